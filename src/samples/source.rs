//! The exemplar as the search sees it: its graph, its neighbourhoods, and which sample is nearest to a place.

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::graph::{Adjacency, Graph, Kind};
use super::neighbours::{Buckets, Neighbourhoods};

/// A neighbourhood that reaches over the exemplar's box lacks what would be there, so that its middle would suit the border of a gap. Middles are
/// therefore at least the radius inside, or this part of the box's shorter side if the box is too small for that.
const INSIDE: f64 = 0.3;

/// The exemplar at one level.
pub struct Source {
    /// Its samples and edges.
    pub graph: Graph,
    /// Its edges by samples.
    pub adjacency: Adjacency,
    /// What is near each sample.
    pub near: Neighbourhoods,
    /// Lower left and upper right corner of its samples, in millimetres.
    pub bounds_mm: (DVec2, DVec2),
    /// Of every kind, where samples are that may be the middle of a neighbourhood, and their numbers.
    middles: FxHashMap<Kind, (Vec<DVec2>, Vec<usize>)>,
    side_mm: f64,
}

/// Finds samples of one kind by place.
pub struct Finder<'a> {
    buckets: Buckets<'a>,
    numbers: &'a [usize],
}

impl Source {
    /// The exemplar with neighbourhoods of `radius_mm`.
    pub fn new(graph: Graph, bounds_mm: (DVec2, DVec2), radius_mm: f64) -> Self {
        let points: Vec<DVec2> = graph.samples.iter().map(|s| s.at).collect();
        let (low, high) = bounds_mm;
        let margin = radius_mm.min(INSIDE * (high - low).min_element());
        let is_inside = |p: DVec2| p.cmpge(low + margin).all() && p.cmple(high - margin).all();
        let mut all: FxHashMap<Kind, Vec<usize>> = FxHashMap::default();
        for (i, sample) in graph.samples.iter().enumerate() {
            all.entry(sample.kind).or_default().push(i);
        }
        let middles = all
            .into_iter()
            .map(|(kind, numbers)| {
                let inner: Vec<usize> = numbers.iter().copied().filter(|&i| is_inside(points[i])).collect();
                let numbers = if inner.is_empty() { numbers } else { inner };
                (kind, (numbers.iter().map(|&i| points[i]).collect(), numbers))
            })
            .collect();
        Self {
            adjacency: graph.adjacency(),
            near: Neighbourhoods::new(&points, radius_mm, None),
            graph,
            bounds_mm,
            middles,
            side_mm: radius_mm / 2.0,
        }
    }

    /// The samples of a kind that may be the middle of a neighbourhood.
    pub fn middles(&self, kind: Kind) -> &[usize] {
        self.middles.get(&kind).map_or(&[], |(_, numbers)| numbers)
    }

    /// What finds such samples by their places, for every kind.
    pub fn finders(&self) -> FxHashMap<Kind, Finder<'_>> {
        self.middles
            .iter()
            .map(|(&kind, (points, numbers))| {
                (kind, Finder { buckets: Buckets::new(points, self.side_mm, None), numbers })
            })
            .collect()
    }

    /// The place that lies `by` from a sample, or where the exemplar's box ends on the way.
    pub fn beside(&self, sample: usize, by: DVec2) -> DVec2 {
        let (low, high) = self.bounds_mm;
        (self.graph.samples[sample].at + by).clamp(low, high)
    }

    /// The longer side of its box, in millimetres.
    pub fn side_mm(&self) -> f64 {
        (self.bounds_mm.1 - self.bounds_mm.0).max_element()
    }
}

impl Finder<'_> {
    /// The sample that is nearest to a place.
    pub fn nearest(&self, p: DVec2) -> Option<usize> {
        self.buckets.nearest(p, |_| true).map(|(i, _)| self.numbers[i])
    }
}
