//! The price of a sum along a run: the one with the greatest estimate.
//!
//! The estimate at the start is concave in the price. Each pass gives its value and a tangent, and the next price is
//! where two tangents meet. Excluded: prices of two sums at once, which are found one after the other.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::graph::{Graph, Toll};
use super::problem::{Cost, Problem};
use super::table::{Table, Weigh};

/// Additions in a pass that looks for a price. Longer runs are judged by shorter ones.
const PRICING_WORK: usize = 2_000_000;
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
        cost + self.rise * i64::from(toll.rise) + self.count * i64::from(toll.count)
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

/// The least priced cost with the sum of a run that has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Sloped {
    cost: i64,
    sum: i64,
}

impl Weigh for Sloped {
    const NONE: Self = Self { cost: i64::MAX, sum: 0 };

    fn or(self, other: Self) -> Self {
        self.min(other)
    }

    fn after(self, step: Self) -> Self {
        match self == Self::NONE {
            true => self,
            false => Self { cost: self.cost.saturating_add(step.cost), sum: self.sum + step.sum },
        }
    }

    fn and(self, other: Self) -> Self {
        self.max(other)
    }
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
    let longest = *problem.window.end();
    let part = (PRICING_WORK as f64 / graph.work(longest).max(1) as f64).min(1.0);
    // A shorter run may come to as much less.
    let shorter = |bins: u32| ((f64::from(bins) * part) as u32).max(bins.min(4 * graph.widest() as u32));
    let window = shorter(*problem.window.start())..=shorter(longest);
    let (low, high) = sum.bounds(f64::from(*window.end()) / f64::from(longest.max(1)));
    let bound = |price: i64| {
        let prices = sum.at(price, base);
        let weigh = |toll: Toll| Sloped { cost: prices.with_cost(toll), sum: sum.of(toll) };
        let mut table = Table::new(Arc::clone(graph), window.clone(), 0, weigh);
        let runs = starts.iter().map(|&Start { node, length, cost, count }| {
            table.load(length.min(*window.end()));
            let count = i32::try_from(count).unwrap_or(0);
            table.at(length, node).after(weigh(Toll { cost, rise: 0, count }))
        });
        runs.fold(Sloped::NONE, Sloped::or)
    };
    let free = bound(0);
    let (side, limit) = match free.sum {
        _ if free == Sloped::NONE => return None,
        sum if sum > high => (1, high),
        sum if sum < low => (-1, -low),
        _ => return None,
    };
    let tangent = |at: i64| {
        let run = bound(side * at);
        Tangent {
            at,
            value: run.cost.saturating_sub(at.saturating_mul(limit)),
            slope: side * run.sum - limit,
        }
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
        let next = tangent(at);
        match next.slope > 0 {
            true => low = next,
            false => high = Some(next),
        }
        at = match high {
            // The best is where neither is below the other.
            Some(high) => match low.meets(high) {
                Some(between) if low.at < between && between < high.at => between,
                _ => break,
            },
            None if at >= highest => break,
            None => at.saturating_mul(growth).min(highest),
        };
    }
    let best = high.filter(|high| high.value > low.value).unwrap_or(low);
    (best.at > 0).then_some(side * best.at)
}
