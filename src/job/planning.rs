//! From a sliced exemplar to the sequences of a job: strictly, or with what bridges are going to mend.

use super::bridging;
use super::builder::BandJob;
use super::choice::{Choice, Chosen, choose, chosen};
use super::cut::Cut;
use super::error::JobError;
use super::plan::{Plan, PlanError, PlanOptions, first_fit, why};
use super::refusal;
use super::stage::{Clock, Stage};
use crate::domain::BandMap;
use crate::solver::{Tally, Unsolved};
use crate::topology::{Shape, Topology};

/// The memory of a search for what bridges could do, in bytes, when they were not asked for.
const HINT_BYTES: usize = 16 << 20;

/// With bridges, a search for what needs none may take memory in this proportion, and one for what they need in the other.
const STRICT_PART: usize = 4;
const RELAXED_PART: usize = 8;

/// The sequences of a job.
pub(super) struct Runs {
    /// Each with what it adds up to.
    pub(super) plans: Vec<(Plan, Topology)>,
    /// The width of bridges, when the sequences do not meet the goal by themselves.
    pub(super) bridge_mm: Option<f64>,
    /// As in [`Chosen`].
    pub(super) sequences: Option<Tally>,
    /// As in [`Chosen`].
    pub(super) is_exact: Option<bool>,
}

/// The best sequence for `job` along the curve of `map`, and what it adds up to.
pub(super) fn plan_run(
    job: &BandJob,
    cut: &mut Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<(Plan, Topology), JobError> {
    let options = plan_options(job, cut, map);
    let chosen = strictly(&options, Choice::Cheapest, false, cut, clock);
    let mut chosen = chosen.map_err(|error| refused(error, cut, &options, ""))?;
    Ok(with_topology(cut, &options, chosen.plans.swap_remove(0)))
}

/// As [`plan_run`], for one way of many: with the successors that are in the table only, and no reason where there is
/// no sequence.
pub(super) fn plan_way(
    job: &BandJob,
    cut: &Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Option<(Plan, Topology)> {
    let options = plan_options(job, cut, map);
    let plan = clock.time(Stage::Solve, || first_fit(&cut.catalogue, &options)).ok()?;
    Some(with_topology(cut, &options, plan))
}

/// The sequences that `job` chooses along the curve of `map`. Where none meets the goal and bridges are allowed, the
/// best for them.
pub(super) fn plan_runs(
    job: &BandJob,
    cut: &mut Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<Runs, JobError> {
    let options = plan_options(job, cut, map);
    // Where bridges are allowed, the time is better spent on what they need than on a search that may be for nothing.
    let part = if job.options.bridge_mm.is_some() { STRICT_PART } else { 1 };
    let strict = PlanOptions { memory_limit: options.memory_limit / part, ..options };
    let error = match strictly(&strict, job.options.choice, job.options.counted, cut, clock) {
        Ok(Chosen { plans, sequences, is_exact }) => {
            let plans = plans.into_iter().map(|plan| with_topology(cut, &options, plan)).collect();
            return Ok(Runs { plans, bridge_mm: None, sequences, is_exact });
        }
        Err(error) => error,
    };
    let bridge_mm = job.options.bridge_mm;
    let mut hint = String::new();
    // Without bridges allowed, looking for what they could do must not take longer than the refusal itself.
    if bridging::can_help(&error) && (bridge_mm.is_some() || matches!(error, PlanError::Refused { .. })) {
        let memory_limit = if bridge_mm.is_some() { options.memory_limit / RELAXED_PART } else { HINT_BYTES };
        let relaxed = || bridging::relaxed_plan(&cut.catalogue, &options, memory_limit);
        if let Some((goal, plan)) = clock.time(Stage::Solve, relaxed) {
            if bridge_mm.is_some() {
                let choice = job.options.choice;
                let Chosen { plans, is_exact, .. } = match choice {
                    Choice::Cheapest => Chosen { plans: vec![plan], sequences: None, is_exact: None },
                    // Bridges do the rest for each of many, too.
                    _ => clock
                        .time(Stage::Solve, || {
                            choose(&cut.catalogue, &PlanOptions { goal, ..options }, choice, false)
                        })
                        .map_err(|error| refused(error, cut, &options, ""))?,
                };
                let plans = plans.into_iter().map(|plan| with_topology(cut, &options, plan)).collect();
                return Ok(Runs { plans, bridge_mm, sequences: None, is_exact });
            }
            hint = bridging::hint(options.goal, with_topology(cut, &options, plan).1);
        }
    }
    Err(refused(error, cut, &options, &hint))
}

fn plan_options(job: &BandJob, cut: &Cut, map: &BandMap) -> PlanOptions {
    PlanOptions {
        shape: if map.curve().is_closed() { Shape::Ring } else { Shape::Open },
        length_mm: map.curve().length_mm(),
        height_mm: cut.height_mm,
        goal: job.options.goal,
        weights: job.options.weights,
        seed: job.options.seed,
        variety: job.variety.map(|variety| variety.with_mirrored(cut.catalogue.originals())),
        memory_limit: job.memory_limit,
    }
}

/// The sequences that meet the goal. Nothing is refused for a join that was not in the table.
fn strictly(
    options: &PlanOptions,
    choice: Choice,
    counted: bool,
    cut: &mut Cut,
    clock: &mut Clock<'_>,
) -> Result<Chosen, PlanError> {
    let mut found = clock.time(Stage::Solve, || chosen(&cut.catalogue, options, choice, counted));
    if found == Err(Unsolved::Infeasible) && cut.admit_all_successors() {
        found = clock.time(Stage::Solve, || chosen(&cut.catalogue, options, choice, counted));
    }
    found.map_err(|error| clock.time(Stage::Solve, || why(&cut.catalogue, options, error)))
}

fn with_topology(cut: &Cut, options: &PlanOptions, plan: Plan) -> (Plan, Topology) {
    // Independently of the automaton that led the search.
    let pieces = plan.sequence.iter().map(|&piece| &cut.catalogue.descriptors()[piece]);
    let topology = options.shape.topology(pieces).expect("a plan joins equal portals and leaves none");
    (plan, topology)
}

fn refused(error: PlanError, cut: &Cut, options: &PlanOptions, hint: &str) -> JobError {
    match error {
        PlanError::TooLarge { labels } => JobError::SearchTooLarge { labels },
        PlanError::Refused { refusal, bin_mm } => {
            JobError::Refused(refusal::message(&cut.catalogue, options, &refusal, bin_mm) + hint)
        }
    }
}
