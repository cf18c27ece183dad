//! A closed triangle mesh, and the flat extrusion that makes one.

use super::FabricateError;
use super::caps;
use super::snap::snapped_to_f32;
use crate::planar::{Grid, Part, Region};

/// A closed solid: facets are counter-clockwise seen from outside, every edge has exactly two facets, and
/// every vertex belongs to one shell. Coordinates are millimetres and exact, not rounded: they are what the
/// checks were made on.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Past the last vertex and the last triangle of each shell.
    ends: Vec<(usize, usize)>,
}

/// One closed surface of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell<'a> {
    /// Its vertices, which no other shell has.
    pub vertices: &'a [[f32; 3]],
    /// The number of the first of them in the solid.
    pub first_vertex: u32,
    /// Its facets, by the numbers that vertices have in the solid.
    pub triangles: &'a [[u32; 3]],
}

impl Solid {
    /// No shell, with room for as many vertices and triangles.
    pub(super) fn with_capacity(vertices: usize, triangles: usize) -> Self {
        let (vertices, triangles) = (Vec::with_capacity(vertices), Vec::with_capacity(triangles));
        Self { vertices, triangles, ends: Vec::new() }
    }

    /// Adds vertices to the shell that is being built; the number of the first of them.
    pub(super) fn add_vertices(&mut self, vertices: impl IntoIterator<Item = [f32; 3]>) -> u32 {
        let first = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        first
    }

    /// Adds facets to the shell that is being built.
    pub(super) fn add_triangles(&mut self, triangles: impl IntoIterator<Item = [u32; 3]>) {
        self.triangles.extend(triangles);
    }

    /// Adds the upright wall between two equal sections of a part, of which the vertices begin at `bottom` and `top`.
    pub(super) fn add_wall(&mut self, part: &Part, bottom: u32, top: u32) {
        let mut start = 0;
        for contour in part.contours() {
            let n = contour.points().len() as u32;
            for i in 0..n {
                // The ink is on the left of i -> j, so the outside is on its right.
                let (i, j) = (start + i, start + (i + 1) % n);
                self.triangles.push([bottom + i, bottom + j, top + j]);
                self.triangles.push([bottom + i, top + j, top + i]);
            }
            start += n;
        }
    }

    /// Ends the shell that is being built.
    pub(super) fn end_shell(&mut self) {
        self.ends.push((self.vertices.len(), self.triangles.len()));
    }

    /// The shells, one for each component of what was made solid, in its order.
    pub fn shells(&self) -> impl ExactSizeIterator<Item = Shell<'_>> {
        (0..self.ends.len()).map(|i| {
            let (vertex, triangle) = if i == 0 { (0, 0) } else { self.ends[i - 1] };
            let (vertices_end, triangles_end) = self.ends[i];
            Shell {
                vertices: &self.vertices[vertex..vertices_end],
                first_vertex: vertex as u32,
                triangles: &self.triangles[triangle..triangles_end],
            }
        })
    }

    /// The vertices (x, y, z) in millimetres.
    pub fn vertices(&self) -> &[[f32; 3]] {
        &self.vertices
    }

    /// The facets as vertex numbers, counter-clockwise seen from outside, in a fixed order.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of each facet, in the order of [`Self::triangles`].
    pub fn facets(&self) -> impl ExactSizeIterator<Item = [[f32; 3]; 3]> + Clone + '_ {
        self.triangles.iter().map(|t| t.map(|i| self.vertices[i as usize]))
    }

    /// The enclosed volume in cubic millimetres, positive for outward facets.
    pub fn volume_mm3(&self) -> f64 {
        let six_volumes = |[a, b, c]: [[f32; 3]; 3]| {
            let [a, b, c] = [a, b, c].map(|p| glam::DVec3::from_array(p.map(f64::from)));
            a.dot(b.cross(c))
        };
        self.facets().map(six_volumes).sum::<f64>() / 6.0
    }
}

/// The prism over `region` from z = 0 to z = `thickness_mm`: one shell for each component, with one tunnel
/// for each hole.
///
/// The region is brought onto 32-bit floats first, see [`snapped_to_f32`]. Facets come component by
/// component: bottom, top, walls contour by contour.
///
/// # Errors
/// [`FabricateError::Thickness`], [`FabricateError::Empty`], and the errors of [`snapped_to_f32`].
pub fn extrude(region: &Region, thickness_mm: f64) -> Result<Solid, FabricateError> {
    if !(Grid::MIN_EXTENT_MM..=Grid::MAX_EXTENT_MM).contains(&thickness_mm) {
        return Err(FabricateError::Thickness { found_mm: thickness_mm });
    }
    let region = snapped_to_f32(region)?;
    let grid = region.grid();
    let count = region.vertices();
    let mut solid = Solid::with_capacity(2 * count, 4 * count);
    for part in region.parts() {
        let cap = caps::triangulate(part).map_err(|found| FabricateError::Triangulation {
            position_mm: grid.to_mm(part.exterior().points()[0]),
            found,
        })?;
        let outline = || part.contours().flat_map(|c| c.points()).map(|&p| grid.to_mm(p));
        let bottom = solid.add_vertices(outline().map(|p| [p.x as f32, p.y as f32, 0.0]));
        let top = solid.add_vertices(outline().map(|p| [p.x as f32, p.y as f32, thickness_mm as f32]));
        solid.add_triangles(cap.iter().map(|&[a, b, c]| [bottom + a, bottom + c, bottom + b]));
        solid.add_triangles(cap.iter().map(|t| t.map(|v| top + v)));
        solid.add_wall(part, bottom, top);
        solid.end_shell();
    }
    Ok(solid)
}

#[cfg(test)]
pub(super) mod tests {
    use std::collections::HashMap;

    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::planar::{FillRule, GridPoint};

    /// (shells, total genus) of a solid, after checking that it is a closed oriented manifold.
    pub(in super::super) fn shells_and_genus(solid: &Solid) -> (usize, usize) {
        let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
        let mut shell: Vec<usize> = (0..solid.vertices().len()).collect();
        fn root(shell: &mut [usize], mut i: usize) -> usize {
            while shell[i] != i {
                shell[i] = shell[shell[i]];
                i = shell[i];
            }
            i
        }
        for t in solid.triangles() {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((a, b)).or_default() += 1;
                let (a, b) = (root(&mut shell, a as usize), root(&mut shell, b as usize));
                shell[a] = b;
            }
        }
        assert!(edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1)), "not closed");
        let shells = (0..shell.len()).filter(|&i| shell[i] == i).count();
        let euler = solid.vertices().len() as i64 - edges.len() as i64 / 2 + solid.triangles().len() as i64;
        (shells, usize::try_from(shells as i64 - euler / 2).unwrap())
    }

    pub(in super::super) fn rectangles(boxes: &[(f64, f64, f64, f64)]) -> Region {
        let grid = Grid::for_extent(200.0).unwrap();
        let paths: Vec<Vec<GridPoint>> = boxes
            .iter()
            .map(|&(x, y, w, h)| {
                [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
                    .map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap())
                    .to_vec()
            })
            .collect();
        Region::fill(grid, &paths, FillRule::EvenOdd)
    }

    #[test]
    fn a_frame_is_one_shell_of_genus_one() {
        let frame = rectangles(&[(0.0, 0.0, 10.0, 10.0), (2.0, 2.0, 4.0, 4.0)]);
        let solid = extrude(&frame, 2.5).unwrap();
        assert_eq!(shells_and_genus(&solid), (1, 1));
        assert_eq!(solid.volume_mm3(), 84.0 * 2.5);
        assert_eq!(solid.vertices().len(), 16);
    }

    #[test]
    fn flat_areas_have_no_more_facets_than_their_outline_asks_for() {
        let frame = rectangles(&[(0.0, 0.0, 90.0, 90.0), (2.0, 2.0, 40.0, 40.0), (50.0, 50.0, 9.0, 9.0)]);
        // Of each cap V − 2 and two more for each hole; two facets stand on each edge of the outline.
        let (vertices, holes) = (12, 2);
        let cap = vertices - 2 + 2 * holes;
        let solid = extrude(&frame, 2.0).unwrap();
        assert_eq!(solid.triangles().len(), 2 * cap + 2 * vertices);
        assert_eq!(solid.vertices().len(), 2 * vertices);
    }

    #[test]
    fn each_shell_has_its_own_vertices() {
        let solid = extrude(&rectangles(&[(0.0, 0.0, 1.0, 1.0), (3.0, 0.0, 2.0, 2.0)]), 1.0).unwrap();
        assert_eq!(solid.shells().len(), 2);
        for shell in solid.shells() {
            assert_eq!((shell.vertices.len(), shell.triangles.len()), (8, 12));
            let own = shell.first_vertex..shell.first_vertex + 8;
            assert!(shell.triangles.iter().flatten().all(|v| own.contains(v)));
        }
    }

    #[test]
    fn facets_look_outward() {
        let solid = extrude(&rectangles(&[(1.0, 1.0, 3.0, 2.0)]), 1.0).unwrap();
        let centre = glam::Vec3::new(2.5, 2.0, 0.5);
        for facet in solid.facets() {
            let [a, b, c] = facet.map(glam::Vec3::from_array);
            assert!((b - a).cross(c - a).dot(a - centre) > 0.0);
        }
    }

    #[test]
    fn the_thickness_is_checked() {
        let square = rectangles(&[(0.0, 0.0, 1.0, 1.0)]);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9, 1e-30] {
            assert!(matches!(extrude(&square, bad), Err(FabricateError::Thickness { .. })), "{bad}");
        }
        assert_eq!(extrude(&rectangles(&[]), 1.0), Err(FabricateError::Empty));
    }

    fn polygon() -> impl Strategy<Value = Vec<(f64, f64)>> {
        let star = (5.0..95.0, 5.0..95.0, 0.5..40.0, proptest::collection::vec(0.2..1.0f64, 3..40));
        star.prop_map(|(x, y, radius, spokes): (f64, f64, f64, Vec<f64>)| {
            let turn = std::f64::consts::TAU / spokes.len() as f64;
            let spoke = |(i, s): (usize, &f64)| {
                let (sin, cos) = (turn * i as f64).sin_cos();
                (x + radius * s * cos, y + radius * s * sin)
            };
            spokes.iter().enumerate().map(spoke).collect()
        })
    }

    /// Coordinates on a coarse lattice meet, overlap and line up all the time; free ones never do.
    pub(in super::super) fn region() -> impl Strategy<Value = Region> {
        (proptest::collection::vec(polygon(), 1..12), prop::bool::ANY).prop_map(|(polygons, lattice)| {
            let grid = Grid::for_extent(200.0).unwrap();
            let place = |&(x, y): &(f64, f64)| {
                let p = DVec2::new(x, y);
                grid.snap(if lattice { (p / 4.0).round() * 4.0 } else { p }).unwrap()
            };
            let paths: Vec<Vec<GridPoint>> = polygons.iter().map(|p| p.iter().map(place).collect()).collect();
            Region::fill(grid, &paths, FillRule::EvenOdd)
        })
    }

    proptest! {
        #[test]
        fn shells_and_genus_are_components_and_holes(region in region(), thickness in 0.1..20.0f64) {
            prop_assume!(!region.is_empty());
            let solid = extrude(&region, thickness);
            // Three lines of the lattice that nearly meet in a point can leave ink finer than floats.
            prop_assume!(!matches!(solid, Err(FabricateError::TooFine { .. })));
            let solid = solid.unwrap();
            prop_assert_eq!(shells_and_genus(&solid), (region.components(), region.holes()));
            let snapped = snapped_to_f32(&region).unwrap();
            let expected = snapped.area_mm2() * f64::from(thickness as f32);
            prop_assert!((solid.volume_mm3() - expected).abs() < 1e-6 * expected);
            // Tips that touched may be cut back by some micrometres.
            prop_assert!((snapped.area_mm2() - region.area_mm2()).abs() < 0.5);
            prop_assert_eq!(&solid, &extrude(&region, thickness).unwrap());
        }
    }
}
