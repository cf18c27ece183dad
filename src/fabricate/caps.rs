//! Exact triangulation of one component: the one adapter to i_triangle, and to spade for wide components.
//!
//! The integer API of i_triangle keeps every boundary vertex when both preserve flags are set, collinear ones included;
//! engines that drop those leave slits where a wall meets the cap. Edges of its monotone triangulation are flipped until it is
//! a Delaunay one, which is what keeps slivers out: a cap is read back by programs that drop triangles of
//! nearly no area. A strand takes hardly any flips; a wide disc takes the more for each triangle the more vertices it
//! has. So flips have a limit, beyond which the triangulation is made by spade, which is slower for strands, and not for
//! discs. The result is not trusted: it is compared with the component in exact arithmetic, so that a fault of an engine is
//! an error and never a leaking solid. `uncheck_triangulate` of i_triangle is unsound and stays out.

use i_triangle::advanced::delaunay::DelaunayRefine;
use i_triangle::geom::point::IndexPoint;
use i_triangle::geom::triangle::IntTriangle;
use i_triangle::i_overlay::core::fill_rule::FillRule;
use i_triangle::i_overlay::core::overlay::IntOverlayOptions;
use i_triangle::i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::custom::IntCustomTriangulatable;
use i_triangle::int::triangulation::RawIntTriangulation;
use i_triangle::int::validation::Validation;
use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::planar::{GridPoint, Part};

/// Flips for each triangle, on average, after which it is left to the other engine. Strands take one or two. More, and
/// wide components wait for what is thrown away; fewer, and strands take three times as long.
const FLIPS: usize = 6;

/// Counter-clockwise triangles that cover `part` exactly, as indices into its vertices in the order of
/// [`Part::contours`].
///
/// # Errors
/// What was wrong with the engine's triangles.
pub(super) fn triangulate(part: &Part) -> Result<Vec<[u32; 3]>, &'static str> {
    let vertices: Vec<GridPoint> = part.contours().flat_map(|c| c.points()).copied().collect();
    let triangles = match flipped(part, &vertices, FLIPS)? {
        Some(triangles) => triangles,
        None => constrained(part, &vertices, &[])?,
    };
    check(part, &vertices, &triangles)?;
    Ok(triangles)
}

/// The same with more `vertices` after those of the outline, inside of the part, and with `inner` edges, by the numbers of vertices, among
/// those of the triangles. They cross neither each other nor the part's outline.
///
/// # Errors
/// What was wrong with the engine's triangles.
pub(super) fn triangulate_along(
    part: &Part,
    vertices: &[GridPoint],
    inner: &[[u32; 2]],
) -> Result<Vec<[u32; 3]>, &'static str> {
    let triangles = constrained(part, vertices, inner)?;
    check(part, vertices, &triangles)?;
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let sides: FxHashSet<[u32; 2]> = sides.collect();
    match inner.iter().all(|&[a, b]| sides.contains(&[a, b]) && sides.contains(&[b, a])) {
        true => Ok(triangles),
        false => Err("an inner edge that no triangle has"),
    }
}

/// The triangles of i_triangle; `None` when they take more than `limit` flips each.
fn flipped(part: &Part, vertices: &[GridPoint], limit: usize) -> Result<Option<Vec<[u32; 3]>>, &'static str> {
    let shape: Vec<Vec<IntPoint<i64>>> =
        part.contours().map(|c| c.points().iter().map(|p| IntPoint { x: p.x, y: p.y }).collect()).collect();
    let validation =
        Validation { fill_rule: FillRule::NonZero, options: IntOverlayOptions::keep_all_points() };
    let monotone = shape.custom_triangulate(validation);
    let Some(triangles) = delaunay(&monotone, limit) else { return Ok(None) };
    let numbers: FxHashMap<GridPoint, u32> = vertices.iter().copied().zip(0..).collect();
    // The engine numbers points in its own order.
    let renumber: Option<Vec<u32>> =
        monotone.points().iter().map(|p| numbers.get(&GridPoint::new(p.x, p.y)).copied()).collect();
    let renumber = renumber.ok_or("a vertex that the component does not have")?;
    Ok(Some(triangles.into_iter().map(|t| t.map(|v| renumber[v])).collect()))
}

/// The Delaunay triangulation of the same points; `None` when it takes more than `limit` flips for each triangle.
fn delaunay(monotone: &RawIntTriangulation<i64>, limit: usize) -> Option<Vec<[usize; 3]>> {
    let point = |index: u32| IndexPoint { index: index as usize, point: monotone.points()[index as usize] };
    let corners = monotone.triangle_indices::<u32>();
    let with_neighbors = corners.chunks_exact(3).zip(monotone.triangle_neighbors());
    let mut triangles: Vec<IntTriangle<i64>> = with_neighbors
        .map(|(t, neighbors)| IntTriangle { vertices: [t[0], t[1], t[2]].map(point), neighbors })
        .collect();
    let mut flips_left = limit * triangles.len();
    // In the order of their numbers, over and over: those of which a neighbour was flipped since they were looked at.
    let mut waiting: Vec<usize> = (0..triangles.len()).collect();
    let mut is_waiting = vec![true; triangles.len()];
    while !waiting.is_empty() {
        let mut next = Vec::new();
        for t in waiting {
            while let Some(other) = flip(&mut triangles, t) {
                flips_left = flips_left.checked_sub(1)?;
                is_waiting[other] = true;
                next.push(other);
            }
            is_waiting[t] = false;
        }
        next.retain(|&t| is_waiting[t]);
        next.sort_unstable();
        next.dedup();
        waiting = next;
    }
    Some(triangles.into_iter().map(|t| t.vertices.map(|v| v.index)).collect())
}

/// Flips one edge of a triangle that needs it; the triangle beyond.
fn flip(triangles: &mut [IntTriangle<i64>], t: usize) -> Option<usize> {
    let neighbors = triangles[t].neighbors;
    neighbors.into_iter().find(|&other| other < triangles.len() && triangles.swap_triangles(t, other))
}

/// The triangles of spade. Numbers of the grid of a solid are exact in its floats, and so are its predicates.
fn constrained(
    part: &Part,
    vertices: &[GridPoint],
    inner: &[[u32; 2]],
) -> Result<Vec<[u32; 3]>, &'static str> {
    let is_inner: FxHashSet<[u32; 2]> = inner.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    let mut edges = Vec::with_capacity(vertices.len() + inner.len());
    let mut start = 0;
    for contour in part.contours() {
        let n = contour.points().len();
        edges.extend((0..n).map(|i| [start + i, start + (i + 1) % n]));
        start += n;
    }
    edges.extend(inner.iter().map(|edge| edge.map(|v| v as usize)));
    let points = vertices.iter().map(|p| Point2::new(p.x as f64, p.y as f64)).collect();
    let mut conflicts = 0;
    let mesh =
        ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(points, edges, |_| conflicts += 1)
            .map_err(|_| "a coordinate out of range")?;
    if conflicts > 0 || mesh.num_vertices() != vertices.len() {
        return Err("contours that meet");
    }
    // From face to face, beginning outside: every edge of a contour that is crossed changes sides.
    let mut is_ink = vec![false; mesh.num_all_faces()];
    let mut is_seen = vec![false; mesh.num_all_faces()];
    is_seen[mesh.outer_face().index()] = true;
    let mut stack: Vec<_> = mesh.convex_hull().map(|edge| edge.rev().fix()).collect();
    while let Some(entered) = stack.pop() {
        let entered = mesh.directed_edge(entered);
        let (face, behind) = (entered.face().index(), entered.rev().face().index());
        if std::mem::replace(&mut is_seen[face], true) {
            continue;
        }
        let [a, b] = entered.vertices().map(|v| v.index() as u32);
        let is_outline = entered.is_constraint_edge() && !is_inner.contains(&[a.min(b), a.max(b)]);
        is_ink[face] = is_ink[behind] != is_outline;
        stack.extend([entered.next(), entered.prev()].map(|edge| edge.rev().fix()));
    }
    let ink = mesh.inner_faces().filter(|face| is_ink[face.index()]);
    Ok(ink.map(|face| face.vertices().map(|v| v.index() as u32)).collect())
}

/// Whether `triangles` are a triangulation of `part` with these vertices, those of its outline first, and no others: all of positive
/// area, of the right number and total area, meeting in pairs along inner edges, and alone along the part's own. Exact.
fn check(part: &Part, vertices: &[GridPoint], triangles: &[[u32; 3]]) -> Result<(), &'static str> {
    let outline: usize = part.contours().map(|c| c.points().len()).sum();
    if triangles.len() + 2 != 2 * vertices.len() - outline + 2 * part.holes().len() {
        return Err("a wrong number of triangles");
    }
    let mut area = 0;
    let mut sides = Vec::with_capacity(3 * triangles.len() + vertices.len());
    for t in triangles {
        let doubled = doubled_area(t.map(|i| vertices[i as usize]));
        if doubled <= 0 {
            return Err("a triangle without area");
        }
        area += doubled;
        sides.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    }
    if area != part.contours().map(|c| c.doubled_area()).sum::<i128>() {
        return Err("a wrong total area");
    }
    // Beyond its own edges the part has a neighbour that is not there.
    let mut start = 0;
    for contour in part.contours() {
        let n = contour.points().len() as u32;
        sides.extend((0..n).map(|i| (start + (i + 1) % n, start + i)));
        start += n;
    }
    check_pairs(vertices.len(), &sides)
}

/// Whether every edge is used once in each direction. Edges are gathered by their lower end, as a table of all would take
/// longer than the triangulation.
fn check_pairs(vertices: usize, sides: &[(u32, u32)]) -> Result<(), &'static str> {
    let lower = |&(from, to): &(u32, u32)| from.min(to) as usize;
    let mut begin = vec![0usize; vertices + 1];
    sides.iter().for_each(|side| begin[lower(side) + 1] += 1);
    for i in 0..vertices {
        begin[i + 1] += begin[i];
    }
    let mut next = begin.clone();
    // The higher end, and whether the edge runs towards it.
    let mut uses = vec![(0u32, false); sides.len()];
    for side @ &(from, to) in sides {
        let place = &mut next[lower(side)];
        uses[*place] = (from.max(to), from < to);
        *place += 1;
    }
    for range in begin.windows(2) {
        let fan = &mut uses[range[0]..range[1]];
        fan.sort_unstable();
        for edge in fan.chunk_by(|a, b| a.0 == b.0) {
            match edge {
                [(_, false), (_, true)] => {}
                [_] => return Err("an open edge"),
                _ => return Err("two triangles on one side of an edge"),
            }
        }
    }
    Ok(())
}

fn doubled_area([a, b, c]: [GridPoint; 3]) -> i128 {
    let (abx, aby) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (acx, acy) = (i128::from(c.x - a.x), i128::from(c.y - a.y));
    abx * acy - aby * acx
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{Contour, Grid, Region};

    fn part(contours: &[&[(i64, i64)]]) -> Part {
        let contours = contours
            .iter()
            .map(|c| Contour::new(c.iter().map(|&(x, y)| GridPoint::new(x, y)).collect()).unwrap())
            .collect();
        let region = Region::from_contours(Grid::for_extent(100.0).unwrap(), contours).unwrap();
        region.parts()[0].clone()
    }

    #[test]
    fn collinear_vertices_stay() {
        let comb: Vec<(i64, i64)> = (0..=50).map(|x| (x * 10, 0)).chain([(500, 70), (0, 70)]).collect();
        assert_eq!(triangulate(&part(&[&comb])).unwrap().len(), 51);
    }

    #[test]
    fn holes_with_collinear_vertices_stay() {
        let outer = [(0, 0), (10, 0), (20, 0), (30, 0), (30, 30), (15, 30), (0, 30)];
        let hole = [(10, 10), (10, 15), (10, 20), (20, 20), (20, 10), (15, 10)];
        assert_eq!(triangulate(&part(&[&outer, &hole])).unwrap().len(), 7 + 6);
    }

    /// A disc with a tooth for each of so many vertices, and a hole that is like it.
    fn toothed(teeth: i64) -> Part {
        let around = |radius: f64, sense: f64| -> Vec<(i64, i64)> {
            let at = |i: i64| {
                let turn = sense * std::f64::consts::TAU * i as f64 / teeth as f64;
                let radius = radius * if i % 2 == 0 { 1.0 } else { 0.97 };
                ((radius * turn.cos()) as i64, (radius * turn.sin()) as i64)
            };
            (0..teeth).map(at).collect()
        };
        part(&[&around(9e6, 1.0), &around(2e6, -1.0)])
    }

    #[test]
    fn both_engines_find_the_delaunay_triangulation() {
        let part = toothed(600);
        let vertices: Vec<GridPoint> = part.contours().flat_map(|c| c.points()).copied().collect();
        let sorted = |mut triangles: Vec<[u32; 3]>| {
            // From the least corner on.
            for t in &mut triangles {
                let [a, b, c] = *t;
                let least = if a < b && a < c { 0 } else { 1 + usize::from(c < b) };
                t.rotate_left(least);
            }
            triangles.sort_unstable();
            triangles
        };
        assert_eq!(flipped(&part, &vertices, 0).unwrap(), None);
        let flipped = flipped(&part, &vertices, 1000).unwrap().unwrap();
        let constrained = constrained(&part, &vertices, &[]).unwrap();
        assert_eq!(check(&part, &vertices, &flipped), Ok(()));
        assert_eq!(check(&part, &vertices, &constrained), Ok(()));
        let (flipped, constrained) = (sorted(flipped), sorted(constrained));
        // But for points on one circle, of which rounding leaves hardly any.
        let common = flipped.iter().filter(|t| constrained.binary_search(t).is_ok()).count();
        assert!(common * 100 >= 99 * flipped.len(), "{common} of {}", flipped.len());
    }

    #[test]
    fn the_check_sees_every_kind_of_fault() {
        let square = part(&[&[(0, 0), (4, 0), (4, 4), (0, 4)]]);
        let vertices: Vec<GridPoint> = square.exterior().points().to_vec();
        let good = [[0, 1, 2], [0, 2, 3]];
        assert_eq!(check(&square, &vertices, &good), Ok(()));
        assert_eq!(check(&square, &vertices, &good[..1]), Err("a wrong number of triangles"));
        let turned = [[0, 2, 1], [0, 2, 3]];
        assert_eq!(check(&square, &vertices, &turned), Err("a triangle without area"));
        let twice = [[0, 1, 2], [0, 1, 2]];
        assert_eq!(check(&square, &vertices, &twice), Err("two triangles on one side of an edge"));
        let overlapping = [[0, 1, 2], [1, 2, 3]];
        assert!(check(&square, &vertices, &overlapping).is_err());
    }
}
