//! Colours as people write them: CSS names and hexadecimal codes.

use super::srgb_decode;
use crate::suggest;

/// One `name rrggbb` a line; see data/README.md.
const NAMES: &str = include_str!("../../data/css_colors.txt");

/// The linear RGBA colour of a CSS name (`tomato`, any case) or a code `#rgb`, `#rgba`, `#rrggbb`, `#rrggbbaa`.
///
/// Codes and names are sRGB-encoded, as in CSS; alpha is linear, 1 if not given.
///
/// # Errors
/// A sentence that says what a colour looks like and, if one is near, which name may have been meant.
pub fn parse(text: &str) -> Result<[f32; 4], String> {
    let text = text.trim();
    let code = match text.strip_prefix('#') {
        Some(code) => Some(code),
        None => names().find(|(name, _)| name.eq_ignore_ascii_case(text)).map(|(_, code)| code),
    };
    code.and_then(decode_hex).ok_or_else(|| {
        let hint = suggest::did_you_mean(text, names().map(|(name, _)| name));
        let text = suggest::quoted(text);
        format!("needs a colour such as \"#c0392b\" or \"tomato\", not {text}{hint}")
    })
}

fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
    NAMES.lines().filter_map(|line| line.split_once(' '))
}

/// Linear RGBA of 3, 4, 6 or 8 hexadecimal digits.
fn decode_hex(code: &str) -> Option<[f32; 4]> {
    let digits = code.chars().map(|c| c.to_digit(16)).collect::<Option<Vec<_>>>()?;
    let bytes: Vec<u32> = match digits.len() {
        3 | 4 => digits.iter().map(|d| d * 17).collect(),
        6 | 8 => digits.chunks(2).map(|pair| pair.iter().fold(0, |sum, d| sum * 16 + d)).collect(),
        _ => return None,
    };
    let mut rgba = [1.0; 4];
    for (channel, byte) in rgba.iter_mut().zip(bytes) {
        *channel = byte as f32 / 255.0;
    }
    let [r, g, b, alpha] = rgba;
    Some([srgb_decode(r), srgb_decode(g), srgb_decode(b), alpha])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_every_length_of_code() {
        assert_eq!(parse("#fff"), Ok([1.0; 4]));
        assert_eq!(parse("#F00f"), Ok([1.0, 0.0, 0.0, 1.0]));
        assert_eq!(parse("#00ff0000"), Ok([0.0, 1.0, 0.0, 0.0]));
        let [r, g, b, a] = parse("#c0392b").unwrap();
        // By hand: ((0xc0 / 255 + 0.055) / 1.055)^2.4, and so on.
        assert!((r - 0.527_115).abs() < 1e-5, "{r}");
        assert!((g - 0.040_915).abs() < 1e-5, "{g}");
        assert!((b - 0.024_158).abs() < 1e-5, "{b}");
        assert_eq!(a, 1.0);
    }

    #[test]
    fn knows_the_names_of_css_in_any_case() {
        assert_eq!(names().count(), 148);
        assert!(names().all(|(_, code)| code.len() == 6 && decode_hex(code).is_some()));
        assert_eq!(parse("RebeccaPurple"), parse("#663399"));
    }

    #[test]
    fn suggests_a_name() {
        let error = parse("tomatoe").unwrap_err();
        assert!(error.ends_with("not \"tomatoe\"; did you mean \"tomato\"?"), "{error}");
        for wrong in ["", "#", "#12", "#12345", "#gggggg", "#123456789", "#ééé"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
