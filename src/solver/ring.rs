//! Rings, opened at their narrowest cut.
//!
//! A ring is a cyclic sequence; where it is opened does not matter to its topology, so it is opened at a cut
//! with the fewest portals, m. Pieces with fewer than m portals on a side then cannot occur, and with m = 1
//! the left labels say next to nothing. For each m, the first piece runs over the pieces with m portals on the
//! left; once the best ring through a first piece is known, that piece is removed, as every ring through it
//! has been seen. What is left is abandoned as soon as its cheapest conceivable ring costs no less than the
//! best found.
//!
//! The drift of a ring is measured from where it is opened, so a ring stays in the band if it does from one
//! of its narrowest cuts. That a ring has left the band from one first piece then says nothing about another,
//! and a first piece from which cheap runs left the band is not removed.

use super::bound::{Bound, NEVER};
use super::problem::{Cost, Problem, Solution, Unsolved};
use super::search::{Outcome, Task, solve_task};
use crate::topology::Automaton;

/// The cheapest ring.
pub(super) fn solve_ring(problem: &Problem<'_>, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
    let left = |p: usize| problem.descriptors[p].left().len();
    let right = |p: usize| problem.descriptors[p].right().len();
    let mut portals: Vec<usize> = (0..problem.pieces()).map(left).collect();
    portals.sort_unstable();
    portals.dedup();
    // What is broken somewhere does not go all the way round.
    portals.retain(|&m| m > 0 || !automaton.goal().closed_pattern);
    let mut best: Option<(Cost, Solution)> = None;
    let (mut labels, mut floor) = (0, NEVER);
    for m in portals {
        let mut allowed: Vec<bool> = (0..problem.pieces()).map(|p| left(p) >= m && right(p) >= m).collect();
        let mut firsts: Vec<usize> = (0..problem.pieces()).filter(|&p| allowed[p] && left(p) == m).collect();
        while let Some((first, estimate)) = most_promising(problem, &firsts, &allowed) {
            let ceiling = best.as_ref().map_or(NEVER, |b| b.0);
            if estimate >= ceiling {
                break;
            }
            let label_limit = problem.label_limit.saturating_sub(labels);
            if label_limit == 0 && best.is_some() {
                floor = floor.min(estimate);
                break;
            }
            let stop = closing_costs(problem, &[first], &allowed);
            let bound = Bound::new(problem, &stop, &allowed);
            let mut seen = true;
            if bound.at(problem.widths[first], first) < ceiling {
                let task =
                    Task { starts: vec![(first, 0)], stop: &stop, bound: &bound, ceiling, label_limit };
                let outcome: Outcome = solve_task(problem, automaton, &task);
                labels += outcome.labels;
                floor = floor.min(outcome.floor);
                seen = !outcome.drifted;
                best = outcome.found.or(best);
            }
            allowed[first] &= !seen;
            firsts.retain(|&p| p != first);
        }
    }
    match best {
        Some((total, solution)) => {
            let gap = total.saturating_sub(floor);
            Ok(Solution { labels, gap, states: automaton.len(), ..solution })
        }
        None if floor == NEVER => Err(Unsolved::Infeasible),
        None => Err(Unsolved::TooLarge { labels }),
    }
}

/// What closing a ring after each piece costs, when it began with the cheapest of `firsts`.
fn closing_costs(problem: &Problem<'_>, firsts: &[usize], allowed: &[bool]) -> Vec<Option<Cost>> {
    (0..problem.pieces())
        .map(|p| {
            let closing = problem.steps[p].iter().filter(|s| firsts.contains(&s.to));
            closing.map(|s| s.cost).min().filter(|_| allowed[p])
        })
        .collect()
}

/// The first piece whose cheapest conceivable ring is cheapest, with that cost: a path of the wanted length
/// from it to a join with any first piece.
fn most_promising(problem: &Problem<'_>, firsts: &[usize], allowed: &[bool]) -> Option<(usize, Cost)> {
    if firsts.is_empty() {
        return None;
    }
    let stop = closing_costs(problem, firsts, allowed);
    let bound = Bound::new(problem, &stop, allowed);
    let estimates = firsts.iter().map(|&f| (f, bound.at(problem.widths[f], f)));
    estimates.filter(|&(_, estimate)| estimate != NEVER).min_by_key(|&(f, estimate)| (estimate, f))
}
