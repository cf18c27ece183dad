//! Motions that take the grid to itself: quarter turns, reflections, shifts. They are exact and undone exactly.

use super::grid::GridPoint;
use super::region::Region;

impl Region {
    /// The region turned by 90 degrees to the left about the origin: (x, y) goes to (−y, x).
    pub fn turned_left(&self) -> Self {
        self.rigidly_moved(|p| GridPoint::new(-p.y, p.x), false)
    }

    /// The region turned by 90 degrees to the right about the origin: (x, y) goes to (y, −x).
    pub fn turned_right(&self) -> Self {
        self.rigidly_moved(|p| GridPoint::new(p.y, -p.x), false)
    }

    /// The region with left and right exchanged: (x, y) goes to (−x, y).
    pub fn mirrored(&self) -> Self {
        self.rigidly_moved(|p| GridPoint::new(-p.x, p.y), true)
    }

    /// The region moved by `by` steps of its grid.
    pub fn shifted(&self, by: GridPoint) -> Self {
        self.rigidly_moved(|p| GridPoint::new(p.x + by.x, p.y + by.y), false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{self, FillRule};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn motions_are_valid_and_undone(
            boxes in prop::collection::vec((-50i64..50, -50i64..50, 1i64..30, 1i64..30), 1..8),
            by in (-100i64..100, -100i64..100),
        ) {
            let region = planar::boxes(1_000_000, FillRule::EvenOdd, &boxes);
            prop_assume!(!region.is_empty());
            let by = GridPoint::new(by.0, by.1);
            let back = GridPoint::new(-by.x, -by.y);
            for (moved, undone) in [
                (region.turned_left(), region.turned_left().turned_right()),
                (region.turned_right(), region.turned_right().turned_right().turned_right().turned_right()),
                (region.mirrored(), region.mirrored().mirrored()),
                (region.shifted(by), region.shifted(by).shifted(back)),
            ] {
                prop_assert_eq!(&undone, &region);
                let again = Region::from_contours(moved.grid(), moved.contours().cloned().collect());
                prop_assert_eq!(again.as_ref(), Ok(&moved));
                prop_assert_eq!((moved.components(), moved.holes()), (region.components(), region.holes()));
            }
        }
    }
}
