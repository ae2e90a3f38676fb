//! Closest hit and any hit of rays that have nothing in common but the tree and the signs of their directions: sixteen
//! are on their way at once and take turns, a node each.
//!
//! Contract: as `traverse`, with the same bits. What one ray has to wait for (memory, the end of a long chain of
//! operations) is filled with the steps of the others. For that nothing may branch on what a ray meets: its boxes are
//! packed onto its stack by a table (`order`), and where it stands then decides which queue it is put into.

use super::alone::Walk;
use super::group::Group;
use super::layout::{Child, EntryPlanes, Node, Places, Target, Tree};
use super::order::Order;
use super::traverse::{FLATTENED, Others, Search, Slabs, Stack};
use super::triangles::Shear;
use crate::geometry::{Hit, Ray};
use crate::simd::{LANES, Lanes, Simd};
use std::hint::select_unpredictable;

/// Rays that are on their way at once.
const WALKERS: usize = 16;
/// With no more than this at nodes, those at leaves come first.
const FEW: usize = WALKERS / 2;
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
    pub(super) fn add<const ANY: bool>(&mut self, first: usize, rays: &[Ray], hits: &[Hit]) {
        for (i, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            if !(ANY && hit.is_some()) {
                let octant = ray.direction.is_negative_bitmask();
                self.0[octant as usize % 8].push((first + i) as u32);
            }
        }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(Vec::is_empty)
    }

    /// Answers them; they are numbers of `walk`'s rays.
    #[inline(always)]
    pub(super) fn answer<S: Simd, O: Others, const ANY: bool>(&self, simd: S, walk: Walk<O>) {
        let mut walkers = std::array::from_fn(|_| Walker::nowhere(simd));
        let mut stream = Stream::new(simd, walk, &mut walkers);
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
    hit: Hit,
    /// Where it is.
    at: Child,
    /// Where that waits among the others.
    top: usize,
    /// Where it will be, the nearest on top: the bits of each [`Child`], and where the ray enters its box.
    waiting: [u32; WAITING + LANES],
    near: [f32; WAITING + LANES],
}

impl<S: Simd> Walker<S> {
    /// Nowhere.
    #[inline(always)]
    fn nowhere(simd: S) -> Self {
        let group = Group::EMPTY;
        Self {
            slabs: group.slabs_of(simd, 0),
            shear: group.shear_of(simd, 0),
            ray: 0,
            hit: Hit::none(0.0),
            at: Child::NOTHING,
            top: 0,
            waiting: [Child::NOTHING.bits(); WAITING + LANES],
            near: [f32::NEG_INFINITY; WAITING + LANES],
        }
    }

    /// Sets out from the root with one ray of a group.
    #[inline(always)]
    fn start(&mut self, simd: S, (group, lane): (&Group, usize), ray: u32, hit: Hit) {
        (self.slabs, self.shear) = (group.slabs_of(simd, lane), group.shear_of(simd, lane));
        (self.ray, self.hit, self.at, self.top) = (ray, hit, Child::node(0), 1);
    }

    /// Goes from a node to the nearest of its boxes that the ray meets; the others wait. If there are none, to what
    /// waits there.
    #[inline(always)]
    fn step<const ANY: bool>(
        &mut self,
        simd: S,
        (entry, order): (&EntryPlanes, &Order),
        node: &Node,
    ) {
        let (met, near) = self.slabs.meet(entry, node, self.hit.t);
        let (slots, top) = (order.slots(met), self.top % WAITING);
        let below = Child::from_bits(self.waiting[top.wrapping_sub(1) % WAITING]);
        let nearest = node.child(order.nearest(met));
        let children = simd.permute_words(node.children(), slots);
        self.waiting[top..top + LANES].copy_from_slice(&children);
        if !ANY {
            self.near[top..top + LANES].copy_from_slice(&near.permute(slots).to_array());
        }
        self.top = (top + met.count_ones() as usize).wrapping_sub(1);
        self.at = select_unpredictable(met == 0, below, nearest);
    }

    /// Goes on to the next that waits.
    #[inline(always)]
    fn leave(&mut self) {
        self.top = self.top.wrapping_sub(1) % WAITING;
        self.at = Child::from_bits(self.waiting[self.top]);
    }

    /// Whether it may find something nearer than its hit where it is.
    #[inline(always)]
    fn is_in_reach<const ANY: bool>(&self) -> bool {
        ANY || self.near[self.top % WAITING] <= self.hit.t
    }

    /// Meets what is not a node, one after the other, until it comes to a node or is done.
    #[inline(always)]
    fn meet<O: Others, const ANY: bool>(
        &mut self,
        search: &Search<S>,
        walk: &Walk<O>,
        stack: &mut Stack,
    ) {
        loop {
            let (ray, in_reach) = (search.ray, self.is_in_reach::<ANY>());
            let found = match self.at.target() {
                Target::Block(index) if in_reach => {
                    let (block, shear) = (&walk.tree.blocks[index], &self.shear);
                    search.meet(walk.tree, block, ray, shear, FLATTENED, &mut self.hit)
                }
                Target::Other(surface) if in_reach => {
                    walk.others.visit::<S, ANY>(search, surface, &mut self.hit, stack)
                }
                Target::Block(_) | Target::Other(_) => false,
                Target::Node(_) | Target::Nothing => return,
            };
            if ANY && found {
                self.at = Child::NOTHING;
                return;
            }
            self.leave();
        }
    }
}

/// Numbers of walkers.
struct Queue {
    /// Twice as long as it may become, as some are written that do not stay.
    walkers: [u8; 2 * WALKERS],
    len: usize,
}

impl Queue {
    const EMPTY: Self = Self { walkers: [0; 2 * WALKERS], len: 0 };

    #[inline(always)]
    fn get(&self, i: usize) -> usize {
        usize::from(self.walkers[i % (2 * WALKERS)]) % WALKERS
    }

    #[inline(always)]
    fn set(&mut self, i: usize, walker: usize) {
        self.walkers[i % (2 * WALKERS)] = walker as u8;
    }

    /// Adds a walker on a condition that nobody could foresee.
    #[inline(always)]
    fn push_if(&mut self, condition: bool, walker: usize) {
        self.set(self.len, walker);
        self.len += usize::from(condition);
    }
}

/// Which walkers are where.
struct Queues {
    at_nodes: Queue,
    /// At leaves and other surfaces, and those that have been everywhere.
    elsewhere: Queue,
    idle: Queue,
}

impl Queues {
    fn all_idle() -> Self {
        let mut idle = Queue::EMPTY;
        for walker in 0..WALKERS {
            idle.push_if(true, walker);
        }
        Self { at_nodes: Queue::EMPTY, elsewhere: Queue::EMPTY, idle }
    }
}

/// Rays that walk through a tree in turns.
struct Stream<'a, S: Simd, O> {
    simd: S,
    walk: Walk<'a, O>,
    places: Places,
    walkers: &'a mut [Walker<S>; WALKERS],
    /// The rays that set out next.
    group: Group,
    /// For trees within the tree.
    inner: Stack,
}

impl<'a, S: Simd, O: Others> Stream<'a, S, O> {
    #[inline(always)]
    fn new(simd: S, walk: Walk<'a, O>, walkers: &'a mut [Walker<S>; WALKERS]) -> Self {
        Self {
            simd,
            places: walk.tree.places(),
            walk,
            walkers,
            group: Group::EMPTY,
            inner: Stack::new(),
        }
    }

    /// Answers `rays`, whose directions have the signs in `octant`.
    #[inline(always)]
    fn answer<const ANY: bool>(&mut self, octant: u32, rays: &[u32]) {
        let mut queues = Queues::all_idle();
        let mut next = self.set_out(rays, 0, &mut queues);
        while queues.at_nodes.len > 0 {
            // Compiled once for each, so that which planes rays enter through is no variable.
            match octant {
                0 => self.walk::<ANY, 0>(&mut queues),
                1 => self.walk::<ANY, 1>(&mut queues),
                2 => self.walk::<ANY, 2>(&mut queues),
                3 => self.walk::<ANY, 3>(&mut queues),
                4 => self.walk::<ANY, 4>(&mut queues),
                5 => self.walk::<ANY, 5>(&mut queues),
                6 => self.walk::<ANY, 6>(&mut queues),
                _ => self.walk::<ANY, 7>(&mut queues),
            }
            self.meet::<ANY>(&mut queues);
            next = self.set_out(rays, next, &mut queues);
        }
    }

    /// Idle walkers take up rays from number `next` on; returns that of the ray after them.
    #[inline(always)]
    fn set_out(&mut self, rays: &[u32], mut next: usize, queues: &mut Queues) -> usize {
        while queues.idle.len > 0 && next < rays.len() {
            queues.idle.len -= 1;
            let walker = queues.idle.get(queues.idle.len);
            if next.is_multiple_of(LANES) {
                let last = rays.len() - 1;
                let ray = |lane| &self.walk.rays[rays[last.min(next + lane)] as usize];
                let group = std::array::from_fn(ray);
                self.group.load(self.simd, group);
                self.group.prepare(self.simd, self.walk.tree.reach);
            }
            let (ray, hit) = (rays[next], self.walk.hits[rays[next] as usize]);
            let group = (&self.group, next % LANES);
            self.walkers[walker].start(self.simd, group, ray, hit);
            queues.at_nodes.push_if(true, walker);
            next += 1;
        }
        next
    }

    /// Walkers at nodes go on until few are left there.
    #[inline(always)]
    fn walk<const ANY: bool, const OCTANT: u32>(&mut self, queues: &mut Queues) {
        self.step::<ANY, OCTANT>(queues);
        while queues.at_nodes.len > FEW {
            self.step::<ANY, OCTANT>(queues);
        }
    }

    /// All walkers at nodes go one step.
    #[inline(always)]
    fn step<const ANY: bool, const OCTANT: u32>(&mut self, queues: &mut Queues) {
        let (entry, order) = (EntryPlanes::of(OCTANT), Order::of(OCTANT));
        let (nodes, places): (&[Node], _) = (&self.walk.tree.nodes, self.places);
        let (count, elsewhere) = (queues.at_nodes.len, queues.elsewhere.len);
        let mut stay = 0;
        for i in 0..count {
            let number = queues.at_nodes.get(i);
            let walker = &mut self.walkers[number];
            walker.step::<ANY>(self.simd, (entry, order), &nodes[walker.at.index()]);
            places.prefetch(self.simd, walker.at);
            queues.at_nodes.set(stay, number);
            queues.elsewhere.set(elsewhere + i - stay, number);
            stay += usize::from(walker.at.is_node());
        }
        (queues.at_nodes.len, queues.elsewhere.len) = (stay, elsewhere + count - stay);
    }

    /// All walkers elsewhere meet what is there.
    #[inline(always)]
    fn meet<const ANY: bool>(&mut self, queues: &mut Queues) {
        let count = std::mem::take(&mut queues.elsewhere.len);
        for i in 0..count {
            let number = queues.elsewhere.get(i);
            let (walk, walker) = (&mut self.walk, &mut self.walkers[number]);
            let ray = &walk.rays[walker.ray as usize];
            let search = Search { simd: self.simd, ray, filter: walk.filter, flags: walk.flags };
            walker.meet::<O, ANY>(&search, walk, &mut self.inner);
            let is_done = !walker.at.is_node();
            queues.at_nodes.push_if(!is_done, number);
            queues.idle.push_if(is_done, number);
            if is_done {
                walk.hits[walker.ray as usize] = walker.hit;
            }
        }
    }
}
