//! A pattern as it is drawn: curves with a pen, and filled elements.

use glam::DVec2;
use kurbo::BezPath;

/// One stroke: a path of a single subpath in millimetres, y up, closed if it ends with a closing element.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The line that the middle of the pen follows.
    pub path: BezPath,
    /// The width of the pen in millimetres.
    pub width_mm: f64,
}

/// A filled shape that is copied, moved and turned as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Closed polygons in millimetres with the ink on their left: exteriors counter-clockwise, holes clockwise. The first one is an
    /// exterior.
    pub contours: Vec<Vec<DVec2>>,
}

/// Curves and elements of a pattern, in millimetres, y up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// The strokes.
    pub curves: Vec<Curve>,
    /// The filled shapes.
    pub elements: Vec<Element>,
}
