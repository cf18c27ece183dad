//! Admissible estimates: the least cost of completing a run when something is ignored.
//!
//! Each is a pass over a smaller graph, exact for what its nodes know; the greatest of them drives the search.
//! The pieces alone are made for every search. The others are dear, and are made when a short search has not
//! ended:
//!
//! - *exact*: all pairs of piece and state, where they are few. Nothing but the drift is ignored.
//! - *classes*: for one component. A partition is too much to know of a run, but one of its classes against
//!   all the others together is not, and an answer must bring that class into contact with the rest before it
//!   ends. The estimate of a run is the greatest over its classes. With holes wanted too, the Euler
//!   characteristic is known besides: with one component it says how many holes there are going to be.
//!
//! Where runs leave the band each of these knows the drift by a price ([`super::priced`]), and where that is not
//! enough, the pairs of piece and state are taken with the drift.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::graph::{Explored, Joins, Scope, of_pieces};
use super::lengths::has_level_run;
use super::priced::{Passes, estimate};
use super::problem::{Cost, Problem};
use super::table::{NEVER, Table};
use crate::topology::{Automaton, Descriptor, Goal, Shape, StateId};

/// Nodes of a graph at which it is given up.
const NODE_LIMIT: usize = 60_000;
/// Additions in the pass that knows state and drift beyond which it is not begun: about a second.
const WORK_LIMIT: usize = 1_000_000_000;
/// Additions in the pass that knows the drift, of which there are some 700 million in a second.
const DRIFT_WORK_LIMIT: usize = 10_000_000_000;
/// The portals of classes that are told from the rest: the first that is affordable.
const CLASS_SIZES: [usize; 4] = [64, 4, 2, 1];

/// What estimates know, from the cheapest to the dearest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    /// Pieces and joins.
    Pieces,
    /// And how portals are connected.
    Topology,
    /// And what rising costs in the end.
    Prices,
    /// And the drift itself.
    Drift,
}

/// Runs by what is known of them, the drift among it, and what completing them costs at least.
type Drifting<K> = (Explored<K>, Table<Cost>);

/// The estimates that are dear to make, as far as they were made.
#[derive(Default)]
pub(super) struct Estimates {
    exact: Option<(Explored<(StateId, i32)>, Passes)>,
    classes: Option<Classes>,
    /// Whether no run stays in the band.
    is_never: bool,
    /// The same with the drift.
    drifting: Option<Drifting<(StateId, i32)>>,
    /// And without the state.
    drifts: Option<Drifting<i32>>,
    /// Of the pieces alone, made when the drift is known and neither of the others is.
    pieces: Option<Passes>,
}

impl Estimates {
    /// Makes the estimates that know topology.
    pub(super) fn learn_topology(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
    ) {
        if automaton.goal().is_free() {
            return;
        }
        self.exact =
            triples(problem, automaton, scope, false, problem.share(NODE_LIMIT)).and_then(|mut explored| {
                let passes = Passes::new(problem, std::mem::take(&mut explored.graph))?;
                Some((explored, passes))
            });
        if self.exact.is_none() {
            self.classes = Classes::new(problem, automaton.goal(), scope);
        }
    }

    /// Makes what is known know the drift, by prices.
    pub(super) fn learn_prices(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
    ) {
        let begin = |piece: usize, node: usize, cost: Cost| (node, problem.widths[piece], cost);
        if let Some((explored, passes)) = &mut self.exact {
            let starts = scope.starts.iter().filter_map(|&(piece, cost)| {
                let node = explored.node(piece, (automaton.start(piece)?, 0))?;
                Some(begin(piece, node, cost))
            });
            let starts: Vec<_> = starts.collect();
            passes.learn_prices(problem, &starts);
            if passes.only_leaves() {
                let starts = starts.iter().map(|&(node, length, _)| (node, length));
                self.is_never = has_level_run(problem, passes.graph(), starts) == Some(false);
            }
        } else if let Some(classes) = &mut self.classes {
            classes.learn_prices(problem, scope);
        } else {
            let starts = scope.starts.iter().map(|&(piece, cost)| begin(piece, piece, cost));
            self.pieces = Passes::new(problem, of_pieces(problem, scope));
            if let Some(passes) = &mut self.pieces {
                passes.learn_prices(problem, &starts.collect::<Vec<_>>());
            }
        }
    }

    /// Makes the pass over all pairs of piece and state with the drift, if it is affordable.
    pub(super) fn learn_drift(
        &mut self,
        problem: &Problem<'_>,
        automaton: &mut Automaton<'_>,
        scope: &Scope,
    ) {
        let limit = problem.share(NODE_LIMIT);
        let longest = *problem.window.end();
        if self.exact.is_some() || automaton.goal().is_free() {
            let is_short = |found: &Explored<_>| found.graph.work(longest) <= problem.share(WORK_LIMIT);
            let found = triples(problem, automaton, scope, true, limit).filter(is_short);
            self.drifting = found.and_then(|explored| drifting(problem, explored));
        }
        if self.drifting.is_none() {
            // Longer runs without their state, which leaves far fewer nodes.
            let found = with_drift(problem, scope, limit);
            self.drifts = found.and_then(|explored| drifting(problem, explored));
        }
    }

    /// Whether the estimate leaves nothing but the drift out of account.
    pub(super) fn is_exact(&self) -> bool {
        self.exact.is_some()
    }

    /// Makes the rows of `length` and of what a step leads to available.
    pub(super) fn load(&mut self, length: u32) {
        let Self { exact, classes, pieces, drifting, drifts, .. } = self;
        let tables = [drifting.as_mut().map(|(_, table)| table), drifts.as_mut().map(|(_, table)| table)];
        tables.into_iter().flatten().for_each(|table| table.load(length));
        let passes = [
            exact.as_mut().map(|(_, passes)| passes),
            classes.as_mut().map(|classes| &mut classes.passes),
            pieces.as_mut(),
        ];
        passes.into_iter().flatten().for_each(|passes| passes.load(length));
    }

    /// The estimate for a run of `length` that ends with `piece` in `state`, at a length that is loaded, with its
    /// drift where runs are told apart by it.
    pub(super) fn rest(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        run: (u32, usize, StateId, Option<i32>),
    ) -> Cost {
        let (length, piece, state, drift) = run;
        if self.is_never {
            return NEVER;
        }
        let mut rest = 0;
        if let Some(passes) = &self.pieces {
            rest = passes.rest(problem, length, piece, drift);
        }
        if let Some((explored, passes)) = &self.exact {
            // What was not reached is from another scope, of which nothing is known here.
            let node = explored.node(piece, (state, 0));
            rest = rest.max(node.map_or(0, |node| passes.rest(problem, length, node, drift)));
        }
        if let (Some((explored, table)), Some(drift)) = (&self.drifting, drift) {
            let node = explored.node(piece, (state, drift));
            rest = rest.max(node.map_or(0, |node| table.at(length, node)));
        }
        if let (Some((explored, table)), Some(drift)) = (&self.drifts, drift) {
            rest = rest.max(explored.node(piece, drift).map_or(0, |node| table.at(length, node)));
        }
        if let Some(classes) = &mut self.classes {
            rest = rest.max(classes.rest(problem, automaton, run));
        }
        rest
    }

    /// Takes what was learned of the classes of the states that were met since into the estimate; whether there
    /// was enough of it to be worth while.
    pub(super) fn learn_more(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        scope: &Scope,
    ) -> bool {
        self.classes.as_mut().is_some_and(|classes| classes.grow(problem, automaton, scope))
    }
}

/// All pairs of piece and state that runs reach, with the drift if asked for, which is 0 otherwise; `None` when they
/// are more than `limit`.
pub(super) fn triples(
    problem: &Problem<'_>,
    automaton: &mut Automaton<'_>,
    scope: &Scope,
    by_drift: bool,
    limit: usize,
) -> Option<Explored<(StateId, i32)>> {
    let starts = scope.starts.iter().filter_map(|&(p, _)| automaton.start(p).map(|s| (p, (s, 0))));
    let starts: Vec<(usize, (StateId, i32))> = starts.collect();
    Explored::new(problem, starts, limit, |piece, &(state, drift), joins| {
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            let drift = if by_drift { drift.saturating_add(step.rise) } else { 0 };
            if drift.saturating_abs() > problem.drift_limit {
                continue;
            }
            if let Some(next) = automaton.step(state, step.to) {
                joins.push((*step, vec![(next, drift)]));
            }
        }
        scope.stop[piece].filter(|_| automaton.accepts(state))
    })
}

/// All pairs of piece and drift that runs reach; `None` when they are more than `limit`.
fn with_drift(problem: &Problem<'_>, scope: &Scope, limit: usize) -> Option<Explored<i32>> {
    let starts: Vec<(usize, i32)> = scope.starts.iter().map(|&(piece, _)| (piece, 0)).collect();
    Explored::new(problem, starts, limit, |piece, &drift, joins| {
        for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
            let drift = drift.saturating_add(step.rise);
            if drift.saturating_abs() <= problem.drift_limit {
                joins.push((*step, vec![drift]));
            }
        }
        scope.stop[piece]
    })
}

/// The pass over what was explored.
fn drifting<K>(problem: &Problem<'_>, mut explored: Explored<K>) -> Option<Drifting<K>> {
    let graph = Arc::new(std::mem::take(&mut explored.graph));
    let table = estimate(problem, &graph, problem.share(DRIFT_WORK_LIMIT), |cost, _| cost)?;
    Some((explored, table))
}

/// A class against the rest, by number, and the Euler characteristic where it is read.
type ClassKey = (u32, i32);

/// What is known of a run and its estimate: one class of its partition against all the others.
struct Classes {
    goal: Goal,
    explored: Explored<ClassKey>,
    passes: Passes,
    /// Whether they were asked to know prices.
    has_prices: bool,
    /// Partitions of at most two classes, by number.
    names: Names,
    /// The nodes of each piece and state that were met, and how many classes have no node.
    nodes: FxHashMap<(u32, StateId), (Vec<u32>, usize)>,
    missing: usize,
}

/// The numbers of the classes that a join leads to, and what χ becomes more.
type JoinedClasses = (Vec<u32>, i32);

/// Numbers of partitions.
#[derive(Default)]
struct Names {
    /// Classes of so many portals are told from the rest; larger ones would be too many.
    most_portals: usize,
    ids: FxHashMap<Descriptor, u32>,
    partitions: Vec<Descriptor>,
    /// What a join with a piece makes of a partition: the numbers of its classes and what χ becomes more.
    joins: FxHashMap<(u32, u32), Option<JoinedClasses>>,
}

impl Names {
    fn name(&mut self, partition: Descriptor) -> u32 {
        let partitions = &mut self.partitions;
        *self.ids.entry(partition).or_insert_with_key(|partition| {
            partitions.push(partition.clone());
            partitions.len() as u32 - 1
        })
    }

    /// Each small class of a run against the others; one entry without classes that are told apart.
    fn classes(&mut self, run: &Descriptor) -> Vec<u32> {
        let most_portals = self.most_portals;
        let portals = run.left().len() + run.right().len();
        let labels = || run.left().iter().chain(run.right()).map(|&l| u32::from(l));
        let mut against = |class: Option<u32>| {
            let told = |labels: &[u16]| -> Vec<u32> {
                labels.iter().map(|&l| u32::from(Some(u32::from(l)) == class)).collect()
            };
            self.name(Descriptor::new(&told(run.left()), &told(run.right()), run.closed(), 0))
        };
        let mut found: Vec<u32> = (0..run.open())
            .filter_map(|class| {
                let size = labels().filter(|&l| l == class).count();
                let is_told = size < portals && size.min(portals - size) <= most_portals;
                is_told.then(|| against(Some(class)))
            })
            .collect();
        // The two classes of a partition are told apart by either.
        found.sort_unstable();
        found.dedup();
        if found.is_empty() {
            found.push(against(None));
        }
        found
    }

    /// The classes of a run with these connections that `piece` is joined to, and by how much χ grows; `None`
    /// when something is closed that should not be.
    fn join(&mut self, problem: &Problem<'_>, id: u32, piece: usize) -> Option<JoinedClasses> {
        if let Some(known) = self.joins.get(&(id, piece as u32)) {
            return known.clone();
        }
        let next = &problem.descriptors[piece];
        let run = self.partitions[id as usize].join(next).ok();
        let joined = run.filter(|run| run.closed() + u32::from(run.open() > 0) <= 1).map(|run| {
            let more = next.euler() - next.left().len() as i64;
            (self.classes(&run), more as i32)
        });
        self.joins.insert((id, piece as u32), joined.clone());
        joined
    }
}

impl Classes {
    /// The estimate for one component; `None` for other goals, and when it would be too large.
    fn new(problem: &Problem<'_>, goal: Goal, scope: &Scope) -> Option<Self> {
        if !goal.is_one_component() {
            return None;
        }
        // Where the holes make it too large, they are not read.
        let without_holes = goal.holes.map(|_| Goal { holes: None, ..goal });
        let goals = std::iter::once(goal).chain(without_holes);
        goals.flat_map(|goal| CLASS_SIZES.map(|size| (goal, size))).find_map(|(goal, most_portals)| {
            let mut names = Names { most_portals, ..Names::default() };
            let (explored, passes) = Self::explore(problem, goal, scope, &mut names, Vec::new())?;
            let nodes = FxHashMap::default();
            Some(Self { goal, explored, passes, has_prices: false, names, nodes, missing: 0 })
        })
    }

    fn explore(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        names: &mut Names,
        seeds: Vec<(usize, ClassKey)>,
    ) -> Option<(Explored<ClassKey>, Passes)> {
        let euler = |run: &Descriptor| if goal.holes.is_some() { run.euler() as i32 } else { 0 };
        let mut starts = seeds;
        for &(piece, _) in &scope.starts {
            let run = &problem.descriptors[piece];
            if run.closed() + u32::from(run.open() > 0) <= 1 {
                starts.extend(names.classes(run).into_iter().map(|class| (piece, (class, euler(run)))));
            }
        }
        let expand = |piece: usize, &(class, euler): &ClassKey, joins: &mut Joins<ClassKey>| {
            for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
                let Some((classes, more)) = names.join(problem, class, step.to) else { continue };
                let euler = if goal.holes.is_some() { euler + more } else { 0 };
                if goal.holes.is_some_and(|holes| 1 - i64::from(euler) > i64::from(holes.most())) {
                    continue;
                }
                joins.push((*step, classes.iter().map(|&class| (class, euler)).collect()));
            }
            let run = &names.partitions[class as usize];
            scope.stop[piece].filter(|_| may_stop(goal, problem.shape, run, euler))
        };

        let explored = Explored::new(problem, starts, problem.share(NODE_LIMIT), expand);

        let mut explored = explored?;
        let passes = Passes::new(problem, std::mem::take(&mut explored.graph))?;
        Some((explored, passes))
    }

    fn learn_prices(&mut self, problem: &Problem<'_>, scope: &Scope) {
        let Self { goal, explored, passes, names, .. } = self;
        let mut starts = Vec::new();
        for &(piece, cost) in &scope.starts {
            let run = &problem.descriptors[piece];
            let euler = if goal.holes.is_some() { run.euler() as i32 } else { 0 };
            let nodes =
                names.classes(run).into_iter().filter_map(|class| explored.node(piece, (class, euler)));
            starts.extend(nodes.map(|node| (node, problem.widths[piece], cost)));
        }
        passes.learn_prices(problem, &starts);
        self.has_prices = true;
    }

    fn rest(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        (length, piece, state, drift): (u32, usize, StateId, Option<i32>),
    ) -> Cost {
        let Self { goal, explored, passes, names, nodes, missing, .. } = self;
        let (nodes, _) = nodes.entry((piece as u32, state)).or_insert_with(|| {
            let keys = keys_of(*goal, automaton, names, state);
            let found: Vec<u32> =
                keys.iter().filter_map(|&key| explored.node(piece, key).map(|n| n as u32)).collect();
            let unknown = keys.len() - found.len();
            *missing += unknown;
            (found, unknown)
        });
        nodes.iter().map(|&node| passes.rest(problem, length, node as usize, drift)).max().unwrap_or(0)
    }

    fn grow(&mut self, problem: &Problem<'_>, automaton: &Automaton<'_>, scope: &Scope) -> bool {
        if self.missing * 10 <= self.nodes.len() {
            return false;
        }
        let mut unknown: Vec<(u32, StateId)> =
            self.nodes.iter().filter(|(_, (_, unknown))| *unknown > 0).map(|(&key, _)| key).collect();
        unknown.sort_unstable();
        let mut seeds = Vec::new();
        for (piece, state) in unknown {
            let keys = keys_of(self.goal, automaton, &mut self.names, state);
            seeds.extend(keys.into_iter().map(|key| (piece as usize, key)));
        }

        self.missing = 0;
        let Some((explored, passes)) = Self::explore(problem, self.goal, scope, &mut self.names, seeds)
        else {
            return false;
        };
        (self.explored, self.passes) = (explored, passes);
        self.nodes.clear();
        if self.has_prices {
            self.learn_prices(problem, scope);
        }
        true
    }
}

/// The classes of a state, each with the Euler characteristic if it is read.
fn keys_of(goal: Goal, automaton: &Automaton<'_>, names: &mut Names, state: StateId) -> Vec<ClassKey> {
    let Some(run) = automaton.connections(state) else { return Vec::new() };
    // Components − χ are the holes so far.
    let (_, holes) = automaton.closed(state);
    let euler = match goal.holes {
        Some(_) => (run.closed() + run.open()) as i32 - holes as i32,
        None => 0,
    };
    names.classes(&run).into_iter().map(|class| (class, euler)).collect()
}

/// Whether a run may be complete, as far as a partition with fewer classes can tell.
fn may_stop(goal: Goal, shape: Shape, run: &Descriptor, euler: i32) -> bool {
    let (topology, euler) = match shape {
        Shape::Open => match run.right().is_empty() {
            true => (None, euler),
            false => return false,
        },
        Shape::Ring => match run.close() {
            Ok(topology) => (Some(topology), euler - run.left().len() as i32),
            Err(_) => return false,
        },
    };
    topology.is_none_or(|ring| ring.components <= 1 && (ring.closed_pattern || !goal.closed_pattern))
        && goal.holes.is_none_or(|holes| u32::try_from(1 - euler).is_ok_and(|n| holes.contains(n)))
}
