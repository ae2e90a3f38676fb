//! In which order a ray visits the boxes of a node that it meets: by the signs of its direction alone, so that nothing
//! is compared and nothing branches.
//!
//! Each bit of a slot's number stands for an axis, set for the side of larger coordinates, and the builder puts each
//! child into the slot of the corner where it lies, as far as these are free. A ray whose direction is negative along
//! the axes in `octant` comes to slot `octant` first. After Ylitie, Karras, Laine, *Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs*, HPG 2017, section 3.2.

use crate::geometry::Bounds;
use crate::simd::LANES;
use glam::Vec3;

/// How many sets of slots there are.
const SETS: usize = 1 << LANES;

/// The order for rays with the same signs; for those with the opposite signs, the reverse.
pub(super) struct Order {
    /// The slots of each set, the first last, so that it comes to lie on top of a stack.
    slots: [[u8; LANES]; SETS],
    /// The first slot of each set.
    first: [u8; SETS],
}

static ORDERS: [Order; 8] = {
    let mut orders = [const { Order { slots: [[0; LANES]; SETS], first: [0; SETS] } }; 8];
    let mut i = 0;
    while i < 8 * SETS * LANES {
        let (octant, set, from_far) = (i / LANES / SETS, i / LANES % SETS, i % LANES);
        let slot = (LANES - 1 - from_far) ^ octant;
        if set >> slot & 1 == 1 {
            let mut farther = 0;
            let mut j = 0;
            while j < from_far {
                farther += set >> ((LANES - 1 - j) ^ octant) & 1;
                j += 1;
            }
            orders[octant].slots[set][farther] = slot as u8;
            orders[octant].first[set] = slot as u8;
        }
        i += 1;
    }
    orders
};

impl Order {
    /// The nearest first for directions whose signs are the lowest bits of `octant`.
    #[inline(always)]
    pub(super) fn of(octant: u32) -> &'static Self {
        &ORDERS[octant as usize % 8]
    }

    /// The slots of a set, the first last.
    #[inline(always)]
    pub(super) fn slots(&self, set: u32) -> &[u8; LANES] {
        &self.slots[set as usize % SETS]
    }

    /// The first slot of a set; 0 of none.
    #[inline(always)]
    pub(super) fn first(&self, set: u32) -> usize {
        usize::from(self.first[set as usize % SETS]) % LANES
    }
}

/// Slots for at most eight children: of all pairs of one and a free slot, the one that fits best is settled first.
pub(crate) fn slots_for(children: &[Bounds]) -> [usize; LANES] {
    let all = children.iter().copied().fold(Bounds::EMPTY, Bounds::union);
    let mut slots = [LANES; LANES];
    for _ in children {
        let free = |slot: &usize| !slots.contains(slot);
        let open = (0..children.len()).filter(|&child| slots[child] == LANES);
        let pairs = open.flat_map(|child| (0..LANES).filter(free).map(move |slot| (child, slot)));
        let fit = |&(child, slot): &(usize, usize)| {
            let from_middle = (children[child].lo + children[child].hi) - (all.lo + all.hi);
            from_middle.dot(corner(slot))
        };
        let best = pairs.max_by(|a, b| fit(a).total_cmp(&fit(b)));
        let Some((child, slot)) = best else { break };
        slots[child] = slot;
    }
    slots
}

/// The direction of a slot's corner, not of unit length.
fn corner(slot: usize) -> Vec3 {
    let side = |axis: usize| if slot >> axis & 1 == 1 { 1.0 } else { -1.0 };
    Vec3::new(side(0), side(1), side(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_is_visited_whole_and_the_nearest_first() {
        for octant in 0..8 {
            let order = Order::of(octant as u32);
            for set in 0..SETS as u32 {
                let slots = order.slots(set).map(usize::from);
                let visited = &slots[..set.count_ones() as usize];
                assert_eq!(visited.iter().fold(0, |all, slot| all | 1 << slot), set);
                assert!(visited.is_sorted_by(|a, b| a ^ octant > b ^ octant));
                assert!(visited.last().is_none_or(|&slot| slot == order.first(set)));
            }
            let mut backward = *Order::of(!octant as u32).slots(0xff);
            backward.reverse();
            assert_eq!(backward, *order.slots(0xff));
            // A direction with these signs comes from the corner of slot `octant`.
            assert_eq!(order.first(0xff), octant);
            assert_eq!((-corner(octant)).is_negative_bitmask(), octant as u32);
        }
    }

    #[test]
    fn children_go_to_their_corners_and_never_to_the_same() {
        let at = |slot: usize| {
            let middle = 10.0 * corner(slot) + Vec3::new(0.1, 0.2, 0.3) * slot as f32;
            Bounds { lo: middle - Vec3::ONE, hi: middle + Vec3::ONE }
        };
        let corners: Vec<_> = [3, 0, 7, 5, 6, 1, 2, 4].map(at).to_vec();
        assert_eq!(slots_for(&corners), [3, 0, 7, 5, 6, 1, 2, 4]);
        assert_eq!(slots_for(&corners[..2])[..2], [7, 0]);
        let alike = slots_for(&[at(5); LANES]);
        assert!((0..LANES).all(|slot| alike.contains(&slot)));
    }
}
