//! Signs that are exact: of areas in the plane and volumes in space.
//!
//! The adapter to the predicates; nothing else in the room names them.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// Positive if a, b and c turn to the left, negative to the right, and 0 only if they are in one line. An
/// approximation of twice the area.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Positive if a, b and c are counter-clockwise seen from d, negative if clockwise, and 0 only if all are in one plane.
pub(super) fn side_of(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    // Theirs is positive on the other side.
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// Whether three different points are in one line.
pub(super) fn is_in_line([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    // Far above what rounding can make of nothing: no need to look closer.
    if u.cross(v).length_squared() > 1e-20 * u.length_squared() * v.length_squared() {
        return false;
    }
    let is_straight = |flat: fn(DVec3) -> DVec2| turn(flat(a), flat(b), flat(c)) == 0.0;
    is_straight(|p| DVec2::new(p.x, p.y))
        && is_straight(|p| DVec2::new(p.y, p.z))
        && is_straight(|p| DVec2::new(p.z, p.x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_those_of_the_textbook() {
        assert!(turn(DVec2::ZERO, DVec2::X, DVec2::Y) > 0.0);
        assert!(side_of(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z) > 0.0);
        assert!(side_of(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Z) < 0.0);
    }

    #[test]
    fn a_line_is_told_from_a_sliver() {
        let (a, b) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, 0.6, 0.9));
        let f32s = |p: DVec3| p.as_vec3().as_dvec3();
        assert!(is_in_line([DVec3::ZERO, DVec3::ONE, 3.0 * DVec3::ONE]));
        assert!(!is_in_line([DVec3::ZERO, DVec3::ONE, DVec3::new(3.0, 3.0, 3.000_000_000_000_1)]));
        assert!(!is_in_line([DVec3::ZERO, f32s(a), f32s(b)]), "they are rounded each on its own");
    }
}
