use super::*;
use crate::color::luminance;
use crate::scene::description::{
    Alpha, BumpAmount, CameraLightAmount, ComplexIndex, Exposure, Filter, Integrator, Light,
    LightDescription, Medium, Pattern, Projection, Sampling, Scalar, Scattering, Shape, Sky, Wrap,
};
use glam::{DVec3, Vec2};
use std::f64::consts::PI;
use std::path::Path;

/// A triangle of glass that leaves half of the light after 2.
const GLASS: &str = r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
    "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
    "materials": [{ "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_volume": {
        "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.5, 0.5] } } }],
    "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] }],
    "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    "buffers": [{ "byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }] }"#;

fn scene_with(text: &str, overrides: &[&str]) -> Result<SceneDescription> {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    image::RgbaImage::new(1, 1).save(file("wood.png")).unwrap();
    image::RgbaImage::from_pixel(4, 2, image::Rgba([255; 4])).save(file("sky.png")).unwrap();
    let lamp = "TILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 20\n0 180\n0\n100 100\n";
    std::fs::write(file("lamp.ies"), lamp).unwrap();
    std::fs::write(file("bad.ies"), lamp.replace("1000", "many")).unwrap();
    std::fs::write(file("glass.gltf"), GLASS).unwrap();
    let access = FileAccess::beside(&file("scene.toml"), &[]);
    let overrides = overrides.iter().map(|o| o.parse()).collect::<Result<Vec<_>>>()?;
    read(text, "scene.toml", &overrides, &access, &mut Warnings::new())
}

fn scene(text: &str) -> SceneDescription {
    scene_with(text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The first line of the error.
fn complaint(text: &str) -> String {
    complaint_with(text, &[])
}

fn complaint_with(text: &str, overrides: &[&str]) -> String {
    let error = scene_with(text, overrides).expect_err("an error").to_string();
    error.lines().next().unwrap_or_default().to_owned()
}

#[test]
fn the_examples_of_the_reference_are_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let reference = std::fs::read_to_string(folder.join("docs/scene-format.md")).unwrap();
    let examples: Vec<&str> =
        reference.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(examples.len(), 14);
    for example in &examples {
        let document =
            Document { name: "example", text: example, overrides: &[], generated: false };
        document.read::<SceneKeys>().unwrap_or_else(|error| panic!("{error}"));
        // The one with a model would need the model.
        if !example.contains("[models.") {
            scene(example);
        }
    }
    let first = std::fs::read_to_string(folder.join("scenes/first.toml")).unwrap();
    assert_eq!(examples[0], first);
}

/// Of one file in two units, and larger by its transform: that changes the shape, not what it is made of.
#[test]
fn what_models_absorb_is_in_their_unit() {
    let scene = scene(
        "models.m = { file = 'glass.gltf' }
         models.mm = { file = 'glass.gltf', unit = 'mm', transform = [{ scale = 10 }] }",
    );
    let absorbed = |name: &str| {
        let surface = scene.surfaces.iter().find(|s| s.name.starts_with(name)).unwrap();
        f64::from(scene.materials[surface.material].interior.unwrap().absorption.x)
    };
    let per_length = 0.5 * 2.0_f64.ln();
    assert!((absorbed("m/") / per_length - 1.0).abs() < 1e-6);
    assert!((absorbed("mm/") / (1000.0 * per_length) - 1.0).abs() < 1e-6);
}

#[test]
fn solids_of_principled_are_those_that_light_gets_into() {
    let is_solid = |keys: &str| {
        let text = format!("materials.m.principled = {{ attenuation_color = 'red', {keys} }}");
        scene(&text).materials.iter().any(|material| material.interior.is_some())
    };
    assert!(!is_solid("solid = true"));
    assert!(is_solid("transmission = 0.5"));
    assert!(is_solid("diffuse_transmission = 0.5"));
}

#[test]
fn an_empty_file_is_a_scene_of_defaults() {
    let empty = scene("");
    assert_eq!((empty.cameras.len(), empty.surfaces.len(), empty.lights.len()), (0, 0, 0));
    assert_eq!(empty.film, Default::default());
    assert_eq!(empty.luminous_efficacy, Default::default());
}

#[test]
fn a_small_scene_arrives_whole() {
    let scene = scene(
        "up = 'y'
        background = '#fff'
        camera.orthographic = { position = [0, 3, 0], height = '50 cm' }
        cameras.side.thin_lens = { position = [3, 0, 0], aperture = '5 mm' }
        film = { resolution = [10, 20], samples = 3, filter = 'box', exposure = 'auto', seed = 7 }
        [materials.red.lambert]
        reflectance = [0.5, 0.25, 0.125]
        alpha_cutoff = 0.5
        [surfaces.ball]
        sphere = { center = [0, 0, 1], radius = 2 }
        material = 'red'
        transform = [{ scale = 2 }, { rotate_z = 90 }, { translate = [0, 0, 1] }]
        [surfaces.floor.plane]",
    );
    assert_eq!(scene.background, Rgb::ONE);
    assert_eq!(scene.cameras[0].name, "camera");
    assert_eq!(scene.cameras[0].up, DVec3::NEG_Z, "seen from above, -z is up where y is");
    assert_eq!(scene.cameras[0].projection, Projection::Orthographic { height: 0.5 });
    let lens = Projection::ThinLens {
        vertical_fov: 40_f64.to_radians(),
        aperture: 0.005,
        focus_distance: 3.0,
    };
    assert_eq!((scene.cameras[1].name.as_str(), scene.cameras[1].projection), ("side", lens));
    assert_eq!((scene.film.width, scene.film.height, scene.film.samples), (10, 20, 3));
    assert_eq!((scene.film.filter, scene.film.seed), (Filter::Box { radius: 0.5 }, 7));
    assert_eq!(scene.film.exposure, Exposure::Auto);
    assert_eq!(scene.materials[0].reflectance.factor, [0.5, 0.25, 0.125, 1.0]);
    assert_eq!(scene.materials[0].alpha, Alpha::Mask { cutoff: 0.5 });
    let [ball, floor] = scene.surfaces.as_slice() else { panic!("two surfaces") };
    assert_eq!((ball.material, floor.material), (0, 1), "the floor has the default grey");
    // (1, 0, 0): doubled, turned to +y, lifted.
    let moved = ball.transform.transform_point3(DVec3::X);
    assert!(moved.abs_diff_eq(DVec3::new(0.0, 2.0, 1.0), 1e-12), "{moved}");
    assert!(matches!(&floor.shape, Shape::Plane(plane) if plane.normal == DVec3::Z));
}

#[test]
fn every_matrix_row_is_an_output_coordinate() {
    let rows = "[[0, 2, 0, 5], [1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1]]";
    let text = format!("surfaces.a = {{ sphere = {{}}, transform = [{{ matrix = {rows} }}] }}");
    let moved = scene(&text).surfaces[0].transform.transform_point3(DVec3::ONE);
    assert_eq!(moved, DVec3::new(7.0, 7.0, 10.0));
}

#[test]
fn textures_have_their_patterns() {
    let scene = scene(
        "[materials.wood.lambert]
        reflectance = { image = { file = 'wood.png', wrap = ['mirror', 'clamp'], scale = 2, offset = [1, 0] } }
        emission = { checker = { colors = ['#fff', [3, 2, 1]], size = [1, '50 cm'] } }",
    );
    let Pattern::Image { image: 0, wrap, transform, .. } = &scene.materials[0].reflectance.pattern
    else {
        panic!("a picture")
    };
    assert_eq!(*wrap, [Wrap::Mirror, Wrap::Clamp]);
    assert_eq!(transform.transform_point2(glam::Vec2::ONE), glam::Vec2::new(3.0, 2.0));
    let checker = Pattern::Checker {
        colors: [[1.0; 4], [3.0, 2.0, 1.0, 1.0]],
        size: glam::Vec2::new(1.0, 0.5),
    };
    assert_eq!(scene.materials[0].emission.pattern, checker);
}

#[test]
fn one_picture_under_two_names_is_decoded_once() {
    let material = |name: &str, file: &str| {
        format!("materials.{name}.lambert.reflectance = {{ image = {{ file = '{file}' }} }}\n")
    };
    let scene = scene(&(material("a", "wood.png") + &material("b", "./wood.png")));
    assert_eq!((scene.materials.len(), scene.images.len()), (2, 1));
}

fn point_intensity(keys: &str) -> Rgb {
    let text = format!("lights.a.point = {{ position = [0, 0, 1], {keys} }}");
    match scene(&text).lights[0].light {
        Light::Point { intensity, .. } => intensity,
        _ => panic!("a point light"),
    }
}

#[test]
fn coloured_lumens_stay_lumens_and_coloured_watts_are_multiplied() {
    for color in ["white", "#ff0000", "#fff4e0", "#000001"] {
        let intensity = point_intensity(&format!("power = '800 lm', color = '{color}'"));
        let lumens = f64::from(luminance(intensity)) * 683.0 * 4.0 * PI;
        assert!((lumens - 800.0).abs() < 1e-3, "{color}: {lumens}");
    }
    let per_steradian = point_intensity("power = '60 W', color = [1, 0.5, 0]") * (4.0 * PI) as f32;
    assert!(per_steradian.abs_diff_eq(Rgb::new(60.0, 30.0, 0.0), 1e-4));
    assert_eq!(point_intensity("intensity = [3, 2, 1]"), Rgb::new(3.0, 2.0, 1.0));
    let halved = scene("luminous_efficacy = 100\nlights.a.ambient.radiance = '20 nit'");
    assert_eq!(
        halved.lights[0].light,
        Light::Ambient { radiance: Rgb::splat(0.2), reach: f64::INFINITY }
    );
}

#[test]
fn a_camera_light_takes_one_of_three_quantities() {
    let amount = |keys: &str| {
        let text = format!("lights.head.camera = {{ {keys} }}");
        match scene(&text).lights[0].light {
            Light::Camera { amount } => amount,
            _ => panic!("a camera light"),
        }
    };
    let three = Rgb::splat(3.0);
    assert_eq!(amount("irradiance = 3"), CameraLightAmount::Irradiance(three));
    assert_eq!(amount("intensity = '3 W/sr'"), CameraLightAmount::Intensity(three));
    let CameraLightAmount::Intensity(i) = amount("power = 12") else { panic!("an intensity") };
    assert!((f64::from(i.x) - 3.0 / PI).abs() < 1e-6);
    assert!(complaint("lights.h.camera = { power = 1, intensity = 1 }").contains("one too many"));
}

#[test]
fn environments_and_integrators_are_read() {
    let described = |keys: &str| scene(&format!("integrator = 'path'\n{keys}")).environment;
    let uniform =
        described("environment.uniform = { radiance = '683 nit', color = 'red' }").unwrap();
    assert_eq!((uniform.sky, uniform.visible), (Sky::Uniform, true));
    assert!((f64::from(luminance(uniform.factor)) - 1.0).abs() < 1e-6 && uniform.factor.y == 0.0);
    let gradient =
        described("environment.gradient = { zenith = 2, horizon = 1, strength = 3 }").unwrap();
    let (zenith, horizon, nadir) = (Rgb::splat(2.0), Rgb::ONE, Rgb::ZERO);
    assert_eq!(gradient.sky, Sky::Gradient { zenith, horizon, nadir });
    assert_eq!(gradient.factor, Rgb::splat(3.0));
    let image = "environment.image = { file = 'sky.png', rotation = 90, visible = false }";
    let image = described(image).unwrap();
    let Sky::Picture { pixels, sampling: Sampling::Bilinear } = &image.sky else { panic!() };
    assert_eq!((pixels.width, pixels.height, image.visible), (4, 2, false));
    assert!((image.rotation * DVec3::Y).abs_diff_eq(-DVec3::X, 1e-12), "north turns to the west");
    let up = described("up = 'y'\nenvironment.uniform.radiance = 1").unwrap().rotation;
    assert!((up * DVec3::Z).abs_diff_eq(DVec3::Y, 1e-12));
    assert!((up * DVec3::Y).abs_diff_eq(-DVec3::Z, 1e-12));
    assert_eq!(scene("").integrator, Integrator::Direct);
    assert_eq!(scene("integrator = 'path'").integrator, Integrator::Path { bounces: None });
    let few = Integrator::Path { bounces: Some(3) };
    assert_eq!(scene("integrator = { path = { bounces = 3 } }").integrator, few);
    let distance = f64::INFINITY;
    let all = scene("integrator = 'ambient_occlusion'").integrator;
    assert_eq!(all, Integrator::AmbientOcclusion { distance });
    let near = scene("integrator = { ambient_occlusion = { distance = '20 cm' } }").integrator;
    assert_eq!(near, Integrator::AmbientOcclusion { distance: 0.2 });
}

#[test]
fn a_surface_emits_what_its_light_says() {
    let radiance = |keys: &str| {
        let scene = scene(&format!("[surfaces.a]\n{keys}"));
        let material = &scene.materials[scene.surfaces[0].material];
        (material.emission.factor[0], material.emits_behind, material.reflectance.factor[0])
    };
    let close = |keys: &str, expected: f64| {
        let (value, ..) = radiance(keys);
        assert!((f64::from(value) / expected - 1.0).abs() < 1e-6, "{keys}: {value}");
    };
    close("sphere.radius = 2\nlight.power = 10", 10.0 / (16.0 * PI * PI));
    close("quad.edge_u = [3, 0, 0]\nlight = { power = 6, two_sided = true }", 1.0 / PI);
    close("disk = {}\nlight.exitance = '683 lx'", 1.0 / PI);
    close("plane = {}\nlight.radiance = '1366 nit'", 2.0);
    close("box = {}\ntransform = [{ scale = [1, 1, 2] }]\nlight.power = 10", 1.0 / PI);
    close("cylinder.capped = false\nlight.power = 1", 1.0 / (PI * PI));
    let mesh = "mesh = { vertices = [[0, 0, 0], [2, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }";
    close(&format!("{mesh}\nlight.power = 1"), 1.0 / PI);
    assert_eq!(radiance("disk = {}\nlight.radiance = 2"), (2.0, false, 0.0));
    let own = "disk = {}\nmaterial = 'a'\nlight = { radiance = 2, two_sided = true }";
    assert_eq!(radiance(&format!("{own}\n[materials.a.lambert]")), (2.0, true, 0.5));
    let endless = complaint("surfaces.a = { plane = {}, light = { power = 1 } }");
    assert!(endless.contains("light.power needs a radiance or exitance"), "{endless}");
}

#[test]
fn skies_are_read_with_their_sun() {
    let sky =
        scene("environment.sky = { sun = { elevation = 30, azimuth = 90, angular_size = 1 } }");
    let environment = sky.environment.unwrap();
    let Sky::Clear { turbidity, sun, ground } = environment.sky else { panic!("a clear sky") };
    assert!(turbidity == 3.0 && sun.abs_diff_eq(DVec3::new(0.75_f64.sqrt(), 0.0, 0.5), 1e-12));
    assert!(ground.min_element() > 0.0);
    let Light::Sun { direction, irradiance, angular_radius } = sky.lights[0].light else {
        panic!("a sun")
    };
    assert!(direction.abs_diff_eq(-sun, 1e-12) && (angular_radius - PI / 360.0).abs() < 1e-12);
    // Some 80 klx at this height, redder than white.
    let lux = 683.0 * luminance(irradiance);
    assert!((6e4..1.1e5).contains(&lux) && irradiance.x > irradiance.z, "{irradiance} {lux}");
    let without = scene("environment.sky = { sunlight = false }");
    assert!(without.lights.is_empty());
    // The same sun by its direction, in a world where y is up.
    let by_direction = "up = 'y'\nenvironment.sky.sun.direction = [-1, -1, 0]";
    let Sky::Clear { sun, .. } = scene(by_direction).environment.unwrap().sky else { panic!() };
    assert!(sun.abs_diff_eq(DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()), 1e-12), "{sun}");
    for time in ["'2003-10-17T12:30:30-07:00'", "2003-10-17T12:30:30-07:00", "2003-10-17T19:30:30Z"]
    {
        let place = "latitude = 39.742476, longitude = -105.1786";
        let timed = format!("environment.sky.sun = {{ {place}, time = {time} }}");
        let Sky::Clear { sun, .. } = scene(&timed).environment.unwrap().sky else { panic!() };
        assert!((sun.z.asin().to_degrees() - 39.888).abs() < 0.03, "{sun}");
        assert!(sun.y < 0.0 && sun.x < 0.0);
    }
}

#[test]
fn skies_of_the_cie_have_the_light_that_is_asked_for() {
    let given = |keys: &str| {
        let scene = scene(&format!("environment.cie = {{ type = 5, {keys} }}"));
        (scene.environment.unwrap(), scene.lights)
    };
    let (sky, lights) = given("zenith_radiance = '683 nit', ground = 0.5");
    let Sky::Cie { number: 5, ground, .. } = sky.sky else { panic!("a sky of the CIE") };
    assert!((sky.factor.x - 1.0).abs() < 1e-6 && lights.is_empty());
    assert!((ground.x - 0.5).abs() < 1e-5, "half of what a uniform sky gives: {ground}");
    let (sky, _) = given("horizontal_irradiance = '2145.708 lx'");
    assert!((f64::from(sky.factor.x) - 1.0).abs() < 1e-5, "π for a uniform sky: {}", sky.factor);
    let (sky, lights) = given("zenith_radiance = 2, sun.elevation = 30, sunlight = 10, ground = 1");
    let Sky::Cie { ground, .. } = sky.sky else { panic!() };
    // (2π + 10 / 2) / π, in units of the zenith.
    assert!((f64::from(ground.x) - (1.0 + 2.5 / PI)).abs() < 1e-5, "{ground}");
    let Light::Sun { irradiance, .. } = lights[0].light else { panic!("a sun") };
    assert_eq!(irradiance, Rgb::splat(10.0));
}

#[test]
fn a_sun_that_has_set_is_told() {
    let mut warnings = Warnings::new();
    let access = FileAccess::beside(Path::new("scene.toml"), &[]);
    let night = "latitude = 40, longitude = 0, time = 2024-06-20T23:00:00Z";
    let text = format!("environment.sky.sun = {{ {night} }}");
    let scene = read(&text, "scene.toml", &[], &access, &mut warnings).unwrap();
    assert!(scene.lights.is_empty());
    assert!(
        warnings[0].to_string().contains("environment.sky.sun has set, it is 2"),
        "{warnings:?}"
    );
}

/// Lat-long pictures show 360° times 180°.
#[test]
fn a_picture_that_is_no_whole_sky_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let warnings = |width: u32| {
        image::RgbaImage::new(width, 8).save(folder.path().join("sky.png")).unwrap();
        let access = FileAccess::beside(&folder.path().join("scene.toml"), &[]);
        let mut warnings = Warnings::new();
        let text = "environment.image.file = 'sky.png'";
        read(text, "scene.toml", &[], &access, &mut warnings).unwrap();
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert!(warnings(8)[0].contains("8 × 8 pixels; all directions are twice as wide as high"));
    assert_eq!(warnings(16), [""; 0]);
}

#[test]
fn a_way_of_shadows_that_is_not_heeded_is_told() {
    let warnings = |text: &str| {
        let mut warnings = Warnings::new();
        let access = FileAccess::beside(Path::new("scene.toml"), &[]);
        read(text, "scene.toml", &[], &access, &mut warnings).unwrap();
        warnings.len()
    };
    let lamp = "[lights.a.point]\nposition = [0, 0, 1]\npower = 1\n";
    assert_eq!(warnings(&format!("shadows = 'naive'\n{lamp}")), 0);
    assert_eq!(warnings(&format!("shadows = 'naive'\nintegrator = 'path'\n{lamp}")), 1);
    assert_eq!(warnings(&format!("shadows = 'off'\n{lamp}radius = 1")), 1);
    assert_eq!(warnings(&format!("integrator = 'path'\n{lamp}radius = 1")), 0);
}

#[test]
fn luminaires_are_read_and_aimed() {
    let photometric = |keys: &str| {
        let lamp = format!("file = 'lamp.ies', position = [0, 0, 3], {keys}");
        let scene = scene(&format!("lights.lamp.photometric = {{ {lamp} }}"));
        let [LightDescription { light, radius, .. }] = &scene.lights[..] else { panic!("one") };
        let Light::Photometric { rotation, factor, web, .. } = light.clone() else { panic!() };
        (rotation, factor, web, *radius)
    };
    let (rotation, factor, web, radius) = photometric("color = 'white'");
    assert!((rotation * DVec3::NEG_Z).abs_diff_eq(DVec3::NEG_Z, 1e-12));
    assert!((rotation * DVec3::X).abs_diff_eq(DVec3::X, 1e-12));
    assert!((683.0 * factor.x - 1.0).abs() < 1e-6 && radius == 0.0);
    assert_eq!(web.intensities, [100.0, 100.0]);
    let (rotation, factor, ..) = photometric("target = [5, 0, 3], power = '500 lm', strength = 2");
    assert!((rotation * DVec3::NEG_Z).abs_diff_eq(DVec3::X, 1e-12));
    // 500 lm, of which 400 π were measured, twice.
    let expected = 2.0 * 500.0 / (400.0 * PI * 683.0);
    assert!((f64::from(factor.x) / expected - 1.0).abs() < 1e-4, "{factor}");
    let (rotation, _, _, radius) = photometric("rotation = 90, radius = '10 cm'");
    assert!((rotation * DVec3::X).abs_diff_eq(DVec3::Y, 1e-12) && radius == 0.1);
    let round =
        "lights.a.spot = { position = [0, 0, 1], target = [0, 0, 0], intensity = 1, radius = 2 }";
    assert_eq!(scene(round).lights[0].radius, 2.0);
    let bad = complaint("lights.lamp.photometric = { file = 'bad.ies', position = [0, 0, 3] }");
    assert!(bad.contains("lights.lamp.photometric.file: bad.ies:2: needs a number"), "{bad}");
}

#[test]
fn instances_repeat_after_the_originals_transform() {
    let scene = scene(
        "surfaces.ball = { sphere = {}, transform = [{ translate = [1, 0, 0] }] }
        instances.copy = { of = 'ball', material = 'red', transform = [{ scale = 2 }] }
        materials.red.lambert = {}",
    );
    let [ball, copy] = scene.surfaces.as_slice() else { panic!("two surfaces") };
    assert_eq!((copy.name.as_str(), &copy.shape), ("copy", &ball.shape));
    assert_eq!(copy.transform.transform_point3(DVec3::ZERO), DVec3::new(2.0, 0.0, 0.0));
    assert_ne!(ball.material, copy.material);
}

#[test]
fn every_complaint_has_its_line_its_path_and_a_hint() {
    let light = "[lights.key.point]\nposition = [0, 0, 1]\n";
    assert_eq!(
        complaint(&format!("{light}power = 6\ncolour = 'red'")),
        "scene.toml:4:1: unknown field \"colour\" in lights.key.point; did you mean \"color\"?"
    );
    assert_eq!(
        complaint("[lights.key.pont]"),
        "scene.toml:1:13: unknown choice \"pont\" in lights.key; did you mean \"point\"?"
    );
    assert_eq!(
        complaint(&format!("{light}power = '3 lx'")),
        "scene.toml:3:9: lights.key.point.power needs W or lm, not lx"
    );
    assert_eq!(
        complaint(&format!("{light}power = 3\nintensity = 4")),
        "scene.toml:4:13: lights.key.point.intensity is one too many: give power or intensity, not both"
    );
    assert_eq!(
        complaint(light),
        "scene.toml:1:1: lights.key.point needs power (W, lm) or intensity (W/sr, cd)"
    );
    assert_eq!(
        complaint("surfaces.a = { sphere = {}, material = 'blu' }\nmaterials.blue.lambert = {}"),
        "scene.toml:1:40: surfaces.a.material needs the name of a material, not \"blu\"; \
         did you mean \"blue\"?"
    );
    // What is called otherwise elsewhere, and numbers up to 255.
    assert_eq!(
        complaint("[materials.a.metal]"),
        "scene.toml:1:14: unknown choice \"metal\" in materials.a; did you mean \"conductor\"?"
    );
    let codes = complaint("materials.a.lambert.reflectance = [128, 64, 32]");
    assert!(codes.contains("not 128") && codes.contains("\"#804020\""), "{codes}");
    assert!(!complaint("materials.a.lambert.reflectance = 1.5").contains('#'));
    assert_eq!(
        complaint("[[surfaces.ball]]\nmaterial = 'red'"),
        "scene.toml:2:1: surfaces.ball is written [[surfaces.ball]]"
    );
    let unquoted = scene_with("[lights.key.point]\npower = 60W", &[]).unwrap_err().to_string();
    assert!(unquoted.ends_with("in quotation marks: \"60 W\""), "{unquoted}");
    assert_eq!(
        complaint("film.samples = 1.5"),
        "scene.toml:1:16: film.samples must be a whole number, not 1.5"
    );
    assert_eq!(
        complaint("surfaces.a = { sphere = {}, transform = [{ scale = 1 }, { scale = 0 }] }"),
        "scene.toml:1:67: surfaces.a.transform[1].scale must not be 0: nothing would be left"
    );
}

#[test]
fn things_come_in_the_order_of_the_text() {
    let scene = scene("[surfaces]\nz.sphere = {}\na.sphere = {}\n[surfaces.m.sphere]");
    let names: Vec<_> = scene.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["z", "a", "m"]);
}

#[test]
fn a_missing_file_is_reported_where_it_is_named() {
    let error = scene_with("[models.dragon]\nfile = 'dragon.ply'", &[]).unwrap_err();
    assert_eq!((error.place.line, error.place.column), (Some(2), Some(8)));
    assert!(error.message.starts_with("models.dragon.file: "), "{}", error.message);
    assert!(error.message.ends_with("dragon.ply: no such file"), "{}", error.message);
}

#[test]
fn what_is_out_of_range_is_refused() {
    for wrong in [
        "camera.perspective = { position = [0, 0, 0] }",
        "camera.perspective = { position = [0, 0, 3], fov = 0 }",
        "camera.perspective = { position = [0, 0, 3], fov = 180 }",
        "camera.perspective = { position = [0, 0, 3], up = [0, 0, -2] }",
        "camera.perspective = { position = [0, nan, 3] }",
        "camera.perspective = { position = [0, 1e99999, 3] }",
        "camera.thin_lens = { position = [0, 0, 3], aperture = 0 }",
        "camera = { perspective = { position = [0, 0, 3] }, orthographic = {} }",
        "film.resolution = [0, 1]",
        "film.resolution = [65536, 65536]",
        "film.resolution = [65537, 1]",
        "film.samples = 0",
        "film.samples = 9223372036854775807",
        "film.seed = -1",
        "film.exposure = inf",
        "film.filter = { gaussian = { sigma = 0 } }",
        "film.filter = { box = {}, tent = {} }",
        "luminous_efficacy = 0",
        "integrator = 'paths'",
        "integrator = { path = { bounces = -1 } }",
        "environment.uniform = { radiance = -1 }",
        "environment.gradient = { zenith = 1 }",
        "integrator = { path = {}, ambient_occlusion = {} }",
        "integrator = { ambient_occlusion = { distance = 0 } }",
        "environment.sky = { turbidity = 1 }",
        "environment.sky = { turbidity = 11 }",
        "environment.sky = { ground = 2 }",
        "environment.sky.sun = { elevation = -1 }",
        "environment.sky.sun = { elevation = 91 }",
        "environment.sky.sun = { elevation = 10, direction = [0, 0, -1] }",
        "environment.sky.sun = { azimuth = 10, latitude = 3 }",
        "environment.sky.sun = { latitude = 3, longitude = 3 }",
        "environment.sky.sun = { latitude = 91, longitude = 3, time = 2024-06-20T12:00:00Z }",
        "environment.sky.sun = { latitude = 3, longitude = 3, time = 2024-06-20T12:00:00 }",
        "environment.sky.sun = { latitude = 3, longitude = 3, time = 2024-06-20 }",
        "environment.sky.sun = { latitude = 3, longitude = 3, time = 'noon' }",
        "environment.sky.sun = { latitude = 3, longitude = 3, time = 12 }",
        "environment.cie = { type = 0, zenith_radiance = 1 }",
        "environment.cie = { type = 16, zenith_radiance = 1 }",
        "environment.cie = { type = 5 }",
        "environment.cie = { type = 5, zenith_radiance = 1, horizontal_irradiance = 1 }",
        "lights.a.photometric = { file = 'none.ies', position = [0, 0, 0] }",
        "lights.a.photometric = { file = 'wood.png', position = [0, 0, 0] }",
        "lights.a.photometric = { file = 'lamp.ies', position = [0, 0, 0], target = [0, 0, 0] }",
        "lights.a.point = { position = [0, 0, 0], power = 1, radius = 0 }",
        "environment.image = { file = 'sea.png' }",
        "environment.image = { file = 'sky.png', strength = -1 }",
        "environment = { uniform = { radiance = 1 }, image = { file = 'sky.png' } }",
        "surfaces.a = { disk = {}, light = {} }",
        "surfaces.a = { disk = {}, light = { power = 1, radiance = 1 } }",
        "surfaces.a = { plane = {}, light = { power = 1 } }",
        "materials.a.lambert = { reflectance = 0.6, mirror = 0.5 }",
        "materials.a.conductor.metal = 'gild'",
        "materials.a.conductor = { n = 1 }",
        "materials.a.conductor = { n = 1, k = 1, metal = 'gold' }",
        "materials.a.dielectric.index = 0.9",
        "materials.a.dielectric.index = 'wather'",
        "materials.a.dielectric.abbe = 0",
        "materials.a.dielectric.attenuation_distance = 0",
        "materials.a.principled.metallic = 1.5",
        "materials.a.principled.color = 'red'",
        "materials.a.mix = { materials = ['a', 'a'] }",
        "materials.a.mix = { materials = ['b', 'c'] }",
        "materials.a.mix = { materials = ['b'] }",
        "materials.a.principled.base_color = { image = { file = 'wood.png', channel = 'r' } }",
        "lights.a.sun = { direction = [0, 0, -1], irradiance = 1, angular_size = 0 }",
        "lights.a.sun = { direction = [0, 0, -1], irradiance = 1, angular_size = 181 }",
        "background = [-1, 0, 0]",
        "background = '#fff8'",
        "shadows = { t_range = { epsilon = 0 } }",
        "materials.a.lambert.reflectance = 1.01",
        "materials.a.lambert.reflectance = [0, 0, -0.1]",
        "materials.a.lambert.alpha_cutoff = 2",
        "materials.a.lambert.reflectance = { checker = { colors = ['red'] } }",
        "surfaces.a = {}",
        "surfaces.a = { sphere = {}, disk = {} }",
        "surfaces.a.sphere.radius = -1",
        "surfaces.a.plane.normal = [0, 0, 0]",
        "surfaces.a.quad = { edge_u = [1, 0, 0], edge_v = [-2, 0, 0] }",
        "surfaces.a.box = { min = [0, 0, 0], max = [1, 1, 0] }",
        "surfaces.a.cone = { base = [0, 0, 1], apex = [0, 0, 1] }",
        "surfaces.a.mesh = { vertices = [[0, 0, 0]], triangles = [[0, 0, 1]] }",
        "surfaces.a.mesh = { vertices = [[0, 0, 0]], triangles = [[0, 0]] }",
        "surfaces.a.mesh = { vertices = [[0, 0, 0]], triangles = [] }",
        "surfaces.a.mesh = { vertices = [[0, 0, 0]], triangles = [[0, 0, 0]], normals = [] }",
        "surfaces.a.mesh = { vertices = [[0, 0, 0]], triangles = [[0, 0, 0]], colors = [[200, 1, 0]] }",
        "surfaces.a = { sphere = {}, transform = [{ scale = [1, 0, 1] }] }",
        "surfaces.a = { sphere = {}, transform = [{ matrix = [[1, 0, 0, 0], [2, 0, 0, 0], [0, 0, 1, 0]] }] }",
        "surfaces.a = { sphere = {}, transform = [{ scale = 1e15 }, { translate = [1e15, 0, 0] }, { scale = 10 }] }",
        "surfaces.a.sphere = {}\nmodels.a.file = 'a.ply'",
        "instances.a.of = 'b'",
        "lights.a.directional = { direction = [0, 0, 0], irradiance = 1 }",
        "lights.a.directional = { direction = [0, 0, 1], irradiance = -1 }",
        "lights.a.directional = { direction = [0, 0, 1], irradiance = 1e39 }",
        "lights.a.ambient = { radiance = '1 nit', color = 'black' }",
        "lights.a.spot = { position = [0, 0, 0], intensity = 1 }",
        "lights.a.spot = { position = [0, 0, 0], target = [0, 0, 0], intensity = 1 }",
        "lights.a.spot = { position = [0, 0, 0], target = [0, 0, 1], intensity = 1, outer_angle = 91 }",
        "lights.a.spot = { position = [0, 0, 0], target = [0, 0, 1], intensity = 1, inner_angle = 45 }",
    ] {
        let error = scene_with(wrong, &[]).expect_err(wrong);
        assert!(error.place.line.is_some() && error.place.column.is_some(), "{wrong}: {error}");
    }
}

#[test]
fn overrides_lie_over_the_text_and_name_themselves() {
    let text = "[film]\nsamples = 4\n[lights.key.point]\nposition = [0, 0, 1]\npower = 1\n";
    let set = |overrides: &[&str]| scene_with(text, overrides).unwrap();
    assert_eq!(set(&["film.samples=64", "film.samples = 65"]).film.samples, 65);
    assert_eq!(set(&["film={}"]).film.samples, 16, "a value replaces what is there");
    assert_eq!(set(&["background=#fff"]).background, Rgb::ONE);
    assert_eq!(set(&["surfaces.a.sphere={}"]).surfaces.len(), 1);
    let Light::Point { intensity, .. } = set(&["lights.key.point.power=683 lm"]).lights[0].light
    else {
        panic!("a point")
    };
    assert!(intensity.abs_diff_eq(Rgb::splat(1.0 / (4.0 * PI) as f32), 1e-7));
    assert_eq!(
        complaint_with(text, &["film.seed=1", "film.sample=3"]),
        "-D film.sample=3: unknown field \"sample\" in film; did you mean \"samples\"?"
    );
    assert_eq!(
        complaint_with(text, &["film.samples=0"]),
        "-D film.samples=0: film.samples must be a whole number from 1 to 16777216, not 0"
    );
    let error = scene_with(text, &["lights.kye.point.power=3"]).unwrap_err();
    assert_eq!(error.help.as_deref(), Some("did you mean \"key\" where it says \"kye\"?"));
    for wrong in ["", "=", "film", "film.=3", "film.samples.x=3", "a\nb=3"] {
        assert!(scene_with(text, &[wrong]).is_err(), "{wrong}");
    }
}

#[test]
fn overrides_leave_the_lines_of_the_text_alone() {
    let text = "[film]\nsamples = 4\nseeed = 3\n";
    let start = "scene.toml:3:1: unknown field \"seeed\" in film";
    assert!(complaint_with(text, &["film.samples=9"]).starts_with(start));
}

#[test]
fn an_override_reaches_into_lists() {
    let text = "surfaces.a = { sphere = {}, transform = [{ scale = 2 }] }";
    let scaled = scene_with(text, &["surfaces.a.transform.0.scale=3"]).unwrap();
    assert_eq!(scaled.surfaces[0].transform.transform_point3(DVec3::X), DVec3::X * 3.0);
    assert!(complaint_with(text, &["surfaces.a.transform.1.scale=3"]).contains("list of 1"));
    let text = "surfaces.a = { sphere = {} }";
    let scaled = scene_with(text, &["surfaces.a.transform.0.scale=3"]).unwrap();
    assert_eq!(scaled.surfaces[0].transform.transform_point3(DVec3::X), DVec3::X * 3.0);
    let second = complaint_with(text, &["surfaces.a.transform.1.scale=3"]);
    assert!(second.contains("there is no list yet to have an element \"1\""), "{second}");
    assert!(scene_with("", &["surfaces.0.sphere={}"]).is_ok());
    assert!(complaint_with("", &["film.resolution.0=300"]).contains("film.resolution needs"));
    assert!(
        complaint_with(text, &["film.seed=-1"]).contains("must be a whole number from 0, not -1")
    );
}

#[test]
fn text_edges_do_not_break_the_reader() {
    assert_eq!(scene("[film]\r\nsamples = 3\r\n").film.samples, 3);
    let marked = text(b"\xef\xbb\xbffilm.samples = 3".to_vec(), "a").unwrap();
    assert_eq!(scene(&marked).film.samples, 3);
    let latin1 = text(b"up = 'z'\n# \xe9".to_vec(), "a.toml").unwrap_err();
    assert_eq!(
        latin1.to_string().lines().next(),
        Some("a.toml:2: byte 11: this is not UTF-8 text")
    );
    for broken in ["\0", "a = \"\0\"", "film.samples = 1\u{1b}", "[", "= 3", "\u{feff}\u{feff}x"] {
        let error = scene_with(broken, &[]).unwrap_err().to_string();
        assert!(!error.contains(['\0', '\u{1b}']), "{error:?}");
    }
}

#[test]
fn depth_and_length_neither_overflow_nor_hang() {
    let deep = |open: &str| format!("a = {}", open.repeat(100_000));
    assert!(scene_with(&deep("["), &[]).is_err());
    assert!(scene_with(&deep("{a="), &[]).is_err());
    assert!(scene_with(&format!("{}a = 1", "a.".repeat(100_000)), &[]).is_err());
    assert!(scene_with(&format!("[{}a]", "a.".repeat(100_000)), &[]).is_err());
    assert!(scene_with("", &[&format!("{}a=1", "a.".repeat(100_000))]).is_err());
    assert!(scene_with("", &[&deep("[")]).is_err());
    let reopened: String = (0..20_000)
        .map(|i| format!("[surfaces.s{i}.sphere]\n"))
        .chain((0..20_000).map(|i| format!("[surfaces.s{i}]\n")))
        .collect();
    assert_eq!(scene(&reopened).surfaces.len(), 20_000);
    for bulky in [" ".repeat(1 << 24), format!("{}a = 1\n", "a.".repeat(70)).repeat(20_000)] {
        assert!(complaint(&bulky).ends_with("1024 MiB are allowed"));
    }
    let long = scene_with(&format!("film.samples = '{}'", "x".repeat(1 << 22)), &[]).unwrap_err();
    assert!(long.to_string().len() < 1000, "{}", long.to_string().len());
    let long = scene_with(&format!("{} = 1", "x".repeat(1 << 22)), &[]).unwrap_err();
    assert!(long.to_string().len() < 1000, "{}", long.to_string().len());
}

#[test]
fn the_schema_describes_every_key_and_its_units() {
    let schema = schema();
    let keys = schema["properties"].as_object().unwrap();
    for key in ["up", "camera", "cameras", "film", "materials", "surfaces", "models", "lights"] {
        assert!(keys.contains_key(key), "{key}");
    }
    let undescribed = |schema: &serde_json::Value| schema["description"].as_str().is_none();
    let missing: Vec<_> = keys.iter().filter(|(_, value)| undescribed(value)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    let power = &schema["$defs"]["Power"];
    assert!(power["examples"].as_array().unwrap().contains(&"800 lm".into()), "{power}");
    assert_eq!(schema["additionalProperties"], serde_json::Value::Bool(false));
}

#[test]
fn every_kind_of_material_is_described() {
    let scene = scene(
        "integrator = 'path'
        [materials]
        blend.mix = { materials = ['metal', 'bottle'], amount = 0.25 }
        moon.diffuse = { roughness = 1, opacity = 0.5 }
        metal.conductor = { metal = 'Gold', roughness = 0.3, anisotropy = 0.5, anisotropy_rotation = 90 }
        own.conductor = { n = [1, 2, 3], k = 4 }
        bottle.dielectric = { index = 'water', abbe = 50, attenuation_color = 0.5, attenuation_distance = '10 cm', priority = 2 }
        window.thin_glass = { index = 1.6, color = 'red' }
        car.principled = { clearcoat = 1, roughness = { image = { file = 'wood.png', channel = 'g' } } }
        worn.conductor = { roughness = 1, multiple_scattering = false }
        ground.dielectric = { roughness = 1, energy_compensation = false }
        chalk.principled = { multiple_scattering = false }
        soap.principled = { iridescence = 1, iridescence_thickness = '300 nm', transmission = 1, solid = true }
        sign.unlit = { color = [1, 2, 0], opacity = 0.5 }
        page.unlit = {}
        steel.mirror = {}",
    );
    let find = |name: &str| scene.materials.iter().find(|m| m.name == name).expect(name);
    let place = |name: &str| scene.materials.iter().position(|m| m.name == name).expect(name);
    let amount = Scalar::constant(0.25);
    let mixed = Scattering::Mix { materials: [place("metal"), place("bottle")], amount };
    assert_eq!(find("blend").scattering, mixed);
    assert_eq!(find("blend").interior, find("bottle").interior);
    assert_eq!((find("moon").alpha, find("moon").reflectance.factor[3]), (Alpha::Blend, 0.5));
    let Scattering::Conductor { index: Some(index), facets } = &find("metal").scattering else {
        panic!("{:?}", find("metal"))
    };
    assert_eq!((index.n.x, facets.anisotropy.is(0.5)), (0.18299, true));
    assert!((facets.rotation - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    let own = ComplexIndex { n: Rgb::new(1.0, 2.0, 3.0), k: Rgb::splat(4.0) };
    assert!(
        matches!(find("own").scattering, Scattering::Conductor { index: Some(i), .. } if i == own)
    );
    let (sign, page) = (find("sign"), find("page"));
    assert_eq!(
        (sign.emission.factor, sign.reflectance.factor),
        ([1.0, 2.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.5])
    );
    assert_eq!((sign.unlit, page.unlit, page.emission.factor), (true, true, [1.0; 4]));
    let twice = complaint("materials.a.unlit = { color = 1, emission = 2 }");
    assert!(twice.contains("color and emission are the same thing here: keep one"), "{twice}");
    let part = "materials = { a.unlit = {}, b.mix = { materials = ['c', 'a'] }, c.lambert = {} }";
    let part = complaint(part);
    assert!(part.contains("mixes \"a\", which is unlit"), "{part}");
    let several = |name: &str| match &find(name).scattering {
        Scattering::Conductor { facets, .. } | Scattering::Dielectric { facets } => {
            facets.multiple_scattering
        }
        Scattering::Principled(p) => p.facets.multiple_scattering,
        other => panic!("{other:?}"),
    };
    assert_eq!(["metal", "bottle", "car"].map(several), [true; 3]);
    assert_eq!(["worn", "ground", "chalk"].map(several), [false; 3]);
    let water = find("bottle").interior.expect("it is solid");
    assert_eq!((water.index, water.dispersion, water.priority), (1.333, 0.02, 2));
    assert!((water.absorption.x - 10.0 * 2.0_f32.ln()).abs() < 1e-4);
    assert_eq!(find("window").scattering, Scattering::ThinGlass { index: 1.6 });
    let Scattering::Principled(car) = &find("car").scattering else { panic!("{:?}", find("car")) };
    assert_eq!((car.facets.roughness.channel, car.metallic.is(0.0)), (1, true));
    let Scattering::Principled(soap) = &find("soap").scattering else { panic!("soap") };
    assert!((soap.iridescence_thickness_range[1] - 300.0).abs() < 1e-3);
    assert!(find("soap").interior.is_some() && find("car").interior.is_none());
    assert!(find("window").is_pane() && !find("soap").is_pane());
}

#[test]
fn media_are_written_in_two_ways() {
    let scene = scene(
        "integrator = 'path'
        [medium]
        extinction = [2, 4, 8]
        albedo = 0.5
        anisotropy = 0.3
        [materials]
        smoke.medium = { sigma_a = 2, scattering = [3, 3, 4], g = -0.5 }
        milk.dielectric = { index = 'water', attenuation_color = 0.5, medium = { density = 900, albedo = 1 } }",
    );
    let halves = Rgb::new(1.0, 2.0, 4.0);
    let fog = Medium { absorption: halves, scattering: halves, anisotropy: 0.3 };
    assert_eq!(scene.medium, Some(fog));
    let smoke = scene.materials[0].interior.expect("it is filled");
    assert_eq!((smoke.index, smoke.absorption, smoke.anisotropy), (1.0, Rgb::splat(2.0), -0.5));
    assert_eq!(smoke.scattering, Rgb::new(3.0, 3.0, 4.0));
    assert!(scene.materials[0].passes_light() && !scene.materials[1].passes_light());
    let milk = scene.materials[1].interior.expect("it is filled");
    assert_eq!(milk.scattering, Rgb::splat(900.0));
    assert!((milk.absorption.x - 2.0_f32.ln()).abs() < 1e-4);
    for (wrong, words) in [
        ("medium = { extinction = 1, scattering = 1 }", "medium.extinction says again"),
        ("medium = { scattering = -1 }", "0 or more"),
        ("medium = { g = 1 }", "medium.g must be from -0.999 to 0.999"),
        ("medium = { albedo = 2 }", "from 0 to 1"),
        (
            "medium = { albedo = 0.5 }",
            "medium.albedo is a part of the extinction, and there is none",
        ),
        ("medium = { absorption = 3e38, scattering = 3e38 }", "at most 1e30 per metre"),
    ] {
        let told = complaint(wrong);
        assert!(told.contains(words), "{told}");
    }
}

/// What would come as a surprise is said.
#[test]
fn media_that_leave_out_light_are_warned_of() {
    let warned = |text: &str| {
        let (access, mut warnings) = (FileAccess::beside(Path::new("scene.toml"), &[]), Vec::new());
        read(text, "scene.toml", &[], &access, &mut warnings).unwrap();
        warnings.iter().map(ToString::to_string).collect::<String>()
    };
    let fog = "[medium]\nscattering = 0.1\n";
    let sky = warned(&format!("integrator = 'path'\n{fog}[environment.uniform]\nradiance = 1"));
    assert!(sky.contains("no light of suns and skies"), "{sky}");
    let blind = warned(&format!("integrator = 'ambient_occlusion'\n{fog}"));
    assert!(blind.contains("media are left out"), "{blind}");
    let none = warned(&format!(
        "integrator = 'path'\n{fog}[lights.a.point]\npower = 1\nposition = [0, 0, 1]"
    ));
    assert_eq!(none, "");
}

#[test]
fn patterns_may_stand_for_any_colour_or_number() {
    let scene = scene(
        "[materials.a.principled]
        base_color = { noise = { colors = ['white', [0.1, 0.2, 0.3]], size = '20 cm', octaves = 6 } }
        roughness = { gradient = { colors = [0.2, 0.8], from = [1, 0], to = [3, 0] } }
        bump = { checker = { colors = [0, 1] } }
        bump_height = '-2 mm'",
    );
    let material = &scene.materials[0];
    let Pattern::Noise { colors, size, octaves } = material.reflectance.pattern else {
        panic!("{material:?}")
    };
    assert_eq!((colors[1], size, octaves), ([0.1, 0.2, 0.3, 1.0], Vec2::splat(0.2), 6));
    let Scattering::Principled(p) = &material.scattering else { panic!("{material:?}") };
    let (from, to) = (Vec2::X, Vec2::new(3.0, 0.0));
    let ramp = Pattern::Gradient { colors: [[0.2; 4], [0.8; 4]], from, to };
    assert_eq!(p.facets.roughness.texture.pattern, ramp);
    let bump = material.bump.as_ref().unwrap();
    assert_eq!(bump.amount, BumpAmount::Metres(-0.002));
    for (wrong, text) in [
        ("reflectance = { noise = { colors = [0, 1], octaves = 0 } }", "1 to 16"),
        (
            "reflectance = { gradient = { colors = [0, 1], to = [0, 0] } }",
            "other than that of from",
        ),
        (
            "reflectance = { noise = { colors = [0, 1] }, checker = { colors = [0, 1] } }",
            "exactly one",
        ),
    ] {
        let text_of = complaint(&format!("[materials.a.lambert]\n{wrong}"));
        assert!(text_of.contains(text), "{text_of}");
    }
}
