//! The strip warp against linear rotation-invariant deformation, measured: the table and the pictures of
//! docs/stitching.md.
//!
//!     cargo run --release --example stitching -- [--pictures FILE.png] [FOLDER...]
//!
//! Each exemplar of each folder (fixtures/exemplars when none is named) is made 20 mm high and synthesized along
//! 400 mm, in one component where it can be. Both methods then bend the same pieces to the same targets.

mod measure;
mod picture;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use openwork::domain::CurveSpec;
use openwork::exemplar::{Exemplar, Limits, ReadOptions};
use openwork::fit::{Bent, FitOptions, Outline, Placed, Prepared, Sides, StitchMethod};
use openwork::job::BandBuilder;
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::{Region, Tolerances};
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};

use measure::{Measured, percentile, turnings};

const HEIGHT_MM: f64 = 20.0;
const LENGTH_MM: f64 = 400.0;
/// The scale on which angles and curvature are measured: a hundredth of the height, which the eye can just see.
const SCALE_MM: f64 = HEIGHT_MM / 100.0;
const CHORD_MM: f64 = Tolerances::DEFAULT_CHORD_MM;
const METHODS: [StitchMethod; 2] = [StitchMethod::Warp, StitchMethod::Lri];

/// Where two figures stand in a cell, the first is the warp's.
const HEAD: &str = "| exemplar | pieces | jumps | p99 | turn, 95 % | worst | over p99 | kink, 90 % | bending | width, median | 95 % | thinnest, 1 % | fell back | ms | ms again |";

/// One exemplar with the run that was synthesized from it.
struct Case {
    name: String,
    region: Region,
    catalogue: Catalogue,
    sequence: Vec<usize>,
}

impl Case {
    fn new(file: &Path) -> Result<Self, Box<dyn Error>> {
        let band = |one: bool| {
            let along = CurveSpec::Line { length_mm: LENGTH_MM };
            let job = BandBuilder::new(file, along).width_mm(HEIGHT_MM);
            let job = if one { job.components(1) } else { job };
            job.build()?.run(&mut |_| {})
        };
        let band = band(true).or_else(|_| band(false))?;
        let options = ReadOptions {
            chord_mm: 0.25 * CHORD_MM,
            target_height_mm: Some(HEIGHT_MM),
            limits: Limits::default(),
        };
        let exemplar = Exemplar::read(file, &options)?;
        let (region, _) = exemplar.region().without_specks(CHORD_MM * CHORD_MM);
        let (low, high) = region.bounds_mm().ok_or("an exemplar without ink")?;
        let rule = SlicingRule::reeb_for_width(high.x - low.x);
        let slicing = Slicing::new(&region, &ReebGraph::new(&region), rule, &Tolerances::default())?;
        // All joins, so that those of the run are among them.
        let weights = CostWeights { successors: usize::MAX, ..CostWeights::default() };
        let catalogue = Catalogue::new(&region, &slicing.cuts, &weights);
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, region, catalogue, sequence: band.plan().sequence.clone() })
    }

    fn options(&self, stitch: StitchMethod) -> FitOptions {
        FitOptions {
            length_mm: LENGTH_MM,
            height_mm: HEIGHT_MM,
            is_ring: false,
            chord_mm: 0.125 * CHORD_MM,
            stitch,
            sides: Sides::Free,
        }
    }

    fn measured(&self, method: StitchMethod) -> Result<Measured, Box<dyn Error>> {
        let options = self.options(method);
        let placed = Placed::new(&self.catalogue, &self.sequence, &options)?;
        let mut prepared = Prepared::new();
        let all = |prepared: &mut Prepared| {
            let start = Instant::now();
            let bent: Vec<_> = (0..self.sequence.len())
                .map(|i| placed.bend(i, method, prepared, options.chord_mm))
                .collect();
            (bent, start.elapsed().as_secs_f64() * 1e3)
        };
        let (_, first_ms) = all(&mut prepared);
        let (bent, again_ms) = all(&mut prepared);
        let fallbacks = bent.iter().filter(|(_, fault)| fault.is_some()).count();
        let bent: Vec<Bent> = bent.into_iter().map(|(bent, _)| bent).collect();
        let outline = Outline::new(&self.catalogue, &self.sequence, &options)?;
        let mut measured = Measured::new(&placed, &bent, &outline.seams, SCALE_MM);
        (measured.fallbacks, measured.first_ms, measured.again_ms) = (fallbacks, first_ms, again_ms);
        Ok(measured)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (mut pictures, mut folders) = (None, Vec::new());
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--pictures" => pictures = Some(arguments.next().ok_or("--pictures needs the name of a file")?),
            _ => folders.push(PathBuf::from(argument)),
        }
    }
    if folders.is_empty() {
        folders.push(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/exemplars"));
    }
    println!("{HEAD}");
    println!("{}", HEAD.split('|').skip(1).map(|_| "|").collect::<Vec<_>>().join("---"));
    let mut cases = Vec::new();
    let mut sums: [Measured; 2] = Default::default();
    for folder in &folders {
        let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
        files.retain(|file| file.extension().is_some_and(|e| e == "svg"));
        files.sort();
        for file in &files {
            let case = Case::new(file).map_err(|e| format!("{}: {e}", file.display()))?;
            let own = turnings(&case.region, SCALE_MM);
            let limit = percentile(&own, 0.99);
            let mut both = Vec::new();
            for (method, sum) in METHODS.into_iter().zip(&mut sums) {
                let mut measured = case.measured(method)?;
                measured.over = measured.angles.iter().filter(|&&a| a > limit).count();
                sum.add(&measured);
                both.push(measured);
            }
            row(&case.name, case.sequence.len(), Some(limit), &both);
            cases.push(case);
        }
    }
    let pieces = cases.iter().map(|case| case.sequence.len()).sum();
    row("**all**", pieces, None, &sums);
    if let Some(file) = pictures {
        std::fs::write(file, picture::sheet(&cases)?)?;
    }
    Ok(())
}

fn row(name: &str, pieces: usize, limit: Option<f64>, both: &[Measured]) {
    let degrees = |radians: f64| format!("{:.1}", radians.to_degrees());
    let percent = |part: f64| format!("{:.1} %", 100.0 * part);
    let changes = |m: &Measured| -> Vec<f64> { m.widths.iter().map(|w| (w - 1.0).abs()).collect() };
    let cells: [&dyn Fn(&Measured) -> String; 10] = [
        &|m| degrees(percentile(&m.angles, 0.95)),
        &|m| degrees(percentile(&m.angles, 1.0)),
        &|m| format!("{} of {}", m.over, m.angles.len()),
        &|m| degrees(percentile(&m.kinks, 0.9)),
        &|m| format!("{:+.1} %", 100.0 * (m.bent_energy / m.drawn_energy - 1.0)),
        &|m| percent(percentile(&changes(m), 0.5)),
        &|m| percent(percentile(&changes(m), 0.95)),
        &|m| percent(percentile(&m.widths, 0.01)),
        &|m| format!("{:.1}", m.first_ms),
        &|m| format!("{:.1}", m.again_ms),
    ];
    let mut cells: Vec<String> =
        cells.iter().map(|cell| both.iter().map(cell).collect::<Vec<_>>().join(", ")).collect();
    cells.insert(8, both[1].fallbacks.to_string());
    let limit = limit.map_or(String::new(), degrees);
    println!("| {name} | {pieces} | {} | {limit} | {} |", both[0].jumps, cells.join(" | "));
}
