//! Exemplars from which runs come out that join their own copies.
//!
//! An exemplar is split along one of its cuts: what was right of the cut comes first, sealed by the cut, then once more
//! the whole, which has that cut open, and what was left of it comes last. A run from the first of these pieces to the
//! last begins and ends with one and the same cut, so that copies of it join there as the exemplar did. It is an
//! open run of closed ink all the same: components and holes are those of the tile as it is written.
//!
//! Where pieces may be mirrored, a run may also return to the cut that it began with, as its own reflection; then it
//! never needs the other part, and a cut will do that leaves either part in one component.
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
/// So many cuts, of those through the fewest strands, are looked at for one to split an exemplar at. More take longer
/// than the search that follows.
const CANDIDATES: usize = 40;
/// So many cuts are left in what a run begins and ends with before it goes over into the whole.
const LEAD: usize = 3;
/// Strands thinner than this part of the exemplar's longer side are hairs, on which no copy should hang.
const HAIR: f64 = 1.0 / 400.0;
/// A crossing this close to a side, as a part of the exemplar's longer side, touches it.
const TOUCH: f64 = 1e-6;
/// Costs weigh positions in this part of the longer side (see [`CostWeights`]).
const UNIT: f64 = 1.0 / 60.0;

/// Regions side by side, left to right, with a gap between them, and by how many millimetres each was moved.
fn side_by_side(regions: [&Region; 3]) -> (Region, [f64; 3]) {
    let grid = regions[0].grid();
    let sizes = regions.iter().filter_map(|r| r.bounds_mm()).map(|(low, high)| high - low);
    let gap = grid.steps(GAP * sizes.map(DVec2::max_element).fold(0.0, f64::max));
    let mut at: Option<i64> = None;
    let mut contours = Vec::new();
    let moved_mm = regions.map(|region| {
        let Some((low, high)) = region.bounds_mm() else { return 0.0 };
        let by = at.map_or(0, |at| at + gap - grid.steps(low.x));
        contours.extend(region.shifted(GridPoint::new(by, 0)).contours().cloned());
        at = Some(grid.steps(high.x) + by);
        grid.mm(by)
    });
    let region = Region::from_contours(grid, contours).expect("regions that stand apart do not meet");
    (region, moved_mm)
}

/// `region` split along one of `cuts`, with its parts in each other's place, and where `kept` ranges of it are then.
/// `choice` 0 is the cut that sets the fewest parts free, in the part that sets fewer if runs `fold` back to it; of
/// these the one through the fewest strands in the middle of the region, as nearer to its ends there are only tips. 1 is
/// the next best, and so on.
///
/// # Errors
/// [`JobError::Refused`] when there is no such cut.
pub(super) fn opened(
    region: &Region,
    cuts: &[reeb::Cut],
    choice: usize,
    folds: bool,
    kept: &[KeptRange],
) -> Result<(Region, Vec<KeptRange>), JobError> {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let (middle, reach) = ((low.x + high.x) / 2.0, MIDDLE * (high.x - low.x) / 2.0);
    let is_outside = |cut: &reeb::Cut| (region.grid().mm(cut.x) - middle).abs() > reach;
    let hair_mm = HAIR * (high - low).max_element();
    let is_hair = |cut: &reeb::Cut| cut.narrowest_portal_mm() < hair_mm;
    let all = cuts;
    let mut cuts: Vec<&reeb::Cut> = all.iter().filter(|cut| cut.portals() > 0).collect();
    // Of those with as many strands, the one whose thinnest is thickest.
    cuts.sort_by(|a, b| {
        let thickest = b.narrowest_portal_mm().total_cmp(&a.narrowest_portal_mm());
        let hair = is_hair(a).cmp(&is_hair(b));
        hair.then(a.portals().cmp(&b.portals())).then(thickest).then(a.x.cmp(&b.x))
    });
    let splits = cuts.iter().take(CANDIDATES).filter_map(|cut| {
        let parts = region.split_at(cut.x)?;
        let [left, right] = parts.each_ref().map(Region::components);
        let free = if folds { left.min(right) } else { left + right };
        Some(((is_hair(cut), free, is_outside(cut), cut.portals()), region.grid().mm(cut.x), parts))
    });
    let mut splits: Vec<_> = splits.collect();
    splits.sort_by_key(|&(rank, ..)| rank);
    let (_, x_mm, [left, right]) = splits.into_iter().nth(choice).ok_or_else(|| {
        JobError::Refused("a tile joins its copies where the exemplar is cut, and no cut crosses its ink; try --slicing uniform:T, or leave out --tile".to_owned())
    })?;
    // A few pieces are enough to get from there into the whole, and from the whole back.
    let mut xs: Vec<i64> = all.iter().map(|cut| cut.x).collect();
    xs.sort_unstable();
    let far = |of: &Region, x: Option<&i64>, side: usize| {
        let part = x.and_then(|&x| Some((of.split_at(x)?, x)));
        part.map(|(parts, x)| (parts.into_iter().nth(side).expect("there are two"), region.grid().mm(x)))
    };
    let is_after = |&x: &&i64| region.grid().mm(*x) > x_mm;
    let after = xs.iter().filter(is_after).nth(LEAD);
    let before = xs.iter().rev().filter(|x| region.grid().mm(**x) < x_mm).nth(LEAD);
    let (first, first_end_mm) = far(&right, after, 0).unwrap_or((right, high.x));
    let (last, last_begin_mm) = far(&left, before, 1).unwrap_or((left, low.x));
    let (opened, moved_mm) = side_by_side([&first, region, &last]);
    let ends_mm = [(x_mm, first_end_mm), (low.x, high.x), (last_begin_mm, x_mm)];
    // No cut is inside a kept range. Ranges count from the left of the ink, and what is moved begins there.
    let begin_mm = opened.bounds_mm().unwrap_or_default().0.x;
    let images = ends_mm.into_iter().zip(moved_mm).flat_map(|((from_mm, to_mm), by_mm)| {
        let is_inside = move |range: &&KeptRange| {
            low.x + range.from_mm >= from_mm - TOUCH && low.x + range.to_mm <= to_mm + TOUCH
        };
        kept.iter().filter(is_inside).map(move |range| {
            let by_mm = low.x + by_mm - begin_mm;
            KeptRange { from_mm: range.from_mm + by_mm, to_mm: range.to_mm + by_mm }
        })
    });
    let kept = images.collect();
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

/// Makes runs of `cut` begin and end as the exemplar does; with `holds`, pieces also keep their heights.
pub(super) fn join_own_copies(cut: &mut Cut, holds: bool) {
    if holds {
        hold_sides(cut, Sides::Held);
    }
    cut.weigh(true);
}

/// Makes the rows of `cut` keep their heights, on a sheet that is rolled, where the two sides of the strip are one place.
pub(super) fn join_sides(cut: &mut Cut) {
    hold_sides(cut, Sides::Joined);
    cut.weigh(false);
}

/// Lets pieces keep their heights, and joins be weighed by where they are and not by where they could be moved to.
fn hold_sides(cut: &mut Cut, sides: Sides) {
    clear_sides(cut);
    let (low, high) = cut.region().bounds_mm().unwrap_or_default();
    let size = high - low;
    let CostWeights { alpha, .. } = cut.weights;
    // With the mean square after the best shift, this makes the mean square without it.
    cut.weights.rise = alpha * (size.y / (size.max_element() * UNIT)).powi(2);
    cut.sides = sides;
}
