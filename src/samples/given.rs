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

/// The clones by their places in the first lap.
///
/// # Errors
/// [`SampleError::Option`] for clones that lie over one another or over themselves, or whose middle is outside of the area.
pub(super) fn checked(clones: &[CloneBox], area: &Area) -> Result<Vec<CloneBox>, SampleError> {
    let clones: Vec<CloneBox> =
        clones.iter().map(|clone| CloneBox { to_mm: area.home(clone.to_mm), ..*clone }).collect();
    for (i, clone) in clones.iter().enumerate() {
        let to = clone.to_mm;
        if !area.contains(to) {
            let found = format!("copied to {:.2}, {:.2} mm, outside of the domain", to.x, to.y);
            return Err(refused(found, "a place whose middle is inside of it"));
        }
        if let Some(lap_mm) = area.lap_mm().filter(|&lap_mm| 2.0 * clone.half_mm.x > lap_mm) {
            let found = format!(
                "a box {:.2} mm wide, more than once round, which is {lap_mm:.2} mm",
                2.0 * clone.half_mm.x
            );
            return Err(refused(found, "a narrower box"));
        }
        let is_upon =
            |other: &CloneBox| area.way(other.to_mm, to).abs().cmplt(clone.half_mm + other.half_mm).all();
        if let Some(other) = clones[..i].iter().find(|&other| is_upon(other)) {
            let found = format!(
                "copied to {:.2}, {:.2} mm, over what is copied to {:.2}, {:.2} mm",
                to.x, to.y, other.to_mm.x, other.to_mm.y
            );
            return Err(refused(found, "places beside each other (positions are the middles of boxes)"));
        }
    }
    Ok(clones)
}

impl Given {
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
        let cubic = edge.cubic(samples, area);
        let places = (0..LOOKS).map(|i| point_at(&cubic, (i as f64 + 0.5) / LOOKS as f64));
        let upon = places.filter(|&p| laps(p, area).any(|p| around.contains(p))).count();
        edge.is_given() || (upon as f64) < UPON * LOOKS as f64
    });
}

/// A place as it lies in the first lap, and in those beside it, where ink may be drawn that goes over the seam.
fn laps(p: DVec2, area: &Area) -> impl Iterator<Item = DVec2> {
    let lap_mm = area.lap_mm();
    let beside = lap_mm.into_iter().flat_map(|lap_mm| [-lap_mm, lap_mm]);
    let home = area.home(p);
    std::iter::once(0.0).chain(beside).map(move |by| home + DVec2::new(by, 0.0))
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
    use crate::samples::area::tests::{rolled, square};
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
    fn strands_upon_ink_that_goes_over_a_seam_go_too() {
        let area = rolled(40.0, 40.0);
        let path = kurbo::BezPath::from_svg("M30 20H50").unwrap();
        let drawing = Drawing { curves: vec![Curve { path, width_mm: 3.0 }], elements: Vec::new() };
        let ink = inked(&drawing, area.region().grid(), 0.01).unwrap();
        let sample = |x: f64| curve_sample(DVec2::new(x, 20.0), 1.0);
        let edge = |a: usize, b: usize| Edge { ends: [a, b], confidence: 0.5, handles: [DVec2::ZERO; 2] };
        let mut graph = Graph {
            samples: [2.0, 8.0, 16.0, 22.0].map(sample).to_vec(),
            edges: vec![edge(0, 1), edge(2, 3)],
            unrealised: Vec::new(),
        };
        clear_of(&mut graph, &ink, &area);
        assert_eq!(graph.edges.iter().map(|edge| edge.ends).collect::<Vec<_>>(), [[2, 3]]);
    }

    #[test]
    fn copies_lie_side_by_side_however_their_place_is_named() {
        let clone = |x: f64, half: f64| CloneBox {
            from_mm: DVec2::ZERO,
            half_mm: DVec2::new(half, 4.0),
            to_mm: DVec2::new(x, 20.0),
        };
        let area = rolled(40.0, 40.0);
        let message = |clones: &[CloneBox]| checked(clones, &area).unwrap_err().to_string();
        let two = checked(&[clone(5.0, 4.0), clone(135.0, 4.0)], &area).unwrap();
        assert!((two[1].to_mm.x - 15.0).abs() < 1e-9, "{two:?}");
        assert!(message(&[clone(5.0, 4.0), clone(131.0, 4.0)]).contains("over what is copied to 5.00"));
        assert!(message(&[clone(5.0, 21.0)]).contains("more than once round"));
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
