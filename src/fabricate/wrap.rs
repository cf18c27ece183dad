//! A solid over a region that is laid on a curved sheet.
//!
//! The region is cut by lines, between which the sheet is flat enough, and no facet crosses any ([`super::lines`]). Back and front are that triangulation, placed on the two sides of the sheet, and the walls stand on the outline's
//! edges. So the solid is closed by construction, as a flat one is: b0 components and b1 holes become b0 shells of total genus b1.
//! Where the two ends of the sheet are joined, the vertices on them are the same and no wall stands there. Excluded: where the sheet lies
//! in space, and whether it meets itself.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::FabricateError;
use super::caps;
use super::lines::{Inside, Lines};
use super::simplify::simplified;
use super::solid::Solid;
use crate::planar::{GridPoint, Part, Region, Sets};

/// Vertices nearer than this part of the chord error to the line between their neighbours are left out, as 32-bit floats
/// could turn a facet over that is thinner than they are exact.
const STRAIGHT_PART: f64 = 0.05;

/// A curved sheet of some thickness over a strip of the plane.
pub struct Sheet<'s> {
    /// Where the sheet lies: the place of a point of the plane, in millimetres, on its back (0) and on its front (1).
    pub place: &'s dyn Fn(DVec2, usize) -> DVec3,
    /// The upright lines in millimetres, ascending, between which it is flat enough. The first and the last are its ends.
    pub lines_mm: &'s [f64],
    /// The level lines, ascending, across which it is not flat either. The first and the last are beyond the region; none where it is
    /// flat from side to side.
    pub levels_mm: &'s [f64],
    /// Whether the two ends are the same place. Then the region ends on them, with the same ink on both.
    pub is_joined: bool,
    /// The chord error in millimetres, a small part of which is spent on straight lines.
    pub chord_mm: f64,
}

/// The solid over `region` on `sheet`, with one shell for each component and one tunnel for each hole, those that are joined
/// at the ends of the sheet counted as they are in space.
///
/// # Errors
/// [`FabricateError::Empty`]; [`FabricateError::TooFine`] where a line cannot be kept apart from the outline;
/// [`FabricateError::Triangulation`]; [`FabricateError::Ends`] where joined ends differ.
pub fn wrap(region: &Region, sheet: &Sheet<'_>) -> Result<Solid, FabricateError> {
    if region.is_empty() {
        return Err(FabricateError::Empty);
    }
    let region = simplified(region, STRAIGHT_PART * sheet.chord_mm);
    let lines = Lines::new(&region, sheet.lines_mm, sheet.levels_mm);
    let cut = lines.cut(&region)?;
    let grid = cut.grid();
    let [first, last] = [0, sheet.lines_mm.len() - 1].map(|i| grid.steps(sheet.lines_mm[i]));
    let ends = Ends(sheet.is_joined.then_some([first, last]));
    let mut pieces = Vec::with_capacity(cut.components());
    for part in cut.parts() {
        let Inside { vertices, edges } = lines.inside(part);
        let facets = caps::triangulate_along(part, &vertices, &edges).map_err(|found| {
            FabricateError::Triangulation { position_mm: grid.to_mm(part.exterior().points()[0]), found }
        })?;
        pieces.push(Piece { part, vertices, facets });
    }
    let shells = ends.shells(&pieces).map_err(|p| FabricateError::Ends { position_mm: grid.to_mm(p) })?;
    let count: usize = pieces.iter().map(|piece| piece.vertices.len()).sum();
    let mut solid = Solid::with_capacity(2 * count, 4 * count);
    for shell in shells {
        // The numbers of the back vertices; those of the front follow each.
        let mut numbers: FxHashMap<GridPoint, u32> = FxHashMap::default();
        for &p in shell.iter().flat_map(|&i| &pieces[i].vertices) {
            let p = ends.joined(p);
            numbers.entry(p).or_insert_with(|| {
                let at = |side| (sheet.place)(grid.to_mm(p), side).as_vec3().to_array();
                solid.add_vertices([at(0), at(1)])
            });
        }
        for piece in shell.iter().map(|&i| &pieces[i]) {
            let number = |v: u32| numbers[&ends.joined(piece.vertices[v as usize])];
            solid.add_triangles(piece.facets.iter().map(|&[a, b, c]| [a, c, b].map(number)));
            solid.add_triangles(piece.facets.iter().map(|facet| facet.map(|v| number(v) + 1)));
            for (p, q) in piece.part.contours().flat_map(|c| c.edges()).filter(|edge| !ends.is_end(*edge)) {
                let [i, j] = [p, q].map(|p| numbers[&ends.joined(p)]);
                // The ink is on the left, so the outside is on the right.
                solid.add_triangles([[i, j, j + 1], [i, j + 1, i + 1]]);
            }
        }
        solid.end_shell();
    }
    Ok(solid)
}

/// A component that was cut, with its vertices, those of its contours first in their order, and its facets.
struct Piece<'p> {
    part: &'p Part,
    vertices: Vec<GridPoint>,
    facets: Vec<[u32; 3]>,
}

/// The ends of the sheet on the grid, if they are joined.
struct Ends(Option<[i64; 2]>);

impl Ends {
    /// A point of the one end for that of the other.
    fn joined(&self, p: GridPoint) -> GridPoint {
        match self.0 {
            Some([first, last]) if p.x == last => GridPoint::new(first, p.y),
            _ => p,
        }
    }

    /// Whether an edge lies on an end.
    fn is_end(&self, (p, q): (GridPoint, GridPoint)) -> bool {
        p.x == q.x && self.0.is_some_and(|ends| ends.contains(&p.x))
    }

    /// The numbers of the pieces of each shell: those that are joined at the ends together. Or a point of an end that the other end
    /// does not have.
    fn shells(&self, pieces: &[Piece<'_>]) -> Result<Vec<Vec<usize>>, GridPoint> {
        let mut sets = Sets::new(pieces.len());
        if let Some(ends) = self.0 {
            let on = |end: i64| {
                let of = |(i, piece): (usize, &Piece<'_>)| {
                    let edges = piece.part.contours().flat_map(|c| c.edges()).collect::<Vec<_>>();
                    edges
                        .into_iter()
                        .filter(move |(p, q)| p.x == end && q.x == end)
                        .map(move |(p, q)| ([p.y.min(q.y), p.y.max(q.y)], i))
                };
                pieces.iter().enumerate().flat_map(of).collect::<FxHashMap<[i64; 2], usize>>()
            };
            let [first, last] = ends.map(on);
            let mut pairs: Vec<_> = first.iter().collect();
            pairs.sort_unstable();
            for (edge, &i) in pairs {
                let &j = last.get(edge).ok_or(GridPoint::new(ends[0], edge[0]))?;
                sets.join(i, j);
            }
            if let Some(edge) = last.keys().filter(|edge| !first.contains_key(*edge)).min() {
                return Err(GridPoint::new(ends[1], edge[0]));
            }
        }
        let mut shells: Vec<Vec<usize>> = Vec::new();
        let mut shell_of: FxHashMap<usize, usize> = FxHashMap::default();
        for i in 0..pieces.len() {
            let shell = *shell_of.entry(sets.find(i)).or_insert_with(|| {
                shells.push(Vec::new());
                shells.len() - 1
            });
            shells[shell].push(i);
        }
        Ok(shells)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::super::solid::tests::{rectangles, region, shells_and_genus};
    use super::*;

    /// A cylinder around z on which a strip of `length` goes all the way round.
    fn cylinder(length: f64, thickness: f64) -> impl Fn(DVec2, usize) -> DVec3 {
        let radius = length / TAU;
        move |p, side| {
            let (sin, cos) = (p.x / radius).sin_cos();
            let r = radius + side as f64 * thickness;
            DVec3::new(r * cos, r * sin, p.y)
        }
    }

    fn wrapped(region: &Region, length: f64, is_joined: bool) -> Result<Solid, FabricateError> {
        let place = cylinder(length, 2.0);
        let lines: Vec<f64> = (0..=48).map(|i| length * f64::from(i) / 48.0).collect();
        let sheet = Sheet { place: &place, lines_mm: &lines, levels_mm: &[], is_joined, chord_mm: 0.05 };
        wrap(region, &sheet)
    }

    #[test]
    fn a_strip_becomes_a_ring_when_its_ends_are_joined() {
        let strip = rectangles(&[(0.0, 0.0, 120.0, 10.0)]);
        let ring = wrapped(&strip, 120.0, true).unwrap();
        assert_eq!(shells_and_genus(&ring), (1, 1));
        let radius = 120.0 / TAU;
        let volume = std::f64::consts::PI * ((radius + 2.0).powi(2) - radius * radius) * 10.0;
        assert!((ring.volume_mm3() / volume - 1.0).abs() < 5e-3, "{} {volume}", ring.volume_mm3());
        let open = wrapped(&rectangles(&[(0.0, 0.0, 100.0, 10.0)]), 120.0, false).unwrap();
        assert_eq!(shells_and_genus(&open), (1, 0));
    }

    #[test]
    fn counts_are_those_in_space() {
        // Two bars that are one all round, a bar between them, and an island over the ends.
        let bars = rectangles(&[
            (0.0, 0.0, 120.0, 2.0),
            (0.0, 8.0, 120.0, 2.0),
            (50.0, 2.0, 3.0, 6.0),
            (0.0, 4.0, 3.0, 2.0),
            (117.0, 4.0, 3.0, 2.0),
        ]);
        let solid = wrapped(&bars, 120.0, true).unwrap();
        let shells = solid.shells().len();
        let (counted, genus) = shells_and_genus(&solid);
        assert_eq!((shells, counted), (2, 2));
        // Two rings with a bar between them: as a surface with two tunnels.
        assert_eq!(genus, 2);
    }

    #[test]
    fn ends_that_differ_are_named() {
        let odd = rectangles(&[(0.0, 0.0, 120.0, 2.0), (0.0, 5.0, 10.0, 2.0)]);
        let Err(FabricateError::Ends { position_mm }) = wrapped(&odd, 120.0, true) else {
            panic!("they differ")
        };
        assert_eq!(position_mm, DVec2::new(0.0, 5.0));
    }

    /// A sheet that is bent both ways.
    fn draped(region: &Region) -> Result<Solid, FabricateError> {
        let place = |p: DVec2, side: usize| {
            let height = 6.0 * (p.x / 40.0).sin() * (p.y / 30.0).cos();
            DVec3::new(p.x, p.y, height + 2.0 * side as f64)
        };
        let [lines, levels] = [(400.0, 7.0), (200.0, 5.0)].map(|(length, step)| {
            (-1..=(length / step) as i32 + 1).map(|i| step * f64::from(i) + 0.1).collect::<Vec<f64>>()
        });
        let sheet =
            Sheet { place: &place, lines_mm: &lines, levels_mm: &levels, is_joined: false, chord_mm: 0.05 };
        wrap(region, &sheet)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn wrapped_regions_keep_shells_and_genus(region in region()) {
            prop_assume!(!region.is_empty());
            match wrapped(&region, 400.0, false) {
                Ok(solid) => {
                    prop_assert_eq!(shells_and_genus(&solid), (region.components(), region.holes()));
                    prop_assert!(solid.volume_mm3() > 0.0);
                    let flat = region.area_mm2() * 2.0;
                    prop_assert!((solid.volume_mm3() / flat - 1.0).abs() < 0.05, "{} {}", solid.volume_mm3(), flat);
                }
                Err(FabricateError::TooFine { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }

        #[test]
        fn draped_regions_keep_shells_and_genus(region in region()) {
            prop_assume!(!region.is_empty());
            match draped(&region) {
                Ok(solid) => {
                    prop_assert_eq!(shells_and_genus(&solid), (region.components(), region.holes()));
                    // It is as thick everywhere, straight up.
                    let flat = region.area_mm2() * 2.0;
                    prop_assert!((solid.volume_mm3() / flat - 1.0).abs() < 0.01, "{} {}", solid.volume_mm3(), flat);
                }
                Err(FabricateError::TooFine { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }
}
