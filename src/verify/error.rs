//! Why a file could not be judged at all.

use thiserror::Error;

use crate::planar::GridError;

/// Why a file could not be judged. What can be judged but is wrong is a fault of the report instead.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerifyError {
    /// More bytes than are read.
    #[error("the file has {bytes} bytes; at most {limit} are read")]
    TooLarge {
        /// The size of the file.
        bytes: usize,
        /// The largest size that is read.
        limit: usize,
    },
    /// Not UTF-8 text.
    #[error("byte {offset} is not UTF-8 text; an uncompressed SVG in UTF-8 is wanted")]
    NotText {
        /// The first byte that is no text.
        offset: usize,
    },
    /// Not well-formed XML.
    #[error("not well-formed XML: {message}")]
    Xml {
        /// What the parser says, with line and column.
        message: String,
    },
    /// Another kind of XML.
    #[error("the root element is <{found}>; an SVG has <svg>")]
    NotSvg {
        /// The root element's name.
        found: String,
    },
    /// Path data that cannot be read.
    #[error("{element} on line {line}: {message}")]
    PathData {
        /// The element, with its id if it has one.
        element: String,
        /// Its line in the file.
        line: u32,
        /// What is wrong.
        message: String,
    },
    /// Something in the SVG that paints, but not as filled or stroked paths.
    #[error("{element} on line {line}: {what} cannot be counted; {instead}")]
    Unsupported {
        /// The element, with its id if it has one.
        element: String,
        /// Its line in the file; 0 when it is not known.
        line: u32,
        /// What it is.
        what: &'static str,
        /// What would work.
        instead: &'static str,
    },
    /// The SVG does not resolve.
    #[error("the SVG cannot be resolved: {message}")]
    Resolve {
        /// What the resolver says.
        message: String,
    },
    /// A coordinate that is out of range or not a number.
    #[error("{element} on line {line}: {source}")]
    Coordinate {
        /// The element, with its id if it has one.
        element: String,
        /// Its line in the file; 0 when it is not known.
        line: u32,
        /// What is wrong with it.
        source: GridError,
    },
    /// A coordinate of a cut line that is out of range or not a number.
    #[error("{element}: {source}")]
    CutCoordinate {
        /// The element, with its line in the file.
        element: String,
        /// What is wrong with it.
        source: GridError,
    },
    /// A DXF that cannot be read, or has what cannot be judged.
    #[error("line {line}: {message}")]
    Dxf {
        /// Where.
        line: u32,
        /// What is wrong, and what would work.
        message: String,
    },
    /// A binary STL whose length does not agree with its header.
    #[error(
        "the header promises {triangles} triangles, which are {wanted} bytes, but the file has {found}: it was cut off or is no STL"
    )]
    Length {
        /// The count in the header.
        triangles: u32,
        /// The length that goes with it, in bytes.
        wanted: u64,
        /// The length of the file, in bytes.
        found: u64,
    },
    /// Too short for any STL.
    #[error("{bytes} bytes are too few for an STL, which has at least 84")]
    TooShort {
        /// The length of the file, in bytes.
        bytes: usize,
    },
    /// An ASCII STL that does not parse.
    #[error("not a readable ASCII STL: {message}")]
    AsciiStl {
        /// What the parser says.
        message: String,
    },
    /// Not a whole archive, as a 3MF is one.
    #[error("not a readable 3MF package: {message}; it was cut off or is no 3MF")]
    Archive {
        /// What the unpacker says.
        message: String,
    },
    /// A 3MF package without the part that it needs.
    #[error("the 3MF package has no {part}, so there is nothing to count")]
    NoModel {
        /// What is missing.
        part: String,
    },
    /// Something in the model of a 3MF or in an OBJ that cannot be read.
    #[error("line {line} of the {kind}: {message}")]
    Mesh {
        /// `3MF model` or `OBJ`.
        kind: &'static str,
        /// The line, counted from 1.
        line: u32,
        /// What is wrong, and what is wanted.
        message: String,
    },
    /// A mesh without triangles.
    #[error("the file has no triangles")]
    NoFacets,
    /// A corner that is NaN or infinite.
    #[error("facet {facet} has a corner that is not a finite number")]
    NotFinite {
        /// The facet, counted from 0.
        facet: usize,
    },
}
