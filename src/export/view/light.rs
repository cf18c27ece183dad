//! Light: a lamp with a soft edge and a bright sky, each made of directions that are looked along.
//!
//! Seen from a direction that light comes from, a point is lit if nothing is nearer. So every direction has a depth
//! picture of its own, and what share of the sky a point sees is how many of them it is nearest in. That gives the
//! soft shade in corners and under a part that tells a person what lies above what.

use glam::{DVec2, DVec3};

use super::camera::{Camera, Raster};
use super::depth::Depths;

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

/// The light at every place of a scene made of `triangles`.
pub(super) fn light(triangles: &[[DVec3; 3]], places: &[Place]) -> Vec<Light> {
    let mut light = vec![Light::default(); places.len()];
    let lamp = lamp().map(|direction| (direction, true));
    for (direction, is_lamp) in lamp.chain(sky().map(|direction| (direction, false))) {
        let depths = Depths::seen_from(triangles, direction);
        let lift = LIFT / depths.1.raster.scale;
        for (place, light) in places.iter().zip(&mut light) {
            let angle = place.normal.dot(direction) as f32;
            if angle <= 0.0 {
                continue;
            }
            let is_lit = is_lit(&depths, place.at + lift * (place.normal + direction), lift);
            match is_lamp {
                true => light.lamp += f32::from(u8::from(is_lit)) * angle / LAMP as f32,
                false => {
                    light.sky += f32::from(u8::from(is_lit)) * angle;
                    light.open_sky += angle;
                }
            }
        }
    }
    light
}

fn is_lit((camera, depths): &(Camera, Depths), at: DVec3, lift: f64) -> bool {
    let seen = camera.of(at);
    let cell = depths.raster.cell(seen.truncate());
    cell.is_none_or(|cell| f64::from(depths.nearest[cell]) <= seen.z + lift)
}

impl Depths {
    /// The scene as the light sees it, with the frame of that.
    fn seen_from(triangles: &[[DVec3; 3]], direction: DVec3) -> (Camera, Self) {
        let camera = Camera::of_light(direction);
        let flat = triangles.iter().flatten().map(|&p| camera.of(p).truncate());
        let (low, high) =
            flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let raster = Raster::new(low, high, CELLS);
        (camera, Self::new(triangles, &camera, raster))
    }
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
