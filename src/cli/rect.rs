//! `openwork rect`.

use std::process::ExitCode;

use super::args::RectArguments;
use super::progress::Progress;
use super::run::{BRIDGES_SHOWN, CliError, destinations, say_bridges, say_found, with_pattern};
use crate::domain::{CurveSpec, Roll};
use crate::job::{BandBuilder, Output, RectBuilder, RectJob, RectReport};

pub(super) fn run_rect(arguments: &RectArguments) -> Result<ExitCode, CliError> {
    let (outputs, report_target) =
        destinations(&arguments.pattern.output, arguments.pattern.report.as_ref())?;
    let quiet = arguments.pattern.quiet;
    let job = job(arguments, |band| band)?;
    job.check_outputs(&outputs, report_target.as_ref())?;
    let progress = Progress::new(quiet, outputs.iter().map(Output::target).chain(&report_target));
    let rect = job.run(&mut |stage| progress.show(stage))?;
    let report = rect.write(&outputs, report_target.as_ref(), &mut |stage| progress.show(stage))?;
    drop(progress);
    if !quiet {
        say_rect(&report, arguments.roll);
    }
    Ok(ExitCode::SUCCESS)
}

/// The rectangle that is asked for, with what `adapt` makes of its options.
pub(super) fn job(
    arguments: &RectArguments,
    adapt: impl FnOnce(BandBuilder) -> BandBuilder,
) -> Result<RectJob, CliError> {
    // The curve of a rectangle is its own matter.
    let line = CurveSpec::Line { length_mm: 1.0 };
    let mut band = with_pattern(BandBuilder::new(&arguments.exemplar, line), &arguments.pattern)?;
    if let Some(seed) = arguments.pattern.seed {
        band = band.seed(seed);
    }
    let rect = match (arguments.roll, arguments.height, arguments.size) {
        (Some(roll), Some(height_mm), _) => RectBuilder::rolled(&arguments.exemplar, roll, height_mm),
        (_, _, Some(size)) => RectBuilder::new(&arguments.exemplar, size),
        _ => unreachable!("the parser asks for a size, or a roll with its height"),
    };
    Ok(rect.tile(arguments.tile).drape(arguments.drape.clone()).options(|_| adapt(band)).build()?)
}

fn say_rect(report: &RectReport, roll: Option<Roll>) {
    let [width_mm, height_mm] = report.size_mm.map(|mm| (mm * 100.0).round() / 100.0);
    let rolled = roll.map_or_else(String::new, |roll| format!(", rolled to {roll}"));
    say!(
        "{} component(s), {} hole(s) in {width_mm}x{height_mm}mm{rolled}: {} pieces along the width, {} rows along the height, {} way(s) tried",
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
