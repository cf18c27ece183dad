//! What the way of slicing does to a band: the table of `docs/slicing.md`.
//!
//!     cargo run --release --example slicing_table -- [--pictures FOLDER] [--least PART] EXEMPLAR.svg...
//!
//! Each exemplar, scaled to a height of 20 mm, is cut by events of at least several persistences, given in parts of
//! its width W, and at as many equally spaced lines as the default gives. Each catalogue makes a band of 240 mm, of
//! whatever topology and of one component. The longest repeat is the longest run of pieces that occurs twice, in
//! parts of the number of pieces. `--least 0.001` leaves out smaller persistences, which take minutes where a drawing
//! has pieces of a few micrometres. Without arguments it shows one small exemplar.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Duration;

use openwork::analysis::Analysis;
use openwork::exemplar::{Exemplar, ReadOptions};
use openwork::job::{Band, BandBuilder, BandReport, JobError, Output, READ_SHARE, SlicingChoice};
use openwork::pieces::CostWeights;
use openwork::planar::Tolerances;
use openwork::reeb::SlicingRule;

const HEIGHT_MM: f64 = 20.0;
const PARTS: [f64; 7] = [0.0, 0.001, 0.002, 0.003, 0.005, 0.01, 0.02];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let mut option = |name: &str| {
        let at =
            arguments.iter().position(|a| a.as_os_str() == name).filter(|at| at + 1 < arguments.len())?;
        arguments.drain(at..at + 2).nth(1)
    };
    let pictures = option("--pictures");
    let least: f64 = option("--least").map_or(Ok(0.0), |part| part.to_string_lossy().parse())?;
    let is_short = arguments.is_empty();
    if is_short {
        arguments.push("fixtures/exemplars/wave.svg".into());
    }
    println!(
        "| exemplar | slicing | pieces | narrowest (mm) | jumps | cost per 100 mm | longest repeat | pieces used | worst seam (deg) | solve (ms) | 1 component: jumps, cost | solve (ms) |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for file in &arguments {
        let options = ReadOptions {
            target_height_mm: Some(HEIGHT_MM),
            chord_mm: Tolerances::DEFAULT_CHORD_MM * READ_SHARE,
            ..ReadOptions::default()
        };
        let exemplar = Exemplar::read(file, &options)?;
        let (low, high) = exemplar.region().bounds_mm().unwrap_or_default();
        let width_mm = high.x - low.x;
        let parts = if is_short { &PARTS[2..4] } else { &PARTS[..] };
        for &part in parts.iter().filter(|&&part| part >= least) {
            let slicing = SlicingChoice::Persistence(part * width_mm);
            row(file, &exemplar, &format!("{part} W"), slicing, pictures.as_deref())?;
        }
        let rule = SlicingRule::reeb_for_width(width_mm);
        let lines = Analysis::new(&exemplar, Some(rule), &Tolerances::default(), &CostWeights::default())?;
        let lines = lines.cuts.len();
        let slicing = SlicingChoice::Uniform(lines);
        row(file, &exemplar, &format!("uniform:{lines}"), slicing, pictures.as_deref())?;
    }
    Ok(())
}

fn row(
    file: &Path,
    exemplar: &Exemplar,
    label: &str,
    slicing: SlicingChoice,
    pictures: Option<&Path>,
) -> Result<(), Box<dyn Error>> {
    let name = exemplar.name();
    let rule = match slicing {
        SlicingChoice::Uniform(lines) => SlicingRule::Uniform { lines },
        SlicingChoice::Persistence(persistence_mm) => SlicingRule::Reeb { persistence_mm },
        SlicingChoice::Reeb => unreachable!("every row has its own threshold"),
    };
    let analysis = Analysis::new(exemplar, Some(rule), &Tolerances::default(), &CostWeights::default());
    let Ok(analysis) = analysis else {
        println!("| {name} | {label} | no cuts | | | | | | | | | |");
        return Ok(());
    };
    let widths: Vec<f64> = analysis.pieces.iter().map(|p| p.width_mm).collect();
    let narrowest = widths.iter().copied().fold(f64::INFINITY, f64::min);
    print!("| {name} | {label} | {} | {narrowest:.3} |", widths.len());
    let picture =
        pictures.map(|folder| folder.join(format!("{name}-{}.png", label.replace([' ', ':'], "_"))));
    match band(file, slicing, None, picture.as_deref())? {
        Some((band, report)) => {
            let sequence = &band.plan().sequence;
            let repeat = longest_repeat(sequence).len() as f64;
            let mut used = sequence.clone();
            used.sort_unstable();
            used.dedup();
            print!(
                " {} | {:.2} | {:.2} | {:.0} % | {:.1} | {:.0} |",
                report.seams.jumps,
                report.cost / report.length_mm * 100.0,
                repeat / widths.len() as f64,
                used.len() as f64 / widths.len() as f64 * 100.0,
                report.seams.worst_angle_after_deg,
                solve_time(&report).as_secs_f64() * 1e3
            );
        }
        None => print!(" refused | | | | | |"),
    }
    match band(file, slicing, Some(1), None)? {
        Some((_, report)) => println!(
            " {}, {:.2} | {:.0} |",
            report.seams.jumps,
            report.cost / report.length_mm * 100.0,
            solve_time(&report).as_secs_f64() * 1e3
        ),
        None => println!(" refused | |"),
    }
    Ok(())
}

/// A verified band; `None` when the constraints cannot be met.
fn band(
    file: &Path,
    slicing: SlicingChoice,
    components: Option<u32>,
    picture: Option<&Path>,
) -> Result<Option<(Band, BandReport)>, Box<dyn Error>> {
    let mut builder = BandBuilder::new(file, "line:240mm".parse()?).width_mm(HEIGHT_MM).slicing(slicing);
    if let Some(components) = components {
        builder = builder.components(components);
    }
    let band = match builder.build()?.run(&mut |_| {}) {
        Ok(band) => band,
        Err(JobError::Refused(_) | JobError::SearchTooLarge { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let outputs: Vec<Output> = picture.map(Output::file).transpose()?.into_iter().collect();
    let report = band.write(&outputs, None, &mut |_| {})?;
    Ok(Some((band, report)))
}

fn solve_time(report: &BandReport) -> Duration {
    let solve = report.made.times.iter().find(|t| t.stage == "solve");
    Duration::from_secs_f64(solve.map_or(0.0, |t| t.milliseconds / 1e3))
}

/// The longest run of pieces that occurs twice.
fn longest_repeat(sequence: &[usize]) -> &[usize] {
    let n = sequence.len();
    let mut best = (0, 0);
    let mut lengths = vec![0usize; n + 1];
    for i in (0..n).rev() {
        // In place: lengths[j] is that of the runs at i + 1 and j until it becomes that at i and j.
        for j in i + 1..n {
            lengths[j] = if sequence[i] == sequence[j] { lengths[j + 1] + 1 } else { 0 };
            if lengths[j] > best.1 {
                best = (i, lengths[j]);
            }
        }
    }
    &sequence[best.0..best.0 + best.1]
}
