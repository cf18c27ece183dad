//! The area that a pattern is to fill, as it is named on a command line.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use super::size::{RectSize, RectSizeError};

/// An area by name: `rect:200x150mm`, `FILE.svg#id` or `FILE.svg` (the inside of a closed path), or `band` (the strip along a curve,
/// which is no part of the name).
#[derive(Debug, Clone, PartialEq)]
pub enum FillDomain {
    /// A rectangle.
    Rect(RectSize),
    /// The inside of a closed path of an SVG file; subpaths inside of others are holes.
    Path {
        /// The file.
        file: PathBuf,
        /// The `id` of the path element; `None` when the file has one path only.
        id: Option<String>,
    },
    /// The strip along a curve.
    Band,
}

/// A text that names no area.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FillDomainError {
    /// It is neither of the kinds.
    #[error(
        "'{text}' names no domain; write rect:WIDTHxHEIGHT, such as rect:200x150mm, FILE.svg#id or FILE.svg for the inside of a closed path, or band with --along and --width"
    )]
    Kind {
        /// What was given.
        text: String,
    },
    /// The size of a rectangle.
    #[error("in '{text}': {source}")]
    Size {
        /// What was given.
        text: String,
        /// What is wrong with the size.
        source: RectSizeError,
    },
    /// A `#` with no file before it, or with no id after it.
    #[error("'{text}' lacks {missing}; write FILE.svg#id or FILE.svg")]
    Path {
        /// What was given.
        text: String,
        /// What is missing.
        missing: &'static str,
    },
}

impl FromStr for FillDomain {
    type Err = FillDomainError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        if text == "band" {
            return Ok(Self::Band);
        }
        if let Some(size) = text.strip_prefix("rect:") {
            let size = size.parse();
            return size
                .map(Self::Rect)
                .map_err(|source| FillDomainError::Size { text: text.to_owned(), source });
        }
        // The last # separates the id, as ids cannot contain one and file names can.
        let (file, id) = match text.rsplit_once('#') {
            Some((file, id)) => (file, Some(id)),
            None => (text, None),
        };
        let missing = |missing| Err(FillDomainError::Path { text: text.to_owned(), missing });
        match (file, id) {
            ("", Some(_)) => missing("a file name"),
            (_, Some("")) => missing("an id after '#'"),
            _ if file.to_ascii_lowercase().ends_with(".svg") => {
                Ok(Self::Path { file: PathBuf::from(file), id: id.map(str::to_owned) })
            }
            _ => Err(FillDomainError::Kind { text: text.to_owned() }),
        }
    }
}

impl fmt::Display for FillDomain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rect(size) => write!(f, "rect:{size}"),
            Self::Path { file, id: None } => write!(f, "{}", file.display()),
            Self::Path { file, id: Some(id) } => write!(f, "{}#{id}", file.display()),
            Self::Band => write!(f, "band"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        for text in ["rect:200x150mm", "a b.svg", "dir/shirt.svg#front", "a#b.SVG#c", "band"] {
            assert_eq!(text.parse::<FillDomain>().unwrap().to_string(), text);
        }
        let size = RectSize::new(200.0, 150.0).unwrap();
        assert_eq!("rect:20x15cm".parse(), Ok(FillDomain::Rect(size)));
    }

    #[test]
    fn errors_teach_the_syntax() {
        let message = |text: &str| text.parse::<FillDomain>().unwrap_err().to_string();
        for text in ["", "200x150mm", "circle:65mm", "shirt.png", "Band"] {
            assert!(message(text).contains("rect:200x150mm, FILE.svg#id or FILE.svg"), "{}", message(text));
        }
        assert!(message("rect:200").starts_with("in 'rect:200': '200' is not a size"));
        assert!(message("rect:0x150mm").contains("the width is 0 mm"));
        assert!(message("#a").contains("lacks a file name") && message("a.svg#").contains("an id after '#'"));
    }
}
