//! Where cuts are wanted, and the places to try there.
//!
//! By events, one interval between each two neighbours, and several where no event is for long (Zhou 2014 §5.2);
//! uniformly, one around each of the equally spaced lines (§5.1). Kept ranges are taken out. Which of the places is
//! best is not decided here. All rules are the same from the left and from the right, so that the mirrored
//! exemplar is cut at the mirrored places.

use super::cuts::SlicingError;
use super::graph::ReebGraph;
use super::kept::Kept;
use super::persistence::persistence;
use crate::planar::Grid;

/// Places tried between two events. More find a slightly better cut; fewer miss the straight part of a curl.
const CANDIDATES: i64 = 24;
/// Where no event is for long, there is a cut for every such part of the exemplar's height. More, and
/// sequences of short equal pieces look mechanical; fewer, and strands without events cannot be cut to length.
const LONGEST_PIECE: f64 = 0.5;
/// Cuts that share an interval keep this part of their room clear at either end, so that they stay apart.
const CLEARANCE: f64 = 1.0 / 6.0;
/// Grid steps that an interval between events has at least: with fewer, every place in it may be a vertex.
const LEAST_STEPS: i64 = 8;

/// An open interval of x in which one cut is placed, with the places to try.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Interval {
    pub(super) low: i64,
    pub(super) high: i64,
    pub(super) tries: Vec<i64>,
}

impl Interval {
    /// An interval with places spread over its `room`.
    fn spread_over(low: i64, high: i64, room: &[(i64, i64)]) -> Self {
        let places = |&(from, to): &(i64, i64)| (1..CANDIDATES).map(move |k| part(from, to, k, CANDIDATES));
        Self { low, high, tries: room.iter().flat_map(places).collect() }
    }

    /// The interval without the kept ranges; `None` when nothing is left to try.
    pub(super) fn outside(&self, kept: &Kept) -> Option<Self> {
        if !self.tries.iter().any(|&x| kept.forbids(x)) {
            return Some(self.clone());
        }
        if let [line] = self.tries[..] {
            // A uniform line stays where it is, or goes.
            debug_assert!(kept.forbids(line));
            return None;
        }
        let (first, last) = (self.tries[0], self.tries[self.tries.len() - 1]);
        let free = kept.free_parts(first, last);
        (!free.is_empty()).then(|| Self::spread_over(self.low, self.high, &free))
    }
}

/// `k` of `n` equal parts of the way from `low` to `high`, rounded towards the nearer end.
fn part(low: i64, high: i64, k: i64, n: i64) -> i64 {
    let steps = |k: i64| (i128::from(high - low) * i128::from(k) / i128::from(n)) as i64;
    if 2 * k <= n { low + steps(k) } else { high - steps(n - k) }
}

/// One interval around each of `lines` equally spaced lines.
pub(super) fn uniform_intervals(lines: usize, left: i64, right: i64) -> Result<Vec<Interval>, SlicingError> {
    let n = i64::try_from(lines).unwrap_or(i64::MAX);
    if !(1..=10_000).contains(&n) {
        return Err(SlicingError::Parameter {
            name: "slicing uniform",
            value: n as f64,
            wanted: "from 1 to 10000 lines",
        });
    }
    let at = |k: i64| part(left, right, k, n + 1);
    let spacing = ((right - left) / (n + 1)).max(2);
    Ok((1..=n)
        .map(|k| Interval { low: at(k) - spacing / 2, high: at(k) + spacing / 2, tries: vec![at(k)] })
        .collect())
}

/// The intervals between events whose persistence and distance are at least `threshold`.
pub(super) fn event_intervals(reeb: &ReebGraph, threshold: i64, height_mm: f64, grid: Grid) -> Vec<Interval> {
    let longest = grid.steps(LONGEST_PIECE * height_mm).max(1);
    let spans = persistence(reeb);
    let mut xs: Vec<i64> = reeb
        .points()
        .zip(&spans)
        .filter(|(_, span)| span.is_none_or(|s| s >= threshold))
        .map(|((_, p), _)| p.at.x)
        .collect();
    xs.sort_unstable();
    let between = |pair: &[i64]| {
        let (low, high) = (pair[0], pair[1]);
        let cuts = ((high - low) / longest).max(1);
        (0..cuts).map(move |k| (part(low, high, k, cuts), part(low, high, k + 1, cuts), cuts > 1))
    };
    xs.windows(2)
        .filter(|pair| pair[1] - pair[0] >= threshold.max(LEAST_STEPS))
        .flat_map(between)
        .map(|(low, high, is_shared)| {
            let clear = if is_shared { ((high - low) as f64 * CLEARANCE) as i64 } else { 0 };
            Interval::spread_over(low, high, &[(low + clear, high - clear)])
        })
        .collect()
}
