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

use super::bound::{Bound, NEVER, TopologyBound};
use super::connectivity::Scope;
use super::labels::column;
use super::open::{Prospect, prospect, short};
use super::problem::{Cost, Problem, Solution, Unsolved};
use super::search::{Outcome, Task, solve_task};
use crate::topology::Automaton;

/// The cheapest ring.
pub(super) fn solve_ring(problem: &Problem<'_>, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
    let mut rings = Rings { problem, best: None, floor: NEVER, labels: 0 };
    for m in narrowest_cuts(problem, automaton.goal().closed_pattern) {
        rings.opened_at(automaton, m);
    }
    let Rings { best, floor, labels, .. } = rings;
    match best {
        Some((total, solution)) => {
            let gap = total.saturating_sub(floor);
            Ok(Solution { labels, gap, states: automaton.len(), ..solution })
        }
        None if floor == NEVER => Err(Unsolved::Infeasible),
        None => Err(Unsolved::TooLarge { labels }),
    }
}

/// The numbers of portals at which rings may have their narrowest cut.
pub(super) fn narrowest_cuts(problem: &Problem<'_>, winds: bool) -> Vec<usize> {
    let mut portals: Vec<usize> = problem.descriptors.iter().map(|d| d.left().len()).collect();
    portals.sort_unstable();
    portals.dedup();
    // What is broken somewhere does not go all the way round.
    portals.retain(|&m| m > 0 || !winds);
    portals
}

/// The pieces that rings with m portals at the narrowest cut may consist of, and those that they may begin with.
pub(super) fn pieces_of(problem: &Problem<'_>, m: usize) -> (Vec<bool>, Vec<usize>) {
    let (left, right) =
        (|p: usize| problem.descriptors[p].left().len(), |p: usize| problem.descriptors[p].right().len());
    let allowed: Vec<bool> = (0..problem.pieces()).map(|p| left(p) >= m && right(p) >= m).collect();
    let firsts = (0..problem.pieces()).filter(|&p| allowed[p] && left(p) == m).collect();
    (allowed, firsts)
}

/// The search for the cheapest ring.
struct Rings<'p> {
    problem: &'p Problem<'p>,
    /// The best so far, with its cost in all.
    best: Option<(Cost, Solution)>,
    /// No ring that was looked for costs less, unless it costs no less than the best.
    floor: Cost,
    labels: usize,
}

impl Rings<'_> {
    /// Looks at the rings with `m` portals at the narrowest cut. Short searches come first; when they do not
    /// end, the estimate with the topology is made, once for all first pieces.
    fn opened_at(&mut self, automaton: &mut Automaton<'_>, m: usize) {
        let problem = self.problem;
        let (mut allowed, mut firsts) = pieces_of(problem, m);
        let mut topology: Option<Box<TopologyBound>> = None;
        let mut short = Some(short(problem));
        while let Some((first, estimate)) = most_promising(problem, &firsts, &allowed) {
            let ceiling = self.ceiling();
            if estimate >= ceiling {
                return;
            }
            let stop = closing_costs(problem, &[first], &allowed);
            let bound = Bound::new(problem, &stop, &allowed);
            let estimate = bound.at(problem.widths[first], first);
            let mut seen = true;
            if estimate < ceiling {
                let left_over = problem.label_limit.saturating_sub(self.labels);
                let task = Task {
                    starts: vec![(first, 0)],
                    stop: &stop,
                    bound: &bound,
                    topology: topology.as_deref(),
                    ceiling,
                    label_limit: short.unwrap_or(left_over).min(left_over),
                    beams: short.is_none() && self.best.is_none(),
                };
                let outcome = solve_task(problem, automaton, &task);
                let (is_settled, labels) = (outcome.is_settled(), outcome.labels);
                seen = !outcome.drifted;
                self.take(outcome, is_settled || short.is_none());
                if !is_settled && short.take().is_some() {
                    let scope = Scope {
                        firsts: &firsts,
                        allowed: &allowed,
                        stop: &closing_costs(problem, &firsts, &allowed),
                    };
                    match prospect(problem, automaton, &scope) {
                        Prospect::Never => return,
                        Prospect::Open(found) => topology = found,
                    }
                    if let Some(bound) = &topology {
                        // Rings through a piece from which none can be completed at less are ruled out.
                        let ceiling = self.ceiling();
                        let mut is_open = |&first: &usize| {
                            let state = automaton.start(first);
                            let column = state.and_then(|state| column(automaton, bound, first, state));
                            column.is_some_and(|column| bound.at(problem.widths[first], column) < ceiling)
                        };
                        firsts.retain(|first| {
                            let keep = is_open(first);
                            allowed[*first] = keep;
                            keep
                        });
                    }
                    continue;
                }
                short = short.map(|limit| limit.saturating_sub(labels));
            }
            allowed[first] &= !seen;
            firsts.retain(|&p| p != first);
        }
    }

    fn ceiling(&self) -> Cost {
        self.best.as_ref().map_or(NEVER, |&(total, _)| total)
    }

    fn take(&mut self, outcome: Outcome, is_final: bool) {
        self.labels += outcome.labels;
        self.best = outcome.found.or(self.best.take());
        if is_final {
            self.floor = self.floor.min(outcome.floor);
        }
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
