//! A closed outline of straight lines, circular arcs and cubic Béziers, as a file will hold it.

use glam::DVec2;

/// What follows a point of an outline, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Segment {
    /// A straight line to a point.
    Line(DVec2),
    /// A circular arc to a point, and its bulge: the tangent of a quarter of its turn, positive to the left.
    Arc(DVec2, f64),
    /// A cubic Bézier: two control points and the end.
    Cubic(DVec2, DVec2, DVec2),
}

impl Segment {
    pub(super) fn end(&self) -> DVec2 {
        match *self {
            Self::Line(end) | Self::Arc(end, _) | Self::Cubic(_, _, end) => end,
        }
    }
}

/// A closed outline; the last segment ends where the first begins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    pub(super) start: DVec2,
    pub(super) segments: Vec<Segment>,
}

impl Outline {
    /// The same outline from the start of segment `first` on.
    pub(super) fn beginning_with(mut self, first: usize) -> Self {
        if first > 0 {
            self.start = self.segments[first - 1].end();
            self.segments.rotate_left(first);
        }
        self
    }

    /// The points at which its segments begin, the start first.
    pub(super) fn joints(&self) -> impl Iterator<Item = DVec2> + '_ {
        let inner = self.segments[..self.segments.len() - 1].iter().map(Segment::end);
        std::iter::once(self.start).chain(inner)
    }

    /// Its length; that of cubics is summed over chords within `chord_mm`.
    pub(super) fn length_mm(&self, chord_mm: f64) -> f64 {
        let lengths = self.joints().zip(&self.segments).map(|(from, segment)| match *segment {
            Segment::Line(to) => from.distance(to),
            Segment::Arc(to, bulge) => Arc { from, to, bulge }.length(),
            Segment::Cubic(a, b, to) => {
                let cubic = Cubic([from, a, b, to]);
                let n = cubic.pieces_within(chord_mm);
                let at = |i: usize| cubic.at(i as f64 / n as f64);
                (0..n).map(|i| at(i).distance(at(i + 1))).sum()
            }
        });
        lengths.sum()
    }
}

/// A circular arc of less than half a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arc {
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    /// The tangent of a quarter of the turn, positive to the left; not zero.
    pub(super) bulge: f64,
}

impl Arc {
    pub(super) fn centre(&self) -> DVec2 {
        let chord = self.to - self.from;
        self.from + chord / 2.0 + chord.perp() * ((1.0 - self.bulge * self.bulge) / (4.0 * self.bulge))
    }

    pub(super) fn radius(&self) -> f64 {
        self.from.distance(self.to) * (1.0 + self.bulge * self.bulge) / (4.0 * self.bulge.abs())
    }

    /// The signed angle from its first direction to its last, in radians.
    pub(super) fn turn(&self) -> f64 {
        4.0 * self.bulge.atan()
    }

    fn length(&self) -> f64 {
        self.radius() * self.turn().abs()
    }

    /// How far it is from its chord at most.
    pub(super) fn rise(&self) -> f64 {
        0.5 * self.bulge.abs() * self.from.distance(self.to)
    }

    /// The point at `t`, from 0 to 1.
    pub(super) fn at(&self, t: f64) -> DVec2 {
        let centre = self.centre();
        centre + DVec2::from_angle(t * self.turn()).rotate(self.from - centre)
    }

    /// The derivative by t.
    pub(super) fn velocity(&self, t: f64) -> DVec2 {
        (self.at(t) - self.centre()).perp() * self.turn()
    }

    /// How many equal steps of t keep the chords within `tolerance_mm`.
    pub(super) fn pieces_within(&self, tolerance_mm: f64) -> usize {
        let step = 2.0 * (1.0 - tolerance_mm / self.radius()).clamp(-1.0, 1.0).acos();
        ((self.turn().abs() / step.max(1e-6)).ceil() as usize).max(1)
    }
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
    fn an_arc_is_that_of_its_bulge() {
        // Of the unit circle, from the right to the top.
        let arc = Arc { from: DVec2::X, to: DVec2::Y, bulge: std::f64::consts::FRAC_PI_8.tan() };
        assert!(arc.centre().length() < 1e-12 && (arc.radius() - 1.0).abs() < 1e-12);
        assert!((arc.turn() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!(
            arc.at(0.5).distance(DVec2::ONE.normalize()) < 1e-12 && arc.at(1.0).distance(DVec2::Y) < 1e-12
        );
        assert!((arc.rise() - (1.0 - 0.5f64.sqrt())).abs() < 1e-12);
        let n = arc.pieces_within(0.01);
        let middle = (arc.at(0.0) + arc.at(1.0 / n as f64)) / 2.0;
        assert!((0.99..1.0).contains(&middle.length()), "{n} pieces");
        let back = Arc { from: DVec2::Y, to: DVec2::X, bulge: -arc.bulge };
        assert!(back.centre().length() < 1e-12 && back.velocity(0.0).angle_to(DVec2::X).abs() < 1e-12);
    }

    #[test]
    fn an_outline_may_begin_anywhere() {
        let corners = [(4.0, 0.0), (4.0, 3.0), (0.0, 0.0)].map(DVec2::from);
        let outline = Outline { start: corners[2], segments: corners.map(Segment::Line).to_vec() };
        assert_eq!(outline.length_mm(0.01), 12.0);
        let turned = outline.clone().beginning_with(2);
        assert_eq!((turned.start, turned.segments[2].end()), (corners[1], corners[1]));
        assert_eq!(
            outline.beginning_with(0).joints().collect::<Vec<_>>(),
            [corners[2], corners[0], corners[1]]
        );
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
