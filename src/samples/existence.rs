//! Which samples there are: those that most neighbourhoods have a use for (Tu 2020 §4.3.4, Eq. 15 and Algorithm 1).

use glam::DVec2;

use super::area::Area;
use super::graph::{Graph, Kind, Sample};
use super::neighbours::Buckets;
use super::options::Options;
use super::similarity::Matching;
use super::source::Source;

/// Sets i(s) of every sample: the part of the neighbourhoods around it that have a match for it.
pub fn believe(graph: &mut Graph, matchings: &[Matching]) {
    let mut votes = vec![[0.0; 2]; graph.samples.len()];
    for matching in matchings {
        for &(sample, input) in &matching.pairs {
            votes[sample][0] += if input.is_some() { matching.weight } else { 0.0 };
            votes[sample][1] += matching.weight;
        }
    }
    for (sample, [matched, all]) in graph.samples.iter_mut().zip(votes) {
        sample.existence = if sample.is_given { 1.0 } else { matched / all };
    }
}

/// Where the exemplar has a sample and the output none, in the sight of some neighbourhoods.
struct Cluster {
    kind: Kind,
    sum: DVec2,
    weight: f64,
    members: Vec<(DVec2, usize)>,
}

impl Cluster {
    fn middle(&self) -> DVec2 {
        self.sum / self.weight
    }
}

/// The samples that are missing (Algorithm 1): what most neighbourhoods over a place would have there. None of them lies outside of the
/// area. Elements come as their middles; `is_wanted` says which kinds may come at all.
pub fn missing(
    graph: &Graph,
    source: &Source,
    matchings: &[Matching],
    area: &Area,
    options: &Options,
    (radius_mm, spacing_mm): (f64, f64),
    is_wanted: impl Fn(Kind) -> bool,
) -> Vec<(Sample, usize)> {
    let near_mm = options.cluster * spacing_mm;
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut cells: rustc_hash::FxHashMap<(i64, i64), Vec<usize>> = rustc_hash::FxHashMap::default();
    let cell = |p: DVec2| ((p.x / near_mm).floor() as i64, (p.y / near_mm).floor() as i64);
    for (s, matching) in matchings.iter().enumerate() {
        for &(input, offset) in &matching.missing {
            let kind = source.graph.samples[input].kind;
            let at = area.home(graph.samples[s].at + offset);
            if !is_wanted(kind) || !area.contains(at) {
                continue;
            }
            // Rolled, a cluster may lie beyond the seam.
            let laps = area.lap_mm().map_or(vec![0.0], |lap_mm| vec![0.0, lap_mm, -lap_mm]);
            let around = laps.into_iter().flat_map(|lap_mm| {
                let (x, y) = cell(at + DVec2::new(lap_mm, 0.0));
                (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (x + dx, y + dy)))
            });
            let nearest = around
                .filter_map(|key| cells.get(&key))
                .flatten()
                .filter(|&&c| clusters[c].kind == kind)
                .map(|&c| (area.way(clusters[c].middle(), at).length(), c))
                .filter(|(d, _)| *d < near_mm)
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            match nearest {
                Some((_, c)) => {
                    let old = cell(clusters[c].middle());
                    let middle = clusters[c].middle();
                    let at = middle + area.way(middle, at);
                    clusters[c].sum += at * matching.weight;
                    clusters[c].weight += matching.weight;
                    clusters[c].members.push((at, input));
                    let new = cell(clusters[c].middle());
                    if old != new {
                        cells.entry(old).or_default().retain(|&other| other != c);
                        cells.entry(new).or_default().push(c);
                    }
                }
                None => {
                    cells.entry(cell(at)).or_default().push(clusters.len());
                    clusters.push(Cluster {
                        kind,
                        sum: at * matching.weight,
                        weight: matching.weight,
                        members: vec![(at, input)],
                    });
                }
            }
        }
    }
    let points: Vec<DVec2> = graph.samples.iter().map(|s| s.at).collect();
    let buckets = Buckets::new(&points, radius_mm, Some(area));
    clusters
        .iter()
        .filter_map(|cluster| {
            let at = cluster.middle();
            let mut over = 0.0;
            buckets.within(at, radius_mm, |s, _| over += matchings[s].weight);
            let existence = if over > 0.0 { cluster.weight / over } else { 0.0 };
            if existence <= options.least_existence || !area.contains(at) {
                return None;
            }
            // The member in the middle stands for all.
            let &(_, input) = cluster.members.iter().min_by(|a, b| {
                a.0.distance_squared(at).total_cmp(&b.0.distance_squared(at)).then(a.1.cmp(&b.1))
            })?;
            let like = &source.graph.samples[input];
            let sample =
                Sample { at: area.home(at), existence: existence.min(1.0), is_given: false, ..like.clone() };
            Some((sample, input))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::area::tests::{rolled, square};
    use crate::samples::sampling::curve_sample;

    fn graph(points: &[(f64, f64)]) -> Graph {
        let samples = points.iter().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        Graph { samples, ..Graph::default() }
    }

    fn seen(middle: usize, pairs: &[(usize, Option<usize>)], missing: &[(usize, DVec2)]) -> Matching {
        Matching { middle, weight: 1.0, pairs: pairs.to_vec(), missing: missing.to_vec() }
    }

    fn found(graph: &Graph, matchings: &[Matching], area: &Area) -> Vec<DVec2> {
        let source = Source::new(
            super::tests::graph(&[(10.0, 10.0), (14.0, 10.0)]),
            (DVec2::ZERO, DVec2::splat(20.0)),
            8.0,
        );
        let options = Options::default();
        let all = missing(graph, &source, matchings, area, &options, (8.0, 4.0), |_| true);
        all.into_iter().map(|(sample, _)| sample.at).collect()
    }

    /// Eq. 15 as in Tu 2020 Figure 7: the part of the neighbourhoods that have a match.
    #[test]
    fn existence_is_the_part_of_those_that_match() {
        let mut three = graph(&[(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]);
        let both = [(0, Some(0)), (1, Some(1))];
        let matchings =
            [seen(0, &both, &[]), seen(1, &both, &[]), seen(0, &[(2, None), (0, None), (1, Some(1))], &[])];
        believe(&mut three, &matchings);
        let existence: Vec<f64> = three.samples.iter().map(|s| s.existence).collect();
        assert!((existence[0] - 2.0 / 3.0).abs() < 1e-12 && existence[1..] == [1.0, 0.0], "{existence:?}");
    }

    /// Algorithm 1: what two of three neighbourhoods over a place lack is added, what one lacks is not, and nothing is added outside.
    #[test]
    fn what_most_lack_is_added() {
        let three = graph(&[(10.0, 10.0), (12.0, 10.0), (11.0, 12.0)]);
        let lacks = |dx: f64, dy: f64| vec![(1, DVec2::new(dx, dy))];
        let two = [seen(0, &[], &lacks(4.0, 0.0)), seen(0, &[], &lacks(2.2, 0.0)), seen(0, &[], &[])];
        let added = found(&three, &two, &square(50.0));
        assert_eq!(added.len(), 1);
        assert!(added[0].distance(DVec2::new(14.1, 10.0)) < 1e-9, "{added:?}");
        let one = [seen(0, &[], &lacks(4.0, 0.0)), seen(0, &[], &[]), seen(0, &[], &[])];
        assert!(found(&three, &one, &square(50.0)).is_empty());
        assert!(found(&three, &two, &square(13.0)).is_empty());
    }

    #[test]
    fn clusters_lie_over_a_seam() {
        let two = graph(&[(98.0, 10.0), (2.0, 10.0)]);
        let lacks = |dx: f64| vec![(1, DVec2::new(dx, 0.0))];
        let matchings = [seen(0, &[], &lacks(1.9)), seen(0, &[], &lacks(-1.9))];
        let added = found(&two, &matchings, &rolled(100.0, 20.0));
        assert_eq!(added.len(), 1, "{added:?}");
    }
}
