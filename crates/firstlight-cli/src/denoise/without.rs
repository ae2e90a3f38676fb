//! In place of the library where firstlight was built without the feature `denoise`: there is never one.

pub(super) enum Denoiser {}

impl Denoiser {
    pub(super) fn open(_: usize) -> Result<Self, String> {
        Err("this firstlight was built without Open Image Denoise".into())
    }

    pub(super) fn name(&self) -> String {
        match *self {}
    }

    pub(super) fn denoise(
        &self,
        _: &[[f32; 3]],
        _: [&[[f32; 3]]; 2],
        _: [usize; 2],
    ) -> Result<Vec<[f32; 3]>, String> {
        match *self {}
    }
}
