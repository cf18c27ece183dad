//! Options of a rectangle, checked before anything is computed.

use std::path::Path;

use super::builder::{BandBuilder, BandJob};
use super::drape::Drape;
use super::error::JobError;
use super::output::{Output, Target};
use super::rect::Rect;
use super::space::{self, refuse_flat_only};
use super::stage::Stage;
use crate::domain::{CurveSpec, RectSize, Roll, SpaceCurve, SpaceMap};

/// Collects the options of a rectangle (Zhou 2014 §6.2).
#[derive(Debug, Clone)]
pub struct RectBuilder {
    band: BandBuilder,
    size: Sides,
    tile: bool,
    drape: Option<Drape>,
}

/// How large a rectangle is.
#[derive(Debug, Clone, Copy)]
enum Sides {
    Flat(RectSize),
    /// As wide as what it is rolled to is round.
    Rolled {
        roll: Roll,
        height_mm: f64,
    },
}

impl RectBuilder {
    /// A rectangle of the exemplar in an SVG file.
    pub fn new(exemplar: impl AsRef<Path>, size: RectSize) -> Self {
        let along = CurveSpec::Line { length_mm: size.width_mm() };
        Self { band: BandBuilder::new(exemplar, along), size: Sides::Flat(size), tile: false, drape: None }
    }

    /// A rectangle that is rolled to a cylinder or a cone `height_mm` high, its sides joined. It has the components and holes
    /// that are asked for as it stands; the way round is one of the holes.
    pub fn rolled(exemplar: impl AsRef<Path>, roll: Roll, height_mm: f64) -> Self {
        let along = CurveSpec::Line { length_mm: height_mm };
        Self {
            band: BandBuilder::new(exemplar, along),
            size: Sides::Rolled { roll, height_mm },
            tile: false,
            drape: None,
        }
    }

    /// Sets options that a rectangle shares with a band. Its constraints hold for the finished rectangle, its
    /// `width_mm` is the height of the exemplar's own rows, and the curve stays a line.
    ///
    /// ```
    /// use openwork::job::RectBuilder;
    ///
    /// let size = "60x40mm".parse()?;
    /// let job = RectBuilder::new("fixtures/exemplars/vine.svg", size)
    ///     .options(|band| band.components(1).min_feature_mm(0.4))
    ///     .build()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn options(mut self, set: impl FnOnce(BandBuilder) -> BandBuilder) -> Self {
        let along = self.band.along.clone();
        self.band = set(self.band);
        self.band.along = along;
        self
    }

    /// Whether opposite sides match, so that copies join side by side and one above the other. What is asked for
    /// holds for one tile as it is written; the report says what the tiling has.
    pub fn tile(mut self, tile: bool) -> Self {
        self.tile = tile;
        self
    }

    /// The height field that it is laid over, stretched over the whole of it; what is rolled stands out by it.
    pub fn drape(mut self, drape: Option<Drape>) -> Self {
        self.drape = drape;
        self
    }

    /// Checks every option by its name.
    ///
    /// # Errors
    /// As [`BandBuilder::build`]; and [`JobError::Option`] for `--width` above the height of the rectangle, for
    /// bridges in a tile, and for a closed pattern, which only rings have.
    pub fn build(self) -> Result<RectJob, JobError> {
        let mut band = self.band.build()?;
        let (size, space) = match self.size {
            Sides::Flat(size) => {
                let lain = self.drape.as_ref().map(|drape| draped(&band, drape, size, self.tile));
                (size, lain.transpose()?)
            }
            Sides::Rolled { roll, height_mm } => {
                let (size, map) = rolled(&band, roll, height_mm, self.drape.as_ref())?;
                (size, Some(map))
            }
        };
        let mut note = None;
        if let Some(map) = &space {
            refuse_flat_only(&band.options.print)?;
            let asked = band.tolerances;
            band.tolerances = space::flat_tolerances(&asked, map)?;
            note = space::note(&asked, &band.tolerances);
        }
        if let Some(width) = band.options.width_mm.filter(|&width| width > size.height_mm()) {
            return Err(JobError::Option {
                option: "--width",
                found: format!("rows {width:.2} mm high do not fit a rectangle of {size}"),
                wanted: "make the rows lower, or the rectangle higher".to_owned(),
            });
        }
        if band.options.goal.closed_pattern {
            return Err(JobError::Option {
                option: "--closed-pattern",
                found: "a rectangle is not closed".to_owned(),
                wanted: "a pattern can close only along a closed curve; leave it out".to_owned(),
            });
        }
        if self.tile && band.options.bridge_mm.is_some() {
            return Err(JobError::Option {
                option: "--bridge",
                found: "bridges across the sides of a --tile would not match those of its copies".to_owned(),
                wanted: "leave out one of the two; openwork extrude --bridge can bridge a tile that is cut by itself"
                    .to_owned(),
            });
        }
        if self.tile && band.options.enforce {
            return Err(JobError::Option {
                option: "--enforce",
                found: "what is thickened along the sides of a --tile would not match its copies".to_owned(),
                wanted: "enforce the widths of the exemplar instead, as openwork extrude EXEMPLAR.svg --min-feature 1mm --enforce -o thick.svg, and make the tile of thick.svg; or take a larger --width"
                    .to_owned(),
            });
        }
        Ok(RectJob { band, size, tile: self.tile, space, note })
    }
}

/// The rectangle that becomes a roll, and how it is rolled.
fn rolled(
    band: &BandJob,
    roll: Roll,
    height_mm: f64,
    drape: Option<&Drape>,
) -> Result<(RectSize, SpaceMap), JobError> {
    let refuse = |option: &'static str, found: &str, wanted: &str| {
        Err(JobError::Option { option, found: found.to_owned(), wanted: wanted.to_owned() })
    };
    let options = &band.options;
    if options.bridge_mm.is_some() || options.enforce {
        let option = if options.enforce { "--enforce" } else { "--bridge" };
        let wanted = "ask for what the ornament gives by itself, or take a larger --width";
        return refuse(option, "the sides of what is rolled would not meet after it", wanted);
    }
    if !RectSize::RANGE_MM.contains(&height_mm) {
        let [least, most] = [RectSize::RANGE_MM.start(), RectSize::RANGE_MM.end()];
        return refuse("--height", &format!("it is {height_mm} mm"), &format!("use {least} to {most} mm"));
    }
    let (curve, slant_mm) = roll.curve(height_mm, options.thickness_mm)?;
    let size = RectSize::new(curve.length_mm(), slant_mm)?;
    let relief = drape.map(|drape| drape.relief(&curve, slant_mm)).transpose()?;
    Ok((size, space::standing(curve, slant_mm, options.thickness_mm, relief, &band.tolerances)?))
}

/// How a rectangle lies over a height field.
fn draped(band: &BandJob, drape: &Drape, size: RectSize, tile: bool) -> Result<SpaceMap, JobError> {
    if tile {
        return Err(JobError::Option {
            option: "--drape",
            found: "copies of a --tile join in the plane".to_owned(),
            wanted: "leave out one of the two".to_owned(),
        });
    }
    let curve = SpaceCurve::lying(size.width_mm())?;
    let relief = Some(drape.relief(&curve, size.height_mm())?);
    space::standing(curve, size.height_mm(), band.options.thickness_mm, relief, &band.tolerances)
}

/// A rectangle whose options are in order.
#[derive(Debug, Clone)]
pub struct RectJob {
    pub(super) band: BandJob,
    pub(super) size: RectSize,
    pub(super) tile: bool,
    /// Where it lies, if it does not lie in the plane.
    pub(super) space: Option<SpaceMap>,
    /// What the user may want to know of that.
    pub(super) note: Option<String>,
}

impl RectJob {
    /// Whether its left side is its right side.
    pub(super) fn is_rolled(&self) -> bool {
        self.space.as_ref().is_some_and(|map| map.curve().is_closed())
    }

    /// Refuses outputs that would overwrite each other or the exemplar, or that cannot be files.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub fn check_outputs(&self, outputs: &[Output], report_file: Option<&Target>) -> Result<(), JobError> {
        self.band.check_outputs(outputs, report_file)
    }

    /// Makes the rectangle; `progress` is told of each stage as it begins, of each way that is tried.
    ///
    /// # Errors
    /// [`JobError`] says why there is no rectangle, and what would work.
    pub fn run(&self, progress: &mut dyn FnMut(Stage)) -> Result<Rect, JobError> {
        Rect::new(self, progress)
    }
}
