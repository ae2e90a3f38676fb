//! Meshes made on the spot, for those who have none at hand: a scan-like ball and an architecture-like hall.

use firstlight::scene::description::Mesh;
use glam::{Vec2, Vec3, vec2, vec3};
use std::f32::consts::{PI, TAU};

/// A ball of radius 1 with bumps, of about so many triangles of about the same size, y up.
pub(crate) fn bumpy_ball(triangles: usize) -> Mesh {
    let rows = (0.5 * (triangles as f32).sqrt()) as u32;
    let mut mesh = Mesh::default();
    add_grid(&mut mesh, 2 * rows, rows, |u, v| {
        let (phi, theta) = (TAU * u, PI * v);
        let radius = 1.0 + 0.05 * (23.0 * theta).sin() * (31.0 * phi).cos() * theta.sin();
        let out = vec3(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        radius * out
    });
    mesh
}

/// Half the length, the height of the walls, half the width of the hall, m.
const HALL: Vec3 = vec3(18.0, 8.0, 8.0);

/// A vaulted hall with fluted columns, arches, lamps and things lying about: 300 thousand triangles from the size of
/// a wall to that of a finger, y up, metres.
pub(crate) fn hall() -> Mesh {
    let mut mesh = Mesh::default();
    add_shell(&mut mesh);
    for (side, number) in [-1.0, 1.0].iter().flat_map(|side| (0..10).map(move |i| (side, i))) {
        let foot = vec3(3.4 * number as f32 - 15.3, 0.0, 4.0 * side);
        add_column(&mut mesh, foot);
        add_arch(&mut mesh, foot + Vec3::Y * 5.0);
        add_lamp(&mut mesh, vec3(foot.x + 1.7, 4.6, foot.z));
    }
    let mut random = Random(1);
    (0..60).for_each(|_| add_vase(&mut mesh, &mut random));
    (0..1500).for_each(|_| add_box(&mut mesh, &mut random));
    mesh
}

/// Floor, walls in few large triangles, and a ribbed vault.
fn add_shell(mesh: &mut Mesh) {
    let h = HALL;
    add_grid(mesh, 36, 16, |u, v| vec3(across(u) * h.x, 0.0, across(v) * h.z));
    for side in [-1.0, 1.0] {
        add_grid(mesh, 6, 2, |u, v| vec3(across(u) * h.x, v * h.y, side * h.z));
        add_grid(mesh, 2, 2, |u, v| vec3(side * h.x, v * 1.5 * h.y, across(u) * h.z));
    }
    add_grid(mesh, 240, 80, |u, v| {
        let rib = 1.0 - 0.03 * (21.0 * PI * u).sin().abs().powi(8);
        let angle = PI * v;
        vec3(across(u) * h.x, h.y + 0.5 * h.y * rib * angle.sin(), -h.z * rib * angle.cos())
    });
}

fn add_column(mesh: &mut Mesh, foot: Vec3) {
    add_grid(mesh, 72, 36, |u, v| {
        let flutes = 1.0 - 0.08 * (12.0 * PI * u).sin().abs();
        let radius = 0.42 * flutes * (1.0 + 0.5 * (2.0 * v - 1.0).powi(8));
        foot + vec3(0.0, 5.0 * v, 0.0) + radius * around(u)
    });
}

/// Half a ring from one column to the next, standing at `foot`.
fn add_arch(mesh: &mut Mesh, foot: Vec3) {
    add_grid(mesh, 36, 20, |u, v| {
        let (angle, reach) = (PI * u, 1.7 + 0.3 * (TAU * v).cos());
        foot + vec3(1.7 - reach * angle.cos(), reach * angle.sin(), 0.3 * (TAU * v).sin())
    });
}

/// A ring of thin wire, hanging.
fn add_lamp(mesh: &mut Mesh, center: Vec3) {
    add_grid(mesh, 96, 8, |u, v| {
        let thickness = 0.02 * vec2((TAU * v).cos(), (TAU * v).sin());
        let wave = 0.06 * (24.0 * PI * u).sin();
        center + (0.5 + thickness.x) * around(u) + Vec3::Y * (thickness.y + wave)
    });
}

/// A vase somewhere on the floor.
fn add_vase(mesh: &mut Mesh, random: &mut Random) {
    let (place, size) = (random.on_floor(), 0.15 + 0.35 * random.unit());
    let (waist, twist) = (1.0 + 5.0 * random.unit(), 6.0 * random.unit());
    add_grid(mesh, 40, 24, |u, v| {
        let profile =
            0.35 + 0.25 * (waist * v + 0.5).sin() + 0.03 * (8.0 * TAU * u + twist * v).sin();
        place + size * (profile * around(u) + 2.0 * v * Vec3::Y)
    });
}

/// A box of some size, turned, on the floor.
fn add_box(mesh: &mut Mesh, random: &mut Random) {
    let (place, turn) = (random.on_floor(), Vec2::from_angle(TAU * random.unit()));
    let half = vec3(random.unit(), random.unit(), random.unit()).powf(3.0) * 0.4 + 0.01;
    let first = mesh.positions.len() as u32;
    for corner in 0..8_u32 {
        let sign = |axis: u32| (corner >> axis & 1) as f32 * 2.0 - 1.0;
        let flat = turn.rotate(vec2(sign(0) * half.x, sign(2) * half.z));
        mesh.positions.push(place + vec3(flat.x, half.y + sign(1) * half.y, flat.y));
    }
    for [a, b, c, d] in
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    {
        mesh.triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|corner| first + corner)));
    }
}

/// From 0..1 to −1..1.
fn across(u: f32) -> f32 {
    2.0 * u - 1.0
}

/// The horizontal unit vector at so many turns.
fn around(turns: f32) -> Vec3 {
    vec3((TAU * turns).cos(), 0.0, (TAU * turns).sin())
}

/// Adds a curved sheet of `columns` × `rows` quadrilaterals, `at` of 0..1 × 0..1.
fn add_grid(mesh: &mut Mesh, columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) {
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        let point = |column| at(column as f32 / columns as f32, row as f32 / rows as f32);
        mesh.positions.extend((0..=columns).map(point));
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let a = first + row * (columns + 1) + column;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        mesh.triangles.extend([[a, d, c], [a, c, b]]);
    }
}

/// Numbers that look random and are the same for everybody: Steele et al.'s SplitMix, OOPSLA 2014.
struct Random(u64);

impl Random {
    /// In 0..1.
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1 << 24) as f32
    }

    /// A place in the hall.
    fn on_floor(&mut self) -> Vec3 {
        vec3(across(self.unit()) * 0.95 * HALL.x, 0.0, across(self.unit()) * 0.95 * HALL.z)
    }
}
