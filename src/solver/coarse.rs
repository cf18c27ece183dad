//! Bounds on the counts of runs by their pieces alone, however their portals are connected.
//!
//! The Euler characteristic of a run is the sum over its pieces, less one for each portal that is glued, so it adds up
//! along a run as costs do. A component has a leftmost place, in a piece where it reaches no portal on the left, unless
//! it goes all the way round a ring; so components are at most as many as such places, and holes, which are components
//! less χ, are at most as many as strands merge. One pass over the pieces takes next to no time where the graph of
//! connections would be too large, and is not begun where it would take long all the same. Excluded: which strands are connected already, which [`super::counts`] knows.

use std::collections::BTreeMap;

use super::connectivity::{Connectivity, Counts, kinds};
use super::counts::{Ranges, is_soon_over, ranges};
use super::graph::Scope;
use super::problem::Problem;
use crate::topology::{Descriptor, Shape};

/// Sums along a run, of each of which the greatest is wanted: places where components begin; merges of strands; closed
/// components, taken off; χ, taken off; χ; holes of the pieces themselves, taken off.
type Sums = [i64; 6];

/// Bounds on the counts of the runs within `scope` in the window, which say nothing where the pass would take too long;
/// `None` when there is no run.
pub(super) fn bounds(problem: &Problem<'_>, scope: &Scope) -> Option<Ranges> {
    let gains: Vec<Sums> = problem.descriptors.iter().map(gain).collect();
    let kinds = kinds(problem, scope);
    let longest = *problem.window.end();
    let n = problem.pieces();
    let layers = problem.widths.iter().max().map_or(1, |&w| w as usize) + 1;
    let mut met: Vec<Option<Sums>> = vec![None; layers * n];
    let place = |length: u32, kind: usize| length as usize % layers * n + kind;
    for &(first, _) in scope.starts.iter().filter(|&&(first, _)| problem.widths[first] <= longest) {
        let mut sums = gains[first];
        if problem.shape == Shape::Ring {
            // What goes all the way round crosses the cut where the ring is opened.
            let around = problem.descriptors[first].left().len() as i64;
            (sums[0], sums[1]) = (sums[0] + around, sums[1] + around);
        }
        join(&mut met[place(problem.widths[first], kinds[first])], sums);
    }
    // Of pieces that are as wide and lead to the same, the most of each sum.
    let joins: Vec<Vec<(usize, u32, Sums)>> = (0..n)
        .map(|piece| {
            let mut joins: BTreeMap<(usize, u32), Option<Sums>> = BTreeMap::new();
            let steps = problem.steps[piece].iter().filter(|_| kinds[piece] == piece);
            for to in steps.map(|step| step.to).filter(|&to| scope.allowed[to]) {
                join(joins.entry((kinds[to], problem.widths[to])).or_default(), gains[to]);
            }
            joins.into_iter().filter_map(|((to, width), gain)| Some((to, width, gain?))).collect()
        })
        .collect();
    if !is_soon_over(problem, joins.iter().map(Vec::len).sum()) {
        return Some(Ranges::ALL);
    }
    let mut found = None;
    for length in 1..=longest {
        for kind in 0..n {
            let Some(sums) = met[place(length, kind)].take() else { continue };
            if scope.stop[kind].is_some() && problem.window.contains(&length) {
                join(&mut found, sums);
            }
            for &(to, width, gain) in joins[kind].iter().filter(|join| length + join.1 <= longest) {
                join(&mut met[place(length + width, to)], std::array::from_fn(|i| sums[i] + gain[i]));
            }
        }
    }
    let [begun, merged, closed, euler_below, euler, own] = found?;
    let count = |n: i64| u32::try_from(n.max(0)).unwrap_or(u32::MAX);
    Some(Ranges {
        // There are no fewer holes than none, and no fewer components.
        least: Counts { components: count((-closed).max(-euler_below)), holes: count((-own).max(-euler)) },
        most: Counts { components: count(begun), holes: count(merged) },
    })
}

/// The ranges that the graph of connections knows; without one, or where that would take too long, these bounds. `None`
/// when there is no run.
pub(super) fn ranges_or_bounds(
    problem: &Problem<'_>,
    scope: &Scope,
    graph: Option<&Connectivity>,
) -> Option<Ranges> {
    match graph.filter(|graph| is_soon_over(problem, graph.joins())) {
        Some(graph) => ranges(problem, graph),
        None => bounds(problem, scope),
    }
}

fn gain(piece: &Descriptor) -> Sums {
    let (left, closed) = (piece.left().len() as i64, i64::from(piece.closed()));
    let begun =
        (0..piece.open()).filter(|&class| piece.left().iter().all(|&l| u32::from(l) != class)).count();
    let begun = begun as i64 + closed;
    let euler = piece.euler() - left;
    [begun, begun - euler, -closed, -euler, euler, -i64::from(piece.holes())]
}

/// The greater of each.
fn join(known: &mut Option<Sums>, sums: Sums) {
    let known = known.get_or_insert(sums);
    known.iter_mut().zip(sums).for_each(|(known, sum)| *known = sum.max(*known));
}
