//! The cheapest cycle of a graph for its length: what a long run costs for each bin, at a price of what it rises.
//!
//! Far from both ends, the cheapest runs go round the cycle that costs the least for each of its bins, so where this
//! begins to climb the other way is the price that the whole run has, but for what its ends rise. Howard's policy
//! iteration finds the cycle: each node follows one of its joins, the best cycle among those is found, and nodes
//! change to joins that lead to it more cheaply, until none does (Cochet-Terrasson et al. 1998, *Numerical computation
//! of spectral elements in max-plus algebra*). That takes some looks at each join, where a pass along the length takes as
//! many as the run has bins.
//!
//! Excluded: anything proven. A price that is not the best makes an estimate lower, never wrong.

use super::graph::{Edge, Graph, Toll};

/// Looks at all joins, at most, for one price.
const MOST_ROUNDS: usize = 64;
/// Millionths by which a join has to be cheaper to be followed.
const NOTABLE: f64 = 1e-3;

/// The joins that lie on runs and lead on for ever, and the one that each node follows.
pub(super) struct Cycles {
    /// Each with the node that it leaves.
    joins: Vec<(usize, Edge)>,
    /// By node, the join that is followed; [`NO_JOIN`] where no cycle can be reached.
    followed: Vec<usize>,
    /// By node, what it costs more to be there than elsewhere.
    values: Vec<f64>,
}

/// The node has no join.
const NO_JOIN: usize = usize::MAX;

/// What going round a cycle comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Round {
    pub(super) cost: f64,
    pub(super) rise: f64,
    /// In bins.
    pub(super) length: f64,
}

impl Cycles {
    /// The cycles of complete runs of `graph` that begin at one of the nodes `starts`; `None` when there are none, and
    /// where joins have to be completed in two ways at once.
    pub(super) fn new(graph: &Graph, starts: impl Iterator<Item = usize>) -> Option<Self> {
        if graph.all_edges().iter().any(|edge| edge.and_next) {
            return None;
        }
        let edges = |node: usize| &graph.all_edges()[graph.edges_of(node)];
        let mut is_met = vec![false; graph.len()];
        let mut open: Vec<usize> = starts.collect();
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut is_met[node], true) {
                open.extend(edges(node).iter().map(|edge| edge.to as usize));
            }
        }
        // What cannot be completed goes, and then what leads nowhere but to an end.
        let mut ends: Vec<bool> = (0..graph.len()).map(|node| graph.stop(node).is_some()).collect();
        spread(&mut ends, |ends, node| edges(node).iter().any(|edge| ends[edge.to as usize]));
        let mut is_gone: Vec<bool> = (0..graph.len()).map(|node| !is_met[node] || !ends[node]).collect();
        spread(&mut is_gone, |is_gone, node| edges(node).iter().all(|edge| is_gone[edge.to as usize]));
        let mut joins = Vec::new();
        let mut followed = vec![NO_JOIN; graph.len()];
        for node in (0..graph.len()).filter(|&node| !is_gone[node]) {
            followed[node] = joins.len();
            joins.extend(edges(node).iter().filter(|e| !is_gone[e.to as usize]).map(|&e| (node, e)));
        }
        let values = vec![0.0; graph.len()];
        (!joins.is_empty()).then_some(Self { joins, followed, values })
    }

    /// The cycle that costs the least for its length, when joins cost as `price` says.
    pub(super) fn cheapest(&mut self, price: impl Fn(Toll) -> i64) -> Option<Round> {
        let costs: Vec<f64> = self.joins.iter().map(|(_, edge)| price(edge.toll()) as f64).collect();
        let mut best = None;
        for _ in 0..MOST_ROUNDS {
            let (round, on_it) = self.best_followed(&costs)?;
            best = Some(round);
            let mean = round.cost / round.length;
            self.evaluate(&costs, mean, on_it);
            let mut is_better = false;
            for (at, ((from, edge), cost)) in self.joins.iter().zip(&costs).enumerate() {
                let value = self.values[edge.to as usize] + cost - mean * f64::from(edge.width);
                if value < self.values[*from] - NOTABLE {
                    (self.values[*from], self.followed[*from]) = (value, at);
                    is_better = true;
                }
            }
            if !is_better {
                break;
            }
        }
        best
    }

    /// Where a node leads to by the join that it follows.
    fn next(&self, node: usize) -> Option<usize> {
        self.joins.get(self.followed[node]).map(|(_, edge)| edge.to as usize)
    }

    /// The cheapest cycle of joins that are followed, and a node on it.
    fn best_followed(&self, costs: &[f64]) -> Option<(Round, usize)> {
        let mut walk_of = vec![NO_JOIN; self.followed.len()];
        let mut best: Option<(Round, usize)> = None;
        for first in (0..self.followed.len()).filter(|&node| self.followed[node] != NO_JOIN) {
            let mut node = first;
            while walk_of[node] == NO_JOIN {
                walk_of[node] = first;
                node = self.next(node)?;
            }
            if walk_of[node] != first {
                continue;
            }
            let (on_it, mut round) = (node, Round { cost: 0.0, rise: 0.0, length: 0.0 });
            loop {
                let at = self.followed[node];
                let (_, edge) = self.joins[at];
                round.cost += costs[at];
                round.rise += f64::from(edge.rise);
                round.length += f64::from(edge.width);
                node = edge.to as usize;
                if node == on_it {
                    break;
                }
            }
            if best.is_none_or(|(known, _)| round.cost * known.length < known.cost * round.length) {
                best = Some((round, on_it));
            }
        }
        best
    }

    /// What it costs to come to the node `on_it` by the joins that are followed, above the `mean` for each bin. Nodes
    /// that do not come there keep what they have.
    fn evaluate(&mut self, costs: &[f64], mean: f64, on_it: usize) {
        let mut is_known = vec![false; self.followed.len()];
        is_known[on_it] = true;
        let mut path = Vec::new();
        for first in (0..self.followed.len()).filter(|&node| self.followed[node] != NO_JOIN) {
            let mut node = first;
            while !std::mem::replace(&mut is_known[node], true) {
                path.push(node);
                node = self.joins[self.followed[node]].1.to as usize;
            }
            // A walk that came back to itself is on another cycle, where the value it met is an old one.
            for node in path.drain(..).rev() {
                let at = self.followed[node];
                let (_, edge) = self.joins[at];
                self.values[node] = self.values[edge.to as usize] + costs[at] - mean * f64::from(edge.width);
            }
        }
    }
}

/// Sets what `follows` from what is set, until nothing more does.
fn spread(set: &mut [bool], follows: impl Fn(&[bool], usize) -> bool) {
    let mut has_grown = true;
    while has_grown {
        has_grown = false;
        for node in (0..set.len()).rev() {
            if !set[node] && follows(set, node) {
                set[node] = true;
                has_grown = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Node 0 is where runs begin and node 3 where they end.
    fn graph(joins: &[Vec<(u32, u32, u64, i32)>]) -> Graph {
        let mut graph = Graph::new();
        for (node, joins) in joins.iter().enumerate() {
            for &(to, width, cost, rise) in joins {
                graph.add(Edge { cost, to, width, rise, count: 0, and_next: false });
            }
            graph.finish_node((node == 3).then_some(Toll::from(0)));
        }
        graph
    }

    fn cost(toll: Toll) -> i64 {
        toll.cost as i64
    }

    /// The least mean of the cycles that are on runs, from walks that come back to where they began.
    fn defined(joins: &[Vec<(u32, u32, u64, i32)>]) -> Option<f64> {
        let n = joins.len();
        let mut leads = vec![vec![false; n]; n];
        for (node, joins) in joins.iter().enumerate() {
            leads[node][node] = true;
            joins.iter().for_each(|&(to, ..)| leads[node][to as usize] = true);
        }
        for (by, from, to) in (0..n * n * n).map(|i| (i / n / n, i / n % n, i % n)) {
            leads[from][to] |= leads[from][by] && leads[by][to];
        }
        let mut least: Option<f64> = None;
        for first in (0..n).filter(|&first| leads[0][first] && leads[first][3]) {
            // By node and length, of walks of at most as many joins as a simple cycle has.
            let mut costs = vec![(first, 0u32, 0u64)];
            for _ in 0..n {
                let next = costs.iter().flat_map(|&(node, length, cost)| {
                    joins[node].iter().map(move |j| (j.0 as usize, length + j.1, cost + j.2))
                });
                costs = next.collect();
                costs.sort_unstable();
                costs.dedup_by_key(|&mut (node, length, _)| (node, length));
                for &(_, length, cost) in costs.iter().filter(|&&(node, ..)| node == first) {
                    let mean = cost as f64 / f64::from(length);
                    least = Some(least.map_or(mean, |known| known.min(mean)));
                }
            }
        }
        least
    }

    proptest! {
        #[test]
        fn no_cycle_is_cheaper(
            joins in prop::collection::vec(
                prop::collection::vec((0u32..5, 1u32..6, 0u64..50, -3i32..=3), 0..4), 5),
        ) {
            let found = Cycles::new(&graph(&joins), std::iter::once(0)).and_then(|mut c| c.cheapest(cost));
            let (found, wanted) = (found.map(|round| round.cost / round.length), defined(&joins));
            prop_assert_eq!(found.is_some(), wanted.is_some());
            prop_assert!(found.zip(wanted).is_none_or(|(a, b)| (a - b).abs() < 1e-2), "{found:?}, not {wanted:?}");
        }
    }

    // Going round at 1 climbs for nothing, at 2 it comes down at 10 for each of two bins; 4 cannot be completed.
    #[test]
    fn a_price_changes_the_cycle() {
        let joins = [
            vec![(1, 1, 0, 0), (2, 1, 0, 0), (4, 1, 0, 0)],
            vec![(1, 1, 0, 1), (3, 1, 0, 0)],
            vec![(2, 2, 20, -1), (3, 1, 0, 0)],
            vec![],
            vec![(4, 1, 0, -9)],
        ];
        let mut cycles = Cycles::new(&graph(&joins), std::iter::once(0)).unwrap();
        let at = |price: i64| move |toll: Toll| toll.cost as i64 + price * i64::from(toll.rise);
        assert_eq!(cycles.cheapest(at(0)), Some(Round { cost: 0.0, rise: 1.0, length: 1.0 }));
        assert_eq!(cycles.cheapest(at(6)), Some(Round { cost: 6.0, rise: 1.0, length: 1.0 }));
        assert_eq!(cycles.cheapest(at(7)), Some(Round { cost: 13.0, rise: -1.0, length: 2.0 }));
    }
}
