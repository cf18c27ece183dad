//! Climbing to a peak of the distance to the boundary.
//!
//! The distance to one edge is a convex function, so its tangent plane lies below it: a step that gains under
//! the linearised distances gains at least as much in truth. From a point the climb goes straight away from
//! the nearest edge until a second one is as near, then along the ridge between the two until a third one is;
//! where three block each other it goes on along one of their other two ridges, or it has arrived.

use glam::DVec2;

/// A place and its distance to the boundary, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) radius: f64,
    pub(super) at: DVec2,
}

/// An edge of the boundary, in millimetres.
pub(super) type Edge = (DVec2, DVec2);

/// Steps of a climb. Straight edges need one or two, corners a few more as they bend the ridges.
const ROUNDS: usize = 24;
/// A climb ends when a step gains less than this part of the radius.
const LEAST_GAIN: f64 = 1e-9;
/// Directions closer than this are one.
const PARALLEL: f64 = 1e-9;

/// The point of `edge` that is nearest to `p`.
pub(super) fn nearest((a, b): Edge, p: DVec2) -> DVec2 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    a + d * t
}

/// `at` with its distance to `edges`.
pub(super) fn spot(at: DVec2, edges: &[Edge]) -> Spot {
    let squares = edges.iter().map(|&e| nearest(e, at).distance_squared(at));
    Spot { radius: squares.fold(f64::INFINITY, f64::min).sqrt(), at }
}

/// The peak above `start`, at most `reach` away from it, of the distance to `edges`.
pub(super) fn ascend(start: DVec2, edges: &[Edge], reach: f64) -> Spot {
    let mut best = spot(start, edges);
    let mut contacts = Vec::with_capacity(edges.len());
    for _ in 0..ROUNDS {
        contacts.clear();
        for &edge in edges {
            let away = best.at - nearest(edge, best.at);
            let distance = away.length();
            if distance > 0.0 {
                contacts.push(Contact { distance, normal: away / distance });
            }
        }
        if contacts.len() < edges.len() {
            break;
        }
        let Some(step) = step(&contacts) else { break };
        let next = spot(best.at + step.clamp_length_max(reach), edges);
        if next.at.distance(start) > reach || next.radius <= best.radius * (1.0 + LEAST_GAIN) {
            break;
        }
        best = next;
    }
    best
}

/// The linearised distance to one edge.
#[derive(Clone, Copy)]
struct Contact {
    distance: f64,
    normal: DVec2,
}

impl Contact {
    fn after(&self, step: DVec2) -> f64 {
        self.distance + self.normal.dot(step)
    }
}

/// A step that raises the least of the distances as far as the first two ridges lead.
fn step(contacts: &[Contact]) -> Option<DVec2> {
    let first = contacts.iter().min_by(|a, b| a.distance.total_cmp(&b.distance))?;
    let (t, second) = first_hit(contacts, DVec2::ZERO, first.normal, first)?;
    let start = first.normal * t;
    let second = &contacts[second];
    let Some((u, along, third)) = ridge(contacts, start, first, second) else { return Some(start) };
    if along > LEAST_GAIN * first.distance {
        return Some(start + u * along);
    }
    let third = &contacts[third];
    let others =
        [(first, third), (second, third)].into_iter().filter_map(|(a, b)| ridge(contacts, start, a, b));
    let (u, along, _) = others.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(start + u * along)
}

/// The direction in which two distances rise alike, how far it goes until another is as low, and which.
fn ridge(contacts: &[Contact], start: DVec2, a: &Contact, b: &Contact) -> Option<(DVec2, f64, usize)> {
    let u = (a.normal + b.normal).try_normalize().filter(|u| u.dot(a.normal) > PARALLEL)?;
    let (along, third) = first_hit(contacts, start, u, a)?;
    Some((u, along, third))
}

/// Where along `u` from `start` the rising distance to `lowest` first meets one that rises more slowly.
fn first_hit(contacts: &[Contact], start: DVec2, u: DVec2, lowest: &Contact) -> Option<(f64, usize)> {
    let rise = lowest.normal.dot(u);
    let level = lowest.after(start);
    let slower = contacts.iter().enumerate().filter(|(_, c)| rise - c.normal.dot(u) > PARALLEL);
    let hits = slower.map(|(i, c)| (((c.after(start) - level) / (rise - c.normal.dot(u))).max(0.0), i));
    hits.min_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(corners: &[(f64, f64)]) -> Vec<Edge> {
        let n = corners.len();
        (0..n).map(|i| (corners[i].into(), corners[(i + 1) % n].into())).collect()
    }

    #[test]
    fn finds_the_incircle_of_a_triangle() {
        // Sides 3, 4 and 5: the radius is 1.
        let triangle = edges(&[(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]);
        for start in [(0.1, 0.1), (3.0, 0.3), (0.2, 2.5), (1.3, 1.3)] {
            let peak = ascend(start.into(), &triangle, 10.0);
            assert!(
                (peak.radius - 1.0).abs() < 1e-6 && peak.at.distance(DVec2::ONE) < 1e-5,
                "{start:?} {peak:?}"
            );
        }
    }

    #[test]
    fn follows_the_ridge_of_a_thin_wedge() {
        let wedge = edges(&[(0.0, 0.0), (100.0, -2.0), (100.0, 2.0)]);
        let peak = ascend((1.0, 0.0).into(), &wedge, 200.0);
        let radius = 400.0 / (4.0 + 2.0 * 100f64.hypot(2.0));
        assert!((peak.radius - radius).abs() < 1e-6, "{peak:?} {radius}");
    }

    #[test]
    fn corners_bend_the_ridge() {
        // Between two points and a line, the circle through the points that touches the line.
        let parts = [((-1.0, 1.0).into(), (-1.0, 9.0).into()), ((1.0, 1.0).into(), (1.0, 9.0).into())];
        let line = (DVec2::new(-9.0, 0.0), DVec2::new(9.0, 0.0));
        let peak = ascend((0.2, 0.6).into(), &[parts[0], parts[1], line], 5.0);
        assert!((peak.radius - 1.0).abs() < 1e-4, "{peak:?}");
    }
}
