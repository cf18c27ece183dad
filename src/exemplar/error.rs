//! Why a file is no exemplar: what was found, where, what was wanted and what would work.

use std::fmt;

use thiserror::Error;

use crate::planar::GridError;

/// An element of an SVG file, as an error message names it: `<path id="leaf"> on line 12`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The tag name without a prefix.
    pub tag: Box<str>,
    /// The element's own id.
    pub id: Option<Box<str>>,
    /// The line of the file on which the element begins, counted from 1.
    pub line: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.id {
            Some(id) => write!(f, "<{} id=\"{id}\"> on line {}", self.tag, self.line),
            None => write!(f, "<{}> on line {}", self.tag, self.line),
        }
    }
}

/// A file that is no exemplar: the file and what is wrong with it.
#[derive(Debug, Error)]
#[error("{file}: {fault}")]
pub struct ExemplarError {
    file: String,
    fault: Box<ExemplarFault>,
}

impl ExemplarError {
    pub(super) fn new(file: impl Into<String>, fault: ExemplarFault) -> Self {
        Self { file: file.into(), fault: Box::new(fault) }
    }

    /// The path of the file as it was given, or the name given to bytes in memory.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// What is wrong.
    pub fn fault(&self) -> &ExemplarFault {
        &self.fault
    }
}

/// What can be wrong with a file.
#[derive(Debug, Error)]
pub enum ExemplarFault {
    /// There is no such file.
    #[error("there is no such file; check the path")]
    Missing,
    /// The operating system does not let us read the file.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// Larger than [`super::Limits::bytes`].
    #[error("is larger than the limit of {limit} bytes; simplify the drawing, or raise the byte limit")]
    TooManyBytes {
        /// The limit that was set.
        limit: usize,
    },
    /// A gzip file.
    #[error("is gzip-compressed (svgz); decompress it first: gunzip -c FILE.svgz > FILE.svg")]
    Compressed,
    /// Bytes that are not UTF-8.
    #[error("is not UTF-8 text (first wrong byte on line {line}); save the drawing again as UTF-8 SVG")]
    NotUtf8 {
        /// The line of the first wrong byte.
        line: usize,
    },
    /// The text is empty or blank.
    #[error("is empty; an SVG drawing is wanted")]
    Blank,
    /// Not well-formed XML.
    #[error("is not well-formed XML: {detail}; save the drawing again from the program that made it")]
    NotXml {
        /// What the XML parser found, with its line and column.
        detail: String,
    },
    /// XML of another kind.
    #[error("is XML, but its root is <{root}>, not <svg>; an SVG drawing is wanted")]
    NotSvg {
        /// The tag of the root element.
        root: String,
    },
    /// A document type that defines entities.
    #[error(
        "defines XML entities (<!ENTITY> on line {line}), which are not expanded; save as plain SVG (in Inkscape: \
         Save As, Plain SVG)"
    )]
    Entity {
        /// The line of the first definition.
        line: usize,
    },
    /// Styles that are in another file or depend on the viewer.
    #[error("{what} on line {line} is not followed; put the styles into the elements (save as plain SVG)")]
    StyleSheet {
        /// What was found.
        what: String,
        /// Where.
        line: usize,
    },
    /// More than [`super::Limits::elements`].
    #[error(
        "has more than {limit} elements, counting every use of a symbol; simplify the drawing, or raise the element \
         limit"
    )]
    TooManyElements {
        /// The limit that was set.
        limit: usize,
    },
    /// Deeper than [`super::Limits::nesting`].
    #[error(
        "{place} is nested more than {limit} levels deep; ungroup the drawing, or raise the nesting limit"
    )]
    TooDeep {
        /// The first element beyond the limit.
        place: Place,
        /// The limit that was set.
        limit: usize,
    },
    /// More than [`super::Limits::segments`].
    #[error(
        "{place} brings the drawing over the limit of {limit} path segments; simplify the path, or raise the segment \
         limit"
    )]
    TooManySegments {
        /// The element with which the limit was passed.
        place: Place,
        /// The limit that was set.
        limit: usize,
    },
    /// More than [`super::Limits::vertices`].
    #[error(
        "{place} brings the flattened drawing over the limit of {limit} vertices; use a larger chord, or raise the \
         vertex limit"
    )]
    TooManyVertices {
        /// The element with which the limit was passed.
        place: Place,
        /// The limit that was set.
        limit: usize,
    },
    /// A number beyond [`super::Limits::coordinate`], or a shape beyond 100 m.
    #[error(
        "{place}: the coordinate {value:e} is out of range (at most {limit:e} {unit}); correct the element"
    )]
    Coordinate {
        /// Where.
        place: Place,
        /// The number found.
        value: f64,
        /// The largest that is accepted.
        limit: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// So far from its own origin that single precision, which the SVG library uses, would show.
    #[error(
        "{place} lies {ratio:.0} times its drawing's size away from the origin, too far to be read precisely; move the \
         drawing to the origin and save it again"
    )]
    Imprecise {
        /// Where.
        place: Place,
        /// Distance from the origin over the size of the drawing.
        ratio: f64,
    },
    /// An attribute or style property that does not mean anything.
    #[error("{place}: {name}=\"{value}\" is not valid: {wanted}")]
    Attribute {
        /// Where.
        place: Place,
        /// The attribute or property.
        name: String,
        /// Its value, shortened.
        value: String,
        /// What would be accepted.
        wanted: String,
    },
    /// Path data that cannot be read to its end.
    #[error(
        "{place}: the path data cannot be read beyond segment {segment} (character {at}, near \"{near}\"); correct \
         the d attribute there"
    )]
    PathData {
        /// Where.
        place: Place,
        /// The number of good segments before.
        segment: usize,
        /// The character of the `d` attribute, counted from 1.
        at: usize,
        /// The text there.
        near: String,
    },
    /// A link that leads nowhere, or to the wrong kind of thing.
    #[error("{place}: {property} refers to \"{target}\", {problem}; correct the link or remove it")]
    Reference {
        /// Where.
        place: Place,
        /// The attribute or property that holds the link.
        property: String,
        /// The link.
        target: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A `use` that contains itself.
    #[error("{place} uses itself, directly or through others; remove one of the links")]
    RecursiveUse {
        /// One of the elements in the loop.
        place: Place,
    },
    /// Text, for which fonts would be needed.
    #[error(
        "{place} is text, which is not converted to outlines here; convert it to paths first (in Inkscape: select it, \
         then Path, Object to Path) or delete it"
    )]
    Text {
        /// Where.
        place: Place,
    },
    /// Something else that ink cannot represent.
    #[error("{place} {what}; {remedy}")]
    Unsupported {
        /// Where.
        place: Place,
        /// What it is.
        what: String,
        /// What would work.
        remedy: &'static str,
    },
    /// Paint that is neither there nor not there.
    #[error(
        "{place} has {what} {opacity}; material is there or not, so set it to 1 to make it ink, or delete the element"
    )]
    PartialOpacity {
        /// Where.
        place: Place,
        /// Which opacity: of a fill, a stroke, a gradient or a group.
        what: &'static str,
        /// Its value, between 0 and 1.
        opacity: f32,
    },
    /// White among other colours.
    #[error(
        "{place} is painted white among other colours ({count} white paint(s) in all), so it is unclear whether it is \
         ink; if it is a background, delete it; if it is meant to cut away, subtract it from what lies below (in \
         Inkscape: Path, Difference); if it is ink, give it the colour of the rest"
    )]
    White {
        /// The first white element.
        place: Place,
        /// The number of white fills and strokes.
        count: usize,
    },
    /// A painted shape that covers no area.
    #[error(
        "{place} is filled but encloses no area; give it a stroke, close it around an area, or delete it"
    )]
    NoArea {
        /// Where.
        place: Place,
    },
    /// A page without size.
    #[error("{place} has a width, height or viewBox that is not positive; give the drawing a size")]
    PageSize {
        /// The root element.
        place: Place,
    },
    /// A shape that the SVG library left out for a reason that we do not know.
    #[error(
        "{place} could not be converted, and nothing may be left out silently; redraw the element or delete it"
    )]
    Dropped {
        /// Where.
        place: Place,
    },
    /// No shape at all.
    #[error(
        "draws nothing: there are no visible shapes; an ornament drawn as filled or stroked paths is wanted"
    )]
    NothingDrawn,
    /// Shapes, but no ink.
    #[error("has no filled area: nothing in it is painted with a fill or a stroke; give the shapes a fill")]
    NoInk,
    /// A scale or a size that cannot be used.
    #[error("{name} is {value}; it must be {wanted}")]
    Option {
        /// The option's name.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would be accepted.
        wanted: &'static str,
    },
    /// The drawing is too small or too large for the grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// No element with the id that was asked for.
    #[error("has no element with the id \"{id}\"; its paths have the ids: {found}")]
    NoSuchId {
        /// The id asked for.
        id: String,
        /// The ids of the paths in the file.
        found: String,
    },
    /// The element that was asked for is not a path.
    #[error("{place} is not a path; a path, line, polyline, polygon, rect, circle or ellipse is wanted")]
    NotAPath {
        /// Where.
        place: Place,
    },
    /// The file does not hold exactly one path.
    #[error("holds {count} paths, so one must be named: add #id to the file name; the ids are: {found}")]
    WhichPath {
        /// How many.
        count: usize,
        /// Their ids.
        found: String,
    },
    /// The path is not part of the drawing.
    #[error(
        "{place} is not part of the drawing: it is inside <defs>, <symbol> or the like, or its display is none; move \
         it to the top level"
    )]
    NotInDrawing {
        /// Where.
        place: Place,
    },
    /// The path has an open subpath where the inside of one is wanted.
    #[error(
        "{place} is open, and the inside of a closed path is wanted; close it (z at the end of its data)"
    )]
    OpenArea {
        /// Where.
        place: Place,
    },
    /// The path has more than one piece.
    #[error("{place} has {count} subpaths; one connected curve is wanted (in Inkscape: Path, Break Apart)")]
    Subpaths {
        /// Where.
        place: Place,
        /// How many.
        count: usize,
    },
}

/// The first 40 characters of a value, for a message.
pub(super) fn shortened(value: &str) -> String {
    const LONGEST: usize = 40;
    match value.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &value[..end]),
        None => value.to_owned(),
    }
}
