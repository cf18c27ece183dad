//! Pulling ink apart where it touches itself in a single point.
//!
//! An overlay may return contours that share vertices. A point of contact holds nothing together in any
//! material, and it makes an extruded solid non-manifold (an edge with four facets), so a region has none.
//! Around such a vertex the ink is a fan of wedges. The contours are rewired so that each wedge is passed by
//! itself, and every wedge but the widest has its tip cut off by a chord: ink is only ever removed, within
//! [`RETREAT_STEPS`] grid steps of the vertex. Excluded here: contours that cross, which an overlay does not
//! return.

use std::cmp::Ordering;

use rustc_hash::{FxHashMap, FxHashSet};

use super::grid::{GridPoint, orient};
use super::overlay::{self, FillRule, RawPart};
use super::region::Part;

/// How far the ink retreats from a point of contact, in grid steps (30 micrometres per metre of extent at
/// most). Fewer, and rounding could turn the cut tip over; more, and the cut would show.
const RETREAT_STEPS: f64 = 1024.0;
/// Rounds of cutting: a cut can bring a vertex to rest on a neighbouring edge, which the next round mends.
const MAX_ROUNDS: usize = 8;

/// Parts whose contours share no vertex, from parts that may.
pub(super) fn pull_apart(mut raw: Vec<RawPart>) -> Vec<Part> {
    for round in 0..MAX_ROUNDS {
        let shared = shared_vertices(&raw);
        if shared.is_empty() {
            break;
        }
        // Each round cuts less deep, so that cuts cannot go on meeting each other.
        let retreat = RETREAT_STEPS / f64::from(1 << round);
        let paths = rewire(&raw, &shared, retreat);
        raw = overlay::fill(paths.iter().map(Vec::as_slice), FillRule::Positive);
    }
    raw.into_iter().map(Part::from_raw).collect()
}

fn shared_vertices(parts: &[RawPart]) -> FxHashSet<GridPoint> {
    let mut seen = FxHashSet::default();
    let points = parts.iter().flatten().flat_map(|c| c.points());
    points.filter(|&&p| !seen.insert(p)).copied().collect()
}

/// A directed edge with the ink on its left.
#[derive(Clone, Copy)]
struct Edge {
    from: GridPoint,
    to: GridPoint,
}

fn rewire(parts: &[RawPart], shared: &FxHashSet<GridPoint>, retreat: f64) -> Vec<Vec<GridPoint>> {
    let edges: Vec<Edge> =
        parts.iter().flatten().flat_map(|c| c.edges().map(|(from, to)| Edge { from, to })).collect();
    let mut leaving: FxHashMap<GridPoint, Vec<usize>> = FxHashMap::default();
    let mut arriving: FxHashMap<GridPoint, Vec<usize>> = FxHashMap::default();
    for (i, e) in edges.iter().enumerate() {
        leaving.entry(e.from).or_default().push(i);
        arriving.entry(e.to).or_default().push(i);
    }
    // The successor of each edge, and the points that stand for the vertex between the two.
    let mut next = vec![usize::MAX; edges.len()];
    let mut corner: Vec<Vec<GridPoint>> = vec![Vec::new(); edges.len()];
    for (&v, arrivals) in &arriving {
        if !shared.contains(&v) {
            next[arrivals[0]] = leaving[&v][0];
            corner[arrivals[0]] = vec![v];
            continue;
        }
        // Turning clockwise from the reversed arriving edge crosses ink until the first leaving edge.
        let wedges: Vec<(usize, usize)> = arrivals
            .iter()
            .map(|&a| {
                let back = edges[a].from;
                let closest = |&x: &usize, &y: &usize| clockwise_order(v, back, edges[x].to, edges[y].to);
                (a, leaving[&v].iter().copied().min_by(closest).expect("as many leave as arrive"))
            })
            .collect();
        let reflex =
            wedges.iter().find(|&&(a, l)| orient(edges[a].from, v, edges[l].to) != Ordering::Greater);
        for &(a, l) in &wedges {
            next[a] = l;
            corner[a] = if Some(&(a, l)) == reflex {
                vec![v]
            } else {
                vec![towards(v, edges[a].from, retreat), towards(v, edges[l].to, retreat)]
            };
        }
    }
    let mut done = vec![false; edges.len()];
    let mut paths = Vec::new();
    for start in 0..edges.len() {
        let mut path = Vec::new();
        let mut e = start;
        while !done[e] {
            done[e] = true;
            path.extend(&corner[e]);
            e = next[e];
        }
        if !path.is_empty() {
            paths.push(path);
        }
    }
    paths
}

/// Orders `a` and `b` by how far one turns clockwise around `v` from the ray to `start`, in (0, 360] degrees.
fn clockwise_order(v: GridPoint, start: GridPoint, a: GridPoint, b: GridPoint) -> Ordering {
    let half = |p: GridPoint| match orient(v, start, p) {
        Ordering::Less => 0,
        Ordering::Equal if opposite(v, start, p) => 1,
        Ordering::Greater => 2,
        Ordering::Equal => 3,
    };
    half(a).cmp(&half(b)).then_with(|| orient(v, a, b))
}

fn opposite(v: GridPoint, a: GridPoint, b: GridPoint) -> bool {
    (a > v) != (b > v)
}

/// The point `retreat` steps from `v` towards `p`, at most a third of the way.
fn towards(v: GridPoint, p: GridPoint, retreat: f64) -> GridPoint {
    let (dx, dy) = ((p.x - v.x) as f64, (p.y - v.y) as f64);
    let t = (retreat / dx.hypot(dy)).min(1.0 / 3.0);
    GridPoint::new(v.x + (dx * t).round() as i64, v.y + (dy * t).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clockwise_order_goes_all_the_way_round() {
        let v = GridPoint::new(0, 0);
        let start = GridPoint::new(0, 5);
        let round = [(1, 3), (4, 0), (2, -2), (0, -1), (-3, -1), (-1, 0), (-1, 7), (0, 2)];
        let round = round.map(|(x, y)| GridPoint::new(x, y));
        for pair in round.windows(2) {
            assert_eq!(clockwise_order(v, start, pair[0], pair[1]), Ordering::Less, "{pair:?}");
        }
    }
}
