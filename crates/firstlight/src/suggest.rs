//! "Did you mean": the known word nearest to what was typed.

/// Longer words are not compared: nobody mistypes them, and the comparison costs their product.
const LONGEST_WORD: usize = 64;

/// What things are called elsewhere, and here.
const ELSEWHERE: &[(&str, &str)] = &[
    ("albedo", "reflectance"),
    ("base_color", "reflectance"),
    ("diffuse_color", "reflectance"),
    ("emissive", "emission"),
    ("emissive_color", "emission"),
    ("fog", "medium"),
    ("glass", "dielectric"),
    ("hdri", "image"),
    ("ior", "index"),
    ("look_at", "target"),
    ("metal", "conductor"),
    ("origin", "position"),
    ("ortho", "orthographic"),
    ("pbr", "principled"),
    ("plastic", "principled"),
    ("smoke", "medium"),
    ("spp", "samples"),
];

/// The candidate most like `word`, if one is near enough to be meant.
pub(crate) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    if word.len() > LONGEST_WORD {
        return None;
    }
    let word = word.to_lowercase();
    let mut candidates: Vec<_> = candidates.into_iter().collect();
    let here = ELSEWHERE.iter().find(|(elsewhere, here)| {
        *elsewhere == word && candidates.iter().any(|candidate| candidate == here)
    });
    if let Some((_, here)) = here {
        candidates.retain(|candidate| candidate == here);
        return candidates.first().copied();
    }
    let allowed = (word.chars().count() / 3).clamp(1, 3);
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST_WORD)
        .map(|candidate| (strsim::damerau_levenshtein(&word, &candidate.to_lowercase()), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// `; did you mean "candidate"?`, or nothing if no candidate is near.
pub(crate) fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> String {
    nearest(word, candidates).map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"))
}

/// Text from a file in quotation marks, as [`visible`].
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", visible(text))
}

/// Text from a file, fit for a message: control characters replaced, long text cut.
pub(crate) fn visible(text: &str) -> String {
    const LONGEST: usize = 80;
    let start: String = text.chars().take(LONGEST).collect();
    let mut visible = start.replace(char::is_control, "\u{fffd}");
    if text.chars().nth(LONGEST).is_some() {
        visible.push('…');
    }
    visible
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_a_misspelling_but_not_another_word() {
        let known = ["color", "position", "power"];
        assert_eq!(nearest("colour", known), Some("color"));
        assert_eq!(nearest("psoition", known), Some("position"));
        assert_eq!(nearest("Power", known), Some("power"));
        assert_eq!(nearest("radiance", known), None);
        assert_eq!(nearest("metal", ["mirror", "conductor"]), Some("conductor"));
        assert_eq!(nearest("metal", ["metals", "mirror"]), Some("metals"));
        assert_eq!(nearest(&"x".repeat(1 << 20), known), None);
    }

    #[test]
    fn quotes_without_letting_control_characters_through() {
        assert_eq!(quoted("a\u{1b}[31m"), "\"a\u{fffd}[31m\"");
        assert!(quoted(&"é".repeat(1000)).ends_with("…\""));
    }
}
