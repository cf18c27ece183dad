//! All sequences that meet the constraints: how many there are, and random ones with known probability.
//!
//! A pass over all triples of piece, state and drift sums up exp(−cost/T) over all completions of a run; a walk
//! that chooses each next piece in proportion to these sums draws a whole sequence in proportion to its own
//! weight (filtering in one direction, sampling in the other). With an infinite temperature every weight is 1
//! and the sum counts. A ring is a sequence that is opened at one of its narrowest cuts: one that can be opened
//! in several places counts as often.
//!
//! Excluded: problems whose triples are too many, which have no census.

use super::big::Big;
use super::estimates::triples;
use super::family::families;
use super::graph::{Explored, Scope};
use super::problem::Problem;
use super::random::Random;
use super::table::{TABLE_BUDGET, Table, Weigh};
use crate::topology::{Automaton, Goal, StateId};

/// Nodes at which a census is given up.
const NODE_LIMIT: usize = 120_000;

/// All sequences of a problem that meet a goal, weighed.
pub struct Census<'p> {
    problem: &'p Problem<'p>,
    automaton: Automaton<'p>,
    temperature: f64,
    /// Scopes with a first piece or several, and what their runs weigh together.
    parts: Vec<(Scope, Big)>,
    total: Big,
    /// The part whose table was used last.
    open: Option<(usize, Triples)>,
}

/// Runs by last piece, state and drift.
struct Triples {
    explored: Explored<(StateId, i32)>,
    table: Table<Big>,
    /// First nodes and what beginning with them weighs.
    starts: Vec<(usize, Big)>,
}

impl<'p> Census<'p> {
    /// The census of the sequences that meet `goal`, each weighed exp(−cost/`temperature`), the temperature in units
    /// of the cost; a temperature of infinity counts them. `None` when it would take more than `effort` additions, of
    /// which there are some 100 millions in a second.
    pub fn new(problem: &'p Problem<'p>, goal: Goal, temperature: f64, effort: usize) -> Option<Self> {
        let mut census = Self {
            problem,
            automaton: Automaton::new(problem.descriptors, goal, problem.shape),
            temperature: temperature * 1e6,
            parts: Vec::new(),
            total: Big::ZERO,
            open: None,
        };
        let mut patience = effort;
        for family in families(problem, goal.closed_pattern) {
            for member in family.members {
                let mut triples = census.triples(&member.scope, &mut patience)?;
                let weight = triples.total(problem);
                if weight != Big::ZERO {
                    census.total = census.total.or(weight);
                    census.open = Some((census.parts.len(), triples));
                    census.parts.push((member.scope, weight));
                }
            }
        }
        Some(census)
    }

    /// The natural logarithm of the sum of all weights: of the number of sequences at an infinite temperature. −∞
    /// when there is none.
    pub fn ln_total(&self) -> f64 {
        self.total.ln()
    }

    /// A sequence drawn in proportion to its weight; `None` when there is none.
    pub fn draw(&mut self, random: &mut Random) -> Option<Vec<usize>> {
        if self.total == Big::ZERO {
            return None;
        }
        let chosen = choose(random, self.total, self.parts.iter().map(|(_, weight)| *weight))?;
        if self.open.as_ref().is_none_or(|(part, _)| *part != chosen) {
            let scope = self.parts[chosen].0.clone();
            let mut patience = usize::MAX;
            self.open = Some((chosen, self.triples(&scope, &mut patience)?));
        }
        let (_, triples) = self.open.as_mut()?;
        triples.draw(self.problem, random)
    }

    fn triples(&mut self, scope: &Scope, patience: &mut usize) -> Option<Triples> {
        let Self { problem, automaton, temperature, .. } = self;
        let starts: Vec<(usize, u64, StateId)> =
            scope.starts.iter().filter_map(|&(p, cost)| automaton.start(p).map(|s| (p, cost, s))).collect();
        let mut explored = triples(problem, automaton, scope, true, NODE_LIMIT)?;
        let graph = std::mem::take(&mut explored.graph);
        *patience = patience.checked_sub(graph.work(*problem.window.end()))?;
        let weigh = |cost| Big::of_cost(cost, *temperature);
        let table =
            Table::new(graph.into(), problem.window.clone(), 2 * TABLE_BUDGET, |toll| weigh(toll.cost));
        let starts = starts.into_iter().filter_map(|(piece, cost, state)| {
            explored.node(piece, (state, 0)).map(|node| (node, weigh(cost)))
        });
        let starts = starts.collect();
        Some(Triples { explored, table, starts })
    }
}

impl Triples {
    /// What beginning with each start and completing it weighs.
    fn of_starts(&mut self, problem: &Problem<'_>) -> Vec<Big> {
        let Self { explored, table, starts } = self;
        let weight = |&(node, weight): &(usize, Big)| {
            let length = problem.widths[explored.piece(node)];
            table.load(length.min(*problem.window.end()));
            table.at(length, node).after(weight)
        };
        starts.iter().map(weight).collect()
    }

    fn total(&mut self, problem: &Problem<'_>) -> Big {
        self.of_starts(problem).into_iter().fold(Big::ZERO, Weigh::or)
    }

    fn draw(&mut self, problem: &Problem<'_>, random: &mut Random) -> Option<Vec<usize>> {
        let weights = self.of_starts(problem);
        let total = weights.iter().copied().fold(Big::ZERO, Weigh::or);
        let start = choose(random, total, weights.into_iter())?;
        let Self { explored, table, starts } = self;
        let mut node = starts[start].0;
        let mut length = problem.widths[explored.piece(node)];
        let mut sequence = Vec::new();
        loop {
            sequence.push(explored.piece(node));
            table.load(length);
            let edges = table.graph().edges_of(node);
            let stopping = table.stopping(length, node);
            let going_on = edges.clone().map(|e| {
                let edge = table.graph().all_edges()[e];
                table.at(length + edge.width, edge.to as usize).after(table.weight(e))
            });
            let chosen = choose(random, table.at(length, node), std::iter::once(stopping).chain(going_on))?;
            let Some(edge) = chosen.checked_sub(1) else { return Some(sequence) };
            let edge = table.graph().all_edges()[edges.start + edge];
            (node, length) = (edge.to as usize, length + edge.width);
        }
    }
}

/// The number of one of `weights`, which add up to `total`, drawn in proportion to them.
fn choose(random: &mut Random, total: Big, weights: impl Iterator<Item = Big>) -> Option<usize> {
    let mut left = random.unit();
    let mut last = None;
    for (i, weight) in weights.enumerate().filter(|(_, weight)| *weight != Big::ZERO) {
        left -= weight.part_of(total);
        last = Some(i);
        if left < 0.0 {
            break;
        }
    }
    // What rounding leaves over belongs to the last.
    last
}
