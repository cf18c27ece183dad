//! From a sequence of pieces to closed outlines in band coordinates.
//!
//! [`Placed`] sets the pieces along the band, with vertical [`offsets`] (Zhou 2014 §4.1), and averages the endpoints and
//! tangents of neighbours. A [`Stitch`] bends each piece to what its neighbours expect (§4.2), and [`Outline`] links the
//! bent chains into contours (§4.3).
//!
//! There are two ways to bend. The [warp](StripWarp) is a homeomorphism of the strip that each piece lies in, so the
//! outline has the topology of the plan by construction, up to the rounding of points. [Rotation-invariant
//! deformation](Lri) is the paper's; as nothing keeps its contours from crossing, each piece that it bent is checked
//! exactly, and warped if it did not hold.

mod interpolant;
mod least_squares;
mod links;
mod lri;
mod offsets;
mod outline;
mod placed;
#[cfg(test)]
mod sample_pieces;
mod sound;
mod stitch;
mod warp;

pub use interpolant::Monotone;
pub use lri::{Lri, LriBend};
pub use offsets::offsets;
pub use outline::{Fallback, Outline, OutlineContour, Seam};
pub use placed::{FitError, FitOptions, Placed, Prepared, Sides};
pub use sound::Unsound;
pub use stitch::{Bent, SideTarget, Stitch, StitchMethod, Targets};
pub use warp::StripWarp;
