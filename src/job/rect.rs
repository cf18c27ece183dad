//! A rectangle: two bands, one along each direction (Zhou 2014 §6.2).
//!
//! The pattern is synthesized along u, turned by 90 degrees, used as the exemplar along v, and turned back. Turns
//! are exact, and the second band has the constraints of the whole, so nothing has to be proved again: the
//! rectangle *is* a band that lies on its side. What is excluded here is the choice of both directions, which
//! is a search of its own ([`super::rect_search`]).
//!
//! The ink fills the rectangle: the run of each pass has the exact length between its first and its last ink,
//! and across it the rows are pressed or stretched, at most as much as a band may be along its length.

use super::band::Band;
use super::error::JobError;
use super::notes::of_first_pass;
use super::output::{Output, Pending, Target, persist};
use super::plan::Plan;
use super::rect_builder::RectJob;
use super::rect_report::{DirectionReport, RectReport};
use super::rect_rows::Made;
use super::rect_search::{Found, search};
use super::report::MadeReport;
use super::stage::{Clock, Stage};
use crate::fabricate::Solid;
use crate::planar::Region;
use crate::topology::{Topology, Wanted};
use crate::verify::Tiling;

/// A rectangle that has the planned topology, ready to be written.
#[derive(Debug, Clone)]
pub struct Rect {
    /// The second pass, turned back.
    band: Band,
    report: RectReport,
}

impl Rect {
    pub(super) fn new(job: &RectJob, progress: &mut dyn FnMut(Stage)) -> Result<Self, JobError> {
        let mut clock = Clock::new(progress);
        let found = search(job, &mut clock)?;
        let report = describe(job, &found);
        let Made { mut band, .. } = found.second;
        band.report.made.times = clock.times;
        Ok(Self { band, report })
    }

    /// The part in millimetres, y up from the lower left corner of its page.
    pub fn region(&self) -> &Region {
        self.band.region()
    }

    /// The plan of the second pass: rows, from the top.
    pub fn plan(&self) -> &Plan {
        self.band.plan()
    }

    /// The tiling that copies make, if the rectangle is a tile.
    pub fn tiling(&self) -> Option<Tiling> {
        self.report.tiling
    }

    /// What the rows add up to.
    pub fn topology(&self) -> Topology {
        self.band.topology()
    }

    /// Encodes every output, reads each again, counts, and gives them their names only if all pass. The report
    /// goes to `report_file` as JSON, if one is named.
    ///
    /// # Errors
    /// [`JobError`] when a file cannot be written or does not pass; then none of them exists under its name.
    pub fn write(
        &self,
        outputs: &[Output],
        report_file: Option<&Target>,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<RectReport, JobError> {
        self.band.job.check_outputs(outputs, report_file)?;
        let (report, pending) = self.deliver(outputs, progress)?;
        persist(pending, report_file.map(|target| (target, report.to_json())))?;
        Ok(report)
    }

    /// Every output, encoded, read again and counted, on its way to its name; and the report.
    pub(super) fn deliver(
        &self,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(RectReport, Vec<Pending>), JobError> {
        let (found, pending) = self.band.deliver(outputs, progress)?;
        let mut report = self.report.clone();
        (report.components, report.holes) = (found.components, found.holes);
        report.chord_mm = found.chord_mm;
        let notes = report.made.notes.into_iter().chain(found.made.notes).collect();
        report.made = MadeReport { notes, ..found.made };
        Ok((report, pending))
    }

    /// The part as a solid.
    pub(super) fn into_solid(self) -> Result<Solid, JobError> {
        self.band.into_solid()
    }
}

fn describe(job: &RectJob, found: &Found) -> RectReport {
    let Found { first, second, cuts_mm, exemplar, .. } = found;
    let first_report = &first.band.report;
    let options = &job.band.options;
    let made = &second.band.report;
    // Notes on the exemplar itself come with the second pass too.
    let own = first_report.made.notes.iter().filter(|note| !exemplar.notes().contains(note));
    let notes = own.map(|note| of_first_pass(note)).chain(job.note.clone()).collect();
    RectReport {
        schema_version: 1,
        generator: made.generator,
        exemplar: made.exemplar.clone(),
        size_mm: [job.size.width_mm(), job.size.height_mm()],
        seed: options.seed,
        wanted_components: options.goal.components.map(Wanted::ends),
        wanted_holes: options.goal.holes.map(Wanted::ends),
        components: made.components,
        holes: made.holes,
        mirror: options.mirror,
        kept_mm: options.kept.iter().map(|k| [k.from_mm, k.to_mm]).collect(),
        thickness_mm: options.thickness_mm,
        chord_mm: job.band.tolerances.chord_mm(),
        along_u: DirectionReport::new(first_report, first_report.width_mm, first.cuts_mm.clone()),
        along_v: DirectionReport::new(made, job.size.width_mm(), cuts_mm.clone()),
        tiling: second.tiling,
        flat: made.flat.clone(),
        bridges: made.bridges.clone(),
        attempts: found.attempts.clone(),
        chosen_attempt: found.chosen,
        made: MadeReport { notes, ..made.made.clone() },
    }
}
