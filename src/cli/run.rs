//! From arguments to results and messages.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use thiserror::Error;

use super::args::{
    AnalyzeArguments, Arguments, BandArguments, Command, PatternArguments, ToleranceArguments,
};
use super::laser::say_cuts;
use super::progress::Progress;
use super::scene::SceneError;
use super::{build, extrude, fill, rect, schema, shell, surface, verify};
use crate::analysis::{Analysis, AnalysisError};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::export;
use crate::job::{
    BandBuilder, BandReport, BridgesReport, Choice, DEFAULT_TEMPERATURE, FlatPattern, Format, JobError,
    MadeReport, Output, Quantities, READ_SHARE, SlicingChoice, SpaceOptions, Target, write_numbered,
};
use crate::pieces::CostWeights;
use crate::planar::{Tolerances, TolerancesError};
use crate::reeb::{SlicingError, SlicingRule};
use crate::verify::{CertificateError, CertificateReport, Mismatch, TilingFault, VerifyError};

/// Whatever ends the program with a message.
#[derive(Debug, Error)]
pub(super) enum CliError {
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{file}: {error}")]
    Unreadable { file: String, error: std::io::Error },
    #[error("{file}: {error}")]
    Unjudged { file: String, error: VerifyError },
    #[error("{file}: {mismatch}")]
    Mismatch { file: String, mismatch: Mismatch },
    #[error("{file}: {fault}")]
    Untiled { file: String, fault: TilingFault },
    #[error("{file}: {error}")]
    Uncertified { file: String, error: CertificateError },
    #[error("{file}: {report}")]
    Refuted { file: String, report: Box<CertificateReport> },
    #[error("{file}: the name does not say what it is; verify reads .svg, .dxf, .stl, .3mf and .obj")]
    UnknownKind { file: String },
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    #[error("cannot write to standard output: {0}")]
    Stdout(std::io::Error),
}

impl From<TolerancesError> for CliError {
    fn from(error: TolerancesError) -> Self {
        Self::Job(error.into())
    }
}

impl CliError {
    pub(super) fn exit_code(&self) -> u8 {
        match self {
            Self::Job(job) => job.exit_code(),
            Self::Scene(_)
            | Self::Unreadable { .. }
            | Self::Unjudged { .. }
            | Self::Uncertified { .. }
            | Self::UnknownKind { .. }
            | Self::Stdout(_) => 2,
            Self::Mismatch { .. } | Self::Untiled { .. } | Self::Refuted { .. } => 4,
            Self::Analysis(AnalysisError::Slicing(SlicingError::TooThin { .. })) => 3,
            Self::Analysis(_) => 2,
        }
    }
}

pub(super) fn run(arguments: Arguments) -> Result<ExitCode, CliError> {
    match arguments.command {
        Command::Band(band) => run_band(&band),
        Command::Rect(arguments) => rect::run_rect(&arguments),
        Command::Fill(arguments) => fill::run(&arguments),
        Command::Surface(arguments) => surface::run(&arguments),
        Command::Analyze(analyze) => run_analyze(&analyze),
        Command::Extrude(arguments) => extrude::run(&arguments),
        Command::Build(arguments) => build::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Schema => shell::print(schema::schema().as_bytes()).map(|()| ExitCode::SUCCESS),
        Command::Completions(arguments) => shell::completions(&arguments).map(|()| ExitCode::SUCCESS),
        Command::Man(arguments) => shell::man(&arguments).map(|()| ExitCode::SUCCESS),
    }
}

pub(super) fn tolerances(arguments: &ToleranceArguments) -> Result<Tolerances, TolerancesError> {
    let or_none = |length: Option<f64>| length.unwrap_or(0.0);
    let chord_mm = arguments.chord.unwrap_or(Tolerances::DEFAULT_CHORD_MM);
    Tolerances::new(chord_mm, or_none(arguments.min_feature), or_none(arguments.min_gap))
}

pub(super) fn output(path: &Path, stdout: Format) -> Result<Output, JobError> {
    if path.as_os_str() == "-" { Ok(Output::stdout(stdout)) } else { Output::file(path) }
}

/// Standard output cannot carry a file and JSON.
pub(super) fn refuse_json_beside(json: bool, outputs: &[Output]) -> Result<(), JobError> {
    if json && outputs.iter().any(|output| *output.target() == Target::Stdout) {
        return Err(JobError::Option {
            option: "--json",
            found: "standard output is already taken by --output -".to_owned(),
            wanted: "give the output a name, or leave out --json".to_owned(),
        });
    }
    Ok(())
}

fn run_band(arguments: &BandArguments) -> Result<ExitCode, CliError> {
    let (outputs, report_target) =
        destinations(&arguments.pattern.output, arguments.pattern.report.as_ref())?;
    let quiet = arguments.pattern.quiet;
    let job = builder(arguments)?.build()?;
    let wanted = arguments.best.or(arguments.count);
    match wanted {
        Some(_) => job.check_numbered(&outputs, report_target.as_ref())?,
        None => job.check_outputs(&outputs, report_target.as_ref())?,
    }
    let progress = Progress::new(quiet, outputs.iter().map(Output::target).chain(&report_target));
    let bands = job.run_all_for(&outputs, &mut |stage| progress.show(stage))?;
    let mut show = |stage| progress.show(stage);
    let reports = match wanted {
        Some(_) => write_numbered(&bands, &outputs, report_target.as_ref(), &mut show)?,
        None => vec![bands[0].write(&outputs, report_target.as_ref(), &mut show)?],
    };
    drop(progress);
    if !quiet {
        reports.iter().for_each(say_band);
        if let Some(sheet) = reports.first().and_then(|report| report.contact_sheet.as_ref()) {
            say!("wrote {sheet}");
        }
        if let Some(wanted) = wanted.filter(|&wanted| reports.len() < usize::from(wanted)) {
            say!("note: {} different band(s) were found of the {wanted} that were asked for", reports.len());
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Which sequences are taken, and whether their number is of interest.
fn choice(arguments: &BandArguments) -> Result<Choice, JobError> {
    let refuse = |option: &'static str, found: &str, wanted: &str| JobError::Option {
        option,
        found: found.to_owned(),
        wanted: wanted.to_owned(),
    };
    let many = arguments.best.map(|n| ("--best", n)).or(arguments.count.map(|n| ("--count", n)));
    if let Some((option, 0)) = many {
        return Err(refuse(option, "0 bands are none", "ask for 1 or more"));
    }
    let is_stream = |path: &PathBuf| path.as_os_str() == "-";
    let pattern = &arguments.pattern;
    if let Some((option, _)) = many
        && pattern.output.iter().chain(&pattern.report).any(is_stream)
    {
        return Err(refuse(option, "several bands do not fit on standard output", "give --output a name"));
    }
    if arguments.temperature.is_some_and(|t| !(1e-3..=1e3).contains(&t)) {
        return Err(refuse("--temperature", "it is out of range", "use a number from 0.001 to 1000"));
    }
    if arguments.best.is_some() && pattern.variety > 0.0 {
        return Err(refuse(
            "--variety",
            "the K best are those of least cost, and the penalty on repetition is no part of it",
            "leave out --variety, or leave out --best",
        ));
    }
    let is_drawn = pattern.seed.is_some() || arguments.count.is_some() || arguments.temperature.is_some();
    if is_drawn && pattern.variety > 0.0 {
        return Err(refuse(
            "--variety",
            "bands that are drawn at random have no penalty on repetition",
            "leave out --variety, or leave out --seed, --count and --temperature",
        ));
    }
    Ok(match (arguments.best, is_drawn) {
        (Some(k), _) => Choice::Best(k.into()),
        (None, true) => Choice::Drawn {
            seed: pattern.seed.unwrap_or(0),
            count: arguments.count.unwrap_or(1).into(),
            temperature: arguments.temperature.unwrap_or(DEFAULT_TEMPERATURE),
        },
        (None, false) => Choice::Cheapest,
    })
}

/// Where a pattern goes, and its report.
pub(super) fn destinations(
    files: &[PathBuf],
    report: Option<&PathBuf>,
) -> Result<(Vec<Output>, Option<Target>), JobError> {
    let outputs = files.iter().map(|path| output(path, Format::Svg)).collect::<Result<_, _>>()?;
    let report_target =
        report.map(|path| if path.as_os_str() == "-" { Target::Stdout } else { Target::File(path.clone()) });
    Ok((outputs, report_target))
}

pub(super) fn builder(arguments: &BandArguments) -> Result<BandBuilder, CliError> {
    let builder = BandBuilder::new(&arguments.exemplar, arguments.along.clone())
        .closed_pattern(arguments.closed_pattern)
        .choice(choice(arguments)?)
        .contact_sheet(!arguments.no_contact_sheet)
        .counted(arguments.pattern.report.is_some())
        .space(SpaceOptions { gap_mm: arguments.gap, twist: arguments.twist.clone(), points: None });
    let builder = match arguments.round {
        Some(radius) => builder.round_mm(radius),
        None => builder,
    };
    with_pattern(builder, &arguments.pattern)
}

/// The options that a band and a rectangle share.
pub(super) fn with_pattern(builder: BandBuilder, a: &PatternArguments) -> Result<BandBuilder, CliError> {
    let made = a.part.make.made(&a.part.tolerances)?;
    let mut builder = builder
        .slicing(a.slicing)
        .mirror(a.mirror)
        .variety(a.variety)
        .alpha(a.alpha)
        .jump_cost(a.jump_cost)
        .stitch(a.stitch)
        .memory_limit(a.memory_limit)
        .thickness_mm(made.thickness_mm)
        .chord_mm(made.chord_mm)
        .min_feature_mm(made.min_feature_mm)
        .min_gap_mm(made.min_gap_mm)
        .enforce(a.part.make.enforce)
        .laser(a.part.laser.options(&made, &a.output))
        .picture(a.part.picture.options())
        .print(a.part.print.options());
    if let Some(material) = made.material {
        builder = builder.material(material);
    }
    for &range in &a.keep {
        builder = builder.keep(range);
    }
    if let Some(width) = a.width {
        builder = builder.width_mm(width);
    }
    if let Some(effort) = a.effort {
        builder = builder.effort(effort);
    }
    if let Some(components) = a.components.0 {
        builder = builder.components(components);
    }
    if let Some(holes) = a.holes.0 {
        builder = builder.holes(holes);
    }
    if let Some(width) = a.bridge {
        builder = builder.bridge_mm(width);
    }
    Ok(builder)
}

/// How many bridges there are and where to find them; nothing where none were laid.
pub(super) fn say_bridges(bridges: Option<&BridgesReport>, positions: &str) {
    if let Some(laid) = bridges.filter(|laid| !laid.bridges.is_empty()) {
        let count = laid.bridges.len();
        say!("{count} bridge(s): {} strut(s), {} slit(s); {positions}", laid.struts, laid.slits);
    }
}

/// Where the bridges of a pattern are listed and seen.
pub(super) const BRIDGES_SHOWN: &str = "--report lists their positions, and a .png shows them in colour";

pub(super) fn say_band(report: &BandReport) {
    let closed = if report.closed_pattern { ", closed all the way round" } else { "" };
    say!(
        "{} component(s), {} hole(s){closed}: {} pieces along {:.1} mm, {} jumps",
        report.components,
        report.holes,
        report.pieces_in_result,
        report.length_mm,
        report.seams.jumps
    );
    say_flat(report.flat.as_ref());
    say_bridges(report.bridges.as_ref(), BRIDGES_SHOWN);
    say_found(&report.made);
}

/// What drawings have of a closed strip, which are cut open.
pub(super) fn say_flat(flat: Option<&FlatPattern>) {
    if let Some(flat) = flat.filter(|flat| flat.is_joined) {
        say!(
            "laid flat and cut open, as in drawings: {} component(s), {} hole(s)",
            flat.components,
            flat.holes
        );
    }
}

/// What was measured, noted and written.
pub(super) fn say_found(made: &MadeReport) {
    let widths = [("ink", made.min_feature), ("gap", made.min_gap)];
    for (what, narrowest) in widths.iter().filter_map(|(what, n)| n.map(|n| (what, n))) {
        let p = narrowest.position_mm;
        say!("narrowest {what} {:.3} mm, at ({:.1}, {:.1}) mm", narrowest.width_mm, p.x, p.y);
    }
    say_quantities(made.quantities.as_ref());
    say_cuts(made.laser.as_ref());
    say_notes(&made.notes);
    for file in &made.files {
        say!("wrote {file}");
    }
}

/// What the part takes of its material, if one was named.
pub(super) fn say_quantities(quantities: Option<&Quantities>) {
    if let Some((part, material)) = quantities.and_then(|part| Some((part, part.material.as_ref()?))) {
        say!("{:.1} mm3 of {}: {:.2} g", part.volume_mm3, material.material.name, material.mass_g);
    }
}

/// A line for each note; a warning says itself what it is.
pub(super) fn say_notes(notes: &[String]) {
    for note in notes {
        let kind = if note.starts_with("warning: ") { "" } else { "note: " };
        say!("{kind}{note}");
    }
}

fn run_analyze(arguments: &AnalyzeArguments) -> Result<ExitCode, CliError> {
    let outputs: Vec<Output> =
        arguments.output.iter().map(|path| output(path, Format::Svg)).collect::<Result<_, _>>()?;
    Output::check(outputs.iter().map(Output::target), &[&arguments.exemplar])?;
    refuse_json_beside(arguments.json, &outputs)?;
    let is_part = |format: Format| format.is_solid() || format == Format::Dxf;
    if let Some(other) = outputs.iter().find(|o| is_part(o.format())) {
        return Err(CliError::Job(JobError::Option {
            option: "--output",
            found: format!("{} is a part to be made", other.target()),
            wanted: "an overlay is a picture: end the name in .svg or .png".to_owned(),
        }));
    }
    let tolerances = tolerances(&arguments.tolerances)?;
    let options = ReadOptions {
        // As a band reads it, so that cuts and numbers of pieces are the same.
        chord_mm: tolerances.chord_mm() * READ_SHARE,
        target_height_mm: arguments.width,
        limits: Limits::default(),
    };
    let exemplar = Exemplar::read(&arguments.exemplar, &options).map_err(JobError::from)?;
    let rule = match arguments.slicing {
        SlicingChoice::Reeb => None,
        SlicingChoice::Persistence(persistence_mm) => Some(SlicingRule::Reeb { persistence_mm }),
        SlicingChoice::Uniform(lines) => Some(SlicingRule::Uniform { lines }),
    };
    let analysis = Analysis::keeping(&exemplar, rule, &arguments.keep, &tolerances, &CostWeights::default())?;
    write_all(&outputs, |format| match format {
        Format::Png => analysis.overlay_png(OVERLAY_PIXELS).map_err(JobError::from),
        Format::Svg | Format::Dxf | Format::Stl | Format::Threemf | Format::Obj => {
            Ok(analysis.overlay_svg().into_bytes())
        }
    })?;
    if arguments.json {
        print_json(&analysis)?;
    } else if !arguments.quiet && !outputs.iter().any(|o| *o.target() == Target::Stdout) {
        // Beside a picture, the rows of a large exemplar are only in the way.
        match arguments.table || outputs.is_empty() {
            true => print(&format!("{analysis}\n"))?,
            false => print(&analysis.summary().to_string())?,
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The longer side of an overlay in pixels: pieces of a fine ornament are narrow.
const OVERLAY_PIXELS: u32 = 2400;

/// Writes each output whole, or none of them.
fn write_all(
    outputs: &[Output],
    encode: impl Fn(Format) -> Result<Vec<u8>, JobError>,
) -> Result<(), CliError> {
    let mut staged = Vec::new();
    for output in outputs {
        let bytes = encode(output.format())?;
        match output.target() {
            Target::File(path) => staged.push(export::stage(path, &bytes).map_err(JobError::from)?),
            Target::Stdout => print_bytes(&bytes)?,
        }
    }
    Ok(export::persist_all(staged).map_err(JobError::from)?)
}

pub(super) fn print_json(report: &impl serde::Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(report).map_err(|e| CliError::Stdout(e.into()))?;
    print(&format!("{text}\n"))
}

pub(super) fn print(text: &str) -> Result<(), CliError> {
    print_bytes(text.as_bytes())
}

/// Prints to standard output; a reader that has closed the pipe has had enough.
fn print_bytes(bytes: &[u8]) -> Result<(), CliError> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}
