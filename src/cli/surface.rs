//! `openwork surface`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{ArgGroup, Args, ValueEnum};

use super::args::PatternArguments;
use super::make::MakeArgs;
use super::progress::Progress;
use super::run::{CliError, destinations, say_band, with_pattern};
use super::values;
use crate::job::{
    BandBuilder, BandJob, Choice, ControlPoints, DEFAULT_TEMPERATURE, Height, JobError, Output, Route,
    SurfaceMode, SurfaceOptions,
};

/// How far points may be off the model when nothing is said, in millimetres.
const TOLERANCE_MM: f64 = 1.0;

pub(super) const SURFACE_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres. Models are in millimetres, z up, and keep
their place. Drawings (SVG, DXF) are the pattern laid flat; a PNG needs --view to show the model.
Counts are those of the pattern. A pattern that is carved through a wall in one component without holes leaves the
model in one piece; each of its holes is a piece that comes off.

Examples:
  A bracelet for a vase: a part of its own that fits around it at half of its height
    openwork surface vine.svg --mesh vase.stl --around 50% --width 14mm --components 1 -o ring.stl
  The same pattern standing out from the vase, which gets a wall of 2 mm:
    openwork surface vine.svg --mesh vase.stl --around 50% --width 14mm --mode emboss --shell 2mm -o vase.stl
  Cut through the shell of an egg, along a curve through five points of it:
    openwork surface vine.svg --mesh egg.obj --through \"20,0,10; 0,20,20; -20,0,30; 0,-20,20; 20,0,10\" \\
      --width 9mm --mode carve --shell 1.6mm --components 1 --holes 0 -o lantern.stl -o lantern.png --view iso

Exit codes: 0 done; 2 the exemplar, the model or an argument is wrong; 3 the constraints cannot be met; 4 a file failed
verification and nothing was written; 1 a bug of ours.";

#[derive(Debug, Args)]
#[command(mut_arg("mesh", |mesh| mesh.required(true)))]
pub(super) struct SurfaceArguments {
    /// The ornament to learn from (SVG)
    pub(super) exemplar: PathBuf,
    #[command(flatten)]
    pub(super) model: OnModelArguments,
    /// The pattern must go all the way round a closed curve
    #[arg(long)]
    pub(super) closed_pattern: bool,
    #[command(flatten)]
    pub(super) pattern: PatternArguments,
}

/// Where a band lies on a model, and what becomes of both.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("route"))]
pub(super) struct OnModelArguments {
    /// The model that the band lies on: an STL, a 3MF or an OBJ, in millimetres
    #[arg(long, value_name = "FILE", requires = "route")]
    mesh: Option<PathBuf>,
    /// Points of the model that the curve passes, x,y,z with semicolons between them; if the last is the first, it closes
    #[arg(long, value_name = "POINTS", group = "route", requires = "mesh", value_parser = values::points, allow_hyphen_values = true)]
    through: Option<ControlPoints>,
    /// A curve near the model: FILE.obj with a polyline, or FILE.csv with a row of x, y and z for each point; if the last is
    /// the first, it closes
    #[arg(long, value_name = "FILE", group = "route", requires = "mesh")]
    curve: Option<PathBuf>,
    /// All the way round at a height: z in the coordinates of the model, as 30mm, or a part of its height, as 50%
    #[arg(long, value_name = "HEIGHT", group = "route", requires = "mesh", value_parser = values::height, allow_hyphen_values = true)]
    around: Option<Height>,
    /// How far points may be off the model; they are brought onto it
    /// [default: 1mm]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, requires = "mesh", conflicts_with = "around", allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// What becomes of the band
    #[arg(long, value_enum, default_value_t, requires = "mesh")]
    mode: Mode,
    /// Give the model a wall, inwards, that is so thick: open models need one, and closed ones are made hollow
    #[arg(long, value_name = "LENGTH", requires = "mesh", value_parser = values::length, allow_hyphen_values = true)]
    shell: Option<f64>,
    /// Carve so deep, from the surface inwards, instead of through the wall of --shell
    #[arg(long, value_name = "LENGTH", requires = "mesh", value_parser = values::length, allow_hyphen_values = true)]
    depth: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(super) enum Mode {
    /// A part of its own, as thick as --thickness, that fits the model; where the model slopes across the band it is thinner, which is told
    #[default]
    Band,
    /// Standing out from the model by --thickness, in one piece with it
    Emboss,
    /// Cut out of the model: through the wall of --shell, or --depth deep. --min-feature is then for what is left between
    /// cuts, and --min-gap for the cuts
    Carve,
}

pub(super) fn run(arguments: &SurfaceArguments) -> Result<ExitCode, CliError> {
    let (outputs, report_target) =
        destinations(&arguments.pattern.output, arguments.pattern.report.as_ref())?;
    let quiet = arguments.pattern.quiet;
    let job = job(arguments, |band| band)?;
    job.check_outputs(&outputs, report_target.as_ref())?;
    let progress = Progress::new(quiet, outputs.iter().map(Output::target).chain(&report_target));
    let bands = job.run_all_for(&outputs, &mut |stage| progress.show(stage))?;
    let report = bands[0].write(&outputs, report_target.as_ref(), &mut |stage| progress.show(stage))?;
    drop(progress);
    if !quiet {
        say_band(&report);
    }
    Ok(ExitCode::SUCCESS)
}

/// The job that the arguments ask for, with what else is `set`.
pub(super) fn job(
    arguments: &SurfaceArguments,
    set: impl FnOnce(BandBuilder) -> BandBuilder,
) -> Result<BandJob, CliError> {
    let options =
        arguments.model.options(&arguments.pattern.part.make)?.expect("the parser asks for a model");
    let builder = BandBuilder::on_model(&arguments.exemplar, options)
        .closed_pattern(arguments.closed_pattern)
        .counted(arguments.pattern.report.is_some());
    let builder = match arguments.pattern.seed {
        Some(seed) => builder.choice(Choice::Drawn { seed, count: 1, temperature: DEFAULT_TEMPERATURE }),
        None => builder,
    };
    Ok(set(with_pattern(builder, &arguments.pattern)?).build()?)
}

impl OnModelArguments {
    /// What is asked of a band on a model that is made so, if there is a model.
    pub(super) fn options(&self, make: &MakeArgs) -> Result<Option<SurfaceOptions>, CliError> {
        let Some(model) = self.mesh.clone() else { return Ok(None) };
        if matches!(self.mode, Mode::Carve) && make.has_thickness() {
            return Err(CliError::Job(JobError::Option {
                option: "--thickness",
                found: "what is carved is as thick as the wall, or as deep as --depth".to_owned(),
                wanted: "leave it out, or use --depth".to_owned(),
            }));
        }
        let route = match (&self.through, &self.curve, self.around) {
            (Some(points), ..) => through(points.clone()),
            (_, Some(file), _) => Route::Curve(file.clone()),
            (.., Some(height)) => Route::Around(height),
            _ => unreachable!("the parser asks for one of them"),
        };
        let mode = match self.mode {
            Mode::Band => SurfaceMode::Band,
            Mode::Emboss => SurfaceMode::Emboss,
            Mode::Carve => SurfaceMode::Carve,
        };
        Ok(Some(SurfaceOptions {
            model,
            route,
            mode,
            shell_mm: self.shell,
            depth_mm: self.depth,
            tolerance_mm: self.tolerance.unwrap_or(TOLERANCE_MM),
        }))
    }
}

/// Points whose last is their first are closed.
fn through(ControlPoints(mut points): ControlPoints) -> Route {
    let is_closed = points.len() > 3 && points.first() == points.last();
    if is_closed {
        points.pop();
    }
    Route::Through { points: ControlPoints(points), is_closed }
}
