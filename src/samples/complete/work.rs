//! The pattern while it is being completed: a graph of which edges may be cut, split and added, with their numbers unchanged.

use std::collections::BTreeMap;

use glam::DVec2;

use super::CompleteOptions;
use super::frame::frame;
use crate::planar::{GridError, Region};
use crate::samples::cubic::{Cubic, halves, point_at};
use crate::samples::ink::CountingPlane;
use crate::samples::{
    Area, Curve, Drawing, Edge, Element, Graph, Kind, Options, Reconstruction, Sample, Without, reconstruct,
};

/// Where an edge that is added ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Foot {
    /// At a sample.
    Sample(usize),
    /// At a new sample on an edge, by the parameter of its curve.
    Edge(usize, f64),
    /// At a new sample that lies on the ink of an element or of the frame.
    Ink(DVec2),
}

/// Where there are only elements, the pen is their size divided by this.
const PENS_PER_ELEMENT: f64 = 6.0;

/// The pattern and what it is drawn in.
#[derive(Clone)]
pub(super) struct Work<'a> {
    pub samples: Vec<Sample>,
    /// All edges that there ever were; handles are as drawn.
    pub edges: Vec<Edge>,
    pub is_there: Vec<bool>,
    /// Edges that may be added, the most confident first: those that were voted for, and those that were taken away.
    pub unrealised: Vec<Edge>,
    pub elements: &'a [Element],
    pub area: &'a Area,
    /// How it is drawn: by the handles of its edges, however they were found.
    options: Options,
    pub completing: &'a CompleteOptions,
    /// Where its ink is counted.
    pub plane: CountingPlane,
    /// The strokes of the frame.
    pub frame: Vec<Curve>,
    /// The pen for what is added where there is none.
    pub pen_mm: f64,
    /// Edges that were split: where, and into which.
    split: BTreeMap<usize, (f64, [usize; 2])>,
}

impl<'a> Work<'a> {
    /// The pattern of a graph, drawn once, so that its curves are fixed from now on.
    pub fn new(
        graph: &'a Graph,
        elements: &'a [Element],
        area: &'a Area,
        options: &Options,
        completing: &'a CompleteOptions,
    ) -> Self {
        let mut samples = graph.samples.clone();
        for sample in samples.iter_mut().filter(|sample| sample.kind == Kind::Curve) {
            sample.width_mm = completing.stroke_mm.unwrap_or(sample.width_mm);
        }
        own_pens(&mut samples);
        let handles = reconstruct(graph, &[], area, options).handles;
        let edges =
            graph.edges.iter().zip(handles).map(|(edge, handles)| Edge { handles, ..*edge }).collect();
        let mut work = Self {
            samples,
            edges,
            is_there: vec![true; graph.edges.len()],
            unrealised: graph.unrealised.clone(),
            elements,
            area,
            options: Options { without: Without::default(), ..options.clone() },
            completing,
            plane: CountingPlane::of(area),
            frame: completing.frame_mm.map_or_else(Vec::new, |width_mm| frame(area, width_mm)),
            pen_mm: 0.0,
            split: BTreeMap::new(),
        };
        work.pen_mm = work.usual_pen();
        work
    }

    /// The width that is wanted, or else that of most samples, or else what suits the elements.
    fn usual_pen(&self) -> f64 {
        let widths = self.samples.iter().map(|sample| sample.width_mm).filter(|&width| width > 0.0);
        let size = |element: &Element| {
            let outline = element.contours.first().map_or(&[][..], Vec::as_slice);
            let low = outline.iter().fold(DVec2::INFINITY, |low, &p| low.min(p));
            let high = outline.iter().fold(DVec2::NEG_INFINITY, |high, &p| high.max(p));
            (high - low).min_element().max(0.0)
        };
        let of_elements = || {
            let sizes = self.elements.iter().map(size).sum::<f64>();
            sizes / self.elements.len().max(1) as f64 / PENS_PER_ELEMENT
        };
        let wanted = self.completing.stroke_mm.or_else(|| median(widths));
        wanted.unwrap_or_else(of_elements).max(4.0 * self.completing.chord_mm)
    }

    /// The numbers of the edges that there are.
    pub fn present(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.edges.len()).filter(|&edge| self.is_there[edge])
    }

    /// For each sample its edges.
    pub fn edges_by_sample(&self) -> Vec<Vec<usize>> {
        let mut by_sample = vec![Vec::new(); self.samples.len()];
        for edge in self.present() {
            self.edges[edge].ends.iter().for_each(|&end| by_sample[end].push(edge));
        }
        by_sample
    }

    /// The curve of an edge, from its first sample on.
    pub fn cubic(&self, edge: usize) -> Cubic {
        self.cubic_of(&self.edges[edge])
    }

    /// The curve of an edge that need not be one of the pattern's.
    pub fn cubic_of(&self, edge: &Edge) -> Cubic {
        edge.cubic(&self.samples, self.area)
    }

    /// About how long an edge is.
    pub fn length_mm(&self, edge: usize) -> f64 {
        let cubic = self.cubic(edge);
        let points = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| point_at(&cubic, t));
        points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// The width of an edge at its middle.
    pub fn width_mm(&self, edge: usize) -> f64 {
        self.edges[edge].ends.iter().map(|&end| self.samples[end].width_mm).sum::<f64>() / 2.0
    }

    /// The direction in which a path goes on that ends at a sample with the one edge `edge`.
    pub fn onward(&self, sample: usize, edge: usize) -> DVec2 {
        let end = usize::from(self.edges[edge].ends[1] == sample);
        -self.edges[edge].handles[end].normalize_or_zero()
    }

    /// Whether the maker gave an edge.
    pub fn is_given(&self, edge: usize) -> bool {
        self.edges[edge].is_given()
    }

    /// The sample at a foot, new where there is none.
    pub fn sample_at(&mut self, foot: Foot) -> usize {
        match foot {
            Foot::Sample(sample) => sample,
            Foot::Ink(at) => self.new_sample(at, self.pen_mm, false),
            Foot::Edge(edge, t) => match self.split.get(&edge) {
                Some(&(before, [first, second])) => match t < before {
                    true => self.sample_at(Foot::Edge(first, t / before)),
                    // Its curve comes back from the end.
                    false => self.sample_at(Foot::Edge(second, (1.0 - t) / (1.0 - before))),
                },
                None => self.split(edge, t),
            },
        }
    }

    fn new_sample(&mut self, at: DVec2, width_mm: f64, is_given: bool) -> usize {
        let kind = Kind::Curve;
        let at = self.area.home(at);
        self.samples.push(Sample {
            at,
            kind,
            orientations: Vec::new(),
            width_mm,
            existence: 1.0,
            is_given,
            element: 0,
        });
        self.samples.len() - 1
    }

    fn split(&mut self, edge: usize, t: f64) -> usize {
        let old = self.edges[edge];
        let (before, after) = halves(&self.cubic(edge), t);
        let middle = self.new_sample(before[3], self.width_mm(edge), self.is_given(edge));
        let first = Edge {
            ends: [old.ends[0], middle],
            handles: [before[1] - before[0], before[2] - before[3]],
            ..old
        };
        let second =
            Edge { ends: [old.ends[1], middle], handles: [after[2] - after[3], after[1] - after[0]], ..old };
        let numbers = [first, second].map(|part| {
            self.edges.push(part);
            self.is_there.push(self.is_there[edge]);
            self.edges.len() - 1
        });
        self.is_there[edge] = false;
        self.split.insert(edge, (t, numbers));
        middle
    }

    /// The number of the edge that is only this part of an edge that there is, which is split where the part begins and ends.
    pub fn part_of(&mut self, edge: usize, [from, until]: [f64; 2]) -> usize {
        let mut part = edge;
        if until < 1.0 {
            self.split(part, until);
            part = self.split[&part].1[0];
        }
        if from > 0.0 {
            self.split(part, from / until);
            part = self.split[&part].1[1];
        }
        part
    }

    /// Adds an edge with the handles of its curve at `from` and at `to`, and gives its number; none where there is one already.
    pub fn add(&mut self, from: usize, to: usize, handles: [DVec2; 2], confidence: f64) -> Option<usize> {
        let (ends, handles) = match from < to {
            true => ([from, to], handles),
            false => ([to, from], [handles[1], handles[0]]),
        };
        if from == to || self.present().any(|edge| self.edges[edge].ends == ends) {
            return None;
        }
        self.edges.push(Edge { ends, confidence, handles });
        self.is_there.push(true);
        Some(self.edges.len() - 1)
    }

    /// Takes an edge away, with all that it was split into, to be one that there is not: its votes are known still.
    pub fn remove(&mut self, edge: usize) {
        for gone in self.trim(edge) {
            let place = self.unrealised.partition_point(|other| other.confidence >= gone.confidence);
            self.unrealised.insert(place, gone);
        }
    }

    /// Takes an edge away for good, with all that it was split into, and gives what there was.
    pub fn trim(&mut self, edge: usize) -> Vec<Edge> {
        let mut gone = Vec::new();
        if self.is_there[edge] {
            gone.push(self.edges[edge]);
        }
        self.is_there[edge] = false;
        if let Some(&(_, parts)) = self.split.get(&edge) {
            parts.into_iter().for_each(|part| gone.extend(self.trim(part)));
        }
        gone
    }

    /// The graph as it is now. Samples that have lost their edges are still there, and draw nothing.
    pub fn graph(&self) -> Graph {
        let edges: Vec<Edge> = self.present().map(|edge| self.edges[edge]).collect();
        let mut samples = self.samples.clone();
        for sample in samples.iter_mut().filter(|sample| sample.kind == Kind::Curve) {
            sample.orientations.clear();
        }
        for edge in &edges {
            for (end, handle) in edge.ends.into_iter().zip(edge.handles) {
                samples[end].orientations.push(handle.to_angle().rem_euclid(std::f64::consts::TAU));
            }
        }
        Graph { samples, edges, unrealised: self.unrealised.clone() }
    }

    /// How it is drawn, with the frame.
    pub fn drawn(&self) -> Reconstruction {
        let mut drawn = reconstruct(&self.graph(), self.elements, self.area, &self.options);
        drawn.drawing.curves.extend(self.frame.iter().cloned());
        drawn
    }

    /// What a drawing of it covers, in the plane where it is counted.
    pub fn inked(&self, drawing: &Drawing) -> Result<Region, GridError> {
        self.plane.inked(drawing, self.area.region().grid(), self.completing.chord_mm)
    }
}

/// The one in the middle; of an even number, the larger one.
fn median(widths: impl Iterator<Item = f64>) -> Option<f64> {
    let mut widths: Vec<f64> = widths.collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied()
}

/// Gives samples of curves that were given the pen of most others: they are where strokes go on from ink that has a pen of its own.
fn own_pens(samples: &mut [Sample]) {
    let is_curve = |sample: &&Sample| sample.kind == Kind::Curve && !sample.is_given;
    let usual_mm = median(samples.iter().filter(is_curve).map(|sample| sample.width_mm));
    let Some(usual_mm) = usual_mm else { return };
    for sample in samples.iter_mut().filter(|sample| sample.kind == Kind::Curve && sample.is_given) {
        sample.width_mm = usual_mm;
    }
}
