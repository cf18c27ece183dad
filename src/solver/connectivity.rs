//! The graph of how runs can be connected, whatever their length and whatever they have counted.
//!
//! A node is a last piece and how the open portals of the run are connected; an edge is a join and the
//! components and holes that it closes. Counts and costs only add up along a path, so questions of how many
//! and how much are path questions on this graph. Excluded: drift, and in a ring which of the first pieces
//! with equally many portals it began with. What the graph forbids is impossible; what it allows may not be.
//!
//! Where only counts are asked for and no costs, pieces that may be followed by the same pieces lead to the same node:
//! with all joins admitted those are all with as many portals on the right, which leaves a graph many times smaller.

use rustc_hash::FxHashMap;

use super::graph::Scope;
use super::problem::Problem;
use crate::topology::{Descriptor, Goal, Shape};

/// Components and holes that are closed on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub(super) struct Counts {
    pub(super) components: u32,
    pub(super) holes: u32,
}

impl Counts {
    pub(super) fn plus(self, other: Self) -> Self {
        Self { components: self.components + other.components, holes: self.holes + other.holes }
    }
}

/// A join.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Edge {
    pub(super) to: u32,
    /// The width of the piece that is joined, in bins.
    pub(super) width: u32,
    pub(super) closes: Counts,
}

/// A run of one piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Begin {
    pub(super) node: u32,
    /// Its width, in bins.
    pub(super) width: u32,
    pub(super) closes: Counts,
}

/// The graph.
pub(super) struct Connectivity {
    /// The last piece of each node, or one that may be followed by the same.
    pieces: Vec<u32>,
    edges: Vec<Edge>,
    /// Where the edges of each node begin, and where all end.
    first_edge: Vec<u32>,
    endings: Vec<Option<Counts>>,
    starts: Vec<Begin>,
    nodes: FxHashMap<(u32, u32), u32>,
    /// For each piece the one whose nodes it shares.
    kinds: Vec<usize>,
    /// Numbers of the ways of being connected.
    known: FxHashMap<Descriptor, u32>,
}

/// Nodes at which a graph is given up that is made once.
pub(super) const NODE_LIMIT: usize = 30_000;

impl Connectivity {
    /// The graph of all runs within `scope` of which the goal does not rule out a join by itself, with a node for each
    /// last piece; `None` when it has more than `limit` nodes.
    pub(super) fn new(problem: &Problem<'_>, goal: Goal, scope: &Scope, limit: usize) -> Option<Self> {
        Self::explore(problem, goal, scope, (0..problem.pieces()).collect(), limit)
    }

    /// The same for counting only: last pieces that may be followed by the same have one node together.
    pub(super) fn of_kinds(problem: &Problem<'_>, goal: Goal, scope: &Scope, limit: usize) -> Option<Self> {
        Self::explore(problem, goal, scope, kinds(problem, scope), limit)
    }

    /// The graph whose nodes are those of the piece that stands for each.
    fn explore(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        kinds: Vec<usize>,
        limit: usize,
    ) -> Option<Self> {
        let mut graph = Self {
            pieces: Vec::new(),
            edges: Vec::new(),
            first_edge: Vec::new(),
            endings: Vec::new(),
            starts: Vec::new(),
            nodes: FxHashMap::default(),
            kinds,
            known: FxHashMap::default(),
        };
        let mut known: FxHashMap<Descriptor, u32> = FxHashMap::default();
        let mut states: Vec<Descriptor> = Vec::new();
        let mut joins: FxHashMap<(u32, u32), Option<(u32, Counts)>> = FxHashMap::default();
        let mut queue: Vec<(u32, u32)> = Vec::new();
        for &(first, _) in &scope.starts {
            let (state, closes) = enter(&mut known, &mut states, &problem.descriptors[first]);
            if admits(goal, closes, states[state as usize].open()) {
                let node = graph.meet(first, state, &mut queue);
                graph.starts.push(Begin { node, width: problem.widths[first], closes });
            }
        }
        let mut leaving: Vec<Edge> = Vec::new();
        let mut at = 0;
        while let Some(&(piece, state)) = queue.get(at) {
            at += 1;
            if queue.len() > limit {
                return None;
            }
            graph.first_edge.push(graph.edges.len() as u32);
            let ending = scope.stop[piece as usize];
            let ending = ending.and_then(|_| ending_of(&states[state as usize], problem.shape, goal));
            graph.endings.push(ending);
            for step in problem.steps[piece as usize].iter().filter(|s| scope.allowed[s.to]) {
                let key = (state, step.to as u32);
                let joined = *joins.entry(key).or_insert_with(|| {
                    let run = states[state as usize].join(&problem.descriptors[step.to]).ok()?;
                    let (state, closes) = enter(&mut known, &mut states, &run);
                    admits(goal, closes, run.open()).then_some((state, closes))
                });
                if let Some((state, closes)) = joined {
                    let to = graph.meet(step.to, state, &mut queue);
                    leaving.push(Edge { to, width: problem.widths[step.to], closes });
                }
            }
            leaving.sort_unstable();
            leaving.dedup();
            graph.edges.append(&mut leaving);
        }
        graph.first_edge.push(graph.edges.len() as u32);
        graph.known = known;
        Some(graph)
    }

    fn meet(&mut self, piece: usize, state: u32, queue: &mut Vec<(u32, u32)>) -> u32 {
        let piece = self.kinds[piece] as u32;
        *self.nodes.entry((piece, state)).or_insert_with(|| {
            self.pieces.push(piece);
            queue.push((piece, state));
            self.pieces.len() as u32 - 1
        })
    }

    /// The node of the runs that end with `piece` and are connected like this, if there are any.
    pub(super) fn node(&self, piece: usize, connections: &Descriptor) -> Option<u32> {
        let state = self.known.get(connections)?;
        self.nodes.get(&(self.kinds[piece] as u32, *state)).copied()
    }

    /// The number of nodes.
    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// The number of edges.
    pub(super) fn joins(&self) -> usize {
        self.edges.len()
    }

    /// The last piece of a node, or one that stands for it.
    pub(super) fn piece(&self, node: usize) -> usize {
        self.pieces[node] as usize
    }

    /// The joins from a node.
    pub(super) fn edges(&self, node: usize) -> &[Edge] {
        &self.edges[self.first_edge[node] as usize..self.first_edge[node + 1] as usize]
    }

    /// What stopping at a node closes, where it is possible with a goal's winding.
    pub(super) fn ending(&self, node: usize) -> Option<Counts> {
        self.endings[node]
    }

    /// The runs of one piece, and what is closed in them.
    pub(super) fn starts(&self) -> &[Begin] {
        &self.starts
    }
}

/// For each piece the first that may be followed by the same pieces, and stopped at as well.
pub(super) fn kinds(problem: &Problem<'_>, scope: &Scope) -> Vec<usize> {
    let mut first: FxHashMap<(Vec<usize>, bool), usize> = FxHashMap::default();
    let kind = |piece: usize| {
        let steps = problem.steps[piece].iter().map(|step| step.to);
        let mut followers: Vec<usize> = steps.filter(|&to| scope.allowed[to]).collect();
        followers.sort_unstable();
        *first.entry((followers, scope.stop[piece].is_some())).or_insert(piece)
    };
    (0..problem.pieces()).map(kind).collect()
}

/// The state of a run with nothing closed, and what was.
fn enter(
    known: &mut FxHashMap<Descriptor, u32>,
    states: &mut Vec<Descriptor>,
    run: &Descriptor,
) -> (u32, Counts) {
    let closes = Counts { components: run.closed(), holes: run.holes() };
    let connections = run.connections();
    let state = *known.entry(connections.clone()).or_insert_with(|| {
        states.push(connections);
        states.len() as u32 - 1
    });
    (state, closes)
}

/// Whether closing this much at once leaves a chance to meet the goal.
fn admits(goal: Goal, closes: Counts, open: u32) -> bool {
    goal.components.is_none_or(|wanted| closes.components + u32::from(open > 0) <= wanted.most())
        && goal.holes.is_none_or(|wanted| closes.holes <= wanted.most())
}

fn ending_of(run: &Descriptor, shape: Shape, goal: Goal) -> Option<Counts> {
    let topology = match shape {
        Shape::Open => run.finished()?,
        Shape::Ring => run.close().ok()?,
    };
    let closes = Counts { components: topology.components, holes: topology.holes };
    (topology.closed_pattern || !goal.closed_pattern).then_some(closes)
}
