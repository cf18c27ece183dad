//! Which component, and which face between the ink, a place is in.
//!
//! The way from a place to the nearest edge of the region crosses no other; so what lies on that edge's one side or the other is where
//! the place is. No other geometry decides what is one component.

use glam::DVec2;

use crate::planar::{EdgeIndex, IndexedEdge, Region};

/// The components of a region and the faces between them, by place.
pub(super) struct Places {
    index: EdgeIndex,
    /// For each contour, the part that it bounds.
    parts: Vec<usize>,
    /// For each contour, the face on its other side: 0 is the outside, and hole number i is face i + 1.
    faces: Vec<usize>,
}

impl Places {
    pub fn new(region: &Region) -> Self {
        let mut places = Self { index: EdgeIndex::new(region), parts: Vec::new(), faces: Vec::new() };
        // Holes by their number, with their boxes, as most do not contain what is asked for.
        let holes: Vec<_> =
            region.parts().iter().flat_map(|part| part.holes()).map(|hole| (hole, hole.bounds())).collect();
        let mut next_face = 0;
        for (number, part) in region.parts().iter().enumerate() {
            let p = part.exterior().points()[0];
            let around = holes.iter().enumerate().filter(|(_, (hole, (low, high)))| {
                low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && hole.contains(p)
            });
            let face = around
                .min_by_key(|(_, (hole, _))| hole.doubled_area().unsigned_abs())
                .map_or(0, |(i, _)| i + 1);
            places.parts.push(number);
            places.faces.push(face);
            for _ in part.holes() {
                next_face += 1;
                places.parts.push(number);
                places.faces.push(next_face);
            }
        }
        places
    }

    /// The number of the part that covers `p`, or is nearest to it.
    pub fn part(&self, p: DVec2) -> Option<usize> {
        self.index.nearest(p).map(|edge| self.parts[edge.contour])
    }

    /// The face that `p` is in; `None` in ink.
    pub fn face(&self, p: DVec2) -> Option<usize> {
        let edge = self.index.nearest(p)?;
        (!is_ink(edge, p)).then(|| self.faces[edge.contour])
    }
}

/// Whether the ink is on the side of the edge on which `p` is.
fn is_ink(edge: &IndexedEdge, p: DVec2) -> bool {
    (edge.to - edge.from).perp_dot(p - edge.from) >= 0.0
}
