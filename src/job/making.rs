//! What a machine and a material ask of a part: enforcing widths, the worst places, and the numbers that cost money.

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::error::JobError;
use crate::fabricate::{
    self, Change, Counts, EnforceError, EnforceOptions, Material, MaterialReport, Pressed, SheetSize,
};
use crate::planar::{Region, Tolerances};
use crate::verify::{self, Mismatch, NarrowPlaces};

/// So many of the greatest changes are reported.
const CHANGES: usize = 10;

/// What was thickened and widened. Areas are square millimetres; of a sign that is carved out of a plate, they are the plate's.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EnforcedReport {
    /// The ink that was added.
    pub added_mm2: f64,
    /// The ink that was taken away.
    pub removed_mm2: f64,
    /// The area before.
    pub area_before_mm2: f64,
    /// In how many places.
    pub places: usize,
    /// The greatest changes.
    pub greatest: Vec<Change>,
    /// By how much the drawing was first pressed together in width and height, so that it keeps its box.
    pub pressed_mm: [f64; 2],
    /// The narrowest ink and gaps before.
    pub before: NarrowPlaces,
}

/// A region in which nothing is lacking any more.
pub(super) struct Mended {
    pub(super) region: Region,
    pub(super) report: EnforcedReport,
    /// How the drawing was pressed together before.
    pub(super) pressed: Option<Pressed>,
}

/// What becomes of ink along the box around a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// It stays round, and the part is pressed into its box.
    Round,
    /// It is straight: no point moves but where something is too narrow.
    Straight,
}

/// The region with its minimum feature and gap enforced, and what was done; `None` when nothing was lacking.
///
/// # Errors
/// [`JobError::Enforce`] where there is no room.
pub(super) fn enforced(
    region: &Region,
    tolerances: &Tolerances,
    border: Border,
) -> Result<Option<Mended>, JobError> {
    let options = EnforceOptions {
        min_feature_mm: tolerances.min_feature_mm(),
        min_gap_mm: tolerances.min_gap_mm(),
        chord_mm: tolerances.chord_mm(),
    };
    let enforced = match border {
        Border::Round => fabricate::enforce_in_box(region, &options)?,
        Border::Straight => fabricate::enforce(region, &options)?,
    };
    if enforced.region == *region {
        return Ok(None);
    }
    let pressed = enforced.pressed;
    let report = EnforcedReport {
        pressed_mm: pressed.map_or(DVec2::ZERO, |pressed| pressed.by_mm()).to_array(),
        added_mm2: enforced.added_mm2,
        removed_mm2: enforced.removed_mm2,
        area_before_mm2: region.area_mm2(),
        places: enforced.changes.len(),
        greatest: enforced.changes.into_iter().take(CHANGES).collect(),
        before: worst_places(region, tolerances),
    };
    debug_assert_eq!(Counts::of(&enforced.region), Counts::of(region));
    Ok(Some(Mended { region: enforced.region, report, pressed }))
}

/// The same for a pattern that is carved out of `sheet`, told of the plate: what is added to the pattern is taken away from it.
///
/// # Errors
/// As [`enforced`].
pub(super) fn enforced_in_plate(
    pattern: &Region,
    tolerances: &Tolerances,
    border: Border,
    sheet: SheetSize,
) -> Result<Option<Mended>, JobError> {
    let by = fabricate::shift_onto(pattern, sheet);
    let made = enforced(pattern, tolerances, border).map_err(|error| match error {
        JobError::Enforce(error) => JobError::Enforce(of_plate(error, by)),
        error => error,
    })?;
    Ok(made.map(|mut made| {
        let report = &mut made.report;
        std::mem::swap(&mut report.added_mm2, &mut report.removed_mm2);
        std::mem::swap(&mut report.before.ink, &mut report.before.gaps);
        report.area_before_mm2 = sheet.width_mm * sheet.height_mm - report.area_before_mm2;
        for change in &mut report.greatest {
            change.area_mm2 = -change.area_mm2;
            change.position_mm = (DVec2::from(change.position_mm) + by).to_array();
        }
        report.before.ink.iter_mut().chain(&mut report.before.gaps).for_each(|place| place.position_mm += by);
        made
    }))
}

/// What cannot be enforced in a pattern, as it is seen in the plate around it.
fn of_plate(error: EnforceError, by: DVec2) -> EnforceError {
    match error {
        EnforceError::Crowded { what, position_mm, width_mm, min_feature_mm, min_gap_mm } => {
            EnforceError::Crowded {
                what: if what == "ink" { "gap" } else { "ink" },
                position_mm: position_mm + by,
                width_mm,
                min_feature_mm: min_gap_mm,
                min_gap_mm: min_feature_mm,
            }
        }
        EnforceError::Width { .. } => error,
    }
}

/// Whether `region` keeps its counts at the widths of `tolerances`, tried as finely as a written file is judged.
///
/// # Errors
/// The first [`Mismatch`], with the narrowest place.
pub(super) fn check_widths(region: &Region, tolerances: &Tolerances) -> Result<(), Mismatch> {
    check_widths_less(region, tolerances, 0.0)
}

/// The same with widths less by so many millimetres.
///
/// # Errors
/// As [`check_widths`].
pub(super) fn check_widths_less(
    region: &Region,
    tolerances: &Tolerances,
    less_mm: f64,
) -> Result<(), Mismatch> {
    let [feature_mm, gap_mm] =
        [tolerances.min_feature_mm(), tolerances.min_gap_mm()].map(|mm| (mm - less_mm).max(0.0));
    let chord_mm = 0.25 * tolerances.chord_mm();
    if feature_mm > 0.0 && !verify::endures_erosion(region, 0.5 * feature_mm, chord_mm) {
        let narrowest = verify::min_feature(region, feature_mm, chord_mm);
        return Err(Mismatch::Feature { wanted_mm: feature_mm, narrowest });
    }
    if gap_mm > 0.0 && !verify::endures_dilation(region, 0.5 * gap_mm, chord_mm) {
        let narrowest = verify::min_gap(region, gap_mm, chord_mm);
        return Err(Mismatch::Gap { wanted_mm: gap_mm, narrowest });
    }
    Ok(())
}

/// That there is nothing to enforce.
pub(super) fn no_width() -> JobError {
    JobError::Option {
        option: "--enforce",
        found: "there is no width to enforce".to_owned(),
        wanted: "name a --process, or give --min-feature or --min-gap".to_owned(),
    }
}

impl EnforcedReport {
    /// A line about it.
    pub(super) fn note(&self) -> String {
        let pressed = match self.pressed_mm {
            [0.0, 0.0] => String::new(),
            [x, y] => format!(
                "; the drawing was pressed together by {x:.3} x {y:.3} mm before, so that it keeps its size"
            ),
        };
        let percent = 100.0 * (self.added_mm2 - self.removed_mm2) / self.area_before_mm2;
        format!(
            "enforced the minimum feature and gap in {} place(s): {:.2} mm2 of ink added, {:.2} mm2 taken away ({percent:+.1} % of the area){pressed}",
            self.places, self.added_mm2, self.removed_mm2
        )
    }
}

/// The worst places of a region, whatever machine will make it.
pub(super) fn worst_places(region: &Region, tolerances: &Tolerances) -> NarrowPlaces {
    // As finely as a written file is judged.
    verify::narrow_places(region, NarrowPlaces::WORST, f64::INFINITY, 0.25 * tolerances.chord_mm())
}

/// The numbers of what is kept that cost money: of the part, or of the sign that is left of its plate, without what falls
/// out. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Quantities {
    /// Its area in square millimetres.
    pub area_mm2: f64,
    /// Its volume in cubic millimetres: that of the solid when one was made or its walls are not upright, else the area times
    /// the thickness.
    pub volume_mm3: f64,
    /// Width, height and thickness of the box around it.
    pub box_mm: [f64; 3],
    /// The length of all outlines.
    pub outline_mm: f64,
    /// The material and the mass, if a material was named.
    #[serde(flatten)]
    pub material: Option<MaterialReport>,
}

impl Quantities {
    /// Those of `region`. `volume_mm3` is that of the solid; without one the walls are upright.
    pub(super) fn new(
        region: &Region,
        thickness_mm: f64,
        volume_mm3: Option<f64>,
        material: Option<&Material>,
    ) -> Self {
        let (low, high) = region.bounds_mm().unwrap_or((DVec2::ZERO, DVec2::ZERO));
        let grid = region.grid();
        let edges = region.contours().flat_map(|contour| contour.edges());
        let area_mm2 = region.area_mm2();
        let volume_mm3 = volume_mm3.unwrap_or(area_mm2 * thickness_mm);
        Self {
            area_mm2,
            volume_mm3,
            box_mm: [high.x - low.x, high.y - low.y, thickness_mm],
            outline_mm: edges.map(|(a, b)| grid.to_mm(a).distance(grid.to_mm(b))).sum(),
            material: material.map(|material| material.report(volume_mm3)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{self, FillRule, Grid};

    #[test]
    fn a_plate_costs_what_it_weighs() {
        // A plate of 20 by 10 mm, as near as the grid has it.
        let step = Grid::for_extent(100.0).unwrap().steps(1.0);
        let plate = planar::boxes(step, FillRule::NonZero, &[(0, 0, 20, 10)]);
        let brass = fabricate::Workshop::default().material("brass").unwrap().clone();
        let cost = Quantities::new(&plate, 2.0, None, Some(&brass));
        assert_eq!((cost.area_mm2, cost.volume_mm3, cost.outline_mm), (200.0, 400.0, 60.0));
        assert_eq!(cost.box_mm, [20.0, 10.0, 2.0]);
        assert!((cost.material.unwrap().mass_g - 3.4).abs() < 1e-12);
        let bevelled = Quantities::new(&plate, 2.0, Some(390.0), None);
        assert_eq!((bevelled.volume_mm3, bevelled.material), (390.0, None));
    }
}
