//! Values of options as they are typed.

use crate::domain::{CurveSpec, RectSize, Roll, parse_length_mm};
use crate::fabricate::Bed;
use crate::job::{
    ControlPoints, Drape, Height, KeptRange, SheetSize, SlicingChoice, StitchMethod, Wanted, WantedError,
};
use crate::verify::Between;

/// A length in millimetres: `12mm`, `1.2cm`, `0.5in`, `34pt`, `45px` or `12`.
pub(super) fn length(text: &str) -> Result<f64, String> {
    parse_length_mm(text).map_err(|e| e.to_string())
}

/// Several lengths in millimetres. (A name of its own, as the parser of arguments gives lists a meaning.)
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lengths(pub(super) Vec<f64>);

/// `12,10,8mm`: a unit at the end is that of all that have none.
pub(super) fn lengths(text: &str) -> Result<Lengths, String> {
    let unit = &text[text.trim_end_matches(|c: char| c.is_ascii_alphabetic()).len()..];
    let is_bare = |part: &str| part.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    let one = |part: &str| match part.trim() {
        part if is_bare(part) => length(&format!("{part}{unit}")),
        part => length(part),
    };
    let lengths = text.split(',').map(one).collect::<Result<_, _>>();
    lengths
        .map(Lengths)
        .map_err(|reason| format!("{reason}; write lengths with commas between them, such as 12,10,8mm"))
}

/// Two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair<T>(pub(super) [T; 2]);

impl<T: std::fmt::Display> std::fmt::Display for Pair<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [a, b] = &self.0;
        write!(f, "{a},{b}")
    }
}

/// `5,2`.
pub(super) fn pair<T: std::str::FromStr>(text: &str) -> Result<Pair<T>, String> {
    let numbers =
        text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    numbers.map(Pair).ok_or_else(|| {
        format!("'{text}' is no pair; write two numbers with a comma between them, such as 5,2")
    })
}

/// A size of memory in bytes: `512MB`, `2GB`, `2GiB`.
pub(super) fn memory(text: &str) -> Result<usize, String> {
    let wanted = "use a number of megabytes or gigabytes, as 512MB or 2GB";
    let upper = text.to_ascii_uppercase();
    // A MiB is what is meant here by MB.
    let short = upper.strip_suffix("IB").map_or_else(|| upper.clone(), |number| format!("{number}B"));
    let (number, unit) = match (short.strip_suffix("MB"), short.strip_suffix("GB")) {
        (Some(number), _) => (number, 1usize << 20),
        (_, Some(number)) => (number, 1 << 30),
        _ => return Err(format!("'{text}' is no size of memory; {wanted}")),
    };
    match number.trim().parse::<usize>().ok().and_then(|n| n.checked_mul(unit)) {
        Some(bytes) if bytes > 0 => Ok(bytes),
        _ => Err(format!("'{text}' is no size of memory; {wanted}")),
    }
}

/// Millions of partial runs, as a number of them: `4`, `0.5`.
pub(super) fn effort(text: &str) -> Result<usize, String> {
    match text.parse::<f64>() {
        Ok(millions) if millions > 0.0 && millions <= 1e6 => Ok((millions * 1e6).ceil() as usize),
        _ => {
            Err(format!("'{text}' is no number of millions; use one above 0 and up to 1000000, as 20 or 0.5"))
        }
    }
}

/// A curve: `line:120mm`, `circle:65mm`, `path:FILE.svg#id`.
pub(super) fn curve(text: &str) -> Result<CurveSpec, String> {
    text.parse::<CurveSpec>().map_err(|e| e.to_string())
}

/// A printer's bed: `220x220mm` or, with a height, `220x220x250mm`. A unit at the end is that of all.
pub(super) fn bed(text: &str) -> Result<Bed, String> {
    let wrong = |reason: String| format!("{reason}; give a bed as 220x220mm or 220x220x250mm");
    // The x of px is no separator.
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = &text[number.len()..];
    let side = |side: &str| match length(&format!("{side}{unit}")) {
        Ok(mm) if (1.0..=100_000.0).contains(&mm) => Ok(mm),
        Ok(mm) => Err(wrong(format!("{mm} mm is no side of a bed, which is from 1 mm to 100 m"))),
        Err(reason) => Err(wrong(reason)),
    };
    let sides: Vec<f64> = number.split('x').map(side).collect::<Result<_, _>>()?;
    match sides[..] {
        [width_mm, depth_mm] => Ok(Bed { width_mm, depth_mm, height_mm: None }),
        [width_mm, depth_mm, height] => Ok(Bed { width_mm, depth_mm, height_mm: Some(height) }),
        _ => Err(wrong(format!("'{text}' has {} number(s)", sides.len()))),
    }
}

/// A size: `120x80mm`.
pub(super) fn size(text: &str) -> Result<RectSize, String> {
    text.parse::<RectSize>().map_err(|e| e.to_string())
}

/// What a rectangle is rolled to: `diameter=120mm,top=80mm`.
pub(super) fn roll(text: &str) -> Result<Roll, String> {
    text.parse::<Roll>().map_err(|e| e.to_string())
}

/// A height field: `hill.csv`, `hill.png,height=20mm`.
pub(super) fn drape(text: &str) -> Result<Drape, String> {
    text.parse::<Drape>().map_err(|e| e.to_string())
}

/// A height on a model: `30mm`, `50%`.
pub(super) fn height(text: &str) -> Result<Height, String> {
    text.parse::<Height>().map_err(|e| e.to_string())
}

/// Points of a model: `20,0,10; 0,20,20`.
pub(super) fn points(text: &str) -> Result<ControlPoints, String> {
    text.parse::<ControlPoints>().map_err(|e| e.to_string())
}

/// The size of a plate: `300x200mm`.
pub(super) fn sheet(text: &str) -> Result<SheetSize, String> {
    size(text).map(|size| SheetSize { width_mm: size.width_mm(), height_mm: size.height_mm() })
}

/// How many of something: `None` when any number will do. (A name of its own, as the parser of arguments gives
/// `Option` a meaning.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Count(pub(super) Option<Wanted>);

impl Count {
    /// The same for what is counted on a file.
    pub(super) fn between(self) -> Option<Between> {
        self.0.map(|wanted| Between { least: wanted.least() as usize, most: wanted.most() as usize })
    }
}

/// `3`, `2..5` or `any`.
pub(super) fn wanted(text: &str) -> Result<Count, String> {
    match text {
        "any" => Ok(Count(None)),
        text => {
            text.parse().map(|wanted| Count(Some(wanted))).map_err(|e: WantedError| format!("{e}, or any"))
        }
    }
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

/// A range of the exemplar: `10mm..24mm`.
pub(super) fn kept(text: &str) -> Result<KeptRange, String> {
    let Some((from, to)) = text.split_once("..") else {
        return Err(format!("'{text}' is no range; write two lengths and two dots, such as 10mm..24mm"));
    };
    let (from_mm, to_mm) = (length(from)?, length(to)?);
    if from_mm >= to_mm {
        return Err(format!("'{text}' ends before it begins; give the left end first"));
    }
    Ok(KeptRange { from_mm, to_mm })
}

/// `warp` or `lri`.
pub(super) fn stitch(text: &str) -> Result<StitchMethod, String> {
    text.parse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_two_lengths_in_order() {
        assert_eq!(kept("1.5..2.25cm"), Ok(KeptRange { from_mm: 1.5, to_mm: 22.5 }));
        assert_eq!(kept("1cm..12mm"), Ok(KeptRange { from_mm: 10.0, to_mm: 12.0 }));
        for wrong in ["10mm", "5mm..3mm", "4..4", "..3mm", "1mm..x", "1mm...."] {
            assert!(kept(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn beds_have_two_sides_or_three() {
        let two = Bed { width_mm: 220.0, depth_mm: 210.5, height_mm: None };
        assert_eq!((bed("220x210.5"), bed("22x21.05cm")), (Ok(two), Ok(two)));
        assert_eq!(bed("220x210.5x250mm"), Ok(Bed { height_mm: Some(250.0), ..two }));
        for wrong in ["", "220", "220x", "1x2x3x4", "0x220", "-5x220mm", "axb", "220x220furlong", "nanx5"] {
            assert!(bed(wrong).unwrap_err().contains("as 220x220mm"), "{wrong}");
        }
    }

    #[test]
    fn lists_of_lengths_share_their_last_unit() {
        assert_eq!(lengths("12,10, 8mm"), Ok(Lengths(vec![12.0, 10.0, 8.0])));
        assert_eq!(lengths("1.2,1cm"), Ok(Lengths(vec![12.0, 10.0])));
        assert_eq!(lengths("1cm,8mm"), Ok(Lengths(vec![10.0, 8.0])));
        for wrong in ["", "12,,8mm", "12;8", "a,b"] {
            assert!(lengths(wrong).unwrap_err().contains("such as 12,10,8mm"), "{wrong}");
        }
        assert_eq!(pair::<usize>("5, 2"), Ok(Pair([5, 2])));
        for wrong in ["", "5", "5,", "5,2,1", "a,b"] {
            assert!(pair::<usize>(wrong).unwrap_err().contains("such as 5,2"), "{wrong}");
        }
    }

    #[test]
    fn sizes_of_memory_have_units() {
        assert_eq!((memory("512MB"), memory("2gb")), (Ok(512 << 20), Ok(2 << 30)));
        assert_eq!((memory("512MiB"), memory("2 GiB")), (Ok(512 << 20), Ok(2 << 30)));
        for wrong in ["", "2", "0MB", "-1GB", "xMB", "99999999999999999GB"] {
            assert!(memory(wrong).unwrap_err().contains("as 512MB"), "{wrong}");
        }
    }

    #[test]
    fn effort_is_in_millions() {
        assert_eq!((effort("4"), effort("0.5")), (Ok(4_000_000), Ok(500_000)));
        for wrong in ["", "0", "-1", "nan", "inf", "4M"] {
            assert!(effort(wrong).unwrap_err().contains("as 20 or 0.5"), "{wrong}");
        }
    }

    #[test]
    fn counts_are_numbers_ranges_or_any() {
        assert_eq!(wanted("any").unwrap().between(), None);
        assert_eq!(wanted("1..2").unwrap().between(), Some(Between { least: 1, most: 2 }));
        assert_eq!(wanted("3").unwrap().between(), Some(3.into()));
        assert!(wanted("5..2").unwrap_err().contains("ends before it begins"));
        assert!(wanted("few").unwrap_err().ends_with("as 2..5, or any"));
    }

    #[test]
    fn choices_are_read_and_taught() {
        assert_eq!(slicing("reeb"), Ok(SlicingChoice::Reeb));
        assert_eq!(slicing("reeb:1cm"), Ok(SlicingChoice::Persistence(10.0)));
        assert_eq!(slicing("uniform:12"), Ok(SlicingChoice::Uniform(12)));
        assert_eq!((stitch("warp"), stitch("lri")), (Ok(StitchMethod::Warp), Ok(StitchMethod::Lri)));
        assert!(stitch("glue").unwrap_err().contains("use warp"));
        for wrong in ["uniform", "uniform:0", "uniform:x", "rebe", ""] {
            assert!(slicing(wrong).unwrap_err().contains("use reeb"), "{wrong}");
        }
    }
}
