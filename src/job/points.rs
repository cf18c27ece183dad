//! Points of a curve in space, from a table or an OBJ.

use std::path::Path;

use glam::DVec3;

use super::error::JobError;

/// The largest file that is read.
const MAX_BYTES: u64 = 64 << 20;
/// Ends that are nearer to each other than this, in millimetres, are one: tables are written with rounded sines.
const SAME_MM: f64 = 1e-3;

/// A polyline in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Where it goes through, without the first point again at the end.
    pub points: Vec<DVec3>,
    /// Whether the last point is followed by the first.
    pub is_closed: bool,
}

/// Reads an OBJ (vertices and one polyline, or vertices in their order) or else a table with x, y and z in each row, apart by commas,
/// semicolons, tabs or spaces. Empty rows, rows after `#`, and a first row without numbers are passed over. The curve is closed when its last point
/// is its first, to a thousandth of a millimetre.
///
/// # Errors
/// [`JobError::Option`] names the line that cannot be read.
pub(super) fn read_points(file: &Path) -> Result<Points, JobError> {
    let refuse = |found: String, wanted: &str| JobError::Option {
        option: "--along",
        found: format!("{}: {found}", file.display()),
        wanted: wanted.to_owned(),
    };
    let unreadable =
        |error: std::io::Error| refuse(error.to_string(), "name a table of x, y and z, or an OBJ");
    if std::fs::metadata(file).map_err(unreadable)?.len() > MAX_BYTES {
        return Err(refuse("it has more than 64 MiB".to_owned(), "a curve of fewer points is enough"));
    }
    let text = std::fs::read_to_string(file).map_err(unreadable)?;
    let is_obj = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    points_of(&text, is_obj).map_err(|(line, found)| {
        let wanted = if is_obj {
            "write v x y z for each point and one l with their numbers"
        } else {
            "write x, y and z in millimetres in each row, such as 12.5, 0, 3"
        };
        refuse(format!("line {line}: {found}"), wanted)
    })
}

fn points_of(text: &str, is_obj: bool) -> Result<Points, Wrong> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut points = if is_obj { obj(text)? } else { table(text)? };
    let gap_mm = |points: &[DVec3]| points[0].distance(points[points.len() - 1]);
    let is_closed = points.len() > 2 && gap_mm(&points) < SAME_MM;
    if is_closed {
        points.pop();
    }
    Ok(Points { points, is_closed })
}

/// What is wrong, and on which line.
type Wrong = (usize, String);

fn numbers<'t>(words: impl Iterator<Item = &'t str>) -> Option<DVec3> {
    let numbers: Vec<f64> = words.map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let [x, y, z] = numbers[..] else { return None };
    let point = DVec3::new(x, y, z);
    point.is_finite().then_some(point)
}

fn table(text: &str) -> Result<Vec<DVec3>, Wrong> {
    let mut points = Vec::new();
    let mut is_first = true;
    for (line, row) in (1..).zip(text.lines()) {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let words = || row.split([',', ';', '\t', ' ']).map(str::trim).filter(|word| !word.is_empty());
        match numbers(words()) {
            Some(point) => points.push(point),
            // A heading.
            None if is_first && words().all(|word| word.parse::<f64>().is_err()) => {}
            None => return Err((line, format!("'{row}' is not a point"))),
        }
        is_first = false;
    }
    Ok(points)
}

fn obj(text: &str) -> Result<Vec<DVec3>, Wrong> {
    let mut vertices = Vec::new();
    let mut polyline: Option<Vec<DVec3>> = None;
    let mut face = None;
    for (line, row) in (1..).zip(text.lines()) {
        let mut words = row.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => {
                let point =
                    numbers(words.take(3)).ok_or_else(|| (line, format!("'{row}' is not a point")))?;
                vertices.push(point);
            }
            Some("l") => {
                if polyline.is_some() {
                    return Err((line, "it has a second polyline, and a band follows one".to_owned()));
                }
                let vertex = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    let index = if number < 0 { vertices.len() as i64 + number } else { number - 1 };
                    usize::try_from(index).ok().and_then(|i| vertices.get(i)).copied()
                };
                let found: Option<Vec<DVec3>> = words.map(vertex).collect();
                polyline =
                    Some(found.ok_or_else(|| (line, format!("'{row}' names a vertex that is not there")))?);
            }
            Some("f") => face = face.or(Some(line)),
            _ => {}
        }
    }
    match (polyline, face) {
        (Some(polyline), _) => Ok(polyline),
        (None, Some(line)) => Err((line, "it is a mesh without a polyline".to_owned())),
        (None, None) => Ok(vertices),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<Points, String> {
        points_of(text, name.ends_with(".obj")).map_err(|(line, found)| format!("line {line}: {found}"))
    }

    #[test]
    fn tables_in_several_hands() {
        let wanted = vec![DVec3::new(0.0, 1.0, 2.5), DVec3::new(-3.0, 0.0, 1e2)];
        for text in
            ["0,1,2.5\n-3,0,100\n", "x; y; z\n0;1;2.5\r\n\n-3; 0; 1e2 # end", "# a\n0 1\t2.5\n -3  0 100"]
        {
            let points = read("a.csv", text).unwrap();
            assert_eq!((&points.points, points.is_closed), (&wanted, false), "{text}");
        }
        assert!(read("a.csv", "0,0,0\n9,0,0\n9,9,0\n0,-9.8e-15,0\n").unwrap().is_closed);
        assert_eq!(read("a.csv", "\u{feff}0,0,0\n9,0,0\n").unwrap().points.len(), 2);
        let error = read("a.csv", "0,0,0\n9,0\n").unwrap_err();
        assert!(error.contains("line 2: '9,0' is not a point"), "{error}");
        assert!(read("a.csv", "x,y,z\nu,v,w\n").unwrap_err().contains("line 2"));
    }

    #[test]
    fn polylines_of_an_obj() {
        let text = "o curve\nv 0 0 0\nv 9 0 0 1\nv 9 9 3\nl 3 2 1 -1\n";
        let points = read("a.obj", text).unwrap();
        assert!(
            points.is_closed && points.points.len() == 3 && points.points[0] == DVec3::new(9.0, 9.0, 3.0)
        );
        assert_eq!(read("a.obj", "v 1 2 3\nv 4 5 6\n").unwrap().points.len(), 2);
        assert!(
            read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
                .unwrap_err()
                .contains("line 4: it is a mesh")
        );
        assert!(read("a.obj", "v 0 0 0\nl 1 2\n").unwrap_err().contains("a vertex that is not there"));
        assert!(read("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\nl 2 1\n").unwrap_err().contains("a second polyline"));
        assert!(read_points(Path::new("none.csv")).is_err());
    }
}
