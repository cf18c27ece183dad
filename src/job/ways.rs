//! What sequences a band may follow when bridges are allowed, and which of them is the cheapest.
//!
//! A sequence that meets the counts all by itself may have to jump wherever the ornament would come apart, and then
//! it is made of scraps; one that leaves them to bridges runs on as it was drawn, but for its bridges. So both are
//! planned and their costs compared, with a price on each bridge. The dearer ones are kept for when the cheaper one
//! turns out to have no place for its bridges. Excluded: laying them ([`crate::fabricate::bridge`]).

use std::panic::resume_unwind;
use std::thread;

use schemars::JsonSchema;
use serde::Serialize;

use super::bridging;
use super::builder::BandJob;
use super::choice::{Choice, Chosen, choose};
use super::cut::Cut;
use super::error::JobError;
use super::plan::{Plan, PlanError, PlanOptions, Prospect, first_fit, why};
use super::planning::{plan_options, refused, strictly, with_any_successors, with_topology};
use super::stage::{Clock, Stage};
use crate::domain::BandMap;
use crate::pieces::CostWeights;
use crate::solver::{Tally, Unsolved};
use crate::topology::{Goal, Topology, Wanted};

/// The memory of a search for what bridges could do, in bytes, when they were not asked for.
const HINT_BYTES: usize = 16 << 20;
/// With bridges, a search for what needs none may take memory in this proportion, and one for what they need in the other.
const STRICT_PART: usize = 4;
const RELAXED_PART: usize = 8;
/// What a bridge costs, in λ: a short strut is seen about half as much as a jump, after which another part of the
/// ornament goes on. Less, and what hangs together with a few jumps is bridged; more, and what is drawn apart becomes
/// scraps.
const BRIDGE_JUMPS: f64 = 0.5;

/// What was weighed when bridges were allowed: a sequence, and the bridges that it needs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct WayReport {
    /// The components that the sequence was held to, without bridges; null when bridges were to see to them.
    pub components: Option<[u32; 2]>,
    /// The holes that the sequence was held to.
    pub holes: Option<[u32; 2]>,
    /// The cost of the cheapest such sequence (Zhou 2014 §3.6.1, with jumps and rises).
    pub cost: f64,
    /// The bridges that it needs.
    pub bridges: u32,
    /// The cost with that of the bridges.
    pub total_cost: f64,
    /// Whether this is the one that was made.
    pub chosen: bool,
}

/// Sequences that may be made.
pub(super) struct Way {
    goal: Goal,
    chosen: Chosen,
    /// Whether `chosen` has no more than the cheapest of those that the job takes.
    is_first_only: bool,
    /// What the cheapest adds up to.
    planned: Topology,
    bridges: u32,
    total_cost: f64,
}

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

/// The ways in which `job` can be made along the curve of `map`, the best first: at least one. Without bridges there is
/// one, which meets the goal by itself.
pub(super) fn ways(
    job: &BandJob,
    cut: &mut Cut,
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<Vec<Way>, JobError> {
    let options = plan_options(job, cut, map);
    if job.options.bridge_mm.is_some() && is_counted(options.goal) {
        return bridged_ways(job, &options, cut, clock);
    }
    let found = with_any_successors(&options, job.options.choice, job.options.counted, cut, clock);
    match found {
        Ok(chosen) => {
            let planned = with_topology(cut, &options, chosen.plans[0].clone()).1;
            let goal = options.goal;
            Ok(vec![Way { goal, chosen, is_first_only: false, planned, bridges: 0, total_cost: 0.0 }])
        }
        Err(error) => {
            let (error, hint) = clock.time(Stage::Solve, || why_with_hint(&options, cut, error));
            Err(refused(error, cut, &options, &hint))
        }
    }
}

/// Why there is no plan, and what bridges would do. Both are looked for at once, as a refusal should come soon.
fn why_with_hint(options: &PlanOptions, cut: &Cut, error: Unsolved) -> (PlanError, String) {
    if error != Unsolved::Infeasible || !is_counted(options.goal) {
        return (why(&cut.catalogue, options, error), String::new());
    }
    let (error, best) = thread::scope(|scope| {
        let best = scope.spawn(|| {
            relaxed(options.goal).into_iter().find_map(|goal| plan_for(options, goal, HINT_BYTES, cut))
        });
        (why(&cut.catalogue, options, error), best.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    let best = best.filter(|_| bridging::can_help(&error));
    let hint = |plan| bridging::hint(options.goal, with_topology(cut, options, plan).1);
    let hint = best.map_or_else(String::new, hint);
    (error, hint)
}

/// Whether there is something for bridges to do.
fn is_counted(goal: Goal) -> bool {
    goal.components.is_some() || goal.holes.is_some()
}

/// What is left of a goal for bridges to do the rest: the components rather than the holes, as slits across strands
/// show less than struts across gaps; and nothing.
fn relaxed(goal: Goal) -> Vec<Goal> {
    let free = Goal { components: None, holes: None, ..goal };
    let mut goals = vec![Goal { holes: None, ..goal }, Goal { components: None, ..goal }];
    goals.retain(|&part| part != goal && part != free);
    goals.push(free);
    goals
}

fn plan_for(options: &PlanOptions, goal: Goal, memory_limit: usize, cut: &Cut) -> Option<Plan> {
    let options = PlanOptions { goal, memory_limit, ..*options };
    first_fit(&cut.catalogue, &options, Prospect::UNKNOWN).ok()
}

fn bridged_ways(
    job: &BandJob,
    options: &PlanOptions,
    cut: &mut Cut,
    clock: &mut Clock<'_>,
) -> Result<Vec<Way>, JobError> {
    let goal = options.goal;
    let price = BRIDGE_JUMPS * job.options.weights.jump.max(CostWeights::default().jump);
    let way = |held: Goal, plan: Plan, cut: &Cut| {
        let (plan, planned) = with_topology(cut, options, plan);
        let bridges = bridges(goal, planned);
        let total_cost = plan.cost + price * f64::from(bridges);
        let chosen = Chosen { plans: vec![plan], sequences: None, is_exact: None };
        Way { goal: held, chosen, is_first_only: true, planned, bridges, total_cost }
    };
    // The time is better spent on what bridges need than on a search that may be for nothing.
    let strict = PlanOptions { memory_limit: options.memory_limit / STRICT_PART, ..*options };
    let strict = strictly(&strict, Choice::Cheapest, false, cut, clock);
    let mut ways: Vec<Way> = Vec::new();
    let refusal = match strict {
        Ok(mut chosen) => {
            ways.push(way(goal, chosen.plans.swap_remove(0), cut));
            None
        }
        Err(error) if bridging::can_help(&error) => Some(error),
        Err(error) => return Err(refused(error, cut, options, "")),
    };
    let relaxed = relaxed(goal);
    let (&free, parts) = relaxed.split_last().expect("a goal can be left to bridges altogether");
    let memory_limit = options.memory_limit / RELAXED_PART;
    let least = clock
        .time(Stage::Solve, || plan_for(options, free, memory_limit, cut))
        .map(|plan| way(free, plan, cut));
    if let Some(least) = least {
        // Nothing costs less than what is free, and what is held to a part of the goal needs a bridge too.
        let bound = least.chosen.plans[0].cost + price;
        let is_beaten = |ways: &[Way]| ways.iter().any(|way| way.total_cost <= bound);
        for &part in parts {
            // What meets a part of the goal though it is free is the best of those that are held to it.
            if !is_beaten(&ways) && least.total_cost > bound && !part.admits(least.planned) {
                let plan = clock.time(Stage::Solve, || plan_for(options, part, memory_limit, cut));
                add(&mut ways, plan.map(|plan| way(part, plan, cut)));
            }
        }
        add(&mut ways, Some(least));
    }
    // A stable sort: of equal ones, the one that needs fewer bridges.
    ways.sort_by(|a, b| a.total_cost.total_cmp(&b.total_cost).then(a.bridges.cmp(&b.bridges)));
    match refusal {
        Some(error) if ways.is_empty() => Err(refused(error, cut, options, "")),
        _ => Ok(ways),
    }
}

/// Adds a way, unless one that is known needs as many bridges and costs no more: mostly it is the same.
fn add(ways: &mut Vec<Way>, way: Option<Way>) {
    let is_new = |way: &Way| {
        !ways.iter().any(|known| known.bridges == way.bridges && known.total_cost <= way.total_cost)
    };
    let way = way.filter(is_new);
    ways.extend(way);
}

/// How many bridges a run needs for a goal: each changes one count by one.
fn bridges(goal: Goal, topology: Topology) -> u32 {
    let missed = |wanted: Option<Wanted>, has: u32| wanted.map_or(0, |wanted| wanted.distance(has));
    missed(goal.components, topology.components) + missed(goal.holes, topology.holes)
}

impl Way {
    /// The sequences of this way that the job takes.
    ///
    /// # Errors
    /// [`JobError`] when there is too much to list or draw so many.
    pub(super) fn runs(
        &self,
        job: &BandJob,
        cut: &Cut,
        map: &BandMap,
        clock: &mut Clock<'_>,
    ) -> Result<Runs, JobError> {
        let options = PlanOptions { goal: self.goal, ..plan_options(job, cut, map) };
        let own = &job.options;
        let chosen = if self.is_first_only && (own.choice != Choice::Cheapest || own.counted) {
            let chosen =
                clock.time(Stage::Solve, || choose(&cut.catalogue, &options, own.choice, own.counted));
            chosen.map_err(|error| refused(error, cut, &options, ""))?
        } else {
            self.chosen.clone()
        };
        let Chosen { plans, sequences, is_exact } = chosen;
        let bridge_mm = own.bridge_mm.filter(|_| self.goal != own.goal);
        let plans = plans.into_iter().map(|plan| with_topology(cut, &options, plan)).collect();
        Ok(Runs { plans, bridge_mm, sequences, is_exact })
    }
}

/// What was weighed, when there was something to weigh.
pub(super) fn weighed(ways: &[Way], chosen: usize) -> Vec<WayReport> {
    let report = |(number, way): (usize, &Way)| WayReport {
        components: way.goal.components.map(Wanted::ends),
        holes: way.goal.holes.map(Wanted::ends),
        cost: way.chosen.plans[0].cost,
        bridges: way.bridges,
        total_cost: way.total_cost,
        chosen: number == chosen,
    };
    let all = ways.iter().enumerate().map(report).collect();
    if ways.iter().all(|way| way.is_first_only) { all } else { Vec::new() }
}

/// What was weighed in a sentence; `None` when there was no choice.
pub(super) fn weighed_note(weighed: &[WayReport]) -> Option<String> {
    let way = |way: &WayReport| match way.bridges {
        0 => format!("cost {:.1} without bridges", way.cost),
        n => format!("cost {:.1} with {n} bridge(s), {:.1} together", way.cost, way.total_cost),
    };
    let (chosen, others): (Vec<_>, Vec<_>) = weighed.iter().partition(|way| way.chosen);
    let others: Vec<String> = others.into_iter().map(way).collect();
    let chosen = chosen.first().filter(|_| !others.is_empty())?;
    Some(format!("weighed: the sequence of {}; not taken: {}", way(chosen), others.join(", ")))
}
