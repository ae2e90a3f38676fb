//! The extensions of materials, one by one, as they look.

use super::material::material;
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::integrator::{Measurement, Meter};
use crate::scene::Scene;
use crate::scene::description::{EnvironmentDescription, Sky};
use crate::verify::scenes::{add, ball, scene_for_paths, under, uniform};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

/// Along a ray from in front of a ball of radius 1 m under a sky. `change` is put into the material `base` of glTF.
fn seen(
    sky: Option<EnvironmentDescription>,
    base: Value,
    change: Value,
    toward: Vec3,
) -> Measurement {
    let mut written = base;
    merge(&mut written, change);
    let mut scene = scene_for_paths(0.0);
    (scene.environment, scene.materials[0]) = (sky, material(written));
    scene.materials[0].double_sided = true;
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    let ray = Ray::new(Vec3::new(0.0, -5.0, 0.0), toward.normalize());
    Meter::new(&Scene::build(&scene)).samples(1 << 16).radiance(&ray)
}

/// What the middle shows under a sky of 1 of a smooth black dielectric that is changed.
fn middle_of_ball(change: Value) -> Rgb {
    let base = json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 0 } });
    seen(uniform(1.0), base, change, Vec3::Y).value
}

fn with(name: &str, keys: Value) -> Value {
    json!({ "extensions": { format!("KHR_materials_{name}"): keys } })
}

fn both(mut first: Value, second: Value) -> Value {
    merge(&mut first, second);
    first
}

fn merge(into: &mut Value, from: Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            from.into_iter()
                .for_each(|(key, value)| merge(into.entry(key).or_insert(Value::Null), value));
        }
        (into, from) => *into = from,
    }
}

/// Extension by extension, parameter by parameter: the value that the specifications give at normal incidence.
#[test]
fn every_extension_has_the_value_that_its_specification_gives() {
    let base = |color: [f32; 3]| json!({ "pbrMetallicRoughness": { "baseColorFactor": [color[0], color[1], color[2], 1] } });
    let metal = json!({ "pbrMetallicRoughness": { "metallicFactor": 1 } });
    let grey = |value: f32| [value; 3];
    let clear = |keys: Value| {
        both(base([1.0; 3]), both(with("transmission", json!({ "transmissionFactor": 1 })), keys))
    };
    let volume = |keys: Value| clear(both(with("ior", json!({ "ior": 1 })), with("volume", keys)));
    // Of what passes, black glass leaves nothing.
    let solid = |keys: Value| {
        let volume = with("volume", json!({ "thicknessFactor": 1 }));
        both(both(with("transmission", json!({ "transmissionFactor": 1 })), volume), keys)
    };
    let cases = [
        (json!({}), grey(0.04)),
        (both(metal, base([0.9, 0.5, 0.1])), [0.9, 0.5, 0.1]),
        (base([0.5; 3]), grey(0.04 + 0.96 * 0.5)),
        (with("ior", json!({ "ior": 2 })), grey(1.0 / 9.0)),
        (with("ior", json!({ "ior": 0 })), grey(1.0)),
        (with("specular", json!({ "specularFactor": 0.25 })), grey(0.01)),
        (with("specular", json!({ "specularColorFactor": [2, 0.5, 0] })), [0.08, 0.02, 0.0]),
        (with("clearcoat", json!({ "clearcoatFactor": 0.5 })), grey(0.02 + 0.98 * 0.04)),
        (clear(json!({})), grey(1.0)),
        (clear(base([0.5, 0.6, 0.7])), [0.5_f32, 0.6, 0.7].map(|c| 0.04 + 0.96 * c * c)),
        (
            volume(
                json!({ "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0.5, 0.8, 1] }),
            ),
            [0.25, 0.64, 1.0],
        ),
        (
            volume(
                json!({ "thicknessFactor": 1, "attenuationDistance": 4, "attenuationColor": [0.5, 0.8, 1] }),
            ),
            [0.5_f32.sqrt(), 0.8_f32.sqrt(), 1.0],
        ),
        (
            both(
                json!({ "emissiveFactor": [0.25, 0.5, 1] }),
                with("emissive_strength", json!({ "emissiveStrength": 3 })),
            ),
            [0.79, 1.54, 3.04],
        ),
        (
            both(
                json!({ "emissiveFactor": [0.25, 0.5, 1] }),
                with("clearcoat", json!({ "clearcoatFactor": 0.5 })),
            ),
            [0.25_f32, 0.5, 1.0].map(|emitted| 0.02 + 0.98 * (0.04 + emitted)),
        ),
        (solid(json!({})), grey(0.04)),
        (solid(with("specular", json!({ "specularFactor": 0.25 }))), grey(0.01)),
        (solid(with("specular", json!({ "specularColorFactor": [2, 0.5, 0] }))), [0.08, 0.02, 0.0]),
        (
            solid(with(
                "iridescence",
                json!({ "iridescenceFactor": 1, "iridescenceThicknessMaximum": 0 }),
            )),
            grey(0.04),
        ),
        (both(base([0.3, 0.2, 0.1]), with("unlit", json!({}))), [0.3, 0.2, 0.1]),
        (
            with(
                "iridescence",
                json!({ "iridescenceFactor": 1, "iridescenceThicknessMaximum": 0 }),
            ),
            grey(0.04),
        ),
    ];
    for (change, expected) in cases {
        let seen = middle_of_ball(change.clone());
        let off = (seen - Rgb::from_array(expected)).abs().max_element();
        assert!(off < 4e-3, "{change}: {seen} is not {expected:?}");
    }
}

/// What has no plain value at normal incidence changes what is seen there, or at the rim.
#[test]
fn every_parameter_changes_the_picture() {
    let off_centre = |change: Value| {
        let base = json!({ "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.4, 0.3, 1], "metallicFactor": 0.5, "roughnessFactor": 0.3 } });
        let (zenith, horizon, nadir) = (Rgb::ONE, Rgb::splat(0.5), Rgb::ZERO);
        let sky = under(Sky::Gradient { zenith, horizon, nadir }, 1.0);
        seen(sky, base, change, Vec3::new(0.75, 5.0, 0.3))
    };
    let sheen = |color: f32, rough: f32| {
        with(
            "sheen",
            json!({ "sheenColorFactor": [color, color, color], "sheenRoughnessFactor": rough }),
        )
    };
    let film = |keys: Value| {
        both(with("iridescence", json!({ "iridescenceFactor": 1 })), with("iridescence", keys))
    };
    let leaf = |keys: Value| {
        let name = "diffuse_transmission";
        both(with(name, json!({ "diffuseTransmissionFactor": 0.5 })), with(name, keys))
    };
    let brushed = |strength: f32, turn: f32| {
        with("anisotropy", json!({ "anisotropyStrength": strength, "anisotropyRotation": turn }))
    };
    let glass = |dispersion: f32| {
        let clear =
            json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 } });
        let solid = both(with("volume", json!({ "thicknessFactor": 1 })), clear);
        let open = with("transmission", json!({ "transmissionFactor": 1 }));
        both(both(open, solid), with("dispersion", json!({ "dispersion": dispersion })))
    };
    let rough = |keys: Value| {
        let rough = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0.4 } });
        both(both(glass(0.0), rough), keys)
    };
    let pairs = [
        (json!({}), sheen(0.5, 0.3)),
        (sheen(0.5, 0.3), sheen(0.5, 0.8)),
        (json!({}), brushed(0.9, 0.0)),
        (brushed(0.9, 0.0), brushed(0.9, 1.2)),
        (json!({}), film(json!({}))),
        (film(json!({})), film(json!({ "iridescenceIor": 1.8 }))),
        (film(json!({})), film(json!({ "iridescenceThicknessMaximum": 700 }))),
        (json!({}), leaf(json!({}))),
        (leaf(json!({})), leaf(json!({ "diffuseTransmissionColorFactor": [1, 0.2, 0.2] }))),
        (
            with("clearcoat", json!({ "clearcoatFactor": 1 })),
            with("clearcoat", json!({ "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.7 })),
        ),
        (glass(0.0), glass(5.0)),
        (rough(json!({})), rough(with("specular", json!({ "specularColorFactor": [9, 1, 1] })))),
        (rough(json!({})), rough(film(json!({})))),
    ];
    for (one, other) in pairs {
        let (a, b) = (off_centre(one.clone()), off_centre(other.clone()));
        let known = (a.standard_error + b.standard_error).max_element();
        let change = (a.value - b.value).abs().max_element();
        assert!(change > 5.0 * known && change > 1e-3, "{one} and {other}: {a:?}, {b:?}");
    }
}
