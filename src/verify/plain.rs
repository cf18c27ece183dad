//! The reader for SVG as Openwork writes it, in `f64` and without a resolver in between.
//!
//! Plain is: `width` and `height` in millimetres, a `viewBox` of the same numbers, and filled `path` elements,
//! perhaps in groups, with presentation attributes only. Anything more is left to [`super::drawn`].

use glam::DVec2;
use roxmltree::{Document, Node};

use super::drawing::{Drawing, Shape, element_name, upright};
use super::error::VerifyError;
use super::path_data::bez_path;
use crate::planar::FillRule;

/// What a group hands down to the paths in it.
#[derive(Clone, Copy)]
struct Inherited<'a> {
    filled: bool,
    rule: FillRule,
    /// Whether paths are lines to follow, whatever paints them.
    lines: bool,
    /// The id of the nearest group.
    layer: &'a str,
}

/// The drawing, or `None` when the file is not plain. Of cut `lines`, strokes and paths without fill are paths like any.
///
/// # Errors
/// [`VerifyError::PathData`].
pub(super) fn read(document: &Document<'_>, lines: bool) -> Result<Option<Drawing>, VerifyError> {
    let root = document.root_element();
    let Some(page_mm) = page(root) else { return Ok(None) };
    let mut shapes = Vec::new();
    let inherited = Inherited { filled: true, rule: FillRule::NonZero, lines, layer: "" };
    let Some(inherited) = attributes(root, inherited, &["width", "height", "viewBox", "version"]) else {
        return Ok(None);
    };
    let plain = children(root, inherited, page_mm.y, &mut shapes)?;
    Ok(plain.then_some(Drawing { page_mm, shapes }))
}

/// Width and height when they are in millimetres and agree with the view box.
fn page(root: Node<'_, '_>) -> Option<DVec2> {
    let mm = |name| root.attribute(name)?.trim().strip_suffix("mm")?.trim_end().parse::<f64>().ok();
    let size = DVec2::new(mm("width")?, mm("height")?);
    let numbers = root.attribute("viewBox")?.split([' ', ',', '\t', '\n', '\r']).filter(|s| !s.is_empty());
    let [x, y, width, height] = numbers.map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?[..] else {
        return None;
    };
    let same = (DVec2::new(width, height) - size).abs().max_element() <= 1e-9 * size.max_element();
    (same && (x, y) == (0.0, 0.0) && size.min_element() > 0.0).then_some(size)
}

/// Reads the children of an element; whether they were all plain.
fn children<'a>(
    parent: Node<'a, '_>,
    inherited: Inherited<'a>,
    height_mm: f64,
    shapes: &mut Vec<Shape>,
) -> Result<bool, VerifyError> {
    for node in parent.children().filter(Node::is_element) {
        let plain = match node.tag_name().name() {
            "title" | "desc" | "metadata" => true,
            "g" => match attributes(node, inherited, &[]) {
                Some(inherited) => {
                    let layer = node.attribute("id").unwrap_or(inherited.layer);
                    children(node, Inherited { layer, ..inherited }, height_mm, shapes)?
                }
                None => false,
            },
            "path" => match attributes(node, inherited, &["d"]) {
                Some(inherited) => {
                    if inherited.filled || inherited.lines {
                        shapes.extend(shape(node, inherited, height_mm)?);
                    }
                    true
                }
                None => false,
            },
            _ => false,
        };
        if !plain {
            return Ok(false);
        }
    }
    Ok(true)
}

/// What an element with only plain attributes, and `own` ones, hands down.
fn attributes<'a>(node: Node<'a, '_>, inherited: Inherited<'a>, own: &[&str]) -> Option<Inherited<'a>> {
    let mut result = inherited;
    for attribute in node.attributes() {
        match (attribute.name(), attribute.value().trim()) {
            (name, _) if own.contains(&name) || name == "id" || name.starts_with("data-") => {}
            ("fill", "none") => result.filled = false,
            // References, transparent and inherited paints need the resolver.
            ("fill", paint) if is_opaque(paint) => result.filled = true,
            ("fill-rule", "evenodd") => result.rule = FillRule::EvenOdd,
            ("fill-rule", "nonzero") => result.rule = FillRule::NonZero,
            ("stroke", "none") => {}
            ("stroke" | "stroke-width", _) if result.lines => {}
            _ => return None,
        }
    }
    Some(result)
}

/// `#rgb`, `#rrggbb` and a few names: the paints that need no colour parser to be called opaque.
fn is_opaque(paint: &str) -> bool {
    let hex = |h: &str| matches!(h.len(), 3 | 6) && h.bytes().all(|b| b.is_ascii_hexdigit());
    paint.strip_prefix('#').map_or(matches!(paint, "black" | "white" | "currentColor"), hex)
}

fn shape(node: Node<'_, '_>, inherited: Inherited<'_>, height_mm: f64) -> Result<Option<Shape>, VerifyError> {
    let Some(data) = node.attribute("d") else { return Ok(None) };
    let element = element_name("path", node.attribute("id"));
    let line = node.document().text_pos_at(node.range().start).row;
    if data.trim().is_empty() {
        return Ok(None);
    }
    match bez_path(data) {
        Ok(mut path) => {
            path.apply_affine(upright(height_mm));
            let (rule, layer) = (inherited.rule, inherited.layer.to_owned());
            Ok(Some(Shape { element, line, path, rule, layer, is_stroke: false }))
        }
        Err(e) => {
            Err(VerifyError::PathData { element, line, message: format!("its data cannot be read: {e}") })
        }
    }
}
