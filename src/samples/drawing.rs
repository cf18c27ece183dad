//! A pattern as it is drawn: curves with a pen, and filled elements.

use glam::DVec2;
use kurbo::{BezPath, Shape};

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

impl Drawing {
    /// It with another one.
    pub fn with(&self, other: &Self) -> Self {
        let mut both = self.clone();
        both.curves.extend_from_slice(&other.curves);
        both.elements.extend_from_slice(&other.elements);
        both
    }

    /// Lower left and upper right corner of the lines of curves and of the ink of elements, in millimetres; `None` if there is nothing.
    pub fn bounds_mm(&self) -> Option<(DVec2, DVec2)> {
        let of_curve = |curve: &Curve| {
            let bounds = curve.path.bounding_box();
            [DVec2::new(bounds.x0, bounds.y0), DVec2::new(bounds.x1, bounds.y1)]
        };
        let curves = self.curves.iter().flat_map(of_curve);
        let elements = self.elements.iter().flat_map(|element| element.contours.iter().flatten().copied());
        let mut points = curves.chain(elements);
        let first = points.next()?;
        Some(points.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
    }
}
