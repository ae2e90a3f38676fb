//! Parts of a picture: some of its samples, from one run or machine of several, and how they are put together.
//!
//! A part is an OpenEXR picture that can be looked at like any other. Beside its colour it has the film's sums in
//! channels of whole numbers, and it says in an attribute what it is a part of.

use super::access::{read_file, shown};
use super::exr::{check_blocks, first_layer, plane, to_file, utf8};
use super::layers::any_channel;
use super::pixels::{Input, guarded, unreadable};
use super::{Limits, Precision};
use crate::color::View;
use crate::diagnostic::{Diagnostic, Result};
use crate::film::{Film, Pixel};
use crate::layers::Guides;
use crate::scene::description::FilmDescription;
use exr::prelude::{AnyChannel, AttributeValue, FlatSamples, LayerAttributes, MetaData};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Some samples of a picture.
#[derive(Debug, Clone)]
pub struct Part {
    /// What it is a part of.
    pub info: PartInfo,
    /// The sums of its samples.
    pub film: Film,
    /// What a denoiser is to know of the picture, if it is to be denoised.
    pub guides: Option<Guides>,
}

/// What a part is a part of. Only parts that agree in everything but `ranges` belong together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartInfo {
    /// The program and its version.
    pub software: String,
    /// The scene's [`fingerprint`](crate::SceneDescription::fingerprint).
    pub fingerprint: String,
    /// The scene's name.
    pub scene: String,
    /// The camera's name.
    pub camera: String,
    /// Width and height of the whole picture in pixels.
    pub resolution: [u32; 2],
    /// The rectangle of it that was rendered: left, top, width, height in pixels.
    pub crop: [u32; 4],
    /// Samples per pixel of the whole.
    pub samples: u32,
    /// Seed of every random number.
    pub seed: u64,
    /// Stops of exposure; `None`: to be chosen from the picture.
    pub exposure: Option<f64>,
    /// How it is to look.
    pub view: View,
    /// Which samples of each pixel it holds: from the first up to, not including, the second; in order, none twice.
    pub ranges: Vec<[u32; 2]>,
}

/// The attribute that makes a picture a part.
const ATTRIBUTE: &str = "firstlightPart";

/// The bytes of a part's file.
///
/// # Errors
/// If it is too large for the format.
pub fn save_part(info: &PartInfo, film: &Film, guides: Option<&Guides>) -> Result<Vec<u8>> {
    let refused = |cause: &dyn std::error::Error| {
        Box::new(Diagnostic::new("", format!("the part cannot be encoded: {cause}")))
    };
    let info = serde_json::to_string(info).map_err(|error| refused(&error))?;
    let image = film.image();
    let picture = ["R", "G", "B", "A"].into_iter().enumerate();
    let picture =
        picture.map(|(i, name)| AnyChannel::new(name, plane(&image, i, Precision::Float)));
    let words = film.rows(|tile, index| tile.pixels[index].to_words());
    let sums = (0..Pixel::WORDS).map(|i| {
        let values = words.iter().map(|words| words[i]).collect();
        AnyChannel::new(channel_name(i).as_str(), FlatSamples::U32(values))
    });
    let guides = guides.into_iter().flat_map(Guides::channels).map(any_channel);
    let mut attributes = LayerAttributes::default();
    attributes.other.insert(utf8(ATTRIBUTE), AttributeValue::Text(utf8(&info)));
    let size = (image.width() as usize, image.height() as usize);
    to_file(size, attributes, picture.chain(sums).chain(guides).collect())
        .map_err(|error| refused(&error))
}

fn channel_name(index: usize) -> String {
    format!("sum.{index:02}")
}

/// Reads the part at `path`.
///
/// # Errors
/// If it cannot be read, is no part, or is larger than `limits` allow.
pub fn load_part(path: &Path, limits: &Limits) -> Result<Part> {
    let bytes = read_file(path)?;
    let input = Input { bytes: &bytes, name: &shown(path), limits };
    guarded(&input, || decode(&input))
}

fn decode(input: &Input) -> Result<Part> {
    let meta =
        MetaData::read_from_buffered(input.bytes, false).map_err(|e| unreadable(input, &e))?;
    let [header] = &meta.headers[..] else { return Err(no_part(input)) };
    let Some(AttributeValue::Text(info)) = header.own_attributes.other.get(&utf8(ATTRIBUTE)) else {
        return Err(no_part(input));
    };
    let info: PartInfo =
        serde_json::from_str(&info.to_string()).map_err(|e| unreadable(input, &e))?;
    let [x, y, width, height] = info.crop;
    let size = header.layer_size;
    if (size.0, size.1) != (width as usize, height as usize) || !info.is_sound() {
        return Err(input.fail("what it says of itself does not fit together").into());
    }
    check_blocks(input, header)?;
    input.room_for(width.into(), height.into(), 4 * header.channels.list.len() as u64)?;
    let channels = first_layer(input.bytes).map_err(|e| unreadable(input, &e))?.channel_data.list;
    let planes = sums(&channels).ok_or_else(|| no_part(input))?;
    let pixel = |index: usize| Pixel::from_words(std::array::from_fn(|i| planes[i][index]));
    let film = Film::from_rows([x, y], [width, height], pixel);
    Ok(Part { info, film, guides: guides(&channels) })
}

/// The channels of sums, in order, if they are all there.
fn sums(channels: &[AnyChannel<FlatSamples>]) -> Option<Vec<&[u32]>> {
    let plane = |index| match samples(channels, &channel_name(index))? {
        FlatSamples::U32(values) => Some(values.as_slice()),
        _ => None,
    };
    (0..Pixel::WORDS).map(plane).collect()
}

/// The channels of guides, if they are all there.
fn guides(channels: &[AnyChannel<FlatSamples>]) -> Option<Guides> {
    let plane = |name| match samples(channels, name)? {
        FlatSamples::F32(values) => Some(values.as_slice()),
        _ => None,
    };
    let planes: Option<Vec<_>> = Guides::NAMES.into_iter().map(plane).collect();
    Some(Guides::from_planes(planes?.try_into().ok()?))
}

fn samples<'a>(channels: &'a [AnyChannel<FlatSamples>], name: &str) -> Option<&'a FlatSamples> {
    let channel = channels.iter().find(|channel| channel.name == *name)?;
    Some(&channel.sample_data)
}

fn no_part(input: &Input) -> Box<Diagnostic> {
    let message = "this is no part of a picture that firstlight has written";
    input.fail(message).help("write parts with firstlight render --samples A..B -o part.exr").into()
}

impl PartInfo {
    /// Whether its rectangle and its samples lie inside the whole.
    fn is_sound(&self) -> bool {
        let inside = |start: u32, length: u32, end: u32| {
            u64::from(start) + u64::from(length) <= end.min(FilmDescription::LARGEST_SIDE).into()
        };
        let ([width, height], [x, y, w, h]) = (self.resolution, self.crop);
        let ends: Vec<u32> = self.ranges.iter().flatten().copied().collect();
        let in_order = ends.is_sorted() && self.ranges.iter().all(|[from, to]| from < to);
        let last = ends.last().is_some_and(|last| *last <= self.samples);
        inside(x, w, width) && inside(y, h, height) && in_order && last
    }

    /// The samples of the whole that it lacks.
    pub fn missing(&self) -> Vec<[u32; 2]> {
        let starts = std::iter::once(0).chain(self.ranges.iter().map(|range| range[1]));
        let ends = self.ranges.iter().map(|range| range[0]).chain([self.samples]);
        starts.zip(ends).map(|(from, to)| [from, to]).filter(|[from, to]| from < to).collect()
    }

    /// How many samples per pixel it has.
    pub fn count(&self) -> u32 {
        self.ranges.iter().map(|[from, to]| to - from).sum()
    }

    /// In what another part differs from this one so that they do not belong together.
    fn differs(&self, other: &Self) -> Option<&'static str> {
        let same = [
            ("another version of the program", self.software == other.software),
            ("another size", self.resolution == other.resolution),
            ("another crop", self.crop == other.crop),
            ("another number of samples in all", self.samples == other.samples),
            ("another seed", self.seed == other.seed),
            ("another exposure", self.exposure == other.exposure),
            ("another view", self.view == other.view),
            ("another scene", self.fingerprint == other.fingerprint),
        ];
        same.into_iter().find(|(_, same)| !same).map(|(what, _)| what)
    }
}

/// Puts parts together, given with the names of their files. The sums are those of one run, bit for bit, whatever the
/// order of the parts.
///
/// # Errors
/// If there are none, if they are not of the same picture, or if two of them have the same samples.
pub fn merge_parts(parts: impl IntoIterator<Item = Result<(String, Part)>>) -> Result<Part> {
    let mut parts = parts.into_iter();
    let none = || Box::new(Diagnostic::new("", "there are no parts to merge"));
    let (first_name, mut whole) = parts.next().ok_or_else(none)??;
    let mut owners: Vec<([u32; 2], String)> =
        whole.info.ranges.iter().map(|range| (*range, first_name.clone())).collect();
    for part in parts {
        let (name, part) = part?;
        if let Some(what) = whole.info.differs(&part.info) {
            let message = format!("this part is of {what} than {first_name}");
            let help = "render all parts with the same scene, options and version";
            return Err(Diagnostic::new(name, message).help(help).into());
        }
        for range in &part.info.ranges {
            check_overlap(*range, &name, &owners)?;
        }
        owners.extend(part.info.ranges.iter().map(|range| (*range, name.clone())));
        whole.film.merge(&part.film);
        // They are of the same scene and seed, so they are the same.
        whole.guides = whole.guides.or(part.guides);
    }
    whole.info.ranges = joined(owners.into_iter().map(|(range, _)| range).collect());
    Ok(whole)
}

fn check_overlap([from, to]: [u32; 2], name: &str, owners: &[([u32; 2], String)]) -> Result<()> {
    let shared = owners.iter().find(|([start, end], _)| from < *end && *start < to);
    let Some(([start, end], owner)) = shared else { return Ok(()) };
    let message = format!("samples {}..{} are in {owner} already", from.max(*start), to.min(*end));
    Err(Diagnostic::new(name, message).help("give each sample once").into())
}

/// Ranges in order, with those that touch made one.
fn joined(mut ranges: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    ranges.sort_unstable();
    let mut joined: Vec<[u32; 2]> = Vec::new();
    for range in ranges {
        match joined.last_mut().filter(|last| last[1] == range[0]) {
            Some(last) => last[1] = range[1],
            None => joined.push(range),
        }
    }
    joined
}
