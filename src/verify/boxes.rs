//! Which boxes meet: all pairs of a list of them.
//!
//! The boxes are put in the order of a space-filling curve (Morton's) through their middles, so that neighbours in the
//! list are mostly neighbours in space, and a binary tree over that order has a box around each of its nodes. The tree is
//! then held against itself, from the root down to leaves of a few boxes. Sorting whole numbers is nearly all that it
//! costs, which is why this is here: building a general tree for boxes took five times as long, and asking it once for
//! each box as long again. A coarse order costs time and nothing else: boxes are compared as they are.

use glam::DVec3;

/// A box by its least and its greatest corner.
pub(super) type Box3 = (DVec3, DVec3);

/// Boxes in a leaf, at most.
const LEAF: usize = 4;
/// Bits of a coordinate in the order along the curve.
const BITS: u32 = 20;

/// Calls `meet` once for each two boxes that have a point in common, the lower number first, in no particular order.
pub(super) fn pairs_that_meet(boxes: &[Box3], mut meet: impl FnMut(usize, usize)) {
    let Some(all) = boxes.iter().copied().reduce(around) else { return };
    let order = along_curve(boxes, all);
    let depth = order.len().div_ceil(LEAF).next_power_of_two().trailing_zeros();
    let tree = Tree::new(boxes, &order, depth);
    let mut compare = |i: u32, j: u32| {
        let (i, j) = (i as usize, j as usize);
        if overlap(&boxes[i], &boxes[j]) {
            meet(i.min(j), i.max(j));
        }
    };
    let mut open = vec![(1, 1)];
    while let Some((a, b)) = open.pop() {
        match (a >= 1 << depth, a == b) {
            (false, true) => open.extend([(2 * a, 2 * a), (2 * a, 2 * a + 1), (2 * a + 1, 2 * a + 1)]),
            (false, false) => {
                let children =
                    [(2 * a, 2 * b), (2 * a, 2 * b + 1), (2 * a + 1, 2 * b), (2 * a + 1, 2 * b + 1)];
                open.extend(children.into_iter().filter(|&(a, b)| tree.overlap(a, b)));
            }
            (true, true) => {
                let leaf = tree.leaf(a);
                for (k, &i) in leaf.iter().enumerate() {
                    leaf[k + 1..].iter().for_each(|&j| compare(i, j));
                }
            }
            (true, false) => {
                for &i in tree.leaf(a) {
                    if overlap(&boxes[i as usize], &tree.around[b]) {
                        tree.leaf(b).iter().for_each(|&j| compare(i, j));
                    }
                }
            }
        }
    }
}

/// A full binary tree over boxes in order. Node 1 is the root, and 2n and 2n + 1 are the children of node n.
struct Tree<'a> {
    order: &'a [u32],
    /// The first leaf.
    leaves: usize,
    /// The box around each node; that of a leaf without boxes meets none.
    around: Vec<Box3>,
}

impl<'a> Tree<'a> {
    fn new(boxes: &[Box3], order: &'a [u32], depth: u32) -> Self {
        let leaves = 1 << depth;
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut tree = Self { order, leaves, around: vec![nothing; 2 * leaves] };
        for node in leaves..2 * leaves {
            tree.around[node] = tree.leaf(node).iter().map(|&i| boxes[i as usize]).fold(nothing, around);
        }
        for node in (1..leaves).rev() {
            tree.around[node] = around(tree.around[2 * node], tree.around[2 * node + 1]);
        }
        tree
    }

    /// The numbers of the boxes of a leaf.
    fn leaf(&self, node: usize) -> &'a [u32] {
        let begin = |leaf: usize| leaf * self.order.len() / self.leaves;
        &self.order[begin(node - self.leaves)..begin(node - self.leaves + 1)]
    }

    fn overlap(&self, a: usize, b: usize) -> bool {
        overlap(&self.around[a], &self.around[b])
    }
}

/// The numbers of the boxes in the order of the curve through `all`.
fn along_curve(boxes: &[Box3], all: Box3) -> Vec<u32> {
    let steps = f64::from((1u32 << BITS) - 1);
    // One scale for all axes: what is flat is ordered as in the plane.
    let scale = 0.5 * steps / (all.1 - all.0).max_element().max(f64::MIN_POSITIVE);
    let mut order: Vec<(u64, u32)> = boxes
        .iter()
        .zip(0..)
        .map(|((low, high), number)| {
            let [x, y, z] = ((*low - all.0 + (*high - all.0)) * scale).to_array().map(|x| x as u64);
            (spread(x) | spread(y) << 1 | spread(z) << 2, number)
        })
        .collect();
    order.sort_unstable();
    order.into_iter().map(|(_, number)| number).collect()
}

/// The lowest [`BITS`] bits, with two bits of nothing after each.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

fn around(a: Box3, b: Box3) -> Box3 {
    (a.0.min(b.0), a.1.max(b.1))
}

fn overlap(a: &Box3, b: &Box3) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn bits_are_spread() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread((1 << BITS) - 1).count_ones(), BITS);
    }

    proptest! {
        /// Against all pairs, with boxes that are points, that are equal and that only touch.
        #[test]
        fn all_pairs_that_meet_are_found_once(
            corners in prop::collection::vec((prop::array::uniform3(-9i8..10), prop::array::uniform3(0u8..5)), 0..90),
            stretch in prop::sample::select(vec![1.0, 1e-3, 1e9]),
        ) {
            let point = |p: [f64; 3]| DVec3::from_array(p) * DVec3::new(stretch, 1.0, 1.0);
            let boxes: Vec<Box3> = corners
                .iter()
                .map(|&(low, size)| {
                    let low = low.map(f64::from);
                    (point(low), point(std::array::from_fn(|i| low[i] + f64::from(size[i]))))
                })
                .collect();
            let mut found = Vec::new();
            pairs_that_meet(&boxes, |i, j| found.push((i, j)));
            found.sort_unstable();
            let all = (0..boxes.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
            let mut expected: Vec<_> = all.filter(|&(i, j)| overlap(&boxes[i], &boxes[j])).collect();
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}
