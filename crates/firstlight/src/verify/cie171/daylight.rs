//! CIE 171:2006, 5.9 to 5.11: daylight through one opening of a black room, under the CIE's general skies. What arrives is
//! given in percent of what the whole sky gives to the ground outside.

use super::{on_wall, standard, steps, walls};
use crate::integrator::{Measurement, Meter};
use crate::scene::Scene;
use crate::scene::description::*;
use crate::verify::closed_forms::over_square;
use crate::verify::scenes::*;
use crate::verify::{Case, Readings, Tolerance};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

pub(super) const fn case(
    id: &'static str,
    setup: &'static str,
    measure: fn(&mut Readings),
) -> Case {
    let source = "ISO 15469:2004, integrated over the opening";
    Case::sampled(id, setup, source, measure).within(Tolerance::Relative(5e-3))
}

/// Width, depth and height of the room, m.
const ROOM: DVec3 = DVec3::new(4.0, 4.0, 3.0);
/// The number of the ceiling in [`walls`].
const CEILING: usize = 1;
/// The number of the wall y = 0.
const FRONT: usize = 4;
/// What the ground outside reflects.
const GROUND: f64 = 0.3;

/// Under a sky with a hole in the roof: the sun stands over the wall opposite to the measured one.
pub(super) fn roof(readings: &mut Readings, sky: u8, sides: &[f64]) {
    for &side in sides {
        let outside = Outside::new(sky, 0.0, v(0.0, 0.5, 0.75_f64.sqrt()));
        let room = Room { outside, opening: Opening::centred(CEILING, [side; 2]), pane: None };
        let names = if sides.len() > 1 { format!("{side}x{side}/") } else { String::new() };
        room.measure(readings, &names, wall_and_floor());
    }
}

/// The same under a uniform sky, with a pane of glass in the hole.
pub(super) fn glazed_roof(readings: &mut Readings) {
    let outside = Outside::new(5, 0.0, DVec3::Z);
    let opening = Opening::centred(CEILING, [1.0; 2]);
    Room { outside, opening, pane: Some(1.52) }.measure(readings, "", wall_and_floor());
}

/// With openings in the wall y = 0, of so many metres of width and height, through which the ground is seen too. The sun
/// stands before them, and does not shine itself.
pub(super) fn facade(readings: &mut Readings, sky: u8, sizes: &[[f64; 2]]) {
    for &[width, height] in sizes {
        let outside = Outside::new(sky, GROUND, v(0.0, -0.5, 0.75_f64.sqrt()));
        let room = Room { outside, opening: Opening::centred(FRONT, [height, width]), pane: None };
        let names = if sizes.len() > 1 { format!("{width}x{height}/") } else { String::new() };
        room.measure(readings, &names, all_around());
    }
}

/// Where the light is measured: a name, a point and what it faces.
type Place = (String, DVec3, DVec3);

fn wall_and_floor() -> Vec<Place> {
    let wall = on_wall().map(|(name, place)| (name.to_string(), place, DVec3::Y));
    let floor =
        ('G'..='N').zip(steps(8)).map(|(name, y)| (name.to_string(), v(2.0, y, 0.0), DVec3::Z));
    wall.chain(floor).collect()
}

/// The back wall from the top down, floor and ceiling from the back on.
fn all_around() -> Vec<Place> {
    let wall = ('A'..='F').zip(steps(6).rev());
    let wall = wall.map(|(name, z)| (name.to_string(), v(2.0, 4.0, z), -DVec3::Y));
    let depths = || ('G'..='N').zip(steps(8).rev());
    let floor = depths().map(|(name, y)| (name.to_string(), v(2.0, y, 0.0), DVec3::Z));
    let ceiling = depths().map(|(name, y)| (format!("{name}'"), v(2.0, y, 3.0), -DVec3::Z));
    wall.chain(floor).chain(ceiling).collect()
}

/// A rectangular hole in a wall.
struct Opening {
    wall: usize,
    /// From where to where it reaches along the wall's two edges, m.
    spans: [[f64; 2]; 2],
}

/// A sky over a ground that reflects alike everywhere.
struct Outside {
    number: u8,
    sun: DVec3,
    /// What the sky gives to the ground, where its zenith has radiance 1, W·m⁻².
    horizontal: f64,
    /// Radiance of the ground, W·sr⁻¹·m⁻².
    ground: f64,
}

struct Room {
    outside: Outside,
    opening: Opening,
    /// Index of the glass in the opening.
    pane: Option<f64>,
}

impl Outside {
    fn new(number: u8, reflectance: f64, sun: DVec3) -> Self {
        // Equal parts of the square are equal parts of the projected hemisphere.
        let horizontal = over_square(400, |st| {
            let from = DVec2::from_angle(TAU * st.x) * st.y.sqrt();
            PI * standard::luminance(number, sun, from.extend((1.0 - st.y).sqrt()))
        });
        Self { number, sun, horizontal, ground: reflectance / PI * horizontal }
    }

    fn radiance(&self, from: DVec3) -> f64 {
        if from.z > 0.0 { standard::luminance(self.number, self.sun, from) } else { self.ground }
    }

    fn description(&self) -> Option<EnvironmentDescription> {
        let (number, sun) = (self.number, self.sun);
        under(Sky::Cie { number, sun, ground: DVec3::splat(self.ground).as_vec3() }, 1.0)
    }
}

impl Opening {
    /// In the middle of a wall, of so many metres along its two edges.
    fn centred(wall: usize, size: [f64; 2]) -> Self {
        let (_, u, w) = walls(ROOM)[wall];
        let span = |edge: DVec3, size: f64| {
            let middle = 0.5 * edge.length();
            [middle - 0.5 * size, middle + 0.5 * size]
        };
        Self { wall, spans: [span(u, size[0]), span(w, size[1])] }
    }

    /// A part of its wall: a corner and two edges.
    fn part(&self, [u0, u1]: [f64; 2], [w0, w1]: [f64; 2]) -> [DVec3; 3] {
        let (corner, u, w) = walls(ROOM)[self.wall];
        let (u, w) = (u.normalize(), w.normalize());
        [corner + u0 * u + w0 * w, (u1 - u0) * u, (w1 - w0) * w]
    }

    /// What is left of its wall.
    fn frame(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let (_, u, w) = walls(ROOM)[self.wall];
        let ([u0, u1], [w0, w1]) = (self.spans[0], self.spans[1]);
        let (u_end, w_end) = (u.length(), w.length());
        [
            self.part([0.0, u0], [0.0, w_end]),
            self.part([u1, u_end], [0.0, w_end]),
            self.part([u0, u1], [0.0, w0]),
            self.part([u0, u1], [w1, w_end]),
        ]
        .into_iter()
        .filter(|[_, u, w]| u.cross(*w) != DVec3::ZERO)
    }

    /// Its parts below and above the horizon of a point.
    fn halves(&self, place: DVec3) -> [[DVec3; 3]; 2] {
        let (_, u, _) = walls(ROOM)[self.wall];
        let [low, high] = self.spans[0];
        // Only what is upright has a horizon.
        let horizon = (place.z * u.normalize().z).clamp(low, high);
        [self.part([low, horizon], self.spans[1]), self.part([horizon, high], self.spans[1])]
    }
}

impl Room {
    fn measure(&self, readings: &mut Readings, names: &str, places: Vec<Place>) {
        let scene = Scene::build(&self.scene());
        for (name, place, normal) in places {
            let percent = 100.0 / self.outside.horizontal;
            let part = |samples| {
                let measured = Meter::new(&scene).samples(samples).irradiance(place, normal);
                let [value, standard_error] =
                    [measured.value, measured.standard_error].map(|part| part * percent as f32);
                Measurement { value, standard_error, ..measured }
            };
            let expected = percent * self.arriving(place, normal);
            readings.meter(format!("{names}{name}"), part, expected);
        }
    }

    fn scene(&self) -> SceneDescription {
        let mut scene = scene_for_paths(0.0);
        scene.environment = self.outside.description();
        let closed = walls(ROOM).into_iter().enumerate();
        let closed = closed.filter(|(number, _)| *number != self.opening.wall);
        let closed = closed.map(|(_, (corner, u, w))| [corner, u, w]);
        for [corner, u, w] in closed.chain(self.opening.frame()) {
            add(&mut scene, quad(corner, u, w));
        }
        if let Some(index) = self.pane {
            let [corner, u, w] = self.opening.part(self.opening.spans[0], self.opening.spans[1]);
            scene.materials.push(pane(index as f32));
            let material = scene.materials.len() - 1;
            add_with(&mut scene, quad(corner, u, w), material);
        }
        scene
    }

    /// Irradiance at a point, W·m⁻².
    fn arriving(&self, place: DVec3, normal: DVec3) -> f64 {
        let through = |[corner, u, w]: [DVec3; 3]| {
            let outward = u.cross(w);
            over_square(160, |st| {
                let to = corner + st.x * u + st.y * w - place;
                let (distance, from) = (to.length(), to.normalize());
                let left = self.pane.map_or(1.0, |index| {
                    passed(index, from.dot(outward.normalize_or_zero()).abs())
                });
                let solid_angle = from.dot(outward).abs() / (distance * distance);
                self.outside.radiance(from) * left * normal.dot(from).max(0.0) * solid_angle
            })
        };
        self.opening.halves(place).into_iter().map(through).sum()
    }
}

/// What a clear pane lets through at the cosine of an angle, after all reflections inside (Fresnel; Stokes 1862).
fn passed(index: f64, cos: f64) -> f64 {
    let inner = (1.0 - (1.0 - cos * cos) / (index * index)).sqrt();
    let [s, p] = [
        (cos - index * inner) / (cos + index * inner),
        (index * cos - inner) / (index * cos + inner),
    ];
    let reflected = 0.5 * (s * s + p * p);
    (1.0 - reflected) / (1.0 + reflected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::closed_forms::{polygon, rectangle};

    fn roof_of(sky: u8, side: f64, pane: Option<f64>) -> Room {
        let outside = Outside::new(sky, 0.0, v(0.0, 0.5, 0.75_f64.sqrt()));
        Room { outside, opening: Opening::centred(CEILING, [side; 2]), pane }
    }

    /// What is expected of a room at the point of that name, in percent.
    fn expected(room: &Room, places: Vec<Place>, at: &str) -> f64 {
        let (_, place, normal) =
            places.into_iter().find(|(name, ..)| name == at).expect("it is one of them");
        100.0 * room.arriving(place, normal) / room.outside.horizontal
    }

    #[test]
    fn uniform_skies_are_polygons() {
        for side in [1.0, 4.0] {
            let room = roof_of(5, side, None);
            assert!((room.outside.horizontal / PI - 1.0).abs() < 1e-9);
            let [corner, u, w] = room.opening.part(room.opening.spans[0], room.opening.spans[1]);
            for (_, place, normal) in wall_and_floor() {
                let exact = polygon(place, normal, &rectangle(corner, u, w));
                assert!((room.arriving(place, normal) / exact - 1.0).abs() < 1e-5);
            }
        }
    }

    /// Reference cases Q59 to Q511: at the top and the bottom of a wall and beside it on the floor, by another quadrature.
    #[test]
    fn openings_give_what_others_have_found() {
        for (number, all) in [
            (1, [35.8228502, 14.3601419, 31.8575248, 43.3242775]),
            (2, [40.3685391, 19.7474037, 41.9615089, 50.0829817]),
            (3, [40.9624711, 13.5899358, 29.1471062, 39.1960842]),
            (4, [45.3442639, 18.9967879, 39.1369883, 46.1639051]),
            (5, [45.1226036, 12.9673724, 26.7951875, 35.5665925]),
            (6, [49.5752602, 18.3773506, 36.5891112, 42.5701489]),
            (7, [51.5024494, 22.7084411, 44.0249399, 47.1227147]),
            (8, [53.1016854, 26.5634499, 50.5774783, 51.1136169]),
            (9, [60.2953350, 16.7554063, 30.6723087, 34.4098025]),
            (10, [61.7363471, 21.0545892, 37.7789375, 38.9775647]),
            (11, [62.9198349, 25.0190759, 44.3039387, 43.1602856]),
            (12, [67.278023, 24.1954735, 42.2831133, 40.9150653]),
            (13, [68.1528968, 27.0769707, 47.0132978, 44.0391898]),
            (14, [73.3281661, 26.1323459, 44.8958038, 41.8215301]),
            (15, [74.7952815, 28.2147803, 48.3589904, 44.3362507]),
        ] {
            let room = roof_of(number, 4.0, None);
            for (at, value) in ["A", "F", "G", "J"].into_iter().zip(all) {
                let found = expected(&room, wall_and_floor(), at);
                assert!((found / value - 1.0).abs() < 1e-4, "{number} {at}: {found}");
            }
        }
        let glazed = roof_of(5, 1.0, Some(1.52));
        for (at, value) in [("A", 0.362037327), ("F", 1.16016243), ("J", 3.0919003)] {
            let found = expected(&glazed, wall_and_floor(), at);
            assert!((found / value - 1.0).abs() < 1e-4, "glazed {at}: {found}");
        }
        for (number, lowest, floor) in
            [(2, 1.82990035, 13.6548667), (9, 4.8181624, 10.3033798), (15, 5.5804167, 19.2752406)]
        {
            let outside = Outside::new(number, GROUND, v(0.0, -0.5, 0.75_f64.sqrt()));
            let opening = Opening::centred(FRONT, [1.0, 2.0]);
            let facade = Room { outside, opening, pane: None };
            for (at, value) in [("A", 0.950682247), ("F", lowest), ("M", floor)] {
                let found = expected(&facade, all_around(), at);
                assert!((found / value - 1.0).abs() < 1e-4, "facade {number} {at}: {found}");
            }
        }
    }
}
