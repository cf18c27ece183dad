//! The report of an area that was filled, as JSON.

use schemars::JsonSchema;
use serde::Serialize;

use super::census::Density;
use super::engine::ChangeReport;
use crate::fabricate::Counts;
use crate::job::bridging::BridgesReport;
use crate::job::json;
use crate::job::laser::LaserReport;
use crate::job::making::{EnforcedReport, Quantities};
use crate::job::report::{FlatPattern, InputReport, StageTime, SurfaceReport};
use crate::samples::LevelReport;
use crate::verify::{MeshReport, NarrowPlaces, SvgReport};

/// What was asked for, what was made, and what was found in the files. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FillReport {
    /// The version of this structure; it changes when a field changes its meaning or goes.
    pub schema_version: u32,
    /// The program and its version.
    pub generator: String,
    /// The exemplar.
    pub exemplar: InputReport,
    /// The domain as it was given.
    pub domain: String,
    /// The curve of a band, as it was given.
    pub along: Option<String>,
    /// The width of a band.
    pub width_mm: Option<f64>,
    /// What was asked of a band on a model; null for others.
    pub surface: Option<SurfaceReport>,
    /// The file that the domain, its curve or its model comes from, if it does.
    pub domain_file: Option<InputReport>,
    /// The strokes that were kept, if there were some.
    pub kept: Option<InputReport>,
    /// The area of the domain in square millimetres.
    pub domain_mm2: f64,
    /// Width and height of the page.
    pub page_mm: [f64; 2],
    /// What random choices came from.
    pub seed: u64,
    /// The width of the widest pen.
    pub pen_mm: f64,
    /// The least and the greatest number of components that were asked for.
    pub wanted_components: Option<[u32; 2]>,
    /// The least and the greatest number of holes that were asked for.
    pub wanted_holes: Option<[u32; 2]>,
    /// Components of the pattern, as it stands. They are those of the written files, but for a model that is one with it and a drawing that was
    /// cut open.
    pub components: usize,
    /// Holes of the pattern, likewise.
    pub holes: usize,
    /// Components and holes of the pattern by itself, before anything was done for the counts that were asked for and before it was clipped.
    pub own: Counts,
    /// What the drawing is of a strip in space; null for what lies in the plane.
    pub flat: Option<FlatPattern>,
    /// Counts of the exemplar on its area.
    pub exemplar_density: Density,
    /// Counts of the result on the domain.
    pub density: Density,
    /// What happened at each level, from coarse to fine.
    pub levels: Vec<LevelReport>,
    /// Every join and every opening that made the counts what they are, in order.
    pub changes: Vec<ChangeReport>,
    /// The bridges, when edges of the pattern did not suffice; the counts are with them.
    pub bridges: Option<BridgesReport>,
    /// The thickness of the solid.
    pub thickness_mm: f64,
    /// The greatest distance between a curve and what stands for it.
    pub chord_mm: f64,
    /// What was thickened and widened; null when it was not asked for, or nothing was lacking.
    pub enforced: Option<EnforcedReport>,
    /// The ten narrowest places of ink and of gaps.
    pub narrow_places: NarrowPlaces,
    /// What costs money.
    pub quantities: Quantities,
    /// Bytes of the files, in their order.
    pub bytes: Vec<usize>,
    /// What was found in the solid, if one was written.
    pub solid: Option<MeshReport>,
    /// What was found in the SVG, if one was written.
    pub drawing: Option<SvgReport>,
    /// The files of cut lines, if some were written.
    pub laser: Option<LaserReport>,
    /// The files that were written.
    pub files: Vec<String>,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// Time per stage.
    pub times: Vec<StageTime>,
}

impl FillReport {
    /// The report as indented JSON, arrays on one line, ending in a line break.
    pub fn to_json(&self) -> String {
        json::indented(self)
    }
}
