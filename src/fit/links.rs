//! The vertices of a piece, and what holds them together.
//!
//! Each contour of a piece is a row of nodes, long edges divided. Two kinds of links join them: along the contours,
//! and across from one contour to another where a Delaunay triangulation of all nodes says that they are
//! neighbours. The links across keep the two sides of a strand, and the strands beside each other, in step, and
//! carry along the islands and holes inside. How much a link weighs follows from one rule: the energy is an integral
//! along the contours, of which a link across stands for the share that its two ends have, and what is near weighs
//! more. Excluded: links from which nothing follows, between two nodes of one straight or gently bent stretch of
//! contour, which a triangulation has plenty of.

use std::ops::Range;

use glam::DVec2;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::pieces::Piece;

/// Edges are divided until none is longer than this part of half the girth of the piece's box. Longer, and bends
/// have nowhere to happen; shorter, and systems grow for nothing.
const LONGEST_EDGE: f64 = 1.0 / 48.0;
/// Lengths count as at least this part of the longest edge, so that no weight outgrows the others by more than
/// floats can bear.
const LEAST_LENGTH: f64 = 1e-3;
/// The weight of links across ink, against 1 along a contour. More, and strands are stiffer across than along, so
/// that a change of thickness happens at once, as a bump; less, and the sides of a strand part.
const ACROSS_INK: f64 = 0.1;
/// The weight of links across gaps. More, and a strand drags its neighbour along; less, and they may meet.
const ACROSS_GAP: f64 = 0.03;
/// A chord between nodes of one contour is a link only if it is shorter than this part of the way along.
const SHORT_CUT: f64 = 0.7;

/// A pull between two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    pub(super) from: usize,
    pub(super) to: usize,
    /// In 1/mm.
    pub(super) weight: f64,
}

/// The nodes of a piece and their links.
#[derive(Debug, Clone)]
pub(super) struct Links {
    /// Positions in the piece.
    pub(super) nodes: Vec<DVec2>,
    /// The nodes of each chain.
    pub(super) chains: Vec<Range<usize>>,
    /// The nodes of each loop; the last is followed by the first.
    pub(super) loops: Vec<Range<usize>>,
    /// Links along the contours.
    pub(super) along: Vec<Link>,
    /// Links from one contour to another, or across a bend of one.
    pub(super) across: Vec<Link>,
}

impl Links {
    pub(super) fn new(piece: &Piece) -> Self {
        let all = || piece.chains.iter().map(|c| &c.points).chain(&piece.loops).flatten();
        let low = all().copied().reduce(DVec2::min).unwrap_or_default();
        let high = all().copied().reduce(DVec2::max).unwrap_or_default();
        let longest = LONGEST_EDGE * (high - low).element_sum();
        let mut found = Self {
            nodes: Vec::new(),
            chains: Vec::new(),
            loops: Vec::new(),
            along: Vec::new(),
            across: Vec::new(),
        };
        for chain in &piece.chains {
            let row = found.row(&chain.points, longest);
            found.chains.push(row);
        }
        for points in &piece.loops {
            let closed: Vec<DVec2> = points.iter().chain(points.first()).copied().collect();
            let row = found.row(&closed, longest);
            // The closing point is the first one again.
            found.nodes.pop();
            found.loops.push(row.start..row.end - 1);
        }
        found.link(LEAST_LENGTH * longest);
        found
    }

    fn row(&mut self, points: &[DVec2], longest: f64) -> Range<usize> {
        let start = self.nodes.len();
        self.nodes.push(points[0]);
        for w in points.windows(2) {
            let parts = (w[0].distance(w[1]) / longest).ceil().max(1.0);
            for k in 1..parts as usize {
                self.nodes.push(w[0].lerp(w[1], k as f64 / parts));
            }
            self.nodes.push(w[1]);
        }
        start..self.nodes.len()
    }

    fn link(&mut self, least: f64) {
        let n = self.nodes.len();
        // What comes before and after each node along its contour; at the ends of a chain the node itself.
        let (mut before, mut after): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
        let mut join = |a: usize, b: usize| {
            after[a] = b;
            before[b] = a;
        };
        for row in &self.chains {
            (row.start + 1..row.end).for_each(|k| join(k - 1, k));
        }
        for row in &self.loops {
            (row.start + 1..row.end).for_each(|k| join(k - 1, k));
            join(row.end - 1, row.start);
        }
        let length = |a: usize, b: usize| self.nodes[a].distance(self.nodes[b]).max(least);
        let along = (0..n)
            .filter(|&a| after[a] != a)
            .map(|a| Link { from: a, to: after[a], weight: 1.0 / length(a, after[a]) })
            .collect();
        // The stretch of contour that a node stands for.
        let share = |a: usize| (length(before[a], a) + length(a, after[a])) / 2.0;
        let neighbours = self.neighbours(&before, &after);
        let across = neighbours.into_iter().map(|(a, b, is_ink)| {
            let strength = if is_ink { ACROSS_INK } else { ACROSS_GAP };
            let width = length(a, b);
            // What is nearer than its nodes are to each other is no nearer for them.
            let near = width.max(share(a).min(share(b)));
            Link { from: a, to: b, weight: strength * share(a).min(share(b)) / (near * near) }
        });
        (self.along, self.across) = (along, across.collect());
    }

    /// Pairs of neighbours that lie across ink or a gap from each other, and which of the two.
    fn neighbours(&self, before: &[usize], after: &[usize]) -> Vec<(usize, usize, bool)> {
        let points = self.nodes.iter().map(|p| Point2::new(p.x, p.y)).collect();
        let Ok(mesh) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points) else {
            return Vec::new();
        };
        if mesh.num_vertices() != self.nodes.len() {
            // Nodes that coincide have lost their numbers.
            return Vec::new();
        }
        let mut along = vec![0.0; self.nodes.len()];
        let mut owner = vec![0; self.nodes.len()];
        let mut girth = Vec::new();
        for (row, is_loop) in
            self.chains.iter().map(|r| (r, false)).chain(self.loops.iter().map(|r| (r, true)))
        {
            let mut at = 0.0;
            for k in row.clone() {
                if k > row.start {
                    at += self.nodes[k].distance(self.nodes[k - 1]);
                }
                along[k] = at;
                owner[k] = girth.len();
            }
            let closing = self.nodes[row.start].distance(self.nodes[row.end - 1]);
            girth.push(if is_loop { at + closing } else { f64::INFINITY });
        }
        let is_short_cut = |a: usize, b: usize| {
            if owner[a] != owner[b] {
                return true;
            }
            let way = (along[a] - along[b]).abs();
            let way = way.min(girth[owner[a]] - way);
            self.nodes[a].distance(self.nodes[b]) < SHORT_CUT * way
        };
        let mut pairs: Vec<(usize, usize, bool)> = mesh
            .undirected_edges()
            .map(|e| e.vertices().map(|v| v.index()))
            .map(|[a, b]| (a.min(b), a.max(b)))
            .filter(|&(a, b)| after[a] != b && after[b] != a && is_short_cut(a, b))
            .map(|(a, b)| {
                let is_ink = self.faces_ink(before, after, a, b) && self.faces_ink(before, after, b, a);
                (a, b, is_ink)
            })
            .collect();
        pairs.sort_unstable();
        pairs
    }

    /// Whether the way from node `a` to `b` begins in ink, which is on the left of the contour.
    fn faces_ink(&self, before: &[usize], after: &[usize], a: usize, b: usize) -> bool {
        let at = self.nodes[a];
        let (way, out) = (self.nodes[b] - at, self.nodes[after[a]] - at);
        let back = self.nodes[before[a]] - at;
        if out == DVec2::ZERO {
            return (-back).perp_dot(way) > 0.0;
        }
        if back == DVec2::ZERO {
            return out.perp_dot(way) > 0.0;
        }
        if out.perp_dot(back) > 0.0 {
            out.perp_dot(way) > 0.0 && way.perp_dot(back) > 0.0
        } else {
            out.perp_dot(way) > 0.0 || way.perp_dot(back) > 0.0
        }
    }
}
