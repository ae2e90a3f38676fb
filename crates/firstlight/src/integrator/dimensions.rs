//! Which pair of sample dimensions decides what. Pairs are never shared, so that no decision knows of another.

use crate::sampler::PathPoints;
use crate::scene::Scene;

/// The place around the pixel's centre.
pub(crate) const FILM: u32 = 0;
/// The place on the lens.
pub(crate) const LENS: u32 = 1;
/// When it is, while the shutter is open.
pub(crate) const TIME: u32 = 2;

/// When the sample with these points is, see [`Ray::time`](crate::Ray::time). Where nothing moves, time tells samples along one
/// ray apart if chance decides about them, and is 0 otherwise.
pub(super) fn time(scene: &Scene, points: &PathPoints) -> f32 {
    let moment = || points.pair(TIME).x;
    match scene.moves() {
        true => scene.camera().time(moment()),
        false if scene.has_blends => moment(),
        false => 0.0,
    }
}

/// The pairs of one reflection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounce(u32);

impl Bounce {
    /// Pairs of one reflection.
    const PAIRS: u32 = 64;
    /// Where those of suns and lights begin; there are as many as there is room for.
    const SUNS: u32 = 8;
    const LIGHTS: u32 = 16;
    /// Where the pairs of all reflections for lights that are asked in the air begin.
    const AIR: u32 = 1 << 31;

    /// Of the reflection with this number, from 0.
    pub(super) fn new(number: u32) -> Self {
        Self(Self::PAIRS * (number + 1))
    }

    /// Where the path goes on.
    pub(super) fn direction(self) -> u32 {
        self.0
    }

    /// How it is reflected, and whether it goes on at all.
    pub(super) fn choice(self) -> u32 {
        self.0 + 1
    }

    /// Where light from far away is looked for.
    pub(super) fn environment(self) -> u32 {
        self.0 + 2
    }

    /// Which light is asked for all.
    pub(super) fn pick(self) -> u32 {
        self.0 + 3
    }

    /// The colour channel that is followed.
    pub(super) fn channel(self) -> u32 {
        self.0 + 4
    }

    /// How far it goes in a medium until it arrives there.
    pub(super) fn flight(self) -> u32 {
        self.0 + 5
    }

    /// Where ambient light may be kept out, and by way of which lobe it is looked for.
    pub(super) fn ambient(self) -> [u32; 2] {
        [self.0 + 6, self.0 + 7]
    }

    /// The place on the sun with this number.
    pub(super) fn sun(self, number: u32) -> u32 {
        self.0 + Self::SUNS + number % (Self::LIGHTS - Self::SUNS)
    }

    /// Which light is asked for all in the air.
    pub(super) fn air_pick(self) -> u32 {
        Self::AIR + self.0
    }

    /// Where on a ray's way the light with this number is asked, and for which place on it.
    pub(super) fn air(self, number: u32) -> [u32; 2] {
        let place = Self::AIR + self.0 + 2 + 2 * (number % (Self::PAIRS / 2 - 1));
        [place, place + 1]
    }

    /// The place on the light with this number.
    pub(super) fn light(self, number: u32) -> u32 {
        self.0 + Self::LIGHTS + number % (Self::PAIRS - Self::LIGHTS)
    }
}
