//! A spatial index of a region's edges.

use glam::DVec2;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

use super::region::Region;

/// One edge of a region in millimetres, with the ink on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexedEdge {
    /// The contour, counted in the order of [`Region::contours`].
    pub contour: usize,
    /// The edge within the contour: from vertex `edge` to the next.
    pub edge: usize,
    /// Where it begins.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
}

impl IndexedEdge {
    /// The point of the edge that is nearest to `p`.
    pub fn nearest(&self, p: DVec2) -> DVec2 {
        let d = self.to - self.from;
        let t = ((p - self.from).dot(d) / d.length_squared()).clamp(0.0, 1.0);
        self.from + d * t
    }
}

impl RTreeObject for IndexedEdge {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.from.to_array(), self.to.to_array())
    }
}

impl PointDistance for IndexedEdge {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        let p = DVec2::from_array(*point);
        self.nearest(p).distance_squared(p)
    }
}

/// All edges of a region in an R-tree.
pub struct EdgeIndex {
    tree: RTree<IndexedEdge>,
}

impl EdgeIndex {
    /// The index of all edges of `region`.
    pub fn new(region: &Region) -> Self {
        let grid = region.grid();
        let mut edges = Vec::with_capacity(region.vertices());
        for (contour, c) in region.contours().enumerate() {
            for (edge, (a, b)) in c.edges().enumerate() {
                edges.push(IndexedEdge { contour, edge, from: grid.to_mm(a), to: grid.to_mm(b) });
            }
        }
        Self { tree: RTree::bulk_load(edges) }
    }

    /// The edge nearest to `p`; `None` for an empty region.
    pub fn nearest(&self, p: DVec2) -> Option<&IndexedEdge> {
        self.tree.nearest_neighbor(p.to_array())
    }

    /// The edges within `radius` of `p`, in no particular order.
    pub fn within(&self, p: DVec2, radius: f64) -> impl Iterator<Item = &IndexedEdge> {
        self.tree.locate_within_distance(p.to_array(), radius * radius)
    }

    /// The edges whose bounding boxes meet the box from `low` to `high`.
    pub fn in_box(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = &IndexedEdge> {
        self.tree.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array()))
    }
}
