//! The facets of a mesh file, uncounted: what a model is read by that something is made of.
//!
//! Excluded: what is right or wrong about them.

use super::error::VerifyError;
use super::shells::Facet;
use super::{obj, stl, threemf};

/// The corners of the facets of an STL, a 3MF or an OBJ, whichever the bytes are, in millimetres. Faces of an OBJ with more corners are
/// parted into fans.
///
/// # Errors
/// [`VerifyError`] when the bytes are no whole file of the format that they begin as.
pub fn read_facets(bytes: &[u8]) -> Result<Vec<[[f32; 3]; 3]>, VerifyError> {
    let facets = if bytes.starts_with(b"PK") {
        threemf::facets(bytes)?.0
    } else if is_obj(bytes) {
        obj::facets(bytes, true)?
    } else {
        stl::facets(bytes)?
    };
    Ok(facets.into_iter().map(|Facet { corners, .. }| corners).collect())
}

/// Whether it is text with a row that an OBJ has, and no STL. A binary STL is known by its length, whatever its header says.
fn is_obj(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let mut first_words = text.lines().filter_map(|line| line.split_whitespace().next());
    !text.starts_with("solid") && first_words.any(|word| matches!(word, "v" | "f" | "o" | "g"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_what_they_hold() {
        let quad = b"# a square\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        let found = read_facets(quad).unwrap();
        assert_eq!(
            found,
            [[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]]
        );
        let ascii = b"solid v\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid v\n";
        assert_eq!(read_facets(ascii).unwrap().len(), 1);
        assert!(matches!(read_facets(b"PK and no more"), Err(VerifyError::Archive { .. })));
        assert!(matches!(read_facets(b"nothing"), Err(VerifyError::TooShort { .. })));
    }
}
