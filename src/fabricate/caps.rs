//! Exact triangulation of one component: the one adapter to i_triangle.
//!
//! Its integer API keeps every boundary vertex when both preserve flags are set, collinear ones included;
//! engines that drop those leave slits where a wall meets the cap. The monotone triangulation is refined to
//! a Delaunay one, which is what keeps slivers out: a cap is read back by programs that drop triangles of
//! nearly no area. The result is not trusted: it is compared with the component in exact arithmetic, so that
//! a fault of the engine is an error and never a leaking solid. `uncheck_triangulate` of the same crate is
//! unsound and stays out.

use i_triangle::i_overlay::core::fill_rule::FillRule;
use i_triangle::i_overlay::core::overlay::IntOverlayOptions;
use i_triangle::i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::custom::IntCustomTriangulatable;
use i_triangle::int::validation::Validation;
use rustc_hash::FxHashMap;

use crate::planar::{GridPoint, Part};

/// Counter-clockwise triangles that cover `part` exactly, as indices into its vertices in the order of
/// [`Part::contours`].
///
/// # Errors
/// What was wrong with the engine's triangles.
pub(super) fn triangulate(part: &Part) -> Result<Vec<[u32; 3]>, &'static str> {
    let shape: Vec<Vec<IntPoint<i64>>> =
        part.contours().map(|c| c.points().iter().map(|p| IntPoint { x: p.x, y: p.y }).collect()).collect();
    let validation =
        Validation { fill_rule: FillRule::NonZero, options: IntOverlayOptions::keep_all_points() };
    let delaunay = shape.custom_triangulate(validation).into_delaunay();

    let vertices: Vec<GridPoint> = part.contours().flat_map(|c| c.points()).copied().collect();
    let numbers: FxHashMap<GridPoint, u32> = vertices.iter().copied().zip(0..).collect();
    // The engine numbers points in its own order.
    let renumber: Option<Vec<u32>> =
        delaunay.points().iter().map(|p| numbers.get(&GridPoint::new(p.x, p.y)).copied()).collect();
    let renumber = renumber.ok_or("a vertex that the component does not have")?;
    let triangles: Vec<[u32; 3]> = delaunay
        .triangle_indices::<u32>()
        .chunks_exact(3)
        .map(|t| [0, 1, 2].map(|k| renumber[t[k] as usize]))
        .collect();
    check(part, &vertices, &triangles)?;
    Ok(triangles)
}

/// Whether `triangles` are a triangulation of `part` without new or lost vertices: all of positive area,
/// of the right number and total area, meeting in pairs along inner edges, and alone along the part's own.
/// Exact.
fn check(part: &Part, vertices: &[GridPoint], triangles: &[[u32; 3]]) -> Result<(), &'static str> {
    if triangles.len() + 2 != vertices.len() + 2 * part.holes().len() {
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
