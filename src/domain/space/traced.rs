//! Curves on models, with smooth frames.
//!
//! The polyline on the model has a corner at every edge, and normals that follow the facets. Both are averaged over
//! a little of the curve and sampled evenly, and a spline goes through the samples: the base curve, and the *normal
//! trace*, which is projected on the unit sphere. The trace made perpendicular to the curve is the front of the
//! band. Zhou 2014 §6.3, which takes Bézier pieces with forward differences as tangents; a spline with a continuous
//! second derivative has no kinks.

use glam::DVec3;

use super::super::surface::MeshCurve;
use super::curve::SpaceFrame;
use super::error::SpaceError;
use super::measured::Measured;
use super::spline::Spline;

/// Samples of the polyline on each side of the middle of an average.
const PARTS: i32 = 8;
/// A curve has at least so many spacings: fewer, and the average is of all of it.
const LEAST_SAMPLES: f64 = 12.0;
/// The most samples: ten metres at half a millimetre.
const MOST_SAMPLES: f64 = 20_000.0;
/// Normals of neighbouring samples turn by no more than this, as a cosine, and are no nearer to the direction of
/// travel than this, as a sine. Less, and the trace between two samples may pass the centre of the sphere, from
/// where it has no direction.
const LEAST: f64 = 0.2;

/// A base curve with the trace of its normals, by the same parameter.
#[derive(Debug, Clone)]
pub(super) struct Traced {
    measured: Measured,
    trace: Spline,
}

impl Traced {
    pub(super) fn new(curve: &MeshCurve, spacing_mm: f64) -> Result<Self, SpaceError> {
        let polyline = Polyline::new(curve);
        let length = polyline.length();
        let count = (length / spacing_mm).ceil();
        if !(LEAST_SAMPLES..=MOST_SAMPLES).contains(&count) {
            return Err(SpaceError::Spacing { spacing_mm, length_mm: length });
        }
        let samples = count as usize + usize::from(!curve.is_closed);
        let at = |i: usize| polyline.average(length * i as f64 / count, spacing_mm);
        let (points, normals): (Vec<DVec3>, Vec<DVec3>) = (0..samples).map(at).unzip();
        let n = points.len();
        let next = |i: usize| (i + 1) % n;
        let steps: Vec<f64> = (0..count as usize).map(|i| points[i].distance(points[next(i)])).collect();
        let at_mm = |i: usize| length * i as f64 / count;
        if let Some(i) = (0..steps.len()).find(|&i| steps[i] < 0.01 * spacing_mm) {
            return Err(SpaceError::Cusp { position: points[i], at_mm: at_mm(i) });
        }
        if let Some(i) = (0..steps.len()).find(|&i| normals[i].dot(normals[next(i)]) < LEAST) {
            return Err(SpaceError::Edge { position: points[i], at_mm: at_mm(i) });
        }
        let trace = Spline::by_steps(&normals, steps, curve.is_closed);
        let traced = Self { measured: Measured::new(Spline::through(&points, curve.is_closed))?, trace };
        let measured = &traced.measured;
        let is_steep = |&step: &usize| {
            let along = measured.jet(step).velocity.normalize();
            let normal = traced.trace.at(measured.parameter(step)).point;
            normal.length() < LEAST || along.cross(normal.normalize()).length() < LEAST
        };
        match (0..measured.steps()).find(is_steep) {
            Some(step) => {
                let (position, at_mm) = (measured.jet(step).point, measured.length_to(step));
                Err(SpaceError::Edge { position, at_mm })
            }
            None => Ok(traced),
        }
    }

    pub(super) fn length(&self) -> f64 {
        self.measured.length()
    }

    pub(super) fn frame(&self, u: f64) -> SpaceFrame {
        let (_, t) = self.measured.locate(u);
        let jet = self.measured.at(t);
        let along = jet.velocity.normalize();
        // How long the trace is does not matter: only where it goes through the sphere.
        let normal = self.trace.at(t).point.normalize();
        let out = (normal - along * normal.dot(along)).normalize();
        SpaceFrame { point: jet.point, along, across: out.cross(along), out, curvature: jet.curvature() }
    }
}

/// A curve on a model by its length.
struct Polyline<'a> {
    curve: &'a MeshCurve,
    /// The length up to each point; of a closed curve the first comes again.
    lengths: Vec<f64>,
}

impl<'a> Polyline<'a> {
    fn new(curve: &'a MeshCurve) -> Self {
        let mut lengths = vec![0.0];
        for [a, b] in curve.pieces() {
            let piece = curve.points_mm[a].distance(curve.points_mm[b]);
            lengths.push(lengths[lengths.len() - 1] + piece);
        }
        Self { curve, lengths }
    }

    fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The place at a length, which goes round on a closed curve, and the normal there.
    fn at(&self, u: f64) -> (DVec3, DVec3) {
        let u = if self.curve.is_closed { u.rem_euclid(self.length()) } else { u.clamp(0.0, self.length()) };
        let i = self.lengths.partition_point(|&s| s <= u).clamp(1, self.lengths.len() - 1) - 1;
        let part = (u - self.lengths[i]) / (self.lengths[i + 1] - self.lengths[i]);
        let next = (i + 1) % self.curve.points_mm.len();
        let between = |of: &[DVec3]| of[i].lerp(of[next], part);
        (between(&self.curve.points_mm), between(&self.curve.normals))
    }

    /// The mean place and normal around a length, the nearer the more; at the ends of an open curve only what is as
    /// far on both sides.
    fn average(&self, u: f64, reach: f64) -> (DVec3, DVec3) {
        let reach = match self.curve.is_closed {
            true => reach,
            false => reach.min(u).min(self.length() - u).max(0.0),
        };
        let (mut point, mut normal) = (DVec3::ZERO, DVec3::ZERO);
        for i in 1 - PARTS..PARTS {
            let weight = f64::from(PARTS - i.abs()) / f64::from(PARTS * PARTS);
            let (p, n) = self.at(u + reach * f64::from(i) / f64::from(PARTS));
            point += p * weight;
            normal += n * weight;
        }
        let (_, here) = self.at(u);
        (point, normal.normalize_or(here))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::super::surface::sample_meshes::{Facet, ball, blob, clean, grid, tube};
    use super::super::curve::SpaceCurve;
    use super::*;
    use proptest::prelude::*;

    fn is_right_handed(frame: &SpaceFrame) -> bool {
        let units = [frame.along, frame.across, frame.out].iter().all(|v| (v.length() - 1.0).abs() < 1e-9);
        units && frame.along.cross(frame.across).distance(frame.out) < 1e-9
    }

    #[test]
    fn around_a_tube_it_is_a_ring() {
        let mesh = clean(tube([88, 10], 40.0, |_| 25.0));
        let curve = SpaceCurve::on_surface(&mesh.around(17.0).unwrap()[0], 2.0).unwrap();
        let ring = SpaceCurve::ring(25.0).unwrap();
        assert!(curve.is_closed() && (curve.length_mm() - ring.length_mm()).abs() < 0.4);
        for i in 0..100 {
            let part = f64::from(i) / 100.0;
            let (frame, wanted) =
                (curve.frame(part * curve.length_mm()), ring.frame(part * ring.length_mm()));
            assert!(frame.point.distance(wanted.point + 17.0 * DVec3::Z) < 0.1, "{}", frame.point);
            let directions =
                [(frame.along, wanted.along), (frame.across, wanted.across), (frame.out, wanted.out)];
            assert!(directions.iter().all(|(a, b)| a.distance(*b) < 0.02), "{frame:?} {wanted:?}");
            assert!((frame.curvature.length() - 1.0 / 25.0).abs() < 0.02, "{}", frame.curvature.length());
        }
    }

    #[test]
    fn facets_do_not_show() {
        // A coarse tube: 12 flat sides of 13 mm. With the average over one of them the front turns evenly.
        let mesh = clean(tube([12, 4], 40.0, |_| 25.0));
        let curve = SpaceCurve::on_surface(&mesh.around(17.0).unwrap()[0], 13.0).unwrap();
        let step = curve.length_mm() / 360.0;
        for i in 0..360 {
            let [a, b] = [i, i + 1].map(|i| curve.frame(f64::from(i) * step).out);
            let turn = a.angle_between(b) / (TAU / 360.0);
            assert!((0.8..1.2).contains(&turn), "{i}: {turn}");
        }
    }

    #[test]
    fn the_ends_stay_where_they_are() {
        let mesh = clean(grid([20, 20], [false; 2], |p| (40.0 * p).extend(6.0 * (3.0 * p.x).sin())));
        let points = [(4.0, 9.0), (15.0, 30.0), (36.0, 21.0)].map(|(x, y)| DVec3::new(x, y, 3.0));
        let on = mesh.through(&points, false, 9.0).unwrap();
        let curve = SpaceCurve::on_surface(&on, 1.0).unwrap();
        assert!(curve.frame(0.0).point.distance(on.points_mm[0]) < 1e-9);
        let last = on.points_mm[on.points_mm.len() - 1];
        assert!(curve.frame(curve.length_mm()).point.distance(last) < 1e-6);
    }

    #[test]
    fn edges_and_lengths_that_make_no_band_are_told() {
        let mesh = clean(ball(6, |p| 20.0 * p));
        let ring = &mesh.around(0.0).unwrap()[0];
        for spacing in [0.0, -1.0, f64::NAN, 30.0, 1e-9] {
            let refused = SpaceCurve::on_surface(ring, spacing).unwrap_err();
            assert!(matches!(refused, SpaceError::Spacing { .. }), "{spacing}: {refused}");
        }
        // A blade: two sheets that meet in a sharp edge, over which the normal goes by the shortest way or the
        // curve turns back.
        let blade: Vec<Facet> = grid([40, 8], [true, false], |p| {
            let (s, c) = (TAU * p.x).sin_cos();
            DVec3::new(30.0 * c, 0.05 * s, 20.0 * p.y)
        });
        let refused = SpaceCurve::on_surface(&clean(blade).around(10.0).unwrap()[0], 0.5).unwrap_err();
        assert!(matches!(refused, SpaceError::Edge { .. } | SpaceError::Cusp { .. }), "{refused}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn frames_are_orthonormal_and_have_no_jumps(
            amounts in prop::array::uniform3(-0.1..0.1f64),
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 3..6),
            height in -15.0..15.0f64,
            is_around in any::<bool>(),
        ) {
            let mesh = blob(12, amounts);
            let points: Vec<DVec3> =
                points.into_iter().filter_map(|p| DVec3::from(p).try_normalize()).map(|p| 30.0 * p).collect();
            let on = match is_around {
                true => mesh.around(height).unwrap().swap_remove(0),
                false => match mesh.through(&points, false, 15.0) {
                    Ok(curve) => curve,
                    Err(_) => return Ok(()),
                },
            };
            let Ok(curve) = SpaceCurve::on_surface(&on, 1.5) else { return Ok(()) };
            let n = 4000;
            let step = curve.length_mm() / f64::from(n);
            let mut before = curve.frame(0.0);
            let places = if curve.is_closed() { n + 3 } else { n };
            for i in 1..=places {
                let frame = curve.frame(f64::from(i) * step);
                prop_assert!(is_right_handed(&frame));
                // A chord is never longer than its arc, and much shorter only in a turn as tight as the step.
                let chord = frame.point.distance(before.point) / step;
                let (bend, turn) = (before.along.distance(frame.along), before.out.distance(frame.out));
                prop_assert!(chord < 1.02 && (chord > 0.5 || bend > 1.0), "at {i}: {chord} {bend}");
                // About the curve it turns as the model does under it: here less than a third of a radian in each
                // millimetre.
                prop_assert!(turn <= 2.0 * bend + 0.3 * step, "at {i}: {turn} {bend} {step}");
                before = frame;
            }
        }
    }
}
