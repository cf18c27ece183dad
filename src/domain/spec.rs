//! The curve that a band follows, as it is named on a command line.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use super::length::{LengthError, parse_length_mm};

/// A curve by name: `line:120mm`, `circle:65mm` (diameter), `path:FILE.svg` or `path:FILE.svg#id`.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveSpec {
    /// A straight line to the right.
    Line {
        /// Its length in millimetres, positive.
        length_mm: f64,
    },
    /// A circle, travelled clockwise so that v up points outward.
    Circle {
        /// The diameter of the centre line v = 0 in millimetres, positive.
        diameter_mm: f64,
    },
    /// A path of an SVG file, open or closed.
    Path {
        /// The file.
        file: PathBuf,
        /// The `id` of the path element; `None` when the file has one path only.
        id: Option<String>,
    },
}

/// A text that names no curve.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CurveSpecError {
    /// The word before the colon is unknown, or there is no colon.
    #[error(
        "'{text}' names no curve; write line:LENGTH, circle:DIAMETER, path:FILE.svg or path:FILE.svg#id, such as line:120mm"
    )]
    Kind {
        /// What was given.
        text: String,
    },
    /// The length does not parse.
    #[error("in '{text}': {source}")]
    Length {
        /// What was given.
        text: String,
        /// What is wrong with the length.
        source: LengthError,
    },
    /// The length is zero or negative.
    #[error("in '{text}' the {what} is {value_mm} mm; it must be more than 0, such as {example}")]
    NotPositive {
        /// What was given.
        text: String,
        /// `length` or `diameter`.
        what: &'static str,
        /// The length in millimetres, as text.
        value_mm: String,
        /// A specification that would work.
        example: &'static str,
    },
    /// A path without a file name, or with `#` and no id after it.
    #[error("'{text}' lacks {missing}; write path:FILE.svg or path:FILE.svg#id")]
    Path {
        /// What was given.
        text: String,
        /// What is missing.
        missing: &'static str,
    },
}

impl FromStr for CurveSpec {
    type Err = CurveSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let positive = |value: &str, what, example| {
            let mm = parse_length_mm(value)
                .map_err(|source| CurveSpecError::Length { text: text.to_owned(), source })?;
            if mm > 0.0 {
                Ok(mm)
            } else {
                Err(CurveSpecError::NotPositive {
                    text: text.to_owned(),
                    what,
                    value_mm: mm.to_string(),
                    example,
                })
            }
        };
        match text.trim().split_once(':') {
            Some(("line", value)) => Ok(Self::Line { length_mm: positive(value, "length", "line:120mm")? }),
            Some(("circle", value)) => {
                Ok(Self::Circle { diameter_mm: positive(value, "diameter", "circle:65mm")? })
            }
            Some(("path", value)) => path(text, value),
            _ => Err(CurveSpecError::Kind { text: text.to_owned() }),
        }
    }
}

/// The last `#` separates the id, as ids cannot contain one and file names can.
fn path(text: &str, value: &str) -> Result<CurveSpec, CurveSpecError> {
    let missing = |missing| CurveSpecError::Path { text: text.to_owned(), missing };
    let (file, id) = match value.rsplit_once('#') {
        Some((_, "")) => return Err(missing("an id after '#'")),
        Some((file, id)) => (file, Some(id.to_owned())),
        None => (value, None),
    };
    if file.is_empty() {
        return Err(missing("a file name"));
    }
    Ok(CurveSpec::Path { file: PathBuf::from(file), id })
}

impl fmt::Display for CurveSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { length_mm } => write!(f, "line:{length_mm}mm"),
            Self::Circle { diameter_mm } => write!(f, "circle:{diameter_mm}mm"),
            Self::Path { file, id: None } => write!(f, "path:{}", file.display()),
            Self::Path { file, id: Some(id) } => write!(f, "path:{}#{id}", file.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        for text in ["line:120mm", "circle:65mm", "path:a b.svg", "path:dir/c.svg#curve-1", "path:a#b.svg#c"]
        {
            assert_eq!(text.parse::<CurveSpec>().unwrap().to_string(), text);
        }
        assert_eq!("circle:6.5cm".parse(), Ok(CurveSpec::Circle { diameter_mm: 65.0 }));
        let path = CurveSpec::Path { file: "a#b.svg".into(), id: Some("c".into()) };
        assert_eq!("path:a#b.svg#c".parse(), Ok(path));
    }

    #[test]
    fn errors_teach_the_syntax() {
        let message = |text: &str| text.parse::<CurveSpec>().unwrap_err().to_string();
        let kinds = "line:LENGTH, circle:DIAMETER, path:FILE.svg or path:FILE.svg#id";
        for text in ["", "120mm", "square:3mm", "line", "lines:3mm"] {
            assert!(message(text).contains(kinds), "{}", message(text));
        }
        assert_eq!(
            message("line:0mm"),
            "in 'line:0mm' the length is 0 mm; it must be more than 0, such as line:120mm"
        );
        assert_eq!(
            message("circle:-2cm"),
            "in 'circle:-2cm' the diameter is -20 mm; it must be more than 0, such as circle:65mm"
        );
        assert!(message("line:NaN").starts_with("in 'line:NaN': 'NaN' is not a length"));
        assert!(message("circle:3furlongs").contains("'furlongs' in '3furlongs' is not a unit"));
        assert_eq!(
            message("path:#a"),
            "'path:#a' lacks a file name; write path:FILE.svg or path:FILE.svg#id"
        );
        assert!(message("path:").contains("a file name"));
        assert!(message("path:a.svg#").contains("an id after '#'"));
    }
}
