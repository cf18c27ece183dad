//! The reader for any other SVG: transforms, styles, shapes, `use`, strokes and units, resolved by usvg.
//!
//! usvg works in `f32` pixels at 96 to the inch, so this is good to about 1e-6 of the extent. It drops text
//! without a word, so the XML is searched first for what it would drop or this reader could not judge.

use kurbo::{Affine, BezPath, Cap, Join, Point, Stroke, StrokeOpts};
use roxmltree::Document;
use usvg::tiny_skia_path::PathSegment;

use super::drawing::{Drawing, Shape, element_name, upright};
use super::error::VerifyError;
use crate::planar::FillRule;

const MM_PER_PX: f64 = 25.4 / 96.0;
/// Elements that paint something else than paths, or limit what paths paint.
const REFUSED: [(&str, &str, &str); 6] = [
    ("text", "text", "convert it to paths"),
    ("image", "an image", "trace it to paths or remove it"),
    ("foreignObject", "foreign content", "remove it"),
    ("mask", "a mask", "apply it to the paths"),
    ("filter", "a filter", "remove it"),
    ("clipPath", "a clip path", "apply it to the paths"),
];

/// The drawing, resolved. Of cut `lines`, every visible path is one, and strokes have no width.
///
/// # Errors
/// [`VerifyError::Unsupported`], [`VerifyError::Resolve`].
pub(super) fn read(document: &Document<'_>, chord_mm: f64, lines: bool) -> Result<Drawing, VerifyError> {
    refuse(document)?;
    let tree = usvg::Tree::from_xmltree(document, &usvg::Options::default())
        .map_err(|e| VerifyError::Resolve { message: e.to_string() })?;
    let size = tree.size();
    let page_mm = glam::DVec2::new(f64::from(size.width()), f64::from(size.height())) * MM_PER_PX;
    let mut reader = Reader {
        to_page: upright(page_mm.y) * Affine::scale(MM_PER_PX),
        chord_mm,
        lines,
        shapes: Vec::new(),
    };
    reader.group(tree.root(), "")?;
    Ok(Drawing { page_mm, shapes: reader.shapes })
}

fn refuse(document: &Document<'_>) -> Result<(), VerifyError> {
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        let name = node.tag_name().name();
        if let Some(&(_, what, instead)) = REFUSED.iter().find(|(refused, ..)| *refused == name) {
            let element = element_name(name, node.attribute("id"));
            let line = document.text_pos_at(node.range().start).row;
            return Err(VerifyError::Unsupported { element, line, what, instead });
        }
    }
    Ok(())
}

struct Reader {
    to_page: Affine,
    chord_mm: f64,
    lines: bool,
    shapes: Vec<Shape>,
}

impl Reader {
    fn group(&mut self, group: &usvg::Group, around: &str) -> Result<(), VerifyError> {
        let layer = if group.id().is_empty() { around } else { group.id() };
        let refused = |what, instead| {
            let element = element_name("g", Some(group.id()));
            Err(VerifyError::Unsupported { element, line: 0, what, instead })
        };
        if group.clip_path().is_some() {
            return refused("a clip path", "apply it to the paths");
        }
        if group.mask().is_some() || !group.filters().is_empty() {
            return refused("a mask or a filter", "remove it");
        }
        if group.opacity().get() == 0.0 {
            return Ok(());
        }
        for node in group.children() {
            match node {
                usvg::Node::Group(group) => self.group(group, layer)?,
                usvg::Node::Path(path) if path.is_visible() => self.path(path, layer)?,
                usvg::Node::Path(_) => {}
                usvg::Node::Image(_) => return refused("an image", "trace it to paths or remove it"),
                usvg::Node::Text(_) => return refused("text", "convert it to paths"),
            }
        }
        Ok(())
    }

    fn path(&mut self, path: &usvg::Path, layer: &str) -> Result<(), VerifyError> {
        let element = element_name("path", Some(path.id()));
        let paints = [path.fill().map(usvg::Fill::paint), path.stroke().map(usvg::Stroke::paint)];
        if paints.into_iter().flatten().any(|paint| matches!(paint, usvg::Paint::Pattern(_))) {
            let (what, instead) = ("a pattern paint", "use a plain colour");
            return Err(VerifyError::Unsupported { element, line: 0, what, instead });
        }
        let t = path.abs_transform();
        let to_page = self.to_page * Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from));
        let outline = bez_path(path.data());
        let layer = layer.to_owned();
        if self.lines {
            let (path, rule) = (to_page * outline, FillRule::EvenOdd);
            self.shapes.push(Shape { element, line: 0, path, rule, layer, is_stroke: false });
            return Ok(());
        }
        if let Some(fill) = path.fill().filter(|f| f.opacity().get() > 0.0) {
            let rule = match fill.rule() {
                usvg::FillRule::NonZero => FillRule::NonZero,
                usvg::FillRule::EvenOdd => FillRule::EvenOdd,
            };
            let path = to_page * outline.clone();
            let (element, layer) = (element.clone(), layer.clone());
            self.shapes.push(Shape { element, line: 0, path, rule, layer, is_stroke: false });
        }
        if let Some(stroke) = path.stroke().filter(|s| s.opacity().get() > 0.0) {
            let tolerance = self.chord_mm / to_page.determinant().abs().sqrt().max(f64::MIN_POSITIVE);
            let path = to_page * kurbo::stroke(outline, &style(stroke), &StrokeOpts::default(), tolerance);
            let rule = FillRule::NonZero;
            self.shapes.push(Shape { element, line: 0, path, rule, layer, is_stroke: true });
        }
        Ok(())
    }
}

fn bez_path(data: &usvg::tiny_skia_path::Path) -> BezPath {
    let point = |p: usvg::tiny_skia_path::Point| Point::new(f64::from(p.x), f64::from(p.y));
    let mut path = BezPath::new();
    for segment in data.segments() {
        match segment {
            PathSegment::MoveTo(p) => path.move_to(point(p)),
            PathSegment::LineTo(p) => path.line_to(point(p)),
            PathSegment::QuadTo(p, q) => path.quad_to(point(p), point(q)),
            PathSegment::CubicTo(p, q, r) => path.curve_to(point(p), point(q), point(r)),
            PathSegment::Close => path.close_path(),
        }
    }
    path
}

fn style(stroke: &usvg::Stroke) -> Stroke {
    let join = match stroke.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => Join::Miter,
        usvg::LineJoin::Round => Join::Round,
        usvg::LineJoin::Bevel => Join::Bevel,
    };
    let cap = match stroke.linecap() {
        usvg::LineCap::Butt => Cap::Butt,
        usvg::LineCap::Round => Cap::Round,
        usvg::LineCap::Square => Cap::Square,
    };
    let style = Stroke::new(f64::from(stroke.width().get()))
        .with_join(join)
        .with_caps(cap)
        .with_miter_limit(f64::from(stroke.miterlimit().get()));
    match stroke.dasharray() {
        Some(dashes) => {
            style.with_dashes(f64::from(stroke.dashoffset()), dashes.iter().map(|&d| f64::from(d)))
        }
        None => style,
    }
}
