//! A closed outline of straight lines and cubic Béziers, as a file will hold it.

use glam::DVec2;

/// What follows a point of an outline, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Segment {
    /// A straight line to a point.
    Line(DVec2),
    /// A cubic Bézier: two control points and the end.
    Cubic(DVec2, DVec2, DVec2),
}

impl Segment {
    pub(super) fn end(&self) -> DVec2 {
        match *self {
            Self::Line(end) | Self::Cubic(_, _, end) => end,
        }
    }
}

/// A closed outline; the last segment ends where the first begins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    pub(super) start: DVec2,
    pub(super) segments: Vec<Segment>,
}

/// A cubic Bézier by its control points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cubic(pub(super) [DVec2; 4]);

impl Cubic {
    pub(super) fn at(&self, t: f64) -> DVec2 {
        let Self([p0, p1, p2, p3]) = *self;
        let s = 1.0 - t;
        p0 * (s * s * s) + p1 * (3.0 * s * s * t) + p2 * (3.0 * s * t * t) + p3 * (t * t * t)
    }

    /// The first derivative.
    pub(super) fn velocity(&self, t: f64) -> DVec2 {
        let Self([p0, p1, p2, p3]) = *self;
        let s = 1.0 - t;
        3.0 * ((p1 - p0) * (s * s) + (p2 - p1) * (2.0 * s * t) + (p3 - p2) * (t * t))
    }

    /// The second derivative.
    pub(super) fn acceleration(&self, t: f64) -> DVec2 {
        let Self([p0, p1, p2, p3]) = *self;
        6.0 * ((p2 - 2.0 * p1 + p0) * (1.0 - t) + (p3 - 2.0 * p2 + p1) * t)
    }

    /// How many equal steps of t keep the chords within `tolerance_mm`.
    pub(super) fn pieces_within(&self, tolerance_mm: f64) -> usize {
        let bend = self.acceleration(0.0).length().max(self.acceleration(1.0).length());
        ((bend / (8.0 * tolerance_mm)).sqrt().ceil() as usize).max(1)
    }
}

/// The distance of `p` from the line from `from` to `to`, which may be a point.
pub(super) fn distance_to_edge(p: DVec2, from: DVec2, to: DVec2) -> f64 {
    let d = to - from;
    let t = ((p - from).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(from + d * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flattening_keeps_the_tolerance() {
        let cubic = Cubic([(0.0, 0.0), (0.0, 8.0), (9.0, 8.0), (9.0, -3.0)].map(DVec2::from));
        let n = cubic.pieces_within(0.01);
        assert!((20..60).contains(&n), "{n}");
        let points: Vec<DVec2> = (0..=n).map(|i| cubic.at(i as f64 / n as f64)).collect();
        for i in 0..1000 {
            let p = cubic.at(f64::from(i) / 999.0);
            let near = points.windows(2).map(|w| distance_to_edge(p, w[0], w[1]));
            assert!(near.fold(f64::INFINITY, f64::min) <= 0.01);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_curve() {
        let cubic = Cubic([(0.0, 0.0), (1.0, 8.0), (9.0, 5.0), (9.0, -3.0)].map(DVec2::from));
        let (t, h) = (0.3, 1e-5);
        let slope = (cubic.at(t + h) - cubic.at(t - h)) / (2.0 * h);
        assert!((slope - cubic.velocity(t)).length() < 1e-6);
        let bend = (cubic.velocity(t + h) - cubic.velocity(t - h)) / (2.0 * h);
        assert!((bend - cubic.acceleration(t)).length() < 1e-6);
    }
}
