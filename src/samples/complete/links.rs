//! Strokes that are added: between components, to make them one, and within one, to enclose a hole.

use std::collections::BTreeMap;

use glam::DVec2;
use kurbo::{ParamCurve, ParamCurveArclen};

use super::ChangeKind;
use super::lines::{CHORDS, Line, Lines, Owner, Run};
use super::scene::Scene;
use super::step::{Link, Port, SMOOTH, Step};
use super::work::Foot;
use crate::planar::Sets;
use crate::samples::cubic::point_at;
use crate::samples::{Edge, Kind};

/// A component of less ink than this many squares of the pen may be taken away where that is less than joining it.
const SMALL_PENS: f64 = 8.0;
/// Candidates for each pair of components at first, as something may be in the way of the cheapest.
const PER_PAIR: usize = 6;
/// A stroke that closes a hole has at least so many edges between its ends, or where there is no such, so many.
const FAR_HOPS: usize = 6;
const NEAR_HOPS: usize = 2;
/// Components that a place is linked to at first; with each doubling of the reach to twice as many.
const PER_PLACE: usize = 4;
/// A set of components with more edges than this has a tree of its own of all that is outside of it.
const LARGE_SET: usize = 200;
/// Candidates within a component from one place.
const PER_PORT: usize = 3;
/// A link that ends at an edge ends at its sample if that is nearer than this many pens: with less, a sliver stays between it and an end or
/// what else leaves there. Where a path only passes there is neither, and the link would be askew for it.
const SNAP_PENS: f64 = 1.5;
const PASSING_SNAP_PENS: f64 = 0.3;
/// How often the ends of a link move to where the other one is nearest.
const MOVES: usize = 3;
/// How many spacings a link reaches at first, and how often that is doubled.
const FIRST_REACH_SPACINGS: f64 = 3.0;
const DOUBLINGS: u32 = 8;

/// What may be added, and what is banned from being tried again.
pub(super) struct Planner<'s, 'a> {
    pub scene: &'s Scene<'a>,
    /// Whether strokes that would touch other ink are tried as well: how the counts then change is seen when it is done.
    pub is_bold: bool,
    /// The face inside of a ring that has to stay closed.
    pub inside: Option<usize>,
    /// Is told a step that is thought of.
    pub is_banned: &'s dyn Fn(&Step) -> bool,
}

impl Planner<'_, '_> {
    /// Up to `needed` steps of which each makes one component of two.
    pub fn joins(&self, needed: usize) -> Vec<Step> {
        let scene = self.scene;
        let mut lines = Lines::new(&scene.work);
        let mut sets = Sets::new(scene.region.components());
        let mut steps = Vec::new();
        // An end that would have to turn away makes a hook, and is better left to a later one.
        let goes_on = |edge: &&Edge| {
            let [from, to] = edge.ends.map(|end| scene.port(end));
            let way = scene.work.area.way(from.at, to.at);
            from.points_along(way, SMOOTH) && to.points_along(-way, SMOOTH)
        };
        for edge in self.voted().filter(goes_on) {
            if steps.len() == needed {
                return steps;
            }
            let Some([p, q]) = self.both_parts(edge.ends) else { continue };
            if sets.find(p) == sets.find(q) {
                continue;
            }
            let (ports, cubic) = (edge.ends.map(|end| scene.port(end)), scene.work.cubic_of(edge));
            let [from, to] = ports;
            let link = if edge.handles.contains(&DVec2::ZERO) {
                Link::smooth(scene, &from, &to)
            } else {
                Link { from, to, cubic }
            };
            let step = Step::add(ChangeKind::Join, &link, Some(edge.confidence));
            if self.is_possible(&link, &step, &lines, false) {
                lines.add(&link.cubic, scene.work.pen_mm / 2.0, usize::MAX);
                sets.join(p, q);
                steps.push(step);
            }
        }
        for doubling in 0..=DOUBLINGS {
            let (links, is_all) = self.between_parts(doubling, &mut sets);
            for ([p, q], link) in links {
                if steps.len() == needed {
                    return steps;
                }
                if sets.find(p) == sets.find(q) {
                    continue;
                }
                if let Some(step) = [p, q].iter().find_map(|&part| self.leaving_out(part, &link)) {
                    sets.join(p, q);
                    steps.push(step);
                    continue;
                }
                for link in [link.clone(), link.straightened()] {
                    let step = Step::add(ChangeKind::Link, &link, None);
                    if self.is_possible(&link, &step, &lines, false) {
                        lines.add(&link.cubic, scene.work.pen_mm / 2.0, usize::MAX);
                        sets.join(p, q);
                        steps.push(step);
                        break;
                    }
                }
            }
            if is_all {
                break;
            }
        }
        if self.is_bold && steps.is_empty() {
            steps = self.roads(needed, &mut sets);
        }
        steps
    }

    /// Up to `needed` steps of which each closes a hole within a component.
    pub fn closings(&self, needed: usize) -> Vec<Step> {
        let scene = self.scene;
        let mut lines = Lines::new(&scene.work);
        let mut steps: Vec<Step> = Vec::new();
        let voted = self.voted().filter_map(|edge| {
            let [p, q] = self.both_parts(edge.ends)?;
            let [from, to] = edge.ends.map(|end| scene.port(end));
            let link = Link::smooth(scene, &from, &to);
            (p == q).then_some((ChangeKind::Enclose, link, Some(edge.confidence)))
        });
        let mut candidates: Vec<_> = voted.collect();
        // Strokes that enclose much, then those that only cut a corner.
        let stems = [FAR_HOPS, NEAR_HOPS].map(|hops| (hops, scene.around_contours(hops)));
        let reaches =
            stems.iter().flat_map(|(hops, stems)| (0..4).map(move |doubling| (*hops, stems, 3 << doubling)));
        for (hops, stems, spacings) in reaches {
            let reach_mm = scene.spacing_mm * f64::from(spacings);
            let links = self.within_parts(reach_mm, hops, stems).into_iter();
            candidates.extend(links.map(|link| (ChangeKind::Enclose, link, None)));
            for (kind, link, confidence) in candidates.drain(..) {
                if steps.len() == needed {
                    return steps;
                }
                let step = Step::add(kind, &link, confidence);
                if self.is_possible(&link, &step, &lines, true) {
                    lines.add(&link.cubic, scene.work.pen_mm / 2.0, usize::MAX);
                    steps.push(step);
                }
            }
        }
        steps
    }

    /// The edges that may be added and were voted for, the most confident first.
    fn voted(&self) -> impl Iterator<Item = &Edge> {
        let work = &self.scene.work;
        work.unrealised.iter().take_while(|edge| edge.confidence >= work.completing.least_vote)
    }

    fn both_parts(&self, ends: [usize; 2]) -> Option<[usize; 2]> {
        let [p, q] = ends.map(|end| self.scene.part_of_sample(end));
        Some([p?, q?])
    }

    /// Whether a link stays in the area, clear of other ink, and was not tried in vain.
    fn is_possible(&self, link: &Link, step: &Step, lines: &Lines, is_within: bool) -> bool {
        if (self.is_banned)(step) || !link.is_inside(self.scene) {
            return false;
        }
        let mut own = self.scene.own(link.from.foot, link.from.owner);
        own.extend(self.scene.own(link.to.foot, link.to.owner));
        let run = lines.run(&link.cubic, self.scene.work.pen_mm / 2.0, self.scene.margin_mm(), |owner| {
            own.contains(&owner)
        });
        match run {
            Run::Clear => true,
            Run::Short => !is_within,
            Run::Blocked => self.is_bold && !is_within,
        }
    }

    /// Instead of a link, a step that takes a small component away, if that is less than the link.
    fn leaving_out(&self, part: usize, link: &Link) -> Option<Step> {
        let work = &self.scene.work;
        if !work.completing.leaves_out_small {
            return None;
        }
        let pen_mm = work.pen_mm;
        let found = &self.scene.region.parts()[part];
        let area_mm2 = found.exterior().area_mm2(self.scene.region.grid());
        if area_mm2 > SMALL_PENS * pen_mm * pen_mm || !found.holes().is_empty() || self.scene.has_solid(part)
        {
            return None;
        }
        let edges: Vec<usize> =
            work.present().filter(|&edge| self.scene.part(Owner::Edge(edge)) == Some(part)).collect();
        let length: f64 = edges.iter().map(|&edge| work.length_mm(edge)).sum();
        let [a, .., b] = link.cubic;
        if edges.is_empty() || edges.iter().any(|&edge| work.is_given(edge)) || length > a.distance(b) {
            return None;
        }
        let step = Step::remove(ChangeKind::LeaveOut, edges, work);
        (!(self.is_banned)(&step)).then_some(step)
    }

    /// Links within a reach that was doubled so often, between parts that are not in one set yet, the cheapest first. With each doubling more
    /// are given, until these are all: that is told with them.
    fn between_parts(&self, doubling: u32, sets: &mut Sets) -> (Vec<([usize; 2], Link)>, bool) {
        let reach_mm = FIRST_REACH_SPACINGS * self.scene.spacing_mm * f64::from(1 << doubling);
        let [most, per_pair] = [PER_PLACE, PER_PAIR].map(|count| count << doubling);
        let mut found: BTreeMap<[usize; 2], Vec<(f64, Link)>> = BTreeMap::new();
        let set_of: Vec<usize> = (0..self.scene.region.components()).map(|part| sets.find(part)).collect();
        let sizes = self.sizes(&set_of);
        let largest = self.largest_set(&set_of, &sizes);
        if set_of.iter().all(|&set| set == largest) {
            return (Vec::new(), true);
        }
        // For each set, how many parts are not in it.
        let mut others = vec![set_of.len(); set_of.len()];
        set_of.iter().for_each(|&set| others[set] -= 1);
        // From within a large set nearly all that is near is its own.
        let outside_of = |set: usize| {
            self.scene.lines.only(|owner| self.scene.part(owner).is_some_and(|part| set_of[part] != set))
        };
        let large = (0..sizes.len()).filter(|&set| sizes[set] > LARGE_SET || set == largest);
        let outside: BTreeMap<usize, Lines> = large.map(|set| (set, outside_of(set))).collect();
        for (part, port) in self.ports() {
            if set_of[part] == largest && port.onward.is_none() {
                // Links to the largest are found from the others.
                continue;
            }
            let lines = outside.get(&set_of[part]).unwrap_or(&self.scene.lines);
            let mut seen: Vec<usize> = Vec::new();
            for (_, line) in lines.nearest_first(port.at).take_while(|&(way_mm, _)| way_mm <= reach_mm) {
                let Some(other) = self.scene.part(line.owner) else { continue };
                if set_of[other] == set_of[part] || seen.contains(&other) {
                    continue;
                }
                seen.push(other);
                let link = Link::smooth(self.scene, &port, &self.landing(line, port.at));
                if link.is_inside(self.scene) {
                    let pair = [part.min(other), part.max(other)];
                    found.entry(pair).or_default().push((link.cost(self.scene), link));
                }
                // All that is farther is of those that were seen.
                if seen.len() == most.min(others[set_of[part]]) {
                    break;
                }
            }
        }
        let (low, high) = self.scene.work.area.bounds_mm();
        let is_all = reach_mm > low.distance(high)
            && most >= set_of.len()
            && found.values().all(|candidates| candidates.len() <= per_pair);
        let mut links: Vec<(f64, [usize; 2], Link)> = Vec::new();
        for (pair, mut candidates) in found {
            candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
            candidates.truncate(per_pair);
            let settled = candidates.into_iter().map(|(cost, link)| self.settled(cost, link));
            links.extend(settled.map(|(cost, link)| (cost, pair, link)));
        }
        links.sort_by(|a, b| a.0.total_cmp(&b.0));
        (links.into_iter().map(|(_, pair, link)| (pair, link)).collect(), is_all)
    }

    /// A link with its cost, after its ends on the sides of ink have moved to where it is shortest, if it is cheaper there.
    fn settled(&self, cost: f64, link: Link) -> (f64, Link) {
        let mut best = (cost, link);
        let (mut from, mut to) = (best.1.from.clone(), best.1.to.clone());
        for _ in 0..MOVES {
            from = self.moved(from, to.at);
            to = self.moved(to, from.at);
            let link = Link::smooth(self.scene, &from, &to);
            let cost = link.cost(self.scene);
            if cost < best.0 && link.is_inside(self.scene) {
                best = (cost, link);
            }
        }
        best
    }

    /// Where the ink of a port is nearest to `p`; ends in the open stay where they are.
    fn moved(&self, port: Port, p: DVec2) -> Port {
        if port.onward.is_some() {
            return port;
        }
        let own = self.scene.own(port.foot, port.owner);
        let p = port.at + self.scene.work.area.way(port.at, p);
        self.scene.lines.nearest_of(&own, p).map_or(port, |line| self.landing(line, p))
    }

    /// Links that would enclose a hole with more than `hops` edges around it, the cheapest first. `stems` are the edges that hang on to contours by
    /// as many.
    fn within_parts(&self, reach_mm: f64, hops: usize, stems: &[Vec<usize>]) -> Vec<Link> {
        let mut links: Vec<(f64, Link)> = Vec::new();
        for (part, port) in self.ports() {
            let mut own = self.scene.own_within(port.foot, port.owner, hops);
            // What is near an element's outline is mostly the stem that it hangs on.
            if let Some(Owner::Contour(contour)) = port.owner {
                own.extend(stems[contour].iter().copied().map(Owner::Edge));
            }
            let near = self.scene.lines.nearest_first(port.at).take_while(|&(way_mm, _)| way_mm <= reach_mm);
            let others = near
                .filter(|(_, line)| self.scene.part(line.owner) == Some(part) && !own.contains(&line.owner));
            let ahead = others.filter(|(_, line)| {
                let way = line.nearest(port.at).0 - port.at;
                port.onward.is_none_or(|onward| onward.dot(way) > 0.0)
            });
            let mut seen: Vec<Owner> = Vec::new();
            for (_, line) in ahead {
                if seen.len() == PER_PORT {
                    break;
                }
                if !seen.contains(&line.owner) {
                    seen.push(line.owner);
                    let link = Link::smooth(self.scene, &port, &self.landing(line, port.at));
                    links.push((link.cost(self.scene), link));
                }
            }
        }
        links.sort_by(|a, b| a.0.total_cmp(&b.0));
        links.into_iter().map(|(_, link)| link).collect()
    }

    /// The set of parts that has the frame, or the most edges.
    fn largest_set(&self, set_of: &[usize], sizes: &[usize]) -> usize {
        for stroke in 0..self.scene.work.frame.len() {
            if let Some(part) = self.scene.part(Owner::Frame(stroke)) {
                return set_of[part];
            }
        }
        (1..sizes.len()).fold(0, |best, i| if sizes[i] > sizes[best] { i } else { best })
    }

    /// How many edges each set of parts has, with outlines of elements by as many lines as edges have.
    fn sizes(&self, set_of: &[usize]) -> Vec<usize> {
        let mut sizes = vec![0; set_of.len()];
        for edge in self.scene.work.present() {
            if let Some(part) = self.scene.part(Owner::Edge(edge)) {
                sizes[set_of[part]] += 1;
            }
        }
        let contours = self.scene.work.elements.iter().flat_map(|element| &element.contours);
        for (number, contour) in contours.enumerate() {
            if let Some(part) = self.scene.part(Owner::Contour(number)) {
                sizes[set_of[part]] += contour.len().div_ceil(CHORDS as usize);
            }
        }
        sizes
    }

    /// All places from which links may go, with their parts: samples, middles of long edges, points of elements' outlines and of the frame.
    fn ports(&self) -> Vec<(usize, Port)> {
        let (scene, work) = (self.scene, &self.scene.work);
        let samples = (0..work.samples.len()).filter(|&i| work.samples[i].kind == Kind::Curve);
        let mut ports: Vec<(usize, Port)> =
            samples.filter_map(|sample| Some((scene.part_of_sample(sample)?, scene.port(sample)))).collect();
        for edge in work.present().filter(|&edge| work.length_mm(edge) > 4.0 * work.pen_mm) {
            let Some(part) = scene.part(Owner::Edge(edge)) else { continue };
            let at = point_at(&work.cubic(edge), 0.5);
            ports.push((part, Port { foot: Foot::Edge(edge, 0.5), at, owner: None, onward: None }));
        }
        for (number, contour) in work.elements.iter().flat_map(|element| &element.contours).enumerate() {
            let owner = Owner::Contour(number);
            let Some(part) = scene.part(owner) else { continue };
            let stride = contour.len().div_ceil(32);
            for i in (0..contour.len()).step_by(stride) {
                let next = contour[(i + 1) % contour.len()];
                let at = contour[i] + self.inward(next - contour[i]);
                ports.push((part, Port { foot: Foot::Ink(at), at, owner: Some(owner), onward: None }));
            }
        }
        for (number, curve) in work.frame.iter().enumerate() {
            let owner = Owner::Frame(number);
            let Some(part) = scene.part(owner) else { continue };
            for segment in curve.path.segments() {
                let count = (segment.arclen(0.1) / scene.spacing_mm).ceil().clamp(1.0, 64.0) as u32;
                for i in 0..count {
                    let p = segment.eval((f64::from(i) + 0.5) / f64::from(count));
                    let at = DVec2::new(p.x, p.y);
                    ports.push((part, Port { foot: Foot::Ink(at), at, owner: Some(owner), onward: None }));
                }
            }
        }
        ports
    }

    /// From an outline into the ink on its left, so that a round end there holds.
    fn inward(&self, along: DVec2) -> DVec2 {
        along.perp().normalize_or_zero() * self.scene.work.pen_mm / 4.0
    }

    /// The place of a line that is nearest to `p`.
    pub(super) fn landing(&self, line: &Line, p: DVec2) -> Port {
        let work = &self.scene.work;
        let (at, t) = line.nearest(p);
        let inked = |at: DVec2| Port { foot: Foot::Ink(at), at, owner: Some(line.owner), onward: None };
        match line.owner {
            Owner::Edge(edge) => {
                let ends = work.edges[edge].ends;
                let off = |end: usize| work.area.way(at, work.samples[end].at).length();
                let near = if off(ends[0]) <= off(ends[1]) { ends[0] } else { ends[1] };
                let passes = self.scene.by_sample[near].len() == 2;
                let snap_pens = if passes { PASSING_SNAP_PENS } else { SNAP_PENS };
                if off(near) < snap_pens * work.pen_mm {
                    return self.scene.port(near);
                }
                // Not so near to an end that a part of no length would be left.
                let foot = Foot::Edge(edge, t.clamp(0.01, 0.99));
                Port { foot, at: point_at(&work.cubic(edge), t.clamp(0.01, 0.99)), owner: None, onward: None }
            }
            Owner::Contour(_) => inked(at + self.inward(line.to - line.from)),
            Owner::Frame(_) => inked(at),
        }
    }
}

impl Scene<'_> {
    /// Whether a part has ink of elements or of the frame.
    pub fn has_solid(&self, part: usize) -> bool {
        let contours = self.work.elements.iter().map(|element| element.contours.len()).sum::<usize>();
        (0..contours)
            .map(Owner::Contour)
            .chain((0..self.work.frame.len()).map(Owner::Frame))
            .any(|owner| self.part(owner) == Some(part))
    }
}
