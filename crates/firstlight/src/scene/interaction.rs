//! From traversal's answer to the point that is shaded, for one ray or for many.
//!
//! Many go in blocks: the triangles' corners are gathered, and loops over the block find points and normals.

use super::Scene;
use super::description::{Material, Mesh, Pattern, Texture};
use crate::bvh::{MeshPart, Part};
use crate::geometry::{Analytic, Hit, Ray};
use crate::math::{BLOCK, Columns, unit_or_zero};
use crate::shading::interaction::{SurfaceInteraction, clearance, lift};
use crate::shading::texture::{Role, Spot, evaluate, uv_set};
use crate::simd::{Kernel, Simd};
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

    /// The mesh that was hit, if one was and it stands still.
    #[inline(always)]
    fn still_mesh(&self, hit: &Hit) -> Option<&MeshPart> {
        match self.world.parts().get(hit.surface as usize)? {
            Part::Mesh(part) if self.world.motion(hit.surface).is_none() => Some(part),
            _ => None,
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
    let normal = facing(outward, ray.direction);
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

/// A point of a triangle.
#[derive(Clone, Copy)]
struct OnTriangle {
    position: DVec3,
    /// What was rounded to f32 per axis.
    rounded: Vec3,
    /// At a right angle to the triangle, of any length.
    across: DVec3,
}

impl OnTriangle {
    /// The point with weights `u` and `v` of the second and third corner. It is interpolated in double precision, to be rounded
    /// once.
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3], u: f32, v: f32) -> Self {
        let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        let (to_b, to_c) = (b - a, c - a);
        let position = a + f64::from(u) * to_b + f64::from(v) * to_c;
        Self { position, rounded: position.abs().as_vec3(), across: to_b.cross(to_c) }
    }

    /// The same in the world, from a mesh's own space. The ray was rounded there too.
    #[inline(always)]
    fn placed(self, part: &MeshPart) -> Self {
        let (m, local) = (part.to_world.matrix3, self.position.abs());
        let brought_back =
            m.x_axis.abs() * local.x + m.y_axis.abs() * local.y + m.z_axis.abs() * local.z;
        let position = part.to_world.transform_point3(self.position);
        let rounded = (position.abs() + brought_back).as_vec3();
        Self { position, rounded, across: part.to_object.matrix3.transpose() * self.across }
    }
}

/// A point of a triangle seen from one side.
#[derive(Clone, Copy)]
struct Facing {
    position: Vec3,
    /// Unit normal on the side of the eye.
    normal: Vec3,
    clearance: f32,
    /// Whether its corners run clockwise as seen from there, in the space that its tree has them in.
    clockwise: bool,
}

impl Facing {
    /// The point in the unit direction `along`, off by at most `error`, m.
    #[inline(always)]
    fn new(point: OnTriangle, along: Vec3, error: f64) -> Self {
        let wound = unit_or_zero(point.across).as_vec3();
        let normal = facing(wound, along);
        let clockwise = wound.dot(along) >= 0.0;
        let clearance = clearance(normal, point.rounded, error);
        Self { position: point.position.as_vec3(), normal, clearance, clockwise }
    }
}

/// The point of a mesh that one ray hit.
#[inline(always)]
fn on_mesh(part: &MeshPart, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    let point = OnTriangle::new(part.corners(hit.primitive), hit.u, hit.v);
    let point = if part.instanced { point.placed(part) } else { point };
    dressed(part, ray, hit, Facing::new(point, ray.direction, part.error()))
}

/// A point of a mesh with what its vertices say of it.
#[inline(always)]
fn dressed(part: &MeshPart, ray: &Ray, hit: &Hit, facing: Facing) -> SurfaceInteraction {
    let Facing { position, normal, clearance, clockwise } = facing;
    let mut interaction = SurfaceInteraction {
        hit: *hit,
        position,
        front: clockwise == part.mirrored,
        clearance,
        lift: Vec3::ZERO,
        geometric_normal: normal,
        shading_normal: normal,
        uv: mesh_uv(&part.mesh, 0, hit),
        seen_width: 0.0,
        seen_along: ray.direction,
        time: ray.time,
        color: mesh_color(&part.mesh, hit),
    };
    if !part.mesh.normals.is_empty() {
        smooth(&mut interaction, part, part.corners(hit.primitive));
    }
    interaction
}

/// Looks at the points that a block of rays hit, at most [`BLOCK`]: all that takes arithmetic.
pub(crate) struct LookAt<'a> {
    /// Whose surfaces they are.
    pub scene: &'a Scene,
    /// The rays.
    pub rays: &'a [Ray],
    /// What they hit.
    pub hits: &'a [Hit],
    /// The points; what was there is replaced.
    pub points: &'a mut Points,
}

impl Kernel for LookAt<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { scene, rays, hits, points } = self;
        let mut parts = [None; BLOCK];
        for (part, hit) in parts.iter_mut().zip(hits) {
            *part = scene.still_mesh(hit);
        }
        let Points { triangles, exact, rounded, facing } = points;
        triangles.gather(&parts, rays, hits);
        exact.find(triangles, rounded);
        for (k, part) in parts.iter().enumerate() {
            if let Some(part) = part.filter(|part| part.instanced) {
                exact.set(k, exact.get(k, rounded).placed(part), rounded);
            }
        }
        facing.find(triangles, exact, rounded);
    }
}

/// The points that a block of rays hit, as far as they lie on triangles that stand still; rows of other rays mean nothing.
#[derive(Default)]
pub(crate) struct Points {
    triangles: Triangles,
    exact: ExactPoints,
    rounded: Columns<f32>,
    facing: Facings,
}

impl Points {
    /// The point that ray `k` hit, as [`Scene::interaction`]; `None` if it hit nothing.
    #[inline(always)]
    pub(crate) fn get(
        &self,
        k: usize,
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
    ) -> Option<SurfaceInteraction> {
        match scene.still_mesh(hit) {
            Some(part) => Some(dressed(part, ray, hit, self.facing.get(k))),
            None => hit.is_some().then(|| scene.interaction(ray, hit)),
        }
    }

    /// The same of a [flat](super::Plain::flat) surface: its position, where rays leave it, and its normal.
    #[inline(always)]
    pub(crate) fn flat(&self, k: usize) -> ([Vec3; 2], Vec3) {
        let Facing { position, normal, clearance, .. } = self.facing.get(k);
        ([position, position + clearance * normal], normal)
    }
}

/// Triangles that a block of rays hit.
struct Triangles {
    corners: [Columns<f32>; 3],
    weights: [[f32; BLOCK]; 2],
    along: Columns<f32>,
    error: [f64; BLOCK],
}

impl Default for Triangles {
    fn default() -> Self {
        let corners = std::array::from_fn(|_| Columns::default());
        let (weights, error) = ([[0.0; BLOCK]; 2], [0.0; BLOCK]);
        Self { corners, weights, along: Columns::default(), error }
    }
}

impl Triangles {
    /// Takes them up.
    #[inline(always)]
    fn gather(&mut self, parts: &[Option<&MeshPart>], rays: &[Ray], hits: &[Hit]) {
        for (k, ((ray, hit), part)) in rays.iter().zip(hits).zip(parts).enumerate() {
            let Some(part) = part else { continue };
            let corners = part.corners(hit.primitive);
            for (column, corner) in self.corners.iter_mut().zip(corners) {
                column.set(k, corner);
            }
            (self.weights[0][k], self.weights[1][k]) = (hit.u, hit.v);
            self.along.set(k, ray.direction);
            self.error[k] = part.error();
        }
    }
}

/// A block of [`OnTriangle`], but for what was rounded.
#[derive(Default)]
struct ExactPoints {
    position: Columns<f64>,
    across: Columns<f64>,
}

impl ExactPoints {
    #[inline(always)]
    fn find(&mut self, triangles: &Triangles, rounded: &mut Columns<f32>) {
        let Triangles { corners: [a, b, c], weights: [u, v], .. } = triangles;
        for k in 0..BLOCK {
            let point = OnTriangle::new([a.get(k), b.get(k), c.get(k)], u[k], v[k]);
            self.set(k, point, rounded);
        }
    }

    #[inline(always)]
    fn get(&self, k: usize, rounded: &Columns<f32>) -> OnTriangle {
        let (position, across) = (self.position.get(k), self.across.get(k));
        OnTriangle { position, rounded: rounded.get(k), across }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, point: OnTriangle, rounded: &mut Columns<f32>) {
        self.position.set(k, point.position);
        self.across.set(k, point.across);
        rounded.set(k, point.rounded);
    }
}

/// A block of [`Facing`].
struct Facings {
    position: Columns<f32>,
    normal: Columns<f32>,
    clearance: [f32; BLOCK],
    clockwise: [bool; BLOCK],
}

impl Default for Facings {
    fn default() -> Self {
        let [position, normal] = [Columns::default(), Columns::default()];
        Self { position, normal, clearance: [0.0; BLOCK], clockwise: [false; BLOCK] }
    }
}

impl Facings {
    #[inline(always)]
    fn find(&mut self, triangles: &Triangles, exact: &ExactPoints, rounded: &Columns<f32>) {
        for k in 0..BLOCK {
            let (point, along) = (exact.get(k, rounded), triangles.along.get(k));
            let facing = Facing::new(point, along, triangles.error[k]);
            self.position.set(k, facing.position);
            self.normal.set(k, facing.normal);
            self.clearance[k] = facing.clearance;
            self.clockwise[k] = facing.clockwise;
        }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Facing {
        let (position, normal) = (self.position.get(k), self.normal.get(k));
        let (clearance, clockwise) = (self.clearance[k], self.clockwise[k]);
        Facing { position, normal, clearance, clockwise }
    }
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
fn facing(normal: Vec3, along: Vec3) -> Vec3 {
    let turned = if normal.dot(along) > 0.0 { -normal } else { normal };
    if normal == Vec3::ZERO { -along } else { turned }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Meets;
    use crate::scene::description::Motion;
    use crate::simd::Level;
    use crate::testing::{Random, bumpy_sphere, icosphere};
    use crate::verify::scenes::*;
    use glam::DAffine3;

    /// Triangles as they are, smooth ones, stretched and mirrored copies of many, others that move, and a ball.
    fn stage() -> Scene {
        let mut scene = scene_of(Vec3::ONE);
        add_mesh(&mut scene, icosphere(2));
        add_mesh(&mut scene, bumpy_sphere(300));
        let copies = scene.surfaces[1].clone();
        for i in 1..4 {
            let mut copy = copies.clone();
            let size = DVec3::new(1.0, 1.3, if i == 2 { -0.7 } else { 0.7 });
            let at = v(2.5 * f64::from(i), 0.0, 0.0);
            copy.transform = DAffine3::from_scale(size) * DAffine3::from_translation(at);
            copy.motion = (i == 3).then(|| Motion::shift(v(0.0, 0.3, 0.1)));
            scene.surfaces.push(copy);
        }
        scene.surfaces[0].transform = DAffine3::from_translation(v(-2.5, 0.0, 0.0));
        add(&mut scene, ball(v(0.0, 0.0, 3.0), 1.0));
        Scene::build(&scene)
    }

    #[test]
    fn many_points_are_those_that_each_ray_finds_alone() {
        let (scene, mut random) = (stage(), Random::new(5));
        let rays: Vec<_> = (0..5000)
            .map(|_| {
                let [from, to] =
                    [0, 1].map(|_| Vec3::from_array([0; 3].map(|_| random.unit() as f32)));
                let from = 8.0 * from - Vec3::splat(4.0);
                let to = Vec3::new(12.0 * to.x - 3.5, 2.0 * to.y - 1.0, 5.0 * to.z - 1.0);
                let time = random.unit() as f32;
                Ray { time, ..Ray::new(from, (to - from).normalize()) }
            })
            .collect();
        let (mut hits, mut points) = (Vec::new(), Points::default());
        scene.world.closest_hits(&rays, &Meets(&scene, 0), &mut hits);
        let instanced = |hit: &&Hit| scene.still_mesh(hit).is_some_and(|part| part.instanced);
        assert!(hits.iter().filter(instanced).count() > 100);
        for level in Level::all() {
            for (rays, hits) in rays.chunks(BLOCK).zip(hits.chunks(BLOCK)) {
                level.run(LookAt { scene: &scene, rays, hits, points: &mut points });
                for (k, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                    let point = points.get(k, &scene, ray, hit);
                    let alone = hit.is_some().then(|| scene.interaction(ray, hit));
                    assert_eq!(format!("{point:?}"), format!("{alone:?}"));
                }
            }
        }
    }

    /// Of those that are flat, the little that is asked of them is the same.
    #[test]
    fn flat_points_are_those_that_each_ray_finds_alone() {
        let (mut scene, mut random) = (scene_of(Vec3::ONE), Random::new(6));
        let center = Vec3::new(-2.5, 0.1, 0.3);
        add_mesh(&mut scene, Mesh { normals: Vec::new(), ..icosphere(2) });
        scene.surfaces[0].transform = DAffine3::from_translation(center.as_dvec3());
        let scene = Scene::build(&scene);
        let (mut hits, mut points, mut flat) = (Vec::new(), Points::default(), 0);
        for _ in 0..50 {
            let rays: Vec<_> = (0..BLOCK)
                .map(|_| {
                    let [x, y, z] = [0; 3].map(|_| random.unit() as f32 - 0.5);
                    Ray::new(center, Vec3::new(x, y, z).normalize())
                })
                .collect();
            scene.world.closest_hits(&rays, &Meets(&scene, 0), &mut hits);
            scene.level().run(LookAt {
                scene: &scene,
                rays: &rays,
                hits: &hits,
                points: &mut points,
            });
            for (k, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
                if scene.plain(hit).is_some_and(|plain| plain.flat) {
                    let at = scene.interaction(ray, hit);
                    let expected = ([at.position, at.ray_origin()], at.shading_normal);
                    assert_eq!(points.flat(k), expected);
                    flat += 1;
                }
            }
        }
        assert!(flat > 1000, "{flat}");
    }
}
