//! Bridges of random islands and frames, held against brute force.

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::planar::{FillRule, Grid, GridPoint};

fn grid() -> Grid {
    Grid::for_extent(128.0).unwrap()
}

fn on_grid(path: &[DVec2]) -> Vec<GridPoint> {
    path.iter().map(|&p| grid().snap(p).unwrap()).collect()
}

fn region(paths: &[Vec<DVec2>]) -> Region {
    Region::fill(grid(), &paths.iter().map(|p| on_grid(p)).collect::<Vec<_>>(), FillRule::EvenOdd)
}

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<DVec2> {
    [(x, y), (x + width, y), (x + width, y + height), (x, y + height)].map(DVec2::from).to_vec()
}

fn options(width_mm: f64) -> BridgeOptions<'static> {
    BridgeOptions {
        width_mm,
        min_feature_mm: 0.0,
        min_gap_mm: 0.0,
        chord_mm: 0.01,
        closed_around: None,
        within: None,
    }
}

fn counts(components: usize, holes: usize) -> Counts {
    Counts { components, holes }
}

/// Ink of `a` that neither `b` nor the bridges cover, in square millimetres.
fn left_over(a: &Region, b: &Region, bridges: &[Bridge]) -> f64 {
    let reversed = |path: Vec<GridPoint>| path.into_iter().rev().collect::<Vec<_>>();
    let mut paths: Vec<Vec<GridPoint>> = a.contours().map(|c| c.points().to_vec()).collect();
    paths.extend(b.contours().map(|c| reversed(c.points().to_vec())));
    for bridge in bridges {
        paths.push(reversed(on_grid(&bridge.corners_mm.map(DVec2::from))));
        let pockets = bridge.pockets_mm.iter().map(|pocket| pocket.iter().map(|&p| DVec2::from(p)).collect());
        paths.extend(pockets.map(|pocket: Vec<DVec2>| reversed(on_grid(&pocket))));
    }
    Region::fill(a.grid(), &paths, FillRule::Positive).area_mm2()
}

/// A blob in its own cell of a checkerboard, often with a hole and an island in it.
fn blob() -> impl Strategy<Value = Vec<Vec<DVec2>>> {
    (3.0..6.5f64, 5..40usize, 0.0..6.0f64, 0..3usize, 0.6..1.0f64).prop_map(
        |(radius, n, turn, rings, flat)| {
            let circle = |radius: f64| {
                let at = |i: usize| DVec2::from_angle(turn + i as f64 * std::f64::consts::TAU / n as f64);
                (0..n).map(|i| radius * at(i) * DVec2::new(1.0, flat)).collect::<Vec<_>>()
            };
            (0..=rings).map(|ring| circle(radius * (1.0 - 0.33 * ring as f64))).collect()
        },
    )
}

fn islands() -> impl Strategy<Value = Region> {
    (proptest::collection::vec((any::<bool>(), blob(), -0.8..0.8f64), 12), any::<bool>()).prop_map(
        |(blobs, framed)| {
            let mut paths = Vec::new();
            for (i, (is_there, blob, shift)) in blobs.into_iter().enumerate() {
                let middle = DVec2::new(10.0 + 15.0 * (i % 4) as f64 + shift, 10.0 + 15.0 * (i / 4) as f64);
                if is_there || i == 5 {
                    paths.extend(blob.into_iter().map(|path| path.into_iter().map(|p| p + middle).collect()));
                }
            }
            if framed {
                paths.extend([rectangle(-2.0, -2.0, 69.0, 54.0), rectangle(0.5, 0.5, 64.0, 49.0)]);
            }
            region(&paths)
        },
    )
}

/// The length of the minimum spanning tree of the components' distances, each pair measured by brute force.
fn brute_force_tree(region: &Region) -> f64 {
    let points: Vec<Vec<[DVec2; 2]>> = region
        .parts()
        .iter()
        .map(|part| {
            let edges = part.contours().flat_map(|c| c.edges());
            edges.map(|(a, b)| [a, b].map(|p| region.grid().to_mm(p))).collect()
        })
        .collect();
    let to_edge = |p: DVec2, [a, b]: [DVec2; 2]| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + (b - a) * t).distance(p)
    };
    let distance = |i: usize, j: usize| {
        let one = |x: &[[DVec2; 2]], y: &[[DVec2; 2]]| {
            let pairs = x.iter().flat_map(|e| y.iter().map(|f| to_edge(e[0], *f)));
            pairs.fold(f64::INFINITY, f64::min)
        };
        one(&points[i], &points[j]).min(one(&points[j], &points[i]))
    };
    let mut reached = vec![f64::INFINITY; points.len()];
    let mut inside = vec![false; points.len()];
    reached[0] = 0.0;
    let mut length = 0.0;
    for _ in 0..points.len() {
        let rest = (0..points.len()).filter(|&i| !inside[i]);
        let next = rest.min_by(|&a, &b| reached[a].total_cmp(&reached[b])).unwrap();
        inside[next] = true;
        length += reached[next];
        for (other, reached) in reached.iter_mut().enumerate() {
            *reached = reached.min(distance(next, other));
        }
    }
    length
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Any counts not above those of the region can be had, and nothing else is touched.
    #[test]
    fn counts_come_out_as_wanted(region in islands(), keep in (0.0..1.0f64, 0.0..1.0f64), width in 0.4..1.2f64) {
        let has = Counts::of(&region);
        let part = |n: usize, share: f64| (n as f64 * share) as usize;
        let wanted = counts(1 + part(has.components - 1, keep.0), part(has.holes, keep.1));
        let bridged = bridge(&region, wanted, &options(width)).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!(Counts::of(&bridged.region), wanted);
        let needed = has.components - wanted.components + has.holes - wanted.holes;
        prop_assert_eq!(bridged.bridges.iter().map(|b| b.changes).sum::<usize>(), needed);
        let (struts, slits): (Vec<Bridge>, Vec<Bridge>) =
            bridged.bridges.iter().cloned().partition(|b| b.kind.is_strut());
        prop_assert!(left_over(&bridged.region, &region, &struts) < 1e-6);
        prop_assert!(left_over(&region, &bridged.region, &slits) < 1e-6);
        let changed: f64 = struts.iter().map(|b| b.area_mm2).sum::<f64>()
            - slits.iter().map(|b| b.area_mm2).sum::<f64>();
        prop_assert!((bridged.region.area_mm2() - region.area_mm2() - changed).abs() < 1e-4);
        for b in &bridged.bridges {
            let [c0, c1, _, c3] = b.corners_mm.map(DVec2::from);
            prop_assert!((c0.distance(c3) - b.width_mm).abs() < 1e-9, "a bridge is as wide as it says");
            prop_assert!(b.width_mm > width - 1e-9, "none is narrower than asked for");
            prop_assert!(c0.distance(c1) >= b.length_mm, "its ends are sunk");
            prop_assert!(b.length_mm >= b.least_mm - 1e-9);
        }
        prop_assert_eq!(bridge(&region, wanted, &options(width)).unwrap(), bridged);
    }

    /// The struts lie along a minimum spanning tree of the true distances.
    #[test]
    fn struts_follow_the_minimum_spanning_tree(region in islands()) {
        let wanted = counts(1, region.holes());
        let bridged = bridge(&region, wanted, &options(0.5)).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let least: f64 = bridged.bridges.iter().map(|b| b.least_mm).sum();
        let tree = brute_force_tree(&region);
        prop_assert!((least - tree).abs() < 1e-6, "{} {}", least, tree);
        let length: f64 = bridged.bridges.iter().map(|b| b.length_mm).sum();
        let detour = (1.3 * tree + 0.5 * bridged.bridges.len() as f64) - length;
        prop_assert!(detour >= 0.0, "{} for {}", length, tree);
    }

    /// Struts hold at the machine's width: the joined ink erodes without coming apart.
    #[test]
    fn struts_are_as_wide_as_the_machine_needs(x in 1.0..9.0f64, y in -3.0..3.0f64, feature in 0.5..2.0f64) {
        let two = region(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(10.0 + x, y, 10.0, 10.0)]);
        let machine = BridgeOptions { min_feature_mm: feature, ..options(0.1) };
        let joined = bridge(&two, counts(1, 0), &machine).unwrap();
        prop_assert!(joined.bridges[0].width_mm >= feature);
        prop_assert_eq!(joined.region.offset(-0.5 * feature, 0.01).components(), 1);
    }
}

#[test]
fn a_strut_between_facing_sides_is_square_and_short() {
    let two = region(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(12.0, 3.0, 10.0, 10.0)]);
    let joined = bridge(&two, counts(1, 0), &options(1.0)).unwrap();
    let [strut] = &joined.bridges[..] else { panic!("one strut joins two parts") };
    assert_eq!((strut.kind, strut.least_mm), (BridgeKind::Join, strut.length_mm));
    assert!((strut.area_mm2 - 2.0).abs() < 1e-6, "{strut:?}");
    let [from, to] = [strut.from_mm, strut.to_mm];
    assert!((from[1] - to[1]).abs() < 1e-9 && (3.5..=9.5).contains(&from[1]), "{strut:?}");
}

#[test]
fn an_island_in_a_hole_is_joined_and_the_hole_opened() {
    let eye = region(&[
        rectangle(0.0, 0.0, 20.0, 20.0),
        rectangle(3.0, 3.0, 14.0, 14.0),
        rectangle(7.0, 8.0, 5.0, 5.0),
    ]);
    assert_eq!(Counts::of(&eye), counts(2, 1));
    let open = bridge(&eye, counts(1, 0), &options(1.0)).unwrap();
    let kinds: Vec<BridgeKind> = open.bridges.iter().map(|b| b.kind).collect();
    assert_eq!(kinds, [BridgeKind::Join, BridgeKind::Open]);
    assert_eq!(open.bridges.iter().map(|b| b.length_mm.round()).collect::<Vec<_>>(), [4.0, 3.0]);
}

#[test]
fn bays_are_closed_and_strands_are_cut_when_more_is_wanted() {
    // A comb: two bays 4 mm wide between three teeth on a back.
    let teeth = [0.0, 7.0, 14.0].map(|x| rectangle(x, 2.0, 3.0, 12.0));
    let mut paths = teeth.map(|t| on_grid(&t)).to_vec();
    paths.push(on_grid(&rectangle(0.0, 0.0, 17.0, 3.0)));
    let comb = Region::fill(grid(), &paths, FillRule::NonZero);
    assert_eq!(Counts::of(&comb), counts(1, 0));
    let closed = bridge(&comb, counts(1, 2), &options(1.0)).unwrap();
    assert!(closed.bridges.iter().all(|b| b.kind == BridgeKind::Enclose && (b.length_mm - 4.0).abs() < 1e-6));
    assert_eq!(Counts::of(&closed.region), counts(1, 2));
    let cut = bridge(&comb, counts(3, 0), &options(1.0)).unwrap();
    assert!(cut.bridges.iter().all(|b| b.kind == BridgeKind::Split && (b.length_mm - 3.0).abs() < 1e-6));
    assert_eq!(Counts::of(&cut.region), counts(3, 0));
}

#[test]
fn a_ring_that_must_stay_closed_does() {
    let circle = |r: f64| -> Vec<DVec2> {
        (0..90)
            .map(|i| DVec2::splat(30.0) + r * DVec2::from_angle(f64::from(i) * 4f64.to_radians()))
            .collect()
    };
    // The frame's hole is nearer to the inside of the ring than to anything else.
    let frame = region(&[rectangle(48.5, 28.0, 6.0, 4.0), rectangle(49.5, 29.0, 4.0, 2.0)]);
    let ring = Region::union(grid(), &[region(&[circle(20.0), circle(19.0)]), frame]);
    assert_eq!(Counts::of(&ring), counts(1, 2));
    let middle = DVec2::splat(30.0);
    let closed = BridgeOptions { closed_around: Some(middle), ..options(0.5) };
    let kept = bridge(&ring, counts(1, 1), &closed).unwrap();
    let inside = grid().snap(middle).unwrap();
    assert!(kept.region.contours().any(|c| !c.is_counter_clockwise() && c.contains(inside)));
    let refused = bridge(&ring, counts(1, 0), &closed);
    assert!(matches!(refused, Err(BridgeError::Impossible { .. })), "{refused:?}");
}

#[test]
fn what_is_smaller_than_its_bridge_is_joined() {
    // No machine would show them, but they count: a hole and an island 0.06 mm thick, one of them with a corner nearest.
    let flat = rectangle(9.9, 1.5, 0.2, 0.06);
    let corner: Vec<DVec2> = [(9.9, 1.5), (10.1, 1.5), (10.0, 1.56)].map(DVec2::from).to_vec();
    for speck in [flat, corner] {
        let coarse = BridgeOptions { chord_mm: 0.05, ..options(0.8) };
        let hole = region(&[rectangle(0.0, 0.0, 20.0, 2.0), speck.clone()]);
        let opened = bridge(&hole, counts(1, 0), &coarse).unwrap();
        assert_eq!(Counts::of(&opened.region), counts(1, 0));
        assert!(opened.bridges[0].length_mm < 0.6, "{:?}", opened.bridges);
        let island = region(&[rectangle(0.0, 2.0, 20.0, 2.0), speck]);
        let machine = BridgeOptions { min_feature_mm: 0.8, ..coarse };
        let joined = bridge(&island, counts(1, 0), &machine).unwrap();
        assert!(joined.bridges[0].length_mm < 0.6, "{:?}", joined.bridges);
        assert_eq!(joined.region.offset(-0.4, 0.001).components(), 1);
    }
}

#[test]
fn a_slit_into_a_narrow_drop_severs_nothing() {
    // A drop with walls 0.1 mm thick at the end of a stem, as of a quill: there is hardly room for the slit in it, and
    // walls that are gone when they are eroded hide what it does to them.
    for turn in [0.0, 0.3, 0.7, 1.1, 1.5] {
        let [out, around] = [DVec2::from_angle(turn), DVec2::from_angle(turn).perp()];
        let drop = |wall: f64| -> Vec<DVec2> {
            (0..40)
                .map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 40.0))
                .map(|p| out * (p.x * (0.5 + wall)) + around * (p.y * (0.22 + wall) * (1.3 - 0.5 * p.x)))
                .map(|p| DVec2::splat(40.0) + p)
                .collect()
        };
        let stem = [(0.45, -0.2), (8.0, -0.6), (8.0, 0.6), (0.45, 0.2)];
        let stem: Vec<DVec2> =
            stem.iter().map(|&(x, y)| DVec2::splat(40.0) + out * (x + 0.1) + around * y).collect();
        let hole: Vec<DVec2> = drop(0.0).into_iter().rev().collect();
        let paths = [drop(0.1), stem, hole].map(|path| on_grid(&path));
        let quill = Region::fill(grid(), &paths, FillRule::Positive);
        assert_eq!(Counts::of(&quill), counts(1, 1), "{turn}");
        let opened = bridge(&quill, counts(1, 0), &options(0.8)).unwrap();
        assert_eq!(Counts::of(&opened.region), counts(1, 0));
        // No sliver holds it: it hangs together within the chord error as well.
        assert_eq!(Counts::of(&opened.region.offset(-0.003, 0.0005)), counts(1, 0), "{turn}");
    }
}

#[test]
fn a_contour_that_is_only_touched_is_not_met() {
    let two = region(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(12.0, 0.0, 10.0, 10.0)]);
    let (ground, index) = (ground::Ground::new(&two), crate::planar::EdgeIndex::new(&two));
    let prober = place::Prober { ground: &ground, index: &index, side: Side::Gap, width_mm: 1.0 };
    let corners = |from: f64, to: f64| [(from, 4.0), (to, 4.0), (to, 5.0), (from, 5.0)].map(DVec2::from);
    assert_eq!(prober.met(&corners(9.9, 12.0)), [0]);
    assert_eq!(prober.met(&corners(9.9, 12.1)), [0, 1]);
}

#[test]
fn what_cannot_be_had_is_an_error() {
    let square = region(&[rectangle(0.0, 0.0, 10.0, 10.0)]);
    let wide = bridge(&square, counts(1, 0), &options(0.0)).unwrap_err();
    assert_eq!(wide, BridgeError::Width { found_mm: 0.0 });
    assert!(matches!(bridge(&square, counts(0, 0), &options(1.0)), Err(BridgeError::Impossible { .. })));
    let text = bridge(&square, counts(1, 3), &options(1.0)).unwrap_err().to_string();
    assert!(text.starts_with("0 of 3 missing holes were made by closing bays; there is no place"), "{text}");
    assert_eq!(bridge(&square, counts(1, 0), &options(1.0)).unwrap().region, square);
}

#[test]
fn without_effort_left_the_search_is_given_up_and_says_so() {
    let apart = region(&[rectangle(0.0, 0.0, 10.0, 4.0), rectangle(12.0, 0.0, 10.0, 4.0)]);
    let lay = |effort: &Effort| lay::lay(&apart, BridgeKind::Join, 1, &options(1.0), effort);
    let enough = Effort::new(1);
    assert_eq!(Counts::of(&lay(&enough).unwrap().region), counts(1, 0));
    assert!(!enough.is_spent());
    let spent = Effort::new(1);
    spent.spend(usize::MAX);
    let error = lay(&spent).unwrap_err();
    assert_eq!(error, BridgeError::TooMuch { kind: BridgeKind::Join, done: 0, needed: 1, width_mm: 1.0 });
    assert!(error.to_string().contains("was given up"));
}

#[test]
fn struts_stay_where_they_may_be() {
    // Two bars, and between them a slit that only lets pass what is right of x = 30, or only a part of a strut.
    let bars = region(&[rectangle(2.0, 2.0, 40.0, 4.0), rectangle(2.0, 9.0, 40.0, 4.0)]);
    let ends_at = |x: f64| region(&[rectangle(0.0, 0.0, 50.0, 14.0), rectangle(0.0, 7.0, x, 1.0)]);
    let laid = |domain: &Region| {
        bridge(&bars, counts(1, 0), &BridgeOptions { within: Some(domain), ..options(1.5) })
    };
    let domain = ends_at(30.0);
    let joined = laid(&domain).unwrap();
    assert!(joined.bridges[0].from_mm[0] > 30.0, "{:?}", joined.bridges);
    assert!(joined.region.without(&domain).is_empty());
    // No room for all of its width.
    for x in [41.2, 50.0] {
        assert!(matches!(laid(&ends_at(x)), Err(BridgeError::NoPlace { .. })), "{x}");
    }
    let coarser = Region::fill(Grid::for_extent(3000.0).unwrap(), &[], FillRule::Positive);
    assert!(matches!(laid(&coarser), Err(BridgeError::Impossible { .. })));
}
