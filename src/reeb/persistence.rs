//! How large each event is: its persistence.
//!
//! A small bump on a contour makes a pair of events that are close together. Events are paired with the
//! partner that they cancel with when the Reeb graph is simplified, smallest pair first: a strand that
//! begins and soon merges, or splits off and soon ends, is a leaf and is pruned; two strands that split and
//! merge again around a hole are made one. The distance in x of the pair is the persistence of both. Loops
//! that interlock, as in a lattice, never become parallel and are never cancelled: their events keep an
//! infinite persistence. (The paper groups events by distance instead, Zhou 2014 §5.2.2.)

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use petgraph::graph::NodeIndex;

use super::graph::{Event, ReebGraph};

/// The persistence of every critical point in grid steps, in sweep order; `None` for events that cancel with
/// nothing.
pub fn persistence(reeb: &ReebGraph) -> Vec<Option<i64>> {
    let mut state = Simplification::new(reeb);
    while let Some(Reverse((span, arc))) = state.queue.pop() {
        state.cancel(span, arc);
    }
    state.persistence
}

struct Arc {
    from: usize,
    to: usize,
    alive: bool,
}

struct Simplification {
    x: Vec<i64>,
    event: Vec<Event>,
    arcs: Vec<Arc>,
    arriving: Vec<Vec<usize>>,
    leaving: Vec<Vec<usize>>,
    queue: BinaryHeap<Reverse<(i64, usize)>>,
    persistence: Vec<Option<i64>>,
}

impl Simplification {
    fn new(reeb: &ReebGraph) -> Self {
        let n = reeb.len();
        let mut new = Self {
            x: reeb.points().map(|(_, p)| p.at.x).collect(),
            event: reeb.points().map(|(_, p)| p.event).collect(),
            arcs: Vec::new(),
            arriving: vec![Vec::new(); n],
            leaving: vec![Vec::new(); n],
            queue: BinaryHeap::new(),
            persistence: vec![None; n],
        };
        for edge in reeb.graph().edge_indices() {
            let ends = reeb.graph().edge_endpoints(edge);
            let (from, to): (NodeIndex, NodeIndex) = ends.expect("an edge has ends");
            new.add_arc(from.index(), to.index());
        }
        new
    }

    fn add_arc(&mut self, from: usize, to: usize) {
        let arc = self.arcs.len();
        self.arcs.push(Arc { from, to, alive: true });
        self.leaving[from].push(arc);
        self.arriving[to].push(arc);
        self.queue.push(Reverse((self.x[to] - self.x[from], arc)));
    }

    fn remove_arc(&mut self, arc: usize) {
        let Arc { from, to, .. } = self.arcs[arc];
        self.arcs[arc].alive = false;
        self.leaving[from].retain(|&a| a != arc);
        self.arriving[to].retain(|&a| a != arc);
    }

    fn cancel(&mut self, span: i64, arc: usize) {
        let Arc { from, to, alive } = self.arcs[arc];
        if !alive {
            return;
        }
        let parallel = self.leaving[from].iter().copied().find(|&a| a != arc && self.arcs[a].to == to);
        match (self.event[from], self.event[to], parallel) {
            (Event::Begin, Event::Merge, _)
            | (Event::Split, Event::End, _)
            | (Event::Begin, Event::End, _) => {}
            (Event::Split, Event::Merge, Some(other)) => self.remove_arc(other),
            _ => return,
        }
        self.remove_arc(arc);
        self.persistence[from] = Some(span);
        self.persistence[to] = Some(span);
        // What is left of a split or merge is a strand that passes through.
        for node in [from, to] {
            self.join_through(node);
        }
        // A split and a merge that have cancelled leave the strand into the one for the strand out of the other.
        if let (Some(&a), Some(&b)) = (self.arriving[from].first(), self.leaving[to].first()) {
            let (before, after) = (self.arcs[a].from, self.arcs[b].to);
            self.remove_arc(a);
            self.remove_arc(b);
            self.add_arc(before, after);
        }
    }

    fn join_through(&mut self, node: usize) {
        if let ([a], [b]) = (self.arriving[node].as_slice(), self.leaving[node].as_slice()) {
            let (a, b) = (*a, *b);
            let (before, after) = (self.arcs[a].from, self.arcs[b].to);
            self.remove_arc(a);
            self.remove_arc(b);
            self.add_arc(before, after);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid, GridPoint, Region};

    fn spans(paths: &[&[(i64, i64)]]) -> Vec<Option<i64>> {
        let paths: Vec<Vec<GridPoint>> = paths
            .iter()
            .map(|p| p.iter().map(|&(x, y)| GridPoint::new(x * 10_000, y * 10_000)).collect())
            .collect();
        let region = Region::fill(Grid::for_extent(100.0).unwrap(), &paths, FillRule::EvenOdd);
        persistence(&ReebGraph::new(&region)).iter().map(|p| p.map(|steps| steps / 10_000)).collect()
    }

    #[test]
    fn a_notch_is_as_large_as_it_is_deep() {
        // A plate with a notch of depth 3 in its right side: its split cancels with the shorter prong's end.
        let plate: &[(i64, i64)] = &[(0, 0), (20, 0), (17, 4), (22, 8), (0, 8)];
        assert_eq!(spans(&[plate]), [Some(22), Some(3), Some(3), Some(22)]);
    }

    #[test]
    fn a_hole_is_as_large_as_it_is_wide() {
        let plate: &[(i64, i64)] = &[(0, 0), (20, 0), (20, 9), (0, 9)];
        let hole: &[(i64, i64)] = &[(8, 4), (10, 2), (13, 4), (10, 6)];
        assert_eq!(spans(&[plate, hole]), [Some(20), Some(5), Some(5), Some(20)]);
    }

    #[test]
    fn interlocked_loops_do_not_cancel() {
        // Nor do the ends of the plate, which hang on them.
        let plate: &[(i64, i64)] = &[(0, 0), (20, 0), (20, 9), (0, 9)];
        let low: &[(i64, i64)] = &[(3, 3), (7, 2), (11, 3), (7, 4)];
        let high: &[(i64, i64)] = &[(6, 7), (10, 6), (14, 7), (10, 8)];
        assert_eq!(spans(&[plate, low, high]), [None; 6]);
    }
}
