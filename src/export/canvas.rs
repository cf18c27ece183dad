//! Paper to draw on: areas, lines and rings in millimetres, y up, as the pixels of a PNG.

use std::ops::RangeInclusive;

use glam::DVec2;
use resvg::tiny_skia::{
    Color, FillRule as Rule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform,
};

use super::ExportError;
use crate::fabricate::Bridge;
use crate::planar::{FillRule, Region};

/// Beyond this a picture takes gigabytes; below, nothing can be seen.
const PIXELS: RangeInclusive<u32> = 16..=16_384;
pub(super) const PAPER: [u8; 3] = [0xf7, 0xf4, 0xee];
pub(super) const INK: [u8; 3] = [0x22, 0x30, 0x4f];
/// Ink that a strut adds, and where a slit took ink away.
pub(super) const STRUT: [u8; 3] = [0xe4, 0x6a, 0x24];
const SLIT: [u8; 3] = [0x2c, 0xa8, 0x8d];

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

/// A sheet of paper with its scale.
pub(super) struct Canvas {
    picture: Pixmap,
    /// The upper left corner, in millimetres.
    corner: DVec2,
    /// Pixels for each millimetre.
    pub(super) scale: f64,
}

impl Canvas {
    /// Paper of which the longer side has so many pixels, from the lower left corner `low` to the upper right `high`.
    ///
    /// # Errors
    /// [`ExportError::Option`] for a size that no picture can have, [`ExportError::Picture`] without memory for it.
    pub(super) fn new(low: DVec2, high: DVec2, longer_side: u32) -> Result<Self, ExportError> {
        check_pixels(longer_side)?;
        let size = high - low;
        let scale = f64::from(longer_side) / size.max_element();
        let [width, height] = size.to_array().map(|mm| (mm * scale).round() as u32);
        let mut picture = Pixmap::new(width, height).ok_or(ExportError::Picture)?;
        picture.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));
        Ok(Self { picture, corner: DVec2::new(low.x, high.y), scale })
    }

    /// Where a point lies, in pixels from the upper left corner.
    fn at(&self, p: DVec2) -> DVec2 {
        DVec2::new(p.x - self.corner.x, self.corner.y - p.y) * self.scale
    }

    fn trace(&self, path: &mut PathBuilder, points: impl Iterator<Item = DVec2>) {
        for (i, p) in points.map(|p| self.at(p)).enumerate() {
            let (x, y) = (p.x as f32, p.y as f32);
            if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
    }

    /// A region, moved by `shift`.
    pub(super) fn region(
        &mut self,
        region: &Region,
        shift: DVec2,
        colour: [u8; 3],
    ) -> Result<(), ExportError> {
        let grid = region.grid();
        let outlines = region.contours().map(|c| c.points().iter().map(move |&p| grid.to_mm(p) + shift));
        self.areas(outlines, FillRule::EvenOdd, colour)
    }

    /// Bridges, moved by `shift`: struts are orange, slits are green.
    pub(super) fn bridges(&mut self, bridges: &[Bridge], shift: DVec2) -> Result<(), ExportError> {
        for (are_struts, colour) in [(true, STRUT), (false, SLIT)] {
            let of_kind = bridges.iter().filter(|bridge| bridge.kind.is_strut() == are_struts);
            let outlines = of_kind.flat_map(|bridge| {
                std::iter::once(&bridge.corners_mm[..]).chain(bridge.pockets_mm.iter().map(Vec::as_slice))
            });
            let outlines = outlines.map(|outline| outline.iter().map(|&p| DVec2::from(p) + shift));
            self.areas(outlines, FillRule::NonZero, colour)?;
        }
        Ok(())
    }

    /// What closed outlines are around.
    fn areas<O: Iterator<Item = DVec2>>(
        &mut self,
        outlines: impl Iterator<Item = O>,
        rule: FillRule,
        colour: [u8; 3],
    ) -> Result<(), ExportError> {
        let mut path = PathBuilder::new();
        for outline in outlines {
            self.trace(&mut path, outline);
            path.close();
        }
        if path.is_empty() {
            return Ok(());
        }
        let path = path.finish().ok_or(ExportError::Picture)?;
        let rule = if rule == FillRule::EvenOdd { Rule::EvenOdd } else { Rule::Winding };
        self.picture.fill_path(&path, &paint(colour), rule, Transform::identity(), None);
        Ok(())
    }

    /// Open lines with round ends, `width` pixels wide.
    pub(super) fn lines<L: Iterator<Item = DVec2>>(
        &mut self,
        lines: impl Iterator<Item = L>,
        width: f64,
        colour: [u8; 3],
    ) -> Result<(), ExportError> {
        let mut path = PathBuilder::new();
        lines.for_each(|line| self.trace(&mut path, line));
        self.draw(path, width, colour)
    }

    /// Circles about points, with radii in pixels, drawn `width` pixels wide.
    pub(super) fn rings(
        &mut self,
        rings: impl Iterator<Item = (DVec2, f64)>,
        width: f64,
        colour: [u8; 3],
    ) -> Result<(), ExportError> {
        let mut path = PathBuilder::new();
        for (middle, radius) in rings {
            let at = self.at(middle);
            path.push_circle(at.x as f32, at.y as f32, radius as f32);
        }
        self.draw(path, width, colour)
    }

    fn draw(&mut self, path: PathBuilder, width: f64, colour: [u8; 3]) -> Result<(), ExportError> {
        if path.is_empty() {
            return Ok(());
        }
        let path = path.finish().ok_or(ExportError::Picture)?;
        let (line_cap, line_join) = (LineCap::Round, LineJoin::Round);
        let stroke = Stroke { width: width as f32, line_cap, line_join, ..Stroke::default() };
        self.picture.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
        Ok(())
    }

    /// The picture as a PNG.
    ///
    /// # Errors
    /// [`ExportError::Picture`] when it cannot be encoded.
    pub(super) fn encode(&self) -> Result<Vec<u8>, ExportError> {
        self.picture.encode_png().map_err(|_| ExportError::Picture)
    }
}

fn paint([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

/// A frame of 80 by 40 mm around a hole of 60 by 20 mm, 10 mm from both axes.
#[cfg(test)]
pub(super) fn frame() -> Region {
    use crate::planar::{Grid, boxes};

    let step = Grid::for_extent(100.0).unwrap().steps(1.0);
    boxes(step, FillRule::EvenOdd, &[(10, 10, 80, 40), (20, 20, 60, 20)])
}

/// A PNG read again, for tests.
#[cfg(test)]
pub(super) struct Seen(Pixmap);

#[cfg(test)]
impl Seen {
    pub(super) fn new(png: &[u8]) -> Self {
        Self(Pixmap::decode_png(png).unwrap())
    }

    pub(super) fn size(&self) -> [u32; 2] {
        [self.0.width(), self.0.height()]
    }

    pub(super) fn colour(&self, x: u32, y: u32) -> [u8; 3] {
        let c = self.0.pixel(x, y).unwrap();
        [c.red(), c.green(), c.blue()]
    }

    /// How many pixels have exactly this colour.
    pub(super) fn count(&self, colour: [u8; 3]) -> usize {
        let [width, height] = self.size();
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .filter(|&(x, y)| self.colour(x, y) == colour)
            .count()
    }
}
