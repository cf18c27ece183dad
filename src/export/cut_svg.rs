//! The SVG of cut lines: strokes without fill, a group for each layer, a path for each contour in cutting order.
//!
//! Laser programs tell cuts by a thin stroke and sort what to do by its colour. The root element says with
//! `data-cut-lines` that areas are to be read by the even-odd rule over all contours of a layer. Excluded: kerf, and
//! fills: those are [`super::svg()`].

use std::fmt::Write;

use super::ExportError;
use super::cutlines::CutLines;
use super::layer::Layer;
use super::svg::{SvgOptions, check, open_document, rounded_page, write_outline};

/// The width of the strokes in millimetres. Wider, and some programs take them for areas to engrave; narrower, and
/// browsers show nothing.
const HAIRLINE: &str = "0.01";

/// The cut lines as an SVG document at 1:1 in millimetres, y down: one `<path>` for each contour, in the order of
/// cutting, grouped by layer. The same lines give the same bytes.
///
/// # Errors
/// [`ExportError::Option`] for a page that is no length, [`ExportError::OffPage`] when lines lie beyond the page.
pub fn cut_svg(lines: &CutLines, options: &SvgOptions) -> Result<String, ExportError> {
    check(Some(lines.bounds_mm), options)?;
    let page = rounded_page(options, lines.decimals);
    let mut text = open_document(page, " data-cut-lines=\"even-odd\"", options);
    for layer in Layer::ALL {
        let mut paths = lines.paths.iter().filter(|path| path.layer == layer).peekable();
        if paths.peek().is_none() {
            continue;
        }
        let [r, g, b] = lines.colours.of(layer);
        let _ = writeln!(
            text,
            "<g id=\"{}\" fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"{HAIRLINE}\">",
            layer.name()
        );
        for path in paths {
            text.push_str("<path d=\"");
            write_outline(&mut text, &path.outline, page[1]);
            text.push_str("\"/>\n");
        }
        text.push_str("</g>\n");
    }
    text.push_str("</svg>\n");
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::{Curves, LayerColours};
    use crate::planar::{FillRule, boxes};

    fn options() -> SvgOptions {
        SvgOptions { width_mm: 60.0, height_mm: 40.0, chord_mm: 0.01, title: None, description: None }
    }

    #[test]
    fn contours_are_strokes_inner_first() {
        let frame = boxes(1 << 26, FillRule::EvenOdd, &[(1, 2, 10, 10), (3, 4, 5, 5)]);
        let lines = CutLines::new(&[(Layer::Cut, &frame)], Curves::Arcs, 0.01).unwrap();
        let text = cut_svg(&lines, &options()).unwrap();
        let group = "<g id=\"CUT\" fill=\"none\" stroke=\"#ff0000\" stroke-width=\"0.01\">\n\
                     <path d=\"M3 36L3 31L8 31L8 36Z\"/>\n<path d=\"M1 38L11 38L11 28L1 28Z\"/>\n</g>\n";
        assert!(text.contains(group), "{text}");
        assert!(text.contains(" viewBox=\"0 0 60 40\" data-cut-lines=\"even-odd\">"));
        let colours = LayerColours { cut: [0, 0x80, 0xff], ..LayerColours::default() };
        let text = cut_svg(&lines.clone().with_colours(colours), &options()).unwrap();
        assert!(text.contains("stroke=\"#0080ff\"") && !text.contains("#ff0000"), "{text}");
        let small = SvgOptions { width_mm: 10.0, ..options() };
        assert!(matches!(cut_svg(&lines, &small), Err(ExportError::OffPage { .. })));
    }
}
