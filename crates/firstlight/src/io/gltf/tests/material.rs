use super::*;
use crate::scene::description::{
    Alpha, Material, Pattern, Principled, Sampling, Scalar, Scattering, Texture, Wrap,
};
use glam::Vec2;

pub(super) fn material(value: Value) -> Material {
    let mut document = triangle();
    document["materials"][0] = value;
    read(&document).materials[0].clone()
}

/// The material with a texture of one red pixel, and the scene's warnings.
fn textured(info: Value, change: impl Fn(&mut Value)) -> (Material, Vec<String>) {
    let mut picture = std::io::Cursor::new(Vec::new());
    let red = image::RgbaImage::from_pixel(1, 1, image::Rgba([255, 0, 0, 255]));
    red.write_to(&mut picture, image::ImageFormat::Png).unwrap();
    let mut document = triangle();
    let uvs = add_accessor(&mut document, &floats(&[0.5; 6]), 5126, 3, "VEC2");
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
    document["images"] = json!([{ "uri": buffer(picture.get_ref())["uri"] }]);
    document["samplers"] = json!([{ "wrapS": 33648, "wrapT": 33071, "magFilter": 9728 }]);
    document["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = info;
    change(&mut document);
    let (scene, warnings) = try_read(&document);
    (scene.unwrap().materials[0].clone(), warnings)
}

#[test]
fn without_a_material_a_surface_is_white() {
    let mut document = triangle();
    document["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
    let scene = read(&document);
    assert_eq!(scene.materials[0].reflectance.factor, [1.0; 4]);
    assert!(!scene.materials[0].double_sided);
}

#[test]
fn factors_alpha_and_emission_are_taken_over() {
    let material = material(json!({
        "name": "lamp", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0 },
        "emissiveFactor": [1, 0.5, 0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
    }));
    assert_eq!((material.name.as_str(), material.double_sided), ("lamp", true));
    assert_eq!(material.alpha, Alpha::Mask { cutoff: 0.25 });
    assert_eq!(material.reflectance.factor, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(material.emission.factor, [8.0, 4.0, 0.0, 1.0]);
}

#[test]
fn unlit_colour_is_emission_and_keeps_its_alpha() {
    let material = material(json!({
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4] },
        "extensions": { "KHR_materials_unlit": {} },
    }));
    assert_eq!(material.reflectance.factor, [0.0, 0.0, 0.0, 0.4]);
    assert_eq!(material.emission.factor, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(material.alpha, Alpha::Blend);
    assert!(material.unlit && material.emits() && !material.is_light());
}

#[test]
fn specular_glossiness_gives_its_diffuse_colour_and_its_gloss() {
    let material = material(json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.1, 0.2, 0.3],
        "glossinessFactor": 0.75 } } }));
    assert_eq!(material.reflectance.factor, [0.5, 0.25, 0.125, 1.0]);
    let p = principled(&material);
    assert!(p.ior == 0.0 && p.facets.roughness.is(0.25), "{p:?}");
    assert_eq!(p.specular_color.factor, [0.1, 0.2, 0.3, 1.0]);
}

fn principled(material: &Material) -> &Principled {
    let Scattering::Principled(principled) = &material.scattering else {
        panic!("not principled: {material:?}");
    };
    principled
}

/// The factor that a scalar has everywhere.
fn value(scalar: &Scalar) -> f32 {
    scalar.texture.factor[scalar.channel]
}

#[test]
fn what_is_not_written_is_what_gltf_says() {
    let material = material(json!({}));
    assert_eq!(principled(&material), &Principled::default());
    assert_eq!(material.interior, None);
}

/// As KHR_materials_volume has it: only with an extension that lets light in.
#[test]
fn what_lets_no_light_in_has_nothing_inside() {
    let volume = json!({ "thicknessFactor": 0.1, "attenuationColor": [1, 0.5, 0.25] });
    let with = |name: &str, keys: Value| {
        let extensions =
            json!({ "KHR_materials_volume": volume, format!("KHR_materials_{name}"): keys });
        material(json!({ "extensions": extensions })).interior.is_some()
    };
    assert!(!with("specular", json!({})));
    assert!(!with("transmission", json!({ "transmissionFactor": 0 })));
    assert!(with("transmission", json!({ "transmissionFactor": 0.1 })));
    assert!(with("diffuse_transmission", json!({ "diffuseTransmissionFactor": 0.1 })));
}

#[test]
fn all_ratified_extensions_are_read() {
    let material = material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0.25, "roughnessFactor": 0.75 },
        "extensions": {
            "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [2, 0.5, 0] },
            "KHR_materials_transmission": { "transmissionFactor": 0.9 },
            "KHR_materials_volume": {
                "thicknessFactor": 0.1, "attenuationDistance": 2.0, "attenuationColor": [1, 0.5, 0.25] },
            "KHR_materials_dispersion": { "dispersion": 0.5 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.1 },
            "KHR_materials_sheen": { "sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.6 },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.8, "anisotropyRotation": 0.5 },
            "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceIor": 1.8,
                "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 800 },
            "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.3, "diffuseTransmissionColorFactor": [1, 0, 0] },
        },
    }));
    let p = principled(&material);
    let scalars = [
        &p.metallic,
        &p.facets.roughness,
        &p.specular,
        &p.transmission,
        &p.clearcoat,
        &p.clearcoat_roughness,
        &p.sheen_roughness,
        &p.facets.anisotropy,
        &p.iridescence,
        &p.diffuse_transmission,
    ];
    let expected = [0.25, 0.75, 0.5, 0.9, 0.7, 0.1, 0.6, 0.8, 1.0, 0.3];
    assert_eq!(scalars.map(value), expected);
    assert_eq!((p.ior, p.facets.rotation, p.iridescence_ior), (1.4, 0.5, 1.8));
    assert_eq!(p.specular_color.factor[..3], [2.0, 0.5, 0.0]);
    assert_eq!(p.sheen_color.factor[..3], [0.1, 0.2, 0.3]);
    assert_eq!(p.diffuse_transmission_color.factor[..3], [1.0, 0.0, 0.0]);
    assert_eq!(p.iridescence_thickness_range, [200.0, 800.0]);
    let interior = material.interior.expect("it is a solid");
    assert_eq!((interior.index, interior.dispersion), (1.4, 0.025));
    // Half of the green light is left after two metres.
    assert!((interior.absorption.y - 0.5 * 2.0_f32.ln()).abs() < 1e-6, "{interior:?}");
    assert_eq!(interior.absorption.x, 0.0);
}

#[test]
fn textures_give_the_channels_that_gltf_names() {
    let info = json!({ "index": 0 });
    let (material, _) = textured(info.clone(), |document| {
        let pbr = &mut document["materials"][0]["pbrMetallicRoughness"];
        pbr["metallicRoughnessTexture"] = info.clone();
        pbr["metallicFactor"] = json!(1);
        document["materials"][0]["extensions"] = json!({
            "KHR_materials_sheen": { "sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 1,
                "sheenRoughnessTexture": info },
            "KHR_materials_transmission": { "transmissionTexture": info },
            "KHR_materials_anisotropy": { "anisotropyStrength": 1, "anisotropyTexture": info },
        });
    });
    let p = principled(&material);
    let scalars = [&p.metallic, &p.facets.roughness, &p.sheen_roughness, &p.facets.anisotropy];
    assert_eq!(scalars.map(|scalar| scalar.channel), [2, 1, 3, 2]);
    let shows = |scalar: &Scalar| matches!(scalar.texture.pattern, Pattern::Image { .. });
    assert_eq!(scalars.map(shows), [true; 4]);
    // Nothing is read of a picture that is multiplied by 0.
    assert!(p.transmission.is(0.0) && !shows(&p.transmission));
    assert!(p.facets.direction.is_some());
}

/// Red of the picture by its strength; the thickness of films is green between least and most.
#[test]
fn occlusion_and_thickness_have_their_channels_and_ranges() {
    let (material, warnings) = textured(json!({ "index": 0 }), |document| {
        let material = &mut document["materials"][0];
        material["occlusionTexture"] = json!({ "index": 0, "strength": 0.25 });
        material["extensions"] = json!({ "KHR_materials_iridescence": {
            "iridescenceFactor": 1, "iridescenceThicknessMinimum": 300,
            "iridescenceThicknessMaximum": 200, "iridescenceThicknessTexture": { "index": 0 } } });
    });
    assert_eq!(warnings, [""; 0]);
    let map = material.occlusion.as_ref().expect("it has a map");
    assert_eq!((map.strength, map.open.channel), (0.25, 0));
    assert!(matches!(map.open.texture.pattern, Pattern::Image { .. }));
    let p = principled(&material);
    assert_eq!((p.iridescence_thickness.channel, p.iridescence_thickness.is(1.0)), (1, false));
    assert_eq!(p.iridescence_thickness_range, [300.0, 200.0]);
    // Without a picture, films are as thick as they can be.
    let (material, _) = textured(json!({ "index": 0 }), |document| {
        let film = json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1 } });
        document["materials"][0]["extensions"] = film;
    });
    assert!(principled(&material).iridescence_thickness.is(1.0) && material.occlusion.is_none());
}

#[test]
fn textures_bring_their_sampler() {
    let (material, warnings) = textured(json!({ "index": 0 }), |_| {});
    assert_eq!(warnings, [""; 0]);
    let Pattern::Image { image, uv_set, wrap, sampling, .. } = material.reflectance.pattern else {
        panic!("a picture")
    };
    assert_eq!((image, uv_set), (0, 0));
    assert_eq!((wrap, sampling), ([Wrap::Mirror, Wrap::Clamp], Sampling::Nearest));
}

#[test]
fn texture_transforms_hold_for_v_up() {
    let at = |transform: Value, uv: Vec2| {
        let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
        match textured(info, |_| {}).0.reflectance.pattern {
            Pattern::Image { transform, .. } => transform.transform_point2(uv),
            _ => panic!("a picture"),
        }
    };
    let near = |a: Vec2, b: Vec2| assert!(a.abs_diff_eq(b, 1e-6), "{a} is not {b}");
    // v up 0.9 is v down 0.1; scaled by 2 and shifted by 0.3 that is 0.5, v up 0.5.
    let scaled = json!({ "offset": [0.1, 0.3], "scale": [3, 2] });
    near(at(scaled, Vec2::new(0.2, 0.9)), Vec2::new(0.7, 0.5));
    // About the picture's upper left, counter-clockwise as seen: what lay to the right comes to lie above.
    let turned = json!({ "rotation": std::f32::consts::FRAC_PI_2 });
    near(at(turned, Vec2::new(1.0, 1.0)), Vec2::new(0.0, 2.0));
    // Scaled first, then turned.
    let both = json!({ "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 1] });
    near(at(both, Vec2::new(1.0, 1.0)), Vec2::new(0.0, 3.0));
    let set = json!({ "texCoord": 0 });
    near(at(set, Vec2::new(0.2, 0.9)), Vec2::new(0.2, 0.9));
}

#[test]
fn broken_pictures_are_named_and_replaced_by_something_visible() {
    let checker = |texture: &Texture| matches!(texture.pattern, Pattern::Checker { .. });
    let cases = [
        (json!({ "uri": "gone.png" }), "images[0]: gone.png: no such file; a checkerboard"),
        (json!({ "uri": "data:;base64,AAAA" }), "images[0]: "),
        (json!({ "bufferView": 9 }), "images[0]: bufferView 9 does not exist"),
        (json!({ "uri": "../../../../etc/passwd" }), "images[0]: "),
        (json!({}), "images[0]: has neither uri nor bufferView"),
    ];
    for (image, text) in cases {
        let (material, warnings) =
            textured(json!({ "index": 0 }), |document| document["images"][0] = image.clone());
        assert!(checker(&material.reflectance), "{image}");
        assert_eq!(material.reflectance.factor, [1.0; 4]);
        assert!(warnings.len() == 1 && warnings[0].contains(text), "{warnings:?}");
    }
    let only = |name: &str| {
        let textures = json!([{ "extensions": { name: { "source": 0 } } }]);
        textured(json!({ "index": 0 }), |document| document["textures"] = textures.clone())
    };
    for (field, otherwise) in
        [("normalTexture", "no relief is shown"), ("occlusionTexture", "no ambient light is kept")]
    {
        let (material, warnings) = textured(json!({ "index": 0 }), |document| {
            document["images"][0] = json!({ "uri": "gone.png" });
            document["materials"][0] = json!({ field: { "index": 0 } });
        });
        assert!(material.normal.is_none() && material.occlusion.is_none());
        assert!(warnings.len() == 1 && warnings[0].contains(otherwise), "{warnings:?}");
    }
    let (material, warnings) = only("MSFT_texture_dds");
    assert!(checker(&material.reflectance) && warnings[0].contains("DDS"), "{warnings:?}");
    let (material, warnings) = only("KHR_texture_basisu");
    assert!(!checker(&material.reflectance) && warnings.is_empty(), "{warnings:?}");
}

/// Varnish has bumps of its own or none, not those of what is below.
#[test]
fn coats_have_normals_of_their_own() {
    let coat = json!({ "KHR_materials_clearcoat": {
        "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": 0, "scale": 0.5 } } });
    let (material, warnings) = textured(json!({ "index": 0 }), |document| {
        document["materials"][0]["extensions"] = coat.clone();
    });
    assert!(warnings.is_empty(), "{warnings:?}");
    let map = principled(&material).clearcoat_normal.as_ref().unwrap();
    assert_eq!(map.scale, 0.5);
    assert!(matches!(map.texture.pattern, Pattern::Image { .. }) && material.normal.is_none());
}

/// The diffuse colour, what it leaves is mirrored, and roughness is what glossiness is not.
#[test]
fn specular_and_glossiness_come_from_their_texture() {
    let (material, warnings) = textured(json!({ "index": 0 }), |document| {
        document["materials"][0]["extensions"] = json!({ "KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.5, 0.4, 0.3, 1.0], "specularFactor": [0.2, 0.3, 0.4],
            "glossinessFactor": 0.75, "specularGlossinessTexture": { "index": 0 } } });
    });
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(material.reflectance.factor, [0.5, 0.4, 0.3, 1.0]);
    let Scattering::Principled(p) = material.scattering else { panic!("it is principled") };
    assert_eq!(p.specular_color.factor[..3], [0.2, 0.3, 0.4]);
    assert!(matches!(p.specular_color.pattern, Pattern::Image { .. }));
    let roughness = &p.facets.roughness;
    assert_eq!((roughness.channel, roughness.complement), (3, true));
    assert_eq!((roughness.texture.factor[3], roughness.meant(0.75)), (0.75, 0.25));
}

#[test]
fn a_mesh_without_the_texture_coordinates_is_noted() {
    let (_, warnings) = textured(json!({ "index": 0, "texCoord": 1 }), |_| {});
    assert!(warnings[0].contains("meshes[0].primitives[0]: has not the texture coordinates"));
}

#[test]
fn variants_choose_materials() {
    let mut document = triangle();
    let color = |c: f32| json!({ "pbrMetallicRoughness": { "baseColorFactor": [c, 0, 0, 1] } });
    document["materials"] = json!([color(0.25), color(0.5)]);
    let variants = json!({ "KHR_materials_variants": { "variants": [{ "name": "day" }, { "name": "night" }] } });
    document["extensions"] = variants;
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["meshes"][0]["primitives"][0]["extensions"] = json!({
        "KHR_materials_variants": { "mappings": [{ "material": 1, "variants": [1] }] } });
    let of = |variant: Option<&str>| {
        let access = FileAccess::beside(Path::new("m.gltf"), &[]);
        let text = document.to_string();
        let options = Options { variant, ..Options::default() };
        super::super::read(text.as_bytes(), "m.gltf", options, &access, &mut Warnings::new())
    };
    let red = |variant| of(variant).unwrap().materials[0].reflectance.factor[0];
    assert_eq!([None, Some("day"), Some("night")].map(red), [0.25, 0.25, 0.5]);
    let complaint = of(Some("nihgt")).unwrap_err().to_string();
    assert!(
        complaint.contains("there are \"day\", \"night\"; did you mean \"night\"?"),
        "{complaint}"
    );
}
