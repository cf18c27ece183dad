//! Processes, materials and `--enforce` by the program: one order of numbers, what is mended, and what is refused.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;

/// Two blocks that a bar of 0.1 mm joins, and a third that is 0.1 mm above the first.
const DRAWING: &str =
    "<path d='M10 20h20v20h-20z M50 20h20v20h-20z M30 29.95h20v.1h-20z M10 10h20v9.9h-20z'/>";

#[test]
fn options_win_over_the_file_and_the_file_over_what_is_built_in() {
    let room = Room::with(&["vine.svg"]);
    room.write("mine.toml", "[process.resin]\nthickness_mm = 5\n\n[material.walnut]\ndensity_g_cm3 = 0.64\n");
    let thickness = |options: &str| {
        room.succeeds(&format!("band vine.svg --along line:60mm -o out.svg --report out.json {options}"));
        room.json("out.json")["thickness_mm"].as_f64().unwrap()
    };
    assert_eq!(thickness(""), 2.0);
    assert_eq!(thickness("--process laser-ply-3mm --min-feature 0mm --min-gap 0mm"), 3.0);
    let resin = "--process resin --processes mine.toml --min-feature 0mm --min-gap 0mm";
    assert_eq!(thickness(resin), 5.0);
    assert_eq!(thickness(&format!("{resin} --thickness 1mm --material walnut")), 1.0);
    let report = room.json("out.json");
    let quantities = &report["quantities"];
    let mass = quantities["volume_mm3"].as_f64().unwrap() * 0.64 / 1000.0;
    assert!((quantities["mass_g"].as_f64().unwrap() - mass).abs() < 1e-9, "{quantities}");
    assert_eq!(report["bytes"][0].as_u64().unwrap(), room.read("out.svg").len() as u64);
}

#[test]
fn what_is_too_narrow_is_refused_with_its_place_or_mended() {
    let room = Room::with(&[]);
    room.draw("bar.svg", DRAWING);
    let words = ["0.100 mm at (", "--enforce would mend it"];
    room.refuses("extrude bar.svg --process fdm-0.4 -o out.svg", 4, &words);
    room.succeeds("extrude bar.svg --process fdm-0.4 --enforce -o out.svg -o out.stl");
    room.succeeds("verify out.svg --components 2 --holes 0 --min-feature 0.4mm --min-gap 0.4mm");
    room.succeeds("verify out.stl --components 2 --holes 0");
    let made = room.succeeds("extrude bar.svg --process fdm-0.4 --enforce -o again.svg --json");
    let report: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    let places = &report["enforced"]["before"];
    let width = |side: &str| places[side][0]["width_mm"].as_f64().unwrap();
    assert!((width("ink") - 0.1).abs() < 1e-3 && (width("gaps") - 0.1).abs() < 1e-3, "{places}");
    assert!(report["enforced"]["added_mm2"].as_f64().unwrap() > 5.0);
    assert_eq!(room.read("out.svg"), room.read("again.svg"));
}

#[test]
fn what_cannot_be_is_told() {
    let room = Room::with(&["vine.svg"]);
    room.draw(
        "comb.svg",
        "<path d='M10 10h40v.2h-40z M10 10.4h40v.2h-40z M10 10.8h40v.2h-40z M10 11.2h40v.2h-40z'/>",
    );
    room.write("typo.toml", "[process.mine]\nlike = \"resin\"\nkerf_m = 1\n");
    let band = "band vine.svg --along line:60mm -o out.svg";
    room.refuses(&format!("{band} --process fdm-04"), 2, &["did you mean 'fdm-0.4'", "waterjet"]);
    room.refuses(&format!("{band} --material gold"), 2, &["there is no material 'gold'", "silver-925"]);
    room.refuses(&format!("{band} --processes typo.toml"), 2, &["typo.toml, line 3", "mean 'kerf_mm'"]);
    room.refuses(&format!("{band} --processes none.toml"), 2, &["none.toml"]);
    room.refuses(&format!("{band} --enforce"), 2, &["there is no width to enforce", "--process"]);
    room.refuses(
        "extrude comb.svg --process fdm-0.4 --enforce -o out.stl",
        3,
        &["there is no room for ink 0.4 mm"],
    );
    let tile = "rect vine.svg --size 30x30mm --tile --process fdm-0.4 --enforce -o out.svg";
    room.refuses(tile, 2, &["--tile", "would not match", "openwork extrude EXEMPLAR.svg"]);
}

#[test]
fn walls_that_are_not_upright_weigh_less() {
    let room = Room::with(&["vine.svg"]);
    room.draw("plates.svg", "<path d='M10 10h30v20h-30z M50 10h20v20h-20z'/>");
    let extrude = "extrude plates.svg --thickness 4mm --material pla";
    for walls in ["--chamfer 0.5mm", "--taper 5", "--chamfer 0.4mm --taper 3", ""] {
        let said = room.succeeds(&format!("{extrude} {walls} -o plates.stl --json"));
        let report: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
        let quantities = &report["quantities"];
        let number = |name: &str| quantities[name].as_f64().unwrap();
        let volume = report["solid"]["volume_mm3"].as_f64().unwrap();
        assert_eq!(number("volume_mm3"), volume, "{walls}");
        assert!((number("mass_g") - volume * number("density_g_cm3") / 1000.0).abs() < 1e-9, "{walls}");
        assert_eq!(volume < 4.0 * number("area_mm2") - 5.0, !walls.is_empty(), "{walls}: {volume}");
        // The same without a solid among the files.
        let said = room.succeeds(&format!("{extrude} {walls} -o plates.svg.svg --json"));
        let report: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
        let drawn = report["quantities"]["volume_mm3"].as_f64().unwrap();
        assert!((drawn - volume).abs() < 1e-3, "{walls}: {drawn} {volume}");
    }
    room.succeeds(
        "band vine.svg --along line:60mm --width 20mm --chamfer 0.1mm -o band.stl --report band.json",
    );
    let report = room.json("band.json");
    assert_eq!(report["quantities"]["volume_mm3"], report["volume_mm3"]);
}
