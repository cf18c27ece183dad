//! The search step: for each sample of the output the neighbourhood of the exemplar that is most like its own (Tu 2020 §4.3.3).
//!
//! PatchMatch on a graph: samples are visited breadth first over their nearest neighbours (Chen et al. 2012), there and back; each tries what its
//! neighbours found, moved along, and random samples in windows that shrink. Order is cut into blocks of a fixed size that run side by side: in its
//! block a sample sees what was just found, elsewhere what the pass before had found. So the result does not depend on the number of threads, which
//! the paper's one region per thread does.

use std::collections::VecDeque;

use glam::DVec2;

use super::draws::Draws;
use super::graph::Graph;
use super::neighbours::Buckets;
use super::options::Options;
use super::parallel::in_parallel;
use super::similarity::{Likeness, Matching, Workspace};

/// Samples in a block.
const BLOCK: usize = 48;

/// What was found for a sample: the exemplar's, and the cost.
pub type Found = (usize, f64);

/// The order in which samples are visited, and the neighbours of each.
pub struct Route {
    order: Vec<usize>,
    neighbours: Vec<Vec<(usize, DVec2)>>,
}

impl Route {
    /// Breadth first over the `k` nearest neighbours of each sample, in an area that may be rolled.
    pub fn new(graph: &Graph, area: &super::area::Area, k: usize) -> Self {
        let points: Vec<DVec2> = graph.samples.iter().map(|s| s.at).collect();
        let n = points.len();
        let (low, high) = area.bounds_mm();
        let start_mm = ((high - low).element_product() / n.max(1) as f64).sqrt() * 1.5;
        let buckets = Buckets::new(&points, start_mm, Some(area));
        let neighbours: Vec<Vec<(usize, DVec2)>> = in_parallel(n, |s| {
            let mut radius_mm = start_mm;
            loop {
                let mut near: Vec<(usize, DVec2)> = Vec::new();
                buckets.within(points[s], radius_mm, |i, offset| {
                    if i != s {
                        near.push((i, offset));
                    }
                });
                if near.len() >= k || radius_mm > (high - low).length() * 2.0 {
                    near.sort_unstable_by(|a, b| {
                        a.1.length_squared().total_cmp(&b.1.length_squared()).then(a.0.cmp(&b.0))
                    });
                    near.truncate(k);
                    return near;
                }
                radius_mm *= 1.6;
            }
        });
        // Ways lead both ways, so that a lone sample is reached too.
        let mut both = vec![Vec::new(); n];
        for (s, near) in neighbours.iter().enumerate() {
            for &(other, _) in near {
                both[s].push(other);
                both[other].push(s);
            }
        }
        let mut order = Vec::with_capacity(n);
        let mut is_seen = vec![false; n];
        for first in 0..n {
            let mut queue = VecDeque::new();
            if !is_seen[first] {
                is_seen[first] = true;
                queue.push_back(first);
            }
            while let Some(s) = queue.pop_front() {
                order.push(s);
                for &other in &both[s] {
                    if !std::mem::replace(&mut is_seen[other], true) {
                        queue.push_back(other);
                    }
                }
            }
        }
        Self { order, neighbours }
    }
}

/// Improves what was found for every sample; `start` has the sample of the exemplar that each begins with, if one is known.
pub fn search(
    likeness: &Likeness<'_>,
    route: &Route,
    start: &[Option<usize>],
    passes: usize,
    options: &Options,
    purpose: &[u64],
) -> Vec<Found> {
    let source = likeness.source;
    let finders = source.finders();
    let n = likeness.graph.samples.len();
    let with = |word: u64, s: usize| {
        let mut purpose = purpose.to_vec();
        purpose.extend([word, s as u64]);
        Draws::new(options.seed, &purpose)
    };
    let mut field: Vec<Found> = in_parallel(n, |s| {
        let middles = source.middles(likeness.graph.samples[s].kind);
        let first = start[s].unwrap_or_else(|| middles[with(0, s).below(middles.len())]);
        let cost = likeness.cost(s, first, f64::INFINITY, &mut Workspace::default());
        (first, cost.expect("every cost is below infinity"))
    });
    let widest_mm = options.windows[0] * source.side_mm();
    let narrowest_mm = options.windows[1] * source.side_mm();
    for pass in 0..passes {
        let is_back = pass % 2 == 1;
        let visit = |place: usize| if is_back { n - 1 - place } else { place };
        let mut place_of = vec![0; n];
        (0..n).for_each(|place| place_of[route.order[visit(place)]] = place);
        let before = &field;
        let blocks = in_parallel_blocks(n, |first, last| {
            let mut workspace = Workspace::default();
            let mut found: Vec<Found> = Vec::with_capacity(last - first);
            for place in first..last {
                let s = route.order[visit(place)];
                let kind = likeness.graph.samples[s].kind;
                let finder = &finders[&kind];
                let (mut best, mut cost) = before[s];
                let mut tried: Vec<usize> = vec![best];
                let mut attempt = |input: usize, best: &mut usize, cost: &mut f64| {
                    if !tried.contains(&input) {
                        tried.push(input);
                        if let Some(less) = likeness.cost(s, input, *cost, &mut workspace) {
                            (*best, *cost) = (input, less);
                        }
                    }
                };
                for &(other, offset) in &route.neighbours[s] {
                    let at = place_of[other];
                    let (theirs, _) =
                        if (first..place).contains(&at) { found[at - first] } else { before[other] };
                    let aim = source.graph.samples[theirs].at - offset;
                    if let Some(input) = finder.nearest(aim) {
                        attempt(input, &mut best, &mut cost);
                    }
                }
                let mut draws = with(1 + pass as u64, s);
                let mut window_mm = widest_mm;
                while window_mm >= narrowest_mm {
                    let middle = source.graph.samples[best].at;
                    let shift = DVec2::new(draws.unit() - 0.5, draws.unit() - 0.5) * 2.0 * window_mm;
                    if let Some(input) = finder.nearest(middle + shift) {
                        attempt(input, &mut best, &mut cost);
                    }
                    window_mm /= 2.0;
                }
                found.push((best, cost));
            }
            found
        });
        let mut next = field.clone();
        for (place, found) in blocks.into_iter().flatten().enumerate() {
            next[route.order[visit(place)]] = found;
        }
        field = next;
    }
    field
}

fn in_parallel_blocks<T: Send>(n: usize, f: impl Fn(usize, usize) -> T + Sync) -> Vec<T> {
    in_parallel(n.div_ceil(BLOCK), |block| f(block * BLOCK, ((block + 1) * BLOCK).min(n)))
}

/// What goes together around every sample.
pub fn matchings(likeness: &Likeness<'_>, found: &[Found]) -> Vec<Matching> {
    in_parallel(found.len(), |s| likeness.matching(s, found[s].0, &mut Workspace::default()))
}
