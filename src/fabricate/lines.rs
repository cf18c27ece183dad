//! The lines of a curved sheet across a region: where the outline crosses them, and the edges along them through the ink.
//!
//! Upright lines and level ones make cells, in each of which the sheet is flat enough. No vertex of the region lies on a line. Wherever the
//! outline crosses one it gets a vertex, and where two lines cross in the ink there is one too. Along a line, ink begins and ends at the
//! vertices of the outline at which it comes to the other side. All of it is decided on the grid; where rounding makes two crossings one, no
//! triangulation passes its check, and the place is an error. Excluded: the solid ([`super::wrap`]).

use super::FabricateError;
use super::snap::same_counts;
use crate::planar::{Contour, Fault, GridPoint, Part, Region, RegionError};

/// How far a line may be moved to keep away from vertices, as a part of the distance to its neighbours.
const MOVE_PART: f64 = 0.1;

/// Lines on the grid, ascending. No vertex of the region that they were made for lies on them.
pub(super) struct Lines {
    upright: Vec<i64>,
    level: Vec<i64>,
}

/// The vertices of a part that was cut, those of its outline first, and the edges along lines by their numbers.
pub(super) struct Inside {
    pub(super) vertices: Vec<GridPoint>,
    pub(super) edges: Vec<[u32; 2]>,
}

impl Lines {
    /// Near the places in millimetres, without the first and the last of the upright ones, which are the ends of the sheet.
    pub(super) fn new(region: &Region, upright_mm: &[f64], level_mm: &[f64]) -> Self {
        let grid = region.grid();
        let near = |places: &[f64], across: fn(&GridPoint) -> i64| {
            let mut taken: Vec<i64> = region.contours().flat_map(|c| c.points()).map(across).collect();
            taken.sort_unstable();
            taken.dedup();
            let at: Vec<i64> = places.iter().map(|&x| grid.steps(x)).collect();
            let lines = at.windows(3).map(|w| {
                let room = (MOVE_PART * (w[1] - w[0]).min(w[2] - w[1]) as f64) as i64;
                widest_gap(&taken, w[1], room)
            });
            let mut lines: Vec<i64> = lines.collect();
            lines.dedup();
            lines
        };
        Self { upright: near(upright_mm, |p| p.x), level: near(level_mm, |p| p.y) }
    }

    /// `region` with a vertex wherever its outline crosses a line.
    ///
    /// # Errors
    /// [`FabricateError::TooFine`] where that cannot be told from its other vertices.
    pub(super) fn cut(&self, region: &Region) -> Result<Region, FabricateError> {
        let grid = region.grid();
        let mut on_edge: Vec<GridPoint> = Vec::new();
        let contours = region.contours().map(|contour| {
            let mut points = Vec::with_capacity(2 * contour.points().len());
            for (a, b) in contour.edges() {
                points.push(a);
                on_edge.clear();
                on_edge.extend(between(&self.upright, a.x, b.x).iter().map(|&x| at_upright(a, b, x)));
                on_edge.extend(between(&self.level, a.y, b.y).iter().map(|&y| at_level(a, b, y)));
                // In the order of the edge: along it both coordinates go one way.
                let steps = |p: &GridPoint| p.x.abs_diff(a.x) + p.y.abs_diff(a.y);
                on_edge.sort_by_key(steps);
                on_edge.dedup();
                points.extend_from_slice(&on_edge);
            }
            Contour::new(points).expect("more vertices do not take its area")
        });
        match Region::from_contours(grid, contours.collect()) {
            Ok(cut) if same_counts(&cut, region) => Ok(cut),
            Err(RegionError::Grid(error)) => Err(error.into()),
            found => {
                let cut = found.as_ref().ok();
                let first = |faults: &[Fault]| faults[0].position_mm();
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

    /// Vertices and edges along the lines through the ink of a part that was cut.
    pub(super) fn inside(&self, part: &Part) -> Inside {
        let outline = Outline::new(part);
        let mut vertices = outline.vertices.clone();
        let mut edges = Vec::new();
        // Where level lines cross upright ones.
        let mut crossings: Vec<u32> = Vec::new();
        let mut on = outline.on(&self.upright, |p| p.x);
        on.sort_unstable_by_key(|&(v, _)| vertices[v as usize]);
        for [from, to] in outline.spans(&on, |v| outline.vertices[v as usize].x) {
            let [a, b] = [from, to].map(|v| vertices[v as usize]);
            let mut last = from;
            for &y in between(&self.level, a.y, b.y) {
                let next = vertices.len() as u32;
                vertices.push(GridPoint::new(a.x, y));
                crossings.push(next);
                edges.push([last, next]);
                last = next;
            }
            edges.push([last, to]);
        }
        let mut on = outline.on(&self.level, |p| p.y);
        on.extend(crossings.into_iter().map(|v| (v, false)));
        on.sort_unstable_by_key(|&(v, _)| (vertices[v as usize].y, vertices[v as usize].x));
        edges.extend(outline.spans(&on, |v| vertices[v as usize].y));
        Inside { vertices, edges }
    }
}

/// The outline of a part that was cut.
struct Outline {
    vertices: Vec<GridPoint>,
    /// The vertices before and after each.
    beside: Vec<[u32; 2]>,
}

impl Outline {
    fn new(part: &Part) -> Self {
        let vertices = part.contours().flat_map(|c| c.points()).copied().collect();
        let mut beside = Vec::new();
        for contour in part.contours() {
            let (first, n) = (beside.len() as u32, contour.points().len() as u32);
            beside.extend((0..n).map(|i| [first + (i + n - 1) % n, first + (i + 1) % n]));
        }
        Self { vertices, beside }
    }

    /// The vertices on lines, and whether the outline comes to the other side there. Where it runs along a line for a while, as rounding may
    /// have it, that is at the last vertex of the run.
    fn on(&self, lines: &[i64], across: fn(&GridPoint) -> i64) -> Vec<(u32, bool)> {
        let place = |v: u32| across(&self.vertices[v as usize]);
        let comes_over = |v: u32| {
            let here = place(v);
            let [mut before, after] = self.beside[v as usize];
            while place(before) == here && before != v {
                before = self.beside[before as usize][0];
            }
            place(after) != here && (place(before) < here) != (place(after) < here)
        };
        let all = (0..self.vertices.len() as u32).filter(|&v| lines.binary_search(&place(v)).is_ok());
        all.map(|v| (v, comes_over(v))).collect()
    }

    /// Edges through the ink between vertices on lines, in the order of lines and along them: those between which there is ink, and that are no edges of
    /// the outline.
    fn spans<'s>(
        &'s self,
        on: &'s [(u32, bool)],
        line: impl Fn(u32) -> i64 + Copy + 's,
    ) -> impl Iterator<Item = [u32; 2]> + 's {
        let is_edge = |a: u32, b: u32| self.beside.get(a as usize).is_some_and(|beside| beside.contains(&b));
        on.chunk_by(move |a, b| line(a.0) == line(b.0)).flat_map(move |line| {
            let mut is_ink = false;
            line.windows(2).filter_map(move |pair| {
                is_ink ^= pair[0].1;
                let [a, b] = [pair[0].0, pair[1].0];
                (is_ink && !is_edge(a, b)).then_some([a, b])
            })
        })
    }
}

/// The places of `lines` that lie truly between two others, in whichever order those are.
fn between(lines: &[i64], a: i64, b: i64) -> &[i64] {
    let (low, high) = (a.min(b), a.max(b));
    let from = lines.partition_point(|&x| x <= low);
    let to = lines.partition_point(|&x| x < high);
    &lines[from..to.max(from)]
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
fn at_upright(a: GridPoint, b: GridPoint, x: i64) -> GridPoint {
    GridPoint::new(x, a.y + along(x - a.x, b.x - a.x, b.y - a.y))
}

/// Where the edge crosses the level line at `y`, rounded to the grid.
fn at_level(a: GridPoint, b: GridPoint, y: i64) -> GridPoint {
    GridPoint::new(a.x + along(y - a.y, b.y - a.y, b.x - a.x), y)
}

/// `rise` for the part `step` of `run`, rounded to the nearest. Halves are rounded up where the other end begins too: whichever way
/// an edge runs, it crosses a line in the same place.
fn along(step: i64, run: i64, rise: i64) -> i64 {
    let (part, run) = (i128::from(step) * i128::from(rise), i128::from(run));
    let (part, run) = if run < 0 { (-part, -run) } else { (part, run) };
    (2 * part + run).div_euclid(2 * run) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_do_not_depend_on_the_direction() {
        let (a, b) = (GridPoint::new(-7, 3), GridPoint::new(12, -40));
        for x in -6..12 {
            assert_eq!(at_upright(a, b, x), at_upright(b, a, x));
        }
        for y in -39..3 {
            assert_eq!(at_level(a, b, y), at_level(b, a, y));
        }
        let (a, b) = (GridPoint::new(0, 0), GridPoint::new(2, 1));
        assert_eq!(at_upright(a, b, 1), GridPoint::new(1, 1));
    }
}
