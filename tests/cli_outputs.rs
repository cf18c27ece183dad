//! What the program writes, and where: files as promised, and streams that carry only what was asked for.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::process::{Command, Stdio};

use common::Room;
use serde_json::Value;

const BRACELET: &str = "band vine.svg --along circle:65mm --width 14mm --components 1 --closed-pattern";

fn count(value: &Value, name: &str) -> u64 {
    value[name].as_u64().unwrap_or_else(|| panic!("{name} in {value}"))
}

#[test]
fn every_file_has_the_counts_of_the_report() {
    let room = Room::with(&["vine.svg"]);
    let said = room.succeeds(&format!("{BRACELET} -o b.svg -o b.stl -o b.png --report b.json"));
    assert!(said.stdout.is_empty());
    assert!(said.stderr.contains("1 component(s)") && said.stderr.contains("closed all the way round"));
    let report = room.json("b.json");
    let holes = count(&report, "holes");
    assert_eq!((count(&report, "schema_version"), count(&report, "components")), (1, 1));
    assert_eq!((count(&report, "shells"), count(&report, "genus")), (1, holes));
    assert_eq!(report["closed_pattern"], true);
    assert_eq!(report["exemplar"]["sha256"].as_str().unwrap().len(), 64);
    assert_eq!(report["sequence"].as_array().unwrap().len() as u64, count(&report, "pieces_in_result"));
    assert!(report["times"].as_array().unwrap().iter().all(|t| t["milliseconds"].as_f64().unwrap() >= 0.0));

    for file in ["b.svg", "b.stl"] {
        room.succeeds(&format!("verify {file} --components 1 --holes {holes}"));
        for (components, holes) in [(2, holes), (1, holes + 1)] {
            let finished = room.run(&format!("verify {file} --components {components} --holes {holes}"));
            assert_eq!(finished.code, 4, "{}", finished.stderr);
            assert!(finished.stderr.contains(file) && finished.stderr.contains("asked for"));
        }
    }
    let svg: Value = serde_json::from_slice(&room.succeeds("verify b.svg --json").stdout).unwrap();
    assert_eq!((count(&svg, "components"), count(&svg, "holes")), (1, holes));
    assert_eq!(svg["faults"].as_array().unwrap().len(), 0);
    let stl: Value = serde_json::from_slice(&room.succeeds("verify b.stl --json").stdout).unwrap();
    assert_eq!((stl["shells"].as_array().unwrap().len(), count(&stl, "genus")), (1, holes));
    assert_eq!(count(&stl, "triangles"), count(&report, "triangles"));

    let png = room.read("b.png");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(room.run("verify b.png").code, 2);
    assert_eq!(room.contents().len(), 5, "nothing but the exemplar and what was asked for");
}

#[test]
fn the_drawing_is_plain() {
    let room = Room::with(&["strands.svg"]);
    room.succeeds("band strands.svg --along circle:80mm --width 12mm -o ring.svg --report ring.json");
    let (report, text) = (room.json("ring.json"), String::from_utf8(room.read("ring.svg")).unwrap());
    let document = roxmltree::Document::parse(&text).unwrap();
    let root = document.root_element();
    let number = |name: &str, unit: &str| -> f64 {
        let value = root.attribute(name).unwrap();
        value.strip_suffix(unit).unwrap_or_else(|| panic!("{name} is {value}")).parse().unwrap()
    };
    let page = [number("width", "mm"), number("height", "mm")];
    let view_box: Vec<f64> =
        root.attribute("viewBox").unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
    assert_eq!(view_box, [0.0, 0.0, page[0], page[1]]);

    let drawn: Vec<_> = document.descendants().filter(|node| node.has_attribute("d")).collect();
    assert_eq!(drawn.len() as u64, count(&report, "components"));
    let words = ["svg", "title", "desc", "g", "path"];
    assert!(document.descendants().all(|n| !n.is_element() || words.contains(&n.tag_name().name())));
    assert!(document.descendants().all(|n| !n.has_attribute("transform") && !n.has_attribute("style")));

    let mut cubics = 0;
    for path in drawn {
        let d = path.attribute("d").unwrap();
        let strange = d.chars().find(|c| !(c.is_ascii_digit() || "MLCZ .,-".contains(*c)));
        assert_eq!(strange, None, "in {d}");
        assert_eq!(d.matches('M').count(), d.matches('Z').count(), "every contour is closed");
        cubics += d.matches('C').count() as u64;
        let numbers =
            d.split(|c: char| !c.is_ascii_digit() && c != '.' && c != '-').filter(|n| !n.is_empty());
        assert!(
            numbers.map(|n| n.parse::<f64>().unwrap()).all(|n| (0.0..=page[0].max(page[1])).contains(&n))
        );
    }
    assert_eq!(report["svg_segments"][1].as_u64(), Some(cubics));
    assert!(4 * cubics < count(&report, "vertices"), "{cubics} cubics are more than smooth runs need");
}

#[test]
fn the_solid_is_a_binary_stl() {
    let room = Room::with(&["chain.svg"]);
    let made = room.succeeds("extrude chain.svg --thickness 0.3cm -o chain.stl --json");
    let made: Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!((count(&made, "components"), count(&made, "holes")), (1, 15));
    assert_eq!((count(&made["solid"], "genus"), &made["thickness_mm"]), (15, &Value::from(3.0)));
    let stl = room.read("chain.stl");
    assert!(!stl.starts_with(b"solid"), "an ASCII file would begin so");
    let facets = u32::from_le_bytes(stl[80..84].try_into().unwrap());
    assert_eq!(stl.len(), 84 + 50 * facets as usize);
    assert_eq!(u64::from(facets), count(&made["solid"], "triangles"));
    room.succeeds("verify chain.stl --components 1 --holes 15");
    assert_eq!(room.succeeds("extrude chain.svg --thickness 3mm -o - --quiet").stdout, stl);
}

#[test]
fn standard_output_carries_what_was_asked_for() {
    let room = Room::with(&["vine.svg"]);
    let band = "band vine.svg --along line:120mm";
    room.succeeds(&format!("{band} -o band.svg"));
    let drawing = room.succeeds(&format!("{band} -o -"));
    assert_eq!(drawing.stdout, room.read("band.svg"));
    assert!(drawing.stderr.contains("component(s)"));
    let report = room.succeeds(&format!("{band} -o band.svg --report -"));
    let report: Value = serde_json::from_slice(&report.stdout).unwrap();
    assert_eq!(report["files"], Value::from(vec!["band.svg"]));
    let quiet = room.succeeds(&format!("{band} -o band.svg --report band.json --quiet"));
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{}", quiet.stderr);
    let quiet = room.succeeds("extrude vine.svg -o vine.stl --quiet");
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{}", quiet.stderr);
    let pieces = room.succeeds("analyze vine.svg --json");
    assert!(serde_json::from_slice::<Value>(&pieces.stdout).unwrap().is_object());
    assert!(pieces.stderr.is_empty(), "{}", pieces.stderr);
}

#[test]
fn a_drawing_is_bridged_to_a_stencil_and_a_picture() {
    let room = Room::with(&["leaves.svg"]);
    let extrude = "extrude leaves.svg --bridge 1mm --components 1 --holes 0";
    let made = room.succeeds(&format!("{extrude} -o s.svg -o s.png -o s.stl --json"));
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    room.succeeds("verify s.svg --components 1 --holes 0");
    room.succeeds("verify s.stl --components 1 --holes 0");
    assert_eq!(report["files"], Value::from(vec!["s.svg", "s.png", "s.stl"]));
    assert_eq!((count(&report["drawing"], "components"), count(&report["solid"], "genus")), (1, 0));
    let bridges = report["bridges"]["bridges"].as_array().unwrap().len();
    assert!(made.stderr.contains(&format!("{bridges} bridge(s): ")), "{}", made.stderr);
    assert!(room.read("s.png").starts_with(b"\x89PNG"));
    // Struts are orange: without bridges the picture has no such pixel, and so it is another one.
    room.succeeds("extrude leaves.svg -o plain.svg -o plain.png");
    assert_ne!(room.read("plain.png"), room.read("s.png"));
    let pages = ["plain.svg", "s.svg"].map(|name| {
        let text = String::from_utf8(room.read(name)).unwrap();
        text.split("viewBox=").nth(1).unwrap().split('>').next().unwrap().to_owned()
    });
    assert_eq!(pages[0], pages[1], "both lie on the page of the drawing");
    room.refuses("extrude leaves.svg -o s.pdf", 2, &[".svg"]);
}

#[test]
fn the_same_exemplar_in_another_folder_gives_the_same_bytes() {
    let room = Room::with(&["vine.svg"]);
    let path = room.path("vine.svg");
    room.succeeds("band vine.svg --along line:60mm -o a.svg");
    room.succeeds(&format!("band {} --along line:60mm -o b.svg", path.display()));
    assert_eq!(room.read("a.svg"), room.read("b.svg"));
    assert!(String::from_utf8(room.read("a.svg")).unwrap().contains(" of vine.svg</desc>"));
}

#[test]
fn what_looks_wrong_is_said_and_nothing_else() {
    let room = Room::with(&["vine.svg", "leaves.svg"]);
    let far = room.succeeds("band leaves.svg --along line:120mm --components 1 --holes 0 -o f.svg").stderr;
    assert!(far.contains("\nwarning: the band has ") && far.contains(" jumps in "), "{far}");
    let wide = room.succeeds("band vine.svg --along circle:65mm --width 69mm -o w.svg").stderr;
    assert!(wide.contains("\nwarning: at (") && wide.contains("15 % of the length of its middle"), "{wide}");
    let fine = room.succeeds("band vine.svg --along circle:65mm --width 14mm -o w.svg").stderr;
    assert!(!fine.contains("warning"), "{fine}");
    // No progress where there is no terminal.
    assert!(!fine.contains('\r') && !fine.contains('\u{1b}'), "{fine:?}");
}

#[test]
fn ranges_are_verified_as_they_are_asked_for() {
    let room = Room::with(&["vine.svg"]);
    room.succeeds("verify vine.svg --components 1..2 --holes any");
    let missed = room.run("verify vine.svg --components 3..5");
    assert!(missed.code == 4 && missed.stderr.contains("3..5 were asked for"), "{}", missed.stderr);
    for command in ["verify vine.svg", "band vine.svg --along line:60mm -o x.svg"] {
        let wrong = room.run(&format!("{command} --components 5..2"));
        assert!(wrong.code == 2 && wrong.stderr.contains("ends before it begins"), "{}", wrong.stderr);
    }
}

#[test]
fn rows_of_an_analysis_are_for_those_who_want_them() {
    let room = Room::with(&["vine.svg"]);
    let lines = |arguments: &str| {
        let said = room.succeeds(&format!("analyze vine.svg {arguments}")).stdout;
        String::from_utf8(said).unwrap().lines().count()
    };
    let rows = lines("");
    assert!(rows > 80, "{rows}");
    assert!(lines("-o cuts.svg") < 12);
    assert_eq!(lines("-o cuts.svg --table"), rows);
}

#[test]
fn a_reader_that_has_had_enough_is_no_failure() {
    let room = Room::with(&["vine.svg"]);
    let commands = [
        "band vine.svg --along line:120mm -o - --report r.json",
        "extrude vine.svg -o -",
        "analyze vine.svg",
        "verify vine.svg --json",
        "--help",
    ];
    for arguments in commands {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("openwork"));
        command.current_dir(room.path("")).args(arguments.split(' '));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Nobody listens, neither to the results nor to the messages.
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments}");
    }
    assert!(room.path("r.json").exists(), "the other outputs are written nevertheless");
}

#[test]
fn the_help_teaches() {
    let room = Room::with(&[]);
    let band = String::from_utf8(room.succeeds("band --help").stdout).unwrap();
    for word in ["middle line", "rubble", "persistence", "looks chopped"] {
        assert!(band.contains(word), "{word}: {band}");
    }
    let rect = String::from_utf8(room.succeeds("rect --help").stdout).unwrap();
    assert!(rect.contains("upside"), "{rect}");
    let overview = String::from_utf8(room.succeeds("--help").stdout).unwrap();
    for command in ["band", "analyze", "extrude", "verify"] {
        assert!(overview.contains(command), "{overview}");
        let help = String::from_utf8(room.succeeds(&format!("{command} --help")).stdout).unwrap();
        for word in ["mm, cm, in, pt or px", "Example", &format!("openwork {command} "), "--min"] {
            assert!(help.contains(word) || (word == "--min" && command == "extrude"), "{word}: {help}");
        }
        assert!(help.lines().all(|line| line.chars().count() <= 120), "{help}");
    }
}
