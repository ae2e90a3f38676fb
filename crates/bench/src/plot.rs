//! A bar chart of ratios as SVG.

use crate::report::Report;
use std::fmt::Write;
use std::path::Path;

/// Width and height of a bar's row, px.
const ROW: [f64; 2] = [640.0, 22.0];
/// Where bars begin, px.
const LEFT: f64 = 190.0;
/// Colours of the bars: against Embree's default and its robust mode.
const COLORS: [&str; 2] = ["#4878a8", "#9dbfdd"];

/// Draws our speed relative to Embree's for each kind of ray and number of threads.
///
/// # Errors
/// If the file cannot be written.
pub(crate) fn write(path: &Path, report: &Report) -> Result<(), String> {
    std::fs::write(path, svg(report)).map_err(|error| format!("{}: {error}", path.display()))
}

fn svg(report: &Report) -> String {
    let means = report.means();
    let longest = means.iter().flat_map(|(.., means)| means).fold(1.0, |a: f64, b| a.max(*b));
    let scale = (ROW[0] - LEFT - 50.0) / longest;
    let height = ROW[1] * (means.len() as f64 + 2.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        ROW[0]
    );
    let text = |svg: &mut String, x: f64, y: f64, what: &str| {
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\">{what}</text>");
    };
    text(
        &mut svg,
        8.0,
        15.0,
        "Rays per second, ours to Embree's best mode: default (dark), robust (light)",
    );
    for (i, (work, threads, means)) in means.iter().enumerate() {
        let y = ROW[1] * (i as f64 + 1.0);
        text(&mut svg, 8.0, y + 14.0, &format!("{}, {threads} thr.", work.name()));
        for (bar, (mean, color)) in means.iter().zip(COLORS).enumerate() {
            let (top, width) = (y + 2.0 + 9.0 * bar as f64, mean * scale);
            let _ = writeln!(
                svg,
                "<rect x=\"{LEFT}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"9\" fill=\"{color}\"/>"
            );
            text(&mut svg, LEFT + width + 4.0, top + 8.5, &format!("{mean:.2}"));
        }
    }
    let (one, bottom) = (LEFT + scale, height - 16.0);
    let _ = writeln!(
        svg,
        "<line x1=\"{one:.1}\" y1=\"22\" x2=\"{one:.1}\" y2=\"{bottom:.1}\" stroke=\"black\"/>\n</svg>"
    );
    svg
}
