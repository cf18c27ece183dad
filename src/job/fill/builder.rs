//! Options of an area that is filled, checked before anything is computed.

use std::path::{Path, PathBuf};

use super::clone::CloneSpec;
use super::{Fill, SampleOptions};
use crate::domain::{CurveSpec, FillDomain};
use crate::job::error::JobError;
use crate::job::flat::FlatMaking;
use crate::job::output::{Output, Target};
use crate::job::space::SpaceOptions;
use crate::job::stage::Stage;
use crate::job::surface::SurfaceOptions;
use crate::topology::{Goal, Wanted};

/// How many levels there are if nothing is said (Tu 2020 §4.3.5).
const LEVELS: usize = 3;

/// Collects the options of an area that is filled with a pattern of curves and elements (Tu 2020). Lengths are millimetres.
///
/// ```no_run
/// use openwork::job::{FillBuilder, Output};
///
/// let fill = FillBuilder::new("branches.svg", "rect:200x150mm".parse()?)
///     .components(1)
///     .seed(7)
///     .build()?
///     .run(&mut |_| {})?;
/// let report = fill.write(&[Output::file("lace.stl")?], None, &mut |_| {})?;
/// assert_eq!(report.components, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FillBuilder {
    pub(super) exemplar: PathBuf,
    pub(super) domain: FillDomain,
    pub(super) along: Option<CurveSpec>,
    pub(super) width_mm: Option<f64>,
    pub(super) round_mm: Option<f64>,
    pub(super) space: SpaceOptions,
    pub(super) surface: Option<SurfaceOptions>,
    pub(super) goal: Goal,
    pub(super) levels: Option<usize>,
    pub(super) radii_mm: Vec<f64>,
    pub(super) spacing_mm: Vec<f64>,
    pub(super) stroke_mm: Option<f64>,
    pub(super) keep: Option<PathBuf>,
    pub(super) clones: Vec<CloneSpec>,
    pub(super) bridge_mm: Option<f64>,
    pub(super) frame_mm: Option<f64>,
    pub(super) constants: SampleOptions,
    pub(super) making: FlatMaking,
}

impl FillBuilder {
    /// An area that is filled with a pattern like that of an SVG file.
    pub fn new(exemplar: impl AsRef<Path>, domain: FillDomain) -> Self {
        Self {
            exemplar: exemplar.as_ref().to_owned(),
            domain,
            along: None,
            width_mm: None,
            round_mm: None,
            space: SpaceOptions::default(),
            surface: None,
            goal: Goal::default(),
            levels: None,
            radii_mm: Vec::new(),
            spacing_mm: Vec::new(),
            stroke_mm: None,
            keep: None,
            clones: Vec::new(),
            bridge_mm: None,
            frame_mm: None,
            constants: SampleOptions::default(),
            making: FlatMaking::default(),
        }
    }

    /// The curve of a [`FillDomain::Band`], its middle line, and how wide the strip along it is.
    pub fn along(mut self, curve: CurveSpec, width_mm: f64) -> Self {
        (self.along, self.width_mm) = (Some(curve), Some(width_mm));
        self
    }

    /// The model that a [`FillDomain::Band`] lies on, with the curve that it follows there (Zhou 2014 §6.3), and how wide the strip is.
    pub fn on_model(mut self, surface: SurfaceOptions, width_mm: f64) -> Self {
        let along = CurveSpec::Model { file: surface.model.clone() };
        self.surface = Some(surface);
        self.along(along, width_mm)
    }

    /// The radius to which corners of that curve are rounded; without one, a corner is an error.
    pub fn round_mm(mut self, radius_mm: f64) -> Self {
        self.round_mm = Some(radius_mm);
        self
    }

    /// What is asked of a band along a curve in space, beyond the curve.
    pub fn space(mut self, space: SpaceOptions) -> Self {
        self.space = space;
        self
    }

    /// The number of connected components, or a range of numbers; left out, it is free.
    pub fn components(mut self, components: impl Into<Wanted>) -> Self {
        self.goal.components = Some(components.into());
        self
    }

    /// The number of holes, or a range of numbers; left out, it is free.
    pub fn holes(mut self, holes: impl Into<Wanted>) -> Self {
        self.goal.holes = Some(holes.into());
        self
    }

    /// The number of levels, 1 to 3; left out, there are as many as radii or spacings, or 3.
    pub fn levels(mut self, levels: usize) -> Self {
        self.levels = Some(levels);
        self
    }

    /// The radius of neighbourhoods at each level, from coarse to fine; when there is none, it follows from the exemplar.
    pub fn radii_mm(mut self, radii_mm: impl Into<Vec<f64>>) -> Self {
        self.radii_mm = radii_mm.into();
        self
    }

    /// The spacing of samples at each level, from coarse to fine; when there is none, it follows from the exemplar.
    pub fn spacing_mm(mut self, spacing_mm: impl Into<Vec<f64>>) -> Self {
        self.spacing_mm = spacing_mm.into();
        self
    }

    /// The width of the pen, instead of the widths that the exemplar's strokes have.
    pub fn stroke_mm(mut self, width_mm: f64) -> Self {
        self.stroke_mm = Some(width_mm);
        self
    }

    /// An SVG of strokes that are there already, in the area or beside it, and stay; the pattern joins them.
    pub fn keep(mut self, file: impl AsRef<Path>) -> Self {
        self.keep = Some(file.as_ref().to_owned());
        self
    }

    /// A box of the exemplar that is copied to a place before anything else; may be called again.
    pub fn copied(mut self, clone: CloneSpec) -> Self {
        self.clones.push(clone);
        self
    }

    /// The width of bridges, which are laid where no edge of the pattern gives what was asked for; left out, that of the pen.
    pub fn bridge_mm(mut self, width_mm: f64) -> Self {
        self.bridge_mm = Some(width_mm);
        self
    }

    /// The width of a stroke along the border of the domain, which belongs to the pattern.
    pub fn frame_mm(mut self, width_mm: f64) -> Self {
        self.frame_mm = Some(width_mm);
        self
    }

    /// What random choices come from; 0 if it is left out.
    pub fn seed(mut self, seed: u64) -> Self {
        self.constants.seed = seed;
        self
    }

    /// Every constant of the method but the levels, which are set here; this sets the seed too.
    pub fn constants(mut self, constants: SampleOptions) -> Self {
        self.constants = constants;
        self
    }

    /// How the part is made.
    pub fn making(mut self, making: FlatMaking) -> Self {
        self.making = making;
        self
    }

    /// Checks every option by its name.
    ///
    /// # Errors
    /// [`JobError`] names the first option that is out of range or contradicts another.
    pub fn build(self) -> Result<FillJob, JobError> {
        self.check_band()?;
        for (option, value) in
            [("--stroke", self.stroke_mm), ("--bridge", self.bridge_mm), ("--frame", self.frame_mm)]
        {
            if let Some(mm) = value.filter(|mm| !(0.01..=100.0).contains(mm)) {
                return Err(refused(
                    option,
                    format!("{mm} mm is out of range"),
                    "it must be from 0.01 to 100 mm",
                ));
            }
        }
        if self.goal.components.is_some_and(|wanted| wanted.most() == 0) {
            return Err(refused(
                "--components",
                "0 components is no pattern".to_owned(),
                "ask for 1 or more, or leave it out",
            ));
        }
        let levels = self.number_of_levels();
        if !(1..=3).contains(&levels) {
            return Err(refused("--levels", format!("{levels} is out of range"), "it must be 1, 2 or 3"));
        }
        for (option, lengths) in [("--radii", &self.radii_mm), ("--spacing", &self.spacing_mm)] {
            if !lengths.is_empty() && lengths.len() != levels {
                let found = format!("{} length(s) are given for {levels} level(s)", lengths.len());
                return Err(refused(
                    option,
                    found,
                    "give one for each level, from coarse to fine, as 12,10,8mm",
                ));
            }
        }
        self.check_constants()?;
        self.making.check_enforced()?;
        self.making.print.profile(self.making.thickness_mm)?;
        Ok(FillJob { options: self })
    }

    /// How many levels there are.
    pub(super) fn number_of_levels(&self) -> usize {
        let given = [&self.radii_mm, &self.spacing_mm].into_iter().map(Vec::len).find(|&n| n > 0);
        self.levels.or(given).unwrap_or(LEVELS)
    }

    fn check_band(&self) -> Result<(), JobError> {
        let is_band = self.domain == FillDomain::Band;
        let of_curves = [
            ("--gap", self.space.gap_mm.is_some()),
            ("--twist", self.space.twist.is_some()),
            ("--round", self.round_mm.is_some()),
        ];
        if let Some((option, _)) = of_curves.into_iter().find(|(_, is_given)| *is_given && !is_band) {
            return Err(refused(
                option,
                format!("{} has no curve", self.domain),
                "leave it out, or use --domain band with --along",
            ));
        }
        match (&self.along, self.width_mm) {
            (None, None) if !is_band => Ok(()),
            _ if !is_band => {
                let found = format!("{} has no curve", self.domain);
                Err(refused(
                    "--domain",
                    found,
                    "use --domain band with --along or --mesh and with --width, or leave these out",
                ))
            }
            (Some(along), Some(width_mm)) => {
                if !(0.5..=10_000.0).contains(&width_mm) {
                    let found = format!("{width_mm} mm is out of range");
                    return Err(refused("--width", found, "it must be from 0.5 to 10000 mm"));
                }
                match along {
                    CurveSpec::Model { .. } if self.surface.is_none() => Err(refused(
                        "--along",
                        format!("{along} needs the model, and where the curve goes on it"),
                        "use --mesh with --around, --through or --curve",
                    )),
                    _ => Ok(()),
                }
            }
            _ => Err(refused(
                "--domain",
                "a band needs the curve that it follows, and how wide it is".to_owned(),
                "give both --along and --width, as --along circle:65mm --width 20mm, or --mesh and --width for a band on a model",
            )),
        }
    }

    fn check_constants(&self) -> Result<(), JobError> {
        let SampleOptions {
            attribute_weight,
            edge_count_price,
            missing_price,
            vote_power,
            least_edge,
            unmatched,
            windows,
            ..
        } = &self.constants;
        let [largest, smallest] = *windows;
        let numbers = [
            ("--attribute-weight", *attribute_weight, 0.0, 100.0),
            ("--edge-count-price", *edge_count_price, 0.0, 100.0),
            ("--missing-price", *missing_price, 0.0, 100.0),
            ("--unmatched-least", unmatched.least, 0.0, 100.0),
            ("--unmatched-per-edge", unmatched.per_edge, 0.0, 100.0),
            ("--unmatched-most", unmatched.most, 0.0, 100.0),
            ("--unmatched-element", unmatched.element, 0.0, 100.0),
            ("--windows", largest, 0.0, 10.0),
            ("--windows", smallest, 0.0, 10.0),
            ("--vote-power", *vote_power, 0.0, 10.0),
            ("--least-edge", *least_edge, 0.0, 1.0),
            ("--least-existence", self.constants.least_existence, 0.0, 1.0),
            ("--cluster", self.constants.cluster, 0.0, 10.0),
            ("--opposite", self.constants.opposite.to_degrees(), 0.0, 90.0),
        ];
        if let Some((option, value, low, high)) =
            numbers.into_iter().find(|(_, v, low, high)| !(*low..=*high).contains(v))
        {
            return Err(refused(
                option,
                format!("{value} is out of range"),
                &format!("it must be from {low} to {high}"),
            ));
        }
        let [first, later] = self.constants.passes;
        let counts = [
            ("--iterations", self.constants.iterations, 0, 1000),
            ("--search-neighbours", self.constants.search_neighbours, 1, 100),
            ("--passes", first, 1, 100),
            ("--passes", later, 1, 100),
        ];
        match counts.into_iter().find(|(_, n, low, high)| !(*low..=*high).contains(n)) {
            Some((option, n, low, high)) => Err(refused(
                option,
                format!("{n} is out of range"),
                &format!("it must be from {low} to {high}"),
            )),
            None => Ok(()),
        }
    }
}

pub(super) fn refused(option: &'static str, found: String, wanted: &str) -> JobError {
    JobError::Option { option, found, wanted: wanted.to_owned() }
}

/// An area to be filled whose options are in order.
#[derive(Debug, Clone)]
pub struct FillJob {
    pub(super) options: FillBuilder,
}

impl FillJob {
    /// Refuses outputs that would overwrite each other or an input, that cannot be files, or that contradict the options for cut
    /// lines.
    ///
    /// # Errors
    /// As [`Output::check`].
    pub fn check_outputs(&self, outputs: &[Output], report_file: Option<&Target>) -> Result<(), JobError> {
        let options = &self.options;
        options.making.check(outputs)?;
        let domain = match &options.domain {
            FillDomain::Path { file, .. } => Some(file.as_path()),
            FillDomain::Rect(_) | FillDomain::Band => None,
        };
        let curve = match &options.along {
            Some(CurveSpec::Path { file, .. } | CurveSpec::Points { file } | CurveSpec::Model { file }) => {
                Some(file.as_path())
            }
            _ => None,
        };
        let on_model = options.surface.as_ref().and_then(SurfaceOptions::curve_file);
        let others =
            [domain, curve, on_model, options.keep.as_deref(), options.making.laser.engrave.as_deref()];
        let inputs: Vec<&Path> =
            std::iter::once(options.exemplar.as_path()).chain(others.into_iter().flatten()).collect();
        Output::check(outputs.iter().map(Output::target).chain(report_file), &inputs)
    }

    /// Fills the area; `progress` is told of each stage as it begins.
    ///
    /// # Errors
    /// [`JobError`] says why it cannot be filled, and what would work.
    pub fn run(&self, progress: &mut dyn FnMut(Stage)) -> Result<Fill, JobError> {
        Fill::new(self, progress)
    }
}
