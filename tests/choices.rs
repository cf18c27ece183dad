//! Which of many bands are made: ranges of counts, the k cheapest, random ones, and bridges where none is.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::collections::BTreeSet;

use common::Room;

#[test]
fn drawn_bands_are_different_valid_and_the_same_for_the_same_seed() {
    let room = Room::with(&["vine.svg"]);
    let draw = "band vine.svg --along line:60mm --width 14mm --components 1 --count 4 --seed 7";
    room.succeeds(&format!("{draw} -o a.svg --report a.json"));
    room.succeeds(&format!("{draw} -o b.svg"));
    let mut sequences = BTreeSet::new();
    for number in 1..=4 {
        let name = |stem: &str| format!("{stem}-0{number}.svg");
        room.succeeds(&format!("verify {} --components 1", name("a")));
        assert_eq!(room.read(&name("a")), room.read(&name("b")), "same seed, same bytes");
        let report = room.json(&format!("a-0{number}.json"));
        assert_eq!(report["seed"], 7);
        // Few pieces and a short line: the census of all bands is affordable.
        assert_eq!(report["drawn_exactly"], true);
        assert!(report["log10_sequences"].as_f64().unwrap() > 1.0);
        sequences.insert(report["sequence"].to_string());
    }
    assert_eq!(sequences.len(), 4);
    room.succeeds(&format!("{} -o c.svg", draw.replace("--seed 7", "--seed 8")));
    assert!((1..=4).any(|n| room.read(&format!("a-0{n}.svg")) != room.read(&format!("c-0{n}.svg"))));
}

#[test]
fn the_k_best_are_in_order_and_begin_with_the_optimum() {
    let room = Room::with(&["vine.svg"]);
    let band = "band vine.svg --along line:60mm --width 14mm --components 1";
    room.succeeds(&format!("{band} -o o.svg --report o.json"));
    room.succeeds(&format!("{band} --best 3 -o k.svg --report k.json"));
    let (optimum, reports) = (room.json("o.json"), (1..=3).map(|n| room.json(&format!("k-0{n}.json"))));
    let reports: Vec<serde_json::Value> = reports.collect();
    let costs: Vec<f64> = reports.iter().map(|report| report["cost"].as_f64().unwrap()).collect();
    assert!(costs.is_sorted() && costs[0] < costs[2], "{costs:?}");
    assert!((costs[0] - optimum["cost"].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(optimum["optimal"], true);
    let sequences: BTreeSet<String> = reports.iter().map(|report| report["sequence"].to_string()).collect();
    assert_eq!(sequences.len(), 3);
    for n in 1..=3 {
        room.succeeds(&format!("verify k-0{n}.svg --components 1"));
    }
}

#[test]
fn a_mirrored_piece_repeats_the_piece() {
    let room = Room::with(&["leaves.svg"]);
    let band = "band leaves.svg --along line:240mm --width 20mm --components 1 --mirror --variety 0.5";
    room.succeeds(&format!("{band} -o m.svg --report m.json"));
    let report = room.json("m.json");
    let originals = report["pieces_in_exemplar"].as_u64().unwrap();
    let sequence: Vec<u64> =
        report["sequence"].as_array().unwrap().iter().map(|piece| piece.as_u64().unwrap()).collect();
    assert!(sequence.iter().any(|&piece| piece >= originals), "the band has mirrored pieces");
    // Zhou 2014 §3.7 by its definition, with numbers in the exemplar.
    let at = |shift: usize| -> f64 {
        let pairs = sequence.iter().zip(&sequence[shift..]);
        pairs.map(|(a, b)| (-2.0 * (a % originals).abs_diff(b % originals) as f64).exp()).sum()
    };
    let most = (1..sequence.len()).map(at).fold(0.0, f64::max);
    let reported = report["autocorrelation"].as_f64().unwrap();
    assert!((reported - most).abs() < 1e-9, "{reported} is not {most}");
}

#[test]
fn ranges_hold_and_bridges_make_what_cannot_be_had() {
    let room = Room::with(&["vine.svg", "strands.svg"]);
    room.succeeds("band vine.svg --along line:120mm --components 1 --holes 2..4 -o r.svg --report r.json");
    assert!((2..=4).contains(&room.json("r.json")["holes"].as_u64().unwrap()));
    room.succeeds("verify --certificate r.json r.svg");

    let strands = "band strands.svg --along line:120mm --width 20mm --components 1";
    let refused = room.run(&format!("{strands} -o s.svg"));
    assert_eq!(refused.code, 3);
    assert!(refused.stderr.contains("--bridge"), "{}", refused.stderr);
    room.succeeds(&format!("{strands} --bridge 1mm -o s.svg -o s.stl -o s.png --report s.json"));
    room.succeeds("verify s.svg --components 1");
    room.succeeds("verify s.stl --components 1");
    room.succeeds("verify --certificate s.json s.svg");
    let bridges = &room.json("s.json")["bridges"];
    assert_eq!(bridges["struts"], 2);
    assert!(bridges["bridges"][0]["width_mm"].as_f64().unwrap() >= 1.0 - 1e-9);
}
