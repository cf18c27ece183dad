//! Exact clipping of a region by its cuts.
//!
//! No vertex lies on a cut, so each contour falls into chains by walking along it: an edge leaves one piece
//! for the next exactly where its ends lie on different sides of a cut. The components of a piece are the
//! closed walks along chains and portals; a contour that reaches no cut is an island if it runs
//! counter-clockwise and a hole if not. Nothing here is decided by a rounded number.
//!
//! Where the lower and the upper side are one place ([`Rim::Joined`]), a piece is a part of a cylinder: ink that lies along both
//! sides is glued there, interval by interval, which unites components and takes one off χ for each.

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::piece::{Chain, End, Endpoint, Piece};
use crate::planar::{Contour, Grid, GridPoint, Region, Sets};
use crate::reeb::Cut;
use crate::topology::Descriptor;

/// The blank before the first ink and after the last, as a part of the exemplar's longer side. Smaller, and
/// copies that are joined end to end nearly touch; larger, and the gap between them shows.
const END_BLANK: f64 = 0.005;

/// What the lower and the upper side of an exemplar are to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rim {
    /// Two borders.
    Apart,
    /// One place, as of a sheet that is rolled: the same ink lies along both.
    Joined,
}

/// The pieces of `region` between `cuts`, left to right.
pub(super) fn cut_up(region: &Region, cuts: &[Cut], rim: Rim) -> Vec<Piece> {
    let Some((low, high)) = region.bounds_mm() else {
        return Vec::new();
    };
    let grid = region.grid();
    let rims = (rim == Rim::Joined).then(|| [grid.steps(low.y), grid.steps(high.y)]);
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
    let walk = Walk { grid, cuts, ranks, rims, origin: DVec2::new(0.0, middle_mm), left_mm: &edges };
    let mut loops = vec![Inside::default(); pieces.len()];
    for (number, contour) in region.contours().enumerate() {
        walk.contour(number, contour, &mut pieces, &mut loops);
    }
    for (piece, inside) in pieces.iter_mut().zip(loops) {
        piece.chains.sort_by_key(|chain| chain.start.order());
        piece.descriptor = descriptor(piece, &inside);
    }
    pieces
}

struct Walk<'a> {
    grid: Grid,
    cuts: &'a [Cut],
    /// Contour, edge and cut to the crossing's number from the top.
    ranks: FxHashMap<(usize, usize, usize), usize>,
    /// The lower and the upper side, if they are joined.
    rims: Option<[i64; 2]>,
    origin: DVec2,
    /// Where each piece begins.
    left_mm: &'a [f64],
}

impl Walk<'_> {
    fn contour(&self, number: usize, contour: &Contour, pieces: &mut [Piece], inside: &mut [Inside]) {
        let points = contour.points();
        let piece_of = |x: i64| self.cuts.partition_point(|c| c.x < x);
        let homes: Vec<usize> = points.iter().map(|p| piece_of(p.x)).collect();
        let n = points.len();
        let Some(first) = (0..n).find(|&i| homes[i] != homes[(i + 1) % n]) else {
            let home = homes[0];
            let local = points.iter().map(|&p| self.local(self.grid.to_mm(p), home)).collect();
            pieces[home].loops.push(local);
            // Exact: the orientation is that of the contour on its grid.
            let island = inside[home].count(contour.is_counter_clockwise());
            contour.edges().for_each(|edge| self.along_rims(edge, Owner::Island(island), &mut inside[home]));
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
            if let Some((start, _)) = chain.as_ref().filter(|_| home == homes[j]) {
                self.along_rims((points[i], points[j]), Owner::Chain(*start), &mut inside[home]);
            }
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

    /// Notes an edge that lies along a side that is joined to the other. None crosses a cut there.
    fn along_rims(&self, (a, b): (GridPoint, GridPoint), owner: Owner, inside: &mut Inside) {
        let Some(side) = self.rims.filter(|_| a.y == b.y).and_then(|ys| ys.iter().position(|&y| y == a.y))
        else {
            return;
        };
        inside.rims[side].push(Stretch { from: a.x.min(b.x), to: a.x.max(b.x), owner });
    }

    fn local(&self, p: DVec2, piece: usize) -> DVec2 {
        p - self.origin - DVec2::new(self.left_mm[piece], 0.0)
    }
}

/// What is inside a piece beside its chains.
#[derive(Debug, Clone, Default)]
struct Inside {
    islands: u32,
    holes: u32,
    /// Ink along the lower and the upper side, if they are joined.
    rims: [Vec<Stretch>; 2],
}

/// A stretch of ink along a side.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    from: i64,
    to: i64,
    owner: Owner,
}

/// What a stretch of ink along a side is a part of.
#[derive(Debug, Clone, Copy)]
enum Owner {
    /// The chain that starts there.
    Chain(End),
    /// An island, by its number in the piece.
    Island(u32),
}

impl Inside {
    /// Counts a contour; the number of an island is the one it has, and of a hole has no meaning.
    fn count(&mut self, is_island: bool) -> u32 {
        match is_island {
            true => self.islands += 1,
            false => self.holes += 1,
        }
        self.islands.saturating_sub(1)
    }

    /// The owners of ink that is glued, interval by interval. Where the sides differ there is nothing to pair, and the part that
    /// comes of it does not have the counts of its plan.
    fn glued(&self) -> Vec<(Owner, Owner)> {
        let intervals = |side: &[Stretch]| {
            let mut sorted = side.to_vec();
            sorted.sort_unstable_by_key(|stretch| stretch.from);
            sorted.chunk_by(|a, b| a.to == b.from).map(|chunk| chunk[0].owner).collect::<Vec<_>>()
        };
        let [lower, upper] = self.rims.each_ref().map(|side| intervals(side));
        lower.into_iter().zip(upper).collect()
    }
}

/// The descriptor of a piece from its chains and what is inside.
fn descriptor(piece: &Piece, inside: &Inside) -> Descriptor {
    let left = piece.left.len();
    let total = left + piece.right.len();
    let slot = |end: End| match end {
        End::Left(k) => k,
        End::Right(k) => left + k,
    };
    // Endpoints joined along chains and across portals make the closed walks; islands come after them.
    let islands = inside.islands as usize;
    let mut walks = Sets::new(total + islands);
    let chains = piece.chains.iter().map(|c| (slot(c.start), slot(c.end)));
    let portals = (0..total).step_by(2).map(|top| (top, top + 1));
    chains.chain(portals).for_each(|(a, b)| walks.join(a, b));
    let roots = |walks: &mut Sets| (0..total + islands).filter(|&i| walks.find(i) == i).count() as i64;
    let euler = roots(&mut walks) - i64::from(inside.holes);
    let glued = inside.glued();
    let number = |owner: Owner| match owner {
        Owner::Chain(start) => slot(start),
        Owner::Island(island) => total + island as usize,
    };
    glued.iter().for_each(|&(lower, upper)| walks.join(number(lower), number(upper)));
    let of_portals: Vec<u32> = (0..total).step_by(2).map(|top| walks.find(top) as u32).collect();
    let all = roots(&mut walks);
    let mut open = of_portals.clone();
    open.sort_unstable();
    open.dedup();
    let closed = (all - open.len() as i64) as u32;
    let (left_labels, right_labels) = of_portals.split_at(left / 2);
    Descriptor::new(left_labels, right_labels, closed, euler - glued.len() as i64)
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
        cut_up(region, &slicing.cuts, Rim::Apart)
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
