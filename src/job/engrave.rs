//! What is engraved on a part before it is cut: the outlines of another drawing.
//!
//! The drawing lies on the part's own page, or on the plate if there is one, the lower left corners of both together, so that
//! it can be drawn over the part's SVG, or over the file of cut lines. Its ink is read like an exemplar's; what is engraved are the outlines of it, closed and each once, as the
//! part itself is cut. All of it must lie on material that is kept, and none along a cut. Excluded: filling areas by hatching them, which the
//! programs of lasers do.

use std::path::Path;

use glam::DVec2;

use super::error::JobError;
use super::report::InputReport;
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::fabricate::FabricateError;
use crate::planar::{EdgeIndex, FillRule, Grid, GridPoint, Region};

/// What is engraved, and where it is from.
pub(super) struct Engraving {
    /// The ink of the drawing.
    region: Region,
    file: String,
    pub(super) input: InputReport,
}

impl Engraving {
    /// The drawing in `file`, its curves within `chord_mm`.
    pub(super) fn read(file: &Path, chord_mm: f64) -> Result<Self, JobError> {
        let options = ReadOptions { chord_mm, target_height_mm: None, limits: Limits::default() };
        let drawing = Exemplar::read(file, &options)?;
        let file = file.display().to_string();
        let input = InputReport { file: file.clone(), sha256: drawing.sha256().to_owned() };
        Ok(Self { region: drawing.region().clone(), file, input })
    }

    /// What is engraved on `kept`, on `grid`. It may reach beyond it by `chord_mm`, and not onto `fallen`, which is a part
    /// of it.
    ///
    /// # Errors
    /// [`JobError::Option`] names a place where there is no material, or where it is cut along the same
    /// line.
    pub(super) fn on(
        &self,
        kept: &Region,
        fallen: Option<&Region>,
        grid: Grid,
        chord_mm: f64,
    ) -> Result<Region, JobError> {
        let (low, high) = kept.bounds_mm().unwrap_or_default();
        let points = || self.region.contours().flat_map(|contour| contour.points());
        let on_page = |p| self.region.grid().to_mm(p);
        // What is far away has no place on the part's grid.
        let is_beyond = |p: &DVec2| p.cmplt(low - chord_mm).any() || p.cmpgt(high + chord_mm).any();
        if let Some(place) = points().map(|&p| on_page(p)).find(is_beyond) {
            return Err(self.misses(place));
        }
        let paths = |region: &Region| -> Result<Vec<Vec<GridPoint>>, JobError> {
            let on_grid = region.placed(grid, |p| p).map_err(FabricateError::from)?;
            Ok(on_grid.contours().map(|contour| contour.points().to_vec()).collect())
        };
        let engraved = Region::fill(grid, &paths(&self.region)?, FillRule::Positive);
        let mut missing = paths(&engraved)?;
        if let Some(fallen) = fallen {
            missing.extend(paths(fallen)?);
        }
        for mut path in paths(&kept.offset(chord_mm, chord_mm))? {
            path.reverse();
            missing.push(path);
        }
        if let Some(beyond) = Region::fill(grid, &missing, FillRule::Positive).contours().next() {
            return Err(self.misses(grid.to_mm(beyond.points()[0])));
        }
        match along_cuts(&engraved, kept, chord_mm) {
            None => Ok(engraved),
            Some(place) => Err(self.burns(place)),
        }
    }

    fn burns(&self, place: DVec2) -> JobError {
        JobError::Option {
            option: "--engrave",
            found: format!(
                "{} is engraved along a cut, at ({:.2}, {:.2}) mm, so that the edge burns",
                self.file, place.x, place.y
            ),
            wanted: "end its ink a little inside of the part, or draw it as a hole of the part".to_owned(),
        }
    }

    fn misses(&self, place: DVec2) -> JobError {
        JobError::Option {
            option: "--engrave",
            found: format!(
                "{} has ink where there is no material, at ({:.2}, {:.2}) mm",
                self.file, place.x, place.y
            ),
            wanted: "draw it over the part, from the lower left corner of the part's own page, or of the plate with --sheet".to_owned(),
        }
    }
}

/// Where an edge of `engraved` runs along the contours of `kept`, nowhere farther from them than `chord_mm`; corners may
/// touch them.
fn along_cuts(engraved: &Region, kept: &Region, chord_mm: f64) -> Option<DVec2> {
    let cuts = EdgeIndex::new(kept);
    let is_near = |p: DVec2| cuts.nearest_within(p, chord_mm).is_some();
    let edges = engraved.contours().flat_map(|contour| contour.edges());
    let mut edges = edges.map(|(a, b)| [engraved.grid().to_mm(a), engraved.grid().to_mm(b)]);
    let is_along =
        |&[a, b]: &[DVec2; 2]| a.distance(b) > chord_mm && [a, a.midpoint(b), b].into_iter().all(is_near);
    edges.find(is_along).map(|[a, b]| a.midpoint(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::boxes;

    fn region(of: &[(i64, i64, i64, i64)]) -> Region {
        boxes(Grid::for_extent(100.0).unwrap().steps(1.0), FillRule::EvenOdd, of)
    }

    fn engraving(of: &[(i64, i64, i64, i64)]) -> Engraving {
        let input = InputReport { file: "name.svg".to_owned(), sha256: String::new() };
        Engraving { region: region(of), file: "name.svg".to_owned(), input }
    }

    /// A frame: material around a hole from (20, 10) to (40, 20).
    const FRAME: [(i64, i64, i64, i64); 2] = [(5, 5, 50, 30), (20, 10, 20, 10)];

    #[test]
    fn what_lies_on_material_is_engraved() {
        let engraving = engraving(&[(6, 7, 10, 20), (8, 9, 4, 4)]);
        let frame = region(&FRAME);
        let engraved = engraving.on(&frame, None, frame.grid(), 0.01).unwrap();
        let (low, high) = engraved.bounds_mm().unwrap();
        assert!(low.distance(DVec2::new(6.0, 7.0)) < 1e-6 && high.distance(DVec2::new(16.0, 27.0)) < 1e-6);
        assert_eq!((engraved.components(), engraved.holes()), (1, 1));
    }

    #[test]
    fn what_is_engraved_along_a_cut_is_refused_with_its_place() {
        let frame = region(&FRAME);
        let on = |of: &[(i64, i64, i64, i64)]| engraving(of).on(&frame, None, frame.grid(), 0.01);
        // The frame itself, and a box at the left side of its hole.
        for of in [&FRAME[..], &[(16, 13, 4, 2)]] {
            let error = on(of).unwrap_err().to_string();
            assert!(
                error.contains("name.svg is engraved along a cut, at (") && error.contains("; end"),
                "{error}"
            );
        }
        assert!(on(&[(16, 13, 4, 2)]).unwrap_err().to_string().contains("at (20.00, 14.00) mm"));
        assert!(on(&[(16, 13, 3, 2)]).is_ok());
    }

    #[test]
    fn what_misses_the_material_is_refused_with_its_place() {
        let frame = region(&FRAME);
        let message = |of: &[(i64, i64, i64, i64)], fallen: Option<&Region>| {
            engraving(of).on(&frame, fallen, frame.grid(), 0.01).unwrap_err().to_string()
        };
        // Over the hole of the frame, which begins at (20, 10).
        let over = message(&[(11, 13, 20, 4)], None);
        assert!(over.contains("name.svg") && over.contains("at (20.01, 13.00)"), "{over}");
        assert!(message(&[(80, 12, 5, 5)], None).contains("at (80.00, 12.00)"));
        let fallen = region(&[(42, 10, 8, 8)]);
        assert!(message(&[(44, 12, 2, 2)], Some(&fallen)).contains("at (44.00, 12.00)"));
    }
}
