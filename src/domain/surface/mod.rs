//! Curves on models: what lies on a surface of triangles, and how far that surface is.
//!
mod closest;
mod curve;
mod error;
mod exact;
mod mesh;
mod orient;
mod repair;
#[cfg(test)]
mod sample_meshes;
mod section;
mod sides;
mod soup;

pub use curve::MeshCurve;
pub use error::SurfaceError;
pub use mesh::{Mesh, MeshPart};
pub use repair::{MeshRepair, RepairKind};
