//! The seams, magnified: as cut, warped, and deformed.

use std::error::Error;

use glam::DVec2;
use openwork::fit::{Bent, Outline, Placed};
use resvg::tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

use super::measure::drawn;
use super::{Case, METHODS};

const CELL: u32 = 230;
const GAP: u32 = 6;
/// Cells beside each other: as cut, warp, lri, and again.
const COLUMNS: u32 = 6;
const INK: [u8; 3] = [0x22, 0x30, 0x4f];
const PAPER: [u8; 3] = [0xf7, 0xf4, 0xee];
const SEAM: [u8; 3] = [0xd0, 0x5a, 0x3c];
/// Half of what a cell shows, in millimetres.
const REACH_MM: f64 = 3.0;

/// A sheet with the jump of each case whose contours meet at the greatest angle as cut. Two cases in a row, each
/// with three cells: pieces as cut and placed, warp, rotation-invariant deformation.
pub fn sheet(cases: &[Case]) -> Result<Vec<u8>, Box<dyn Error>> {
    let rows = (3 * cases.len() as u32).div_ceil(COLUMNS);
    let size = |cells: u32| cells * (CELL + GAP) + GAP;
    let mut sheet = Pixmap::new(size(COLUMNS), size(rows)).ok_or("no room for a picture")?;
    sheet.fill(Color::WHITE);
    for (number, case) in cases.iter().enumerate() {
        for (column, cell) in cells(case)?.into_iter().enumerate() {
            let place = 3 * number as u32 + column as u32;
            let (x, y) = (size(place % COLUMNS) as i32, size(place / COLUMNS) as i32);
            sheet.draw_pixmap(x, y, cell.as_ref(), &Default::default(), Transform::identity(), None);
        }
    }
    Ok(sheet.encode_png()?)
}

fn cells(case: &Case) -> Result<[Pixmap; 3], Box<dyn Error>> {
    let outlines = METHODS.map(|m| Outline::new(&case.catalogue, &case.sequence, &case.options(m)));
    let [warp, lri] = outlines;
    let (warp, lri) = (warp?, lri?);
    let options = case.options(METHODS[0]);
    let placed = Placed::new(&case.catalogue, &case.sequence, &options)?;
    let jumps = warp.seams.iter().enumerate().filter(|(_, seam)| !seam.is_natural);
    let worst = jumps.max_by(|a, b| a.1.before_deg.total_cmp(&b.1.before_deg)).map_or(0, |(i, _)| i);
    let mut cut = View::new(&warp, &placed, worst)?;
    let mut start = warp.seams[worst].u_mm;
    start -= placed.pieces()[worst].width_mm * placed.stretch();
    for i in worst..=(worst + 1).min(placed.pieces().len() - 1) {
        let piece = placed.pieces()[i];
        let Bent { chains, loops } = drawn(piece);
        for points in chains.iter().chain(&loops) {
            let offset = placed.targets(i).offset_mm;
            let place = |p: &DVec2| DVec2::new(start + p.x * placed.stretch(), banded(&warp, p.y + offset));
            cut.line(&points.iter().map(place).collect::<Vec<_>>(), INK, 1.6);
        }
        start += piece.width_mm * placed.stretch();
    }
    let mut filled = [View::new(&warp, &placed, worst)?, View::new(&lri, &placed, worst)?];
    for (view, outline) in filled.iter_mut().zip([&warp, &lri]) {
        view.fill(outline);
    }
    let [warp, lri] = filled;
    Ok([cut.finished(), warp.finished(), lri.finished()])
}

/// A height before the run was fitted to the band, after it.
fn banded(outline: &Outline, y_mm: f64) -> f64 {
    (y_mm + outline.lift_mm) * outline.squash
}

/// A window on a seam.
struct View {
    picture: Pixmap,
    middle: DVec2,
}

impl View {
    fn new(outline: &Outline, placed: &Placed<'_>, seam: usize) -> Result<Self, Box<dyn Error>> {
        let mut picture = Pixmap::new(CELL, CELL).ok_or("no room for a picture")?;
        let [r, g, b] = PAPER;
        picture.fill(Color::from_rgba8(r, g, b, 255));
        // The height is that of the pair of endpoints whose tangents differ most.
        let right = &placed.pieces()[seam].right;
        let left = &placed.pieces()[seam + 1].left;
        let angle = |k: &usize| right[*k].tangent.angle_to(left[*k].tangent).abs();
        let worst = (0..right.len()).max_by(|a, b| angle(a).total_cmp(&angle(b)));
        let height = worst.map_or(0.0, |k| placed.targets(seam).right[k].y_mm);
        Ok(Self { picture, middle: DVec2::new(outline.seams[seam].u_mm, banded(outline, height)) })
    }

    fn pixel(&self, p: DVec2) -> (f32, f32) {
        let p = (p - self.middle) / REACH_MM * f64::from(CELL) / 2.0;
        let half = f64::from(CELL) / 2.0;
        ((half + p.x) as f32, (half - p.y) as f32)
    }

    fn line(&mut self, points: &[DVec2], [r, g, b]: [u8; 3], width: f32) {
        let mut path = PathBuilder::new();
        for (i, &p) in points.iter().enumerate() {
            let (x, y) = self.pixel(p);
            if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(r, g, b, 255);
        let stroke = Stroke { width, ..Stroke::default() };
        if let Some(path) = path.finish() {
            self.picture.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }

    fn fill(&mut self, outline: &Outline) {
        let mut path = PathBuilder::new();
        for contour in &outline.contours {
            for (i, &p) in contour.points.iter().enumerate() {
                let (x, y) = self.pixel(p);
                if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            path.close();
        }
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        let [r, g, b] = INK;
        paint.set_color_rgba8(r, g, b, 255);
        if let Some(path) = path.finish() {
            self.picture.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
        }
    }

    /// The picture with the seam marked at its upper and lower end.
    fn finished(mut self) -> Pixmap {
        let mut paint = Paint::default();
        let [r, g, b] = SEAM;
        paint.set_color_rgba8(r, g, b, 255);
        for y in [0.0, CELL as f32 - 14.0] {
            if let Some(mark) = Rect::from_xywh(CELL as f32 / 2.0 - 1.0, y, 2.0, 14.0) {
                self.picture.fill_rect(mark, &paint, Transform::identity(), None);
            }
        }
        self.picture
    }
}
