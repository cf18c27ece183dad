//! Open runs: first a short search, and only where that does not end, the questions that are dear to answer.

use super::bound::{Bound, NEVER, TopologyBound};
use super::connectivity::{Connectivity, Scope};
use super::counts::{Caps, counts, ranges};
use super::problem::{Problem, Solution, Unsolved};
use super::reach::is_never;
use super::search::{Outcome, Task, solve_task};
use crate::topology::Automaton;

/// The part of the label limit that the short search may use: 20,000 of 800,000. Most goals near the exemplar's
/// own topology need fewer.
const SHORT: usize = 40;

/// The labels of a short search.
pub(super) fn short(problem: &Problem<'_>) -> usize {
    problem.label_limit / SHORT
}

/// The cheapest open run.
pub(super) fn solve_open(problem: &Problem<'_>, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
    let allowed = vec![true; problem.pieces()];
    let bound = Bound::new(problem, &problem.end, &allowed);
    let starts: Vec<(usize, u64)> =
        problem.begin.iter().enumerate().filter_map(|(piece, cost)| cost.map(|c| (piece, c))).collect();
    let task = |topology, ceiling, label_limit: usize, beams| Task {
        starts: starts.clone(),
        stop: &problem.end,
        bound: &bound,
        topology,
        ceiling,
        label_limit: label_limit.min(problem.label_limit),
        beams,
    };
    let mut outcome = solve_task(problem, automaton, &task(None, NEVER, short(problem), false));
    if !outcome.is_settled() {
        let firsts: Vec<usize> = starts.iter().map(|&(piece, _)| piece).collect();
        let scope = Scope { firsts: &firsts, allowed: &allowed, stop: &problem.end };
        let Prospect::Open(topology) = prospect(problem, automaton, &scope) else {
            return Err(Unsolved::Infeasible);
        };
        let before = outcome;
        let ceiling = before.found.as_ref().map_or(NEVER, |&(total, _)| total);
        let long = task(topology.as_deref(), ceiling, usize::MAX, before.found.is_none());
        outcome = solve_task(problem, automaton, &long);
        outcome.labels += before.labels;
        outcome.floor = outcome.floor.max(before.floor);
        outcome.found = outcome.found.or(before.found);
    }
    let Outcome { found, floor, labels, .. } = outcome;
    match found {
        Some((total, solution)) => Ok(Solution { gap: total.saturating_sub(floor), labels, ..solution }),
        None if floor == NEVER => Err(Unsolved::Infeasible),
        None => Err(Unsolved::TooLarge { labels }),
    }
}

/// What can be said of a goal without a search.
pub(super) enum Prospect {
    /// It cannot be met.
    Never,
    /// It may be met; with the estimate for it, if it is not too large.
    Open(Option<Box<TopologyBound>>),
}

/// Looks at a goal that a short search could not decide.
pub(super) fn prospect(problem: &Problem<'_>, automaton: &mut Automaton<'_>, scope: &Scope<'_>) -> Prospect {
    let goal = automaton.goal();
    if goal.is_free() {
        return Prospect::Open(None);
    }
    if is_never(problem, automaton, scope) {
        return Prospect::Never;
    }
    let Some(graph) = Connectivity::new(problem, goal, scope) else {
        return Prospect::Open(None);
    };
    let ranges = ranges(problem, &graph);
    if !ranges.is_some_and(|ranges| ranges.admit(goal)) {
        return Prospect::Never;
    }
    if let Some(bound) = TopologyBound::new(problem, goal, &graph) {
        return Prospect::Open(Some(Box::new(bound)));
    }
    if counts(problem, &graph, Caps::of(goal)).is_some_and(|set| !set.has(goal)) {
        return Prospect::Never;
    }
    Prospect::Open(None)
}
