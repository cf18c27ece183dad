//! The curve that a band follows, as it is named on a command line.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use super::length::{LengthError, parse_length_mm};

/// A curve by name. In the plane: `line:120mm`, `circle:65mm` (diameter), `path:FILE.svg` or `path:FILE.svg#id`. In space:
/// `ring:65mm` and `helix:65mm,pitch=12mm,turns=3` (inner diameters), `points:FILE.csv` or `points:FILE.obj`.
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
    /// A band that stands on a cylinder, its thickness outwards.
    Ring {
        /// The diameter of the inside in millimetres, positive.
        inner_mm: f64,
    },
    /// A band that winds around a cylinder.
    Helix {
        /// The diameter of the inside in millimetres, positive.
        inner_mm: f64,
        /// By how much each turn rises, in millimetres, positive.
        pitch_mm: f64,
        /// How often it goes round, positive.
        turns: f64,
    },
    /// A smooth curve through points in space.
    Points {
        /// A table of x, y and z in millimetres, or an OBJ with a polyline.
        file: PathBuf,
    },
    /// A curve on a model, which is no part of the name.
    Model {
        /// An STL, a 3MF or an OBJ.
        file: PathBuf,
    },
}

/// A text that names no curve.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CurveSpecError {
    /// The word before the colon is unknown, or there is no colon.
    #[error(
        "'{text}' names no curve; write line:LENGTH, circle:DIAMETER, path:FILE.svg or path:FILE.svg#id, such as line:120mm; in space ring:DIAMETER, helix:DIAMETER,pitch=LENGTH,turns=NUMBER or points:FILE.csv"
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
    /// A helix without its parts.
    #[error(
        "'{text}' is no helix: {wrong}; write helix:DIAMETER,pitch=LENGTH,turns=NUMBER, such as helix:65mm,pitch=12mm,turns=3"
    )]
    Helix {
        /// What was given.
        text: String,
        /// What is wrong.
        wrong: String,
    },
    /// Points without a file.
    #[error("'{text}' lacks a file name; write points:FILE.csv or points:FILE.obj")]
    Points {
        /// What was given.
        text: String,
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
            Some(("ring", value)) => Ok(Self::Ring { inner_mm: positive(value, "diameter", "ring:65mm")? }),
            Some(("helix", value)) => {
                let wrong = |wrong: String| CurveSpecError::Helix { text: text.to_owned(), wrong };
                let mut parts = value.split(',');
                let example = "helix:65mm,pitch=12mm,turns=3";
                let inner_mm = positive(parts.next().unwrap_or_default(), "diameter", example)?;
                let (mut pitch_mm, mut turns) = (None, None);
                for part in parts {
                    match part.trim().split_once('=') {
                        Some(("pitch", value)) => pitch_mm = Some(positive(value, "pitch", example)?),
                        Some(("turns", value)) => {
                            let number =
                                value.trim().parse().ok().filter(|n: &f64| *n > 0.0 && n.is_finite());
                            turns = Some(
                                number.ok_or_else(|| wrong(format!("'{value}' is no number of turns")))?,
                            );
                        }
                        _ => return Err(wrong(format!("'{part}' is neither pitch nor turns"))),
                    }
                }
                let pitch_mm = pitch_mm.ok_or_else(|| wrong("it lacks a pitch".to_owned()))?;
                let turns = turns.ok_or_else(|| wrong("it lacks its turns".to_owned()))?;
                Ok(Self::Helix { inner_mm, pitch_mm, turns })
            }
            Some(("points", "")) => Err(CurveSpecError::Points { text: text.to_owned() }),
            Some(("points", file)) => Ok(Self::Points { file: file.into() }),
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
            Self::Ring { inner_mm } => write!(f, "ring:{inner_mm}mm"),
            Self::Helix { inner_mm, pitch_mm, turns } => {
                write!(f, "helix:{inner_mm}mm,pitch={pitch_mm}mm,turns={turns}")
            }
            Self::Points { file } => write!(f, "points:{}", file.display()),
            Self::Model { file } => write!(f, "a curve on {}", file.display()),
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
        let planar =
            ["line:120mm", "circle:65mm", "path:a b.svg", "path:dir/c.svg#curve-1", "path:a#b.svg#c"];
        let spatial = ["ring:65mm", "helix:65mm,pitch=12mm,turns=3.5", "points:a b.csv"];
        for text in planar.into_iter().chain(spatial) {
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
        assert!(message("helix:65mm,pitch=12mm").contains("it lacks its turns; write helix:"));
        assert!(message("helix:65mm,turns=2").contains("it lacks a pitch"));
        assert!(message("helix:65mm,pitch=12mm,turns=0").contains("'0' is no number of turns"));
        assert!(message("helix:65mm,rise=3").contains("'rise=3' is neither pitch nor turns"));
        assert!(
            message("ring:0").contains("the diameter is 0 mm") && message("points:").contains("a file name")
        );
    }
}
