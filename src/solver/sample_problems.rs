//! Small random problems and all their runs, for tests.
//!
//! Pieces are connected as the plane allows: going round one, a portal joins a component that is still within
//! reach or begins another. Some are blank, have islands, or so many holes that a set of counts takes several
//! words. Runs are found by plain enumeration, which knows nothing of the automaton, of graphs or of passes.

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use super::problem::{Cost, Problem, Step};
use super::table::NEVER;
use crate::topology::{Descriptor, Goal, Shape, Topology, Wanted};

/// A problem that owns its pieces.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    shape: Shape,
    descriptors: Vec<Descriptor>,
    widths: Vec<u32>,
    steps: Vec<Vec<Step>>,
    begin: Vec<Cost>,
    end: Vec<Cost>,
    window: (u32, u32),
    drift_limit: i32,
    memory_limit: usize,
    asked: Vec<Asked>,
}

/// A goal, by the number of a run that it is to be like.
#[derive(Debug, Clone, Copy)]
struct Asked {
    kind: usize,
    run: usize,
    /// Added to what that run has.
    more: (u32, u32),
}

/// A run of pieces, complete or not.
#[derive(Debug)]
pub(super) struct Run {
    parent: Option<usize>,
    pub(super) first: usize,
    pub(super) piece: usize,
    pub(super) length: u32,
    pub(super) drift: i32,
    pub(super) is_in_band: bool,
    /// What the first piece, or the last join, costs.
    step: Cost,
    /// What stopping here costs and makes, where the portals allow it, whatever the length.
    pub(super) stop: Option<(Cost, Topology)>,
    run: Descriptor,
}

/// All runs of a problem up to its greatest length, each after the run that it is longer than by a piece.
pub(super) struct Runs(Vec<Run>);

/// The most pieces of a problem.
const MOST: usize = 6;
/// The most portals on a side.
const PORTALS: usize = 4;
/// Memory with which every estimate is made.
pub(super) const AMPLE: usize = 256 << 20;
/// Runs beyond which a shorter length is asked for.
const PATIENCE: usize = 4_000;

impl Sample {
    /// The problem, as long as enumeration affords, and its runs.
    pub(super) fn enumerated(&self) -> (Problem<'_>, Runs) {
        let ends = |costs: &[Cost], side: fn(&Descriptor) -> &[u16]| {
            let ends = self.descriptors.iter().zip(costs);
            ends.map(|(d, &cost)| side(d).is_empty().then_some(cost)).collect::<Vec<_>>()
        };
        let (mut low, mut high) = self.window;
        loop {
            let problem = Problem {
                shape: self.shape,
                descriptors: &self.descriptors,
                widths: self.widths.clone(),
                steps: self.steps.clone(),
                begin: ends(&self.begin, Descriptor::left),
                end: ends(&self.end, Descriptor::right),
                window: low..=high,
                drift_limit: self.drift_limit,
                variety: None,
                memory_limit: self.memory_limit,
                effort_limit: usize::MAX,
            };
            if let Some(runs) = Runs::new(&problem) {
                return (problem, runs);
            }
            (low, high) = (low.saturating_sub(1).max(1), high - 1);
        }
    }

    /// Goals of all kinds, most of which some run has or nearly has.
    pub(super) fn goals(&self, problem: &Problem<'_>, runs: &Runs) -> Vec<Goal> {
        let complete: Vec<Topology> = runs.complete(problem).map(|(_, topology)| topology).collect();
        let single: Vec<Topology> = complete.iter().filter(|t| t.components == 1).copied().collect();
        let goal = |asked: &Asked| {
            let (more, most) = asked.more;
            let all = if (1..=5).contains(&asked.kind) { &single } else { &complete };
            let like = all.get(asked.run % all.len().max(1));
            let (components, holes) = like.map_or((more, most), |t| (t.components + more, t.holes + more));
            let exactly = |n: u32| Some(Wanted::exactly(n));
            let up_from = |n: u32| Wanted::between(n, n + most);
            let (components, holes) = match asked.kind {
                0 => (None, None),
                1 => (exactly(1), None),
                2 => (exactly(1), exactly(holes)),
                3 => (exactly(1), up_from(holes)),
                4 => (exactly(1), exactly(0)),
                5 => (Wanted::between(0, 1), None),
                6 => (exactly(components), None),
                // With holes, no components and one are not told apart by classes.
                7 => (up_from(components), exactly(holes)),
                8 => (None, Wanted::between(0, holes)),
                _ => (None, up_from(holes)),
            };
            let closed_pattern = self.shape == Shape::Ring && asked.run.is_multiple_of(3);
            Goal { components, holes, closed_pattern }
        };
        self.asked.iter().map(goal).collect()
    }
}

impl Runs {
    /// All runs; `None` when they are too many. Rings are opened at their narrowest cut.
    fn new(problem: &Problem<'_>) -> Option<Self> {
        let fewest = |p: usize| problem.descriptors[p].left().len().min(problem.descriptors[p].right().len());
        let mut runs = Vec::new();
        for first in 0..problem.pieces() {
            let run = &problem.descriptors[first];
            let begin = match problem.shape {
                Shape::Open => problem.begin[first],
                Shape::Ring => (fewest(first) == run.left().len()).then_some(0),
            };
            if let Some(step) = begin.filter(|_| problem.widths[first] <= *problem.window.end()) {
                let (length, run) = (problem.widths[first], run.clone());
                let begun = Run {
                    parent: None,
                    first,
                    piece: first,
                    length,
                    drift: 0,
                    is_in_band: true,
                    step,
                    stop: None,
                    run,
                };
                runs.push(begun.stopping(problem));
            }
        }
        let mut at = 0;
        while at < runs.len() {
            if runs.len() > PATIENCE {
                return None;
            }
            let Run { first, piece, length, drift, is_in_band, .. } = runs[at];
            let cut = problem.descriptors[first].left().len();
            for step in &problem.steps[piece] {
                let length = length + problem.widths[step.to];
                let is_narrow = problem.shape == Shape::Ring && fewest(step.to) < cut;
                if length > *problem.window.end() || is_narrow {
                    continue;
                }
                let run = runs[at].run.join(&problem.descriptors[step.to]).expect("portal numbers match");
                let drift = drift + step.rise;
                let is_in_band = is_in_band && drift.abs() <= problem.drift_limit;
                let (parent, piece, step) = (Some(at), step.to, step.cost);
                let longer = Run { parent, first, piece, length, drift, is_in_band, step, stop: None, run };
                runs.push(longer.stopping(problem));
            }
            at += 1;
        }
        Some(Self(runs))
    }

    /// All runs.
    pub(super) fn all(&self) -> &[Run] {
        &self.0
    }

    /// The runs of an accepted length that may stop, in the band or not, and what they make.
    pub(super) fn complete(&self, problem: &Problem<'_>) -> impl Iterator<Item = (&Run, Topology)> {
        let is_long_enough = |run: &&Run| problem.window.contains(&run.length);
        self.0.iter().filter(is_long_enough).filter_map(|run| Some((run, run.stop?.1)))
    }

    /// What completing each run in the band to the goal costs at least; [`NEVER`] where nothing does.
    pub(super) fn rests(&self, problem: &Problem<'_>, goal: Goal) -> Vec<Cost> {
        let mut rests = vec![NEVER; self.0.len()];
        for (at, run) in self.0.iter().enumerate().rev() {
            let stop = run.stop.filter(|&(_, topology)| {
                run.is_in_band && problem.window.contains(&run.length) && goal.admits(topology)
            });
            rests[at] = rests[at].min(stop.map_or(NEVER, |(cost, _)| cost));
            if let Some(parent) = run.parent {
                rests[parent] = rests[parent].min(rests[at].saturating_add(run.step));
            }
        }
        rests
    }

    /// What the cheapest run in all costs that begins with one of these pieces, by their [`Runs::rests`].
    pub(super) fn least(&self, rests: &[Cost], is_first: impl Fn(usize) -> bool) -> Cost {
        let firsts = self.0.iter().zip(rests).filter(|(run, _)| run.parent.is_none() && is_first(run.piece));
        firsts.map(|(run, rest)| rest.saturating_add(run.step)).min().unwrap_or(NEVER)
    }

    /// Something that is carried along each run from the one before it, in their order.
    pub(super) fn along<T: Clone>(&self, mut next: impl FnMut(Option<&T>, &Run) -> T) -> Vec<T> {
        let mut found: Vec<T> = Vec::with_capacity(self.0.len());
        for run in &self.0 {
            let here = next(run.parent.map(|parent| &found[parent]), run);
            found.push(here);
        }
        found
    }

    /// What a sequence in the band costs and makes, if it is one of the complete runs.
    pub(super) fn made(&self, problem: &Problem<'_>, sequence: &[usize]) -> Option<(Cost, Topology)> {
        let pieces = |mut at: usize| {
            let mut pieces = vec![self.0[at].piece];
            while let Some(parent) = self.0[at].parent {
                pieces.push(self.0[parent].piece);
                at = parent;
            }
            pieces
        };
        let length: u32 = sequence.iter().map(|&p| problem.widths[p]).sum();
        let is_it = |at: &usize| self.0[*at].length == length && pieces(*at).iter().rev().eq(sequence);
        let run = &self.0[(0..self.0.len()).find(is_it)?];
        let (_, topology) = run.stop.filter(|_| run.is_in_band && problem.window.contains(&length))?;
        Some((problem.cost_of(sequence)?, topology))
    }
}

impl Run {
    /// With what stopping there comes to.
    fn stopping(mut self, problem: &Problem<'_>) -> Self {
        self.stop = match problem.shape {
            Shape::Open => problem.end[self.piece].zip(self.run.finished()),
            Shape::Ring => {
                let closing = problem.steps[self.piece].iter().find(|s| s.to == self.first);
                closing.map(|s| (s.cost, self.run.close().expect("portal numbers match")))
            }
        };
        self
    }
}

/// A piece with so many portals, connected by `choices`.
fn planar(left: usize, right: usize, choices: &[usize], closed: u32, holes: i64) -> Descriptor {
    let mut within_reach: Vec<u32> = Vec::new();
    let mut components = 0;
    let mut labels = Vec::new();
    for &choice in &choices[..left + right] {
        let at = choice % (within_reach.len() + 1);
        // What lies between is cut off.
        within_reach.truncate(at + 1);
        if at == within_reach.len() {
            within_reach.push(components);
            components += 1;
        }
        labels.push(within_reach[at]);
    }
    // The right side is met from the bottom upwards.
    let mut on_the_right = labels.split_off(left);
    on_the_right.reverse();
    let holes = if components + closed == 0 { 0 } else { holes };
    Descriptor::new(&labels, &on_the_right, closed, i64::from(components + closed) - holes)
}

/// Random problems.
fn samples() -> impl Strategy<Value = Sample> {
    let ink = (prop_oneof![4 => Just(0u32), 1 => Just(1)], prop_oneof![6 => 0i64..3, 1 => Just(70)]);
    // Cut down to the most of a problem, so that most pieces fit each other.
    let portals = || prop_oneof![1 => Just(0usize), 2 => 1..=PORTALS, 3 => Just(PORTALS)];
    // Most follow the piece before, so that most problems have a run.
    let left = prop::option::weighted(0.3, portals());
    let piece = (left, portals(), prop::collection::vec(0usize..12, 2 * PORTALS), ink);
    let join = (0u32..10, 0u64..9, -2i32..=2);
    let tables = (prop::collection::vec(piece, 2..=MOST), prop::collection::vec(join, MOST * MOST));
    let costs = || prop::collection::vec(0u64..5, MOST);
    let sizes = (prop::collection::vec(1u32..=3, MOST), costs(), costs());
    // In a band, how many portals there are at most, how many joins, and whether they climb.
    let style = (any::<bool>(), 1..=PORTALS, prop_oneof![Just(6u32), Just(8), Just(10)], 0i32..=1);
    let limit = prop_oneof![4 => 0i32..4, 2 => 4i32..9, 1 => Just(1_000), 1 => Just(5_000)];
    let memory =
        prop_oneof![4 => Just(AMPLE), 2 => Just(4 << 20), 2 => Just(1 << 20), 1 => Just(400_000usize)];
    let asked = (0usize..10, any::<usize>(), (prop_oneof![3 => Just(0u32), 1 => Just(1)], 0u32..3));
    let asked = asked.prop_map(|(kind, run, more)| Asked { kind, run, more });
    let length = prop_oneof![3 => 3u32..13, 1 => 13u32..24];
    let request = ((length, 0u32..4), limit, memory, prop::collection::vec(asked, 4));
    (style, tables, sizes, request).prop_map(
        |((is_ring, most, density, lean), (pieces, joins), (widths, begin, end), request)| {
            let ((low, span), drift_limit, memory_limit, asked) = request;
            let n = pieces.len();
            let is_end = |i: usize, end: usize| !is_ring && i == end;
            let rights: Vec<usize> = pieces.iter().map(|piece| most.min(piece.1)).collect();
            let right = |i: usize| if is_end(i, n - 1) { 0 } else { rights[i] };
            let describe =
                |(i, (left, _, choices, (closed, holes))): (usize, (Option<usize>, _, Vec<usize>, _))| {
                    let left = left.map_or_else(|| right((i + n - 1) % n), |left| most.min(left));
                    let left = if is_end(i, 0) { 0 } else { left };
                    planar(left, right(i), &choices, closed, holes)
                };
            let descriptors: Vec<Descriptor> = pieces.into_iter().enumerate().map(describe).collect();
            let step = |from: usize, to: usize| {
                let fits = descriptors[from].right().len() == descriptors[to].left().len();
                let (rank, cost, rise) = joins[from * MOST + to];
                (fits && (rank < density || to == (from + 1) % n)).then_some(Step {
                    to,
                    cost,
                    rise: rise + lean,
                })
            };
            Sample {
                shape: if is_ring { Shape::Ring } else { Shape::Open },
                widths: widths[..n].to_vec(),
                steps: (0..n).map(|a| (0..n).filter_map(|b| step(a, b)).collect()).collect(),
                begin: begin[..n].to_vec(),
                end: end[..n].to_vec(),
                descriptors,
                window: (low, low + span),
                drift_limit,
                memory_limit,
                asked,
            }
        },
    )
}

/// Tests so many random problems, the same each time, so that what they exercise can be counted.
pub(super) fn for_samples(cases: u32, test: impl Fn(Sample) -> Result<(), TestCaseError>) {
    let config = Config { cases, max_shrink_iters: 20_000, failure_persistence: None, ..Config::default() };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    if let Err(error) = TestRunner::new_with_rng(config, rng).run(&samples(), test) {
        panic!("{error}");
    }
}
