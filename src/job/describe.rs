//! What a report says of a band before its files are read again.

use super::builder::{BandJob, SlicingChoice};
use super::certificate::Certificate;
use super::choice::Choice;
use super::cut::Cut;
use super::part::Part;
use super::plan::Plan;
use super::report::{
    BandReport, DroppedCutReport, FallbackReport, InputReport, MadeReport, SeamReport, StageTime,
    StitchReport,
};
use crate::domain::BandMap;
use crate::fit::{Outline, Seam, Sides};
use crate::reeb::Slicing;
use crate::solver::{autocorrelation, evenness, longest_repeat};
use crate::topology::{Shape, Topology, Wanted};

/// Cuts named in a note; a report lists all.
const DROPPED_SHOWN: usize = 5;

/// What to say of cuts through ink that is too thin.
fn dropped_note(slicing: &Slicing) -> Option<String> {
    let dropped = &slicing.dropped;
    let shown = dropped.iter().take(DROPPED_SHOWN).map(|d| format!("{:.2} ({:.3})", d.x_mm, d.portal_mm));
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if dropped.len() > DROPPED_SHOWN { ", ..." } else { "" };
    (!dropped.is_empty()).then(|| {
        format!(
            "{} cut(s) were left out, as they pass through ink thinner than --min-feature: at x (portal) {shown}{more} mm",
            dropped.len()
        )
    })
}

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
    let mut notes = cut.exemplar.notes().to_vec();
    if let [first, ..] = cut.specks[..] {
        notes.push(format!(
            "{} speck(s) of less than {:.1e} mm2 were left out, the first at ({:.3}, {:.3}) mm; a smaller --chord keeps them",
            cut.specks.len(),
            job.tolerances.chord_mm().powi(2),
            first.x,
            first.y
        ));
    }
    if outline.method != options.stitch && cut.sides != Sides::Held {
        notes.push(
            "the whole band was stitched by --stitch warp, as rotation-invariant deformation made contours meet between its pieces"
                .to_owned(),
        );
    }
    if !outline.fallbacks.is_empty() {
        notes.push(format!(
            "{} of {} pieces were warped, as rotation-invariant deformation would have broken them",
            outline.fallbacks.len(),
            plan.sequence.len()
        ));
    }
    if let Some(note) = dropped_note(&cut.slicing) {
        notes.push(note);
    }
    if let (SlicingChoice::Uniform(lines), 1..) = (options.slicing, cut.slicing.missed) {
        notes.push(format!(
            "{} of the {lines} cuts were left out, as contours run along them or nearly touch there",
            cut.slicing.missed
        ));
    }
    if plan.epsilon > 0.05 {
        notes.push(format!(
            "no sequence came within 5 % of the length; within {:.0} % one did, and it is stretched by {:.1} %",
            plan.epsilon * 100.0,
            (outline.stretch - 1.0) * 100.0
        ));
    }
    if plan.epsilon <= 0.05 && (outline.stretch - 1.0).abs() > 0.05 {
        notes.push(format!(
            "the pieces are so narrow against the length that it was met only within {:.1} %, by stretching",
            (outline.stretch - 1.0).abs() * 100.0
        ));
    }
    if outline.squash < 0.99 {
        notes.push(format!(
            "the band climbs and was pressed to {:.0} % of its height to fit",
            outline.squash * 100.0
        ));
    }
    for squeeze in map.squeezes() {
        notes.push(format!(
            "the curve bends so hard at ({:.1}, {:.1}) mm that the inner side is squeezed from {:.1} to {:.1} mm",
            squeeze.position_mm[0], squeeze.position_mm[1], squeeze.reach_mm, squeeze.squeezed_to_mm
        ));
    }
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
        longest_repeat: longest_repeat(&plan.sequence),
        evenness: evenness(&plan.sequence, cut.catalogue.pieces().len()),
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
        optimal: plan.gap.map(|gap| gap == 0.0),
        cost_gap: plan.gap,
        autocorrelation: job.variety.map(|_| autocorrelation(&plan.sequence)),
        successors: cut.weights.successors,
        epsilon: plan.epsilon,
        length_error_mm: length_mm / outline.stretch - length_mm,
        squash: outline.squash,
        squeezes: map.squeezes().to_vec(),
        bridges: None,
        weighed: Vec::new(),
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
            area_mm2: part.region.area_mm2(),
            page_mm: part.page_mm.to_array(),
            vertices: part.region.vertices(),
            svg_segments: None,
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
            notes,
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
