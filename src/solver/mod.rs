//! The best sequence of pieces under length, drift and topology constraints.
//!
//! The layer of the search is the length of the run in bins, not the number of its pieces, so that the target
//! length is met by construction (Zhou 2014 §3.6.2 fills a table by number of pieces and meets the length by
//! luck). A label is a run: its last piece, its state of the [`Automaton`], its cost. Walks along the length
//! (`pass`) look at the runs whose estimate is within a threshold, which grows until a run is found
//! (`cheapest`); the estimates are admissible (`estimates`): the same search with something ignored, run
//! backwards. Rings are opened at their narrowest cut (`family`).
//!
//! What this room promises to the next: a [`Solution`] meets every constraint of its [`Problem`], and no
//! other sequence that does costs less by more than its `gap`. Coordinates are not known here.
//!
//! [`Automaton`]: crate::topology::Automaton

mod beam;
mod best;
mod big;
#[cfg(test)]
mod bounds_tests;
mod census;
mod cheapest;
mod classes;
mod coarse;
mod completions;
mod connected;
mod connectivity;
mod counts;
mod cycles;
mod estimates;
mod explain;
mod family;
#[cfg(test)]
mod forced_tests;
mod graph;
mod labels;
mod lengths;
mod nearest;
mod pass;
mod price;
mod priced;
mod problem;
mod random;
mod reach;
mod recurrence;
mod rows;
#[cfg(test)]
mod sample_problems;
mod table;
mod tally;
mod variety;

pub use best::{best, canonical};
pub use census::Census;
pub use explain::{Refusal, explain};
pub use nearest::Nearest;
pub use problem::{Cost, Problem, Solution, Step, Unsolved};
pub use random::Random;
pub use reach::is_impossible;
pub use tally::{Tally, tally};
pub use variety::{Variety, autocorrelation, evenness, longest_repeat};

use crate::topology::{Automaton, Goal};

/// The best sequence for `problem` with the topology of `goal`.
///
/// # Errors
/// [`Unsolved::Infeasible`] when no sequence meets the constraints, [`Unsolved::TooLarge`] when the search passed
/// [`Problem::memory_limit`] or [`Problem::effort_limit`] and found none.
pub fn solve(problem: &Problem<'_>, goal: Goal) -> Result<Solution, Unsolved> {
    solve_unless(problem, goal, &|| false)
}

/// The same, for when something else may tell that there is no sequence, which takes too long to ask before a search
/// that may be short: `is_hopeless` is asked when this one turns out not to be.
///
/// # Errors
/// As [`solve`]; [`Unsolved::Infeasible`] also when it is hopeless.
pub fn solve_unless(
    problem: &Problem<'_>,
    goal: Goal,
    is_hopeless: &dyn Fn() -> bool,
) -> Result<Solution, Unsolved> {
    solve_with_effort(problem, goal, is_hopeless).0
}

/// The same, and how much work it was, in about as many labels.
fn solve_with_effort(
    problem: &Problem<'_>,
    goal: Goal,
    is_hopeless: &dyn Fn() -> bool,
) -> (Result<Solution, Unsolved>, usize) {
    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
    cheapest::cheapest(problem, &mut automaton, is_hopeless)
}
