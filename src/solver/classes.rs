//! The estimate for one component: one class of a run's partition against all the others.
//!
//! How all portals of a run are connected is too much for a graph, but whether a portal belongs to one class or to
//! the rest is not, and whatever completes the run must bring that class into contact with the rest before it ends. The
//! estimate of a run is the greatest over its classes. With holes wanted too, the Euler characteristic is known
//! besides: with one component it says how many holes there are going to be. Where that makes the graph too large,
//! holes are left out of account.
//!
//! Small classes say nearly all: what the larger ones say more is seldom worth their nodes, and a pass over so many that
//! it has to be given up early says less.

use rustc_hash::FxHashMap;

use super::graph::{Explored, Joins, Scope};
use super::priced::{Passes, WORK_LIMIT};
use super::problem::{Cost, Problem};
use super::table::NEVER;
use crate::topology::{Automaton, Descriptor, Goal, Shape, StateId};

/// The portals of classes that are told from the rest, at most.
pub(super) const CLASS_SIZES: [usize; 4] = [1, 2, 4, 64];
/// By so much the nodes grow from each of them to the next, about.
const GROWTH: usize = 8;

/// A class against the rest, by number, and the Euler characteristic where it is read.
type ClassKey = (u32, i32);

/// What is known of a run and its estimate: one class of its partition against all the others.
pub(super) struct Classes {
    goal: Goal,
    explored: Explored<ClassKey>,
    pub(super) passes: Passes,
    /// Whether they were asked to know prices.
    has_prices: bool,
    /// Nodes at which the graph is given up.
    limit: usize,
    /// The least that any run costs.
    least: Cost,
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

    /// The same for a piece by itself, each with its Euler characteristic if it is read.
    fn keys(&mut self, goal: Goal, piece: &Descriptor) -> Vec<ClassKey> {
        let euler = goal.holes.map_or(0, |_| piece.euler() as i32);
        self.classes(piece).into_iter().map(|class| (class, euler)).collect()
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
        // Where the holes make it too large, they are not read.
        let without_holes = goal.holes.map(|_| Goal { holes: None, ..goal });
        let longest = *problem.window.end();
        for goal in std::iter::once(goal).chain(without_holes) {
            let mut is_affordable = false;
            for most_portals in CLASS_SIZES {
                let names = Names { most_portals, ..Names::default() };
                let Some(next) = Self::explored(problem, goal, scope, limit, names) else { break };
                is_affordable = true;
                let graph = next.passes.graph();
                let is_last =
                    graph.len() * GROWTH > limit || graph.work(longest) > problem.share(WORK_LIMIT) / GROWTH;
                if best.as_ref().is_none_or(|best| best.least < next.least) {
                    best = Some(next);
                }
                if is_last {
                    break;
                }
            }
            if is_affordable {
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
        let (explored, mut passes) = Self::explore(problem, goal, scope, limit, &mut names, Vec::new())?;
        let mut least = NEVER;
        for &(piece, cost) in &scope.starts {
            let length = problem.widths[piece];
            passes.load(length.min(*problem.window.end()));
            let run = &problem.descriptors[piece];
            let nodes = names.keys(goal, run).into_iter().filter_map(|key| explored.node(piece, key));
            let rest = nodes.map(|node| passes.rest(problem, length, node, None)).max();
            least = least.min(rest.unwrap_or(NEVER).saturating_add(cost));
        }
        let nodes = FxHashMap::default();
        Some(Self { goal, explored, passes, has_prices: false, limit, least, names, nodes, missing: 0 })
    }

    fn explore(
        problem: &Problem<'_>,
        goal: Goal,
        scope: &Scope,
        limit: usize,
        names: &mut Names,
        seeds: Vec<(usize, ClassKey)>,
    ) -> Option<(Explored<ClassKey>, Passes)> {
        let mut starts = seeds;
        for &(piece, _) in &scope.starts {
            let run = &problem.descriptors[piece];
            if run.closed() + u32::from(run.open() > 0) <= 1 {
                starts.extend(names.keys(goal, run).into_iter().map(|key| (piece, key)));
            }
        }
        let expand = |piece: usize, &(class, euler): &ClassKey, joins: &mut Joins<ClassKey>| {
            for step in problem.steps[piece].iter().filter(|s| scope.allowed[s.to]) {
                let Some((classes, more)) = names.join(problem, class, step.to) else { continue };
                let euler = if goal.holes.is_some() { euler + more } else { 0 };
                // Holes are what components have more than χ, and never become fewer.
                let least_holes = |&class: &u32| {
                    let run = &names.partitions[class as usize];
                    i64::from(run.closed() + run.open()) - i64::from(euler)
                };
                let holes = classes.iter().map(least_holes).max().unwrap_or(0);
                if goal.holes.is_none_or(|wanted| holes <= i64::from(wanted.most())) {
                    joins.push((*step, classes.iter().map(|&class| (class, euler)).collect()));
                }
            }
            let run = &names.partitions[class as usize];
            scope.stop[piece].filter(|_| may_stop(goal, problem.shape, run, euler))
        };
        let mut explored = Explored::new(problem, starts, limit, expand)?;
        let passes = Passes::new(problem, std::mem::take(&mut explored.graph))?;
        Some((explored, passes))
    }

    /// Makes the estimate know the drift, by prices.
    pub(super) fn learn_prices(&mut self, problem: &Problem<'_>, scope: &Scope) {
        let Self { goal, explored, passes, names, .. } = self;
        let mut starts = Vec::new();
        for &(piece, cost) in &scope.starts {
            let keys = names.keys(*goal, &problem.descriptors[piece]);
            let nodes = keys.into_iter().filter_map(|key| explored.node(piece, key));
            starts.extend(nodes.map(|node| (node, problem.widths[piece], cost)));
        }
        passes.learn_prices(problem, &starts);
        self.has_prices = true;
    }

    /// The estimate for a run of a length that is loaded, as [`super::estimates::Estimates::rest`].
    pub(super) fn rest(
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

    /// Takes the classes of the states that were met since into the graph; whether there were enough of them to be worth
    /// while.
    pub(super) fn grow(&mut self, problem: &Problem<'_>, automaton: &Automaton<'_>, scope: &Scope) -> bool {
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
        let Self { goal, limit, names, .. } = self;
        let Some((explored, passes)) = Self::explore(problem, *goal, scope, *limit, names, seeds) else {
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
