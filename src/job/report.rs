//! The report of a band, as JSON.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::bridging::BridgesReport;
use super::certificate::{Certificate, sha256};
use super::json;
use super::laser::LaserReport;
use super::making::{EnforcedReport, Quantities};
use super::ways::WayReport;
use crate::domain::Squeeze;
use crate::solver::Tally;
use crate::verify::{NarrowPlaces, Narrowest};

/// An input file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InputReport {
    /// The name as it was given.
    pub file: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl InputReport {
    /// That of a file, which was read before.
    pub(super) fn of(file: &Path) -> Self {
        Self { file: file.display().to_string(), sha256: sha256(&std::fs::read(file).unwrap_or_default()) }
    }
}

/// The seams of a band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SeamReport {
    /// The number of seams.
    pub count: usize,
    /// Of them, seams between pieces that are not neighbours in the exemplar.
    pub jumps: usize,
    /// The greatest angle between contours at a seam as cut, in degrees.
    pub worst_angle_before_deg: f64,
    /// The greatest turn of a contour at a seam after fitting, in degrees.
    pub worst_angle_after_deg: f64,
}

/// A cut that was left out, as its narrowest portal is under the minimum feature (Zhou 2014 §5.2.1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DroppedCutReport {
    /// Where it would have been, from the left edge of the exemplar at the size that it has in the band.
    pub x_mm: f64,
    /// The height of its narrowest portal.
    pub portal_mm: f64,
}

/// How pieces were bent to meet.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StitchReport {
    /// `warp` or `lri`: what the band was made with.
    pub method: String,
    /// Pieces that `lri` would have broken, and that were warped instead.
    pub fallbacks: Vec<FallbackReport>,
    /// The seams beside such pieces, by their number from 0 along the band.
    pub fallback_seams: Vec<usize>,
}

/// A piece that was warped instead.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FallbackReport {
    /// Its place in the sequence, from 0.
    pub place: usize,
    /// Its number in the exemplar, from 0.
    pub piece: usize,
    /// What would have been wrong.
    pub fault: String,
}

/// What was asked of a band on a model.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SurfaceReport {
    /// `band`, `emboss` or `carve`.
    pub mode: &'static str,
    /// Where the curve goes: `around 50%`, `through 5 points`, or `along` a file.
    pub route: String,
    /// The wall that the model was given, in millimetres.
    pub shell_mm: Option<f64>,
    /// How deep it was carved, in millimetres, if not through.
    pub depth_mm: Option<f64>,
    /// How far points could be off the model, in millimetres.
    pub tolerance_mm: f64,
}

/// The drawing of a band in space: the pattern laid flat.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FlatPattern {
    /// The components of the drawing.
    pub components: usize,
    /// Its holes.
    pub holes: usize,
    /// Whether its left and right sides are the same place, where a closed band was cut open.
    pub is_joined: bool,
    /// Where along the curve it was cut, in millimetres.
    pub cut_mm: Option<f64>,
    /// The least and the greatest factor by which lengths along the band are multiplied in space, on its back or front.
    pub scales: [f64; 2],
}

/// How long a stage took. Solids are made and read again while the drawing is, so stages may add up to more than the whole.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct StageTime {
    /// The stage.
    pub stage: &'static str,
    /// Wall clock.
    pub milliseconds: f64,
}

/// Why a report has no number of sequences.
pub(super) const NOT_COUNTED: &str =
    "not counted: bands are counted whose sequences meet what was asked for without bridges";

/// What was asked for, what was made, and what was found in the files. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BandReport {
    /// The version of this structure; it changes when a field changes its meaning or goes.
    pub schema_version: u32,
    /// The program and its version.
    pub generator: &'static str,
    /// The exemplar.
    pub exemplar: InputReport,
    /// The curve as it was given.
    pub along: String,
    /// What was asked of a band on a model; null for one that lies on none.
    pub surface: Option<SurfaceReport>,
    /// The file of the curve, if it is in one.
    pub curve: Option<InputReport>,
    /// The seed, if one was given.
    pub seed: Option<u64>,
    /// With a seed: whether the sequence was drawn from all that meet the constraints with its exact probability;
    /// where they are too many, every jump costs a random part more instead.
    pub drawn_exactly: Option<bool>,
    /// The decimal logarithm of the number of sequences that meet the constraints within the accepted lengths, where
    /// they were counted. A ring counts once for each narrowest cut at which it can be opened.
    pub log10_sequences: Option<f64>,
    /// That of a number that is not greater; the same where they were counted.
    pub log10_sequences_at_least: Option<f64>,
    /// That of a number that is not less; the same where they were counted.
    pub log10_sequences_at_most: Option<f64>,
    /// Which of the three it is, and why.
    pub sequences: &'static str,
    /// The most pieces in a row that occur twice, shown the same way, without overlapping.
    pub longest_repeat: usize,
    /// How evenly the exemplar's pieces are used: the entropy of their frequencies as a part of the greatest, 0 to 1;
    /// a mirrored piece counts as the piece.
    pub evenness: f64,
    /// The least and the greatest number of components that were asked for.
    pub wanted_components: Option<[u32; 2]>,
    /// The least and the greatest number of holes that were asked for.
    pub wanted_holes: Option<[u32; 2]>,
    /// Whether a closed pattern was asked for.
    pub wanted_closed_pattern: bool,
    /// Components of the written files.
    pub components: usize,
    /// Holes of the written files; the inside of a closed ring is one.
    pub holes: usize,
    /// Whether some component goes all the way round.
    pub closed_pattern: bool,
    /// The arc length of the curve.
    pub length_mm: f64,
    /// The height of the band.
    pub width_mm: f64,
    /// The thickness of the solid.
    pub thickness_mm: f64,
    /// The greatest distance between a curve and what stands for it.
    pub chord_mm: f64,
    /// Pieces of the exemplar.
    pub pieces_in_exemplar: usize,
    /// Pieces of the band.
    pub pieces_in_result: usize,
    /// Whether pieces may be used left for right.
    pub mirror: bool,
    /// Pieces of the band that are.
    pub mirrored_pieces_in_result: usize,
    /// Ranges of the exemplar that were not cut, from its left edge at the size that it has in the band.
    pub kept_mm: Vec<[f64; 2]>,
    /// Cuts left out because of the minimum feature.
    pub dropped_cuts: Vec<DroppedCutReport>,
    /// The pieces of the band in order, by their number in the exemplar from 0; n + i is piece i of n, mirrored.
    pub sequence: Vec<usize>,
    /// The cost of the sequence (Zhou 2014 §3.6.1, with jumps and rises).
    pub cost: f64,
    /// Of the cheapest bands, as `--best` lists them, which this is, from 1; null when these were not asked for.
    pub rank: Option<usize>,
    /// Whether no cheaper sequence meets the constraints; null when a seed or variety was asked for.
    pub optimal: Option<bool>,
    /// How much less another sequence could cost at most. With `rank`, exactly what it costs more than the first.
    pub cost_gap: Option<f64>,
    /// The autocorrelation of the sequence (Zhou 2014 §3.7), when variety was asked for; a mirrored piece counts as
    /// the piece.
    pub autocorrelation: Option<f64>,
    /// How many successors of each piece were considered.
    pub successors: usize,
    /// The part of the length by which sequences were allowed to miss it before stretching.
    pub epsilon: f64,
    /// The length of the sequence less the length of the curve, before stretching.
    pub length_error_mm: f64,
    /// What heights were multiplied by so that the band fits its width.
    pub squash: f64,
    /// Where the curve bends so hard that the inner side is squeezed.
    pub squeezes: Vec<Squeeze>,
    /// The bridges, when the ornament alone could not give what was asked for; then `components`, `holes` and
    /// the files are with them.
    pub bridges: Option<BridgesReport>,
    /// Of a band in space, its drawing.
    pub flat: Option<FlatPattern>,
    /// Where bridges were allowed: the sequences that were weighed against each other, the best first.
    pub weighed: Vec<WayReport>,
    /// The picture of all bands that were written together, with their numbers, if there is one.
    pub contact_sheet: Option<String>,
    /// The seams.
    pub seams: SeamReport,
    /// How the pieces were bent to meet at the seams.
    pub stitching: StitchReport,
    /// Partial runs that the search made.
    pub search_labels: usize,
    /// States of the automaton that it met.
    pub search_states: usize,
    /// What was made of it, and what was found in the files.
    #[serde(flatten)]
    pub made: MadeReport,
}

/// The part and its files, in a report. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MadeReport {
    /// The narrowest ink, measured on the result.
    pub min_feature: Option<Narrowest>,
    /// The narrowest gap, measured on the result.
    pub min_gap: Option<Narrowest>,
    /// The ten narrowest places of ink and of gaps, measured on the result.
    pub narrow_places: NarrowPlaces,
    /// What was thickened and widened; null when it was not asked for, or nothing was lacking.
    pub enforced: Option<EnforcedReport>,
    /// What costs money.
    pub quantities: Option<Quantities>,
    /// Bytes of the files, in their order.
    pub bytes: Vec<usize>,
    /// Ink of the part in square millimetres.
    pub area_mm2: f64,
    /// Width and height of the page.
    pub page_mm: [f64; 2],
    /// Vertices of the part's outline.
    pub vertices: usize,
    /// Straight segments and cubics in the SVG, if one was written.
    pub svg_segments: Option<[usize; 2]>,
    /// The files of cut lines, if some were written.
    pub laser: Option<LaserReport>,
    /// Facets of the STL, if one was written.
    pub triangles: Option<usize>,
    /// Shells of the STL.
    pub shells: Option<usize>,
    /// Total genus of the STL.
    pub genus: Option<i64>,
    /// Volume of the STL in cubic millimetres.
    pub volume_mm3: Option<f64>,
    /// The files that were written.
    pub files: Vec<String>,
    /// What proves the counts without trusting the search; of a rectangle, that of its second pass, whose pieces are rows.
    pub certificate: Certificate,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// Time per stage.
    pub times: Vec<StageTime>,
}

impl BandReport {
    /// Says how many sequences there are.
    pub(super) fn tell_number(&mut self, tally: Option<Tally>) {
        let log10 = |ln: f64| Some(ln / std::f64::consts::LN_10).filter(|log| log.is_finite());
        self.log10_sequences_at_least = tally.and_then(|tally| log10(tally.ln_at_least));
        self.log10_sequences_at_most = tally.and_then(|tally| log10(tally.ln_at_most));
        self.log10_sequences = tally.and_then(|tally| tally.ln_counted()).and_then(log10);
        self.sequences = match tally {
            None => NOT_COUNTED,
            Some(tally) if tally.ln_counted().is_some() => "counted",
            Some(_) => "bounded: counting them would take too long",
        };
    }

    /// The report as indented JSON, arrays on one line, ending in a line break.
    pub fn to_json(&self) -> String {
        json::indented(self)
    }
}
