//! Exact clipping of a region by its cuts.
//!
//! No vertex lies on a cut, so each contour falls into chains by walking along it: an edge leaves one piece
//! for the next exactly where its ends lie on different sides of a cut. The components of a piece are the
//! closed walks along chains and portals; a contour that reaches no cut is an island if it runs
//! counter-clockwise and a hole if not. Nothing here is decided by a rounded number.

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::piece::{Chain, End, Endpoint, Piece};
use crate::planar::{Contour, Grid, Region};
use crate::reeb::Cut;
use crate::topology::Descriptor;

/// The blank before the first ink and after the last, as a part of the exemplar's longer side. Smaller, and
/// copies that are joined end to end nearly touch; larger, and the gap between them shows.
const END_BLANK: f64 = 0.005;

/// The pieces of `region` between `cuts`, left to right.
pub(super) fn cut_up(region: &Region, cuts: &[Cut]) -> Vec<Piece> {
    let Some((low, high)) = region.bounds_mm() else {
        return Vec::new();
    };
    let grid = region.grid();
    let middle_mm = (low.y + high.y) / 2.0;
    let mut edges: Vec<f64> = cuts.iter().map(|c| grid.mm(c.x)).collect();
    // Blank ends keep pieces apart that are joined where the exemplar begins and ends.
    let blank_mm = END_BLANK * (high - low).max_element();
    edges.insert(0, low.x - blank_mm);
    edges.push(high.x + blank_mm);
    let endpoints = |cut: Option<&Cut>| -> Vec<Endpoint> {
        let crossings = cut.map_or(&[][..], |c| &c.crossings);
        crossings.iter().map(|c| Endpoint { y_mm: c.y_mm - middle_mm, tangent: c.tangent }).collect()
    };
    let mut pieces: Vec<Piece> = (0..=cuts.len())
        .map(|i| Piece {
            x_mm: edges[i] - edges[0],
            width_mm: edges[i + 1] - edges[i],
            left: endpoints(i.checked_sub(1).map(|left| &cuts[left])),
            right: endpoints(cuts.get(i)),
            chains: Vec::new(),
            loops: Vec::new(),
            descriptor: Descriptor::new(&[], &[], 0, 0),
        })
        .collect();
    let mut ranks = FxHashMap::default();
    for (cut, c) in cuts.iter().enumerate() {
        for (rank, crossing) in c.crossings.iter().enumerate() {
            ranks.insert((crossing.contour, crossing.edge, cut), rank);
        }
    }
    let walk = Walk { grid, cuts, ranks, origin: DVec2::new(0.0, middle_mm), left_mm: &edges };
    let mut loops = vec![Loops::default(); pieces.len()];
    for (number, contour) in region.contours().enumerate() {
        walk.contour(number, contour, &mut pieces, &mut loops);
    }
    for (piece, loops) in pieces.iter_mut().zip(loops) {
        piece.chains.sort_by_key(|chain| chain.start.order());
        piece.descriptor = descriptor(piece, loops);
    }
    pieces
}

struct Walk<'a> {
    grid: Grid,
    cuts: &'a [Cut],
    /// Contour, edge and cut to the crossing's number from the top.
    ranks: FxHashMap<(usize, usize, usize), usize>,
    origin: DVec2,
    /// Where each piece begins.
    left_mm: &'a [f64],
}

impl Walk<'_> {
    fn contour(&self, number: usize, contour: &Contour, pieces: &mut [Piece], loops: &mut [Loops]) {
        let points = contour.points();
        let piece_of = |x: i64| self.cuts.partition_point(|c| c.x < x);
        let homes: Vec<usize> = points.iter().map(|p| piece_of(p.x)).collect();
        let n = points.len();
        let Some(first) = (0..n).find(|&i| homes[i] != homes[(i + 1) % n]) else {
            let home = homes[0];
            let local = points.iter().map(|&p| self.local(self.grid.to_mm(p), home)).collect();
            pieces[home].loops.push(local);
            // Exact: the orientation is that of the contour on its grid.
            loops[home].count(contour.is_counter_clockwise());
            return;
        };
        // Start after an edge that crosses a cut, so that every chain is met whole.
        let mut chain: Option<(End, Vec<DVec2>)> = None;
        for step in 0..=n {
            let i = (first + step) % n;
            let j = (i + 1) % n;
            if let (1.., Some((_, open))) = (step, &mut chain) {
                open.push(self.local(self.grid.to_mm(points[i]), homes[i]));
            }
            let mut home = homes[i];
            while home != homes[j] {
                let rightwards = home < homes[j];
                let cut = if rightwards { home } else { home - 1 };
                let rank = self.ranks[&(number, i, cut)];
                let at = DVec2::new(self.grid.mm(self.cuts[cut].x), self.cuts[cut].crossings[rank].y_mm);
                let (leave, next_home) =
                    if rightwards { (End::Right(rank), home + 1) } else { (End::Left(rank), home - 1) };
                if let Some((start, mut open)) = chain.take() {
                    open.push(self.local(at, home));
                    pieces[home].chains.push(Chain { start, end: leave, points: open });
                }
                if step == n {
                    return;
                }
                home = next_home;
                let enter = if rightwards { End::Left(rank) } else { End::Right(rank) };
                chain = Some((enter, vec![self.local(at, home)]));
            }
        }
    }

    fn local(&self, p: DVec2, piece: usize) -> DVec2 {
        p - self.origin - DVec2::new(self.left_mm[piece], 0.0)
    }
}

/// Contours inside a piece.
#[derive(Debug, Clone, Copy, Default)]
struct Loops {
    islands: u32,
    holes: u32,
}

impl Loops {
    fn count(&mut self, is_island: bool) {
        if is_island {
            self.islands += 1;
        } else {
            self.holes += 1;
        }
    }
}

/// The descriptor of a piece from its chains and loops.
fn descriptor(piece: &Piece, Loops { islands, holes }: Loops) -> Descriptor {
    let left = piece.left.len();
    let total = left + piece.right.len();
    let slot = |end: End| match end {
        End::Left(k) => k,
        End::Right(k) => left + k,
    };
    // Endpoints joined along chains and across portals make the closed walks.
    let mut label: Vec<usize> = (0..total).collect();
    let find = |label: &[usize], mut a: usize| {
        while label[a] != a {
            a = label[a];
        }
        a
    };
    let chains = piece.chains.iter().map(|c| (slot(c.start), slot(c.end)));
    let portals = (0..total).step_by(2).map(|top| (top, top + 1));
    for (a, b) in chains.chain(portals) {
        let (a, b) = (find(&label, a), find(&label, b));
        label[a.max(b)] = a.min(b);
    }
    let of_portals = |from: usize, to: usize| -> Vec<u32> {
        (from..to).step_by(2).map(|top| find(&label, top) as u32).collect()
    };
    let open = (0..total).filter(|&a| label[a] == a).count() as i64;
    let euler = open + i64::from(islands) - i64::from(holes);
    Descriptor::new(&of_portals(0, left), &of_portals(left, total), islands, euler)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{self, FillRule, Tolerances};
    use crate::reeb::{ReebGraph, Slicing, SlicingRule};
    use proptest::prelude::*;

    fn region(boxes: &[(i64, i64, i64, i64)]) -> Region {
        planar::boxes(100_000_000, FillRule::EvenOdd, boxes)
    }

    fn pieces(region: &Region, rule: SlicingRule) -> Vec<Piece> {
        let reeb = ReebGraph::new(region);
        let slicing = Slicing::new(region, &reeb, rule, &Tolerances::default()).unwrap();
        cut_up(region, &slicing.cuts)
    }

    #[test]
    fn a_frame_falls_into_two_brackets() {
        let frame = region(&[(0, 0, 30, 20), (10, 5, 10, 10)]);
        let found = pieces(&frame, SlicingRule::Uniform { lines: 1 });
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].descriptor, Descriptor::new(&[], &[0, 0], 0, 1));
        assert_eq!(found[1].descriptor, Descriptor::new(&[0, 0], &[], 0, 1));
        let chain = &found[0].chains[0];
        assert_eq!((chain.start, chain.end), (End::Right(0), End::Right(3)), "the outside, ink on the left");
        assert_eq!(chain.points.len(), 4);
    }

    proptest! {
        // The join of all pieces in their own order is the exemplar again.
        #[test]
        fn joined_descriptors_count_the_exemplar(
            boxes in prop::collection::vec((0i64..60, 0i64..30, 1i64..30, 1i64..20), 1..16),
            lines in 1usize..14,
            events in any::<bool>(),
        ) {
            let region = region(&boxes);
            prop_assume!(!region.is_empty());
            let rule = if events { SlicingRule::Reeb { persistence_mm: 0.0 } } else { SlicingRule::Uniform { lines } };
            let found = pieces(&region, rule);
            let mut run = found[0].descriptor.clone();
            for piece in &found[1..] {
                run = run.join(&piece.descriptor).unwrap();
            }
            let topology = run.finished().unwrap();
            prop_assert_eq!(topology.components as usize, region.components());
            prop_assert_eq!(topology.holes as usize, region.holes());
            // Each chain ends where another begins in the neighbour, and endpoints descend.
            for piece in &found {
                for side in [&piece.left, &piece.right] {
                    prop_assert!(side.windows(2).all(|w| w[0].y_mm > w[1].y_mm));
                }
                prop_assert_eq!(piece.chains.len() * 2, piece.left.len() + piece.right.len());
            }
        }
    }
}
