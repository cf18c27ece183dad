//! A spline through control points on a disc of the model that is laid flat.
//!
//! A way that goes round a middle (a band round a vase, whose far side is left out) is drawn in the logarithm of
//! the plane about that middle: the angle and the logarithm of the distance. Laying flat keeps angles nearly, so a
//! band is as it was on the vase there, only unrolled, and what is even on the vase is even in it; in the plane
//! itself the outer of two equal waves would be wider. Any other way is drawn in the plane. Excluded: which part of
//! the model is laid flat.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::super::space::Spline;
use super::closest::Place;
use super::curve::MeshCurve;
use super::disc::Disc;
use super::error::SurfaceError;
use super::mean_value::Flat;
use super::mesh::Mesh;
use super::route::Route;
use super::walk::{Left, Walk, in_plane};

/// A sample of the spline about every so many millimetres of the way, so that chords are a micrometre off where it
/// bends with a radius of 5 mm.
const SAMPLE_MM: f64 = 0.2;
/// Samples between two points, at least and at most.
const SAMPLES: [f64; 2] = [8.0, 4000.0];
/// What each corner of a facet counts at least for a control point, so that it is strictly inside. Its place moves
/// by that part of the facet.
const INSIDE: f64 = 1e-9;
/// The most oblong ellipse on which the border around an open curve is laid.
const MOST_OBLONG: f64 = 8.0;
/// A way goes round a middle if it turns about it by this much, in radians. Less than most of a turn is no band
/// round anything.
const ROUND: f64 = 0.7 * TAU;

/// A spline on a disc that is laid flat.
pub(super) struct Drawing<'a> {
    mesh: &'a Mesh,
    disc: &'a Disc,
    flat: Flat,
    route: &'a Route,
    /// The triangle of each control point, with the weights of its corners.
    controls: Vec<(usize, [f64; 3])>,
    line: Line,
    is_closed: bool,
}

/// The spline.
enum Line {
    Plane(Spline),
    /// In angles and logarithms about a middle; a closed one has a part that comes round, and turns evenly besides.
    Round {
        middle: DVec2,
        spline: Spline,
        turn: f64,
    },
}

impl<'a> Drawing<'a> {
    /// The drawing of a way that goes round one of the middles of the disc; `None` if it does not.
    pub(super) fn round(
        mesh: &'a Mesh,
        disc: &'a Disc,
        route: &'a Route,
        places: &[Place],
        is_closed: bool,
    ) -> Result<Option<Self>, SurfaceError> {
        if disc.middles.is_empty() {
            return Ok(None);
        }
        let flat = laid_flat(disc, DVec2::ONE, 0)?;
        let controls = controls(disc, places);
        let turns = disc.middles.iter().map(|&middle| {
            let middle = flat.places[middle as usize];
            (middle, angles(disc, &flat, route, &controls, middle))
        });
        let whole = |angles: &[f64]| (angles[angles.len() - 1] - angles[0]).abs();
        // Of several the first, so that equal ones make no difference.
        let best = turns.reduce(|a, b| if whole(&b.1) > whole(&a.1) + 1e-6 { b } else { a });
        let Some((middle, angles)) = best.filter(|(_, angles)| whole(angles) > ROUND) else {
            return Ok(None);
        };
        let at = |&(triangle, weights): &(usize, [f64; 3])| in_plane(disc, &flat, triangle, weights);
        let n = controls.len();
        let place = |i: usize| DVec3::new(angles[i], at(&controls[i % n]).distance(middle).ln(), 0.0);
        let steps: Vec<f64> = (0..angles.len() - 1).map(|i| place(i).distance(place(i + 1))).collect();
        let turn = match is_closed {
            true => (angles[n] - angles[0]) / steps.iter().sum::<f64>(),
            false => 0.0,
        };
        let mut knot = 0.0;
        let mut points = Vec::new();
        for (i, step) in steps.iter().chain(&[0.0]).take(n).enumerate() {
            points.push(place(i) - DVec3::X * (turn * knot));
            knot += step;
        }
        let line = Line::Round { middle, spline: Spline::by_steps(&points, steps, is_closed), turn };
        Ok(Some(Self { mesh, disc, flat, route, controls, line, is_closed }))
    }

    /// The drawing in the plane itself.
    pub(super) fn straight(
        mesh: &'a Mesh,
        disc: &'a Disc,
        route: &'a Route,
        places: &[Place],
        is_closed: bool,
    ) -> Result<Self, SurfaceError> {
        // An open curve runs from one end of an ellipse to the other, which is as oblong as the surface around it is.
        let perimeter: f64 = lengths(disc).sum();
        let beside = (perimeter - 2.0 * route.length()) / TAU;
        let oblong = 1.0 + 0.5 * route.length() / beside.max(1e-3 * route.length());
        let is_round = is_closed || !disc.middles.is_empty();
        let half_axes = if is_round { DVec2::ONE } else { DVec2::new(oblong.min(MOST_OBLONG), 1.0) };
        let last = places[places.len() - 1].point;
        let far = |&i: &usize| disc.vertices[disc.border[i] as usize].distance(last);
        let start = (0..disc.border.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let flat = laid_flat(disc, half_axes, start)?;
        let controls = controls(disc, places);
        let at =
            |&(triangle, weights): &(usize, [f64; 3])| in_plane(disc, &flat, triangle, weights).extend(0.0);
        let line = Line::Plane(Spline::through(&controls.iter().map(at).collect::<Vec<_>>(), is_closed));
        Ok(Self { mesh, disc, flat, route, controls, line, is_closed })
    }

    /// The spline, walked over the triangles and brought back to the model.
    ///
    /// # Errors
    /// [`SurfaceError::Leaves`] where it leaves the disc, or comes upon what is not of the model.
    pub(super) fn curve(&self) -> Result<MeshCurve, SurfaceError> {
        let (triangle, weights) = self.controls[0];
        let mut walk = Walk::new(self.mesh, self.disc, &self.flat, triangle, weights);
        let start = walk.at();
        let knots = self.line.knots();
        for (i, pair) in knots.windows(2).enumerate() {
            let samples = (self.route.lengths[i] / SAMPLE_MM).clamp(SAMPLES[0], SAMPLES[1]).ceil();
            for sample in 1..=samples as usize {
                let t = pair[0] + (pair[1] - pair[0]) * sample as f64 / samples;
                let is_last = self.is_closed && i + 2 == knots.len() && sample == samples as usize;
                let target = if is_last { start } else { self.line.at(t) };
                let leaves = |left: Left| SurfaceError::Leaves { number: i + 1, position: left.position };
                walk.go(target, is_last).map_err(leaves)?;
            }
        }
        let places = walk.finished();
        let position = places[0].0;
        MeshCurve::cleaned(places, self.is_closed).ok_or(SurfaceError::Twice { number: 1, position })
    }
}

impl Line {
    fn knots(&self) -> &[f64] {
        match self {
            Self::Plane(spline) | Self::Round { spline, .. } => spline.knots(),
        }
    }

    fn at(&self, t: f64) -> DVec2 {
        match self {
            Self::Plane(spline) => spline.at(t).point.truncate(),
            Self::Round { middle, spline, turn } => {
                let place = spline.at(t).point;
                middle + DVec2::from_angle(place.x + turn * t) * place.y.exp()
            }
        }
    }
}

fn laid_flat(disc: &Disc, half_axes: DVec2, start: usize) -> Result<Flat, SurfaceError> {
    Flat::of(disc, half_axes, start).map_err(|triangle| SurfaceError::Flipped {
        position: disc.vertices[disc.triangles[triangle][0] as usize],
    })
}

fn controls(disc: &Disc, places: &[Place]) -> Vec<(usize, [f64; 3])> {
    let control = |place: &Place| {
        let facet = place.facet as u32;
        let triangle = disc.facets.binary_search(&facet).expect("the way begins and ends at its corners");
        (triangle, place.weights.map(|weight| (weight + INSIDE) / (1.0 + 3.0 * INSIDE)))
    };
    places.iter().map(control).collect()
}

/// The lengths of the edges along the border of a disc.
fn lengths(disc: &Disc) -> impl Iterator<Item = f64> + '_ {
    let place = |v: &u32| disc.vertices[*v as usize];
    let next = disc.border.iter().skip(1).chain(disc.border.first());
    disc.border.iter().zip(next).map(move |(a, b)| place(a).distance(place(b)))
}

/// The angle of each control point about a middle, counted on along the way; of a closed way that of the first
/// again at the end.
fn angles(
    disc: &Disc,
    flat: &Flat,
    route: &Route,
    controls: &[(usize, [f64; 3])],
    middle: DVec2,
) -> Vec<f64> {
    let control = |i: usize| {
        let (triangle, weights) = controls[i % controls.len()];
        in_plane(disc, flat, triangle, weights) - middle
    };
    let mut angles = vec![control(0).to_angle()];
    for (i, way) in route.ways.iter().enumerate() {
        let inner = way.iter().filter_map(|&v| disc.number(v)).map(|v| flat.places[v as usize] - middle);
        let mut at = control(i);
        let mut angle = angles[i];
        for next in inner.chain([control(i + 1)]) {
            angle += at.angle_to(next);
            at = next;
        }
        angles.push(angle);
    }
    angles
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{clean, tube};
    use super::*;

    /// Eight points round a cylinder, up and down by turns.
    fn waves(mesh: &Mesh) -> MeshCurve {
        let point = |i: u32| {
            let around = DVec2::from_angle(TAU * f64::from(i) / 8.0 + 0.05) * 20.0;
            around.extend(if i.is_multiple_of(2) { 34.0 } else { 26.0 })
        };
        mesh.through(&(0..8).map(point).collect::<Vec<_>>(), true, 1.0).unwrap()
    }

    #[test]
    fn equal_waves_stay_equal() {
        let curve = waves(&clean(tube([80, 40], 60.0, |_| 20.0)));
        let heights = || curve.points_mm.iter().map(|p| p.z - 30.0);
        let (low, high) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
        assert!((-4.2..-3.9).contains(&low) && (3.9..4.2).contains(&high), "{low} {high}");
        // It is as long above the middle as below.
        let above = curve.pieces().filter(|[a, _]| curve.points_mm[*a].z > 30.0);
        let above: f64 = above.map(|[a, b]| curve.points_mm[a].distance(curve.points_mm[b])).sum();
        assert!((above / curve.length_mm() - 0.5).abs() < 0.02, "{}", above / curve.length_mm());
    }
}
