//! How the time and memory of a search grow: with the length, with the pieces of the exemplar, with its portals.
//!
//!     cargo bench --bench scaling [-- --plot docs/pictures/scaling.svg]
//!
//! Lengths are those of bands along a line from exemplars of the repository, planned as a job plans them; pieces
//! and portals are those of exemplars made from seeds ([`instances`]), of each size the first three that can make
//! one component. All bands are of one component. The figures are medians.

mod instances;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use instances::{Instance, Sizes};
use openwork::exemplar::{Exemplar, Limits, ReadOptions};
use openwork::job::{DEFAULT_MEMORY_LIMIT, PlanOptions, SEED_SPREAD, plan};
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::Tolerances;
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};
use openwork::solver::{Problem, Unsolved, solve};
use openwork::topology::{Goal, Shape};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const HEIGHT_MM: f64 = 14.0;

/// One point of a curve.
struct Point {
    size: f64,
    ms: f64,
    mib: f64,
}

/// A curve: what it is of, and its points.
type Curve = (String, Vec<Point>);

fn main() {
    let mut arguments = std::env::args().skip_while(|a| a != "--plot").skip(1);
    let panels = [
        (
            "pieces out",
            vec![by_length("filigree", 100_000), by_length("lace", 100_000), by_length("vine", 100_000)],
        ),
        ("pieces in", vec![by_size("pieces in", &[10, 20, 40, 70, 100, 200, 400], |n| (n, 6, 200))]),
        ("portals", vec![by_size("portals", &[2, 4, 6, 8, 12, 16, 20, 24], |m| (100, m, 100))]),
    ];
    if let Some(file) = arguments.next() {
        std::fs::write(&file, plot(&panels)).expect("the plot can be written");
    }
}

fn one_component() -> Goal {
    Goal { components: Some(1.into()), ..Goal::default() }
}

/// Searches for bands of 100 to at most so many pieces.
fn by_length(exemplar: &str, most: usize) -> Curve {
    println!(
        "\n| {exemplar}: pieces out | length (m) | time (ms) | us for a piece | peak (MiB) | labels | states | gap |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let catalogue = catalogue(exemplar);
    let mean_mm = catalogue.width_mm() / catalogue.pieces().len() as f64;
    let lengths = [100, 1_000, 10_000, 100_000].into_iter().filter(|&pieces| pieces <= most);
    let points = lengths.filter_map(|pieces_out: usize| {
        let options = PlanOptions {
            shape: Shape::Open,
            length_mm: pieces_out as f64 * mean_mm,
            height_mm: HEIGHT_MM,
            goal: one_component(),
            weights: CostWeights::default(),
            seed: None,
            seed_spread: SEED_SPREAD,
            variety: None,
            memory_limit: DEFAULT_MEMORY_LIMIT,
            effort: None,
        };
        let (plan, ms, mib) = take(|| plan(&catalogue, &options));
        let plan = match plan {
            Ok(plan) => plan,
            Err(error) => {
                println!("| {pieces_out} wanted | | {ms:.0} | | {mib:.1} | {error:?} | |");
                return None;
            }
        };
        let made = plan.sequence.len();
        println!(
            "| {made} | {:.2} | {ms:.2} | {:.2} | {mib:.1} | {} | {} | {:?} |",
            options.length_mm / 1e3,
            ms * 1e3 / made as f64,
            plan.labels,
            plan.states,
            plan.gap.unwrap_or(f64::NAN)
        );
        Some(Point { size: made as f64, ms, mib })
    });
    (exemplar.to_owned(), points.collect())
}

fn catalogue(exemplar: &str) -> Catalogue {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/exemplars/{exemplar}.svg"));
    let options = ReadOptions {
        chord_mm: 0.25 * Tolerances::DEFAULT_CHORD_MM,
        target_height_mm: Some(HEIGHT_MM),
        limits: Limits::default(),
    };
    let exemplar = Exemplar::read(&file, &options).expect("the fixtures can be read");
    let (low, high) = exemplar.region().bounds_mm().expect("the fixtures have ink");
    let rule = SlicingRule::reeb_for_width(high.x - low.x);
    let region = exemplar.region();
    let slicing = Slicing::new(region, &ReebGraph::new(region), rule, &Tolerances::default());
    Catalogue::new(region, &slicing.expect("the fixtures can be cut").cuts, &CostWeights::default())
}

/// Searches exemplars of several sizes; `sizes` gives the pieces in, the portals, and the pieces out.
fn by_size(what: &str, values: &[usize], sizes: fn(usize) -> (usize, usize, usize)) -> Curve {
    const EXEMPLARS: usize = 3;
    println!("\n| {what} | time (ms) | slowest (ms) | peak (MiB) | labels | states | optimal |");
    println!("|---|---|---|---|---|---|---|");
    let mut points = Vec::new();
    for &value in values {
        let (pieces, portals, pieces_out) = sizes(value);
        let mut taken = Vec::new();
        for seed in 1.. {
            let instance = Instance::new(Sizes { pieces, portals, seed });
            let length = (pieces_out as f64 * instance.mean_width()) as u32;
            let problem = Problem { memory_limit: 1 << 30, ..instance.problem(Shape::Open, length) };
            match take(|| solve(&problem, one_component())) {
                (Ok(solution), ms, mib) => taken.push((ms, mib, solution)),
                (Err(Unsolved::Infeasible), ..) => continue,
                (Err(error), ms, mib) => {
                    println!("| {value} | {ms:.1} | | {mib:.1} | {error} | | |");
                    return ("one component".to_owned(), points);
                }
            }
            if taken.len() == EXEMPLARS {
                break;
            }
        }
        taken.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (ms, mib, solution) = &taken[EXEMPLARS / 2];
        println!(
            "| {value} | {ms:.2} | {:.2} | {mib:.1} | {} | {} | {} of {EXEMPLARS} |",
            taken[EXEMPLARS - 1].0,
            solution.labels,
            solution.states,
            taken.iter().filter(|(_, _, s)| s.gap == 0).count()
        );
        points.push(Point { size: value as f64, ms: *ms, mib: *mib });
    }
    ("one component".to_owned(), points)
}

/// Runs a search several times, or once if it is slow: what it found, the median time in ms, the peak in MiB.
fn take<T>(search: impl Fn() -> T) -> (T, f64, f64) {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let begin = Instant::now();
    let mut answer = black_box(search());
    let mut times = vec![begin.elapsed()];
    let peak = ALLOCATOR.peak_usage().saturating_sub(before);
    while times.len() < 11 && begin.elapsed().as_secs_f64() < 1.0 {
        let start = Instant::now();
        answer = black_box(search());
        times.push(start.elapsed());
    }
    times.sort_unstable();
    (answer, times[times.len() / 2].as_secs_f64() * 1e3, peak as f64 / f64::from(1 << 20))
}

/// The curves as SVG: a panel for each, with logarithmic axes; time in full, memory in dashes.
fn plot(panels: &[(&str, Vec<Curve>)]) -> String {
    const SIDE: f64 = 220.0;
    const COLOURS: [&str; 3] = ["#1b6ca8", "#c2571a", "#3c8d40"];
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} 320\" font-family=\"sans-serif\" \
         font-size=\"11\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        panels.len() as f64 * (SIDE + 70.0) + 20.0
    );
    let points = || panels.iter().flat_map(|(_, curves)| curves.iter().flat_map(|(_, points)| points));
    let top = points().map(|p| p.ms.max(p.mib).log10()).fold(0.0, f64::max).ceil();
    let bottom = points().map(|p| p.ms.min(p.mib).log10()).fold(0.0, f64::min).floor();
    for (number, (what, curves)) in panels.iter().enumerate() {
        let left = number as f64 * (SIDE + 70.0) + 55.0;
        let sizes = || curves.iter().flat_map(|(_, points)| points.iter().map(|p| p.size.log10()));
        let (low, high) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
        let x = |size: f64| left + (size.log10() - low) / (high - low) * SIDE;
        let y = |value: f64| 20.0 + (top - value.log10()) / (top - bottom) * SIDE;
        for decade in bottom as i32..=top as i32 {
            let (at, value) = (y(10f64.powi(decade)), 10f64.powi(decade));
            out += &format!(
                "<path d=\"M{left:.1} {at:.1}h{SIDE}\" stroke=\"#ddd\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>\n",
                left - 5.0,
                at + 4.0
            );
        }
        for (colour, (name, points)) in curves.iter().enumerate() {
            let colour = COLOURS[colour % COLOURS.len()];
            for (value, dashes) in
                [(|p: &Point| p.ms) as fn(&Point) -> f64, |p| p.mib].iter().zip(["", "5 4"])
            {
                let line: Vec<String> =
                    points.iter().map(|p| format!("{:.1},{:.1}", x(p.size), y(value(p)))).collect();
                out += &format!(
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" \
                     stroke-dasharray=\"{dashes}\"/>\n",
                    line.join(" ")
                );
            }
            let at = 36.0 + 14.0 * curves.iter().position(|(n, _)| n == name).unwrap_or(0) as f64;
            out += &format!("<text x=\"{:.1}\" y=\"{at}\" fill=\"{colour}\">{name}</text>\n", left + 8.0);
        }
        let longest = curves.iter().map(|(_, points)| points).max_by_key(|points| points.len());
        for p in longest.into_iter().flatten() {
            out += &format!(
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n",
                x(p.size),
                SIDE + 36.0,
                p.size
            );
        }
        let middle = left + SIDE / 2.0;
        out +=
            &format!("<text x=\"{middle:.1}\" y=\"{}\" text-anchor=\"middle\">{what}</text>\n", SIDE + 56.0);
    }
    out + "<text x=\"55\" y=\"306\">full lines: time in ms; dashes: peak memory in MiB</text>\n</svg>\n"
}
