//! From a sliced exemplar to a sequence that meets the goal of a job by itself.

use std::cell::OnceCell;

use super::builder::BandJob;
use super::choice::{Choice, Chosen, chosen};
use super::cut::Cut;
use super::error::JobError;
use super::plan::{Plan, PlanError, PlanOptions, Prospect, SEED_SPREAD, first_fit, is_impossible, why};
use super::refusal;
use super::stage::{Clock, Stage};
use crate::domain::BandMap;
use crate::solver::Unsolved;
use crate::topology::{Shape, Topology};

/// The best sequence for `job` along the curve of `map`, and what it adds up to.
pub(super) fn plan_run(
    job: &BandJob,
    cut: &mut Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<(Plan, Topology), JobError> {
    let options = plan_options(job, cut, map);
    let chosen = strictly(&options, Choice::Cheapest, false, cut, clock);
    // What else could be had here need not be what the rectangle could have.
    let mut chosen = chosen.map_err(|error| match error {
        PlanError::Refused { refusal, .. } => {
            JobError::Refused(refusal::reason(&cut.catalogue, &options, &refusal))
        }
        error => refused(error, cut, &options, ""),
    })?;
    Ok(with_topology(cut, &options, chosen.plans.swap_remove(0)))
}

/// As [`plan_run`], for one strip of many: no reason where there is no sequence; `None` when that is shown.
///
/// # Errors
/// [`JobError::SearchTooLarge`] when the search was given up.
pub(super) fn plan_strip(
    job: &BandJob,
    cut: &mut Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<Option<(Plan, Topology)>, JobError> {
    let options = plan_options(job, cut, map);
    match with_any_successors(&options, Choice::Cheapest, false, cut, clock) {
        Ok(mut chosen) => Ok(Some(with_topology(cut, &options, chosen.plans.swap_remove(0)))),
        Err(Unsolved::Infeasible) => Ok(None),
        Err(Unsolved::TooLarge { labels }) => Err(JobError::SearchTooLarge { labels }),
    }
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
    let plan = clock.time(Stage::Solve, || first_fit(&cut.catalogue, &options, Prospect::UNKNOWN)).ok()?;
    Some(with_topology(cut, &options, plan))
}

pub(super) fn plan_options(job: &BandJob, cut: &Cut, map: &BandMap) -> PlanOptions {
    PlanOptions {
        shape: if map.curve().is_closed() { Shape::Ring } else { Shape::Open },
        length_mm: map.curve().length_mm(),
        height_mm: cut.height_mm,
        goal: job.options.goal,
        weights: job.options.weights,
        seed: job.options.seed,
        seed_spread: SEED_SPREAD,
        variety: job.variety.map(|variety| variety.with_mirrored(cut.catalogue.originals())),
        memory_limit: job.memory_limit,
        effort: job.options.effort,
    }
}

/// The sequences that meet the goal. Nothing is refused for a join that was not in the table.
pub(super) fn strictly(
    options: &PlanOptions,
    choice: Choice,
    counted: bool,
    cut: &mut Cut,
    clock: &mut Clock<'_>,
) -> Result<Chosen, PlanError> {
    let found = with_any_successors(options, choice, counted, cut, clock);
    found.map_err(|error| clock.time(Stage::Solve, || why(&cut.catalogue, options, error)))
}

/// The same, without a reason where there is none.
pub(super) fn with_any_successors(
    options: &PlanOptions,
    choice: Choice,
    counted: bool,
    cut: &mut Cut,
    clock: &mut Clock<'_>,
) -> Result<Chosen, Unsolved> {
    let all = OnceCell::new();
    let all_joins = || all.get_or_init(|| cut.with_all_successors());
    // What cannot be had with all joins cannot be had with the cheapest few.
    let hopeless = OnceCell::new();
    let is_hopeless =
        || *hopeless.get_or_init(|| is_impossible(all_joins().as_ref().unwrap_or(&cut.catalogue), options));
    let found = clock.time(Stage::Solve, || {
        chosen(&cut.catalogue, options, choice, counted, Prospect::Open(&is_hopeless))
    });
    if found != Err(Unsolved::Infeasible) {
        return found;
    }
    let is_hopeless = is_hopeless();
    let Some(all) = all.into_inner().flatten() else { return found };
    cut.admit(all);
    if is_hopeless {
        return found;
    }
    clock.time(Stage::Solve, || chosen(&cut.catalogue, options, choice, counted, Prospect::Poor))
}

pub(super) fn with_topology(cut: &Cut, options: &PlanOptions, plan: Plan) -> (Plan, Topology) {
    // Independently of the automaton that led the search.
    let pieces = plan.sequence.iter().map(|&piece| &cut.catalogue.descriptors()[piece]);
    let topology = options.shape.topology(pieces).expect("a plan joins equal portals and leaves none");
    (plan, topology)
}

pub(super) fn refused(error: PlanError, cut: &Cut, options: &PlanOptions, hint: &str) -> JobError {
    match error {
        PlanError::TooLarge { labels } => JobError::SearchTooLarge { labels },
        PlanError::Refused { refusal, bin_mm } => {
            JobError::Refused(refusal::message(&cut.catalogue, options, &refusal, bin_mm) + hint)
        }
    }
}
