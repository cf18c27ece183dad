//! One change of a pattern, planned and carried out.

use glam::DVec2;

use super::lines::Owner;
use super::scene::Scene;
use super::work::{Foot, Work};
use super::{Change, ChangeKind};
use crate::samples::Area;
use crate::samples::border::stretches;
use crate::samples::cubic::Cubic;

/// What is done to the graph.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Act {
    /// Edges one after the other between two feet: where they meet, and the handles of their curves, of which there is one more.
    Add { feet: [Foot; 2], corners: Vec<DVec2>, handles: Vec<[DVec2; 2]> },
    /// Edges taken away.
    Remove(Vec<usize>),
}

/// Whether a stroke of curves that go on in one another stays in an area with its middle line; its two ends may be at the border.
pub(super) fn is_inside(cubics: &[Cubic], area: &Area) -> bool {
    let last = cubics.len() - 1;
    cubics.iter().enumerate().all(|(i, cubic)| match stretches(cubic, area)[..] {
        [[from, until]] => (from == 0.0 || i == 0) && (until == 1.0 || i == last),
        _ => false,
    })
}

/// A change, and how to make it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step {
    pub change: Change,
    pub act: Act,
}

impl Step {
    /// A step that adds a stroke along `link`.
    pub fn add(kind: ChangeKind, link: &Link, confidence: Option<f64>) -> Self {
        let step = Self::along(kind, [link.from.foot, link.to.foot], &[link.cubic]);
        Self { change: Change { confidence, ..step.change }, ..step }
    }

    /// A step that adds a stroke of one or more curves, each of which begins where the one before ends.
    pub fn along(kind: ChangeKind, feet: [Foot; 2], cubics: &[Cubic]) -> Self {
        let (from_mm, to_mm) = (cubics[0][0], cubics[cubics.len() - 1][3]);
        let corners = cubics[1..].iter().map(|cubic| cubic[0]).collect();
        let handles = cubics.iter().map(|&[a, p, q, b]| [p - a, q - b]).collect();
        let change = Change { kind, from_mm, to_mm, confidence: None };
        Self { change, act: Act::Add { feet, corners, handles } }
    }

    /// A step that takes edges away, from one end of them to the other.
    pub fn remove(kind: ChangeKind, edges: Vec<usize>, work: &Work) -> Self {
        let ends = edges.iter().flat_map(|&edge| work.edges[edge].ends);
        let mut outer: Vec<usize> = Vec::new();
        for end in ends {
            match outer.iter().position(|&known| known == end) {
                Some(known) => drop(outer.swap_remove(known)),
                None => outer.push(end),
            }
        }
        let at = |i: usize| {
            outer.get(i).map_or(work.samples[work.edges[edges[0]].ends[i % 2]].at, |&s| work.samples[s].at)
        };
        let confidence = edges.iter().map(|&edge| work.edges[edge].confidence).fold(f64::INFINITY, f64::min);
        let (from_mm, to_mm) = (at(0), at(outer.len().max(2) - 1));
        Self {
            change: Change { kind, from_mm, to_mm, confidence: Some(confidence) },
            act: Act::Remove(edges),
        }
    }

    /// Makes the change; whether there was anything to do.
    pub fn carry_out(&self, work: &mut Work) -> bool {
        match &self.act {
            Act::Add { feet: [from, to], corners, handles } => {
                let confidence = self.change.confidence.unwrap_or(0.0);
                let mut at = work.sample_at(*from);
                let feet = corners.iter().map(|&corner| Foot::Ink(corner)).chain([*to]);
                let mut is_new = false;
                for (foot, &handles) in feet.zip(handles) {
                    let next = work.sample_at(foot);
                    is_new |= work.add(at, next, handles, confidence).is_some();
                    at = next;
                }
                is_new
            }
            // What is trimmed is not to come back by its votes.
            Act::Remove(edges) if self.change.kind == ChangeKind::Trim => {
                edges.iter().for_each(|&edge| drop(work.trim(edge)));
                true
            }
            Act::Remove(edges) => {
                edges.iter().for_each(|&edge| work.remove(edge));
                true
            }
        }
    }
}

/// A place at the ink from which a stroke may go.
#[derive(Debug, Clone)]
pub(super) struct Port {
    pub foot: Foot,
    pub at: DVec2,
    /// Whose ink it is, where it is no sample's.
    pub owner: Option<Owner>,
    /// The direction in which a path goes on that ends there in the open.
    pub onward: Option<DVec2>,
}

impl Port {
    /// Whether a path that ends there goes on along `way`, turning by an angle with at least this cosine; elsewhere any way is as good.
    pub fn points_along(&self, way: DVec2, least_cosine: f64) -> bool {
        self.onward.is_none_or(|onward| onward.dot(way) > least_cosine * way.length())
    }
}

/// A stroke that may be added.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub from: Port,
    pub to: Port,
    pub cubic: [DVec2; 4],
}

/// A path goes on smoothly into a stroke that turns from it by less than this: the cosine of 60 degrees. With less, an end that turns makes
/// a corner in the open; with more, a hook.
pub(super) const SMOOTH: f64 = 0.5;
/// What the turn of an end counts: one by 60 degrees makes a stroke count 1.75 times as long, one by 90 degrees 2.5 times.
const TURN: f64 = 1.5;
/// What a stroke counts at a place that is no end, and at one where paths meet already: there it would look like one of them that goes on.
const SIDE: f64 = 1.5;
const JUNCTION: f64 = 2.0;

impl Link {
    /// A stroke that continues the paths that end at its feet, if it need not turn too much.
    pub fn smooth(scene: &Scene, from: &Port, to: &Port) -> Self {
        let way = scene.work.area.way(from.at, to.at);
        let length = way.length();
        let third = |onward: Option<DVec2>, way: DVec2| {
            let smooth = onward.filter(|onward| onward.dot(way) > SMOOTH * length);
            smooth.map_or(way / 3.0, |onward| onward * length / 3.0)
        };
        let end = from.at + way;
        let cubic = [from.at, from.at + third(from.onward, way), end + third(to.onward, -way), end];
        Self { from: from.clone(), to: to.clone(), cubic }
    }

    /// The same as a straight stroke.
    pub fn straightened(mut self) -> Self {
        let [a, _, _, b] = self.cubic;
        self.cubic = [a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b];
        self
    }

    /// Its length, counted more where it is not how a maker would go on: from and to ends in the open, straight ahead.
    pub fn cost(&self, scene: &Scene) -> f64 {
        let [a, _, _, b] = self.cubic;
        let factor = |port: &Port, way: DVec2| match (port.onward, port.foot) {
            (Some(onward), _) => 1.0 + TURN * (1.0 - onward.dot(way.normalize_or_zero())),
            (None, Foot::Sample(sample)) if scene.by_sample[sample].len() > 2 => JUNCTION,
            (None, _) => SIDE,
        };
        a.distance(b) * factor(&self.from, b - a) * factor(&self.to, a - b)
    }

    /// Whether its middle line stays in the area.
    pub fn is_inside(&self, scene: &Scene) -> bool {
        let [a, .., b] = self.cubic;
        // The feet are ink already, and those at the frame are on the border.
        let foot = scene.work.pen_mm / a.distance(b).max(scene.work.pen_mm);
        match stretches(&self.cubic, scene.work.area)[..] {
            [[from, until]] => from <= foot && until >= 1.0 - foot,
            _ => false,
        }
    }
}

impl Scene<'_> {
    /// The port at a sample of a curve.
    pub fn port(&self, sample: usize) -> Port {
        let onward = self.free_end(sample).map(|edge| self.work.onward(sample, edge));
        Port { foot: Foot::Sample(sample), at: self.work.samples[sample].at, owner: None, onward }
    }
}
