//! Whole jobs.
mod plan;
pub use plan::{Plan, PlanError, PlanOptions, plan};
