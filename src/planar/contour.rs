//! One closed polygon of a region.

use super::grid::{Grid, GridPoint, orient};
use std::cmp::Ordering;

/// A closed polygon of at least three grid points, without repeated neighbours; the closing edge runs from
/// the last point to the first. Counter-clockwise around ink, clockwise around a hole.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Contour {
    points: Vec<GridPoint>,
}

impl Contour {
    /// A contour through `points`, with neighbours that coincide made one; `None` when fewer than three
    /// different points remain or the polygon encloses no area.
    ///
    /// The first point becomes the least one in (x, y) order, so that equal contours compare equal.
    pub fn new(mut points: Vec<GridPoint>) -> Option<Self> {
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() < 3 {
            return None;
        }
        let least = (0..points.len()).min_by_key(|&i| points[i])?;
        points.rotate_left(least);
        let contour = Self { points };
        (contour.doubled_area() != 0).then_some(contour)
    }

    /// The points, from the least one on.
    pub fn points(&self) -> &[GridPoint] {
        &self.points
    }

    /// The directed edges, the closing one last.
    pub fn edges(&self) -> impl Iterator<Item = (GridPoint, GridPoint)> + '_ {
        let n = self.points.len();
        (0..n).map(move |i| (self.points[i], self.points[(i + 1) % n]))
    }

    /// Twice the signed area in square steps, exact: positive for a counter-clockwise contour.
    pub fn doubled_area(&self) -> i128 {
        self.edges().map(|(a, b)| i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y)).sum()
    }

    /// The signed area in square millimetres.
    pub fn area_mm2(&self, grid: Grid) -> f64 {
        self.doubled_area() as f64 * 0.5 * grid.step_mm() * grid.step_mm()
    }

    /// Whether the contour runs counter-clockwise, around ink.
    pub fn is_counter_clockwise(&self) -> bool {
        self.doubled_area() > 0
    }

    /// Whether `p` lies strictly inside, exactly; points on the contour are not inside.
    pub fn contains(&self, p: GridPoint) -> bool {
        let mut inside = false;
        for (a, b) in self.edges() {
            let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
            let side = orient(low, high, p);
            if side == Ordering::Equal && p >= low.min(high) && p <= low.max(high) {
                return false;
            }
            // The half-open rule counts a ray through a vertex once.
            if low.y <= p.y && p.y < high.y && side == Ordering::Greater {
                inside = !inside;
            }
        }
        inside
    }

    /// The smallest and largest coordinates.
    pub fn bounds(&self) -> (GridPoint, GridPoint) {
        let mut low = self.points[0];
        let mut high = self.points[0];
        for p in &self.points {
            low = GridPoint::new(low.x.min(p.x), low.y.min(p.y));
            high = GridPoint::new(high.x.max(p.x), high.y.max(p.y));
        }
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contour(points: &[(i64, i64)]) -> Option<Contour> {
        Contour::new(points.iter().map(|&(x, y)| GridPoint::new(x, y)).collect())
    }

    #[test]
    fn starts_at_the_least_point_and_keeps_its_turn() {
        let c = contour(&[(4, 4), (0, 4), (0, 0), (4, 0), (4, 4)]).unwrap();
        assert_eq!(c.points()[0], GridPoint::new(0, 0));
        assert_eq!(c.doubled_area(), 32);
    }

    #[test]
    fn no_area_is_no_contour() {
        assert!(contour(&[(0, 0), (1, 1), (2, 2)]).is_none());
        assert!(contour(&[(0, 0), (0, 0), (1, 0)]).is_none());
    }

    #[test]
    fn contains_counts_vertices_once_and_edges_as_outside() {
        let c = contour(&[(0, 0), (4, 0), (4, 4), (2, 2), (0, 4)]).unwrap();
        assert!(c.contains(GridPoint::new(2, 1)));
        assert!(c.contains(GridPoint::new(1, 2)));
        assert!(!c.contains(GridPoint::new(2, 2)));
        assert!(!c.contains(GridPoint::new(2, 3)));
        assert!(!c.contains(GridPoint::new(-1, 0)));
        assert!(!c.contains(GridPoint::new(3, 0)));
    }
}
