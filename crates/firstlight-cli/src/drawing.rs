//! An explanation as a drawing: the rays, blocked ones black.

use firstlight::explain::{Explanation, Step, Verdict};
use glam::{DMat3, DVec2, DVec3, Vec3};
use std::fmt::Write;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 600.0;
const MARGIN: f64 = 60.0;
/// Rays that leave the scene are drawn as long as this part of the drawing's extent.
const TO_INFINITY: f64 = 0.35;

/// One line of the drawing.
struct Line {
    from: DVec3,
    to: DVec3,
    class: &'static str,
    label: String,
}

/// The drawing as an SVG file.
pub(crate) fn svg(explanation: &Explanation) -> String {
    let points: Vec<DVec3> = explanation.path.iter().flat_map(places).collect();
    let reach = TO_INFINITY * extent(&points).max(1e-6);
    let lines: Vec<Line> =
        explanation.path.iter().enumerate().flat_map(|(i, step)| lines(i, step, reach)).collect();
    let ends: Vec<DVec3> = lines.iter().flat_map(|line| [line.from, line.to]).collect();
    let page = Page::around(&ends);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"14\">\n<style>line{{stroke-width:2}}.seen{{stroke:#2563eb}}.bounce{{stroke:#7c3aed}}\
         .lit{{stroke:#f59e0b}}.blocked{{stroke:#000}}.normal{{stroke:#9ca3af;stroke-dasharray:4 3}}</style>\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    let mut labels = Labels::default();
    for line in &lines {
        let (from, to) = (page.place(line.from), page.place(line.to));
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            "<line class=\"{}\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>",
            line.class, from.x, from.y, to.x, to.y
        );
        if line.class == "blocked" {
            let _ = writeln!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\"/>", to.x, to.y);
        }
        labels.add(&mut svg, to, &line.label);
    }
    if let Some(step) = explanation.path.first() {
        labels.add(&mut svg, page.place(double(step.origin)), "eye");
    }
    let _ = writeln!(
        svg,
        "<text x=\"20\" y=\"{}\">{}</text>\n</svg>",
        HEIGHT - 20.0,
        escaped(&explanation.cause.text)
    );
    svg
}

/// Texts that do not lie on one another.
#[derive(Default)]
struct Labels(Vec<DVec2>);

impl Labels {
    fn add(&mut self, svg: &mut String, at: DVec2, text: &str) {
        if text.is_empty() {
            return;
        }
        let (width, edge) = (9.0 * text.chars().count() as f64, 12.0);
        let x = (at.x + 8.0).min(WIDTH - width - edge).max(edge);
        let mut place = DVec2::new(x, at.y - 6.0);
        let lies_on = |place: DVec2, other: &DVec2| {
            (place.y - other.y).abs() < 15.0 && (place.x - other.x).abs() < 160.0
        };
        while self.0.iter().any(|other| lies_on(place, other)) {
            place.y += 16.0;
        }
        self.0.push(place);
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            place.x,
            place.y,
            escaped(text)
        );
    }
}

fn double(place: [f32; 3]) -> DVec3 {
    Vec3::from(place).as_dvec3()
}

/// Where a step begins, and what it met.
fn places(step: &Step) -> impl Iterator<Item = DVec3> {
    let met = step.met.as_ref().map(|met| double(met.position));
    std::iter::once(double(step.origin)).chain(met)
}

fn extent(points: &[DVec3]) -> f64 {
    let most = |a: DVec3, b: &DVec3| a.max(*b);
    let least = |a: DVec3, b: &DVec3| a.min(*b);
    let Some(first) = points.first() else { return 1.0 };
    (points.iter().fold(*first, most) - points.iter().fold(*first, least)).length()
}

fn lines(number: usize, step: &Step, reach: f64) -> Vec<Line> {
    let class = if number == 0 { "seen" } else { "bounce" };
    let from = double(step.origin);
    let Some(met) = &step.met else {
        let to = from + reach * double(step.direction);
        return vec![Line { from, to, class, label: String::new() }];
    };
    let at = double(met.position);
    let mut lines = vec![Line { from, to: at, class, label: met.surface.clone() }];
    let normal = at + 0.3 * reach * double(met.shading_normal);
    lines.push(Line { from: at, to: normal, class: "normal", label: String::new() });
    for light in &step.lights {
        let Some(incoming) = light.incoming.map(double) else { continue };
        let distance = light.distance.map_or(reach, f64::from);
        let (to, class, label) = match &light.verdict {
            Verdict::Lit | Verdict::Tinted { .. } | Verdict::Unshadowed => {
                (at + distance * incoming, "lit", light.source.clone())
            }
            Verdict::Blocked { by, at: place, .. } => {
                (double(*place), "blocked", format!("{} blocked by {by}", light.source))
            }
            _ => continue,
        };
        lines.push(Line { from: at, to, class, label });
    }
    lines
}

/// From the world to the page: onto the plane in which the points are spread most.
struct Page {
    axes: [DVec3; 2],
    middle: DVec2,
    scale: f64,
}

impl Page {
    fn around(points: &[DVec3]) -> Self {
        let axes = spread(points);
        let flat: Vec<DVec2> =
            points.iter().map(|p| DVec2::new(p.dot(axes[0]), p.dot(axes[1]))).collect();
        let first = flat.first().copied().unwrap_or_default();
        let (lo, hi) = flat.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let room = DVec2::new(WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN);
        let scale = (room / (hi - lo).max(DVec2::splat(1e-9))).min_element();
        Self { axes, middle: 0.5 * (lo + hi), scale }
    }

    fn place(&self, point: DVec3) -> DVec2 {
        let flat = DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1])) - self.middle;
        DVec2::new(0.5 * WIDTH + self.scale * flat.x, 0.5 * HEIGHT - self.scale * flat.y)
    }
}

/// Two axes that span the plane of the points, the second one as upright as it can be.
fn spread(points: &[DVec3]) -> [DVec3; 2] {
    let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let outer = |d: DVec3| DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    let covariance = points.iter().fold(DMat3::ZERO, |sum, p| sum + outer(*p - mean));
    let first = strongest(covariance, DVec3::new(0.9, 0.4, 0.1));
    let rest = covariance - outer(first) * first.dot(covariance * first);
    let across = strongest(rest, first.any_orthonormal_vector());
    let normal = first.cross(across).try_normalize().unwrap_or(DVec3::Y);
    let up = (DVec3::Z - DVec3::Z.dot(normal) * normal).try_normalize().unwrap_or(first);
    [up.cross(normal), up]
}

/// The direction that a symmetric matrix stretches most.
fn strongest(matrix: DMat3, start: DVec3) -> DVec3 {
    (0..64).fold(start, |v, _| (matrix * v).try_normalize().unwrap_or(v))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
