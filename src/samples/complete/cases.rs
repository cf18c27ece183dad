//! Small drawings of what went wrong once, completed.

use std::f64::consts::TAU;

use glam::DVec2;

use super::tests::{Dice, PEN_MM, area, check, goal, sample};
use super::*;
use crate::planar::{FillRule, Grid, GridPoint};
use crate::samples::Edge;

/// A graph of strokes through places.
fn strokes(lines: &[&[(f64, f64)]]) -> Graph {
    let mut graph = Graph::default();
    for line in lines {
        let first = graph.samples.len();
        graph.samples.extend(line.iter().map(|&(x, y)| sample(DVec2::new(x, y))));
        let edge = |i| Edge { ends: [i, i + 1], confidence: 1.0, handles: [DVec2::ZERO; 2] };
        graph.edges.extend((first..graph.samples.len() - 1).map(edge));
    }
    graph
}

fn area_of_paths(paths: &[&[(f64, f64)]]) -> Area {
    let grid = Grid::for_extent(400.0).unwrap();
    let path =
        |path: &&[(f64, f64)]| path.iter().map(|&(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).collect();
    let paths: Vec<Vec<GridPoint>> = paths.iter().map(path).collect();
    Area::new(Region::fill(grid, &paths, FillRule::EvenOdd))
}

/// Nothing is tidied before it is counted.
fn untidied(frame_mm: Option<f64>) -> CompleteOptions {
    CompleteOptions { joins_ends: false, removes_twigs: false, frame_mm, ..CompleteOptions::default() }
}

fn covers(completed: &Completed, x: f64, y: f64) -> bool {
    let p = completed.region.grid().snap(DVec2::new(x, y)).unwrap();
    completed.region.parts().iter().any(|part| part.covers(p))
}

#[test]
fn a_fork_that_stands_on_the_frame_is_opened() {
    let mut graph = strokes(&[&[(20.0, 0.0), (30.0, 12.0), (40.0, 0.0)]]);
    graph.samples.push(sample(DVec2::new(30.0, 22.0)));
    graph.edges.push(Edge { ends: [1, 3], confidence: 1.0, handles: [DVec2::ZERO; 2] });
    let goal = goal(Some(1), Some(1));
    let completed =
        complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &goal, &untidied(Some(2.0)));
    let completed = completed.unwrap();
    check(&completed, &goal);
    assert_eq!(completed.changes.iter().map(|change| change.kind).collect::<Vec<_>>(), [ChangeKind::Open]);
}

#[test]
fn a_stroke_is_cut_between_the_faces_that_it_parts() {
    // Four squares in a row, by two strokes between two rails that have no samples where they cross: each wall is one strand.
    let rails: [&[(f64, f64)]; 6] = [
        &[(4.0, 10.0), (56.0, 10.0)],
        &[(4.0, 20.0), (56.0, 20.0)],
        &[(4.0, 30.0), (56.0, 30.0)],
        &[(10.0, 4.0), (10.0, 15.0), (10.0, 25.0), (10.0, 36.0)],
        &[(30.0, 4.0), (30.0, 15.0), (30.0, 25.0), (30.0, 36.0)],
        &[(50.0, 4.0), (50.0, 15.0), (50.0, 25.0), (50.0, 36.0)],
    ];
    let graph = strokes(&rails);
    let goal = goal(Some(1), Some(1));
    let completed = complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &goal, &untidied(None));
    check(&completed.unwrap(), &goal);
}

#[test]
fn a_way_through_a_neck_is_found_round_its_corners() {
    let neck: &[(f64, f64)] = &[
        (0.0, 0.0),
        (30.0, 0.0),
        (30.0, 30.0),
        (50.0, 30.0),
        (50.0, 0.0),
        (80.0, 0.0),
        (80.0, 40.0),
        (50.0, 40.0),
        (50.0, 31.0),
        (30.0, 31.0),
        (30.0, 40.0),
        (0.0, 40.0),
    ];
    let area = area_of_paths(&[neck]);
    let graph = strokes(&[&[(10.0, 5.0), (20.0, 5.0)], &[(60.0, 5.0), (70.0, 5.0)]]);
    let goal = goal(Some(1), Some(0));
    let completed = complete(&graph, &[], &area, &Options::default(), &goal, &untidied(None)).unwrap();
    check(&completed, &goal);
    assert_eq!(completed.changes.iter().map(|change| change.kind).collect::<Vec<_>>(), [ChangeKind::Link]);
    assert!(completed.region.without(area.grown(0.5 * PEN_MM).region()).area_mm2() < 0.01);
}

#[test]
fn what_the_area_makes_impossible_is_named() {
    let square = |x: f64| [(x, 0.0), (x + 30.0, 0.0), (x + 30.0, 30.0), (x, 30.0)];
    let islands = area_of_paths(&[&square(0.0), &square(40.0)]);
    let graph = strokes(&[&[(5.0, 15.0), (25.0, 15.0)], &[(45.0, 15.0), (65.0, 15.0)]]);
    let refusal = |area: &Area, wanted: Goal, frame_mm: Option<f64>| {
        complete(&graph, &[], area, &Options::default(), &wanted, &untidied(frame_mm))
            .unwrap_err()
            .to_string()
    };
    let told = refusal(&islands, goal(Some(1), None), None);
    assert!(
        told.contains("the area lies in 2 pieces") && told.contains("ask for 2 components or more"),
        "{told}"
    );
    let holed = area_of_paths(&[
        &[(0.0, 0.0), (70.0, 0.0), (70.0, 30.0), (0.0, 30.0)],
        &[(32.0, 12.0), (38.0, 12.0), (38.0, 18.0), (32.0, 18.0)],
    ]);
    let told = refusal(&holed, goal(None, Some(0)), Some(1.5));
    assert!(
        told.contains("each of its 2 loops is a hole") && told.contains("ask for 2 holes or more"),
        "{told}"
    );
}

#[test]
fn what_runs_along_the_frame_goes() {
    // A wave whose trough is within the frame, and a stroke that is hidden there.
    let graph = strokes(&[
        &[(5.0, 20.0), (15.0, 6.0), (20.0, 1.5), (30.0, 1.2), (40.0, 1.5), (45.0, 6.0), (55.0, 20.0)],
        &[(15.0, 39.0), (25.0, 38.8), (35.0, 39.0)],
    ]);
    let completed =
        complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &Goal::default(), &untidied(Some(1.5)));
    let completed = completed.unwrap();
    let trimmed = completed.changes.iter().filter(|change| change.kind == ChangeKind::Trim).count();
    assert_eq!(trimmed, 2, "{:?}", completed.changes);
    assert!(!covers(&completed, 30.0, 1.5) && !covers(&completed, 25.0, 38.6));
    // What is left of the wave goes on to the frame.
    assert_eq!(completed.components, 1);
}

#[test]
fn what_is_nearest_of_some_is_the_first_of_all_that_is_one_of_them() {
    let mut dice = Dice(11);
    let mut place = || (60.0 * dice.roll(), 40.0 * dice.roll());
    let paths: Vec<Vec<(f64, f64)>> = (0..30).map(|_| vec![place(), place(), place()]).collect();
    let graph = strokes(&paths.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let (area, completing) = (area(60.0, 40.0), CompleteOptions::default());
    let lines = super::lines::Lines::new(&Work::new(&graph, &[], &area, &Options::default(), &completing));
    for first in 0..55 {
        let owners = [first, first + 3].map(super::lines::Owner::Edge);
        let p = DVec2::from(place());
        let slow = lines.nearest_first(p).find(|(_, line)| owners.contains(&line.owner)).unwrap().1;
        let fast = lines.nearest_of(&owners, p).unwrap();
        assert_eq!((slow.owner, slow.from, slow.to), (fast.owner, fast.from, fast.to), "seed 11, {p}");
    }
}

#[test]
fn what_runs_along_the_frame_does_not_come_back() {
    // A stroke that comes near to the frame and leaves it, in three edges, of which the middle one is beside it.
    let graph = strokes(&[&[(2.0, 20.0), (14.0, 1.6), (46.0, 1.6), (58.0, 20.0)]]);
    let options = CompleteOptions { frame_mm: Some(1.5), ..CompleteOptions::default() };
    let completed =
        complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &Goal::default(), &options).unwrap();
    assert!(
        completed.changes.iter().any(|change| change.kind == ChangeKind::Trim),
        "{:?}",
        completed.changes
    );
    assert!(!covers(&completed, 30.0, 1.6), "{:?}", completed.changes);
    assert_eq!(completed.components, 1, "what is left goes on to the frame");
}

#[test]
fn a_strip_that_is_all_beside_its_frame_keeps_its_pattern() {
    let graph = strokes(&[&[(0.0, 1.0), (20.0, 2.0), (40.0, 1.0), (60.0, 2.0)]]);
    let trimmed = |height: f64| {
        let area = area(60.0, height);
        let options = untidied(Some(0.5));
        let completed =
            complete(&graph, &[], &area, &Options::default(), &Goal::default(), &options).unwrap();
        completed.changes.iter().filter(|change| change.kind == ChangeKind::Trim).count()
    };
    assert_eq!(trimmed(3.0), 0);
}

#[test]
fn what_goes_on_from_a_given_stroke_is_no_free_end_and_has_the_pattern_s_pen() {
    let mut graph = strokes(&[&[(5.0, 20.0), (15.0, 20.0), (25.0, 20.0)], &[(40.0, 5.0), (40.0, 35.0)]]);
    (graph.samples[0].is_given, graph.samples[0].width_mm) = (true, 6.0);
    let (area, completing) = (area(60.0, 40.0), CompleteOptions::default());
    let work = Work::new(&graph, &[], &area, &Options::default(), &completing);
    assert!(work.present().all(|edge| work.width_mm(edge) == 1.0));
    let scene = super::scene::Scene::new(work).unwrap();
    let ends: Vec<usize> = scene.free_ends().into_iter().map(|(sample, _)| sample).collect();
    assert_eq!(ends, [2, 3, 4]);
}

#[test]
fn a_slit_that_bends_is_filled_along_its_middle() {
    let mut graph = strokes(&[&[(0.0, 22.0), (1.9, 20.0), (1.9, 1.9), (20.0, 1.9), (22.0, 0.0)]]);
    graph.edges.iter_mut().for_each(|edge| edge.confidence = f64::INFINITY);
    let completed =
        complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &Goal::default(), &untidied(Some(2.0)));
    let completed = completed.unwrap();
    assert_eq!(completed.holes, 1, "{:?}", completed.changes);
    assert!(completed.changes.iter().all(|change| change.kind == ChangeKind::Fill));
    assert!(covers(&completed, 1.2, 1.2) && covers(&completed, 1.2, 15.0) && covers(&completed, 15.0, 1.2));
    assert!(!covers(&completed, 11.0, 11.0), "the straight way between its ends stays open");
}

#[test]
fn a_hole_that_nothing_opens_is_filled_if_it_is_small() {
    let mut graph = strokes(&[&[(20.0, 20.0), (22.6, 20.0), (21.3, 22.2)]]);
    graph.edges.push(Edge { ends: [0, 2], confidence: 1.0, handles: [DVec2::ZERO; 2] });
    graph.edges.iter_mut().for_each(|edge| edge.confidence = f64::INFINITY);
    let goal = goal(Some(1), Some(0));
    let completed =
        complete(&graph, &[], &area(60.0, 40.0), &Options::default(), &goal, &untidied(None)).unwrap();
    check(&completed, &goal);
    assert_eq!(completed.changes.iter().map(|change| change.kind).collect::<Vec<_>>(), [ChangeKind::Fill]);
}

#[test]
fn an_edge_is_split_where_it_is_told_to_however_often_it_was_before() {
    let graph = strokes(&[&[(0.0, 5.0), (32.0, 5.0)]]);
    let (area, completing) = (area(60.0, 40.0), CompleteOptions::default());
    let mut work = Work::new(&graph, &[], &area, &Options::default(), &completing);
    for (t, x) in [(0.5, 16.0), (0.75, 24.0), (0.25, 8.0), (0.875, 28.0)] {
        let at = work.sample_at(work::Foot::Edge(0, t));
        assert!(work.samples[at].at.distance(DVec2::new(x, 5.0)) < 1e-9, "{t}: {}", work.samples[at].at);
    }
}

#[test]
fn lines_that_are_as_near_come_in_the_order_of_their_owners() {
    let mut graph = strokes(&[&[(30.0, 20.0)]]);
    for i in 0..24 {
        graph
            .samples
            .push(sample(DVec2::new(30.0, 20.0) + 12.0 * DVec2::from_angle(TAU * f64::from(i * 7) / 24.0)));
        graph.edges.push(Edge { ends: [0, i as usize + 1], confidence: 1.0, handles: [DVec2::ZERO; 2] });
    }
    let (area, completing) = (area(60.0, 40.0), CompleteOptions::default());
    let work = Work::new(&graph, &[], &area, &Options::default(), &completing);
    let lines = lines::Lines::new(&work);
    let owners: Vec<_> =
        lines.nearest_first(DVec2::new(30.0, 20.0)).take(24).map(|(_, line)| line.owner).collect();
    assert_eq!(owners, (0..24).map(lines::Owner::Edge).collect::<Vec<_>>());
}
