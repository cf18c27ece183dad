//! The choice of both directions of a rectangle (Zhou 2014 §6.2).
//!
//! The first pass makes a strip: a band as long as the rectangle is wide. Turned by 90 degrees it is the exemplar
//! of the second pass, whose pieces are rows. The constraints bind the second pass only; the first is free in its
//! topology, and which strip lets the second succeed is not known before it was tried. So several ways are tried
//! in a fixed order: strips in one component and strips as they come, with one seed after another, at the height
//! that was asked for or at smaller ones. A strip whose rows do not follow each other well is also tried beside
//! its mirror image: a row that is cut anywhere can then go on as its own reflection, where every strand meets
//! itself. Of the two the cheaper is taken; their costs compare, as both are measured on the rectangle's width. The first
//! strip over which a second pass comes out right, in its topology and at the machine's tolerance, is the one.
//!
//! Excluded: the search for a sequence itself, which is that of a band.

use glam::DVec2;

use super::band::{Band, Drawn};
use super::builder::BandJob;
use super::cut::{Cut, read_exemplar, slice_region};
use super::error::JobError;
use super::part::Part;
use super::plan::Plan;
use super::planning::plan_run;
use super::rect_builder::RectJob;
use super::rect_report::Attempt;
use super::rect_tile::{clear_sides, join_own_copies, opened, side_by_side};
use super::stage::{Clock, Stage};
use crate::domain::{BandMap, CurveSpec, PlanarCurve};
use crate::exemplar::Exemplar;
use crate::fit::Sides;
use crate::planar::{GridPoint, Region, Tolerances};
use crate::topology::{Goal, Topology, Wanted};
use crate::verify::{self, Tiling};

/// Where no height is asked for, rows are at most this part of the rectangle's height. Larger, and there are too
/// few rows to look like a pattern; smaller, and ornaments shrink for no need.
const TALLEST_ROW: f64 = 0.25;
/// The heights that are tried, as parts of the first.
const HEIGHTS: [f64; 2] = [1.0, 0.6];
/// Seeds of strips that are tried when those without one fail.
const SEEDS: [u64; 2] = [1, 2];
/// A jump in the second pass costs so many λ. The strip is only as long as the exemplar is high, so a run of it
/// ends every few millimetres anyway; at the price of the first pass, short cycles of equal rows are the optimum.
const JUMP_FACTOR: f64 = 10.0;
/// What moving a row sideways costs in the second pass, as a multiple of the first pass's. A band may climb; a
/// rectangle whose rows wander has ragged sides.
const RISE_FACTOR: f64 = 200.0;
/// A second pass that costs no more than so many jumps for each height of a row is good enough: the mirror image is
/// not tried. Less, and searches take longer; more, and rows are joined that were better mirrored.
const GOOD_ROW: f64 = 3.0;
/// Successors that are weighed of each row where the mirror image stands beside the strip. A row's own reflection is
/// among the cheapest; more make the search longer and the pattern no better.
const MIRRORED_SUCCESSORS: usize = 6;
/// So many places are tried at which a tile's strip is split.
const SPLITS: usize = 2;
/// The most ways that are tried. More, and a refusal takes longer than anyone waits for it.
const MOST_ATTEMPTS: usize = 12;
/// The same for tiles, whose ways take longer and have more in common.
const MOST_TILE_ATTEMPTS: usize = 6;
/// The memory that the search for a strip and for its rows may take, in bytes: a way that has no sequence soon is
/// given up for the next one.
const STRIP_MEMORY_LIMIT: usize = 128 << 20;
/// See [`STRIP_MEMORY_LIMIT`].
const ROWS_MEMORY_LIMIT: usize = 16 << 20;
/// Rows may be pressed or stretched sideways by this much to fill the width: as a band along its length.
const STRETCH: std::ops::RangeInclusive<f64> = 0.7..=1.3;
/// The first pass may use this part of the chord error, so that both stay within it.
const FIRST_CHORD_SHARE: f64 = 0.5;

/// Both directions, and all that was tried for them.
pub(super) struct Found {
    /// The strip.
    pub(super) first: Band,
    /// The rectangle.
    pub(super) second: Made,
    /// Where the strip and the sheet were cut, in millimetres.
    pub(super) cuts_mm: [Vec<f64>; 2],
    pub(super) mirrored: bool,
    pub(super) attempts: Vec<Attempt>,
    pub(super) chosen: usize,
    pub(super) exemplar: Exemplar,
}

/// A second pass that has a plan.
struct Way {
    job: BandJob,
    cut: Cut,
    plan: Plan,
    planned: Topology,
    mirrored: bool,
    attempt: usize,
}

/// A rectangle that has passed.
pub(super) struct Made {
    pub(super) band: Band,
    pub(super) drawn: Drawn,
    /// What its copies make, if it is a tile.
    pub(super) tiling: Option<Tiling>,
}

/// A strip with the cuts of the exemplar that it was made of.
struct Strip {
    band: Band,
    cuts_mm: Vec<f64>,
}

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
    /// The first failure of a second pass, or of a first one as long as there is none.
    error: Option<(bool, JobError)>,
}

/// The first strip over which a second pass comes out right, with that pass.
pub(super) fn search(job: &RectJob, clock: &mut Clock<'_>) -> Result<Found, JobError> {
    let own = clock.time(Stage::Read, || read_exemplar(&job.band))?;
    let map = flat_map(job.size.height_mm(), job.size.width_mm())?;
    let mut search = Search {
        job,
        map,
        clock,
        attempts: Vec::new(),
        allowed: if job.tile { MOST_TILE_ATTEMPTS } else { MOST_ATTEMPTS },
        bridge_mm: None,
        error: None,
    };
    for height_mm in heights(job, &own) {
        for goal in goals(job) {
            if let Some(found) = search.at_height(height_mm, goal)? {
                return Ok(found);
            }
        }
    }
    // Bridges across the sides of a tile would have to match too.
    search.bridge_mm = job.band.options.bridge_mm.filter(|_| !job.tile);
    if search.bridge_mm.is_some() {
        let tried = search.attempts.len();
        for height_mm in heights(job, &own) {
            // As many ways again.
            search.allowed = tried + MOST_ATTEMPTS;
            if let Some(found) = search.at_height(height_mm, Goal::default())? {
                return Ok(found);
            }
        }
    }
    Err(search.refusal())
}

/// The map of a straight band.
fn flat_map(length_mm: f64, height_mm: f64) -> Result<BandMap, JobError> {
    Ok(BandMap::new(PlanarCurve::line(length_mm)?, -height_mm / 2.0, height_mm / 2.0)?)
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

impl Search<'_, '_> {
    /// The first strip of one height that does, if any.
    fn at_height(&mut self, height_mm: f64, goal: Goal) -> Result<Option<Found>, JobError> {
        let mut options = self.job.band.options.clone();
        options.width_mm = Some(height_mm);
        let tolerances = &self.job.band.tolerances;
        let tolerances = Tolerances::new(
            tolerances.chord_mm() * FIRST_CHORD_SHARE,
            tolerances.min_feature_mm(),
            tolerances.min_gap_mm(),
        )?;
        let job =
            BandJob { options, tolerances, variety: self.job.band.variety, memory_limit: STRIP_MEMORY_LIMIT };
        let exemplar = self.clock.time(Stage::Read, || read_exemplar(&job))?;
        let given = self.job.band.options.seed;
        let seeds: Vec<Option<u64>> = match given {
            Some(_) => vec![given],
            // Where one component is only preferred, other strips are not worth the time.
            None if goal != self.job.band.options.goal => vec![None],
            None => std::iter::once(None).chain(SEEDS.map(Some)).collect(),
        };
        let mut strips: Vec<Strip> = Vec::new();
        let mut refused = Vec::new();
        for seed in seeds {
            for first_goal in first_goals(goal) {
                // A seed changes what is cheap, not what can be.
                if refused.contains(&first_goal) || self.is_out_of_attempts() {
                    continue;
                }
                let mut job = job.clone();
                job.options.goal = first_goal;
                job.options.seed = seed;
                match self.new_strip(&job, &exemplar, &strips) {
                    Ok(None) => {}
                    Ok(Some(strip)) => {
                        if let Some((way, second)) = self.over_strip(&strip, goal, &exemplar) {
                            return Ok(Some(Found {
                                first: strip.band,
                                second,
                                cuts_mm: [strip.cuts_mm, cuts_mm(&way.cut)],
                                mirrored: way.mirrored,
                                attempts: std::mem::take(&mut self.attempts),
                                chosen: way.attempt,
                                exemplar,
                            }));
                        }
                        strips.push(strip);
                    }
                    Err(error) => {
                        refused.push(first_goal);
                        self.attempts.push(Attempt::first(&job, error.to_string()));
                        self.note(false, error);
                    }
                }
            }
        }
        Ok(None)
    }

    /// The cheapest second pass over a strip that comes out right. The mirror image doubles the pieces, so it is
    /// left alone where the strip follows itself well enough.
    fn over_strip(&mut self, strip: &Strip, goal: Goal, exemplar: &Exemplar) -> Option<(Way, Made)> {
        let splits = if self.job.tile { SPLITS } else { 1 };
        (0..splits).find_map(|split| self.over_split(strip, split, goal, exemplar))
    }

    fn is_out_of_attempts(&self) -> bool {
        self.attempts.len() >= self.allowed
    }

    /// The same for one place where a tile's strip is split.
    fn over_split(
        &mut self,
        strip: &Strip,
        split: usize,
        goal: Goal,
        exemplar: &Exemplar,
    ) -> Option<(Way, Made)> {
        if self.is_out_of_attempts() {
            return None;
        }
        let mut ways: Vec<Way> = self.way(strip, split, goal, false, exemplar).into_iter().collect();
        let rows = self.job.size.height_mm() / strip.band.report.width_mm;
        let is_good = |way: &Way| way.plan.cost <= GOOD_ROW * way.job.options.weights.jump.max(1.0) * rows;
        if let Some(at) = ways.iter().position(is_good)
            && let Some(second) = self.made(&ways[at], strip)
        {
            return Some((ways.swap_remove(at), second));
        }
        if !self.job.band.options.mirror {
            ways.extend(self.way(strip, split, goal, true, exemplar));
        }
        // Cheapest first, and in the order in which they were tried.
        ways.sort_by(|a, b| a.plan.cost.total_cmp(&b.plan.cost).then(a.attempt.cmp(&b.attempt)));
        ways.retain(|way| self.attempts[way.attempt].outcome == Attempt::PLANNED);
        ways.into_iter().find_map(|way| {
            let second = self.made(&way, strip)?;
            Some((way, second))
        })
    }

    /// A strip, unless there is one like it.
    fn new_strip(
        &mut self,
        job: &BandJob,
        exemplar: &Exemplar,
        known: &[Strip],
    ) -> Result<Option<Strip>, JobError> {
        let mut slice = |job: &BandJob, region: &Region| {
            self.clock.time(Stage::Slice, || slice_region(job, exemplar.clone(), region))
        };
        let mut cut = slice(job, exemplar.region())?;
        if self.job.tile {
            let (region, kept) = opened(exemplar.region(), None, &cut.slicing.cuts, 0, &job.options.kept)?;
            let mut job = job.clone();
            job.options.kept = kept;
            cut = slice(&job, &region)?;
            join_own_copies(&mut cut, false);
        }
        cut.sides = Sides::Filled;
        let map = flat_map(self.job.size.width_mm(), cut.height_mm)?;
        let (plan, planned) = plan_run(job, &mut cut, &map, self.clock)?;
        if known.iter().any(|strip| strip.band.plan.sequence == plan.sequence) {
            return Ok(None);
        }
        let band = Band::made(job, &cut, plan, planned, &map, None, self.clock)?;
        Ok(Some(Strip { band, cuts_mm: cuts_mm(&cut) }))
    }

    /// A second pass over a strip, if there is a plan for it.
    fn way(
        &mut self,
        strip: &Strip,
        split: usize,
        goal: Goal,
        mirrored: bool,
        exemplar: &Exemplar,
    ) -> Option<Way> {
        let mut options = self.job.band.options.clone();
        options.along = CurveSpec::Line { length_mm: self.job.size.height_mm() };
        options.goal = goal;
        // What is kept whole are places of the exemplar, and these the strip has kept already.
        options.kept.clear();
        options.weights.jump *= JUMP_FACTOR;
        options.weights.rise *= RISE_FACTOR;
        if mirrored {
            options.weights.successors = options.weights.successors.min(MIRRORED_SUCCESSORS);
        }
        let job = BandJob { options, memory_limit: ROWS_MEMORY_LIMIT, ..self.job.band.clone() };
        let attempt = self.attempts.len();
        match self.rows(&job, strip, split, mirrored, exemplar) {
            Ok((cut, plan, planned)) => {
                self.attempts.push(Attempt::second(&strip.band, mirrored, Ok(&plan)));
                Some(Way { job, cut, plan, planned, mirrored, attempt })
            }
            Err(error) => {
                self.attempts.push(Attempt::second(&strip.band, mirrored, Err(&error)));
                self.note(true, error);
                None
            }
        }
    }

    /// The strip cut into rows, and their best sequence.
    fn rows(
        &mut self,
        job: &BandJob,
        strip: &Strip,
        split: usize,
        mirrored: bool,
        exemplar: &Exemplar,
    ) -> Result<(Cut, Plan, Topology), JobError> {
        let mut slice =
            |region: &Region| self.clock.time(Stage::Slice, || slice_region(job, exemplar.clone(), region));
        // The lower side to the right, so that rows come in reading order.
        let standing = strip.band.part.region.turned_left();
        let image = mirrored.then(|| standing.mirrored());
        let mut cut;
        if self.job.tile {
            cut = slice(&standing)?;
            clear_sides(&mut cut);
            let (region, _) = opened(&standing, image.as_ref(), &cut.slicing.cuts, split, &[])?;
            cut = slice(&region)?;
            join_own_copies(&mut cut, true);
        } else {
            let sheet: Vec<&Region> = std::iter::once(&standing).chain(&image).collect();
            cut = slice(&side_by_side(&sheet))?;
            cut.sides = Sides::Filled;
        }
        let (plan, planned) = plan_run(job, &mut cut, &self.map, self.clock)?;
        Ok((cut, plan, planned))
    }

    /// The rectangle of a way, upright, if it comes out right.
    fn made(&mut self, way: &Way, strip: &Strip) -> Option<Made> {
        self.try_making(way, strip)
            .map_err(|error| {
                self.attempts[way.attempt].outcome = error.to_string();
                self.note(true, error);
            })
            .ok()
    }

    fn try_making(&mut self, way: &Way, strip: &Strip) -> Result<Made, JobError> {
        let Way { job, cut, plan, planned, .. } = way;
        let mut job = job.clone();
        if self.bridge_mm.is_some() {
            job.options.goal = self.job.band.options.goal;
        }
        let mut band = Band::made(&job, cut, plan.clone(), *planned, &self.map, None, self.clock)?;
        if !STRETCH.contains(&band.report.squash) {
            return Err(JobError::Refused(format!(
                "the rows would have to be pressed or stretched sideways by {:.0} % to fill the width",
                (band.report.squash - 1.0).abs() * 100.0
            )));
        }
        band.part = turned_back(&band.part);
        if let Some(width_mm) = self.bridge_mm {
            self.clock.time(Stage::Bridge, || band.lay_bridges(width_mm, None))?;
        }
        // What messages call the width of a band is the height of a row here.
        band.report.width_mm = strip.band.report.width_mm;
        // Ink that the machine cannot make may be thicker another way.
        let drawn = band.drawn(self.clock)?;
        let tiling = match self.job.tile {
            true => Some(self.clock.time(Stage::Verify, || verify::tiling(&drawn.found.region))?),
            false => None,
        };
        Ok(Made { band, drawn, tiling })
    }

    /// The first failure counts; those of second passes tell more.
    fn note(&mut self, is_second: bool, error: JobError) {
        if self.error.as_ref().is_none_or(|(known, _)| is_second && !known) {
            self.error = Some((is_second, error));
        }
    }

    fn refusal(self) -> JobError {
        let ways = self.attempts.len();
        match self.error {
            Some((true, JobError::Refused(why))) => JobError::Refused(format!(
                "no rectangle of {}: {ways} way(s) of making it were tried; of the first, whose rows are the pieces, {why}; another --width may help",
                self.job.size
            )),
            Some((false, JobError::Refused(why))) => JobError::Refused(format!(
                "no rectangle of {}: no strip as long as it is wide: {why}",
                self.job.size
            )),
            Some((_, error)) => error,
            None => unreachable!("a height is tried, and it either succeeds or fails with an error"),
        }
    }
}

/// The topologies that strips are asked for. The rows of a strip that hangs together do so too, mostly.
fn first_goals(goal: Goal) -> Vec<Goal> {
    let one = Goal { components: Some(Wanted::exactly(1)), ..Goal::default() };
    match goal.holes {
        Some(_) => vec![one, Goal { holes: Some(Wanted::exactly(0)), ..one }, Goal::default()],
        None => vec![one, Goal::default()],
    }
}

/// A part that lies on its left side, set upright on its page.
fn turned_back(part: &Part) -> Part {
    let (low, high) = part.region.bounds_mm().unwrap_or_default();
    let grid = part.region.grid();
    // The turn takes x to −y; the margin below is that which was on the right.
    let up = grid.steps(low.x) + grid.steps(high.x);
    let region = part.region.turned_right().shifted(GridPoint::new(0, up));
    Part { region, page_mm: DVec2::new(part.page_mm.y, part.page_mm.x), ..part.clone() }
}

fn cuts_mm(cut: &Cut) -> Vec<f64> {
    cut.slicing.cuts.iter().map(|c| cut.region().grid().mm(c.x)).collect()
}
