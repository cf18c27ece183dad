//! One piece.

use glam::DVec2;

use crate::topology::Descriptor;

/// One end of a portal (Zhou 2014 §3.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Endpoint {
    /// Height above the middle of the exemplar, in millimetres.
    pub y_mm: f64,
    /// The unit tangent of the contour here, pointing right.
    pub tangent: DVec2,
}

impl Endpoint {
    /// The slope dy/dx of the contour here.
    pub fn slope(&self) -> f64 {
        self.tangent.y / self.tangent.x
    }
}

/// An endpoint of a piece by its side and its number from the top. Portal j has endpoints 2j and 2j + 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum End {
    /// On the left cut.
    Left(usize),
    /// On the right cut.
    Right(usize),
}

impl End {
    /// Orders ends: the left side first, each from the top.
    pub(super) fn order(self) -> (usize, usize) {
        match self {
            Self::Left(k) => (0, k),
            Self::Right(k) => (1, k),
        }
    }
}

/// A part of a contour inside a piece, from cut to cut, with the ink on its left.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Where it enters the piece.
    pub start: End,
    /// Where it leaves.
    pub end: End,
    /// Its vertices, both ends included: x in millimetres from the left cut, y above the exemplar's middle.
    pub points: Vec<DVec2>,
}

/// The ink between two neighbouring cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Where the piece begins, in millimetres from where the first piece does; of a mirrored piece, in the
    /// mirrored exemplar.
    pub x_mm: f64,
    /// Its width w in millimetres.
    pub width_mm: f64,
    /// Portal endpoints on the left cut, top to bottom.
    pub left: Vec<Endpoint>,
    /// Portal endpoints on the right cut, top to bottom.
    pub right: Vec<Endpoint>,
    /// Parts of contours that reach a cut.
    pub chains: Vec<Chain>,
    /// Contours inside the piece: counter-clockwise islands and clockwise holes; coordinates as in [`Chain`].
    pub loops: Vec<Vec<DVec2>>,
    /// How its portals are connected inside it, and what is closed there.
    pub descriptor: Descriptor,
}

impl Piece {
    /// The number of portals on the left cut.
    pub fn left_portals(&self) -> usize {
        self.left.len() / 2
    }

    /// The number of portals on the right cut.
    pub fn right_portals(&self) -> usize {
        self.right.len() / 2
    }

    /// Whether its ink is that of `other` to within a tolerance, vertex by vertex: where an exemplar repeats a motif, it
    /// has such pieces.
    pub fn looks_like(&self, other: &Self, tolerance_mm: f64) -> bool {
        let is_near = |a: &DVec2, b: &DVec2| a.distance(*b) <= tolerance_mm;
        let are_near =
            |a: &[DVec2], b: &[DVec2]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_near(a, b));
        let are_alike =
            |a: &Chain, b: &Chain| (a.start, a.end) == (b.start, b.end) && are_near(&a.points, &b.points);
        (self.width_mm - other.width_mm).abs() <= tolerance_mm
            && self.descriptor == other.descriptor
            && self.chains.len() == other.chains.len()
            && self.chains.iter().zip(&other.chains).all(|(a, b)| are_alike(a, b))
            && self.loops.len() == other.loops.len()
            && self.loops.iter().zip(&other.loops).all(|(a, b)| are_near(a, b))
    }

    /// How far its ink is from its left and its right side, in millimetres; 0 on a side with portals, and on
    /// both without ink.
    pub fn blanks_mm(&self) -> (f64, f64) {
        let points = self.chains.iter().map(|c| &c.points).chain(&self.loops).flatten();
        let range = points.map(|p| (p.x, p.x)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        range.map_or((0.0, 0.0), |(low, high)| (low, self.width_mm - high))
    }
}
