//! The estimate for one component: one class of a run's partition against all the others.
//!
//! How all portals of a run are connected is too much for a graph, but whether a portal belongs to one class or to
//! the rest is not, and whatever completes the run must bring that class into contact with the rest before it ends. The
//! estimate of a run is the greatest over its classes. With holes wanted too, the Euler characteristic has a price
//! ([`super::priced`]): it adds up along a run, and with one component says how many holes there are going to be.
//!
//! Small classes say nearly all: what the larger ones say more is seldom worth their nodes, and a pass over so many that
//! it has to be given up early says less.

use rustc_hash::FxHashMap;

use super::graph::{Explored, Joins, Scope, Toll};
use super::price::Start;
use super::priced::{Passes, WORK_LIMIT};
use super::problem::{Cost, Problem};
use super::table::NEVER;
use crate::topology::{Automaton, Descriptor, Goal, Shape, StateId};

/// The portals of classes that are told from the rest, at most.
pub(super) const CLASS_SIZES: [usize; 4] = [1, 2, 4, 64];
/// By so much the nodes grow from each of them to the next, about.
const GROWTH: usize = 8;

/// What is known of a run and its estimate: one class of its partition against all the others.
pub(super) struct Classes {
    goal: Goal,
    /// By a class against the rest, by number.
    explored: Explored<u32>,
    pub(super) passes: Passes,
    /// Whether they were asked to know prices.
    has_prices: bool,
    /// Nodes at which the graph is given up.
    limit: usize,
    /// The least that any run costs.
    least: Cost,
    /// Partitions of at most two classes, by number.
    names: Names,
    /// Of each piece and state that were met.
    nodes: FxHashMap<(u32, StateId), Nodes>,
    missing: usize,
}

/// The classes of a run.
struct Nodes {
    found: Vec<u32>,
    /// How many have no node.
    unknown: usize,
    /// The Euler characteristic of the run.
    euler: i64,
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
    /// The estimate for one component that says most of those with at most `limit` nodes, and of a `coarser` one; `None`
    /// for other goals, and when even the coarsest would be too large.
    pub(super) fn new(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        limit: usize,
        coarser: Option<Self>,
    ) -> Option<Self> {
        if !goal.is_one_component() {
            return None;
        }
        let mut best = coarser;
        for most_portals in CLASS_SIZES {
            let names = Names { most_portals, ..Names::default() };
            let Some(next) = Self::explored(problem, goal, scope, limit, names) else { break };
            let graph = next.passes.graph();
            let work = graph.work(*problem.window.end());
            let is_last = graph.len() * GROWTH > limit || work > problem.share(WORK_LIMIT) / GROWTH;
            if best.as_ref().is_none_or(|best| best.least < next.least) {
                best = Some(next);
            }
            if is_last {
                break;
            }
        }
        best
    }

    /// The estimate that tells apart classes of so many portals, whatever it says.
    #[cfg(test)]
    pub(super) fn of_size(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        limit: usize,
        most_portals: usize,
    ) -> Option<Self> {
        let names = Names { most_portals, ..Names::default() };
        goal.is_one_component().then(|| Self::explored(problem, goal, scope, limit, names)).flatten()
    }

    /// The estimate with these classes; `None` when it would be too large.
    fn explored(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        limit: usize,
        mut names: Names,
    ) -> Option<Self> {
        let (explored, passes) = Self::explore(problem, goal, scope, limit, &mut names, Vec::new())?;
        let nodes = FxHashMap::default();
        let mut found =
            Self { goal, explored, passes, has_prices: false, limit, least: NEVER, names, nodes, missing: 0 };
        let starts = found.starts(problem, scope);
        for &(piece, cost) in &scope.starts {
            let length = problem.widths[piece];
            found.passes.load(length.min(*problem.window.end()));
            // All classes of a piece have to meet.
            let of_piece = starts.iter().filter(|start| found.explored.piece(start.node) == piece);
            let rest =
                of_piece.map(|start| found.passes.rest(problem, length, start.node, start.count, None));
            found.least = found.least.min(rest.max().unwrap_or(NEVER).saturating_add(cost));
        }
        Some(found)
    }

    fn explore(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        limit: usize,
        names: &mut Names,
        seeds: Vec<(usize, u32)>,
    ) -> Option<(Explored<u32>, Passes)> {
        let mut begins = seeds;
        for &(piece, _) in &scope.starts {
            let run = &problem.descriptors[piece];
            if run.closed() + u32::from(run.open() > 0) <= 1 {
                begins.extend(names.classes(run).into_iter().map(|class| (piece, class)));
            }
        }
        let expand = |piece: usize, &class: &u32, joins: &mut Joins<u32>| {
            for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
                if let Some((classes, more)) = names.join(problem, class, step.to) {
                    joins.push((*step, more, classes));
                }
            }
            let count = may_stop(goal, problem.shape, &names.partitions[class as usize])?;
            scope.stop[piece].map(|cost| Toll { cost, rise: 0, count })
        };
        let mut explored = Explored::new(problem, begins, limit, expand)?;
        let mut passes = Passes::new(problem, std::mem::take(&mut explored.graph))?;
        if let Some(wanted) = goal.holes {
            // A goal of at most one component may be met without ink.
            let components = goal.components.map_or(1, |wanted| i64::from(wanted.least()));
            let euler = components - i64::from(wanted.most())..=1 - i64::from(wanted.least());
            passes.learn_counts(problem, &starts(problem, scope, names, &explored), euler);
        }
        Some((explored, passes))
    }

    /// Makes the estimate know the drift, by prices.
    pub(super) fn learn_drift(&mut self, problem: &Problem<'_>, scope: &Scope) {
        let starts = self.starts(problem, scope);
        self.passes.learn_drift(problem, &starts);
        self.has_prices = true;
    }

    fn starts(&mut self, problem: &Problem<'_>, scope: &Scope) -> Vec<Start> {
        starts(problem, scope, &mut self.names, &self.explored)
    }

    /// The estimate for a run of a length that is loaded, as [`super::estimates::Estimates::rest`].
    pub(super) fn rest(
        &mut self,
        problem: &Problem<'_>,
        automaton: &Automaton<'_>,
        (length, piece, state, drift): (u32, usize, StateId, Option<i32>),
    ) -> Cost {
        let Self { explored, passes, names, nodes, missing, .. } = self;
        let nodes = nodes.entry((piece as u32, state)).or_insert_with(|| {
            let Some(run) = automaton.connections(state) else {
                return Nodes { found: Vec::new(), unknown: 0, euler: 0 };
            };
            let classes = names.classes(&run);
            let found: Vec<u32> =
                classes.iter().filter_map(|&class| explored.node(piece, class).map(|n| n as u32)).collect();
            let unknown = classes.len() - found.len();
            *missing += unknown;
            // Components − χ are the holes so far.
            let (_, holes) = automaton.closed(state);
            let euler = i64::from(run.closed() + run.open()) - i64::from(holes);
            Nodes { found, unknown, euler }
        });
        let rest = |&node: &u32| passes.rest(problem, length, node as usize, nodes.euler, drift);
        nodes.found.iter().map(rest).max().unwrap_or(0)
    }

    /// Takes the classes of the states that were met since into the graph; whether there were enough of them to be worth
    /// while.
    pub(super) fn grow(&mut self, problem: &Problem<'_>, automaton: &Automaton<'_>, scope: &Scope) -> bool {
        if self.missing * 10 <= self.nodes.len() {
            return false;
        }
        let mut unknown: Vec<(u32, StateId)> =
            self.nodes.iter().filter(|(_, nodes)| nodes.unknown > 0).map(|(&key, _)| key).collect();
        unknown.sort_unstable();
        let mut seeds = Vec::new();
        for (piece, state) in unknown {
            let run = automaton.connections(state);
            let classes = run.map(|run| self.names.classes(&run)).unwrap_or_default();
            seeds.extend(classes.into_iter().map(|class| (piece as usize, class)));
        }
        self.missing = 0;
        let Self { goal, limit, names, .. } = self;
        let Some((explored, passes)) = Self::explore(problem, *goal, scope, *limit, names, seeds) else {
            return false;
        };
        (self.explored, self.passes) = (explored, passes);
        self.nodes.clear();
        if self.has_prices {
            self.learn_drift(problem, scope);
        }
        true
    }
}

/// Where runs begin: each class of a first piece.
fn starts(problem: &Problem<'_>, scope: &Scope, names: &mut Names, explored: &Explored<u32>) -> Vec<Start> {
    let mut starts = Vec::new();
    for &(piece, cost) in &scope.starts {
        let run = &problem.descriptors[piece];
        let (length, count) = (problem.widths[piece], run.euler());
        let nodes = names.classes(run).into_iter().filter_map(|class| explored.node(piece, class));
        starts.extend(nodes.map(|node| Start { node, length, cost, count }));
    }
    starts
}

/// Whether a run may be complete, as far as a partition with fewer classes can tell, and then what χ becomes more.
fn may_stop(goal: Goal, shape: Shape, run: &Descriptor) -> Option<i32> {
    match shape {
        Shape::Open => run.right().is_empty().then_some(0),
        Shape::Ring => {
            let ring = run.close().ok()?;
            let is_one = ring.components <= 1 && (ring.closed_pattern || !goal.closed_pattern);
            is_one.then_some(-(run.left().len() as i32))
        }
    }
}
