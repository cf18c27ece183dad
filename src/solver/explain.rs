//! Why no sequence meets the constraints, and what can be had instead.
//!
//! The constraints are taken up one after the other, length and drift first, until no sequence is left: the one
//! that was taken up last is named. The nearest count that can be had is looked for by solving for ranges of
//! counts, so there is a sequence with every count that is named.

use super::connectivity::{Connectivity, NODE_LIMIT};
use super::counts::ranges;
use super::family::scopes;
use super::lengths::{lengths, stays_in_band};
use super::problem::{Problem, Unsolved};
use super::solve;
use crate::topology::{Goal, Topology, Wanted};

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

/// A count that can be had instead of the one that was wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nearest {
    /// The count.
    pub count: u32,
    /// Whether every count nearer to the request was found to be impossible.
    pub is_proven: bool,
}

/// The constraint that cannot be met, for a problem that [`solve`] found infeasible. `longest` bins are looked
/// at for sequences of other lengths.
pub fn explain(problem: &Problem<'_>, goal: Goal, longest: u32) -> Refusal {
    let problem = &Problem { variety: None, memory_limit: ATTEMPT_BYTES, ..problem.clone() };
    let free = Goal::default();
    let lengths = lengths(problem, longest.max(*problem.window.end()));
    if lengths.range(problem.window.clone()).next().is_none() {
        return Refusal::Length {
            below: lengths.range(..problem.window.start()).next_back().copied(),
            above: lengths.range(problem.window.end() + 1..).next().copied(),
        };
    }
    let is_refused = |goal: Goal| solve(problem, goal) == Err(Unsolved::Infeasible);
    if stays_in_band(problem).map_or_else(|| is_refused(free), |stays| !stays) {
        return Refusal::Drift;
    }
    // A constraint that is the only one left is the one to name; what is not refused soon is left open.
    let has_counts = goal.components.is_some() || goal.holes.is_some();
    if goal.closed_pattern && (!has_counts || is_refused(Goal { closed_pattern: true, ..free })) {
        return Refusal::ClosedPattern;
    }
    let components = Goal { holes: None, ..goal };
    let holes = Goal { components: None, ..goal };
    let others = Goal { components: None, holes: None, ..goal };
    match (goal.components, goal.holes) {
        (Some(wanted), None) => {
            Refusal::Components { nearest: nearest(problem, others, wanted, Count::Components) }
        }
        (None, Some(wanted)) => Refusal::Holes { nearest: nearest(problem, others, wanted, Count::Holes) },
        (None, None) => Refusal::Drift,
        (Some(of_components), Some(of_holes)) => {
            let [by_components, by_holes] = [components, holes].map(|goal| solve(problem, goal));
            if by_components == Err(Unsolved::Infeasible) {
                return Refusal::Components {
                    nearest: nearest(problem, others, of_components, Count::Components),
                };
            }
            if by_holes == Err(Unsolved::Infeasible) {
                return Refusal::Holes { nearest: nearest(problem, others, of_holes, Count::Holes) };
            }
            Refusal::Both {
                each_exists: by_components.is_ok() && by_holes.is_ok(),
                nearest_holes: nearest(problem, components, of_holes, Count::Holes),
            }
        }
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

    fn of(self, topology: Topology) -> u32 {
        match self {
            Self::Components => topology.components,
            Self::Holes => topology.holes,
        }
    }

    /// The least and the most that runs with the `others` can have, as far as the graph of connections knows: nothing
    /// beyond can be had. `None` when there is no run.
    fn ends(self, problem: &Problem<'_>, others: Goal) -> Option<(u32, u32)> {
        let mut ends: Option<(u32, u32)> = None;
        for scope in scopes(problem, others.closed_pattern) {
            let Some(graph) = Connectivity::new(problem, others, &scope, NODE_LIMIT) else {
                return Some((0, u32::MAX));
            };
            if let Some(found) = ranges(problem, &graph) {
                let (least, most) = match self {
                    Self::Components => (found.least.components, found.most.components),
                    Self::Holes => (found.least.holes, found.most.holes),
                };
                ends = Some(ends.map_or((least, most), |(low, high)| (low.min(least), high.max(most))));
            }
        }
        ends
    }
}

/// Memory of one attempt, in bytes.
const ATTEMPT_BYTES: usize = 16 << 20;
/// Attempts on each side of the request.
const MOST_TRIES: usize = 12;
/// Of them, those that come to nothing.
const MOST_UNKNOWN: usize = 4;

/// The count nearest to `wanted` with which a sequence exists, where `others` is the goal without it; `None` when
/// none was found. Ranges that lie next to each other, each twice as long as the last, are tried until there is a
/// sequence, and of that range always the half nearer to the request.
fn nearest(problem: &Problem<'_>, others: Goal, wanted: Wanted, count: Count) -> Option<Nearest> {
    let attempt = |a: u32, b: u32| {
        let range = Wanted::between(a.min(b), a.max(b)).expect("the ends are in order");
        let solution = solve(problem, count.wanted(others, range))?;
        let pieces = solution.sequence.iter().map(|&piece| &problem.descriptors[piece]);
        let topology = problem.shape.topology(pieces).expect("a solution adds up");
        Ok::<u32, Unsolved>(count.of(topology))
    };
    let (least, most) = count.ends(problem, others)?;
    // From the count next to the request away from it, or from the first that the graph knows; also the first that was not refused, if there is one.
    let side = |next: u32, is_above: bool| {
        let away = |from: u32, by: u32| match is_above {
            true => from.saturating_add(by).min(most),
            false => from.saturating_sub(by).max(least),
        };
        let next = if is_above { next.max(least) } else { next.min(most) };
        if !(least..=most).contains(&next) {
            return (None, None);
        }
        let (mut near, mut length, mut far, mut found) = (next, 1, None, None);
        // The first that was neither had nor refused, and how many ranges were so.
        let (mut open, mut unknown) = (None, 0);
        for _ in 0..MOST_TRIES {
            let reach = far.map_or(away(near, length - 1), |far| near.midpoint(far));
            match attempt(near, reach) {
                Ok(n) => {
                    found = Some(n);
                    far = Some(if is_above { n.saturating_sub(1) } else { n + 1 });
                    if n == near {
                        break;
                    }
                }
                Err(Unsolved::Infeasible) if Some(reach) != far && reach != away(reach, 1) => {
                    near = away(reach, 1);
                    length *= 2;
                }
                // No count is beyond.
                Err(Unsolved::Infeasible) if far.is_none() => return (found, open),
                Err(Unsolved::Infeasible) => return (found, open.or(found)),
                // What lies further may be found sooner.
                Err(Unsolved::TooLarge { .. })
                    if far.is_none() && unknown < MOST_UNKNOWN && reach != away(reach, 1) =>
                {
                    open = open.or(Some(near));
                    unknown += 1;
                    near = away(reach, 1);
                    length *= 2;
                }
                Err(Unsolved::TooLarge { .. }) => break,
            }
        }
        (found, open.or(Some(near)))
    };
    let below = wanted.least().checked_sub(1).map_or((None, None), |next| side(next, false));
    let above = wanted.most().checked_add(1).map_or((None, None), |next| side(next, true));
    let found = [below.0, above.0].into_iter().flatten().min_by_key(|&n| (wanted.distance(n), n))?;
    let open = [below.1, above.1].into_iter().flatten().map(|n| wanted.distance(n)).min();
    Some(Nearest { count: found, is_proven: open.is_none_or(|open| open >= wanted.distance(found)) })
}
