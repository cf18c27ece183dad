//! Why no sequence meets the constraints, and what can be had instead.
//!
//! The constraints are taken up one after the other, length and drift first, until no sequence is left: the one
//! that was taken up last is named. All searches for that share one effort, as a refusal has to come soon. Excluded:
//! the nearest count that can be had instead ([`super::nearest`]).

use super::lengths::{lengths, stays_in_band};
use super::nearest::{Count, Effort, Nearest, nearest};
use super::problem::{Problem, Unsolved};
use crate::topology::{Goal, Wanted};

/// Why a problem has no solution.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// No sequence has an acceptable length. The nearest lengths below and above that some sequence has, in
    /// bins; both `None` when there is no sequence at all.
    Length {
        /// The longest that is shorter.
        below: Option<u32>,
        /// The shortest that is longer.
        above: Option<u32>,
    },
    /// Sequences of this length exist, but all drift out of the band.
    Drift,
    /// Every ring of this length is open somewhere. An open run always is.
    ClosedPattern,
    /// No sequence has so many holes.
    Holes {
        /// The nearest number that can be had, if one was found.
        nearest: Option<Nearest>,
    },
    /// No sequence has so many components.
    Components {
        /// The nearest number that can be had, if one was found.
        nearest: Option<Nearest>,
    },
    /// Components and holes cannot be had together.
    Both {
        /// Whether each was found to be possible by itself.
        each_exists: bool,
        /// The number of holes nearest to the request among sequences with the wanted components.
        nearest_holes: Option<Nearest>,
    },
}

/// The constraint that cannot be met, for a problem that [`super::solve`] found infeasible. `longest` bins are looked
/// at for sequences of other lengths.
pub fn explain(problem: &Problem<'_>, goal: Goal, longest: u32) -> Refusal {
    let problem = &Problem { variety: None, ..problem.clone() };
    let free = Goal::default();
    let lengths = lengths(problem, longest.max(*problem.window.end()));
    if lengths.range(problem.window.clone()).next().is_none() {
        return Refusal::Length {
            below: lengths.range(..problem.window.start()).next_back().copied(),
            above: lengths.range(problem.window.end() + 1..).next().copied(),
        };
    }
    let mut effort = Effort::new(problem);
    if stays_in_band(problem).map_or_else(|| effort.solve(free) == Err(Unsolved::Infeasible), |stays| !stays)
    {
        return Refusal::Drift;
    }
    // A constraint that is the only one left is the one to name; what is not refused soon is left open.
    let closed = Goal { closed_pattern: true, ..free };
    let has_counts = goal.components.is_some() || goal.holes.is_some();
    if goal.closed_pattern && (!has_counts || effort.solve(closed) == Err(Unsolved::Infeasible)) {
        return Refusal::ClosedPattern;
    }
    let components = Goal { holes: None, ..goal };
    let holes = Goal { components: None, ..goal };
    let others = Goal { components: None, holes: None, ..goal };
    match (goal.components, goal.holes) {
        (Some(wanted), None) => {
            Refusal::Components { nearest: nearest(&mut effort, others, wanted, Count::Components) }
        }
        (None, Some(wanted)) => {
            Refusal::Holes { nearest: nearest(&mut effort, others, wanted, Count::Holes) }
        }
        (None, None) => Refusal::Drift,
        (Some(of_components), Some(of_holes)) => {
            let [by_components, by_holes] = effort.solve_both(components, holes);
            // A count that goes with the other one helps more than one that does not.
            let mut nearest_to = |together: Goal, wanted: Wanted, count: Count| {
                nearest(&mut effort, together, wanted, count).or_else(|| {
                    let alone = nearest(&mut effort, others, wanted, count)?;
                    Some(Nearest { is_alone: true, ..alone })
                })
            };
            if by_components == Err(Unsolved::Infeasible) {
                let nearest = nearest_to(holes, of_components, Count::Components);
                return Refusal::Components { nearest };
            }
            if by_holes == Err(Unsolved::Infeasible) {
                return Refusal::Holes { nearest: nearest_to(components, of_holes, Count::Holes) };
            }
            Refusal::Both {
                each_exists: by_components.is_ok() && by_holes.is_ok(),
                nearest_holes: nearest(&mut effort, components, of_holes, Count::Holes),
            }
        }
    }
}
