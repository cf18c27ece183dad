//! Circular arcs by arc length, and the pair of arcs that joins two tangents.

use glam::DVec2;

/// An arc of a circle, or a straight line where the curvature is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arc {
    /// Where it begins.
    pub start: DVec2,
    /// The unit direction of travel there.
    pub direction: DVec2,
    /// In 1/mm, positive where it turns left.
    pub curvature: f64,
    /// In mm, not negative.
    pub length: f64,
}

impl Arc {
    /// The arc that leaves `start` in the unit `direction` and ends in `end`.
    pub fn through(start: DVec2, direction: DVec2, end: DVec2) -> Self {
        let chord = end - start;
        let chord_length = chord.length();
        if chord_length == 0.0 {
            return Self { start, direction, curvature: 0.0, length: 0.0 };
        }
        // The angle between tangent and chord is half of the arc's turn.
        let half_turn = direction.perp_dot(chord).atan2(direction.dot(chord));
        let curvature = 2.0 * half_turn.sin() / chord_length;
        Self { start, direction, curvature, length: chord_length / sinc(half_turn) }
    }

    /// The point `s` mm from the start; beyond the ends it continues round the circle.
    pub fn point(&self, s: f64) -> DVec2 {
        let half_turn = 0.5 * self.curvature * s;
        self.start + turned(self.direction, half_turn) * (s * sinc(half_turn))
    }

    /// The unit direction of travel `s` mm from the start.
    pub fn direction_at(&self, s: f64) -> DVec2 {
        turned(self.direction, self.curvature * s)
    }

    /// The unit direction of travel at the end.
    pub fn end_direction(&self) -> DVec2 {
        self.direction_at(self.length)
    }

    /// By how much the direction turns from start to end, in radians.
    pub fn turn(&self) -> f64 {
        self.curvature * self.length
    }

    /// The part from `from` to `to` mm.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self {
            start: self.point(from),
            direction: self.direction_at(from),
            curvature: self.curvature,
            length: to - from,
        }
    }

    /// The distance of `p` from the arc's whole circle, negative on the left of the direction of travel.
    ///
    /// (|p − centre| − r) written so that it does not cancel for a large radius, nor divide by zero for a line.
    pub fn distance(&self, p: DVec2) -> f64 {
        let q = p - self.start;
        let normal = self.direction.perp();
        let k = self.curvature;
        (k * q.length_squared() - 2.0 * q.dot(normal)) / ((k * q - normal).length() + 1.0)
    }
}

/// Two arcs with a common tangent, from `p0` in direction `d0` to `p1` in direction `d1` (both of unit
/// length): the biarc whose two tangent lengths are equal, which always exists for different points. Equal
/// arcs result where one arc would do.
pub(super) fn biarc(p0: DVec2, d0: DVec2, p1: DVec2, d1: DVec2) -> [Arc; 2] {
    let chord = p1 - p0;
    let along = chord.dot(d0 + d1);
    // 2 (1 - d0·d1), without cancelling for nearly parallel directions.
    let bend = (d1 - d0).length_squared();
    let reach = chord.length_squared() / (along + (along * along + bend * chord.length_squared()).sqrt());
    let reach = if reach.is_finite() { reach } else { 0.5 * chord.length() };
    let joint = 0.5 * ((p0 + d0 * reach) + (p1 - d1 * reach));
    let first = Arc::through(p0, d0, joint);
    [first, Arc::through(joint, first.end_direction(), p1)]
}

/// The angle from unit direction `a` to `b` in radians, positive to the left, at most π.
pub(super) fn turn_between(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b).atan2(a.dot(b))
}

fn turned(direction: DVec2, angle: f64) -> DVec2 {
    DVec2::from_angle(angle).rotate(direction)
}

/// sin(x)/x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_quarter_circle() {
        let arc = Arc::through(DVec2::new(3.0, 0.0), DVec2::Y, DVec2::new(0.0, 3.0));
        assert!((arc.length - 3.0 * FRAC_PI_2).abs() < 1e-12);
        assert!((arc.curvature - 1.0 / 3.0).abs() < 1e-12);
        assert!((arc.end_direction() - DVec2::NEG_X).length() < 1e-12);
        assert!((arc.distance(DVec2::new(0.0, 5.0)) - 2.0).abs() < 1e-12);
        assert!((arc.distance(DVec2::ZERO) + 3.0).abs() < 1e-12);
    }

    #[test]
    fn parallel_directions_are_joined_by_an_s() {
        let [a, b] = biarc(DVec2::ZERO, DVec2::X, DVec2::new(4.0, 1.0), DVec2::X);
        assert!((a.point(a.length) - DVec2::new(2.0, 0.5)).length() < 1e-12);
        assert!((a.curvature + b.curvature).abs() < 1e-12 && a.curvature > 0.0);
    }

    proptest! {
        #[test]
        fn a_biarc_meets_both_ends(
            x in -5.0..5.0f64, y in 0.1..5.0f64, from in -PI..PI, to in -PI..PI,
        ) {
            let (p1, d0, d1) = (DVec2::new(x, y), DVec2::from_angle(from), DVec2::from_angle(to));
            // Directions that both point straight back leave a half turn of no curvature.
            prop_assume!(p1.normalize().dot(d0) > -0.99 || p1.normalize().dot(d1) > -0.99);
            let [a, b] = biarc(DVec2::ZERO, d0, p1, d1);
            prop_assert!((a.point(a.length) - b.start).length() < 1e-7);
            prop_assert!((b.point(b.length) - p1).length() < 1e-7);
            prop_assert!((b.end_direction() - d1).length() < 1e-7);
        }
    }
}
