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

/// Offsets say nothing of where the whole is, so that every sample is held where it is, by this part of the mean weight of an offset.
const HOLD: f64 = 0.05;

/// The positions that the matchings ask for, as moves from where samples are. What the maker gave does not move. Samples outside of the area
/// are drawn to its border as strongly as by all of their offsets together.
pub fn moves(graph: &Graph, source: &Source, matchings: &[Matching], area: &Area) -> Vec<DVec2> {
    let n = graph.samples.len();
    let inputs = &source.graph.samples;
    let mean = matchings.iter().map(|matching| matching.weight).sum::<f64>() / matchings.len().max(1) as f64;
    let mut weights = vec![HOLD * mean; n];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::area::tests::square;
    use crate::samples::sampling::curve_sample;

    fn graph(points: &[(f64, f64)]) -> Graph {
        let samples = points.iter().map(|&(x, y)| curve_sample(DVec2::new(x, y), 1.0)).collect();
        Graph { samples, ..Graph::default() }
    }

    /// Every sample is matched with the one of the same number.
    fn matchings(n: usize) -> Vec<Matching> {
        let pairs: Vec<_> = (0..n).map(|s| (s, Some(s))).collect();
        (0..n)
            .map(|middle| Matching { middle, weight: 1.0, pairs: pairs.clone(), missing: Vec::new() })
            .collect()
    }

    fn source(points: &[(f64, f64)]) -> Source {
        Source::new(graph(points), (DVec2::ZERO, DVec2::splat(50.0)), 20.0)
    }

    /// Eq. 14: offsets become the exemplar's, around the same middle.
    #[test]
    fn offsets_become_those_of_the_exemplar() {
        let source = source(&[(10.0, 10.0), (16.0, 10.0), (10.0, 13.0)]);
        let output = graph(&[(20.0, 20.0), (24.0, 22.0), (19.0, 25.0)]);
        let moves = moves(&output, &source, &matchings(3), &square(50.0));
        let at: Vec<DVec2> = output.samples.iter().zip(&moves).map(|(s, by)| s.at + *by).collect();
        assert!((at[1] - at[0]).distance(DVec2::new(6.0, 0.0)) < 0.1, "{at:?}");
        assert!((at[2] - at[0]).distance(DVec2::new(0.0, 3.0)) < 0.1, "{at:?}");
        assert!(moves.iter().copied().sum::<DVec2>().length() < 1e-9);
    }

    #[test]
    fn what_is_outside_goes_to_the_border_and_what_is_given_stays() {
        let source = source(&[(10.0, 10.0), (16.0, 10.0)]);
        let mut output = graph(&[(48.0, 20.0), (54.0, 20.0)]);
        let free = moves(&output, &source, &matchings(2), &square(50.0));
        assert!(free[1].x < -2.0 && (free[1].x - free[0].x).abs() < 2.0, "{free:?}");
        output.samples[0].is_given = true;
        assert_eq!(moves(&output, &source, &matchings(2), &square(50.0))[0], DVec2::ZERO);
    }
}
