//! The count nearest to one that cannot be had.
//!
//! What the graph of connections allows is found first, in one pass for all counts, so that what is impossible is not
//! looked for. Of what is left, searches for ranges of counts go away from the request on both sides, the nearer side
//! first, until one finds a sequence; then they close in on it. All searches of a refusal share one `Effort`, so that
//! it comes soon however many there are: first each has little memory, then more. A count that is named has a
//! sequence; that there is none nearer is said only where every nearer one was refused by the graph or by a search.

use std::panic::resume_unwind;
use std::thread;

use super::coarse::ranges_or_bounds;
use super::connectivity::{Connectivity, Counts, NODE_LIMIT};
use super::counts::{Caps, CountSet, Ranges, counts, work};
use super::family::scopes;
use super::problem::{Problem, Solution, Unsolved};
use super::solve_with_effort;
use crate::topology::{Goal, Topology, Wanted};

/// A count that can be had instead of the one that was wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nearest {
    /// The count.
    pub count: u32,
    /// Whether every count nearer to the request was found to be impossible.
    pub is_proven: bool,
    /// Whether that is so only without the other number, where two are wanted.
    pub is_alone: bool,
}

/// The effort of all searches of a refusal together, in labels: about a third of a second.
const MOST_EFFORT: usize = 1_500_000;
/// That of a search that ends at once.
const LEAST_EFFORT: usize = 2_000;
/// Memory of a search, in bytes, in the first round and in the second.
const ROUND_BYTES: [usize; 2] = [2 << 20, 16 << 20];
/// Word operations of all passes over sets of counts together: less than a tenth of a second.
const MOST_WORK: usize = 60_000_000;
/// Memory that the passes are in proportion to, in bytes.
const PASS_BYTES: usize = 64 << 20;
/// Counts are told one by one up to so many more than are wanted.
const REACH: u32 = 127;
/// By so much ranges grow after one in which nothing is, and after one of which that was not found out.
const GROWTH: u32 = 2;
const LEAP: u32 = 32;

/// What the searches of a refusal may still take.
pub(super) struct Effort<'p> {
    problem: &'p Problem<'p>,
    left: usize,
}

impl<'p> Effort<'p> {
    /// All of it.
    pub(super) fn new(problem: &'p Problem<'p>) -> Self {
        Self { problem, left: MOST_EFFORT }
    }

    /// A search with all the memory that one may have.
    pub(super) fn solve(&mut self, goal: Goal) -> Result<Solution, Unsolved> {
        let [.., bytes] = ROUND_BYTES;
        self.search(goal, bytes)
    }

    /// Two searches at once, each with half of what is left.
    pub(super) fn solve_both(&mut self, one: Goal, other: Goal) -> [Result<Solution, Unsolved>; 2] {
        let problem = self.problem;
        let halves = [self.left / 2, self.left - self.left / 2].map(|left| Self { problem, left });
        let [(one, left), (other, also_left)] = thread::scope(|scope| {
            let [mut half, mut second] = halves;
            let other = scope.spawn(move || (second.solve(other), second.left));
            let one = (half.solve(one), half.left);
            [one, other.join().unwrap_or_else(|panic| resume_unwind(panic))]
        });
        self.left = left + also_left;
        [one, other]
    }

    fn search(&mut self, goal: Goal, memory_limit: usize) -> Result<Solution, Unsolved> {
        if self.left == 0 {
            return Err(Unsolved::TooLarge { labels: 0 });
        }
        let problem = Problem { memory_limit, effort_limit: self.left, ..self.problem.clone() };
        let (found, effort) = solve_with_effort(&problem, goal, &|| false);
        self.left = self.left.saturating_sub(effort.max(LEAST_EFFORT));
        found
    }
}

/// Which count is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    Components,
    Holes,
}

impl Count {
    /// `goal` with this count too.
    fn wanted(self, goal: Goal, wanted: Wanted) -> Goal {
        match self {
            Self::Components => Goal { components: Some(wanted), ..goal },
            Self::Holes => Goal { holes: Some(wanted), ..goal },
        }
    }

    fn of(self, topology: Topology) -> u32 {
        match self {
            Self::Components => topology.components,
            Self::Holes => topology.holes,
        }
    }

    fn ends(self, Ranges { least, most }: Ranges) -> (u32, u32) {
        match self {
            Self::Components => (least.components, most.components),
            Self::Holes => (least.holes, most.holes),
        }
    }
}

/// What is known of the runs of one scope: no count beyond `least` and `most`, and up to `cap` none that is not in
/// the set.
struct Known {
    least: u32,
    most: u32,
    told: Option<(u32, CountSet)>,
}

/// The counts that runs with the other numbers wanted may have, as far as the graphs of connections know.
struct Possible {
    count: Count,
    others: Goal,
    scopes: Vec<Known>,
}

impl Possible {
    fn new(problem: &Problem<'_>, others: Goal, wanted: Wanted, count: Count) -> Self {
        let problem = &Problem { memory_limit: PASS_BYTES, ..problem.clone() };
        let (mut nodes, mut most_work) = (NODE_LIMIT, MOST_WORK);
        let mut known = Vec::new();
        // Small graphs first, which leave more for the large ones: those of rings with few portals at their narrowest.
        let all = scopes(problem, others.closed_pattern);
        for (before, scope) in all.iter().enumerate().rev() {
            let left = before + 1;
            let graph = Connectivity::of_kinds(problem, others, scope, nodes / left);
            nodes -= graph.as_ref().map_or(nodes / left, Connectivity::len);
            let ends = ranges_or_bounds(problem, scope, graph.as_ref()).map(|ranges| count.ends(ranges));
            let Some((least, most)) = ends else { continue };
            let cap = most.min(wanted.most().saturating_add(REACH));
            let caps = match count {
                Count::Components => Caps { components: Some(cap), ..Caps::of(others) },
                Count::Holes => Caps { holes: Some(cap), ..Caps::of(others) },
            };
            let set = graph.and_then(|graph| {
                let set = counts(problem, &graph, caps, most_work / left)?;
                most_work -= work(problem, &graph, caps);
                Some(set)
            });
            known.push(Known { least, most, told: set.map(|set| (cap, set)) });
        }
        Self { count, others, scopes: known }
    }

    /// Whether a run may have this count.
    fn has(&self, n: u32) -> bool {
        let all = |wanted: Option<Wanted>| wanted.map_or(0..=0, |w| w.least()..=w.most());
        self.scopes.iter().any(|known| {
            (known.least..=known.most).contains(&n)
                && known.told.as_ref().filter(|&&(cap, _)| n <= cap).is_none_or(|(_, set)| match self.count {
                    Count::Components => {
                        all(self.others.holes).any(|holes| set.has(Counts { components: n, holes }))
                    }
                    Count::Holes => {
                        all(self.others.components).any(|components| set.has(Counts { components, holes: n }))
                    }
                })
        })
    }

    /// The count beyond which no run has any, upwards or downwards; `None` when there is no run.
    fn end(&self, is_above: bool) -> Option<u32> {
        match is_above {
            true => self.scopes.iter().map(|known| known.most).max(),
            false => self.scopes.iter().map(|known| known.least).min(),
        }
    }

    /// The first count from `n` on, upwards or downwards, that a run may have.
    fn first(&self, n: u32, is_above: bool) -> Option<u32> {
        let (least, most) = (self.end(false)?, self.end(true)?);
        match is_above {
            true => (n.max(least)..=most).find(|&n| self.has(n)),
            false => (least..=n.min(most)).rev().find(|&n| self.has(n)),
        }
    }
}

/// The counts on one side of the request.
struct Side {
    is_above: bool,
    /// The nearest that is neither refused nor passed over; `None` when none is left.
    near: Option<u32>,
    /// How many counts the next range has.
    length: u32,
    /// The nearest that was found.
    found: Option<u32>,
    /// The nearest that was passed over.
    open: Option<u32>,
}

impl Side {
    /// All counts from `next` away from the request.
    fn new(possible: &Possible, next: Option<u32>, is_above: bool) -> Self {
        let near = next.and_then(|next| possible.first(next, is_above));
        Self { is_above, near, length: 1, found: None, open: None }
    }

    /// The next count that may be had after `n`; none at or beyond what was found.
    fn after(&self, possible: &Possible, n: u32) -> Option<u32> {
        let next = if self.is_above { n.checked_add(1) } else { n.checked_sub(1) }?;
        self.before_found(possible.first(next, self.is_above)?)
    }

    fn before_found(&self, n: u32) -> Option<u32> {
        let is_nearer = self.found.is_none_or(|found| if self.is_above { n < found } else { n > found });
        is_nearer.then_some(n)
    }

    /// The next range to look into: from the nearest count on, and once something was found half of the way there.
    fn range(&self, possible: &Possible, near: u32) -> (u32, u32) {
        let end = possible.end(self.is_above).unwrap_or(near);
        let far = match (self.found, self.is_above) {
            (Some(found), true) => near.midpoint(found - 1),
            (Some(found), false) => near.midpoint(found + 1),
            (None, true) => near.saturating_add(self.length - 1).min(end),
            (None, false) => near.saturating_sub(self.length - 1).max(end),
        };
        (near, far)
    }

    /// Takes up what a search of the range came to.
    fn learn(&mut self, possible: &Possible, (near, far): (u32, u32), result: Result<u32, Unsolved>) {
        let growth = match result {
            Ok(n) => {
                self.found = Some(n);
                self.near = self.before_found(near);
                return;
            }
            Err(Unsolved::Infeasible) => GROWTH,
            Err(Unsolved::TooLarge { .. }) => {
                self.open = self.open.or(Some(near));
                LEAP
            }
        };
        self.length = self.length.saturating_mul(growth);
        self.near = self.after(possible, far);
    }

    /// Goes back to what was passed over.
    fn again(&mut self) {
        self.near = self.open.take().and_then(|n| self.before_found(n)).or(self.near);
        self.length = 1;
    }
}

/// The count nearest to `wanted` with which a sequence exists, where `others` is the goal without it; `None` when none
/// was found.
pub(super) fn nearest(
    effort: &mut Effort<'_>,
    others: Goal,
    wanted: Wanted,
    count: Count,
) -> Option<Nearest> {
    let problem = effort.problem;
    let possible = Possible::new(problem, others, wanted, count);
    let mut sides = [
        Side::new(&possible, wanted.least().checked_sub(1), false),
        Side::new(&possible, wanted.most().checked_add(1), true),
    ];
    // Of two that are as near, the lower.
    let rank = |n: u32| (wanted.distance(n), n);
    let best = |sides: &[Side; 2]| sides.iter().filter_map(|side| side.found).min_by_key(|&n| rank(n));
    let is_open = |sides: &[Side; 2]| {
        let limit = best(sides).map_or(u32::MAX, |n| wanted.distance(n));
        let open = sides.iter().flat_map(|side| [side.open, side.near]).flatten();
        open.into_iter().any(|n| wanted.distance(n) < limit)
    };
    let counted = |solution: Solution| {
        let pieces = solution.sequence.iter().map(|&piece| &problem.descriptors[piece]);
        count.of(problem.shape.topology(pieces).expect("a solution adds up"))
    };
    let [.., ample] = ROUND_BYTES;
    // What the first search has to leave for the others.
    let rest = effort.left / 3;
    let mut is_first = true;
    for bytes in ROUND_BYTES {
        while effort.left > 0 {
            let limit = best(&sides).map(rank);
            let due = |side: &&mut Side| side.near.is_some_and(|n| limit.is_none_or(|limit| rank(n) < limit));
            let side = sides.iter_mut().filter(due).min_by_key(|side| side.near.map(rank));
            let Some((side, near)) = side.and_then(|side| side.near.map(|near| (side, near))) else { break };
            let range = side.range(&possible, near);
            let (low, high) = (range.0.min(range.1), range.0.max(range.1));
            let range_wanted = Wanted::between(low, high).expect("the ends are in order");
            // The nearest of all that the graph allows can be had most often.
            let bytes = if is_first { ample } else { bytes };
            let result = effort.search(count.wanted(others, range_wanted), bytes).map(counted);
            if std::mem::take(&mut is_first) {
                effort.left = effort.left.max(rest);
            }
            side.learn(&possible, range, result);
        }
        if !is_open(&sides) {
            break;
        }
        sides.iter_mut().for_each(Side::again);
    }
    if best(&sides).is_none() {
        // Whatever the ornament has by itself is found at once, and more than nothing.
        effort.left = effort.left.max(1);
        let whole = effort.search(others, ample).ok().map(counted);
        return whole.map(|count| Nearest { count, is_proven: false, is_alone: false });
    }
    let is_proven = !is_open(&sides);
    best(&sides).map(|count| Nearest { count, is_proven, is_alone: false })
}
