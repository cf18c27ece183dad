//! `openwork rect`.

use std::process::ExitCode;

use super::args::RectArguments;
use super::progress::Progress;
use super::run::{BRIDGES_SHOWN, CliError, destinations, say_bridges, say_found, with_pattern};
use crate::domain::{CurveSpec, RectSize};
use crate::job::{BandBuilder, Output, RectBuilder, RectReport};

pub(super) fn run_rect(arguments: &RectArguments) -> Result<ExitCode, CliError> {
    let (outputs, report_target) = destinations(&arguments.pattern)?;
    let quiet = arguments.pattern.quiet;
    let line = CurveSpec::Line { length_mm: arguments.size.width_mm() };
    let mut band = with_pattern(BandBuilder::new(&arguments.exemplar, line), &arguments.pattern)?;
    if let Some(seed) = arguments.pattern.seed {
        band = band.seed(seed);
    }
    let job = RectBuilder::new(&arguments.exemplar, arguments.size)
        .tile(arguments.tile)
        .options(|_| band)
        .build()?;
    job.check_outputs(&outputs, report_target.as_ref())?;
    let progress = Progress::new(quiet, outputs.iter().map(Output::target).chain(&report_target));
    let rect = job.run(&mut |stage| progress.show(stage))?;
    let report = rect.write(&outputs, report_target.as_ref(), &mut |stage| progress.show(stage))?;
    drop(progress);
    if !quiet {
        say_rect(&report, arguments.size);
    }
    Ok(ExitCode::SUCCESS)
}

fn say_rect(report: &RectReport, size: RectSize) {
    say!(
        "{} component(s), {} hole(s) in {size}: {} pieces along the width, {} rows along the height, {} way(s) tried",
        report.components,
        report.holes,
        report.along_u.pieces_in_result,
        report.along_v.pieces_in_result,
        report.attempts.len()
    );
    if let Some(tiling) = &report.tiling {
        say!(
            "copies join at {} place(s) across and {} upwards: the tiling has {} component(s) and {} hole(s) for each tile",
            tiling.joins_across,
            tiling.joins_up,
            tiling.components,
            tiling.holes
        );
    }
    say_bridges(report.bridges.as_ref(), BRIDGES_SHOWN);
    say_found(&report.made);
}
