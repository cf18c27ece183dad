//! The search over labels, for runs from given first pieces to given last ones.
//!
//! It runs in up to three rounds. The first is A* without regard to where a run has drifted to, except that a
//! run that leaves the band is dropped. As long as no dropped run had a smaller estimate than the answer, the
//! answer is the optimum; otherwise a run that was dropped may have stood for one that stays in the band, and
//! a second round takes the drift into the state, looking only for what is cheaper. Either gives up at a
//! number of labels; then a beam along the length finds a sequence if it can, and the least estimate that A*
//! had not yet settled says how far from the optimum that may be.

use super::bound::{Bound, NEVER, TopologyBound};
use super::labels::{Label, Labels, Search};
use super::problem::{Cost, Problem, Solution};
use crate::topology::Automaton;

/// Where runs begin and what they must look like.
pub(super) struct Task<'t> {
    /// First pieces and what beginning with them costs.
    pub(super) starts: Vec<(usize, Cost)>,
    /// What stopping after each piece costs, where it may stop.
    pub(super) stop: &'t [Option<Cost>],
    /// The least cost of completing a run, ignoring topology.
    pub(super) bound: &'t Bound,
    /// The least cost with the topology, if it was computed.
    pub(super) topology: Option<&'t TopologyBound>,
    /// Only solutions that cost less in all, variety included, are of interest.
    pub(super) ceiling: Cost,
    /// Labels at which A* gives up.
    pub(super) label_limit: usize,
    /// Whether a beam is tried then.
    pub(super) beams: bool,
}

impl Outcome {
    /// Whether nothing better can exist.
    pub(super) fn is_settled(&self) -> bool {
        self.floor >= self.found.as_ref().map_or(NEVER, |&(total, _)| total)
    }
}

/// What a search found.
pub(super) struct Outcome {
    /// The cheapest sequence and its whole cost, variety included; its gap is not set.
    pub(super) found: Option<(Cost, Solution)>,
    /// No run of the task that costs less than the ceiling costs less than this.
    pub(super) floor: Cost,
    /// Whether a run that left the band may have been cheaper than what was found.
    pub(super) drifted: bool,
    /// Labels made.
    pub(super) labels: usize,
}

/// States of the automaton at which A* gives up: with so many partitions of the portals, dominance has stopped
/// to bite, and a beam finds a good sequence long before A* would prove one.
const STATE_LIMIT: usize = 20_000;
/// Labels kept at each length by the beam; widened until a sequence is found.
const BEAMS: [usize; 3] = [128, 1024, 8192];

/// The cheapest run for `task`.
pub(super) fn solve_task(problem: &Problem<'_>, automaton: &mut Automaton<'_>, task: &Task<'_>) -> Outcome {
    let mut outcome = Outcome { found: None, floor: 0, drifted: true, labels: 0 };
    {
        // In the second round only what is cheaper than the find of the first is of interest.
        for by_drift in [false, true] {
            let ceiling = outcome.found.as_ref().map_or(task.ceiling, |&(total, _)| total);
            let task = Task { starts: task.starts.clone(), ceiling, ..*task };
            let mut search = Search::new(problem, &task, automaton.dominance(), by_drift);
            let round = best_first(&mut search, automaton);
            outcome.labels += search.labels.len();
            if let Some((total, at)) = round.best {
                outcome.found = Some((total, search.solution(automaton, at)));
            }
            let total = outcome.found.as_ref().map_or(task.ceiling, |&(total, _)| total);
            outcome.drifted = search.drifted_at < total;
            let settled = round.unsettled == NEVER;
            if settled && (by_drift || !outcome.drifted) {
                outcome.floor = outcome.found.as_ref().map_or(NEVER, |&(total, _)| total);
                return outcome;
            }
            // What was dropped in the first round may have stood for a run that costs as little.
            let floor = if by_drift { round.unsettled } else { round.unsettled.min(search.drifted_at) };
            outcome.floor = outcome.floor.max(floor);
            if !settled {
                break;
            }
        }
    }
    if outcome.found.is_none() && task.beams {
        outcome.found = BEAMS.iter().find_map(|&width| {
            let mut narrow = Search::new(problem, task, automaton.dominance(), false);
            let (total, at) = beam(&mut narrow, automaton, width)?;
            Some((total, narrow.solution(automaton, at)))
        });
    }
    outcome
}

/// What A* came to.
struct Round {
    /// The cheapest complete label, with its whole cost.
    best: Option<(Cost, u32)>,
    /// The least estimate that was not settled when the labels ran out; [`NEVER`] if they did not.
    unsettled: Cost,
}

fn best_first(search: &mut Search<'_>, automaton: &mut Automaton<'_>) -> Round {
    search.start(automaton);
    let mut best: Option<(Cost, u32)> = None;
    while let Some((estimate, at)) = search.pop() {
        if best.is_some_and(|(cost, _)| cost <= estimate) {
            break;
        }
        if search.labels.len() > search.task.label_limit || automaton.len() > STATE_LIMIT {
            return Round { best, unsettled: estimate };
        }
        if search.labels.is_superseded(at) {
            continue;
        }
        if let Some(total) = search.total(automaton, at).filter(|t| best.is_none_or(|(known, _)| *t < known))
        {
            best = Some((total, at));
        }
        search.extend(automaton, at);
    }
    Round { best, unsettled: NEVER }
}

/// The cheapest complete label among runs that at each length were among the `width` most promising.
fn beam(search: &mut Search<'_>, automaton: &mut Automaton<'_>, width: usize) -> Option<(Cost, u32)> {
    search.start(automaton);
    let mut best: Option<(Cost, u32)> = None;
    let mut layers: Vec<Vec<(Cost, u32)>> = vec![Vec::new(); *search.problem.window.end() as usize + 1];
    for length in 0..layers.len() {
        // Runs only grow, so whatever reaches this length has been found.
        while let Some((estimate, at)) = search.pop() {
            let Label { length, .. } = *search.labels.get(at);
            layers[length as usize].push((estimate, at));
        }
        let mut layer = std::mem::take(&mut layers[length]);
        layer.sort_unstable();
        layer.truncate(width);
        for (_, at) in layer {
            if search.labels.is_superseded(at) {
                continue;
            }
            if let Some(total) =
                search.total(automaton, at).filter(|t| best.is_none_or(|(known, _)| *t < known))
            {
                best = Some((total, at));
            }
            search.extend(automaton, at);
        }
    }
    best
}

impl Search<'_> {
    fn solution(&self, automaton: &Automaton<'_>, at: u32) -> Solution {
        let sequence = Labels::sequence(&self.labels, at);
        let stop = sequence.last().and_then(|&last| self.task.stop[last]).unwrap_or(0);
        Solution {
            cost: self.labels.get(at).cost + stop,
            sequence,
            gap: 0,
            labels: self.labels.len(),
            states: automaton.len(),
        }
    }
}
