//! Union-find with an integer potential: how often a path winds around the seam of a ring.

/// Disjoint sets over 0..n. Each element has a potential relative to its root, so that adding a relation
/// that contradicts the potentials reveals a cycle that winds.
pub(super) struct UnionFind {
    parent: Vec<u32>,
    offset: Vec<i32>,
}

/// What adding a relation did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Joined {
    /// Two sets became one.
    Merged,
    /// The elements were in one set already; the new cycle's total potential.
    Cycle(i32),
}

impl UnionFind {
    pub(super) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), offset: vec![0; n] }
    }

    /// The root of `a`, and the potential of `a` relative to it.
    pub(super) fn find(&mut self, a: usize) -> (usize, i32) {
        let (mut root, mut total) = (a, 0);
        while self.parent[root] as usize != root {
            total += self.offset[root];
            root = self.parent[root] as usize;
        }
        let (mut node, mut left) = (a, total);
        while self.parent[node] as usize != root {
            let up = self.parent[node] as usize;
            let step = self.offset[node];
            self.parent[node] = root as u32;
            self.offset[node] = left;
            left -= step;
            node = up;
        }
        (root, total)
    }

    /// Records that `b` lies `winding` turns beyond `a`.
    pub(super) fn relate(&mut self, a: usize, b: usize, winding: i32) -> Joined {
        let ((root_a, pa), (root_b, pb)) = (self.find(a), self.find(b));
        if root_a == root_b {
            return Joined::Cycle(pa + winding - pb);
        }
        self.parent[root_b] = root_a as u32;
        self.offset[root_b] = pa + winding - pb;
        Joined::Merged
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_add_up() {
        let mut sets = UnionFind::new(4);
        assert_eq!(sets.relate(0, 1, 1), Joined::Merged);
        assert_eq!(sets.relate(2, 3, 0), Joined::Merged);
        assert_eq!(sets.relate(3, 1, 1), Joined::Merged);
        assert_eq!(sets.relate(0, 2, 0), Joined::Cycle(0));
        assert_eq!(sets.relate(3, 0, 1), Joined::Cycle(1));
        assert_eq!(sets.find(3).0, sets.find(0).0);
    }
}
