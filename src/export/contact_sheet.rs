//! A contact sheet: many bands on one picture, at one scale, with their numbers, to choose from.
//!
//! Bands stand in a grid, row by row, each in a cell as large as the largest band, its number over its upper left corner.
//! There are as many columns as make the sheet most like a page on its side. The digits are strokes of our own, so that
//! the picture needs no font and is the same everywhere.

use glam::DVec2;

use super::ExportError;
use super::canvas::{Canvas, INK};
use crate::fabricate::Bridge;
use crate::planar::Region;

/// Width over height of the sheet that columns are chosen for.
const ASPECT: f64 = 1.4;
/// The height of digits, as a part of the square root of the area of all cells.
const DIGIT: f64 = 0.024;
/// Blank paper around and between cells, and between a number and its band, in heights of digits.
const GAP: f64 = 1.2;
const UNDER: f64 = 0.5;
/// From one digit to the next, and the width of their strokes, in heights of digits.
const ADVANCE: f64 = 0.85;
const STROKE: f64 = 0.13;

/// A band on a contact sheet.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'s> {
    /// The number that it is known by, with its leading zeros.
    pub number: &'s str,
    /// The band.
    pub region: &'s Region,
    /// Its bridges: struts are orange, slits are green.
    pub bridges: &'s [Bridge],
}

/// All `bands` as one PNG of `longer_side` pixels, in their order, at one scale.
///
/// # Errors
/// [`ExportError::Option`] for a size that no picture can have, [`ExportError::Empty`] without bands or ink.
pub fn contact_sheet(bands: &[Shown<'_>], longer_side: u32) -> Result<Vec<u8>, ExportError> {
    let corners: Option<Vec<_>> = bands.iter().map(|band| band.region.bounds_mm()).collect();
    let corners = corners.ok_or(ExportError::Empty)?;
    let largest =
        corners.iter().map(|(low, high)| high - low).reduce(DVec2::max).ok_or(ExportError::Empty)?;
    let grid = Grid::new(largest, bands.len());
    let mut canvas =
        Canvas::new(DVec2::new(0.0, -grid.size().y), DVec2::new(grid.size().x, 0.0), longer_side)?;
    for (place, (band, (low, high))) in bands.iter().zip(corners).enumerate() {
        let corner = grid.corner(place);
        // In the middle of its cell.
        let shift = corner + DVec2::new(largest.x, -largest.y) / 2.0 - (low + high) / 2.0;
        canvas.region(band.region, shift, INK)?;
        canvas.bridges(band.bridges, shift)?;
        let base = corner + DVec2::new(0.0, UNDER * grid.digit_mm);
        let strokes = band.number.chars().enumerate().map(|(i, digit)| {
            let left = DVec2::new(ADVANCE * i as f64, 0.0);
            stroke(digit).map(move |p| base + grid.digit_mm * (left + p / 6.0))
        });
        canvas.lines(strokes, STROKE * grid.digit_mm * canvas.scale, INK)?;
    }
    canvas.encode()
}

/// Where cells lie: the sheet's upper left corner is the origin, y up. Lengths are millimetres.
#[derive(Debug, Clone, Copy)]
struct Grid {
    columns: usize,
    rows: usize,
    /// What a band takes at most.
    cell: DVec2,
    digit_mm: f64,
}

impl Grid {
    /// For `count` bands of at most this size.
    fn new(cell: DVec2, count: usize) -> Self {
        let digit_mm = DIGIT * (cell.x * cell.y * count as f64).sqrt();
        let with = |columns: usize| Self { columns, rows: count.div_ceil(columns), cell, digit_mm };
        let strangeness = |grid: &Self| (grid.size().x / grid.size().y / ASPECT).ln().abs();
        // Of columns that make as many rows the fewest leave the fewest cells empty.
        let grids = (1..=count).map(with).filter(|grid| (grid.columns - 1) * grid.rows < count);
        grids.min_by(|a, b| strangeness(a).total_cmp(&strangeness(b))).unwrap_or_else(|| with(1))
    }

    /// From a cell's upper left corner to the next one's.
    fn pitch(&self) -> DVec2 {
        self.cell + self.digit_mm * DVec2::new(GAP, 1.0 + UNDER + GAP)
    }

    fn size(&self) -> DVec2 {
        DVec2::new(self.columns as f64, self.rows as f64) * self.pitch() + GAP * self.digit_mm
    }

    /// The upper left corner of the place of a band.
    fn corner(&self, place: usize) -> DVec2 {
        let cell = DVec2::new((place % self.columns) as f64, (place / self.columns) as f64);
        let first = self.digit_mm * DVec2::new(GAP, GAP + 1.0 + UNDER);
        (first + cell * self.pitch()) * DVec2::new(1.0, -1.0)
    }
}

/// The corners of each digit, which is one stroke 4 wide and 6 high: x and y of each.
const DIGITS: [&str; 10] = [
    "10 30 41 45 36 16 05 01 10",
    "15 26 20",
    "05 16 36 45 44 00 40",
    "06 46 24 34 43 41 30 10 01",
    "30 36 02 42",
    "46 06 04 34 43 41 30 10 01",
    "36 26 04 01 10 30 41 42 33 03",
    "06 46 10",
    "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
    "10 20 42 45 36 16 05 04 13 43",
];

/// The stroke of a digit, 4 wide and 6 high; nothing for other characters.
fn stroke(digit: char) -> impl Iterator<Item = DVec2> {
    let corners = digit.to_digit(10).map_or("", |digit| DIGITS[digit as usize]);
    corners.split_whitespace().map(|corner| {
        let [x, y] = [0, 1].map(|i| f64::from(corner.as_bytes()[i] - b'0'));
        DVec2::new(x, y)
    })
}

#[cfg(test)]
mod tests {
    use super::super::canvas::{PAPER, Seen};
    use super::*;
    use crate::planar::{self, FillRule, boxes};

    fn bar(width: i64, height: i64) -> Region {
        let step = planar::Grid::for_extent(100.0).unwrap().steps(1.0);
        boxes(step, FillRule::NonZero, &[(3, 7, width, height)])
    }

    #[test]
    fn columns_make_a_page() {
        let columns = |x: f64, y: f64, count: usize| Grid::new(DVec2::new(x, y), count).columns;
        assert_eq!(columns(80.0, 80.0, 12), 4);
        assert_eq!(columns(240.0, 16.0, 12), 2);
        assert_eq!(columns(480.0, 16.0, 12), 1);
        assert_eq!(columns(120.0, 16.0, 12), 2);
        assert_eq!(columns(10.0, 200.0, 12), 12);
        assert_eq!(columns(50.0, 50.0, 1), 1);
        // No column is empty: five bands in two rows of three, never in two of four.
        for count in 1..40 {
            let grid = Grid::new(DVec2::new(30.0, 20.0), count);
            assert!(grid.columns * grid.rows >= count && (grid.columns - 1) * grid.rows < count);
        }
    }

    #[test]
    fn bands_are_in_their_cells_at_one_scale() {
        let (long, short) = (bar(60, 40), bar(30, 20));
        let names = ["01", "02", "03"];
        let bands: Vec<Shown> = [&long, &short, &long]
            .into_iter()
            .zip(names)
            .map(|(region, number)| Shown { number, region, bridges: &[] })
            .collect();
        let seen = Seen::new(&contact_sheet(&bands, 1000).unwrap());
        let grid = Grid::new(DVec2::new(60.0, 40.0), 3);
        let scale = 1000.0 / grid.size().max_element();
        let at = |place: usize, x: f64, y: f64| {
            let p = (grid.corner(place) + DVec2::new(x, -y)) * scale;
            seen.colour(p.x as u32, -p.y as u32)
        };
        for place in [0, 2] {
            assert_eq!([at(place, 1.0, 1.0), at(place, 59.0, 39.0)], [INK; 2]);
        }
        // Half as wide and half as high, in the middle of its cell.
        assert_eq!([at(1, 16.0, 11.0), at(1, 44.0, 29.0)], [INK; 2]);
        assert_eq!([at(1, 14.0, 20.0), at(1, 30.0, 9.0), at(1, 46.0, 20.0)], [PAPER; 3]);
        for place in 0..3 {
            // The box of two digits, above the upper left corner of the cell.
            let part = |i: u32| f64::from(i) / 40.0 * grid.digit_mm;
            let mut spots = (0..64).flat_map(|i| (0..40).map(move |j| (part(i), part(j))));
            let is_drawn = spots.any(|(x, y)| at(place, x, -UNDER * grid.digit_mm - y) != PAPER);
            assert!(is_drawn, "the number of band {place} is missing");
        }
    }

    #[test]
    fn digits_stay_in_their_boxes_and_differ() {
        let all: Vec<Vec<DVec2>> = ('0'..='9').map(|digit| stroke(digit).collect()).collect();
        for (i, corners) in all.iter().enumerate() {
            let high = DVec2::new(4.0, 6.0);
            let is_inside = |p: &DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(high).all();
            assert!(corners.iter().all(is_inside), "{i}");
            let reaches = |y: f64| corners.iter().any(|p| p.y == y);
            assert!(reaches(0.0) && reaches(6.0), "{i} is not as high as the others");
            assert!(!all[..i].contains(corners), "{i}");
        }
        assert_eq!(stroke('x').count(), 0);
    }

    #[test]
    fn without_bands_there_is_no_sheet() {
        assert!(matches!(contact_sheet(&[], 1000), Err(ExportError::Empty)));
        let region = bar(10, 10);
        let band = Shown { number: "01", region: &region, bridges: &[] };
        assert!(matches!(contact_sheet(&[band], 3), Err(ExportError::Option { .. })));
        assert_eq!(contact_sheet(&[band], 64).unwrap(), contact_sheet(&[band], 64).unwrap());
    }
}
