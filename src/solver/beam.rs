//! When the optimum is too much work: walks that keep only the most promising runs of each length.
//!
//! A beam finds a run where there are many that meet the constraints, and may lose them all where there are few. So it
//! knows which counts a run may still come to ([`super::completions`]), and is widened until a run is found or as much
//! work was done as the search may take. The penalty on repetition depends on the whole run, so its search is a beam from
//! the beginning (Zhou 2014 §3.7).

use super::cheapest::Cheapest;
use super::estimates::Level;
use super::family::Family;
use super::labels::LABEL_BYTES;
use super::pass::{Beyond, Walk};
use super::problem::{Solution, Unsolved};
use super::table::NEVER;
use crate::topology::Automaton;

/// Runs of each length that the beam keeps; widened until a run is found.
const BEAMS: [usize; 3] = [300, 3_000, 30_000];
/// Runs of each length that it keeps at least.
const NARROWEST_BEAM: usize = 30;
/// The effort of all beams, as a multiple of that of the search for the optimum. With as much only, none was found for one
/// component and twelve holes of real ornaments.
const BEAM_EFFORT: usize = 4;

impl Cheapest<'_> {
    /// The best run that a beam finds, member by member.
    pub(super) fn beam(&mut self, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
        let (problem, goal) = (self.problem, automaton.goal());
        let left: Vec<&mut Family> =
            self.families.iter_mut().filter(|family| family.estimate() != NEVER).collect();
        let scopes = left.len();
        for family in left {
            family.estimates.learn_completions(problem, goal, &family.scope, scopes);
            family.look_again(problem, automaton);
        }
        self.raise();
        let fits = self.problem.memory_limit / LABEL_BYTES;
        let mut left = fits.min(self.problem.effort_limit.saturating_mul(BEAM_EFFORT));
        let layers = *self.problem.window.end() as usize;
        for width in BEAMS {
            // A long run has to be walked through to its end all the same, so its beam is narrower.
            let width = width.min(left / layers.max(1)).max(NARROWEST_BEAM);
            for (family, member) in self.in_order() {
                if self.best.is_some() || left == 0 {
                    break;
                }
                // The narrowest is walked to its end whatever that takes.
                let most = if width > NARROWEST_BEAM { left } else { usize::MAX };
                left = left.saturating_sub(self.walk_member(automaton, (family, member), width, most));
            }
        }
        self.finish(automaton)
    }

    /// The best run that the paper's table finds with the penalty on repetition (Zhou 2014 §3.7): of the runs of a
    /// length, as many as can be looked at are kept.
    pub(super) fn varied(&mut self, automaton: &mut Automaton<'_>) -> Result<Solution, Unsolved> {
        /// Terms of correlations that are added up for one member.
        const PATIENCE: usize = 400_000_000;
        /// Members that are looked at, the most promising first.
        const MEMBERS: usize = 6;
        self.level = self.level.max(Level::Topology);
        self.catch_up(automaton);
        let joins: usize =
            self.problem.steps.iter().map(Vec::len).sum::<usize>() / self.problem.pieces().max(1);
        let layers = *self.problem.window.end() as usize;
        let narrowest = self.problem.widths.iter().copied().min().unwrap_or(1) as usize;
        let terms = layers.saturating_mul(joins.max(1)).saturating_mul(layers / narrowest / 4 + 1);
        let width = (PATIENCE / terms.max(1)).clamp(8, 400);
        for width in [width, width * 8] {
            for at in self.in_order().into_iter().take(MEMBERS) {
                self.walk_member(automaton, at, width, usize::MAX);
            }
            if self.best.is_some() {
                break;
            }
        }
        self.finish(automaton)
    }

    /// The members by family and number, the most promising first.
    fn in_order(&self) -> Vec<(usize, usize)> {
        let members = |f: usize| (0..self.families[f].members.len()).map(move |m| (f, m));
        let mut all: Vec<(usize, usize)> = (0..self.families.len()).flat_map(members).collect();
        all.sort_by_key(|&(f, m)| (self.families[f].members[m].estimate, f, m));
        all
    }

    /// Walks over one member without a threshold, keeping so many runs of each length; the effort it took, which is
    /// limited.
    fn walk_member(
        &mut self,
        automaton: &mut Automaton<'_>,
        (family, at): (usize, usize),
        width: usize,
        effort_limit: usize,
    ) -> usize {
        let family = &mut self.families[family];
        let mut table = family.take_table(self.problem, at);
        let member = &family.members[at];
        let walk = Walk {
            problem: self.problem,
            scope: &member.scope,
            pieces: &mut table,
            estimates: &mut family.estimates,
            threshold: NEVER - 1,
            ceiling: self.best.as_ref().map_or(NEVER, |&(_, _, total)| total),
            by_drift: self.by_drift,
            width,
            effort_limit,
        };
        let passage = walk.run(automaton, Beyond::new(NEVER - 1));
        family.keep_table(at, table);
        self.labels += passage.labels;
        self.effort += passage.effort;
        self.best = passage.found.or(self.best.take());
        passage.effort
    }
}
