//! The border of the area: the pattern is synthesized a little beyond it and cut there.
//!
//! Neighbourhoods at a border are halves, and the last samples of a strand are anywhere near it. Beyond the border neither matters. Excluded: cutting
//! elements, which are whole or are not there.

use super::area::Area;
use super::cubic::{Cubic, halves, point_at};
use super::elements::Elements;
use super::graph::{Edge, Graph, Kind, Sample, renumbered};
use crate::planar::Sets;

/// Bisections that find where an edge crosses the border.
const BISECTIONS: usize = 40;
/// Nearer to the border than this part of the length of a scrap, an end was cut there.
const ON_BORDER: f64 = 1e-6;
/// Parts of an edge that are looked at for crossings of the border.
const PARTS: usize = 16;

/// Cuts the graph at the border of `area`: samples outside go, edges to them end in a new sample on the border. Elements whose ink is not wholly
/// inside go too, and scraps of less than `least_mm` that are cut off. What was given stays where it is.
pub fn cut(graph: &mut Graph, elements: &mut Elements, area: &Area, least_mm: f64) {
    let element_stays: Vec<bool> = elements
        .placed
        .iter()
        .map(|placed| {
            let drawn = elements.classes[placed.class as usize].drawn(&placed.similarity);
            drawn.iter().flatten().all(|&p| area.contains(p))
        })
        .collect();
    let inside: Vec<bool> = graph
        .samples
        .iter()
        .map(|s| match s.kind {
            Kind::Curve => s.is_given || area.contains(s.at),
            Kind::Element { .. } => element_stays[s.element as usize],
        })
        .collect();
    let mut stubs: Vec<(Sample, Edge)> = Vec::new();
    let first = graph.samples.len();
    for edge in &graph.edges {
        let (a, b) = match edge.ends.map(|end| inside[end]) {
            [true, false] => (0, 1),
            [false, true] => (1, 0),
            _ => continue,
        };
        let (kept, lost) = (&graph.samples[edge.ends[a]], &graph.samples[edge.ends[b]]);
        let cubic = [
            kept.at,
            kept.at + edge.handles[a],
            kept.at + area.way(kept.at, lost.at) + edge.handles[b],
            kept.at + area.way(kept.at, lost.at),
        ];
        let t = exit(&cubic, area);
        if t <= 0.0 {
            continue;
        }
        let ([_, h1, h2, end], _) = halves(&cubic, t);
        let sample = Sample {
            at: area.home(end),
            orientations: vec![(h2 - end).to_angle().rem_euclid(std::f64::consts::TAU)],
            is_given: false,
            ..kept.clone()
        };
        let ends = [edge.ends[a], first + stubs.len()];
        stubs.push((sample, Edge { ends, confidence: edge.confidence, handles: [h1 - kept.at, h2 - end] }));
    }
    let mut stays = inside;
    for (sample, edge) in stubs {
        graph.samples.push(sample);
        graph.edges.push(edge);
        stays.push(true);
    }
    graph.keep(&stays);
    drop_scraps(graph, area, least_mm);
    let number_of = renumbered(&element_stays);
    for sample in graph.samples.iter_mut().filter(|s| s.kind != Kind::Curve) {
        sample.element = number_of[sample.element as usize] as u32;
    }
    let mut kept = element_stays.iter();
    elements.placed.retain(|_| *kept.next().expect("one for each element"));
}

/// Takes away what the border cut off in less than `least_mm` of line, and samples that are alone, which draw nothing.
fn drop_scraps(graph: &mut Graph, area: &Area, least_mm: f64) {
    let n = graph.samples.len();
    let mut sets = Sets::new(n);
    graph.edges.iter().for_each(|edge| sets.join(edge.ends[0], edge.ends[1]));
    let (mut lengths, mut is_cut) = (vec![0.0; n], vec![false; n]);
    for edge in &graph.edges {
        let [a, b] = edge.ends.map(|end| graph.samples[end].at);
        lengths[sets.find(edge.ends[0])] += area.way(a, b).length();
    }
    for s in 0..n {
        if area.depth_mm(graph.samples[s].at) < ON_BORDER * least_mm {
            is_cut[sets.find(s)] = true;
        }
    }
    let stays: Vec<bool> = (0..n)
        .map(|s| {
            let (sample, set) = (&graph.samples[s], sets.find(s));
            let is_scrap = lengths[set] == 0.0 || (is_cut[set] && lengths[set] < least_mm);
            sample.kind != Kind::Curve || sample.is_given || !is_scrap
        })
        .collect();
    graph.keep(&stays);
}

/// The last parameter before a cubic leaves the area for the first time; its beginning is inside.
fn exit(cubic: &Cubic, area: &Area) -> f64 {
    let is_inside = |t: f64| area.contains(point_at(cubic, t));
    let out = (1..=PARTS).map(|i| i as f64 / PARTS as f64).find(|&t| !is_inside(t)).unwrap_or(1.0);
    let (mut low, mut high) = (out - 1.0 / PARTS as f64, out);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if is_inside(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::samples::area::tests::square;
    use crate::samples::sampling::curve_sample;

    #[test]
    fn edges_end_on_the_border_and_scraps_go() {
        let points = [(5.0, 5.0), (13.0, 5.0), (9.0, 9.5), (12.0, 11.0), (2.0, 2.0)];
        let samples = points.iter().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        let edge = |a: usize, b: usize, h: DVec2| Edge { ends: [a, b], confidence: 1.0, handles: [h, -h] };
        let edges = vec![edge(0, 1, DVec2::X), edge(2, 3, DVec2::new(1.0, 0.5))];
        let mut graph = Graph { samples, edges, unrealised: Vec::new() };
        cut(&mut graph, &mut Elements::default(), &square(10.0), 2.0);
        // The long edge is cut at x = 10; what is left of the short one is a scrap, and a sample alone draws nothing.
        assert_eq!((graph.samples.len(), graph.edges.len()), (2, 1));
        let end = graph.samples[graph.edges[0].ends[1]].at;
        assert!(end.distance(DVec2::new(10.0, 5.0)) < 1e-6 && square(10.0).contains(end), "{end}");
    }
}
