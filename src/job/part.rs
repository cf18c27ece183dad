//! From an outline in band coordinates to the part on its page.

use glam::DVec2;

use super::error::{JobError, OutlineFault};
use super::joined::Joined;
use super::unrolled::{best_cut, unrolled};
use crate::domain::BandMap;
use crate::fabricate::{Counts, snapped_to_f32};
use crate::fit::{Outline, Sides};
use crate::planar::{Contour, Grid, GridPoint, Region, RegionError};
use crate::topology::Topology;
use crate::verify;

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
    /// What it has: of a closed band that was laid flat, what it has in space.
    pub(super) counts: Counts,
    /// How the two sides of a closed band that was laid flat are joined.
    pub(super) joined: Option<Joined>,
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
        sides: Sides,
        planned: Topology,
        chord_mm: f64,
    ) -> Result<Self, PartError> {
        if map.curve().is_rolled() {
            return Self::unrolled(outline, map, planned);
        }
        let mapped: Vec<Vec<DVec2>> =
            outline.contours.iter().map(|c| map.map_contour(&c.points, c.winding, chord_mm)).collect();
        let points = || mapped.iter().flatten();
        let low = points().copied().reduce(DVec2::min).unwrap_or_default();
        let high = points().copied().reduce(DVec2::max).unwrap_or_default();
        let shift = DVec2::splat(MARGIN_MM) - low;
        let page_mm = high - low + 2.0 * MARGIN_MM;
        let exact = Grid::for_extent(page_mm.max_element())
            .map_err(|e| PartError::Job(JobError::Fabricate(e.into())))?;
        let region = region_of(&mapped, exact, shift)?;
        let region = snapped_to_f32(&region).map_err(|e| PartError::Job(JobError::Fabricate(e)))?;
        let counts = match sides {
            Sides::Joined => rolled_across(&region)?,
            _ => Counts::of(&region),
        };
        check_counts(counts, planned)?;
        let [low, high] = map.v_range_mm();
        let across = (0..=SEAM_CHORDS).map(|i| low + (high - low) * f64::from(i) / f64::from(SEAM_CHORDS));
        let seam = |u: f64| across.clone().map(|v| map.map(u, v) + shift).collect();
        let seams_mm = outline.seams.iter().map(|s| seam(s.u_mm)).collect();
        Ok(Self { region, page_mm, shift_mm: shift, seams_mm, counts, joined: None })
    }

    /// A closed band laid flat, cut open where the fewest strands are, with room for its whole width.
    fn unrolled(outline: &Outline, map: &BandMap, planned: Topology) -> Result<Self, PartError> {
        let length_mm = map.curve().length_mm();
        let [low, high] = map.v_range_mm();
        let shift = DVec2::new(MARGIN_MM, MARGIN_MM - low);
        let page_mm = DVec2::new(length_mm, high - low) + 2.0 * MARGIN_MM;
        let grid = Grid::for_extent(page_mm.max_element())
            .map_err(|e| PartError::Job(JobError::Fabricate(e.into())))?;
        let cut_mm = best_cut(&outline.contours, length_mm);
        let touching = OutlineFault::Contact { position_mm: DVec2::new(MARGIN_MM, MARGIN_MM) };
        let paths = unrolled(&outline.contours, length_mm, cut_mm).ok_or(PartError::Untrue(touching))?;
        let region = region_of(&paths, grid, shift)?;
        let sides_mm = [shift.x, shift.x + length_mm];
        let rolled = verify::rolled(&region, sides_mm).map_err(|_| PartError::Untrue(touching))?;
        let counts = Counts { components: rolled.components, holes: rolled.holes };
        check_counts(counts, planned)?;
        let line = |u_mm: f64| {
            let x = (u_mm - cut_mm).rem_euclid(length_mm);
            vec![DVec2::new(x, low) + shift, DVec2::new(x, high) + shift]
        };
        let seams_mm = outline.seams.iter().map(|s| line(s.u_mm)).collect();
        let joined = Some(Joined { cut_mm, sides_mm });
        Ok(Self { region, page_mm, shift_mm: shift, seams_mm, counts, joined })
    }

    /// The part on a page of `page_mm` that begins where the part does.
    pub(super) fn without_margin(&self, page_mm: DVec2) -> Result<Self, JobError> {
        let (low, _) = self.region.bounds_mm().unwrap_or_default();
        let grid = self.region.grid();
        let corner = GridPoint::new(-grid.steps(low.x), -grid.steps(low.y));
        let region = snapped_to_f32(&self.region.shifted(corner)).map_err(JobError::Fabricate)?;
        let seams_mm = self.seams_mm.iter().map(|seam| seam.iter().map(|&p| p - low).collect()).collect();
        Ok(Self { region, page_mm, shift_mm: self.shift_mm - low, seams_mm, ..self.clone() })
    }
}

/// Closed paths, moved by `shift`, on the grid.
fn region_of(paths: &[Vec<DVec2>], grid: Grid, shift: DVec2) -> Result<Region, PartError> {
    let mut contours = Vec::with_capacity(paths.len());
    for path in paths {
        let snapped: Result<Vec<_>, _> = path.iter().map(|&p| grid.snap(p + shift)).collect();
        let snapped = snapped.map_err(|e| PartError::Job(JobError::Fabricate(e.into())))?;
        contours.extend(Contour::new(snapped));
    }
    Region::from_contours(grid, contours).map_err(|error| match error {
        RegionError::Invalid { faults } => {
            PartError::Untrue(OutlineFault::Contact { position_mm: faults[0].position_mm() })
        }
        RegionError::Grid(e) => PartError::Job(JobError::Fabricate(e.into())),
    })
}

/// What a region has whose lower and upper sides are one place.
fn rolled_across(region: &Region) -> Result<Counts, PartError> {
    let upright = region.turned_right();
    let (low, high) = upright.bounds_mm().unwrap_or_default();
    let rolled = verify::rolled(&upright, [low.x, high.x])
        .map_err(|_| PartError::Untrue(OutlineFault::Contact { position_mm: DVec2::splat(MARGIN_MM) }))?;
    Ok(Counts { components: rolled.components, holes: rolled.holes })
}

fn check_counts(counts: Counts, planned: Topology) -> Result<(), PartError> {
    let Counts { components, holes } = counts;
    match (components, holes) == (planned.components as usize, planned.holes as usize) {
        true => Ok(()),
        false => Err(PartError::Untrue(OutlineFault::Counts { components, holes })),
    }
}
