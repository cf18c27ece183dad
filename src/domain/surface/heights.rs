//! How far a model is from places near it, along given directions.
//!
//! Whether a line passes a triangle is decided by exact signs, one for each side, and a line through a side counts
//! for both of its triangles: no line slips through an edge or a vertex. Excluded: facets far from the points that
//! were named.

use glam::DVec3;
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};

use super::closest::Near;
use super::exact::side_of;
use super::mesh::Mesh;

/// By how much the boxes of facets are widened, in millimetres: more than what rounding takes from them.
const SLACK_MM: f64 = 1e-9;

/// The facets of a model near a curve, in a tree.
#[derive(Debug)]
pub struct MeshHeights {
    tree: RTree<Facet>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Facet {
    corners: [DVec3; 3],
}

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.corners;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }
}

/// The part of a line within `reach` of its origin, on both sides.
struct Line {
    origin: DVec3,
    inverse: DVec3,
    reach: f64,
}

impl Line {
    fn meets(&self, envelope: &AABB<[f64; 3]>) -> bool {
        let slack = DVec3::splat(SLACK_MM);
        let a = (DVec3::from(envelope.lower()) - slack - self.origin) * self.inverse;
        let b = (DVec3::from(envelope.upper()) + slack - self.origin) * self.inverse;
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter.max(-self.reach) <= leave.min(self.reach)
    }
}

impl SelectionFunction<Facet> for Line {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 3]>) -> bool {
        self.meets(envelope)
    }

    fn should_unpack_leaf(&self, facet: &Facet) -> bool {
        self.meets(&facet.envelope())
    }
}

impl MeshHeights {
    /// The facets of `mesh` that may be within `reach_mm` of any of the places `near`.
    pub fn new(mesh: &Mesh, near: impl IntoIterator<Item = DVec3>, reach_mm: f64) -> Self {
        let near = Near::new(near.into_iter(), reach_mm);
        let facets = (0..mesh.triangles().len()).map(|facet| mesh.corners(facet));
        let facets = facets.filter(|&corners| near.of(corners).next().is_some());
        Self { tree: RTree::bulk_load(facets.map(|corners| Facet { corners }).collect()) }
    }

    /// The mean length of the facets' edges in mm; 0 without facets.
    pub fn edge_mm(&self) -> f64 {
        let around = |facet: &Facet| {
            (0..3).map(|i| facet.corners[i].distance(facet.corners[(i + 1) % 3])).sum::<f64>()
        };
        let lengths: Vec<f64> = self.tree.iter().map(around).collect();
        lengths.iter().sum::<f64>() / (3.0 * lengths.len().max(1) as f64)
    }

    /// How far the model is from `origin` along `direction`, a unit vector: negative if it is behind. Of several
    /// places within `reach_mm` it is the nearest where the outside of the model is ahead; `None` if there is none.
    pub fn height(&self, origin: DVec3, direction: DVec3, reach_mm: f64) -> Option<f64> {
        // A direction of zero along an axis divides to infinity, which is right for what is between planes of that
        // axis.
        let line = Line { origin, inverse: direction.recip(), reach: reach_mm };
        let ahead = origin + direction;
        let mut best: Option<f64> = None;
        for facet in self.tree.locate_with_selection_function(line) {
            let Some(height) = crossing(facet.corners, origin, ahead, direction) else { continue };
            // Of two as far away the one ahead, so that the order in the tree does not matter.
            let is_nearer = best.is_none_or(|best| (height.abs(), -height) < (best.abs(), -best));
            if height.abs() <= reach_mm && is_nearer {
                best = Some(height);
            }
        }
        best
    }
}

/// Where the line from `origin` to `ahead` leaves the model through a triangle.
fn crossing(corners: [DVec3; 3], origin: DVec3, ahead: DVec3, direction: DVec3) -> Option<f64> {
    // The weight of each corner is the volume over the side that faces it, and its sign is exact.
    let mut weights = [0.0; 3];
    for i in 0..3 {
        weights[(i + 2) % 3] = side_of(origin, ahead, corners[i], corners[(i + 1) % 3]);
        if weights[(i + 2) % 3] < 0.0 {
            return None;
        }
    }
    let sum: f64 = weights.iter().sum();
    let height = |i: usize| weights[i] / sum * (corners[i] - origin).dot(direction);
    (sum > 0.0).then(|| height(0) + height(1) + height(2))
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{ball, blob, clean, grid};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_through_edges_and_vertices_meet_the_model() {
        let mesh = clean(ball(5, |p| 20.0 * p));
        let heights = MeshHeights::new(&mesh, [DVec3::ZERO], 30.0);
        let edges = mesh.triangles().iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        for [a, b] in edges.map(|edge| edge.map(|v| mesh.vertices_mm()[v as usize])) {
            for part in [0.0, 0.5, 0.3] {
                let at = a.lerp(b, part);
                let height = heights.height(DVec3::ZERO, at.normalize(), 30.0).expect("it is all around");
                assert!((height - at.length()).abs() < 1e-9, "{at}");
            }
        }
    }

    #[test]
    fn grid_lines_are_no_gaps() {
        // Coordinates are whole numbers, so that lines do pass through vertices exactly.
        let mesh = clean(grid([8, 8], [false; 2], |p| (8.0 * p).extend(0.0)));
        let heights = MeshHeights::new(&mesh, [DVec3::new(4.0, 4.0, 0.0)], 6.0);
        for (i, j) in (0..=16).flat_map(|i| (0..=16).map(move |j| (i, j))) {
            let at = DVec3::new(0.5 * f64::from(i), 0.5 * f64::from(j), -1.5);
            assert_eq!(heights.height(at, DVec3::Z, 2.0), Some(1.5), "{at}");
            assert_eq!(
                heights.height(at, DVec3::NEG_Z, 2.0),
                None,
                "from the other side there is no outside"
            );
            assert_eq!(heights.height(at, DVec3::Z, 1.0), None);
            assert_eq!(heights.height(at + 3.0 * DVec3::Z, DVec3::Z, 2.0), Some(-1.5));
        }
    }

    proptest! {
        #[test]
        fn heights_are_on_the_model(
            amounts in prop::array::uniform3(-0.1..0.1f64),
            towards in prop::array::uniform3(-1.0..1.0f64),
            from in 20.0..45.0f64,
        ) {
            let mesh = blob(7, amounts);
            let Some(direction) = DVec3::from(towards).try_normalize() else { return Ok(()) };
            let heights = MeshHeights::new(&mesh, [DVec3::ZERO], 60.0);
            let origin = direction * from;
            let height = heights.height(origin, direction, 60.0).expect("it is all around");
            let place = mesh.nearest_anywhere(origin + direction * height).expect("it has facets");
            prop_assert!(place.distance < 1e-9);
        }
    }
}
