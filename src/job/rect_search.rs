//! The choice of both directions of a rectangle (Zhou 2014 §6.2).
//!
//! The first pass makes a strip: a band as long as the rectangle is wide. Turned by 90 degrees it is the exemplar
//! of the second pass, whose pieces are rows. The constraints bind the second pass only; the first is free in its
//! topology, and which strip lets the second succeed is not known before it was tried. So several ways are tried
//! in a fixed order: strips in one component and strips as they come, with one seed after another, at the height
//! that was asked for or at smaller ones. All of it is done first with joins between rows in which every strand fits,
//! and only if nothing comes of that with worse ones. The first way that comes out right, in its topology and at the
//! machine's tolerance, is the one.
//!
//! Excluded: how a strip is made ([`super::rect_strip`]) and how its rows are joined ([`super::rect_rows`]).

use super::cut::read_exemplar;
use super::error::JobError;
use super::rect_builder::RectJob;
use super::rect_report::Attempt;
use super::rect_rows::{Made, RowsWish, Way};
use super::rect_strip::{Strip, Strips, Wish, cuts_mm, flat_map};
use super::stage::{Clock, Stage};
use crate::domain::BandMap;
use crate::exemplar::Exemplar;
use crate::fabricate::BridgeError;
use crate::topology::{Goal, Wanted};

/// Where no height is asked for, rows are at most this part of the rectangle's height. Larger, and there are too
/// few rows to look like a pattern; smaller, and ornaments shrink for no need.
const TALLEST_ROW: f64 = 0.25;
/// The heights that are tried, as parts of the first.
const HEIGHTS: [f64; 2] = [1.0, 0.6];
/// Seeds of strips that are tried when those without one fail.
const SEEDS: [u64; 2] = [1, 2];
/// What joins are accepted, as tried.
const BARS: [Bar; 3] = [
    Bar { worst_misfit: 1.0, scraps: 1.0 },
    Bar { worst_misfit: 2.0, scraps: MOST_SCRAPS },
    Bar { worst_misfit: f64::INFINITY, scraps: MOST_SCRAPS },
];
/// The most [`Bar::scraps`]. Beyond, nothing of the ornament is left but zigzags.
const MOST_SCRAPS: f64 = 4.0;
/// The greatest misfit of a join between rows, whatever strips may have: there are many in a panel, and a sliver is
/// seen in each. Reflections are always within it.
const ROWS_MISFIT: f64 = 2.0;
/// So many places are tried at which a tile's strip is split.
const SPLITS: usize = 2;
/// The most ways that are tried at one bar and height. More, and a refusal takes longer than anyone waits for it.
const MOST_ATTEMPTS: usize = 4;
/// The most that are tried for what is only preferred to what was asked for.
const MOST_PREFERRED: usize = 2;
/// The same as [`MOST_ATTEMPTS`] for tiles, whose ways take longer and have more in common.
const MOST_TILE_ATTEMPTS: usize = 3;

/// Which joins are accepted.
#[derive(Debug, Clone, Copy)]
struct Bar {
    /// The greatest misfit (see [`crate::pieces::Join::misfit`]).
    worst_misfit: f64,
    /// How many times more joins than usual are accepted, before it is scraps that are repeated.
    scraps: f64,
}

/// Both directions, and all that was tried for them.
pub(super) struct Found {
    /// The strip.
    pub(super) first: Strip,
    /// The rectangle.
    pub(super) second: Made,
    /// Where the sheet was cut, in millimetres.
    pub(super) cuts_mm: Vec<f64>,
    pub(super) attempts: Vec<Attempt>,
    pub(super) chosen: usize,
    pub(super) exemplar: Exemplar,
}

/// How much a failure tells: whether it is one of what was asked for, not of what was only tried for it; whether it is
/// one of a second pass; and whether it is a refusal with its reason and not a way that came out wrong.
type Telling = (bool, bool, bool);

/// Tries one way after another.
struct Search<'a, 'c> {
    job: &'a RectJob,
    /// The length of the second pass.
    map: BandMap,
    clock: &'a mut Clock<'c>,
    attempts: Vec<Attempt>,
    /// Attempts after which no more strips are made.
    allowed: usize,
    /// The width of bridges, once no way comes out right without them.
    bridge_mm: Option<f64>,
    /// The failure that tells most, and how much.
    error: Option<(Telling, JobError)>,
    /// Why the first bridges could not be laid.
    unbridged: Option<BridgeError>,
}

/// The first way that comes out right.
pub(super) fn search(job: &RectJob, clock: &mut Clock<'_>) -> Result<Found, JobError> {
    let own = clock.time(Stage::Read, || read_exemplar(&job.band))?;
    let map = flat_map(job.size.height_mm(), job.size.width_mm())?;
    let mut heights = heights(job, &own)
        .into_iter()
        .map(|height_mm| Strips::new(job, height_mm, clock))
        .collect::<Result<Vec<_>, _>>()?;
    let mut search = Search {
        job,
        map,
        clock,
        attempts: Vec::new(),
        allowed: 0,
        bridge_mm: None,
        error: None,
        unbridged: None,
    };
    let goals = goals(job);
    let bridge_mm = job.band.options.bridge_mm;
    let relaxed = relaxed_goals(job);
    for bar in BARS {
        if let Some(found) = search.at_bar(&mut heights, &goals, bar) {
            return Ok(found);
        }
        if bridge_mm.is_some() && !search.has_given_bridges_up() {
            search.bridge_mm = bridge_mm;
            if let Some(found) = search.at_bar(&mut heights, &relaxed, bar) {
                return Ok(found);
            }
            search.bridge_mm = None;
        }
    }
    Err(search.refusal())
}

fn heights(job: &RectJob, own: &Exemplar) -> Vec<f64> {
    if let Some(height) = job.band.options.width_mm {
        return vec![height];
    }
    let (low, high) = own.region().bounds_mm().unwrap_or_default();
    let height = (high.y - low.y).min(TALLEST_ROW * job.size.height_mm());
    HEIGHTS.iter().map(|part| part * height).collect()
}

/// What the rectangle must have. Where components are free it hangs together if it can.
fn goals(job: &RectJob) -> Vec<Goal> {
    let goal = job.band.options.goal;
    match goal.components {
        None => vec![Goal { components: Some(Wanted::exactly(1)), ..goal }, goal],
        Some(_) => vec![goal],
    }
}

/// What the rectangle must have before bridges are laid: the components rather than the holes, as slits across strands
/// show less than struts across gaps.
fn relaxed_goals(job: &RectJob) -> Vec<Goal> {
    let goal = job.band.options.goal;
    let in_part = (goal.components.is_some() && goal.holes.is_some()).then_some(Goal { holes: None, ..goal });
    in_part.into_iter().chain([Goal::default()]).collect()
}

/// The topologies that strips are asked for. The rows of a strip that hangs together do so too, mostly.
///
/// What is `rolled` must go all the way round: a strip that has a place without ink would leave the sheet open there.
fn first_goals(goal: Goal, rolled: bool) -> Vec<Goal> {
    let free = Goal { closed_pattern: rolled, ..Goal::default() };
    let one = Goal { components: Some(Wanted::exactly(1)), ..free };
    match goal.holes {
        // The way round is a hole of a strip that closes.
        Some(_) => vec![one, Goal { holes: Some(Wanted::exactly(u32::from(rolled))), ..one }, free],
        None => vec![one, free],
    }
}

/// Whether any strip will do, or any that closes.
fn is_any(goal: Goal) -> bool {
    Goal { closed_pattern: false, ..goal }.is_free()
}

impl Search<'_, '_> {
    /// The first way that comes out right with joins that pass a bar.
    fn at_bar(&mut self, heights: &mut [Strips], goals: &[Goal], bar: Bar) -> Option<Found> {
        let most = if self.job.tile { MOST_TILE_ATTEMPTS } else { MOST_ATTEMPTS };
        for strips in heights {
            for &goal in goals {
                let is_preferred = self.bridge_mm.is_none() && !self.is_own(goal);
                self.allowed =
                    self.attempts.len() + if is_preferred { MOST_PREFERRED.min(most) } else { most };
                if let Some(found) = self.over_strips(strips, goal, bar) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// The first strip of one height that does, if any.
    fn over_strips(&mut self, strips: &mut Strips, goal: Goal, bar: Bar) -> Option<Found> {
        let Bar { worst_misfit, scraps } = bar;
        // A tile begins and ends with one and the same cut, which leaves too few ways to be choosy.
        let scraps = if self.job.tile { MOST_SCRAPS } else { scraps };
        let given = self.job.band.options.seed;
        let seeds: Vec<Option<u64>> = match given {
            Some(_) => vec![given],
            // Where one component is only preferred, other strips are not worth the time.
            None if !self.is_own(goal) => vec![None],
            None => std::iter::once(None).chain(SEEDS.map(Some)).collect(),
        };
        let mut wishes = Vec::new();
        for seed in seeds {
            for goal in first_goals(goal, self.job.is_rolled()) {
                // What the exemplar has as it is goes before what a mirror makes of it.
                wishes.extend([false, true].map(|fold| Wish { goal, seed, worst_misfit, scraps, fold }));
            }
        }
        for wish in wishes {
            if self.attempts.len() >= self.allowed
                || (self.bridge_mm.is_some() && self.has_given_bridges_up())
            {
                return None;
            }
            // What no strip can be at all is nobody's wish; the rest is only tried, and costs nothing but that.
            let is_told = self.error.as_ref().is_some_and(|((is_own, ..), _)| *is_own);
            let explained = is_any(wish.goal) && !is_told;
            let strip = match strips.get(wish, explained, self.clock) {
                Ok(Some(strip)) => strip,
                Ok(None) => continue,
                Err(error) => {
                    self.attempts.push(Attempt::first(&strips.job(wish), error.to_string()));
                    self.note((is_any(wish.goal), false, matches!(error, JobError::Refused(_))), error);
                    continue;
                }
            };
            let told = self.error.as_ref().is_some_and(|&((is_own, is_second, _), _)| is_own && is_second);
            let explained = self.is_own(goal) && !told;
            for split in 0..if self.job.tile { SPLITS } else { 1 } {
                let rows =
                    RowsWish { goal, worst_misfit: worst_misfit.min(ROWS_MISFIT), scraps, explained, split };
                if let Some((way, second)) = self.over_strip(&strip, rows, &strips.exemplar) {
                    return Some(Found {
                        first: strip,
                        second,
                        cuts_mm: cuts_mm(&way.cut),
                        chosen: self.attempts.len() - 1,
                        attempts: std::mem::take(&mut self.attempts),
                        exemplar: strips.exemplar.clone(),
                    });
                }
            }
        }
        None
    }

    /// A second pass over a strip, if it comes out right.
    fn over_strip(&mut self, strip: &Strip, wish: RowsWish, exemplar: &Exemplar) -> Option<(Way, Made)> {
        let way = Way::new(self.job, strip, wish, exemplar, &self.map, self.clock);
        self.attempts.push(Attempt::second(&strip.band, wish.worst_misfit, way.as_ref()));
        let made = way.and_then(|way| {
            let bridges = self.bridge_mm.map(|width_mm| (width_mm, self.job.band.options.goal));
            let made = way.made(strip, bridges, self.job, &self.map, self.clock);
            made.map(|made| (way, made))
        });
        made.map_err(|error| {
            if let Some(attempt) = self.attempts.last_mut() {
                attempt.outcome = error.to_string();
            }
            if let JobError::Bridge(why) = &error {
                self.unbridged.get_or_insert_with(|| why.clone());
            }
            let has_reason = wish.explained && matches!(error, JobError::Refused(_));
            self.note((self.is_own(wish.goal), true, has_reason), error);
        })
        .ok()
    }

    /// Whether rows with this goal are what was asked for.
    fn is_own(&self, goal: Goal) -> bool {
        goal == self.job.band.options.goal
    }

    /// Whether bridges took too long to look for: over other rows they would again.
    fn has_given_bridges_up(&self) -> bool {
        matches!(self.unbridged, Some(BridgeError::TooMuch { .. }))
    }

    /// The first of those counts that tell most.
    fn note(&mut self, telling: Telling, error: JobError) {
        if self.error.as_ref().is_none_or(|(known, _)| telling > *known) {
            self.error = Some((telling, error));
        }
    }

    fn refusal(self) -> JobError {
        let ways = self.attempts.len();
        let options = &self.job.band.options;
        let can_bridge = options.bridge_mm.is_none() && !self.job.tile && !self.job.is_rolled();
        let remedy = match (self.unbridged, options.goal.components, options.goal.holes) {
            (Some(why), ..) => format!("; and with bridges, {why}"),
            (None, Some(_), _) if can_bridge => ", or --bridge 1mm to join what stays apart".to_owned(),
            (None, None, Some(_)) if can_bridge => ", or --bridge 1mm to open and close holes".to_owned(),
            _ => String::new(),
        };
        match self.error {
            Some(((_, true, _), JobError::Refused(why))) => JobError::Refused(format!(
                "no rectangle of {} was found in {ways} way(s); in the first, {why}; try another --width{remedy}",
                self.job.size
            )),
            Some(((_, false, _), JobError::Refused(why))) => JobError::Refused(format!(
                "no rectangle of {} was found in {ways} way(s), no strip as long as it is wide: {why}; try another --width{remedy}",
                self.job.size
            )),
            Some((_, JobError::SearchTooLarge { .. })) => JobError::Refused(format!(
                "no rectangle of {} was found in {ways} way(s), and some were given up, as each may take a part of the search only; try counts nearer to the ornament's own, or another --width{remedy}",
                self.job.size
            )),
            Some((_, error)) => error,
            None => unreachable!("a height is tried, and it either succeeds or fails with an error"),
        }
    }
}
