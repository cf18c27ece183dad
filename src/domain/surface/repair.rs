//! What was mended in a model, to be told.

use std::fmt;

use glam::DVec3;

/// A kind of fault in a model that can be mended without changing its shape, with how many there were and where the
/// first was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshRepair {
    /// What was done.
    pub repair: RepairKind,
    /// How often.
    pub count: usize,
    /// Where first, in millimetres.
    pub position: DVec3,
}

/// What was done to a model so that it is a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RepairKind {
    /// Facets whose corners were not three places were left out.
    Collapsed,
    /// Facets with the same corners as another were left out.
    Repeated,
    /// Facets with their corners in one line were taken out by turning their longest edge.
    Flat,
    /// Facets that faced against their neighbours were turned.
    Turned,
    /// Parts that only shared a corner were parted there.
    Parted,
    /// Closed parts with their inside out were turned.
    InsideOut,
}

impl fmt::Display for MeshRepair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (one, many) = match self.repair {
            RepairKind::Collapsed => {
                ("facet with two equal corners was left out", "facets with two equal corners were left out")
            }
            RepairKind::Repeated => ("repeated facet was left out", "repeated facets were left out"),
            RepairKind::Flat => ("facet without area was mended", "facets without area were mended"),
            RepairKind::Turned => {
                ("facet that faced the wrong way was turned", "facets that faced the wrong way were turned")
            }
            RepairKind::Parted => (
                "corner at which parts of the model touch was parted",
                "corners at which parts of the model touch were parted",
            ),
            RepairKind::InsideOut => {
                ("part that was inside out was turned", "parts that were inside out were turned")
            }
        };
        let (what, p) = (if self.count == 1 { one } else { many }, self.position);
        let first = if self.count == 1 { "at" } else { "the first at" };
        write!(f, "{} {what}, {first} ({:.3}, {:.3}, {:.3}) mm", self.count, p.x, p.y, p.z)
    }
}

/// What was mended so far.
#[derive(Debug, Default)]
pub(super) struct Repairs(Vec<MeshRepair>);

impl Repairs {
    pub(super) fn add(&mut self, repair: RepairKind, position: DVec3) {
        match self.0.iter_mut().find(|told| told.repair == repair) {
            Some(told) => told.count += 1,
            None => self.0.push(MeshRepair { repair, count: 1, position }),
        }
    }

    /// All, in the order in which they are done.
    pub(super) fn told(mut self) -> Vec<MeshRepair> {
        self.0.sort_by_key(|told| told.repair);
        self.0
    }
}
