//! Smaller sections of one component, with the walls between them.
//!
//! A component that goes in from all its edges by some distance is its erosion. The solid between the two is
//! sound only if the smaller section lies in the larger as a shrunk copy: then what is left between them is one
//! ring for each contour, with that contour on one side and its copy on the other. Equal counts alone do not
//! tell, as a tip may fall off where a hole bursts; the rings do. Where one is missing or two flow together,
//! the ink is narrower than what goes in from both sides.

use glam::DVec2;
use rstar::RTree;
use rustc_hash::FxHashSet;

use super::snap::snapped_to;
use crate::planar::{Contour, GridPoint, Part, Region};

/// Halvings in the search for the largest inset: the answer is within a thousandth of what was wanted.
const HALVINGS: u32 = 10;

/// Where a section is no shrunk copy of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NotInset {
    pub(super) position_mm: DVec2,
}

/// The component `whole` without what is within `inset_mm` of its edges, where round corners are kept within
/// `chord_mm`, on the same grid.
pub(super) fn inset(whole: &Region, inset_mm: f64, chord_mm: f64) -> Result<Region, NotInset> {
    if inset_mm == 0.0 {
        return Ok(whole.clone());
    }
    let smaller = without_islets(whole.offset(-inset_mm, chord_mm), inset_mm * inset_mm);
    // Without the very short edges that an offset makes in corners.
    let smaller = snapped_to(&smaller, whole.grid()).map_err(|_| lost(whole))?;
    match rings(whole, &smaller) {
        Ok(_) => Ok(smaller),
        Err(fault) => Err(fault),
    }
}

/// A section without what is left in tips that are a little thicker at their ends than behind: islets of less than
/// `area_mm2` beside a larger part. The slope has a roof there, as in every tip.
fn without_islets(section: Region, area_mm2: f64) -> Region {
    let grid = section.grid();
    let areas = section.parts().iter().map(|part| part.contours().map(|c| c.area_mm2(grid)).sum::<f64>());
    let largest = areas.fold(0.0, f64::max);
    match section.components() {
        0 | 1 => section,
        _ => section.without_specks(area_mm2.min(largest)).0,
    }
}

/// The rings between a section and a smaller one: parts with an exterior and one hole, of which one is a contour of
/// `outer` and the other a reversed one of `inner`.
pub(super) fn rings(outer: &Region, inner: &Region) -> Result<Region, NotInset> {
    let reversed = |contour: &Contour| {
        let points = contour.points().iter().rev().copied().collect();
        Contour::new(points).expect("the reverse of a contour is one")
    };
    let contours = outer.contours().cloned().chain(inner.contours().map(reversed)).collect();
    let between = Region::from_contours(outer.grid(), contours).map_err(|_| lost(outer))?;
    let outline: FxHashSet<GridPoint> = outer.contours().flat_map(Contour::points).copied().collect();
    let is_outer = |contour: &Contour| outline.contains(&contour.points()[0]);
    let is_ring = |part: &&Part| {
        let [hole] = part.holes() else { return false };
        is_outer(part.exterior()) != is_outer(hole)
    };
    match between.parts().iter().find(|part| !is_ring(part)) {
        Some(part) => Err(NotInset { position_mm: narrow_place(&between, part, is_outer) }),
        None => Ok(between),
    }
}

/// The largest inset up to `wanted_mm` that was seen to work for all components; 0 when none was.
pub(super) fn largest(parts: &[Region], wanted_mm: f64, chord_mm: f64) -> f64 {
    let (mut works, mut fails) = (0.0, wanted_mm);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (works + fails);
        match parts.iter().all(|part| inset(part, middle, chord_mm).is_ok()) {
            true => works = middle,
            false => fails = middle,
        }
    }
    works
}

/// Nothing is left of a component, or nothing that can be told.
fn lost(region: &Region) -> NotInset {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    NotInset { position_mm: (low + high) * 0.5 }
}

/// Where two contours that should not be in one ring come nearest: two of the section, between which the ink is too
/// narrow, or two into which its copy fell apart, between which it was.
fn narrow_place(region: &Region, part: &Part, is_outer: impl Fn(&Contour) -> bool) -> DVec2 {
    let grid = region.grid();
    let points = |contour: &Contour| contour.points().iter().map(|&p| grid.to_mm(p)).collect::<Vec<_>>();
    let mut nearest: Option<(f64, DVec2)> = None;
    for side in [true, false] {
        let alike: Vec<Vec<DVec2>> = part.contours().filter(|c| is_outer(c) == side).map(points).collect();
        for (i, one) in alike.iter().enumerate() {
            let others = alike[i + 1..].iter().flatten().map(|p| p.to_array()).collect();
            let tree = RTree::bulk_load(others);
            for &p in one {
                let Some(&q) = tree.nearest_neighbor(p.to_array()) else { continue };
                let q = DVec2::from_array(q);
                if nearest.is_none_or(|(distance, _)| p.distance(q) < distance) {
                    nearest = Some((p.distance(q), (p + q) * 0.5));
                }
            }
        }
    }
    nearest.map_or_else(|| grid.to_mm(part.exterior().points()[0]), |(_, place)| place)
}

#[cfg(test)]
mod tests {
    use super::super::solid::tests::rectangles;
    use super::*;

    #[test]
    fn a_frame_goes_in_from_both_sides() {
        let frame = rectangles(&[(0.0, 0.0, 10.0, 10.0), (2.0, 2.0, 6.0, 6.0)]);
        let smaller = inset(&frame, 0.5, 0.01).unwrap();
        assert_eq!((smaller.components(), smaller.holes()), (1, 1));
        // The hole's corners are rounded.
        assert!((smaller.area_mm2() - (81.0 - 49.0 + 0.25 * (4.0 - std::f64::consts::PI))).abs() < 0.02);
        assert_eq!(rings(&frame, &smaller).unwrap().components(), 2);
        assert!((largest(&[frame], 3.0, 0.01) - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_neck_is_named_by_its_place() {
        let bone = [(0.0, 0.0, 10.0, 10.0), (20.0, 0.0, 10.0, 10.0), (10.0, 4.0, 10.0, 1.0)];
        let NotInset { position_mm } = inset(&rectangles(&bone), 0.6, 0.01).unwrap_err();
        assert!((position_mm - DVec2::new(15.0, 4.5)).length() < 6.0, "{position_mm}");
        assert!((position_mm.y - 4.5).abs() < 4.5);
        assert!((largest(&[rectangles(&bone)], 0.6, 0.01) - 0.5).abs() < 0.002);
    }

    #[test]
    fn a_thin_wall_is_named_by_its_place() {
        let wall = rectangles(&[(0.0, 0.0, 10.0, 10.0), (3.0, 3.0, 6.5, 4.0)]);
        let NotInset { position_mm } = inset(&wall, 0.4, 0.01).unwrap_err();
        assert!(position_mm.x > 9.0, "{position_mm}");
    }

    #[test]
    fn a_limb_that_is_lost_is_no_change() {
        let odd = rectangles(&[(0.0, 0.0, 10.0, 10.0), (12.0, 4.0, 1.1, 1.1), (10.0, 4.3, 2.0, 0.5)]);
        let smaller = inset(&odd, 0.6, 0.01).unwrap();
        assert_eq!((smaller.components(), smaller.holes()), (1, 0));
        assert!(inset(&rectangles(&[(0.0, 0.0, 1.0, 1.0)]), 0.6, 0.01).is_err());
    }

    #[test]
    fn a_tip_with_a_knob_gets_a_roof_and_a_head_does_not() {
        let knob =
            |side: f64| rectangles(&[(0.0, 0.0, 10.0, 10.0), (10.0, 4.6, 2.0, 0.8), (12.0, 4.0, side, side)]);
        assert!(inset(&knob(1.2), 0.5, 0.01).is_ok());
        assert!(inset(&knob(2.0), 0.5, 0.01).is_err());
    }

    #[test]
    fn equal_counts_are_not_enough() {
        let frame = rectangles(&[(0.0, 0.0, 10.0, 10.0), (1.0, 1.0, 1.0, 1.0)]);
        let elsewhere = rectangles(&[(4.0, 4.0, 4.0, 4.0), (5.0, 5.0, 1.0, 1.0)]);
        assert_eq!((frame.components(), frame.holes()), (elsewhere.components(), elsewhere.holes()));
        assert!(rings(&frame, &elsewhere).is_err());
    }
}
