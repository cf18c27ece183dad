//! The size of a rectangle, as people type it.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::length::{LengthError, parse_length_mm};

/// The sides of a rectangle in millimetres, both in range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectSize {
    width_mm: f64,
    height_mm: f64,
}

/// A text or numbers that are no size.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RectSizeError {
    /// There are not two lengths.
    #[error("'{text}' is not a size; write width and height with an x between them, such as 120x80mm")]
    Form {
        /// What was given.
        text: String,
    },
    /// A side is not a length.
    #[error("in '{text}': {source}")]
    Length {
        /// What was given.
        text: String,
        /// What is wrong with it.
        source: LengthError,
    },
    /// A side is too short or too long.
    #[error("the {side} is {found_mm} mm; it must be from {} to {} mm", RectSize::RANGE_MM.start(), RectSize::RANGE_MM.end())]
    Range {
        /// `width` or `height`.
        side: &'static str,
        /// The length in millimetres, as text.
        found_mm: String,
    },
}

impl RectSize {
    /// The lengths that a side may have. Shorter, and no ornament fits; longer, and the rows of a rectangle hold
    /// more strands than a search can tell apart.
    pub const RANGE_MM: std::ops::RangeInclusive<f64> = 1.0..=2000.0;

    /// A rectangle by its sides in millimetres.
    ///
    /// # Errors
    /// [`RectSizeError::Range`] for a side that is not a number within [`Self::RANGE_MM`].
    pub fn new(width_mm: f64, height_mm: f64) -> Result<Self, RectSizeError> {
        for (side, mm) in [("width", width_mm), ("height", height_mm)] {
            if !Self::RANGE_MM.contains(&mm) {
                return Err(RectSizeError::Range { side, found_mm: mm.to_string() });
            }
        }
        Ok(Self { width_mm, height_mm })
    }

    /// The side along u, to the right.
    pub fn width_mm(self) -> f64 {
        self.width_mm
    }

    /// The side along v, up.
    pub fn height_mm(self) -> f64 {
        self.height_mm
    }
}

/// `120x80mm`, `120mm x 8cm`, `5inx3in`: a first length without a unit has that of the second.
impl FromStr for RectSize {
    type Err = RectSizeError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let form = || RectSizeError::Form { text: text.to_owned() };
        // The x of px is followed by no digit.
        let between = text.char_indices().find(|&(i, c)| {
            matches!(c, 'x' | 'X' | '×')
                && text[i + c.len_utf8()..]
                    .trim_start()
                    .starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        });
        let (at, x) = between.ok_or_else(form)?;
        let (width, height) = (text[..at].trim(), text[at + x.len_utf8()..].trim());
        if width.is_empty() {
            return Err(form());
        }
        let length = |side: &str| {
            parse_length_mm(side).map_err(|source| RectSizeError::Length { text: text.to_owned(), source })
        };
        let unit = &height[height.rfind(|c: char| c.is_ascii_digit() || c == '.').map_or(0, |i| i + 1)..];
        let is_bare = width.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        let width_mm = if is_bare { length(&format!("{width}{unit}"))? } else { length(width)? };
        Self::new(width_mm, length(height)?)
    }
}

/// In millimetres with two decimals at most: three inches are 76.2 and not 76.19999999999999.
impl fmt::Display for RectSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |mm: f64| (mm * 100.0).round() / 100.0;
        write!(f, "{}x{}mm", shown(self.width_mm), shown(self.height_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_units() {
        for (text, width, height) in [
            ("120x80mm", 120.0, 80.0),
            ("120x80", 120.0, 80.0),
            ("12x8cm", 120.0, 80.0),
            ("120mm x 8 cm", 120.0, 80.0),
            ("96pxx192px", 25.4, 50.8),
            ("2in×1.5in", 50.8, 38.1),
            (" 33.5X20 ", 33.5, 20.0),
        ] {
            let size: RectSize = text.parse().unwrap_or_else(|e| panic!("{text}: {e}"));
            assert!((size.width_mm() - width).abs() < 1e-9, "{text}: {size}");
            assert!((size.height_mm() - height).abs() < 1e-9, "{text}: {size}");
        }
        for (text, shown) in
            [("120x80mm", "120x80mm"), ("4inx3in", "101.6x76.2mm"), ("1.234x2cm", "12.34x20mm")]
        {
            assert_eq!(text.parse::<RectSize>().unwrap().to_string(), shown);
        }
    }

    #[test]
    fn what_is_no_size_is_taught() {
        for text in ["", "120", "120mm", "120x", "x80", "120x80x", "wide", "120:80"] {
            let message = text.parse::<RectSize>().expect_err(text).to_string();
            assert!(message.contains("such as") || message.contains("is not a unit"), "{text}: {message}");
        }
        for text in ["0x80mm", "120x0", "-5x80", "120x-80mm", "0.5x80mm", "120x2001mm", "1e9x80"] {
            let message = text.parse::<RectSize>().expect_err(text).to_string();
            assert!(message.contains("from 1 to 2000 mm"), "{text}: {message}");
        }
        assert!(RectSize::new(f64::NAN, 80.0).is_err());
    }
}
