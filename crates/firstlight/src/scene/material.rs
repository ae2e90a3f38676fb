//! What a material is at one point: its textures looked up, its lobes made.

use super::Scene;
use super::description::{
    BumpAmount, BumpMap, Facets, Material, NormalMap, OcclusionMap, Pattern, Principled, Scalar,
    Scattering, Texture,
};
use crate::bvh::{Part, World};
use crate::color::Rgb;
use crate::geometry::Hit;
use crate::shading::bsdf::{
    Bsdf, Frame, Fresnel, Kind, Layers, Lobe, PrincipledPoint, VARNISH, Wall, above, principled,
};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::{Role, Spot, evaluate, uv_set};
use glam::{Vec2, Vec3, Vec3Swizzles, Vec4Swizzles};

/// A boundary between two media as light that leaves it sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Boundary {
    /// Index beyond over index on the side of the eye.
    pub eta: f32,
    /// Whether the eye is inside of the solid.
    pub inside: bool,
}

/// A surface that is matte, smooth and of one colour everywhere, and that neither emits nor encloses anything.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plain {
    /// The fraction of light that it reflects, 0..1.
    pub reflectance: Rgb,
    /// Whether it is of flat triangles that stand still.
    pub flat: bool,
}

/// Those that are plain.
pub(super) fn plain_surfaces(
    world: &World,
    material_of: &[u32],
    materials: &[Material],
) -> Vec<Option<Plain>> {
    let plain = |(surface, &material): (u32, &u32)| {
        let reflectance = plain_reflectance(&materials[material as usize])?;
        let flat = match &world.parts()[surface as usize] {
            Part::Mesh(part) => part.mesh.normals.is_empty() && world.motion(surface).is_none(),
            Part::Analytic(..) => false,
        };
        Some(Plain { reflectance, flat })
    };
    (0..).zip(material_of).map(plain).collect()
}

/// The reflectance of a material if it makes surfaces plain.
fn plain_reflectance(material: &Material) -> Option<Rgb> {
    let Material { reflectance, ambient_reflectance, occlusion, interior, .. } = material;
    let no_more = ambient_reflectance.is_none() && occlusion.is_none() && interior.is_none();
    let smooth = material.is_matte() && !material.has_relief();
    let plain = smooth && no_more && reflectance.is_constant() && !material.emits();
    plain.then(|| Vec3::from_slice(&reflectance.factor))
}

/// The facets of a material, if they are not round.
fn brushed(material: &Material) -> Option<&Facets> {
    let facets = match &material.scattering {
        Scattering::Conductor { facets, .. } | Scattering::Dielectric { facets } => facets,
        Scattering::Principled(principled) => &principled.facets,
        _ => return None,
    };
    (!facets.anisotropy.is(0.0)).then_some(facets)
}

/// Two directions laid into the plane of a normal, with length 1 unless they are 0.
fn flattened(axes: [Vec3; 2], normal: Vec3) -> [Vec3; 2] {
    axes.map(|axis| (axis - axis.dot(normal) * normal).normalize_or_zero())
}

/// A direction in a picture, in the texture coordinates that the picture is laid along.
fn unturned(texture: &Texture, direction: Vec2) -> Vec2 {
    let Pattern::Image { transform, .. } = &texture.pattern else { return direction };
    let turned = transform.matrix2.inverse() * direction;
    turned.normalize_or_zero() * direction.length()
}

/// Adds lobes for a point of a surface.
struct Maker<'a> {
    scene: &'a Scene,
    at: &'a SurfaceInteraction,
    frame: Frame,
    boundary: Option<Boundary>,
}

impl Scene {
    /// What was hit, if it is plain.
    #[inline(always)]
    pub(crate) fn plain(&self, hit: &Hit) -> Option<&Plain> {
        self.plain.get(hit.surface as usize)?.as_ref()
    }

    /// Adds the lobes of a material at a point to `lobes`, for light that leaves along the unit vector `outgoing`;
    /// returns the frame that they are in, and the fraction of light that they scatter in all.
    ///
    /// `boundary` is given where the material is that of a solid, see [`Material::interior`].
    #[inline(always)]
    pub(crate) fn add_lobes(
        &self,
        material: &Material,
        at: &SurfaceInteraction,
        outgoing: Vec3,
        boundary: Option<Boundary>,
        lobes: &mut Vec<Lobe>,
    ) -> (Frame, Rgb) {
        if material.is_matte() {
            let weight = self.evaluate(&material.reflectance, at).xyz();
            if weight != Rgb::ZERO {
                lobes.push(Lobe::new(Kind::Lambert, weight));
            }
            return (self.frame(material, at), weight);
        }
        let frame = self.frame(material, at);
        let mut layers = Layers::new(lobes, above(frame.to_local(outgoing)));
        Maker { scene: self, at, frame, boundary }.add(material, &mut layers);
        (frame, layers.finish())
    }

    /// The boundary of a material's solid that lies in air, if it has one.
    pub(crate) fn boundary_from_air(
        &self,
        material: &Material,
        at: &SurfaceInteraction,
    ) -> Option<Boundary> {
        let index = material.interior?.index;
        let eta = if at.front { index } else { 1.0 / index };
        Some(Boundary { eta, inside: !at.front })
    }

    /// The frame of a surface: its first axis is the direction of the facets' anisotropy, its third the normal, bent as
    /// the material wants it.
    #[inline(always)]
    fn frame(&self, material: &Material, at: &SurfaceInteraction) -> Frame {
        let ground = at.shading_normal;
        let raised = material.bump.as_ref().map_or(ground, |map| self.raised_normal(map, at));
        let normal = material.normal.as_ref().map_or(raised, |map| {
            self.bent_normal(map, &SurfaceInteraction { shading_normal: raised, ..*at })
        });
        let frame = match brushed(material) {
            Some(facets) => self.brushed_frame(normal, facets, at),
            None => Frame::around(normal),
        };
        if normal == ground { frame } else { frame.bent_from(ground) }
    }

    fn brushed_frame(&self, normal: Vec3, facets: &Facets, at: &SurfaceInteraction) -> Frame {
        let turn = Vec2::from_angle(facets.rotation);
        let direction = match &facets.direction {
            Some(texture) => 2.0 * self.look_up(texture, at, Role::Data).xy() - 1.0,
            None => Vec2::X,
        };
        let turn = direction.normalize_or(Vec2::X).rotate(turn);
        let uv_set = facets.direction.as_ref().map_or(0, uv_set);
        let [along_u, along_v] = flattened(self.growing(at, uv_set), normal);
        Frame::along(normal, turn.x * along_u + turn.y * along_v)
    }

    /// The normal that a map gives a point, on the side of the eye.
    fn bent_normal(&self, map: &NormalMap, at: &SurfaceInteraction) -> Vec3 {
        let normal = at.shading_normal;
        let texel = 2.0 * self.look_up(&map.texture, at, Role::Data).xyz() - 1.0;
        let slope = unturned(&map.texture, texel.xy()) * map.scale;
        // Seen from behind, hills are valleys.
        let slope = if at.front { slope } else { -slope };
        let [along_u, along_v] = flattened(self.growing(at, uv_set(&map.texture)), normal);
        (slope.x * along_u + slope.y * along_v + texel.z.max(1e-3) * normal).normalize()
    }

    /// The normal of a surface that a map raises, on the side of the eye.
    fn raised_normal(&self, map: &BumpMap, at: &SurfaceInteraction) -> Vec3 {
        let (normal, texture) = (at.shading_normal, &map.height.texture);
        let gradients = self.gradients(at, uv_set(texture));
        let step = self.texel_step(texture);
        let spot = self.spot(texture, at);
        let height = |shift: Vec2| {
            let spot = Spot { uv: spot.uv + shift, ..spot };
            let texel = evaluate(texture, &self.pictures, spot, at.color, Role::Data);
            map.height.meant(texel[map.height.channel])
        };
        let along = |axis: Vec2| (height(step * axis) - height(-step * axis)) / (2.0 * step);
        let slopes = [along(Vec2::X), along(Vec2::Y)];
        let steep = |i: usize| match map.amount {
            BumpAmount::Metres(metres) => metres * slopes[i] * gradients[i],
            BumpAmount::Relative(part) => part * slopes[i] * gradients[i].normalize_or_zero(),
        };
        let slope = steep(0) + steep(1);
        let slope = slope - slope.dot(normal) * normal;
        // Seen from behind, hills are valleys.
        let slope = if at.front { slope } else { -slope };
        (normal - slope).try_normalize().unwrap_or(normal)
    }

    /// Half a texel in texture coordinates; of what has no texels, a small part.
    fn texel_step(&self, texture: &Texture) -> f32 {
        match &texture.pattern {
            Pattern::Image { image, transform, .. } => {
                let across = self.pictures[*image].texels_across() as f32;
                0.5 / (across * transform.matrix2.determinant().abs().sqrt()).max(1e-6)
            }
            Pattern::Checker { size, .. } | Pattern::Noise { size, .. } => {
                1e-3 * size.min_element()
            }
            Pattern::Gradient { from, to, .. } => 1e-3 * (*to - *from).length(),
            Pattern::Constant => 1.0,
        }
    }

    /// The fraction of ambient light that the material reflects at a point; `None`: all that it scatters.
    #[inline(always)]
    pub(crate) fn ambient_reflectance(
        &self,
        material: &Material,
        at: &SurfaceInteraction,
    ) -> Option<Rgb> {
        Some(self.evaluate(material.ambient_reflectance.as_ref()?, at).xyz())
    }

    /// The part of what a surface emits that its varnish lets out (KHR_materials_clearcoat).
    #[inline(always)]
    pub(super) fn through_coat(
        &self,
        material: &Material,
        at: &SurfaceInteraction,
        outgoing: Vec3,
    ) -> f32 {
        let Some(coat) = material.coat() else { return 1.0 };
        1.0 - self.number(coat, at) * VARNISH.at(at.shading_normal.dot(outgoing).abs()).x
    }

    /// The part of ambient light that an occlusion map lets come to a point, 0..1.
    #[inline(always)]
    pub(crate) fn openness(&self, material: &Material, at: &SurfaceInteraction) -> f32 {
        let Some(OcclusionMap { open, strength }) = &material.occlusion else { return 1.0 };
        1.0 + strength * (self.number(open, at) - 1.0)
    }

    /// The alpha of a material at a point.
    pub(crate) fn alpha(&self, material: &Material, at: &SurfaceInteraction) -> f32 {
        let opacity = material.opacity.as_ref().map_or(1.0, |opacity| self.number(opacity, at));
        self.evaluate(&material.reflectance, at).w * opacity
    }

    /// The thickness of a thin film at a point, nm.
    pub(crate) fn film_thickness(&self, p: &Principled, at: &SurfaceInteraction) -> f32 {
        let [thin, thick] = p.iridescence_thickness_range;
        thin + (thick - thin) * self.number(&p.iridescence_thickness, at)
    }

    /// A number of a texture at a point, 0..1.
    fn number(&self, scalar: &Scalar, at: &SurfaceInteraction) -> f32 {
        if scalar.texture.is_constant() {
            return scalar.meant(scalar.texture.factor[scalar.channel]);
        }
        let texel = self.look_up(&scalar.texture, at, Role::Data);
        scalar.meant(texel[scalar.channel].clamp(0.0, 1.0))
    }

    /// The fraction of light that goes through a point of a pane as if it were not there.
    pub(crate) fn straight(
        &self,
        material: &Material,
        at: &SurfaceInteraction,
        outgoing: Vec3,
    ) -> Rgb {
        let mut lobes = Vec::new();
        let (frame, _) = self.add_lobes(material, at, outgoing, None, &mut lobes);
        Bsdf { frame, outgoing, lobes: &lobes }.straight()
    }
}

impl Maker<'_> {
    fn color(&self, texture: &Texture) -> Rgb {
        self.scene.evaluate(texture, self.at).xyz()
    }

    fn number(&self, scalar: &Scalar) -> f32 {
        self.scene.number(scalar, self.at)
    }

    /// Widths of the facets along the frame's first axis and across it.
    fn alpha(&self, facets: &Facets) -> Vec2 {
        let (roughness, anisotropy) =
            (self.number(&facets.roughness), self.number(&facets.anisotropy));
        let alpha = roughness * roughness;
        Vec2::new(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha)
    }

    fn add(&self, material: &Material, layers: &mut Layers<'_>) {
        let color = || self.color(&material.reflectance);
        match &material.scattering {
            Scattering::Matte { roughness } => layers.matte(color(), self.number(roughness)),
            Scattering::Mirror { mirrored } => {
                layers.add(Kind::Mirror, self.color(mirrored), Rgb::ONE);
                layers.matte(color(), 0.0);
            }
            Scattering::Conductor { index, facets } => {
                let color = color();
                let fresnel = match index {
                    Some(index) => {
                        layers.left *= color;
                        Fresnel::Conductor { n: index.n, k: index.k }
                    }
                    None => Fresnel::Schlick { normal: color, grazing: 1.0 },
                };
                layers.multiple_scattering = facets.multiple_scattering;
                layers.facets(fresnel, self.alpha(facets));
            }
            Scattering::Dielectric { facets } => {
                let eta = self.boundary.map_or(1.0, |boundary| boundary.eta);
                layers.multiple_scattering = facets.multiple_scattering;
                layers.glass(eta, self.alpha(facets), color(), None);
            }
            Scattering::ThinGlass { index } => layers.window(*index, color()),
            Scattering::Principled(p) => {
                layers.multiple_scattering = p.facets.multiple_scattering;
                principled(layers, &self.principled(p, color()));
            }
            Scattering::Mix { materials, amount } => {
                let (left, amount) = (layers.left, self.number(amount));
                for (part, share) in materials.iter().zip([1.0 - amount, amount]) {
                    layers.left = left * share;
                    if share > 0.0 {
                        self.add(&self.scene.materials[*part], layers);
                    }
                }
            }
        }
    }

    /// The normal of the coat in the frame; varnish fills what the normal map of the surface carves.
    fn coat_normal(&self, p: &Principled) -> Vec3 {
        let normal = match &p.clearcoat_normal {
            Some(map) => self.scene.bent_normal(map, self.at),
            None => self.at.shading_normal,
        };
        above(self.frame.to_local(normal))
    }

    fn principled(&self, p: &Principled, base_color: Rgb) -> PrincipledPoint {
        PrincipledPoint {
            base_color,
            metallic: self.number(&p.metallic),
            alpha: self.alpha(&p.facets),
            ior: if p.ior == 0.0 { f32::INFINITY } else { p.ior },
            specular: self.number(&p.specular),
            specular_color: self.color(&p.specular_color),
            transmission: self.number(&p.transmission),
            diffuse_transmission: self.number(&p.diffuse_transmission),
            diffuse_transmission_color: self.color(&p.diffuse_transmission_color),
            clearcoat: self.number(&p.clearcoat),
            clearcoat_roughness: self.number(&p.clearcoat_roughness),
            clearcoat_normal: self.coat_normal(p),
            sheen_color: self.color(&p.sheen_color),
            sheen_roughness: self.number(&p.sheen_roughness),
            iridescence: self.number(&p.iridescence),
            iridescence_ior: p.iridescence_ior,
            iridescence_thickness: self.scene.film_thickness(p, self.at),
            wall: match self.boundary {
                Some(Boundary { eta, inside }) => Wall::Solid { eta, inside },
                None => Wall::Thin,
            },
        }
    }
}
