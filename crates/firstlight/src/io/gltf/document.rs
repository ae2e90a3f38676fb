//! The JSON of a glTF document, as far as this reader understands it; the rest is skipped.
//!
//! Field names and defaults: Khronos, glTF 2.0 specification, and the extensions' own pages. Rarely used parts
//! are boxed so that a long list of empty objects does not take many times the memory of its text.

use super::error;
use crate::diagnostic::{Diagnostic, Result};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// A finite `f32`; numbers beyond its range are refused where they stand.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Real(pub(super) f32);

impl TryFrom<f64> for Real {
    type Error = String;

    fn try_from(number: f64) -> std::result::Result<Self, String> {
        let real = number as f32;
        real.is_finite().then_some(Self(real)).ok_or_else(|| format!("{number:e} is too large"))
    }
}

/// The plain numbers of an array of [`Real`]s.
pub(super) fn plain<const N: usize>(reals: [Real; N]) -> [f32; N] {
    reals.map(|real| real.0)
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) scene: Option<u32>,
    pub(super) scenes: Vec<Scene>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    pub(super) images: Vec<Image>,
    pub(super) samplers: Vec<Sampler>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) cameras: Vec<Camera>,
    pub(super) extensions: DocumentExtensions,
}

#[derive(Debug, Default, Deserialize)]
struct Asset {
    version: Option<String>,
    generator: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) lights: Lights,
    #[serde(rename = "KHR_materials_variants")]
    pub(super) variants: Variants,
}

/// The names of the variants that a file has.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Variants {
    pub(super) variants: Vec<Variant>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Variant {
    pub(super) name: Option<String>,
}

/// Which material a primitive has in which variants.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct VariantMappings {
    pub(super) mappings: Vec<VariantMapping>,
}

#[derive(Debug, Deserialize)]
pub(super) struct VariantMapping {
    pub(super) material: u32,
    #[serde(default)]
    pub(super) variants: Vec<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Lights {
    pub(super) lights: Vec<Light>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) name: Option<String>,
    pub(super) color: Option<[Real; 3]>,
    pub(super) intensity: Option<Real>,
    pub(super) spot: Option<Spot>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Spot {
    pub(super) inner_cone_angle: Option<f64>,
    pub(super) outer_cone_angle: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<u32>,
    pub(super) mesh: Option<u32>,
    pub(super) camera: Option<u32>,
    pub(super) skin: Option<u32>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<NodeLight>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
}

#[derive(Debug, Deserialize)]
pub(super) struct NodeLight {
    pub(super) light: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instancing {
    pub(super) attributes: BTreeMap<String, u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, u32>,
    pub(super) indices: Option<u32>,
    pub(super) material: Option<u32>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Option<IgnoredAny>,
    pub(super) extensions: Option<Box<PrimitiveExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Draco>,
    #[serde(rename = "KHR_materials_variants")]
    pub(super) variants: Option<VariantMappings>,
}

#[derive(Debug, Deserialize, PartialEq, Eq, Hash)]
#[serde(rename_all = "camelCase")]
pub(super) struct Draco {
    pub(super) buffer_view: u32,
    pub(super) attributes: BTreeMap<String, u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: Option<Box<MetallicRoughness>>,
    pub(super) emissive_factor: Option<[Real; 3]>,
    pub(super) emissive_texture: Option<Box<TextureInfo>>,
    pub(super) normal_texture: Option<Box<TextureInfo>>,
    pub(super) occlusion_texture: Option<Box<TextureInfo>>,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<Real>,
    pub(super) double_sided: bool,
    pub(super) extensions: Option<Box<MaterialExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MetallicRoughness {
    pub(super) base_color_factor: Option<[Real; 4]>,
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: Option<Real>,
    pub(super) roughness_factor: Option<Real>,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_unlit")]
    pub(super) unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_anisotropy")]
    pub(super) anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub(super) clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    pub(super) diffuse_transmission: Option<DiffuseTransmission>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub(super) dispersion: Option<Dispersion>,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub(super) iridescence: Option<Iridescence>,
    #[serde(rename = "KHR_materials_sheen")]
    pub(super) sheen: Option<Sheen>,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_volume")]
    pub(super) volume: Option<Volume>,
}

/// A struct of an extension: all fields are optional.
macro_rules! extension {
    ($name:ident { $($field:ident: $type:ty,)* }) => {
        #[derive(Debug, Default, Deserialize)]
        #[serde(default, rename_all = "camelCase")]
        pub(super) struct $name {
            $(pub(super) $field: Option<$type>,)*
        }
    };
}

extension! { Anisotropy {
    anisotropy_strength: Real,
    anisotropy_rotation: Real,
    anisotropy_texture: TextureInfo,
} }
extension! { Clearcoat {
    clearcoat_factor: Real,
    clearcoat_texture: TextureInfo,
    clearcoat_roughness_factor: Real,
    clearcoat_roughness_texture: TextureInfo,
    clearcoat_normal_texture: TextureInfo,
} }
extension! { DiffuseTransmission {
    diffuse_transmission_factor: Real,
    diffuse_transmission_texture: TextureInfo,
    diffuse_transmission_color_factor: [Real; 3],
    diffuse_transmission_color_texture: TextureInfo,
} }
extension! { Dispersion { dispersion: Real, } }
extension! { Ior { ior: Real, } }
extension! { Iridescence {
    iridescence_factor: Real,
    iridescence_texture: TextureInfo,
    iridescence_ior: Real,
    iridescence_thickness_minimum: Real,
    iridescence_thickness_maximum: Real,
    iridescence_thickness_texture: TextureInfo,
} }
extension! { Sheen {
    sheen_color_factor: [Real; 3],
    sheen_color_texture: TextureInfo,
    sheen_roughness_factor: Real,
    sheen_roughness_texture: TextureInfo,
} }
extension! { Specular {
    specular_factor: Real,
    specular_texture: TextureInfo,
    specular_color_factor: [Real; 3],
    specular_color_texture: TextureInfo,
} }
extension! { Transmission {
    transmission_factor: Real,
    transmission_texture: TextureInfo,
} }
extension! { Volume {
    thickness_factor: Real,
    attenuation_distance: Real,
    attenuation_color: [Real; 3],
} }

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: Option<Real>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpecularGlossiness {
    pub(super) diffuse_factor: Option<[Real; 4]>,
    pub(super) diffuse_texture: Option<TextureInfo>,
    pub(super) specular_factor: Option<[Real; 3]>,
    pub(super) glossiness_factor: Option<Real>,
    pub(super) specular_glossiness_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: u32,
    #[serde(default)]
    pub(super) tex_coord: u32,
    /// Of normal textures.
    pub(super) scale: Option<Real>,
    /// Of occlusion textures.
    pub(super) strength: Option<Real>,
    #[serde(default)]
    pub(super) extensions: TextureInfoExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureTransform {
    pub(super) offset: Option<[Real; 2]>,
    pub(super) rotation: Option<Real>,
    pub(super) scale: Option<[Real; 2]>,
    pub(super) tex_coord: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    pub(super) source: Option<u32>,
    pub(super) sampler: Option<u32>,
    pub(super) extensions: Option<Box<TextureExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    pub(super) webp: Option<TextureSource>,
    #[serde(rename = "KHR_texture_basisu")]
    pub(super) basisu: Option<TextureSource>,
    #[serde(rename = "EXT_texture_avif")]
    pub(super) avif: Option<TextureSource>,
    #[serde(rename = "MSFT_texture_dds")]
    pub(super) dds: Option<TextureSource>,
}

#[derive(Debug, Deserialize)]
pub(super) struct TextureSource {
    pub(super) source: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) name: Option<String>,
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sampler {
    pub(super) mag_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u32>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u32>,
    pub(super) extensions: Option<Box<BufferViewExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub(super) meshopt: Option<Meshopt>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: u32,
    pub(super) count: u64,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    pub(super) perspective: Option<Perspective>,
    pub(super) orthographic: Option<Orthographic>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct Orthographic {
    pub(super) ymag: f64,
}

impl Document {
    /// Parses the JSON and checks that it is glTF 2.
    ///
    /// # Errors
    /// With line and column where the JSON is broken or a field has the wrong type; if the version is not 2; if
    /// there are far more objects than a model of this size has.
    pub(super) fn parse(json: &[u8], name: &str) -> Result<Self> {
        check_density(json, name)?;
        match serde_json::from_slice::<Self>(json) {
            Ok(document) => document.asset.check(name).map(|()| document),
            // Another version has other fields: say that rather than which field is odd.
            Err(cause) => match serde_json::from_slice::<AssetOnly>(json) {
                Ok(AssetOnly { asset }) if asset.version.is_some() => {
                    asset.check(name)?;
                    Err(json_error(&cause, name))
                }
                _ => Err(json_error(&cause, name)),
            },
        }
    }
}

/// Empty objects take many times the memory of their text; no model consists of them.
fn check_density(json: &[u8], name: &str) -> Result<()> {
    const FREE: usize = 500_000;
    const BYTES_PER_OBJECT: usize = 16;
    let objects = json.iter().filter(|&&byte| byte == b'{').count();
    if objects.saturating_sub(FREE) <= json.len() / BYTES_PER_OBJECT {
        return Ok(());
    }
    let cause = format!("{objects} objects in {} bytes of JSON are too many", json.len());
    Err(Box::new(Diagnostic::new(name, cause)))
}

#[derive(Deserialize)]
struct AssetOnly {
    #[serde(default)]
    asset: Asset,
}

impl Document {
    /// The program that wrote the file, as it calls itself.
    pub(super) fn generator(&self) -> &str {
        self.asset.generator.as_deref().unwrap_or_default()
    }
}

impl Asset {
    fn check(&self, name: &str) -> Result<()> {
        match &self.version {
            Some(version) if version.split('.').next() == Some("2") => Ok(()),
            Some(version) => {
                let cause = format!("this is glTF {version:?}; only version 2 can be read");
                Err(error(name, "asset.version", cause))
            }
            None => Err(error(name, "asset.version", "is missing; this is not a glTF 2 document")),
        }
    }
}

fn json_error(cause: &serde_json::Error, name: &str) -> Box<Diagnostic> {
    let text = cause.to_string();
    let suffix = format!(" at line {} column {}", cause.line(), cause.column());
    let message = text.strip_suffix(&suffix).unwrap_or(&text);
    let mut complaint = Diagnostic::new(name, message).at_line(cause.line());
    complaint.place.column = Some(cause.column());
    Box::new(complaint)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(json: &str) -> String {
        Document::parse(json.as_bytes(), "m.gltf").unwrap_err().to_string()
    }

    #[test]
    fn versions_are_told_apart() {
        assert!(Document::parse(br#"{"asset": {"version": "2.1"}}"#, "m.gltf").is_ok());
        assert!(complaint("{}").contains("asset.version: is missing"));
        let old = complaint(r#"{"asset": {"version": "1.0"}, "nodes": {"a": {}}}"#);
        assert_eq!(old, "m.gltf: asset.version: this is glTF \"1.0\"; only version 2 can be read");
    }

    #[test]
    fn broken_json_is_named_with_line_and_column() {
        let text = complaint("{\"asset\": {\"version\": \"2.0\"},\n \"nodes\": [{\"mesh\": -1}]}");
        assert_eq!(text, "m.gltf:2:22: invalid value: integer `-1`, expected u32");
        assert!(complaint("{\"scene\": 1e99999}").starts_with("m.gltf:1:"));
        assert!(complaint("nonsense").starts_with("m.gltf:1:"));
    }

    #[test]
    fn a_number_too_large_for_a_float_is_refused() {
        let json = r#"{"asset": {"version": "2.0"}, "materials": [{"alphaCutoff": 1e300}]}"#;
        assert!(complaint(json).contains("1e300 is too large"));
    }

    #[test]
    fn millions_of_empty_objects_are_refused() {
        let json = format!("{{\"nodes\": [{}{{}}]}}", "{},".repeat(1_000_000));
        assert!(complaint(&json).contains("1000002 objects in 3000015 bytes"), "{}", json.len());
    }

    #[test]
    fn deep_nesting_is_no_danger() {
        for key in ["extras", "nodes"] {
            let json = format!("{{\"{key}\": {}{}}}", "[".repeat(100_000), "]".repeat(100_000));
            assert!(Document::parse(json.as_bytes(), "m.gltf").is_err());
        }
    }
}
