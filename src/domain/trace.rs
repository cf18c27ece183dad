//! Contours through the map: polylines that stay within the chord error.
//!
//! A straight edge in (u, v) becomes a curve. It is halved until samples of the curve, close enough together to
//! see every bend, stay within the chord error of the chord between its ends.

use glam::DVec2;

use super::band::BandMap;

/// A chord error below this gives no better part, only more points.
const MIN_CHORD_MM: f64 = 1e-5;
/// The part of the chord error that is used, as the greatest error may lie between two samples.
const CHORD_SHARE: f64 = 0.9;

impl BandMap {
    /// Maps a closed contour and keeps its orientation.
    ///
    /// `points` are its vertices in (u, v) with u unwrapped: u runs on past the length of a closed curve. The
    /// contour closes from the last vertex to the first one moved by `winding` lengths along u, so a contour
    /// that does not go round has winding 0. Points are added on the edges so that the polyline returned stays
    /// within `chord_mm` of the image of the straight (u, v) edges; every vertex is among its points. The
    /// first point is not repeated at the end.
    ///
    /// # Panics
    /// When `winding` is not 0 on an open curve.
    pub fn map_contour(&self, points: &[DVec2], winding: i32, chord_mm: f64) -> Vec<DVec2> {
        assert!(winding == 0 || self.curve().is_closed(), "nothing winds round an open curve");
        let Some(&first) = points.first() else { return Vec::new() };
        let end = first + DVec2::new(f64::from(winding) * self.curve().length_mm(), 0.0);
        let mut mapped = Vec::with_capacity(2 * points.len());
        for (i, &from) in points.iter().enumerate() {
            let to = points.get(i + 1).copied().unwrap_or(end);
            self.trace(from, to, chord_mm, &mut |_, point| mapped.push(point));
        }
        mapped
    }

    /// Maps an open line, whose vertices are in (u, v) with u unwrapped, within `chord_mm` likewise.
    pub fn map_line(&self, points: &[DVec2], chord_mm: f64) -> Vec<DVec2> {
        let mut mapped = Vec::with_capacity(2 * points.len());
        for pair in points.windows(2) {
            self.trace(pair[0], pair[1], chord_mm, &mut |_, point| mapped.push(point));
        }
        mapped.extend(points.last().map(|last| self.map(last.x, last.y)));
        mapped
    }

    /// Calls `put` with (u, v) and the place of points along the straight edge from `from` to `to`: `from`
    /// itself, then what the chord error asks for; not `to`.
    pub(super) fn trace(&self, from: DVec2, to: DVec2, chord_mm: f64, put: &mut impl FnMut(DVec2, DVec2)) {
        let tolerance = CHORD_SHARE * chord_mm.max(MIN_CHORD_MM);
        let start = (from, self.map(from.x, from.y));
        put(start.0, start.1);
        self.refine(start, (to, self.map(to.x, to.y)), tolerance, put);
    }

    fn refine(
        &self,
        from: (DVec2, DVec2),
        to: (DVec2, DVec2),
        tolerance: f64,
        put: &mut impl FnMut(DVec2, DVec2),
    ) {
        if self.is_flat(from, to, tolerance) {
            return;
        }
        let middle = 0.5 * (from.0 + to.0);
        let middle = (middle, self.map(middle.x, middle.y));
        self.refine(from, middle, tolerance, put);
        put(middle.0, middle.1);
        self.refine(middle, to, tolerance, put);
    }

    /// Whether samples of the edge's image stay within `tolerance` of its chord.
    fn is_flat(&self, from: (DVec2, DVec2), to: (DVec2, DVec2), tolerance: f64) -> bool {
        let chord = to.1 - from.1;
        let samples = 4 * ((to.0.x - from.0.x).abs() / self.sample_mm).ceil().max(1.0) as usize;
        (1..samples).all(|i| {
            let uv = from.0.lerp(to.0, i as f64 / samples as f64);
            let p = self.map(uv.x, uv.y) - from.1;
            let t = if chord == DVec2::ZERO { 0.0 } else { p.dot(chord) / chord.length_squared() };
            p.distance_squared(chord * t.clamp(0.0, 1.0)) <= tolerance * tolerance
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{PlanarCurve, sample_curves};
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    fn area(ring: &[DVec2]) -> f64 {
        let n = ring.len();
        0.5 * (0..n).map(|i| ring[i].perp_dot(ring[(i + 1) % n])).sum::<f64>()
    }

    #[test]
    fn rings_by_winding() {
        let map = BandMap::new(PlanarCurve::circle(60.0).unwrap(), -7.0, 7.0).unwrap();
        let length = map.curve().length_mm();
        // Along travel, clockwise, at v = 5: the outside of a circle of radius 35.
        let forward = map.map_contour(&[DVec2::new(3.0, 5.0)], 1, 0.001);
        assert!((area(&forward) + PI * 35.0 * 35.0).abs() < 0.3);
        assert!(forward.iter().all(|p| (p.length() - 35.0).abs() < 1e-9));
        let vertices = [0.0, -0.25, -0.75].map(|part| DVec2::new(part * length + 7.0 * length, -4.0));
        let back = map.map_contour(&vertices, -1, 0.001);
        assert!((area(&back) - PI * 26.0 * 26.0).abs() < 0.3);
        for vertex in vertices {
            assert!(back.contains(&map.map(vertex.x, vertex.y)));
        }
        // Winding 0 across the seam keeps its orientation.
        let square = [(-3.0, -1.0), (3.0, -1.0), (3.0, 2.0), (-3.0, 2.0)].map(|(u, v)| DVec2::new(u, v));
        let mapped = map.map_contour(&square, 0, 0.001);
        let expected = 6.0 / length * PI * (32.0 * 32.0 - 29.0 * 29.0);
        assert!((area(&mapped) - expected).abs() < 0.01);
        assert!(map.map_contour(&[], 0, 0.001).is_empty());
    }

    #[test]
    #[should_panic(expected = "nothing winds round an open curve")]
    fn an_open_curve_has_no_winding() {
        let map = BandMap::new(PlanarCurve::line(120.0).unwrap(), -7.0, 7.0).unwrap();
        map.map_contour(&[DVec2::ZERO], 1, 0.01);
    }

    #[test]
    fn points_are_added_only_where_they_are_needed() {
        let map = BandMap::new(PlanarCurve::circle(60.0).unwrap(), -7.0, 7.0).unwrap();
        let ring = map.map_contour(&[DVec2::ZERO], 1, 0.01);
        // A chord of a circle of radius r errs by r (1 - cos(half of its angle)).
        let least = TAU / (2.0 * (1.0 - 0.01 / 30.0f64).acos());
        assert!((ring.len() as f64) >= least && (ring.len() as f64) < 2.2 * least, "{} {least}", ring.len());
    }

    fn distance_to_polyline(p: DVec2, ring: &[DVec2]) -> f64 {
        let n = ring.len();
        let distance = |i: usize| {
            let (a, d) = (ring[i], ring[(i + 1) % n] - ring[i]);
            let t =
                if d == DVec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
            p.distance(a + d * t)
        };
        (0..n).map(distance).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn contours_stay_within_the_chord_error(
            path in sample_curves::closed_path(), chord in 0.002..0.1f64, winding in -1..=1i32,
            vertices in prop::collection::vec((-0.3..1.3f64, -5.0..5.0f64), 1..6),
        ) {
            let curve = PlanarCurve::from_bez_path(&path).unwrap();
            let length = curve.length_mm();
            let map = BandMap::new(curve, -5.0, 5.0);
            prop_assume!(map.is_ok());
            let map = map.unwrap();
            let vertices: Vec<DVec2> = vertices.iter().map(|&(s, v)| DVec2::new(s * length, v)).collect();
            let ring = map.map_contour(&vertices, winding, chord);
            let end = vertices[0] + DVec2::new(f64::from(winding) * length, 0.0);
            for (i, &a) in vertices.iter().enumerate() {
                let b = vertices.get(i + 1).copied().unwrap_or(end);
                for j in 0..150 {
                    let uv = a.lerp(b, f64::from(j) / 150.0);
                    let off = distance_to_polyline(map.map(uv.x, uv.y), &ring);
                    prop_assert!(off <= chord, "{} > {}", off, chord);
                }
            }
        }
    }
}
