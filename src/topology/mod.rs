//! The algebra of descriptors, and the automaton of what can be reached.
//!
//! A [`Descriptor`] says how the portals of a piece, or of any run of pieces, are connected inside it, and
//! how many components and holes it has (Zhou 2014 §3.4). [`Descriptor::join`] glues two at their common
//! portals, [`Descriptor::close`] glues a run to itself. The [`Automaton`] walks runs piece by piece for a
//! [`Goal`], keeps only what the goal can still tell apart, and knows which states are dead.
//!
//! What this room promises to the next: a run that the automaton accepts has exactly the components, holes
//! and winding of the goal when its geometry is glued as its portals say. Coordinates are not known here.

mod automaton;
mod descriptor;
mod goal;
mod union_find;

pub use automaton::{Automaton, Dominance, StateId};
pub use descriptor::{Descriptor, DescriptorError, Topology};
pub use goal::{Goal, Shape, Wanted, WantedError};
