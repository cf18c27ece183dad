//! A disc of triangles laid flat.
//!
//! Its border goes on an ellipse, by length; each vertex inside becomes a mean of its neighbours with the weights
//! of Floater 2003 (mean value coordinates), which are positive. By Tutte's theorem (in Floater's form, for convex
//! combinations) no triangle turns over, whatever the disc looks like. That the numbers agree is checked exactly.
//! This is the adapter to the solver. Zhou 2014 §6.3.

use faer::linalg::solvers::Solve;
use faer::prelude::*;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMat, Triplet};
use glam::DVec2;

use super::disc::Disc;
use super::exact::turn;
use super::sides::NONE;

/// The least part of all weights of a vertex that one has. Less, and a vertex at the tip of a sliver depends on one
/// neighbour alone, as far as numbers can tell.
const LEAST_WEIGHT: f64 = 1e-7;

/// Where the vertices of a disc are in the plane, with its border on an ellipse around the origin, counter-clockwise.
#[derive(Debug)]
pub(super) struct Flat {
    pub(super) places: Vec<DVec2>,
}

impl Flat {
    /// Lays out a disc. The border vertex number `start` of its border goes to the end of the long axis of the
    /// ellipse, `half_axes`.
    ///
    /// # Errors
    /// The first triangle that turned over, which happens only where numbers are too coarse for the triangles.
    pub(super) fn of(disc: &Disc, half_axes: DVec2, start: usize) -> Result<Self, usize> {
        let border = on_ellipse(disc, half_axes, start);
        let flipped = |flat: &Self| {
            let corners = |t: &[u32; 3]| t.map(|v| flat.places[v as usize]);
            disc.triangles.iter().map(corners).position(|[a, b, c]| turn(a, b, c) <= 0.0)
        };
        // Where slivers are too thin for their angles, the same weight for all neighbours bends the curve more, but
        // lays it flat too.
        let mut first = 0;
        for weights in [mean_values(disc), uniform(disc)] {
            let Some(flat) = solved(disc, &border, &weights) else { continue };
            match flipped(&flat) {
                None => return Ok(flat),
                Some(triangle) => first = triangle,
            }
        }
        Err(first)
    }
}

/// The weights of neighbours as vertex, neighbour and weight; several for a pair are added.
type Weights = Vec<(u32, u32, f64)>;

fn mean_values(disc: &Disc) -> Weights {
    let mut weights = Weights::with_capacity(6 * disc.triangles.len());
    for triangle in &disc.triangles {
        for i in 0..3 {
            let [v, a, b] = [triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]];
            let [to_a, to_b] = [a, b].map(|n| disc.vertices[n as usize] - disc.vertices[v as usize]);
            let (la, lb) = (to_a.length(), to_b.length());
            // The tangent of half the angle, which is less than a right angle.
            let tangent = to_a.cross(to_b).length() / (la * lb + to_a.dot(to_b));
            weights.extend([(v, a, tangent / la), (v, b, tangent / lb)]);
        }
    }
    let mut most = vec![0.0f64; disc.vertices.len()];
    let finite = |weight: f64| if weight.is_finite() { weight } else { 0.0 };
    for (v, _, weight) in &mut weights {
        *weight = finite(*weight);
        most[*v as usize] = most[*v as usize].max(*weight);
    }
    for (v, _, weight) in &mut weights {
        let most = most[*v as usize];
        *weight = if most > 0.0 { weight.max(LEAST_WEIGHT * most) } else { 1.0 };
    }
    weights
}

fn uniform(disc: &Disc) -> Weights {
    let of = |t: &[u32; 3]| {
        (0..3).flat_map(|i| [(t[i], t[(i + 1) % 3], 1.0), (t[i], t[(i + 2) % 3], 1.0)]).collect()
    };
    disc.triangles.iter().flat_map(|t: &[u32; 3]| -> Weights { of(t) }).collect()
}

/// Solves for the vertices inside; `None` where the numbers fail.
fn solved(disc: &Disc, border: &[(u32, DVec2)], weights: &Weights) -> Option<Flat> {
    let mut places = vec![DVec2::ZERO; disc.vertices.len()];
    let mut free = vec![0; disc.vertices.len()];
    for &(v, place) in border {
        (places[v as usize], free[v as usize]) = (place, NONE);
    }
    let mut count = 0;
    for number in &mut free {
        if *number != NONE {
            *number = count;
            count += 1;
        }
    }
    if count == 0 {
        return Some(Flat { places });
    }
    let mut sums = vec![0.0; disc.vertices.len()];
    for &(v, _, weight) in weights {
        sums[v as usize] += weight;
    }
    let mut entries: Vec<Triplet<usize, usize, f64>> =
        (0..count as usize).map(|row| Triplet::new(row, row, 1.0)).collect();
    let mut right = Mat::<f64>::zeros(count as usize, 2);
    for &(v, n, weight) in weights.iter().filter(|(v, _, _)| free[*v as usize] != NONE) {
        let (row, part) = (free[v as usize] as usize, weight / sums[v as usize]);
        if free[n as usize] == NONE {
            right[(row, 0)] += part * places[n as usize].x;
            right[(row, 1)] += part * places[n as usize].y;
        } else {
            entries.push(Triplet::new(row, free[n as usize] as usize, -part));
        }
    }
    let matrix =
        SparseColMat::<usize, f64>::try_new_from_triplets(count as usize, count as usize, &entries).ok()?;
    let symbolic = SymbolicLu::try_new(matrix.symbolic()).ok()?;
    let lu = Lu::try_new_with_symbolic(symbolic, matrix.as_ref()).ok()?;
    lu.solve_in_place(&mut right);
    for (place, row) in places.iter_mut().zip(&free).filter(|(_, row)| **row != NONE) {
        *place = DVec2::new(right[(*row as usize, 0)], right[(*row as usize, 1)]);
    }
    Some(Flat { places })
}

/// The vertices of the border on an ellipse, as far from each other along it as they are along the border.
fn on_ellipse(disc: &Disc, half_axes: DVec2, start: usize) -> Vec<(u32, DVec2)> {
    /// Steps in which the ellipse is measured; between them the angle is taken to grow evenly.
    const STEPS: usize = 4096;
    let at = |angle: f64| half_axes * DVec2::from_angle(angle);
    let angle = |step: f64| std::f64::consts::TAU * step / STEPS as f64;
    let mut along = vec![0.0];
    for step in 0..STEPS {
        along.push(along[step] + at(angle(step as f64)).distance(at(angle(step as f64 + 1.0))));
    }
    let n = disc.border.len();
    let border = |i: usize| disc.border[(start + i) % n];
    let place = |i: usize| disc.vertices[border(i) as usize];
    let mut lengths = vec![0.0];
    for i in 0..n {
        lengths.push(lengths[i] + place(i).distance(place(i + 1)));
    }
    let vertex = |i: usize| {
        let length = along[STEPS] * lengths[i] / lengths[n];
        let step = along.partition_point(|&l| l <= length).clamp(1, STEPS) - 1;
        let part = (length - along[step]) / (along[step + 1] - along[step]);
        (border(i), at(angle(step as f64 + part)))
    };
    (0..n).map(vertex).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{blob, clean, grid};
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn areas(disc: &Disc, flat: &Flat) -> Vec<f64> {
        let corners = |t: &[u32; 3]| t.map(|v| flat.places[v as usize]);
        disc.triangles.iter().map(corners).map(|[a, b, c]| turn(a, b, c)).collect()
    }

    #[test]
    fn a_flat_ellipse_stays_as_it_is() {
        // Mean values reproduce what is linear: of a plane sheet with its border on the ellipse, the sheet itself.
        let mesh = clean(grid([16, 16], [false; 2], |p| {
            let p = 2.0 * p - 1.0;
            // A square pressed into a circle.
            let round =
                DVec2::new(p.x * (1.0 - 0.5 * p.y * p.y).sqrt(), p.y * (1.0 - 0.5 * p.x * p.x).sqrt());
            round.extend(0.0)
        }));
        let all: Vec<u32> = (0..mesh.vertices_mm().len() as u32).collect();
        let disc = Disc::around(&mesh, &all).unwrap();
        let start =
            (0..disc.border.len()).find(|&i| disc.vertices[disc.border[i] as usize].x > 0.9999).unwrap();
        let flat = Flat::of(&disc, DVec2::ONE, start).unwrap();
        for (place, wanted) in flat.places.iter().zip(&disc.vertices) {
            assert!(place.distance(wanted.truncate()) < 0.01, "{place} {wanted}");
        }
    }

    #[test]
    fn holes_are_laid_flat_too() {
        // A bent sheet with three holes, each closed by a fan.
        let sheet = grid([12, 12], [false; 2], |p| (40.0 * p).extend(20.0 * p.x * p.y * p.y));
        let is_hole = |cell: usize| [27, 28, 39, 66, 101].contains(&cell);
        let kept = sheet.into_iter().enumerate().filter(|(i, _)| !is_hole(i / 2)).map(|(_, facet)| facet);
        let mesh = clean(kept.collect());
        let all: Vec<u32> = (0..mesh.vertices_mm().len() as u32).collect();
        let disc = Disc::around(&mesh, &all).unwrap();
        assert_eq!(disc.middles.len(), 3);
        let flat = Flat::of(&disc, DVec2::new(2.0, 1.0), 5).unwrap();
        assert!(areas(&disc, &flat).iter().all(|&area| area > 0.0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_triangle_turns_over(
            amounts in prop::array::uniform3(-0.2..0.2f64),
            at in prop::array::uniform3(-1.0..1.0f64),
            reach in 5.0..70.0f64,
            half in 1.0..8.0f64,
        ) {
            let mesh = blob(8, amounts);
            let Some(place) = mesh.nearest_anywhere(DVec3::from(at) * 40.0) else { return Ok(()) };
            let from = mesh.triangles()[place.facet];
            let near: Vec<u32> = mesh.within(&from, reach, usize::MAX).into_iter().map(|(v, _)| v).collect();
            let Ok(disc) = Disc::around(&mesh, &near) else { return Ok(()) };
            let flat = Flat::of(&disc, DVec2::new(half, 1.0), 0).unwrap();
            prop_assert!(areas(&disc, &flat).iter().all(|&area| area > 0.0));
        }
    }
}
