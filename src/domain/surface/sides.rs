//! The sides of triangles, and which two are one edge.
//!
//! Triangle t has the sides 3t, 3t + 1 and 3t + 2, each from one corner to the next. The side across an edge is
//! found by putting the sides of each vertex in a bucket and sorting there, which takes a tenth of a second for a
//! million triangles. Excluded: coordinates.

/// In place of a side or a vertex: none.
pub(super) const NONE: u32 = u32::MAX;

/// The triangle of a side.
pub(super) fn triangle_of(side: u32) -> usize {
    (side / 3) as usize
}

/// The side of the same triangle that comes after it.
pub(super) fn next(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}

/// The side of the same triangle that comes before it.
pub(super) fn previous(side: u32) -> u32 {
    if side.is_multiple_of(3) { side + 2 } else { side - 1 }
}

/// The vertex at which a side begins.
pub(super) fn from(triangles: &[[u32; 3]], side: u32) -> u32 {
    triangles[triangle_of(side)][(side % 3) as usize]
}

/// The vertex at which a side ends.
pub(super) fn to(triangles: &[[u32; 3]], side: u32) -> u32 {
    from(triangles, next(side))
}

/// Entries by their keys, which are less than `keys`: where each bucket begins, and what it holds in the order of
/// the entries.
pub(super) fn bucketed<T: Copy + Default>(
    keys: usize,
    entries: impl Iterator<Item = (u32, T)> + Clone,
) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0u32; keys + 1];
    for (key, _) in entries.clone() {
        starts[key as usize + 1] += 1;
    }
    for key in 0..keys {
        starts[key + 1] += starts[key];
    }
    let mut ends = starts.clone();
    let mut held = vec![T::default(); starts[keys] as usize];
    for (key, entry) in entries {
        let end = &mut ends[key as usize];
        held[*end as usize] = entry;
        *end += 1;
    }
    (starts, held)
}

/// An edge of three triangles or more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crowded {
    /// Its ends.
    pub(super) ends: [u32; 2],
    /// How many triangles it has.
    pub(super) triangles: usize,
    /// How many further edges there are like it.
    pub(super) more: usize,
}

/// For each side the one across its edge, whichever way that goes, or [`NONE`] at a border.
///
/// # Errors
/// The edge with the lowest vertices that has three triangles or more.
pub(super) fn twins(triangles: &[[u32; 3]], vertices: usize) -> Result<Vec<u32>, Crowded> {
    let sides = 0..3 * triangles.len() as u32;
    let keyed = sides.map(|side| {
        let (a, b) = (from(triangles, side), to(triangles, side));
        (a.min(b), (a.max(b), side))
    });
    let (starts, mut held) = bucketed(vertices, keyed);
    let mut twins = vec![NONE; 3 * triangles.len()];
    let mut crowded: Option<Crowded> = None;
    for low in 0..vertices {
        let bucket = &mut held[starts[low] as usize..starts[low + 1] as usize];
        bucket.sort_unstable();
        for edge in bucket.chunk_by(|a, b| a.0 == b.0) {
            match *edge {
                [_] => {}
                [(_, a), (_, b)] => (twins[a as usize], twins[b as usize]) = (b, a),
                _ => match &mut crowded {
                    Some(first) => first.more += 1,
                    None => {
                        let ends = [low as u32, edge[0].0];
                        crowded = Some(Crowded { ends, triangles: edge.len(), more: 0 });
                    }
                },
            }
        }
    }
    crowded.map_or(Ok(twins), Err)
}

/// The sides without a twin in loops, each in the direction of its sides, from its lowest side on; of triangles
/// that agree in their orientation and have one fan at each vertex.
pub(super) fn border_loops(triangles: &[[u32; 3]], twins: &[u32]) -> Vec<Vec<u32>> {
    let mut is_seen = vec![false; twins.len()];
    let mut loops = Vec::new();
    for first in (0..twins.len() as u32).filter(|&side| twins[side as usize] == NONE) {
        if is_seen[first as usize] {
            continue;
        }
        let mut border = Vec::new();
        let mut side = first;
        while !is_seen[side as usize] {
            is_seen[side as usize] = true;
            border.push(side);
            // Round the vertex where it ends, to the next side without a twin.
            side = next(side);
            while twins[side as usize] != NONE {
                side = next(twins[side as usize]);
            }
        }
        loops.push(border);
    }
    debug_assert!(loops.iter().all(|l| to(triangles, l[l.len() - 1]) == from(triangles, l[0])));
    loops
}

/// All sides that begin at the vertex where `first` begins, counter-clockwise; `first` must have no side clockwise
/// of it if the vertex is on a border.
pub(super) fn star(twins: &[u32], first: u32) -> impl Iterator<Item = u32> + '_ {
    let mut at = Some(first);
    std::iter::from_fn(move || {
        let side = at?;
        let next = twins[previous(side) as usize];
        at = (next != NONE && next != first).then_some(next);
        Some(side)
    })
}

/// For each vertex a side from which its [`star`] goes round it.
pub(super) fn outgoing(triangles: &[[u32; 3]], twins: &[u32], vertices: usize) -> Vec<u32> {
    let mut sides = vec![NONE; vertices];
    for side in 0..twins.len() as u32 {
        let at = &mut sides[from(triangles, side) as usize];
        if *at == NONE || twins[side as usize] == NONE {
            *at = side;
        }
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles side by side, and one more beyond.
    const STRIP: [[u32; 3]; 3] = [[0, 1, 2], [2, 1, 3], [2, 3, 4]];

    #[test]
    fn sides_find_what_is_across() {
        let twins = twins(&STRIP, 5).unwrap();
        assert_eq!(twins, [NONE, 3, NONE, 1, NONE, 6, 5, NONE, NONE]);
        assert_eq!(border_loops(&STRIP, &twins), [vec![0, 4, 7, 8, 2]]);
    }

    #[test]
    fn a_star_goes_round_its_vertex() {
        let twins = twins(&STRIP, 5).unwrap();
        let outgoing = outgoing(&STRIP, &twins, 5);
        let round = |v: usize| -> Vec<u32> { star(&twins, outgoing[v]).map(|s| to(&STRIP, s)).collect() };
        assert_eq!(round(2), [0, 1, 3]);
        assert_eq!(round(1), [3, 2]);
    }

    #[test]
    fn an_edge_of_three_is_told() {
        let fin = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert_eq!(twins(&fin, 5).unwrap_err(), Crowded { ends: [0, 1], triangles: 3, more: 0 });
    }
}
