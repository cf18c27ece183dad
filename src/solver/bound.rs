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
        let widest = problem.widths.iter().copied().max().unwrap_or(0) as usize;
        // Rows beyond the longest length are never reached from, so that no step has to be checked.
        let mut table = vec![NEVER; (longest + widest + 1) * pieces];
        let rows: Vec<(usize, Vec<(usize, Cost)>)> = (0..pieces)
            .filter(|&piece| allowed[piece])
            .map(|piece| {
                let steps = problem.steps[piece].iter().filter(|s| allowed[s.to]);
                let ahead = |to: usize| problem.widths[to] as usize * pieces + to;
                (piece, steps.map(|s| (ahead(s.to), s.cost)).collect())
            })
            .collect();
        for length in (0..=longest).rev() {
            let may_stop = problem.window.contains(&(length as u32));
            let here = length * pieces;
            for (piece, steps) in &rows {
                let stopping = if may_stop { stop[*piece].unwrap_or(NEVER) } else { NEVER };
                let going_on = steps.iter().map(|&(ahead, cost)| table[here + ahead].saturating_add(cost));
                table[here + piece] = going_on.fold(stopping, Cost::min);
            }
        }
        Self { pieces, table }
    }

    /// The estimate for a run of `length` bins that ends with `piece`; [`NEVER`] when it cannot be completed.
    pub(super) fn at(&self, length: u32, piece: usize) -> Cost {
        self.table.get(length as usize * self.pieces + piece).copied().unwrap_or(NEVER)
    }
}
