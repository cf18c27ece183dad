//! Bad input ends with a message that names the place and the remedy, and without a file; untidy input works.

mod common;

use std::fmt::Write as _;

use common::{Finished, Room};

#[test]
fn a_file_that_is_no_drawing() {
    let room = Room::with(&[]);
    room.write("empty.svg", "");
    room.write("words.svg", "An ornament, in words.");
    room.write("page.svg", "<html><body/></html>");
    let refuses = |file: &str, words: &[&str]| {
        for job in ["band FILE --along line:60mm -o out.svg", "extrude FILE -o out.stl"] {
            room.refuses(&job.replace("FILE", file), 2, words);
        }
    };
    refuses("nowhere.svg", &["nowhere.svg", "no such file", "check the path"]);
    refuses("empty.svg", &["empty.svg", "is empty", "an SVG drawing is wanted"]);
    refuses("words.svg", &["words.svg", "not well-formed XML", "1:1"]);
    refuses("page.svg", &["page.svg", "its root is <html>", "an SVG drawing is wanted"]);
    room.refuses("verify nowhere.svg", 2, &["nowhere.svg", "No such file"]);
    room.refuses("verify words.svg", 2, &["words.svg", "XML"]);
    room.refuses("analyze nowhere.svg --json", 2, &["nowhere.svg", "no such file"]);
}

#[test]
fn a_drawing_without_ink() {
    let room = Room::with(&[]);
    room.draw("blank.svg", "");
    room.draw("unfilled.svg", "<path d='M0 0 H50 V20 Z' fill='none'/>");
    room.draw("line.svg", "<path id='hair' d='M0 0 L50 20'/>");
    let refuses = |file: &str, words: &[&str]| {
        room.refuses(&format!("band {file} --along line:60mm -o out.svg"), 2, words);
    };
    refuses("blank.svg", &["blank.svg", "no visible shapes", "filled or stroked paths"]);
    refuses("unfilled.svg", &["unfilled.svg", "no filled area", "give the shapes a fill"]);
    refuses("line.svg", &["<path id=\"hair\"> on line 2", "encloses no area", "give it a stroke"]);
}

#[test]
fn a_coordinate_that_is_no_place() {
    let room = Room::with(&[]);
    room.draw("nan.svg", "<path id='leaf' d='M0 0 L10 10 L NaN 20 Z'/>");
    room.draw("far.svg", "\n<path id='leaf' d='M0 0 L10 10 L 1e30 20 Z'/>");
    let refuses = |file: &str, words: &[&str]| {
        room.refuses(&format!("band {file} --along line:60mm -o out.svg"), 2, words);
    };
    refuses(
        "nan.svg",
        &["<path id=\"leaf\"> on line 2", "beyond segment 2", "NaN", "correct the d attribute"],
    );
    refuses(
        "far.svg",
        &["<path id=\"leaf\"> on line 3", "1e30 is out of range", "1e9", "correct the element"],
    );
}

/// A rail with two eyes, drawn tidily.
const RAIL: &str = "M0 5 H60 V15 H0 Z";
const EYES: &str = "M10 10 L20 13 L30 10 L20 7 Z M35 10 L45 13 L55 10 L45 7 Z";

/// The band that a drawing gives, and its components and holes.
fn band_of(body: &str) -> (Vec<u8>, [u64; 2]) {
    let room = Room::with(&[]);
    room.draw("motif.svg", body);
    room.succeeds("band motif.svg --along line:60mm --components 1 -o band.svg --report band.json");
    let report = room.json("band.json");
    (room.read("band.svg"), ["components", "holes"].map(|name| report[name].as_u64().unwrap()))
}

#[test]
fn duplicates_fill_rules_and_windings_do_not_matter() {
    let (tidy, counts) = band_of(&format!("<path fill-rule='evenodd' d='{RAIL} {EYES}'/>"));
    assert_eq!(counts, [1, 2]);
    // With nonzero winding, the eyes are holes where they run against the rail.
    let backwards = "M10 10 L20 7 L30 10 L20 13 Z M35 10 L45 7 L55 10 L45 13 Z";
    let opposite = [EYES, backwards].map(|eyes| band_of(&format!("<path d='{RAIL} {eyes}'/>")));
    assert_eq!(opposite.iter().filter(|band| **band == (tidy.clone(), [1, 2])).count(), 1);
    assert_eq!(opposite.iter().filter(|(_, counts)| *counts == [1, 0]).count(), 1);
    let element = format!("<path fill-rule='evenodd' d='{RAIL} {EYES}'/>");
    assert_eq!(band_of(&element.repeat(3)), (tidy, [1, 2]));
}

#[test]
fn self_crossing_contours_are_united() {
    // One contour that crosses itself twice: a rail and a tab across it.
    let (_, counts) = band_of("<path d='M0 5 H60 V15 H20 V0 H40 V15 H0 Z'/>");
    assert_eq!(counts, [1, 0]);
    // A pentagram as one contour: whole under one rule, with a hole in the middle under the other, its five tips
    // holding together by strips.
    let star = "M30 1 L48 57 L1 22 L59 22 L12 57 Z";
    assert_eq!(band_of(&format!("<path d='{star}'/>")).1, [1, 0]);
    let inked = format!("<path fill-rule='evenodd' stroke='black' d='{star}'/>");
    assert_eq!(band_of(&inked).1, [1, 1]);
}

/// A strip that waves, as one path of `segments` segments.
fn wavy_strip(segments: usize) -> String {
    let half = segments / 2;
    let mut d = String::from("<path d='M");
    for (top, i) in (0..half).map(|i| (20.0, i)).chain((0..half).rev().map(|i| (26.0, i))) {
        let x = 100.0 * i as f64 / (half - 1) as f64;
        write!(d, "{x:.4} {:.4} ", top + 2.0 * (x / 4.0).sin()).unwrap();
    }
    d + "Z'/>"
}

#[test]
fn a_path_of_200000_segments_in_bounded_memory() {
    let room = Room::with(&[]);
    room.draw("wave.svg", &wavy_strip(200_000));
    let arguments = "band wave.svg --along line:100mm --components 1 --holes 0 -o wave-band.svg";
    let finished = if cfg!(target_os = "linux") {
        // A process that wants more than 2 GiB of addresses fails here.
        let program = assert_cmd::cargo::cargo_bin("openwork");
        let limited = format!("ulimit -v 2097152 && exec {} {arguments}", program.display());
        let mut shell = assert_cmd::Command::new("sh");
        Finished::of(shell.current_dir(room.path("")).args(["-c", &limited]))
    } else {
        room.run(arguments)
    };
    assert_eq!(finished.code, 0, "{}", finished.stderr);
    // A strip that waves takes a few curves to draw, however it came in.
    assert!(room.read("wave-band.svg").len() < 100_000);
}

#[test]
fn a_curve_that_carries_nothing() {
    let room = Room::with(&["vine.svg"]);
    room.draw(
        "curves.svg",
        "<g fill='none' stroke='black'><path id='point' d='M5 5 L5 5'/><path id='two' d='M0 0 H9 M0 5 H9'/></g>",
    );
    let refuses = |along: &str, words: &[&str]| {
        room.refuses(&format!("band vine.svg --along {along} -o out.svg"), 2, words);
    };
    refuses("line:0mm", &["--along", "the length is 0 mm", "more than 0", "line:120mm"]);
    refuses("circle:-65mm", &["--along", "the diameter is -65 mm", "circle:65mm"]);
    refuses("line:NaN", &["--along", "'NaN' is not a length", "120mm"]);
    refuses("line:12parsec", &["--along", "'parsec'", "mm, cm, in, pt, px"]);
    refuses("square:5mm", &["--along", "names no curve", "circle:DIAMETER"]);
    refuses("path:curves.svg#point", &["0 mm long", "at least 0.1 mm"]);
    refuses("path:curves.svg#two", &["2 subpaths"]);
    refuses("path:curves.svg#three", &["curves.svg", "no element with the id \"three\"", "point, two"]);
    refuses("path:curves.svg", &["curves.svg", "holds 2 paths", "add #id", "point, two"]);
    refuses("path:nowhere.svg", &["nowhere.svg", "no such file"]);
}

#[test]
fn a_number_out_of_range() {
    let room = Room::with(&["vine.svg"]);
    let refuses = |option: &str, words: &[&str]| {
        room.refuses(&format!("band vine.svg --along line:120mm -o out.svg {option}"), 2, words);
    };
    refuses("--width 0", &["--width", "0 is out of range", "from 0.5 to 10000 mm"]);
    refuses("--width -3mm", &["--width", "-3 is out of range", "from 0.5 to 10000 mm"]);
    refuses("--width NaN", &["--width", "'NaN' is not a length", "120mm"]);
    refuses("--width inf", &["--width", "'inf' is not a length"]);
    refuses("--width 3furlong", &["--width", "'furlong'", "mm, cm, in, pt, px"]);
    refuses("--thickness 0", &["--thickness", "0 is out of range"]);
    refuses("--thickness -2mm", &["--thickness", "-2 is out of range"]);
    refuses("--thickness NaNmm", &["--thickness", "'NaNmm' is not a length"]);
    refuses("--chord 0", &["chord", "0 mm", "from 0.0001 to 1"]);
    refuses("--min-feature -1mm", &["min-feature", "-1 mm", "from 0"]);
    refuses("--min-gap nan", &["--min-gap", "'nan' is not a length"]);
    refuses("--components 0", &["--components", "0 components is no band", "1 or more"]);
    refuses("--components -1", &["--components", "-1"]);
    refuses("--holes 1.5", &["--holes", "1.5"]);
    refuses("--alpha 2", &["alpha", "is 2", "from 0 to 1"]);
    refuses("--jump-cost NaN", &["jump-cost", "NaN", "from 0"]);
    refuses("--variety -1", &["--variety", "-1 is out of range", "from 0"]);
    refuses("--slicing uniform:0", &["--slicing", "'0'", "uniform:T"]);
    refuses("--slicing reeb:-1mm", &["persistence", "-1", "from 0 to the width"]);
    room.refuses("extrude vine.svg --thickness 0 -o out.stl", 2, &["thickness", "0"]);
    room.refuses("verify vine.svg --min-gap -1", 2, &["min-gap", "-1"]);
}

#[test]
fn options_that_contradict_each_other() {
    let room = Room::with(&["vine.svg"]);
    room.refuses(
        "band vine.svg --along line:120mm --closed-pattern -o out.svg",
        2,
        &["--closed-pattern", "line:120mm is an open curve", "circle:65mm"],
    );
    room.refuses(
        "band vine.svg --along circle:65mm --width 14mm --closed-pattern --holes 0 -o out.svg",
        2,
        &["--closed-pattern", "has a hole, its inside", "--holes 1 or more"],
    );
}

#[test]
fn an_output_that_cannot_be_a_file() {
    let room = Room::with(&["vine.svg"]);
    std::fs::create_dir(room.path("folder.svg")).unwrap();
    let refuses = |outputs: &str, words: &[&str]| {
        room.refuses(&format!("band vine.svg --along line:120mm {outputs}"), 2, words);
    };
    refuses("-o no/out.svg", &["cannot write no/out.svg", "No such file", "make the directory first"]);
    refuses("-o out.svg --report no/out.json", &["cannot write no/out.json", "make the directory first"]);
    refuses("-o folder.svg", &["cannot write folder.svg", "not a file", "give a file name"]);
    refuses("-o vine.svg/out.svg", &["cannot write vine.svg/out.svg", "give another directory"]);
    refuses("-o out.pdf", &["--output", "out.pdf", ".svg, .dxf, .stl, .3mf, .obj or .png"]);
    refuses("-o out", &["--output", "out does not say a format", ".svg, .dxf, .stl, .3mf, .obj or .png"]);
    refuses("", &["--output <FILE>"]);
    room.refuses("extrude vine.svg -o out.pdf", 2, &["--output", "out.pdf does not say a format", ".stl"]);
    room.refuses(
        "extrude vine.svg -o no/out.stl",
        2,
        &["cannot write no/out.stl", "make the directory first"],
    );
    room.refuses("analyze vine.svg -o out.stl", 2, &["--output", "out.stl", ".svg or .png"]);
}

#[test]
fn solids_that_no_printer_makes() {
    let room = Room::with(&[]);
    room.draw("bars.svg", "<path d='M10 10H110V14H10Z M10 14H14V30H10Z'/>");
    let refuses = |options: &str, code: i32, words: &[&str]| {
        room.refuses(&format!("extrude bars.svg --thickness 3mm {options} -o out.3mf"), code, words);
    };
    refuses("--chamfer 1.5mm", 2, &["the chamfer is 1.5 mm", "less than half of the thickness of 3 mm"]);
    refuses("--chamfer -1mm", 2, &["the chamfer is -1 mm"]);
    refuses("--taper 60", 2, &["the taper is 60 degrees", "less than 45"]);
    refuses("--taper 40", 3, &["too narrow for walls that go in by 2.517 mm", "a taper of 37.", "does"]);
    refuses("--max-triangles 3", 2, &["at most 3 are allowed", "no chord error does"]);
    refuses(
        "--bed 50x50mm",
        2,
        &["100.00 x 20.00 x 3.00 mm", "does not fit a bed of 50 x 50 mm", "larger bed"],
    );
    refuses(
        "--bed 220x220x2mm",
        2,
        &["3.00 mm high, and the bed of 220 x 220 x 2 mm has room for 2 mm", "thinner"],
    );
    refuses("--bed 220", 2, &["--bed", "give a bed as 220x220mm"]);
    refuses("--place", 2, &["--bed"]);
}

#[test]
fn an_output_that_is_named_twice_or_is_an_input() {
    let room = Room::with(&["vine.svg"]);
    room.draw("curve.svg", "<path d='M0 30 H120' fill='none' stroke='black'/>");
    std::fs::create_dir(room.path("sub")).unwrap();
    let refuses = |outputs: &str, words: &[&str]| {
        room.refuses(&format!("band vine.svg --along path:curve.svg {outputs}"), 2, words);
    };
    let own = "every output needs a name of its own";
    refuses("-o a.svg -o a.svg", &["a.svg is given twice", own]);
    refuses("-o a.svg -o ./a.svg", &["./a.svg is given twice", own]);
    refuses("-o a.svg -o sub/../a.svg", &["sub/../a.svg is given twice", own]);
    refuses("-o a.svg --report a.svg", &["a.svg is given twice", own]);
    refuses("-o - --report -", &["standard output is given twice", own]);
    refuses("-o ./vine.svg", &["./vine.svg is an input", "overwritten", own]);
    refuses("-o curve.svg", &["curve.svg is an input", "overwritten", own]);
    room.refuses("extrude vine.svg -o - --json", 2, &["--json", "standard output", "leave out --json"]);
    room.refuses("analyze vine.svg -o - --json", 2, &["--json", "standard output", "leave out --json"]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_to() {
    use std::os::unix::fs::PermissionsExt;
    let room = Room::with(&["vine.svg"]);
    let locked = room.path("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    // For root, no folder is locked: then another one that not even root can write to does.
    let is_root = std::fs::write(locked.join("probe"), "").is_ok();
    let folder = if is_root { "/proc/self" } else { "locked" };
    if !is_root || cfg!(target_os = "linux") {
        let arguments = format!("band vine.svg --along line:120mm -o {folder}/out.svg");
        room.refuses(&arguments, 2, &["cannot write", "out.svg", "directory"]);
    }
}

#[test]
fn a_band_that_folds_or_meets_itself() {
    let room = Room::with(&["vine.svg"]);
    room.draw(
        "curves.svg",
        "<g fill='none' stroke='black'>\
         <path id='eight' d='M60 30 C120 -30 120 90 60 30 C0 -30 0 90 60 30 Z'/>\
         <path id='corner' d='M10 10 H80 V50'/></g>",
    );
    let refuses = |options: &str, words: &[&str]| {
        room.refuses(&format!("band vine.svg -o out.svg {options}"), 2, words);
    };
    refuses("--along circle:5mm", &["folds at (", "radius of 2.500 mm", "narrower --width"]);
    // The paths cross in the middle of the page; the edges of the band meet first, a little before.
    refuses(
        "--along path:curves.svg#eight --width 0.5",
        &["meets itself at (", "along the curve", "--width"],
    );
    refuses(
        "--along path:curves.svg#corner --width 6",
        &["corner of -90.0 degrees at (80.000, 50.000) mm", "70.000 mm along it", "--round RADIUS"],
    );
    refuses("--along path:curves.svg#corner --width 6 --round 45mm", &["45 mm", "smaller radius"]);
    refuses(
        "--along path:curves.svg#corner --width 6 --round 0",
        &["rounding corners is 0 mm", "more than 0"],
    );
    room.succeeds("band vine.svg --along path:curves.svg#corner --width 6 --round 8mm -o out.svg --quiet");
}

#[test]
fn constraints_that_cannot_be_met() {
    let room = Room::with(&["vine.svg", "strands.svg"]);
    let refuses = |options: &str, words: &[&str]| {
        room.refuses(&format!("band {options} -o out.svg -o out.stl --report out.json"), 3, words);
    };
    refuses("vine.svg --along line:1mm", &["curve's 1.0 mm", "the shortest that can be made is", "--width"]);
    refuses(
        "strands.svg --along line:120mm --components 1",
        &[
            "has 1 component(s)",
            "keeps all its strands together",
            "the nearest that can be had is --components 3",
        ],
    );
    refuses(
        "strands.svg --along line:120mm --components 3 --holes 1",
        &["has 1 hole(s)", "the nearest that can be had is --holes 0"],
    );
    refuses(
        "vine.svg --along line:120mm --min-feature 20mm",
        &["--min-feature 20 mm", "at x = ", "--width", "lower --min-feature"],
    );
}

#[test]
fn a_result_that_the_machine_cannot_make() {
    let room = Room::with(&["vine.svg"]);
    // What stood there before stays.
    room.write("out.svg", "an older drawing");
    let refuses = |option: &str, words: &[&str]| {
        let outputs = "-o out.svg -o out.stl -o out.png --report out.json";
        room.refuses(&format!("band vine.svg --along line:120mm --width 8mm {outputs} {option}"), 4, words);
    };
    let (place, end) = (" mm at (", "Nothing was written");
    refuses(
        "--min-feature 0.5mm",
        &["ink narrower than 0.5 mm", place, "--width", "a smaller --min-feature", end],
    );
    refuses("--min-gap 0.5mm", &["a gap narrower than 0.5 mm", place, "--width", "a smaller --min-gap", end]);
}
