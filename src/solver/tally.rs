//! How many sequences meet the constraints: exactly where that is affordable, otherwise from how many to how many.
//!
//! The pairs of piece and state of the automaton that runs reach do not depend on the length, and most ornaments have
//! few. They are explored, and their paths are counted for every drift at once ([`super::rows`]). A ring is counted from
//! each first piece by itself; it counts once for each narrowest cut at which it can be opened.
//!
//! Where the pairs are too many, only some are explored, those of a known sequence first. A join to a pair that was not
//! is led to an explored one with the same last piece. If that can be completed in more ways ([`Automaton::dominates`]),
//! runs are counted that there are not, and never one less; if it can be completed in fewer, the other way round. Where
//! none compares, the join is left out for the lower bound, and for the upper one the run goes on as if nothing was
//! asked of its topology. Rings of all first pieces are bounded by runs that can be closed to any.
//!
//! Excluded: costs, and drawing, which is what [`super::census`] is for.

use rustc_hash::FxHashMap;

use super::family::{closing_costs, scopes};
use super::graph::Scope;
use super::problem::{Cost, Problem, Step};
use super::rows::{Bounds, Link, Links, Runs};
use crate::topology::{Automaton, Goal, Shape, StateId};

/// Rows that are made before all grow by the same factor, at least.
const FEWEST_ROWS: usize = 64;
/// The part of the effort that each of the bounds may take where counting would take too much.
const PART_FOR_BOUNDS: usize = 100;
/// Bytes of rows at which sequences are not counted.
const MOST_BYTES: usize = 64 << 20;
/// Explored pairs that a join to another one is compared with.
const COMPARED: usize = 48;
/// Logarithms that are nearer to each other are of the same number.
const SAME: f64 = 1e-3;

/// The natural logarithm of the number of sequences that meet the constraints. A ring counts once for each narrowest cut
/// at which it can be opened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally {
    /// Of a number that is not greater.
    pub ln_at_least: f64,
    /// Of a number that is not less.
    pub ln_at_most: f64,
}

impl Tally {
    /// The logarithm of the number itself, if it was counted; −∞ of none.
    pub fn ln_counted(&self) -> Option<f64> {
        let is_same = self.ln_at_least == self.ln_at_most || self.ln_at_most - self.ln_at_least <= SAME;
        is_same.then_some(self.ln_at_least.midpoint(self.ln_at_most))
    }
}

/// How many sequences of `problem` meet `goal`. `known` is one of them, if one is known, and `effort` the work that may
/// be done, of which there are some 20 million units in a second.
pub fn tally(problem: &Problem<'_>, goal: Goal, known: Option<&[usize]>, effort: usize) -> Tally {
    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
    let scopes = scopes(problem, goal.closed_pattern);
    let counted = exactly(problem, &mut automaton, &scopes, effort);
    let Bounds { least, most } =
        counted.unwrap_or_else(|| between(problem, &mut automaton, &scopes, known, effort));
    // What is known is one.
    let least = if known.is_some() { least.max(0.0) } else { least };
    Tally { ln_at_least: least, ln_at_most: most.max(least) }
}

/// The number itself; `None` when it takes too much.
fn exactly(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    scopes: &[Scope],
    effort: usize,
) -> Option<Bounds> {
    let mut left = effort;
    let mut passes = Vec::new();
    // Everything is looked at before anything is counted, so that giving up is cheap.
    for scope in scopes {
        let rings = if problem.shape == Shape::Ring { scope.starts.len() } else { 1 };
        let limit = nodes_for(problem, left / rings.max(1));
        let pairs = Pairs::explore(problem, automaton, std::slice::from_ref(scope), &[], limit);
        if !pairs.is_complete() {
            return None;
        }
        for Part { starts, stop } in pairs.parts(problem, automaton, scope) {
            let is_stop = |pair: &Pair| stop[pair.piece as usize].is_some() && automaton.accepts(pair.state);
            let links = pairs.links(problem, is_stop, |_, known| known).pruned();
            if links.bytes(problem.drift_limit) > MOST_BYTES {
                return None;
            }
            let rows = FEWEST_ROWS.min(*problem.window.end() as usize);
            left = left.checked_sub(links.len() * rows)?;
            passes.push((links, starts));
        }
    }
    let mut patience = effort;
    let counts = passes.iter().map(|(links, starts)| links.count(&runs(problem, starts), &mut patience));
    Some(counts.fold(Bounds::NONE, Bounds::or)).filter(|found| found.most < f64::INFINITY)
}

/// Bounds of the number, for a part of the effort.
fn between(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    scopes: &[Scope],
    known: Option<&[usize]>,
    effort: usize,
) -> Bounds {
    let effort = effort / PART_FOR_BOUNDS;
    let known = known.unwrap_or(&[]);
    let pairs = Pairs::explore(problem, automaton, scopes, known, nodes_for(problem, effort));
    let by_piece = pairs.by_piece(problem);
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);

    // What is not explored is as free as can be.
    let free = pairs.explored() as u32;
    let above = |automaton: &Automaton<'_>, piece: usize, state: StateId| {
        let found = pairs.nearest(&by_piece[piece], state, |a, b| automaton.dominates(a, b));
        found.unwrap_or(free + piece as u32)
    };
    let is_stop = |pair: &Pair| {
        scopes[pair.scope as usize].stop[pair.piece as usize].is_some() && automaton.accepts(pair.state)
    };
    let mut links =
        pairs.links(problem, is_stop, |join, known| known.or_else(|| Some(above(automaton, join.0, join.1))));
    for (piece, steps) in problem.steps.iter().enumerate() {
        let link = |step: &Step| link(problem, step, free + step.to as u32);
        links.links.push(steps.iter().map(link).collect());
        links.stops.push(match problem.shape {
            Shape::Open => problem.end[piece].is_some(),
            Shape::Ring => !steps.is_empty(),
        });
    }
    let all = scopes.iter().flat_map(|scope| &scope.starts).map(|start| start.0);
    let starts: Vec<(usize, StateId)> =
        all.filter_map(|piece| automaton.start(piece).map(|state| (piece, state))).collect();
    let starts: Vec<(u32, u32)> = starts
        .into_iter()
        .map(|(piece, state)| {
            let node = pairs.explored_id(piece, state);
            (node.unwrap_or_else(|| above(automaton, piece, state)), problem.widths[piece])
        })
        .collect();
    let links = links.pruned();
    if links.bytes(problem.drift_limit) <= MOST_BYTES {
        most = links.count(&runs(problem, &starts), &mut (2 * effort)).most;
    }
    if most == f64::INFINITY {
        most = at_most_any(problem, starts.len());
    }

    // And here there is only what is explored.
    if let Some(start) = known.first().and_then(|&first| pairs.start(automaton, first)) {
        let scope = &scopes[pairs.nodes[start as usize].scope as usize];
        let first = known[0];
        let stop = match problem.shape {
            Shape::Open => scope.stop.clone(),
            Shape::Ring => closing_costs(problem, &[first], &scope.allowed),
        };
        let below = |piece: usize, state: StateId| {
            pairs.nearest(&by_piece[piece], state, |a, b| automaton.dominates(b, a))
        };
        let is_stop = |pair: &Pair| stop[pair.piece as usize].is_some() && automaton.accepts(pair.state);
        let links =
            pairs.links(problem, is_stop, |join, known| known.or_else(|| below(join.0, join.1))).pruned();
        if links.bytes(problem.drift_limit) <= MOST_BYTES {
            let starts = [(start, problem.widths[first])];
            least = links.count(&runs(problem, &starts), &mut (10 * effort)).least;
        }
    }
    Bounds { least, most }
}

/// As many sequences as there are ways to go on, as often as there can be pieces.
fn at_most_any(problem: &Problem<'_>, starts: usize) -> f64 {
    let narrowest = problem.widths.iter().copied().min().unwrap_or(1).max(1);
    let pieces = f64::from(*problem.window.end() / narrowest);
    let ways = problem.steps.iter().map(Vec::len).max().unwrap_or(0).max(1) as f64;
    // Runs of fewer pieces are among as many of all numbers.
    (starts.max(1) as f64).ln() + pieces * ways.ln() + pieces.max(1.0).ln()
}

/// Nodes whose rows may be made for so much work.
fn nodes_for(problem: &Problem<'_>, effort: usize) -> usize {
    let joins: usize = problem.steps.iter().map(Vec::len).sum();
    effort.saturating_mul(problem.pieces()) / (joins.max(1) * FEWEST_ROWS)
}

fn runs<'r>(problem: &Problem<'_>, starts: &'r [(u32, u32)]) -> Runs<'r> {
    Runs { starts, window: problem.window.clone(), limit: problem.drift_limit }
}

fn link(problem: &Problem<'_>, step: &Step, to: u32) -> Link {
    Link { to, width: problem.widths[step.to], rise: step.rise }
}

/// A last piece and a state.
struct Pair {
    piece: u32,
    state: StateId,
    /// The scope of the runs.
    scope: u32,
}

/// What is counted together.
struct Part {
    /// The first pairs, each with its length in bins.
    starts: Vec<(u32, u32)>,
    /// What stopping after each piece costs, where it may stop.
    stop: Vec<Option<Cost>>,
}

/// Pairs of piece and state that runs reach.
struct Pairs {
    nodes: Vec<Pair>,
    ids: FxHashMap<(u32, StateId), u32>,
    /// Of each pair that was explored, the joins, each with the pair that it leads to.
    joins: Vec<Vec<(Step, u32)>>,
}

impl Pairs {
    /// The pairs of all scopes, of which so many are explored as `limit` says: those of the `known` sequence first, and all of these.
    fn explore(
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scopes: &[Scope],
        known: &[usize],
        limit: usize,
    ) -> Self {
        let mut pairs = Self { nodes: Vec::new(), ids: FxHashMap::default(), joins: Vec::new() };
        let begins =
            |scope: &Scope| known.first().is_some_and(|&k| scope.starts.iter().any(|&(p, _)| p == k));
        if let Some(scope) = scopes.iter().position(begins) {
            let mut state = automaton.start(known[0]);
            for (at, &piece) in known.iter().enumerate() {
                if at > 0 {
                    state = state.and_then(|state| automaton.step(state, piece));
                }
                let Some(state) = state else { break };
                pairs.meet(piece, state, scope);
            }
        }
        let first = pairs.nodes.len();
        for (number, scope) in scopes.iter().enumerate() {
            for &(piece, _) in &scope.starts {
                if let Some(state) = automaton.start(piece) {
                    pairs.meet(piece, state, number);
                }
            }
        }
        let mut at = 0;
        while at < pairs.nodes.len().min(limit.max(first)) {
            let Pair { piece, state, scope } = pairs.nodes[at];
            let allowed = &scopes[scope as usize].allowed;
            let mut joins = Vec::new();
            for step in problem.steps[piece as usize].iter().filter(|step| allowed[step.to]) {
                if let Some(next) = automaton.step(state, step.to) {
                    joins.push((*step, pairs.meet(step.to, next, scope as usize)));
                }
            }
            pairs.joins.push(joins);
            at += 1;
        }
        pairs
    }

    fn meet(&mut self, piece: usize, state: StateId, scope: usize) -> u32 {
        let nodes = &mut self.nodes;
        *self.ids.entry((piece as u32, state)).or_insert_with(|| {
            nodes.push(Pair { piece: piece as u32, state, scope: scope as u32 });
            nodes.len() as u32 - 1
        })
    }

    /// All runs of a scope, or its rings by their first piece.
    fn parts(&self, problem: &Problem<'_>, automaton: &mut Automaton<'_>, scope: &Scope) -> Vec<Part> {
        let start = |&(piece, _): &(usize, Cost)| {
            let node = self.start(automaton, piece)?;
            Some((node, problem.widths[piece]))
        };
        let starts: Vec<(u32, u32)> = scope.starts.iter().filter_map(start).collect();
        let ring = |start: (u32, u32)| {
            let first = self.nodes[start.0 as usize].piece as usize;
            Part { starts: vec![start], stop: closing_costs(problem, &[first], &scope.allowed) }
        };
        match problem.shape {
            Shape::Open => vec![Part { starts, stop: scope.stop.clone() }],
            Shape::Ring => starts.into_iter().map(ring).collect(),
        }
    }

    fn is_complete(&self) -> bool {
        self.joins.len() == self.nodes.len()
    }

    /// The number of pairs that were explored, which are the first.
    fn explored(&self) -> usize {
        self.joins.len()
    }

    fn explored_id(&self, piece: usize, state: StateId) -> Option<u32> {
        let id = self.ids.get(&(piece as u32, state)).copied();
        id.filter(|&id| (id as usize) < self.explored())
    }

    /// The explored pair of a run of one piece.
    fn start(&self, automaton: &mut Automaton<'_>, piece: usize) -> Option<u32> {
        automaton.start(piece).and_then(|state| self.explored_id(piece, state))
    }

    /// The explored pairs of each piece.
    fn by_piece(&self, problem: &Problem<'_>) -> Vec<Vec<u32>> {
        let mut found = vec![Vec::new(); problem.pieces()];
        for (id, pair) in (0u32..).zip(&self.nodes[..self.explored()]) {
            found[pair.piece as usize].push(id);
        }
        found
    }

    /// Of the first of some pairs with one piece those whose state is `beyond` this one, and of these one that no other
    /// lies between.
    fn nearest(&self, ids: &[u32], state: StateId, beyond: impl Fn(StateId, StateId) -> bool) -> Option<u32> {
        let state_of = |id: u32| self.nodes[id as usize].state;
        let found = ids.iter().take(COMPARED).copied().filter(|&id| beyond(state_of(id), state));
        found.reduce(|a, b| if beyond(state_of(a), state_of(b)) { b } else { a })
    }

    /// The explored pairs as a graph. `lead` says for each join, by piece and state, where it leads: with the pair
    /// itself, if that was explored.
    fn links(
        &self,
        problem: &Problem<'_>,
        is_stop: impl Fn(&Pair) -> bool,
        mut lead: impl FnMut((usize, StateId), Option<u32>) -> Option<u32>,
    ) -> Links {
        let explored = self.explored();
        let mut of_node = |joins: &Vec<(Step, u32)>| {
            let leads = joins.iter().filter_map(|(step, to)| {
                let known = Some(*to).filter(|&to| (to as usize) < explored);
                let to = lead((step.to, self.nodes[*to as usize].state), known)?;
                Some(link(problem, step, to))
            });
            leads.collect()
        };
        let links = self.joins.iter().map(&mut of_node).collect();
        Links { links, stops: self.nodes[..explored].iter().map(is_stop).collect() }
    }
}
