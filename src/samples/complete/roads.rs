//! Strokes round corners: between components that no straight stroke joins, along the shortest way inside of the area.
//!
//! A shortest way bends only where the area's border does, at corners that point into it. From each of them all others that can be seen are
//! looked up, and the ink that is nearest; what is between is found by distances alone (Dijkstra). Of the whole way only the stretch from
//! the last ink of the one side to the first of the other becomes a stroke. Excluded: rolled areas, whose borders are straight.

use std::collections::BTreeMap;

use glam::DVec2;
use kurbo::ParamCurve;

use super::ChangeKind;
use super::lines::{Line, Lines, Owner};
use super::links::Planner;
use super::scene::Scene;
use super::step::{Port, Step, is_inside};
use crate::planar::Sets;
use crate::samples::Area;
use crate::samples::cubic::Cubic;

/// The most corners that ways may go by: of more, as many are taken at even distances.
const MOST_CORNERS: usize = 600;
/// A border turns at a corner by at least this angle, in radians: less is a curve's chord.
const LEAST_TURN: f64 = 1e-4;
/// So much of the nearest ink is looked at from a corner, as border may be between.
const MOST_LOOKS: usize = 256;
/// Handles of a stroke round a corner, as parts of what is straight: the largest that stay inside are taken.
const HANDLES: [f64; 4] = [1.0 / 3.0, 0.1, 0.03, 0.01];
/// A way is looked at for ink in steps of this part of the pen.
const STEP_PENS: f64 = 0.25;

/// Places that are nearer to one another than this part of the pen are one.
const LEAST_PENS: f64 = 0.1;

impl Planner<'_, '_> {
    /// Up to `needed` steps of which each joins two of the sets of components, round corners of the area.
    pub(super) fn roads(&self, needed: usize, sets: &mut Sets) -> Vec<Step> {
        let (scene, area) = (self.scene, self.scene.work.area);
        let mut steps = Vec::new();
        if area.lap_mm().is_some() || needed == 0 {
            return steps;
        }
        let corners = corners(area, 2.0 * scene.work.completing.chord_mm);
        if corners.is_empty() {
            return steps;
        }
        let seen = Seen::new(area, corners);
        for part in 0..scene.region.components() {
            let set = sets.find(part);
            let is_own: Vec<bool> =
                (0..scene.region.components()).map(|other| sets.find(other) == set).collect();
            if steps.len() == needed || is_own.iter().all(|&is_own| is_own) {
                break;
            }
            let Some(way) = self.road(&seen, &is_own) else { continue };
            let Some((ports, places, met)) = self.stretch(&way, &is_own) else { continue };
            let Some(cubics) = smooth(area, &places) else { continue };
            let step = Step::along(ChangeKind::Link, ports.map(|port| port.foot), &cubics);
            if !(self.is_banned)(&step) {
                sets.join(part, met);
                steps.push(step);
            }
        }
        steps
    }

    /// The shortest way by corners from the components that are `is_own` to another, by its places.
    fn road(&self, seen: &Seen, is_own: &[bool]) -> Option<Vec<DVec2>> {
        let scene = self.scene;
        let of = |owner: Owner| scene.part(owner);
        let own = scene.lines.only(|owner| of(owner).is_some_and(|part| is_own[part]));
        let others = scene.lines.only(|owner| of(owner).is_some_and(|part| !is_own[part]));
        let nearest = |lines: &Lines, corner: DVec2| {
            let mut looks = lines.nearest_first(corner).take(MOST_LOOKS);
            let inked = looks.find(|(_, line)| is_seen(scene.work.area, line.nearest(corner).0, corner));
            inked.map(|(way_mm, line)| (way_mm, line.nearest(corner).0))
        };
        let begins: Vec<_> = seen.corners.iter().map(|&corner| nearest(&own, corner)).collect();
        let ends: Vec<_> = seen.corners.iter().map(|&corner| nearest(&others, corner)).collect();
        let start = begins.iter().map(|begin| begin.map_or(f64::INFINITY, |(way_mm, _)| way_mm)).collect();
        let (ways_mm, before) = seen.ways(start);
        let total = |corner: usize| Some(ways_mm[corner] + ends[corner]?.0).filter(|way| way.is_finite());
        let lasts = (0..seen.corners.len()).filter_map(|corner| Some((total(corner)?, corner)));
        let (_, last) = lasts.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut places = vec![ends[last]?.1];
        let mut corner = last;
        loop {
            places.push(seen.corners[corner]);
            match before[corner] {
                Some(earlier) => corner = earlier,
                None => break,
            }
        }
        places.push(begins[corner]?.1);
        places.reverse();
        Some(places)
    }

    /// What of a way is in the open between two sides, with the ports at its ends, and the component that it meets: the first one on the way.
    fn stretch(&self, places: &[DVec2], is_own: &[bool]) -> Option<([Port; 2], Vec<DVec2>, usize)> {
        let (scene, work) = (self.scene, &self.scene.work);
        let reach_mm = 0.5 * work.pen_mm;
        // Whose ink is touched on the way, with how far that is, in corners.
        let mut left: Option<(f64, Line)> = None;
        let mut met: Option<(f64, Line, usize)> = None;
        'way: for (i, side) in places.windows(2).enumerate() {
            let count = (side[0].distance(side[1]) / (STEP_PENS * work.pen_mm)).ceil().clamp(1.0, 1e4) as u32;
            for k in 0..=count {
                let part = f64::from(k) / f64::from(count);
                for (_, line) in scene.lines.near(side[0].lerp(side[1], part), reach_mm) {
                    match scene.part(line.owner) {
                        Some(part_of) if is_own[part_of] => left = Some((i as f64 + part, *line)),
                        Some(part_of) => {
                            met = Some((i as f64 + part, *line, part_of));
                            break 'way;
                        }
                        None => {}
                    }
                }
            }
        }
        let ((from, first), (to, last, met)) = (left?, met?);
        let mut way = vec![at(places, from)];
        way.extend((from.floor() as usize + 1..to.ceil() as usize).map(|i| places[i]));
        way.push(at(places, to));
        // The ink is met by the side of the pen: its middle goes on from there, as the way by the corners is narrow.
        let ends = [self.landing(&first, way[0]), self.landing(&last, way[way.len() - 1])];
        way.insert(0, ends[0].at);
        way.push(ends[1].at);
        way.dedup_by(|a, b| a.distance(*b) < LEAST_PENS * work.pen_mm);
        let count = way.len();
        (way[0], way[count - 1]) = (ends[0].at, ends[1].at);
        (count > 1).then_some((ends, way, met))
    }
}

/// A place on a way, by the number of the corner before it and the part of what follows.
fn at(places: &[DVec2], number: f64) -> DVec2 {
    let i = (number.floor() as usize).min(places.len() - 2);
    places[i].lerp(places[i + 1], number - i as f64)
}

/// Corners of an area, and which of them are seen from which.
struct Seen {
    corners: Vec<DVec2>,
    from: Vec<Vec<usize>>,
}

impl Seen {
    fn new(area: &Area, corners: Vec<DVec2>) -> Self {
        let mut from = vec![Vec::new(); corners.len()];
        for b in 0..corners.len() {
            for a in 0..b {
                if is_seen(area, corners[a], corners[b]) {
                    from[a].push(b);
                    from[b].push(a);
                }
            }
        }
        Self { corners, from }
    }

    /// How far each corner is where so much of the way is behind at its beginning, and the corner before it.
    fn ways(&self, start: Vec<f64>) -> (Vec<f64>, Vec<Option<usize>>) {
        let mut ways_mm = start;
        let mut before = vec![None; ways_mm.len()];
        // Lengths that are not negative are in the order of their bits.
        let mut open: BTreeMap<(u64, usize), ()> = (0..ways_mm.len())
            .filter(|&i| ways_mm[i].is_finite())
            .map(|i| ((ways_mm[i].to_bits(), i), ()))
            .collect();
        while let Some(((bits, corner), ())) = open.pop_first() {
            let so_far_mm = f64::from_bits(bits);
            for &next in &self.from[corner] {
                let way_mm = so_far_mm + self.corners[corner].distance(self.corners[next]);
                if way_mm < ways_mm[next] {
                    open.remove(&(ways_mm[next].to_bits(), next));
                    (ways_mm[next], before[next]) = (way_mm, Some(corner));
                    open.insert((way_mm.to_bits(), next), ());
                }
            }
        }
        (ways_mm, before)
    }
}

/// Whether a straight line between two places of the area stays in it.
fn is_seen(area: &Area, a: DVec2, b: DVec2) -> bool {
    area.crossings(a, b).next().is_none() && area.contains(a.midpoint(b))
}

/// The corners of an area at which its border turns into it, moved inside by `off_mm`.
fn corners(area: &Area, off_mm: f64) -> Vec<DVec2> {
    let grid = area.region().grid();
    let mut corners = Vec::new();
    for contour in area.region().contours() {
        let points: Vec<DVec2> = contour.points().iter().map(|&p| grid.to_mm(p)).collect();
        let count = points.len();
        for i in 0..count {
            let [a, b, c] = [points[(i + count - 1) % count], points[i], points[(i + 1) % count]];
            let [into, out] = [(b - a).normalize_or_zero(), (c - b).normalize_or_zero()];
            let corner = b + (into + out).perp().normalize_or_zero() * off_mm;
            if into.perp_dot(out) < -LEAST_TURN && area.contains(corner) {
                corners.push(corner);
            }
        }
    }
    let stride = corners.len().div_ceil(MOST_CORNERS).max(1);
    corners.into_iter().step_by(stride).collect()
}

/// The curves of a stroke by places, as smooth as the area lets them be; `None` where it leaves no room.
fn smooth(area: &Area, places: &[DVec2]) -> Option<Vec<Cubic>> {
    let last = places.len() - 1;
    let way = |i: usize| (places[i + 1] - places[i]).normalize_or_zero();
    let along = |i: usize| match i {
        0 => way(0),
        i if i == last => way(last - 1),
        i => (way(i - 1) + way(i)).normalize_or(way(i)),
    };
    let curves = |part: f64| -> Vec<Cubic> {
        let side = |i: usize| {
            let (a, b) = (places[i], places[i + 1]);
            let handle_mm = part * a.distance(b);
            [a, a + handle_mm * along(i), b - handle_mm * along(i + 1), b]
        };
        (0..last).map(side).collect()
    };
    HANDLES.into_iter().map(curves).find(|cubics| is_inside(cubics, area))
}

impl Scene<'_> {
    /// How many pieces the area has that have ink, where those that ink joins already are one: no fewer components can be had within it.
    pub fn islands(&self) -> usize {
        let region = self.work.area.region();
        if region.components() < 2 || self.work.area.lap_mm().is_some() {
            return 1;
        }
        let places = super::places::Places::new(region);
        let count = self.region.components();
        let mut sets = Sets::new(count + region.components());
        let mut join = |part: Option<usize>, at: DVec2| {
            if let Some((part, piece)) = part.zip(places.part(at)) {
                sets.join(part, count + piece);
            }
        };
        for (stroke, curve) in self.work.frame.iter().enumerate() {
            let begin = curve.path.segments().next().map(|segment| segment.start());
            begin.iter().for_each(|p| join(self.part(Owner::Frame(stroke)), DVec2::new(p.x, p.y)));
        }
        for (sample, known) in self.work.samples.iter().enumerate() {
            join(self.part_of_sample(sample), known.at);
        }
        let contours = self.work.elements.iter().flat_map(|element| &element.contours);
        for (number, contour) in contours.enumerate() {
            contour.iter().for_each(|&p| join(self.part(Owner::Contour(number)), p));
        }
        let mut found: Vec<usize> = (0..count).map(|part| sets.find(part)).collect();
        found.sort_unstable();
        found.dedup();
        found.len()
    }
}
