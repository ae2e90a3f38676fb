//! The picture as numbers: linear RGBA radiance.

use crate::color::Rgb;

/// A picture of linear radiance with alpha, rows from the top. Colour is not multiplied by alpha.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 4]>,
}

impl Image {
    /// A black, opaque picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0, 0.0, 0.0, 1.0]; width as usize * height as usize] }
    }

    /// A picture from `width × height` RGBA pixels, row by row from the top.
    ///
    /// # Panics
    /// If the number of pixels is not `width × height`.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 4]>) -> Self {
        assert_eq!(
            pixels.len(),
            width as usize * height as usize,
            "pixels do not fill the picture"
        );
        Self { width, height, pixels }
    }

    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// The lecture's `image.set(ix, iy, c)`: an opaque colour at column `ix`, row `iy` from the top.
    pub fn set(&mut self, ix: u32, iy: u32, c: Rgb) {
        let index = self.index(ix, iy);
        self.pixels[index] = [c.x, c.y, c.z, 1.0];
    }

    /// The colour at column `ix`, row `iy` from the top.
    pub fn get(&self, ix: u32, iy: u32) -> Rgb {
        let [r, g, b, _] = self.pixels[self.index(ix, iy)];
        Rgb::new(r, g, b)
    }

    fn index(&self, ix: u32, iy: u32) -> usize {
        assert!(ix < self.width && iy < self.height, "pixel ({ix}, {iy}) is outside the picture");
        iy as usize * self.width as usize + ix as usize
    }
}
