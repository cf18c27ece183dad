//! The admissible estimate: the cheapest completion when topology is ignored.

use super::problem::{Cost, Problem};

/// A cost that nothing reaches.
pub(super) const NEVER: Cost = Cost::MAX;

/// For every length and last piece, the least cost of completing the run, ignoring topology and drift. It
/// obeys the triangle inequality along every step, so labels are settled once.
pub(super) struct Bound {
    pieces: usize,
    /// By length, then piece.
    table: Vec<Cost>,
}

impl Bound {
    /// The estimate when a run that ends with piece p within the window may stop at cost `stop[p]`, and only
    /// the pieces of `allowed` may follow.
    pub(super) fn new(problem: &Problem<'_>, stop: &[Option<Cost>], allowed: &[bool]) -> Self {
        let pieces = problem.pieces();
        let longest = *problem.window.end() as usize;
        let mut table = vec![NEVER; (longest + 1) * pieces];
        for length in (0..=longest).rev() {
            let may_stop = problem.window.contains(&(length as u32));
            for piece in 0..pieces {
                if !allowed[piece] {
                    continue;
                }
                let mut best = if may_stop { stop[piece].unwrap_or(NEVER) } else { NEVER };
                for step in &problem.steps[piece] {
                    let longer = length + problem.widths[step.to] as usize;
                    if longer <= longest {
                        let rest = table[longer * pieces + step.to];
                        best = best.min(rest.saturating_add(step.cost));
                    }
                }
                table[length * pieces + piece] = best;
            }
        }
        Self { pieces, table }
    }

    /// The estimate for a run of `length` bins that ends with `piece`; [`NEVER`] when it cannot be completed.
    pub(super) fn at(&self, length: u32, piece: usize) -> Cost {
        self.table.get(length as usize * self.pieces + piece).copied().unwrap_or(NEVER)
    }
}
