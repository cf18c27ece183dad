//! Ranges of the exemplar that stay whole.
//!
//! A cut through the head of a flower makes two half heads, which the search then puts where it likes (DecoBrush
//! §7 asks for motifs that stay whole). A kept range forbids cuts strictly inside it; its ends may be cut.
//! Excluded: what follows from a range for the search, which only sees a wider piece.

use std::cmp::Ordering;

use super::cuts::SlicingError;
use crate::planar::Grid;

/// A range of the exemplar without a cut inside, in millimetres from the left edge of its ink, at the size that
/// the exemplar has in the job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptRange {
    /// Where it begins.
    pub from_mm: f64,
    /// Where it ends, to the right of where it begins.
    pub to_mm: f64,
}

/// How far a range may reach beyond the exemplar: positions are shown with two decimals, and the width that was
/// read there and typed again may be larger than the true one.
const SLACK_MM: f64 = 0.01;

/// Kept ranges on the grid: open intervals, ascending, apart from each other.
pub(super) struct Kept {
    ranges: Vec<(i64, i64)>,
}

impl Kept {
    /// Checks `ranges` against ink between `left_mm` and `right_mm`.
    pub(super) fn new(
        ranges: &[KeptRange],
        grid: Grid,
        (left_mm, right_mm): (f64, f64),
    ) -> Result<Self, SlicingError> {
        let width_mm = right_mm - left_mm;
        let mut sorted = Vec::with_capacity(ranges.len());
        for &KeptRange { from_mm, to_mm } in ranges {
            let fault = if from_mm.partial_cmp(&to_mm) != Some(Ordering::Less) {
                Some("ends before it begins; give the left end first")
            } else if from_mm < -SLACK_MM || to_mm > width_mm + SLACK_MM {
                Some(
                    "reaches beyond the exemplar; positions are those that analyze shows at the same --width",
                )
            } else {
                None
            };
            if let Some(fault) = fault {
                return Err(SlicingError::Kept { from_mm, to_mm, fault, width_mm });
            }
            sorted.push((grid.steps(left_mm + from_mm), grid.steps(left_mm + to_mm)));
        }
        sorted.sort_unstable();
        let mut ranges: Vec<(i64, i64)> = Vec::with_capacity(sorted.len());
        for (low, high) in sorted {
            match ranges.last_mut() {
                Some(last) if low < last.1 => last.1 = last.1.max(high),
                _ => ranges.push((low, high)),
            }
        }
        Ok(Self { ranges })
    }

    /// Whether a cut at `x` would divide a range.
    pub(super) fn forbids(&self, x: i64) -> bool {
        let next = self.ranges.partition_point(|&(_, high)| high <= x);
        self.ranges.get(next).is_some_and(|&(low, _)| low < x)
    }

    /// The parts of an interval that may be cut, ascending.
    pub(super) fn free_parts(&self, low: i64, high: i64) -> Vec<(i64, i64)> {
        let mut parts = Vec::new();
        let mut at = low;
        for &(from, to) in self.ranges.iter().filter(|&&(from, to)| to > low && from < high) {
            if from > at {
                parts.push((at, from));
            }
            at = at.max(to);
        }
        if at < high {
            parts.push((at, high));
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kept(ranges: &[(f64, f64)]) -> Result<Kept, SlicingError> {
        let ranges: Vec<KeptRange> =
            ranges.iter().map(|&(from_mm, to_mm)| KeptRange { from_mm, to_mm }).collect();
        Kept::new(&ranges, Grid::for_extent(100.0).unwrap(), (5.0, 65.0))
    }

    #[test]
    fn ranges_are_checked_against_the_exemplar() {
        let text = |ranges: &[(f64, f64)]| kept(ranges).err().unwrap().to_string();
        let said = text(&[(3.0, 5.0), (50.0, 61.0)]);
        assert!(said.contains("50.00mm..61.00mm") && said.contains("60.00 mm wide"), "{said}");
        assert!(text(&[(-1.0, 3.0)]).contains("reaches beyond"));
        assert!(text(&[(8.0, 8.0)]).contains("left end first"));
        assert!(text(&[(f64::NAN, 8.0)]).contains("left end first"));
        assert!(kept(&[(0.0, 60.005)]).is_ok(), "a width as analyze prints it");
    }

    proptest! {
        #[test]
        fn free_parts_are_what_is_not_forbidden(
            ranges in prop::collection::vec((0.0f64..50.0, 0.1f64..9.0), 0..6),
            low in 0.0f64..60.0,
            width in 1.0f64..20.0,
        ) {
            let ranges: Vec<_> = ranges.into_iter().map(|(from, width)| (from, from + width)).collect();
            let kept = kept(&ranges).unwrap();
            let grid = Grid::for_extent(100.0).unwrap();
            let (low, high) = (grid.steps(low), grid.steps(low + width));
            let parts = kept.free_parts(low, high);
            prop_assert!(parts.windows(2).all(|w| w[0].1 <= w[1].0));
            for k in 1..200 {
                let x = low + (high - low) * k / 200;
                let is_free = parts.iter().any(|&(from, to)| (from..=to).contains(&x));
                prop_assert_eq!(is_free, !kept.forbids(x));
            }
        }
    }
}
