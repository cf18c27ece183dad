//! B-splines, rational or not, as polylines.
//!
//! Points are evaluated by de Boor's recursion, and each span between different knots is halved until the points at
//! its quarters lie close to the chord. A span is one polynomial (or a quotient of two), so it does not wiggle between
//! them more than its degree allows. Excluded: splines that are given by points to pass through.

use glam::{DVec2, DVec3};

/// Halvings of a span at most.
const MAX_DEPTH: u32 = 14;
/// Halvings of a span at least, so that symmetry does not hide a bend.
const MIN_DEPTH: u32 = 2;

/// A B-spline in the plane.
pub(super) struct Spline {
    degree: usize,
    knots: Vec<f64>,
    /// x, y and 1, all times the weight.
    control: Vec<DVec3>,
}

impl Spline {
    /// A spline of so many knots as control points and the degree and one more; without weights all weigh 1.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn new(
        degree: i64,
        knots: Vec<f64>,
        control: Vec<DVec2>,
        weights: Vec<f64>,
    ) -> Result<Self, &'static str> {
        if control.is_empty() {
            return Err("it has no control points; convert it to one that has");
        }
        let degree = usize::try_from(degree).ok().filter(|d| (1..=20).contains(d));
        let degree = degree.ok_or("its degree is not from 1 to 20")?;
        if control.len() <= degree || knots.len() != control.len() + degree + 1 {
            return Err("it has not as many knots as its degree and control points ask for");
        }
        if !knots.windows(2).all(|w| w[0] <= w[1]) || knots[degree] >= knots[control.len()] {
            return Err("its knots do not ascend");
        }
        if !weights.is_empty() && (weights.len() != control.len() || !weights.iter().all(|w| *w > 0.0)) {
            return Err("its weights are not one positive number for each control point");
        }
        let weigh = |(i, p): (usize, &DVec2)| p.extend(1.0) * weights.get(i).copied().unwrap_or(1.0);
        let control = control.iter().enumerate().map(weigh).collect();
        Ok(Self { degree, knots, control })
    }

    /// Points of the spline from its start to its end, with chords within `chord_mm`.
    pub(super) fn flattened(&self, chord_mm: f64) -> Vec<DVec2> {
        let spans = self.degree..self.control.len();
        let mut points = Vec::new();
        for span in spans.filter(|&span| self.knots[span] < self.knots[span + 1]) {
            let (low, high) = (self.knots[span], self.knots[span + 1]);
            let (from, to) = (self.at(span, low), self.at(span, high));
            // Spans meet where they join: one of the two points will do.
            if points.is_empty() {
                points.push(from);
            }
            self.halve(span, [low, high], [from, to], chord_mm, 0, &mut points);
        }
        points
    }

    fn halve(
        &self,
        span: usize,
        [low, high]: [f64; 2],
        [from, to]: [DVec2; 2],
        chord_mm: f64,
        depth: u32,
        points: &mut Vec<DVec2>,
    ) {
        let middle = 0.5 * (low + high);
        let quarters = [0.25, 0.5, 0.75].map(|t| self.at(span, low + t * (high - low)));
        let close = |p: &DVec2| {
            let d = to - from;
            let t = ((p - from).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            p.distance(from + d * t) <= chord_mm
        };
        // A line is one at once: all its control points lie on the chord, and so do the quarters.
        let straight =
            quarters.iter().all(|p| p.distance(from) + p.distance(to) <= from.distance(to) * (1.0 + 1e-12));
        if straight || depth >= MAX_DEPTH || (depth >= MIN_DEPTH && quarters.iter().all(close)) {
            points.push(to);
            return;
        }
        let at = quarters[1];
        self.halve(span, [low, middle], [from, at], chord_mm, depth + 1, points);
        self.halve(span, [middle, high], [at, to], chord_mm, depth + 1, points);
    }

    /// The point at a parameter between knots `span` and the next.
    fn at(&self, span: usize, u: f64) -> DVec2 {
        let degree = self.degree;
        let mut d: Vec<DVec3> = self.control[span - degree..=span].to_vec();
        for round in 1..=degree {
            for j in (round..=degree).rev() {
                let i = span - degree + j;
                let (low, high) = (self.knots[i], self.knots[i + degree + 1 - round]);
                let t = if high > low { (u - low) / (high - low) } else { 0.0 };
                d[j] = d[j - 1].lerp(d[j], t);
            }
        }
        d[degree].truncate() / d[degree].z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_span_is_the_bezier_of_its_points() {
        let control = [(0.0, 0.0), (0.0, 8.0), (9.0, 8.0), (9.0, -3.0)].map(DVec2::from).to_vec();
        let spline =
            Spline::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], control.clone(), vec![]).unwrap();
        let points = spline.flattened(0.001);
        assert_eq!((points[0], points[points.len() - 1]), (control[0], control[3]));
        let bezier = |t: f64| {
            let s = 1.0 - t;
            control[0] * s * s * s
                + control[1] * 3.0 * s * s * t
                + control[2] * 3.0 * s * t * t
                + control[3] * t * t * t
        };
        assert!(spline.at(3, 0.3).distance(bezier(0.3)) < 1e-12);
        assert!((20..200).contains(&points.len()), "{}", points.len());
    }

    #[test]
    fn a_straight_span_is_one_line() {
        let control = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)].map(DVec2::from).to_vec();
        let spline = Spline::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], control, vec![]).unwrap();
        assert_eq!(spline.flattened(0.001).len(), 2);
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let points = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert!(Spline::new(2, knots.clone(), points.clone(), vec![]).is_ok());
        assert!(Spline::new(3, knots.clone(), points.clone(), vec![]).is_err());
        assert!(Spline::new(0, knots.clone(), points.clone(), vec![]).is_err());
        assert!(Spline::new(2, knots.clone(), points.clone(), vec![1.0]).is_err());
        assert!(Spline::new(2, vec![0.0, 0.0, 1.0, 0.0, 1.0, 1.0], points, vec![]).is_err());
    }
}
