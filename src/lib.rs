//! Ornament that can be made: new pattern from one SVG ornament, with exactly the components and holes that
//! were asked for, written as a part and counted again on the file.

pub mod analysis;
pub mod cli;
pub mod domain;
pub mod exemplar;
pub mod export;
pub mod fabricate;
pub mod fit;
pub mod job;
pub mod pieces;
pub mod planar;
pub mod reeb;
pub mod solver;
pub mod topology;
pub mod verify;
