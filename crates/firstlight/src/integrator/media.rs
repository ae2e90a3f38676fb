//! Which transparent solids a path is in.

use crate::geometry::Ray;
use crate::scene::description::{Interior, Material, Medium};
use crate::scene::{Boundary, Everything, Scene};
use glam::Vec3;

/// Solids that a path may be in at once; what is entered beyond that is not seen.
const MOST: usize = 6;
/// Surfaces that are looked at to find out what is around a point.
const MOST_AROUND: u32 = 1000;
/// Where that is looked for: along no edge that people model.
const SOMEWHERE: Vec3 = Vec3::new(0.359, 0.4817, 0.7993);

/// The solids around a point, by their materials, in the order in which light entered them.
///
/// Schmidt & Budge, *Simple Nested Dielectrics in Ray Traced Images*, 2002: where solids overlap, the one of highest
/// priority counts, and boundaries of others are not there. Of equals, the one entered last counts, so that a ball in
/// a liquid needs no priorities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Media {
    materials: [u32; MOST],
    count: u8,
}

/// A surface of a solid that a path has met.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Where the path comes from.
    pub before: Media,
    /// Where it is if it goes on to the other side.
    pub beyond: Media,
    /// The boundary; `None` if a solid of higher priority hides it.
    pub boundary: Option<Boundary>,
}

/// The solids around where paths start, found once for those that start at one place and time, as most do.
#[derive(Default)]
pub(super) struct Around(Option<((Vec3, f32), Media)>);

impl Around {
    /// The solids around a point, m, at a time.
    #[inline(always)]
    pub(super) fn media(&mut self, scene: &Scene, point: Vec3, time: f32) -> Media {
        if !scene.has_solids {
            return Media::default();
        }
        match self.0 {
            Some((known, media)) if known == (point, time) => media,
            _ => self.0.insert(((point, time), Media::around(scene, point, time))).1,
        }
    }
}

impl Media {
    /// Crosses a surface of the solid of `material`, from its front or its back. `channel`: the one that the path is
    /// followed for, if the index depends on it.
    pub(super) fn cross(
        self,
        scene: &Scene,
        material: u32,
        front: bool,
        channel: Option<u8>,
    ) -> Crossing {
        // A path that starts inside of a solid learns of it where it leaves.
        let before = if front || self.contains(material) { self } else { self.with(material) };
        let beyond = if front { before.with(material) } else { before.without(material) };
        let (here, there) = (before.innermost(scene), beyond.innermost(scene));
        let index = |medium: Option<u32>| {
            medium.map_or(1.0, |m| index(&scene.materials[m as usize], channel))
        };
        let outer = if front { there } else { here };
        let boundary = (outer == Some(material))
            .then(|| Boundary { eta: index(there) / index(here), inside: !front });
        Crossing { before, beyond, boundary }
    }

    /// What is around, where it counts.
    #[inline(always)]
    pub(super) fn interior<'a>(&self, scene: &'a Scene) -> Option<&'a Interior> {
        if self.count == 0 {
            return None;
        }
        scene.materials[self.innermost(scene)? as usize].interior.as_ref()
    }

    /// What fills the space there, if anything does.
    #[inline(always)]
    pub(super) fn medium(&self, scene: &Scene) -> Option<Medium> {
        self.interior(scene).map(Interior::medium).or(scene.medium)
    }

    /// The solids around a point, m, at a time. They have to be known before they are left: what is met inside of them is seen
    /// through them.
    fn around(scene: &Scene, point: Vec3, time: f32) -> Self {
        let (mut found, mut entered) = (Vec::new(), Self::default());
        let mut ray = Ray { time, ..Ray::new(point, SOMEWHERE.normalize()) };
        let mut hits = Vec::new();
        for _ in 0..MOST_AROUND {
            scene.world.closest_hits(&[ray], &Everything, &mut hits);
            let Some(hit) = hits.first().filter(|hit| hit.is_some()) else { break };
            let at = scene.interaction(&ray, hit);
            let material = scene.material_of[hit.surface as usize];
            match scene.material(hit).interior {
                Some(_) if at.front => entered = entered.with(material),
                Some(_) if entered.contains(material) => entered = entered.without(material),
                Some(_) => found.push(material),
                None => {}
            }
            ray = Ray { origin: at.behind(), ..ray };
        }
        // The last to be left was the first to be entered.
        found.into_iter().rev().fold(Self::default(), Self::with)
    }

    /// The material that counts.
    fn innermost(&self, scene: &Scene) -> Option<u32> {
        let priority = |m: u32| scene.materials[m as usize].interior.map_or(0, |i| i.priority);
        self.inside().iter().copied().max_by_key(|&material| priority(material))
    }

    fn inside(&self) -> &[u32] {
        &self.materials[..usize::from(self.count)]
    }

    fn contains(&self, material: u32) -> bool {
        self.inside().contains(&material)
    }

    fn with(mut self, material: u32) -> Self {
        if usize::from(self.count) < MOST {
            self.materials[usize::from(self.count)] = material;
            self.count += 1;
        }
        self
    }

    /// Without the one of that material that was entered last.
    fn without(mut self, material: u32) -> Self {
        if let Some(place) = self.inside().iter().rposition(|&inside| inside == material) {
            self.materials[place..usize::from(self.count)].rotate_left(1);
            self.count -= 1;
        }
        self
    }
}

fn index(material: &Material, channel: Option<u8>) -> f32 {
    material.interior.map_or(1.0, |interior| match channel {
        Some(channel) => interior.index_of(channel.into()),
        None => interior.index,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneDescription;
    use crate::color::Rgb;

    /// A scene with solids of these indices and priorities.
    fn scene(solids: &[(f32, i32)]) -> Scene {
        let material = |&(index, priority): &(f32, i32)| {
            let interior = Some(Interior { priority, ..Interior::clear(index) });
            Material { interior, ..Material::matte("solid", Rgb::ONE) }
        };
        let materials = solids.iter().map(material).collect();
        Scene::build(&SceneDescription { materials, ..SceneDescription::default() })
    }

    fn eta(crossing: &Crossing) -> Option<f32> {
        crossing.boundary.map(|boundary| boundary.eta)
    }

    #[test]
    fn a_ball_in_water_is_entered_from_water_and_left_to_it() {
        let scene = scene(&[(1.33, 0), (1.5, 0)]);
        let into_water = Media::default().cross(&scene, 0, true, None);
        let into_ball = into_water.beyond.cross(&scene, 1, true, None);
        let out_of_ball = into_ball.beyond.cross(&scene, 1, false, None);
        let out_of_water = out_of_ball.beyond.cross(&scene, 0, false, None);
        assert_eq!(eta(&into_water), Some(1.33));
        assert_eq!(eta(&into_ball), Some(1.5 / 1.33));
        assert_eq!(eta(&out_of_ball), Some(1.33 / 1.5));
        assert_eq!(eta(&out_of_water), Some(1.0 / 1.33));
        assert_eq!(out_of_water.beyond, Media { count: 0, ..out_of_water.beyond });
    }

    /// A liquid that reaches a little into its glass: its surface in the glass is not there, and the glass ends in liquid.
    #[test]
    fn the_higher_priority_hides_the_lower() {
        let scene = scene(&[(1.33, 0), (1.5, 1)]);
        let into_glass = Media::default().cross(&scene, 1, true, None);
        let hidden = into_glass.beyond.cross(&scene, 0, true, None);
        let into_liquid = hidden.beyond.cross(&scene, 1, false, None);
        assert_eq!(eta(&hidden), None);
        assert_eq!(eta(&into_liquid), Some(1.33 / 1.5));
        let back = into_liquid.beyond.cross(&scene, 1, true, None);
        assert_eq!(eta(&back), Some(1.5 / 1.33));
        assert_eq!(eta(&back.beyond.cross(&scene, 0, false, None)), None);
    }

    #[test]
    fn who_starts_inside_leaves_the_solid() {
        let scene = scene(&[(1.5, 0)]);
        let out = Media::default().cross(&scene, 0, false, None);
        assert_eq!((eta(&out), out.beyond.count), (Some(1.0 / 1.5), 0));
        assert_eq!(out.boundary.map(|boundary| boundary.inside), Some(true));
        let deep =
            (0..20).fold(Media::default(), |media, _| media.cross(&scene, 0, true, None).beyond);
        assert_eq!(usize::from(deep.count), MOST);
    }
}
