//! Where the rows of a pass begin to recur.
//!
//! A pass of least costs is linear over (min, +): a row with a constant more gives rows with a constant more. So once
//! as many rows as one is made of repeat earlier ones with a constant more, all that follow do. In a graph of which
//! all parts can reach each other that happens after finitely many rows, and the period is that of the cheapest
//! cycle (Baccelli, Cohen, Olsder and Quadrat 1992, *Synchronization and Linearity*, theorem 3.112).
//!
//! Rows are compared by a hash of what they have above their least entry. Excluded: the proof, which is the
//! comparison of the rows themselves.

use rustc_hash::{FxBuildHasher, FxHashMap};

use super::table::Weigh;

/// Rows in the order in which they are made.
pub(super) struct Recurrence {
    /// The number of the last row with this hash.
    last: FxHashMap<u64, usize>,
    /// The hash of each row, and its least entry, or that of the last row before it that has one.
    rows: Vec<(u64, i64)>,
    /// The period that the latest rows have, how many in a row have it, and what they cost more.
    period: usize,
    met: usize,
    more: i64,
    /// By entry of a row, what its cost is multiplied by in the hash: so no product waits for another.
    factors: Vec<u64>,
}

/// Rows for which there is room at first.
const ROWS: usize = 1 << 10;

impl Recurrence {
    /// No rows yet, of which there are `longest` at most, of so many `entries` each.
    pub(super) fn new(entries: usize, longest: usize) -> Self {
        /// The golden ratio, whose powers in whole numbers have nothing in common with sums of costs.
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        let next = |factor: &u64| Some(factor.wrapping_mul(GOLDEN));
        Self {
            last: FxHashMap::with_capacity_and_hasher(longest.min(ROWS), FxBuildHasher),
            rows: Vec::with_capacity(longest.min(ROWS)),
            period: 0,
            met: 0,
            more: 0,
            factors: std::iter::successors(Some(GOLDEN), next).take(entries).collect(),
        }
    }

    /// Takes up the next row. The period, once so many `wanted` rows in a row have one.
    pub(super) fn next<W: Weigh>(&mut self, row: &[W], wanted: usize) -> Option<usize> {
        let number = self.rows.len();
        let least = row.iter().filter_map(|weight| weight.as_cost()).min();
        let least = least.or(self.rows.last().map(|&(_, least)| least)).unwrap_or(0);
        let above = |weight: &W| weight.as_cost().map_or(-1, |cost| cost - least) as u64;
        let products =
            row.iter().zip(&self.factors).map(|(weight, factor)| above(weight).wrapping_mul(*factor));
        let hash = products.fold(0, u64::wrapping_add);
        self.rows.push((hash, least));
        let last = self.last.insert(hash, number);
        let goes_on = self.period > 0
            && number.checked_sub(self.period).is_some_and(|at| self.rows[at] == (hash, least - self.more));
        if goes_on {
            self.met += 1;
        } else if let Some(last) = last {
            // Simple rows look like others that are nearer than a period, so the present period is tried first.
            (self.period, self.met, self.more) = (number - last, 1, least - self.rows[last].1);
        } else {
            (self.period, self.met) = (0, 0);
        }
        (self.met >= wanted).then_some(self.period)
    }
}
