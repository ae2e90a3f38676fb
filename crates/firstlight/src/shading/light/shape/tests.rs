//! Each shape against its density: counts over a chart of its surface (Pearson's χ²), solid angles, irradiances.

use super::*;
use crate::math::tangents;
use crate::testing::{Random, chi_squared_z};
use glam::{DAffine3, DMat3, DQuat};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A light shape that covers the unit square of a chart: where a point of the square lies, and the other way round.
struct Charted {
    shape: LightShape,
    to_world: DAffine3,
    chart: Chart,
}

/// Charts of the unit shapes.
#[derive(Clone, Copy)]
enum Chart {
    /// The part of the unit sphere with a cosine to the unit vector `pole` of at least `least`.
    Cap {
        pole: DVec3,
        least: f64,
    },
    Disk,
    Square,
    Triangle,
    /// Angles around the axis from `middle − half_width` to `middle + half_width`.
    Side {
        middle: f64,
        half_width: f64,
    },
}

impl Chart {
    fn position(self, st: DVec2) -> DVec3 {
        match self {
            Self::Cap { pole, least } => {
                let z = 1.0 - st.x * (1.0 - least);
                let around = DVec2::from_angle(TAU * st.y) * (1.0 - z * z).max(0.0).sqrt();
                let (tangent, bitangent) = tangents(pole);
                around.x * tangent + around.y * bitangent + z * pole
            }
            Self::Disk => (DVec2::from_angle(TAU * st.y) * st.x.sqrt()).extend(0.0),
            Self::Square => st.extend(0.0),
            Self::Triangle => DVec3::new(st.x, st.y * (1.0 - st.x), 0.0),
            Self::Side { middle, half_width } => {
                DVec2::from_angle(middle + (2.0 * st.x - 1.0) * half_width).extend(st.y)
            }
        }
    }

    /// Outward normal of the unit shape.
    fn normal(self, p: DVec3) -> DVec3 {
        match self {
            Self::Cap { .. } => p,
            Self::Side { .. } => p.with_z(0.0),
            _ => DVec3::Z,
        }
    }

    fn locate(self, p: DVec3) -> DVec2 {
        let around = |p: DVec2| p.to_angle().rem_euclid(TAU) / TAU;
        match self {
            Self::Cap { pole, least } => {
                let (tangent, bitangent) = tangents(pole);
                let s = (1.0 - p.dot(pole)) / (1.0 - least);
                DVec2::new(s, around(DVec2::new(p.dot(tangent), p.dot(bitangent))))
            }
            Self::Disk => DVec2::new(p.truncate().length_squared(), around(p.truncate())),
            Self::Square => p.truncate(),
            Self::Triangle => DVec2::new(p.x, p.y / (1.0 - p.x)),
            Self::Side { middle, half_width } => {
                let angle = DVec2::from_angle(middle).angle_to(p.truncate());
                DVec2::new(0.5 + 0.5 * angle / half_width, p.z)
            }
        }
    }
}

impl Charted {
    /// The shape whose unit is charted by `chart`, under `to_world`; `from` sees it.
    fn new(kind: &str, to_world: DAffine3, from: DVec3) -> Self {
        let eye = to_world.inverse().transform_point3(from);
        let m = to_world.matrix3;
        let corner = to_world.translation;
        let (shape, chart) = match kind {
            "ellipsoid" => {
                let d = eye.length();
                let least = if d > 1.0 { 1.0 / d } else { -1.0 };
                let chart = Chart::Cap { pole: eye.normalize_or(DVec3::Z), least };
                (LightShape::Ellipsoid(Ellipsoid::new(&to_world)), chart)
            }
            "disk" => (LightShape::Disk(EllipticDisk::new(&to_world)), Chart::Disk),
            "square" => (LightShape::Parallelogram(Parallelogram::new(&to_world)), Chart::Square),
            "triangle" => {
                let triangle = Triangle::new([corner, corner + m.x_axis, corner + m.y_axis]);
                (LightShape::Triangle(triangle), Chart::Triangle)
            }
            _ => {
                let rho = eye.truncate().length();
                let (middle, half_width) = if rho > 1.0 {
                    (eye.truncate().to_angle(), (1.0 / rho).acos())
                } else {
                    (0.0, PI)
                };
                let chart = Chart::Side { middle, half_width };
                (LightShape::CylinderSide(CylinderSide::new(&to_world)), chart)
            }
        };
        Self { shape, to_world, chart }
    }

    fn position(&self, st: DVec2) -> DVec3 {
        self.to_world.transform_point3(self.chart.position(st))
    }

    /// Probability per area of the chart's square with which `from` is to pick the point at `st`.
    fn density(&self, from: DVec3, st: DVec2) -> f64 {
        const STEP: f64 = 1e-6;
        let slope = |along: DVec2| {
            (self.position(st + STEP * along) - self.position(st - STEP * along)) / (2.0 * STEP)
        };
        let area = slope(DVec2::X).cross(slope(DVec2::Y));
        let to_light = self.position(st) - from;
        let steradians = area.dot(to_light).abs() / to_light.length().powi(3);
        self.shape.pdf(from, self.position(st)) * steradians
    }

    /// Expected share of the samples in each of `bins`² cells, by `parts`² midpoints in each.
    fn expected(&self, from: DVec3, bins: usize, parts: usize) -> Vec<f64> {
        let fine = (bins * parts) as f64;
        let mut shares = vec![0.0; bins * bins];
        for (i, j) in (0..bins * parts).flat_map(|i| (0..bins * parts).map(move |j| (i, j))) {
            let st = (DVec2::new(i as f64, j as f64) + 0.5) / fine;
            shares[i / parts * bins + j / parts] += self.density(from, st) / (fine * fine);
        }
        shares
    }

    /// Counts of `samples` samples in `bins`² cells. Whether each sample lies on the shape and knows its own density.
    fn counts(&self, from: DVec3, bins: usize, samples: usize, random: &mut Random) -> Vec<u64> {
        let mut counts = vec![0; bins * bins];
        for _ in 0..samples {
            let u = DVec2::new(random.unit(), random.unit());
            let sample = self.shape.sample(from, u).expect("the light is seen");
            self.is_sound(from, &sample);
            let unit = self.to_world.inverse().transform_point3(sample.position);
            let cell = |x: f64| ((x * bins as f64) as usize).min(bins - 1);
            let st = self.chart.locate(unit);
            counts[cell(st.x) * bins + cell(st.y)] += 1;
        }
        counts
    }

    fn is_sound(&self, from: DVec3, sample: &ShapeSample) {
        let along = from + sample.distance * sample.incoming;
        assert!(along.distance(sample.position) <= 1e-12 * (sample.distance + from.length()));
        assert!((sample.incoming.length() - 1.0).abs() < 1e-12);
        let unit = self.to_world.inverse().transform_point3(sample.position);
        let normal = self.to_world.matrix3.inverse().transpose() * self.chart.normal(unit);
        // Triangles take their front from the order of their corners, which mirrors turn round.
        let is_triangle = matches!(self.chart, Chart::Triangle);
        let side = if is_triangle { self.to_world.matrix3.determinant().signum() } else { 1.0 };
        assert!((side * normal.normalize()).distance(sample.normal) < 1e-6);
        let pdf = self.shape.pdf(from, sample.position);
        assert!((pdf / sample.pdf - 1.0).abs() < 1e-9, "{pdf} is not {}", sample.pdf);
    }
}

/// Maps that turn, stretch and shear, and keep or change the hand.
fn maps() -> Vec<DAffine3> {
    let at = DVec3::new(0.4, -0.3, 2.0);
    let turned = DQuat::from_euler(glam::EulerRot::XYZ, 0.6, -0.4, 1.1);
    let skewed = DMat3::from_cols(
        DVec3::new(1.1, 0.2, -0.1),
        DVec3::new(0.3, -0.7, 0.2),
        DVec3::new(-0.2, 0.4, 0.9),
    );
    vec![
        DAffine3::from_scale_rotation_translation(DVec3::splat(0.8), turned, at),
        DAffine3::from_mat3_translation(skewed, at),
    ]
}

const KINDS: [&str; 5] = ["ellipsoid", "disk", "square", "triangle", "side"];

#[track_caller]
fn check(charted: &Charted, from: DVec3, what: &str) {
    let (bins, samples) = (24, 300_000);
    let expected = charted.expected(from, bins, 10);
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 2e-3, "{what}: the density's integral is {total}");
    let counts = charted.counts(from, bins, samples, &mut Random::new(7));
    let z = chi_squared_z(&counts, &expected);
    assert!(z.abs() < 4.5, "{what}: {z} standard deviations from the density");
}

#[test]
fn every_shape_is_sampled_by_its_density() {
    for (m, map) in maps().into_iter().enumerate() {
        for kind in KINDS {
            for (f, from) in [DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0)].into_iter().enumerate() {
                check(&Charted::new(kind, map, from), from, &format!("{kind}, map {m}, from {f}"));
            }
        }
    }
}

#[test]
fn round_shapes_are_sampled_by_their_density_from_inside() {
    for (m, map) in maps().into_iter().enumerate() {
        let from = map.transform_point3(DVec3::new(0.3, -0.2, 0.6));
        for kind in ["ellipsoid", "side"] {
            check(&Charted::new(kind, map, from), from, &format!("{kind}, map {m}, from inside"));
        }
    }
}

#[test]
fn near_shapes_are_sampled_by_their_density() {
    for kind in ["ellipsoid", "square", "triangle"] {
        let map = maps()[1];
        let above = if kind == "ellipsoid" { DVec3::Z } else { DVec3::new(0.3, 0.3, 0.0) };
        let from = map.transform_point3(above + 0.1 * DVec3::Z);
        check(&Charted::new(kind, map, from), from, &format!("{kind}, from near"));
    }
}

/// From far away, or if the light is small, a flat light is sampled by area: all digits that matter are there.
#[test]
fn small_and_distant_shapes_are_sampled_by_their_density() {
    for size in [1e-9, 1e-5, 1.0] {
        for kind in KINDS {
            let map = DAffine3::from_scale(DVec3::splat(size)) * maps()[1];
            let from = DVec3::new(300.0, 200.0, 500.0);
            check(&Charted::new(kind, map, from), from, &format!("{kind} of size {size}"));
        }
    }
}

/// Mean of `value` over points that `shape` picks for `from`, with the standard error.
fn mean(shape: &LightShape, from: DVec3, value: impl Fn(&ShapeSample) -> f64) -> (f64, f64) {
    let (rows, mut random) = (400, Random::new(3));
    let (mut sum, mut squares) = (0.0, 0.0);
    for cell in 0..rows * rows {
        let jitter = DVec2::new(random.unit(), random.unit());
        let place = DVec2::new(f64::from(cell / rows), f64::from(cell % rows));
        let sample = shape.sample(from, (place + jitter) / f64::from(rows));
        let x = sample.map_or(0.0, |sample| value(&sample));
        sum += x;
        squares += x * x;
    }
    let n = f64::from(rows * rows);
    (sum / n, ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt())
}

/// ∫ dω over the light, of ∫ cos θ dω for a receiver at the origin.
#[track_caller]
fn expect(shape: &LightShape, from: DVec3, value: impl Fn(&ShapeSample) -> f64, expected: f64) {
    let (mean, error) = mean(shape, from, value);
    let close = (mean - expected).abs() <= 4.0 * error + 1e-9 * expected.abs();
    assert!(close && error < 2e-2 * expected, "{mean} ± {error} is not {expected}");
}

fn sphere(center: DVec3, radius: f64) -> LightShape {
    let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(radius)), center);
    LightShape::Ellipsoid(Ellipsoid::new(&map))
}

fn rectangle(center: DVec3, width: f64, depth: f64) -> LightShape {
    let scale = DVec3::new(width, depth, 1.0);
    let corner = center - 0.5 * scale.with_z(0.0);
    let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(scale), corner);
    LightShape::Parallelogram(Parallelogram::new(&map))
}

fn disk(center: DVec3, radius: f64) -> LightShape {
    let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(radius)), center);
    LightShape::Disk(EllipticDisk::new(&map))
}

/// The mean of 1/pdf is the solid angle.
#[test]
fn solid_angles_match_closed_forms() {
    let steradians = |sample: &ShapeSample| 1.0 / sample.pdf;
    for distance in [1.0 + 1e-9, 1.1, 2.0, 1e3, 1e8] {
        let shape = sphere(DVec3::Z * distance, 1.0);
        let half_angle = f64::asin(1.0 / distance);
        expect(&shape, DVec3::ZERO, steradians, 4.0 * PI * (0.5 * half_angle).sin().powi(2));
    }
    for distance in [1e-6_f64, 1e-2, 1.0, 1e2, 1e6] {
        let (w, d) = (2.0, 0.5);
        let corner = w * d / (w * w + d * d + 4.0 * distance * distance).sqrt();
        let expected = 4.0 * (corner / (2.0 * distance)).atan();
        expect(&rectangle(DVec3::Z * distance, w, d), DVec3::ZERO, steradians, expected);
    }
    let on_axis = TAU * (1.0 - 2.0 / 5_f64.sqrt());
    expect(&disk(DVec3::Z * 2.0, 1.0), DVec3::ZERO, steradians, on_axis);
    let octant = Triangle::new([DVec3::X, DVec3::Y, DVec3::Z]);
    expect(&LightShape::Triangle(octant), DVec3::ZERO, steradians, FRAC_PI_2);
    // Seen across: twice the angle times the sine of that to its ends.
    let side = CylinderSide::new(&DAffine3::from_translation(DVec3::new(3.0, 0.0, -0.5)));
    let facing =
        |sample: &ShapeSample| f64::from(sample.normal.dot(sample.incoming) < 0.0) / sample.pdf;
    let (all, facing) = (
        mean(&LightShape::CylinderSide(side), DVec3::ZERO, steradians),
        mean(&LightShape::CylinderSide(side), DVec3::ZERO, facing),
    );
    assert_eq!(all, facing, "only the outside is picked from outside");
}

/// Irradiances of a horizontal receiver at the origin under a radiance of 1, names as in the reference table.
#[test]
fn irradiances_match_closed_forms() {
    let irradiance = |sample: &ShapeSample| sample.incoming.z.max(0.0) / sample.pdf;
    // A01, A14: Lambert's polygon formula.
    for (h, expected) in
        [(1.0, 0.752274688), (0.1, 3.04212844), (1e-2, 3.14056468), (1e-3, 3.14158237)]
    {
        expect(&rectangle(DVec3::Z * h, 1.0, 1.0), DVec3::ZERO, irradiance, expected);
    }
    // A08, A09.
    for (x, expected) in [(0.0, 0.628318531), (1.0, 0.460075592), (5.0, 0.0157872984)] {
        expect(&disk(DVec3::Z * 2.0, 1.0), DVec3::X * x, irradiance, expected);
    }
    // A11.
    for degrees in [0.0, 30.0, 60.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let tilted = |sample: &ShapeSample| {
            sample.incoming.dot(DVec3::new(sin, 0.0, cos)).max(0.0) / sample.pdf
        };
        expect(&sphere(DVec3::Z * 2.0, 0.5), DVec3::ZERO, tilted, PI / 16.0 * cos);
    }
    // A06, polylum1: Nori's triangle above a receiver that faces y.
    let corners = [
        DVec3::new(-0.443432, 0.596366, 0.495985),
        DVec3::new(-0.320397, 0.0677699, -0.229359),
        DVec3::new(0.0341197, 0.11415, -0.343049),
    ];
    let facing_y = |sample: &ShapeSample| sample.incoming.y.max(0.0) / sample.pdf;
    let triangle = LightShape::Triangle(Triangle::new(corners));
    expect(&triangle, DVec3::ZERO, facing_y, 0.0898392585 * TAU);
}

/// A uniform cylinder fills the sky of a point inside but for its two openings.
#[test]
fn a_cylinder_is_all_around_a_point_inside() {
    let side =
        LightShape::CylinderSide(CylinderSide::new(&DAffine3::from_translation(-0.5 * DVec3::Z)));
    let opening = TAU * (1.0 - 0.5 / 1.25_f64.sqrt());
    expect(&side, DVec3::ZERO, |s| 1.0 / s.pdf, 4.0 * PI - 2.0 * opening);
}

#[test]
fn areas_match_closed_forms() {
    let close = |shape: LightShape, expected: f64, relative: f64| {
        let area = shape.area();
        assert!((area / expected - 1.0).abs() < relative, "{area} is not {expected}");
    };
    close(sphere(DVec3::ONE, 3.0), 36.0 * PI, 1e-12);
    close(disk(DVec3::ONE, 3.0), 9.0 * PI, 1e-12);
    close(rectangle(DVec3::ONE, 3.0, 2.0), 6.0, 1e-12);
    close(LightShape::Triangle(Triangle::new([DVec3::ZERO, DVec3::X, DVec3::Y])), 0.5, 1e-12);
    // A prolate and an oblate spheroid.
    let e = f64::sqrt(1.0 - 1.0 / 25.0);
    let (long, flat) = (DVec3::new(1.0, 1.0, 5.0), DVec3::new(5.0, 5.0, 1.0));
    for (scale, area) in [
        (long, TAU * (1.0 + 5.0 / e * e.asin())),
        (flat, TAU * 25.0 * (1.0 + (1.0 - e * e) / e * e.atanh())),
    ] {
        let turned = DAffine3::from_scale_rotation_translation(
            scale,
            DQuat::from_rotation_x(0.4),
            DVec3::ONE,
        );
        close(LightShape::Ellipsoid(Ellipsoid::new(&turned)), area, 1e-3);
    }
    let tube = DAffine3::from_scale(DVec3::new(2.0, 2.0, 3.0));
    close(LightShape::CylinderSide(CylinderSide::new(&tube)), 12.0 * PI, 1e-12);
}

/// Wherever the eye is and however large the light: an answer, or none, but never a number that is not one.
#[test]
fn extremes_give_sound_samples_or_none() {
    let mut random = Random::new(1);
    let wide = |random: &mut Random| 10_f64.powf(24.0 * random.unit() - 12.0);
    for n in 0..200_000 {
        let scale = DVec3::new(wide(&mut random), wide(&mut random), wide(&mut random));
        let turned = DQuat::from_axis_angle(random.direction(), 6.0 * random.unit());
        let map = DAffine3::from_scale_rotation_translation(
            scale,
            turned,
            random.point() * wide(&mut random),
        );
        let eye = if n % 3 == 0 { map.transform_point3(random.point()) } else { random.point() };
        let from = if n % 7 == 0 { map.translation } else { eye };
        let charted = Charted::new(KINDS[n % 5], map, from);
        let Some(sample) = charted.shape.sample(from, DVec2::new(random.unit(), random.unit()))
        else {
            continue;
        };
        assert!(sample.position.is_finite() && sample.incoming.is_finite(), "{sample:?}");
        assert!(
            sample.normal.is_finite() && sample.distance > 0.0 && sample.pdf > 0.0,
            "{sample:?}"
        );
    }
}

/// From near and from afar, in full blocks and others.
#[test]
fn a_block_of_points_sees_what_each_sees_alone() {
    let mut random = Random::new(11);
    for (map, kind) in maps().into_iter().flat_map(|map| KINDS.map(|kind| (map, kind))) {
        let shape = Charted::new(kind, map, DVec3::new(3.0, 1.0, 1.5)).shape;
        for count in [1, 37, BLOCK] {
            let (mut from, mut u) = (Columns::<f64>::default(), [Vec2::ZERO; BLOCK]);
            for (k, u) in u[..count].iter_mut().enumerate() {
                let distance = 10.0_f64.powf(2.0 * random.unit() - 1.0);
                let around = DVec2::from_angle(TAU * random.unit());
                from.set(k, map.translation + distance * around.extend(random.unit() - 0.5));
                *u = Vec2::new(random.unit() as f32, random.unit() as f32);
            }
            let mut samples = ShapeSamples::default();
            shape.sample_all(&from, &u, count, &mut samples);
            for (k, u) in u[..count].iter().enumerate() {
                assert_eq!(samples.get(k), shape.sample(from.get(k), u.as_dvec2()), "{kind}");
            }
        }
    }
}

/// Whichever corner a lamp is described from, it is the same lamp, from near, from afar and in between.
#[test]
fn a_square_is_the_same_from_each_of_its_corners() {
    let mut random = Random::new(13);
    for map in maps() {
        let (m, corner) = (map.matrix3, map.translation);
        let turned = DAffine3 {
            matrix3: DMat3::from_cols(-m.x_axis, -m.y_axis, m.z_axis),
            translation: corner + m.x_axis + m.y_axis,
        };
        let [a, b] = [map, turned].map(|map| Parallelogram::new(&map));
        for _ in 0..1000 {
            let mut unit = || random.unit();
            let position = corner + unit() * m.x_axis + unit() * m.y_axis;
            let from = position + 6.0 * DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5);
            assert!((a.pdf(from, position) / b.pdf(from, position) - 1.0).abs() < 1e-9);
        }
    }
}
