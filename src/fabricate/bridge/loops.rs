//! Where a contour comes near to itself: a strut there closes a bay to a hole, a slit cuts a strand in two.

use glam::DVec2;

use super::ground::Side;
use super::place::{Place, Prober};
use crate::planar::IndexedEdge;

/// What is cut off must be larger than this, in squares of the width of a bridge: less is a notch.
const LEAST_AREA: f64 = 4.0;
/// A ray first looks this far, in widths, and then twice as far, and so on.
const LOOK: f64 = 2.0;
/// What a ray meets sooner than this, in widths, is where it begins.
const NOT_ITSELF: f64 = 1e-8;

impl Prober<'_> {
    /// Places for bridges of at most `reach_mm` from a contour to itself, the best first.
    pub(super) fn loops(&self, reach_mm: f64) -> Vec<Place> {
        let mut places = Vec::new();
        for (number, rim) in self.ground.rims.iter().enumerate() {
            let areas = Areas::new(&rim.points);
            let mut last = None;
            for (edge, &from) in rim.points.iter().enumerate() {
                let to = rim.points[(edge + 1) % rim.points.len()];
                for p in self.along(from, to) {
                    if self.is_beside(p, &mut last) {
                        continue;
                    }
                    let Some((q, other)) = self.opposite(p, to - from, reach_mm) else { continue };
                    if other.contour != number {
                        continue;
                    }
                    let cut = areas.cut((edge, p), (other.edge, q)).map(|area| match self.side {
                        Side::Gap => -area,
                        Side::Ink => area,
                    });
                    let least = cut.into_iter().filter(|&area| area > 0.0).fold(f64::INFINITY, f64::min);
                    let large = least.is_finite() && least > LEAST_AREA * self.width_mm * self.width_mm;
                    places.extend(if large { self.probe(p, q) } else { None });
                }
            }
        }
        self.ranked(places.into_iter(), usize::MAX)
    }

    /// What is seen from a point of a contour, at a right angle to it, on the side that is crossed.
    fn opposite(&self, p: DVec2, along: DVec2, reach_mm: f64) -> Option<(DVec2, IndexedEdge)> {
        let left = along.perp().normalize_or_zero();
        let ahead = if self.side == Side::Ink { left } else { -left };
        // Mostly what is seen is near, and all that lies in the box around a long ray is not worth a look.
        let mut from = 0.0;
        while from < reach_mm {
            let to = f64::max(2.0 * from, LOOK * self.width_mm).min(reach_mm);
            let [a, b] = [from, to].map(|t| p + ahead * t);
            let seen = self.index.in_box(a.min(b), a.max(b)).filter_map(|edge| {
                let (a, b) = (ahead.perp_dot(edge.from - p), ahead.perp_dot(edge.to - p));
                let t = ahead.dot(edge.from - p) + ahead.dot(edge.to - edge.from) * (a / (a - b));
                let is_hit = (a > 0.0) != (b > 0.0) && t > NOT_ITSELF * self.width_mm && t <= to;
                is_hit.then_some((t, edge))
            });
            let nearest = seen.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.edge.cmp(&b.1.edge)));
            if let Some((t, edge)) = nearest {
                return Some((p + ahead * t, *edge));
            }
            from = to;
        }
        None
    }
}

/// Areas under the beginnings of a contour, for the area of any stretch of it in one step.
struct Areas<'a> {
    points: &'a [DVec2],
    /// Twice the area between the origin and the edges before each vertex.
    before: Vec<f64>,
    whole: f64,
}

impl<'a> Areas<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let origin = points[0];
        let mut sum = 0.0;
        let mut before = Vec::with_capacity(points.len());
        for (i, &p) in points.iter().enumerate() {
            before.push(sum);
            sum += (p - origin).perp_dot(points[(i + 1) % points.len()] - origin);
        }
        Self { points, before, whole: sum }
    }

    /// The signed areas of the two polygons that the chord between two points on edges makes of the contour.
    fn cut(&self, a: (usize, DVec2), b: (usize, DVec2)) -> [f64; 2] {
        let origin = self.points[0];
        let until =
            |(edge, p): (usize, DVec2)| self.before[edge] + (self.points[edge] - origin).perp_dot(p - origin);
        let closing = (b.1 - origin).perp_dot(a.1 - origin);
        // Along the contour from a to b and back along the chord, wherever the contour begins.
        let mut first = until(b) - until(a) + closing;
        if (b.0, self.points[b.0].distance(b.1)) < (a.0, self.points[a.0].distance(a.1)) {
            first += self.whole;
        }
        [0.5 * first, 0.5 * (self.whole - first)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chord_cuts_a_contour_into_areas_that_add_up() {
        let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        let areas = Areas::new(&points);
        let (bottom, top) = ((0, DVec2::new(1.0, 0.0)), (2, DVec2::new(1.0, 2.0)));
        assert_eq!(areas.cut(bottom, top), [6.0, 2.0]);
        assert_eq!(areas.cut(top, bottom), [2.0, 6.0]);
    }
}
