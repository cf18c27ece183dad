//! The frame: a stroke along the border of the area.

use glam::DVec2;
use kurbo::BezPath;

use crate::samples::reconstruct::point;
use crate::samples::{Area, Curve};

/// Strokes of the given width along the border of `area`; of a rolled one, along its first lap.
pub(super) fn frame(area: &Area, width_mm: f64) -> Vec<Curve> {
    let grid = area.region().grid();
    let mut curves = Vec::new();
    for contour in area.region().contours() {
        let points: Vec<DVec2> = contour.points().iter().map(|&p| grid.to_mm(p)).collect();
        let Some(lap_mm) = area.lap_mm() else {
            let mut path = line(&points);
            path.close_path();
            curves.push(Curve { path, width_mm });
            continue;
        };
        let sides = points.iter().zip(points.iter().cycle().skip(1));
        let within = sides.filter_map(|(&a, &b)| in_lap(a, b, lap_mm));
        curves.extend(within.map(|side| Curve { path: line(&side), width_mm }));
    }
    curves
}

fn line(points: &[DVec2]) -> BezPath {
    let mut path = BezPath::new();
    path.move_to(point(points[0]));
    points[1..].iter().for_each(|&p| path.line_to(point(p)));
    path
}

/// The part of a side from x = 0 to one lap.
fn in_lap(a: DVec2, b: DVec2, lap_mm: f64) -> Option<[DVec2; 2]> {
    let [from, to] = if a.x == b.x {
        if (0.0..=lap_mm).contains(&a.x) { [0.0, 1.0] } else { return None }
    } else {
        let mut parts = [0.0, lap_mm].map(|x| ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0));
        parts.sort_by(f64::total_cmp);
        parts
    };
    (from < to).then(|| [a.lerp(b, from), a.lerp(b, to)])
}
