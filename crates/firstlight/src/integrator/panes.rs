//! What is between a point and a light without stopping it: panes, which tint light, and media, which weaken it.

use super::media::Media;
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::scene::description::Interior;
use crate::scene::{OnlyPanes, Scene};

/// Panes in a row that are looked through.
const MOST: usize = 64;

/// What is left of light that comes along a ray that starts in `media`; nothing else is in the way.
#[inline(always)]
pub(super) fn tint(scene: &Scene, ray: &Ray, media: Media, repetition: u32) -> Rgb {
    match media.medium(scene) {
        _ if scene.has_panes => look_through(scene, ray, media, repetition),
        Some(medium) => medium.transmittance(ray.t_max),
        None => Rgb::ONE,
    }
}

#[inline(never)]
fn look_through(scene: &Scene, ray: &Ray, mut media: Media, repetition: u32) -> Rgb {
    let (mut ray, mut tint, mut hits) = (*ray, Rgb::ONE, Vec::<Hit>::new());
    for _ in 0..MOST {
        scene.world.closest_hits(&[ray], &OnlyPanes(scene, repetition), &mut hits);
        let Some(hit) = hits.first().filter(|hit| hit.is_some()) else { break };
        let (at, material) = (scene.interaction(&ray, hit), scene.material(hit));
        tint *= left(scene, media, hit.t);
        if material.interior.is_some() {
            let number = scene.material_of[hit.surface as usize];
            let crossing = media.cross(scene, number, at.front, None);
            let bent = |eta: f32| (eta - 1.0).abs() >= Interior::NOTHING;
            match crossing.boundary {
                Some(boundary) if bent(boundary.eta) => return Rgb::ZERO,
                Some(_) => tint *= scene.straight(material, &at, -ray.direction),
                None => {}
            }
            media = crossing.beyond;
        } else {
            tint *= scene.straight(material, &at, -ray.direction);
        }
        let t_max = ray.t_max - (at.behind() - ray.origin).length();
        ray = Ray { origin: at.behind(), t_min: 0.0, t_max, ..ray };
    }
    tint * left(scene, media, ray.t_max)
}

/// What is left of light after a distance, m.
fn left(scene: &Scene, media: Media, distance: f32) -> Rgb {
    media.medium(scene).map_or(Rgb::ONE, |medium| medium.transmittance(distance))
}
