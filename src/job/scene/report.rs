//! The report of a scene, as JSON.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::joint::JointReport;
use crate::job::json;

/// What was built, and what was found in the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneReport {
    /// The version of this structure.
    pub schema_version: u32,
    /// The program and its version.
    pub generator: String,
    /// The parts, in the order of their names.
    pub parts: Vec<PartReport>,
    /// The joints that were asked for, each of which holds.
    pub joints: Vec<JointReport>,
    /// Shells of the whole.
    pub shells: usize,
    /// The total genus of the whole: its tunnels.
    pub genus: usize,
    /// Its facets.
    pub triangles: usize,
    /// Its volume in cubic millimetres.
    pub volume_mm3: f64,
    /// The least and the greatest coordinates in millimetres.
    pub bounds_mm: [[f64; 3]; 2],
    /// The files that were written.
    pub files: Vec<String>,
    /// Their bytes, in their order.
    pub bytes: Vec<usize>,
    /// SHA-256 of each, in hexadecimal.
    pub sha256: Vec<String>,
    /// Whether all of it was found in the cache.
    pub from_cache: bool,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// How long it took, in milliseconds.
    pub milliseconds: f64,
}

/// A part of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PartReport {
    /// Its name.
    pub name: String,
    /// What it is made from: band, rect, extrude, strip, plate or model.
    pub kind: String,
    /// Shells of one copy.
    pub shells: usize,
    /// The total genus of one copy.
    pub genus: usize,
    /// The volume of one copy as it was made, in cubic millimetres.
    pub volume_mm3: f64,
    /// The copies.
    pub copies: Vec<CopyReport>,
    /// Whether it was found in the cache.
    pub from_cache: bool,
    /// The report of the command that makes such a part; null where there is none.
    pub report: Value,
}

/// A copy of a part in its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CopyReport {
    /// Its name: that of the part, with a number if there are several.
    pub name: String,
    /// The least and the greatest coordinates in millimetres.
    pub bounds_mm: [[f64; 3]; 2],
}

impl SceneReport {
    /// The report as indented JSON.
    pub fn to_json(&self) -> String {
        json::indented(self)
    }
}
