//! The reader for cut lines in an SVG: strokes to follow, not ink.

use glam::DVec2;

use super::cutlines::{CutPath, CutReport, judge};
use super::drawing::Loop;
use super::error::VerifyError;
use super::stretches::Stretch;
use super::svg::{drawing, parsed, text};

/// The attribute of the root element that says that a file has cut lines.
const MARK: &str = "data-cut-lines";

/// Whether an SVG says of itself that it has cut lines instead of areas.
pub fn has_cut_lines(bytes: &[u8]) -> bool {
    text(bytes).and_then(parsed).is_ok_and(|document| document.root_element().has_attribute(MARK))
}

/// Reads an SVG and counts what its lines cut out by the even-odd rule over all its paths, with curves as polygons within
/// `chord_mm`. Strokes have no width, and fills do not matter; the id of a group is the name of a layer.
///
/// # Errors
/// [`VerifyError`] when the bytes are no SVG, or when something in it cannot be judged.
pub fn read_cut_svg(bytes: &[u8], chord_mm: f64) -> Result<CutReport, VerifyError> {
    let document = parsed(text(bytes)?)?;
    let drawing = drawing(&document, chord_mm, true)?;
    let mut paths = Vec::new();
    for shape in &drawing.shapes {
        for Loop { points, closed } in shape.loops(chord_mm) {
            let n = points.len();
            let pairs = (0..if closed { n } else { n - 1 }).map(|i| (points[i], points[(i + 1) % n]));
            let stretches: Vec<Stretch> = pairs
                .filter(|(from, to): &(DVec2, DVec2)| from != to)
                .map(|(a, b)| Stretch::Line(a, b))
                .collect();
            if stretches.is_empty() {
                continue;
            }
            let element = match shape.line {
                0 => shape.element.clone(),
                line => format!("{} on line {line}", shape.element),
            };
            let layer = if shape.layer.is_empty() { "0" } else { &shape.layer }.to_owned();
            paths.push(CutPath { element, layer, stretches, is_closed: closed });
        }
    }
    judge(paths, "millimetres", Vec::new(), chord_mm)
}

#[cfg(test)]
mod tests {
    use super::super::CutFault;
    use super::*;

    fn file(attributes: &str, body: &str) -> String {
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20" {attributes}>{body}</svg>"#
        )
    }

    fn read(body: &str) -> CutReport {
        read_cut_svg(file("data-cut-lines=\"even-odd\"", body).as_bytes(), 0.01).unwrap()
    }

    const FRAME: &str = r##"<g id="CUT" fill="none" stroke="#ff0000" stroke-width="0.01">
        <path d="M3 3L9 3L9 9L3 9Z"/><path d="M1 1L11 1L11 11L1 11Z"/></g>"##;

    #[test]
    fn strokes_are_contours_by_the_even_odd_rule() {
        let report = read(FRAME);
        assert_eq!((report.components, report.holes, report.pierces, report.faults.len()), (1, 1, 2, 0));
        assert!((report.area_mm2 - 64.0).abs() < 1e-6 && (report.cut_length_mm - 64.0).abs() < 1e-9);
        assert!(has_cut_lines(file("data-cut-lines=\"even-odd\"", FRAME).as_bytes()));
        assert!(!has_cut_lines(file("", FRAME).as_bytes()) && !has_cut_lines(b"<svg"));
    }

    #[test]
    fn arcs_are_read_exactly_and_faults_are_found() {
        let disc = r##"<path fill="none" stroke="#f00" d="M19 10A9 9 0 0 1 1 10A9 9 0 0 1 19 10Z"/>"##;
        let report = read(disc);
        assert!(
            (report.cut_length_mm - 18.0 * std::f64::consts::PI).abs() < 0.05,
            "{}",
            report.cut_length_mm
        );
        let twice = read(&format!("{disc}{disc}"));
        assert!(twice.faults.iter().any(|f| matches!(f, CutFault::Doubled { .. })), "{:?}", twice.faults);
        let open = read(r##"<path fill="none" stroke="#f00" d="M1 1L5 1L5 5"/>"##);
        assert!(matches!(open.faults[..], [CutFault::Open { .. }]), "{:?}", open.faults);
    }

    #[test]
    fn what_is_engraved_is_closed_and_engraved_once_and_counts_nothing() {
        let engraved =
            |body: &str| read(&format!(r##"<g id="ENGRAVE" fill="none" stroke="#00f">{body}</g>{FRAME}"##));
        let square = r#"<path d="M4 4L6 4L6 6L4 6Z"/>"#;
        let sound = engraved(square);
        assert_eq!((sound.components, sound.holes, sound.pierces, sound.faults.len()), (1, 1, 2, 0));
        let open = engraved(r#"<path d="M4 4L6 4L6 6"/>"#);
        assert!(matches!(open.open_engraved[..], [CutFault::Open { .. }]), "{:?}", open.open_engraved);
        assert!(open.faults.is_empty() && open.to_string().contains("1 path(s) that do not close"), "{open}");
        let twice = engraved(&format!("{square}{square}"));
        assert!(twice.faults.iter().all(|f| matches!(f, CutFault::Doubled { is_engraved: true, .. })));
        assert!(twice.faults.len() == 4 && twice.faults[0].to_string().contains("are engraved twice"));
    }

    #[test]
    fn files_of_others_are_lines_too() {
        let circle = r#"<circle cx="10" cy="10" r="5" style="fill:none;stroke:red;stroke-width:0.1"/>"#;
        let report = read_cut_svg(file("", circle).as_bytes(), 0.01).unwrap();
        assert_eq!((report.components, report.holes, report.pierces), (1, 0, 1));
        assert!((report.area_mm2 - 25.0 * std::f64::consts::PI).abs() < 0.3);
    }
}
