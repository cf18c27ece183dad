//! Rectangles by the program: exact size, counts on the file, tiles that join, what is refused.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use openwork::verify::{read_svg, tiling};

/// Makes a rectangle and gives its report.
fn rect(room: &Room, arguments: &str) -> serde_json::Value {
    room.succeeds(&format!("rect {arguments} -o out.svg -o out.stl -o out.png --report out.json"));
    room.json("out.json")
}

#[test]
fn the_ink_fills_the_rectangle_in_one_piece() {
    for (exemplar, size, width, height) in [
        ("lattice", "50x30mm", 50.0, 30.0),
        ("vine", "60x45mm", 60.0, 45.0),
        ("wave", "33.3x41.7", 33.3, 41.7),
    ] {
        let room = Room::with(&[&format!("{exemplar}.svg")]);
        let report = rect(&room, &format!("{exemplar}.svg --size {size} --width 9mm --components 1"));
        let found = read_svg(&room.read("out.svg"), 0.0025).unwrap();
        let (low, high) = found.bounds_mm.unwrap();
        assert!(
            (high.x - low.x - width).abs() < 0.02 && (high.y - low.y - height).abs() < 0.02,
            "{exemplar}"
        );
        assert_eq!(found.components, 1, "{exemplar}");
        assert_eq!(report["holes"], found.holes, "{exemplar}");
        assert_eq!((&report["shells"], &report["genus"]), (&1.into(), &found.holes.into()), "{exemplar}");
        assert_eq!(found.faults, [], "{exemplar}");
        assert!(report["tiling"].is_null());
        // Both directions are told.
        for (direction, length) in [("along_u", width), ("along_v", height)] {
            let direction = &report[direction];
            assert!((direction["length_mm"].as_f64().unwrap() - length).abs() < 1e-9);
            let pieces = direction["sequence"].as_array().unwrap().len();
            assert_eq!(direction["pieces_in_result"], pieces);
            assert!(direction["cost"].is_number() && !direction["cuts_mm"].as_array().unwrap().is_empty());
        }
        let chosen = report["chosen_attempt"].as_u64().unwrap() as usize;
        assert_eq!(report["attempts"][chosen]["outcome"], "planned");
    }
}

#[test]
fn copies_of_a_tile_join() {
    let room = Room::with(&["lattice.svg", "chain.svg"]);
    let report = rect(&room, "lattice.svg --size 40x40mm --width 10mm --components 1 --tile");
    let file = read_svg(&room.read("out.svg"), 0.0025).unwrap();
    let found = tiling(&file.region).unwrap();
    assert!((found.pitch_mm - 40.0).abs().max_element() < 1e-3, "{}", found.pitch_mm);
    assert!(found.joins_across > 0 && found.joins_up > 0);
    assert_eq!((file.components, found.components, found.four_components), (1, 1, 1));
    assert_eq!(report["tiling"]["holes"], found.holes);
    assert_eq!(report["tiling"]["four_holes"], found.four_holes);
    // The page is the tile.
    assert_eq!(report["page_mm"], serde_json::json!([40.0, 40.0]));
    let drawing = String::from_utf8(room.read("out.svg")).unwrap();
    assert!(drawing.contains("width=\"40mm\" height=\"40mm\" viewBox=\"0 0 40 40\""), "{drawing:.300}");
    let (low, high) = file.bounds_mm.unwrap();
    assert!(low.abs().max_element() < 1e-3 && (high - 40.0).abs().max_element() < 1e-3, "{low} {high}");
    // The program says the same.
    let said = room.succeeds("verify out.svg --tiles --components 1 --json").stdout;
    let said: serde_json::Value = serde_json::from_slice(&said).unwrap();
    assert_eq!(said["tiling"], report["tiling"]);
    let said = String::from_utf8(room.succeeds("verify out.svg --tiles").stdout).unwrap();
    assert!(said.contains("2 x 2 tiles  1 component(s)"), "{said}");
    assert_eq!(room.run("verify out.svg --tiles --components 2").code, 4);
    assert_eq!(room.run("verify out.stl --tiles").code, 2);
    // A rectangle that is no tile does not join.
    rect(&room, "chain.svg --size 40x40mm --width 10mm --components 1");
    let plain = read_svg(&room.read("out.svg"), 0.0025).unwrap();
    assert!(tiling(&plain.region).is_err());
    let refused = room.run("verify out.svg --tiles");
    assert!(refused.code == 4 && refused.stderr.contains("copies do not join"), "{}", refused.stderr);
}

#[test]
fn a_tile_may_be_of_several_strands() {
    let room = Room::with(&["vine.svg", "wave.svg"]);
    for (exemplar, width, is_one) in [("vine", "10mm", true), ("wave", "9mm", false)] {
        let report = rect(&room, &format!("{exemplar}.svg --size 30x30mm --width {width} --tile"));
        let file = read_svg(&room.read("out.svg"), 0.0025).unwrap();
        let found = tiling(&file.region).unwrap();
        assert!((found.pitch_mm - 30.0).abs().max_element() < 1e-3, "{exemplar}: {}", found.pitch_mm);
        assert!(found.joins_across > 0 && found.joins_up > 0, "{exemplar}");
        assert_eq!(report["components"], file.components, "{exemplar}");
        assert_eq!(report["tiling"]["components"], found.components, "{exemplar}");
        assert_eq!(report["tiling"]["holes"], found.holes, "{exemplar}");
        assert_eq!(report["tiling"]["four_components"], found.four_components, "{exemplar}");
        assert_eq!(report["tiling"]["four_holes"], found.four_holes, "{exemplar}");
        assert_eq!((found.components == 1, file.components == 1), (is_one, is_one), "{exemplar}");
    }
}

#[test]
fn holes_are_as_many_as_are_asked_for() {
    let room = Room::with(&["vine.svg"]);
    let report =
        rect(&room, "vine.svg --size 40x30mm --width 10mm --components 1 --holes 4 --memory-limit 256MB");
    let found = read_svg(&room.read("out.svg"), 0.0025).unwrap();
    assert_eq!((found.components, found.holes), (1, 4));
    assert_eq!(
        (&report["components"], &report["holes"], &report["genus"]),
        (&1.into(), &4.into(), &4.into())
    );
    room.succeeds("verify out.stl --components 1 --holes 4");
}

#[test]
fn bridges_join_what_the_rows_do_not() {
    let room = Room::with(&["leaves.svg"]);
    let report = rect(&room, "leaves.svg --size 30x20mm --width 10mm --components 1 --bridge 1mm");
    assert_eq!(read_svg(&room.read("out.svg"), 0.0025).unwrap().components, 1);
    let struts = report["bridges"]["struts"].as_u64().unwrap();
    let listed = report["bridges"]["bridges"].as_array().unwrap();
    assert!(struts > 0 && listed.len() as u64 >= struts);
    assert!(listed.iter().all(|bridge| bridge["width_mm"].as_f64().unwrap() >= 1.0 - 1e-9));
    room.succeeds("verify out.stl --components 1");
    // The certificate knows them, and the rectangle is not proven without one.
    room.succeeds("verify --certificate out.json out.svg");
    let mut report = report;
    report["certificate"]["bridges"].as_array_mut().unwrap().pop();
    room.write("fewer.json", &report.to_string());
    assert_eq!(room.run("verify --certificate fewer.json out.svg").code, 4);
}

#[test]
fn certificates_of_rectangles_replay_on_their_own_files() {
    let room = Room::with(&["vine.svg"]);
    let report = rect(&room, "vine.svg --size 40x30mm --width 10mm --components 1");
    for file in ["out.svg", "out.stl"] {
        let said = room.succeeds(&format!("verify --certificate out.json {file}")).stdout;
        assert!(String::from_utf8(said).unwrap().contains("certificate holds: "), "{file}");
    }
    // χ of the rectangle after one row.
    let mut tampered = report.clone();
    let euler = &mut tampered["certificate"]["steps"]["euler"][9];
    *euler = (euler.as_i64().unwrap() + 1).into();
    room.write("tampered.json", &tampered.to_string());
    let refuted = room.run("verify --certificate tampered.json out.svg");
    assert!(refuted.code == 4 && refuted.stderr.contains("join 9"), "{}", refuted.stderr);
    // Another rectangle is another file.
    room.succeeds("rect vine.svg --size 40x30mm --width 10mm --components 1 --seed 3 -o other.svg");
    assert_eq!(room.run("verify --certificate out.json other.svg").code, 4);
}

#[test]
fn what_cannot_be_is_refused_by_its_name() {
    let room = Room::with(&["vine.svg", "leaves.svg", "meander.svg", "wave.svg"]);
    let before = room.contents();
    for (arguments, code, says) in [
        ("vine.svg --size 120", 2, "such as 120x80mm"),
        ("vine.svg --size 120x", 2, "such as 120x80mm"),
        ("vine.svg --size 0x80mm", 2, "from 1 to 2000 mm"),
        ("vine.svg --size 120x90000mm", 2, "from 1 to 2000 mm"),
        ("vine.svg --size 40x30mm --width 31mm", 2, "--width"),
        ("vine.svg --size 4inx3in --width 90mm", 2, "101.6x76.2mm"),
        ("vine.svg --size 40x30mm --components 0", 2, "--components"),
        ("missing.svg --size 40x30mm", 2, "missing.svg"),
        // Separate leaves do not hang together however they are joined.
        ("leaves.svg --size 60x40mm --components 1", 3, "--bridge 1mm to join what stays apart"),
        // Nothing is told of components, for which nobody asked.
        ("wave.svg --size 20x15mm --width 5mm --holes 300", 3, "no sequence along 15.0 mm has 300 hole(s)"),
        // No strand leads on from one copy to the next.
        ("meander.svg --size 60x40mm --components 1 --tile", 3, "no cut crosses its ink"),
    ] {
        room.refuses(&format!("rect {arguments} -o out.svg"), code, &[says]);
        assert_eq!(room.contents(), before, "{arguments}");
    }
}

#[test]
fn the_same_bytes_again() {
    let room = Room::with(&["vine.svg"]);
    let files = |room: &Room| {
        let mut report = rect(room, "vine.svg --size 50x40mm --width 10mm --components 1 --seed 4");
        report.as_object_mut().unwrap().remove("times");
        (room.read("out.svg"), room.read("out.stl"), room.read("out.png"), report)
    };
    assert!(files(&room) == files(&room));
}
