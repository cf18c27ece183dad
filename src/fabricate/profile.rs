//! How far a solid's walls go in at which height.

use super::FabricateError;
use crate::planar::Grid;

/// The smallest chamfer in millimetres: no machine makes a smaller one, and at 100 m 32-bit floats lie nearly as far apart.
const MIN_CHAMFER_MM: f64 = 0.01;
/// The largest taper in degrees: beyond it the part is more a roof than a plate.
const MAX_TAPER_DEG: f64 = 45.0;

/// The heights of a solid, from z = 0 up, and what becomes of its edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    thickness_mm: f64,
    chamfer_mm: f64,
    taper_deg: f64,
}

/// A horizontal section: how high it is, and how far its outline lies inside that of the region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Level {
    pub(super) z_mm: f64,
    pub(super) inset_mm: f64,
}

impl Profile {
    /// Upright walls from z = 0 to `thickness_mm`.
    ///
    /// # Errors
    /// [`FabricateError::Thickness`] outside 0.001 mm to 100 m.
    pub fn upright(thickness_mm: f64) -> Result<Self, FabricateError> {
        if !(Grid::MIN_EXTENT_MM..=Grid::MAX_EXTENT_MM).contains(&thickness_mm) {
            return Err(FabricateError::Thickness { found_mm: thickness_mm });
        }
        Ok(Self { thickness_mm, chamfer_mm: 0.0, taper_deg: 0.0 })
    }

    /// The same with all edges of the bottom and the top bevelled at 45 degrees, `chamfer_mm` wide and high.
    ///
    /// # Errors
    /// [`FabricateError::Chamfer`] below 0.01 mm and from half of the thickness on, where no wall is left.
    pub fn chamfered(self, chamfer_mm: f64) -> Result<Self, FabricateError> {
        match chamfer_mm >= MIN_CHAMFER_MM && chamfer_mm < 0.5 * self.thickness_mm {
            true => Ok(Self { chamfer_mm, ..self }),
            false => Err(FabricateError::Chamfer { found_mm: chamfer_mm, thickness_mm: self.thickness_mm }),
        }
    }

    /// The same with all walls sloped inwards from the bottom to the top, `taper_deg` degrees from upright (the draft
    /// of a mould).
    ///
    /// # Errors
    /// [`FabricateError::Taper`] unless it is more than 0 and less than 45 degrees.
    pub fn tapered(self, taper_deg: f64) -> Result<Self, FabricateError> {
        match taper_deg > 0.0 && taper_deg < MAX_TAPER_DEG {
            true => Ok(Self { taper_deg, ..self }),
            false => Err(FabricateError::Taper { found_deg: taper_deg }),
        }
    }

    /// The height in millimetres.
    pub fn thickness_mm(&self) -> f64 {
        self.thickness_mm
    }

    /// Whether all walls are upright.
    pub fn is_upright(&self) -> bool {
        self.chamfer_mm == 0.0 && self.taper_deg == 0.0
    }

    /// The levels between which walls are straight, from the bottom up.
    pub(super) fn levels(&self) -> Vec<Level> {
        let (top, chamfer) = (self.thickness_mm, self.chamfer_mm);
        let slope = self.taper_deg.to_radians().tan();
        let level = |z_mm: f64, bevel: f64| Level { z_mm, inset_mm: slope * z_mm + bevel };
        match chamfer > 0.0 {
            true => {
                vec![level(0.0, chamfer), level(chamfer, 0.0), level(top - chamfer, 0.0), level(top, chamfer)]
            }
            false => vec![level(0.0, 0.0), level(top, 0.0)],
        }
    }

    /// What to ask for instead, when walls can go in by `largest_mm` at most.
    pub(super) fn remedy(&self, largest_mm: f64) -> String {
        // Rounded down, so that it works as it is printed.
        let down = |x: f64| (x * 1000.0).floor() / 1000.0;
        let taper = |mm: f64| down((mm / self.thickness_mm).atan().to_degrees());
        let asked = match (self.chamfer_mm > 0.0, self.taper_deg > 0.0) {
            _ if down(largest_mm) < MIN_CHAMFER_MM => "no chamfer or taper does".to_owned(),
            (true, false) => format!("a chamfer of {} mm does", down(largest_mm)),
            (false, _) => format!("a taper of {} degrees does", taper(largest_mm)),
            (true, true) => format!(
                "a chamfer of {} mm does without the taper, a taper of {} degrees without the chamfer",
                down(largest_mm),
                taper(largest_mm)
            ),
        };
        format!("{asked}, or a larger minimum feature of the pattern")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_follow_the_walls() {
        let plate = Profile::upright(4.0).unwrap();
        let pairs = |p: Profile| p.levels().iter().map(|l| (l.z_mm, l.inset_mm)).collect::<Vec<_>>();
        assert_eq!(pairs(plate), [(0.0, 0.0), (4.0, 0.0)]);
        assert!(plate.is_upright());
        assert_eq!(pairs(plate.chamfered(0.5).unwrap()), [(0.0, 0.5), (0.5, 0.0), (3.5, 0.0), (4.0, 0.5)]);
        let both = pairs(plate.chamfered(0.5).unwrap().tapered(10.0).unwrap());
        let slope = 10f64.to_radians().tan();
        assert_eq!(both, [(0.0, 0.5), (0.5, 0.5 * slope), (3.5, 3.5 * slope), (4.0, 4.0 * slope + 0.5)]);
    }

    #[test]
    fn what_no_solid_has_is_refused() {
        let plate = Profile::upright(4.0).unwrap();
        for bad in [-1.0, 0.0, 0.001, 2.0, 9.0, f64::NAN] {
            assert!(matches!(plate.chamfered(bad), Err(FabricateError::Chamfer { .. })), "{bad}");
        }
        for bad in [-1.0, 0.0, 45.0, 90.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(plate.tapered(bad), Err(FabricateError::Taper { .. })), "{bad}");
        }
    }
}
