//! A spatial index of a region's edges.
//!
//! The edges are put in the order of a space-filling curve (Morton's) through their middles, and a binary tree over that
//! order has a box around each of its nodes. The search for the nearest edge looks into the nearer half first, and no
//! farther than it is told to: what is wide enough need not be measured. General R-trees have no such search, and without
//! a bound they take as long as this.

use glam::DVec2;
use rstar::{AABB, PointDistance, RTreeObject};

use super::region::Region;

/// Edges in a leaf, at most.
const LEAF: usize = 4;
/// Bits of a coordinate in the order along the curve. Fewer, and edges of a fine outline come in no order; more are not
/// seen.
const BITS: u32 = 16;
/// Nodes that wait to be looked into, at most: one for each level of a tree that has as many leaves as there is memory.
const WAITING: usize = usize::BITS as usize;

/// One edge of a region in millimetres, with the ink on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexedEdge {
    /// The contour, counted in the order of [`Region::contours`].
    pub contour: usize,
    /// The edge within the contour: from vertex `edge` to the next.
    pub edge: usize,
    /// Where it begins.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
}

impl IndexedEdge {
    /// The point of the edge that is nearest to `p`.
    pub fn nearest(&self, p: DVec2) -> DVec2 {
        let d = self.to - self.from;
        let t = ((p - self.from).dot(d) / d.length_squared()).clamp(0.0, 1.0);
        self.from + d * t
    }

    fn distance_squared(&self, p: DVec2) -> f64 {
        self.nearest(p).distance_squared(p)
    }

    fn bounds(&self) -> Bounds {
        Bounds { low: self.from.min(self.to), high: self.from.max(self.to) }
    }
}

/// For general trees of some of the edges; an [`EdgeIndex`] is of all.
impl RTreeObject for IndexedEdge {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.from.to_array(), self.to.to_array())
    }
}

impl PointDistance for IndexedEdge {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        self.distance_squared(DVec2::from_array(*point))
    }
}

/// A box by its least and its greatest corner; one around nothing is everywhere out of reach.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: DVec2,
    high: DVec2,
}

impl Bounds {
    const NOTHING: Self = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };

    fn around(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn distance_squared(&self, p: DVec2) -> f64 {
        (self.low - p).max(p - self.high).max(DVec2::ZERO).length_squared()
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// All edges of a region, by where they are.
#[derive(Clone)]
pub struct EdgeIndex {
    /// In the order of the curve.
    edges: Vec<IndexedEdge>,
    /// The box around each node. Node 1 is the root, and 2n and 2n + 1 are the children of node n.
    bounds: Vec<Bounds>,
    /// The first leaf.
    leaves: usize,
}

impl EdgeIndex {
    /// The index of all edges of `region`.
    pub fn new(region: &Region) -> Self {
        let grid = region.grid();
        let mut edges = Vec::with_capacity(region.vertices());
        for (contour, c) in region.contours().enumerate() {
            for (edge, (a, b)) in c.edges().enumerate() {
                edges.push(IndexedEdge { contour, edge, from: grid.to_mm(a), to: grid.to_mm(b) });
            }
        }
        let edges = along_curve(edges);
        let leaves = edges.len().div_ceil(LEAF).next_power_of_two();
        let mut index = Self { edges, bounds: vec![Bounds::NOTHING; 2 * leaves], leaves };
        for node in leaves..2 * leaves {
            let edges = index.leaf(node).iter().map(IndexedEdge::bounds);
            index.bounds[node] = edges.fold(Bounds::NOTHING, Bounds::around);
        }
        for node in (1..leaves).rev() {
            index.bounds[node] = index.bounds[2 * node].around(index.bounds[2 * node + 1]);
        }
        index
    }

    /// The edge nearest to `p`, of equally near ones the first of the region; `None` for an empty region.
    pub fn nearest(&self, p: DVec2) -> Option<&IndexedEdge> {
        self.nearest_within(p, f64::INFINITY)
    }

    /// The same, or `None` when it is farther than `reach`. Far from everything many edges are about equally near, and
    /// to know that none is within reach takes a thousandth of finding the nearest.
    pub fn nearest_within(&self, p: DVec2, reach: f64) -> Option<&IndexedEdge> {
        let reach = reach * reach;
        let mut best: Option<(f64, &IndexedEdge)> = None;
        let mut waiting = [(0, 0.0); WAITING];
        waiting[0] = (1, self.bounds[1].distance_squared(p));
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (node, distance) = waiting[count];
            if distance > best.map_or(reach, |(least, _)| least) {
                continue;
            }
            if node >= self.leaves {
                for edge in self.leaf(node) {
                    let distance = edge.distance_squared(p);
                    let place = |edge: &IndexedEdge| (edge.contour, edge.edge);
                    let is_better = match best {
                        None => distance <= reach,
                        Some((least, _)) if distance != least => distance < least,
                        Some((_, known)) => place(edge) < place(known),
                    };
                    if is_better {
                        best = Some((distance, edge));
                    }
                }
                continue;
            }
            let [a, b] =
                [2 * node, 2 * node + 1].map(|child| (child, self.bounds[child].distance_squared(p)));
            // The last one in is the first one out.
            let (far, near) = if a.1 < b.1 { (b, a) } else { (a, b) };
            waiting[count..count + 2].copy_from_slice(&[far, near]);
            count += 2;
        }
        best.map(|(_, edge)| edge)
    }

    /// The edges within `radius` of `p`, in no particular order.
    pub fn within(&self, p: DVec2, radius: f64) -> impl Iterator<Item = &IndexedEdge> {
        let square = radius * radius;
        self.leaves_where(move |bounds| bounds.distance_squared(p) <= square)
            .filter(move |edge| edge.distance_squared(p) <= square)
    }

    /// The edges whose bounding boxes meet the box from `low` to `high`, in no particular order.
    pub fn in_box(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = &IndexedEdge> {
        let wanted = Bounds { low, high };
        self.leaves_where(move |bounds| bounds.overlaps(&wanted))
            .filter(move |edge| edge.bounds().overlaps(&wanted))
    }

    /// The edges of all leaves that may hold what is wanted, as may all nodes above them.
    fn leaves_where(&self, may: impl Fn(&Bounds) -> bool) -> impl Iterator<Item = &IndexedEdge> {
        let mut waiting = vec![1];
        let leaves = std::iter::from_fn(move || {
            while let Some(node) = waiting.pop() {
                if !may(&self.bounds[node]) {
                    continue;
                }
                if node >= self.leaves {
                    return Some(self.leaf(node));
                }
                waiting.extend([2 * node, 2 * node + 1]);
            }
            None
        });
        leaves.flatten()
    }

    fn leaf(&self, node: usize) -> &[IndexedEdge] {
        let begin = |leaf: usize| leaf * self.edges.len() / self.leaves;
        &self.edges[begin(node - self.leaves)..begin(node - self.leaves + 1)]
    }
}

/// The edges in the order of the curve through the box around them all.
fn along_curve(edges: Vec<IndexedEdge>) -> Vec<IndexedEdge> {
    let all = edges.iter().map(IndexedEdge::bounds).fold(Bounds::NOTHING, Bounds::around);
    let steps = f64::from((1u32 << BITS) - 1);
    let scale = steps / (all.high - all.low).max_element().max(f64::MIN_POSITIVE);
    let middle = |edge: &IndexedEdge| (edge.from.midpoint(edge.to) - all.low) * scale;
    let keys = edges.iter().map(middle).map(|at| spread(at.x as u32) | spread(at.y as u32) << 1);
    let mut order: Vec<(u32, usize)> = keys.zip(0..).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, number)| edges[number]).collect()
}

/// The lowest [`BITS`] bits, with a bit of nothing after each.
fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{FillRule, Grid, GridPoint};
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (2 * bit));
        }
    }

    proptest! {
        /// Against looking at all edges.
        #[test]
        fn queries_find_what_there_is(
            squares in prop::collection::vec((0i64..60, 0i64..60, 1i64..9), 0..40),
            at in (-10i32..80, -10i32..80),
            reach in (0u32..30, 0u32..30),
        ) {
            let grid = Grid::for_extent(100.0).unwrap();
            let one = grid.steps(1.0);
            let paths: Vec<Vec<GridPoint>> = squares
                .iter()
                .map(|&(x, y, size)| {
                    [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
                        .map(|(x, y)| GridPoint::new(x * one, y * one))
                        .to_vec()
                })
                .collect();
            let index = EdgeIndex::new(&Region::fill(grid, &paths, FillRule::EvenOdd));
            let p = DVec2::new(f64::from(at.0), f64::from(at.1));
            let least = index.edges.iter().map(|edge| edge.distance_squared(p)).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(index.nearest(p).map_or(f64::INFINITY, |edge| edge.distance_squared(p)), least);
            let radius = f64::from(reach.0);
            let within = index.nearest_within(p, radius).map(|edge| edge.distance_squared(p));
            prop_assert_eq!(within, Some(least).filter(|&least| least <= radius * radius));
            let near = index.edges.iter().filter(|edge| edge.distance_squared(p) <= radius * radius);
            prop_assert_eq!(index.within(p, radius).count(), near.count());
            let high = p + DVec2::new(f64::from(reach.0), f64::from(reach.1));
            let met = |edge: &&IndexedEdge| edge.bounds().overlaps(&Bounds { low: p, high });
            prop_assert_eq!(index.in_box(p, high).count(), index.edges.iter().filter(met).count());
        }
    }
}
