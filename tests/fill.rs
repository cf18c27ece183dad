//! Areas filled by the program: counts on the file, ink inside of the domain, what is kept, what is refused.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::fmt::Write as _;
use std::path::Path;

use common::{Finished, Room};
use openwork::job::FillBuilder;
use openwork::planar::{Grid, Region, Tolerances};
use openwork::samples::{Curve, Drawing, inked};
use openwork::verify::{SvgReport, read_svg};
use serde_json::Value;

const PEN: &str = "fill='none' stroke='black' stroke-width='1' stroke-linecap='round'";

/// Twigs that fork, in rows, on a drawing of 120 mm by 60 mm.
fn twigs() -> String {
    let mut body = String::new();
    for row in 0..4 {
        for column in 0..8 {
            let (x, y) = (8 + 14 * column + 6 * (row % 2), 14 + 13 * row + column % 3);
            let _ = writeln!(body, "<path d='M{x} {y}v-9m0 5l4 -4m-4 2l-4 -4' {PEN}/>");
        }
    }
    body
}

/// A domain with a hole, on the same page.
const FRAME: &str = "<path id='frame' d='M5 5H115V55H5Z M45 20H75V40H45Z' fill='none' stroke='red'/>\
                     <path id='open' d='M5 5H115V55'/>";

fn room() -> Room {
    let room = Room::with(&[]);
    room.draw("twigs.svg", &twigs());
    room.draw("frame.svg", FRAME);
    room
}

/// Fills, and gives what is in the drawing and the report.
fn fill(room: &Room, arguments: &str) -> (SvgReport, Value) {
    room.succeeds(&format!("fill {arguments} -o out.svg --report out.json"));
    (read_svg(&room.read("out.svg"), 0.0025).unwrap(), room.json("out.json"))
}

/// Whether a point in millimetres is in the ink.
fn covers(region: &Region, x: f64, y: f64) -> bool {
    let grid: Grid = region.grid();
    let p = grid.snap(glam::DVec2::new(x, y)).unwrap();
    region.parts().iter().any(|part| part.covers(p))
}

#[test]
fn a_rectangle_has_what_is_asked_for() {
    let room = room();
    let (free, report) = fill(&room, "twigs.svg --domain rect:90x60mm");
    assert_eq!((&report["components"], &report["holes"]), (&free.components.into(), &free.holes.into()));
    let of = |which: &str, what: &str| report[which][what].as_f64().unwrap();
    assert!(free.components > 10 && of("exemplar_density", "components") > 30.0, "{report}");
    let levels = report["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 3);
    assert!(levels.iter().all(|level| level["energies"].as_array().unwrap().len() >= 7));
    let (one, report) = fill(&room, "twigs.svg --domain rect:90x60mm --components 1 --holes 2..9");
    assert!(one.components == 1 && (2..=9).contains(&one.holes), "{}", one.holes);
    assert!(!report["changes"].as_array().unwrap().is_empty());
    for found in [&free, &one] {
        let (low, high) = found.bounds_mm.unwrap();
        assert!(low.min_element() > 0.98 && high.x < 91.02 && high.y < 61.02, "{low} {high}");
        assert_eq!(found.faults, []);
    }
}

#[test]
fn a_narrow_strip_has_smaller_neighbourhoods() {
    let room = room();
    for (domain, least_mm) in [("rect:90x60mm", 8.0), ("rect:90x7mm", 0.0)] {
        let (found, report) = fill(&room, &format!("twigs.svg --domain {domain} --components 1..99"));
        let radii =
            report["levels"].as_array().unwrap().iter().map(|level| level["radius_mm"].as_f64().unwrap());
        let largest_mm = radii.fold(0.0, f64::max);
        assert!(largest_mm > least_mm && found.components > 0, "{domain}: {largest_mm}");
        assert!(largest_mm <= if least_mm == 0.0 { 6.0 } else { 60.0 }, "{domain}: {largest_mm}");
    }
}

#[test]
fn a_frame_is_part_of_the_pattern() {
    let room = room();
    let (found, _) = fill(&room, "twigs.svg --domain rect:70x50mm --components 1 --frame 1mm -o out.stl");
    assert!(found.components == 1 && found.holes >= 1);
    for (x, y) in [(1.5, 26.0), (70.5, 26.0), (36.0, 1.5), (36.0, 50.5)] {
        assert!(covers(&found.region, x, y), "{x} {y}");
    }
    assert_eq!(room.json("out.json")["solid"]["genus"], found.holes);
}

#[test]
fn a_hole_of_the_domain_stays_empty() {
    let room = room();
    let (found, report) = fill(&room, "twigs.svg --domain frame.svg#frame --components 1");
    assert_eq!(found.components, 1);
    // The domain begins one margin from the corner of the page.
    for i in 1..30 {
        for j in 1..20 {
            let (x, y) = (41.0 + f64::from(i), 16.0 + f64::from(j));
            assert!(!covers(&found.region, x, y), "{x} {y}");
        }
    }
    assert!((report["domain_mm2"].as_f64().unwrap() - (5500.0 - 600.0)).abs() < 0.01);
    assert_eq!(report["domain_file"]["file"], "frame.svg");
}

#[test]
fn nothing_is_laid_across_a_slit_of_the_domain() {
    let room = room();
    let slits: String = (0..5).map(|i| format!("M{0} 8h0.4v38h-0.4Z", 24 + 15 * i)).collect();
    room.draw("slits.svg", &format!("<path id='slits' fill-rule='evenodd' d='M5 5H115V55H5Z {slits}'/>"));
    for holes in [0, 12] {
        let counts = format!("--components 1 --holes {holes}");
        let (found, _) = fill(&room, &format!("twigs.svg --domain slits.svg#slits {counts}"));
        assert_eq!((found.components, found.holes), (1, holes));
        // The page begins one margin before the domain, and y goes up.
        for i in 0..5 {
            for y in 11..48 {
                let x = 24.2 + 15.0 * f64::from(i) - 4.0;
                assert!(!covers(&found.region, x, f64::from(y)), "slit {i} at {y}");
            }
        }
    }
}

#[test]
fn a_band_goes_along_its_curve() {
    let room = room();
    let (ring, _) = fill(&room, "twigs.svg --domain band --along circle:80mm --width 24mm --components 1");
    assert_eq!(ring.components, 1);
    let (low, high) = ring.bounds_mm.unwrap();
    assert!((high - low).max_element() < 104.05 && (high - low).min_element() > 95.0, "{low} {high}");
    assert!(!(0..20).any(|i| covers(&ring.region, 53.0 + 1.3 * f64::from(i), 53.0)), "the inside is empty");
    let (line, report) = fill(&room, "twigs.svg --domain band --along line:90mm --width 30mm --components 2");
    assert_eq!(line.components, 2);
    assert_eq!((&report["domain"], &report["along"]), (&"band".into(), &"line:90mm".into()));
}

#[test]
fn a_band_in_space_has_its_counts_as_it_stands() {
    let room = room();
    let arguments =
        "twigs.svg --domain band --along ring:50mm --width 24mm --components 1 --frame 1.2mm -o out.stl";
    let (flat, report) = fill(&room, arguments);
    // The way round is one of the holes.
    let holes = report["holes"].as_u64().unwrap();
    assert!(report["components"] == 1 && holes >= 2, "{report}");
    assert_eq!((&report["solid"]["genus"], &report["flat"]["is_joined"]), (&holes.into(), &true.into()));
    assert_eq!(report["flat"]["holes"], flat.holes);
    room.succeeds(&format!("verify out.stl --components 1 --holes {holes}"));
    let open = "twigs.svg --domain band --along helix:40mm,pitch=34mm,turns=1.2 --width 24mm --components 1 -o out.stl";
    let (flat, report) = fill(&room, open);
    assert!(flat.components == 1 && report["flat"]["is_joined"] == false);
    let refuses = |more: &str, words: &[&str]| {
        let job = "fill twigs.svg --domain band --along ring:50mm --width 24mm -o out.stl";
        room.refuses(&format!("{job} {more}"), 2, words);
    };
    refuses("--chamfer 0.3mm", &["--chamfer", "lie flat"]);
    refuses("--bridge 1mm", &["--bridge", "would not meet"]);
}

#[test]
fn a_band_on_a_model_fits_it_or_is_one_with_it() {
    let room = room();
    let vase = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/models/vase.obj");
    std::fs::copy(vase, room.path("vase.obj")).unwrap();
    let job = "twigs.svg --domain band --mesh vase.obj --around 40mm --width 20mm --components 1";
    let (flat, report) = fill(&room, &format!("{job} --frame 1.2mm --thickness 1.5mm -o ring.stl"));
    let holes = report["holes"].as_u64().unwrap();
    assert!(report["components"] == 1 && holes >= 2, "{report}");
    assert_eq!((&report["solid"]["genus"], &report["flat"]["holes"]), (&holes.into(), &flat.holes.into()));
    assert_eq!(
        (&report["surface"]["mode"], &report["surface"]["route"]),
        (&"band".into(), &"around 40mm".into())
    );
    assert_eq!(report["domain_file"]["file"], "vase.obj");
    // It is where the model is, and around it.
    let corner = |mm: &Value| mm.as_f64().unwrap();
    let [low, high] =
        [0, 1].map(|end| [0, 1, 2].map(|axis| corner(&report["solid"]["bounds_mm"][end][axis])));
    assert!((low[2] - 30.0).abs() < 1.5 && (high[2] - 50.0).abs() < 1.5, "{low:?} {high:?}");
    assert!(low[0] < -34.0 && high[1] > 34.0 && high[0] < 37.0, "{low:?} {high:?}");
    // The vase is open above, so that its wall is a bowl.
    let shells_and_genus = |report: &Value| {
        let shells = report["solid"]["shells"].as_array().unwrap().len();
        (shells, report["solid"]["genus"].as_u64().unwrap())
    };
    let (_, report) = fill(&room, &format!("{job} --mode emboss --shell 2mm --thickness 1mm -o vase.stl"));
    assert_eq!(shells_and_genus(&report), (1, 0));
    // Each hole of what is carved through it comes off.
    let (_, report) = fill(&room, &format!("{job} --mode carve --shell 2mm -o vase.stl"));
    let holes = report["holes"].as_u64().unwrap();
    assert_eq!(shells_and_genus(&report), (1 + holes as usize, 1));
    let open = "--through 35,0,40;0,35,44;-35,0,40 --tolerance 4mm";
    let job = "twigs.svg --domain band --mesh vase.obj --width 20mm --components 1 --holes 2";
    let (flat, report) = fill(&room, &format!("{job} {open} -o part.stl"));
    assert_eq!((flat.components, flat.holes), (1, 2));
    assert_eq!(shells_and_genus(&report), (1, 2));
}

#[test]
fn what_no_model_can_carry() {
    let room = room();
    let vase = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/models/vase.obj");
    std::fs::copy(vase, room.path("vase.obj")).unwrap();
    let refuses = |arguments: &str, words: &[&str]| {
        room.refuses(&format!("fill twigs.svg {arguments} -o out.stl"), 2, words);
    };
    let job = "--domain band --mesh vase.obj --around 40mm";
    refuses("--domain band --mesh vase.obj --width 20mm", &["--around"]);
    refuses("--domain band --around 40mm --width 20mm", &["--mesh"]);
    refuses("--domain rect:90x60mm --mode carve", &["--mesh"]);
    refuses(
        "--domain rect:90x60mm --mesh vase.obj --around 40mm --width 20mm",
        &["rect:90x60mm has no curve", "--mesh"],
    );
    refuses(job, &["--mesh", "--width 20mm"]);
    refuses(&format!("{job} --width 20mm --along line:90mm"), &["cannot be used with"]);
    refuses(&format!("{job} --width 20mm --twist 90"), &["--twist", "lies as the model does"]);
    refuses(&format!("{job} --width 20mm --mode emboss"), &["is open", "--shell"]);
    refuses(&format!("{job} --width 20mm --mode carve"), &["how deep", "--depth 2mm"]);
    refuses(&format!("{job} --width 20mm -o vase.obj"), &["vase.obj is an input"]);
    let narrow = "--width 20mm --mode carve --shell 2mm --min-gap 1.5mm";
    room.refuses(
        &format!("fill twigs.svg {job} {narrow} -o out.stl"),
        4,
        &["cut out of the model", "smaller --min-gap"],
    );
}

#[test]
fn elements_are_copied_whole() {
    let room = Room::with(&[]);
    let mut body = String::new();
    for i in 0..32 {
        let (x, y) = (8 + 14 * (i % 8), 8 + 14 * (i / 8));
        let _ = writeln!(body, "<g><circle cx='{x}' cy='{y}' r='3'/><path d='M{x} {y}v5' {PEN}/></g>");
    }
    room.draw("pins.svg", &body);
    let (found, _) = fill(&room, "pins.svg --domain rect:90x60mm");
    assert!(found.components > 10 && found.holes == 0);
    // All of one size, and none is cut.
    let areas: Vec<f64> =
        found.region.parts().iter().map(|p| p.exterior().area_mm2(found.region.grid())).collect();
    let whole = std::f64::consts::PI * 9.0 + 2.4;
    let alike = areas.iter().filter(|area| (**area - whole).abs() < 0.4).count();
    assert!(10 * alike >= 9 * areas.len(), "{areas:?}");
}

#[test]
fn what_is_kept_stays() {
    let room = room();
    room.draw("begun.svg", &format!("<path d='M10 50C30 20 60 20 80 50' {PEN}/>"));
    let (found, report) = fill(&room, "twigs.svg --domain rect:90x60mm --keep begun.svg");
    // Points of the curve, on the page of the result.
    for t in [0.0_f64, 0.2, 0.5, 0.8, 1.0] {
        let s = 1.0 - t;
        let x = s.powi(3) * 10.0 + 3.0 * s * s * t * 30.0 + 3.0 * s * t * t * 60.0 + t.powi(3) * 80.0;
        let y = s.powi(3) * 10.0 + 3.0 * s * s * t * 40.0 + 3.0 * s * t * t * 40.0 + t.powi(3) * 10.0;
        assert!(covers(&found.region, x + 1.0, y + 1.0), "{x} {y}");
    }
    assert_eq!(report["kept"]["file"], "begun.svg");
}

#[test]
fn a_box_of_the_exemplar_comes_whole_to_its_place() {
    let room = room();
    for how in ["", "--start noise --iterations 2", "--components 1"] {
        let job = format!("twigs.svg --domain rect:90x60mm --seed 3 --clone 0,0,40x30->45,25 {how}");
        let (found, _) = fill(&room, &job);
        // Two twigs that are wholly in the box, by their feet in the exemplar, with their arms.
        for (x, y) in [(14.0, 7.0), (28.0, 6.0)] {
            let stem = (0..9).map(|up| (0.0, f64::from(up)));
            let arms = (1..4).flat_map(|out| {
                [(f64::from(out), 4.0 + f64::from(out)), (-f64::from(out), 6.0 + f64::from(out))]
            });
            for (dx, dy) in stem.chain(arms) {
                let (x, y) = (x + dx + 45.0 + 1.0, y + dy + 25.0 + 1.0);
                assert!(covers(&found.region, x, y), "{how}: {x} {y}");
            }
        }
    }
    room.succeeds("fill twigs.svg --domain rect:120x60mm --iterations 0 --clone 0,0,120x60->0,0 -o out.svg");
    let job = "fill twigs.svg --domain rect:90x60mm -o out.svg --clone";
    room.refuses(&format!("{job} 100,0,40x30->45,25"), 2, &["--clone", "beyond the exemplar", "120.00"]);
    room.refuses(&format!("{job} 0,0,4x4->45,25"), 2, &["--clone", "where nothing is drawn"]);
    room.refuses(&format!("{job} 0,0,40x30->85,25"), 2, &["--clone", "outside of the domain"]);
    room.refuses(
        &format!("{job} 0,0,40x30->45,25 --clone 0,0,40x30->20,10"),
        2,
        &["--clone", "over what is copied"],
    );
}

#[test]
fn copied_elements_stay_where_they_are_put() {
    let room = Room::with(&[]);
    let discs =
        (0..32).map(|i| format!("<circle cx='{}' cy='{}' r='3'/>", 8 + 14 * (i % 8), 8 + 14 * (i / 8)));
    room.draw("discs.svg", &discs.collect::<String>());
    // The lower left ones, moved off their grid.
    let (found, _) = fill(&room, "discs.svg --domain rect:90x60mm --clone 0,0,30x30->33.3,21.7");
    for (x, y) in [(8.0, 10.0), (22.0, 10.0), (8.0, 24.0), (22.0, 24.0)] {
        let (x, y) = (x + 34.3, y + 22.7);
        assert!(
            [(0.0, 0.0), (2.9, 0.0), (-2.9, 0.0), (0.0, 2.9), (0.0, -2.9)]
                .iter()
                .all(|(dx, dy)| { covers(&found.region, x + dx, y + dy) }),
            "{x} {y}"
        );
    }
    assert_eq!(found.holes, 0);
}

#[test]
fn what_is_kept_comes_out_exactly_and_counts() {
    let room = room();
    // One goes on beside the domain, and another crosses it.
    room.draw("begun.svg", &format!("<path d='M10 50C30 20 60 20 112 50' {PEN}/><path d='M20 5V55' {PEN}/>"));
    let filled = FillBuilder::new(room.path("twigs.svg"), "rect:90x60mm".parse().unwrap())
        .keep(room.path("begun.svg"))
        .components(1)
        .build()
        .unwrap()
        .run(&mut |_| {})
        .unwrap();
    let region = filled.region();
    // Chords of round outlines lie a little inside.
    let kept = filled.drawing().curves.iter().rev().take(2).cloned();
    let curves = kept.map(|curve| Curve { width_mm: curve.width_mm - 0.01, ..curve }).collect();
    let begun = Drawing { curves, elements: Vec::new() };
    let ink = inked(&begun, region.grid(), 0.25 * Tolerances::default().chord_mm()).unwrap();
    // But for steps of the grid where outlines cross.
    let lost_mm2 = ink.without(region).area_mm2();
    assert!(ink.area_mm2() > 100.0 && lost_mm2 < 1e-6, "{lost_mm2}");
    assert_eq!(region.components(), 1);
    // The page has room for what is beside the domain.
    let (low, high) = region.bounds_mm().unwrap();
    assert!(low.min_element() > 0.98 && (high.x - 113.5).abs() < 0.01, "{low} {high}");
    room.refuses(
        "fill twigs.svg --domain band --along line:90mm --width 20mm --keep begun.svg -o out.svg",
        2,
        &["--keep", "beside the strip", "lower left corner"],
    );
}

#[test]
fn what_is_kept_keeps_its_ends_and_its_pen() {
    let room = room();
    // A thick bar with flat ends, a shape, and a dot that no neighbourhood sees.
    room.draw(
        "begun.svg",
        "<path d='M20 30H60' stroke='red' stroke-width='6'/><circle cx='70' cy='15' r='4'/><circle cx='150' cy='30' r='2'/>",
    );
    let job = "--domain rect:90x60mm --keep begun.svg --seed 2";
    let (found, report) = fill(&room, &format!("twigs.svg {job}"));
    let y = |svg: f64| 60.0 - svg + 1.0;
    for (x, at) in [(20.1, 27.1), (59.9, 32.9), (40.0, 30.0), (70.0, 11.1), (73.9, 15.0), (150.0, 30.0)] {
        assert!(covers(&found.region, x + 1.0, y(at)), "{x} {at}");
    }
    // Only the bar and the shapes are as wide as this.
    let wide = found.region.offset(-1.2, 0.01);
    let [low, high] = [wide.bounds_mm().unwrap().0, wide.bounds_mm().unwrap().1];
    assert_eq!(wide.components(), 3, "{low} {high}");
    // A round end would begin at 19.2 mm; strokes of the pattern that end on it add a little.
    assert!(low.x > 21.0, "{low}");
    let notes = report["notes"].to_string();
    assert!(
        notes.contains("1 component(s) of --keep lie beside the domain, up to 58.0 mm away")
            && !notes.contains("flat ends"),
        "{notes}"
    );
    // A line whose ends are far away goes through the domain all the same.
    room.draw("through.svg", &format!("<path d='M-100 30H300' {PEN}/>"));
    let (_, report) = fill(&room, "twigs.svg --domain rect:90x60mm --iterations 0 --keep through.svg");
    assert!(!report["notes"].to_string().contains("beside the domain"), "{}", report["notes"]);
    // On a strip as well, from whose corner it is drawn.
    room.draw("bar.svg", "<path d='M20 30H60' stroke='red' stroke-width='6'/>");
    let (found, _) = fill(&room, "twigs.svg --domain band --along line:90mm --width 40mm --keep bar.svg");
    let wide = found.region.offset(-1.2, 0.01);
    assert!(wide.bounds_mm().unwrap().0.x > 21.0);
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let room = room();
    let bytes = |threads: &str| {
        let job = "fill twigs.svg --domain rect:70x50mm --components 1 --seed 5 -o out.svg -o out.png";
        let finished = Finished::of(room.command(job).env("OPENWORK_THREADS", threads));
        assert_eq!(finished.code, 0, "{}", finished.stderr);
        (room.read("out.svg"), room.read("out.png"))
    };
    let one = bytes("1");
    assert!(one == bytes("2") && one == bytes("3"));
    let (_, _) = fill(&room, "twigs.svg --domain rect:70x50mm --components 1 --seed 6");
    assert!(room.read("out.svg") != one.0, "another seed");
}

#[test]
fn a_preset_has_its_options() {
    let room = room();
    room.write(
        "p.toml",
        "domain = \"rect:70x50mm\"\n[fill]\ncomponents = 1\nradii = \"14,11,9mm\"\nspacing = \"9,7,5mm\"\n",
    );
    let (found, report) = fill(&room, "twigs.svg --preset p.toml");
    assert_eq!((found.components, &report["levels"][0]["radius_mm"]), (1, &14.0.into()));
}

#[test]
fn widths_are_enforced() {
    let room = room();
    let (found, report) =
        fill(&room, "twigs.svg --domain rect:70x50mm --components 1 --min-feature 1.2mm --enforce");
    assert_eq!(found.components, 1);
    assert!(report["enforced"]["added_mm2"].as_f64().unwrap() > 0.0);
    room.succeeds("verify out.svg --components 1 --min-feature 1.15mm");
}

#[test]
fn what_cannot_be_learnt_from() {
    let room = room();
    room.draw("blank.svg", "");
    room.draw("one.svg", &format!("<path d='M10 10H14' {PEN}/>"));
    room.draw("dashed.svg", &format!("<path id='d' stroke-dasharray='2 1' d='M10 10H90' {PEN}/>"));
    room.draw("stretched.svg", &format!("<g transform='scale(1 2)'><path id='s' d='M9 9H90' {PEN}/></g>"));
    let refuses = |file: &str, words: &[&str]| {
        room.refuses(&format!("fill {file} --domain rect:90x60mm -o out.svg"), 2, words);
    };
    refuses("nowhere.svg", &["nowhere.svg", "no such file"]);
    refuses("blank.svg", &["blank.svg", "draws nothing"]);
    room.refuses(
        "fill one.svg --domain rect:90x60mm --radii 12mm --spacing 8mm -o out.svg",
        2,
        &["one.svg: the exemplar has 2 sample(s)", "draw more strokes"],
    );
    refuses("dashed.svg", &["<path id=\"d\"> on line 2", "dashed", "Convert to Dashes"]);
    refuses("stretched.svg", &["<path id=\"s\"> on line 2", "stretches", "Stroke to Path"]);
}

#[test]
fn what_cannot_be_filled() {
    let room = room();
    let refuses = |arguments: &str, code: i32, words: &[&str]| {
        room.refuses(&format!("fill twigs.svg {arguments} -o out.svg"), code, words);
    };
    refuses("--domain shape", 2, &["'shape' names no domain", "rect:200x150mm"]);
    refuses("--domain rect:0x9mm", 2, &["the width is 0 mm", "from 1 to 2000 mm"]);
    refuses("--domain frame.svg#none", 2, &["no element with the id \"none\"", "frame, open"]);
    refuses("--domain frame.svg#open", 2, &["<path id=\"open\"> on line 2 is open", "z at the end"]);
    refuses("--domain frame.svg", 2, &["holds 2 paths", "#id", "frame, open"]);
    refuses("--domain rect:1x40mm --stroke 1.5mm", 2, &["nowhere wider than the pen of 1.50 mm", "--stroke"]);
    refuses("--domain rect:8x8mm --radii 12,10,9mm", 2, &["less than a neighbourhood", "--radii"]);
    refuses(
        "--domain rect:40x30mm --frame 15mm",
        2,
        &["--frame", "covers all of the domain", "a narrower one"],
    );
    refuses("--domain rect:40x30mm --twist 30", 2, &["--twist", "has no curve", "--domain band"]);
    refuses("--domain rect:40x30mm --gap 3mm", 2, &["--gap", "has no curve"]);
    refuses(
        "--domain rect:90x60mm --radii 40,40,40mm --spacing .5,.5,.4mm",
        2,
        &["more than 400", "a smaller --radii"],
    );
    refuses("--domain rect:90x60mm --radii 9,8mm --levels 3", 2, &["2 length(s)", "3 level(s)", "12,10,8mm"]);
    refuses("--domain rect:90x60mm --levels 4", 2, &["--levels", "1, 2 or 3"]);
    refuses("--domain rect:90x60mm --iterations 1001", 2, &["--iterations", "from 0 to 1000"]);
    refuses("--domain rect:90x60mm --cluster nan", 2, &["--cluster", "from 0 to 10"]);
    refuses("--domain rect:90x60mm --stroke 0", 2, &["--stroke", "from 0.01 to 100 mm"]);
    refuses("--domain rect:90x60mm --components 0", 2, &["0 components is no pattern"]);
    refuses("--domain rect:90x60mm --along circle:65mm", 2, &["--along", "--width 20mm"]);
    refuses("--domain rect:90x60mm --along circle:65mm --width 9mm", 2, &["rect:90x60mm has no curve"]);
    refuses("--domain band", 2, &["a band needs the curve", "--along and --width"]);
    refuses("--domain band --along circle:20mm --width 60mm", 2, &["narrower --width"]);
    refuses("--domain band --along line:80mm --width 30mm --gap 3mm", 2, &["only a ring has a gap"]);
    refuses("--domain rect:90x60mm --clone 1,2->3", 2, &["is no copy", "10,20,30x15->100,50"]);
    refuses("--domain rect:90x60mm --engine pieces", 2, &["invalid value 'pieces'", "samples"]);
    refuses("--domain rect:90x60mm --holes 4000", 3, &["wanted were 4000 hole(s)"]);
}

#[test]
fn what_cannot_be_kept() {
    let room = room();
    room.draw("upon.svg", &format!("<path d='M10 10H50' {PEN}/><path d='M60 10H20' {PEN}/>"));
    let refuses = |file: &str, words: &[&str]| {
        room.refuses(&format!("fill twigs.svg --domain rect:90x60mm --keep {file} -o out.svg"), 2, words);
    };
    refuses("upon.svg", &["--keep: upon.svg", "strokes 1 and 2 lie upon each other", "delete one"]);
    room.draw("empty.svg", "");
    refuses("empty.svg", &["draws nothing"]);
    room.refuses("fill twigs.svg --domain rect:90x60mm --keep twigs.svg -o twigs.svg", 2, &["twigs.svg"]);
}
