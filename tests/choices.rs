//! Which of many bands are made: ranges of counts, the k cheapest, random ones, and bridges where none is.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::collections::BTreeSet;

use common::Room;
use openwork::job::{BandBuilder, Choice, Output, write_numbered};

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

/// Where the exemplar repeats a motif, another piece of the same look makes no other band.
#[test]
fn no_two_of_the_best_look_the_same() {
    let room = Room::with(&["filigree.svg"]);
    room.succeeds("band filigree.svg --along line:120mm --width 14mm --components 1 --best 5 -o k.svg");
    let files: std::collections::BTreeSet<Vec<u8>> =
        (1..=5).map(|rank| room.read(&format!("k-{rank:02}.svg"))).collect();
    assert_eq!(files.len(), 5);
}

#[test]
fn the_k_best_are_in_order_and_begin_with_the_optimum() {
    let room = Room::with(&["vine.svg"]);
    let band = "band vine.svg --along line:60mm --width 14mm --components 1";
    room.succeeds(&format!("{band} -o o.svg --report o.json"));
    room.succeeds(&format!("{band} --best 3 -o k.svg --report k.json"));
    let cost = |name: &str| room.json(name)["cost"].as_f64().unwrap();
    let costs: Vec<f64> = (1..=3).map(|n| cost(&format!("k-0{n}.json"))).collect();
    assert!(costs.windows(2).all(|pair| pair[0] <= pair[1]), "{costs:?}");
    assert!((costs[0] - cost("o.json")).abs() < 1e-9);
    // What each is worth is told against the first.
    for (rank, cost) in (1..).zip(&costs) {
        let report = room.json(&format!("k-0{rank}.json"));
        assert_eq!(report["rank"], rank);
        assert_eq!(report["optimal"], *cost == costs[0]);
        assert!((report["cost_gap"].as_f64().unwrap() - (cost - costs[0])).abs() < 1e-9);
    }
    let sequence = |n: usize| room.json(&format!("k-0{n}.json"))["sequence"].to_string();
    assert_eq!((1..=3).map(sequence).collect::<BTreeSet<_>>().len(), 3);
    for n in 1..=3 {
        room.succeeds(&format!("verify k-0{n}.svg --components 1"));
    }
    assert!(costs[2] > costs[0]);
    assert!(room.json("o.json")["rank"].is_null());
    room.refuses(&format!("{band} --best 3 --memory-limit 1MB -o m.svg"), 3, &["--memory-limit"]);
}

#[test]
fn several_bands_are_written_together_or_not_at_all() {
    let room = Room::with(&["vine.svg"]);
    let bands = BandBuilder::new(room.path("vine.svg"), "line:60mm".parse().unwrap())
        .choice(Choice::Best(3))
        .build()
        .unwrap()
        .run_all(&mut |_| {})
        .unwrap();
    let outputs = [Output::file(room.path("b.svg")).unwrap()];
    // The last of them cannot be written.
    std::fs::create_dir(room.path("b-03.svg")).unwrap();
    let before = room.contents();
    write_numbered(&bands, &outputs, None, &mut |_| {}).unwrap_err();
    assert_eq!(room.contents(), before);
    std::fs::remove_dir(room.path("b-03.svg")).unwrap();
    assert_eq!(write_numbered(&bands, &outputs, None, &mut |_| {}).unwrap().len(), 3);
    assert!((1..=3).all(|n| room.path(&format!("b-0{n}.svg")).is_file()));
    // Numbered names are no input, and what fails verification leaves none.
    room.succeeds("band vine.svg --along line:60mm --count 2 --seed 7 -o vine.svg");
    let draw = "band vine.svg --along line:60mm --components 1 --count 12 --seed 7 --min-feature 0.7mm";
    room.refuses(&format!("{draw} -o c.svg -o c.stl --report c.json"), 4, &["Nothing was written"]);
}

#[test]
fn options_are_honoured_or_refused() {
    let room = Room::with(&["vine.svg", "strands.svg"]);
    let tile = "rect vine.svg --size 60x40mm --tile --bridge 1mm -o t.svg";
    room.refuses(tile, 2, &["--bridge", "--tile", "leave out one"]);
    let varied = "band vine.svg --along line:60mm --best 3 --variety 1 -o t.svg";
    room.refuses(varied, 2, &["--variety", "leave out --best"]);
    // Each of many bands is bridged.
    let strands = "band strands.svg --along line:60mm --width 14mm --components 1 --count 3 --seed 7";
    room.refuses(&format!("{strands} -o s.svg"), 3, &["--bridge"]);
    room.succeeds(&format!("{strands} --bridge 1mm -o s.svg --report s.json"));
    let mut sequences = BTreeSet::new();
    for number in 1..=3 {
        room.succeeds(&format!("verify s-0{number}.svg --components 1"));
        let report = room.json(&format!("s-0{number}.json"));
        assert_eq!(report["bridges"]["struts"], 2);
        sequences.insert(report["sequence"].to_string());
    }
    assert_eq!(sequences.len(), 3);
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
