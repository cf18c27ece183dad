//! Where the copies of a part are.
//!
//! A part is made at its own origin. It is placed once, in a fixed order, and what comes of it is repeated. Excluded: whether copies
//! meet ([`super::joint`]).

use glam::{DAffine3, DVec3};
use serde::{Deserialize, Serialize};

use crate::fabricate::Solid;

/// An axis of space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Axis {
    /// To the right.
    X,
    /// To the back.
    Y,
    /// Up.
    Z,
}

impl Axis {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its name, as it is typed.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }

    /// One millimetre along it.
    fn unit(self) -> DVec3 {
        DVec3::AXES[self as usize]
    }

    /// The mirror in the plane through the origin that it is perpendicular to.
    fn mirror(self) -> DAffine3 {
        DAffine3::from_scale(DVec3::ONE - 2.0 * self.unit())
    }
}

/// How a part is placed: first centred, then scaled, mirrored, turned about x, about y and about z, and moved last.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// The axes along which the middle of its box comes to 0.
    pub centre: Vec<Axis>,
    /// What all lengths are multiplied by.
    pub scale: f64,
    /// The axis that points the other way.
    pub mirror: Option<Axis>,
    /// Turns about the three axes through the origin, in degrees, counter-clockwise seen from the tips of the axes.
    pub turn_deg: DVec3,
    /// By how much it is moved, in millimetres.
    pub move_mm: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        let (turn_deg, move_mm) = (DVec3::ZERO, DVec3::ZERO);
        Self { centre: Vec::new(), scale: 1.0, mirror: None, turn_deg, move_mm }
    }
}

/// How a placed part is repeated: `times` copies, each turned and moved once more than the one before; then, with a mirror, as
/// many again on its other side.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// How many copies, the first included; at least 1.
    pub times: usize,
    /// The axis that copies are turned about.
    pub about: Option<Axis>,
    /// By how much each is turned, in degrees.
    pub turn_deg: f64,
    /// A point that the axis and the mirror go through, in millimetres.
    pub through_mm: DVec3,
    /// By how much each is moved, in millimetres.
    pub step_mm: DVec3,
    /// The axis that the mirror is perpendicular to.
    pub mirror: Option<Axis>,
}

impl Default for Repeat {
    fn default() -> Self {
        let (through_mm, step_mm) = (DVec3::ZERO, DVec3::ZERO);
        Self { times: 1, about: None, turn_deg: 0.0, through_mm, step_mm, mirror: None }
    }
}

impl Repeat {
    /// Whether the last copy is followed by the first: they go round the axis once.
    pub fn is_closed(&self) -> bool {
        self.about.is_some()
            && self.step_mm == DVec3::ZERO
            && self.times > 2
            && (self.turn_deg.abs() * self.times as f64 - 360.0).abs() < 1e-6
    }

    /// How many copies there are in all.
    pub fn copies(&self) -> usize {
        self.times * if self.mirror.is_some() { 2 } else { 1 }
    }

    /// The motion of each copy.
    fn motions(&self) -> Vec<DAffine3> {
        let through = DAffine3::from_translation(self.through_mm);
        let at = |motion: DAffine3| through * motion * through.inverse();
        let mut motions: Vec<DAffine3> = (0..self.times)
            .map(|i| {
                let turned = self.about.filter(|_| i > 0).map(|axis| {
                    at(DAffine3::from_axis_angle(axis.unit(), (self.turn_deg * i as f64).to_radians()))
                });
                DAffine3::from_translation(self.step_mm * i as f64) * turned.unwrap_or(DAffine3::IDENTITY)
            })
            .collect();
        if let Some(axis) = self.mirror {
            motions.extend(motions.clone().into_iter().map(|motion| at(axis.mirror()) * motion));
        }
        motions
    }
}

impl Placement {
    /// The motion that brings `solid` to its place.
    fn motion(&self, solid: &Solid) -> DAffine3 {
        let points = || solid.vertices().iter().map(|p| DVec3::from_array(p.map(f64::from)));
        let low = points().reduce(DVec3::min).unwrap_or_default();
        let high = points().reduce(DVec3::max).unwrap_or_default();
        let centre: DVec3 = self.centre.iter().map(|axis| axis.unit() * (low + high) / 2.0).sum();
        let [x, y, z] = self.turn_deg.to_array().map(f64::to_radians);
        let turned =
            DAffine3::from_rotation_z(z) * DAffine3::from_rotation_y(y) * DAffine3::from_rotation_x(x);
        DAffine3::from_translation(self.move_mm)
            * turned
            * self.mirror.map_or(DAffine3::IDENTITY, Axis::mirror)
            * DAffine3::from_scale(DVec3::splat(self.scale))
            * DAffine3::from_translation(-centre)
    }

    /// The motions of all copies of `solid`, in their order.
    pub(super) fn motions(&self, repeat: &Repeat, solid: &Solid) -> Vec<DAffine3> {
        let placed = self.motion(solid);
        repeat.motions().into_iter().map(|motion| motion * placed).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    fn near(found: DVec3, wanted: DVec3) {
        assert!(found.distance(wanted) < 1e-9, "{found} {wanted}");
    }

    #[test]
    fn placing_has_an_order() {
        let place = Placement {
            scale: 2.0,
            mirror: Some(Axis::X),
            turn_deg: point(90.0, 0.0, 90.0),
            move_mm: point(0.0, 0.0, 5.0),
            ..Placement::default()
        };
        let motion = place.motion(&Solid::from_facets([]).unwrap());
        // (1, 2, 3), twice as large, mirrored: (-2, 4, 6); about x: (-2, -6, 4); about z: (6, -2, 4); up.
        near(motion.transform_point3(point(1.0, 2.0, 3.0)), point(6.0, -2.0, 9.0));
    }

    #[test]
    fn copies_go_round_and_are_mirrored() {
        let repeat = Repeat {
            times: 4,
            about: Some(Axis::Z),
            turn_deg: 90.0,
            through_mm: point(1.0, 0.0, 0.0),
            mirror: Some(Axis::Z),
            ..Repeat::default()
        };
        assert!(repeat.is_closed() && repeat.copies() == 8);
        let motions = repeat.motions();
        let places: Vec<DVec3> = motions.iter().map(|m| m.transform_point3(point(3.0, 0.0, 1.0))).collect();
        near(places[0], point(3.0, 0.0, 1.0));
        near(places[1], point(1.0, 2.0, 1.0));
        near(places[6], point(-1.0, 0.0, -1.0));
        let stairs = Repeat { times: 3, step_mm: point(0.0, 0.0, 2.0), ..Repeat::default() };
        assert!(!stairs.is_closed());
        near(stairs.motions()[2].transform_point3(DVec3::X), point(1.0, 0.0, 4.0));
    }
}
