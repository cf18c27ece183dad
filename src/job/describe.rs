//! What a report says of a band before its files are read again.

use super::builder::BandJob;
use super::certificate::Certificate;
use super::choice::Choice;
use super::cut::Cut;
use super::notes::notes;
use super::part::Part;
use super::plan::Plan;
use super::report::{
    BandReport, DroppedCutReport, FallbackReport, InputReport, MadeReport, NOT_COUNTED, SeamReport,
    StageTime, StitchReport,
};
use super::surface::SurfaceOptions;
use crate::domain::BandMap;
use crate::fit::{Outline, Seam};
use crate::solver::{autocorrelation, evenness, longest_repeat};
use crate::topology::{Shape, Topology, Wanted};

/// What was asked for and made; what is found in the files comes later.
#[expect(
    clippy::too_many_arguments,
    reason = "a report draws on every stage, and this is the only place that sees all"
)]
pub(super) fn describe(
    job: &BandJob,
    cut: &Cut,
    plan: &Plan,
    planned: Topology,
    map: &BandMap,
    outline: &Outline,
    part: &Part,
    curve: Option<InputReport>,
    times: Vec<StageTime>,
) -> BandReport {
    let options = &job.options;
    let worst = |angle: fn(&Seam) -> f64| outline.seams.iter().map(angle).fold(0.0, f64::max);
    let length_mm = map.curve().length_mm();
    // A mirrored piece is a use of the piece.
    let origins: Vec<usize> = plan.sequence.iter().map(|&p| cut.catalogue.origin(p).index).collect();
    BandReport {
        schema_version: 1,
        generator: concat!("Openwork ", env!("CARGO_PKG_VERSION")),
        exemplar: InputReport {
            file: options.exemplar.display().to_string(),
            sha256: cut.exemplar.sha256().to_owned(),
        },
        along: options.along.to_string(),
        curve,
        seed: match options.choice {
            Choice::Drawn { seed, .. } => Some(seed),
            _ => options.seed,
        },
        drawn_exactly: None,
        log10_sequences: None,
        log10_sequences_at_least: None,
        log10_sequences_at_most: None,
        sequences: NOT_COUNTED,
        longest_repeat: longest_repeat(&plan.sequence),
        evenness: evenness(&origins, cut.catalogue.originals()),
        wanted_components: options.goal.components.map(Wanted::ends),
        wanted_holes: options.goal.holes.map(Wanted::ends),
        wanted_closed_pattern: options.goal.closed_pattern,
        components: planned.components as usize,
        holes: planned.holes as usize,
        closed_pattern: planned.closed_pattern,
        length_mm,
        width_mm: cut.height_mm,
        thickness_mm: options.thickness_mm,
        chord_mm: job.tolerances.chord_mm(),
        pieces_in_exemplar: cut.catalogue.originals(),
        pieces_in_result: plan.sequence.len(),
        mirror: cut.mirror,
        mirrored_pieces_in_result: plan
            .sequence
            .iter()
            .filter(|&&p| cut.catalogue.origin(p).is_mirrored)
            .count(),
        kept_mm: options.kept.iter().map(|k| [k.from_mm, k.to_mm]).collect(),
        dropped_cuts: cut
            .slicing
            .dropped
            .iter()
            .map(|d| DroppedCutReport { x_mm: d.x_mm, portal_mm: d.portal_mm })
            .collect(),
        sequence: plan.sequence.clone(),
        cost: plan.cost,
        rank: None,
        optimal: plan.gap.map(|gap| gap == 0.0),
        cost_gap: plan.gap,
        autocorrelation: job.variety.map(|_| autocorrelation(&origins)),
        successors: cut.weights.successors,
        epsilon: plan.epsilon,
        length_error_mm: length_mm / outline.stretch - length_mm,
        squash: outline.squash,
        squeezes: map.squeezes().to_vec(),
        bridges: None,
        flat: None,
        surface: job.options.surface.as_ref().map(SurfaceOptions::report),
        weighed: Vec::new(),
        contact_sheet: None,
        seams: SeamReport {
            count: outline.seams.len(),
            jumps: outline.seams.iter().filter(|s| !s.is_natural).count(),
            worst_angle_before_deg: worst(|s| s.before_deg),
            worst_angle_after_deg: worst(|s| s.after_deg),
        },
        stitching: stitching(outline),
        search_labels: plan.labels,
        search_states: plan.states,
        made: MadeReport {
            min_feature: None,
            min_gap: None,
            narrow_places: Default::default(),
            enforced: None,
            quantities: None,
            bytes: Vec::new(),
            area_mm2: part.region.area_mm2(),
            page_mm: part.page_mm.to_array(),
            vertices: part.region.vertices(),
            svg_segments: None,
            laser: None,
            triangles: None,
            shells: None,
            genus: None,
            volume_mm3: None,
            files: Vec::new(),
            certificate: Certificate::new(
                &cut.catalogue,
                &plan.sequence,
                if map.curve().is_closed() { Shape::Ring } else { Shape::Open },
                options.goal,
                planned,
            ),
            notes: notes(job, cut, plan, map, outline, part.shift_mm),
            times,
        },
    }
}

fn stitching(outline: &Outline) -> StitchReport {
    let fallbacks = outline.fallbacks.iter().map(|f| FallbackReport {
        place: f.place,
        piece: f.piece,
        fault: f.fault.to_string(),
    });
    StitchReport {
        method: outline.method.to_string(),
        fallbacks: fallbacks.collect(),
        fallback_seams: (0..outline.seams.len()).filter(|&i| outline.seams[i].fell_back).collect(),
    }
}
