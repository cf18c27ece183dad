//! What a machine asks for, as it is typed: `--process`, `--processes`, `--enforce`, `--material`.
//!
//! There is one order, and the last wins: the process that is built in, the file of processes, options of their own.

use std::path::PathBuf;

use clap::Args;

use super::args::ToleranceArguments;
use super::run::CliError;
use super::values;
use crate::job::{JobError, LayerColours, Material, Process, Workshop};
use crate::planar::Tolerances;

/// The thickness of a solid when neither an option nor a process says one, in millimetres.
const THICKNESS_MM: f64 = 2.0;

#[derive(Debug, Clone, Args)]
pub(super) struct MakeArgs {
    /// The machine: fdm-0.4, fdm-0.2, resin, laser-ply-3mm, laser-acrylic-3mm, waterjet, or one of --processes. Says
    /// --min-feature, --min-gap, --chord, --thickness and, for cut lines, --kerf where these are not given, and
    /// the colours of lines that are cut and engraved
    #[arg(long, value_name = "NAME")]
    process: Option<String>,
    /// More processes and materials, or other numbers for those that are built in (TOML)
    #[arg(long, value_name = "FILE.toml")]
    processes: Option<PathBuf>,
    /// Thicken ink below the minimum feature and widen gaps below the minimum gap, and nothing else. Not with --tile, whose copies
    /// would not match: enforce the exemplar with openwork extrude first
    #[arg(long)]
    pub(super) enforce: bool,
    /// The material, for the mass in the report: pla, petg, abs, resin, birch-ply, mdf, acrylic, silver-925, brass, steel,
    /// stainless, aluminium, or one of --processes
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Thickness of the solid [default: that of the process, or 2mm]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    thickness: Option<f64>,
}

/// What came of it.
#[derive(Debug, Clone)]
pub(super) struct Made {
    pub(super) min_feature_mm: f64,
    pub(super) min_gap_mm: f64,
    pub(super) chord_mm: f64,
    pub(super) thickness_mm: f64,
    /// Of the process, if it cuts.
    pub(super) kerf_mm: Option<f64>,
    /// Of the process, or the usual ones.
    pub(super) colours: LayerColours,
    pub(super) material: Option<Material>,
}

impl MakeArgs {
    /// Whether a thickness was typed.
    pub(super) fn has_thickness(&self) -> bool {
        self.thickness.is_some()
    }

    /// All numbers, from the process and the options.
    pub(super) fn made(&self, tolerances: &ToleranceArguments) -> Result<Made, CliError> {
        let workshop = self.workshop()?;
        let refused = |option: &'static str, error: &dyn std::fmt::Display| {
            let wanted = "docs/processes.md lists those that are built in, and how to add others".to_owned();
            JobError::Option { option, found: error.to_string(), wanted }
        };
        let process = self.process.as_deref().map(|name| workshop.process(name)).transpose();
        let process = process.map_err(|error| refused("--process", &error))?;
        let material = self.material.as_deref().map(|name| workshop.material(name)).transpose();
        let material = material.map_err(|error| refused("--material", &error))?;
        let or = |given: Option<f64>, of: fn(&Process) -> f64, otherwise: f64| {
            given.or(process.map(of)).unwrap_or(otherwise)
        };
        Ok(Made {
            min_feature_mm: or(tolerances.min_feature, |p| p.min_feature_mm, 0.0),
            min_gap_mm: or(tolerances.min_gap, |p| p.min_gap_mm, 0.0),
            chord_mm: or(tolerances.chord, |p| p.chord_mm, Tolerances::DEFAULT_CHORD_MM),
            thickness_mm: or(self.thickness, |p| p.thickness_mm, THICKNESS_MM),
            kerf_mm: process.map(|p| p.kerf_mm).filter(|&kerf_mm| kerf_mm > 0.0),
            colours: process.map_or_else(LayerColours::default, |p| LayerColours {
                cut: p.cut_colour,
                engrave: p.engrave_colour,
            }),
            material: material.cloned(),
        })
    }

    fn workshop(&self) -> Result<Workshop, CliError> {
        let Some(path) = &self.processes else { return Ok(Workshop::default()) };
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|error| CliError::Unreadable { file: file.clone(), error })?;
        let workshop = Workshop::with_file(&text);
        Ok(workshop.map_err(|error| JobError::Option {
            option: "--processes",
            found: format!("{file}, {error}"),
            wanted: "docs/processes.md shows how it is written".to_owned(),
        })?)
    }
}
