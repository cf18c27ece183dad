//! Curves on models: what lies on a surface of triangles, and how far that surface is.
//!
mod closest;
mod curve;
mod disc;
mod error;
mod exact;
mod heights;
mod mean_value;
mod mesh;
mod orient;
mod repair;
mod route;
#[cfg(test)]
mod sample_meshes;
mod section;
mod sides;
mod soup;
mod thicken;
mod through;
mod walk;

pub use curve::MeshCurve;
pub use error::SurfaceError;
pub use heights::MeshHeights;
pub use mesh::{Mesh, MeshPart};
pub use repair::{MeshRepair, RepairKind};
