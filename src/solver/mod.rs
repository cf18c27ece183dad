//! The best sequence of pieces under length, drift and topology constraints.
//!
//! The layer of the search is the length of the run in bins, not the number of its pieces, so that the target
//! length is met by construction (Zhou 2014 §3.6.2 fills a table by number of pieces and meets the length by
//! luck). A label is a run: its length, its last piece, its state of the [`Automaton`], its cost. Labels are
//! settled in the order of an admissible estimate of the whole cost (A*): the same search without topology,
//! run backwards, is exact for everything but the topology. Rings are opened at their narrowest cut.
//!
//! What this room promises to the next: a [`Solution`] meets every constraint of its [`Problem`], and no
//! other sequence that does costs less by more than its `gap`. Coordinates are not known here.
//!
//! [`Automaton`]: crate::topology::Automaton

mod bound;
mod connectivity;
mod counts;
mod explain;
mod labels;
mod open;
mod problem;
mod reach;
mod ring;
mod search;
mod variety;

pub use explain::{Refusal, explain};
pub use problem::{Cost, Problem, Solution, Step, Unsolved};
pub use variety::{Variety, autocorrelation};

use crate::topology::{Automaton, Goal, Shape};

/// The best sequence for `problem` with the topology of `goal`.
///
/// # Errors
/// [`Unsolved::Infeasible`] when no sequence meets the constraints, [`Unsolved::TooLarge`] when the search
/// would take more labels than [`Problem::label_limit`].
pub fn solve(problem: &Problem<'_>, goal: Goal) -> Result<Solution, Unsolved> {
    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
    match problem.shape {
        Shape::Open => open::solve_open(problem, &mut automaton),
        Shape::Ring => ring::solve_ring(problem, &mut automaton),
    }
}
