//! A smooth curve on a model, past control points.
//!
//! The surface around a way past the points is laid flat ([`Disc`], [`Flat`]), a spline is drawn there through where the points came to lie, and walked over the
//! triangles ([`Walk`]). If the spline needs more room than there is, the same is done with more of the surface. Zhou 2014 §6.3, which lays the whole model flat.

use glam::{DVec2, DVec3};

use super::super::space::Spline;
use super::closest::Place;
use super::curve::MeshCurve;
use super::disc::{Disc, NoDisc};
use super::error::SurfaceError;
use super::mean_value::Flat;
use super::mesh::Mesh;
use super::route::Route;
use super::walk::{Left, Walk, in_plane};

/// How much of the surface is laid flat beside the way: this part of the longest way between two points, one after the other until the curve stays in it, with at most so many
/// vertices. More, and it takes longer (30,000 vertices take a second) and curves feel far corners of the model; less, and the curve leaves it.
const ROOM: [(f64, usize); 3] = [(0.5, 30_000), (1.0, 60_000), (2.0, 120_000)];
/// Room is never less than so many lengths of an edge.
const LEAST_EDGES: f64 = 4.0;
/// A sample of the spline about every so many millimetres of the way, so that chords are a micrometre off where it bends with a radius of 5 mm.
const SAMPLE_MM: f64 = 0.2;
/// Samples between two points, at least and at most.
const SAMPLES: [f64; 2] = [8.0, 4000.0];
/// So many guides are laid between two control points, where the model is no farther off than this part of the way between them.
const GUIDES: usize = 3;
const GUIDE_PART: f64 = 0.35;
/// Places nearer to each other than this are one, in millimetres.
const SAME_MM: f64 = 1e-6;
/// What each corner of a facet counts at least for a control point, so that it is strictly inside. Its place moves by that part of the facet.
const INSIDE: f64 = 1e-9;
/// The most oblong ellipse on which the border of an open curve's surroundings is laid.
const MOST_OBLONG: f64 = 8.0;

impl Mesh {
    /// A smooth curve through `control_mm`, each of which is first brought to the nearest place of the model.
    ///
    /// It lies on the model, and runs between the points as the spline through them in space would, led onto it. It may meet itself.
    ///
    /// # Errors
    /// [`SurfaceError::Points`] for fewer than two points, or three of a closed curve, [`SurfaceError::Off`] for a point that is farther off than `tolerance_mm`,
    /// [`SurfaceError::Twice`], [`SurfaceError::Parts`], [`SurfaceError::Handle`], [`SurfaceError::Leaves`] and [`SurfaceError::Flipped`].
    pub fn through(
        &self,
        control_mm: &[DVec3],
        is_closed: bool,
        tolerance_mm: f64,
    ) -> Result<MeshCurve, SurfaceError> {
        let places = self.places(control_mm, tolerance_mm)?;
        let n = places.len();
        let pairs = if is_closed { n } else { n.saturating_sub(1) };
        let is_twice = |&i: &usize| places[i].point.distance(places[(i + 1) % n].point) < SAME_MM;
        if n > 1
            && let Some(i) = (0..pairs).find(is_twice)
        {
            return Err(SurfaceError::Twice { number: i + 1, position: places[i].point });
        }
        self.curve_past(&self.guided(places, is_closed), is_closed)
    }

    /// Control points with guides between them: places of the model next to the spline through the points in space. The plane is stretched far from a
    /// curve, and what is fair there need not be fair on the model; a spline in space is, but it has to be led onto it. Where it runs far
    /// from the model, as through it, there are none.
    fn guided(&self, places: Vec<Place>, is_closed: bool) -> Vec<Place> {
        let n = places.len();
        let points: Vec<DVec3> = places.iter().map(|place| place.point).collect();
        if n < if is_closed { 3 } else { 2 } {
            return places;
        }
        let spline = Spline::through(&points, is_closed);
        let knots = spline.knots();
        let guides: Vec<DVec3> = (0..knots.len() - 1)
            .flat_map(|i| (1..=GUIDES).map(move |k| (i, k as f64 / (GUIDES + 1) as f64)))
            .map(|(i, part)| spline.at(knots[i] + part * (knots[i + 1] - knots[i])).point)
            .collect();
        let far_mm = |i: usize| GUIDE_PART * points[i].distance(points[(i + 1) % n]);
        let most_mm = (0..knots.len() - 1).map(far_mm).fold(0.0, f64::max);
        let found = self.nearest(&guides, most_mm);
        let mut guided: Vec<Place> = Vec::with_capacity(n + guides.len());
        for (i, place) in places.into_iter().enumerate() {
            guided.push(place);
            let between = found.chunks_exact(GUIDES).nth(i).into_iter().flatten().flatten();
            guided.extend(between.filter(|guide| guide.distance <= far_mm(i)).copied());
        }
        guided.dedup_by(|b, a| a.point.distance(b.point) < SAME_MM);
        guided
    }

    /// A smooth curve along a polyline, brought to the model as control points are; of points that come to the same place one is passed.
    ///
    /// # Errors
    /// As [`Mesh::through`], but for [`SurfaceError::Twice`].
    pub fn along(
        &self,
        polyline_mm: &[DVec3],
        is_closed: bool,
        tolerance_mm: f64,
    ) -> Result<MeshCurve, SurfaceError> {
        let mut places = self.places(polyline_mm, tolerance_mm)?;
        places.dedup_by(|b, a| a.point.distance(b.point) < SAME_MM);
        while is_closed
            && places.len() > 1
            && places[0].point.distance(places[places.len() - 1].point) < SAME_MM
        {
            places.pop();
        }
        self.curve_past(&places, is_closed)
    }

    fn places(&self, points: &[DVec3], tolerance_mm: f64) -> Result<Vec<Place>, SurfaceError> {
        let nearest = self.nearest(points, tolerance_mm);
        let place = |(i, found): (usize, Option<Place>)| {
            found.ok_or_else(|| {
                let nearest = self.nearest_anywhere(points[i]);
                SurfaceError::Off {
                    number: i + 1,
                    distance_mm: nearest.map_or(f64::INFINITY, |place| place.distance),
                    tolerance_mm,
                    nearest: nearest.map_or(points[i], |place| place.point),
                }
            })
        };
        nearest.into_iter().enumerate().map(place).collect()
    }

    fn curve_past(&self, places: &[Place], is_closed: bool) -> Result<MeshCurve, SurfaceError> {
        let wanted = if is_closed { 3 } else { 2 };
        if places.len() < wanted {
            return Err(SurfaceError::Points { found: places.len(), wanted });
        }
        let route = self.route(places, is_closed)?;
        let gap = route.lengths.iter().copied().fold(0.0, f64::max);
        let edges = LEAST_EDGES * self.edge_length(&route);
        let mut last = None;
        for (part, most) in ROOM {
            let (disc, reach) = self.disc_around(&route, (part * gap).max(edges), most)?;
            let drawing = Drawing::new(self, &disc, &route, places, reach, is_closed)?;
            match drawing.curve() {
                Ok(curve) => return Ok(curve),
                Err(leaves) => last = Some(leaves),
            }
        }
        Err(last.expect("there was a last try"))
    }

    /// The greatest disc up to `reach` around a way that is one, with how far it reaches.
    fn disc_around(&self, route: &Route, reach: f64, most: usize) -> Result<(Disc, f64), SurfaceError> {
        let near = self.within(&route.vertices, reach, most);
        let mut reach = near[near.len() - 1].1;
        loop {
            let count = near.partition_point(|&(_, distance)| distance <= reach);
            let inner: Vec<u32> = near[..count].iter().map(|&(v, _)| v).collect();
            match Disc::around(self, &inner) {
                Ok(disc) => return Ok((disc, reach)),
                // The way alone is no disc.
                Err(_) if reach == 0.0 => return Err(SurfaceError::Handle { position: self.met(route) }),
                // A little less leaves a cap, or the far side of a handle.
                Err(NoDisc::Closed | NoDisc::Handle) => {
                    reach = if count <= route.vertices.len() { 0.0 } else { 0.8 * reach };
                }
            }
        }
    }

    /// Where a way comes to a vertex for the second time.
    fn met(&self, route: &Route) -> DVec3 {
        let mut sorted = route.vertices.clone();
        sorted.sort_unstable();
        let twice = route.vertices.iter().find(|v| {
            let first = sorted.partition_point(|other| other < v);
            sorted.get(first + 1) == Some(v)
        });
        self.vertices_mm()[*twice.unwrap_or(&route.vertices[0]) as usize]
    }

    /// The mean length of the edges along a way, or at its one vertex.
    fn edge_length(&self, route: &Route) -> f64 {
        let place = |v: u32| self.vertices_mm()[v as usize];
        let edges =
            route.vertices.iter().flat_map(|&v| self.neighbours(v).map(move |n| place(v).distance(place(n))));
        let (sum, count) = edges.fold((0.0, 0.0), |(sum, count), length| (sum + length, count + 1.0));
        sum / count
    }
}

/// A spline through control points on a disc that is laid flat.
struct Drawing<'a> {
    mesh: &'a Mesh,
    disc: &'a Disc,
    flat: Flat,
    route: &'a Route,
    /// The triangle of each control point, with the weights of its corners.
    controls: Vec<(usize, [f64; 3])>,
    is_closed: bool,
}

impl<'a> Drawing<'a> {
    fn new(
        mesh: &'a Mesh,
        disc: &'a Disc,
        route: &'a Route,
        places: &[Place],
        reach: f64,
        is_closed: bool,
    ) -> Result<Self, SurfaceError> {
        // A closed curve goes round the middle. An open one runs along, from one end of an ellipse to the other.
        let length: f64 = route.lengths.iter().sum();
        let oblong = ((0.5 * length + reach) / reach.max(1e-3 * length)).min(MOST_OBLONG);
        let half_axes = if is_closed { DVec2::ONE } else { DVec2::new(oblong, 1.0) };
        let far =
            |&i: &usize| disc.vertices[disc.border[i] as usize].distance(places[places.len() - 1].point);
        let start = (0..disc.border.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let flat = Flat::of(disc, half_axes, start).map_err(|triangle| SurfaceError::Flipped {
            position: disc.vertices[disc.triangles[triangle][0] as usize],
        })?;
        let control = |place: &Place| {
            let triangle =
                disc.facets.binary_search(&(place.facet as u32)).expect("the way begins at its corner");
            (triangle, place.weights.map(|weight| (weight + INSIDE) / (1.0 + 3.0 * INSIDE)))
        };
        Ok(Self { mesh, disc, flat, route, controls: places.iter().map(control).collect(), is_closed })
    }

    fn curve(&self) -> Result<MeshCurve, SurfaceError> {
        let at =
            |&(triangle, weights): &(usize, [f64; 3])| in_plane(self.disc, &self.flat, triangle, weights);
        let flat: Vec<DVec3> = self.controls.iter().map(|control| at(control).extend(0.0)).collect();
        let spline = Spline::through(&flat, self.is_closed);
        let (triangle, weights) = self.controls[0];
        let mut walk = Walk::new(self.mesh, self.disc, &self.flat, triangle, weights);
        let start = walk.at();
        for (i, knots) in spline.knots().windows(2).enumerate() {
            let samples = (self.route.lengths[i] / SAMPLE_MM).clamp(SAMPLES[0], SAMPLES[1]).ceil();
            for sample in 1..=samples as usize {
                let t = knots[0] + (knots[1] - knots[0]) * sample as f64 / samples;
                let is_last = self.is_closed && i + 2 == spline.knots().len() && sample == samples as usize;
                let target = if is_last { start } else { spline.at(t).point.truncate() };
                let leaves = |left: Left| SurfaceError::Leaves { number: i + 1, position: left.position };
                walk.go(target, is_last).map_err(leaves)?;
            }
        }
        let places = walk.finished();
        let position = places[0].0;
        MeshCurve::cleaned(places, self.is_closed).ok_or(SurfaceError::Twice { number: 1, position })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::sample_meshes::{ball, blob, clean, grid, torus, tube};
    use super::*;
    use proptest::prelude::*;

    fn circle(n: usize, radius: f64, z: f64) -> Vec<DVec3> {
        let angle = |i: usize| TAU * i as f64 / n as f64 + 0.1;
        (0..n).map(|i| (DVec2::from_angle(angle(i)) * radius).extend(z)).collect()
    }

    #[test]
    fn a_curve_goes_round_a_vase() {
        let mesh = clean(tube([48, 24], 60.0, |h| 20.0 + 5.0 * (4.0 * h).sin()));
        let curve = mesh.through(&circle(6, 25.0, 30.0), true, 6.0).unwrap();
        curve.check_on(&mesh);
        assert!((curve.length_mm() - TAU * 24.5).abs() < 3.0, "{}", curve.length_mm());
        assert!(curve.points_mm.iter().all(|p| (p.z - 30.0).abs() < 3.0));
    }

    #[test]
    fn a_curve_goes_round_a_handle_one_way() {
        let mesh = clean(torus([60, 24], 30.0, 10.0));
        let around_tube = (0..5).map(|i| TAU * f64::from(i) / 5.0);
        let meridian: Vec<DVec3> =
            around_tube.map(|a| DVec3::new(30.0 + 10.0 * a.cos(), 0.0, 10.0 * a.sin())).collect();
        let curve = mesh.through(&meridian, true, 1.0).unwrap();
        curve.check_on(&mesh);
        assert!((curve.length_mm() - TAU * 10.0).abs() < 3.0);
        let longways = mesh.through(&circle(8, 40.0, 0.0), true, 1.0).unwrap();
        assert!((longways.length_mm() - TAU * 40.0).abs() < 5.0);
        // Both ways in one curve, with the outermost place twice.
        let both: Vec<DVec3> = [circle(8, 40.0, 0.0), meridian].concat();
        let refused = mesh.through(&both, true, 1.5).unwrap_err();
        assert!(matches!(refused, SurfaceError::Handle { .. }), "{refused}");
    }

    #[test]
    fn it_passes_its_points_in_a_plane_as_splines_do() {
        let mesh = clean(grid([30, 30], [false; 2], |p| (60.0 * p).extend(0.0)));
        let points: Vec<DVec3> = [(12.0, 30.0), (24.0, 36.0), (36.0, 26.0), (48.0, 30.0)]
            .map(|(x, y)| DVec3::new(x, y, 0.5))
            .to_vec();
        let curve = mesh.through(&points, false, 1.0).unwrap();
        curve.check_on(&mesh);
        for p in &points {
            assert!(curve.points_mm.iter().any(|q| q.distance(p.with_z(0.0)) < 1e-6), "{p}");
        }
        assert!((37.0..48.0).contains(&curve.length_mm()));
        let same = mesh.through(&points, false, 1.0).unwrap();
        assert_eq!(curve, same);
    }

    #[test]
    fn what_makes_no_curve_is_refused() {
        let mesh = clean(ball(6, |p| 30.0 * p));
        let points = circle(4, 30.0, 0.0);
        let mut off = points.clone();
        off[2].x -= 9.0;
        match mesh.through(&off, true, 2.0).unwrap_err() {
            SurfaceError::Off { number: 3, distance_mm, nearest, .. } => {
                assert!(distance_mm > 8.0 && (nearest.length() - 29.8).abs() < 0.5);
            }
            other => panic!("{other}"),
        }
        assert!(matches!(
            mesh.through(&points[..2], true, 2.0),
            Err(SurfaceError::Points { found: 2, wanted: 3 })
        ));
        assert!(matches!(mesh.through(&[], false, 2.0), Err(SurfaceError::Points { found: 0, wanted: 2 })));
        let twice = [points[0], points[1], points[1], points[2]];
        assert!(matches!(mesh.through(&twice, true, 2.0), Err(SurfaceError::Twice { number: 2, .. })));
        assert!(mesh.along(&twice, true, 2.0).is_ok());
        // On a sheet the curve would have to leave it.
        let sheet = clean(grid([10, 10], [false; 2], |p| (20.0 * p).extend(0.0)));
        let at_border = [(1.0, 0.1), (10.0, 5.0), (19.0, 0.1), (10.0, 0.05)];
        let at_border = at_border.map(|(x, y)| DVec3::new(x, y, 0.0));
        let refused = sheet.through(&at_border, true, 1.0).unwrap_err();
        assert!(matches!(refused, SurfaceError::Leaves { .. }), "{refused}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn curves_lie_on_the_model(
            amounts in prop::array::uniform3(-0.12..0.12f64),
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 2..6),
            is_closed in any::<bool>(),
        ) {
            let mesh = blob(6, amounts);
            let points: Vec<DVec3> = points.into_iter().filter_map(|p| DVec3::from(p).try_normalize()).map(|p| 30.0 * p).collect();
            match mesh.through(&points, is_closed, 15.0) {
                Ok(curve) => curve.check_on(&mesh),
                Err(SurfaceError::Points { .. } | SurfaceError::Leaves { .. }) => {}
                Err(other) => prop_assert!(false, "{other}"),
            }
        }
    }
}
