//! Parts that count, and that a machine will make nothing of: those that are thin everywhere, and those that are tiny.
//!
//! A printer fills outlines with lines as wide as its nozzle. A component in which no disc of that width fits gets no
//! line at all, and slicers leave it out, some without a word. Excluded: thin places of what is wide elsewhere, which
//! the room that judges files measures.

use glam::DVec2;

use crate::planar::{Contour, FillRule, Grid, Part, Region};

/// Chords of the erosion, as a part of the width: what is thinner than the width by less than that may be missed.
const ARC_PART: f64 = 0.005;
/// Sums of lengths and angles are this exact, and far more so.
const ROUNDING: f64 = 1e-9;

/// The middles of the boxes around those components of `region` that are nowhere as wide as `width_mm`.
pub fn thin_everywhere(region: &Region, width_mm: f64) -> Vec<DVec2> {
    let grid = region.grid();
    let is_doubtful = |part: &&Part| !is_surely_wide(part, grid, 0.5 * width_mm);
    let doubtful: Vec<&Part> = region.parts().iter().filter(is_doubtful).collect();
    let outlines = doubtful.iter().flat_map(|part| part.contours()).map(|c| c.points().to_vec());
    let ink = Region::fill(grid, &outlines.collect::<Vec<_>>(), FillRule::Positive);
    let left = ink.offset(-0.5 * width_mm, ARC_PART * width_mm);
    let mut is_lost = vec![true; doubtful.len()];
    for piece in left.parts() {
        let p = piece.exterior().points()[0];
        if let Some(i) = doubtful.iter().position(|part| part.covers(p)) {
            is_lost[i] = false;
        }
    }
    let lost = doubtful.iter().zip(is_lost).filter(|(_, is_lost)| *is_lost);
    lost.map(|(part, _)| middle(region, part.exterior())).collect()
}

/// Whether there is more of a part than can lie within `radius_mm` of its outline, so that a disc fits. What lies so near
/// lies beside an edge, or at a corner that turns away from the ink, in the sector between its edges' normals.
fn is_surely_wide(part: &Part, grid: Grid, radius_mm: f64) -> bool {
    let (mut length_mm, mut turns) = (0.0, 0.0);
    for contour in part.contours() {
        let points = contour.points();
        let edge = |i: usize| {
            let [p, q] = [i, i + 1].map(|i| grid.to_mm(points[i % points.len()]));
            q - p
        };
        for i in 0..points.len() {
            let (here, next) = (edge(i), edge(i + 1));
            length_mm += here.length();
            // The ink is on the left, so a turn to the right is away from it.
            turns += (-here.angle_to(next)).max(0.0);
        }
    }
    let area_mm2: f64 = part.contours().map(|contour| contour.area_mm2(grid)).sum();
    area_mm2 > (radius_mm * length_mm + 0.5 * radius_mm * radius_mm * turns) * (1.0 + ROUNDING)
}

/// The middles of the boxes around those components and holes of `region` whose outlines are around less than `area_mm2`.
pub fn smaller_than(region: &Region, area_mm2: f64) -> Vec<DVec2> {
    let grid = region.grid();
    let tiny = region.contours().filter(|contour| contour.area_mm2(grid).abs() < area_mm2);
    tiny.map(|contour| middle(region, contour)).collect()
}

fn middle(region: &Region, contour: &Contour) -> DVec2 {
    let (low, high) = contour.bounds();
    region.grid().to_mm(low).midpoint(region.grid().to_mm(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::boxes;

    /// Boxes with a corner and a size in tenths of a millimetre.
    fn region(of: &[(i64, i64, i64, i64)]) -> Region {
        boxes(Grid::for_extent(100.0).unwrap().steps(0.1), FillRule::EvenOdd, of)
    }

    #[test]
    fn what_is_wide_somewhere_is_not_lost() {
        // A thread, a thread with a knob, a frame of threads, and a plate.
        let thread = (0, 0, 3, 100);
        let frame = [(100, 0, 60, 60), (103, 3, 54, 54)];
        let of = [thread, (20, 0, 3, 100), (23, 50, 4, 7), frame[0], frame[1], (200, 0, 50, 50)];
        let lost = thin_everywhere(&region(&of), 0.4);
        assert_eq!(lost.len(), 2, "{lost:?}");
        assert!(
            lost[0].distance(DVec2::new(0.15, 5.0)) < 1e-6 && lost[1].distance(DVec2::new(13.0, 3.0)) < 1e-6
        );
        assert!(thin_everywhere(&region(&of), 0.2).is_empty());
    }

    #[test]
    fn enough_ink_has_room_for_a_disc() {
        let grid = region(&[(0, 0, 5, 5)]).grid();
        let is_wide = |of, radius_mm| is_surely_wide(&region(of).parts()[0], grid, radius_mm);
        // A square of 5 mm holds a disc of 5 mm; half of that is sure.
        assert!(is_wide(&[(0, 0, 50, 50)], 1.24) && !is_wide(&[(0, 0, 50, 50)], 1.26));
        // Four corners of the hole of a frame turn away from its ink.
        let frame = [(0, 0, 50, 50), (10, 10, 30, 30)];
        let sectors = |r: f64| 32.0 * r + 0.5 * r * r * std::f64::consts::TAU;
        let most = (1..500).map(|i| f64::from(i) * 1e-3).take_while(|&r| sectors(r) < 16.0).last().unwrap();
        assert!(is_wide(&frame, most) && !is_wide(&frame, most + 1e-3));
    }

    #[test]
    fn tiny_parts_and_holes_are_found() {
        let found =
            smaller_than(&region(&[(0, 0, 50, 50), (10, 10, 1, 1), (100, 0, 1, 2), (120, 0, 2, 3)]), 0.025);
        assert_eq!(found.len(), 2);
        assert!(found[0].distance(DVec2::new(1.05, 1.05)) < 1e-6, "{found:?}");
    }
}
