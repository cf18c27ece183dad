//! Unions, differences and intersections of random solids: sound on reading, and adding up.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use openwork::export;
use openwork::fabricate::{FabricateError, Sheet, Solid, difference, extrude, intersection, union, wrap};
use openwork::planar::{FillRule, Grid, Region};
use openwork::verify::read_stl;
use proptest::prelude::*;

/// Rectangles as (x, y, width, height), every second one over another a gap.
fn rectangles(boxes: &[(f64, f64, f64, f64)]) -> Region {
    let grid = Grid::for_extent(400.0).unwrap();
    let corners = |&(x, y, w, h): &(f64, f64, f64, f64)| {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
            .map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap())
            .to_vec()
    };
    Region::fill(grid, &boxes.iter().map(corners).collect::<Vec<_>>(), FillRule::EvenOdd)
}

fn cuboid([w, d, h]: [f64; 3]) -> Solid {
    extrude(&rectangles(&[(0.0, 0.0, w, d)]), h).unwrap()
}

/// A flat ring.
fn ring(outer: f64, inner: f64, height: f64, corners: usize) -> Solid {
    let grid = Grid::for_extent(400.0).unwrap();
    let circle = |radius: f64| {
        let corner = |i| DVec2::from_angle(TAU * i as f64 / corners as f64) * radius;
        (0..corners).map(|i| grid.snap(corner(i)).unwrap()).collect::<Vec<_>>()
    };
    extrude(&Region::fill(grid, &[circle(outer), circle(inner)], FillRule::EvenOdd), height).unwrap()
}

/// A ladder laid around a cylinder of that radius and closed: a band of as many holes as it has rungs.
fn hoop(radius: f64, rungs: usize, thickness: f64) -> Solid {
    let length = TAU * radius;
    let pitch = length / rungs as f64;
    let gaps = (0..rungs).map(|i| ((i as f64 + 0.25) * pitch, 2.0, 0.5 * pitch, 4.0));
    let whole = [(0.0, 0.0, length, 8.0)].into_iter().chain(gaps).collect::<Vec<_>>();
    let lines: Vec<f64> = (0..=64).map(|i| length * f64::from(i) / 64.0).collect();
    let place = |p: DVec2, side: usize| {
        let round = DVec2::from_angle(p.x / radius) * (radius + side as f64 * thickness);
        round.extend(p.y)
    };
    wrap(
        &rectangles(&whole),
        &Sheet { place: &place, lines_mm: &lines, levels_mm: &[], is_joined: true, chord_mm: 0.05 },
    )
    .unwrap()
}

fn shape() -> impl Strategy<Value = Solid> {
    let size = || 2.0..30.0f64;
    prop_oneof![
        (size(), size(), size()).prop_map(|(w, d, h)| cuboid([w, d, h])),
        (8.0..20.0f64, 0.2..0.9f64, 1.0..8.0f64, 5usize..90).prop_map(|(r, q, h, n)| ring(r, r * q, h, n)),
        (8.0..20.0f64, 3usize..12, 0.5..3.0f64).prop_map(|(r, n, t)| hoop(r, n, t)),
    ]
}

fn motion() -> impl Strategy<Value = DAffine3> {
    let axis =
        (-1.0..1.0f64, -1.0..1.0f64, 0.1..1.0f64).prop_map(|(x, y, z)| DVec3::new(x, y, z).normalize());
    let place = (-12.0..12.0f64, -12.0..12.0f64, -12.0..12.0f64).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    (axis, 0.0..TAU, place, any::<bool>()).prop_map(|(axis, angle, place, mirrors)| {
        let mirror = DMat3::from_diagonal(DVec3::new(if mirrors { -1.0 } else { 1.0 }, 1.0, 1.0));
        DAffine3::from_mat3_translation(DMat3::from_quat(DQuat::from_axis_angle(axis, angle)) * mirror, place)
    })
}

/// Shells less genus, which is χ of the body, once the solid was written, read again and found sound.
fn euler(solid: &Solid) -> i64 {
    let report = read_stl(&export::stl(solid, "").unwrap()).unwrap();
    assert_eq!(report.faults, []);
    assert_eq!((report.shells.len(), report.genus), (solid.shells().len(), solid.genus() as i64));
    report.shells.len() as i64 - report.genus
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_two_solids_have_adds_up(a in shape(), b in shape(), motion in motion()) {
        let b = b.moved(&motion).unwrap();
        let [both, any, rest] = [intersection(&a, &b), union(&[&a, &b]), difference(&a, &b)].map(Result::unwrap);
        let [a_euler, b_euler, both_euler, any_euler, _] = [&a, &b, &both, &any, &rest].map(euler);
        prop_assert_eq!(any_euler, a_euler + b_euler - both_euler);
        let of = Solid::volume_mm3;
        let near = |x: f64, y: f64| (x - y).abs() < 1e-4 * (of(&a) + of(&b));
        prop_assert!(near(of(&any), of(&a) + of(&b) - of(&both)), "{} {}", of(&any), of(&both));
        prop_assert!(near(of(&rest), of(&a) - of(&both)), "{} {}", of(&rest), of(&both));
        // What is in one of them only is what is in any and not in both.
        let other = difference(&b, &a).unwrap();
        prop_assert!(near(of(&rest) + of(&other) + of(&both), of(&any)));
        prop_assert_eq!(&any, &union(&[&a, &b]).unwrap());
    }

    #[test]
    fn moved_solids_keep_their_shape(solid in shape(), motion in motion()) {
        let moved = solid.moved(&motion).unwrap();
        prop_assert_eq!(euler(&moved), euler(&solid));
        prop_assert!((moved.volume_mm3() / solid.volume_mm3() - 1.0).abs() < 1e-4);
    }

    /// On a coarse lattice faces lie on each other and edges meet all the time.
    #[test]
    fn solids_on_a_lattice_are_sound_or_refused(
        boxes in prop::collection::vec((0..4i8, 0..4i8, 0..4i8, 1..4i8, 1..4i8, 1..4i8), 2..6)
    ) {
        let solids: Vec<Solid> = boxes.iter().map(|&(x, y, z, w, d, h)| {
            let place = DVec3::new(x.into(), y.into(), z.into());
            cuboid([w, d, h].map(f64::from)).moved(&DAffine3::from_translation(place)).unwrap()
        }).collect();
        let cells = |(x, y, z, w, d, h): Box6| {
            (x..x + w).flat_map(move |x| (y..y + d).flat_map(move |y| (z..z + h).map(move |z| [x, y, z])))
        };
        let filled: BTreeSet<[i8; 3]> = boxes.iter().copied().flat_map(cells).collect();
        let whole = union(&solids.iter().collect::<Vec<_>>());
        if is_manifold(&filled) {
            let whole = whole.unwrap();
            euler(&whole);
            prop_assert!((whole.volume_mm3() - filled.len() as f64).abs() < 1e-6);
        } else {
            // What only touches may be told apart by chance, but not written as one.
            let error = whole.map(|whole| { euler(&whole); });
            let is_told = matches!(error, Ok(()) | Err(FabricateError::Facets { .. } | FabricateError::Rounding { .. }));
            prop_assert!(is_told);
        }
    }
}

/// A corner and sizes.
type Box6 = (i8, i8, i8, i8, i8, i8);

/// Whether cells nowhere touch along an edge or in a corner only: around each corner of the lattice the filled cells are
/// joined by faces, and so are the empty ones, and around each edge too.
fn is_manifold(filled: &BTreeSet<[i8; 3]>) -> bool {
    let around = |[x, y, z]: [i8; 3]| {
        (0..8u8)
            .map(|i| filled.contains(&[x - i as i8 % 2, y - i as i8 / 2 % 2, z - i as i8 / 4]))
            .collect::<Vec<_>>()
    };
    let corners = (0..9).flat_map(|x| (0..9).flat_map(move |y| (0..9).map(move |z| [x, y, z])));
    corners.map(around).all(|cells| {
        let is_joined = |kind: bool| {
            let of_kind: Vec<usize> = (0..8).filter(|&i| cells[i] == kind).collect();
            let mut reached: Vec<usize> = of_kind.iter().take(1).copied().collect();
            let mut next = 0;
            while next < reached.len() {
                let beside = [1, 2, 4].map(|bit| reached[next] ^ bit);
                reached.extend(
                    beside
                        .into_iter()
                        .filter(|&i| cells[i] == kind && !reached.contains(&i))
                        .collect::<Vec<_>>(),
                );
                next += 1;
            }
            reached.len() == of_kind.len()
        };
        let crossed = |i: usize, [a, b]: [usize; 2]| {
            cells[i] == cells[i ^ a ^ b] && cells[i] != cells[i ^ a] && cells[i] != cells[i ^ b]
        };
        let edges = [[1, 2], [1, 4], [2, 4]];
        is_joined(true) && is_joined(false) && !edges.iter().any(|&pair| (0..8).any(|i| crossed(i, pair)))
    })
}

#[test]
fn many_solids_become_one() {
    let spokes: Vec<Solid> = (0..24)
        .map(|i| {
            let turn = DAffine3::from_rotation_z(TAU * f64::from(i) / 24.0);
            cuboid([40.0, 2.0, 3.0]).moved(&turn).unwrap()
        })
        .chain([ring(42.0, 38.0, 3.0, 180), ring(22.0, 20.0, 3.0, 90)])
        .collect();
    let wheel = union(&spokes.iter().collect::<Vec<_>>()).unwrap();
    // The hub is whole; between spokes there is a gap within the small ring and one within the large.
    assert_eq!((wheel.shells().len(), wheel.genus()), (1, 48));
    assert_eq!(euler(&wheel), 1 - 48);
}

#[test]
fn what_is_apart_stays_apart() {
    let (a, far) = (cuboid([2.0; 3]), DAffine3::from_translation(DVec3::splat(5.0)));
    let b = a.moved(&far).unwrap();
    assert_eq!(union(&[&a, &b]).unwrap().shells().len(), 2);
    assert_eq!(intersection(&a, &b).unwrap().shells().len(), 0);
    assert_eq!(difference(&a, &a).unwrap().shells().len(), 0);
    assert_eq!(union(&[]).unwrap().volume_mm3(), 0.0);
    // A cavity is a shell of its own.
    let hollow =
        difference(&cuboid([9.0; 3]), &a.moved(&DAffine3::from_translation(DVec3::splat(3.0))).unwrap());
    let hollow = hollow.unwrap();
    assert_eq!((hollow.shells().len(), hollow.genus()), (2, 0));
}

#[test]
fn a_motion_that_flattens_is_refused() {
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(cuboid([2.0; 3]).moved(&flat), Err(FabricateError::Motion));
    let nowhere = DAffine3::from_translation(DVec3::NAN);
    assert_eq!(cuboid([2.0; 3]).moved(&nowhere), Err(FabricateError::Motion));
}
