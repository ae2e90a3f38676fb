//! The rules that keep the house a house: imports go downward only, `unsafe` lives in `simd/`.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules of the library from the ground up. A module may use those before it; those in one row know nothing
/// of each other. `scene::description` is plain data and lies below what is built from it.
const LAYERS: &[&[&str]] = &[
    &["math", "suggest"],
    &["diagnostic", "color", "simd"],
    &["units", "image", "sampler"],
    &["scene::description"],
    &["geometry"],
    &["kernels", "camera", "false_color", "film"],
    &["bvh", "shading"],
    &["scene"],
    &["integrator", "look"],
    &["layers"],
    &["render"],
    &["compare", "doctor", "explain", "passport", "verify"],
    &["io"],
];

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = vec![root.clone()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path: PathBuf = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found
}

/// The layer of a path such as `scene::description::Mesh`; `None` if it is not part of the order.
fn layer(path: &str) -> Option<(usize, &'static str)> {
    let belongs = |module: &str| path == module || path.starts_with(&format!("{module}::"));
    let all = LAYERS.iter().enumerate().flat_map(|(i, row)| row.iter().map(move |m| (i, *m)));
    all.filter(|(_, module)| belongs(module)).max_by_key(|(_, module)| module.len())
}

/// The module paths of `use crate::…` lines, with one level of braces opened.
fn imports(source: &str) -> Vec<String> {
    let flat =
        source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().replace('\n', " ");
    let statements = flat.split("use crate::").skip(1).filter_map(|rest| rest.split(';').next());
    let open = |statement: &str| match statement.split_once('{') {
        Some((base, names)) => {
            let names = names.trim_end_matches('}').split(',');
            names.map(|name| format!("{base}{}", name.trim())).collect()
        }
        None => vec![statement.to_owned()],
    };
    statements.flat_map(open).collect()
}

/// Every upward or sideways import of a file, as messages.
fn upward(name: &str, source: &str) -> Vec<String> {
    let module = name.trim_end_matches(".rs").trim_end_matches("/mod").replace('/', "::");
    let Some((from, own)) = layer(&module) else { return Vec::new() };
    let wrong = imports(source)
        .into_iter()
        .filter(|import| layer(import).is_some_and(|(to, target)| target != own && to >= from));
    wrong.map(|import| format!("{name} ({own}) uses crate::{import}")).collect()
}

#[test]
fn imports_go_downward_only() {
    let is_test = |name: &str| name.ends_with("tests.rs") || name.ends_with("testing.rs");
    let wrong: Vec<_> =
        sources().iter().filter(|(n, _)| !is_test(n)).flat_map(|(n, s)| upward(n, s)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_module_has_its_place_in_the_order() {
    let outside = ["lib", "testing"];
    for (name, _) in sources() {
        let module = name.trim_end_matches(".rs").replace('/', "::");
        assert!(layer(&module).is_some() || outside.contains(&module.as_str()), "{name}");
    }
}

#[test]
fn an_upward_import_would_be_found() {
    assert_eq!(upward("geometry/ray.rs", "use crate::scene::description::Mesh;\n").len(), 0);
    assert_eq!(upward("geometry/ray.rs", "use crate::scene::Scene;\n").len(), 1);
    assert_eq!(upward("bvh/mod.rs", "use crate::{math::hash,\n    render::render};\n").len(), 1);
    assert_eq!(upward("shading/mod.rs", "use crate::bvh::World;\n").len(), 1);
}

#[test]
fn unsafe_lives_in_simd_and_says_why() {
    for (name, source) in sources() {
        let code = source.lines().filter(|line| !line.trim_start().starts_with("//"));
        let blocks =
            code.filter(|line| line.contains("unsafe {") || line.contains("unsafe fn")).count();
        if !name.starts_with("simd/") {
            assert_eq!(blocks, 0, "{name} contains unsafe code");
            assert!(!source.contains("allow(unsafe_code)"), "{name} allows unsafe code");
        }
        let reasons = source.matches("// SAFETY: ").count();
        assert!(reasons >= blocks, "{name}: {blocks} unsafe blocks, {reasons} reasons");
    }
}
