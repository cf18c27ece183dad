//! What a printer is given: a solid with its edges, its number of triangles and its place on the bed, as STL, 3MF
//! or OBJ.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::path::Path;

use super::error::{JobError, OURS};
use super::extrude::name;
use super::output::{Format, Output, Pending};
use super::stage::{Clock, Stage};
use crate::export::{self, MeshDocument};
use crate::fabricate::{self, Bed, Counts, Profile, Solid};
use crate::planar::Region;
use crate::verify::{self, Expected, MeshReport, Mismatch};

/// The unit that a 3MF must name: many programs ask, or guess, where none is named.
const UNIT: &str = "millimeter";

/// How a solid is made, beyond its thickness.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PrintOptions {
    /// Bevels all edges of the bottom and the top at 45 degrees, so wide and high in millimetres.
    pub chamfer_mm: Option<f64>,
    /// Slopes all walls inwards from the bottom to the top, by so many degrees.
    pub taper_deg: Option<f64>,
    /// The most triangles that the solid may have.
    pub max_triangles: Option<usize>,
    /// The printer's bed, which the part must fit.
    pub bed: Option<Bed>,
    /// Whether the solid is turned and moved to the middle of the bed; otherwise it stays as drawn.
    pub place: bool,
    /// The command that makes it, for files that can tell.
    pub command: Option<String>,
}

impl PrintOptions {
    /// The walls of a solid.
    ///
    /// # Errors
    /// [`JobError::Fabricate`] for a thickness, a chamfer or a taper out of range.
    pub(super) fn profile(&self, thickness_mm: f64) -> Result<Profile, JobError> {
        let mut profile = Profile::upright(thickness_mm)?;
        if let Some(chamfer_mm) = self.chamfer_mm {
            profile = profile.chamfered(chamfer_mm)?;
        }
        if let Some(taper_deg) = self.taper_deg {
            profile = profile.tapered(taper_deg)?;
        }
        Ok(profile)
    }

    /// The solid over `region`; what the user may want to know is added to `notes`.
    pub(super) fn solid(
        &self,
        region: &Region,
        thickness_mm: f64,
        chord_mm: f64,
        notes: &mut Vec<String>,
    ) -> Result<Solid, JobError> {
        let mut region = Cow::Borrowed(region);
        if let Some(bed) = &self.bed {
            let turn_deg = bed.turn_for(&region, thickness_mm)?;
            if self.place {
                region = Cow::Owned(bed.place(&region, turn_deg).map_err(fabricate::FabricateError::from)?);
            } else if turn_deg != 0.0 {
                notes.push(format!(
                    "the part fits the bed only when it is turned by {turn_deg:.1} degrees; --place writes it so, in the middle of the bed"
                ));
            }
        }
        let profile = self.profile(thickness_mm)?;
        let made = fabricate::raise_within(&region, &profile, chord_mm, self.max_triangles)?;
        let count = made.solid.triangles().len();
        if count < made.triangles_before {
            notes.push(format!(
                "the outline of the solid was simplified within the chord error: {count} triangles instead of {}",
                made.triangles_before
            ));
        }
        Ok(made.solid)
    }

    /// What files say of a solid that was learnt from `source`.
    pub(super) fn document(&self, source: &Path, seed: Option<u64>, counts: Counts) -> MeshDocument {
        let note = |name: &str, text: String| (name.to_owned(), text);
        let mut notes = Vec::new();
        notes.extend(self.command.clone().map(|command| note("Command", command)));
        notes.extend(seed.map(|seed| note("Seed", seed.to_string())));
        notes.push(note("Components", counts.components.to_string()));
        notes.push(note("Holes", counts.holes.to_string()));
        MeshDocument {
            title: source.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            application: format!("Openwork {}", env!("CARGO_PKG_VERSION")),
            notes,
            colours: if counts.components > 1 { COLOURS.to_vec() } else { vec![MeshDocument::GREY] },
        }
    }
}

/// Colours in which parts are told apart, also by those who see few of them (Okabe and Ito 2008).
const COLOURS: [[u8; 3]; 6] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xd5, 0x5e, 0x00],
];

/// A solid as a file of a format that holds one.
pub(super) fn mesh(format: Format, solid: &Solid, document: &MeshDocument) -> Result<Vec<u8>, JobError> {
    Ok(match format {
        Format::Threemf => export::threemf(solid, document),
        Format::Obj => export::obj(solid, document),
        _ => export::stl(solid, &document.application)?,
    })
}

/// The files of a solid.
#[derive(Default)]
pub(super) struct Meshes {
    /// The solid, once it was made.
    solid: Option<Solid>,
    /// The volume of the last of the files, as it was read again.
    read_mm3: Option<f64>,
    /// What the user may want to know of it.
    pub(super) notes: Vec<String>,
    /// The files, in the order of the outputs that they are for.
    files: VecDeque<MeshFile>,
}

/// A file of a solid that has passed.
pub(super) struct MeshFile {
    pub(super) item: Pending,
    /// What it holds.
    pub(super) bytes: Vec<u8>,
    /// What was found in it.
    pub(super) found: MeshReport,
}

impl Meshes {
    /// Those of `outputs` that hold a solid, each written, read again and held against the plan. A solid that will be shown is
    /// made without any.
    ///
    /// # Errors
    /// [`JobError`] when the solid cannot be made, and of the first file that cannot be written or does not pass.
    pub(super) fn new(
        outputs: &[Output],
        is_shown: bool,
        document: &MeshDocument,
        expected: &Expected,
        clock: &mut Clock<'_>,
        make: impl FnOnce(&mut Vec<String>) -> Result<Solid, JobError>,
    ) -> Result<Self, JobError> {
        let mut meshes = Self::default();
        let mut outputs = outputs.iter().filter(|output| output.format().is_solid()).peekable();
        if outputs.peek().is_none() && !is_shown {
            return Ok(meshes);
        }
        let solid = clock.time(Stage::Stl, || make(&mut meshes.notes))?;
        for output in outputs {
            let bytes = clock.time(Stage::Stl, || mesh(output.format(), &solid, document))?;
            let item = Pending::new(output.target(), bytes)?;
            let (bytes, found) = clock.time(Stage::Verify, || check_mesh(output, &item, &solid, expected))?;
            meshes.read_mm3 = Some(found.volume_mm3);
            meshes.files.push_back(MeshFile { item, bytes, found });
        }
        Ok(Self { solid: Some(solid), ..meshes })
    }

    /// The next of the files.
    pub(super) fn next(&mut self) -> MeshFile {
        self.files.pop_front().expect("there is one for each output that holds a solid")
    }

    /// The volume of the solid in cubic millimetres, if one was made or its walls are not upright; else there is no need of
    /// one.
    pub(super) fn volume_mm3(
        &mut self,
        is_upright: bool,
        make: impl FnOnce(&mut Vec<String>) -> Result<Solid, JobError>,
    ) -> Result<Option<f64>, JobError> {
        if self.read_mm3.is_some() || (is_upright && self.solid.is_none()) {
            return Ok(self.read_mm3);
        }
        Ok(Some(self.solid(make)?.volume_mm3()))
    }

    /// The solid that was made before, or the one that is made now.
    pub(super) fn solid(
        &mut self,
        make: impl FnOnce(&mut Vec<String>) -> Result<Solid, JobError>,
    ) -> Result<&Solid, JobError> {
        Ok(match &mut self.solid {
            Some(solid) => solid,
            none => none.insert(make(&mut self.notes)?),
        })
    }
}

/// Reads a written solid again and holds it against the plan: what was asked for, and the solid itself.
fn check_mesh(
    output: &Output,
    pending: &Pending,
    solid: &Solid,
    expected: &Expected,
) -> Result<(Vec<u8>, MeshReport), JobError> {
    let bytes = pending.read_again()?;
    let read = match output.format() {
        Format::Threemf => verify::read_threemf(&bytes),
        Format::Obj => verify::read_obj(&bytes),
        _ => verify::read_stl(&bytes),
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
    Ok((bytes, report))
}
