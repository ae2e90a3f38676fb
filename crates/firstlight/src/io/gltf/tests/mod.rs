//! Whole documents, made here.

mod extensions;
mod geometry;
mod hostile;
mod material;
mod nodes;

use crate::diagnostic::Result;
use crate::io::model::Options;
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{Mesh, SceneDescription};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// A document with one triangle: accessor 0 its positions, 1 its indices; one node, one mesh, one material.
fn triangle() -> Value {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0_f32]];
    let mut bytes: Vec<u8> =
        positions.as_flattened().iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend([0, 1, 2]);
    json!({
        "asset": { "version": "2.0" },
        "buffers": [buffer(&bytes)],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 3 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" },
        ],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0 } }],
        "meshes": [{ "name": "tri", "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }
        ] }],
        "nodes": [{ "mesh": 0 }],
    })
}

fn buffer(bytes: &[u8]) -> Value {
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes));
    json!({ "uri": uri, "byteLength": bytes.len() })
}

/// Adds a buffer with a view and an accessor over all of it; returns the accessor's index.
fn add_accessor(
    document: &mut Value,
    bytes: &[u8],
    component: u32,
    count: u64,
    kind: &str,
) -> usize {
    let buffers = document["buffers"].as_array().unwrap().len();
    push(document, "buffers", buffer(bytes));
    let view = json!({ "buffer": buffers, "byteLength": bytes.len() });
    let view = push(document, "bufferViews", view);
    let accessor =
        json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
    push(document, "accessors", accessor)
}

fn push(document: &mut Value, list: &str, item: Value) -> usize {
    let list = document[list].as_array_mut().unwrap();
    list.push(item);
    list.len() - 1
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn try_read(document: &Value) -> (Result<SceneDescription>, Vec<String>) {
    let mut warnings = Warnings::new();
    let access = FileAccess::beside(Path::new("m.gltf"), &[]);
    let scene = super::read(
        document.to_string().as_bytes(),
        "m.gltf",
        Options::default(),
        &access,
        &mut warnings,
    );
    (scene, warnings.iter().map(ToString::to_string).collect())
}

/// The scene, which must come without warnings.
fn read(document: &Value) -> SceneDescription {
    let (scene, warnings) = try_read(document);
    assert_eq!(warnings, [""; 0]);
    scene.unwrap()
}

fn only_mesh(document: &Value) -> Arc<Mesh> {
    let [mesh] = <[_; 1]>::try_from(read(document).meshes).unwrap();
    mesh
}

fn complaint(document: &Value) -> String {
    try_read(document).0.unwrap_err().to_string()
}

/// The warnings about a document that can be read.
fn warnings(document: &Value) -> Vec<String> {
    let (scene, warnings) = try_read(document);
    scene.unwrap();
    warnings
}
