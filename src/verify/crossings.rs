//! Facets that meet where they should not.
//!
//! Two facets of a sound surface share an edge, a corner, or nothing. Whether they share more is decided by
//! exact predicates: an edge of one facet against the other facet, both closed sets, leaving out the corners
//! that both have. Pairs are found by their bounding boxes; most of them lie on two sides of a plane or an edge,
//! which is tried first. Excluded: facets without area, which are a fault
//! of their own, and pairs with the same three corners, which are duplicates.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

type Box3 = GeomWithData<Rectangle<[f64; 3]>, usize>;

/// The facets that cross or touch another one, each once and with a place near that; facets are numbers of
/// points of `at`.
pub(super) fn crossings(at: &[DVec3], facets: &[[usize; 3]]) -> Vec<(usize, DVec3)> {
    let boxed = |(number, facet): (usize, &[usize; 3])| {
        let [a, b, c] = facet.map(|v| at[v]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let is_flat = (b - a).cross(c - a) == DVec3::ZERO;
        let bounds = Rectangle::from_corners(low.to_array(), high.to_array());
        (!is_flat).then_some(Box3::new(bounds, number))
    };
    let boxes: Vec<Box3> = facets.iter().enumerate().filter_map(boxed).collect();
    let tree = RTree::bulk_load(boxes.clone());
    let mut found = Vec::new();
    for one in &boxes {
        let (low, high) = (one.geom().lower(), one.geom().upper());
        let other = tree
            .locate_in_envelope_intersecting(AABB::from_corners(low, high))
            .filter(|other| other.data > one.data && meet(at, facets[one.data], facets[other.data]))
            .min_by_key(|other| other.data);
        if let Some(other) = other {
            // Somewhere in what the two boxes have in common.
            let low = DVec3::from_array(low).max(DVec3::from_array(other.geom().lower()));
            let high = DVec3::from_array(high).min(DVec3::from_array(other.geom().upper()));
            found.push((one.data, (low + high) * 0.5));
        }
    }
    found
}

/// Whether two facets have more in common than corners and an edge that both have.
fn meet(at: &[DVec3], one: [usize; 3], other: [usize; 3]) -> bool {
    let shared = one.iter().filter(|v| other.contains(v)).count();
    let (s, t) = (one.map(|v| at[v]), other.map(|v| at[v]));
    if is_beside(at, one, other) || is_beside(at, other, one) {
        return false;
    }
    match shared {
        0 => (0..3).any(|i| pierces(s[i], s[(i + 1) % 3], t) || pierces(t[i], t[(i + 1) % 3], s)),
        // What they share beyond the common corner ends on an edge that does not have it.
        1 => {
            let [a, b] = opposite(one, |v| other.contains(&v)).map(|v| at[v]);
            let [c, d] = opposite(other, |v| one.contains(&v)).map(|v| at[v]);
            pierces(a, b, t) || pierces(c, d, s)
        }
        2 => folded(at, one, other),
        _ => false,
    }
}

/// Whether the corners that only `other` has lie all on one side of the plane of `facet`, or, where both are level and
/// equally high, all beyond an edge of it. Then the two have no more in common than their corners do. This settles
/// nearly all pairs.
fn is_beside(at: &[DVec3], facet: [usize; 3], other: [usize; 3]) -> bool {
    let t = facet.map(|v| at[v]);
    let mut own = other.into_iter().filter(|v| !facet.contains(v)).map(|v| at[v]);
    if facet.iter().chain(&other).any(|&v| at[v].z != t[0].z) {
        let Some(first) = own.next().map(|p| side(t, p)) else { return false };
        return first != 0.0 && own.all(|p| side(t, p) * first.signum() > 0.0);
    }
    (0..3).any(|i| {
        let [a, b, c] = [0, 1, 2].map(|k| t[(i + k) % 3].truncate());
        // From a corner inside, the other one would reach across.
        let inside = turn(a, b, c).signum();
        !other.contains(&facet[(i + 2) % 3]) && own.clone().all(|p| turn(a, b, p.truncate()) * inside < 0.0)
    })
}

/// The two corners besides the one that `is_shared`.
fn opposite(facet: [usize; 3], is_shared: impl Fn(usize) -> bool) -> [usize; 2] {
    let i = facet.iter().position(|&v| is_shared(v)).expect("called with a shared corner");
    [facet[(i + 1) % 3], facet[(i + 2) % 3]]
}

/// Whether two facets with a common edge lie in one plane and on the same side of the edge.
fn folded(at: &[DVec3], one: [usize; 3], other: [usize; 3]) -> bool {
    let apex = |facet: [usize; 3], beside: [usize; 3]| {
        facet.into_iter().find(|v| !beside.contains(v)).map(|v| at[v]).expect("two corners are shared")
    };
    let (p, q) = (apex(one, other), apex(other, one));
    let triangle = one.map(|v| at[v]);
    if side(triangle, q) != 0.0 {
        return false;
    }
    let axis = flat_axis(triangle);
    let mut ends = one.into_iter().filter(|v| other.contains(v)).map(|v| flat(at[v], axis));
    let (a, b) = (ends.next().expect("two are shared"), ends.next().expect("two are shared"));
    turn(a, b, flat(p, axis)) * turn(a, b, flat(q, axis)) > 0.0
}

/// Whether the closed segment from `p` to `q` meets the closed triangle `t`. Exact.
fn pierces(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let (above, below) = (side(t, p), side(t, q));
    if (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0) {
        return false;
    }
    if above == 0.0 && below == 0.0 {
        let axis = flat_axis(t);
        return meets_flat(flat(p, axis), flat(q, axis), t.map(|v| flat(v, axis)));
    }
    // The line goes round all three sides the same way.
    let [a, b, c] = t;
    let turns = [side([p, q, a], b), side([p, q, b], c), side([p, q, c], a)];
    turns.iter().all(|&x| x >= 0.0) || turns.iter().all(|&x| x <= 0.0)
}

/// Whether a closed segment meets a closed triangle in the plane. Exact.
fn meets_flat(p: DVec2, q: DVec2, t: [DVec2; 3]) -> bool {
    let is_inside = |v: DVec2| {
        let turns = [turn(t[0], t[1], v), turn(t[1], t[2], v), turn(t[2], t[0], v)];
        turns.iter().all(|&x| x >= 0.0) || turns.iter().all(|&x| x <= 0.0)
    };
    is_inside(p) || is_inside(q) || (0..3).any(|i| cross_flat(p, q, t[i], t[(i + 1) % 3]))
}

/// Whether two closed segments of the plane meet. Exact.
fn cross_flat(p: DVec2, q: DVec2, a: DVec2, b: DVec2) -> bool {
    let (pa, pb) = (turn(p, q, a), turn(p, q, b));
    let (ap, aq) = (turn(a, b, p), turn(a, b, q));
    if pa == 0.0 && pb == 0.0 {
        // On one line: their boxes tell.
        return p.min(q).cmple(a.max(b)).all() && a.min(b).cmple(p.max(q)).all();
    }
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    !apart(pa, pb) && !apart(ap, aq)
}

/// The side of the plane of `t` on which `p` lies; only the sign counts, and it is exact.
fn side(t: [DVec3; 3], p: DVec3) -> f64 {
    if t.iter().all(|v| v.z == t[0].z) {
        // Caps are level and walls upright: the predicate would go to its last resort for each point in their plane.
        let [a, b, c] = t.map(DVec3::truncate);
        return sign(turn(a, b, c)) * (t[0].z - p.z);
    }
    for i in 0..3 {
        let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
        if a.truncate() == b.truncate() {
            return turn(a.truncate(), c.truncate(), p.truncate()) * sign(a.z - b.z);
        }
    }
    let coord = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    orient3d(coord(t[0]), coord(t[1]), coord(t[2]), coord(p))
}

/// −1, 0 or 1; a corner given twice has no plane, and no side of it.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |v: DVec2| Coord { x: v.x, y: v.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// The axis along which `t` is seen widest.
fn flat_axis(t: [DVec3; 3]) -> usize {
    let normal = (t[1] - t[0]).cross(t[2] - t[0]).abs().to_array();
    (0..3).max_by(|&i, &j| normal[i].total_cmp(&normal[j])).expect("there are three axes")
}

/// `p` seen along an axis.
fn flat(p: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Facets of three points each, with equal points made one.
    fn found(points: &[[f64; 3]]) -> Vec<usize> {
        let mut at: Vec<DVec3> = Vec::new();
        let numbers: Vec<usize> = points
            .iter()
            .map(|&p| {
                let p = DVec3::from_array(p);
                at.iter().position(|&q| q == p).unwrap_or_else(|| {
                    at.push(p);
                    at.len() - 1
                })
            })
            .collect();
        let facets: Vec<[usize; 3]> = numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        crossings(&at, &facets).into_iter().map(|(facet, _)| facet).collect()
    }

    const BASE: [[f64; 3]; 3] = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]];

    fn with(other: [[f64; 3]; 3]) -> bool {
        let both = [BASE, other].concat();
        let turned = [other, BASE].concat();
        assert_eq!(found(&both), found(&turned));
        !found(&both).is_empty()
    }

    #[test]
    fn facets_apart_and_neighbours_are_sound() {
        assert!(!with([[0., 0., 1.], [4., 0., 1.], [0., 4., 1.]]), "above");
        assert!(!with([[4., 4., 0.], [4., 0., 0.], [0., 4., 0.]]), "beside, in one plane");
        assert!(!with([[0., 0., 0.], [4., 0., 0.], [0., 0., 3.]]), "at an edge, upright");
        assert!(!with([[0., 0., 0.], [-4., 0., 0.], [0., -4., 0.]]), "at a corner, in one plane");
        assert!(!with([[0., 0., 0.], [1., 1., 2.], [1., 2., 2.]]), "at a corner, above");
        assert!(!with([[3., 3., 0.], [9., 3., 0.], [3., 9., 0.]]), "beside with a gap");
    }

    #[test]
    fn what_crosses_or_touches_is_found() {
        assert!(with([[1., 1., -1.], [1., 1., 1.], [9., 9., 1.]]), "through the middle");
        assert!(with([[1., 1., 0.], [1., 1., 2.], [2., 1., 2.]]), "a corner rests on it");
        assert!(with([[1., 0., 0.], [3., 0., 0.], [2., 0., 2.]]), "an edge rests on an edge");
        assert!(with([[1., 1., 0.], [2., 1., 0.], [1., 2., 0.]]), "within, in one plane");
        assert!(with([[0., 0., 0.], [4., 0., 0.], [1., 1., 0.]]), "folded onto it at an edge");
        assert!(with([[0., 0., 0.], [3., 3., 0.], [3., 2., 0.]]), "over it from a corner, in one plane");
        assert!(with([[0., 0., 0.], [2., 2., 0.], [2., 2., 3.]]), "an edge from a corner lies in it");
        assert!(with([[0., 0., 0.], [1., 1., 1.], [3., 1., -1.]]), "through it from a corner");
        assert!(with([[0., 0., 0.], [5., 3., 0.], [3., 5., 0.]]), "from a corner across it, in one plane");
        assert!(with([[-1., -1., 0.], [9., -1., 0.], [-1., 9., 0.]]), "around it, in one plane");
    }

    proptest! {
        /// Against a search in small whole numbers, where many things line up.
        #[test]
        fn pierces_agrees_with_exact_arithmetic(v in prop::array::uniform5(prop::array::uniform3(-3i64..4))) {
            let [p, q, a, b, c] = v;
            let minus = |u: [i64; 3], w: [i64; 3]| [u[0] - w[0], u[1] - w[1], u[2] - w[2]];
            let cross = |u: [i64; 3], w: [i64; 3]| {
                [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]]
            };
            let dot = |u: [i64; 3], w: [i64; 3]| u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
            let n = cross(minus(b, a), minus(c, a));
            let (hp, hq) = (dot(n, minus(p, a)), dot(n, minus(q, a)));
            prop_assume!(n != [0; 3] && hp != hq);
            // The point of the line in the plane, times hp − hq.
            let scaled: [i64; 3] = std::array::from_fn(|i| q[i] * hp - p[i] * hq);
            let w = hp - hq;
            let within = [(a, b), (b, c), (c, a)].into_iter().all(|(u, v)| {
                let from = std::array::from_fn(|i| scaled[i] - w * u[i]);
                dot(n, cross(minus(v, u), from)) * w.signum() >= 0
            });
            let expected = within && hp * hq <= 0;
            let point = |v: [i64; 3]| DVec3::from_array(v.map(|x| x as f64));
            prop_assert_eq!(pierces(point(p), point(q), [a, b, c].map(point)), expected);
        }
    }
}
