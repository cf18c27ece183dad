//! What a fine polygon was before it was flattened: straight lines, corners, and smooth runs between them.
//!
//! The vertices lie on the drawing's curves, unevenly spaced, so an angle alone says nothing: a tight bend
//! turns by 40 degrees at each vertex and is smooth, a shallow corner turns by 15 and is not. Two facts tell
//! them apart. A smooth curve that turns so much over so long an edge would leave the tolerance, so its
//! flattening would have had another vertex there. And along a smooth curve the turn at a vertex is about
//! what the curvature of its neighbours explains. Excluded here: how a run is fitted.

use glam::DVec2;

/// A vertex that turns more than this is a corner whatever its neighbours do (radians). Less, and the tip of
/// a coarsely flattened hairline becomes two corners; more, and a cusp would be rounded.
const CERTAIN_TURN: f64 = 1.9;
/// A turn is a corner when it exceeds so many times what the neighbours explain, and a little more. Less, and
/// every uneven spot of a flattening is a corner; more, and corners of a petal are smoothed.
const UNEXPLAINED: (f64, f64) = (2.5, 0.2);
/// A turn at which thinning never drops the vertex (radians).
const KEPT_TURN: f64 = 0.3;
/// The part of the tolerance that thinning may use.
pub(super) const THINNING: f64 = 0.02;

/// A closed polygon and the distance that what stands for an edge may have from it.
#[derive(Debug, Clone)]
pub(super) struct Polygon {
    /// The vertices in millimetres.
    pub(super) points: Vec<DVec2>,
    /// For the edge from each vertex to the next, the tolerance in millimetres; zero keeps the edge.
    pub(super) tolerances: Vec<f64>,
}

/// A stretch of a closed polygon, from a vertex to a vertex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    /// The vertices, both ends included; two for a straight line.
    pub(super) points: Vec<DVec2>,
    /// The tolerance of each edge.
    pub(super) tolerances: Vec<f64>,
    /// The unit directions in which the run leaves its first vertex and reaches its last.
    pub(super) tangents: (DVec2, DVec2),
    /// Whether it is a single straight line.
    pub(super) straight: bool,
}

impl Polygon {
    /// The runs in order, beginning at a corner if there is one. A polygon without corners and lines is one
    /// run, with one tangent at both its ends.
    pub(super) fn runs(&self) -> Vec<Run> {
        let thinned = self.thinned(THINNING);
        let shape = Shape::new(&thinned);
        let n = thinned.points.len();
        let corners = shape.corners();
        let lines = shape.lines(&corners);
        let is_break = |i: usize| corners[i] || lines[i] || lines[(i + n - 1) % n];
        let sharpest = (0..n).max_by(|&a, &b| shape.turns[a].abs().total_cmp(&shape.turns[b].abs()));
        let first = (0..n).find(|&i| is_break(i)).or(sharpest).unwrap_or(0);

        let mut runs = Vec::new();
        let mut from = first;
        while from < first + n {
            let mut to = from + 1;
            while to < first + n && !is_break(to % n) {
                to += 1;
            }
            let straight = to == from + 1 && (is_break(from % n) || n == 1);
            let tangents = if straight {
                (shape.directions[from % n], shape.directions[from % n])
            } else {
                // A smooth join with a line continues the line.
                let at_end = |i: usize, beyond: usize, one_sided: DVec2| {
                    if corners[i] {
                        one_sided
                    } else if lines[beyond] {
                        shape.directions[beyond]
                    } else {
                        shape.tangent(i)
                    }
                };
                (
                    at_end(from % n, (from + n - 1) % n, shape.leaving(from % n)),
                    at_end(to % n, to % n, shape.reaching(to % n)),
                )
            };
            runs.push(Run {
                points: (from..=to).map(|i| thinned.points[i % n]).collect(),
                tolerances: (from..to).map(|i| thinned.tolerances[i % n]).collect(),
                tangents,
                straight,
            });
            from = to;
        }
        runs
    }

    /// The polygon without the vertices that a straight edge passes within a `part` of the tolerance.
    pub(super) fn thinned(&self, part: f64) -> Self {
        let n = self.points.len();
        let edge = |i: usize| self.points[(i + 1) % n] - self.points[i % n];
        let turn = |i: usize| edge(i + n - 1).angle_to(edge(i)).abs();
        let start = (0..n).max_by(|&a, &b| turn(a).total_cmp(&turn(b))).unwrap_or(0);
        let mut thinned = Self { points: Vec::new(), tolerances: Vec::new() };
        let mut anchor = start;
        while anchor < start + n {
            let origin = self.points[anchor % n];
            let tolerance = self.tolerances[anchor % n];
            let slack = tolerance * part;
            let mut end = anchor + 1;
            // The directions that pass all vertices so far closely enough, as an angle either side of a base.
            let base = edge(anchor);
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            let mut reach = base.length();
            while slack > 0.0 && end < start + n {
                let half = (slack / (self.points[end % n] - origin).length()).min(1.0).asin();
                let angle = base.angle_to(self.points[end % n] - origin);
                (low, high) = (low.max(angle - half), high.min(angle + half));
                let next = self.points[(end + 1) % n] - origin;
                let ahead = base.angle_to(next);
                if turn(end) > KEPT_TURN
                    || self.tolerances[end % n] != tolerance
                    || next.length() <= reach
                    || !(low..=high).contains(&ahead)
                {
                    break;
                }
                reach = next.length();
                end += 1;
            }
            thinned.points.push(origin);
            thinned.tolerances.push(tolerance);
            anchor = end;
        }
        if thinned.points.len() < 3 { self.clone() } else { thinned }
    }
}

/// Lengths, directions and turns of a closed polygon.
struct Shape<'a> {
    tolerances: &'a [f64],
    lengths: Vec<f64>,
    directions: Vec<DVec2>,
    /// The signed turn at each vertex, in radians.
    turns: Vec<f64>,
}

impl<'a> Shape<'a> {
    fn new(polygon: &'a Polygon) -> Self {
        let n = polygon.points.len();
        let edges: Vec<DVec2> = (0..n).map(|i| polygon.points[(i + 1) % n] - polygon.points[i]).collect();
        Self {
            tolerances: &polygon.tolerances,
            lengths: edges.iter().map(|e| e.length()).collect(),
            directions: edges.iter().map(|e| e.normalize()).collect(),
            turns: (0..n).map(|i| edges[(i + n - 1) % n].angle_to(edges[i])).collect(),
        }
    }

    fn before(&self, i: usize) -> usize {
        (i + self.turns.len() - 1) % self.turns.len()
    }

    fn after(&self, i: usize) -> usize {
        (i + 1) % self.turns.len()
    }

    fn corners(&self) -> Vec<bool> {
        let n = self.turns.len();
        // An arc that turns by t over a chord of length l rises l t / 8 above it.
        let certain: Vec<bool> = (0..n)
            .map(|i| {
                let turn = self.turns[i].abs();
                let shorter = self.lengths[self.before(i)].min(self.lengths[i]);
                let tolerance = self.tolerances[self.before(i)].max(self.tolerances[i]);
                turn > CERTAIN_TURN || shorter * turn / 8.0 > tolerance
            })
            .collect();
        let explained = |i: usize, neighbour: usize, shared: usize, beyond: usize| {
            if certain[neighbour] || self.turns[neighbour] * self.turns[i] < 0.0 {
                return 0.0;
            }
            let curvature = self.turns[neighbour].abs() / self.lengths[shared].min(self.lengths[beyond]);
            curvature * self.lengths[shared] / 2.0
        };
        let unexplained = |i: usize| {
            let (before, after) = (self.before(i), self.after(i));
            let sum = explained(i, before, before, self.before(before)) + explained(i, after, i, after);
            self.turns[i].abs() > UNEXPLAINED.0 * sum + UNEXPLAINED.1
        };
        (0..n).map(|i| certain[i] || unexplained(i)).collect()
    }

    /// Which edges are lines: those that a curve with the turns at their ends would have left, and those
    /// between two corners.
    fn lines(&self, corners: &[bool]) -> Vec<bool> {
        let smooth_turn = |i: usize| if corners[i] { 0.0 } else { self.turns[i].abs() };
        let is_line = |i: usize| {
            let turn = smooth_turn(i).max(smooth_turn(self.after(i)));
            self.lengths[i] * turn / 8.0 > 2.0 * self.tolerances[i] || (corners[i] && corners[self.after(i)])
        };
        (0..corners.len()).map(is_line).collect()
    }

    /// The unit tangent at a smooth vertex: that of the circle through it and its neighbours.
    fn tangent(&self, i: usize) -> DVec2 {
        let before = self.before(i);
        tangent_between(self.directions[before], self.lengths[before], self.directions[i], self.lengths[i])
    }

    /// The unit tangent on leaving corner `i`, mirrored from the next vertex.
    fn leaving(&self, i: usize) -> DVec2 {
        mirrored(self.tangent(self.after(i)), self.directions[i])
    }

    /// The unit tangent on reaching corner `i`, mirrored from the vertex before.
    fn reaching(&self, i: usize) -> DVec2 {
        let before = self.before(i);
        mirrored(self.tangent(before), self.directions[before])
    }
}

/// The unit tangent where an edge of direction `a` and one of direction `b` meet, if both are chords of a
/// circle: the shorter edge says more.
pub(super) fn tangent_between(a: DVec2, a_length: f64, b: DVec2, b_length: f64) -> DVec2 {
    (a * b_length + b * a_length).try_normalize().unwrap_or(a)
}

/// The other end's tangent of an arc over a chord of direction `chord`.
fn mirrored(tangent: DVec2, chord: DVec2) -> DVec2 {
    2.0 * chord.dot(tangent) * chord - tangent
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHORD: f64 = 0.01;

    fn runs(points: Vec<DVec2>) -> Vec<Run> {
        let tolerances = vec![CHORD; points.len()];
        Polygon { points, tolerances }.runs()
    }

    fn dense(corners: &[(f64, f64)], per_side: usize) -> Vec<DVec2> {
        let n = corners.len();
        let side = |i: usize| {
            let (a, b) = (DVec2::from(corners[i]), DVec2::from(corners[(i + 1) % n]));
            (0..per_side).map(move |k| a.lerp(b, k as f64 / per_side as f64))
        };
        (0..n).flat_map(side).collect()
    }

    /// An arc about `centre`, flattened to half of the tolerance; the last point is left out.
    fn arc(centre: (f64, f64), radius: f64, from: f64, to: f64) -> Vec<DVec2> {
        let step = (8.0 * 0.5 * CHORD / radius).sqrt();
        let n = ((to - from).abs() / step).ceil();
        let point =
            |i: u32| DVec2::from(centre) + radius * DVec2::from_angle(from + (to - from) * f64::from(i) / n);
        (0..n as u32).map(point).collect()
    }

    #[test]
    fn a_dense_square_is_four_lines() {
        let found = runs(dense(&[(0.0, 0.0), (7.0, 1.0), (6.0, 8.0), (-1.0, 7.0)], 25));
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|run| run.straight && run.points.len() == 2));
    }

    #[test]
    fn circles_of_any_size_are_smooth() {
        for radius in [0.02, 0.1, 1.0, 30.0, 300.0] {
            let found = runs(arc((1.0, 2.0), radius, 0.0, std::f64::consts::TAU));
            assert_eq!(found.len(), 1, "radius {radius}");
            assert_eq!(found[0].tangents.0, found[0].tangents.1);
        }
    }

    #[test]
    fn a_rounded_bar_keeps_its_lines_and_has_no_corners() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for radius in [0.1, 1.0] {
            let mut bar = arc((20.0, 0.0), radius, -FRAC_PI_2, FRAC_PI_2);
            bar.push(DVec2::new(20.0, radius));
            bar.extend(arc((0.0, 0.0), radius, FRAC_PI_2, FRAC_PI_2 + PI));
            bar.push(DVec2::new(0.0, -radius));
            let found = runs(bar);
            let straight: Vec<bool> = found.iter().map(|run| run.straight).collect();
            assert_eq!(straight.iter().filter(|&&s| s).count(), 2, "radius {radius}: {straight:?}");
            assert_eq!(found.len(), 4);
            for i in 0..4 {
                assert!(found[i].tangents.1.distance(found[(i + 1) % 4].tangents.0) < 1e-9);
            }
        }
    }

    #[test]
    fn a_lens_has_two_corners() {
        // Two arcs of radius 5 that meet at 30 degrees.
        let half = 15f64.to_radians();
        let rise = 5.0 * half.cos();
        let down = std::f64::consts::FRAC_PI_2;
        let mut lens = arc((0.0, rise), 5.0, -down - half, -down + half);
        lens.extend(arc((0.0, -rise), 5.0, down - half, down + half));
        let found = runs(lens);
        assert_eq!(found.len(), 2);
        // The tangents at the tips are those of the arcs.
        assert!((found[0].tangents.0.to_angle() + half).abs() < 0.01, "{}", found[0].tangents.0);
    }
}
