//! A bridge is tried out before it is laid: exactly, and at the tolerance of a machine.
//!
//! A bridge changes nothing outside of its corners, so a window around it is enough: the counts of the window
//! change by what the counts of the whole change by. With M the material (ink for a strut, gap for a slit) and S
//! the bridge, a bridge that joins makes one component fewer of M and no other hole; one that makes a loop takes
//! one off the Euler characteristic. The same must hold of M eroded, or the bridge hangs on by a sliver, and of
//! M dilated, or it leaves a slot beside itself. In a crowd of parts a bridge may cut off small pockets: as a last
//! resort these are filled with it (of ink: a crumb that would fall out is taken away).
//!
//! How much erosion a place withstands ranks it. Eroding takes nearly all of the time, so it is done with contours
//! that are thinned as far as the least erosion allows, and it is what an [`Effort`] is counted in.

use std::cell::Cell;

use glam::DVec2;

use super::BridgeOptions;
use super::fence::Fence;
use super::ground::{Ground, Side, nearest_step};
use super::thin::thinned;
use crate::planar::{Contour, FillRule, Grid, GridPoint, Part, Region};

/// Erosions that a good bridge withstands, as parts of its width, the best first; then only what is required.
const GRADES: [f64; 3] = [0.35, 0.2, 0.08];
/// The grade of a bridge that withstands what is required and no more; one grade more and it does not.
pub(super) const REQUIRED: usize = GRADES.len();
/// What every bridge withstands, in chord errors: two of half of it meet in a fitted curve.
const LEAST_CHORDS: f64 = 0.75;
/// The window reaches so far beyond the bridge, in widths, so that what it holds on to is seen.
const WINDOW: f64 = 1.0;
/// The required erosion is exceeded by this, as a width that just holds is lost in rounding.
const SURPLUS: f64 = 1.02;
/// The largest pocket that is filled, in squares of the width: more is a hole of its own.
const LARGEST_POCKET: f64 = 1.5;
/// Arcs of eroded corners, as part of the radius.
const ARC: f64 = 0.03;

/// Contours are thinned by this part of the least erosion before they are eroded.
const THINNING: f64 = 0.1;
/// Where erosions only rank, by so much of the width: a part of those in [`GRADES`].
const RANK_THINNING: f64 = 0.015;
/// Vertices that are eroded or dilated before the search for places is given up, whatever is needed and for each bridge:
/// a few seconds, and several times what a bridge mostly takes.
const MOST_VERTICES: usize = 1_000_000;
const MOST_VERTICES_EACH: usize = 8_000;

/// What is left of the work that trying bridges may take. It is counted in vertices and not in time, so that the same
/// drawing gives the same answer on any machine.
pub(super) struct Effort {
    left: Cell<usize>,
}

impl Effort {
    /// What so many bridges may take.
    pub(super) fn new(bridges: usize) -> Self {
        Self { left: Cell::new(MOST_VERTICES + bridges.saturating_mul(MOST_VERTICES_EACH)) }
    }

    pub(super) fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    pub(super) fn spend(&self, vertices: usize) {
        self.left.set(self.left.get().saturating_sub(vertices));
    }
}

/// What a bridge is to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Purpose {
    /// Make one loop.
    Loop,
    /// Join two.
    Join,
    /// Join two, or more if there is no room for less, up to so many changes of the count; and fill small pockets.
    JoinCrowd(usize),
}

impl Purpose {
    /// By how many a bridge may change the count.
    pub(super) fn most(self) -> usize {
        if let Self::JoinCrowd(most) = self { most } else { 1 }
    }
}

/// A question to a [`Site`]: a bridge, what it is for, and what was laid before within its window.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Asked {
    corners: Vec<GridPoint>,
    purpose: Purpose,
    beside: Vec<Vec<GridPoint>>,
}

/// How a bridge passed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Verdict {
    /// 0 is the best; see [`GRADES`].
    pub(super) grade: usize,
    /// By how many it changes the count.
    pub(super) changes: usize,
    /// Pockets that the bridge would cut off and that are filled with it, counter-clockwise.
    pub(super) pockets: Vec<Vec<GridPoint>>,
    /// The material that is added or taken away, in square millimetres.
    pub(super) area_mm2: f64,
}

/// A region with the bridges that were laid so far.
pub(super) struct Site<'a> {
    ground: &'a Ground,
    side: Side,
    width_mm: f64,
    /// Erosion of the material that is required, in millimetres.
    erosion_mm: f64,
    /// Dilation of the material that is required.
    dilation_mm: f64,
    /// Erosion and dilation of the material without which curves could not be fitted to it.
    least_mm: f64,
    /// The contours of the ground, thinned for what is required, and for what only ranks.
    thin: [Vec<Vec<GridPoint>>; 2],
    /// Bridges laid, counter-clockwise.
    laid: Vec<Laid>,
    /// Where struts may be, if not anywhere.
    fence: Option<&'a Fence<'a>>,
    effort: &'a Effort,
}

struct Laid {
    path: Vec<GridPoint>,
    low: DVec2,
    high: DVec2,
}

impl Laid {
    fn new(grid: Grid, path: Vec<GridPoint>) -> Self {
        let corners = || path.iter().map(|&p| grid.to_mm(p));
        let low = corners().reduce(DVec2::min).unwrap_or_default();
        let high = corners().reduce(DVec2::max).unwrap_or_default();
        Self { path, low, high }
    }
}

impl<'a> Site<'a> {
    /// Without bridges yet.
    pub(super) fn new(
        ground: &'a Ground,
        side: Side,
        width_mm: f64,
        options: &BridgeOptions<'_>,
        fence: Option<&'a Fence<'a>>,
        effort: &'a Effort,
    ) -> Self {
        let half = |mm: f64| 0.5 * mm * SURPLUS;
        let (feature, gap) = (half(options.min_feature_mm), half(options.min_gap_mm));
        let (erosion_mm, dilation_mm) = match side {
            Side::Gap => (feature, gap),
            Side::Ink => (gap, feature),
        };
        let least_mm = LEAST_CHORDS * options.chord_mm;
        let thin = [THINNING * least_mm, f64::max(THINNING * least_mm, RANK_THINNING * width_mm)].map(|mm| {
            let slack = ground.grid.steps(mm) as f64;
            ground.rims.iter().map(|rim| thinned(&rim.steps, slack)).collect()
        });
        Self {
            ground,
            side,
            width_mm,
            erosion_mm,
            dilation_mm,
            least_mm,
            thin,
            laid: Vec::new(),
            fence,
            effort,
        }
    }

    /// Lays a bridge and fills its pockets; how many outlines there are then.
    pub(super) fn lay(&mut self, corners: &[DVec2; 4], pockets: &[Vec<GridPoint>]) -> usize {
        let grid = self.ground.grid;
        self.laid.push(self.on_grid(corners));
        self.laid.extend(pockets.iter().map(|path| Laid::new(grid, path.clone())));
        self.laid.len()
    }

    /// The region with as many of the outlines that were laid.
    pub(super) fn built(&self, outlines: usize) -> Region {
        let ink = self.ground.rims.iter().map(|rim| rim.steps.clone());
        let laid = self.laid.iter().take(outlines).map(|laid| match self.side {
            Side::Gap => laid.path.clone(),
            Side::Ink => laid.path.iter().rev().copied().collect(),
        });
        Region::fill(self.ground.grid, &ink.chain(laid).collect::<Vec<_>>(), FillRule::Positive)
    }

    /// All that the verdict on a bridge depends on, as the contours are always the same; `None` where no bridge may be.
    pub(super) fn asked(&self, corners: &[DVec2; 4], purpose: Purpose) -> Option<Asked> {
        let bridge = self.on_grid(corners);
        if self.fence.is_some_and(|fence| !fence.holds(&bridge.path)) {
            return None;
        }
        let [low, high] = self.window_around(&bridge);
        Some(Asked { beside: self.laid_in(low, high).cloned().collect(), corners: bridge.path, purpose })
    }

    fn window_around(&self, bridge: &Laid) -> [DVec2; 2] {
        let largest = self.width_mm.max(2.0 * self.erosion_mm).max(2.0 * self.dilation_mm);
        [bridge.low - WINDOW * largest, bridge.high + WINDOW * largest]
    }

    /// The outlines that were laid and meet a box.
    fn laid_in(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = &Vec<GridPoint>> {
        let meets = move |laid: &&Laid| laid.low.cmple(high).all() && laid.high.cmpge(low).all();
        self.laid.iter().filter(meets).map(|laid| &laid.path)
    }

    /// Tries a bridge; `None` when it does not serve its purpose.
    pub(super) fn try_out(&self, corners: &[DVec2; 4], purpose: Purpose) -> Option<Verdict> {
        let bridge = self.on_grid(corners);
        let [low, high] = self.window_around(&bridge);
        let mut paths = self.window(low, high, |rim| &self.ground.rims[rim].steps);
        let before = paths.len();
        let without = Region::fill(self.ground.grid, &paths, FillRule::Positive);
        paths.push(bridge.path.clone());
        let mut with = Region::fill(self.ground.grid, &paths, FillRule::Positive);
        let mut change = Change::between(&without, &with);
        let mut pockets = Vec::new();
        if matches!(purpose, Purpose::JoinCrowd(_)) && change.holes > 0 {
            pockets = self.pockets(&without, &with, change.holes as usize)?;
            paths.extend(pockets.iter().cloned());
            with = Region::fill(self.ground.grid, &paths, FillRule::Positive);
            change = Change::between(&without, &with);
        }
        let changes = (1..=purpose.most()).find(|&changes| change.serves(purpose, changes))?;
        let area_mm2 = with.area_mm2() - without.area_mm2();
        // Where they agree the two are thinned alike, as their paths are and not their contours.
        let thin_pair = |thin: &[Vec<GridPoint>]| {
            let mut paths = self.window(low, high, |rim| &thin[rim]);
            let without = Region::fill(self.ground.grid, &paths, FillRule::Positive);
            paths.extend(std::iter::once(&bridge.path).chain(&pockets).cloned());
            [without, Region::fill(self.ground.grid, &paths, FillRule::Positive)]
        };
        // By how many the count changes once `lost` of what is joined have vanished.
        let withstands = |[without, with]: &[Region; 2], [erosion_mm, dilation_mm]: [f64; 2], lost: usize| {
            let offsets = |r: f64| Change::between(&self.offset(without, r), &self.offset(with, r));
            let holds = erosion_mm == 0.0
                || if lost == 0 {
                    offsets(-erosion_mm).serves(purpose, changes)
                } else {
                    offsets(-erosion_mm).joins(changes, lost)
                };
            holds && (dilation_mm == 0.0 || offsets(dilation_mm).adds_nothing(purpose, changes))
        };
        let graded = GRADES.into_iter().chain([0.0]).map(|part| {
            [self.erosion_mm, self.dilation_mm].map(|mm| mm.max(part * self.width_mm).max(self.least_mm))
        });
        let levels: Vec<[f64; 2]> = graded.chain([[self.least_mm; 2]]).collect();
        let thin = thin_pair(&self.thin[0]);
        // What withstands more need not withstand less: walls that are gone with more hide what the bridge does to them.
        let holds = withstands(&thin, levels[REQUIRED], 0);
        let graded = || {
            let thin = thin_pair(&self.thin[1]);
            levels[..REQUIRED].iter().position(|&level| withstands(&thin, level, 0)).unwrap_or(REQUIRED)
        };
        let least = || levels[REQUIRED + 1] != levels[REQUIRED] && withstands(&thin, levels[REQUIRED + 1], 0);
        let grade = holds.then(graded).or_else(|| least().then_some(REQUIRED + 1));
        let grade = grade.or_else(|| {
            // What is too thin to last by itself needs no hold, as a hole that is smaller than the slit that opens it.
            let [before, after] = [&thin[0], &thin[1]].map(Region::parts);
            let joined: Vec<&Part> = before.iter().filter(|part| !after.contains(part)).collect();
            let lasting = |&level: &[f64; 2]| {
                let is_lost =
                    |part: &&&Part| self.offset(&part.alone(self.ground.grid), -level[0]).is_empty();
                let lost = joined.iter().filter(is_lost).count();
                // Without any, the answer is known.
                lost > 0 && withstands(&thin, level, lost)
            };
            if purpose == Purpose::Loop {
                return None;
            }
            let least = lasting(&levels[REQUIRED + 1]);
            least.then(|| if lasting(&levels[REQUIRED]) { REQUIRED } else { REQUIRED + 1 })
        })?;
        // Where a slit only touches a contour, gap is not joined and ink is severed: such a place is not taken.
        let is_true = self.side == Side::Gap || {
            let ink = |paths: &[Vec<GridPoint>]| euler(&self.inverse(paths, low, high));
            ink(&paths) - ink(&paths[..before]) == change.holes - change.components
        };
        is_true.then_some(Verdict { grade, changes, pockets, area_mm2 })
    }

    /// The smallest holes that are new, if they are small.
    fn pockets(&self, without: &Region, with: &Region, count: usize) -> Option<Vec<Vec<GridPoint>>> {
        let holes = |region: &Region| -> Vec<Contour> {
            region.contours().filter(|c| !c.is_counter_clockwise()).cloned().collect()
        };
        let before = holes(without);
        let mut new = holes(with);
        new.retain(|hole| !before.contains(hole));
        new.sort_by_key(|hole| hole.doubled_area().abs());
        new.truncate(count);
        let largest = LARGEST_POCKET * self.width_mm * self.width_mm;
        let are_small = new.iter().all(|hole| hole.area_mm2(self.ground.grid).abs() <= largest);
        let pockets = || -> Vec<Vec<GridPoint>> {
            new.iter().map(|hole| hole.points().iter().rev().copied().collect()).collect()
        };
        let may_fill = |pockets: &Vec<Vec<GridPoint>>| {
            self.fence.is_none_or(|fence| pockets.iter().all(|pocket| fence.covers(pocket)))
        };
        are_small.then(pockets).filter(may_fill)
    }

    fn offset(&self, region: &Region, radius_mm: f64) -> Region {
        self.effort.spend(region.vertices());
        region.offset(radius_mm, ARC * radius_mm.abs())
    }

    fn on_grid(&self, corners: &[DVec2; 4]) -> Laid {
        let grid = self.ground.grid;
        Laid::new(grid, corners.iter().map(|&p| nearest_step(grid, p)).collect())
    }

    /// What is not material in the window.
    fn inverse(&self, paths: &[Vec<GridPoint>], low: DVec2, high: DVec2) -> Region {
        let grid = self.ground.grid;
        let [least, greatest] = [low, high].map(|p| nearest_step(grid, p));
        let turned = paths.iter().map(|path| path.iter().rev().copied().collect());
        let paths: Vec<Vec<GridPoint>> = turned.chain([frame(least, greatest)]).collect();
        Region::fill(grid, &paths, FillRule::Positive)
    }

    /// Paths whose positive winding is the material in the window, with the bridges that were laid. `steps` are those
    /// of a contour.
    fn window<'s>(
        &self,
        low: DVec2,
        high: DVec2,
        steps: impl Fn(usize) -> &'s [GridPoint],
    ) -> Vec<Vec<GridPoint>> {
        let grid = self.ground.grid;
        let meets = |a: DVec2, b: DVec2| a.cmple(high).all() && b.cmpge(low).all();
        let [least, greatest] = [low, high].map(|p| nearest_step(grid, p));
        let rims = self.ground.rims.iter().enumerate().filter(|(_, rim)| meets(rim.low, rim.high));
        let paths = rims.map(|(rim, _)| clipped(steps(rim), least, greatest));
        let mut paths: Vec<Vec<GridPoint>> = paths.filter(|path| path.len() > 2).collect();
        if self.side == Side::Ink {
            paths.iter_mut().for_each(|path| path.reverse());
            paths.push(frame(least, greatest));
        }
        paths.extend(self.laid_in(low, high).cloned());
        paths
    }
}

fn frame(low: GridPoint, high: GridPoint) -> Vec<GridPoint> {
    [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)]
        .map(|(x, y)| GridPoint::new(x, y))
        .to_vec()
}

/// Components less holes.
fn euler(region: &Region) -> isize {
    region.components() as isize - region.holes() as isize
}

/// What a bridge changes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Change {
    components: isize,
    holes: isize,
}

impl Change {
    fn between(before: &Region, after: &Region) -> Self {
        let less = |a: usize, b: usize| a as isize - b as isize;
        Self {
            components: less(after.components(), before.components()),
            holes: less(after.holes(), before.holes()),
        }
    }

    /// Whether so many are joined, or a loop is made: whether the two ends of a loop hang together is not always to
    /// be seen in the window.
    fn serves(self, purpose: Purpose, changes: usize) -> bool {
        let found = (self.components, self.holes);
        found == (-(changes as isize), 0) || (purpose == Purpose::Loop && found == (0, 1))
    }

    /// Whether so many are joined, but for those that are lost with nothing but the bridge in their place.
    fn joins(self, changes: usize, lost: usize) -> bool {
        (self.components, self.holes) == (lost as isize - changes as isize, 0)
    }

    /// Whether no more is joined, and no slot beside the bridge becomes a hole. Dilated far enough, both sides of a
    /// short bridge meet without it.
    fn adds_nothing(self, purpose: Purpose, changes: usize) -> bool {
        let loops = if purpose == Purpose::Loop { 1 } else { 0 };
        (-(changes as isize)..=0).contains(&self.components) && self.holes <= loops
    }
}

/// A closed path cut to a box (Sutherland and Hodgman 1974). Where the path leaves the box and comes back, it runs
/// along the border, forth and back where it passes by: such stretches enclose nothing.
fn clipped(path: &[GridPoint], low: GridPoint, high: GridPoint) -> Vec<GridPoint> {
    let swap = |p: GridPoint| GridPoint::new(p.y, p.x);
    let negate = |p: GridPoint| GridPoint::new(-p.x, -p.y);
    let right = |path: &[GridPoint], x: i64| right_of(path, x);
    let above: Vec<GridPoint> = right(path, low.x).into_iter().map(swap).collect();
    let rest: Vec<GridPoint> = right(&above, low.y).into_iter().map(|p| negate(swap(p))).collect();
    let below: Vec<GridPoint> = right(&rest, -high.x).into_iter().map(swap).collect();
    right(&below, -high.y).into_iter().map(|p| negate(swap(p))).collect()
}

/// The part of a closed path where x is at least `limit`.
fn right_of(path: &[GridPoint], limit: i64) -> Vec<GridPoint> {
    let mut kept = Vec::new();
    let Some(&last) = path.last() else { return kept };
    let mut from = last;
    for &to in path {
        if (from.x < limit) != (to.x < limit) {
            let t = (limit - from.x) as f64 / (to.x - from.x) as f64;
            kept.push(GridPoint::new(limit, from.y + ((to.y - from.y) as f64 * t).round() as i64));
        }
        if to.x >= limit {
            kept.push(to);
        }
        from = to;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(points: &[(i64, i64)]) -> Vec<GridPoint> {
        points.iter().map(|&(x, y)| GridPoint::new(x, y)).collect()
    }

    #[test]
    fn clipping_keeps_the_inside_and_its_turn() {
        let (low, high) = (GridPoint::new(0, 0), GridPoint::new(10, 10));
        let area = |p: &[GridPoint]| -> i64 {
            (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).map(|(a, b)| a.x * b.y - b.x * a.y).sum()
        };
        let around = path(&[(-5, -5), (20, -5), (20, 20), (-5, 20)]);
        assert_eq!(area(&clipped(&around, low, high)), 200);
        let corner = path(&[(5, 5), (20, 5), (20, 20), (5, 20)]);
        assert_eq!(area(&clipped(&corner, low, high)), 50);
        let hole: Vec<GridPoint> = corner.iter().rev().copied().collect();
        assert_eq!(area(&clipped(&hole, low, high)), -50);
        let outside = path(&[(20, 0), (30, 0), (30, 5)]);
        assert_eq!(area(&clipped(&outside, low, high)), 0);
        // A horseshoe whose bend is outside becomes two bars.
        let horseshoe = path(&[(2, 20), (2, 5), (4, 5), (4, 18), (6, 18), (6, 5), (8, 5), (8, 20)]);
        assert_eq!(area(&clipped(&horseshoe, low, high)), 40);
    }
}
