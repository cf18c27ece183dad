//! Curves on models: what lies on a surface of triangles, how far that surface is, and walls for it.
//!
//! A [`Mesh`] is a surface: facets from a file are welded, mended and turned until each edge has two facets or one,
//! and what was done is told. On it lie curves ([`MeshCurve`]), exactly, with a point wherever they cross an edge:
//! level ones around it ([`Mesh::around`]), and smooth ones through control points ([`Mesh::through`]), for which
//! the surface around the points is laid flat by mean value coordinates and a spline is walked over its triangles.
//! [`MeshHeights`] says how far the model is from a place beside such a curve, and [`Mesh::thickened`] gives an
//! open model a wall. Zhou 2014 §6.3.
//!
//! What is decided (what an edge joins, which side of a line a corner is on, whether a triangle turned over) is
//! decided by integers and exact signs; coordinates only say where. Excluded: reading files, the band that is laid
//! along the curve, and uniting it with the model.

mod closest;
mod curve;
mod disc;
mod drawing;
mod error;
mod exact;
mod heights;
mod mean_value;
mod mesh;
mod orient;
mod repair;
mod route;
#[cfg(test)]
pub(super) mod sample_meshes;
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
