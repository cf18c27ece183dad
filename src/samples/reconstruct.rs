//! From a sample graph to curves (Tu 2020 §4.4.2).
//!
//! At each sample the directions in which paths leave it are matched with its edges, and two edges whose directions are opposite are one
//! path that passes through; so every edge is in exactly one path. Unlike the paper's, a path also goes on through a sample with two
//! edges that are not opposite, as a corner, and an edge is the cubic curve that was voted for with it, made smooth where a path passes.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use kurbo::{BezPath, Point};

use super::assignment::Assignment;
use super::graph::Adjacency;
use super::orientations::{matched, turn};
use super::{Area, Curve, Drawing, Element, Graph, Kind, Options};

/// A loop whose ends are as near as this part of a millimetre is closed; one that leads round a rolled area is not.
const CLOSES_MM: f64 = 1e-6;

/// A path through the graph. Its edges are in the order in which it runs, edge i from sample i to the next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Route {
    /// The samples it passes; that of a closed one where it begins is not repeated.
    pub samples: Vec<usize>,
    /// Its edges.
    pub edges: Vec<usize>,
    /// Whether it ends where it begins; in a rolled area it may have gone round.
    pub is_closed: bool,
}

/// A pattern as it is drawn, and how that follows from its graph.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reconstruction {
    /// The strokes, one for each path in their order, and the elements.
    pub drawing: Drawing,
    /// The paths: every edge is in exactly one.
    pub paths: Vec<Route>,
    /// For each edge, from its ends to the control points of its cubic curve, in millimetres, as drawn.
    pub handles: Vec<[DVec2; 2]>,
    /// How many samples of curves have no edge, of which nothing is drawn.
    pub lone_samples: usize,
}

/// Draws the paths of a graph, and `elements` with them. In a rolled area a path is drawn in one piece from its first sample on.
pub fn reconstruct(graph: &Graph, elements: &[Element], area: &Area, options: &Options) -> Reconstruction {
    let adjacency = graph.adjacency();
    let weave = Weave::new(graph, &adjacency, area, options);
    let handles = weave.handles();
    let paths = weave.routes();
    let curves = paths.iter().map(|route| weave.curve(route, &handles)).collect();
    let is_lone = |&i: &usize| graph.samples[i].kind == Kind::Curve && adjacency.degree(i) == 0;
    Reconstruction {
        drawing: Drawing { curves, elements: elements.to_vec() },
        lone_samples: (0..graph.samples.len()).filter(is_lone).count(),
        paths,
        handles,
    }
}

/// One end of an edge: the edge, and 0 or 1.
type End = (usize, usize);

/// How a path goes on where an edge ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Onward {
    /// The end of the next edge at the same sample.
    to: End,
    /// Otherwise there is a corner.
    is_smooth: bool,
}

/// Where at each sample paths pass from one edge to the other.
struct Weave<'a> {
    graph: &'a Graph,
    area: &'a Area,
    /// Whether directions are used, or chords only.
    has_directions: bool,
    /// By edge and end.
    onward: Vec<[Option<Onward>; 2]>,
}

impl<'a> Weave<'a> {
    fn new(graph: &'a Graph, adjacency: &Adjacency, area: &'a Area, options: &Options) -> Self {
        let has_directions = !options.without.orientation;
        let mut weave = Self { graph, area, has_directions, onward: vec![[None; 2]; graph.edges.len()] };
        let opposite = if has_directions { options.opposite } else { FRAC_PI_2 };
        let mut problem = Assignment::default();
        for sample in 0..graph.samples.len() {
            let ends: Vec<End> = adjacency
                .of(sample)
                .iter()
                .map(|&(edge, _)| (edge, usize::from(graph.edges[edge].ends[1] == sample)))
                .collect();
            weave.pass(sample, &ends, opposite, &mut problem);
        }
        weave
    }

    /// Pairs the edges that end at a sample: the ones that are most nearly opposite first.
    fn pass(&mut self, sample: usize, ends: &[End], opposite: f64, problem: &mut Assignment) {
        let directions = self.directions(sample, ends, problem);
        let mut pairs = Vec::new();
        for j in 0..ends.len() {
            for i in 0..j {
                let bend = PI - turn(directions[i], directions[j]);
                if bend < opposite || ends.len() == 2 {
                    pairs.push((bend, i, j));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (bend, i, j) in pairs {
            let [a, b] = [ends[i], ends[j]];
            if self.onward[a.0][a.1].is_none() && self.onward[b.0][b.1].is_none() {
                let is_smooth = bend < opposite;
                self.onward[a.0][a.1] = Some(Onward { to: b, is_smooth });
                self.onward[b.0][b.1] = Some(Onward { to: a, is_smooth });
            }
        }
    }

    /// The angle at which the path along each edge leaves a sample: the direction of the sample that is matched with it, its own where
    /// there is none.
    fn directions(&self, sample: usize, ends: &[End], problem: &mut Assignment) -> Vec<f64> {
        let mut own: Vec<f64> = ends.iter().map(|&end| self.leaving(end).to_angle()).collect();
        let given = &self.graph.samples[sample].orientations;
        if self.has_directions {
            for (direction, end) in matched(given, &own, problem).into_iter().enumerate() {
                if let Some(end) = end {
                    own[end] = given[direction];
                }
            }
        }
        own
    }

    /// The way from one end of an edge to the other.
    fn chord(&self, (edge, end): End) -> DVec2 {
        let at = |end: usize| self.graph.samples[self.graph.edges[edge].ends[end]].at;
        self.area.way(at(end), at(1 - end))
    }

    fn handle(&self, (edge, end): End) -> Option<DVec2> {
        let handle = self.graph.edges[edge].handles[end];
        (self.has_directions && handle != DVec2::ZERO).then_some(handle)
    }

    fn leaving(&self, end: End) -> DVec2 {
        self.handle(end).unwrap_or_else(|| self.chord(end))
    }

    /// The handles as drawn: those of the edges, opposite where a path passes smoothly; where there are none, along the line from the
    /// sample before to the sample after, as Catmull and Rom's splines have them.
    fn handles(&self) -> Vec<[DVec2; 2]> {
        let smooth = |end: End| {
            let onward = self.onward[end.0][end.1].filter(|onward| onward.is_smooth)?;
            let along = match (self.handle(end), self.handle(onward.to)) {
                (Some(a), Some(b)) => a.normalize() - b.normalize(),
                (Some(a), None) => a,
                (None, Some(b)) => -b,
                (None, None) => self.chord(end) - self.chord(onward.to),
            };
            let length = self.handle(end).map_or(self.chord(end).length() / 3.0, DVec2::length);
            along.try_normalize().map(|along| along * length)
        };
        let drawn = |edge: usize| {
            let known = [0, 1].map(|end| smooth((edge, end)).or(self.handle((edge, end))));
            [0, 1].map(|end| known[end].unwrap_or_else(|| bent_as(self.chord((edge, end)), known[1 - end])))
        };
        (0..self.graph.edges.len()).map(drawn).collect()
    }

    /// The paths: those that end, in the order of their first edges, then those that close.
    fn routes(&self) -> Vec<Route> {
        let mut is_used = vec![false; self.graph.edges.len()];
        let ends = || (0..self.graph.edges.len()).flat_map(|edge| [(edge, 0), (edge, 1)]);
        let mut routes = Vec::new();
        for (edge, end) in ends().filter(|&(edge, end)| self.onward[edge][end].is_none()).chain(ends()) {
            if !is_used[edge] {
                routes.push(self.route((edge, end), &mut is_used));
            }
        }
        routes
    }

    fn route(&self, first: End, is_used: &mut [bool]) -> Route {
        let mut route = Route { samples: Vec::new(), edges: Vec::new(), is_closed: false };
        let mut at = first;
        loop {
            let (edge, end) = at;
            is_used[edge] = true;
            route.samples.push(self.graph.edges[edge].ends[end]);
            route.edges.push(edge);
            match self.onward[edge][1 - end] {
                Some(onward) if onward.to == first => {
                    route.is_closed = true;
                    return route;
                }
                Some(onward) => at = onward.to,
                None => {
                    route.samples.push(self.graph.edges[edge].ends[1 - end]);
                    return route;
                }
            }
        }
    }

    fn curve(&self, route: &Route, handles: &[[DVec2; 2]]) -> Curve {
        let mut at = self.graph.samples[route.samples[0]].at;
        let begin = at;
        let mut path = BezPath::new();
        path.move_to(point(at));
        for (i, (&edge, &sample)) in route.edges.iter().zip(&route.samples).enumerate() {
            let end = usize::from(self.graph.edges[edge].ends[1] == sample);
            let mut next = at + self.chord((edge, end));
            let [leaving, reaching] = [handles[edge][end], next + handles[edge][1 - end]];
            let is_last = i + 1 == route.edges.len();
            if is_last && route.is_closed && next.distance(begin) < CLOSES_MM {
                next = begin;
            }
            path.curve_to(point(at + leaving), point(reaching), point(next));
            at = next;
        }
        if route.is_closed && at == begin {
            path.close_path();
        }
        // What goes on from a stroke that was given has a pen of its own.
        let samples = || route.samples.iter().map(|&sample| &self.graph.samples[sample]);
        let mut widths: Vec<f64> = samples().filter(|s| !s.is_given).map(|s| s.width_mm).collect();
        if widths.is_empty() {
            widths = samples().map(|s| s.width_mm).collect();
        }
        let width_mm = widths.iter().sum::<f64>() / widths.len() as f64;
        Curve { path, width_mm }
    }
}

/// The handle of an end that has none: the curve is one of the second degree, as bent as the other end has it.
fn bent_as(chord: DVec2, other: Option<DVec2>) -> DVec2 {
    let handle = other.map_or(chord / 3.0, |other| 2.0 / 3.0 * chord + other);
    if handle.dot(chord) > 0.0 { handle } else { chord / 3.0 }
}

pub(super) fn point(p: DVec2) -> Point {
    Point::new(p.x, p.y)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use kurbo::PathEl;
    use proptest::prelude::*;

    use super::*;
    use crate::planar::{FillRule, Grid, Region};
    use crate::samples::{Edge, Sample};

    fn area(lap_mm: Option<f64>) -> Area {
        let grid = Grid::for_extent(400.0).unwrap();
        let corners = [(-200.0, -200.0), (200.0, -200.0), (200.0, 200.0), (-200.0, 200.0)];
        let path = corners.map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).to_vec();
        let region = Region::fill(grid, &[path], FillRule::NonZero);
        match lap_mm {
            Some(lap_mm) => Area::rolled(region, lap_mm),
            None => Area::new(region),
        }
    }

    fn sample(x: f64, y: f64, orientations: &[f64]) -> Sample {
        Sample {
            at: DVec2::new(x, y),
            kind: Kind::Curve,
            orientations: orientations.to_vec(),
            width_mm: 1.0,
            existence: 1.0,
            is_given: false,
            element: 0,
        }
    }

    fn graph(samples: Vec<Sample>, edges: &[(usize, usize)]) -> Graph {
        let edge =
            |&(a, b): &(usize, usize)| Edge { ends: [a, b], confidence: 1.0, handles: [DVec2::ZERO; 2] };
        Graph { samples, edges: edges.iter().map(edge).collect(), unrealised: Vec::new() }
    }

    #[test]
    fn directions_decide_which_edges_of_a_junction_are_one_path() {
        // Three edges that leave the middle to the left, to the right and up.
        let at = |middle: &[f64]| {
            vec![
                sample(0.0, 0.0, middle),
                sample(-9.0, 0.0, &[]),
                sample(9.0, 0.0, &[]),
                sample(0.0, 9.0, &[]),
            ]
        };
        let edges = [(0, 1), (0, 2), (0, 3)];
        let routes = |middle: &[f64], options: &Options| {
            let found = reconstruct(&graph(at(middle), &edges), &[], &area(None), options);
            found.paths.into_iter().map(|route| route.samples).collect::<Vec<_>>()
        };
        let options = Options::default();
        assert_eq!(routes(&[PI, 0.0, FRAC_PI_2], &options), [vec![1, 0, 2], vec![0, 3]]);
        // The path from below bends to the right.
        assert_eq!(routes(&[PI, 0.35 * PI - PI + TAU, 0.35 * PI], &options), [vec![0, 1], vec![2, 0, 3]]);
        let mut without = Options::default();
        without.without.orientation = true;
        assert_eq!(routes(&[PI, 0.35 * PI - PI + TAU, 0.35 * PI], &without), [vec![1, 0, 2], vec![0, 3]]);
    }

    #[test]
    fn handles_of_a_smooth_path_are_opposite_and_corners_stay() {
        let samples = vec![
            sample(0.0, 0.0, &[0.0]),
            sample(9.0, 0.0, &[PI, 0.1]),
            sample(18.0, 1.0, &[PI, FRAC_PI_2]),
            sample(18.0, 9.0, &[]),
        ];
        let mut graph = graph(samples, &[(0, 1), (1, 2), (2, 3)]);
        graph.edges[0].handles = [DVec2::new(3.0, 0.0), DVec2::new(-3.0, -0.2)];
        graph.edges[1].handles = [DVec2::new(2.0, 0.0), DVec2::new(-3.0, 0.0)];
        let found = reconstruct(&graph, &[], &area(None), &Options::default());
        assert_eq!(
            found.paths,
            [Route { samples: vec![0, 1, 2, 3], edges: vec![0, 1, 2], is_closed: false }]
        );
        let [a, b] = [found.handles[0][1], found.handles[1][0]];
        assert!(a.perp_dot(b).abs() < 1e-12 && a.dot(b) < 0.0, "{a} and {b}");
        assert_eq!(found.handles[1][1], DVec2::new(-3.0, 0.0));
        assert_eq!(found.handles[2][0], DVec2::new(0.0, 8.0 / 3.0));
    }

    #[test]
    fn what_goes_on_from_a_given_stroke_has_its_own_pen() {
        let mut graph = graph(
            vec![sample(0.0, 0.0, &[]), sample(9.0, 0.0, &[]), sample(18.0, 0.0, &[])],
            &[(0, 1), (1, 2)],
        );
        (graph.samples[0].width_mm, graph.samples[0].is_given) = (4.0, true);
        let widths = |graph: &Graph| -> Vec<f64> {
            let found = reconstruct(graph, &[], &area(None), &Options::default());
            found.drawing.curves.iter().map(|curve| curve.width_mm).collect()
        };
        assert_eq!(widths(&graph), [1.0]);
        graph.samples.iter_mut().for_each(|sample| sample.is_given = true);
        assert_eq!(widths(&graph), [2.0]);
    }

    #[test]
    fn a_path_goes_the_short_way_round_a_rolled_area() {
        let samples = (0..4).map(|i| sample(10.0 * f64::from(i), 0.0, &[0.0, PI])).collect();
        let graph = graph(samples, &[(0, 1), (1, 2), (2, 3), (0, 3)]);
        let found = reconstruct(&graph, &[], &area(Some(40.0)), &Options::default());
        let [route] = &found.paths[..] else { panic!("one path goes round") };
        assert!(route.is_closed);
        let path = &found.drawing.curves[0].path;
        assert!(!path.elements().contains(&PathEl::ClosePath), "it is drawn open");
        let bounds = kurbo::Shape::bounding_box(path);
        assert!((bounds.width() - 40.0).abs() < 1e-9 && bounds.height() < 1e-9);
    }

    proptest! {
        #[test]
        fn every_edge_is_in_exactly_one_path(
            places in prop::collection::vec((0.0f64..100.0, 0.0f64..50.0, prop::collection::vec(0.0..TAU, 0..5)), 3..30),
            pairs in prop::collection::btree_set((0usize..30, 0usize..30), 0..60),
            is_rolled in prop::bool::ANY,
            without in prop::bool::ANY,
        ) {
            let samples: Vec<Sample> = places.iter().map(|(x, y, o)| sample(*x, *y, o)).collect();
            let count = samples.len();
            let edges: std::collections::BTreeSet<_> =
                pairs.iter().map(|&(a, b)| (a % count, b % count)).filter(|(a, b)| a < b).collect();
            let graph = graph(samples, &edges.into_iter().collect::<Vec<_>>());
            let area = area(is_rolled.then_some(100.0));
            let mut options = Options::default();
            options.without.orientation = without;
            let found = reconstruct(&graph, &[], &area, &options);
            let mut used: Vec<usize> = found.paths.iter().flat_map(|route| route.edges.clone()).collect();
            used.sort_unstable();
            prop_assert_eq!(used, (0..graph.edges.len()).collect::<Vec<_>>());
            for (route, curve) in found.paths.iter().zip(&found.drawing.curves) {
                prop_assert_eq!(route.samples.len(), route.edges.len() + usize::from(!route.is_closed));
                for (i, &edge) in route.edges.iter().enumerate() {
                    let [a, b] = [route.samples[i], route.samples[(i + 1) % route.samples.len()]];
                    prop_assert_eq!(graph.edges[edge].ends, [a.min(b), a.max(b)]);
                }
                prop_assert_eq!(curve.path.segments().count(), route.edges.len());
            }
            prop_assert!(found.handles.iter().flatten().all(|h| h.is_finite()));
        }
    }
}
