//! The relief that a rectangle is laid over, as it is named and read.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use super::error::JobError;
use crate::domain::{LengthError, Relief, SpaceCurve, parse_length_mm};
use crate::exemplar::read_heights;

/// A height field in a file: a table of heights in millimetres, `hill.csv`, or a picture whose white is so high, `hill.png,height=20mm`.
#[derive(Debug, Clone, PartialEq)]
pub struct Drape {
    file: PathBuf,
    height_mm: Option<f64>,
}

/// A text that names no height field.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DrapeError {
    /// It has not the right parts.
    #[error("'{text}' names no height field; write FILE.csv, or FILE.png,height=20mm")]
    Form {
        /// What was given.
        text: String,
    },
    /// The height is no length.
    #[error("in '{text}': {source}")]
    Height {
        /// What was given.
        text: String,
        /// What is wrong with it.
        source: LengthError,
    },
}

impl FromStr for Drape {
    type Err = DrapeError;

    fn from_str(text: &str) -> Result<Self, DrapeError> {
        let (file, height) = match text.rsplit_once(",height=") {
            Some((file, height)) => (file, Some(height)),
            None => (text, None),
        };
        if file.is_empty() {
            return Err(DrapeError::Form { text: text.to_owned() });
        }
        let height_mm = height
            .map(parse_length_mm)
            .transpose()
            .map_err(|source| DrapeError::Height { text: text.to_owned(), source })?;
        Ok(Self { file: file.into(), height_mm })
    }
}

impl fmt::Display for Drape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.height_mm.map_or(Ok(()), |height_mm| write!(f, ",height={height_mm}mm"))
    }
}

impl Drape {
    /// The relief of a sheet along `curve`, `height_mm` across.
    ///
    /// # Errors
    /// [`JobError::Option`] for a file that cannot be read, and a picture without a height.
    pub(super) fn relief(&self, curve: &SpaceCurve, height_mm: f64) -> Result<Relief, JobError> {
        let refuse = |found: String, wanted: &str| JobError::Option {
            option: "--drape",
            found,
            wanted: wanted.to_owned(),
        };
        let heights = read_heights(&self.file)
            .map_err(|error| refuse(error.to_string(), "the table is stretched over the whole rectangle"))?;
        let scale = match (heights.are_parts, self.height_mm) {
            (true, Some(height_mm)) => height_mm,
            (true, None) => {
                let found = format!("{} is a picture without a height", self.file.display());
                return Err(refuse(found, "say how high its white is, as FILE.png,height=20mm"));
            }
            (false, None) => 1.0,
            (false, Some(_)) => {
                let found = format!("{} has heights of its own, in mm", self.file.display());
                return Err(refuse(found, "leave out height="));
            }
        };
        // The lowest row first.
        let rows = heights.values.chunks_exact(heights.columns).rev();
        let table = rows.flatten().map(|height| scale * height).collect();
        let half = 0.5 * height_mm;
        Ok(Relief::new(table, heights.columns, curve.length_mm(), [-half, half], curve.is_closed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn height_fields_are_named() {
        for text in ["hill.csv", "hills/a,b.png,height=20mm"] {
            assert_eq!(text.parse::<Drape>().unwrap().to_string(), text);
        }
        assert!(matches!("".parse::<Drape>(), Err(DrapeError::Form { .. })));
        assert!(matches!("a.png,height=high".parse::<Drape>(), Err(DrapeError::Height { .. })));
    }
}
