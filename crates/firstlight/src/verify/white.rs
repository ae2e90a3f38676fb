//! Materials that lose no light: under a sky that is the same everywhere, nothing made of them can be seen.

use crate::color::Rgb;
use crate::scene::description::*;

/// Round facets of a roughness.
fn rough(roughness: f32) -> Facets {
    Facets::of(Scalar::constant(roughness))
}

fn of(name: &str, scattering: Scattering) -> Material {
    Material { scattering, ..Material::matte(name, Rgb::ONE) }
}

/// A solid of glass.
pub fn glass(index: f32, roughness: f32) -> Material {
    let interior = Some(Interior::clear(index));
    Material { interior, ..of("glass", Scattering::Dielectric { facets: rough(roughness) }) }
}

/// A metal that reflects all.
pub fn metal(roughness: f32) -> Material {
    of("metal", Scattering::Conductor { index: None, facets: rough(roughness) })
}

/// A pane of glass.
pub fn pane(index: f32) -> Material {
    of("pane", Scattering::ThinGlass { index })
}

/// glTF's surface, white and no metal, but for what is changed.
pub fn principled(name: &str, change: impl FnOnce(&mut Principled)) -> Material {
    let mut p = Principled { metallic: Scalar::constant(0.0), ..Principled::default() };
    change(&mut p);
    of(name, Scattering::Principled(Box::new(p)))
}

/// Each kind of material that loses nothing, at a roughness, by its name.
pub fn materials(roughness: f32) -> Vec<Material> {
    let number = Scalar::constant;
    let facets = || rough(roughness);
    let brushed = Facets { anisotropy: number(0.7), ..facets() };
    let named = |name: &str, material| Material { name: name.into(), ..material };
    vec![
        of("eon", Scattering::Matte { roughness: number(roughness) }),
        metal(roughness),
        of("brushed", Scattering::Conductor { index: None, facets: brushed }),
        named("glass 1.1", glass(1.1, roughness)),
        named("glass 1.5", glass(1.5, roughness)),
        named("glass 2.4", glass(2.4, roughness)),
        principled("plastic", |p| p.facets = facets()),
        principled("pane", |p| (p.transmission, p.facets) = (number(1.0), facets())),
        Material {
            interior: Some(Interior::clear(1.5)),
            ..principled("half glass", |p| (p.transmission, p.facets) = (number(0.5), facets()))
        },
        principled("layers", |p| {
            (p.clearcoat, p.clearcoat_roughness) = (number(1.0), number(0.2));
            p.sheen_color = Texture::constant(Rgb::splat(0.7));
            (p.sheen_roughness, p.metallic) = (number(0.4), number(0.5));
            p.facets = facets();
        }),
        principled("leaf", |p| (p.diffuse_transmission, p.facets) = (number(0.6), facets())),
    ]
}
