//! Lengths as people type them.

use thiserror::Error;

/// Units and how many millimetres they are. px are CSS pixels, 96 to the inch.
const UNITS: [(&str, f64); 6] =
    [("", 1.0), ("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("pt", 25.4 / 72.0), ("px", 25.4 / 96.0)];

/// A text that is not a length.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LengthError {
    /// There is no number, or it is not a finite one.
    #[error("'{text}' is not a length; write a number and a unit, such as 120mm")]
    Number {
        /// What was given.
        text: String,
    },
    /// The number is followed by something that is not a unit.
    #[error("'{unit}' in '{text}' is not a unit; use mm, cm, in, pt, px (96 to the inch) or none (mm)")]
    Unit {
        /// What was given.
        text: String,
        /// What stands after the number.
        unit: String,
    },
}

/// The length `text` in millimetres: a finite decimal number of either sign, then mm, cm, in, pt, px (96 to
/// the inch) or nothing, which means mm. Space around and between is allowed.
///
/// # Errors
/// [`LengthError`] when there is no finite number, or what follows it is no unit.
pub fn parse_length_mm(text: &str) -> Result<f64, LengthError> {
    let number_error = || LengthError::Number { text: text.to_owned() };
    let trimmed = text.trim();
    let end = trimmed.rfind(|c: char| c.is_ascii_digit() || c == '.').ok_or_else(number_error)? + 1;
    let (number, unit) = trimmed.split_at(end);
    let value: f64 = number.parse().map_err(|_| number_error())?;
    let unit = unit.trim_start();
    let Some((_, scale)) = UNITS.iter().find(|(name, _)| *name == unit) else {
        return Err(LengthError::Unit { text: text.to_owned(), unit: unit.to_owned() });
    };
    let mm = value * scale;
    if mm.is_finite() { Ok(mm) } else { Err(number_error()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units() {
        for (text, mm) in [
            ("120mm", 120.0),
            ("6.5cm", 65.0),
            ("2in", 50.8),
            ("72pt", 25.4),
            ("96px", 25.4),
            ("120", 120.0),
            (" 1.5e1 mm ", 15.0),
            ("-.5mm", -0.5),
            ("5.", 5.0),
        ] {
            let found = parse_length_mm(text).unwrap();
            assert!((found - mm).abs() < 1e-12, "{text}: {found}");
        }
    }

    #[test]
    fn errors_say_what_would_work() {
        let message = |text| parse_length_mm(text).unwrap_err().to_string();
        assert_eq!(
            message("5em"),
            "'em' in '5em' is not a unit; use mm, cm, in, pt, px (96 to the inch) or none (mm)"
        );
        for text in ["", "mm", "nan", "NaN mm", "inf", "1e999mm", "1,5mm", "--5", "1..2"] {
            assert_eq!(
                message(text),
                format!("'{text}' is not a length; write a number and a unit, such as 120mm")
            );
        }
    }
}
