//! Which lengths sequences have, and whether any of a length stays in the band: passes along the length that
//! ignore topology and carry sets as bits.

use std::collections::BTreeSet;

use super::family::families;
use super::graph::{Graph, of_pieces};
use super::problem::Problem;
use crate::topology::Shape;

/// The lengths up to `longest` of all sequences, whatever their topology and drift.
pub(super) fn lengths(problem: &Problem<'_>, longest: u32) -> BTreeSet<u32> {
    let pieces = problem.pieces();
    // Of each run, the pieces that it may have begun with; an open run's do not matter and are one.
    let first_of = |p: usize| if problem.shape == Shape::Ring { p } else { 0 };
    let words = first_of(pieces - 1) / 64 + 1;
    let bit = |first: usize| (first / 64, 1u64 << (first % 64));
    let mut stops = vec![0u64; pieces * words];
    for (piece, stops) in stops.chunks_exact_mut(words).enumerate() {
        match problem.shape {
            Shape::Open => stops[0] = u64::from(problem.end[piece].is_some()),
            Shape::Ring => problem.steps[piece].iter().for_each(|s| stops[bit(s.to).0] |= bit(s.to).1),
        }
    }
    let layer = pieces * words;
    // Only as many lengths as the widest piece has bins are open at a time.
    let layers = problem.widths.iter().max().map_or(1, |&w| w as usize).min(longest as usize) + 1;
    let mut firsts = vec![0u64; layers * layer];
    let place = |length: u32, piece: usize| length as usize % layers * layer + piece * words;
    let mut here = vec![0u64; words];
    let mut found = BTreeSet::new();
    for length in 1..=longest {
        for piece in 0..pieces {
            let at = place(length, piece);
            here.copy_from_slice(&firsts[at..at + words]);
            firsts[at..at + words].fill(0);
            let may_begin = problem.shape == Shape::Ring || problem.begin[piece].is_some();
            if may_begin && problem.widths[piece] == length {
                let (word, bit) = bit(first_of(piece));
                here[word] |= bit;
            }
            if here.iter().all(|&w| w == 0) {
                continue;
            }
            if here.iter().zip(&stops[piece * words..]).any(|(a, b)| a & b != 0) {
                found.insert(length);
            }
            for step in &problem.steps[piece] {
                let longer = length.saturating_add(problem.widths[step.to]);
                if longer <= longest {
                    let at = place(longer, step.to);
                    firsts[at..at + words].iter_mut().zip(&here).for_each(|(to, &from)| *to |= from);
                }
            }
        }
    }
    found
}

/// The widest band for which drifts are told apart, in units; beyond, the question is left open.
const WIDEST: i32 = 4096;

/// Whether some sequence of an accepted length stays in the band, whatever its topology; `None` when that was not
/// found out.
pub(super) fn stays_in_band(problem: &Problem<'_>) -> Option<bool> {
    let families = families(problem, false);
    let mut scopes = families.iter().flat_map(|family| &family.members).map(|member| &member.scope);
    let mut is_known = true;
    let found = scopes.any(|scope| {
        let starts = scope.starts.iter().map(|&(piece, _)| (piece, problem.widths[piece]));
        let found = has_level_run(problem, &of_pieces(problem, scope), starts);
        is_known &= found.is_some();
        found == Some(true)
    });
    (found || is_known).then_some(found)
}

/// Whether some run of `graph` of an accepted length, from `starts` (node and length), stays in the band; `None`
/// when that was not found out.
pub(super) fn has_level_run(
    problem: &Problem<'_>,
    graph: &Graph,
    starts: impl Iterator<Item = (usize, u32)>,
) -> Option<bool> {
    if problem.drift_limit > WIDEST {
        return None;
    }
    let (longest, n) = (*problem.window.end() as usize, graph.len());
    let limit = problem.drift_limit.max(0) as usize;
    let bits = 2 * limit + 1;
    let words = bits.div_ceil(64);
    // An odd number of bits never fills its last word.
    let last = !(u64::MAX << (bits % 64));
    let layers = problem.widths.iter().max().map_or(1, |&w| w as usize) + 1;
    let mut drifts = vec![0u64; layers * n * words];
    let place = |length: usize, node: usize| (length % layers * n + node) * words;
    for (node, length) in starts.filter(|&(_, length)| length as usize <= longest) {
        drifts[place(length as usize, node) + limit / 64] |= 1 << (limit % 64);
    }
    let mut here = vec![0u64; words];
    for length in 1..=longest {
        for node in 0..n {
            let met = &mut drifts[place(length, node)..][..words];
            if met.iter().all(|&w| w == 0) {
                continue;
            }
            if graph.stop(node).is_some() && problem.window.contains(&(length as u32)) {
                return Some(true);
            }
            here.copy_from_slice(met);
            met.fill(0);
            for edge in &graph.all_edges()[graph.edges_of(node)] {
                let longer = length + edge.width as usize;
                if longer <= longest {
                    let to = &mut drifts[place(longer, edge.to as usize)..][..words];
                    add_moved(to, &here, edge.rise);
                    to[words - 1] &= last;
                }
            }
        }
    }
    Some(false)
}

/// Adds to `set` what `other` holds, moved by `by`; what leaves at either end is lost.
fn add_moved(set: &mut [u64], other: &[u64], by: i32) {
    let (words, bits) = (by.unsigned_abs() as usize / 64, by.unsigned_abs() % 64);
    let word = |at: Option<usize>| at.and_then(|at| other.get(at)).copied().unwrap_or(0);
    for (w, to) in set.iter_mut().enumerate() {
        let (near, far) = match by >= 0 {
            true => (word(w.checked_sub(words)), word(w.checked_sub(words + 1))),
            false => (word(Some(w + words)), word(Some(w + words + 1))),
        };
        *to |= match (by >= 0, bits) {
            (_, 0) => near,
            (true, bits) => near << bits | far >> (64 - bits),
            (false, bits) => near >> bits | far << (64 - bits),
        };
    }
}
