//! The automaton of reachable descriptors.
//!
//! A state is what a partial run of pieces has to be known by: how the open portals are connected, and how
//! many components and holes are closed, where the goal reads them. The pairs of piece and state that can be
//! reached do not depend on the length of the run, so states and transitions are found once, on demand, and
//! remembered. A state that can no longer meet the goal is dead and never entered.

use rustc_hash::FxHashMap;

use super::descriptor::{Descriptor, Topology};
use super::goal::{Goal, Shape, Wanted};

/// A state of an [`Automaton`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StateId(u32);

impl StateId {
    /// The state's number, counted from 0 in the order of discovery.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Which of two states at the same place can stand for the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dominance {
    /// Only equal ones.
    Equal,
    /// With one component wanted, a coarser partition of the portals: whatever completes a finer one to a single
    /// component completes the coarser one. If holes are wanted too, both must have the same Euler
    /// characteristic: then they end with equally many holes, as these are components − χ.
    Coarser,
    /// With at most some holes wanted and components free, a finer partition with no more holes: whatever
    /// completes the coarser one closes no fewer cycles there.
    Finer,
}

/// What a run is known by: labels of its left portals (rings only) and right portals, and the counters that
/// the goal reads (0 where it does not).
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct State {
    left: Vec<u16>,
    right: Vec<u16>,
    closed: u32,
    holes: u32,
    /// The number of open components.
    open: u32,
}

/// States and transitions for one goal over one catalogue of pieces.
pub struct Automaton<'a> {
    pieces: &'a [Descriptor],
    goal: Goal,
    shape: Shape,
    states: Vec<State>,
    ids: FxHashMap<State, StateId>,
    starts: FxHashMap<usize, Option<StateId>>,
    steps: FxHashMap<u64, Option<StateId>>,
}

impl<'a> Automaton<'a> {
    /// The automaton over `pieces` for `goal`.
    pub fn new(pieces: &'a [Descriptor], goal: Goal, shape: Shape) -> Self {
        Self {
            pieces,
            goal,
            shape,
            states: Vec::new(),
            ids: FxHashMap::default(),
            starts: FxHashMap::default(),
            steps: FxHashMap::default(),
        }
    }

    /// What is asked for.
    pub fn goal(&self) -> Goal {
        self.goal
    }

    /// The number of states found so far.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether no state was found yet.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The state of the run that is `piece` alone; `None` if it is dead.
    pub fn start(&mut self, piece: usize) -> Option<StateId> {
        if let Some(&known) = self.starts.get(&piece) {
            return known;
        }
        let found = self.enter(&self.pieces[piece].clone(), 0);
        self.starts.insert(piece, found);
        found
    }

    /// The state of a run in `state` followed by `piece`, whose left portals are as many as the run's right
    /// ones; `None` if it is dead.
    pub fn step(&mut self, state: StateId, piece: usize) -> Option<StateId> {
        let key = pair(state.0, piece as u32);
        if let Some(&known) = self.steps.get(&key) {
            return known;
        }
        let holes = self.states[state.index()].holes;
        let run = self.run(state);
        let found = match self.pieces.get(piece).map(|p| run.join(p)) {
            Some(Ok(joined)) => self.enter(&joined, holes),
            _ => None,
        };
        self.steps.insert(key, found);
        found
    }

    /// A run in `state` as far as the goal reads it: labels and closed components that it does not read are
    /// not kept, and there are no holes.
    fn run(&self, state: StateId) -> Descriptor {
        let State { left, right, closed, open, .. } = &self.states[state.index()];
        let wide = |labels: &[u16]| labels.iter().map(|&l| u32::from(l)).collect::<Vec<_>>();
        Descriptor::new(&wide(left), &wide(right), *closed, i64::from(closed + open))
    }

    /// How the open portals of a run in `state` are connected, and the components that are closed, if the goal
    /// reads them; without holes.
    pub fn connections(&self, state: StateId) -> Option<Descriptor> {
        self.reads_partition().then(|| self.run(state))
    }

    /// The components and the holes that are closed in `state`, 0 where the goal does not read them.
    pub fn closed(&self, state: StateId) -> (u32, u32) {
        let State { closed, holes, .. } = self.states[state.index()];
        (closed, holes)
    }

    /// The memory that states and transitions take, in bytes, to within a few tens of percent.
    pub fn bytes(&self) -> usize {
        let portals = self.states.first().map_or(0, |s| 2 * (s.left.len() + s.right.len()));
        let state = 2 * (size_of::<State>() + portals + 32) + size_of::<StateId>();
        self.states.len() * state + self.steps.capacity() * 18
    }

    fn reads_partition(&self) -> bool {
        self.goal.components.is_some() || self.goal.holes.is_some() || self.goal.closed_pattern
    }

    /// The state of `run`, which has `holes` more than its Euler characteristic says.
    fn enter(&mut self, run: &Descriptor, holes: u32) -> Option<StateId> {
        if self.goal.closed_pattern && self.shape == Shape::Open {
            return None;
        }
        let holes = holes + run.holes();
        if self.goal.holes.is_some_and(|wanted| holes > wanted.most()) {
            return None;
        }
        let keep_left = self.shape == Shape::Ring;
        let blank = |labels: &[u16]| vec![0u16; labels.len()];
        let (left, right) = match (self.reads_partition(), keep_left) {
            (true, true) => (run.left().to_vec(), run.right().to_vec()),
            // Without the left side, components that reach only it would be lost: they are none, as an open
            // run begins without portals.
            (true, false) => (Vec::new(), run.right().to_vec()),
            (false, _) => (if keep_left { blank(run.left()) } else { Vec::new() }, blank(run.right())),
        };
        let open = match self.reads_partition() {
            true => run.open(),
            false => u32::from(left.len() + right.len() > 0),
        };
        if let Some(wanted) = self.goal.components {
            // Every open component is going to be a part of at least one more closed one.
            if run.closed() + u32::from(open > 0) > wanted.most() {
                return None;
            }
        }
        let state = State {
            left,
            right,
            closed: if self.goal.components.is_some() { run.closed() } else { 0 },
            holes: if self.goal.holes.is_some() { holes } else { 0 },
            open,
        };
        if let Some(&id) = self.ids.get(&state) {
            return Some(id);
        }
        let id = StateId(u32::try_from(self.states.len()).expect("fewer than 2^32 states"));
        self.states.push(state.clone());
        self.ids.insert(state, id);
        Some(id)
    }

    /// Whether a run in `state` is complete and meets the goal: no portals are open (open runs), or its right
    /// portals can be glued to its left ones with the goal's topology (rings).
    pub fn accepts(&self, state: StateId) -> bool {
        let State { left, right, closed, holes, .. } = &self.states[state.index()];
        match self.shape {
            Shape::Open => {
                right.is_empty()
                    && self.goal.components.is_none_or(|wanted| wanted.contains(*closed))
                    && self.goal.holes.is_none_or(|wanted| wanted.contains(*holes))
            }
            Shape::Ring => {
                let closes =
                    |ring: Topology| self.goal.admits(Topology { holes: holes + ring.holes, ..ring });
                left.len() == right.len() && self.run(state).close().is_ok_and(closes)
            }
        }
    }

    /// How states at one place compare for this goal.
    pub fn dominance(&self) -> Dominance {
        let at_most = |wanted: Wanted| wanted.least() == 0;
        match (self.goal.components, self.goal.holes) {
            (Some(_), _) if self.goal.is_one_component() => Dominance::Coarser,
            (None, Some(holes)) if at_most(holes) && !self.goal.closed_pattern => Dominance::Finer,
            _ => Dominance::Equal,
        }
    }

    /// States at one place of which one may dominate another have the same rank.
    pub fn rank(&self, state: StateId) -> u32 {
        let State { closed, open, holes, .. } = &self.states[state.index()];
        match self.dominance() {
            Dominance::Equal => state.0,
            Dominance::Coarser if self.goal.holes.is_some() => (closed + open).wrapping_sub(*holes),
            Dominance::Coarser | Dominance::Finer => 0,
        }
    }

    /// Whether a run in state `a` can be completed in every way in which one in `b` can, so that at no higher
    /// cost it can stand for it. Both have the same numbers of portals.
    pub fn dominates(&self, a: StateId, b: StateId) -> bool {
        if a == b {
            return true;
        }
        let (coarse, fine) = match self.dominance() {
            Dominance::Equal => return false,
            Dominance::Coarser => (a, b),
            Dominance::Finer => (b, a),
        };
        if self.rank(a) != self.rank(b) {
            return false;
        }
        let (of_coarse, of_fine) = (&self.states[coarse.index()], &self.states[fine.index()]);
        // A partition that is coarser has fewer components, or is equal and has other counters.
        if of_coarse.open > of_fine.open
            || of_coarse.closed != of_fine.closed
            || (self.dominance() == Dominance::Finer && of_fine.holes > of_coarse.holes)
        {
            return false;
        }
        is_coarser(of_coarse, of_fine)
    }
}

fn pair(high: u32, low: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

/// Whether portals that `fine` connects are connected in `coarse` too.
fn is_coarser(coarse: &State, fine: &State) -> bool {
    if coarse.left.len() != fine.left.len() || coarse.right.len() != fine.right.len() {
        return false;
    }
    /// Classes for which nothing is allocated.
    const FEW: usize = 64;
    const UNSEEN: u16 = u16::MAX;
    let (mut few, mut many) = ([UNSEEN; FEW], Vec::new());
    let classes = fine.open as usize;
    let image = match few.get_mut(..classes) {
        Some(image) => image,
        None => {
            many.resize(classes, UNSEEN);
            &mut many[..]
        }
    };
    let mut is_image = |(&f, &c): (&u16, &u16)| {
        let image = &mut image[usize::from(f)];
        if *image == UNSEEN {
            *image = c;
        }
        *image == c
    };
    fine.left.iter().zip(&coarse.left).all(&mut is_image)
        && fine.right.iter().zip(&coarse.right).all(is_image)
}
