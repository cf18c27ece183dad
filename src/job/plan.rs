//! From a catalogue in millimetres to a search problem in whole numbers, and back to a plan.

use crate::pieces::{Catalogue, CostWeights, Piece};
use crate::solver::{self, Cost, Problem, Refusal, Solution, Step, Unsolved, Variety};
use crate::topology::{Goal, Shape};

/// What is asked of the sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanOptions {
    /// Open run or ring.
    pub shape: Shape,
    /// The arc length L in millimetres.
    pub length_mm: f64,
    /// The height H of the band in millimetres, the offset of a piece stays within half of it, up or down.
    pub height_mm: f64,
    /// The topology.
    pub goal: Goal,
    /// The weights with which the catalogue was made.
    pub weights: CostWeights,
    /// A seed varies the cost of each jump, so that another seed gives another band near the optimum; without
    /// one the optimum itself is found.
    pub seed: Option<u64>,
    /// How much the seed adds to the cost of a jump at most, in units of λ: [`SEED_SPREAD`] or another number. Beyond that,
    /// what is more is added to natural joins as well.
    pub seed_spread: f64,
    /// The penalty on repetition.
    pub variety: Option<Variety>,
    /// The memory that the search may take, in bytes, before it gives optimality up.
    pub memory_limit: usize,
    /// The partial runs that it may look at before it does; `None` for as many as take a few seconds, and more the
    /// longer the run is.
    pub effort: Option<usize>,
}

/// A sequence of pieces that meets the constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The pieces in order.
    pub sequence: Vec<usize>,
    /// The cost by Zhou 2014 §3.6.1 with jumps, without what a seed adds.
    pub cost: f64,
    /// How much less a sequence that meets the constraints could cost at most. 0 is the optimum; `None` says
    /// nothing, as a seed or the variety term was asked for.
    pub gap: Option<f64>,
    /// ε: the lengths that were accepted are those within this part of L.
    pub epsilon: f64,
    /// The length of the pieces before they are stretched to L, in millimetres.
    pub natural_length_mm: f64,
    /// Labels that the search made.
    pub labels: usize,
    /// Distinct states of the automaton that it met.
    pub states: usize,
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq)]
pub enum PlanError {
    /// The constraints cannot be met, and why.
    Refused {
        /// The constraint.
        refusal: Refusal,
        /// The length of a bin in millimetres, for lengths in the refusal.
        bin_mm: f64,
    },
    /// The search was given up.
    TooLarge {
        /// Labels made until then.
        labels: usize,
    },
}

/// The first ε is the paper's (Zhou 2014 §3.5); it is widened until a sequence is found. Beyond the last, the
/// stretching would show.
pub(super) const EPSILONS: [f64; 4] = [0.05, 0.1, 0.2, 0.3];
/// The smallest bin, as a part of the narrowest piece: smaller, and the search takes longer for a length no truer.
const BIN: f64 = 0.75;
/// Each piece has at least one bin, so large bins lengthen the narrow pieces. They may not lengthen the exemplar by
/// more than this part: a band may use mostly narrow ones, and misses its length by several times as much.
const BIN_ERROR: f64 = 0.004;
/// What bins grow by when larger ones are tried.
const BIN_STEP: f64 = 1.2;
/// The most bins in a band: beyond, bins grow and lengths are less true, which the report shows.
const MOST_BINS: f64 = 400_000.0;
/// Units of drift in the height of the band.
const DRIFT_UNITS: f64 = 64.0;
/// How much a seed adds to the cost of a jump when nothing else is asked for, in units of λ. Less, and many seeds give the
/// optimum again; more, and bands cost more without being more different.
pub const SEED_SPREAD: f64 = 2.0;
/// The λ that this part is taken of when λ is smaller, so that a seed has an effect without λ too.
const LEAST_SEEDED_JUMP: f64 = 0.1;
/// The partial runs that a search looks at when nothing else is asked for, at least, and for each bin of the length. Five
/// times as many took five times as long for answers of the same cost wherever optimality was given up.
const DEFAULT_EFFORT: usize = 4_000_000;
const EFFORT_PER_BIN: usize = 500;
/// The memory that a search may take when nothing else is asked for, in bytes.
pub const DEFAULT_MEMORY_LIMIT: usize = 2 << 30;

/// The best sequence of `catalogue` for `options`.
///
/// # Errors
/// [`PlanError`] when the constraints cannot be met or the search is too large.
pub fn plan(catalogue: &Catalogue, options: &PlanOptions) -> Result<Plan, PlanError> {
    first_fit(catalogue, options, Prospect::UNKNOWN).map_err(|error| why(catalogue, options, error))
}

/// Why there is no sequence, when [`first_fit`] found none.
pub(super) fn why(catalogue: &Catalogue, options: &PlanOptions, error: Unsolved) -> PlanError {
    if let Unsolved::TooLarge { labels } = error {
        return PlanError::TooLarge { labels };
    }
    let bin_mm = bin_mm(catalogue, options.length_mm);
    let widest = EPSILONS.iter().rev().find_map(|&epsilon| window(options.length_mm, epsilon, bin_mm));
    let mut problem = problem(catalogue, options, bin_mm);
    // A window without a whole number of bins stands for its middle.
    let middle = (options.length_mm / bin_mm).round().max(1.0) as u32;
    problem.window = widest.unwrap_or(middle..=middle);
    let longest = (problem.window.end() * 2).max((catalogue.width_mm() * 2.0 / bin_mm) as u32);
    // What is too long to be used here is as long as it is when other lengths are asked for.
    problem.widths = catalogue.pieces().iter().map(|piece| bins(piece, bin_mm)).collect();
    PlanError::Refused { refusal: solver::explain(&problem, options.goal, longest), bin_mm }
}

/// Whether no sequence of `catalogue` meets the goal for any ε, as far as that is found out soon.
pub(super) fn is_impossible(catalogue: &Catalogue, options: &PlanOptions) -> bool {
    let bin_mm = bin_mm(catalogue, options.length_mm);
    let [.., last] = EPSILONS;
    window(options.length_mm, last, bin_mm).is_some_and(|window| {
        solver::is_impossible(&Problem { window, ..problem(catalogue, options, bin_mm) }, options.goal)
    })
}

/// What is thought of a search before it, which decides where it begins.
#[derive(Clone, Copy)]
pub(super) enum Prospect<'a> {
    /// Nothing speaks against a sequence, so the least ε comes first. When there is none soon, the function is asked
    /// whether it is hopeless: whether there is none for any ε.
    Open(&'a dyn Fn() -> bool),
    /// A part of what may be joined was not enough, so there is likely none, and the widest ε comes first.
    Poor,
}

impl Prospect<'_> {
    /// Nothing speaks against a sequence, and nothing but the search can tell.
    pub(super) const UNKNOWN: Self = Self::Open(&|| false);
}

/// The best sequence for the least ε with which one was found. Where a search for a lesser one was given up, there may be
/// others.
pub(super) fn first_fit(
    catalogue: &Catalogue,
    options: &PlanOptions,
    prospect: Prospect<'_>,
) -> Result<Plan, Unsolved> {
    let bin_mm = bin_mm(catalogue, options.length_mm);
    let mut problem = problem(catalogue, options, bin_mm);
    let is_hopeless = match prospect {
        Prospect::Open(is_hopeless) => is_hopeless,
        Prospect::Poor => &|| false,
    };
    let mut within = |epsilon: f64| {
        // No whole number of bins may lie so close to a short length.
        problem.window = window(options.length_mm, epsilon, bin_mm).ok_or(Unsolved::Infeasible)?;
        solver::solve_unless(&problem, options.goal, is_hopeless).map(|solution| (solution, epsilon))
    };
    let [first, .., last] = EPSILONS;
    let mut narrower = &EPSILONS[..EPSILONS.len() - 1];
    let mut found = Err(Unsolved::Infeasible);
    if let Prospect::Open(_) = prospect {
        found = within(first);
        narrower = &narrower[1..];
    }
    if found == Err(Unsolved::Infeasible) && !is_hopeless() {
        // What cannot be had within the last cannot be had within any, so that refusals come soon.
        found = within(last);
        if found != Err(Unsolved::Infeasible) {
            // One that was given up closer to the length leaves the others.
            let closer = narrower.iter().find_map(|&epsilon| within(epsilon).ok());
            found = closer.map_or(found, Ok);
        }
    }
    found.map(|(solution, epsilon)| finish(catalogue, options, solution, epsilon))
}

pub(super) fn finish(catalogue: &Catalogue, options: &PlanOptions, solution: Solution, epsilon: f64) -> Plan {
    let Solution { sequence, cost, gap, labels, states } = solution;
    let cost = match options.seed {
        None => cost as f64 / 1e6,
        Some(_) => {
            let unseeded = PlanOptions { seed: None, ..*options };
            let true_cost =
                problem(catalogue, &unseeded, bin_mm(catalogue, options.length_mm)).cost_of(&sequence);
            true_cost.unwrap_or(cost) as f64 / 1e6
        }
    };
    let natural_length_mm = sequence.iter().map(|&p| catalogue.pieces()[p].width_mm).sum();
    let gap = (options.seed.is_none() && options.variety.is_none()).then_some(gap as f64 / 1e6);
    Plan { sequence, cost, gap, epsilon, natural_length_mm, labels, states }
}

/// The search problem with the lengths within ε of L.
pub(super) fn problem_of<'a>(catalogue: &'a Catalogue, options: &PlanOptions, epsilon: f64) -> Problem<'a> {
    let bin_mm = bin_mm(catalogue, options.length_mm);
    let mut problem = problem(catalogue, options, bin_mm);
    if let Some(window) = window(options.length_mm, epsilon, bin_mm) {
        problem.window = window;
    }
    problem
}

fn bin_mm(catalogue: &Catalogue, length_mm: f64) -> f64 {
    let widths = || catalogue.pieces().iter().map(|p| p.width_mm);
    let (narrowest, whole) = (widths().fold(f64::INFINITY, f64::min), widths().sum::<f64>());
    let error = |bin_mm: f64| {
        let bins: u32 = catalogue.pieces().iter().map(|p| bins(p, bin_mm)).sum();
        (f64::from(bins) * bin_mm / whole - 1.0).abs()
    };
    let mean = whole / catalogue.pieces().len() as f64;
    let mut bin_mm = narrowest * BIN;
    while bin_mm * BIN_STEP < mean / 2.0 && error(bin_mm * BIN_STEP) <= BIN_ERROR {
        bin_mm *= BIN_STEP;
    }
    bin_mm.max(length_mm / MOST_BINS)
}

/// The width of a piece in bins. Both of its ends are rounded, so that errors do not add up along the exemplar.
fn bins(piece: &Piece, bin_mm: f64) -> u32 {
    let whole = |mm: f64| (mm / bin_mm).round() as u32;
    (whole(piece.x_mm + piece.width_mm) - whole(piece.x_mm)).max(1)
}

fn window(length_mm: f64, epsilon: f64, bin_mm: f64) -> Option<std::ops::RangeInclusive<u32>> {
    let low = (length_mm * (1.0 - epsilon) / bin_mm).ceil();
    let high = (length_mm * (1.0 + epsilon) / bin_mm).floor();
    (low <= high).then_some(low as u32..=high as u32)
}

fn problem<'a>(catalogue: &'a Catalogue, options: &PlanOptions, bin_mm: f64) -> Problem<'a> {
    let pieces = catalogue.pieces();
    let micro = |cost: f64| (cost * 1e6).round() as Cost;
    // A piece that is longer than any run may be is as good as one that just does not fit.
    let length_bins = (options.length_mm / bin_mm) as usize;
    let too_long = 2 * length_bins as u32 + 2;
    let widths = pieces.iter().map(|p| bins(p, bin_mm).min(too_long)).collect();
    let unit_mm = options.height_mm / DRIFT_UNITS;
    let unit = options.weights.jump.max(LEAST_SEEDED_JUMP);
    let (of_jumps, of_natural) =
        (options.seed_spread * unit, (options.seed_spread - SEED_SPREAD).max(0.0) * unit);
    let steps = catalogue
        .joins()
        .iter()
        .enumerate()
        .map(|(from, joins)| {
            joins
                .iter()
                .map(|join| {
                    let spread = if join.is_natural { of_natural } else { of_jumps };
                    let extra = options.seed.map_or(0.0, |seed| spread * noise(seed, from, join.to));
                    let rise = (join.rise_mm / unit_mm).round() as i32;
                    Step { to: join.to, cost: micro(join.cost + extra), rise }
                })
                .collect()
        })
        .collect();
    // Only the exemplar's own ends are no jumps.
    let end_cost = |is_own: bool| match is_own {
        true => Some(0),
        false => (!catalogue.has_own_ends_only()).then(|| micro(options.weights.jump)),
    };
    let begin = pieces
        .iter()
        .enumerate()
        .map(|(i, p)| if p.left.is_empty() { end_cost(catalogue.is_own_begin(i)) } else { None });
    let end = pieces
        .iter()
        .enumerate()
        .map(|(i, p)| if p.right.is_empty() { end_cost(catalogue.is_own_end(i)) } else { None });
    Problem {
        shape: options.shape,
        descriptors: catalogue.descriptors(),
        widths,
        steps,
        begin: begin.collect(),
        end: end.collect(),
        window: 0..=0,
        drift_limit: (DRIFT_UNITS / 2.0) as i32,
        variety: options.variety,
        memory_limit: options.memory_limit,
        effort_limit: options.effort.unwrap_or_else(|| DEFAULT_EFFORT.max(length_bins * EFFORT_PER_BIN)),
    }
}

/// A number in 0..1 that depends on all three arguments (the finaliser of SplitMix64).
fn noise(seed: u64, from: usize, to: usize) -> f64 {
    let mut z = seed ^ ((from as u64) << 32 | to as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
        z = (z ^ (z >> 30)).wrapping_mul(factor);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::super::builder::BandBuilder;
    use super::super::cut::{read_exemplar, slice};
    use super::*;

    // Wherever the search begins, it comes to the least ε of all; also where nothing can be had.
    #[test]
    fn the_least_epsilon_is_found_from_either_end() {
        // Few holes leave few lengths.
        let job = BandBuilder::new("fixtures/exemplars/lattice.svg", "line:60mm".parse().unwrap())
            .components(1)
            .holes(8)
            .build()
            .unwrap();
        let cut = slice(&job, read_exemplar(&job).unwrap()).unwrap();
        let mut met = Vec::new();
        for length_mm in (4..60).map(f64::from) {
            let options = PlanOptions {
                shape: Shape::Open,
                length_mm,
                height_mm: cut.height_mm,
                goal: job.options.goal,
                weights: job.options.weights,
                seed: None,
                seed_spread: SEED_SPREAD,
                variety: None,
                memory_limit: DEFAULT_MEMORY_LIMIT,
                effort: None,
            };
            let ascending = EPSILONS.into_iter().find_map(|epsilon| {
                let found = solver::solve(&problem_of(&cut.catalogue, &options, epsilon), options.goal);
                Some((found.ok()?.cost, epsilon))
            });
            for prospect in [Prospect::UNKNOWN, Prospect::Poor] {
                let found = first_fit(&cut.catalogue, &options, prospect);
                let found = found.ok().map(|plan| ((plan.cost * 1e6).round() as Cost, plan.epsilon));
                assert_eq!(found, ascending, "{length_mm} mm");
            }
            met.push(ascending.map(|(_, epsilon)| epsilon));
            // What is thought to be hopeless is not looked for beyond the first ε.
            let hopeless = first_fit(&cut.catalogue, &options, Prospect::Open(&|| true));
            assert!(hopeless.is_err() || ascending.is_some_and(|(_, epsilon)| epsilon == EPSILONS[0]));
        }
        assert!(
            met.contains(&None) && EPSILONS.iter().all(|&epsilon| met.contains(&Some(epsilon))),
            "{met:?}"
        );
    }
}
