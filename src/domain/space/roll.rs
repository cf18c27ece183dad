//! What a sheet is rolled to: a cylinder or a cone.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::super::length::{LengthError, parse_length_mm};
use super::curve::SpaceCurve;
use super::error::SpaceError;
use super::twist::Twist;

/// A cylinder, or a part of a cone, by its inner diameters in millimetres. It stands on its bottom, around the z axis.
///
/// As text `diameter=120mm`, or `diameter=120mm,top=80mm` for a cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roll {
    bottom_mm: f64,
    top_mm: f64,
}

/// A text that is no roll.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RollError {
    /// It has not the right parts.
    #[error(
        "'{text}' is nothing to roll to; write diameter=120mm, or diameter=120mm,top=80mm for a cone (both inside)"
    )]
    Form {
        /// What was given.
        text: String,
    },
    /// A part is no length.
    #[error("in '{text}': {source}")]
    Length {
        /// What was given.
        text: String,
        /// What is wrong with it.
        source: LengthError,
    },
    /// A diameter is zero or less.
    #[error("in '{text}' a diameter is {found_mm} mm; it must be more than 0, such as diameter=120mm")]
    NotPositive {
        /// What was given.
        text: String,
        /// The diameter in millimetres, as text.
        found_mm: String,
    },
}

impl Roll {
    /// The circle of the middle of a sheet that stands `height_mm` high and is `thickness_mm` thick, with v up the wall; and how long the
    /// wall is along it.
    ///
    /// # Errors
    /// [`SpaceError::Radius`] for a circle that cannot be.
    pub fn curve(self, height_mm: f64, thickness_mm: f64) -> Result<(SpaceCurve, f64), SpaceError> {
        let narrows = 0.5 * (self.bottom_mm - self.top_mm);
        let (lean, slant_mm) = ((narrows / height_mm).atan(), narrows.hypot(height_mm));
        // The diameters are those of the inside, half of the thickness along the normal of the wall away.
        let radius = 0.25 * (self.bottom_mm + self.top_mm) + 0.5 * thickness_mm * lean.cos();
        let ring = SpaceCurve::ring(radius)?;
        Ok((ring.twisted(&Twist::constant(-lean))?, slant_mm))
    }
}

impl FromStr for Roll {
    type Err = RollError;

    fn from_str(text: &str) -> Result<Self, RollError> {
        let form = || RollError::Form { text: text.to_owned() };
        let (mut bottom, mut top) = (None, None);
        for part in text.split(',') {
            let (name, value) = part.split_once('=').ok_or_else(form)?;
            let mm = parse_length_mm(value)
                .map_err(|source| RollError::Length { text: text.to_owned(), source })?;
            if mm <= 0.0 {
                return Err(RollError::NotPositive { text: text.to_owned(), found_mm: mm.to_string() });
            }
            let side = match name.trim() {
                "diameter" => &mut bottom,
                "top" => &mut top,
                _ => return Err(form()),
            };
            if side.replace(mm).is_some() {
                return Err(form());
            }
        }
        let bottom_mm = bottom.ok_or_else(form)?;
        Ok(Self { bottom_mm, top_mm: top.unwrap_or(bottom_mm) })
    }
}

impl fmt::Display for Roll {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "diameter={}mm", self.bottom_mm)?;
        match self.top_mm == self.bottom_mm {
            true => Ok(()),
            false => write!(f, ",top={}mm", self.top_mm),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::map::SpaceMap;
    use super::*;
    use glam::DVec2;

    #[test]
    fn rolls_are_read() {
        for (text, shown) in
            [("diameter=120mm", "diameter=120mm"), ("diameter=12cm, top=80mm", "diameter=120mm,top=80mm")]
        {
            assert_eq!(text.parse::<Roll>().unwrap().to_string(), shown);
        }
        for text in ["", "120mm", "top=80mm", "diameter=", "diameter=0", "diameter=9,diameter=9", "size=9"] {
            let message = text.parse::<Roll>().expect_err(text).to_string();
            assert!(message.contains("diameter=120mm") || message.contains("length"), "{text}: {message}");
        }
    }

    #[test]
    fn a_cone_has_its_inner_diameters() {
        for text in ["diameter=120mm", "diameter=120mm,top=80mm", "diameter=60mm,top=90mm"] {
            let roll: Roll = text.parse().unwrap();
            let (curve, slant) = roll.curve(100.0, 2.0).unwrap();
            let map = SpaceMap::new(curve, [-0.5 * slant, 0.5 * slant], [-1.0, 1.0], 0.0).unwrap();
            for (u, v, diameter, z) in [(0.0, -0.5, roll.bottom_mm, -50.0), (77.0, 0.5, roll.top_mm, 50.0)] {
                let inside = map.place(DVec2::new(u, v * slant), -1.0);
                let lean = (0.5 * (roll.bottom_mm - roll.top_mm) / 100.0).atan();
                assert!((2.0 * inside.truncate().length() - diameter).abs() < 1e-9, "{text}: {inside}");
                assert!((inside.z - (z - lean.sin())).abs() < 1e-9, "{text}: {inside}");
            }
        }
    }
}
