//! The estimate for numbers of components or holes: what is wanted has a price.
//!
//! How the open portals of a run are connected says what each join closes, so on the graph of connections
//! ([`Connectivity`]) components and holes add up along a run as costs do, and have a price ([`super::priced`]). The
//! further a target is from what the ornament gives by itself, the more that says. Excluded: both prices at once; with
//! both numbers wanted there is an estimate for each. One component has [`super::classes`].

use rustc_hash::FxHashMap;

use super::connectivity::{Begin, Connectivity, Counts};
use super::graph::{Edge, Graph, Scope, Toll};
use super::price::Start;
use super::priced::Passes;
use super::problem::{Cost, Problem};
use crate::topology::{Automaton, Goal, StateId, Wanted};

/// Which number is given a price.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Priced {
    Components,
    Holes,
}

impl Priced {
    fn of(self, counts: Counts) -> u32 {
        match self {
            Self::Components => counts.components,
            Self::Holes => counts.holes,
        }
    }
}

/// What is known of a run and its estimates: how its portals are connected.
pub(super) struct Connected {
    graph: Connectivity,
    estimates: Vec<(Priced, Passes)>,
    /// The node of each piece and state that was met, and what the run has closed.
    nodes: FxHashMap<(u32, StateId), Option<(u32, Counts)>>,
}

impl Connected {
    /// The estimates for the numbers that `goal` wants; `None` when it wants none, and when there are more than `limit`
    /// pairs of piece and connections.
    pub(super) fn new(problem: &Problem<'_>, goal: Goal, scope: &Scope, limit: usize) -> Option<Self> {
        let wanted = [(Priced::Components, goal.components), (Priced::Holes, goal.holes)];
        let wanted = wanted.into_iter().filter_map(|(priced, wanted)| Some((priced, wanted?)));
        let graph = Connectivity::new(problem, goal, scope, limit)?;
        let estimate = |(priced, wanted): (Priced, Wanted)| {
            let mut passes = Passes::new(problem, counted(problem, scope, &graph, priced))?;
            let bounds = i64::from(wanted.least())..=i64::from(wanted.most());
            passes.learn_counts(problem, &starts(scope, &graph, priced), bounds);
            Some((priced, passes))
        };
        let estimates: Vec<_> = wanted.filter_map(estimate).collect();
        (!estimates.is_empty()).then(|| Self { graph, estimates, nodes: FxHashMap::default() })
    }

    /// Makes the estimates know the drift, by prices.
    pub(super) fn learn_drift(&mut self, problem: &Problem<'_>, scope: &Scope) {
        for (priced, passes) in &mut self.estimates {
            passes.learn_drift(problem, &starts(scope, &self.graph, *priced));
        }
    }

    /// Makes the rows of `length` and of what a step leads to available.
    pub(super) fn load(&mut self, length: u32) {
        self.estimates.iter_mut().for_each(|(_, passes)| passes.load(length));
    }

    /// The estimate for a run of a length that is loaded, as [`super::estimates::Estimates::rest`].
    pub(super) fn rest(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        (length, piece, state, drift): (u32, usize, StateId, Option<i32>),
    ) -> Cost {
        let Self { graph, estimates, nodes } = self;
        let known = nodes.entry((piece as u32, state)).or_insert_with(|| {
            let node = graph.node(piece, &automaton.connections(state)?.connections())?;
            let (components, holes) = automaton.closed(state);
            Some((node, Counts { components, holes }))
        });
        // What was not reached is from another scope, of which nothing is known here.
        let Some((node, closed)) = *known else { return 0 };
        let rest = |(priced, passes): &(Priced, Passes)| {
            passes.rest(problem, length, node as usize, i64::from(priced.of(closed)), drift)
        };
        estimates.iter().map(rest).max().unwrap_or(0)
    }
}

/// The graph with the costs of joins, and what each closes as its count.
fn counted(problem: &Problem<'_>, scope: &Scope, connectivity: &Connectivity, priced: Priced) -> Graph {
    let mut graph = Graph::new();
    for node in 0..connectivity.len() {
        let piece = connectivity.piece(node);
        for edge in connectivity.edges(node) {
            let to = connectivity.piece(edge.to as usize);
            let step = problem.steps[piece].iter().find(|step| step.to == to);
            let step = step.expect("the graph has the joins of the problem");
            let count = priced.of(edge.closes) as i32;
            graph.add(Edge { count, ..Edge::new(problem, step, edge.to) });
        }
        let ending = scope.stop[piece].zip(connectivity.ending(node));
        let toll = |(cost, closes)| Toll { cost, rise: 0, count: priced.of(closes) as i32 };
        graph.finish_node(ending.map(toll));
    }
    graph
}

fn starts(scope: &Scope, graph: &Connectivity, priced: Priced) -> Vec<Start> {
    let start = |&Begin { node, width, closes }: &Begin| {
        let piece = graph.piece(node as usize);
        let cost = scope.starts.iter().find(|&&(first, _)| first == piece).map_or(0, |&(_, cost)| cost);
        let count = i64::from(priced.of(closes));
        Start { node: node as usize, length: width, cost, count }
    };
    graph.starts().iter().map(start).collect()
}
