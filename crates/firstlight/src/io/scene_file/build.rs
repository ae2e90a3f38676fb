//! From what is written to a scene with indices.

use super::color::Two;
use super::document::{At, Document, Named, Span, in_order};
use super::environment::{EnvironmentKeys, Surroundings};
use super::light::{Lighting, SurfaceLightKeys};
use super::luminaire::Luminaires;
use super::material::MaterialKeys;
use super::motion::MotionKeys;
use super::pictures::Pictures;
use super::surface::{NewShape, SurfaceKeys};
use super::{InstanceKeys, ModelKeys, SceneKeys, look, medium, transform};
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Result};
use crate::io::gltf::LightUnits;
use crate::io::model::{self, Format, UpAxis, upright};
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{
    Integrator, Light, LightDescription, LuminousEfficacy, Material, Part, SceneDescription,
    Shadows, Shape, Surface, Texture, Up,
};
use crate::scene::middle;
use crate::suggest::{did_you_mean, quoted};
use glam::{DAffine3, DVec3};
use indexmap::IndexMap;
use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Surfaces in a scene, at most: instances of models multiply, and a short file must not fill the memory.
const MOST_SURFACES: usize = 1 << 22;

/// A scene as it grows.
pub(super) struct Builder<'a> {
    document: &'a Document<'a>,
    access: &'a FileAccess,
    scene: SceneDescription,
    up: UpAxis,
    materials: HashMap<String, usize>,
    /// The grey of surfaces without a material, once one is needed.
    default_material: Option<usize>,
    /// Model files that were read, by how they were.
    models: HashMap<ModelKey, (Part, Format)>,
    /// Which surfaces each surface or model became, for instances.
    placed: IndexMap<String, Range<usize>>,
}

/// A model file, its variant, the units of its lights, and the bits of its unit of length, m.
type ModelKey = (PathBuf, Option<String>, Option<LightUnits>, u64);

/// Builds the scene that is written in `keys`.
pub(super) fn build(
    keys: SceneKeys,
    document: &Document<'_>,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let efficacy = keys.luminous_efficacy.0;
    let mut scene = SceneDescription {
        up: Up(keys.up.direction()),
        film: keys.film.describe(),
        integrator: keys.integrator.0,
        shadows: keys.shadows,
        background: keys.background.0,
        medium: keys.medium.map(|keys| keys.describe(document)).transpose()?,
        luminous_efficacy: LuminousEfficacy(efficacy),
        ..SceneDescription::default()
    };
    for (name, camera) in keys
        .camera
        .map(|camera| ("camera".to_owned(), camera))
        .into_iter()
        .chain(in_order(keys.cameras))
    {
        scene.cameras.push(camera.describe(&name, keys.up, document)?);
    }
    let mut builder = Builder {
        document,
        access,
        scene,
        up: keys.up,
        materials: HashMap::new(),
        default_material: None,
        models: HashMap::new(),
        placed: IndexMap::new(),
    };
    let mut luminaires = Luminaires { document, access, by_file: HashMap::new() };
    for (name, light) in in_order(keys.lights) {
        let light = builder.lighting().describe(&name, light.value, &mut luminaires)?;
        builder.scene.lights.push(light);
    }
    builder.add_materials(keys.materials, keys.environment, warnings)?;
    for (name, surface) in in_order(keys.surfaces) {
        builder.add_surface(name, surface)?;
    }
    for (name, model) in in_order(keys.models) {
        builder.add_model(name, model, warnings)?;
    }
    for (name, instance) in in_order(keys.instances) {
        builder.add_instance(&name, instance)?;
    }
    look::apply(keys.look, keys.section, document, &mut builder.scene)?;
    warnings.extend(builder.scene.leave_out_far_triangles(document.name));
    warnings.extend(unheeded_shadows(&builder.scene, document.name));
    warnings.extend(medium::doubts(&builder.scene, document.name));
    warnings.extend(left_behind(&builder.scene, document.name));
    Ok(builder.scene)
}

/// A word about a setting that only the lecture's sum heeds.
fn unheeded_shadows(scene: &SceneDescription, name: &str) -> Option<Diagnostic> {
    let heeded = scene.integrator == Integrator::Direct && scene.is_lecture();
    (scene.shadows != Shadows::Robust && !heeded).then(|| {
        let message = "shadows has no effect here: shadows are robust";
        let help = "it is for the integrator \"direct\", up to 1024 points and parallel light";
        Diagnostic::new(name, message).help(help)
    })
}

/// A word about lights at a camera that moves.
fn left_behind(scene: &SceneDescription, name: &str) -> Option<Diagnostic> {
    let at_camera = |light: &LightDescription| matches!(light.light, Light::Camera { .. });
    let light = scene.lights.iter().find(|light| at_camera(light))?;
    scene.cameras.first()?.motion.as_ref()?;
    let message = "stays where the camera is at time 0; cameras move, lights do not";
    let warning = Diagnostic::new(name, message).at_part(format!("light {}", quoted(&light.name)));
    Some(warning.help("let the things move instead, or use lights that stand somewhere"))
}

impl Builder<'_> {
    fn lighting(&self) -> Lighting<'_> {
        let efficacy = self.scene.luminous_efficacy.0;
        Lighting { document: self.document, efficacy, up: self.up }
    }

    /// Materials and environment, which may share pictures.
    fn add_materials(
        &mut self,
        materials: Named<MaterialKeys>,
        environment: Option<At<EnvironmentKeys>>,
        warnings: &mut Warnings,
    ) -> Result<()> {
        let (document, access) = (self.document, self.access);
        let mut pictures =
            Pictures { document, access, images: Vec::new(), by_file: HashMap::new() };
        // Mixes wait for what they mix.
        let mut waiting: Vec<_> = in_order(materials).collect();
        for _ in 0..=SceneDescription::MOST_MIXING {
            for (name, material) in std::mem::take(&mut waiting) {
                let known = |part: &String| self.materials.contains_key(part);
                let parts = material.value.parts();
                if parts.is_none_or(|parts| parts.value.0.iter().all(known)) {
                    self.describe_material(name, material, &mut pictures, warnings)?;
                } else {
                    waiting.push((name, material));
                }
            }
        }
        if let Some(error) = self.unmixed(&waiting) {
            return Err(error);
        }
        if let Some(At { value, .. }) = environment {
            let (lighting, up) = (&self.lighting(), self.up);
            let pictures = &mut pictures;
            let new = value.describe(&mut Surroundings { lighting, pictures, up, warnings })?;
            self.scene.environment = Some(new.sky);
            self.scene.lights.extend(new.sun);
        }
        self.scene.images = pictures.images;
        Ok(())
    }

    fn describe_material(
        &mut self,
        name: String,
        At { span, value: keys }: At<MaterialKeys>,
        pictures: &mut Pictures<'_>,
        warnings: &mut Warnings,
    ) -> Result<()> {
        let parts = keys.parts().map(|parts| self.mixed(parts)).transpose()?;
        let inside = |place: &usize| self.scene.materials[*place].interior;
        let interior = parts.iter().flatten().find_map(inside);
        let material = keys.describe(&name, (parts.unwrap_or_default(), interior), pictures)?;
        if self.scene.integrator == Integrator::Direct && material.shows_its_surroundings() {
            let message = "shows little of its surroundings by the integrator \"direct\", which asks lights alone";
            let warning = self.document.error(&span, message);
            warnings.push(warning.help("write integrator = \"path\""));
        }
        self.scene.materials.push(material);
        self.materials.insert(name, self.scene.materials.len() - 1);
        Ok(())
    }

    /// The places of the materials that a mix names, which scatter light.
    fn mixed(&self, parts: &At<Two<String>>) -> Result<[usize; 2]> {
        let places = parts.value.0.each_ref().map(|part| self.materials[part]);
        let unlit = places.iter().find(|place| self.scene.materials[**place].unlit);
        unlit.map_or(Ok(places), |place| {
            let name = quoted(&self.scene.materials[*place].name);
            let message = format!("mixes {name}, which is unlit: a mix scatters light as its parts do");
            let help = "give the mix an emission instead, or show both in the picture of one unlit material";
            Err(self.document.error(&parts.span, message).help(help).into())
        })
    }

    /// The complaint about the first of the mixes that cannot be made.
    fn unmixed(&self, waiting: &[(String, At<MaterialKeys>)]) -> Option<Box<Diagnostic>> {
        let mix = waiting.first()?.1.value.parts()?;
        let waits = |name: &String| waiting.iter().any(|(waiting, _)| waiting == name);
        let unknown =
            mix.value.0.iter().find(|&part| !self.materials.contains_key(part) && !waits(part));
        let message = match unknown {
            Some(name) => {
                let hint = did_you_mean(name, self.materials.keys().map(String::as_str));
                format!("names the unknown material {}{hint}", quoted(name))
            }
            None => "mixes itself, or mixes of more than 4 levels".to_owned(),
        };
        Some(self.document.error(&mix.span, message))
    }

    fn add_surface(
        &mut self,
        name: String,
        At { span, value: keys }: At<SurfaceKeys>,
    ) -> Result<()> {
        let shape = match keys.shape(&name, &span, self.document)? {
            NewShape::Ready(shape) => shape,
            NewShape::Mesh(mesh) => {
                self.scene.meshes.push(Arc::new(mesh));
                Shape::Mesh(self.scene.meshes.len() - 1)
            }
        };
        let mut material = match (self.material(keys.material.as_ref())?, &keys.light) {
            (Some(material), _) => material,
            (None, None) => self.default_material(),
            (None, Some(_)) => self.add_material(Material::matte(&name, Rgb::ZERO)),
        };
        if matches!(shape, Shape::Mesh(mesh) if !self.scene.meshes[mesh].colors.is_empty()) {
            material = self.with_vertex_colors(material);
        }
        let transform = transform::compose(keys.transform.as_ref(), self.document)?;
        let start = self.scene.surfaces.len();
        let mut surface = Surface { name: name.clone(), shape, material, transform, motion: None };
        if let Some(light) = &keys.light {
            surface.material = self.lit_material(&surface, light)?;
        }
        self.scene.surfaces.push(surface);
        self.placed.insert(name, start..start + 1);
        self.set_in_motion(start, keys.motion.as_ref())
    }

    fn add_model(
        &mut self,
        name: String,
        At { span, value: keys }: At<ModelKeys>,
        warnings: &mut Warnings,
    ) -> Result<()> {
        if self.placed.contains_key(&name) {
            return Err(self.document.error(&span, "has the name of a surface; choose another"));
        }
        let file = self.load(&keys, warnings)?;
        let Some((part, format)) = self.models.get(&file) else { return Ok(()) };
        self.check_visible(part, &keys.file.span, warnings)?;
        let own = transform::compose(keys.transform.as_ref(), self.document)?;
        let stand = upright(keys.up.unwrap_or(format.up()), self.up);
        let transform = own * stand * DAffine3::from_scale(DVec3::splat(keys.metres()));
        let start = self.scene.surfaces.len();
        let material = self.material(keys.material.as_ref())?;
        self.check_room(part.surfaces.len(), &span)?;
        self.scene.place(part, &name, transform, material);
        if let Some(motion) = keys.motion.as_ref().filter(|_| !part.lights.is_empty()) {
            let warning = self.document.error(&motion.span, "does not move the model's lights");
            warnings.push(warning.help("only what has a surface moves"));
        }
        self.placed.insert(name, start..self.scene.surfaces.len());
        self.set_in_motion(start, keys.motion.as_ref())
    }

    /// Reads a variant of a model file unless it was read before; returns the key to `models`.
    fn load(&mut self, keys: &ModelKeys, warnings: &mut Warnings) -> Result<ModelKey> {
        let At { span, value: name } = &keys.file;
        let variant = keys.variant.as_ref();
        let path = self.document.open(span, self.access.resolve(name))?;
        let real = path.canonicalize().unwrap_or_else(|_| path.clone());
        let variant = variant.map(|variant| variant.value.clone());
        let key = (real, variant, keys.gltf_lights, keys.metres().to_bits());
        if !self.models.contains_key(&key) {
            let access = self.access.within(&path);
            let options = model::Options {
                variant: key.1.as_deref(),
                lights: key.2,
                luminous_efficacy: self.scene.luminous_efficacy,
            };
            let read = model::read_with_format(&path, options, &access, warnings);
            let (mut model, format) = self.placed_where_named(span, read)?;
            for material in &mut model.materials {
                material.interior = material.interior.map(|i| i.in_unit(keys.metres() as f32));
            }
            let part = self.scene.adopt(model);
            self.models.insert(key.clone(), (part, format));
        }
        Ok(key)
    }

    /// What was read, or the complaint about it: where the file is named, if it is about the whole file.
    fn placed_where_named<T>(&self, span: &Span, read: Result<T>) -> Result<T> {
        match read {
            Err(error) if error.place.is_whole_file() => self.document.open(span, Err(error)),
            other => other,
        }
    }

    /// Says that nothing of a model will be seen; if it was to be the whole scene, that is an error.
    fn check_visible(&self, part: &Part, span: &Span, warnings: &mut Warnings) -> Result<()> {
        let seen = |surface: &Surface| self.scene.triangles_of(&surface.shape) > 0;
        if part.surfaces.iter().any(seen) {
            return Ok(());
        }
        // What was left out of it on reading says more.
        let help = match warnings.last() {
            Some(note) if self.document.generated => note.to_string(),
            _ => "its nodes show no mesh with triangles".into(),
        };
        if self.document.generated {
            let error = Diagnostic::new(self.document.name, "no triangles in this file");
            return Err(Box::new(error.help(help)));
        }
        warnings.push(self.document.error(span, "names a model without triangles").help(help));
        Ok(())
    }

    /// Repeats the surfaces of a surface or model, moved after their own transform.
    fn add_instance(
        &mut self,
        name: &str,
        At { span, value: keys }: At<InstanceKeys>,
    ) -> Result<()> {
        let of = &keys.of.value;
        let Some(range) = self.placed.get(of).cloned() else {
            let hint = did_you_mean(of, self.placed.keys().map(String::as_str));
            let message = format!("needs the name of a surface or model, not {}{hint}", quoted(of));
            return Err(self.document.error(&keys.of.span, message));
        };
        let material = self.material(keys.material.as_ref())?;
        let transform = transform::compose(keys.transform.as_ref(), self.document)?;
        self.check_room(range.len(), &span)?;
        let start = self.scene.surfaces.len();
        for i in range {
            let Some(original) = self.scene.surfaces.get(i) else { continue };
            let own_name = original.name.strip_prefix(of.as_str()).unwrap_or_default();
            let copy = Surface {
                name: format!("{name}{own_name}"),
                shape: original.shape.clone(),
                material: material.unwrap_or(original.material),
                transform: transform * original.transform,
                motion: None,
            };
            self.scene.surfaces.push(copy);
        }
        self.set_in_motion(start, keys.motion.as_ref())
    }

    /// Lets the surfaces from number `start` on move together.
    fn set_in_motion(&mut self, start: usize, motion: Option<&At<MotionKeys>>) -> Result<()> {
        let Some(motion) = motion else { return Ok(()) };
        let surfaces = start..self.scene.surfaces.len();
        let motion = motion.describe(middle(&self.scene, surfaces.clone()), self.document)?;
        self.scene.surfaces[surfaces].iter_mut().for_each(|surface| surface.motion = motion);
        Ok(())
    }

    fn check_room(&self, more: usize, span: &Span) -> Result<()> {
        if self.scene.surfaces.len().saturating_add(more) <= MOST_SURFACES {
            return Ok(());
        }
        Err(self.document.error(
            span,
            format!("makes more than {MOST_SURFACES} surfaces, the most there can be"),
        ))
    }

    /// The index of a material by its name.
    fn material(&self, name: Option<&At<String>>) -> Result<Option<usize>> {
        let Some(At { span, value: name }) = name else { return Ok(None) };
        if let Some(&index) = self.materials.get(name) {
            return Ok(Some(index));
        }
        let hint = did_you_mean(name, self.materials.keys().map(String::as_str));
        Err(self
            .document
            .error(span, format!("needs the name of a material, not {}{hint}", quoted(name))))
    }

    /// A copy of a surface's material that emits.
    fn lit_material(
        &mut self,
        surface: &Surface,
        At { span, value: keys }: &At<SurfaceLightKeys>,
    ) -> Result<usize> {
        let area = self.scene.emitting_area(surface);
        let radiance = self.lighting().surface(keys, span, area)?;
        let mut material = self.scene.materials[surface.material].clone();
        material.emission = Texture::constant(radiance);
        material.written = keys.written(self.document);
        material.emits_behind = keys.two_sided.unwrap_or(false);
        material.visible = keys.visible.unwrap_or(true);
        Ok(self.add_material(material))
    }

    fn add_material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    /// A copy of a material that the mesh's vertex colours multiply.
    fn with_vertex_colors(&mut self, material: usize) -> usize {
        let mut copy = self.scene.materials[material].clone();
        copy.reflectance.vertex_colors = true;
        self.add_material(copy)
    }

    fn default_material(&mut self) -> usize {
        *self.default_material.get_or_insert_with(|| {
            self.scene.materials.push(Material::matte("default", Rgb::splat(0.5)));
            self.scene.materials.len() - 1
        })
    }
}
