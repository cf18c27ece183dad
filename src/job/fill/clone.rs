//! A box of the exemplar that is copied to a place of the output, as it is named on a command line.

use std::fmt;
use std::str::FromStr;

use glam::DVec2;

use crate::domain::RectSize;
use crate::samples;

/// A box of the exemplar and where it goes, in millimetres, y up. Both places are lower left corners: of the box, from the lower left
/// corner of the exemplar's page, and of its copy, from that of the domain's page (of a rectangle and of a strip, from its own corner).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloneSpec {
    /// The corner of the box.
    pub from_mm: DVec2,
    /// Its width and height.
    pub size_mm: DVec2,
    /// The corner of its copy.
    pub to_mm: DVec2,
}

impl CloneSpec {
    /// The same by its middle, with the copy moved by `shift_mm`.
    pub(super) fn placed(&self, shift_mm: DVec2) -> samples::CloneBox {
        let half_mm = 0.5 * self.size_mm;
        samples::CloneBox { from_mm: self.from_mm + half_mm, half_mm, to_mm: self.to_mm + half_mm + shift_mm }
    }
}

impl FromStr for CloneSpec {
    type Err = String;

    /// Reads `10,20,30x15->100,50`.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = || {
            format!(
                "'{text}' is no copy; write the lower left corner and the size of a box of the exemplar and the corner of its copy in mm, such as 10,20,30x15->100,50"
            )
        };
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|mm| mm.is_finite());
        let place = |text: &str| {
            let (x, y) = text.split_once(',')?;
            Some(DVec2::new(number(x)?, number(y)?))
        };
        let (from, to) = text.split_once("->").ok_or_else(form)?;
        let (corner, size) = from.rsplit_once(',').ok_or_else(form)?;
        let (from_mm, to_mm) = place(corner).zip(place(to)).ok_or_else(form)?;
        let size: RectSize = size.trim().parse().map_err(|error| format!("in '{text}': {error}"))?;
        Ok(Self { from_mm, size_mm: DVec2::new(size.width_mm(), size.height_mm()), to_mm })
    }
}

impl fmt::Display for CloneSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_mm, size_mm, to_mm } = self;
        write!(f, "{},{},{}x{}->{},{}", from_mm.x, from_mm.y, size_mm.x, size_mm.y, to_mm.x, to_mm.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_read_and_taught() {
        let spec: CloneSpec = "10,20,30x15->100,-5.5".parse().unwrap();
        assert_eq!(spec.to_string(), "10,20,30x15->100,-5.5");
        let placed = spec.placed(DVec2::ONE);
        assert_eq!((placed.from_mm, placed.half_mm), (DVec2::new(25.0, 27.5), DVec2::new(15.0, 7.5)));
        assert_eq!(placed.to_mm, DVec2::new(116.0, 3.0));
        for wrong in ["", "10,20->30,40", "10,20,30x15", "10,20,30x15->100", "a,20,30x15->1,2"] {
            let message = wrong.parse::<CloneSpec>().unwrap_err();
            assert!(
                message.contains("such as 10,20,30x15->100,50") || message.contains("such as 120x80mm"),
                "{message}"
            );
        }
    }
}
