//! The report of a rectangle, as JSON.

use schemars::JsonSchema;
use serde::Serialize;

use super::bridging::BridgesReport;

use super::band::Band;
use super::builder::BandJob;
use super::error::JobError;
use super::json;
use super::rect_rows::Way;
use super::report::{
    BandReport, DroppedCutReport, FlatPattern, InputReport, MadeReport, SeamReport, StitchReport,
};
use crate::topology::Wanted;
use crate::verify::Tiling;

/// One of the two passes of a rectangle. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DirectionReport {
    /// How long the run is: the rectangle's width in the first pass, its height in the second.
    pub length_mm: f64,
    /// How far the run reaches across: the height of the strip, the width of the rectangle.
    pub across_mm: f64,
    /// Components and holes of what the pass made.
    pub components: usize,
    /// See `components`.
    pub holes: usize,
    /// Where the exemplar of the pass was cut, from its left on the grid that it was read on.
    pub cuts_mm: Vec<f64>,
    /// Cuts left out because of the minimum feature.
    pub dropped_cuts: Vec<DroppedCutReport>,
    /// Pieces of the exemplar of the pass.
    pub pieces_in_exemplar: usize,
    /// Pieces of the run.
    pub pieces_in_result: usize,
    /// Pieces of the run that are used left for right, in the second pass upside down.
    pub mirrored_pieces_in_result: usize,
    /// The pieces in order, by their number from 0; n + i is piece i of n, mirrored. In the second pass they are
    /// rows, from the top.
    pub sequence: Vec<usize>,
    /// The cost of the sequence (Zhou 2014 §3.6.1, with jumps and rises).
    pub cost: f64,
    /// Whether no cheaper sequence meets the constraints; null when a seed or variety was asked for.
    pub optimal: Option<bool>,
    /// How much less another sequence could cost at most.
    pub cost_gap: Option<f64>,
    /// How many successors of each piece were considered.
    pub successors: usize,
    /// The part of the length by which sequences were allowed to miss it before stretching.
    pub epsilon: f64,
    /// The length of the sequence less that of the run, before stretching.
    pub length_error_mm: f64,
    /// What measures across were multiplied by so that the ink fills the rectangle.
    pub squash: f64,
    /// The seams.
    pub seams: SeamReport,
    /// How the pieces were bent to meet at the seams.
    pub stitching: StitchReport,
    /// Partial runs that the search made.
    pub search_labels: usize,
    /// States of the automaton that it met.
    pub search_states: usize,
}

impl DirectionReport {
    pub(super) fn new(band: &BandReport, across_mm: f64, cuts_mm: Vec<f64>) -> Self {
        Self {
            length_mm: band.length_mm,
            across_mm,
            components: band.components,
            holes: band.holes,
            cuts_mm,
            dropped_cuts: band.dropped_cuts.clone(),
            pieces_in_exemplar: band.pieces_in_exemplar,
            pieces_in_result: band.pieces_in_result,
            mirrored_pieces_in_result: band.mirrored_pieces_in_result,
            sequence: band.sequence.clone(),
            cost: band.cost,
            optimal: band.optimal,
            cost_gap: band.cost_gap,
            successors: band.successors,
            epsilon: band.epsilon,
            length_error_mm: band.length_error_mm,
            squash: band.squash,
            seams: band.seams,
            stitching: band.stitching.clone(),
            search_labels: band.search_labels,
            search_states: band.search_states,
        }
    }
}

/// A way of making a rectangle that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Attempt {
    /// The height of the strip in millimetres.
    pub row_mm: f64,
    /// The components that the strip was asked for; null if they were free.
    pub strip_components: Option<u32>,
    /// The holes that the strip was asked for; null if they were free.
    pub strip_holes: Option<u32>,
    /// The seed of the strip.
    pub strip_seed: Option<u64>,
    /// The greatest misfit that joins between rows were allowed: 1 is a strand that is joined to one beside it, by the
    /// width of the narrower, or to one twice as wide, or turns back. Null if any was, or if there was no
    /// strip.
    pub allowed_misfit: Option<f64>,
    /// The greatest misfit of the joins between rows, if there was a sequence.
    pub misfit: Option<f64>,
    /// The cost of the second pass, if it found a sequence.
    pub cost: Option<f64>,
    /// `planned`, or why it failed.
    pub outcome: String,
}

impl Attempt {
    /// The outcome of a second pass that found a sequence.
    pub(super) const PLANNED: &str = "planned";

    /// A first pass that failed.
    pub(super) fn first(job: &BandJob, outcome: String) -> Self {
        let options = &job.options;
        Self {
            row_mm: options.width_mm.unwrap_or_default(),
            strip_components: options.goal.components.map(Wanted::most),
            strip_holes: options.goal.holes.map(Wanted::most),
            strip_seed: options.seed,
            allowed_misfit: None,
            misfit: None,
            cost: None,
            outcome,
        }
    }

    /// A second pass.
    pub(super) fn second(strip: &Band, allowed_misfit: f64, way: Result<&Way, &JobError>) -> Self {
        Self {
            allowed_misfit: Some(allowed_misfit).filter(|m| m.is_finite()),
            misfit: way.ok().map(|way| way.misfit),
            cost: way.ok().map(|way| way.plan.cost),
            ..Self::first(&strip.job, way.err().map_or_else(|| Self::PLANNED.to_owned(), ToString::to_string))
        }
    }
}

/// What was asked for, what was made, and what was found in the files. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RectReport {
    /// The version of this structure; it changes when a field changes its meaning or goes.
    pub schema_version: u32,
    /// The program and its version.
    pub generator: &'static str,
    /// The exemplar.
    pub exemplar: InputReport,
    /// Width and height of the rectangle, which the ink fills.
    pub size_mm: [f64; 2],
    /// The seed, if one was given.
    pub seed: Option<u64>,
    /// The least and the greatest number of components that were asked for.
    pub wanted_components: Option<[u32; 2]>,
    /// The least and the greatest number of holes that were asked for.
    pub wanted_holes: Option<[u32; 2]>,
    /// Components of the written files.
    pub components: usize,
    /// Holes of the written files.
    pub holes: usize,
    /// Whether pieces may be used left for right.
    pub mirror: bool,
    /// Ranges of the exemplar that were not cut, from its left edge at the size that it has in the rows.
    pub kept_mm: Vec<[f64; 2]>,
    /// The thickness of the solid.
    pub thickness_mm: f64,
    /// The greatest distance between a curve and what stands for it.
    pub chord_mm: f64,
    /// The first pass: the strip along u.
    pub along_u: DirectionReport,
    /// The second pass: rows of the strip along v, downwards.
    pub along_v: DirectionReport,
    /// The tiling that copies make, counted on the drawing; null when no tile was asked for.
    pub tiling: Option<Tiling>,
    /// What the drawing is of a rectangle that does not lie flat; null for one that does.
    pub flat: Option<FlatPattern>,
    /// The bridges, when the ornament alone could not give what was asked for; then the counts are with them.
    pub bridges: Option<BridgesReport>,
    /// The ways that were tried, in order.
    pub attempts: Vec<Attempt>,
    /// The one that was chosen, counted from 0.
    pub chosen_attempt: usize,
    /// What was made of it, and what was found in the files.
    #[serde(flatten)]
    pub made: MadeReport,
}

impl RectReport {
    /// The report as indented JSON, arrays on one line, ending in a line break.
    pub fn to_json(&self) -> String {
        json::indented(self)
    }
}
