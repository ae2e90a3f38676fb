use super::*;
use glam::{Vec2, Vec3};

#[test]
fn a_triangle_comes_through() {
    let scene = read(&triangle());
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!((mesh.name.as_str(), scene.surfaces[0].name.as_str()), ("tri", "tri"));
    assert!(mesh.normals.is_empty() && mesh.uvs.is_empty() && mesh.colors.is_empty());
}

/// "All components of each COLOR_0 accessor element MUST be clamped" (glTF 2.0, 3.7.2.1); by how much is told.
#[test]
fn vertex_colours_go_up_to_one() {
    let colored = |most: f32| {
        let mut document = triangle();
        let colors = floats(&[0.5, 0.25, most, 0.0, 0.5, 0.5, 0.5, 0.5, 0.5]);
        let colors = add_accessor(&mut document, &colors, 5126, 3, "VEC3");
        document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
        document
    };
    let (scene, _) = try_read(&colored(200.0));
    assert_eq!(scene.unwrap().meshes[0].colors[0], [0.5, 0.25, 1.0, 1.0]);
    assert!(warnings(&colored(200.0))[0].contains("as of 0 to 255"));
    assert!(warnings(&colored(1.0)).is_empty());
}

#[test]
fn without_indices_corners_follow_each_other() {
    let mut document = triangle();
    document["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert_eq!(only_mesh(&document).triangles, [[0, 1, 2]]);
}

#[test]
fn strips_turn_every_second_triangle_and_fans_share_a_corner() {
    let mut document = triangle();
    let positions = floats(&(0..15).map(|n| n as f32).collect::<Vec<_>>());
    let positions = add_accessor(&mut document, &positions, 5126, 5, "VEC3");
    let indices = add_accessor(&mut document, &[0, 1, 2, 3, 3, 4], 5121, 6, "SCALAR");
    let primitive = &mut document["meshes"][0]["primitives"][0];
    *primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": 5,
                         "material": 0 });
    assert_eq!(only_mesh(&document).triangles, [[0, 1, 2], [1, 3, 2]]);
    document["meshes"][0]["primitives"][0]["mode"] = json!(6);
    let fan = [[1, 2, 0], [2, 3, 0], [3, 3, 0], [3, 4, 0]];
    assert_eq!(only_mesh(&document).triangles, fan);
    document["meshes"][0]["primitives"][0]["mode"] = json!(1);
    let points = warnings(&document);
    assert!(points[0].starts_with("m.gltf: meshes[0].primitives[0]: points and lines"));
}

#[test]
fn interleaved_normalized_integers_are_unpacked_and_v_is_turned_up() {
    let mut document = triangle();
    // A normal of three signed bytes, a fill byte, then a texture coordinate of two unsigned shorts.
    let vertex = [0, 0, 127, 99, 0xff, 0xff, 0, 0];
    let all = vertex.repeat(3);
    let accessor = add_accessor(&mut document, &all, 5120, 3, "VEC3");
    document["bufferViews"][2]["byteStride"] = json!(8);
    document["accessors"][accessor]["normalized"] = json!(true);
    let uv = json!({ "bufferView": 2, "byteOffset": 4, "componentType": 5123, "count": 3,
                     "type": "VEC2", "normalized": true });
    let uv = push(&mut document, "accessors", uv);
    let attributes = json!({ "POSITION": 0, "NORMAL": accessor, "TEXCOORD_0": uv });
    document["meshes"][0]["primitives"][0]["attributes"] = attributes;
    let mesh = only_mesh(&document);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.uvs, [[Vec2::ONE; 3]]);
}

#[test]
fn sparse_elements_replace_zeros_and_others() {
    let mut document = triangle();
    let values = add_accessor(&mut document, &floats(&[5.0, 6.0, 7.0]), 5126, 1, "VEC3");
    let sparse = json!({ "count": 1, "indices": { "bufferView": 1, "byteOffset": 1,
        "componentType": 5121 }, "values": { "bufferView": values } });
    document["accessors"][0]["sparse"] = sparse;
    let mesh = only_mesh(&document);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::new(5.0, 6.0, 7.0), Vec3::Y]);
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let mesh = only_mesh(&document);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::new(5.0, 6.0, 7.0), Vec3::ZERO]);
    document["accessors"][0]["sparse"]["count"] = json!(2);
    document["accessors"][0]["sparse"]["indices"]["byteOffset"] = json!(0);
    assert!(complaint(&document).contains("accessors[0].sparse.values: needs 24 bytes"));
    document["accessors"][0]["sparse"]["count"] = json!(1u64 << 62);
    assert!(complaint(&document).contains("accessors[0].sparse: replaces 4611686018427387904"));
}

#[test]
fn colours_are_linear_fractions_with_alpha() {
    let mut document = triangle();
    let bytes = [255, 0, 51, 0].repeat(3);
    let colors = add_accessor(&mut document, &bytes, 5121, 3, "VEC3");
    document["bufferViews"][2]["byteStride"] = json!(4);
    document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    let scene = read(&document);
    assert_eq!(scene.meshes[0].colors, [[1.0, 0.0, 0.2, 1.0]; 3]);
    assert!(scene.materials[0].reflectance.vertex_colors);
    assert!(!scene.materials[0].emission.vertex_colors);
}

#[test]
fn primitives_with_the_same_data_share_a_mesh_and_keep_only_their_vertices() {
    let mut document = triangle();
    let positions = floats(&(0..30).map(|n| n as f32).collect::<Vec<_>>());
    let positions = add_accessor(&mut document, &positions, 5126, 10, "VEC3");
    let indices = add_accessor(&mut document, &[9, 2, 5], 5121, 3, "SCALAR");
    let primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
    document["meshes"][0]["primitives"] = json!([primitive, primitive]);
    let scene = read(&document);
    assert_eq!((scene.meshes.len(), scene.surfaces.len()), (1, 2));
    let x: Vec<f32> = scene.meshes[0].positions.iter().map(|p| p.x).collect();
    assert_eq!((x, &scene.meshes[0].triangles[..]), (vec![6.0, 15.0, 27.0], &[[2, 0, 1]][..]));
}

#[test]
fn what_is_not_finite_is_dropped_and_counted() {
    let mut document = triangle();
    let mut numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].repeat(2);
    numbers[3] = f32::NAN;
    let positions = add_accessor(&mut document, &floats(&numbers), 5126, 6, "VEC3");
    let mut normals = [0.0, 0.0, -2.0].repeat(6);
    normals[9..12].copy_from_slice(&[0.0, f32::INFINITY, 0.0]);
    let normals = add_accessor(&mut document, &floats(&normals), 5126, 6, "VEC3");
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    document["meshes"][0]["primitives"] = json!([{ "attributes": attributes, "material": 0 }]);
    let (scene, warnings) = try_read(&document);
    let mesh = &scene.unwrap().meshes[0];
    assert_eq!(mesh.triangles, [[3, 4, 5]]);
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert_eq!(mesh.normals[3..], [Vec3::Z, Vec3::NEG_Z, Vec3::NEG_Z]);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn meshopt_views_are_unpacked() {
    let mut document = triangle();
    let mut packed = vec![0xe1, 0xf0];
    packed.extend([0; 16]);
    push(&mut document, "buffers", buffer(&packed));
    let fallback = push(&mut document, "buffers", json!({ "byteLength": 6 }));
    let extension = json!({ "buffer": 1, "byteLength": 18, "byteStride": 2, "count": 3,
                            "mode": "TRIANGLES" });
    document["bufferViews"][1] = json!({ "buffer": fallback, "byteLength": 6,
        "extensions": { "EXT_meshopt_compression": extension } });
    document["accessors"][1]["componentType"] = json!(5123);
    assert_eq!(only_mesh(&document).triangles, [[0, 1, 2]]);
    document["bufferViews"][1]["extensions"]["EXT_meshopt_compression"]["count"] = json!(6);
    let text = complaint(&document);
    assert!(text.contains("bufferViews[1].extensions.EXT_meshopt_compression: the stream ends"));
    document["bufferViews"][1].as_object_mut().unwrap().remove("extensions");
    assert!(complaint(&document).contains("bufferViews[1]: buffer 2 has no data"));
}

#[test]
fn draco_streams_are_unpacked() {
    let mut document = triangle();
    let packed = draco_triangle();
    push(&mut document, "buffers", buffer(&packed));
    let view =
        push(&mut document, "bufferViews", json!({ "buffer": 1, "byteLength": packed.len() }));
    let extension = json!({ "bufferView": view, "attributes": { "POSITION": 0 } });
    let primitive = &mut document["meshes"][0]["primitives"][0];
    primitive["extensions"] = json!({ "KHR_draco_mesh_compression": extension });
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let mesh = only_mesh(&document);
    let mut x: Vec<f32> = mesh.positions.iter().map(|p| p.x.round()).collect();
    x.sort_by(f32::total_cmp);
    assert_eq!((x, mesh.triangles.len()), (vec![0.0, 4.0, 8.0], 1));
    document["bufferViews"][view]["byteLength"] = json!(packed.len() / 2);
    let place = "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: cannot be unpacked";
    assert!(complaint(&document).contains(place));
}

/// A triangle with x = 0, 4, 8, packed by the same library.
fn draco_triangle() -> Vec<u8> {
    use draco_core::*;
    let mut positions = PointAttribute::new();
    positions.init(GeometryAttributeType::Position, 3, DataType::Float32, false, 3);
    let numbers = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 8.0, 4.0, 0.0];
    positions.buffer_mut().update(&floats(&numbers), Some(0));
    let mut mesh = Mesh::new();
    mesh.set_num_points(3);
    mesh.add_attribute(positions);
    mesh.add_face([PointIndex(0), PointIndex(1), PointIndex(2)]);
    let mut out = EncoderBuffer::new();
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    encoder.encode(&EncoderOptions::default(), &mut out).unwrap();
    out.data().to_vec()
}
