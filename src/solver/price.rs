//! The price of a sum along a run: the one with the greatest estimate.
//!
//! The estimate at the start is concave in the price. Each pass gives its value and a tangent, and the next price is
//! where two tangents meet. Of a long run, the cheapest cycles tell the price of the rise without a pass
//! ([`super::cycles`]): what the ends add to them is little for each bin. Any price gives an estimate that is
//! admissible; a worse one gives a lower. Excluded: prices of two sums at once, which are found one after the other.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::cycles::{Cycles, Round};
use super::graph::{Edge, Graph, Toll};
use super::problem::{Cost, Problem};
use super::table::{Table, Weigh};

/// Additions in a pass that looks for a price. Longer runs are judged by shorter ones.
const PRICING_WORK: usize = 2_000_000;
/// Widths of the widest piece from which on a run is judged by its cycles, and joins up to which it is.
const LONG: usize = 16;
const MOST_JOINS: usize = 100_000;
/// The part of the estimate that another pass has to promise.
const NEAR: i64 = 256;
/// Prices that cycles are asked for, at most.
const MOST_PRICES: usize = 32;
/// Passes that look for a price, at most.
const MOST_PASSES: usize = 8;

/// Prices of a unit of rise and of what is counted, in millionths, positive when having more is what should cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Prices {
    pub(super) rise: i64,
    pub(super) count: i64,
}

impl Prices {
    /// The cost of what is added to a run, with its rise and its count paid for.
    pub(super) fn with_cost(self, toll: Toll) -> i64 {
        let cost = i64::try_from(toll.cost).unwrap_or(i64::MAX / 4);
        let of_rise = self.rise.saturating_mul(i64::from(toll.rise));
        cost.saturating_add(of_rise).saturating_add(self.count.saturating_mul(i64::from(toll.count)))
    }
}

/// The sum that is given a price, the bounds within which it has to end, and the highest price.
pub(super) enum Sum {
    /// The rise, at most so much up or down.
    Rise { most: i64, highest: i64 },
    /// What is counted.
    Count { between: RangeInclusive<i64>, highest: i64 },
}

impl Sum {
    fn of(&self, toll: Toll) -> i64 {
        match self {
            Self::Rise { .. } => i64::from(toll.rise),
            Self::Count { .. } => i64::from(toll.count),
        }
    }

    fn at(&self, price: i64, base: Prices) -> Prices {
        match self {
            Self::Rise { .. } => Prices { rise: price, ..base },
            Self::Count { .. } => Prices { count: price, ..base },
        }
    }

    /// The bounds, when only this part of the length is looked at: at least one unit of rise.
    fn bounds(&self, part: f64) -> (i64, i64) {
        match self {
            Self::Rise { most, .. } => {
                let most = ((*most as f64 * part) as i64).max(1);
                (-most, most)
            }
            Self::Count { between, .. } => (
                (*between.start() as f64 * part).floor() as i64,
                (*between.end() as f64 * part).ceil() as i64,
            ),
        }
    }
}

/// Where runs begin: a node, and the length, cost and count that they have there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) node: usize,
    pub(super) length: u32,
    pub(super) cost: Cost,
    pub(super) count: i64,
}

/// The least priced cost, and the sum of a run that has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sloped {
    cost: i64,
    sum: i64,
}

/// The estimate as a function of the price, as far as one pass tells: a line above it that touches it.
#[derive(Clone, Copy)]
struct Tangent {
    at: i64,
    value: i64,
    slope: i64,
}

impl Tangent {
    /// Where two tangents meet.
    fn meets(self, other: Self) -> Option<i64> {
        let (a, b) = (i128::from(self.slope), i128::from(other.slope));
        let zero = |t: Self| i128::from(t.value) - i128::from(t.slope) * i128::from(t.at);
        i64::try_from((zero(other) - zero(self)).checked_div(a - b)?).ok()
    }

    /// What the estimate is at most at a price.
    fn above(self, price: i64) -> i64 {
        self.value.saturating_add(self.slope.saturating_mul(price - self.at))
    }
}

/// The price of `sum` with the greatest estimate for the cheapest run from `starts`, beside the `base` prices of
/// others; `None` when that is no price at all.
pub(super) fn price(
    problem: &Problem<'_>,
    graph: &Arc<Graph>,
    starts: &[Start],
    base: Prices,
    sum: &Sum,
) -> Option<i64> {
    if let &Sum::Rise { most, highest } = sum
        && let Some(price) = of_cycles(problem, graph, starts, base, (most, highest))
    {
        return Some(price);
    }
    let longest = *problem.window.end();
    let part = (PRICING_WORK as f64 / graph.work(longest).max(1) as f64).min(1.0);
    // A shorter run may come to as much less.
    let shorter = |bins: u32| ((f64::from(bins) * part) as u32).max(bins.min(4 * graph.widest() as u32));
    let window = shorter(*problem.window.start())..=shorter(longest);
    let (low, high) = sum.bounds(f64::from(*window.end()) / f64::from(longest.max(1)));
    let bound = |price: i64| {
        let prices = sum.at(price, base);
        let mut table = Table::new(Arc::clone(graph), window.clone(), 0, |toll| prices.with_cost(toll));
        let runs = starts.iter().map(|&Start { node, length, cost, count }| {
            let length = length.min(*window.end());
            table.load(length);
            let toll = Toll { cost, rise: 0, count: i32::try_from(count).unwrap_or(0) };
            (table.at(length, node).after(prices.with_cost(toll)), length, node, toll)
        });
        let (cost, length, node, toll) =
            runs.min_by_key(|&(cost, ..)| cost).filter(|&(cost, ..)| cost != i64::NONE)?;
        Some(Sloped { cost, sum: sum.of(toll) + sum_of_run(&mut table, sum, length, node) })
    };
    let free = bound(0)?;
    let (side, limit) = match free.sum {
        sum if sum > high => (1, high),
        sum if sum < low => (-1, -low),
        _ => return None,
    };
    let tangent = |at: i64| {
        let Sloped { cost, sum } = bound(side * at)?;
        Some(Tangent { at, value: cost.saturating_sub(at.saturating_mul(limit)), slope: side * sum - limit })
    };
    let mut low = Tangent { at: 0, value: free.cost, slope: side * free.sum - limit };
    let (highest, growth) = match sum {
        Sum::Rise { highest, .. } => (*highest, 4),
        // The highest price tells at once whether there is a run at all.
        Sum::Count { highest, .. } => (*highest, *highest),
    };
    let mut at = (low.value / low.slope).clamp(1, highest);
    let mut high: Option<Tangent> = None;
    for _ in 0..MOST_PASSES {
        let next = tangent(at)?;
        match next.slope > 0 {
            true => low = next,
            false => high = Some(next),
        }
        at = match high {
            // The best is where neither is below the other.
            Some(high) => match low.meets(high) {
                Some(between)
                    if low.at < between
                        && between < high.at
                        && low.above(between) > best(low, high).value.saturating_add(low.value / NEAR) =>
                {
                    between
                }
                _ => break,
            },
            None if at >= highest => break,
            None => at.saturating_mul(growth).min(highest),
        };
    }
    let best = high.map_or(low, |high| best(low, high));
    (best.at > 0).then_some(side * best.at)
}

/// The price of the rise by the cheapest cycles; `None` when they say none, or the run is too short for them to say
/// much.
fn of_cycles(
    problem: &Problem<'_>,
    graph: &Graph,
    starts: &[Start],
    base: Prices,
    (most, highest): (i64, i64),
) -> Option<i64> {
    let longest = *problem.window.end();
    if (longest as usize) < LONG * graph.widest() || graph.work(1) > MOST_JOINS {
        return None;
    }
    let mut cycles = Cycles::new(graph, starts.iter().map(|start| start.node))?;
    let limit = most as f64 / f64::from(longest);
    let mut tangent = |side: i64, at: f64| {
        let prices = Prices { rise: side * at as i64, ..base };
        let Round { cost, rise, length } = cycles.cheapest(|toll| prices.with_cost(toll))?;
        Some(Mean { at, value: cost / length - at * limit, slope: side as f64 * rise / length - limit })
    };
    let up = tangent(1, 0.0)?;
    let (side, mut low) = match up.slope > 0.0 {
        true => (1, up),
        false => (-1, tangent(-1, 0.0).filter(|down| down.slope > 0.0)?),
    };
    let mut high: Option<Mean> = None;
    let highest = highest as f64;
    let mut at = (low.value / low.slope).clamp(1.0, highest).floor();
    for _ in 0..MOST_PRICES {
        let next = tangent(side, at)?;
        match next.slope > 0.0 {
            true => low = next,
            false => high = Some(next),
        }
        at = match high {
            Some(high) => match low.meets(high) {
                between if low.at < between && between < high.at => between,
                _ => break,
            },
            // All that goes on for ever climbs: whether anything stays in the band is for the passes to tell.
            None if at >= highest => return None,
            None => (at * 4.0).min(highest),
        };
    }
    let best = high.filter(|high| high.value > low.value).unwrap_or(low).at as i64;
    (best > 0).then_some(side * best)
}

/// A [`Tangent`] of the estimate for each bin of a run without ends.
#[derive(Clone, Copy)]
struct Mean {
    at: f64,
    value: f64,
    slope: f64,
}

impl Mean {
    /// Where two tangents meet, as a whole price.
    fn meets(self, other: Self) -> f64 {
        let zero = |t: Self| t.value - t.slope * t.at;
        ((zero(other) - zero(self)) / (self.slope - other.slope)).floor()
    }
}

/// The price with the greater estimate.
fn best(low: Tangent, high: Tangent) -> Tangent {
    if high.value > low.value { high } else { low }
}

/// What the cheapest run that goes on from `node` at `length` sums up to. Of joins that are completed in two ways at
/// once, the dearer counts.
fn sum_of_run(table: &mut Table<i64>, sum: &Sum, mut length: u32, mut node: usize) -> i64 {
    let mut total = 0;
    loop {
        table.load(length);
        let rest = table.at(length, node);
        let graph = table.graph();
        if let Some(toll) = graph.stop(node).filter(|_| table.stopping(length, node) == rest) {
            return total + sum.of(toll);
        }
        let mut dearest: Option<(i64, &Edge)> = None;
        let next = graph.edges_of(node).find_map(|at| {
            let edge = &graph.all_edges()[at];
            let here = table.at(length + edge.width, edge.to as usize);
            let pair = dearest.filter(|&(other, _)| other >= here).unwrap_or((here, edge));
            if edge.and_next {
                dearest = Some(pair);
                return None;
            }
            dearest = None;
            (pair.0.after(table.weight(at)) == rest).then_some(pair.1)
        });
        // Every finite entry was made by one of the joins.
        let Some(edge) = next else { return total };
        total += sum.of(edge.toll());
        (length, node) = (length + edge.width, edge.to as usize);
    }
}
