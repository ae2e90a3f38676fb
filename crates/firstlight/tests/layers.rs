//! Layers of light add up to the picture; layers of data are what is in the middle of each pixel.

mod common;

use common::{close, read, small_scenes};
use firstlight::io::{Develop, Limits, Metadata, load_layers, save_layers};
use firstlight::layers::{Channel, Layer, Plane, data_layers};
use firstlight::render::{Crop, Progress, RenderOptions, Stop, render, render_layers};
use firstlight::{Image, Scene, SceneDescription};
use std::ops::ControlFlow;
use std::path::Path;

fn numbers<'a>(channels: &'a [Channel], name: &str) -> &'a [f32] {
    let channel = channels.iter().find(|channel| channel.name == name);
    match &channel.unwrap_or_else(|| panic!("there is no {name}")).plane {
        Plane::Numbers(values) => values,
        Plane::Whole(_) => panic!("{name} has whole numbers"),
    }
}

fn whole<'a>(channels: &'a [Channel], name: &str) -> &'a [u32] {
    let channel = channels.iter().find(|channel| channel.name == name);
    match &channel.unwrap_or_else(|| panic!("there is no {name}")).plane {
        Plane::Whole(values) => values,
        Plane::Numbers(_) => panic!("{name} has no whole numbers"),
    }
}

/// The sums of all channels whose names begin and end so.
fn sums(channels: &[Channel], begin: &str, end: &str, size: usize) -> Vec<f64> {
    let mut sums = vec![0.0; size];
    for channel in channels.iter().filter(|c| c.name.starts_with(begin) && c.name.ends_with(end)) {
        let Plane::Numbers(values) = &channel.plane else { panic!("{} is light", channel.name) };
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(*value));
    }
    sums
}

fn with_layers(description: &SceneDescription, crop: Option<Crop>) -> (Image, Vec<Channel>) {
    let scene = Scene::build(description);
    let options = RenderOptions { crop, ..RenderOptions::default() };
    let (rendered, lights) = render_layers(&scene, &options, &|_| ControlFlow::Continue(()));
    let all: Vec<_> = Layer::NAMES.iter().map(|(_, layer)| *layer).collect();
    let channels = lights.channels(description, &all);
    (rendered.image, channels)
}

#[test]
fn layers_of_light_add_up_to_the_picture() {
    for (name, mut description) in small_scenes() {
        description.film.transparent |= name.ends_with("first.toml");
        let crop = Some(Crop { x: 3, y: 2, width: 20, height: 13 });
        let (image, channels) = with_layers(&description, crop);
        let options = RenderOptions { crop, ..RenderOptions::default() };
        let scene = Scene::build(&description);
        let plain = render(&scene, &options, &|_| ControlFlow::Continue(())).image;
        assert_eq!(image, plain, "{name}: layers change the picture");
        let size = image.pixels().len();
        for (index, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let end = format!(".{letter}");
            let by_light = sums(&channels, "light.", &end, size);
            let by_way: Vec<f64> = ["emission", "direct", "indirect", "ambient"]
                .into_iter()
                .map(|way| sums(&channels, way, &end, size))
                .reduce(|a, b| a.iter().zip(b).map(|(a, b)| a + b).collect())
                .unwrap();
            for ((pixel, by_light), by_way) in image.pixels().iter().zip(by_light).zip(by_way) {
                let seen = f64::from(pixel[index] * pixel[3]);
                let rounding = 1e-6 * f64::from(pixel[..3].iter().copied().fold(1e-6, f32::max));
                assert!((by_light - seen).abs() <= rounding, "{name}: {by_light} is not {seen}");
                assert!((by_way - seen).abs() <= rounding, "{name}: {by_way} is not {seen}");
            }
        }
        let counts = whole(&channels, "sample_count");
        assert!(counts.iter().all(|count| *count == 6), "{name}: {counts:?}");
    }
}

/// A time that ends after a pass of one of the sequences that take turns without end.
#[test]
fn layers_add_up_after_any_number_of_passes() {
    let description = read(Path::new("scene.toml"), BALL, &["lights.key.point.radius=2"]);
    let scene = Scene::build(&description);
    let options = RenderOptions { endless: true, ..RenderOptions::default() };
    let enough = |progress: Progress| match progress.samples {
        0..12 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(Stop::AfterPass),
    };
    let (rendered, lights) = render_layers(&scene, &options, &enough);
    assert_eq!(rendered.samples, 12);
    let channels = lights.channels(&description, &[Layer::Light]);
    let sums = sums(&channels, "light.", ".R", 33 * 33);
    for (pixel, sum) in rendered.image.pixels().iter().zip(sums) {
        close(sum, f64::from(pixel[0]), 1e-5);
    }
}

const BALL: &str = "
    film = { resolution = [33, 33], samples = 64 }
    camera.perspective = { position = [0, -5, 0], target = [0, 0, 0], fov = 40 }
    surfaces.ball.sphere = { radius = 1 }
    surfaces.ball.material = 'red'
    surfaces.wall.quad = { corner = [-9, 2, -9], edge_u = [18, 0, 0], edge_v = [0, 0, 9] }
    materials.red.lambert.reflectance = [0.5, 0.2, 0.1]
    lights.key.point = { position = [0, -5, 0], intensity = '500 cd' }
    lights.fill.ambient.radiance = 0.1
";

fn data(text: &str) -> Vec<Channel> {
    let description = read(Path::new("scene.toml"), text, &[]);
    let scene = Scene::build(&description);
    let all: Vec<_> = Layer::NAMES.iter().map(|(_, layer)| *layer).collect();
    let samples = scene.film().samples;
    data_layers(&scene, &description, [[0, 0], [33, 33]], &all, samples, &|| false)
}

#[test]
fn data_is_that_of_the_middle_of_the_pixel() {
    let channels = data(BALL);
    let (middle, corner, below) = (16 * 33 + 16, 0, 32 * 33 + 1);
    close(numbers(&channels, "Z")[middle], 4.0, 1e-6);
    close(numbers(&channels, "distance")[middle], 4.0, 1e-6);
    close(numbers(&channels, "Z")[below], 7.0, 1e-6);
    let slanted = numbers(&channels, "distance")[below];
    assert!(slanted > 7.5, "{slanted} is along the ray");
    assert_eq!(numbers(&channels, "Z")[corner], f32::INFINITY);
    close(numbers(&channels, "P.Y")[middle], -1.0, 1e-6);
    close(numbers(&channels, "N.Y")[middle], -1.0, 1e-6);
    close(numbers(&channels, "facing")[middle], 1.0, 1e-6);
    close(numbers(&channels, "albedo.G")[middle], 0.2, 1e-6);
    assert_eq!(numbers(&channels, "roughness")[middle], 1.0);
    for (name, of_ball, of_wall) in [("object", 1, 2), ("primitive", 1, 1), ("instance", 1, 1)] {
        let found = whole(&channels, name);
        assert_eq!([found[middle], found[below], found[corner]], [of_ball, of_wall, 0], "{name}");
    }
    let materials = whole(&channels, "material");
    assert!(materials[middle] != materials[below] && materials[middle] > 0);
    // 500 cd at 4 m, and ambient light of 0.1 W/(sr m²) from all sides.
    let lux = 500.0 / 16.0 + 683.0 * 0.1 * std::f64::consts::PI;
    close(numbers(&channels, "illuminance")[middle], lux, 1e-5);
    close(numbers(&channels, "irradiance.B")[middle], lux / 683.0, 1e-5);
}

/// The front of the ball sees nothing but sky.
#[test]
fn open_places_see_the_sky() {
    let open = numbers(&data(BALL), "ao")[16 * 33 + 16];
    assert_eq!(open, 1.0);
    let closed =
        BALL.to_owned() + "surfaces.shell.sphere = { center = [0, -1, 0], radius = 0.3 }\n";
    let inside = closed.replace("position = [0, -5, 0], target", "position = [0, -1.1, 0], target");
    let hidden = numbers(&data(&inside), "ao")[16 * 33 + 16];
    assert_eq!(hidden, 0.0);
}

#[test]
fn files_keep_every_bit_and_are_the_same_each_time() {
    let description = read(Path::new("scene.toml"), BALL, &["film.samples=1"]);
    let (image, channels) = with_layers(&description, None);
    let attributes: Vec<_> = (0..9).map(|i| (format!("cryptomatte/{i}"), i.to_string())).collect();
    let save = || {
        let (channels, attributes) = (channels.clone(), attributes.clone());
        save_layers(&image, channels, attributes, Develop::default(), &Metadata::default()).unwrap()
    };
    let bytes = save();
    assert!((0..4).all(|_| save() == bytes));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    std::fs::write(&path, bytes).unwrap();
    let file = load_layers(&path, &Limits::default()).unwrap();
    assert_eq!((file.width, file.height, file.exposure_ev), (33, 33, Some(0.0)));
    for channel in &channels {
        let found = file.channels.iter().find(|found| found.name == channel.name);
        assert_eq!(found, Some(channel));
    }
    let mut lights = file.layers("light.");
    lights.sort_unstable();
    assert_eq!(lights, ["fill", "key"]);
}

/// Samples without end, but nobody waits for them.
#[test]
fn data_that_takes_long_can_be_left_off() {
    let description = read(Path::new("scene.toml"), BALL, &["lights.key.point.radius=1"]);
    let scene = Scene::build(&description);
    let wanted = [Layer::Depth, Layer::Irradiance, Layer::Ao];
    let channels =
        data_layers(&scene, &description, [[0, 0], [33, 33]], &wanted, u32::MAX, &|| true);
    let middle = 16 * 33 + 16;
    close(numbers(&channels, "Z")[middle], 4.0, 1e-6);
    assert_eq!(numbers(&channels, "irradiance.R")[middle], 0.0);
    assert_eq!(numbers(&channels, "ao")[middle], 0.0);
}

/// What lights may be called, and files may not.
#[test]
fn lights_of_any_name_have_layers() {
    let long = "long ".repeat(100);
    let lights = [("Лампа 1 💡", 3.0), ("a.b", 2.0), ("a_b", 1.0), (&long, 0.5)];
    let more: String = lights
        .iter()
        .map(|(name, power)| {
            format!("lights.'{name}'.point = {{ position = [0, -5, 0], power = {power} }}\n")
        })
        .collect();
    let description =
        read(Path::new("scene.toml"), &(BALL.to_owned() + &more), &["film.samples=1"]);
    let (image, channels) = with_layers(&description, None);
    let bytes =
        save_layers(&image, channels.clone(), vec![], Develop::default(), &Metadata::default());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.exr");
    std::fs::write(&path, bytes.unwrap()).unwrap();
    let file = load_layers(&path, &Limits::default()).unwrap();
    for channel in &channels {
        assert!(file.channels.contains(channel), "{}", channel.name);
    }
    let red = |name: &str| numbers(&file.channels, &format!("light.{name}.R"))[16 * 33 + 16];
    for (name, power) in [("Лампа 1 💡", 6.0), ("a_b", 4.0), ("a_b_2", 2.0), (&long[..200], 1.0)]
    {
        close(red(name) / red(&long[..200]), power, 1e-5);
    }
}

/// Ambient light that near surfaces keep out is ambient light.
#[test]
fn ambient_light_is_that_of_ambient_lights() {
    let more = ["lights.fill.ambient.reach=0.5", "lights.key.point.intensity=0"];
    let description = read(Path::new("scene.toml"), BALL, &more);
    let (image, channels) = with_layers(&description, None);
    let middle = 16 * 33 + 16;
    close(numbers(&channels, "ambient.R")[middle], image.pixels()[middle][0].into(), 1e-6);
    assert_eq!(numbers(&channels, "direct.R")[middle], 0.0);
}

/// What only bounds a medium is not there itself, and neither are particles: data and mattes are of what stands in it.
#[test]
fn data_layers_see_through_fog() {
    let clear = "
        film = { resolution = [8, 6], samples = 16 }
        integrator = 'path'
        camera.perspective = { position = [0, -9, 1], target = [0, 0, 1] }
        lights.key.point = { position = [0, -4, 5], power = '1 kW' }
        materials.white.lambert = { reflectance = 0.8 }
        materials.smoke.medium = { scattering = 0.2, absorption = 0.1 }
        [surfaces.ball]
        sphere = { center = [0, 0, 1], radius = 1.5 }
        material = 'white'
    ";
    let smoke =
        "[surfaces.smoke]\nbox = { min = [-8, -5, -8], max = [8, 5, 8] }\nmaterial = 'smoke'\n";
    let fog =
        clear.replace("integrator", "medium = { extinction = 0.1, albedo = 0.9 }\nintegrator");
    let path = Path::new("scene.toml");
    let of = |text: &str| {
        let description = read(path, text, &[]);
        let all: Vec<_> = Layer::NAMES.iter().map(|(_, layer)| *layer).collect();
        let scene = Scene::build(&description);
        let place = [[0, 0], [8, 6]];
        let data = data_layers(&scene, &description, place, &all, 1, &|| false);
        let (_, light) = with_layers(&description, None);
        let mattes = light.iter().filter(|channel| channel.name.starts_with("CryptoObject00"));
        let mattes: Vec<f32> = mattes.flat_map(|c| numbers(&light, &c.name).to_vec()).collect();
        (whole(&data, "object").to_vec(), numbers(&data, "Z").to_vec(), mattes)
    };
    let plain = of(clear);
    assert!(plain.0.contains(&1) && plain.0.contains(&0), "{:?}", plain.0);
    for text in [format!("{clear}{smoke}"), fog] {
        assert!(of(&text) == plain, "{text}");
    }
}
