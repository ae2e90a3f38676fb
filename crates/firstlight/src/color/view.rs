//! From scene to screen: how bright light is brought into what a display can show.

use super::{Rgb, srgb_decode};
use glam::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

/// What a developed picture looks like. All but [`View::Srgb`] and [`View::Raw`] bend the bright end, so that lights
/// keep their shape; a colour that is typed in comes out as typed by [`View::Srgb`] alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum View {
    /// As it is, cut off at white.
    #[default]
    Srgb,
    /// Colours as they are up to 0.8, then compressed towards white (Khronos PBR Neutral).
    Neutral,
    /// Soft and pale, as film: colours fade as they get brighter (Sobotka's AgX, by Wrensch's polynomial).
    Agx,
    /// Strong contrast (ACES RRT and ODT, by Hill's fit).
    Aces,
    /// The curve of a film with a toe and a shoulder (Hable 2010).
    Filmic,
    /// Linear numbers without sRGB encoding, cut off at 1.
    Raw,
}

impl View {
    /// Their names, as users write them.
    pub const NAMES: [(&str, Self); 6] = [
        ("srgb", Self::Srgb),
        ("neutral", Self::Neutral),
        ("agx", Self::Agx),
        ("aces", Self::Aces),
        ("filmic", Self::Filmic),
        ("raw", Self::Raw),
    ];

    /// The name that users write.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, view)| *view == self).map_or("srgb", |(name, _)| name)
    }

    /// The view of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, view)| *view)
    }

    /// Linear display values 0..1 of exposed light; NaN becomes 0.
    pub fn display(self, light: Rgb) -> Rgb {
        let light = light.map(|channel| if channel > 0.0 { channel.min(1e6) } else { 0.0 });
        let display = match self {
            Self::Srgb => light,
            Self::Neutral => neutral(light),
            Self::Agx => agx(light),
            Self::Aces => aces(light),
            Self::Filmic => hable(2.0 * light) / hable(Vec3::splat(11.2)),
            // The encoding that follows gives the number back.
            Self::Raw => light.min(Rgb::ONE).map(srgb_decode),
        };
        display.clamp(Rgb::ZERO, Rgb::ONE)
    }
}

/// Khronos, *PBR Neutral Tone Mapping*, 2024.
fn neutral(light: Rgb) -> Rgb {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = light.min_element();
    let light = light - if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let peak = light.max_element();
    if peak < START {
        return light;
    }
    let room = 1.0 - START;
    let lowered = 1.0 - room * room / (peak + room - START);
    let fade = 1.0 - 1.0 / (DESATURATION * (peak - lowered) + 1.0);
    (light * (lowered / peak)).lerp(Vec3::splat(lowered), fade)
}

/// Troy Sobotka's AgX; the curve as Benjamin Wrensch fitted it (*Minimal AgX Implementation*, 2023).
fn agx(light: Rgb) -> Rgb {
    const DARKEST: f32 = -12.47393;
    const BRIGHTEST: f32 = 4.026069;
    let inset = Mat3::from_cols_array(&[
        0.842_479_1,
        0.042_328_24,
        0.042_375_66,
        0.078_433_6,
        0.878_468_64,
        0.078_433_6,
        0.079_223_745,
        0.079_166_13,
        0.879_143,
    ]);
    let stops = (inset * light).map(|x| x.max(1e-10).log2().clamp(DARKEST, BRIGHTEST));
    let encoded = ((stops - DARKEST) / (BRIGHTEST - DARKEST)).map(|x| {
        let (x2, x4) = (x * x, x * x * x * x);
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
            - 0.00232
    });
    (inset.inverse() * encoded).map(|x| x.max(0.0).powf(2.2))
}

/// Stephen Hill's fit of the ACES reference rendering and output transforms.
fn aces(light: Rgb) -> Rgb {
    let into = Mat3::from_cols_array(&[
        0.59719, 0.076, 0.0284, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777,
    ]);
    let out = Mat3::from_cols_array(&[
        1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602,
    ]);
    let curve = |x: f32| {
        (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081)
    };
    out * (into * light).map(curve)
}

/// John Hable, *Filmic Games*, GDC 2010.
fn hable(x: Vec3) -> Vec3 {
    let (a, b, c, d, e, f) = (0.15, 0.5, 0.1, 0.2, 0.02, 0.3);
    (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_is_black_at_black_and_rises_to_white() {
        for (name, view) in View::NAMES {
            let at = |x: f32| view.display(Rgb::splat(x)).y;
            assert!(at(0.0) < 0.002, "{name}");
            let values: Vec<f32> = (0..60).map(|i| at(0.001 * 1.3_f32.powi(i))).collect();
            assert!(values.windows(2).all(|pair| pair[0] <= pair[1] + 1e-4), "{name}: {values:?}");
            assert!(at(1e4) > 0.95 && at(f32::INFINITY) <= 1.0, "{name}: {}", at(1e4));
            assert_eq!(at(f32::NAN), at(0.0));
        }
    }

    #[test]
    fn typed_colours_come_out_as_typed() {
        let color = Rgb::new(0.2, 0.5, 0.9);
        assert_eq!(View::Srgb.display(color), color);
        // Neutral keeps the base colours of diffuse surfaces, less the 4 % that gloss adds.
        let seen = View::Neutral.display(Rgb::new(0.24, 0.54, 0.64));
        assert!((seen - Rgb::new(0.2, 0.5, 0.6)).abs().max_element() < 1e-6, "{seen}");
        let raw = View::Raw.display(Rgb::splat(0.5)).x;
        assert!((crate::color::srgb_encode(raw) - 0.5).abs() < 1e-6);
    }

    /// Middle grey: AgX turns its curve at half of the encoded range there; Neutral takes 0.04 away; the others follow
    /// from their formulas, whose matrices leave greys grey.
    #[test]
    fn middle_grey_stays_in_the_middle() {
        for (view, expected, tolerance) in [
            (View::Agx, 0.5_f32.powf(2.2), 4e-3),
            (View::Neutral, 0.14, 1e-6),
            (View::Aces, 0.105591, 1e-3),
            (View::Filmic, 0.128338, 1e-5),
        ] {
            let grey = view.display(Rgb::splat(0.18)).y;
            assert!((grey - expected).abs() < tolerance, "{view:?}: {grey}");
        }
    }
}
