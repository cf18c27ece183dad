//! Where struts may be.

use std::cmp::Ordering;

use super::ground::nearest_step;
use crate::planar::{EdgeIndex, FillRule, GridPoint, IndexedEdge, Region, orient};

/// A region that struts stay in, with all of their width and the ends that are sunk.
pub(super) struct Fence<'a> {
    region: &'a Region,
    index: EdgeIndex,
}

impl<'a> Fence<'a> {
    pub(super) fn new(region: &'a Region) -> Self {
        Self { region, index: EdgeIndex::new(region) }
    }

    /// Whether all of a strut is inside, decided exactly; along the border it is. `corners` are counter-clockwise and convex.
    pub(super) fn holds(&self, corners: &[GridPoint]) -> bool {
        let grid = self.region.grid();
        let in_mm = || corners.iter().map(|&p| grid.to_mm(p));
        let Some((low, high)) = in_mm().map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
            return true;
        };
        let step = |p| nearest_step(grid, p);
        let meets = |edge: &IndexedEdge| !are_apart(corners, [step(edge.from), step(edge.to)]);
        let middle = step(in_mm().sum::<glam::DVec2>() / corners.len() as f64);
        !self.index.in_box(low, high).any(meets) && self.region.parts().iter().any(|part| part.covers(middle))
    }

    /// Whether all of an outline is inside.
    pub(super) fn covers(&self, path: &[GridPoint]) -> bool {
        Region::fill(self.region.grid(), &[path.to_vec()], FillRule::Positive).without(self.region).is_empty()
    }
}

/// Whether an edge does not meet the inside of a convex outline: one of the sides, or the edge, has them on different sides (the separating
/// axes of two convex shapes are normals of their sides).
fn are_apart(corners: &[GridPoint], [from, to]: [GridPoint; 2]) -> bool {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let is_beyond_a_side = sides
        .filter(|(a, b)| a != b)
        .any(|(&a, &b)| [from, to].iter().all(|&p| orient(a, b, p) != Ordering::Greater));
    let beside = |side: Ordering| corners.iter().all(|&p| orient(from, to, p) != side);
    is_beyond_a_side || beside(Ordering::Less) || beside(Ordering::Greater)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::planar::Grid;

    fn points(of: &[(i64, i64)]) -> Vec<GridPoint> {
        of.iter().map(|&(x, y)| GridPoint::new(x, y)).collect()
    }

    #[test]
    fn along_the_border_is_inside() {
        let grid = Grid::for_extent(100.0).unwrap();
        let outer = points(&[(0, 0), (1000, 0), (1000, 1000), (0, 1000)]);
        let slit = points(&[(400, 200), (400, 800), (410, 800), (410, 200)]);
        let region = Region::fill(grid, &[outer, slit], FillRule::Positive);
        let fence = Fence::new(&region);
        let holds = |of: [(i64, i64); 4]| fence.holds(&points(&of));
        assert!(holds([(0, 0), (400, 0), (400, 300), (0, 300)]));
        assert!(!holds([(0, 0), (401, 0), (401, 300), (0, 300)]));
        assert!(!holds([(390, 300), (420, 300), (420, 320), (390, 320)]));
        assert!(!holds([(402, 300), (408, 300), (408, 320), (402, 320)]));
        assert!(!holds([(-50, 900), (50, 900), (50, 950), (-50, 950)]));
        // The slit ends in it, and beside it.
        assert!(!holds([(300, 700), (500, 700), (500, 900), (300, 900)]));
        assert!(holds([(300, 800), (500, 800), (500, 900), (300, 900)]));
    }

    proptest! {
        #[test]
        fn what_it_holds_is_what_the_region_covers(
            hole in proptest::collection::vec((100i64..900, 100i64..900), 3),
            strut in ((0i64..1000, 0i64..1000), (-300i64..300, -300i64..300), 1i64..3),
        ) {
            let grid = Grid::for_extent(100.0).unwrap();
            let outer = points(&[(0, 0), (1000, 0), (1000, 1000), (0, 1000)]);
            let hole = Region::fill(grid, &[points(&hole)], FillRule::NonZero);
            let region = Region::fill(grid, &[outer], FillRule::Positive).without(&hole);
            let ((x, y), (u, v), part) = strut;
            // A rectangle with a right angle at its first corner.
            let corners = points(&[(x, y), (x + u, y + v), (x + u - v / part, y + v + u / part), (x - v / part, y + u / part)]);
            let fence = Fence::new(&region);
            // Without area it is no strut.
            prop_assume!(u.abs().max(v.abs()) > 20);
            // An overlay loses slivers of a step, which the predicates see.
            let step_mm = grid.mm(1);
            let roomier = region.offset(3.0 * step_mm, step_mm);
            prop_assert!(!fence.holds(&corners) || fence.covers(&corners), "{:?} {:?}", corners, region);
            prop_assert!(!fence.covers(&corners) || Fence::new(&roomier).holds(&corners), "{:?} {:?}", corners, region);
        }
    }
}
