//! The analysis as a picture.
//!
//! One SVG serves both formats: the PNG is drawn from it, so that they cannot differ. Stripes behind the ink
//! tell the pieces apart. On each portal lie two bars side by side, one for each piece that meets there, in the
//! colour of the portal's component in that piece: equal colours facing each other across a piece are
//! connected in it. Units are thousandths of the ornament's longer side, y down.

use std::fmt::Write;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg;

use super::lettering;
use super::{Analysis, CriticalPointFound};
use crate::export::ExportError;

const PAPER: &str = "#f7f4ee";
const STRIPE: &str = "#ece4d5";
/// Kept ranges, behind the ink and on a bracket above and below it.
const KEPT: &str = "#cfe3d3";
const KEPT_LINE: &str = "#3f8a5d";
const INK: &str = "#34435f";
const CUT: &str = "#c2603f";
const TEXT: &str = "#4a4238";
const FAINT: &str = "#b9ad9a";
/// Colours of component labels, told apart on dark ink; after the last the first comes again.
const LABELS: [&str; 9] =
    ["#f4b63f", "#4cc9b4", "#ff8a70", "#79bdf2", "#b5dc63", "#f59fcb", "#b9a2f5", "#e6e0d2", "#d98f3e"];
/// Each event with its colour and its sign, drawn in a square from -1 to 1.
const EVENTS: [(&str, &str, &str); 4] = [
    ("begin", "#3aa76d", "M-1 0A1 1 0 1 1 1 0A1 1 0 1 1 -1 0Z"),
    ("end", "#d8453e", "M-.86 -.86H.86V.86H-.86Z"),
    ("split", "#2f8fd8", "M-1.1 0L.9 -1.1V1.1Z"),
    ("merge", "#9a5bd0", "M1.1 0L-.9 -1.1V1.1Z"),
];

/// The ornament's longer side.
const SIDE: f64 = 1000.0;
const MARGIN: f64 = 36.0;
/// Stripes and cuts reach beyond the ink by so much.
const OVERHANG: f64 = 12.0;
const TITLE_HEIGHT: f64 = 11.0;
const NUMBER_HEIGHT: f64 = 8.0;
const LEGEND_HEIGHT: f64 = 8.0;
/// From one row of numbers or of the legend to the next.
const ROW: f64 = 15.0;
/// Rows in which numbers are staggered; what fits in none is left out.
const NUMBER_ROWS: usize = 4;
/// The radius of the sign of an event, where there is room.
const SIGN: f64 = 4.6;
/// The radius of the sign of an event that is too small to be cut beside.
const SMALL_SIGN: f64 = 1.9;

/// The picture as an SVG document.
pub(super) fn svg(analysis: &Analysis) -> String {
    let layout = Layout::new(analysis);
    let (w, h) = (layout.width, layout.height);
    let mut svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.0}\" \
         height=\"{h:.0}\" viewBox=\"0 0 {w:.0} {h:.0}\">\n<rect width=\"{w:.0}\" height=\"{h:.0}\" fill=\"{PAPER}\"/>\n"
    );
    lettering::write(&mut svg, &title(analysis), (MARGIN, MARGIN + TITLE_HEIGHT), TITLE_HEIGHT, TEXT);
    let drawing = Drawing { analysis, layout: &layout };
    drawing.stripes(&mut svg);
    drawing.kept(&mut svg);
    drawing.numbers(&mut svg);
    drawing.ink(&mut svg);
    drawing.cuts(&mut svg);
    drawing.portals(&mut svg);
    drawing.events(&mut svg);
    layout.legend(&mut svg);
    svg.push_str("</svg>\n");
    svg
}

/// The picture as a PNG.
pub(super) fn png(analysis: &Analysis, longer_side: u32) -> Result<Vec<u8>, ExportError> {
    let wanted = 16..=16_384;
    if !wanted.contains(&longer_side) {
        let (name, wanted) = ("picture size", "from 16 to 16384 pixels");
        return Err(ExportError::Option { name, found: longer_side.into(), wanted });
    }
    let tree =
        usvg::Tree::from_str(&svg(analysis), &usvg::Options::default()).map_err(|_| ExportError::Picture)?;
    let (width, height) = (tree.size().width(), tree.size().height());
    let scale = longer_side as f32 / width.max(height);
    let pixels = |side: f32| ((side * scale).round() as u32).max(1);
    let mut picture = Pixmap::new(pixels(width), pixels(height)).ok_or(ExportError::Picture)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(|_| ExportError::Picture)
}

fn title(analysis: &Analysis) -> String {
    let [width, height] = analysis.size_mm;
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    format!(
        "{}   {width:.1} x {height:.1} mm   {}   {}   {}",
        analysis.name,
        plural(analysis.components, "component"),
        plural(analysis.holes, "hole"),
        plural(analysis.pieces.len(), "piece")
    )
}

/// A piece's number: its middle and its row, counted upwards.
struct Number {
    index: usize,
    x: f64,
    row: usize,
}

/// Where everything goes.
struct Layout {
    /// Units in a millimetre.
    scale: f64,
    left: f64,
    /// The top and the bottom of the ink.
    top: f64,
    bottom: f64,
    numbers: Vec<Number>,
    legend: Vec<(LegendItem, f64, usize)>,
    width: f64,
    height: f64,
}

impl Layout {
    fn new(analysis: &Analysis) -> Self {
        let [width_mm, height_mm] = analysis.size_mm;
        let scale = SIDE / width_mm.max(height_mm);
        let title = lettering::width(&title(analysis), TITLE_HEIGHT);
        let inner = (width_mm * scale).max(title).max(SIDE / 2.0);
        let left = MARGIN + (inner - width_mm * scale) / 2.0;
        let numbers = numbers(analysis, left, scale);
        let rows = 1 + numbers.iter().map(|n| n.row).max().unwrap_or(0);
        let top = MARGIN + TITLE_HEIGHT + (rows as f64 + 0.6) * ROW + OVERHANG;
        let bottom = top + height_mm * scale;
        let (legend, legend_rows) = legend(analysis, inner);
        let height = bottom + OVERHANG + (legend_rows as f64 + 0.6) * ROW + MARGIN;
        Self { scale, left, top, bottom, numbers, legend, width: inner + 2.0 * MARGIN, height }
    }

    fn x(&self, x_mm: f64) -> f64 {
        self.left + x_mm * self.scale
    }

    fn y(&self, y_mm: f64) -> f64 {
        self.bottom - y_mm * self.scale
    }

    fn legend(&self, svg: &mut String) {
        for (item, x, row) in &self.legend {
            let y = self.bottom + OVERHANG + (*row as f64 + 1.4) * ROW;
            item.draw(svg, *x, y - LEGEND_HEIGHT * 0.4);
            let at = (x + item.sign_width() + 5.0, y);
            lettering::write(svg, item.text(), at, LEGEND_HEIGHT, TEXT);
        }
    }
}

/// Places numbers in the lowest row where they are free of their neighbours.
fn numbers(analysis: &Analysis, left: f64, scale: f64) -> Vec<Number> {
    let mut taken = [f64::NEG_INFINITY; NUMBER_ROWS];
    let mut numbers = Vec::new();
    for piece in &analysis.pieces {
        let x = left + (piece.x_mm + piece.width_mm / 2.0) * scale;
        let half = lettering::width(&piece.index.to_string(), NUMBER_HEIGHT) / 2.0;
        if let Some(row) = (0..NUMBER_ROWS).find(|&row| x - half > taken[row]) {
            taken[row] = x + half + 0.6 * NUMBER_HEIGHT;
            numbers.push(Number { index: piece.index, x, row });
        }
    }
    numbers
}

struct Drawing<'a> {
    analysis: &'a Analysis,
    layout: &'a Layout,
}

impl Drawing<'_> {
    fn stripes(&self, svg: &mut String) {
        let l = self.layout;
        let (top, height) = (l.top - OVERHANG, l.bottom - l.top + 2.0 * OVERHANG);
        for piece in self.analysis.pieces.iter().skip(1).step_by(2) {
            let (x, width) = (l.x(piece.x_mm), piece.width_mm * l.scale);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{STRIPE}\"/>"
            );
        }
    }

    fn kept(&self, svg: &mut String) {
        let l = self.layout;
        let (top, bottom) = (l.top - OVERHANG, l.bottom + OVERHANG);
        for &[from, to] in &self.analysis.kept_mm {
            let (x, width) = (l.x(from), (to - from) * l.scale);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{:.2}\" fill=\"{KEPT}\"/>\n\
                 <path d=\"M{x:.2} {top:.2}h{width:.2}M{x:.2} {bottom:.2}h{width:.2}\" stroke=\"{KEPT_LINE}\" \
                 stroke-width=\"2\"/>",
                bottom - top
            );
        }
    }

    fn numbers(&self, svg: &mut String) {
        let foot = self.layout.top - OVERHANG;
        for number in &self.layout.numbers {
            let y = foot - 4.0 - number.row as f64 * ROW;
            if number.row > 0 {
                let _ = writeln!(
                    svg,
                    "<path d=\"M{x:.2} {from:.2}V{foot:.2}\" stroke=\"{FAINT}\" stroke-width=\".5\"/>",
                    x = number.x,
                    from = y + 3.0
                );
            }
            let text = number.index.to_string();
            let x = number.x - lettering::width(&text, NUMBER_HEIGHT) / 2.0;
            lettering::write(svg, &text, (x, y), NUMBER_HEIGHT, TEXT);
        }
    }

    fn ink(&self, svg: &mut String) {
        let region = &self.analysis.region;
        let Some((low, _)) = region.bounds_mm() else { return };
        let _ = write!(svg, "<path fill=\"{INK}\" fill-rule=\"evenodd\" d=\"");
        for contour in region.contours() {
            for (i, &p) in contour.points().iter().enumerate() {
                let at = region.grid().to_mm(p) - low;
                let verb = if i == 0 { 'M' } else { 'L' };
                let _ = write!(svg, "{verb}{:.2} {:.2}", self.layout.x(at.x), self.layout.y(at.y));
            }
            svg.push_str("Z\n");
        }
        svg.push_str("\"/>\n");
    }

    fn cuts(&self, svg: &mut String) {
        let (from, to) = (self.layout.top - OVERHANG, self.layout.bottom + OVERHANG);
        let mut line = |x_mm: f64, style: &str| {
            let x = self.layout.x(x_mm);
            let _ = writeln!(svg, "<path d=\"M{x:.2} {from:.2}V{to:.2}\" stroke=\"{CUT}\" {style}/>");
        };
        for cut in &self.analysis.cuts {
            line(cut.x_mm, CUT_STYLE);
        }
        for cut in &self.analysis.dropped_cuts {
            line(cut.x_mm, DROPPED_STYLE);
        }
    }

    fn portals(&self, svg: &mut String) {
        let pieces = &self.analysis.pieces;
        for (i, cut) in self.analysis.cuts.iter().enumerate() {
            let x = self.layout.x(cut.x_mm);
            let sides = [(&pieces[i].descriptor.right, -1.0), (&pieces[i + 1].descriptor.left, 1.0)];
            for ((labels, side), piece) in sides.into_iter().zip(&pieces[i..]) {
                let width = bar_width(piece.width_mm * self.layout.scale);
                for (portal, &label) in cut.endpoints_mm.chunks_exact(2).zip(labels) {
                    let (top, bottom) = (self.layout.y(portal[0]), self.layout.y(portal[1]));
                    bar(svg, if side < 0.0 { x - width } else { x }, (top, bottom), width, label);
                }
            }
        }
    }

    fn events(&self, svg: &mut String) {
        // The events that matter lie on top of the others.
        let (large, small): (Vec<_>, Vec<_>) =
            self.analysis.critical_points.iter().partition(|p| p.makes_cuts);
        let crowding = (large.len() as f64 / 80.0).sqrt().clamp(1.0, 2.2);
        let mut draw = |points: Vec<&CriticalPointFound>, radius: f64| {
            for p in points {
                sign(svg, p.event, (self.layout.x(p.x_mm), self.layout.y(p.y_mm)), radius);
            }
        };
        draw(small, SMALL_SIGN.min(SIGN / crowding));
        draw(large, SIGN / crowding);
    }
}

const CUT_STYLE: &str = "stroke-width=\".8\"";
const DROPPED_STYLE: &str = "stroke-width=\".8\" stroke-dasharray=\"3 3\"";

/// The width of the bar of a portal on one side of a cut, by the width of the piece there.
fn bar_width(piece: f64) -> f64 {
    (0.2 * piece).clamp(0.4, 3.2)
}

fn bar(svg: &mut String, x: f64, (top, bottom): (f64, f64), width: f64, label: u16) {
    let colour = LABELS[usize::from(label) % LABELS.len()];
    let height = bottom - top;
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{colour}\"/>"
    );
}

fn sign(svg: &mut String, event: &str, (x, y): (f64, f64), radius: f64) {
    let Some((_, colour, path)) = EVENTS.iter().find(|(name, ..)| *name == event) else { return };
    let _ = writeln!(
        svg,
        "<path transform=\"translate({x:.2} {y:.2}) scale({radius:.2})\" d=\"{path}\" fill=\"{colour}\" \
         stroke=\"{PAPER}\" stroke-width=\".3\" stroke-linejoin=\"round\"/>"
    );
}

/// An entry of the legend.
#[derive(Clone, Copy)]
enum LegendItem {
    Event(&'static str),
    Small,
    Cut,
    Dropped,
    Kept,
    Portal,
}

impl LegendItem {
    fn text(self) -> &'static str {
        match self {
            Self::Event(name) => name,
            Self::Small => "event too small to cut beside",
            Self::Cut => "cut",
            Self::Dropped => "cut left out, ink too thin",
            Self::Kept => "kept whole",
            Self::Portal => "portal: colour is the component in the piece on that side",
        }
    }

    fn sign_width(self) -> f64 {
        match self {
            Self::Event(_) => 2.0 * SIGN,
            Self::Small => 2.0 * SMALL_SIGN,
            Self::Portal => 8.0,
            Self::Cut | Self::Dropped | Self::Kept => 14.0,
        }
    }

    /// Draws the sign with its left end at `x` and its middle at `y`.
    fn draw(self, svg: &mut String, x: f64, y: f64) {
        let mut line = |style: &str| {
            let _ = writeln!(svg, "<path d=\"M{x:.2} {y:.2}h14\" stroke=\"{CUT}\" {style}/>");
        };
        match self {
            Self::Event(name) => sign(svg, name, (x + SIGN, y), SIGN),
            Self::Small => sign(svg, "split", (x + SMALL_SIGN, y), SMALL_SIGN),
            Self::Cut => line(CUT_STYLE),
            Self::Dropped => line(DROPPED_STYLE),
            Self::Kept => {
                let _ = writeln!(
                    svg,
                    "<rect x=\"{x:.2}\" y=\"{:.2}\" width=\"14\" height=\"10\" fill=\"{KEPT}\"/>\n\
                     <path d=\"M{x:.2} {:.2}h14M{x:.2} {:.2}h14\" stroke=\"{KEPT_LINE}\" stroke-width=\"2\"/>",
                    y - 5.0,
                    y - 5.0,
                    y + 5.0
                );
            }
            Self::Portal => {
                bar(svg, x, (y - 5.0, y + 5.0), 4.0, 0);
                bar(svg, x + 4.0, (y - 5.0, y + 5.0), 4.0, 1);
            }
        }
    }
}

/// The entries that this picture needs with their places, in rows of `width`, and the number of rows.
fn legend(analysis: &Analysis, width: f64) -> (Vec<(LegendItem, f64, usize)>, usize) {
    let mut items: Vec<LegendItem> = EVENTS.iter().map(|(name, ..)| LegendItem::Event(name)).collect();
    if analysis.critical_points.iter().any(|p| !p.makes_cuts) {
        items.push(LegendItem::Small);
    }
    items.push(LegendItem::Cut);
    if !analysis.dropped_cuts.is_empty() {
        items.push(LegendItem::Dropped);
    }
    if !analysis.kept_mm.is_empty() {
        items.push(LegendItem::Kept);
    }
    items.push(LegendItem::Portal);
    let (mut x, mut row) = (MARGIN, 0);
    let mut placed = Vec::new();
    for item in items {
        let needed = item.sign_width() + 5.0 + lettering::width(item.text(), LEGEND_HEIGHT);
        if x > MARGIN && x + needed > MARGIN + width {
            (x, row) = (MARGIN, row + 1);
        }
        placed.push((item, x, row));
        x += needed + 18.0;
    }
    (placed, row + 1)
}

#[cfg(test)]
mod tests {
    use super::super::tests::analysis;
    use super::*;
    use crate::reeb::SlicingRule;

    #[test]
    fn the_picture_shows_ink_portals_and_events_where_they_are() {
        let analysis = analysis(None);
        let layout = Layout::new(&analysis);
        let pixels = layout.width.max(layout.height).round() as u32;
        let picture = Pixmap::decode_png(&png(&analysis, pixels).unwrap()).unwrap();
        let colour = |x: f64, y: f64| {
            let c = picture.pixel(x as u32, y as u32).unwrap();
            format!("#{:02x}{:02x}{:02x}", c.red(), c.green(), c.blue())
        };
        assert_eq!(colour(2.0, 2.0), PAPER);
        assert_eq!(colour(layout.x(20.0), layout.y(10.0)), INK);
        // The second cut has two portals that are one component on its left, and on its right.
        let cut = &analysis.cuts[1];
        assert_eq!(colour(layout.x(cut.x_mm) - 5.0, layout.y(6.0)), STRIPE, "the eye is open");
        let middle = layout.y((cut.endpoints_mm[0] + cut.endpoints_mm[1]) / 2.0);
        assert_eq!(colour(layout.x(cut.x_mm) - 2.0, middle), LABELS[0]);
        let split = &analysis.critical_points[1];
        assert_eq!(colour(layout.x(split.x_mm), layout.y(split.y_mm)), EVENTS[2].1);
    }

    #[test]
    fn numbers_never_overlap() {
        for lines in [1, 40, 130, 700] {
            let analysis = analysis(Some(SlicingRule::Uniform { lines }));
            let layout = Layout::new(&analysis);
            let span = |n: &Number| {
                let half = lettering::width(&n.index.to_string(), NUMBER_HEIGHT) / 2.0;
                (n.x - half, n.x + half)
            };
            for (i, a) in layout.numbers.iter().enumerate() {
                let mut right = layout.numbers[i + 1..].iter().filter(|b| b.row == a.row);
                assert!(right.all(|b| span(a).1 < span(b).0), "{lines} lines");
            }
            assert!(layout.numbers.len() > lines.min(100) / 2);
        }
    }

    #[test]
    fn a_size_that_no_picture_can_have_is_an_error() {
        assert!(matches!(png(&analysis(None), 3), Err(ExportError::Option { .. })));
    }
}
