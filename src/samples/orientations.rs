//! In which directions paths leave a sample: as many as the exemplar's samples have that were matched with it, and the means of theirs
//! (Tu 2020 §4.3.4, Eq. 6).

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::assignment::Assignment;
use super::draws::Draws;
use super::graph::{Graph, Kind};
use super::similarity::Matching;
use super::source::Source;

/// The least angle between two directions, in radians.
pub fn turn(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Which of `others` each of `directions` goes with, so that the sum of the angles between them is least (Eq. 6); `None` for those that
/// are too many.
pub fn matched(directions: &[f64], others: &[f64], problem: &mut Assignment) -> Vec<Option<usize>> {
    problem.clear(others.len());
    for &own in directions {
        others.iter().enumerate().for_each(|(column, &other)| problem.price(column, turn(own, other)));
        // Dearer than any match, so that as many as possible are matched.
        problem.end_row(100.0 * PI);
    }
    problem.solve();
    (0..directions.len()).map(|row| problem.column(row)).collect()
}

/// Votes for one direction, as unit vectors.
#[derive(Default, Clone)]
struct Votes {
    sum: DVec2,
    count: f64,
}

impl Votes {
    fn add(&mut self, direction: f64, weight: f64) {
        self.sum += DVec2::from_angle(direction) * weight;
        self.count += weight;
    }

    /// One less the length of the mean: 0 if all are the same.
    fn variance(&self) -> f64 {
        if self.count == 0.0 { 1.0 } else { 1.0 - self.sum.length() / self.count }
    }
}

/// Sets the directions of all samples of curves that the maker did not give, and the width of their pen.
pub fn turn_all(graph: &mut Graph, source: &Source, matchings: &[Matching], seed: u64, purpose: &[u64]) {
    let mut inputs: Vec<Vec<(usize, f64)>> = vec![Vec::new(); graph.samples.len()];
    for matching in matchings {
        for &(s, input) in &matching.pairs {
            inputs[s].extend(input.map(|input| (input, matching.weight)));
        }
    }
    let mut problem = Assignment::default();
    for (s, sample) in graph.samples.iter_mut().enumerate() {
        if sample.is_given || sample.kind != Kind::Curve || inputs[s].is_empty() {
            continue;
        }
        let mut votes = vec![Votes::default(); sample.orientations.len()];
        let mut spare: Vec<f64> = Vec::new();
        let (mut number, mut width_mm) = (0.0, 0.0);
        for &(input, weight) in &inputs[s] {
            let theirs = &source.graph.samples[input];
            number += weight * theirs.orientations.len() as f64;
            width_mm += weight * theirs.width_mm;
            let mut is_taken = vec![false; theirs.orientations.len()];
            for (own, other) in
                matched(&sample.orientations, &theirs.orientations, &mut problem).into_iter().enumerate()
            {
                if let Some(other) = other {
                    votes[own].add(theirs.orientations[other], weight);
                    is_taken[other] = true;
                }
            }
            spare.extend(theirs.orientations.iter().zip(is_taken).filter(|(_, t)| !t).map(|(o, _)| *o));
        }
        let count: f64 = inputs[s].iter().map(|(_, weight)| weight).sum();
        sample.width_mm = width_mm / count;
        let wanted = (number / count).round() as usize;
        let mut own: Vec<(f64, f64)> = sample
            .orientations
            .iter()
            .zip(&votes)
            .map(|(&old, votes)| {
                let is_sure = votes.sum.length_squared() > 1e-12;
                (if is_sure { votes.sum.to_angle().rem_euclid(TAU) } else { old }, votes.variance())
            })
            .collect();
        while own.len() > wanted {
            let worst =
                (0..own.len()).max_by(|&a, &b| own[a].1.total_cmp(&own[b].1)).expect("there is one more");
            own.remove(worst);
        }
        let mut purpose = purpose.to_vec();
        purpose.push(s as u64);
        let mut draws = Draws::new(seed, &purpose);
        let mut is_first = true;
        while own.len() < wanted && !spare.is_empty() {
            let pick = if is_first { median(&spare) } else { draws.below(spare.len()) };
            own.push((spare.swap_remove(pick), 0.0));
            is_first = false;
        }
        sample.orientations = own.into_iter().map(|(direction, _)| direction).collect();
    }
}

/// The direction from which the others differ least in sum: the median on a circle.
fn median(directions: &[f64]) -> usize {
    let spread = |i: usize| directions.iter().map(|&other| turn(directions[i], other)).sum::<f64>();
    let all = (0..directions.len()).map(|i| (spread(i), i));
    all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map_or(0, |(_, i)| i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_go_round() {
        assert!((turn(0.1, TAU - 0.1) - 0.2).abs() < 1e-12);
        assert!((turn(3.0, 0.0) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn directions_are_matched_with_the_nearest() {
        let mut problem = Assignment::default();
        let found = matched(&[0.0, 2.0, 4.0], &[4.1, 6.2], &mut problem);
        assert_eq!(found, [Some(1), None, Some(0)]);
    }

    /// As in Tu 2020 Figure 9: of the directions that are left over, the one in the middle comes in.
    #[test]
    fn the_median_of_directions_is_the_one_in_the_middle() {
        assert_eq!(median(&[0.1, 6.2, 6.0]), 1);
        assert_eq!(median(&[1.0, 1.5, 1.2]), 2);
    }
}
