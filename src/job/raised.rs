//! A solid and the files that hold it, each read as it will be written and held against the plan.
//!
//! It takes as long as the drawing and knows nothing of it, so both are made side by side (see
//! [`Clock::both`](super::stage::Clock::both)). Excluded: how a solid is made ([`super::print`]), and the names of files.

use super::band::FINER_CHORDS;
use super::error::{JobError, OURS};
use super::flat::name;
use super::output::{Format, Output};
use super::print::mesh;
use super::stage::{Clock, Stage};
use crate::export::MeshDocument;
use crate::fabricate::{FabricateError, Solid};
use crate::verify::{self, Expected, MeshReport, Mismatch};

/// Solids of more facets are not made again with finer ones: each takes several times as long.
const MOST_FACETS: usize = 300_000;

/// The unit that a 3MF must name: many programs ask, or guess, where none is named.
const UNIT: &str = "millimeter";

/// A solid, if something asks for it, and its files.
#[derive(Debug, Clone, Default)]
pub(super) struct Raised {
    solid: Option<Solid>,
    /// What the user may want to know of it.
    pub(super) notes: Vec<String>,
    /// One of each format that is asked for.
    files: Vec<MeshFile>,
}

/// The content of a file of a solid that has passed.
#[derive(Debug, Clone)]
pub(super) struct MeshFile {
    format: Format,
    pub(super) bytes: Vec<u8>,
    /// What was found in it.
    pub(super) found: MeshReport,
}

/// What a solid is made for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'w> {
    /// Those that hold a solid have a file.
    pub(super) outputs: &'w [Output],
    /// What files say of it.
    pub(super) document: &'w MeshDocument,
    /// What each of them has to have.
    pub(super) expected: &'w Expected,
    /// Whether it is wanted without any file: its picture, or its volume.
    pub(super) is_shown: bool,
}

impl Raised {
    /// What is `wanted`, of the solid that `make` gives, which may add to the notes.
    ///
    /// # Errors
    /// [`JobError`] when the solid cannot be made, and of the first file that does not pass.
    pub(super) fn new(
        wanted: Wanted<'_>,
        clock: &mut Clock<'_>,
        make: impl FnOnce(&mut Vec<String>) -> Result<Solid, JobError>,
    ) -> Result<Self, JobError> {
        let mut raised = Self::default();
        let is_solid = |output: &&Output| output.format().is_solid();
        if !wanted.is_shown && !wanted.outputs.iter().any(|output| is_solid(&output)) {
            return Ok(raised);
        }
        let solid = clock.time(Stage::Stl, || make(&mut raised.notes))?;
        for output in wanted.outputs.iter().filter(is_solid) {
            let format = output.format();
            if raised.file(format).is_none() {
                let bytes = clock.time(Stage::Stl, || mesh(format, &solid, wanted.document))?;
                let found = clock.time(Stage::Verify, || check(output, &bytes, &solid, wanted.expected))?;
                raised.files.push(MeshFile { format, bytes, found });
            }
        }
        Ok(Self { solid: Some(solid), ..raised })
    }

    /// The same of a solid that is bent, for which `make` is told how near its facets have to be. On a bend, facets of ink on both sides of a
    /// gap that is finer than they are may cross; then it is made again with finer ones.
    ///
    /// # Errors
    /// As [`Raised::new`].
    pub(super) fn bent(
        wanted: Wanted<'_>,
        clock: &mut Clock<'_>,
        asked_mm: f64,
        make: impl Fn(f64, &mut Vec<String>) -> Result<Solid, JobError>,
    ) -> Result<Self, JobError> {
        let mut facets = 0;
        let mut raised = Self::new(wanted, clock, |notes| {
            let solid = make(asked_mm, notes)?;
            facets = solid.triangles().len();
            Ok(solid)
        });
        for chord_mm in FINER_CHORDS.map(|part| part * asked_mm) {
            if !is_faulty(&raised) || facets > MOST_FACETS {
                break;
            }
            raised = Self::new(wanted, clock, |notes| {
                notes.push(format!(
                    "facets are within {chord_mm:.4} mm instead of {asked_mm:.4} mm, at which some would have crossed"
                ));
                let solid = make(chord_mm, notes)?;
                facets = solid.triangles().len();
                Ok(solid)
            });
        }
        raised.map_err(|error| match error {
            JobError::Mismatch { file, mismatch: mismatch @ Mismatch::Faults { .. }, .. } => {
                let remedy = "; ink or gaps are too fine for facets there: make it larger, or give --min-feature and --min-gap, which say where that is";
                JobError::Mismatch { file, mismatch, remedy: remedy.to_owned() }
            }
            error => error,
        })
    }

    /// Whether each of `outputs` that holds a solid has its file.
    pub(super) fn is_for(&self, outputs: &[Output]) -> bool {
        outputs.iter().all(|output| !output.format().is_solid() || self.file(output.format()).is_some())
    }

    /// The file of a format that holds a solid, if an output asked for it.
    pub(super) fn file(&self, format: Format) -> Option<&MeshFile> {
        self.files.iter().find(|file| file.format == format)
    }

    /// The solid, if something asked for it.
    pub(super) fn solid(&self) -> Option<&Solid> {
        self.solid.as_ref()
    }

    /// The volume in cubic millimetres: of what was read last, or else of the solid.
    pub(super) fn volume_mm3(&self) -> Option<f64> {
        let read = self.files.last().map(|file| file.found.volume_mm3);
        read.or_else(|| self.solid.as_ref().map(Solid::volume_mm3))
    }
}

/// Reads the bytes of a solid and holds them against the plan: what was asked for, and the solid itself.
fn check(output: &Output, bytes: &[u8], solid: &Solid, expected: &Expected) -> Result<MeshReport, JobError> {
    let read = match output.format() {
        Format::Threemf => verify::read_threemf(bytes),
        Format::Obj => verify::read_obj(bytes),
        _ => verify::read_stl(bytes),
    };
    let file = || name(output.target());
    let report = read.map_err(|error| JobError::Unjudged { file: file(), error })?;
    let mismatch =
        |mismatch, remedy: &str| JobError::Mismatch { file: file(), mismatch, remedy: remedy.to_owned() };
    report.check(expected).map_err(|found| mismatch(found, ""))?;
    if output.format() == Format::Threemf && report.unit != Some(UNIT) {
        let found = Mismatch::Unit { found: report.unit, wanted: UNIT };
        return Err(mismatch(found, OURS));
    }
    report.is_like(solid.facets()).map_err(|found| mismatch(found.into(), OURS))?;
    Ok(report)
}

/// Whether a solid was made that is not sound.
fn is_faulty(raised: &Result<Raised, JobError>) -> bool {
    matches!(
        raised,
        Err(JobError::Mismatch { mismatch: Mismatch::Faults { .. }, .. }
            | JobError::Fabricate(FabricateError::Rounding { .. } | FabricateError::Facets { .. }))
    )
}
