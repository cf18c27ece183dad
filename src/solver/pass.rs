//! One walk along the length: every run whose estimate is within a threshold.
//!
//! Runs of each length are extended before those of greater lengths, so that only as many lengths as the widest
//! piece has bins are open at a time, and what no open run goes back to can be dropped. Runs whose estimate
//! passes the threshold are left out and counted, which says what the next threshold should be.

use rustc_hash::FxHashMap;

use super::estimates::Estimates;
use super::graph::Scope;
use super::labels::{Labels, NONE, Run};
use super::problem::{Cost, Problem};
use super::table::{NEVER, Table};
use super::variety::{Variety, extend};
use crate::topology::Automaton;

/// What to walk over.
pub(super) struct Walk<'w> {
    pub(super) problem: &'w Problem<'w>,
    pub(super) scope: &'w Scope,
    /// The least cost of completing a run by its last piece.
    pub(super) pieces: &'w mut Table<Cost>,
    /// What else is known of it.
    pub(super) estimates: &'w mut Estimates,
    /// Only runs of at most this estimate are looked at.
    pub(super) threshold: Cost,
    /// Only runs that cost less in all are of interest.
    pub(super) ceiling: Cost,
    /// Whether runs that have drifted differently are told apart.
    pub(super) by_drift: bool,
    /// The most promising runs of each length are extended, and no others.
    pub(super) width: usize,
    /// Effort at which the walk is given up, in labels.
    pub(super) effort_limit: usize,
}

/// What a walk came to.
pub(super) struct Passage {
    /// The cheapest run that meets all constraints: its pieces, its cost in all, and that with the penalty for
    /// repetition.
    pub(super) found: Option<(Vec<usize>, Cost, Cost)>,
    /// The least estimate of a run that left the band.
    pub(super) drifted_at: Cost,
    /// Estimates of the runs that were left out.
    pub(super) beyond: Beyond,
    pub(super) labels: usize,
    /// The work that was done, counted in labels.
    pub(super) effort: usize,
    /// Runs that were looked at, most of which became no labels.
    pub(super) looked: usize,
    /// Whether the walk was given up.
    pub(super) is_cut_short: bool,
}

/// Buckets for each doubling of the distance.
const PER_DOUBLING: u32 = 4;

/// How the estimates of runs that were left out are distributed above the threshold. Buckets grow with the
/// distance from it, so that costs of any scale are told apart.
#[derive(Debug, Clone)]
pub(super) struct Beyond {
    threshold: Cost,
    buckets: [u32; (64 * PER_DOUBLING) as usize],
    /// The least.
    least: Cost,
}

impl Beyond {
    /// No runs yet, above a threshold.
    pub(super) fn new(threshold: Cost) -> Self {
        Self { threshold, buckets: [0; (64 * PER_DOUBLING) as usize], least: NEVER }
    }

    /// Counts a run that was left out.
    pub(super) fn leave_out(&mut self, estimate: Cost) {
        self.least = self.least.min(estimate);
        let bucket = &mut self.buckets[bucket(estimate - self.threshold)];
        *bucket = bucket.saturating_add(1);
    }

    /// Adds what another walk with the same threshold left out.
    pub(super) fn add(&mut self, other: &Self) {
        self.least = self.least.min(other.least);
        for (a, b) in self.buckets.iter_mut().zip(other.buckets) {
            *a = a.saturating_add(b);
        }
    }

    /// A threshold that lets in about so many of the runs that were left out; [`NEVER`] when there were none.
    pub(super) fn next(&self, runs: usize) -> Cost {
        if self.least == NEVER {
            return NEVER;
        }
        let mut sum = 0usize;
        let mut at = self.least;
        for (bucket, &count) in self.buckets.iter().enumerate().filter(|&(_, &count)| count > 0) {
            sum += count as usize;
            if sum > runs {
                break;
            }
            at = at.max(self.threshold.saturating_add(end_of(bucket)));
        }
        at.min(NEVER - 1)
    }

    /// The least estimate of a run that was left out; [`NEVER`] when there was none.
    pub(super) fn least(&self) -> Cost {
        self.least
    }
}

/// The bucket of a distance from the threshold.
fn bucket(distance: Cost) -> usize {
    let doublings = distance.max(1).ilog2();
    // The bits after the first say how far it is to the next doubling.
    let part = match doublings.checked_sub(PER_DOUBLING.ilog2()) {
        Some(shift) => distance >> shift,
        None => distance << (PER_DOUBLING.ilog2() - doublings),
    };
    (doublings * PER_DOUBLING) as usize + part as usize % PER_DOUBLING as usize
}

/// The greatest distance that falls into a bucket.
fn end_of(bucket: usize) -> Cost {
    let (doublings, part) = (bucket as u32 / PER_DOUBLING, bucket as u32 % PER_DOUBLING);
    let next = (u128::from(PER_DOUBLING + part + 1) << doublings).div_ceil(u128::from(PER_DOUBLING));
    Cost::try_from(next - 1).unwrap_or(NEVER)
}

impl Walk<'_> {
    /// Walks from the shortest run to the longest.
    pub(super) fn run(mut self, automaton: &mut Automaton<'_>, beyond: Beyond) -> Passage {
        let problem = self.problem;
        let widest = problem.widths.iter().copied().max().unwrap_or(1);
        let longest = *problem.window.end();
        let mut labels = Labels::new(widest, self.by_drift);
        let mut passage = Passage {
            found: None,
            drifted_at: NEVER,
            beyond,
            labels: 0,
            effort: 0,
            looked: 0,
            is_cut_short: false,
        };
        let mut best: Option<(Cost, Cost, u32)> = None;
        let mut repetition = problem.variety.map(Repetition::new);
        for &(piece, cost) in &self.scope.starts {
            // Starts are met at their own lengths, which may be in another block.
            let length = problem.widths[piece];
            self.load(length.min(longest));
            if let Some(state) = automaton.start(piece) {
                let run =
                    Run { length, piece: piece as u32, state, drift: 0, cost, weight: cost, bound: cost };
                self.meet(automaton, &mut labels, &mut passage, repetition.as_mut(), run, NONE);
            }
        }
        for length in 1..=longest {
            let met = labels.advance();
            let mut members: Vec<u32> = met.iter().copied().filter(|&at| !labels.is_superseded(at)).collect();
            if members.is_empty() {
                continue;
            }
            self.load(length);
            if members.len() > self.width {
                let estimate = |at: &u32| {
                    let label = labels.get(*at);
                    label.bound + (label.weight - label.cost)
                };
                members.sort_by_cached_key(|at| (estimate(at), *at));
                members.truncate(self.width);
                passage.is_cut_short = true;
            }
            if repetition.is_none() {
                let kept = labels.sweep(best.map(|(.., at)| at), &mut members);
                best = best.zip(kept).map(|((total, cost, _), at)| (total, cost, at));
            }
            let may_stop = problem.window.contains(&length);
            for at in members {
                let label = labels.get(at);
                let piece = label.piece as usize;
                if let Some(stop) =
                    self.scope.stop[piece].filter(|_| may_stop && automaton.accepts(label.state))
                {
                    let (cost, total) = (label.cost + stop, label.weight + stop);
                    if total < self.ceiling && best.is_none_or(|(known, ..)| total < known) {
                        best = Some((total, cost, at));
                    }
                }
                for step in problem.steps[piece].iter().filter(|s| self.scope.allowed[s.to]) {
                    let length = length + problem.widths[step.to];
                    if length > longest {
                        continue;
                    }
                    let cost = label.cost + step.cost;
                    let rest = self.pieces.at(length, step.to);
                    if rest == NEVER || cost.saturating_add(rest) >= self.ceiling {
                        continue;
                    }
                    if cost + rest > self.threshold {
                        passage.beyond.leave_out(cost + rest);
                        continue;
                    }
                    let Some(state) = automaton.step(label.state, step.to) else { continue };
                    let drift = label.drift.saturating_add(step.rise);
                    let run = Run {
                        length,
                        piece: step.to as u32,
                        state,
                        drift,
                        cost,
                        weight: cost,
                        bound: label.bound,
                    };
                    self.meet(automaton, &mut labels, &mut passage, repetition.as_mut(), run, at);
                }
            }
            if let Some(repetition) = &mut repetition {
                repetition.forget(&met);
            }
            if labels.effort() > self.effort_limit {
                passage.is_cut_short = true;
                break;
            }
        }
        (passage.labels, passage.effort) = (labels.made, labels.effort());
        passage.found = best.map(|(total, cost, at)| (labels.sequence(at), cost, total));
        passage
    }

    fn load(&mut self, length: u32) {
        self.pieces.load(length);
        self.estimates.load(length);
    }

    /// Takes up a run unless its estimate is beyond the threshold or another can stand for it.
    fn meet(
        &mut self,
        automaton: &mut Automaton<'_>,
        labels: &mut Labels,
        passage: &mut Passage,
        repetition: Option<&mut Repetition>,
        run: Run,
        parent: u32,
    ) {
        let Run { length, state, drift, cost, .. } = run;
        let piece = run.piece as usize;
        passage.looked += 1;
        let plain = self.pieces.at(length, piece);
        let known_drift = self.by_drift.then_some(drift);
        let rest =
            plain.max(self.estimates.rest(self.problem, automaton, (length, piece, state, known_drift)));
        // What is known of the run before holds for it with any piece more.
        let mut run = Run { bound: run.bound.max(cost.saturating_add(rest)), ..run };
        let mut estimate = run.bound;
        let correlations = repetition.as_ref().map(|r| r.correlations(labels, parent, piece));
        if let (Some(r), Some(correlations)) = (&repetition, &correlations) {
            let penalty = r.variety.penalty(correlations);
            estimate = estimate.saturating_add(penalty);
            run.weight = cost.saturating_add(penalty);
        }
        if rest == NEVER || estimate >= self.ceiling {
            return;
        }
        if estimate > self.threshold {
            passage.beyond.leave_out(estimate);
            return;
        }
        if drift.saturating_abs() > self.problem.drift_limit {
            passage.drifted_at = passage.drifted_at.min(estimate);
            return;
        }
        let met = labels.add(automaton, run, parent);
        if let (Some(at), Some(r), Some(correlations)) = (met, repetition, correlations) {
            r.keep(at, correlations);
        }
    }
}

/// The correlations of the runs that are open, when variety is asked for.
struct Repetition {
    variety: Variety,
    correlations: FxHashMap<u32, Vec<f32>>,
}

impl Repetition {
    fn new(variety: Variety) -> Self {
        Self { variety, correlations: FxHashMap::default() }
    }

    /// Of the run `parent` with `piece` after it.
    fn correlations(&self, labels: &Labels, parent: u32, piece: usize) -> Vec<f32> {
        match self.correlations.get(&parent) {
            Some(before) => {
                let number = |piece| self.variety.number(piece);
                extend(before, number(piece), labels.backwards(parent).map(number))
            }
            None => Vec::new(),
        }
    }

    fn keep(&mut self, at: u32, correlations: Vec<f32>) {
        self.correlations.insert(at, correlations);
    }

    fn forget(&mut self, passed: &[u32]) {
        passed.iter().for_each(|at| {
            self.correlations.remove(at);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        // A bucket holds its distances and no greater ones.
        #[test]
        fn buckets_end_where_the_next_begins(distance in prop_oneof![1u64..40, 1u64..1 << 40, 1u64 << 60..NEVER]) {
            let end = end_of(bucket(distance));
            prop_assert!(end >= distance && end - distance <= distance / 4 + 1);
            prop_assert!(end == NEVER || bucket(end) == bucket(distance));
            prop_assert!(end >= NEVER - 1 || bucket(end + 1) > bucket(end));
        }

        #[test]
        fn a_threshold_lets_in_the_nearest_and_no_more_than_wanted(
            mut distances in prop::collection::vec(1u64..1_000_000, 1..50),
            wanted in 0usize..60,
        ) {
            let mut beyond = Beyond::new(1_000);
            distances.iter().for_each(|d| beyond.leave_out(1_000 + d));
            let next = beyond.next(wanted);
            distances.sort_unstable();
            let let_in = distances.iter().filter(|&&d| 1_000 + d <= next).count();
            prop_assert!(next >= 1_000 + distances[0]);
            prop_assert!(let_in <= wanted || next == 1_000 + distances[0]);
        }
    }
}
