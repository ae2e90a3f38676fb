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
}

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
    /// Pc
    pub(super) clearcoat: Option<f32>,
    /// Pcr
    pub(super) clearcoat_roughness: Option<f32>,
    /// aniso
    pub(super) anisotropy: Option<f32>,
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
            // One name with blanks, or several names.
            let whole = [names.as_str()];
            let several: Vec<&str> = names.split_whitespace().take(MOST_LIBRARIES).collect();
            let files = if access.resolve(names).is_ok() { &whole } else { several.as_slice() };
            for file in files {
                let file = file.replace('\\', "/");
                match access.read(&file) {
                    Ok(bytes) => library.read(&bytes, &file)?,
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
                Ok(false) => self.unknown.add(|| line.place(name)),
                Err(_) => self.numbers.add(|| line.place(name)),
            }
        }
        Ok(())
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

fn missing(file: &str, error: &Diagnostic, place: &Place) -> Diagnostic {
    let message =
        format!("cannot use the material file {}: {}", quoted(file.as_bytes()), error.message);
    let help = Some("its materials are shown in matte grey".into());
    Diagnostic { message, place: place.clone(), help, ..Diagnostic::default() }
}

impl Mtl {
    /// Takes in one line; `false`: its keyword is unknown.
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
            "pc" => self.clearcoat = Some(number(words)?),
            "pcr" => self.clearcoat_roughness = Some(number(words)?),
            "aniso" => self.anisotropy = Some(number(words)?),
            "anisor" => self.anisotropy_rotation = Some(number(words)?),
            "ka" | "map_ka" | "map_ns" | "map_ps" | "refl" | "sharpness" => {}
            "norm" | "map_kn" => self.normal_map = Some(Map::read(line, name)?),
            "map_bump" | "bump" => self.bump_map = Some(Map::read(line, name)?),
            "disp" | "decal" => {}
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
        let (mut scale, mut offset, mut wrap) = (Vec2::ONE, Vec2::ZERO, Wrap::Repeat);
        let (mut file, mut strength) = (text.as_str(), 1.0);
        while file.starts_with('-') {
            let (option, after) = first_word(file);
            let (value, after_one) = first_word(after);
            file = match option {
                "-s" => up_to_three(after, &mut scale),
                "-o" => up_to_three(after, &mut offset),
                "-t" => up_to_three(after, &mut Vec2::default()),
                "-mm" => first_word(after_one).1,
                "-clamp" | "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-texres" | "-bm"
                | "-boost" | "-type" => after_one,
                _ => break,
            };
            match option {
                "-clamp" if value == "on" => wrap = Wrap::Clamp,
                "-bm" => strength = number(std::iter::once(value.as_bytes()))?,
                _ => {}
            }
        }
        if file.is_empty() {
            return Err("no picture named".into());
        }
        let file = seen_from_model(name, &file.replace('\\', "/"));
        let transform = UvTransform::from_scale_angle_translation(scale, 0.0, offset);
        Ok(Self { file, transform, wrap, strength, place: line.place(name) })
    }
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

/// The path of `file`, which the material file `library` names, seen from the model's folder.
fn seen_from_model(library: &str, file: &str) -> String {
    match library.rsplit_once('/') {
        Some((folder, _)) if !file.starts_with('/') => format!("{folder}/{file}"),
        _ => file.to_owned(),
    }
}
