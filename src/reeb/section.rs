//! Vertical cross-sections of a region: where a line x = c meets the contours, from top to bottom.

use std::cmp::Ordering;

use glam::DVec2;

use crate::planar::{Contour, Grid, GridPoint, Region};

/// Where a contour crosses a vertical line: one portal endpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The contour, counted in the order of [`Region::contours`].
    pub contour: usize,
    /// The edge of the contour: from vertex `edge` to the next.
    pub edge: usize,
    /// The height in millimetres.
    pub y_mm: f64,
    /// The unit tangent of the contour here, turned to point right (x > 0). On an edge between smooth vertices
    /// it is interpolated between theirs, so that it is the tangent of the curve that was flattened.
    pub tangent: DVec2,
}

#[derive(Clone, Copy)]
struct Edge {
    contour: usize,
    edge: usize,
    left: GridPoint,
    right: GridPoint,
}

/// The edges of a region, ready to be cut by vertical lines.
pub struct CrossSections<'a> {
    grid: Grid,
    contours: Vec<&'a Contour>,
    /// Edges that are not vertical, by their left end.
    edges: Vec<Edge>,
    /// All x at which there is a vertex, ascending.
    vertex_xs: Vec<i64>,
}

impl<'a> CrossSections<'a> {
    /// Prepares `region`.
    pub fn new(region: &'a Region) -> Self {
        let mut edges = Vec::with_capacity(region.vertices());
        let mut vertex_xs = Vec::with_capacity(region.vertices());
        for (contour, c) in region.contours().enumerate() {
            for (edge, (a, b)) in c.edges().enumerate() {
                vertex_xs.push(a.x);
                if a.x != b.x {
                    edges.push(Edge { contour, edge, left: a.min(b), right: a.max(b) });
                }
            }
        }
        edges.sort_unstable_by_key(|e| (e.left, e.contour, e.edge));
        vertex_xs.sort_unstable();
        vertex_xs.dedup();
        Self { grid: region.grid(), contours: region.contours().collect(), edges, vertex_xs }
    }

    /// The x nearest to `x` and strictly between `low` and `high` on which no vertex lies, if there is one.
    pub fn clear_of_vertices(&self, x: i64, low: i64, high: i64) -> Option<i64> {
        let is_free = |x: i64| low < x && x < high && self.vertex_xs.binary_search(&x).is_err();
        // Vertices at d consecutive steps would have to lie on each side of x.
        (0..=self.vertex_xs.len() as i64).flat_map(|d| [x + d, x - d]).take(4096).find(|&x| is_free(x))
    }

    /// Whether some vertex lies strictly between two abscissas.
    pub fn has_vertex_between(&self, low: i64, high: i64) -> bool {
        let next = self.vertex_xs.partition_point(|&x| x <= low);
        self.vertex_xs.get(next).is_some_and(|&x| x < high)
    }

    /// The crossings at each of `xs`, which ascend and lie on no vertex; each section from top to bottom.
    pub fn at(&self, xs: &[i64]) -> Vec<Vec<Crossing>> {
        let mut active: Vec<Edge> = Vec::new();
        let mut pending = self.edges.iter().peekable();
        let mut sections = Vec::with_capacity(xs.len());
        for &x in xs {
            debug_assert!(self.vertex_xs.binary_search(&x).is_err(), "a cut may not pass through a vertex");
            active.retain(|e| e.right.x > x);
            while let Some(e) = pending.next_if(|e| e.left.x < x) {
                if e.right.x > x {
                    active.push(*e);
                }
            }
            active.sort_by(|a, b| height_order(b, a, x));
            sections.push(active.iter().map(|e| self.crossing(e, x)).collect());
        }
        sections
    }

    fn crossing(&self, e: &Edge, x: i64) -> Crossing {
        let (dx, dy) = ((e.right.x - e.left.x) as f64, (e.right.y - e.left.y) as f64);
        let t = (x - e.left.x) as f64 / dx;
        let smooth = edge_tangent(self.contours[e.contour].points(), e.edge, x);
        let tangent = if smooth.x > 0.0 { smooth } else { DVec2::new(dx, dy) };
        Crossing {
            contour: e.contour,
            edge: e.edge,
            y_mm: self.grid.mm(e.left.y) + dy * t * self.grid.step_mm(),
            tangent: tangent.normalize(),
        }
    }
}

/// Compares the heights of two edges at `x`, exactly; both cross it.
fn height_order(a: &Edge, b: &Edge, x: i64) -> Ordering {
    // y = left.y + dy (x - left.x) / dx; all factors stay below 2^35, their products below 2^107.
    let height = |e: &Edge| {
        let dx = i128::from(e.right.x - e.left.x);
        let dy = i128::from(e.right.y - e.left.y);
        (i128::from(e.left.y) * dx + dy * i128::from(x - e.left.x), dx)
    };
    let ((an, ad), (bn, bd)) = (height(a), height(b));
    (an * bd).cmp(&(bn * ad))
}

/// The largest turn at a vertex that still counts as smooth (cosine of 30 degrees): flattening within a chord
/// error makes smaller turns, drawn corners are larger.
const SMOOTH_COS: f64 = 0.866;

/// The tangent on edge `edge` of a closed polygon at abscissa `x`, pointing right.
fn edge_tangent(points: &[GridPoint], edge: usize, x: i64) -> DVec2 {
    let n = points.len();
    let at = |i: usize| {
        let p = points[i % n];
        DVec2::new(p.x as f64, p.y as f64)
    };
    let (a, b) = (at(edge), at(edge + 1));
    let along = (b - a).normalize();
    let vertex = |before: DVec2, after: DVec2| {
        let (before, after) = (before.normalize(), after.normalize());
        if before.dot(after) > SMOOTH_COS { (before + after).normalize() } else { along }
    };
    let (from, to) = (vertex(a - at(edge + n - 1), b - a), vertex(b - a, at(edge + 2) - b));
    let t = (x as f64 - a.x) / (b.x - a.x);
    let tangent = from.lerp(to, t);
    if b.x > a.x { tangent } else { -tangent }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::FillRule;

    #[test]
    fn sections_come_from_top_to_bottom_and_avoid_vertices() {
        let grid = Grid::for_extent(100.0).unwrap();
        let path = |points: &[(i64, i64)]| points.iter().map(|&(x, y)| GridPoint::new(x, y)).collect();
        let paths: Vec<Vec<GridPoint>> = vec![
            path(&[(0, 0), (1000, 100), (1000, 900), (0, 800)]),
            path(&[(300, 300), (301, 400), (600, 350)]),
        ];
        let region = Region::fill(grid, &paths, FillRule::EvenOdd);
        let sections = CrossSections::new(&region);
        let x = sections.clear_of_vertices(300, 0, 1000).unwrap();
        assert!(x == 299 || x == 302, "{x}");
        let found = sections.at(&[299, 450]);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 4]);
        assert!(found[1].windows(2).all(|w| w[0].y_mm > w[1].y_mm));
        assert!((found[0][0].y_mm - grid.mm(800) - 29.9 * grid.step_mm()).abs() < 1e-9);
        assert!(found[1].iter().all(|c| c.tangent.x > 0.0 && (c.tangent.length() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn no_room_between_vertices_is_no_place() {
        let grid = Grid::for_extent(100.0).unwrap();
        let path = [(0, 0), (1, -9), (2, 0), (1, 9)].map(|(x, y)| GridPoint::new(x, y)).to_vec();
        let region = Region::fill(grid, &[path], FillRule::EvenOdd);
        assert_eq!(CrossSections::new(&region).clear_of_vertices(1, 0, 2), None);
    }
}
