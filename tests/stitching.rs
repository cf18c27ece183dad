//! Both ways of stitching through whole jobs.

use std::path::Path;

use openwork::domain::CurveSpec;
use openwork::exemplar::{Exemplar, Limits, ReadOptions};
use openwork::fit::{FitOptions, Outline, Prepared, Sides, StitchMethod};
use openwork::job::{Band, BandBuilder};
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::Tolerances;
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};

fn fixture(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/exemplars").join(name)
}

fn leaves(stitch: StitchMethod) -> Band {
    BandBuilder::new(fixture("leaves.svg"), CurveSpec::Line { length_mm: 400.0 })
        .width_mm(20.0)
        .components(1)
        .stitch(stitch)
        .build()
        .unwrap()
        .run(&mut |_| {})
        .unwrap()
}

#[test]
fn the_report_says_which_seams_fell_back_and_why() {
    let report = leaves(StitchMethod::Lri).write(&[], None, &mut |_| {}).unwrap();
    let stitching = &report.stitching;
    assert_eq!(stitching.method, "lri");
    assert!(
        !stitching.fallbacks.is_empty(),
        "the pieces of these leaves are narrow and their jumps are high"
    );
    for fallback in &stitching.fallbacks {
        assert_eq!(report.sequence[fallback.place], fallback.piece);
        assert!(!fallback.fault.is_empty());
        // A seam has the number of the piece before it.
        let beside = |seam: usize| stitching.fallback_seams.contains(&seam);
        assert!(beside(fallback.place) && beside(fallback.place - 1), "{fallback:?}");
    }
    let note = format!("{} of {} pieces were warped", stitching.fallbacks.len(), report.pieces_in_result);
    assert!(report.made.notes.iter().any(|n| n.starts_with(&note)), "{:?}", report.made.notes);
}

#[test]
fn the_warp_never_falls_back() {
    let warped = leaves(StitchMethod::Warp);
    let report = warped.write(&[], None, &mut |_| {}).unwrap();
    assert_eq!(report.stitching.method, "warp");
    assert!(report.stitching.fallbacks.is_empty() && report.stitching.fallback_seams.is_empty());
    // Bending decides nothing: the plan is the same.
    assert_eq!(warped.plan().sequence, leaves(StitchMethod::Lri).plan().sequence);
}

#[test]
fn pieces_prepared_for_another_run_give_the_same_outline() {
    let options = ReadOptions { chord_mm: 0.0025, target_height_mm: Some(14.0), limits: Limits::default() };
    let exemplar = Exemplar::read(&fixture("tilted.svg"), &options).unwrap();
    let region = exemplar.region();
    let (low, high) = region.bounds_mm().unwrap();
    let rule = SlicingRule::reeb_for_width(high.x - low.x);
    let slicing = Slicing::new(region, &ReebGraph::new(region), rule, &Tolerances::default()).unwrap();
    let catalogue = Catalogue::new(region, &slicing.cuts, &CostWeights::default());
    // Some jumps, and then the exemplar's own pieces to its end.
    let last = catalogue.pieces().len() - 1;
    let natural: Vec<usize> = (0..=last).collect();
    let mut sequence = vec![0];
    for jump in 0.. {
        let at = sequence[sequence.len() - 1];
        if at == last {
            break;
        }
        let other = catalogue.joins()[at].iter().find(|j| !j.is_natural).filter(|_| jump < 20);
        sequence.push(other.map_or(at + 1, |j| j.to));
    }
    let fit = FitOptions {
        length_mm: 120.0,
        height_mm: 14.0,
        is_ring: false,
        chord_mm: 1e-3,
        stitch: StitchMethod::Lri,
        sides: Sides::Free,
    };
    let mut prepared = Prepared::new();
    Outline::prepared(&catalogue, &natural, &fit, &mut prepared).unwrap();
    assert!((1..=natural.len()).contains(&prepared.len()));
    let reused = Outline::prepared(&catalogue, &sequence, &fit, &mut prepared).unwrap();
    let fresh = Outline::new(&catalogue, &sequence, &fit).unwrap();
    assert_eq!(reused.contours, fresh.contours);
    let warped =
        Outline::new(&catalogue, &sequence, &FitOptions { stitch: StitchMethod::Warp, ..fit }).unwrap();
    assert_ne!(reused.contours, warped.contours, "the two methods bend differently");
}
