//! Plates: the level facets of one height, where it is known without looking at pairs of them that none crosses another.
//!
//! The caps of a part are of many long thin facets, whose boxes meet by the hundred for each. But facets that are level,
//! equally high and all turned the same way lie over a point as often as their *border* winds round it: the sides that
//! only one of them has, while all others are of two, once in each direction. So a border is looked at instead. It has
//! to be of loops, one through a vertex, that do not meet, and that wind round no point more than once. Then facets
//! overlap nowhere, and neither can a corner rest on the side of another facet: inside of the plate there would be facets
//! on both sides of it, and on the border the corner would have a loop or facets all around. So they share corners,
//! sides, or nothing.
//!
//! A facet that comes to the height of a plate from above or below only, and in no more than a corner or a side that the
//! plate has too, shares that with facets of the plate and nothing else. That holds for all walls of a part, so that
//! in the end neither two facets of a cap nor a cap and a wall need be compared.
//!
//! Excluded: to say what crosses. A plate of which any of this does not hold is left to the search ([`super::crossings`]),
//! like all facets that are not level.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::boxes::{Box3, pairs_that_meet};
use super::crossings::{cross_flat, turn};
use super::shells::Side;

/// A height is looked at when so much of all facets is level there. More, and small caps go through the search; less, and
/// in a mesh of many heights each facet is held against many of them.
const PART: usize = 64;
/// Neither a vertex nor a plate.
const NONE: usize = usize::MAX;

/// The facets at one height.
struct Plate {
    height: f64,
    /// 1 when its facets are counter-clockwise seen from above, −1 when they are clockwise.
    turn: f64,
    facets: usize,
    low: DVec2,
    high: DVec2,
    /// The sides that only one of its facets has, in that facet's direction.
    border: Vec<[usize; 2]>,
    /// Nothing was found yet that speaks against it.
    is_sound: bool,
}

/// Whether each facet is part of a plate that no facet crosses or touches but in common corners and sides. `sides` are those
/// of all facets, by their ends.
pub(super) fn in_plates(at: &[DVec3], facets: &[[usize; 3]], sides: &[Side]) -> Vec<bool> {
    let mut plates = Plates::new(at, facets);
    plates.find_borders(sides);
    plates.look_around(sides);
    plates.look_at_borders();
    plates.plate_of.iter().map(|&plate| plate != NONE && plates.plates[plate].is_sound).collect()
}

/// All plates of a mesh.
struct Plates<'a> {
    at: &'a [DVec3],
    facets: &'a [[usize; 3]],
    plates: Vec<Plate>,
    /// The plate of each facet.
    plate_of: Vec<usize>,
}

impl<'a> Plates<'a> {
    fn new(at: &'a [DVec3], facets: &'a [[usize; 3]]) -> Self {
        let mut known: FxHashMap<u64, usize> = FxHashMap::default();
        let mut plates: Vec<Plate> = Vec::new();
        let mut plate_of = vec![NONE; facets.len()];
        for (facet, corners) in facets.iter().enumerate() {
            let [a, b, c] = corners.map(|v| at[v]);
            if a.z != b.z || b.z != c.z {
                continue;
            }
            let [a, b, c] = [a, b, c].map(DVec3::truncate);
            let turn = turn(a, b, c);
            if turn == 0.0 {
                continue;
            }
            let number = *known.entry(at[corners[0]].z.to_bits()).or_insert(plates.len());
            if number == plates.len() {
                plates.push(Plate {
                    height: at[corners[0]].z,
                    turn: turn.signum(),
                    facets: 0,
                    low: DVec2::INFINITY,
                    high: DVec2::NEG_INFINITY,
                    border: Vec::new(),
                    is_sound: true,
                });
            }
            let plate = &mut plates[number];
            plate_of[facet] = number;
            plate.facets += 1;
            plate.is_sound &= turn.signum() == plate.turn;
            for p in [a, b, c] {
                (plate.low, plate.high) = (plate.low.min(p), plate.high.max(p));
            }
        }
        plates.iter_mut().for_each(|plate| plate.is_sound &= plate.facets >= facets.len() / PART);
        Self { at, facets, plates, plate_of }
    }

    /// Parts the sides of plates into inner ones and their borders.
    fn find_borders(&mut self, sides: &[Side]) {
        for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
            // A side is at one height, so all of them are of one plate.
            let mut own = edge.iter().filter(|side| self.plate_of[side.facet] != NONE);
            let Some(first) = own.next() else { continue };
            let plate = &mut self.plates[self.plate_of[first.facet]];
            match (own.next(), own.next()) {
                (None, _) => plate.border.push(match (first.ends, first.forward) {
                    (ends, true) => ends,
                    ([a, b], false) => [b, a],
                }),
                (Some(second), None) => plate.is_sound &= first.forward != second.forward,
                _ => plate.is_sound = false,
            }
        }
    }

    /// Finds the plates that other facets come to in another way than with a corner or a side that both have.
    fn look_around(&mut self, sides: &[Side]) {
        let mut is_of_plate = vec![false; self.at.len()];
        let mut has_common_side = vec![false; self.facets.len()];
        for (corners, _) in self.facets.iter().zip(&self.plate_of).filter(|&(_, &plate)| plate != NONE) {
            corners.iter().for_each(|&v| is_of_plate[v] = true);
        }
        for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
            if edge.iter().any(|side| self.plate_of[side.facet] != NONE) {
                edge.iter().for_each(|side| has_common_side[side.facet] = true);
            }
        }
        let sound = self.plates.iter().enumerate().filter(|(_, plate)| plate.is_sound);
        let mut heights: Vec<(f64, usize)> = sound.map(|(number, plate)| (plate.height, number)).collect();
        heights.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (facet, corners) in self.facets.iter().enumerate() {
            let t = corners.map(|v| self.at[v]);
            let (low, high) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
            let first = heights.partition_point(|&(height, _)| height < low.z);
            for &(_, number) in heights[first..].iter().take_while(|&&(height, _)| height <= high.z) {
                let plate = &mut self.plates[number];
                let is_beside =
                    high.truncate().cmplt(plate.low).any() || low.truncate().cmpgt(plate.high).any();
                if self.plate_of[facet] == number || is_beside {
                    continue;
                }
                let is_on_one_side = low.z == plate.height || high.z == plate.height;
                let mut on = corners.iter().filter(|&&v| self.at[v].z == plate.height);
                plate.is_sound &= is_on_one_side
                    && match (on.next(), on.next(), on.next()) {
                        (Some(&v), None, _) => is_of_plate[v],
                        // It has no other side that is level.
                        (Some(_), Some(_), None) => has_common_side[facet],
                        _ => false,
                    };
            }
        }
    }

    /// Finds the plates whose borders meet themselves or wind round a point more than once.
    fn look_at_borders(&mut self) {
        let mut after = vec![NONE; self.at.len()];
        let mut border: Vec<([usize; 2], usize)> = Vec::new();
        for (number, plate) in self.plates.iter_mut().enumerate().filter(|(_, plate)| plate.is_sound) {
            for &[a, b] in &plate.border {
                // As many sides of a border lead to a vertex as lead away from it.
                plate.is_sound &= std::mem::replace(&mut after[a], b) == NONE;
                border.push(([a, b], number));
            }
        }
        let boxes: Vec<Box3> = border
            .iter()
            .map(|&(ends, _)| ends.map(|v| self.at[v]))
            .map(|[p, q]| (p.min(q), p.max(q)))
            .collect();
        pairs_that_meet(&boxes, |i, j| {
            let ((one, plate), (other, _)) = (border[i], border[j]);
            self.plates[plate].is_sound &= !meet(self.at, one, other);
        });
        for plate in self.plates.iter_mut().filter(|plate| plate.is_sound) {
            plate.is_sound = covers_once(self.at, plate, &mut after);
        }
    }
}

/// Whether two sides of a border have more in common than the vertex in which one follows the other. Exact.
fn meet(at: &[DVec3], [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
    let [p, q, r, s] = [a, b, c, d].map(|v| at[v].truncate());
    let is_back_on_itself = |p: DVec2, v: DVec2, q: DVec2| turn(p, v, q) == 0.0 && (p - v).dot(q - v) > 0.0;
    match (b == c, d == a) {
        (true, false) => is_back_on_itself(p, q, s),
        (false, true) => is_back_on_itself(q, p, r),
        _ => cross_flat(p, q, r, s),
    }
}

/// Whether the loops of a border, which do not meet, wind round each point once or not at all, and in the sense of the
/// plate's facets. The loops are taken out of `after`.
///
/// It is enough to look outside of each loop and inside, at its leftmost vertex: there is no part of the plane that is
/// beside no loop. How often the others wind round that vertex is the number of their sides below it that run to the
/// right, less those that run to the left.
fn covers_once(at: &[DVec3], plate: &Plate, after: &mut [usize]) -> bool {
    let flat = |v: usize| at[v].truncate();
    let is_left = |p: DVec2, q: DVec2| (p.x, p.y) < (q.x, q.y);
    let mut loops: Vec<(DVec2, f64)> = Vec::new();
    // From left to right, with the loop and whether it runs so.
    let mut edges: Vec<([DVec2; 2], usize, bool)> = Vec::with_capacity(plate.border.len());
    let mut corners: Vec<DVec2> = Vec::new();
    for &[start, _] in &plate.border {
        corners.clear();
        let mut v = start;
        while after[v] != NONE {
            corners.push(flat(v));
            v = std::mem::replace(&mut after[v], NONE);
        }
        let Some(leftmost) =
            (0..corners.len()).reduce(|i, j| if is_left(corners[j], corners[i]) { j } else { i })
        else {
            continue;
        };
        let n = corners.len();
        let [before, here, next] = [n - 1, 0, 1].map(|step| corners[(leftmost + step) % n]);
        for (i, &p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % n];
            if p.x != q.x {
                edges.push((if p.x < q.x { [p, q] } else { [q, p] }, loops.len(), p.x < q.x));
            }
        }
        loops.push((here, turn(before, here, next)));
    }
    edges.sort_unstable_by(|a, b| a.0[0].x.total_cmp(&b.0[0].x));
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_unstable_by(|&i, &j| loops[i].0.x.total_cmp(&loops[j].0.x));
    let mut coming = edges.iter().peekable();
    let mut around = Vec::new();
    order.into_iter().all(|number| {
        let (p, turned) = loops[number];
        while let Some(edge) = coming.next_if(|edge| edge.0[0].x <= p.x) {
            around.push(edge);
        }
        around.retain(|edge| edge.0[1].x > p.x);
        let below = around.iter().filter(|edge| edge.1 != number && turn(edge.0[0], edge.0[1], p) > 0.0);
        let winding: i64 = below.map(|edge| if edge.2 { 1 } else { -1 }).sum();
        // Outside of a loop that goes round ink there is none, and outside of one that goes round a hole there is.
        winding as f64 * plate.turn == if turned * plate.turn > 0.0 { 0.0 } else { 1.0 }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::crossings::crossings_of_pairs;
    use super::super::shells::sides;
    use super::*;

    /// For facets of these points, whether each is in a plate, and the facets that cross another.
    fn looked_at(points: &[[i32; 3]]) -> (Vec<bool>, Vec<usize>) {
        let mut at: Vec<DVec3> = Vec::new();
        let numbers: Vec<usize> = points
            .iter()
            .map(|&p| {
                let p = DVec3::from_array(p.map(f64::from));
                at.iter().position(|&q| q == p).unwrap_or_else(|| {
                    at.push(p);
                    at.len() - 1
                })
            })
            .collect();
        let facets: Vec<[usize; 3]> = numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let all: Vec<usize> = (0..facets.len()).collect();
        let crossing = crossings_of_pairs(&at, &facets, &all).into_iter().map(|(facet, _)| facet);
        (in_plates(&at, &facets, &sides(&facets)), crossing.collect())
    }

    /// Two facets for each square of side 2 with its lower left corner there, counter-clockwise.
    fn squares(corners: &[[i32; 2]]) -> Vec<[i32; 3]> {
        let square = |&[x, y]: &[i32; 2]| {
            [(0, 0), (2, 0), (2, 2), (0, 0), (2, 2), (0, 2)].map(|(dx, dy)| [x + dx, y + dy, 0])
        };
        corners.iter().flat_map(square).collect()
    }

    fn is_plate(points: &[[i32; 3]]) -> bool {
        looked_at(points).0.iter().any(|&is_in_plate| is_in_plate)
    }

    #[test]
    fn squares_with_a_hole_and_an_island_in_it_are_a_plate() {
        let ring = (0..5).flat_map(|x| (0..5).map(move |y| [2 * x, 2 * y]));
        let mut ring: Vec<[i32; 2]> =
            ring.filter(|p| p[0] == 0 || p[0] == 8 || p[1] == 0 || p[1] == 8).collect();
        assert!(looked_at(&squares(&ring)).0.iter().all(|&is_in_plate| is_in_plate));
        ring.extend([[4, 4], [20, 3]]);
        assert!(looked_at(&squares(&ring)).0.iter().all(|&is_in_plate| is_in_plate));
    }

    #[test]
    fn what_overlaps_or_touches_is_no_plate() {
        assert!(!is_plate(&squares(&[[0, 0], [1, 1]])), "crossing");
        assert!(!is_plate(&squares(&[[0, 0], [2, 1]])), "a corner on a side");
        let mut within = [[-9, -9, 0], [40, -9, 0], [-9, 40, 0]].to_vec();
        within.extend(squares(&[[0, 0]]));
        assert!(!is_plate(&within), "one over the other");
        let mut turned = squares(&[[0, 0], [8, 0]]);
        turned.swap(0, 1);
        assert!(!is_plate(&turned), "both ways round");
    }

    #[test]
    fn walls_that_stand_on_a_plate_leave_it_one() {
        let mut part = squares(&[[0, 0], [2, 0]]);
        part.extend([[4, 0, 0], [4, 2, 0], [4, 2, 5], [4, 2, 0], [9, 9, 7], [9, 8, 7]]);
        assert!(is_plate(&part));
        for through in [[[1, 1, 0], [1, 1, 5], [9, 9, 5]], [[0, 0, 0], [4, 2, 0], [9, 9, 7]]] {
            assert!(!is_plate(&[&part[..], &through].concat()), "{through:?}");
        }
        assert!(!is_plate(&[&part[..], &[[1, 1, -1], [1, 1, 1], [3, 1, 1]]].concat()), "right through");
    }

    proptest! {
        /// Against the search through pairs, with vertices of a grid that wander and facets that are not there.
        #[test]
        fn nothing_crosses_a_plate(
            shifts in prop::collection::vec((-3i32..4, -3i32..4), 25),
            left_out in prop::collection::vec(0usize..6, 32),
            wandering in 0usize..4,
            other in prop::option::of(prop::array::uniform3((-1i32..18, -1i32..18, -1i32..3))),
        ) {
            let vertex = |i: usize, j: usize| {
                let (x, y) = if (5 * i + j) % 4 <= wandering { shifts[5 * i + j] } else { (0, 0) };
                [4 * i as i32 + x, 4 * j as i32 + y, 0]
            };
            let mut points = Vec::new();
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                for (half, facet) in [[a, b, c], [a, c, d]].into_iter().enumerate() {
                    if left_out[8 * i + 2 * j + half] > 0 {
                        points.extend(facet);
                    }
                }
            }
            points.extend(other.into_iter().flatten().map(|(x, y, z)| [x, y, z]));
            let (plates, crossing) = looked_at(&points);
            for facet in crossing {
                prop_assert!(!plates[facet], "{facet} of {points:?}");
            }
        }
    }
}
