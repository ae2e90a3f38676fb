//! Pictures of many layers: one OpenEXR file with a channel for every number of a pixel, and back.

use super::Limits;
use super::access::{read_file, shown};
use super::exr::{attributes, check_blocks, first_layer, plane, to_file, utf8};
use super::pixels::{Input, guarded, unreadable};
use super::save::{Develop, Metadata, Precision};
use crate::Image;
use crate::color::View;
use crate::diagnostic::{Diagnostic, Result};
use crate::layers::{Channel, Plane};
use exr::prelude::{AnyChannel, AttributeValue, FlatSamples, MetaData, Vec2};
use std::path::Path;

/// The attribute that keeps lumens per watt, as text.
pub const EFFICACY: &str = "luminousEfficacy";

/// Encodes a picture with more channels, all in 32 bits, and more attributes: names and texts.
///
/// # Errors
/// If it is too large for the format.
pub fn save_layers(
    image: &Image,
    channels: Vec<Channel>,
    more: Vec<(String, String)>,
    develop: Develop,
    metadata: &Metadata,
) -> Result<Vec<u8>> {
    let picture = ["R", "G", "B", "A"].into_iter().enumerate();
    let picture = picture.map(|(i, name)| AnyChannel::new(name, plane(image, i, Precision::Float)));
    let channels = channels.into_iter().map(any_channel);
    let mut attributes = attributes(develop, metadata);
    let more = more.into_iter().map(|(key, text)| (utf8(&key), AttributeValue::Text(utf8(&text))));
    attributes.other.extend(more);
    let size = (image.width() as usize, image.height() as usize);
    to_file(size, attributes, picture.chain(channels).collect()).map_err(|cause| {
        Box::new(Diagnostic::new("", format!("the layers cannot be encoded: {cause}")))
    })
}

/// A channel as files have it.
pub(super) fn any_channel(channel: Channel) -> AnyChannel<FlatSamples> {
    let samples = match channel.plane {
        Plane::Numbers(values) => FlatSamples::F32(values),
        Plane::Whole(values) => FlatSamples::U32(values),
    };
    AnyChannel { name: utf8(&channel.name), ..AnyChannel::new("", samples) }
}

/// The channels of a file.
#[derive(Debug, Clone)]
pub struct LayerFile {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// All channels, half precision made single.
    pub channels: Vec<Channel>,
    /// Stops of exposure that it is meant to be shown with.
    pub exposure_ev: Option<f32>,
    /// What is then made of light that is brighter than white.
    pub view: Option<View>,
    /// Lumens per watt that its scene was reckoned with.
    pub luminous_efficacy: Option<f64>,
}

impl LayerFile {
    /// The numbers of the channel of that name.
    pub fn numbers(&self, name: &str) -> Option<&[f32]> {
        let channel = self.channels.iter().find(|channel| channel.name == name)?;
        if let Plane::Numbers(values) = &channel.plane { Some(values) } else { None }
    }

    /// Red, green and blue of a layer, pixel by pixel.
    pub fn rgb(&self, layer: &str) -> Option<Vec<[f32; 3]>> {
        let channel = |letter| self.numbers(&format!("{layer}.{letter}"));
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        Some(r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]).collect())
    }

    /// The names of the layers whose name begins so, without that.
    pub fn layers(&self, prefix: &str) -> Vec<&str> {
        let red = |channel: &'_ Channel| channel.name.strip_suffix(".R").is_some();
        let named = self.channels.iter().filter(|channel| red(channel));
        named.filter_map(|channel| channel.name.strip_suffix(".R")?.strip_prefix(prefix)).collect()
    }
}

/// Reads all channels of the first layer of the OpenEXR file at `path`.
///
/// # Errors
/// If it cannot be read, is no OpenEXR file, or is larger than `limits` allow.
pub fn load_layers(path: &Path, limits: &Limits) -> Result<LayerFile> {
    let bytes = read_file(path)?;
    let input = Input { bytes: &bytes, name: &shown(path), limits };
    if !bytes.starts_with(&[0x76, 0x2F, 0x31, 0x01]) {
        return Err(input.fail("this is no OpenEXR file, which layers are kept in").into());
    }
    guarded(&input, || decode(&input))
}

fn decode(input: &Input) -> Result<LayerFile> {
    let meta =
        MetaData::read_from_buffered(input.bytes, false).map_err(|e| unreadable(input, &e))?;
    for header in &meta.headers {
        check_blocks(input, header)?;
        let Vec2(width, height) = header.layer_size;
        let bytes = 4 * header.channels.list.len() as u64;
        let _ = input.room_for(width as u64, height as u64, bytes)?;
    }
    let layer = first_layer(input.bytes).map_err(|e| unreadable(input, &e))?;
    let attribute = |name: &str| layer.attributes.other.get(&utf8(name));
    let exposure_ev = match attribute("exposureEV") {
        Some(AttributeValue::F32(ev)) => Some(*ev),
        _ => None,
    };
    let text = |name: &str| match attribute(name) {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    let view = text("viewTransform").and_then(|name| View::from_name(&name));
    let luminous_efficacy = text(EFFICACY).and_then(|number| number.parse().ok());
    let channel = |channel: AnyChannel<FlatSamples>| Channel {
        name: String::from_utf8_lossy(channel.name.as_slice()).into_owned(),
        plane: match channel.sample_data {
            FlatSamples::F16(values) => Plane::Numbers(values.iter().map(|x| x.to_f32()).collect()),
            FlatSamples::F32(values) => Plane::Numbers(values),
            FlatSamples::U32(values) => Plane::Whole(values),
        },
    };
    // `room_for` has made sure that the size fits.
    Ok(LayerFile {
        width: layer.size.0 as u32,
        height: layer.size.1 as u32,
        channels: layer.channel_data.list.into_iter().map(channel).collect(),
        exposure_ev,
        view,
        luminous_efficacy,
    })
}
