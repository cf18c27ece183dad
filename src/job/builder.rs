//! Options of a band, checked before anything is computed.

use std::path::{Path, PathBuf};

use super::band::Band;
use super::choice::Choice;
use super::error::JobError;
use super::laser::LaserOptions;
use super::making;
use super::output::{Output, Target};
use super::picture::PictureOptions;
use super::plan::DEFAULT_MEMORY_LIMIT;
use super::print::PrintOptions;
use super::space::SpaceOptions;
use super::stage::Stage;
use super::surface::{Ground, SurfaceMode, SurfaceOptions};
use crate::domain::CurveSpec;
use crate::fabricate::Material;
use crate::fit::StitchMethod;
use crate::pieces::CostWeights;
use crate::planar::Tolerances;
use crate::reeb::KeptRange;
use crate::solver::Variety;
use crate::topology::{Goal, Wanted};

/// How the exemplar is sliced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SlicingChoice {
    /// Between topological events, with the default persistence for the exemplar's width.
    #[default]
    Reeb,
    /// Between events of at least this persistence in millimetres.
    Persistence(f64),
    /// At so many equally spaced lines.
    Uniform(usize),
}

/// Collects the options of a band. Lengths are millimetres.
#[derive(Debug, Clone)]
pub struct BandBuilder {
    pub(super) exemplar: PathBuf,
    pub(super) along: CurveSpec,
    pub(super) width_mm: Option<f64>,
    pub(super) goal: Goal,
    pub(super) slicing: SlicingChoice,
    pub(super) kept: Vec<KeptRange>,
    pub(super) mirror: bool,
    pub(super) seed: Option<u64>,
    pub(super) beta: f64,
    pub(super) weights: CostWeights,
    pub(super) thickness_mm: f64,
    pub(super) print: PrintOptions,
    pub(super) picture: PictureOptions,
    pub(super) round_mm: Option<f64>,
    pub(super) stitch: StitchMethod,
    pub(super) bridge_mm: Option<f64>,
    pub(super) choice: Choice,
    pub(super) contact_sheet: bool,
    pub(super) counted: bool,
    pub(super) memory_limit: usize,
    pub(super) effort: Option<usize>,
    pub(super) laser: LaserOptions,
    pub(super) enforce: bool,
    pub(super) material: Option<Material>,
    pub(super) space: SpaceOptions,
    pub(super) surface: Option<SurfaceOptions>,
    chord_mm: f64,
    min_feature_mm: f64,
    pub(super) min_gap_mm: f64,
}

/// The thickness of a solid when none is asked for, in millimetres: five layers or more of most printers.
const DEFAULT_THICKNESS_MM: f64 = 2.0;

impl BandBuilder {
    /// A band of the exemplar in an SVG file along a curve.
    pub fn new(exemplar: impl AsRef<Path>, along: CurveSpec) -> Self {
        Self {
            exemplar: exemplar.as_ref().to_owned(),
            along,
            width_mm: None,
            goal: Goal::default(),
            slicing: SlicingChoice::default(),
            kept: Vec::new(),
            mirror: false,
            seed: None,
            beta: 0.0,
            weights: CostWeights::default(),
            thickness_mm: DEFAULT_THICKNESS_MM,
            print: PrintOptions::default(),
            picture: PictureOptions::default(),
            round_mm: None,
            stitch: StitchMethod::default(),
            bridge_mm: None,
            choice: Choice::default(),
            contact_sheet: true,
            counted: false,
            memory_limit: DEFAULT_MEMORY_LIMIT,
            effort: None,
            laser: LaserOptions::default(),
            enforce: false,
            material: None,
            space: SpaceOptions::default(),
            surface: None,
            chord_mm: Tolerances::DEFAULT_CHORD_MM,
            min_feature_mm: 0.0,
            min_gap_mm: 0.0,
        }
    }

    /// A band of the exemplar in an SVG file on a model (Zhou 2014 §6.3).
    pub fn on_model(exemplar: impl AsRef<Path>, surface: SurfaceOptions) -> Self {
        let along = CurveSpec::Model { file: surface.model.clone() };
        Self { surface: Some(surface), ..Self::new(exemplar, along) }
    }

    /// The height H of the band, to which the exemplar is scaled; left out, it is the exemplar's own.
    pub fn width_mm(mut self, width_mm: f64) -> Self {
        self.width_mm = Some(width_mm);
        self
    }

    /// The number of connected components, or a range of numbers; left out, it is free.
    pub fn components(mut self, components: impl Into<Wanted>) -> Self {
        self.goal.components = Some(components.into());
        self
    }

    /// The number of holes, or a range of numbers; left out, it is free. The inside of a closed ring counts as one.
    pub fn holes(mut self, holes: impl Into<Wanted>) -> Self {
        self.goal.holes = Some(holes.into());
        self
    }

    /// Whether some component must go all the way round (closed curves only).
    pub fn closed_pattern(mut self, closed_pattern: bool) -> Self {
        self.goal.closed_pattern = closed_pattern;
        self
    }

    /// How the exemplar is sliced.
    pub fn slicing(mut self, slicing: SlicingChoice) -> Self {
        self.slicing = slicing;
        self
    }

    /// A range of the exemplar that is not cut, in millimetres from its left edge at the size that it has in the
    /// band; may be called again.
    pub fn keep(mut self, range: KeptRange) -> Self {
        self.kept.push(range);
        self
    }

    /// Whether every piece may be used left for right as well.
    pub fn mirror(mut self, mirror: bool) -> Self {
        self.mirror = mirror;
        self
    }

    /// Another seed gives another band near the optimum; without one it is the optimum.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = Some(seed);
        self
    }

    /// The weight β of the autocorrelation (Zhou 2014 §3.7); 0 leaves it out.
    pub fn variety(mut self, beta: f64) -> Self {
        self.beta = beta;
        self
    }

    /// The weight α of positions against tangents (Zhou 2014 §3.6.1).
    pub fn alpha(mut self, alpha: f64) -> Self {
        self.weights.alpha = alpha;
        self
    }

    /// The cost λ of a jump.
    pub fn jump_cost(mut self, jump: f64) -> Self {
        self.weights.jump = jump;
        self
    }

    /// The thickness of the solid.
    pub fn thickness_mm(mut self, thickness_mm: f64) -> Self {
        self.thickness_mm = thickness_mm;
        self
    }

    /// How the solid is made, beyond its thickness.
    pub fn print(mut self, print: PrintOptions) -> Self {
        self.print = print;
        self
    }

    /// What pictures show, and how large they are.
    pub fn picture(mut self, picture: PictureOptions) -> Self {
        self.picture = picture;
        self
    }

    /// The narrowest ink that the machine makes; 0 is not checked.
    pub fn min_feature_mm(mut self, min_feature_mm: f64) -> Self {
        self.min_feature_mm = min_feature_mm;
        self
    }

    /// The narrowest gap that the machine keeps open; 0 is not checked.
    pub fn min_gap_mm(mut self, min_gap_mm: f64) -> Self {
        self.min_gap_mm = min_gap_mm;
        self
    }

    /// The greatest distance between a curve and what stands for it in the files.
    pub fn chord_mm(mut self, chord_mm: f64) -> Self {
        self.chord_mm = chord_mm;
        self
    }

    /// The radius to which corners of the curve are rounded; without one, a corner is an error.
    pub fn round_mm(mut self, radius_mm: f64) -> Self {
        self.round_mm = Some(radius_mm);
        self
    }

    /// Whether ink that is too thin is thickened to the minimum feature, and gaps that are too narrow are widened to the
    /// minimum gap, before the part is checked.
    pub fn enforce(mut self, enforce: bool) -> Self {
        self.enforce = enforce;
        self
    }

    /// The material, for the mass in the report.
    pub fn material(mut self, material: Material) -> Self {
        self.material = Some(material);
        self
    }

    /// How pieces are bent to meet.
    pub fn stitch(mut self, stitch: StitchMethod) -> Self {
        self.stitch = stitch;
        self
    }

    /// Which of the sequences that meet the constraints are taken; one band is made of each.
    pub fn choice(mut self, choice: Choice) -> Self {
        self.choice = choice;
        self
    }

    /// Whether [`write_numbered`](super::write_numbered) adds a contact sheet of all bands; it does unless told otherwise.
    pub fn contact_sheet(mut self, contact_sheet: bool) -> Self {
        self.contact_sheet = contact_sheet;
        self
    }

    /// Whether the report tells how many sequences meet the constraints, where they can be counted.
    pub fn counted(mut self, counted: bool) -> Self {
        self.counted = counted;
        self
    }

    /// The memory that the search may take, in bytes. Beyond it the best that a beam finds is taken, and the report
    /// says how far from the optimum it may be.
    pub fn memory_limit(mut self, bytes: usize) -> Self {
        self.memory_limit = bytes;
        self
    }

    /// The partial runs that the search may look at before it gives optimality up as it does beyond the memory.
    /// Without a number it is as many as take a few seconds.
    pub fn effort(mut self, partial_runs: usize) -> Self {
        self.effort = Some(partial_runs);
        self
    }

    /// What is asked of a band along a curve in space, beyond the curve.
    pub fn space(mut self, space: SpaceOptions) -> Self {
        self.space = space;
        self
    }

    /// What files of cut lines are to be like.
    pub fn laser(mut self, laser: LaserOptions) -> Self {
        self.laser = laser;
        self
    }

    /// The width of bridges: where the ornament cannot give the components or holes that are asked for, or only at a
    /// higher cost than with bridges, struts of this width join components and slits of this width open holes. A
    /// bridge costs as much as half a jump. Without a width there are none, and what cannot be had is refused.
    pub fn bridge_mm(mut self, width_mm: f64) -> Self {
        self.bridge_mm = Some(width_mm);
        self
    }

    /// Whether the pattern is cut out of a model, so that its gaps are what is kept.
    pub(super) fn carves_model(&self) -> bool {
        self.surface.as_ref().is_some_and(|surface| surface.mode == SurfaceMode::Carve)
    }

    /// Checks every option by its name.
    ///
    /// # Errors
    /// [`JobError`] names the first option that is out of range or contradicts another.
    pub fn build(self) -> Result<BandJob, JobError> {
        self.weights.validate()?;
        let kept = Tolerances::new(self.chord_mm, self.min_feature_mm, self.min_gap_mm)?;
        let tolerances = match self.carves_model() {
            true => kept.swapped(),
            false => self.laser.of_pattern(&kept),
        };
        if let Some(width) = self.width_mm {
            in_range("--width", width, 0.5, 10_000.0)?;
        }
        if let Some(width) = self.bridge_mm {
            in_range("--bridge", width, 0.01, 100.0)?;
        }
        in_range("--thickness", self.thickness_mm, 0.001, 10_000.0)?;
        self.print.profile(self.thickness_mm)?;
        if !(0.0..=1e6).contains(&self.beta) {
            return Err(out_of_range("--variety", self.beta, "it must be from 0 to 1000000"));
        }
        if self.goal.components.is_some_and(|wanted| wanted.most() == 0) {
            return Err(JobError::Option {
                option: "--components",
                found: "0 components is no band".to_owned(),
                wanted: "ask for 1 or more, or leave it out".to_owned(),
            });
        }
        if self.goal.closed_pattern && self.goal.holes.is_some_and(|wanted| wanted.most() == 0) {
            return Err(JobError::Option {
                option: "--closed-pattern",
                found: "a pattern that goes all the way round has a hole, its inside, but --holes 0 was asked for"
                    .to_owned(),
                wanted: "ask for --holes 1 or more, or leave one of the two out".to_owned(),
            });
        }
        if self.enforce && tolerances.min_feature_mm() == 0.0 && tolerances.min_gap_mm() == 0.0 {
            return Err(making::no_width());
        }
        let variety = (self.beta > 0.0).then(|| Variety::new(self.beta));
        let memory_limit = self.memory_limit;
        Ok(BandJob { options: self, tolerances, variety, memory_limit, ground: None })
    }
}

fn in_range(option: &'static str, value: f64, low: f64, high: f64) -> Result<(), JobError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(out_of_range(option, value, &format!("it must be from {low} to {high} mm")))
}

fn out_of_range(option: &'static str, value: f64, wanted: &str) -> JobError {
    JobError::Option { option, found: format!("{value} is out of range"), wanted: wanted.to_owned() }
}

/// A band whose options are in order.
#[derive(Debug, Clone)]
pub struct BandJob {
    pub(super) options: BandBuilder,
    /// What the pattern must keep to: of one that is carved out of a plate, the ink is the gaps of what is kept.
    pub(super) tolerances: Tolerances,
    pub(super) variety: Option<Variety>,
    /// The memory that the search may take, in bytes.
    pub(super) memory_limit: usize,
    /// The model that it lies on, once that was read.
    pub(super) ground: Option<Ground>,
}

impl BandJob {
    /// Refuses outputs that would overwrite each other or an input, that cannot be files, or that contradict the
    /// options for cut lines. Writing does so
    /// too; a job takes a while, though, and this can be known before it.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub fn check_outputs(&self, outputs: &[Output], report_file: Option<&Target>) -> Result<(), JobError> {
        self.options.laser.check(outputs)?;
        self.options.picture.check(outputs)?;
        if self.options.laser.carve {
            self.options.picture.check_sign()?;
        }
        self.check_targets(outputs.iter().map(Output::target).chain(report_file))
    }

    /// Refuses targets that would overwrite each other or an input.
    fn check_targets<'t>(&self, targets: impl IntoIterator<Item = &'t Target>) -> Result<(), JobError> {
        let curve = match &self.options.along {
            CurveSpec::Path { file, .. } | CurveSpec::Points { file } | CurveSpec::Model { file } => {
                Some(file.as_path())
            }
            CurveSpec::Line { .. }
            | CurveSpec::Circle { .. }
            | CurveSpec::Ring { .. }
            | CurveSpec::Helix { .. } => None,
        };
        let on_model = self.options.surface.as_ref().and_then(SurfaceOptions::curve_file);
        let drawings = curve.into_iter().chain(on_model).chain(self.options.laser.engrave.as_deref());
        let inputs: Vec<&Path> = std::iter::once(self.options.exemplar.as_path()).chain(drawings).collect();
        Output::check(targets, &inputs)
    }

    /// Makes the band; `progress` is told of each stage as it begins.
    ///
    /// # Errors
    /// [`JobError`] says why there is no band, and what would work.
    pub fn run(&self, progress: &mut dyn FnMut(Stage)) -> Result<Band, JobError> {
        Ok(self.run_all(progress)?.swap_remove(0))
    }

    /// Makes a band of each sequence that the job's [`Choice`] takes: fewer than asked for when there are no more, and
    /// at least one.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_all(&self, progress: &mut dyn FnMut(Stage)) -> Result<Vec<Band>, JobError> {
        self.run_all_for(&[], progress)
    }

    /// The same for bands that are going to be written to `outputs`: what can be made of them side by side is made so, which
    /// takes less time than [`Self::run_all`] and gives the same.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_all_for(
        &self,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<Vec<Band>, JobError> {
        Band::all(self, outputs, progress)
    }

    /// Where the contact sheet of numbered bands goes, if there is to be one and some output is a file.
    pub(super) fn contact_sheet(&self, outputs: &[Output]) -> Option<Target> {
        let mut sheets = outputs.iter().filter_map(|output| output.target().contact_sheet());
        sheets.next().filter(|_| self.options.contact_sheet)
    }

    /// The same check for bands that [`write_numbered`](super::write_numbered) is going to write, as many as the job's
    /// [`Choice`] asks for, with their contact sheet.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub fn check_numbered(&self, outputs: &[Output], report_file: Option<&Target>) -> Result<(), JobError> {
        let most = match self.options.choice {
            Choice::Cheapest => 1,
            Choice::Best(count) | Choice::Drawn { count, .. } => count,
        };
        (1..=most).try_for_each(|number| {
            let outputs: Vec<Output> = outputs.iter().map(|output| output.numbered(number)).collect();
            self.check_outputs(&outputs, report_file.map(|target| target.numbered(number)).as_ref())
        })?;
        self.contact_sheet(outputs).map_or(Ok(()), |sheet| self.check_targets([&sheet]))
    }
}
