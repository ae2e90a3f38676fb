//! The studio around a model, as the command line asks for it.

use crate::args::{Axis, PictureArgs, StudioArgs};
use firstlight::color::Rgb;
use firstlight::diagnostic::{Diagnostic, Result};
use firstlight::io::model_override;
use firstlight::io::scene_file::Override;
use firstlight::scene::Studio;
use firstlight::scene::description::Exposure;
use firstlight::units::Quantity;
use firstlight::{Look, SceneDescription};
use std::path::Path;

impl StudioArgs {
    /// Refuses what a scene file says itself.
    pub(crate) fn refuse(&self) -> Result<()> {
        let given = [
            (
                "--azimuth",
                self.azimuth.is_some(),
                "place the camera: [camera.perspective] position = …",
            ),
            (
                "--elevation",
                self.elevation.is_some(),
                "place the camera: [camera.perspective] position = …",
            ),
            ("--key", self.key.is_some(), "add a light: [lights.key.directional] irradiance = …"),
            (
                "--headlight",
                self.headlight.is_some(),
                "add a light: [lights.head.camera] irradiance = …",
            ),
            ("--ground", self.ground.is_some(), "add a surface: [surfaces.ground.plane]"),
            (
                "--background",
                self.background.is_some(),
                "set background = … in it, or -D background=…",
            ),
            ("--up", self.up.is_some(), "set up in its [models.NAME], or -D models.NAME.up=y"),
            (
                "--unit",
                self.unit.is_some(),
                "set unit in its [models.NAME], or -D models.NAME.unit=mm",
            ),
            (
                "--variant",
                self.variant.is_some(),
                "set variant in its [models.NAME], or -D models.NAME.variant=…",
            ),
            (
                "--gltf-lights",
                self.gltf_lights.is_some(),
                "set gltf_lights in its [models.NAME], or -D models.NAME.gltf_lights=…",
            ),
        ];
        let Some((flag, _, help)) = given.into_iter().find(|(_, given, _)| *given) else {
            return Ok(());
        };
        let message = "this is for model files; a scene file says it itself";
        Err(Box::new(Diagnostic::new(flag, message).help(help)))
    }

    /// What `--up`, `--unit`, `--variant` and `--gltf-lights` set in the scene around the model at `path`.
    pub(crate) fn overrides(&self, path: &Path) -> Result<Vec<Override>> {
        let up = self.up.map(|axis| if axis == Axis::Y { "y" } else { "z" });
        let unit = ("unit", self.unit.as_deref());
        let lights = self.gltf_lights.map(|units| units.name());
        let values =
            [("up", up), unit, ("variant", self.variant.as_deref()), ("gltf_lights", lights)];
        let given = values.into_iter().filter_map(|(key, value)| Some((key, value?)));
        given.map(|(key, value)| model_override(path, key, value)).collect()
    }

    /// Whether a direction was asked for that the model's own cameras do not have.
    fn has_view(&self) -> bool {
        self.azimuth.is_some() || self.elevation.is_some()
    }

    /// The studio; of the parts that nobody asked for, `own_lights` leaves only the camera.
    fn studio(&self, own_lights: bool, bare: bool, efficacy: f64) -> Studio {
        let usual = Studio::default();
        let light = |asked: Option<crate::args::Switch<Quantity>>, usual| match asked {
            Some(switch) => switch.on().map(|amount| amount.to_radiometric(efficacy).value),
            None if own_lights => None,
            None => usual,
        };
        let ground = match self.ground {
            Some(switch) => switch.on().map(rgb),
            None if own_lights || bare => None,
            None => usual.ground,
        };
        Studio {
            azimuth: self.azimuth.unwrap_or(usual.azimuth),
            elevation: self.elevation.unwrap_or(usual.elevation),
            key: light(self.key, usual.key),
            headlight: light(self.headlight, usual.headlight),
            surroundings: self.key.is_none() && self.headlight.is_none(),
            ground,
            background: self.background.map(rgb),
            ..usual
        }
    }
}

fn rgb([r, g, b, _]: [f32; 4]) -> Rgb {
    Rgb::new(r, g, b)
}

/// Puts the studio around a model. Its own camera is kept unless a direction is asked for; its own lights are used
/// alone, unless others are asked for, and with an exposure that suits them. What `-D` sets stays as it is set.
pub(crate) fn dress(scene: &mut SceneDescription, args: &PictureArgs) -> Result<()> {
    if args.studio.has_view() {
        if args.camera.as_deref().is_some_and(|name| name != "frame") {
            let error = Diagnostic::new("--camera", "a named camera has a direction of its own");
            return Err(Box::new(error.help("leave out --azimuth and --elevation")));
        }
        scene.cameras.clear();
    }
    let own_lights = !scene.lights.is_empty() || scene.environment.is_some();
    // Without a ground there is nothing around the model: for a transparent picture, or a drawing on paper.
    let bare = scene.film.transparent || args.look == Some(Look::Clarity);
    let mut studio = args.studio.studio(own_lights, bare, scene.luminous_efficacy.0);
    if args.input.sets(&["background"]) {
        studio.background = studio.background.or(Some(scene.background));
    } else if args.look == Some(Look::Clarity) {
        // Paper.
        studio.background = studio.background.or(Some(Rgb::ONE));
    }
    if own_lights {
        scene.lights.extend(studio.lights());
        if args.exposure.is_none() && !args.input.sets(&["film", "exposure"]) {
            scene.film.exposure = Exposure::Auto;
        }
    }
    let integrator = scene.integrator;
    studio.dress(scene);
    if args.input.sets(&["integrator"]) {
        scene.integrator = integrator;
    }
    Ok(())
}
