//! The map from a band and its thickness to space.

use glam::{DVec2, DVec3};

use super::contact::first_contact;
use super::curve::{SpaceCurve, SpaceFrame};
use super::error::SpaceError;
use super::relief::Relief;

/// What is left of lengths along the innermost edge of a bend, at least.
pub(super) const LEAST_SCALE: f64 = 0.15;
/// Places along the curve at which bends are looked at, for each millimetre and at least.
const LOOKS_PER_MM: f64 = 4.0;
const LOOKS: f64 = 256.0;
/// Places across the band at which a relief is looked at.
const LOOKS_ACROSS: usize = 24;
/// The steepest slope of a relief, as a tangent. There the sheet has half of its thickness.
const STEEPEST: f64 = 1.732_050_807_568_877_2;

/// The map from (u, v, w) to space: u along a curve, v across the band, w through its thickness.
///
/// S(u, v, w) = C(u) + v V(u) + w N(u) with the frame (T, V, N) of the curve, right-handed. T' = a V + b N, V' = −a T + c N
/// and N' = −b T − c V, with the curvatures a towards V and b towards N and the rate c at which the frame turns. So S_u =
/// (1 − a v − b w) T − c w V + c v N, and the Jacobian determinant is 1 − a v − b w, whatever c is: nothing folds where that is
/// positive, which is checked (at least 0.15 is kept). Zhou 2014 §3.5 takes such frames for planar curves.
///
/// On a [`Relief`] h(u, v) it is S(u, v, h + w). The slopes of h only shear along N, so the determinant is 1 − a v − b (h + w).
///
/// That far places do not meet is checked with boxes along the band, to about the thickness; the file is judged exactly.
#[derive(Debug, Clone)]
pub struct SpaceMap {
    curve: SpaceCurve,
    v_range: [f64; 2],
    w_range: [f64; 2],
    relief: Option<Relief>,
    scales: [f64; 2],
    steepest: f64,
}

impl SpaceMap {
    /// The map of the band of `v_range_mm` across `curve`, from `w_range_mm[0]`, its back, to `w_range_mm[1]`, its front.
    ///
    /// No two places of the band may come within `gap_mm` of each other, which may be 0.
    ///
    /// # Errors
    /// [`SpaceError::Fold`] and [`SpaceError::Contact`] name the place.
    pub fn new(
        curve: SpaceCurve,
        v_range_mm: [f64; 2],
        w_range_mm: [f64; 2],
        gap_mm: f64,
    ) -> Result<Self, SpaceError> {
        Self::draped(curve, v_range_mm, w_range_mm, None, gap_mm)
    }

    /// The same on a relief.
    ///
    /// # Errors
    /// As [`Self::new`], and [`SpaceError::Steep`] with the place.
    pub fn draped(
        curve: SpaceCurve,
        v_range_mm: [f64; 2],
        w_range_mm: [f64; 2],
        relief: Option<Relief>,
        gap_mm: f64,
    ) -> Result<Self, SpaceError> {
        let scales = [1.0; 2];
        let mut map = Self { curve, v_range: v_range_mm, w_range: w_range_mm, relief, scales, steepest: 0.0 };
        map.check_folds()?;
        (map.scales, map.steepest) = map.measured_scales()?;
        first_contact(&map, gap_mm).map_or(Ok(map), Err)
    }

    /// The curve v = w = 0.
    pub fn curve(&self) -> &SpaceCurve {
        &self.curve
    }

    /// The back and the front.
    pub fn w_range_mm(&self) -> [f64; 2] {
        self.w_range
    }

    /// The lower and the upper side.
    pub fn v_range_mm(&self) -> [f64; 2] {
        self.v_range
    }

    /// The place of (u, v) at height w.
    pub fn place(&self, uv: DVec2, w: f64) -> DVec3 {
        let frame = self.curve.frame(uv.x);
        frame.point + frame.across * uv.y + frame.out * (self.height_mm(uv) + w)
    }

    /// How far the sheet stands out at (u, v).
    pub(super) fn height_mm(&self, uv: DVec2) -> f64 {
        self.relief.as_ref().map_or(0.0, |relief| relief.at(uv))
    }

    /// Whether it lies on a relief.
    pub(super) fn has_relief(&self) -> bool {
        self.relief.is_some()
    }

    /// The heights at a place along the curve, of which the greatest and the least are looked for at some places across.
    pub(super) fn heights_mm(&self, u: f64) -> [f64; 2] {
        if self.relief.is_none() {
            return [0.0; 2];
        }
        let heights = self.looks_across().map(|v| self.height_mm(DVec2::new(u, v)));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)])
    }

    /// Places across the band at which it is looked at: its sides, and on a relief some between.
    pub(super) fn looks_across(&self) -> impl Iterator<Item = f64> + use<> {
        let steps = if self.relief.is_some() { LOOKS_ACROSS } else { 1 };
        let [low, high] = self.v_range;
        (0..=steps).map(move |i| low + (high - low) * i as f64 / steps as f64)
    }

    /// By how much lengths along the band are multiplied at (u, v) and so far out from where it would be flat.
    pub(super) fn scale_at(&self, u: f64, v: f64, out: f64) -> f64 {
        let frame = self.curve.frame(u);
        1.0 - frame.curvature.dot(frame.across) * v - frame.curvature.dot(frame.out) * out
    }

    /// The least part of its thickness that the sheet has, measured straight through it: less than 1 where a relief slopes, as the thickness stands
    /// on the sheet without it.
    pub fn least_thickness(&self) -> f64 {
        (1.0 + self.steepest * self.steepest).sqrt().recip()
    }

    /// The least and the greatest factor by which lengths on the band are multiplied, in any direction and anywhere: the singular
    /// values of the map on its front and its back. A twist lengthens the edges, and shears.
    pub fn scales(&self) -> [f64; 2] {
        self.scales
    }

    /// The scales, and the steepest slope of the relief.
    fn measured_scales(&self) -> Result<([f64; 2], f64), SpaceError> {
        let places: Vec<f64> = self.looks().collect();
        let frames: Vec<SpaceFrame> = places.iter().map(|&u| self.curve.frame(u)).collect();
        let (mut scales, mut steepest) = ([1.0f64, 1.0], 0.0f64);
        for (pair, u) in frames.windows(2).zip(places.windows(2)) {
            let [from, to] = [pair[0], pair[1]];
            let step = u[1] - u[0];
            // How fast the frame turns about the curve.
            let twist = (to.across - from.across).dot(from.out) / step;
            let (a, b) = (from.curvature.dot(from.across), from.curvature.dot(from.out));
            for v in self.looks_across() {
                let [height, slope_u, slope_v] = self.slopes(DVec2::new(u[0], v), step);
                for w in self.w_range.map(|w| w + height) {
                    let along = DVec3::new(1.0 - a * v - b * w, -twist * w, twist * v + slope_u);
                    let across = DVec3::new(0.0, 1.0, slope_v);
                    let steep = slope_v.hypot(slope_u / along.x.max(LEAST_SCALE));
                    steepest = steepest.max(steep);
                    if self.relief.is_some() && steep > STEEPEST {
                        let position = self.place(DVec2::new(u[0], v), 0.0);
                        return Err(SpaceError::Steep { position, degrees: steep.atan().to_degrees() });
                    }
                    // Of the two columns S_u and S_v, whose lengths and angle are known.
                    let (p, q, shear) = (along.length_squared(), across.length_squared(), along.dot(across));
                    let (half, apart) = (0.5 * (p + q), (0.25 * (p - q).powi(2) + shear * shear).sqrt());
                    let [least, most] = [half - apart, half + apart].map(|x| x.max(0.0).sqrt());
                    scales = [scales[0].min(least), scales[1].max(most)];
                }
            }
        }
        Ok((scales, steepest))
    }

    /// The height of the relief and its slopes along u and v, over a `step`.
    fn slopes(&self, uv: DVec2, step: f64) -> [f64; 3] {
        if self.relief.is_none() {
            return [0.0; 3];
        }
        let height = self.height_mm(uv);
        let over = |by: DVec2| (self.height_mm(uv + by) - self.height_mm(uv - by)) / (2.0 * step);
        [height, over(DVec2::new(step, 0.0)), over(DVec2::new(0.0, step))]
    }

    /// The lowest z of the band, at the places at which bends are looked at.
    pub fn low_mm(&self) -> f64 {
        let corners = |u: f64| {
            let across = self.looks_across().flat_map(move |v| self.w_range.map(|w| (v, w)));
            across.map(move |(v, w)| self.place(DVec2::new(u, v), w).z)
        };
        self.looks().flat_map(corners).fold(f64::INFINITY, f64::min)
    }

    /// The same band, `by_mm` higher.
    pub fn lifted(self, by_mm: f64) -> Self {
        Self { curve: self.curve.lifted(by_mm), ..self }
    }

    /// Places along the curve at which bends are looked at.
    pub(super) fn looks(&self) -> impl Iterator<Item = f64> {
        let length = self.curve.length_mm();
        let looks = (LOOKS_PER_MM * length).max(LOOKS).ceil();
        (0..=looks as usize).map(move |i| length * i as f64 / looks)
    }

    fn check_folds(&self) -> Result<(), SpaceError> {
        for u in self.looks() {
            let frame = self.curve.frame(u);
            let (a, b) = (frame.curvature.dot(frame.across), frame.curvature.dot(frame.out));
            let [low, high] = self.heights_mm(u);
            let reach = (a * self.v_range[0]).max(a * self.v_range[1])
                + (b * (low + self.w_range[0])).max(b * (high + self.w_range[1]));
            if 1.0 - reach < LEAST_SCALE {
                let radius = frame.curvature.length().recip();
                return Err(SpaceError::Fold {
                    position: frame.point,
                    at_mm: u,
                    reach_mm: reach * radius,
                    radius_mm: radius,
                    allowed_mm: (1.0 - LEAST_SCALE) * radius,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_ring_needs_as_many_lines_as_its_chords() {
        let map = SpaceMap::new(SpaceCurve::ring(33.5).unwrap(), [-7.0, 7.0], [-1.0, 1.0], 0.0).unwrap();
        let lines = map.lines(0.0, 0.01);
        // A chord of a circle of radius r errs by r (1 - cos(half of its angle)).
        let least = std::f64::consts::TAU / (2.0 * (1.0 - 0.01 / 34.5f64).acos());
        let n = lines.len() as f64 - 1.0;
        assert!(n >= least && n < 2.2 * least, "{n} {least}");
        assert!(
            lines[0] == 0.0
                && lines.is_sorted()
                && (lines[lines.len() - 1] - map.curve().length_mm()).abs() < 1e-9
        );
        assert!((map.scale_at(0.0, 0.0, 1.0) - 34.5 / 33.5).abs() < 1e-12);
    }

    #[test]
    fn a_thickness_beyond_the_radius_folds() {
        let ring = SpaceCurve::ring(5.0).unwrap();
        let Err(SpaceError::Fold { radius_mm, reach_mm, .. }) =
            SpaceMap::new(ring, [-3.0, 3.0], [-4.9, 4.9], 0.0)
        else {
            panic!("4.9 mm of a radius of 5")
        };
        assert!((radius_mm - 5.0).abs() < 1e-9 && (reach_mm - 4.9).abs() < 1e-9);
    }

    #[test]
    fn a_helix_that_is_wider_than_its_pitch_meets_itself() {
        let band = |width: f64| {
            SpaceMap::new(
                SpaceCurve::helix(30.0, 12.0, 3.0).unwrap(),
                [-0.5 * width, 0.5 * width],
                [-1.0, 1.0],
                0.0,
            )
        };
        assert!(band(11.0).is_ok());
        let apart = |gap_mm: f64| {
            let helix = SpaceCurve::helix(30.0, 12.0, 3.0).unwrap();
            SpaceMap::new(helix, [-5.5, 5.5], [-1.0, 1.0], gap_mm)
        };
        assert!(apart(0.8).is_ok());
        assert!(matches!(apart(1.2), Err(SpaceError::Contact { .. })));
        let Err(SpaceError::Contact { at_mm: [a, b], position, .. }) = band(12.5) else {
            panic!("12.5 > 12")
        };
        let turn = std::f64::consts::TAU * 30.0;
        assert!((b - a - turn).abs() < 0.1 * turn, "{a} {b}");
        assert!((position.truncate().length() - 30.0).abs() < 2.0, "{position}");
    }

    #[test]
    fn a_knot_that_passes_through_itself_is_named() {
        // A figure eight that crosses itself at the origin.
        let eight = |lift: f64| {
            let points: Vec<DVec3> = (0..40)
                .map(|i| std::f64::consts::TAU * f64::from(i) / 40.0)
                .map(|a| DVec3::new(40.0 * a.sin(), 25.0 * (2.0 * a).sin(), lift * a.cos()))
                .collect();
            SpaceMap::new(SpaceCurve::through(&points, true).unwrap(), [-2.0, 2.0], [-0.5, 0.5], 0.0)
        };
        assert!(eight(10.0).is_ok());
        let Err(SpaceError::Contact { position, .. }) = eight(0.0) else { panic!("it crosses itself") };
        assert!(position.length() < 4.0, "{position}");
    }

    #[test]
    fn turns_are_seen_however_many() {
        // All of it at a quarter, a half and three quarters is on its chord.
        let helix = |turns| {
            SpaceMap::new(SpaceCurve::helix(30.0, 22.0, turns).unwrap(), [-5.0, 5.0], [-1.0, 1.0], 0.0)
        };
        let lines = |turns| helix(turns).unwrap().lines(0.0, 0.01).len();
        let counts = [lines(1.0), lines(4.0), lines(8.0)];
        assert!(counts[1] > 3 * counts[0] && 10 * counts[2] > 18 * counts[1], "{counts:?}");
        let line = SpaceCurve::through(&[DVec3::ZERO, DVec3::X * 200.0], false).unwrap();
        let twisted = line.twisted(&"0:0,10:0,24:90,38:0".parse().unwrap()).unwrap();
        let map = SpaceMap::new(twisted, [-5.0, 5.0], [-1.0, 1.0], 0.0).unwrap();
        let lines = map.lines(0.0, 0.01);
        assert!(lines.len() > 60 && [10.0, 24.0, 38.0].iter().all(|u| lines.contains(u)), "{}", lines.len());
    }

    #[test]
    fn a_twist_lengthens_and_shears() {
        let line = SpaceCurve::through(&[DVec3::ZERO, DVec3::X * 200.0], false).unwrap();
        let twisted = line.twisted(&"3000".parse().unwrap()).unwrap();
        let map = SpaceMap::new(twisted, [-6.0, 6.0], [-1.0, 1.0], 0.0).unwrap();
        let c = 3000f64.to_radians() / 200.0;
        let [least, most] = map.scales();
        assert!(
            most > (1.0 + (6.0 * c).powi(2)).sqrt() * 0.999 && least < 0.99 && least > 0.9,
            "{least} {most}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn facets_stay_within_the_chord_error(
            points in prop::collection::vec((-40.0..40.0f64, -40.0..40.0f64, -40.0..40.0f64), 4..7),
            twist in -300.0..300.0f64, chord in 0.005..0.1f64,
        ) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            let Ok(curve) = SpaceCurve::through(&points, false) else { return Ok(()) };
            let curve = curve.twisted(&twist.to_string().parse().unwrap()).unwrap();
            let Ok(map) = SpaceMap::new(curve, [-1.5, 1.5], [-0.4, 0.4], 0.0) else { return Ok(()) };
            for pair in map.lines(0.0, chord).windows(2) {
                for part in [0.1, 0.3, 0.5, 0.7, 0.9] {
                    for (v, w) in [(-1.5, 0.4), (0.0, -0.4), (1.5, 0.4)] {
                        let at = |u: f64| map.place(DVec2::new(u, v), w);
                        let flat = at(pair[0]).lerp(at(pair[1]), part);
                        let off = at(pair[0] + part * (pair[1] - pair[0])).distance(flat);
                        prop_assert!(off <= chord, "{} > {}", off, chord);
                    }
                }
            }
        }
    }
}
