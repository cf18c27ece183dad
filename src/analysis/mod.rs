//! What Openwork sees in an exemplar: events, cuts, pieces and how they are connected.
//!
//! An [`Analysis`] is the work of `reeb` and `pieces` in numbers that a person or a program can read, before
//! anything is synthesized: as JSON (it serializes), as a table for a terminal (it displays) and as a picture
//! ([`Analysis::overlay_svg`], [`Analysis::overlay_png`]). It is for finding out why a band comes out as it
//! does: which places can be cut, which cannot and why, and what may follow what.
//!
//! Excluded: sequences, and so every question of which topology can be reached.

mod lettering;
mod overlay;
mod table;

use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

use crate::exemplar::Exemplar;
use crate::pieces::{Catalogue, CostWeights, CostWeightsError, Piece};
use crate::planar::{Region, Tolerances};
use crate::reeb::{Cut, KeptRange, ReebGraph, Slicing, SlicingError, SlicingRule, persistence::persistence};

/// The version of the JSON form; it changes when a field is renamed, removed or gets another meaning.
pub const SCHEMA_VERSION: u32 = 1;

/// What an exemplar consists of. Lengths are millimetres from the lower left corner of the ink's bounding box,
/// x to the right and y up, rounded to a nanometre.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Analysis {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// The exemplar's name.
    pub name: String,
    /// The SHA-256 of the exemplar's file.
    pub sha256: String,
    /// Width and height of the ink.
    pub size_mm: [f64; 2],
    /// Connected components of the ink.
    pub components: usize,
    /// Holes in the ink.
    pub holes: usize,
    /// The area of the ink.
    pub area_mm2: f64,
    /// How cuts were looked for.
    pub slicing: SlicingUsed,
    /// Where strands begin, end, split and merge, from left to right.
    pub critical_points: Vec<CriticalPointFound>,
    /// Ranges that no cut may divide, from the left end of the ink, as they were asked for.
    pub kept_mm: Vec<[f64; 2]>,
    /// The cuts, from left to right.
    pub cuts: Vec<CutFound>,
    /// Cuts that were left out as they pass through ink thinner than the minimum feature.
    pub dropped_cuts: Vec<CutLeftOut>,
    /// The pieces, from left to right.
    pub pieces: Vec<PieceFound>,
    /// What is worth knowing about the drawing, one sentence each.
    pub notes: Vec<String>,
    /// The ink, for the picture.
    #[serde(skip)]
    region: Region,
}

/// The rule by which an exemplar was cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "rule", rename_all = "lowercase")]
pub enum SlicingUsed {
    /// Between neighbouring events.
    Reeb {
        /// Events of less persistence, and distances below it, make no cut.
        persistence_mm: f64,
    },
    /// Equally spaced.
    Uniform {
        /// The number of lines.
        lines: usize,
    },
}

/// An event of the Reeb graph.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CriticalPointFound {
    /// begin, end, split or merge.
    pub event: &'static str,
    /// From the left end of the ink.
    pub x_mm: f64,
    /// From the bottom of the ink.
    pub y_mm: f64,
    /// The distance in x to the event that it cancels with; `None` when it cancels with nothing.
    pub persistence_mm: Option<f64>,
    /// Whether it is large enough for a cut beside it.
    pub makes_cuts: bool,
}

/// A cut.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CutFound {
    /// From the left end of the ink.
    pub x_mm: f64,
    /// The number of portals; 0 where the line meets no ink.
    pub portals: usize,
    /// The height of the narrowest portal; `None` without portals.
    pub narrowest_portal_mm: Option<f64>,
    /// How squarely the contours cross at worst: the cosine of the steepest slope, 1 for all level, `None`
    /// without portals.
    pub squareness: Option<f64>,
    /// Heights of the portal endpoints from the bottom of the ink, top to bottom; portal j lies between 2j and
    /// 2j + 1.
    pub endpoints_mm: Vec<f64>,
}

/// A cut that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CutLeftOut {
    /// Where it would have been, from the left end of the ink.
    pub x_mm: f64,
    /// The height of its narrowest portal.
    pub narrowest_portal_mm: f64,
}

/// A piece.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PieceFound {
    /// Its number, from 0, as in the sequences of other reports.
    pub index: usize,
    /// Where it begins, from the left end of the ink; the first one begins before it, by the blank that keeps
    /// apart what is joined at the ends of the exemplar.
    pub x_mm: f64,
    /// Its width.
    pub width_mm: f64,
    /// How its portals are connected inside it.
    pub descriptor: DescriptorFound,
    /// The pieces that were kept as its successors.
    pub successors: usize,
    /// What it costs to follow with the exemplar's own next piece; `None` for the last one.
    pub natural_cost: Option<f64>,
    /// What the cheapest jump costs; `None` when no other piece fits.
    pub jump_cost: Option<f64>,
}

/// The descriptor of a piece.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct DescriptorFound {
    /// The component of each portal on the left, top to bottom.
    pub left: Vec<u16>,
    /// The component of each portal on the right, top to bottom, by the same numbers.
    pub right: Vec<u16>,
    /// Components that reach no portal.
    pub closed: u32,
    /// The Euler characteristic.
    pub euler: i64,
    /// Holes inside the piece.
    pub holes: u32,
}

/// Why an exemplar cannot be analysed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AnalysisError {
    /// It cannot be cut.
    #[error(transparent)]
    Slicing(#[from] SlicingError),
    /// A weight is out of range.
    #[error(transparent)]
    Weights(#[from] CostWeightsError),
}

impl Analysis {
    /// Cuts `exemplar` by `rule`, or by events with the default threshold, and weighs the joins of its pieces.
    ///
    /// # Errors
    /// [`AnalysisError`] for parameters out of range, and when the minimum feature leaves no cut.
    pub fn new(
        exemplar: &Exemplar,
        rule: Option<SlicingRule>,
        tolerances: &Tolerances,
        weights: &CostWeights,
    ) -> Result<Self, AnalysisError> {
        Self::keeping(exemplar, rule, &[], tolerances, weights)
    }

    /// As [`Self::new`], without a cut inside the ranges of `kept`.
    ///
    /// # Errors
    /// [`AnalysisError`] for parameters and ranges out of range, and when the minimum feature or the ranges leave
    /// no cut.
    pub fn keeping(
        exemplar: &Exemplar,
        rule: Option<SlicingRule>,
        kept: &[KeptRange],
        tolerances: &Tolerances,
        weights: &CostWeights,
    ) -> Result<Self, AnalysisError> {
        weights.validate()?;
        // What a band leaves out as well.
        let (region, specks) = exemplar.region().without_specks(tolerances.chord_mm().powi(2));
        let region = &region;
        let mut notes = exemplar.notes().to_vec();
        if !specks.is_empty() {
            notes.push(format!("{} speck(s) too small for the chord error are left out", specks.len()));
        }
        let (low, high) = region.bounds_mm().unwrap_or_default();
        let rule = rule.unwrap_or_else(|| SlicingRule::reeb_for_width(high.x - low.x));
        let reeb = ReebGraph::new(region);
        let Slicing { cuts, dropped, .. } = Slicing::keeping(region, &reeb, rule, kept, tolerances)?;
        let catalogue = Catalogue::new(region, &cuts, weights);
        let slicing = match rule {
            SlicingRule::Reeb { persistence_mm } => SlicingUsed::Reeb { persistence_mm },
            SlicingRule::Uniform { lines } => SlicingUsed::Uniform { lines },
        };
        let dropped = dropped
            .iter()
            .map(|d| CutLeftOut { x_mm: rounded(d.x_mm), narrowest_portal_mm: rounded(d.portal_mm) });
        let pieces = catalogue.pieces().iter().enumerate();
        Ok(Self {
            schema_version: SCHEMA_VERSION,
            name: exemplar.name().to_owned(),
            sha256: exemplar.sha256().to_owned(),
            size_mm: (high - low).to_array().map(rounded),
            components: region.components(),
            holes: region.holes(),
            area_mm2: rounded(region.area_mm2()),
            slicing,
            critical_points: critical_points(region, &reeb, slicing),
            kept_mm: kept.iter().map(|k| [rounded(k.from_mm), rounded(k.to_mm)]).collect(),
            cuts: cuts.iter().map(|cut| CutFound::new(region, cut)).collect(),
            dropped_cuts: dropped.collect(),
            pieces: pieces.map(|(i, piece)| PieceFound::new(&catalogue, i, piece)).collect(),
            notes,
            region: region.clone(),
        })
    }

    /// A picture for a person to look at, as an SVG document: the ink with its cuts, the portals coloured by
    /// component on either side of a cut, the critical points and the numbers of the pieces.
    pub fn overlay_svg(&self) -> String {
        overlay::svg(self)
    }

    /// The picture of [`Self::overlay_svg`] as a PNG of `longer_side` pixels.
    ///
    /// # Errors
    /// [`ExportError`](crate::export::ExportError) for a size that no picture can have.
    pub fn overlay_png(&self, longer_side: u32) -> Result<Vec<u8>, crate::export::ExportError> {
        overlay::png(self, longer_side)
    }
}

/// A length to the nanometre: what is finer is noise of the grid and makes reports hard to read.
fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}

fn critical_points(region: &Region, reeb: &ReebGraph, slicing: SlicingUsed) -> Vec<CriticalPointFound> {
    let (low, _) = region.bounds_mm().unwrap_or_default();
    let grid = region.grid();
    let spans = persistence(reeb);
    let points = reeb.points().zip(&spans);
    points
        .map(|((_, point), &span)| {
            let at = grid.to_mm(point.at) - low;
            let large = |threshold_mm| span.is_none_or(|s| s >= grid.steps(threshold_mm).max(1));
            CriticalPointFound {
                event: point.event.name(),
                x_mm: rounded(at.x),
                y_mm: rounded(at.y),
                persistence_mm: span.map(|s| rounded(grid.mm(s))),
                makes_cuts: matches!(slicing, SlicingUsed::Reeb { persistence_mm } if large(persistence_mm)),
            }
        })
        .collect()
}

impl CutFound {
    fn new(region: &Region, cut: &Cut) -> Self {
        let (low, _) = region.bounds_mm().unwrap_or_default();
        let squareness = cut.crossings.iter().map(|c| c.tangent.x).reduce(f64::min);
        Self {
            x_mm: rounded(region.grid().mm(cut.x) - low.x),
            portals: cut.portals(),
            narrowest_portal_mm: squareness.map(|_| rounded(cut.narrowest_portal_mm())),
            squareness: squareness.map(rounded),
            endpoints_mm: cut.crossings.iter().map(|c| rounded(c.y_mm - low.y)).collect(),
        }
    }
}

impl PieceFound {
    fn new(catalogue: &Catalogue, index: usize, piece: &Piece) -> Self {
        let joins = &catalogue.joins()[index];
        let descriptor = &piece.descriptor;
        Self {
            index,
            x_mm: rounded(piece.x_mm - catalogue.pieces()[0].blanks_mm().0),
            width_mm: rounded(piece.width_mm),
            descriptor: DescriptorFound {
                left: descriptor.left().to_vec(),
                right: descriptor.right().to_vec(),
                closed: descriptor.closed(),
                euler: descriptor.euler(),
                holes: descriptor.holes(),
            },
            successors: joins.len(),
            natural_cost: joins.iter().find(|j| j.is_natural).map(|j| rounded(j.cost)),
            jump_cost: joins.iter().find(|j| !j.is_natural).map(|j| rounded(j.cost)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exemplar::ReadOptions;

    /// A bar with an eye, and an island after it.
    const DRAWING: &[u8] = br#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 20" width="60mm" height="20mm">
        <path fill-rule="evenodd" d="M0 5H40V15H0Z M10 10L20 7L30 10L20 13Z"/><path d="M46 4h10v12h-10z"/></svg>"#;

    pub(super) fn analysis(rule: Option<SlicingRule>) -> Analysis {
        let exemplar = Exemplar::from_svg("eye", DRAWING, &ReadOptions::default()).unwrap();
        Analysis::new(&exemplar, rule, &Tolerances::default(), &CostWeights::default()).unwrap()
    }

    #[test]
    fn events_cuts_and_pieces_are_those_of_the_drawing() {
        let found = analysis(None);
        assert_eq!((found.components, found.holes), (2, 1));
        // The SVG library's coordinates have 24 bits.
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5;
        assert!(near(found.size_mm[0], 56.0) && near(found.size_mm[1], 12.0), "{:?}", found.size_mm);
        let events: Vec<_> = found.critical_points.iter().map(|p| (p.event, p.x_mm.round())).collect();
        let wanted = [("begin", 0.0), ("split", 10.0), ("merge", 30.0), ("end", 40.0), ("begin", 46.0)];
        assert_eq!(events[..5], wanted);
        assert!(found.critical_points.iter().all(|p| p.makes_cuts));
        assert_eq!(found.cuts.iter().map(|c| c.portals).collect::<Vec<_>>(), [1, 2, 2, 2, 1, 0, 1]);
        assert_eq!(found.cuts[5].narrowest_portal_mm, None);
        let ends = &found.cuts[0].endpoints_mm;
        assert!(ends.len() == 2 && near(ends[0], 11.0) && near(ends[1], 1.0), "{ends:?}");
        let middle = &found.pieces[1].descriptor;
        assert_eq!((middle.left.as_slice(), middle.right.as_slice()), ([0].as_slice(), [0, 0].as_slice()));
        assert_eq!((middle.closed, middle.euler, middle.holes), (0, 1, 0));
    }

    #[test]
    fn json_has_numbers_where_there_are_numbers() {
        let json = serde_json::to_value(analysis(Some(SlicingRule::Uniform { lines: 4 }))).unwrap();
        assert_eq!(json["schema_version"], 1);
        assert_eq!(json["slicing"]["rule"], "uniform");
        assert_eq!(json["pieces"].as_array().unwrap().len(), 5);
        assert_eq!(json["cuts"][3]["narrowest_portal_mm"], serde_json::Value::Null);
        assert_eq!(json["critical_points"][0]["makes_cuts"], false);
        assert!(json.get("region").is_none());
    }

    #[test]
    fn what_cannot_be_cut_is_told() {
        let exemplar = Exemplar::from_svg("eye", DRAWING, &ReadOptions::default()).unwrap();
        let tolerances = Tolerances::default();
        let weights = CostWeights { alpha: 2.0, ..CostWeights::default() };
        let refused = Analysis::new(&exemplar, None, &tolerances, &weights).unwrap_err();
        assert_eq!(refused.to_string(), "alpha is 2; it must be from 0 to 1");
        let rule = Some(SlicingRule::Uniform { lines: 0 });
        let refused = Analysis::new(&exemplar, rule, &tolerances, &CostWeights::default()).unwrap_err();
        assert!(refused.to_string().contains("uniform is 0"), "{refused}");
    }
}
