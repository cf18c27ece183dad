//! Zhou 2014 §3.6.2 and §3.6.3 as printed, to compare with.
//!
//! A table by number of pieces; in each row, the cheapest run for each last piece and descriptor, found by hash.
//! Every entry is joined to every piece that fits. Runs that exceed the wanted numbers of components or holes,
//! leave the band or pass the length are not grown, nor are those that have reached it. The answer is the
//! cheapest entry that has reached the length with the wanted topology. A ring is an entry whose last piece fits
//! its first one; its cycles are looked for in one table, not in one for each first piece.
//!
//! A cheaper run drives a dearer one of the same number of pieces from its entry whatever their lengths and
//! drifts are, so this is no exact search: what it finds can be dearer than the optimum, or nothing.

use openwork::solver::{Cost, Problem};
use openwork::topology::{Descriptor, Goal, Shape};
use rustc_hash::FxHashMap;

/// Entries at which it is given up.
const MOST_ENTRIES: usize = 30_000_000;

/// T[k, i, Υ].
struct Entry {
    piece: usize,
    topology: Descriptor,
    cost: Cost,
    length: u32,
    drift: i32,
    first: usize,
    /// The entry without the last piece, in the row before.
    parent: usize,
}

/// What the table held in the end.
pub struct Found {
    /// The cheapest run, and its cost.
    pub best: Option<(Vec<usize>, Cost)>,
    /// Entries that reached the length with the wanted topology ("correct paths" in Table 1).
    pub correct_paths: usize,
    /// Entries in all.
    pub entries: usize,
    /// Whether it was given up.
    pub is_cut_short: bool,
}

/// Fills the table and backtracks. With `counts_free_holes`, descriptors that differ in the number of holes alone
/// are different, as printed; without, only where the goal asks for holes.
pub fn solve(problem: &Problem<'_>, goal: Goal, counts_free_holes: bool) -> Found {
    let forget = |topology: Descriptor| match counts_free_holes || goal.holes.is_some() {
        true => topology,
        false => {
            let labels = |side: &[u16]| side.iter().map(|&l| u32::from(l)).collect::<Vec<_>>();
            let (left, right) = (labels(topology.left()), labels(topology.right()));
            let components = topology.closed() + topology.open();
            Descriptor::new(&left, &right, topology.closed(), i64::from(components))
        }
    };
    let mut rows: Vec<Vec<Entry>> = vec![Vec::new()];
    for piece in 0..problem.pieces() {
        let begin = match problem.shape {
            Shape::Open => problem.begin[piece],
            Shape::Ring => Some(0),
        };
        if let Some(cost) = begin {
            let topology = forget(problem.descriptors[piece].clone());
            let length = problem.widths[piece];
            rows[0].push(Entry { piece, topology, cost, length, drift: 0, first: piece, parent: usize::MAX });
        }
    }
    let mut best: Option<(Cost, usize, usize)> = None;
    let (mut correct_paths, mut entries) = (0, rows[0].len());
    let mut row = 0;
    while !rows[row].is_empty() && entries < MOST_ENTRIES {
        let mut next: Vec<Entry> = Vec::new();
        let mut places: FxHashMap<(usize, Descriptor), usize> = FxHashMap::default();
        for (at, entry) in rows[row].iter().enumerate() {
            if problem.window.contains(&entry.length) {
                if let Some(cost) = finished(problem, goal, entry) {
                    correct_paths += 1;
                    if best.is_none_or(|(known, ..)| cost < known) {
                        best = Some((cost, row, at));
                    }
                }
                continue;
            }
            for step in &problem.steps[entry.piece] {
                let length = entry.length + problem.widths[step.to];
                let drift = entry.drift + step.rise;
                if length > *problem.window.end() || drift.abs() > problem.drift_limit {
                    continue;
                }
                let Ok(topology) = entry.topology.join(&problem.descriptors[step.to]) else { continue };
                let topology = forget(topology);
                let components = topology.closed() + u32::from(topology.open() > 0);
                if goal.components.is_some_and(|wanted| components > wanted.most())
                    || goal.holes.is_some_and(|wanted| topology.holes() > wanted.most())
                {
                    continue;
                }
                let cost = entry.cost + step.cost;
                let (piece, first) = (step.to, entry.first);
                match places.entry((step.to, topology.clone())) {
                    std::collections::hash_map::Entry::Vacant(place) => {
                        place.insert(next.len());
                        next.push(Entry { piece, topology, cost, length, drift, first, parent: at });
                    }
                    std::collections::hash_map::Entry::Occupied(place) => {
                        let known = &mut next[*place.get()];
                        if cost < known.cost {
                            *known = Entry { piece, topology, cost, length, drift, first, parent: at };
                        }
                    }
                }
            }
        }
        entries += next.len();
        rows.push(next);
        row += 1;
    }
    let is_cut_short = entries >= MOST_ENTRIES;
    let best = best.map(|(cost, row, at)| (backtrack(&rows, row, at), cost));
    Found { best, correct_paths, entries, is_cut_short }
}

/// What a run that has reached the length costs in all; `None` if it is not complete or not as wanted.
fn finished(problem: &Problem<'_>, goal: Goal, entry: &Entry) -> Option<Cost> {
    let (topology, end) = match problem.shape {
        Shape::Open => (entry.topology.finished()?, problem.end[entry.piece]?),
        Shape::Ring => {
            let closing = problem.steps[entry.piece].iter().find(|s| s.to == entry.first)?;
            (entry.topology.close().ok()?, closing.cost)
        }
    };
    goal.admits(topology).then_some(entry.cost + end)
}

fn backtrack(rows: &[Vec<Entry>], row: usize, mut at: usize) -> Vec<usize> {
    let mut sequence = Vec::new();
    for row in rows[..=row].iter().rev() {
        sequence.push(row[at].piece);
        at = row[at].parent;
    }
    sequence.reverse();
    sequence
}
