//! How many ways there are to complete a run, for every length and drift: a pass that counts.
//!
//! Row d holds, for each node of a graph and each drift, in how many ways a run can go on for exactly d bins and stop.
//! Whatever the drift, the joins are the same, so a join is one sum of two vectors, shifted by its rise. What a window
//! of lengths has together is a sum over rows.
//!
//! Far from the end, rows grow by the same factor everywhere. Rows are sums of earlier ones, and sums keep order: where
//! as many rows as the widest piece has bins are each at least λ times the one before, in every entry, so are all that
//! follow; and the same with at most (Collatz 1942, Wielandt 1950). So once the least and the greatest factor agree, no
//! more rows are made, and where the patience ends before, the two factors still bound the number.
//!
//! Excluded: costs, which [`super::table`] adds up, and drawing.

use super::big::Big;
use super::table::Weigh;

/// A join, and to which node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    pub(super) to: u32,
    /// The width of the piece that is joined, in bins.
    pub(super) width: u32,
    /// By how much it raises the run, in units of drift.
    pub(super) rise: i32,
}

/// A graph whose paths are runs, without their costs.
#[derive(Debug, Clone, Default)]
pub(super) struct Links {
    /// By the node that they leave.
    pub(super) links: Vec<Vec<Link>>,
    /// Whether a run may stop at each node.
    pub(super) stops: Vec<bool>,
}

/// What is counted: runs from `starts`, nodes each with its length in bins, whose length is in `window` and whose drift
/// stays within `limit`.
pub(super) struct Runs<'r> {
    pub(super) starts: &'r [(u32, u32)],
    pub(super) window: std::ops::RangeInclusive<u32>,
    pub(super) limit: i32,
}

/// The natural logarithm of a number, from the least to the most that it can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub(super) least: f64,
    pub(super) most: f64,
}

/// How far apart the logarithms of the bounds may be at which rows are not made any more.
const TOLERANCE: f64 = 1e-4;
/// Drifts that a vector has room for, in which work is measured.
const LANES: usize = 65;

impl Links {
    /// Joins of all nodes.
    pub(super) fn len(&self) -> usize {
        self.links.iter().map(Vec::len).sum()
    }

    /// The memory that counting takes, in bytes, with drifts up to `limit`.
    pub(super) fn bytes(&self, limit: i32) -> usize {
        let widest = self.links.iter().flatten().map(|link| link.width as usize).max().unwrap_or(1);
        let lanes = 2 * limit.max(0) as usize + 1;
        (widest + 1).saturating_mul(self.stops.len()).saturating_mul(lanes * size_of::<f64>())
    }

    /// Without the joins to nodes from which no stop can be reached.
    pub(super) fn pruned(mut self) -> Self {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); self.stops.len()];
        for (node, links) in self.links.iter().enumerate() {
            links.iter().for_each(|link| before[link.to as usize].push(node as u32));
        }
        let mut is_live = self.stops.clone();
        let mut queue: Vec<u32> = (0u32..).zip(&is_live).filter(|&(_, &live)| live).map(|(n, _)| n).collect();
        while let Some(node) = queue.pop() {
            for &from in &before[node as usize] {
                if !std::mem::replace(&mut is_live[from as usize], true) {
                    queue.push(from);
                }
            }
        }
        self.links.iter_mut().for_each(|links| links.retain(|link| is_live[link.to as usize]));
        self
    }

    /// How many runs there are. `patience` is the work that may be done, a unit for each join of a row; what is done is
    /// taken from it.
    pub(super) fn count(&self, runs: &Runs<'_>, patience: &mut usize) -> Bounds {
        let longest = runs.starts.iter().filter_map(|&(_, width)| runs.window.end().checked_sub(width)).max();
        let Some(longest) = longest else { return Bounds::NONE };
        let mut rows = Rows::new(self, runs.limit, longest);
        let mut found = Big::ZERO;
        let work = (self.len() * rows.lanes).div_ceil(LANES).max(1);
        for depth in 0..=longest {
            rows.next();
            found = runs.at(depth).map(|node| rows.get(node)).fold(found, Weigh::or);
            *patience = patience.saturating_sub(work);
            let left = f64::from(longest - depth);
            let (least, most) = rows.factors();
            if most < least {
                // Rows without any entry.
                break;
            }
            if (most - least) * left <= TOLERANCE || *patience == 0 {
                let rest = |factor: f64| runs.beyond(depth, factor, |node| rows.get(node).ln());
                let sum = |factor| ln_sum([found.ln(), rest(factor)]);
                return Bounds { least: sum(least), most: sum(most) };
            }
        }
        Bounds { least: found.ln(), most: found.ln() }
    }
}

impl Bounds {
    /// Of no run.
    pub(super) const NONE: Self = Self { least: f64::NEG_INFINITY, most: f64::NEG_INFINITY };

    /// Of runs that are in either.
    pub(super) fn or(self, other: Self) -> Self {
        Self { least: ln_sum([self.least, other.least]), most: ln_sum([self.most, other.most]) }
    }
}

impl Runs<'_> {
    /// The starts whose runs of an accepted length go on for `depth` bins.
    fn at(&self, depth: u32) -> impl Iterator<Item = u32> {
        let accepted = move |&(_, width): &(u32, u32)| self.window.contains(&(width + depth));
        self.starts.iter().copied().filter(accepted).map(|(node, _)| node)
    }

    /// The logarithm of the number of runs that go on for longer than `depth`, where each row is the one before times
    /// exp(`factor`).
    fn beyond(&self, depth: u32, factor: f64, at_depth: impl Fn(u32) -> f64) -> f64 {
        if factor == f64::INFINITY {
            return factor;
        }
        let of_start = |&(node, width): &(u32, u32)| {
            let first = self.window.start().saturating_sub(width).max(depth + 1);
            let last = self.window.end().checked_sub(width).filter(|&last| last >= first);
            let here = at_depth(node);
            match last {
                Some(last) if here > f64::NEG_INFINITY => {
                    here + ln_powers(factor, first - depth, last - depth)
                }
                _ => f64::NEG_INFINITY,
            }
        };
        ln_sum(self.starts.iter().map(of_start))
    }
}

/// Rows, as many as the widest piece has bins and one more.
struct Rows<'g> {
    graph: &'g Links,
    /// Drifts from −`limit` to `limit`.
    limit: i32,
    lanes: usize,
    kept: usize,
    /// The number of rows that were made.
    made: usize,
    /// By row, node and drift, in units of two to the exponent.
    values: Vec<f64>,
    /// By row and node.
    exponents: Vec<i64>,
    /// Of the latest rows, the logarithms of the least and greatest factor to the row before.
    factors: Vec<(f64, f64)>,
}

impl<'g> Rows<'g> {
    fn new(graph: &'g Links, limit: i32, longest: u32) -> Self {
        let links = || graph.links.iter().flatten();
        let widest = links().map(|link| link.width as usize).max().unwrap_or(1);
        let narrowest = links().map(|link| link.width).min().unwrap_or(1).max(1);
        // No run drifts further.
        let steepest = links().map(|link| i64::from(link.rise).abs()).max().unwrap_or(0);
        let reached = steepest.saturating_mul(i64::from(longest / narrowest));
        let limit = i64::from(limit.max(0)).min(reached) as i32;
        let (lanes, kept, nodes) = (2 * limit as usize + 1, widest + 1, graph.stops.len());
        Self {
            graph,
            limit,
            lanes,
            kept,
            made: 0,
            values: vec![0.0; kept * nodes * lanes],
            exponents: vec![0; kept * nodes],
            factors: Vec::new(),
        }
    }

    /// Makes the next row.
    fn next(&mut self) {
        let nodes = self.graph.stops.len();
        let (row, lanes) = (self.made % self.kept, self.lanes);
        let mut here = vec![0.0; lanes];
        let mut factors = (f64::INFINITY, f64::NEG_INFINITY);
        for node in 0..nodes {
            here.fill(0.0);
            let exponent = self.sum(node, &mut here);
            if self.made > 0 {
                let place = (self.made - 1) % self.kept * nodes + node;
                let before = &self.values[place * lanes..][..lanes];
                self.exponents[row * nodes + node] = exponent;
                let more = (exponent - self.exponents[place]) as f64 * std::f64::consts::LN_2;
                let (least, most) = extremes(before, &here);
                factors = (factors.0.min(least.ln() + more), factors.1.max(most.ln() + more));
            }
            let place = row * nodes + node;
            self.exponents[place] = exponent;
            self.values[place * lanes..][..lanes].copy_from_slice(&here);
        }
        self.factors.push(factors);
        self.made += 1;
    }

    /// What completing runs that end at `node` comes to in the next row, and its exponent.
    fn sum(&self, node: usize, here: &mut [f64]) -> i64 {
        if self.made == 0 {
            here.fill(f64::from(u8::from(self.graph.stops[node])));
            return 0;
        }
        let (nodes, lanes) = (self.graph.stops.len(), self.lanes as i32);
        let links = &self.graph.links[node];
        let place = |link: &Link| {
            let row = self.made.checked_sub(link.width as usize)? % self.kept;
            Some(row * nodes + link.to as usize)
        };
        let exponent = links.iter().filter_map(place).map(|p| self.exponents[p]).max().unwrap_or(0);
        for link in links.iter().filter(|link| link.rise.abs() < lanes) {
            let Some(place) = place(link) else { continue };
            let apart = exponent - self.exponents[place];
            if apart > 1000 {
                continue;
            }
            let unit = 2f64.powi(-(apart as i32));
            let from = &self.values[place * self.lanes..][..self.lanes];
            let rise = link.rise.unsigned_abs() as usize;
            // A run that drifts by `rise` more leaves the band at one end.
            let shared = self.lanes - rise;
            let (to, from) = match link.rise >= 0 {
                true => (&mut here[..shared], &from[rise..]),
                false => (&mut here[rise..], &from[..shared]),
            };
            to.iter_mut().zip(from).for_each(|(to, &from)| *to += from * unit);
        }
        normalized(here, exponent)
    }

    /// In how many ways a run that ends at `node` without drift can go on for as many bins as the latest row has.
    fn get(&self, node: u32) -> Big {
        let place = (self.made - 1) % self.kept * self.graph.stops.len() + node as usize;
        Big::new(self.values[place * self.lanes + self.limit as usize], self.exponents[place])
    }

    /// The logarithms of the least and the greatest factor by which an entry of a further row grows.
    fn factors(&self) -> (f64, f64) {
        let block = self.kept - 1;
        // The first row has stops, and none before it.
        if self.made <= block {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let latest = &self.factors[self.made - block..];
        latest
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &(l, m)| (least.min(l), most.max(m)))
    }
}

/// The least and the greatest quotient of two vectors, entry by entry; what is 0 in both has none.
fn extremes(before: &[f64], here: &[f64]) -> (f64, f64) {
    before.iter().zip(here).fold((f64::INFINITY, 0.0f64), |(least, most), (&before, &here)| {
        let quotient = here / before;
        // Both comparisons are false where there is none.
        (if quotient < least { quotient } else { least }, if quotient > most { quotient } else { most })
    })
}

/// Scales a vector by a power of two when it has grown large or small; the exponent then.
fn normalized(values: &mut [f64], exponent: i64) -> i64 {
    const LARGE: f64 = 1.2676506002282294e30;
    let most = values.iter().copied().fold(0.0, f64::max);
    if most == 0.0 || (1.0 / LARGE..LARGE).contains(&most) {
        return exponent;
    }
    let power = most.log2().floor() as i32;
    let unit = 2f64.powi(-power);
    values.iter_mut().for_each(|value| *value *= unit);
    exponent + i64::from(power)
}

/// ln Σ exp.
pub(super) fn ln_sum(logarithms: impl IntoIterator<Item = f64>) -> f64 {
    logarithms.into_iter().fold(f64::NEG_INFINITY, |sum, ln| {
        let (large, small) = (sum.max(ln), sum.min(ln));
        if small == f64::NEG_INFINITY || large == f64::INFINITY {
            large
        } else {
            large + (small - large).exp().ln_1p()
        }
    })
}

/// ln Σ exp(k·`factor`) over k from `first` to `last`.
fn ln_powers(factor: f64, first: u32, last: u32) -> f64 {
    if !factor.is_finite() {
        return factor;
    }
    let (count, greatest) = (f64::from(last - first + 1), if factor > 0.0 { last } else { first });
    let ratio = -factor.abs();
    let sum = if ratio > -1e-12 { count } else { (count * ratio).exp_m1() / ratio.exp_m1() };
    f64::from(greatest) * factor + sum.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn graph(joins: &[Vec<(u32, u32, i32)>]) -> Links {
        let link = |&(to, width, rise): &(u32, u32, i32)| Link { to, width, rise };
        let links = joins.iter().map(|joins| joins.iter().map(link).collect()).collect();
        Links { links, stops: (0..joins.len()).map(|node| node == 2).collect() }
    }

    /// The same by its definition, in whole numbers.
    fn defined(joins: &[Vec<(u32, u32, i32)>], window: (u32, u32), limit: i32) -> u128 {
        let lanes = (2 * limit + 1) as usize;
        let mut rows = vec![vec![vec![0u128; lanes]; joins.len()]; window.1 as usize + 1];
        for length in (1..=window.1).rev() {
            for (node, joins) in joins.iter().enumerate() {
                for drift in -limit..=limit {
                    let stop = u128::from(node == 2 && length >= window.0);
                    let rests =
                        joins.iter().filter(|join| (drift + join.2).abs() <= limit).filter_map(|join| {
                            let row = rows.get((length + join.1) as usize)?;
                            Some(row[join.0 as usize][(drift + join.2 + limit) as usize])
                        });
                    rows[length as usize][node][(drift + limit) as usize] = stop + rests.sum::<u128>();
                }
            }
        }
        rows[1][0][limit as usize]
    }

    proptest! {
        // Enough patience gives the number, and any gives bounds of it.
        #[test]
        fn runs_are_counted_as_defined(
            joins in prop::collection::vec(prop::collection::vec((0u32..4, 1u32..5, -2i32..=2), 0..4), 4),
            end in 1u32..90,
            slack in 0u32..9,
            limit in 0i32..5,
            patience in 0usize..3_000,
        ) {
            let start = end.saturating_sub(slack).max(1);
            let number = defined(&joins, (start, end), limit) as f64;
            let runs = Runs { starts: &[(0, 1)], window: start..=end, limit };
            let graph = graph(&joins).pruned();
            let Bounds { least, most } = graph.count(&runs, &mut usize::MAX.clone());
            prop_assert!(least <= number.ln() + 1e-9 && number.ln() <= most + 1e-9);
            prop_assert!(least == most || most - least < 1e-3, "{least} to {most}");
            let Bounds { least, most } = graph.count(&runs, &mut patience.clone());
            prop_assert!(least <= number.ln() + 1e-9 && number.ln() <= most + 1e-9, "{least} to {most}");
        }
    }

    // Widths of 1 and 2 make Fibonacci numbers, which grow by the golden ratio.
    #[test]
    fn rows_that_grow_by_the_same_factor_are_not_made() {
        let graph = graph(&[vec![(2, 1, 0)], vec![], vec![(2, 1, 0), (2, 2, 0)]]);
        let runs = Runs { starts: &[(0, 1)], window: 1_000_000..=1_000_000, limit: 32 };
        let mut patience = 1_000;
        let found = graph.count(&runs, &mut patience);
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        // F(n) = φ^n / √5, and after the first join 999 998 bins are left.
        let wanted = 999_999.0 * golden.ln() - 5f64.sqrt().ln();
        assert!((found.least - wanted).abs() < 1e-3 && (found.most - wanted).abs() < 1e-3, "{found:?}");
        assert!(patience > 500);
    }
}
