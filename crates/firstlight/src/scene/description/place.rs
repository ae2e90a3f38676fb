//! Scenes inside scenes: a model's parts taken over and placed.

use super::{
    CameraDescription, CameraPose, Light, LightDescription, Material, Pattern, Projection,
    SceneDescription, Shape, Surface,
};
use glam::DAffine3;

/// What can be placed of a model whose pictures, materials and meshes a scene has taken over.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Surfaces, with indices into the scene.
    pub surfaces: Vec<Surface>,
    /// Lights in the model's space.
    pub lights: Vec<LightDescription>,
    /// Cameras in the model's space.
    pub cameras: Vec<CameraDescription>,
}

impl SceneDescription {
    /// Takes over a model's pictures, materials and meshes; what it returns can be placed any number of times.
    ///
    /// Its film, background and shadow settings are dropped. Its lights, converted from photometric units with its
    /// own luminous efficacy, are converted again with this scene's.
    pub fn adopt(&mut self, model: SceneDescription) -> Part {
        let (images, materials, meshes) =
            (self.images.len(), self.materials.len(), self.meshes.len());
        let mut part =
            Part { surfaces: model.surfaces, lights: model.lights, cameras: model.cameras };
        for surface in &mut part.surfaces {
            surface.material += materials;
            if let Shape::Mesh(mesh) = &mut surface.shape {
                *mesh += meshes;
            }
        }
        let dimmer = model.luminous_efficacy.0 / self.luminous_efficacy.0;
        part.lights.iter_mut().for_each(|light| scale_light(&mut light.light, dimmer as f32));
        self.images.extend(model.images);
        self.meshes.extend(model.meshes);
        self.materials.extend(model.materials.into_iter().map(|m| with_images_after(m, images)));
        part
    }

    /// Adds a part's surfaces, lights and cameras, moved by `transform`; their names become `name/theirs`.
    ///
    /// `material`, if any, replaces the surfaces' own. Quantities of light stay what they are. In the model, everything stands
    /// still.
    pub fn place(&mut self, part: &Part, name: &str, transform: DAffine3, material: Option<usize>) {
        let full_name = |own: &str| format!("{name}/{own}");
        self.surfaces.extend(part.surfaces.iter().map(|surface| Surface {
            name: full_name(&surface.name),
            shape: surface.shape.clone(),
            material: material.unwrap_or(surface.material),
            transform: transform * surface.transform,
            motion: None,
        }));
        self.lights.extend(part.lights.iter().map(|light| LightDescription {
            name: full_name(&light.name),
            light: moved_light(&light.light, transform),
            shadows: light.shadows,
            radius: light.radius * growth(transform),
            written: light.written.clone(),
        }));
        self.cameras.extend(part.cameras.iter().map(|camera| CameraDescription {
            name: full_name(&camera.name),
            ..moved_camera(camera, transform)
        }));
    }
}

/// The material with the indices of its pictures moved behind `count` others.
fn with_images_after(mut material: Material, count: usize) -> Material {
    for texture in material.textures_mut() {
        if let Pattern::Image { image, .. } = &mut texture.pattern {
            *image += count;
        }
    }
    material
}

fn scale_light(light: &mut Light, factor: f32) {
    use super::CameraLightAmount::{Intensity, Irradiance};
    let quantity = match light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity,
        Light::Photometric { factor, .. } => factor,
        Light::Directional { irradiance, .. } | Light::Sun { irradiance, .. } => irradiance,
        Light::Ambient { radiance, .. } => radiance,
        Light::Camera { amount: Intensity(quantity) | Irradiance(quantity) } => quantity,
    };
    *quantity *= factor;
}

fn moved_light(light: &Light, by: DAffine3) -> Light {
    let mut moved = light.clone();
    match &mut moved {
        Light::Point { position, .. } => *position = by.transform_point3(*position),
        Light::Spot { position, direction, .. } => {
            *position = by.transform_point3(*position);
            *direction = by.transform_vector3(*direction).normalize_or(*direction);
        }
        Light::Photometric { position, rotation, .. } => {
            *position = by.transform_point3(*position);
            *rotation = by.to_scale_rotation_translation().1 * *rotation;
        }
        Light::Directional { direction, .. } | Light::Sun { direction, .. } => {
            *direction = by.transform_vector3(*direction).normalize_or(*direction);
        }
        Light::Ambient { .. } | Light::Camera { .. } => {}
    }
    moved
}

/// How lengths grow on average: by the cube root of the volume.
fn growth(by: DAffine3) -> f64 {
    by.matrix3.determinant().abs().cbrt()
}

/// The camera moved; its lengths grow on average.
fn moved_camera(camera: &CameraDescription, by: DAffine3) -> CameraDescription {
    let growth = growth(by);
    let mut projection = camera.projection;
    match &mut projection {
        Projection::Perspective { .. } => {}
        Projection::Orthographic { height } => *height *= growth,
        Projection::ThinLens { aperture, focus_distance, .. } => {
            *aperture *= growth;
            *focus_distance *= growth;
        }
    }
    CameraDescription {
        name: camera.name.clone(),
        position: by.transform_point3(camera.position),
        target: by.transform_point3(camera.target),
        up: by.transform_vector3(camera.up).normalize_or(camera.up),
        projection,
        shutter: camera.shutter,
        motion: camera.motion.map(|pose| CameraPose {
            position: by.transform_point3(pose.position),
            target: by.transform_point3(pose.target),
            up: by.transform_vector3(pose.up).normalize_or(pose.up),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LuminousEfficacy, Pixels, Sampling, Texels, UvTransform, Wrap};
    use super::*;
    use crate::color::Rgb;
    use glam::DVec3;
    use std::sync::Arc;

    fn textured_model() -> SceneDescription {
        let mut material = Material::matte("wood", Rgb::ONE);
        material.reflectance.pattern = Pattern::Image {
            image: 0,
            uv_set: 0,
            transform: UvTransform::IDENTITY,
            wrap: [Wrap::Repeat; 2],
            sampling: Sampling::Bilinear,
        };
        let texels = Texels::Srgb8(vec![[0; 4]]);
        let picture = Pixels { name: "wood.png".into(), width: 1, height: 1, texels };
        let position = DVec3::new(0.0, 1.0, 0.0);
        let light = Light::Point { position, intensity: Rgb::splat(2.0) };
        SceneDescription {
            images: vec![Arc::new(picture)],
            materials: vec![material],
            meshes: vec![Arc::default()],
            surfaces: vec![Surface {
                name: "leg".into(),
                shape: Shape::Mesh(0),
                material: 0,
                transform: DAffine3::from_translation(DVec3::X),
                motion: None,
            }],
            lights: vec![LightDescription::new("bulb", light)],
            ..SceneDescription::default()
        }
    }

    #[test]
    fn indices_names_and_transforms_follow_into_the_scene() {
        let mut scene = textured_model();
        let part = scene.adopt(textured_model());
        scene.place(&part, "chair", DAffine3::from_scale(DVec3::splat(2.0)), None);
        let [_, leg] = scene.surfaces.as_slice() else { panic!("two surfaces") };
        assert_eq!(
            (leg.name.as_str(), leg.material, &leg.shape),
            ("chair/leg", 1, &Shape::Mesh(1))
        );
        assert_eq!(leg.transform.transform_point3(DVec3::ZERO), DVec3::new(2.0, 0.0, 0.0));
        let Pattern::Image { image, .. } = scene.materials[1].reflectance.pattern else {
            panic!("a picture")
        };
        assert_eq!(image, 1);
        let Light::Point { position, .. } = scene.lights[1].light else { panic!("a point") };
        assert_eq!(position, DVec3::new(0.0, 2.0, 0.0));
    }

    #[test]
    fn lights_keep_their_lumens_under_another_efficacy() {
        let efficacy = LuminousEfficacy(683.0 / 2.0);
        let mut scene =
            SceneDescription { luminous_efficacy: efficacy, ..SceneDescription::default() };
        let part = scene.adopt(textured_model());
        let Light::Point { intensity, .. } = part.lights[0].light else { panic!("a point") };
        assert_eq!(intensity, Rgb::splat(4.0));
    }
}
