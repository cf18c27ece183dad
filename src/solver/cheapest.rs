//! The cheapest run: walks along the length with growing thresholds.
//!
//! A [`Walk`] with a threshold at or above the optimum finds it, and looks only at runs whose estimate is within
//! the threshold. So the threshold begins at the least estimate there is and grows, each time to where some three
//! times as many runs come in, until a walk finds a run: then everything cheaper was looked at, and it is the
//! optimum. A step that lets in far too many is taken back. The first walks know only the pieces; the more work the
//! walks turn out to take, the dearer the estimates that are made for them ([`Level`]).
//!
//! Drift is not part of a state until a run has left the band. As long as no run that was dropped for that had
//! a smaller estimate than the answer, the answer is the optimum; otherwise a run that was dropped may have
//! stood for one that stays in the band, and the walks are taken again with the drift in the state.
//!
//! After the work that may be done, which is that of as many labels as the memory limit holds at most, a beam finds a run
//! if it can, with a few times as much. The last threshold at which nothing was found says how far from the optimum that
//! may be. It is the work that is counted and not the labels that are left, so that the limit bounds the time as well, but
//! for that of making estimates, whose passes have limits of their own.

use super::estimates::Level;
use super::family::{Family, families};
use super::labels::LABEL_BYTES;
use super::pass::{Beyond, Passage, Walk};
use super::problem::{Cost, Problem, Solution, Unsolved};
use super::reach::{is_never, is_out_of_range};
use super::table::NEVER;
use crate::topology::Automaton;

/// Effort after which dear estimates are made, at least and at most: as much as they take. Most goals near the exemplar's
/// own topology need less.
const SHORT: [usize; 2] = [300, 150_000];
/// Additions in a pass that take as long as a label.
const ADDITIONS_PER_LABEL: usize = 200;
/// A pass that knows the topology takes about as many times as long as one over the pieces alone.
const TOPOLOGY: usize = 8;
/// Where runs leave the band, prices are made after so small a part of that effort: the walks that know the drift and no
/// price of it look at most runs in vain.
const PRICES: usize = 8;
/// Effort after which the dearest of all is made, the pass over all pairs of piece and state with the drift.
const LONG: usize = 1_500_000;
/// Runs that take as long to look at as a label, when they become none.
const LOOKS_PER_LABEL: usize = 8;
/// A threshold is too high when it lets in so many times the effort of the last one.
const LEAP: usize = 24;
/// It is lowered to so small a part of the step that led to it.
const STEP_BACK: Cost = 6;
/// Runs that a threshold lets in at least of those that the last one left out.
const FEW: usize = 8;
/// Labels for each run more that a threshold lets in, at most. Each is going to be extended to a few of its own: to so
/// few that the effort did not grow as it should, and there are fewer labels for each from then on.
const LABELS_PER_RUN: usize = 16;
/// By how much the effort should grow from one threshold to the next, at least and at most.
const GROWTH: [usize; 2] = [3, 12];

/// The cheapest run, or ring, that `automaton` accepts. Whether it `is_hopeless` is asked before the first dear estimates
/// are made. With the effort that it took.
pub(super) fn cheapest(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    is_hopeless: &dyn Fn() -> bool,
) -> (Result<Solution, Unsolved>, usize) {
    let mut search = Cheapest::new(problem, automaton, is_hopeless);
    let found = match problem.variety {
        Some(_) => search.varied(automaton),
        None => search.solve(automaton),
    };
    (found, search.effort + search.learning)
}

/// The same from a standing that no small problem comes to: the level, whether drifts are told apart, the effort after
/// which more is learned, and what `force` makes of each family before the first walk.
#[cfg(test)]
pub(super) fn cheapest_from(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    (level, by_drift, short): (Level, bool, usize),
    mut force: impl FnMut(&mut Family, &mut Automaton<'_>),
) -> Result<Solution, Unsolved> {
    let mut search = Cheapest { level, by_drift, short, ..Cheapest::new(problem, automaton, &|| false) };
    search.families.iter_mut().for_each(|family| force(family, automaton));
    search.catch_up(automaton);
    search.solve(automaton)
}

/// Effort after which dear estimates are made: of a ring, each member then has a pass of its own.
fn short(problem: &Problem<'_>, families: &[Family]) -> usize {
    let joins: usize = problem.steps.iter().map(Vec::len).sum();
    let passes = TOPOLOGY + families.iter().map(|f| f.members.len()).sum::<usize>();
    let additions = joins.saturating_mul(*problem.window.end() as usize).saturating_mul(passes);
    let [least, most] = SHORT;
    (additions / ADDITIONS_PER_LABEL).clamp(least, most)
}

/// A search for the cheapest run.
pub(super) struct Cheapest<'p> {
    pub(super) problem: &'p Problem<'p>,
    is_hopeless: &'p dyn Fn() -> bool,
    pub(super) families: Vec<Family>,
    /// Runs of at most this estimate are looked at.
    threshold: Cost,
    /// No run that meets the constraints costs less.
    floor: Cost,
    /// The best so far: pieces, cost, cost with penalties.
    pub(super) best: Option<(Vec<usize>, Cost, Cost)>,
    pub(super) by_drift: bool,
    /// As [`short`] says.
    short: usize,
    /// Which estimates were found to be worth while.
    pub(super) level: Level,
    pub(super) labels: usize,
    /// The work of making dear estimates, counted in labels.
    learning: usize,
    /// The work of all walks, counted in labels.
    pub(super) effort: usize,
    /// Runs that all walks looked at.
    looked: usize,
    /// Of the effort, what was done before the estimates were those of the level, and runs told apart by drift or not.
    effort_before: usize,
    /// Of the last walks with one threshold.
    last: usize,
}

/// How far the search was.
struct Standing {
    effort: usize,
    floor: Cost,
}

/// What the walks over all families with one threshold came to.
struct Round {
    drifted_at: Cost,
    beyond: Beyond,
    is_cut_short: bool,
}

impl<'p> Cheapest<'p> {
    fn new(problem: &'p Problem<'p>, automaton: &Automaton<'_>, is_hopeless: &'p dyn Fn() -> bool) -> Self {
        let families = families(problem, automaton.goal().closed_pattern);
        let threshold = families.iter().map(Family::estimate).min().unwrap_or(NEVER);
        let short = short(problem, &families);
        Self {
            problem,
            is_hopeless,
            families,
            threshold,
            floor: threshold,
            best: None,
            by_drift: false,
            short,
            level: if automaton.goal().is_free() { Level::Topology } else { Level::Pieces },
            labels: 0,
            effort: 0,
            learning: 0,
            looked: 0,
            effort_before: 0,
            last: 0,
        }
    }

    fn solve(&mut self, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
        // Walks in a row that were too long.
        let mut leaps = 0;
        let mut labels_per_run = LABELS_PER_RUN;
        while self.threshold != NEVER {
            let most = self.effort_limit(automaton);
            let patience = self.patience().map_or(most, |effort| most.min(self.effort_before + effort));
            // Of a step that is as small as it can be, nothing can be taken back.
            let is_leap = self.threshold > self.floor.saturating_add(STEP_BACK);
            let leap = if is_leap {
                self.effort + ((LEAP * self.last).max(self.short) << leaps)
            } else {
                usize::MAX
            };
            let before = Standing { effort: self.effort, floor: self.floor };
            let round = self.round(automaton, patience.min(leap));
            if round.is_cut_short {
                if self.effort > patience {
                    if self.patience().is_none() || self.effort >= self.effort_limit(automaton) {
                        return self.beam(automaton);
                    }
                    self.learn(automaton);
                } else {
                    self.threshold = self.floor + (self.threshold - self.floor) / STEP_BACK;
                    leaps += 1;
                }
                continue;
            }
            let effort = self.effort - before.effort;
            let has_grown = 2 * effort > 3 * self.last;
            let previous = std::mem::replace(&mut self.last, effort);
            leaps = 0;
            let best = self.best.as_ref().map_or(NEVER, |&(_, _, total)| total);
            if !self.by_drift && round.drifted_at < best && round.drifted_at <= self.threshold {
                // Up to there, nothing was left out.
                self.by_drift = true;
                self.effort_before = self.effort;
                self.floor = self.floor.max(round.drifted_at);
                self.threshold = self.floor;
                self.raise();
                continue;
            }
            if best <= self.threshold || round.beyond.least() == NEVER {
                // What is dearer than the threshold is dearer than the best.
                self.floor = best;
                break;
            }
            self.floor = self.floor.max(round.beyond.least());
            // How many labels come of a run differs as much as joins and estimates do.
            if effort < GROWTH[0] * previous {
                labels_per_run = (labels_per_run / 2).max(1);
            } else if effort > GROWTH[1] * previous {
                labels_per_run = (labels_per_run * 2).min(LABELS_PER_RUN);
            }
            let next = round.beyond.next((self.last / labels_per_run).max(FEW));
            // Where many estimates lie close together, steps grow all the same.
            let step = self.threshold.saturating_sub(before.floor).saturating_mul(2);
            let least = if has_grown { 0 } else { self.floor.saturating_add(step).min(NEVER - 1) };
            self.threshold = next.max(least);
            if self.patience().is_some_and(|effort| self.effort > self.effort_before + effort) {
                self.learn(automaton);
            }
            let problem = self.problem;
            for family in &mut self.families {
                if family.estimates.learn_more(problem, automaton, &family.scope) {
                    family.look_again(problem, automaton);
                }
            }
            self.catch_up(automaton);
        }
        self.finish(automaton)
    }

    /// Effort after which the estimates of the next level are made; `None` when there is none.
    fn patience(&self) -> Option<usize> {
        match (self.level, self.by_drift) {
            (Level::Pieces | Level::Topology, false) => Some(self.short),
            (Level::Pieces | Level::Topology | Level::Fine, true) => Some(self.short / PRICES),
            (Level::Prices, _) => Some(LONG),
            (Level::Fine, false) | (Level::Drift, _) => None,
        }
    }

    /// Goes on to the next level of estimates.
    fn learn(&mut self, automaton: &mut Automaton<'_>) {
        if self.level == Level::Pieces && (self.is_hopeless)() {
            self.families.iter_mut().for_each(|family| family.members.clear());
        }
        self.level = match (self.level, self.by_drift) {
            (Level::Pieces, false) => Level::Topology,
            (Level::Topology, false) => Level::Fine,
            (Level::Pieces | Level::Topology | Level::Fine, _) => Level::Prices,
            (Level::Prices | Level::Drift, _) => Level::Drift,
        };
        self.effort_before = self.effort;
        self.learning += self.short;
        self.catch_up(automaton);
    }

    /// Walks over all members with the threshold.
    fn round(&mut self, automaton: &mut Automaton<'_>, limit: usize) -> Round {
        let problem = self.problem;
        let beyond = Beyond::new(self.threshold);
        let mut round = Round { drifted_at: NEVER, beyond, is_cut_short: false };
        for family in &mut self.families {
            // Once all rings through a first piece have been seen, it need not be looked at again.
            let mut allowed = family.scope.allowed.clone();
            for at in 0..family.members.len() {
                let ceiling = self.best.as_ref().map_or(NEVER, |&(_, _, total)| total);
                let mut leave_out = |estimate: Cost| {
                    let is_late = estimate > self.threshold && estimate < ceiling;
                    if is_late {
                        round.beyond.leave_out(estimate);
                    }
                    is_late || estimate >= ceiling
                };
                if leave_out(family.members[at].estimate) {
                    continue;
                }
                let mut table = family.take_table(problem, at);
                let member = &family.members[at];
                if leave_out(member.estimate) {
                    family.keep_table(at, table);
                    continue;
                }
                let mut scope = member.scope.clone();
                scope.allowed.clone_from(&allowed);
                let walk = Walk {
                    problem,
                    scope: &scope,
                    pieces: &mut table,
                    estimates: &mut family.estimates,
                    threshold: self.threshold,
                    ceiling,
                    by_drift: self.by_drift,
                    width: usize::MAX,
                    effort_limit: limit.saturating_sub(self.effort),
                };
                let beyond = Beyond::new(self.threshold);
                let Passage { found, drifted_at, beyond, labels, effort, looked, is_cut_short } =
                    walk.run(automaton, beyond);
                family.keep_table(at, table);
                self.labels += labels;
                self.effort += effort;
                self.looked += looked;
                round.drifted_at = round.drifted_at.min(drifted_at);
                round.beyond.add(&beyond);
                self.best = found.or(self.best.take());
                if is_cut_short {
                    round.is_cut_short = true;
                    return round;
                }
                if family.is_ring && !self.by_drift && drifted_at == NEVER {
                    allowed[scope.starts[0].0] = false;
                }
            }
        }
        round
    }

    /// Finds out what cannot be, and makes the estimates of the level, for the families that the threshold has
    /// reached; as they learn, it rises, and reaches others.
    pub(super) fn catch_up(&mut self, automaton: &mut Automaton<'_>) {
        let (problem, goal, level) = (self.problem, automaton.goal(), self.level);
        self.raise();
        loop {
            let is_due = |f: &&mut Family| {
                let estimate = f.estimate();
                f.level < level && estimate <= self.threshold && estimate != NEVER
            };
            let Some(family) = self.families.iter_mut().filter(is_due).min_by_key(|f| f.estimate()) else {
                return;
            };
            let is_new = family.level == Level::Pieces;
            if is_new && is_never(problem, automaton, &family.scope) {
                family.members.clear();
            } else {
                family.learn(problem, automaton, level);
                if is_new
                    && !goal.is_free()
                    && !family.estimates.is_exact()
                    && is_out_of_range(problem, goal, &family.scope)
                {
                    family.members.clear();
                }
            }
            self.raise();
        }
    }

    /// Lifts the threshold to the least estimate.
    pub(super) fn raise(&mut self) {
        let least = self.families.iter().map(Family::estimate).min().unwrap_or(NEVER);
        let best = self.best.as_ref().map_or(NEVER, |&(_, _, total)| total);
        self.floor = self.floor.max(least.min(best));
        self.threshold = match (least, best) {
            (NEVER, NEVER) => NEVER,
            // Nothing is left but what is known.
            (least, best) if least >= best => best,
            (least, _) => self.threshold.max(least),
        };
    }

    /// Effort at which the search is given up, in all walks together: that of as many labels as fit the memory at most.
    fn effort_limit(&self, automaton: &Automaton<'_>) -> usize {
        let fits = self.problem.memory_limit.saturating_sub(automaton.bytes()) / LABEL_BYTES;
        fits.min(self.problem.effort_limit.saturating_sub(self.looked / LOOKS_PER_LABEL))
    }

    pub(super) fn finish(&mut self, automaton: &Automaton<'_>) -> Result<Solution, Unsolved> {
        let Self { floor, labels, .. } = *self;
        match self.best.take() {
            Some((sequence, cost, total)) => {
                let gap = total.saturating_sub(floor);
                Ok(Solution { sequence, cost, gap, labels, states: automaton.len() })
            }
            None if floor == NEVER || self.threshold == NEVER => Err(Unsolved::Infeasible),
            None => Err(Unsolved::TooLarge { labels }),
        }
    }
}
