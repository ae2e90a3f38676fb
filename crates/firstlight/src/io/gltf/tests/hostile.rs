use super::*;
use crate::io::model::Options;

#[test]
fn every_index_is_checked_and_named() {
    let cases = [
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            "accessor",
            2,
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        ("/meshes/0/primitives/0/indices", "accessor", 2, "meshes[0].primitives[0].indices"),
        ("/meshes/0/primitives/0/material", "material", 1, "meshes[0].primitives[0].material"),
        ("/accessors/0/bufferView", "bufferView", 2, "accessors[0].bufferView"),
        ("/bufferViews/1/buffer", "buffer", 1, "bufferViews[1].buffer"),
        ("/nodes/0/mesh", "mesh", 1, "nodes[0].mesh"),
    ];
    for (pointer, kind, count, part) in cases {
        let mut document = triangle();
        *document.pointer_mut(pointer).unwrap() = json!(17);
        let there = if count == 1 { "there is 1".into() } else { format!("there are {count}") };
        assert_eq!(
            complaint(&document),
            format!("m.gltf: {part}: {kind} 17 does not exist; {there}")
        );
    }
    for (field, kind) in [("camera", "camera"), ("mesh", "mesh")] {
        let mut document = triangle();
        document["nodes"][0][field] = json!(4_000_000_000_u32);
        let text = format!("nodes[0].{field}: {kind} 4000000000 does not exist");
        assert!(complaint(&document).contains(&text));
    }
    let mut document = triangle();
    document["scene"] = json!(1);
    assert_eq!(complaint(&document), "m.gltf: scene: scene 1 does not exist; there are none");
}

#[test]
fn sizes_beyond_the_bytes_are_refused() {
    let cases: [(&str, u64, &str); 10] = [
        ("/accessors/0/count", 1 << 62, "accessors[0]: 4611686018427387904 elements are too many"),
        ("/accessors/0/count", u32::MAX.into(), "accessors[0]: needs 51539607540 bytes"),
        ("/accessors/0/byteOffset", u64::MAX - 7, "accessors[0]: needs 36 bytes from byte 184467"),
        ("/accessors/0/byteOffset", 1, "accessors[0]: needs 36 bytes from byte 1 of bufferView 0"),
        ("/accessors/0/componentType", 5124, "accessors[0].componentType: 5124 is no component"),
        ("/bufferViews/0/byteOffset", u64::MAX - 7, "bufferViews[0]: 36 bytes from byte 184467"),
        ("/bufferViews/0/byteLength", u64::MAX, "bufferViews[0]: 18446744073709551615 bytes"),
        ("/bufferViews/0/byteStride", 0, "bufferViews[0]: byteStride is 0, but an element has 12"),
        ("/bufferViews/0/byteStride", u32::MAX.into(), "accessors[0]: needs 8589934602 bytes"),
        ("/buffers/0/byteLength", 40, "buffers[0]: should have 40 bytes, but there are only 39"),
    ];
    for (pointer, number, text) in cases {
        let mut document = triangle();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        document.pointer_mut(parent).unwrap()[key] = json!(number);
        let found = complaint(&document);
        assert!(found.contains(text), "{found} does not say {text}");
    }
}

#[test]
fn zeros_that_cost_no_bytes_are_limited() {
    let mut document = triangle();
    document["accessors"][0] = json!({ "componentType": 5126, "count": u32::MAX, "type": "VEC3" });
    document["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert!(complaint(&document).contains("would unpack to 17179869180 bytes"));
}

#[test]
fn vertices_out_of_range_are_named() {
    let mut document = triangle();
    document["accessors"][0]["count"] = json!(2);
    let text = "meshes[0].primitives[0].indices: index 2 is 2, but there are 2 vertices";
    assert!(complaint(&document).contains(text));
}

#[test]
fn types_that_do_not_fit_are_named() {
    let mut document = triangle();
    document["accessors"][0]["type"] = json!("VEC2");
    let text = "attributes.POSITION: accessor 0 has type \"VEC2\"; here it must be VEC3";
    assert!(complaint(&document).contains(text));
    let mut document = triangle();
    document["accessors"][1]["componentType"] = json!(5120);
    assert!(complaint(&document).contains("indices: accessor 1 must have unsigned integers"));
    let mut document = triangle();
    let two = add_accessor(&mut document, &floats(&[0.0; 6]), 5126, 2, "VEC3");
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(two);
    assert!(complaint(&document).contains("NORMAL: has 2 elements, but POSITION has 3"));
}

#[test]
fn files_outside_the_folder_stay_closed() {
    for uri in [
        "../../../../etc/passwd",
        "%2e%2e/%2e%2e/etc/passwd",
        "/etc/passwd",
        "file:///etc/passwd",
        "http:%2f%2fexample.com/a.bin",
        "a%00b.bin",
    ] {
        let mut document = triangle();
        document["buffers"][0]["uri"] = json!(uri);
        let text = complaint(&document);
        assert!(text.starts_with("m.gltf: buffers[0]: cannot read"), "{text}");
    }
}

#[test]
fn required_extensions_that_are_unknown_stop_the_reading() {
    let mut document = triangle();
    document["extensionsUsed"] = json!(["NV_materials_mdl", "KHR_materials_variants"]);
    let warnings = warnings(&document);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("extensionsUsed[0]: the extension NV_materials_mdl"));
    for name in ["NV_materials_mdl", "MSFT_texture_dds"] {
        document["extensionsRequired"] = json!([name]);
        let text = complaint(&document);
        assert!(text.contains("extensionsRequired[0]") && text.contains(name), "{text}");
        assert!(text.contains("help: export the model again without"), "{text}");
    }
}

#[test]
fn surfaces_are_counted_before_they_fill_the_memory() {
    let mut document = triangle();
    let primitive = document["meshes"][0]["primitives"][0].clone();
    document["meshes"][0]["primitives"] = vec![primitive; 100].into();
    document["nodes"] = vec![json!({ "mesh": 0 }); 100].into();
    let mut access = FileAccess::beside(Path::new("m.gltf"), &[]);
    access.limits.decoded_bytes = 1 << 20;
    let text = document.to_string();
    let scene = super::super::read(
        text.as_bytes(),
        "m.gltf",
        Options::default(),
        &access,
        &mut Warnings::new(),
    );
    assert!(scene.unwrap_err().to_string().contains("surfaces, which is the limit"));
}
