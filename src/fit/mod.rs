//! From a sequence of pieces to closed outlines in band coordinates.
//!
//! [`offsets`] places the pieces vertically (Zhou 2014 §4.1), a [`warp`](StripWarp) bends each so that its
//! portal endpoints and tangents meet its neighbours' halfway (in place of §4.2), and [`Outline`] links the
//! bent chains into contours (§4.3).
//!
//! The warp is a homeomorphism of the strip that each piece lies in, so the outline has the topology of the
//! plan by construction, up to the rounding of points. Linear rotation-invariant deformation can stand beside
//! it as another implementation of [`Stitch`].

mod interpolant;
mod offsets;
mod outline;
mod warp;

pub use interpolant::Monotone;
pub use offsets::offsets;
pub use outline::{FitError, FitOptions, Outline, OutlineContour, Seam, Sides};
pub use warp::{SideTarget, Stitch, StripWarp};
