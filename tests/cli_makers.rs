//! What a maker asks for on the command line: files for printers, pictures, many bands to choose from, engraving, presets,
//! and what the program tells of itself.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::collections::BTreeSet;

use common::Room;
use resvg::tiny_skia::Pixmap;
use serde_json::Value;

const BORDER: &str = "band vine.svg --along line:120mm --width 16mm --components 1";

/// How many pixels of a PNG have exactly this colour.
fn pixels(png: &[u8], [r, g, b]: [u8; 3]) -> usize {
    let picture = Pixmap::decode_png(png).unwrap();
    picture.pixels().iter().filter(|p| [p.red(), p.green(), p.blue()] == [r, g, b]).count()
}

#[test]
fn files_for_printers_hold_what_was_asked_for() {
    let room = Room::with(&["vine.svg"]);
    room.succeeds(&format!("{BORDER} --chamfer 0.3mm -o b.3mf -o b.obj -o b.stl --report b.json"));
    let report = room.json("b.json");
    let holes = report["holes"].as_u64().unwrap();
    for file in ["b.3mf", "b.obj", "b.stl"] {
        let found = room.succeeds(&format!("verify {file} --components 1 --holes {holes} --json"));
        let found: Value = serde_json::from_slice(&found.stdout).unwrap();
        assert_eq!(found["triangles"], report["triangles"], "{file}");
        assert_eq!(room.run(&format!("verify {file} --components 2")).code, 4, "{file}");
        room.succeeds(&format!("verify --certificate b.json {file}"));
    }
    assert!(room.read("b.3mf").starts_with(b"PK"));
    let obj = String::from_utf8(room.read("b.obj")).unwrap();
    let facets = obj.lines().filter(|line| line.starts_with("f ")).count() as u64;
    assert_eq!(report["triangles"].as_u64(), Some(facets));
}

#[test]
fn pictures_show_the_solid_or_mark_what_is_thin() {
    let room = Room::with(&["vine.svg"]);
    let picture = |name: &str, options: &str| {
        room.succeeds(&format!("{BORDER} --pixels 1200 {options} -o {name}"));
        room.read(name)
    };
    const RING: [u8; 3] = [0xd6, 0x28, 0x39];
    const SEAM: [u8; 3] = [0x5b, 0xa7, 0xe0];
    let plain = picture("plain.png", "");
    assert_eq!((pixels(&plain, RING), pixels(&plain, SEAM)), (0, 0));
    let marked = picture("marked.png", "--show thin");
    assert!(pixels(&marked, RING) > 200 && pixels(&marked, SEAM) == 0, "{}", pixels(&marked, RING));
    let both = picture("both.png", "--show seams,thin");
    assert!(pixels(&both, RING) > 200 && pixels(&both, SEAM) > 200);

    let iso = picture("iso.png", "--view iso");
    let size = |png: &[u8]| Pixmap::decode_png(png).map(|p| (p.width(), p.height())).unwrap();
    assert_eq!(size(&iso).0.max(size(&iso).1), 1200);
    assert_ne!(picture("top.png", "--view top"), iso);
    // Of the ink of flat drawings nothing is left.
    assert!(pixels(&plain, [0x22, 0x30, 0x4f]) > 10_000);
    assert_eq!(pixels(&iso, [0x22, 0x30, 0x4f]), 0);
    room.refuses(&format!("{BORDER} --view iso -o x.svg"), 2, &["--view", "no output is a picture"]);
    room.refuses(&format!("{BORDER} --view back -o x.png"), 2, &["back", "iso"]);
    room.refuses(&format!("{BORDER} --show thick -o x.png"), 2, &["thick", "seams, thin or bridges"]);
}

#[test]
fn numbered_bands_have_a_contact_sheet() {
    let room = Room::with(&["vine.svg"]);
    let said = room.succeeds(&format!("{BORDER} --count 3 --seed 7 -o vine.v2.svg --report r.json")).stderr;
    assert_eq!(said.matches("wrote vine.v2-sheet.png").count(), 1, "{said}");
    let names: BTreeSet<String> = room.contents().into_keys().collect();
    let wanted = ["r-01.json", "r-02.json", "r-03.json", "vine.svg", "vine.v2-sheet.png"];
    let bands = ["vine.v2-01.svg", "vine.v2-02.svg", "vine.v2-03.svg"];
    assert_eq!(names, wanted.into_iter().chain(bands).map(str::to_owned).collect());
    assert_eq!(room.json("r-02.json")["contact_sheet"], "vine.v2-sheet.png");
    let sheet = room.read("vine.v2-sheet.png");
    let picture = Pixmap::decode_png(&sheet).unwrap();
    assert_eq!(picture.width().max(picture.height()), 2400);
    // As much ink as three bands have at this scale: none is missing or cut off.
    let area_mm2: f64 = ["r-01.json", "r-02.json", "r-03.json"]
        .map(|report| room.json(report)["area_mm2"].as_f64().unwrap())
        .iter()
        .sum();
    let ink = pixels(&sheet, [0x22, 0x30, 0x4f]) as f64;
    let page_mm = room.json("r-01.json")["page_mm"][0].as_f64().unwrap();
    let least_scale = f64::from(picture.width()) / (3.3 * page_mm);
    assert!(ink > 0.8 * area_mm2 * least_scale * least_scale, "{ink} pixels of ink");

    room.succeeds(&format!("{BORDER} --count 3 --seed 7 -o again.svg"));
    assert_eq!(room.read("again-sheet.png"), sheet, "the same bytes");
    room.succeeds(&format!("{BORDER} --best 2 --no-sheet -o best.svg --report s.json"));
    assert!(!room.path("best-sheet.png").exists());
    assert_eq!(room.json("s-01.json")["contact_sheet"], Value::Null);
    // Bridges are seen on it.
    let bridged = "band vine.svg --along line:60mm --components 1 --holes 0 --bridge 1mm";
    room.succeeds(&format!("{bridged} --count 2 -o stencil.svg --report t.json"));
    let laid = room.json("t-01.json")["bridges"]["bridges"].as_array().map_or(0, Vec::len);
    let coloured =
        [[0xe4, 0x6a, 0x24], [0x2c, 0xa8, 0x8d]].map(|c| pixels(&room.read("stencil-sheet.png"), c));
    assert!(laid > 0 && coloured.iter().sum::<usize>() > 100, "{laid} bridges, {coloured:?}");
}

#[test]
fn a_sheet_that_cannot_be_written_is_known_before_the_search() {
    let room = Room::with(&["vine.svg"]);
    std::fs::create_dir(room.path("a-sheet.png")).unwrap();
    room.refuses(&format!("{BORDER} --count 2 -o a.svg"), 2, &["a-sheet.png", "not a file"]);
    room.succeeds(&format!("{BORDER} --count 2 --no-contact-sheet -o a.svg"));
}

/// A plate of 40 by 20 mm with a window.
const PLATE: &str = "<path fill-rule='evenodd' d='M5 5H45V25H5Z M15 10H35V20H15Z'/>";

#[test]
fn a_drawing_is_engraved_in_the_colours_of_the_process() {
    let room = Room::with(&[]);
    room.draw("plate.svg", PLATE);
    room.draw("name.svg", "<rect x='7' y='8' width='5' height='14'/><circle cx='40' cy='15' r='2'/>");
    room.write(
        "p.toml",
        "[process.mine]\nlike = \"laser-ply-3mm\"\ncut_colour = \"#0000f0\"\nengrave_colour = \"#00ff00\"\n",
    );
    // On a sheet the drawing lies on the sheet's page: the part moves by 25 mm to the right and 15 mm down to its middle.
    room.write(
        "laid.svg",
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60'>\
         <rect x='32' y='23' width='5' height='14'/><circle cx='65' cy='30' r='2'/></svg>",
    );
    let alone = "extrude plate.svg --processes p.toml --process mine --engrave name.svg";
    let laid = "extrude plate.svg --processes p.toml --process mine --engrave laid.svg --sheet 100x60mm";
    for (mine, name) in [(alone, "name.svg"), (laid, "laid.svg")] {
        let said = room.succeeds(&format!("{mine} --cut -o p.dxf -o p.svg --json"));
        assert!(said.stderr.contains("engraves 50.6 mm"), "{}", said.stderr);
        let laser = &serde_json::from_slice::<Value>(&said.stdout).unwrap()["laser"];
        assert_eq!(laser["engraved"]["file"], name);
        for file in ["p.dxf", "p.svg"] {
            let found = room.succeeds(&format!("verify {file} --components 1 --holes 1 --json"));
            let found: Value = serde_json::from_slice(&found.stdout).unwrap();
            assert_eq!(found["pierces"], 2, "{file}: what is engraved or shown is not cut");
            let layers = found["layers"].as_array().unwrap();
            let engraved = layers.iter().find(|layer| layer["name"] == "ENGRAVE").unwrap();
            let length_mm = engraved["length_mm"].as_f64().unwrap();
            assert!((length_mm - (38.0 + 4.0 * std::f64::consts::PI)).abs() < 0.02, "{file}: {length_mm}");
            assert_eq!((&engraved["paths"], &engraved["is_cut"]), (&Value::from(2), &Value::from(false)));
        }
    }
    let svg = String::from_utf8(room.read("p.svg")).unwrap();
    let at = |words: &str| svg.find(words).unwrap_or_else(|| panic!("{words} is not in {svg}"));
    let engrave = at("<g id=\"ENGRAVE\" fill=\"none\" stroke=\"#00ff00\"");
    assert!(
        engrave < at("<g id=\"CUT\" fill=\"none\" stroke=\"#0000f0\"") && at("<g id=\"SHEET\"") > engrave
    );
    let dxf = String::from_utf8(room.read("p.dxf")).unwrap();
    // The nearest of the index is blue, and the exact colour stands beside it.
    assert!(
        dxf.contains("2\nCUT\n70\n0\n62\n5\n420\n240\n") && dxf.contains("2\nENGRAVE\n70\n0\n62\n3\n6\n")
    );
    assert!(svg.contains("M32 37L37 37"), "{svg}");

    room.draw("wide.svg", "<rect x='7' y='8' width='10' height='4'/>");
    let wide = alone.replace("name.svg", "wide.svg");
    room.refuses(&format!("{wide} -o q.dxf"), 2, &["--engrave", "wide.svg", "no material", "at (15.0", "mm"]);
    room.refuses(&format!("{alone} -o q.stl"), 2, &["--engrave", "no output has cut lines"]);
    // A picture shows it on the part, wherever that lies on its plate.
    for options in [&format!("{alone} -o q.png"), &format!("{laid} -o q.dxf -o q.png")] {
        room.succeeds(options);
        assert!(pixels(&room.read("q.png"), [0xf2, 0xc1, 0x4e]) > 500, "{options}");
    }
    room.refuses(&format!("{alone} --cut -o name.svg"), 2, &["name.svg", "is an input"]);
    room.refuses(&format!("{alone} --sheet 100x60mm -o q.dxf"), 2, &["--engrave", "no material", "--sheet"]);
    // A sign has its name beside the pattern, where the part has no page.
    room.refuses(&format!("{laid} --carve -o q.dxf"), 2, &["--engrave", "no material"]);
    room.draw("corner.svg", "<rect x='2' y='50' width='12' height='5'/>");
    room.succeeds(&format!("{} --carve -o q.dxf", laid.replace("laid.svg", "corner.svg")));
}

#[test]
fn what_a_printer_leaves_out_is_told() {
    let room = Room::with(&[]);
    room.draw("thin.svg", "<path d='M5 5H25V25H5Z M30 5H50V5.3H30Z M30 10H30.05V10.05H30Z'/>");
    let said = room.succeeds("extrude thin.svg -o thin.3mf");
    assert!(said.stderr.contains("warning: 2 of 3 components are nowhere as wide"), "{}", said.stderr);
    assert!(said.stderr.contains("warning: 1 component(s) or hole(s) are smaller"), "{}", said.stderr);
    let said = room.succeeds("extrude thin.svg -o thin.dxf");
    assert!(!said.stderr.contains("nozzle"), "{}", said.stderr);
}

#[test]
fn presets_are_checked_and_the_command_line_wins() {
    let room = Room::with(&["vine.svg"]);
    room.write(
        "p.toml",
        "along = \"line:60mm\"\ncomponents = 1\noutput = [\"p.svg\"]\nreport = \"p.json\"\n",
    );
    room.succeeds("band vine.svg --preset p.toml");
    let report = room.json("p.json");
    assert_eq!((&report["components"], &report["along"]), (&Value::from(1), &Value::from("line:60mm")));
    room.succeeds("band vine.svg --preset p.toml --along line:80mm --report q.json");
    let report = room.json("q.json");
    assert_eq!(
        (&report["along"], &report["files"]),
        (&Value::from("line:80mm"), &Value::from(vec!["p.svg"]))
    );
    room.write("wrong.toml", "along = \"line:60mm\"\ncompnents = 1\n");
    let words = ["wrong.toml, line 2", "compnents", "did you mean components?"];
    room.refuses("band vine.svg --preset wrong.toml -o x.svg", 2, &words);
    room.write("range.toml", "along = \"line:60mm\"\ncomponents = \"5..2\"\n");
    room.refuses("band vine.svg --preset range.toml -o x.svg", 2, &["components", "ends before it begins"]);
    room.refuses("band vine.svg --preset none.toml -o x.svg", 2, &["none.toml"]);
}

#[test]
fn the_program_tells_of_itself() {
    let room = Room::with(&[]);
    let schema: Value = serde_json::from_slice(&room.succeeds("schema").stdout).unwrap();
    let band = &schema["options"]["band"]["properties"];
    assert_eq!(band["count"]["type"], serde_json::json!(["integer", "string"]));
    assert_eq!(band["engrave"]["type"], "string");
    assert!(schema["reports"]["band"]["properties"]["contact_sheet"].is_object());

    let script = String::from_utf8(room.succeeds("completions bash").stdout).unwrap();
    assert!(script.contains("_openwork()") && script.contains("--closed-pattern"), "{script}");
    assert_eq!(room.run("completions tcsh").code, 2);

    room.succeeds("man --folder man");
    // A folder that is there is as good, and one in another is made too.
    room.succeeds("man --folder man");
    room.succeeds("man --folder share/man/man1");
    assert_eq!(room.read("share/man/man1/openwork.1"), room.read("man/openwork.1"));
    for (page, word) in
        [("openwork.1", "verify"), ("openwork-band.1", "along"), ("openwork-extrude.1", "thickness")]
    {
        let text = String::from_utf8(room.read(&format!("man/{page}"))).unwrap();
        assert!(text.contains(".TH") && text.contains(word), "{page}: {text}");
    }
    let one = room.succeeds("man");
    assert_eq!(one.stdout, room.read("man/openwork.1"));
    room.write("file", "");
    room.refuses("man --folder file", 2, &["cannot write file"]);
}
