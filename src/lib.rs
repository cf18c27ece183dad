//! Ornament that can be made: new pattern from one SVG ornament, with exactly the components and holes that
//! were asked for, written as a part and counted again on the file.
//!
//! [`job`] is where to begin: a builder takes an exemplar and a curve, and the band that it makes writes itself
//! as SVG, STL and PNG.
//!
//! ```no_run
//! use openwork::job::{BandBuilder, Output};
//!
//! let band = BandBuilder::new("fixtures/exemplars/vine.svg", "circle:65mm".parse()?)
//!     .width_mm(14.0)
//!     .components(1)
//!     .closed_pattern(true)
//!     .build()?
//!     .run(&mut |_| {})?;
//! let report = band.write(&[Output::file("bracelet.stl")?], None, &mut |_| {})?;
//! println!("{} component(s), {} hole(s)", report.components, report.holes);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The other rooms are the steps of such a job, and data flows through them one way. [`exemplar`] reads the
//! ornament into a clean region of the [`planar`] grid; [`reeb`] finds its events and cuts; [`pieces`] cuts it
//! up and weighs every join. [`topology`] knows what runs of pieces add up to, and [`solver`] finds the cheapest
//! one that meets the constraints. [`fit`] bends the pieces until they meet, [`domain`] lays the outline along
//! the curve, [`fabricate`] makes a solid of it, [`export`] writes the files, and [`verify`] counts on them, knowing
//! nothing of how they came to be. [`analysis`] shows how an exemplar is understood; [`cli`] is the program.
//!
//! The method is that of Zhou, Jiang and Lefebvre, *Topology-Constrained Synthesis of Vector Patterns* (2014),
//! cited as Zhou 2014. Lengths are millimetres; y points up.

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
pub mod samples;
pub mod solver;
pub mod topology;
pub mod verify;
