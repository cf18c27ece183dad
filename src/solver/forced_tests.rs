//! The search against enumeration with estimates that small problems do not come to by themselves: each level from
//! the start or soon after, drifts told apart from the start, classes in the place of all pairs of piece and state.
//!
//! Excluded: the search as it begins by itself, which the tests of the whole room hold against enumeration.

use std::cell::Cell;

use proptest::prelude::*;

use super::cheapest::cheapest_from;
use super::classes::{CLASS_SIZES, Classes};
use super::estimates::{Estimates, Level};
use super::family::Family;
use super::problem::{Problem, Solution, Unsolved};
use super::sample_problems::{AMPLE, Runs, for_samples};
use super::table::NEVER;
use crate::topology::{Automaton, Goal};

/// That the search has the cost of the cheapest run, and a run of that cost, or none where there is none.
fn check(
    problem: &Problem<'_>,
    runs: &Runs,
    goal: Goal,
    found: Result<Solution, Unsolved>,
    how: &str,
) -> Result<bool, TestCaseError> {
    let least = runs.least(&runs.rests(problem, goal), |_| true);
    match found {
        Ok(solution) => {
            let made = runs.made(problem, &solution.sequence);
            let is_valid = made.is_some_and(|(cost, t)| cost == solution.cost && goal.admits(t));
            prop_assert!(is_valid, "{how}: {solution:?} made {made:?} for {goal:?}");
            let is_best = solution.cost >= least && solution.cost - solution.gap <= least;
            prop_assert!(is_best, "{how}: {solution:?} instead of {least} for {goal:?} of {problem:?}");
            prop_assert!(solution.gap == 0 || problem.memory_limit < AMPLE, "{how}: {solution:?}");
        }
        Err(Unsolved::Infeasible) => prop_assert_eq!(least, NEVER, "{} for {:?} of {:?}", how, goal, problem),
        Err(Unsolved::TooLarge { .. }) => prop_assert!(problem.memory_limit < AMPLE, "{how}"),
    }
    Ok(least != NEVER)
}

/// Effort that no small problem takes.
const NEVER_SOON: usize = 1 << 40;
/// Random problems, each with four goals.
const CASES: u32 = 500;
const LEVELS: [Level; 4] = [Level::Topology, Level::Fine, Level::Prices, Level::Drift];

#[test]
fn estimates_of_any_level_lead_to_the_optimum() {
    let solved = Cell::new(0);
    for_samples(CASES, |sample| {
        let (problem, runs) = sample.enumerated();
        for goal in sample.goals(&problem, &runs) {
            for level in LEVELS {
                for (by_drift, short) in [(false, NEVER_SOON), (true, NEVER_SOON), (false, 0), (true, 0)] {
                    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
                    let found = cheapest_from(&problem, &mut automaton, (level, by_drift, short), |_, _| {});
                    let how = format!("{level:?}, {by_drift}, {short}");
                    solved.set(solved.get() + usize::from(check(&problem, &runs, goal, found, &how)?));
                }
            }
        }
        Ok(())
    });
    assert!(solved.get() >= 8_000, "{} have a run", solved.get());
}

/// Knowing which counts a run may still come to leads to the optimum, and where no run comes to what is wanted, whatever
/// its drift, nothing is searched.
#[test]
fn completions_lead_to_the_optimum() {
    let (solved, refused) = (Cell::new(0), Cell::new(0));
    for_samples(CASES, |sample| {
        let (problem, runs) = sample.enumerated();
        let goals = sample.goals(&problem, &runs);
        for goal in goals.into_iter().filter(|goal| goal.components.is_some() || goal.holes.is_some()) {
            let force = |family: &mut Family, automaton: &mut Automaton<'_>| {
                let scope = family.scope.clone();
                family.estimates.learn_completions(&problem, goal, &scope, 1);
                family.look_again(&problem, automaton);
                refused.set(refused.get() + usize::from(family.members.is_empty()));
            };
            let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
            let from = (Level::Topology, false, NEVER_SOON);
            let found = cheapest_from(&problem, &mut automaton, from, force);
            solved.set(solved.get() + usize::from(check(&problem, &runs, goal, found, "completions")?));
        }
        Ok(())
    });
    assert!(solved.get() >= 500 && refused.get() >= 100, "{} have a run, {}", solved.get(), refused.get());
}

#[test]
fn classes_lead_to_the_optimum() {
    let (solved, made) = (Cell::new(0), Cell::new(0));
    for_samples(CASES, |sample| {
        let (problem, runs) = sample.enumerated();
        let goals = sample.goals(&problem, &runs);
        for goal in goals.into_iter().filter(|goal| goal.is_one_component()) {
            for (size, limit) in CLASS_SIZES.into_iter().zip([20, 100, 6_000, 6_000]) {
                for (level, by_drift) in [(Level::Fine, false), (Level::Prices, true), (Level::Drift, true)] {
                    let force = |family: &mut Family, automaton: &mut Automaton<'_>| {
                        let scope = family.scope.clone();
                        let Some(classes) = Classes::of_size(&problem, goal, &scope, limit, size) else {
                            return;
                        };
                        made.set(made.get() + 1);
                        family.estimates = Estimates::of_classes(classes);
                        if level >= Level::Prices {
                            family.estimates.learn_prices(&problem, automaton, &scope);
                        }
                        if level == Level::Drift {
                            family.estimates.learn_drift(&problem, automaton, &scope);
                        }
                        family.level = level;
                        family.look_again(&problem, automaton);
                    };
                    let mut automaton = Automaton::new(problem.descriptors, goal, problem.shape);
                    let found = cheapest_from(&problem, &mut automaton, (level, by_drift, NEVER_SOON), force);
                    let how = format!("classes of {size}, {level:?}");
                    solved.set(solved.get() + usize::from(check(&problem, &runs, goal, found, &how)?));
                }
            }
        }
        Ok(())
    });
    assert!(
        solved.get() >= 2_000 && made.get() >= 5_000,
        "{} have a run, {} classes",
        solved.get(),
        made.get()
    );
}
