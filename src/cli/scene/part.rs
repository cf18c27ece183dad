//! Parts of a scene file: what they are made from, in the words of the command line.
//!
//! A key of a part is an option of the command that makes such a part, without its dashes. All of them become the words of a command
//! line, paths resolved, so that one parser judges both; what it finds wrong is told with the line of the key.

use std::any::TypeId;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Args, Command, CommandFactory, FromArgMatches};

use super::table::{Entry, SceneError, Table};
use crate::cli::args::{Arguments, BandArguments, ExtrudeArguments, RectArguments, ToleranceArguments};
use crate::cli::make::MakeArgs;
use crate::cli::preset::{name_of, words};
use crate::cli::run::CliError;
use crate::cli::surface::{self, SurfaceArguments};
use crate::cli::{extrude, rect, run, values};
use crate::domain::{CurveSpec, RectSize, Twist};
use crate::job::{Making, Points, PrintOptions, SpaceOptions, Strip};

/// What a part can be made from. Each key has the file, the curve or the size that it begins with.
pub(super) const KINDS: [&str; 7] = ["band", "rect", "surface", "extrude", "strip", "plate", "model"];

/// Keys of a part that are no options of its command.
pub(super) const OWN: [&str; 4] = ["place", "repeat", "points", "closed"];

/// Options that a part of a scene does not have: they say where files go and what is told, or make several parts.
const NOT_HERE: [&str; 12] = [
    "output",
    "report",
    "quiet",
    "json",
    "best",
    "count",
    "no-contact-sheet",
    "preset",
    "tile",
    "view",
    "show",
    "pixels",
];

/// The extension of a word by which a file with a curve is named.
const CURVE_FILES: [&str; 2] = ["path:", "points:"];

/// A plain strip: the options of a band that have nothing to do with a pattern.
#[derive(Debug, Args)]
struct StripArguments {
    #[arg(id = "strip", value_parser = values::curve)]
    along: CurveSpec,
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    width: Option<f64>,
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    gap: Option<f64>,
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    twist: Option<Twist>,
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    round: Option<f64>,
    #[command(flatten)]
    make: MakeArgs,
    #[command(flatten)]
    tolerances: ToleranceArguments,
}

/// A plain plate.
#[derive(Debug, Args)]
struct PlateArguments {
    #[arg(id = "plate", value_parser = values::size)]
    size: RectSize,
    #[command(flatten)]
    make: MakeArgs,
    #[command(flatten)]
    tolerances: ToleranceArguments,
}

/// A file with a solid.
#[derive(Debug, Args)]
struct ModelArguments {
    #[arg(id = "model")]
    file: PathBuf,
}

/// What a part is made from, and the files that this reads.
pub(super) struct Made {
    pub(super) making: Making,
    pub(super) files: Vec<PathBuf>,
    /// The least width that its material has, in millimetres; 0 where none was asked for.
    pub(super) min_feature_mm: f64,
}

/// The parser of the options of a kind of part.
pub(super) fn command(kind: &str) -> Command {
    let own = |name: &'static str| Command::new(name);
    match kind {
        "strip" => StripArguments::augment_args(own("strip")),
        "plate" => PlateArguments::augment_args(own("plate")),
        "model" => ModelArguments::augment_args(own("model")),
        _ => Arguments::command().find_subcommand(kind).expect("a kind of part is a command").clone(),
    }
}

/// The options of a command that a part may have.
pub(super) fn options(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|arg| arg.get_long().is_some_and(|long| !NOT_HERE.contains(&long)))
}

/// Reads what a part is made from. Options of `every` part are taken where the part does not speak of them.
pub(super) fn read(table: &Table<'_>, every: Option<&Table<'_>>, folder: &Path) -> Result<Made, CliError> {
    let kinds: Vec<Entry<'_>> = table.entries().filter(|entry| KINDS.contains(&entry.key)).collect();
    let [kind] = &kinds[..] else {
        let found = if kinds.is_empty() { "is made from nothing" } else { "is made from several things" };
        let wanted = format!("give it one of {}", KINDS.join(", "));
        return Err(table.wrong(found, &wanted).into());
    };
    let command = command(kind.key);
    let known = || options(&command).map(name_of).chain(KINDS).chain(OWN);
    let mut typed =
        Typed { folder, first: String::new(), words: Vec::new(), files: Vec::new(), entries: Vec::new() };
    for entry in table.entries().filter(|entry| entry.key != kind.key && !OWN.contains(&entry.key)) {
        let arg = options(&command).find(|arg| name_of(arg) == entry.key);
        typed.add(arg.ok_or_else(|| entry.unknown(known()))?, &entry)?;
    }
    for entry in every.iter().flat_map(|every| every.entries()) {
        let is_said = table.get(entry.key).is_some();
        if let Some(arg) = options(&command).find(|arg| !is_said && name_of(arg) == entry.key) {
            typed.add(arg, &entry)?;
        }
    }
    let points = points(table, kind, &mut typed)?;
    if !(kind.key == "strip" && points.is_some()) {
        let beginning = kind.text()?.to_owned();
        typed.begin(kind.key, &beginning);
    }
    if command.get_arguments().any(|arg| arg.get_long() == Some("output")) {
        typed.words.push("--output=part.stl".into());
    }
    made(kind.key, &command, typed, table, points)
}

/// Words of a command line, and where they come from.
struct Typed<'p, 't> {
    folder: &'p Path,
    /// What the command line begins with in help, and ends with here.
    first: String,
    /// The options.
    words: Vec<OsString>,
    files: Vec<PathBuf>,
    entries: Vec<Entry<'t>>,
}

impl<'t> Typed<'_, 't> {
    fn add(&mut self, arg: &Arg, entry: &Entry<'t>) -> Result<(), SceneError> {
        let is_path = arg.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        let read = words(arg, entry.value.get_ref()).map_err(|wanted| entry.wrong(wanted))?;
        for word in read {
            let text = word.to_string_lossy().into_owned();
            let (option, value) = text.split_once('=').unwrap_or((&text, ""));
            let value = match name_of(arg) {
                _ if is_path => self.path(value),
                "drape" => self.drape(value),
                _ => self.curve(value),
            };
            self.words.push(if value.is_empty() {
                option.into()
            } else {
                format!("{option}={value}").into()
            });
        }
        self.entries.push(entry.clone());
        Ok(())
    }

    /// What a part begins with: a file, or a curve or a size.
    fn begin(&mut self, kind: &str, value: &str) {
        self.first = match kind {
            "plate" => value.to_owned(),
            "strip" => self.curve(value),
            _ => self.path(value),
        };
    }

    /// A path from the folder of the scene.
    fn path(&mut self, name: &str) -> String {
        let path = self.folder.join(name);
        self.files.push(path.clone());
        path.to_string_lossy().into_owned()
    }

    /// A height field in a file, with what is said of it behind a comma.
    fn drape(&mut self, text: &str) -> String {
        let (name, rest) = text.split_once(',').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let path = self.path(name);
        rest.map_or_else(|| path.clone(), |rest| format!("{path},{rest}"))
    }

    /// A curve, whose file is looked for from the folder of the scene.
    fn curve(&mut self, text: &str) -> String {
        match CURVE_FILES.into_iter().find_map(|kind| Some((kind, text.strip_prefix(kind)?))) {
            Some((kind, name)) => {
                let (name, id) = name.split_once('#').map_or((name, None), |(name, id)| (name, Some(id)));
                let path = self.path(name);
                format!("{kind}{path}{}", id.map_or_else(String::new, |id| format!("#{id}")))
            }
            None => text.to_owned(),
        }
    }
}

/// The points that stand in the scene itself; the curve is named after the scene then.
fn points<'t>(
    table: &Table<'t>,
    kind: &Entry<'t>,
    typed: &mut Typed<'_, 't>,
) -> Result<Option<Points>, SceneError> {
    let closed = table.get("closed");
    let Some(entry) = table.get("points") else {
        return closed.map_or(Ok(None), |closed| {
            Err(closed.because(
                "has no points",
                "it says whether the curve through points is closed: give points, or leave it out",
            ))
        });
    };
    if !["band", "strip"].contains(&kind.key) {
        return Err(entry.because("is for a curve", "only a band or a strip follows one"));
    }
    if table.get("along").is_some() {
        return Err(entry.because("is a curve, and along is another", "leave one of them out"));
    }
    let points =
        Points { points: entry.points()?, is_closed: closed.map_or(Ok(false), |closed| closed.truth())? };
    let curve = format!("points:{}", table.source.file.display());
    match kind.key {
        "strip" if kind.truth().is_ok_and(|is_strip| is_strip) => typed.first = curve,
        "strip" => {
            return Err(kind.because("is a curve, and points are another", "write strip = true with points"));
        }
        _ => typed.words.push(format!("--along={curve}").into()),
    }
    Ok(Some(points))
}

/// The words parsed and judged by the command.
fn made(
    kind: &str,
    command: &Command,
    typed: Typed<'_, '_>,
    table: &Table<'_>,
    points: Option<Points>,
) -> Result<Made, CliError> {
    let entries = typed.entries;
    let words: Vec<OsString> =
        [kind.into()].into_iter().chain(typed.words).chain(["--".into(), typed.first.into()]).collect();
    let told = |error: clap::Error| told(&error, &entries, table);
    let matches = command.clone().try_get_matches_from(words).map_err(told)?;
    let parsed = "what was parsed has its arguments";
    let no_command = |print: PrintOptions| PrintOptions { command: None, ..print };
    let files = typed.files;
    let (making, min_feature_mm) = match kind {
        "band" => {
            let arguments = BandArguments::from_arg_matches(&matches).expect(parsed);
            let pattern = &arguments.pattern.part;
            let space = SpaceOptions { gap_mm: arguments.gap, twist: arguments.twist.clone(), points };
            let builder = run::builder(&arguments)?.space(space).print(no_command(pattern.print.options()));
            let made = pattern.make.made(&pattern.tolerances)?;
            (Making::Band(Box::new(builder.build()?)), made.min_feature_mm)
        }
        "rect" => {
            let arguments = RectArguments::from_arg_matches(&matches).expect(parsed);
            let pattern = &arguments.pattern.part;
            let made = pattern.make.made(&pattern.tolerances)?;
            let print = no_command(pattern.print.options());
            (Making::Rect(Box::new(rect::job(&arguments, |band| band.print(print))?)), made.min_feature_mm)
        }
        "surface" => {
            let arguments = SurfaceArguments::from_arg_matches(&matches).expect(parsed);
            let pattern = &arguments.pattern.part;
            let made = pattern.make.made(&pattern.tolerances)?;
            let print = no_command(pattern.print.options());
            (Making::Band(Box::new(surface::job(&arguments, |band| band.print(print))?)), made.min_feature_mm)
        }
        "extrude" => {
            let arguments = ExtrudeArguments::from_arg_matches(&matches).expect(parsed);
            let (mut making, bridges) = extrude::making(&arguments)?;
            making.print = no_command(making.print);
            let min_feature_mm = making.tolerances.min_feature_mm();
            (Making::Extrude { file: arguments.file, making: Box::new(making), bridges }, min_feature_mm)
        }
        "strip" => {
            let arguments = StripArguments::from_arg_matches(&matches).expect(parsed);
            let made = arguments.make.made(&arguments.tolerances)?;
            let strip = Strip::new(arguments.along, |mut options| {
                options = options.thickness_mm(made.thickness_mm).chord_mm(made.chord_mm);
                options = options.min_feature_mm(made.min_feature_mm).min_gap_mm(made.min_gap_mm);
                options =
                    options.space(SpaceOptions { gap_mm: arguments.gap, twist: arguments.twist, points });
                options = arguments.width.into_iter().fold(options, |options, width| options.width_mm(width));
                arguments.round.into_iter().fold(options, |options, radius| options.round_mm(radius))
            })?;
            (Making::Strip(Box::new(strip)), made.min_feature_mm)
        }
        "plate" => {
            let arguments = PlateArguments::from_arg_matches(&matches).expect(parsed);
            let made = arguments.make.made(&arguments.tolerances)?;
            let (size, thickness_mm) = (arguments.size, made.thickness_mm);
            (Making::Plate { size, thickness_mm }, made.min_feature_mm)
        }
        _ => {
            let arguments = ModelArguments::from_arg_matches(&matches).expect(parsed);
            (Making::Model { file: arguments.file }, 0.0)
        }
    };
    Ok(Made { making, files, min_feature_mm })
}

/// What the parser found wrong, with the line of the key that it speaks of.
fn told(error: &clap::Error, entries: &[Entry<'_>], table: &Table<'_>) -> SceneError {
    let text = error.to_string();
    let text = text.split("\n\nUsage").next().unwrap_or_default();
    let text = text.split("\n\nFor more").next().unwrap_or_default().trim_start_matches("error: ");
    let line = text.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let named = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(name)) => name.trim_start_matches("--").split([' ', '=']).next(),
        _ => None,
    };
    match entries.iter().find(|entry| Some(entry.key) == named) {
        Some(entry) => entry.because("is not right", &line),
        None => table.wrong("is not right", &line),
    }
}
