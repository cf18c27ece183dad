//! A wall for a model: its inner side.
//!
//! Each vertex is moved inwards along its normal until the nearest of the planes of its facets is a wall away, and
//! the moved surface is turned round. Along borders, quadrilaterals join the two. Excluded: whether the wall meets
//! itself, where the model bends inwards more than the wall is thick; that is for the caller to judge.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::error::SurfaceError;
use super::mesh::Mesh;
use super::sides::{NONE, triangle_of, twins};

/// The least wall in millimetres: less, and its two sides are one for a printer and nearly so for the numbers of files.
const LEAST_WALL_MM: f64 = 0.01;
/// The cosine between a vertex's normal and a facet's that is taken for the least. Less, and sharp corners grow
/// long thorns inwards; more, and walls beside them get thinner. At a corner of a cube it is 0.577.
const LEAST_COSINE: f64 = 0.5;

impl Mesh {
    /// The model as a wall of about `wall_mm` under its surface: closed, and agreeing in orientation. Of an open
    /// part it is one shell, of a closed one the outer shell and that of the hollow.
    ///
    /// # Errors
    /// [`SurfaceError::Wall`] if the wall is no thickness, or so thick that corners of its inner side come to lie
    /// on others.
    pub fn thickened(&self, wall_mm: f64) -> Result<Self, SurfaceError> {
        let outer = self.vertices_mm();
        let n = outer.len() as u32;
        if !(LEAST_WALL_MM..=2000.0).contains(&wall_mm) {
            return Err(SurfaceError::Wall { wall_mm, position: outer[0] });
        }
        let mut cosines = vec![1.0f64; outer.len()];
        for (facet, triangle) in self.triangles().iter().enumerate() {
            let [a, b, c] = self.corners(facet);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for &v in triangle {
                let cosine = normal.dot(self.vertex_normals()[v as usize]);
                cosines[v as usize] = cosines[v as usize].min(cosine);
            }
        }
        let inner = (0..outer.len()).map(|v| {
            let depth = wall_mm / cosines[v].max(LEAST_COSINE);
            // As a file has it, so that what is checked here is what is written.
            (outer[v] - self.vertex_normals()[v] * depth).as_vec3().as_dvec3()
        });
        let vertices: Vec<DVec3> = outer.iter().copied().chain(inner).collect();
        // Corners that touched before may touch now; corners that come to touch make another shape.
        let places = |points: &[DVec3]| {
            points.iter().map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits)).collect::<FxHashSet<_>>()
        };
        let (before, inside) = (places(outer), places(&vertices[n as usize..]));
        if before.len() != inside.len() || !before.is_disjoint(&inside) {
            let mut seen = before.clone();
            let mut moved = vertices[n as usize..].iter();
            let position = moved.find(|p| !seen.insert((**p + DVec3::ZERO).to_array().map(f64::to_bits)));
            return Err(SurfaceError::Wall { wall_mm, position: position.copied().unwrap_or(outer[0]) });
        }
        // Where the wall is thicker than the model is curved, its inner side is turned over.
        for facet in 0..self.triangles().len() {
            let [a, b, c] = self.corners(facet);
            let [p, q, r] = self.triangles()[facet].map(|v| vertices[(v + n) as usize]);
            // Beyond the middle of a ball it is turned about, in both directions: then its edges point the other way.
            let is_turned = [(b - a, q - p), (c - b, r - q), (a - c, p - r)]
                .iter()
                .any(|(edge, inner)| edge.dot(*inner) <= 0.0);
            if is_turned || (b - a).cross(c - a).dot((q - p).cross(r - p)) <= 0.0 {
                return Err(SurfaceError::Wall { wall_mm, position: (a + b + c) / 3.0 });
            }
        }
        let mut triangles = self.triangles().to_vec();
        triangles.extend(self.triangles().iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
        let count = self.parts().len() as u32;
        let mut parts: Vec<u32> = (0..self.triangles().len()).map(|t| self.part_of(t) as u32).collect();
        let is_open: Vec<bool> = self.parts().iter().map(|part| part.borders > 0).collect();
        // What has a border is one part with its inner side.
        let within: Vec<u32> =
            parts.iter().map(|&part| if is_open[part as usize] { part } else { part + count }).collect();
        parts.extend(within);
        for side in (0..3 * self.triangles().len() as u32).filter(|&side| self.twin(side) == NONE) {
            let (a, b) = (self.from(side), self.to(side));
            triangles.extend([[b, a, a + n], [b, a + n, b + n]]);
            parts.extend([self.part_of(triangle_of(side)) as u32; 2]);
        }
        let twins = twins(&triangles, vertices.len()).expect("each edge of a border gets one more facet");
        Ok(Self::assembled(vertices, triangles, twins, renumbered(parts)))
    }
}

/// Numbers of parts in the order in which they come first.
fn renumbered(mut parts: Vec<u32>) -> Vec<u32> {
    let mut known = vec![NONE; 1 + parts.iter().copied().max().unwrap_or(0) as usize];
    let mut count = 0;
    for part in &mut parts {
        let number = &mut known[*part as usize];
        if *number == NONE {
            *number = count;
            count += 1;
        }
        *part = *number;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::super::mesh::MeshPart;
    use super::super::sample_meshes::{ball, blob, clean, grid, torus, tube};
    use super::*;
    use proptest::prelude::*;

    fn parts(mesh: &Mesh) -> Vec<(usize, usize)> {
        mesh.parts().iter().map(|&MeshPart { borders, genus, .. }| (borders, genus)).collect()
    }

    #[test]
    fn walls_that_turn_over_are_told() {
        let ball = clean(ball(6, |p| 25.0 * p.normalize()));
        assert!(ball.thickened(12.0).is_ok());
        for wall in [25.0, 26.0, 40.0] {
            assert!(matches!(ball.thickened(wall), Err(SurfaceError::Wall { .. })), "{wall}");
        }
    }

    #[test]
    fn an_open_model_gets_one_shell() {
        // A tube has a hole, a sheet none.
        let walled = clean(tube([32, 8], 40.0, |h| 20.0 + 3.0 * (5.0 * h).sin())).thickened(2.0).unwrap();
        assert!(walled.is_closed() && parts(&walled) == [(0, 1)]);
        let sheet = clean(grid([6, 6], [false; 2], |p| (30.0 * p).extend(5.0 * p.x * p.y)));
        let walled = sheet.thickened(2.0).unwrap();
        assert!(walled.is_closed() && parts(&walled) == [(0, 0)]);
        assert!((walled.volume_mm3() - 2.0 * 900.0).abs() < 60.0, "{}", walled.volume_mm3());
        assert!(walled.vertices_mm()[49].z < 0.0, "the wall is under the surface");
        let (again, repairs) = Mesh::new(walled.facets()).unwrap();
        assert!(repairs.is_empty() && again.facets().eq(walled.facets()));
    }

    #[test]
    fn a_closed_model_gets_a_hollow() {
        let walled = clean(torus([40, 20], 30.0, 10.0)).thickened(2.0).unwrap();
        assert!(walled.is_closed() && parts(&walled) == [(0, 1), (0, 1)]);
        // What is read again is still hollow.
        let (again, repairs) = Mesh::new(walled.facets()).unwrap();
        assert!(repairs.is_empty(), "{repairs:?}");
        assert!((again.volume_mm3() - walled.volume_mm3()).abs() < 1e-6);
    }

    #[test]
    fn walls_are_as_thick_as_was_asked_for() {
        let walled = clean(tube([64, 8], 40.0, |_| 20.0)).thickened(2.0).unwrap();
        for p in walled.vertices_mm() {
            let radius = p.truncate().length();
            assert!((radius - 20.0).abs() < 1e-4 || (radius - 18.0).abs() < 0.01, "{radius}");
        }
    }

    #[test]
    fn a_wall_that_is_none_is_refused() {
        let mesh = clean(ball(4, |p| 10.0 * p));
        for wall in [0.0, -1.0, f64::NAN, 1e-9] {
            assert!(matches!(mesh.thickened(wall), Err(SurfaceError::Wall { .. })), "{wall}");
        }
    }

    proptest! {
        #[test]
        fn walls_are_closed(amounts in prop::array::uniform3(-0.1..0.1f64), wall in 0.5..3.0f64) {
            let walled = blob(6, amounts).thickened(wall).unwrap();
            prop_assert!(walled.is_closed());
            prop_assert_eq!(parts(&walled), [(0, 0), (0, 0)]);
            prop_assert!(walled.volume_mm3() > 0.0);
        }
    }
}
