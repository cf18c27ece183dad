//! An SVG as curves and elements, which is what the second engine learns from.
//!
//! A pen that follows a path makes a *curve*, and what is filled is an *element*, which is copied, moved and turned as a
//! whole. A path with a stroke and no fill is a curve, or several, one for each subpath. A path with a fill is an element with the stroke
//! that it has. A group (`g` or `use`) that directly holds a fill is one element with all that is in it: a flower of five
//! petals and a stem. Two kinds of groups only sort a drawing and bind nothing: layers of Inkscape, and a group that
//! holds everything that is drawn.
//!
//! What is synthesized is drawn with a round pen. So a curve has one width all along, and its ends and corners
//! count as round; ends that are drawn flat are told. Strokes of elements keep their dashes, ends and corners, as they are
//! expanded as drawn.
//!
//! Excluded, with their place: curves that are stretched, so that the pen is wider one way than another; that are dashed; that a clip cuts;
//! and dots, lines of no length.

use std::path::Path;

use glam::DVec2;
use kurbo::{Affine, Rect, Shape as _};

use super::artwork::{Artwork, Item, Shape};
use super::error::{ExemplarError, ExemplarFault};
use super::outline::{check_precision, regions};
use super::parts::{Line, Parts};
use super::scan::{Strictness, scan};
use super::source::Source;
use super::{ReadOptions, check_options, read_named, sha256};
use crate::planar::Region;

/// Curves and elements in millimetres, y up, where the drawing has them on its page.
#[derive(Debug, Clone)]
pub struct Linework {
    name: String,
    sha256: String,
    notes: Vec<String>,
    lost: Option<String>,
    page_mm: [f64; 2],
    strokes: Vec<Line>,
    stroke_ink: Vec<Vec<DVec2>>,
    elements: Vec<Vec<Vec<DVec2>>>,
}

impl Linework {
    /// The curves and elements of the SVG file at `path`, named by the file's stem.
    ///
    /// # Errors
    /// [`ExemplarError`] names the file and what is wrong with it: as [`super::Exemplar::read`], and curves that cannot be represented.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, ExemplarError> {
        read_named(path, &options.limits, |name, bytes| Self::parse(name, bytes, options))
    }

    /// The curves and elements of the SVG document `bytes`, which errors call `name`.
    ///
    /// # Errors
    /// As [`Linework::read`].
    pub fn from_svg(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ExemplarError> {
        Self::parse(name, bytes, options).map_err(|fault| ExemplarError::new(name, fault))
    }

    fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ExemplarFault> {
        check_options(options)?;
        let source = Source::parse(bytes, &options.limits)?;
        let found = scan(&source, &options.limits, Strictness::Ink)?;
        let artwork = Artwork::new(&source, found, &options.limits)?;
        let parts = Parts::new(&artwork, options)?;
        let mut linework = Self {
            name: name.to_owned(),
            sha256: sha256(bytes),
            notes: Vec::new(),
            lost: None,
            page_mm: [artwork.page_mm.0, artwork.page_mm.1],
            strokes: Vec::new(),
            stroke_ink: Vec::new(),
            elements: Vec::new(),
        };
        linework.lay(&parts, 1.0, options)?;
        let Some(bounds) = linework.bounds() else { return Err(ExemplarFault::NoInk) };
        check_precision(&artwork.items, 1.0, bounds.width().max(bounds.height()))?;
        if let Some(height_mm) = options.target_height_mm {
            linework.lay(&parts, height_mm / bounds.height(), options)?;
        }
        (linework.notes, linework.lost) = (parts.notes, parts.lost);
        Ok(linework)
    }

    /// Everything of `parts` at `scale` about the origin of the page.
    fn lay(&mut self, parts: &Parts, scale: f64, options: &ReadOptions) -> Result<(), ExemplarFault> {
        let pen =
            |line: &Line| Line { path: Affine::scale(scale) * &line.path, width_mm: line.width_mm * scale };
        self.strokes = parts.strokes.iter().map(pen).collect();
        self.page_mm = self.page_mm.map(|mm| mm * scale);
        self.stroke_ink = match parts.drawn_strokes.is_empty() {
            true => Vec::new(),
            false => {
                contours(&regions(&[&parts.drawn_strokes], scale, options.chord_mm, &options.limits)?[0])
            }
        };
        let drawings: Vec<&[Item<Shape>]> = parts.elements.iter().map(Vec::as_slice).collect();
        self.elements.clear();
        if !drawings.is_empty() {
            let regions = regions(&drawings, scale, options.chord_mm, &options.limits)?;
            // What its clip leaves nothing of is not drawn.
            self.elements.extend(regions.iter().filter(|region| !region.is_empty()).map(contours));
        }
        Ok(())
    }

    /// The box of the ink.
    fn bounds(&self) -> Option<Rect> {
        let of_stroke = |line: &Line| {
            let pen = 0.5 * line.width_mm;
            line.path.bounding_box().inflate(pen, pen)
        };
        let of_element = |contours: &Vec<Vec<DVec2>>| {
            let point = |p: &DVec2| kurbo::Point::new(p.x, p.y);
            let first = Rect::from_points(point(&contours[0][0]), point(&contours[0][0]));
            contours.iter().flatten().fold(first, |bounds, p| bounds.union_pt(point(p)))
        };
        let strokes = self.strokes.iter().map(of_stroke);
        strokes.chain(self.elements.iter().map(of_element)).reduce(|a, b| a.union(b))
    }

    /// The curves, in the order of the file.
    pub fn strokes(&self) -> &[Line] {
        &self.strokes
    }

    /// What the curves cover as they are drawn, with their own ends and corners: closed polygons with the ink on their left.
    pub fn stroke_ink(&self) -> &[Vec<DVec2>] {
        &self.stroke_ink
    }

    /// The elements, in the order of the file: each one as closed polygons with the ink on their left, the first one an exterior. An
    /// element may have several components.
    pub fn elements(&self) -> &[Vec<Vec<DVec2>>] {
        &self.elements
    }

    /// Width and height of the page in millimetres.
    pub fn page_mm(&self) -> [f64; 2] {
        self.page_mm
    }

    /// The file's stem, or the name given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The SHA-256 of the file's bytes, in lower-case hexadecimal.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// What is worth telling the user though it is no error, one sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What is lost where the curves are drawn again by a round pen, if anything is, as a sentence.
    pub fn lost(&self) -> Option<&str> {
        self.lost.as_deref()
    }
}

fn contours(region: &Region) -> Vec<Vec<DVec2>> {
    let grid = region.grid();
    region.contours().map(|contour| contour.points().iter().map(|&p| grid.to_mm(p)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use kurbo::PathEl;

    use super::super::parts::is_closed;
    use super::*;

    /// A drawing of 100 mm by 100 mm in which one user unit is one millimetre.
    fn read_at(body: &str, height_mm: Option<f64>) -> Result<Linework, String> {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='{}' width='100mm' height='100mm' viewBox='0 0 100 \
             100'>\n{body}</svg>",
            "http://www.inkscape.org/namespaces/inkscape"
        );
        let options = ReadOptions { target_height_mm: height_mm, ..ReadOptions::default() };
        Linework::from_svg("test", svg.as_bytes(), &options).map_err(|e| e.to_string())
    }

    fn read(body: &str) -> Linework {
        read_at(body, None).unwrap_or_else(|e| panic!("{e}\n{body}"))
    }

    /// How many curves, and how many contours each element has.
    fn found(body: &str) -> (usize, Vec<usize>) {
        let linework = read(body);
        (linework.strokes().len(), linework.elements().iter().map(Vec::len).collect())
    }

    const PEN: &str = "fill='none' stroke='black' stroke-width='2' stroke-linecap='round'";

    #[test]
    fn strokes_are_curves_where_the_drawing_has_them() {
        let linework = read(&format!(
            "<g transform='translate(5 0) rotate(90) scale(2)'><path d='M10 -10H20V-20M30 -30h5z' {PEN}/></g>"
        ));
        let [open, closed] = linework.strokes() else { panic!("two subpaths are two curves") };
        assert!((open.width_mm - 4.0).abs() < 1e-4 && linework.lost().is_none(), "{linework:?}");
        let start = open.path.elements()[0].end_point().unwrap();
        assert!(start.distance(kurbo::Point::new(25.0, 80.0)) < 1e-3, "{start:?}");
        assert!(!is_closed(&open.path) && is_closed(&closed.path));
        assert!(matches!(closed.path.elements().last(), Some(PathEl::ClosePath)));
        let ring =
            read(&format!("<path d='M10 10H20V20H10V10' {PEN}/><circle cx='50' cy='50' r='9' {PEN}/>"));
        assert!(
            ring.strokes().iter().all(|line| matches!(line.path.elements().last(), Some(PathEl::ClosePath)))
        );
    }

    #[test]
    fn fills_are_elements_and_groups_bind_them() {
        let dot = |x: i32| format!("<circle cx='{x}' cy='50' r='2'/>");
        let stem = format!("<path d='M10 10V40' {PEN}/>");
        assert_eq!(found(&(dot(10) + &dot(20) + &stem)), (1, vec![1, 1]));
        assert_eq!(found(&format!("<g>{}{}{stem}</g>{}", dot(10), dot(20), dot(30))), (0, vec![3, 1]));
        // A group within the group, and one that holds no fill itself.
        assert_eq!(found(&format!("<g>{}<g>{}</g></g>{stem}", dot(10), dot(20))), (1, vec![2]));
        assert_eq!(found(&format!("<g><g>{}{}</g>{stem}</g>{}", dot(10), dot(20), dot(30))), (1, vec![2, 1]));
        // Groups that only sort.
        assert_eq!(found(&format!("<g>{}{}{stem}</g>", dot(10), dot(20))), (1, vec![1, 1]));
        let layer = format!("<g inkscape:groupmode='layer'>{}{}</g>{stem}", dot(10), dot(20));
        assert_eq!(found(&layer), (1, vec![1, 1]));
        // Each use of a symbol is one.
        let flower = format!("<symbol id='f' overflow='visible'>{}{}{stem}</symbol>", dot(10), dot(16));
        assert_eq!(found(&format!("{flower}<use href='#f'/><use href='#f' x='20'/>")), (0, vec![3, 3]));
    }

    #[test]
    fn an_element_is_united_and_keeps_its_holes() {
        let disc = "<circle cx='50' cy='50' r='9' stroke='black' stroke-width='2'/>";
        let ring = "<path fill-rule='evenodd' d='M10 10H30V30H10ZM15 15H25V25H15Z'/>";
        let linework = read(&format!("{disc}{ring}"));
        let [disc, ring] = linework.elements() else { panic!("two elements") };
        let area = |contour: &[DVec2]| {
            let n = contour.len();
            0.5 * (0..n).map(|i| contour[i].perp_dot(contour[(i + 1) % n])).sum::<f64>()
        };
        assert!(disc.len() == 1 && (area(&disc[0]) - std::f64::consts::PI * 100.0).abs() < 1.0);
        assert!(
            ring.len() == 2 && (area(&ring[0]) - 400.0).abs() < 1e-3 && (area(&ring[1]) + 100.0).abs() < 1e-3
        );
        let half = "<clipPath id='c'><rect width='20' height='100'/></clipPath>";
        let clipped = read(&format!("{half}<rect clip-path='url(#c)' x='10' y='10' width='30' height='5'/>"));
        assert!((area(&clipped.elements()[0][0]) - 50.0).abs() < 1e-3);
    }

    #[test]
    fn a_fill_that_nobody_meant_is_none() {
        let pen = "stroke='black' stroke-linecap='round'";
        assert_eq!(found(&format!("<path d='M10 10H30' {pen}/>")), (1, vec![]));
        let bent = read(&format!("<path d='M10 10H30V20' {pen}/>"));
        assert_eq!(bent.elements().len(), 1);
        assert!(bent.notes()[0].contains("<path> on line 2 is open and has a fill"), "{:?}", bent.notes());
    }

    #[test]
    fn a_height_scales_all_of_it() {
        let body = format!("<path d='M10 10V28' {PEN}/><rect x='40' y='15' width='5' height='5'/>");
        let linework = read_at(&body, Some(40.0)).unwrap();
        let bounds = linework.bounds().unwrap();
        assert!((bounds.height() - 40.0).abs() < 1e-6, "{bounds:?}");
        assert_eq!((linework.strokes()[0].width_mm.round(), linework.page_mm()[0].round()), (4.0, 200.0));
    }

    #[test]
    fn strokes_cover_what_they_are_drawn_with() {
        let linework = read("<path d='M10 10H30V30' fill='none' stroke='red' stroke-width='4'/>");
        let [contour] = linework.stroke_ink() else { panic!("{linework:?}") };
        // Flat ends and a corner; some vertices lie on straight sides.
        let n = contour.len();
        let area = 0.5 * (0..n).map(|i| contour[i].perp_dot(contour[(i + 1) % n])).sum::<f64>();
        assert!((area - 4.0 * 40.0).abs() < 1e-3, "{area}");
        let corner = |p: &DVec2| p.distance(DVec2::new(32.0, 92.0)) < 1e-3;
        assert!(contour.iter().any(corner) && contour.iter().all(|p| p.x > 9.99), "{contour:?}");
        assert!(read("<rect width='9' height='9'/>").stroke_ink().is_empty());
    }

    #[test]
    fn what_no_pen_draws_is_named() {
        let says = |body: &str, wanted: &[&str]| {
            let message = read_at(body, None).unwrap_err();
            assert!(wanted.iter().all(|part| message.contains(part)), "{message}");
        };
        says(
            &format!("<path transform='scale(1 2)' d='M0 0H9' {PEN}/>"),
            &["<path> on line 2", "stretches", "Stroke to Path"],
        );
        says(&format!("<path stroke-dasharray='2 1' d='M0 0H9' {PEN}/>"), &["dashed", "Convert to Dashes"]);
        let half = "<clipPath id='c'><rect width='20' height='100'/></clipPath>";
        says(&format!("{half}<path clip-path='url(#c)' d='M0 0H9' {PEN}/>"), &["a clip cuts"]);
        says(&format!("<path d='M0 0h0' {PEN}/>"), &["a dot", "filled circle"]);
        says("", &["draws nothing"]);
        says("<path d='M0 0H9' fill='none'/>", &["has no filled area"]);
        let flat = read("<path d='M0 0H9M3 3H9' fill='none' stroke='red'/>");
        assert!(flat.lost().unwrap().starts_with("2 curves have flat ends (the first is <path> on line 2)"));
    }
}
