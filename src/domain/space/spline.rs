//! A smooth curve through points in space.
//!
//! A cubic spline with a continuous second derivative, by the length of the chords between its points (natural at the ends of an
//! open curve, periodic on a closed one). Excluded: arc length and frames.

use glam::DVec3;

/// A cubic spline by its knots, with a point and a second derivative at each.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Spline {
    knots: Vec<f64>,
    points: Vec<DVec3>,
    bends: Vec<DVec3>,
}

/// Where a curve is at a parameter, with its first and second derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Jet {
    pub(in super::super) point: DVec3,
    pub(in super::super) velocity: DVec3,
    pub(in super::super) bend: DVec3,
}

impl Jet {
    /// The curvature, as a vector towards the centre.
    pub(super) fn curvature(&self) -> DVec3 {
        let along = self.velocity.normalize();
        (self.bend - along * self.bend.dot(along)) / self.velocity.length_squared()
    }
}

impl Spline {
    /// The spline through `points`, of which no two in a row are the same; at least two, and three that close.
    pub(in super::super) fn through(points: &[DVec3], is_closed: bool) -> Self {
        let n = points.len();
        let steps = (0..n - usize::from(!is_closed)).map(|i| points[i].distance(points[(i + 1) % n]));
        Self::by_steps(points, steps.collect(), is_closed)
    }

    /// The spline through `points`, which may be the same, with its knots `steps` apart, all more than 0; one for each two
    /// points in a row.
    pub(in super::super) fn by_steps(points: &[DVec3], steps: Vec<f64>, is_closed: bool) -> Self {
        let mut points = points.to_vec();
        if is_closed {
            points.push(points[0]);
        }
        let n = points.len() - 1;
        debug_assert_eq!(steps.len(), n);
        let mut knots = vec![0.0; n + 1];
        for i in 0..n {
            knots[i + 1] = knots[i] + steps[i];
        }
        let slope = |i: usize| (points[i + 1] - points[i]) / steps[i];
        let bends = if is_closed {
            let row = |i: usize| {
                let before = (i + n - 1) % n;
                Row {
                    lower: steps[before],
                    middle: 2.0 * (steps[before] + steps[i]),
                    upper: steps[i],
                    right: 6.0 * (slope(i) - slope(before)),
                }
            };
            let mut bends = periodic(&(0..n).map(row).collect::<Vec<_>>());
            bends.push(bends[0]);
            bends
        } else {
            let row = |i: usize| Row {
                lower: steps[i - 1],
                middle: 2.0 * (steps[i - 1] + steps[i]),
                upper: steps[i],
                right: 6.0 * (slope(i) - slope(i - 1)),
            };
            let inner = tridiagonal(&(1..n).map(row).collect::<Vec<_>>());
            [vec![DVec3::ZERO], inner, vec![DVec3::ZERO]].concat()
        };
        Self { knots, points, bends }
    }

    /// The parameters of the points, from 0 on; of a closed curve the first point comes again.
    pub(in super::super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The curve at parameter `t`, which goes on beyond the ends as the last cubics do.
    pub(in super::super) fn at(&self, t: f64) -> Jet {
        let i = self.knots.partition_point(|&k| k <= t).clamp(1, self.knots.len() - 1) - 1;
        let h = self.knots[i + 1] - self.knots[i];
        let (a, b) = ((self.knots[i + 1] - t) / h, (t - self.knots[i]) / h);
        let (p, q, m, n) = (self.points[i], self.points[i + 1], self.bends[i], self.bends[i + 1]);
        Jet {
            point: a * p + b * q + (h * h / 6.0) * ((a * a * a - a) * m + (b * b * b - b) * n),
            velocity: (q - p) / h + (h / 6.0) * ((1.0 - 3.0 * a * a) * m + (3.0 * b * b - 1.0) * n),
            bend: a * m + b * n,
        }
    }
}

/// One equation of a banded system.
#[derive(Debug, Clone, Copy)]
struct Row {
    lower: f64,
    middle: f64,
    upper: f64,
    right: DVec3,
}

/// Solves rows of which each knows its neighbours; the middle outweighs them, so no pivot is needed.
fn tridiagonal(rows: &[Row]) -> Vec<DVec3> {
    let mut upper = vec![0.0; rows.len()];
    let mut solved = vec![DVec3::ZERO; rows.len()];
    for (i, row) in rows.iter().enumerate() {
        let (lower, before, above) =
            if i == 0 { (0.0, DVec3::ZERO, 0.0) } else { (row.lower, solved[i - 1], upper[i - 1]) };
        let pivot = row.middle - lower * above;
        upper[i] = row.upper / pivot;
        solved[i] = (row.right - lower * before) / pivot;
    }
    for i in (0..rows.len().saturating_sub(1)).rev() {
        let next = solved[i + 1];
        solved[i] -= upper[i] * next;
    }
    solved
}

/// The same where the first and the last row are neighbours too (Sherman and Morrison 1950).
fn periodic(rows: &[Row]) -> Vec<DVec3> {
    let n = rows.len();
    let (first, last) = (rows[0], rows[n - 1]);
    let gamma = -first.middle;
    let mut open = rows.to_vec();
    open[0].middle -= gamma;
    open[n - 1].middle -= last.upper * first.lower / gamma;
    let solved = tridiagonal(&open);
    let corner = |i: usize| match i {
        0 => gamma,
        i if i == n - 1 => last.upper,
        _ => 0.0,
    };
    let mut rank_one = open;
    for (i, row) in rank_one.iter_mut().enumerate() {
        row.right = DVec3::splat(corner(i));
    }
    let z = tridiagonal(&rank_one);
    let tail = first.lower / gamma;
    let factor = (solved[0] + tail * solved[n - 1]) / (1.0 + z[0].x + tail * z[n - 1].x);
    solved.iter().zip(&z).map(|(s, z)| *s - factor * z.x).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zigzag(n: usize) -> Vec<DVec3> {
        (0..n)
            .map(|i| i as f64)
            .map(|i| DVec3::new(10.0 * (0.9 * i).cos() + i, 8.0 * (1.3 * i).sin(), 3.0 * (0.7 * i).sin()))
            .collect()
    }

    fn is_smooth(spline: &Spline, knots: &[f64]) {
        for &t in knots {
            let (a, b) = (spline.at(t - 1e-7), spline.at(t + 1e-7));
            assert!(a.point.distance(b.point) < 1e-5 && a.velocity.distance(b.velocity) < 1e-5);
            assert!(a.bend.distance(b.bend) < 1e-4, "{t}: {} {}", a.bend, b.bend);
        }
    }

    #[test]
    fn it_passes_its_points_smoothly() {
        for (n, is_closed) in [(2, false), (3, false), (9, false), (3, true), (4, true), (9, true)] {
            let points = zigzag(n);
            let spline = Spline::through(&points, is_closed);
            for (&t, p) in spline.knots().iter().zip(&points) {
                assert!(spline.at(t).point.distance(*p) < 1e-9, "{n} {is_closed}");
            }
            is_smooth(&spline, &spline.knots()[1..spline.knots().len() - 1]);
            if is_closed {
                let (start, end) = (spline.at(0.0), spline.at(*spline.knots().last().unwrap()));
                assert!(start.point.distance(end.point) < 1e-9);
                assert!(start.velocity.distance(end.velocity) < 1e-9 && start.bend.distance(end.bend) < 1e-9);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_curve() {
        let spline = Spline::through(&zigzag(7), true);
        let end = *spline.knots().last().unwrap();
        for i in 1..200 {
            let (t, h) = (end * f64::from(i) / 200.0, 1e-5);
            let (a, b) = (spline.at(t - h), spline.at(t + h));
            assert!(((b.point - a.point) / (2.0 * h)).distance(spline.at(t).velocity) < 1e-6);
            assert!(((b.velocity - a.velocity) / (2.0 * h)).distance(spline.at(t).bend) < 1e-4);
        }
    }

    #[test]
    fn a_straight_line_stays_straight() {
        let points: Vec<DVec3> = [0.0, 1.0, 5.0, 6.5].map(|x| DVec3::new(x, 2.0 * x, -x)).to_vec();
        let spline = Spline::through(&points, false);
        assert!(spline.at(3.0).bend.length() < 1e-12);
    }
}
