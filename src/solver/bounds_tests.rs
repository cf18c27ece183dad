//! Every estimate against enumeration: none says more than completing a run costs, and none that a run cannot be
//! completed when it can be; where one is said to be exact, it is.
//!
//! The problems are the same each time, and each estimate must have been made, and have said something, so often.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::classes::{CLASS_SIZES, Classes};
use super::coarse::bounds;
use super::connected::Connected;
use super::connectivity::{Connectivity, Counts, NODE_LIMIT};
use super::counts::{Caps, Ranges, counts, ranges};
use super::estimates::{Estimates, Level};
use super::family::{Family, families, scopes};
use super::graph::{Scope, of_pieces};
use super::lengths::{has_level_run, lengths, stays_in_band};
use super::problem::{Cost, Problem};
use super::reach::{is_never, is_out_of_range};
use super::sample_problems::{AMPLE, Runs, for_samples};
use super::table::NEVER;
use crate::topology::{Automaton, Goal, Shape, StateId, Topology};

/// What a search knows of a run: length, last piece, state and drift.
type Label = (u32, usize, StateId, i32);

/// How often an estimate was made, how often it was finite, and how often more than 0.
type Tally = RefCell<BTreeMap<&'static str, [usize; 3]>>;

/// One goal of a problem: everything that the estimates are held against.
struct Case<'a> {
    problem: &'a Problem<'a>,
    runs: &'a Runs,
    goal: Goal,
    /// What completing each run costs at least.
    rests: Vec<Cost>,
    /// The state of each run that is not dead.
    states: Vec<Option<StateId>>,
    tally: &'a Tally,
}

impl<'a> Case<'a> {
    fn new(
        problem: &'a Problem<'a>,
        runs: &'a Runs,
        automaton: &mut Automaton<'a>,
        tally: &'a Tally,
    ) -> Result<Self, TestCaseError> {
        let goal = automaton.goal();
        let states = runs.along(|before: Option<&Option<StateId>>, run| match before {
            None => automaton.start(run.piece),
            Some(state) => state.and_then(|state| automaton.step(state, run.piece)),
        });
        let rests = runs.rests(problem, goal);
        for ((run, &state), &rest) in runs.all().iter().zip(&states).zip(&rests) {
            prop_assert!(state.is_some() || rest == NEVER, "a dead state of {run:?} for {goal:?}");
            if let (Some(state), Some((_, topology))) = (state, run.stop) {
                prop_assert_eq!(automaton.accepts(state), goal.admits(topology), "{:?} for {:?}", run, goal);
            }
        }
        Ok(Self { problem, runs, goal, rests, states, tally })
    }

    /// The least that completing a run costs of those in the band that a search does not tell apart, in one scope.
    fn labels(&self, scope: &Scope) -> BTreeMap<Label, Cost> {
        let mut labels = BTreeMap::new();
        let runs = self.runs.all().iter().zip(&self.states).zip(&self.rests);
        for ((run, state), &rest) in runs.filter(|((run, _), _)| run.is_in_band) {
            if let Some(state) = state.filter(|_| scope.starts.iter().any(|&(p, _)| p == run.first)) {
                let least = labels.entry((run.length, run.piece, state, run.drift)).or_insert(NEVER);
                *least = rest.min(*least);
            }
        }
        labels
    }

    /// That no label has a greater estimate than what completing one of its runs costs, or another if it `is_exact`.
    fn check(
        &self,
        name: &'static str,
        labels: &BTreeMap<Label, Cost>,
        is_exact: bool,
        mut rest: impl FnMut(u32, usize, StateId, Option<i32>) -> Cost,
    ) -> Result<(), TestCaseError> {
        let mut said = [1, 0, 0];
        for (&(length, piece, state, drift), &least) in labels {
            for known in [None, Some(drift)] {
                let found = rest(length, piece, state, known);
                let is_true = found <= least && (found == least || !is_exact || known.is_none());
                prop_assert!(
                    is_true,
                    "{} says {} instead of {} of {:?} with drift {:?} for {:?} of {:?}",
                    name,
                    found,
                    least,
                    (length, piece, state),
                    known,
                    self.goal,
                    self.problem
                );
                said[1] += usize::from(found != NEVER);
                said[2] += usize::from(found != NEVER && found > 0);
            }
        }
        let mut tally = self.tally.borrow_mut();
        let sums = tally.entry(name).or_default();
        sums.iter_mut().zip(said).for_each(|(sum, n)| *sum += n);
        Ok(())
    }

    /// The estimates of a family at each of `levels`, one after the other.
    fn check_levels(
        &self,
        automaton: &mut Automaton<'_>,
        family: &mut Family,
        levels: &[Level],
    ) -> Result<(), TestCaseError> {
        let Self { problem, goal, .. } = *self;
        let labels = self.labels(&family.scope);
        let is_open = problem.shape == Shape::Open;
        let is_level = self.runs.all().iter().all(|run| run.is_in_band);
        for &level in levels {
            family.learn(problem, automaton, level);
            let knows_all =
                is_open && problem.memory_limit == AMPLE && (goal.is_free() || family.estimates.is_exact());
            let is_exact = knows_all
                && match level {
                    Level::Drift => true,
                    _ => is_level && !goal.is_free(),
                };
            let name = match level {
                Level::Pieces | Level::Topology => "topology",
                Level::Fine => "fine",
                Level::Prices => "prices",
                Level::Drift => "drift",
            };
            self.check_estimates(name, automaton, &labels, is_exact, &mut family.estimates)?;
            if family.estimates.learn_more(problem, automaton, &family.scope) {
                self.check_estimates("learned more", automaton, &labels, is_exact, &mut family.estimates)?;
            }
            family.look_again(problem, automaton);
            self.check_members(family)?;
        }
        Ok(())
    }

    fn check_estimates(
        &self,
        name: &'static str,
        automaton: &Automaton<'_>,
        labels: &BTreeMap<Label, Cost>,
        is_exact: bool,
        estimates: &mut Estimates,
    ) -> Result<(), TestCaseError> {
        self.check(name, labels, is_exact, |length, piece, state, drift| {
            estimates.load(length);
            estimates.rest(self.problem, automaton, (length, piece, state, drift))
        })
    }

    /// That each member through which there is a run is there, and that no run of it costs less than it says.
    fn check_members(&self, family: &mut Family) -> Result<(), TestCaseError> {
        let Self { problem, runs, rests, .. } = self;
        for (first, _) in family.scope.starts.clone() {
            let least = runs.least(rests, |p| p == first);
            let is_of = |member: usize| family.members[member].scope.starts.iter().any(|&(p, _)| p == first);
            let Some(member) = (0..family.members.len()).find(|&m| is_of(m)) else {
                prop_assert_eq!(least, NEVER, "a member with {} has been dropped for {:?}", first, self.goal);
                continue;
            };
            let mut table = family.take_table(problem, member);
            let member_estimate = family.members[member].estimate;
            prop_assert!(member_estimate <= least, "{} of {} for {:?}", member_estimate, first, self.goal);
            for (run, &rest) in runs.all().iter().zip(rests).filter(|(run, _)| run.first == first) {
                table.load(run.length);
                prop_assert!(
                    table.at(run.length, run.piece) <= rest,
                    "pieces, after {run:?} for {:?}",
                    self.goal
                );
            }
            family.keep_table(member, table);
        }
        let least = family.scope.starts.iter().map(|&(first, _)| runs.least(rests, |p| p == first)).min();
        prop_assert!(family.estimate() <= least.unwrap_or(NEVER));
        Ok(())
    }

    /// The estimate by classes of each size by itself, and as it is chosen, however small it has to be.
    fn check_classes(&self, automaton: &Automaton<'_>, scope: &Scope) -> Result<(), TestCaseError> {
        /// Nodes: of next to nothing, of some of these problems, and of all.
        const LIMITS: [usize; 3] = [8, 40, 6_000];
        let Self { problem, goal, .. } = *self;
        let labels = self.labels(scope);
        let names = ["classes of 1", "classes of 2", "classes of 4", "classes of all"];
        let sized =
            CLASS_SIZES.iter().zip(names).flat_map(|(&size, name)| LIMITS.map(|limit| (name, limit, size)));
        for (name, limit, size) in sized {
            for has_prices in [false, true] {
                if let Some(classes) = Classes::of_size(problem, goal, scope, limit, size) {
                    self.check_grown(name, automaton, scope, &labels, (classes, has_prices))?;
                }
            }
        }
        for [few, more] in [[LIMITS[0], LIMITS[1]], [LIMITS[1], LIMITS[2]]] {
            let coarser = Classes::new(problem, goal, scope, few, None);
            if let Some(classes) = Classes::new(problem, goal, scope, more, coarser) {
                self.check_grown("classes as chosen", automaton, scope, &labels, (classes, false))?;
            }
        }
        Ok(())
    }

    /// The estimates that give components and holes a price, before and after they know that of the rise.
    fn check_connected(&self, automaton: &Automaton<'_>, scope: &Scope) -> Result<(), TestCaseError> {
        let Self { problem, goal, .. } = *self;
        let labels = self.labels(scope);
        let mut states = Automaton::new(problem.descriptors, goal, problem.shape);
        if let Some(connected) = Connected::new(problem, goal, scope, NODE_LIMIT) {
            let mut estimates = Estimates::of_connected(connected);
            self.check_estimates("counts at a price", automaton, &labels, false, &mut estimates)?;
            estimates.learn_prices(problem, &mut states, scope);
            self.check_estimates("counts and rise at a price", automaton, &labels, false, &mut estimates)?;
        }
        Ok(())
    }

    /// These classes, as they learn of the states that are met, before or after they know prices, and of the drift.
    fn check_grown(
        &self,
        name: &'static str,
        automaton: &Automaton<'_>,
        scope: &Scope,
        labels: &BTreeMap<Label, Cost>,
        (classes, has_prices): (Classes, bool),
    ) -> Result<(), TestCaseError> {
        let problem = self.problem;
        let mut states = Automaton::new(problem.descriptors, self.goal, problem.shape);
        let mut estimates = Estimates::of_classes(classes);
        let names = match has_prices {
            false => [name, "grown classes"],
            true => {
                estimates.learn_prices(problem, &mut states, scope);
                ["classes at a price", "grown classes at a price"]
            }
        };
        self.check_estimates(names[0], automaton, labels, false, &mut estimates)?;
        if estimates.learn_more(problem, automaton, scope) {
            self.check_estimates(names[1], automaton, labels, false, &mut estimates)?;
        }
        estimates.learn_drift(problem, &mut states, scope);
        self.check_estimates("classes and drift", automaton, labels, false, &mut estimates)
    }

    /// That of two states at one place, one that dominates costs no more to complete.
    fn check_dominance(&self, automaton: &Automaton<'_>) -> Result<(), TestCaseError> {
        let mut places: BTreeMap<(usize, u32, usize, i32), BTreeMap<StateId, Cost>> = BTreeMap::new();
        for ((run, &state), &rest) in self.runs.all().iter().zip(&self.states).zip(&self.rests) {
            if let Some(state) = state.filter(|_| run.is_in_band) {
                let place = places.entry((run.first, run.length, run.piece, run.drift)).or_default();
                place.insert(state, rest);
            }
        }
        let mut pairs = 0;
        for place in places.values() {
            for (&a, &of_a) in place {
                for (&b, &of_b) in place.iter().filter(|&(&b, _)| b != a && automaton.dominates(a, b)) {
                    prop_assert!(of_a <= of_b, "{a:?} for {b:?}, {of_a} for {of_b}: {:?}", self.goal);
                    pairs += 1;
                }
            }
        }
        self.tally.borrow_mut().entry("dominated").or_default()[0] += pairs;
        Ok(())
    }

    /// That what is said to be impossible is, whatever the drift; of an open run, that all else is possible.
    fn check_reach(&self, scope: &Scope) -> Result<(), TestCaseError> {
        let Self { problem, goal, .. } = *self;
        let is_first = |p: usize| scope.starts.iter().any(|&(first, _)| first == p);
        let met = || self.runs.complete(problem).filter(|(run, _)| is_first(run.first)).map(|(_, t)| t);
        let can_be = met().any(|topology| goal.admits(topology));
        let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
        let (never, out_of_range) =
            (is_never(problem, &mut automaton, scope), is_out_of_range(problem, goal, scope));
        prop_assert!(!(can_be && never), "{goal:?} is possible");
        prop_assert!(!(can_be && out_of_range), "{goal:?} is in range");
        let is_open = problem.shape == Shape::Open;
        prop_assert!(!is_open || out_of_range != can_be, "{goal:?} is out of range");
        let mut tally = self.tally.borrow_mut();
        tally.entry("never").or_default()[0] += usize::from(never);
        tally.entry("out of range").or_default()[0] += usize::from(out_of_range);
        Ok(())
    }
}

/// That counts and their ranges are those of all runs of a scope, whatever their drift; in a ring, at least those.
fn check_counts(problem: &Problem<'_>, runs: &Runs, scope: &Scope) -> Result<(), TestCaseError> {
    let is_first = |p: usize| scope.starts.iter().any(|&(first, _)| first == p);
    let met: Vec<Topology> =
        runs.complete(problem).filter(|(run, _)| is_first(run.first)).map(|(_, t)| t).collect();
    let coarse = bounds(problem, scope);
    prop_assert!(coarse.is_some() || met.is_empty());
    if let Some(Ranges { least, most }) = coarse {
        let is_within = |t: &Topology| {
            (least.components..=most.components).contains(&t.components)
                && (least.holes..=most.holes).contains(&t.holes)
        };
        prop_assert!(met.iter().all(is_within), "{least:?} to {most:?} by pieces alone: {met:?}");
    }
    let by_piece = Connectivity::new(problem, Goal::default(), scope, NODE_LIMIT);
    let of_kinds = Connectivity::of_kinds(problem, Goal::default(), scope, NODE_LIMIT);
    let [by_piece, of_kinds] = [by_piece, of_kinds].map(|graph| graph.expect("the problem is small"));
    prop_assert!(of_kinds.len() <= by_piece.len());
    check_counts_of(problem, &met, &by_piece)?;
    check_counts_of(problem, &met, &of_kinds)
}

/// That a graph tells the counts of the runs that were `met`; in a ring, at least those.
fn check_counts_of(
    problem: &Problem<'_>,
    met: &[Topology],
    graph: &Connectivity,
) -> Result<(), TestCaseError> {
    let is_open = problem.shape == Shape::Open;
    let found = ranges(problem, graph);
    prop_assert!(found.is_some() || met.is_empty());
    prop_assert!(found.is_none() || !is_open || !met.is_empty());
    let ends = |of: fn(&Topology) -> u32| (met.iter().map(of).min(), met.iter().map(of).max());
    if let (Some(range), (Some(few), Some(many)), (Some(low), Some(high))) =
        (found, ends(|t| t.components), ends(|t| t.holes))
    {
        let told = [
            range.least.components,
            few,
            many,
            range.most.components,
            range.least.holes,
            low,
            high,
            range.most.holes,
        ];
        prop_assert!(told[..4].is_sorted() && told[4..].is_sorted(), "{told:?}");
        prop_assert!(
            !is_open || (told[0], told[2], told[4], told[6]) == (told[1], told[3], told[5], told[7]),
            "{told:?}"
        );
    }
    for (components, holes) in
        [(None, None), (Some(4), None), (None, Some(150)), (Some(4), Some(150)), (Some(90), Some(3))]
    {
        let set =
            counts(problem, graph, Caps { components, holes }, usize::MAX).expect("the problem is small");
        let read =
            |counts: Counts| (components.map_or(0, |_| counts.components), holes.map_or(0, |_| counts.holes));
        let had: BTreeSet<(u32, u32)> =
            met.iter().map(|t| read(Counts { components: t.components, holes: t.holes })).collect();
        for at in 0..=components.unwrap_or(0) {
            for hole in 0..=holes.unwrap_or(0) {
                let (is_told, is_had) =
                    (set.has(Counts { components: at, holes: hole }), had.contains(&(at, hole)));
                prop_assert!(is_told || !is_had, "{at} with {hole} of {components:?}, {holes:?}");
                prop_assert!(
                    is_had || !is_told || !is_open,
                    "no {at} with {hole} of {components:?}, {holes:?}"
                );
            }
        }
    }
    Ok(())
}

/// That lengths and whether any run stays in the band are told as they are, of all runs and of each member.
fn check_lengths(problem: &Problem<'_>, runs: &Runs) -> Result<(), TestCaseError> {
    let longest = *problem.window.end();
    let had: BTreeSet<u32> =
        runs.all().iter().filter(|run| run.stop.is_some()).map(|run| run.length).collect();
    prop_assert_eq!(lengths(problem, longest), had);
    let stays = |first: Option<usize>| {
        let of_it = runs.complete(problem).filter(|(run, _)| first.is_none_or(|first| run.first == first));
        of_it.into_iter().any(|(run, _)| run.is_in_band)
    };
    let is_known = problem.drift_limit <= 4096;
    prop_assert_eq!(stays_in_band(problem).filter(|_| is_known), is_known.then(|| stays(None)));
    for member in families(problem, false).iter().flat_map(|family| &family.members) {
        let scope = &member.scope;
        let starts = scope.starts.iter().map(|&(piece, _)| (piece, problem.widths[piece]));
        let found = has_level_run(problem, &of_pieces(problem, scope), starts);
        let first = (problem.shape == Shape::Ring).then(|| scope.starts[0].0);
        prop_assert_eq!(found, is_known.then(|| stays(first)));
    }
    Ok(())
}

/// Random problems, each with four goals.
const CASES: u32 = 300;
/// Levels in the orders in which a search may come to them.
const ORDERS: [&[Level]; 3] = [
    &[Level::Topology, Level::Fine, Level::Prices, Level::Drift],
    &[Level::Fine, Level::Drift],
    &[Level::Prices, Level::Drift],
];

#[test]
fn no_estimate_says_more_than_completing_a_run_costs() {
    let tally = Tally::default();
    for_samples(CASES, |sample| {
        let (problem, runs) = sample.enumerated();
        for goal in sample.goals(&problem, &runs) {
            let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
            let case = Case::new(&problem, &runs, &mut automaton, &tally)?;
            for levels in ORDERS {
                for mut family in families(&problem, goal.closed_pattern) {
                    case.check_levels(&mut automaton, &mut family, levels)?;
                }
            }
            for scope in scopes(&problem, goal.closed_pattern) {
                case.check_classes(&automaton, &scope)?;
                case.check_connected(&automaton, &scope)?;
            }
        }
        Ok(())
    });
    let tally = tally.into_inner();
    let names = ["topology", "fine", "prices", "drift", "classes of 1", "classes of 2"];
    let more = ["classes of 4", "classes of all", "classes as chosen", "grown classes", "classes at a price"];
    for name in names
        .into_iter()
        .chain(more)
        .chain(["grown classes at a price", "classes and drift"])
        .chain(["counts at a price", "counts and rise at a price"])
    {
        let [made, _, positive] = tally.get(name).copied().unwrap_or_default();
        assert!(made >= 20 && positive >= 1_000, "{name}: {made} made, {positive} times above 0");
    }
}

#[test]
fn what_is_told_apart_or_ruled_out_is_so() {
    let tally = Tally::default();
    for_samples(CASES, |sample| {
        let (problem, runs) = sample.enumerated();
        check_lengths(&problem, &runs)?;
        for scope in scopes(&problem, false) {
            check_counts(&problem, &runs, &scope)?;
        }
        for goal in sample.goals(&problem, &runs) {
            let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
            let case = Case::new(&problem, &runs, &mut automaton, &tally)?;
            case.check_dominance(&automaton)?;
            for scope in scopes(&problem, goal.closed_pattern) {
                case.check_reach(&scope)?;
            }
        }
        Ok(())
    });
    let tally = tally.into_inner();
    for (name, [found, ..]) in tally {
        assert!(found >= 300, "{name}: {found}");
    }
}
