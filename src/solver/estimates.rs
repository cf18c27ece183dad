//! Admissible estimates: the least cost of completing a run when something is ignored.
//!
//! Each is a pass over a smaller graph, exact for what its nodes know; the greatest of them drives the search.
//! The pieces alone are made for every search. The others are dear, and are made when a short search has not
//! ended:
//!
//! - *exact*: all pairs of piece and state, where they are few. Nothing but the drift is ignored.
//! - *classes*: for one component, one class of a run's portals against all the others ([`super::classes`]).
//! - *connected*: for other counts, all pairs of piece and connections of portals ([`super::connected`]).
//!
//! Where runs leave the band each of these knows the drift by a price ([`super::priced`]). Where that is not enough, the
//! pairs of piece and state are taken with the drift, or the pieces alone where the run is long.

use std::sync::Arc;

use super::classes::Classes;
use super::completions::Completions;
use super::connected::Connected;
use super::graph::{Explored, Scope, Toll, of_pieces};
use super::lengths::has_level_run;
use super::price::Start;
use super::priced::{Passes, estimate};
use super::problem::{Cost, Problem};
use super::table::{NEVER, Table};
use crate::topology::{Automaton, Goal, StateId};

/// Nodes of a graph at which it is given up: of one that is made soon, and of one that is made when much was searched.
const NODE_LIMITS: [usize; 2] = [6_000, 60_000];
/// Additions in the pass that knows state and drift beyond which it is not begun: about a second.
const WORK_LIMIT: usize = 1_000_000_000;
/// Additions in the pass that knows the drift, of which there are some 700 million in a second.
const DRIFT_WORK_LIMIT: usize = 10_000_000_000;
/// What estimates know, from the cheapest to the dearest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    /// Pieces and joins.
    Pieces,
    /// And how portals are connected, where that is simple.
    Topology,
    /// Or where it is not.
    Fine,
    /// And what rising costs in the end.
    Prices,
    /// And the drift itself.
    Drift,
}

/// Runs by what is known of them, the drift among it, and what completing them costs at least.
type Drifting<K> = (Explored<K>, Table<Cost>);

/// The estimates that are dear to make, as far as they were made.
#[derive(Default)]
pub(super) struct Estimates {
    exact: Option<(Explored<(StateId, i32)>, Passes)>,
    classes: Option<Classes>,
    connected: Option<Connected>,
    /// Whether no run stays in the band.
    is_never: bool,
    /// The same with the drift.
    drifting: Option<Drifting<(StateId, i32)>>,
    /// And without the state.
    drifts: Option<Drifting<i32>>,
    /// What a run may still count, made when only a beam can find one.
    completions: Option<Completions>,
    /// Of the pieces alone, made when the drift is known and neither of the others is.
    pieces: Option<Passes>,
}

impl Estimates {
    /// With classes where all pairs of piece and state would be few enough.
    #[cfg(test)]
    pub(super) fn of_classes(classes: Classes) -> Self {
        Self { classes: Some(classes), ..Self::default() }
    }

    /// With prices on what is counted where all pairs of piece and state would be few enough.
    #[cfg(test)]
    pub(super) fn of_connected(connected: Connected) -> Self {
        Self { connected: Some(connected), ..Self::default() }
    }

    /// Makes the estimates that know topology, as far as they are small or, when they are to be `fine`, as far as they
    /// are affordable.
    pub(super) fn learn_topology(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
        is_fine: bool,
    ) {
        if automaton.goal().is_free() || self.exact.is_some() {
            return;
        }
        let limit = problem.share(NODE_LIMITS[usize::from(is_fine)]);
        self.exact = triples(problem, automaton, scope, false, limit).and_then(|mut explored| {
            let passes = Passes::new(problem, std::mem::take(&mut explored.graph))?;
            Some((explored, passes))
        });
        self.classes = match (self.exact.is_some(), self.classes.take()) {
            (true, _) => None,
            (false, coarser) => Classes::new(problem, automaton.goal(), scope, limit, coarser),
        };
        self.connected = match (self.exact.is_none() && self.classes.is_none(), self.connected.take()) {
            (true, None) => Connected::new(problem, automaton.goal(), scope, limit),
            (true, known) => known,
            (false, _) => None,
        };
    }

    /// Makes what is known know the drift, by prices.
    pub(super) fn learn_prices(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
    ) {
        let begin = |piece: usize, node: usize, cost: Cost| Start {
            node,
            length: problem.widths[piece],
            cost,
            count: 0,
        };
        if let Some((explored, passes)) = &mut self.exact {
            let starts = scope.starts.iter().filter_map(|&(piece, cost)| {
                let node = explored.node(piece, (automaton.start(piece)?, 0))?;
                Some(begin(piece, node, cost))
            });
            let starts: Vec<_> = starts.collect();
            passes.learn_drift(problem, &starts);
            if passes.only_leaves() {
                let starts = starts.iter().map(|start| (start.node, start.length));
                self.is_never = has_level_run(problem, passes.graph(), starts) == Some(false);
            }
        } else if let Some(classes) = &mut self.classes {
            classes.learn_drift(problem, scope);
        } else if let Some(connected) = &mut self.connected {
            connected.learn_drift(problem, scope);
        } else {
            let starts = scope.starts.iter().map(|&(piece, cost)| begin(piece, piece, cost));
            self.pieces = Passes::new(problem, of_pieces(problem, scope));
            if let Some(passes) = &mut self.pieces {
                passes.learn_drift(problem, &starts.collect::<Vec<_>>());
            }
        }
    }

    /// Makes the pass over all pairs of piece and state with the drift, if it is affordable.
    pub(super) fn learn_drift(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
    ) {
        let limit = problem.share(NODE_LIMITS[1]);
        let longest = *problem.window.end();
        if self.exact.is_some() || automaton.goal().is_free() {
            let is_short = |found: &Explored<_>| found.graph.work(longest) <= problem.share(WORK_LIMIT);
            let found = triples(problem, automaton, scope, true, limit).filter(is_short);
            self.drifting = found.and_then(|explored| drifting(problem, explored));
        }
        if self.drifting.is_none() {
            // Longer runs without their state, which leaves far fewer nodes.
            let found = with_drift(problem, scope, limit);
            self.drifts = found.and_then(|explored| drifting(problem, explored));
        }
    }

    /// Makes known which counts a run may still come to, if that is affordable.
    pub(super) fn learn_completions(
        &mut self,
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        scopes: usize,
    ) {
        self.completions = Completions::new(problem, goal, scope, scopes);
    }

    /// Whether the estimate leaves nothing but the drift out of account.
    pub(super) fn is_exact(&self) -> bool {
        self.exact.as_ref().is_some_and(|(_, passes)| passes.is_whole())
    }

    /// Makes the rows of `length` and of what a step leads to available.
    pub(super) fn load(&mut self, length: u32) {
        let Self { exact, classes, connected, pieces, drifting, drifts, .. } = self;
        connected.iter_mut().for_each(|connected| connected.load(length));
        let tables = [drifting.as_mut().map(|(_, table)| table), drifts.as_mut().map(|(_, table)| table)];
        tables.into_iter().flatten().for_each(|table| table.load(length));
        let passes = [
            exact.as_mut().map(|(_, passes)| passes),
            classes.as_mut().map(|classes| &mut classes.passes),
            pieces.as_mut(),
        ];
        passes.into_iter().flatten().for_each(|passes| passes.load(length));
    }

    /// The estimate for a run of `length` that ends with `piece` in `state`, at a length that is loaded, with its
    /// drift where runs are told apart by it.
    pub(super) fn rest(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        run: (u32, usize, StateId, Option<i32>),
    ) -> Cost {
        let (length, piece, state, drift) = run;
        let comes_to_nothing =
            |known: &mut Completions| !known.may_complete(automaton, (length, piece, state));
        if self.is_never || self.completions.as_mut().is_some_and(comes_to_nothing) {
            return NEVER;
        }
        let mut rest = 0;
        if let Some(passes) = &self.pieces {
            rest = passes.rest(problem, length, piece, 0, drift);
        }
        if let Some((explored, passes)) = &self.exact {
            // What was not reached is from another scope, of which nothing is known here.
            let node = explored.node(piece, (state, 0));
            rest = rest.max(node.map_or(0, |node| passes.rest(problem, length, node, 0, drift)));
        }
        if let (Some((explored, table)), Some(drift)) = (&self.drifting, drift) {
            let node = explored.node(piece, (state, drift));
            rest = rest.max(node.map_or(0, |node| table.at(length, node)));
        }
        if let (Some((explored, table)), Some(drift)) = (&self.drifts, drift) {
            rest = rest.max(explored.node(piece, drift).map_or(0, |node| table.at(length, node)));
        }
        if let Some(classes) = &mut self.classes {
            rest = rest.max(classes.rest(problem, automaton, run));
        }
        if let Some(connected) = &mut self.connected {
            rest = rest.max(connected.rest(problem, automaton, run));
        }
        rest
    }

    /// Takes what was learned of the classes of the states that were met since into the estimate; whether there
    /// was enough of it to be worth while.
    pub(super) fn learn_more(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        scope: &Scope,
    ) -> bool {
        self.classes.as_mut().is_some_and(|classes| classes.grow(problem, automaton, scope))
    }
}

/// All pairs of piece and state that runs reach, with the drift if asked for, which is 0 otherwise; `None` when they
/// are more than `limit`.
pub(super) fn triples(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    scope: &Scope,
    by_drift: bool,
    limit: usize,
) -> Option<Explored<(StateId, i32)>> {
    let starts = scope.starts.iter().filter_map(|&(p, _)| automaton.start(p).map(|s| (p, (s, 0))));
    let starts: Vec<(usize, (StateId, i32))> = starts.collect();
    Explored::new(problem, starts, limit, |piece, &(state, drift), joins| {
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            let drift = if by_drift { drift.saturating_add(step.rise) } else { 0 };
            if drift.saturating_abs() > problem.drift_limit {
                continue;
            }
            if let Some(next) = automaton.step(state, step.to) {
                joins.push((*step, 0, vec![(next, drift)]));
            }
        }
        scope.stop[piece].filter(|_| automaton.accepts(state)).map(Toll::from)
    })
}

/// All pairs of piece and drift that runs reach; `None` when they are more than `limit`.
fn with_drift(problem: &Problem<'_>, scope: &Scope, limit: usize) -> Option<Explored<i32>> {
    let starts: Vec<(usize, i32)> = scope.starts.iter().map(|&(piece, _)| (piece, 0)).collect();
    Explored::new(problem, starts, limit, |piece, &drift, joins| {
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            let drift = drift.saturating_add(step.rise);
            if drift.saturating_abs() <= problem.drift_limit {
                joins.push((*step, 0, vec![drift]));
            }
        }
        scope.stop[piece].map(Toll::from)
    })
}

/// The pass over what was explored.
fn drifting<K>(problem: &Problem<'_>, mut explored: Explored<K>) -> Option<Drifting<K>> {
    let graph = Arc::new(std::mem::take(&mut explored.graph));
    let table = estimate(problem, &graph, problem.share(DRIFT_WORK_LIMIT), |toll| toll.cost)?;
    Some((explored, table))
}
