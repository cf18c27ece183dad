//! Admissible estimates: the cheapest completion when something is ignored.

use super::connectivity::{Connectivity, Counts};
use super::problem::{Cost, Problem};
use crate::topology::{Descriptor, Goal};

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

/// For every length, node of a [`Connectivity`] graph and counts still to come, the least cost of completing
/// the run: exact but for drift, and for the first piece of a ring.
///
/// A topology far from the exemplar's own costs far more than the ornament without constraints, and then the
/// plain [`Bound`] lets A* look at nearly everything. This one is dear to make, and hardly anything is looked
/// at afterwards.
pub(super) struct TopologyBound {
    graph: Connectivity,
    reads: Reads,
    /// Components and holes that are wanted, as [`Reads::fold`] has them.
    wanted: (usize, usize),
    layers: usize,
    /// By length, node and counts; in 32 bits, as there are many.
    table: Vec<u32>,
}

/// What cannot be completed.
const DEAD: u32 = u32::MAX;
/// Dearer costs are cut off, which keeps them admissible: 2000 in the units of the problem.
const DEAREST: u32 = 2_000_000_000;
/// Entries of the table at which it is not made: 256 MB.
const CELL_LIMIT: usize = 64_000_000;
/// Additions at which it is not made: about a second.
const WORK_LIMIT: usize = 1_500_000_000;

impl TopologyBound {
    /// The estimate for `goal` on its graph; `None` when it would be too large.
    pub(super) fn new(problem: &Problem<'_>, goal: Goal, graph: &Connectivity) -> Option<Self> {
        let reads = Reads { components: goal.components.is_some(), holes: goal.holes.is_some() };
        let counts = Counts { components: goal.components.unwrap_or(0), holes: goal.holes.unwrap_or(0) };
        let wanted = reads.fold(counts);
        let layers = *problem.window.end() as usize + 1;
        let combinations = (wanted.0 + 1).saturating_mul(wanted.1 + 1);
        let cells = layers.saturating_mul(graph.len()).saturating_mul(combinations);
        let work = layers.saturating_mul(graph.joins()).saturating_mul(combinations);
        if cells > CELL_LIMIT || work > WORK_LIMIT {
            return None;
        }
        let table = vec![DEAD; cells];
        let mut bound = Self { graph: graph.clone(), reads, wanted, layers, table };
        for length in (0..layers).rev() {
            for node in 0..graph.len() {
                bound.fill(problem, length, node);
            }
        }
        Some(bound)
    }

    /// Computes the entries at one length and node from those at greater lengths.
    fn fill(&mut self, problem: &Problem<'_>, length: usize, node: usize) {
        let columns = self.wanted.1 + 1;
        let size = (self.wanted.0 + 1) * columns;
        let begin = (length * self.graph.len() + node) * size;
        let (known, longer_ones) = self.table.split_at_mut(begin + size);
        let here = &mut known[begin..];
        let stop = self.graph.ending(node).filter(|_| problem.window.contains(&(length as u32)));
        if let Some(stop) = stop {
            let (row, column) = self.reads.fold(stop.closes);
            if row <= self.wanted.0 && column <= self.wanted.1 {
                here[row * columns + column] = cut_off(stop.cost);
            }
        }
        for edge in self.graph.edges(node) {
            let longer = length + problem.widths[self.graph.piece(edge.to as usize)] as usize;
            if longer >= self.layers {
                continue;
            }
            let from = (longer * self.graph.len() + edge.to as usize) * size - begin - size;
            let rest = &longer_ones[from..from + size];
            let (rows, skip) = self.reads.fold(edge.closes);
            let cost = cut_off(edge.cost);
            for row in rows..=self.wanted.0 {
                let to = here[row * columns..].iter_mut().take(columns).skip(skip);
                let from = &rest[(row - rows) * columns..][..columns];
                for (to, &from) in to.zip(from) {
                    *to = (*to).min(if from == DEAD { DEAD } else { (from + cost).min(DEAREST) });
                }
            }
        }
    }

    /// Where to look for a run that ends with `piece`, is connected like this and has closed so much; `None`
    /// when it cannot be completed at any length.
    pub(super) fn column(&self, piece: usize, connections: &Descriptor, closed: Counts) -> Option<usize> {
        let node = self.graph.node(piece, connections)?;
        let closed = self.reads.fold(closed);
        let (row, column) = (self.wanted.0.checked_sub(closed.0)?, self.wanted.1.checked_sub(closed.1)?);
        Some((node * (self.wanted.0 + 1) + row) * (self.wanted.1 + 1) + column)
    }

    /// The estimate for a run of `length` bins at a [`Self::column`]; [`NEVER`] when it cannot be completed.
    pub(super) fn at(&self, length: u32, column: usize) -> Cost {
        let layer = self.table.len() / self.layers;
        match self.table.get(length as usize * layer + column) {
            None | Some(&DEAD) => NEVER,
            Some(&cost) => Cost::from(cost),
        }
    }
}

/// Which counts a goal reads.
#[derive(Clone, Copy)]
struct Reads {
    components: bool,
    holes: bool,
}

impl Reads {
    /// The counts that are read, 0 for the others; a single one comes second, where it lies densely.
    fn fold(self, counts: Counts) -> (usize, usize) {
        let (components, holes) = (counts.components as usize, counts.holes as usize);
        match (self.components, self.holes) {
            (true, true) => (components, holes),
            (true, false) => (0, components),
            (false, true) => (0, holes),
            (false, false) => (0, 0),
        }
    }
}

fn cut_off(cost: Cost) -> u32 {
    u32::try_from(cost).map_or(DEAREST, |cost| cost.min(DEAREST))
}
