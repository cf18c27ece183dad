//! Triangles made to agree: the same way round, with one fan at each vertex, and their outside out.

use glam::DVec3;

use super::error::SurfaceError;
use super::repair::{RepairKind, Repairs};
use super::sides::{NONE, from, next, previous, to, triangle_of};

/// Turns triangles so that neighbours agree, the lesser number in each part; gives the part of each triangle and the number of parts.
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

/// Turns closed parts with their inside out: those that no other part contains, with all that they contain. A hollow in a part stays
/// one. Parts with a border stay as they are.
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
        // Seen from inside, a closed part is all around: 4π.
        let contains = |other: &usize| {
            *other != part && !is_open[*other] && angles[*other].abs() > 2.0 * std::f64::consts::PI
        };
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
