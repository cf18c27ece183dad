use glam::DVec2;

use super::*;
use crate::planar::{FillRule, Grid, GridPoint};

fn region(paths: &[Vec<DVec2>]) -> Region {
    let grid = Grid::for_extent(128.0).unwrap();
    let snapped = |path: &Vec<DVec2>| path.iter().map(|&p| grid.snap(p).unwrap()).collect();
    let paths: Vec<Vec<GridPoint>> = paths.iter().map(snapped).collect();
    Region::fill(grid, &paths, FillRule::EvenOdd)
}

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<DVec2> {
    [(x, y), (x + width, y), (x + width, y + height), (x, y + height)].map(DVec2::from).to_vec()
}

fn circle(x: f64, y: f64, radius: f64, n: usize) -> Vec<DVec2> {
    let turn = std::f64::consts::TAU / n as f64;
    (0..n).map(|i| DVec2::new(x, y) + radius * DVec2::from_angle(i as f64 * turn)).collect()
}

fn options(min_feature_mm: f64, min_gap_mm: f64) -> EnforceOptions {
    EnforceOptions { min_feature_mm, min_gap_mm, chord_mm: 0.01 }
}

/// The ink between two heights at a place, as pairs of where it begins and ends.
fn ink_at(region: &Region, x: f64) -> Vec<[f64; 2]> {
    let mut crossings = Vec::new();
    for (a, b) in region.contours().flat_map(|contour| contour.edges()) {
        let [a, b] = [a, b].map(|p| region.grid().to_mm(p));
        if (a.x < x) != (b.x < x) {
            crossings.push(a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y));
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings.chunks(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[test]
fn a_neck_is_thickened_and_nothing_else() {
    let dumbbell = region(&[
        rectangle(0.0, 0.0, 10.0, 10.0),
        rectangle(20.0, 0.0, 10.0, 10.0),
        rectangle(10.0, 4.9, 10.0, 0.2),
    ]);
    let dumbbell = Region::union(dumbbell.grid(), [&dumbbell]);
    assert_eq!(dumbbell.components(), 1);
    let enforced = enforce(&dumbbell, &options(1.0, 0.0)).unwrap();
    let [[low, high]] = ink_at(&enforced.region, 15.0)[..] else { panic!("one strand") };
    assert!((1.0..1.06).contains(&(high - low)), "{low} {high}");
    // The neck is 10 mm long and gains 0.83 mm; the blocks stay what they are.
    assert!((8.0..8.6).contains(&enforced.added_mm2), "{}", enforced.added_mm2);
    assert!(enforced.removed_mm2 < 1e-6);
    assert_eq!(ink_at(&enforced.region, 5.0), [[0.0, 10.0]]);
    // What was thickened needs no more.
    let again = enforce(&enforced.region, &options(1.0, 0.0)).unwrap();
    assert_eq!(again.region, enforced.region);
    assert!(again.changes.is_empty());
}

#[test]
fn corners_and_tips_stay_sharp() {
    let star = (0..20).map(|i| {
        let radius = if i % 2 == 0 { 30.0 } else { 12.0 };
        radius * DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 20.0)
    });
    let star = region(&[star.collect()]);
    assert_eq!(enforce(&star, &options(0.8, 0.8)).unwrap().region, star);
}

#[test]
fn a_hair_becomes_a_strand_of_its_own_length() {
    let hair = region(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(10.0, 5.0, 8.0, 0.05)]);
    let enforced = enforce(&hair, &options(0.5, 0.5)).unwrap();
    let [[low, high]] = ink_at(&enforced.region, 17.0)[..] else { panic!("one strand") };
    assert!((0.5..0.53).contains(&(high - low)), "{low} {high}");
    let (_, far) = enforced.region.bounds_mm().unwrap();
    assert!((far.x - 18.0).abs() < 1e-6, "{far}");
}

#[test]
fn a_gap_is_widened_on_both_sides() {
    let two = region(&[rectangle(0.0, 0.0, 5.0, 5.0), rectangle(0.0, 5.1, 5.0, 5.0)]);
    let enforced = enforce(&two, &options(0.0, 0.6)).unwrap();
    let [[_, below], [above, _]] = ink_at(&enforced.region, 2.5)[..] else { panic!("two blocks") };
    assert!((0.6..0.63).contains(&(above - below)), "{below} {above}");
    assert!((above + below - 10.1).abs() < 0.01);
    assert!(enforced.added_mm2 < 1e-6 && enforced.removed_mm2 > 2.4);
}

#[test]
fn ink_beside_a_narrow_gap_grows_on_its_other_side() {
    // A wire of 0.1 mm that hangs on two blocks, 0.4 mm above a plate.
    let wire = region(&[
        rectangle(0.0, 0.0, 30.0, 5.0),
        rectangle(0.0, 5.4, 5.0, 5.0),
        rectangle(25.0, 5.4, 5.0, 5.0),
        rectangle(5.0, 5.4, 20.0, 0.1),
    ]);
    let wire = Region::union(wire.grid(), [&wire]);
    let enforced = enforce(&wire, &options(0.5, 0.4)).unwrap();
    let [[_, plate], [low, high]] = ink_at(&enforced.region, 15.0)[..] else { panic!("two strands") };
    assert!(low - plate > 0.4 && high - low > 0.5, "{plate} {low} {high}");
    assert!((high - 5.4 - 0.5).abs() < 0.06, "{high}");
    assert_eq!(Counts::of(&enforced.region), Counts::of(&wire));
}

/// A block of 20 by 10 mm with these slits taken out of it.
fn slit(slits: &[Vec<DVec2>]) -> Region {
    let mut paths = vec![rectangle(0.0, 0.0, 20.0, 10.0)];
    paths.extend_from_slice(slits);
    region(&paths)
}

#[test]
fn a_long_slot_is_widened_and_no_deeper_than_it_was() {
    let block = slit(&[rectangle(10.0, 4.0, 0.1, 6.0)]);
    let enforced = enforce(&block, &options(0.5, 0.5)).unwrap();
    assert_eq!(Counts::of(&enforced.region), Counts::of(&block));
    let below = ink_at(&enforced.region, 10.05);
    assert!(below.len() == 1 && (below[0][1] - 4.0).abs() < 0.05, "{below:?}");
    for x in [9.82, 10.28] {
        assert!(ink_at(&enforced.region, x)[0][1] < 5.0, "{x}");
    }
    assert!(enforced.removed_mm2 > 2.2, "{}", enforced.removed_mm2);
}

#[test]
fn a_short_bay_with_a_pocket_is_filled() {
    let bay = [(10.0, 10.0), (9.8, 9.7), (10.2, 9.2), (10.4, 9.5), (10.02, 9.7), (10.1, 10.0)];
    let block = slit(&[bay.map(DVec2::from).to_vec()]);
    let enforced = enforce(&block, &options(0.6, 0.6)).unwrap();
    assert!((enforced.region.area_mm2() - 200.0).abs() < 0.02, "{}", enforced.region.area_mm2());
    assert!(enforced.removed_mm2 < 1e-6);
}

#[test]
fn slots_without_room_are_filled() {
    // Between two slots no ink is left when they are as wide as gaps must be.
    let block = slit(&[0, 1, 2, 3].map(|i| rectangle(9.0 + 0.5 * f64::from(i), 4.0, 0.1, 6.0)));
    let enforced = enforce(&block, &options(0.6, 0.6)).unwrap();
    assert_eq!(Counts::of(&enforced.region), Counts::of(&block));
    let eroded = enforced.region.offset(-0.29, 0.001);
    assert_eq!(Counts::of(&eroded), Counts::of(&block));
}

#[test]
fn specks_and_pinholes_become_as_large_as_they_must() {
    let speck = region(&[circle(5.0, 5.0, 4.0, 64), circle(5.0, 5.0, 0.05, 16), circle(15.0, 5.0, 0.05, 16)]);
    assert_eq!(Counts::of(&speck), Counts { components: 2, holes: 1 });
    let enforced = enforce(&speck, &options(0.6, 0.6)).unwrap();
    assert_eq!(Counts::of(&enforced.region), Counts::of(&speck));
    let hole = &enforced.region.parts()[0].holes()[0];
    let area = -hole.area_mm2(enforced.region.grid());
    assert!((0.28..0.31).contains(&area), "{area}");
}

#[test]
fn what_has_no_room_is_refused_with_its_place() {
    let bars: Vec<Vec<DVec2>> = (0..5).map(|i| rectangle(0.0, 0.4 * f64::from(i), 20.0, 0.2)).collect();
    let Err(EnforceError::Crowded { position_mm, .. }) = enforce(&region(&bars), &options(0.4, 0.4)) else {
        panic!("strands 0.4 mm apart cannot be 0.4 mm wide with gaps of 0.4 mm")
    };
    assert!((0.0..=1.8).contains(&position_mm.y), "{position_mm}");
}

#[test]
fn nothing_asked_for_changes_nothing() {
    let two = region(&[rectangle(0.0, 0.0, 5.0, 5.0), rectangle(0.0, 5.1, 5.0, 5.0)]);
    assert_eq!(enforce(&two, &options(0.0, 0.0)).unwrap().region, two);
    let wrong = enforce(&two, &options(-1.0, 0.0));
    assert_eq!(wrong, Err(EnforceError::Width { name: "minimum feature", found_mm: -1.0 }));
}
