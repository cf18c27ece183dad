//! The exemplar of a job, read and cut into pieces.

use glam::DVec2;

use super::builder::{BandJob, SlicingChoice};
use super::error::JobError;
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::fit::Sides;
use crate::pieces::{Catalogue, CostWeights};
use crate::planar::{Region, Tolerances};
use crate::reeb::{ReebGraph, Slicing, SlicingRule};

/// The part of the chord error that is for flattening the exemplar.
pub const READ_SHARE: f64 = 0.25;

/// An exemplar cut into pieces.
pub(super) struct Cut {
    pub(super) exemplar: Exemplar,
    pub(super) region: Region,
    pub(super) slicing: Slicing,
    pub(super) catalogue: Catalogue,
    pub(super) weights: CostWeights,
    pub(super) mirror: bool,
    pub(super) height_mm: f64,
    /// What becomes of the sides of the band.
    pub(super) sides: Sides,
    /// Parts and holes that are too small to be told from nothing at the chord error.
    pub(super) specks: Vec<DVec2>,
}

impl Cut {
    /// What is cut.
    pub(super) fn region(&self) -> &Region {
        &self.region
    }

    /// Makes the catalogue again, after cuts were left out or weights were changed.
    pub(super) fn weigh(&mut self, own_ends_only: bool) {
        self.catalogue = self.weighed(&self.weights, own_ends_only);
    }

    /// The catalogue with every join instead of the cheapest few; `None` if these are all.
    pub(super) fn with_all_successors(&self) -> Option<Catalogue> {
        let successors = self.catalogue.originals();
        let weights = CostWeights { successors, ..self.weights };
        (self.weights.successors < successors)
            .then(|| self.weighed(&weights, self.catalogue.has_own_ends_only()))
    }

    /// Takes the catalogue with every join for the one with the cheapest few.
    pub(super) fn admit(&mut self, with_all_successors: Catalogue) {
        self.weights.successors = with_all_successors.originals();
        self.catalogue = with_all_successors;
    }

    fn weighed(&self, weights: &CostWeights, own_ends_only: bool) -> Catalogue {
        let catalogue = match self.sides {
            Sides::Joined => Catalogue::rolled(&self.region, &self.slicing.cuts, weights),
            _ => catalogue(&self.region, &self.slicing, weights, self.mirror),
        };
        if own_ends_only { catalogue.with_own_ends_only() } else { catalogue }
    }
}

/// How the exemplar is read for a job with this chord error.
pub(super) fn read_options(chord_mm: f64, height_mm: Option<f64>) -> ReadOptions {
    ReadOptions { chord_mm: chord_mm * READ_SHARE, target_height_mm: height_mm, limits: Limits::default() }
}

/// The ink that is cut: without parts and holes that the chord error cannot tell from nothing, and where those are.
pub(super) fn cleaned(region: &Region, chord_mm: f64) -> (Region, Vec<DVec2>) {
    region.without_specks(chord_mm.powi(2))
}

/// The exemplar at the size and the chord error of the job.
pub(super) fn read_exemplar(job: &BandJob) -> Result<Exemplar, JobError> {
    let options = read_options(job.tolerances.chord_mm(), job.options.width_mm);
    Ok(Exemplar::read(&job.options.exemplar, &options)?)
}

/// Cuts the exemplar.
pub(super) fn slice(job: &BandJob, exemplar: Exemplar) -> Result<Cut, JobError> {
    let region = exemplar.region().clone();
    slice_region(job, exemplar, &region)
}

/// Cuts `region`, which is the ink of `exemplar` or was made from it.
pub(super) fn slice_region(job: &BandJob, exemplar: Exemplar, region: &Region) -> Result<Cut, JobError> {
    let (region, specks) = cleaned(region, job.tolerances.chord_mm());
    let region = &region;
    if region.is_empty() {
        return Err(JobError::Option {
            option: "--chord",
            found: format!("at {} mm all ink is no more than specks", job.tolerances.chord_mm()),
            wanted: "use a smaller --chord, or a larger --width".to_owned(),
        });
    }
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let rule = match job.options.slicing {
        SlicingChoice::Reeb => SlicingRule::reeb_for_width(high.x - low.x),
        SlicingChoice::Persistence(persistence_mm) => SlicingRule::Reeb { persistence_mm },
        SlicingChoice::Uniform(lines) => SlicingRule::Uniform { lines },
    };
    let reeb = ReebGraph::new(region);
    // What will be thickened may be cut where it is thin.
    let tolerances = match job.options.enforce {
        true => &Tolerances::new(job.tolerances.chord_mm(), 0.0, 0.0)?,
        false => &job.tolerances,
    };
    let slicing = Slicing::keeping(region, &reeb, rule, &job.options.kept, tolerances)?;
    let (weights, mirror) = (job.options.weights, job.options.mirror);
    let catalogue = catalogue(region, &slicing, &weights, mirror);
    let (region, height_mm) = (region.clone(), high.y - low.y);
    Ok(Cut { region, slicing, catalogue, weights, mirror, height_mm, sides: Sides::Free, exemplar, specks })
}

fn catalogue(region: &Region, slicing: &Slicing, weights: &CostWeights, mirror: bool) -> Catalogue {
    let new = if mirror { Catalogue::with_mirrored } else { Catalogue::new };
    new(region, &slicing.cuts, weights)
}
