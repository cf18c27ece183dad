//! A smooth curve on a model, past control points.
//!
//! The points are brought to the model and joined by a way along its edges. The surface around that is cut out as a
//! disc ([`Disc`]) and laid flat, and a spline is drawn on it ([`Drawing`]): about the middle, if the way goes
//! round what the disc leaves out, and else straight on. If the spline needs more room than there is, the same is
//! done with more of the surface. Zhou 2014 §6.3, which lays the whole model flat.

use std::f64::consts::TAU;

use glam::DVec3;

use super::closest::Place;
use super::curve::MeshCurve;
use super::disc::{Disc, NoDisc};
use super::drawing::Drawing;
use super::error::SurfaceError;
use super::mesh::Mesh;
use super::route::Route;

/// How much of the surface is laid flat beside the way: this part of the longest way between two points, one after
/// the other until the curve stays in it, with at most so many vertices. More, and it takes longer (40,000 vertices
/// take a third of a second); less, and the curve feels the border, or leaves it.
const ROOM: [(f64, usize); 3] = [(1.5, 40_000), (3.0, 80_000), (6.0, 160_000)];
/// Around a way that may go round something, at first no more than this part of the radius of a circle as long.
/// More, and nothing is left to go round: on a ball, the poles are 1.6 radii from the equator, and the middle of a
/// flat circle is one.
const TURN: f64 = 0.6;
/// Room is never less than so many lengths of an edge.
const LEAST_EDGES: f64 = 4.0;
/// Places nearer to each other than this are one, in millimetres.
const SAME_MM: f64 = 1e-6;

impl Mesh {
    /// A smooth curve through `control_mm`, each of which is first brought to the nearest place of the model.
    ///
    /// It lies on the model; how it runs between the points depends on how the surface around them can be laid
    /// flat. It may meet itself.
    ///
    /// # Errors
    /// [`SurfaceError::Control`], [`SurfaceError::Points`] for fewer than two points, or three of a closed curve,
    /// [`SurfaceError::Off`] for a point that is farther off than `tolerance_mm`, [`SurfaceError::Twice`] for two in a row
    /// at one place, [`SurfaceError::Parts`], [`SurfaceError::Handle`], [`SurfaceError::Coarse`], [`SurfaceError::Leaves`] and [`SurfaceError::Flipped`].
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
        self.curve_past(&places, is_closed)
    }

    /// A smooth curve along a polyline, brought to the model as control points are; of points that come to the same
    /// place one is passed.
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
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(SurfaceError::Control { number: i + 1 });
        }
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
        let least = LEAST_EDGES * self.edge_length(&route);
        let mut last = None;
        for (part, most) in ROOM {
            let room = (part * gap).max(least);
            let turn = TURN * route.length() / TAU * (part / ROOM[0].0);
            let disc = self.disc_around(&route, room.min(turn.max(least)), most)?;
            let round = Drawing::round(self, &disc, &route, places, is_closed)?;
            let wide;
            let drawing = match round {
                Some(drawing) => drawing,
                None => {
                    wide = self.disc_around(&route, room, most)?;
                    Drawing::straight(self, &wide, &route, places, is_closed)?
                }
            };
            match drawing.curve() {
                Ok(curve) => return Ok(curve),
                Err(leaves) => last = Some(leaves),
            }
        }
        Err(last.expect("there was a last try"))
    }

    /// The greatest disc up to `reach` around a way that is one.
    fn disc_around(&self, route: &Route, reach: f64, most: usize) -> Result<Disc, SurfaceError> {
        let vertices = route.vertices();
        let near = self.within(&vertices, reach, most);
        let mut reach = near[near.len() - 1].1;
        loop {
            let count = near.partition_point(|&(_, distance)| distance <= reach);
            let inner: Vec<u32> = near[..count].iter().map(|&(v, _)| v).collect();
            match Disc::around(self, &inner) {
                Ok(disc) => return Ok(disc),
                // Nor is the way alone.
                Err(NoDisc::Closed) if reach == 0.0 => {
                    let position = self.vertices_mm()[vertices[0] as usize];
                    return Err(SurfaceError::Coarse { position });
                }
                Err(NoDisc::Handle) if reach == 0.0 => {
                    return Err(SurfaceError::Handle { position: self.met(&vertices) });
                }
                // A little less leaves a cap, or the far side of a handle.
                Err(NoDisc::Closed | NoDisc::Handle) => {
                    reach = if count <= vertices.len() { 0.0 } else { 0.8 * reach };
                }
            }
        }
    }

    /// Where a way comes to a vertex for the second time.
    fn met(&self, way: &[u32]) -> DVec3 {
        let mut sorted = way.to_vec();
        sorted.sort_unstable();
        let twice = way.iter().find(|v| {
            let first = sorted.partition_point(|other| other < v);
            sorted.get(first + 1) == Some(v)
        });
        self.vertices_mm()[*twice.unwrap_or(&way[0]) as usize]
    }

    /// The mean length of the edges along a way, or at its one vertex.
    fn edge_length(&self, route: &Route) -> f64 {
        let place = |v: u32| self.vertices_mm()[v as usize];
        let edges = route
            .vertices()
            .into_iter()
            .flat_map(|v| self.neighbours(v).map(move |n| place(v).distance(place(n))));
        let (sum, count) = edges.fold((0.0, 0.0), |(sum, count), length| (sum + length, count + 1.0));
        sum / count
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{ball, blob, clean, grid, torus, tube};
    use super::*;
    use glam::DVec2;
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
        let unknown = mesh.through(&[DVec3::X, DVec3::NAN], false, 2.0);
        assert_eq!(unknown.unwrap_err(), SurfaceError::Control { number: 2 });
        // Of four triangles, none is beside the curve.
        let corners = [[0.0f32, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t| t.map(|v: usize| corners[v]));
        let tips = corners.map(|[x, y, z]| DVec3::new(x.into(), y.into(), z.into()));
        let coarse = clean(tetrahedron.to_vec()).through(&tips, true, 1.0).err();
        assert!(matches!(coarse, Some(SurfaceError::Coarse { .. })), "{coarse:?}");
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
