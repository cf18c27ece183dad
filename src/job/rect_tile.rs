//! Exemplars from which runs come out that join their own copies.
//!
//! An exemplar is split along one of its cuts and its two parts change places: what was right of the cut comes first,
//! sealed by the cut, and what was left of it comes last. A run from the first of its pieces to the last begins and
//! ends with one and the same cut, so that copies of it join there as the exemplar did. It is an open run of closed
//! ink all the same: components and holes are those of the tile as it is written.
//!
//! In the second pass the rows hold the sides of the strip, which already match (`Sides::Held`), and no row begins
//! where ink crosses a side, so that corners stay clear.

use glam::DVec2;

use super::cut::Cut;
use super::error::JobError;
use crate::fit::Sides;
use crate::pieces::CostWeights;
use crate::planar::{GridPoint, Region};
use crate::reeb::{self, KeptRange};

/// The gap between parts of an exemplar that are set side by side, as a part of its longer side.
const GAP: f64 = 0.01;
/// The middle part of an exemplar, in which it is split if it can be.
const MIDDLE: f64 = 0.6;
/// A crossing this close to a side, as a part of the exemplar's longer side, touches it.
const TOUCH: f64 = 1e-6;
/// Costs weigh positions in this part of the longer side (see [`CostWeights`]).
const UNIT: f64 = 1.0 / 60.0;

/// Regions side by side, left to right, with a gap between them.
fn side_by_side(regions: &[&Region]) -> Region {
    let grid = regions[0].grid();
    let sizes = regions.iter().filter_map(|r| r.bounds_mm()).map(|(low, high)| high - low);
    let gap = grid.steps(GAP * sizes.map(DVec2::max_element).fold(0.0, f64::max));
    let mut at: Option<i64> = None;
    let mut contours = Vec::new();
    for region in regions {
        let Some((low, high)) = region.bounds_mm() else { continue };
        let by = at.map_or(0, |at| at + gap - grid.steps(low.x));
        contours.extend(region.shifted(GridPoint::new(by, 0)).contours().cloned());
        at = Some(grid.steps(high.x) + by);
    }
    Region::from_contours(grid, contours).expect("regions that stand apart do not meet")
}

/// `region` split along one of `cuts`, with its parts in each other's place, and where `kept` ranges of it are then.
/// `choice` 0 is the cut through the fewest strands in the middle of the region: nearer to its ends there are only tips, which a
/// split would set free. 1 is the next best, and so on.
///
/// # Errors
/// [`JobError::Refused`] when there is no such cut.
pub(super) fn opened(
    region: &Region,
    cuts: &[reeb::Cut],
    choice: usize,
    kept: &[KeptRange],
) -> Result<(Region, Vec<KeptRange>), JobError> {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let (middle, reach) = ((low.x + high.x) / 2.0, MIDDLE * (high.x - low.x) / 2.0);
    let is_outside = |cut: &reeb::Cut| (region.grid().mm(cut.x) - middle).abs() > reach;
    let mut cuts: Vec<&reeb::Cut> = cuts.iter().filter(|cut| cut.portals() > 0).collect();
    // Of those with as many strands, the one whose thinnest is thickest.
    cuts.sort_by(|a, b| {
        let thickest = b.narrowest_portal_mm().total_cmp(&a.narrowest_portal_mm());
        let middle = is_outside(a).cmp(&is_outside(b));
        middle.then(a.portals().cmp(&b.portals())).then(thickest).then(a.x.cmp(&b.x))
    });
    let split = |cut: &&reeb::Cut| Some((region.grid().mm(cut.x), region.split_at(cut.x)?));
    let (x_mm, [left, right]) = cuts.iter().skip(choice).find_map(split).ok_or_else(|| {
        JobError::Refused("a tile joins its copies where the exemplar is cut, and no cut crosses its ink; try --slicing uniform:T, or leave out --tile".to_owned())
    })?;
    let opened = side_by_side(&[&right, &left]);
    let end_mm = opened.bounds_mm().unwrap_or_default().1.x;
    // No cut is inside a kept range. What was left of the cut ends where the whole ends now.
    let moved = kept.iter().map(|range| {
        let is_left = low.x + range.to_mm <= x_mm + TOUCH;
        let by_mm = if is_left { end_mm - x_mm - (x_mm - low.x) } else { low.x - x_mm };
        KeptRange { from_mm: range.from_mm + by_mm, to_mm: range.to_mm + by_mm }
    });
    let kept = moved.collect();
    Ok((opened, kept))
}

/// Leaves out the cuts that touch a side of the strip that `cut` is made of.
pub(super) fn clear_sides(cut: &mut Cut) {
    let (low, high) = cut.region().bounds_mm().unwrap_or_default();
    let touch = TOUCH * (high - low).max_element();
    cut.slicing
        .cuts
        .retain(|c| c.crossings.iter().all(|c| c.y_mm - low.y > touch && high.y - c.y_mm > touch));
}

/// Makes runs of `cut` begin and end as the exemplar does; with `holds`, pieces also keep their heights, and joins
/// are weighed by where they are and not by where they could be moved to.
pub(super) fn join_own_copies(cut: &mut Cut, holds: bool) {
    if holds {
        clear_sides(cut);
        let (low, high) = cut.region().bounds_mm().unwrap_or_default();
        let size = high - low;
        let CostWeights { alpha, .. } = cut.weights;
        // With the mean square after the best shift, this makes the mean square without it.
        cut.weights.rise = alpha * (size.y / (size.max_element() * UNIT)).powi(2);
        cut.sides = Sides::Held;
    }
    cut.weigh(true);
}
