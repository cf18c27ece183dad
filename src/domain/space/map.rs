//! The map from a band and its thickness to space.

use glam::{DVec2, DVec3};

use super::contact::first_contact;
use super::curve::SpaceCurve;
use super::error::SpaceError;

/// What is left of lengths along the innermost edge of a bend, at least.
const LEAST_SCALE: f64 = 0.15;
/// Places along the curve at which bends are looked at, for each millimetre and at least.
const LOOKS_PER_MM: f64 = 4.0;
const LOOKS: f64 = 256.0;
/// A chord error below this gives no better part, only more facets.
const MIN_CHORD_MM: f64 = 1e-4;
/// The part of the chord error that is used, as the greatest error may lie between two samples.
const CHORD_SHARE: f64 = 0.9;
/// No facet is longer than this part of a closed curve, however straight.
const TURN_PART: f64 = 1.0 / 12.0;

/// The map from (u, v, w) to space: u along a curve, v across the band, w through its thickness.
///
/// S(u, v, w) = C(u) + v V(u) + w N(u) with the frame (T, V, N) of the curve, right-handed. T' = a V + b N, V' = −a T + c N
/// and N' = −b T − c V, with the curvatures a towards V and b towards N and the rate c at which the frame turns. So S_u =
/// (1 − a v − b w) T − c w V + c v N, and the Jacobian determinant is 1 − a v − b w, whatever c is: nothing folds where that is
/// positive, which is checked (at least 0.15 is kept). Zhou 2014 §3.5 takes such frames for planar curves.
///
/// That far places do not meet is checked with boxes along the band, to about the thickness; the file is judged exactly.
#[derive(Debug, Clone)]
pub struct SpaceMap {
    curve: SpaceCurve,
    v_range: [f64; 2],
    w_range: [f64; 2],
}

impl SpaceMap {
    /// The map of the band of `v_range_mm` across `curve`, from `w_range_mm[0]`, its back, to `w_range_mm[1]`, its front.
    ///
    /// # Errors
    /// [`SpaceError::Fold`] and [`SpaceError::Contact`] name the place.
    pub fn new(curve: SpaceCurve, v_range_mm: [f64; 2], w_range_mm: [f64; 2]) -> Result<Self, SpaceError> {
        let map = Self { curve, v_range: v_range_mm, w_range: w_range_mm };
        map.check_folds()?;
        first_contact(&map).map_or(Ok(map), Err)
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
        frame.point + frame.across * uv.y + frame.out * w
    }

    /// By how much lengths along the band are multiplied at (u, v, w).
    pub fn scale(&self, uv: DVec2, w: f64) -> f64 {
        let frame = self.curve.frame(uv.x);
        1.0 - frame.curvature.dot(frame.across) * uv.y - frame.curvature.dot(frame.out) * w
    }

    /// The least and the greatest of these factors anywhere on the band.
    pub fn scales(&self) -> [f64; 2] {
        let corners = || (0..4).map(|i| (self.v_range[i % 2], self.w_range[i / 2]));
        let all = self.looks().flat_map(|u| corners().map(move |(v, w)| self.scale(DVec2::new(u, v), w)));
        all.fold([1.0, 1.0], |[least, most], scale| [f64::min(least, scale), f64::max(most, scale)])
    }

    /// Places along the curve at which bends are looked at.
    fn looks(&self) -> impl Iterator<Item = f64> {
        let length = self.curve.length_mm();
        let looks = (LOOKS_PER_MM * length).max(LOOKS).ceil();
        (0..=looks as usize).map(move |i| length * i as f64 / looks)
    }

    fn check_folds(&self) -> Result<(), SpaceError> {
        for u in self.looks() {
            let frame = self.curve.frame(u);
            let (a, b) = (frame.curvature.dot(frame.across), frame.curvature.dot(frame.out));
            let reach = (a * self.v_range[0]).max(a * self.v_range[1])
                + (b * self.w_range[0]).max(b * self.w_range[1]);
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

    /// Places along the curve, from 0 to its length, between which flat facets stay within `chord_mm` of the band.
    pub fn lines(&self, chord_mm: f64) -> Vec<f64> {
        let tolerance = CHORD_SHARE * chord_mm.max(MIN_CHORD_MM);
        let length = self.curve.length_mm();
        let longest = if self.curve.is_closed() { TURN_PART * length } else { length };
        let first = (length / longest).ceil() as usize;
        let mut lines = vec![0.0];
        for i in 0..first {
            let [from, to] = [i, i + 1].map(|i| length * i as f64 / first as f64);
            self.refine(from, to, tolerance, &mut lines);
        }
        lines
    }

    /// Adds the places after `from` up to `to`.
    fn refine(&self, from: f64, to: f64, tolerance: f64, lines: &mut Vec<f64>) {
        if self.is_flat(from, to, tolerance) {
            lines.push(to);
            return;
        }
        let middle = 0.5 * (from + to);
        self.refine(from, middle, tolerance, lines);
        self.refine(middle, to, tolerance, lines);
    }

    /// Whether facets between two places stay within `tolerance` of the band, on its front and its back.
    fn is_flat(&self, from: f64, to: f64, tolerance: f64) -> bool {
        let corner = |u: f64, v: usize, w: usize| self.place(DVec2::new(u, self.v_range[v]), self.w_range[w]);
        (0..2).all(|w| {
            // Of facets in a strip that is twisted any may be on either side of it by this.
            let twist = corner(from, 0, w) - corner(from, 1, w) - corner(to, 0, w) + corner(to, 1, w);
            let bend = (0..2).flat_map(|v| [0.25, 0.5, 0.75].map(|part| (v, part))).map(|(v, part)| {
                let chord = corner(from, v, w).lerp(corner(to, v, w), part);
                corner(from + part * (to - from), v, w).distance(chord)
            });
            0.25 * twist.length() + bend.fold(0.0, f64::max) <= tolerance
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_ring_needs_as_many_lines_as_its_chords() {
        let map = SpaceMap::new(SpaceCurve::ring(33.5).unwrap(), [-7.0, 7.0], [-1.0, 1.0]).unwrap();
        let lines = map.lines(0.01);
        // A chord of a circle of radius r errs by r (1 - cos(half of its angle)).
        let least = std::f64::consts::TAU / (2.0 * (1.0 - 0.01 / 34.5f64).acos());
        let n = lines.len() as f64 - 1.0;
        assert!(n >= least && n < 2.2 * least, "{n} {least}");
        assert!(
            lines[0] == 0.0
                && lines.is_sorted()
                && (lines[lines.len() - 1] - map.curve().length_mm()).abs() < 1e-9
        );
        assert!((map.scale(DVec2::ZERO, 1.0) - 34.5 / 33.5).abs() < 1e-12);
    }

    #[test]
    fn a_thickness_beyond_the_radius_folds() {
        let ring = SpaceCurve::ring(5.0).unwrap();
        let Err(SpaceError::Fold { radius_mm, reach_mm, .. }) = SpaceMap::new(ring, [-3.0, 3.0], [-4.9, 4.9])
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
            )
        };
        assert!(band(11.0).is_ok());
        let Err(SpaceError::Contact { at_mm: [a, b], position }) = band(12.5) else { panic!("12.5 > 12") };
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
            SpaceMap::new(SpaceCurve::through(&points, true).unwrap(), [-2.0, 2.0], [-0.5, 0.5])
        };
        assert!(eight(10.0).is_ok());
        let Err(SpaceError::Contact { position, .. }) = eight(0.0) else { panic!("it crosses itself") };
        assert!(position.length() < 4.0, "{position}");
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
            let Ok(map) = SpaceMap::new(curve, [-1.5, 1.5], [-0.4, 0.4]) else { return Ok(()) };
            for pair in map.lines(chord).windows(2) {
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
