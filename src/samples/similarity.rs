//! How alike two neighbourhoods are, and which samples of them go together (Tu 2020 §4.2).

use glam::DVec2;

use super::area::Area;
use super::assignment::Assignment;
use super::graph::{Adjacency, Graph, Kind};
use super::neighbours::{Near, Neighbourhoods};
use super::options::Options;
use super::parallel::in_parallel;
use super::source::Source;

/// The price of leaving alone a sample that the maker gave, in parts of δ, in place of the paper's infinity: more than a neighbourhood of others.
const GIVEN_PRICE: f64 = 100.0;

/// Up to so many edges all ways are tried, which is faster than an assignment problem; samples rarely have more.
const MOST_TRIED: usize = 4;

/// Costs for each sample well below this part of δ do not count for more.
const VOTE_FLOOR: f64 = 0.1;

/// The output beside the exemplar, for one search.
pub struct Likeness<'a> {
    /// The exemplar.
    pub source: &'a Source,
    /// The output.
    pub graph: &'a Graph,
    /// What is near each sample of the output.
    pub near: &'a Neighbourhoods,
    area: &'a Area,
    options: &'a Options,
    spacing_mm: f64,
    /// γ · Ê of Eq. 5, by sample of the output and of the exemplar.
    edges: Vec<f32>,
    /// c by sample of the output.
    prices: Vec<f64>,
}

/// What goes together around a sample of the output and one of the exemplar.
#[derive(Debug, Clone, Default)]
pub struct Matching {
    /// The sample of the exemplar in the middle.
    pub middle: usize,
    /// How much its votes count: the more, the better it suits (as in Kwatra et al. 2005).
    pub weight: f64,
    /// Every sample of the output's neighbourhood with the exemplar's, if it has one.
    pub pairs: Vec<(usize, Option<usize>)>,
    /// What the exemplar has there and the output has not: the sample, and the offset from the middle.
    pub missing: Vec<(usize, DVec2)>,
}

/// Room for one comparison after the other.
#[derive(Default)]
pub struct Workspace {
    problem: Assignment,
}

impl<'a> Likeness<'a> {
    /// Prepares to compare the output's neighbourhoods `near` with the exemplar's.
    pub fn new(
        source: &'a Source,
        (graph, near): (&'a Graph, &'a Neighbourhoods),
        area: &'a Area,
        options: &'a Options,
        spacing_mm: f64,
    ) -> Self {
        let adjacency = graph.adjacency();
        let price = &options.unmatched;
        let element_mm = price.element * mean_nearest(near, graph);
        let prices = (0..graph.samples.len())
            .map(|s| match (graph.samples[s].is_given, graph.samples[s].kind) {
                (true, _) => GIVEN_PRICE * spacing_mm,
                _ if options.without.robust => GIVEN_PRICE * spacing_mm,
                (false, Kind::Curve) => {
                    (price.least + price.per_edge * adjacency.degree(s) as f64).min(price.most) * spacing_mm
                }
                (false, Kind::Element { .. }) => element_mm,
            })
            .collect();
        let edges = match options.without.edges {
            true => Vec::new(),
            false => edge_table(source, graph, &adjacency, area, options, spacing_mm),
        };
        Self { source, graph, near, area, options, spacing_mm, edges, prices }
    }

    fn edge_cost(&self, output: usize, input: usize) -> f64 {
        match self.edges.is_empty() {
            true => 0.0,
            false => f64::from(self.edges[output * self.source.graph.samples.len() + input]),
        }
    }

    /// The cost of Eq. 7 around `output` and `input`, if it is below `bound`.
    pub fn cost(&self, output: usize, input: usize, bound: f64, workspace: &mut Workspace) -> Option<f64> {
        self.fill(output, input, &mut workspace.problem);
        let missing = self.missing_cost(output, input);
        if workspace.problem.bound() + missing >= bound {
            return None;
        }
        let cost = workspace.problem.solve() + missing;
        (cost < bound).then_some(cost)
    }

    /// What goes together there.
    pub fn matching(&self, output: usize, input: usize, workspace: &mut Workspace) -> Matching {
        self.fill(output, input, &mut workspace.problem);
        let cost = workspace.problem.solve() + self.missing_cost(output, input);
        let (outputs, inputs) = (self.near.of(output), self.source.near.of(input));
        let mut is_taken = vec![false; inputs.len()];
        let pairs = outputs
            .iter()
            .enumerate()
            .map(|(row, near)| {
                let column = workspace.problem.column(row);
                column.inspect(|&column| is_taken[column] = true);
                (near.sample, column.map(|column| inputs[column].sample))
            })
            .collect();
        let missing = inputs.iter().zip(&is_taken).filter(|&(_, is_taken)| !is_taken);
        let missing = missing.map(|(near, _)| (near.sample, near.offset)).collect();
        let each = cost / (outputs.len() as f64 * self.spacing_mm);
        let weight = (VOTE_FLOOR + each).powf(-self.options.vote_power);
        Matching { middle: input, weight, pairs, missing }
    }

    /// The problem of Eq. 9. A pair dearer than staying alone is never taken, so it is left out.
    fn fill(&self, output: usize, input: usize, problem: &mut Assignment) {
        let inputs = self.source.near.of(input);
        problem.clear(inputs.len());
        let samples = &self.source.graph.samples;
        for a in self.near.of(output) {
            let price = self.prices[a.sample];
            let kind = self.graph.samples[a.sample].kind;
            for (column, b) in inputs.iter().enumerate() {
                let d2 = a.offset.distance_squared(b.offset);
                if d2 >= price * price || samples[b.sample].kind != kind {
                    continue;
                }
                let cost = d2.sqrt() + self.edge_cost(a.sample, b.sample);
                if cost < price {
                    problem.price(column, cost);
                }
            }
            problem.end_row(price);
        }
    }

    /// The price of what the exemplar has more of, which the paper has not.
    fn missing_cost(&self, output: usize, input: usize) -> f64 {
        let price = self.options.missing_price;
        if price == 0.0 {
            return 0.0;
        }
        let at = self.graph.samples[output].at;
        let has = self.near.of(output).len();
        let wanted = self.source.near.of(input);
        // At the border of the area there is less by right.
        let wanted = match has < wanted.len() {
            true => wanted.iter().filter(|near| self.area.contains(at + near.offset)).count(),
            false => wanted.len(),
        };
        price * self.spacing_mm * wanted.saturating_sub(has) as f64
    }
}

/// The mean distance from a sample of an element to the nearest other one of another element, in millimetres.
fn mean_nearest(near: &Neighbourhoods, graph: &Graph) -> f64 {
    let nearest = |s: usize| {
        let own = graph.samples[s].element;
        let is_other =
            |n: &&Near| graph.samples[n.sample].kind != Kind::Curve && graph.samples[n.sample].element != own;
        let others = near.of(s)[1..].iter().filter(is_other);
        others.map(|n| n.offset.length()).min_by(f64::total_cmp)
    };
    let elements = (0..graph.samples.len()).filter(|&s| graph.samples[s].kind != Kind::Curve);
    let found: Vec<f64> = elements.filter_map(nearest).collect();
    let widest =
        (0..graph.samples.len()).flat_map(|s| near.of(s)).map(|n| n.offset.length()).fold(0.0, f64::max);
    if found.is_empty() { 0.5 * widest } else { found.iter().sum::<f64>() / found.len() as f64 }
}

/// γ · Ê between all samples of curves (Eq. 5).
fn edge_table(
    source: &Source,
    graph: &Graph,
    adjacency: &Adjacency,
    area: &Area,
    options: &Options,
    spacing_mm: f64,
) -> Vec<f32> {
    let (gamma, beta) = (options.attribute_weight, options.edge_count_price * spacing_mm);
    let vectors = |graph: &Graph, adjacency: &Adjacency, s: usize, way: &dyn Fn(DVec2, DVec2) -> DVec2| {
        let to = |&(_, other): &(usize, usize)| way(graph.samples[s].at, graph.samples[other].at);
        adjacency.of(s).iter().map(to).collect::<Vec<DVec2>>()
    };
    let inputs: Vec<Vec<DVec2>> = (0..source.graph.samples.len())
        .map(|s| vectors(&source.graph, &source.adjacency, s, &|a, b| b - a))
        .collect();
    let rows = in_parallel(graph.samples.len(), |s| {
        let own = vectors(graph, adjacency, s, &|a, b| area.way(a, b));
        inputs.iter().map(|input| (gamma * edge_difference(&own, input, beta)) as f32).collect::<Vec<f32>>()
    });
    rows.concat()
}

/// Ê of Eq. 5 between two sets of edges as vectors: the least sum of distances of a matching, and β for each that is too many or too few.
/// A sample without edges is new and differs from none.
pub fn edge_difference(a: &[DVec2], b: &[DVec2], beta: f64) -> f64 {
    if a.is_empty() {
        return 0.0;
    }
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let matched = if many.len() > MOST_TRIED { assigned(few, many) } else { least(few, many, 0) };
    matched + beta * (many.len() - few.len()) as f64
}

/// The least sum as an assignment problem.
fn assigned(few: &[DVec2], many: &[DVec2]) -> f64 {
    let mut problem = Assignment::default();
    problem.clear(many.len());
    for a in few {
        many.iter().enumerate().for_each(|(column, b)| problem.price(column, a.distance(*b)));
        // Dearer than all matches together, so that nobody stays alone.
        problem.end_row(many.iter().chain(few).map(|v| 2.0 * v.length()).sum::<f64>() + 1.0);
    }
    problem.solve()
}

/// The least sum over all ways to give each of `few` one of `many`, of those not in the bits of `taken`.
fn least(few: &[DVec2], many: &[DVec2], taken: u32) -> f64 {
    let Some((first, rest)) = few.split_first() else { return 0.0 };
    let ways = (0..many.len()).filter(|j| taken & (1 << j) == 0);
    ways.map(|j| first.distance(many[j]) + least(rest, many, taken | 1 << j)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eq. 5 by hand: the nearest edges go together, and each that is left over costs β.
    #[test]
    fn edges_are_matched_and_counted() {
        let [right, up, left] = [DVec2::X, DVec2::Y, DVec2::NEG_X];
        assert_eq!(edge_difference(&[right], &[right], 5.0), 0.0);
        assert_eq!(edge_difference(&[right, up], &[up, right], 5.0), 0.0);
        assert_eq!(edge_difference(&[right], &[left], 5.0), 2.0);
        assert_eq!(edge_difference(&[right, up], &[up], 5.0), 5.0);
        assert_eq!(edge_difference(&[up], &[left, up * 1.5, right], 5.0), 0.5 + 10.0);
        // A new sample differs from none, but a sample with edges differs from one without.
        assert_eq!(edge_difference(&[], &[right, up], 5.0), 0.0);
        assert_eq!(edge_difference(&[right, up], &[], 5.0), 10.0);
    }

    #[test]
    fn the_least_of_all_ways_is_found_for_stars() {
        let star =
            |turn: f64| (0..8).map(|i| DVec2::from_angle(turn + f64::from(i) * 0.785)).collect::<Vec<_>>();
        let (a, b) = (star(0.0), star(0.1));
        let each = DVec2::X.distance(DVec2::from_angle(0.1));
        assert!((edge_difference(&a, &b, 1.0) - 8.0 * each).abs() < 1e-9);
    }
}
