//! A band along a curve: from the exemplar to verified files.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::blind;
use super::bridging::{self, BridgesReport};
use super::builder::BandJob;
use super::certificate::{FileDigest, sha256};
use super::choice::Choice;
use super::cut::{Cut, read_exemplar, slice};
use super::describe::describe;
use super::error::JobError;
use super::extrude::{file_name, name};
use super::laser::Cutting;
use super::making::{self, Border, Mended, Quantities};
use super::output::{Format, Output, Pending, Target, persist};
use super::part::{Part, PartError};
use super::picture::Pictured;
use super::plan::Plan;
use super::print::{self, MeshFile, Meshes};
use super::report::{BandReport, InputReport};
use super::small;
use super::stage::{Clock, Stage};
use super::ways::{Runs, ways, weighed, weighed_note};
use crate::domain::{BandMap, CurveSpec, PlanarCurve};
use crate::exemplar::{Limits, read_path};
use crate::export::{self, MeshDocument, SvgDocument, SvgOptions};
use crate::fabricate::{self, Counts, Solid};
use crate::fit::{FitOptions, Outline, Prepared, Sides, StitchMethod};
use crate::planar::{Region, Tolerances};
use crate::topology::Topology;
use crate::verify::{self, Expected, Mismatch, NarrowPlaces, Narrowest, SvgReport};

/// The chord error is shared out: these parts are for bending, for mapping and for fitting curves to the SVG, and
/// what is left for flattening the exemplar.
const FIT_SHARE: f64 = 0.125;
const MAP_SHARE: f64 = 0.125;
const SVG_SHARE: f64 = 0.5;
/// Ink thinner than this is worth a warning, in millimetres: about the width of a laser's cut.
const HAIRLINE_MM: f64 = 0.1;
/// When the counts are not as planned, chords cut through a gap or a strand: smaller ones are tried.
const CHORD_TRIES: [f64; 4] = [1.0, 0.25, 0.06, 0.015];

/// A drawing that has passed, and what was found in it.
#[derive(Debug, Clone)]
struct Drawn {
    drawing: SvgDocument,
    found: SvgReport,
}

/// When a drawing has not the counts of its part, what is finer than the chord error was lost, and the band is made again
/// within these parts of it.
const FINER_CHORDS: [f64; 2] = [0.25, 0.0625];

/// What a drawing without a file is called.
const DRAWING: &str = "the drawing";

/// A band that has the planned topology, ready to be written.
#[derive(Debug, Clone)]
pub struct Band {
    pub(super) job: BandJob,
    pub(super) part: Part,
    pub(super) plan: Plan,
    pub(super) planned: Topology,
    /// What the part has, with bridges.
    pub(super) counts: Counts,
    pub(super) report: BandReport,
    /// The drawing, once it has passed.
    drawn: Option<Drawn>,
}

impl Band {
    /// The bands that the job's choice takes, at least one.
    pub(super) fn all(job: &BandJob, progress: &mut dyn FnMut(Stage)) -> Result<Vec<Self>, JobError> {
        let (bands, is_fine_enough) = Self::all_within_chord(job, progress)?;
        if is_fine_enough {
            return Ok(bands);
        }
        let asked_mm = job.tolerances.chord_mm();
        for chord_mm in FINER_CHORDS.map(|part| part * asked_mm) {
            let Some(tolerances) = job.tolerances.with_chord_mm(chord_mm) else { break };
            // The exemplar too is read anew, as what is lost may have come too close there.
            let finer = BandJob { tolerances, ..job.clone() };
            if let Ok((mut bands, true)) = Self::all_within_chord(&finer, progress) {
                bands.iter_mut().for_each(|band| band.report.made.notes.push(format!(
                    "made within {chord_mm} mm instead of {asked_mm} mm, at which something so fine was lost that the counts changed"
                )));
                return Ok(bands);
            }
        }
        Ok(bands)
    }

    /// The bands, and whether their drawings have the counts of their parts.
    fn all_within_chord(
        job: &BandJob,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(Vec<Self>, bool), JobError> {
        let mut clock = Clock::new(progress);
        let options = &job.options;
        let (exemplar, curve, curve_input) = clock.time(Stage::Read, || {
            let (curve, input) = read_curve(&options.along, options.round_mm)?;
            Ok::<_, JobError>((read_exemplar(job)?, curve, input))
        })?;
        if options.goal.closed_pattern && !curve.is_closed() {
            return Err(JobError::Option {
                option: "--closed-pattern",
                found: format!("{} is an open curve", options.along),
                wanted: "a pattern can close only along a closed curve, as circle:65mm".to_owned(),
            });
        }
        let mut cut = clock.time(Stage::Slice, || slice(job, exemplar))?;
        let half = cut.height_mm / 2.0;
        // Where the band cannot lie is found before the search, not after it.
        let map = clock.time(Stage::Map, || BandMap::new(curve, -half, half))?;
        let ways = ways(job, &mut cut, &map, &mut clock)?;
        let mut refusal = None;
        for (number, way) in ways.iter().enumerate() {
            let made = way
                .runs(job, &cut, &map, &mut clock)
                .and_then(|runs| Self::follow(runs, job, &cut, &map, curve_input.as_ref(), &mut clock));
            match made {
                Ok((mut bands, is_fine_enough)) => {
                    let weighed = weighed(&ways, number);
                    for report in bands.iter_mut().map(|band| &mut band.report) {
                        report.made.notes.extend(weighed_note(&weighed));
                        report.weighed.clone_from(&weighed);
                    }
                    return Ok((bands, is_fine_enough));
                }
                // Another way may have a place for its bridges, or need none.
                Err(error) => refusal = refusal.or(Some(error)),
            }
        }
        Err(refusal.expect("there is a way, and it either succeeds or fails"))
    }

    /// The bands that follow the sequences of one way, and whether their drawings have the counts of their parts.
    fn follow(
        runs: Runs,
        job: &BandJob,
        cut: &Cut,
        map: &BandMap,
        curve_input: Option<&InputReport>,
        clock: &mut Clock<'_>,
    ) -> Result<(Vec<Self>, bool), JobError> {
        let mut bands = Vec::with_capacity(runs.plans.len());
        let mut is_fine_enough = true;
        let mut prepared = Prepared::new();
        for (rank, run) in (1..).zip(runs.plans) {
            let curve_input = curve_input.cloned();
            let mut band = Self::made_with(&mut prepared, job, cut, run, map, curve_input, clock)?;
            band.report.rank = matches!(job.options.choice, Choice::Best(_)).then_some(rank);
            if let Some(width_mm) = runs.bridge_mm {
                let inside = bridging::inside(map).map(|p| p + band.part.shift_mm);
                clock.time(Stage::Bridge, || band.lay_bridges(width_mm, inside))?;
            }
            band.enforce(Border::Round, clock)?;
            // A drawing that does not pass is left for `deliver` to tell of, which knows the name of its file.
            if let Err(JobError::Mismatch { mismatch, .. }) = band.pass(clock) {
                is_fine_enough &= !matches!(mismatch, Mismatch::Components { .. } | Mismatch::Holes { .. });
            }
            band.report.made.times.clone_from(&clock.times);
            band.report.tell_number(runs.sequences);
            band.report.made.certificate.tell_source(job, cut);
            band.report.drawn_exactly = runs.is_exact;
            bands.push(band);
        }
        Ok((bands, is_fine_enough))
    }

    /// The band that follows a plan.
    pub(super) fn made(
        job: &BandJob,
        cut: &Cut,
        plan: Plan,
        planned: Topology,
        map: &BandMap,
        curve_input: Option<InputReport>,
        clock: &mut Clock<'_>,
    ) -> Result<Self, JobError> {
        Self::made_with(&mut Prepared::new(), job, cut, (plan, planned), map, curve_input, clock)
    }

    /// The same with what other bands of the same cut have `prepared`.
    fn made_with(
        prepared: &mut Prepared,
        job: &BandJob,
        cut: &Cut,
        (plan, planned): (Plan, Topology),
        map: &BandMap,
        curve_input: Option<InputReport>,
        clock: &mut Clock<'_>,
    ) -> Result<Self, JobError> {
        let (part, outline) = make_part(prepared, job, cut, (&plan, planned), map, clock)?;
        let report =
            describe(job, cut, &plan, planned, map, &outline, &part, curve_input, clock.times.clone());
        let counts = Counts::of(&part.region);
        Ok(Self { job: job.clone(), part, plan, planned, counts, report, drawn: None })
    }

    /// Gives the part bridges of at least `width_mm` so that it meets the goal. `inside` is a point in the inside of
    /// a ring.
    pub(super) fn lay_bridges(&mut self, width_mm: f64, inside: Option<DVec2>) -> Result<(), JobError> {
        let goal = self.job.options.goal;
        let options =
            bridging::options(width_mm, &self.job.tolerances, inside.filter(|_| goal.closed_pattern));
        let bridged = bridging::bridged(&self.part.region, goal, &options)?;
        let without = Counts::of(&self.part.region);
        let region = fabricate::snapped_to_f32(&bridged.region)?;
        let (low, high) = region.bounds_mm().unwrap_or_default();
        if low.cmplt(DVec2::ZERO).any() || high.cmpgt(self.part.page_mm).any() {
            return Err(JobError::Refused(format!(
                "bridges {width_mm} mm wide would reach beyond the page of the band; give --bridge a smaller width"
            )));
        }
        self.part.region = region;
        self.counts = Counts::of(&self.part.region);
        let bridges = BridgesReport::new(without, bridged.bridges);
        let report = &mut self.report;
        report.made.notes.push(bridges.note(self.counts));
        report.closed_pattern = inside.is_some_and(|p| bridging::surrounds(&self.part.region, p));
        report.made.certificate.add_bridges(&bridges.bridges, self.counts, report.closed_pattern);
        (report.components, report.holes) = (self.counts.components, self.counts.holes);
        (report.made.area_mm2, report.made.vertices) =
            (self.part.region.area_mm2(), self.part.region.vertices());
        report.bridges = Some(bridges);
        Ok(())
    }

    /// Thickens what is too thin and widens what is too narrow, if that was asked for.
    pub(super) fn enforce(&mut self, border: Border, clock: &mut Clock<'_>) -> Result<(), JobError> {
        if !self.job.options.enforce {
            return Ok(());
        }
        let (region, tolerances) = (&self.part.region, &self.job.tolerances);
        let made = clock.time(Stage::Enforce, || match self.job.options.laser.plate() {
            Some(sheet) => making::enforced_in_plate(region, tolerances, border, sheet),
            None => making::enforced(region, tolerances, border),
        })?;
        let Some(Mended { region, report: enforced, pressed }) = made else { return Ok(()) };
        self.part.region = fabricate::snapped_to_f32(&region)?;
        if let Some(pressed) = pressed {
            self.part.seams_mm.iter_mut().flatten().for_each(|p| *p = pressed.moved(*p));
            if let Some(bridges) = &mut self.report.bridges {
                bridges.press(&pressed);
            }
        }
        let made = &mut self.report.made;
        made.notes.push(enforced.note());
        (made.area_mm2, made.vertices) = (self.part.region.area_mm2(), self.part.region.vertices());
        made.enforced = Some(enforced);
        Ok(())
    }

    /// The part in millimetres, y up from the lower left corner of its page.
    pub fn region(&self) -> &Region {
        &self.part.region
    }

    /// The plan that was followed.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What the plan's pieces add up to, without bridges.
    pub fn topology(&self) -> Topology {
        self.planned
    }

    /// Encodes every output, reads each again, counts, and gives them their names only if all pass. The report
    /// goes to `report_file` as JSON, if one is named.
    ///
    /// # Errors
    /// [`JobError`] when a file cannot be written or does not pass; then none of them exists under its name.
    pub fn write(
        &self,
        outputs: &[Output],
        report_file: Option<&Target>,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<BandReport, JobError> {
        self.job.check_outputs(outputs, report_file)?;
        let (report, pending) = self.deliver(outputs, progress)?;
        persist(pending, report_file.map(|target| (target, report.to_json())))?;
        Ok(report)
    }

    /// Every output, encoded, read again and counted, on its way to its name; and the report.
    pub(super) fn deliver(
        &self,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(BandReport, Vec<Pending>), JobError> {
        let mut clock = Clock::new(progress);
        let mut report = self.report.clone();
        let expected = self.expected();
        // The solid knows nothing of the drawing.
        let (drawn, meshes) = clock.both(
            |clock| self.drawn.clone().map_or_else(|| self.drawn(clock), Ok),
            |clock| {
                let is_shown = self.job.options.picture.view.is_some();
                let make = |notes: &mut Vec<String>| self.solid(notes);
                Meshes::new(outputs, is_shown, &self.document(), &expected, clock, make)
            },
        );
        let Drawn { drawing, found } = drawn.map_err(|error| match error {
            JobError::Mismatch { mismatch, remedy, .. } => {
                JobError::Mismatch { file: shown(outputs), mismatch, remedy }
            }
            error => error,
        })?;
        let mut meshes = meshes?;
        let laser = &self.job.options.laser;
        let mut cutting = match laser.is_needed(outputs) {
            true => Some(clock.time(Stage::CutLines, || self.cutting())?),
            false => None,
        };
        let mut pending = Vec::new();
        // A sign is judged as it is left of its plate, and its pattern is not.
        let narrow_places = match cutting.as_ref().filter(|_| laser.carve) {
            Some(cutting) => clock.time(Stage::Verify, || self.judge(cutting.kept(), outputs))?,
            None => found.narrow_places.clone(),
        };
        let min_feature = narrow_places.ink.first().copied();
        (report.made.min_feature, report.made.min_gap) = (min_feature, narrow_places.gaps.first().copied());
        report.made.narrow_places.clone_from(&narrow_places);
        let mut digests = Vec::new();
        let mut sizes = Vec::new();
        let mut digest = |output: &Output, bytes: &[u8]| {
            let file = name(output.target()).display().to_string();
            digests.push(FileDigest { file, format: output.format().name(), sha256: sha256(bytes) });
        };
        for output in outputs {
            if let Some(cutting) = cutting.as_mut().filter(|_| laser.makes(output.format())) {
                let (item, bytes) =
                    cutting.write(output, &self.job.options.picture, &narrow_places, &mut clock)?;
                sizes.push(bytes.len());
                // A certificate counts the pattern, and not what is left around it.
                if laser.cuts(output.format()) && !laser.carve {
                    digest(output, &bytes);
                }
                pending.push(item);
                continue;
            }
            let item = match output.format() {
                Format::Dxf => unreachable!("a DXF has cut lines"),
                Format::Svg => {
                    report.made.svg_segments = Some([drawing.lines, drawing.cubics]);
                    digest(output, drawing.text.as_bytes());
                    sizes.push(drawing.text.len());
                    let item = Pending::new(output.target(), drawing.text.clone().into_bytes())?;
                    if clock.time(Stage::Verify, || item.read_again())? != drawing.text.as_bytes() {
                        let source = std::io::Error::other("the file differs from what was written to it");
                        let path = name(output.target());
                        return Err(JobError::Export(export::ExportError::Write { path, source }));
                    }
                    item
                }
                Format::Stl | Format::Threemf | Format::Obj => {
                    let MeshFile { item, bytes, found } = meshes.next();
                    digest(output, &bytes);
                    sizes.push(bytes.len());
                    report.made.triangles = Some(found.triangles);
                    report.made.shells = Some(found.shells.len());
                    report.made.genus = Some(found.genus);
                    report.made.volume_mm3 = Some(found.volume_mm3);
                    item
                }
                Format::Png => {
                    let bridges = self.report.bridges.as_ref().map_or(&[][..], |b| &b.bridges);
                    let engraved = cutting.as_ref().map(Cutting::engraved_on_part).transpose()?.flatten();
                    let part = Pictured {
                        region: &self.part.region,
                        bridges,
                        seams_mm: &self.part.seams_mm,
                        narrow_mm: &report.made.narrow_places.places_mm(),
                        engraved: engraved.as_ref(),
                    };
                    let picture = clock.time(Stage::Png, || {
                        self.job.options.picture.png(&part, || meshes.solid(|notes| self.solid(notes)))
                    })?;
                    digest(output, &picture);
                    sizes.push(picture.len());
                    Pending::new(output.target(), picture)?
                }
            };
            pending.push(item);
        }
        let options = &self.job.options;
        report.made.quantities = Some(match cutting.as_ref().and_then(Cutting::sign) {
            Some(sign) => Quantities::new(sign, options.thickness_mm, None, options.material.as_ref()),
            None => {
                let is_upright = options.print.profile(options.thickness_mm)?.is_upright();
                let make = |notes: &mut Vec<String>| self.solid(notes);
                let volume_mm3 = clock.time(Stage::Stl, || meshes.volume_mm3(is_upright, make))?;
                let (region, material) = (&self.part.region, options.material.as_ref());
                Quantities::new(region, options.thickness_mm, volume_mm3, material)
            }
        });
        report.made.notes.append(&mut meshes.notes);
        if let Some(narrowest) = min_feature.filter(|n| n.width_mm < HAIRLINE_MM) {
            report.made.notes.push(format!(
                "{} only {:.3} mm wide holds the {} together, which hardly any machine makes; a larger --width makes it wider in proportion",
                if laser.carve { "material" } else { "ink" },
                narrowest.width_mm,
                if laser.carve { "plate" } else { "band" },
            ));
        }
        let narrowest_mm = found.min_feature.map(|n| n.width_mm);
        let lost = small::warnings(&self.part.region, &self.job.tolerances, outputs, narrowest_mm);
        report.made.notes.extend(lost);
        let is_enforced = self.job.options.enforce;
        report.made.notes.extend(blind::notes(&narrow_places, &self.kept_tolerances(), is_enforced));
        report.made.laser = cutting.map(|cutting| cutting.report);
        report.made.bytes = sizes;
        report.made.certificate.seal([found.components, found.holes], digests);
        report.components = found.components;
        report.holes = found.holes;
        report.made.files = outputs.iter().map(|o| name(o.target()).display().to_string()).collect();
        report.made.times.extend(clock.times);
        Ok((report, pending))
    }

    /// What every file has to have. The widths of a pattern that is carved out of a plate are those of the plate, which is
    /// judged by itself.
    fn expected(&self) -> Expected {
        let counts = Expected {
            components: Some(self.counts.components.into()),
            holes: Some(self.counts.holes.into()),
            ..Expected::default()
        };
        match self.job.options.laser.carve {
            true => counts,
            false => Expected {
                min_feature_mm: self.job.tolerances.min_feature_mm(),
                min_gap_mm: self.job.tolerances.min_gap_mm(),
                ..counts
            },
        }
    }

    /// The tolerances of what is kept: of the part, or of the plate that it is carved out of.
    fn kept_tolerances(&self) -> Tolerances {
        // Twice swapped is not swapped.
        self.job.options.laser.of_pattern(&self.job.tolerances)
    }

    /// The narrowest places of what is left of a plate, which keeps the widths.
    fn judge(&self, kept: &Region, outputs: &[Output]) -> Result<NarrowPlaces, JobError> {
        let tolerances = self.kept_tolerances();
        let places = making::worst_places(kept, &tolerances);
        making::check_widths(kept, &tolerances)
            .map_err(|mismatch| self.mismatch(shown(outputs), mismatch, &places))?;
        Ok(places)
    }

    /// The drawing, which has passed: the promise at the machine's tolerance is checked on it, so it is always made.
    fn drawn(&self, clock: &mut Clock<'_>) -> Result<Drawn, JobError> {
        let drawing = clock.time(Stage::Svg, || self.svg())?;
        let found = clock.time(Stage::Verify, || self.read_svg(drawing.text.as_bytes()))?;
        found
            .check(&self.expected())
            .map_err(|mismatch| self.mismatch(DRAWING.into(), mismatch, &found.narrow_places))?;
        Ok(Drawn { drawing, found })
    }

    /// The part as an SVG drawing.
    ///
    /// # Errors
    /// [`JobError::Export`] when the drawing cannot be made.
    pub fn svg(&self) -> Result<SvgDocument, JobError> {
        let options = SvgOptions {
            width_mm: self.part.page_mm.x,
            height_mm: self.part.page_mm.y,
            chord_mm: self.job.tolerances.chord_mm() * SVG_SHARE,
            title: None,
            // The name only: the same drawing in another folder gives the same bytes.
            description: Some(format!(
                "{} of {}",
                self.report.generator,
                file_name(&self.job.options.exemplar)
            )),
        };
        Ok(export::svg(&self.part.region, &options)?)
    }

    /// The part as cut lines.
    fn cutting(&self) -> Result<Cutting, JobError> {
        let tolerances = self.kept_tolerances();
        let curve_chord_mm = tolerances.chord_mm() * SVG_SHARE;
        let of = format!("{} of {}", self.report.generator, file_name(&self.job.options.exemplar));
        let laser = &self.job.options.laser;
        Cutting::new(laser, &self.part.region, self.part.page_mm, &tolerances, curve_chord_mm, of)
    }

    /// The part as a binary STL solid.
    ///
    /// # Errors
    /// [`JobError`] when the solid cannot be made.
    pub fn stl(&self) -> Result<Vec<u8>, JobError> {
        print::mesh(Format::Stl, &self.solid(&mut Vec::new())?, &self.document())
    }

    /// The part as a solid; what the user may want to know is added to `notes`.
    fn solid(&self, notes: &mut Vec<String>) -> Result<Solid, JobError> {
        let options = &self.job.options;
        let chord_mm = self.job.tolerances.chord_mm();
        options.print.solid(&self.part.region, options.thickness_mm, chord_mm, notes)
    }

    /// What files say of the solid.
    fn document(&self) -> MeshDocument {
        let options = &self.job.options;
        let seed = match options.choice {
            Choice::Drawn { seed, .. } => Some(seed),
            _ => options.seed,
        };
        options.print.document(&options.exemplar, seed, self.counts)
    }

    /// What was found in the drawing, which is kept for [`Band::deliver`].
    pub(super) fn pass(&mut self, clock: &mut Clock<'_>) -> Result<&SvgReport, JobError> {
        let drawn = self.drawn(clock)?;
        Ok(&self.drawn.insert(drawn).found)
    }

    fn read_svg(&self, bytes: &[u8]) -> Result<SvgReport, JobError> {
        verify::read_svg(bytes, self.job.tolerances.chord_mm() / 4.0)
            .map_err(|error| JobError::Unjudged { file: DRAWING.into(), error })
    }

    fn mismatch(&self, file: PathBuf, mismatch: Mismatch, found: &NarrowPlaces) -> JobError {
        let scale = |narrowest: Option<&Narrowest>, wanted: f64, option: &str| {
            let factor = narrowest.map(|n| wanted / n.width_mm).filter(|f| f.is_finite() && *f < 100.0);
            let width = factor.map(|f| format!("--width {:.0}mm or more", (self.report.width_mm * f).ceil()));
            // A tile cannot be mended, and what was mended has been.
            let mend = if self.job.options.enforce { "" } else { "--enforce would mend it, or " };
            format!(
                "; {mend}{} would do, or a smaller {option}",
                width.unwrap_or_else(|| "a larger --width".to_owned())
            )
        };
        let tolerances = &self.kept_tolerances();
        let remedy = match mismatch {
            Mismatch::Feature { .. } => {
                scale(found.ink.first(), tolerances.min_feature_mm(), "--min-feature")
            }
            Mismatch::Gap { .. } => scale(found.gaps.first(), tolerances.min_gap_mm(), "--min-gap"),
            Mismatch::Components { .. } | Mismatch::Holes { .. } => {
                let chord_mm = tolerances.chord_mm();
                format!(
                    "; what is finer than the chord error was lost: try a --chord smaller than {chord_mm} mm or a larger --width"
                )
            }
            _ => String::new(),
        };
        JobError::Mismatch { file, mismatch, remedy }
    }
}

/// The output that is named when the part is at fault.
fn shown(outputs: &[Output]) -> PathBuf {
    let shown = outputs.iter().find(|o| o.format() == Format::Svg).or(outputs.first());
    shown.map_or_else(|| DRAWING.into(), |o| name(o.target()))
}

fn read_curve(
    spec: &CurveSpec,
    round_mm: Option<f64>,
) -> Result<(PlanarCurve, Option<InputReport>), JobError> {
    Ok(match spec {
        CurveSpec::Line { length_mm } => (PlanarCurve::line(*length_mm)?, None),
        CurveSpec::Circle { diameter_mm } => (PlanarCurve::circle(*diameter_mm)?, None),
        CurveSpec::Path { file, id } => {
            let path = read_path(file, id.as_deref(), &Limits::default())?;
            let curve = match round_mm {
                Some(radius) => PlanarCurve::from_bez_path_rounded(&path, radius)?,
                None => PlanarCurve::from_bez_path(&path)?,
            };
            (curve, Some(InputReport { file: file.display().to_string(), sha256: sha256_of(file) }))
        }
    })
}

fn sha256_of(file: &Path) -> String {
    sha256(&std::fs::read(file).unwrap_or_default())
}

fn make_part(
    prepared: &mut Prepared,
    job: &BandJob,
    cut: &Cut,
    (plan, planned): (&Plan, Topology),
    map: &BandMap,
    clock: &mut Clock<'_>,
) -> Result<(Part, Outline), JobError> {
    let mut last = None;
    // What no chord error can help is warped after all.
    let methods: &[StitchMethod] = match job.options.stitch {
        StitchMethod::Lri if cut.sides != Sides::Held => &[StitchMethod::Lri, StitchMethod::Warp],
        _ => &[StitchMethod::Warp],
    };
    let tries = methods.iter().flat_map(|&stitch| CHORD_TRIES.map(|share| (stitch, share)));
    for (stitch, share) in tries {
        let chord_mm = job.tolerances.chord_mm() * share;
        let fit = FitOptions {
            length_mm: map.curve().length_mm(),
            height_mm: cut.height_mm,
            is_ring: map.curve().is_closed(),
            chord_mm: chord_mm * FIT_SHARE,
            stitch,
            sides: cut.sides,
        };
        let outline =
            clock.time(Stage::Fit, || Outline::prepared(&cut.catalogue, &plan.sequence, &fit, prepared))?;
        match clock.time(Stage::Map, || Part::new(&outline, map, planned, chord_mm * MAP_SHARE)) {
            Ok(part) => return Ok((part, outline)),
            Err(PartError::Job(error)) => return Err(error),
            Err(PartError::Untrue(fault)) => last = Some(fault),
        }
    }
    Err(JobError::Outline {
        components: planned.components as usize,
        holes: planned.holes as usize,
        fault: last.expect("a try either returns or leaves a fault"),
    })
}
