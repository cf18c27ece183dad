//! A closed band that was laid flat, judged as what it is: its two sides are one place.
//!
//! Where it was cut open there is a border that the part does not have. So it is judged with what lies beyond, copies of itself. Excluded: the
//! counts, which need no widths.

use glam::DVec2;

use super::making::{check_widths, worst_places};
use crate::planar::{FillRule, Grid, GridPoint, Region, Tolerances};
use crate::verify::{Mismatch, NarrowPlaces, Narrowest};

/// What lies within so many heights of the cut is measured with what is beyond it.
const NEAR_HEIGHTS: f64 = 1.0;

/// How the sides of a flat band are joined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joined {
    /// Where along the curve it was cut, in millimetres: its left side.
    pub(super) cut_mm: f64,
    /// Where its left and right sides are on the page.
    pub(super) sides_mm: [f64; 2],
}

impl Joined {
    fn length_mm(&self) -> f64 {
        self.sides_mm[1] - self.sides_mm[0]
    }

    /// The flat band between two copies of itself, which share their sides exactly.
    fn with_copies(&self, flat: &Region) -> Region {
        let [left, right] = self.sides_mm.map(|x| flat.grid().steps(x));
        let length = right - left;
        let copies = [-length, 0, length].map(|by| flat.shifted(GridPoint::new(by, 0)));
        Region::union(flat.grid(), &copies)
    }

    /// Whether all ink and all gaps of the flat band have their widths.
    ///
    /// # Errors
    /// The [`Mismatch`].
    pub(super) fn check_widths(&self, flat: &Region, tolerances: &Tolerances) -> Result<(), Mismatch> {
        let [feature_mm, gap_mm] = [tolerances.min_feature_mm(), tolerances.min_gap_mm()];
        if feature_mm == 0.0 && gap_mm == 0.0 {
            return Ok(());
        }
        let only = |feature_mm: f64, gap_mm: f64| {
            Tolerances::new(tolerances.chord_mm(), feature_mm, gap_mm).expect("each was in range before")
        };
        let copies = self.with_copies(flat);
        // Strands that are cut off at the ends of the copies must not come off: they are held by a bar.
        let (low, high) = copies.bounds_mm().unwrap_or_default();
        let wide = 4.0 * feature_mm + 1.0;
        let length = self.length_mm();
        let bars = [self.sides_mm[0] - length, self.sides_mm[1] + length].map(|x| {
            let (left, right) = (x - wide, x + wide);
            vec![(left, low.y), (right, low.y), (right, high.y), (left, high.y)]
        });
        let barred = add(&copies, &bars);
        check_widths(&barred, &only(feature_mm, 0.0))?;
        check_widths(&copies, &only(0.0, gap_mm))
    }

    /// The narrowest places of the flat band, of which `found` were found as if its sides were borders.
    pub(super) fn narrow_places(
        &self,
        found: &NarrowPlaces,
        flat: &Region,
        tolerances: &Tolerances,
    ) -> NarrowPlaces {
        let (low, high) = flat.bounds_mm().unwrap_or_default();
        let near = (NEAR_HEIGHTS * (high.y - low.y)).min(0.25 * self.length_mm());
        let [left, right] = self.sides_mm;
        // As far again on both sides of the cut, so that what is measured has no border near.
        let window = [right - 2.0 * near, right + 2.0 * near];
        let around = worst_places(&between(&self.with_copies(flat), window), tolerances);
        let merged = |own: &[_], beyond: &[_]| {
            let is_far = |x: f64| x - left > near && right - x > near;
            let on_page = |place: &Narrowest| {
                let mut place = *place;
                if place.position_mm.x > right {
                    place.position_mm.x -= self.length_mm();
                }
                place
            };
            let own = own.iter().copied().filter(|p: &Narrowest| is_far(p.position_mm.x));
            let beyond =
                beyond.iter().filter(|p: &&Narrowest| (p.position_mm.x - right).abs() <= near).map(on_page);
            let mut all: Vec<_> = own.chain(beyond).collect();
            all.sort_by(|a, b| a.width_mm.total_cmp(&b.width_mm));
            all.truncate(NarrowPlaces::WORST);
            all
        };
        NarrowPlaces { ink: merged(&found.ink, &around.ink), gaps: merged(&found.gaps, &around.gaps) }
    }
}

fn on(grid: Grid, path: &[(f64, f64)]) -> Vec<GridPoint> {
    path.iter().map(|&(x, y)| GridPoint::new(grid.steps(x), grid.steps(y))).collect()
}

/// The region with the insides of closed paths, counter-clockwise, in millimetres.
fn add(region: &Region, paths: &[Vec<(f64, f64)>]) -> Region {
    let grid = region.grid();
    let own = region.contours().map(|c| c.points().to_vec());
    let all: Vec<Vec<GridPoint>> = own.chain(paths.iter().map(|path| on(grid, path))).collect();
    Region::fill(grid, &all, FillRule::Positive)
}

/// What of a region lies between two upright lines.
fn between(region: &Region, [left, right]: [f64; 2]) -> Region {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let (low, high) = (low - DVec2::ONE, high + DVec2::ONE);
    let grid = region.grid();
    // Taken once off everywhere, and added between the lines: what is left is ink there.
    let all = on(grid, &[(low.x, low.y), (low.x, high.y), (high.x, high.y), (high.x, low.y)]);
    let strip = on(grid, &[(left, low.y), (right, low.y), (right, high.y), (left, high.y)]);
    let own = region.contours().map(|c| c.points().to_vec());
    let paths: Vec<Vec<GridPoint>> = own.chain([all, strip]).collect();
    Region::fill(grid, &paths, FillRule::Positive)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip from 1 to 101 with a strand of 2 mm all along, which is thinner where it was cut open.
    fn waisted(waist_mm: f64) -> (Region, Joined) {
        let grid = Grid::for_extent(512.0).unwrap();
        let half = 0.5 * waist_mm;
        let path = [
            (1.0, 10.0 - half),
            (2.0, 9.0),
            (100.0, 9.0),
            (101.0, 10.0 - half),
            (101.0, 10.0 + half),
            (100.0, 11.0),
            (2.0, 11.0),
            (1.0, 10.0 + half),
        ];
        let region = Region::fill(grid, &[on(grid, &path)], FillRule::Positive);
        (region, Joined { cut_mm: 0.0, sides_mm: [1.0, 101.0] })
    }

    #[test]
    fn a_waist_at_the_cut_is_found() {
        let (flat, joined) = waisted(0.3);
        let tolerances = |feature| Tolerances::new(0.01, feature, 0.0).unwrap();
        assert!(joined.check_widths(&flat, &tolerances(0.25)).is_ok());
        assert!(matches!(joined.check_widths(&flat, &tolerances(0.4)), Err(Mismatch::Feature { .. })));
        // As a flat part it has no waist.
        assert!(check_widths(&flat, &tolerances(0.4)).is_ok());
        let found = worst_places(&flat, &tolerances(0.0));
        let places = joined.narrow_places(&found, &flat, &tolerances(0.0));
        assert!((places.ink[0].width_mm - 0.3).abs() < 1e-3, "{:?}", places.ink);
        let x = places.ink[0].position_mm.x;
        assert!((x - 1.0).abs() < 0.1 || (x - 101.0).abs() < 0.1, "{x}");
    }

    #[test]
    fn a_gap_over_the_cut_is_found() {
        let grid = Grid::for_extent(512.0).unwrap();
        // Two strands, 0.2 mm apart near the cut and joined further on.
        let boxes = [
            vec![(1.0, 0.0), (101.0, 0.0), (101.0, 2.0), (1.0, 2.0)],
            vec![(1.0, 2.2), (101.0, 2.2), (101.0, 4.0), (1.0, 4.0)],
            vec![(4.0, 1.0), (98.0, 1.0), (98.0, 3.0), (4.0, 3.0)],
        ];
        let paths: Vec<_> = boxes.iter().map(|path| on(grid, path)).collect();
        let flat = Region::fill(grid, &paths, FillRule::Positive);
        let joined = Joined { cut_mm: 0.0, sides_mm: [1.0, 101.0] };
        let tolerances = |gap| Tolerances::new(0.01, 0.0, gap).unwrap();
        assert!(joined.check_widths(&flat, &tolerances(0.15)).is_ok());
        assert!(matches!(joined.check_widths(&flat, &tolerances(0.3)), Err(Mismatch::Gap { .. })));
    }
}
