//! What the exemplar reader takes, and the message for everything that it does not.

use openwork::exemplar::{
    Exemplar, ExemplarError, ExemplarFault, Limits, ReadOptions, path_from_svg, read_path,
};
use proptest::prelude::*;
use std::fmt::Write as _;
use std::path::Path;

/// A drawing of 100 mm by 100 mm in which one user unit is one millimetre.
fn page(body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"100mm\" \
         height=\"100mm\" viewBox=\"0 0 100 100\">\n{body}\n</svg>"
    )
}

fn read_raw(svg: &str) -> Result<Exemplar, ExemplarError> {
    Exemplar::from_svg("test", svg.as_bytes(), &ReadOptions::default())
}

fn read(body: &str) -> Exemplar {
    read_raw(&page(body)).unwrap_or_else(|e| panic!("{e}\n{body}"))
}

fn counts(body: &str) -> (usize, usize) {
    let exemplar = read(body);
    (exemplar.region().components(), exemplar.region().holes())
}

fn area(body: &str) -> f64 {
    read(body).region().area_mm2()
}

#[track_caller]
fn assert_close(found: f64, wanted: f64, slack: f64) {
    assert!((found - wanted).abs() <= slack, "{found} is not {wanted} within {slack}");
}

#[track_caller]
fn assert_says(error: &ExemplarError, wanted: &[&str]) {
    let message = error.to_string();
    for part in wanted {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
}

/// The message about a drawing with this body, whose first line is line 2 of the file.
#[track_caller]
fn refuses(body: &str, wanted: &[&str]) {
    match read_raw(&page(body)) {
        Err(error) => assert_says(&error, wanted),
        Ok(e) => panic!("{body} was read as {} components", e.region().components()),
    }
}

const SQUARE: &str = "<rect x='10' y='20' width='30' height='40'/>";

#[test]
fn keeps_the_place_on_the_page_with_y_up() {
    let exemplar = read(SQUARE);
    let (low, high) = exemplar.region().bounds_mm().unwrap();
    assert_close(low.distance(glam::DVec2::new(10.0, 40.0)), 0.0, 1e-4);
    assert_close(high.distance(glam::DVec2::new(40.0, 80.0)), 0.0, 1e-4);
    assert_eq!(exemplar.name(), "test");
    assert_eq!(exemplar.sha256().len(), 64);
    assert!(exemplar.notes().is_empty(), "{:?}", exemplar.notes());
}

#[test]
fn units_come_from_the_page() {
    let no_size =
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 96 96'><rect width='96' height='96'/></svg>";
    let exemplar = read_raw(no_size).unwrap();
    assert_close(exemplar.region().area_mm2(), 25.4 * 25.4, 1e-3);
    assert!(exemplar.notes()[0].contains("pixels"), "{:?}", exemplar.notes());
    let scaled = "<svg xmlns='http://www.w3.org/2000/svg' width='2in' height='2in' viewBox='-5 -5 10 10'>\
                  <rect x='-5' y='-5' width='10' height='10'/></svg>";
    assert_close(read_raw(scaled).unwrap().region().area_mm2(), 50.8 * 50.8, 1e-3);
}

#[test]
fn a_height_and_a_scale_are_met_before_flattening() {
    let circle = page("<circle cx='50' cy='50' r='10'/>");
    let options = ReadOptions { target_height_mm: Some(60.0), ..ReadOptions::default() };
    let tall = Exemplar::from_svg("test", circle.as_bytes(), &options).unwrap();
    let height = |e: &Exemplar| e.region().bounds_mm().map(|(low, high)| high.y - low.y).unwrap();
    assert_close(height(&tall), 60.0, 1e-6);
    let natural = read_raw(&circle).unwrap();
    let scaled = natural.scaled(3.0).unwrap();
    assert_close(height(&scaled), 60.0, 0.01);
    assert!(scaled.region().vertices() > natural.region().vertices());
    assert_says(&natural.scaled(-1.0).unwrap_err(), &["scale factor", "-1", "above 0"]);
    let options = ReadOptions { target_height_mm: Some(f64::NAN), ..ReadOptions::default() };
    let error = Exemplar::from_svg("test", circle.as_bytes(), &options).unwrap_err();
    assert_says(&error, &["the height is NaN", "above 0 mm"]);
}

#[test]
fn fill_rules_crossings_duplicates_and_windings() {
    let star = "M50 5 L79 95 L2 39 L98 39 L21 95 Z";
    assert_eq!(counts(&format!("<path d='{star}'/>")), (1, 0));
    assert_eq!(counts(&format!("<path fill-rule='evenodd' d='{star}'/>")), (5, 0));
    assert_eq!(counts(&format!("<path d='{star}'/><path d='{star}'/>")), (1, 0));
    let ring = "M10 10 H90 V90 H10 Z M30 30 V70 H70 V30 Z";
    let same = "M10 10 H90 V90 H10 Z M30 30 H70 V70 H30 Z";
    assert_eq!(counts(&format!("<path d='{ring}'/>")), (1, 1));
    assert_eq!(counts(&format!("<path d='{same}'/>")), (1, 0));
    assert_eq!(counts(&format!("<path style='fill-rule:evenodd' d='{same}'/>")), (1, 1));
    // Two paths of opposite winding do not cancel: each is ink.
    assert_eq!(counts("<path d='M10 10 H90 V90 H10 Z'/><path d='M30 30 V70 H70 V30 Z'/>"), (1, 0));
}

#[test]
fn a_touch_in_one_path_is_joined_by_another() {
    let mut black = String::new();
    let mut red = String::new();
    for (x, y) in (0..6).flat_map(|x| (0..6).map(move |y| (x, y))) {
        let cell = if (x + y) % 2 == 0 { &mut black } else { &mut red };
        write!(cell, "M{} {}h10v10h-10z", x * 10 + 10, y * 10 + 10).unwrap();
    }
    assert_eq!(counts(&format!("<path d='{black}'/>")), (18, 0));
    assert_eq!(counts(&format!("<path d='{black}'/><path fill='red' d='{red}'/>")), (1, 0));
}

#[test]
fn groups_transforms_styles_and_uses_are_resolved() {
    let nested = "<g transform='translate(10 10)'><g transform='rotate(90)'><g transform='scale(2 3)'>\
                  <rect width='5' height='4' transform='translate(1 -6)'/></g></g></g>";
    let (low, high) = read(nested).region().bounds_mm().unwrap();
    // x' = 10 - 3(y - 6), y' = 10 + 2(x + 1), then y up.
    assert_close(low.distance(glam::DVec2::new(16.0, 78.0)), 0.0, 1e-4);
    assert_close(high.distance(glam::DVec2::new(28.0, 88.0)), 0.0, 1e-4);
    let used = "<defs><rect id='r' width='5' height='5'/><symbol id='s' overflow='visible'><use href='#r'/></symbol></defs>\
                <use href='#r' x='1'/><use xlink:href='#s' x='20' y='20'/><use href='#s' x='40'/>";
    assert_eq!(counts(used), (3, 0));
    let styled = "<style>.no{display:none} .ring{fill:none;stroke:#000;stroke-width:2}</style>\
                  <circle class='ring' cx='50' cy='50' r='20'/><circle class='no' cx='5' cy='5' r='3'/>";
    assert_eq!(counts(styled), (1, 1));
}

#[test]
fn markers_are_ink() {
    let body = "<marker id='m' markerWidth='4' markerHeight='4' refX='2' refY='2' markerUnits='userSpaceOnUse'>\
                <rect width='4' height='4'/></marker>\
                <path d='M20 20 L80 80' fill='none' stroke='black' marker-start='url(#m)' marker-end='url(#m)'/>";
    let plain = area("<path d='M20 20 L80 80' fill='none' stroke='black'/>");
    assert!(area(body) > plain + 20.0);
    assert_eq!(counts(body), (1, 0));
}

#[test]
fn what_cannot_be_seen_is_not_ink() {
    let hidden = "<g display='none'><text>a</text><image href='a.png'/><rect width='9' height='9'/></g>\
                  <rect visibility='hidden' x='20' width='9' height='9'/><rect fill='none' x='40' width='9' height='9'/>\
                  <rect opacity='0' x='60' width='9' height='9'/><rect fill-opacity='0' x='60' width='9' height='9'/>\
                  <defs><rect width='9' height='9'/></defs><symbol><rect width='9' height='9'/></symbol>\
                  <g visibility='hidden'><text>b</text></g><text/><title>t</title><metadata><x/></metadata>";
    assert_close(area(&format!("{SQUARE}{hidden}")), 1200.0, 1e-2);
    let empty = read(&format!("{SQUARE}<path d=''/><path d='M1 1'/>"));
    assert_eq!(empty.notes().len(), 2);
    assert!(empty.notes()[0].contains("<path> on line 2"), "{:?}", empty.notes());
}

#[test]
fn strokes_have_width_caps_joins_and_dashes() {
    let line = |attributes: &str| {
        area(&format!("<path d='M20 50 H60' fill='none' stroke='black' stroke-width='4' {attributes}/>"))
    };
    assert_close(line(""), 160.0, 1e-2);
    assert_close(line("stroke-linecap='square'"), 176.0, 1e-2);
    assert_close(line("stroke-linecap='round'"), 160.0 + 4.0 * std::f64::consts::PI, 0.05);
    let corner = |join: &str| {
        area(&format!(
            "<path d='M20 20 H60 V60' fill='none' stroke='black' stroke-width='4' stroke-linejoin='{join}'/>"
        ))
    };
    assert_close(corner("miter"), 320.0, 1e-2);
    assert_close(corner("bevel"), 318.0, 1e-2);
    assert_close(corner("round"), 316.0 + std::f64::consts::PI, 0.05);
    let dashed = |dashes: &str, cap: &str| {
        counts(&format!(
            "<path d='M20 50 H60' fill='none' stroke='black' stroke-width='2' stroke-dasharray='{dashes}' \
             stroke-linecap='{cap}'/>"
        ))
    };
    assert_eq!(dashed("5", "butt"), (4, 0));
    assert_eq!(dashed("6 4", "round"), (4, 0));
    // Dotted lines are dashes of no length, and a dot is a path of no length.
    assert_eq!(dashed("0 3.9", "round").0, 11);
    let dot = "<path d='M50 50 h0' fill='none' stroke='black' stroke-width='4' stroke-linecap='round'/>";
    assert_close(area(dot), 4.0 * std::f64::consts::PI, 0.05);
}

#[test]
fn a_stroke_is_transformed_with_its_shape() {
    let body = "<g transform='scale(10 1)'><rect x='1' y='20' width='6' height='40' fill='none' stroke='black' \
                stroke-width='2'/></g>";
    // 20 mm wide uprights and 2 mm thin beams: 80 x 42 outside, 40 x 38 inside.
    let exemplar = read(body);
    assert_close(exemplar.region().area_mm2(), 80.0 * 42.0 - 40.0 * 38.0, 1e-2);
    assert_eq!((exemplar.region().components(), exemplar.region().holes()), (1, 1));
    let mirrored = "<circle transform='translate(50 50) scale(-2 1)' r='10' fill='none' stroke='black' stroke-width='3'/>";
    assert_eq!(counts(mirrored), (1, 1));
    let pi = std::f64::consts::PI;
    assert_close(area(mirrored), 2.0 * pi * (11.5 * 11.5 - 8.5 * 8.5), 0.6);
}

#[test]
fn clips_are_applied_exactly() {
    let clip = "<clipPath id='c'><circle cx='20' cy='40' r='5'/><rect x='30' y='10' width='30' height='20'/></clipPath>";
    let exemplar = read(&format!("{clip}<g clip-path='url(#c)'>{SQUARE}</g>"));
    assert_eq!(exemplar.region().components(), 2);
    assert_close(exemplar.region().area_mm2(), 100.0 + 25.0 * std::f64::consts::PI, 0.2);
    let ring = "<clipPath id='c'><path clip-rule='evenodd' d='M0 0H100V100H0Z M20 30H30V40H20Z'/></clipPath>";
    assert_eq!(counts(&format!("{ring}<g clip-path='url(#c)'>{SQUARE}</g>")), (1, 1));
    let within = "<clipPath id='d'><rect width='25' height='100'/></clipPath>\
                  <clipPath id='c' clip-path='url(#d)'><rect width='100' height='30'/></clipPath>";
    assert_close(area(&format!("{within}<g clip-path='url(#c)'>{SQUARE}</g>")), 150.0, 1e-2);
    // A symbol's viewport clips, at the place where the symbol is used.
    let symbol = "<symbol id='s' viewBox='0 0 10 10'><rect width='20' height='20'/></symbol>\
                  <use href='#s' x='30' y='30' width='10' height='10'/>";
    assert_close(area(symbol), 100.0, 1e-2);
}

#[test]
fn opaque_gradients_are_ink_and_others_are_not_known() {
    let gradient = |opacity: &str| {
        format!(
            "<linearGradient id='g'><stop offset='0'/><stop offset='1' stop-color='red' stop-opacity='{opacity}'/>\
             </linearGradient><rect fill='url(#g)' width='9' height='9'/>"
        )
    };
    assert_close(area(&gradient("1")), 81.0, 1e-2);
    refuses(&gradient("0.5"), &["<rect> on line 2", "gradient", "opacity 0.5"]);
    let pattern = "<pattern id='g' width='1' height='1'><rect width='1' height='1'/></pattern><rect fill='url(#g)' \
                   width='9' height='9'/>";
    refuses(pattern, &["<rect> on line 2", "pattern", "Pattern to Objects"]);
}

#[test]
fn white_is_ink_only_when_all_is_white() {
    let exemplar = read("<g fill='white'><rect width='9' height='9'/></g>");
    assert!(exemplar.notes()[0].contains("white is read as ink"), "{:?}", exemplar.notes());
    refuses(
        &format!("<rect id='bg' fill='#FFF' width='100' height='100'/>\n{SQUARE}"),
        &["<rect id=\"bg\"> on line 2 is painted white", "1 white paint", "background", "Difference"],
    );
}

#[test]
fn opacity_is_all_or_nothing() {
    refuses(
        "\n<rect fill-opacity='.5' width='9' height='9'/>",
        &["<rect> on line 3", "fill opacity of 0.5", "set it to 1"],
    );
    refuses("<rect opacity='.5' width='9' height='9'/>", &["<rect> on line 2", "an opacity of 0.5"]);
    refuses("<g id='a' opacity='30%'><g>\n<path d='M0 0h9v9'/></g></g>", &["<g id=\"a\"> on line 2", "0.3"]);
    refuses("<rect stroke='rgba(0,0,0,.25)' width='9' height='9'/>", &["stroke opacity of 0.25"]);
}

#[test]
fn what_ink_cannot_represent_is_named() {
    for (body, wanted) in [
        ("<text id='t' x='1' y='9'>ab</text>", ["<text id=\"t\"> on line 2", "Object to Path"]),
        ("\n<image href='a.png' width='9' height='9'/>", ["<image> on line 3", "Trace Bitmap"]),
        ("<foreignObject><p/></foreignObject>", ["<foreignObject> on line 2", "delete it"]),
        ("<blob/>", ["<blob> on line 2", "not an element of SVG"]),
        ("<g filter='url(#f)'/>", ["<g> on line 2", "filter"]),
        ("<g style='mask:url(#f)'/>", ["<g> on line 2", "mask"]),
        ("<g style='mix-blend-mode:screen'/>", ["<g> on line 2", "mix-blend-mode"]),
        ("<rect systemLanguage='de' width='9' height='9'/>", ["<rect> on line 2", "systemLanguage"]),
        ("<path d='M0 0h9' vector-effect='non-scaling-stroke'/>", ["<path> on line 2", "vector effect"]),
        ("<path d='M0 0h9' stroke='red' stroke-linejoin='arcs'/>", ["<path> on line 2", "line join arcs"]),
        ("<rect width='9' height='9' style='x:9px'/>", ["<rect> on line 2", "in a style"]),
        ("<path d='M0 0h9' pathLength='4' stroke-dasharray='1'/>", ["<path> on line 2", "pathLength"]),
    ] {
        refuses(&format!("{body}{SQUARE}"), &wanted);
    }
}

#[test]
fn broken_values_are_named_where_they_are() {
    for (body, wanted) in [
        ("<path id='p' d='M0 0 L9 0 L9 x 0'/>", ["<path id=\"p\"> on line 2", "beyond segment 2"]),
        ("\n\n<path d='L 3 4'/>", ["<path> on line 4", "segment 0"]),
        ("<path d='M NaN 0 L9 9'/>", ["<path> on line 2", "NaN"]),
        ("<path d='M 0 0 L1e30 9 L 0 9'/>", ["<path> on line 2", "1e30"]),
        ("<rect width='1e30' height='9'/>", ["<rect> on line 2", "1e30"]),
        ("<rect width='NaN' height='9'/>", ["width=\"NaN\"", "number"]),
        ("<rect width='0' height='9'/>", ["width=\"0\"", "greater than 0"]),
        ("<rect width='9' height='-3'/>", ["height=\"-3\"", "greater than 0"]),
        ("<circle r='0'/>", ["<circle> on line 2", "greater than 0"]),
        ("<ellipse rx='-1' ry='2'/>", ["<ellipse> on line 2", "greater than 0"]),
        ("<polygon points='1 2'/>", ["<polygon> on line 2", "at least 3 points"]),
        ("<polyline points='1 2 3 4 5'/>", ["<polyline> on line 2", "even number"]),
        ("<polygon points='1 2 3 4 x 6'/>", ["<polygon> on line 2", "list of numbers"]),
        ("<rect width='9' height='9' fill='blak'/>", ["fill=\"blak\"", "a colour"]),
        ("<rect width='9' height='9' style='stroke:#12'/>", ["stroke=\"#12\"", "a colour"]),
        ("<rect width='9' height='9' stroke-width='-1'/>", ["stroke-width=\"-1\"", "0 or more"]),
        ("<rect width='9' height='9' stroke-dasharray='1 -1'/>", ["stroke-dasharray", "0 or more"]),
        ("<rect width='9' height='9' opacity='half'/>", ["opacity=\"half\"", "from 0 to 1"]),
        ("<g transform='rotate(1,2'><rect width='9' height='9'/></g>", ["<g> on line 2", "transform"]),
        ("<g transform='scale(0)'><rect width='9' height='9'/></g>", ["<g> on line 2", "flattens"]),
        ("<rect width='9' height='9' style='fill red;stroke:red'/>", ["<rect> on line 2", "style"]),
        ("<symbol id='s' viewBox='0 0 0 5'/><use href='#s'/>", ["<symbol id=\"s\"> on line 2", "viewBox"]),
    ] {
        refuses(&format!("{body}{SQUARE}"), &wanted);
    }
}

#[test]
fn broken_links_are_named() {
    for (body, wanted) in [
        ("<use href='#no'/>", ["<use> on line 2", "\"#no\", which does not exist"]),
        ("<use href='other.svg#a'/>", ["<use> on line 2", "not in this file"]),
        ("<use/>", ["<use> on line 2", "not in this file"]),
        ("<filter id='f'/><use href='#f'/>", ["<use> on line 2", "nothing that can be drawn"]),
        ("<rect width='9' height='9' fill='url(#no)'/>", ["<rect> on line 2", "fill refers to \"no\""]),
        ("<g clip-path='url(#no)'/>", ["<g> on line 2", "clip-path refers to"]),
        ("<g clip-path='circle(5px)'/>", ["<g> on line 2", "url(#id)"]),
        ("<path d='M0 0h9v9' marker-mid='url(#no)'/>", ["<path> on line 2", "marker-mid refers to"]),
        ("<g id='a'><use href='#a'/></g>", ["<use> on line 2", "uses itself"]),
        ("<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>", ["uses itself", "remove one"]),
    ] {
        refuses(&format!("{body}{SQUARE}"), &wanted);
    }
}

#[test]
fn nothing_drawn_and_no_area() {
    refuses("", &["draws nothing"]);
    refuses("<g/><defs><path d='M0 0h9v9'/></defs>", &["draws nothing"]);
    refuses("<path d='M0 0h9v9' fill='none'/>", &["has no filled area"]);
    refuses("\n<path id='l' d='M0 0 L9 9 L5 5'/>", &["<path id=\"l\"> on line 3", "no area"]);
    // The implicit fill of a stroked line is no mistake of anyone's.
    assert_eq!(counts("<path d='M10 10 L90 10' stroke='black'/>"), (1, 0));
    // An open path encloses the area that its implicit closing gives it.
    assert_close(area("<path d='M10 10 H50 V50'/>"), 800.0, 1e-2);
}

#[test]
fn files_that_are_no_svg() {
    let read = |bytes: &[u8]| Exemplar::from_svg("f.svg", bytes, &ReadOptions::default()).unwrap_err();
    assert_says(&read(b""), &["f.svg: is empty"]);
    assert_says(&read(b" \n "), &["f.svg: is empty"]);
    assert_says(&read(b"<svg>\n<g></svg>"), &["f.svg", "not well-formed XML", "2:"]);
    assert_says(&read(b"solid teapot"), &["not well-formed XML"]);
    assert_says(&read(b"<html/>"), &["root is <html>", "not <svg>"]);
    assert_says(&read(b"<svg>\n\xff</svg>"), &["not UTF-8", "line 2"]);
    assert_says(&read(&[0x1f, 0x8b, 8, 0]), &["gzip", "gunzip"]);
    assert_says(&read(b"<svg width='0' height='9'/>"), &["<svg> on line 1", "not positive"]);
    let entity = b"<!DOCTYPE svg [\n<!ENTITY a SYSTEM 'file:///etc/passwd'>]><svg>&a;</svg>";
    let error = read(entity);
    assert!(error.to_string().contains("ENTITY") || error.to_string().contains("entity"), "{error}");
    assert_says(
        &read(b"<!DOCTYPE svg [\n<!ENTITY a 'b'>]><svg id='&a;'/>"),
        &["<!ENTITY> on line 2", "plain SVG"],
    );
    assert_says(&read(b"<?xml-stylesheet href='a.css'?>\n<svg/>"), &["style sheet", "line 1"]);
    let doctype =
        "<!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd'>";
    assert!(read_raw(&format!("{doctype}{}", page(SQUARE))).is_ok());
}

#[test]
fn files_on_disk() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("vine.svg");
    let error = Exemplar::read(&file, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error.fault(), ExemplarFault::Missing));
    assert_says(&error, &["vine.svg: there is no such file"]);
    let error = Exemplar::read(dir.path(), &ReadOptions::default()).unwrap_err();
    assert!(matches!(error.fault(), ExemplarFault::Unreadable(_)), "{error}");
    std::fs::write(&file, page(SQUARE)).unwrap();
    assert_eq!(Exemplar::read(&file, &ReadOptions::default()).unwrap().name(), "vine");
}

#[test]
fn every_limit_has_its_error() {
    let with = |limits: Limits, body: &str| {
        let options = ReadOptions { limits, ..ReadOptions::default() };
        Exemplar::from_svg("test", page(body).as_bytes(), &options).unwrap_err()
    };
    let all = Limits::default();
    assert_says(&with(Limits { bytes: 100, ..all }, SQUARE), &["limit of 100 bytes"]);
    assert_says(&with(Limits { elements: 3, ..all }, &SQUARE.repeat(3)), &["more than 3 elements"]);
    assert_says(&with(Limits { elements: 3, ..all }, &SQUARE.repeat(300)), &["more than 3 elements"]);
    assert_says(
        &with(Limits { nesting: 4, ..all }, "<g><g><g><g/></g></g></g>"),
        &["<g> on line 2", "4 levels"],
    );
    assert_says(
        &with(Limits { segments: 20, ..all }, &SQUARE.repeat(3)),
        &["<rect> on line 2", "20 path segments"],
    );
    assert_says(
        &with(Limits { vertices: 20, ..all }, "<circle r='9'/>"),
        &["<circle> on line 2", "20 vertices"],
    );
    assert_says(&with(Limits { coordinate: 20.0, ..all }, SQUARE), &["range", "2e1 user units"]);
    let far = "<rect width='2e8' height='2e8'/>";
    assert_says(&with(all, far), &["<rect> on line 2", "1e5 mm"]);
    let dust = "<path d='M0 0H90' fill='none' stroke='black' stroke-dasharray='0.000001'/>";
    assert_says(&with(all, dust), &["<path> on line 2", "4000000 path segments"]);
    let imprecise = "<g transform='translate(-1000000)'><rect x='1000000' width='9' height='9'/></g>";
    assert_says(&with(all, imprecise), &["<rect> on line 2", "away from the origin"]);
}

#[test]
fn uses_cannot_explode_and_depth_cannot_overflow() {
    let mut bomb = "<defs><g id='a0'><rect width='1' height='1'/></g>".to_owned();
    for i in 1..30 {
        let last = i - 1;
        write!(bomb, "<g id='a{i}'><use href='#a{last}'/><use href='#a{last}'/></g>").unwrap();
    }
    refuses(&format!("{bomb}</defs><use href='#a29'/>"), &["more than 200000 elements"]);
    refuses(&"<g>".repeat(100_000), &["not well-formed XML"]);
    let deep = format!("{}{SQUARE}{}", "<g>".repeat(100_000), "</g>".repeat(100_000));
    refuses(&deep, &["<g> on line 2", "256 levels"]);
    let marker = format!("<marker id='m'>{}</marker>", SQUARE.repeat(100));
    let bomb = format!("{marker}<path marker-mid='url(#m)' d='M0 0{}'/>", "h1v1".repeat(25_000));
    refuses(&bomb, &["<marker id=\"m\"> on line 2", "4000000 path segments"]);
    let inner = "<marker id='m'><path marker-mid='url(#m)' d='M0 0h1'/></marker><path marker-mid='url(#m)' d='M0 0h9v9'/>";
    refuses(inner, &["<path> on line 2", "markers inside of a marker"]);
    let chain: String = (1..140).map(|i| format!("<g id='c{i}'><use href='#c{}'/></g>", i - 1)).collect();
    refuses(&format!("<defs><g id='c0'>{SQUARE}</g>{chain}</defs><use href='#c139'/>"), &["256 levels"]);
    assert_eq!(counts(&format!("<defs><g id='c0'>{SQUARE}</g>{chain}</defs><use href='#c120'/>")), (1, 0));
    let allowed = format!("{}{SQUARE}{}", "<g>".repeat(250), "</g>".repeat(250));
    assert_eq!(counts(&allowed), (1, 0));
}

#[test]
fn a_path_of_200_000_segments() {
    // A comb: every tooth is four segments.
    let mut d = "M0 0".to_owned();
    for _ in 0..50_000 {
        d.push_str("v40h.001v-40h.001");
    }
    d.push_str("v50H0z");
    let svg = page(&format!("<path d='{d}'/>"));
    assert_eq!(read_raw(&svg).unwrap().region().components(), 1);
    // Curves, in many separate rings.
    let mut d = String::new();
    for i in 0..25_000 {
        let (x, y) = (f64::from(i % 160) * 0.6, f64::from(i / 160) * 0.6);
        write!(d, "M{x} {y}q.4 0 .4 .4t-.4-.4q0 .4 .4 .4q0 -.4 -.4 -.4h.5v.5h-.5z").unwrap();
    }
    assert_eq!(read_raw(&page(&format!("<path d='{d}'/>"))).unwrap().region().components(), 25_000);
}

#[test]
fn guide_paths() {
    let svg = page(
        "<defs><path id='def' d='M0 0h1'/></defs><text>ignored</text><g transform='translate(10 0)'>\
         <path id='a' d='M0 10 C 5 10 10 20 20 30' fill='none'/><circle id='b' cx='30' cy='30' r='10'/>\
         <path id='c' d='M0 0h1M2 2h1'/><path id='bad' d='M0 0h1 x'/><g id='g'/></g>",
    );
    let path = |id: Option<&str>| path_from_svg("guide.svg", svg.as_bytes(), id, &Limits::default());
    let a = path(Some("a")).unwrap();
    let first = kurbo::PathSeg::Cubic(kurbo::CubicBez::new((10., 90.), (15., 90.), (20., 80.), (30., 70.)));
    let found = a.segments().next().unwrap();
    assert!((found.to_cubic().p2 - first.to_cubic().p2).hypot() < 1e-4, "{found:?}");
    assert_eq!(path(Some("b")).unwrap().elements().last(), Some(&kurbo::PathEl::ClosePath));
    assert_says(&path(None).unwrap_err(), &["guide.svg: holds 4 paths", "a, b, c, bad"]);
    assert_says(&path(Some("no")).unwrap_err(), &["no element with the id \"no\"", "a, b, c, bad"]);
    assert_says(&path(Some("g")).unwrap_err(), &["<g id=\"g\"> on line 2 is not a path"]);
    assert_says(&path(Some("c")).unwrap_err(), &["<path id=\"c\">", "2 subpaths", "Break Apart"]);
    assert_says(&path(Some("bad")).unwrap_err(), &["<path id=\"bad\">", "beyond segment 2"]);
    assert_says(&path(Some("def")).unwrap_err(), &["<path id=\"def\">", "<defs>", "top level"]);
    let only = page("<line x1='10' y1='20' x2='30' y2='20'/>");
    let line = path_from_svg("g", only.as_bytes(), None, &Limits::default()).unwrap();
    assert_eq!(line.segments().count(), 1);
    let error = read_path(Path::new("no/such.svg"), None, &Limits::default()).unwrap_err();
    assert_says(&error, &["no/such.svg", "no such file"]);
    let error = path_from_svg("g", page("<g/>").as_bytes(), None, &Limits::default()).unwrap_err();
    assert_says(&error, &["draws nothing"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Rectangles nested in each other, filled even-odd, alternate between ink and gap whatever their windings,
    /// and the same under any rotation.
    #[test]
    fn nested_rectangles(stacks in prop::collection::vec((1usize..7, any::<u8>()), 1..5), turn in 0.0..360.0) {
        let mut d = String::new();
        let (mut components, mut holes) = (0, 0);
        for (i, &(depth, windings)) in stacks.iter().enumerate() {
            for level in 0..depth {
                let (low, side) = (level as f64, 18.0 - 2.0 * level as f64);
                let x = 20.0 * i as f64 + low;
                if windings >> level & 1 == 0 {
                    write!(d, "M{x} {low}h{side}v{side}h-{side}z").unwrap();
                } else {
                    write!(d, "M{x} {low}v{side}h{side}v-{side}z").unwrap();
                }
            }
            components += depth.div_ceil(2);
            holes += depth / 2;
        }
        let body = format!("<g transform='rotate({turn} 50 50)'><path fill-rule='evenodd' d='{d}'/></g>");
        prop_assert_eq!(counts(&body), (components, holes));
    }

    /// Reading never panics, whatever bytes follow the opening of a drawing.
    #[test]
    fn arbitrary_text_is_read_or_refused(body in "[<>/='\"#a-z0-9 .-]{0,120}", d in "[MmLlHhVvCcSsQqTtAaZz0-9 .,e-]{0,80}") {
        let _ = read_raw(&page(&body)).map_err(|e| assert!(!e.to_string().is_empty()));
        let path = page(&format!("<path stroke='black' d='{d}'/>"));
        let _ = read_raw(&path).map_err(|e| assert!(!e.to_string().is_empty()));
    }
}
