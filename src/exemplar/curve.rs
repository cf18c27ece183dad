//! One path of an SVG file as a curve in millimetres: the line along which a band runs.
//!
//! How the path is painted does not matter, nor what else is in the file; only the one element must be sound.
//! Excluded: paths that are made of several pieces.

use std::path::Path;

use kurbo::{Affine, BezPath, PathEl};
use roxmltree::Node as XmlNode;
use usvg::{Group, Node};

use super::artwork::{affine, bez_path, fill_rule, library_tree, page_to_mm};
use super::check::Checker;
use super::error::{ExemplarError, ExemplarFault, Place};
use super::limits::Limits;
use super::scan::{Strictness, scan};
use super::source::{SHAPES, Source, label, svg_tag};
use crate::planar::FillRule;

/// The ids that an error lists at most.
const LISTED: usize = 12;

/// The path with this `id` of the SVG file at `path`, or its only path when no id is given: in millimetres, y
/// up, where the drawing has it on its page. Lines, polylines, polygons, rectangles, circles and ellipses are
/// paths too, and the last four are closed.
///
/// # Errors
/// [`ExemplarError`] when the file cannot be read, holds no such path or no single one (the ids are listed),
/// or the path is broken or has several subpaths.
pub fn read_path(path: &Path, id: Option<&str>, limits: &Limits) -> Result<BezPath, ExemplarError> {
    let file = path.display().to_string();
    let bytes = super::read_bytes(path, limits).map_err(|fault| ExemplarError::new(&file, fault))?;
    parse(&bytes, id, limits).map_err(|fault| ExemplarError::new(file, fault))
}

/// [`read_path`] for a document in memory, which errors call `name`.
///
/// # Errors
/// As [`read_path`].
pub fn path_from_svg(
    name: &str,
    bytes: &[u8],
    id: Option<&str>,
    limits: &Limits,
) -> Result<BezPath, ExemplarError> {
    parse(bytes, id, limits).map_err(|fault| ExemplarError::new(name, fault))
}

fn parse(bytes: &[u8], id: Option<&str>, limits: &Limits) -> Result<BezPath, ExemplarFault> {
    let Named { path, place, .. } = named(bytes, id, limits)?;
    let count = path.elements().iter().filter(|el| matches!(el, PathEl::MoveTo(_))).count();
    if count > 1 {
        return Err(ExemplarFault::Subpaths { place, count });
    }
    Ok(path)
}

/// One path of a drawing.
pub(super) struct Named {
    pub(super) place: Place,
    /// In millimetres, y up.
    pub(super) path: BezPath,
    /// By which rule it is filled, if it has a fill.
    pub(super) rule: Option<FillRule>,
}

/// The path with this `id`, or the only one.
pub(super) fn named(bytes: &[u8], id: Option<&str>, limits: &Limits) -> Result<Named, ExemplarFault> {
    let source = Source::parse(bytes, limits)?;
    scan(&source, limits, Strictness::Structure)?;
    let node = choose(&source, id)?;
    let place = source.place(node);
    let checker = Checker { source: &source, limits };
    checker.shape(node, svg_tag(node).unwrap_or_default())?;
    for around in node.ancestors().filter(XmlNode::is_element) {
        checker.transforms(around)?;
    }
    let (tree, _) = library_tree(&source, limits)?;
    let to_mm = page_to_mm(f64::from(tree.size().height()));
    let Some((found, to_mm)) = find(tree.root(), to_mm, &label(node)) else {
        return Err(ExemplarFault::NotInDrawing { place });
    };
    let rule = found.fill().map(|fill| fill_rule(fill.rule()));
    Ok(Named { place, path: to_mm * bez_path(found.data()), rule })
}

fn choose<'a, 'i>(source: &'a Source<'i>, id: Option<&str>) -> Result<XmlNode<'a, 'i>, ExemplarFault> {
    let is_path = |n: &XmlNode| svg_tag(*n).is_some_and(|tag| SHAPES.contains(&tag));
    let paths = || source.root().descendants().filter(is_path).filter(|n| !defined(*n));
    let found = || {
        let mut ids: Vec<&str> = paths().filter_map(|n| n.attribute("id")).take(LISTED + 1).collect();
        if ids.len() > LISTED {
            ids[LISTED] = "...";
        }
        if ids.is_empty() { "none (give the path an id)".to_owned() } else { ids.join(", ") }
    };
    if let Some(id) = id {
        let node = source.root().descendants().find(|n| n.attribute("id") == Some(id));
        let node = node.ok_or_else(|| ExemplarFault::NoSuchId { id: id.to_owned(), found: found() })?;
        return if is_path(&node) {
            Ok(node)
        } else {
            Err(ExemplarFault::NotAPath { place: source.place(node) })
        };
    }
    let mut all = paths();
    match (all.next(), all.next()) {
        (Some(only), None) => Ok(only),
        (None, _) => Err(ExemplarFault::NothingDrawn),
        _ => Err(ExemplarFault::WhichPath { count: paths().count(), found: found() }),
    }
}

/// Whether an element only defines something for others to use.
fn defined(node: XmlNode) -> bool {
    const DEFINING: [&str; 6] = ["defs", "symbol", "clipPath", "mask", "marker", "pattern"];
    node.ancestors().any(|n| svg_tag(n).is_some_and(|tag| DEFINING.contains(&tag)))
}

fn find<'t>(group: &'t Group, outer: Affine, label: &str) -> Option<(&'t usvg::Path, Affine)> {
    let transform = outer * affine(group.transform());
    group.children().iter().find_map(|node| match node {
        Node::Group(inner) => find(inner, transform, label),
        Node::Path(path) if path.id() == label => Some((path, transform)),
        _ => None,
    })
}
