//! The autocorrelation of a sequence, as a penalty on repetition (Zhou 2014 §3.7).
//!
//! A(η) = max over shifts j of Σ exp(−|η_i − η_{i+j}| / σ). The paper's maximum runs over j from 0, where the
//! sum is the length of the sequence whatever it is; j is meant to begin at 1, and does here.

use super::problem::Cost;

/// The paper's σ: pieces that are neighbours in the exemplar correlate by exp(−2).
const SIGMA: f64 = 0.5;

/// The weight β of the autocorrelation in the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variety {
    /// Cost for each unit of autocorrelation.
    pub beta: f64,
}

impl Variety {
    /// β·A for the correlations at each shift.
    pub(super) fn penalty(self, correlations: &[f32]) -> Cost {
        let most = correlations.iter().copied().fold(0.0f32, f32::max);
        (self.beta * f64::from(most) * 1e6).round() as Cost
    }
}

/// exp(−d/σ) for a distance d of piece numbers; beyond a few pieces it is nothing.
fn correlation(a: usize, b: usize) -> f32 {
    const FAR: usize = 8;
    let distance = a.abs_diff(b);
    // 1/σ is 2, and whole powers are several times faster than exp.
    if distance < FAR { std::f32::consts::E.powi(-2 * distance as i32) } else { 0.0 }
}

/// The correlations of a sequence at shifts 1, 2, ..., from those of the sequence without its last piece.
/// `back` gives the pieces before the last one, latest first.
pub(super) fn extend(before: &[f32], last: usize, back: impl Iterator<Item = usize>) -> Vec<f32> {
    let mut correlations = before.to_vec();
    for (shift, piece) in back.enumerate() {
        let term = correlation(piece, last);
        match correlations.get_mut(shift) {
            Some(sum) => *sum += term,
            None => correlations.push(term),
        }
    }
    correlations
}

/// The autocorrelation A of a whole sequence.
pub fn autocorrelation(sequence: &[usize]) -> f64 {
    let at = |shift: usize| -> f64 {
        sequence.iter().zip(&sequence[shift..]).map(|(&a, &b)| (-(a.abs_diff(b) as f64) / SIGMA).exp()).sum()
    };
    (1..sequence.len()).map(at).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetition_correlates_and_extending_agrees() {
        let cycle = [3, 4, 5, 3, 4, 5, 3, 4, 5];
        let natural = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        assert!((autocorrelation(&cycle) - 6.0).abs() < 1e-9, "a shift by three meets itself six times");
        assert!((autocorrelation(&natural) - 8.0 * (-2f64).exp()).abs() < 1e-9);
        let mut correlations = Vec::new();
        for i in 0..cycle.len() {
            correlations = extend(&correlations, cycle[i], cycle[..i].iter().rev().copied());
        }
        let most = correlations.iter().copied().fold(0.0f32, f32::max);
        assert!((f64::from(most) - autocorrelation(&cycle)).abs() < 1e-4);
        assert!(
            (0..8).all(|d| (f64::from(correlation(9, 9 + d)) - (-(d as f64) / SIGMA).exp()).abs() < 1e-7)
        );
        assert_eq!(Variety { beta: 0.5 }.penalty(&[1.0, 6.0, 2.0]), 3_000_000);
    }
}
