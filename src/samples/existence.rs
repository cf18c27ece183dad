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
            let (x, y) = cell(at);
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
            let nearest = around
                .filter_map(|key| cells.get(&key))
                .flatten()
                .filter(|&&c| clusters[c].kind == kind)
                .map(|&c| (clusters[c].middle().distance(at), c))
                .filter(|(d, _)| *d < near_mm)
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            match nearest {
                Some((_, c)) => {
                    let old = cell(clusters[c].middle());
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
                    cells.entry((x, y)).or_default().push(clusters.len());
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
            let sample = Sample { at, existence: existence.min(1.0), is_given: false, ..like.clone() };
            Some((sample, input))
        })
        .collect()
}
