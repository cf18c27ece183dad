//! The binary STL writer.
//!
//! An 80 byte header, the number of facets, and 50 bytes for each facet: normal and corners as little-endian
//! `f32`, two bytes left zero. A solid's coordinates are `f32` already, so nothing is rounded here.

use glam::DVec3;

use super::ExportError;
use crate::fabricate::Solid;

const HEADER_BYTES: usize = 80;
const FACET_BYTES: usize = 50;

/// `solid` as a binary STL file in millimetres, facets in the solid's order. `header` is cut to 80 bytes of
/// ASCII; one that begins with "solid", by which readers know ASCII files, gets a space before it.
///
/// # Errors
/// [`ExportError::TooManyFacets`] beyond the format's 32-bit count.
pub fn stl(solid: &Solid, header: &str) -> Result<Vec<u8>, ExportError> {
    let facets = solid.facets();
    let count =
        u32::try_from(facets.len()).map_err(|_| ExportError::TooManyFacets { found: facets.len() })?;
    let mut bytes = Vec::with_capacity(HEADER_BYTES + 4 + FACET_BYTES * facets.len());
    if header.to_ascii_lowercase().starts_with("solid") {
        bytes.push(b' ');
    }
    bytes.extend(header.chars().map(|c| if c.is_ascii_graphic() { c as u8 } else { b' ' }));
    bytes.resize(HEADER_BYTES, b' ');
    bytes.extend(count.to_le_bytes());
    for corners in facets {
        let floats = normal(corners).into_iter().chain(corners.into_iter().flatten());
        bytes.extend(floats.flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    Ok(bytes)
}

/// The unit normal by the right-hand rule.
fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)));
    // Adding zero turns a negative zero into a plain one.
    (b - a).cross(c - a).normalize_or_zero().to_array().map(|x| x as f32 + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabricate::extrude;
    use crate::planar::{FillRule, Grid, GridPoint, Region};

    fn slab() -> Solid {
        let grid = Grid::for_extent(10.0).unwrap();
        let one = grid.steps(1.0);
        let square = [(0, 0), (2, 0), (2, 1), (0, 1)].map(|(x, y)| GridPoint::new(x * one, y * one));
        extrude(&Region::fill(grid, &[square.to_vec()], FillRule::NonZero), 0.5).unwrap()
    }

    fn float(bytes: &[u8], at: usize) -> f32 {
        f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
    }

    #[test]
    fn the_layout_is_the_format() {
        let bytes = stl(&slab(), "Openwork").unwrap();
        assert_eq!(&bytes[..9], b"Openwork ");
        assert_eq!(bytes[80..84], 12u32.to_le_bytes());
        assert_eq!(bytes.len(), 84 + 12 * 50);
        // The first facet is of the bottom and looks down.
        assert_eq!([float(&bytes, 84), float(&bytes, 88), float(&bytes, 92)], [0.0, 0.0, -1.0]);
        assert_eq!(bytes[132..134], [0, 0]);
    }

    #[test]
    fn other_readers_find_the_same_facets() {
        let bytes = stl(&slab(), "Openwork").unwrap();
        let mesh = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (8, 12));
        mesh.validate().unwrap();
    }

    #[test]
    fn the_header_never_looks_like_ascii() {
        for header in ["solid part", "SOLID", &"solid ".repeat(40), "Maß & Größe", ""] {
            let bytes = stl(&slab(), header).unwrap();
            assert!(!bytes[..5].eq_ignore_ascii_case(b"solid"), "{header}");
            assert!(bytes[..80].is_ascii());
            assert_eq!(bytes[80..84], 12u32.to_le_bytes());
        }
    }
}
