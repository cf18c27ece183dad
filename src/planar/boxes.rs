//! Regions of boxes, for the tests of all rooms.

use super::{FillRule, Grid, GridPoint, Region};

/// The region of boxes, each of a corner, a width and a height in units of so many steps of the grid for 100 mm.
pub(crate) fn boxes(step: i64, rule: FillRule, boxes: &[(i64, i64, i64, i64)]) -> Region {
    let paths: Vec<Vec<GridPoint>> = boxes
        .iter()
        .map(|&(x, y, w, h)| {
            [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
                .map(|(x, y)| GridPoint::new(x * step, y * step))
                .to_vec()
        })
        .collect();
    Region::fill(Grid::for_extent(100.0).expect("100 mm have a grid"), &paths, rule)
}
