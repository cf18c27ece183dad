//! The sweep that builds the Reeb graph.
//!
//! Vertices are visited in (x, y) order, which shears away ties in x: no two vertices are met at once and no
//! edge is vertical. The edges that cross the sweep line are kept from top to bottom; as no contours touch,
//! exact orientation of the vertex against an edge always decides on which side it lies. Consecutive pairs
//! of active edges bound the strands.

use std::cmp::Ordering;

use petgraph::graph::{DiGraph, NodeIndex};

use super::graph::{CriticalPoint, Event, Strand};
use crate::planar::{GridPoint, Region, orient};

/// An edge that crosses the sweep line, from its least to its greatest end.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Active {
    left: GridPoint,
    right: GridPoint,
}

struct Visit {
    at: GridPoint,
    before: GridPoint,
    after: GridPoint,
}

pub(super) fn reeb_graph(region: &Region) -> DiGraph<CriticalPoint, Strand> {
    let mut visits = Vec::with_capacity(region.vertices());
    for contour in region.contours() {
        let points = contour.points();
        let n = points.len();
        visits.extend((0..n).map(|i| Visit {
            at: points[i],
            before: points[(i + n - 1) % n],
            after: points[(i + 1) % n],
        }));
    }
    visits.sort_unstable_by_key(|v| v.at);
    let mut sweep = Sweep { active: Vec::new(), strands: Vec::new(), graph: DiGraph::new() };
    for visit in &visits {
        sweep.visit(visit);
    }
    debug_assert!(sweep.active.is_empty(), "every edge ends");
    sweep.graph
}

struct Sweep {
    /// Edges across the sweep line, from top to bottom; strand j lies between 2j and 2j + 1.
    active: Vec<Active>,
    /// Where each open strand began.
    strands: Vec<NodeIndex>,
    graph: DiGraph<CriticalPoint, Strand>,
}

impl Sweep {
    fn visit(&mut self, v: &Visit) {
        let position = self.active.partition_point(|e| orient(e.left, e.right, v.at) == Ordering::Less);
        match (v.before > v.at, v.after > v.at) {
            // The boundary passes through: one edge gives way to the next.
            (true, false) => self.active[position] = Active { left: v.at, right: v.before },
            (false, true) => self.active[position] = Active { left: v.at, right: v.after },
            (true, true) => self.open(v, position),
            (false, false) => self.close(v, position),
        }
    }

    fn open(&mut self, v: &Visit, position: usize) {
        let (upper, lower) = if orient(v.at, v.after, v.before) == Ordering::Greater {
            (v.before, v.after)
        } else {
            (v.after, v.before)
        };
        let pair = [upper, lower].map(|right| Active { left: v.at, right });
        self.active.splice(position..position, pair);
        let strand = position / 2;
        if position.is_multiple_of(2) {
            let node = self.node(Event::Begin, v.at);
            self.strands.insert(strand, node);
        } else {
            let node = self.node(Event::Split, v.at);
            self.graph.add_edge(self.strands[strand], node, Strand);
            self.strands.splice(strand..=strand, [node, node]);
        }
    }

    fn close(&mut self, v: &Visit, position: usize) {
        self.active.drain(position..position + 2);
        let strand = position / 2;
        if position.is_multiple_of(2) {
            let node = self.node(Event::End, v.at);
            self.graph.add_edge(self.strands.remove(strand), node, Strand);
        } else {
            let node = self.node(Event::Merge, v.at);
            self.graph.add_edge(self.strands[strand], node, Strand);
            self.graph.add_edge(self.strands[strand + 1], node, Strand);
            self.strands.splice(strand..=strand + 1, [node]);
        }
    }

    fn node(&mut self, event: Event, at: GridPoint) -> NodeIndex {
        self.graph.add_node(CriticalPoint { event, at })
    }
}
