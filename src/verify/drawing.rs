//! What both SVG readers hand over: filled paths in millimetres, y up.

use glam::DVec2;
use kurbo::{Affine, BezPath, PathEl};

use super::error::VerifyError;
use crate::planar::{FillRule, Grid, GridPoint};

/// Filled paths on a page; the page's lower left corner is the origin, y points up.
pub(super) struct Drawing {
    /// Width and height of the page.
    pub(super) page_mm: DVec2,
    pub(super) shapes: Vec<Shape>,
}

/// One filled path.
pub(super) struct Shape {
    /// The element it came from, for messages.
    pub(super) element: String,
    /// Its line in the file; 0 when it is not known.
    pub(super) line: u32,
    /// Millimetres, y up.
    pub(super) path: BezPath,
    pub(super) rule: FillRule,
    /// The id of the group that it is in, or nothing.
    pub(super) layer: String,
    /// Whether the path is the outline of a stroke, which crosses itself as a matter of course.
    pub(super) is_stroke: bool,
}

/// One closed polygon of a shape.
pub(super) struct Loop {
    pub(super) points: Vec<DVec2>,
    /// Whether the path said so: by Z, or by coming back to its first point.
    pub(super) closed: bool,
}

/// The map from a page `height_mm` high, y down, to y up.
pub(super) fn upright(height_mm: f64) -> Affine {
    Affine::new([1.0, 0.0, 0.0, -1.0, 0.0, height_mm])
}

/// How an element is called in messages: its name, and its id if it has one.
pub(super) fn element_name(name: &str, id: Option<&str>) -> String {
    match id.filter(|id| !id.is_empty()) {
        Some(id) => format!("<{name} id=\"{id}\">"),
        None => format!("<{name}>"),
    }
}

impl Shape {
    /// The polygons of the path, within `chord_mm` of its curves.
    pub(super) fn loops(&self, chord_mm: f64) -> Vec<Loop> {
        let mut loops: Vec<Loop> = Vec::new();
        let vector = |p: kurbo::Point| DVec2::new(p.x, p.y);
        kurbo::flatten(&self.path, chord_mm, |element| match element {
            PathEl::MoveTo(p) => loops.push(Loop { points: vec![vector(p)], closed: false }),
            PathEl::LineTo(p) => {
                let p = vector(p);
                match loops.last_mut() {
                    Some(current) if !current.closed => current.points.push(p),
                    // After Z a path goes on from the first point.
                    Some(Loop { points, .. }) => {
                        let first = points[0];
                        loops.push(Loop { points: vec![first, p], closed: false });
                    }
                    None => {}
                }
            }
            PathEl::ClosePath => {
                if let Some(current) = loops.last_mut() {
                    current.closed = true;
                }
            }
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => unreachable!("flattening leaves lines only"),
        });
        for current in &mut loops {
            current.closed |= current.points.len() > 2 && current.points.first() == current.points.last();
        }
        loops.retain(|l| l.points.len() > 1);
        loops
    }

    /// A polygon on `grid`.
    pub(super) fn snap(&self, grid: Grid, points: &[DVec2]) -> Result<Vec<GridPoint>, VerifyError> {
        points
            .iter()
            .map(|&p| grid.snap(p))
            .collect::<Result<_, _>>()
            .map_err(|source| self.misplaced(source))
    }

    /// The error for a coordinate of this shape.
    pub(super) fn misplaced(&self, source: crate::planar::GridError) -> VerifyError {
        VerifyError::Coordinate { element: self.element.clone(), line: self.line, source }
    }
}
