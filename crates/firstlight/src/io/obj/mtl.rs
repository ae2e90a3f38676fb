//! MTL, the material files of OBJ.

use super::faces::MOST_MATERIALS;
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::io::text::{Line, Lines, Parsed, Tally, counted, float, floats, lossy, quoted};
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{UvTransform, Wrap};
use glam::Vec2;
use indexmap::IndexMap;

/// More material files than this are not opened for one model.
const MOST_LIBRARIES: usize = 256;

/// The materials of all material files of a model. If two have the same name, the later one counts.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: IndexMap<String, Mtl>,
    twice: Tally,
    unknown: Tally,
    numbers: Tally,
    /// As many as [`NOT_SHOWN`].
    not_shown: [Tally; NOT_SHOWN.len()],
}

/// Keywords that are known and not shown, and what is there instead.
const NOT_SHOWN: [(&str, &str); 5] = [
    ("disp", "surfaces are not moved; map_bump shows relief"),
    ("decal", "no picture is laid over another"),
    ("refl", "what mirrors shows the scene around it"),
    ("map_Ns", "gloss is the same everywhere; map_Pr varies it"),
    ("map_Tr", "nothing is cut out; map_d does that"),
];

/// A material as its file gives it; `None` is what the file does not say.
#[derive(Debug, Default)]
pub(super) struct Mtl {
    pub(super) place: Place,
    /// Kd
    pub(super) diffuse: Option<Rgb>,
    /// map_Kd
    pub(super) diffuse_map: Option<Map>,
    /// Ke
    pub(super) emission: Option<Rgb>,
    /// map_Ke
    pub(super) emission_map: Option<Map>,
    /// d: 1 is solid.
    pub(super) opacity: Option<f32>,
    /// Tr: 0 is solid.
    pub(super) transparency: Option<f32>,
    /// map_d
    pub(super) opacity_map: Option<Map>,
    /// Ks
    pub(super) specular: Option<Rgb>,
    /// Ns
    pub(super) shininess: Option<f32>,
    /// Ni
    pub(super) index: Option<f32>,
    /// Tf
    pub(super) filter: Option<Rgb>,
    /// illum
    pub(super) illumination: Option<f32>,
    /// map_Ks
    pub(super) specular_map: Option<Map>,
    /// Pr
    pub(super) roughness: Option<f32>,
    /// map_Pr
    pub(super) roughness_map: Option<Map>,
    /// Pm
    pub(super) metallic: Option<f32>,
    /// map_Pm
    pub(super) metallic_map: Option<Map>,
    /// Ps
    pub(super) sheen: Option<f32>,
    /// map_Ps
    pub(super) sheen_map: Option<Map>,
    /// Pc
    pub(super) clearcoat: Option<f32>,
    /// map_Pc
    pub(super) clearcoat_map: Option<Map>,
    /// Pcr
    pub(super) clearcoat_roughness: Option<f32>,
    /// map_Pcr
    pub(super) clearcoat_roughness_map: Option<Map>,
    /// aniso
    pub(super) anisotropy: Option<f32>,
    /// map_aniso
    pub(super) anisotropy_map: Option<Map>,
    /// norm
    pub(super) normal_map: Option<Map>,
    /// map_bump
    pub(super) bump_map: Option<Map>,
    /// anisor, turns
    pub(super) anisotropy_rotation: Option<f32>,
}

/// A picture and how it lies on the surface.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    /// Its path, seen from the model's folder.
    pub(super) file: String,
    pub(super) transform: UvTransform,
    pub(super) wrap: Wrap,
    /// -bm: how high the picture is, or how much its normals bend.
    pub(super) strength: f32,
    /// -imfchan: which channel a number is read from, 0 to 3 for red, green, blue and alpha.
    pub(super) channel: Option<usize>,
    /// -mm: what the picture is multiplied by, and what is added to that.
    pub(super) gain: f32,
    pub(super) base: f32,
    pub(super) place: Place,
}

impl Library {
    /// Opens the files that `mtllib` lines name; what is not there becomes a warning.
    pub(super) fn open(
        named: &IndexMap<String, Place>,
        access: &FileAccess,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut library = Self::default();
        for (names, place) in named.iter().take(MOST_LIBRARIES) {
            for file in files(&names.replace('\\', "/"), access) {
                match access.read_meant(&file) {
                    Ok((bytes, None)) => library.read(&bytes, &file)?,
                    Ok((bytes, Some(meant))) => {
                        warnings.push(moved(&file, &meant, place));
                        library.read(&bytes, &meant)?;
                    }
                    Err(error) => warnings.push(missing(&file, &error, place)),
                }
            }
        }
        if named.len() > MOST_LIBRARIES {
            let place = named.values().last().cloned().unwrap_or_default();
            let message = format!("only the first {MOST_LIBRARIES} material files are opened");
            warnings.push(Diagnostic { message, place, ..Diagnostic::default() });
        }
        library.warn(warnings);
        Ok(library)
    }

    fn warn(&mut self, warnings: &mut Warnings) {
        std::mem::take(&mut self.twice).warn(warnings, |count| {
            format!("{} described twice: the later one counts", counted(count, "material"))
        });
        std::mem::take(&mut self.unknown).warn(warnings, |count| {
            format!("{} with an unknown keyword skipped", counted(count, "line"))
        });
        std::mem::take(&mut self.numbers).warn(warnings, |count| {
            format!("{} without a readable value skipped", counted(count, "line"))
        });
        for (tally, (keyword, instead)) in self.not_shown.iter_mut().zip(NOT_SHOWN) {
            std::mem::take(tally).warn(warnings, |count| {
                format!("{} with {keyword} skipped: {instead}", counted(count, "line"))
            });
        }
    }

    /// Reads the file called `name`.
    fn read(&mut self, bytes: &[u8], name: &str) -> Result<()> {
        let mut current: Option<usize> = None;
        for line in Lines::joined(bytes) {
            let Some(keyword) = line.words().next() else { continue };
            if keyword == b"newmtl" {
                current = Some(self.add(&line, name)?);
                continue;
            }
            let material = current.and_then(|index| self.materials.get_index_mut(index));
            let Some((_, material)) = material else { continue };
            match material.read_line(&line, name) {
                Ok(true) => {}
                Ok(false) => self.left_out(keyword).add(|| line.place(name)),
                Err(_) => self.numbers.add(|| line.place(name)),
            }
        }
        Ok(())
    }

    /// The tally of lines with a keyword that is not shown.
    fn left_out(&mut self, keyword: &[u8]) -> &mut Tally {
        let known = |(known, _): &(&str, _)| keyword.eq_ignore_ascii_case(known.as_bytes());
        match NOT_SHOWN.iter().position(known) {
            Some(index) => &mut self.not_shown[index],
            None => &mut self.unknown,
        }
    }

    fn add(&mut self, line: &Line<'_>, name: &str) -> Result<usize> {
        if self.materials.len() == MOST_MATERIALS {
            let cause = format!("more than {MOST_MATERIALS} materials");
            return Err(Box::new(line.complain(name, cause)));
        }
        let material = Mtl { place: line.place(name), ..Mtl::default() };
        let (index, before) = self.materials.insert_full(line.after_keyword(), material);
        self.twice.add_line_if(before.is_some(), name, line);
        Ok(index)
    }
}

/// The files that a line names: one with blanks in its name or its folder's, or several.
fn files(names: &str, access: &FileAccess) -> Vec<String> {
    let several: Vec<&str> = names.split_whitespace().take(MOST_LIBRARIES).collect();
    let whole = match several.iter().all(|name| name.to_ascii_lowercase().ends_with(".mtl")) {
        true => access.resolve(names).is_ok(),
        false => access.read_meant(names).is_ok(),
    };
    if whole { vec![names.to_owned()] } else { several.into_iter().map(str::to_owned).collect() }
}

fn moved(file: &str, meant: &str, place: &Place) -> Diagnostic {
    let [file, meant] = [file, meant].map(|name| quoted(name.as_bytes()));
    let message = format!(
        "a material file cannot be opened where the model says: {file}, for which {meant} is taken"
    );
    Diagnostic { message, place: place.clone(), ..Diagnostic::default() }
}

fn missing(file: &str, error: &Diagnostic, place: &Place) -> Diagnostic {
    let message =
        format!("cannot use the material file {}: {}", quoted(file.as_bytes()), error.message);
    let help = Some("its materials are shown in matte grey".into());
    Diagnostic { message, place: place.clone(), help, ..Diagnostic::default() }
}

impl Mtl {
    /// Takes in one line; `false`: its keyword is none of those that are shown.
    fn read_line(&mut self, line: &Line<'_>, name: &str) -> Parsed<bool> {
        let mut words = line.words();
        let keyword = lossy(words.next().unwrap_or_default()).to_ascii_lowercase();
        match keyword.as_str() {
            "kd" => self.diffuse = Some(color(words)?),
            "ke" => self.emission = Some(color(words)?),
            "d" => self.opacity = Some(opacity(words)?),
            "tr" => self.transparency = Some(opacity(words)?),
            "map_kd" => self.diffuse_map = Some(Map::read(line, name)?),
            "map_ke" => self.emission_map = Some(Map::read(line, name)?),
            "map_d" => self.opacity_map = Some(Map::read(line, name)?),
            "ks" => self.specular = Some(color(words)?),
            "ns" => self.shininess = Some(number(words)?),
            "ni" => self.index = Some(number(words)?),
            "tf" => self.filter = Some(color(words)?),
            "illum" => self.illumination = Some(number(words)?),
            "map_ks" => self.specular_map = Some(Map::read(line, name)?),
            "pr" => self.roughness = Some(number(words)?),
            "map_pr" => self.roughness_map = Some(Map::read(line, name)?),
            "pm" => self.metallic = Some(number(words)?),
            "map_pm" => self.metallic_map = Some(Map::read(line, name)?),
            "ps" => self.sheen = Some(number(words)?),
            "map_ps" => self.sheen_map = Some(Map::read(line, name)?),
            "pc" => self.clearcoat = Some(number(words)?),
            "map_pc" => self.clearcoat_map = Some(Map::read(line, name)?),
            "pcr" => self.clearcoat_roughness = Some(number(words)?),
            "map_pcr" => self.clearcoat_roughness_map = Some(Map::read(line, name)?),
            "aniso" => self.anisotropy = Some(number(words)?),
            "map_aniso" => self.anisotropy_map = Some(Map::read(line, name)?),
            "anisor" => self.anisotropy_rotation = Some(number(words)?),
            "ka" | "map_ka" | "sharpness" => {}
            "norm" | "map_kn" => self.normal_map = Some(Map::read(line, name)?),
            "map_bump" | "bump" => self.bump_map = Some(Map::read(line, name)?),
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// Red, green and blue; a single number is grey.
fn color<'a>(words: impl Iterator<Item = &'a [u8]>) -> Parsed<Rgb> {
    let words: Vec<&[u8]> = words.take(3).collect();
    let color = match words.as_slice() {
        [grey] => Rgb::splat(floats::<1>(&mut [*grey].into_iter())?[0]),
        words => Rgb::from(floats(&mut words.iter().copied())?),
    };
    if color.is_finite() { Ok(color) } else { Err("not finite".into()) }
}

/// A finite number.
fn number<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Parsed<f32> {
    let [number] = floats(&mut words)?;
    if number.is_finite() { Ok(number) } else { Err("not finite".into()) }
}

/// A fraction 0..1, perhaps after `-halo`.
fn opacity<'a>(words: impl Iterator<Item = &'a [u8]>) -> Parsed<f32> {
    let [value] = floats(&mut words.filter(|word| *word != b"-halo"))?;
    if value.is_nan() { Err("not a number".into()) } else { Ok(value.clamp(0.0, 1.0)) }
}

impl Map {
    /// Reads `map_… [options] file`, where the file may have blanks in its name.
    fn read(line: &Line<'_>, name: &str) -> Parsed<Self> {
        let text = line.after_keyword();
        let (mut map, mut rest) = (Self::plain(line.place(name)), text.as_str());
        let (mut scale, mut offset) = (Vec2::ONE, Vec2::ZERO);
        while rest.starts_with('-') {
            let (option, after) = first_word(rest);
            let (value, after_one) = first_word(after);
            let number = |word: &str| number(std::iter::once(word.as_bytes()));
            rest = match option {
                "-s" => up_to_three(after, &mut scale),
                "-o" => up_to_three(after, &mut offset),
                "-t" => up_to_three(after, &mut Vec2::default()),
                "-mm" => first_word(after_one).1,
                "-clamp" | "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-texres" | "-bm"
                | "-boost" | "-type" => after_one,
                _ => break,
            };
            match option {
                "-clamp" if value == "on" => map.wrap = Wrap::Clamp,
                "-bm" => map.strength = number(value)?,
                "-imfchan" => map.channel = channel(value),
                "-mm" => (map.base, map.gain) = (number(value)?, number(first_word(after_one).0)?),
                _ => {}
            }
        }
        if rest.is_empty() {
            return Err("no picture named".into());
        }
        let file = rest.strip_prefix('"').and_then(|f| f.strip_suffix('"')).unwrap_or(rest);
        let file = seen_from_model(name, &file.replace('\\', "/"));
        let transform = UvTransform::from_scale_angle_translation(scale, 0.0, offset);
        Ok(Self { file, transform, ..map })
    }

    /// Without options, and yet without a picture.
    fn plain(place: Place) -> Self {
        let (transform, wrap) = (UvTransform::IDENTITY, Wrap::Repeat);
        let (strength, gain) = (1.0, 1.0);
        Self {
            file: String::new(),
            transform,
            wrap,
            strength,
            channel: None,
            gain,
            base: 0.0,
            place,
        }
    }
}

/// The channel that `-imfchan` names. Luminance is red, as in all pictures of numbers; depth is in none.
fn channel(name: &str) -> Option<usize> {
    let name = if name == "l" { "r" } else { name };
    ["r", "g", "b", "m"].iter().position(|channel| *channel == name)
}

/// The first word of a text without blanks around it, and the rest.
fn first_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Takes up to three numbers in front of a file name, of which two count; returns what follows.
fn up_to_three<'a>(mut text: &'a str, values: &mut Vec2) -> &'a str {
    let mut unused = 0.0;
    for value in [&mut values.x, &mut values.y, &mut unused] {
        let (word, rest) = first_word(text);
        match float(word.as_bytes()) {
            Some(number) if number.is_finite() && !rest.is_empty() => *value = number,
            _ => break,
        }
        text = rest;
    }
    text
}

/// Whether a path starts at the root of a disk, here or on Windows.
fn is_absolute(path: &str) -> bool {
    path.starts_with('/') || path.get(1..3) == Some(":/")
}

/// The path of `file`, which the material file `library` names, seen from the model's folder.
fn seen_from_model(library: &str, file: &str) -> String {
    match library.rsplit_once('/') {
        Some((folder, _)) if !is_absolute(file) => format!("{folder}/{file}"),
        _ => file.to_owned(),
    }
}
