//! What is traced: a mesh, where it is seen from, where its light is.

use crate::meshes;
use firstlight::io::model_override;
use firstlight::scene::description::{
    CameraDescription, FilmDescription, Material, Mesh, Projection, Shape, Surface,
};
use firstlight::scene::{bounds, frame};
use firstlight::{FileAccess, SceneDescription, load};
use glam::{DAffine3, DVec3, Vec3};
use std::path::Path;
use std::str::FromStr;

/// A mesh with its view.
pub(crate) struct Recipe {
    /// What to call it.
    pub(crate) name: String,
    /// Everything there is, as one mesh, in the coordinates of its file.
    pub(crate) mesh: Mesh,
    /// Camera and light.
    pub(crate) view: View,
}

/// A pinhole camera and a point light, in the coordinates of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// Where the camera is.
    pub(crate) eye: Vec3,
    /// What it looks at.
    pub(crate) target: Vec3,
    /// What is up in the picture.
    pub(crate) up: Vec3,
    /// Its vertical field of view, degrees.
    pub(crate) vertical_fov: f32,
    /// Where the light is.
    pub(crate) light: Vec3,
}

impl FromStr for View {
    type Err = String;

    /// Reads 13 numbers: eye, target, up, vertical field of view in degrees, light.
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f32>, _> = text.split_whitespace().map(str::parse).collect();
        let [ex, ey, ez, tx, ty, tz, ux, uy, uz, vertical_fov, lx, ly, lz] =
            numbers.map_err(|e| e.to_string())?.try_into().map_err(|n: Vec<f32>| {
                format!(
                    "{} numbers instead of 13: eye, target, up, field of view in degrees, light",
                    n.len()
                )
            })?;
        let v = Vec3::new;
        let (eye, target, up) = (v(ex, ey, ez), v(tx, ty, tz), v(ux, uy, uz));
        Ok(Self { eye, target, up, vertical_fov, light: v(lx, ly, lz) })
    }
}

impl Recipe {
    /// The recipes that need no files.
    pub(crate) fn generated() -> Vec<Self> {
        let v = Vec3::new;
        let ball = View {
            eye: v(0.6, 1.0, 3.0),
            target: v(0.0, 0.0, 0.0),
            up: Vec3::Y,
            vertical_fov: 40.0,
            light: v(2.0, 4.0, 3.0),
        };
        let hall = View {
            eye: v(-15.0, 2.4, 0.8),
            target: v(4.0, 3.0, -0.6),
            up: Vec3::Y,
            vertical_fov: 65.0,
            light: v(0.0, 7.0, 0.0),
        };
        let ball = |name: &str, triangles| Self {
            name: name.into(),
            mesh: meshes::bumpy_ball(triangles),
            view: ball,
        };
        let hall = Self { name: "hall".into(), mesh: meshes::hall(), view: hall };
        vec![ball("ball 10k", 10_000), ball("ball 100k", 100_000), ball("ball 1M", 1_000_000), hall]
    }

    /// The model in a file, seen as `view` says or else from above its side.
    ///
    /// # Errors
    /// If it cannot be read or has no triangles.
    pub(crate) fn of_file(path: &Path, view: Option<View>) -> Result<Self, String> {
        // Not turned upright: views are given in the file's own coordinates.
        let as_it_stands = model_override(path, "up", "z").map_err(|e| e.to_string())?;
        let access = FileAccess::beside(path, &[]);
        let scene = load(path, &[as_it_stands], &access, &mut Vec::new());
        let mesh = merged(&scene.map_err(|e| e.to_string())?);
        if mesh.triangles.is_empty() {
            return Err(format!("{} has no triangles", path.display()));
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let view = view.unwrap_or_else(|| View::framing(&mesh));
        Ok(Self { name, mesh, view })
    }
}

impl View {
    /// A view of a whole mesh, with the light above the camera's shoulder.
    fn framing(mesh: &Mesh) -> Self {
        let mut scene = description(mesh.clone());
        scene.film = FilmDescription { width: 1, height: 1, ..FilmDescription::default() };
        let camera = frame(&scene, DVec3::new(0.4, 0.5, 1.0), DVec3::Y);
        let vertical_fov = match camera.projection {
            Projection::Perspective { vertical_fov } => vertical_fov.to_degrees() as f32,
            _ => unreachable!("framing cameras are pinholes"),
        };
        let [lower, upper] = bounds(&scene).unwrap_or_default();
        let light = camera.position + DVec3::new(-0.5, 0.8, 0.0) * (upper - lower).length();
        let (eye, target) = (camera.position.as_vec3(), camera.target.as_vec3());
        Self { eye, target, up: Vec3::Y, vertical_fov, light: light.as_vec3() }
    }
}

/// All meshes of a scene in one, where they stand.
fn merged(scene: &SceneDescription) -> Mesh {
    let mut all = Mesh::default();
    for surface in &scene.surfaces {
        let Shape::Mesh(mesh) = surface.shape else { continue };
        let (mesh, first) = (&scene.meshes[mesh], all.positions.len() as u32);
        let placed = |p: &Vec3| surface.transform.transform_point3(p.as_dvec3()).as_vec3();
        all.positions.extend(mesh.positions.iter().map(placed));
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|corner| first + corner)));
    }
    all
}

/// A scene of one opaque mesh that is seen from both sides. It has a camera, lest building looks for one.
pub(crate) fn description(mesh: Mesh) -> SceneDescription {
    SceneDescription {
        materials: vec![Material::matte("only", Vec3::splat(0.5))],
        meshes: vec![mesh.into()],
        surfaces: vec![Surface {
            name: "mesh".into(),
            shape: Shape::Mesh(0),
            material: 0,
            transform: DAffine3::IDENTITY,
            motion: None,
        }],
        cameras: vec![CameraDescription {
            name: "unused".into(),
            position: DVec3::ZERO,
            target: DVec3::X,
            up: DVec3::Z,
            projection: Projection::Perspective { vertical_fov: 1.0 },
            shutter: CameraDescription::OPEN,
            motion: None,
        }],
        ..SceneDescription::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_13_numbers() {
        let view: View = "-1 2 3  4 5 6  0 1 0  40  7 8 9".parse().unwrap();
        assert_eq!((view.eye, view.light), (Vec3::new(-1.0, 2.0, 3.0), Vec3::new(7.0, 8.0, 9.0)));
        assert!("1 2".parse::<View>().unwrap_err().starts_with("2 numbers instead of 13"));
        assert!("1 2 x".parse::<View>().is_err());
    }

    #[test]
    fn a_framed_mesh_is_seen_and_lit_from_outside() {
        let view = View::framing(&meshes::bumpy_ball(1000));
        assert!(view.eye.length() > 1.5 && view.light.length() > 1.5);
        assert!(view.target.length() < 0.3);
    }
}
