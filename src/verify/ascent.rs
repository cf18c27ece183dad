//! Climbing to a peak of the distance to the boundary.
//!
//! The distance to one edge is a convex function, so its tangent plane lies below it: a step that gains under
//! the linearised distances gains at least as much in truth. Each step goes in the direction that raises all
//! of the nearest edges' distances at once, the steepest such one, as far as the least distance rises. What
//! counts as nearest is generous at first, which smooths the ridges, and strict in the end.

use glam::DVec2;

use crate::planar::Region;

/// A place and its distance to the boundary, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) radius: f64,
    pub(super) at: DVec2,
}

/// An edge of the boundary, in millimetres.
pub(super) type Edge = (DVec2, DVec2);

/// Steps of a climb, at most.
const ROUNDS: usize = 48;
/// Edges not farther than the nearest by more than this part of the radius are raised together, at first.
/// More, and edges that do not matter bar the way; less, and a climb zigzags along ridges.
const GENEROUS: f64 = 0.1;
/// The strictest such part, and the least gain of a step; a climb ends there.
const STRICT: f64 = 1e-7;

/// Legs of a climb to a peak, each at most as long as the radius there.
const CLIMBS: usize = 32;

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

/// The peak above `start`, or as near to it as one gets in the circle of `reach` around `centre`, of the
/// distance to `edges`. The climb crosses none of them.
pub(super) fn ascend(start: DVec2, edges: &[Edge], (centre, reach): (DVec2, f64)) -> Spot {
    let mut best = spot(start, edges);
    let mut generosity = GENEROUS;
    let mut contacts = Vec::with_capacity(edges.len());
    for _ in 0..ROUNDS {
        contacts.clear();
        contacts.extend(edges.iter().map(|&edge| Contact::new(best.at, edge)));
        if best.radius <= 0.0 || generosity < STRICT {
            break;
        }
        let limit = best.radius * (1.0 + generosity);
        let next = steepest(&contacts, limit).map(|u| {
            let along = rise(&contacts, u, way_out(best.at - centre, u, reach));
            spot(best.at + u * along, edges)
        });
        match next {
            Some(next) if next.radius > best.radius * (1.0 + STRICT) => best = next,
            _ => generosity *= 0.04,
        }
    }
    best
}

/// All edges of a region, for the few peaks that decide something.
pub(super) struct Climber {
    edges: Vec<Edge>,
}

impl Climber {
    pub(super) fn new(region: &Region) -> Self {
        let grid = region.grid();
        let edges = region.contours().flat_map(|c| c.edges().map(|(a, b)| (grid.to_mm(a), grid.to_mm(b))));
        Self { edges: edges.collect() }
    }

    /// `at` with its true distance to the boundary.
    pub(super) fn look(&self, at: DVec2) -> Spot {
        spot(at, &self.edges)
    }

    /// The peak above `start`, with its true distance to the boundary.
    pub(super) fn climb(&self, start: Spot) -> Spot {
        let mut best = self.look(start.at);
        // A climb sees the edges that can stop it, and no farther; then it looks around again.
        for _ in 0..CLIMBS {
            let reach = best.radius;
            let in_sight = |&edge: &Edge| nearest(edge, best.at).distance(best.at) <= 3.0 * reach;
            let near: Vec<Edge> = self.edges.iter().copied().filter(in_sight).collect();
            let next = ascend(best.at, &near, (best.at, reach));
            let arrived = next.at.distance(best.at) < 0.5 * reach;
            best = next;
            if arrived {
                break;
            }
        }
        best
    }
}

/// The linearised distance to one edge.
#[derive(Clone, Copy)]
struct Contact {
    distance: f64,
    normal: DVec2,
}

impl Contact {
    fn new(at: DVec2, edge: Edge) -> Self {
        let away = at - nearest(edge, at);
        let distance = away.length();
        Self { distance, normal: away / distance }
    }
}

/// The direction in which all contacts nearer than `limit` move away, the slowest as fast as possible: the
/// middle of the arc that their normals span, unless they come from all around.
fn steepest(contacts: &[Contact], limit: f64) -> Option<DVec2> {
    let nearest = contacts.iter().min_by(|a, b| a.distance.total_cmp(&b.distance))?.normal;
    let (mut right, mut left) = ((0.0, nearest), (0.0, nearest));
    for contact in contacts.iter().filter(|c| c.distance <= limit) {
        let turn = turn(nearest, contact.normal);
        if turn < right.0 {
            right = (turn, contact.normal);
        }
        if turn > left.0 {
            left = (turn, contact.normal);
        }
    }
    // Measured from one of them, normals within half a turn span an arc of less than half a turn.
    let spans_less_than_half = right.1.perp_dot(left.1) > 0.0 || left.0 - right.0 < 1.0;
    let u = (right.1 + left.1).try_normalize()?;
    (spans_less_than_half && u.dot(left.1) > STRICT).then_some(u)
}

/// How far one turns counter-clockwise from `a` to `b`: increasing with the angle, from −2 to 2 for half a turn.
fn turn(a: DVec2, b: DVec2) -> f64 {
    let (along, across) = (a.dot(b), a.perp_dot(b));
    let quarter = across / (along.abs() + across.abs());
    if along >= 0.0 { quarter } else { 2f64.copysign(across) - quarter }
}

/// How far it is from `p` along the unit vector `u` out of the circle of `radius` around the origin.
fn way_out(p: DVec2, u: DVec2, radius: f64) -> f64 {
    let inward = -p.dot(u);
    let root = (inward * inward + radius * radius - p.length_squared()).max(0.0).sqrt();
    (inward + root).max(0.0)
}

/// How far along `u` the least of the linearised distances rises, up to `reach`.
fn rise(contacts: &[Contact], u: DVec2, reach: f64) -> f64 {
    let lines = contacts.iter().map(|c| (c.distance, c.normal.dot(u)));
    let mut along = 0.0;
    let lowest = lines.clone().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let Some((mut height, mut slope)) = lowest else { return 0.0 };
    // The least of lines is concave: follow it over its corners as long as it rises.
    while slope > 0.0 && along < reach {
        let corner = |&(h, s): &(f64, f64)| ((h - height) / (slope - s)).max(along);
        let lower = lines.clone().filter(|l| l.1 < slope);
        let Some(next) = lower.min_by(|a, b| corner(a).total_cmp(&corner(b)).then(a.1.total_cmp(&b.1)))
        else {
            return reach;
        };
        along = corner(&next);
        (height, slope) = next;
    }
    along.min(reach)
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
            let peak = ascend(start.into(), &triangle, (DVec2::ZERO, 10.0));
            assert!(
                (peak.radius - 1.0).abs() < 1e-6 && peak.at.distance(DVec2::ONE) < 1e-5,
                "{start:?} {peak:?}"
            );
        }
    }

    #[test]
    fn follows_the_ridge_of_a_thin_wedge() {
        let wedge = edges(&[(0.0, 0.0), (100.0, -2.0), (100.0, 2.0)]);
        let peak = ascend((1.0, 0.0).into(), &wedge, (DVec2::ZERO, 200.0));
        let radius = 400.0 / (4.0 + 2.0 * 100f64.hypot(2.0));
        assert!((peak.radius - radius).abs() < 1e-6, "{peak:?} {radius}");
    }

    #[test]
    fn corners_bend_the_ridge() {
        // Between two points and a line, the circle through the points that touches the line.
        let parts = [((-1.0, 1.0).into(), (-1.0, 9.0).into()), ((1.0, 1.0).into(), (1.0, 9.0).into())];
        let line = (DVec2::new(-9.0, 0.0), DVec2::new(9.0, 0.0));
        let peak = ascend((0.2, 0.6).into(), &[parts[0], parts[1], line], (DVec2::ZERO, 5.0));
        assert!((peak.radius - 1.0).abs() < 1e-4, "{peak:?}");
    }
}
