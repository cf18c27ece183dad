//! The second engine as a job uses it: synthesis, completion, and what is told of them.

use schemars::JsonSchema;
use serde::Serialize;

use super::FillJob;
use super::ground::Ground;
use crate::job::error::JobError;
use crate::job::stage::{Clock, Stage};
use crate::samples::{
    self, ChangeKind, CompleteError, CompleteOptions, Drawing, Element, Given, LevelReport,
};

/// The part of the chord error that strokes may spend while they are completed.
const INK_SHARE: f64 = 0.25;

/// A join or an opening that made the counts what they are. Positions are millimetres from the lower left corner of the page, y up; of a
/// band, in its strip: along the curve, and across it from its middle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChangeReport {
    /// What it is: `join` of ends along an edge that nearly was, `bridge` between components, `enclose` for a hole, `fill` of one that is
    /// too small, `open` of a hole, `part` of a component, `trim` of a twig, `leave out` of a small component.
    pub kind: &'static str,
    /// Where it begins.
    pub from_mm: [f64; 2],
    /// Where it ends.
    pub to_mm: [f64; 2],
    /// The vote of the exemplar's neighbourhoods for the edge, from 0 to 1; null where none was voted for.
    pub confidence: Option<f64>,
}

impl ChangeReport {
    fn new(change: &samples::Change) -> Self {
        let kind = match change.kind {
            ChangeKind::Join => "join",
            ChangeKind::Bridge => "bridge",
            ChangeKind::Enclose => "enclose",
            ChangeKind::Fill => "fill",
            ChangeKind::Open => "open",
            ChangeKind::Part => "part",
            ChangeKind::Trim => "trim",
            ChangeKind::LeaveOut => "leave out",
        };
        let (from_mm, to_mm) = (change.from_mm.to_array(), change.to_mm.to_array());
        Self { kind, from_mm, to_mm, confidence: change.confidence }
    }
}

/// A pattern in its area.
pub(super) struct Pattern {
    pub(super) drawing: Drawing,
    /// What it covers.
    pub(super) region: crate::planar::Region,
    pub(super) changes: Vec<ChangeReport>,
    pub(super) levels: Vec<LevelReport>,
    /// What could not be met by edges of the pattern alone.
    pub(super) lacking: Option<String>,
}

/// A pattern like `exemplar` all over the area, with what is given, completed as far as the goal can be met.
///
/// # Errors
/// [`JobError`] when there is no pattern.
pub(super) fn pattern(
    job: &FillJob,
    exemplar: &Drawing,
    ground: &Ground,
    given: &Given,
    ends_wanted: usize,
    clock: &mut Clock<'_>,
) -> Result<Pattern, JobError> {
    let constants = job.constants(exemplar);
    let synthesis = clock.time(Stage::Synthesize, || {
        samples::synthesize(exemplar, &ground.area, &constants, given, &mut |_, _| {})
    })?;
    let placed = synthesis.elements.placed.iter().map(|placed| Element {
        contours: synthesis.elements.classes[placed.class as usize].drawn(&placed.similarity),
    });
    let elements: Vec<Element> = placed.chain(given.drawing.elements.iter().cloned()).collect();
    let tolerances = &job.options.making.tolerances;
    let completing = CompleteOptions {
        chord_mm: INK_SHARE * tolerances.chord_mm(),
        min_gap_mm: tolerances.min_gap_mm(),
        stroke_mm: job.options.stroke_mm,
        frame_mm: job.options.frame_mm,
        ends_wanted: Some(ends_wanted),
        ..CompleteOptions::default()
    };
    let completed = clock.time(Stage::Complete, || {
        samples::complete(
            &synthesis.graph,
            &elements,
            &ground.area,
            &constants,
            &job.options.goal,
            &completing,
        )
    });
    let (completed, lacking) = match completed {
        Ok(completed) => (completed, None),
        Err(error @ CompleteError::NotMet { .. }) => {
            let lacking = error.to_string();
            let CompleteError::NotMet { nearest, .. } = error else { unreachable!("it was matched before") };
            (*nearest, Some(lacking))
        }
        Err(error) => return Err(error.into()),
    };
    Ok(Pattern {
        drawing: completed.drawing,
        region: completed.region,
        changes: completed.changes.iter().map(ChangeReport::new).collect(),
        levels: synthesis.levels,
        lacking,
    })
}
