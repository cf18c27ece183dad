//! Graphs whose paths are runs: what the passes along the length walk on.
//!
//! A node is a last piece and whatever else is known of a run that ends with it; an edge is a join. Costs add
//! up along a path and widths are those of the pieces, so a question about the runs of a length is a question
//! about paths, which a [`super::table::Table`] answers.

use std::hash::Hash;

use rustc_hash::FxHashMap;

use super::problem::{Cost, Problem, Step};

/// A join.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) cost: Cost,
    pub(super) to: u32,
    /// The width of the piece that is joined, in bins.
    pub(super) width: u32,
    /// By how much it raises the run, in units of drift.
    pub(super) rise: i32,
    /// By how much it raises what is counted, if anything is.
    pub(super) count: i32,
    /// Whether this edge and the next are one join to two nodes at once, both of which must be completed.
    pub(super) and_next: bool,
}

impl Edge {
    /// A step to a node.
    pub(super) fn new(problem: &Problem<'_>, step: &Step, to: u32) -> Self {
        let &Step { to: piece, cost, rise } = step;
        Self { cost, to, width: problem.widths[piece], rise, count: 0, and_next: false }
    }

    /// What it adds to a run.
    pub(super) fn toll(&self) -> Toll {
        Toll { cost: self.cost, rise: self.rise, count: self.count }
    }
}

/// What a join, or stopping, adds to a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Toll {
    pub(super) cost: Cost,
    /// In units of drift.
    pub(super) rise: i32,
    /// Of what is counted.
    pub(super) count: i32,
}

impl From<Cost> for Toll {
    fn from(cost: Cost) -> Self {
        Self { cost, rise: 0, count: 0 }
    }
}

/// The part of a problem that a search looks at.
#[derive(Debug, Clone)]
pub(super) struct Scope {
    /// First pieces, and what beginning with them costs.
    pub(super) starts: Vec<(usize, Cost)>,
    /// The pieces that may occur.
    pub(super) allowed: Vec<bool>,
    /// What stopping after each piece costs, where it may stop.
    pub(super) stop: Vec<Option<Cost>>,
}

/// A graph whose paths are runs.
#[derive(Debug, Clone, Default)]
pub(super) struct Graph {
    edges: Vec<Edge>,
    /// Where the edges of each node begin, and where all end.
    first_edge: Vec<u32>,
    stops: Vec<Option<Toll>>,
}

impl Graph {
    /// A graph without nodes.
    pub(super) fn new() -> Self {
        Self { edges: Vec::new(), first_edge: vec![0], stops: Vec::new() }
    }

    /// Adds a node whose edges are the ones added since the last, and what stopping there adds if it is possible.
    pub(super) fn finish_node(&mut self, stop: Option<Toll>) {
        self.stops.push(stop);
        self.first_edge.push(self.edges.len() as u32);
    }

    /// Adds an edge to the node that is going to be finished next.
    pub(super) fn add(&mut self, edge: Edge) {
        self.edges.push(edge);
    }

    /// The number of nodes.
    pub(super) fn len(&self) -> usize {
        self.stops.len()
    }

    /// All edges, by the node that they leave.
    pub(super) fn all_edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The numbers of the edges that leave a node.
    pub(super) fn edges_of(&self, node: usize) -> std::ops::Range<usize> {
        self.first_edge[node] as usize..self.first_edge[node + 1] as usize
    }

    /// What stopping at a node adds, if it may be stopped at.
    pub(super) fn stop(&self, node: usize) -> Option<Toll> {
        self.stops[node]
    }

    /// The additions that a pass over lengths up to `longest` takes.
    pub(super) fn work(&self, longest: u32) -> usize {
        self.edges.len().saturating_mul(longest as usize)
    }

    /// The greatest width of an edge; 1 without edges.
    pub(super) fn widest(&self) -> usize {
        self.edges.iter().map(|e| e.width as usize).max().unwrap_or(1)
    }
}

/// The joins of `problem` alone: a node for each piece.
pub(super) fn of_pieces(problem: &Problem<'_>, scope: &Scope) -> Graph {
    let mut graph = Graph::new();
    for piece in 0..problem.pieces() {
        let is_allowed = scope.allowed[piece];
        for step in problem.steps[piece].iter().filter(|s| is_allowed && scope.allowed[s.to]) {
            graph.add(Edge::new(problem, step, step.to as u32));
        }
        graph.finish_node(scope.stop[piece].filter(|_| is_allowed).map(Toll::from));
    }
    graph
}

/// A graph that is explored from its starts, with the nodes found by what is known of a run.
pub(super) struct Explored<K> {
    pub(super) graph: Graph,
    nodes: FxHashMap<(u32, K), u32>,
    /// The piece and the rest of each node.
    keys: Vec<(u32, K)>,
}

/// What can follow at a node: the joins, each with what it counts and the keys of the nodes that it leads to.
pub(super) type Joins<K> = Vec<(Step, i32, Vec<K>)>;

impl<K: Hash + Eq + Clone> Explored<K> {
    /// Everything that can be reached from `starts`; `None` when that is more than `limit` nodes. `expand` gives
    /// for a piece and a key what stopping there adds, and the joins.
    pub(super) fn new(
        problem: &Problem<'_>,
        starts: impl IntoIterator<Item = (usize, K)>,
        limit: usize,
        mut expand: impl FnMut(usize, &K, &mut Joins<K>) -> Option<Toll>,
    ) -> Option<Self> {
        let mut found = Self { graph: Graph::new(), nodes: FxHashMap::default(), keys: Vec::new() };
        for (piece, key) in starts {
            found.meet(piece, key);
        }
        let mut joins = Joins::new();
        let mut at = 0;
        while at < found.keys.len() {
            if found.keys.len() > limit {
                return None;
            }
            let (piece, key) = found.keys[at].clone();
            joins.clear();
            let stop = expand(piece as usize, &key, &mut joins);
            for (step, count, keys) in joins.drain(..) {
                let last = keys.len().saturating_sub(1);
                for (i, key) in keys.into_iter().enumerate() {
                    let node = found.meet(step.to, key);
                    let and_next = i < last;
                    found.graph.add(Edge { count, and_next, ..Edge::new(problem, &step, node) });
                }
            }
            found.graph.finish_node(stop);
            at += 1;
        }
        Some(found)
    }

    fn meet(&mut self, piece: usize, key: K) -> u32 {
        let keys = &mut self.keys;
        *self.nodes.entry((piece as u32, key)).or_insert_with_key(|key| {
            keys.push(key.clone());
            keys.len() as u32 - 1
        })
    }

    /// The node of a piece and a key, if it was reached.
    pub(super) fn node(&self, piece: usize, key: K) -> Option<usize> {
        self.nodes.get(&(piece as u32, key)).map(|&node| node as usize)
    }

    /// The last piece of the runs of a node.
    pub(super) fn piece(&self, node: usize) -> usize {
        self.keys[node].0 as usize
    }
}
