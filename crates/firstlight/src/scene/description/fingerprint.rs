//! A number that tells scenes apart.

use super::SceneDescription;
use crate::math::hash;
use std::fmt::{self, Write};

impl SceneDescription {
    /// 32 hexadecimal digits that are the same for the same scene and else, but for an unlikely accident, others.
    ///
    /// They are a hash of the scene's debug text, which shows every value there is with all of its digits, so that nothing
    /// that is added to scenes can be forgotten here.
    pub fn fingerprint(&self) -> String {
        let mut mixer = Mixer { state: [1, 2], pending: 0, count: 0 };
        // A mixer takes everything.
        let _ = write!(mixer, "{self:?}");
        mixer.take();
        let [a, b] = mixer.state;
        format!("{a:016x}{b:016x}")
    }
}

/// Mixes text into a number as it comes, eight bytes at a time.
struct Mixer {
    state: [u64; 2],
    /// Bytes that wait for more, and how many bytes there were.
    pending: u64,
    count: u64,
}

impl Mixer {
    fn take(&mut self) {
        let [a, b] = &mut self.state;
        *a = hash(*a ^ self.pending);
        *b = hash(b.rotate_left(23) ^ self.pending ^ self.count);
        self.pending = 0;
    }
}

impl Write for Mixer {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.pending = self.pending << 8 | u64::from(byte);
            self.count += 1;
            if self.count.is_multiple_of(8) {
                self.take();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::scene::description::Material;

    #[test]
    fn the_smallest_difference_shows() {
        let mut scene = SceneDescription::default();
        scene.materials.push(Material::matte("a", Rgb::splat(0.5)));
        let before = scene.fingerprint();
        assert_eq!(scene.clone().fingerprint(), before);
        assert_eq!(before.len(), 32);
        scene.materials[0].reflectance.factor[1] = 0.5_f32.next_up();
        assert_ne!(scene.fingerprint(), before);
        scene.materials[0].reflectance.factor[1] = 0.5;
        scene.film.seed = 1;
        assert_ne!(scene.fingerprint(), before);
    }
}
