//! Facets that are too thin to be rounded are taken out of a closed mesh.
//!
//! Rounding moves every corner a little, and a facet that is thinner than that may turn over and cross its neighbours. A thin facet
//! either has a short side, which is collapsed into a point, or a corner near the middle of its opposite side, which is turned
//! so that it ends in that corner. Both leave the mesh closed and its genus as it is, and move the surface by no more than the
//! thickness of what goes. Once no facet is thin, every corner is far enough from all sides around it to be rounded. Excluded:
//! surfaces that come close to each other without being neighbours.

use std::collections::VecDeque;

use glam::DVec3;
use rustc_hash::FxHashSet;

/// Each facet may be looked at so many times on the average before the rest is left as it is.
const PATIENCE: usize = 8;

/// A closed mesh that can be changed in places.
pub(super) struct Mesh {
    pub(super) vertices: Vec<DVec3>,
    /// `None` where a facet was taken out.
    facets: Vec<Option<[u32; 3]>>,
    /// The facets around each vertex, in no order.
    around: Vec<Vec<usize>>,
}

impl Mesh {
    /// A mesh in which each edge has two facets, in opposite directions.
    pub(super) fn new(vertices: Vec<DVec3>, facets: &[[u32; 3]]) -> Self {
        let mut around = vec![Vec::new(); vertices.len()];
        for (i, &v) in facets.as_flattened().iter().enumerate() {
            around[v as usize].push(i / 3);
        }
        Self { vertices, facets: facets.iter().copied().map(Some).collect(), around }
    }

    /// The facets that are there.
    pub(super) fn facets(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.facets.iter().flatten().copied()
    }

    /// Takes out facets that are thinner than `thin_mm`, where that is possible.
    pub(super) fn take_out_slivers(&mut self, thin_mm: f64) {
        let is_thin = |mesh: &Self, i: &usize| mesh.facets[*i].is_some_and(|t| mesh.thickness(t) < thin_mm);
        let mut queue: VecDeque<usize> = (0..self.facets.len()).filter(|i| is_thin(self, i)).collect();
        let mut patience = PATIENCE * self.facets.len();
        while let Some(facet) = queue.pop_front() {
            if !is_thin(self, &facet) {
                continue;
            }
            if patience == 0 {
                return;
            }
            patience -= 1;
            // What could not be taken out before may be now that its neighbours are others.
            if let Some(changed) = self.collapsed(facet, thin_mm).or_else(|| self.turned(facet)) {
                let near = changed.iter().flat_map(|&v| &self.around[v as usize]);
                queue.extend(near.copied().filter(|i| is_thin(self, i)));
            }
        }
    }

    fn points(&self, facet: [u32; 3]) -> [DVec3; 3] {
        facet.map(|v| self.vertices[v as usize])
    }

    /// Along the facet's face, twice as long as its area is large.
    fn normal(&self, facet: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.points(facet);
        (b - a).cross(c - a)
    }

    /// The least height over a side.
    fn thickness(&self, facet: [u32; 3]) -> f64 {
        let [a, b, c] = self.points(facet);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if longest > 0.0 { self.normal(facet).length() / longest } else { 0.0 }
    }

    /// Collapses the shortest side of the facet if it is shorter than `short_mm`. The vertices around which facets changed; `None`
    /// if that would pinch the surface or turn a facet over.
    fn collapsed(&mut self, facet: usize, short_mm: f64) -> Option<Vec<u32>> {
        let corners = self.facets[facet]?;
        let length = |i: usize| {
            let [p, q] = [corners[i], corners[(i + 1) % 3]].map(|v| self.vertices[v as usize]);
            p.distance(q)
        };
        let side = (0..3).min_by(|&i, &j| length(i).total_cmp(&length(j)))?;
        if length(side) >= short_mm {
            return None;
        }
        let [p, q] = [corners[side], corners[(side + 1) % 3]];
        self.merged(p, q, short_mm).or_else(|| self.merged(q, p, short_mm))
    }

    /// Moves the vertex `gone` onto `kept`, its neighbour.
    fn merged(&mut self, gone: u32, kept: u32, thin_mm: f64) -> Option<Vec<u32>> {
        // Two corners of three facets each are those of a tetrahedron, which would be left without volume.
        if [gone, kept].iter().all(|&v| self.around[v as usize].len() == 3) {
            return None;
        }
        // More than two neighbours in common would leave an edge with four facets.
        let near = self.neighbours(gone);
        if self.neighbours(kept).iter().filter(|v| near.contains(v)).count() != 2 {
            return None;
        }
        let (lost, moved): (Vec<usize>, Vec<usize>) = self.around[gone as usize]
            .iter()
            .partition(|&&i| self.facets[i].is_some_and(|t| t.contains(&kept)));
        let renamed = |t: [u32; 3]| t.map(|v| if v == gone { kept } else { v });
        let stays = |&i: &usize| {
            let before = self.facets[i].expect("facets around a vertex are there");
            // What was thin may lie any way.
            self.thickness(before) < thin_mm || self.normal(before).dot(self.normal(renamed(before))) > 0.0
        };
        if !moved.iter().all(stays) {
            return None;
        }
        for &i in &lost {
            let corners = self.facets[i].take().expect("facets around a vertex are there");
            corners.iter().for_each(|&v| self.around[v as usize].retain(|&j| j != i));
        }
        for &i in &moved {
            self.facets[i] = self.facets[i].map(renamed);
        }
        self.around[gone as usize].clear();
        self.around[kept as usize].extend(&moved);
        Some(vec![kept])
    }

    fn neighbours(&self, v: u32) -> FxHashSet<u32> {
        let corners = self.around[v as usize].iter().filter_map(|&i| self.facets[i]).flatten();
        corners.filter(|&w| w != v).collect()
    }

    /// Turns the longest side of the facet so that it joins the two corners opposite of it. The vertices around which facets
    /// changed; `None` if those corners are joined already or the facets would be thinner than before, or look another way.
    fn turned(&mut self, facet: usize) -> Option<Vec<u32>> {
        let corners = self.facets[facet]?;
        let length = |i: usize| {
            let [p, q] = [corners[i], corners[(i + 1) % 3]].map(|v| self.vertices[v as usize]);
            p.distance_squared(q)
        };
        let side = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j)))?;
        let [a, b, c] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
        let is_other = |&&i: &&usize| i != facet && self.facets[i].is_some_and(|t| t.contains(&b));
        let other = *self.around[a as usize].iter().find(is_other)?;
        let across = self.facets[other]?;
        let d = *across.iter().find(|&&v| v != a && v != b)?;
        if c == d || self.neighbours(c).contains(&d) {
            return None;
        }
        let turned = [[a, d, c], [d, b, c]];
        let thickness = |[s, t]: [[u32; 3]; 2]| self.thickness(s).min(self.thickness(t));
        if thickness(turned) <= thickness([corners, across])
            || turned.iter().any(|&t| self.normal(t).dot(self.normal(across)) < 0.0)
        {
            return None;
        }
        (self.facets[facet], self.facets[other]) = (Some(turned[0]), Some(turned[1]));
        self.around[a as usize].retain(|&i| i != other);
        self.around[b as usize].retain(|&i| i != facet);
        self.around[c as usize].push(other);
        self.around[d as usize].push(facet);
        Some(vec![a, b, c, d])
    }
}

#[cfg(test)]
mod tests {
    use super::super::solid::Solid;
    use super::*;

    fn solid(mesh: &Mesh) -> Solid {
        let corner = |v: u32| mesh.vertices[v as usize].as_vec3().to_array();
        Solid::from_facets(mesh.facets().map(|t| t.map(corner))).unwrap()
    }

    /// A tetrahedron with two more corners on one of its edges: near the first end, and in the middle but so little aside that
    /// the facets beside it have hardly any area.
    fn with_slivers() -> Mesh {
        let vertices = vec![
            DVec3::ZERO,
            DVec3::new(10.0, 0.0, 0.0),
            DVec3::new(0.0, 10.0, 0.0),
            DVec3::new(0.0, 0.0, 10.0),
            DVec3::new(1e-5, 0.0, 0.0),
            DVec3::new(5.0, 1e-6, 0.0),
        ];
        // The floor, in which [4, 5, 1] is a line but for a micrometre, and the three walls.
        let facets = [[0, 2, 4], [4, 2, 5], [5, 2, 1], [4, 5, 1], [0, 4, 3], [4, 1, 3], [1, 2, 3], [2, 0, 3]];
        Mesh::new(vertices, &facets)
    }

    #[test]
    fn short_sides_are_collapsed_and_long_ones_turned() {
        let mut mesh = with_slivers();
        let before = solid(&mesh);
        mesh.take_out_slivers(1e-4);
        let after = solid(&mesh);
        assert_eq!((after.shells().len(), after.genus()), (1, 0));
        assert!(mesh.facets().all(|t| mesh.thickness(t) >= 1e-4));
        assert!(after.triangles().len() < before.triangles().len());
        assert!((after.volume_mm3() - before.volume_mm3()).abs() < 1e-2);
    }

    #[test]
    fn what_would_pinch_the_surface_stays() {
        // All of it is thin: nothing can go without the whole.
        let scale = DVec3::new(1.0, 1.0, 1e-6);
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 1e-6 * scale);
        let facets = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mut mesh = Mesh::new(vertices.to_vec(), &facets);
        mesh.take_out_slivers(1e-4);
        assert_eq!(mesh.facets().count(), 4);
    }
}
