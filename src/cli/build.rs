//! `openwork build`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::progress::Progress;
use super::run::{CliError, output, say_notes};
use super::scene;
use crate::job::{Format, JobError, Output, SceneReport, Target, View};

/// What follows the options in the help of `build`.
pub(super) const HELP: &str = "\
A scene file is TOML; docs/scenes.md is its manual. Paths in it are relative to its folder. A part is made from an
exemplar (band, rect), a drawing (extrude), plain (strip, plate), or a mesh file (model); its other keys are options of that
command. place = { centre, scale, mirror, turn, move } is applied in this order; repeat = 6 makes six copies around the
upright axis, repeat = { times, about, turn, through, step, mirror } others. A joint names parts that must fuse.

  shells = 1
  output = [\"lamp.stl\", \"lamp.png\"]
  [part.arc]
  band = \"vine.svg\"
  points = [[40, 0, 0], [55, 10, 40], [30, 20, 90]]
  width = \"14mm\"
  components = 1
  repeat = 6
  [part.foot]
  strip = \"ring:78mm\"
  width = \"6mm\"
  [[joint]]
  between = [\"arc\", \"foot\"]

Examples:
  Build it, with the files that it names:
    openwork build lamp.toml
  Elsewhere, with a picture from the front, and no cache:
    openwork build lamp.toml -o lamp.3mf -o lamp.png --view front --no-cache

Exit codes: 0 done; 2 the scene or an argument is wrong; 3 a part cannot be made, or a joint does not hold;
4 the whole is not as declared, or a file failed verification, and nothing was written; 1 a bug of ours.";

#[derive(Debug, Args)]
pub(super) struct BuildArguments {
    /// The scene (TOML)
    scene: PathBuf,
    /// A file to write: .stl, .3mf, .obj or .png; may be repeated; - is STL on standard output [default: those of the scene]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Write a report of what was built and measured (JSON; - for standard output) [default: that of the scene]
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Take pictures from this side: top, iso or front [default: that of the scene, or iso]
    #[arg(long, value_name = "SIDE", value_parser = str::parse::<View>)]
    view: Option<View>,
    /// Length of the longer side of pictures in pixels [default: that of the scene, or 1600]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pixels: Option<u32>,
    /// Keep parts and results here, so that what did not change need not be made again; may be deleted at any time
    /// [default: openwork in $XDG_CACHE_HOME, or in ~/.cache]
    #[arg(long, value_name = "FOLDER", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Make everything anew, and keep nothing
    #[arg(long)]
    no_cache: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &BuildArguments) -> Result<ExitCode, CliError> {
    let file = scene::read(&arguments.scene)?;
    let mut scene = file.scene;
    let is_typed = !arguments.output.is_empty();
    let paths = if is_typed { &arguments.output } else { &file.outputs };
    let outputs: Vec<Output> =
        paths.iter().map(|path| output(path, Format::Stl)).collect::<Result<_, _>>()?;
    if outputs.is_empty() {
        return Err(CliError::Job(JobError::Option {
            option: "--output",
            found: "neither the scene nor the command line names a file".to_owned(),
            wanted: "give -o FILE.stl, or write output = [\"FILE.stl\"] in the scene".to_owned(),
        }));
    }
    let target = |path: &PathBuf| match path.as_os_str() == "-" {
        true => Target::Stdout,
        false => Target::File(path.clone()),
    };
    let report_target = arguments.report.as_ref().or(file.report.as_ref()).map(target);
    scene.view = arguments.view.unwrap_or(scene.view);
    scene.pixels = arguments.pixels.unwrap_or(scene.pixels);
    scene.cache = match arguments.no_cache {
        true => None,
        false => arguments.cache.clone().or_else(default_cache),
    };
    let progress = Progress::new(arguments.quiet, outputs.iter().map(Output::target).chain(&report_target));
    let report = scene.build(&outputs, report_target.as_ref(), &mut |step| progress.show_step(step))?;
    drop(progress);
    if !arguments.quiet {
        say_scene(&report);
    }
    Ok(ExitCode::SUCCESS)
}

/// Where results are kept when nothing else is said; nowhere for a user without a home.
fn default_cache() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")));
    base.filter(|base| base.is_absolute()).map(|base| base.join("openwork"))
}

fn say_scene(report: &SceneReport) {
    for part in &report.parts {
        let copies = match part.copies.len() {
            1 => String::new(),
            n => format!(", {n} copies"),
        };
        let kept = if part.from_cache && !report.from_cache { ", from the cache" } else { "" };
        say!("{}: {} shell(s), genus {}{copies}{kept}", part.name, part.shells, part.genus);
    }
    if let Some(weakest) = report.joints.iter().min_by(|a, b| a.width_mm.total_cmp(&b.width_mm)) {
        let ([first, second], [x, y, z]) = (&weakest.between, weakest.position_mm);
        say!(
            "{} joint(s), the narrowest between {first} and {second}: {:.2} mm at ({x:.1}, {y:.1}, {z:.1}) mm",
            report.joints.len(),
            weakest.width_mm
        );
    }
    let kept = if report.from_cache { ", unchanged" } else { "" };
    let [low, high] = report.bounds_mm;
    let [w, d, h] = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    say!(
        "the whole: {} shell(s), genus {}: {} facets, {:.1} mm3, {w:.1} x {d:.1} x {h:.1} mm{kept}",
        report.shells,
        report.genus,
        report.triangles,
        report.volume_mm3
    );
    say_notes(&report.notes);
    for file in &report.files {
        say!("wrote {file}");
    }
}
