//! From a flat region to a solid: snapping to what a file can hold, triangulation, extrusion along z.
//!
//! A mesh file holds 32-bit floats. Rounding to them at the very end would move vertices after the last
//! check, so the region is first brought onto a grid whose points are exact in `f32` and checked *there*;
//! the caps are triangulated in integers with every boundary vertex kept, and the walls stand on the same
//! vertices. The solid is therefore closed by construction and writing it changes nothing: a region of b0
//! components and b1 holes becomes b0 shells of total genus b1.
//!
//! Before that, bridges may give the region other counts ([`bridge()`]), and what is too thin or too narrow for a machine
//! ([`Process`]) may be mended ([`enforce()`]).
//!
//! Excluded: files, curved fronts, kerf. Nothing here knows how the region came to be.

mod bridge;
mod caps;
mod enforce;
mod material;
mod process;
mod snap;
mod solid;

pub use bridge::{Bridge, BridgeError, BridgeKind, BridgeOptions, Bridged, Counts, bridge};
pub use enforce::{Change, EnforceError, EnforceOptions, Enforced, TIP, enforce};
pub use material::{Material, MaterialReport};
pub use process::{Process, Workshop, WorkshopError, table as process_table};
pub use snap::snapped_to_f32;
pub use solid::{Solid, extrude};

use glam::DVec2;
use thiserror::Error;

use crate::planar::GridError;

/// Why a region cannot become a solid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FabricateError {
    /// The region has no ink.
    #[error("there is nothing to extrude: the region is empty")]
    Empty,
    /// The thickness is not a usable length.
    #[error("the thickness is {found_mm} mm; it must be from 0.001 to 100000 mm")]
    Thickness {
        /// What was given.
        found_mm: f64,
    },
    /// The region's extent does not fit the grid of 32-bit floats.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Features are finer than the 32-bit floats of a mesh file can tell apart.
    #[error(
        "at ({:.4}, {:.4}) mm contours are closer than the {step_mm:.1e} mm that a mesh file resolves at this \
         size; in 32-bit floats {found_components} component(s) and {found_holes} hole(s) would remain of \
         {components} and {holes}; move the drawing nearer to the origin, scale it up, or set a minimum \
         feature and gap", position_mm.x, position_mm.y
    )]
    TooFine {
        /// Where, in millimetres.
        position_mm: DVec2,
        /// The distance of neighbouring 32-bit floats at the region's extent.
        step_mm: f64,
        /// Components of the region.
        components: usize,
        /// Holes of the region.
        holes: usize,
        /// Components after snapping.
        found_components: usize,
        /// Holes after snapping.
        found_holes: usize,
    },
    /// The triangulation of a cap is not the cap: a fault of the engine, caught before it reaches a file.
    #[error(
        "the cap of the component at ({:.4}, {:.4}) mm was not triangulated exactly ({found}); please report \
         this drawing; moving or scaling it slightly is likely to help", position_mm.x, position_mm.y
    )]
    Triangulation {
        /// The least point of the component.
        position_mm: DVec2,
        /// What is wrong with the triangles.
        found: &'static str,
    },
}
