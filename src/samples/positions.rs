//! Positions: the least squares of all offsets that matched neighbourhoods ask for (Tu 2020 §4.3.4, Eq. 13 and 14). The adapter to faer.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use glam::DVec2;
use rustc_hash::FxHashMap;

use super::area::Area;
use super::graph::Graph;
use super::similarity::Matching;
use super::source::Source;

/// Offsets say nothing of where the whole is, so that every sample is held where it is, by this part of the weight of one offset.
const HOLD: f64 = 0.05;

/// The positions that the matchings ask for, as moves from where samples are. What the maker gave does not move. Samples outside of the area
/// are drawn to its border as strongly as by all of their offsets together.
pub fn moves(graph: &Graph, source: &Source, matchings: &[Matching], area: &Area) -> Vec<DVec2> {
    let n = graph.samples.len();
    let inputs = &source.graph.samples;
    let mut weights = vec![HOLD; n];
    let mut right = vec![DVec2::ZERO; n];
    let mut between: FxHashMap<(usize, usize), f64> = FxHashMap::default();
    for (s, matching) in matchings.iter().enumerate() {
        for &(other, input) in &matching.pairs {
            let Some(input) = input.filter(|_| other != s) else { continue };
            // From s to the other, as in the exemplar; and by how much they differ from it.
            let wanted = inputs[input].at - inputs[matching.middle].at;
            let lack = wanted - area.way(graph.samples[s].at, graph.samples[other].at);
            let weight = matching.weight;
            weights[s] += weight;
            weights[other] += weight;
            right[s] -= lack * weight;
            right[other] += lack * weight;
            *between.entry((s.max(other), s.min(other))).or_default() -= weight;
        }
    }
    for (s, sample) in graph.samples.iter().enumerate() {
        if !area.contains(sample.at) {
            let weight = weights[s];
            weights[s] += weight;
            right[s] += (area.nearest(sample.at) - sample.at) * weight;
        }
    }
    let free: Vec<usize> = (0..n).filter(|&s| !graph.samples[s].is_given).collect();
    let mut place = vec![usize::MAX; n];
    free.iter().enumerate().for_each(|(k, &s)| place[s] = k);
    let mut entries: Vec<Triplet<usize, usize, f64>> =
        free.iter().enumerate().map(|(k, &s)| Triplet::new(k, k, weights[s])).collect();
    let mut pairs: Vec<_> = between.into_iter().collect();
    pairs.sort_unstable_by_key(|pair| pair.0);
    for ((a, b), weight) in pairs {
        let (a, b) = (place[a], place[b]);
        if a != usize::MAX && b != usize::MAX {
            entries.push(Triplet::new(a.max(b), a.min(b), weight));
        }
    }
    let m = free.len();
    let solved = || {
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(m, m, &entries).ok()?;
        let symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
        Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()
    };
    let mut moves = vec![DVec2::ZERO; n];
    // Held as it is, the matrix is positive definite; if floats say otherwise, nothing moves.
    let Some(llt) = (m > 0).then(solved).flatten() else { return moves };
    let mut rhs = Mat::<f64>::zeros(m, 2);
    for (k, &s) in free.iter().enumerate() {
        (rhs[(k, 0)], rhs[(k, 1)]) = (right[s].x, right[s].y);
    }
    llt.solve_in_place(&mut rhs);
    for (k, &s) in free.iter().enumerate() {
        moves[s] = DVec2::new(rhs[(k, 0)], rhs[(k, 1)]);
    }
    moves
}
