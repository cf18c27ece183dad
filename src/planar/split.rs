//! A region cut along a vertical line, both parts sealed by the line.

use super::contour::Contour;
use super::grid::GridPoint;
use super::region::Region;

impl Region {
    /// The parts of the region to the left and to the right of the line at `x`, in steps of the grid. Along the line
    /// both have the same vertices. `None` when a vertex lies on the line, or crossings of it are too close to be
    /// told apart on the grid.
    pub fn split_at(&self, x: i64) -> Option<[Self; 2]> {
        let mut chains: Vec<Chain> = Vec::new();
        let mut whole: [Vec<Contour>; 2] = [Vec::new(), Vec::new()];
        for contour in self.contours() {
            let points = contour.points();
            if points.iter().any(|p| p.x == x) {
                return None;
            }
            let n = points.len();
            let crosses = |i: usize| (points[i].x < x) != (points[(i + 1) % n].x < x);
            let Some(first) = (0..n).find(|&i| crosses(i)) else {
                whole[usize::from(points[0].x > x)].push(contour.clone());
                continue;
            };
            let mut chain = vec![crossing(points[first], points[(first + 1) % n], x)];
            for step in 1..=n {
                let i = (first + step) % n;
                chain.push(points[i]);
                if crosses(i) {
                    let at = crossing(points[i], points[(i + 1) % n], x);
                    chain.push(at);
                    let side = usize::from(points[i].x > x);
                    chains.push(Chain { side, points: std::mem::replace(&mut chain, vec![at]) });
                }
            }
        }
        // From the top, crossings 2j and 2j + 1 are the ends of portal j.
        let mut heights: Vec<i64> = chains.iter().map(|c| c.points[0].y).collect();
        heights.sort_unstable_by(|a, b| b.cmp(a));
        if heights.windows(2).any(|w| w[0] == w[1]) {
            return None;
        }
        let partner = |y: i64| heights[heights.partition_point(|&h| h > y) ^ 1];
        let mut used = vec![false; chains.len()];
        for start in 0..chains.len() {
            let mut points = Vec::new();
            let (side, mut at) = (chains[start].side, start);
            while !std::mem::replace(&mut used[at], true) {
                let run = &chains[at].points;
                points.extend_from_slice(run);
                let entry = partner(run[run.len() - 1].y);
                at = chains.iter().position(|c| c.side == side && c.points[0].y == entry)?;
            }
            if !points.is_empty() {
                whole[side].push(Contour::new(points)?);
            }
        }
        let [left, right] = whole.map(|contours| Self::from_contours(self.grid(), contours).ok());
        Some([left?, right?])
    }
}

/// A part of a contour between two crossings of the line, both included.
struct Chain {
    /// 0 on the left of the line, 1 on the right.
    side: usize,
    points: Vec<GridPoint>,
}

/// The point of the edge on the line, its height rounded to the grid.
fn crossing(a: GridPoint, b: GridPoint, x: i64) -> GridPoint {
    // The same from both ends: the edge from left to right.
    let (a, b) = if a.x < b.x { (a, b) } else { (b, a) };
    let (run, rise) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let twice = 2 * rise * i128::from(x - a.x) + run;
    GridPoint::new(x, a.y + twice.div_euclid(2 * run) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_parts_make_the_whole(
            boxes in prop::collection::vec((0i64..50, 0i64..50, 1i64..30, 1i64..30, -9i64..9), 1..10),
            at in 0i64..80,
        ) {
            let step = 1_000_000;
            let paths: Vec<Vec<GridPoint>> = boxes
                .iter()
                .map(|&(x, y, w, h, lean)| {
                    [(x, y), (x + w, y), (x + w + lean, y + h), (x + lean, y + h)]
                        .map(|(x, y)| GridPoint::new(x * step, y * step))
                        .to_vec()
                })
                .collect();
            let grid = Grid::for_extent(100.0).unwrap();
            let region = Region::fill(grid, &paths, FillRule::NonZero);
            let x = at * step + 12_345;
            if let Some([left, right]) = region.split_at(x) {
                let bounds = |r: &Region| r.bounds_mm();
                prop_assert!(bounds(&left).is_none_or(|(_, high)| high.x <= grid.mm(x)));
                prop_assert!(bounds(&right).is_none_or(|(low, _)| low.x >= grid.mm(x)));
                prop_assert!((left.area_mm2() + right.area_mm2() - region.area_mm2()).abs() < 1e-6);
                let union = Region::union(grid, [&left, &right]);
                prop_assert_eq!((union.components(), union.holes()), (region.components(), region.holes()));
            }
        }
    }

    #[test]
    fn a_frame_becomes_two_brackets() {
        let grid = Grid::for_extent(100.0).unwrap();
        let square =
            |a: i64, b: i64| [(a, a), (b, a), (b, b), (a, b)].map(|(x, y)| GridPoint::new(x, y)).to_vec();
        let frame = Region::fill(grid, &[square(0, 1000), square(300, 600)], FillRule::EvenOdd);
        let [left, right] = frame.split_at(400).unwrap();
        assert_eq!([left.components(), left.holes(), right.components(), right.holes()], [1, 0, 1, 0]);
        assert_eq!(frame.split_at(300), None, "a vertex lies there");
    }
}
