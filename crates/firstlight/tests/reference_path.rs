//! Reference cases of lights with an extent and of light that bounces, by the path integrator. The names are those of
//! the project's table of reference values; so are the tolerances: 0.2 %, with a standard error of at most 0.1 %.

mod common;

use common::*;
use firstlight::scene::description::*;
use firstlight::{Measurement, Meter, Ray, Scene, SceneDescription};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A scene for paths of any length. Material 0 reflects `reflectance`, material 1 emits 1 to its front and reflects
/// nothing, material 2 is black.
fn scene_for_paths(reflectance: f32) -> SceneDescription {
    let mut scene = scene_of(Vec3::splat(reflectance));
    scene.integrator = Integrator::Path { bounces: None };
    scene.materials.push(emitter(1.0, 0.0));
    scene.materials.push(Material::matte("black", Vec3::ZERO));
    scene
}

/// Emits to its front and reflects.
fn emitter(radiance: f32, reflectance: f32) -> Material {
    let emission = Texture::constant(Vec3::splat(radiance));
    let matte = Material::matte("emitter", Vec3::splat(reflectance));
    Material { emission, emits_behind: false, ..matte }
}

/// Both sides emit and reflect.
fn glowing(radiance: f32, reflectance: f32) -> Material {
    Material { emits_behind: true, ..emitter(radiance, reflectance) }
}

fn mirror(mirrored: f32) -> Material {
    Material::mirror("mirror", Vec3::splat(mirrored))
}

fn add_with(scene: &mut SceneDescription, shape: Shape, material: usize) {
    add(scene, shape);
    scene.surfaces.last_mut().expect("just added").material = material;
}

/// A rectangle from a corner; its front is where u × v points.
fn quad(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Shape {
    Shape::Quad(Quad { corner, edge_u, edge_v })
}

/// A horizontal rectangle around `center` that faces down.
fn panel(center: DVec3, width: f64, depth: f64) -> Shape {
    quad(center - v(width / 2.0, depth / 2.0, 0.0), v(0.0, depth, 0.0), v(width, 0.0, 0.0))
}

fn ball(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere { center, radius })
}

fn uniform(radiance: f32) -> Option<EnvironmentDescription> {
    under(Sky::Uniform, radiance)
}

fn under(sky: Sky, factor: f32) -> Option<EnvironmentDescription> {
    let (rotation, factor) = (DQuat::IDENTITY, Vec3::splat(factor));
    Some(EnvironmentDescription { sky, factor, rotation, visible: true })
}

/// Takes samples until the standard error is small enough, then asks whether the value is right.
#[track_caller]
fn expect(measure: impl Fn(u32) -> Measurement, expected: f64) {
    let known = |m: &Measurement| f64::from(m.standard_error.x) <= 1e-3 * expected;
    let mut tries = (12..=24).step_by(2).map(|k| measure(1 << k)).filter(known);
    let measured = tries.next().expect("the standard error falls to 0.1 %");
    let (value, error) = (f64::from(measured.value.x), f64::from(measured.standard_error.x));
    // Neither rounding nor what is found once in a million samples shows in the standard error.
    let off = (value - expected).abs();
    assert!(off <= 4.0 * error + 3e-5 * expected, "{value} ± {error} is not {expected}");
}

#[track_caller]
fn expect_facing(scene: &Scene, at: DVec3, normal: DVec3, expected: f64) {
    expect(|samples| Meter::new(scene).samples(samples).irradiance(at, normal), expected);
}

#[track_caller]
fn expect_up(scene: &SceneDescription, at: DVec3, expected: f64) {
    expect_facing(&Scene::build(scene), at, DVec3::Z, expected);
}

#[track_caller]
fn expect_seen(scene: &SceneDescription, origin: DVec3, target: DVec3, expected: f64) {
    let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
    let scene = Scene::build(scene);
    expect(|samples| Meter::new(&scene).samples(samples).radiance(&ray), expected);
}

#[test]
fn a01_a02_a14_square_light() {
    for (height, x, y, expected) in [
        (1.0, 0.0, 0.0, 0.752274688),
        (1.0, 0.5, 0.0, 0.566645112),
        (1.0, 1.5, 0.5, 0.0906142259),
        (1.0, 4.0, -2.0, 0.00233614264),
        (0.1, 0.0, 0.0, 3.04212844),
        (1e-2, 0.0, 0.0, 3.14056468),
        (1e-3, 0.0, 0.0, 3.14158237),
    ] {
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, panel(DVec3::Z * height, 1.0, 1.0), 1);
        expect_up(&scene, v(x, y, 0.0), expected);
        // As a mesh and as seen on a floor.
        scene.surfaces.clear();
        let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)];
        let positions = corners.map(|(x, y)| Vec3::new(x, y, height as f32)).to_vec();
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        add_mesh(&mut scene, Mesh { positions, triangles, ..Mesh::default() });
        scene.surfaces[0].material = 1;
        add(&mut scene, floor());
        let eye = v(x, y, 0.0) + 0.5 * height * v(0.1, 0.2, 1.0);
        expect_seen(&scene, eye, v(x, y, 0.0), 0.5 / PI * expected);
    }
}

#[test]
fn a04_light_cut_by_the_horizon() {
    let mut scene = scene_for_paths(0.5);
    let corner = v(1.0, -1.0, -1.0);
    add_with(&mut scene, quad(corner, v(0.0, 0.0, 2.0), v(0.0, 2.0, 0.0)), 1);
    expect_up(&scene, DVec3::ZERO, 0.350188288);
}

#[test]
fn a06_triangles_of_nori() {
    let triangles = [
        [
            [-0.443432, 0.596366, 0.495985],
            [-0.320397, 0.0677699, -0.229359],
            [0.0341197, 0.11415, -0.343049],
        ],
        [
            [0.461963, 0.397843, 0.412747],
            [-0.0381582, 0.851323, -0.156872],
            [0.195443, 0.891957, -0.260672],
        ],
        [
            [0.100871, 0.289075, -0.422609],
            [-0.308386, 0.629587, 0.423966],
            [-0.373132, 0.237287, 0.351592],
        ],
        [
            [-0.17575, 0.639397, 0.151268],
            [0.318604, 0.732996, 0.459771],
            [0.139095, 0.294498, 0.478556],
        ],
        [
            [-0.17487, 0.447916, 0.367201],
            [-0.405259, 0.249607, -0.354079],
            [0.356029, 0.0918984, -0.132271],
        ],
    ];
    let expected = [0.0898392585, 0.0229200404, 0.0534195402, 0.0205313915, 0.261739859];
    for (corners, expected) in triangles.into_iter().zip(expected) {
        let mut scene = scene_for_paths(0.5);
        scene.materials[1].emits_behind = true;
        let positions = corners.map(Vec3::from_array).to_vec();
        add_mesh(&mut scene, Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() });
        scene.surfaces[0].material = 1;
        let scene = Scene::build(&scene);
        expect_facing(&scene, DVec3::ZERO, DVec3::Y, 2.0 * PI * expected);
    }
}

#[test]
fn a08_a09_disk_light() {
    let mut scene = scene_for_paths(0.5);
    add_with(
        &mut scene,
        Shape::Disk(Disk { center: v(0.0, 0.0, 2.0), normal: -DVec3::Z, radius: 1.0 }),
        1,
    );
    for (x, expected) in [
        (0.0, 0.628318531),
        (0.5, 0.580263748),
        (1.0, 0.460075592),
        (2.0, 0.206963188),
        (5.0, 0.0157872984),
    ] {
        expect_up(&scene, v(x, 0.0, 0.0), expected);
    }
}

#[test]
fn a11_a12_sphere_light() {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, ball(v(0.0, 0.0, 2.0), 0.5), 1);
    let built = Scene::build(&scene);
    for (degrees, expected) in [
        (0.0, 0.196349541),
        (30.0, 0.17004369),
        (60.0, 0.0981747704),
        (80.0, 0.0347227199),
        (85.0, 0.020999724),
        (90.0, 0.010618796),
        (95.0, 0.00388673396),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        expect_facing(&built, DVec3::ZERO, v(sin, 0.0, cos), expected);
    }
}

#[test]
fn a16_a_one_sided_light_leaves_its_back_dark() {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, panel(DVec3::Z, 1.0, 1.0), 1);
    let built = Scene::build(&scene);
    assert_eq!(built.irradiance(v(0.1, 0.2, 1.5), -DVec3::Z).value, Vec3::ZERO);
    let down = Ray::new(Vec3::new(0.1, 0.2, 1.5), -Vec3::Z);
    assert_eq!(built.radiance(&down).value, Vec3::ZERO);
    scene.materials[1].emits_behind = true;
    assert!(Scene::build(&scene).irradiance(v(0.1, 0.2, 1.5), -DVec3::Z).value.x > 1.0);
}

/// All the power of a light arrives on a black sphere around it.
#[test]
fn a17_power_of_a_rectangle() {
    for (behind, expected) in [(false, 9.42477796), (true, 18.8495559)] {
        let mut scene = scene_for_paths(0.0);
        scene.materials[1] = Material { emits_behind: behind, ..emitter(3.0, 0.0) };
        add_with(&mut scene, panel(DVec3::ZERO, 2.0, 0.5), 1);
        let built = Scene::build(&scene);
        let (rows, mut sum) = (12, 0.0);
        for cell in 0..2 * rows * rows {
            let z = (f64::from(cell % rows) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            let phi = f64::from(cell / rows) / f64::from(rows) * PI;
            let r = (1.0 - z * z).sqrt();
            let outward = v(r * phi.cos(), r * phi.sin(), z);
            let meter = Meter::new(&built).samples(256);
            sum += f64::from(meter.irradiance(20.0 * outward, -outward).value.x);
        }
        close(sum / f64::from(2 * rows * rows) * 4.0 * PI * 400.0, expected, 2e-3);
    }
}

#[test]
fn a18_penumbra() {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, panel(DVec3::Z * 2.0, 1.0, 1.0), 1);
    let half_plane = quad(v(-1e3, -1e3, 1.0), v(1e3, 0.0, 0.0), v(0.0, 2e3, 0.0));
    add_with(&mut scene, half_plane, 2);
    let built = Scene::build(&scene);
    for (x, expected) in [
        (-0.4, 0.0173307475),
        (-0.2, 0.0623127132),
        (0.0, 0.115418399),
        (0.2, 0.164630353),
        (0.4, 0.198460368),
        (0.5, 0.207918813),
        (0.6, 0.198828598),
    ] {
        expect_facing(&built, v(x, 0.0, 0.0), DVec3::Z, expected);
    }
    assert_eq!(built.irradiance(v(-0.6, 0.0, 0.0), DVec3::Z).value, Vec3::ZERO);
}

/// Mean of a picture that shows exactly a unit square of reflectance 0.5 in z = 0.
fn mean_of_square(scene: &mut SceneDescription, corner: DVec3) -> f64 {
    add(scene, quad(corner, DVec3::X, DVec3::Y));
    let middle = corner + v(0.5, 0.5, 0.0);
    let view = Projection::Orthographic { height: 1.0 };
    scene.cameras.push(camera(middle + v(0.0, 0.0, 0.1), middle, view));
    let filter = Filter::Box { radius: 0.5 };
    scene.film =
        FilmDescription { width: 32, height: 32, samples: 64, filter, ..scene.film.clone() };
    let image = picture(scene).image;
    image.pixels().iter().map(|p| f64::from(p[0])).sum::<f64>() / 1024.0
}

#[test]
fn f01_form_factor_of_parallel_squares() {
    for (distance, expected) in [(0.5, 0.415253284), (1.0, 0.199824896), (2.0, 0.0685895888)] {
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, panel(v(0.5, 0.5, distance), 1.0, 1.0), 1);
        close(mean_of_square(&mut scene, DVec3::ZERO) / 0.5, expected, 2e-3);
    }
}

#[test]
fn f02_form_factor_of_squares_with_an_edge_in_common() {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, quad(DVec3::ZERO, DVec3::Z, DVec3::X), 1);
    close(mean_of_square(&mut scene, DVec3::ZERO) / 0.5, 0.200043776, 2e-3);
}

/// F04 as the flux through the disk by reciprocity: what the disk sees of the sphere.
#[test]
fn f04_form_factor_from_sphere_to_disk() {
    for (distance, expected) in [(1.0, 0.146446609), (0.5, 0.276393202)] {
        let radius = 0.4;
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, ball(v(0.0, 0.0, distance), radius), 1);
        let built = Scene::build(&scene);
        let (rings, mut sum) = (64, 0.0);
        for ring in 0..rings {
            let r = ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
            let meter = Meter::new(&built).samples(4096);
            sum += f64::from(meter.irradiance(v(r, 0.0, 0.0), DVec3::Z).value.x);
        }
        let flux = sum / f64::from(rings) * PI;
        close(flux / (PI * 4.0 * PI * radius * radius), expected, 2e-3);
    }
}

#[test]
fn e01_e02_uniform_sky() {
    let mut scene = scene_for_paths(0.18);
    scene.environment = uniform(1.0);
    expect_up(&scene, DVec3::ZERO, PI);
    add(&mut scene, floor());
    expect_seen(&scene, v(0.3, 0.2, 1.0), DVec3::ZERO, 0.18);
    let wall = Plane { point: v(0.0, 1e-9, 0.0), normal: DVec3::Y };
    add_with(&mut scene, Shape::Plane(wall), 2);
    expect_up(&scene, v(0.0, -1e-6, 0.0), PI / 2.0);
}

#[test]
fn e03_tilted_under_half_a_sky() {
    let texels = Texels::Linear(vec![[1.0; 4], [0.0, 0.0, 0.0, 1.0]]);
    let pixels = Arc::new(Pixels { name: "sky".into(), width: 1, height: 2, texels });
    let mut scene = scene_for_paths(0.5);
    scene.environment = under(Sky::Picture { pixels, sampling: Sampling::Nearest }, 1.0);
    let built = Scene::build(&scene);
    for (degrees, expected) in
        [(0.0, PI), (30.0, 2.93114585), (60.0, 2.35619449), (90.0, PI / 2.0), (135.0, 0.460075592)]
    {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        expect_facing(&built, DVec3::ZERO, v(sin, 0.0, cos), expected);
    }
    assert_eq!(built.irradiance(DVec3::ZERO, -DVec3::Z).value, Vec3::ZERO);
}

#[test]
fn e04_sky_between_two_walls() {
    let mut scene = scene_for_paths(0.5);
    scene.environment = uniform(1.0);
    for x in [-0.5, 0.5] {
        add_with(&mut scene, quad(v(x, -1e4, 0.0), v(0.0, 2e4, 0.0), DVec3::Z), 2);
    }
    expect_up(&scene, v(0.0, 0.0, 0.0), 1.40496295);
}

#[test]
fn e06_sphere_on_a_plane() {
    let mut scene = scene_for_paths(0.5);
    scene.environment = uniform(1.0);
    add_with(&mut scene, ball(DVec3::Z, 1.0), 2);
    let built = Scene::build(&scene);
    for (x, expected) in [
        (0.25, 0.273082017),
        (0.5, 0.89365194),
        (1.0, 2.03087192),
        (2.0, 2.86060006),
        (4.0, 3.09677217),
    ] {
        expect_facing(&built, v(x, 0.0, 0.0), DVec3::Z, expected);
    }
}

#[test]
fn e10_overcast_sky() {
    let (horizon, zenith) = (Vec3::splat(1.0 / 3.0), Vec3::ONE);
    let mut scene = scene_for_paths(0.5);
    scene.environment = under(Sky::Gradient { zenith, horizon, nadir: Vec3::ZERO }, 1.0);
    expect_up(&scene, DVec3::ZERO, 7.0 * PI / 9.0);
    // From the side, the lower half shows a ground that falls from 1/3 to 0.
    let lower = PI / 6.0 - 2.0 / 9.0;
    expect_facing(&Scene::build(&scene), DVec3::ZERO, DVec3::X, 0.96804322 + lower);
}

#[test]
fn e12_hot_texel() {
    let texel = |i: u32| if i == 5 * 64 + 20 { [1000.0; 4] } else { [0.0; 4] };
    let texels = Texels::Linear((0..64 * 32).map(texel).collect());
    let pixels = Arc::new(Pixels { name: "sky".into(), width: 64, height: 32, texels });
    let mut scene = scene_for_paths(0.5);
    scene.environment = under(Sky::Picture { pixels, sampling: Sampling::Nearest }, 1.0);
    expect_up(&scene, DVec3::ZERO, 4.24328049);
}

/// Half of a sun of 60° is above the horizon; the edge of a half plane cuts another in two.
#[test]
fn suns_are_cut_by_horizons_and_edges() {
    let mut scene = scene_for_paths(0.5);
    let sun = |direction: DVec3, degrees: f64| Light::Sun {
        direction,
        irradiance: Vec3::splat(10.0),
        angular_radius: degrees.to_radians(),
    };
    light(&mut scene, sun(-DVec3::X, 30.0));
    // ∫ cos over half a cone around the horizon: as A12 at 90°, for sin 30° = 1/2.
    let (s, half) = (PI / 6.0, 0.5);
    let lit = (s - half * s.cos()) / (PI * half * half);
    expect_up(&scene, DVec3::ZERO, 10.0 * lit);
    scene.lights[0].light = sun(-DVec3::Z, 0.265);
    expect_up(&scene, DVec3::ZERO, 10.0);
    add_with(&mut scene, quad(v(0.0, -1e3, 2.0), v(1e3, 0.0, 0.0), v(0.0, 2e3, 0.0)), 2);
    expect_up(&scene, DVec3::ZERO, 5.0);
    let rim = 2.0 * 0.265_f64.to_radians().tan();
    expect_up(&scene, v(-1.01 * rim, 0.0, 0.0), 10.0);
    assert_eq!(
        Scene::build(&scene).irradiance(v(1.01 * rim, 0.0, 0.0), DVec3::Z).value,
        Vec3::ZERO
    );
}

/// The inside of the lower half of a sphere.
fn bowl() -> Mesh {
    let (rows, columns) = (256, 512);
    let mut mesh = Mesh::default();
    for i in 0..=rows * columns {
        let (row, column) = (i / columns, i % columns);
        let theta = 0.5 * PI * f64::from(row) / f64::from(rows);
        let phi = 2.0 * PI * f64::from(column) / f64::from(columns);
        let (sin, cos) = theta.sin_cos();
        let (across, z) = if row == rows { (0.0, -1.0) } else { (cos, -sin) };
        mesh.positions.push(v(across * phi.cos(), across * phi.sin(), z).as_vec3());
    }
    for row in 0..rows {
        for column in 0..columns {
            let at =
                |r: u32, c: u32| if r == rows { rows * columns } else { r * columns + c % columns };
            let (a, b) = (at(row, column), at(row, column + 1));
            mesh.triangles.push([a, b, at(row + 1, column)]);
            if row + 1 < rows {
                mesh.triangles.push([b, at(row + 1, column + 1), at(row + 1, column)]);
            }
        }
    }
    mesh
}

#[test]
fn e08_bowl_under_the_sky() {
    for (reflectance, expected) in [(0.2, 0.111111111), (0.5, 0.333333333), (0.8, 0.666666667)] {
        let mut scene = scene_for_paths(reflectance);
        scene.environment = uniform(1.0);
        add_mesh(&mut scene, bowl());
        for target in [v(0.1, 0.05, -1.0), v(0.8, 0.1, -0.59)] {
            expect_seen(&scene, v(-0.1, 0.2, 0.5), target, expected);
        }
    }
}

#[test]
fn c01_c02_furnace_around_convex_things() {
    for reflectance in [0.18, 0.5, 0.8, 1.0] {
        let mut scene = scene_for_paths(reflectance);
        scene.environment = uniform(1.0);
        add(&mut scene, ball(DVec3::ZERO, 1.0));
        expect_seen(&scene, v(3.0, 2.0, 1.0), v(0.3, 0.2, 0.5), reflectance.into());
        scene.surfaces[0].shape = cube(DVec3::ZERO, 1.0);
        expect_seen(&scene, v(3.0, 2.0, 1.0), v(0.3, 0.2, 0.3), reflectance.into());
    }
}

#[test]
fn c03_inside_a_glowing_sphere() {
    let mut scene = scene_for_paths(0.5);
    scene.materials[0] = glowing(0.5, 0.5);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    expect_seen(&scene, v(0.2, 0.1, -0.3), v(1.0, 2.0, 3.0), 1.0);
}

fn inside_a_glowing_box(reflectances: &[(f32, f64)]) {
    for &(reflectance, expected) in reflectances {
        let mut scene = scene_for_paths(0.0);
        scene.materials[0] = glowing(1.0, reflectance);
        add(&mut scene, cube(DVec3::ZERO, 2.0));
        expect_seen(&scene, v(0.2, 0.1, -0.3), v(1.0, 2.0, 3.0), expected);
    }
}

#[test]
fn c04_inside_a_glowing_box() {
    inside_a_glowing_box(&[(0.0, 1.0), (0.5, 2.0), (0.8, 5.0)]);
}

#[test]
#[ignore = "the slow set: light of hundreds of reflections"]
fn c04_inside_a_glowing_box_that_loses_hardly_anything() {
    inside_a_glowing_box(&[(0.95, 20.0), (0.99, 100.0)]);
}

/// A depth counts reflections.
#[test]
fn c05_box_with_few_reflections() {
    for (bounces, expected) in
        [(0, 1.0), (1, 1.8), (2, 2.44), (3, 2.952), (5, 3.68928), (8, 4.32891136)]
    {
        let mut scene = scene_for_paths(0.0);
        scene.integrator = Integrator::Path { bounces: Some(bounces) };
        scene.materials[0] = glowing(1.0, 0.8);
        add(&mut scene, cube(DVec3::ZERO, 2.0));
        expect_seen(&scene, v(0.2, 0.1, -0.3), v(1.0, 2.0, 3.0), expected);
    }
}

#[test]
fn c06_box_of_matte_mirrors() {
    let mut scene = scene_for_paths(0.0);
    scene.materials[0] = Material { scattering: mirror(0.5).scattering, ..glowing(0.25, 0.25) };
    add(&mut scene, cube(DVec3::ZERO, 2.0));
    expect_seen(&scene, v(0.2, 0.1, -0.3), v(1.0, 2.0, 3.0), 1.0);
}

#[test]
fn c07_c08_point_light_inside_a_sphere() {
    let intensity = |i: f64| Vec3::splat(i as f32);
    let mut scene = scene_for_paths(0.5);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    light(&mut scene, Light::Point { position: DVec3::ZERO, intensity: intensity(PI) });
    expect_seen(&scene, v(0.2, 0.1, -0.3), v(1.0, 2.0, 3.0), 1.0);
    scene.lights.clear();
    light(&mut scene, Light::Point { position: v(0.0, 0.0, 0.6), intensity: intensity(1.0) });
    for (degrees, expected) in [
        (0.0, 1.15387334),
        (60.0, 0.327305296),
        (90.0, 0.259503647),
        (120.0, 0.234556337),
        (180.0, 0.221324843),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        expect_seen(&scene, v(0.1, 0.2, 0.1), v(sin, 0.0, cos), expected);
    }
}

#[test]
fn c11_parallel_plates_between_mirrors() {
    let mut scene = scene_for_paths(0.6);
    scene.materials[1] = emitter(1.0, 0.3);
    scene.materials.push(mirror(1.0));
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    add_with(&mut scene, quad(DVec3::ZERO, x, y), 1);
    add_with(&mut scene, quad(z, y, x), 0);
    for (corner, u) in [(DVec3::ZERO, x), (y, x), (DVec3::ZERO, y), (x, y)] {
        add_with(&mut scene, quad(corner, u, z), 3);
    }
    expect_seen(&scene, v(0.4, 0.3, 0.6), v(0.7, 0.6, 0.0), 1.2195122);
    expect_seen(&scene, v(0.4, 0.3, 0.6), v(0.7, 0.6, 1.0), 0.731707317);
}

#[test]
fn c13_concentric_spheres() {
    let mut scene = scene_for_paths(0.7);
    scene.materials[1] = emitter(1.0, 0.4);
    add_with(&mut scene, ball(DVec3::ZERO, 0.5), 1);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    expect_seen(&scene, v(0.0, 0.7, 0.1), v(0.0, 0.4, 0.1), 1.17283951);
    expect_seen(&scene, v(0.0, 0.7, 0.1), v(0.2, 1.0, 0.1), 0.432098765);
}

#[test]
fn c15_two_squares() {
    let mut scene = scene_for_paths(0.5);
    scene.materials[1] = emitter(1.0, 0.5);
    add_with(&mut scene, quad(DVec3::ZERO, DVec3::X, DVec3::Y), 1);
    add(&mut scene, quad(DVec3::Z, DVec3::Y, DVec3::X));
    let eye = v(0.6, 0.7, 0.4);
    let in_corner = 1.0 - 1e-6;
    for (target, expected) in [
        (v(0.5, 0.5, 0.0), 1.01232676),
        (v(in_corner, in_corner, 0.0), 1.00700635),
        (v(0.5, 0.5, 1.0), 0.120976802),
        (v(in_corner, in_corner, 1.0), 0.0699750448),
    ] {
        expect_seen(&scene, eye, target, expected);
    }
}

/// The eye looks down a corridor of two mirrors at an emitter behind k reflections.
#[test]
fn c17_corridor_of_mirrors() {
    for k in [1, 2, 5, 10, 50] {
        let mut scene = scene_for_paths(0.0);
        scene.materials.push(mirror(0.9));
        scene.materials[1].emits_behind = true;
        // A ray that rises by 0.1 from mirror to mirror leaves after k of them.
        let end = 0.1 * f64::from(k) + 0.05;
        for x in [0.0, 1.0] {
            add_with(
                &mut scene,
                quad(v(x, -1.0, -1.0), v(0.0, 2.0, 0.0), v(0.0, 0.0, 1.0 + end)),
                3,
            );
        }
        add_with(&mut scene, quad(v(-9.0, -9.0, end + 0.1), 18.0 * DVec3::X, 18.0 * DVec3::Y), 1);
        expect_seen(&scene, v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.1), 0.9_f64.powi(k));
    }
}

/// C21 as far as matte surfaces and mirrors go: in a room where everything sends out what it does not reflect, nothing
/// can be told apart.
#[test]
fn c21_isothermal_room() {
    let mut scene = scene_for_paths(0.0);
    scene.materials = [0.2, 0.5, 0.9].map(|r| glowing(1.0 - r, r)).to_vec();
    scene.materials.push(Material { scattering: mirror(0.6).scattering, ..glowing(0.3, 0.1) });
    add_with(&mut scene, cube(DVec3::ZERO, 2.0), 1);
    add_with(&mut scene, ball(v(0.3, 0.2, -0.5), 0.4), 0);
    add_with(&mut scene, ball(v(-0.4, 0.1, 0.3), 0.3), 3);
    let base = v(-0.3, -0.6, -1.0);
    let cylinder = Cylinder { base, top: base + v(0.1, 0.0, 0.8), radius: 0.2, capped: true };
    add_with(&mut scene, Shape::Cylinder(cylinder), 2);
    let cone = Cone { base: v(0.6, 0.6, -1.0), apex: v(0.6, 0.6, 0.2), radius: 0.2, capped: false };
    add_with(&mut scene, Shape::Cone(cone), 2);
    let disk =
        Disk { center: v(0.5, -0.5, 0.2), normal: v(1.0, 1.0, 1.0).normalize(), radius: 0.3 };
    add_with(&mut scene, Shape::Disk(disk), 3);
    let mesh = Mesh {
        positions: vec![
            Vec3::new(-0.9, 0.4, -0.8),
            Vec3::new(0.1, 0.8, -0.9),
            Vec3::new(-0.5, 0.9, 0.6),
        ],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    add_mesh(&mut scene, mesh);
    scene.surfaces.last_mut().expect("a mesh").transform = DAffine3::from_rotation_x(0.3);
    let view = Projection::Perspective { vertical_fov: 2.0 };
    scene.cameras.push(camera(v(-0.9, -0.9, 0.8), v(0.2, 0.2, -0.3), view));
    scene.film = FilmDescription { width: 64, height: 64, samples: 64, ..scene.film };
    let image = picture(&scene).image;
    // Every path gathers nearly the same: what deviates by more than its share is wrong.
    let values: Vec<f64> = image.pixels().iter().map(|p| f64::from(p[0])).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    close(mean, 1.0, 1e-3);
    let worst = values.iter().map(|x| (x - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 0.15, "{worst}");
}
