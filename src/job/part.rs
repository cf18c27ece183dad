//! From an outline in band coordinates to the part on its page.

use glam::DVec2;

use super::error::{JobError, OutlineFault};
use crate::domain::BandMap;
use crate::fabricate::snapped_to_f32;
use crate::fit::Outline;
use crate::planar::{Contour, Grid, GridPoint, Region, RegionError};
use crate::topology::Topology;

/// Blank page around the part, in millimetres.
pub(super) const MARGIN_MM: f64 = 1.0;

/// Chords of a line across the band in pictures: where the band is squeezed it is not straight.
const SEAM_CHORDS: u32 = 16;

/// A part on its page.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// The part, y up from the lower left corner of the page, on a grid that 32-bit floats hold exactly.
    pub(super) region: Region,
    /// Width and height of the page.
    pub(super) page_mm: DVec2,
    /// What was added to positions of the curve to lay the part on its page.
    pub(super) shift_mm: DVec2,
    /// Lines across the band where two pieces meet.
    pub(super) seams_mm: Vec<Vec<DVec2>>,
}

/// Why an outline is no part.
pub(super) enum PartError {
    /// It cannot be, whatever the chord error.
    Job(JobError),
    /// Contours touch, or the counts are not as planned: a smaller chord error may help.
    Untrue(OutlineFault),
}

impl Part {
    /// `outline` mapped along the curve, placed on its page, snapped once, and counted against the plan.
    pub(super) fn new(
        outline: &Outline,
        map: &BandMap,
        planned: Topology,
        chord_mm: f64,
    ) -> Result<Self, PartError> {
        let mapped: Vec<Vec<DVec2>> =
            outline.contours.iter().map(|c| map.map_contour(&c.points, c.winding, chord_mm)).collect();
        let points = || mapped.iter().flatten();
        let low = points().copied().reduce(DVec2::min).unwrap_or_default();
        let high = points().copied().reduce(DVec2::max).unwrap_or_default();
        let shift = DVec2::splat(MARGIN_MM) - low;
        let page_mm = high - low + 2.0 * MARGIN_MM;
        let exact = Grid::for_extent(page_mm.max_element())
            .map_err(|e| PartError::Job(JobError::Fabricate(e.into())))?;
        let mut contours = Vec::with_capacity(mapped.len());
        for path in &mapped {
            let snapped: Result<Vec<_>, _> = path.iter().map(|&p| exact.snap(p + shift)).collect();
            let snapped = snapped.map_err(|e| PartError::Job(JobError::Fabricate(e.into())))?;
            contours.extend(Contour::new(snapped));
        }
        let region = Region::from_contours(exact, contours).map_err(|error| match error {
            RegionError::Invalid { faults } => {
                PartError::Untrue(OutlineFault::Contact { position_mm: faults[0].position_mm() })
            }
            RegionError::Grid(e) => PartError::Job(JobError::Fabricate(e.into())),
        })?;
        let region = snapped_to_f32(&region).map_err(|e| PartError::Job(JobError::Fabricate(e)))?;
        let (components, holes) = (region.components(), region.holes());
        if (components, holes) != (planned.components as usize, planned.holes as usize) {
            return Err(PartError::Untrue(OutlineFault::Counts { components, holes }));
        }
        let [low, high] = map.v_range_mm();
        let across = (0..=SEAM_CHORDS).map(|i| low + (high - low) * f64::from(i) / f64::from(SEAM_CHORDS));
        let seam = |u: f64| across.clone().map(|v| map.map(u, v) + shift).collect();
        let seams_mm = outline.seams.iter().map(|s| seam(s.u_mm)).collect();
        Ok(Self { region, page_mm, shift_mm: shift, seams_mm })
    }

    /// The part on a page of `page_mm` that begins where the part does.
    pub(super) fn without_margin(&self, page_mm: DVec2) -> Result<Self, JobError> {
        let (low, _) = self.region.bounds_mm().unwrap_or_default();
        let grid = self.region.grid();
        let corner = GridPoint::new(-grid.steps(low.x), -grid.steps(low.y));
        let region = snapped_to_f32(&self.region.shifted(corner)).map_err(JobError::Fabricate)?;
        let seams_mm = self.seams_mm.iter().map(|seam| seam.iter().map(|&p| p - low).collect()).collect();
        Ok(Self { region, page_mm, shift_mm: self.shift_mm - low, seams_mm })
    }
}
