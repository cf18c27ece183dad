//! Files: SVG, DXF, STL, 3MF, OBJ and PNG writers, and outputs that appear whole or not at all.
//!
//! A writer turns a region or a solid into bytes; [`stage`] and [`persist_all`] turn bytes into files. The
//! two are apart so that what was written can be read again and verified under its temporary name, before
//! anything exists under the name that was asked for.
//!
//! What this room promises to the next: the curves of an SVG or DXF lie within the chord tolerance of the region
//! and have its components and holes; STL, 3MF and OBJ have the solid's coordinates unrounded; the same input gives the
//! same bytes. Excluded: standard output, and how shapes came to be.

mod arcs;
mod canvas;
mod clearance;
mod contact_sheet;
mod curves;
mod cut_svg;
mod cutlines;
mod dxf;
mod layer;
mod mesh;
mod obj;
mod order;
mod outline;
mod outlines;
mod png;
mod runs;
mod staged;
mod stl;
mod svg;
mod text;
mod threemf;
mod view;

pub use contact_sheet::{Shown, contact_sheet};
pub use cut_svg::cut_svg;
pub use cutlines::{CutLines, CutNumbers};
pub use dxf::{DxfVersion, dxf};
pub use layer::{Layer, LayerColours};
pub use mesh::MeshDocument;
pub use obj::obj;
pub use outlines::Curves;
pub use png::{DEFAULT_PIXELS, Marks, png};
pub use staged::{Staged, check_destination, persist_all, remove_staged, stage};
pub use stl::stl;
pub use svg::{SvgDocument, SvgOptions, svg};
pub use threemf::threemf;
pub use view::{DEFAULT_COLOUR, Painted, View, view_png};

use std::io;
use std::path::{Path, PathBuf};

use glam::DVec2;
use thiserror::Error;

/// Why a file cannot be written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// A setting of a writer is out of range.
    #[error("{name} is {found}; it must be {wanted}")]
    Option {
        /// The setting.
        name: &'static str,
        /// What was given.
        found: f64,
        /// What would be accepted.
        wanted: &'static str,
    },
    /// Ink lies beyond the page.
    #[error(
        "the ink reaches from ({:.3}, {:.3}) to ({:.3}, {:.3}) mm, beyond the page of {:.3} x {:.3} mm; move \
         it or take a larger page", low_mm.x, low_mm.y, high_mm.x, high_mm.y, page_mm.x, page_mm.y
    )]
    OffPage {
        /// The lower left corner of the ink.
        low_mm: DVec2,
        /// The upper right corner of the ink.
        high_mm: DVec2,
        /// Width and height of the page.
        page_mm: DVec2,
    },
    /// There is nothing to draw.
    #[error("there is nothing to draw: the region is empty")]
    Empty,
    /// Curves that the release of a DXF cannot hold.
    #[error("DXF of release 12 has no splines; use --curves arcs or polyline, or the release 2000")]
    Splines,
    /// The picture could not be made: no memory, or ink narrower than can be drawn.
    #[error("the picture could not be drawn; a smaller size is likely to work")]
    Picture,
    /// More facets than an STL file can count.
    #[error("{found} facets are more than an STL file holds (4294967295); take a larger chord tolerance")]
    TooManyFacets {
        /// The number of facets.
        found: usize,
    },
    /// The output's name belongs to something else.
    #[error("cannot write {}: it is not a file; give a file name, or - for standard output", path.display())]
    NotAFile {
        /// The name as it was given.
        path: PathBuf,
    },
    /// The system refused.
    #[error("cannot write {}: {source}; {}", path.display(), remedy(source))]
    Write {
        /// The name as it was given.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The system refused one of several files, and others could not be taken back.
    #[error(
        "cannot write {}: {source}; {}. Of the same run these were written and could not be taken back: {}",
        path.display(), remedy(source), list(standing)
    )]
    Partly {
        /// The name as it was given.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
        /// The files that stand, each of them whole.
        standing: Vec<PathBuf>,
    },
}

fn list(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

impl ExportError {
    fn write(path: &Path, source: io::Error) -> Self {
        Self::Write { path: path.to_owned(), source }
    }
}

fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "make the directory first, or give another",
        io::ErrorKind::NotADirectory => "a part of the path is a file; give another directory",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "give a directory that can be written to"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space, or give another directory"
        }
        io::ErrorKind::FileTooLarge => "allow larger files (ulimit -f), or give a directory that holds them",
        _ => "try another directory",
    }
}
