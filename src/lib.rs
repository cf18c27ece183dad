//! Ornament that can be made: new pattern from one SVG ornament, with exactly the components and holes that
//! were asked for, written as a part and counted again on the file.
pub mod planar;
pub mod verify;
