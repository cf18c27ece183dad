//! `openwork extrude`.

use std::process::ExitCode;

use super::args::ExtrudeArguments;
use super::laser::say_cuts;
use super::progress::Progress;
use super::run::{CliError, output, print_json, refuse_json_beside, say_bridges, say_notes, say_quantities};
use crate::job::{ExtrudeBridges, ExtrudeReport, FlatMaking, Format, Output, extrude};

pub(super) fn run(arguments: &ExtrudeArguments) -> Result<ExitCode, CliError> {
    let outputs: Vec<Output> =
        arguments.output.iter().map(|path| output(path, Format::Stl)).collect::<Result<_, _>>()?;
    refuse_json_beside(arguments.json, &outputs)?;
    let (making, bridges) = making(arguments)?;
    let progress = Progress::new(arguments.quiet, outputs.iter().map(Output::target));
    let made = extrude(&arguments.file, &making, bridges, &outputs, &mut |stage| progress.show(stage))?;
    drop(progress);
    if arguments.json {
        print_json(&made)?;
    }
    if !arguments.quiet {
        say_made(&made);
    }
    Ok(ExitCode::SUCCESS)
}

/// How the drawing is to be made, and its bridges.
pub(super) fn making(arguments: &ExtrudeArguments) -> Result<(FlatMaking, Option<ExtrudeBridges>), CliError> {
    let making = arguments.part.making(&arguments.output)?;
    let bridges = arguments.bridge.map(|width_mm| ExtrudeBridges {
        width_mm,
        components: arguments.components.and_then(|count| count.0),
        holes: arguments.holes.and_then(|count| count.0),
    });
    Ok((making, bridges))
}

fn say_made(made: &ExtrudeReport) {
    match &made.solid {
        Some(solid) => say!(
            "{} shell(s), total genus {}: {} facets, {:.1} mm3",
            solid.shells.len(),
            solid.genus,
            solid.triangles,
            solid.volume_mm3
        ),
        None => say!("{} component(s), {} hole(s)", made.components, made.holes),
    }
    say_bridges(made.bridges.as_ref(), "--json lists their positions, and a .png shows them in colour");
    say_quantities(Some(&made.quantities));
    say_cuts(made.laser.as_ref());
    say_notes(&made.notes);
    for file in &made.files {
        say!("wrote {file}");
    }
}
