//! Rectangles that are rolled or laid over a height field: counts are those of what stands there.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::f64::consts::TAU;

use common::Room;
use glam::DVec2;
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::{FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};
use openwork::verify::{MeshReport, read_stl, read_svg, rolled};
use proptest::prelude::*;

fn solid(room: &Room, name: &str) -> MeshReport {
    let found = read_stl(&room.read(name)).unwrap();
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    found
}

#[test]
fn a_shade_is_one_piece_with_its_holes() {
    let room = Room::with(&["vine.svg"]);
    room.succeeds(
        "rect vine.svg --roll diameter=40mm --height 30mm --components 1 --chord 0.03 -o a.stl -o a.svg -o a.png --view iso --pixels 200 --report a.json",
    );
    let (report, found) = (room.json("a.json"), solid(&room, "a.stl"));
    assert_eq!((report["components"].as_u64(), found.shells.len()), (Some(1), 1));
    assert_eq!(report["holes"].as_i64(), Some(found.genus));
    let (low, high) = found.bounds_mm.unwrap();
    // As round as its outside, as high as was asked for, and standing.
    assert!((high[0] - 22.0).abs() < 0.02 && (low[1] + 22.0).abs() < 0.02, "{low:?} {high:?}");
    assert!(low[2].abs() < 1e-3 && (high[2] - 30.0).abs() < 1e-3, "{low:?} {high:?}");
    // The drawing is the sheet cut open; its two sides have the same ink, and counts follow from them.
    let flat = read_svg(&room.read("a.svg"), 0.004).unwrap();
    assert_eq!(report["flat"]["components"].as_u64(), Some(flat.components as u64));
    assert_eq!(report["flat"]["is_joined"], true);
    let (low, high) = flat.bounds_mm.unwrap();
    assert!((high.x - low.x - TAU * 21.0).abs() < 0.01);
    room.succeeds("verify --certificate a.json a.stl");
}

#[test]
fn counts_of_a_shade_can_be_asked_for() {
    let room = Room::with(&["lace.svg"]);
    let job = "rect lace.svg --roll diameter=50mm,top=40mm --height 30mm --thickness 1.2 --chord 0.05";
    room.succeeds(&format!("{job} --components 1 --min-feature 0.4 -o cone.stl --report cone.json"));
    let report = room.json("cone.json");
    assert_eq!(report["components"], 1);
    // Lengths are shorter at the top of a cone.
    assert!(report["flat"]["scales"][0].as_f64().unwrap() < 0.95);
    let (_, high) = solid(&room, "cone.stl").bounds_mm.unwrap();
    assert!((high[0] - 26.2).abs() < 0.1, "{high:?}");
}

#[test]
fn a_sheet_lies_over_a_hill() {
    let room = Room::with(&["vine.svg"]);
    let row =
        |j: i32| (0..9).map(move |i| format!("{} ", 6.0 * f64::from(i * (8 - i) * j * (6 - j)) / 144.0));
    let table: String = (0..7).map(|j| row(j).collect::<String>() + "\n").collect();
    room.write("hill.txt", &table);
    room.succeeds(
        "rect vine.svg --size 60x40mm --drape hill.txt --thickness 1.5 --components 1 --chord 0.05 -o a.stl --report a.json",
    );
    let (report, found) = (room.json("a.json"), solid(&room, "a.stl"));
    assert_eq!((report["components"].as_u64(), found.shells.len()), (Some(1), 1));
    assert_eq!(report["holes"].as_i64(), Some(found.genus));
    let (low, high) = found.bounds_mm.unwrap();
    // The B-spline rounds the top of 6 mm a little.
    assert!(high[2] - low[2] > 5.5 && high[2] - low[2] < 7.5, "{low:?} {high:?}");
}

#[test]
fn what_cannot_be_rolled_or_laid_is_told() {
    let room = Room::with(&["vine.svg"]);
    room.write("steep.csv", "0 0 0 0 0\n0 0 90 0 0\n0 0 90 0 0\n0 0 90 0 0\n0 0 0 0 0\n");
    room.write("odd.csv", "0 0 0 0\n0 0 0\n");
    room.write("small.csv", "0 0\n0 0\n");
    for (options, code, told) in [
        ("--roll diameter=40mm", 2, "--height"),
        ("--roll diameter=40mm --height 30mm --size 60x40mm", 2, "cannot be used with"),
        ("--roll 40mm --height 30mm", 2, "diameter=120mm,top=80mm"),
        ("--roll diameter=40mm --height 30mm --tile", 2, "cannot be used with"),
        ("--roll diameter=40mm --height 30mm --enforce --min-feature 1", 2, "would not meet after it"),
        ("--roll diameter=40mm --height 30mm --bridge 1mm", 2, "would not meet after it"),
        ("--roll diameter=40mm --height 30mm --chamfer 0.3mm", 2, "parts that lie flat"),
        ("--roll diameter=40mm --height 30mm --thickness 0mm", 2, "thickness"),
        ("--roll diameter=4mm --height 30mm --thickness 40mm", 2, "radius"),
        ("--roll diameter=0mm --height 30mm", 2, "more than 0"),
        ("--roll diameter=40mm,top=1mm --height 3mm --thickness 3mm", 2, "inside of a bend"),
        ("--height 30mm --size 60x40mm", 2, "cannot be used with"),
        ("--height 30mm", 2, "--roll"),
        ("--size 60x40mm --drape steep.csv", 2, "60 degrees are the most"),
        ("--size 60x40mm --drape odd.csv", 2, "line 2 has 3 heights"),
        ("--size 60x40mm --drape small.csv", 2, "4 x 4"),
        ("--size 60x40mm --drape none.csv", 2, "none.csv"),
        ("--size 60x40mm --drape steep.csv --tile", 2, "--tile"),
        ("--size 60x40mm --drape vine.svg", 2, "is no height"),
    ] {
        room.refuses(&format!("rect vine.svg {options} --components 1 -o a.stl"), code, &[told]);
    }
}

const EXTENT_MM: f64 = 200.0;

/// Ink that goes on over the lower and the upper side, `height` steps apart.
fn periodic(stars: &[Vec<DVec2>], height: i64) -> Option<Region> {
    let grid = Grid::for_extent(EXTENT_MM).unwrap();
    let path = |star: &Vec<DVec2>| star.iter().map(|&p| grid.snap(p).unwrap()).collect::<Vec<_>>();
    let own = Region::fill(grid, &stars.iter().map(path).collect::<Vec<_>>(), FillRule::NonZero);
    let copies = [-2, -1, 0, 1, 2].map(|i| own.shifted(GridPoint::new(0, i * height)));
    let [_, above] = Region::union(grid, &copies).turned_right().split_at(0)?;
    let [middle, _] = above.split_at(height)?;
    Some(middle.turned_left())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// The descriptors of pieces of a cylinder, joined, against counts of the whole with its sides glued.
    #[test]
    fn rows_of_a_roll_are_counted_as_they_stand(
        stars in prop::collection::vec(
            ((0.0..60.0f64, -10.0..30.0f64), prop::collection::vec(1.5..9.0f64, 3..8), 0.0..TAU), 1..9,
        ),
        lines in 1usize..9,
    ) {
        let corners = |((x, y), radii, turn): &((f64, f64), Vec<f64>, f64)| {
            let sector = TAU / radii.len() as f64;
            let corner = |(k, &r): (usize, &f64)| DVec2::new(*x, *y) + r * DVec2::from_angle(turn + sector * k as f64);
            radii.iter().enumerate().map(corner).collect::<Vec<_>>()
        };
        let stars: Vec<Vec<DVec2>> = stars.iter().map(corners).collect();
        let grid = Grid::for_extent(EXTENT_MM).unwrap();
        let Some(region) = periodic(&stars, grid.steps(20.0)) else { return Ok(()) };
        prop_assume!(!region.is_empty());
        let (low, high) = region.bounds_mm().unwrap();
        let rule = SlicingRule::Uniform { lines };
        let Ok(slicing) = Slicing::new(&region, &ReebGraph::new(&region), rule, &Tolerances::default())
        else { return Ok(()) };
        let is_clear = |cut: &openwork::reeb::Cut| {
            cut.crossings.iter().all(|c| c.y_mm - low.y > 1e-6 && high.y - c.y_mm > 1e-6)
        };
        let cuts: Vec<_> = slicing.cuts.into_iter().filter(is_clear).collect();
        let catalogue = Catalogue::rolled(&region, &cuts, &CostWeights::default());
        let descriptors = &catalogue.descriptors()[..catalogue.originals()];
        let mut run = descriptors[0].clone();
        for next in &descriptors[1..] {
            run = run.join(next).unwrap();
        }
        let counted = run.finished().unwrap();
        let upright = region.turned_right();
        let (low, high) = upright.bounds_mm().unwrap();
        let glued = rolled(&upright, [low.x, high.x]).unwrap();
        prop_assert_eq!((counted.components as usize, counted.holes as usize), (glued.components, glued.holes));
    }
}
