//! Where along two contours a bridge sits best.
//!
//! A craftsman puts a bridge where it is short, meets both sides squarely and has something to hold on to. So
//! places are taken all along the stretch where two contours are about as near as they ever are, and each is
//! probed by rays along the bridge, spread over its width: their mean length is the material it takes, their
//! spread says how far its ends are from square, and how far they run on says how much there is to hold on to.
//! Excluded: whether the counts come out right, which [`super::trial`] decides.

use glam::DVec2;

use super::ground::{Ground, Side};
use super::links::Link;
use crate::planar::EdgeIndex;

/// Rays on either side of the middle one, over the width of a bridge.
const RAYS: i32 = 3;
/// Places along a contour, as part of the width of the bridge: closer ones differ by nothing that shows.
const SPACING: f64 = 0.2;
/// Vertices closer than this part of the spacing are passed over: contours have far more of them than places differ.
const DENSEST: f64 = 0.5;
/// The most places that are probed for one pair of contours; beyond, every second one is left out, and so on.
const MOST_PLACES: usize = 600;
/// How deep an end is sunk where there is room, as part of the width: enough that rounding cannot loosen it.
const SINK: f64 = 0.15;
/// How far an end stays off what it must not be sunk into, as part of the width: more than a bridge may touch.
const CLEAR: f64 = 0.02;
/// A contour that reaches less far into a bridge, as part of its width, is not met: rounding could miss it.
const TOUCH: f64 = 0.01;
/// How far a ray looks for the other contour beyond the middle one's hit, as part of the width.
const LOOK: f64 = 1.5;
/// How far the edge of a bridge may lie off what is crossed, where that bends, as part of the width.
const BEND: f64 = 0.6;
/// Crossings within this part of a way from its ends are those of the contours that it leads to.
const END: f64 = 1e-6;
/// What is paid for ends that are not square, for each millimetre that one edge of the bridge is longer.
const SKEW: f64 = 0.5;
/// What is paid for a ray that finds nothing to hold on to, as part of the width.
const MISS: f64 = 0.75;
/// What there should be to hold on to, as part of the width, and what is paid for each millimetre less.
const HOLD: f64 = 1.0;
const THIN: f64 = 0.6;

/// A place for a bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Where its axis meets the first contour.
    pub(super) from: DVec2,
    /// Where it meets the second.
    pub(super) to: DVec2,
    /// Its corners, counter-clockwise, sunk into both sides.
    pub(super) corners: [DVec2; 4],
    /// Millimetres of bridge with all that is paid for; less is better.
    pub(super) score: f64,
}

impl Place {
    pub(super) fn middle(&self) -> DVec2 {
        0.5 * (self.from + self.to)
    }

    pub(super) fn width_mm(&self) -> f64 {
        self.corners[0].distance(self.corners[3])
    }

    pub(super) fn length_mm(&self) -> f64 {
        self.from.distance(self.to)
    }
}

/// What probing needs to know.
#[derive(Clone, Copy)]
pub(super) struct Prober<'a> {
    pub(super) ground: &'a Ground,
    pub(super) index: &'a EdgeIndex,
    pub(super) side: Side,
    pub(super) width_mm: f64,
}

impl Prober<'_> {
    /// The `most` best places where the contours of `link` are at most `limit_mm` apart, the best first.
    pub(super) fn between(&self, link: &Link, limit_mm: f64, most: usize) -> Vec<Place> {
        let Link { rims, ends, .. } = *link;
        let mut axes = Vec::new();
        for [a, b] in [rims, [rims[1], rims[0]]] {
            let (a, b) = (&self.ground.rims[a], &self.ground.rims[b]);
            let margin = DVec2::splat(limit_mm);
            let mut last = None;
            for edge in a.edges_in(b.low - margin, b.high + margin) {
                for p in self.along(edge.from, edge.to) {
                    if b.box_distance(p) > limit_mm || self.is_beside(p, &mut last) {
                        continue;
                    }
                    let q = b.nearest(p);
                    if q.distance(p) <= limit_mm && q != p {
                        axes.push([p, q]);
                    }
                }
            }
        }
        let stride = axes.len().div_ceil(MOST_PLACES).max(1);
        // The shortest may not be thinned out.
        let axes = axes.into_iter().step_by(stride).chain([ends]);
        self.ranked(axes.filter_map(|[p, q]| self.probe(p, q)), most)
    }

    /// Whether no contour crosses the way between two points of contours.
    pub(super) fn is_clear(&self, [p, q]: [DVec2; 2]) -> bool {
        let ahead = q - p;
        !self.index.in_box(p.min(q), p.max(q)).any(|edge| {
            let (a, b) = (ahead.perp_dot(edge.from - p), ahead.perp_dot(edge.to - p));
            let across = ahead.dot(edge.from - p) + ahead.dot(edge.to - edge.from) * (a / (a - b));
            let part = across / ahead.length_squared();
            (a > 0.0) != (b > 0.0) && (END..1.0 - END).contains(&part)
        })
    }

    /// The contours that have a point well within these corners: what the bridge just touches is not joined.
    pub(super) fn met(&self, corners: &[DVec2; 4]) -> Vec<usize> {
        let skin = TOUCH * self.width_mm;
        let inward = |from: DVec2, to: DVec2| (to - from).normalize_or_zero() * skin;
        let corners: [DVec2; 4] = std::array::from_fn(|i| {
            let [before, at, after] = [(i + 3) % 4, i, (i + 1) % 4].map(|i| corners[i]);
            at + inward(at, before) + inward(at, after)
        });
        let (mut low, mut high) = (corners[0], corners[0]);
        corners.iter().for_each(|&p| (low, high) = (low.min(p), high.max(p)));
        // An edge meets a convex polygon unless it lies beyond one of its sides, or all corners beside the edge.
        let beyond = |a: DVec2, b: DVec2| {
            (0..4).any(|i| {
                let side = corners[(i + 1) % 4] - corners[i];
                side.perp_dot(a - corners[i]) < 0.0 && side.perp_dot(b - corners[i]) < 0.0
            }) || [1.0, -1.0].iter().any(|sign| corners.iter().all(|&c| sign * (b - a).perp_dot(c - a) < 0.0))
        };
        let edges = self.index.in_box(low, high).filter(|edge| !beyond(edge.from, edge.to));
        let mut rims: Vec<usize> = edges.map(|edge| edge.contour).collect();
        rims.sort_unstable();
        rims.dedup();
        rims
    }

    /// Points of an edge: its beginning, and more where it is long.
    pub(super) fn along(&self, from: DVec2, to: DVec2) -> impl Iterator<Item = DVec2> + use<> {
        let count = (from.distance(to) / (SPACING * self.width_mm)).ceil().max(1.0) as usize;
        (0..count).map(move |i| from.lerp(to, i as f64 / count as f64))
    }

    /// Whether `p` is too near to the `last` point of its contour that was looked at; if not, it is the last one now.
    pub(super) fn is_beside(&self, p: DVec2, last: &mut Option<DVec2>) -> bool {
        let beside = last.is_some_and(|last| last.distance(p) < DENSEST * SPACING * self.width_mm);
        if !beside {
            *last = Some(p);
        }
        beside
    }

    /// The best first, with those left out that lie beside a better one.
    pub(super) fn ranked(&self, places: impl Iterator<Item = Place>, most: usize) -> Vec<Place> {
        let mut all: Vec<Place> = places.collect();
        let key = |p: &Place| [p.score, p.from.x, p.from.y, p.to.x, p.to.y];
        let order = |a: &Place, b: &Place| {
            let pairs = key(a).into_iter().zip(key(b));
            pairs.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        };
        all.sort_by(order);
        let mut kept: Vec<Place> = Vec::new();
        for place in all {
            let apart = 0.4 * self.width_mm;
            if kept.iter().all(|k| k.middle().distance(place.middle()) > apart) {
                kept.push(place);
            }
            if kept.len() == most {
                break;
            }
        }
        kept
    }

    /// The bridge along the line from `p` to `q`, both on contours; `None` when something is in between.
    pub(super) fn probe(&self, p: DVec2, q: DVec2) -> Option<Place> {
        let half_mm = 0.5 * self.width_mm;
        let (middle, half_length) = (0.5 * (p + q), 0.5 * p.distance(q));
        let ahead = (q - p).normalize_or_zero();
        let left = ahead.perp();
        let deepest = half_length + LOOK * self.width_mm;
        let (low, high) = bounds([p, q], deepest.max(half_mm) + half_mm);
        let edges: Vec<_> = self.index.in_box(low, high).map(|e| [e.from, e.to]).collect();
        let mut score = 0.0;
        let mut reach = [0.0; 2];
        for (end, direction) in [-ahead, ahead].into_iter().enumerate() {
            let mut hits: Vec<Hit> = Vec::new();
            let mut axis = None;
            for ray in -RAYS..=RAYS {
                let start = middle + left * (half_mm * f64::from(ray) / f64::from(RAYS));
                let hit = self.shoot(&edges, start, direction, half_length + BEND * self.width_mm, deepest);
                if ray == 0 && hit.is_none_or(|hit| (hit.enter - half_length).abs() > 1e-3 * self.width_mm) {
                    return None;
                }
                if ray == 0 {
                    axis = hit;
                }
                hits.extend(hit);
            }
            let rays = f64::from(2 * RAYS + 1);
            let misses = rays - hits.len() as f64;
            let deep = hits.iter().map(|h| h.enter).fold(0.0, f64::max);
            let shallow = hits.iter().map(|h| h.enter).fold(f64::INFINITY, f64::min);
            let far_side = hits.iter().map(|h| h.leave).fold(f64::INFINITY, f64::min);
            let mean = hits.iter().map(|h| h.enter).sum::<f64>() / hits.len() as f64;
            let hold = hits.iter().map(|h| h.leave - h.enter).sum::<f64>() / hits.len() as f64;
            let lacking = (HOLD * self.width_mm - hold).max(0.0);
            score += mean + SKEW * (deep - shallow) + MISS * self.width_mm * misses / rays + THIN * lacking;
            let room = 0.5 * (far_side - deep);
            // Without room a corner would lie on a contour, and rounding would say whether it is cut.
            let room = if room > 0.0 { room } else { -CLEAR * self.width_mm };
            reach[end] = deep + room.min(SINK * self.width_mm);
            // A corner must be sunk into as well, or the bridge only touches it.
            if let Some(hit) = axis {
                let room = 0.5 * (hit.leave - hit.enter);
                reach[end] = reach[end].max(hit.enter + room.min(SINK * self.width_mm));
            }
        }
        let (back, front) = (middle - ahead * reach[0], middle + ahead * reach[1]);
        let across = left * half_mm;
        Some(Place {
            from: p,
            to: q,
            corners: [back - across, front - across, front + across, back + across],
            score,
        })
    }

    /// Where a ray enters what is to be joined, and where it leaves it again; `None` when it finds nothing.
    fn shoot(
        &self,
        edges: &[[DVec2; 2]],
        start: DVec2,
        ahead: DVec2,
        crossed: f64,
        deepest: f64,
    ) -> Option<Hit> {
        let mut crossings: Vec<(f64, bool)> = Vec::new();
        for &[from, to] in edges {
            let (a, b) = (ahead.perp_dot(from - start), ahead.perp_dot(to - start));
            if (a > 0.0) == (b > 0.0) {
                continue;
            }
            let t = ahead.dot(from - start) + ahead.dot(to - from) * (a / (a - b));
            // Ink is on the left of an edge: a ray that sees the edge go from its right to its left leaves ink.
            let into_ink = a > 0.0;
            crossings.push((t, into_ink == (self.side == Side::Gap)));
        }
        crossings.retain(|&(t, _)| t > 0.0 && t <= 2.0 * deepest);
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(first, enters) = crossings.first()?;
        // A ray may begin inside already. Where what is crossed bends, it soon comes out of there and crosses it.
        let is_inside = !enters && (first > crossed || crossings.len() == 1);
        let at = |i: usize| crossings.get(i).map_or(2.0 * deepest, |&(t, _)| t);
        let [enter, leave] = match (enters, is_inside) {
            (true, _) => [first, at(1)],
            (false, true) => [0.0, first],
            (false, false) => [at(1), at(2)],
        };
        (enter <= deepest).then_some(Hit { enter, leave })
    }
}

/// Where a ray enters and leaves, in millimetres from its start.
#[derive(Clone, Copy)]
struct Hit {
    enter: f64,
    leave: f64,
}

fn bounds(points: [DVec2; 2], margin: f64) -> (DVec2, DVec2) {
    let [p, q] = points;
    (p.min(q) - margin, p.max(q) + margin)
}
