//! Strokes: discs moved along a core.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::core::{Core, Node, radius};
use super::keep::Kept;
use crate::planar::{EdgeIndex, Grid, GridPoint};

/// The coarser grid of polygons, as a part of the chord and of the radius.
const COARSE: f64 = 0.1;
/// The most strokes that are made one.
const LONGEST: usize = 48;

/// A disc moved along a straight line, its radius changing evenly. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    pub(super) radii: [f64; 2],
}

impl Stroke {
    fn reach(&self) -> f64 {
        self.radii[0].max(self.radii[1])
    }

    fn envelope(&self, margin: f64) -> AABB<[f64; 2]> {
        let margin = DVec2::splat(self.reach() + margin);
        let (low, high) = (self.from.min(self.to) - margin, self.from.max(self.to) + margin);
        AABB::from_corners(low.to_array(), high.to_array())
    }

    /// A convex polygon around the stroke, counter-clockwise, at most about `chord_mm` from it.
    ///
    /// Its points are on a coarser grid: where strokes follow each other their sides all but coincide, and crossings
    /// that are rounded by as much as the sides are apart make ever more crossings.
    pub(super) fn polygon(&self, grid: Grid, chord_mm: f64) -> Vec<GridPoint> {
        let mut points = Vec::new();
        let least = self.radii[0].min(self.radii[1]).max(grid.step_mm());
        let quantum = grid.steps(COARSE * chord_mm.min(least)).max(1);
        let coarse = |mm: f64| (mm / grid.mm(quantum)).round() as i64 * quantum;
        for (centre, radius) in [(self.from, self.radii[0]), (self.to, self.radii[1])] {
            let n = corners(radius, chord_mm);
            let turn = std::f64::consts::TAU / n as f64;
            let around = radius / (0.5 * turn).cos();
            points.extend((0..n).map(|i| {
                let p = centre + around * DVec2::from_angle(i as f64 * turn);
                GridPoint::new(coarse(p.x), coarse(p.y))
            }));
        }
        hull(points)
    }
}

/// Corners of a polygon around a circle that leaves it by no more than `chord_mm`.
fn corners(radius: f64, chord_mm: f64) -> usize {
    let half_turn = (radius / (radius + chord_mm)).acos();
    ((std::f64::consts::PI / half_turn).ceil()).clamp(8.0, 256.0) as usize
}

/// The convex hull, counter-clockwise (Andrew's monotone chain), exact on the grid.
fn hull(mut points: Vec<GridPoint>) -> Vec<GridPoint> {
    points.sort_unstable();
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = GridPoint>| {
        let mut kept: Vec<GridPoint> = Vec::new();
        for p in points {
            while let [.., a, b] = kept[..]
                && crate::planar::orient(a, b, p).is_le()
            {
                kept.pop();
            }
            kept.push(p);
        }
        kept.pop();
        kept
    };
    let mut lower = chain(&mut points.iter().copied());
    lower.extend(chain(&mut points.iter().rev().copied()));
    lower
}

/// What is too narrow of the kept core: strokes of `wanted` radius along all of it that is narrower than `enough`.
pub(super) fn lacking(
    core: &Core,
    kept: &Kept,
    index: &EdgeIndex,
    [enough, wanted]: [f64; 2],
    spacing: f64,
) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let is_narrow = |node: &Node| node.radius < enough;
    let mut is_linked = vec![false; core.nodes.len()];
    let radii = [wanted; 2];
    for &[a, b] in core.links.iter().filter(|ends| ends.iter().all(|&end| kept.nodes[end])) {
        (is_linked[a], is_linked[b]) = (true, true);
        let ends = [core.nodes[a], core.nodes[b]];
        let [from, to] = ends.map(|node| node.at);
        match ends.each_ref().map(is_narrow) {
            [false, false] => {}
            [true, true] => strokes.push(Stroke { from, to, radii }),
            // From the narrow end on, as far as it is narrow.
            [first, _] => {
                let (from, to) = if first { (from, to) } else { (to, from) };
                let steps = (from.distance(to) / spacing).ceil().max(1.0);
                let reached = (1..=steps as usize)
                    .map(|i| from.lerp(to, i as f64 / steps))
                    .find(|&p| radius(index, p) >= enough);
                strokes.push(Stroke { from, to: reached.unwrap_or(to), radii });
            }
        }
    }
    let alone = (0..core.nodes.len()).filter(|&i| kept.nodes[i] && !is_linked[i]);
    strokes.extend(alone.map(|i| core.nodes[i]).filter(is_narrow).map(|node| Stroke {
        from: node.at,
        to: node.at,
        radii,
    }));
    strokes
}

/// What must not be taken from the kept core of the other side by strokes nearby: as much of it as there is, up to
/// the radius `most`.
pub(super) fn guards(core: &Core, kept: &Kept, most: f64, strokes: &[Stroke]) -> Vec<Stroke> {
    let boxes = strokes.iter().map(|stroke| {
        let envelope = stroke.envelope(most);
        GeomWithData::new(Rectangle::from_corners(envelope.lower(), envelope.upper()), ())
    });
    let near = RTree::bulk_load(boxes.collect());
    let guard = |ends: [usize; 2]| {
        let [from, to] = ends.map(|end| core.nodes[end]);
        Stroke { from: from.at, to: to.at, radii: [from.radius, to.radius].map(|radius| radius.min(most)) }
    };
    let links = core.links.iter().copied().filter(|ends| ends.iter().all(|&end| kept.nodes[end]));
    let mut is_linked = vec![false; core.nodes.len()];
    links.clone().flatten().for_each(|end| is_linked[end] = true);
    let alone = (0..core.nodes.len()).filter(|&i| kept.nodes[i] && !is_linked[i]).map(|i| [i, i]);
    links
        .chain(alone)
        .map(guard)
        .filter(|guard| near.locate_in_envelope_intersecting(guard.envelope(0.0)).next().is_some())
        .collect()
}

/// The same with strokes that follow each other made one, where that moves nothing by more than `slack_mm`.
pub(super) fn merged(strokes: &[Stroke], slack_mm: f64) -> Vec<Stroke> {
    let key = |p: DVec2| p.to_array().map(f64::to_bits);
    let mut at: FxHashMap<[u64; 2], Vec<usize>> = FxHashMap::default();
    for (i, stroke) in strokes.iter().enumerate().filter(|(_, stroke)| stroke.from != stroke.to) {
        for end in [stroke.from, stroke.to] {
            at.entry(key(end)).or_default().push(i);
        }
    }
    let is_joint = |p: DVec2| at.get(&key(p)).is_some_and(|of| of.len() == 2);
    let mut done = vec![false; strokes.len()];
    let mut merged = Vec::new();
    // From where chains end, and then around loops.
    let from_ends = (0..strokes.len()).map(|i| (i, false));
    for (i, is_loop) in from_ends.chain((0..strokes.len()).map(|i| (i, true))) {
        let stroke = strokes[i];
        let turned = Stroke { from: stroke.to, to: stroke.from, radii: [stroke.radii[1], stroke.radii[0]] };
        let start = match (is_joint(stroke.from), is_joint(stroke.to)) {
            _ if done[i] => continue,
            (true, true) if !is_loop => continue,
            (true, false) => turned,
            _ => stroke,
        };
        let mut chain = vec![(start.from, start.radii[0])];
        let (mut last, mut index) = (start, i);
        loop {
            done[index] = true;
            chain.push((last.to, last.radii[1]));
            let next = at.get(&key(last.to)).filter(|of| of.len() == 2);
            let Some(&other) = next.and_then(|of| of.iter().find(|&&other| !done[other])) else { break };
            let Stroke { from, to, radii } = strokes[other];
            last = if from == last.to {
                strokes[other]
            } else {
                Stroke { from: to, to: from, radii: [radii[1], radii[0]] }
            };
            index = other;
        }
        merged.extend(simplified(&chain, slack_mm));
    }
    merged
}

/// Strokes through the points of a chain, as few as can be for one that looks ahead only.
fn simplified(chain: &[(DVec2, f64)], slack_mm: f64) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let mut first = 0;
    while first + 1 < chain.len() {
        let (from, radius) = chain[first];
        let is_close = |end: usize| {
            let (to, end_radius) = chain[end];
            let ahead = to - from;
            chain[first + 1..end].iter().all(|&(p, r)| {
                let t = (p - from).dot(ahead) / ahead.length_squared();
                let off = p.distance(from + ahead * t) + (r - (radius + (end_radius - radius) * t)).abs();
                (0.0..=1.0).contains(&t) && off <= slack_mm
            })
        };
        let ends = first + 2..chain.len().min(first + LONGEST);
        let end = ends.take_while(|&end| is_close(end)).last().unwrap_or(first + 1);
        let (to, end_radius) = chain[end];
        strokes.push(Stroke { from, to, radii: [radius, end_radius] });
        first = end;
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_chains_become_one_stroke_and_corners_stay() {
        let radii = [0.5; 2];
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let line = |i: u8| Stroke { from: at(i.into(), 0.0), to: at(f64::from(i) + 1.0, 0.0), radii };
        // Out of order, and one turned round.
        let mut strokes: Vec<Stroke> = [2, 0, 3, 1].into_iter().map(line).collect();
        strokes[0] = Stroke { from: strokes[0].to, to: strokes[0].from, radii };
        strokes.push(Stroke { from: at(4.0, 0.0), to: at(4.0, 3.0), radii });
        let merged = merged(&strokes, 0.01);
        assert_eq!(merged.len(), 2);
        let mut corners: Vec<[i64; 2]> =
            merged.iter().flat_map(|s| [s.from, s.to]).map(|p| p.to_array().map(|x| x as i64)).collect();
        corners.sort_unstable();
        assert_eq!(corners, [[0, 0], [4, 0], [4, 0], [4, 3]]);
        // A loop has no end to begin at.
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        let ring: Vec<Stroke> =
            (0..4).map(|i| Stroke { from: square[i], to: square[(i + 1) % 4], radii }).collect();
        assert_eq!(super::merged(&ring, 0.01).len(), 4);
    }

    #[test]
    fn a_polygon_is_around_its_stroke_and_close_to_it() {
        let grid = Grid::for_extent(10.0).unwrap();
        let stroke = Stroke { from: DVec2::new(1.0, 2.0), to: DVec2::new(4.0, 2.5), radii: [0.5, 0.2] };
        let polygon: Vec<DVec2> = stroke.polygon(grid, 0.01).into_iter().map(|p| grid.to_mm(p)).collect();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let side = |c: DVec2| (q - p).perp_dot(c - p) / (q - p).length();
            assert!(side(stroke.from) > 0.5 - 2e-3 && side(stroke.to) > 0.2 - 2e-3, "{p} {q}");
            let near = (p.distance(stroke.from) - 0.5).min(p.distance(stroke.to) - 0.2);
            assert!(near < 0.012, "{p}");
        }
    }
}
