//! A part on a plate: laid out in its middle, or carved out of it as a sign.
//!
//! Both are the same contours inside the plate's outline, and differ in what is kept: the part, or what is left of
//! the plate. In the second case holes of the pattern are islands of the plate that nothing holds, and they fall
//! out: the plate has one component more for each hole. Excluded: kerf, and nesting of several parts.

use std::fmt;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

use crate::planar::{FillRule, Grid, GridError, GridPoint, Part, Region};

/// Width and height of a plate in millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SheetSize {
    /// From left to right.
    pub width_mm: f64,
    /// From bottom to top.
    pub height_mm: f64,
}

impl SheetSize {
    /// Refuses what is no plate.
    ///
    /// # Errors
    /// [`SheetError::Size`].
    pub fn check(self) -> Result<(), SheetError> {
        match [self.width_mm, self.height_mm].iter().all(|side| (1.0..=1e4).contains(side)) {
            true => Ok(()),
            false => Err(SheetError::Size { found: self }),
        }
    }
}

impl fmt::Display for SheetSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {} mm", self.width_mm, self.height_mm)
    }
}

/// Why a part does not go on a plate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SheetError {
    /// The plate is no plate.
    #[error("the sheet is {found}; both sides must be from 1 to 10000 mm")]
    Size {
        /// What was given.
        found: SheetSize,
    },
    /// There is nothing to lay on the plate.
    #[error("there is nothing to cut: the region is empty")]
    Empty,
    /// The part is larger than the plate, or too near to its edge.
    #[error(
        "the part is {:.2} x {:.2} mm and needs {edge_mm} mm of the sheet around it; the sheet is {sheet}; take one \
         of at least {:.1} x {:.1} mm, or a smaller part", part_mm.x, part_mm.y,
        part_mm.x + 2.0 * edge_mm, part_mm.y + 2.0 * edge_mm
    )]
    TooSmall {
        /// Width and height of the part.
        part_mm: DVec2,
        /// What is needed on each side.
        edge_mm: f64,
        /// The plate.
        sheet: SheetSize,
    },
    /// A coordinate that does not fit the grid.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// A piece of the plate that nothing holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FallenPiece {
    /// The middle of its bounding box, from the plate's lower left corner.
    #[serde(serialize_with = "as_pair")]
    #[schemars(with = "[f64; 2]")]
    pub position_mm: DVec2,
    /// Width and height of its bounding box.
    #[serde(serialize_with = "as_pair")]
    #[schemars(with = "[f64; 2]")]
    pub size_mm: DVec2,
    /// Its area in square millimetres, without its own openings.
    pub area_mm2: f64,
}

fn as_pair<S: serde::Serializer>(v: &DVec2, serializer: S) -> Result<S::Ok, S::Error> {
    v.to_array().serialize(serializer)
}

/// A plate with a pattern cut out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Carved {
    /// All that is left of the plate, from its lower left corner: the sign, and the pieces that fall out.
    pub plate: Region,
    /// The sign alone.
    pub sign: Region,
    /// The pieces that fall out.
    pub fallen: Region,
    /// Where they are and how large, in the order of their least points.
    pub falls_out: Vec<FallenPiece>,
}

/// `part` in the middle of a plate whose lower left corner is the origin, at least `edge_mm` away from its border.
///
/// # Errors
/// [`SheetError`] for a plate that is none, or on which the part does not fit.
pub fn on_sheet(part: &Region, sheet: SheetSize, edge_mm: f64) -> Result<Region, SheetError> {
    sheet.check()?;
    let size_mm = DVec2::new(sheet.width_mm, sheet.height_mm);
    let (low, high) = part.bounds_mm().ok_or(SheetError::Empty)?;
    let part_mm = high - low;
    if (part_mm + 2.0 * edge_mm).cmpgt(size_mm).any() {
        return Err(SheetError::TooSmall { part_mm, edge_mm, sheet });
    }
    let reach = low.abs().max(high.abs()).max_element();
    let grid = Grid::for_extent(size_mm.max_element().max(reach))?;
    // The grids are powers of two: only onto a coarser one would points move, and this is as fine as there is.
    let placed = part.placed(grid, |p| p)?;
    // By whole steps, so that the part stays what it is.
    let by = shift_onto(part, sheet);
    Ok(placed.shifted(GridPoint::new(grid.steps(by.x), grid.steps(by.y))))
}

/// How far a part is moved to lie in the middle of a plate whose lower left corner is the origin.
pub fn shift_onto(part: &Region, sheet: SheetSize) -> DVec2 {
    let (low, high) = part.bounds_mm().unwrap_or_default();
    (DVec2::new(sheet.width_mm, sheet.height_mm) - low - high) / 2.0
}

/// The plate's own outline as a region, on `grid`.
///
/// # Errors
/// [`SheetError::Grid`] when the plate does not fit the grid.
pub fn plate(grid: Grid, sheet: SheetSize) -> Result<Region, SheetError> {
    let (w, h) = (sheet.width_mm, sheet.height_mm);
    let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
    let corners: Result<Vec<GridPoint>, GridError> =
        corners.into_iter().map(|(x, y)| grid.snap(DVec2::new(x, y))).collect();
    Ok(Region::fill(grid, &[corners?], FillRule::NonZero))
}

/// The plate less `pattern` in its middle, and what falls out of it.
///
/// # Errors
/// As [`on_sheet`].
pub fn carved(pattern: &Region, sheet: SheetSize, edge_mm: f64) -> Result<Carved, SheetError> {
    let pattern = on_sheet(pattern, sheet, edge_mm)?;
    let grid = pattern.grid();
    let mut paths: Vec<Vec<GridPoint>> =
        plate(grid, sheet)?.contours().map(|c| c.points().to_vec()).collect();
    paths.extend(pattern.contours().map(|c| c.points().iter().rev().copied().collect()));
    let left = Region::fill(grid, &paths, FillRule::Positive);
    // The pattern does not reach the border, so one part has it for its exterior.
    let area = |part: &&Part| part.exterior().doubled_area();
    let holds = left.parts().iter().max_by_key(area).ok_or(SheetError::Empty)?;
    let only = |is_sign: bool| {
        let parts = left.parts().iter().filter(|part| (*part == holds) == is_sign).flat_map(Part::contours);
        Region::from_contours(grid, parts.cloned().collect()).expect("parts of a region are a region")
    };
    let (sign, fallen) = (only(true), only(false));
    let piece = |part: &Part| {
        let (low, high) = part.exterior().bounds();
        let (low, high) = (grid.to_mm(low), grid.to_mm(high));
        let area_mm2 = part.contours().map(|c| c.area_mm2(grid)).sum();
        FallenPiece { position_mm: (low + high) / 2.0, size_mm: high - low, area_mm2 }
    };
    let falls_out = fallen.parts().iter().map(piece).collect();
    Ok(Carved { plate: left, sign, fallen, falls_out })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::boxes;

    const SHEET: SheetSize = SheetSize { width_mm: 60.0, height_mm: 40.0 };

    /// Boxes of a corner, a width and a height in millimetres.
    fn region(of: &[(i64, i64, i64, i64)]) -> Region {
        boxes(1 << 26, FillRule::EvenOdd, of)
    }

    fn counts(region: &Region) -> (usize, usize) {
        (region.components(), region.holes())
    }

    #[test]
    fn a_part_goes_to_the_middle() {
        let laid = on_sheet(&region(&[(3, 3, 20, 10), (5, 5, 2, 2)]), SHEET, 1.0).unwrap();
        let (low, high) = laid.bounds_mm().unwrap();
        assert!(low.distance(DVec2::new(20.0, 15.0)) < 1e-6 && high.distance(DVec2::new(40.0, 25.0)) < 1e-6);
        assert_eq!(counts(&laid), (1, 1));
    }

    #[test]
    fn holes_of_the_pattern_fall_out_of_the_sign() {
        // A frame with a dot in it, and a bar: the inside of the frame falls out, and has the dot as an opening.
        let pattern = region(&[(0, 0, 20, 20), (5, 5, 10, 10), (8, 8, 2, 2), (25, 0, 5, 20)]);
        assert_eq!(counts(&pattern), (3, 1));
        let carved = carved(&pattern, SHEET, 1.0).unwrap();
        assert_eq!((counts(&carved.plate), counts(&carved.fallen)), ((2, 3), (1, 1)));
        assert_eq!(counts(&carved.sign), (1, 2));
        let [piece] = carved.falls_out[..] else { panic!("{:?}", carved.falls_out) };
        assert!((piece.area_mm2 - 96.0).abs() < 1e-4 && piece.size_mm.distance(DVec2::splat(10.0)) < 1e-6);
        assert!(piece.position_mm.distance(DVec2::new(25.0, 20.0)) < 1e-6, "{}", piece.position_mm);
    }

    #[test]
    fn without_holes_nothing_falls_out() {
        let carved = carved(&region(&[(0, 0, 20, 20), (22, 0, 5, 5)]), SHEET, 1.0).unwrap();
        assert_eq!((counts(&carved.plate), carved.falls_out.len()), ((1, 2), 0));
        assert!((carved.plate.area_mm2() - (2400.0 - 425.0)).abs() < 1e-4);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_size_that_would() {
        let error = on_sheet(&region(&[(0, 0, 59, 10)]), SHEET, 1.0).unwrap_err();
        assert!(error.to_string().contains("take one of at least 61.0 x 12.0 mm"), "{error}");
        assert!(on_sheet(&region(&[(0, 0, 58, 10)]), SHEET, 1.0).is_ok());
        for width_mm in [0.0, -5.0, f64::NAN, 1e6] {
            let sheet = SheetSize { width_mm, height_mm: 10.0 };
            assert!(matches!(on_sheet(&region(&[(0, 0, 1, 1)]), sheet, 0.0), Err(SheetError::Size { .. })));
        }
    }
}
