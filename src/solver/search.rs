//! The search over labels, for runs from given first pieces to given last ones.
//!
//! It runs in up to three rounds. The first is A* without regard to where a run has drifted to, except that a
//! run that leaves the band is dropped; if none ever was, its answer is the optimum. Otherwise a second round
//! takes the drift into the state, looking only for what is cheaper. Either gives up at a number of labels;
//! then a beam along the length finds a sequence if it can, and the least estimate that A* had not yet
//! settled says how far from the optimum that may be.

use super::bound::Bound;
use super::labels::{Label, Labels, Search};
use super::problem::{Cost, Problem, Solution, Unsolved};
use crate::topology::Automaton;

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

/// States of the automaton at which A* gives up: with so many partitions of the portals, dominance has stopped
/// to bite, and a beam finds a good sequence long before A* would prove one.
const STATE_LIMIT: usize = 20_000;
/// Labels kept at each length by the beam; doubled until a sequence is found.
const BEAMS: [usize; 3] = [128, 1024, 8192];

/// The cheapest open run.
pub(super) fn solve_open(problem: &Problem<'_>, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
    let bound = Bound::new(problem, &problem.end, &vec![true; problem.pieces()]);
    let starts =
        problem.begin.iter().enumerate().filter_map(|(piece, cost)| cost.map(|c| (piece, c))).collect();
    let task = Task { starts, stop: &problem.end, bound: &bound, ceiling: super::bound::NEVER };
    solve_task(problem, automaton, &task)
}

/// The cheapest run for `task`.
pub(super) fn solve_task(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    task: &Task<'_>,
) -> Result<Solution, Unsolved> {
    let mut first = Search::new(problem, task, false);
    let found = best_first(&mut first, automaton);
    let labels = first.labels.len();
    let (found, floor) = match found {
        Ok(found) if !first.drifted_out => {
            return found.map(|at| first.solution(automaton, at, 0)).ok_or(Unsolved::Infeasible);
        }
        Ok(found) => (found.map(|at| first.solution(automaton, at, 0)), 0),
        Err(floor) => (None, floor),
    };
    drop(first);
    if floor == 0 {
        let ceiling = found.as_ref().map_or(task.ceiling, |f| f.cost);
        let cheaper = Task { starts: task.starts.clone(), ceiling, ..*task };
        let mut second = Search::new(problem, &cheaper, true);
        match best_first(&mut second, automaton) {
            Ok(None) => return found.ok_or(Unsolved::Infeasible),
            Ok(Some(at)) => return Ok(second.solution(automaton, at, 0)),
            Err(floor) => {
                if let Some(found) = found {
                    return Ok(Solution { gap: found.cost.saturating_sub(floor), ..found });
                }
            }
        }
    }
    BEAMS
        .iter()
        .find_map(|&width| {
            let mut narrow = Search::new(problem, task, false);
            let at = beam(&mut narrow, automaton, width)?;
            let solution = narrow.solution(automaton, at, 0);
            Some(Solution { gap: solution.cost.saturating_sub(floor), ..solution })
        })
        .ok_or(Unsolved::TooLarge { labels })
}

/// A*: the cheapest complete label, none if there is none, or the least unsettled estimate when the labels
/// ran out.
fn best_first(search: &mut Search<'_>, automaton: &mut Automaton<'_>) -> Result<Option<u32>, Cost> {
    search.start(automaton);
    let mut best: Option<(Cost, u32)> = None;
    while let Some((estimate, at)) = search.pop() {
        if best.is_some_and(|(cost, _)| cost <= estimate) {
            break;
        }
        if search.labels.len() > search.problem.label_limit || automaton.len() > STATE_LIMIT {
            return Err(estimate);
        }
        if search.labels.is_superseded(at) {
            continue;
        }
        if let Some(total) = search.total(automaton, at) {
            if best.is_none_or(|(known, _)| total < known) {
                best = Some((total, at));
            }
        }
        search.extend(automaton, at);
    }
    Ok(best.map(|(_, at)| at))
}

/// The cheapest complete label among runs that at each length were among the `width` most promising.
fn beam(search: &mut Search<'_>, automaton: &mut Automaton<'_>, width: usize) -> Option<u32> {
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
            if let Some(total) = search.total(automaton, at) {
                if best.is_none_or(|(known, _)| total < known) {
                    best = Some((total, at));
                }
            }
            search.extend(automaton, at);
        }
    }
    best.map(|(_, at)| at)
}

impl Search<'_> {
    fn solution(&self, automaton: &Automaton<'_>, at: u32, gap: Cost) -> Solution {
        let sequence = Labels::sequence(&self.labels, at);
        let stop = sequence.last().and_then(|&last| self.task.stop[last]).unwrap_or(0);
        Solution {
            cost: self.labels.get(at).cost + stop,
            sequence,
            gap,
            labels: self.labels.len(),
            states: automaton.len(),
        }
    }
}
