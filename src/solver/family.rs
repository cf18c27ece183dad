//! What is searched: open runs, and rings by the cut at which they are opened.
//!
//! A ring is a cyclic sequence; where it is opened does not matter to its topology, so it is opened at a cut
//! with the fewest portals, m. Pieces with fewer than m portals on a side then cannot occur, and with m = 1
//! the left labels say next to nothing. A family is all rings with the same m; its members are the first
//! pieces, each with what it costs to close the ring there. Open runs are one family with one member.
//!
//! The drift of a ring is measured from where it is opened, so a ring stays in the band if it does from one
//! of its narrowest cuts.

use std::cmp::Reverse;

use super::estimates::{Estimates, Level};
use super::graph::{Scope, of_pieces};
use super::problem::{Cost, Problem};
use super::table::{NEVER, TABLE_BUDGET, Table};
use crate::topology::{Automaton, Shape};

/// Runs that are looked at together.
pub(super) struct Family {
    /// All members in one: the first pieces, and the least cost of stopping after each piece.
    pub(super) scope: Scope,
    pub(super) members: Vec<Member>,
    /// The least cost of completing a run of any member by its last piece.
    shared: Option<Box<Table<Cost>>>,
    /// What was learned of all members.
    pub(super) estimates: Estimates,
    /// How much.
    pub(super) level: Level,
    /// Whether each member is searched by itself, with its own end.
    pub(super) is_ring: bool,
}

/// The runs of a family from one first piece (rings), or all of them (open runs).
pub(super) struct Member {
    pub(super) scope: Scope,
    /// No run of this member costs less.
    pub(super) estimate: Cost,
    table: Option<Box<Table<Cost>>>,
}

/// The families of a problem. A closed pattern is not broken anywhere, so with `winds` there is none at an
/// empty cut.
pub(super) fn families(problem: &Problem<'_>, winds: bool) -> Vec<Family> {
    let is_ring = problem.shape == Shape::Ring;
    scopes(problem, winds).into_iter().map(|scope| Family::new(problem, scope, is_ring)).collect()
}

/// What the families are looked for in.
pub(super) fn scopes(problem: &Problem<'_>, winds: bool) -> Vec<Scope> {
    match problem.shape {
        Shape::Open => vec![open_scope(problem)],
        Shape::Ring => narrowest_cuts(problem, winds).into_iter().map(|m| ring_scope(problem, m)).collect(),
    }
}

/// All open runs.
fn open_scope(problem: &Problem<'_>) -> Scope {
    Scope {
        starts: problem.begin.iter().enumerate().filter_map(|(p, cost)| cost.map(|c| (p, c))).collect(),
        allowed: vec![true; problem.pieces()],
        stop: problem.end.clone(),
    }
}

/// The numbers of portals at which rings may have their narrowest cut.
fn narrowest_cuts(problem: &Problem<'_>, winds: bool) -> Vec<usize> {
    let mut portals: Vec<usize> = problem.descriptors.iter().map(|d| d.left().len()).collect();
    portals.sort_unstable();
    portals.dedup();
    portals.retain(|&m| m > 0 || !winds);
    portals
}

/// All rings with `m` portals at the narrowest cut; closing costs are to the cheapest of the first pieces.
fn ring_scope(problem: &Problem<'_>, m: usize) -> Scope {
    let (left, right) =
        (|p: usize| problem.descriptors[p].left().len(), |p: usize| problem.descriptors[p].right().len());
    let allowed: Vec<bool> = (0..problem.pieces()).map(|p| left(p) >= m && right(p) >= m).collect();
    let firsts: Vec<usize> = (0..problem.pieces()).filter(|&p| allowed[p] && left(p) == m).collect();
    let stop = closing_costs(problem, &firsts, &allowed);
    Scope { starts: firsts.into_iter().map(|p| (p, 0)).collect(), allowed, stop }
}

/// What closing a ring after each piece costs, when it began with the cheapest of `firsts`.
pub(super) fn closing_costs(problem: &Problem<'_>, firsts: &[usize], allowed: &[bool]) -> Vec<Option<Cost>> {
    let mut is_first = vec![false; problem.pieces()];
    firsts.iter().for_each(|&p| is_first[p] = true);
    (0..problem.pieces())
        .map(|p| {
            let closing = problem.steps[p].iter().filter(|s| is_first[s.to]);
            closing.map(|s| s.cost).min().filter(|_| allowed[p])
        })
        .collect()
}

impl Family {
    fn new(problem: &Problem<'_>, scope: Scope, is_ring: bool) -> Self {
        let mut table = piece_table(problem, &scope);
        let estimates = estimates(&mut table, problem, &scope);
        let mut members: Vec<Member> = match is_ring {
            false => {
                let estimate = estimates.into_iter().min().unwrap_or(NEVER);
                vec![Member { scope: scope.clone(), estimate, table: None }]
            }
            true => scope
                .starts
                .iter()
                .zip(estimates)
                .map(|(start, estimate)| {
                    let stop = closing_costs(problem, &[start.0], &scope.allowed);
                    let scope = Scope { starts: vec![*start], allowed: scope.allowed.clone(), stop };
                    Member { scope, estimate, table: None }
                })
                .collect(),
        };
        let table = Some(Box::new(table));
        let shared = match (&mut members[..], is_ring) {
            ([only], false) => {
                only.table = table;
                None
            }
            _ => table,
        };
        let mut family =
            Self { scope, members, shared, estimates: Estimates::default(), level: Level::Pieces, is_ring };
        family.sort();
        family
    }

    /// Drops members of which nothing can come, and puts the most promising first.
    fn sort(&mut self) {
        self.members.retain(|m| m.estimate != NEVER);
        self.members.sort_by_key(|m| (m.estimate, m.scope.starts[0].0));
    }

    /// The least cost that any member may have; [`NEVER`] without members.
    pub(super) fn estimate(&self) -> Cost {
        self.members.iter().map(|m| m.estimate).min().unwrap_or(NEVER)
    }

    /// Makes the estimates up to `level`, and looks at the members again in their light.
    pub(super) fn learn(&mut self, problem: &Problem<'_>, automaton: &mut Automaton<'_>, level: Level) {
        if self.level < Level::Fine {
            self.estimates.learn_topology(problem, automaton, &self.scope, level >= Level::Fine);
        }
        if self.level < Level::Prices && level >= Level::Prices {
            self.estimates.learn_prices(problem, automaton, &self.scope);
        }
        if level == Level::Drift {
            self.estimates.learn_drift(problem, automaton, &self.scope);
        }
        self.level = level;
        self.look_again(problem, automaton);
    }

    /// The least cost of completing a run of a member by its last piece. As long as nothing is known of topology, that
    /// of all members does: most that are looked at then come to nothing, and each has a pass of its own.
    pub(super) fn take_table(&mut self, problem: &Problem<'_>, member: usize) -> Box<Table<Cost>> {
        match self.shared.take_if(|_| self.level == Level::Pieces) {
            Some(shared) => shared,
            None => self.members[member].take_table(problem),
        }
    }

    /// Takes a table back for another walk.
    pub(super) fn keep_table(&mut self, member: usize, table: Box<Table<Cost>>) {
        match self.level == Level::Pieces && self.is_ring {
            true => self.shared = Some(table),
            false => self.members[member].keep_table(table),
        }
    }

    /// Looks at the members in the light of what has been learned.
    pub(super) fn look_again(&mut self, problem: &Problem<'_>, automaton: &mut Automaton<'_>) {
        for member in &mut self.members {
            let starts = member.scope.starts.iter().map(|&(piece, cost)| {
                let Some(state) = automaton.start(piece) else { return NEVER };
                let length = problem.widths[piece];
                self.estimates.load(length.min(*problem.window.end()));
                let rest = self.estimates.rest(problem, automaton, (length, piece, state, Some(0)));
                rest.saturating_add(cost)
            });
            member.estimate = member.estimate.max(starts.min().unwrap_or(NEVER));
        }
        self.sort();
    }
}

impl Member {
    /// The least cost of completing a run of this member by its last piece. Made once, if it is small.
    fn take_table(&mut self, problem: &Problem<'_>) -> Box<Table<Cost>> {
        let mut table = self.table.take().unwrap_or_else(|| Box::new(piece_table(problem, &self.scope)));
        let starts = estimates(&mut table, problem, &self.scope);
        self.estimate = self.estimate.max(starts.into_iter().min().unwrap_or(NEVER));
        table
    }

    /// Keeps the table for another walk, unless many like it would take too much memory.
    fn keep_table(&mut self, table: Box<Table<Cost>>) {
        const SMALL: usize = 4 << 20;
        if table.bytes() <= SMALL || self.scope.starts.len() > 1 {
            self.table = Some(table);
        }
    }
}

fn piece_table(problem: &Problem<'_>, scope: &Scope) -> Table<Cost> {
    let (graph, budget) = (of_pieces(problem, scope), problem.share(TABLE_BUDGET / 2));
    Table::new(graph.into(), problem.window.clone(), budget, |toll| toll.cost)
}

/// The least cost of a run from each of the first pieces of `scope`.
fn estimates(table: &mut Table<Cost>, problem: &Problem<'_>, scope: &Scope) -> Vec<Cost> {
    // A first piece may be wider than any that is joined, so its row need not be in the block of the least length. From
    // the widest on, each block is made once.
    let mut order: Vec<usize> = (0..scope.starts.len()).collect();
    order.sort_by_key(|&i| Reverse(problem.widths[scope.starts[i].0]));
    let mut estimates = vec![NEVER; order.len()];
    for i in order {
        let (piece, cost) = scope.starts[i];
        let length = problem.widths[piece];
        table.load(length);
        estimates[i] = table.at(length, piece).saturating_add(cost);
    }
    estimates
}
