//! Minimum feature and gap, enforced: what is too thin is thickened, what is too narrow is widened, and nothing else.
//!
//! The ink and the gaps each have a *core*, lines in their middle to which they can be shrunk without changing a count
//! ([`self::core`]). Where ink that holds something together is thinner than the minimum feature ([`keep`]), a disc of that
//! size is moved along the core and added ([`stroke`]); where a gap is narrower than the minimum gap, one is taken
//! away. A stroke stops at the core of the other side, with as much around it as that side has, up to what it needs, or
//! half of that where ink gives way to a gap ([`grow`]). So no step changes components or holes. Ink beside a narrow gap
//! grows on its other side only: its core moves there, and the next step starts from that. Steps for ink and gaps alternate
//! until nothing is lacking.
//!
//! Two strands and the gap between them may need more room than there is. Then nothing is lacking never comes, and
//! [`EnforceError::Crowded`] names the place. The box around the ink is never left, so that the part keeps its size.
//!
//! Tips of ink and ends of notches are left as they are, as a machine that cannot make them loses nothing that
//! counts; but what ends freely and is narrow for more than [`TIP`] times the width is seen: such ink is thickened, and such a
//! gap widened. A short end with a neck is no tip either. Ink is thickened there, as a lump that breaks off is missed; a gap is
//! filled ([`fill`]), as a pocket that nothing gets into is nothing, and widening it would bite into the ink around. Long
//! gaps that end blind are filled too where there is no room to widen them.
//!
//! Excluded: moving strands apart, and the judgement whether a file holds, which is for another room to give.

mod core;
mod fill;
mod grow;
mod keep;
mod stroke;
#[cfg(test)]
mod tests;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

use self::core::{Core, Fineness, cores};
use self::grow::{Bounds, complement, grown};
use self::keep::{Kept, Tip};
use self::stroke::{Stroke, guards, lacking, merged};
use super::Counts;
use super::in_box::Pressed;
use crate::planar::{EdgeIndex, Region};

/// Steps for ink and gaps, at most. Ink that is blocked on one side halves what it lacks with each, so that this many
/// leave nothing to speak of; more only take time where there is no room.
const ROUNDS: usize = 24;
/// Ink beside a gap that is widened keeps this part of the minimum feature, and grows again on its other side, so that
/// strands can give way. All of it, and strands that are just wide enough hold a narrow gap between them for ever; much
/// less, and what has no other side is worn to a thread before it is refused.
const YIELD: f64 = 0.5;
/// It is no progress when more than this part of what lacked is still lacking, and after so many steps without any there is
/// no room. Fewer steps, and ink that is blocked for a while is given up; more only take time.
const PROGRESS: f64 = 0.97;
const PATIENCE: usize = 6;
/// After so many steps it is judged whether there is hope: there is while no more than this part of what lacked first is
/// lacking, or while four steps leave less than this part of what lacked before them. Drawings that have room lack a few
/// hundredths after so many; what is judged earlier may only have begun to give way.
const TRIAL: usize = 8;
const SLIGHT: f64 = 0.01;
const SLOW: f64 = 0.5;
/// Drawings of fewer vertices are tried to the end, which takes a second or two.
const LARGE: usize = 3000;
/// Ends are to blame for a lack of room where all else is no more than this part of what lacks.
const BLAME: f64 = 0.5;
/// What is made is wider than what is wanted by this part: the distances along a core are those at its nodes, and
/// between them it may be narrower by a hundredth.
const WANTED: f64 = 1.03;
/// Less than that, and there is something lacking; nearer to [`WANTED`], and rounding would count as lacking.
const ENOUGH: f64 = 1.015;
/// What is stuck just below [`ENOUGH`] is good from this part of what is wanted on.
const GOOD: f64 = 1.002;
/// Of the lesser width, how far points of contours are apart at most, so that narrow strips are crossed often enough.
const SPACING: f64 = 1.0 / 3.0;
/// Where only one of the two widths is wanted, the other side keeps what it has up to this part of the width.
const UNASKED: f64 = 0.1;
/// Ink that ends freely is a tip when it is thin for no more than so many minimum features, as are the tips of wedges
/// of more than 17 degrees; longer, and it is a hair.
pub const TIP: f64 = 3.0;
/// What of a filled bay is thinner than twice this part of a chord is rounding.
const SLIVER: f64 = 0.25;
/// How far the outside is taken along around the ink, in diagonals of its box: more than a core reaches, which goes one
/// and a little farther.
const FRAME: f64 = 16.0;
/// Changes of less area than this part of a disc of the width are rounding.
const LEAST_CHANGE: f64 = 1e-3;

/// What is enforced. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnforceOptions {
    /// The narrowest ink that the machine makes; 0 asks for nothing.
    pub min_feature_mm: f64,
    /// The narrowest gap that the machine keeps open; 0 asks for nothing.
    pub min_gap_mm: f64,
    /// The greatest distance between a round edge and the chords that stand for it.
    pub chord_mm: f64,
}

/// A place where ink was added or taken away.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Change {
    /// The middle of the box around it, in millimetres.
    pub position_mm: [f64; 2],
    /// The ink added, or with a minus taken away, in square millimetres.
    pub area_mm2: f64,
}

/// A region in which nothing is too thin or too narrow.
#[derive(Debug, Clone, PartialEq)]
pub struct Enforced {
    /// The region, on the grid of the one that was given; that one itself when nothing was lacking.
    pub region: Region,
    /// Where it differs, the greatest change first.
    pub changes: Vec<Change>,
    /// The ink that was added in square millimetres.
    pub added_mm2: f64,
    /// The ink that was taken away in square millimetres.
    pub removed_mm2: f64,
    /// Whether ends are left as they were, as there is no room for them: slots, and lumps of ink on a neck.
    pub leaves_ends: bool,
    /// How the drawing was pressed together before, so that what grew stays in its box; only [`super::enforce_in_box`] does.
    pub pressed: Option<Pressed>,
}

/// Why minimum feature and gap cannot be enforced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EnforceError {
    /// A width that is no length.
    #[error("the {name} is {found_mm} mm; it must be from 0 to 100 mm")]
    Width {
        /// Minimum feature or minimum gap.
        name: &'static str,
        /// What was given.
        found_mm: f64,
    },
    /// There is no room for strands and gaps as wide as they must be.
    #[error(
        "at ({:.3}, {:.3}) mm there is no room for ink {min_feature_mm} mm and gaps {min_gap_mm} mm wide: the {what} \
         there comes out {width_mm:.3} mm wide, and no more without moving strands apart", position_mm.x, position_mm.y
    )]
    Crowded {
        /// Ink or gap.
        what: &'static str,
        /// Where it is narrowest, in millimetres.
        position_mm: DVec2,
        /// How wide it came to be.
        width_mm: f64,
        /// The minimum feature.
        min_feature_mm: f64,
        /// The minimum gap.
        min_gap_mm: f64,
    },
}

/// `region` with ink thickened to the minimum feature and gaps widened to the minimum gap where they hold something
/// together or apart, with the same components and holes. The same arguments give the same result.
///
/// # Errors
/// [`EnforceError`] for widths out of range, and where there is no room. Where only slots, or lumps on a neck, have none,
/// they stay as they are.
pub fn enforce(region: &Region, options: &EnforceOptions) -> Result<Enforced, EnforceError> {
    let widths = [("minimum feature", options.min_feature_mm), ("minimum gap", options.min_gap_mm)];
    if let Some((name, found_mm)) = widths.into_iter().find(|(_, mm)| !(0.0..=100.0).contains(mm)) {
        return Err(EnforceError::Width { name, found_mm });
    }
    let Some(within) = size_kept(region, options).filter(|_| widths.iter().any(|(_, mm)| *mm > 0.0)) else {
        return Ok(unchanged(region));
    };
    let job = Job::new(options, within);
    let crowd = match mended(&job, region) {
        Ok(now) => return Ok(changed(region, now, options)),
        Err(crowd) => crowd,
    };
    // Ends for which there is no room are no reason to refuse a drawing that has room for all else.
    let rest = Job { mends_ends: false, ..job };
    let [all, others] = [&job, &rest].map(|job| job.survey(region).lack(job));
    let are_to_blame = others <= BLAME * all || (others < all && !is_large(region));
    if are_to_blame && let Ok(now) = mended(&rest, region) {
        return Ok(Enforced { leaves_ends: true, ..changed(region, now, options) });
    }
    let Crowd(what, position_mm, width_mm) = crowd;
    let EnforceOptions { min_feature_mm, min_gap_mm, .. } = *options;
    Err(EnforceError::Crowded { what, position_mm, width_mm, min_feature_mm, min_gap_mm })
}

/// What lacks most where there is no room: ink or gap, where, and how wide it came to be.
struct Crowd(&'static str, DVec2, f64);

/// `region` with what `job` asks for.
fn mended(job: &Job, region: &Region) -> Result<Region, Crowd> {
    let counts = Counts::of(region);
    let mut now = region.clone();
    let mut narrowest = None;
    let (mut least_lack, mut last_progress) = (f64::INFINITY, 0);
    let mut lacks = Vec::new();
    for round in 0..2 * ROUNDS {
        let survey = job.survey(&now);
        narrowest = survey.narrowest();
        // Where there is no room, what lacks soon stops to become less.
        let lack = survey.lack(job);
        let is_progress = lack < PROGRESS * least_lack;
        lacks.push(lack);
        // What is given as good stays as it is.
        let is_settled = round == 0 || !is_progress;
        if narrowest.is_none() || (is_settled && survey.is_good(job)) {
            match job.filled(&now, &job.bays(&survey, false)) {
                Some(full) => now = full,
                None => return Ok(now),
            }
            continue;
        }
        if is_large(region) && is_hopeless(&lacks) {
            break;
        }
        if is_progress {
            (least_lack, last_progress) = (lack, round);
        } else if round - last_progress >= PATIENCE {
            // No room for gaps that end blind is no reason to refuse: they can be filled.
            let Some(full) = job.filled(&now, &job.bays(&survey, true)) else { break };
            (now, least_lack, last_progress) = (full, f64::INFINITY, round);
            continue;
        }
        let turns = if round % 2 == 0 { [Side::Ink, Side::Gap] } else { [Side::Gap, Side::Ink] };
        let step = turns.into_iter().find_map(|side| job.step(&now, &survey, side));
        if let Some(grown) = step.filter(|grown| Counts::of(grown) == counts) {
            now = grown;
        }
    }
    let (what, position_mm, width_mm) = narrowest.unwrap_or(("ink", DVec2::ZERO, 0.0));
    Err(Crowd(what, position_mm, width_mm))
}

/// Whether every step takes its time.
fn is_large(region: &Region) -> bool {
    region.vertices() > LARGE
}

/// Whether what lacked after each step shows that there is no room, long before it stops to become less.
fn is_hopeless(lacks: &[f64]) -> bool {
    let (&[first, ..], &[.., before, _, _, _, now]) = (lacks, lacks) else { return false };
    lacks.len() > TRIAL && now > SLIGHT * first && now > SLOW * before
}

/// The box around the ink, made as wide and high as the minimum feature needs.
fn size_kept(region: &Region, options: &EnforceOptions) -> Option<(DVec2, DVec2)> {
    let (low, high) = region.bounds_mm()?;
    let least = DVec2::splat(WANTED * options.min_feature_mm + 2.0 * options.chord_mm);
    let more = 0.5 * (least - (high - low)).max(DVec2::ZERO);
    Some((low - more, high + more))
}

fn unchanged(region: &Region) -> Enforced {
    Enforced {
        region: region.clone(),
        changes: Vec::new(),
        added_mm2: 0.0,
        removed_mm2: 0.0,
        leaves_ends: false,
        pressed: None,
    }
}

/// What became of `before`.
fn changed(before: &Region, now: Region, options: &EnforceOptions) -> Enforced {
    if now == *before {
        return unchanged(before);
    }
    let [added, removed] = [now.without(before), before.without(&now)];
    let width_mm = options.min_feature_mm.max(options.min_gap_mm);
    let mut changes = Vec::new();
    for (change, sign) in [(&added, 1.0), (&removed, -1.0)] {
        for part in change.parts() {
            let grid = change.grid();
            let (low, high) = part.exterior().bounds();
            let area: f64 = part.contours().map(|contour| contour.area_mm2(grid)).sum();
            if area >= LEAST_CHANGE * width_mm * width_mm {
                let position_mm = grid.to_mm(low).midpoint(grid.to_mm(high)).to_array();
                changes.push(Change { position_mm, area_mm2: sign * area });
            }
        }
    }
    changes.sort_by(|a, b| {
        let place = a.position_mm.partial_cmp(&b.position_mm).unwrap_or(std::cmp::Ordering::Equal);
        b.area_mm2.abs().total_cmp(&a.area_mm2.abs()).then(place)
    });
    Enforced {
        region: now,
        changes,
        added_mm2: added.area_mm2(),
        removed_mm2: removed.area_mm2(),
        leaves_ends: false,
        pressed: None,
    }
}

/// What grows in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Ink,
    Gap,
}

/// What is wanted, as halves of widths, first of ink and then of gaps.
struct Job {
    halves: [f64; 2],
    /// How wide a guard is at most.
    guards: [f64; 2],
    spacing: f64,
    within: (DVec2, DVec2),
    chord_mm: f64,
    /// Whether slots and necks are mended: what ends blind and is no hair.
    mends_ends: bool,
}

/// Both sides as they are.
struct Survey {
    cores: [Core; 2],
    /// What of the cores the other side leaves alone.
    guarded: [Kept; 2],
    /// What of the core of the gaps is kept.
    kept: Kept,
    lacking: [Vec<Stroke>; 2],
    index: EdgeIndex,
}

impl Job {
    fn new(options: &EnforceOptions, within: (DVec2, DVec2)) -> Self {
        let halves = [0.5 * options.min_feature_mm, 0.5 * options.min_gap_mm];
        let most = halves[0].max(halves[1]);
        let least = halves.into_iter().filter(|&half| half > 0.0).fold(most, f64::min);
        Self {
            halves,
            guards: halves.map(|half| if half > 0.0 { WANTED * half } else { UNASKED * most }),
            spacing: 2.0 * least * SPACING,
            within,
            // Steps repeat, and each may leave the wanted width by a chord.
            chord_mm: (0.25 * options.chord_mm).max(1e-4 * least),
            mends_ends: true,
        }
    }

    /// What may end blind in ink (0) or in gaps (1); with `has_no_necks`, no lump or pocket may.
    fn tip(&self, side: usize, has_no_necks: bool) -> Tip {
        let half = self.halves[side];
        if half <= 0.0 || (side == 1 && !self.mends_ends) {
            return Tip::ANY;
        }
        let uneven_mm = if has_no_necks && self.mends_ends { self.chord_mm } else { f64::INFINITY };
        Tip { long_mm: TIP * 2.0 * half, uneven_mm }
    }

    /// Points of bays that are no notches: of those that are not to be widened, as they are short and have a pocket; with
    /// `all`, of all that are too narrow.
    fn bays(&self, survey: &Survey, all: bool) -> Vec<DVec2> {
        let (core, half) = (&survey.cores[1], self.halves[1]);
        let across = |node: &core::Node| core::across(&survey.index, node);
        let kept = |tip: Tip| Kept::new(core, ENOUGH * half, tip, across).nodes;
        let (bays, blind) = (kept(self.tip(1, true)), kept(Tip::ANY));
        let others = if all { &blind } else { &survey.kept.nodes };
        let is_bay = |&i: &usize| bays[i] && !others[i] && core.nodes[i].radius < half;
        (0..bays.len()).filter(is_bay).map(|i| core.nodes[i].at).collect()
    }

    /// The region with those bays filled; `None` when none of them can be.
    fn filled(&self, region: &Region, bays: &[DVec2]) -> Option<Region> {
        let sliver_mm = SLIVER * self.chord_mm;
        if bays.is_empty() { None } else { fill::filled(region, bays, GOOD * self.halves[1], sliver_mm) }
    }

    fn survey(&self, region: &Region) -> Survey {
        let index = EdgeIndex::new(region);
        let enough = self.halves.map(|half| ENOUGH * half);
        // A stroke takes no more from the other side than its own width.
        let hold = [0, 1].map(|side| self.guards[side] + 2.0 * WANTED * self.halves[1 - side]);
        let fineness = Fineness { enough, hold, spacing: self.spacing };
        let cores = cores(region, &index, &fineness);
        let tips = [self.tip(0, true), self.tip(1, false)];
        // A side of which nothing is asked is held together where it is narrow, but may lose its corners.
        let kept = [0, 1].map(|side| {
            Kept::new(&cores[side], enough[side].max(self.guards[side]), tips[side], |node| {
                core::across(&index, node)
            })
        });
        let lacking = [0, 1].map(|side| {
            let radii = [enough[side], WANTED * self.halves[side]];
            let strokes = lacking(&cores[side], &kept[side], &index, radii, self.spacing);
            merged(&strokes, self.chord_mm)
        });
        let guarded = [0, 1].map(|side| kept[side].drawn_back(&cores[side], hold[side]));
        let [_, kept] = kept;
        Survey { cores, guarded, kept, lacking, index }
    }

    /// The region after one side has grown; `None` when that side lacks nothing.
    fn step(&self, region: &Region, survey: &Survey, side: Side) -> Option<Region> {
        let (own, other) = if side == Side::Ink { (0, 1) } else { (1, 0) };
        let strokes = &survey.lacking[own];
        if strokes.is_empty() {
            return None;
        }
        let most = self.guards[other] * if side == Side::Gap { YIELD } else { 1.0 };
        let guards = guards(&survey.cores[other], &survey.guarded[other], most, strokes);
        let guards = merged(&guards, 0.0);
        let points = survey.points();
        let frame = self.frame(region);
        let within = if side == Side::Ink { self.within } else { frame };
        let bounds = Bounds { guards: &guards, within, chord_mm: self.chord_mm };
        Some(match side {
            Side::Ink => grown(region, strokes, &bounds, &points[0], &points[1]),
            Side::Gap => {
                let gaps = complement(region, frame);
                complement(&grown(&gaps, strokes, &bounds, &points[1], &points[0]), frame)
            }
        })
    }

    /// A box around everything, and around the frame of the cores too.
    fn frame(&self, region: &Region) -> (DVec2, DVec2) {
        let (low, high) = region.bounds_mm().unwrap_or(self.within);
        let margin = FRAME * ((high - low).length() + self.guards[0] + self.guards[1]);
        (low - margin, high + margin)
    }
}

impl Survey {
    /// A point of each part, first of ink and then of gaps. Parts that nothing holds are still parts.
    fn points(&self) -> [Vec<DVec2>; 2] {
        self.cores.each_ref().map(|core| core.widest_of_parts().iter().map(|node| node.at).collect())
    }

    /// What is lacking altogether: the length of all that is too narrow, each by the part of its width that it lacks.
    fn lack(&self, job: &Job) -> f64 {
        let lacks = [0, 1].into_iter().flat_map(|side| {
            self.lacking[side].iter().map(move |stroke| {
                let ends = [stroke.from, stroke.to].map(|at| core::radius(&self.index, at));
                let length = stroke.from.distance(stroke.to) + job.halves[side];
                length * (1.0 - 0.5 * (ends[0] + ends[1]) / (WANTED * job.halves[side])).max(0.0)
            })
        });
        lacks.sum()
    }

    /// Whether what lacks is as wide as it must be, though not quite as wide as it was to become.
    fn is_good(&self, job: &Job) -> bool {
        [0, 1].into_iter().all(|side| {
            let mut ends = self.lacking[side].iter().flat_map(|stroke| [stroke.from, stroke.to]);
            ends.all(|at| core::radius(&self.index, at) >= GOOD * job.halves[side])
        })
    }

    /// What lacks most, where, and how wide it is; `None` when nothing is lacking.
    fn narrowest(&self) -> Option<(&'static str, DVec2, f64)> {
        let places = [("ink", 0), ("gap", 1)].into_iter().flat_map(|(what, side)| {
            self.lacking[side].iter().flat_map(move |stroke| {
                [stroke.from, stroke.to].map(|at| (what, at, 2.0 * core::radius(&self.index, at)))
            })
        });
        places.min_by(|a, b| a.2.total_cmp(&b.2))
    }
}
