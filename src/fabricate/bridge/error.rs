//! Why bridges cannot be laid.

use thiserror::Error;

use super::{BridgeKind, BridgeOptions, Counts};
use crate::planar::Region;

/// Widths that can be worked with, in millimetres.
const WIDTHS_MM: std::ops::RangeInclusive<f64> = 0.01..=100.0;

/// Why a region cannot be given the counts that are wanted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BridgeError {
    /// The width is not a usable length.
    #[error("bridges {found_mm} mm wide; they must be from 0.01 to 100 mm")]
    Width {
        /// What was given.
        found_mm: f64,
    },
    /// No region has such counts, or the region is empty.
    #[error("{wanted} cannot be had by bridges: {why}")]
    Impossible {
        /// What was wanted.
        wanted: Counts,
        /// What is in the way.
        why: &'static str,
    },
    /// There is no place left for a bridge.
    #[error("{done} of {needed} {}; there is no place for another {} {width_mm:.3} mm wide; a narrower one may find a place", what(*kind), if kind.is_strut() { "strut" } else { "slit" })]
    NoPlace {
        /// What the bridge was for.
        kind: BridgeKind,
        /// By how many the count was changed.
        done: usize,
        /// By how many it had to be.
        needed: usize,
        /// How wide they are.
        width_mm: f64,
    },
    /// The search was given up, as hardly any place will do.
    #[error("{done} of {needed} {}; the search for places of {}s {width_mm:.3} mm wide was given up, as nearly all that were tried would not hold; change the counts by less, or try another width or a larger chord error", what(*kind), if kind.is_strut() { "strut" } else { "slit" })]
    TooMuch {
        /// What the bridge was for.
        kind: BridgeKind,
        /// By how many the count was changed.
        done: usize,
        /// By how many it had to be.
        needed: usize,
        /// How wide they are.
        width_mm: f64,
    },
}

fn what(kind: BridgeKind) -> &'static str {
    match kind {
        BridgeKind::Join => "superfluous components were joined to others",
        BridgeKind::Enclose => "missing holes were made by closing bays",
        BridgeKind::Open => "superfluous holes were opened",
        BridgeKind::Split => "missing components were made by cutting strands",
    }
}

/// Refuses what cannot be done for any region.
pub(super) fn check(region: &Region, wanted: Counts, options: &BridgeOptions) -> Result<(), BridgeError> {
    if !WIDTHS_MM.contains(&options.width_mm) {
        return Err(BridgeError::Width { found_mm: options.width_mm });
    }
    let impossible = |why| Err(BridgeError::Impossible { wanted, why });
    if region.is_empty() {
        return impossible("there is no ink");
    }
    if options.within.is_some_and(|within| within.grid() != region.grid()) {
        return impossible("where struts may be is on another grid");
    }
    if wanted.components == 0 {
        return impossible("bridges take no component away");
    }
    if wanted.holes == 0 && options.closed_around.is_some() {
        return impossible("a pattern that goes all the way round has its inside for a hole");
    }
    Ok(())
}
