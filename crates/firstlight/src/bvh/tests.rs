//! Tracing against an oracle, and the promises about closed meshes and about rays that leave surfaces.

use super::{BuildQuality, MeshPart, Part, World};
use crate::geometry::{Analytic, Hit, Ray};
use crate::kernels::{HitFilter, PARTLY_THERE};
use crate::scene::description::{Mesh, Motion, Plane, Sphere};
use crate::simd::Level;
use crate::testing::{Random, bumpy_sphere, icosphere};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::sync::Arc;

struct Everything;

impl HitFilter for Everything {
    fn flags(&self) -> u32 {
        0
    }

    fn accepts(&self, _: &Ray, _: &Hit, _: bool) -> bool {
        true
    }
}

fn world(mesh: &Arc<Mesh>, transforms: &[DAffine3], instanced: bool) -> World {
    moving(mesh, transforms, instanced, vec![None; transforms.len()])
}

fn moving(
    mesh: &Arc<Mesh>,
    transforms: &[DAffine3],
    instanced: bool,
    motions: Vec<Option<Motion>>,
) -> World {
    let part = |t: &DAffine3| Part::Mesh(MeshPart::new(Arc::clone(mesh), *t, instanced, 0));
    let parts = transforms.iter().map(part).collect();
    World::build(parts, motions, Level::detect(), BuildQuality::Final)
}

fn motion(random: &mut Random) -> Motion {
    Motion {
        pivot: random.point(),
        axis: random.direction(),
        angle: 20.0 * (random.unit() - 0.5),
        growth: 0.3 + random.unit(),
        shift: random.point(),
    }
}

fn closest(world: &World, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = Vec::new();
    world.closest_hits(rays, &Everything, &mut hits);
    hits
}

fn skewed(seed: u64) -> DAffine3 {
    let mut random = Random::new(seed);
    let mut column = || 0.6 * random.point();
    let matrix = DMat3::from_cols(DVec3::X + column(), -DVec3::Y + column(), DVec3::Z + column());
    DAffine3::from_mat3_translation(matrix, 3.0 * random.point())
}

fn random_rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut ray = || {
        let origin = 4.0 * random.point();
        let toward = (1.5 * random.point() - origin).normalize();
        Ray::new(origin.as_vec3(), toward.as_vec3())
    };
    (0..count).map(|_| ray()).collect()
}

/// The nearest triangle by trying them all in double precision (Möller & Trumbore 1997): its distance.
fn nearest_by_trying_all(parts: &[Part], ray: &Ray) -> f64 {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut nearest = f64::INFINITY;
    for part in parts {
        let Part::Mesh(part) = part else { continue };
        for triangle in &part.mesh.triangles {
            let corner =
                |i: u32| part.to_world.transform_point3(part.mesh.positions[i as usize].as_dvec3());
            let [a, b, c] = triangle.map(corner);
            let (e1, e2) = (b - a, c - a);
            let p = d.cross(e2);
            let scale = 1.0 / e1.dot(p);
            let u = (o - a).dot(p) * scale;
            let q = (o - a).cross(e1);
            let v = d.dot(q) * scale;
            let t = e2.dot(q) * scale;
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 {
                nearest = nearest.min(t);
            }
        }
    }
    nearest
}

#[test]
fn finds_what_trying_every_triangle_finds() {
    let mesh = Arc::new(bumpy_sphere(12));
    let transforms = [DAffine3::IDENTITY, skewed(1), skewed(2)];
    let rays = random_rays(3000, 3);
    for instanced in [false, true] {
        let world = world(&mesh, &transforms, instanced);
        let hits = closest(&world, &rays);
        let mut occluded = Vec::new();
        world.occluded(&rays, &Everything, &mut occluded);
        let mut found = 0;
        for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(occluded) {
            let expected = nearest_by_trying_all(world.parts(), ray);
            assert_eq!(hit.is_some(), expected.is_finite(), "{ray:?}");
            assert_eq!(occluded, hit.is_some(), "{ray:?}");
            if hit.is_some() {
                found += 1;
                assert!(
                    (f64::from(hit.t) - expected).abs() < 1e-6 * (4.0 + expected),
                    "{hit:?} {expected}"
                );
            }
        }
        assert!(found > 1000, "{found} hits");
    }
}

/// Each ray meets things where they are at its time.
#[test]
fn what_moves_is_found_where_it_is() {
    let (mesh, mut random) = (Arc::new(bumpy_sphere(12)), Random::new(8));
    let transforms = [skewed(1), skewed(2), skewed(4)];
    let motions = vec![Some(motion(&mut random)), None, Some(motion(&mut random))];
    let mut world = moving(&mesh, &transforms, true, motions);
    let mut rays = random_rays(3000, 3);
    rays.iter_mut().for_each(|ray| ray.time = random.unit() as f32);
    let (hits, mut occluded, mut found) = (closest(&world, &rays), Vec::new(), [0; 3]);
    world.occluded(&rays, &Everything, &mut occluded);
    for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(occluded) {
        let parts = (0..3).map(|surface| world.part(surface, ray.time).into_owned());
        let expected = nearest_by_trying_all(&parts.collect::<Vec<_>>(), ray);
        assert_eq!((hit.is_some(), occluded), (expected.is_finite(), expected.is_finite()));
        if hit.is_some() {
            found[hit.surface as usize] += 1;
            assert!((f64::from(hit.t) - expected).abs() < 1e-6 * (4.0 + expected), "{hit:?}");
        }
    }
    assert!(found.iter().all(|count| *count > 100), "{found:?}");
    for level in Level::all() {
        world = world.at_level(level);
        assert_eq!(closest(&world, &rays), hits, "{level:?}");
    }
}

/// Of things in the same place the one with the lower number is hit, in whatever order they are come to.
#[test]
fn equal_distances_are_ordered_by_identity() {
    let mesh = Arc::new(bumpy_sphere(12));
    for instanced in [false, true] {
        let world = world(&mesh, &[DAffine3::IDENTITY; 3], instanced);
        let hits = closest(&world, &random_rays(2000, 9));
        assert!(hits.iter().filter(|hit| hit.is_some()).count() > 100);
        assert!(hits.iter().all(|hit| !hit.is_some() || hit.surface == 0), "{instanced}");
    }
}

#[test]
fn every_level_gives_the_same_bits() {
    let mesh = Arc::new(bumpy_sphere(30));
    let rays = random_rays(20_000, 5);
    for instanced in [false, true] {
        let mut world = world(&mesh, &[skewed(1), skewed(2)], instanced);
        let expected = closest(&world, &rays);
        for level in Level::all() {
            world = world.at_level(level);
            assert_eq!(closest(&world, &rays), expected, "{level:?}");
        }
    }
}

/// Rays of a pinhole, and parallel ones, eight by eight close to each other.
fn coherent_rays() -> Vec<Ray> {
    let mut random = Random::new(11);
    let mut rays = Vec::new();
    for group in 0..3000 {
        let eye = DVec3::new(-4.0, 0.3, 0.7);
        let target = 1.4 * random.point();
        for _ in 0..8 {
            let shift = 0.02 * random.point();
            let (origin, toward) = if group % 2 == 0 {
                (eye, target + shift - eye)
            } else {
                (eye + target + shift, -eye)
            };
            let mut ray = Ray::new(origin.as_vec3(), toward.normalize().as_vec3());
            ray.t_min = if group % 5 == 0 { 4.0 } else { 0.0 };
            ray.t_max = if group % 7 == 0 { 4.2 } else { f32::INFINITY };
            rays.push(ray);
        }
    }
    rays
}

#[test]
fn rays_that_go_together_find_what_each_finds_alone() {
    let mesh = Arc::new(bumpy_sphere(30));
    let rays = coherent_rays();
    for instanced in [false, true] {
        for level in Level::all() {
            let transforms = [skewed(1), DAffine3::IDENTITY, skewed(2)];
            let world = world(&mesh, &transforms, instanced).at_level(level);
            let together = closest(&world, &rays);
            let alone: Vec<Hit> = rays.iter().flat_map(|ray| closest(&world, &[*ray])).collect();
            assert_eq!(together, alone, "{level:?}");
            assert!(together.iter().filter(|hit| hit.is_some()).count() > 10_000);
            let mut occluded = Vec::new();
            world.occluded(&rays, &Everything, &mut occluded);
            assert!(occluded.iter().zip(&alone).all(|(occluded, hit)| *occluded == hit.is_some()));
        }
    }
}

/// Every third primitive has a hole, for rays from one side.
struct Holes;

impl HitFilter for Holes {
    fn flags(&self) -> u32 {
        PARTLY_THERE
    }

    fn accepts(&self, _: &Ray, hit: &Hit, from_behind: bool) -> bool {
        from_behind || hit.primitive % 3 != 1
    }
}

/// Triangles of the world's own tree and of another, a ball and a plane without end.
fn world_of_all_kinds() -> World {
    let mesh = Arc::new(bumpy_sphere(30));
    let part = |seed, instanced, flags| {
        Part::Mesh(MeshPart::new(Arc::clone(&mesh), skewed(seed), instanced, flags))
    };
    let ball = Analytic::sphere(&Sphere::default(), &DAffine3::from_translation(DVec3::X));
    let plane = Analytic::plane(&Plane::default(), &DAffine3::from_translation(-2.5 * DVec3::Z));
    let parts = vec![
        part(1, false, PARTLY_THERE),
        part(2, true, 0),
        part(3, true, PARTLY_THERE),
        Part::Analytic(ball, PARTLY_THERE),
        Part::Analytic(plane, 0),
    ];
    World::build(parts, vec![None; 5], Level::detect(), BuildQuality::Final)
}

#[test]
fn rays_in_batches_of_all_sizes_find_what_each_finds_alone() {
    let mut rays = random_rays(3000, 17);
    for (i, ray) in rays.iter_mut().enumerate() {
        ray.t_min = if i % 5 == 0 { 3.0 } else { 0.0 };
        ray.t_max = if i % 7 == 0 { 4.5 } else { f32::INFINITY };
    }
    let mut world = world_of_all_kinds();
    let (mut alone, mut hits, mut occluded) = (Vec::new(), Vec::new(), Vec::new());
    for ray in &rays {
        world.closest_hits(&[*ray], &Holes, &mut hits);
        alone.push(hits[0]);
    }
    let met = |surface| alone.iter().filter(|hit| hit.surface == surface).count();
    assert!((0..5).all(|surface| met(surface) > 30));
    for level in Level::all() {
        world = world.at_level(level);
        for size in [1, 7, 9, 17, 64, 65, 1000, 3000] {
            for (rays, alone) in rays.chunks(size).zip(alone.chunks(size)) {
                world.closest_hits(rays, &Holes, &mut hits);
                assert_eq!(hits, alone, "{level:?}, {size}");
                world.occluded(rays, &Holes, &mut occluded);
                assert!(occluded.iter().zip(alone).all(|(any, hit)| *any == hit.is_some()));
            }
        }
    }
}

#[test]
fn the_range_of_a_ray_is_respected_exactly() {
    let world = world(&Arc::new(icosphere(2)), &[DAffine3::IDENTITY], false);
    for mut ray in random_rays(2000, 7) {
        let hit = closest(&world, &[ray])[0];
        if !hit.is_some() {
            continue;
        }
        ray.t_max = hit.t;
        assert_eq!(closest(&world, &[ray])[0], hit, "t_max is inside the range");
        ray.t_max = hit.t.next_down();
        assert!(!closest(&world, &[ray])[0].is_some(), "the range ends at t_max");
        ray = Ray { t_min: hit.t, t_max: f32::INFINITY, ..ray };
        assert!(closest(&world, &[ray])[0].t > hit.t, "t_min is outside the range");
    }
}

/// What makes case G05 mean something: a mesh with one triangle missing lets rays out.
#[test]
fn a_hole_of_one_triangle_is_found() {
    let mut mesh = icosphere(3);
    mesh.triangles.pop();
    let world = world(&Arc::new(mesh), &[DAffine3::IDENTITY], false);
    let mut random = Random::new(1);
    let rays: Vec<Ray> =
        (0..100_000).map(|_| Ray::new(Vec3::ZERO, random.direction().as_vec3())).collect();
    assert!(closest(&world, &rays).iter().any(|hit| !hit.is_some()));
}

/// A hundred thousand copies of a triangle cost no more than one, and the first of them is hit.
#[test]
fn equal_triangles_are_kept_once() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]; 100_000], ..Mesh::default() };
    let world = world(&Arc::new(mesh), &[DAffine3::IDENTITY], false);
    assert!(world.memory() < 10_000, "{} bytes", world.memory());
    let hit = closest(&world, &[Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z)])[0];
    assert_eq!((hit.t, hit.primitive), (1.0, 0));
}

/// Nodes far from the origin, planes along the axes, boxes without volume.
#[test]
fn flat_boxes_are_not_missed() {
    let mut mesh = Mesh::default();
    for i in 0..100_u32 {
        let x = i as f32;
        let base = mesh.positions.len() as u32;
        let corners = [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
        mesh.positions.extend(corners.map(|(x, y)| Vec3::new(x, y, 0.0)));
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    let world = world(&Arc::new(mesh), &[DAffine3::IDENTITY], false);
    let mut random = Random::new(4);
    let rays: Vec<Ray> = (0..100_000)
        .map(|i| {
            let x = if i % 2 == 0 { (i % 99 + 1) as f32 } else { 100.0 * random.unit() as f32 };
            Ray::new(Vec3::new(x, random.unit() as f32, 1.0), -Vec3::Z)
        })
        .collect();
    assert!(closest(&world, &rays).iter().all(Hit::is_some));
}

/// Trees that several threads build are those that one builds: nodes that are binned and cut in parallel, too.
#[test]
fn trees_do_not_depend_on_the_number_of_threads() {
    let mesh = Arc::new(bumpy_sphere(160));
    let built = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", world(&mesh, &[DAffine3::IDENTITY], false)))
    };
    assert!(mesh.triangles.len() > 40_000, "{} triangles", mesh.triangles.len());
    let one = built(1);
    for threads in [2, 5] {
        assert!(built(threads) == one, "{threads} threads");
    }
}
