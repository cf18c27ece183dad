//! How long the synthesis of sample graphs takes, and how it grows with the area.
//!
//!     cargo bench --bench samples
//!
//! The first table has an area on which there are as many samples, with as many in a neighbourhood, as in Tu 2020 Appendix C (750, 1000 and 1300 with
//! 30, 30 and 20), level by level; the second one the same exemplar on larger and larger squares. The figures are medians of three runs.

use std::time::Instant;

use glam::DVec2;
use openwork::exemplar::{Linework, ReadOptions};
use openwork::planar::{FillRule, Grid, Region};
use openwork::samples::{
    Area, Curve, Drawing, Element, Given, Options, Synthesis, default_levels, synthesize,
};

const RUNS: usize = 3;

fn main() {
    let exemplar = read("rings");
    let (seconds, whole) = median(&exemplar, 84.0);
    println!("| level | samples | in a neighbourhood | time (s) | of it search (s) |");
    println!("|---|---|---|---|---|");
    for (number, level) in whole.levels.iter().enumerate() {
        println!(
            "| {} | {} | {:.0} | {:.2} | {:.2} |",
            number + 1,
            level.samples,
            level.neighbours,
            level.seconds,
            level.search_seconds
        );
    }
    println!("| all | | | {seconds:.2} | |\n");
    println!("| side (mm) | samples, finest level | time (s) | ms for a sample |");
    println!("|---|---|---|---|");
    for side_mm in [60.0, 85.0, 120.0, 170.0, 240.0, 340.0] {
        let (seconds, made) = median(&exemplar, side_mm);
        let samples = made.levels.last().map_or(0, |level| level.samples);
        println!("| {side_mm:.0} | {samples} | {seconds:.2} | {:.2} |", 1e3 * seconds / samples as f64);
    }
}

/// The median time of a square of `side_mm`, and what was made in it.
fn median(exemplar: &Drawing, side_mm: f64) -> (f64, Synthesis) {
    let area = square(side_mm);
    let options =
        Options { levels: default_levels(exemplar, 3, f64::INFINITY), seed: 1, ..Options::default() };
    let mut runs: Vec<(f64, Synthesis)> = (0..RUNS)
        .map(|_| {
            let began = Instant::now();
            let made = synthesize(exemplar, &area, &options, &Given::default(), &mut |_, _| {});
            (began.elapsed().as_secs_f64(), made.expect("the exemplar is good"))
        })
        .collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    runs.swap_remove(RUNS / 2)
}

fn square(side_mm: f64) -> Area {
    let grid = Grid::for_extent(side_mm + 100.0).expect("it is small");
    let corners = [(0.0, 0.0), (side_mm, 0.0), (side_mm, side_mm), (0.0, side_mm)];
    let path = corners.map(|(x, y)| grid.snap(DVec2::new(x, y)).expect("it is on the grid")).to_vec();
    Area::new(Region::fill(grid, &[path], FillRule::NonZero))
}

fn read(name: &str) -> Drawing {
    let file = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/samples/{}.svg"), name);
    let read = Linework::read(file.as_ref(), &ReadOptions::default()).expect("the exemplar can be read");
    Drawing {
        curves: read
            .strokes()
            .iter()
            .map(|line| Curve { path: line.path.clone(), width_mm: line.width_mm })
            .collect(),
        elements: read.elements().iter().map(|contours| Element { contours: contours.clone() }).collect(),
    }
}
