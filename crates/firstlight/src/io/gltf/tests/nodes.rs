use super::*;
use crate::scene::description::{Light, Projection};
use glam::{DVec3, Vec3};

#[test]
fn transforms_are_chained_and_names_kept() {
    let mut document = triangle();
    document["nodes"] = json!([
        { "children": [1], "translation": [0, 0, 5] },
        { "mesh": 0, "name": "leaf", "scale": [2, 2, 2], "rotation": [0, 0, 1.0, 1.0] },
        { "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1] },
    ]);
    document["scenes"] = json!([{ "nodes": [] }, { "nodes": [0, 2] }]);
    document["scene"] = json!(1);
    let scene = read(&document);
    let [leaf, other] = &scene.surfaces[..] else { panic!("two surfaces") };
    assert_eq!((leaf.name.as_str(), other.name.as_str()), ("leaf", "tri"));
    let moved = leaf.transform.transform_point3(DVec3::X);
    assert!(moved.abs_diff_eq(DVec3::new(0.0, 2.0, 5.0), 1e-6), "{moved}");
    assert_eq!(other.transform.translation, DVec3::new(7.0, 8.0, 9.0));
    assert_eq!(scene.meshes.len(), 1);
}

#[test]
fn trees_that_are_none_are_refused() {
    let mut document = triangle();
    document["scenes"] = json!([{ "nodes": [0] }]);
    document["nodes"] = json!([{ "children": [1] }, { "children": [0] }]);
    assert_eq!(
        complaint(&document),
        "m.gltf: nodes[1].children[0]: node 0 is reached again, first from scenes[0].nodes[0]; \
         a node must have one parent"
    );
    document["nodes"] = json!([{ "children": [1, 2] }, { "children": [2] }, {}]);
    assert!(complaint(&document).contains("node 2 is reached again"));
    document["nodes"] = json!([{ "children": [9] }]);
    assert!(complaint(&document).contains("nodes[0].children[0]: node 9 does not exist"));
    document.as_object_mut().unwrap().remove("scenes");
    document["nodes"] = json!([{ "children": [0] }]);
    assert!(complaint(&document).contains("there is no root"));
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_no_danger() {
    let mut document = triangle();
    let mut nodes: Vec<_> = (1..100_000).map(|i| json!({ "children": [i] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    document["nodes"] = nodes.into();
    assert_eq!(read(&document).surfaces.len(), 1);
}

#[test]
fn transforms_that_are_none_are_refused_or_left_out() {
    let mut document = triangle();
    document["nodes"] = json!([{ "mesh": 0, "rotation": [0, 0, 0, 0] }]);
    assert!(complaint(&document).contains("nodes[0].rotation: a rotation must be"));
    document["nodes"] = json!([{ "mesh": 0, "matrix": [0,0,0,0, 0,0,0,0, 0,0,0,0, 0,0,0,0] }]);
    assert!(complaint(&document).contains("nodes[0].matrix: the last row"));
    document["nodes"] =
        json!([{ "children": [1], "scale": [1e200, 1, 1] }, { "mesh": 0, "scale": [1e200, 1, 1] }]);
    assert!(complaint(&document).contains("nodes[1]: its transform in the world is not"));
    document["nodes"] = json!([{ "mesh": 0, "scale": [1, 0, 1] }]);
    assert!(warnings(&document)[0].contains("nodes[0].mesh: is scaled to nothing"));
}

#[test]
fn instances_stand_where_their_attributes_say() {
    let mut document = triangle();
    let bytes = floats(&[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let translations = add_accessor(&mut document, &bytes, 5126, 2, "VEC3");
    // Half a turn about y, as normalized bytes.
    let rotations = add_accessor(&mut document, &[0, 127, 0, 0].repeat(2), 5120, 2, "VEC4");
    document["accessors"][rotations]["normalized"] = json!(true);
    let attributes = json!({ "TRANSLATION": translations, "ROTATION": rotations });
    let instancing = json!({ "attributes": attributes });
    document["nodes"] = json!([{ "mesh": 0, "translation": [0, 3, 0],
                                 "extensions": { "EXT_mesh_gpu_instancing": instancing } }]);
    let scene = read(&document);
    let moved = scene.surfaces[1].transform.transform_point3(DVec3::X);
    assert!(moved.abs_diff_eq(DVec3::new(1.0, 3.0, 0.0), 1e-12), "{moved}");
    assert_eq!((scene.surfaces.len(), scene.meshes.len()), (2, 1));
    document["accessors"][rotations]["count"] = json!(1);
    assert!(complaint(&document).contains("nodes[0].extensions.EXT_mesh_gpu_instancing"));
}

#[test]
fn cameras_look_along_minus_z() {
    let mut document = triangle();
    document["cameras"] = json!([
        { "perspective": { "yfov": 0.5 }, "name": "eye" },
        { "orthographic": { "ymag": 2.0 } },
    ]);
    let turned = [0.0, 1.0, 0.0, 1.0];
    document["nodes"] =
        json!([{ "camera": 0, "translation": [1, 2, 3], "rotation": turned }, { "camera": 1 }]);
    let scene = read(&document);
    let [eye, flat] = &scene.cameras[..] else { panic!("two cameras") };
    assert_eq!(eye.name, "eye");
    assert!(eye.target.abs_diff_eq(DVec3::new(0.0, 2.0, 3.0), 1e-6), "{}", eye.target);
    assert_eq!(eye.up, DVec3::Y);
    assert_eq!(eye.projection, Projection::Perspective { vertical_fov: 0.5 });
    assert_eq!(flat.projection, Projection::Orthographic { height: 4.0 });
    document["cameras"][0]["perspective"]["yfov"] = json!(3.15);
    assert!(complaint(&document).contains("cameras[0].perspective.yfov: 3.15 is no field of view"));
}

#[test]
fn lights_are_converted_with_the_luminous_efficacy() {
    let mut document = triangle();
    document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 683, "color": [1, 0.5, 0] },
        { "type": "spot", "intensity": 1366, "spot": { "outerConeAngle": 0.6 } },
        { "type": "directional" },
    ] } });
    let at = |light| {
        json!({ "extensions": { "KHR_lights_punctual": { "light": light } },
                             "translation": [0, 4, 0], "rotation": [-1.0, 0, 0, 1.0] })
    };
    document["nodes"] = json!([at(0), at(1), at(2)]);
    let lights = read(&document).lights;
    let position = DVec3::new(0.0, 4.0, 0.0);
    assert_eq!(lights[0].light, Light::Point { position, intensity: Vec3::new(1.0, 0.5, 0.0) });
    let Light::Spot { direction, intensity, inner_angle, outer_angle, .. } = lights[1].light else {
        panic!("a spot")
    };
    assert!(direction.abs_diff_eq(DVec3::NEG_Y, 1e-6), "{direction}");
    assert_eq!((intensity, inner_angle, outer_angle), (Vec3::splat(2.0), 0.0, 0.6));
    assert!(matches!(lights[2].light, Light::Directional { irradiance, .. }
        if irradiance == Vec3::splat(1.0 / 683.0)));
    let light = &mut document["extensions"]["KHR_lights_punctual"]["lights"][1];
    light["spot"]["innerConeAngle"] = json!(0.7);
    assert!(complaint(&document).contains("extensions.KHR_lights_punctual.lights[1].spot"));
}

/// Blender wrote watts as if they were candela before version 3.6 of its exporter; that is undone, with a word.
#[test]
fn watts_of_old_exports_stay_watts() {
    let read_from = |generator: &str| {
        let mut document = triangle();
        document["asset"]["generator"] = json!(generator);
        document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 1000 }, { "type": "directional", "intensity": 3 } ] } });
        let at = |light| json!({ "extensions": { "KHR_lights_punctual": { "light": light } } });
        document["nodes"] = json!([at(0), at(1)]);
        let (scene, warnings) = try_read(&document);
        let lights = scene.unwrap().lights;
        let strength = [0, 1].map(|i: usize| lights[i].light.quantity().1.x);
        (strength, lights[0].written.clone(), warnings)
    };
    let (strength, written, warnings) = read_from("Khronos glTF Blender I/O v1.8.19");
    assert_eq!(strength, [(1000.0 / (4.0 * std::f64::consts::PI)) as f32, 3.0]);
    assert_eq!(written, "1000 W");
    assert!(warnings[0].contains("taken as watts") && warnings[0].contains("--gltf-lights spec"));
    for generator in ["Khronos glTF Blender I/O v4.2.60", "another"] {
        let (strength, written, warnings) = read_from(generator);
        assert_eq!(strength, [1000.0 / 683.0, 3.0 / 683.0].map(|x: f64| x as f32));
        assert_eq!((written.as_str(), warnings.len()), ("1000 cd", 0));
    }
}
