//! The map from a band to the plane.

use glam::DVec2;

use super::crossing::{BorderPoint, first_meeting};
use super::curve::PlanarCurve;
use super::error::DomainError;
use super::squeeze::{Profile, Side, Squeeze};

/// The chord error at which the border is tested for crossings. Larger, and a band is refused or accepted
/// wrongly by about that much; smaller, and the test takes longer than the rest of the map.
const BORDER_CHORD_MM: f64 = 0.005;
/// The greatest spacing along u at which the image of an edge is sampled, in mm and in radii of the tightest
/// bend.
const SAMPLE_MM: f64 = 2.0;
const SAMPLE_RADII: f64 = 0.25;
/// The least spacing of those samples, for bends much tighter than any band could follow.
const MIN_SAMPLE_MM: f64 = 0.02;

/// An injective, orientation-keeping map from band coordinates (u, v) to the plane.
///
/// M(u, v) = C(u) + f(u, v) n(u), with n the left normal and f(u, v) = v / (1 + k(u) |v|); k is 0 except on
/// the inner side of tight bends ([`BandMap::squeezes`]). On v = 0 the map is the curve, and lengths across
/// are kept near it.
///
/// **Why nothing folds.** With n' = −κ t the derivatives are M_u = (1 − f κ) t + f_u n and M_v = f_v n, so
/// the Jacobian determinant is (1 − f κ) f_v, whatever f_u is: *any* k that is smooth along u will do. k is so
/// large that f κ ≤ 0.85, and f_v = 1 / (1 + k |v|)² > 0. So M is locally injective and keeps orientation.
///
/// **Why nothing overlaps.** The constructor checks that the image of the band's border does not meet itself.
/// For a map that is locally injective with positive orientation, the number of points of the band that
/// come to lie on p is the sum of the winding numbers around p of the oriented border. An open band has one
/// border, a simple closed curve: the sum is 0 or 1. A ring has two, of which one is a deformation of the
/// other through curves with tangents (v = const), so both turn the same way and count with opposite signs:
/// again 0 or 1. Hence M is injective, up to the chord error (0.005 mm) with which the border is followed.
#[derive(Debug, Clone)]
pub struct BandMap {
    curve: PlanarCurve,
    v_range: [f64; 2],
    left: Profile,
    right: Profile,
    squeezes: Vec<Squeeze>,
    pub(super) sample_mm: f64,
}

impl BandMap {
    /// The map of the band from `v_low_mm` to `v_high_mm` across `curve` (usually −H/2 to H/2).
    ///
    /// # Errors
    /// [`DomainError::Width`] when the sides are not finite or not in order, [`DomainError::Fold`] where the
    /// curve bends too hard even for a squeezed band, [`DomainError::Crossing`] where the band meets itself,
    /// and [`DomainError::Coordinates`] when it reaches beyond 100 m.
    pub fn new(curve: PlanarCurve, v_low_mm: f64, v_high_mm: f64) -> Result<Self, DomainError> {
        let finite = v_low_mm.is_finite() && v_high_mm.is_finite();
        if !finite || v_low_mm >= v_high_mm {
            return Err(DomainError::Width { low_mm: v_low_mm, high_mm: v_high_mm });
        }
        let (left, mut squeezes) = Profile::new(&curve, Side::Left, v_high_mm.max(0.0))?;
        let (right, more) = Profile::new(&curve, Side::Right, (-v_low_mm).max(0.0))?;
        squeezes.extend(more);
        squeezes.sort_by(|a, b| a.from_mm.total_cmp(&b.from_mm));
        let hardest = curve.curvatures().fold(0.0, |k: f64, (_, _, curvature)| k.max(curvature.abs()));
        let sample_mm = (SAMPLE_RADII / hardest).clamp(MIN_SAMPLE_MM, SAMPLE_MM);
        let map = Self { curve, v_range: [v_low_mm, v_high_mm], left, right, squeezes, sample_mm };
        // A strip that is cut open does not meet itself.
        if map.curve.is_rolled() {
            return Ok(map);
        }
        match first_meeting(&map.borders())? {
            None => Ok(map),
            Some(meeting) => Err(DomainError::Crossing {
                position: meeting.position,
                first_mm: meeting.u[0],
                second_mm: meeting.u[1],
            }),
        }
    }

    /// The curve v = 0.
    pub fn curve(&self) -> &PlanarCurve {
        &self.curve
    }

    /// The lower and the upper side of the band, in mm.
    pub fn v_range_mm(&self) -> [f64; 2] {
        self.v_range
    }

    /// Where the band is squeezed, in the order of u; empty when it is nowhere.
    pub fn squeezes(&self) -> &[Squeeze] {
        &self.squeezes
    }

    /// The place of (u, v) in the plane. u goes round on a closed curve and straight on beyond the ends of an
    /// open one. Injectivity holds for v within [`BandMap::v_range_mm`].
    pub fn map(&self, u: f64, v: f64) -> DVec2 {
        let frame = self.curve.frame(u);
        frame.point + frame.normal * (v / self.stretch(u, v))
    }

    /// The scale of the map at (u, v) along the curve, 1 − f κ, and across it, f_v. Both are positive
    /// within the band; their product is the Jacobian determinant.
    pub fn scale(&self, u: f64, v: f64) -> [f64; 2] {
        let stretch = self.stretch(u, v);
        [1.0 - v / stretch * self.curve.frame(u).curvature, (stretch * stretch).recip()]
    }

    /// The least that a side of the band is scaled by along the curve, on the inner side of the bend where that is, with
    /// the middle of that bend in the plane and its radius in mm. 1 and no radius where nothing bends.
    pub fn tightest(&self) -> (f64, DVec2, f64) {
        let straight = (1.0, self.curve.frame(0.0).point, f64::INFINITY);
        let [low, high] = self.v_range;
        let bends = self.curve.curvatures().map(|(start, length, curvature)| {
            let at = start + 0.5 * length;
            let [along, _] = self.scale(at, if curvature > 0.0 { high } else { low });
            (along, self.curve.frame(at).point, curvature.abs().recip())
        });
        bends.fold(straight, |tightest, bend| if bend.0 < tightest.0 { bend } else { tightest })
    }

    /// 1 + k |v|.
    fn stretch(&self, u: f64, v: f64) -> f64 {
        let profile = if v > 0.0 { &self.left } else { &self.right };
        1.0 + profile.k(self.curve.wrap(u)) * v.abs()
    }

    /// The image of the band's border: one closed polyline for an open curve, two for a ring.
    fn borders(&self) -> Vec<Vec<BorderPoint>> {
        let [low, high] = self.v_range;
        let length = self.curve.length_mm();
        let corner = DVec2::new;
        let outlines: &[&[DVec2]] = if self.curve.is_closed() {
            &[&[corner(0.0, low), corner(length, low)], &[corner(0.0, high), corner(length, high)]]
        } else {
            &[&[
                corner(0.0, low),
                corner(length, low),
                corner(length, high),
                corner(0.0, high),
                corner(0.0, low),
            ]]
        };
        let border = |outline: &&[DVec2]| {
            let mut points = Vec::new();
            for edge in outline.windows(2) {
                self.trace(edge[0], edge[1], BORDER_CHORD_MM, &mut |uv, point| {
                    points.push(BorderPoint { u: uv.x, point });
                });
            }
            points
        };
        outlines.iter().map(border).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::sample_curves;
    use kurbo::BezPath;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn curve(svg: &str) -> PlanarCurve {
        PlanarCurve::from_bez_path(&BezPath::from_svg(svg).unwrap()).unwrap()
    }

    #[test]
    fn the_tightest_place_is_on_the_inner_side() {
        let map = BandMap::new(PlanarCurve::circle(65.0).unwrap(), -20.0, 20.0).unwrap();
        let (scale, at, radius_mm) = map.tightest();
        assert!((scale - (1.0 - 20.0 / 32.5)).abs() < 1e-9 && (radius_mm - 32.5).abs() < 1e-9, "{scale}");
        assert!((at.length() - 32.5).abs() < 1e-9, "{at}");
        let straight = BandMap::new(PlanarCurve::line(65.0).unwrap(), -20.0, 20.0).unwrap();
        assert_eq!(straight.tightest().0, 1.0);
    }

    #[test]
    fn a_line_is_mapped_as_it_is() {
        let map = BandMap::new(PlanarCurve::line(120.0).unwrap(), -7.0, 7.0).unwrap();
        assert_eq!(map.map(30.0, 4.0), DVec2::new(30.0, 4.0));
        assert_eq!(map.map(-2.0, -7.0), DVec2::new(-2.0, -7.0));
        assert!(map.squeezes().is_empty());
        let square = [(1.0, 1.0), (100.0, 1.0), (100.0, 5.0), (1.0, 5.0)].map(|(u, v)| DVec2::new(u, v));
        assert_eq!(map.map_contour(&square, 0, 0.01), square);
    }

    #[test]
    fn widths_that_are_none() {
        for (low, high) in [(1.0, 1.0), (2.0, -2.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            let line = PlanarCurve::line(9.0).unwrap();
            assert!(matches!(BandMap::new(line, low, high), Err(DomainError::Width { .. })));
        }
    }

    /// A right turn of 90 degrees with radius 6 between two long straight lines.
    fn bend() -> PlanarCurve {
        let path = BezPath::from_svg("M0 0 H60 V-60").unwrap();
        PlanarCurve::from_bez_path_rounded(&path, 6.0).unwrap()
    }

    #[test]
    fn the_inner_side_of_a_bend_is_squeezed_and_reported() {
        let map = BandMap::new(bend(), -9.0, 9.0).unwrap();
        let [squeeze] = map.squeezes() else { panic!("one squeeze: {:?}", map.squeezes()) };
        assert_eq!(squeeze.side, Side::Right);
        assert!((squeeze.radius_mm - 6.0).abs() < 1e-9);
        assert!((squeeze.squeezed_to_mm - 0.85 * 6.0).abs() < 1e-9);
        assert!(squeeze.from_mm < 54.0 && squeeze.from_mm > 54.0 - 2.5 * 9.0, "{squeeze:?}");
        assert!(squeeze.to_mm > 54.0 + 3.0 * PI && squeeze.to_mm < 54.0 + 3.0 * PI + 2.5 * 9.0);
        assert!((squeeze.from_mm..squeeze.to_mm).contains(&squeeze.at_mm));
        // Far away and on the outer side nothing is squeezed; on the inner side the curve keeps its place.
        assert_eq!(map.map(20.0, -9.0), DVec2::new(20.0, -9.0));
        assert_eq!(map.scale(squeeze.at_mm, 9.0)[1], 1.0);
        assert_eq!(map.scale(squeeze.at_mm, 0.0), [1.0, 1.0]);
        assert!(map.scale(squeeze.at_mm, -9.0)[0] >= 0.15 - 1e-12);
    }

    #[test]
    fn a_squeeze_over_the_seam_is_one() {
        let path = BezPath::from_svg("M0 0 H80 V80 H0 Z").unwrap();
        let square = PlanarCurve::from_bez_path_rounded(&path, 6.0).unwrap();
        let map = BandMap::new(square.clone(), -9.0, 9.0).unwrap();
        assert_eq!(map.squeezes().len(), 4);
        let last = map.squeezes().last().unwrap();
        assert!(last.to_mm > square.length_mm(), "{last:?}");
        assert!(DVec2::from_array(last.position_mm).length() < 4.0);
    }

    #[test]
    fn a_bend_too_tight_is_a_fold() {
        let Err(DomainError::Fold { side, radius_mm, reach_mm, allowed_mm, at_mm, .. }) =
            BandMap::new(bend(), -13.0, 13.0)
        else {
            panic!("13 mm do not fit into a radius of 6")
        };
        assert_eq!((side, reach_mm), (Side::Right, 13.0));
        assert!((radius_mm - 6.0).abs() < 1e-9 && (allowed_mm - 12.75).abs() < 1e-9);
        assert!(at_mm > 54.0 && at_mm < 54.0 + 3.0 * PI);
        assert!(BandMap::new(bend(), -12.7, 12.7).is_ok());
        // The other side is the outer one.
        assert!(BandMap::new(bend(), -1.0, 13.0).is_ok());
        let message = BandMap::new(bend(), -13.0, 13.0).unwrap_err().to_string();
        assert!(
            message.contains("13.000 mm to the right") && message.contains("narrower --width"),
            "{message}"
        );
    }

    #[test]
    fn a_crossing_names_the_place_and_both_positions() {
        // A loop that crosses itself at the origin, at right angles.
        let loop_ = curve("M-60 -60 L0 0 C60 60 -60 60 0 0 L60 -60");
        let Err(DomainError::Crossing { position, first_mm, second_mm }) =
            BandMap::new(loop_.clone(), -2.0, 2.0)
        else {
            panic!("a loop is refused")
        };
        assert!(position.length() < 4.0, "{position}");
        let arm = 60.0 * 2f64.sqrt();
        assert!((first_mm - arm).abs() < 4.0, "{first_mm}");
        assert!((second_mm - (loop_.length_mm() - arm)).abs() < 4.0, "{second_mm}");
    }

    #[test]
    fn sides_that_meet_are_refused_and_narrower_ones_are_not() {
        // A hairpin whose legs are 20 mm apart.
        let hairpin = curve("M0 0 H60 C73.3333 0 73.3333 20 60 20 H0");
        assert!(BandMap::new(hairpin.clone(), -2.0, 9.9).is_ok());
        let message = BandMap::new(hairpin, -2.0, 10.1).unwrap_err().to_string();
        assert!(message.contains("narrower --width or move the curve apart"), "{message}");
    }

    #[test]
    fn a_full_ring_with_a_small_hole_is_a_band() {
        let circle = PlanarCurve::circle(20.0).unwrap();
        let map = BandMap::new(circle.clone(), -9.0, 9.0).unwrap();
        let [squeeze] = map.squeezes() else { panic!("the whole ring is one squeeze") };
        assert_eq!((squeeze.from_mm, squeeze.to_mm), (0.0, circle.length_mm()));
        let inner = map.map_contour(&[DVec2::new(0.0, -9.0)], 1, 0.01);
        assert!(inner.iter().all(|p| (p.length() - 1.5).abs() < 1e-9));
    }

    fn check_map(curve: PlanarCurve, half: f64, samples: &[(f64, f64)]) -> Result<(), TestCaseError> {
        let length = curve.length_mm();
        let map = match BandMap::new(curve, -half, half) {
            Ok(map) => map,
            Err(refusal) => {
                let expected =
                    matches!(refusal, DomainError::Fold { .. } | DomainError::Crossing { .. }) && half > 2.0;
                prop_assert!(expected, "{} at {}", refusal, half);
                return Ok(());
            }
        };
        for &(s, t) in samples {
            let (u, v) = (s * length, t * half);
            let [along, across] = map.scale(u, v);
            prop_assert!(along >= 0.15 - 1e-9 && across > 0.0);
            let h = 1e-5;
            let d_u = (map.map(u + h, v) - map.map(u - h, v)) / (2.0 * h);
            let d_v = (map.map(u, v + h) - map.map(u, v - h)) / (2.0 * h);
            let determinant = d_u.perp_dot(d_v);
            prop_assert!(determinant > 0.0);
            // Within h of a joint the curvature is a mean; elsewhere both agree.
            prop_assert!((determinant - along * across).abs() < 0.05, "{} {}", determinant, along * across);
            // Reach: never further from the curve than v, never less than the promised share.
            let depth = map.map(u, v).distance(map.map(u, 0.0));
            prop_assert!(depth <= v.abs() + 1e-9 && depth >= 0.4 * v.abs() - 1e-9);
        }
        for squeeze in map.squeezes() {
            prop_assert!(squeeze.squeezed_to_mm <= 0.85 * squeeze.radius_mm + 1e-9);
            prop_assert!(squeeze.squeezed_to_mm >= 0.4 * squeeze.reach_mm - 1e-9);
            prop_assert!(squeeze.squeezed_to_mm < squeeze.reach_mm);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn the_map_keeps_orientation(
            open in sample_curves::open_path(), closed in sample_curves::closed_path(), half in 1.0..14.0f64,
            samples in prop::collection::vec((0.001..0.999f64, -1.0..1.0f64), 60),
        ) {
            check_map(PlanarCurve::from_bez_path(&open).unwrap(), half, &samples)?;
            check_map(PlanarCurve::from_bez_path(&closed).unwrap(), half, &samples)?;
        }
    }
}
