//! Why no sequence meets the constraints, and what can be had instead.
//!
//! The constraints are relaxed one after the other until a sequence exists: the one whose removal helped is
//! named. What can be had is found by carrying the least and greatest counts forward over all runs.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::problem::{Problem, Unsolved};
use super::{Solution, solve};
use crate::topology::{Goal, Shape};

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
    /// Every ring of this length is open somewhere.
    ClosedPattern,
    /// No sequence has so many holes.
    Holes {
        /// The nearest number that can be had, if it was found.
        nearest: Option<u32>,
    },
    /// No sequence has so many components.
    Components {
        /// The nearest number that can be had, if it was found.
        nearest: Option<u32>,
    },
    /// Each count can be had by itself, but not both together.
    Both {
        /// The number of holes nearest to the request among sequences with the wanted components.
        nearest_holes: Option<u32>,
    },
}

/// How far from the request a count is looked for.
const NEAREST_TRIES: u32 = 400;

/// The constraint that cannot be met, for a problem that [`solve`] found infeasible. `longest` bins are looked
/// at for sequences of other lengths.
pub fn explain(problem: &Problem<'_>, goal: Goal, longest: u32) -> Refusal {
    let feasible =
        |problem: &Problem<'_>, goal: Goal| !matches!(solve(problem, goal), Err(Unsolved::Infeasible));
    let undrifted = Problem { drift_limit: i32::MAX / 2, ..problem.clone() };
    let free = Goal::default();
    if !feasible(&undrifted, free) {
        return lengths(problem, longest);
    }
    if !feasible(problem, free) {
        return Refusal::Drift;
    }
    if goal.closed_pattern && !feasible(problem, Goal { closed_pattern: true, ..free }) {
        return Refusal::ClosedPattern;
    }
    let components = Goal { holes: None, ..goal };
    let holes = Goal { components: None, ..goal };
    if goal.components.is_some() && !feasible(problem, components) {
        let nearest = nearest(problem, goal.components, |n| Goal { components: Some(n), ..components });
        return Refusal::Components { nearest };
    }
    if goal.holes.is_some() && !feasible(problem, holes) {
        return Refusal::Holes {
            nearest: nearest(problem, goal.holes, |n| Goal { holes: Some(n), ..holes }),
        };
    }
    Refusal::Both { nearest_holes: nearest(problem, goal.holes, |n| Goal { holes: Some(n), ..goal }) }
}

/// The count nearest to `wanted` with which a sequence exists. The count of the best sequence without the
/// constraint bounds how far one has to look.
fn nearest(problem: &Problem<'_>, wanted: Option<u32>, with: impl Fn(u32) -> Goal) -> Option<u32> {
    let wanted = wanted?;
    let small = Problem { label_limit: problem.label_limit.min(200_000), variety: None, ..problem.clone() };
    let has = |n: u32| -> Option<Solution> { solve(&small, with(n)).ok() };
    (1..NEAREST_TRIES).find_map(|d| {
        let below = wanted.checked_sub(d).filter(|&n| has(n).is_some());
        below.or_else(|| wanted.checked_add(d).filter(|&n| has(n).is_some()))
    })
}

/// The lengths that sequences have, around the window.
fn lengths(problem: &Problem<'_>, longest: u32) -> Refusal {
    let reached = match problem.shape {
        Shape::Open => {
            let starts: Vec<usize> = (0..problem.pieces()).filter(|&p| problem.begin[p].is_some()).collect();
            reachable_lengths(problem, &starts, longest, |p| problem.end[p].is_some())
        }
        Shape::Ring => {
            let mut all = BTreeMap::new();
            for first in 0..problem.pieces() {
                let closes = |p: usize| problem.steps[p].iter().any(|s| s.to == first);
                all.extend(reachable_lengths(problem, &[first], longest, closes));
            }
            all
        }
    };
    Refusal::Length {
        below: reached.range(..problem.window.start()).next_back().map(|(&l, ())| l),
        above: reached.range(problem.window.end() + 1..).next().map(|(&l, ())| l),
    }
}

fn reachable_lengths(
    problem: &Problem<'_>,
    starts: &[usize],
    longest: u32,
    may_stop: impl Fn(usize) -> bool,
) -> BTreeMap<u32, ()> {
    let mut seen: FxHashMap<(u32, usize), ()> = FxHashMap::default();
    let mut queue: Vec<(u32, usize)> = starts.iter().map(|&p| (problem.widths[p], p)).collect();
    let mut found = BTreeMap::new();
    while let Some((length, piece)) = queue.pop() {
        if length > longest || seen.insert((length, piece), ()).is_some() {
            continue;
        }
        if may_stop(piece) {
            found.insert(length, ());
        }
        queue.extend(problem.steps[piece].iter().map(|s| (length + problem.widths[s.to], s.to)));
    }
    found
}
