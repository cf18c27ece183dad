//! The part of a model around a way, made into a disc.
//!
//! All triangles at the nearest vertices of the way, so many that there is room beside it, are a piece of the
//! surface with some borders. The longest border becomes that of the disc; the others, such as the far side of a
//! band round a vase, are closed by fans of triangles around a middle. So a closed curve may go round a vase or a
//! handle, and only a piece that itself has a handle is no disc. Excluded: the plane, in which the disc is laid
//! elsewhere.

use glam::DVec3;

use super::mesh::Mesh;
use super::sides::{NONE, border_loops, from, twins};

/// A disc of triangles: those of the model first, and then those that close its other borders.
#[derive(Debug)]
pub(super) struct Disc {
    pub(super) vertices: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The facet of the model of each of the first triangles, with its corners in the same order.
    pub(super) facets: Vec<u32>,
    /// For each side the one across its edge.
    pub(super) twins: Vec<u32>,
    /// The vertices along its border, with the disc on the left.
    pub(super) border: Vec<u32>,
    /// The vertices in the middle of the fans that close its other borders.
    pub(super) middles: Vec<u32>,
    /// The vertex of the disc that each of the model is, or [`NONE`].
    numbers: Vec<u32>,
}

/// Why triangles are no disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoDisc {
    /// They have no border.
    Closed,
    /// They have a handle.
    Handle,
}

impl Disc {
    /// The vertex of the disc that one of the model is.
    pub(super) fn number(&self, vertex: u32) -> Option<u32> {
        Some(self.numbers[vertex as usize]).filter(|&number| number != NONE)
    }

    /// The disc of all triangles at `inner` vertices, which hang together.
    pub(super) fn around(mesh: &Mesh, inner: &[u32]) -> Result<Self, NoDisc> {
        let facets = facets_around(mesh, inner);
        let mut local = vec![NONE; mesh.vertices_mm().len()];
        let mut vertices = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(facets.len());
        for &facet in &facets {
            triangles.push(mesh.triangles()[facet as usize].map(|v| {
                let number = &mut local[v as usize];
                if *number == NONE {
                    *number = vertices.len() as u32;
                    vertices.push(mesh.vertices_mm()[v as usize]);
                }
                *number
            }));
        }
        let paired = |triangles: &[[u32; 3]], vertices: usize| {
            twins(triangles, vertices)
                .expect("no edge of a model has three triangles, and borders get one more each")
        };
        let open = paired(&triangles, vertices.len());
        let mut borders = border_loops(&triangles, &open);
        let place = |side: u32| vertices[from(&triangles, side) as usize];
        let length = |border: &[u32]| -> f64 {
            let next = border.iter().skip(1).chain(border.first());
            border.iter().zip(next).map(|(&a, &b)| place(a).distance(place(b))).sum()
        };
        let edges = (3 * triangles.len() + borders.iter().map(Vec::len).sum::<usize>()) / 2;
        let euler = (vertices.len() + triangles.len()) as i64 - edges as i64;
        if borders.is_empty() {
            return Err(NoDisc::Closed);
        }
        if euler + borders.len() as i64 != 2 {
            return Err(NoDisc::Handle);
        }
        let longest = (0..borders.len())
            .max_by(|&a, &b| length(&borders[a]).total_cmp(&length(&borders[b])).then(b.cmp(&a)))
            .expect("there is a border");
        let loop_vertices =
            |border: &[u32]| -> Vec<u32> { border.iter().map(|&side| from(&triangles, side)).collect() };
        let border = loop_vertices(&borders.remove(longest));
        let holes: Vec<Vec<u32>> = borders.iter().map(|hole| loop_vertices(hole)).collect();
        let mut middles = Vec::new();
        for hole in holes {
            let middle = hole.iter().map(|&v| vertices[v as usize]).sum::<DVec3>() / hole.len() as f64;
            middles.push(vertices.len() as u32);
            vertices.push(middle);
            let next = hole.iter().skip(1).chain(hole.first());
            triangles.extend(hole.iter().zip(next).map(|(&a, &b)| [b, a, middles[middles.len() - 1]]));
        }
        let twins = paired(&triangles, vertices.len());
        Ok(Self { vertices, triangles, facets, twins, border, middles, numbers: local })
    }
}

/// The triangles at `inner` vertices and, until no two fans of them touch in a vertex only, at such vertices too.
fn facets_around(mesh: &Mesh, inner: &[u32]) -> Vec<u32> {
    let mut is_in = vec![false; mesh.triangles().len()];
    let mut is_done = vec![false; mesh.vertices_mm().len()];
    let mut facets = Vec::new();
    let mut open: Vec<u32> = inner.to_vec();
    while !open.is_empty() {
        let mut touched = Vec::new();
        for &vertex in &open {
            is_done[vertex as usize] = true;
            for side in mesh.star(vertex) {
                if !std::mem::replace(&mut is_in[(side / 3) as usize], true) {
                    facets.push(side / 3);
                    touched.extend(mesh.triangles()[(side / 3) as usize]);
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&vertex| !is_done[vertex as usize] && fans(mesh, vertex, &is_in) > 1);
        open = touched;
    }
    facets.sort_unstable();
    facets
}

/// How many fans the triangles that are in form around a vertex.
fn fans(mesh: &Mesh, vertex: u32, is_in: &[bool]) -> usize {
    let star: Vec<u32> = mesh.star(vertex).collect();
    let goes_round = mesh.twin(star[0]) != NONE;
    let begins = |i: usize| {
        let before = if i > 0 { Some(star[i - 1]) } else { star.last().copied().filter(|_| goes_round) };
        is_in[(star[i] / 3) as usize] && before.is_none_or(|side| !is_in[(side / 3) as usize])
    };
    (0..star.len()).filter(|&i| begins(i)).count()
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{ball, clean, torus, tube};
    use super::*;
    use proptest::prelude::*;

    fn is_disc(disc: &Disc) -> bool {
        let open = disc.twins.iter().filter(|&&twin| twin == NONE).count();
        let edges = (3 * disc.triangles.len() + open) / 2;
        open == disc.border.len() && disc.vertices.len() + disc.triangles.len() == edges + 1
    }

    #[test]
    fn a_band_round_a_vase_is_a_disc() {
        let mesh = clean(tube([24, 12], 40.0, |_| 20.0));
        let ring: Vec<u32> = (0..mesh.vertices_mm().len() as u32)
            .filter(|&v| (mesh.vertices_mm()[v as usize].z - 20.0).abs() < 4.0)
            .collect();
        let disc = Disc::around(&mesh, &ring).unwrap();
        assert!(is_disc(&disc) && disc.triangles.len() == disc.facets.len() + 24);
        // Also with the borders of the model in it.
        let all: Vec<u32> = (0..mesh.vertices_mm().len() as u32).collect();
        assert!(is_disc(&Disc::around(&mesh, &all).unwrap()));
    }

    #[test]
    fn what_is_no_disc_is_told() {
        let sphere = clean(ball(3, |p| p));
        let all = |mesh: &Mesh| (0..mesh.vertices_mm().len() as u32).collect::<Vec<u32>>();
        assert_eq!(Disc::around(&sphere, &all(&sphere)).unwrap_err(), NoDisc::Closed);
        let ring = clean(torus([24, 12], 30.0, 10.0));
        assert_eq!(Disc::around(&ring, &all(&ring)[1..]).unwrap_err(), NoDisc::Closed);
        assert_eq!(Disc::around(&ring, &all(&ring)[20..]).unwrap_err(), NoDisc::Handle);
    }

    proptest! {
        #[test]
        fn pieces_of_a_ball_are_discs(seeds in prop::collection::vec(0usize..200, 1..5), reach in 0.0..1.2f64) {
            let mesh = clean(ball(5, |p| p));
            // Several pieces, joined by a way.
            let places: Vec<_> = seeds.iter().map(|&s| mesh.nearest_anywhere(mesh.vertices_mm()[s]).unwrap()).collect();
            let route = mesh.route(&places, false).unwrap();
            let near: Vec<u32> = mesh.within(&route.vertices(), reach, usize::MAX).into_iter().map(|(v, _)| v).collect();
            match Disc::around(&mesh, &near) {
                Ok(disc) => prop_assert!(is_disc(&disc)),
                Err(why) => prop_assert_eq!(why, NoDisc::Closed),
            }
        }
    }
}
