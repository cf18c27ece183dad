//! Bays that the beam does not get into: they change no count, and the part has ink there in the end.
//!
//! Where a gap that matters is narrower than the kerf, the part is refused ([`super::kerf`]). A gap that ends blind, as a notch
//! or the mouth of a spiral, matters to no count; the lines run past its mouth, and it stays filled. Every sharp inner
//! corner loses a little so, which nobody sees; what is as large as the kerf is wide is told.

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use crate::planar::{GridError, Region};

/// Slivers thinner than so many chord errors are rounding.
const SLIVER: f64 = 2.0;
/// Chords of round joins are at most this part of the radius.
const ARC_PART: f64 = 0.002;
/// Bays of less area than this part of a square as wide as the kerf are corners: a notch of 20 degrees loses about one.
const LEAST: f64 = 1.0;

/// A bay that stays filled. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FilledBay {
    /// The middle of the box around it.
    pub position_mm: [f64; 2],
    /// The longer side of that box.
    pub length_mm: f64,
    /// How much of it stays filled, in square millimetres.
    pub area_mm2: f64,
}

/// The bays of `ink` that stay filled when a beam of width `kerf_mm` follows the contours of `cut`, the largest first.
///
/// # Errors
/// [`GridError`] when the ink does not fit the grid of the cut.
pub fn filled_bays(
    ink: &Region,
    cut: &Region,
    kerf_mm: f64,
    chord_mm: f64,
) -> Result<Vec<FilledBay>, GridError> {
    let grid = cut.grid();
    let arc_mm = (0.25 * chord_mm).min(ARC_PART * kerf_mm);
    let left = cut.offset(-0.5 * kerf_mm, arc_mm);
    let filled = left.without(&ink.placed(grid, |p| p)?);
    let sliver_mm = SLIVER * chord_mm;
    let solid = filled.offset(-0.5 * sliver_mm, arc_mm).offset(0.5 * sliver_mm, arc_mm);
    let bays = solid.parts().iter().map(|part| {
        let (low, high) = part.exterior().bounds();
        let (low, high): (DVec2, DVec2) = (grid.to_mm(low), grid.to_mm(high));
        let area_mm2 = part.contours().map(|contour| contour.area_mm2(grid)).sum();
        FilledBay {
            position_mm: low.midpoint(high).to_array(),
            length_mm: (high - low).max_element(),
            area_mm2,
        }
    });
    let mut bays: Vec<FilledBay> = bays.filter(|bay| bay.area_mm2 >= LEAST * kerf_mm * kerf_mm).collect();
    bays.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2));
    Ok(bays)
}

#[cfg(test)]
mod tests {
    use super::super::compensated;
    use super::*;
    use crate::planar::{FillRule, Grid, boxes};

    #[test]
    fn a_narrow_slit_is_told_and_corners_are_not() {
        // A plate of 20 by 10 mm with slits of 0.1 and 0.3 mm from above, as the even-odd rule takes them out.
        let step = Grid::for_extent(100.0).unwrap().steps(0.1);
        let slits = [(0, 0, 200, 100), (50, 60, 1, 40), (120, 60, 3, 40)];
        let plate = boxes(step, FillRule::EvenOdd, &slits);
        let bays = |kerf_mm: f64| {
            let cut = compensated(&plate, kerf_mm, 0.01).unwrap();
            filled_bays(&plate, &cut, kerf_mm, 0.01).unwrap()
        };
        assert_eq!(bays(0.08), []);
        let found = bays(0.2);
        assert_eq!(found.len(), 1, "{found:?}");
        let [x, y] = found[0].position_mm;
        assert!((x - 5.05).abs() < 0.05 && (y - 8.0).abs() < 0.2, "{found:?}");
        assert!(
            (found[0].area_mm2 - 0.4).abs() < 0.05 && (found[0].length_mm - 4.0).abs() < 0.3,
            "{found:?}"
        );
        assert_eq!(bays(0.5).len(), 2);
    }
}
