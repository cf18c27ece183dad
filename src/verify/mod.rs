//! verify
mod clearance;
mod endure;
mod narrowest;
mod report;
pub use endure::{endures_dilation, endures_erosion};
pub use narrowest::{Narrowest, Widths, min_feature, min_gap, widths};
