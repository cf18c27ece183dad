//! Whether a goal can be met at all, whatever the length: reachability on the automaton itself.
//!
//! Of the states that a piece can be reached in, only those that no other dominates are followed: for one
//! component the coarsest, for no holes the finest. Most goals that an exemplar cannot meet fall here, without
//! a look at a single length. Goals without dominance have the graph of [`super::counts`], and where that is too large
//! what the pieces alone tell ([`super::coarse`]).

use super::coarse::ranges_or_bounds;
use super::connectivity::{Connectivity, Counts, NODE_LIMIT};
use super::counts::{Caps, Ranges, counts, work_limit};
use super::family::scopes;
use super::graph::Scope;
use super::problem::Problem;
use crate::topology::{Automaton, Dominance, Goal, StateId, Wanted};

/// States that are compared before the question is left open.
const PATIENCE: usize = 4_000_000;

/// Word operations of the passes over counts together that tell whether a goal [`is_impossible`]: less than a tenth of a
/// second. Graphs are made and ranges found besides, within limits of their own for each scope.
const SOON: usize = 100_000_000;
/// The memory by which the other passes are kept as short.
const SOON_BYTES: usize = 64 << 20;

/// Whether no sequence meets `goal`, as far as that is found out soon. `false` otherwise: then [`super::solve`] tells.
pub fn is_impossible(problem: &Problem<'_>, goal: Goal) -> bool {
    let problem = &Problem { memory_limit: problem.memory_limit.min(SOON_BYTES), ..problem.clone() };
    let scopes = scopes(problem, goal.closed_pattern);
    let (nodes, work) = (NODE_LIMIT / scopes.len().max(1), SOON / scopes.len().max(1));
    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
    scopes.iter().all(|scope| {
        is_never(problem, &mut automaton, scope) || { is_out(problem, goal, scope, nodes, work) }
    })
}

/// Whether no run within `scope` of any length meets the automaton's goal. `false` also when that was not found
/// out.
pub(super) fn is_never(problem: &Problem<'_>, automaton: &mut Automaton<'_>, scope: &Scope) -> bool {
    if automaton.dominance() == Dominance::Equal {
        return false;
    }
    let mut met: Vec<Vec<StateId>> = vec![Vec::new(); problem.pieces()];
    let mut queue: Vec<(usize, StateId)> = Vec::new();
    let starts = scope.starts.iter().filter_map(|&(p, _)| automaton.start(p).map(|state| (p, state)));
    for (piece, state) in starts.collect::<Vec<_>>() {
        meet(automaton, &mut met[piece], state).then(|| queue.push((piece, state)));
    }
    let mut patience = PATIENCE;
    while let Some((piece, state)) = queue.pop() {
        if !met[piece].contains(&state) {
            continue;
        }
        if scope.stop[piece].is_some() && automaton.accepts(state) {
            return false;
        }
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            if let Some(next) = automaton.step(state, step.to) {
                let Some(left) = patience.checked_sub(1 + met[step.to].len()) else { return false };
                patience = left;
                meet(automaton, &mut met[step.to], next).then(|| queue.push((step.to, next)));
            }
        }
    }
    true
}

/// Whether no run within `scope` of an accepted length has counts that meet the goal, as far as the graph of
/// connections knows. `false` also when that was not found out.
pub(super) fn is_out_of_range(problem: &Problem<'_>, goal: Goal, scope: &Scope) -> bool {
    is_out(problem, goal, scope, NODE_LIMIT, work_limit(problem))
}

/// The same, by passes over the graph of at most so many nodes and word operations; where it has more, by the pieces
/// alone.
fn is_out(problem: &Problem<'_>, goal: Goal, scope: &Scope, nodes: usize, work: usize) -> bool {
    let graph = Connectivity::of_kinds(problem, goal, scope, nodes);
    let graph = graph.as_ref();
    if ranges_or_bounds(problem, scope, graph).is_none_or(|ranges| is_outside(goal, ranges)) {
        return true;
    }
    let set = graph.and_then(|graph| counts(problem, graph, Caps::of(goal), work));
    let Some(set) = set else { return false };
    let all = |wanted: Option<Wanted>| wanted.map_or(0..=0, |w| w.least()..=w.most());
    !all(goal.components).any(|components| all(goal.holes).any(|holes| set.has(Counts { components, holes })))
}

/// Whether a count that is wanted lies beyond its range.
fn is_outside(goal: Goal, Ranges { least, most }: Ranges) -> bool {
    let is_off = |wanted: Option<Wanted>, least, most| {
        wanted.is_some_and(|wanted| wanted.most() < least || wanted.least() > most)
    };
    is_off(goal.components, least.components, most.components) || is_off(goal.holes, least.holes, most.holes)
}

/// Takes up a state unless another dominates it; those that it dominates go.
fn meet(automaton: &mut Automaton<'_>, met: &mut Vec<StateId>, state: StateId) -> bool {
    if met.iter().any(|&other| automaton.dominates(other, state)) {
        return false;
    }
    met.retain(|&other| !automaton.dominates(state, other));
    met.push(state);
    true
}
