//! The SVG writer: a region as compound paths of fitted curves, one for each component.
//!
//! Every contour is fitted by itself and stays within the chord tolerance of its polygon, but two contours
//! that pass each other more closely than that may still cross. So the outlines are flattened finely, as
//! they will stand in the file, and checked as a region; where they fault, the tolerance of the polygon's
//! edges nearby is divided, down to the exact edges. The file therefore has the region's components and
//! holes. Excluded: strokes, transforms, colours, text, and where on the page the ornament is put.

use std::fmt::Write;

use glam::DVec2;

use super::ExportError;
use super::curves::{Rounding, fitted};
use super::outline::{Outline, Segment};
use super::runs::Polygon;
use crate::planar::{Contour, EdgeIndex, Region, RegionError};

/// How finely outlines are flattened for the check, as a part of the tolerance. Larger, and a crossing can
/// hide between the chords; smaller, and the check takes longer than everything else.
const CHECK_FLATTENING: f64 = 0.125;
/// What a fault does to the tolerance of the edges nearby.
const TIGHTENING: f64 = 0.25;
/// A tolerance below this part of the chord becomes zero, which keeps the edges themselves.
const EXACT_BELOW: f64 = 1e-3;
/// Rounds of tightening before all edges are kept: each round finds at least one fault in each contour.
const MAX_ROUNDS: usize = 60;

/// How a region becomes an SVG file.
#[derive(Debug, Clone, PartialEq)]
pub struct SvgOptions {
    /// Width of the page in millimetres.
    pub width_mm: f64,
    /// Height of the page in millimetres. The region lies on the page with y up from the lower left corner.
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
    check(region, options)?;
    let rounding = Rounding { exact: (-region.grid().step_mm().log10()).ceil() as i32 };
    let outlines = outlines(region, options.chord_mm, rounding);

    // A page rounded to decimals of the chord keeps the decimals of what is subtracted from it.
    let decimals = rounding.decimals(options.chord_mm);
    let scale = 10f64.powi(decimals);
    let page = [options.width_mm, options.height_mm].map(|mm| (mm * scale).ceil() / scale);
    let (width, height) = (Number(page[0]), Number(page[1]));
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">"
    );
    for (tag, content) in [("title", &options.title), ("desc", &options.description)] {
        if let Some(content) = content {
            let _ = writeln!(text, "<{tag}>{}</{tag}>", Escaped(content));
        }
    }
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

fn check(region: &Region, options: &SvgOptions) -> Result<(), ExportError> {
    let lengths =
        [("page width", options.width_mm), ("page height", options.height_mm), ("chord", options.chord_mm)];
    for (name, found) in lengths {
        if !(1e-6..=1e6).contains(&found) {
            return Err(ExportError::Option { name, found, wanted: "a length from 0.000001 to 1000000 mm" });
        }
    }
    let page = DVec2::new(options.width_mm, options.height_mm);
    let slack = options.chord_mm;
    match region.bounds_mm() {
        Some((low, high)) if low.min_element() < -slack || (high - page).max_element() > slack => {
            Err(ExportError::OffPage { low_mm: low, high_mm: high, page_mm: page })
        }
        _ => Ok(()),
    }
}

/// Fitted outlines of all contours, in their order, that make a region of the same components and holes.
fn outlines(region: &Region, chord_mm: f64, rounding: Rounding) -> Vec<Outline> {
    let grid = region.grid();
    let mut polygons: Vec<Polygon> = region
        .contours()
        .map(|c| Polygon {
            points: c.points().iter().map(|&p| grid.to_mm(p)).collect(),
            tolerances: vec![chord_mm; c.points().len()],
        })
        .collect();
    let fit = |polygon: &Polygon| {
        let (start, segments) = fitted(&polygon.runs(), rounding);
        Outline { start, segments }
    };
    let mut outlines: Vec<Outline> = polygons.iter().map(fit).collect();
    let mut index = None;
    for round in 0.. {
        let faults = faults(region, &outlines, chord_mm);
        if faults.is_empty() || round > MAX_ROUNDS {
            break;
        }
        let mut concerned = vec![false; polygons.len()];
        let edges = index.get_or_insert_with(|| EdgeIndex::new(region));
        for &fault in &faults {
            // An outline at the fault has its polygon within the tolerance of it.
            for edge in edges.within(fault, 1.5 * chord_mm) {
                let tolerance = &mut polygons[edge.contour].tolerances[edge.edge];
                if *tolerance > 0.0 {
                    *tolerance *= TIGHTENING;
                    if *tolerance < EXACT_BELOW * chord_mm {
                        *tolerance = 0.0;
                    }
                    concerned[edge.contour] = true;
                }
            }
        }
        if round == MAX_ROUNDS || !concerned.contains(&true) {
            for polygon in &mut polygons {
                polygon.tolerances.fill(0.0);
            }
            concerned.fill(true);
        }
        for i in (0..polygons.len()).filter(|&i| concerned[i]) {
            outlines[i] = fit(&polygons[i]);
        }
    }
    outlines
}

/// Where the outlines are not a region of the same components and holes.
fn faults(region: &Region, outlines: &[Outline], chord_mm: f64) -> Vec<DVec2> {
    let grid = region.grid();
    let mut contours = Vec::with_capacity(outlines.len());
    for outline in outlines {
        let points = outline.flattened(CHECK_FLATTENING * chord_mm);
        // Points beyond the grid's extent, and contours that lost their area, are faults like a crossing.
        let snapped: Result<Vec<_>, _> = points.iter().map(|&p| grid.snap(p)).collect();
        match snapped.ok().and_then(Contour::new) {
            Some(contour) => contours.push(contour),
            None => return vec![outline.start],
        }
    }
    match Region::from_contours(grid, contours) {
        Ok(found) if (found.components(), found.holes()) == (region.components(), region.holes()) => {
            Vec::new()
        }
        Ok(_) => outlines.iter().map(|o| o.start).collect(),
        Err(RegionError::Invalid { faults }) => faults.iter().map(|f| f.position_mm()).collect(),
        Err(RegionError::Grid(_)) => outlines.iter().map(|o| o.start).collect(),
    }
}

fn write_outline(text: &mut String, outline: &Outline, height: f64) {
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
            Segment::Cubic(a, b, end) => {
                let ((ax, ay), (bx, by), (x, y)) = (flip(a), flip(b), flip(end));
                let _ = write!(text, "C{ax} {ay} {bx} {by} {x} {y}");
            }
        }
    }
    text.push('Z');
}

/// A number with the decimals it has: no trailing zeros, no exponent, no minus before zero.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Twelve decimals are more than a rounded coordinate has, and fewer than show its binary tail.
        let digits = format!("{:.12}", self.0);
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if digits == "-0" { "0" } else { digits })
    }
}

/// Text as XML content; characters that XML cannot hold become U+FFFD.
struct Escaped<'a>(&'a str);

impl std::fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '\t' | '\n' => f.write_char(c)?,
                '\0'..='\x1f' | '\x7f' | '\u{fffe}' | '\u{ffff}' => f.write_char('\u{fffd}')?,
                _ => f.write_char(c)?,
            }
        }
        Ok(())
    }
}
