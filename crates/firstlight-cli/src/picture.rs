//! The scene as the command line wants it: what a picture shows, and with what it is made.

use crate::args::PictureArgs;
use crate::input::choose_camera;
use crate::{Outcome, machine, studio};
use firstlight::diagnostic::Result;
use firstlight::io::scene_file::{Override, apply_look};
use firstlight::io::{FileAccess, Warnings};
use firstlight::scene::description::Section;
use firstlight::{Level, Look, SceneDescription};

impl PictureArgs {
    /// Reads the scene through `access` and lays over it what was asked for.
    pub(crate) fn prepare(
        &self,
        access: &FileAccess,
        warnings: &mut Warnings,
    ) -> Outcome<SceneDescription> {
        let mut scene = self.read(access, warnings)?;
        self.complete(&mut scene)?;
        Ok(scene)
    }

    /// Reads the scene as its file has it.
    pub(crate) fn read(
        &self,
        access: &FileAccess,
        warnings: &mut Warnings,
    ) -> Outcome<SceneDescription> {
        let is_model = self.input.is_model();
        if !is_model {
            self.studio.refuse()?;
        }
        let overrides =
            if is_model { self.studio.overrides(&self.input.scene)? } else { self.look()? };
        self.input.load_with(overrides, access, warnings)
    }

    /// Adds what a picture of the scene needs: film, camera, and the studio around a model.
    pub(crate) fn complete(&self, scene: &mut SceneDescription) -> Result<()> {
        self.set_film(scene);
        choose_camera(scene, self.camera.as_deref())?;
        if self.input.is_model() {
            studio::dress(scene, self)?;
            if let Some(look) = self.look {
                apply_look(look, self.section, &self.input.define, scene)?;
                self.set_film(scene);
            }
        }
        Ok(())
    }

    /// The look that is asked for, laid over that of a scene file.
    fn look(&self) -> Outcome<Vec<Override>> {
        let name = |look| Look::NAMES.iter().find(|known| known.1 == look).map(|known| known.0);
        let look = self.look.and_then(name).map(|name| format!("look={name:?}"));
        let section = self.section.map(|Section { point: p, normal: n }| {
            let (point, normal) = (p.to_array(), n.to_array());
            format!("section={{point={point:?},normal={normal:?}}}")
        });
        let parse = |(text, flag): (String, _)| Ok(text.parse::<Override>()?.called(flag));
        let given = [look.zip(Some("--look")), section.zip(Some("--section"))];
        given.into_iter().flatten().map(parse).collect()
    }

    fn set_film(&self, scene: &mut SceneDescription) {
        let film = &mut scene.film;
        [film.width, film.height] = self.resolution.unwrap_or([film.width, film.height]);
        film.samples = self.spp.unwrap_or(film.samples);
        film.seed = self.seed.unwrap_or(film.seed);
        film.exposure = self.exposure.unwrap_or(film.exposure);
        film.view = self.view.unwrap_or(film.view);
        film.transparent |= self.transparent;
        film.clamp = self.clamp.map_or(film.clamp, |clamp| clamp.on());
    }

    /// Worker threads.
    pub(crate) fn threads(&self) -> usize {
        self.threads.map_or_else(machine::processors, |threads| threads as usize)
    }

    /// Instructions to trace with.
    pub(crate) fn level(&self) -> Level {
        self.simd.0.unwrap_or_else(Level::detect)
    }
}
