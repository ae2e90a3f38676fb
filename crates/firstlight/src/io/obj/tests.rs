use super::*;
use crate::color::Rgb;
use crate::scene::description::{
    Alpha, BumpAmount, BumpMap, Material, Pattern, Scalar, Scattering, Texture, Wrap,
};
use crate::shading::texture::Role;
use glam::Vec2;
use std::path::Path;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn load_in(folder: &Path, text: &str) -> (Result<SceneDescription>, Warnings) {
    let mut warnings = Warnings::new();
    let access = FileAccess::beside(&folder.join("x.obj"), &[]);
    let scene = read(text.as_bytes(), "x.obj", &access, &mut warnings);
    (scene, warnings)
}

fn load(text: &str) -> (SceneDescription, Vec<String>) {
    let (scene, warnings) = load_in(Path::new(""), text);
    (scene.unwrap(), warnings.iter().map(ToString::to_string).collect())
}

fn error(text: &str) -> String {
    load_in(Path::new(""), text).0.expect_err("must be refused").to_string()
}

/// The materials of a triangle per name, described by the text of a material file.
fn materials(mtl: &str, names: &[&str]) -> (Vec<Material>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my materials.mtl"), mtl).unwrap();
    write_picture(&folder.path().join("red.png"), [255, 0, 0, 255]);
    write_picture(&folder.path().join("leaf.png"), [0, 255, 0, 0]);
    let faces: String = names.iter().map(|name| format!("usemtl {name}\nf 1 2 3\n")).collect();
    let text = format!("mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let (scene, warnings) = load_in(folder.path(), &text);
    (scene.unwrap().materials, warnings.iter().map(ToString::to_string).collect())
}

fn write_picture(path: &Path, color: [u8; 4]) {
    image::RgbaImage::from_pixel(1, 1, image::Rgba(color)).save(path).unwrap();
}

#[test]
fn indices_of_every_form() {
    for face in
        ["f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -3 -2 -1"]
    {
        let (scene, warnings) =
            load(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 1\nvn 0 0 2\n{face}\n"));
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{face}");
        assert_eq!(mesh.normals.is_empty(), face.split('/').count() < 6, "{face}");
        assert!(mesh.normals.iter().all(|normal| normal.to_array() == [0.0, 0.0, 1.0]));
        assert_eq!(
            mesh.uvs.first().map(|set| set[0]),
            face.contains("/1").then_some(Vec2::new(0.5, 1.0)).filter(|_| !face.contains("//"))
        );
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

#[test]
fn text_of_any_shape() {
    let joined =
        "\u{feff}# a comment \\\r\nv 0 0 0 # here\r\nv 1 0 \\\r\n 0\r\n\tv 0 1 0\rf 1 2\\\n 3";
    let (scene, warnings) = load(joined);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.meshes[0].positions[1].to_array(), [1.0, 0.0, 0.0]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn negative_numbers_count_from_where_they_stand() {
    let (scene, _) = load(&format!("{TRIANGLE}v 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\nv 9 9 9\n"));
    assert_eq!(scene.meshes[0].positions[3].to_array(), [5.0, 0.0, 0.0]);
}

#[test]
fn wrong_lines_are_named() {
    let range = error(&TRIANGLE.replace("f 1 2 3", "f 1 2 4"));
    assert_eq!(range, "x.obj:4: vertex 4 does not exist, only 1 to 3\n    4 | f 1 2 4");
    assert!(error(&TRIANGLE.replace("f 1 2 3", "f 0 1 2")).contains("numbers start at 1"));
    assert!(error(&TRIANGLE.replace("f 1 2 3", "f -4 1 2")).contains("only 3 before"));
    assert!(
        error(&TRIANGLE.replace("f 1 2 3", "f 1/1 2 3")).contains("texture coordinate 1 does not")
    );
    assert!(
        error(&TRIANGLE.replace("f 1 2 3", "f 1 2 18446744073709551615")).contains("as a vertex")
    );
    assert!(
        error(&TRIANGLE.replace("f 1 2 3", "f 1 2 9223372036854775807")).contains("only 1 to 3")
    );
    assert!(
        error(&TRIANGLE.replace("f 1 2 3", "f 1 2 -9223372036854775808")).contains("only 3 before")
    );
    assert!(error(&TRIANGLE.replace("f 1 2 3", "f 1/1/1/1 2 3")).contains("x.obj:4"));
    let comma = error(&TRIANGLE.replace("v 1 0 0", "v 1,5 0 0"));
    assert!(
        comma.contains("x.obj:2: cannot read \"1,5\"") && comma.contains("no comma"),
        "{comma}"
    );
    assert!(error("v 1 2\n").contains("3 numbers expected here, but only 2 found"));
    assert!(error("v 1 2 3\n").contains("no triangles"));
}

#[test]
fn polygons_become_triangles() {
    let arrow = "v 0 0 0\nv 4 -3 0\nv 1 0 0\nv 4 3 0\nf 2 3 4 1\n";
    assert_eq!(area(&load(arrow).0), 3.0, "a quad that is not convex");
    let letter = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8\n";
    assert_eq!(area(&load(letter).0), 7.0, "the letter U");
    let turned = letter.replace("f 1 2 3 4 5 6 7 8", "f 8 7 6 5 4 3 2 1");
    assert_eq!(area(&load(&turned).0), -7.0, "its back");
    let corners = (0..70_000).map(|_| " 1").collect::<String>();
    assert!(error(&format!("v 0 0 0\nf{corners}\n")).contains("more than 65536 corners"));
}

/// The area of all triangles, seen from +z; fails if two of them face opposite sides.
fn area(scene: &SceneDescription) -> f32 {
    let mesh = &scene.meshes[0];
    let areas = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z / 2.0
    });
    let areas: Vec<f32> = areas.collect();
    assert!(areas.iter().all(|area| area.signum() == areas[0].signum()), "{areas:?}");
    areas.iter().sum()
}

#[test]
fn smoothing_groups_make_normals() {
    let roof = "v -1 0 0\nv -1 1 0\nv 0 0 1\nv 0 1 1\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 1\n\
        GROUP\nf 1/1 3/1 4/1 2/1\nf 3/2 5/2 6/2 4/2\n";
    let smooth = load(&roof.replace("GROUP", "s 1")).0;
    let mesh = &smooth.meshes[0];
    let ridge = mesh.positions.iter().zip(&mesh.normals).filter(|(position, _)| position.z == 1.0);
    let normals: Vec<_> = ridge.map(|(_, normal)| *normal).collect();
    assert_eq!(normals.len(), 4, "split by texture coordinates");
    assert!(normals.iter().all(|normal| (normal.z.abs() - 1.0).abs() < 1e-6), "{normals:?}");
    assert!(load(&roof.replace("GROUP", "s off")).0.meshes[0].normals.is_empty());
}

#[test]
fn vertices_have_colors() {
    let (scene, warnings) = load("v 0 0 0\nv 1 0 0 0.5 0.25 2\nv 0 1 0 1\nf 1 2 3\n");
    assert_eq!(scene.meshes[0].colors, [[1.0; 4], [0.5, 0.25, 1.0, 1.0], [1.0; 4]]);
    assert!(scene.materials[0].reflectance.vertex_colors);
    assert!(warnings[0].starts_with("x.obj:2: 1 vertex color outside 0..1"), "{warnings:?}");
}

#[test]
fn what_is_not_shown_is_counted() {
    let text = format!("{TRIANGLE}l 1 2\np 1\nusemlt x\ncurv 0\nv nan 0 0\nf 1 2 4\nf 1 1 2\n");
    let (scene, warnings) = load(&text);
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert!(scene.meshes[0].positions.iter().all(|position| position.is_finite()));
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].starts_with("x.obj:10: 2 faces without area"), "{warnings:?}");
    assert!(warnings[2].starts_with("x.obj:7: 2 lines with an unknown keyword"), "{warnings:?}");
}

#[test]
fn every_material_is_a_surface() {
    let text =
        format!("{TRIANGLE}usemtl Wood\nf 1 2 3\nusemtl Iron\nf 1 2 3\nusemtl Wood\nf 3 2 1\n");
    let (scene, warnings) = load(&text);
    let names: Vec<&str> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["default", "Wood", "Iron"]);
    assert_eq!(scene.meshes[scene.surfaces.len() - 2].triangles.len(), 2);
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].contains("describes \"Wood\" and 1 material more: shown in"),
        "{warnings:?}"
    );
}

#[test]
fn missing_material_files_are_named() {
    let (scene, warnings) = load(&format!("mtllib no.mtl\nusemtl a\n{TRIANGLE}"));
    assert_eq!(scene.materials[0].reflectance.factor, [0.5, 0.5, 0.5, 1.0]);
    assert!(
        warnings[0].starts_with("x.obj:1: cannot use the material file \"no.mtl\": no such file")
    );
    let (_, warnings) = load(&format!("mtllib ../../../etc/passwd\n{TRIANGLE}"));
    assert!(
        warnings[0].contains("not opened") || warnings[0].contains("no such file"),
        "{warnings:?}"
    );
}

#[test]
fn colors_and_opacity() {
    let mtl = "newmtl red\r\n Kd 2 0 0\r\nKs 1 1 1\nnewmtl glass\nKd 0.25\nd 0.5\nnewmtl old\nTr 1\n\
        newmtl lamp\nKd 0 0 0\nKe 3 2 1\nwhatever 1\nnewmtl bad\nKd one two three\n";
    let (materials, warnings) = materials(mtl, &["red", "glass", "old", "lamp", "bad"]);
    assert_eq!(materials[0].reflectance.factor, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(materials[1].reflectance.factor, [0.25, 0.25, 0.25, 0.5]);
    assert_eq!(materials[1].alpha, Alpha::Blend);
    assert_eq!(materials[2], Material::matte("old", Rgb::splat(0.5)));
    assert_eq!(materials[3].emission.factor, [3.0, 2.0, 1.0, 1.0]);
    assert_eq!(materials[4].reflectance.factor, [0.5, 0.5, 0.5, 1.0]);
    assert_eq!(warnings.len(), 5, "{warnings:?}");
    assert!(warnings[1].starts_with("my materials.mtl:14: 1 line without a readable value"));
}

#[test]
fn pictures_and_their_options() {
    let mtl = "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd -s 2 3 1 -o 0.5 -clamp on -bm 1 red.png\n\
        newmtl b\nKd 0 0 0\nmap_Kd C:\\somewhere\\red.png\nnewmtl c\nmap_Kd leaf.png\nmap_d leaf.png\n\
        newmtl d\nmap_Kd no such.png\nmap_d red.png\n";
    let (materials, warnings) = materials(mtl, &["a", "b", "c", "d"]);
    let Pattern::Image { transform, wrap, .. } = materials[0].reflectance.pattern else {
        panic!("no picture: {:?}", materials[0]);
    };
    assert_eq!(transform.transform_point2(Vec2::ONE).to_array(), [2.5, 3.0]);
    assert_eq!(wrap, [Wrap::Clamp; 2]);
    assert_eq!(materials[0].reflectance.factor, [0.5, 0.5, 0.5, 1.0]);
    assert!(matches!(materials[1].reflectance.pattern, Pattern::Image { .. }));
    assert_eq!(materials[1].reflectance.factor, [1.0; 4]);
    assert_eq!([materials[1].alpha, materials[2].alpha], [Alpha::Opaque, Alpha::Blend]);
    assert!(matches!(materials[3].reflectance.pattern, Pattern::Checker { .. }));
    let mask = materials[3].opacity.as_ref().map(|mask| (&mask.texture.pattern, mask.channel));
    assert!(matches!(mask, Some((Pattern::Image { .. }, 0))), "{mask:?}");
    assert_eq!([&materials[2].opacity, &materials[0].opacity], [&None, &None]);
    assert_eq!(materials[3].alpha, Alpha::Blend);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].starts_with("my materials.mtl:11: cannot use the picture \"no such.png\""));
}

#[test]
fn gloss_metal_and_glass_are_taken_over() {
    let mtl = "newmtl phong\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 30\nillum 2\n\
        newmtl mirror\nKd 0 0 0\nKs 0.8 0.8 0.8\nillum 3\n\
        newmtl pbr\nPr 0.3\nPm 1\nPc 0.5\nPcr 0.1\nPs 0.2\naniso 0.4\nanisor 0.25\n\
        newmtl glass\nTf 0.9 1 1\nNi 1.45\nillum 7\nd 0.1\nnewmtl plain\nKs 0 0 0\nillum 1\n";
    let (materials, warnings) = materials(mtl, &["phong", "mirror", "pbr", "glass", "plain"]);
    let principled = |i: usize| match &materials[i].scattering {
        Scattering::Principled(principled) => principled,
        other => panic!("{other:?}"),
    };
    let roughness = |i: usize| principled(i).facets.roughness.texture.factor[0];
    assert_eq!(principled(0).specular_color.factor[0], 1.0);
    assert!((roughness(0) - 0.5).abs() < 1e-6, "{}", roughness(0));
    assert_eq!(principled(1).specular_color.factor[0], 20.0);
    assert_eq!((roughness(2), principled(2).metallic.texture.factor[0]), (0.3, 1.0));
    assert!((principled(2).facets.rotation - 0.5 * std::f32::consts::PI).abs() < 1e-6);
    assert_eq!(materials[3].interior.map(|interior| interior.index), Some(1.45));
    assert_eq!(materials[3].reflectance.factor, [0.9, 1.0, 1.0, 1.0]);
    assert_eq!(materials[3].alpha, Alpha::Opaque);
    assert!(materials[4].is_matte());
    assert!(warnings.is_empty(), "{warnings:?}");
}

/// Numbers of pictures: which channel, over which range, and for which part of the surface.
#[test]
fn numbers_may_be_pictures_of_any_channel_and_range() {
    let mtl = "newmtl a\nPc 0.5\nmap_Pc -imfchan b layers.png\nmap_Pcr -imfchan g layers.png\n\
        map_aniso -mm 0.25 0.5 layers.png\nmap_Ps -mm 0.2 0.4 layers.png\n\
        newmtl b\nmap_d -imfchan m layers.png\nmap_Kd red.png\nmap_Pr -imfchan l layers.png\n\
        newmtl c\nmap_Kd -mm 0.5 0.25 \"red.png\"\ndisp layers.png\nREFL layers.png\nmap_Ns layers.png\n\
        map_Tr layers.png\nmap_Tr layers.png\nnorm gone.png\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    write_picture(&folder.path().join("layers.png"), [51, 102, 204, 153]);
    write_picture(&folder.path().join("red.png"), [255, 0, 0, 255]);
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n";
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let (scene, warnings) = load_in(folder.path(), &text);
    let scene = scene.unwrap();
    let [a, b, c] = &scene.materials[..] else { panic!("there are three") };
    // One texel is the same everywhere.
    let texel = |texture: &Texture, role| {
        let Pattern::Image { image, .. } = texture.pattern else { panic!("{texture:?}") };
        let value = crate::shading::texture::texel(&scene.images[image], 0, role);
        value * glam::Vec4::from_array(texture.factor)
    };
    let number = |scalar: &Scalar| texel(&scalar.texture, Role::Data)[scalar.channel];
    let close = |value: f32, expected: f32| {
        assert!((value - expected).abs() < 1e-6, "{value}, expected {expected}");
    };
    let Scattering::Principled(p) = &a.scattering else { panic!("{a:?}") };
    close(number(&p.clearcoat), 0.5 * 0.8);
    close(number(&p.clearcoat_roughness), 0.4);
    close(number(&p.facets.anisotropy), 0.25 + 0.5 * 0.2);
    close(texel(&p.sheen_color, Role::Color).x, 0.2 + 0.4 * 0.2);
    close(number(b.opacity.as_ref().unwrap()), 0.6);
    let Scattering::Principled(p) = &b.scattering else { panic!("{b:?}") };
    close(number(&p.facets.roughness), 0.2);
    assert_eq!(texel(&c.reflectance, Role::Color).to_array(), [0.75, 0.5, 0.5, 1.0]);
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let starts = [
        "m.mtl:13: 1 line with disp skipped: surfaces are not moved",
        "m.mtl:14: 1 line with refl skipped",
        "m.mtl:15: 1 line with map_Ns skipped",
        "m.mtl:16: 2 lines with map_Tr skipped: nothing is cut out; map_d does that",
        "m.mtl:18: cannot use the picture \"gone.png\": no such file",
    ];
    assert_eq!(warnings.len(), starts.len(), "{warnings:?}");
    assert!(warnings.iter().zip(starts).all(|(w, start)| w.starts_with(start)), "{warnings:?}");
    assert!(warnings[4].ends_with("help: no relief is shown"), "{warnings:?}");
}

/// Paths that exporters leave behind.
#[test]
fn pictures_are_found_by_the_ends_of_their_paths() {
    let mtl = "newmtl a\nmap_Kd \"Tex/A Leaf.PNG\"\nmap_Ke D:\\old\\tex\\a leaf.png\n\
        newmtl b\nmap_Kd /home/me/a leaf.png\nmap_Ke a.svg\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tex")).unwrap();
    std::fs::write(folder.path().join("M.MTL"), mtl).unwrap();
    std::fs::write(folder.path().join("a.svg"), "<svg/>").unwrap();
    write_picture(&folder.path().join("tex/a leaf.png"), [9, 9, 9, 255]);
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let (scene, warnings) = load_in(folder.path(), &text);
    let scene = scene.unwrap();
    let found = |texture: &Texture| matches!(texture.pattern, Pattern::Image { .. });
    assert!(found(&scene.materials[0].reflectance) && found(&scene.materials[0].emission));
    assert!(!found(&scene.materials[1].reflectance));
    let warnings: String = warnings.iter().map(|warning| format!("{warning}\n")).collect();
    let library = "x.obj:1: a material file cannot be opened where the model says: \"m.mtl\", for which \
        \"M.MTL\" is taken";
    assert!(warnings.contains(library), "{warnings}");
    let moved = "M.MTL:2: 2 pictures cannot be opened where the model says, such as \"Tex/A Leaf.PNG\", for which \
        \"tex/a leaf.png\" is taken";
    assert!(warnings.contains(moved), "{warnings}");
    let formats = "help: PNG, JPEG, WebP, KTX2, TGA, BMP, TIFF, GIF, HDR, EXR and PFM can be read; magenta and";
    assert!(warnings.contains(formats), "{warnings}");
}

/// Blanks are in names, in those of folders, and between names.
#[test]
fn material_files_may_have_blanks_in_their_paths() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    for (name, color) in [("my car.mtl", "1 0 0"), ("a.mtl", "0 1 0"), ("b.mtl", "0 0 1")] {
        std::fs::write(folder.path().join(name), format!("newmtl {name}\nKd {color}\n")).unwrap();
    }
    let known = |line: &str| {
        let faces = "usemtl my car.mtl\nf 1 2 3\nusemtl a.mtl\nf 1 2 3\nusemtl b.mtl\nf 1 2 3\n";
        let text = format!("mtllib {line}\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
        let scene = load_in(folder.path(), &text).0.unwrap();
        scene.materials.iter().map(|it| it.reflectance.factor[..3] != [0.5; 3]).collect::<Vec<_>>()
    };
    for line in ["my car.mtl", "My Car.MTL", "C:\\My Models\\my car.mtl", "../my stuff/My car.mtl"]
    {
        assert_eq!(known(line), [true, false, false], "{line}");
    }
    for line in ["a.mtl b.mtl", "old/a.mtl old/b.mtl", "A.mtl sub\\B.mtl"] {
        assert_eq!(known(line), [false, true, true], "{line}");
    }
}

/// Copies of pictures take sixteen bytes a pixel, each and together.
#[test]
fn changed_pictures_stay_within_the_limits() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbaImage::from_pixel(8, 8, image::Rgba([9, 8, 7, 255]));
    picture.save(folder.path().join("it.png")).unwrap();
    let material = |i: u32| format!("newmtl {i}\nmap_Kd -mm 0.{i} 1 it.png\nmap_Ke it.png\n");
    let mtl: String = (1..=5).map(material).collect();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    let faces: String = (1..=5).map(|i| format!("usemtl {i}\nf 1 2 3\n")).collect();
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let copies = |decoded_bytes: u64| {
        let mut warnings = Warnings::new();
        let mut access = FileAccess::beside(&folder.path().join("x.obj"), &[]);
        access.limits.decoded_bytes = decoded_bytes;
        let scene = read(text.as_bytes(), "x.obj", &access, &mut warnings).unwrap();
        let shown = |it: &&Material| matches!(it.reflectance.pattern, Pattern::Image { .. });
        let glows = |it: &Material| matches!(it.emission.pattern, Pattern::Image { .. });
        assert!(scene.materials.iter().all(glows));
        let full = warnings.iter().filter(|w| w.to_string().contains("would unpack to 1 KiB"));
        (scene.materials.iter().filter(shown).count(), full.count())
    };
    assert_eq!([300, 1024, 2048].map(copies), [(0, 5), (4, 1), (5, 0)]);
}

/// A grey picture holds heights; one with colours can only hold normals, whatever its key says.
#[test]
fn bump_maps_are_heights_unless_they_have_colours() {
    let mtl = "newmtl a\nbump -bm 2 leaf.png\nnewmtl b\nmap_Bump -bm 0.5 grey.png\nnewmtl c\nbump gone.png\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    write_picture(&folder.path().join("leaf.png"), [128, 128, 255, 255]);
    write_picture(&folder.path().join("grey.png"), [90, 90, 90, 255]);
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n";
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let (scene, warnings) = load_in(folder.path(), &text);
    let [a, b, c] = &scene.unwrap().materials[..] else { panic!("there are three") };
    assert_eq!((a.bump.is_none(), a.normal.as_ref().map(|map| map.scale)), (true, Some(2.0)));
    let amount = b.bump.as_ref().map(|map| map.amount);
    assert_eq!((b.normal.is_none(), amount), (true, Some(BumpAmount::Relative(0.005))));
    assert!(c.bump.is_none() && c.normal.is_none());
    assert!(warnings.iter().any(|warning| warning.to_string().contains("gone.png")));
}

/// What a height is does not depend on how high it is made; and one channel is no normal.
#[test]
fn heights_may_be_of_any_channel_and_range() {
    let mtl = "newmtl a\nbump -bm 2 -mm 0.5 3 nearly grey.png\nnewmtl b\nbump -imfchan b blue.png\n\
        newmtl c\nbump -mm 0 0.5 blue.png\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    write_picture(&folder.path().join("nearly grey.png"), [90, 95, 92, 255]);
    write_picture(&folder.path().join("blue.png"), [128, 128, 255, 255]);
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n";
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let scene = load_in(folder.path(), &text).0.unwrap();
    let [a, b, c] = &scene.materials[..] else { panic!("there are three") };
    let bump = |material: &Material| {
        let BumpMap { height, amount } = material.bump.clone()?;
        Some((height.channel, amount))
    };
    assert_eq!(bump(a), Some((0, BumpAmount::Relative(0.01 * 2.0 * 3.0))));
    assert_eq!(bump(b), Some((2, BumpAmount::Relative(0.01))));
    assert!(c.bump.is_none() && c.normal.is_some());
    // The heights are as the picture has them: only the normals are a copy.
    assert_eq!(scene.images.len(), 3);
}

/// What `-imfchan` and `-mm` say is true of alpha and of the colour of sheen as well.
#[test]
fn channels_and_ranges_reach_alpha_and_sheen() {
    let mtl = "newmtl a\nmap_Ps -imfchan b -mm 0.1 0.5 layers.png\nmap_d -mm 1 -1 layers.png\n\
        newmtl b\nmap_d -imfchan l layers.png\nnewmtl c\nmap_Kd layers.png\nmap_d -mm 1 -1 layers.png\n\
        newmtl d\nmap_Kd solid.png\nmap_d -mm 1 -1 solid.png\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    write_picture(&folder.path().join("layers.png"), [51, 102, 204, 153]);
    write_picture(&folder.path().join("solid.png"), [51, 102, 204, 255]);
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\nusemtl d\nf 1 2 3\n";
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let scene = load_in(folder.path(), &text).0.unwrap();
    let [a, b, c, d] = &scene.materials[..] else { panic!("there are four") };
    let texel = |texture: &Texture| {
        let Pattern::Image { image, .. } = texture.pattern else { panic!("{texture:?}") };
        crate::shading::texture::texel(&scene.images[image], 0, Role::Data)
    };
    let opacity = |material: &Material| {
        material.opacity.as_ref().map(|mask| texel(&mask.texture)[mask.channel])
    };
    let close = |value: f32, expected: f32| {
        assert!((value - expected).abs() < 1e-6, "{value}, expected {expected}");
    };
    let Scattering::Principled(p) = &a.scattering else { panic!("{a:?}") };
    let sheen = texel(&p.sheen_color);
    (0..3).for_each(|channel| close(sheen[channel], 0.1 + 0.5 * 0.8));
    close(opacity(a).unwrap(), 0.4);
    close(opacity(b).unwrap(), 0.2);
    assert_eq!((opacity(c), c.alpha), (None, Alpha::Blend));
    close(texel(&c.reflectance).w, 0.4);
    close(texel(&c.reflectance).x, crate::color::srgb_decode(0.2));
    // Without alpha there is nothing to turn round.
    assert_eq!((opacity(d), d.alpha, texel(&d.reflectance).w), (None, Alpha::Opaque, 1.0));
}
