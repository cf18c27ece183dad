//! Which numbers of components and holes runs can have: one pass forward along the length.
//!
//! At every length and node of the [`Connectivity`] graph it carries the set of counts of all runs that end
//! there, as bits; a join shifts the set by what it closes. Only as many lengths as the widest piece has bins
//! are held at a time. As the graph knows no drift, the sets hold every count that can be had, and may hold
//! some that cannot.

use super::connectivity::{Begin, Connectivity, Counts};
use super::problem::Problem;
use crate::topology::{Goal, Wanted};

/// A set of counts: for each number of components, a set of numbers of holes. A number that is not read is 0.
pub(super) struct CountSet {
    frame: Frame,
    bits: Vec<u64>,
}

/// Which counts are read, and up to which.
#[derive(Debug, Clone, Copy)]
pub(super) struct Caps {
    /// The most components; `None` does not read them.
    pub(super) components: Option<u32>,
    /// The most holes; `None` does not read them.
    pub(super) holes: Option<u32>,
}

impl Caps {
    /// Up to the most that a goal allows.
    pub(super) fn of(goal: Goal) -> Self {
        Self { components: goal.components.map(Wanted::most), holes: goal.holes.map(Wanted::most) }
    }
}

/// How a set lies in memory: rows of bits.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    caps: Caps,
    rows: usize,
    words: usize,
}

/// Word operations at which a pass is not begun, with little memory and with much: up to about a second.
const WORK_LIMITS: [usize; 2] = [2_000_000, 1_000_000_000];
/// Joins at which a pass of ranges is not begun: up to about half a second.
const RANGES_WORK_LIMITS: [usize; 2] = [1_000_000, 100_000_000];

/// Word operations at which a pass is not begun. A search that may take little memory is one of many, and has no
/// more time for this.
pub(super) fn work_limit(problem: &Problem<'_>) -> usize {
    let [least, most] = WORK_LIMITS;
    problem.share(most).max(least)
}

/// The word operations that the pass for these caps takes.
pub(super) fn work(problem: &Problem<'_>, graph: &Connectivity, caps: Caps) -> usize {
    let frame = Frame::new(caps);
    let longest = *problem.window.end() as usize;
    // A set has to be made and read even where nothing is joined.
    let joins = graph.joins().max(graph.len());
    longest.saturating_mul(joins).saturating_mul(frame.rows).saturating_mul(frame.words)
}

/// The counts of all runs in the window; `None` when the pass would take more than `most` word operations.
pub(super) fn counts(
    problem: &Problem<'_>,
    graph: &Connectivity,
    caps: Caps,
    most: usize,
) -> Option<CountSet> {
    if work(problem, graph, caps) > most {
        return None;
    }
    let frame = Frame::new(caps);
    let longest = *problem.window.end() as usize;
    let size = frame.size();
    let n = graph.len();
    let layers = problem.widths.iter().max().map_or(1, |&w| w as usize) + 1;
    let mut sets = vec![0u64; layers * n * size];
    let mut is_met = vec![false; layers * n];
    let mut found = vec![0u64; size];
    for &Begin { node, width, closes } in graph.starts() {
        let place = width as usize % layers * n + node as usize;
        let mut one = vec![0u64; size];
        one[0] = 1;
        frame.add_shifted(&mut sets[place * size..][..size], &one, closes);
        is_met[place] = true;
    }
    let mut set = vec![0u64; size];
    for length in 1..=longest {
        for node in 0..n {
            let place = length % layers * n + node;
            if !std::mem::take(&mut is_met[place]) {
                continue;
            }
            let here = &mut sets[place * size..][..size];
            set.copy_from_slice(here);
            here.fill(0);
            if let Some(ending) = graph.ending(node).filter(|_| problem.window.contains(&(length as u32))) {
                frame.add_shifted(&mut found, &set, ending);
            }
            for edge in graph.edges(node) {
                let longer = length + edge.width as usize;
                if longer <= longest {
                    let place = longer % layers * n + edge.to as usize;
                    frame.add_shifted(&mut sets[place * size..][..size], &set, edge.closes);
                    is_met[place] = true;
                }
            }
        }
    }
    Some(CountSet { frame, bits: found })
}

/// Whether a pass for ranges over a graph with so many joins is worth its time.
pub(super) fn is_soon_over(problem: &Problem<'_>, joins: usize) -> bool {
    let [least, most] = RANGES_WORK_LIMITS;
    let longest = *problem.window.end() as usize;
    longest.saturating_mul(joins) <= problem.share(most).max(least)
}

/// From the fewest to the most components and holes of the runs in the window; `None` when there is no run. Both
/// ends of a range can be had, each by itself and as far as the graph knows.
pub(super) fn ranges(problem: &Problem<'_>, graph: &Connectivity) -> Option<Ranges> {
    let longest = *problem.window.end() as usize;
    let n = graph.len();
    let layers = problem.widths.iter().max().map_or(1, |&w| w as usize) + 1;
    let mut met: Vec<Option<Ranges>> = vec![None; layers * n];
    for &Begin { node, width, closes } in graph.starts() {
        Ranges::EMPTY.plus(closes).join(&mut met[width as usize % layers * n + node as usize]);
    }
    let mut found = None;
    for length in 1..=longest {
        for node in 0..n {
            let Some(here) = met[length % layers * n + node].take() else { continue };
            if let Some(ending) = graph.ending(node).filter(|_| problem.window.contains(&(length as u32))) {
                here.plus(ending).join(&mut found);
            }
            for edge in graph.edges(node) {
                let longer = length + edge.width as usize;
                if longer <= longest {
                    here.plus(edge.closes).join(&mut met[longer % layers * n + edge.to as usize]);
                }
            }
        }
    }
    found
}

/// Least and greatest counts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges {
    pub(super) least: Counts,
    pub(super) most: Counts,
}

impl Ranges {
    /// Of runs of which nothing is known.
    pub(super) const ALL: Self = Self {
        least: Counts { components: 0, holes: 0 },
        most: Counts { components: u32::MAX, holes: u32::MAX },
    };

    const EMPTY: Self =
        Self { least: Counts { components: 0, holes: 0 }, most: Counts { components: 0, holes: 0 } };

    fn plus(self, closes: Counts) -> Self {
        Self { least: self.least.plus(closes), most: self.most.plus(closes) }
    }

    /// Widens `other` to hold this.
    fn join(self, other: &mut Option<Self>) {
        let known = other.get_or_insert(self);
        known.least.components = known.least.components.min(self.least.components);
        known.least.holes = known.least.holes.min(self.least.holes);
        known.most.components = known.most.components.max(self.most.components);
        known.most.holes = known.most.holes.max(self.most.holes);
    }
}

impl CountSet {
    /// Whether a run can have these counts; one that is not read is left out.
    pub(super) fn has(&self, counts: Counts) -> bool {
        self.frame.holds(&self.bits, counts)
    }
}

impl Frame {
    pub(super) fn new(caps: Caps) -> Self {
        // One count alone lies along the bits.
        let (rows, bits) = match (caps.components, caps.holes) {
            (Some(components), Some(holes)) => (components as usize + 1, holes as usize + 1),
            (Some(count), None) | (None, Some(count)) => (1, count as usize + 1),
            (None, None) => (1, 1),
        };
        Self { caps, rows, words: bits.div_ceil(64) }
    }

    /// How many words a set has.
    pub(super) fn size(&self) -> usize {
        self.rows * self.words
    }

    /// Whether a set holds these counts; one that is not read is left out.
    pub(super) fn holds(&self, set: &[u64], counts: Counts) -> bool {
        self.place(counts).is_some_and(|(row, bit)| set[row * self.words + bit / 64] & (1 << (bit % 64)) != 0)
    }

    /// The row and the bit of these counts; `None` beyond the caps.
    fn place(&self, counts: Counts) -> Option<(usize, usize)> {
        let Caps { components, holes } = self.caps;
        let fits = components.is_none_or(|cap| counts.components <= cap)
            && holes.is_none_or(|cap| counts.holes <= cap);
        let (components, holes) =
            (components.map(|_| counts.components as usize), holes.map(|_| counts.holes as usize));
        fits.then(|| match (components, holes) {
            (Some(components), Some(holes)) => (components, holes),
            (one, other) => (0, one.or(other).unwrap_or(0)),
        })
    }

    /// Adds to `set` what `other` holds, with so much more closed. What lies beyond the caps may be lost.
    pub(super) fn add_shifted(&self, set: &mut [u64], other: &[u64], closes: Counts) {
        let Some((rows, bits)) = self.place(closes) else { return };
        let (words, bits) = (bits / 64, bits % 64);
        for row in rows..self.rows {
            let from = &other[(row - rows) * self.words..][..self.words - words];
            let to = &mut set[row * self.words..][words..self.words];
            if bits == 0 {
                to.iter_mut().zip(from).for_each(|(to, &from)| *to |= from);
                continue;
            }
            let mut carried = 0;
            for (to, &from) in to.iter_mut().zip(from) {
                *to |= from << bits | carried;
                carried = from >> (64 - bits);
            }
        }
    }
}
