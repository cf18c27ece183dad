//! The estimate that knows sums along a run: they have prices.
//!
//! A run may end anywhere in the band, so what it still rises lies between two bounds that its drift gives; so does
//! what it still counts, holes say, when a number of them is wanted. At a price of μ for each unit, the priced cost of
//! a completion differs from its cost by μ times that sum: the least priced cost, less the most that this can be, is an
//! admissible estimate (Lagrangian relaxation). A pass with prices takes as long as one without, where a pass over the
//! nodes with all their sums takes as many times as long as there are sums. The prices are found by [`super::price`].
//!
//! Excluded: that the run stays in the band on its way, which the labels know.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::graph::{Graph, Toll};
use super::price::{Prices, Start, Sum, price};
use super::problem::{Cost, Problem};
use super::table::{NEVER, TABLE_BUDGET, Table, Weigh};

/// Additions in a pass: about a second. Beyond, costs are underestimated.
pub(super) const WORK_LIMIT: usize = 500_000_000;
/// The highest price of a unit of rise, in millionths: of a band that can only climb.
const HIGHEST: i64 = 1_000_000_000;
/// The highest price of anything.
const HIGHEST_OF_ALL: Cost = 10_000_000_000_000;

/// The least cost of completing a run, by the length it has and the node where it ends.
pub(super) struct Passes {
    graph: Arc<Graph>,
    plain: Table<Cost>,
    /// The counts that complete runs may come to, where anything is counted.
    counts: Option<RangeInclusive<i64>>,
    /// With a price on what is counted, and with prices on that and the rise.
    counted: Option<Priced>,
    priced: Option<Priced>,
    /// No run costs more.
    dearest: Cost,
}

/// A pass with prices.
struct Priced {
    prices: Prices,
    table: Table<i64>,
}

impl Passes {
    /// The pass over `graph` that knows no sums; `None` when it would take too long to say anything.
    pub(super) fn new(problem: &Problem<'_>, graph: Graph) -> Option<Self> {
        let graph = Arc::new(graph);
        let plain = estimate(problem, &graph, problem.share(WORK_LIMIT), |toll| toll.cost)?;
        let dearest = dearest(problem, &graph);
        Some(Self { graph, plain, counts: None, counted: None, priced: None, dearest })
    }

    /// Adds the pass that knows what is counted, when complete runs from `starts` may come to `counts`. Nothing is
    /// added where the cheapest do anyway.
    pub(super) fn learn_counts(
        &mut self,
        problem: &Problem<'_>,
        starts: &[Start],
        counts: RangeInclusive<i64>,
    ) {
        // At this price one too many costs more than any run.
        let highest = self.dearest.saturating_add(1).min(HIGHEST_OF_ALL) as i64;
        let sum = Sum::Count { between: counts.clone(), highest };
        let price = price(problem, &self.graph, starts, Prices::default(), &sum);
        self.counted = price.and_then(|count| self.priced(problem, Prices { count, rise: 0 }));
        self.counts = Some(counts);
    }

    /// Adds the pass that knows the drift. Nothing is added where the cheapest runs end in the band anyway.
    pub(super) fn learn_drift(&mut self, problem: &Problem<'_>, starts: &[Start]) {
        let base = self.counted.as_ref().map_or_else(Prices::default, |priced| priced.prices);
        let sum = Sum::Rise { most: i64::from(problem.drift_limit), highest: HIGHEST };
        let price = price(problem, &self.graph, starts, base, &sum);
        self.priced = price.and_then(|rise| self.priced(problem, Prices { rise, ..base }));
    }

    fn priced(&self, problem: &Problem<'_>, prices: Prices) -> Option<Priced> {
        let table = estimate(problem, &self.graph, problem.share(WORK_LIMIT), |toll| prices.with_cost(toll))?;
        Some(Priced { prices, table })
    }

    /// Whether even the highest price does not keep the cheapest runs in the band.
    pub(super) fn only_leaves(&self) -> bool {
        self.priced.as_ref().is_some_and(|priced| priced.prices.rise.abs() >= HIGHEST)
    }

    /// Whether the pass that knows no sums underestimates nothing.
    pub(super) fn is_whole(&self) -> bool {
        !self.plain.is_cut_short()
    }

    /// The graph.
    pub(super) fn graph(&self) -> &Graph {
        &self.graph
    }

    /// Makes the rows of `length` and of what a step leads to available.
    pub(super) fn load(&mut self, length: u32) {
        self.plain.load(length);
        for priced in [&mut self.counted, &mut self.priced].into_iter().flatten() {
            priced.table.load(length);
        }
    }

    /// The estimate at a length that is loaded, for a run that has counted so much, with this drift if it is known.
    pub(super) fn rest(
        &self,
        problem: &Problem<'_>,
        length: u32,
        node: usize,
        count: i64,
        drift: Option<i32>,
    ) -> Cost {
        let mut rest = self.plain.at(length, node);
        let limit = i64::from(problem.drift_limit);
        for Priced { prices, table } in [&self.counted, &self.priced].into_iter().flatten() {
            if rest == NEVER {
                return NEVER;
            }
            if prices.rise != 0 && drift.is_none() {
                continue;
            }
            let priced = table.at(length, node);
            if priced == i64::NONE {
                return NEVER;
            }
            let drift = i64::from(drift.unwrap_or(0));
            let of_rise = most(prices.rise, -limit - drift, limit - drift);
            let of_count =
                self.counts.as_ref().map_or(0, |c| most(prices.count, c.start() - count, c.end() - count));
            let least = priced.saturating_sub(of_rise).saturating_sub(of_count);
            rest = rest.max(Cost::try_from(least).unwrap_or(0));
        }
        // What costs more than any run is none.
        if rest > self.dearest { NEVER } else { rest }
    }
}

/// The most that a sum between two bounds comes to at a price.
fn most(price: i64, low: i64, high: i64) -> i64 {
    price.saturating_mul(if price >= 0 { high } else { low })
}

/// More than which no run of `graph` costs.
fn dearest(problem: &Problem<'_>, graph: &Graph) -> Cost {
    let edges = graph.all_edges();
    let join = edges.iter().map(|e| e.cost).max().unwrap_or(0);
    let narrowest = edges.iter().map(|e| e.width).min().unwrap_or(1).max(1);
    let stop = (0..graph.len()).filter_map(|node| graph.stop(node)).map(|toll| toll.cost).max().unwrap_or(0);
    join.saturating_mul(u64::from(problem.window.end() / narrowest) + 1).saturating_add(stop)
}

/// The pass over `graph` with so many additions at most, beyond which costs are underestimated; `None` when that
/// says nothing.
pub(super) fn estimate<W: Weigh>(
    problem: &Problem<'_>,
    graph: &Arc<Graph>,
    patience: usize,
    weigh: impl Fn(Toll) -> W,
) -> Option<Table<W>> {
    Table::within(Arc::clone(graph), problem.window.clone(), problem.share(TABLE_BUDGET), patience, weigh)
}

#[cfg(test)]
mod tests {
    use super::super::graph::{Scope, of_pieces};
    use super::super::problem::Step;
    use super::*;
    use crate::topology::Shape;
    use proptest::prelude::*;

    const LIMIT: i32 = 3;

    /// Four pieces, of which the second may be stopped at.
    fn problem(steps: Vec<Vec<Step>>, end: u32) -> Problem<'static> {
        Problem {
            shape: Shape::Open,
            descriptors: &[],
            widths: vec![1, 2, 1, 3],
            steps,
            begin: vec![Some(0); 4],
            end: vec![None, Some(2), None, None],
            window: end.saturating_sub(2)..=end,
            drift_limit: LIMIT,
            variety: None,
            memory_limit: 1 << 30,
            effort_limit: usize::MAX,
        }
    }

    /// The least costs of completing runs that stay in the band, by length, piece and drift.
    fn completions(problem: &Problem<'_>) -> Vec<[[Cost; 2 * LIMIT as usize + 1]; 4]> {
        let end = *problem.window.end() as usize;
        let mut rows = vec![[[NEVER; 2 * LIMIT as usize + 1]; 4]; end + 1];
        for length in (0..=end).rev() {
            for piece in 0..4 {
                for drift in -LIMIT..=LIMIT {
                    let may_stop = problem.window.contains(&(length as u32));
                    let stop = problem.end[piece].filter(|_| may_stop).unwrap_or(NEVER);
                    let rests = problem.steps[piece].iter().map(|step| {
                        let row = rows.get(length + problem.widths[step.to] as usize);
                        let at = usize::try_from(drift + step.rise + LIMIT).ok();
                        let rest = row.zip(at).and_then(|(row, at)| row[step.to].get(at));
                        rest.map_or(NEVER, |rest| rest.saturating_add(step.cost))
                    });
                    rows[length][piece][(drift + LIMIT) as usize] = rests.fold(stop, Cost::min);
                }
            }
        }
        rows
    }

    proptest! {
        #[test]
        fn a_price_never_says_too_much(
            steps in prop::collection::vec(
                prop::collection::vec((0usize..4, 0u64..100, -3i32..=3), 1..5), 4),
            end in 6u32..40,
        ) {
            let steps = steps.iter().map(|steps| {
                steps.iter().map(|&(to, cost, rise)| Step { to, cost, rise }).collect()
            });
            let problem = problem(steps.collect(), end);
            let scope = Scope {
                starts: vec![(0, 0)],
                allowed: vec![true; 4],
                stop: problem.end.clone(),
            };
            let mut passes = Passes::new(&problem, of_pieces(&problem, &scope)).unwrap();
            passes.learn_drift(&problem, &[Start { node: 0, length: 1, cost: 0, count: 0 }]);
            for (length, row) in (0u32..).zip(completions(&problem)) {
                passes.load(length);
                for (piece, row) in row.iter().enumerate() {
                    for (drift, &cost) in (-LIMIT..).zip(row) {
                        prop_assert!(passes.rest(&problem, length, piece, 0, Some(drift)) <= cost);
                    }
                }
            }
        }
    }

    // Piece 0 climbs for nothing, or costs 10 to come down: in a band of 3, half of its joins cost.
    #[test]
    fn a_price_tells_what_staying_in_the_band_costs() {
        let join = |to, cost, rise| Step { to, cost, rise };
        let steps = vec![vec![join(0, 0, 1), join(0, 10, -1), join(1, 0, 0)], vec![], vec![], vec![]];
        let problem = problem(steps, 202);
        let scope = Scope { starts: vec![(0, 0)], allowed: vec![true; 4], stop: problem.end.clone() };
        let mut passes = Passes::new(&problem, of_pieces(&problem, &scope)).unwrap();
        passes.learn_drift(&problem, &[Start { node: 0, length: 1, cost: 0, count: 0 }]);
        passes.load(1);
        assert_eq!(passes.rest(&problem, 1, 0, 0, None), 2);
        // 197 to 199 joins of piece 0, of which 97 or more have to come down.
        let least = passes.rest(&problem, 1, 0, 0, Some(0));
        assert!((940..=980).contains(&least), "{least}");
    }
}
