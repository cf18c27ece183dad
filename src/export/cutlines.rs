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
use super::layer::{Layer, LayerColours};
use super::order::ordered;
use super::outline::Outline;
use super::outlines::{Curves, outlines};
use crate::planar::Region;

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
    pub(super) colours: LayerColours,
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
        let (decimals, colours) = (decimals.unwrap_or(0), LayerColours::default());
        Ok(Self { paths, bounds_mm, decimals, colours, chord_mm })
    }

    /// The same lines in other colours.
    pub fn with_colours(self, colours: LayerColours) -> Self {
        Self { colours, ..self }
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
