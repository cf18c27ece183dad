//! Letters drawn with a pen, for pictures that must look the same with no font at hand.
//!
//! Each glyph is an SVG path to be stroked, y down, the base line at 0, digits and ascenders 7 high. Only what
//! the pictures say is here: digits, small letters and a few signs.

use std::fmt::Write;

/// The height of a digit in the glyphs' own units.
const HEIGHT: f64 = 7.0;
/// The room between two glyphs.
const GAP: f64 = 1.7;
/// The pen's width.
const PEN: f64 = 0.85;

/// How wide a line of `text` is, with digits `height` high.
pub(super) fn width(text: &str, height: f64) -> f64 {
    let advances: f64 = text.chars().map(|c| glyph(c).1 + GAP).sum();
    (advances - GAP).max(0.0) * height / HEIGHT
}

/// Writes `text` with its left end at `x` and its base line at `y` as one SVG group in `colour`. Capitals are
/// drawn as small letters, what has no glyph as a dot.
pub(super) fn write(svg: &mut String, text: &str, (x, y): (f64, f64), height: f64, colour: &str) {
    let scale = height / HEIGHT;
    let _ = write!(
        svg,
        "<g transform=\"translate({x:.2} {y:.2}) scale({scale:.4})\" fill=\"none\" stroke=\"{colour}\" \
         stroke-width=\"{PEN}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">"
    );
    let mut at = 0.0;
    for c in text.chars() {
        let (path, advance) = glyph(c);
        if !path.is_empty() {
            let _ = write!(svg, "<path transform=\"translate({at:.2} 0)\" d=\"{path}\"/>");
        }
        at += advance + GAP;
    }
    svg.push_str("</g>\n");
}

/// The path of a character and its width.
fn glyph(c: char) -> (&'static str, f64) {
    match c.to_ascii_lowercase() {
        '0' => (
            "M2.1 -7C.6 -7 0 -5.4 0 -3.5C0 -1.6 .6 0 2.1 0C3.6 0 4.2 -1.6 4.2 -3.5C4.2 -5.4 3.6 -7 2.1 -7Z",
            4.2,
        ),
        '1' => ("M.8 -5.6L2.5 -7V0", 3.4),
        '2' => ("M.3 -5.3C.5 -7.5 4 -7.5 4 -5.1C4 -3.4 1.6 -2.2 .2 0H4.2", 4.2),
        '3' => (
            "M.4 -6C1.1 -7.4 3.9 -7.3 3.9 -5.3C3.9 -4.2 3 -3.7 1.6 -3.7C3.2 -3.7 4.2 -3 4.2 -1.9C4.2 .5 .9 .5 .1 -1.2",
            4.2,
        ),
        '4' => ("M3.2 0V-7L0 -2H4.4", 4.4),
        '5' => ("M3.8 -7H.9L.5 -3.9C1.4 -4.8 4.2 -4.7 4.2 -2.3C4.2 .4 1 .5 .1 -1", 4.2),
        '6' => ("M3.7 -6.4C2.4 -7.7 0 -6.4 0 -2.6C0 .9 4.2 .8 4.2 -2.2C4.2 -5 .6 -5 .1 -2.2", 4.2),
        '7' => ("M0 -7H4.2L1.4 0", 4.2),
        '8' => (
            "M2.1 -3.8C-.1 -4 -.1 -7 2.1 -7C4.3 -7 4.3 -4 2.1 -3.8C-.6 -3.5 -.6 0 2.1 0C4.8 0 4.8 -3.5 2.1 -3.8Z",
            4.2,
        ),
        '9' => ("M.5 -.6C1.8 .7 4.2 -.6 4.2 -4.4C4.2 -7.9 0 -7.8 0 -4.8C0 -2 3.6 -2 4.1 -4.8", 4.2),
        'a' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M4 -4.6V0", 4.0),
        'b' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M0 -7V0", 4.0),
        'c' => ("M3.5 -3.8A2 2.3 0 1 0 3.5 -.8", 3.6),
        'd' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M4 -7V0", 4.0),
        'e' => ("M.1 -2.4H4A2 2.3 0 1 0 3.5 -.8", 4.0),
        'f' => ("M3 -6.9H2.6A1.4 1.4 0 0 0 1.2 -5.5V0M0 -4.5H2.8", 2.6),
        'g' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M4 -4.6V.4A2 1.9 0 0 1 .3 1.3", 4.0),
        'h' => ("M0 -7V0M0 -2.8A1.9 1.8 0 0 1 3.8 -2.8V0", 3.8),
        'i' => ("M.4 -4.6V0M.4 -6.6V-6.5", 0.8),
        'j' => ("M1 -4.6V.8A1.3 1.3 0 0 1 -.3 2.1M1 -6.6V-6.5", 1.2),
        'k' => ("M0 -7V0M3.4 -4.6L0 -1.8M1.3 -2.9L3.6 0", 3.4),
        'l' => ("M.4 -7V0", 0.8),
        'm' => ("M0 -4.6V0M0 -3A1.5 1.6 0 0 1 3 -3V0M3 -3A1.5 1.6 0 0 1 6 -3V0", 6.0),
        'n' => ("M0 -4.6V0M0 -2.8A1.9 1.8 0 0 1 3.8 -2.8V0", 3.8),
        'o' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3", 4.0),
        'p' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M0 -4.6V2.2", 4.0),
        'q' => ("M4 -2.3A2 2.3 0 1 1 0 -2.3A2 2.3 0 1 1 4 -2.3M4 -4.6V2.2", 4.0),
        'r' => ("M0 -4.6V0M0 -2.6A2.2 2 0 0 1 2.5 -4.5", 2.4),
        's' => ("M3.3 -3.8C2.9 -4.9 .4 -4.9 .4 -3.4C.4 -1.9 3.5 -2.7 3.5 -1.2C3.5 .3 .6 .3 .1 -.9", 3.5),
        't' => ("M1.2 -6.2V-1.4A1.4 1.4 0 0 0 3 -.1M0 -4.5H2.8", 2.8),
        'u' => ("M0 -4.6V-1.8A1.9 1.8 0 0 0 3.8 -1.8M3.8 -4.6V0", 3.8),
        'v' => ("M0 -4.6L1.9 0L3.8 -4.6", 3.8),
        'w' => ("M0 -4.6L1.4 0L2.9 -4.4L4.4 0L5.8 -4.6", 5.8),
        'x' => ("M0 -4.6L3.6 0M3.6 -4.6L0 0", 3.6),
        'y' => ("M0 -4.6L2 0M4 -4.6L1.4 1.4Q1 2.2 0 2.2", 3.8),
        'z' => ("M.2 -4.5H3.5L0 0H3.7", 3.6),
        ' ' => ("", 1.8),
        ',' => ("M.7 -.3L.2 1.3", 0.7),
        ':' => ("M.4 -4V-3.9M.4 -.2V-.1", 0.8),
        '-' => ("M0 -2.6H2.6", 2.6),
        '_' => ("M0 .8H3.6", 3.6),
        _ => ("M.4 -.2V-.1", 0.8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_a_path_as_wide_as_it_says() {
        let mut svg = String::new();
        for c in ('a'..='z').chain('0'..='9').chain(",:-_.".chars()) {
            let (d, advance) = glyph(c);
            let path = kurbo::BezPath::from_svg(d).unwrap();
            let bounds = kurbo::Shape::bounding_box(&path);
            assert!(bounds.x0 > -0.5 && bounds.x1 < advance + 0.5, "{c}: {bounds:?}");
            assert!(bounds.y0 > -7.5 && bounds.y1 < 2.5, "{c}: {bounds:?}");
            write(&mut svg, &c.to_string(), (0.0, 0.0), 7.0, "#000");
        }
        assert_eq!(svg.matches("<g ").count(), 41);
    }

    #[test]
    fn a_line_is_as_wide_as_its_glyphs_and_the_gaps_between() {
        assert!((width("00", 14.0) - 2.0 * (4.2 + GAP + 4.2)).abs() < 1e-12);
        assert_eq!(width("", 9.0), 0.0);
    }
}
