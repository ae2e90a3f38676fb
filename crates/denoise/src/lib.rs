//! Takes the noise out of pictures with Intel Open Image Denoise, version 2, on the processor.
//!
//! The library is loaded while the program runs, so that nothing needs it to be built or started. What comes out looks
//! clean and is an estimate: it is biased, and no number in it is to be relied on.

#![allow(unsafe_code, reason = "calls a C library")]

mod abi;
mod find;

use abi::{Functions, Handle};
use std::ffi::{CStr, c_char, c_int};
use std::path::Path;
use std::ptr::null;

/// Three numbers of a pixel.
pub type Pixel = [f32; 3];

/// Pixels around a picture, which mirror it: up to the edge of what it is shown, the library is out by several percent, and
/// in the corners by a third.
const MARGIN: usize = 16;

/// Open Image Denoise, ready to work.
pub struct Denoiser {
    functions: Functions,
    device: Handle,
}

impl Denoiser {
    /// Loads the library, from the folder that the environment's `OIDN_DIR` names, or else from where the system or the
    /// Python package `pyoidn` has it, and lets it use so many threads.
    ///
    /// # Errors
    /// If there is none, or none that can be used: what was tried and why it failed, in words to be printed.
    pub fn open(threads: usize) -> Result<Self, String> {
        let mut reasons = vec!["Open Image Denoise 2 is not to be had".to_owned()];
        for path in find::candidates() {
            match Self::load(&path, threads) {
                Ok(denoiser) => return Ok(denoiser),
                Err(reason) => reasons.push(reason),
            }
        }
        Err(reasons.join("; "))
    }

    fn load(path: &Path, threads: usize) -> Result<Self, String> {
        let functions = Functions::load(path)?;
        // SAFETY: the type of the device is one of the library's; the result is looked at when errors are asked for.
        let device = unsafe { (functions.new_device)(abi::CPU) };
        let denoiser = Self { functions, device };
        denoiser.check()?;
        denoiser.start(threads);
        denoiser.check()?;
        Ok(denoiser)
    }

    fn start(&self, threads: usize) {
        let Self { functions, device } = self;
        let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
        // SAFETY: the device is alive, and the names are C strings.
        unsafe {
            (functions.set_int)(*device, c"numThreads".as_ptr(), threads);
            // Several programs at once would all be pinned to the same processors.
            (functions.set_bool)(*device, c"setAffinity".as_ptr(), false);
            (functions.commit_device)(*device);
        }
    }

    /// The library, its version and what it works on: `Open Image Denoise 2.5.1 on the CPU`.
    pub fn name(&self) -> String {
        // SAFETY: the device is alive, and the name is a C string.
        let version =
            unsafe { (self.functions.get_int)(self.device, c"version".as_ptr()) }.unsigned_abs();
        let [major, minor, patch] = [version / 10_000, version / 100 % 100, version % 100];
        format!("Open Image Denoise {major}.{minor}.{patch} on the CPU")
    }

    /// Takes the noise out of linear radiance of any range, row by row of a picture of this width and height. The albedo
    /// (0..1) and the normal of what is seen in each pixel tell it what is no noise; where nothing is seen they are 0. What
    /// noise they have is taken out of them first.
    ///
    /// # Errors
    /// If the library fails: what it says.
    ///
    /// # Panics
    /// If the pixels do not fill the picture.
    pub fn denoise(
        &self,
        radiance: &[Pixel],
        [albedo, normal]: [&[Pixel]; 2],
        size: [usize; 2],
    ) -> Result<Vec<Pixel>, String> {
        let [mut color, mut albedo, mut normal] =
            [radiance, albedo, normal].map(|pixels| framed(pixels, size));
        self.filter(size, [(c"albedo", &mut albedo)], &[])?;
        self.filter(size, [(c"normal", &mut normal)], &[])?;
        let images = [(c"color", &mut color), (c"albedo", &mut albedo), (c"normal", &mut normal)];
        self.filter(size, images, &[c"hdr", c"cleanAux"])?;
        Ok(unframed(&color, size))
    }

    /// Runs the filter for ray traced pictures with these framed images and switches; the first image becomes what comes
    /// out.
    fn filter<const N: usize>(
        &self,
        size: [usize; 2],
        images: [(&CStr, &mut Vec<Pixel>); N],
        switches: &[&CStr],
    ) -> Result<(), String> {
        let (f, [width, height]) = (&self.functions, size.map(|side| side + 2 * MARGIN));
        let images = images.map(|(name, pixels)| {
            assert_eq!(pixels.len(), width * height, "pixels do not fill the picture");
            (name, pixels.as_mut_ptr().cast())
        });
        // SAFETY: the device is alive, names are C strings, and the images have that many pixels of three floats, which live
        // and are left alone until the filter is released. A filter that is null is refused by all functions.
        unsafe {
            let filter = (f.new_filter)(self.device, c"RT".as_ptr());
            for (name, pixels) in images.into_iter().chain([(c"output", images[0].1)]) {
                let (name, format) = (name.as_ptr(), abi::FLOAT3);
                (f.share_image)(filter, name, pixels, format, width, height, 0, 0, 0);
            }
            for name in switches {
                (f.set_filter_bool)(filter, name.as_ptr(), true);
            }
            (f.commit_filter)(filter);
            (f.execute)(filter);
            (f.release_filter)(filter);
        }
        self.check()
    }

    /// What has gone wrong, if anything.
    fn check(&self) -> Result<(), String> {
        let mut message: *const c_char = null();
        // SAFETY: the device is alive or null, which is allowed; the message is a C string that lives until the next call.
        let (code, message) = unsafe {
            let code = (self.functions.error)(self.device, &raw mut message);
            (code, (!message.is_null()).then(|| CStr::from_ptr(message).to_string_lossy()))
        };
        match (code, message) {
            (0, _) if !self.device.is_null() => Ok(()),
            (_, Some(message)) => Err(message.into_owned()),
            (code, None) => Err(format!("error {code} without a word")),
        }
    }
}

impl Drop for Denoiser {
    fn drop(&mut self) {
        if !self.device.is_null() {
            // SAFETY: the device is alive, and nothing else refers to it.
            unsafe { (self.functions.release_device)(self.device) };
        }
    }
}

/// The picture with its mirrored margin.
fn framed(pixels: &[Pixel], [width, height]: [usize; 2]) -> Vec<Pixel> {
    assert_eq!(pixels.len(), width * height, "pixels do not fill the picture");
    let rows = mirrored(height).map(|y| &pixels[y * width..][..width]);
    rows.flat_map(|row| mirrored(width).map(|x| row[x])).collect()
}

/// Places along a side of this length, and beyond both of its ends. What is at an end is not doubled: two bright pixels
/// side by side would be taken for a thing, not for noise.
fn mirrored(length: usize) -> impl Iterator<Item = usize> {
    let there_and_back = (0..length).chain((1..length.saturating_sub(1)).rev());
    let period = (2 * length).saturating_sub(2).max(1);
    let start = MARGIN.next_multiple_of(period) - MARGIN;
    there_and_back.cycle().skip(start).take(length + 2 * MARGIN)
}

/// The picture without its margin.
fn unframed(pixels: &[Pixel], [width, height]: [usize; 2]) -> Vec<Pixel> {
    let rows = pixels.chunks(width + 2 * MARGIN).skip(MARGIN).take(height);
    rows.flat_map(|row| &row[MARGIN..MARGIN + width]).copied().collect()
}

#[cfg(test)]
mod tests;
