//! Random planar graphs are completed to random counts, and counted again.

use std::f64::consts::TAU;

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::planar::{FillRule, Grid, GridPoint};
use crate::samples::{Edge, Kind, Sample, inked};
use crate::topology::Wanted;

const CELL_MM: f64 = 6.0;
pub(super) const PEN_MM: f64 = 1.0;

/// Numbers that are as good as random.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    /// From 0 to 1.
    pub(super) fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }
}

pub(super) fn sample(at: DVec2) -> Sample {
    Sample {
        at,
        kind: Kind::Curve,
        orientations: Vec::new(),
        width_mm: PEN_MM,
        existence: 1.0,
        is_given: false,
        element: 0,
    }
}

/// A grid of jittered samples of which so large a part of the edges is kept; some of the others were voted for. Twigs hang on some.
fn net(columns: usize, rows: usize, kept: f64, dice: &mut Dice) -> Graph {
    let mut graph = Graph::default();
    for i in 0..columns * rows {
        let (x, y) = ((i % columns) as f64 + 1.0, (i / columns) as f64 + 1.0);
        let off = DVec2::new(dice.roll() - 0.5, dice.roll() - 0.5) * 0.5;
        graph.samples.push(sample((DVec2::new(x, y) + off) * CELL_MM));
    }
    let across = (0..columns * rows).filter(|i| (i + 1) % columns > 0).map(|i| [i, i + 1]);
    let up = (0..columns * (rows - 1)).map(|i| [i, i + columns]);
    for ends in across.chain(up) {
        let edge = Edge { ends, confidence: dice.roll(), handles: [DVec2::ZERO; 2] };
        match dice.roll() {
            roll if roll < kept => graph.edges.push(edge),
            roll if roll < 0.5 + 0.5 * kept => graph.unrealised.push(edge),
            _ => {}
        }
    }
    for foot in (0..columns * rows).step_by(7) {
        let tip = graph.samples.len();
        graph.samples.push(sample(
            graph.samples[foot].at + DVec2::from_angle(TAU * dice.roll()) * (0.5 + 2.0 * dice.roll()),
        ));
        graph.edges.push(Edge { ends: [foot, tip], confidence: dice.roll(), handles: [DVec2::ZERO; 2] });
    }
    graph.unrealised.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    graph
}

pub(super) fn area(width_mm: f64, height_mm: f64) -> Area {
    let grid = Grid::for_extent(400.0).unwrap();
    let corners = [(0.0, 0.0), (width_mm, 0.0), (width_mm, height_mm), (0.0, height_mm)];
    let path: Vec<GridPoint> = corners.iter().map(|&(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).collect();
    Area::new(Region::fill(grid, &[path], FillRule::NonZero))
}

fn area_of(columns: usize, rows: usize) -> Area {
    area((columns + 1) as f64 * CELL_MM, (rows + 1) as f64 * CELL_MM)
}

/// Squares with a hole each.
fn elements(count: usize, columns: usize, rows: usize, dice: &mut Dice) -> Vec<Element> {
    let square = |at: DVec2, side: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| at + 0.5 * side * DVec2::new(x, y))
            .to_vec()
    };
    let mut element = || {
        let at =
            DVec2::new(1.0 + dice.roll() * (columns as f64 - 1.0), 1.0 + dice.roll() * (rows as f64 - 1.0))
                * CELL_MM;
        let inner = square(at, 1.2).into_iter().rev().collect();
        Element { contours: vec![square(at, 3.0), inner] }
    };
    (0..count).map(|_| element()).collect()
}

pub(super) fn goal(components: Option<u32>, holes: Option<u32>) -> Goal {
    Goal {
        components: components.map(Wanted::exactly),
        holes: holes.map(Wanted::exactly),
        closed_pattern: false,
    }
}

/// Counts the drawing once more.
pub(super) fn check(completed: &Completed, goal: &Goal) {
    let region = inked(&completed.drawing, completed.region.grid(), 0.01).unwrap();
    assert_eq!(region, completed.region);
    assert_eq!((region.components(), region.holes()), (completed.components, completed.holes));
    let count = |n: usize| u32::try_from(n).unwrap();
    assert!(goal.components.is_none_or(|wanted| wanted.contains(count(region.components()))));
    assert!(goal.holes.is_none_or(|wanted| wanted.contains(count(region.holes()))));
}

#[test]
fn two_strokes_are_joined_by_the_edge_that_was_voted_for() {
    let mut graph = Graph::default();
    for x in [10.0, 20.0, 40.0, 50.0] {
        graph.samples.push(sample(DVec2::new(x, 20.0)));
    }
    let edge = |a, b, confidence| Edge { ends: [a, b], confidence, handles: [DVec2::ZERO; 2] };
    graph.edges = vec![edge(0, 1, 1.0), edge(2, 3, 1.0)];
    graph.unrealised = vec![edge(0, 2, 0.2), edge(1, 2, 0.15)];
    let area = area(60.0, 40.0);
    let options = Options::default();
    let goal = goal(Some(1), Some(0));
    let completed = complete(&graph, &[], &area, &options, &goal, &CompleteOptions::default()).unwrap();
    check(&completed, &goal);
    // The better vote would lie on a stroke.
    let [change] = &completed.changes[..] else { panic!("{:?}", completed.changes) };
    assert_eq!((change.kind, change.confidence), (ChangeKind::Join, Some(0.15)));
    assert_eq!(completed.drawing.curves.len(), 1, "it is one path");
}

#[test]
fn ends_that_almost_meet_are_joined_and_twigs_go_without_a_goal() {
    let mut graph = Graph::default();
    // A line of three edges with a gap after the second, and a twig in its middle.
    for (x, y) in [(5.0, 20.0), (15.0, 20.0), (25.0, 20.0), (29.0, 20.5), (39.0, 20.5), (15.0, 20.9)] {
        graph.samples.push(sample(DVec2::new(x, y)));
    }
    let edge = |a, b| Edge { ends: [a, b], confidence: 1.0, handles: [DVec2::ZERO; 2] };
    graph.edges = vec![edge(0, 1), edge(1, 2), edge(3, 4), edge(1, 5)];
    let area = area(60.0, 40.0);
    let kinds = |completing: &CompleteOptions| {
        let completed =
            complete(&graph, &[], &area, &Options::default(), &Goal::default(), completing).unwrap();
        check(&completed, &Goal::default());
        completed.changes.iter().map(|change| change.kind).collect::<Vec<_>>()
    };
    assert_eq!(kinds(&CompleteOptions::default()), [ChangeKind::Join, ChangeKind::Trim]);
    assert_eq!(
        kinds(&CompleteOptions { removes_twigs: false, ..CompleteOptions::default() }),
        [ChangeKind::Join]
    );
    assert_eq!(
        kinds(&CompleteOptions { joins_ends: false, ..CompleteOptions::default() }),
        [ChangeKind::Trim]
    );
    // Of five ends, four are as many as there should be.
    let few = CompleteOptions { ends_wanted: Some(4), ..CompleteOptions::default() };
    assert_eq!(kinds(&few), [ChangeKind::Join]);
    assert_eq!(kinds(&CompleteOptions { ends_wanted: Some(5), ..few }), []);
}

#[test]
fn a_ring_is_opened_before_it_is_parted() {
    let mut graph = Graph::default();
    for i in 0..12 {
        graph
            .samples
            .push(sample(DVec2::new(30.0, 20.0) + 12.0 * DVec2::from_angle(TAU * f64::from(i) / 12.0)));
        let (i, next) = (i as usize, (i as usize + 1) % 12);
        graph.edges.push(Edge {
            ends: [i.min(next), i.max(next)],
            confidence: 1.0,
            handles: [DVec2::ZERO; 2],
        });
    }
    let area = area(60.0, 40.0);
    for components in 1..=3 {
        let goal = goal(Some(components), Some(0));
        let found = complete(&graph, &[], &area, &Options::default(), &goal, &CompleteOptions::default());
        let completed = found.unwrap();
        check(&completed, &goal);
        assert_eq!(completed.changes.len(), components as usize);
    }
}

#[test]
fn given_strokes_stay() {
    let mut graph = net(4, 4, 1.0, &mut Dice(5));
    graph.edges.iter_mut().for_each(|edge| edge.confidence = f64::INFINITY);
    let completing = CompleteOptions { joins_ends: false, ..CompleteOptions::default() };
    let refused =
        complete(&graph, &[], &area_of(4, 4), &Options::default(), &goal(None, Some(0)), &completing);
    let Err(CompleteError::NotMet { nearest, .. }) = refused else { panic!("{refused:?}") };
    assert!(nearest.changes.iter().all(|change| change.kind == ChangeKind::Fill));
}

#[test]
fn what_cannot_be_is_refused_with_what_was_reached() {
    let area = area(60.0, 40.0);
    let (options, completing) = (Options::default(), CompleteOptions::default());
    let none = complete(&Graph::default(), &[], &area, &options, &Goal::default(), &completing);
    assert!(matches!(none, Err(CompleteError::Empty)));
    // Nothing opens the hole of an element.
    let ring = elements(1, 5, 4, &mut Dice(3));
    let refused = complete(&Graph::default(), &ring, &area, &options, &goal(Some(1), Some(0)), &completing);
    let Err(error @ CompleteError::NotMet { .. }) = refused else { panic!("{refused:?}") };
    let told = error.to_string();
    assert!(told.contains("1 component(s) and 1 hole(s) were reached"), "{told}");
    assert!(
        told.contains("wanted were 1 component(s) and 0 hole(s); what holes are left are within elements"),
        "{told}"
    );
}

#[test]
fn a_small_net_gets_every_pair_of_counts() {
    let (columns, rows) = (4, 3);
    let options = Options::default();
    let completing = CompleteOptions { leaves_out_small: false, ..CompleteOptions::default() };
    let mut met = 0;
    for components in 1..=3 {
        for holes in 0..=5 {
            let graph = net(columns, rows, 0.6, &mut Dice(11));
            let goal = goal(Some(components), Some(holes));
            match complete(&graph, &[], &area_of(columns, rows), &options, &goal, &completing) {
                Ok(completed) => {
                    check(&completed, &goal);
                    met += 1;
                }
                Err(error) => println!("{error}"),
            }
        }
    }
    assert!(met >= 16, "{met} of 18");
}

#[test]
fn a_rolled_net_is_one_component_that_winds_round() {
    let (columns, rows) = (12, 5);
    let lap_mm = columns as f64 * CELL_MM;
    let grid = Grid::for_extent(400.0).unwrap();
    let high = (rows + 1) as f64 * CELL_MM;
    let corners = [(-lap_mm, 0.0), (2.0 * lap_mm, 0.0), (2.0 * lap_mm, high), (-lap_mm, high)];
    let path: Vec<GridPoint> = corners.iter().map(|&(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).collect();
    let area = Area::rolled(Region::fill(grid, &[path], FillRule::NonZero), lap_mm);
    let mut graph = net(columns, rows, 0.6, &mut Dice(4));
    graph.samples.iter_mut().for_each(|sample| sample.at = area.home(sample.at));
    // Row by row the last sample is beside the first.
    for row in 0..rows {
        let ends = [row * columns, row * columns + columns - 1];
        graph.unrealised.push(Edge { ends, confidence: 0.0, handles: [DVec2::ZERO; 2] });
    }
    for frame_mm in [None, Some(2.0)] {
        let goal = Goal { closed_pattern: frame_mm.is_some(), ..goal(Some(1), Some(8)) };
        let completing = CompleteOptions { frame_mm, ..CompleteOptions::default() };
        let completed = complete(&graph, &[], &area, &Options::default(), &goal, &completing).unwrap();
        assert_eq!((completed.components, completed.holes), (1, 8));
        let plane = crate::samples::ink::CountingPlane::of(&area);
        let counted = plane.inked(&completed.drawing, grid, 0.01).unwrap();
        assert_eq!((counted.components(), counted.holes()), (1, 8));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn one_component_is_always_had(
        seed in 0u64..1_000_000,
        columns in 2usize..9,
        rows in 2usize..7,
        kept in 0.2f64..1.0,
        count in 0usize..5,
        has_frame in prop::bool::ANY,
    ) {
        let mut dice = Dice(seed);
        let graph = net(columns, rows, kept, &mut dice);
        let elements = elements(count, columns, rows, &mut dice);
        let goal = goal(Some(1), None);
        let completing = CompleteOptions { frame_mm: has_frame.then_some(2.0), ..CompleteOptions::default() };
        let completed = complete(&graph, &elements, &area_of(columns, rows), &Options::default(), &goal, &completing);
        prop_assert!(completed.is_ok(), "{}", completed.unwrap_err());
        check(&completed.unwrap(), &goal);
    }

    #[test]
    fn counts_are_exact_or_refused(
        seed in 0u64..1_000_000,
        columns in 3usize..8,
        rows in 3usize..6,
        kept in 0.3f64..1.0,
        count in 0usize..3,
        components in 1u32..6,
        holes in 0u32..12,
    ) {
        let mut dice = Dice(seed);
        let graph = net(columns, rows, kept, &mut dice);
        let elements = elements(count, columns, rows, &mut dice);
        let goal = goal(Some(components), Some(holes));
        let complete = || complete(&graph, &elements, &area_of(columns, rows), &Options::default(), &goal, &CompleteOptions::default());
        let completed = complete();
        prop_assert_eq!(&complete(), &completed);
        match completed {
            Ok(completed) => check(&completed, &goal),
            Err(CompleteError::NotMet { nearest, .. }) => println!("{seed}: {} {} instead of {components} {holes}", nearest.components, nearest.holes),
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}
