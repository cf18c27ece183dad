//! One part of a scene, made and judged as a command of its own would do it.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::cache::Key;
use super::strip::Strip;
use crate::domain::RectSize;
use crate::export;
use crate::fabricate::{self, Solid};
use crate::job::builder::BandJob;
use crate::job::error::JobError;
use crate::job::extrude::{self, ExtrudeBridges};
use crate::job::flat::FlatMaking;
use crate::job::output::{Format, Output};
use crate::job::rect_builder::RectJob;
use crate::job::stage::Stage;
use crate::planar::{FillRule, Grid, Region};
use crate::verify;

/// The part of the chord error that is spent on fewer facets. More, and curves that were drawn finely show corners; less, and
/// everything takes longer.
const SIMPLER_SHARE: f64 = 0.25;

/// What a part is made from.
#[derive(Debug, Clone)]
pub enum Making {
    /// A band of an exemplar.
    Band(Box<BandJob>),
    /// A rectangle of an exemplar.
    Rect(Box<RectJob>),
    /// A drawing as it is.
    Extrude {
        /// The drawing.
        file: PathBuf,
        /// How it is made.
        making: Box<FlatMaking>,
        /// Bridges that are laid before.
        bridges: Option<ExtrudeBridges>,
    },
    /// A plain strip along a curve.
    Strip(Box<Strip>),
    /// A plain plate with a corner at the origin.
    Plate {
        /// Width and depth.
        size: RectSize,
        /// The height in millimetres.
        thickness_mm: f64,
    },
    /// A mesh file: STL, 3MF or OBJ.
    Model {
        /// The file.
        file: PathBuf,
    },
}

/// A part that was made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Made {
    /// The solid, numbered as [`Solid::from_facets`] does it.
    pub(super) solid: Solid,
    /// The report of its command, or nothing.
    pub(super) report: Value,
    /// What the user may want to know.
    pub(super) notes: Vec<String>,
    /// Whether it was found in the cache.
    pub(super) is_kept: bool,
}

impl Making {
    /// The word for it in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Band(_) => "band",
            Self::Rect(_) => "rect",
            Self::Extrude { .. } => "extrude",
            Self::Strip(_) => "strip",
            Self::Plate { .. } => "plate",
            Self::Model { .. } => "model",
        }
    }

    /// The chord error of what is drawn.
    fn chord_mm(&self) -> Option<f64> {
        match self {
            Self::Band(job) => Some(job.tolerances.chord_mm()),
            Self::Rect(job) => Some(job.band.tolerances.chord_mm()),
            Self::Extrude { making, .. } => Some(making.tolerances.chord_mm()),
            Self::Strip(_) | Self::Plate { .. } | Self::Model { .. } => None,
        }
    }

    /// What the part follows from: all options, and the bytes of all `files` that it reads. A file that cannot be read is left to
    /// the making to complain of.
    pub(super) fn key(&self, files: &[PathBuf]) -> Key {
        let read = |file: &PathBuf| std::fs::read(file).unwrap_or_default();
        let options = format!("{self:?}").into_bytes();
        let blocks: Vec<Vec<u8>> = std::iter::once(options).chain(files.iter().map(read)).collect();
        Key::of(blocks.iter().map(Vec::as_slice))
    }

    /// Makes it.
    ///
    /// # Errors
    /// As the command of this kind.
    pub(super) fn make(&self, progress: &mut dyn FnMut(Stage)) -> Result<Made, JobError> {
        let outputs = [Output::stdout(Format::Stl)];
        let made = |solid: Option<Solid>, report: Value, notes: Vec<String>| {
            let solid = solid.expect("a solid was asked for");
            // Outlines are finer than the chord error by as much as they are bent after they are drawn.
            let solid = match self.chord_mm() {
                Some(chord_mm) => solid.with_fewer_facets(chord_mm * SIMPLER_SHARE)?,
                None => solid,
            };
            Ok(Made { solid: Solid::from_facets(solid.facets())?, report, notes, is_kept: false })
        };
        match self {
            Self::Band(job) => {
                let band = job.run_all_for(&outputs, progress)?.swap_remove(0);
                let (report, _) = band.deliver(&outputs, progress)?;
                made(Some(band.into_solid()?), json(&report), report.made.notes)
            }
            Self::Rect(job) => {
                let rect = job.run(progress)?;
                let (report, _) = rect.deliver(&outputs, progress)?;
                made(Some(rect.into_solid()?), json(&report), report.made.notes)
            }
            Self::Extrude { file, making, bridges } => {
                let (report, _, solid) = extrude::extruded(file, making, *bridges, &outputs, progress)?;
                made(solid, json(&report), report.notes)
            }
            Self::Strip(strip) => {
                progress(Stage::Stl);
                made(Some(strip.solid()?), Value::Null, Vec::new())
            }
            Self::Plate { size, thickness_mm } => {
                progress(Stage::Stl);
                made(Some(plate(*size, *thickness_mm)?), Value::Null, Vec::new())
            }
            Self::Model { file } => {
                progress(Stage::Read);
                made(Some(model(file)?), Value::Null, Vec::new())
            }
        }
    }
}

fn json(report: &impl serde::Serialize) -> Value {
    serde_json::to_value(report).expect("reports have no maps with keys that are not text")
}

fn plate(size: RectSize, thickness_mm: f64) -> Result<Solid, JobError> {
    let (w, d) = (size.width_mm(), size.height_mm());
    let grid = Grid::for_extent(w.max(d)).map_err(fabricate::FabricateError::from)?;
    let corners = [(0.0, 0.0), (w, 0.0), (w, d), (0.0, d)];
    let corners = corners.map(|(x, y)| grid.snap(glam::DVec2::new(x, y)).expect("it is within the extent"));
    Ok(fabricate::extrude(&Region::fill(grid, &[corners.to_vec()], FillRule::EvenOdd), thickness_mm)?)
}

/// The solid of a mesh file, if it is sound.
fn model(file: &Path) -> Result<Solid, JobError> {
    let refuse = |found: String| JobError::Option {
        option: "model",
        found: format!("{}: {found}", file.display()),
        wanted: "use an STL, a 3MF or an OBJ of a closed solid".to_owned(),
    };
    let bytes = std::fs::read(file).map_err(|error| refuse(error.to_string()))?;
    let facets = verify::read_facets(&bytes).map_err(|error| refuse(error.to_string()))?;
    let solid = Solid::from_facets(facets).map_err(|error| refuse(error.to_string()))?;
    // What crosses itself is seen by the same eyes as in what is written.
    let found = verify::read_stl(&export::stl(&solid, "")?).map_err(|error| refuse(error.to_string()))?;
    match found.faults.first() {
        Some(fault) => Err(refuse(format!("it has {} fault(s), first: {fault}", found.faults.len()))),
        None => Ok(solid),
    }
}
