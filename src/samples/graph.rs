//! Samples and their edges: what a pattern is while it is being synthesized (Tu 2020 §4.1).
//!
//! A flat structure instead of a graph library's: samples are removed and added between iterations by the hundred, indices are keys of
//! the search's arrays, and nothing but the neighbours of a sample is ever asked for.

use glam::DVec2;

use super::area::Area;
use super::cubic::Cubic;

/// What a sample stands for: its id q(s) and its class (Tu 2020 Table 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// A point of a curve: q(s) = -1.
    Curve,
    /// The point number `point` of an element of the class `class`; samples of a curve match no others, and these only their own.
    Element {
        /// Elements that are alike are of one class.
        class: u32,
        /// The place in the element, the same in all elements of the class: q(s).
        point: u32,
    },
}

/// A sample s: u(s) = (p(s), a(s), i(s)) of Tu 2020 Eq. 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its position p(s) in millimetres, y up.
    pub at: DVec2,
    /// What it stands for.
    pub kind: Kind,
    /// Directions in which paths leave it, o(s), in radians from 0 to 2π; in the exemplar as many as it has edges.
    pub orientations: Vec<f64>,
    /// The width of the pen there, in millimetres; 0 for an element.
    pub width_mm: f64,
    /// The confidence i(s) from 0 to 1 that there is such a sample.
    pub existence: f64,
    /// Whether it was given by the maker: it is never moved, removed or left unmatched.
    pub is_given: bool,
    /// The element that it belongs to, numbered through the pattern; 0 for a curve.
    pub element: u32,
}

/// An edge between two samples of curves: a stretch of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The numbers of its samples, which differ, the smaller first.
    pub ends: [usize; 2],
    /// The vote ī(e) from 0 to 1 that there is such an edge; infinite for what the maker gave.
    pub confidence: f64,
    /// From each end to the control point of the cubic Bézier curve that belongs to it, in millimetres. The exemplar's are voted on with
    /// the edge, which keeps bends that are finer than the spacing; Tu 2020 §4.4.2 has directions only.
    pub handles: [DVec2; 2],
}

impl Edge {
    /// The cubic Bézier curve from its first sample the short way to its second.
    pub(super) fn cubic(&self, samples: &[Sample], area: &Area) -> Cubic {
        let [a, b] = self.ends.map(|end| samples[end].at);
        let to = a + area.way(a, b);
        [a, a + self.handles[0], to + self.handles[1], to]
    }

    /// Whether it was given by the maker: it is never taken away.
    pub fn is_given(&self) -> bool {
        self.confidence == f64::INFINITY
    }
}

/// A sample graph.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Graph {
    /// All samples.
    pub samples: Vec<Sample>,
    /// The edges that there are, each pair of samples at most once.
    pub edges: Vec<Edge>,
    /// Edges that were voted for and that there are not, the most confident first.
    pub unrealised: Vec<Edge>,
}

/// The numbers of those that stay when the others go; `usize::MAX` for the others.
pub fn renumbered(stays: &[bool]) -> Vec<usize> {
    let number = |next: &mut usize, stays: &bool| {
        *next += usize::from(*stays);
        Some(if *stays { *next - 1 } else { usize::MAX })
    };
    stays.iter().scan(0, number).collect()
}

/// For each sample its edges: the number of the edge, and of the sample at its other end.
#[derive(Debug, Clone, Default)]
pub struct Adjacency {
    starts: Vec<usize>,
    entries: Vec<(usize, usize)>,
}

impl Graph {
    /// The edges by their samples, in ascending order of their numbers.
    pub fn adjacency(&self) -> Adjacency {
        let mut starts = vec![0; self.samples.len() + 1];
        for end in self.edges.iter().flat_map(|edge| edge.ends) {
            starts[end + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0); 2 * self.edges.len()];
        for (number, edge) in self.edges.iter().enumerate() {
            for (end, other) in [(edge.ends[0], edge.ends[1]), (edge.ends[1], edge.ends[0])] {
                entries[next[end]] = (number, other);
                next[end] += 1;
            }
        }
        Adjacency { starts, entries }
    }
}

impl Graph {
    /// Keeps those samples for which `stays` is true, and the edges between them.
    pub fn keep(&mut self, stays: &[bool]) {
        let number_of = renumbered(stays);
        let mut kept = stays.iter();
        self.samples.retain(|_| *kept.next().expect("one for each sample"));
        for edges in [&mut self.edges, &mut self.unrealised] {
            edges.retain_mut(|edge| {
                edge.ends = edge.ends.map(|end| number_of[end]);
                edge.ends[1] != usize::MAX && edge.ends[0] != usize::MAX
            });
        }
    }
}

impl Adjacency {
    /// The edges of a sample: their numbers, and the samples at their other ends.
    pub fn of(&self, sample: usize) -> &[(usize, usize)] {
        &self.entries[self.starts[sample]..self.starts[sample + 1]]
    }

    /// |E(s)|: how many edges a sample has.
    pub fn degree(&self, sample: usize) -> usize {
        self.starts[sample + 1] - self.starts[sample]
    }
}
