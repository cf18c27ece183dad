//! Bridges: the least ink added or taken away that gives a region the components and holes that are wanted.
//!
//! | wanted | bridge | laid |
//! |---|---|---|
//! | fewer components | a strut between two components | along a minimum spanning tree of their distances |
//! | more holes | a strut across a bay | where the bay is narrowest |
//! | fewer holes | a slit from a hole to the outside or to another hole | along a minimum spanning tree |
//! | more components | a slit across a strand | where the strand is thinnest |
//!
//! Ink and gaps are dual, so there is one search for struts and slits ([`ground`]). Distances between contours
//! are true ones ([`links`]); which place along two contours is taken is a matter of length, squareness and hold
//! ([`place`]); every bridge is tried out in a window before it is laid, exactly and at the tolerance of a
//! machine ([`trial`]), and is laid only where struts may be ([`fence`]); the region with all of them is counted at the end. The work of trying is limited, so that
//! a refusal takes seconds too.
//!
//! Excluded: filling holes and dropping islands, which changes the drawing instead of holding it together.

mod error;
mod fence;
mod ground;
mod lay;
mod links;
mod loops;
mod place;
mod thin;
mod trial;

pub use error::BridgeError;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use crate::planar::Region;
use ground::Side;
use trial::Effort;

/// Components and holes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Counts {
    /// Connected components (b0).
    pub components: usize,
    /// Holes (b1).
    pub holes: usize,
}

impl Counts {
    /// Those of a region.
    pub fn of(region: &Region) -> Self {
        Self { components: region.components(), holes: region.holes() }
    }
}

impl std::fmt::Display for Counts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} component(s) and {} hole(s)", self.components, self.holes)
    }
}

/// How bridges are to be. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgeOptions<'a> {
    /// The width of struts and slits; they are wider when the machine needs it.
    pub width_mm: f64,
    /// The narrowest ink that the machine makes; 0 when it was not given.
    pub min_feature_mm: f64,
    /// The narrowest gap that the machine keeps open; 0 when it was not given.
    pub min_gap_mm: f64,
    /// The greatest distance between the region and the curves that will stand for it: no bridge hangs on by so
    /// little.
    pub chord_mm: f64,
    /// A point in a gap that no slit may open to the outside: the inside of a ring that must stay closed.
    pub closed_around: Option<DVec2>,
    /// Where struts may be, with all of their width: a region on the grid of the one that gets them. `None` for anywhere.
    pub within: Option<&'a Region>,
}

/// What a bridge is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BridgeKind {
    /// A strut that joins two components.
    Join,
    /// A strut that closes a bay to a hole.
    Enclose,
    /// A slit that opens a hole to the outside or to another hole.
    Open,
    /// A slit that cuts a component in two.
    Split,
}

impl BridgeKind {
    /// Whether ink is added; otherwise it is taken away.
    pub fn is_strut(self) -> bool {
        matches!(self, Self::Join | Self::Enclose)
    }

    fn side(self) -> Side {
        if self.is_strut() { Side::Gap } else { Side::Ink }
    }

    /// The counts after so many bridges of this kind.
    fn changed(self, Counts { components, holes }: Counts, by: usize) -> Counts {
        match self {
            Self::Join => Counts { components: components - by, holes },
            Self::Enclose => Counts { components, holes: holes + by },
            Self::Open => Counts { components, holes: holes - by },
            Self::Split => Counts { components: components + by, holes },
        }
    }
}

/// One bridge. Positions and lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Bridge {
    /// What it is for.
    pub kind: BridgeKind,
    /// By how many it changes the count: 1, or more where there is no room to join two only.
    pub changes: usize,
    /// Where its axis begins, on a boundary.
    pub from_mm: [f64; 2],
    /// Where its axis ends, on a boundary.
    pub to_mm: [f64; 2],
    /// Its width: as asked for, or more where the machine needs it or parts lie so close that a narrower one
    /// would cut off pockets.
    pub width_mm: f64,
    /// The length of its axis between the boundaries.
    pub length_mm: f64,
    /// The least distance between what it joins (for a loop, its own length): no bridge could be shorter.
    pub least_mm: f64,
    /// The ink added or taken away, in square millimetres.
    pub area_mm2: f64,
    /// Its corners, counter-clockwise; the ends are sunk into what it joins.
    pub corners_mm: [[f64; 2]; 4],
    /// Outlines of small pockets beside it, which it would have cut off and which are filled with it (beside a slit:
    /// crumbs that would have fallen out). Mostly there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pockets_mm: Vec<Vec<[f64; 2]>>,
}

/// A region with bridges.
#[derive(Debug, Clone, PartialEq)]
pub struct Bridged {
    /// The region, on the grid of the one that was given.
    pub region: Region,
    /// The bridges, in the order in which they were laid.
    pub bridges: Vec<Bridge>,
}

/// `region` with exactly the `wanted` counts, by as few bridges as can be and as little material.
///
/// Nothing outside of the bridges' corners and pockets is changed. The same arguments give the same result.
///
/// # Errors
/// [`BridgeError`] for options out of range, counts that no region has, and when there is no place for a bridge or
/// looking for one is given up.
pub fn bridge(region: &Region, wanted: Counts, options: &BridgeOptions<'_>) -> Result<Bridged, BridgeError> {
    error::check(region, wanted, options)?;
    let has = Counts::of(region);
    let steps = [
        (BridgeKind::Join, has.components.saturating_sub(wanted.components)),
        (BridgeKind::Enclose, wanted.holes.saturating_sub(has.holes)),
        (BridgeKind::Open, has.holes.saturating_sub(wanted.holes)),
        (BridgeKind::Split, wanted.components.saturating_sub(has.components)),
    ];
    let mut bridged = Bridged { region: region.clone(), bridges: Vec::new() };
    for (kind, count) in steps.into_iter().filter(|(_, count)| *count > 0) {
        let laid = lay::lay(&bridged.region, kind, count, options, &Effort::new(count))?;
        bridged.region = laid.region;
        bridged.bridges.extend(laid.bridges);
    }
    debug_assert_eq!(Counts::of(&bridged.region), wanted);
    Ok(bridged)
}

#[cfg(test)]
mod tests;
