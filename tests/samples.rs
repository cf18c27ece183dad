//! Sample graphs from exemplar to ink, by the library: what holds for every result.

use glam::DVec2;
use openwork::exemplar::{Linework, ReadOptions};
use openwork::planar::{FillRule, Grid, Region};
use openwork::samples::{
    Area, Border, CompleteOptions, Curve, Drawing, Element, Given, Kind, Options, SampleError, Start,
    Synthesis, complete, default_levels, reconstruct, synthesize,
};
use openwork::topology::Goal;
use proptest::prelude::*;

const EXEMPLARS: [&str; 6] = ["branches", "scales", "maze", "waves", "leaves", "rings"];

fn read(name: &str) -> Drawing {
    let file = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/samples/{}.svg"), name);
    let read = Linework::read(file.as_ref(), &ReadOptions::default()).unwrap();
    let curve = |line: &openwork::exemplar::Line| Curve { path: line.path.clone(), width_mm: line.width_mm };
    let element = |contours: &Vec<Vec<DVec2>>| Element { contours: contours.clone() };
    Drawing {
        curves: read.strokes().iter().map(curve).collect(),
        elements: read.elements().iter().map(element).collect(),
    }
}

fn polygon(points: &[(f64, f64)]) -> Vec<openwork::planar::GridPoint> {
    let grid = Grid::for_extent(300.0).unwrap();
    points.iter().map(|&(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).collect()
}

fn region(paths: &[&[(f64, f64)]]) -> Region {
    let paths: Vec<_> = paths.iter().map(|path| polygon(path)).collect();
    Region::fill(Grid::for_extent(300.0).unwrap(), &paths, FillRule::EvenOdd)
}

/// A square with a hole in it.
fn holed() -> Area {
    let outer = [(0.0, 0.0), (70.0, 0.0), (70.0, 60.0), (0.0, 60.0)];
    let inner = [(28.0, 20.0), (46.0, 24.0), (40.0, 42.0)];
    Area::new(region(&[&outer, &inner]))
}

fn options(exemplar: &Drawing, seed: u64) -> Options {
    Options { levels: default_levels(exemplar, 2, f64::INFINITY), seed, iterations: 4, ..Options::default() }
}

fn made(exemplar: &Drawing, area: &Area, options: &Options) -> Synthesis {
    synthesize(exemplar, area, options, &Given::default(), &mut |_, _| {}).unwrap()
}

fn elements(made: &Synthesis) -> Vec<Element> {
    let drawn = |placed: &openwork::samples::Placed| Element {
        contours: made.elements.classes[placed.class as usize].drawn(&placed.similarity),
    };
    made.elements.placed.iter().map(drawn).collect()
}

#[test]
fn no_sample_is_outside_of_the_area_and_no_element_reaches_out() {
    let area = holed();
    for name in EXEMPLARS {
        let exemplar = read(name);
        for (start, border) in
            [(Start::Patches, Border::Cut), (Start::Patches, Border::Within), (Start::Noise, Border::Cut)]
        {
            let made = made(&exemplar, &area, &Options { start, border, ..options(&exemplar, 3) });
            assert!(!made.graph.samples.is_empty());
            for sample in made.graph.samples.iter().filter(|s| s.kind == Kind::Curve) {
                assert!(area.contains(sample.at), "{name}: {} is outside", sample.at);
            }
            for p in elements(&made).iter().flat_map(|e| &e.contours).flatten() {
                assert!(area.contains(*p), "{name}: an element reaches out at {p}");
            }
            for sample in &made.graph.samples {
                assert!((0.0..=1.0).contains(&sample.existence), "{name}");
            }
        }
    }
}

#[test]
fn every_edge_is_drawn_once_and_joins_two_samples_of_curves() {
    for name in EXEMPLARS {
        let exemplar = read(name);
        let options = options(&exemplar, 5);
        let made = made(&exemplar, &holed(), &options);
        let drawn = reconstruct(&made.graph, &elements(&made), &holed(), &options);
        let mut edges: Vec<usize> = drawn.paths.iter().flat_map(|path| path.edges.iter().copied()).collect();
        edges.sort_unstable();
        assert_eq!(edges, (0..made.graph.edges.len()).collect::<Vec<_>>(), "{name}");
        let mut pairs: Vec<[usize; 2]> = made.graph.edges.iter().map(|edge| edge.ends).collect();
        assert!(pairs.iter().all(|[a, b]| a < b));
        assert!(pairs.iter().flatten().all(|&s| made.graph.samples[s].kind == Kind::Curve));
        pairs.sort_unstable();
        pairs.dedup();
        assert_eq!(pairs.len(), made.graph.edges.len(), "{name}: an edge is there twice");
    }
}

#[test]
fn energy_falls_at_every_level() {
    let (mut falls, mut levels) = (0, 0);
    for name in EXEMPLARS {
        let exemplar = read(name);
        let area = Area::new(region(&[&[(0.0, 0.0), (90.0, 0.0), (90.0, 90.0), (0.0, 90.0)]]));
        let options =
            Options { levels: default_levels(&exemplar, 3, f64::INFINITY), seed: 2, ..Options::default() };
        for (number, level) in made(&exemplar, &area, &options).levels.iter().enumerate() {
            let energies = &level.energies_per_sample;
            assert_eq!(energies.len(), options.iterations + 1);
            // What is best is kept, and most often it is the last.
            let least = energies.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(level.full_energy_per_sample <= least * 1.001, "{name}, level {number}: {level:?}");
            falls += usize::from(energies[energies.len() - 1] < energies[0]);
            levels += 1;
        }
    }
    assert!(4 * falls >= 3 * levels, "the energy fell at {falls} of {levels} levels");
}

#[test]
fn one_component_is_had_from_every_exemplar() {
    let goal = Goal { components: Some(1.into()), ..Goal::default() };
    for name in EXEMPLARS {
        let exemplar = read(name);
        let options = options(&exemplar, 1);
        let made = made(&exemplar, &holed(), &options);
        let completing = CompleteOptions { frame_mm: Some(1.5), ..CompleteOptions::default() };
        let lace = complete(&made.graph, &elements(&made), &holed(), &options, &goal, &completing).unwrap();
        assert_eq!((lace.components, lace.region.components()), (1, 1), "{name}");
        assert_eq!(lace.holes, lace.region.holes(), "{name}");
    }
}

#[test]
fn what_cannot_be_learnt_from_is_refused() {
    let area = Area::new(region(&[&[(0.0, 0.0), (50.0, 0.0), (50.0, 50.0), (0.0, 50.0)]]));
    let branches = read("branches");
    let run = |drawing: &Drawing, options: &Options, area: &Area| {
        synthesize(drawing, area, options, &Given::default(), &mut |_, _| {}).unwrap_err()
    };
    let good = options(&branches, 0);
    assert_eq!(run(&Drawing::default(), &good, &area), SampleError::Empty);
    let wide = Options {
        levels: vec![openwork::samples::Level { radius_mm: 40.0, spacing_mm: 0.5 }],
        ..good.clone()
    };
    match run(&branches, &wide, &area) {
        SampleError::Crowded { largest, .. } => assert!(largest > openwork::samples::MOST_NEIGHBOURS),
        error => panic!("{error}"),
    }
    let stroke = Drawing {
        curves: vec![Curve { path: kurbo::BezPath::from_svg("M0 0L4 1").unwrap(), width_mm: 1.0 }],
        elements: Vec::new(),
    };
    assert!(matches!(run(&stroke, &good, &area), SampleError::Sparse { .. }));
    let small = Area::new(region(&[&[(0.0, 0.0), (5.0, 0.0), (5.0, 50.0), (0.0, 50.0)]]));
    assert!(matches!(run(&branches, &good, &small), SampleError::Small { .. }));
    assert!(matches!(
        run(&branches, &Options { levels: vec![], ..good.clone() }, &area),
        SampleError::Option { .. }
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    // A rolled area of any size: everything goes the short way over the seam, and the graph has no edge round it.
    #[test]
    fn rolled_areas_have_no_seam(lap in 50.0f64..120.0, height in 25.0f64..50.0, seed in 0u64..1000) {
        let exemplar = read("waves");
        let strip = [(-0.5 * lap, 0.0), (1.5 * lap, 0.0), (1.5 * lap, height), (-0.5 * lap, height)];
        let area = Area::rolled(region(&[&strip]), lap);
        let options = Options { seed, ..options(&exemplar, seed) };
        let made = made(&exemplar, &area, &options);
        let spacing_mm = options.levels[1].spacing_mm;
        for edge in &made.graph.edges {
            let [a, b] = edge.ends.map(|end| made.graph.samples[end].at);
            prop_assert!(area.way(a, b).length() < 3.0 * spacing_mm);
            prop_assert!((0.0..lap).contains(&a.x));
        }
        let over = made.graph.edges.iter().filter(|edge| {
            let [a, b] = edge.ends.map(|end| made.graph.samples[end].at);
            (a.x - b.x).abs() > 0.5 * lap
        });
        prop_assert!(over.count() > 0, "no line passes the seam");
    }
}
