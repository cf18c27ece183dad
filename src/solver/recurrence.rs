//! Where the rows of a pass begin to recur.
//!
//! A pass of least costs is linear over (min, +): a row with a constant more gives rows with a constant more. So once
//! as many rows as one is made of repeat earlier ones with a constant more, all that follow do. In a graph of which
//! all parts can reach each other that happens after finitely many rows, and the period is that of the cheapest
//! cycle (Baccelli, Cohen, Olsder and Quadrat 1992, *Synchronization and Linearity*, theorem 3.112).
//!
//! Rows are compared by a hash of what they have above their least entry. Excluded: the proof, which is the
//! comparison of the rows themselves.

use std::hash::Hasher;

use rustc_hash::{FxHashMap, FxHasher};

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
}

impl Recurrence {
    /// No rows yet.
    pub(super) fn new() -> Self {
        Self { last: FxHashMap::default(), rows: Vec::new(), period: 0, met: 0, more: 0 }
    }

    /// Takes up the next row. The period, once so many `wanted` rows in a row have one.
    pub(super) fn next<W: Weigh>(&mut self, row: &[W], wanted: usize) -> Option<usize> {
        let number = self.rows.len();
        let least = row.iter().filter_map(|weight| weight.as_cost()).min();
        let least = least.or(self.rows.last().map(|&(_, least)| least)).unwrap_or(0);
        let mut hasher = FxHasher::default();
        for weight in row {
            hasher.write_i64(weight.as_cost().map_or(-1, |cost| cost - least));
        }
        let hash = hasher.finish();
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
