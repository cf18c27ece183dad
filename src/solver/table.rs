//! Passes along the length: what completing a run amounts to, for every length and node of a graph.
//!
//! The same pass computes least costs, numbers of runs and sums of weights; [`Weigh`] says which. It goes from
//! the longest length down and needs only as many lengths at a time as the widest piece has bins. Where the
//! whole table would not fit its budget, a strip of that many lengths is kept at regular intervals, and the
//! rows between two strips are computed again when they are asked for. Walks that go upwards along the length
//! do that once, so time stays linear in the length and memory grows with the length only by the strips, of
//! which there are about as many as a strip of rows between them is long.

use std::ops::RangeInclusive;

use super::graph::Graph;
use super::problem::Cost;

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
}

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
}

/// The results of a pass.
pub(super) struct Table<W> {
    graph: Graph,
    /// By edge.
    weights: Vec<W>,
    /// By node.
    stops: Vec<W>,
    window: RangeInclusive<u32>,
    widest: usize,
    /// Lengths in a block, at least the widest.
    block: usize,
    /// The first rows of each block, as many as the widest piece has bins.
    strips: Vec<Vec<W>>,
    /// The rows of one block and the first ones of the next.
    rows: Vec<W>,
    /// The block that `rows` holds.
    loaded: usize,
}

impl<W: Weigh> Table<W> {
    /// The pass over `graph` for runs whose length is in `window`. Costs are turned into weights by `weigh`.
    /// Beyond `budget` bytes not all rows are kept.
    pub(super) fn new(
        graph: Graph,
        window: RangeInclusive<u32>,
        budget: usize,
        weigh: impl Fn(Cost) -> W,
    ) -> Self {
        let layers = *window.end() as usize + 1;
        let widest = graph.widest();
        let row = graph.len().max(1) * size_of::<W>();
        let block = match (layers + widest).saturating_mul(row) <= budget {
            true => layers.max(widest),
            false => widest.max((layers * widest).isqrt()),
        };
        let weights = graph.all_edges().iter().map(|e| weigh(e.cost)).collect();
        let stops = (0..graph.len()).map(|n| graph.stop(n).map_or(W::NONE, &weigh)).collect();
        let rows = vec![W::NONE; (block + widest) * graph.len()];
        let blocks = layers.div_ceil(block);
        let mut table =
            Self { graph, weights, stops, window, widest, block, strips: Vec::new(), rows, loaded: blocks };
        for at in (0..blocks).rev() {
            table.fill(at);
            if blocks > 1 {
                table.strips.push(table.rows[..table.widest * table.graph.len()].to_vec());
            }
        }
        table.strips.reverse();
        table
    }

    /// The bytes that a table over so many nodes takes at least, whatever its budget.
    pub(super) fn least_bytes(nodes: usize, widest: usize, longest: u32) -> usize {
        let block = widest.max((longest as usize * widest).isqrt());
        let strips = longest as usize / block + 2;
        (block + widest + strips * widest).saturating_mul(nodes).saturating_mul(size_of::<W>())
    }

    /// The memory that the rows take.
    pub(super) fn bytes(&self) -> usize {
        (self.rows.len() + self.strips.iter().map(Vec::len).sum::<usize>()) * size_of::<W>()
    }

    /// The graph.
    pub(super) fn graph(&self) -> &Graph {
        &self.graph
    }

    /// Makes the rows of `length` and the ones that a step can lead to available.
    pub(super) fn load(&mut self, length: u32) {
        let wanted = length as usize / self.block;
        if wanted != self.loaded && wanted * self.block <= *self.window.end() as usize {
            let n = self.graph.len();
            match self.strips.get(wanted + 1) {
                Some(strip) => {
                    let at = self.block * n;
                    self.rows[at..at + strip.len()].copy_from_slice(strip);
                }
                None => self.rows[self.block * n..].fill(W::NONE),
            }
            self.fill_block(wanted);
        }
    }

    /// What completing a run of `length` that ends at `node` amounts to. The length has to be loaded.
    pub(super) fn at(&self, length: u32, node: usize) -> W {
        let n = self.graph.len();
        match (length as usize).checked_sub(self.loaded * self.block) {
            Some(row) if length <= *self.window.end() => {
                self.rows.get(row * n + node).copied().unwrap_or(W::NONE)
            }
            _ => W::NONE,
        }
    }

    /// What stopping at `node` amounts to, at a length in the window.
    pub(super) fn stopping(&self, length: u32, node: usize) -> W {
        if self.window.contains(&length) { self.stops[node] } else { W::NONE }
    }

    /// What a join amounts to, without what follows.
    pub(super) fn weight(&self, edge: usize) -> W {
        self.weights[edge]
    }

    /// Moves from the block above, whose rows are there, to this one.
    fn fill(&mut self, block: usize) {
        let n = self.graph.len();
        let above = self.widest * n;
        self.rows.copy_within(..above, self.block * n);
        self.fill_block(block);
    }

    fn fill_block(&mut self, block: usize) {
        let n = self.graph.len();
        let edges = self.graph.all_edges();
        let longest = *self.window.end() as usize;
        for row in (0..self.block).rev() {
            let length = block * self.block + row;
            let (below, above) = self.rows.split_at_mut((row + 1) * n);
            let here = &mut below[row * n..];
            if length > longest {
                here.fill(W::NONE);
                continue;
            }
            let may_stop = self.window.contains(&(length as u32));
            for (node, value) in here.iter_mut().enumerate() {
                let mut sum = if may_stop { self.stops[node] } else { W::NONE };
                let range = self.graph.edges_of(node);
                let mut pending = None;
                for (edge, &weight) in edges[range.clone()].iter().zip(&self.weights[range]) {
                    let rest = above[(edge.width as usize - 1) * n + edge.to as usize];
                    let rest = match pending.take() {
                        None => rest,
                        Some(other) => rest.and(other),
                    };
                    if edge.and_next {
                        pending = Some(rest);
                    } else if rest != W::NONE {
                        sum = sum.or(rest.after(weight));
                    }
                }
                *value = sum;
            }
        }
        self.loaded = block;
    }
}

#[cfg(test)]
mod tests {
    use super::super::graph::Edge;
    use super::*;
    use proptest::prelude::*;

    fn graph(edges: &[Vec<(u32, u32, u64)>]) -> Graph {
        let mut graph = Graph::new();
        for (node, edges) in edges.iter().enumerate() {
            for &(to, width, cost) in edges {
                graph.add(Edge { cost, to: to % 4, width, and_next: false });
            }
            graph.finish_node((node == 2).then_some(3));
        }
        graph
    }

    proptest! {
        // A table that keeps strips answers as one that keeps all rows, in any order of questions.
        #[test]
        fn strips_change_nothing(
            edges in prop::collection::vec(prop::collection::vec((0u32..4, 1u32..6, 0u64..50), 0..5), 4),
            end in 1u32..300,
            questions in prop::collection::vec((0u32..300, 0usize..4), 1..20),
        ) {
            let window = end.saturating_sub(2)..=end;
            let mut whole = Table::new(graph(&edges), window.clone(), usize::MAX, |c| c);
            let mut strips = Table::new(graph(&edges), window, 0, |c| c);
            for (length, node) in questions {
                whole.load(length);
                strips.load(length);
                prop_assert_eq!(whole.at(length, node), strips.at(length, node));
            }
        }
    }
}
