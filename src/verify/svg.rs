//! Counts what the paths of an SVG fill.

use std::fmt;

use glam::DVec2;
use roxmltree::{Document, ParsingOptions};
use rustc_hash::FxHashSet;
use schemars::JsonSchema;
use serde::Serialize;

use super::drawing::{Drawing, Shape};
use super::error::VerifyError;
use super::narrowest::{NarrowPlaces, Narrowest, narrow_places};
use super::{drawn, plain};
use crate::planar::{Contour, Fault, Grid, Region, RegionError};

/// The largest file that is read; larger ones are not ornaments but attacks on memory.
const MAX_BYTES: usize = 256 << 20;
/// The most elements that are read, for the same reason.
const MAX_NODES: u32 = 4_000_000;
/// Overlaps smaller than this part of the ink are rounding.
const OVERLAP_PART: f64 = 1e-9;

/// What an SVG holds. Lengths are millimetres from the page's lower left corner, y up.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SvgReport {
    /// The number of connected components of the ink.
    pub components: usize,
    /// The number of holes in them.
    pub holes: usize,
    /// The area of the ink.
    pub area_mm2: f64,
    /// The lower left and upper right corner of the ink; `None` when there is none.
    #[serde(serialize_with = "super::json::corners")]
    #[schemars(with = "Option<[[f64; 2]; 2]>")]
    pub bounds_mm: Option<(DVec2, DVec2)>,
    /// Width and height of the page.
    #[serde(serialize_with = "super::json::point")]
    #[schemars(with = "[f64; 2]")]
    pub page_mm: DVec2,
    /// The number of vertices after curves were made polygons.
    pub vertices: usize,
    /// The narrowest ink; `None` when there is no ink.
    pub min_feature: Option<Narrowest>,
    /// The narrowest gap; `None` when no gap would ever close.
    pub min_gap: Option<Narrowest>,
    /// What is not in order in the file, though it can be counted.
    pub faults: Vec<SvgFault>,
    /// The greatest distance between the file's curves and the polygons that were counted.
    pub chord_mm: f64,
    /// The ten narrowest places of ink and of gaps.
    #[serde(skip)]
    pub narrow_places: NarrowPlaces,
    /// The ink.
    #[serde(skip)]
    pub region: Region,
}

/// Something in an SVG that a cutter or a slicer may stumble over. It does not change the counts.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SvgFault {
    /// Contours cross or touch themselves or each other.
    Crossing {
        /// Where.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// A contour covers ink twice, or is a hole outside of any ink.
    Nesting {
        /// A point of the contour.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// Several elements paint the same area.
    Overlap {
        /// The area painted more than once.
        area_mm2: f64,
    },
    /// A subpath that is filled but not closed.
    Open {
        /// The element.
        element: String,
        /// Where the subpath begins.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// A subpath without area, or one whose loops cancel.
    Degenerate {
        /// The element.
        element: String,
        /// Where the subpath begins.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// Ink beyond the page.
    OutsidePage {
        /// A corner of the ink's bounding box that is beyond it.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
}

impl fmt::Display for SvgFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, p) = match self {
            Self::Crossing { position_mm } => ("contours cross or touch", position_mm),
            Self::Nesting { position_mm } => {
                ("a contour covers ink twice or is a hole in nothing", position_mm)
            }
            Self::Overlap { area_mm2 } => {
                return write!(f, "elements overlap: {area_mm2:.4} mm2 are painted twice");
            }
            Self::Open { element, position_mm } => {
                write!(f, "{element}: ")?;
                ("a filled subpath is not closed", position_mm)
            }
            Self::Degenerate { element, position_mm } => {
                write!(f, "{element}: ")?;
                ("a subpath has no area, or its loops cancel", position_mm)
            }
            Self::OutsidePage { position_mm } => ("ink reaches beyond the page", position_mm),
        };
        write!(f, "{what} at ({:.4}, {:.4}) mm", p.x, p.y)
    }
}

/// Reads an SVG and counts what its paths fill, with curves as polygons within `chord_mm`.
///
/// Every path is filled under its own rule, strokes are ink, and all is united; colours are not told apart,
/// white is ink too.
///
/// # Errors
/// [`VerifyError`] when the bytes are no SVG, or when something in it cannot be judged.
pub fn read_svg(bytes: &[u8], chord_mm: f64) -> Result<SvgReport, VerifyError> {
    let text = text(bytes)?;
    let document = parsed(text)?;
    count(&drawing(&document, chord_mm, false)?, chord_mm)
}

/// The text of a file that is not too large.
pub(super) fn text(bytes: &[u8]) -> Result<&str, VerifyError> {
    if bytes.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    std::str::from_utf8(bytes).map_err(|e| VerifyError::NotText { offset: e.valid_up_to() })
}

/// The document, if it is an SVG.
pub(super) fn parsed(text: &str) -> Result<Document<'_>, VerifyError> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| VerifyError::Xml { message: e.to_string() })?;
    let root = document.root_element().tag_name().name();
    if root != "svg" {
        return Err(VerifyError::NotSvg { found: root.to_owned() });
    }
    Ok(document)
}

/// What is drawn: areas, or cut `lines`.
pub(super) fn drawing(document: &Document<'_>, chord_mm: f64, lines: bool) -> Result<Drawing, VerifyError> {
    match plain::read(document, lines)? {
        Some(drawing) => Ok(drawing),
        None => drawn::read(document, chord_mm, lines),
    }
}

fn count(drawing: &Drawing, chord_mm: f64) -> Result<SvgReport, VerifyError> {
    let mut faults = Vec::new();
    let loops: Vec<_> = drawing.shapes.iter().map(|shape| shape.loops(chord_mm)).collect();
    let grid = grid(
        drawing,
        loops.iter().zip(&drawing.shapes).flat_map(|(loops, shape)| {
            loops.iter().flat_map(move |l| l.points.iter().map(move |&p| (p, shape)))
        }),
    )?;
    let mut filled = Vec::with_capacity(loops.len());
    let mut contours = Vec::new();
    for (shape, loops) in drawing.shapes.iter().zip(&loops) {
        let mut paths = Vec::with_capacity(loops.len());
        for l in loops {
            let path = shape.snap(grid, &l.points)?;
            if !shape.is_stroke {
                let (element, position_mm) = (shape.element.clone(), l.points[0]);
                match Contour::new(path.clone()) {
                    None => faults.push(SvgFault::Degenerate { element, position_mm }),
                    Some(contour) => {
                        contours.push(contour);
                        if !l.closed {
                            faults.push(SvgFault::Open { element, position_mm });
                        }
                    }
                }
            }
            paths.push(path);
        }
        filled.push(Region::fill(grid, &paths, shape.rule));
    }
    let painted_mm2: f64 = filled.iter().map(Region::area_mm2).sum();
    let region = match filled.len() {
        1 => filled.remove(0),
        _ => Region::union(grid, &filled),
    };
    let area_mm2 = region.area_mm2();
    if painted_mm2 - area_mm2 > OVERLAP_PART * painted_mm2 {
        faults.push(SvgFault::Overlap { area_mm2: painted_mm2 - area_mm2 });
    }
    faults.extend(contour_faults(&region, contours).into_iter().map(SvgFault::from));
    faults.extend(beyond_page(&region, drawing.page_mm, chord_mm));
    let narrow_places = narrow_places(&region, NarrowPlaces::WORST, f64::INFINITY, chord_mm);
    Ok(SvgReport {
        components: region.components(),
        holes: region.holes(),
        area_mm2,
        bounds_mm: region.bounds_mm(),
        page_mm: drawing.page_mm,
        vertices: region.vertices(),
        min_feature: narrow_places.ink.first().copied(),
        min_gap: narrow_places.gaps.first().copied(),
        faults,
        chord_mm,
        narrow_places,
        region,
    })
}

/// The grid for the page and everything drawn.
fn grid<'a>(
    drawing: &Drawing,
    points: impl Iterator<Item = (DVec2, &'a Shape)>,
) -> Result<Grid, VerifyError> {
    let mut extent_mm = drawing.page_mm.max_element().clamp(Grid::MIN_EXTENT_MM, Grid::MAX_EXTENT_MM);
    let probe = Grid::for_extent(extent_mm).expect("clamped to the range");
    for (p, shape) in points {
        probe.snap(p).map_err(|source| shape.misplaced(source))?;
        extent_mm = extent_mm.max(p.abs().max_element());
    }
    Ok(Grid::for_extent(extent_mm).expect("every coordinate was in range"))
}

/// Where the file's own contours are not those of the region that they fill.
pub(super) fn contour_faults(region: &Region, contours: Vec<Contour>) -> Vec<Fault> {
    let found: FxHashSet<&Contour> = region.contours().collect();
    let given: Vec<Contour> = contours.into_iter().map(|c| oriented(c, &found)).collect();
    if given.len() == found.len() && given.iter().all(|c| found.contains(c)) {
        return Vec::new();
    }
    match Region::from_contours(region.grid(), given) {
        Ok(_) => Vec::new(),
        Err(RegionError::Invalid { faults }) => faults,
        Err(RegionError::Grid(e)) => unreachable!("the contours are on the grid: {e}"),
    }
}

impl From<Fault> for SvgFault {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Crossing(position_mm) => Self::Crossing { position_mm },
            Fault::Nesting(position_mm) => Self::Nesting { position_mm },
        }
    }
}

/// A contour the way round in which it bounds the ink, if it does: a file may wind as it likes.
fn oriented(contour: Contour, found: &FxHashSet<&Contour>) -> Contour {
    if found.contains(&contour) {
        return contour;
    }
    let reversed = Contour::new(contour.points().iter().rev().copied().collect());
    reversed.filter(|r| found.contains(r)).unwrap_or(contour)
}

fn beyond_page(region: &Region, page_mm: DVec2, slack_mm: f64) -> Option<SvgFault> {
    let (low, high) = region.bounds_mm()?;
    let position_mm = if low.min_element() < -slack_mm {
        low
    } else if (high - page_mm).max_element() > slack_mm {
        high
    } else {
        return None;
    };
    Some(SvgFault::OutsidePage { position_mm })
}

impl fmt::Display for SvgReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "components   {}", self.components)?;
        writeln!(f, "holes        {}", self.holes)?;
        writeln!(f, "area         {:.3} mm2", self.area_mm2)?;
        writeln!(f, "page         {:.3} x {:.3} mm", self.page_mm.x, self.page_mm.y)?;
        for (name, narrowest) in [("min feature", &self.min_feature), ("min gap", &self.min_gap)] {
            match narrowest {
                Some(n) => {
                    let (w, p) = (n.width_mm, n.position_mm);
                    writeln!(f, "{name:<12} {w:.3} mm at ({:.3}, {:.3}) mm", p.x, p.y)?;
                }
                None => writeln!(f, "{name:<12} none")?,
            }
        }
        write!(f, "faults       {}", self.faults.len())?;
        self.faults.iter().take(super::shells::FAULTS_SHOWN).try_for_each(|fault| write!(f, "\n  {fault}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHORD: f64 = 0.01;

    /// A plain file with a page of 40 by 20 mm.
    fn plain(body: &str) -> String {
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20">{body}</svg>"#
        )
    }

    fn read(text: &str) -> SvgReport {
        read_svg(text.as_bytes(), CHORD).unwrap()
    }

    fn counts(text: &str) -> (usize, usize, usize) {
        let report = read(text);
        (report.components, report.holes, report.faults.len())
    }

    #[test]
    fn counts_a_plain_file() {
        let report = read(&plain(
            r##"<desc>two</desc><g fill="#000"><path id="a" fill-rule="evenodd" d="M1 1L11 1L11 11L1 11ZM3 3L9 3L9 9L3 9Z"/><path d="M20 1L22 1L22 3Z"/></g>"##,
        ));
        assert_eq!((report.components, report.holes), (2, 1));
        assert_eq!(report.faults, []);
        assert!((report.area_mm2 - 66.0).abs() < 1e-6);
        let (low, high) = report.bounds_mm.unwrap();
        assert!(low.distance(DVec2::new(1.0, 9.0)) < 1e-6 && high.distance(DVec2::new(22.0, 19.0)) < 1e-6);
        assert!((report.min_feature.unwrap().width_mm - 2.0 * 0.585_786).abs() < 1e-3);
        assert!((report.min_gap.unwrap().width_mm - 6.0).abs() < 1e-3);
    }

    #[test]
    fn curves_stay_within_the_chord() {
        let circle = "M15 10C15 12.7614 12.7614 15 10 15C7.2386 15 5 12.7614 5 10C5 7.2386 7.2386 5 10 5C12.7614 5 15 7.2386 15 10Z";
        let report = read(&plain(&format!(r#"<path d="{circle}"/>"#)));
        assert!((report.area_mm2 - 25.0 * std::f64::consts::PI).abs() < 10.0 * std::f64::consts::PI * CHORD);
        assert!((report.min_feature.unwrap().width_mm - 10.0).abs() < 2.0 * CHORD);
    }

    #[test]
    fn faults_are_named_and_do_not_change_the_counts() {
        let bow = read(&plain(r#"<path d="M0 0L4 4L4 0L0 8Z"/>"#));
        assert_eq!((bow.components, bow.holes), (2, 0));
        let near = |p: DVec2| p.distance(DVec2::new(8.0 / 3.0, 20.0 - 8.0 / 3.0)) < 1e-4;
        assert!(
            bow.faults.iter().any(|f| matches!(f, SvgFault::Crossing { position_mm } if near(*position_mm)))
        );
        let open = read(&plain(r#"<path id="tail" d="M1 1L5 1L5 5"/>"#));
        assert_eq!(open.components, 1);
        let text = open.faults[0].to_string();
        assert_eq!(text, "<path id=\"tail\">: a filled subpath is not closed at (1.0000, 19.0000) mm");
        let twice = read(&plain(r#"<path d="M0 0L4 0L4 4L0 4Z"/><path d="M0 0L4 0L4 4L0 4Z"/>"#));
        assert_eq!((twice.components, twice.holes), (1, 0));
        assert!(twice.faults.contains(&SvgFault::Overlap { area_mm2: 16.0 }), "{:?}", twice.faults);
        let out = read(&plain(r#"<path d="M38 1L42 1L42 5Z"/>"#));
        assert!(matches!(out.faults[..], [SvgFault::OutsidePage { .. }]));
        let flat = read(&plain(r#"<path d="M1 1L5 1L5 5ZM8 1L9 1Z"/>"#));
        assert!(matches!(flat.faults[..], [SvgFault::Degenerate { .. }]));
    }

    #[test]
    fn either_winding_is_in_order() {
        assert_eq!(counts(&plain(r#"<path d="M1 1L1 11L11 11L11 1ZM3 3L9 3L9 9L3 9Z"/>"#)), (1, 1, 0));
        assert_eq!(counts(&plain(r#"<path d="M1 1L11 1L11 11L1 11ZM3 3L3 9L9 9L9 3Z"/>"#)), (1, 1, 0));
    }

    #[test]
    fn other_files_are_resolved() {
        let shapes = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 100" width="200" height="100">
            <style>.hole { fill: none; stroke: #000; stroke-width: 4 }</style>
            <g transform="translate(10 10) scale(2)"><circle class="hole" cx="10" cy="10" r="8"/></g>
            <rect id="a" x="100" y="10" width="20" height="20"/>
            <use href="\x23a" x="40"/></svg>"#;
        let report = read(&shapes.replace("\\x23", "#"));
        assert_eq!((report.components, report.holes), (3, 1));
        let px = 25.4 / 96.0;
        assert!((report.page_mm - DVec2::new(200.0, 100.0) * px).length() < 1e-3);
        // The stroke is 8 px wide after scaling, the squares are 20 px.
        assert!((report.min_feature.unwrap().width_mm - 8.0 * px).abs() < 3.0 * CHORD);
    }

    #[test]
    fn both_readers_agree() {
        let body = r##"<path fill="#123456" d="M1 1C4 -1 8 4 11 1L11 11L1 11ZM3 5L9 5L9 9L3 9Z" fill-rule="evenodd"/>"##;
        let (exact, resolved) =
            (read(&plain(body)), read(&plain(&format!(r#"<g opacity="0.9">{body}</g>"#))));
        assert_eq!((exact.components, exact.holes), (resolved.components, resolved.holes));
        assert!((exact.area_mm2 - resolved.area_mm2).abs() < 1e-3);
    }

    #[test]
    fn what_cannot_be_judged_is_an_error() {
        let error = |text: &str| read_svg(text.as_bytes(), CHORD).unwrap_err();
        let text = error(&plain("<text id=\"t\">hello</text>")).to_string();
        assert_eq!(text, "<text id=\"t\"> on line 1: text cannot be counted; convert it to paths");
        assert!(matches!(error("<svg"), VerifyError::Xml { .. }));
        assert!(matches!(error("<html/>"), VerifyError::NotSvg { .. }));
        assert!(matches!(error(&plain(r#"<path d="M1 1Q"/>"#)), VerifyError::PathData { .. }));
        assert!(matches!(error(&plain(r#"<path d="M1 1L1e30 1L3 3Z"/>"#)), VerifyError::Coordinate { .. }));
        assert!(matches!(read_svg(b"\xff", CHORD), Err(VerifyError::NotText { offset: 0 })));
    }

    #[test]
    fn no_ink_is_nothing() {
        let report = read(&plain(""));
        assert_eq!((report.components, report.holes, report.bounds_mm), (0, 0, None));
        assert_eq!((report.min_feature, report.min_gap), (None, None));
    }

    #[test]
    fn json_has_stable_names() {
        let json = serde_json::to_value(read(&plain(r#"<path d="M0 0L4 4L4 0L0 8Z"/>"#))).unwrap();
        assert_eq!(json["components"], 2);
        assert_eq!(json["page_mm"], serde_json::json!([40.0, 20.0]));
        assert_eq!(json["faults"][0]["kind"], "crossing");
        assert!(json["min_feature"]["width_mm"].is_f64());
    }
}
