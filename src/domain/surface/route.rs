//! Ways along the edges of a model, and what is near them.
//!
//! A* from each control point to the next, and Dijkstra's search from all that they pass. Ties go to the lower
//! vertex, so the way is always the same.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::closest::Place;
use super::error::SurfaceError;
use super::mesh::Mesh;

/// A way from place to place.
#[derive(Debug, Clone)]
pub(super) struct Route {
    /// The vertices it passes from each place to the next.
    pub(super) ways: Vec<Vec<u32>>,
    /// How long it is from each place to the next, in millimetres.
    pub(super) lengths: Vec<f64>,
}

impl Route {
    /// All vertices it passes, without those that come again at once.
    pub(super) fn vertices(&self) -> Vec<u32> {
        let mut vertices = self.ways.concat();
        vertices.dedup();
        vertices
    }

    /// How long it is in all, in millimetres.
    pub(super) fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }
}

/// A vertex that a search may go on from; the greatest is the one to take.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Open {
    /// How long the way is, at least.
    key: f64,
    vertex: u32,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.key.total_cmp(&self.key).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// What is known of the vertices in one search; the others are forgotten without being touched.
#[derive(Debug)]
struct Search {
    round: u32,
    seen: Vec<u32>,
    costs: Vec<f64>,
    before: Vec<u32>,
}

impl Search {
    fn cost(&self, vertex: u32) -> f64 {
        if self.seen[vertex as usize] == self.round { self.costs[vertex as usize] } else { f64::INFINITY }
    }

    fn improve(&mut self, vertex: u32, cost: f64, before: u32) -> bool {
        let is_better = cost < self.cost(vertex);
        if is_better {
            let i = vertex as usize;
            (self.seen[i], self.costs[i], self.before[i]) = (self.round, cost, before);
        }
        is_better
    }
}

impl Mesh {
    /// A short way along edges past all places, and back to the first if it is closed.
    ///
    /// # Errors
    /// [`SurfaceError::Parts`] where there is no way to the next.
    pub(super) fn route(&self, places: &[Place], is_closed: bool) -> Result<Route, SurfaceError> {
        let n = self.vertices_mm().len();
        let mut search = Search { round: 0, seen: vec![0; n], costs: vec![0.0; n], before: vec![0; n] };
        let mut route = Route { ways: Vec::new(), lengths: Vec::new() };
        for i in 0..places.len() - usize::from(!is_closed) {
            let (from, to) = (places[i], places[(i + 1) % places.len()]);
            let apart = || SurfaceError::Parts { number: i + 1, position: from.point };
            let (way, length) = self.way(&mut search, from, to).ok_or_else(apart)?;
            route.ways.push(way);
            route.lengths.push(length);
        }
        Ok(route)
    }

    /// The vertices of a shortest way from a corner of one triangle to a corner of another.
    fn way(&self, search: &mut Search, from: Place, to: Place) -> Option<(Vec<u32>, f64)> {
        if self.part_of(from.facet) != self.part_of(to.facet) {
            return None;
        }
        search.round += 1;
        let place = |v: u32| self.vertices_mm()[v as usize];
        let mut open = BinaryHeap::new();
        for &vertex in &self.triangles()[from.facet] {
            let cost = place(vertex).distance(from.point);
            search.improve(vertex, cost, vertex);
            open.push(Open { key: cost + place(vertex).distance(to.point), vertex });
        }
        let goal = self.triangles()[to.facet];
        while let Some(Open { key, vertex }) = open.pop() {
            let cost = search.cost(vertex);
            let left = |v: u32| place(v).distance(to.point);
            // It was found by a shorter way since.
            if key > cost + left(vertex) {
                continue;
            }
            if goal.contains(&vertex) {
                let mut way = vec![vertex];
                while search.before[way[way.len() - 1] as usize] != way[way.len() - 1] {
                    way.push(search.before[way[way.len() - 1] as usize]);
                }
                way.reverse();
                return Some((way, cost + left(vertex)));
            }
            for next in self.neighbours(vertex) {
                let cost = cost + place(vertex).distance(place(next));
                if search.improve(next, cost, vertex) {
                    open.push(Open { key: cost + left(next), vertex: next });
                }
            }
        }
        None
    }

    /// The vertices up to `reach_mm` along edges from any of `sources`, at most `most`, with how far they are, the
    /// nearest first.
    pub(super) fn within(&self, sources: &[u32], reach_mm: f64, most: usize) -> Vec<(u32, f64)> {
        let place = |v: u32| -> DVec3 { self.vertices_mm()[v as usize] };
        let mut costs = vec![f64::INFINITY; self.vertices_mm().len()];
        let mut is_done = vec![false; costs.len()];
        let mut open: BinaryHeap<Open> = BinaryHeap::new();
        for &vertex in sources {
            costs[vertex as usize] = 0.0;
            open.push(Open { key: 0.0, vertex });
        }
        let mut reached = Vec::new();
        while let Some(Open { key, vertex }) = open.pop() {
            if std::mem::replace(&mut is_done[vertex as usize], true) {
                continue;
            }
            // The sources are always among them.
            if key > 0.0 && reached.len() >= most {
                break;
            }
            reached.push((vertex, key));
            for next in self.neighbours(vertex) {
                let cost = key + place(vertex).distance(place(next));
                if cost < costs[next as usize] && cost <= reach_mm {
                    costs[next as usize] = cost;
                    open.push(Open { key: cost, vertex: next });
                }
            }
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_meshes::{ball, clean};
    use super::*;

    #[test]
    fn ways_are_short_and_hang_together() {
        let mesh = clean(ball(10, |p| 10.0 * p));
        let points = [DVec3::X, DVec3::Y, DVec3::NEG_X].map(|p| 10.0 * p);
        let places: Vec<Place> = mesh.nearest(&points, 1.0).into_iter().flatten().collect();
        let route = mesh.route(&places, false).unwrap();
        let vertices = route.vertices();
        for pair in vertices.windows(2) {
            assert!(mesh.neighbours(pair[0]).any(|v| v == pair[1]));
        }
        for length in &route.lengths {
            assert!((15.6..18.0).contains(length), "{length}");
        }
        let near = mesh.within(&vertices, 3.0, usize::MAX);
        assert!(near.windows(2).all(|pair| pair[0].1 <= pair[1].1) && near[near.len() - 1].1 <= 3.0);
        assert!(mesh.within(&vertices, 3.0, 5).len() >= vertices.len());
    }

    #[test]
    fn there_is_no_way_to_another_part() {
        let two = ball(3, |p| 10.0 * p).into_iter().chain(ball(3, |p| 10.0 * p + 30.0 * DVec3::X));
        let mesh = clean(two.collect());
        let points = [DVec3::new(10.0, 0.0, 0.0), DVec3::new(20.0, 0.0, 0.0)];
        let places: Vec<Place> = mesh.nearest(&points, 1.0).into_iter().flatten().collect();
        assert!(matches!(mesh.route(&places, false), Err(SurfaceError::Parts { number: 1, .. })));
    }
}
