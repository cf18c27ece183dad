//! Why no sequence meets the constraints, and what can be had instead.
//!
//! The constraints are taken up one after the other, length and drift first, until no sequence is left: the one
//! that was taken up last is named. Which counts can be had is read off a pass along the length, and the
//! nearest of them is confirmed by a solution before it is named.

use super::connectivity::{Connectivity, Counts};
use super::counts::{Caps, Ranges, counts, ranges};
use super::family::scopes;
use super::lengths::{lengths, stays_in_band};
use super::problem::{Problem, Unsolved};
use super::solve;
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

/// The constraint that cannot be met, for a problem that [`solve`] found infeasible. `longest` bins are looked
/// at for sequences of other lengths.
pub fn explain(problem: &Problem<'_>, goal: Goal, longest: u32) -> Refusal {
    let feasible = |goal: Goal| !matches!(solve(problem, goal), Err(Unsolved::Infeasible));
    let free = Goal::default();
    let lengths = lengths(problem, longest.max(*problem.window.end()));
    if lengths.range(problem.window.clone()).next().is_none() {
        return Refusal::Length {
            below: lengths.range(..problem.window.start()).next_back().copied(),
            above: lengths.range(problem.window.end() + 1..).next().copied(),
        };
    }
    if !stays_in_band(problem).unwrap_or_else(|| feasible(free)) {
        return Refusal::Drift;
    }
    if goal.closed_pattern && !feasible(Goal { closed_pattern: true, ..free }) {
        return Refusal::ClosedPattern;
    }
    let components = Goal { holes: None, ..goal };
    let holes = Goal { components: None, ..goal };
    if let Some(wanted) = goal.components.filter(|_| !feasible(components)) {
        let others = Goal { components: None, ..components };
        return Refusal::Components { nearest: nearest(problem, others, wanted, Count::Components) };
    }
    let others = Goal { holes: None, ..holes };
    match goal.holes {
        Some(wanted) if !feasible(holes) => {
            Refusal::Holes { nearest: nearest(problem, others, wanted, Count::Holes) }
        }
        wanted => Refusal::Both {
            nearest_holes: wanted.and_then(|wanted| nearest(problem, components, wanted, Count::Holes)),
        },
    }
}

/// Which count is looked for.
#[derive(Clone, Copy, PartialEq)]
enum Count {
    Components,
    Holes,
}

impl Count {
    /// `goal` with this count too.
    fn wanted(self, goal: Goal, wanted: Wanted) -> Goal {
        match self {
            Self::Components => Goal { components: Some(wanted), ..goal },
            Self::Holes => Goal { holes: Some(wanted), ..goal },
        }
    }

    fn of(self, counts: Counts) -> u32 {
        match self {
            Self::Components => counts.components,
            Self::Holes => counts.holes,
        }
    }
}

/// Joins that may be looked at, in all attempts to confirm a count: about a second at the very worst.
const PATIENCE: usize = 100_000_000;
/// Attempts to confirm a count, at most.
const MOST_TRIES: usize = 400;
/// Memory of one attempt, in bytes.
const ATTEMPT_BYTES: usize = 32 << 20;

/// The count nearest to `wanted` with which a sequence exists, where `others` is the goal without it; `None` when
/// it was not found out.
fn nearest(problem: &Problem<'_>, others: Goal, wanted: Wanted, count: Count) -> Option<u32> {
    let graphs = graphs(problem, others)?;
    let mut candidates: Vec<u32> = Vec::new();
    for graph in &graphs {
        let Some(Ranges { least, most }) = ranges(problem, graph) else { continue };
        let (least, most) = (count.of(least), count.of(most));
        let up_to = Wanted::between(0, most)?;
        match counts(problem, graph, Caps::of(count.wanted(others, up_to))) {
            Some(set) => {
                let given = others.components.map_or(0..=0, |c| c.least()..=c.most());
                candidates.extend((least..=most).filter(|&n| match count {
                    Count::Components => set.has(Counts { components: n, holes: 0 }),
                    Count::Holes => given.clone().any(|c| set.has(Counts { components: c, holes: n })),
                }));
            }
            // With one count alone the ends of its range can be had.
            None if wanted.most() <= least && others.components.is_none() => candidates.push(least),
            None if wanted.least() >= most && others.components.is_none() => candidates.push(most),
            None => return None,
        }
    }
    candidates.sort_unstable_by_key(|&n| (wanted.distance(n), n));
    candidates.dedup();
    let joins: usize = graphs.iter().map(Connectivity::joins).sum();
    let work = joins.saturating_mul(*problem.window.end() as usize).max(1);
    let tries = (PATIENCE / work).clamp(2, MOST_TRIES);
    let small = Problem { variety: None, memory_limit: ATTEMPT_BYTES, ..problem.clone() };
    for n in candidates.into_iter().filter(|&n| !wanted.contains(n)).take(tries) {
        match solve(&small, count.wanted(others, Wanted::exactly(n))) {
            Ok(_) => return Some(n),
            Err(Unsolved::Infeasible) => {}
            Err(Unsolved::TooLarge { .. }) => return None,
        }
    }
    None
}

/// The graphs of all runs that a goal allows: one for open runs, one for each narrowest cut of rings. `None` when
/// one is too large.
fn graphs(problem: &Problem<'_>, goal: Goal) -> Option<Vec<Connectivity>> {
    scopes(problem, goal.closed_pattern).iter().map(|scope| Connectivity::new(problem, goal, scope)).collect()
}
