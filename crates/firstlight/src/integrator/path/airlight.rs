//! Airlight: light that a medium scatters towards where a ray came from, anywhere on its way.
//!
//! Where paths are scattered is decided by what is left of light, and next to a lamp, where most of its light is, that hardly ever
//! happens. So lights that are somewhere are not asked there, but at places along the ray that are picked for each light: one
//! evenly over the angle that it sees, one as light is lost (`shading/airway.rs`). One of the two, picked in proportion to
//! what it may bring, stands for both (Talbot, Cline, Egbert, *Importance Resampling for Global Illumination*, 2005). Surfaces
//! that emit share with paths that meet them by chance as they do at a surface.

use super::lights::{Answer, PAIR_STEP};
use super::vertices::{Scattering, Vertex};
use super::walk::Walk;
use super::{Path, Scratch};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::integrator::dimensions::Bounce;
use crate::integrator::record::{Asked, Recorder};
use crate::sampler::PathPoints;
use crate::scene::description::Medium;
use crate::scene::{LocalLight, Scene};
use crate::shading::airway::{Attenuated, Equiangular};
use crate::shading::light::tree::Reach;
use crate::shading::volume::HenyeyGreenstein;
use glam::{Vec2, Vec3};

/// What is left at least, in the choice of places, of a light on its way to one: where fog ends before the light, more is left
/// than fog would leave.
const LEFT: f32 = 1.0 / 64.0;
/// Free paths after which next to nothing is seen, in the choice of lights.
const FAR: f32 = 3.0;

/// A ray through a medium, on whose way lights are asked.
pub(super) struct Airway {
    /// The number of the ray and its walk.
    pub(super) walk: u32,
    /// How long it is, m; may be infinite.
    pub(super) length: f32,
    /// What light at its start is multiplied by on its way to the eye.
    pub(super) throughput: Rgb,
    /// What it goes through, which scatters.
    pub(super) medium: Medium,
}

/// A light that is asked.
#[derive(Clone, Copy)]
struct Lamp {
    light: LocalLight,
    reach: Reach,
    /// The chance of being asked.
    chance: f32,
}

/// Where a light is asked.
struct Place {
    /// How far along the ray, m.
    distance: f64,
    /// What it may bring, in no unit.
    glow: f64,
    /// The length that it stands for, m.
    length: f64,
}

impl Airway {
    /// The part of its ray on which most of what is seen is.
    fn seen(&self, ray: &Ray) -> Ray {
        let far = FAR / self.medium.extinction().max_element();
        Ray { t_max: self.length.min(far), ..*ray }
    }

    /// Where a lamp is asked, picked by two numbers in 0..1; `None` if nothing comes from anywhere.
    fn place(&self, scene: &Scene, ray: &Ray, lamp: &Lamp, u: Vec2) -> Option<Place> {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let span = lamp.reach.span(origin, direction, f64::from(self.length))?;
        let (nearest, distance) = lamp.reach.nearest(origin, direction);
        let near = Equiangular::new(&span, nearest, distance);
        let weights = self.throughput * self.medium.scattering;
        let far = Attenuated::new(&span, self.medium.extinction(), weights);
        let places = [near.sample(u.x.into()), far.sample(u.x.into())].map(|t| {
            let distance = t.clamp(span.start, span.end.min(f64::MAX));
            let left = far.left(distance);
            let glow = f64::from(left.element_sum()) * self.glow(scene, ray, lamp, distance);
            Place { distance, glow, length: (near.pdf(distance) + far.pdf(left)).recip() }
        });
        pick_one(places, u.y.into())
    }

    /// About how much of a lamp's light is scattered towards the start of a ray so far along it; 0 only where none is.
    fn glow(&self, scene: &Scene, ray: &Ray, lamp: &Lamp, t: f64) -> f64 {
        let point = ray.origin.as_dvec3() + t * ray.direction.as_dvec3();
        let shine = match lamp.light {
            LocalLight::Point(place) => {
                let sample = scene.lights[place as usize].sample(point);
                sample.map_or(0.0, |sample| sample.irradiance.max_element())
            }
            LocalLight::Round(_) | LocalLight::Area(_) => lamp.reach.shine(point) as f32,
        };
        let to_light = (lamp.reach.center - point).as_vec3();
        let distance = to_light.length();
        let phase = HenyeyGreenstein { g: self.medium.anisotropy };
        let scattered = phase.pdf(ray.direction, to_light / distance.max(f32::MIN_POSITIVE));
        let left = (-distance * self.medium.extinction().min_element()).exp();
        f64::from(shine * scattered * left.max(LEFT))
    }
}

/// One of two places, picked by a number in 0..1 in proportion to what they bring, to stand for both; `None` if that is nothing.
fn pick_one([a, b]: [Place; 2], u: f64) -> Option<Place> {
    let (from_a, from_b) = (a.glow * a.length, b.glow * b.length);
    let sum = from_a + from_b;
    let place = if u * sum < from_a { a } else { b };
    (sum > 0.0).then(|| Place { length: sum / place.glow, ..place })
}

impl Path<'_> {
    /// Asks local lights on the way of rays through media.
    #[inline(never)]
    pub(super) fn add_airlight(
        &self,
        bounce: u32,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let lights = &self.scene.local_lights;
        if self.asks_all(bounce) {
            for number in 0..lights.len() {
                let lamp = self.lamp(number, 1.0);
                self.ask_airways(bounce, number, points, scratch, recorder, |_, _, _| Some(lamp));
            }
            return;
        }
        let pair = Bounce::new(bounce).air_pick();
        self.ask_airways(bounce, 0, points, scratch, recorder, |airway, ray, points| {
            let pick = points.pair(pair).as_dvec2();
            let u = pick.x + pick.y * PAIR_STEP;
            let (number, chance) = lights.pick_along(&airway.seen(ray), u)?;
            Some(self.lamp(number, chance))
        });
    }

    fn lamp(&self, number: u32, chance: f32) -> Lamp {
        let lights = &self.scene.local_lights;
        Lamp { light: lights.light(number), reach: lights.reach(number), chance }
    }

    /// Asks one lamp for each of the rays, by pairs of numbers for the light with this number.
    fn ask_airways(
        &self,
        bounce: u32,
        number: u32,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
        lamp: impl Fn(&Airway, &Ray, &PathPoints) -> Option<Lamp>,
    ) {
        let Scratch { rays, walks, airways, shadows, samples, counts, .. } = scratch;
        let [along, on_light] = Bounce::new(bounce).air(number);
        shadows.clear();
        for airway in airways.iter() {
            let (ray, walk) = (&rays[airway.walk as usize], &walks[airway.walk as usize]);
            let points = &points[walk.sample as usize];
            let Some(lamp) = lamp(airway, ray, points) else { continue };
            let place = airway.place(self.scene, ray, &lamp, points.pair(along));
            let Some(place) = place else { continue };
            let u = || points.pair(on_light);
            if let Some(asked) = self.light_in_air(bounce, airway, (walk, ray), &lamp, &place, u) {
                shadows.ask(self.scene, &asked, &walk.media, samples, recorder);
            }
        }
        shadows.settle(self.scene, 0, samples, counts, recorder);
    }

    /// What a lamp gives to a place on the way of a ray.
    fn light_in_air(
        &self,
        bounce: u32,
        airway: &Airway,
        (walk, ray): (&Walk, &Ray),
        lamp: &Lamp,
        place: &Place,
        u: impl FnOnce() -> Vec2,
    ) -> Option<Asked> {
        let Airway { throughput, medium, .. } = airway;
        let distance = place.distance as f32;
        let position = ray.at(distance);
        // Of what emits, the chance in which a path that is scattered here would have asked for it counts in what is shared.
        let chance = match lamp.light {
            LocalLight::Area(number) if !self.asks_all(bounce) => {
                self.scene.local_lights.probability(position, Vec3::ZERO, number)
            }
            _ => lamp.chance,
        };
        let stands_for = place.length as f32 * (chance / lamp.chance);
        let scattered = medium.scattering * medium.transmittance(distance) * stands_for;
        let walk = Walk { throughput: *throughput * scattered, ..*walk };
        let phase = HenyeyGreenstein { g: medium.anisotropy };
        let (scattering, lobe) = Scattering::floating(&walk, position, ray.direction, phase);
        let vertex = Vertex::floating(&walk, position, &scattering, std::slice::from_ref(&lobe));
        let answer: Option<Answer> = match lamp.light {
            _ if chance == 0.0 => None,
            LocalLight::Point(place) => self.light_from_point(&vertex, place, chance),
            LocalLight::Round(place) => self.light_from_round(&vertex, place, chance, u()),
            LocalLight::Area(number) => {
                self.light_from_area(&vertex, self.scene.area_lights.get(number), chance, u())
            }
        };
        answer.map(|answer| Asked { after: Some(distance), ..answer.at(&vertex, bounce) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::measured;
    use super::*;
    use crate::scene::description::*;
    use crate::verify::scenes::*;
    use glam::DVec3;
    use std::f64::consts::{PI, TAU};

    /// From the start of the ray to the black wall, m.
    const LENGTH: f64 = 6.0;
    /// Fog as the second channel has it; the others have other fog.
    const EXTINCTION: f64 = 0.5;
    const SCATTERING: f64 = 0.4;
    const G: f64 = 0.4;
    /// Where lights stand, and where they shine to.
    const LAMP: DVec3 = DVec3::new(0.3, 0.5, 0.4);
    const DOWN: DVec3 = DVec3::NEG_Z;

    /// A part of a light: where it is, where it faces, and W·sr⁻¹ along that, W·sr⁻¹·m⁻² times m² if it is a part of a surface.
    struct Part {
        position: DVec3,
        normal: Option<DVec3>,
        intensity: f64,
    }

    fn fog(anisotropy: f64) -> Medium {
        let scattering = Rgb::new(0.1, SCATTERING as f32, 2.0);
        let absorption = Rgb::new(0.05, (EXTINCTION - SCATTERING) as f32, 0.0);
        Medium { absorption, scattering, anisotropy: anisotropy as f32 }
    }

    /// A ray in fog before a black wall.
    fn stage() -> (SceneDescription, Ray) {
        let mut scene = scene_for_paths(0.0);
        scene.medium = Some(fog(G));
        add_with(&mut scene, quad(v(-9.0, 3.0, -9.0), 18.0 * DVec3::X, 18.0 * DVec3::Z), 2);
        (scene, Ray::new(v(0.0, 3.0 - LENGTH, 0.0).as_vec3(), Vec3::Y))
    }

    /// The airlight integral ∫ σ_s e^(−σ (t + r)) p(cos) I cos / r² dt over all parts, by the midpoint rule.
    fn airlight(parts: &[Part], beam: impl Fn(DVec3) -> f64) -> f64 {
        const STEPS: u32 = 800;
        let step = LENGTH / f64::from(STEPS);
        let at = |i: u32| {
            let t = (f64::from(i) + 0.5) * step;
            let point = v(0.0, 3.0 - LENGTH + t, 0.0);
            let from = |part: &Part| {
                let off = part.position - point;
                let (r, to_light) = (off.length(), off.normalize());
                let facing = part.normal.map_or(1.0, |n| (-to_light).dot(n).max(0.0));
                let phase =
                    (1.0 - G * G) / (4.0 * PI) / (1.0 + G * G - 2.0 * G * to_light.y).powf(1.5);
                (-EXTINCTION * (t + r)).exp() * phase * part.intensity * beam(-to_light) * facing
                    / (r * r)
            };
            parts.iter().map(from).sum::<f64>()
        };
        SCATTERING * step * (0..STEPS).map(at).sum::<f64>()
    }

    /// A point of the second channel's intensity.
    fn point(position: DVec3, intensity: f64) -> (Light, Part) {
        let color = Rgb::splat(intensity as f32);
        (Light::Point { position, intensity: color }, Part { position, normal: None, intensity })
    }

    /// Parts of a sphere around the lamp.
    fn sphere(radius: f64, radiance: f64) -> Vec<Part> {
        const ROWS: u32 = 60;
        let mid = |i: u32| (f64::from(i) + 0.5) / f64::from(ROWS);
        let part = |i: u32| {
            let (z, phi) = (2.0 * mid(i / ROWS) - 1.0, TAU * mid(i % ROWS));
            let normal = ((1.0 - z * z).sqrt() * DVec3::new(phi.cos(), phi.sin(), 0.0)).with_z(z);
            let area = 4.0 * PI * radius * radius / f64::from(ROWS * ROWS);
            Part {
                position: LAMP + radius * normal,
                normal: Some(normal),
                intensity: radiance * area,
            }
        };
        (0..ROWS * ROWS).map(part).collect()
    }

    /// Parts of a square around the lamp that faces down.
    fn square(side: f64, radiance: f64) -> Vec<Part> {
        const ROWS: u32 = 40;
        let mid = |i: u32| ((f64::from(i) + 0.5) / f64::from(ROWS) - 0.5) * side;
        let area = (side / f64::from(ROWS)).powi(2);
        let part = |i: u32| Part {
            position: LAMP + v(mid(i / ROWS), mid(i % ROWS), 0.0),
            normal: Some(DOWN),
            intensity: radiance * area,
        };
        (0..ROWS * ROWS).map(part).collect()
    }

    /// What is scattered once is what the integral says, within four standard errors and the rule's own.
    fn assert_is(name: &str, scene: &SceneDescription, ray: &Ray, expected: f64) {
        let scene = Scene::build(scene);
        let [mean, error] = measured(&Path::new(&scene, false, Some(1)), ray, 1 << 12);
        let z = (mean - expected).abs() / (error + 1e-4 * expected);
        assert!(z < 4.0, "{name}: {mean} ± {error} is not {expected}, z = {z}");
        assert!(error < 0.01 * expected, "{name}: {mean} ± {error} tells nothing");
    }

    #[test]
    fn airlight_of_points_and_beams_is_the_integral() {
        let (mut scene, ray) = stage();
        let (light_of, part) = point(LAMP, 2.0);
        light(&mut scene, light_of);
        let parts = [part];
        assert_is("point", &scene, &ray, airlight(&parts, |_| 1.0));
        let [inner_angle, outer_angle] = [0.5, 0.9];
        let falloff = SpotFalloff::Gltf;
        let direction = DOWN;
        let intensity = Rgb::splat(2.0);
        scene.lights[0].light =
            Light::Spot { position: LAMP, direction, intensity, inner_angle, outer_angle, falloff };
        let beam = |toward: DVec3| {
            let ramp =
                (toward.dot(DOWN) - outer_angle.cos()) / (inner_angle.cos() - outer_angle.cos());
            ramp.clamp(0.0, 1.0).powi(2)
        };
        assert_is("spot", &scene, &ray, airlight(&parts, beam));
    }

    #[test]
    fn airlight_of_what_has_an_extent_is_the_integral() {
        let (mut round, ray) = stage();
        light(&mut round, point(LAMP, 2.0).0);
        round.lights[0].radius = 0.2;
        let as_bright = 2.0 / (PI * 0.04);
        assert_is("round", &round, &ray, airlight(&sphere(0.2, as_bright), |_| 1.0));
        for (name, shape, parts) in [
            ("sphere", ball(LAMP, 0.2), sphere(0.2, 1.0)),
            ("large sphere", ball(LAMP, 0.45), sphere(0.45, 1.0)),
            ("square", panel(LAMP, 0.7, 0.7), square(0.7, 1.0)),
        ] {
            let (mut scene, ray) = stage();
            add_with(&mut scene, shape, 1);
            assert_is(name, &scene, &ray, airlight(&parts, |_| 1.0));
        }
    }

    /// More points than are asked one by one: one is picked for all.
    #[test]
    fn airlight_of_many_is_the_sum() {
        let (mut scene, ray) = stage();
        let place = |i: u32| {
            v(f64::from(i % 5) - 2.3, 0.5 * f64::from(i / 5) - 2.0, 0.4 + 0.1 * f64::from(i % 3))
        };
        let (lights, parts): (Vec<_>, Vec<_>) =
            (0..45).map(|i| point(place(i), 1.0 + f64::from(i % 4))).unzip();
        lights.into_iter().for_each(|one| light(&mut scene, one));
        assert_is("many", &scene, &ray, airlight(&parts, |_| 1.0));
    }

    /// In a closed box that glows, fog that absorbs nothing is not there: asking lights and meeting them make a whole, also
    /// where one is picked for all.
    #[test]
    fn fog_in_a_furnace_is_not_seen() {
        for g in [0.0, 0.8] {
            let mut scene = scene_for_paths(0.0);
            scene.medium = Some(Medium { absorption: Rgb::ZERO, ..fog(g) });
            scene.materials.push(glowing(1.0, 0.0));
            add_with(&mut scene, cube(DVec3::ZERO, 3.0), 3);
            let scene = Scene::build(&scene);
            let ray = Ray::new(Vec3::new(0.4, -0.3, 0.2), Vec3::new(0.6, 0.0, 0.8));
            let [mean, error] = measured(&Path::new(&scene, false, None), &ray, 1 << 11);
            assert!((mean - 1.0).abs() < 4.0 * error && error < 0.01, "{g}: {mean} ± {error}");
        }
    }
}
