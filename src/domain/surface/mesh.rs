//! Models: triangles that form a surface.

use glam::DVec3;

use super::error::SurfaceError;
use super::orient::{agree, assert_agree, outside_out, part_fans};
use super::repair::{MeshRepair, Repairs};
use super::sides::{NONE, border_loops, from, outgoing, previous, star, to, triangle_of, twins};
use super::soup::Soup;

/// A surface of triangles, closed or with borders, of one part or several, in millimetres.
///
/// Each edge has one triangle or two, each vertex one fan of them, and neighbours agree in their orientation: seen
/// from outside, corners are counter-clockwise. Closed parts have their inside inside; which side of an open part
/// is its outside is what the file says.
#[derive(Debug, Clone)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// For each side the one across its edge.
    twins: Vec<u32>,
    /// For each vertex a side from which its star goes round.
    outgoing: Vec<u32>,
    normals: Vec<DVec3>,
    parts: Vec<u32>,
}

/// What hangs together of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshPart {
    /// How many facets it has.
    pub facets: usize,
    /// How many borders it has; none if it is closed.
    pub borders: usize,
    /// How many handles it has: none if it is a ball or a sheet, one if it is a ring.
    pub genus: usize,
}

impl Mesh {
    /// The surface of `facets`, whose corners are counter-clockwise seen from outside, and what had to be mended
    /// for it to be one.
    ///
    /// Equal corners are welded. Repeated facets and facets without area are taken out, facets that face the wrong
    /// way are turned, parts that touch in a corner are parted there, and closed parts that are inside out are
    /// turned.
    ///
    /// # Errors
    /// [`SurfaceError::Empty`], [`SurfaceError::TooMany`], [`SurfaceError::Coordinates`] for what is no model,
    /// [`SurfaceError::Crowded`] for an edge of three facets, [`SurfaceError::Flat`] for a facet that cannot be
    /// mended, and [`SurfaceError::OneSided`].
    pub fn new(
        facets: impl IntoIterator<Item = [[f32; 3]; 3]>,
    ) -> Result<(Self, Vec<MeshRepair>), SurfaceError> {
        let mut repairs = Repairs::default();
        let soup = Soup::new(facets, &mut repairs)?;
        let mut twins = twins(&soup.triangles, soup.vertices.len()).map_err(|edge| soup.crowded(edge))?;
        let Soup { mut vertices, mut triangles } = soup;
        let (parts, count) = agree(&vertices, &mut triangles, &mut twins, &mut repairs)?;
        part_fans(&mut vertices, &mut triangles, &twins, &mut repairs);
        outside_out(&vertices, &mut triangles, &mut twins, (&parts, count), &mut repairs);
        Ok((Self::assembled(vertices, triangles, twins, parts), repairs.told()))
    }

    /// Triangles that are a surface already, with what is across their sides, and their parts.
    pub(super) fn assembled(
        vertices: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        twins: Vec<u32>,
        parts: Vec<u32>,
    ) -> Self {
        assert_agree(&triangles, &twins);
        let outgoing = outgoing(&triangles, &twins, vertices.len());
        let normals = vertex_normals(&vertices, &triangles);
        Self { vertices, triangles, twins, outgoing, normals, parts }
    }

    /// The vertices.
    pub fn vertices_mm(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The three vertices of each triangle, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles by their corners, as files have them.
    pub fn facets(&self) -> impl ExactSizeIterator<Item = [[f32; 3]; 3]> + '_ {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize].as_vec3().to_array()))
    }

    /// A unit vector at each vertex that points outside: the mean of the normals of the triangles there, by their
    /// angles.
    pub fn vertex_normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// Whether there is no border.
    pub fn is_closed(&self) -> bool {
        !self.twins.contains(&NONE)
    }

    /// Nothing, if the model is closed.
    ///
    /// # Errors
    /// [`SurfaceError::Open`] with a place on the longest border.
    pub fn ensure_closed(&self) -> Result<(), SurfaceError> {
        let borders = self.borders();
        let length = |border: &Vec<u32>| {
            let ends =
                |i: usize| [border[i], border[(i + 1) % border.len()]].map(|v| self.vertices[v as usize]);
            (0..border.len()).map(ends).map(|[a, b]| a.distance(b)).sum::<f64>()
        };
        match borders.iter().max_by(|a, b| length(a).total_cmp(&length(b))) {
            None => Ok(()),
            Some(longest) => {
                let position = self.vertices[longest[0] as usize];
                Err(SurfaceError::Open { position, loops: borders.len() })
            }
        }
    }

    /// The vertices along each border, with the surface on the left.
    pub fn borders(&self) -> Vec<Vec<u32>> {
        let loops = border_loops(&self.triangles, &self.twins);
        loops.iter().map(|sides| sides.iter().map(|&side| self.from(side)).collect()).collect()
    }

    /// The parts, in the order of their first facets.
    pub fn parts(&self) -> Vec<MeshPart> {
        let count = self.parts.iter().max().map_or(0, |&last| last as usize + 1);
        let mut parts = vec![MeshPart { facets: 0, borders: 0, genus: 0 }; count];
        // Vertices − edges + facets.
        let mut euler = vec![0i64; count];
        let part = |side: u32| self.parts[triangle_of(side)] as usize;
        for side in 0..self.twins.len() as u32 {
            let twin = self.twins[side as usize];
            // An edge counts where its twin does not come before it.
            euler[part(side)] -= i64::from(twin == NONE || twin > side);
        }
        for &side in &self.outgoing {
            euler[part(side)] += 1;
        }
        for &number in &self.parts {
            euler[number as usize] += 1;
            parts[number as usize].facets += 1;
        }
        for border in border_loops(&self.triangles, &self.twins) {
            parts[part(border[0])].borders += 1;
        }
        for (part, euler) in parts.iter_mut().zip(euler) {
            part.genus = usize::try_from(2 - part.borders as i64 - euler).unwrap_or(0) / 2;
        }
        parts
    }

    /// The part of a facet, counted as [`Mesh::parts`] has them.
    pub fn part_of(&self, facet: usize) -> usize {
        self.parts[facet] as usize
    }

    /// The lowest and the highest corner of the box around the model.
    pub fn bounds_mm(&self) -> [DVec3; 2] {
        let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.vertices.iter().fold(start, |[low, high], &p| [low.min(p), high.max(p)])
    }

    /// What is inside, in cubic millimetres; of no meaning for a model with borders.
    pub fn volume_mm3(&self) -> f64 {
        // About its middle, so that nothing large is taken from something large.
        let [low, high] = self.bounds_mm();
        let middle = low.midpoint(high);
        let corners = |t: &[u32; 3]| t.map(|v| self.vertices[v as usize] - middle);
        self.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    pub(super) fn corners(&self, facet: usize) -> [DVec3; 3] {
        self.triangles[facet].map(|v| self.vertices[v as usize])
    }

    pub(super) fn from(&self, side: u32) -> u32 {
        from(&self.triangles, side)
    }

    pub(super) fn to(&self, side: u32) -> u32 {
        to(&self.triangles, side)
    }

    /// The side across the edge of a side, or [`NONE`].
    pub(super) fn twin(&self, side: u32) -> u32 {
        self.twins[side as usize]
    }

    /// The sides that begin at a vertex, counter-clockwise.
    pub(super) fn star(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        star(&self.twins, self.outgoing[vertex as usize])
    }

    /// The vertices that share an edge with a vertex.
    pub(super) fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.star(vertex).flat_map(|side| {
            // The last edge of a fan at a border has no side that begins here.
            let behind = previous(side);
            let last = (self.twin(behind) == NONE).then(|| self.from(behind));
            [Some(self.to(side)), last].into_iter().flatten()
        })
    }

    /// The place in a triangle at barycentric coordinates, and the outside there.
    pub(super) fn place_in(&self, facet: usize, weights: [f64; 3]) -> (DVec3, DVec3) {
        let sum =
            |of: &[DVec3]| (0..3).map(|i| of[self.triangles[facet][i] as usize] * weights[i]).sum::<DVec3>();
        (sum(&self.vertices), self.outside(facet, sum(&self.normals)))
    }

    /// The place on the edge of a side, from 0 at its begin to 1 at its end, and the outside there; the same from
    /// both sides.
    pub(super) fn place_on(&self, side: u32, part: f64) -> (DVec3, DVec3) {
        let (a, b, part) = match self.from(side) < self.to(side) {
            true => (self.from(side), self.to(side), part),
            false => (self.to(side), self.from(side), 1.0 - part),
        };
        let [a, b] = [a as usize, b as usize];
        let normal = self.normals[a].lerp(self.normals[b], part);
        (self.vertices[a].lerp(self.vertices[b], part), self.outside(triangle_of(side), normal))
    }

    /// A sum of normals as a unit vector; that of the facet where they cancel.
    fn outside(&self, facet: usize, sum: DVec3) -> DVec3 {
        let [a, b, c] = self.corners(facet);
        sum.try_normalize().unwrap_or_else(|| (b - a).cross(c - a).normalize_or(DVec3::Z))
    }
}

/// The mean of the normals of the triangles at each vertex, by their angles there (Thürmer and Wüthrich 1998): it
/// does not depend on how a face is cut into triangles.
fn vertex_normals(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; vertices.len()];
    for triangle in triangles {
        let corners = triangle.map(|v| vertices[v as usize]);
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(normal) = cross.try_normalize() else { continue };
        for (i, v) in triangle.iter().enumerate() {
            let (ahead, behind) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
            sums[*v as usize] += normal * cross.length().atan2(ahead.dot(behind));
        }
    }
    // Where they cancel, as on the tip of a needle, any is as good.
    sums.into_iter().map(|sum| sum.normalize_or(DVec3::Z)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{ball, clean, grid, tube};
    use super::*;

    #[test]
    fn a_box_has_the_normals_of_its_corners() {
        // Whatever way its faces are cut: each of them counts a right angle at a corner.
        let box_of = |p: DVec3| p.signum() * DVec3::new(10.0, 20.0, 30.0);
        let corners: Vec<DVec3> = (0..8)
            .map(|i| box_of(DVec3::from([1, 2, 4].map(|bit| if i & bit > 0 { 1.0 } else { -1.0 }))))
            .collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let facets = facets.map(|f| f.map(|i: usize| corners[i].as_vec3().to_array()));
        let mesh = clean(facets.collect());
        assert!((mesh.volume_mm3() - 48_000.0).abs() < 1e-6);
        assert_eq!(mesh.bounds_mm(), [corners[0], corners[7]]);
        for (place, normal) in mesh.vertices_mm().iter().zip(mesh.vertex_normals()) {
            assert!(normal.distance(place.signum() / 3f64.sqrt()) < 1e-9);
        }
    }

    #[test]
    fn stars_know_all_neighbours() {
        let mesh = clean(tube([8, 3], 10.0, |_| 5.0));
        for v in 0..mesh.vertices_mm().len() as u32 {
            let mut found: Vec<u32> = mesh.neighbours(v).collect();
            found.sort_unstable();
            let has = |t: &&[u32; 3]| t.contains(&v);
            let mut wanted: Vec<u32> = mesh.triangles().iter().filter(has).flatten().copied().collect();
            wanted.sort_unstable();
            wanted.dedup();
            wanted.retain(|&other| other != v);
            assert_eq!(found, wanted);
        }
        assert_eq!(mesh.borders().iter().map(Vec::len).collect::<Vec<_>>(), [8, 8]);
    }

    #[test]
    fn what_is_open_is_told_with_a_place() {
        assert!(clean(ball(2, |p| p)).ensure_closed().is_ok());
        let open = clean(tube([8, 3], 10.0, |h| 5.0 + h)).ensure_closed().unwrap_err();
        match &open {
            SurfaceError::Open { position, loops: 2 } => assert_eq!(position.z, 10.0),
            other => panic!("{other}"),
        }
        assert!(open.to_string().contains("--shell"));
    }

    #[test]
    fn an_edge_of_three_facets_is_told_with_its_ends() {
        let fin = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 1.0]];
        let facets = grid([2, 1], [false; 2], |p| DVec3::new(p.x - 0.5, p.y, 0.0)).into_iter().chain([fin]);
        match Mesh::new(facets).unwrap_err() {
            SurfaceError::Crowded { ends, facets: 3, more: 0 } => {
                assert!(ends.contains(&DVec3::ZERO) && ends.contains(&DVec3::Y), "{ends:?}");
            }
            other => panic!("{other}"),
        }
    }
}
