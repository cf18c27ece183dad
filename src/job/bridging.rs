//! Bridges in a job: what they could do where there is no plan, and what to tell of those that were laid.

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::plan::PlanError;
use crate::domain::BandMap;
use crate::fabricate::{self, Bridge, BridgeError, BridgeKind, BridgeOptions, Bridged, Counts, Pressed};
use crate::planar::{GridPoint, Region, Tolerances};
use crate::solver::Refusal;
use crate::topology::{Goal, Topology, Wanted};

/// The bridges of a part. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BridgesReport {
    /// Components and holes without bridges.
    pub without: Counts,
    /// Struts: ink that was added.
    pub struts: usize,
    /// The lengths of all struts together.
    pub strut_length_mm: f64,
    /// Ink that was added, in square millimetres.
    pub added_mm2: f64,
    /// Slits: ink that was taken away.
    pub slits: usize,
    /// The lengths of all slits together.
    pub slit_length_mm: f64,
    /// Ink that was taken away, in square millimetres.
    pub removed_mm2: f64,
    /// Each bridge, in the order in which they were laid.
    pub bridges: Vec<Bridge>,
}

impl BridgesReport {
    /// Moves the bridges with the drawing that they are in. Their lengths and widths stay those with which they were laid.
    pub(super) fn press(&mut self, pressed: &Pressed) {
        let press = |p: &mut [f64; 2]| *p = pressed.moved(DVec2::from(*p)).to_array();
        for bridge in &mut self.bridges {
            [&mut bridge.from_mm, &mut bridge.to_mm].into_iter().for_each(press);
            bridge.corners_mm.iter_mut().chain(bridge.pockets_mm.iter_mut().flatten()).for_each(press);
        }
    }

    pub(super) fn new(without: Counts, bridges: Vec<Bridge>) -> Self {
        let (struts, slits): (Vec<&Bridge>, Vec<&Bridge>) = bridges.iter().partition(|b| b.kind.is_strut());
        let length = |of: &[&Bridge]| of.iter().fold(0.0, |sum, b| sum + b.length_mm);
        let area = |of: &[&Bridge]| of.iter().fold(0.0, |sum, b| sum + b.area_mm2);
        Self {
            without,
            struts: struts.len(),
            strut_length_mm: length(&struts),
            added_mm2: area(&struts),
            slits: slits.len(),
            slit_length_mm: length(&slits),
            removed_mm2: area(&slits),
            bridges,
        }
    }

    /// The bridges in a sentence.
    pub(super) fn note(&self, with: Counts) -> String {
        let mut parts = Vec::new();
        let mut tell = |count: usize, what: &str, mm: f64, mm2: f64, done: &str| {
            if count > 0 {
                let least = self.bridges.iter().filter(|b| b.kind.is_strut() == (what == "strut"));
                let width_mm = least.map(|b| b.width_mm).fold(0.0, f64::max);
                parts.push(format!(
                    "{count} {what}(s) {width_mm:.2} mm wide, {mm:.2} mm long together, {done} {mm2:.2} mm2 of ink"
                ));
            }
        };
        tell(self.struts, "strut", self.strut_length_mm, self.added_mm2, "add");
        tell(self.slits, "slit", self.slit_length_mm, self.removed_mm2, "take away");
        if parts.is_empty() {
            return format!("no bridges were needed: {with}");
        }
        format!("{}: {with} instead of {}", parts.join(", "), self.without)
    }
}

/// Bridges of which few ornaments have room for more.
const MANY: usize = 150;

/// Whether bridges could help where there is no plan.
pub(super) fn can_help(error: &PlanError) -> bool {
    match error {
        PlanError::TooLarge { .. } => true,
        PlanError::Refused { refusal, .. } => {
            matches!(refusal, Refusal::Components { .. } | Refusal::Holes { .. } | Refusal::Both { .. })
        }
    }
}

/// The counts nearest to those of a part that has `has` that the goal allows.
pub(super) fn wanted(goal: Goal, has: Counts) -> Counts {
    let nearest = |wanted: Option<Wanted>, has: usize| {
        wanted.map_or(has, |w| has.clamp(w.least() as usize, w.most() as usize))
    };
    Counts { components: nearest(goal.components, has.components), holes: nearest(goal.holes, has.holes) }
}

/// What bridges would do for a goal that no plan meets, in words; empty when they could do nothing.
pub(super) fn hint(goal: Goal, best: Topology) -> String {
    let has = Counts { components: best.components as usize, holes: best.holes as usize };
    let wanted = wanted(goal, has);
    let struts = has.components.saturating_sub(wanted.components) + wanted.holes.saturating_sub(has.holes);
    let slits = has.holes.saturating_sub(wanted.holes) + wanted.components.saturating_sub(has.components);
    let count = |n: usize, what: &str| (n > 0).then(|| format!("{n} {what}(s)"));
    let bridges: Vec<String> = [count(struts, "strut"), count(slits, "slit")].into_iter().flatten().collect();
    if bridges.is_empty() {
        return String::new();
    }
    let little = if struts + slits > MANY { ", after which little of the ornament may be left" } else { "" };
    format!(
        "; or give --bridge with a width, as --bridge 1mm: {} would be needed{little}",
        bridges.join(" and ")
    )
}

/// The options of bridges in a band. `inside_mm` is a point on the inner side of a ring, which must stay closed.
pub(super) fn options(
    width_mm: f64,
    tolerances: &Tolerances,
    inside_mm: Option<DVec2>,
) -> BridgeOptions<'static> {
    BridgeOptions {
        width_mm,
        min_feature_mm: tolerances.min_feature_mm(),
        min_gap_mm: tolerances.min_gap_mm(),
        chord_mm: tolerances.chord_mm(),
        closed_around: inside_mm,
        within: None,
    }
}

/// How many parts are joined so that there are bays to close, in parts of the holes that are missing. Fewer leave more of
/// the drawing as it is; more find more places.
const JOINS_PER_HOLE: [usize; 2] = [1, 4];

/// `region` with bridges as the goal asks. Where the bays do not suffice for the holes, parts are joined as far as the
/// goal allows: between two that are joined there is a bay on either side of the strut.
pub(super) fn bridged(
    region: &Region,
    goal: Goal,
    options: &BridgeOptions<'_>,
) -> Result<Bridged, BridgeError> {
    let wanted = wanted(goal, Counts::of(region));
    let laid = fabricate::bridge(region, wanted, options);
    let Err(BridgeError::NoPlace { kind: BridgeKind::Enclose, done, needed, .. }) = laid else {
        return laid;
    };
    let least = goal.components.map_or(1, |of| of.least().max(1) as usize);
    let mut fewer: Vec<usize> = JOINS_PER_HOLE
        .map(|joins| wanted.components.saturating_sub(joins * (needed - done)).max(least))
        .into_iter()
        .chain([least])
        .filter(|&components| components < wanted.components)
        .collect();
    fewer.dedup();
    let joined = |components| fabricate::bridge(region, Counts { components, ..wanted }, options).ok();
    fewer.into_iter().find_map(joined).map_or(laid, Ok)
}

/// How far beyond the band's inner border the inside of a ring begins, as a part of the band's height.
const BEYOND: f64 = 1e-3;
/// Samples of a ring for the side on which its inside is.
const SAMPLES: usize = 720;

/// A point in the inside of a ring, where no band is; `None` for an open band, and for one in space.
pub(super) fn inside(map: &BandMap) -> Option<DVec2> {
    let curve = map.curve();
    if !curve.is_closed() || curve.is_rolled() {
        return None;
    }
    let at = |i: usize| map.map(curve.length_mm() * i as f64 / SAMPLES as f64, 0.0);
    let area: f64 = (0..SAMPLES).map(|i| (at(i) - at(0)).perp_dot(at(i + 1) - at(0))).sum();
    let [low, high] = map.v_range_mm();
    let beyond = BEYOND * (high - low);
    Some(map.map(0.0, if area > 0.0 { high + beyond } else { low - beyond }))
}

/// Whether ink goes all the way round `inside_mm`.
pub(super) fn surrounds(region: &Region, inside_mm: DVec2) -> bool {
    let grid = region.grid();
    let p = GridPoint::new(grid.steps(inside_mm.x), grid.steps(inside_mm.y));
    region.contours().any(|c| !c.is_counter_clockwise() && c.contains(p))
}
