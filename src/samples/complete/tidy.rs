//! What a maker would do before counting anything: ends that almost meet are joined, and stray twigs go.

use std::collections::BTreeSet;

use glam::DVec2;

use super::ChangeKind;
use super::beside::is_grazing;
use super::lines::{Lines, Run};
use super::scene::Scene;
use super::step::{Link, Port, Step};

/// Ends are joined that turn by less than this: the cosine of 35 degrees. With less, ends bend towards each other in hooks.
const AHEAD: f64 = 0.82;
/// An end goes on to the frame where it turns by less than this: the cosine of 55 degrees, so that one that runs along it can go on by 45.
const FAIR: f64 = 0.57;
/// Ends with less than this many pens between their middle and the frame go on to it though they run along it.
const NEAR_PENS: f64 = 1.35;
/// A twig is shorter than so many pens.
const TWIG_PENS: f64 = 1.2;
/// Ends that point at each other are joined across this many spacings while there are too many of them. With less, the gaps that the exemplar
/// itself has are never closed, and where the output has more of them they stay.
const REACH_SPACINGS: f64 = 2.0;
/// Across more than this part of a spacing, two strokes that were never one become one, which is only done while ends are too many by more than
/// `MANY`.
const NEAR_SPACINGS: f64 = 0.6;
/// So many times as many ends as there should be are many.
const MANY: f64 = 1.04;

/// What is done to a scene before its components and holes are counted. Ends are joined and twigs taken away until there are only
/// `ends_wanted` ends in the open, as in the exemplar.
pub(super) fn tidied(scene: &Scene) -> Vec<Step> {
    let completing = scene.work.completing;
    let mut tidy = Tidy {
        scene,
        lines: Lines::new(&scene.work),
        open: scene.free_ends().into_iter().map(|(sample, _)| sample).collect(),
        inside: 0,
        steps: Vec::new(),
    };
    tidy.inside = tidy.open.iter().filter(|&&end| tidy.is_inside(end)).count();
    if let Some(frame_mm) = completing.frame_mm {
        tidy.join_frame(frame_mm);
    }
    if completing.joins_ends {
        tidy.join_voted();
        tidy.join_pointing();
    }
    if completing.removes_twigs {
        tidy.remove_twigs();
    }
    tidy.steps
}

struct Tidy<'s, 'a> {
    scene: &'s Scene<'a>,
    /// With what has been added.
    lines: Lines,
    /// Samples at which paths end in the open.
    open: BTreeSet<usize>,
    /// How many of them dangle: at the border the exemplar's ends are cut as well, and do not count.
    inside: usize,
    steps: Vec<Step>,
}

impl Tidy<'_, '_> {
    fn is_enough(&self) -> bool {
        self.inside <= self.scene.work.completing.ends_wanted.unwrap_or(0)
    }

    /// Whether ends are too many to leave any that could be joined.
    fn is_many(&self) -> bool {
        let wanted = self.scene.work.completing.ends_wanted.unwrap_or(0);
        self.inside as f64 > MANY * wanted as f64
    }

    fn is_inside(&self, end: usize) -> bool {
        let work = &self.scene.work;
        work.area.depth_mm(work.samples[end].at) > work.pen_mm
    }

    fn close(&mut self, ends: &[usize]) {
        for &end in ends {
            self.inside -= usize::from(self.open.remove(&end) && self.is_inside(end));
        }
    }

    /// Adds a link if it runs clear, and closes its ends.
    fn link(&mut self, kind: ChangeKind, link: Link, confidence: Option<f64>, ends: &[usize]) {
        let (scene, pen_mm) = (self.scene, self.scene.work.pen_mm);
        let mut own = scene.own(link.from.foot, link.from.owner);
        own.extend(scene.own(link.to.foot, link.to.owner));
        for link in [link.clone(), link.straightened()] {
            let run =
                self.lines.run(&link.cubic, pen_mm / 2.0, scene.margin_mm(), |owner| own.contains(&owner));
            if run != Run::Blocked && link.is_inside(scene) {
                self.lines.add(&link.cubic, pen_mm / 2.0, usize::MAX);
                self.close(ends);
                self.steps.push(Step::add(kind, &link, confidence));
                return;
            }
        }
    }

    /// Ends near the frame go on to it, if they need not turn much: others stay, as a hook would come of it.
    fn join_frame(&mut self, frame_mm: f64) {
        let (scene, work) = (self.scene, &self.scene.work);
        for end in self.open.clone() {
            let from = scene.port(end);
            let depth_mm = work.area.depth_mm(from.at);
            // An end that runs along the frame and near it goes on ahead, and meets it at half a right angle.
            let ahead = work.area.nearest(from.at + from.onward.unwrap_or_default() * depth_mm);
            let nearest = work.area.nearest(from.at);
            let is_fair = |at: DVec2| from.points_along(at - from.at, FAIR);
            let at = match depth_mm < 0.5 * frame_mm + NEAR_PENS * work.pen_mm {
                true => [nearest, ahead].into_iter().find(|&at| is_fair(at)),
                false => Some(nearest).filter(|&at| is_fair(at)),
            };
            let Some(at) = at else { continue };
            if depth_mm < scene.spacing_mm {
                let near = self.lines.near(at, 0.0);
                let Some(owner) = near
                    .iter()
                    .map(|(_, line)| line.owner)
                    .find(|owner| matches!(owner, super::lines::Owner::Frame(_)))
                else {
                    continue;
                };
                let to = Port { foot: super::work::Foot::Ink(at), at, owner: Some(owner), onward: None };
                self.link(ChangeKind::Join, Link::smooth(scene, &from, &to), None, &[end]);
            }
        }
    }

    /// Edges that were voted for and would close an end.
    fn join_voted(&mut self) {
        let scene = self.scene;
        for edge in &scene.work.unrealised {
            if edge.confidence < scene.work.completing.least_confidence || self.is_enough() {
                return;
            }
            if edge.ends.iter().any(|end| self.open.contains(end)) {
                let [from, to] = edge.ends.map(|end| scene.port(end));
                let has_other = edge.ends.iter().all(|&end| !scene.by_sample[end].is_empty());
                let way = scene.work.area.way(from.at, to.at);
                // An end that would have to turn back makes a hook.
                let goes_on = from.points_along(way, AHEAD) && to.points_along(-way, AHEAD);
                let link = Link::smooth(scene, &from, &to);
                if has_other && goes_on && !is_grazing(&scene.work, &link.cubic) {
                    self.link(ChangeKind::Join, link, Some(edge.confidence), &edge.ends);
                }
            }
        }
    }

    /// Pairs of ends that point at each other and are near, the nearest first.
    fn join_pointing(&mut self) {
        let scene = self.scene;
        let reach_mm = scene.work.completing.reach_mm.unwrap_or(REACH_SPACINGS * scene.spacing_mm);
        let mut pairs = Vec::new();
        let open: Vec<usize> = self.open.iter().copied().collect();
        for (i, &a) in open.iter().enumerate() {
            for &b in &open[..i] {
                let [p, q] = [a, b].map(|end| scene.work.samples[end].at);
                let way = scene.work.area.way(p, q);
                if way.length() >= reach_mm {
                    continue;
                }
                let (from, to) = (scene.port(a), scene.port(b));
                let link = Link::smooth(scene, &to, &from);
                let goes_on = from.points_along(way, AHEAD) && to.points_along(-way, AHEAD);
                if goes_on && !is_grazing(&scene.work, &link.cubic) {
                    pairs.push((way.length(), [b, a], link));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (way_mm, ends, link) in pairs {
            let is_far = way_mm > NEAR_SPACINGS * scene.spacing_mm;
            if is_far && !self.is_many() {
                return;
            }
            if !self.is_enough() && ends.iter().all(|end| self.open.contains(end)) {
                self.link(ChangeKind::Join, link, None, &ends);
            }
        }
    }

    /// Twigs: short edges from where other paths pass to an end in the open.
    fn remove_twigs(&mut self) {
        let (scene, work) = (self.scene, &self.scene.work);
        for end in self.open.clone() {
            let [edge] = scene.by_sample[end][..] else { continue };
            let [a, b] = work.edges[edge].ends;
            let foot = if end == a { b } else { a };
            let is_twig =
                work.length_mm(edge) < TWIG_PENS * work.width_mm(edge) && scene.by_sample[foot].len() > 2;
            if is_twig && !work.is_given(edge) && !self.is_enough() {
                self.close(&[end]);
                self.steps.push(Step::remove(ChangeKind::Trim, vec![edge], work));
            }
        }
    }
}
