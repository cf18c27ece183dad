//! Paths as chains of chords: the one adapter to the curve library's flattening.

use glam::DVec2;
use kurbo::{BezPath, PathEl, Point};

/// A subpath as a chain of chords.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chords {
    /// Its vertices in the units of the path; the first is not repeated at the end.
    pub points: Vec<DVec2>,
    /// Whether it closes.
    pub is_closed: bool,
}

impl Chords {
    /// The vertices on the way along it: of one that closes, and does not end where it began, the first is repeated.
    pub fn way(mut self) -> Vec<DVec2> {
        if self.is_closed && self.points.first() != self.points.last() {
            self.points.push(self.points[0]);
        }
        self.points
    }
}

/// The subpaths of a path, within `tolerance` of it.
pub fn chords(path: &BezPath, tolerance: f64) -> Vec<Chords> {
    let mut subpaths: Vec<Chords> = Vec::new();
    // Of a curve that hardly bends, points between its ends come out as no numbers where none are needed.
    let is_lost = |p: Point| path.is_finite() && !p.is_finite();
    kurbo::flatten(path, tolerance, |el| match el {
        PathEl::MoveTo(p) => {
            subpaths.push(Chords { points: vec![DVec2::new(p.x, p.y)], is_closed: false });
        }
        el => {
            let subpath = subpaths.last_mut().expect("a path begins with a move");
            match el.end_point() {
                Some(p) if is_lost(p) => {}
                Some(p) => subpath.points.push(DVec2::new(p.x, p.y)),
                None => subpath.is_closed = true,
            }
        }
    });
    subpaths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subpaths_close_where_they_say() {
        let path = BezPath::from_svg("M0 0H4V3Z M9 9L10 9 M1 1H2V2L1 1Z").unwrap();
        let [triangle, line, returned] = &chords(&path, 0.1)[..] else { panic!("three subpaths") };
        assert_eq!((triangle.points.len(), triangle.is_closed), (3, true));
        assert_eq!(triangle.clone().way().len(), 4);
        assert_eq!((line.clone().way().len(), line.is_closed), (2, false));
        assert_eq!((returned.points.len(), returned.clone().way().len()), (4, 4));
    }

    #[test]
    fn what_hardly_bends_has_numbers_for_points() {
        let [a, b, c, d] = [
            (67.8621944980384, 0.4616083222768688),
            (67.86219449803839, -1.405058393746542),
            (67.88168900487373, -3.221757903194507),
            (67.88168900487375, -5.088424619217918),
        ];
        let mut path = BezPath::new();
        path.move_to(a);
        path.curve_to(b, c, d);
        let [line] = &chords(&path, 0.0025)[..] else { panic!("one subpath") };
        assert!(line.points.iter().all(|p| p.is_finite()), "{:?}", line.points);
        assert_eq!((line.points[0], *line.points.last().unwrap()), (DVec2::from(a), DVec2::from(d)));
    }
}
