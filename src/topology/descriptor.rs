//! Descriptors and how they join.

use thiserror::Error;

use super::union_find::{Joined, UnionFind};

/// How a piece, or a run of pieces, connects its portals, and how much topology is closed inside it
/// (Zhou 2014 §3.4).
///
/// Labels are the components that reach a portal, renumbered by first occurrence along the left side from
/// top to bottom and then along the right side, so that equal topologies compare equal. Holes are not
/// stored: they are components − χ at any time.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Descriptor {
    left: Vec<u16>,
    right: Vec<u16>,
    closed: u32,
    euler: i64,
}

/// The topology of a shape without open portals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Topology {
    /// Connected components (b0).
    pub components: u32,
    /// Holes (b1). The inside of a closed ring counts as one.
    pub holes: u32,
    /// Whether some component winds all the way round.
    pub closed_pattern: bool,
}

/// Descriptors that do not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("{right} portals on a right side cannot be joined to {left} on a left side")]
pub struct DescriptorError {
    /// Portals on the right side of the first.
    pub right: usize,
    /// Portals on the left side of the second.
    pub left: usize,
}

impl Descriptor {
    /// A descriptor from component labels of any numbering, top to bottom; `closed` components that reach no
    /// portal; and the Euler characteristic of all of it.
    pub fn new(left: &[u32], right: &[u32], closed: u32, euler: i64) -> Self {
        let mut names: Vec<u32> = Vec::new();
        let mut renumber = |label: &u32| {
            let known = names.iter().position(|n| n == label);
            known.unwrap_or_else(|| {
                names.push(*label);
                names.len() - 1
            }) as u16
        };
        let left = left.iter().map(&mut renumber).collect();
        let right = right.iter().map(&mut renumber).collect();
        Self { left, right, closed, euler }
    }

    /// Component labels of the left portals, top to bottom.
    pub fn left(&self) -> &[u16] {
        &self.left
    }

    /// Component labels of the right portals, top to bottom.
    pub fn right(&self) -> &[u16] {
        &self.right
    }

    /// Components that reach no portal.
    pub fn closed(&self) -> u32 {
        self.closed
    }

    /// The Euler characteristic of all components together.
    pub fn euler(&self) -> i64 {
        self.euler
    }

    /// Components that reach a portal.
    pub fn open(&self) -> u32 {
        self.left.iter().chain(&self.right).max().map_or(0, |&l| u32::from(l) + 1)
    }

    /// Holes so far: components − χ. Joining never makes them fewer.
    pub fn holes(&self) -> u32 {
        (i64::from(self.closed + self.open()) - self.euler) as u32
    }

    /// The same portals, connected in the same way, with nothing closed and no holes.
    pub fn connections(&self) -> Self {
        Self { closed: 0, euler: i64::from(self.open()), ..self.clone() }
    }

    /// The run `self` followed by `next`, glued portal by portal.
    ///
    /// χ(A∪B) = χ(A) + χ(B) − m, as m segments of χ = 1 are shared; a component that is left without a
    /// portal is closed.
    ///
    /// # Errors
    /// [`DescriptorError`] when the numbers of portals differ.
    pub fn join(&self, next: &Self) -> Result<Self, DescriptorError> {
        if self.right.len() != next.left.len() {
            return Err(DescriptorError { right: self.right.len(), left: next.left.len() });
        }
        let (a, b) = (self.open() as usize, next.open() as usize);
        let mut sets = UnionFind::new(a + b);
        let mut components = a + b;
        for (&r, &l) in self.right.iter().zip(&next.left) {
            if sets.relate(usize::from(r), a + usize::from(l), 0) == Joined::Merged {
                components -= 1;
            }
        }
        let left: Vec<u32> = self.left.iter().map(|&l| sets.find(usize::from(l)).0 as u32).collect();
        let right: Vec<u32> = next.right.iter().map(|&r| sets.find(a + usize::from(r)).0 as u32).collect();
        let euler = self.euler + next.euler - self.right.len() as i64;
        let mut joined = Self::new(&left, &right, 0, euler);
        joined.closed = self.closed + next.closed + components as u32 - joined.open();
        Ok(joined)
    }

    /// The topology of a run without open portals; `None` if it has some.
    pub fn finished(&self) -> Option<Topology> {
        let done = self.left.is_empty() && self.right.is_empty();
        done.then(|| Topology { components: self.closed, holes: self.holes(), closed_pattern: false })
    }

    /// The topology of the ring made by gluing the right portals to the left ones.
    ///
    /// Whether the pattern is closed is decided by winding: crossing the seam adds one turn, and a cycle of
    /// components whose turns do not cancel goes all the way round (Zhou 2014 §3.6.3, Figure 6).
    ///
    /// # Errors
    /// [`DescriptorError`] when the numbers of portals differ.
    pub fn close(&self) -> Result<Topology, DescriptorError> {
        if self.right.len() != self.left.len() {
            return Err(DescriptorError { right: self.right.len(), left: self.left.len() });
        }
        let open = self.open() as usize;
        let mut sets = UnionFind::new(open);
        let mut components = i64::from(self.closed) + open as i64;
        let mut closed_pattern = false;
        for (&r, &l) in self.right.iter().zip(&self.left) {
            match sets.relate(usize::from(r), usize::from(l), 1) {
                Joined::Merged => components -= 1,
                Joined::Cycle(turns) => closed_pattern |= turns != 0,
            }
        }
        let euler = self.euler - self.right.len() as i64;
        Ok(Topology { components: components as u32, holes: (components - euler) as u32, closed_pattern })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strand() -> Descriptor {
        Descriptor::new(&[0], &[0], 0, 1)
    }

    #[test]
    fn figure_4_closes_a_component_and_a_hole() {
        // Zhou 2014 Figure 4: (a) four components, one ending and two starting inside; (b) two components, one
        // ending inside, joined at four portals.
        let a = Descriptor::new(&[0, 1], &[1, 2, 3, 3], 0, 4);
        let b = Descriptor::new(&[0, 1, 0, 0], &[0], 0, 2);
        let joined = a.join(&b).unwrap();
        assert_eq!((joined.left(), joined.right()), ([0, 1].as_slice(), [1].as_slice()));
        assert_eq!(joined.closed(), 1);
        assert_eq!(joined.holes(), 1);
    }

    #[test]
    fn a_strand_closed_on_itself_winds() {
        let ring = strand().close().unwrap();
        assert_eq!(ring, Topology { components: 1, holes: 1, closed_pattern: true });
    }

    #[test]
    fn strands_that_shift_by_one_wind_twice_as_one_component() {
        let crossed = Descriptor::new(&[0, 1], &[1, 0], 0, 2);
        let ring = crossed.close().unwrap();
        assert_eq!((ring.components, ring.closed_pattern), (1, true));
        // Figure 6, bottom: a component that turns back at both ends does not wind.
        let hooks = Descriptor::new(&[0, 0], &[1, 1], 0, 2);
        let ring = hooks.close().unwrap();
        assert_eq!(ring, Topology { components: 1, holes: 1, closed_pattern: false });
    }

    #[test]
    fn an_empty_cut_separates() {
        let begin_end = Descriptor::new(&[], &[], 1, 1);
        let two = begin_end.join(&begin_end).unwrap();
        assert_eq!(two.finished(), Some(Topology { components: 2, holes: 0, closed_pattern: false }));
        assert!(strand().join(&begin_end).is_err());
        assert_eq!(strand().finished(), None);
    }
}
