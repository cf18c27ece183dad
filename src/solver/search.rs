//! A* over labels, for runs from given first pieces to given last ones.
//!
//! Labels at one length and piece have the same estimate, so they are settled in the order of their cost, and
//! a label is dropped when one that is no dearer can stand for it (equal state, or dominance). Drift is not
//! part of what a label is known by at first: a run that drifts out of the band is dropped, and only if that
//! ever happened is the search run again with the drift as a part of the state, which is exact.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::bound::{Bound, NEVER};
use super::problem::{Cost, Problem, Solution, Unsolved};
use super::variety::extend;
use crate::topology::{Automaton, StateId};

/// A partial run.
struct Label {
    cost: Cost,
    length: u32,
    piece: u32,
    state: StateId,
    drift: i32,
    /// The label of the run without its last piece, or itself for the first.
    parent: u32,
}

/// Where runs begin and what they must look like.
pub(super) struct Task<'t> {
    /// First pieces and what beginning with them costs.
    pub(super) starts: Vec<(usize, Cost)>,
    /// What stopping after each piece costs, where it may stop.
    pub(super) stop: &'t [Option<Cost>],
    /// The least cost of completing a run, ignoring topology.
    pub(super) bound: &'t Bound,
    /// Only cheaper solutions are of interest.
    pub(super) ceiling: Cost,
}

/// The cheapest open run.
pub(super) fn solve_open(problem: &Problem<'_>, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
    let bound = Bound::new(problem, &problem.end, &vec![true; problem.pieces()]);
    let starts =
        problem.begin.iter().enumerate().filter_map(|(piece, cost)| cost.map(|c| (piece, c))).collect();
    let task = Task { starts, stop: &problem.end, bound: &bound, ceiling: NEVER };
    solve_task(problem, automaton, &task)
}

/// The cheapest run for `task`, exact in the drift.
pub(super) fn solve_task(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    task: &Task<'_>,
) -> Result<Solution, Unsolved> {
    let mut search = Search::new(problem, task, false);
    let found = search.run(automaton);
    if !search.drifted_out || matches!(found, Err(Unsolved::TooLarge { .. })) {
        return found;
    }
    let first_labels = search.labels.len();
    let mut exact = Search::new(problem, task, true);
    match (exact.run(automaton), found) {
        (Ok(best), _) => Ok(Solution { labels: best.labels + first_labels, ..best }),
        // A valid answer whose optimality could not be shown within the limit.
        (Err(Unsolved::TooLarge { .. }), Ok(valid)) => Ok(Solution { optimal: false, ..valid }),
        (Err(why), _) => Err(why),
    }
}

struct Search<'s> {
    problem: &'s Problem<'s>,
    task: &'s Task<'s>,
    by_drift: bool,
    drifted_out: bool,
    labels: Vec<Label>,
    correlations: Vec<Vec<f32>>,
    /// Labels met at each length and piece.
    met: FxHashMap<(u32, u32), Vec<u32>>,
    /// By estimate of the whole cost; among equals the longest run first, then the oldest.
    open: BinaryHeap<(Reverse<Cost>, u32, Reverse<u32>)>,
}

impl<'s> Search<'s> {
    fn new(problem: &'s Problem<'s>, task: &'s Task<'s>, by_drift: bool) -> Self {
        Self {
            problem,
            task,
            by_drift,
            drifted_out: false,
            labels: Vec::new(),
            correlations: Vec::new(),
            met: FxHashMap::default(),
            open: BinaryHeap::new(),
        }
    }

    fn run(&mut self, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
        for &(piece, cost) in &self.task.starts {
            if let Some(state) = automaton.start(piece) {
                let length = self.problem.widths[piece];
                let parent = self.labels.len() as u32;
                self.meet(automaton, Label { cost, length, piece: piece as u32, state, drift: 0, parent });
            }
        }
        let mut best: Option<(Cost, u32)> = None;
        while let Some((Reverse(estimate), _, Reverse(at))) = self.open.pop() {
            if best.is_some_and(|(cost, _)| cost <= estimate) {
                break;
            }
            if self.labels.len() > self.problem.label_limit {
                return Err(Unsolved::TooLarge { labels: self.labels.len() });
            }
            let Label { cost, length, piece, state, drift, .. } = self.labels[at as usize];
            if self.is_superseded(automaton, at) {
                continue;
            }
            if self.problem.window.contains(&length) && automaton.accepts(state) {
                if let Some(stop) = self.task.stop[piece as usize] {
                    let total = cost + stop + self.penalty(at);
                    if total < self.task.ceiling && best.is_none_or(|(known, _)| total < known) {
                        best = Some((total, at));
                    }
                }
            }
            let problem = self.problem;
            for step in &problem.steps[piece as usize] {
                let length = length + problem.widths[step.to];
                if self.task.bound.at(length, step.to) == NEVER {
                    continue;
                }
                let drift = drift + step.rise;
                if drift.abs() > problem.drift_limit {
                    self.drifted_out = true;
                    continue;
                }
                if let Some(state) = automaton.step(state, step.to) {
                    let cost = cost + step.cost;
                    self.meet(
                        automaton,
                        Label { cost, length, piece: step.to as u32, state, drift, parent: at },
                    );
                }
            }
        }
        let Some((_, at)) = best else { return Err(Unsolved::Infeasible) };
        let sequence = self.sequence(at);
        let cost =
            self.labels[at as usize].cost + self.task.stop[*sequence.last().unwrap_or(&0)].unwrap_or(0);
        Ok(Solution {
            sequence,
            cost,
            optimal: self.problem.variety.is_none(),
            labels: self.labels.len(),
            states: automaton.len(),
        })
    }

    /// Takes up a label unless one that was met before can stand for it.
    fn meet(&mut self, automaton: &mut Automaton<'_>, label: Label) {
        let rest = self.task.bound.at(label.length, label.piece as usize);
        let at = self.labels.len() as u32;
        let mut correlations = Vec::new();
        let mut penalty = 0;
        if let Some(variety) = self.problem.variety {
            if label.parent != at {
                let before = &self.correlations[label.parent as usize];
                correlations = extend(before, label.piece as usize, self.backwards(label.parent));
            }
            penalty = variety.penalty(&correlations);
        }
        let estimate = label.cost.saturating_add(rest).saturating_add(penalty);
        if rest == NEVER || estimate >= self.task.ceiling {
            return;
        }
        let met = self.met.entry((label.length, label.piece)).or_default();
        for &other in met.iter() {
            let other = &self.labels[other as usize];
            if other.cost <= label.cost
                && (!self.by_drift || other.drift == label.drift)
                && automaton.dominates(other.state, label.state)
            {
                return;
            }
        }
        met.push(at);
        self.open.push((Reverse(estimate), label.length, Reverse(at)));
        self.labels.push(label);
        if self.problem.variety.is_some() {
            self.correlations.push(correlations);
        }
    }

    /// Whether a cheaper label that can stand for this one was met after it.
    fn is_superseded(&self, automaton: &mut Automaton<'_>, at: u32) -> bool {
        let label = &self.labels[at as usize];
        let met = &self.met[&(label.length, label.piece)];
        met.iter().any(|&other| {
            let other = &self.labels[other as usize];
            other.cost < label.cost
                && (!self.by_drift || other.drift == label.drift)
                && automaton.dominates(other.state, label.state)
        })
    }

    fn penalty(&self, at: u32) -> Cost {
        self.problem.variety.map_or(0, |v| v.penalty(&self.correlations[at as usize]))
    }

    /// The pieces of a run, latest first.
    fn backwards(&self, at: u32) -> impl Iterator<Item = usize> + '_ {
        let mut next = Some(at);
        std::iter::from_fn(move || {
            let at = next?;
            let label = &self.labels[at as usize];
            next = (label.parent != at).then_some(label.parent);
            Some(label.piece as usize)
        })
    }

    fn sequence(&self, at: u32) -> Vec<usize> {
        let mut sequence: Vec<usize> = self.backwards(at).collect();
        sequence.reverse();
        sequence
    }
}
