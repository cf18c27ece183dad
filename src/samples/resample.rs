//! A sample graph at a finer spacing: the chains of edges between forks, ends and corners are sampled anew (Tu 2020 §4.3.5).

use std::collections::BTreeSet;

use glam::DVec2;
use kurbo::{CubicBez, ParamCurve, Point};

use super::area::Area;
use super::graph::{Adjacency, Edge, Graph, Kind};
use super::sampling::{curve_sample, fitted_handles};

/// Chords of an edge while it is measured.
const CHORDS: usize = 8;
/// Chords that new handles are fitted to.
const FITTED: usize = 8;
/// A turn of a path at a sample above this, in radians, is a corner.
const CORNER: f64 = std::f64::consts::FRAC_PI_4;

/// The curves of a graph sampled by `spacing_mm`, and for each new sample the old one that is nearest along its curve.
/// Elements are left out, and what was given: it is sampled by itself.
pub fn resampled(graph: &Graph, area: &Area, spacing_mm: f64) -> (Graph, Vec<usize>) {
    let adjacency = graph.adjacency();
    let is_node = |s: usize| {
        adjacency.degree(s) != 2 || graph.samples[s].is_given || {
            let [a, b] = [0, 1].map(|k| leaving(graph, &adjacency, s, k));
            std::f64::consts::PI - a.angle_to(b).abs() > CORNER
        }
    };
    let mut fine = Graph::default();
    let mut parents: Vec<usize> = Vec::new();
    let mut node_of: Vec<Option<usize>> = vec![None; graph.samples.len()];
    for (s, sample) in graph.samples.iter().enumerate() {
        if sample.kind == Kind::Curve && is_node(s) && (adjacency.degree(s) > 0 || sample.is_given) {
            node_of[s] = Some(fine.samples.len());
            fine.samples.push(super::graph::Sample { orientations: Vec::new(), ..sample.clone() });
            parents.push(s);
        }
    }
    let mut is_used = vec![false; graph.edges.len()];
    let mut pairs: BTreeSet<[usize; 2]> = BTreeSet::new();
    let nodes: Vec<usize> = (0..graph.samples.len()).filter(|&s| node_of[s].is_some()).collect();
    for &s in &nodes {
        for &(first, _) in adjacency.of(s) {
            if !is_used[first] {
                let chain = chain(&adjacency, s, first, &node_of, &mut is_used);
                lay(graph, area, &chain, &node_of, spacing_mm, (&mut fine, &mut parents, &mut pairs));
            }
        }
    }
    // What is left are rings without a node.
    for first in 0..graph.edges.len() {
        if !is_used[first] {
            let s = graph.edges[first].ends[0];
            node_of[s] = Some(fine.samples.len());
            fine.samples.push(super::graph::Sample { orientations: Vec::new(), ..graph.samples[s].clone() });
            parents.push(s);
            let chain = chain(&adjacency, s, first, &node_of, &mut is_used);
            lay(graph, area, &chain, &node_of, spacing_mm, (&mut fine, &mut parents, &mut pairs));
        }
    }
    let adjacency = fine.adjacency();
    for s in 0..fine.samples.len() {
        let directions = (0..adjacency.degree(s)).map(|k| leaving(&fine, &adjacency, s, k));
        fine.samples[s].orientations =
            directions.map(|d| d.to_angle().rem_euclid(std::f64::consts::TAU)).collect();
    }
    (fine, parents)
}

/// The handle at a sample of its edge number `k`.
fn leaving(graph: &Graph, adjacency: &Adjacency, s: usize, k: usize) -> DVec2 {
    let edge = &graph.edges[adjacency.of(s)[k].0];
    edge.handles[usize::from(edge.ends[1] == s)]
}

/// The edges from a node to the next one: each with the sample that it begins at.
fn chain(
    adjacency: &Adjacency,
    from: usize,
    first: usize,
    node_of: &[Option<usize>],
    is_used: &mut [bool],
) -> Vec<(usize, usize, usize)> {
    let (mut s, mut edge) = (from, first);
    let mut chain = Vec::new();
    loop {
        is_used[edge] = true;
        let &(_, next) = adjacency.of(s).iter().find(|way| way.0 == edge).expect("an edge is at its ends");
        chain.push((edge, s, next));
        if node_of[next].is_some() {
            return chain;
        }
        // Two edges meet there.
        let &(on, _) = adjacency.of(next).iter().find(|way| way.0 != edge).expect("a sample between has two");
        (s, edge) = (next, on);
    }
}

fn lay(
    graph: &Graph,
    area: &Area,
    chain: &[(usize, usize, usize)],
    node_of: &[Option<usize>],
    spacing_mm: f64,
    (fine, parents, pairs): (&mut Graph, &mut Vec<usize>, &mut BTreeSet<[usize; 2]>),
) {
    let start = chain[0].1;
    let mut points = vec![graph.samples[start].at];
    let mut owners = vec![start];
    for &(number, from, to) in chain {
        let edge = &graph.edges[number];
        let [out, back] =
            if edge.ends[0] == from { edge.handles } else { [edge.handles[1], edge.handles[0]] };
        let a = points[points.len() - 1];
        let b = a + area.way(graph.samples[from].at, graph.samples[to].at);
        let at = |p: DVec2| Point::new(p.x, p.y);
        let cubic = CubicBez::new(at(a), at(a + out), at(b + back), at(b));
        for k in 1..=CHORDS {
            let p = cubic.eval(k as f64 / CHORDS as f64);
            points.push(DVec2::new(p.x, p.y));
            owners.push(if 2 * k <= CHORDS { from } else { to });
        }
    }
    let mut along = vec![0.0];
    for ends in points.windows(2) {
        along.push(along[along.len() - 1] + ends[0].distance(ends[1]));
    }
    let length_mm = along[along.len() - 1];
    let locate = |mm: f64| {
        let i = along.partition_point(|&a| a <= mm).clamp(1, along.len() - 1) - 1;
        let t = ((mm - along[i]) / (along[i + 1] - along[i]).max(1e-12)).clamp(0.0, 1.0);
        (points[i].lerp(points[i + 1], t), owners[if t < 0.5 { i } else { i + 1 }])
    };
    // What goes on from a stroke that was given has a pen of its own.
    let own = chain.iter().flat_map(|&(_, from, to)| [from, to]).find(|&s| !graph.samples[s].is_given);
    let width_mm = |owner: usize| {
        let like = own.filter(|_| graph.samples[owner].is_given).unwrap_or(owner);
        graph.samples[like].width_mm
    };
    let [first, last] = [start, chain[chain.len() - 1].2].map(|s| node_of[s].expect("chains end at nodes"));
    let key = [first.min(last), first.max(last)];
    if graph.edges[chain[0].0].is_given() {
        return;
    }
    let least = match first == last {
        true => 3,
        false if pairs.contains(&key) => 2,
        false => 1,
    };
    let count = ((length_mm / spacing_mm).round() as usize).max(least);
    let mut before = first;
    for i in 1..=count {
        let mm = |i: usize| length_mm * i as f64 / count as f64;
        let node = match i == count {
            true => last,
            false => {
                let (p, owner) = locate(mm(i));
                fine.samples.push(curve_sample(area.home(p), width_mm(owner)));
                parents.push(owner);
                fine.samples.len() - 1
            }
        };
        let stretch: Vec<DVec2> = (0..=FITTED)
            .map(|k| locate(mm(i - 1) + (mm(i) - mm(i - 1)) * k as f64 / FITTED as f64).0)
            .collect();
        let handles = fitted_handles(&stretch);
        pairs.insert([before.min(node), before.max(node)]);
        fine.edges.push(Edge {
            ends: [before.min(node), before.max(node)],
            confidence: 1.0,
            handles: if before < node { handles } else { [handles[1], handles[0]] },
        });
        before = node;
    }
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::samples::area::tests::square;
    use crate::samples::sampling::{Resolution, sampled};
    use crate::samples::{Curve, Drawing, Elements};

    #[test]
    fn a_finer_graph_has_the_same_forks_ends_and_rings() {
        let paths =
            ["M5 20C15 5 25 35 35 20", "M20 20V38", "M8 30A4 4 0 1 1 16 30A4 4 0 1 1 8 30Z", "M22 3H34V10"];
        let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        let drawing = Drawing { curves: paths.iter().map(curve).collect(), elements: Vec::new() };
        let resolution = Resolution { level: 0, levels: 1, spacing_mm: 6.0 };
        let coarse = sampled(&drawing, &Elements::default(), resolution);
        let (fine, parents) = resampled(&coarse, &square(40.0), 2.0);
        assert_eq!(parents.len(), fine.samples.len());
        let census = |graph: &Graph| {
            let adjacency = graph.adjacency();
            let of = |k: usize| (0..graph.samples.len()).filter(|&s| adjacency.degree(s) == k).count();
            (of(0), of(1), of(3), graph.samples.len() as i64 - graph.edges.len() as i64)
        };
        assert_eq!(census(&coarse), census(&fine));
        assert!(fine.samples.len() > 2 * coarse.samples.len());
    }
}
