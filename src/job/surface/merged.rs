//! A band and its model made one, and what that has to have.
//!
//! On a model whose surface S has no handles and β borders (a wall closes them), a pattern of c components and h holes in all leaves 1 + h
//! parts of S, which have β + c + h borders together. What is carved through the wall is therefore 1 + h shells of a total genus of β + c − 1: a shell over a
//! part with b borders has the genus b − 1. Without holes the model stays one piece, and each handle adds 2 to its genus. Standing out, or carved only so deep, it changes neither. Excluded: how solids are united.

use super::super::error::JobError;
use super::{Ground, SurfaceMode};
use crate::domain::MeshPart;
use crate::export;
use crate::fabricate::{self, Counts, Solid};
use crate::verify::{self, Expected};

/// How many shells a model with a band has, and their genus together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct MergedCounts {
    pub(in super::super) shells: usize,
    pub(in super::super) genus: usize,
}

impl MergedCounts {
    pub(in super::super) fn expected(self) -> Expected {
        Expected {
            components: Some(self.shells.into()),
            holes: Some(self.genus.into()),
            ..Expected::default()
        }
    }
}

impl Ground {
    /// What the model has with a pattern on it; `None` if the band is a part of its own.
    ///
    /// # Errors
    /// [`JobError::Refused`] for what is carved through a model of several parts, or with holes through one with handles, where
    /// counts do not follow from those of the pattern.
    pub(in super::super) fn merged_counts(&self, pattern: Counts) -> Result<Option<MergedCounts>, JobError> {
        let options = self.options();
        let parts = self.mesh().parts();
        let is_walled = options.shell_mm.is_some();
        if options.mode == SurfaceMode::Band {
            return Ok(None);
        }
        if !self.is_through() {
            // A wall over a part with b borders has the genus 2 g + b - 1; a hollow part has an outer and an inner shell.
            let own = |part: &MeshPart| match (is_walled, part.borders) {
                (true, 0) => (2, 2 * part.genus),
                (true, borders) => (1, 2 * part.genus + borders - 1),
                (false, _) => (1, part.genus),
            };
            let (shells, genus) =
                parts.iter().map(own).fold((0, 0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
            return Ok(Some(MergedCounts { shells, genus }));
        }
        // The surface that is carved, with what its wall has if it came with one.
        let (handles, borders) = match (parts.as_slice(), is_walled) {
            ([part], true) => (part.genus, part.borders),
            ([part], false) => (0, part.genus + 1),
            ([outer, inner], false) if outer.genus == inner.genus => (outer.genus, 0),
            _ => {
                return Err(JobError::Refused(format!(
                    "the model has {} parts, and what is carved through them cannot be counted beforehand; unite them, or carve each by itself",
                    parts.len()
                )));
            }
        };
        if handles > 0 && pattern.holes > 0 {
            return Err(JobError::Refused(format!(
                "a pattern of {} hole(s), carved through a model with {handles} handle(s), may part it or not; ask for --holes 0, which leaves it in one piece",
                pattern.holes
            )));
        }
        let genus = 2 * handles + borders + pattern.components - 1;
        Ok(Some(MergedCounts { shells: 1 + pattern.holes, genus }))
    }

    /// The model as a solid, with its wall.
    fn model(&self) -> Result<Solid, JobError> {
        let mesh = match self.options().shell_mm {
            Some(wall_mm) => &self.mesh().thickened(wall_mm)?,
            None => self.mesh(),
        };
        mesh.ensure_closed()?;
        let solid = Solid::from_facets(mesh.facets())?;
        // What crosses itself has no inside to add to or take from.
        let found = verify::read_stl(&export::stl(&solid, "")?)
            .map_err(|error| JobError::Unjudged { file: self.options().model.clone(), error })?;
        match (found.faults.first(), self.options().shell_mm) {
            (None, _) => Ok(solid),
            (Some(fault), Some(wall_mm)) => Err(JobError::Option {
                option: "--shell",
                found: format!("the model with a wall of {wall_mm} mm is not sound: {fault}"),
                wanted: "use a thinner wall, or a model that does not cross itself".to_owned(),
            }),
            (Some(fault), None) => Err(JobError::Option {
                option: "--mesh",
                found: format!("{} is not sound: {fault}", self.options().model.display()),
                wanted: "unite its parts (a boolean union), so that nothing crosses".to_owned(),
            }),
        }
    }

    /// What becomes of a `band` whose pattern has these counts: itself, or the model with it or without what is in it. What the user may
    /// want to know of that is added to `notes`.
    ///
    /// # Errors
    /// As [`Ground::merged_counts`], and for a model that is not sound.
    pub(in super::super) fn merged(
        &self,
        band: Solid,
        pattern: Counts,
        notes: &mut Vec<String>,
    ) -> Result<Solid, JobError> {
        let Some(MergedCounts { shells, genus }) = self.merged_counts(pattern)? else { return Ok(band) };
        notes.push(format!("the model with the pattern: {shells} shell(s) of a genus of {genus} in all"));
        if self.is_through() && pattern.holes > 0 {
            notes.push(format!(
                "carved through, the pattern parts the model into {} pieces, one more than it has holes; --holes 0 leaves it in one",
                pattern.holes + 1
            ));
        }
        let model = self.model()?;
        Ok(match self.options().mode {
            SurfaceMode::Carve => fabricate::difference(&model, &band)?,
            _ => fabricate::union(&[&model, &band])?,
        })
    }
}
