//! From a drawing to its sample graph (Tu 2020 §4.1.1).
//!
//! Curves are sampled at their ends, where they meet, at corners, and between these evenly, as near to the spacing as goes. Corners are not in
//! the paper: without a sample there a meander would come out round.

use std::collections::BTreeSet;

use glam::DVec2;

use super::drawing::Drawing;
use super::elements::Elements;
use super::graph::{Edge, Graph, Kind, Sample};
use super::lines::{Line, meetings};
use crate::planar::Sets;

/// Chords are within this part of the spacing.
const CHORD: f64 = 0.002;
/// Places nearer to each other than this part of the spacing, or half of the pen, are one sample.
const SAME: f64 = 0.12;
/// Chords of a stretch that its handles are fitted to.
const FITTED: usize = 12;

/// Which points of elements to take: the number of the level, of how many, and the spacing of samples in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// From 0, the coarsest.
    pub level: usize,
    /// All levels.
    pub levels: usize,
    /// δ.
    pub spacing_mm: f64,
}

/// The sample graph of a drawing, whose elements are already classified.
pub fn sampled(drawing: &Drawing, elements: &Elements, resolution: Resolution) -> Graph {
    let mut graph = sampled_curves(drawing, resolution.spacing_mm);
    for (number, placed) in (0..).zip(&elements.placed) {
        let points = elements.classes[placed.class as usize].points(
            resolution.level,
            resolution.levels,
            resolution.spacing_mm,
        );
        graph.samples.extend((0..).zip(points).map(|(point, p)| Sample {
            at: placed.similarity.apply(p),
            kind: Kind::Element { class: placed.class, point },
            orientations: Vec::new(),
            width_mm: 0.0,
            existence: 1.0,
            is_given: false,
            element: number,
        }));
    }
    graph
}

/// A place of a line that has a sample.
#[derive(Debug, Clone, Copy)]
struct Stop {
    along_mm: f64,
    node: usize,
}

/// The sample graph of the curves alone.
fn sampled_curves(drawing: &Drawing, spacing_mm: f64) -> Graph {
    let lines: Vec<Line> =
        drawing.curves.iter().filter_map(|curve| Line::new(curve, CHORD * spacing_mm)).collect();
    let pen = |a: &Line, b: &Line| 0.25 * (a.width_mm + b.width_mm);
    let (mut stops, places) = nodes(&lines, pen, spacing_mm);
    let mut graph = Graph::default();
    for &(at, width_mm) in &places {
        graph.samples.push(curve_sample(at, width_mm));
    }
    let mut pairs: BTreeSet<[usize; 2]> = BTreeSet::new();
    for (line, stops) in lines.iter().zip(&mut stops) {
        for (from, to) in stretches(line, stops, &mut graph) {
            lay(line, from, to, spacing_mm, &mut graph, &mut pairs);
        }
    }
    let adjacency = graph.adjacency();
    for s in 0..graph.samples.len() {
        let leaving = adjacency.of(s).iter().map(|&(e, _)| {
            let edge = &graph.edges[e];
            let handle = edge.handles[usize::from(edge.ends[1] == s)];
            handle.to_angle().rem_euclid(std::f64::consts::TAU)
        });
        graph.samples[s].orientations = leaving.collect();
    }
    graph
}

pub(super) fn curve_sample(at: DVec2, width_mm: f64) -> Sample {
    Sample {
        at,
        kind: Kind::Curve,
        orientations: Vec::new(),
        width_mm,
        existence: 1.0,
        is_given: false,
        element: 0,
    }
}

/// The stops of every line at ends, meetings and corners, and the places of their nodes with the width of the pen there.
fn nodes(
    lines: &[Line],
    pen: impl Fn(&Line, &Line) -> f64,
    spacing_mm: f64,
) -> (Vec<Vec<Stop>>, Vec<(DVec2, f64)>) {
    let mut all: Vec<(usize, f64)> = Vec::new();
    let mut one: Vec<[usize; 2]> = Vec::new();
    for meeting in meetings(lines, pen) {
        one.push([all.len(), all.len() + 1]);
        all.extend(meeting);
    }
    for (number, line) in lines.iter().enumerate() {
        if !line.is_closed {
            all.extend([(number, 0.0), (number, line.length_mm())]);
        }
        all.extend(line.corners_mm.iter().map(|&corner| (number, corner)));
    }
    // What is one place is one node: meetings, and what lies close together along a line.
    let mut sets = Sets::new(all.len());
    one.iter().for_each(|&[a, b]| sets.join(a, b));
    let mut by_line: Vec<Vec<usize>> = vec![Vec::new(); lines.len()];
    (0..all.len()).for_each(|i| by_line[all[i].0].push(i));
    for (line, on) in lines.iter().zip(&mut by_line) {
        on.sort_by(|&a, &b| all[a].1.total_cmp(&all[b].1).then(a.cmp(&b)));
        let same_mm = (SAME * spacing_mm).max(0.5 * line.width_mm).min(0.25 * line.length_mm());
        for pair in on.windows(2) {
            if all[pair[1]].1 - all[pair[0]].1 < same_mm {
                sets.join(pair[0], pair[1]);
            }
        }
        if let (true, Some(&first), Some(&last)) = (line.is_closed, on.first(), on.last())
            && all[first].1 + line.length_mm() - all[last].1 < same_mm
        {
            sets.join(first, last);
        }
    }
    let mut node_of = vec![usize::MAX; all.len()];
    let mut places: Vec<(DVec2, f64, u32)> = Vec::new();
    for i in 0..all.len() {
        let root = sets.find(i);
        if node_of[root] == usize::MAX {
            node_of[root] = places.len();
            places.push((DVec2::ZERO, 0.0, 0));
        }
        let node = node_of[root];
        node_of[i] = node;
        let line = &lines[all[i].0];
        let place = &mut places[node];
        *place = (place.0 + line.at(all[i].1), place.1.max(line.width_mm), place.2 + 1);
    }
    let stops = by_line
        .iter()
        .map(|on| {
            let mut stops: Vec<Stop> =
                on.iter().map(|&i| Stop { along_mm: all[i].1, node: node_of[i] }).collect();
            // The first and the last of several at one place: between them the line does not leave it.
            stops.dedup_by_key(|stop| stop.node);
            stops
        })
        .collect();
    (stops, places.into_iter().map(|(sum, width, count)| (sum / f64::from(count), width)).collect())
}

/// The stretches between stops. A closed line without any gets one.
fn stretches(line: &Line, stops: &mut Vec<Stop>, graph: &mut Graph) -> Vec<(Stop, Stop)> {
    if stops.is_empty() {
        stops.push(Stop { along_mm: 0.0, node: graph.samples.len() });
        graph.samples.push(curve_sample(line.points[0], line.width_mm));
    }
    let mut stretches: Vec<(Stop, Stop)> = stops.windows(2).map(|pair| (pair[0], pair[1])).collect();
    if line.is_closed {
        let (first, last) = (stops[0], stops[stops.len() - 1]);
        stretches.push((last, Stop { along_mm: first.along_mm + line.length_mm(), node: first.node }));
    }
    stretches
}

/// Samples and edges along a stretch.
fn lay(
    line: &Line,
    from: Stop,
    to: Stop,
    spacing_mm: f64,
    graph: &mut Graph,
    pairs: &mut BTreeSet<[usize; 2]>,
) {
    let length_mm = to.along_mm - from.along_mm;
    // Two samples have one edge at the most.
    let key = [from.node.min(to.node), from.node.max(to.node)];
    let least = match from.node == to.node {
        true => 3,
        false if pairs.contains(&key) => 2,
        false => 1,
    };
    // A loop on a fork that the pen covers is the fork.
    if from.node == to.node && length_mm < line.length_mm() && length_mm < line.width_mm {
        return;
    }
    let count = ((length_mm / spacing_mm).round() as usize).max(least);
    let mut before = from.node;
    for i in 1..=count {
        let along = |i: usize| from.along_mm + length_mm * i as f64 / count as f64;
        let node = match i == count {
            true => to.node,
            false => {
                graph.samples.push(curve_sample(line.at(along(i)), line.width_mm));
                graph.samples.len() - 1
            }
        };
        let mut points = line.between(along(i - 1), along(i), FITTED);
        // Nodes lie between the lines that meet there.
        points[0] = graph.samples[before].at;
        points[FITTED] = graph.samples[node].at;
        let handles = fitted_handles(&points);
        let is_forward = before < node;
        pairs.insert([before.min(node), before.max(node)]);
        graph.edges.push(Edge {
            ends: if is_forward { [before, node] } else { [node, before] },
            confidence: 1.0,
            handles: if is_forward { handles } else { [handles[1], handles[0]] },
        });
        before = node;
    }
}

/// The handles of the cubic Bézier curve that comes nearest to the points, in the sense of least squares at parameters by length, with the
/// directions of the points' ends (Schneider 1990).
pub fn fitted_handles(points: &[DVec2]) -> [DVec2; 2] {
    let last = points.len() - 1;
    let (a, b) = (points[0], points[last]);
    let tangent =
        |p: DVec2, q: DVec2, r: DVec2| (4.0 * q - 3.0 * p - r).normalize_or(q - p).normalize_or_zero();
    let t = [tangent(a, points[1], points[2]), tangent(b, points[last - 1], points[last - 2])];
    let mut along = vec![0.0];
    for ends in points.windows(2) {
        along.push(along[along.len() - 1] + ends[0].distance(ends[1]));
    }
    let length = along[last];
    let (mut c, mut x) = ([[0.0; 2]; 2], [0.0; 2]);
    for (p, s) in points.iter().zip(&along) {
        let u = s / length;
        let v = 1.0 - u;
        let (b1, b2) = (3.0 * u * v * v, 3.0 * u * u * v);
        let form = [t[0] * b1, t[1] * b2];
        let rest = *p - (a * (v * v * v + b1) + b * (b2 + u * u * u));
        for i in 0..2 {
            for j in 0..2 {
                c[i][j] += form[i].dot(form[j]);
            }
            x[i] += form[i].dot(rest);
        }
    }
    let determinant = c[0][0] * c[1][1] - c[0][1] * c[1][0];
    let lengths =
        [(x[0] * c[1][1] - x[1] * c[0][1]) / determinant, (x[1] * c[0][0] - x[0] * c[1][0]) / determinant];
    let is_sound = lengths.iter().all(|l| l.is_finite() && *l > 0.1 * length && *l < length);
    let lengths = if is_sound { lengths } else { [length / 3.0; 2] };
    [t[0] * lengths[0], t[1] * lengths[1]]
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::samples::Curve;

    fn graph(paths: &[&str], spacing_mm: f64) -> Graph {
        let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        let drawing = Drawing { curves: paths.iter().map(curve).collect(), elements: Vec::new() };
        sampled(&drawing, &Elements::default(), Resolution { level: 0, levels: 1, spacing_mm })
    }

    fn degrees(graph: &Graph) -> Vec<usize> {
        let adjacency = graph.adjacency();
        let mut degrees: Vec<usize> = (0..graph.samples.len()).map(|s| adjacency.degree(s)).collect();
        degrees.sort_unstable();
        degrees
    }

    #[test]
    fn lines_that_cross_share_a_sample() {
        let cross = graph(&["M0 10H20", "M10 0V20"], 5.0);
        assert_eq!(degrees(&cross), [1, 1, 1, 1, 2, 2, 2, 2, 4]);
        assert!(cross.samples.iter().any(|s| s.at.distance(DVec2::splat(10.0)) < 1e-9));
    }

    #[test]
    fn an_end_on_a_line_is_a_fork_where_ink_meets() {
        assert_eq!(degrees(&graph(&["M0 10H20", "M10 0V9.7"], 10.0)), [1, 1, 1, 3]);
        // Beyond half of a pen there is a gap.
        assert_eq!(degrees(&graph(&["M0 10H20", "M10 0V8.5"], 10.0)), [1, 1, 1, 1, 2]);
    }

    #[test]
    fn corners_and_rings_are_sampled() {
        let corner = graph(&["M0 0H9V9"], 20.0);
        assert_eq!(degrees(&corner), [1, 1, 2]);
        let ring = graph(&["M10 0A10 10 0 1 1 -10 0A10 10 0 1 1 10 0Z"], 6.0);
        assert_eq!(ring.samples.len(), (std::f64::consts::TAU * 10.0 / 6.0).round() as usize);
        assert!(degrees(&ring).iter().all(|&degree| degree == 2));
    }

    #[test]
    fn every_sample_has_as_many_directions_as_edges() {
        let all = graph(&["M0 10C5 0 15 20 20 10", "M10 0V20", "M3 3H6"], 3.0);
        let adjacency = all.adjacency();
        for (s, sample) in all.samples.iter().enumerate() {
            assert_eq!(sample.orientations.len(), adjacency.degree(s));
        }
        assert!(all.edges.iter().all(|e| e.ends[0] < e.ends[1]));
    }

    #[test]
    fn handles_follow_the_curve() {
        // A quarter of a circle has handles of 0.5523 radii.
        let points: Vec<DVec2> =
            (0..=12).map(|i| DVec2::from_angle(std::f64::consts::FRAC_PI_2 * f64::from(i) / 12.0)).collect();
        let [out, back] = fitted_handles(&points);
        assert!((out - DVec2::new(0.0, 0.5523)).length() < 0.01, "{out}");
        assert!((back - DVec2::new(0.5523, 0.0)).length() < 0.01, "{back}");
    }
}
