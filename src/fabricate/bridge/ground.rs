//! What a bridge is laid across: the contours of a region, each between one part and one face of the gaps.
//!
//! Ink and gaps are dual. A *strut* lies in a face of the gaps and joins the parts around it; a *slit* lies in
//! a part of the ink and joins the faces around it. So one search serves both: the [`Side`] says what is crossed
//! (the *cell*), and the contours of a cell stand for what can be joined (the *nodes*). Parts and faces nest as
//! a tree, so two contours of one cell never stand for the same node: a bridge between two of them always
//! joins, and a bridge from a contour to itself always makes a loop.

use glam::DVec2;
use rstar::{AABB, RTree};

use crate::planar::{Grid, GridPoint, IndexedEdge, Region};

/// What a bridge crosses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Gaps: ink is added, a strut.
    Gap,
    /// Ink: ink is taken away, a slit.
    Ink,
}

/// One contour of a region in millimetres.
pub(super) struct Rim {
    /// The points; ink is on the left of every edge.
    pub(super) points: Vec<DVec2>,
    /// The same on the grid.
    pub(super) steps: Vec<GridPoint>,
    /// The edges in a tree.
    pub(super) tree: RTree<IndexedEdge>,
    /// Corners of the bounding box.
    pub(super) low: DVec2,
    /// Corners of the bounding box.
    pub(super) high: DVec2,
    /// The part whose boundary it is.
    part: usize,
    /// The face of the gaps on its other side; 0 is the outside.
    face: usize,
}

impl Rim {
    /// The point of the contour that is nearest to `p`.
    pub(super) fn nearest(&self, p: DVec2) -> DVec2 {
        self.tree.nearest_neighbor(p.to_array()).map_or(p, |edge| edge.nearest(p))
    }

    /// The edges whose boxes meet the box from `low` to `high`, in the order of the contour.
    pub(super) fn edges_in(&self, low: DVec2, high: DVec2) -> Vec<IndexedEdge> {
        let envelope = AABB::from_corners(low.to_array(), high.to_array());
        let mut edges: Vec<IndexedEdge> =
            self.tree.locate_in_envelope_intersecting(envelope).copied().collect();
        edges.sort_unstable_by_key(|edge| edge.edge);
        edges
    }

    /// The distance between the bounding box and a point.
    pub(super) fn box_distance(&self, p: DVec2) -> f64 {
        (self.low - p).max(p - self.high).max(DVec2::ZERO).length()
    }
}

/// The grid point nearest to `p`.
pub(super) fn nearest_step(grid: Grid, p: DVec2) -> GridPoint {
    GridPoint::new(grid.steps(p.x), grid.steps(p.y))
}

/// All contours of a region, with what they part.
pub(super) struct Ground {
    /// The contours in the order of [`Region::contours`].
    pub(super) rims: Vec<Rim>,
    /// Of the points.
    pub(super) grid: Grid,
}

impl Ground {
    pub(super) fn new(region: &Region) -> Self {
        let grid = region.grid();
        let mut rims = Vec::new();
        // Faces are numbered by the hole contours in order, after the outside.
        let mut holes = Vec::new();
        for (part, of) in region.parts().iter().enumerate() {
            for (i, contour) in of.contours().enumerate() {
                let index = rims.len();
                if i > 0 {
                    holes.push((index, contour));
                }
                let points: Vec<DVec2> = contour.points().iter().map(|&p| grid.to_mm(p)).collect();
                let edges = (0..points.len()).map(|edge| IndexedEdge {
                    contour: index,
                    edge,
                    from: points[edge],
                    to: points[(edge + 1) % points.len()],
                });
                let (low, high) = contour.bounds();
                rims.push(Rim {
                    tree: RTree::bulk_load(edges.collect()),
                    low: grid.to_mm(low),
                    high: grid.to_mm(high),
                    steps: contour.points().to_vec(),
                    points,
                    part,
                    face: if i > 0 { holes.len() } else { 0 },
                });
            }
        }
        let mut ground = Self { rims, grid };
        let exteriors = region.parts().iter().scan(0, |next, part| {
            let first = *next;
            *next += 1 + part.holes().len();
            Some((first, part.exterior().points()[0]))
        });
        for (exterior, p) in exteriors {
            let at = grid.to_mm(p);
            // The smallest hole around a part is the one that it lies in.
            let around = holes
                .iter()
                .filter(|(rim, contour)| ground.rims[*rim].box_distance(at) == 0.0 && contour.contains(p));
            let innermost = around.min_by_key(|(_, contour)| contour.doubled_area().abs());
            ground.rims[exterior].face = innermost.map_or(0, |&(rim, _)| ground.rims[rim].face);
        }
        ground
    }

    /// What lies on the given side of a contour: only within one cell can there be a bridge.
    pub(super) fn cell(&self, rim: usize, side: Side) -> usize {
        match side {
            Side::Gap => self.rims[rim].face,
            Side::Ink => self.rims[rim].part,
        }
    }

    /// What lies on the other side of a contour, and is joined by a bridge: from 0, without gaps.
    pub(super) fn node(&self, rim: usize, side: Side) -> usize {
        match side {
            Side::Gap => self.rims[rim].part,
            Side::Ink => self.rims[rim].face,
        }
    }

    /// How many nodes there are.
    pub(super) fn nodes(&self, side: Side) -> usize {
        (0..self.rims.len()).map(|rim| self.node(rim, side) + 1).max().unwrap_or(0)
    }

    /// The face that a point in a gap lies in.
    pub(super) fn face_of(&self, region: &Region, p: GridPoint) -> usize {
        let contours = region.contours().enumerate();
        let around = contours.filter(|(_, c)| !c.is_counter_clockwise() && c.contains(p));
        around.min_by_key(|(_, c)| c.doubled_area().abs()).map_or(0, |(rim, _)| self.rims[rim].face)
    }
}
