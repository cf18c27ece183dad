//! Zhou 2014 Table 1, again: problems of the same sizes as its rows, searched by the solver and by the paper's
//! table as printed ([`reference`]).
//!
//!     cargo bench --bench table1 [-- ROW]
//!
//! The paper gives the pieces of each exemplar and of each result; the exemplars are made from seeds
//! ([`instances`]) and the length is such that the optimum has about as many pieces as the row. All rows want one
//! component; the ones that the paper marks as cyclic are rings with a closed pattern. Both searches get the same
//! joins, lengths and drifts. The penalty on repetition, which the paper's times include, is left out in both.

mod instances;
mod reference;

use std::hint::black_box;
use std::time::{Duration, Instant};

use instances::{Instance, Sizes};
use openwork::solver::{Problem, Solution, solve};
use openwork::topology::{Goal, Shape};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// A row of Table 1, and the portals of the exemplar that stands for the row's own.
struct Row {
    name: &'static str,
    shape: Shape,
    pieces: usize,
    pieces_out: usize,
    portals: usize,
    printed_s: f64,
    printed_paths: usize,
}

const fn row(
    name: &'static str,
    shape: Shape,
    (pieces, pieces_out, portals): (usize, usize, usize),
    (printed_s, printed_paths): (f64, usize),
) -> Row {
    Row { name, shape, pieces, pieces_out, portals, printed_s, printed_paths }
}

const ROWS: [Row; 11] = [
    row("Figure 13, 1", Shape::Open, (11, 56, 3), (0.13, 29)),
    row("Figure 13, 2", Shape::Open, (14, 74, 4), (1.3, 81)),
    row("Figure 13, 3", Shape::Open, (14, 109, 5), (9.9, 465)),
    row("Figure 13, 4", Shape::Open, (13, 65, 5), (2.2, 157)),
    row("Figure 13, 5", Shape::Open, (15, 70, 4), (1.2, 148)),
    row("Figure 13, 6", Shape::Open, (10, 75, 4), (0.78, 134)),
    row("Figure 1 (left)", Shape::Ring, (20, 147, 4), (62.1, 110)),
    row("Chair side (circle)", Shape::Ring, (18, 190, 5), (143.0, 1422)),
    row("Chair foot", Shape::Open, (12, 130, 4), (8.3, 205)),
    row("Chair back (axis 1)", Shape::Open, (15, 64, 2), (0.007, 1)),
    row("Chair back (axis 2)", Shape::Open, (14, 102, 6), (5.9, 64)),
];

/// What a search took.
struct Taken<T> {
    answer: T,
    median: Duration,
    peak_bytes: usize,
}

fn main() {
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    println!(
        "| row | | pieces in, out | portals | paper | search | peak | labels | states | reference | peak | entries | correct paths (paper) | faster than reference, paper | cost: search, reference | reference without counting holes |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut sum = Duration::ZERO;
    for row in &ROWS {
        if wanted.as_ref().is_none_or(|w| row.name.contains(w.as_str())) {
            sum += print(row);
        }
    }
    println!("\nAll searches: {} ms", ms(sum));
}

/// Searches a row's problem both ways; the time of the search.
fn print(row: &Row) -> Duration {
    let goal = Goal { components: Some(1.into()), holes: None, closed_pattern: row.shape == Shape::Ring };
    let (instance, length) = instance(row, goal);
    let problem = instance.problem(row.shape, length);
    let ours = take(31, || solve(&problem, goal));
    let solution = ours.answer.expect("the row was made so that it can be met");
    let plain = take(3, || reference::solve(&problem, goal, true));
    let lean = take(3, || reference::solve(&problem, goal, false));
    let [found, lean_found] = [&plain.answer, &lean.answer];
    let cost_of = |found: &reference::Found| match &found.best {
        Some((sequence, cost)) => {
            assert_eq!(problem.cost_of(sequence), Some(*cost));
            let rule = if stays_in_band(&problem, sequence) { "" } else { " (drifts)" };
            assert!(solution.cost <= *cost || !rule.is_empty(), "the reference is cheaper");
            format!("{:.3}{rule}", *cost as f64 / 1e6)
        }
        None if found.is_cut_short => "given up".to_owned(),
        None => "none".to_owned(),
    };
    assert_eq!(solution.gap, 0, "the search is exact");
    let times = |other: f64| format!("{:.0}", other / ours.median.as_secs_f64());
    println!(
        "| {} | {} | {}, {} | {} | {} | {} ms | {} | {} | {} | {} ms | {} | {} | {} ({}) | {}, {} | {:.3}, {} | {} ms, {}, {} |",
        row.name,
        if row.shape == Shape::Ring { "ring" } else { "open" },
        problem.pieces(),
        solution.sequence.len(),
        row.portals,
        if row.printed_s < 0.1 {
            format!("{} ms", row.printed_s * 1e3)
        } else {
            format!("{} s", row.printed_s)
        },
        ms(ours.median),
        bytes(ours.peak_bytes),
        solution.labels,
        solution.states,
        ms(plain.median),
        bytes(plain.peak_bytes),
        found.entries,
        found.correct_paths,
        row.printed_paths,
        times(plain.median.as_secs_f64()),
        times(row.printed_s),
        solution.cost as f64 / 1e6,
        cost_of(found),
        ms(lean.median),
        times(lean.median.as_secs_f64()),
        cost_of(lean_found),
    );
    ours.median
}

/// The first exemplar of a row's sizes that can meet the goal, and the length at which the optimum has about as
/// many pieces as the row.
fn instance(row: &Row, goal: Goal) -> (Instance, u32) {
    for seed in 1.. {
        let instance = Instance::new(Sizes { pieces: row.pieces, portals: row.portals, seed });
        let mut length = row.pieces_out as f64 * instance.mean_width();
        for _ in 0..4 {
            let Ok(Solution { sequence, .. }) =
                solve(&instance.problem(row.shape, length.round() as u32), goal)
            else {
                break;
            };
            // Twenty times the exemplar's own length is no exemplar's fault; a run of one piece is.
            if sequence.len().abs_diff(row.pieces_out) * 25 <= row.pieces_out {
                return (instance, length.round() as u32);
            }
            length *= row.pieces_out as f64 / sequence.len() as f64;
        }
    }
    unreachable!("some seed makes a row")
}

/// Whether a sequence stays in the band as the solver measures it: a ring from one of its narrowest cuts.
fn stays_in_band(problem: &Problem<'_>, sequence: &[usize]) -> bool {
    let n = sequence.len();
    let left = |at: usize| problem.descriptors[sequence[at]].left().len();
    let narrowest = (0..n).map(left).min();
    let is_level = |first: usize| {
        let mut drift = 0i32;
        (first..first + n - 1).all(|at| {
            let steps = &problem.steps[sequence[at % n]];
            let step = steps.iter().find(|s| s.to == sequence[(at + 1) % n]);
            drift += step.map_or(0, |s| s.rise);
            drift.abs() <= problem.drift_limit
        })
    };
    match problem.shape {
        Shape::Open => is_level(0),
        Shape::Ring => (0..n).any(|at| Some(left(at)) == narrowest && is_level(at)),
    }
}

/// Runs a search so many times, or fewer if it is slow.
fn take<T>(most: usize, search: impl Fn() -> T) -> Taken<T> {
    const PATIENCE: Duration = Duration::from_secs(3);
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let start = Instant::now();
    let mut answer = black_box(search());
    let mut times = vec![start.elapsed()];
    let peak_bytes = ALLOCATOR.peak_usage().saturating_sub(before);
    while times.len() < most && start.elapsed() < PATIENCE {
        let start = Instant::now();
        answer = black_box(search());
        times.push(start.elapsed());
    }
    times.sort_unstable();
    Taken { answer, median: times[times.len() / 2], peak_bytes }
}

fn ms(time: Duration) -> String {
    let ms = time.as_secs_f64() * 1e3;
    if ms < 10.0 { format!("{ms:.2}") } else { format!("{ms:.0}") }
}

fn bytes(bytes: usize) -> String {
    match bytes as f64 / 1024.0 {
        kib if kib < 1024.0 => format!("{kib:.0} KiB"),
        kib => format!("{:.1} MiB", kib / 1024.0),
    }
}
