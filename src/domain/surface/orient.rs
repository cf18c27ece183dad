//! Triangles made to agree: the same way round, with one fan at each vertex, and their outside out.

use std::f64::consts::TAU;

use glam::DVec3;

use super::error::SurfaceError;
use super::repair::{RepairKind, Repairs};
use super::sides::{NONE, from, next, previous, to, triangle_of};

/// Turns triangles so that neighbours agree, the lesser number in each part; gives the part of each triangle and
/// the number of parts.
pub(super) fn agree(
    vertices: &[DVec3],
    triangles: &mut [[u32; 3]],
    twins: &mut Vec<u32>,
    repairs: &mut Repairs,
) -> Result<(Vec<u32>, usize), SurfaceError> {
    let mut parts = vec![NONE; triangles.len()];
    let mut is_turned = vec![false; triangles.len()];
    let mut count = 0;
    for start in 0..triangles.len() {
        if parts[start] != NONE {
            continue;
        }
        parts[start] = count;
        let mut members = vec![start as u32];
        let mut done = 0;
        while let Some(&t) = members.get(done) {
            done += 1;
            for side in 3 * t..3 * t + 3 {
                let twin = twins[side as usize];
                if twin == NONE {
                    continue;
                }
                // Neighbours agree when their common edge has two directions.
                let agrees = from(triangles, side) != from(triangles, twin);
                let (other, wanted) = (triangle_of(twin), is_turned[t as usize] == agrees);
                if parts[other] == NONE {
                    parts[other] = count;
                    is_turned[other] = wanted;
                    members.push(other as u32);
                } else if is_turned[other] != wanted {
                    let position = vertices[from(triangles, side) as usize];
                    return Err(SurfaceError::OneSided { position });
                }
            }
        }
        let turned = members.iter().filter(|&&t| is_turned[t as usize]).count();
        if 2 * turned > members.len() {
            members.iter().for_each(|&t| is_turned[t as usize] ^= true);
        }
        count += 1;
    }
    let turned = || (0..triangles.len()).filter(|&t| is_turned[t]);
    turned().for_each(|t| repairs.add(RepairKind::Turned, vertices[triangles[t][0] as usize]));
    turn(triangles, twins, &is_turned);
    Ok((parts, count as usize))
}

/// Turns the triangles that `is_turned` names.
fn turn(triangles: &mut [[u32; 3]], twins: &mut Vec<u32>, is_turned: &[bool]) {
    if !is_turned.contains(&true) {
        return;
    }
    // Of (a, b, c) and (a, c, b), the first and the last side change places.
    let moved = |side: u32| match is_turned[triangle_of(side)] {
        true => side - side % 3 + (2 - side % 3),
        false => side,
    };
    let mut turned = vec![NONE; twins.len()];
    for side in 0..twins.len() as u32 {
        let twin = twins[side as usize];
        turned[moved(side) as usize] = if twin == NONE { NONE } else { moved(twin) };
    }
    *twins = turned;
    for (triangle, _) in triangles.iter_mut().zip(is_turned).filter(|(_, turned)| **turned) {
        triangle.swap(1, 2);
    }
}

/// Gives each fan of triangles around a vertex a vertex of its own.
pub(super) fn part_fans(
    vertices: &mut Vec<DVec3>,
    triangles: &mut [[u32; 3]],
    twins: &[u32],
    repairs: &mut Repairs,
) {
    // A side stands for the corner at which it begins.
    let mut is_seen = vec![false; twins.len()];
    let mut has_fan = vec![false; vertices.len()];
    let mut fan = Vec::new();
    for first in 0..twins.len() as u32 {
        if is_seen[first as usize] {
            continue;
        }
        fan.clear();
        let mut side = first;
        while side != NONE && !is_seen[side as usize] {
            is_seen[side as usize] = true;
            fan.push(side);
            side = twins[previous(side) as usize];
        }
        // It ended at a border: what is on the other side of the first.
        if side == NONE {
            let mut side = twins[first as usize];
            while side != NONE {
                is_seen[next(side) as usize] = true;
                fan.push(next(side));
                side = twins[next(side) as usize];
            }
        }
        let vertex = from(triangles, first) as usize;
        if std::mem::replace(&mut has_fan[vertex], true) {
            let position = vertices[vertex];
            repairs.add(RepairKind::Parted, position);
            vertices.push(position);
            has_fan.push(true);
            for &corner in &fan {
                triangles[triangle_of(corner)][(corner % 3) as usize] = vertices.len() as u32 - 1;
            }
        }
    }
}

/// Turns closed parts with their inside out: those that no other part contains, with all that they contain. A
/// hollow in a part stays one. Parts with a border stay as they are.
pub(super) fn outside_out(
    vertices: &[DVec3],
    triangles: &mut [[u32; 3]],
    twins: &mut Vec<u32>,
    (parts, count): (&[u32], usize),
    repairs: &mut Repairs,
) {
    let mut is_open = vec![false; count];
    let mut volumes = vec![0.0; count];
    let mut places = vec![DVec3::ZERO; count];
    for (t, &part) in parts.iter().enumerate() {
        let [a, b, c] = triangles[t].map(|v| vertices[v as usize]);
        volumes[part as usize] += a.dot(b.cross(c)) / 6.0;
        places[part as usize] = a;
        is_open[part as usize] |= (3 * t..3 * t + 3).any(|side| twins[side] == NONE);
    }
    // Without any that could be wrong or hide one that is, as nearly always, no part is looked for in another.
    if !(0..count).any(|part| !is_open[part] && volumes[part] < 0.0) {
        return;
    }
    let mut is_inverted = vec![false; count];
    for part in (0..count).filter(|&part| !is_open[part]) {
        let mut angles = vec![0.0; count];
        if count > 1 {
            for (t, &other) in parts.iter().enumerate() {
                let corners = triangles[t].map(|v| vertices[v as usize] - places[part]);
                angles[other as usize] += solid_angle(corners);
            }
        }
        // Seen from inside, a closed part is all around: 4π, and from outside 0.
        let contains = |other: &usize| *other != part && !is_open[*other] && angles[*other].abs() > TAU;
        let outermost =
            (0..count).filter(contains).max_by(|&a, &b| volumes[a].abs().total_cmp(&volumes[b].abs()));
        is_inverted[part] = volumes[outermost.unwrap_or(part)] < 0.0;
    }
    for part in (0..count).filter(|&part| is_inverted[part]) {
        repairs.add(RepairKind::InsideOut, places[part]);
    }
    let is_turned: Vec<bool> = parts.iter().map(|&part| is_inverted[part as usize]).collect();
    turn(triangles, twins, &is_turned);
}

/// The solid angle of a triangle seen from the origin, positive if it is clockwise (van Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

/// The twins of triangles that agree, where the other triangle is across the edge; checked in debug builds only.
pub(super) fn assert_agree(triangles: &[[u32; 3]], twins: &[u32]) {
    debug_assert!((0..twins.len() as u32).all(|side| {
        let twin = twins[side as usize];
        twin == NONE || from(triangles, side) == to(triangles, twin) && twins[twin as usize] == side
    }));
}

#[cfg(test)]
mod tests {
    use super::super::mesh::{Mesh, MeshPart};
    use super::super::repair::{MeshRepair, RepairKind};
    use super::super::sample_meshes::{Facet, ball, grid, torus, tube};
    use super::*;
    use proptest::prelude::*;

    fn reversed(facet: Facet) -> Facet {
        [facet[0], facet[2], facet[1]]
    }

    fn told(facets: Vec<Facet>) -> (Mesh, Vec<(RepairKind, usize)>) {
        let (mesh, repairs) = Mesh::new(facets).unwrap();
        (mesh, repairs.iter().map(|&MeshRepair { repair, count, .. }| (repair, count)).collect())
    }

    #[test]
    fn parts_that_touch_are_parted() {
        // Two pyramids, one upside down, whose tops are one place.
        let base = [[2.0f32, 0.0], [-1.0, 2.0], [-1.0, -2.0]];
        let pyramid = |z: f32| {
            let [a, b, c] = base.map(|[x, y]| [x, y, z]);
            let top = [0.0; 3];
            [[a, b, top], [b, c, top], [c, a, top], [c, b, a]]
        };
        let below = pyramid(4.0).map(reversed);
        let (mesh, repairs) = told([pyramid(-4.0), below].concat());
        assert_eq!(repairs, [(RepairKind::Parted, 1)]);
        assert_eq!((mesh.vertices_mm().len(), mesh.parts().len()), (8, 2));
        assert!(mesh.parts().iter().all(|part| part.genus == 0 && part.borders == 0));
    }

    #[test]
    fn an_inside_out_model_is_turned_with_its_hollow() {
        let hollow = |turn: bool| -> Vec<Facet> {
            let inner = ball(3, |p| 5.0 * p).into_iter().map(reversed);
            let all = ball(3, |p| 10.0 * p).into_iter().chain(inner);
            all.map(|facet| if turn { reversed(facet) } else { facet }).collect()
        };
        let (right, none) = told(hollow(false));
        let (turned, repairs) = told(hollow(true));
        assert!(none.is_empty() && repairs == [(RepairKind::InsideOut, 2)], "{none:?} {repairs:?}");
        assert!(right.volume_mm3() > 2500.0 && (turned.volume_mm3() - right.volume_mm3()).abs() < 1e-6);
        // One beside it that is inside out does not touch what is right.
        let beside = ball(2, |p| 4.0 * p + 30.0 * DVec3::X).into_iter().map(reversed);
        let (mesh, repairs) = told(hollow(false).into_iter().chain(beside).collect());
        assert_eq!(repairs, [(RepairKind::InsideOut, 1)]);
        assert!(mesh.volume_mm3() > right.volume_mm3());
    }

    #[test]
    fn a_moebius_band_has_no_outside() {
        let place = |u: f64, v: f64| {
            let ((s, c), (hs, hc)) = (u.sin_cos(), (0.5 * u).sin_cos());
            DVec3::new((20.0 + v * hc) * c, (20.0 + v * hc) * s, v * hs)
        };
        let n = 12u32;
        let corner = |i: u32, side: f64| {
            // After one turn, the edges have changed places.
            let side = if i == n { -side } else { side };
            place(TAU * f64::from(i % n) / f64::from(n), side).as_vec3().to_array()
        };
        let cells = (0..n).flat_map(|i| {
            let [a, b, c, d] = [corner(i, -4.0), corner(i + 1, -4.0), corner(i + 1, 4.0), corner(i, 4.0)];
            [[a, b, c], [a, c, d]]
        });
        let refused = Mesh::new(cells.collect::<Vec<Facet>>()).unwrap_err();
        assert!(matches!(refused, SurfaceError::OneSided { .. }), "{refused}");
    }

    #[test]
    fn what_hangs_together_is_counted() {
        let counted = |facets: Vec<Facet>| {
            let parts = told(facets).0.parts();
            parts.iter().map(|&MeshPart { borders, genus, .. }| (borders, genus)).collect::<Vec<_>>()
        };
        assert_eq!(counted(torus([20, 10], 20.0, 5.0)), [(0, 1)]);
        assert_eq!(counted(tube([20, 5], 20.0, |_| 5.0)), [(2, 0)]);
        assert_eq!(counted(torus([20, 10], 20.0, 5.0).split_off(2)), [(1, 1)]);
        let two = grid([2, 2], [false; 2], |p| p.extend(0.0)).into_iter().chain(ball(2, |p| p * 9.0));
        assert_eq!(counted(two.collect()), [(1, 0), (0, 0)]);
    }

    proptest! {
        #[test]
        fn facets_are_made_to_agree(flips in prop::collection::vec(prop::bool::weighted(0.2), 180)) {
            let facets = ball(3, |p| 10.0 * p);
            let mixed = facets.iter().zip(&flips).map(|(&f, &flip)| if flip { reversed(f) } else { f });
            let (mesh, repairs) = told(mixed.collect());
            let flipped = flips.iter().filter(|&&flip| flip).count();
            let wanted = if flipped > 0 { vec![(RepairKind::Turned, flipped)] } else { vec![] };
            prop_assert_eq!(repairs, wanted);
            prop_assert!(mesh.is_closed() && mesh.volume_mm3() > 3000.0);
        }
    }
}
