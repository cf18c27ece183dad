//! Files for a laser: they are read again, hold what was asked for, and are refused before they exist where the beam
//! would spoil the part.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use serde_json::Value;

const BAND: &str = "band vine.svg --along line:120mm --width 16mm --components 1";

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or_else(|| panic!("{name} in {value}"))
}

#[test]
fn every_kind_of_cut_file_has_the_counts_of_the_report() {
    let room = Room::with(&["vine.svg"]);
    for curves in ["arcs", "polyline", "spline"] {
        let said = room.succeeds(&format!(
            "{BAND} --kerf 0.1mm --curves {curves} --cut -o {curves}.dxf -o {curves}.svg --report {curves}.json"
        ));
        assert!(said.stderr.contains("pierces"), "{}", said.stderr);
        let report = room.json(&format!("{curves}.json"));
        let laser = &report["laser"];
        let (components, holes) = (&report["components"], &report["holes"]);
        assert_eq!((&laser["components"], &laser["holes"]), (components, holes));
        let pierces = components.as_u64().unwrap() + holes.as_u64().unwrap();
        assert_eq!(laser["pierces"].as_u64(), Some(pierces));
        assert_eq!(
            laser["files"][0]["bytes"].as_u64(),
            Some(room.read(&format!("{curves}.dxf")).len() as u64)
        );
        for file in [format!("{curves}.dxf"), format!("{curves}.svg")] {
            let args = format!("verify {file} --components {components} --holes {holes}");
            let found: Value =
                serde_json::from_slice(&room.succeeds(&format!("{args} --json")).stdout).unwrap();
            assert_eq!(found["faults"].as_array().unwrap().len(), 0, "{file}");
            assert!(
                (number(&found, "cut_length_mm") / number(laser, "cut_length_mm") - 1.0).abs() < 1e-3,
                "{file}"
            );
            room.succeeds(&format!("verify --certificate {curves}.json {file}"));
            assert_eq!(room.run(&format!("verify {file} --components 2")).code, 4);
        }
    }
    room.succeeds(&format!("{BAND} --kerf 0.1mm --dxf-version r12 -o old.dxf"));
    let found = room.succeeds("verify old.dxf --components 1");
    assert!(String::from_utf8_lossy(&found.stdout).contains("does not say its unit"));
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let room = Room::with(&["vine.svg"]);
    for name in ["a", "b"] {
        room.succeeds(&format!("{BAND} --kerf 0.1mm --cut -o {name}.dxf -o {name}.svg"));
    }
    assert_eq!(room.read("a.dxf"), room.read("b.dxf"));
    assert_eq!(room.read("a.svg"), room.read("b.svg"));
}

/// A frame with a plate in it: one hole.
const FRAME: &str = "<path fill-rule='evenodd' d='M5 5H45V25H5Z M10 10H40V20H10Z'/>";

#[test]
fn kerf_moves_contours_by_half_and_the_part_keeps_its_size() {
    let room = Room::with(&[]);
    room.draw("frame.svg", FRAME);
    room.succeeds("extrude frame.svg --kerf 0.2mm -o frame.dxf");
    let found: Value = serde_json::from_slice(&room.succeeds("verify frame.dxf --json").stdout).unwrap();
    let corners: Vec<f64> = found["bounds_mm"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|p| p.as_array().unwrap())
        .map(|v| v.as_f64().unwrap())
        .collect();
    assert!((corners[2] - corners[0] - 40.2).abs() < 1e-3 && (corners[3] - corners[1] - 20.2).abs() < 1e-3);
    assert!((number(&found, "area_mm2") - (40.2 * 20.2 - 29.8 * 9.8)).abs() < 0.1);
}

#[test]
fn a_sign_says_what_falls_out() {
    let room = Room::with(&[]);
    room.draw("frame.svg", FRAME);
    let said = room.succeeds("extrude frame.svg --sheet 60x40mm --carve -o sign.dxf -o sign.png --json");
    assert!(
        said.stderr.contains("1 piece(s) fall out of the plate, the largest of 300.0 mm2"),
        "{}",
        said.stderr
    );
    let report: Value = serde_json::from_slice(&said.stdout).unwrap();
    let piece = &report["laser"]["falls_out"][0];
    let at = [0, 1].map(|i| piece["position_mm"][i].as_f64().unwrap());
    assert!((at[0] - 30.0).abs() < 1e-6 && (at[1] - 20.0).abs() < 1e-6, "{at:?}");
    room.succeeds("verify sign.dxf --components 2 --holes 1");
    let said = room.succeeds("extrude frame.svg --bridge 1mm --holes 0 --sheet 60x40mm --carve -o whole.dxf");
    assert!(said.stderr.contains("nothing falls out of the plate"), "{}", said.stderr);
    room.succeeds("verify whole.dxf --components 1 --holes 1");
    // Laid on a plate instead, the part counts, and the outline of the plate does not.
    room.succeeds("extrude frame.svg --sheet 60x40mm -o laid.dxf");
    room.succeeds("verify laid.dxf --components 1 --holes 1");
}

#[test]
fn what_the_beam_would_spoil_is_refused() {
    let room = Room::with(&[]);
    room.draw("frame.svg", FRAME);
    let refuses = |options: &str, code: i32, words: &[&str]| {
        room.refuses(&format!("extrude frame.svg {options}"), code, words);
    };
    refuses(
        "--kerf 6mm -o out.dxf",
        3,
        &["--kerf", "a feature of 5.0", "narrower than the kerf of 6 mm", "mm a"],
    );
    refuses("--kerf 0mm -o out.dxf", 2, &["--kerf", "the kerf is 0 mm", "from 0.001"]);
    refuses("--kerf -1mm -o out.dxf", 2, &["--kerf"]);
    refuses("--kerf 0.1mm -o out.stl", 2, &["--kerf", "no output has cut lines", ".dxf"]);
    refuses("--cut -o out.stl", 2, &["--cut", "no output has cut lines", ".dxf"]);
    refuses("--carve -o out.dxf", 2, &["--carve", "--sheet 300x200mm"]);
    refuses("--sheet 60x40mm --carve -o out.stl", 2, &["--carve", "out.stl", ".dxf"]);
    refuses("--sheet 41x40mm -o out.dxf", 2, &["--sheet", "40.00 x 20.00 mm", "at least 42.0 x 22.0 mm"]);
    refuses(
        "--curves spline --dxf-version r12 -o out.dxf",
        2,
        &["--dxf-version", "splines", "--curves arcs"],
    );
    room.draw("near.svg", "<path d='M5 5H25V25H5Z M25.1 5H45V25H25.1Z'/>");
    room.refuses("extrude near.svg --kerf 0.15mm -o out.dxf", 3, &["a gap of 0.100 mm", "at (25.05"]);
}

#[test]
fn double_cuts_and_open_paths_of_others_are_found() {
    let room = Room::with(&[]);
    let line = |a: (i32, i32), b: (i32, i32)| {
        format!("0\nLINE\n8\n0\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", a.0, a.1, b.0, b.1)
    };
    let sides = [line((0, 0), (9, 0)), line((9, 0), (9, 9)), line((9, 9), (0, 9)), line((0, 9), (0, 0))];
    let file = |entities: &str| {
        format!(
            "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
        )
    };
    room.write("closed.dxf", &file(&sides.concat()));
    room.succeeds("verify closed.dxf --components 1 --holes 0");
    room.write("open.dxf", &file(&sides[..3].concat()));
    room.write("twice.dxf", &file(&(sides.concat() + &line((1, 0), (5, 0)))));
    for (name, word) in [("open.dxf", "a path is not closed"), ("twice.dxf", "4.000 mm are cut twice")] {
        let finished = room.run(&format!("verify {name}"));
        assert_eq!(finished.code, 4, "{}", finished.stderr);
        assert!(finished.stderr.contains("fault(s)"), "{}", finished.stderr);
        assert!(String::from_utf8_lossy(&finished.stdout).contains(word), "{name}");
    }
}

#[test]
fn strands_much_thinner_than_the_chord_error_can_be_cut() {
    let room = Room::with(&[]);
    // Ink of 0.001 mm: chords of an eighth of the chord error would cross it.
    room.draw(
        "hair.svg",
        "<path fill-rule='evenodd' d='M40 20A10 10 0 0 1 20 20A10 10 0 0 1 40 20ZM39.999 20A9.999 9.999 0 0 1 20.001 20A9.999 9.999 0 0 1 39.999 20Z'/>",
    );
    for options in ["-o hair.dxf", "--curves polyline -o hair.dxf", "--cut -o hair.svg.svg"] {
        room.succeeds(&format!("extrude hair.svg --sheet 60x40mm --carve {options}"));
    }
}

#[test]
fn bays_that_the_beam_does_not_get_into_are_told() {
    let room = Room::with(&[]);
    // A slit of 0.1 mm from the side, and one of 0.4 mm.
    room.draw("slit.svg", "<path d='M5 5H45V12H20V12.1H45V20H20V20.4H45V30H5Z'/>");
    let said = room.succeeds("extrude slit.svg --kerf 0.2mm -o slit.dxf --json");
    assert!(said.stderr.contains("does not get into 1 bay(s)"), "{}", said.stderr);
    let report: Value = serde_json::from_slice(&said.stdout).unwrap();
    let bay = &report["laser"]["filled_bays"][0];
    assert!(
        (number(bay, "area_mm2") - 2.5).abs() < 0.1 && (number(bay, "length_mm") - 25.0).abs() < 0.5,
        "{bay}"
    );
    let said = room.succeeds("extrude slit.svg --kerf 0.08mm -o slit.dxf");
    assert!(!said.stderr.contains("bay"), "{}", said.stderr);
}

#[test]
fn limbs_that_burn_away_are_told() {
    let room = Room::with(&[]);
    // Spikes of 0.1 mm: 1.6 mm long, and 1 mm, on a plate of 40 by 15 mm.
    room.draw("spikes.svg", "<path d='M5 55H45V40H30.1V39H30V40H20.1V38.4H20V40H5Z'/>");
    let said = room.succeeds("extrude spikes.svg --kerf 0.15mm -o spikes.dxf --json");
    assert!(said.stderr.contains("note: 2 limb(s) are narrower than the kerf"), "{}", said.stderr);
    let report: Value = serde_json::from_slice(&said.stdout).unwrap();
    let limb = &report["laser"]["burnt_limbs"][0];
    assert!((number(limb, "length_mm") - 1.65).abs() < 0.15 && number(limb, "width_mm") < 0.11, "{limb}");
    let x = limb["position_mm"][0].as_f64().unwrap();
    assert!((x - 20.05).abs() < 0.1, "{limb}");
    let said = room.succeeds("extrude spikes.svg --kerf 0.08mm -o spikes.dxf");
    assert!(!said.stderr.contains("limb"), "{}", said.stderr);
}

#[test]
fn a_sign_weighs_what_is_left_of_its_plate() {
    let room = Room::with(&[]);
    room.draw("frame.svg", FRAME);
    let made = room.succeeds(
        "extrude frame.svg --thickness 3mm --sheet 60x40mm --carve --material birch-ply -o sign.dxf --json",
    );
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    let quantities = &report["quantities"];
    // The whole plate less the outline of the frame: what the frame goes round falls out.
    let area = 60.0 * 40.0 - 40.0 * 20.0;
    assert!((number(quantities, "area_mm2") - area).abs() < 1e-3, "{quantities}");
    let mass = 3.0 * area * number(quantities, "density_g_cm3") / 1000.0;
    assert!((number(quantities, "mass_g") - mass).abs() < 1e-5, "{quantities}");
    assert_eq!(quantities["box_mm"], serde_json::json!([60.0, 40.0, 3.0]));
}

/// Two slots 3 mm wide with a web of 0.6 mm between them.
const SLOTS: &str = "<path d='M10 10H30V13H10Z M10 13.6H30V16.6H10Z'/>";

#[test]
fn widths_of_a_sign_are_those_of_its_plate() {
    let room = Room::with(&["vine.svg"]);
    room.draw("slots.svg", SLOTS);
    let sign = "extrude slots.svg --sheet 60x40mm --carve";
    let narrow = format!("{sign} --min-feature 1mm -o sign.dxf");
    room.refuses(&narrow, 4, &["ink narrower than 1 mm", "0.600 mm at (", "20.000) mm", "--enforce"]);
    // The slots are wide enough to be ink, and the web to be a gap.
    room.succeeds(&format!("{sign} --min-feature 0.5mm --min-gap 2.9mm -o sign.dxf"));
    room.succeeds("verify sign.dxf --components 1 --holes 2 --min-feature 0.5mm --min-gap 2.9mm");
    assert_eq!(room.run("verify sign.dxf --min-feature 1mm").code, 4);
    room.refuses(&format!("{sign} --min-gap 3.2mm -o wide.dxf"), 4, &["a gap narrower than 3.2 mm"]);
    // What is left around the pattern is a web, too.
    let edge = "extrude slots.svg --sheet 24x30mm --carve --min-feature 0.5mm";
    room.succeeds(&format!("{edge} -o edge.dxf"));
    let wide = edge.replace("0.5mm", "3mm");
    room.refuses(&format!("{wide} --enforce -o out.dxf"), 2, &["--sheet", "needs 3 mm of the sheet"]);
    for kerf in ["", "--kerf 0.2mm --cut -o mended.svg"] {
        let made = room.succeeds(&format!("{narrow} --enforce {kerf} -o mended.png --show thin --json"));
        let report: Value = serde_json::from_slice(&made.stdout).unwrap();
        assert!(number(&report["narrow_places"]["ink"][0], "width_mm") > 1.0 - 1e-3, "{report}");
        let enforced = &report["enforced"];
        assert!(number(enforced, "added_mm2") > 0.0, "{enforced}");
        let after = number(enforced, "area_before_mm2") + number(enforced, "added_mm2")
            - number(enforced, "removed_mm2");
        assert!((number(&report["quantities"], "area_mm2") - after).abs() < 1e-3, "{enforced}");
        if kerf.is_empty() {
            room.succeeds("verify sign.dxf --components 1 --holes 2 --min-feature 1mm");
        }
    }
    let band = "band vine.svg --along line:120mm --width 30mm --components 1 --sheet 140x50mm --carve";
    room.refuses(
        &format!("{band} --min-feature 3mm -o band.dxf"),
        4,
        &["band.dxf", "ink narrower than 3 mm"],
    );
    room.succeeds(&format!("{band} --min-feature 0.2mm --min-gap 0.2mm -o band.dxf --report band.json"));
    let report = room.json("band.json");
    let [web, slot] = ["min_feature", "min_gap"].map(|side| number(&report[side], "width_mm"));
    room.succeeds(&format!(
        "verify band.dxf --min-feature {:.3}mm --min-gap {:.3}mm",
        web - 0.02,
        slot - 0.02
    ));
}

#[test]
fn the_picture_of_a_sign_is_as_asked_for() {
    let room = Room::with(&[]);
    room.draw("slots.svg", SLOTS);
    let sign = "extrude slots.svg --sheet 60x40mm --carve -o sign.png";
    let size = |options: &str| {
        room.succeeds(&format!("{sign} {options}"));
        let bytes = room.read("sign.png");
        (u32::from_be_bytes(bytes[16..20].try_into().unwrap()), bytes)
    };
    let (wide, plain) = size("--pixels 700");
    let (_, marked) = size("--pixels 700 --show thin");
    assert!(wide == 700 && plain != marked);
    let refuses = |options: &str, words: &[&str]| room.refuses(&format!("{sign} {options}"), 2, words);
    refuses("--view iso", &["--view", "--carve", "leave it out"]);
    refuses("--show bridges", &["--show", "cuts away", "--show thin"]);
    refuses("--show seams", &["--show", "seams"]);
    room.refuses("extrude slots.svg -o out.png --show seams", 2, &["--show", "seams", "thin or bridges"]);
}
