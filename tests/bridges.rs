//! Bridges by the program: when they are laid, what the report and the certificate say of them, and what is finer than
//! the chord error.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use openwork::verify::read_svg;
use serde_json::Value;

/// Makes a band that must verify, and gives its report.
#[track_caller]
fn band(room: &Room, arguments: &str) -> Value {
    room.succeeds(&format!("band {arguments} -o out.svg --report out.json"));
    let report = room.json("out.json");
    let found = read_svg(&room.read("out.svg"), 0.0025).unwrap();
    assert_eq!(report["components"], found.components, "{arguments}");
    assert_eq!(report["holes"], found.holes, "{arguments}");
    report
}

/// The way that was made, and all that were weighed.
#[track_caller]
fn weighed(report: &Value) -> (&Value, &[Value]) {
    let ways = report["weighed"].as_array().unwrap();
    let chosen: Vec<&Value> = ways.iter().filter(|way| way["chosen"] == true).collect();
    assert_eq!(chosen.len(), 1);
    (chosen[0], ways)
}

#[test]
fn scraps_give_way_to_bridges_where_these_cost_less() {
    let room = Room::with(&["leaves.svg", "vine.svg"]);
    let report = band(&room, "leaves.svg --along line:120mm --components 1 --bridge 1mm");
    let (chosen, ways) = weighed(&report);
    assert_eq!(report["components"], 1);
    assert!(chosen["components"].is_null() && chosen["bridges"].as_u64().unwrap() > 0);
    // The leaves do hang together by themselves, at a price.
    let strict = ways.iter().find(|way| way["bridges"] == 0).unwrap();
    assert_eq!(strict["components"], serde_json::json!([1, 1]));
    for way in ways {
        assert!(chosen["total_cost"].as_f64().unwrap() <= way["total_cost"].as_f64().unwrap());
        let bridges = way["bridges"].as_f64().unwrap();
        let total = way["cost"].as_f64().unwrap() + 0.5 * bridges;
        assert!((total - way["total_cost"].as_f64().unwrap()).abs() < 1e-9);
    }
    assert!(report["bridges"]["struts"].as_u64().unwrap() > 0);
    let notes = report["notes"].to_string();
    assert!(notes.contains("not taken: cost ") && notes.contains("without bridges"), "{notes}");
    // What hangs together as it was drawn is left as it is.
    let report = band(&room, "vine.svg --along line:120mm --components 1 --bridge 1mm");
    assert_eq!(weighed(&report).0["bridges"], 0);
    assert!(report["bridges"].is_null());
}

#[test]
fn a_way_without_bridges_is_taken_where_these_have_no_place() {
    let room = Room::with(&["leaves.svg"]);
    // So wide a bridge covers the leaves that it is to join.
    let report = band(&room, "leaves.svg --along line:120mm --components 1 --bridge 40mm");
    let (chosen, ways) = weighed(&report);
    assert_eq!(chosen["bridges"], 0);
    let cheapest = ways.iter().map(|way| way["total_cost"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
    assert!(cheapest < chosen["total_cost"].as_f64().unwrap());
    assert!(report["bridges"].is_null());
}

#[test]
fn components_that_are_free_are_joined_where_holes_need_it() {
    let room = Room::with(&["rope.svg"]);
    let report = band(&room, "rope.svg --along line:120mm --holes 3 --bridge 0.8mm");
    assert_eq!(report["holes"], 3);
    room.succeeds("verify out.svg --holes 3");
    room.succeeds("verify --certificate out.json out.svg");
}

#[test]
fn rings_with_slits_prove_themselves() {
    let room = Room::with(&["lattice.svg"]);
    let ring = "lattice.svg --along circle:60mm --components 1 --holes 0 --bridge 0.8mm";
    let report = band(&room, ring);
    assert!(report["bridges"]["slits"].as_u64().unwrap() > 0);
    assert_eq!(report["certificate"]["closing"]["closed_pattern"], true);
    assert_eq!(report["closed_pattern"], false);
    room.succeeds("verify --certificate out.json out.svg");
    // Struts cannot have opened it.
    let mut tampered = report;
    for bridge in tampered["certificate"]["bridges"].as_array_mut().unwrap() {
        (bridge["kind"], bridge["holes"]) = ("strut".into(), 1.into());
    }
    room.write("tampered.json", &tampered.to_string());
    let refuted = room.run("verify --certificate tampered.json out.svg");
    assert!(refuted.code == 4 && refuted.stderr.contains("closed all the way round"), "{}", refuted.stderr);
}

#[test]
fn rectangles_with_holes_and_bridges_have_both() {
    let room = Room::with(&["leaves.svg"]);
    room.succeeds(
        "rect leaves.svg --size 30x20mm --width 10mm --components 1 --holes 2 --bridge 0.8mm --memory-limit 64MB -o out.svg --report out.json",
    );
    let found = read_svg(&room.read("out.svg"), 0.0025).unwrap();
    assert_eq!((found.components, found.holes), (1, 2));
    assert!(!room.json("out.json")["bridges"]["bridges"].as_array().unwrap().is_empty());
    room.succeeds("verify --certificate out.json out.svg");
}

/// A strand 6 mm high in waves, across the whole drawing.
fn wave(y: f64) -> String {
    let (n, step, height) = (8, 15.0, 6.0);
    let mut path = format!("M0 {y} ");
    for i in 0..n {
        let (x, swing) = (f64::from(i) * step, if i % 2 == 0 { 6.0 } else { -6.0 });
        let (at, end) = (y + swing, x + step);
        path += &format!("C{} {at} {} {at} {end} {y} ", x + 5.4, x + 9.6);
    }
    let low = y + height;
    path += &format!("V{low} ");
    for i in (0..n).rev() {
        let (x, swing) = (f64::from(i) * step, if i % 2 == 0 { 6.0 } else { -6.0 });
        let at = low + swing;
        path += &format!("C{} {at} {} {at} {x} {low} ", x + 9.6, x + 5.4);
    }
    format!("<path d='{path}Z'/>")
}

#[test]
fn what_is_finer_than_the_chord_error_is_made_within_a_smaller_one() {
    let room = Room::with(&[]);
    // Two strands, and between them a seventh of the chord error.
    room.draw("close.svg", &(wave(20.0) + &wave(26.03)));
    let report = band(&room, "close.svg --along line:150mm --width 20mm --chord 0.2mm");
    assert_eq!(report["components"], 2);
    let notes = report["notes"].to_string();
    assert!(notes.contains("made within 0.05 mm instead of 0.2 mm"), "{notes}");
    // With room between them, within what was asked for.
    room.draw("apart.svg", &(wave(20.0) + &wave(26.3)));
    let report = band(&room, "apart.svg --along line:150mm --width 20mm --chord 0.2mm");
    assert!(!report["notes"].to_string().contains("made within"));
}
