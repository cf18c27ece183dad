//! Labels: partial runs, by the length at which they stand, and which of them can stand for which.

use std::collections::VecDeque;

use rustc_hash::FxHashMap;

use super::problem::Cost;
use crate::topology::{Automaton, StateId};

/// A partial run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label {
    pub(super) cost: Cost,
    /// What it is weighed by against others: the cost, with a penalty for repetition where there is one.
    pub(super) weight: Cost,
    /// No complete run that begins with it costs less.
    pub(super) bound: Cost,
    pub(super) piece: u32,
    pub(super) state: StateId,
    pub(super) drift: i32,
    /// The label of the run without its last piece, or [`NONE`] for the first.
    pub(super) parent: u32,
    /// The label met before this one at the same length and place.
    before: u32,
    is_superseded: bool,
}

/// A run that is met.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) length: u32,
    pub(super) piece: u32,
    pub(super) state: StateId,
    pub(super) drift: i32,
    pub(super) cost: Cost,
    /// As in [`Label`].
    pub(super) weight: Cost,
    /// As in [`Label`].
    pub(super) bound: Cost,
}

/// No label.
pub(super) const NONE: u32 = u32::MAX;
/// The memory that a label takes with its place, in bytes.
pub(super) const LABEL_BYTES: usize = size_of::<Label>() + 24;
/// Labels at which those that no open run goes back to are dropped for the first time.
const FIRST_SWEEP: usize = 1 << 20;

/// Where labels of one length can stand for each other: piece, rank of the state, and drift when runs are told
/// apart by it.
type Place = (u32, u32, i32);

/// The labels of one length.
#[derive(Default)]
struct Layer {
    members: Vec<u32>,
    /// The label met last at each place.
    latest: FxHashMap<Place, u32>,
}

/// All labels that a walk along the length still needs. Labels at one place have the same estimate to the end,
/// so one that is no dearer than another and whose state dominates can stand for it.
pub(super) struct Labels {
    store: Vec<Label>,
    /// From the length that is looked at upwards.
    layers: VecDeque<Layer>,
    /// The length of the first layer.
    length: u32,
    by_drift: bool,
    sweep_at: usize,
    /// Labels made, also those that were dropped.
    pub(super) made: usize,
    /// Pairs of labels that were compared.
    compared: usize,
}

/// Pairs of labels that take as long to compare as a label takes to make.
const COMPARISONS_PER_LABEL: usize = 32;

impl Labels {
    /// No labels. With `by_drift`, runs that have drifted differently never stand for each other.
    pub(super) fn new(widest: u32, by_drift: bool) -> Self {
        let layers = (0..=widest).map(|_| Layer::default()).collect();
        Self { store: Vec::new(), layers, length: 0, by_drift, sweep_at: FIRST_SWEEP, made: 0, compared: 0 }
    }

    /// The work that was done, counted in labels.
    pub(super) fn effort(&self) -> usize {
        self.made + self.compared / COMPARISONS_PER_LABEL
    }

    pub(super) fn get(&self, at: u32) -> Label {
        self.store[at as usize]
    }

    /// Moves on to the next length; the labels there in the order in which they were met, also those that others
    /// stand for.
    pub(super) fn advance(&mut self) -> Vec<u32> {
        self.length += 1;
        if let Some(mut layer) = self.layers.pop_front() {
            layer.latest.clear();
            self.layers.push_back(layer);
        }
        std::mem::take(&mut self.layers[0].members)
    }

    /// Whether a cheaper label that can stand for this one was met after it.
    pub(super) fn is_superseded(&self, at: u32) -> bool {
        self.store[at as usize].is_superseded
    }

    /// Adds a run of `length` unless another can stand for it; the ones that it can stand for are superseded.
    pub(super) fn add(&mut self, automaton: &mut Automaton<'_>, run: Run, parent: u32) -> Option<u32> {
        let Run { length, piece, state, drift, cost, weight, bound } = run;
        let at = self.store.len() as u32;
        let layer = &mut self.layers[(length - self.length) as usize];
        let place = (piece, automaton.rank(state), if self.by_drift { drift } else { 0 });
        let head = layer.latest.entry(place).or_insert(NONE);
        let (mut link, mut previous) = (*head, NONE);
        while link != NONE {
            let other = self.store[link as usize];
            self.compared += 1;
            if other.weight <= weight {
                if automaton.dominates(other.state, state) {
                    return None;
                }
                previous = link;
            } else if automaton.dominates(state, other.state) {
                self.store[link as usize].is_superseded = true;
                match previous {
                    NONE => *head = other.before,
                    p => self.store[p as usize].before = other.before,
                }
            } else {
                previous = link;
            }
            link = other.before;
        }
        let before = std::mem::replace(head, at);
        let is_superseded = false;
        self.store.push(Label { cost, weight, bound, piece, state, drift, parent, before, is_superseded });
        layer.members.push(at);
        self.made += 1;
        Some(at)
    }

    /// Drops the labels that neither an open run nor `kept` goes back to, once there are many; gives the new
    /// number of `kept`. `held` are labels of the present length that are still going to be extended.
    pub(super) fn sweep(&mut self, kept: Option<u32>, held: &mut [u32]) -> Option<u32> {
        if self.store.len() < self.sweep_at {
            return kept;
        }
        for layer in &mut self.layers {
            layer.members.retain(|&at| !self.store[at as usize].is_superseded);
        }
        let mut is_needed = vec![false; self.store.len()];
        let open = self.layers.iter().flat_map(|layer| &layer.members);
        for mut at in open.copied().chain(kept).chain(held.iter().copied()) {
            while at != NONE && !std::mem::replace(&mut is_needed[at as usize], true) {
                at = self.store[at as usize].parent;
            }
        }
        let mut moved = vec![NONE; self.store.len()];
        let needed = (0..is_needed.len()).filter(|&at| is_needed[at]);
        for (next, at) in (0u32..).zip(needed) {
            moved[at] = next;
        }
        let to = |at: u32| if at == NONE { NONE } else { moved[at as usize] };
        let mut at = 0;
        self.store.retain(|_| {
            at += 1;
            is_needed[at - 1]
        });
        for label in &mut self.store {
            // What stood at the same place at a length that has passed is not asked for again.
            (label.parent, label.before) = (to(label.parent), to(label.before));
        }
        for layer in &mut self.layers {
            layer.members.iter_mut().for_each(|at| *at = to(*at));
            layer.latest.values_mut().for_each(|at| *at = to(*at));
            layer.latest.retain(|_, at| *at != NONE);
        }
        held.iter_mut().for_each(|at| *at = to(*at));
        self.sweep_at = FIRST_SWEEP.max(2 * self.store.len());
        kept.map(to)
    }

    /// The pieces of a run, latest first.
    pub(super) fn backwards(&self, at: u32) -> impl Iterator<Item = usize> + '_ {
        let mut next = at;
        std::iter::from_fn(move || {
            let label = self.store.get(next as usize)?;
            next = label.parent;
            Some(label.piece as usize)
        })
    }

    /// The pieces of a run, from the first.
    pub(super) fn sequence(&self, at: u32) -> Vec<usize> {
        let mut sequence: Vec<usize> = self.backwards(at).collect();
        sequence.reverse();
        sequence
    }
}
