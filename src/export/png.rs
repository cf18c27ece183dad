//! A picture of a region for a person to look at.

use glam::DVec2;
use resvg::tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Stroke, Transform};

use super::ExportError;
use crate::fabricate::Bridge;
use crate::planar::Region;

/// The longer side in pixels when nothing else is asked for.
pub const DEFAULT_PIXELS: u32 = 1600;
/// Beyond this a picture takes gigabytes; below, nothing can be seen.
const PIXELS: std::ops::RangeInclusive<u32> = 16..=16_384;
/// The margin on each side, as a part of the longer side of the ink.
const MARGIN: f64 = 0.04;
pub(super) const PAPER: [u8; 3] = [0xf7, 0xf4, 0xee];
const INK: [u8; 3] = [0x22, 0x30, 0x4f];
/// Ink that a strut adds, and where a slit took ink away.
const STRUT: [u8; 3] = [0xe4, 0x6a, 0x24];
const SLIT: [u8; 3] = [0x2c, 0xa8, 0x8d];
/// Where pieces meet, and around what is narrow.
const SEAM: [u8; 3] = [0x5b, 0xa7, 0xe0];
const NARROW: [u8; 3] = [0xd6, 0x28, 0x39];
/// Widths of lines, as parts of the longer side of the picture.
const SEAM_WIDTH: f64 = 0.0015;
const NARROW_WIDTH: f64 = 0.0022;
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
    let size = high - low;
    let margin = MARGIN * size.max_element();
    let scale = f64::from(longer_side) / (size.max_element() + 2.0 * margin);
    let [width, height] = (size + 2.0 * margin).to_array().map(|mm| (mm * scale).round() as u32);
    let picture = Pixmap::new(width, height).ok_or(ExportError::Picture)?;
    let mut sheet = Sheet { picture, corner: DVec2::new(low.x - margin, high.y + margin), scale };
    sheet.picture.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));

    let mut ink = PathBuilder::new();
    for contour in region.contours() {
        sheet.trace(&mut ink, contour.points().iter().map(|&p| region.grid().to_mm(p)), true);
    }
    sheet.fill(ink, FillRule::EvenOdd, INK)?;
    for (are_struts, colour) in [(true, STRUT), (false, SLIT)] {
        let mut path = PathBuilder::new();
        for bridge in marks.bridges.iter().filter(|b| b.kind.is_strut() == are_struts) {
            for outline in
                std::iter::once(&bridge.corners_mm[..]).chain(bridge.pockets_mm.iter().map(Vec::as_slice))
            {
                sheet.trace(&mut path, outline.iter().map(|&p| DVec2::from(p)), true);
            }
        }
        sheet.fill(path, FillRule::Winding, colour)?;
    }
    let mut fallen = PathBuilder::new();
    for (region, contour) in
        marks.fallen.iter().flat_map(|region| region.contours().map(move |c| (region, c)))
    {
        sheet.trace(&mut fallen, contour.points().iter().map(|&p| region.grid().to_mm(p)), true);
    }
    sheet.fill(fallen, FillRule::EvenOdd, STRUT)?;
    let mut seams = PathBuilder::new();
    for seam in marks.seams_mm {
        sheet.trace(&mut seams, seam.iter().copied(), false);
    }
    sheet.draw(seams, SEAM_WIDTH * f64::from(longer_side), SEAM)?;
    let mut rings = PathBuilder::new();
    for &(middle, width_mm) in marks.narrow_mm {
        let radius = (RING * width_mm * scale).max(LEAST_RING * f64::from(longer_side));
        let at = sheet.at(middle);
        rings.push_circle(at.x as f32, at.y as f32, radius as f32);
    }
    sheet.draw(rings, NARROW_WIDTH * f64::from(longer_side), NARROW)?;
    sheet.picture.encode_png().map_err(|_| ExportError::Picture)
}

/// A picture with its scale.
struct Sheet {
    picture: Pixmap,
    /// The upper left corner, in millimetres.
    corner: DVec2,
    /// Pixels for each millimetre.
    scale: f64,
}

impl Sheet {
    /// Where a point lies, in pixels from the upper left corner.
    fn at(&self, p: DVec2) -> DVec2 {
        DVec2::new(p.x - self.corner.x, self.corner.y - p.y) * self.scale
    }

    fn trace(&self, path: &mut PathBuilder, points: impl Iterator<Item = DVec2>, is_closed: bool) {
        for (i, p) in points.map(|p| self.at(p)).enumerate() {
            let (x, y) = (p.x as f32, p.y as f32);
            if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if is_closed {
            path.close();
        }
    }

    fn fill(&mut self, path: PathBuilder, rule: FillRule, colour: [u8; 3]) -> Result<(), ExportError> {
        if path.is_empty() {
            return Ok(());
        }
        let path = path.finish().ok_or(ExportError::Picture)?;
        self.picture.fill_path(&path, &paint(colour), rule, Transform::identity(), None);
        Ok(())
    }

    fn draw(&mut self, path: PathBuilder, width: f64, colour: [u8; 3]) -> Result<(), ExportError> {
        if path.is_empty() {
            return Ok(());
        }
        let path = path.finish().ok_or(ExportError::Picture)?;
        let stroke = Stroke { width: width as f32, ..Stroke::default() };
        self.picture.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
        Ok(())
    }
}

fn paint([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

/// Refuses sizes that no picture can have.
pub(super) fn check_pixels(longer_side: u32) -> Result<(), ExportError> {
    match PIXELS.contains(&longer_side) {
        true => Ok(()),
        false => Err(ExportError::Option {
            name: "picture size",
            found: longer_side.into(),
            wanted: "from 16 to 16384 pixels",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{Grid, GridPoint};

    fn frame() -> Region {
        let grid = Grid::for_extent(100.0).unwrap();
        let one = grid.steps(1.0);
        let rectangle = |x: i64, y: i64, w: i64, h: i64| {
            [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
                .map(|(x, y)| GridPoint::new(x * one, y * one))
                .to_vec()
        };
        let paths = [rectangle(10, 10, 80, 40), rectangle(20, 20, 60, 20)];
        Region::fill(grid, &paths, crate::planar::FillRule::EvenOdd)
    }

    #[test]
    fn ink_is_dark_and_holes_are_paper() {
        let picture = Pixmap::decode_png(&png(&frame(), &Marks::default(), 864).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (864, 464));
        let rgb = |x, y| {
            let c = picture.pixel(x, y).unwrap();
            [c.red(), c.green(), c.blue()]
        };
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
        let picture = Pixmap::decode_png(&png(&frame(), &marks, 4000).unwrap()).unwrap();
        let has = |[r, g, b]: [u8; 3]| {
            picture.pixels().iter().filter(|p| [p.red(), p.green(), p.blue()] == [r, g, b]).count()
        };
        assert!(has(SEAM) > 3000 && has(NARROW) > 400, "{} {}", has(SEAM), has(NARROW));
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(matches!(png(&frame(), &Marks::default(), 3), Err(ExportError::Option { .. })));
        assert!(matches!(png(&frame(), &Marks::default(), 1 << 20), Err(ExportError::Option { .. })));
        let empty = Region::empty(Grid::for_extent(1.0).unwrap());
        assert!(matches!(png(&empty, &Marks::default(), 100), Err(ExportError::Empty)));
    }
}
