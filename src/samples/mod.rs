//! The second engine: sample graphs (Tu 2020, Continuous Curve Textures).
//!
//! A pattern of curves and elements is turned into samples with edges; samples of the output are moved, added, removed and joined until
//! around each of them it looks as somewhere in the exemplar; curves are drawn through what comes of it; and what was joined by no edge
//! is joined, or opened, until the ink has the components and holes that were asked for.
//!
//! ```text
//! Drawing --> sampling --> search <--> assignment --> reconstruction --> completion --> Drawing, Region
//!                              for each level
//! ```

mod area;
mod assignment;
mod border;
mod complete;
mod copies;
mod cubic;
mod drawing;
mod draws;
mod edges;
mod elements;
mod existence;
mod given;
mod graph;
mod ink;
mod level;
mod lines;
mod neighbours;
mod options;
mod orientations;
mod parallel;
mod positions;
mod reconstruct;
mod resample;
mod sampling;
mod scale;
mod search;
mod similarity;
mod source;
mod start;
mod synthesis;

pub use area::Area;
pub use complete::{Change, ChangeKind, CompleteError, CompleteOptions, Completed, complete};
pub use copies::CloneBox;
pub use drawing::{Curve, Drawing, Element};
pub use elements::{Class, Elements, Placed, Similarity};
pub use given::{Given, clear_of};
pub use graph::{Adjacency, Edge, Graph, Kind, Sample};
pub use ink::inked;
pub use level::{LevelReport, MOST_NEIGHBOURS, SampleError};
pub use options::{Border, Level, Options, Start, UnmatchedPrice, Without};
pub use reconstruct::{Reconstruction, Route, reconstruct};
pub use sampling::{Resolution, sampled};
pub use scale::default_levels;
pub use synthesis::{Synthesis, synthesize};
