//! What a seam would look like, beyond the cost of Zhou 2014 §3.6.1.
//!
//! That cost is a mean: of two dozen strands, one that is joined to another three widths away from it hardly counts,
//! and yet it is what everyone sees: the seam shears it into a sliver. The *misfit* is that of the worst strand, in
//! measures of the strand itself. And the cost says nothing of what the seam leaves over: a leaf that meets
//! another by the last hair of its tip, or a strand of which the cut leaves a sliver, fits perfectly. The *weakness* is
//! for these. Excluded: what both cost, and which misfits are accepted at all ([`super::CostWeights`]).

use std::f64::consts::PI;

use glam::DVec2;

use super::piece::{Endpoint, Piece};

/// Strands and slivers that are this wide, as a part of the exemplar's longer side, are wide enough. More, and only
/// the trunk of an ornament is; less, and hairs are.
const WIDE: f64 = 1.0 / 120.0;
/// A seam is held well when this part of the exemplar's height is ink. More, and rows are cut where they are
/// densest; less, and they hang by a leaf.
const HELD: f64 = 0.06;

/// The side of a piece that a seam would be at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side<'a> {
    /// Portal endpoints, top to bottom.
    endpoints: &'a [Endpoint],
    /// How far the nearest place is, in millimetres, at which a contour turns back towards the side or away from it.
    depth_mm: f64,
}

impl<'a> Side<'a> {
    pub(super) fn left(piece: &'a Piece) -> Self {
        Self { endpoints: &piece.left, depth_mm: turns(piece).fold(f64::INFINITY, f64::min) }
    }

    pub(super) fn right(piece: &'a Piece) -> Self {
        let depths = turns(piece).map(|x_mm| piece.width_mm - x_mm);
        Self { endpoints: &piece.right, depth_mm: depths.fold(f64::INFINITY, f64::min) }
    }

    pub(super) fn portals(&self) -> usize {
        self.endpoints.len() / 2
    }

    pub(super) fn endpoints(&self) -> &'a [Endpoint] {
        self.endpoints
    }
}

/// Where contours of `piece` turn back along x, in millimetres from its left side.
fn turns(piece: &Piece) -> impl Iterator<Item = f64> {
    let rows = piece.chains.iter().map(|chain| &chain.points).chain(&piece.loops);
    let turn = |w: &[DVec2]| ((w[1].x - w[0].x) * (w[2].x - w[1].x) < 0.0).then_some(w[1].x);
    rows.flat_map(move |points| points.windows(3).filter_map(turn))
}

/// The misfit of the worst portal where `right` meets `left`, as they lie. It is 0 where every strand goes straight
/// on, and 1 where one lies beside the other by the width of the narrower, is twice as wide, or turns back. The reflection
/// of a side has at most 1.
pub(super) fn misfit(right: &[Endpoint], left: &[Endpoint]) -> f64 {
    let portals = right.chunks_exact(2).zip(left.chunks_exact(2));
    portals.map(|(r, l)| of_portal(r, l)).fold(0.0, f64::max)
}

fn of_portal(right: &[Endpoint], left: &[Endpoint]) -> f64 {
    let middle_mm = |portal: &[Endpoint]| (portal[0].y_mm + portal[1].y_mm) / 2.0;
    let narrow_mm = width_mm(right).min(width_mm(left)).max(f64::MIN_POSITIVE);
    let beside = (middle_mm(right) - middle_mm(left)).abs() / narrow_mm;
    let wider = width_mm(right).max(width_mm(left)) / narrow_mm - 1.0;
    // A leaf that narrows to its tip goes on straight if its middle does.
    let along = |portal: &[Endpoint]| (portal[0].tangent.to_angle() + portal[1].tangent.to_angle()) / 2.0;
    let turned = (along(right) - along(left)).abs() / PI;
    beside.max(wider).max(turned)
}

fn width_mm(portal: &[Endpoint]) -> f64 {
    portal[0].y_mm - portal[1].y_mm
}

/// How weak a seam of `right` and `left` is in an exemplar of this size: 0 where it is held well and nothing beside it
/// is narrow, 1 where it hangs by a hair, 2 where it also leaves one over. A seam without portals is neither.
pub(super) fn weakness(right: Side<'_>, left: Side<'_>, longer_mm: f64, height_mm: f64) -> f64 {
    if right.endpoints.is_empty() {
        return 0.0;
    }
    let widths = || right.endpoints.chunks_exact(2).chain(left.endpoints.chunks_exact(2)).map(width_mm);
    // What turns back beside the cut leaves a sliver, which is likely to find its like on the other side.
    let sliver_mm = 2.0 * right.depth_mm.min(left.depth_mm);
    let narrowest_mm = widths().fold(sliver_mm, f64::min);
    let lacks = |found: f64, wanted: f64| (1.0 - found / wanted).max(0.0).powi(2);
    lacks(narrowest_mm, WIDE * longer_mm) + lacks(widths().sum::<f64>() / 2.0, HELD * height_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(ys: &[f64], degrees: f64) -> Vec<Endpoint> {
        let tangent = DVec2::from_angle(degrees.to_radians());
        ys.iter().map(|&y_mm| Endpoint { y_mm, tangent }).collect()
    }

    #[test]
    fn the_worst_strand_counts_by_its_own_width() {
        let right = side(&[9.0, 7.0, 2.0, 1.0], 0.0);
        let close = |left: &[Endpoint], wanted: f64| (misfit(&right, left) - wanted).abs() < 1e-12;
        assert!(close(&right, 0.0));
        assert!(close(&side(&[9.5, 7.5, 2.0, 1.0], 0.0), 0.25));
        assert!(close(&side(&[9.5, 7.5, 3.5, 2.5], 0.0), 1.5), "beside it");
        assert!(close(&side(&[9.0, 7.0, 3.0, 0.0], 0.0), 2.0), "three times as wide");
        assert!(close(&side(&[9.0, 7.0, 2.0, 1.0], -45.0), 0.25), "turned");
        assert_eq!(misfit(&[], &[]), 0.0);
    }

    #[test]
    fn a_seam_is_weak_that_hangs_by_a_hair_or_leaves_one_over() {
        let of = |ys: &[f64], depth_mm: f64| {
            let endpoints = side(ys, 0.0);
            let side = Side { endpoints: &endpoints, depth_mm };
            weakness(side, side, 120.0, 100.0)
        };
        // 6 mm of ink hold it, and 1 mm is wide.
        assert_eq!(of(&[9.0, 3.0], f64::INFINITY), 0.0);
        assert_eq!(of(&[9.0, 6.0], f64::INFINITY), 0.25, "half as much ink");
        assert_eq!(of(&[9.0, 3.0], 0.25), 0.25, "two quarters of a millimetre are half");
        assert!((of(&[9.0, 8.999], f64::INFINITY) - 2.0).abs() < 0.01);
        assert_eq!(of(&[], 0.0), 0.0);
    }
}
