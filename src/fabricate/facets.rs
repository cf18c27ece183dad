//! Facets from elsewhere, made a solid where they are the boundary of one.
//!
//! A mesh file, and an operation on meshes, gives facets with their corners, and nothing says that they belong together. Here
//! corners with the same 32-bit floats become one vertex, and the facets are numbered shell by shell. Facets whose corners
//! are not three different points bound nothing and are left out. What remains must be closed, oriented and in no place pinched;
//! otherwise the first fault is told with its place. Excluded: facets that cross each other, and repair.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::FabricateError;
use super::solid::Solid;
use crate::planar::Sets;

impl Solid {
    /// The solid that `facets` bound: corners in millimetres, counter-clockwise seen from outside, and from inside around a
    /// cavity. Shells come in the order of their first facets. No facets are a solid without shells.
    ///
    /// # Errors
    /// [`FabricateError::Facets`] with the place of the first edge that has not exactly two facets in opposite directions, of a
    /// facet without area, of a point in which surfaces only touch, of a shell that faces inwards and is no cavity, and of a
    /// coordinate that is no finite number.
    pub fn from_facets(facets: impl IntoIterator<Item = [[f32; 3]; 3]>) -> Result<Self, FabricateError> {
        let soup = Soup::weld(facets)?;
        soup.check_areas()?;
        let sides = soup.sides();
        let mut shells = Sets::new(soup.facets.len());
        // Facets around a vertex that follow each other across edges, by their corners.
        let mut fans = Sets::new(3 * soup.facets.len());
        for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
            let found = match edge {
                [a, b] if a.forward != b.forward => {
                    shells.join(a.facet, b.facet);
                    for v in a.ends {
                        fans.join(soup.corner(a.facet, v), soup.corner(b.facet, v));
                    }
                    continue;
                }
                [_] => "there is an edge with only one facet, so that the surface is open",
                [_, _] => {
                    "two facets run along an edge in the same direction, so that one of them is turned over"
                }
                _ => "more than two facets share an edge",
            };
            let [p, q] = edge[0].ends.map(|v| soup.point(v));
            return Err(FabricateError::Facets { position_mm: (p + q) / 2.0, found });
        }
        soup.check_fans(&mut fans)?;
        let shells = soup.shells(&mut shells);
        soup.check_inside_out(&shells)?;
        Ok(soup.solid(&shells))
    }
}

/// Facets by the numbers of their corners, which are points that differ.
struct Soup {
    at: Vec<[f32; 3]>,
    facets: Vec<[u32; 3]>,
}

/// One use of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The lower vertex, then the higher.
    ends: [u32; 2],
    facet: usize,
    /// Whether the facet runs from the lower vertex to the higher.
    forward: bool,
}

impl Soup {
    fn weld(facets: impl IntoIterator<Item = [[f32; 3]; 3]>) -> Result<Self, FabricateError> {
        let mut known: FxHashMap<[u32; 3], u32> = FxHashMap::default();
        let mut soup = Self { at: Vec::new(), facets: Vec::new() };
        for corners in facets {
            if !corners.iter().flatten().all(|x| x.is_finite()) {
                let position_mm = DVec3::from_array(corners[0].map(f64::from));
                return Err(FabricateError::Facets {
                    position_mm,
                    found: "a coordinate is no finite number",
                });
            }
            let facet = corners.map(|p| {
                // Adding zero makes one number of both zeros.
                let p = p.map(|x| x + 0.0);
                *known.entry(p.map(f32::to_bits)).or_insert_with(|| {
                    soup.at.push(p);
                    soup.at.len() as u32 - 1
                })
            });
            let [a, b, c] = facet;
            if a != b && b != c && c != a {
                soup.facets.push(facet);
            }
        }
        Ok(soup)
    }

    fn point(&self, v: u32) -> DVec3 {
        DVec3::from_array(self.at[v as usize].map(f64::from))
    }

    fn points(&self, facet: usize) -> [DVec3; 3] {
        self.facets[facet].map(|v| self.point(v))
    }

    fn corner(&self, facet: usize, v: u32) -> usize {
        3 * facet + self.facets[facet].iter().position(|&w| w == v).expect("an edge ends in corners")
    }

    fn sides(&self) -> Vec<Side> {
        let of = |(facet, &[a, b, c]): (usize, &[u32; 3])| {
            [(a, b), (b, c), (c, a)].map(|(p, q)| Side { ends: [p.min(q), p.max(q)], facet, forward: p < q })
        };
        let mut sides: Vec<Side> = self.facets.iter().enumerate().flat_map(of).collect();
        sides.sort_unstable();
        sides
    }

    fn check_areas(&self) -> Result<(), FabricateError> {
        let is_flat = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a) == DVec3::ZERO;
        match (0..self.facets.len()).map(|facet| self.points(facet)).find(|&corners| is_flat(corners)) {
            Some([a, b, c]) => Err(FabricateError::Facets {
                position_mm: (a + b + c) / 3.0,
                found: "there is a facet without area, whose corners lie on a line",
            }),
            None => Ok(()),
        }
    }

    fn check_fans(&self, fans: &mut Sets) -> Result<(), FabricateError> {
        let mut fan_of = vec![usize::MAX; self.at.len()];
        for (corner, &v) in self.facets.as_flattened().iter().enumerate() {
            let fan = fans.find(corner);
            let known = &mut fan_of[v as usize];
            if *known != usize::MAX && *known != fan {
                let found = "surfaces touch in one point only";
                return Err(FabricateError::Facets { position_mm: self.point(v), found });
            }
            *known = fan;
        }
        Ok(())
    }

    /// The numbers of the facets of each shell.
    fn shells(&self, sets: &mut Sets) -> Vec<Vec<usize>> {
        let mut number = vec![usize::MAX; self.facets.len()];
        let mut shells: Vec<Vec<usize>> = Vec::new();
        for facet in 0..self.facets.len() {
            let root = sets.find(facet);
            if number[root] == usize::MAX {
                number[root] = shells.len();
                shells.push(Vec::new());
            }
            shells[number[root]].push(facet);
        }
        shells
    }

    /// That a shell that encloses a negative volume lies within the box of one that does not.
    fn check_inside_out(&self, shells: &[Vec<usize>]) -> Result<(), FabricateError> {
        let spans: Vec<Span> = shells.iter().map(|shell| self.span(shell)).collect();
        let is_cavity = |cavity: &Span| {
            let around =
                |s: &Span| s.volume > 0.0 && s.low.cmplt(cavity.low).all() && s.high.cmpgt(cavity.high).all();
            spans.iter().any(around)
        };
        match spans.iter().position(|span| span.volume <= 0.0 && !is_cavity(span)) {
            Some(i) => Err(FabricateError::Facets {
                position_mm: self.points(shells[i][0])[0],
                found: "a shell faces inwards and is no cavity of another",
            }),
            None => Ok(()),
        }
    }

    fn span(&self, shell: &[usize]) -> Span {
        // Volumes are taken from a point of the shell, as far-off coordinates would cancel badly.
        let origin = self.points(shell[0])[0];
        let empty = Span { volume: 0.0, low: origin, high: origin };
        shell.iter().fold(empty, |mut span, &facet| {
            let corners = self.points(facet);
            let [a, b, c] = corners.map(|p| p - origin);
            span.volume += a.dot(b.cross(c)) / 6.0;
            for p in corners {
                (span.low, span.high) = (span.low.min(p), span.high.max(p));
            }
            span
        })
    }

    fn solid(&self, shells: &[Vec<usize>]) -> Solid {
        let mut solid = Solid::with_capacity(self.at.len(), self.facets.len());
        let mut numbers = vec![u32::MAX; self.at.len()];
        for shell in shells {
            for &facet in shell {
                let corners = self.facets[facet].map(|v| {
                    let number = &mut numbers[v as usize];
                    if *number == u32::MAX {
                        *number = solid.add_vertices([self.at[v as usize]]);
                    }
                    *number
                });
                solid.add_triangles([corners]);
            }
            solid.end_shell();
        }
        solid
    }
}

/// The volume that a shell encloses, and the box around it.
struct Span {
    volume: f64,
    low: DVec3,
    high: DVec3,
}

#[cfg(test)]
mod tests {
    use super::super::solid::extrude;
    use super::super::solid::tests::{rectangles, region, shells_and_genus};
    use super::*;
    use proptest::prelude::*;

    fn found(facets: &[[[f32; 3]; 3]]) -> (&'static str, DVec3) {
        match Solid::from_facets(facets.iter().copied()) {
            Err(FabricateError::Facets { position_mm, found }) => (found, position_mm),
            other => panic!("{other:?}"),
        }
    }

    fn cube(x: f64, y: f64) -> Vec<[[f32; 3]; 3]> {
        extrude(&rectangles(&[(x, y, 2.0, 2.0)]), 2.0).unwrap().facets().collect()
    }

    #[test]
    fn faults_are_told_with_their_places() {
        let whole = cube(0.0, 0.0);
        let (what, at) = found(&whole[1..]);
        assert!(what.contains("only one facet") && at.abs().max_element() <= 2.0, "{what} {at}");
        let mut turned = whole.clone();
        turned[3].swap(0, 1);
        assert!(found(&turned).0.contains("same direction"));
        // Cubes that share an upright edge, and cubes that share a corner.
        let beside = [whole.clone(), cube(2.0, 2.0)].concat();
        assert_eq!(found(&beside), ("more than two facets share an edge", DVec3::new(2.0, 2.0, 1.0)));
        let above = cube(2.0, 2.0).into_iter().map(|facet| facet.map(|[x, y, z]| [x, y, z + 2.0]));
        let touching: Vec<_> = whole.iter().copied().chain(above).collect();
        assert_eq!(found(&touching), ("surfaces touch in one point only", DVec3::splat(2.0)));
        let inward: Vec<_> = whole.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert!(found(&inward).0.contains("faces inwards"));
        let mut odd = whole.clone();
        odd[0][1][2] = f32::NAN;
        assert!(found(&odd).0.contains("no finite number"));
        let line = [[[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]];
        assert!(found(&line).0.contains("without area"));
    }

    #[test]
    fn a_cavity_faces_inwards() {
        let inner = |[x, y, z]: [f32; 3]| [x / 2.0 + 0.5, y / 2.0 + 0.5, z / 2.0 + 0.5];
        let cavity = cube(0.0, 0.0).into_iter().map(|[a, b, c]| [a, c, b].map(inner));
        let hollow = Solid::from_facets(cube(0.0, 0.0).into_iter().chain(cavity)).unwrap();
        assert_eq!((hollow.shells().len(), hollow.volume_mm3()), (2, 7.0));
    }

    #[test]
    fn what_has_no_extent_is_left_out() {
        let mut facets = cube(0.0, 0.0);
        facets.push([[1.0; 3], [1.0; 3], [2.0; 3]]);
        facets.push([[-0.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        assert_eq!(Solid::from_facets(facets).unwrap().triangles().len(), 12);
        assert_eq!(Solid::from_facets([]).unwrap().shells().len(), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn solids_are_found_again(region in region(), turn in 0usize..1000) {
            prop_assume!(!region.is_empty());
            let Ok(solid) = extrude(&region, 2.0) else { return Ok(()) };
            let mut facets: Vec<_> = solid.facets().collect();
            let middle = turn % facets.len();
            facets.rotate_left(middle);
            let again = Solid::from_facets(facets).unwrap();
            prop_assert_eq!(shells_and_genus(&again), shells_and_genus(&solid));
            prop_assert_eq!(again.shells().len(), solid.shells().len());
            prop_assert_eq!(Solid::from_facets(solid.facets()).unwrap().facets().len(), solid.facets().len());
        }
    }
}
