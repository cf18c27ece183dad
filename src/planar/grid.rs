//! The integer grid on which topology is decided.

use std::cmp::Ordering;

use glam::DVec2;
use thiserror::Error;

/// A point of a [`Grid`], in grid steps. Ordered by x, then y: the order in which a sweep meets points, with
/// ties in x broken as if the plane had been sheared by an infinitesimal amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GridPoint {
    /// Steps to the right.
    pub x: i64,
    /// Steps up.
    pub y: i64,
}

impl GridPoint {
    /// The point at (`x`, `y`) steps.
    pub const fn new(x: i64, y: i64) -> Self {
        Self { x, y }
    }
}

/// The side of the directed line a→b on which `c` lies, exactly: `Greater` is left (counter-clockwise),
/// `Less` is right, `Equal` is on the line.
pub fn orient(a: GridPoint, b: GridPoint, c: GridPoint) -> Ordering {
    let (abx, aby) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (acx, acy) = (i128::from(c.x - a.x), i128::from(c.y - a.y));
    (abx * acy).cmp(&(aby * acx))
}

/// A square grid whose step is a power of two of a millimetre, so that steps and millimetres convert into
/// each other without rounding.
///
/// The step follows from the extent of what is put on it and is never chosen by an algorithm. A larger step
/// would merge features that a maker can see; a smaller one would run out of bits in the exact predicates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    exponent: i32,
}

/// Why a point or an extent does not fit a grid.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum GridError {
    /// A coordinate is NaN or infinite.
    #[error("the coordinate ({x}, {y}) is not a finite number")]
    NotFinite {
        /// x as found.
        x: f64,
        /// y as found.
        y: f64,
    },
    /// An extent outside of what can be computed with.
    #[error(
        "coordinates reach {extent_mm:e} mm; Openwork works with 0.001 mm to 100 m, so check the units of the drawing"
    )]
    Extent {
        /// The largest absolute coordinate, in millimetres.
        extent_mm: f64,
    },
}

/// Bits of a coordinate on the working grid: 33 and a sign leave room for exact `i128` products of three
/// differences, and make the step of a 240 mm band 3e-8 mm.
const WORKING_BITS: i32 = 33;
/// Bits of an `f32` significand: a coordinate of so many bits is written to an STL file without rounding.
const F32_BITS: i32 = 24;

impl Grid {
    /// The largest absolute coordinate that is accepted, in millimetres: 100 m.
    pub const MAX_EXTENT_MM: f64 = 1e5;
    /// The smallest extent that is accepted, in millimetres.
    pub const MIN_EXTENT_MM: f64 = 1e-3;

    /// The working grid for coordinates whose absolute value is at most `extent_mm`.
    ///
    /// # Errors
    /// [`GridError::Extent`] outside 0.001 mm to 100 m.
    pub fn for_extent(extent_mm: f64) -> Result<Self, GridError> {
        Self::with_bits(extent_mm, WORKING_BITS)
    }

    /// The finest grid whose points up to `extent_mm` are exact in `f32` (STL files).
    ///
    /// # Errors
    /// [`GridError::Extent`] outside 0.001 mm to 100 m.
    pub fn exact_in_f32(extent_mm: f64) -> Result<Self, GridError> {
        Self::with_bits(extent_mm, F32_BITS)
    }

    fn with_bits(extent_mm: f64, bits: i32) -> Result<Self, GridError> {
        if !(Self::MIN_EXTENT_MM..=Self::MAX_EXTENT_MM).contains(&extent_mm) {
            return Err(GridError::Extent { extent_mm });
        }
        let mut top = 0;
        while 2f64.powi(top) < extent_mm {
            top += 1;
        }
        while 2f64.powi(top - 1) >= extent_mm {
            top -= 1;
        }
        Ok(Self { exponent: top - bits })
    }

    /// The step in millimetres.
    pub fn step_mm(self) -> f64 {
        2f64.powi(self.exponent)
    }

    /// The nearest grid point to a finite point in millimetres.
    ///
    /// # Errors
    /// [`GridError`] for NaN, infinity, and what lies beyond [`Self::MAX_EXTENT_MM`].
    pub fn snap(self, p: DVec2) -> Result<GridPoint, GridError> {
        if !p.is_finite() {
            return Err(GridError::NotFinite { x: p.x, y: p.y });
        }
        let extent_mm = p.abs().max_element();
        if extent_mm > Self::MAX_EXTENT_MM {
            return Err(GridError::Extent { extent_mm });
        }
        Ok(GridPoint::new(self.steps(p.x), self.steps(p.y)))
    }

    /// A length in steps, rounded to the nearest.
    pub fn steps(self, mm: f64) -> i64 {
        (mm / self.step_mm()).round() as i64
    }

    /// A number of steps in millimetres, exact.
    pub fn mm(self, steps: i64) -> f64 {
        steps as f64 * self.step_mm()
    }

    /// A grid point in millimetres, exact.
    pub fn to_mm(self, p: GridPoint) -> DVec2 {
        DVec2::new(self.mm(p.x), self.mm(p.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn f32_grid_is_exact_in_f32() {
        for extent in [0.001, 0.7, 1.0, 64.0, 65.0, 240.0, 99_999.0] {
            let grid = Grid::exact_in_f32(extent).unwrap();
            let p = grid.snap(DVec2::new(extent, -extent / 3.0)).unwrap();
            let q = grid.to_mm(p);
            assert_eq!(f64::from(q.x as f32), q.x);
            assert_eq!(f64::from(q.y as f32), q.y);
            assert!((q.x - extent).abs() <= grid.step_mm() / 2.0);
        }
    }

    #[test]
    fn orientation_is_exact_where_floats_are_not() {
        let big = 1 << 33;
        let a = GridPoint::new(-big, -big);
        let b = GridPoint::new(big, big - 1);
        assert_eq!(orient(a, b, GridPoint::new(0, 0)), Ordering::Greater);
        assert_eq!(orient(a, b, GridPoint::new(0, -1)), Ordering::Less);
        assert_eq!(orient(a, b, b), Ordering::Equal);
    }

    #[test]
    fn refuses_what_does_not_fit() {
        let grid = Grid::for_extent(60.0).unwrap();
        assert!(matches!(grid.snap(DVec2::new(f64::NAN, 0.0)), Err(GridError::NotFinite { .. })));
        assert!(matches!(grid.snap(DVec2::new(1e30, 0.0)), Err(GridError::Extent { .. })));
        assert!(Grid::for_extent(0.0).is_err());
    }
}
