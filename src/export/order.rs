//! The order in which contours are cut: what lies inside first, and then the nearest.
//!
//! A part that is cut out drops, or shifts, and what is still to be cut inside of it comes out in the wrong place. So
//! contours go by their depth, the number of contours around them, the deepest first. Among those of one depth the
//! next is the one with the joint nearest to where the beam is, and it begins there; among arcs, at a joint that a line ends
//! in, so that it is met exactly. Excluded: the shortest way of all.

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::outline::{Outline, Segment};
use crate::planar::{Contour, Region};

/// The outlines in the order in which they are cut, from `at` on. `outlines` are those of the region's contours.
pub(super) fn ordered(region: &Region, outlines: Vec<Outline>, at: &mut DVec2) -> Vec<Outline> {
    let depths = depths(region);
    let mut left: Vec<Option<Outline>> = outlines.into_iter().map(Some).collect();
    let mut ordered = Vec::with_capacity(left.len());
    for depth in (0..=depths.iter().copied().max().unwrap_or(0)).rev() {
        let joints = |i: usize, outline: &Outline| {
            let entry = |(k, p): (usize, DVec2)| GeomWithData::new(p.to_array(), (i, k));
            outline
                .joints()
                .enumerate()
                .filter(|(k, _)| may_begin(outline, *k))
                .map(entry)
                .collect::<Vec<_>>()
        };
        let of_depth = left.iter().enumerate().filter(|(i, _)| depths[*i] == depth);
        let entries = of_depth.flat_map(|(i, outline)| outline.iter().flat_map(move |o| joints(i, o)));
        let mut tree = RTree::bulk_load(entries.collect());
        while let Some(&nearest) = tree.nearest_neighbor(at.to_array()) {
            let (i, first) = nearest.data;
            let outline = left[i].take().expect("a contour is cut once");
            for joint in joints(i, &outline) {
                tree.remove(&joint);
            }
            let outline = outline.beginning_with(first);
            *at = outline.start;
            ordered.push(outline);
        }
    }
    ordered
}

/// Whether the path may begin at joint `k`: anywhere, but where there are lines and arcs only behind a line.
fn may_begin(outline: &Outline, k: usize) -> bool {
    let n = outline.segments.len();
    let is_arc = |segment: &Segment| matches!(segment, Segment::Arc(..));
    !is_arc(&outline.segments[(k + n - 1) % n]) || outline.segments.iter().all(is_arc)
}

/// How many contours are around each.
fn depths(region: &Region) -> Vec<usize> {
    let contours: Vec<&Contour> = region.contours().collect();
    let boxes: Vec<_> = contours.iter().map(|c| c.bounds()).collect();
    let is_around = |outer: usize, inner: usize| {
        let ((low, high), p) = (boxes[outer], contours[inner].points()[0]);
        outer != inner
            && (low.x..=high.x).contains(&p.x)
            && (low.y..=high.y).contains(&p.y)
            && contours[outer].contains(p)
    };
    let around = |inner: usize| (0..contours.len()).filter(|&outer| is_around(outer, inner)).count();
    (0..contours.len()).map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::super::outlines::{Curves, outlines};
    use super::*;
    use crate::planar::{FillRule, boxes};

    #[test]
    fn inner_contours_come_first_and_then_the_nearest() {
        // A frame with a dot in it on the right, and two plates on the left, one with a hole.
        let region = boxes(
            1 << 26,
            FillRule::EvenOdd,
            &[
                (50, 0, 30, 30),
                (55, 5, 20, 20),
                (60, 10, 5, 5),
                (0, 0, 10, 10),
                (2, 2, 3, 3),
                (20, 0, 10, 10),
            ],
        );
        let outlines = outlines(&region, Curves::Polyline, 0.01);
        let mut beam = DVec2::ZERO;
        let ordered = ordered(&region, outlines, &mut beam);
        assert_eq!((ordered.len(), beam), (6, ordered[5].start));
        let sizes: Vec<f64> = ordered.iter().map(|o| o.length_mm(0.01) / 4.0).collect();
        let wanted = [5.0, 20.0, 3.0, 10.0, 10.0, 30.0];
        // The dot is deepest; from it the frame's hole is nearer than the plate's; then exteriors from left to right.
        let close = sizes.iter().zip(wanted).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-3);
        assert!(close, "{sizes:?}");
        assert!(ordered[2].start.distance(DVec2::new(5.0, 5.0)) < 1e-3, "it begins at the nearest corner");
    }
}
