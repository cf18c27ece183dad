//! A polyline of the plane, walked over the triangles that lie there, and brought back to the model.
//!
//! Each sample is strictly inside a triangle and no segment passes a vertex, by exact signs: what would is moved by
//! a few last bits, always the same way. So a segment leaves each triangle through one side, and there is nothing
//! to decide. Each crossing of an edge is a point of the curve on the model.

use glam::{DVec2, DVec3};

use super::disc::Disc;
use super::exact::turn;
use super::mean_value::Flat;
use super::mesh::Mesh;
use super::sides::{NONE, triangle_of};

/// How often a sample is moved before that is given up: each move is twice as far as the one before, and from 2⁻⁵⁰ on.
const MOVES: i32 = 24;

/// Where a walk ends that leaves the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    /// The last place on the model.
    pub(super) position: DVec3,
}

/// A walk over the triangles of a disc.
pub(super) struct Walk<'a> {
    mesh: &'a Mesh,
    disc: &'a Disc,
    flat: &'a Flat,
    /// The triangle where it is.
    triangle: usize,
    at: DVec2,
    /// The places so far, each with the outside there.
    places: Vec<(DVec3, DVec3)>,
}

/// How a segment from inside a triangle goes on.
enum Step {
    /// It ends strictly inside.
    Ends,
    /// It leaves through a side, this far along it.
    Leaves(u32, f64),
    /// It ends on a side, or passes a vertex.
    Touches,
}

impl<'a> Walk<'a> {
    /// Begins in a triangle of the disc, at the place with these weights of its corners, which are all positive.
    pub(super) fn new(
        mesh: &'a Mesh,
        disc: &'a Disc,
        flat: &'a Flat,
        triangle: usize,
        weights: [f64; 3],
    ) -> Self {
        let at = in_plane(disc, flat, triangle, weights);
        let mut walk = Self { mesh, disc, flat, triangle, at, places: Vec::new() };
        walk.mark();
        walk
    }

    /// Where it is in the plane.
    pub(super) fn at(&self) -> DVec2 {
        self.at
    }

    /// Goes straight on to `target`, or to a few last bits beside it unless that is `fixed`, which is then strictly
    /// inside a triangle.
    pub(super) fn go(&mut self, target: DVec2, fixed: bool) -> Result<(), Left> {
        if target == self.at {
            return Ok(());
        }
        for number in 0..MOVES {
            // Of a fixed target the way to it is bent instead.
            let bend = fixed.then(|| moved(self.at.midpoint(target), number));
            let target = if fixed || number == 0 { target } else { moved(target, number) };
            let stops: &[DVec2] = match (bend, number) {
                (Some(bend), 1..) => &[bend, target],
                _ => &[target],
            };
            let (triangle, at, marks) = (self.triangle, self.at, self.places.len());
            let mut arrived = true;
            for &stop in stops {
                arrived = arrived && self.segment(stop)?;
            }
            if arrived {
                return Ok(());
            }
            self.places.truncate(marks);
            (self.triangle, self.at) = (triangle, at);
        }
        // It runs along an edge whatever is done, which no walk over proper triangles does.
        Err(self.left())
    }

    /// One segment; whether it met neither vertex nor side but to cross it.
    fn segment(&mut self, target: DVec2) -> Result<bool, Left> {
        let mut entered = NONE;
        loop {
            match self.step(target, entered) {
                Step::Touches => return Ok(false),
                Step::Ends => {
                    self.at = target;
                    self.mark();
                    return Ok(true);
                }
                Step::Leaves(side, part) => {
                    let twin = self.disc.twins[side as usize];
                    self.places.push(self.mesh.place_on(self.on_model(side), part));
                    if twin == NONE || triangle_of(twin) >= self.disc.facets.len() {
                        return Err(self.left());
                    }
                    (self.triangle, entered) = (triangle_of(twin), twin);
                }
            }
        }
    }

    fn step(&self, target: DVec2, entered: u32) -> Step {
        let corners = self.corners(self.triangle);
        let beyond = [0, 1, 2].map(|i| turn(corners[i], corners[(i + 1) % 3], target));
        if beyond.iter().all(|&sign| sign > 0.0) {
            return Step::Ends;
        }
        for i in 0..3 {
            let side = (3 * self.triangle + i) as u32;
            if side == entered || beyond[i] > 0.0 {
                continue;
            }
            // It goes out between the ends of the side: the one on its right, the other on its left.
            let right = turn(self.at, target, corners[i]);
            let left = turn(self.at, target, corners[(i + 1) % 3]);
            if right < 0.0 && left > 0.0 {
                return match beyond[i] {
                    0.0 => Step::Touches,
                    _ => Step::Leaves(side, right / (right - left)),
                };
            }
        }
        Step::Touches
    }

    /// Marks where it is as a place of the curve.
    fn mark(&mut self) {
        let corners = self.corners(self.triangle);
        let area = |i: usize| turn(corners[(i + 1) % 3], corners[(i + 2) % 3], self.at).max(0.0);
        let areas = [area(0), area(1), area(2)];
        let sum: f64 = areas.iter().sum();
        let facet = self.disc.facets[self.triangle] as usize;
        self.places.push(self.mesh.place_in(facet, areas.map(|area| area / sum)));
    }

    /// The places, from the first on.
    pub(super) fn finished(self) -> Vec<(DVec3, DVec3)> {
        self.places
    }

    fn left(&self) -> Left {
        Left { position: self.places[self.places.len() - 1].0 }
    }

    fn corners(&self, triangle: usize) -> [DVec2; 3] {
        self.disc.triangles[triangle].map(|v| self.flat.places[v as usize])
    }

    /// The side of the model that is a side of the disc.
    fn on_model(&self, side: u32) -> u32 {
        3 * self.disc.facets[triangle_of(side)] + side % 3
    }
}

/// The place in the plane of weights of the corners of a triangle.
pub(super) fn in_plane(disc: &Disc, flat: &Flat, triangle: usize, weights: [f64; 3]) -> DVec2 {
    (0..3).map(|i| flat.places[disc.triangles[triangle][i] as usize] * weights[i]).sum()
}

/// A place by a few last bits beside another: in a new direction with each number, and twice as far.
fn moved(place: DVec2, number: i32) -> DVec2 {
    // Steps of a radian meet no direction twice.
    place + DVec2::from_angle(f64::from(number)) * (2f64.powi(number - 50) * place.abs().max_element())
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{clean, grid};
    use super::*;

    /// A plane sheet of 8 by 8 squares of 1 mm, laid flat as it is.
    fn sheet() -> (Mesh, Disc, Flat) {
        let mesh = clean(grid([8, 8], [false; 2], |p| (8.0 * p).extend(2.0)));
        let all: Vec<u32> = (0..mesh.vertices_mm().len() as u32).collect();
        let disc = Disc::around(&mesh, &all).unwrap();
        let places = disc.vertices.iter().map(|p| p.truncate()).collect();
        (mesh, disc, Flat { places })
    }

    #[test]
    fn a_walk_marks_every_edge() {
        let (mesh, disc, flat) = sheet();
        let mut walk = Walk::new(&mesh, &disc, &flat, 0, [0.4, 0.3, 0.3]);
        let start = walk.at();
        walk.go(start + DVec2::new(3.0, 0.001), false).unwrap();
        let places = walk.finished();
        // Three columns: in each an upright and a diagonal.
        assert_eq!(places.len(), 2 + 6);
        for (point, normal) in places {
            assert!((point.y - start.y).abs() < 0.0011 && point.z == 2.0 && normal == DVec3::Z);
        }
    }

    #[test]
    fn vertices_and_edges_are_passed_beside() {
        let (mesh, disc, flat) = sheet();
        // Along a row of vertices, up a column, and along diagonals; from a vertex, nearly.
        let mut walk = Walk::new(&mesh, &disc, &flat, 0, [1.0 - 2e-9, 1e-9, 1e-9]);
        let start = walk.at();
        for (x, y) in [(1.0, 1.0), (5.0, 1.0), (5.0, 7.0), (1.0, 3.0), (4.0, 6.0)] {
            walk.go(DVec2::new(x, y), false).unwrap();
            assert!(walk.at().distance(DVec2::new(x, y)) < 1e-8);
        }
        walk.go(start, true).unwrap();
        assert_eq!(walk.at(), start);
        let curve = super::super::curve::MeshCurve::cleaned(walk.finished(), true).unwrap();
        curve.check_on(&mesh);
    }

    #[test]
    fn leaving_is_told_with_the_place() {
        let (mesh, disc, flat) = sheet();
        let mut walk = Walk::new(&mesh, &disc, &flat, 0, [0.4, 0.3, 0.3]);
        let left = walk.go(DVec2::new(10.0, 4.0), false).unwrap_err();
        assert!((left.position.x - 8.0).abs() < 1e-9, "{left:?}");
    }
}
