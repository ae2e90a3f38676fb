//! KHR_materials_variants: one model in several looks.

use super::data::Data;
use super::document::Primitive;
use crate::diagnostic::Result;
use crate::suggest::{did_you_mean, quoted};

/// The number of the variant called `name`.
///
/// # Errors
/// If the file has none of that name; the complaint names those that it has.
pub(super) fn find(data: &Data, name: &str) -> Result<u32> {
    let list = &data.document.extensions.variants.variants;
    let names = || list.iter().filter_map(|variant| variant.name.as_deref());
    if let Some(place) = list.iter().position(|variant| variant.name.as_deref() == Some(name)) {
        return Ok(place as u32);
    }
    let known = names().take(32).map(quoted).collect::<Vec<_>>().join(", ");
    let known =
        if known.is_empty() { "there are none".into() } else { format!("there are {known}") };
    let hint = did_you_mean(name, names());
    let cause = format!("the variant {} does not exist; {known}{hint}", quoted(name));
    Err(data.error("extensions.KHR_materials_variants", cause))
}

/// The material that a primitive has in a variant.
pub(super) fn material(primitive: &Primitive, variant: Option<u32>) -> Option<u32> {
    let mappings = primitive.extensions.as_ref().and_then(|e| e.variants.as_ref());
    let mapping = variant.zip(mappings).and_then(|(variant, mappings)| {
        mappings.mappings.iter().find(|mapping| mapping.variants.contains(&variant))
    });
    mapping.map(|mapping| mapping.material).or(primitive.material)
}
