//! Light: a lamp with a soft edge and a bright sky, each made of directions that are looked along.
//!
//! Seen from a direction that light comes from, a point is lit if nothing is nearer. So every direction has a depth
//! picture of its own, and what share of the sky a point sees is how many of them it is nearest in. That gives the
//! soft shade in corners and under a part that tells a person what lies above what.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec2, DVec3};

use super::camera::{Camera, Raster};
use super::depth::draw;

/// Cells along the longer side of a depth picture.
const CELLS: usize = 1400;
/// Directions of the sky.
const SKY: usize = 24;
/// Directions of the lamp.
const LAMP: usize = 6;
/// Half the angle at which the lamp is seen, as a tangent.
const LAMP_SPREAD: f64 = 0.06;
/// Where the lamp is: up, left and in front.
const LAMP_AT: DVec3 = DVec3::new(-0.45, -0.35, 0.82);
/// How far off the surface a point is taken, in cells of a depth picture: a surface is not to shade itself.
const LIFT: f64 = 1.5;

/// What reaches a point, each from 0 to 1.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Light {
    /// Of the lamp, with the angle at which it falls.
    pub(super) lamp: f32,
    /// Of the sky.
    pub(super) sky: f32,
    /// What the sky would be with nothing in the way.
    open_sky: f32,
}

impl Light {
    /// The part of the sky that is seen.
    pub(super) fn openness(&self) -> f32 {
        if self.open_sky > 0.0 { self.sky / self.open_sky } else { 0.0 }
    }
}

/// A point of a surface, and where it looks to.
pub(super) struct Place {
    pub(super) at: DVec3,
    pub(super) normal: DVec3,
}

/// The light at every place of a scene made of `triangles`. The same whatever the number of threads that look for it.
pub(super) fn light(triangles: &[[DVec3; 3]], places: &[Place]) -> Vec<Light> {
    let directions: Vec<DVec3> = lamp().chain(sky()).collect();
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get).min(directions.len());
    let next = AtomicUsize::new(0);
    let lit: Vec<Vec<Lit>> = std::thread::scope(|scope| {
        let look = || lit_from(triangles, places, &directions, &next);
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(look)).collect();
        let own = look();
        let others =
            others.into_iter().map(|other| other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        std::iter::once(own).chain(others).collect()
    });
    let light = |(number, place): (usize, &Place)| {
        let lit = lit.iter().fold(0, |all, lit| all | lit[number]);
        Light::of(place, lit, &directions)
    };
    places.iter().enumerate().map(light).collect()
}

/// From which directions light reaches a place: a bit for each, the lamp first.
type Lit = u32;

impl Light {
    fn of(place: &Place, lit: Lit, directions: &[DVec3]) -> Self {
        let mut light = Self::default();
        for (number, direction) in directions.iter().enumerate() {
            let angle = place.normal.dot(*direction) as f32;
            if angle <= 0.0 {
                continue;
            }
            let falls = if lit >> number & 1 == 1 { angle } else { 0.0 };
            if number < LAMP {
                light.lamp += falls / LAMP as f32;
            } else {
                light.sky += falls;
                light.open_sky += angle;
            }
        }
        light
    }
}

/// Looks along one direction after the other, as long as nobody else does.
fn lit_from(
    triangles: &[[DVec3; 3]],
    places: &[Place],
    directions: &[DVec3],
    next: &AtomicUsize,
) -> Vec<Lit> {
    let mut lit: Vec<Lit> = vec![0; places.len()];
    let mut nearest = Vec::new();
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let Some(&direction) = directions.get(number) else { return lit };
        let (camera, raster) = seen_from(triangles, direction);
        nearest.clear();
        nearest.resize(raster.cells(), f32::NEG_INFINITY);
        draw(triangles, &camera, &raster, |cell, z, _| nearest[cell] = nearest[cell].max(z));
        let lift = LIFT / raster.scale;
        for (place, lit) in places.iter().zip(&mut lit) {
            if place.normal.dot(direction) as f32 <= 0.0 {
                continue;
            }
            let seen = camera.of(place.at + lift * (place.normal + direction));
            let cell = raster.cell(seen.truncate());
            let is_lit = cell.is_none_or(|cell| f64::from(nearest[cell]) <= seen.z + lift);
            *lit |= Lit::from(is_lit) << number;
        }
    }
}

/// The frame in which light from a direction sees the scene.
fn seen_from(triangles: &[[DVec3; 3]], direction: DVec3) -> (Camera, Raster) {
    let camera = Camera::of_light(direction);
    let flat = triangles.iter().flatten().map(|&p| camera.of(p).truncate());
    let (low, high) =
        flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    (camera, Raster::new(low, high, CELLS))
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
        let light = light(&triangles, &[place(0.0), place(40.0)]);
        assert_eq!(light[0].lamp, 0.0);
        assert!(light[0].openness() < 0.4, "{:?}", light[0]);
        assert!(light[1].lamp > 0.8 && light[1].openness() == 1.0, "{:?}", light[1]);
    }

    #[test]
    fn directions_are_unit_and_look_up() {
        for direction in sky().chain(lamp()) {
            assert!((direction.length() - 1.0).abs() < 1e-12 && direction.z > 0.05, "{direction}");
        }
    }
}
