//! Pieces to try the room on.

use glam::DVec2;

use super::stitch::SideTarget;
use crate::pieces::{Catalogue, Chain, CostWeights, End, Endpoint, Piece};
use crate::planar::{Grid, Region};

/// A piece 4 mm wide with these chains and loops; endpoints and tangents are those of the chains, and its descriptor
/// is of no account.
fn piece(chains: Vec<Chain>, loops: Vec<Vec<DVec2>>) -> Piece {
    let grid = Grid::for_extent(10.0).unwrap();
    let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)].map(|p| grid.snap(p.into()).unwrap());
    let region = Region::fill(grid, &[square.to_vec()], crate::planar::FillRule::EvenOdd);
    let mut piece = Catalogue::new(&region, &[], &CostWeights::default()).pieces()[0].clone();
    let mut ends: Vec<(End, Endpoint)> = Vec::new();
    for Chain { start, end, points } in &chains {
        let n = points.len();
        for (end, at, next) in [(*start, points[0], points[1]), (*end, points[n - 1], points[n - 2])] {
            let way = (next - at).normalize();
            let tangent = if way.x < 0.0 { -way } else { way };
            ends.push((end, Endpoint { y_mm: at.y, tangent }));
        }
    }
    let side = |of: fn(usize) -> End| -> Vec<Endpoint> {
        let at = |k: usize| ends.iter().find(|(end, _)| *end == of(k)).map(|(_, endpoint)| *endpoint);
        (0..).map_while(at).collect()
    };
    (piece.left, piece.right) = (side(End::Left), side(End::Right));
    (piece.width_mm, piece.chains, piece.loops) = (4.0, chains, loops);
    piece
}

fn path(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&p| p.into()).collect()
}

fn diamond(x: f64, y: f64, r: f64) -> Vec<DVec2> {
    path(&[(x - r, y), (x, y - r), (x + r, y), (x, y + r)])
}

/// A strand from cut to cut with a hole in it and an island above it.
pub(super) fn crossing_strand() -> Piece {
    let bottom = path(&[(0.0, -0.5), (1.0, -0.3), (2.0, -0.6), (3.0, -0.5), (4.0, -0.5)]);
    let top = path(&[(4.0, 0.5), (3.0, 0.6), (2.0, 0.4), (1.0, 0.7), (0.0, 0.5)]);
    let mut hole = diamond(2.0, 0.0, 0.15);
    hole.reverse();
    let chains = vec![
        Chain { start: End::Left(1), end: End::Right(1), points: bottom },
        Chain { start: End::Right(0), end: End::Left(0), points: top },
    ];
    piece(chains, vec![hole, diamond(2.0, 1.5, 0.3)])
}

/// Two thin strands that run level, with a narrow gap between them.
pub(super) fn two_strands() -> Piece {
    let level = |k: usize, y: f64| {
        let points = path(&[(0.0, y), (4.0, y)]);
        if k % 2 == 1 {
            Chain { start: End::Left(k), end: End::Right(k), points }
        } else {
            Chain { start: End::Right(k), end: End::Left(k), points: points.into_iter().rev().collect() }
        }
    };
    let mut chains = vec![level(0, 0.3), level(1, 0.1), level(2, -0.1), level(3, -0.3)];
    chains.sort_by_key(|c| matches!(c.start, End::Right(_)));
    piece(chains, Vec::new())
}

/// The targets that leave the endpoints of a piece where they are.
pub(super) fn targets_of(piece: &Piece) -> (Vec<SideTarget>, Vec<SideTarget>) {
    let keep = |ends: &[Endpoint]| -> Vec<SideTarget> {
        ends.iter().map(|e| SideTarget { y_mm: e.y_mm, tangent: e.tangent }).collect()
    };
    (keep(&piece.left), keep(&piece.right))
}

/// Targets with their tangents turned by so many radians and their heights raised.
pub(super) fn turned(targets: &[SideTarget], angle: f64, rise_mm: f64) -> Vec<SideTarget> {
    let turn = |t: &SideTarget| SideTarget {
        y_mm: t.y_mm + rise_mm,
        tangent: DVec2::from_angle(angle).rotate(t.tangent),
    };
    targets.iter().map(turn).collect()
}
