//! Quantities as colours, with a legend: maps of luminance and illuminance.

use crate::color::{ColorMap, Rgb};
use crate::image::Image;

/// The part of all values that may lie above the scale, and below it.
const CUT: f64 = 0.005;
/// Ratio of the ends from which on a scale is logarithmic.
const WIDE: f64 = 30.0;
/// Picture heights that one dot of the legend's letters is for.
const DOT_HEIGHT: u32 = 360;
/// Width and height of a letter in dots, and from letter to letter.
const LETTER: [u32; 3] = [5, 7, 6];

/// A scale of colours for a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// What the first and the last colour stand for. A scale that starts at 0 is linear; one whose ends are far apart is
    /// logarithmic.
    pub ends: [f64; 2],
    /// The unit that is written above it.
    pub unit: String,
}

impl Scale {
    /// A scale with round ends on which nearly all of `values` lie; those that are 0 or not finite do not count.
    pub fn around(values: &[f64], unit: &str) -> Self {
        let mut lit: Vec<f64> =
            values.iter().copied().filter(|v| *v > 0.0 && v.is_finite()).collect();
        lit.sort_by(f64::total_cmp);
        let at = |part: f64| lit.get((part * lit.len() as f64) as usize).copied();
        let (low, high) = (at(CUT).unwrap_or(1.0), at(1.0 - CUT).unwrap_or(1.0));
        // No more than four powers of ten: what is darker is as good as dark.
        let low = low.max(1e-4 * high);
        let ends = match high / low > WIDE {
            true => [round(low, f64::floor), round(high, f64::ceil)],
            false => [0.0, round(high, f64::ceil)],
        };
        Self { ends, unit: unit.into() }
    }

    fn is_logarithmic(&self) -> bool {
        self.ends[0] > 0.0 && self.ends[1] / self.ends[0] > WIDE
    }

    /// Where a value is between the ends, 0..1.
    fn place(&self, value: f64) -> f64 {
        let [low, high] = self.ends;
        let place = match self.is_logarithmic() {
            true => (value / low).ln() / (high / low).ln(),
            false => (value - low) / (high - low),
        };
        place.clamp(0.0, 1.0)
    }

    /// The values that are written beside it.
    fn marks(&self) -> Vec<f64> {
        let [low, high] = self.ends;
        if self.is_logarithmic() {
            let powers = low.log10().ceil() as i32..=high.log10().floor() as i32;
            let few = powers.clone().count() < 3;
            let steps = if few { &[1.0, 2.0, 5.0][..] } else { &[1.0] };
            let all = (powers.start() - 1..=*powers.end())
                .flat_map(|power| steps.iter().map(move |step| step * 10_f64.powi(power)));
            return all.filter(|mark| *mark >= 0.999 * low && *mark <= 1.001 * high).collect();
        }
        (0..=5).map(|i| low + 0.2 * f64::from(i) * (high - low)).collect()
    }
}

/// The next of 1, 2 and 5 times a power of ten in the direction of `rounding`.
fn round(value: f64, rounding: fn(f64) -> f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    let up = rounding(0.5) > 0.0;
    let fits = |step: &&f64| match up {
        true => **step * power >= 0.999 * value,
        false => **step * power <= 1.001 * value,
    };
    let found = if up { steps.iter().find(fits) } else { steps.iter().rev().find(fits) };
    found.map_or(value, |step| step * power)
}

/// A picture of `values`, row by row, in the colours of a scale, which is drawn beside its right edge unless the picture is too
/// small for letters. What is 0 or not finite is black. It is to be shown as it is, without exposure.
pub fn false_color(values: &[f64], [width, height]: [u32; 2], scale: &Scale) -> Image {
    let color = |value: &f64| match *value > 0.0 && value.is_finite() {
        true => ColorMap::Viridis.color(scale.place(*value) as f32),
        false => Rgb::ZERO,
    };
    let legend = Legend::of(scale, height);
    let mut image = Image::new(width + legend.as_ref().map_or(0, Legend::width), height);
    for (place, value) in (0..).zip(values) {
        image.set(place % width, place / width, color(value));
    }
    if let Some(legend) = legend {
        legend.draw(&mut image, width);
    }
    image
}

/// A bar of colours with numbers beside it.
struct Legend<'a> {
    scale: &'a Scale,
    height: u32,
    /// The values that are written, and how.
    marks: Vec<(f64, String)>,
    /// Side of a dot of its letters, pixels.
    dot: u32,
}

impl<'a> Legend<'a> {
    /// For a picture so high, if there is room for its letters.
    fn of(scale: &'a Scale, height: u32) -> Option<Self> {
        let marks = scale.marks().into_iter().map(|mark| (mark, written(mark))).collect();
        let legend = Self { scale, height, marks, dot: (height / DOT_HEIGHT).max(1) };
        (8 * legend.line() <= height).then_some(legend)
    }

    fn line(&self) -> u32 {
        LETTER[1] * self.dot
    }

    fn margin(&self) -> u32 {
        4 * self.dot
    }

    /// Width of the bar.
    fn bar(&self) -> u32 {
        10 * self.dot
    }

    /// Width of all of it.
    fn width(&self) -> u32 {
        let longest = self.marks.iter().map(|(_, text)| text.len()).max().unwrap_or(0);
        let longest = longest.max(self.scale.unit.len()) as u32;
        3 * self.margin() + self.bar() + longest * LETTER[2] * self.dot
    }

    /// Draws it with its left edge in this column.
    fn draw(&self, image: &mut Image, left: u32) {
        let Self { scale, height, dot, .. } = *self;
        let (line, margin, bar) = (self.line(), self.margin(), self.bar());
        let top = margin + 2 * line;
        let length = height - top - 2 * margin;
        fill(image, [left + margin, top, bar, length], |y| {
            ColorMap::Viridis.color(1.0 - y as f32 / (length - 1).max(1) as f32)
        });
        let text = left + 2 * margin + bar;
        write(image, [left + margin, margin], dot, &scale.unit);
        for (mark, name) in &self.marks {
            let y = top + ((1.0 - scale.place(*mark)) * f64::from(length - 1)).round() as u32;
            fill(image, [left + margin, y, bar + margin / 2, 1], |_| Rgb::ONE);
            let y = y.saturating_sub(line / 2).min(height - line - 1);
            write(image, [text, y], dot, name);
        }
    }
}

/// A number as short as it can be: `0.5`, `2000`, `1e5`.
fn written(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let plain = rounded.to_string();
    let short = format!("{rounded:e}");
    if plain.len() > 5 && short.len() < plain.len() { short } else { plain }
}

/// Colours the pixels of a rectangle (left, top, width, height) by their rows in it.
fn fill(image: &mut Image, [x, y, width, height]: [u32; 4], color: impl Fn(u32) -> Rgb) {
    for iy in y..(y + height).min(image.height()) {
        for ix in x..(x + width).min(image.width()) {
            image.set(ix, iy, color(iy - y));
        }
    }
}

/// Writes a text in white, each of its dots so many pixels wide.
fn write(image: &mut Image, [x, y]: [u32; 2], dot: u32, text: &str) {
    for (place, letter) in (0..).zip(text.chars()) {
        for (row, bits) in (0..).zip(glyph(letter)) {
            for column in (0..LETTER[0]).filter(|column| bits >> (4 - column) & 1 == 1) {
                let corner = [x + (place * LETTER[2] + column) * dot, y + row * dot];
                fill(image, [corner[0], corner[1], dot, dot], |_| Rgb::ONE);
            }
        }
    }
}

/// The rows of a letter, five bits each; a blank for letters that no legend has.
fn glyph(letter: char) -> [u8; 7] {
    match letter {
        '0' => [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111],
        '3' => [0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        '.' => [0, 0, 0, 0, 0, 0b01100, 0b01100],
        '-' => [0, 0, 0, 0b11111, 0, 0, 0],
        'e' => [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110],
        'i' => [0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110],
        'l' => [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        'n' => [0, 0, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001],
        't' => [0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110],
        'x' => [0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001],
        _ => [0; 7],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_have_round_ends() {
        let of = |values: &[f64]| Scale::around(values, "lx").ends;
        assert_eq!(of(&[3.0, 40.0, 700.0]), [2.0, 1000.0]);
        assert_eq!(of(&[30.0, 40.0, 70.0, 0.0, f64::NAN]), [0.0, 100.0]);
        assert_eq!(of(&[1e-9, 50.0, 50.0]), [0.005, 50.0]);
        assert_eq!(of(&[0.0, 0.0]), [0.0, 1.0]);
    }

    #[test]
    fn marks_are_where_their_colours_are() {
        let scale = Scale { ends: [1.0, 10_000.0], unit: "lx".into() };
        assert_eq!(scale.marks(), [1.0, 10.0, 100.0, 1000.0, 10_000.0]);
        assert!((scale.place(100.0) - 0.5).abs() < 1e-12);
        let scale = Scale { ends: [0.0, 50.0], unit: "lx".into() };
        assert_eq!(scale.marks()[5], 50.0);
        assert_eq!(
            [0.5, 2000.0, 1e5, 0.001, 20_000.0].map(written),
            ["0.5", "2000", "1e5", "0.001", "20000"]
        );
        for letter in scale.unit.chars().chain(written(1.5e-7).chars()) {
            assert_ne!(glyph(letter), [0; 7], "{letter}");
        }
    }

    /// The colour of a pixel can be read off the bar.
    #[test]
    fn the_legend_is_beside_the_picture() {
        let scale = Scale { ends: [1.0, 10_000.0], unit: "lx".into() };
        let image = false_color(&vec![100.0; 320 * 200], [320, 200], &scale);
        let color = image.get(5, 100);
        assert_eq!(color, ColorMap::Viridis.color(0.5));
        assert_eq!(image.width(), 320 + 52);
        assert!((0..320 * 200).all(|place| image.get(place % 320, place / 320) == color));
        let column: Vec<_> = (0..200).map(|y| image.get(320 + 9, y)).collect();
        let near = column.iter().position(|c| c.distance(color) < 0.02);
        assert!(near.is_some_and(|y| (90..130).contains(&y)), "{near:?}");
        let small = false_color(&[1.0; 4], [2, 2], &scale);
        assert_eq!(small.get(1, 1), ColorMap::Viridis.color(0.0));
    }
}
