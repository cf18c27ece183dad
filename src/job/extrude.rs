//! Any SVG, as it is, to a verified solid.

use std::path::Path;

use serde::Serialize;

use super::bridging::{self, BridgesReport};
use super::error::JobError;
use super::output::{Output, Pending, Target, persist};
use super::report::{InputReport, StageTime};
use super::stage::{Clock, Stage};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::export;
use crate::fabricate::{self, Counts};
use crate::planar::{Region, Tolerances};
use crate::verify::{self, Expected, StlReport};

/// What was extruded, and what was found in the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExtrudeReport {
    /// The version of this structure.
    pub schema_version: u32,
    /// The drawing.
    pub input: InputReport,
    /// Components of the drawing: shells of the solid.
    pub components: usize,
    /// Holes of the drawing: total genus of the solid.
    pub holes: usize,
    /// The height of the solid in millimetres.
    pub thickness_mm: f64,
    /// The bridges, when some were asked for; the counts are with them.
    pub bridges: Option<BridgesReport>,
    /// What was found in the file.
    pub solid: StlReport,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// Time per stage.
    pub times: Vec<StageTime>,
}

/// Bridges for a drawing that is extruded, and the counts that they are to make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtrudeBridges {
    /// The width of struts and slits in millimetres.
    pub width_mm: f64,
    /// The number of components; `None` leaves it as it is.
    pub components: Option<usize>,
    /// The number of holes; `None` leaves it as it is.
    pub holes: Option<usize>,
}

/// Extrudes the drawing in `file` to a solid `thickness_mm` high and writes it as STL, verified; with `bridges`,
/// these are laid before.
///
/// # Errors
/// [`JobError`] for a drawing that cannot be represented, a thickness out of range, and a file that cannot be
/// written or does not pass.
pub fn extrude(
    file: &Path,
    thickness_mm: f64,
    tolerances: &Tolerances,
    bridges: Option<ExtrudeBridges>,
    output: &Output,
    progress: &mut dyn FnMut(Stage),
) -> Result<ExtrudeReport, JobError> {
    Output::check([output.target()], &[file])?;
    let mut clock = Clock::new(progress);
    let options =
        ReadOptions { chord_mm: tolerances.chord_mm(), target_height_mm: None, limits: Limits::default() };
    let drawing = clock.time(Stage::Read, || Exemplar::read(file, &options))?;
    let mut region = drawing.region().clone();
    let mut notes = drawing.notes().to_vec();
    let bridges = match bridges {
        Some(wanted) => Some(clock.time(Stage::Bridge, || lay(&mut region, wanted, tolerances))?),
        None => None,
    };
    notes.extend(bridges.as_ref().map(|report| report.note(Counts::of(&region))));
    let bytes = clock.time(Stage::Stl, || {
        let solid = fabricate::extrude(&region, thickness_mm)?;
        Ok::<_, JobError>(export::stl(&solid, &format!("Openwork {}", env!("CARGO_PKG_VERSION")))?)
    })?;
    let pending = Pending::new(output.target(), bytes)?;
    let expected = Expected {
        components: Some(region.components()),
        holes: Some(region.holes()),
        ..Expected::default()
    };
    let solid = clock.time(Stage::Verify, || check_stl(output.target(), &pending, &expected))?;
    persist(vec![pending], None)?;
    Ok(ExtrudeReport {
        schema_version: 1,
        input: InputReport { file: file.display().to_string(), sha256: drawing.sha256().to_owned() },
        components: region.components(),
        holes: region.holes(),
        thickness_mm,
        solid,
        bridges,
        notes,
        times: clock.times,
    })
}

/// Gives a drawing bridges.
fn lay(
    region: &mut Region,
    wanted: ExtrudeBridges,
    tolerances: &Tolerances,
) -> Result<BridgesReport, JobError> {
    let without = Counts::of(region);
    let counts = Counts {
        components: wanted.components.unwrap_or(without.components),
        holes: wanted.holes.unwrap_or(without.holes),
    };
    let bridged = fabricate::bridge(region, counts, &bridging::options(wanted.width_mm, tolerances, None))?;
    *region = bridged.region;
    Ok(BridgesReport::new(without, bridged.bridges))
}

/// Reads a written STL again and holds it against the plan.
pub(super) fn check_stl(
    target: &Target,
    pending: &Pending,
    expected: &Expected,
) -> Result<StlReport, JobError> {
    let bytes = pending.read_again()?;
    let report =
        verify::read_stl(&bytes).map_err(|error| JobError::Unjudged { file: name(target), error })?;
    report.check(expected).map_err(|mismatch| JobError::Mismatch {
        file: name(target),
        mismatch,
        remedy: String::new(),
    })?;
    Ok(report)
}

/// The name of a target in messages.
pub(super) fn name(target: &Target) -> std::path::PathBuf {
    match target {
        Target::File(path) => path.clone(),
        Target::Stdout => "standard output".into(),
    }
}
