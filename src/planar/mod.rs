//! Plane geometry in millimetres: an exact integer grid, validated regions, predicates and the one adapter
//! to the third-party overlay engine.
//!
//! Everything topological in Openwork is decided on [`GridPoint`]s, which are `i64` multiples of a power of
//! two of a millimetre. Floats are snapped once, by a [`Grid`] chosen from the extent, and turned back
//! without rounding. y points up; an exterior runs counter-clockwise and a hole clockwise, so the ink is
//! always on the left of an edge.
//!
//! What this room promises to the next: the contours of a [`Region`] are simple and pairwise disjoint, not
//! even sharing a vertex. Its number of components is therefore its number of exteriors, its number of
//! holes the number of clockwise contours, and nothing hangs together by a point.

#[cfg(test)]
mod boxes;
mod chords;
mod contour;
mod grid;
mod index;
mod motion;
mod overlay;
mod region;
mod sets;
mod split;
mod stroke;
mod threads;
mod tolerances;
mod touch;

#[cfg(test)]
pub(crate) use boxes::boxes;
pub use chords::{Chords, chords};
pub use contour::Contour;
pub use grid::{Grid, GridError, GridPoint, orient};
pub use index::{EdgeIndex, IndexedEdge};
pub use overlay::{FillRule, boundaries};
pub use region::{Fault, Part, Region, RegionError};
pub use sets::Sets;
pub use stroke::stroked;
pub use threads::threads;
pub use tolerances::{Tolerances, TolerancesError};
