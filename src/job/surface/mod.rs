//! Bands on models (Zhou 2014 §6.3): what is asked for, and how it is written.
//!
//! A curve on the model carries the band, as any curve in space does; the model's distance from the flat band is its relief, so that it lies on
//! the model. Excluded: the geometry of models and their curves ([`crate::domain`]).

mod ground;
mod merged;
mod under;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::DVec3;
use thiserror::Error;

use super::report::SurfaceReport;
use crate::domain::{LengthError, parse_length_mm};

pub use ground::Ground;
pub(super) use merged::MergedCounts;

/// What is asked of a band on a model.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceOptions {
    /// The model: an STL, a 3MF or an OBJ, in millimetres.
    pub model: PathBuf,
    /// Where the curve goes.
    pub route: Route,
    /// What becomes of band and model.
    pub mode: SurfaceMode,
    /// The wall that the model is given, inwards, in millimetres. A closed model is made hollow by it.
    pub shell_mm: Option<f64>,
    /// How deep a model is carved that is not carved through, in millimetres.
    pub depth_mm: Option<f64>,
    /// How far points may be off the model, in millimetres.
    pub tolerance_mm: f64,
}

/// Where a curve goes on a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Route {
    /// Through points near the model.
    Through {
        /// The points in millimetres, in the coordinates of the model.
        points: ControlPoints,
        /// Whether the last is followed by the first.
        is_closed: bool,
    },
    /// Through the points of a file, closed if its last point is its first.
    Curve(PathBuf),
    /// All the way round at one height.
    Around(Height),
}

/// What becomes of a band and the model that it lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SurfaceMode {
    /// The band is a part of its own, as thick as was asked for, and fits the model.
    #[default]
    Band,
    /// The band stands out from the model, in one piece with it.
    Emboss,
    /// The band is cut out of the model: through its wall, or so deep.
    Carve,
}

/// A height on a model: in millimetres along z, or as a part of its own height from its lowest place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Height {
    /// The z of the model's own coordinates, in millimetres.
    Mm(f64),
    /// A part of the model's height, from 0 to 1.
    Part(f64),
}

/// Points in space, as they are typed: `x,y,z; x,y,z`.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlPoints(pub Vec<DVec3>);

/// A text that names no place on a model.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RouteError {
    /// A height is none.
    #[error(
        "'{text}' is no height; write a length above the model's origin, as 30mm, or a part of the model's height, as 50%"
    )]
    Height {
        /// What was given.
        text: String,
    },
    /// A height is no length.
    #[error("in '{text}': {source}")]
    Length {
        /// What was given.
        text: String,
        /// What is wrong with it.
        source: LengthError,
    },
    /// Points are none.
    #[error(
        "'{point}' is no point; write x,y,z in millimetres for each, with semicolons between them, as \"30,0,10; 0,30,20\""
    )]
    Point {
        /// The point.
        point: String,
    },
}

impl SurfaceOptions {
    /// The file that the curve comes from, if it does.
    pub(super) fn curve_file(&self) -> Option<&Path> {
        match &self.route {
            Route::Curve(file) => Some(file),
            Route::Through { .. } | Route::Around(_) => None,
        }
    }

    /// What reports say of it.
    pub(super) fn report(&self) -> SurfaceReport {
        SurfaceReport {
            mode: match self.mode {
                SurfaceMode::Band => "band",
                SurfaceMode::Emboss => "emboss",
                SurfaceMode::Carve => "carve",
            },
            route: match &self.route {
                Route::Around(height) => format!("around {height}"),
                Route::Curve(file) => format!("along {}", file.display()),
                Route::Through { points, is_closed } => {
                    let closed = if *is_closed { ", closed" } else { "" };
                    format!("through {} points{closed}", points.0.len())
                }
            },
            shell_mm: self.shell_mm,
            depth_mm: self.depth_mm,
            tolerance_mm: self.tolerance_mm,
        }
    }
}

impl FromStr for Height {
    type Err = RouteError;

    fn from_str(text: &str) -> Result<Self, RouteError> {
        let wrong = || RouteError::Height { text: text.to_owned() };
        if let Some(part) = text.trim().strip_suffix('%') {
            let percent = part.trim().parse::<f64>().ok().filter(|p| (0.0..=100.0).contains(p));
            return Ok(Self::Part(percent.ok_or_else(wrong)? / 100.0));
        }
        parse_length_mm(text)
            .map(Self::Mm)
            .map_err(|source| RouteError::Length { text: text.to_owned(), source })
    }
}

impl fmt::Display for Height {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mm(mm) => write!(f, "{mm}mm"),
            Self::Part(part) => write!(f, "{}%", part * 100.0),
        }
    }
}

impl FromStr for ControlPoints {
    type Err = RouteError;

    fn from_str(text: &str) -> Result<Self, RouteError> {
        let point = |part: &str| {
            let numbers: Option<Vec<f64>> = part.split(',').map(|n| n.trim().parse().ok()).collect();
            match numbers.as_deref() {
                Some(&[x, y, z]) if DVec3::new(x, y, z).is_finite() => Ok(DVec3::new(x, y, z)),
                _ => Err(RouteError::Point { point: part.trim().to_owned() }),
            }
        };
        // One semicolon more at the end is no point.
        let parts = text.trim().trim_end_matches(';').split(';');
        parts.map(point).collect::<Result<Vec<_>, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_lengths_or_parts() {
        assert_eq!("50%".parse::<Height>().unwrap(), Height::Part(0.5));
        assert_eq!("-1.5cm".parse::<Height>().unwrap(), Height::Mm(-15.0));
        for text in ["", "%", "120%", "-1%", "high"] {
            let message = text.parse::<Height>().expect_err(text).to_string();
            assert!(message.contains("50%") || message.contains("length"), "{text}: {message}");
        }
    }

    #[test]
    fn points_are_apart_by_semicolons() {
        let points: ControlPoints = "1,2,3; -4.5, 0,6;".parse().unwrap();
        assert_eq!(points.0, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.5, 0.0, 6.0)]);
        for text in ["", "1,2", "1,2,3;;4,5,6", "1,2,x", "1,2,NaN", "1 2 3"] {
            assert!(matches!(text.parse::<ControlPoints>(), Err(RouteError::Point { .. })), "{text}");
        }
    }
}
