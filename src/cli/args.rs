//! The arguments as they are typed. This one definition makes the parser and the help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::build::BuildArguments;
use super::fill::FillArguments;
use super::laser::LaserArgs;
use super::make::MakeArgs;
use super::picture::PictureArgs;
use super::preset::PresetArgs;
use super::print::PrintArgs;
use super::run::CliError;
use super::shell::{CompletionsArguments, ManArguments};
use super::surface::{SURFACE_HELP, SurfaceArguments};
use super::values;
use crate::domain::{CurveSpec, RectSize, Roll, Twist};
use crate::job::{Drape, FlatMaking, KeptRange, SlicingChoice, StitchMethod};
use crate::planar::Tolerances;

/// Ornament that can be made: new pattern from one SVG ornament, with exactly the components and holes you ask
/// for, written as a part and counted again on the file.
#[derive(Debug, Parser)]
#[command(name = "openwork", version, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Synthesize a band along a line, a circle or any path, and write it as SVG, DXF, STL, 3MF, OBJ or PNG
    #[command(after_help = BAND_HELP)]
    Band(Box<BandArguments>),
    /// Synthesize a rectangle, in both directions, and write it as SVG, DXF, STL, 3MF, OBJ or PNG
    #[command(after_help = RECT_HELP)]
    Rect(Box<RectArguments>),
    /// Fill an area with a pattern of curves and elements, as rectangles, drawn shapes with holes and rings
    #[command(after_help = super::fill::HELP)]
    Fill(Box<FillArguments>),
    /// Synthesize a band on a model (STL, 3MF, OBJ): a part that fits it, standing out from it, or carved out of it
    #[command(after_help = SURFACE_HELP)]
    Surface(Box<SurfaceArguments>),
    /// Show how an exemplar is understood: critical points, cuts, pieces, portals, descriptors
    #[command(after_help = ANALYZE_HELP)]
    Analyze(AnalyzeArguments),
    /// Extrude any SVG, as it is, to a verified solid, or turn it into cut lines
    #[command(after_help = EXTRUDE_HELP)]
    Extrude(Box<ExtrudeArguments>),
    /// Build a scene: several parts in their places, joined into one solid
    #[command(after_help = super::build::HELP)]
    Build(BuildArguments),
    /// Count components and holes (SVG, DXF) or shells and genus (STL, 3MF, OBJ) of a file, and check them
    #[command(after_help = VERIFY_HELP)]
    Verify(VerifyArguments),
    /// Print the JSON schema of every option, as presets have them, and of every report
    Schema,
    /// Print what completes the arguments in a shell
    Completions(CompletionsArguments),
    /// Print the manual page, or write those of all commands
    Man(ManArguments),
}

const BAND_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.
Positions in messages are millimetres from the lower left corner of the page, y up.
In a PNG, struts of --bridge are orange and slits are green.
The middle line of the band follows the curve. A flat ring along circle:65mm that is 14mm wide is 65 - 14 = 51 mm
inside and 65 + 14 = 79 mm outside.

Examples:
  A bracelet in one piece that closes on itself:
    openwork band vine.svg --along circle:65mm --width 14mm --components 1 --closed-pattern \\
                  -o bracelet.stl -o bracelet.svg
  A bracelet that stands, a cuff with an opening of 25 mm, and a picture of it:
    openwork band vine.svg --along ring:65mm --width 14mm --components 1 --closed-pattern -o bracelet.stl
    openwork band vine.svg --along ring:65mm --gap 25mm --width 20mm --components 1 -o cuff.3mf -o cuff.png --view iso
  A border of 24 cm with a picture of it:
    openwork band scroll.svg --along line:240mm --components 1 -o border.svg -o border.png
  Along a path drawn elsewhere, for a nozzle of 0.4 mm:
    openwork band lace.svg --along path:collar.svg#edge --min-feature 0.4mm -o collar.stl
  A stencil from an ornament of many parts: one piece, nothing that falls out:
    openwork band foliage.svg --along line:240mm --components 1 --holes 0 --bridge 1mm -o stencil.svg
  A border to be cut by a laser, and a sign from whose plate nothing falls out:
    openwork band scroll.svg --along line:240mm --components 1 --kerf 0.15mm -o border.dxf
    openwork band scroll.svg --along line:240mm --holes 0 --bridge 1mm --sheet 300x100mm --carve -o sign.dxf -o sign.png
  Twelve different bands of the same ornament, and vine-sheet.png to choose from:
    openwork band vine.svg --along line:120mm --components 1 --count 12 --seed 7 -o vine.svg

Exit codes: 0 done; 2 the input or an argument is wrong; 3 the constraints cannot be met;
4 the result failed verification and nothing was written; 1 a bug of ours.";

const RECT_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.
The pattern is made along the width, turned by 90 degrees and used as the exemplar along the height. What is
asked for holds for the finished rectangle, which the ink fills from side to side. Rows may also be used upside
down, so that the pattern goes on as its own reflection, as it does in lace; often every second row is.

Examples:
  A panel in one piece:
    openwork rect vine.svg --size 120x80mm --components 1 -o panel.svg -o panel.stl
  With smaller rows, and a report of what was tried:
    openwork rect scroll.svg --size 120x80mm --width 8mm -o panel.svg --report panel.json
  A lamp shade in one piece, narrower at its top:
    openwork rect vine.svg --roll diameter=90mm,top=60mm --height 110mm --components 1 -o shade.stl
  Laid over a hill of 20 mm, drawn in greys:
    openwork rect lace.svg --size 160x100mm --drape hill.png,height=20mm --components 1 -o dish.stl

Exit codes: 0 done; 2 the input or an argument is wrong; 3 the constraints cannot be met;
4 the result failed verification and nothing was written; 1 a bug of ours.";

const ANALYZE_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.

Examples:
  A table of the pieces:
    openwork analyze vine.svg
  A summary, and a picture of the cuts:
    openwork analyze vine.svg -o cuts.svg
  As JSON, at the height that a band is to have:
    openwork analyze vine.svg --width 14mm --json";

const EXTRUDE_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.

Examples:
  openwork extrude sign.svg --thickness 3mm -o sign.stl
  For a laser: arcs and lines, inner contours first, with the width of the beam taken into account:
    openwork extrude sign.svg --kerf 0.15mm -o sign.dxf
  With bevelled edges, for a printer of 220 mm:
    openwork extrude sign.svg --thickness 3mm --chamfer 0.5mm --bed 220x220mm --place -o sign.3mf
  A stencil of one's own drawing in one piece, from which nothing falls out, and a picture of where the bridges are
  (struts orange, slits green):
    openwork extrude letters.svg --bridge 1mm --components 1 --holes 0 -o stencil.svg -o stencil.png

Exit codes: 0 done; 2 the drawing or an argument is wrong; 3 there is no place for a bridge; 4 a file failed
verification and nothing was written; 1 a bug of ours.";

const VERIFY_HELP: &str = "\
Lengths take mm, cm, in, pt or px (96 to the inch); a bare number is millimetres.
Exit code 4 when the file is not as asked for, 2 when it cannot be read. Faults that leave the counts as they are
(elements that overlap, contours that touch) are listed and do not change the exit code.

Examples:
  One piece that a nozzle of 0.5 mm can print:
    openwork verify sign.svg --components 1 --holes 0..4 --min-feature 0.5mm
  A file for a laser: closed paths, nothing cut twice, nothing that crosses:
    openwork verify sign.dxf --components 1
  What a solid has, as JSON:
    openwork verify sign.stl --json
  Whether copies of a tile join, and what the tiling has:
    openwork verify tile.svg --tiles
  Whether a report proves the counts of the file that was written with it:
    openwork verify --certificate bracelet.json bracelet.svg
  And whether the pieces that it adds up are those of the exemplar:
    openwork verify --certificate bracelet.json --exemplar vine.svg bracelet.svg";

#[derive(Debug, Args)]
pub(super) struct BandArguments {
    /// The ornament to learn from (SVG)
    pub(super) exemplar: PathBuf,
    /// The curve, which the middle line of the band follows: line:120mm, circle:65mm (its diameter; inside, a flat ring
    /// measures 65mm less --width), path:FILE.svg or path:FILE.svg#id. In space, where drawings are the pattern laid flat:
    /// ring:65mm, a bracelet that stands on a cylinder (its diameter inside), helix:65mm,pitch=20mm,turns=3, and
    /// points:FILE.csv or points:FILE.obj, a smooth curve through points, closed if the last is the first
    #[arg(long, value_name = "SPEC", value_parser = values::curve)]
    pub(super) along: CurveSpec,
    /// Leave a ring open, so wide straight across the inside: a cuff
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) gap: Option<f64>,
    /// Turn a band in space about its curve: degrees over the whole length, or a table of places in mm with degrees, as
    /// 0:0,40:90,120:90
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub(super) twist: Option<Twist>,
    /// The pattern must go all the way round a closed curve
    #[arg(long)]
    pub(super) closed_pattern: bool,
    /// Round corners of the path to this radius [default: a corner is an error]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) round: Option<f64>,
    /// The K cheapest bands, none twice; files are numbered, as out-01.svg
    #[arg(long, value_name = "K", conflicts_with_all = ["seed", "count", "temperature"], allow_negative_numbers = true)]
    pub(super) best: Option<u16>,
    /// So many different bands drawn at random; files are numbered, as out-01.svg
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) count: Option<u16>,
    /// Leave out the contact sheet that --count and --best write beside the first file: out-sheet.png, a picture of all
    /// bands with their numbers
    #[arg(long, alias = "no-sheet")]
    pub(super) no_contact_sheet: bool,
    /// T, how wild bands drawn at random are: each is drawn with a probability in proportion to exp(-cost/T), and a jump
    /// costs 1. At 0.05 they are nearly the cheapest, at 0.16 there is a jump more in some thirty pieces, at 0.5 they jump
    /// every few pieces, from 2 on they are rubble [default: 0.16]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(super) temperature: Option<f64>,
    #[command(flatten)]
    pub(super) pattern: PatternArguments,
}

#[derive(Debug, Args)]
pub(super) struct RectArguments {
    /// The ornament to learn from (SVG)
    pub(super) exemplar: PathBuf,
    /// Width and height, such as 120x80mm
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true, required_unless_present = "roll", conflicts_with = "roll")]
    pub(super) size: Option<RectSize>,
    /// Roll the rectangle to a cylinder by its inner diameter, as diameter=120mm, or to a cone, as diameter=120mm,top=80mm. Its sides are
    /// joined, so that a shade is one piece; counts are those of what stands there, the way round being one of the holes
    #[arg(long, value_name = "ROLL", value_parser = values::roll, requires = "height")]
    pub(super) roll: Option<Roll>,
    /// How high a rolled rectangle stands
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_negative_numbers = true, requires = "roll", conflicts_with = "size")]
    pub(super) height: Option<f64>,
    /// Lay the rectangle over a height field that is stretched over it: a table of heights in mm, FILE.csv, or a picture whose white is
    /// so high, FILE.png,height=20mm. The sheet is a smooth surface led by the heights: between its neighbours, a single peak is rounded. Its sizes are those seen from above; what is rolled stands out by it
    #[arg(long, value_name = "FILE", value_parser = values::drape)]
    pub(super) drape: Option<Drape>,
    /// Make opposite sides match, so that copies join; the page is the tile, without a margin
    #[arg(long, conflicts_with = "roll")]
    pub(super) tile: bool,
    #[command(flatten)]
    pub(super) pattern: PatternArguments,
}

/// What a band and a rectangle share.
#[derive(Debug, Args)]
pub(super) struct PatternArguments {
    /// Height that the exemplar is scaled to: of the band, or of a rectangle's rows [default: the exemplar's own
    /// height, in a rectangle at most a quarter of it]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) width: Option<f64>,
    /// So many connected components: a number, a range with both ends as 2..5, or any
    #[arg(long, value_name = "N", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    pub(super) components: values::Count,
    /// So many holes: a number, a range or any; the inside of a closed ring is one
    #[arg(long, value_name = "M", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    pub(super) holes: values::Count,
    /// Where the exemplar is cut: reeb, between the places where strands begin, end, split or merge; reeb:LENGTH, but not
    /// for bumps and notches that reach less far than this along the exemplar (their persistence), so that more gives
    /// fewer and longer pieces; uniform:T, at T equally spaced lines
    #[arg(long, value_name = "RULE", value_parser = values::slicing, default_value = "reeb")]
    pub(super) slicing: SlicingChoice,
    /// Range of the exemplar that is never cut, as 10mm..24mm from its left edge at the size it has in the band
    /// (what analyze shows with the same --width); may be repeated
    #[arg(long, value_name = "X0..X1", value_parser = values::kept, allow_hyphen_values = true)]
    pub(super) keep: Vec<KeptRange>,
    /// Use every piece left for right as well
    #[arg(long)]
    pub(super) mirror: bool,
    /// A band drawn at random, the same for the same seed; in a rectangle, what the search prefers
    /// [default: the optimum]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) seed: Option<u64>,
    /// Weight of the autocorrelation, against repetition: 0.5 to 2 are mild, from 10 on the pattern is rubble
    #[arg(long, value_name = "BETA", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(super) variety: f64,
    /// What joins are chosen by: 1 is where strands meet only, 0 their directions only. Less where strands meet with kinks,
    /// more where they are bent far to meet
    #[arg(long, default_value_t = 0.8, allow_negative_numbers = true)]
    pub(super) alpha: f64,
    /// Cost of a jump, which is a join that is not in the exemplar. More, as 3, where the pattern looks chopped; less, as
    /// 0.3, where whole copies of the exemplar repeat; 0 allows short cycles
    #[arg(long, value_name = "LAMBDA", default_value_t = 1.0, allow_negative_numbers = true)]
    pub(super) jump_cost: f64,
    /// How pieces are bent to meet: warp, or lri (linear rotation-invariant deformation)
    #[arg(long, value_name = "METHOD", value_parser = values::stitch, default_value_t)]
    pub(super) stitch: StitchMethod,
    /// Memory that the search may take before it gives optimality up, as 512MB or 2GB; in a rectangle, each way that is
    /// tried takes 8MB at most
    #[arg(long, value_name = "SIZE", value_parser = values::memory, default_value = "2GB")]
    pub(super) memory_limit: usize,
    /// Partial sequences that the search looks at before it gives optimality up, in millions, of which one takes about a
    /// second; it then takes the best that a beam finds, and says how far from the optimum that may be [default: 4, more
    /// for long bands]
    #[arg(long, value_name = "MILLIONS", value_parser = values::effort, allow_hyphen_values = true)]
    pub(super) effort: Option<usize>,
    /// Join components by struts and open holes by slits of this width, as few and as short as can be, where the ornament
    /// cannot give the components or holes asked for, or only with many jumps: a bridge costs as much as half a jump
    /// [default: none, and what cannot be is refused]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) bridge: Option<f64>,
    #[command(flatten)]
    pub(super) part: PartArguments,
    /// A file to write: .svg, .dxf, .stl, .3mf, .obj or .png; may be repeated; - is SVG on standard output
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: Vec<PathBuf>,
    /// Write a report of what was asked for, made and measured (JSON; - for standard output)
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// What every command that makes a part has.
#[derive(Debug, Args)]
pub(super) struct PartArguments {
    #[command(flatten)]
    pub(super) tolerances: ToleranceArguments,
    #[command(flatten)]
    pub(super) print: PrintArgs,
    #[command(flatten)]
    pub(super) laser: LaserArgs,
    #[command(flatten)]
    pub(super) make: MakeArgs,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) preset: PresetArgs,
}

impl PartArguments {
    /// How a part that lies flat is to be made, for these outputs.
    pub(super) fn making(&self, outputs: &[PathBuf]) -> Result<FlatMaking, CliError> {
        let made = self.make.made(&self.tolerances)?;
        Ok(FlatMaking {
            thickness_mm: made.thickness_mm,
            tolerances: Tolerances::new(made.chord_mm, made.min_feature_mm, made.min_gap_mm)?,
            enforce: self.make.enforce,
            laser: self.laser.options(&made, outputs),
            material: made.material,
            print: self.print.options(),
            picture: self.picture.options(),
        })
    }
}

#[derive(Debug, Clone, Args)]
pub(super) struct ToleranceArguments {
    /// Narrowest ink the machine makes; counts must survive eroding by half of it [default: not checked]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) min_feature: Option<f64>,
    /// Narrowest gap the machine keeps open; counts must survive dilating by half of it [default: not checked]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) min_gap: Option<f64>,
    /// Greatest distance between a curve and what stands for it [default: that of the process, or 0.01mm]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) chord: Option<f64>,
}

#[derive(Debug, Args)]
pub(super) struct AnalyzeArguments {
    /// The ornament (SVG)
    pub(super) exemplar: PathBuf,
    /// Height to which the exemplar is scaled [default: its own]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) width: Option<f64>,
    /// Where the exemplar is cut: reeb, reeb:LENGTH or uniform:T (see openwork band --help)
    #[arg(long, value_name = "RULE", value_parser = values::slicing, default_value = "reeb")]
    pub(super) slicing: SlicingChoice,
    /// Range of the exemplar that is never cut, as 10mm..24mm from its left edge at this --width; may be repeated
    #[arg(long, value_name = "X0..X1", value_parser = values::kept, allow_hyphen_values = true)]
    pub(super) keep: Vec<KeptRange>,
    #[command(flatten)]
    pub(super) tolerances: ToleranceArguments,
    /// An overlay to write: .svg or .png; may be repeated; - is SVG on standard output
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,
    /// Print the analysis as JSON on standard output
    #[arg(long)]
    pub(super) json: bool,
    /// Print a row for each piece also when a picture is written
    #[arg(long, conflicts_with = "json")]
    pub(super) table: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct ExtrudeArguments {
    /// The drawing (SVG)
    pub(super) file: PathBuf,
    /// Lay bridges of this width so that the drawing has the components and holes asked for: struts join, slits open
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) bridge: Option<f64>,
    /// Components that bridges are to make: a number, a range or any [default: as drawn]
    #[arg(long, value_name = "N", value_parser = values::wanted, requires = "bridge", allow_negative_numbers = true)]
    pub(super) components: Option<values::Count>,
    /// Holes that bridges are to make: a number, a range or any [default: as drawn]
    #[arg(long, value_name = "M", value_parser = values::wanted, requires = "bridge", allow_negative_numbers = true)]
    pub(super) holes: Option<values::Count>,
    #[command(flatten)]
    pub(super) part: PartArguments,
    /// A file to write: .stl, .3mf, .obj, .svg (the outline, with its bridges), .dxf or .png; may be repeated; - is STL on
    /// standard output
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: Vec<PathBuf>,
    /// Print what was made and found as JSON on standard output, each bridge with its position
    #[arg(long)]
    pub(super) json: bool,
    /// Say nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    /// The file (.svg, .dxf, .stl, .3mf or .obj)
    pub(super) file: PathBuf,
    /// Read an .svg as lines to be cut, whatever paints them: material is what an odd number of them is around. Files that
    /// say so themselves, as those of --cut, are always read so
    #[arg(long)]
    pub(super) cut_lines: bool,
    /// The report that was written with the file: replay its certificate, step by step
    #[arg(long, value_name = "REPORT.json")]
    pub(super) certificate: Option<PathBuf>,
    /// The exemplar of the report: cut its pieces out again and compare them with the certificate
    #[arg(long, value_name = "EXEMPLAR.svg", requires = "certificate")]
    pub(super) exemplar: Option<PathBuf>,
    /// It must be a tile: opposite sides match, so that copies join (SVG). Tells what the tiling has
    #[arg(long)]
    pub(super) tiles: bool,
    /// Components (SVG) or shells (solids) that it must have: a number, a range with both ends as 1..2, or any
    #[arg(long, value_name = "N", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    pub(super) components: values::Count,
    /// Holes (SVG) or total genus (solids) that it must have: a number, a range or any
    #[arg(long, value_name = "M", value_parser = values::wanted, default_value = "any", hide_default_value = true, allow_negative_numbers = true)]
    pub(super) holes: values::Count,
    #[command(flatten)]
    pub(super) tolerances: ToleranceArguments,
    /// Print what was found as JSON on standard output
    #[arg(long)]
    pub(super) json: bool,
}
