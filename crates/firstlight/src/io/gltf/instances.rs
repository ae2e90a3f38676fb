//! EXT_mesh_gpu_instancing: many copies of a node's mesh.

use super::accessor::Accessor;
use super::data::Data;
use super::nodes::{Placed, unit_quaternion};
use crate::diagnostic::Result;
use glam::{DAffine3, DQuat, DVec3};

/// Where a node's mesh stands in the world: once, or wherever its instancing attributes say.
///
/// # Errors
/// If an accessor is broken, their counts differ, or a rotation is zero or not finite.
pub(super) fn transforms(data: &Data, placed: &Placed) -> Result<Vec<DAffine3>> {
    let instancing = placed.node.extensions.as_ref().and_then(|e| e.instancing.as_ref());
    let Some(instancing) = instancing else { return Ok(vec![placed.transform]) };
    let part = format!("nodes[{}].extensions.EXT_mesh_gpu_instancing.attributes", placed.index);
    let attribute = |name: &str, kind| match instancing.attributes.get(name) {
        Some(&index) => data.accessor(index, &[kind], &format!("{part}.{name}")).map(Some),
        None => Ok(None),
    };
    let copies = Copies {
        translations: attribute("TRANSLATION", "VEC3")?,
        rotations: attribute("ROTATION", "VEC4")?,
        scales: attribute("SCALE", "VEC3")?,
    };
    let Some(count) = copies.count() else {
        return Err(data.error(part, "the instancing attributes differ in their counts"));
    };
    data.charge((size_of::<DAffine3>() * count) as u64, &part)?;
    let broken =
        |i| data.error(part.as_str(), format!("the rotation of instance {i} has no usable length"));
    (0..count)
        .map(|i| Ok(placed.transform * copies.transform(i).ok_or_else(|| broken(i))?))
        .collect()
}

struct Copies<'a> {
    translations: Option<Accessor<'a>>,
    rotations: Option<Accessor<'a>>,
    scales: Option<Accessor<'a>>,
}

impl Copies<'_> {
    /// How many copies, if the attributes agree on it.
    fn count(&self) -> Option<usize> {
        let attributes = [&self.translations, &self.rotations, &self.scales];
        let mut counts = attributes.into_iter().flatten().map(|accessor| accessor.count);
        let first = counts.next().unwrap_or(0);
        counts.all(|count| count == first).then_some(first)
    }

    fn transform(&self, i: usize) -> Option<DAffine3> {
        let get = |accessor: &Option<Accessor>, default: [f32; 3]| {
            let numbers = accessor.as_ref().map_or(default, |accessor| accessor.get(i));
            DVec3::from(numbers.map(f64::from))
        };
        let rotation = match &self.rotations {
            Some(rotations) => unit_quaternion(rotations.get(i).map(f64::from))?,
            None => DQuat::IDENTITY,
        };
        let (scale, translation) = (get(&self.scales, [1.0; 3]), get(&self.translations, [0.0; 3]));
        Some(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
    }
}
