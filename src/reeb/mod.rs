//! Critical points, the Reeb graph and the cuts, exact from the vertices of a region.
//!
//! Zhou 2014 §5.2 rasterises the exemplar and scans its columns for events. Here a line sweeps over the
//! contours: an event is a vertex that is a local extremum in x, so no event is lost to a pixel or made by
//! one. [`ReebGraph`] holds the events and the strands between them, [`persistence`] says how large each
//! event is, and [`Slicing`] puts a cut between neighbouring events of sufficient size.
//!
//! What this room promises to the next: no vertex of the region lies on a cut, cuts ascend, and along a cut
//! no two crossings coincide, so the order of portal endpoints is strict. The mirrored exemplar is cut at the
//! mirrored places, up to ties and steps of the grid.

mod cuts;
mod graph;
mod intervals;
mod kept;
pub mod persistence;
mod section;
mod sweep;

pub use cuts::{Cut, CutDropped, Slicing, SlicingError, SlicingRule};
pub use graph::{CriticalPoint, Event, ReebGraph, Strand};
pub use kept::KeptRange;
pub use section::{CrossSections, Crossing};
