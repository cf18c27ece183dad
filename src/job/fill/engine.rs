//! The second engine as a job uses it: synthesis, completion, and what is told of them.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::FillJob;
use super::ground::{Ground, grid_error};
use crate::fabricate::Counts;
use crate::job::error::JobError;
use crate::job::stage::{Clock, Stage};
use crate::planar::{Contour, Region};
use crate::samples::{
    self, ChangeKind, CompleteError, CompleteOptions, Curve, Drawing, Element, Given, LevelReport, Options,
    SampleError,
};

/// The part of the chord error that strokes may spend while they are completed.
const INK_SHARE: f64 = 0.25;

/// A join or an opening that made the counts what they are. Positions are millimetres from the lower left corner of the page, y up; of a
/// band, in its strip: along the curve, and across it from its middle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChangeReport {
    /// What it is: `join` of ends along an edge that nearly was, `link` between components, `enclose` for a hole, `fill` of one that is
    /// too small, `open` of a hole, `part` of a component, `trim` of a twig or of what runs along the frame, `leave out` of a small component.
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
            ChangeKind::Link => "link",
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
    /// It, without what is kept.
    pub(super) drawing: Drawing,
    /// What it covers with what is kept.
    pub(super) region: Region,
    /// Components and holes before anything was done for the goal.
    pub(super) own: Counts,
    pub(super) changes: Vec<ChangeReport>,
    /// What is to be told.
    pub(super) notes: Vec<String>,
    pub(super) levels: Vec<LevelReport>,
    /// What could not be met by edges of the pattern alone.
    pub(super) lacking: Option<String>,
}

/// A pattern like `exemplar` all over the area, with what is given, of which `kept` is the ink, completed as far as the goal can be met.
///
/// # Errors
/// [`JobError`] when there is no pattern.
pub(super) fn pattern(
    (job, constants): (&FillJob, &Options),
    exemplar: &Drawing,
    ground: &Ground,
    (given, kept): (&Given, &Drawing),
    ends_wanted: usize,
    clock: &mut Clock<'_>,
) -> Result<Pattern, JobError> {
    let synthesis = clock.time_telling(Stage::Synthesize, |tell| {
        let mut progress =
            |level, iteration| tell(Stage::Iterate { level: level + 1, iteration: iteration + 1 });
        samples::synthesize(exemplar, &ground.area, constants, given, &mut progress)
    });
    let synthesis = synthesis.map_err(|error| unlearnt(&job.options.exemplar, error))?;
    let placed = synthesis.elements.placed.iter().map(|placed| Element {
        contours: synthesis.elements.classes[placed.class as usize].drawn(&placed.similarity),
    });
    let mut elements: Vec<Element> = placed.collect();
    let own_elements = elements.len();
    let tolerances = &job.options.making.tolerances;
    let completing = CompleteOptions {
        chord_mm: INK_SHARE * tolerances.chord_mm(),
        min_gap_mm: tolerances.min_gap_mm(),
        stroke_mm: job.options.stroke_mm,
        frame_mm: job.options.frame_mm,
        ends_wanted: Some(ends_wanted),
        ..CompleteOptions::default()
    };
    // What is given is ink as it was drawn, and the pattern's strokes through its samples would be a second one.
    let copied = synthesis
        .copied
        .iter()
        .map(|curve| Curve { width_mm: job.options.stroke_mm.unwrap_or(curve.width_mm), ..curve.clone() });
    let there = Drawing { curves: copied.collect(), elements: kept.elements.clone() };
    let ink = samples::inked(&there, ground.area.region().grid(), completing.chord_mm).map_err(grid_error)?;
    elements.extend(as_elements(&ink));
    let mut graph = synthesis.graph;
    graph.edges.retain(|edge| !edge.is_given());
    samples::clear_of(&mut graph, &ink, &ground.area);
    let completed = clock.time(Stage::Complete, || {
        samples::complete(&graph, &elements, &ground.area, constants, &job.options.goal, &completing)
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
    let mut drawing = completed.drawing;
    drawing.elements.truncate(own_elements);
    drawing.curves.extend(there.curves);
    Ok(Pattern {
        drawing,
        region: completed.region,
        own: Counts { components: completed.own[0], holes: completed.own[1] },
        notes: lost_copies(synthesis.lost_copies),
        changes: completed.changes.iter().map(ChangeReport::new).collect(),
        levels: synthesis.levels,
        lacking,
    })
}

fn lost_copies(count: usize) -> Vec<String> {
    let note = || {
        format!(
            "{count} shape(s) of what --clone copies would reach beyond the domain and are left out, as shapes are whole or not there"
        )
    };
    (count > 0).then(note).into_iter().collect()
}

/// Ink as shapes, one for each component.
fn as_elements(ink: &Region) -> impl Iterator<Item = Element> + '_ {
    let in_mm = |contour: &Contour| contour.points().iter().map(|&p| ink.grid().to_mm(p)).collect();
    ink.parts().iter().map(move |part| Element { contours: part.contours().map(in_mm).collect() })
}

/// The error of the engine, with the file where that is what has to change.
pub(super) fn unlearnt(exemplar: &Path, error: SampleError) -> JobError {
    match error {
        SampleError::Empty | SampleError::Sparse { .. } | SampleError::Crowded { .. } => {
            JobError::Unlearnt { file: exemplar.to_owned(), error }
        }
        _ => error.into(),
    }
}
