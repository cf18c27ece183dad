//! The boundary as it is seen from inside a triangulation.

use glam::DVec2;
use spade::Triangulation;

use super::ascent::{Edge, nearest};
use super::clearance::Mesh;

/// The most triangles that one look passes through. A circle that holds no vertex is crossed by a few; more
/// come together only where the answer is wide open anyway.
const MOST_FACES: usize = 64;
const NONE: usize = usize::MAX;

/// One side of a triangle.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: usize,
    to: usize,
    /// The triangle on the other side; [`NONE`] when the side is boundary.
    beyond: usize,
}

/// A triangulation of which some edges are boundary, two at each vertex. Triangles count from 0.
pub(super) struct Walls {
    at: Vec<DVec2>,
    /// The neighbours of each vertex along its contour.
    next: Vec<[usize; 2]>,
    faces: Vec<[Side; 3]>,
    /// The triangles passed by the current look.
    passed: Vec<usize>,
}

impl Walls {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let at: Vec<DVec2> = mesh.vertices().map(|v| DVec2::new(v.position().x, v.position().y)).collect();
        let mut next: Vec<[usize; 2]> = (0..at.len()).map(|v| [v, v]).collect();
        for edge in mesh.undirected_edges().filter(|e| e.is_constraint_edge()) {
            let [p, q] = edge.vertices().map(|v| v.index());
            for (v, w) in [(p, q), (q, p)] {
                let slot = usize::from(next[v][0] != v);
                next[v][slot] = w;
            }
        }
        let faces = mesh.inner_faces().map(|face| {
            face.adjacent_edges().map(|edge| {
                let beyond = edge.rev().face().as_inner().filter(|_| !edge.is_constraint_edge());
                let beyond = beyond.map_or(NONE, |face| face.index() - 1);
                Side { from: edge.from().index(), to: edge.to().index(), beyond }
            })
        });
        let faces = faces.collect();
        Self { at, next, faces, passed: Vec::new() }
    }

    /// Where a vertex is.
    pub(super) fn at(&self, vertex: usize) -> DVec2 {
        self.at[vertex]
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, face: usize) -> [usize; 3] {
        self.faces[face].map(|side| side.from)
    }

    /// The two edges that meet in a vertex, leading away from it.
    pub(super) fn around(&self, vertex: usize) -> [Edge; 2] {
        self.next[vertex].map(|w| (self.at[vertex], self.at[w]))
    }

    /// Puts the boundary edges into `seen` that meet the circle and can be reached inside of it from the
    /// triangles `from`, together with those at the corners on the way.
    pub(super) fn in_sight(&mut self, from: &[usize], centre: DVec2, radius: f64, seen: &mut Vec<Edge>) {
        seen.clear();
        self.passed.clear();
        self.passed.extend(from);
        let mut i = 0;
        while i < self.passed.len() {
            for side in self.faces[self.passed[i]] {
                let edge = (self.at[side.from], self.at[side.to]);
                if side.beyond == NONE {
                    seen.push(edge);
                } else if self.passed.len() < MOST_FACES
                    && nearest(edge, centre).distance_squared(centre) < radius * radius
                    && !self.passed.contains(&side.beyond)
                {
                    self.passed.push(side.beyond);
                }
            }
            if i < from.len() {
                for corner in self.corners(self.passed[i]) {
                    seen.extend(self.around(corner));
                }
            }
            i += 1;
        }
    }
}
