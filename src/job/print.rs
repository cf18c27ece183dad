//! What a printer is given: a solid with its edges, its number of triangles and its place on the bed, as STL, 3MF
//! or OBJ.

use std::borrow::Cow;
use std::path::Path;

use super::error::JobError;
use super::output::Format;
use crate::export::{self, MeshDocument};
use crate::fabricate::{self, Bed, Counts, Profile, Solid};
use crate::planar::Region;

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
