//! Curves that lie on a model.

use glam::DVec3;

/// Points nearer to each other than this are one, in millimetres: a curve that passes a vertex crosses several
/// edges there.
const SAME_MM: f64 = 1e-9;

/// A polyline on a model: each of its pieces is in one triangle, as wherever it crosses an edge it has a point.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshCurve {
    /// The points in the order of travel, in millimetres; the first does not come again at the end.
    pub points_mm: Vec<DVec3>,
    /// The outside of the model at each point: a unit vector, between those of the vertices around.
    pub normals: Vec<DVec3>,
    /// Whether the last point is followed by the first.
    pub is_closed: bool,
}

impl MeshCurve {
    /// A curve of places without those that are the one before; `None` if less than a piece is left.
    pub(super) fn cleaned(places: Vec<(DVec3, DVec3)>, is_closed: bool) -> Option<Self> {
        let mut curve = Self { points_mm: Vec::new(), normals: Vec::new(), is_closed };
        for (point, normal) in places {
            if curve.points_mm.last().is_none_or(|last| last.distance(point) > SAME_MM) {
                curve.points_mm.push(point);
                curve.normals.push(normal);
            }
        }
        while is_closed
            && curve.points_mm.len() > 1
            && curve.points_mm[0].distance(curve.points_mm[curve.points_mm.len() - 1]) <= SAME_MM
        {
            curve.points_mm.pop();
            curve.normals.pop();
        }
        let wanted = if is_closed { 3 } else { 2 };
        (curve.points_mm.len() >= wanted).then_some(curve)
    }

    /// The length in mm.
    pub fn length_mm(&self) -> f64 {
        self.pieces().map(|[a, b]| self.points_mm[a].distance(self.points_mm[b])).sum()
    }

    /// The points at the ends of each piece.
    pub(in super::super) fn pieces(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let n = self.points_mm.len();
        (0..n - usize::from(!self.is_closed)).map(move |i| [i, (i + 1) % n])
    }

    /// Panics unless each piece is in one triangle of the model, to a millionth of a millimetre.
    #[cfg(test)]
    pub(super) fn check_on(&self, mesh: &super::Mesh) {
        use super::closest::closest;
        let off = |p: DVec3, facet: usize| closest(p, mesh.corners(facet)).0.distance(p);
        for [a, b] in self.pieces() {
            let [a, b] = [self.points_mm[a], self.points_mm[b]];
            let in_one = (0..mesh.triangles().len()).any(|t| off(a, t) < 1e-6 && off(b, t) < 1e-6);
            assert!(in_one, "the piece from {a} to {b} is in no triangle");
        }
        assert!(self.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-9));
    }
}
