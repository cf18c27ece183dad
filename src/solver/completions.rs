//! Which counts a run may still come to: one pass backwards along the length.
//!
//! For every length and node of the [`Connectivity`] graph there is the set of counts that going on from there and
//! stopping in the window can close. A run of which none of them makes up what is wanted comes to nothing, however
//! promising it looks: a beam that keeps such runs has nothing left at the end. The sets of all lengths are kept, so
//! they are made for what is searched in earnest only. Excluded: the drift, and in a ring the piece that it began with.

use rustc_hash::FxHashMap;

use super::connectivity::{Connectivity, Counts};
use super::counts::{Caps, Frame};
use super::graph::Scope;
use super::problem::Problem;
use crate::topology::{Automaton, Goal, StateId, Wanted};

/// Nodes of a graph at which it is given up.
const NODE_LIMIT: usize = 60_000;
/// Word operations beyond which a pass is not begun: a few seconds.
const MOST_WORK: usize = 4_000_000_000;
/// The memory that the sets of all scopes may take, in bytes.
const MOST_BYTES: usize = 512 << 20;

/// The counts that can be closed on the way to an end.
pub(super) struct Completions {
    goal: Goal,
    graph: Connectivity,
    frame: Frame,
    /// By length, node and word.
    sets: Vec<u64>,
    /// The node of each piece and state that was met, and what the run has closed.
    nodes: FxHashMap<(u32, StateId), Option<(u32, Counts)>>,
}

impl Completions {
    /// Those of the runs within `scope`, one of so many `scopes`; `None` when no number is wanted, and when they are too
    /// many.
    pub(super) fn new(problem: &Problem<'_>, goal: Goal, scope: &Scope, scopes: usize) -> Option<Self> {
        if goal.components.is_none() && goal.holes.is_none() {
            return None;
        }
        let graph = Connectivity::of_kinds(problem, goal, scope, problem.share(NODE_LIMIT))?;
        let frame = Frame::new(Caps::of(goal));
        let (n, size, longest) = (graph.len(), frame.size(), *problem.window.end() as usize);
        let words = (longest + 1).checked_mul(n)?.checked_mul(size)?;
        let work = longest.saturating_mul(graph.joins()).saturating_mul(size);
        if words > problem.share(MOST_BYTES) / scopes / size_of::<u64>() || work > problem.share(MOST_WORK) {
            return None;
        }
        let mut sets = vec![0u64; words];
        let mut one = vec![0u64; size];
        one[0] = 1;
        for length in (1..=longest).rev() {
            let (here, beyond) = sets.split_at_mut((length + 1) * n * size);
            let here = &mut here[length * n * size..];
            for (node, set) in here.chunks_exact_mut(size).enumerate() {
                let ending = graph.ending(node).filter(|_| problem.window.contains(&(length as u32)));
                if let Some(ending) = ending {
                    frame.add_shifted(set, &one, ending);
                }
                for edge in graph.edges(node) {
                    let place = ((edge.width as usize - 1) * n + edge.to as usize) * size;
                    if let Some(rest) = beyond.get(place..place + size) {
                        frame.add_shifted(set, rest, edge.closes);
                    }
                }
            }
        }
        Some(Self { goal, graph, frame, sets, nodes: FxHashMap::default() })
    }

    /// Whether a run of `length` that ends with `piece` in `state` may still come to what is wanted. `true` also of runs
    /// from another scope, of which nothing is known here.
    pub(super) fn may_complete(
        &mut self,
        automaton: &Automaton<'_>,
        (length, piece, state): (u32, usize, StateId),
    ) -> bool {
        let Self { goal, graph, frame, sets, nodes } = self;
        let known = nodes.entry((piece as u32, state)).or_insert_with(|| {
            let node = graph.node(piece, &automaton.connections(state)?.connections())?;
            let (components, holes) = automaton.closed(state);
            Some((node, Counts { components, holes }))
        });
        let Some((node, closed)) = *known else { return true };
        let size = frame.size();
        let place = (length as usize * graph.len() + node as usize) * size;
        // A first piece may be longer than the window.
        let Some(set) = sets.get(place..place + size) else { return false };
        let left = |wanted: Option<Wanted>, closed: u32| match wanted {
            // A number that is not wanted is not read.
            None => Some(0..=0),
            Some(wanted) => Some(wanted.least().saturating_sub(closed)..=wanted.most().checked_sub(closed)?),
        };
        let Some(components) = left(goal.components, closed.components) else { return false };
        let Some(holes) = left(goal.holes, closed.holes) else { return false };
        components
            .into_iter()
            .any(|components| holes.clone().any(|holes| frame.holds(set, Counts { components, holes })))
    }
}
