//! A report proves its band: the certificate replays on the files that were written with it, and on nothing else.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use openwork::verify::{self, CertificatePlace, CertificateReport, Counted, SvgReport};
use serde_json::{Value, json};

/// A ring and an open band of the vine, with their reports.
fn bands() -> Room {
    let room = Room::with(&["vine.svg", "strands.svg"]);
    let vine = "band vine.svg --width 14mm --components 1";
    room.succeeds(&format!(
        "{vine} --along circle:65mm --closed-pattern -o ring.svg -o ring.stl -o ring.png --report ring.json"
    ));
    room.succeeds(&format!("{vine} --along line:150mm --mirror -o line.svg --report line.json"));
    room.succeeds("band strands.svg --along circle:60mm --width 12mm -o many.svg --report many.json");
    room
}

/// Verification must fail with code 4 and say all of `words`; what was counted is printed all the same.
#[track_caller]
fn disproves(room: &Room, arguments: &str, words: &[&str]) {
    let finished = room.run(arguments);
    assert_eq!(finished.code, 4, "{arguments}: {}", finished.stderr);
    for word in words {
        assert!(finished.stderr.contains(word), "\"{word}\" is not in: {}", finished.stderr);
    }
}

/// A file as it was read again.
struct Drawing {
    bytes: Vec<u8>,
    counted: SvgReport,
}

impl Drawing {
    fn of(room: &Room, file: &str) -> Self {
        let bytes = room.read(file);
        let counted = verify::read_svg(&bytes, 0.0025).unwrap();
        Self { bytes, counted }
    }

    fn replay(&self, report: &Value) -> CertificateReport {
        let report = report.to_string();
        verify::replay_certificate(report.as_bytes(), &self.bytes, Counted::Svg(&self.counted)).unwrap()
    }
}

/// The certificate must not hold, first at a place and for a reason.
#[track_caller]
fn refuted(file: &Drawing, report: &Value, words: &[&str]) -> CertificateReport {
    let found = file.replay(report);
    assert!(!found.holds && !found.faults.is_empty());
    let text = found.to_string();
    for word in words {
        assert!(text.contains(word), "\"{word}\" is not in: {text}");
    }
    found
}

#[test]
fn certificates_replay_on_their_own_files() {
    let room = bands();
    for (report, file) in [
        ("ring.json", "ring.svg"),
        ("ring.json", "ring.stl"),
        ("line.json", "line.svg"),
        ("many.json", "many.svg"),
    ] {
        let said = room.succeeds(&format!("verify {file} --certificate {report}"));
        let text = String::from_utf8(said.stdout).unwrap();
        assert!(text.contains("certificate holds: "), "{text}");
    }
    let json = room.succeeds("verify --json --certificate ring.json ring.svg").stdout;
    let json: Value = serde_json::from_slice(&json).unwrap();
    let report = room.json("ring.json");
    assert_eq!((&json["certificate"]["holds"], &json["components"]), (&json!(true), &json!(1)));
    assert_eq!(json["certificate"]["closed_pattern"], true);
    assert_eq!(json["certificate"]["joins"], report["pieces_in_result"]);
    let line: Value =
        serde_json::from_slice(&room.succeeds("verify --json --certificate line.json line.svg").stdout)
            .unwrap();
    assert_eq!(line["certificate"]["holes"], room.json("line.json")["holes"]);
    // Another writer may lay the report out as it likes.
    assert!(Drawing::of(&room, "ring.svg").replay(&report).holds);
}

#[test]
fn a_swapped_file_is_told() {
    let room = bands();
    disproves(&room, "verify --certificate ring.json line.svg", &["SHA-256"]);
    disproves(&room, "verify --certificate line.json ring.svg", &["SHA-256"]);
    // The line has no solid.
    disproves(&room, "verify --certificate line.json ring.stl", &["as .stl: no such file"]);
    // One byte more is another file, though it counts the same.
    let text = String::from_utf8(room.read("line.svg")).unwrap();
    room.write("line.svg", &(text + "\n"));
    disproves(&room, "verify --certificate line.json line.svg", &["the file: its SHA-256 is"]);
    room.write("empty.json", "{}");
    room.write("words.json", "words");
    assert_eq!(room.run("verify --certificate empty.json ring.svg").code, 2);
    assert_eq!(room.run("verify --certificate words.json ring.svg").code, 2);
    assert_eq!(room.run("verify --certificate nowhere.json ring.svg").code, 2);
}

#[test]
fn every_tampered_number_is_found_where_it_stands() {
    let room = bands();
    let (report, ring) = (room.json("ring.json"), Drawing::of(&room, "ring.svg"));
    let tampered = |change: &dyn Fn(&mut Value)| {
        let mut report = report.clone();
        change(&mut report["certificate"]);
        report
    };
    let raise = |value: &mut Value| *value = json!(value.as_i64().unwrap() + 1);

    // χ of the run after one join: that join and the next one do not follow, and no other.
    let found = refuted(&ring, &tampered(&|c| raise(&mut c["steps"]["euler"][20])), &["join 20, of piece"]);
    let positions: Vec<usize> = found
        .faults
        .iter()
        .filter_map(|f| match f.place {
            CertificatePlace::Join { position, .. } => Some(position),
            _ => None,
        })
        .collect();
    assert!(positions == [20, 21] || positions == [20], "{positions:?}");

    // χ of a piece.
    refuted(&ring, &tampered(&|c| raise(&mut c["pieces"][3]["euler"])), &["piece "]);
    let lower = tampered(&|c| {
        let euler = &mut c["pieces"][3]["euler"];
        *euler = json!(euler.as_i64().unwrap() - 1);
    });
    refuted(&ring, &lower, &["join ", "Euler characteristic"]);

    // One label of a piece, wherever it is.
    let pieces = report["certificate"]["pieces"].as_array().unwrap().len();
    for piece in 0..pieces {
        for side in ["left", "right"] {
            for portal in 0..report["certificate"]["pieces"][piece][side].as_array().unwrap().len() {
                let relabelled = tampered(&|c| {
                    let label = &mut c["pieces"][piece][side][portal];
                    *label = json!(if label == 0 { 1 } else { 0 });
                });
                assert!(!ring.replay(&relabelled).holds, "{piece} {side} {portal}");
            }
        }
    }

    // One step of the sequence, by any other piece that the list knows.
    let others: Vec<Value> =
        report["certificate"]["pieces"].as_array().unwrap().iter().map(|p| p["piece"].clone()).collect();
    for other in others.iter().filter(|&other| *other != report["certificate"]["sequence"][7]) {
        let changed = tampered(&|c| c["sequence"][7] = other.clone());
        assert!(!ring.replay(&changed).holds, "{other}");
        // Also when the report is changed at both places.
        let mut both = changed;
        both["sequence"][7] = other.clone();
        assert!(!ring.replay(&both).holds, "{other}");
    }
    refuted(&ring, &tampered(&|c| c["sequence"][7] = json!(9999)), &["piece 9999 has no descriptor"]);

    // The rest.
    refuted(&ring, &tampered(&|c| c["steps"]["state"][9] = json!(-1)), &["join 9", "no state -1"]);
    refuted(&ring, &tampered(&|c| raise(&mut c["steps"]["closed"][5])), &["join 5", "closed components"]);
    refuted(&ring, &tampered(&|c| raise(&mut c["closing"]["components"])), &["the closing join"]);
    refuted(&ring, &tampered(&|c| c["closing"]["closed_pattern"] = json!(false)), &["all the way round"]);
    refuted(&ring, &tampered(&|c| c["closing"] = json!(null)), &["a ring has one"]);
    refuted(&ring, &tampered(&|c| raise(&mut c["result"]["holes"])), &["the result", "the report"]);
    refuted(&ring, &tampered(&|c| c["wanted"]["components"] = json!([2, 3])), &["2 to 3 component(s)"]);
    refuted(&ring, &tampered(&|c| raise(&mut c["recount"][1])), &["the file has 1 component(s)"]);
    refuted(&ring, &tampered(&|c| c["sha256"] = json!("0")), &["the whole: "]);
    let mut outside = report.clone();
    outside["sequence"][7] = json!(0);
    refuted(&ring, &outside, &["the report: its sequence"]);
    let mut outside = report.clone();
    outside["components"] = json!(2);
    refuted(&ring, &outside, &["the report: its components"]);
}

#[test]
fn the_pieces_are_those_of_the_exemplar() {
    let room = bands();
    for (report, file) in [("ring.json", "ring.svg"), ("line.json", "line.svg")] {
        let said = room.succeeds(&format!("verify {file} --certificate {report} --exemplar vine.svg")).stdout;
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("its pieces are those of the exemplar"), "{said}");
    }
    let verify = "verify ring.svg --certificate forged.json --exemplar vine.svg";
    let forge = |change: &dyn Fn(&mut Value)| {
        let mut report = room.json("ring.json");
        change(&mut report["certificate"]);
        room.write("forged.json", &report.to_string());
    };
    // One descriptor, one place in the sequence, χ off by one, a count: each is told at its place.
    forge(&|c| c["pieces"][2]["closed"] = json!(7));
    let piece = room.json("ring.json")["certificate"]["pieces"][2]["piece"].to_string();
    disproves(&room, verify, &[&format!("piece {piece}: the exemplar has closed components"), "says 7"]);
    forge(&|c| {
        let (a, b) = (c["sequence"][5].clone(), c["sequence"][6].clone());
        (c["sequence"][5], c["sequence"][6]) = (b, a);
    });
    disproves(&room, verify, &["join 5, of piece", "the report: its sequence"]);
    forge(&|c| c["steps"]["euler"][9] = json!(c["steps"]["euler"][9].as_i64().unwrap() - 1));
    disproves(&room, verify, &["join 9, of piece", "Euler characteristic"]);
    forge(&|c| c["result"]["components"] = json!(2));
    disproves(&room, verify, &["the result: the steps add up to 1 component(s)"]);
    // Another exemplar, and other cuts.
    let strands = verify.replace("vine.svg", "strands.svg");
    disproves(&room, &strands, &["the exemplar: its SHA-256 is"]);
    forge(&|c| c["source"]["cuts"] = json!([1, 2, 3]));
    disproves(&room, verify, &["the exemplar: "]);
    forge(&|c| {
        let cuts = c["source"]["cuts"].as_array_mut().unwrap();
        cuts.reverse();
    });
    disproves(&room, verify, &["not from left to right"]);
    forge(&|c| c["source"] = json!(null));
    assert_eq!(room.run(verify).code, 2);
    assert_eq!(room.run("verify ring.svg --exemplar vine.svg").code, 2);
}

#[test]
fn bridges_change_the_counts_as_they_can() {
    let room = bands();
    let (report, many) = (room.json("many.json"), Drawing::of(&room, "many.svg"));
    let bridged = |kind: &str, components: i64, holes: i64| {
        let mut report = report.clone();
        let bridge = json!({ "kind": kind, "components": components, "holes": holes, "position_um": [0, 0] });
        report["certificate"]["bridges"] = json!([bridge]);
        let result = &mut report["certificate"]["result"];
        result["components"] = json!(result["components"].as_i64().unwrap() + components);
        result["holes"] = json!(result["holes"].as_i64().unwrap() + holes);
        result["euler"] = json!(result["euler"].as_i64().unwrap() + components - holes);
        let found = many.replay(&report);
        let at = |wanted: fn(&CertificatePlace) -> bool| found.faults.iter().any(|f| wanted(&f.place));
        // The file has no bridge: the recount tells.
        let told =
            at(|p| matches!(p, CertificatePlace::Recount)) && !at(|p| matches!(p, CertificatePlace::Result));
        assert!(told || kind == "staple");
        at(|p| matches!(p, CertificatePlace::Bridge { .. }))
    };
    assert!(!bridged("strut", 0, 1));
    assert!(!bridged("slit", 0, -1));
    assert!(!bridged("slit", 1, 0));
    assert!(bridged("strut", 0, -1));
    assert!(bridged("strut", 1, 0));
    assert!(bridged("slit", 0, 1));
    assert!(bridged("staple", 0, 1));
}

#[test]
fn a_certificate_is_a_few_numbers_for_each_piece() {
    let room = Room::with(&["vine.svg"]);
    let size = |length: u32| {
        room.succeeds(&format!("band vine.svg --along line:{length}mm --width 8mm -o b.svg --report b.json"));
        let report = room.json("b.json");
        (report["certificate"].to_string().len(), report["pieces_in_result"].as_u64().unwrap() as usize)
    };
    let ((short, few), (long, many)) = (size(100), size(1600));
    let each = (long - short) as f64 / (many - few) as f64;
    assert!(each < 20.0, "{each} bytes for each piece");
}

#[test]
fn bridges_are_where_a_pressed_band_has_them() {
    let room = Room::with(&["strands.svg"]);
    // Wider ink would grow over the box of the band, so that all of it is pressed together first, bridges too.
    room.succeeds(
        "band strands.svg --along line:90mm --width 12mm --components 1 --bridge 1mm --min-feature 1.3mm --enforce \
         -o band.svg --report band.json",
    );
    let report = room.json("band.json");
    assert!(report["enforced"]["pressed_mm"][0].as_f64().unwrap() > 0.1, "{}", report["enforced"]);
    let steps = report["certificate"]["bridges"].as_array().unwrap();
    let bridges = report["bridges"]["bridges"].as_array().unwrap();
    assert!(!steps.is_empty() && steps.len() == bridges.len());
    for (step, bridge) in steps.iter().zip(bridges) {
        for axis in 0..2 {
            let [from, to] = ["from_mm", "to_mm"].map(|end| bridge[end][axis].as_f64().unwrap());
            assert_eq!(step["position_um"][axis].as_f64().unwrap(), (500.0 * (from + to)).round());
        }
    }
    room.succeeds("verify band.svg --certificate band.json");
}
