//! They ask for the library, and have nothing to say where it is not.

use super::*;

const SIDE: usize = 64;

/// Opens the library; says so where there is none, unless `OIDN_DIR` promises one.
fn library(threads: usize) -> Option<Denoiser> {
    match Denoiser::open(threads) {
        Ok(denoiser) => Some(denoiser),
        Err(reason) if std::env::var_os("OIDN_DIR").is_some() => panic!("{reason}"),
        Err(reason) => {
            eprintln!("not tested: {reason}");
            None
        }
    }
}

/// Has it take the noise out, with guides of a wall of this albedo that faces the camera.
fn denoised(denoiser: &Denoiser, radiance: &[Pixel], albedo: impl Fn(usize) -> f32) -> Vec<Pixel> {
    let albedo: Vec<_> = (0..SIDE * SIDE).map(|i| [albedo(i); 3]).collect();
    let normal = vec![[0.0, 0.0, 1.0]; SIDE * SIDE];
    denoiser.denoise(radiance, [&albedo, &normal], [SIDE; 2]).unwrap()
}

fn grey(_: usize) -> f32 {
    0.5
}

/// Brighter from left to right: 0.2 to 1.8.
fn gradient() -> Vec<f32> {
    (0..SIDE * SIDE).map(|i| 0.2 + 1.6 * ((i % SIDE) as f32 + 0.5) / SIDE as f32).collect()
}

/// The gradient seen by few samples: each pixel times a number from 0 to 2 of its own, mean 1.
fn noisy() -> Vec<Pixel> {
    let mut state = 1_u32;
    let mut random = || {
        // Numerical Recipes' linear congruential generator.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32
    };
    gradient().into_iter().map(|value| [value * random(); 3]).collect()
}

fn root_mean_square_error(pixels: &[Pixel]) -> f64 {
    let errors = pixels.iter().zip(gradient()).map(|(pixel, exact)| f64::from(pixel[1] - exact));
    (errors.map(|error| error * error).sum::<f64>() / (SIDE * SIDE) as f64).sqrt()
}

/// To the edges and corners; more exact than two parts in a thousand the library is nowhere.
#[test]
fn a_picture_without_noise_stays_what_it_is() {
    let Some(denoiser) = library(1) else { return };
    for color in [[1.0, 0.5, 0.25], [0.01; 3], [500.0; 3]] {
        let after = denoised(&denoiser, &[color; SIDE * SIDE], grey);
        let parts = after.iter().flat_map(|pixel| (0..3).map(|i| pixel[i] / color[i]));
        let worst = parts.map(|part| (part - 1.0).abs()).fold(0.0, f32::max);
        assert!(worst < 3e-3, "{color:?}: {worst}");
    }
}

#[test]
fn most_of_the_noise_goes() {
    let Some(denoiser) = library(1) else { return };
    let before = root_mean_square_error(&noisy());
    let after = root_mean_square_error(&denoised(&denoiser, &noisy(), grey));
    assert!(before > 0.5 && after < before / 5.0, "{before} {after}");
}

/// A dark and a bright half, both under the same noisy light.
#[test]
fn guides_keep_edges() {
    let Some(denoiser) = library(1) else { return };
    let albedo = |i: usize| if i % SIDE < SIDE / 2 { 0.2 } else { 0.8 };
    let light = noisy().into_iter().zip(gradient()).map(|(noisy, exact)| noisy[0] / exact);
    let radiance: Vec<_> = light.enumerate().map(|(i, light)| [albedo(i) * light; 3]).collect();
    let after = denoised(&denoiser, &radiance, albedo);
    let column = |x: usize| (0..SIDE).map(|y| after[y * SIDE + x][1]).sum::<f32>() / SIDE as f32;
    let [dark, bright] = [SIDE / 2 - 1, SIDE / 2].map(column);
    assert!((dark - 0.2).abs() < 0.04 && (bright - 0.8).abs() < 0.08, "{dark} {bright}");
}

#[test]
fn threads_do_not_change_the_picture() {
    let (Some(one), Some(three)) = (library(1), library(3)) else { return };
    assert_eq!(denoised(&one, &noisy(), grey), denoised(&three, &noisy(), grey));
}

#[test]
fn margins_mirror_the_picture() {
    let places: Vec<_> = mirrored(20).collect();
    assert_eq!([0, 15, 16, 35, 36, 51].map(|i| places[i]), [16, 1, 0, 19, 18, 3]);
    let narrow: Vec<_> = mirrored(3).skip(10).take(9).collect();
    assert_eq!(narrow, [2, 1, 0, 1, 2, 1, 0, 1, 2]);
    assert!(mirrored(1).eq([0; 33]));
    let pixels: Vec<_> = (0..15).map(|i| [i as f32; 3]).collect();
    assert_eq!(unframed(&framed(&pixels, [5, 3]), [5, 3]), pixels);
}

#[test]
fn it_tells_its_version() {
    let Some(denoiser) = library(1) else { return };
    let name = denoiser.name();
    assert!(name.starts_with("Open Image Denoise 2.") && name.ends_with(" on the CPU"), "{name}");
}

#[test]
fn a_library_that_is_another_is_refused() {
    let refused = |path: &str| Denoiser::load(Path::new(path), 1).err().expect("refused");
    assert!(refused("no-such-library.so").contains("no-such-library.so"));
    #[cfg(target_os = "linux")]
    assert_eq!(refused("libc.so.6"), "libc.so.6 is not version 2");
}
