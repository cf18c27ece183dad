//! Which of a core must be kept: all that is wide, and what is narrow but holds something together.
//!
//! From its ends inwards, a core is peeled off as long as it is narrow: what that takes away are the tips of ink and
//! the ends of notches, whose loss changes no count. What is left is wide, leads from one wide place to another, or
//! goes round in a loop. A part that would be peeled off altogether keeps its widest point.
//!
//! Not all that ends blind is a tip ([`Tip`]). What is long is a hair of ink, or a slot: it is seen, and would be missed.
//! What is wider again behind a neck is a lump of ink that breaks off, or a pocket that is closed off, before it is gone
//! itself.

use std::collections::VecDeque;

use super::core::{Core, Node};

const NONE: usize = usize::MAX;

/// What ends blind and is a tip, in millimetres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tip {
    /// It is narrow for no more than that.
    pub(super) long_mm: f64,
    /// Its radius is nowhere greater by more than that than it is nearer to its foot.
    pub(super) uneven_mm: f64,
}

impl Tip {
    /// Whatever ends blind.
    pub(super) const ANY: Self = Self { long_mm: f64::INFINITY, uneven_mm: f64::INFINITY };
}

/// The nodes of a core that are kept.
pub(super) struct Kept {
    pub(super) nodes: Vec<bool>,
}

impl Kept {
    /// Nodes with a radius below `half_mm` are narrow. A free end that is no tip because it is long is kept after all, up to
    /// `half_mm` from its end, so that it becomes no longer when it becomes wider; one with a neck, up to where it is widest.
    ///
    /// `across` gives half of the width at a node, and is infinite where there is a contour on one side only: nodes beside the
    /// middle look narrower than it is there, and triangles along a round wall have nodes all along it.
    pub(super) fn new(core: &Core, half_mm: f64, tip: Tip, across: impl Fn(&Node) -> f64) -> Self {
        let n = core.nodes.len();
        let ways = Ways::new(core);
        let mut degree: Vec<usize> = (0..n).map(|i| ways.from(i).len()).collect();
        let mut kept = vec![true; n];
        let mut held = vec![false; n];
        let mut reach = vec![0.0; n];
        let mut outer = vec![NONE; n];
        // The widest node that has been peeled off behind each, and the way there.
        let mut widest: Vec<usize> = (0..n).collect();
        let mut towards = vec![NONE; n];
        let radius = |i: usize| core.nodes[i].radius;
        let is_loose = |i: usize, degree: &[usize]| degree[i] <= 1 && radius(i) < half_mm;
        let mut loose: VecDeque<usize> = (0..n).filter(|&i| is_loose(i, &degree)).collect();
        while let Some(i) = loose.pop_front() {
            if !kept[i] || held[i] {
                continue;
            }
            let is_long = reach[i] > tip.long_mm;
            let lump = radius(widest[i]) - tip.uneven_mm;
            let is_neck = lump > radius(i) && lump > across(&core.nodes[i]);
            if is_long || is_neck {
                held[i] = true;
                let mut at = if is_long { i } else { NONE };
                while at != NONE {
                    held[at] |= reach[at] >= half_mm;
                    at = outer[at];
                }
                let mut at = i;
                while is_neck && at != widest[i] {
                    at = towards[at];
                    held[at] = true;
                }
                continue;
            }
            kept[i] = false;
            // A way along the wall of something wide is no length of a narrow thing.
            let is_between = tip.long_mm.is_infinite() || across(&core.nodes[i]).is_finite();
            for &to in ways.from(i).iter().filter(|&&to| kept[to]) {
                degree[to] -= 1;
                let way = core.nodes[i].at.distance(core.nodes[to].at);
                let far = reach[i] + if is_between { way } else { 0.0 };
                if far > reach[to] {
                    (reach[to], outer[to]) = (far, i);
                }
                if radius(widest[i]) > radius(widest[to]) {
                    (widest[to], towards[to]) = (widest[i], i);
                }
                if is_loose(to, &degree) {
                    loose.push_back(to);
                }
            }
        }
        (0..n).for_each(|i| kept[i] |= held[i]);
        let mut is_empty = vec![true; n];
        (0..n).filter(|&i| kept[i]).for_each(|i| is_empty[core.nodes[i].part] = false);
        let mut widest = vec![NONE; n];
        for (i, node) in core.nodes.iter().enumerate().filter(|(_, node)| is_empty[node.part]) {
            let best = &mut widest[node.part];
            if *best == NONE || node.radius > core.nodes[*best].radius {
                *best = i;
            }
        }
        widest.into_iter().filter(|&i| i != NONE).for_each(|i| kept[i] = true);
        Self { nodes: kept }
    }
}

/// A lump is one when its neck is narrower than this part of it. More, and every unevenness of a core is a lump, which
/// takes room from the other side; less, and a lump may be worn down to the width of its neck.
const NECK: f64 = 0.8;

impl Kept {
    /// What of it must be left alone by the other side, which takes nothing from where the radius is `hold_mm` or more:
    /// free ends are drawn back into the wide, or to the middle of the lump that they end in.
    pub(super) fn drawn_back(&self, core: &Core, hold_mm: f64) -> Self {
        let n = core.nodes.len();
        let ways = Ways::new(core);
        let mut kept = self.nodes.clone();
        let degree = |i: usize, kept: &[bool]| ways.from(i).iter().filter(|&&to| kept[to]).count();
        let mut left: Vec<usize> = (0..n).map(|i| degree(i, &self.nodes)).collect();
        let mut held = vec![false; n];
        let mut widest: Vec<f64> = core.nodes.iter().map(|node| node.radius).collect();
        let mut outer = vec![NONE; n];
        let is_loose = |i: usize, left: &[usize]| left[i] <= 1 && core.nodes[i].radius < hold_mm;
        let mut loose: VecDeque<usize> = (0..n).filter(|&i| kept[i] && is_loose(i, &left)).collect();
        while let Some(i) = loose.pop_front() {
            if !kept[i] || held[i] {
                continue;
            }
            let inner = ways.from(i).iter().copied().find(|&to| kept[to]);
            let Some(to) = inner.filter(|&to| core.nodes[to].radius >= NECK * widest[i]) else {
                let mut at = i;
                held[at] = true;
                while outer[at] != NONE {
                    at = outer[at];
                    held[at] = true;
                }
                continue;
            };
            kept[i] = false;
            left[to] -= 1;
            if widest[i] > widest[to] {
                (widest[to], outer[to]) = (widest[i], i);
            }
            if is_loose(to, &left) {
                loose.push_back(to);
            }
        }
        (0..n).for_each(|i| kept[i] |= held[i]);
        Self { nodes: kept }
    }
}

/// The neighbours of each node, one after the other.
struct Ways {
    first: Vec<usize>,
    to: Vec<usize>,
}

impl Ways {
    fn new(core: &Core) -> Self {
        let mut first = vec![0; core.nodes.len() + 1];
        core.links.iter().flatten().for_each(|&i| first[i + 1] += 1);
        (1..first.len()).for_each(|i| first[i] += first[i - 1]);
        let mut next = first.clone();
        let mut to = vec![0; 2 * core.links.len()];
        for [a, b] in core.links.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
            to[next[a]] = b;
            next[a] += 1;
        }
        Self { first, to }
    }

    fn from(&self, node: usize) -> &[usize] {
        &self.to[self.first[node]..self.first[node + 1]]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// A chain of nodes 1 mm apart, with these radii.
    fn chain(radii: &[f64]) -> Core {
        let node = |(i, &radius): (usize, &f64)| Node { at: DVec2::new(i as f64, 0.0), radius, part: 0 };
        Core {
            nodes: radii.iter().enumerate().map(node).collect(),
            links: (1..radii.len()).map(|i| [i - 1, i]).collect(),
        }
    }

    fn kept(core: &Core, long_mm: f64) -> Vec<usize> {
        let kept = Kept::new(core, 1.0, Tip { long_mm, uneven_mm: 0.05 }, |node| node.radius).nodes;
        (0..kept.len()).filter(|&i| kept[i]).collect()
    }

    #[test]
    fn tips_go_and_necks_stay() {
        let core = chain(&[0.0, 0.5, 2.0, 0.1, 0.1, 2.0, 0.5, 0.0]);
        assert_eq!(kept(&core, 10.0), [2, 3, 4, 5]);
    }

    #[test]
    fn loops_stay() {
        let mut core = chain(&[0.2, 0.2, 0.2, 0.2, 0.1]);
        core.links.push([3, 0]);
        assert_eq!(kept(&core, 10.0), [0, 1, 2, 3]);
    }

    #[test]
    fn hairs_stay_but_for_their_ends() {
        let core = chain(&[2.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.0]);
        assert_eq!(kept(&core, 10.0), [0]);
        assert_eq!(kept(&core, 3.0), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn necks_and_what_they_close_off_stay() {
        // Behind a neck of 0.2 it is wider by 0.2, and in the end by 0.04 only.
        let core = chain(&[0.0, 0.24, 0.2, 0.3, 0.4, 0.2, 0.3, 2.0]);
        assert_eq!(kept(&core, 10.0), [4, 5, 6, 7]);
        // A neck with two pockets.
        let mut forked = chain(&[0.0, 0.3, 0.1, 0.5, 2.0]);
        forked.nodes.push(Node { at: DVec2::new(2.0, 1.0), radius: 0.2, part: 0 });
        forked.links.push([2, 5]);
        assert_eq!(kept(&forked, 10.0), [1, 2, 3, 4]);
    }

    #[test]
    fn what_only_looks_like_a_neck_is_none() {
        let core = chain(&[0.0, 0.3, 0.2, 0.5, 2.0]);
        let tip = Tip { long_mm: 10.0, uneven_mm: 0.05 };
        let kept = Kept::new(&core, 1.0, tip, |_| f64::INFINITY).nodes;
        assert_eq!(kept, [false, false, false, false, true]);
    }

    #[test]
    fn what_is_left_alone_ends_in_the_wide_and_in_lumps() {
        let drawn_back = |radii: &[f64]| {
            let core = chain(radii);
            let kept = Kept::new(&core, 1.0, Tip::ANY, |node| node.radius).drawn_back(&core, 5.0).nodes;
            (0..kept.len()).filter(|&i| kept[i]).collect::<Vec<_>>()
        };
        assert_eq!(drawn_back(&[0.5, 1.5, 2.0, 3.0, 6.0, 5.5, 4.0, 2.0]), [4, 5]);
        // On the left a lump of 3 behind a neck of 2; on the right only an unevenness.
        assert_eq!(drawn_back(&[1.0, 3.0, 2.5, 2.0, 4.0, 6.0, 4.0, 3.9, 4.2]), [1, 2, 3, 4, 5]);
        assert_eq!(drawn_back(&[1.1, 1.2, 1.1]), [1]);
    }

    #[test]
    fn nothing_goes_altogether() {
        assert_eq!(kept(&chain(&[0.0, 0.2, 0.5, 0.2]), 10.0), [2]);
    }
}
