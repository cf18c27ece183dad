//! Tables of heights: the grey values of a PNG, or numbers in text.

use std::path::{Path, PathBuf};

use resvg::tiny_skia::Pixmap;
use thiserror::Error;

/// The largest file that is read.
const MAX_BYTES: u64 = 64 << 20;
/// The most values in a table, and the fewest in a row or column: what lies between four is curved.
const MAX_VALUES: usize = 16 << 20;
const MIN_SIDE: usize = 4;

/// A table of heights, as it is seen from the front: the first row is the upper one.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// Row after row, from the left.
    pub values: Vec<f64>,
    /// How many a row has.
    pub columns: usize,
    /// Whether values are parts from 0, black, to 1, white, and not millimetres.
    pub are_parts: bool,
}

/// A file that is no table of heights.
#[derive(Debug, Error)]
#[error("{}: {found}; {wanted}", file.display())]
pub struct HeightsError {
    file: PathBuf,
    found: String,
    wanted: &'static str,
}

/// Reads a PNG, whose greys are heights, or else text: numbers in millimetres apart by commas, semicolons, tabs or spaces, as many in each row.
/// Empty rows and what is after `#` are passed over.
///
/// # Errors
/// [`HeightsError`] says what is wrong, and in which line.
pub fn read_heights(file: &Path) -> Result<Heights, HeightsError> {
    let refuse = |found: String, wanted: &'static str| HeightsError { file: file.to_owned(), found, wanted };
    let unreadable =
        |error: std::io::Error| refuse(error.to_string(), "name a PNG, or a table of heights in mm");
    if std::fs::metadata(file).map_err(unreadable)?.len() > MAX_BYTES {
        return Err(refuse(
            "it has more than 64 MiB".to_owned(),
            "use fewer heights: they are smoothed anyway",
        ));
    }
    let bytes = std::fs::read(file).map_err(unreadable)?;
    let heights = if bytes.starts_with(b"\x89PNG") {
        greys(&bytes).map_err(|found| refuse(found, "save it as a grey or RGB PNG without transparency"))?
    } else {
        let text = std::str::from_utf8(&bytes).map_err(|_| {
            refuse("it is neither a PNG nor text".to_owned(), "name a PNG, or a table of heights in mm")
        })?;
        table(text)
            .map_err(|found| refuse(found, "write as many numbers in mm in each row, such as 0, 1.5, 3"))?
    };
    let rows = heights.values.len() / heights.columns.max(1);
    if heights.columns < MIN_SIDE || rows < MIN_SIDE || heights.values.len() > MAX_VALUES {
        let found = format!("it is a table of {} x {rows} heights", heights.columns);
        return Err(refuse(found, "use from 4 x 4 to some 4000 x 4000"));
    }
    Ok(heights)
}

fn greys(bytes: &[u8]) -> Result<Heights, String> {
    let picture = Pixmap::decode_png(bytes).map_err(|error| error.to_string())?;
    if picture.pixels().iter().any(|p| p.alpha() != u8::MAX) {
        return Err("parts of it are transparent, which is no height".to_owned());
    }
    // As bright as they look (Rec. 601).
    let grey =
        |[r, g, b]: [u8; 3]| (0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)) / 255.0;
    let values = picture.pixels().iter().map(|p| grey([p.red(), p.green(), p.blue()])).collect();
    Ok(Heights { values, columns: picture.width() as usize, are_parts: true })
}

fn table(text: &str) -> Result<Heights, String> {
    let (mut values, mut columns) = (Vec::new(), 0);
    for (line, row) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let row = row.split('#').next().unwrap_or_default();
        if row.contains(';') && row.contains(',') {
            return Err(format!(
                "line {line} has commas and semicolons, so that decimals cannot be told: write 1.5 for 1,5"
            ));
        }
        let before = values.len();
        for word in row.split([',', ';', '\t', ' ']).map(str::trim).filter(|word| !word.is_empty()) {
            match word.parse::<f64>() {
                Ok(height) if height.is_finite() && height.abs() < 1e4 => values.push(height),
                _ => return Err(format!("line {line}: '{word}' is no height in mm")),
            }
        }
        let found = values.len() - before;
        if found > 0 && columns > 0 && found != columns {
            return Err(format!("line {line} has {found} heights and those before it {columns}"));
        }
        columns = if found > 0 { found } else { columns };
    }
    Ok(Heights { values, columns, are_parts: false })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_and_faults_have_a_line() {
        let read = table("# a hill\n0, 1, 2\n\n3 4\t5 # right\n").unwrap();
        assert_eq!((read.columns, read.values.len(), read.are_parts), (3, 6, false));
        assert_eq!(table("1 2\n1 2 3\n").unwrap_err(), "line 2 has 3 heights and those before it 2");
        assert_eq!(table("1 2\n1 x\n").unwrap_err(), "line 2: 'x' is no height in mm");
        assert!(table("1,5;2,5\n").unwrap_err().contains("1.5 for 1,5"));
        assert!(table("NaN").is_err() && table("1e9").is_err());
    }

    #[test]
    fn greys_are_heights() {
        let mut picture = Pixmap::new(5, 4).unwrap();
        picture.fill(resvg::tiny_skia::Color::from_rgba8(51, 51, 51, 255));
        let read = greys(&picture.encode_png().unwrap()).unwrap();
        assert_eq!((read.columns, read.values.len(), read.are_parts), (5, 20, true));
        assert!(read.values.iter().all(|grey| (grey - 0.2).abs() < 1e-9));
        let clear = Pixmap::new(5, 4).unwrap();
        assert!(greys(&clear.encode_png().unwrap()).unwrap_err().contains("transparent"));
        assert!(greys(b"\x89PNG and no more").is_err());
    }
}
