//! What a cutter follows: closed paths of lines and curves on layers, in the order of cutting.
//!
//! The paths are the contours of regions, each once, so that no line is cut twice, within the chord error and with
//! the regions' components and holes ([`super::outlines`]). Engraving comes first, as the plate is still whole; then
//! cuts, inner contours before outer ones ([`super::order`]). Excluded: power and speed, which belong to the machine,
//! and the kerf, which the regions have already.

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::ExportError;
use super::curves::Rounding;
use super::order::ordered;
use super::outline::Outline;
use super::outlines::{Curves, outlines};
use crate::planar::Region;

/// What is to be done along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// Only the surface is marked.
    Engrave,
    /// The beam goes through.
    Cut,
    /// Nothing: the outline of the plate, to lay the part out by.
    Sheet,
}

impl Layer {
    /// All, in the order in which they are worked.
    pub const ALL: [Self; 3] = [Self::Engrave, Self::Cut, Self::Sheet];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Engrave => "ENGRAVE",
            Self::Cut => "CUT",
            Self::Sheet => "SHEET",
        }
    }

    /// Its colour as red, green and blue: those that most laser programs take for cutting (red) and engraving (blue).
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Self::Engrave => [0, 0, 255],
            Self::Cut => [255, 0, 0],
            Self::Sheet => [128, 128, 128],
        }
    }

    /// The same as a number of the AutoCAD colour index.
    pub(super) fn colour_index(self) -> u8 {
        match self {
            Self::Engrave => 5,
            Self::Cut => 1,
            Self::Sheet => 8,
        }
    }
}

/// What cutting takes, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
pub struct CutNumbers {
    /// The length of all cuts.
    pub cut_length_mm: f64,
    /// How often the beam has to pierce: once for each closed cut.
    pub pierces: usize,
    /// The length of all that is engraved.
    pub engrave_length_mm: f64,
    /// Where segments of paths on any layer meet.
    pub nodes: usize,
}

/// A closed path of a cutter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CutPath {
    pub(super) layer: Layer,
    pub(super) outline: Outline,
}

/// Closed paths on layers, in the order of cutting. Lengths are millimetres, y up.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLines {
    pub(super) paths: Vec<CutPath>,
    /// The lower left and upper right corner of all regions.
    pub(super) bounds_mm: (DVec2, DVec2),
    /// The decimals that suit the chord error.
    pub(super) decimals: i32,
    chord_mm: f64,
}

impl CutLines {
    /// The contours of `regions`, each on its layer, as `curves` within `chord_mm` of them either way.
    ///
    /// # Errors
    /// [`ExportError::Option`] for a chord that is no length, [`ExportError::Empty`] when there is nothing to cut.
    pub fn new(regions: &[(Layer, &Region)], curves: Curves, chord_mm: f64) -> Result<Self, ExportError> {
        if !(1e-6..=1e3).contains(&chord_mm) {
            let wanted = "a length from 0.000001 to 1000 mm";
            return Err(ExportError::Option { name: "chord", found: chord_mm, wanted });
        }
        let bounds = regions.iter().filter_map(|(_, region)| region.bounds_mm());
        let bounds_mm = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).ok_or(ExportError::Empty)?;
        let mut at = bounds_mm.0;
        let mut paths = Vec::new();
        for layer in Layer::ALL {
            for (_, region) in regions.iter().filter(|(of, _)| *of == layer) {
                let outlines = ordered(region, outlines(region, curves, chord_mm), &mut at);
                paths.extend(outlines.into_iter().map(|outline| CutPath { layer, outline }));
            }
        }
        let decimals = regions.iter().map(|(_, region)| Rounding::on(region.grid()).decimals(chord_mm)).max();
        Ok(Self { paths, bounds_mm, decimals: decimals.unwrap_or(0), chord_mm })
    }

    /// What cutting them takes.
    pub fn numbers(&self) -> CutNumbers {
        let mut numbers = CutNumbers::default();
        for CutPath { layer, outline } in &self.paths {
            numbers.nodes += outline.segments.len();
            let length_mm = outline.length_mm(0.1 * self.chord_mm);
            match layer {
                Layer::Engrave => numbers.engrave_length_mm += length_mm,
                Layer::Cut => {
                    numbers.cut_length_mm += length_mm;
                    numbers.pierces += 1;
                }
                Layer::Sheet => {}
            }
        }
        numbers
    }

    /// The lower left and upper right corner of what is cut, engraved or shown.
    pub fn bounds_mm(&self) -> (DVec2, DVec2) {
        self.bounds_mm
    }
}
