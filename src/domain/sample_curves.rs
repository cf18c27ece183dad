//! Random smooth paths for the tests of this room.

use glam::DVec2;
use kurbo::BezPath;
use proptest::prelude::*;

/// A smooth path through the points: each segment leaves and arrives along the chord of its neighbours.
fn spline(points: &[DVec2], closed: bool) -> BezPath {
    let n = points.len();
    let at = |i: isize| {
        let last = n as isize - 1;
        points[if closed { i.rem_euclid(n as isize) } else { i.clamp(0, last) } as usize]
    };
    let mut path = BezPath::new();
    path.move_to((points[0].x, points[0].y));
    for i in 0..if closed { n } else { n - 1 } as isize {
        let p1 = at(i) + (at(i + 1) - at(i - 1)) / 6.0;
        let p2 = at(i + 1) - (at(i + 2) - at(i)) / 6.0;
        let p3 = at(i + 1);
        path.curve_to((p1.x, p1.y), (p2.x, p2.y), (p3.x, p3.y));
    }
    if closed {
        path.close_path();
    }
    path
}

/// An open path of some 80 to 250 mm that winds about without turning back sharply.
pub(super) fn open_path() -> impl Strategy<Value = BezPath> {
    prop::collection::vec((20.0..40.0f64, -0.5..0.5f64), 4..7).prop_map(|steps| {
        let mut points = vec![DVec2::new(-10.0, 5.0)];
        let mut heading = 0.3;
        for (length, turn) in steps {
            heading += turn;
            points.push(points[points.len() - 1] + DVec2::from_angle(heading) * length);
        }
        spline(&points, false)
    })
}

/// A closed path around the origin, 30 to 50 mm from it, drawn either way.
pub(super) fn closed_path() -> impl Strategy<Value = BezPath> {
    (prop::collection::vec(30.0..50.0f64, 8..9), any::<bool>()).prop_map(|(radii, reverse)| {
        let n = radii.len() as f64;
        let turn = std::f64::consts::TAU / n * if reverse { -1.0 } else { 1.0 };
        let point = |(i, r): (usize, f64)| DVec2::from_angle(i as f64 * turn) * r;
        let points: Vec<DVec2> = radii.into_iter().enumerate().map(point).collect();
        spline(&points, true)
    })
}
