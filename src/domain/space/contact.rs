//! Whether far places of a thick band meet in space.
//!
//! The band is covered by boxes, one for each short step along the curve, and boxes that are no neighbours must be apart. A box is
//! as long as the step is on the inner side of the bend, so that neighbours of neighbours never overlap; what it leaves out on the outer
//! side is shorter than the band is thick, so that no band slips through another. Excluded: the pattern, which may leave room where two bands
//! meet; they are refused all the same.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::error::SpaceError;
use super::map::{LEAST_SCALE, SpaceMap};

/// Steps along the curve, as a part of the thickness. Longer, and one band could pass through another unseen.
const STEP_PART: f64 = 0.5;
/// The most boxes: a hundred metres of a band of 2 mm.
const MOST: usize = 100_000;

/// A box in space: its middle, its axes, which are unit vectors, and how far it reaches along each.
#[derive(Debug, Clone, Copy)]
struct Block {
    middle: DVec3,
    axes: [DVec3; 3],
    reach: [f64; 3],
}

impl Block {
    fn envelope(&self) -> AABB<[f64; 3]> {
        let half = (0..3).map(|i| self.axes[i].abs() * self.reach[i]).sum::<DVec3>();
        AABB::from_corners((self.middle - half).to_array(), (self.middle + half).to_array())
    }

    /// Whether two boxes have a point in common: none of the directions that could part them does.
    fn meets(&self, other: &Self) -> bool {
        let between = other.middle - self.middle;
        let parts = |axis: DVec3| {
            let reach =
                |block: &Self| (0..3).map(|i| block.axes[i].dot(axis).abs() * block.reach[i]).sum::<f64>();
            between.dot(axis).abs() > reach(self) + reach(other)
        };
        let crossed = (0..9).map(|k| self.axes[k / 3].cross(other.axes[k % 3]));
        let crossed = crossed.filter(|axis| axis.length_squared() > 1e-12);
        !self.axes.into_iter().chain(other.axes).chain(crossed).any(parts)
    }
}

/// The first place, in the order of the curve, at which the band comes within `gap_mm` of itself.
pub(super) fn first_contact(map: &SpaceMap, gap_mm: f64) -> Option<SpaceError> {
    let ([v0, v1], [w0, w1]) = (map.v_range_mm(), map.w_range_mm());
    let length = map.curve().length_mm();
    let n = ((length / (STEP_PART * (w1 - w0))).ceil() as usize).clamp(8, MOST);
    let step = length / n as f64;
    let place = |i: usize| (i as f64 + 0.5) * step;
    let block = |i: usize| {
        let frame = map.curve().frame(place(i));
        let [low, high] = map.heights_mm(place(i));
        let (w0, w1) = (w0 + low, w1 + high);
        let corners = [(v0, w0), (v0, w1), (v1, w0), (v1, w1)];
        let scale = corners.map(|(v, w)| map.scale_at(place(i), v, w)).into_iter().fold(1.0, f64::min);
        Block {
            middle: frame.point + frame.across * (0.5 * (v0 + v1)) + frame.out * (0.5 * (w0 + w1)),
            axes: [frame.along, frame.across, frame.out],
            reach: [0.5 * step * scale.max(0.0), 0.5 * (v1 - v0), 0.5 * (w1 - w0)]
                .map(|reach| reach + 0.5 * gap_mm),
        }
    };
    let blocks: Vec<Block> = (0..n).map(block).collect();
    // Boxes that are so near along the curve have ink between them and no gap: the inner side of a bend may be that much shorter.
    let near = 1 + (gap_mm / (LEAST_SCALE * step)).ceil() as usize;
    let entry = |(i, block): (usize, &Block)| {
        let envelope = block.envelope();
        GeomWithData::new(Rectangle::from_corners(envelope.lower(), envelope.upper()), i)
    };
    let tree = RTree::bulk_load(blocks.iter().enumerate().map(entry).collect());
    let is_neighbour = |i: usize, j: usize| {
        let apart = i.abs_diff(j);
        apart <= near || (map.curve().is_closed() && apart >= n - near)
    };
    (0..n).find_map(|i| {
        let near = tree.locate_in_envelope_intersecting(blocks[i].envelope()).map(|entry| entry.data);
        let met = near.filter(|&j| j > i && !is_neighbour(i, j) && blocks[i].meets(&blocks[j])).min()?;
        let position = blocks[i].middle.midpoint(blocks[met].middle);
        Some(SpaceError::Contact { position, at_mm: [place(i), place(met)], gap_mm })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(middle: [f64; 3], turn: f64) -> Block {
        let (sin, cos) = turn.sin_cos();
        let axes = [DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z];
        Block { middle: middle.into(), axes, reach: [2.0, 1.0, 0.5] }
    }

    #[test]
    fn boxes_meet_or_are_apart() {
        let one = block([0.0; 3], 0.0);
        assert!(one.meets(&block([3.9, 0.0, 0.0], 0.0)) && !one.meets(&block([4.1, 0.0, 0.0], 0.0)));
        assert!(one.meets(&block([0.0, 1.9, 0.9], 0.0)) && !one.meets(&block([0.0, 0.0, 1.1], 0.7)));
        // Their boxes along the axes overlap, they do not.
        assert!(!one.meets(&block([3.2, 1.9, 0.0], std::f64::consts::FRAC_PI_4 * 3.0)));
    }
}
