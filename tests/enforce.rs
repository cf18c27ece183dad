//! Enforced regions: what was too thin or too narrow holds, the counts are those of before, and the rest is as it was.

use glam::DVec2;
use openwork::fabricate::{Counts, EnforceError, EnforceOptions, enforce};
use openwork::planar::{EdgeIndex, FillRule, Grid, GridPoint, Region};
use openwork::verify::{endures_dilation, endures_erosion, narrow_places};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const CHORD_MM: f64 = 0.01;

fn region(paths: &[Vec<DVec2>]) -> Region {
    let grid = Grid::for_extent(128.0).unwrap();
    let snapped = |path: &Vec<DVec2>| path.iter().map(|&p| grid.snap(p).unwrap()).collect();
    let paths: Vec<Vec<GridPoint>> = paths.iter().map(snapped).collect();
    Region::fill(grid, &paths, FillRule::EvenOdd)
}

/// A strand, a disc or a blob, somewhere and turned somehow.
fn blob() -> impl Strategy<Value = Vec<DVec2>> {
    let turned = |n: usize| move |i: usize| DVec2::from_angle(i as f64 * std::f64::consts::TAU / n as f64);
    let strand = (1.0..14.0, 0.05..3.0).prop_map(|(w, h): (f64, f64)| {
        [(-w, -h), (w, -h), (w, h), (-w, h)].map(|(x, y)| DVec2::new(x, y / 2.0)).to_vec()
    });
    let disc = (0.5..9.0f64, 8..40usize)
        .prop_map(move |(r, n)| (0..n).map(turned(n)).map(|p| p * r).collect::<Vec<DVec2>>());
    let star = proptest::collection::vec(0.5..9.0f64, 5..16)
        .prop_map(move |radii| (0..radii.len()).map(|i| turned(radii.len())(i) * radii[i]).collect());
    let place = (-20.0..20.0f64, -20.0..20.0f64, 0.0..6.3f64);
    (place, prop_oneof![strand, disc, star]).prop_map(|((x, y, angle), shape)| {
        let turn = DVec2::from_angle(angle);
        shape.into_iter().map(|p: DVec2| turn.rotate(p) + DVec2::new(x, y)).collect()
    })
}

/// Whether the counts of a region survive half of both widths.
fn holds(region: &Region, feature_mm: f64, gap_mm: f64) -> bool {
    endures_erosion(region, 0.5 * feature_mm, 0.25 * CHORD_MM)
        && endures_dilation(region, 0.5 * gap_mm, 0.25 * CHORD_MM)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, rng_seed: RngSeed::Fixed(4), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn enforced_regions_hold_with_the_same_counts(
        paths in proptest::collection::vec(blob(), 1..8),
        feature_mm in 0.1..0.8f64,
        gap_mm in 0.1..0.8f64,
    ) {
        let before = region(&paths);
        prop_assume!(!before.is_empty());
        let options = EnforceOptions { min_feature_mm: feature_mm, min_gap_mm: gap_mm, chord_mm: CHORD_MM };
        let enforced = match enforce(&before, &options) {
            Ok(enforced) => enforced,
            // Strands that cross at random may leave no room; but then something was too narrow.
            Err(EnforceError::Crowded { .. }) => {
                prop_assert!(!holds(&before, 1.05 * feature_mm, 1.05 * gap_mm));
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let after = &enforced.region;
        prop_assert_eq!(Counts::of(after), Counts::of(&before));
        prop_assert!(holds(after, feature_mm, gap_mm));
        // The part has kept its size, and its area is as the report says.
        let [old, new] = [&before, after].map(|region| region.bounds_mm().unwrap());
        let grown = (old.0 - new.0).max(new.1 - old.1).max_element();
        prop_assert!(grown <= 2.0 * CHORD_MM + feature_mm, "{}", grown);
        let change = enforced.added_mm2 - enforced.removed_mm2;
        prop_assert!((after.area_mm2() - before.area_mm2() - change).abs() < 1e-3);
        // Ends for which there was no room are tried again, and others may find some.
        if enforced.leaves_ends {
            return Ok(());
        }
        // Once more changes nothing.
        prop_assert_eq!(&enforce(after, &options).unwrap().region, after);
        // Nor is anything much narrower that changes no count, but for tips and the ends of notches. Crannies between strokes
        // are measured at the nodes of a core only, and may be missed by a few hundredths.
        let places = narrow_places(after, 10, f64::INFINITY, CHORD_MM);
        for (places, wanted_mm) in [(places.ink, feature_mm), (places.gaps, gap_mm)] {
            let narrowest_mm = places.first().map_or(f64::INFINITY, |place| place.width_mm);
            prop_assert!(narrowest_mm > 0.9 * wanted_mm, "{narrowest_mm} {wanted_mm} {feature_mm}");
        }
    }
}

#[test]
fn what_is_far_from_narrow_places_is_untouched() {
    let square = |x: f64, y: f64, side: f64| {
        [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(DVec2::from).to_vec()
    };
    let bar = [(10.0, 4.95), (30.0, 4.95), (30.0, 5.05), (10.0, 5.05)].map(DVec2::from).to_vec();
    let grid = Grid::for_extent(128.0).unwrap();
    let paths = [square(0.0, 0.0, 10.0), square(30.0, 0.0, 10.0), bar, square(0.0, 10.2, 10.0)];
    let snapped = paths.map(|path| path.into_iter().map(|p| grid.snap(p).unwrap()).collect());
    let before = Region::fill(grid, &snapped, FillRule::NonZero);
    let options = EnforceOptions { min_feature_mm: 0.6, min_gap_mm: 0.5, chord_mm: CHORD_MM };
    let after = enforce(&before, &options).unwrap().region;
    let places = narrow_places(&before, 10, 0.6, CHORD_MM);
    assert!((places.ink[0].width_mm - 0.1).abs() < 1e-3 && (places.gaps[0].width_mm - 0.2).abs() < 1e-3);
    // The far corners of the squares, and all of their edges that are not near the bar or the gap.
    let index = EdgeIndex::new(&after);
    for p in [(0.0, 0.0), (40.0, 10.0), (40.0, 0.0), (5.0, 0.0), (35.0, 10.0), (0.0, 20.2), (10.0, 15.0)] {
        let p = DVec2::from(p);
        let distance = index.nearest(p).unwrap().nearest(p).distance(p);
        assert!(distance < 1e-6, "{p} {distance}");
    }
}
