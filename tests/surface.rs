//! Bands on models: free, standing out, carved; and models that cannot be used.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use common::Room;
use openwork::verify::{MeshReport, read_stl};
use proptest::prelude::*;

/// A model as text, an OBJ.
#[derive(Debug, Clone, Default)]
struct Model {
    vertices: Vec<[f64; 3]>,
    facets: Vec<[usize; 3]>,
}

impl Model {
    /// A surface of revolution through (radius, height), poles where the radius is 0, with bumps of so many millimetres.
    fn turned(profile: &[(f64, f64)], around: usize, bumps: f64) -> Self {
        let mut model = Self::default();
        let mut rows: Vec<Vec<usize>> = Vec::new();
        for &(radius, z) in profile {
            let first = model.vertices.len();
            let n = if radius == 0.0 { 1 } else { around };
            model.vertices.extend((0..n).map(|i| {
                let a = TAU * i as f64 / around as f64;
                let r = if radius == 0.0 { 0.0 } else { radius + bumps * (3.0 * a + 0.1 * z).sin() };
                [r * a.cos(), r * a.sin(), z]
            }));
            rows.push((0..around).map(|i| first + i % n).collect());
        }
        for pair in rows.windows(2) {
            for i in 0..around {
                let j = (i + 1) % around;
                let [a, b, c, d] = [pair[0][i], pair[0][j], pair[1][j], pair[1][i]];
                model.facets.extend(
                    [[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && a != c),
                );
            }
        }
        model
    }

    fn egg(bumps: f64) -> Self {
        let profile: Vec<(f64, f64)> = (0..=24)
            .map(|j| PI * f64::from(j) / 24.0)
            .map(|t| (if t.sin() < 1e-9 { 0.0 } else { 18.0 * t.sin() }, -24.0 * t.cos()))
            .collect();
        Self::turned(&profile, 48, bumps)
    }

    /// Open at both ends.
    fn tube() -> Self {
        let profile: Vec<(f64, f64)> = (0..=12).map(|j| (16.0, 3.0 * f64::from(j))).collect();
        Self::turned(&profile, 40, 0.0)
    }

    fn ring() -> Self {
        let mut model = Self::default();
        let (n, m) = (60, 24);
        for i in 0..n {
            let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
            model.vertices.extend((0..m).map(|j| {
                let (up, out) = (TAU * j as f64 / m as f64).sin_cos();
                let r = 30.0 + 9.0 * out;
                [r * cos, r * sin, 9.0 * up]
            }));
        }
        for i in 0..n {
            for j in 0..m {
                let at = |i: usize, j: usize| (i % n) * m + j % m;
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                model.facets.extend([[a, b, c], [a, c, d]]);
            }
        }
        model
    }

    fn and(mut self, other: Self, by: [f64; 3]) -> Self {
        let first = self.vertices.len();
        self.vertices.extend(other.vertices.iter().map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]));
        self.facets.extend(other.facets.iter().map(|f| f.map(|v| first + v)));
        self
    }

    fn obj(&self) -> String {
        let mut text = String::new();
        self.vertices.iter().for_each(|[x, y, z]| writeln!(text, "v {x:.6} {y:.6} {z:.6}").unwrap());
        self.facets.iter().for_each(|f| {
            let [a, b, c] = f.map(|v| v + 1);
            writeln!(text, "f {a} {b} {c}").unwrap();
        });
        text
    }
}

fn solid(room: &Room, name: &str) -> MeshReport {
    let found = read_stl(&room.read(name)).unwrap();
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    found
}

fn shells_and_genus(room: &Room, name: &str) -> (usize, i64) {
    let found = solid(room, name);
    (found.shells.len(), found.genus)
}

fn room() -> Room {
    let room = Room::with(&["vine.svg"]);
    room.write("egg.obj", &Model::egg(0.0).obj());
    room.write("tube.obj", &Model::tube().obj());
    room
}

const JOB: &str = "surface vine.svg --width 9mm --chord 0.05 --components 1";

#[test]
fn a_band_lies_on_its_model() {
    let room = room();
    room.succeeds(&format!(
        "{JOB} --mesh egg.obj --around 50% --thickness 1.5mm -o a.stl -o a.svg -o a.png --view iso --pixels 200 --report a.json"
    ));
    let (report, found) = (room.json("a.json"), solid(&room, "a.stl"));
    assert_eq!((report["components"].as_u64(), found.shells.len()), (Some(1), 1));
    assert_eq!(report["holes"].as_i64(), Some(found.genus));
    room.succeeds("verify --certificate a.json a.stl");
    // From the egg outwards, as thick as was asked for: facets of the egg are chords of it.
    let bytes = room.read("a.stl");
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    for facet in bytes[84..].chunks_exact(50) {
        for corner in facet[12..48].chunks_exact(12) {
            let [x, y, z] = [number(&corner[0..4]), number(&corner[4..8]), number(&corner[8..12])];
            let radius = x.hypot(y) / (1.0 - (z / 24.0).powi(2)).sqrt();
            assert!(radius > 17.7 && radius < 19.9, "({x}, {y}, {z}) is at {radius} of 18");
        }
    }
}

#[test]
fn what_stands_out_is_one_with_the_model() {
    let room = room();
    room.succeeds(&format!("{JOB} --mesh egg.obj --around 50% --mode emboss --thickness 1mm -o egg.stl"));
    assert_eq!(shells_and_genus(&room, "egg.stl"), (1, 0));
    room.succeeds(&format!("{JOB} --mesh tube.obj --around 18mm --mode emboss --shell 1.5mm -o tube.stl"));
    // A wall around a tube is a ring.
    assert_eq!(shells_and_genus(&room, "tube.stl"), (1, 1));
    room.succeeds(&format!(
        "{JOB} --mesh egg.obj --around 50% --mode emboss --shell 1.5mm -o hollow.3mf -o hollow.stl"
    ));
    assert_eq!(shells_and_genus(&room, "hollow.stl"), (2, 0));
}

#[test]
fn what_is_carved_leaves_the_pieces_that_its_holes_part() {
    let room = room();
    let job = format!("{JOB} --mesh egg.obj --around 50% --mode carve");
    room.succeeds(&format!("{job} --shell 1.5mm --holes 0 -o whole.stl"));
    assert_eq!(shells_and_genus(&room, "whole.stl"), (1, 0));
    room.succeeds(&format!("{job} --shell 1.5mm --closed-pattern --holes 1 -o halves.stl"));
    assert_eq!(shells_and_genus(&room, "halves.stl"), (2, 0));
    room.succeeds(&format!("{job} --depth 1mm --holes 3 -o groove.stl"));
    assert_eq!(shells_and_genus(&room, "groove.stl"), (1, 0));
    // A model that comes with a wall: cut through where the depth is more than that.
    room.succeeds(&format!(
        "{JOB} --mesh tube.obj --around 50% --mode emboss --shell 1.5mm --thickness 0.5 -o walled.stl"
    ));
    room.succeeds(&format!(
        "{JOB} --holes 0 --mesh walled.stl --around 4.6mm --mode carve --depth 3mm -o through.stl"
    ));
    assert_eq!(shells_and_genus(&room, "through.stl"), (1, 2));
}

#[test]
fn a_curve_through_points_is_followed() {
    let room = room();
    let through = "--through 18,0,0;0,17,6;-17,0,-4;0,-18,0";
    room.succeeds(&format!("{JOB} --mesh egg.obj {through} --tolerance 2mm -o open.stl"));
    assert_eq!(solid(&room, "open.stl").shells.len(), 1);
    room.succeeds(&format!(
        "{JOB} --mesh egg.obj {through};18,0,0 --tolerance 2mm --closed-pattern -o closed.stl --report r.json"
    ));
    assert_eq!(room.json("r.json")["closed_pattern"], true);
    let rows = (0..=40).map(|i| TAU * f64::from(i % 40) / 40.0);
    let table: String =
        rows.map(|a| format!("{},{},{}\n", 18.0 * a.cos(), 18.0 * a.sin(), 3.0 * (2.0 * a).sin())).collect();
    room.write("wave.csv", &table);
    room.succeeds(&format!("{JOB} --mesh egg.obj --curve wave.csv --closed-pattern -o wave.stl"));
    let (low, high) = solid(&room, "wave.stl").bounds_mm.unwrap();
    assert!(low[2] < -6.5 && high[2] > 6.5 && high[2] < 9.0, "{low:?} {high:?}");
}

#[test]
fn bad_models_and_curves_are_told() {
    let room = room();
    let [egg, tube] = [Model::egg(0.0), Model::tube()];
    room.write("ring.obj", &Model::ring().obj());
    room.write("two.obj", &egg.clone().and(Model::egg(0.0), [60.0, 0.0, 0.0]).obj());
    let mut crowded = egg.clone();
    crowded.vertices.push([0.0, 0.0, 60.0]);
    let [a, b, _] = crowded.facets[700];
    crowded.facets.push([a, b, crowded.vertices.len() - 1]);
    room.write("crowded.obj", &crowded.obj());
    room.write("none.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    room.write("cut.stl", "no model");
    room.write("far.csv", "0,0,0\n5,0,0\n9,3,0\n");
    for (options, told) in [
        ("--mesh egg.obj", "--through"),
        ("--mesh egg.obj --around 50% --curve far.csv", "cannot be used with"),
        ("--mesh egg.obj --around 120%", "50%"),
        ("--mesh egg.obj --around 99mm", "reaches from -24"),
        ("--mesh egg.obj --through 1,2", "is no point"),
        ("--mesh egg.obj --through 18,0,0", "at least 2"),
        ("--mesh egg.obj --through 18,0,0;0,40,0", "off the surface"),
        ("--mesh egg.obj --curve far.csv", "off the surface"),
        ("--mesh egg.obj --curve nowhere.obj", "nowhere.obj"),
        ("--mesh nowhere.stl --around 50%", "nowhere.stl"),
        ("--mesh cut.stl --around 50%", "cut.stl"),
        ("--mesh none.obj --around 50%", "no facet with an area"),
        ("--mesh crowded.obj --around 50%", "3 facets share the edge"),
        ("--mesh two.obj --through 18,0,0;78,0,0", "do not hang together"),
        ("--mesh tube.obj --around 50% --mode emboss", "--shell"),
        ("--mesh egg.obj --around 50% --mode carve", "how deep"),
        ("--mesh egg.obj --around 50% --shell 1mm", "--mode emboss or carve"),
        ("--mesh egg.obj --around 50% --depth 1mm", "--mode carve"),
        ("--mesh egg.obj --around 50% --mode carve --shell 1mm --depth 2mm", "through the wall"),
        ("--mesh egg.obj --around 50% --mode emboss --shell 0mm", "no thickness"),
        ("--mesh egg.obj --around 50% --thickness 0mm", "thickness"),
        ("--mesh tube.obj --around 97%", "ends or turns away"),
        ("--mesh egg.obj --around 99%", "folds"),
        ("--mesh egg.obj --around 50% --enforce --min-feature 1mm", "--enforce"),
        ("--mesh egg.obj --around 50% --chamfer 0.3mm", "parts that lie flat"),
    ] {
        room.refuses(&format!("{JOB} {options} -o a.stl"), 2, &[told]);
    }
    // Too wide for the model.
    room.refuses(
        "surface vine.svg --mesh egg.obj --around 50% --width 60mm -o a.stl",
        2,
        &["ends or turns away"],
    );
    // A model with a handle, or of two parts, is carved in one piece, or else refused.
    let carve = format!("{JOB} --mode carve --shell 1.5mm -o a.stl");
    room.refuses(&format!("{carve} --mesh two.obj --around 50%"), 3, &["2 parts"]);
    room.refuses(&format!("{carve} --mesh ring.obj --around 0mm --holes 2"), 3, &["handle"]);
    room.succeeds(&format!(
        "{JOB} --mode carve --shell 1.5mm -o ring.stl --mesh ring.obj --around 0mm --holes 0"
    ));
    assert_eq!(shells_and_genus(&room, "ring.stl"), (1, 2));
    // What can be mended is mended, and told.
    let mut mended = tube;
    mended.facets.push(mended.facets[5]);
    mended.facets.push([7, 7, 9]);
    mended.facets[30].reverse();
    room.write("mended.obj", &mended.obj());
    let said = room.succeeds(&format!("{JOB} --mesh mended.obj --around 50% -o a.stl"));
    let said = format!("{}{}", said.stderr, String::from_utf8_lossy(&said.stdout));
    assert!(said.contains("repeated facet") && said.contains("wrong way"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    /// Whatever the model, the file is closed and has the counts that follow from those of the pattern.
    #[test]
    fn files_have_their_counts_on_any_model(
        bumps in -1.2..1.2f64, height in 35.0..65.0f64, mode in 0usize..4, closed in any::<bool>(),
    ) {
        let room = Room::with(&["vine.svg"]);
        room.write("egg.obj", &Model::egg(bumps).obj());
        let mode = ["band", "emboss --shell 1.2mm", "carve --shell 1.2mm", "carve --depth 0.8mm"][mode];
        let closed = if closed { "--closed-pattern" } else { "" };
        // Exit 0 says that it was read again and is as planned.
        room.succeeds(&format!(
            "surface vine.svg --width 7mm --chord 0.05 --components 1 {closed} --mesh egg.obj --around {height}% --mode {mode} -o a.stl"
        ));
        solid(&room, "a.stl");
    }
}
