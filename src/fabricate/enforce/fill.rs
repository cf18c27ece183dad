//! Bays that are filled: what ends blind, and is not worth a gap or has no room for one.
//!
//! A bay is filled as far as no disc of the minimum gap gets into it from outside: that is what dilating the ink by half
//! of the gap and eroding it again adds. Of what is added all over the region only the pieces are taken that cover a given
//! point of a bay, and of these only as many as change no count.

use glam::DVec2;

use super::super::Counts;
use crate::planar::{FillRule, GridPoint, Part, Region};

/// Chords of round joins are at most this part of the radius.
const ARC_PART: f64 = 0.002;

/// `region` with the bays filled that `points` lie in, which a disc of `radius_mm` does not get into. What is thinner than
/// twice `sliver_mm` is rounding. `None` when there is nothing to fill.
pub(super) fn filled(region: &Region, points: &[DVec2], radius_mm: f64, sliver_mm: f64) -> Option<Region> {
    let grid = region.grid();
    let arc_mm = sliver_mm.min(ARC_PART * radius_mm);
    let closed = region.offset(radius_mm, arc_mm).offset(-radius_mm, arc_mm);
    // Without slivers along the outline, and with a seam to overlap it.
    let added = closed.without(region).offset(-sliver_mm, sliver_mm).offset(2.0 * sliver_mm, sliver_mm);
    let points: Vec<GridPoint> =
        points.iter().map(|p| GridPoint::new(grid.steps(p.x), grid.steps(p.y))).collect();
    let bays: Vec<&Part> =
        added.parts().iter().filter(|part| points.iter().any(|&p| part.covers(p))).collect();
    let before = Counts::of(region);
    let full = with(region, &bays, before);
    (full != *region).then_some(full)
}

/// `region` with as many of `bays` as change no count.
fn with(region: &Region, bays: &[&Part], before: Counts) -> Region {
    if bays.is_empty() {
        return region.clone();
    }
    let contours = bays.iter().flat_map(|bay| bay.contours()).map(|contour| contour.points().to_vec());
    let paths: Vec<Vec<GridPoint>> = contours.collect();
    let added = Region::fill(region.grid(), &paths, FillRule::Positive);
    let full = Region::union(region.grid(), [region, &added]);
    if Counts::of(&full) == before {
        return full;
    }
    if bays.len() == 1 {
        return region.clone();
    }
    let (some, others) = bays.split_at(bays.len() / 2);
    with(&with(region, some, before), others, before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{Grid, boxes};

    /// A plate of 20 by 10 mm with a slit from above, and one through it from top to bottom; tenths of a millimetre.
    fn slit() -> Region {
        let step = Grid::for_extent(100.0).unwrap().steps(0.1);
        boxes(step, FillRule::EvenOdd, &[(0, 0, 200, 100), (50, 60, 2, 40), (120, 0, 2, 100)])
    }

    #[test]
    fn a_bay_is_filled_and_nothing_else() {
        let slit = slit();
        assert_eq!(slit.components(), 2);
        let full = filled(&slit, &[DVec2::new(5.1, 8.0)], 0.2, 1e-3).unwrap();
        assert_eq!(Counts::of(&full), Counts::of(&slit));
        assert!((full.area_mm2() - slit.area_mm2() - 0.8).abs() < 0.03, "{}", full.area_mm2());
        assert_eq!(filled(&slit, &[DVec2::new(5.1, 8.0)], 0.09, 1e-3), None);
    }

    #[test]
    fn what_holds_apart_is_not_filled() {
        let (bay, gap) = (DVec2::new(5.1, 8.0), DVec2::new(12.1, 5.0));
        assert_eq!(filled(&slit(), &[gap], 0.2, 1e-3), None);
        let both = filled(&slit(), &[gap, bay], 0.2, 1e-3);
        assert_eq!(both, filled(&slit(), &[bay], 0.2, 1e-3));
    }
}
