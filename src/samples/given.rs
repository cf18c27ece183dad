//! What the maker gives: strokes and elements that stay, and places of the exemplar that go to places of the output (Tu 2020 §3).

use glam::DVec2;
use rustc_hash::{FxHashMap, FxHashSet};

use super::area::Area;
use super::copies::{CloneBox, Copies, refused};
use super::cubic::point_at;
use super::drawing::Drawing;
use super::elements::Elements;
use super::graph::{Graph, Kind};
use super::level::SampleError;
use super::neighbours::Buckets;
use super::sampling::{Resolution, sampled};
use crate::planar::Region;

/// What is given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// Strokes that are there and stay, in the area or beside it.
    pub drawing: Drawing,
    /// Boxes of the exemplar that are copied before anything else, and stay.
    pub clones: Vec<CloneBox>,
}

impl Given {
    /// Refuses clones that lie over one another, or whose middle is outside of the area.
    pub(super) fn check(&self, area: &Area) -> Result<(), SampleError> {
        for (i, clone) in self.clones.iter().enumerate() {
            let to = clone.to_mm;
            if !area.contains(to) {
                let found = format!("copied to {:.2}, {:.2} mm, outside of the domain", to.x, to.y);
                return Err(refused(found, "a place whose middle is inside of it"));
            }
            let reach =
                |other: &CloneBox| area.way(other.to_mm, to).abs().cmplt(clone.half_mm + other.half_mm).all();
            if let Some(other) = self.clones[..i].iter().find(|&other| reach(other)) {
                let found = format!(
                    "copied to {:.2}, {:.2} mm, over what is copied to {:.2}, {:.2} mm",
                    to.x, to.y, other.to_mm.x, other.to_mm.y
                );
                return Err(refused(found, "places beside each other (positions are the middles of boxes)"));
            }
        }
        Ok(())
    }

    /// What is drawn and what is copied, as samples that stay. Elements that are drawn are ink, and no part of the pattern; beside a pattern of
    /// elements alone, strokes are none either.
    pub(super) fn sampled(
        &self,
        copies: &Copies,
        elements: Elements,
        area: &Area,
        resolution: Resolution,
        has_curves: bool,
    ) -> Graph {
        let curves =
            self.drawing.curves.iter().chain(&copies.curves).filter(|_| has_curves).cloned().collect();
        let mut graph = sampled(&Drawing { curves, elements: Vec::new() }, &elements, resolution);
        for sample in &mut graph.samples {
            sample.is_given = true;
            sample.at = area.home(sample.at);
        }
        graph.edges.iter_mut().for_each(|edge| edge.confidence = f64::INFINITY);
        graph
    }
}

/// A stroke that has more than this part of itself in ink that was given, or within a part of a pen of it, is drawn there already.
const UPON: f64 = 0.7;
/// That part of a pen.
const BESIDE_PENS: f64 = 0.25;
/// Places of a stroke that are looked at.
const LOOKS: usize = 12;

/// Takes away edges that are drawn upon `ink`, which is there already: strands that the pattern has of its own there.
pub fn clear_of(graph: &mut Graph, ink: &Region, area: &Area) {
    let pen_mm = graph.samples.iter().filter(|s| !s.is_given).map(|s| s.width_mm).fold(0.0, f64::max);
    if ink.is_empty() || pen_mm == 0.0 {
        return;
    }
    let around = Area::new(ink.offset(BESIDE_PENS * pen_mm, BESIDE_PENS * BESIDE_PENS * pen_mm));
    let samples = &graph.samples;
    graph.edges.retain(|edge| {
        let [a, b] = edge.ends.map(|end| samples[end].at);
        let to = a + area.way(a, b);
        let cubic = [a, a + edge.handles[0], to + edge.handles[1], to];
        let places = (0..LOOKS).map(|i| point_at(&cubic, (i as f64 + 0.5) / LOOKS as f64));
        let upon = places.filter(|&p| around.contains(area.home(p))).count();
        edge.is_given() || (upon as f64) < UPON * LOOKS as f64
    });
}

/// Puts the curves of `given` in the place of those that were given at the level before; edges that led there lead to the nearest of the new ones.
pub(super) fn exchange(graph: &mut Graph, found: &mut Vec<Option<usize>>, given: Graph, area: &Area) {
    let first = graph.samples.len();
    if given.samples.is_empty() {
        return;
    }
    let points: Vec<DVec2> = given.samples.iter().map(|s| s.at).collect();
    let buckets = Buckets::new(&points, 1.0, Some(area));
    let mut instead: FxHashMap<usize, usize> = FxHashMap::default();
    for (s, sample) in graph.samples.iter().enumerate().filter(|(_, s)| is_given_curve(s)) {
        let nearest = buckets.nearest(sample.at, |_| true).expect("there are some");
        instead.insert(s, first + nearest.0);
    }
    graph.edges.retain(|edge| !edge.is_given());
    for edge in &mut graph.edges {
        let ends = edge.ends.map(|end| instead.get(&end).copied().unwrap_or(end));
        if ends[0] > ends[1] {
            edge.handles.reverse();
        }
        edge.ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    }
    graph.edges.sort_by_key(|edge| edge.ends);
    graph.edges.dedup_by_key(|edge| edge.ends);
    let there: FxHashSet<[usize; 2]> =
        given.edges.iter().map(|edge| edge.ends.map(|end| end + first)).collect();
    graph.edges.retain(|edge| edge.ends[0] != edge.ends[1] && !there.contains(&edge.ends));
    let stays: Vec<bool> =
        graph.samples.iter().map(|s| !is_given_curve(s)).chain(given.samples.iter().map(|_| true)).collect();
    graph.samples.extend(given.samples);
    graph.edges.extend(
        given
            .edges
            .into_iter()
            .map(|edge| super::graph::Edge { ends: edge.ends.map(|end| end + first), ..edge }),
    );
    found.extend(points.iter().map(|_| None));
    let mut kept = stays.iter();
    found.retain(|_| *kept.next().expect("one for each sample"));
    graph.keep(&stays);
}

fn is_given_curve(sample: &super::graph::Sample) -> bool {
    sample.is_given && sample.kind == Kind::Curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Curve;
    use crate::samples::area::tests::square;
    use crate::samples::graph::Edge;
    use crate::samples::ink::inked;
    use crate::samples::sampling::curve_sample;

    #[test]
    fn strands_upon_what_is_there_go_and_those_that_cross_it_stay() {
        let area = square(40.0);
        let path = kurbo::BezPath::from_svg("M2 20H38").unwrap();
        let drawing = Drawing { curves: vec![Curve { path, width_mm: 3.0 }], elements: Vec::new() };
        let ink = inked(&drawing, area.region().grid(), 0.01).unwrap();
        // Along it, beside it, across it, and on from its end.
        let ends = [
            [(4.0, 20.5), (14.0, 20.5)],
            [(4.0, 23.5), (14.0, 23.5)],
            [(20.0, 16.0), (20.0, 24.0)],
            [(36.0, 20.0), (36.0, 30.0)],
        ];
        let samples = ends.iter().flatten().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        let edge = |i: usize| Edge { ends: [2 * i, 2 * i + 1], confidence: 0.5, handles: [DVec2::ZERO; 2] };
        let mut graph = Graph { samples, edges: (0..4).map(edge).collect(), unrealised: Vec::new() };
        graph.edges.push(Edge { ends: [0, 2], confidence: f64::INFINITY, ..edge(0) });
        clear_of(&mut graph, &ink, &area);
        let left: Vec<[usize; 2]> = graph.edges.iter().map(|edge| edge.ends).collect();
        assert_eq!(left, [[2, 3], [4, 5], [6, 7], [0, 2]]);
    }

    #[test]
    fn edges_that_lead_to_what_is_given_lead_to_its_new_samples() {
        let area = square(40.0);
        let sample = |x: f64, is_given: bool| super::super::graph::Sample {
            is_given,
            ..curve_sample(DVec2::new(x, 5.0), 1.0)
        };
        let edge = |a: usize, b: usize, confidence: f64| Edge {
            ends: [a, b],
            confidence,
            handles: [DVec2::ZERO; 2],
        };
        let graph = |places: &[(f64, bool)], edges: Vec<Edge>| Graph {
            samples: places.iter().map(|&(x, is_given)| sample(x, is_given)).collect(),
            edges,
            unrealised: Vec::new(),
        };
        // A stroke that is given from 10 to 20, another at 30, one sample of the pattern, and an edge between the two strokes.
        let places = [(10.0, true), (20.0, true), (30.0, true), (35.0, false)];
        let mut coarse = graph(&places, vec![edge(0, 1, f64::INFINITY), edge(1, 2, 0.8), edge(2, 3, 0.9)]);
        let fine = graph(
            &[(10.0, true), (15.0, true), (20.0, true), (31.0, true)],
            vec![edge(0, 1, f64::INFINITY), edge(1, 2, f64::INFINITY)],
        );
        let mut found = vec![None; 4];
        exchange(&mut coarse, &mut found, fine, &area);
        let places: Vec<f64> = coarse.samples.iter().map(|s| s.at.x).collect();
        assert_eq!(places, [35.0, 10.0, 15.0, 20.0, 31.0]);
        let mut edges: Vec<([usize; 2], bool)> =
            coarse.edges.iter().map(|e| (e.ends, e.is_given())).collect();
        edges.sort_unstable();
        assert_eq!(edges, [([0, 4], false), ([1, 2], true), ([2, 3], true), ([3, 4], false)]);
        assert_eq!(found.len(), 5);
    }
}
