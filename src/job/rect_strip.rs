//! The first pass of a rectangle: strips as long as it is wide.
//!
//! All strips of one height come from the exemplar at that height, and differ by what they were asked for. Each is
//! made when it is first wanted and then kept, as several second passes may be tried over it; one that follows
//! the plan of another is left out. Excluded: which strip is wanted, which is for [`super::rect_search`].

use super::band::Band;
use super::builder::BandJob;
use super::cut::{Cut, read_exemplar, slice_region};
use super::error::JobError;
use super::planning::{plan_run, plan_strip};
use super::rect_builder::RectJob;
use super::rect_tile::{join_own_copies, opened};
use super::stage::{Clock, Stage};
use crate::domain::{BandMap, PlanarCurve};
use crate::exemplar::Exemplar;
use crate::fit::StitchMethod;
use crate::planar::{Region, Tolerances};
use crate::topology::Goal;

/// The most memory that the search for a strip may take, in bytes: one that has no sequence soon is given up.
const STRIP_MEMORY_LIMIT: usize = 8 << 20;
/// What a jump of the misfit 1 costs in the first pass, in λ: as in the second, as much as the jump itself.
const MISFIT_COST: f64 = 1.0;
/// What climbing costs, as a multiple of what it costs a band. Less, and strips use one climbing piece up and another
/// down; more, and joins are taken that fit worse.
const RISE_FACTOR: f64 = 20.0;
/// So many jumps for each time that the exemplar fits the strip leave something of it. More, and it is scraps that are
/// repeated.
const JUMPS_PER_RUN: f64 = 4.0;
/// Successors that are weighed of each piece, of each orientation. More, and the search is longer; strips are no better.
const SUCCESSORS: usize = 8;
/// The first pass may use this part of the chord error, so that both stay within it.
const FIRST_CHORD_SHARE: f64 = 0.5;

/// A strip with the cuts of the exemplar that it was made of.
#[derive(Debug, Clone)]
pub(super) struct Strip {
    pub(super) band: Band,
    /// In millimetres.
    pub(super) cuts_mm: Vec<f64>,
}

impl Strip {
    /// How high its ink is.
    pub(super) fn height_mm(&self) -> f64 {
        self.band.part.region.bounds_mm().map_or(0.0, |(low, high)| high.y - low.y)
    }
}

/// What a strip is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wish {
    pub(super) goal: Goal,
    pub(super) seed: Option<u64>,
    /// The greatest misfit of a join.
    pub(super) worst_misfit: f64,
    /// How many times more jumps than strips usually have are accepted.
    pub(super) scraps: f64,
    /// Whether the exemplar is folded: it may go on as its own reflection, and hardly any other way. Such a strip is
    /// found at once where there are too many others to look at.
    pub(super) fold: bool,
}

impl Wish {
    /// Whether what cannot be for `other` cannot be for this one: a seed changes what is cheap, not what can be.
    fn is_within(&self, other: &Self) -> bool {
        self.worst_misfit <= other.worst_misfit && self.fold == other.fold && self.goal == other.goal
    }
}

/// The strips of one height.
pub(super) struct Strips {
    job: BandJob,
    pub(super) exemplar: Exemplar,
    tile: bool,
    /// Whether strips go all the way round, and close.
    rolled: bool,
    map_width_mm: f64,
    /// What was wished for, and what came of it.
    known: Vec<(Wish, Option<Strip>)>,
    /// Wishes that no sequence meets.
    refused: Vec<Wish>,
}

impl Strips {
    /// None yet.
    pub(super) fn new(job: &RectJob, height_mm: f64, clock: &mut Clock<'_>) -> Result<Self, JobError> {
        let mut options = job.band.options.clone();
        options.width_mm = Some(height_mm);
        let whole = &job.band.tolerances;
        let tolerances = Tolerances::new(
            whole.chord_mm() * FIRST_CHORD_SHARE,
            whole.min_feature_mm(),
            whole.min_gap_mm(),
        )?;
        let memory_limit = job.band.memory_limit.min(STRIP_MEMORY_LIMIT);
        let band = BandJob { options, tolerances, variety: job.band.variety, memory_limit, ground: None };
        let exemplar = clock.time(Stage::Read, || read_exemplar(&band))?;
        Ok(Self {
            job: band,
            exemplar,
            tile: job.tile,
            rolled: job.is_rolled(),
            map_width_mm: job.size.width_mm(),
            known: Vec::new(),
            refused: Vec::new(),
        })
    }

    /// The job of a strip.
    pub(super) fn job(&self, wish: Wish) -> BandJob {
        let mut job = self.job.clone();
        job.options.goal = wish.goal;
        job.options.seed = wish.seed;
        job.options.mirror |= wish.fold;
        job.options.weights.misfit = MISFIT_COST;
        job.options.weights.rise *= RISE_FACTOR;
        job.options.weights.successors = if wish.fold { 1 } else { SUCCESSORS };
        job.options.weights.worst_misfit = wish.worst_misfit;
        job
    }

    /// The strip that was wished for; `None` if there is none, or if it is the same as one of another wish. The reason
    /// for a refusal is looked for where it is to be `explained`.
    ///
    /// # Errors
    /// [`JobError`] when it cannot be made, the first time that it is wished for.
    pub(super) fn get(
        &mut self,
        wish: Wish,
        explained: bool,
        clock: &mut Clock<'_>,
    ) -> Result<Option<Strip>, JobError> {
        if let Some((_, strip)) = self.known.iter().find(|(known, _)| *known == wish) {
            return Ok(strip.clone());
        }
        if self.refused.iter().any(|refused| wish.is_within(refused)) {
            return Ok(None);
        }
        match self.made(wish, explained, clock) {
            Ok(strip) => {
                self.known.push((wish, strip.clone()));
                Ok(strip)
            }
            Err(error) => {
                self.known.push((wish, None));
                Err(error)
            }
        }
    }

    fn made(
        &mut self,
        wish: Wish,
        explained: bool,
        clock: &mut Clock<'_>,
    ) -> Result<Option<Strip>, JobError> {
        let mut job = self.job(wish);
        let mut slice = |job: &BandJob, region: &Region| {
            clock.time(Stage::Slice, || slice_region(job, self.exemplar.clone(), region))
        };
        let mut cut = slice(&job, self.exemplar.region())?;
        if self.tile {
            let (region, kept) =
                opened(self.exemplar.region(), &cut.slicing.cuts, 0, job.options.mirror, &job.options.kept)?;
            job.options.kept = kept;
            // Rotation-invariant deformation turns what no join holds, as the two ends that have to match.
            job.options.stitch = StitchMethod::Warp;
            cut = slice(&job, &region)?;
            join_own_copies(&mut cut, false);
        }
        let map = match self.rolled {
            true => rolled_map(self.map_width_mm, cut.height_mm)?,
            false => flat_map(self.map_width_mm, cut.height_mm)?,
        };
        let planned = match explained {
            true => plan_run(&job, &mut cut, &map, clock),
            false => plan_strip(&job, &mut cut, &map, clock).and_then(|found| {
                found.ok_or_else(|| {
                    JobError::Refused("none hangs together with strands that fit at every join".to_owned())
                })
            }),
        };
        let (plan, planned) = planned.inspect_err(|error| {
            // Whatever else is wrong depends on the sequence, and another seed gives another one.
            if matches!(error, JobError::Refused(_)) {
                self.refused.push(wish);
            }
        })?;
        let jumps = cut.catalogue.jumps_of(&plan.sequence);
        let runs = self.map_width_mm / cut.catalogue.width_mm();
        if jumps as f64 > wish.scraps * JUMPS_PER_RUN * runs.max(1.0) {
            return Err(JobError::Refused(format!(
                "the strip would have {jumps} jumps where the exemplar fits {runs:.1} times, and be made of scraps of it"
            )));
        }
        let mut strips = self.known.iter().filter_map(|(_, strip)| strip.as_ref());
        if strips.any(|strip| strip.band.plan.sequence == plan.sequence) {
            return Ok(None);
        }
        let band = Band::made(&job, &cut, plan, planned, &map, None, clock)?;
        Ok(Some(Strip { band, cuts_mm: cuts_mm(&cut) }))
    }
}

/// The map of a straight band.
pub(super) fn flat_map(length_mm: f64, height_mm: f64) -> Result<BandMap, JobError> {
    Ok(BandMap::new(PlanarCurve::line(length_mm)?, -height_mm / 2.0, height_mm / 2.0)?)
}

/// The map of a band that is closed and laid flat.
fn rolled_map(length_mm: f64, height_mm: f64) -> Result<BandMap, JobError> {
    Ok(BandMap::new(PlanarCurve::rolled(length_mm)?, -height_mm / 2.0, height_mm / 2.0)?)
}

/// Where a region was cut, in millimetres.
pub(super) fn cuts_mm(cut: &Cut) -> Vec<f64> {
    cut.slicing.cuts.iter().map(|c| cut.region().grid().mm(c.x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::RectBuilder;

    #[test]
    fn the_memory_limit_of_the_job_holds_for_its_strips() {
        for (asked, held) in [(1 << 20, 1 << 20), (1 << 30, STRIP_MEMORY_LIMIT)] {
            let job = RectBuilder::new("fixtures/exemplars/wave.svg", "60x40mm".parse().unwrap())
                .options(|band| band.memory_limit(asked))
                .build()
                .unwrap();
            let strips = Strips::new(&job, 10.0, &mut Clock::new(&mut |_| {})).unwrap();
            assert_eq!(strips.job.memory_limit, held);
        }
    }
}
