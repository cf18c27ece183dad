//! Bands along curves in space: the solid has the topology that was asked for, wherever the curve goes.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::f64::consts::TAU;

use common::Room;
use openwork::domain::{CurveSpec, SpaceError};
use openwork::job::{BandBuilder, JobError, Output, SpaceOptions};
use openwork::verify::{MeshReport, read_stl, read_svg};
use proptest::prelude::*;

fn solid(room: &Room, name: &str) -> MeshReport {
    let found = read_stl(&room.read(name)).unwrap();
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    found
}

/// A table of points round a circle of 40 mm that goes up and down.
fn crown(n: u32) -> String {
    let row = |i: u32| {
        let a = TAU * f64::from(i % n) / f64::from(n);
        format!("{}, {}, {}\n", 40.0 * a.cos(), 40.0 * a.sin(), 6.0 * (3.0 * a).sin())
    };
    (0..=n).map(row).collect()
}

#[test]
fn a_bracelet_stands_on_its_cylinder() {
    let room = Room::with(&["vine.svg"]);
    let job = "band vine.svg --along ring:65mm --width 14mm --components 1 --closed-pattern";
    room.succeeds(&format!("{job} -o a.stl -o a.svg -o a.png --view iso --pixels 200 --report a.json"));
    let (report, found) = (room.json("a.json"), solid(&room, "a.stl"));
    assert_eq!((report["components"].as_u64(), found.shells.len()), (Some(1), 1));
    assert_eq!(report["holes"].as_i64(), Some(found.genus));
    let (low, high) = found.bounds_mm.unwrap();
    assert!((high[0] - 34.5).abs() < 0.01 && (low[0] + 34.5).abs() < 0.01, "{low:?} {high:?}");
    assert!(low[2] > -1e-4 && high[2] < 14.0 + 1e-4);
    // Nothing reaches into the inside of 65 mm.
    let corners = read_corners(&room.read("a.stl"));
    assert!(corners.iter().all(|[x, y, _]| x.hypot(*y) > 32.5 - 0.01 && x.hypot(*y) < 34.5 + 1e-4));
    // The drawing is the pattern laid flat and cut open.
    let flat = read_svg(&room.read("a.svg"), 0.002).unwrap();
    assert_eq!(report["flat"]["components"].as_u64(), Some(flat.components as u64));
    assert_eq!(report["flat"]["is_joined"], true);
    let (low, high) = flat.bounds_mm.unwrap();
    assert!((high.x - low.x - TAU * 33.5).abs() < 0.01);
    // The certificate is of what is closed.
    room.succeeds("verify --certificate a.json a.stl");
}

/// The corners of a binary STL.
fn read_corners(bytes: &[u8]) -> Vec<[f64; 3]> {
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let facets = bytes[84..].chunks_exact(50);
    let corners = facets.flat_map(|facet| facet[12..48].chunks_exact(12).collect::<Vec<_>>());
    corners.map(|c| [number(&c[0..4]), number(&c[4..8]), number(&c[8..12])]).collect()
}

#[test]
fn a_cuff_has_its_gap_and_a_helix_its_turns() {
    let room = Room::with(&["vine.svg", "lace.svg"]);
    room.succeeds(
        "band vine.svg --along ring:65mm --gap 25mm --width 20mm --components 1 -o cuff.stl -o cuff.3mf",
    );
    assert_eq!(solid(&room, "cuff.stl").shells.len(), 1);
    let back =
        read_corners(&room.read("cuff.stl")).into_iter().filter(|[x, y, _]| *y > 0.0 && x.abs() < 12.4);
    assert_eq!(back.count(), 0, "the gap is free");
    room.succeeds(
        "band lace.svg --along helix:40mm,pitch=14mm,turns=2 --width 11mm --components 1 -o helix.stl",
    );
    let (low, high) = solid(&room, "helix.stl").bounds_mm.unwrap();
    assert!(high[2] - low[2] > 28.0 + 10.0 && high[2] - low[2] < 28.0 + 11.1, "{low:?} {high:?}");
}

#[test]
fn a_curve_through_points_closes_and_twists() {
    let room = Room::with(&["lace.svg"]);
    room.write("crown.csv", &crown(24));
    room.succeeds(
        "band lace.svg --along points:crown.csv --width 9mm --components 1 --closed-pattern --twist 360 -o a.stl --report a.json",
    );
    let (found, report) = (solid(&room, "a.stl"), room.json("a.json"));
    assert_eq!((found.shells.len(), Some(found.genus)), (1, report["holes"].as_i64()));
    room.succeeds(
        "band lace.svg --along points:crown.csv --width 9mm --components 1 --closed-pattern -o b.stl",
    );
    assert_ne!(room.read("a.stl"), room.read("b.stl"));
}

#[test]
fn widths_hold_over_the_cut_too() {
    let room = Room::with(&["vine.svg"]);
    let job = "band vine.svg --along ring:65mm --width 24mm --components 1 --closed-pattern";
    room.succeeds(&format!("{job} --min-feature 0.4mm --min-gap 0.2mm -o a.stl --report a.json"));
    let report = room.json("a.json");
    assert!(report["min_feature"]["width_mm"].as_f64().unwrap() > 0.4, "{}", report["min_feature"]);
    assert!(report["min_gap"]["width_mm"].as_f64().unwrap() > 0.2);
    room.refuses(
        &format!("{job} --min-feature 2.5mm -o b.stl"),
        4,
        &["narrower than 2.577", "a larger --width"],
    );
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let room = Room::with(&["lace.svg"]);
    room.write("cusp.csv", "0,0,0\n30,0,0\n1,0,0\n");
    room.write("back.csv", "0,0,0\n30,0,0\n0,0,0\n");
    room.write("words.csv", "0,0,0\n1,two,3\n");
    room.write("one.csv", "0,0,0\n");
    room.write("far.csv", "20000,0,0\n20100,0,0\n");
    let refuses = |rest: &str, words: &[&str]| {
        room.refuses(&format!("band lace.svg --width 9mm -o a.stl --along {rest}"), 2, words);
    };
    refuses("points:cusp.csv", &["a cusp at (29.", "spread the points"]);
    refuses("points:back.csv", &["2 point(s) make no curve; at least 3"]);
    refuses("ring:1mm --thickness 30mm", &["folds at", "mm radius", "--thickness"]);
    refuses("points:words.csv", &["words.csv: line 2: '1,two,3' is not a point"]);
    refuses("points:one.csv", &["1 point(s) make no curve"]);
    refuses("points:none.csv", &["none.csv"]);
    refuses("ring:65mm --gap 65mm", &["a gap of 65 mm does not fit a ring of 65 mm inside"]);
    refuses("ring:65mm --gap 0", &["a gap of 0 mm does not fit"]);
    refuses("ring:65mm --twist 90", &["a twist of 90 degrees does not close"]);
    refuses("ring:65mm --twist abc", &["'abc' is no twist"]);
    refuses("line:65mm --twist 90", &["--twist", "a band in the plane has no twist"]);
    refuses("circle:65mm --gap 5mm", &["--gap", "only a ring has a gap"]);
    refuses("ring:65mm --thickness 0", &["--thickness"]);
    refuses("helix:60mm,pitch=8mm,turns=2", &["meets itself at", "a greater pitch"]);
    refuses("helix:60mm,pitch=8mm", &["it lacks its turns"]);
    refuses("helix:65mm,pitch=12mm,turns=6000", &["m long", "fewer turns"]);
    refuses("helix:65mm,pitch=20mm,turns=1 --twist 0:0,500:180", &["a place at 500 mm"]);
    refuses("points:far.csv", &["point 1", "move the curve nearer"]);
    refuses("ring:65mm --round 3mm", &["--round", "no corners"]);
    refuses("ring:65mm --chamfer 0.3mm", &["--chamfer", "for parts that lie flat"]);
    refuses("ring:65mm --gap 0.2mm --min-gap 0.4mm", &["--gap", "less than the minimum gap"]);
    refuses(
        "helix:60mm,pitch=9.3mm,turns=2 --min-gap 0.5mm",
        &["comes within 0.5 mm, the minimum gap, of itself"],
    );
    refuses("ring:65mm --enforce --min-feature 0.4mm", &["--enforce", "--gap"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn solids_are_closed_along_any_curve(
        points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -0.7..0.7f64), 5..8),
        is_closed in any::<bool>(), twist in -180.0..180.0f64, width in 5.0..9.0f64,
        exemplar in prop::sample::select(vec!["lace", "vine", "wave"]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        // Spread round a circle, so that few of them fold.
        let n = points.len() as f64;
        let mut rows: Vec<String> = (0..).zip(&points).map(|(i, (x, y, z))| {
            let a = TAU * f64::from(i) / n;
            format!("{},{},{}", 60.0 * a.cos() + 9.0 * x, 60.0 * a.sin() + 9.0 * y, 25.0 * z)
        }).collect();
        if is_closed {
            rows.push(rows[0].clone());
        }
        let table = folder.path().join("points.csv");
        std::fs::write(&table, rows.join("\n")).unwrap();
        let along: CurveSpec = format!("points:{}", table.display()).parse().unwrap();
        let twist = (!is_closed).then(|| twist.to_string().parse().unwrap());
        let job = BandBuilder::new(format!("fixtures/exemplars/{exemplar}.svg"), along)
            .width_mm(width)
            .components(1)
            .space(SpaceOptions { twist, ..SpaceOptions::default() })
            .build()
            .unwrap();
        let band = match job.run(&mut |_| {}) {
            Ok(band) => band,
            Err(JobError::Refused(_) | JobError::Space(SpaceError::Fold { .. } | SpaceError::Contact { .. })) => {
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let file = folder.path().join("a.stl");
        let report = band.write(&[Output::file(&file).unwrap()], None, &mut |_| {});
        let report = report.map_err(|e| TestCaseError::fail(e.to_string()))?;
        let found = read_stl(&std::fs::read(&file).unwrap()).unwrap();
        prop_assert!(found.faults.is_empty());
        prop_assert_eq!((found.shells.len(), found.genus), (1, report.holes as i64));
    }
}

/// A closed curve with straight sides and tight corners, so that facets are needed in some places only.
fn frame() -> String {
    let corners = [(45.0, 20.0), (-45.0, 20.0), (-45.0, -20.0), (45.0, -20.0)];
    let mut rows = Vec::new();
    for (i, (x, y)) in corners.into_iter().enumerate() {
        for k in 0..=4 {
            let a = TAU * (i as f64 + f64::from(k) / 4.0) / 4.0;
            rows.push(format!("{},{},0", x + 12.0 * a.cos(), y + 12.0 * a.sin()));
        }
    }
    rows.push(rows[0].clone());
    rows.join("\n")
}

#[test]
fn facets_are_where_the_curve_bends() {
    let room = Room::with(&["lattice.svg"]);
    room.write("frame.csv", &frame());
    let points: Vec<glam::DVec3> = frame()
        .lines()
        .map(|row| row.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>())
        .map(|p| glam::DVec3::new(p[0], p[1], p[2]))
        .collect();
    let curve = openwork::domain::SpaceCurve::through(&points[..points.len() - 1], true).unwrap();
    let n = 20_000;
    let dense: Vec<glam::DVec3> =
        (0..n).map(|i| curve.frame(curve.length_mm() * f64::from(i) / f64::from(n)).point).collect();
    room.succeeds(
        "band lattice.svg --along points:frame.csv --width 10mm --components 1 --closed-pattern -o a.stl",
    );
    room.succeeds(
        "band lattice.svg --along helix:60mm,pitch=22mm,turns=4 --width 10mm --components 1 -o b.stl",
    );
    // Half of the thickness off the curve, all of it: middles of facets' edges are where flat facets are worst.
    let off_frame = |p: glam::DVec3| {
        let flat = glam::DVec2::new(p.x, p.y);
        let near =
            dense.iter().map(|q| flat.distance(glam::DVec2::new(q.x, q.y))).fold(f64::INFINITY, f64::min);
        (near - 1.0).abs()
    };
    let off_helix = |p: glam::DVec3| (p.x.hypot(p.y) - 30.0).abs().min((p.x.hypot(p.y) - 32.0).abs());
    let worst = |name: &str, off: &dyn Fn(glam::DVec3) -> f64| {
        let corners = read_corners(&room.read(name));
        let mut worst = 0.0f64;
        for facet in corners.chunks_exact(3).step_by(7) {
            let [a, b, c] = [facet[0], facet[1], facet[2]].map(glam::DVec3::from_array);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                // Only edges of the front and of the back: those between them have their middles a millimetre off.
                let middle = off(p.midpoint(q));
                if off(p) < 1e-3 && off(q) < 1e-3 && middle < 0.9 {
                    worst = worst.max(middle);
                }
            }
        }
        worst
    };
    assert!(worst("b.stl", &off_helix) < 0.01, "{}", worst("b.stl", &off_helix));
    assert!(worst("a.stl", &off_frame) < 0.01, "{}", worst("a.stl", &off_frame));
}

#[test]
fn the_flat_pattern_of_a_ring_is_cut_for_a_laser() {
    let room = Room::with(&["vine.svg"]);
    for width in ["12mm", "14mm", "16mm"] {
        room.succeeds(&format!(
            "band vine.svg --along ring:65mm --width {width} --components 1 --closed-pattern --kerf 0.15mm -o flat.dxf"
        ));
    }
}
