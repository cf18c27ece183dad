//! The facets of an STL file, binary or ASCII.

use super::error::VerifyError;
use super::shells::{Facet, MeshReport, survey};

/// Header, count, and each facet of a binary STL, in bytes.
const HEADER: usize = 80;
const PREAMBLE: usize = HEADER + 4;
const RECORD: usize = 50;
/// The largest file that is read: twenty million facets.
const MAX_BYTES: usize = 1 << 30;

/// Reads a binary or ASCII STL, in millimetres, and counts its shells and their genus.
///
/// A file is binary when its length is the one that its count asks for; a header that begins with "solid"
/// does not make it ASCII.
///
/// # Errors
/// [`VerifyError`] when the bytes are no whole STL. What is wrong with the solid itself is a fault of the
/// report.
pub fn read_stl(bytes: &[u8]) -> Result<MeshReport, VerifyError> {
    Ok(survey(&facets(bytes)?))
}

/// The facets of an STL, all of finite numbers.
pub(super) fn facets(bytes: &[u8]) -> Result<Vec<Facet>, VerifyError> {
    if bytes.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    let facets = match binary(bytes) {
        Ok(facets) => facets,
        Err(_) if looks_ascii(bytes) => ascii(bytes)?,
        Err(error) => return Err(error),
    };
    let finite = |f: &Facet| f.corners.iter().flatten().all(|x| x.is_finite());
    match facets.iter().position(|f| !finite(f)) {
        Some(facet) => Err(VerifyError::NotFinite { facet }),
        None => Ok(facets),
    }
}

fn binary(bytes: &[u8]) -> Result<Vec<Facet>, VerifyError> {
    let Some((preamble, records)) = bytes.split_at_checked(PREAMBLE) else {
        return Err(VerifyError::TooShort { bytes: bytes.len() });
    };
    let count =
        preamble[HEADER..].try_into().map(u32::from_le_bytes).expect("the preamble ends in four bytes");
    let wanted = PREAMBLE as u64 + u64::from(count) * RECORD as u64;
    if bytes.len() as u64 != wanted {
        return Err(VerifyError::Length { triangles: count, wanted, found: bytes.len() as u64 });
    }
    Ok(records.chunks_exact(RECORD).map(record).collect())
}

fn record(bytes: &[u8]) -> Facet {
    let mut numbers = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let mut point = || [(); 3].map(|()| numbers.next().expect("a record has twelve numbers"));
    let normal = point();
    Facet { normal, corners: [(); 3].map(|()| point()) }
}

fn looks_ascii(bytes: &[u8]) -> bool {
    bytes.starts_with(b"solid")
        && bytes.iter().take(512).all(|b| b.is_ascii_graphic() || b.is_ascii_whitespace())
}

fn ascii(bytes: &[u8]) -> Result<Vec<Facet>, VerifyError> {
    let error = |message: String| VerifyError::AsciiStl { message };
    let text = std::str::from_utf8(bytes).map_err(|e| error(e.to_string()))?;
    // The parser stops at the first end, and wants a space after the first word.
    let end =
        text.find("endsolid").ok_or_else(|| error("it has no \"endsolid\"; it was cut off".to_owned()))?;
    if text[end..].lines().skip(1).any(|line| !line.trim().is_empty()) {
        return Err(error("it goes on after \"endsolid\"; one solid in a file is wanted".to_owned()));
    }
    let body = text.split_once('\n').map_or("", |(_, body)| body);
    let mut cursor = std::io::Cursor::new(format!("solid \n{body}"));
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|e| error(e.to_string()))?;
    let facet = |t: stl_io::Triangle| Facet { normal: t.normal.0, corners: t.vertices.map(|v| v.0) };
    triangles.map(|t| t.map(facet).map_err(|e| error(e.to_string()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const TETRAHEDRON: [[[f32; 3]; 3]; 4] = {
        let (o, x, y, z) = ([0., 0., 0.], [3., 0., 0.], [0., 3., 0.], [0., 0., 3.]);
        [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
    };

    fn bytes(header: &[u8], facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(HEADER, b' ');
        bytes.extend(u32::try_from(facets.len()).unwrap().to_le_bytes());
        for facet in facets {
            bytes.extend([0u8; 12]);
            bytes.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0u8; 2]);
        }
        bytes
    }

    fn text(facets: &[[[f32; 3]; 3]]) -> String {
        let facet = |f: &[[f32; 3]; 3]| {
            let corners: Vec<String> = f.iter().map(|[x, y, z]| format!("vertex {x} {y} {z}")).collect();
            format!("facet normal 0 0 0\n outer loop\n  {}\n endloop\nendfacet\n", corners.join("\n  "))
        };
        format!("solid\n{}endsolid\n", facets.iter().map(facet).collect::<String>())
    }

    #[test]
    fn binary_and_ascii_read_the_same() {
        let report = read_stl(&bytes(b"tetrahedron", &TETRAHEDRON)).unwrap();
        assert_eq!((report.triangles, report.vertices, report.shells.len(), report.genus), (4, 4, 1, 0));
        assert_eq!(report.volume_mm3, 4.5);
        assert_eq!(report.faults, []);
        assert_eq!(read_stl(text(&TETRAHEDRON).as_bytes()).unwrap(), report);
        assert_eq!(read_stl(&bytes(b"solid but binary", &TETRAHEDRON)).unwrap(), report);
    }

    #[test]
    fn a_cut_off_file_is_an_error() {
        let whole = bytes(b"", &TETRAHEDRON);
        let error = read_stl(&whole[..whole.len() - 7]).unwrap_err();
        assert_eq!(error, VerifyError::Length { triangles: 4, wanted: 284, found: 277 });
        assert!(error.to_string().contains("promises 4 triangles"), "{error}");
        assert_eq!(read_stl(&whole[..40]), Err(VerifyError::TooShort { bytes: 40 }));
        let cut = text(&TETRAHEDRON).replace("endsolid", "");
        assert!(matches!(read_stl(cut.as_bytes()), Err(VerifyError::AsciiStl { .. })));
    }

    #[test]
    fn two_solids_in_one_ascii_file_are_not_half_read() {
        let twice = text(&TETRAHEDRON).repeat(2);
        assert!(matches!(read_stl(twice.as_bytes()), Err(VerifyError::AsciiStl { .. })));
    }

    #[test]
    fn nan_is_an_error() {
        let mut facets = TETRAHEDRON;
        facets[2][1][0] = f32::NAN;
        assert_eq!(read_stl(&bytes(b"", &facets)), Err(VerifyError::NotFinite { facet: 2 }));
    }
}
