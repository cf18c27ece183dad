//! Everything that can end a job, and with which exit code.

use std::path::PathBuf;

use glam::DVec2;
use thiserror::Error;

use crate::domain::{DomainError, RectSizeError, SpaceError, SurfaceError};
use crate::exemplar::ExemplarError;
use crate::export::ExportError;
use crate::fabricate::{BridgeError, EnforceError, FabricateError, KerfError, SheetError};
use crate::fit::FitError;
use crate::pieces::CostWeightsError;
use crate::planar::TolerancesError;
use crate::reeb::SlicingError;
use crate::samples::{CompleteError, SampleError};
use crate::verify::{Mismatch, TilingFault, VerifyError};

/// Why a job ended without its files.
#[derive(Debug, Error)]
pub enum JobError {
    /// The exemplar or the file of the curve.
    #[error(transparent)]
    Exemplar(#[from] ExemplarError),
    /// The curve cannot carry the band.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The curve in space cannot carry the band.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// A model cannot be used, or no curve lies on it.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A rectangle is too small or too large.
    #[error(transparent)]
    Size(#[from] RectSizeError),
    /// The exemplar cannot be sliced.
    #[error(transparent)]
    Slicing(#[from] SlicingError),
    /// A tolerance out of range.
    #[error(transparent)]
    Tolerances(#[from] TolerancesError),
    /// A weight out of range.
    #[error(transparent)]
    Weights(#[from] CostWeightsError),
    /// An option out of range, or two that contradict each other.
    #[error("{option}: {found}; {wanted}")]
    Option {
        /// The option.
        option: &'static str,
        /// What was found.
        found: String,
        /// What would work.
        wanted: String,
    },
    /// No pattern can be synthesized.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// An exemplar of curves and elements has too little in it, or too much.
    #[error("{}: {error}", file.display())]
    Unlearnt {
        /// The exemplar's file.
        file: PathBuf,
        /// What it has.
        error: SampleError,
    },
    /// A pattern cannot be completed.
    #[error("{0}. Nothing was written")]
    Complete(#[from] CompleteError),
    /// No sequence of pieces meets the constraints.
    #[error("{0}")]
    Refused(String),
    /// The search was given up before it found a sequence.
    #[error(
        "the search for a sequence was given up after {labels} partial runs, without finding one and without showing that there is none; try counts nearer to the ornament's own, a shorter curve, coarser --slicing uniform:T, or a larger --effort and --memory-limit"
    )]
    SearchTooLarge {
        /// Labels made until then.
        labels: usize,
    },
    /// A sequence that the catalogue does not know: a bug of ours.
    #[error("internal error, please report it: {0}")]
    Fit(#[from] FitError),
    /// The mapped outline does not have the planned topology.
    #[error(
        "the band does not have the {components} component(s) and {holes} hole(s) that were planned: {fault}; the ornament has ink or gaps finer than the chord error: use a smaller --chord or a larger --width. Nothing was written"
    )]
    Outline {
        /// Components planned.
        components: usize,
        /// Holes planned.
        holes: usize,
        /// What is there instead.
        fault: OutlineFault,
    },
    /// Bridges cannot be laid.
    #[error("--bridge: {0}. Nothing was written")]
    Bridge(#[from] BridgeError),
    /// The kerf takes more than there is.
    #[error("--kerf: {0}. Nothing was written")]
    Kerf(#[from] KerfError),
    /// The part does not go on the plate.
    #[error("--sheet: {0}. Nothing was written")]
    Sheet(#[from] SheetError),
    /// Minimum feature and gap cannot be enforced.
    #[error(
        "--enforce: {0}; a larger --width would do, or a smaller --min-feature or --min-gap. Nothing was written"
    )]
    Enforce(#[from] EnforceError),
    /// The solid cannot be made.
    #[error(transparent)]
    Fabricate(#[from] FabricateError),
    /// A file cannot be made or written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A file was written but cannot be judged.
    #[error("{}: {error}; nothing was written under this name", file.display())]
    Unjudged {
        /// The output.
        file: PathBuf,
        /// Why.
        error: VerifyError,
    },
    /// A part of a scene.
    #[error("part {part}: {error}")]
    Part {
        /// Its name.
        part: String,
        /// What is wrong with it.
        error: Box<JobError>,
    },
    /// Two parts of a scene that are to fuse do not.
    #[error("the joint of {first} and {second} does not hold: {found}; {remedy}. Nothing was written")]
    Joint {
        /// The copy of the one part.
        first: String,
        /// The other part, or its copy.
        second: String,
        /// What is there instead.
        found: String,
        /// What would help.
        remedy: String,
    },
    /// A tile does not join its copies.
    #[error("the tile failed verification: {0}. Nothing was written")]
    Tiling(#[from] TilingFault),
    /// A file failed verification.
    #[error("{}: {mismatch}{remedy}. Nothing was written", file.display())]
    Mismatch {
        /// The output.
        file: PathBuf,
        /// What is not as asked for.
        mismatch: Mismatch,
        /// What would help.
        remedy: String,
    },
}

/// What is said of a file that is not like its plan.
pub(super) const OURS: &str = "; this is a bug of ours, please report it";

/// How a mapped outline differs from the plan.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum OutlineFault {
    /// Contours cross or touch, so that it bounds no region.
    #[error("contours meet at ({:.3}, {:.3}) mm on its page", position_mm.x, position_mm.y)]
    Contact {
        /// Where, from the lower left corner of the page, y up.
        position_mm: DVec2,
    },
    /// Other counts.
    #[error("it came out with {components} and {holes}")]
    Counts {
        /// Components found.
        components: usize,
        /// Holes found.
        holes: usize,
    },
}

impl JobError {
    /// The exit code: 2 wrong input or arguments, 3 constraints that cannot be met, 4 failed verification, 1 a
    /// bug of ours.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Exemplar(_)
            | Self::Domain(_)
            | Self::Space(_)
            | Self::Surface(_)
            | Self::Size(_)
            | Self::Tolerances(_)
            | Self::Samples(_)
            | Self::Unlearnt { .. }
            | Self::Weights(_)
            | Self::Option { .. }
            | Self::Sheet(_)
            | Self::Kerf(KerfError::Range { .. })
            | Self::Export(_) => 2,
            Self::Slicing(SlicingError::TooThin { .. }) => 3,
            Self::Slicing(_) => 2,
            Self::Bridge(BridgeError::Width { .. }) => 2,
            Self::Refused(_)
            | Self::Complete(_)
            | Self::SearchTooLarge { .. }
            | Self::Bridge(_)
            | Self::Kerf(_) => 3,
            Self::Enforce(EnforceError::Width { .. }) => 2,
            Self::Enforce(_) => 3,
            Self::Fabricate(
                FabricateError::Thickness { .. }
                | FabricateError::Chamfer { .. }
                | FabricateError::Taper { .. }
                | FabricateError::TooManyTriangles { .. }
                | FabricateError::TooHigh { .. }
                | FabricateError::Bed { .. }
                | FabricateError::Motion,
            ) => 2,
            Self::Fabricate(FabricateError::Inset { .. }) => 3,
            Self::Outline { .. }
            | Self::Tiling(_)
            | Self::Fabricate(_)
            | Self::Unjudged { .. }
            | Self::Mismatch { .. } => 4,
            Self::Part { error, .. } => error.exit_code(),
            Self::Joint { .. } => 3,
            Self::Fit(_) => 1,
        }
    }
}
