//! Light: a lamp with a soft edge and a bright sky, each made of directions that are looked along.
//!
//! Seen from a direction that light comes from, a point is lit if nothing is nearer. So every direction has a depth
//! picture of its own, and what share of the sky a point sees is how many of them it is nearest in. That gives the
//! soft shade in corners and under a part that tells a person what lies above what. Shadows of the lamp have an edge to
//! be seen; the sky has none, so it is looked for at fewer places and in coarser pictures.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec2, DVec3};

use super::camera::{Camera, Raster};
use super::depth::draw;
use crate::planar::threads;

/// Directions of the sky.
const SKY: usize = 24;
/// Directions of the lamp.
const LAMP: usize = 6;
/// Cells along the longer side of a depth picture, for the sky and for the lamp.
const SKY_CELLS: usize = 900;
const LAMP_CELLS: usize = 1400;
/// Half the angle at which the lamp is seen, as a tangent.
const LAMP_SPREAD: f64 = 0.06;
/// Where the lamp is: up, left and in front.
const LAMP_AT: DVec3 = DVec3::new(-0.45, -0.35, 0.82);
/// How far off the surface a point is taken, in cells of a depth picture: a surface is not to shade itself.
const LIFT: f64 = 1.5;

/// A point of a surface, and where it looks to.
pub(super) struct Place {
    pub(super) at: DVec3,
    pub(super) normal: DVec3,
}

/// What reaches each place of the lamp, from 0 to 1, with the angle at which it falls. The scene is made of `triangles`.
pub(super) fn lamp_light(triangles: &[[DVec3; 3]], places: &[Place]) -> Vec<f32> {
    let directions: Vec<DVec3> = lamp().collect();
    let lit = lit(triangles, places, &directions, LAMP_CELLS);
    let falls = |(place, lit)| falling(place, &directions, lit) / LAMP as f32;
    places.iter().zip(lit).map(falls).collect()
}

/// The part of the sky above each place that is seen from there, from 0 to 1, all by the angle at which it shines.
pub(super) fn open_sky(triangles: &[[DVec3; 3]], places: &[Place]) -> Vec<f32> {
    let directions: Vec<DVec3> = sky().collect();
    let lit = lit(triangles, places, &directions, SKY_CELLS);
    let open = |(place, lit)| match falling(place, &directions, Lit::MAX) {
        0.0 => 0.0,
        whole => falling(place, &directions, lit) / whole,
    };
    places.iter().zip(lit).map(open).collect()
}

/// From which directions light reaches a place: a bit for each.
type Lit = u32;

/// The light that falls on a place from those directions from which it does.
fn falling(place: &Place, directions: &[DVec3], lit: Lit) -> f32 {
    let falls = directions.iter().enumerate().filter(|(number, _)| lit >> number & 1 == 1);
    falls.map(|(_, direction)| place.normal.dot(*direction).max(0.0) as f32).sum()
}

/// From which of the directions light reaches each place; the same whatever the number of threads that look for it.
fn lit(triangles: &[[DVec3; 3]], places: &[Place], directions: &[DVec3], cells: usize) -> Vec<Lit> {
    let threads = threads().min(directions.len());
    let next = AtomicUsize::new(0);
    let look = || lit_from(triangles, places, directions, cells, &next);
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(look)).collect();
        let mut lit = look();
        for other in others {
            let theirs = other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            lit.iter_mut().zip(theirs).for_each(|(lit, theirs)| *lit |= theirs);
        }
        lit
    })
}

/// Looks along one direction after the other, leaving out those that somebody else has taken.
fn lit_from(
    triangles: &[[DVec3; 3]],
    places: &[Place],
    directions: &[DVec3],
    cells: usize,
    next: &AtomicUsize,
) -> Vec<Lit> {
    let mut lit: Vec<Lit> = vec![0; places.len()];
    let mut nearest = Vec::new();
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let Some(&direction) = directions.get(number) else { return lit };
        let (camera, raster) = seen_from(triangles, direction, cells);
        nearest.clear();
        nearest.resize(raster.cells(), f32::NEG_INFINITY);
        draw(triangles, &camera, &raster, |cell, z, _| nearest[cell] = nearest[cell].max(z));
        let lift = LIFT / raster.scale;
        for (place, lit) in places.iter().zip(&mut lit) {
            if place.normal.dot(direction) <= 0.0 {
                continue;
            }
            // Off the surface along its normal and towards the light, and as much for what one cell may span.
            let seen = camera.of(place.at + lift * place.normal);
            let cell = raster.cell(seen.truncate());
            let is_lit = cell.is_none_or(|cell| f64::from(nearest[cell]) <= seen.z + 2.0 * lift);
            *lit |= Lit::from(is_lit) << number;
        }
    }
}

/// The frame in which light from a direction sees the scene.
fn seen_from(triangles: &[[DVec3; 3]], direction: DVec3, cells: usize) -> (Camera, Raster) {
    let camera = Camera::of_light(direction);
    let flat = triangles.iter().flatten().map(|&p| camera.of(p).truncate());
    let (low, high) =
        flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    (camera, Raster::new(low, high, cells))
}

/// Directions spread evenly over the half of the sphere that looks up, none of them level.
fn sky() -> impl Iterator<Item = DVec3> {
    (0..SKY).map(|i| {
        let z = (i as f64 + 0.5) / SKY as f64 * 0.9 + 0.1;
        let around = DVec2::from_angle(i as f64 * golden_angle());
        (around * (1.0 - z * z).sqrt()).extend(z)
    })
}

/// Directions spread evenly over the disc of the lamp.
fn lamp() -> impl Iterator<Item = DVec3> {
    let frame = Camera::of_light(LAMP_AT);
    (0..LAMP).map(move |i| {
        let radius = LAMP_SPREAD * ((i as f64 + 0.5) / LAMP as f64).sqrt();
        let at = radius * DVec2::from_angle(i as f64 * golden_angle());
        frame.back(at.extend(1.0)).normalize()
    })
}

fn golden_angle() -> f64 {
    std::f64::consts::PI * (3.0 - 5f64.sqrt())
}

/// The direction of the middle of the lamp.
pub(super) fn towards_lamp() -> DVec3 {
    LAMP_AT.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 2, looking up, around a point.
    fn tile(at: DVec3) -> [[DVec3; 3]; 2] {
        let [a, b, c, d] =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| at + DVec3::new(x, y, 0.0));
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn what_lies_under_something_is_in_the_shade() {
        let mut triangles = Vec::new();
        triangles.extend(tile(DVec3::ZERO));
        triangles.extend(tile(DVec3::new(40.0, 0.0, 0.0)));
        // A roof over the first, which its underside makes one.
        triangles.extend(tile(DVec3::new(0.0, 0.0, 0.5)));
        let place = |x: f64| Place { at: DVec3::new(x, 0.0, 0.0), normal: DVec3::Z };
        let places = [place(0.0), place(40.0)];
        let (lamp, open) = (lamp_light(&triangles, &places), open_sky(&triangles, &places));
        assert!(lamp[0] == 0.0 && open[0] < 0.4, "{} {}", lamp[0], open[0]);
        assert!(lamp[1] > 0.8 && open[1] == 1.0, "{} {}", lamp[1], open[1]);
    }

    #[test]
    fn directions_are_unit_and_look_up() {
        for direction in sky().chain(lamp()) {
            assert!((direction.length() - 1.0).abs() < 1e-12 && direction.z > 0.05, "{direction}");
        }
    }
}
