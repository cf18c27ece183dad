//! Labels: partial runs, which of them can stand for which, and how they grow.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::bound::{NEVER, TopologyBound};
use super::connectivity::Counts;
use super::problem::{Cost, Problem};
use super::search::Task;
use super::variety::extend;
use crate::topology::{Automaton, Dominance, StateId};

/// A partial run.
pub(super) struct Label {
    pub(super) cost: Cost,
    pub(super) length: u32,
    piece: u32,
    state: StateId,
    drift: i32,
    /// The label of the run without its last piece, or itself for the first.
    parent: u32,
    /// The label met before this one at the same length and piece.
    before: u32,
    superseded: bool,
}

const NONE: u32 = u32::MAX;

/// Where labels can stand for each other: length, piece, state when only equal ones can, and drift when runs
/// are told apart by it.
type Place = (u32, u32, u32, i32);

/// All labels, findable by length and last piece. Labels at one place have the same estimate to the end, so
/// one that is no dearer than another and whose state dominates can stand for it; those that it stands for
/// are no longer found.
pub(super) struct Labels {
    store: Vec<Label>,
    /// The label met last at each place.
    latest: FxHashMap<Place, u32>,
    by_drift: bool,
    by_state: bool,
}

impl Labels {
    pub(super) fn len(&self) -> usize {
        self.store.len()
    }

    pub(super) fn get(&self, at: u32) -> &Label {
        &self.store[at as usize]
    }

    fn place(&self, label: &Label) -> Place {
        let state = if self.by_state { label.state.index() as u32 } else { 0 };
        (label.length, label.piece, state, if self.by_drift { label.drift } else { 0 })
    }

    /// Adds a label unless another can stand for it; the ones that it can stand for are superseded.
    fn add(&mut self, automaton: &mut Automaton<'_>, mut label: Label) -> Option<u32> {
        let at = self.store.len() as u32;
        let place = self.place(&label);
        let head = self.latest.entry(place).or_insert(NONE);
        let (mut link, mut previous) = (*head, NONE);
        while link != NONE {
            let other = &self.store[link as usize];
            let next = other.before;
            if other.cost <= label.cost {
                if automaton.dominates(other.state, label.state) {
                    return None;
                }
                previous = link;
            } else if automaton.dominates(label.state, other.state) {
                self.store[link as usize].superseded = true;
                match previous {
                    NONE => *head = next,
                    p => self.store[p as usize].before = next,
                }
            } else {
                previous = link;
            }
            link = next;
        }
        label.before = std::mem::replace(head, at);
        self.store.push(label);
        Some(at)
    }

    /// Whether a cheaper label that can stand for this one was met after it.
    pub(super) fn is_superseded(&self, at: u32) -> bool {
        self.get(at).superseded
    }

    /// The pieces of a run, latest first.
    fn backwards(&self, at: u32) -> impl Iterator<Item = usize> + '_ {
        let mut next = Some(at);
        std::iter::from_fn(move || {
            let at = next?;
            let label = self.get(at);
            next = (label.parent != at).then_some(label.parent);
            Some(label.piece as usize)
        })
    }

    pub(super) fn sequence(&self, at: u32) -> Vec<usize> {
        let mut sequence: Vec<usize> = self.backwards(at).collect();
        sequence.reverse();
        sequence
    }
}

/// A search in progress.
pub(super) struct Search<'s> {
    pub(super) problem: &'s Problem<'s>,
    pub(super) task: &'s Task<'s>,
    pub(super) labels: Labels,
    /// The least estimate of a run that was dropped because it left the band; [`NEVER`] when none was.
    pub(super) drifted_at: Cost,
    /// Where the topology's estimate is found for each piece and state.
    columns: FxHashMap<(u32, StateId), Option<usize>>,
    /// Correlations of each label's run, when variety is asked for.
    correlations: Vec<Vec<f32>>,
    /// By estimate of the whole cost; among equals the longest run first, then the oldest.
    open: BinaryHeap<(Reverse<Cost>, u32, Reverse<u32>)>,
}

impl<'s> Search<'s> {
    /// With `by_drift`, runs that have drifted differently never stand for each other.
    pub(super) fn new(
        problem: &'s Problem<'s>,
        task: &'s Task<'s>,
        dominance: Dominance,
        by_drift: bool,
    ) -> Self {
        let by_state = dominance == Dominance::Equal;
        Self {
            problem,
            task,
            labels: Labels { store: Vec::new(), latest: FxHashMap::default(), by_drift, by_state },
            drifted_at: NEVER,
            columns: FxHashMap::default(),
            correlations: Vec::new(),
            open: BinaryHeap::new(),
        }
    }

    /// Meets the runs of one piece.
    pub(super) fn start(&mut self, automaton: &mut Automaton<'_>) {
        for &(piece, cost) in &self.task.starts {
            if let Some(state) = automaton.start(piece) {
                let length = self.problem.widths[piece];
                let parent = self.labels.len() as u32;
                self.meet(
                    automaton,
                    Label {
                        cost,
                        length,
                        piece: piece as u32,
                        state,
                        drift: 0,
                        parent,
                        before: NONE,
                        superseded: false,
                    },
                );
            }
        }
    }

    /// The open label with the least estimate, and that estimate.
    pub(super) fn pop(&mut self) -> Option<(Cost, u32)> {
        self.open.pop().map(|(Reverse(estimate), _, Reverse(at))| (estimate, at))
    }

    /// What a run costs in all if it stops here; `None` if it may not.
    pub(super) fn total(&self, automaton: &Automaton<'_>, at: u32) -> Option<Cost> {
        let label = self.labels.get(at);
        let stop = self.task.stop[label.piece as usize]?;
        let total = label.cost + stop + self.penalty(at);
        let complete = self.problem.window.contains(&label.length) && automaton.accepts(label.state);
        (complete && total < self.task.ceiling).then_some(total)
    }

    /// Meets every run that is this one and a piece more.
    pub(super) fn extend(&mut self, automaton: &mut Automaton<'_>, at: u32) {
        let problem = self.problem;
        let &Label { cost, length, piece, state, drift, .. } = self.labels.get(at);
        for step in &problem.steps[piece as usize] {
            let length = length + problem.widths[step.to];
            if self.task.bound.at(length, step.to) == NEVER {
                continue;
            }
            if let Some(state) = automaton.step(state, step.to) {
                let (cost, piece, drift) = (cost + step.cost, step.to as u32, drift + step.rise);
                self.meet(
                    automaton,
                    Label { cost, length, piece, state, drift, parent: at, before: NONE, superseded: false },
                );
            }
        }
    }

    /// The least cost of completing a run, as far as it is known.
    fn rest(&mut self, automaton: &Automaton<'_>, label: &Label) -> Cost {
        let plain = self.task.bound.at(label.length, label.piece as usize);
        let Some(bound) = self.task.topology.filter(|_| plain != NEVER) else { return plain };
        let entry = self.columns.entry((label.piece, label.state));
        let column = *entry.or_insert_with(|| column(automaton, bound, label.piece as usize, label.state));
        column.map_or(NEVER, |column| bound.at(label.length, column).max(plain))
    }

    /// Takes up a label unless one that was met before can stand for it.
    fn meet(&mut self, automaton: &mut Automaton<'_>, label: Label) {
        let rest = self.rest(automaton, &label);
        let at = self.labels.len() as u32;
        let mut correlations = Vec::new();
        let mut penalty = 0;
        if let Some(variety) = self.problem.variety {
            if label.parent != at {
                let before = &self.correlations[label.parent as usize];
                correlations = extend(before, label.piece as usize, self.labels.backwards(label.parent));
            }
            penalty = variety.penalty(&correlations);
        }
        let estimate = label.cost.saturating_add(rest).saturating_add(penalty);
        if rest == NEVER || estimate >= self.task.ceiling {
            return;
        }
        if label.drift.abs() > self.problem.drift_limit {
            self.drifted_at = self.drifted_at.min(estimate);
            return;
        }
        let length = label.length;
        if let Some(at) = self.labels.add(automaton, label) {
            self.open.push((Reverse(estimate), length, Reverse(at)));
            if self.problem.variety.is_some() {
                self.correlations.push(correlations);
            }
        }
    }

    fn penalty(&self, at: u32) -> Cost {
        self.problem.variety.map_or(0, |v| v.penalty(&self.correlations[at as usize]))
    }
}

/// Where the estimate with the topology is found for a run that ends with `piece` in `state`.
pub(super) fn column(
    automaton: &Automaton<'_>,
    bound: &TopologyBound,
    piece: usize,
    state: StateId,
) -> Option<usize> {
    let (components, holes) = automaton.closed(state);
    bound.column(piece, &automaton.connections(state)?, Counts { components, holes })
}
