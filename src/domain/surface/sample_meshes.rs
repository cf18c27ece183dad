//! Models for the tests of this folder.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::mesh::Mesh;

pub(in super::super) type Facet = [[f32; 3]; 3];

/// A ball of twenty triangles, each cut into `frequency`² on the sphere, whose vertices are then moved by `shape`.
pub(in super::super) fn ball(frequency: u32, shape: impl Fn(DVec3) -> DVec3) -> Vec<Facet> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { 1.0 } else { -1.0 };
        let (x, y) = (sign(1), golden * sign(2));
        [DVec3::new(0.0, x, y), DVec3::new(x, y, 0.0), DVec3::new(y, 0.0, x)][(i / 4) as usize]
    };
    let corners: Vec<DVec3> = (0..12).map(corner).collect();
    let is_edge = |a: usize, b: usize| (corners[a].distance(corners[b]) - 2.0).abs() < 1e-9;
    let mut facets = Vec::new();
    let mut known: FxHashMap<[i64; 3], [f32; 3]> = FxHashMap::default();
    for (a, b, c) in (0..12).flat_map(|a| (0..12).flat_map(move |b| (0..12).map(move |c| (a, b, c)))) {
        let outside = corners[a].dot(corners[b].cross(corners[c])) > 0.0;
        if !(a < b && a < c && outside && is_edge(a, b) && is_edge(b, c) && is_edge(c, a)) {
            continue;
        }
        let mut at = |i: u32, j: u32| {
            let [i, j, n] = [i, j, frequency].map(f64::from);
            let p = (corners[a] * (n - i - j) + corners[b] * i + corners[c] * j).normalize();
            // The same place of two of the twenty differs in the last digits.
            let key = (p * 1e8).round().to_array().map(|x| x as i64);
            *known.entry(key).or_insert_with(|| shape(p).as_vec3().to_array())
        };
        for (i, j) in (0..frequency).flat_map(|i| (0..frequency - i).map(move |j| (i, j))) {
            facets.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < frequency {
                facets.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    facets
}

/// A grid of `counts` cells, open or closed in each direction, whose corners `shape` takes from the unit square.
pub(in super::super) fn grid(
    counts: [u32; 2],
    is_closed: [bool; 2],
    shape: impl Fn(DVec2) -> DVec3,
) -> Vec<Facet> {
    let at = |i: u32, j: u32| {
        let wrap = |i: u32, axis: usize| if is_closed[axis] { i % counts[axis] } else { i };
        let place = |i: u32, axis: usize| f64::from(wrap(i, axis)) / f64::from(counts[axis]);
        shape(DVec2::new(place(i, 0), place(j, 1))).as_vec3().to_array()
    };
    let cells = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A ring around the z axis, with one handle.
pub(in super::super) fn torus(counts: [u32; 2], radius: f64, tube: f64) -> Vec<Facet> {
    grid(counts, [true, true], |p| {
        let ((s, c), (ts, tc)) = ((TAU * p.x).sin_cos(), (TAU * p.y).sin_cos());
        DVec3::new((radius + tube * tc) * c, (radius + tube * tc) * s, tube * ts)
    })
}

/// A tube around the z axis from z = 0 to `height`, open at both ends, with its radius at each height from 0 to 1.
pub(in super::super) fn tube(counts: [u32; 2], height: f64, radius: impl Fn(f64) -> f64) -> Vec<Facet> {
    grid(counts, [true, false], |p| {
        let (s, c) = (TAU * p.x).sin_cos();
        DVec3::new(radius(p.y) * c, radius(p.y) * s, height * p.y)
    })
}

/// A ball of 30 mm radius, pressed and pulled by waves of `amounts`.
pub(in super::super) fn blob(frequency: u32, amounts: [f64; 3]) -> Mesh {
    let facets = ball(frequency, |p| {
        let waves = amounts[0] * (3.0 * p.x + p.y).sin() + amounts[1] * (2.0 * p.y - 3.0 * p.z).cos();
        p * 30.0 * (1.0 + waves + amounts[2] * p.x * p.z)
    });
    clean(facets)
}

/// A model that needs no repair.
pub(in super::super) fn clean(facets: Vec<Facet>) -> Mesh {
    let (mesh, repairs) = Mesh::new(facets).expect("a surface");
    assert!(repairs.is_empty(), "{repairs:?}");
    mesh
}
