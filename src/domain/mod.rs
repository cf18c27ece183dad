//! Where the pattern goes: maps band coordinates to the plane and refuses what it would fold or cross.
//!
//! A band has coordinates (u, v) in millimetres: u is arc length along a curve, v is the distance across it,
//! positive on the left of the direction of travel. (u, v) becomes C(u) + f(u, v) n(u), where n is the left
//! normal and f is v itself except on the inner side of a tight bend, where it is squeezed ([`BandMap`]
//! has the proof that nothing folds). Curves are chains of circular arcs that share tangents ([`PlanarCurve`]),
//! so arc length, frames and curvature are closed forms. Zhou 2014 §3.5 assumes such a smooth curve and §6.3
//! leaves self-intersection in high curvature to the tessellator; here both are checked.
//!
//! What this room promises to the next: a [`BandMap`] that exists is injective on its band and keeps
//! orientation, so components and holes of what it maps stay the same; [`BandMap::map_contour`] stays within
//! the chord error of that map.
//!
//! Curves in space carry frames ([`SpaceCurve`]), and a [`SpaceMap`] lays a thick band along them. On models,
//! which are surfaces of triangles ([`Mesh`]), lie curves ([`MeshCurve`]) that give such a curve, with the outside of
//! the model as its front.
//!
//! Excluded: reading files (a [`CurveSpec`] or a [`FillDomain`] only names one), and the minimum feature after
//! the map, which is measured where the part is made.

mod arc;
mod band;
mod chain;
mod crossing;
mod curve;
mod error;
mod fill_spec;
mod length;
mod path;
mod rounding;
#[cfg(test)]
mod sample_curves;
mod size;
mod space;
mod spec;
mod squeeze;
mod surface;
mod trace;

pub use band::BandMap;
pub use curve::{Frame, PlanarCurve};
pub use error::DomainError;
pub use fill_spec::{FillDomain, FillDomainError};
pub use length::{LengthError, parse_length_mm};
pub use size::{RectSize, RectSizeError};
pub use space::{Relief, Roll, RollError, SpaceCurve, SpaceError, SpaceFrame, SpaceMap, Twist, TwistError};
pub use spec::{CurveSpec, CurveSpecError};
pub use squeeze::{Side, Squeeze};
pub use surface::{Mesh, MeshCurve, MeshHeights, MeshPart, MeshRepair, RepairKind, SurfaceError};
