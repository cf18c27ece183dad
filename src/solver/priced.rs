//! The estimate that knows the drift: rising has a price.
//!
//! A run may end anywhere in the band, so what it still rises lies between two bounds that its drift gives. At a
//! price of μ for each unit of rise, the priced cost of a completion differs from its cost by μ times that rise:
//! the least priced cost, less the most that μ · rise can be, is an admissible estimate (Lagrangian relaxation of
//! the drift). A pass with prices takes as long as one without, where a pass over the nodes with all their drifts
//! takes as many times as long as there are drifts.
//!
//! The estimate at the start is concave in μ. Each pass gives its value and a tangent, and the next price is
//! where two tangents meet. Excluded: that the run stays in the band on its way, which the labels know.

use std::sync::Arc;

use super::graph::Graph;
use super::problem::{Cost, Problem};
use super::table::{NEVER, TABLE_BUDGET, Table, Weigh};

/// Additions in a pass: about a second. Beyond, costs are underestimated.
pub(super) const WORK_LIMIT: usize = 500_000_000;
/// Additions in a pass that looks for a price. Longer runs are judged by shorter ones.
const PRICING_WORK: usize = 2_000_000;
/// Passes that look for a price, at most.
const MOST_PASSES: usize = 8;
/// The highest price of a unit of rise, in millionths: of a band that can only climb.
const HIGHEST: i64 = 1_000_000_000;

/// The least cost of completing a run, by the length it has and the node where it ends.
pub(super) struct Passes {
    graph: Arc<Graph>,
    plain: Table<Cost>,
    priced: Option<Priced>,
}

/// A pass at a price.
struct Priced {
    /// μ, positive when rising is what should cost.
    price: i64,
    table: Table<i64>,
}

impl Passes {
    /// The pass over `graph` that does not know the drift; `None` when it would take too long to say anything.
    pub(super) fn new(problem: &Problem<'_>, graph: Graph) -> Option<Self> {
        let graph = Arc::new(graph);
        let plain = estimate(problem, &graph, problem.share(WORK_LIMIT), |cost, _| cost)?;
        Some(Self { graph, plain, priced: None })
    }

    /// Adds the pass that knows it, for runs that begin at `starts`: node, length and cost of each. Nothing is added
    /// where the cheapest runs end in the band anyway.
    pub(super) fn learn_prices(&mut self, problem: &Problem<'_>, starts: &[(usize, u32, Cost)]) {
        self.priced = price(problem, &self.graph, starts).and_then(|price| {
            let table = estimate(problem, &self.graph, problem.share(WORK_LIMIT), |cost, rise| {
                priced(price, cost, rise)
            })?;
            Some(Priced { price, table })
        });
    }

    /// Whether even the highest price does not keep the cheapest runs in the band.
    pub(super) fn only_leaves(&self) -> bool {
        self.priced.as_ref().is_some_and(|priced| priced.price.abs() >= HIGHEST)
    }

    /// Whether the pass that does not know the drift underestimates nothing.
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
        if let Some(priced) = &mut self.priced {
            priced.table.load(length);
        }
    }

    /// The estimate at a length that is loaded, for a run with this drift if it is known.
    pub(super) fn rest(&self, problem: &Problem<'_>, length: u32, node: usize, drift: Option<i32>) -> Cost {
        let plain = self.plain.at(length, node);
        let (Some(Priced { price, table }), Some(drift)) = (&self.priced, drift) else { return plain };
        let rest = table.at(length, node);
        if plain == NEVER || rest == i64::NONE {
            return NEVER;
        }
        let limit = i64::from(problem.drift_limit);
        let most = match *price >= 0 {
            true => price * (limit - i64::from(drift)),
            false => -price * (limit + i64::from(drift)),
        };
        plain.max(Cost::try_from(rest - most).unwrap_or(0))
    }
}

/// The pass over `graph` with so many additions at most, beyond which costs are underestimated; `None` when that
/// says nothing.
pub(super) fn estimate<W: Weigh>(
    problem: &Problem<'_>,
    graph: &Arc<Graph>,
    patience: usize,
    weigh: impl Fn(Cost, i32) -> W,
) -> Option<Table<W>> {
    Table::within(Arc::clone(graph), problem.window.clone(), problem.share(TABLE_BUDGET), patience, weigh)
}

/// The cost of a step with its rise paid for.
fn priced(price: i64, cost: Cost, rise: i32) -> i64 {
    i64::try_from(cost).unwrap_or(i64::MAX / 4) + price * i64::from(rise)
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

/// The least priced cost with the rise of a run that has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Sloped {
    cost: i64,
    rise: i64,
}

impl Weigh for Sloped {
    const NONE: Self = Self { cost: i64::MAX, rise: 0 };

    fn or(self, other: Self) -> Self {
        self.min(other)
    }

    fn after(self, step: Self) -> Self {
        match self == Self::NONE {
            true => self,
            false => Self { cost: self.cost.saturating_add(step.cost), rise: self.rise + step.rise },
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

/// The price with the greatest estimate for the cheapest run from `starts`; `None` when that is no price at all.
fn price(problem: &Problem<'_>, graph: &Arc<Graph>, starts: &[(usize, u32, Cost)]) -> Option<i64> {
    let longest = *problem.window.end();
    let part = (PRICING_WORK as f64 / graph.work(longest).max(1) as f64).min(1.0);
    // A shorter run may rise by as much less of the band, but by one unit at least.
    let shorter = |bins: u32| ((f64::from(bins) * part) as u32).max(bins.min(4 * graph.widest() as u32));
    let window = shorter(*problem.window.start())..=shorter(longest);
    let limit =
        (i64::from(problem.drift_limit) * i64::from(*window.end()) / i64::from(longest.max(1))).max(1);
    let bound = |price: i64| {
        let weigh = |cost, rise| Sloped { cost: priced(price, cost, rise), rise: i64::from(rise) };
        let mut table = Table::new(Arc::clone(graph), window.clone(), 0, weigh);
        let runs = starts.iter().map(|&(node, length, cost)| {
            table.load(length.min(*window.end()));
            table.at(length, node).after(weigh(cost, 0))
        });
        runs.fold(Sloped::NONE, Sloped::or)
    };
    let free = bound(0);
    if free == Sloped::NONE || free.rise.abs() <= limit {
        return None;
    }
    let side = free.rise.signum();
    let tangent = |at: i64| {
        let run = bound(side * at);
        Tangent { at, value: run.cost.saturating_sub(at * limit), slope: side * run.rise - limit }
    };
    let mut low = Tangent { at: 0, value: free.cost, slope: side * free.rise - limit };
    let mut at = (low.value / low.slope).clamp(1, HIGHEST);
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
            None if at >= HIGHEST => break,
            None => (4 * at).min(HIGHEST),
        };
    }
    let best = high.filter(|high| high.value > low.value).unwrap_or(low);
    (best.at > 0).then_some(side * best.at)
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
            passes.learn_prices(&problem, &[(0, 1, 0)]);
            for (length, row) in (0u32..).zip(completions(&problem)) {
                passes.load(length);
                for (piece, row) in row.iter().enumerate() {
                    for (drift, &cost) in (-LIMIT..).zip(row) {
                        prop_assert!(passes.rest(&problem, length, piece, Some(drift)) <= cost);
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
        passes.learn_prices(&problem, &[(0, 1, 0)]);
        passes.load(1);
        assert_eq!(passes.rest(&problem, 1, 0, None), 2);
        // 197 to 199 joins of piece 0, of which 97 or more have to come down.
        let least = passes.rest(&problem, 1, 0, Some(0));
        assert!((940..=980).contains(&least), "{least}");
    }
}
