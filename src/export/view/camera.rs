//! Where a solid is looked at from, without perspective.

use std::str::FromStr;

use glam::{DVec2, DVec3};

/// A direction to look from. Distances in the picture are true ones, as on a drawing: there is no perspective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum View {
    /// From above (+z), with y up.
    Top,
    /// From above, in front and to the right, with z up.
    Iso,
    /// From in front (−y), with z up.
    Front,
}

impl View {
    /// All of them, in the order of their names in messages.
    pub const ALL: [Self; 3] = [Self::Top, Self::Iso, Self::Front];

    /// Its name, as it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Top => "top",
            Self::Iso => "iso",
            Self::Front => "front",
        }
    }

    pub(super) fn camera(self) -> Camera {
        match self {
            Self::Top => Camera::towards(DVec3::Z, DVec3::Y),
            Self::Iso => Camera::towards(DVec3::new(0.45, -0.9, 0.85), DVec3::Z),
            Self::Front => Camera::towards(DVec3::NEG_Y, DVec3::Z),
        }
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|view| view.name() == text);
        known.ok_or_else(|| format!("there is no view {text}; there are top, iso and front"))
    }
}

/// A right-handed frame: x of the picture, y of the picture, and towards the eye.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    pub(super) towards: DVec3,
}

impl Camera {
    /// The frame of an eye far away in a direction, with `up` up in the picture as far as it can be.
    pub(super) fn towards(eye: DVec3, up: DVec3) -> Self {
        let towards = eye.normalize();
        let right = up.cross(towards).normalize();
        Self { right, up: towards.cross(right), towards }
    }

    /// The frame of a light in a direction; what is up does not matter to it.
    pub(super) fn of_light(direction: DVec3) -> Self {
        let up = if direction.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
        Self::towards(direction, up)
    }

    /// A point in the frame: x, y, and how near it is.
    pub(super) fn of(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.towards.dot(p))
    }

    /// The point that has these coordinates in the frame.
    pub(super) fn back(&self, p: DVec3) -> DVec3 {
        self.right * p.x + self.up * p.y + self.towards * p.z
    }
}

/// A window of the picture plane, cut into square cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Raster {
    /// The corner with the least x and y.
    pub(super) low: DVec2,
    /// Cells for each millimetre.
    pub(super) scale: f64,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Raster {
    /// The window from `low` to `high` with so many cells along its longer side.
    pub(super) fn new(low: DVec2, high: DVec2, longer_side: usize) -> Self {
        let size = high - low;
        let scale = longer_side as f64 / size.max_element().max(f64::MIN_POSITIVE);
        let [width, height] = (size * scale).to_array().map(|cells| (cells.round() as usize).max(1));
        Self { low, scale, width, height }
    }

    pub(super) fn cells(&self) -> usize {
        self.width * self.height
    }

    /// A point of a frame in cells: the centre of the first is at one half.
    pub(super) fn in_cells(&self, p: DVec3) -> DVec3 {
        let at = (p.truncate() - self.low) * self.scale;
        at.extend(p.z)
    }

    /// The middle of a cell in the picture plane.
    pub(super) fn middle(&self, cell: usize) -> DVec2 {
        let (x, y) = (cell % self.width, cell / self.width);
        self.low + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / self.scale
    }

    /// The cell that a point of the picture plane lies in; `None` outside of the window.
    pub(super) fn cell(&self, p: DVec2) -> Option<usize> {
        let at = (p - self.low) * self.scale;
        let is_inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.width as f64 && at.y < self.height as f64;
        is_inside.then(|| at.y as i64 as usize * self.width + at.x as i64 as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_lead_back() {
        for view in View::ALL {
            let camera = view.camera();
            assert!(camera.right.cross(camera.up).abs_diff_eq(camera.towards, 1e-12), "{view:?}");
            let p = DVec3::new(3.0, -7.0, 2.0);
            assert!(camera.back(camera.of(p)).abs_diff_eq(p, 1e-12), "{view:?}");
            assert_eq!(view.name().parse(), Ok(view));
        }
        assert!("back".parse::<View>().is_err());
    }

    #[test]
    fn what_is_up_is_up_in_every_view() {
        assert_eq!(View::Top.camera().of(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(View::Front.camera().of(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 3.0, -2.0));
        assert!(View::Iso.camera().of(DVec3::Z).y > 0.0);
    }
}
