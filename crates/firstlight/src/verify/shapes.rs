//! Closed meshes that cases and tests shoot at.

use crate::scene::description::Mesh;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// A sphere of triangles: an icosahedron, each triangle cut into four `levels` times, with smooth normals.
pub fn icosphere(levels: u32) -> Mesh {
    let g = f64::midpoint(1.0, 5_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        corners.push(DVec3::new(a, b, 0.0));
        corners.push(DVec3::new(0.0, a, b));
        corners.push(DVec3::new(b, 0.0, a));
    }
    let mut positions: Vec<Vec3> = corners.iter().map(|p| p.normalize().as_vec3()).collect();
    let mut triangles = hull_of_icosahedron(&corners);
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let cut = triangles.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        triangles = cut.collect();
    }
    Mesh { normals: positions.clone(), positions, triangles, ..Mesh::default() }
}

fn hull_of_icosahedron(corners: &[DVec3]) -> Vec<[u32; 3]> {
    let near = |a: usize, b: usize| (corners[a] - corners[b]).length() < 2.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
                    let out = outward.dot(corners[a]) > 0.0;
                    triangles.push(if out { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    triangles
}

/// A closed, bumpy sphere around the origin, of `rows` × 2 `rows` quads cut in two.
pub fn bumpy_sphere(rows: u32) -> Mesh {
    let columns = 2 * rows;
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let theta = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let phi = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let r = 1.0 + 0.2 * (7.0 * theta).sin() * (5.0 * phi).cos() * theta.sin();
            let (sin, cos) = theta.sin_cos();
            let sin = if row == rows { 0.0 } else { sin };
            mesh.positions
                .push(DVec3::new(r * sin * phi.cos(), r * sin * phi.sin(), r * cos).as_vec3());
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let at = |r: u32, c: u32| r * columns + c % columns;
            let (a, b) = (at(row, column), at(row + 1, column));
            let (c, d) = (at(row + 1, column + 1), at(row, column + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// The surface of a Menger sponge of two levels inside −1..1: many axis-aligned, coplanar triangles. Each outer face
/// of each small cube that has no neighbour is two triangles.
pub fn menger_sponge() -> Mesh {
    let solid = |p: [i32; 3]| {
        p.iter().all(|c| (0..9).contains(c))
            && [1, 3].iter().all(|s| p.iter().filter(|c| *c / s % 3 == 1).count() < 2)
    };
    let mut mesh = Mesh::default();
    let mut index = HashMap::new();
    for cell in (0..729).map(|i| [i % 9, i / 9 % 9, i / 81]).filter(|&c| solid(c)) {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut neighbour = cell;
            neighbour[axis] += 2 * side - 1;
            if solid(neighbour) {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let ring = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                let mut p = cell;
                p[axis] += side;
                p[u] += du;
                p[v] += dv;
                *index.entry(p).or_insert_with(|| {
                    let coordinate = |c: i32| c as f32 / 4.5 - 1.0;
                    mesh.positions.push(Vec3::from_array(p.map(coordinate)));
                    mesh.positions.len() as u32 - 1
                })
            });
            let [a, b, c, d] = if side == 1 { ring } else { [ring[3], ring[2], ring[1], ring[0]] };
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}
