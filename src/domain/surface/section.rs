//! Where a level plane cuts a model.
//!
//! A vertex counts as above the plane when it is on it, so that each triangle has no piece of the cut or one, and
//! pieces join into chains without a special case. A piece goes from the side that goes down through the plane to
//! the one that goes up. Excluded: planes that are not level.

use glam::DVec3;

use super::curve::MeshCurve;
use super::error::SurfaceError;
use super::mesh::Mesh;
use super::sides::{NONE, next};

impl Mesh {
    /// All curves in which the plane z = `height_mm` cuts the model, the longest first; there is at least one.
    ///
    /// Seen from above, the outside is on the right of each: one around a part goes counter-clockwise, as a ring
    /// does, one around a hollow clockwise. A closed one begins at its back, where y is greatest; one that meets a
    /// border is open.
    ///
    /// # Errors
    /// [`SurfaceError::Height`] with what would be met.
    pub fn around(&self, height_mm: f64) -> Result<Vec<MeshCurve>, SurfaceError> {
        let is_above = |vertex: u32| self.vertices_mm()[vertex as usize].z >= height_mm;
        let goes_down = |side: u32| is_above(self.from(side)) && !is_above(self.to(side));
        let goes_up = |side: u32| !is_above(self.from(side)) && is_above(self.to(side));
        let place = |side: u32| {
            let [a, b] = [self.from(side), self.to(side)].map(|v| self.vertices_mm()[v as usize].z);
            let (point, normal) = self.place_on(side, (height_mm - a) / (b - a));
            (point.with_z(height_mm), normal)
        };
        let mut is_seen = vec![false; self.triangles().len()];
        let mut curves: Vec<(f64, MeshCurve)> = Vec::new();
        // What begins at a border first: from the middle on it would be two.
        let down = || (0..3 * self.triangles().len() as u32).filter(|&side| goes_down(side));
        let from_border = down().filter(|&side| self.twin(side) == NONE);
        for first in from_border.chain(down()) {
            let mut places = vec![place(first)];
            let mut side = first;
            while side != NONE && !std::mem::replace(&mut is_seen[(side / 3) as usize], true) {
                let up = if goes_up(next(side)) { next(side) } else { next(next(side)) };
                places.push(place(up));
                side = self.twin(up);
            }
            // It may come round to where it began, or touch the plane in a point.
            let is_closed = side != NONE;
            if let Some(curve) = MeshCurve::cleaned(places, is_closed) {
                let curve = if is_closed { from_the_back(curve) } else { curve };
                curves.push((curve.length_mm(), curve));
            }
        }
        if curves.is_empty() {
            let [low, high] = self.bounds_mm();
            return Err(SurfaceError::Height { height_mm, low_mm: low.z, high_mm: high.z });
        }
        curves.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(curves.into_iter().map(|(_, curve)| curve).collect())
    }
}

/// The same loop from its greatest y on.
fn from_the_back(mut curve: MeshCurve) -> MeshCurve {
    let key = |p: DVec3| (p.y, -p.x.abs());
    let better = |a: DVec3, b: DVec3| key(a) > key(b);
    let mut first = 0;
    for i in 1..curve.points_mm.len() {
        if better(curve.points_mm[i], curve.points_mm[first]) {
            first = i;
        }
    }
    curve.points_mm.rotate_left(first);
    curve.normals.rotate_left(first);
    curve
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::sample_meshes::{Facet, ball, blob, clean, torus, tube};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_ring_goes_round_as_rings_do() {
        let curves = clean(ball(12, |p| 30.0 * p)).around(4.0).unwrap();
        let [curve] = curves.as_slice() else { panic!("{} curves", curves.len()) };
        assert!(curve.is_closed && (curve.length_mm() - TAU * 29.7).abs() < 2.0);
        assert!(curve.points_mm[0].y > 29.0);
        for i in 1..curve.points_mm.len() {
            let along = curve.points_mm[i] - curve.points_mm[i - 1];
            // Along, up and out are right-handed.
            assert!(along.cross(DVec3::Z).dot(curve.normals[i]) > 0.0);
        }
    }

    #[test]
    fn vertices_on_the_plane_make_no_difference() {
        // The rings of a tube are at whole heights.
        let mesh = clean(tube([24, 10], 10.0, |_| 20.0));
        for height in [1.0, 1.5, 5.0, 10.0] {
            let curves = mesh.around(height).unwrap();
            assert_eq!(curves.len(), 1, "{height}");
            assert!(curves[0].points_mm.len() >= 24 && curves[0].is_closed);
            assert!((curves[0].length_mm() - TAU * 20.0).abs() < 0.5);
        }
        assert!(matches!(mesh.around(0.0), Err(SurfaceError::Height { low_mm: 0.0, high_mm: 10.0, .. })));
        assert!(mesh.around(10.1).is_err());
    }

    #[test]
    fn all_that_is_cut_is_told() {
        let curves = clean(torus([48, 16], 30.0, 8.0)).around(1.0).unwrap();
        assert_eq!(curves.len(), 2);
        assert!(curves[0].length_mm() > curves[1].length_mm() + 50.0);
        // Half a tube is cut into a curve with two ends.
        let half: Vec<Facet> = tube([24, 10], 10.0, |_| 20.0).split_off(240);
        let curves = clean(half).around(3.3).unwrap();
        assert!(curves.len() == 1 && !curves[0].is_closed, "{}", curves.len());
    }

    proptest! {
        #[test]
        fn sections_are_on_the_model(amounts in prop::array::uniform3(-0.12..0.12f64), height in -20.0..20.0f64) {
            let mesh = blob(6, amounts);
            for curve in mesh.around(height).unwrap() {
                prop_assert!(curve.is_closed);
                curve.check_on(&mesh);
            }
        }
    }
}
