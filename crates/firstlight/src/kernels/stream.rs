//! Closest hit and any hit of rays that have nothing in common but the tree and the signs of their directions: sixteen
//! are on their way at once and take turns, a node each.
//!
//! Contract: as `traverse`, with the same bits. What one ray has to wait for (memory, the end of a long chain of
//! operations) is filled with the steps of the others. For that nothing may branch on what a ray meets: its boxes are
//! packed onto its stack by a table (`order`), and who is where is kept in bits.

use super::alone::Walk;
use super::group::Group;
use super::layout::{Child, EntryPlanes, Node, Places, Target, Tree};
use super::order::Order;
use super::traverse::{Answer, FLATTENED, Others, Search, Slabs, Stack};
use super::triangles::Shear;
use crate::geometry::{Hit, Ray};
use crate::simd::{Eight, LANES, Lanes, MOST, Simd, Vectors};
use std::hint::select_unpredictable;

/// Rays that are on their way at once.
const WALKERS: usize = 16;
/// With no more than this at nodes, those at leaves come first.
const FEW: u32 = WALKERS as u32 / 2;
/// Trees with fewer nodes have a ray answered before turns pay.
const MANY: usize = 64;
/// Boxes that may wait for one ray.
const WAITING: usize = 128;
/// The deepest tree for which that is enough: seven wait at each node, eight at the last, and one place is kept free.
const DEPTH: usize = (WAITING - 2) / 7;

/// Numbers of rays that do not go together, by the signs of their directions.
#[derive(Default)]
pub(super) struct Strays([Vec<u32>; 8]);

impl Strays {
    /// None yet, if it pays to collect those that go through `tree`.
    #[inline(always)]
    pub(super) fn through<S: Simd>(tree: &Tree) -> Option<Self> {
        let pays = S::PERMUTES && tree.nodes.len() >= MANY && tree.depth <= DEPTH;
        pays.then(Self::default)
    }

    /// Adds rays that start with number `first`, but for those whose answer is known.
    #[inline(always)]
    pub(super) fn add<A: Answer<ANY>, const ANY: bool>(
        &mut self,
        first: usize,
        rays: &[Ray],
        (answers, known): (&mut [A], bool),
    ) {
        for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
            if !known {
                *answer = A::none(ray.t_max);
            }
            if !(ANY && answer.hit(ray.t_max).is_some()) {
                self.0[ray.octant() as usize % 8].push((first + i) as u32);
            }
        }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(Vec::is_empty)
    }

    /// Answers them; they are numbers of `walk`'s rays.
    #[inline(always)]
    pub(super) fn answer<S: Simd, O: Others, A: Answer<ANY>, const ANY: bool>(
        &self,
        simd: S,
        walk: Walk<O>,
        answers: &mut [A],
    ) {
        let mut walkers = std::array::from_fn(|_| Walker::nowhere(simd));
        let mut stream = Stream::new(simd, (walk, answers), &mut walkers);
        for (octant, rays) in self.0.iter().enumerate() {
            stream.answer::<ANY>(octant as u32, rays);
        }
    }
}

/// A ray on its way.
struct Walker<S: Simd> {
    slabs: Slabs<S>,
    shear: Shear<S>,
    ray: u32,
    /// How far it looks.
    t: f32,
    /// Where it is.
    at: Child,
    /// The place of what waits on top.
    top: usize,
    /// Where it will be, the next on top, and above that where it is: the bits of each [`Child`], and where the ray
    /// enters its box.
    waiting: [u32; WAITING + LANES],
    near: [f32; WAITING + LANES],
}

impl<S: Simd> Walker<S> {
    /// Nowhere.
    #[inline(always)]
    fn nowhere(simd: S) -> Self {
        let group = Group::<S::Rays>::EMPTY;
        Self {
            slabs: group.slabs_of(simd, 0),
            shear: group.shear_of(simd, 0),
            ray: 0,
            t: 0.0,
            at: Child::NOTHING,
            top: 0,
            waiting: [Child::NOTHING.bits(); WAITING + LANES],
            near: [f32::NEG_INFINITY; WAITING + LANES],
        }
    }

    /// Sets out from the root with one ray of a group.
    #[inline(always)]
    fn start(&mut self, simd: S, (group, lane): (&Group<S::Rays>, usize), ray: u32, t: f32) {
        (self.slabs, self.shear) = (group.slabs_of(simd, lane), group.shear_of(simd, lane));
        (self.ray, self.t, self.at, self.top) = (ray, t, Child::node(0), 0);
    }

    /// Goes from a node to the first in `order` of its boxes that the ray meets; the others wait. If there are none, to
    /// what waits there.
    #[inline(always)]
    fn step<const ANY: bool>(
        &mut self,
        simd: S,
        (entry, order): (&EntryPlanes, &Order),
        node: &Node,
    ) {
        let (met, near) = self.slabs.meet(entry, node, self.t);
        let (slots, top) = (order.slots(met), self.top % WAITING);
        let below = Child::from_bits(self.waiting[top]);
        let first = node.child(order.first(met));
        let children = simd.permute_words(node.children(), slots);
        self.waiting[top + 1..][..LANES].copy_from_slice(&children);
        if !ANY {
            self.near[top + 1..][..LANES].copy_from_slice(&near.permute(slots).to_array());
        }
        self.top = (top + met.count_ones() as usize).wrapping_sub(1);
        self.at = select_unpredictable(met == 0, below, first);
    }

    /// Goes on to the next that waits.
    #[inline(always)]
    fn leave(&mut self) {
        let top = self.top % WAITING;
        self.at = Child::from_bits(self.waiting[top]);
        self.top = top.wrapping_sub(1);
    }

    /// Whether it may find something nearer than its hit where it is.
    #[inline(always)]
    fn is_in_reach<const ANY: bool>(&self) -> bool {
        ANY || self.near[self.top.wrapping_add(1) % WAITING] <= self.t
    }

    /// Meets what is not a node, one after the other, until it comes to a node or is done.
    #[inline(always)]
    fn meet<O: Others, A: Answer<ANY>, const ANY: bool>(
        &mut self,
        simd: S,
        (walk, answers): (&Walk<O>, &mut [A]),
        stack: &mut Stack,
    ) {
        let number = self.ray as usize;
        let (ray, answer) = (&walk.rays[number], &mut answers[number]);
        let mut spare = Hit::none(ray.t_max);
        let hit = answer.hit_or(&mut spare);
        let search = Search { simd, ray, filter: walk.filter, flags: walk.flags };
        loop {
            let in_reach = self.is_in_reach::<ANY>();
            let found = match self.at.target() {
                Target::Block(index) if in_reach => {
                    let (block, shear) = (&walk.tree.blocks[index], &self.shear);
                    search.meet(walk.tree, block, ray, shear, FLATTENED, hit)
                }
                Target::Other(surface) if in_reach => {
                    walk.others.visit::<ANY>(&search.with(()), surface, hit, stack)
                }
                Target::Block(_) | Target::Other(_) => false,
                Target::Node(_) | Target::Nothing => return,
            };
            if ANY && found {
                self.at = Child::NOTHING;
                let any = A::of(hit);
                *answer = any;
                return;
            }
            self.t = hit.t;
            self.leave();
        }
    }
}

/// Numbers of walkers, as bits.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Set(u32);

impl Set {
    const NONE: Self = Self(0);
    const ALL: Self = Self((1 << WALKERS) - 1);

    fn is_empty(self) -> bool {
        self == Self::NONE
    }
}

impl Iterator for Set {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let (rest, first) = (self.0, self.0.trailing_zeros() as usize % WALKERS);
        self.0 &= rest.wrapping_sub(1);
        (rest != 0).then_some(first)
    }
}

/// Which walkers are where.
struct Crowd {
    at_nodes: Set,
    /// At leaves and other surfaces, and those that have been everywhere.
    elsewhere: Set,
    idle: Set,
}

impl Crowd {
    const IDLE: Self = Self { at_nodes: Set::NONE, elsewhere: Set::NONE, idle: Set::ALL };
}

/// Rays that walk through a tree in turns.
struct Stream<'a, S: Simd, O, A> {
    simd: S,
    walk: Walk<'a, O>,
    answers: &'a mut [A],
    places: Places,
    walkers: &'a mut [Walker<S>; WALKERS],
    /// The rays that set out next.
    group: Group<S::Rays>,
    /// For trees within the tree.
    inner: Stack,
}

impl<'a, S: Simd, O: Others, A> Stream<'a, S, O, A> {
    #[inline(always)]
    fn new(
        simd: S,
        (walk, answers): (Walk<'a, O>, &'a mut [A]),
        walkers: &'a mut [Walker<S>; WALKERS],
    ) -> Self {
        Self {
            simd,
            places: walk.tree.places(),
            walk,
            answers,
            walkers,
            group: Group::EMPTY,
            inner: Stack::new(),
        }
    }

    /// Answers `rays`, whose directions have the signs in `octant`.
    #[inline(always)]
    fn answer<const ANY: bool>(&mut self, octant: u32, rays: &[u32])
    where
        A: Answer<ANY>,
    {
        let mut crowd = Crowd::IDLE;
        let mut next = self.set_out(rays, 0, &mut crowd);
        while !crowd.at_nodes.is_empty() {
            // Compiled once for each, so that which planes rays enter through is no variable.
            match octant {
                0 => self.walk::<ANY, 0>(&mut crowd),
                1 => self.walk::<ANY, 1>(&mut crowd),
                2 => self.walk::<ANY, 2>(&mut crowd),
                3 => self.walk::<ANY, 3>(&mut crowd),
                4 => self.walk::<ANY, 4>(&mut crowd),
                5 => self.walk::<ANY, 5>(&mut crowd),
                6 => self.walk::<ANY, 6>(&mut crowd),
                _ => self.walk::<ANY, 7>(&mut crowd),
            }
            self.meet::<ANY>(&mut crowd);
            next = self.set_out(rays, next, &mut crowd);
        }
        for &ray in rays {
            A::name(std::slice::from_mut(&mut self.answers[ray as usize]), self.walk.others);
        }
    }

    /// Idle walkers take up rays from number `next` on; returns that of the ray after them.
    #[inline(always)]
    fn set_out<const ANY: bool>(
        &mut self,
        rays: &[u32],
        mut next: usize,
        crowd: &mut Crowd,
    ) -> usize
    where
        A: Answer<ANY>,
    {
        while next < rays.len() {
            let Some(walker) = crowd.idle.next() else { break };
            if next.is_multiple_of(S::Rays::COUNT) {
                let last = rays.len() - 1;
                let ray = |lane| &self.walk.rays[rays[last.min(next + lane)] as usize];
                let group: [_; MOST] = std::array::from_fn(ray);
                self.group.load(self.simd, &group[..S::Rays::COUNT]);
                self.group.prepare(self.simd.rays(), self.walk.tree.reach);
            }
            let (ray, group) = (rays[next], (&self.group, next % S::Rays::COUNT));
            let number = ray as usize;
            let t = self.answers[number].hit(self.walk.rays[number].t_max).t;
            self.walkers[walker].start(self.simd, group, ray, t);
            crowd.at_nodes.0 |= 1 << walker;
            next += 1;
        }
        next
    }

    /// Walkers at nodes go on until few are left there.
    #[inline(always)]
    fn walk<const ANY: bool, const OCTANT: u32>(&mut self, crowd: &mut Crowd) {
        loop {
            self.step::<ANY, OCTANT>(crowd);
            if crowd.at_nodes.0.count_ones() <= FEW {
                break;
            }
        }
    }

    /// All walkers at nodes go one step.
    #[inline(always)]
    fn step<const ANY: bool, const OCTANT: u32>(&mut self, crowd: &mut Crowd) {
        // Of any hit, what is far is more often one: what is near is mostly the surface that the ray leaves.
        let order = Order::of(if ANY { !OCTANT } else { OCTANT });
        let entry = EntryPlanes::of(OCTANT);
        let nodes: &[Node] = &self.walk.tree.nodes;
        let mut gone = 0;
        for number in crowd.at_nodes {
            let walker = &mut self.walkers[number];
            walker.step::<ANY>(self.simd, (entry, order), &nodes[walker.at.node_index()]);
            self.places.prefetch(self.simd, walker.at);
            gone |= walker.at.is_no_node() << number;
        }
        crowd.elsewhere.0 |= gone;
        crowd.at_nodes.0 &= !gone;
    }

    /// All walkers elsewhere meet what is there.
    #[inline(always)]
    fn meet<const ANY: bool>(&mut self, crowd: &mut Crowd)
    where
        A: Answer<ANY>,
    {
        let mut done = 0;
        for number in crowd.elsewhere {
            let walker = &mut self.walkers[number];
            let batch = (&self.walk, &mut *self.answers);
            walker.meet::<O, A, ANY>(self.simd, batch, &mut self.inner);
            done |= walker.at.is_no_node() << number;
        }
        crowd.idle.0 |= done;
        crowd.at_nodes.0 |= crowd.elsewhere.0 & !done;
        crowd.elsewhere = Set::NONE;
    }
}
