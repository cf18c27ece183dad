//! A solid over a region that is laid on a curved sheet.
//!
//! The region is cut by upright lines, between which the sheet is flat enough; its outline gets a vertex wherever it crosses one,
//! and no facet crosses any. Back and front are that triangulation, placed on the two sides of the sheet, and the walls stand on the outline's
//! edges. So the solid is closed by construction, as a flat one is: b0 components and b1 holes become b0 shells of total genus b1.
//! Where the two ends of the sheet are joined, the vertices on them are the same and no wall stands there. Excluded: where the sheet lies
//! in space, and whether it meets itself.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::FabricateError;
use super::caps;
use super::simplify::simplified;
use super::snap::same_counts;
use super::solid::Solid;
use crate::planar::{Contour, GridPoint, Part, Region, RegionError, Sets};

/// Vertices nearer than this part of the chord error to the line between their neighbours are left out, as 32-bit floats
/// could turn a facet over that is thinner than they are exact.
const STRAIGHT_PART: f64 = 0.05;
/// How far a line may be moved to keep away from vertices, as a part of the distance to its neighbours.
const MOVE_PART: f64 = 0.1;

/// A curved sheet of some thickness over a strip of the plane.
pub struct Sheet<'s> {
    /// Where the sheet lies: the place of a point of the plane, in millimetres, on its back (0) and on its front (1).
    pub place: &'s dyn Fn(DVec2, usize) -> DVec3,
    /// The upright lines in millimetres, ascending, between which it is flat enough. The first and the last are its ends.
    pub lines_mm: &'s [f64],
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
    let lines = Lines::new(&region, sheet);
    let cut = lines.cut(&region)?;
    let grid = cut.grid();
    let mut pieces = Vec::with_capacity(cut.components());
    for part in cut.parts() {
        let vertices: Vec<GridPoint> = part.contours().flat_map(|c| c.points()).copied().collect();
        let facets = caps::triangulate_along(part, &lines.inside(&vertices)).map_err(|found| {
            FabricateError::Triangulation { position_mm: grid.to_mm(part.exterior().points()[0]), found }
        })?;
        pieces.push(Piece { part, vertices, facets });
    }
    let shells = lines.shells(&pieces).map_err(|p| FabricateError::Ends { position_mm: grid.to_mm(p) })?;
    let count: usize = pieces.iter().map(|piece| piece.vertices.len()).sum();
    let mut solid = Solid::with_capacity(2 * count, 4 * count);
    for shell in shells {
        // The numbers of the back vertices; those of the front follow each.
        let mut numbers: FxHashMap<GridPoint, u32> = FxHashMap::default();
        for &p in shell.iter().flat_map(|&i| &pieces[i].vertices) {
            let p = lines.joined(p);
            numbers.entry(p).or_insert_with(|| {
                let at = |side| (sheet.place)(grid.to_mm(p), side).as_vec3().to_array();
                solid.add_vertices([at(0), at(1)])
            });
        }
        for piece in shell.iter().map(|&i| &pieces[i]) {
            let number = |v: u32| numbers[&lines.joined(piece.vertices[v as usize])];
            solid.add_triangles(piece.facets.iter().map(|&[a, b, c]| [a, c, b].map(number)));
            solid.add_triangles(piece.facets.iter().map(|facet| facet.map(|v| number(v) + 1)));
            for (p, q) in piece.part.contours().flat_map(|c| c.edges()).filter(|edge| !lines.is_end(*edge)) {
                let [i, j] = [p, q].map(|p| numbers[&lines.joined(p)]);
                // The ink is on the left, so the outside is on the right.
                solid.add_triangles([[i, j, j + 1], [i, j + 1, i + 1]]);
            }
        }
        solid.end_shell();
    }
    Ok(solid)
}

/// A component that was cut, with its vertices in the order of its contours and its facets.
struct Piece<'p> {
    part: &'p Part,
    vertices: Vec<GridPoint>,
    facets: Vec<[u32; 3]>,
}

/// The lines on the grid.
struct Lines {
    /// Without the ends, ascending. No vertex of the region lies on them.
    inner: Vec<i64>,
    /// The ends, if they are joined.
    ends: Option<[i64; 2]>,
}

impl Lines {
    fn new(region: &Region, sheet: &Sheet<'_>) -> Self {
        let grid = region.grid();
        let mut taken: Vec<i64> = region.contours().flat_map(|c| c.points()).map(|p| p.x).collect();
        taken.sort_unstable();
        taken.dedup();
        let at: Vec<i64> = sheet.lines_mm.iter().map(|&x| grid.steps(x)).collect();
        let inner = at.windows(3).map(|w| {
            let room = (MOVE_PART * (w[1] - w[0]).min(w[2] - w[1]) as f64) as i64;
            widest_gap(&taken, w[1], room)
        });
        let mut inner: Vec<i64> = inner.collect();
        inner.dedup();
        let ends = sheet.is_joined.then(|| [at[0], at[at.len() - 1]]);
        Self { inner, ends }
    }

    /// `region` with a vertex wherever its outline crosses a line.
    fn cut(&self, region: &Region) -> Result<Region, FabricateError> {
        let grid = region.grid();
        let contours = region.contours().map(|contour| {
            let mut points = Vec::with_capacity(2 * contour.points().len());
            for (a, b) in contour.edges() {
                points.push(a);
                let (low, high) = (a.x.min(b.x), a.x.max(b.x));
                let from = self.inner.partition_point(|&x| x <= low);
                let to = self.inner.partition_point(|&x| x < high);
                let crossed = self.inner[from..to.max(from)].iter().map(|&x| crossing(a, b, x));
                match a.x < b.x {
                    true => points.extend(crossed),
                    false => points.extend(crossed.rev()),
                }
            }
            Contour::new(points).expect("more vertices do not take its area")
        });
        match Region::from_contours(grid, contours.collect()) {
            Ok(cut) if same_counts(&cut, region) => Ok(cut),
            Err(RegionError::Grid(error)) => Err(error.into()),
            found => {
                let cut = found.as_ref().ok();
                let first = |faults: &[crate::planar::Fault]| faults[0].position_mm();
                Err(FabricateError::TooFine {
                    position_mm: match &found {
                        Err(RegionError::Invalid { faults }) => first(faults),
                        _ => region.bounds_mm().unwrap_or_default().0,
                    },
                    step_mm: grid.step_mm(),
                    components: region.components(),
                    holes: region.holes(),
                    found_components: cut.map_or(0, Region::components),
                    found_holes: cut.map_or(0, Region::holes),
                })
            }
        }
    }

    /// Edges along the lines through the ink of a part, by the numbers of its vertices.
    fn inside(&self, vertices: &[GridPoint]) -> Vec<[u32; 2]> {
        let is_on = |v: &u32| self.inner.binary_search(&vertices[*v as usize].x).is_ok();
        let mut on: Vec<u32> = (0..vertices.len() as u32).filter(is_on).collect();
        on.sort_unstable_by_key(|&v| vertices[v as usize]);
        let mut edges = Vec::with_capacity(on.len() / 2);
        for line in on.chunk_by(|&a, &b| vertices[a as usize].x == vertices[b as usize].x) {
            // The outline crosses the line at each of them: in, out, in, out.
            edges.extend(line.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
        }
        edges
    }

    /// A point of the one end for that of the other.
    fn joined(&self, p: GridPoint) -> GridPoint {
        match self.ends {
            Some([first, last]) if p.x == last => GridPoint::new(first, p.y),
            _ => p,
        }
    }

    /// Whether an edge lies on an end.
    fn is_end(&self, (p, q): (GridPoint, GridPoint)) -> bool {
        p.x == q.x && self.ends.is_some_and(|ends| ends.contains(&p.x))
    }

    /// The numbers of the pieces of each shell: those that are joined at the ends together. Or a point of an end that the other end
    /// does not have.
    fn shells(&self, pieces: &[Piece<'_>]) -> Result<Vec<Vec<usize>>, GridPoint> {
        let mut sets = Sets::new(pieces.len());
        if let Some(ends) = self.ends {
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

/// The middle of the widest gap between `taken` places within `room` of `near`. Where all are taken it is one of them, and the
/// triangulation fails.
fn widest_gap(taken: &[i64], near: i64, room: i64) -> i64 {
    let (low, high) = (near - room.max(2), near + room.max(2));
    let from = taken.partition_point(|&x| x < low);
    let to = taken.partition_point(|&x| x <= high);
    let stops = [&[low], &taken[from..to], &[high]].concat();
    let gaps = stops.windows(2).map(|pair| (pair[1] - pair[0], pair[0].midpoint(pair[1])));
    // Of equal ones the nearest.
    let best = gaps.max_by_key(|&(gap, middle)| (gap, -(middle - near).abs())).expect("there are two stops");
    best.1
}

/// Where the edge crosses the upright line at `x`, rounded to the grid.
fn crossing(a: GridPoint, b: GridPoint, x: i64) -> GridPoint {
    let (run, rise) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let along = i128::from(x - a.x) * rise;
    // Rounded to the nearest, halves up, whichever way the edge runs.
    let (along, run) = if run < 0 { (-along, -run) } else { (along, run) };
    let up = (2 * along + run).div_euclid(2 * run);
    GridPoint::new(x, a.y + up as i64)
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
        wrap(region, &Sheet { place: &place, lines_mm: &lines, is_joined, chord_mm: 0.05 })
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

    #[test]
    fn crossings_do_not_depend_on_the_direction() {
        let (a, b) = (GridPoint::new(-7, 3), GridPoint::new(12, -40));
        for x in -6..12 {
            assert_eq!(crossing(a, b, x), crossing(b, a, x));
        }
        assert_eq!(crossing(GridPoint::new(0, 0), GridPoint::new(2, 1), 1), GridPoint::new(1, 1));
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
    }
}
