//! Pieces as a mirror shows them, left for right.
//!
//! Zhou 2014 has no mirrored pieces; a scroll that may also run the other way has twice as many ways to go on.
//! Reflection turns the ink to the right of every contour, so chains and loops are reversed as well. What was the
//! exemplar's next piece is its previous one in the mirror.

use glam::DVec2;

use super::piece::{Chain, End, Endpoint, Piece};
use crate::topology::Descriptor;

/// `piece` of an exemplar whose pieces are `total_mm` wide together, left for right.
pub(super) fn mirrored(piece: &Piece, total_mm: f64) -> Piece {
    let reflect = |p: &DVec2| DVec2::new(piece.width_mm - p.x, p.y);
    let reversed = |points: &[DVec2]| points.iter().rev().map(reflect).collect::<Vec<_>>();
    let mut chains: Vec<Chain> = piece
        .chains
        .iter()
        .map(|chain| Chain {
            start: opposite(chain.end),
            end: opposite(chain.start),
            points: reversed(&chain.points),
        })
        .collect();
    chains.sort_by_key(|chain| chain.start.order());
    let d = &piece.descriptor;
    let wide = |labels: &[u16]| labels.iter().map(|&l| u32::from(l)).collect::<Vec<_>>();
    Piece {
        x_mm: total_mm - piece.x_mm - piece.width_mm,
        width_mm: piece.width_mm,
        left: piece.right.iter().map(turned).collect(),
        right: piece.left.iter().map(turned).collect(),
        chains,
        loops: piece.loops.iter().map(|points| reversed(points)).collect(),
        descriptor: Descriptor::new(&wide(d.right()), &wide(d.left()), d.closed(), d.euler()),
    }
}

fn opposite(end: End) -> End {
    match end {
        End::Left(k) => End::Right(k),
        End::Right(k) => End::Left(k),
    }
}

/// Tangents point right on either side of the mirror.
fn turned(endpoint: &Endpoint) -> Endpoint {
    Endpoint { tangent: DVec2::new(endpoint.tangent.x, -endpoint.tangent.y), ..*endpoint }
}
