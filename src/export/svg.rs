//! The SVG writer: a region as compound paths of fitted curves, one for each component.
//!
//! The curves are those of [`super::outlines`], which keep the region's components and holes. Excluded: strokes, transforms, colours, text, and where on the page the ornament is put.

use std::fmt::Write;

use glam::DVec2;

use super::ExportError;
use super::curves::Rounding;
use super::outline::{Arc, Outline, Segment};
use super::outlines::{Curves, outlines};
use super::text::{Escaped, Number};
use crate::planar::Region;

/// How a region becomes an SVG file.
#[derive(Debug, Clone, PartialEq)]
pub struct SvgOptions {
    /// Width of the page in millimetres.
    pub width_mm: f64,
    /// Height of the page in millimetres. The region lies on the page with y up from the lower left corner;
    /// curves may pass the region's bounds by the chord, so leave at least that as a margin.
    pub height_mm: f64,
    /// The greatest distance, either way, between the region's boundary and the file's curves.
    pub chord_mm: f64,
    /// The document's `<title>`.
    pub title: Option<String>,
    /// The document's `<desc>`, for how it was made.
    pub description: Option<String>,
}

/// An SVG document and what it is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SvgDocument {
    /// The text of the file.
    pub text: String,
    /// Straight segments.
    pub lines: usize,
    /// Cubic Béziers.
    pub cubics: usize,
}

/// `region` as an SVG document at 1:1 in millimetres: one `<path>` for each component, even-odd, absolute
/// `M`, `L`, `C` and `Z` only, y down. Smooth stretches are cubic Béziers within the chord tolerance of the
/// region, corners stay corners and straight lines straight, and the curves have the components and holes
/// of the region. The same region and options give the same bytes.
///
/// # Errors
/// [`ExportError::Option`] for a page or chord that is no length, [`ExportError::OffPage`] when ink lies
/// beyond the page.
pub fn svg(region: &Region, options: &SvgOptions) -> Result<SvgDocument, ExportError> {
    check(region.bounds_mm(), options)?;
    let outlines = outlines(region, Curves::Spline, options.chord_mm);

    let page = rounded_page(options, Rounding::on(region.grid()).decimals(options.chord_mm));
    let mut text = open_document(page, "", options);
    let mut outlines_left = outlines.as_slice();
    for part in region.parts() {
        let (own, rest) = outlines_left.split_at(1 + part.holes().len());
        outlines_left = rest;
        text.push_str("<path fill=\"#000\" fill-rule=\"evenodd\" d=\"");
        for (i, outline) in own.iter().enumerate() {
            if i > 0 {
                text.push('\n');
            }
            write_outline(&mut text, outline, page[1]);
        }
        text.push_str("\"/>\n");
    }
    text.push_str("</svg>\n");

    let count = |wanted: fn(&Segment) -> bool| {
        outlines.iter().flat_map(|o| &o.segments).filter(|s| wanted(s)).count()
    };
    Ok(SvgDocument {
        text,
        lines: count(|s| matches!(s, Segment::Line(_))),
        cubics: count(|s| matches!(s, Segment::Cubic(..))),
    })
}

/// Width and height of the page, rounded up: a page with decimals of the chord keeps the decimals of what is subtracted
/// from it.
pub(super) fn rounded_page(options: &SvgOptions, decimals: i32) -> [f64; 2] {
    let scale = 10f64.powi(decimals);
    [options.width_mm, options.height_mm].map(|mm| (mm * scale).ceil() / scale)
}

/// The head of a document, with more attributes of the root element.
pub(super) fn open_document(page: [f64; 2], attributes: &str, options: &SvgOptions) -> String {
    let [width, height] = page.map(Number);
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\"{attributes}>"
    );
    for (tag, content) in [("title", &options.title), ("desc", &options.description)] {
        if let Some(content) = content {
            let _ = writeln!(text, "<{tag}>{}</{tag}>", Escaped(content));
        }
    }
    text
}

/// Refuses a page or chord that is no length, and what lies beyond the page.
pub(super) fn check(bounds_mm: Option<(DVec2, DVec2)>, options: &SvgOptions) -> Result<(), ExportError> {
    let lengths =
        [("page width", options.width_mm), ("page height", options.height_mm), ("chord", options.chord_mm)];
    for (name, found) in lengths {
        if !(1e-6..=1e6).contains(&found) {
            return Err(ExportError::Option { name, found, wanted: "a length from 0.000001 to 1000000 mm" });
        }
    }
    let page = DVec2::new(options.width_mm, options.height_mm);
    let slack = options.chord_mm;
    match bounds_mm {
        Some((low, high)) if low.min_element() < -slack || (high - page).max_element() > slack => {
            Err(ExportError::OffPage { low_mm: low, high_mm: high, page_mm: page })
        }
        _ => Ok(()),
    }
}

/// Adds the outline to path data, y down from `height`.
pub(super) fn write_outline(text: &mut String, outline: &Outline, height: f64) {
    let flip = |p: DVec2| (Number(p.x), Number(height - p.y));
    let (x, y) = flip(outline.start);
    let _ = write!(text, "M{x} {y}");
    for (i, segment) in outline.segments.iter().enumerate() {
        match *segment {
            // Closing the path draws the last line.
            Segment::Line(_) if i + 1 == outline.segments.len() => {}
            Segment::Line(end) => {
                let (x, y) = flip(end);
                let _ = write!(text, "L{x} {y}");
            }
            Segment::Arc(to, bulge) => {
                let from = outline.segments[(i + outline.segments.len() - 1) % outline.segments.len()].end();
                let radius = Number(Arc { from, to, bulge }.radius());
                // What turns to the left with y up does so counter-clockwise, which is against SVG's angles.
                let sweep = u8::from(bulge < 0.0);
                let (x, y) = flip(to);
                let _ = write!(text, "A{radius} {radius} 0 0 {sweep} {x} {y}");
            }
            Segment::Cubic(a, b, end) => {
                let ((ax, ay), (bx, by), (x, y)) = (flip(a), flip(b), flip(end));
                let _ = write!(text, "C{ax} {ay} {bx} {by} {x} {y}");
            }
        }
    }
    text.push('Z');
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::planar::{EdgeIndex, FillRule, Grid};

    const CHORD: f64 = 0.01;

    fn options() -> SvgOptions {
        SvgOptions { width_mm: 60.0, height_mm: 40.0, chord_mm: CHORD, title: None, description: None }
    }

    fn region(paths: &[Vec<DVec2>]) -> Region {
        let grid = Grid::for_extent(60.0).unwrap();
        let snap = |p: &DVec2| grid.snap(*p).unwrap();
        let paths: Vec<Vec<_>> = paths.iter().map(|p| p.iter().map(snap).collect()).collect();
        Region::fill(grid, &paths, FillRule::EvenOdd)
    }

    fn circle(x: f64, y: f64, radius: f64) -> Vec<DVec2> {
        let n = (std::f64::consts::TAU / (4.0 * CHORD / radius).sqrt()).ceil() as u32;
        let turn = std::f64::consts::TAU / f64::from(n);
        (0..n).map(|i| DVec2::new(x, y) + radius * DVec2::from_angle(turn * f64::from(i))).collect()
    }

    fn rectangle(x: f64, y: f64, w: f64, h: f64) -> Vec<DVec2> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(DVec2::from).to_vec()
    }

    /// The file's paths as another library reads them, with y up, flattened finely.
    fn read_back(document: &SvgDocument) -> Region {
        read_within(document, CHORD / 50.0)
    }

    fn read_within(document: &SvgDocument, tolerance: f64) -> Region {
        let tree = roxmltree::Document::parse(&document.text).unwrap();
        let grid = Grid::for_extent(60.0).unwrap();
        let mut contours = Vec::new();
        for path in tree.descendants().filter(|n| n.has_tag_name("path")) {
            let curves = kurbo::BezPath::from_svg(path.attribute("d").unwrap()).unwrap();
            kurbo::flatten(curves, tolerance, |element| match element {
                kurbo::PathEl::MoveTo(p) => contours.push(vec![DVec2::new(p.x, 40.0 - p.y)]),
                kurbo::PathEl::LineTo(p) => contours.last_mut().unwrap().push(DVec2::new(p.x, 40.0 - p.y)),
                _ => {}
            });
        }
        let snapped: Vec<Vec<_>> =
            contours.iter().map(|c| c.iter().map(|&p| grid.snap(p).unwrap()).collect()).collect();
        Region::fill(grid, &snapped, FillRule::EvenOdd)
    }

    /// The greatest distance of a point of `a`'s boundary from that of `b`.
    fn distance(a: &Region, b: &Region) -> f64 {
        let index = EdgeIndex::new(b);
        let mut worst: f64 = 0.0;
        for (p, q) in a.contours().flat_map(|c| c.edges()) {
            let (p, q) = (a.grid().to_mm(p), a.grid().to_mm(q));
            for k in 0..8 {
                let point = p.lerp(q, f64::from(k) / 8.0);
                worst = worst.max(index.nearest(point).unwrap().nearest(point).distance(point));
            }
        }
        worst
    }

    fn wave(phase: f64) -> Vec<DVec2> {
        let at = |i: u32, lift: f64| {
            let x = 0.1 * f64::from(i);
            DVec2::new(x, 20.0 + 8.0 * (x / 4.0 + phase).sin() + 2.0 * (x * 1.3).cos() + lift)
        };
        (10..=580).map(|i| at(i, 0.0)).chain((10..=580).rev().map(|i| at(i, 1.0))).collect()
    }

    #[test]
    fn the_file_is_within_the_chord_both_ways() {
        for paths in [
            vec![wave(0.0)],
            vec![circle(30.0, 20.0, 19.0), circle(30.0, 20.0, 18.9), circle(20.0, 20.0, 0.03)],
            vec![rectangle(1.0, 1.0, 58.0, 38.0), wave(1.0)],
        ] {
            let region = region(&paths);
            let document = svg(&region, &options()).unwrap();
            let back = read_back(&document);
            assert_eq!((back.components(), back.holes()), (region.components(), region.holes()));
            // Snapping of the region's own retreats aside, nothing is allowed for.
            assert!(distance(&region, &back) <= CHORD, "{}", distance(&region, &back));
            assert!(distance(&back, &region) <= CHORD, "{}", distance(&back, &region));
            assert!(document.cubics < region.vertices() / 4, "{} cubics", document.cubics);
        }
    }

    #[test]
    fn contours_closer_than_the_chord_stay_apart() {
        // Rings of which ink and gaps are a tenth of the chord; their fits need not match.
        let rings: Vec<_> = (0..6).map(|i| circle(30.0, 20.0, 10.0 + 0.1 * CHORD * f64::from(i))).collect();
        let rings = region(&rings);
        assert_eq!((rings.components(), rings.holes()), (3, 3));
        let back = read_back(&svg(&rings, &options()).unwrap());
        assert_eq!((back.components(), back.holes()), (3, 3));
        // A wave that comes within a hundredth of the chord of a line.
        let top = wave(0.0).iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let near = region(&[wave(0.0), rectangle(1.0, top + 0.01 * CHORD, 57.0, 1.0)]);
        assert_eq!(near.components(), 2);
        let document = svg(&near, &options()).unwrap();
        assert_eq!(read_back(&document).components(), 2);
        assert!(document.lines + document.cubics < 200, "only the place itself is exact");
    }

    #[test]
    fn specks_stay_even_for_coarse_readers() {
        let mut paths: Vec<_> = [0.005, 0.008, 0.011].map(|r| circle(1e3 * r, 20.0, r)).to_vec();
        paths.extend([rectangle(20.0, 5.0, 1.0, 5.9e-6), rectangle(30.0, 5.0, 0.0024, 0.0024)]);
        paths.extend([circle(30.0, 20.0, 9.0), circle(30.0, 20.0, 0.005)]);
        let region = region(&paths);
        assert_eq!((region.components(), region.holes()), (6, 1));
        let document = svg(&region, &options()).unwrap();
        for tolerance in [0.02, 0.5, 2.0, 20.0] {
            let back = read_within(&document, tolerance * CHORD);
            assert_eq!((back.components(), back.holes()), (6, 1), "read within {tolerance} chords");
        }
    }

    fn star() -> impl Strategy<Value = Vec<DVec2>> {
        let spokes = proptest::collection::vec(0.2..1.0f64, 3..60);
        (10.0..50.0, 10.0..30.0, 0.05..10.0, spokes).prop_map(|(x, y, radius, spokes)| {
            let turn = std::f64::consts::TAU / spokes.len() as f64;
            let spoke =
                |(i, s): (usize, &f64)| DVec2::new(x, y) + radius * s * DVec2::from_angle(turn * i as f64);
            spokes.iter().enumerate().map(spoke).collect()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn counts_and_chord_hold_for_any_region(
            stars in proptest::collection::vec(star(), 1..8),
            circles in proptest::collection::vec((10.0..50.0, 10.0..30.0, 0.02..9.0), 0..8),
        ) {
            let circles = circles.into_iter().map(|(x, y, radius)| circle(x, y, radius));
            let region = region(&stars.into_iter().chain(circles).collect::<Vec<_>>());
            let back = read_back(&svg(&region, &options()).unwrap());
            prop_assert_eq!((back.components(), back.holes()), (region.components(), region.holes()));
            prop_assert!(distance(&region, &back) <= CHORD);
            prop_assert!(distance(&back, &region) <= CHORD);
        }
    }

    #[test]
    fn a_square_is_four_lines_on_a_page_with_y_down() {
        let document = svg(&region(&[rectangle(1.0, 2.0, 10.0, 5.5)]), &options()).unwrap();
        assert_eq!((document.lines, document.cubics), (4, 0));
        assert!(document.text.contains(" width=\"60mm\" height=\"40mm\" viewBox=\"0 0 60 40\""));
        let path = "fill-rule=\"evenodd\" d=\"M1 32.5L1 38L11 38L11 32.5Z\"";
        assert!(document.text.contains(path), "{}", document.text);
    }

    #[test]
    fn components_are_paths_and_the_bytes_repeat() {
        let islands = region(&[circle(10.0, 10.0, 4.0), circle(10.0, 10.0, 2.0), circle(30.0, 10.0, 4.0)]);
        let document = svg(&islands, &options()).unwrap();
        assert_eq!(document.text.matches("<path").count(), 2);
        assert_eq!(document.text.matches('M').count(), 3);
        assert_eq!(svg(&islands, &options()).unwrap(), document);
    }

    #[test]
    fn texts_are_escaped() {
        let title = Some("a < b & \u{1}c".to_owned());
        let document = svg(&region(&[]), &SvgOptions { title, ..options() }).unwrap();
        assert!(document.text.contains("<title>a &lt; b &amp; \u{fffd}c</title>"));
        roxmltree::Document::parse(&document.text).unwrap();
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let square = region(&[rectangle(50.0, 2.0, 10.5, 5.5)]);
        assert!(matches!(svg(&square, &options()), Err(ExportError::OffPage { .. })));
        for chord_mm in [0.0, -1.0, f64::NAN] {
            let error = svg(&square, &SvgOptions { chord_mm, ..options() }).unwrap_err();
            assert!(error.to_string().starts_with("chord is "), "{error}");
        }
    }
}
