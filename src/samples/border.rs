//! The border of the area: the pattern is synthesized a little beyond it and cut there.
//!
//! Neighbourhoods at a border are halves, and the last samples of a strand are anywhere near it. Beyond the border neither matters. Excluded: cutting
//! elements, which are whole or are not there.

use glam::DVec2;

use super::area::Area;
use super::cubic::{Cubic, part, point_at};
use super::elements::{Elements, Placed};
use super::graph::{Edge, Graph, Kind, Sample, renumbered};
use crate::planar::Sets;

/// Bisections that find where an edge crosses the border.
const BISECTIONS: usize = 40;
/// Nearer to the border than this part of the length of a scrap, an end was cut there.
const ON_BORDER: f64 = 1e-6;
/// Chords by which an edge is looked at for crossings of the border.
const CHORDS: usize = 16;

/// Cuts the graph at the border of `area`: samples outside go, and edges end in new samples wherever they leave it, be it only over a narrow
/// hole. Elements whose ink is not wholly inside go too, and scraps of less than `least_mm` that are cut off. What was given stays where it is.
pub fn cut(graph: &mut Graph, elements: &mut Elements, area: &Area, least_mm: f64) {
    let drawn = |placed: &Placed| elements.classes[placed.class as usize].drawn(&placed.similarity);
    let element_stays: Vec<bool> =
        elements.placed.iter().map(|placed| area.covers_all(&drawn(placed))).collect();
    let mut stays: Vec<bool> = graph
        .samples
        .iter()
        .map(|s| match s.kind {
            Kind::Curve => s.is_given || area.contains(s.at),
            Kind::Element { .. } => element_stays[s.element as usize],
        })
        .collect();
    for edge in std::mem::take(&mut graph.edges) {
        let [a, b] = edge.ends;
        if edge.is_given() || graph.samples[a].kind != Kind::Curve {
            graph.edges.push(edge);
            continue;
        }
        let cubic = edge.cubic(&graph.samples, area);
        for [from, until] in stretches(&cubic, area) {
            let [p, q, r, s] = part(&cubic, from, until);
            let mut foot = |t: f64, old: usize, at: DVec2, handle: DVec2| {
                if t == (if old == a { 0.0 } else { 1.0 }) && stays[old] {
                    return old;
                }
                let orientations = vec![handle.to_angle().rem_euclid(std::f64::consts::TAU)];
                let like = graph.samples[old].clone();
                // What goes on from a stroke that was given has a pen of its own.
                let other = &graph.samples[if old == a { b } else { a }];
                let width_mm = if like.is_given { other.width_mm } else { like.width_mm };
                graph.samples.push(Sample {
                    at: area.home(at),
                    orientations,
                    width_mm,
                    is_given: false,
                    ..like
                });
                stays.push(true);
                graph.samples.len() - 1
            };
            let ends = [foot(from, a, p, q - p), foot(until, b, s, r - s)];
            let (ends, handles) = match ends[0] < ends[1] {
                true => (ends, [q - p, r - s]),
                false => ([ends[1], ends[0]], [r - s, q - p]),
            };
            graph.edges.push(Edge { ends, handles, ..edge });
        }
    }
    graph.keep(&stays);
    drop_scraps(graph, area, least_mm);
    let number_of = renumbered(&element_stays);
    for sample in graph.samples.iter_mut().filter(|s| s.kind != Kind::Curve) {
        sample.element = number_of[sample.element as usize] as u32;
    }
    let mut kept = element_stays.iter();
    elements.placed.retain(|_| *kept.next().expect("one for each element"));
}

/// Takes away what the border cut off in less than `least_mm` of line, and samples that are alone, which draw nothing.
fn drop_scraps(graph: &mut Graph, area: &Area, least_mm: f64) {
    let n = graph.samples.len();
    let mut sets = Sets::new(n);
    graph.edges.iter().for_each(|edge| sets.join(edge.ends[0], edge.ends[1]));
    let (mut lengths, mut is_cut) = (vec![0.0; n], vec![false; n]);
    for edge in &graph.edges {
        let [a, b] = edge.ends.map(|end| graph.samples[end].at);
        lengths[sets.find(edge.ends[0])] += area.way(a, b).length();
    }
    for s in 0..n {
        if area.depth_mm(graph.samples[s].at) < ON_BORDER * least_mm {
            is_cut[sets.find(s)] = true;
        }
    }
    let stays: Vec<bool> = (0..n)
        .map(|s| {
            let (sample, set) = (&graph.samples[s], sets.find(s));
            let is_scrap = lengths[set] == 0.0 || (is_cut[set] && lengths[set] < least_mm);
            sample.kind != Kind::Curve || sample.is_given || !is_scrap
        })
        .collect();
    graph.keep(&stays);
}

/// The stretches of a cubic that are inside of the area, by their parameters. Where chords cross the border says only where to look: what is
/// inside is decided between one crossing and the next, and the places where it changes are found between these.
pub fn stretches(cubic: &Cubic, area: &Area) -> Vec<[f64; 2]> {
    let is_inside = |t: f64| area.contains(point_at(cubic, t));
    let mut looks = vec![0.0, 1.0];
    if !area.is_crossed_near(cubic) {
        return if is_inside(0.5) { vec![[0.0, 1.0]] } else { Vec::new() };
    }
    for i in 0..CHORDS {
        let [from, to] = [i, i + 1].map(|i| point_at(cubic, i as f64 / CHORDS as f64));
        looks.extend(area.crossings(from, to).map(|part| (i as f64 + part) / CHORDS as f64));
    }
    looks.sort_by(f64::total_cmp);
    let mut found: Vec<[f64; 2]> = Vec::new();
    let mut before = (0.0, is_inside(0.0));
    let mut began = 0.0;
    let middles = looks.windows(2).filter(|w| w[0] < w[1]).map(|w| 0.5 * (w[0] + w[1]));
    for t in middles.chain([1.0]) {
        let now = is_inside(t);
        if now != before.1 {
            let change = changed(before.0, t, before.1, &is_inside);
            match now {
                true => began = change,
                false => found.push([began, change]),
            }
        }
        before = (t, now);
    }
    if before.1 {
        found.push([began, 1.0]);
    }
    found.retain(|[from, until]| from < until);
    found
}

/// The parameter between two at which inside and outside change, on its inner side.
fn changed(mut low: f64, mut high: f64, low_inside: bool, is_inside: &impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if is_inside(middle) == low_inside { low = middle } else { high = middle }
    }
    if low_inside { low } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid, Region};
    use crate::samples::area::tests::square;
    use crate::samples::elements::Similarity;
    use crate::samples::sampling::curve_sample;

    #[test]
    fn edges_end_on_the_border_and_scraps_go() {
        let points = [(5.0, 5.0), (13.0, 5.0), (9.0, 9.5), (12.0, 11.0), (2.0, 2.0)];
        let samples = points.iter().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        let edge = |a: usize, b: usize, h: DVec2| Edge { ends: [a, b], confidence: 1.0, handles: [h, -h] };
        let edges = vec![edge(0, 1, DVec2::X), edge(2, 3, DVec2::new(1.0, 0.5))];
        let mut graph = Graph { samples, edges, unrealised: Vec::new() };
        cut(&mut graph, &mut Elements::default(), &square(10.0), 2.0);
        // The long edge is cut at x = 10; what is left of the short one is a scrap, and a sample alone draws nothing.
        assert_eq!((graph.samples.len(), graph.edges.len()), (2, 1));
        let end = graph.samples[graph.edges[0].ends[1]].at;
        assert!(end.distance(DVec2::new(10.0, 5.0)) < 1e-6 && square(10.0).contains(end), "{end}");
    }

    #[test]
    fn what_leaves_a_thick_stroke_that_was_given_outside_has_its_own_pen() {
        let samples = [((5.0, -2.0), 4.0), ((5.0, 6.0), 1.0)];
        let samples = samples.map(|((x, y), width_mm)| curve_sample(DVec2::new(x, y), width_mm)).to_vec();
        let edges = vec![Edge { ends: [0, 1], confidence: 1.0, handles: [DVec2::Y, -DVec2::Y] }];
        let mut graph = Graph { samples, edges, unrealised: Vec::new() };
        graph.samples[0].is_given = true;
        cut(&mut graph, &mut Elements::default(), &square(10.0), 0.5);
        let [edge] = &graph.edges[..] else { panic!("one edge: {graph:?}") };
        assert!(
            edge.ends.iter().all(|&end| graph.samples[end].width_mm == 1.0 && !graph.samples[end].is_given)
        );
    }

    /// A square of 10 mm with a slit from x = 6 to x = 6.1, which ends in a corner at y = 8.
    fn slit() -> Area {
        let grid = Grid::for_extent(100.0).unwrap();
        let path = |points: &[(f64, f64)]| {
            points.iter().map(|&(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).collect::<Vec<_>>()
        };
        let outer = path(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]);
        let hole = path(&[(6.0, 2.0), (6.0, 8.0), (6.1, 8.0), (6.1, 2.0)]);
        Area::new(Region::fill(grid, &[outer, hole], FillRule::Positive))
    }

    #[test]
    fn edges_are_cut_at_every_narrow_hole() {
        let samples = [(1.0, 5.0), (9.0, 5.0), (1.0, 9.0), (9.0, 9.0)]
            .iter()
            .map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0))
            .collect();
        let edge = |a: usize, b: usize| Edge {
            ends: [a, b],
            confidence: 0.5,
            handles: [DVec2::X * 2.0, DVec2::X * -2.0],
        };
        let mut graph = Graph { samples, edges: vec![edge(0, 1), edge(2, 3)], unrealised: Vec::new() };
        cut(&mut graph, &mut Elements::default(), &slit(), 0.5);
        // The one across the slit is two now, and they end where it begins.
        assert_eq!((graph.samples.len(), graph.edges.len()), (6, 3));
        let mut ends: Vec<f64> = graph.samples[4..].iter().map(|s| s.at.x).collect();
        ends.sort_by(f64::total_cmp);
        assert!((ends[0] - 6.0).abs() < 1e-6 && (ends[1] - 6.1).abs() < 1e-6, "{ends:?}");
    }

    #[test]
    fn a_curve_between_two_samples_outside_stays_where_it_is_inside() {
        let cubic = [(-1.0, 1.0), (3.0, 9.0), (3.0, 9.0), (11.0, 11.0)].map(|(x, y)| DVec2::new(x, y));
        let [[from, until]] = stretches(&cubic, &slit())[..] else { panic!("one stretch") };
        assert!(0.0 < from && from < until && until < 1.0);
        let ends = [from, until].map(|t| point_at(&cubic, t));
        assert!(ends[0].x.abs() < 1e-6 && (ends[1].y - 10.0).abs() < 1e-6, "{ends:?}");
    }

    #[test]
    fn elements_over_a_narrow_hole_go() {
        let square = |at: DVec2| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let contour = corners.map(|(x, y)| at + DVec2::new(x, y)).to_vec();
            crate::samples::Element { contours: vec![contour] }
        };
        let middles = [DVec2::new(3.0, 5.0), DVec2::new(6.05, 5.0), DVec2::new(9.5, 5.0)];
        let mut elements = Elements::of(&middles.map(square));
        assert_eq!(elements.placed.len(), 3);
        cut(&mut Graph::default(), &mut elements, &slit(), 0.5);
        let left: Vec<Similarity> = elements.placed.iter().map(|placed| placed.similarity).collect();
        assert_eq!(left.len(), 1);
        assert!(left[0].shift.distance(middles[0]) < 1e-9);
    }
}
