//! Where light goes that enters glass.

use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::shading::bsdf::{Bsdf, Frame, Kind, Layers, Lobe};
use glam::{Vec2, Vec3};

pub(super) const CASES: &[Case] = &[Case::exact(
    "M10-slab-displacement",
    "a ray through a slab of 1 m of index 1.5: how far it is shifted sideways",
    "Snell",
    m10,
)
.within(Tolerance::Absolute(1e-5))];

/// The refracted direction of a ray that goes down along `direction`, at a smooth boundary.
fn refracted(direction: Vec3, eta: f32) -> Vec3 {
    let mut lobes = Vec::new();
    let mut layers = Layers::new(&mut lobes, -direction);
    layers.glass(eta, Vec2::ZERO, Rgb::ONE, None);
    layers.finish();
    lobes.retain(|lobe: &Lobe| matches!(lobe.kind, Kind::Refraction { .. }));
    lobes.iter_mut().for_each(|lobe| lobe.share = 1.0);
    let bsdf = Bsdf { frame: Frame::around(Vec3::Z), outgoing: -direction, lobes: &lobes };
    bsdf.sample(0.5, Vec2::ZERO).map_or(Vec3::NAN, |sample| sample.incoming)
}

fn m10(readings: &mut Readings) {
    for (degrees, expected) in [
        (0.0_f32, 0.0),
        (30.0, 0.193813782),
        (45.0, 0.329142308),
        (60.0, 0.512472013),
        (80.0, 0.83366385),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(sin, 0.0, -cos);
        let inside = refracted(direction, 1.5);
        // Where the ray leaves the slab, seen across the ray that would have gone straight on.
        let exit = inside / -inside.z;
        let across = exit - exit.dot(direction) * direction;
        readings.exact(format!("{degrees}, shift"), across.length(), expected);
        let turned = refracted(inside, 1.0 / 1.5) - direction;
        readings.at_most(format!("{degrees}, turn"), turned.length().into(), 1e-5);
    }
}
