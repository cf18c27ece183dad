//! Where closed polylines meet themselves or each other.

use std::cmp::Ordering;

use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

use crate::planar::{Grid, GridError, GridPoint, orient};

/// A point of a band's border with its place along the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BorderPoint {
    /// Along the curve, in mm.
    pub u: f64,
    /// In the plane, in mm.
    pub point: DVec2,
}

/// Two places of a border that meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    /// Where, in mm.
    pub position: DVec2,
    /// Both places along the curve in mm, the lesser first.
    pub u: [f64; 2],
}

struct Edge {
    border: usize,
    /// Its place in the border.
    index: usize,
    u: f64,
    from: GridPoint,
    to: GridPoint,
    envelope: AABB<[f64; 2]>,
}

impl RTreeObject for Edge {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        self.envelope
    }
}

/// The meeting of closed polylines, with themselves or each other, that comes first along u; decided exactly
/// after snapping to the grid. Points of different borders, or of one border at different places, must not
/// even touch.
///
/// # Errors
/// [`GridError`] for points out of range.
pub(super) fn first_meeting(borders: &[Vec<BorderPoint>]) -> Result<Option<Meeting>, GridError> {
    let points = || borders.iter().flatten().map(|p| p.point);
    let extent = points().fold(Grid::MIN_EXTENT_MM, |e, p| e.max(p.abs().max_element()));
    let grid = Grid::for_extent(extent)?;
    let mut edges = Vec::new();
    let mut sizes = Vec::with_capacity(borders.len());
    for (border, points) in borders.iter().enumerate() {
        let size = push_edges(grid, border, points, &mut edges)?;
        sizes.push(size);
    }
    let tree = RTree::bulk_load(edges);
    let mut first: Option<Meeting> = None;
    for a in tree.iter() {
        for b in tree.locate_in_envelope_intersecting(a.envelope) {
            let ordered = (a.border, a.index) < (b.border, b.index);
            if !ordered || are_neighbours(a, b, sizes[a.border]) || !meet(a, b) {
                continue;
            }
            let u = [a.u.min(b.u), a.u.max(b.u)];
            if first.is_none_or(|f| u < f.u) {
                first = Some(Meeting { position: meeting_point(grid, a, b), u });
            }
        }
    }
    Ok(first)
}

/// Appends the edges of a border that have a length after snapping, and returns how many there are.
fn push_edges(
    grid: Grid,
    border: usize,
    points: &[BorderPoint],
    edges: &mut Vec<Edge>,
) -> Result<usize, GridError> {
    let snapped: Result<Vec<_>, _> = points.iter().map(|p| Ok((p.u, grid.snap(p.point)?))).collect();
    let mut snapped = snapped?;
    snapped.dedup_by_key(|p| p.1);
    for (index, &(u, from)) in snapped.iter().enumerate() {
        let (_, to) = snapped[(index + 1) % snapped.len()];
        let envelope = AABB::from_corners(grid.to_mm(from).to_array(), grid.to_mm(to).to_array());
        edges.push(Edge { border, index, u, from, to, envelope });
    }
    Ok(snapped.len())
}

fn are_neighbours(a: &Edge, b: &Edge, size: usize) -> bool {
    a.border == b.border && (b.index - a.index == 1 || b.index - a.index + 1 == size)
}

/// Whether two edges share a point, ends included.
fn meet(a: &Edge, b: &Edge) -> bool {
    let sides = [orient(a.from, a.to, b.from), orient(a.from, a.to, b.to)];
    let other = [orient(b.from, b.to, a.from), orient(b.from, b.to, a.to)];
    if sides == [Ordering::Equal; 2] {
        // On one line the ranges along it decide.
        let (a0, a1) = (a.from.min(a.to), a.from.max(a.to));
        let (b0, b1) = (b.from.min(b.to), b.from.max(b.to));
        return a0 <= b1 && b0 <= a1;
    }
    sides[0] != sides[1] && other[0] != other[1]
}

/// The point where two edges that meet do so, near enough for a message.
fn meeting_point(grid: Grid, a: &Edge, b: &Edge) -> DVec2 {
    let [p, q, r, s] = [a.from, a.to, b.from, b.to].map(|p| grid.to_mm(p));
    let (d, e) = (q - p, s - r);
    let across = d.perp_dot(e);
    if across == 0.0 { p } else { p + d * ((r - p).perp_dot(e) / across).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn border(points: &[(f64, f64)]) -> Vec<BorderPoint> {
        let point = |(i, &(x, y)): (usize, &(f64, f64))| BorderPoint { u: i as f64, point: DVec2::new(x, y) };
        points.iter().enumerate().map(point).collect()
    }

    #[test]
    fn a_square_meets_nothing() {
        let square = border(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let inner = border(&[(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)]);
        assert_eq!(first_meeting(&[square, inner]), Ok(None));
    }

    #[test]
    fn crossings_and_touches_are_named() {
        let bow = border(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)]);
        let found = first_meeting(&[bow]).unwrap().unwrap();
        assert_eq!(found, Meeting { position: DVec2::new(2.0, 2.0), u: [0.0, 2.0] });
        let square = border(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
        let touching = border(&[(4.0, 2.0), (6.0, 1.0), (6.0, 3.0)]);
        let found = first_meeting(&[square, touching]).unwrap().unwrap();
        assert_eq!(found.position, DVec2::new(4.0, 2.0));
    }

    #[test]
    fn edges_on_one_line_meet_only_where_they_overlap() {
        let u_shape = |gap: f64| {
            border(&[(0.0, 0.0), (9.0, 0.0), (9.0, 2.0), (5.0 + gap, 0.0), (5.0 + gap, 3.0), (0.0, 3.0)])
        };
        assert!(first_meeting(&[u_shape(0.0)]).unwrap().is_some());
        let apart =
            border(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (3.0, 1.0), (3.0, 0.0), (5.0, 0.0), (5.0, 3.0)]);
        assert_eq!(first_meeting(&[apart]), Ok(None));
    }
}
