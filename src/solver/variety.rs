//! The autocorrelation of a sequence, as a penalty on repetition (Zhou 2014 §3.7).
//!
//! A(η) = max over shifts j of Σ exp(−|η_i − η_{i+j}| / σ). The paper's maximum runs over j from 0, where the
//! sum is the length of the sequence whatever it is; j is meant to begin at 1, and does here.
//!
//! η are numbers of the exemplar's pieces. A piece that is shown left for right counts as the piece itself: the eye meets
//! the same motif again, and a mirrored run that goes back through the exemplar correlates with it like one that goes on.

use rustc_hash::FxHashMap;

use super::problem::Cost;

/// The paper's σ: pieces that are neighbours in the exemplar correlate by exp(−2).
const SIGMA: f64 = 0.5;

/// The weight β of the autocorrelation in the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variety {
    beta: f64,
    /// The exemplar's number of pieces, if mirrored ones come after them.
    originals: Option<usize>,
}

impl Variety {
    /// The cost for each unit of autocorrelation, among pieces none of which is mirrored.
    pub fn new(beta: f64) -> Self {
        Self { beta, originals: None }
    }

    /// The same where piece `originals` + i is piece i, mirrored.
    pub fn with_mirrored(self, originals: usize) -> Self {
        Self { originals: Some(originals), ..self }
    }

    /// η: the number of a piece in the exemplar, whichever way it is shown.
    pub(super) fn number(self, piece: usize) -> usize {
        self.originals.and_then(|originals| piece.checked_sub(originals)).unwrap_or(piece)
    }

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

/// The autocorrelation A of a whole sequence of numbers of the exemplar's pieces.
pub fn autocorrelation(sequence: &[usize]) -> f64 {
    let at = |shift: usize| -> f64 {
        sequence.iter().zip(&sequence[shift..]).map(|(&a, &b)| (-(a.abs_diff(b) as f64) / SIGMA).exp()).sum()
    };
    (1..sequence.len()).map(at).fold(0.0, f64::max)
}

/// The most pieces in a row that occur twice in a sequence without overlapping.
pub fn longest_repeat(sequence: &[usize]) -> usize {
    // What repeats at one length repeats at every shorter one.
    let (mut repeats, mut does_not) = (0, sequence.len() / 2 + 1);
    while does_not - repeats > 1 {
        let length = (repeats + does_not) / 2;
        if has_repeat(sequence, length) { repeats = length } else { does_not = length }
    }
    repeats
}

/// Whether two stretches of `length` pieces that do not overlap are equal: by a hash that rolls along, and a
/// comparison where it agrees.
fn has_repeat(sequence: &[usize], length: usize) -> bool {
    const BASE: u64 = 0x9e37_79b9_7f4a_7c15;
    let top = (1..length).fold(1u64, |power, _| power.wrapping_mul(BASE));
    let mut first: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
    let mut hash = 0u64;
    for (end, &piece) in sequence.iter().enumerate() {
        if end >= length {
            hash = hash.wrapping_sub((sequence[end - length] as u64 + 1).wrapping_mul(top));
        }
        hash = hash.wrapping_mul(BASE).wrapping_add(piece as u64 + 1);
        let Some(begin) = (end + 1).checked_sub(length) else { continue };
        let here = &sequence[begin..=end];
        let known = first.entry(hash).or_default();
        match known.iter().find(|&&k| &sequence[k..k + length] == here) {
            Some(&k) if k + length <= begin => return true,
            Some(_) => {}
            None => known.push(begin),
        }
    }
    false
}

/// How evenly the pieces of an exemplar of `pieces` are used: the entropy of their frequencies as a part of the
/// greatest there is. 1 uses all equally often, 0 only one.
pub fn evenness(sequence: &[usize], pieces: usize) -> f64 {
    if pieces < 2 || sequence.is_empty() {
        return 1.0;
    }
    let mut uses = vec![0u32; pieces];
    sequence.iter().for_each(|&p| uses[p] += 1);
    let n = sequence.len() as f64;
    let parts = uses.into_iter().filter(|&u| u > 0).map(|u| f64::from(u) / n);
    -parts.map(|p| p * p.ln()).sum::<f64>() / (pieces as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn repeats_and_uses_are_counted() {
        assert_eq!(longest_repeat(&[1, 2, 3, 1, 2, 3, 1]), 3);
        assert_eq!(longest_repeat(&[1, 1, 1, 1, 1]), 2);
        assert_eq!(longest_repeat(&[1, 2, 3, 4]), 0);
        assert_eq!(longest_repeat(&[]), 0);
        assert!((evenness(&[0, 1, 2, 3], 4) - 1.0).abs() < 1e-12);
        assert!((evenness(&[0, 1, 0, 1], 4) - 0.5).abs() < 1e-12);
        assert!(evenness(&[2, 2, 2], 4).abs() < 1e-12);
    }

    #[test]
    fn a_mirrored_piece_counts_as_the_piece() {
        let variety = Variety::new(1.0).with_mirrored(5);
        let numbers: Vec<usize> = [0, 1, 4, 9, 6, 5].map(|piece| variety.number(piece)).to_vec();
        assert_eq!(numbers, [0, 1, 4, 4, 1, 0]);
        assert_eq!(Variety::new(1.0).number(9), 9);
    }

    proptest! {
        #[test]
        fn the_longest_repeat_is_found(sequence in prop::collection::vec(0usize..3, 0..24)) {
            let n = sequence.len();
            let is_repeat = |a: usize, b: usize, l: usize| b + l <= n && sequence[a..a + l] == sequence[b..b + l];
            let all = (0..n).flat_map(|a| (1..=n).map(move |l| (a, l)));
            let found = all.filter(|&(a, l)| (a + l..n).any(|b| is_repeat(a, b, l))).map(|(_, l)| l).max();
            prop_assert_eq!(longest_repeat(&sequence), found.unwrap_or(0));
        }
    }

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
        assert_eq!(Variety::new(0.5).penalty(&[1.0, 6.0, 2.0]), 3_000_000);
    }
}
