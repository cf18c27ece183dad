//! The curve that a band follows.

use glam::DVec2;
use kurbo::BezPath;

use super::arc::Arc;
use super::chain::Chain;
use super::error::DomainError;
use super::path::{MIN_LENGTH_MM, chain_of};
use super::rounding::{eased, rounded};
use crate::planar::{Grid, GridError};

/// A smooth curve in the plane, open or closed, by arc length in millimetres.
///
/// It is a chain of circular arcs and straight lines with common tangents: exact for lines and circles,
/// within 1e-6 mm of other paths (0.01 mm within a quarter of a millimetre of a joint that the drawing leaves
/// slightly bent, where it is eased; 0.05 mm where lines shorter than that follow each other, which are
/// merged). The direction of travel is continuous everywhere; the curvature is
/// constant on each arc.
///
/// A closed curve runs clockwise, whichever way it was drawn, so that its left side, v up, is the outside:
/// the top of the ornament points outward on a ring. Of a figure that has no outside, such as an eight,
/// the larger lobe counts.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarCurve {
    chain: Chain,
    /// Whether it is a line of which the end is the start.
    is_rolled: bool,
}

/// The curve at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The point, in mm.
    pub point: DVec2,
    /// The unit direction of travel.
    pub tangent: DVec2,
    /// The unit normal, on the left of the direction of travel.
    pub normal: DVec2,
    /// The curvature in 1/mm, positive where the curve turns left.
    pub curvature: f64,
}

impl PlanarCurve {
    /// A straight line from the origin to the right.
    ///
    /// # Errors
    /// [`DomainError::TooShort`] below 0.1 mm, [`DomainError::Coordinates`] for what is not finite or exceeds
    /// 100 m.
    pub fn line(length_mm: f64) -> Result<Self, DomainError> {
        Self::single(
            Arc { start: DVec2::ZERO, direction: DVec2::X, curvature: 0.0, length: length_mm },
            length_mm,
            false,
        )
    }

    /// A circle around the origin, clockwise from its lowest point, so that v up points outward, u = 0 is at
    /// the bottom and the ornament stands upright at the top. The diameter is that of the line v = 0.
    ///
    /// # Errors
    /// As [`PlanarCurve::line`].
    pub fn circle(diameter_mm: f64) -> Result<Self, DomainError> {
        let arc = Arc {
            start: DVec2::new(0.0, -0.5 * diameter_mm),
            direction: DVec2::NEG_X,
            curvature: -2.0 / diameter_mm,
            length: std::f64::consts::PI * diameter_mm,
        };
        Self::single(arc, diameter_mm, true)
    }

    /// A straight line of which the end is the start: a closed curve in space laid flat. Places along it go round, and the band
    /// along it is a cylinder cut open.
    ///
    /// # Errors
    /// As [`PlanarCurve::line`].
    pub fn rolled(length_mm: f64) -> Result<Self, DomainError> {
        let line = Self::line(length_mm)?;
        let arcs = line.chain.located_arcs().map(|(_, arc)| *arc).collect::<Vec<_>>();
        Ok(Self { chain: Chain::new(arcs, true), is_rolled: true })
    }

    /// Whether it is a line of which the end is the start.
    pub fn is_rolled(&self) -> bool {
        self.is_rolled
    }

    fn single(arc: Arc, extent_mm: f64, closed: bool) -> Result<Self, DomainError> {
        if !extent_mm.is_finite() {
            return Err(GridError::NotFinite { x: extent_mm, y: 0.0 }.into());
        }
        if extent_mm > Grid::MAX_EXTENT_MM {
            return Err(GridError::Extent { extent_mm }.into());
        }
        if arc.length < MIN_LENGTH_MM {
            return Err(DomainError::TooShort { length_mm: arc.length, minimum_mm: MIN_LENGTH_MM });
        }
        Ok(Self { chain: Chain::new([arc], closed), is_rolled: false })
    }

    /// The curve along a path of one subpath in millimetres, y up. It is closed when the path is, or when its
    /// ends are less than 0.002 mm apart; then u = 0 stays at the path's start and the direction becomes
    /// clockwise. Bends of a degree or less between segments are eased.
    ///
    /// # Errors
    /// [`DomainError`] when the path is empty, has several subpaths, has coordinates that are not finite or
    /// beyond 100 m, is shorter than 0.1 mm, or has a corner.
    pub fn from_bez_path(path: &BezPath) -> Result<Self, DomainError> {
        Ok(Self { chain: eased(&chain_of(path)?)?, is_rolled: false })
    }

    /// As [`PlanarCurve::from_bez_path`], but corners are replaced by arcs of at least `radius_mm`, and of
    /// exactly that radius between straight lines (corners of 10 degrees or less may become gentler). A corner at the start of a closed path moves u = 0 to the
    /// middle of its rounding.
    ///
    /// # Errors
    /// As there, but for corners [`DomainError::Rounding`] where the radius does not fit, and
    /// [`DomainError::RoundRadius`] when it is not a positive number.
    pub fn from_bez_path_rounded(path: &BezPath, radius_mm: f64) -> Result<Self, DomainError> {
        Ok(Self { chain: eased(&rounded(&chain_of(path)?, radius_mm)?)?, is_rolled: false })
    }

    /// The length in mm.
    pub fn length_mm(&self) -> f64 {
        self.chain.length()
    }

    /// Whether the end is the start.
    pub fn is_closed(&self) -> bool {
        self.chain.is_closed()
    }

    /// The curve at arc length `u`. Beyond the ends a closed curve goes round again, and an open one goes on
    /// straight.
    pub fn frame(&self, u: f64) -> Frame {
        let (arc, s) = self.chain.locate(u);
        let inside = if self.is_closed() { s } else { s.clamp(0.0, arc.length) };
        let tangent = arc.direction_at(inside);
        Frame {
            point: arc.point(inside) + tangent * (s - inside),
            tangent,
            normal: tangent.perp(),
            curvature: if s == inside { arc.curvature } else { 0.0 },
        }
    }

    /// u modulo the length on a closed curve; u itself on an open one.
    pub(super) fn wrap(&self, u: f64) -> f64 {
        self.chain.wrap(u)
    }

    /// The stretches of constant curvature: where each one starts, how long it is, and its curvature.
    pub(super) fn curvatures(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.chain.located_arcs().map(|(start, arc)| (start, arc.length, arc.curvature))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::sample_curves;
    use proptest::prelude::*;

    fn curve(svg: &str) -> PlanarCurve {
        PlanarCurve::from_bez_path(&BezPath::from_svg(svg).unwrap()).unwrap()
    }

    #[test]
    fn a_line_goes_on_straight() {
        let line = PlanarCurve::line(120.0).unwrap();
        assert_eq!((line.length_mm(), line.is_closed()), (120.0, false));
        for u in [-5.0, 0.0, 60.0, 120.0, 150.0] {
            let f = line.frame(u);
            assert_eq!((f.point, f.tangent, f.normal), (DVec2::new(u, 0.0), DVec2::X, DVec2::Y));
        }
    }

    #[test]
    fn a_circle_has_its_left_side_outside_and_wraps() {
        let circle = PlanarCurve::circle(65.0).unwrap();
        assert!(circle.is_closed());
        let length = std::f64::consts::PI * 65.0;
        assert!((circle.length_mm() - length).abs() < 1e-12);
        assert!((circle.frame(0.0).point - DVec2::new(0.0, -32.5)).length() < 1e-12);
        let top = circle.frame(0.5 * length);
        assert!((top.point - DVec2::new(0.0, 32.5)).length() < 1e-9);
        assert!((top.tangent - DVec2::X).length() < 1e-9 && (top.normal - DVec2::Y).length() < 1e-9);
        for u in [0.0, 17.0, 100.0] {
            let (a, b) = (circle.frame(u), circle.frame(u - 3.0 * length));
            assert!((a.point - b.point).length() < 1e-9 && (a.tangent - b.tangent).length() < 1e-9);
            assert!(a.point.dot(a.normal) > 32.4);
        }
    }

    #[test]
    fn open_paths_go_on_straight() {
        let spline = curve("M10 70 C50 -20 90 -10 110 50 S170 130 210 30");
        for (u, step) in [(0.0, -7.0), (spline.length_mm(), 7.0)] {
            let (end, beyond) = (spline.frame(u), spline.frame(u + step));
            assert!((beyond.point - end.point - end.tangent * step).length() < 1e-9);
            assert_eq!(beyond.curvature, 0.0);
        }
    }

    #[test]
    fn lengths_that_cannot_be_used() {
        for mm in [0.0, -3.0, 0.01, f64::NAN, f64::INFINITY, 1e6] {
            assert!(PlanarCurve::line(mm).is_err(), "line {mm}");
            assert!(PlanarCurve::circle(mm).is_err(), "circle {mm}");
        }
    }

    fn check_frames(curve: &PlanarCurve) -> Result<(), TestCaseError> {
        let n = 2000;
        let step = curve.length_mm() / f64::from(n);
        for i in 0..n {
            let (a, b) = (curve.frame(f64::from(i) * step), curve.frame((f64::from(i) + 0.999) * step));
            prop_assert!((a.tangent.length() - 1.0).abs() < 1e-12);
            prop_assert!((a.normal - a.tangent.perp()).length() < 1e-15);
            // Unit speed and a bounded turn: both hold only if nothing jumps.
            prop_assert!((b.point - a.point).length() <= step * 1.0001);
            prop_assert!((b.point - a.point).length() >= step * 0.9);
            prop_assert!((b.tangent - a.tangent).length() < 0.3);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn frames_are_orthonormal_and_continuous(
            open in sample_curves::open_path(), closed in sample_curves::closed_path(),
        ) {
            let closed = PlanarCurve::from_bez_path(&closed).unwrap();
            prop_assert!(closed.is_closed());
            check_frames(&PlanarCurve::from_bez_path(&open).unwrap())?;
            check_frames(&closed)?;
            let (start, end) = (closed.frame(0.0), closed.frame(closed.length_mm() - 1e-9));
            prop_assert!((start.point - end.point).length() < 1e-5);
            prop_assert!((start.tangent - end.tangent).length() < 1e-5);
        }
    }
}
