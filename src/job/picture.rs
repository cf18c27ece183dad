//! What a PNG shows: the part as a drawing with marks, or the solid, shaded.

use std::str::FromStr;

use super::error::JobError;
use super::output::{Format, Output};
use crate::export::{self, DEFAULT_COLOUR, DEFAULT_PIXELS, Marks, Painted, View};
use crate::fabricate::{Bridge, Solid};
use crate::planar::Region;
use crate::verify::NarrowPlaces;

/// What is marked in a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Show {
    /// Struts in orange and slits in green.
    Bridges,
    /// Where pieces meet: light blue lines across the band.
    Seams,
    /// The narrowest ink and gaps: a red ring around each.
    Thin,
}

impl Show {
    /// All of them, in the order of their names in messages.
    pub const ALL: [Self; 3] = [Self::Seams, Self::Thin, Self::Bridges];

    /// Its name, as it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bridges => "bridges",
            Self::Seams => "seams",
            Self::Thin => "thin",
        }
    }
}

impl FromStr for Show {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|show| show.name() == text);
        known.ok_or_else(|| {
            format!("{text} cannot be shown; use seams, thin or bridges, or several as seams,thin")
        })
    }
}

/// What a PNG shows, and how large it is.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureOptions {
    /// Where the solid is seen from; without one the part is shown as a flat drawing.
    pub view: Option<View>,
    /// What is marked in a flat drawing; when nothing is named, bridges if there are some.
    pub show: Vec<Show>,
    /// The longer side in pixels.
    pub pixels: u32,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { view: None, show: Vec::new(), pixels: DEFAULT_PIXELS }
    }
}

/// A part, and what may be marked in its picture.
pub(super) struct Pictured<'p> {
    pub(super) region: &'p Region,
    pub(super) bridges: &'p [Bridge],
    pub(super) seams_mm: &'p [Vec<glam::DVec2>],
    /// The middle and the width of each.
    pub(super) narrow_mm: &'p [(glam::DVec2, f64)],
    /// What is engraved, where the region is.
    pub(super) engraved: Option<&'p Region>,
}

impl PictureOptions {
    /// Refuses what no output or no drawing could show.
    ///
    /// # Errors
    /// [`JobError::Option`] names the option.
    pub fn check(&self, outputs: &[Output]) -> Result<(), JobError> {
        let default = Self::default();
        let has_png = outputs.iter().any(|output| output.format() == Format::Png);
        let given = [
            ("--view", self.view.is_some()),
            ("--show", self.show != default.show),
            ("--pixels", self.pixels != default.pixels),
        ];
        let refuse = |option, found: &str, wanted: &str| {
            Err(JobError::Option { option, found: found.to_owned(), wanted: wanted.to_owned() })
        };
        if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given && !has_png) {
            return refuse(option, "no output is a picture", "write a .png, or leave it out");
        }
        if self.view.is_some() && self.show != default.show {
            return refuse("--show", "marks are for flat drawings", "leave out --view, or --show");
        }
        Ok(())
    }

    /// Refuses what the picture of a sign that is carved out of a plate cannot show.
    ///
    /// # Errors
    /// [`JobError::Option`] names the option.
    pub(super) fn check_sign(&self) -> Result<(), JobError> {
        let refuse = |option, found: String, wanted: &str| {
            Err(JobError::Option { option, found, wanted: wanted.to_owned() })
        };
        if self.view.is_some() {
            let found = "a sign that is carved with --carve is cut, and has no solid to be seen".to_owned();
            return refuse("--view", found, "leave it out, and the picture shows the plate");
        }
        match self.show.iter().find(|&&show| show != Show::Thin) {
            Some(show) => {
                let found = format!("{} are of the pattern, which --carve cuts away", show.name());
                refuse("--show", found, "use --show thin, or leave out --carve for a picture of the pattern")
            }
            None => Ok(()),
        }
    }

    /// The picture of a sign, with what falls out of it and what is engraved in `marks`, and its narrow places.
    pub(super) fn sign_png(
        &self,
        kept: &Region,
        marks: Marks<'_>,
        narrow: &NarrowPlaces,
    ) -> Result<Vec<u8>, JobError> {
        let narrow_mm = if self.show.contains(&Show::Thin) { narrow.places_mm() } else { Vec::new() };
        Ok(export::png(kept, &Marks { narrow_mm: &narrow_mm, ..marks }, self.pixels)?)
    }

    /// The shaded picture of a solid, if that is what is asked for, else of the flat part.
    ///
    /// # Panics
    /// If a view is asked for, and there is no solid.
    pub(super) fn png(&self, part: &Pictured<'_>, solid: Option<&Solid>) -> Result<Vec<u8>, JobError> {
        if let Some(view) = self.view {
            let solid = solid.expect("a solid is made for its picture");
            let painted = Painted { solid, colour: DEFAULT_COLOUR };
            return Ok(export::view_png(&[painted], view, self.pixels)?);
        }
        let default = [Show::Bridges];
        let shown = if self.show.is_empty() { &default[..] } else { &self.show };
        let shows = |what: Show| shown.contains(&what);
        let marks = Marks {
            bridges: if shows(Show::Bridges) { part.bridges } else { &[] },
            fallen: None,
            engraved: part.engraved,
            seams_mm: if shows(Show::Seams) { part.seams_mm } else { &[] },
            narrow_mm: if shows(Show::Thin) { part.narrow_mm } else { &[] },
        };
        Ok(export::png(part.region, &marks, self.pixels)?)
    }
}
