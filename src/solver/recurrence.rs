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
    /// The least entry of each row.
    least: Vec<i64>,
    /// The period of the latest rows, how many in a row have it, and what they cost more.
    run: (usize, usize, i64),
}

impl Recurrence {
    /// No rows yet.
    pub(super) fn new() -> Self {
        Self { last: FxHashMap::default(), least: Vec::new(), run: (0, 0, 0) }
    }

    /// Takes up the next row. The period, once so many `wanted` rows in a row have one.
    pub(super) fn next<W: Weigh>(&mut self, row: &[W], wanted: usize) -> Option<usize> {
        let number = self.least.len();
        let Some(least) = row.iter().filter_map(|weight| weight.as_cost()).min() else {
            self.least.push(0);
            self.run = (0, 0, 0);
            return None;
        };
        let mut hasher = FxHasher::default();
        for weight in row {
            hasher.write_i64(weight.as_cost().map_or(-1, |cost| cost - least));
        }
        self.least.push(least);
        let before = self.last.insert(hasher.finish(), number);
        self.run = match before.map(|before| (number - before, least - self.least[before])) {
            Some((period, more)) if (period, more) == (self.run.0, self.run.2) => {
                (period, self.run.1 + 1, more)
            }
            Some((period, more)) => (period, 1, more),
            None => (0, 0, 0),
        };
        (self.run.1 >= wanted).then_some(self.run.0)
    }
}
