//! Whether a goal can be met at all, whatever the length: reachability on the automaton itself.
//!
//! Of the states that a piece can be reached in, only those that no other dominates are followed: for one
//! component the coarsest, for no holes the finest. Most goals that an exemplar cannot meet fall here, without
//! a look at a single length. Excluded: goals without dominance, which have the graph of [`super::counts`].

use super::connectivity::Scope;
use super::problem::Problem;
use crate::topology::{Automaton, Dominance, StateId};

/// States that are followed before the question is left open.
const PATIENCE: usize = 40_000;

/// Whether no run within `scope` of any length meets the automaton's goal. `false` also when that was not found
/// out.
pub(super) fn is_never(problem: &Problem<'_>, automaton: &mut Automaton<'_>, scope: &Scope<'_>) -> bool {
    if automaton.dominance() == Dominance::Equal {
        return false;
    }
    let mut met: Vec<Vec<StateId>> = vec![Vec::new(); problem.pieces()];
    let mut queue: Vec<(usize, StateId)> = Vec::new();
    let starts = scope.firsts.iter().filter_map(|&piece| automaton.start(piece).map(|state| (piece, state)));
    for (piece, state) in starts.collect::<Vec<_>>() {
        meet(automaton, &mut met[piece], state).then(|| queue.push((piece, state)));
    }
    let mut patience = PATIENCE;
    while let Some((piece, state)) = queue.pop() {
        if !met[piece].contains(&state) {
            continue;
        }
        if patience == 0 || (scope.stop[piece].is_some() && automaton.accepts(state)) {
            return false;
        }
        patience -= 1;
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            if let Some(next) = automaton.step(state, step.to) {
                meet(automaton, &mut met[step.to], next).then(|| queue.push((step.to, next)));
            }
        }
    }
    true
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
