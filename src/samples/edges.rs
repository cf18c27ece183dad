//! Which samples are joined: the votes of all neighbourhoods, taken greedily (Tu 2020 §4.3.4, Eq. 16 to 21).

use glam::DVec2;
use rustc_hash::{FxHashMap, FxHashSet};

use super::area::Area;
use super::graph::{Edge, Graph};
use super::lines::crossing;
use super::options::Options;
use super::similarity::Matching;
use super::source::Source;

/// What was said of one pair of samples.
#[derive(Default, Clone, Copy)]
struct Votes {
    /// Neighbourhoods that have an edge there.
    edges: f64,
    /// Neighbourhoods that have both samples.
    all: f64,
    handles: [DVec2; 2],
}

/// Sets the edges of the output, and those that were voted for in vain.
///
/// An edge may not cross one that is believed in more: edges of an exemplar never do, as it has a sample wherever lines cross.
pub fn join(graph: &mut Graph, source: &Source, matchings: &[Matching], area: &Area, options: &Options) {
    let n = graph.samples.len();
    let mut votes: FxHashMap<(usize, usize), Votes> = FxHashMap::default();
    let mut degrees = vec![[0.0; 2]; n];
    let mut output_of: FxHashMap<usize, usize> = FxHashMap::default();
    for matching in matchings {
        output_of.clear();
        output_of.extend(matching.pairs.iter().filter_map(|&(s, input)| Some((input?, s))));
        for &(s, input) in &matching.pairs {
            let Some(input) = input else { continue };
            let weight = matching.weight;
            degrees[s][0] += weight * source.adjacency.degree(input) as f64;
            degrees[s][1] += weight;
            for &(number, other) in source.adjacency.of(input) {
                let Some(&t) = output_of.get(&other) else { continue };
                if s < t {
                    let edge = &source.graph.edges[number];
                    let vote = votes.entry((s, t)).or_default();
                    vote.edges += weight;
                    let [a, b] = edge.handles;
                    let handles = if edge.ends[0] == input { [a, b] } else { [b, a] };
                    vote.handles =
                        [vote.handles[0] + handles[0] * weight, vote.handles[1] + handles[1] * weight];
                }
            }
        }
    }
    let mut candidates: Vec<((usize, usize), Votes)> = votes.into_iter().collect();
    candidates.sort_unstable_by_key(|candidate| candidate.0);
    count_all(&mut candidates, matchings, n);
    let fixed: Vec<Edge> = given(graph).collect();
    let is_given: FxHashSet<[usize; 2]> = fixed.iter().map(|edge| edge.ends).collect();
    let mut edges: Vec<Edge> = candidates
        .into_iter()
        .filter(|((a, b), _)| !is_given.contains(&[*a, *b]))
        .map(|((a, b), votes)| Edge {
            ends: [a, b],
            confidence: votes.edges / votes.all,
            handles: votes.handles.map(|sum| sum / votes.edges),
        })
        .collect();
    edges.extend(fixed);
    edges.sort_by(|a, b| b.confidence.total_cmp(&a.confidence).then(a.ends.cmp(&b.ends)));
    let wanted: Vec<f64> =
        degrees.iter().map(|[sum, count]| if *count > 0.0 { sum / count } else { 0.0 }).collect();
    choose(graph, edges, &wanted, area, options.least_edge);
}

/// Edges that the maker gave stay.
fn given(graph: &Graph) -> impl Iterator<Item = Edge> + '_ {
    graph.edges.iter().filter(|edge| edge.is_given()).copied()
}

/// Counts the neighbourhoods that have both ends of each candidate.
fn count_all(candidates: &mut [((usize, usize), Votes)], matchings: &[Matching], n: usize) {
    let mut starts = vec![0; n + 1];
    for ((a, _), _) in candidates.iter() {
        starts[a + 1] += 1;
    }
    for s in 0..n {
        starts[s + 1] += starts[s];
    }
    let mut stamp = vec![usize::MAX; n];
    for (number, matching) in matchings.iter().enumerate() {
        matching.pairs.iter().for_each(|&(s, _)| stamp[s] = number);
        for &(s, _) in &matching.pairs {
            for ((_, b), votes) in &mut candidates[starts[s]..starts[s + 1]] {
                if stamp[*b] == number {
                    votes.all += matching.weight;
                }
            }
        }
    }
}

/// The greedy solution of Eq. 16: edges in the order of their votes, each taken if that makes the sum of Eq. 19 smaller.
fn choose(graph: &mut Graph, edges: Vec<Edge>, wanted: &[f64], area: &Area, least: f64) {
    let mut degrees = vec![0.0; wanted.len()];
    let mut taken: Vec<Edge> = Vec::new();
    let mut left: Vec<Edge> = Vec::new();
    let samples = &graph.samples;
    let mut field = CrossingField::new(samples.iter().map(|s| s.at).collect(), area);
    for edge in edges {
        let [a, b] = edge.ends;
        let off = |s: usize, more: f64| (degrees[s] + more - wanted[s]).abs();
        let with = (1.0 - edge.confidence).abs() + off(a, 1.0) + off(b, 1.0);
        let without = edge.confidence + off(a, 0.0) + off(b, 0.0);
        if edge.is_given() || (edge.confidence >= least && with < without && !field.crosses(edge.ends)) {
            degrees[a] += 1.0;
            degrees[b] += 1.0;
            field.add(edge.ends);
            taken.push(edge);
        } else {
            left.push(edge);
        }
    }
    taken.sort_unstable_by_key(|edge| edge.ends);
    (graph.edges, graph.unrealised) = (taken, left);
}

/// The edges that were taken, by the squares that they pass.
pub struct CrossingField<'a> {
    points: Vec<DVec2>,
    area: &'a Area,
    side_mm: f64,
    cells: FxHashMap<(i64, i64), Vec<[usize; 2]>>,
}

impl<'a> CrossingField<'a> {
    /// A field without edges between these points.
    pub fn new(points: Vec<DVec2>, area: &'a Area) -> Self {
        let (low, high) = area.bounds_mm();
        let side_mm = ((high - low).element_product() / points.len().max(1) as f64).sqrt().max(1e-6) * 2.0;
        Self { points, area, side_mm, cells: FxHashMap::default() }
    }

    /// The squares of an edge's box; rolled, whole squares go round.
    fn keys(&self, [a, b]: [usize; 2]) -> Vec<(i64, i64)> {
        let from = self.area.home(self.points[a]);
        let to = from + self.area.way(from, self.points[b]);
        let columns = self.area.lap_mm().map(|lap_mm| ((lap_mm / self.side_mm).floor() as i64).max(1));
        let width_mm = match (self.area.lap_mm(), columns) {
            (Some(lap_mm), Some(columns)) => lap_mm / columns as f64,
            _ => self.side_mm,
        };
        let cell = |p: DVec2| ((p.x / width_mm).floor() as i64, (p.y / self.side_mm).floor() as i64);
        let (low, high) = (cell(from.min(to)), cell(from.max(to)));
        let last = columns.map_or(high.0, |columns| high.0.min(low.0 + columns - 1));
        let column = |x: i64| columns.map_or(x, |columns| x.rem_euclid(columns));
        (low.0..=last).flat_map(|x| (low.1..=high.1).map(move |y| (column(x), y))).collect()
    }

    /// Whether an edge would cross one that is there, other than in a common end.
    pub fn crosses(&self, ends: [usize; 2]) -> bool {
        let [a, b] = ends;
        let from = self.points[a];
        let to = from + self.area.way(from, self.points[b]);
        self.keys(ends).iter().filter_map(|key| self.cells.get(key)).flatten().any(|&[c, d]| {
            if [a, b].contains(&c) || [a, b].contains(&d) {
                return false;
            }
            let start = from + self.area.way(from, self.points[c]);
            let end = start + self.area.way(start, self.points[d]);
            crossing(from, to, start, end).is_some()
        })
    }

    /// Adds an edge.
    pub fn add(&mut self, ends: [usize; 2]) {
        for key in self.keys(ends) {
            self.cells.entry(key).or_default().push(ends);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::area::tests::square;
    use crate::samples::sampling::curve_sample;

    fn graph(points: &[(f64, f64)]) -> Graph {
        let samples = points.iter().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        Graph { samples, ..Graph::default() }
    }

    fn edge(a: usize, b: usize, confidence: f64) -> Edge {
        Edge { ends: [a, b], confidence, handles: [DVec2::ZERO; 2] }
    }

    /// A case like that of Tu 2020 Figure 8: four samples, four possible edges, expected degrees that the greedy solution meets but for one.
    #[test]
    fn edges_are_taken_in_the_order_of_their_votes() {
        let mut four = graph(&[(1.0, 1.0), (9.0, 1.0), (9.0, 9.0), (1.0, 9.0)]);
        let edges = vec![edge(0, 1, 1.0), edge(1, 2, 0.8), edge(2, 3, 0.6), edge(0, 3, 0.3)];
        choose(&mut four, edges, &[1.0, 1.9, 2.0, 1.0], &square(10.0), 0.0);
        let taken: Vec<[usize; 2]> = four.edges.iter().map(|e| e.ends).collect();
        assert_eq!(taken, [[0, 1], [1, 2], [2, 3]]);
        assert_eq!(four.unrealised.len(), 1);
        assert_eq!(four.unrealised[0].ends, [0, 3]);
    }

    #[test]
    fn an_edge_that_crosses_a_surer_one_is_not_taken() {
        let mut cross = graph(&[(1.0, 1.0), (9.0, 9.0), (9.0, 1.0), (1.0, 9.0)]);
        choose(&mut cross, vec![edge(0, 1, 1.0), edge(2, 3, 0.9)], &[1.0; 4], &square(10.0), 0.0);
        assert_eq!(cross.edges.len(), 1);
        assert_eq!(cross.unrealised[0].ends, [2, 3]);
    }

    #[test]
    fn what_few_believe_in_is_left() {
        let mut pair = graph(&[(1.0, 1.0), (9.0, 9.0)]);
        choose(&mut pair, vec![edge(0, 1, 0.2)], &[1.0; 2], &square(10.0), 0.25);
        assert!(pair.edges.is_empty());
        choose(&mut pair, vec![edge(0, 1, 0.2)], &[1.0; 2], &square(10.0), 0.0);
        assert_eq!(pair.edges.len(), 1);
    }
}
