//! Facets that meet where they should not.
//!
//! Two facets of a sound surface share an edge, a corner, or nothing. Whether they share more is decided by
//! exact predicates: an edge of one facet against the other facet, both closed sets, leaving out the corners
//! that both have. Caps that are sound as a whole ([`super::plates`]) are left out first. Pairs of what is left are found by
//! their bounding boxes ([`super::boxes`]); most of them lie on two sides of a plane or, seen from above, of an edge,
//! which is tried next. Excluded: facets without area, which are a fault of their own, and pairs with the same three
//! corners, which are duplicates.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::boxes::{Box3, pairs_that_meet};
use super::plates::in_plates;
use super::shells::Side;

/// No facet.
const NONE: usize = usize::MAX;

/// The facets that cross or touch another one, each once and with a place near that; facets are numbers of
/// points of `at`, and `sides` are theirs, by their ends.
pub(super) fn crossings(at: &[DVec3], facets: &[[usize; 3]], sides: &[Side]) -> Vec<(usize, DVec3)> {
    let is_known = in_plates(at, facets, sides);
    let doubtful: Vec<usize> = (0..facets.len()).filter(|&facet| !is_known[facet]).collect();
    crossings_of_pairs(at, facets, &doubtful)
}

/// The same among the facets with these numbers, by looking at pairs.
pub(super) fn crossings_of_pairs(
    at: &[DVec3],
    facets: &[[usize; 3]],
    numbers: &[usize],
) -> Vec<(usize, DVec3)> {
    let is_flat = |&[a, b, c]: &[usize; 3]| (at[b] - at[a]).cross(at[c] - at[a]) == DVec3::ZERO;
    let bounds = |&[a, b, c]: &[usize; 3]| (at[a].min(at[b]).min(at[c]), at[a].max(at[b]).max(at[c]));
    let numbers: Vec<usize> = numbers.iter().copied().filter(|&facet| !is_flat(&facets[facet])).collect();
    let boxes: Vec<Box3> = numbers.iter().map(|&facet| bounds(&facets[facet])).collect();
    let kinds: Vec<Kind> = numbers.iter().map(|&facet| Kind::of(facets[facet].map(|v| at[v]))).collect();
    let face = |i: usize| Face { corners: facets[numbers[i]], kind: kinds[i] };
    // The first facet after each that it meets.
    let mut partners = vec![NONE; numbers.len()];
    pairs_that_meet(&boxes, |i, j| {
        if j < partners[i] && meet(at, face(i), face(j)) {
            partners[i] = j;
        }
    });
    let met = partners.iter().enumerate().filter(|&(_, &j)| j != NONE);
    met.map(|(i, &j)| {
        // Somewhere in what the two boxes have in common.
        let (low, high) = (boxes[i].0.max(boxes[j].0), boxes[i].1.min(boxes[j].1));
        (numbers[i], (low + high) * 0.5)
    })
    .collect()
}

/// What makes it easy to tell the sides of a facet. Caps are level and walls upright, and for those the predicate of
/// space would go to its last resort for each point in their plane.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// All corners are equally high. With that, 1 if they turn counter-clockwise seen from above, and −1 if clockwise.
    Level(f64),
    /// Of its corners from this one on, the second is above or below the first. With that, 1 if it is below, −1 if above.
    Upright(u8, f64),
    /// Neither.
    Leaning,
}

impl Kind {
    fn of(t: [DVec3; 3]) -> Self {
        let [a, b, c] = t.map(DVec3::truncate);
        if t.iter().all(|v| v.z == t[0].z) {
            return Self::Level(sign(turn(a, b, c)));
        }
        match [(a, b), (b, c), (c, a)].iter().position(|(p, q)| p == q) {
            Some(i) => Self::Upright(i as u8, sign(t[i].z - t[(i + 1) % 3].z)),
            None => Self::Leaning,
        }
    }
}

/// A facet by its corners.
#[derive(Clone, Copy)]
struct Face {
    corners: [usize; 3],
    kind: Kind,
}

impl Face {
    fn has(&self, corner: usize) -> bool {
        self.corners.contains(&corner)
    }

    fn at(&self, at: &[DVec3]) -> Triangle {
        Triangle { t: self.corners.map(|v| at[v]), kind: self.kind }
    }
}

/// A facet with area by its points.
#[derive(Clone, Copy)]
struct Triangle {
    t: [DVec3; 3],
    kind: Kind,
}

/// Whether two facets have more in common than corners and an edge that both have.
fn meet(at: &[DVec3], one: Face, other: Face) -> bool {
    if is_beside(at, one, other) || is_beside(at, other, one) {
        return false;
    }
    let (s, t) = (one.at(at), other.at(at));
    match one.corners.iter().filter(|&&v| other.has(v)).count() {
        0 => (0..3).any(|i| s.is_pierced(t.t[i], t.t[(i + 1) % 3]) || t.is_pierced(s.t[i], s.t[(i + 1) % 3])),
        // What they share beyond the common corner ends on an edge that does not have it.
        1 => {
            let [a, b] = opposite(one.corners, |v| other.has(v)).map(|v| at[v]);
            let [c, d] = opposite(other.corners, |v| one.has(v)).map(|v| at[v]);
            t.is_pierced(a, b) || s.is_pierced(c, d)
        }
        2 => folded(at, one, other),
        _ => false,
    }
}

/// Whether the corners that only `other` has lie all on one side of the plane of `facet`; or, where that is level, all
/// beyond an edge of it as seen from above. Then the two have no more in common than their corners do. This settles
/// nearly all pairs.
fn is_beside(at: &[DVec3], facet: Face, other: Face) -> bool {
    let triangle = facet.at(at);
    let own = other.corners.into_iter().filter(|&v| !facet.has(v)).map(|v| at[v]);
    let Some(first) = own.clone().next().map(|p| triangle.side(p)) else { return false };
    if first != 0.0 && own.clone().all(|p| triangle.side(p) * first.signum() > 0.0) {
        return true;
    }
    let Kind::Level(inside) = facet.kind else { return false };
    (0..3).any(|i| {
        let [a, b] = [i, (i + 1) % 3].map(|k| triangle.t[k].truncate());
        // From a corner inside, the other one would reach across.
        !other.has(facet.corners[(i + 2) % 3]) && own.clone().all(|p| turn(a, b, p.truncate()) * inside < 0.0)
    })
}

/// The two corners besides the one that `is_shared`.
fn opposite(facet: [usize; 3], is_shared: impl Fn(usize) -> bool) -> [usize; 2] {
    let i = facet.iter().position(|&v| is_shared(v)).expect("called with a shared corner");
    [facet[(i + 1) % 3], facet[(i + 2) % 3]]
}

/// Whether two facets with a common edge lie in one plane and on the same side of the edge.
fn folded(at: &[DVec3], one: Face, other: Face) -> bool {
    let apex = |facet: Face, beside: Face| {
        facet.corners.into_iter().find(|&v| !beside.has(v)).map(|v| at[v]).expect("two corners are shared")
    };
    let (p, q) = (apex(one, other), apex(other, one));
    let triangle = one.at(at);
    if triangle.side(q) != 0.0 {
        return false;
    }
    let axis = triangle.flat_axis();
    let mut ends = one.corners.into_iter().filter(|&v| other.has(v)).map(|v| flat(at[v], axis));
    let (a, b) = (ends.next().expect("two are shared"), ends.next().expect("two are shared"));
    turn(a, b, flat(p, axis)) * turn(a, b, flat(q, axis)) > 0.0
}

impl Triangle {
    /// Whether the closed segment from `p` to `q` meets the closed triangle. Exact.
    fn is_pierced(&self, p: DVec3, q: DVec3) -> bool {
        let (above, below) = (self.side(p), self.side(q));
        if (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0) {
            return false;
        }
        if above == 0.0 && below == 0.0 {
            let axis = self.flat_axis();
            return meets_flat(flat(p, axis), flat(q, axis), self.t.map(|v| flat(v, axis)));
        }
        // The line goes round all three sides the same way.
        let [a, b, c] = self.t;
        let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| {
            let t = [p, q, u];
            Triangle { t, kind: Kind::of(t) }.side(v)
        });
        turns.iter().all(|&x| x >= 0.0) || turns.iter().all(|&x| x <= 0.0)
    }

    /// The side of its plane on which `p` lies; only the sign counts, and it is exact. A corner given twice has no plane, and
    /// no side of it.
    fn side(&self, p: DVec3) -> f64 {
        match self.kind {
            Kind::Level(turn) => turn * (self.t[0].z - p.z),
            Kind::Upright(i, down) => {
                let [a, c] = [i, (i + 2) % 3].map(|k| self.t[usize::from(k)].truncate());
                turn(a, c, p.truncate()) * down
            }
            Kind::Leaning => {
                let [a, b, c, p] =
                    [self.t[0], self.t[1], self.t[2], p].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
                orient3d(a, b, c, p)
            }
        }
    }

    /// The axis along which it is seen widest.
    fn flat_axis(&self) -> usize {
        let [a, b, c] = self.t;
        let normal = (b - a).cross(c - a).abs().to_array();
        (0..3).max_by(|&i, &j| normal[i].total_cmp(&normal[j])).expect("there are three axes")
    }
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
pub(super) fn cross_flat(p: DVec2, q: DVec2, a: DVec2, b: DVec2) -> bool {
    let (pa, pb) = (turn(p, q, a), turn(p, q, b));
    let (ap, aq) = (turn(a, b, p), turn(a, b, q));
    if pa == 0.0 && pb == 0.0 {
        // On one line: their boxes tell.
        return p.min(q).cmple(a.max(b)).all() && a.min(b).cmple(p.max(q)).all();
    }
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    !apart(pa, pb) && !apart(ap, aq)
}

/// −1, 0 or 1.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// Positive when `a`, `b` and `c` turn counter-clockwise; only the sign counts, and it is exact.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |v: DVec2| Coord { x: v.x, y: v.y };
    orient2d(coord(a), coord(b), coord(c))
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

    use super::super::shells::sides;
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
        crossings(&at, &facets, &sides(&facets)).into_iter().map(|(facet, _)| facet).collect()
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
        fn piercing_agrees_with_exact_arithmetic(v in prop::array::uniform5(prop::array::uniform3(-3i64..4))) {
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
            let t = [a, b, c].map(point);
            prop_assert_eq!(Triangle { t, kind: Kind::of(t) }.is_pierced(point(p), point(q)), expected);
        }
    }
}
