//! The k cheapest sequences, none twice.
//!
//! The pass over all pairs of piece and state gives the exact cost of the best completion of any run. Runs are
//! extended in the order of it: the first to be complete is the cheapest sequence, the next the second cheapest,
//! and so on. What leaves the band is passed over; where that is too much, the pass is taken with the drift. Rings
//! that are rotations of each other are one.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::estimates::triples;
use super::family::families;
use super::graph::{Explored, Scope};
use super::problem::{Cost, Problem, Solution, Unsolved};
use super::table::{NEVER, TABLE_BUDGET, Table};
use crate::topology::{Automaton, Goal, Shape, StateId};

/// Nodes at which it is given up, where there is memory for them.
const NODE_LIMIT: usize = 300_000;
/// Runs at which the drift is taken into the pass, and runs at which it is given up.
const MOST_RUNS: [usize; 2] = [1_000_000, 20_000_000];
/// The most bytes of the table of a scope. More, and listing takes no less time.
const MOST_TABLE: usize = 8 * TABLE_BUDGET;
/// What a run takes, in bytes, with its places in the queue and room to grow.
const RUN_BYTES: usize = 2 * (size_of::<Run>() + 2 * size_of::<Waiting>());

/// The `k` cheapest sequences that meet `goal`, or all if there are fewer, cheapest first. The gap of each is what it
/// costs more than the first. Half of the problem's memory is for tables, half for runs.
///
/// # Errors
/// [`Unsolved::Infeasible`] when there is none, [`Unsolved::TooLarge`] when there is too much to go through, or more than
/// the problem's memory holds.
pub fn best(problem: &Problem<'_>, goal: Goal, k: usize) -> Result<Vec<Solution>, Unsolved> {
    match list(problem, goal, k, false) {
        Err(Unsolved::TooLarge { .. }) => list(problem, goal, k, true),
        found => found,
    }
}

fn list(problem: &Problem<'_>, goal: Goal, k: usize, by_drift: bool) -> Result<Vec<Solution>, Unsolved> {
    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
    let mut lists: Vec<Listing> = Vec::new();
    let mut members: Vec<(Cost, Scope)> = families(problem, goal.closed_pattern)
        .into_iter()
        .flat_map(|family| family.members)
        .map(|member| (member.estimate, member.scope))
        .collect();
    members.sort_by_key(|(estimate, scope)| (Reverse(*estimate), Reverse(scope.starts[0].0)));
    let mut found: Vec<Solution> = Vec::new();
    let mut seen: BTreeSet<Vec<usize>> = BTreeSet::new();
    let (mut steps, mut runs) = (0, 0);
    let most_runs = problem.memory_limit / 2 / RUN_BYTES;
    let mut table_bytes = problem.memory_limit / 2;
    while found.len() < k {
        let next = lists.iter().map(Listing::estimate).min().unwrap_or(NEVER);
        // A member is opened when nothing cheaper is left.
        if members.last().is_some_and(|(estimate, _)| *estimate <= next) {
            let (_, scope) = members.pop().expect("there is a last member");
            let list = Listing::new(problem, &mut automaton, scope, by_drift, &mut table_bytes);
            let list = list.ok_or(Unsolved::TooLarge { labels: steps })?;
            runs += list.runs.len();
            lists.push(list);
            continue;
        }
        let Some(list) = lists.iter_mut().filter(|l| l.estimate() != NEVER).min_by_key(|l| l.estimate())
        else {
            break;
        };
        steps += 1;
        if steps > MOST_RUNS[usize::from(by_drift)] || runs > most_runs {
            return Err(Unsolved::TooLarge { labels: steps });
        }
        let before = list.runs.len();
        let next = list.advance(problem);
        runs += list.runs.len() - before;
        if let Some((cost, sequence)) = next
            && stays_in_band(problem, &sequence)
            && seen.insert(canonical(&sequence, problem.shape))
        {
            let gap = cost - found.first().map_or(cost, |first| first.cost);
            found.push(Solution { sequence, cost, gap, labels: steps, states: automaton.len() });
        }
    }
    if found.is_empty() { Err(Unsolved::Infeasible) } else { Ok(found) }
}

/// Whether a run stays within the limit of the drift all along.
fn stays_in_band(problem: &Problem<'_>, sequence: &[usize]) -> bool {
    let rise = |pair: &[usize]| problem.steps[pair[0]].iter().find(|s| s.to == pair[1]).map_or(0, |s| s.rise);
    let mut drift = 0i32;
    sequence.windows(2).all(|pair| {
        drift = drift.saturating_add(rise(pair));
        drift.saturating_abs() <= problem.drift_limit
    })
}

/// The same for all rotations of a ring.
pub fn canonical(sequence: &[usize], shape: Shape) -> Vec<usize> {
    let rotated = |by: usize| [&sequence[by..], &sequence[..by]].concat();
    match shape {
        Shape::Open => sequence.to_vec(),
        Shape::Ring => (0..sequence.len()).map(rotated).min().unwrap_or_default(),
    }
}

/// A run in a listing.
struct Run {
    node: u32,
    length: u32,
    cost: Cost,
    parent: u32,
}

const NONE: u32 = u32::MAX;

/// A run by the cost of its best completion, and whether it stops here.
type Waiting = (Reverse<Cost>, Reverse<u32>, bool);

/// The sequences of one scope, cheapest first.
struct Listing {
    explored: Explored<(StateId, i32)>,
    table: Table<Cost>,
    runs: Vec<Run>,
    open: BinaryHeap<Waiting>,
}

impl Listing {
    /// `None` when it does not fit `table_bytes`; what its table may take of them is taken.
    fn new(
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: Scope,
        by_drift: bool,
        table_bytes: &mut usize,
    ) -> Option<Self> {
        let mut explored = triples(problem, automaton, &scope, by_drift, problem.share(NODE_LIMIT))?;
        let graph = std::mem::take(&mut explored.graph);
        let row = graph.len() * size_of::<Cost>();
        let (rows, widest) = (*problem.window.end() as usize + 1, graph.widest());
        // With all rows, or with as few as a table makes do with: a block, and what each block is made of.
        let (whole, least) = ((rows + 2 * widest) * row, 2 * ((rows * widest).isqrt() + widest) * row);
        let budget = whole.min(MOST_TABLE).min(*table_bytes);
        *table_bytes = table_bytes.checked_sub(budget.max(least.min(whole)))?;
        let table = Table::new(graph.into(), problem.window.clone(), budget, |toll| toll.cost);
        let mut list = Self { explored, table, runs: Vec::new(), open: BinaryHeap::new() };
        for &(piece, cost) in &scope.starts {
            let state = automaton.start(piece);
            if let Some(node) = state.and_then(|state| list.explored.node(piece, (state, 0))) {
                list.meet(Run { node: node as u32, length: problem.widths[piece], cost, parent: NONE });
            }
        }
        Some(list)
    }

    /// What the cheapest sequence that is still to come costs.
    fn estimate(&self) -> Cost {
        self.open.peek().map_or(NEVER, |(Reverse(estimate), ..)| *estimate)
    }

    fn meet(&mut self, run: Run) {
        self.table.load(run.length);
        let rest = self.table.at(run.length, run.node as usize);
        if rest != NEVER {
            self.open.push((Reverse(run.cost + rest), Reverse(self.runs.len() as u32), false));
            self.runs.push(run);
        }
    }

    /// Goes one step on; a sequence if one is complete.
    fn advance(&mut self, problem: &Problem<'_>) -> Option<(Cost, Vec<usize>)> {
        let (Reverse(cost), Reverse(at), is_stopped) = self.open.pop()?;
        if is_stopped {
            let mut sequence = Vec::new();
            let mut next = at;
            while let Some(run) = self.runs.get(next as usize) {
                sequence.push(self.explored.piece(run.node as usize));
                next = run.parent;
            }
            sequence.reverse();
            return Some((cost, sequence));
        }
        let Run { node, length, cost, .. } = self.runs[at as usize];
        self.table.load(length);
        let stopping = self.table.stopping(length, node as usize);
        if stopping != NEVER {
            self.open.push((Reverse(cost + stopping), Reverse(at), true));
        }
        for edge in self.table.graph().edges_of(node as usize) {
            let edge = self.table.graph().all_edges()[edge];
            if length + edge.width <= *problem.window.end() {
                self.meet(Run {
                    node: edge.to,
                    length: length + edge.width,
                    cost: cost + edge.cost,
                    parent: at,
                });
            }
        }
        None
    }
}
