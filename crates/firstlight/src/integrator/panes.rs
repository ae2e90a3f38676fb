//! Panes of glass between a point and a light: they stop no light, they tint it.

use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::scene::{OnlyPanes, Scene};

/// Panes in a row that are looked through.
const MOST: usize = 64;

/// What the panes in the way of each ray leave of light that comes along it; nothing else is in the way.
#[inline(always)]
pub(super) fn tint(scene: &Scene, ray: &Ray, repetition: u32) -> Rgb {
    if scene.has_panes { look_through(scene, ray, repetition) } else { Rgb::ONE }
}

#[inline(never)]
fn look_through(scene: &Scene, ray: &Ray, repetition: u32) -> Rgb {
    let (mut ray, mut tint, mut hits) = (*ray, Rgb::ONE, Vec::<Hit>::new());
    for _ in 0..MOST {
        scene.world.closest_hits(&[ray], &OnlyPanes(scene, repetition), &mut hits);
        let Some(hit) = hits.first().filter(|hit| hit.is_some()) else { return tint };
        let at = scene.interaction(&ray, hit);
        tint *= scene.straight(scene.material(hit), &at, -ray.direction);
        let t_max = ray.t_max - (at.behind() - ray.origin).length();
        ray = Ray { t_min: 0.0, t_max, ..Ray::new(at.behind(), ray.direction) };
    }
    tint
}
