//! `openwork fill`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::args::PartArguments;
use super::laser::say_cuts;
use super::progress::Progress;
use super::run::{BRIDGES_SHOWN, CliError, destinations, say_bridges, say_flat, say_notes, say_quantities};
use super::surface::OnModelArguments;
use super::values;
use crate::domain::{CurveSpec, FillDomain, Twist};
use crate::job::{
    CloneSpec, FillBuilder, FillJob, FillReport, JobError, Output, SampleBorder, SampleOptions, SampleStart,
    SampleWithout, SpaceOptions, UnmatchedPrice,
};

/// What follows the options in the help of `fill`.
pub(super) const HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.
Positions in messages are millimetres from the lower left corner of the page, y up.
The exemplar is learnt from as it is drawn: a stroke without a fill is a curve, what is filled is an element that is
copied as a whole, and so is a group (g) that directly holds a fill, with all that is in it. Layers, and a group that
holds everything, only sort a drawing.
What is asked for is met by edges that the pattern nearly has; what these cannot give, bridges do, and the report lists
each. Without --components and --holes the pattern has as many as it comes with.

Examples:
  A panel of branches, as they come, and in one piece:
    openwork fill branches.svg --domain rect:200x150mm -o panel.svg
    openwork fill branches.svg --domain rect:200x150mm --components 1 --frame 2mm -o lace.stl -o lace.png
  The inside of a shape drawn elsewhere, whose inner outlines are holes:
    openwork fill scales.svg --domain shirt.svg#front --components 1 --seed 7 -o front.svg
  A ring, 20 mm wide, whose middle line is a circle:
    openwork fill waves.svg --domain band --along circle:90mm --width 20mm --components 1 -o ring.svg
  A bracelet that stands, in one piece:
    openwork fill leaves.svg --domain band --along ring:65mm --width 30mm --components 1 --frame 1.5mm -o bracelet.stl
  A bracelet for a vase, which fits around it at half of its height; --mode emboss makes both one, as openwork surface does:
    openwork fill leaves.svg --domain band --mesh vase.stl --around 50% --width 14mm --components 1 -o ring.stl
  Go on from strokes that are there, with a finer look around:
    openwork fill branches.svg --domain rect:200x150mm --keep begun.svg --radii 16,12,9mm --spacing 10,7,5mm -o whole.svg
  A corner of the exemplar, 30 mm wide and 20 mm high, copied to a place:
    openwork fill branches.svg --domain rect:200x150mm --clone '0,0,30x20->150,100' -o panel.svg

Exit codes: 0 done; 2 the input or an argument is wrong; 3 what was asked for cannot be met;
4 the result failed verification and nothing was written; 1 a bug of ours.";

#[derive(Debug, Args)]
pub(super) struct FillArguments {
    /// The ornament to learn from: strokes, filled shapes and groups of them (SVG)
    exemplar: PathBuf,
    /// What is filled: rect:200x150mm; FILE.svg#id or FILE.svg, the inside of a closed path, where outlines inside of others are holes;
    /// or band, the strip along a curve, with --along and --width
    #[arg(long, value_name = "AREA", value_parser = str::parse::<FillDomain>)]
    domain: FillDomain,
    /// How the pattern is made: samples, a graph of samples whose neighbourhoods are like the exemplar's. (openwork band and rect cut the
    /// exemplar into pieces instead)
    #[arg(long, value_name = "NAME", value_parser = ["samples"], default_value = "samples")]
    engine: String,
    /// The curve of --domain band, which its middle line follows: line:120mm, circle:65mm (its diameter), path:FILE.svg or
    /// path:FILE.svg#id. In space, where drawings are the pattern laid flat: ring:65mm, helix:65mm,pitch=20mm,turns=3 (inner diameters),
    /// points:FILE.csv or points:FILE.obj
    #[arg(long, value_name = "SPEC", value_parser = values::curve, conflicts_with = "mesh")]
    along: Option<CurveSpec>,
    /// How wide the strip of --domain band is
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    width: Option<f64>,
    /// Leave a ring open, so wide straight across the inside: a cuff
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    gap: Option<f64>,
    /// Turn a band in space about its curve: degrees over the whole length, or a table of places in mm with degrees, as
    /// 0:0,40:90,120:90
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    twist: Option<Twist>,
    #[command(flatten)]
    model: OnModelArguments,
    /// Round corners of --along to this radius [default: a corner is an error]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    round: Option<f64>,
    /// So many connected components: a number, a range with both ends as 2..5, or any
    #[arg(long, value_name = "N", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    components: values::Count,
    /// So many holes: a number, a range or any
    #[arg(long, value_name = "M", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    holes: values::Count,
    /// What random choices come from: another number, another pattern; the same one, the same bytes
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
    /// Levels, from coarse to fine: 1, 2 or 3 [default: as many as --radii or --spacing has, or 3]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    levels: Option<usize>,
    /// Radius of neighbourhoods at each level, from coarse to fine, as 12,10,8mm: more sees larger motifs and takes longer. 20 to 30
    /// samples in each are usual [default: in proportion to the exemplar, and no larger than the domain is wide]
    #[arg(long, value_name = "LENGTHS", value_parser = values::lengths, allow_hyphen_values = true)]
    radii: Option<values::Lengths>,
    /// Spacing of samples along curves at each level, as 8,6,5mm: less follows finer bends and takes longer [default: in proportion to the
    /// exemplar]
    #[arg(long, value_name = "LENGTHS", value_parser = values::lengths, allow_hyphen_values = true)]
    spacing: Option<values::Lengths>,
    /// Searches and assignments at each level; 0 leaves the pattern as it begins
    #[arg(long, value_name = "N", default_value_t = SampleOptions::default().iterations, allow_negative_numbers = true)]
    iterations: usize,
    /// How it begins: patches of the exemplar, each suiting those around it, or noise, single samples
    #[arg(long, value_name = "WAY", value_parser = ["patches", "noise"], default_value = "patches")]
    start: String,
    /// Draw all strokes so wide; those of --keep stay as they are [default: as wide as the exemplar's]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    stroke: Option<f64>,
    /// A stroke so wide along the border of the domain, which belongs to the pattern
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    frame: Option<f64>,
    /// The width of bridges, which join components and open holes where no edge of the pattern does [default: that of the pen]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    bridge: Option<f64>,
    /// Strokes that are there already, in the domain or beside it (of a strip, in it), and stay as they are; the pattern goes on from them.
    /// Shapes in the file stay too, and the pattern runs up to them and under them. Drawn on the page of the domain's file; of a rectangle or
    /// a strip, from its lower left corner
    #[arg(long, value_name = "FILE.svg")]
    keep: Option<PathBuf>,
    /// Copy a box of the exemplar to a place, where it stays whole; the pattern goes on from it. In mm from lower left corners, of the
    /// exemplar's page and of the domain: X,Y,WxH->X,Y; may be repeated
    #[arg(long, value_name = "SRC->DST", value_parser = str::parse::<CloneSpec>, allow_hyphen_values = true)]
    clone: Vec<CloneSpec>,
    #[command(flatten)]
    part: PartArguments,
    /// A file to write: .svg, .dxf, .stl, .3mf, .obj or .png; may be repeated; - is SVG on standard output
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Write a report of what was asked for, made and measured (JSON; - for standard output)
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Say nothing but errors
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    method: MethodArguments,
}

/// The constants of Tu 2020, with the paper's values unless the help says otherwise.
#[derive(Debug, Args)]
#[command(next_help_heading = "Constants of the method")]
struct MethodArguments {
    /// How it ends at the border: cut, made beyond it and cut there, or within, kept inside as in the paper
    #[arg(long, value_name = "WAY", value_parser = ["cut", "within"], default_value = "cut")]
    border: String,
    /// Leave parts of the method out, to see what they are for: edges, robust, existence, orientation. Several as edges,robust
    #[arg(long, value_name = "PARTS", value_delimiter = ',', value_parser = ["edges", "robust", "existence", "orientation"])]
    without: Vec<String>,
    /// Weight of attributes beside positions (gamma, Eq. 8)
    #[arg(long, value_name = "WEIGHT", default_value_t = SampleOptions::default().attribute_weight, allow_negative_numbers = true)]
    attribute_weight: f64,
    /// Price of an edge too many or too few, in spacings (beta, Eq. 5)
    #[arg(long, value_name = "PRICE", default_value_t = SampleOptions::default().edge_count_price, allow_negative_numbers = true)]
    edge_count_price: f64,
    /// Price of an unmatched sample without edges, in spacings (section 4.2.3)
    #[arg(long, value_name = "PRICE", default_value_t = UnmatchedPrice::default().least, allow_negative_numbers = true)]
    unmatched_least: f64,
    /// More of it for each edge, in spacings
    #[arg(long, value_name = "PRICE", default_value_t = UnmatchedPrice::default().per_edge, allow_negative_numbers = true)]
    unmatched_per_edge: f64,
    /// Price of an unmatched sample at the most, in spacings
    #[arg(long, value_name = "PRICE", default_value_t = UnmatchedPrice::default().most, allow_negative_numbers = true)]
    unmatched_most: f64,
    /// Price of an unmatched sample of an element, in distances between neighbours
    #[arg(long, value_name = "PRICE", default_value_t = UnmatchedPrice::default().element, allow_negative_numbers = true)]
    unmatched_element: f64,
    /// Price of a sample that the pattern lacks, in spacings; the paper's is 0
    #[arg(long, value_name = "PRICE", default_value_t = SampleOptions::default().missing_price, allow_negative_numbers = true)]
    missing_price: f64,
    /// Neighbourhoods vote with their cost to minus this power; the paper's is 0
    #[arg(long, value_name = "POWER", default_value_t = SampleOptions::default().vote_power, allow_negative_numbers = true)]
    vote_power: f64,
    /// Neighbours in the graph that the search follows (section 4.3.3)
    #[arg(long, value_name = "N", default_value_t = SampleOptions::default().search_neighbours, allow_negative_numbers = true)]
    search_neighbours: usize,
    /// Passes of the search in the first iteration of a level, and in those after
    #[arg(long, value_name = "N,N", value_parser = values::pair::<usize>, default_value_t = values::Pair(SampleOptions::default().passes), allow_hyphen_values = true)]
    passes: values::Pair<usize>,
    /// Largest and smallest window of the random search, in parts of the exemplar's longer side
    #[arg(long, value_name = "PART,PART", value_parser = values::pair::<f64>, default_value_t = values::Pair(SampleOptions::default().windows), allow_hyphen_values = true)]
    windows: values::Pair<f64>,
    /// Samples are removed that are believed in less than this, and added that are more (section 4.3.4)
    #[arg(long, value_name = "PART", default_value_t = SampleOptions::default().least_existence, allow_negative_numbers = true)]
    least_existence: f64,
    /// Edges are not made that are believed in less than this; the paper's is 0
    #[arg(long, value_name = "PART", default_value_t = SampleOptions::default().least_edge, allow_negative_numbers = true)]
    least_edge: f64,
    /// Candidates nearer than this to a cluster are of it, in spacings (Algorithm 1)
    #[arg(long, value_name = "PART", default_value_t = SampleOptions::default().cluster, allow_negative_numbers = true)]
    cluster: f64,
    /// Directions within so many degrees of opposite are one path (section 4.4.2)
    #[arg(long, value_name = "DEGREES", default_value_t = 20.0, allow_negative_numbers = true)]
    opposite: f64,
}

impl MethodArguments {
    /// The constants; levels are set apart.
    fn constants(&self, arguments: &FillArguments) -> SampleOptions {
        let leaves_out = |part: &str| self.without.iter().any(|word| word == part);
        SampleOptions {
            levels: Vec::new(),
            iterations: arguments.iterations,
            seed: arguments.seed,
            start: if arguments.start == "noise" { SampleStart::Noise } else { SampleStart::Patches },
            border: if self.border == "within" { SampleBorder::Within } else { SampleBorder::Cut },
            attribute_weight: self.attribute_weight,
            edge_count_price: self.edge_count_price,
            unmatched: UnmatchedPrice {
                least: self.unmatched_least,
                per_edge: self.unmatched_per_edge,
                most: self.unmatched_most,
                element: self.unmatched_element,
            },
            missing_price: self.missing_price,
            vote_power: self.vote_power,
            search_neighbours: self.search_neighbours,
            passes: self.passes.0,
            windows: self.windows.0,
            least_existence: self.least_existence,
            least_edge: self.least_edge,
            cluster: self.cluster,
            opposite: self.opposite.to_radians(),
            without: SampleWithout {
                edges: leaves_out("edges"),
                robust: leaves_out("robust"),
                existence: leaves_out("existence"),
                orientation: leaves_out("orientation"),
            },
        }
    }
}

pub(super) fn run(arguments: &FillArguments) -> Result<ExitCode, CliError> {
    let (outputs, report_target) = destinations(&arguments.output, arguments.report.as_ref())?;
    let job = job(arguments)?;
    job.check_outputs(&outputs, report_target.as_ref())?;
    let progress = Progress::new(arguments.quiet, outputs.iter().map(Output::target).chain(&report_target));
    let fill = job.run(&mut |stage| progress.show(stage))?;
    let report = fill.write(&outputs, report_target.as_ref(), &mut |stage| progress.show(stage))?;
    drop(progress);
    if !arguments.quiet {
        say_fill(&report);
    }
    Ok(ExitCode::SUCCESS)
}

fn job(a: &FillArguments) -> Result<FillJob, CliError> {
    let making = a.part.making(&a.output)?;
    let mut builder = FillBuilder::new(&a.exemplar, a.domain.clone())
        .constants(a.method.constants(a))
        .making(making)
        .space(SpaceOptions { gap_mm: a.gap, twist: a.twist.clone(), points: None });
    match (&a.along, a.model.options(&a.part.make)?, a.width) {
        (Some(along), _, Some(width_mm)) => builder = builder.along(along.clone(), width_mm),
        (None, Some(surface), Some(width_mm)) => builder = builder.on_model(surface, width_mm),
        (None, None, None) => {}
        (along, surface, width_mm) => {
            let (option, wanted) = match (along, surface, width_mm) {
                (.., Some(_)) => {
                    ("--width", "give --along too, as --along circle:65mm, or --mesh for a band on a model")
                }
                (Some(_), ..) => ("--along", "give --width too, as --width 20mm"),
                _ => ("--mesh", "give --width too, as --width 20mm"),
            };
            let found = "a band needs the curve that it follows, and how wide it is".to_owned();
            return Err(JobError::Option { option, found, wanted: wanted.to_owned() }.into());
        }
    }
    let set = |builder: FillBuilder, value: Option<f64>, set: fn(FillBuilder, f64) -> FillBuilder| match value
    {
        Some(mm) => set(builder, mm),
        None => builder,
    };
    builder = set(builder, a.round, FillBuilder::round_mm);
    builder = set(builder, a.stroke, FillBuilder::stroke_mm);
    builder = set(builder, a.frame, FillBuilder::frame_mm);
    builder = set(builder, a.bridge, FillBuilder::bridge_mm);
    if let Some(components) = a.components.0 {
        builder = builder.components(components);
    }
    if let Some(holes) = a.holes.0 {
        builder = builder.holes(holes);
    }
    if let Some(levels) = a.levels {
        builder = builder.levels(levels);
    }
    if let Some(radii) = &a.radii {
        builder = builder.radii_mm(radii.0.clone());
    }
    if let Some(spacing) = &a.spacing {
        builder = builder.spacing_mm(spacing.0.clone());
    }
    if let Some(keep) = &a.keep {
        builder = builder.keep(keep);
    }
    Ok(a.clone.iter().fold(builder, |builder, clone| builder.copied(*clone)).build()?)
}

fn say_fill(report: &FillReport) {
    let samples = report.levels.last().map_or(0, |level| level.samples);
    let neighbours = report.levels.last().map_or(0.0, |level| level.neighbours);
    say!(
        "{} component(s), {} hole(s) on {:.1} cm2: {samples} samples with {neighbours:.0} neighbours each",
        report.components,
        report.holes,
        report.domain_mm2 / 100.0
    );
    say_flat(report.flat.as_ref());
    say_densities(report);
    let mut kinds: Vec<&str> = report.changes.iter().map(|change| change.kind).collect();
    kinds.sort_unstable();
    let counted: Vec<String> =
        kinds.chunk_by(|a, b| a == b).map(|same| format!("{} {}", same.len(), same[0])).collect();
    if !counted.is_empty() {
        say!("{} change(s): {}; --report lists their positions", kinds.len(), counted.join(", "));
    }
    if report.wanted_components.is_some() || report.wanted_holes.is_some() {
        say!("by itself, tidied, the pattern has {}", report.own);
    }
    say_bridges(report.bridges.as_ref(), BRIDGES_SHOWN);
    let widths = [("ink", &report.narrow_places.ink), ("gap", &report.narrow_places.gaps)];
    for (what, narrowest) in widths.iter().filter_map(|(what, places)| places.first().map(|n| (what, n))) {
        let p = narrowest.position_mm;
        say!("narrowest {what} {:.3} mm, at ({:.1}, {:.1}) mm", narrowest.width_mm, p.x, p.y);
    }
    say_quantities(Some(&report.quantities));
    say_cuts(report.laser.as_ref());
    say_notes(&report.notes);
    for file in &report.files {
        say!("wrote {file}");
    }
}

/// Counts on less than this part of what the exemplar's were taken on say nothing.
const LEAST_COUNTED: f64 = 0.25;

/// What there is on an area like the exemplar's, but for what was asked for.
fn say_densities(report: &FillReport) {
    let (made, learnt) = (&report.density, &report.exemplar_density);
    if made.area_mm2 < LEAST_COUNTED * learnt.area_mm2 {
        return;
    }
    let counts = [
        ("component(s)", made.components, learnt.components, report.wanted_components.is_none()),
        ("hole(s)", made.holes, learnt.holes, report.wanted_holes.is_none()),
        ("free end(s)", made.dangling_ends, learnt.dangling_ends, true),
    ];
    let told = counts.iter().filter(|(.., is_free)| *is_free);
    let told = told.map(|(what, made, learnt, _)| format!("{made:.1} {what} ({learnt:.1})"));
    say!("on 100 cm2 away from the border (in the exemplar): {}", told.collect::<Vec<_>>().join(", "));
}
