//! Lights found by asking them, by meeting them, and by both.

use super::lights::{AimAll, Aims};
use super::{Onward, Path, PickAll, Scratch, Techniques, Vertices, Walk};
use crate::color::Rgb;
use crate::geometry::{Cone, Ray};
use crate::math::BLOCK;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::scene::description::*;
use crate::shading::bsdf::Matte;
use crate::simd::Level;
use crate::testing::Random;
use crate::verify::scenes::*;
use glam::{Vec2, Vec3};

const BOTH: Techniques = Techniques { lights: 1.0, bsdf: 1.0 };
const LIGHTS: Techniques = Techniques { lights: 1.0, bsdf: 0.0 };
const BSDF: Techniques = Techniques { lights: 1e-30, bsdf: 1.0 };

/// Mean radiance along a ray and its standard error, by independent sequences.
pub(super) fn measured(path: &Path, ray: &Ray, samples: u32) -> [f64; 2] {
    const SEQUENCES: u32 = 32;
    let mut scratch = Scratch::default();
    let mut means = Vec::new();
    for sequence in 0..SEQUENCES {
        let sampler = Sampler::new(sequence.into(), samples);
        let mut sum = 0.0;
        for start in (0..samples).step_by(1024) {
            let points: Vec<_> = (start..start + 1024).map(|i| sampler.points(0, 0, i)).collect();
            path.gather(&vec![*ray; points.len()], &points, &mut scratch, &mut ());
            sum += scratch.samples.iter().map(|s| f64::from(s.radiance.y)).sum::<f64>();
        }
        means.push(sum / f64::from(samples));
    }
    let n = f64::from(SEQUENCES);
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

/// How many standard errors two measurements are apart; `gain` plants an error in the second.
fn apart([a, a_error]: [f64; 2], [b, b_error]: [f64; 2], gain: f64) -> f64 {
    (gain * b - a) / a_error.hypot(b_error).max(1e-6 * a)
}

/// A ball of metal or matter on a floor, and what looks at both.
fn stage(material: Material) -> SceneDescription {
    let mut scene = scene_for_paths(0.6);
    scene.materials.push(material);
    add(&mut scene, floor());
    add_with(&mut scene, ball(v(0.0, 0.0, 0.6), 0.6), 3);
    scene
}

fn satin() -> Material {
    let facets = Facets::of(Scalar::constant(0.5));
    let scattering = Scattering::Conductor { index: None, facets };
    Material { scattering, ..Material::matte("satin", Rgb::splat(0.8)) }
}

fn smoke() -> Material {
    let mut smoke = clear(1.0, Rgb::splat(0.3));
    let interior = smoke.interior.as_mut().expect("it is filled");
    (interior.scattering, interior.anisotropy) = (Rgb::splat(1.5), 0.5);
    smoke
}

/// Every kind of light, over something matte, something glossy and something cloudy.
fn scenes() -> Vec<(String, Scene)> {
    let center = v(0.9, -0.6, 1.6);
    let disk = Disk { center, normal: v(-0.3, 0.2, -1.0).normalize(), radius: 0.5 };
    let (base, top) = (center, center + v(0.2, 0.6, 0.1));
    let corners = [center, center + v(0.0, 0.9, 0.2), center + v(0.9, 0.1, 0.3)];
    let positions = corners.map(|corner| corner.as_vec3()).to_vec();
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let shapes = [
        ("sphere", Some(ball(center, 0.4))),
        ("quad", Some(panel(center, 0.8, 1.1))),
        ("disk", Some(Shape::Disk(disk))),
        ("cylinder", Some(Shape::Cylinder(Cylinder { base, top, radius: 0.2, capped: true }))),
        ("triangle", None),
    ];
    let mut all = Vec::new();
    for (kind, material) in
        [("matte", Material::matte("m", Rgb::splat(0.5))), ("satin", satin()), ("smoke", smoke())]
    {
        for (name, shape) in &shapes {
            let mut scene = stage(material.clone());
            match shape {
                Some(shape) => add_with(&mut scene, shape.clone(), 1),
                None => {
                    add_mesh(&mut scene, mesh.clone());
                    scene.surfaces.last_mut().expect("it was added").material = 1;
                    scene.materials[1].emits_behind = true;
                }
            }
            all.push((format!("{name} over {kind}"), Scene::build(&scene)));
        }
        let mut scene = stage(material.clone());
        let [zenith, horizon, nadir] = [2.0, 0.5, 0.1].map(Rgb::splat);
        scene.environment = under(Sky::Gradient { zenith, horizon, nadir }, 1.0);
        all.push((format!("sky over {kind}"), Scene::build(&scene)));
        let mut scene = stage(material);
        let (direction, irradiance) = (v(-1.0, 0.5, -1.5).normalize(), Rgb::splat(3.0));
        light(&mut scene, Light::Sun { direction, irradiance, angular_radius: 0.3 });
        all.push((format!("sun over {kind}"), Scene::build(&scene)));
    }
    all
}

/// Asking lights alone, meeting them alone and both give the same; an error of a thousandth in one would be found.
#[test]
#[ignore = "the slow set: ten million paths"]
fn both_ways_to_find_lights_agree() {
    let target = v(0.15, -0.4, 0.9);
    let origin = v(1.0, -4.0, 1.8);
    let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
    let mut found = 0;
    for (name, scene) in scenes() {
        let by = |techniques| Path { techniques, ..Path::new(&scene, false, Some(2)) };
        let both = measured(&by(BOTH), &ray, 1 << 12);
        assert!(both[0] > 1e-3, "{name}: {both:?}");
        for techniques in [LIGHTS, BSDF] {
            let one = measured(&by(techniques), &ray, 1 << 12);
            let z = apart(both, one, 1.0);
            assert!(z.abs() < 4.5, "{name} {techniques:?}: {one:?} is not {both:?}, z = {z}");
            found += u32::from(apart(both, one, 1.001).abs() > 4.5 && z.abs() < 4.5);
        }
    }
    assert!(found > 0, "an error of a thousandth is not found");
}

/// Matte vertices around the middle of a scene, each of a walk of its own, and two numbers in 0..1 for each.
fn matte_vertices(count: u32) -> (Vec<Walk>, Vertices, Vec<Vec2>) {
    let (mut random, mut vertices) = (Random::new(4), Vertices::default());
    let mut numbers = |scale: f32| Vec3::from_array([0; 3].map(|_| scale * random.unit() as f32));
    for number in 0..count {
        let position = numbers(4.0) - 2.0;
        let normal = (numbers(2.0) - 1.0).normalize();
        let matte = Matte { normal, reflectance: numbers(1.0) };
        vertices.push_matte(number, [position, position + 1e-6 * normal], matte);
    }
    let pairs = (0..count).map(|_| numbers(1.0).truncate()).collect();
    ((0..count).map(|sample| Walk::from_eye(sample, 0.0)).collect(), vertices, pairs)
}

#[test]
fn matte_vertices_pick_in_blocks_what_each_picks_alone() {
    let (walks, vertices, pairs) = matte_vertices(1000);
    let mut onward = Onward::default();
    for level in Level::all() {
        for (number, (block, numbers)) in
            vertices.blocks().iter().zip(pairs.chunks(BLOCK)).enumerate()
        {
            level.run(PickAll { block, numbers, onward: &mut onward });
            for (k, &u) in numbers.iter().enumerate() {
                let alone = vertices.get(number * BLOCK + k, &walks).sample(0.5, u);
                let alone = alone.expect("something is scattered everywhere");
                assert_eq!((onward.incoming.get(k), onward.pdf[k]), (alone.incoming, alone.pdf));
                assert_eq!(onward.part[k], Cone::part(alone.pdf));
            }
        }
    }
}

/// From near and from afar, before and behind.
#[test]
fn matte_vertices_aim_in_blocks_at_what_each_aims_at_alone() {
    let (walks, vertices, pairs) = matte_vertices(1000);
    let mut found = 0;
    for shape in [ball(v(0.1, 0.2, 0.3), 0.4), panel(v(0.0, 0.0, 0.5), 0.4, 0.3)] {
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, shape, 1);
        let scene = Scene::build(&scene);
        let path = Path::new(&scene, false, None);
        let (light, mut aims) = (scene.area_lights.get(0), Aims::default());
        let emitted = scene.even_emission(light).expect("it is alike everywhere");
        for level in Level::all() {
            let blocks = vertices.blocks().iter().zip(pairs.chunks(BLOCK));
            for (number, (block, places)) in blocks.enumerate() {
                let techniques = path.techniques;
                level.run(AimAll { techniques, light, block, places, aims: &mut aims });
                for (k, &place) in places.iter().enumerate() {
                    let vertex = vertices.get(number * BLOCK + k, &walks);
                    let alone = path.light_from_area(&vertex, light, 1.0, place);
                    let together = aims.answer(k, light, vertex.start, emitted);
                    assert_eq!(together, alone, "{number} {k}");
                    found += u32::from(together.is_some());
                }
            }
        }
    }
    assert!(found > 500, "{found}");
}
