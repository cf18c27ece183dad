//! Facets from a file, made into triangles on common vertices.
//!
//! Corners with equal coordinates become one vertex, in the order in which they come first. Facets of which nothing
//! is left, and repeated ones, are taken out. A facet whose three corners are in one line has no area and no
//! normal; it fills the gap between a long edge on one side and two short ones on the other. Its longest edge is
//! turned: with d across it, the facets abc and bad become bcd and cad. What was mended is told. Excluded: gaps
//! between corners that are only nearly equal, which are borders.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::error::SurfaceError;
use super::exact::is_in_line;
use super::repair::{RepairKind, Repairs};
use super::sides::{Crowded, NONE, bucketed, from, previous, to, twins};

/// The most facets: their sides must be numbers of 32 bits, and memory must hold them.
const MOST_FACETS: usize = 50_000_000;
/// How far from the origin a corner may be, in millimetres; farther off, 32-bit floats are a tenth of a micrometre
/// apart and more.
const FAR_MM: f32 = 2000.0;
/// How often facets without area are looked for. Each round mends all that do not touch, so chains of a few are
/// gone in as many rounds.
const ROUNDS: usize = 64;

/// Triangles on common vertices, of any orientation.
#[derive(Debug)]
pub(super) struct Soup {
    pub(super) vertices: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Soup {
    pub(super) fn new(
        facets: impl IntoIterator<Item = [[f32; 3]; 3]>,
        repairs: &mut Repairs,
    ) -> Result<Self, SurfaceError> {
        let mut soup = Self::welded(facets, repairs)?;
        soup.drop_repeated(repairs);
        soup.mend_flat(repairs)?;
        soup.drop_unused();
        match soup.triangles.is_empty() {
            true => Err(SurfaceError::Empty),
            false => Ok(soup),
        }
    }

    fn welded(
        facets: impl IntoIterator<Item = [[f32; 3]; 3]>,
        repairs: &mut Repairs,
    ) -> Result<Self, SurfaceError> {
        let facets = facets.into_iter();
        let expected = facets.size_hint().0;
        let mut known: FxHashMap<[u32; 3], u32> = FxHashMap::default();
        known.reserve(expected / 2);
        let mut soup = Self { vertices: Vec::new(), triangles: Vec::with_capacity(expected) };
        for (number, facet) in facets.enumerate() {
            if number == MOST_FACETS {
                return Err(SurfaceError::TooMany { most: MOST_FACETS });
            }
            // What is no number is not within the bounds either.
            if !facet.as_flattened().iter().all(|x| x.abs() <= FAR_MM) {
                return Err(SurfaceError::Coordinates { facet: number + 1 });
            }
            let triangle = facet.map(|corner| {
                // Minus zero is zero.
                let corner = corner.map(|x| x + 0.0);
                *known.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                    soup.vertices.push(DVec3::from(corner.map(f64::from)));
                    soup.vertices.len() as u32 - 1
                })
            });
            let [a, b, c] = triangle;
            match a == b || b == c || c == a {
                true => repairs.add(RepairKind::Collapsed, soup.vertices[a as usize]),
                false => soup.triangles.push(triangle),
            }
        }
        Ok(soup)
    }

    /// Of facets with the same three corners, whichever way round, the first stays.
    fn drop_repeated(&mut self, repairs: &mut Repairs) {
        let sorted = |triangle: &[u32; 3]| {
            let mut sorted = *triangle;
            sorted.sort_unstable();
            sorted
        };
        let keyed = self.triangles.iter().enumerate().map(|(i, triangle)| {
            let [low, middle, high] = sorted(triangle);
            (low, (middle, high, i as u32))
        });
        let (starts, mut held) = bucketed(self.vertices.len(), keyed);
        let mut is_repeated = vec![false; self.triangles.len()];
        for pair in starts.windows(2) {
            let bucket = &mut held[pair[0] as usize..pair[1] as usize];
            bucket.sort_unstable();
            for two in bucket.windows(2).filter(|two| (two[0].0, two[0].1) == (two[1].0, two[1].1)) {
                is_repeated[two[1].2 as usize] = true;
            }
        }
        for (triangle, _) in self.triangles.iter().zip(&is_repeated).filter(|(_, repeated)| **repeated) {
            repairs.add(RepairKind::Repeated, self.vertices[triangle[0] as usize]);
        }
        let mut repeated = is_repeated.iter();
        self.triangles.retain(|_| repeated.next() == Some(&false));
    }

    fn mend_flat(&mut self, repairs: &mut Repairs) -> Result<(), SurfaceError> {
        for _ in 0..ROUNDS {
            let mut flat: Vec<(f64, u32)> = (0..self.triangles.len() as u32)
                .filter(|&t| is_in_line(self.corners(t)))
                .map(|t| (self.longest(t).1, t))
                .collect();
            if flat.is_empty() {
                return Ok(());
            }
            // The longest first: what is across the longest edge of all is no longer, so turning makes edges
            // shorter, and that ends.
            flat.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            if self.mend_round(&flat, repairs)? == 0 {
                break;
            }
        }
        let left = (0..self.triangles.len() as u32).find(|&t| is_in_line(self.corners(t)));
        left.map_or(Ok(()), |t| Err(SurfaceError::Flat { position: self.corners(t)[0] }))
    }

    /// Turns the longest edges of those of the `flat` facets that do not touch; how many.
    fn mend_round(&mut self, flat: &[(f64, u32)], repairs: &mut Repairs) -> Result<usize, SurfaceError> {
        let twins = twins(&self.triangles, self.vertices.len()).map_err(|edge| self.crowded(edge))?;
        let mut edges: Vec<(u32, u32)> = Vec::with_capacity(twins.len());
        for side in 0..twins.len() as u32 {
            let (a, b) = (from(&self.triangles, side), to(&self.triangles, side));
            edges.push((a.min(b), a.max(b)));
        }
        edges.sort_unstable();
        let mut is_touched = vec![false; self.triangles.len()];
        let mut is_gone = vec![false; self.triangles.len()];
        let mut mended = 0;
        for &(_, t) in flat {
            let side = self.longest(t).0;
            let (a, b) = (from(&self.triangles, side), to(&self.triangles, side));
            let c = self.opposite(side);
            let twin = twins[side as usize];
            if is_touched[t as usize] {
                continue;
            }
            if twin == NONE {
                is_gone[t as usize] = true;
            } else {
                let (other, d) = ((twin / 3) as usize, self.opposite(twin));
                let turned = (c.min(d), c.max(d));
                if is_touched[other] || edges.binary_search(&turned).is_ok() {
                    continue;
                }
                is_touched[other] = true;
                let across = self.triangles[other];
                let with_c = |gone: u32| across.map(|v| if v == gone { c } else { v });
                (self.triangles[other], self.triangles[t as usize]) = (with_c(a), with_c(b));
            }
            is_touched[t as usize] = true;
            mended += 1;
            repairs.add(RepairKind::Flat, self.vertices[c as usize]);
        }
        let mut gone = is_gone.iter();
        self.triangles.retain(|_| gone.next() == Some(&false));
        Ok(mended)
    }

    /// The longest side of a triangle and the square of its length.
    fn longest(&self, t: u32) -> (u32, f64) {
        let square = |side: u32| {
            let [a, b] = [from(&self.triangles, side), to(&self.triangles, side)];
            self.vertices[a as usize].distance_squared(self.vertices[b as usize])
        };
        let sides = (3 * t..3 * t + 3).map(|side| (side, square(side)));
        sides.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).expect("three sides")
    }

    fn opposite(&self, side: u32) -> u32 {
        from(&self.triangles, previous(side))
    }

    fn corners(&self, t: u32) -> [DVec3; 3] {
        self.triangles[t as usize].map(|v| self.vertices[v as usize])
    }

    /// The error for an edge of too many triangles.
    pub(super) fn crowded(&self, edge: Crowded) -> SurfaceError {
        let ends = edge.ends.map(|v| self.vertices[v as usize]);
        SurfaceError::Crowded { ends, facets: edge.triangles, more: edge.more }
    }

    fn drop_unused(&mut self) {
        let mut places = vec![NONE; self.vertices.len()];
        for &v in self.triangles.as_flattened() {
            places[v as usize] = 0;
        }
        let kept = places.iter_mut().filter(|place| **place != NONE);
        kept.zip(0..).for_each(|(place, number)| *place = number);
        let mut place = places.iter();
        self.vertices.retain(|_| place.next() != Some(&NONE));
        for v in self.triangles.as_flattened_mut() {
            *v = places[*v as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soup(facets: &[[[f32; 3]; 3]]) -> (Result<Soup, SurfaceError>, Vec<String>) {
        let mut repairs = Repairs::default();
        let soup = Soup::new(facets.iter().copied(), &mut repairs);
        (soup, repairs.told().iter().map(ToString::to_string).collect())
    }

    const A: [f32; 3] = [0.0, 0.0, 0.0];
    const B: [f32; 3] = [3.0, 0.0, 0.0];
    const C: [f32; 3] = [1.0, 0.0, 0.0];
    const D: [f32; 3] = [1.0, -2.0, 0.0];
    const E: [f32; 3] = [1.0, 2.0, 0.5];

    #[test]
    fn corners_are_welded_and_what_is_nothing_is_dropped() {
        let minus_zero = [-0.0, 0.0, -0.0];
        let (made, told) = soup(&[[A, B, E], [A, A, E], [E, A, B], [B, minus_zero, D], [B, E, A]]);
        let made = made.unwrap();
        assert_eq!((made.vertices.len(), made.triangles), (4, vec![[0, 1, 2], [1, 0, 3]]));
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].contains("1 facet") && told[1].contains("2 "), "{told:?}");
    }

    #[test]
    fn a_facet_without_area_is_turned_away() {
        // Between the long edge of one facet and the two short ones of others.
        let (made, told) = soup(&[[B, A, D], [A, C, E], [C, B, E], [A, B, C]]);
        let made = made.unwrap();
        assert_eq!(made.triangles.len(), 4);
        assert!((0..4).all(|t| !is_in_line(made.corners(t))));
        assert!(twins(&made.triangles, made.vertices.len()).is_ok());
        assert_eq!(told.len(), 1, "{told:?}");
        // At a border it is left out.
        assert_eq!(soup(&[[A, C, E], [C, B, E], [A, B, C]]).0.unwrap().triangles.len(), 2);
    }

    #[test]
    fn what_is_no_model_is_refused() {
        assert_eq!(soup(&[]).0.unwrap_err(), SurfaceError::Empty);
        assert_eq!(soup(&[[A, B, C]]).0.unwrap_err(), SurfaceError::Empty);
        let bad = [f32::NAN, 0.0, 0.0];
        assert_eq!(soup(&[[A, B, D], [A, B, bad]]).0.unwrap_err(), SurfaceError::Coordinates { facet: 2 });
        assert!(soup(&[[A, B, [3000.0, 0.0, 0.0]]]).0.is_err());
    }
}
