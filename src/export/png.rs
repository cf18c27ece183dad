//! A picture of a region for a person to look at.

use glam::DVec2;
use resvg::tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Transform};

use super::ExportError;
use crate::fabricate::Bridge;
use crate::planar::{Contour, Region};

/// The longer side in pixels when nothing else is asked for.
pub const DEFAULT_PIXELS: u32 = 1600;
/// Beyond this a picture takes gigabytes; below, nothing can be seen.
const PIXELS: std::ops::RangeInclusive<u32> = 16..=16_384;
/// The margin on each side, as a part of the longer side of the ink.
const MARGIN: f64 = 0.04;
const PAPER: [u8; 3] = [0xf7, 0xf4, 0xee];
const INK: [u8; 3] = [0x22, 0x30, 0x4f];
/// Ink that a strut adds, and where a slit took ink away.
const STRUT: [u8; 3] = [0xe4, 0x6a, 0x24];
const SLIT: [u8; 3] = [0x2c, 0xa8, 0x8d];

/// `region` as a PNG of `longer_side` pixels (with margins), dark ink on light paper.
///
/// # Errors
/// [`ExportError::Option`] for a size that no picture can have, [`ExportError::Empty`] without ink.
pub fn png(region: &Region, longer_side: u32) -> Result<Vec<u8>, ExportError> {
    png_with_bridges(region, &[], longer_side)
}

/// The same with the region's bridges: struts are orange, slits are green.
///
/// # Errors
/// As [`png`].
pub fn png_with_bridges(
    region: &Region,
    bridges: &[Bridge],
    longer_side: u32,
) -> Result<Vec<u8>, ExportError> {
    let of_kind = |are_struts: bool| {
        let outlines = bridges
            .iter()
            .filter(move |b| b.kind.is_strut() == are_struts)
            .flat_map(|b| std::iter::once(&b.corners_mm[..]).chain(b.pockets_mm.iter().map(Vec::as_slice)));
        outlines.map(|outline| outline.iter().map(|&p| DVec2::from(p)).collect()).collect()
    };
    picture(region, [(of_kind(true), STRUT), (of_kind(false), SLIT)], longer_side)
}

/// `plate` with the pieces that fall out of it in orange.
///
/// # Errors
/// As [`png`].
pub fn png_of_plate(plate: &Region, fallen: &Region, longer_side: u32) -> Result<Vec<u8>, ExportError> {
    let exteriors = fallen.parts().iter().flat_map(|part| part.contours());
    let millimetres = |c: &Contour| c.points().iter().map(|&p| fallen.grid().to_mm(p)).collect();
    picture(plate, [(exteriors.map(millimetres).collect(), STRUT), (Vec::new(), SLIT)], longer_side)
}

/// The region with areas in other colours on it, each given by its outlines.
fn picture(
    region: &Region,
    areas: [(Vec<Vec<DVec2>>, [u8; 3]); 2],
    longer_side: u32,
) -> Result<Vec<u8>, ExportError> {
    if !PIXELS.contains(&longer_side) {
        return Err(ExportError::Option {
            name: "picture size",
            found: longer_side.into(),
            wanted: "from 16 to 16384 pixels",
        });
    }
    let (low, high) = region.bounds_mm().ok_or(ExportError::Empty)?;
    let size = high - low;
    let margin = MARGIN * size.max_element();
    let scale = f64::from(longer_side) / (size.max_element() + 2.0 * margin);
    let [width, height] = (size + 2.0 * margin).to_array().map(|mm| (mm * scale).round() as u32);
    let mut picture = Pixmap::new(width, height).ok_or(ExportError::Picture)?;
    picture.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));

    let add = |path: &mut PathBuilder, points: &mut dyn Iterator<Item = DVec2>| {
        for (i, p) in points.enumerate() {
            let x = ((p.x - low.x + margin) * scale) as f32;
            let y = ((high.y - p.y + margin) * scale) as f32;
            if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        path.close();
    };
    let mut fill = |path: PathBuilder, rule: FillRule, [r, g, b]: [u8; 3]| {
        let path = path.finish().ok_or(ExportError::Picture)?;
        let mut paint = Paint::default();
        paint.set_color_rgba8(r, g, b, 255);
        picture.fill_path(&path, &paint, rule, Transform::identity(), None);
        Ok::<_, ExportError>(())
    };
    let mut ink = PathBuilder::new();
    for contour in region.contours() {
        add(&mut ink, &mut contour.points().iter().map(|&p| region.grid().to_mm(p)));
    }
    fill(ink, FillRule::EvenOdd, INK)?;
    for (outlines, colour) in areas {
        let mut path = PathBuilder::new();
        for outline in outlines {
            add(&mut path, &mut outline.into_iter());
        }
        if !path.is_empty() {
            fill(path, FillRule::Winding, colour)?;
        }
    }
    picture.encode_png().map_err(|_| ExportError::Picture)
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
        let picture = Pixmap::decode_png(&png(&frame(), 864).unwrap()).unwrap();
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
    fn what_cannot_be_drawn_is_an_error() {
        assert!(matches!(png(&frame(), 3), Err(ExportError::Option { .. })));
        assert!(matches!(png(&frame(), 1 << 20), Err(ExportError::Option { .. })));
        let empty = Region::empty(Grid::for_extent(1.0).unwrap());
        assert!(matches!(png(&empty, 100), Err(ExportError::Empty)));
    }
}
