//! True distances between contours, and the spanning forest that joins the nearest first (Kruskal 1956).
//!
//! The distance of two polygons is attained at a vertex of one of them, so the nearest edge of the other is
//! looked up for each vertex in reach. Pairs are measured in rounds of doubling reach: a round settles every
//! pair nearer than its reach, and far pairs are never measured when near ones have joined their contours. A
//! shortest link crosses no third contour: from that one both ends would be nearer, and joined before.

use glam::DVec2;

use super::ground::{Ground, Rim, Side};

/// The shortest way from one contour to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    /// The contours, the lower number first.
    pub(super) rims: [usize; 2],
    /// How far they are apart, in millimetres.
    pub(super) distance_mm: f64,
    /// The nearest points, on either of them.
    pub(super) ends: [DVec2; 2],
}

/// The nearest points of two contours, if they are at most `reach` apart.
pub(super) fn nearest(a: &Rim, b: &Rim, reach: f64) -> Option<[DVec2; 2]> {
    let mut best = reach;
    let mut found = None;
    for (x, y) in [(a, b), (b, a)] {
        let margin = DVec2::splat(best);
        for edge in x.edges_in(y.low - margin, y.high + margin) {
            let p = edge.from;
            if y.box_distance(p) > best {
                continue;
            }
            let q = y.nearest(p);
            if q.distance(p) <= best {
                (best, found) = (q.distance(p), Some([p, q]));
            }
        }
    }
    found
}

/// All links of length in (`over`, `reach`] within cells of `side`, the shortest first, between nodes that
/// `apart` says are not joined yet.
pub(super) fn links(
    ground: &Ground,
    side: Side,
    over: f64,
    reach: f64,
    mut apart: impl FnMut(usize, usize) -> bool,
) -> Vec<Link> {
    let mut order: Vec<usize> = (0..ground.rims.len()).collect();
    order.sort_by(|&a, &b| ground.rims[a].low.x.total_cmp(&ground.rims[b].low.x));
    let mut links = Vec::new();
    for (i, &a) in order.iter().enumerate() {
        let from = &ground.rims[a];
        let ahead = order[i + 1..].iter().take_while(|&&b| ground.rims[b].low.x <= from.high.x + reach);
        for &b in ahead {
            let to = &ground.rims[b];
            let is_near = to.low.y <= from.high.y + reach && from.low.y <= to.high.y + reach;
            if !is_near
                || ground.cell(a, side) != ground.cell(b, side)
                || !apart(ground.node(a, side), ground.node(b, side))
            {
                continue;
            }
            if let Some(ends) = nearest(from, to, reach) {
                let distance_mm = ends[0].distance(ends[1]);
                if distance_mm > over {
                    links.push(Link { rims: [a.min(b), a.max(b)], distance_mm, ends });
                }
            }
        }
    }
    links.sort_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm).then(a.rims.cmp(&b.rims)));
    links
}
