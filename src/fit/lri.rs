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
/// Larger, and contours arrive at a portal at another angle than their frames; smaller, and they overshoot on the way.
const SLACK_ALONG: f64 = 0.05;
/// The length ℓ of links across. Larger, and strands change their width; smaller, and where they have to, they do so
/// at once, as a bump.
const SLACK_ACROSS: f64 = 0.1;
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
                // The quotient of two unit vectors that both point right, less 1; exactly 0 if they are equal.
                turns.push((target.tangent - end.tangent).rotate(conjugate(end.tangent)));
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

#[cfg(test)]
mod tests {
    use super::super::sample_pieces::{crossing_strand, targets_of, turned};
    use super::*;
    use proptest::prelude::*;

    /// The turns less 1 and the moves of all endpoints under p → r p + t, with r as a complex number.
    fn similarity(piece: &Piece, r: DVec2, t: DVec2) -> (Vec<DVec2>, Vec<DVec2>) {
        let left = piece.left.iter().map(|e| DVec2::new(0.0, e.y_mm));
        let right = piece.right.iter().map(|e| DVec2::new(piece.width_mm, e.y_mm));
        let places = left.chain(right);
        places.map(|p| (r - DVec2::X, r.rotate(p) + t - p)).unzip()
    }

    #[test]
    fn a_piece_that_nothing_moves_keeps_every_bit() {
        let piece = crossing_strand();
        let lri = Lri::new(&piece).unwrap();
        let (left, right) = targets_of(&piece);
        let targets = Targets { left: &left, right: &right, offset_mm: 0.0, held_mm: None };
        let bent = lri.solved(&targets).bend(&piece, 1e-6);
        for (row, chain) in lri.links.chains.iter().zip(&bent.chains) {
            assert_eq!(&lri.links.nodes[row.clone()], &chain[..]);
        }
        for (row, points) in lri.links.loops.iter().zip(&bent.loops) {
            // A loop ends where it began.
            assert_eq!(&lri.links.nodes[row.start + 1..row.end], &points[..points.len() - 1]);
            assert_eq!(lri.links.nodes[row.start], points[points.len() - 1]);
        }
    }

    #[test]
    fn a_piece_without_portals_has_no_system() {
        let mut piece = crossing_strand();
        (piece.left, piece.right, piece.chains) = Default::default();
        assert!(Lri::new(&piece).is_none());
    }

    #[test]
    fn factorizing_again_changes_no_bit() {
        let piece = crossing_strand();
        let (kept, fresh) = (Lri::new(&piece).unwrap(), Lri::new(&piece).unwrap());
        for angle in [0.1, -0.3, 0.2] {
            let (left, right) = targets_of(&piece);
            let left = turned(&left, angle, 0.2);
            let targets = Targets { left: &left, right: &right, offset_mm: 0.0, held_mm: None };
            assert_eq!(kept.solved(&targets).places, fresh.solved(&targets).places);
        }
    }

    proptest! {
        #[test]
        fn a_turned_and_shifted_boundary_turns_and_shifts_all(
            angle in -1.5f64..1.5, x in -9.0f64..9.0, y in -9.0f64..9.0,
        ) {
            let piece = crossing_strand();
            let lri = Lri::new(&piece).unwrap();
            let (r, t) = (DVec2::from_angle(angle), DVec2::new(x, y));
            let (turns, moves) = similarity(&piece, r, t);
            let found = lri.deformed(turns, &moves);
            for (&drawn, &found) in lri.links.nodes.iter().zip(&found.places) {
                prop_assert!(found.distance(r.rotate(drawn) + t) < 1e-9, "{drawn} went to {found}");
            }
        }

        // Whatever the targets are, turning and shifting them does the same to the result.
        #[test]
        fn what_is_made_does_not_depend_on_how_targets_lie(
            turns in prop::collection::vec(-0.8f64..0.8, 4),
            moves in prop::collection::vec((-0.3f64..0.3, -0.3f64..0.3), 4),
            angle in -3.0f64..3.0, x in -9.0f64..9.0,
        ) {
            let piece = crossing_strand();
            let lri = Lri::new(&piece).unwrap();
            let (r, t) = (DVec2::from_angle(angle), DVec2::new(x, -x));
            let (_, to_origin) = similarity(&piece, DVec2::ZERO, DVec2::ZERO);
            let turns: Vec<DVec2> = turns.iter().map(|&a| DVec2::from_angle(a)).collect();
            let moves: Vec<DVec2> = moves.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            let plain = lri.deformed(turns.iter().map(|&z| z - DVec2::X).collect(), &moves);
            let other: Vec<DVec2> = moves.iter().zip(&to_origin).map(|(&m, &o)| r.rotate(m - o) + t + o).collect();
            let moved = lri.deformed(turns.iter().map(|&z| r.rotate(z) - DVec2::X).collect(), &other);
            for (&p, &q) in plain.places.iter().zip(&moved.places) {
                prop_assert!(q.distance(r.rotate(p) + t) < 1e-8);
            }
        }

        #[test]
        fn endpoints_and_tangents_arrive(
            left_turn in -0.5f64..0.5, right_turn in -0.5f64..0.5, left_rise in -0.4f64..0.4, right_rise in -0.4f64..0.4,
        ) {
            let piece = crossing_strand();
            let lri = Lri::new(&piece).unwrap();
            let (left, right) = targets_of(&piece);
            let (left, right) = (turned(&left, left_turn, left_rise), turned(&right, right_turn, right_rise));
            let targets = Targets { left: &left, right: &right, offset_mm: 0.0, held_mm: None };
            let bent = lri.solved(&targets).bend(&piece, 1e-7);
            for (chain, points) in piece.chains.iter().zip(&bent.chains) {
                let n = points.len();
                for (end, at, next) in [(chain.start, points[0], points[1]), (chain.end, points[n - 1], points[n - 2])] {
                    let (x, target, inward) = match end {
                        End::Left(k) => (0.0, left[k], 1.0),
                        End::Right(k) => (piece.width_mm, right[k], -1.0),
                    };
                    prop_assert!(at.distance(DVec2::new(x, target.y_mm)) < 1e-12);
                    let off = ((next - at) * inward).angle_to(target.tangent).abs().to_degrees();
                    // Of up to 29° of turn and 15° of shear.
                    prop_assert!(off < 4.0, "{end:?} is {off}° off");
                }
            }
        }
    }
}
