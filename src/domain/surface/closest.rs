//! The nearest place of a model: of one triangle, and of all, for many points at once.
//!
//! The points are put in a tree rather than the facets: there are few of them, so a million facets need no more
//! than a look each. Excluded: a tree of the whole model, which takes longer to make than all that is asked of it.

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::mesh::Mesh;

/// A place on a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) facet: usize,
    /// How much each corner counts; the sum is 1.
    pub(super) weights: [f64; 3],
    pub(super) point: DVec3,
    /// How far it is from what it is nearest to.
    pub(super) distance: f64,
}

/// The place of a triangle that is nearest to a point, with its barycentric coordinates.
pub(super) fn closest(p: DVec3, corners: [DVec3; 3]) -> (DVec3, [f64; 3]) {
    let [a, b, c] = corners;
    let (u, v, w) = (b - a, c - a, p - a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    if square > 0.0 {
        let (wb, wc) = (w.cross(v).dot(normal) / square, u.cross(w).dot(normal) / square);
        if wb >= 0.0 && wc >= 0.0 && wb + wc <= 1.0 {
            return (a + wb * u + wc * v, [1.0 - wb - wc, wb, wc]);
        }
    }
    // Not above the triangle: the nearest is on a side.
    let on_side = |i: usize| {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let along = to - from;
        let length = along.length_squared();
        let part = if length > 0.0 { ((p - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        let mut weights = [0.0; 3];
        (weights[i], weights[(i + 1) % 3]) = (1.0 - part, part);
        (from + along * part, weights)
    };
    let nearer = |a: (DVec3, [f64; 3]), b: (DVec3, [f64; 3])| {
        if b.0.distance_squared(p) < a.0.distance_squared(p) { b } else { a }
    };
    nearer(nearer(on_side(0), on_side(1)), on_side(2))
}

/// The points that are within `reach` of the box of a facet.
pub(super) struct Near {
    tree: RTree<GeomWithData<[f64; 3], usize>>,
    reach: f64,
}

impl Near {
    pub(super) fn new(points: impl Iterator<Item = DVec3>, reach: f64) -> Self {
        let entries = points.enumerate().map(|(i, p)| GeomWithData::new(p.to_array(), i)).collect();
        Self { tree: RTree::bulk_load(entries), reach }
    }

    /// The numbers of the points that may be near a triangle, in no order.
    pub(super) fn of(&self, [a, b, c]: [DVec3; 3]) -> impl Iterator<Item = usize> + '_ {
        let reach = DVec3::splat(self.reach);
        let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
        let envelope = AABB::from_corners(low.to_array(), high.to_array());
        self.tree.locate_in_envelope(envelope).map(|entry| entry.data)
    }
}

impl Mesh {
    /// The nearest place to each point, of those that are within `reach` of it; the first facet if several are as near.
    pub(super) fn nearest(&self, points: &[DVec3], reach: f64) -> Vec<Option<Place>> {
        let near = Near::new(points.iter().copied(), reach);
        let mut best: Vec<Option<Place>> = vec![None; points.len()];
        for facet in 0..self.triangles().len() {
            for i in near.of(self.corners(facet)) {
                let place = self.place_near(facet, points[i]);
                let is_nearer = best[i].is_none_or(|best| place.distance < best.distance);
                if is_nearer && place.distance <= reach {
                    best[i] = Some(place);
                }
            }
        }
        best
    }

    /// The nearest place to a point, however far.
    pub(super) fn nearest_anywhere(&self, point: DVec3) -> Option<Place> {
        let places = (0..self.triangles().len()).map(|facet| self.place_near(facet, point));
        places.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn place_near(&self, facet: usize, p: DVec3) -> Place {
        let (point, weights) = closest(p, self.corners(facet));
        Place { facet, weights, point, distance: point.distance(p) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::blob;
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-5.0..5.0f64).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn no_place_of_a_triangle_is_nearer(p in place(), a in place(), b in place(), c in place()) {
            let (found, weights) = closest(p, [a, b, c]);
            prop_assert!(found.distance(a * weights[0] + b * weights[1] + c * weights[2]) < 1e-9);
            prop_assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
            for (i, j) in (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j))) {
                let other = a.lerp(b, f64::from(i) / 20.0) + (c - a) * (f64::from(j) / 20.0);
                prop_assert!(found.distance(p) <= other.distance(p) + 1e-9);
            }
        }

        #[test]
        fn all_are_looked_for_at_once(points in prop::collection::vec(place(), 1..9)) {
            let mesh = blob(3, [0.1, 0.0, 0.1]);
            let points: Vec<DVec3> = points.into_iter().map(|p| p * 8.0).collect();
            for (found, &p) in mesh.nearest(&points, 15.0).iter().zip(&points) {
                let wanted = mesh.nearest_anywhere(p).filter(|place| place.distance <= 15.0);
                prop_assert_eq!(*found, wanted);
            }
        }
    }
}
