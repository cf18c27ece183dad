//! Any SVG, as it is, to a verified solid.

use std::path::Path;

use serde::Serialize;

use super::error::JobError;
use super::output::{Output, Pending, Target, persist};
use super::report::{InputReport, StageTime};
use super::stage::{Clock, Stage};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::export;
use crate::fabricate;
use crate::planar::Tolerances;
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
    /// What was found in the file.
    pub solid: StlReport,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// Time per stage.
    pub times: Vec<StageTime>,
}

/// Extrudes the drawing in `file` to a solid `thickness_mm` high and writes it as STL, verified.
///
/// # Errors
/// [`JobError`] for a drawing that cannot be represented, a thickness out of range, and a file that cannot be
/// written or does not pass.
pub fn extrude(
    file: &Path,
    thickness_mm: f64,
    tolerances: &Tolerances,
    output: &Output,
    progress: &mut dyn FnMut(Stage),
) -> Result<ExtrudeReport, JobError> {
    Output::check([output.target()], &[file])?;
    let mut clock = Clock::new(progress);
    let options =
        ReadOptions { chord_mm: tolerances.chord_mm(), target_height_mm: None, limits: Limits::default() };
    let drawing = clock.time(Stage::Read, || Exemplar::read(file, &options))?;
    let region = drawing.region();
    let bytes = clock.time(Stage::Stl, || {
        let solid = fabricate::extrude(region, thickness_mm)?;
        Ok::<_, JobError>(export::stl(&solid, &format!("Openwork {}", env!("CARGO_PKG_VERSION")))?)
    })?;
    let pending = Pending::new(output.target(), bytes)?;
    let expected = Expected {
        components: Some(region.components()),
        holes: Some(region.holes()),
        ..Expected::default()
    };
    let solid = clock.time(Stage::Verify, || check_stl(output.target(), &pending, &expected))?;
    persist(vec![pending])?;
    Ok(ExtrudeReport {
        schema_version: 1,
        input: InputReport { file: file.display().to_string(), sha256: drawing.sha256().to_owned() },
        components: region.components(),
        holes: region.holes(),
        thickness_mm,
        solid,
        notes: drawing.notes().to_vec(),
        times: clock.times,
    })
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
