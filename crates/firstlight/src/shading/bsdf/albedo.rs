//! How much light facets scatter once, from tables: what they lose is what was scattered several times.
//!
//! The tables are made by `cargo xtask tables`; `data/README.md` says how.

use super::sheen::Sheen;
use glam::{Vec2, Vec3, Vec3Swizzles};
use std::f32::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Values on a grid, read in between in proportion to the distances. All axes go from 0 to 1.
#[derive(Debug)]
pub(crate) struct Table<const AXES: usize> {
    sizes: [usize; AXES],
    /// Last axis fastest; 0 to 65535 is 0 to 1.
    values: Vec<u16>,
}

impl<const AXES: usize> Table<AXES> {
    fn read(sizes: [usize; AXES], bytes: &[u8]) -> Self {
        let values = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        Self { sizes, values }
    }

    /// The value at a place of the unit cube; places outside are moved to its surface.
    pub(crate) fn at(&self, place: [f32; AXES]) -> f32 {
        let mut corners = [(0, 1.0_f32); 16];
        let mut count = 1;
        for (size, x) in self.sizes.iter().zip(place) {
            let x = x.clamp(0.0, 1.0) * (size - 1) as f32;
            let low = (x as usize).min(size - 2);
            let part = x - low as f32;
            for i in 0..count {
                let (index, weight) = corners[i];
                corners[i] = (index * size + low, weight * (1.0 - part));
                corners[count + i] = (index * size + low + 1, weight * part);
            }
            count *= 2;
        }
        let sum = corners[..count].iter().map(|&(i, weight)| f32::from(self.values[i]) * weight);
        sum.sum::<f32>() / 65535.0
    }
}

/// Cosines and facets' widths are tabulated by (cosine, roughness) in this way: grazing angles count in units of the
/// width, below which facets hide each other.
fn place(cos: f32, alpha: f32) -> [f32; 2] {
    [alpha.sqrt(), cos * (1.0 + alpha) / (cos + alpha)]
}

/// The fraction of light from a direction above that GGX facets which reflect all of it scatter once, and what Schlick's
/// (1 − cos)⁵ would leave of that.
pub(crate) fn facets(direction: Vec3, alpha: Vec2) -> (f32, f32) {
    let seen = width_seen(direction, alpha);
    let all = if alpha.x == alpha.y {
        FACETS.at(place(direction.z, seen))
    } else {
        let [rough, stretch, turn] = shape_place(direction, alpha);
        BRUSHED.at([rough, stretch, turn, place(direction.z, seen)[1]])
    };
    (all, all * FACETS_GRAZING.at([seen.sqrt(), direction.z.sqrt()]))
}

/// The width of the facets along the plane of a direction.
fn width_seen(direction: Vec3, alpha: Vec2) -> f32 {
    let along = direction.xy().normalize_or(Vec2::X);
    (along * alpha).length()
}

/// Roughness of the narrow side, how much of the way to 1 the wide side's width is, and the direction's turn from the
/// wide side to the narrow one.
fn shape_place(direction: Vec3, alpha: Vec2) -> [f32; 3] {
    let (wide, narrow) = (alpha.max_element(), alpha.min_element());
    let stretch = ((wide - narrow) / (1.0 - narrow).max(1e-6)).sqrt();
    let across = if alpha.x >= alpha.y { direction.y } else { direction.x };
    let turn = (across.abs() / direction.xy().length().max(1e-9)).min(1.0).asin() / FRAC_PI_2;
    [narrow.sqrt(), stretch, turn]
}

/// The fraction of light from a direction above that a rough boundary of glass scatters once, to either side. `eta`:
/// index beyond over index here. Brushed glass is taken as ground evenly.
pub(crate) fn glass(direction: Vec3, alpha: Vec2, eta: f32) -> f32 {
    let (table, eta) = if eta >= 1.0 { (&GLASS_OUTSIDE, eta) } else { (&GLASS_INSIDE, 1.0 / eta) };
    let [rough, angle] = place(direction.z, (alpha.x * alpha.y).sqrt());
    // Where light grazes glass of nearly the same index, all changes quickly.
    table.at([index_place(eta), rough, (angle * angle).cbrt()])
}

/// The fraction of light from a direction that white sheen reflects, up to [`MOST_SHEEN`]: it is a formula for looks.
pub(crate) fn sheen(cos: f32, alpha: f32) -> f32 {
    let least = Sheen::LEAST.sqrt();
    MOST_SHEEN * SHEEN.at([(alpha.sqrt() - least) / (1.0 - least), cos.sqrt()])
}

/// Indices from 1 to 4, the low ones finely.
fn index_place(eta: f32) -> f32 {
    ((eta - 1.0) / 3.0).max(0.0).cbrt()
}

const MOST_SHEEN: f32 = 1.6;
const FACETS_SIZES: [usize; 2] = [32, 32];
const BRUSHED_SIZES: [usize; 4] = [14, 14, 9, 32];
const GLASS_SIZES: [usize; 3] = [32, 24, 48];
const SHEEN_SIZES: [usize; 2] = [32, 48];

static FACETS: LazyLock<Table<2>> =
    LazyLock::new(|| Table::read(FACETS_SIZES, include_bytes!("../../../data/facets.bin")));
static FACETS_GRAZING: LazyLock<Table<2>> =
    LazyLock::new(|| Table::read(FACETS_SIZES, include_bytes!("../../../data/facets-grazing.bin")));
static BRUSHED: LazyLock<Table<4>> = LazyLock::new(|| {
    Table::read(BRUSHED_SIZES, include_bytes!("../../../data/facets-brushed.bin"))
});
static GLASS_OUTSIDE: LazyLock<Table<3>> =
    LazyLock::new(|| Table::read(GLASS_SIZES, include_bytes!("../../../data/glass-outside.bin")));
static GLASS_INSIDE: LazyLock<Table<3>> =
    LazyLock::new(|| Table::read(GLASS_SIZES, include_bytes!("../../../data/glass-inside.bin")));
static SHEEN: LazyLock<Table<2>> =
    LazyLock::new(|| Table::read(SHEEN_SIZES, include_bytes!("../../../data/sheen.bin")));

/// Where the tables come from: integrals over the distribution of visible facets, by points spread evenly.
#[cfg(test)]
mod make {
    use super::super::fresnel::{dielectric, schlick_weight};
    use super::super::ggx::{Ggx, mirrored, refracted};
    use super::*;
    use rayon::prelude::*;
    use std::f32::consts::TAU;

    /// Points per value.
    const POINTS: u32 = 1 << 13;

    /// Roberts' sequence: evenly spread, without a seed.
    fn points() -> impl Iterator<Item = Vec2> {
        const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
        (0..POINTS).map(|i| {
            let [x, y] = STEP.map(|step| ((f64::from(i) + 0.5) * step).fract());
            Vec2::new(x as f32, y as f32)
        })
    }

    fn direction(cos: f32) -> Vec3 {
        Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
    }

    fn mean(value: impl Fn(Vec2) -> f32) -> f32 {
        (points().map(|u| f64::from(value(u))).sum::<f64>() / f64::from(POINTS)) as f32
    }

    fn integrate_facets(outgoing: Vec3, alpha: Vec2, weight: impl Fn(f32) -> f32) -> f32 {
        let facets = Ggx { alpha };
        mean(|u| {
            let m = facets.sample(outgoing, u);
            let incoming = mirrored(outgoing, m);
            if incoming.z <= 0.0 {
                return 0.0;
            }
            let hidden = facets.both_visible(outgoing, incoming) / facets.visible(outgoing);
            hidden * weight(outgoing.dot(m).clamp(0.0, 1.0))
        })
    }

    fn integrate_glass(cos: f32, alpha: f32, eta: f32) -> [f32; 2] {
        let (facets, outgoing) = (Ggx { alpha: Vec2::splat(alpha) }, direction(cos));
        let hidden = |incoming| facets.both_visible(outgoing, incoming) / facets.visible(outgoing);
        let share = |through: bool| {
            mean(|u| {
                let m = facets.sample(outgoing, u);
                let cos = outgoing.dot(m).clamp(0.0, 1.0);
                let (reflected, beyond) = dielectric(cos.into(), eta.into());
                let (reflected, beyond) = (reflected as f32, beyond.map(|cos| cos as f32));
                if !through {
                    let incoming = mirrored(outgoing, m);
                    return if incoming.z > 0.0 { reflected * hidden(incoming) } else { 0.0 };
                }
                let Some(beyond) = beyond else { return 0.0 };
                let incoming = refracted(outgoing, m, eta, beyond);
                if incoming.z < 0.0 { (1.0 - reflected) * hidden(incoming) } else { 0.0 }
            })
        };
        [share(false), share(true)]
    }

    fn integrate_sheen(cos: f32, alpha: f32) -> f32 {
        const STEPS: u32 = 128;
        let (sheen, outgoing) = (Sheen { alpha }, direction(cos));
        let mut sum = 0.0;
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            // Grazing directions and those near the plane of incidence count most.
            let part = |i: u32| (i as f32 + 0.5) / STEPS as f32;
            let (z, turn) = (part(i) * part(i), part(j) * part(j));
            let (sin, cos) = (0.5 * TAU * turn).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let incoming = Vec3::new(across * cos, across * sin, z);
            let cell = TAU * 4.0 * part(i) * part(j) / (STEPS * STEPS) as f32;
            sum += f64::from(sheen.value(outgoing, incoming) * z * cell);
        }
        sum as f32
    }

    /// The inverse of [`place`].
    fn unplace(rough: f32, angle: f32) -> (f32, f32) {
        let alpha = (rough * rough).max(1e-4);
        ((angle * alpha / (1.0 + alpha - angle)).max(1e-4 * alpha).min(1.0), alpha)
    }

    fn grid<const AXES: usize>(
        sizes: [usize; AXES],
        value: impl Fn([f32; AXES]) -> f32 + Sync,
    ) -> Vec<u8> {
        let total = sizes.iter().product::<usize>();
        let at = |index: usize| {
            let (mut rest, mut place) = (index, [0.0; AXES]);
            for axis in (0..AXES).rev() {
                place[axis] = (rest % sizes[axis]) as f32 / (sizes[axis] - 1) as f32;
                rest /= sizes[axis];
            }
            (value(place).clamp(0.0, 1.0) * 65535.0).round() as u16
        };
        let values: Vec<u16> = (0..total).into_par_iter().map(at).collect();
        values.into_iter().flat_map(u16::to_le_bytes).collect()
    }

    #[test]
    #[ignore = "writes the tables: cargo xtask tables"]
    fn write_the_tables() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
        let write = |name: &str, bytes: Vec<u8>| std::fs::write(folder.join(name), bytes).unwrap();
        let facets = |[rough, angle]: [f32; 2]| {
            let (cos, alpha) = unplace(rough, angle);
            integrate_facets(direction(cos), Vec2::splat(alpha), |_| 1.0)
        };
        write("facets.bin", grid(FACETS_SIZES, facets));
        let grazing = |[rough, angle]: [f32; 2]| {
            let (cos, alpha) = ((angle * angle).max(1e-6), (rough * rough).max(1e-4));
            let integral = |weight: fn(f32) -> f32| {
                integrate_facets(direction(cos), Vec2::splat(alpha), weight)
            };
            integral(schlick_weight) / integral(|_| 1.0)
        };
        write("facets-grazing.bin", grid(FACETS_SIZES, grazing));
        let brushed = |[rough, stretch, turn, angle]: [f32; 4]| {
            let narrow = (rough * rough).clamp(1e-4, 0.9999);
            let wide = narrow + (1.0 - narrow) * stretch * stretch;
            let (sin, cos) = (turn * FRAC_PI_2).sin_cos();
            let alpha = Vec2::new(wide, narrow);
            let seen = (Vec2::new(cos, sin) * alpha).length();
            let (up, _) = unplace(seen.sqrt(), angle);
            let across = (1.0 - up * up).max(0.0).sqrt();
            integrate_facets(Vec3::new(across * cos, across * sin, up), alpha, |_| 1.0)
        };
        write("facets-brushed.bin", grid(BRUSHED_SIZES, brushed));
        let glass = |inside: bool| {
            grid(GLASS_SIZES, |[index, rough, angle]| {
                let (cos, alpha) = unplace(rough, angle * angle.sqrt());
                let eta = 1.0 + 3.0 * index * index * index;
                integrate_glass(cos, alpha, if inside { 1.0 / eta } else { eta }).iter().sum()
            })
        };
        write("glass-outside.bin", glass(false));
        write("glass-inside.bin", glass(true));
        let sheen = |[rough, angle]: [f32; 2]| {
            let rough = rough + (1.0 - rough) * Sheen::LEAST.sqrt();
            integrate_sheen((angle * angle).max(1e-6), rough * rough) / MOST_SHEEN
        };
        write("sheen.bin", grid(SHEEN_SIZES, sheen));
    }
}
