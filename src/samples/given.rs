//! What the maker gives: strokes and elements that stay, and places of the exemplar that go to places of the output (Tu 2020 §3).

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::area::Area;
use super::drawing::Drawing;
use super::elements::Elements;
use super::graph::Graph;
use super::level::SampleError;
use super::neighbours::Buckets;
use super::options::{Options, Start};
use super::sampling::{Resolution, sampled};
use super::start::CloneBox;

/// What is given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// Strokes that are there and stay, in the area or beside it.
    pub drawing: Drawing,
    /// Boxes of the exemplar that are copied before anything else.
    pub clones: Vec<CloneBox>,
}

impl Given {
    /// Refuses clones that would copy nothing.
    pub(super) fn check(
        &self,
        (low, high): (DVec2, DVec2),
        area: &Area,
        options: &Options,
    ) -> Result<(), SampleError> {
        let refuse = |found: String, wanted| Err(SampleError::Option { name: "--clone", found, wanted });
        for clone in &self.clones {
            let (from, to) = (clone.from_mm - clone.half_mm, clone.from_mm + clone.half_mm);
            if to.cmplt(low).any() || from.cmpgt(high).any() {
                let found = format!(
                    "from {:.2}, {:.2} to {:.2}, {:.2} mm, outside of the exemplar, which reaches from {:.2}, {:.2} to {:.2}, {:.2} mm",
                    from.x, from.y, to.x, to.y, low.x, low.y, high.x, high.y
                );
                return refuse(found, "a box of the exemplar");
            }
            if !area.contains(clone.to_mm) {
                let found =
                    format!("copied to {:.2}, {:.2} mm, outside of the domain", clone.to_mm.x, clone.to_mm.y);
                return refuse(found, "a place whose middle is inside of it");
            }
        }
        match self.clones.is_empty() || options.start == Start::Patches {
            true => Ok(()),
            false => {
                refuse("a copy beside --start noise".to_owned(), "--start patches, which lays copies first")
            }
        }
    }

    /// What is drawn, as samples that stay. Elements are ink, and no part of the pattern.
    pub(super) fn sampled(&self, elements: &Elements, resolution: Resolution) -> Graph {
        let none = Elements { classes: elements.classes.clone(), placed: Vec::new() };
        let mut graph = sampled(&self.drawing, &none, resolution);
        graph.samples.iter_mut().for_each(|sample| sample.is_given = true);
        graph
    }
}

/// Puts `given` in the place of what was given at the level before; edges that led there lead to the nearest of the new ones.
pub(super) fn exchange(graph: &mut Graph, found: &mut Vec<Option<usize>>, given: Graph, area: &Area) {
    let first = graph.samples.len();
    if given.samples.is_empty() {
        return;
    }
    let points: Vec<DVec2> = given.samples.iter().map(|s| s.at).collect();
    let buckets = Buckets::new(&points, 1.0, Some(area));
    let mut instead: FxHashMap<usize, usize> = FxHashMap::default();
    for (s, sample) in graph.samples.iter().enumerate().filter(|(_, s)| s.is_given) {
        let nearest = buckets.nearest(sample.at, |_| true).expect("there are some");
        instead.insert(s, first + nearest.0);
    }
    let samples = &graph.samples;
    graph.edges.retain(|edge| !edge.ends.iter().all(|&end| samples[end].is_given));
    for edge in &mut graph.edges {
        let ends = edge.ends.map(|end| instead.get(&end).copied().unwrap_or(end));
        if ends[0] > ends[1] {
            edge.handles.reverse();
        }
        edge.ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    }
    graph.edges.sort_by_key(|edge| edge.ends);
    graph.edges.dedup_by_key(|edge| edge.ends);
    let stays: Vec<bool> =
        graph.samples.iter().map(|s| !s.is_given).chain(given.samples.iter().map(|_| true)).collect();
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
