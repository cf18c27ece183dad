//! The frame: a stroke along the border of the area.

use kurbo::BezPath;

use crate::samples::reconstruct::point;
use crate::samples::{Area, Curve};

/// Strokes of the given width along the border of `area`; of a rolled one, along its first lap.
pub(super) fn frame(area: &Area, width_mm: f64) -> Vec<Curve> {
    let grid = area.region().grid();
    let mut curves = Vec::new();
    for contour in area.region().contours() {
        let points: Vec<_> = contour.points().iter().map(|&p| grid.to_mm(p)).collect();
        let mut path = BezPath::new();
        match area.lap_mm() {
            None => {
                path.move_to(point(points[0]));
                points[1..].iter().for_each(|&p| path.line_to(point(p)));
                path.close_path();
                curves.push(Curve { path, width_mm });
            }
            Some(lap_mm) => {
                for (&a, &b) in points.iter().zip(points.iter().cycle().skip(1)) {
                    let at =
                        |x: f64| if a.x == b.x { 0.0 } else { ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0) };
                    let (from, to) = (at(0.0).min(at(lap_mm)), at(0.0).max(at(lap_mm)));
                    if from < to {
                        let mut path = BezPath::new();
                        path.move_to(point(a.lerp(b, from)));
                        path.line_to(point(a.lerp(b, to)));
                        curves.push(Curve { path, width_mm });
                    }
                }
            }
        }
    }
    curves
}
