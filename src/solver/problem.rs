//! What is asked of the solver, and what it answers.

use std::ops::RangeInclusive;

use thiserror::Error;

use super::variety::Variety;
use crate::topology::{Descriptor, Shape};

/// A cost in millionths, so that sums are exact and equal costs compare equal.
pub type Cost = u64;

/// A join of a piece to a successor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// The successor.
    pub to: usize,
    /// What the join costs.
    pub cost: Cost,
    /// By how much it raises the run, in units of drift.
    pub rise: i32,
}

/// A search problem in whole numbers.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// Whether the run has two ends or closes on itself.
    pub shape: Shape,
    /// The descriptor of each piece.
    pub descriptors: &'a [Descriptor],
    /// The width of each piece in bins, at least 1.
    pub widths: Vec<u32>,
    /// The joins that may follow each piece. Portal numbers match.
    pub steps: Vec<Vec<Step>>,
    /// What it costs an open run to begin with each piece; `None` where it cannot (portals on the left).
    pub begin: Vec<Option<Cost>>,
    /// What it costs an open run to end with each piece; `None` where it cannot (portals on the right).
    pub end: Vec<Option<Cost>>,
    /// The total widths that are accepted, in bins.
    pub window: RangeInclusive<u32>,
    /// The largest accumulated rise, up or down, at any piece (δ stays inside the band, Zhou 2014 §3.5).
    pub drift_limit: i32,
    /// The penalty on repetition, if wanted. It depends on the whole run, so the answer is then the best one
    /// among the runs that the search keeps, as in Zhou 2014 §3.7, and not proven optimal.
    pub variety: Option<Variety>,
    /// The memory that the search may take, in bytes. Beyond it, optimality is given up.
    pub memory_limit: usize,
    /// The work that the search for the optimum may be, in partial runs that are looked at. Beyond it, optimality is given
    /// up as well.
    pub effort_limit: usize,
}

/// A sequence that meets all constraints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Solution {
    /// The pieces in order.
    pub sequence: Vec<usize>,
    /// The cost of its joins (with the closing one for a ring), begin and end; without the variety term.
    pub cost: Cost,
    /// How much less a sequence that meets the constraints could cost at most; 0 when none does.
    pub gap: Cost,
    /// Labels that were made.
    pub labels: usize,
    /// States of the automaton that were met.
    pub states: usize,
}

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Unsolved {
    /// No sequence meets the constraints.
    #[error("no sequence of pieces meets the constraints")]
    Infeasible,
    /// The search passed a limit, of memory or of effort, without having found a sequence.
    #[error("the search was given up after {labels} partial runs")]
    TooLarge {
        /// Labels made until then.
        labels: usize,
    },
}

impl Problem<'_> {
    /// The number of pieces.
    pub fn pieces(&self) -> usize {
        self.widths.len()
    }

    /// `most` of something that grows with the memory a search takes, or less where little memory is allowed.
    pub(super) fn share(&self, most: usize) -> usize {
        /// Memory with which everything is made as large as is worth while.
        const AMPLE: usize = 256 << 20;
        (most as f64 * (self.memory_limit as f64 / AMPLE as f64).min(1.0)) as usize
    }

    /// The cost of a sequence by the problem's own tables; `None` if a join is not in them.
    pub fn cost_of(&self, sequence: &[usize]) -> Option<Cost> {
        let step = |a: usize, b: usize| self.steps[a].iter().find(|s| s.to == b).map(|s| s.cost);
        let (&first, &last) = (sequence.first()?, sequence.last()?);
        let ends = match self.shape {
            Shape::Open => self.begin[first]? + self.end[last]?,
            Shape::Ring => step(last, first)?,
        };
        sequence.windows(2).map(|w| step(w[0], w[1])).sum::<Option<Cost>>().map(|c| c + ends)
    }
}
