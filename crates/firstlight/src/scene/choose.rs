//! One camera of many.

use super::description::SceneDescription;
use crate::diagnostic::{Diagnostic, Result};
use crate::suggest::{did_you_mean, quoted};

impl SceneDescription {
    /// Makes the camera `name` the first, the one in use. A model's camera `chair/front` also answers to `front` if
    /// it is the only one.
    ///
    /// # Errors
    /// If no camera has this name, or several end in it; lists those there are.
    pub fn choose_camera(&mut self, name: &str) -> Result<()> {
        let index = self.find_camera(name).ok_or_else(|| self.no_camera(name))?;
        self.cameras[..=index].rotate_right(1);
        Ok(())
    }

    fn find_camera(&self, name: &str) -> Option<usize> {
        let exact = self.cameras.iter().position(|camera| camera.name == name);
        let mut alike =
            (0..self.cameras.len()).filter(|&i| own_name(&self.cameras[i].name) == Some(name));
        exact.or_else(|| alike.next().filter(|_| alike.next().is_none()))
    }

    fn no_camera(&self, name: &str) -> Box<Diagnostic> {
        const MOST_LISTED: usize = 20;
        let names = || self.cameras.iter().map(|camera| camera.name.as_str());
        let hint = did_you_mean(name, names().chain(names().filter_map(own_name)));
        let error = Diagnostic::new("", format!("there is no camera {}{hint}", quoted(name)));
        if self.cameras.is_empty() {
            return Box::new(error.help("the scene has no cameras of its own"));
        }
        let listed: Vec<_> = names().take(MOST_LISTED).map(quoted).collect();
        let more = if self.cameras.len() > MOST_LISTED { ", …" } else { "" };
        Box::new(error.help(format!("its cameras are {}{more}", listed.join(", "))))
    }
}

/// A camera's name inside its model.
fn own_name(full: &str) -> Option<&str> {
    full.rsplit_once('/').map(|(_, own)| own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{CameraDescription, Projection};
    use glam::DVec3;

    fn scene(names: &[&str]) -> SceneDescription {
        let camera = |name: &&str| CameraDescription {
            name: (*name).into(),
            position: DVec3::ZERO,
            target: DVec3::Y,
            up: DVec3::Z,
            projection: Projection::Perspective { vertical_fov: 1.0 },
            shutter: CameraDescription::OPEN,
            motion: None,
        };
        SceneDescription {
            cameras: names.iter().map(camera).collect(),
            ..SceneDescription::default()
        }
    }

    fn chosen(names: &[&str], name: &str) -> Option<String> {
        let mut scene = scene(names);
        scene.choose_camera(name).ok()?;
        assert_eq!(scene.cameras.len(), names.len());
        Some(scene.cameras[0].name.clone())
    }

    #[test]
    fn the_chosen_camera_comes_first() {
        let mut scene = scene(&["a", "b", "c"]);
        scene.choose_camera("c").unwrap();
        assert_eq!(
            scene.cameras.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
            ["c", "a", "b"]
        );
    }

    #[test]
    fn a_models_camera_answers_to_its_own_name() {
        assert_eq!(chosen(&["x", "m/front"], "front").as_deref(), Some("m/front"));
        assert_eq!(chosen(&["m/front", "front"], "front").as_deref(), Some("front"));
        assert_eq!(chosen(&["m/front", "n/front"], "front"), None);
    }

    #[test]
    fn an_unknown_name_is_answered_with_those_there_are() {
        let error = scene(&["camera", "top"]).choose_camera("tpo").unwrap_err().to_string();
        assert!(error.contains("did you mean \"top\"?"), "{error}");
        assert!(error.contains("its cameras are \"camera\", \"top\""), "{error}");
        let error = scene(&["m/front"]).choose_camera("fornt").unwrap_err().to_string();
        assert!(error.contains("did you mean \"front\"?"), "{error}");
        assert!(scene(&[]).choose_camera("x").unwrap_err().to_string().contains("no cameras"));
    }
}
