//! The mesh files of one shape: they agree facet for facet, hold what was planned, and are told from broken ones.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use glam::{DVec2, DVec3};
use openwork::export::{self, MeshDocument};
use openwork::fabricate::{FabricateError, Profile, Solid, raise};
use openwork::planar::{FillRule, Grid, Region};
use openwork::verify::{MeshReport, VerifyError, read_obj, read_stl, read_threemf};
use proptest::prelude::*;
use zip::write::SimpleFileOptions;

fn document() -> MeshDocument {
    MeshDocument {
        title: "sign <1> & more".to_owned(),
        application: "Openwork".to_owned(),
        notes: vec![
            ("Command".to_owned(), "openwork \"a & b\"".to_owned()),
            ("Seed".to_owned(), "7".to_owned()),
        ],
        colours: vec![MeshDocument::GREY, [255, 0, 128]],
    }
}

/// Star-shaped polygons over each other, every second one a gap.
fn region() -> impl Strategy<Value = Region> {
    let star = (10.0..90.0, 10.0..90.0, 1.0..30.0, prop::collection::vec(0.3..1.0f64, 3..24));
    prop::collection::vec(star, 1..8).prop_map(|stars| {
        let grid = Grid::for_extent(200.0).unwrap();
        let path = |(x, y, radius, spokes): &(f64, f64, f64, Vec<f64>)| {
            let turn = std::f64::consts::TAU / spokes.len() as f64;
            let spoke =
                |(i, s): (usize, &f64)| DVec2::new(*x, *y) + DVec2::from_angle(turn * i as f64) * radius * *s;
            spokes.iter().enumerate().map(|p| grid.snap(spoke(p)).unwrap()).collect::<Vec<_>>()
        };
        Region::fill(grid, &stars.iter().map(path).collect::<Vec<_>>(), FillRule::EvenOdd)
    })
}

fn frame() -> Region {
    let grid = Grid::for_extent(100.0).unwrap();
    let square = |low: f64, high: f64| {
        [(low, low), (high, low), (high, high), (low, high)]
            .map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap())
            .to_vec()
    };
    let paths = [square(1.0, 11.0), square(3.0, 9.0), square(5.0, 7.0)];
    Region::fill(grid, &paths, FillRule::EvenOdd)
}

fn solid() -> Solid {
    raise(&frame(), &Profile::upright(2.0).unwrap().chamfered(0.3).unwrap(), 0.01).unwrap()
}

/// The same solid, whichever format says its unit.
fn same(one: &MeshReport, other: &MeshReport) {
    let without = |report: &MeshReport| {
        let mut report = report.clone();
        report.unit = None;
        report
    };
    assert_eq!(without(one), without(other));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn all_formats_hold_the_same_solid(
        region in region(), thickness in 0.5..5.0f64, chamfer in 0.02..0.2f64, taper in 0.5..20.0f64, which in 0..4,
    ) {
        prop_assume!(!region.is_empty());
        let mut profile = Profile::upright(thickness).unwrap();
        if which % 2 == 1 {
            profile = profile.chamfered(chamfer).unwrap();
        }
        if which >= 2 {
            profile = profile.tapered(taper).unwrap();
        }
        let solid = match raise(&region, &profile, 0.02) {
            Err(FabricateError::TooFine { .. } | FabricateError::Inset { .. }) => return Ok(()),
            solid => solid.unwrap(),
        };
        let write = || (export::stl(&solid, "").unwrap(), export::threemf(&solid, &document()), export::obj(&solid, &document()));
        let (stl, threemf, obj) = write();
        prop_assert_eq!(&write(), &(stl.clone(), threemf.clone(), obj.clone()));
        let report = read_stl(&stl).unwrap();
        prop_assert_eq!(&report.faults, &[]);
        prop_assert_eq!((report.shells.len(), report.genus), (region.components(), region.holes() as i64));
        prop_assert!(report.shells.iter().all(|shell| shell.volume_mm3 > 0.0));
        prop_assert!((report.volume_mm3 - solid.volume_mm3()).abs() < 1e-6 * report.volume_mm3);
        // Programs merge equal corners, and the facet is gone.
        prop_assert!(solid.facets().all(|[a, b, c]| a != b && b != c && c != a));
        // Facets in the same order with the same coordinates give the same numbers to the last bit.
        same(&read_threemf(&threemf).unwrap(), &report);
        same(&read_obj(&obj).unwrap(), &report);
    }
}

#[test]
fn a_package_says_what_it_is() {
    let mut archive =
        zip::ZipArchive::new(std::io::Cursor::new(export::threemf(&solid(), &document()))).unwrap();
    let model = std::io::read_to_string(archive.by_name("3D/3dmodel.model").unwrap()).unwrap();
    for part in [
        r#"<model unit="millimeter""#,
        r#"<metadata name="Title">sign &lt;1&gt; &amp; more</metadata>"#,
        r#"<metadata name="Application">Openwork</metadata>"#,
        r#"<metadata name="o:Command">openwork &quot;a &amp; b&quot;</metadata>"#,
        r#"<metadata name="o:Seed">7</metadata>"#,
        r##"displaycolor="#FF0080FF""##,
        r#"<object id="2" type="model" name="sign &lt;1&gt; &amp; more 1" pid="1" pindex="0">"#,
        r#"<object id="3" type="model" name="sign &lt;1&gt; &amp; more 2" pid="1" pindex="1">"#,
        r#"<component objectid="2"/>"#,
        r#"<item objectid="4"/>"#,
    ] {
        assert!(model.contains(part), "{part}");
    }
    assert_eq!(roxmltree::Document::parse(&model).unwrap().root_element().tag_name().name(), "model");
}

#[test]
fn an_obj_says_its_unit_and_names_its_groups() {
    let text = String::from_utf8(export::obj(&solid(), &document())).unwrap();
    assert!(text.starts_with("# Openwork\n# Units: millimetres\n# Command: openwork \"a & b\"\n# Seed: 7\n"));
    assert!(
        text.contains("\no sign_<1>_&_more\ng sign_<1>_&_more_1\nv ")
            && text.contains("\ng sign_<1>_&_more_2\nv ")
    );
}

/// A package around a model.
fn package(model: &str) -> Vec<u8> {
    use std::io::Write;
    let relationships = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" Target="/3D/m.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in [("_rels/.rels", relationships), ("3D/m.model", model)] {
        archive.start_file(name, SimpleFileOptions::DEFAULT).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const TETRAHEDRON: &str = r#"<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources>
<object id="7"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="3" y="0" z="0"/><vertex x="0" y="3" z="0"/><vertex x="0" y="0" z="3"/></vertices>
<triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh></object>
<object id="8"><components><component objectid="7"/></components></object>
</resources>
<build><item objectid="8"/></build></model>"#;

fn read(from: &str, to: &str) -> Result<MeshReport, VerifyError> {
    assert!(TETRAHEDRON.contains(from), "{from}");
    read_threemf(&package(&TETRAHEDRON.replacen(from, to, 1)))
}

fn message(from: &str, to: &str) -> String {
    read(from, to).unwrap_err().to_string()
}

#[test]
fn units_and_transforms_are_respected() {
    let plain = read("millimeter", "millimeter").unwrap();
    assert_eq!((plain.shells.len(), plain.genus, plain.volume_mm3), (1, 0, 4.5));
    let inches = read("millimeter", "inch").unwrap();
    assert_eq!(inches.bounds_mm.unwrap().1, [f64::from(76.2f32); 3]);
    assert!((inches.volume_mm3 - 4.5 * 25.4f64.powi(3)).abs() < 0.1);
    let silent = read(r#" unit="millimeter""#, "").unwrap();
    assert_eq!([plain.unit, inches.unit, silent.unit], [Some("millimeter"), Some("inch"), None]);
    same(&silent, &plain);
    let moved =
        read(r#"<item objectid="8""#, r#"<item objectid="8" transform="0 2 0 -2 0 0 0 0 2 10 20 30""#)
            .unwrap();
    assert_eq!(moved.bounds_mm, Some(([4.0, 20.0, 30.0], [10.0, 26.0, 36.0])));
    let mirrored =
        read(r#"<component objectid="7""#, r#"<component objectid="7" transform="-1 0 0 0 1 0 0 0 1 0 0 0""#)
            .unwrap();
    assert_eq!((mirrored.volume_mm3, mirrored.faults), (4.5, vec![]));
    let twice =
        read("<build>", r#"<build><item objectid="7" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>"#).unwrap();
    assert_eq!((twice.shells.len(), twice.volume_mm3), (2, 9.0));
    let into_itself =
        read("<build>", r#"<build><item objectid="7" transform="1 0 0 0 1 0 0 0 1 0.5 0.25 0.125"/>"#)
            .unwrap();
    assert!(!into_itself.faults.is_empty());
}

#[test]
fn broken_packages_are_told_apart() {
    let whole = export::threemf(&solid(), &document());
    for cut in [0, 3, whole.len() / 2, whole.len() - 1] {
        let text = read_threemf(&whole[..cut]).unwrap_err().to_string();
        assert!(text.starts_with("not a readable 3MF package: ") && text.contains("cut off"), "{text}");
    }
    let mut spoilt = whole.clone();
    spoilt[whole.len() / 2] ^= 0x55;
    assert!(read_threemf(&spoilt).is_err());

    assert!(read_threemf(&package("<svg/>")).unwrap_err().to_string().contains("the root is <svg>"));
    assert!(message("</build>", "").contains("not well-formed XML"));
    assert_eq!(message(r#"<build><item objectid="8"/></build>"#, ""), "the file has no triangles");
    assert_eq!(
        message(r#"v1="1" v2="2""#, r#"v1="1" v2="4""#),
        "line 5 of the 3MF model: v2 is 4, but the mesh has 4 vertices, from 0 on"
    );
    assert!(message(r#"<triangle v1="1""#, "<triangle").contains("<triangle> has no v1"));
    assert!(message(r#"x="3""#, r#"x="three""#).contains("\"three\" is no finite number"));
    assert!(message(r#"x="3""#, r#"x="NaN""#).contains("no finite number"));
    assert!(message(r#" x="3""#, "").contains("a vertex without x"));
    assert!(message("millimeter", "furlong").contains("the unit \"furlong\""));
    assert!(message("<model", r#"<model requiredextensions="b""#).contains("extension(s) \"b\""));
    assert!(
        message(r#"objectid="7""#, r#"objectid="8""#).contains("object 8 is not defined before it is used")
    );
    assert!(message(r#"id="8""#, r#"id="7""#).contains("a second object 7"));
    let flat = r#"<item transform="1 0 0 0 1 0 0 0 0 0 0 0""#;
    assert!(message("<item", flat).contains("leaves nothing"));
    assert!(message("<item", r#"<item transform="1 0 0""#).contains("a transform of 3 numbers"));
    let faults = read(r#"<triangle v1="1" v2="2" v3="3"/>"#, "").unwrap().faults;
    assert_eq!(faults.len(), 3, "an open mesh is read, and is at fault: {faults:?}");
}

#[test]
fn a_package_without_a_model_is_told() {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive.start_file("readme.txt", SimpleFileOptions::DEFAULT).unwrap();
    archive.write_all(b"nothing").unwrap();
    let bytes = archive.finish().unwrap().into_inner();
    let text = read_threemf(&bytes).unwrap_err().to_string();
    assert!(text.contains("has no _rels/.rels"), "{text}");
}

/// The areas in square millimetres of the facets of a binary STL.
fn areas(stl: &[u8]) -> Vec<f64> {
    let number = |at: &[u8]| f64::from(f32::from_le_bytes(at.try_into().unwrap()));
    let area = |facet: &[u8]| {
        let numbers: Vec<f64> = facet[12..48].chunks_exact(4).map(number).collect();
        let [a, b, c] = [0, 3, 6].map(|i| DVec3::from_slice(&numbers[i..]));
        0.5 * (b - a).cross(c - a).length()
    };
    stl[84..].chunks_exact(50).map(area).collect()
}

#[test]
fn no_facet_is_too_small_to_be_one() {
    // Programs that look for facets without any area take those of less than this for such. This ornament has bends
    // of less than a step of 32-bit floats where its pieces meet.
    const NONE_MM2: f64 = 1e-10;
    let room = Room::with(&["filigree.svg"]);
    for walls in ["", "--chamfer 0.2mm", "--taper 3 --chamfer 0.2mm"] {
        let band = "band filigree.svg --along circle:50mm --width 10mm --components 1 -o band.stl";
        room.succeeds(&format!("{band} {walls}"));
        let areas = areas(&room.read("band.stl"));
        let least = areas.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(areas.len() > 50_000 && least > NONE_MM2, "{walls}: {} facets, {least:e} mm2", areas.len());
    }
}
