//! What the writer of DXF writes.

use super::*;
use crate::export::{Curves, LayerColours};
use crate::planar::{FillRule, Grid, Region, boxes};

/// A disc of radius 5 about (20, 20), flattened finely.
fn disc() -> Region {
    let grid = Grid::for_extent(100.0).unwrap();
    let at = |i: u32| {
        let p = DVec2::splat(20.0) + 5.0 * DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 200.0);
        grid.snap(p).unwrap()
    };
    Region::fill(grid, &[(0..200).map(at).collect()], FillRule::NonZero)
}

fn written(regions: &[(Layer, &Region)], curves: Curves, version: DxfVersion) -> String {
    dxf(&CutLines::new(regions, curves, 0.01).unwrap(), version).unwrap()
}

/// The values of the pairs with a code.
fn values(text: &str, code: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len() % 2, 0, "codes and values alternate");
    lines.chunks(2).filter(|pair| pair[0] == code).map(|pair| pair[1].to_owned()).collect()
}

#[test]
fn a_square_with_a_hole_is_two_closed_polylines_inner_first() {
    let frame = boxes(1 << 26, FillRule::EvenOdd, &[(1, 2, 10, 10), (3, 4, 5, 5)]);
    let text = written(&[(Layer::Cut, &frame)], Curves::Arcs, DxfVersion::R2000);
    assert!(text.starts_with("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n"));
    assert!(text.contains("9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n") && text.ends_with("0\nEOF\n"));
    let first =
        "100\nAcDbPolyline\n90\n4\n70\n1\n43\n0\n10\n3\n20\n4\n10\n3\n20\n9\n10\n8\n20\n9\n10\n8\n20\n4\n";
    assert!(text.contains(first), "{text}");
    assert_eq!(text.matches("\nLWPOLYLINE\n").count(), 2);
    assert_eq!(text, written(&[(Layer::Cut, &frame)], Curves::Arcs, DxfVersion::R2000), "the same bytes");
}

#[test]
fn handles_are_unique_and_below_the_seed() {
    let text =
        written(&[(Layer::Cut, &disc()), (Layer::Engrave, &disc())], Curves::Spline, DxfVersion::R2000);
    let mut handles = values(&text, "5");
    handles.extend(values(&text, "105"));
    let seed = u32::from_str_radix(&handles.remove(0), 16).unwrap();
    let mut numbers: Vec<u32> = handles.iter().map(|h| u32::from_str_radix(h, 16).unwrap()).collect();
    numbers.sort_unstable();
    assert!(numbers.windows(2).all(|w| w[0] < w[1]) && *numbers.last().unwrap() < seed, "{numbers:?}");
    let owners: Vec<u32> = values(&text, "330").iter().map(|h| u32::from_str_radix(h, 16).unwrap()).collect();
    assert!(owners.iter().all(|owner| *owner == 0 || numbers.contains(owner)));
}

#[test]
fn a_disc_is_arcs_or_a_spline() {
    let arcs = written(&[(Layer::Cut, &disc())], Curves::Arcs, DxfVersion::R2000);
    let bulges = values(&arcs, "42");
    // One value is the width factor of the text style.
    assert!((4..9).contains(&bulges.len()), "{bulges:?}");
    let spline = written(&[(Layer::Cut, &disc())], Curves::Spline, DxfVersion::R2000);
    let knots = values(&spline, "72").last().unwrap().parse::<usize>().unwrap();
    let points = values(&spline, "73").last().unwrap().parse::<usize>().unwrap();
    assert_eq!(knots, points + 4);
    let entity = &spline[spline.find("AcDbSpline").unwrap()..spline.find("OBJECTS").unwrap()];
    assert_eq!((entity.matches("\n40\n").count(), entity.matches("\n10\n").count()), (knots, points));
}

#[test]
fn release_12_has_polylines_and_refuses_splines() {
    let text = written(&[(Layer::Cut, &disc())], Curves::Arcs, DxfVersion::R12);
    assert!(text.contains("AC1009") && !text.contains("$INSUNITS") && !text.contains("AcDb"));
    // All but the last, which begins the closing line, have a bulge; so many values has the text style too.
    assert_eq!(text.matches("\nVERTEX\n").count(), values(&text, "42").len());
    assert_eq!((text.matches("\nPOLYLINE\n").count(), text.matches("\nSEQEND\n").count()), (1, 1));
    let splines = CutLines::new(&[(Layer::Cut, &disc())], Curves::Spline, 0.01).unwrap();
    assert!(matches!(dxf(&splines, DxfVersion::R12), Err(ExportError::Splines)));
}

#[test]
fn layers_have_their_colours_and_engraving_comes_first() {
    let square = boxes(1 << 26, FillRule::NonZero, &[(0, 0, 50, 50)]);
    let regions = [(Layer::Sheet, &square), (Layer::Cut, &square), (Layer::Engrave, &square)];
    let text = written(&regions, Curves::Arcs, DxfVersion::R2000);
    for (name, colour) in [("ENGRAVE", 7), ("CUT", 1), ("SHEET", 8)] {
        assert!(text.contains(&format!("2\n{name}\n70\n0\n62\n{colour}\n")), "{name}");
    }
    assert!(values(&text, "420").is_empty(), "numbers of the index say these exactly");
    let entities = &text[text.find("ENTITIES").unwrap()..];
    let layers: Vec<&str> =
        entities.split("\n8\n").skip(1).map(|rest| rest.lines().next().unwrap()).collect();
    assert_eq!(layers, ["ENGRAVE", "CUT", "SHEET"]);
}
#[test]
fn colours_of_a_process_are_exact_where_the_release_can_say_so() {
    let square = boxes(1 << 26, FillRule::NonZero, &[(0, 0, 50, 50)]);
    let lines = CutLines::new(&[(Layer::Cut, &square)], Curves::Arcs, 0.01).unwrap();
    let lines = lines.with_colours(LayerColours { cut: [0, 0, 0xf0], ..LayerColours::default() });
    let text = dxf(&lines, DxfVersion::R2000).unwrap();
    assert!(text.contains("2\nCUT\n70\n0\n62\n5\n420\n240\n"), "{text}");
    let old = dxf(&lines, DxfVersion::R12).unwrap();
    assert!(old.contains("2\nCUT\n70\n0\n62\n5\n6\n") && values(&old, "420").is_empty());
}
