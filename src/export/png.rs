//! A picture of a region for a person to look at.

use glam::DVec2;

use super::ExportError;
use super::canvas::{Canvas, INK, STRUT, check_pixels};
use crate::fabricate::Bridge;
use crate::planar::{Contour, Region};

/// The longer side in pixels when nothing else is asked for.
pub const DEFAULT_PIXELS: u32 = 1600;
/// The margin on each side, as a part of the longer side of the ink.
const MARGIN: f64 = 0.04;
/// Where pieces meet, and around what is narrow.
const SEAM: [u8; 3] = [0x5b, 0xa7, 0xe0];
const NARROW: [u8; 3] = [0xd6, 0x28, 0x39];
/// What is engraved: light on the ink, as if burnt into it.
const ENGRAVED: [u8; 3] = [0xf2, 0xc1, 0x4e];
/// Widths of lines, as parts of the longer side of the picture.
const SEAM_WIDTH: f64 = 0.0015;
const NARROW_WIDTH: f64 = 0.0022;
const ENGRAVED_WIDTH: f64 = 0.002;
/// A ring around a narrow place has this many times its width, and at least this part of the longer side, as radius.
const RING: f64 = 1.5;
const LEAST_RING: f64 = 0.01;

/// What is drawn over the ink so that a person finds it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Marks<'m> {
    /// Struts are orange, slits are green.
    pub bridges: &'m [Bridge],
    /// What falls out of the region when it is cut; orange.
    pub fallen: Option<&'m Region>,
    /// What is engraved: its outlines, yellow.
    pub engraved: Option<&'m Region>,
    /// Lines across the band where two pieces meet, in millimetres; light blue.
    pub seams_mm: &'m [Vec<DVec2>],
    /// Places that are narrow: the middle and the width, in millimetres; a red ring around each.
    pub narrow_mm: &'m [(DVec2, f64)],
}

/// `region` as a PNG of `longer_side` pixels (with margins), dark ink on light paper, with `marks` over it.
///
/// # Errors
/// [`ExportError::Option`] for a size that no picture can have, [`ExportError::Empty`] without ink.
pub fn png(region: &Region, marks: &Marks<'_>, longer_side: u32) -> Result<Vec<u8>, ExportError> {
    check_pixels(longer_side)?;
    let (low, high) = region.bounds_mm().ok_or(ExportError::Empty)?;
    let margin = MARGIN * (high - low).max_element();
    let mut canvas = Canvas::new(low - margin, high + margin, longer_side)?;
    canvas.region(region, DVec2::ZERO, INK)?;
    canvas.bridges(marks.bridges, DVec2::ZERO)?;
    if let Some(fallen) = marks.fallen {
        canvas.region(fallen, DVec2::ZERO, STRUT)?;
    }
    let pixels = f64::from(longer_side);
    if let Some(engraved) = marks.engraved {
        let grid = engraved.grid();
        let around = |contour: &'_ Contour| {
            let points = contour.points().iter().map(|&p| grid.to_mm(p)).collect::<Vec<_>>();
            let first = points[0];
            points.into_iter().chain([first])
        };
        canvas.lines(engraved.contours().map(around), ENGRAVED_WIDTH * pixels, ENGRAVED)?;
    }
    let seams = marks.seams_mm.iter().map(|seam| seam.iter().copied());
    canvas.lines(seams, SEAM_WIDTH * pixels, SEAM)?;
    let scale = canvas.scale;
    let radius = |width_mm: f64| (RING * width_mm * scale).max(LEAST_RING * pixels);
    let rings = marks.narrow_mm.iter().map(|&(middle, width_mm)| (middle, radius(width_mm)));
    canvas.rings(rings, NARROW_WIDTH * pixels, NARROW)?;
    canvas.encode()
}

#[cfg(test)]
mod tests {
    use super::super::canvas::{PAPER, Seen, frame};
    use super::*;
    use crate::planar::{FillRule, Grid, boxes};

    #[test]
    fn ink_is_dark_and_holes_are_paper() {
        let picture = Seen::new(&png(&frame(), &Marks::default(), 864).unwrap());
        assert_eq!(picture.size(), [864, 464]);
        let rgb = |x, y| picture.colour(x, y);
        assert_eq!(rgb(5, 5), PAPER);
        assert_eq!(rgb(432, 232), PAPER);
        assert_eq!(rgb(60, 232), INK);
        assert_eq!(rgb(432, 60), INK);
    }

    #[test]
    fn seams_and_narrow_places_are_marked() {
        let seams = [vec![DVec2::new(50.0, 5.0), DVec2::new(50.0, 55.0)]];
        let marks =
            Marks { seams_mm: &seams, narrow_mm: &[(DVec2::new(15.0, 30.0), 2.0)], ..Marks::default() };
        let picture = Seen::new(&png(&frame(), &marks, 4000).unwrap());
        let has = |colour| picture.count(colour);
        assert!(has(SEAM) > 3000 && has(NARROW) > 400, "{} {}", has(SEAM), has(NARROW));
    }

    #[test]
    fn what_is_engraved_is_outlined() {
        let engraved = boxes(frame().grid().steps(1.0), FillRule::NonZero, &[(12, 15, 4, 30)]);
        let marks = Marks { engraved: Some(&engraved), ..Marks::default() };
        let picture = Seen::new(&png(&frame(), &marks, 2000).unwrap());
        // 68 mm at 23 pixels to the millimetre, four pixels wide less their soft edges; filled it would be ten times as much.
        assert!((3000..9000).contains(&picture.count(ENGRAVED)), "{}", picture.count(ENGRAVED));
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(matches!(png(&frame(), &Marks::default(), 3), Err(ExportError::Option { .. })));
        assert!(matches!(png(&frame(), &Marks::default(), 1 << 20), Err(ExportError::Option { .. })));
        let empty = Region::empty(Grid::for_extent(1.0).unwrap());
        assert!(matches!(png(&empty, &Marks::default(), 100), Err(ExportError::Empty)));
    }
}
