//! What the library's doctor finds, as far as the user wants to hear it.

use crate::args::FindingArgs;
use crate::render::Picture;
use firstlight::Noise;
use firstlight::SceneDescription;
use firstlight::diagnostic::Diagnostic;
use firstlight::doctor::Shown;
use firstlight::io::{Format, Warnings};

/// A warning if a background is to be transparent in a format that is not.
pub(crate) fn opaque(scene: &SceneDescription, format: Format) -> Option<Diagnostic> {
    let opaque = scene.film.transparent && matches!(format, Format::Hdr | Format::Pfm);
    opaque.then(|| {
        Diagnostic::new("", "this format has no alpha: the transparent background will be black")
            .help("write a .png or .exr")
    })
}

impl FindingArgs {
    /// Those of the findings that are not to be ignored.
    pub(crate) fn heeded(&self, findings: Vec<Diagnostic>) -> Warnings {
        let ignored = |finding: &Diagnostic| self.ignore.iter().any(|code| code == finding.code);
        findings.into_iter().filter(|finding| !ignored(finding)).collect()
    }
}

/// A picture as its file will show it.
pub(crate) fn shown(picture: &Picture, noise: Option<Noise>) -> Shown<'_> {
    Shown {
        rendered: &picture.rendered,
        exposure_ev: picture.exposure_ev,
        auto_exposure: picture.auto_exposure,
        // Whether the exposure is part of the file.
        developed: matches!(picture.format, Format::Png { .. }),
        noise,
    }
}
