//! Passes along the length: what completing a run amounts to, for every length and node of a graph.
//!
//! The same pass computes least costs, numbers of runs and sums of weights; [`Weigh`] says which. It goes from
//! the longest length down; the depth of a row is how far below that it lies. A row is made of those above it, as
//! many as the widest piece has bins, so where as many recur with a constant more, all rows below do, and none is
//! computed any more: far from the end, the cheapest runs go round the cheapest cycle ([`super::recurrence`]).
//!
//! Where the rows until then do not fit the budget, those that a block of rows is made of are kept, and the block
//! is computed again when it is asked for. Walks that go along the length do that once for each block, so time stays
//! linear in the length.

use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use super::graph::{Edge, Graph, Toll};
use super::problem::Cost;
use super::recurrence::Recurrence;

/// What a pass adds up.
pub(super) trait Weigh: Copy + PartialEq {
    /// Of no run at all.
    const NONE: Self;

    /// Of runs that are in `self` or in `other`.
    fn or(self, other: Self) -> Self;

    /// Of runs in `self`, each with `step` before it.
    fn after(self, step: Self) -> Self;

    /// Of one join that has to be completed in two ways at once.
    fn and(self, other: Self) -> Self;

    /// As a cost that adds up; `None` of no run, and of weights that are no costs, which never recur.
    fn as_cost(self) -> Option<i64> {
        None
    }

    /// The cost with so much more.
    fn shifted(self, _more: i64) -> Self {
        self
    }
}

/// Bytes of a table up to which all its rows are kept.
pub(super) const TABLE_BUDGET: usize = 128 << 20;
/// A cost that nothing reaches.
pub(super) const NEVER: Cost = Cost::MAX;

/// The least cost.
impl Weigh for Cost {
    const NONE: Self = NEVER;

    fn or(self, other: Self) -> Self {
        self.min(other)
    }

    fn after(self, step: Self) -> Self {
        self.saturating_add(step)
    }

    fn and(self, other: Self) -> Self {
        self.max(other)
    }

    fn as_cost(self) -> Option<i64> {
        i64::try_from(self).ok()
    }

    fn shifted(self, more: i64) -> Self {
        if self == NEVER { self } else { self.saturating_add_signed(more) }
    }
}

/// The least priced cost, which may be negative.
impl Weigh for i64 {
    const NONE: Self = i64::MAX;

    fn or(self, other: Self) -> Self {
        self.min(other)
    }

    fn after(self, step: Self) -> Self {
        if self == Self::NONE { self } else { self.saturating_add(step) }
    }

    fn and(self, other: Self) -> Self {
        self.max(other)
    }

    fn as_cost(self) -> Option<i64> {
        (self != Self::NONE).then_some(self)
    }

    fn shifted(self, more: i64) -> Self {
        self.after(more)
    }
}

/// The results of a pass.
pub(super) struct Table<W> {
    graph: Arc<Graph>,
    /// By edge.
    joins: Vec<Join<W>>,
    /// Whether some joins have to be completed in two ways at once.
    has_pairs: bool,
    /// By node.
    stops: Vec<W>,
    window: RangeInclusive<u32>,
    widest: usize,
    /// Rows in a block.
    block: usize,
    /// For each block the rows that it is made of, as many as the widest piece has bins.
    strips: Vec<Vec<W>>,
    /// The strip of a block, and the block.
    rows: Vec<W>,
    /// The block that `rows` holds.
    loaded: usize,
    tail: Option<Tail<W>>,
    /// Whether patience ended before the rows recurred.
    is_cut_short: bool,
}

/// What a pass reads of an edge.
#[derive(Clone, Copy)]
struct Join<W> {
    weight: W,
    /// How far before a row the node lies that it leads to.
    back: u32,
}

/// Rows that recur.
struct Tail<W> {
    /// The depth of the first.
    from: usize,
    rows: Vec<W>,
    period: usize,
    /// What each recurrence costs more.
    excess: i64,
}

impl<W: Weigh> Table<W> {
    /// The pass over `graph` for runs whose length is in `window`. What joins and stopping add is
    /// turned into weights by `weigh`. Beyond `budget` bytes not all rows are kept.
    pub(super) fn new(
        graph: Arc<Graph>,
        window: RangeInclusive<u32>,
        budget: usize,
        weigh: impl Fn(Toll) -> W,
    ) -> Self {
        Self::within(graph, window, budget, usize::MAX, weigh).expect("patience does not end")
    }

    /// The same with so many additions at most: costs below the rows that this makes are underestimated, as if the
    /// least that they grew by there were all that they grow by. `None` when that says nothing.
    pub(super) fn within(
        graph: Arc<Graph>,
        window: RangeInclusive<u32>,
        budget: usize,
        patience: usize,
        weigh: impl Fn(Toll) -> W,
    ) -> Option<Self> {
        let layers = *window.end() as usize + 1;
        let widest = graph.widest();
        let n = graph.len();
        let affordable = (budget / (n.max(1) * size_of::<W>())).saturating_sub(widest);
        let block = affordable.max((layers * widest).isqrt()).max(widest).min(layers.max(widest));
        let join = |e: &Edge| Join { weight: weigh(e.toll()), back: e.width * n as u32 - e.to };
        let joins = graph.all_edges().iter().map(join).collect();
        let has_pairs = graph.all_edges().iter().any(|e| e.and_next);
        let stops = (0..n).map(|node| graph.stop(node).map_or(W::NONE, &weigh)).collect();
        let most_rows = (patience / graph.work(1).max(1)).max(1);
        let rows = vec![W::NONE; widest * n];
        let mut table = Self {
            graph,
            joins,
            has_pairs,
            stops,
            window,
            widest,
            block,
            strips: Vec::new(),
            rows,
            loaded: 0,
            tail: None,
            is_cut_short: false,
        };
        table.go_down(most_rows)?;
        Some(table)
    }

    /// Computes all rows, or as many as there are before they recur, or `most`.
    fn go_down(&mut self, most: usize) -> Option<()> {
        let n = self.graph.len();
        let longest = *self.window.end() as usize;
        // As long as runs may stop, costs do not grow.
        let first = longest - *self.window.start() as usize + 1;
        let mut recurrence = Recurrence::new(n, longest);
        for depth in 0..=longest {
            let row = depth % self.block;
            if row == 0 {
                if depth > 0 {
                    let at = self.block * n;
                    self.rows.copy_within(at..at + self.widest * n, 0);
                }
                self.loaded = depth / self.block;
                self.strips.push(self.rows[..self.widest * n].to_vec());
            }
            self.fill_row(row);
            if depth < first {
                continue;
            }
            let at = (self.widest + row) * n;
            let found = recurrence.next(&self.rows[at..at + n], self.widest);
            let found = found.and_then(|period| Some((period, self.excess(row, period, true)?)));
            let found = match found {
                None if depth >= most => {
                    self.is_cut_short = true;
                    let period = (row + 1).min(depth - first);
                    Some((period, self.excess(row, period, false)?))
                }
                found => found,
            };
            if let Some((period, excess)) = found {
                let rows = self.rows[at + n - period * n..at + n].to_vec();
                self.tail = Some(Tail { from: depth + 1 - period, rows, period, excess });
                break;
            }
        }
        Some(())
    }

    /// By what the rows down to `row` of the block, as many as the widest piece has bins, cost more than those a
    /// period above: all by the same if they have to be `equal`, else at least. `None` also when those are not there
    /// any more.
    fn excess(&self, row: usize, period: usize, equal: bool) -> Option<i64> {
        let n = self.graph.len();
        let end = (self.widest + row + 1) * n;
        let (low, high) = (end.checked_sub(self.widest * n)?, end.checked_sub((self.widest + period) * n)?);
        if period == 0 {
            return None;
        }
        let mut excess: Option<i64> = None;
        for (&here, &above) in self.rows[low..end].iter().zip(&self.rows[high..]) {
            let more = match (here.as_cost(), above.as_cost()) {
                (None, None) => continue,
                (None, Some(_)) if !equal => continue,
                (Some(here), Some(above)) => here - above,
                _ => return None,
            };
            if equal && excess.is_some_and(|known| known != more) {
                return None;
            }
            excess = Some(excess.map_or(more, |known| known.min(more)));
        }
        excess
    }

    /// The memory that the rows take.
    pub(super) fn bytes(&self) -> usize {
        let strips: usize = self.strips.iter().map(Vec::len).sum();
        let tail = self.tail.as_ref().map_or(0, |tail| tail.rows.len());
        (self.rows.len() + strips + tail) * size_of::<W>()
    }

    /// Whether costs are underestimated, as the pass was given up early.
    pub(super) fn is_cut_short(&self) -> bool {
        self.is_cut_short
    }

    /// The graph.
    pub(super) fn graph(&self) -> &Graph {
        &self.graph
    }

    /// Makes the rows of `length` and the ones that a step can lead to available.
    pub(super) fn load(&mut self, length: u32) {
        let Some(depth) = self.window.end().checked_sub(length) else { return };
        let depth = match &self.tail {
            // A step from a row that recurs may lead to the rows before.
            Some(tail) if depth as usize >= tail.from => match tail.from.checked_sub(1) {
                Some(last) if depth as usize <= last + self.widest => last,
                _ => return,
            },
            _ => depth as usize,
        };
        let wanted = depth / self.block;
        if wanted != self.loaded {
            let strip = &self.strips[wanted];
            self.rows[..strip.len()].copy_from_slice(strip);
            self.loaded = wanted;
            let end = self.tail.as_ref().map_or(*self.window.end() as usize + 1, |tail| tail.from);
            for row in 0..self.block.min(end - wanted * self.block) {
                self.fill_row(row);
            }
        }
    }

    /// What completing a run of `length` that ends at `node` amounts to. The length has to be loaded.
    pub(super) fn at(&self, length: u32, node: usize) -> W {
        let Some(depth) = self.window.end().checked_sub(length) else { return W::NONE };
        let (depth, n) = (depth as usize, self.graph.len());
        if let Some(tail) = self.tail.as_ref().filter(|tail| depth >= tail.from) {
            // Divisions of whole words would be most of the time.
            let (below, period) = ((depth - tail.from) as u32, tail.period as u32);
            let (times, row) = (below / period, (below % period) as usize);
            return tail.rows[row * n + node].shifted(tail.excess * i64::from(times));
        }
        let row = (depth + self.widest).checked_sub(self.loaded * self.block);
        row.and_then(|row| self.rows.get(row * n + node).copied()).unwrap_or(W::NONE)
    }

    /// What stopping at `node` amounts to, at a length in the window.
    pub(super) fn stopping(&self, length: u32, node: usize) -> W {
        if self.window.contains(&length) { self.stops[node] } else { W::NONE }
    }

    /// What a join amounts to, without what follows.
    pub(super) fn weight(&self, edge: usize) -> W {
        self.joins[edge].weight
    }

    /// Computes a row of the loaded block from those before it.
    fn fill_row(&mut self, row: usize) {
        let n = self.graph.len();
        let at = (self.widest + row) * n;
        if self.rows.len() < at + n {
            self.rows.resize(at + n, W::NONE);
        }
        let mut rows = std::mem::take(&mut self.rows);
        let (above, here) = rows.split_at_mut(at);
        let length = *self.window.end() as usize - (self.loaded * self.block + row);
        let may_stop = self.window.contains(&(length as u32));
        for (node, value) in here[..n].iter_mut().enumerate() {
            let stop = if may_stop { self.stops[node] } else { W::NONE };
            let edges = self.graph.edges_of(node);
            *value = match self.has_pairs {
                false => self.joins[edges]
                    .iter()
                    .fold(stop, |sum, join| sum.or(above[at - join.back as usize].after(join.weight))),
                true => self.sum_of_pairs(edges, stop, |edge| above[at - self.joins[edge].back as usize]),
            };
        }
        self.rows = rows;
    }

    /// The same where some joins are completed in two ways at once.
    fn sum_of_pairs(&self, edges: Range<usize>, stop: W, rest: impl Fn(usize) -> W) -> W {
        let mut sum = stop;
        let mut pending = None;
        for edge in edges {
            let rest = match pending.take() {
                None => rest(edge),
                Some(other) => rest(edge).and(other),
            };
            match self.graph.all_edges()[edge].and_next {
                true => pending = Some(rest),
                false => sum = sum.or(rest.after(self.joins[edge].weight)),
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn graph(edges: &[Vec<(u32, u32, u64)>]) -> Graph {
        let mut graph = Graph::new();
        for (node, edges) in edges.iter().enumerate() {
            for &(to, width, cost) in edges {
                graph.add(Edge { cost, to: to % 4, width, rise: 0, count: 0, and_next: false });
            }
            graph.finish_node((node == 2).then_some(Toll::from(3)));
        }
        graph
    }

    /// The same by its definition.
    fn defined(edges: &[Vec<(u32, u32, u64)>], window: &RangeInclusive<u32>) -> Vec<[Cost; 4]> {
        let mut rows = vec![[NEVER; 4]; *window.end() as usize + 1];
        for length in (0..=*window.end()).rev() {
            for (node, edges) in edges.iter().enumerate() {
                let stop = if node == 2 && window.contains(&length) { 3 } else { NEVER };
                let rests = edges.iter().map(|&(to, width, cost)| {
                    let row = rows.get((length + width) as usize);
                    row.map_or(NEVER, |row| row[to as usize % 4].saturating_add(cost))
                });
                rows[length as usize][node] = rests.fold(stop, Cost::min);
            }
        }
        rows
    }

    proptest! {
        // However few rows are kept, and wherever they recur, in any order of questions.
        #[test]
        fn a_table_answers_as_defined(
            edges in prop::collection::vec(prop::collection::vec((0u32..4, 1u32..6, 0u64..50), 0..5), 4),
            end in 1u32..600,
            slack in 0u32..20,
            questions in prop::collection::vec((0u32..600, 0usize..4), 1..20),
        ) {
            let window = end.saturating_sub(slack)..=end;
            let defined = defined(&edges, &window);
            let mut whole = Table::new(graph(&edges).into(), window.clone(), usize::MAX, |toll| toll.cost);
            let mut strips = Table::new(graph(&edges).into(), window, 0, |toll| toll.cost);
            for (length, node) in questions {
                whole.load(length);
                strips.load(length);
                let cost = defined.get(length as usize).map_or(NEVER, |row| row[node]);
                prop_assert_eq!(whole.at(length, node), cost);
                prop_assert_eq!(strips.at(length, node), cost);
            }
        }

        // A pass that is given up early never says too much.
        #[test]
        fn without_patience_costs_are_underestimated(
            edges in prop::collection::vec(prop::collection::vec((0u32..4, 1u32..6, 0u64..50), 1..5), 4),
            end in 60u32..400,
            slack in 0u32..20,
            patience in 0usize..2_000,
        ) {
            let window = end - slack..=end;
            let defined = defined(&edges, &window);
            let table = Table::within(graph(&edges).into(), window, usize::MAX, patience, |toll| toll.cost);
            if let Some(mut table) = table {
                for (length, row) in (0u32..).zip(&defined) {
                    table.load(length);
                    for (node, &cost) in row.iter().enumerate() {
                        prop_assert!(table.at(length, node) <= cost);
                    }
                }
            }
        }
    }

    // A cycle that costs 7 for every 3 bins: rows recur, and are not computed to the end.
    #[test]
    fn rows_that_recur_are_not_kept() {
        let edges = [vec![(1, 1, 2)], vec![(2, 2, 5)], vec![(0, 1, 0), (0, 3, 9)], vec![]];
        let mut table =
            Table::new(graph(&edges).into(), 1_000_000..=1_000_000, usize::MAX, |toll: Toll| toll.cost);
        assert!(table.bytes() < 10_000, "{}", table.bytes());
        table.load(0);
        // 250,000 rounds of four bins: 0 to 1 to 2 to 0, and the last ends at 2.
        assert_eq!(table.at(0, 2), 250_000 * 7 + 3);
    }
}
