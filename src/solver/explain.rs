//! Why no sequence meets the constraints, and what can be had instead.
//!
//! The constraints are taken up one after the other, length and drift first, until no sequence is left: the one
//! that was taken up last is named. The nearest count that can be had is looked for by solving for ranges of
//! counts, so there is a sequence with every count that is named.

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
    // What is not refused soon is taken to be possible: another constraint is the one to name.
    let problem = &Problem { variety: None, memory_limit: ATTEMPT_BYTES, ..problem.clone() };
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

    fn of(self, topology: Topology) -> u32 {
        match self {
            Self::Components => topology.components,
            Self::Holes => topology.holes,
        }
    }
}

/// Memory of one attempt, in bytes.
const ATTEMPT_BYTES: usize = 16 << 20;
/// Attempts on each side of the request.
const MOST_TRIES: usize = 12;

/// The count nearest to `wanted` with which a sequence exists, where `others` is the goal without it; `None` when
/// none was found. Ranges that lie next to each other, each twice as long as the last, are tried until there is a
/// sequence, and of that range always the half nearer to the request: what is named can be had, and is the
/// nearest unless attempts ran out.
fn nearest(problem: &Problem<'_>, others: Goal, wanted: Wanted, count: Count) -> Option<u32> {
    let attempt = |a: u32, b: u32| {
        let range = Wanted::between(a.min(b), a.max(b)).expect("the ends are in order");
        let solution = solve(problem, count.wanted(others, range))?;
        let pieces = solution.sequence.iter().map(|&piece| &problem.descriptors[piece]);
        let topology = problem.shape.topology(pieces).expect("a solution adds up");
        Ok::<u32, Unsolved>(count.of(topology))
    };
    // From the count next to the request away from it.
    let side = |next: u32, is_above: bool| {
        let away = |from: u32, by: u32| match is_above {
            true => from.saturating_add(by),
            false => from.saturating_sub(by),
        };
        let (mut near, mut length, mut far, mut found) = (next, 1, None, None);
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
                Err(_) => break,
            }
        }
        found
    };
    let below = wanted.least().checked_sub(1).and_then(|next| side(next, false));
    let above = wanted.most().checked_add(1).and_then(|next| side(next, true));
    [below, above].into_iter().flatten().min_by_key(|&n| (wanted.distance(n), n))
}
