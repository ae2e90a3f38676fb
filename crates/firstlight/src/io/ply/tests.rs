use super::*;
use std::path::Path;

const SQUARE: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
    end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

fn load(bytes: &[u8]) -> (Result<SceneDescription>, Warnings) {
    let mut warnings = Warnings::new();
    let access = FileAccess::beside(Path::new("x.ply"), &[]);
    let scene = read(bytes, "x.ply", &access, &mut warnings);
    (scene, warnings)
}

fn scene(text: &str) -> SceneDescription {
    load(text.as_bytes()).0.unwrap()
}

fn error(text: &str) -> String {
    load(text.as_bytes()).0.expect_err("must be refused").to_string()
}

#[test]
fn text_with_any_line_end() {
    for text in [SQUARE.to_owned(), SQUARE.replace('\n', "\r\n"), format!("\u{feff}{SQUARE}")] {
        let scene = scene(&text);
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(scene.meshes[0].positions[2].to_array(), [1.0, 1.0, 0.0]);
        assert_eq!(scene.materials[0], default_material());
    }
}

/// A binary file of two triangles with doubles, colours, a list in front of the indices and an unknown element.
fn binary(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement camera 1\nproperty list short int skipped\n\
         element vertex 4\nproperty uchar green\nproperty double z\nproperty double y\nproperty double x\n\
         property uchar red\nproperty uchar blue\nelement face 2\nproperty list uchar float quality\n\
         property list ushort ushort vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut put = |number: &[u8]| {
        let swap = big.then(|| number.iter().rev().copied().collect());
        bytes.extend(swap.unwrap_or_else(|| number.to_vec()));
    };
    put(&1i16.to_le_bytes());
    put(&7i32.to_le_bytes());
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        put(&[255]);
        [0.0, y, x].iter().for_each(|value: &f64| put(&value.to_le_bytes()));
        put(&[188]);
        put(&[0]);
    }
    for face in [[0u16, 1, 2], [0, 2, 3]] {
        put(&[1]);
        put(&0.5f32.to_le_bytes());
        put(&3u16.to_le_bytes());
        face.iter().for_each(|index| put(&index.to_le_bytes()));
    }
    bytes
}

#[test]
fn binary_of_both_orders() {
    for big in [false, true] {
        let scene = load(&binary(big)).0.unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.positions[1].to_array(), [1.0, 0.0, 0.0]);
        let [red, green, blue, alpha] = mesh.colors[0];
        assert!((red - 0.5029).abs() < 1e-3, "{red}");
        assert_eq!([green, blue, alpha], [1.0, 0.0, 1.0]);
        assert!(scene.materials[0].reflectance.vertex_colors);
        assert_eq!(scene.materials[0].reflectance.factor, [1.0; 4]);
    }
}

#[test]
fn a_binary_file_cut_anywhere_is_refused() {
    let bytes = binary(false);
    for length in 0..bytes.len() {
        assert!(load(&bytes[..length]).0.is_err(), "{length} bytes");
    }
    let cut = load(&bytes[..bytes.len() - 1]).0.unwrap_err().to_string();
    assert!(cut.starts_with("x.ply: byte "), "{cut}");
    assert!(
        cut.contains("face 1 of 2: list \"vertex_index\" of length 3, but 5 bytes follow"),
        "{cut}"
    );
}

#[test]
fn lying_counts_are_refused() {
    let vertices = error(&SQUARE.replace("vertex 4", "vertex 4294967295"));
    assert!(vertices.starts_with("x.ply:4: \"vertex\" promises 4294967295 rows"), "{vertices}");
    let overflow = error(&SQUARE.replace("face 1", "face 18446744073709551615"));
    assert!(overflow.contains("\"face\" promises 18446744073709551615 rows"), "{overflow}");
    let list = error(&SQUARE.replace("4 0 1 2 3", "4000000000 0 1 2 3"));
    assert!(list.starts_with("x.ply:15: face 0 of 1: list \"vertex_indices\""), "{list}");
    assert!(error(&SQUARE.replace("4 0 1 2 3", "-1 0")).contains("of length -1"));
    let empty =
        SQUARE.replace("element face", "element nothing 18446744073709551615\nelement face");
    assert!(scene(&empty).meshes[0].triangles.len() == 2);
}

#[test]
fn wrong_values_are_named() {
    let index = error(&SQUARE.replace("4 0 1 2 3", "4 0 1 2 4"));
    assert!(
        index.starts_with("x.ply:15: face 0 of 1: vertex 4 does not exist, only vertices 0 to 3"),
        "{index}"
    );
    assert!(error(&SQUARE.replace("4 0 1 2 3", "4 0 1 2 -1")).contains("vertex -1 does not exist"));
    let word = error(&SQUARE.replace("1 1 0", "1 one 0"));
    assert!(word.starts_with("x.ply:13: vertex 2 of 4: cannot read \"one\" as a number"), "{word}");
    let early = error(SQUARE.trim_end().strip_suffix(" 3").unwrap());
    assert!(early.contains("face 0 of 1: list \"vertex_indices\" of length 4, but"), "{early}");
}

#[test]
fn broken_headers_are_named() {
    assert!(error("").contains("this is no PLY file"));
    assert!(error("ply\nformat ascii 1.0\n").contains("\"end_header\" is missing"));
    assert!(error(&SQUARE.replace("format ascii 1.0\n", "")).contains("no \"format\" line"));
    let typo = error(&SQUARE.replace("element face", "elemnt face"));
    assert!(typo.contains("x.ply:8") && typo.contains("did you mean \"element\"?"), "{typo}");
    assert!(error(&SQUARE.replace("float z", "half z")).contains("\"half\" is no type of number"));
    assert!(error(&SQUARE.replace("float z", "float w")).contains("no \"x\", \"y\" and \"z\""));
    assert!(
        error(&SQUARE.replace("vertex_indices", "corners")).contains("no list \"vertex_indices\"")
    );
    assert!(error(&SQUARE.replace("element face 1", "element face 0")).contains("cloud of points"));
}

#[test]
fn normals_coordinates_and_their_repair() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0 2 0 0\n1 0 0 0 0 0 nan 0\n0 1 0 0 0 1 0 1\nnan 0 0 0 0 1 0 0\n3 0 1 2\n3 0 1 3\n";
    let (scene, warnings) = load(text.as_bytes());
    let mesh = &scene.unwrap().meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(mesh.positions.len(), 3, "what is not finite is gone");
    assert!(mesh.normals.iter().all(|normal| (normal.z - 1.0).abs() < 1e-6), "{:?}", mesh.normals);
    assert_eq!(mesh.uvs[0][1].to_array(), [0.0, 0.0]);
    let said: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(said[1].starts_with("x.ply: face 1: 1 face without area"), "{said:?}");
}

#[test]
fn strips_turn_every_second_triangle() {
    let head = SQUARE.replace("element face 1", "element tristrips 1");
    let text = head.replace("4 0 1 2 3\n", "9 0 1 3 2 2 -1 1 2 3\n");
    assert_eq!(scene(&text).meshes[0].triangles, [[0, 1, 3], [3, 1, 2], [1, 2, 3]]);
}

#[test]
fn faces_with_their_own_coordinates_split_vertices() {
    let head =
        SQUARE.replace("vertex_indices\n", "vertex_indices\nproperty list uchar float texcoord\n");
    let head = head.replace("comment made by hand", "comment TextureFile no such.png");
    let text = head
        .replace("face 1", "face 2")
        .replace("4 0 1 2 3\n", "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 1 0 1\n");
    let (scene, warnings) = load(text.as_bytes());
    let scene = scene.unwrap();
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(scene.meshes[0].uvs[0][3].to_array(), [0.5, 1.0]);
    assert!(
        warnings[0].to_string().contains("cannot use the picture \"no such.png\": no such file")
    );
    let pattern = &scene.materials[0].reflectance.pattern;
    assert!(matches!(pattern, crate::scene::description::Pattern::Checker { .. }));
}

#[test]
fn surplus_values_in_a_line_are_ignored_with_a_warning() {
    let text = SQUARE.replace("1 0 0\n", "1 0 0 7 8\n").replace("0 1 2 3\n", "0 1 2 3 255\n");
    let (scene, warnings) = load(text.as_bytes());
    assert_eq!(scene.unwrap().meshes[0].triangles.len(), 2);
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].to_string().starts_with("x.ply:12: 2 lines with more values"),
        "{}",
        warnings[0]
    );
}
