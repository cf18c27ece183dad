//! What `docs/samples.md` shows: the exemplars of `fixtures/samples` synthesized, completed, and made without parts of the method.
//!
//!     cargo run --release --example samples -- FOLDER
//!
//! writes the drawings (SVG), the sheets that show them (`samples-1.png`, `samples-2.png`, `samples-without.png`) and the plot of energies
//! (`samples-energies.svg`) to the folder, and prints the tables. Without a folder one exemplar is tried.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use openwork::job::{FillBuilder, FillReport, Output, SampleOptions, SampleStart, SampleWithout};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use usvg::Tree;

const EXEMPLARS: [&str; 6] = ["branches", "scales", "maze", "waves", "leaves", "rings"];
/// Two and a half times the area of an exemplar of 60 x 60 mm.
const DOMAIN: &str = "rect:100x90mm";
const SEED: u64 = 1;
/// For densities, of which one pattern has little to count.
const SEEDS: [u64; 5] = [1, 2, 3, 4, 5];

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        let report = made(&std::env::temp_dir(), "scales", "free", |fill| fill.levels(1))?;
        println!("{}: {} component(s), {} hole(s)", report.files.join(", "), report.components, report.holes);
        println!("name a folder for all of it");
        return Ok(());
    };
    std::fs::create_dir_all(&folder)?;
    let free: Vec<FillReport> =
        EXEMPLARS.iter().map(|name| made(&folder, name, "free", |fill| fill)).collect::<Result<_, _>>()?;
    densities(&folder, &free)?;
    exact(&folder, &free)?;
    without(&folder, &free)?;
    let noise = EXEMPLARS.iter().map(|name| {
        made(&folder, name, "noise", |fill| {
            fill.constants(SampleOptions {
                seed: SEED,
                start: SampleStart::Noise,
                ..SampleOptions::default()
            })
        })
    });
    let noise: Vec<FillReport> = noise.collect::<Result<_, _>>()?;
    energies(&[("from patches", &free), ("from noise", &noise)], &folder.join("samples-energies.svg"))?;
    for (number, names) in EXEMPLARS.chunks(3).enumerate() {
        let row =
            |name: &&str| vec![exemplar(name), drawn(&folder, name, "free"), drawn(&folder, name, "lace")];
        let rows: Vec<Vec<PathBuf>> = names.iter().map(row).collect();
        sheet(&rows, 3.0, &folder.join(format!("samples-{}.png", number + 1)))?;
    }
    const WAYS: [&str; 6] =
        ["free", "without-edges", "without-robust", "without-existence", "without-orientation", "noise"];
    let ways = |name: &str| WAYS.map(|what| drawn(&folder, name, what));
    let rows: Vec<Vec<PathBuf>> = ["branches", "leaves", "rings"]
        .iter()
        .flat_map(|name| ways(name).chunks(3).map(<[_]>::to_vec).collect::<Vec<_>>())
        .collect();
    sheet(&rows, 2.8, &folder.join("samples-without.png"))?;
    Ok(())
}

fn exemplar(name: &str) -> PathBuf {
    format!(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/samples/{}.svg"), name).into()
}

fn drawn(folder: &Path, name: &str, what: &str) -> PathBuf {
    folder.join(format!("{name}-{what}.svg"))
}

/// Drawings in rows on one picture, all at so many pixels to the millimetre.
fn sheet(rows: &[Vec<PathBuf>], pixels_per_mm: f32, file: &Path) -> Result<(), Box<dyn Error>> {
    const GAP: f32 = 18.0;
    let scale = pixels_per_mm * 25.4 / 96.0;
    let read = |file: &PathBuf| -> Result<Tree, Box<dyn Error>> {
        Ok(Tree::from_data(&std::fs::read(file)?, &usvg::Options::default())?)
    };
    let rows: Vec<Vec<Tree>> =
        rows.iter().map(|row| row.iter().map(read).collect::<Result<_, _>>()).collect::<Result<_, _>>()?;
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let cells = |column: usize| rows.iter().filter_map(move |row| row.get(column));
    let widths: Vec<f32> = (0..columns)
        .map(|column| cells(column).map(|tree| tree.size().width() * scale).fold(0.0, f32::max))
        .collect();
    let heights: Vec<f32> = rows
        .iter()
        .map(|row| row.iter().map(|tree| tree.size().height() * scale).fold(0.0, f32::max))
        .collect();
    let size = |lengths: &[f32]| (lengths.iter().sum::<f32>() + GAP * (lengths.len() + 1) as f32) as u32;
    let mut picture = Pixmap::new(size(&widths), size(&heights)).ok_or("no drawings")?;
    picture.fill(Color::WHITE);
    let mut y = GAP;
    for (row, height) in rows.iter().zip(&heights) {
        let mut x = GAP;
        for (tree, width) in row.iter().zip(&widths) {
            let left = x + (width - tree.size().width() * scale) / 2.0;
            let top = y + (height - tree.size().height() * scale) / 2.0;
            resvg::render(
                tree,
                Transform::from_row(scale, 0.0, 0.0, scale, left, top),
                &mut picture.as_mut(),
            );
            x += width + GAP;
        }
        y += height + GAP;
    }
    picture.save_png(file)?;
    println!("{}", file.display());
    Ok(())
}

/// An exemplar on the domain, with what `adapt` asks for, written as `NAME-WHAT.svg`.
fn made(
    folder: &Path,
    name: &str,
    what: &str,
    adapt: impl Fn(FillBuilder) -> FillBuilder,
) -> Result<FillReport, Box<dyn Error>> {
    let builder = adapt(FillBuilder::new(exemplar(name), DOMAIN.parse()?).seed(SEED));
    let fill = builder.build()?.run(&mut |_| {})?;
    Ok(fill.write(&[Output::file(drawn(folder, name, what))?], None, &mut |_| {})?)
}

/// Counts for each 100 cm2 beside the exemplar's, the means of several seeds.
fn densities(folder: &Path, free: &[FillReport]) -> Result<(), Box<dyn Error>> {
    println!("| exemplar | ends | in the pattern | components | in the pattern | holes | in the pattern |");
    println!("|---|---|---|---|---|---|---|");
    for (name, report) in EXEMPLARS.iter().zip(free) {
        let learnt = &report.exemplar_density;
        let mut found = [0.0; 3];
        for seed in SEEDS {
            let seeded = made(folder, name, "seeded", |fill| fill.seed(seed))?.density;
            for (sum, one) in found.iter_mut().zip([seeded.dangling_ends, seeded.components, seeded.holes]) {
                *sum += one / SEEDS.len() as f64;
            }
        }
        let pair = |a: f64, b: f64| match a > 0.0 {
            true => format!("{a:.0} | {b:.0} ({:+.0} %)", (b / a - 1.0) * 100.0),
            false => format!("{a:.0} | {b:.0}"),
        };
        println!(
            "| {name} | {} | {} | {} |",
            pair(learnt.dangling_ends, found[0]),
            pair(learnt.components, found[1]),
            pair(learnt.holes, found[2])
        );
    }
    println!();
    Ok(())
}

/// Exact counts, with what was changed for them.
fn exact(folder: &Path, free: &[FillReport]) -> Result<(), Box<dyn Error>> {
    println!("| exemplar | as it comes | asked for | found | changes |");
    println!("|---|---|---|---|---|");
    for (name, report) in EXEMPLARS.iter().zip(free) {
        let lace = made(folder, name, "lace", |fill| fill.components(1).frame_mm(1.6))?;
        let both = made(folder, name, "both", |fill| fill.components(1).holes(12))?;
        for (asked, made) in [("1 component, in a frame", lace), ("1 component, 12 holes", both)] {
            let mut kinds: Vec<(&str, usize)> = Vec::new();
            for change in &made.changes {
                match kinds.iter_mut().find(|kind| kind.0 == change.kind) {
                    Some(kind) => kind.1 += 1,
                    None => kinds.push((change.kind, 1)),
                }
            }
            let mut kinds: Vec<String> =
                kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
            kinds.extend(made.bridges.as_ref().map(|bridges| format!("{} bridges", bridges.bridges.len())));
            println!(
                "| {name} | {}, {} | {asked} | {}, {} | {} |",
                report.components,
                report.holes,
                made.components,
                made.holes,
                kinds.join(", ")
            );
        }
    }
    println!();
    Ok(())
}

/// The ablations of Tu 2020 §5.2.
fn without(folder: &Path, free: &[FillReport]) -> Result<(), Box<dyn Error>> {
    let parts: [(&str, SampleWithout); 4] = [
        ("edges", SampleWithout { edges: true, ..SampleWithout::default() }),
        ("robust", SampleWithout { robust: true, ..SampleWithout::default() }),
        ("existence", SampleWithout { existence: true, ..SampleWithout::default() }),
        ("orientation", SampleWithout { orientation: true, ..SampleWithout::default() }),
    ];
    println!("| exemplar | whole | without edges | without robust matching | without existence |");
    println!("|---|---|---|---|---|");
    let energy = |report: &FillReport| report.levels.last().map_or(0.0, |level| level.full_energy_per_sample);
    for (name, whole) in EXEMPLARS.iter().zip(free) {
        let mut cells = vec![format!("{:.1}", energy(whole))];
        for (part, without) in parts {
            let constants = SampleOptions { seed: SEED, without, ..SampleOptions::default() };
            let report =
                made(folder, name, &format!("without-{part}"), |fill| fill.constants(constants.clone()))?;
            // Directions are for the drawing alone.
            if !without.orientation {
                cells.push(format!("{:.1}", energy(&report)));
            }
        }
        println!("| {name} | {} |", cells.join(" | "));
    }
    println!();
    Ok(())
}

/// Energies for each sample over the iterations of all levels.
fn energies(runs: &[(&str, &[FillReport])], file: &Path) -> Result<(), Box<dyn Error>> {
    const COLOURS: [&str; 6] = ["#1b6ca8", "#c2571a", "#3c8d40", "#8a4fa3", "#a8841b", "#555555"];
    const SIZE: [f64; 2] = [330.0, 220.0];
    let all = || runs.iter().flat_map(|run| run.1).flat_map(|report| &report.levels);
    let most = all().flat_map(|level| &level.energies_per_sample).fold(0.0_f64, |most, &e| most.max(e));
    let least =
        all().flat_map(|level| &level.energies_per_sample).fold(f64::INFINITY, |least, &e| least.min(e));
    let (top, bottom) = (most.log10().ceil(), least.max(0.1).log10().floor());
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} 300\" font-family=\"sans-serif\" font-size=\"11\">\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        runs.len() as f64 * (SIZE[0] + 60.0) + 20.0
    );
    for (panel, (what, reports)) in runs.iter().enumerate() {
        let left = 50.0 + panel as f64 * (SIZE[0] + 60.0);
        let y = |energy: f64| 20.0 + (top - energy.max(0.1).log10()) / (top - bottom) * SIZE[1];
        for decade in bottom as i32..=top as i32 {
            let value = 10.0_f64.powi(decade);
            writeln!(
                svg,
                "<path d=\"M{left:.1} {0:.1}h{1}\" stroke=\"#ddd\"/><text x=\"{2:.1}\" y=\"{3:.1}\" text-anchor=\"end\">{value}</text>",
                y(value),
                SIZE[0],
                left - 5.0,
                y(value) + 4.0
            )?;
        }
        let steps: usize = reports[0].levels.iter().map(|level| level.energies_per_sample.len()).sum();
        for (number, (name, report)) in EXEMPLARS.iter().zip(*reports).enumerate() {
            let mut step = 0;
            for level in &report.levels {
                let points: Vec<String> = level
                    .energies_per_sample
                    .iter()
                    .enumerate()
                    .map(|(i, &e)| {
                        let x = left + (step + i) as f64 / (steps - 1) as f64 * SIZE[0];
                        format!("{x:.1},{:.1}", y(e))
                    })
                    .collect();
                step += level.energies_per_sample.len();
                writeln!(
                    svg,
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>",
                    points.join(" "),
                    COLOURS[number]
                )?;
            }
            writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{}\">{name}</text>",
                left + 8.0 + 54.0 * number as f64,
                SIZE[1] + 40.0,
                COLOURS[number]
            )?;
        }
        writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{what}: mm for each sample, three levels of eight searches</text>",
            left + SIZE[0] / 2.0,
            SIZE[1] + 60.0
        )?;
    }
    svg.push_str("</svg>\n");
    std::fs::write(file, svg)?;
    println!("{}", file.display());
    Ok(())
}
