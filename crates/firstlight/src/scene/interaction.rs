//! From traversal's answer to the point that is shaded.

use super::Scene;
use super::description::{Material, Mesh, Pattern, Texture};
use crate::bvh::{MeshPart, Part};
use crate::geometry::{Analytic, Hit, Ray};
use crate::shading::interaction::{SurfaceInteraction, clearance, lift};
use crate::shading::texture::{Role, Spot, evaluate, uv_set};
use glam::{DVec3, Vec2, Vec3, Vec4};

impl Scene {
    /// The point that `ray` hit.
    #[inline(always)]
    pub(crate) fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        match self.world.motion(hit.surface) {
            None => on_part(&self.world.parts()[hit.surface as usize], ray, hit),
            Some(_) => self.moving_interaction(ray, hit),
        }
    }

    #[inline(never)]
    fn moving_interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        on_part(&self.world.part(hit.surface, ray.time), ray, hit)
    }

    /// The material of what was hit.
    #[inline(always)]
    pub(crate) fn material(&self, hit: &Hit) -> &Material {
        &self.materials[self.material_of[hit.surface as usize] as usize]
    }

    /// Linear RGBA of a texture of colours at a point.
    #[inline(always)]
    pub(crate) fn evaluate(&self, texture: &Texture, at: &SurfaceInteraction) -> Vec4 {
        self.look_up(texture, at, Role::Color)
    }

    /// RGBA of a texture at a point.
    #[inline(always)]
    pub(crate) fn look_up(&self, texture: &Texture, at: &SurfaceInteraction, role: Role) -> Vec4 {
        evaluate(texture, &self.pictures, self.spot(texture, at), at.color, role)
    }

    /// Where a texture is looked at.
    #[inline(always)]
    pub(crate) fn spot(&self, texture: &Texture, at: &SurfaceInteraction) -> Spot {
        let uv = match (uv_set(texture), &self.world.parts()[at.hit.surface as usize]) {
            (set @ 1.., Part::Mesh(part)) => mesh_uv(&part.mesh, set, &at.hit),
            _ => at.uv,
        };
        let pointlike = at.seen_width == 0.0
            || matches!(texture.pattern, Pattern::Constant | Pattern::Gradient { .. });
        if pointlike { Spot::at(uv) } else { self.wide_spot(texture, at, uv) }
    }

    #[inline(never)]
    fn wide_spot(&self, texture: &Texture, at: &SurfaceInteraction, uv: Vec2) -> Spot {
        let [u, v] = self.gradients(at, uv_set(texture));
        let extent = at.seen_axes().map(|axis| Vec2::new(axis.dot(u), axis.dot(v)));
        Spot { uv, extent }
    }

    /// How the texture coordinates of a set grow, in the world, m⁻¹; zero if unknown.
    pub(crate) fn gradients(&self, at: &SurfaceInteraction, uv_set: usize) -> [Vec3; 2] {
        match &*self.world.part(at.hit.surface, at.time) {
            Part::Mesh(part) => mesh_gradients(part, uv_set, &at.hit),
            Part::Analytic(shape, _) => shape.gradients(at.position.as_dvec3(), at.hit.primitive),
        }
    }

    /// The directions in which the texture coordinates of a set grow, in the world, of any length; zero if unknown.
    pub(crate) fn growing(&self, at: &SurfaceInteraction, uv_set: usize) -> [Vec3; 2] {
        match &*self.world.part(at.hit.surface, at.time) {
            Part::Mesh(part) => mesh_growing(part, uv_set, &at.hit),
            Part::Analytic(shape, _) => shape.growing(at.position.as_dvec3(), at.hit.primitive),
        }
    }

    /// Whether the back of a surface was hit; `from_behind` is traversal's view of it, by the winding in its tree.
    pub(crate) fn is_back(&self, hit: &Hit, from_behind: bool) -> bool {
        let part = &self.world.parts()[hit.surface as usize];
        from_behind != matches!(part, Part::Mesh(MeshPart { mirrored: true, .. }))
    }
}

#[inline(always)]
fn on_part(part: &Part, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    match part {
        Part::Mesh(part) => on_mesh(part, ray, hit),
        Part::Analytic(shape, _) => on_analytic(shape, ray, hit),
    }
}

#[inline(always)]
fn on_analytic(shape: &Analytic, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    let point = shape.point(ray, f64::from(hit.t), hit.primitive);
    let position = point.position.as_vec3();
    let outward = point.normal.as_vec3();
    let normal = facing(outward, ray);
    SurfaceInteraction {
        hit: *hit,
        position,
        front: outward.dot(ray.direction) < 0.0,
        clearance: clearance(normal, position.abs(), shape.error()),
        lift: Vec3::ZERO,
        geometric_normal: normal,
        shading_normal: normal,
        uv: point.uv.as_vec2(),
        seen_width: 0.0,
        seen_along: ray.direction,
        time: ray.time,
        color: [1.0; 4],
    }
}

/// Positions are interpolated in double precision and rounded once, in world space.
#[inline(always)]
fn on_mesh(part: &MeshPart, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    let corners = part.corners(hit.primitive);
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
    let local = a + u * (b - a) + v * (c - a);
    let position = if part.instanced { part.to_world.transform_point3(local) } else { local };
    let wound = world_normal(part, (b - a).cross(c - a));
    let outward = facing(wound, ray);
    let mut interaction = SurfaceInteraction {
        hit: *hit,
        position: position.as_vec3(),
        front: (wound.dot(ray.direction) < 0.0) != part.mirrored,
        clearance: clearance(outward, rounded(part, position, local), part.error()),
        lift: Vec3::ZERO,
        geometric_normal: outward,
        shading_normal: outward,
        uv: mesh_uv(&part.mesh, 0, hit),
        seen_width: 0.0,
        seen_along: ray.direction,
        time: ray.time,
        color: mesh_color(&part.mesh, hit),
    };
    if !part.mesh.normals.is_empty() {
        smooth(&mut interaction, part, corners);
    }
    interaction
}

/// Replaces the flat normal by the mix of the corners' normals, and lifts the point onto the surface they suggest.
#[inline(always)]
fn smooth(interaction: &mut SurfaceInteraction, part: &MeshPart, corners: [Vec3; 3]) {
    let (mesh, hit) = (&part.mesh, &interaction.hit);
    let side = interaction.geometric_normal;
    let normals = mesh.triangles[hit.primitive as usize].map(|index| {
        let normal = part.to_object.matrix3.transpose() * mesh.normals[index as usize].as_dvec3();
        let normal = normal.normalize_or_zero().as_vec3();
        if normal.dot(side) < 0.0 { -normal } else { normal }
    });
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let mixed: Vec3 = (0..3).map(|i| weights[i] * normals[i]).sum();
    interaction.shading_normal = mixed.try_normalize().unwrap_or(side);
    let in_world = |p: Vec3| {
        if part.instanced { part.to_world.transform_point3(p.as_dvec3()).as_vec3() } else { p }
    };
    interaction.lift = lift(interaction.position, corners.map(in_world), normals, weights);
}

/// A unit normal, on the side that the ray comes from; against the ray if it is zero.
#[inline(always)]
fn facing(normal: Vec3, ray: &Ray) -> Vec3 {
    match normal.dot(ray.direction) {
        _ if normal == Vec3::ZERO => -ray.direction,
        cos if cos > 0.0 => -normal,
        _ => normal,
    }
}

#[inline(always)]
fn world_normal(part: &MeshPart, normal: DVec3) -> Vec3 {
    let normal = if part.instanced { part.to_object.matrix3.transpose() * normal } else { normal };
    normal.normalize_or_zero().as_vec3()
}

/// What was rounded to f32 per axis: the position, and for instances the ray's origin in the mesh's space.
#[inline(always)]
fn rounded(part: &MeshPart, position: DVec3, local: DVec3) -> Vec3 {
    let position = position.abs();
    let m = part.to_world.matrix3;
    let brought_back = m.x_axis.abs() * local.x.abs()
        + m.y_axis.abs() * local.y.abs()
        + m.z_axis.abs() * local.z.abs();
    (if part.instanced { position + brought_back } else { position }).as_vec3()
}

/// Interpolates a per-vertex value.
fn mix<T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>>(
    mesh: &Mesh,
    values: &[T],
    hit: &Hit,
) -> T {
    let [a, b, c] = mesh.triangles[hit.primitive as usize].map(|index| values[index as usize]);
    a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v
}

#[inline(always)]
fn mesh_uv(mesh: &Mesh, set: usize, hit: &Hit) -> Vec2 {
    mesh.uvs.get(set).map_or(Vec2::ZERO, |uvs| mix(mesh, uvs, hit))
}

/// From the corners' positions and texture coordinates.
fn mesh_growing(part: &MeshPart, uv_set: usize, hit: &Hit) -> [Vec3; 2] {
    let uvs = part.mesh.uvs.get(uv_set).filter(|uvs| !uvs.is_empty());
    let Some(uvs) = uvs else { return [Vec3::ZERO; 2] };
    let [a, b, c] = part.corners(hit.primitive).map(Vec3::as_dvec3);
    let [s, t, w] = part.mesh.triangles[hit.primitive as usize].map(|i| uvs[i as usize].as_dvec2());
    let (along, across) = (t - s, w - s);
    let sign = along.perp_dot(across).signum();
    let local = [
        sign * ((b - a) * across.y - (c - a) * along.y),
        sign * ((c - a) * along.x - (b - a) * across.x),
    ];
    local.map(|axis| {
        let in_world = part.instanced.then(|| part.to_world.transform_vector3(axis));
        in_world.unwrap_or(axis).normalize_or_zero().as_vec3()
    })
}

/// From the corners' positions and texture coordinates: what changes from one corner to another grows across the edge
/// that it does not change along.
fn mesh_gradients(part: &MeshPart, uv_set: usize, hit: &Hit) -> [Vec3; 2] {
    let uvs = part.mesh.uvs.get(uv_set).filter(|uvs| !uvs.is_empty());
    let Some(uvs) = uvs else { return [Vec3::ZERO; 2] };
    let [a, b, c] = part.corners(hit.primitive).map(|corner| {
        let corner = corner.as_dvec3();
        if part.instanced { part.to_world.transform_point3(corner) } else { corner }
    });
    let [s, t, w] = part.mesh.triangles[hit.primitive as usize].map(|i| uvs[i as usize].as_dvec2());
    let (b, c) = (b - a, c - a);
    let normal = b.cross(c);
    let area2 = normal.length_squared();
    if area2 == 0.0 {
        return [Vec3::ZERO; 2];
    }
    let (toward_b, toward_c) = (c.cross(normal) / area2, normal.cross(b) / area2);
    let (t, w) = (t - s, w - s);
    [t.x * toward_b + w.x * toward_c, t.y * toward_b + w.y * toward_c].map(|g| g.as_vec3())
}

#[inline(always)]
fn mesh_color(mesh: &Mesh, hit: &Hit) -> [f32; 4] {
    if mesh.colors.is_empty() {
        return [1.0; 4];
    }
    let [a, b, c] = mesh.triangles[hit.primitive as usize];
    let color = |index: u32| Vec4::from_array(mesh.colors[index as usize]);
    (color(a) * (1.0 - hit.u - hit.v) + color(b) * hit.u + color(c) * hit.v).to_array()
}
