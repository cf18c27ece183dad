//! Cubic Hermite interpolation of points on a line, with slopes that keep monotone data monotone.

/// A function through points (x_k, y_k) with ascending x: cubic between them, with the limited slopes of
/// Fritsch and Butland (1984), so that it never overshoots: between two points it stays between their values,
/// and it increases where they do.
#[derive(Debug, Clone)]
pub struct Monotone {
    xs: Vec<f64>,
    ys: Vec<f64>,
    slopes: Vec<f64>,
    outside: f64,
}

impl Monotone {
    /// The interpolant through `points`, ascending in x, continued beyond the ends with slope `outside` (0 or
    /// 1). Without points it is `outside` times x.
    pub fn new(points: &[(f64, f64)], outside: f64) -> Self {
        let xs: Vec<f64> = points.iter().map(|p| p.0).collect();
        let ys: Vec<f64> = points.iter().map(|p| p.1).collect();
        let secants: Vec<f64> = points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
        let n = points.len();
        let slope = |k: usize| {
            let before = k.checked_sub(1).map(|i| secants[i]);
            let after = secants.get(k).copied();
            match (before, after) {
                (Some(a), Some(b)) => harmonic(a, b),
                // At the ends the slope outside, as far as it does not overshoot.
                (Some(s), None) | (None, Some(s)) if s > 0.0 => outside.min(2.7 * s),
                (Some(_), None) | (None, Some(_)) => 0.0,
                (None, None) => outside,
            }
        };
        let slopes = (0..n).map(slope).collect();
        Self { xs, ys, slopes, outside }
    }

    /// The value at `x`.
    pub fn value(&self, x: f64) -> f64 {
        let n = self.xs.len();
        if n == 0 {
            return self.outside * x;
        }
        if x <= self.xs[0] {
            return self.ys[0] + self.outside * (x - self.xs[0]);
        }
        if x >= self.xs[n - 1] {
            return self.ys[n - 1] + self.outside * (x - self.xs[n - 1]);
        }
        let (k, h, t) = self.locate(x);
        let (t2, t3) = (t * t, t * t * t);
        self.ys[k] * (2.0 * t3 - 3.0 * t2 + 1.0)
            + self.ys[k + 1] * (3.0 * t2 - 2.0 * t3)
            + h * self.slopes[k] * (t3 - 2.0 * t2 + t)
            + h * self.slopes[k + 1] * (t3 - t2)
    }

    /// The derivative at the k-th point.
    pub fn slope_at(&self, k: usize) -> f64 {
        self.slopes[k]
    }

    fn locate(&self, x: f64) -> (usize, f64, f64) {
        let k = self.xs.partition_point(|&k| k <= x) - 1;
        let h = self.xs[k + 1] - self.xs[k];
        (k, h, (x - self.xs[k]) / h)
    }

    /// The least and the greatest derivative anywhere, exact.
    pub fn slope_range(&self) -> (f64, f64) {
        let mut range = (self.outside, self.outside);
        let mut include = |d: f64| range = (range.0.min(d), range.1.max(d));
        for k in 0..self.xs.len().saturating_sub(1) {
            let secant = (self.ys[k + 1] - self.ys[k]) / (self.xs[k + 1] - self.xs[k]);
            let (a, b) = (self.slopes[k], self.slopes[k + 1]);
            include(a);
            include(b);
            // d(t) = a + 2(3s − 2a − b) t + 3(a + b − 2s) t² is stationary at one t.
            let (linear, square) = (3.0 * secant - 2.0 * a - b, a + b - 2.0 * secant);
            let t = -linear / (3.0 * square);
            if (0.0..=1.0).contains(&t) {
                include(a + 2.0 * linear * t + 3.0 * square * t * t);
            }
        }
        range
    }
}

/// The harmonic mean of two slopes of one sign, else 0.
fn harmonic(a: f64, b: f64) -> f64 {
    if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn monotone_data_stays_monotone(steps in prop::collection::vec((0.01f64..3.0, 0.01f64..3.0), 1..12)) {
            let mut at = (-5.0, -4.0);
            let points: Vec<(f64, f64)> = steps.iter().map(|s| { at = (at.0 + s.0, at.1 + s.1); at }).collect();
            let f = Monotone::new(&points, 1.0);
            let (least, greatest) = f.slope_range();
            prop_assert!(least > 0.0);
            let (from, to) = (points[0].0 - 1.0, points[points.len() - 1].0 + 1.0);
            let n = 400;
            let at = |i: usize| from + (to - from) * i as f64 / n as f64;
            for i in 0..n {
                let slope = (f.value(at(i + 1)) - f.value(at(i))) / (at(i + 1) - at(i));
                prop_assert!(slope >= least - 1e-9 && slope <= greatest + 1e-9, "{slope} in {least}..{greatest}");
            }
            for p in &points {
                prop_assert!((f.value(p.0) - p.1).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn without_points_it_is_the_identity() {
        assert_eq!(Monotone::new(&[], 1.0).value(3.5), 3.5);
        let shift = Monotone::new(&[(1.0, 3.0)], 1.0);
        assert_eq!((shift.value(-1.0), shift.value(2.0)), (1.0, 4.0));
    }
}
