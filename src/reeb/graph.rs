//! The Reeb graph of a region under the height function x.

use petgraph::graph::{DiGraph, NodeIndex};

use super::sweep;
use crate::planar::{GridPoint, Region};

/// What happens to the strands of ink as the sweep passes a critical point (Zhou 2014 Figure 12).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// A strand begins.
    Begin,
    /// A strand ends.
    End,
    /// One strand becomes two.
    Split,
    /// Two strands become one.
    Merge,
}

impl Event {
    /// The event's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Begin => "begin",
            Self::End => "end",
            Self::Split => "split",
            Self::Merge => "merge",
        }
    }
}

/// A vertex at which the number of strands changes: a local extremum in x of a contour. Several vertices at
/// one x count once, and ties are broken as if the plane were sheared by an infinitesimal amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CriticalPoint {
    /// What happens here.
    pub event: Event,
    /// Where, on the region's grid.
    pub at: GridPoint,
}

/// A strand: ink between two critical points that a vertical line meets in one interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strand;

/// Critical points and the strands between them, directed from left to right. Its first Betti number is the
/// number of holes of the region, and its connected components are the region's.
#[derive(Debug, Clone)]
pub struct ReebGraph {
    graph: DiGraph<CriticalPoint, Strand>,
}

impl ReebGraph {
    /// The Reeb graph of `region`; nodes are in sweep order.
    pub fn new(region: &Region) -> Self {
        Self { graph: sweep::reeb_graph(region) }
    }

    /// The graph.
    pub fn graph(&self) -> &DiGraph<CriticalPoint, Strand> {
        &self.graph
    }

    /// The critical points in sweep order.
    pub fn points(&self) -> impl Iterator<Item = (NodeIndex, &CriticalPoint)> {
        self.graph.node_indices().map(|n| (n, &self.graph[n]))
    }

    /// The number of critical points.
    pub fn len(&self) -> usize {
        self.graph.node_count()
    }

    /// Whether the region had no ink.
    pub fn is_empty(&self) -> bool {
        self.graph.node_count() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{self, FillRule};
    use petgraph::algo::connected_components;
    use proptest::prelude::*;

    fn region(boxes: &[(i64, i64, i64, i64)]) -> Region {
        planar::boxes(1, FillRule::EvenOdd, boxes)
    }

    fn events(region: &Region) -> Vec<Event> {
        ReebGraph::new(region).points().map(|(_, p)| p.event).collect()
    }

    #[test]
    fn a_frame_splits_and_merges() {
        use Event::{Begin, End, Merge, Split};
        let frame = region(&[(0, 0, 1000, 1000), (200, 200, 300, 300)]);
        assert_eq!(events(&frame), [Begin, Split, Merge, End]);
        assert_eq!(events(&region(&[(0, 0, 10, 10), (0, 20, 10, 10)])), [Begin, Begin, End, End]);
    }

    proptest! {
        #[test]
        fn betti_numbers_are_the_regions(
            boxes in prop::collection::vec((0i64..40, 0i64..40, 1i64..25, 1i64..25), 1..14)
        ) {
            let boxes: Vec<_> = boxes.iter().map(|&(x, y, w, h)| (x * 5000, y * 5000, w * 5000, h * 5000)).collect();
            let region = region(&boxes);
            let reeb = ReebGraph::new(&region);
            let (nodes, arcs) = (reeb.graph().node_count(), reeb.graph().edge_count());
            let components = connected_components(reeb.graph());
            prop_assert_eq!(components, region.components());
            prop_assert_eq!(arcs + components - nodes, region.holes());
        }
    }
}
