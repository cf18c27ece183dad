//! Values of options as they are typed.

use crate::domain::{CurveSpec, RectSize, parse_length_mm};
use crate::job::SlicingChoice;

/// A length in millimetres: `12mm`, `1.2cm`, `0.5in`, `34pt`, `45px` or `12`.
pub(super) fn length(text: &str) -> Result<f64, String> {
    parse_length_mm(text).map_err(|e| e.to_string())
}

/// A curve: `line:120mm`, `circle:65mm`, `path:FILE.svg#id`.
pub(super) fn curve(text: &str) -> Result<CurveSpec, String> {
    text.parse::<CurveSpec>().map_err(|e| e.to_string())
}

/// A size: `120x80mm`.
pub(super) fn size(text: &str) -> Result<RectSize, String> {
    text.parse::<RectSize>().map_err(|e| e.to_string())
}

/// `reeb`, `reeb:0.2mm` or `uniform:12`.
pub(super) fn slicing(text: &str) -> Result<SlicingChoice, String> {
    let wanted =
        "use reeb, reeb:LENGTH (events of at least this persistence), or uniform:T (T equally spaced cuts)";
    match text.split_once(':') {
        None if text == "reeb" => Ok(SlicingChoice::Reeb),
        Some(("reeb", persistence)) => length(persistence).map(SlicingChoice::Persistence),
        Some(("uniform", lines)) => match lines.parse::<usize>() {
            Ok(lines) if lines > 0 => Ok(SlicingChoice::Uniform(lines)),
            _ => Err(format!("'{lines}' is no number of cuts; {wanted}")),
        },
        _ => Err(format!("'{text}' is no way of slicing; {wanted}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slicing_is_read_and_taught() {
        assert_eq!(slicing("reeb"), Ok(SlicingChoice::Reeb));
        assert_eq!(slicing("reeb:1cm"), Ok(SlicingChoice::Persistence(10.0)));
        assert_eq!(slicing("uniform:12"), Ok(SlicingChoice::Uniform(12)));
        for wrong in ["uniform", "uniform:0", "uniform:x", "rebe", ""] {
            assert!(slicing(wrong).unwrap_err().contains("use reeb"), "{wrong}");
        }
    }
}
