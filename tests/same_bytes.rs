//! The same input and seed give the same bytes, whatever the number of threads.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::{Finished, Room};
use openwork::domain::CurveSpec;
use openwork::job::{BandBuilder, Output};
use serde_json::Value;

/// Ways of using the search and the geometry: a ring, an open path with jumps, a band with variety, and two that are mended,
/// shaded, cut and printed. With what each writes.
const JOBS: [(&str, &[&str]); 5] = [
    (
        "band vine.svg --along circle:65mm --width 14mm --components 1 --closed-pattern --seed 7",
        &["out.svg", "out.stl", "out.png"],
    ),
    ("band leaves.svg --along path:curve.svg --width 9mm --seed 3", &["out.svg", "out.stl", "out.png"]),
    (
        "band wave.svg --along line:60mm --width 10mm --components 1 --variety 0.5",
        &["out.svg", "out.stl", "out.png"],
    ),
    (
        "band lace.svg --along circle:65mm --width 14mm --enforce --min-feature 0.6mm --min-gap 0.5mm --view iso --pixels 400",
        &["out.dxf", "out.3mf", "out.png"],
    ),
    (
        "band leaves.svg --along line:90mm --width 9mm --enforce --min-feature 0.6mm --min-gap 0.5mm --view front --pixels 400",
        &["out.dxf", "out.3mf", "out.png"],
    ),
];

/// Every file that a job writes, and its report without the times.
fn results(room: &Room, (job, outputs): (&str, &[&str]), threads: &str) -> (Vec<Vec<u8>>, Value) {
    let named: String = outputs.iter().map(|name| format!(" -o {name}")).collect();
    let arguments = format!("{job} {named} --report out.json");
    let finished = Finished::of(room.command(&arguments).env("OPENWORK_THREADS", threads));
    assert_eq!(finished.code, 0, "{job}: {}", finished.stderr);
    let mut report = room.json("out.json");
    report.as_object_mut().unwrap().remove("times");
    (outputs.iter().map(|name| room.read(name)).collect(), report)
}

#[test]
fn one_thread_two_threads_three_and_again() {
    let room = Room::with(&["vine.svg", "leaves.svg", "wave.svg", "lace.svg"]);
    room.draw("curve.svg", "<path d='M5 40 C40 -10 80 70 115 20' fill='none' stroke='black'/>");
    for job in JOBS {
        let first = results(&room, job, "1");
        for threads in ["1", "2", "3"] {
            let again = results(&room, job, threads);
            let same: Vec<bool> = first.0.iter().zip(&again.0).map(|(a, b)| a == b).collect();
            assert_eq!(same, [true; 3], "{:?} of {} on {threads} thread(s)", job.1, job.0);
            assert_eq!(first.1, again.1, "the report of {} on {threads} thread(s)", job.0);
        }
    }
}

/// What a refusal looks for, it looks for on several threads.
#[test]
fn a_refusal_says_the_same_again() {
    let room = Room::with(&["lace.svg", "lattice.svg"]);
    for job in [
        "band lace.svg --along line:240mm --components 1 --holes 12",
        "band lattice.svg --along line:240mm --components 1 --holes 12",
    ] {
        let said = || {
            let finished = Finished::of(&mut room.command(&format!("{job} -o out.svg")));
            assert_eq!(finished.code, 3, "{job}: {}", finished.stderr);
            finished.stderr
        };
        let first = said();
        assert!((0..3).all(|_| said() == first), "{job}: {first}");
    }
}

#[test]
fn seeds_differ_and_none_is_better_than_the_optimum() {
    let room = Room::with(&["vine.svg"]);
    for curve in ["--along line:240mm --width 20mm --components 1", "--along circle:65mm --width 14mm"] {
        let band = |seed: &str| {
            room.succeeds(&format!("band vine.svg {curve} {seed} -o out.svg --report out.json"));
            let report = room.json("out.json");
            (report["sequence"].clone(), report["cost"].as_f64().unwrap(), report["optimal"].clone())
        };
        let (_, least, optimal) = band("");
        assert_eq!(optimal, true);
        let seeded: Vec<_> = (1..=4).map(|seed| band(&format!("--seed {seed}"))).collect();
        for (_, cost, optimal) in &seeded {
            assert!(*cost >= least && optimal.is_null(), "{cost} is less than the optimum {least}");
        }
        let is_new = |i: usize| seeded[..i].iter().all(|(sequence, ..)| *sequence != seeded[i].0);
        let different = (0..seeded.len()).filter(|&i| is_new(i)).count();
        assert!(different >= 2, "four seeds gave {different} band(s): {curve}");
    }
}

/// What was made beside the drawing for some outputs is the same as what is made later for others.
#[test]
fn solids_made_ahead_are_those_made_later() {
    let along: CurveSpec = "line:40mm".parse().unwrap();
    let job = BandBuilder::new("fixtures/exemplars/vine.svg", along).width_mm(10.0).build().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let outputs = |names: &[&str]| -> Vec<Output> {
        names.iter().map(|name| Output::file(folder.path().join(name)).unwrap()).collect()
    };
    let band = |outputs: &[Output]| job.run_all_for(outputs, &mut |_| {}).unwrap().swap_remove(0);
    let ahead = outputs(&["ahead.svg", "ahead.stl", "again.stl"]);
    band(&ahead).write(&ahead, None, &mut |_| {}).unwrap();
    let later = outputs(&["later.stl", "later.obj", "later.svg"]);
    band(&outputs(&["never.3mf"])).write(&later, None, &mut |_| {}).unwrap();
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("ahead.svg"), bytes("later.svg"));
    assert_eq!(bytes("ahead.stl"), bytes("later.stl"));
    assert_eq!(bytes("ahead.stl"), bytes("again.stl"));
    assert!(!folder.path().join("never.3mf").exists() && !bytes("later.obj").is_empty());
}
