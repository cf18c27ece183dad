//! Outlines with fewer vertices within a tolerance, for meshes that may have only so many triangles.
//!
//! Vertices that lie near the line between those that stay are left out (Douglas and Peucker 1973). That alone
//! could make contours cross where they run close; so the result must be a valid region with the same counts,
//! and else less is left out.

use super::snap::same_counts;
use crate::planar::{Contour, GridPoint, Region};

/// Halvings of the tolerance before an outline is left as it is: contours that are so close keep their vertices.
const HALVINGS: u32 = 6;

/// `region` without vertices that the lines between the others pass within `tolerance_mm`, with the same components
/// and holes.
pub(super) fn simplified(region: &Region, tolerance_mm: f64) -> Region {
    let mut tolerance = tolerance_mm / region.grid().step_mm();
    for _ in 0..=HALVINGS {
        let thin = |contour: &Contour| {
            Contour::new(thinned(contour.points(), tolerance)).unwrap_or_else(|| contour.clone())
        };
        match Region::from_contours(region.grid(), region.contours().map(thin).collect()) {
            Ok(simpler) if same_counts(&simpler, region) => return simpler,
            _ => tolerance *= 0.5,
        }
    }
    region.clone()
}

/// The vertices of a closed contour that stay, by a tolerance in steps.
fn thinned(points: &[GridPoint], tolerance: f64) -> Vec<GridPoint> {
    let n = points.len();
    let from_first = |i: &usize| distance(points[*i], points[0], points[0]);
    let far =
        (1..n).max_by(|i, j| from_first(i).total_cmp(&from_first(j))).expect("a contour has three points");
    let mut stays = vec![false; n];
    (stays[0], stays[far]) = (true, true);
    let mut stack = vec![(0, far), (far, n)];
    while let Some((from, to)) = stack.pop() {
        let off = |i: usize| distance(points[i], points[from], points[to % n]);
        let farthest = (from + 1..to).map(|i| (off(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, middle)) = farthest.filter(|&(off, _)| off > tolerance) {
            stays[middle] = true;
            stack.extend([(from, middle), (middle, to)]);
        }
    }
    points.iter().zip(stays).filter_map(|(&p, stays)| stays.then_some(p)).collect()
}

/// From `p` to the segment between `a` and `b`, in steps.
fn distance(p: GridPoint, a: GridPoint, b: GridPoint) -> f64 {
    let minus = |p: GridPoint, q: GridPoint| glam::DVec2::new((p.x - q.x) as f64, (p.y - q.y) as f64);
    let (along, to_p) = (minus(b, a), minus(p, a));
    let length = along.length_squared();
    let t = if length > 0.0 { (to_p.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (to_p - along * t).length()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::super::solid::tests::{rectangles, region};
    use super::*;
    use crate::planar::{EdgeIndex, FillRule, Grid};

    fn circle(radius_mm: f64, sides: usize) -> Region {
        let grid = Grid::for_extent(100.0).unwrap();
        let turn = std::f64::consts::TAU / sides as f64;
        let point = |i: usize| grid.snap(DVec2::from_angle(turn * i as f64) * radius_mm + 50.0).unwrap();
        Region::fill(grid, &[(0..sides).map(point).collect()], FillRule::NonZero)
    }

    #[test]
    fn a_circle_keeps_what_its_tolerance_asks_for() {
        let fine = circle(40.0, 5000);
        let coarse = simplified(&fine, 0.05);
        // A chord of a circle is off by r (1 − cos(π/n)): 63 sides would do, halving makes some more.
        assert!((63..130).contains(&coarse.vertices()), "{}", coarse.vertices());
        assert_eq!(simplified(&rectangles(&[(0.0, 0.0, 5.0, 5.0)]), 1.0).vertices(), 4);
    }

    #[test]
    fn contours_that_are_close_do_not_cross() {
        // A ring 0.02 mm wide.
        let grid = Grid::for_extent(100.0).unwrap();
        let path = |r: f64| circle(r, 2000).contours().next().unwrap().points().to_vec();
        let ring = Region::fill(grid, &[path(30.0), path(29.98)], FillRule::EvenOdd);
        let simpler = simplified(&ring, 0.5);
        assert_eq!((simpler.components(), simpler.holes()), (1, 1));
        assert!(simpler.vertices() < ring.vertices());
    }

    proptest! {
        #[test]
        fn simpler_outlines_stay_within_the_tolerance(region in region(), tolerance in 0.01..2.0f64) {
            prop_assume!(!region.is_empty());
            let simpler = simplified(&region, tolerance);
            prop_assert!(same_counts(&simpler, &region) && simpler.vertices() <= region.vertices());
            let edges = EdgeIndex::new(&simpler);
            for p in region.contours().flat_map(|c| c.points()).map(|&p| region.grid().to_mm(p)) {
                let off = edges.nearest(p).unwrap().nearest(p).distance(p);
                prop_assert!(off <= tolerance * 1.000_001, "{} is off by {} > {}", p, off, tolerance);
            }
        }
    }
}
