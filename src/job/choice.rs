//! Which of the sequences that meet the constraints are taken: the cheapest, the k cheapest, or random ones.

use std::collections::BTreeSet;

use super::plan::{Plan, PlanError, PlanOptions, Prospect, SEED_SPREAD, finish, first_fit, problem_of, why};
use crate::pieces::{Catalogue, Piece};
use crate::solver::{self, Census, Problem, Random, Solution, Tally, Unsolved, canonical};
use crate::topology::Shape;

/// Which sequences are taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Choice {
    /// The cheapest.
    #[default]
    Cheapest,
    /// So many of the cheapest, none twice.
    Best(usize),
    /// Different ones at random.
    Drawn {
        /// The same seed draws the same sequences.
        seed: u64,
        /// How many.
        count: usize,
        /// T: a sequence is drawn with a probability in proportion to exp(−cost/T).
        temperature: f64,
    },
}

/// The temperature when none is asked for, in units of the cost, in which a jump costs λ = 1: a jump that is not
/// needed then is about e⁻⁶ as likely as none, and with a dozen to choose from at each cut there is one in some
/// thirty pieces.
pub const DEFAULT_TEMPERATURE: f64 = 0.16;
/// The work of counting sequences beside the cheapest, so that a report takes no longer than a part of a second more.
const COUNTING_EFFORT: usize = 4_000_000;
/// The same beside many sequences: a second.
const LONG_COUNTING_EFFORT: usize = 20_000_000;
/// Additions at which sequences are not drawn exactly: a second or two.
const DRAWING_EFFORT: usize = 150_000_000;
/// How often a sequence is drawn again when it was drawn before.
const REDRAWS: usize = 40;

/// Sequences, and what is known of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The sequences: by cost, or in the order in which they were drawn.
    pub plans: Vec<Plan>,
    /// How many sequences meet the constraints within the accepted lengths, if that was asked for.
    pub sequences: Option<Tally>,
    /// Whether random sequences were drawn from all that there are with their exact probabilities. Otherwise each is
    /// the cheapest when every jump costs a random part more, the more the higher the temperature.
    pub is_exact: Option<bool>,
}

/// The sequences of `catalogue` for `options` that `choice` takes; with `counted`, all are counted.
///
/// # Errors
/// As [`super::plan`]; [`PlanError::TooLarge`] also when there is too much to list the k cheapest.
pub fn choose(
    catalogue: &Catalogue,
    options: &PlanOptions,
    choice: Choice,
    counted: bool,
) -> Result<Chosen, PlanError> {
    chosen(catalogue, options, choice, counted, Prospect::UNKNOWN)
        .map_err(|error| why(catalogue, options, error))
}

/// The same, without a reason where there is none.
pub(super) fn chosen(
    catalogue: &Catalogue,
    options: &PlanOptions,
    choice: Choice,
    counted: bool,
    prospect: Prospect<'_>,
) -> Result<Chosen, Unsolved> {
    let cheapest = first_fit(catalogue, options, prospect)?;
    let problem = problem_of(catalogue, options, cheapest.epsilon);
    let effort = if choice == Choice::Cheapest { COUNTING_EFFORT } else { LONG_COUNTING_EFFORT };
    let count = || solver::tally(&problem, options.goal, Some(&cheapest.sequence), effort);
    let sequences = counted.then(count);
    let epsilon = cheapest.epsilon;
    let to_plan = |solution: Solution| finish(catalogue, options, solution, epsilon);
    let (plans, is_exact) = match choice {
        Choice::Cheapest => (vec![cheapest], None),
        Choice::Best(k) => (best(catalogue, &problem, options, k)?.into_iter().map(to_plan).collect(), None),
        Choice::Drawn { seed, count, temperature } => {
            let census = Census::new(&problem, options.goal, temperature, DRAWING_EFFORT);
            let is_exact = census.is_some();
            let plans = match census {
                Some(census) => {
                    let drawn = draw(census, seed, count, Seen::new(catalogue, options.shape));
                    let solution = |sequence: Vec<usize>| Solution {
                        cost: problem.cost_of(&sequence).unwrap_or_default(),
                        sequence,
                        gap: 0,
                        labels: cheapest.labels,
                        states: cheapest.states,
                    };
                    let plans = drawn.into_iter().map(|sequence| to_plan(solution(sequence)));
                    plans.map(|plan| Plan { gap: None, ..plan }).collect()
                }
                None => perturbed(catalogue, options, (seed, count), temperature)?,
            };
            (plans, Some(is_exact))
        }
    };
    Ok(Chosen { plans, sequences, is_exact })
}

/// Sequences that were met, by what they look like.
struct Seen {
    shape: Shape,
    /// For each piece the first that looks like it.
    looks: Vec<usize>,
    sequences: BTreeSet<Vec<usize>>,
}

impl Seen {
    /// None yet.
    fn new(catalogue: &Catalogue, shape: Shape) -> Self {
        /// Pieces that differ by less make the same files.
        const ALIKE_MM: f64 = 1e-3;
        let pieces = catalogue.pieces();
        let first_like = |piece: &Piece| pieces.iter().position(|other| other.looks_like(piece, ALIKE_MM));
        let looks = pieces.iter().map(|piece| first_like(piece).expect("a piece is like itself")).collect();
        Self { shape, looks, sequences: BTreeSet::new() }
    }

    /// Whether nothing that looks the same was met before.
    fn is_new(&mut self, sequence: &[usize]) -> bool {
        let looks: Vec<usize> = sequence.iter().map(|&piece| self.looks[piece]).collect();
        self.sequences.insert(canonical(&looks, self.shape))
    }
}

/// The `k` cheapest sequences that look different.
fn best(
    catalogue: &Catalogue,
    problem: &Problem<'_>,
    options: &PlanOptions,
    k: usize,
) -> Result<Vec<Solution>, Unsolved> {
    /// Sequences that are listed for each that is wanted, at most.
    const MOST_LISTED: usize = 16;
    let mut listed = k;
    loop {
        let found = solver::best(problem, options.goal, listed);
        let (found, is_last) = match found {
            Err(Unsolved::TooLarge { .. }) if listed > k => (solver::best(problem, options.goal, k)?, true),
            found => (found?, listed >= MOST_LISTED * k),
        };
        let is_all = found.len() < listed;
        let mut seen = Seen::new(catalogue, options.shape);
        let different: Vec<Solution> =
            found.into_iter().filter(|solution| seen.is_new(&solution.sequence)).take(k).collect();
        if different.len() == k || is_all || is_last {
            return Ok(different);
        }
        listed *= 2;
    }
}

/// Up to `count` different sequences.
fn draw(mut census: Census<'_>, seed: u64, count: usize, mut seen: Seen) -> Vec<Vec<usize>> {
    let mut random = Random::new(seed);
    let mut drawn = Vec::new();
    for _ in 0..count.saturating_mul(REDRAWS) {
        let Some(sequence) = census.draw(&mut random).filter(|_| drawn.len() < count) else { break };
        if seen.is_new(&sequence) {
            drawn.push(sequence);
        }
    }
    drawn
}

/// Up to `count` different sequences, each the cheapest when every jump costs a random part more: the more, the higher the
/// temperature, and the more sequences were found before.
fn perturbed(
    catalogue: &Catalogue,
    options: &PlanOptions,
    (seed, count): (u64, usize),
    temperature: f64,
) -> Result<Vec<Plan>, Unsolved> {
    /// Seeds that are tried for each sequence.
    const TRIES: usize = 8;
    /// By how much the random part grows when it has led to a sequence that is known.
    const GROWTH: f64 = 1.15;
    let mut seed_spread = SEED_SPREAD * temperature / DEFAULT_TEMPERATURE;
    let mut random = Random::new(seed);
    let mut seen = Seen::new(catalogue, options.shape);
    let mut plans = Vec::new();
    for _ in 0..count.saturating_mul(TRIES) {
        if plans.len() == count {
            break;
        }
        let options = PlanOptions { seed: Some(random.bits()), seed_spread, ..*options };
        let found = first_fit(catalogue, &options, Prospect::UNKNOWN)?;
        if seen.is_new(&found.sequence) {
            plans.push(found);
        } else {
            seed_spread *= GROWTH;
        }
    }
    Ok(plans)
}
