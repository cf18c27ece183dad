//! Curves in space by arc length, with frames that turn no more than they must.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use super::super::surface::MeshCurve;
use super::error::SpaceError;
use super::measured::Measured;
use super::spline::{Jet, Spline};
use super::traced::Traced;
use super::twist::Twist;

/// Points nearer to each other than this are one, in millimetres.
const SAME_MM: f64 = 1e-6;
/// How far from the origin a point may be, in millimetres: farther off, the 32-bit floats of files are a tenth of a micrometre apart and more.
const FAR_MM: f64 = 2000.0;
/// The greatest length of a curve in millimetres.
const MAX_LENGTH_MM: f64 = 1e5;
/// The least length of a curve in millimetres.
const MIN_LENGTH_MM: f64 = 0.1;

/// A smooth curve in space by arc length u in millimetres, open or closed, with a right-handed frame at each place.
#[derive(Debug, Clone)]
pub struct SpaceCurve {
    kind: Kind,
    length: f64,
    is_closed: bool,
    twist: Twist,
    /// What is added to z.
    lift: f64,
}

#[derive(Debug, Clone)]
enum Kind {
    /// On a cylinder around the z axis: its radius, by how much it rises for each radian, and the angle at u = 0.
    Helix { radius: f64, rise: f64, start: f64 },
    /// Through points, with frames that turn as little as they can.
    Carried(Carried),
    /// On a model, with its outside as the front.
    Traced(Traced),
}

/// A curve at one place. `along`, `across` and `out` are unit vectors and a right-handed basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceFrame {
    /// The point, in mm.
    pub point: DVec3,
    /// The direction of travel.
    pub along: DVec3,
    /// Where v points: across the band.
    pub across: DVec3,
    /// Where the thickness points: the front of the band.
    pub out: DVec3,
    /// The curvature in 1/mm, as a vector towards the centre.
    pub curvature: DVec3,
}

impl SpaceCurve {
    /// A whole circle around the z axis, travelled counter-clockwise seen from above, so that v points up and the front of
    /// the band is outside. It begins at the back, on the y axis.
    ///
    /// # Errors
    /// [`SpaceError::Radius`] unless the radius is a length.
    pub fn ring(radius_mm: f64) -> Result<Self, SpaceError> {
        Self::on_cylinder(radius_mm, 0.0, TAU, true)
    }

    /// The same without a gap at the back, which is `gap_mm` wide, straight across, at `gap_radius_mm` from the axis.
    ///
    /// # Errors
    /// [`SpaceError::Gap`] unless the gap is narrower than the ring.
    pub fn cuff(radius_mm: f64, gap_mm: f64, gap_radius_mm: f64) -> Result<Self, SpaceError> {
        let sine = 0.5 * gap_mm / gap_radius_mm;
        if !(sine > 0.0 && sine < 1.0) {
            return Err(SpaceError::Gap { gap_mm, most_mm: 2.0 * gap_radius_mm });
        }
        Self::on_cylinder(radius_mm, 0.0, TAU - 2.0 * sine.asin(), false)
    }

    /// A helix around the z axis that rises by `pitch_mm` with each turn to the left and begins at z = 0. Its front is away from
    /// the axis: the band lies on the cylinder.
    ///
    /// # Errors
    /// [`SpaceError::Radius`] and [`SpaceError::Turns`] for what makes no helix.
    pub fn helix(radius_mm: f64, pitch_mm: f64, turns: f64) -> Result<Self, SpaceError> {
        if !(turns > 0.0 && turns <= 1e4 && pitch_mm.is_finite()) {
            return Err(SpaceError::Turns { turns, pitch_mm });
        }
        Self::on_cylinder(radius_mm, pitch_mm, turns * TAU, false)
    }

    fn on_cylinder(radius: f64, pitch_mm: f64, angle: f64, is_closed: bool) -> Result<Self, SpaceError> {
        let rise = pitch_mm / TAU;
        let length = radius.hypot(rise) * angle;
        if !(radius > 0.0 && radius <= FAR_MM && length >= MIN_LENGTH_MM) {
            return Err(SpaceError::Radius { radius_mm: radius });
        }
        if length > MAX_LENGTH_MM {
            return Err(SpaceError::Length { length_mm: length, most_mm: MAX_LENGTH_MM });
        }
        // What is open is so at the back, and a helix begins there.
        let start = if pitch_mm == 0.0 { FRAC_PI_2 + 0.5 * (TAU - angle) } else { FRAC_PI_2 };
        let kind = Kind::Helix { radius, rise, start };
        Ok(Self { kind, length, is_closed, twist: Twist::default(), lift: 0.0 })
    }

    /// A straight line along x, v along y: what is laid along it lies on its back.
    ///
    /// # Errors
    /// [`SpaceError::Points`] unless it has a length.
    pub fn lying(length_mm: f64) -> Result<Self, SpaceError> {
        Self::through(&[DVec3::ZERO, DVec3::X * length_mm], false)?.twisted(&Twist::constant(-FRAC_PI_2))
    }

    /// A smooth curve through `points`. At its start v points up as far as it can, along y where the curve itself goes up.
    ///
    /// # Errors
    /// [`SpaceError::Points`] for fewer than two points (three of a closed curve), [`SpaceError::Coordinates`] for what is no
    /// place, [`SpaceError::Twice`] where two in a row are the same, and [`SpaceError::Cusp`] where it turns on the spot.
    pub fn through(points: &[DVec3], is_closed: bool) -> Result<Self, SpaceError> {
        let wanted = if is_closed { 3 } else { 2 };
        if points.len() < wanted {
            return Err(SpaceError::Points { found: points.len(), wanted });
        }
        if let Some(number) = points.iter().position(|p| !p.is_finite() || p.abs().max_element() > FAR_MM) {
            return Err(SpaceError::Coordinates { number: number + 1 });
        }
        let pairs = points.len() - usize::from(!is_closed);
        let is_twice = |i: &usize| points[*i].distance(points[(i + 1) % points.len()]) < SAME_MM;
        if let Some(i) = (0..pairs).find(is_twice) {
            return Err(SpaceError::Twice { number: i + 1, position: points[i] });
        }
        let carried = Carried::new(Spline::through(points, is_closed))?;
        let length = carried.measured.length();
        if length < MIN_LENGTH_MM {
            return Err(SpaceError::Points { found: points.len(), wanted });
        }
        let mut curve =
            Self { kind: Kind::Carried(carried), length, is_closed, twist: Twist::default(), lift: 0.0 };
        if is_closed {
            // Carried all the way round, the frame comes back turned; that is undone evenly.
            let (start, end) = (curve.frame(0.0), curve.frame_unwrapped(length));
            let turned = start.across.dot(end.out).atan2(start.across.dot(end.across));
            curve.twist = Twist::even(turned, length);
        }
        Ok(curve)
    }

    /// A smooth curve along one on a model, whose front is the outside of the model. It is the curve averaged over about
    /// `spacing_mm` and sampled as densely, so it may leave the model by a little; so are its normals, and facets that
    /// are not much longer than that do not show. A twist would lift the band off the model.
    ///
    /// # Errors
    /// [`SpaceError::Spacing`] unless the curve has at least a dozen spacings, [`SpaceError::Cusp`] where it turns on the
    /// spot, and [`SpaceError::Edge`] where the model does.
    pub fn on_surface(curve: &MeshCurve, spacing_mm: f64) -> Result<Self, SpaceError> {
        let traced = Traced::new(curve, spacing_mm)?;
        let (length, is_closed) = (traced.length(), curve.is_closed);
        Ok(Self { kind: Kind::Traced(traced), length, is_closed, twist: Twist::default(), lift: 0.0 })
    }

    /// The same with frames that are turned about the direction of travel as well, counter-clockwise seen against it.
    ///
    /// # Errors
    /// [`SpaceError::Twist`] for a closed curve that is not turned by whole turns, [`SpaceError::TwistPlace`] for places beyond the end.
    pub fn twisted(mut self, twist: &Twist) -> Result<Self, SpaceError> {
        if let Some(place) = twist.places().find(|&place| place > self.length + 1e-6) {
            return Err(SpaceError::TwistPlace { place_mm: place, length_mm: self.length });
        }
        let by = twist.at(self.length, self.length) - twist.at(0.0, self.length);
        if self.is_closed && (by / TAU - (by / TAU).round()).abs() > 1e-9 {
            return Err(SpaceError::Twist { by_deg: by.to_degrees() });
        }
        self.twist = self.twist.and(twist);
        Ok(self)
    }

    /// The same, `by_mm` higher.
    pub fn lifted(mut self, by_mm: f64) -> Self {
        self.lift += by_mm;
        self
    }

    /// Places between its ends where its twist begins to change otherwise.
    pub(super) fn creases(&self) -> impl Iterator<Item = f64> + '_ {
        self.twist.places().filter(|&u| u > 0.0 && u < self.length)
    }

    /// The length in mm.
    pub fn length_mm(&self) -> f64 {
        self.length
    }

    /// Whether the end is the start.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The curve at arc length `u`, which goes round on a closed curve; of an open one it is from 0 to the length.
    pub fn frame(&self, u: f64) -> SpaceFrame {
        let is_inside = (0.0..=self.length).contains(&u);
        self.frame_unwrapped(if self.is_closed && !is_inside { u.rem_euclid(self.length) } else { u })
    }

    fn frame_unwrapped(&self, u: f64) -> SpaceFrame {
        let frame = match &self.kind {
            Kind::Helix { radius, rise, start } => {
                let speed = radius.hypot(*rise);
                let (sin, cos) = (start + u / speed).sin_cos();
                let out = DVec3::new(cos, sin, 0.0);
                let along = (DVec3::new(-sin, cos, 0.0) * *radius + DVec3::Z * *rise) / speed;
                SpaceFrame {
                    point: out * *radius + DVec3::Z * (rise * u / speed),
                    along,
                    across: out.cross(along),
                    out,
                    curvature: -out * (radius / (speed * speed)),
                }
            }
            Kind::Carried(carried) => carried.frame(u),
            Kind::Traced(traced) => traced.frame(u),
        };
        let frame = SpaceFrame { point: frame.point + DVec3::Z * self.lift, ..frame };
        let angle = self.twist.at(u, self.length);
        if angle == 0.0 {
            return frame;
        }
        let (sin, cos) = angle.sin_cos();
        let across = cos * frame.across + sin * frame.out;
        SpaceFrame { across, out: frame.along.cross(across), ..frame }
    }
}

/// A spline with frames at many parameters.
#[derive(Debug, Clone)]
struct Carried {
    measured: Measured,
    across: Vec<DVec3>,
}

impl Carried {
    fn new(spline: Spline) -> Result<Self, SpaceError> {
        let measured = Measured::new(spline)?;
        let start = measured.jet(0).velocity.normalize();
        let up = if start.z.abs() < 0.99 { DVec3::Z } else { DVec3::Y };
        let mut across = vec![(up - start * up.dot(start)).normalize()];
        for i in 1..measured.steps() {
            let next = transported(across[i - 1], measured.jet(i - 1), measured.jet(i));
            across.push(next);
        }
        Ok(Self { measured, across })
    }

    fn frame(&self, u: f64) -> SpaceFrame {
        let (i, t) = self.measured.locate(u);
        let jet = self.measured.at(t);
        let along = jet.velocity.normalize();
        let carried = transported(self.across[i], self.measured.jet(i), jet);
        let across = (carried - along * carried.dot(along)).normalize();
        SpaceFrame { point: jet.point, along, across, out: along.cross(across), curvature: jet.curvature() }
    }
}

/// A direction across the curve at `from`, carried to `to` by two reflections (Wang, Jüttler, Zheng and Liu 2008, table I).
fn transported(across: DVec3, from: Jet, to: Jet) -> DVec3 {
    let reflected = |v: DVec3, normal: DVec3| match normal.length_squared() {
        0.0 => v,
        square => v - normal * (2.0 * normal.dot(v) / square),
    };
    let chord = to.point - from.point;
    let (across, along) = (reflected(across, chord), reflected(from.velocity.normalize(), chord));
    reflected(across, to.velocity.normalize() - along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn is_right_handed(frame: &SpaceFrame) -> bool {
        let units = [frame.along, frame.across, frame.out].iter().all(|v| (v.length() - 1.0).abs() < 1e-9);
        units && frame.along.cross(frame.across).distance(frame.out) < 1e-9
    }

    #[test]
    fn a_ring_is_read_from_outside() {
        let ring = SpaceCurve::ring(32.5).unwrap();
        assert!((ring.length_mm() - TAU * 32.5).abs() < 1e-9 && ring.is_closed());
        let front = ring.frame(0.5 * ring.length_mm());
        assert!(front.point.distance(DVec3::new(0.0, -32.5, 0.0)) < 1e-9);
        assert!(front.along.distance(DVec3::X) < 1e-9 && front.across.distance(DVec3::Z) < 1e-9);
        assert!(front.out.distance(DVec3::NEG_Y) < 1e-9);
        assert!(ring.frame(-1.0).point.distance(ring.frame(ring.length_mm() - 1.0).point) < 1e-9);
    }

    #[test]
    fn a_cuff_is_open_at_the_back_by_its_gap() {
        let cuff = SpaceCurve::cuff(33.5, 25.0, 32.5).unwrap();
        let [a, b] = [0.0, cuff.length_mm()].map(|u| cuff.frame(u).point * (32.5 / 33.5));
        assert!((a.distance(b) - 25.0).abs() < 1e-9 && a.y > 0.0 && (a.y - b.y).abs() < 1e-9);
        for bad in [0.0, -1.0, 65.0, f64::NAN] {
            assert!(matches!(SpaceCurve::cuff(33.5, bad, 32.5), Err(SpaceError::Gap { .. })));
        }
    }

    #[test]
    fn a_helix_lies_on_its_cylinder() {
        let helix = SpaceCurve::helix(20.0, 12.0, 3.0).unwrap();
        for i in 0..=100 {
            let u = helix.length_mm() * f64::from(i) / 100.0;
            let frame = helix.frame(u);
            assert!((frame.point.truncate().length() - 20.0).abs() < 1e-9 && is_right_handed(&frame));
            assert!((frame.point.z - 36.0 * f64::from(i) / 100.0).abs() < 1e-9);
            assert!(frame.out.distance(frame.point.with_z(0.0) / 20.0) < 1e-9);
        }
    }

    #[test]
    fn a_spline_through_a_circle_is_nearly_one() {
        let points: Vec<DVec3> = (0..24)
            .map(|i| TAU * f64::from(i) / 24.0)
            .map(|a| DVec3::new(30.0 * a.cos(), 30.0 * a.sin(), 5.0))
            .collect();
        let curve = SpaceCurve::through(&points, true).unwrap();
        assert!((curve.length_mm() - TAU * 30.0).abs() < 1e-2, "{}", curve.length_mm());
        let frame = curve.frame(50.0);
        assert!(
            (frame.curvature.length() - 1.0 / 30.0).abs() < 1e-4 && frame.across.distance(DVec3::Z) < 1e-9
        );
        assert!(frame.out.dot(frame.point.normalize()) > 0.9);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let through = |points: &[DVec3], is_closed| SpaceCurve::through(points, is_closed).unwrap_err();
        assert!(matches!(through(&[p(0.0, 0.0)], false), SpaceError::Points { found: 1, wanted: 2 }));
        assert!(matches!(through(&[p(0.0, 0.0), p(9.0, 0.0)], true), SpaceError::Points { .. }));
        let twice = through(&[p(0.0, 0.0), p(9.0, 0.0), p(9.0, 0.0), p(0.0, 5.0)], false);
        assert!(matches!(twice, SpaceError::Twice { number: 2, .. }));
        let far = through(&[p(0.0, 0.0), p(f64::NAN, 0.0)], false);
        assert!(matches!(far, SpaceError::Coordinates { number: 2 }));
        let back = through(&[p(0.0, 0.0), p(10.0, 0.0), p(0.0, 0.0)], false);
        assert!(matches!(back, SpaceError::Cusp { .. }), "{back}");
    }

    #[test]
    fn a_closed_curve_twists_by_whole_turns() {
        let ring = || SpaceCurve::ring(30.0).unwrap();
        let half = Twist::even(0.5 * TAU, ring().length_mm());
        assert!(matches!(ring().twisted(&half), Err(SpaceError::Twist { .. })));
        let whole = ring().twisted(&"360".parse().unwrap()).unwrap();
        let quarter = whole.frame(0.25 * whole.length_mm());
        assert!(quarter.across.distance(ring().frame(0.25 * whole.length_mm()).out) < 1e-9);
        assert!(is_right_handed(&quarter));
    }

    #[test]
    fn what_lies_shows_its_front() {
        let frame = SpaceCurve::lying(80.0).unwrap().frame(30.0);
        assert!(frame.point.distance(DVec3::X * 30.0) < 1e-9 && frame.across.distance(DVec3::Y) < 1e-9);
        assert!(frame.out.distance(DVec3::Z) < 1e-9 && is_right_handed(&frame));
    }

    proptest! {
            #![proptest_config(ProptestConfig::with_cases(48))]
            #[test]
            fn frames_are_orthonormal_and_have_no_jumps(
                points in prop::collection::vec((-50.0..50.0f64, -50.0..50.0f64, -50.0..50.0f64), 4..9),
                is_closed in any::<bool>(),
            ) {
                let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
                let Ok(curve) = SpaceCurve::through(&points, is_closed) else { return Ok(()) };
                let n = 4000;
                let step = curve.length_mm() / f64::from(n);
                let mut before = curve.frame(0.0);
                let turns = if is_closed { n + 3 } else { n };
                for i in 1..=turns {
                    let frame = curve.frame(f64::from(i) * step);
                    prop_assert!(is_right_handed(&frame));
    // A chord is never longer than its arc, and much shorter only in a turn as tight as the step.
                    let chord = frame.point.distance(before.point) / step;
                    prop_assert!(chord < 1.02 && chord > 0.5, "at {i}: {chord}");
                    // It turns about itself no more than the curve bends, and evenly so that it closes.
                    let bend = before.along.distance(frame.along);
                    let turn = before.across.distance(frame.across);
                    prop_assert!(turn <= bend + 3.5 * step / curve.length_mm() + 1e-6, "at {i}: {turn} {bend}");
                    before = frame;
                }
            }
        }
}
