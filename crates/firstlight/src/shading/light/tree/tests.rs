//! Picks against their probabilities, and sums over picked lights against sums over all.

use super::*;
use crate::geometry::Bounds;
use crate::simd::Level;
use crate::testing::{Random, chi_squared_z};
use std::f32::consts::{FRAC_PI_2, PI};

/// A light that is a point: where, how strong, along which axis, within which angle.
#[derive(Debug, Clone, Copy)]
struct Lamp {
    position: Vec3,
    intensity: f32,
    cone: EmissionCone,
}

impl Lamp {
    fn bounds(&self) -> LightBounds {
        let bounds = Bounds { lo: self.position, hi: self.position };
        LightBounds { bounds, cone: self.cone, intensity: self.intensity }
    }

    /// Irradiance, up to a factor: Lambert's cosine inside the cone.
    fn gives(&self, point: Vec3, normal: Vec3) -> f32 {
        let to_light = self.position - point;
        let incoming = to_light.normalize();
        let cos = -self.cone.axis.dot(incoming);
        let cos = if self.cone.two_sided { cos.abs() } else { cos };
        let angle = (cos.clamp(-1.0, 1.0).acos() - self.cone.spread).max(0.0);
        let sent = if angle >= self.cone.falloff { 0.0 } else { angle.cos() };
        self.intensity * sent * normal.dot(incoming).max(0.0) / to_light.length_squared()
    }
}

fn lamps(count: usize, seed: u64) -> Vec<Lamp> {
    let mut random = Random::new(seed);
    let lamp = |i: usize| {
        let axis = random.direction().as_vec3();
        let cone = match i % 4 {
            0 => EmissionCone::EVERYWHERE,
            1 => EmissionCone::flat(axis, false),
            2 => EmissionCone::flat(axis, true),
            _ => EmissionCone { axis, spread: 0.2, falloff: 0.5, two_sided: false },
        };
        let intensity = if i % 11 == 5 { 0.0 } else { 10_f32.powf(2.0 * random.unit() as f32) };
        Lamp { position: 5.0 * random.point().as_vec3(), intensity, cone }
    };
    (0..count).map(lamp).collect()
}

fn tree(lamps: &[Lamp]) -> LightTree {
    LightTree::build(&lamps.iter().map(Lamp::bounds).collect::<Vec<_>>(), Level::detect())
}

fn receivers(count: usize, reach: f32) -> impl Iterator<Item = (Vec3, Vec3)> {
    let mut random = Random::new(77);
    (0..count).map(move |_| (reach * random.point().as_vec3(), random.direction().as_vec3()))
}

#[test]
fn lights_are_picked_by_their_probability() {
    for count in [1, 2, 3, 40, 1000] {
        let lamps = lamps(count, count as u64);
        let tree = tree(&lamps);
        for (point, normal) in receivers(6, 7.0) {
            let shares: Vec<f64> =
                (0..count as u32).map(|i| tree.probability(point, normal, i).into()).collect();
            let total: f64 = shares.iter().sum();
            // What is lost are ways that end where neither child gives anything.
            let lost = 1.0 - total;
            assert!(lost > -1e-4, "{count}: {total}");
            let mut counts = vec![0; count + 1];
            let mut random = Random::new(4);
            for _ in 0..100_000 {
                match tree.pick(point, normal, random.unit()) {
                    Some((light, probability)) => {
                        let known = tree.probability(point, normal, light);
                        assert!((probability / known - 1.0).abs() < 1e-5, "{count}");
                        counts[light as usize] += 1;
                    }
                    None => counts[count] += 1,
                }
            }
            let shares: Vec<_> = shares.into_iter().chain([lost.max(0.0)]).collect();
            if total > 0.0 && counts.iter().filter(|count| **count > 0).count() > 1 {
                let z = chi_squared_z(&counts, &shares);
                assert!(z < 4.5, "{count}: {z} standard deviations");
            }
        }
    }
}

#[test]
fn whatever_gives_light_can_be_picked() {
    let lamps = lamps(300, 5);
    let tree = tree(&lamps);
    for (point, normal) in receivers(2000, 7.0) {
        for (light, lamp) in (0..).zip(&lamps) {
            let (gives, probability) =
                (lamp.gives(point, normal), tree.probability(point, normal, light));
            assert!(gives == 0.0 || probability > 0.0, "{lamp:?} gives {gives} to {point}");
        }
    }
}

/// The mean over picked lights is the sum over all, and better known than with picks by intensity alone.
#[test]
fn picked_lights_stand_for_all() {
    let lamps = lamps(2000, 9);
    let tree = tree(&lamps);
    let all_intensity: f32 = lamps.iter().map(|lamp| lamp.intensity).sum();
    let (mut squares, mut squares_by_intensity, mut far_off) = (0.0, 0.0, 0);
    for (point, normal) in receivers(200, 7.0) {
        let expected: f64 = lamps.iter().map(|lamp| f64::from(lamp.gives(point, normal))).sum();
        if expected == 0.0 {
            continue;
        }
        let by_intensity: f64 = lamps
            .iter()
            .filter(|lamp| lamp.intensity > 0.0)
            .map(|lamp| {
                f64::from(lamp.gives(point, normal)).powi(2)
                    * f64::from(all_intensity / lamp.intensity)
            })
            .sum();
        let mut random = Random::new(6);
        let (mut sum, mut sum2, n) = (0.0, 0.0, 20_000);
        for _ in 0..n {
            let Some((light, probability)) = tree.pick(point, normal, random.unit()) else {
                continue;
            };
            let value = f64::from(lamps[light as usize].gives(point, normal) / probability);
            sum += value;
            sum2 += value * value;
        }
        let (mean, n) = (sum / f64::from(n), f64::from(n));
        let variance = sum2 / n - mean * mean;
        far_off += u32::from((mean - expected).abs() > 4.0 * (variance / n).sqrt());
        squares += variance / (expected * expected);
        squares_by_intensity += by_intensity / (expected * expected) - 1.0;
    }
    // Rare bright lights near a point make a few deviations look smaller than they are.
    assert!(far_off <= 2, "{far_off} sums are far off");
    assert!(
        squares < 0.05 * squares_by_intensity,
        "{squares} against {squares_by_intensity} by intensity"
    );
}

#[test]
fn cones_hold_what_they_are_made_of() {
    let mut random = Random::new(12);
    for _ in 0..20_000 {
        let mut cone = || EmissionCone {
            axis: random.direction().as_vec3(),
            spread: PI * random.unit().powi(2) as f32,
            falloff: FRAC_PI_2 * random.unit() as f32,
            two_sided: false,
        };
        let (a, b) = (cone(), cone());
        let both = a.union(b);
        for part in [a, b] {
            let reach = both.axis.dot(part.axis).clamp(-1.0, 1.0).acos() + part.spread;
            assert!(both.spread == PI || reach <= both.spread + 2e-3, "{a:?} {b:?} {both:?}");
            assert!(both.falloff >= part.falloff);
        }
        assert!(both.spread <= a.spread.max(b.spread).max(0.5 * (PI + a.spread + b.spread)) + 1e-3);
        assert!(both.measure() >= a.measure().max(b.measure()) - 1e-3);
    }
}

/// Lights in one place, or so far apart that sums overflow, neither break the tree nor make it too deep for its trails.
#[test]
fn odd_crowds_of_lights_make_sound_trees() {
    let at = |position: Vec3| Lamp { position, intensity: 1.0, cone: EmissionCone::EVERYWHERE };
    let same = vec![at(Vec3::ONE); 3000];
    let far = |i: i32| at([Vec3::X, Vec3::Y, Vec3::Z][(i % 3) as usize] * 2_f32.powi(i / 3 - 140));
    let apart: Vec<_> = (0..570).map(far).collect();
    for lamps in [same, apart] {
        let tree = tree(&lamps);
        assert!(tree.nodes.len() < lamps.len());
        let share = |i| f64::from(tree.probability(-Vec3::ONE, Vec3::ONE.normalize(), i));
        let total: f64 = (0..lamps.len() as u32).map(share).sum();
        assert!((total - 1.0).abs() < 1e-3, "{total}");
    }
    assert_eq!(LightTree::build(&[], Level::detect()).pick(Vec3::ZERO, Vec3::Z, 0.5), None);
    let dark = Lamp { intensity: 0.0, ..at(Vec3::ONE) };
    assert_eq!(tree(&[dark]).pick(Vec3::ZERO, Vec3::Z, 0.5), None);
}

#[test]
fn every_level_picks_the_same() {
    let bounds: Vec<_> = lamps(500, 3).iter().map(Lamp::bounds).collect();
    let [first, .., last] = &Level::all()[..] else { return };
    let trees = [first, last].map(|level| LightTree::build(&bounds, *level));
    let mut random = Random::new(8);
    for (point, normal) in receivers(1000, 7.0) {
        let u = random.unit();
        let [a, b] = trees.each_ref().map(|tree| tree.pick(point, normal, u));
        assert_eq!(a, b);
    }
}
