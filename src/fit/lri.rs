//! Linear rotation-invariant deformation of a piece (Zhou 2014 §4.2; Lipman, Sorkine, Levin and Cohen-Or 2005).
//!
//! Every node of the piece has a frame. In the plane a frame is a complex number, and the differences of frames and
//! of positions, written in the frames themselves, are what does not change when the piece is turned or moved.
//! Let z be what the frame of a node is turned and scaled by, p its new position, and e the link from node i to j as
//! drawn. Then keeping the first differences means p_j − p_i = e (z_i + z_j) / 2, and keeping the second means
//! z_j = z_i. Neither can hold everywhere once the portals are moved and turned, so both hold in least squares:
//!
//! Σ w ( |z_j − z_i|² + |p_j − p_i − e (z_i + z_j) / 2|² / ℓ² ) is least,
//!
//! with z and p given at each portal endpoint. Along a single contour with small ℓ this is the cubic spline, the
//! bend of least energy; the links across (`links`) keep strands from parting.
//!
//! Lipman et al. solve for the frames first and for the positions after them, which is the limit of large ℓ. Then
//! the positions have to make up for what the frames do not add up to, all along the contour, and the contour
//! arrives at a portal at another angle than its frame: a kink at the seam. With both in one system it arrives as
//! it should, and the system is still linear, Hermitian and the same for whatever the targets are. Excluded: any
//! protection from contours that cross; `sound` looks for that.

use glam::DVec2;

use super::least_squares::{Factorized, LeastSquares};
use super::links::Links;
use super::stitch::{Bent, Stitch, Targets};
use crate::pieces::{Chain, End, Endpoint, Piece};

/// The length ℓ of links along a contour, as a part of the piece's width: below it a contour may shear and stretch.
/// Larger, and contours arrive at a portal at another angle than their frames, a kink of 8° in place of 5° at 0.1;
/// smaller, and it makes no difference.
const SLACK_ALONG: f64 = 0.02;
/// The length ℓ of links across. Larger, and strands change their width; smaller, and where they have to, they do so
/// at once, as a bump.
const SLACK_ACROSS: f64 = 0.15;
/// Parts into which an edge is divided at most, as it bends.
const MOST_PARTS: f64 = 64.0;

/// A piece made ready to be deformed: its system of equations, factorized. It depends on the piece alone.
#[derive(Debug, Clone)]
pub struct Lri {
    links: Links,
    /// Fixed are the turns of all endpoints, left then right, and then their positions.
    system: Factorized,
    left: Vec<Endpoint>,
    right: Vec<Endpoint>,
}

impl Lri {
    /// The factorized system of `piece`; `None` without portals, as nothing then holds the piece in place, and for
    /// shapes so extreme that floats cannot factorize it.
    pub fn new(piece: &Piece) -> Option<Self> {
        if piece.left.is_empty() && piece.right.is_empty() {
            return None;
        }
        let links = Links::new(piece);
        let n = links.nodes.len();
        let stiffness = |slack: f64| (slack * piece.width_mm).powi(-2);
        let along = links.along.iter().map(|link| (link, stiffness(SLACK_ALONG)));
        let across = links.across.iter().map(|link| (link, stiffness(SLACK_ACROSS)));
        let mut system = LeastSquares::new(2 * n);
        for (link, stiffness) in along.chain(across) {
            let (i, j) = (link.from, link.to);
            let half = (links.nodes[j] - links.nodes[i]) / 2.0;
            system.add(link.weight, &[(j, DVec2::X), (i, -DVec2::X)]);
            system.add(
                stiffness * link.weight,
                &[(n + j, DVec2::X), (n + i, -DVec2::X), (i, -half), (j, -half)],
            );
        }
        let mut ends: Vec<(usize, usize)> = Vec::with_capacity(2 * piece.chains.len());
        let order = |end: End| match end {
            End::Left(k) => k,
            End::Right(k) => piece.left.len() + k,
        };
        for (Chain { start, end, .. }, row) in piece.chains.iter().zip(&links.chains) {
            ends.push((order(*start), row.start));
            ends.push((order(*end), row.end - 1));
        }
        ends.sort_unstable();
        let turns = ends.iter().map(|&(_, node)| node);
        let fixed: Vec<usize> = turns.clone().chain(turns.map(|node| n + node)).collect();
        Some(Self {
            system: system.factorized(&fixed)?,
            links,
            left: piece.left.clone(),
            right: piece.right.clone(),
        })
    }

    /// The deformation that meets `targets`, which must be as many as the piece has endpoints.
    pub fn solved(&self, targets: &Targets<'_>) -> LriBend<'_> {
        let (mut turns, mut moves) = (Vec::new(), Vec::new());
        for (ends, targets) in [(&self.left, targets.left), (&self.right, targets.right)] {
            for (end, target) in ends.iter().zip(targets) {
                // The quotient of two unit vectors that both point right, less 1.
                turns.push(target.tangent.rotate(conjugate(end.tangent)) - DVec2::X);
                moves.push(DVec2::new(0.0, target.y_mm - end.y_mm));
            }
        }
        self.deformed(turns, &moves)
    }

    /// The deformation with these turns less 1 and these moves of the endpoints, left then right. The unknowns are
    /// what z and p differ by from the piece as drawn, so that what does not move keeps its coordinates to the last
    /// bit.
    fn deformed(&self, mut turns: Vec<DVec2>, moves: &[DVec2]) -> LriBend<'_> {
        turns.extend_from_slice(moves);
        let solved = self.system.minimum(&turns);
        let (turns, moves) = solved.split_at(self.links.nodes.len());
        LriBend {
            links: &self.links,
            turns: turns.iter().map(|&t| t + DVec2::X).collect(),
            places: self.links.nodes.iter().zip(moves).map(|(&p, &m)| p + m).collect(),
        }
    }
}

fn conjugate(z: DVec2) -> DVec2 {
    DVec2::new(z.x, -z.y)
}

/// A piece deformed to its targets.
#[derive(Debug, Clone)]
pub struct LriBend<'a> {
    links: &'a Links,
    /// What the frame of each node is turned and scaled by, as a complex number.
    turns: Vec<DVec2>,
    places: Vec<DVec2>,
}

impl LriBend<'_> {
    /// The image of the edge from node `i` to `j` without its beginning. The turn goes from one node's to the
    /// other's at a constant rate, which bends the edge into a parabola.
    fn edge(&self, i: usize, j: usize, chord_mm: f64, bent: &mut Vec<DVec2>) {
        let along = self.links.nodes[j] - self.links.nodes[i];
        let bend = along.rotate(self.turns[j] - self.turns[i]) / 2.0;
        let straight = self.places[j] - self.places[i];
        // A parabola is furthest from its chord in the middle, by a quarter of its bend.
        let parts = (bend.length() / 4.0 / chord_mm).sqrt().ceil().clamp(1.0, MOST_PARTS);
        for k in 1..parts as usize {
            let t = k as f64 / parts;
            bent.push(self.places[i] + straight * t - bend * (t * (1.0 - t)));
        }
        bent.push(self.places[j]);
    }
}

impl Stitch for LriBend<'_> {
    fn bend(&self, _piece: &Piece, chord_mm: f64) -> Bent {
        let chains = self.links.chains.iter().map(|row| {
            let mut bent = vec![self.places[row.start]];
            (row.start + 1..row.end).for_each(|k| self.edge(k - 1, k, chord_mm, &mut bent));
            bent
        });
        let loops = self.links.loops.iter().map(|row| {
            let mut bent = Vec::new();
            (row.start + 1..row.end).for_each(|k| self.edge(k - 1, k, chord_mm, &mut bent));
            self.edge(row.end - 1, row.start, chord_mm, &mut bent);
            bent
        });
        Bent { chains: chains.collect(), loops: loops.collect() }
    }
}
