//! The triangles of a Wavefront OBJ file.
//!
//! The format has no unit; millimetres are taken, which is what slicers do. Groups, objects, normals, texture
//! coordinates and materials are passed over: shells are counted by what hangs together. Excluded, by an error
//! that says so: faces of more than three corners, lines, points, curves and surfaces.

use super::error::VerifyError;
use super::shells::{Facet, MeshReport, survey};

/// The largest file that is read, in bytes.
const MAX_BYTES: usize = 1 << 30;

/// Reads an OBJ of triangles, in millimetres, and counts its shells and their genus.
///
/// # Errors
/// [`VerifyError`] with the line that cannot be read. What is wrong with the solid itself is a fault of the
/// report.
pub fn read_obj(bytes: &[u8]) -> Result<MeshReport, VerifyError> {
    Ok(survey(&facets(bytes, false)?))
}

/// The facets of an OBJ, at least one. As a model that something is made on, `fans` says, faces with more than three corners are parted into
/// fans, and lines and points passed over; they are errors else.
pub(super) fn facets(bytes: &[u8], fans: bool) -> Result<Vec<Facet>, VerifyError> {
    if bytes.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    let error = |line: usize, message: String| VerifyError::Mesh {
        kind: "OBJ",
        line: u32::try_from(line).unwrap_or(u32::MAX),
        message,
    };
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        error(line, "bytes that are no UTF-8 text".to_owned())
    })?;
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let mut facets = Vec::new();
    for (line, content) in text.lines().enumerate() {
        let mut words = content.split('#').next().unwrap_or("").split_whitespace();
        let error = |message| error(line + 1, message);
        match words.next() {
            Some("v") => vertices.push(vertex(words).map_err(error)?),
            Some("f") => {
                let corners = face(words, vertices.len()).map_err(error)?;
                if corners.len() < 3 || corners.len() > 3 && !fans {
                    return Err(error(format!(
                        "a face of {} corners; only triangles are counted",
                        corners.len()
                    )));
                }
                facets.extend(corners[1..].windows(2).map(|pair| Facet {
                    normal: [0.0; 3],
                    corners: [corners[0], pair[0], pair[1]].map(|v| vertices[v]),
                }));
            }
            // Lines and points beside the surface of a model are nobody's facets.
            Some("l" | "p") if fans => {}
            None | Some("vn" | "vt" | "g" | "o" | "s" | "usemtl" | "mtllib") => {}
            Some(other) => {
                return Err(error(format!("{other:?} cannot be counted; a mesh of triangles is wanted")));
            }
        }
    }
    match facets.is_empty() {
        true => Err(VerifyError::NoFacets),
        false => Ok(facets),
    }
}

/// Three coordinates; weights and colours after them are passed over.
fn vertex<'a>(words: impl Iterator<Item = &'a str>) -> Result<[f32; 3], String> {
    let numbers: Vec<&str> = words.collect();
    if numbers.len() < 3 {
        return Err(format!("a vertex of {} coordinate(s); it has three", numbers.len()));
    }
    let mut point = [0f32; 3];
    for (x, text) in point.iter_mut().zip(numbers) {
        *x = text.parse().map_err(|_| format!("{text:?} is no number"))?;
        if !x.is_finite() {
            return Err(format!("the coordinate {text} is no finite 32-bit number"));
        }
    }
    Ok(point)
}

/// Numbers of vertices, counted from 0.
fn face<'a>(words: impl Iterator<Item = &'a str>, known: usize) -> Result<Vec<usize>, String> {
    let number = |corner: &str| {
        let text = corner.split('/').next().unwrap_or("");
        let number: i64 = text.parse().map_err(|_| format!("{corner:?} is no number of a vertex"))?;
        // Vertices count from 1, or from −1 backwards.
        let index =
            if number < 0 { number.checked_add_unsigned(known as u64) } else { number.checked_sub(1) };
        index
            .and_then(|i| usize::try_from(i).ok())
            .filter(|&i| i < known)
            .ok_or_else(|| format!("vertex {number}, but {known} are given before it"))
    };
    words.map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str = "# a corner\no corner\nv 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nvn 0 0 1\n\
                               g all\nf 1 3 2\nf 1/1 2/1 4/1\nf -4//1 -1//1 -2//1\nf 2 3 4 # the long one\n";

    fn message(text: &str) -> String {
        read_obj(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn every_form_of_a_face_is_read() {
        let report = read_obj(TETRAHEDRON.as_bytes()).unwrap();
        assert_eq!((report.triangles, report.vertices, report.shells.len(), report.genus), (4, 4, 1, 0));
        assert_eq!((report.volume_mm3, report.faults), (4.5, vec![]));
    }

    #[test]
    fn an_open_mesh_is_a_fault() {
        let open = TETRAHEDRON.replace("f 1 3 2\n", "");
        assert_eq!(read_obj(open.as_bytes()).unwrap().faults.len(), 3);
    }

    #[test]
    fn messages_name_the_line() {
        assert_eq!(
            message(&TETRAHEDRON.replace("f 1 3 2", "f 1 3 5")),
            "line 9 of the OBJ: vertex 5, but 4 are given before it"
        );
        assert_eq!(
            message("v 0 0 0\nv 1 0\n"),
            "line 2 of the OBJ: a vertex of 2 coordinate(s); it has three"
        );
        assert!(message("v 0 0 zero\n").contains("\"zero\" is no number"));
        assert!(message("v 0 0 1e99\n").contains("no finite"));
        assert!(message("v 0 0 nan\n").contains("no finite"));
        assert!(message("f 0 1 2\n").contains("vertex 0"));
        assert!(message(&TETRAHEDRON.replace("f 1 3 2", "f 1 3 2 4")).contains("a face of 4 corners"));
        assert!(message("curv 0 1 2\n").contains("\"curv\" cannot be counted"));
        assert_eq!(message("v 0 0 0\n"), "the file has no triangles");
        assert!(read_obj(b"v 0 0 0\n\xff").unwrap_err().to_string().starts_with("line 2"));
    }
}
