//! Contours with fewer vertices, for questions whose answer does not hang on the last micrometre.
//!
//! Contours are flattened within a small part of the chord error, and how they look eroded is asked again and again.
//! From an anchor, vertices are passed over as long as one straight edge passes all of them closely enough: the
//! directions in which it would do so are a sector, which each vertex narrows (Williams 1978, Sklansky and Gonzalez
//! 1980). It takes one pass.

use glam::DVec2;

use crate::planar::GridPoint;

/// A closed path without the vertices that a straight edge passes within `slack` grid steps; the same when that
/// leaves no polygon.
pub(super) fn thinned(path: &[GridPoint], slack: f64) -> Vec<GridPoint> {
    let n = path.len();
    let mut kept = Vec::new();
    let mut anchor = 0;
    while anchor < n {
        kept.push(path[anchor]);
        let mut end = anchor + 1;
        let mut sector = Sector::new(path[anchor], path[end % n], slack);
        // Contours are closed: the first vertex stays, whatever comes before it.
        while end < n && sector.admits(path[(end + 1) % n]) {
            end += 1;
        }
        anchor = end;
    }
    if kept.len() < 3 { path.to_vec() } else { kept }
}

/// The directions of edges from an anchor that pass all vertices so far closely enough.
struct Sector {
    anchor: GridPoint,
    /// The direction to the first vertex; angles are from here.
    base: DVec2,
    low: f64,
    high: f64,
    /// How far the last vertex is: an edge that turned back would pass by more than its directions say.
    reach: f64,
    slack: f64,
}

impl Sector {
    fn new(anchor: GridPoint, first: GridPoint, slack: f64) -> Self {
        let base = from_to(anchor, first);
        let half = half_angle(slack, base.length());
        Self { anchor, base, low: -half, high: half, reach: base.length(), slack }
    }

    /// Whether an edge to `p` will do; if so, the sector is narrowed by `p`, as it may be passed over next.
    fn admits(&mut self, p: GridPoint) -> bool {
        let ahead = from_to(self.anchor, p);
        let (length, angle) = (ahead.length(), self.base.angle_to(ahead));
        let admits = length > self.reach && (self.low..=self.high).contains(&angle);
        if admits {
            let half = half_angle(self.slack, length);
            (self.low, self.high) = (self.low.max(angle - half), self.high.min(angle + half));
            self.reach = length;
        }
        admits
    }
}

fn half_angle(slack: f64, length: f64) -> f64 {
    (slack / length).min(1.0).asin()
}

fn from_to(a: GridPoint, b: GridPoint) -> DVec2 {
    DVec2::new((b.x - a.x) as f64, (b.y - a.y) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A wobbly closed curve.
    fn blob(n: usize, waves: f64, depth: f64) -> Vec<GridPoint> {
        let at = |i: usize| {
            let t = std::f64::consts::TAU * i as f64 / n as f64;
            let r = 1e6 * (1.0 + depth * (waves * t).sin());
            GridPoint::new((r * t.cos()).round() as i64, (r * t.sin()).round() as i64)
        };
        (0..n).map(at).collect()
    }

    fn distance(p: GridPoint, a: GridPoint, b: GridPoint) -> f64 {
        let (ap, ab) = (from_to(a, p), from_to(a, b));
        let t = (ap.dot(ab) / ab.length_squared()).clamp(0.0, 1.0);
        ap.distance(ab * t)
    }

    proptest! {
        #[test]
        fn what_is_passed_over_is_within_the_slack(
            n in 3usize..400, waves in 1u8..7, depth in 0.0..0.8, slack in 1.0..40_000.0
        ) {
            let path = blob(n, f64::from(waves), depth);
            let thin = thinned(&path, slack);
            prop_assert!((3..=n).contains(&thin.len()));
            // Vertices stay in order, and the edge that stands for those between two of them passes close by.
            let kept: Vec<usize> = thin.iter().map(|p| path.iter().position(|q| p == q).unwrap()).collect();
            prop_assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
            for (k, &from) in kept.iter().enumerate() {
                let to = kept.get(k + 1).copied().unwrap_or(n);
                let (a, b) = (path[from], path[to % n]);
                prop_assert!((from..to).all(|i| distance(path[i], a, b) <= slack * (1.0 + 1e-9)));
            }
        }
    }

    #[test]
    fn a_circle_keeps_as_many_vertices_as_its_slack_needs() {
        let path = blob(20_000, 1.0, 0.0);
        // The sagitta of n edges around a circle of radius r is about r π²/2n²; the sector allows twice that and more.
        let thin = thinned(&path, 100.0).len();
        assert!((60..400).contains(&thin), "{thin}");
    }
}
