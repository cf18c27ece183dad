//! Disjoint sets of numbers.

/// Disjoint sets of the numbers from 0; each is known by its least member, so that nothing depends on the order of
/// joins.
#[derive(Debug, Clone)]
pub struct Sets {
    parent: Vec<usize>,
}

impl Sets {
    /// `n` sets of one number each.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n).collect() }
    }

    /// The least member of the set that `i` is in.
    pub fn find(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Makes one set of the two that `i` and `j` are in.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.find(i), self.find(j));
        self.parent[i.max(j)] = i.min(j);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_joins_does_not_matter() {
        let joins = [(4, 2), (5, 1), (2, 5), (0, 3)];
        let found = |joins: &mut dyn Iterator<Item = (usize, usize)>| {
            let mut sets = Sets::new(7);
            joins.for_each(|(i, j)| sets.join(i, j));
            (0..7).map(|i| sets.find(i)).collect::<Vec<_>>()
        };
        assert_eq!(found(&mut joins.into_iter()), [0, 1, 1, 0, 1, 1, 6]);
        assert_eq!(found(&mut joins.into_iter().rev()), [0, 1, 1, 0, 1, 1, 6]);
    }
}
