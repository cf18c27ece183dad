//! Assignment problems: who is matched with whom at the least price (Kuhn 1955), where everyone may stay single.
//!
//! Rows are few and know only some of the columns, so shortest augmenting paths over sparse rows (Jonker and Volgenant 1987) are enough. A
//! row that may stay single at a price (Tu 2020 Eq. 9, the part C_u) has a column of its own at that price.

/// A problem: prices of columns by rows.
#[derive(Debug, Clone, Default)]
pub struct Assignment {
    starts: Vec<usize>,
    entries: Vec<(u32, f64)>,
    single: Vec<f64>,
    columns: usize,
    // Of the solution; kept so that nothing is allocated twice.
    potentials: Vec<f64>,
    row_of: Vec<u32>,
    column_of: Vec<u32>,
    distance: Vec<f64>,
    from: Vec<u32>,
    is_done: Vec<bool>,
    touched: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Assignment {
    /// Begins a problem with so many columns.
    pub fn clear(&mut self, columns: usize) {
        self.starts.clear();
        self.starts.push(0);
        self.entries.clear();
        self.single.clear();
        self.columns = columns;
    }

    /// Adds an entry to the row that is being made.
    pub fn price(&mut self, column: usize, price: f64) {
        self.entries.push((column as u32, price));
    }

    /// Ends a row, which may stay single at this price; 0 or more, as all prices.
    pub fn end_row(&mut self, single: f64) {
        // A column of its own.
        self.entries.push(((self.columns + self.single.len()) as u32, single));
        self.single.push(single);
        self.starts.push(self.entries.len());
    }

    /// The sum of the least prices of the rows, which no solution can be below.
    pub fn bound(&self) -> f64 {
        let least = |row: &[usize]| {
            self.entries[row[0]..row[1]].iter().map(|entry| entry.1).fold(f64::INFINITY, f64::min)
        };
        self.starts.windows(2).map(least).sum()
    }

    /// The least sum of prices.
    pub fn solve(&mut self) -> f64 {
        let rows = self.single.len();
        let all = self.columns + rows;
        self.potentials.clear();
        self.potentials.resize(all, 0.0);
        self.row_of.clear();
        self.row_of.resize(all, NONE);
        self.column_of.clear();
        self.column_of.resize(rows, NONE);
        self.distance.clear();
        self.distance.resize(all, f64::INFINITY);
        self.from.clear();
        self.from.resize(all, NONE);
        self.is_done.clear();
        self.is_done.resize(all, false);
        for row in 0..rows {
            // Most rows get what they like best.
            let best = self.row(row).iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a });
            let (column, _) = best.expect("a row has its own column");
            if self.row_of[column as usize] == NONE {
                (self.row_of[column as usize], self.column_of[row]) = (row as u32, column);
            }
        }
        for row in 0..rows {
            if self.column_of[row] == NONE {
                self.augment(row);
            }
        }
        (0..rows).map(|row| self.price_of(row)).sum()
    }

    fn row(&self, row: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }

    fn price_of(&self, row: usize) -> f64 {
        let column = self.column_of[row];
        self.row(row).iter().find(|entry| entry.0 == column).expect("it was taken from the row").1
    }

    /// Gives the row a column along the shortest path of reduced prices (Dijkstra), moving others.
    fn augment(&mut self, first: usize) {
        self.touched.clear();
        let (mut row, mut base) = (first, 0.0);
        let end = loop {
            // The reduced price of the row's own place is that of its dual: its least reduced price if it is free.
            let own = match self.column_of[row] {
                NONE => 0.0,
                column => self.price_of(row) - self.potentials[column as usize],
            };
            for e in self.starts[row]..self.starts[row + 1] {
                let (column, price) = self.entries[e];
                let c = column as usize;
                let reach = base + price - self.potentials[c] - own;
                if !self.is_done[c] && reach < self.distance[c] {
                    if self.distance[c] == f64::INFINITY {
                        self.touched.push(column);
                    }
                    (self.distance[c], self.from[c]) = (reach, row as u32);
                }
            }
            let mut next: Option<(f64, u32)> = None;
            for &column in &self.touched {
                let d = self.distance[column as usize];
                if !self.is_done[column as usize]
                    && next.is_none_or(|(least, which)| (d, column) < (least, which))
                {
                    next = Some((d, column));
                }
            }
            let (d, column) = next.expect("a row can stay single");
            self.is_done[column as usize] = true;
            match self.row_of[column as usize] {
                NONE => break (d, column),
                taken => (row, base) = (taken as usize, d),
            }
        };
        let (length, mut column) = end;
        for &c in &self.touched {
            let c = c as usize;
            if self.is_done[c] {
                self.potentials[c] += self.distance[c] - length;
            }
            (self.distance[c], self.is_done[c]) = (f64::INFINITY, false);
        }
        loop {
            let row = self.from[column as usize];
            let before = std::mem::replace(&mut self.column_of[row as usize], column);
            self.row_of[column as usize] = row;
            if row as usize == first {
                break;
            }
            column = before;
        }
    }

    /// The column of a row in the solution; `None` if it stays single.
    pub fn column(&self, row: usize) -> Option<usize> {
        let column = self.column_of[row] as usize;
        (column < self.columns).then_some(column)
    }
}

#[cfg(test)]
mod tests {
    use pathfinding::kuhn_munkres::kuhn_munkres_min;
    use pathfinding::matrix::Matrix;
    use proptest::prelude::*;

    use super::*;

    /// Rows of prices by column, `None` where a row does not know the column; and what it costs each to stay single.
    type Problem = (Vec<Vec<Option<u32>>>, Vec<u32>);

    fn problems(rows: usize, columns: usize) -> impl Strategy<Value = Problem> {
        (1..=rows, 0..=columns).prop_flat_map(|(rows, columns)| {
            let row = prop::collection::vec(prop::option::weighted(0.7, 0u32..30), columns);
            (prop::collection::vec(row, rows), prop::collection::vec(0u32..40, rows))
        })
    }

    fn solved((prices, single): &Problem) -> (Assignment, f64) {
        let mut problem = Assignment::default();
        problem.clear(prices[0].len());
        for (row, &alone) in prices.iter().zip(single) {
            for (column, price) in row.iter().enumerate() {
                if let Some(price) = price {
                    problem.price(column, f64::from(*price));
                }
            }
            problem.end_row(f64::from(alone));
        }
        assert!(problem.bound() <= problem.clone().solve());
        let sum = problem.solve();
        (problem, sum)
    }

    /// The least sum of all ways.
    fn brute((prices, single): &Problem, row: usize, taken: u32) -> u32 {
        if row == prices.len() {
            return 0;
        }
        let alone = single[row] + brute(&(prices.clone(), single.clone()), row + 1, taken);
        let with = prices[row].iter().enumerate().filter(|(column, _)| taken & (1 << column) == 0);
        let with = with.filter_map(|(column, price)| {
            Some((*price)? + brute(&(prices.clone(), single.clone()), row + 1, taken | 1 << column))
        });
        with.chain([alone]).min().expect("a row can stay single")
    }

    proptest! {
        #[test]
        fn no_way_is_cheaper(problem in problems(5, 5)) {
            let (made, sum) = solved(&problem);
            prop_assert_eq!(sum, f64::from(brute(&problem, 0, 0)));
            let mut taken: Vec<usize> = (0..problem.0.len()).filter_map(|row| made.column(row)).collect();
            let count = taken.len();
            taken.sort_unstable();
            taken.dedup();
            prop_assert_eq!(taken.len(), count, "a column was given twice");
        }

        #[test]
        fn a_library_finds_nothing_cheaper(problem in problems(30, 40)) {
            let (_, sum) = solved(&problem);
            // In a full matrix every row has a column of its own, at the price of staying single.
            let (prices, single) = &problem;
            let matrix = Matrix::from_rows(prices.iter().enumerate().map(|(i, row)| {
                let known = row.iter().map(|price| price.map_or(100_000, i64::from));
                let own = (0..single.len()).map(move |j| if i == j { i64::from(single[i]) } else { 100_000 });
                known.chain(own).collect::<Vec<i64>>()
            })).expect("rows are as long");
            prop_assert_eq!(sum as i64, kuhn_munkres_min(&matrix).0);
        }
    }
}
