//! Counts what a written *file* holds: components, holes, shells, genus, the narrowest ink and gap.
//!
//! The promise of Openwork is about the file, not the plan. So the bytes are read again here, by code that
//! shares nothing with the code that made them beyond [`crate::planar`], and what is found can be checked
//! against what was asked for ([`Expected`]). [`read_svg`] fills every path under its own rule and counts on
//! the union; [`read_dxf`] and [`read_cut_svg`] judge lines to be cut; [`read_stl`], [`read_threemf`] and [`read_obj`] weld
//! corners by their exact bits, count shells and genus by Euler's formula and look for facets that cross.
//! "At the tolerance of the machine" means that the counts stay the same after eroding by half of the
//! minimum feature and after dilating by half of the minimum gap ([`endures_erosion`],
//! [`endures_dilation`]); where they would change first is measured by [`widths`].
//!
//! Whoever has the plan of a file can hold it against that too, as counts know nothing of size and place ([`Unlike`]).
//! [`replay_certificate`] adds the sequence of a report up again, join by join, and holds it against the file.
//!
//! Excluded: repair. What cannot be judged (text, images, masks, filters, clip paths) is an error that says
//! so; what can be judged but is not in order is a fault in the report.

mod ascent;
mod boxes;
mod certificate;
mod check;
mod clearance;
mod crossings;
mod cut_svg;
mod cutlines;
mod drawing;
mod drawn;
mod dxf;
mod endure;
mod error;
mod facets;
mod json;
mod likeness;
mod narrowest;
mod obj;
mod path_data;
mod plain;
mod plates;
mod replay;
mod shells;
mod spline;
mod stl;
mod stretches;
mod svg;
mod threemf;
mod tiling;
mod walls;

pub use certificate::{
    CertificateError, CertificateFault, CertificatePlace, CertificateReport, Counted, replay_certificate,
};
pub use check::{Between, Expected, Mismatch};
pub use cut_svg::{has_cut_lines, read_cut_svg};
pub use cutlines::{CutFault, CutLayer, CutReport};
pub use dxf::read_dxf;
pub use endure::{endures_dilation, endures_erosion};
pub use error::VerifyError;
pub use facets::read_facets;
pub use likeness::{Extent, Unlike};
pub use narrowest::{NarrowPlaces, Narrowest, Widths, min_feature, min_gap, narrow_places, widths};
pub use obj::read_obj;
pub use shells::{MeshFault, MeshFaultKind, MeshReport, Shell};
pub use stl::read_stl;
pub use svg::{SvgFault, SvgReport, read_svg};
pub use threemf::read_threemf;
pub use tiling::{Rolled, Tiling, TilingFault, rolled, tiling};
