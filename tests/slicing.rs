//! What slicing promises: nothing kept is cut, thin portals are dropped at the size of the job, and the mirrored
//! exemplar gives the mirrored catalogue.

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use common::Room;
use openwork::exemplar::{Exemplar, ReadOptions};
use openwork::job::BandBuilder;
use openwork::pieces::{Catalogue, Chain, CostWeights};
use openwork::planar::{FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{KeptRange, ReebGraph, Slicing, SlicingError, SlicingRule};
use openwork::topology::Topology;
use proptest::prelude::*;

const FIXTURES: [&str; 12] = [
    "chain", "filigree", "lace", "lattice", "leaves", "meander", "rope", "strands", "strokes", "tilted",
    "vine", "wave",
];

fn file(name: &str) -> String {
    format!("{}/fixtures/exemplars/{name}.svg", env!("CARGO_MANIFEST_DIR"))
}

fn region(name: &str, height_mm: Option<f64>) -> Region {
    let options = ReadOptions { target_height_mm: height_mm, ..ReadOptions::default() };
    Exemplar::read(file(name).as_ref(), &options).unwrap().region().clone()
}

fn width_mm(region: &Region) -> f64 {
    let (low, high) = region.bounds_mm().unwrap();
    high.x - low.x
}

fn slice(region: &Region, rule: SlicingRule, kept: &[KeptRange], min_feature_mm: f64) -> Slicing {
    let tolerances = Tolerances::new(0.01, min_feature_mm, 0.0).unwrap();
    Slicing::keeping(region, &ReebGraph::new(region), rule, kept, &tolerances).unwrap()
}

/// Positions of the cuts from the left edge.
fn positions(region: &Region, slicing: &Slicing) -> Vec<f64> {
    let left = region.bounds_mm().unwrap().0.x;
    slicing.cuts.iter().map(|c| region.grid().mm(c.x) - left).collect()
}

/// The region left for right, exact on its grid.
fn mirror_image(region: &Region) -> Region {
    let paths: Vec<Vec<GridPoint>> =
        region.contours().map(|c| c.points().iter().map(|p| GridPoint::new(-p.x, p.y)).collect()).collect();
    Region::fill(region.grid(), &paths, FillRule::EvenOdd)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn no_cut_divides_a_kept_range(
        name in prop::sample::select(&FIXTURES[..]),
        ranges in prop::collection::vec((0.0f64..0.8, 0.02f64..0.2), 1..4),
        lines in prop::option::of(2usize..60),
    ) {
        let region = region(name, Some(20.0));
        let width = width_mm(&region);
        let rule = match lines {
            Some(lines) => SlicingRule::Uniform { lines },
            None => SlicingRule::reeb_for_width(width),
        };
        let kept: Vec<KeptRange> = ranges
            .iter()
            .map(|&(from, part)| KeptRange { from_mm: from * width, to_mm: (from + part) * width })
            .collect();
        let tolerances = Tolerances::default();
        let slicing = match Slicing::keeping(&region, &ReebGraph::new(&region), rule, &kept, &tolerances) {
            Ok(slicing) => slicing,
            Err(error) => {
                prop_assert!(matches!(error, SlicingError::AllKept { .. }), "{error}");
                return Ok(());
            }
        };
        let step = region.grid().step_mm();
        for x in positions(&region, &slicing) {
            prop_assert!(!kept.iter().any(|k| k.from_mm + step < x && x < k.to_mm - step), "{x} in {kept:?}");
        }
        // Uniform lines outside stay where they were.
        if lines.is_some() {
            let all = slice(&region, rule, &[], 0.0);
            let outside = |x: &f64| !kept.iter().any(|k| k.from_mm < *x && *x < k.to_mm);
            // Of several cuts in one gap only one stays, which may then be another.
            let through_ink = |s: &Slicing| {
                let cuts = positions(&region, s).into_iter().zip(&s.cuts);
                cuts.filter(|(_, c)| c.portals() > 0).map(|(x, _)| x).filter(outside).collect::<Vec<_>>()
            };
            prop_assert_eq!(through_ink(&slicing), through_ink(&all));
        }
    }
}

#[test]
fn thin_portals_are_dropped_at_the_size_of_the_job() {
    for name in ["vine", "filigree", "tilted"] {
        let small = region(name, Some(10.0));
        let large = small.placed(Grid::for_extent(500.0).unwrap(), |p| 3.0 * p).unwrap();
        let rule = |region: &Region| SlicingRule::reeb_for_width(width_mm(region));
        let all = slice(&small, rule(&small), &[], 0.0);
        let mut thinnest: Vec<f64> = all.cuts.iter().map(|c| c.narrowest_portal_mm()).collect();
        thinnest.retain(|mm| mm.is_finite());
        thinnest.sort_by(f64::total_cmp);
        let feature = thinnest[thinnest.len() / 3] + 1e-4;
        let dropping = slice(&small, rule(&small), &[], feature);
        assert!(!dropping.dropped.is_empty(), "{name}");
        assert!(dropping.cuts.iter().all(|c| c.narrowest_portal_mm() >= feature), "{name}");
        assert!(dropping.dropped.iter().all(|d| d.portal_mm < feature), "{name}");
        assert!(dropping.dropped.iter().all(|d| 0.0 < d.x_mm && d.x_mm < width_mm(&small)), "{name}");
        // Three times the size with three times the feature is the same; with the same feature, less is dropped.
        let scaled = slice(&large, rule(&large), &[], 3.0 * feature);
        let places =
            |s: &Slicing, by: f64| s.dropped.iter().map(|d| (d.x_mm / by * 1e3).round()).collect::<Vec<_>>();
        assert_eq!(places(&dropping, 1.0), places(&scaled, 3.0), "{name}");
        assert_eq!(dropping.cuts.len(), scaled.cuts.len(), "{name}");
        assert!(slice(&large, rule(&large), &[], feature).dropped.len() < dropping.dropped.len(), "{name}");
    }
}

/// The catalogue of a region, every join weighed.
fn catalogue(region: &Region, is_mirrored: bool) -> Catalogue {
    let slicing = slice(region, SlicingRule::reeb_for_width(width_mm(region)), &[], 0.0);
    let weights = CostWeights { successors: usize::MAX, ..CostWeights::default() };
    let new = if is_mirrored { Catalogue::with_mirrored } else { Catalogue::new };
    new(region, &slicing.cuts, &weights)
}

#[test]
fn mirroring_the_exemplar_mirrors_the_catalogue() {
    // The lace is its own mirror image, so of two equal places in its very middle either may be cut.
    for name in FIXTURES.into_iter().filter(|&name| name != "lace") {
        let region = region(name, None);
        let (both, image) = (catalogue(&region, true), catalogue(&mirror_image(&region), false));
        let n = both.originals();
        assert_eq!(image.pieces().len(), n, "{name}");
        // Piece k of the mirror image is the mirrored piece n - 1 - k.
        let twin = |k: usize| 2 * n - 1 - k;
        for k in 0..n {
            let (found, wanted) = (&image.pieces()[k], &both.pieces()[twin(k)]);
            assert_eq!(found.descriptor, wanted.descriptor, "{name} {k}");
            assert!((found.x_mm - wanted.x_mm).abs() < 1e-6, "{name} {k}: {} {}", found.x_mm, wanted.x_mm);
            assert_eq!(found.chains.len(), wanted.chains.len());
            for (a, b) in found.chains.iter().zip(&wanted.chains) {
                assert_eq!((a.start, a.end), (b.start, b.end), "{name} {k}");
                // Vertices may differ: where one was in the way of a cut, it lies on the other side of it.
                let along = |c: &Chain| c.points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
                assert!((along(a) - along(b)).abs() < 1e-4, "{name} {k}: {} {}", along(a), along(b));
                let n = [a, b].map(|c| c.points.len() - 1);
                assert!(
                    a.points[0].distance(b.points[0]) < 1e-6
                        && a.points[n[0]].distance(b.points[n[1]]) < 1e-6
                );
            }
            assert_eq!(image.natural_next(k).map(twin), both.natural_next(twin(k)), "{name} {k}");
            assert_eq!(image.is_own_begin(k), both.is_own_begin(twin(k)));
            assert_eq!(image.is_own_end(k), both.is_own_end(twin(k)));
        }
        for k in 0..n {
            for join in &image.joins()[k] {
                let same = both.join(twin(k), twin(join.to)).unwrap();
                assert!((join.cost - same.cost).abs() < 1e-6, "{name} {k} to {}", join.to);
                assert!((join.rise_mm - same.rise_mm).abs() < 1e-6);
                assert_eq!(join.is_natural, same.is_natural);
                // The same join backwards is one of the exemplar, at the same cost.
                let back = both.join(twin(join.to) - n, twin(k) - n).unwrap();
                assert!((join.cost - back.cost).abs() < 1e-6, "{name} {k} to {}", join.to);
            }
        }
    }
}

#[test]
fn the_mirrored_pieces_join_to_the_exemplar_again() {
    for name in FIXTURES {
        let region = region(name, None);
        let catalogue = catalogue(&region, true);
        let first = (0..catalogue.pieces().len()).filter(|&p| catalogue.is_own_begin(p));
        for first in first {
            let natural = std::iter::successors(Some(first), |&p| catalogue.natural_next(p));
            let sequence: Vec<usize> = natural.collect();
            assert_eq!(sequence.len(), catalogue.originals());
            assert!(catalogue.is_own_end(*sequence.last().unwrap()));
            let mut run = catalogue.descriptors()[first].clone();
            for &piece in &sequence[1..] {
                run = run.join(&catalogue.descriptors()[piece]).unwrap();
            }
            let wanted = Topology {
                components: region.components() as u32,
                holes: region.holes() as u32,
                closed_pattern: false,
            };
            assert_eq!(run.finished(), Some(wanted), "{name}");
        }
    }
}

#[test]
fn mirrored_pieces_never_make_a_band_dearer_and_the_mirror_image_costs_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["vine", "meander", "filigree"] {
        let text = std::fs::read_to_string(file(name)).unwrap();
        let (begin, end) = (text.find("<svg").unwrap(), text.rfind("</svg>").unwrap());
        let inside = begin + text[begin..].find('>').unwrap() + 1;
        let image = folder.path().join(format!("{name}.svg"));
        let turned =
            format!("{}<g transform=\"scale(-1 1)\">{}</g></svg>", &text[..inside], &text[inside..end]);
        std::fs::write(&image, turned).unwrap();
        for along in ["line:150mm", "circle:60mm"] {
            let band = |exemplar: &str, mirror: bool| {
                let builder = BandBuilder::new(exemplar, along.parse().unwrap()).width_mm(12.0).components(1);
                builder.mirror(mirror).build().unwrap().run(&mut |_| {}).unwrap()
            };
            let (plain, both) = (band(&file(name), false), band(&file(name), true));
            assert!(both.plan().cost <= plain.plan().cost + 1e-9, "{name} {along}");
            let image = band(image.to_str().unwrap(), true);
            assert!((image.plan().cost - both.plan().cost).abs() < 1e-3, "{name} {along}");
            assert_eq!(image.topology().components, 1);
        }
    }
}

#[test]
fn options_are_checked_and_reported() {
    let room = Room::with(&["vine.svg"]);
    let band = "band vine.svg --along line:120mm --width 14mm -o band.svg";
    room.refuses(&format!("{band} --keep 20mm..10mm"), 2, &["--keep", "left end first"]);
    room.refuses(&format!("{band} --keep 20mm"), 2, &["--keep", "10mm..24mm"]);
    let beyond = ["--keep 60.00mm..90.00mm reaches beyond", "68.07 mm wide", "--width"];
    room.refuses(&format!("{band} --keep 60mm..90mm"), 2, &beyond);
    room.refuses(&format!("{band} --keep -3mm..5mm"), 2, &["reaches beyond"]);
    room.refuses(&format!("{band} --keep 0..68mm"), 2, &["leaves no place for a cut"]);
    room.refuses("analyze vine.svg --keep 60mm..190mm", 2, &["100.00 mm wide"]);
    let text = room.succeeds("analyze vine.svg --keep 10mm..20mm --keep 4cm..45mm --json").stdout;
    let found: serde_json::Value = serde_json::from_slice(&text).unwrap();
    assert_eq!(found["kept_mm"], serde_json::json!([[10.0, 20.0], [40.0, 45.0]]));
    let cuts = found["cuts"].as_array().unwrap().iter().map(|c| c["x_mm"].as_f64().unwrap());
    assert!(cuts.into_iter().all(|x| !(10.001..19.999).contains(&x) && !(40.001..44.999).contains(&x)));
    room.succeeds(&format!("{band} --keep 10..20mm --mirror --min-feature 0.4mm --report band.json"));
    let report = room.json("band.json");
    assert_eq!((&report["mirror"], &report["kept_mm"]), (&true.into(), &serde_json::json!([[10.0, 20.0]])));
    assert!(
        report["mirrored_pieces_in_result"].as_u64().unwrap() <= report["pieces_in_result"].as_u64().unwrap()
    );
    for cut in report["dropped_cuts"].as_array().unwrap() {
        assert!(cut["portal_mm"].as_f64().unwrap() < 0.4);
    }
}
