//! A band along a curve: from the exemplar to a part that has the planned topology.

use glam::DVec2;

use super::bridging::{self, BridgesReport};
use super::builder::BandJob;
use super::choice::Choice;
use super::cut::{Cut, read_exemplar, slice};
use super::describe::describe;
use super::error::JobError;
use super::joined::Joined;
use super::judged::Drawn;
use super::making::{self, Border, Mended};
use super::output::Output;
use super::part::{Part, PartError};
use super::plan::Plan;
use super::raised::Raised;
use super::report::{BandReport, FlatPattern, InputReport};
use super::space::{self, read_space_curve};
use super::stage::{Clock, Stage};
use super::surface::Ground;
use super::ways::{Runs, ways, weighed, weighed_note};
use crate::domain::{BandMap, CurveSpec, PlanarCurve, SpaceCurve, SpaceMap};
use crate::exemplar::{Limits, read_path};
use crate::fabricate::{self, Counts};
use crate::fit::{FitOptions, Outline, Prepared, StitchMethod};
use crate::planar::Region;
use crate::topology::Topology;
use crate::verify::Mismatch;

/// The chord error is shared out: these parts are for bending, for mapping and for fitting curves to the SVG, and
/// what is left for flattening the exemplar.
const FIT_SHARE: f64 = 0.125;
const MAP_SHARE: f64 = 0.125;
/// When the counts are not as planned, chords cut through a gap or a strand: smaller ones are tried.
const CHORD_TRIES: [f64; 4] = [1.0, 0.25, 0.06, 0.015];

/// When a drawing has not the counts of its part, what is finer than the chord error was lost, and the band is made again
/// within these parts of it.
pub(super) const FINER_CHORDS: [f64; 2] = [0.25, 0.0625];

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
    pub(super) drawn: Option<Drawn>,
    /// The solid and its files, once they have passed.
    pub(super) raised: Option<Raised>,
    /// Where it lies in space, if it does not lie in the plane.
    pub(super) space: Option<SpaceMap>,
}

impl Band {
    /// The bands that the job's choice takes, at least one.
    /// Solids of `outputs` are made beside the drawing.
    pub(super) fn all(
        job: &BandJob,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<Vec<Self>, JobError> {
        let ground = match (&job.options.surface, &job.ground) {
            (Some(options), None) => {
                progress(Stage::Read);
                Some(Ground::new(options)?)
            }
            (_, ground) => ground.clone(),
        };
        let job = &BandJob { ground, ..job.clone() };
        let (bands, is_fine_enough) = Self::all_within_chord(job, outputs, progress)?;
        if is_fine_enough {
            return Ok(bands);
        }
        let asked_mm = job.tolerances.chord_mm();
        for chord_mm in FINER_CHORDS.map(|part| part * asked_mm) {
            let Some(tolerances) = job.tolerances.with_chord_mm(chord_mm) else { break };
            // The exemplar too is read anew, as what is lost may have come too close there.
            let finer = BandJob { tolerances, ..job.clone() };
            if let Ok((mut bands, true)) = Self::all_within_chord(&finer, outputs, progress) {
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
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(Vec<Self>, bool), JobError> {
        let mut clock = Clock::new(progress);
        let options = &job.options;
        let (exemplar, curve, in_space, curve_input) = clock.time(Stage::Read, || {
            let in_space = read_space_curve(job)?;
            let (curve, input) = read_curve(&options.along, options.round_mm, in_space.as_ref())?;
            Ok::<_, JobError>((read_exemplar(job)?, curve, in_space, input))
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
        let (map, space) = clock.time(Stage::Map, || {
            let space = in_space.map(|curve| space::space_map(job, curve, cut.height_mm)).transpose()?;
            Ok::<_, JobError>((BandMap::new(curve, -half, half)?, space))
        })?;
        let asked = job.tolerances;
        let job = &match &space {
            Some(map) => BandJob { tolerances: space::flat_tolerances(&job.tolerances, map)?, ..job.clone() },
            None => job.clone(),
        };
        let ways = ways(job, &mut cut, &map, &mut clock)?;
        let mut refusal = None;
        for (number, way) in ways.iter().enumerate() {
            let made = way.runs(job, &cut, &map, &mut clock).and_then(|runs| {
                Self::follow(
                    runs,
                    (job, outputs),
                    &cut,
                    (&map, space.as_ref()),
                    curve_input.as_ref(),
                    &mut clock,
                )
            });
            match made {
                Ok((mut bands, is_fine_enough)) => {
                    let weighed = weighed(&ways, number);
                    let told = space::note(&asked, &job.tolerances);
                    bands.iter_mut().for_each(|band| band.report.made.notes.extend(told.clone()));
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
        (job, outputs): (&BandJob, &[Output]),
        cut: &Cut,
        (map, space): (&BandMap, Option<&SpaceMap>),
        curve_input: Option<&InputReport>,
        clock: &mut Clock<'_>,
    ) -> Result<(Vec<Self>, bool), JobError> {
        let mut bands = Vec::with_capacity(runs.plans.len());
        let mut is_fine_enough = true;
        let mut prepared = Prepared::new();
        for (rank, run) in (1..).zip(runs.plans) {
            let curve_input = curve_input.cloned();
            let mut band = Self::made_with(&mut prepared, job, cut, run, map, curve_input, clock)?;
            band.space = space.cloned();
            band.report.flat = band.flat_pattern();
            band.report.made.notes.extend(job.ground.iter().flat_map(Ground::notes).cloned());
            band.report.rank = matches!(job.options.choice, Choice::Best(_)).then_some(rank);
            if let Some(width_mm) = runs.bridge_mm {
                let inside = bridging::inside(map).map(|p| p + band.part.shift_mm);
                clock.time(Stage::Bridge, || band.lay_bridges(width_mm, inside))?;
            }
            band.enforce(Border::Round, clock)?;
            // What does not pass is left for `deliver` to tell of, which knows the names of files.
            let ahead = |clock: &mut Clock<'_>| {
                (!outputs.is_empty()).then(|| band.raised(outputs, clock).ok()).flatten()
            };
            let (drawn, raised) = clock.both(|clock| band.drawn(clock), ahead);
            (band.drawn, band.raised) = (drawn.as_ref().ok().cloned(), raised);
            if let Err(JobError::Mismatch { mismatch, .. }) = drawn {
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
        let counts = part.counts;
        Ok(Self {
            job: job.clone(),
            part,
            plan,
            planned,
            counts,
            report,
            drawn: None,
            raised: None,
            space: None,
        })
    }

    /// Lays a rectangle in space. The middle of its ink is the middle of the sheet, and where it is `rolled` its left side is its right one.
    pub(super) fn lay(&mut self, space: &SpaceMap, rolled: bool) {
        let (low, high) = self.part.region.bounds_mm().unwrap_or_default();
        self.part.joined = rolled.then_some(Joined { cut_mm: 0.0, sides_mm: [low.x, high.x] });
        let start = 0.5 * (low.x + high.x - space.curve().length_mm());
        self.part.shift_mm = DVec2::new(start, 0.5 * (low.y + high.y));
        self.space = Some(space.clone());
        self.report.flat = self.flat_pattern();
    }

    /// What its drawing is, of a band in space.
    fn flat_pattern(&self) -> Option<FlatPattern> {
        let space = self.space.as_ref()?;
        let Counts { components, holes } = Counts::of(&self.part.region);
        let is_joined = self.part.joined.is_some();
        let cut_mm = self.part.joined.as_ref().map(|joined| joined.cut_mm);
        Some(FlatPattern { components, holes, is_joined, cut_mm, scales: space.scales() })
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
                self.report.made.certificate.move_bridges(&bridges.bridges);
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
}

/// The curve in the plane: for one in space, the line that stands for it.
pub(super) fn read_curve(
    spec: &CurveSpec,
    round_mm: Option<f64>,
    in_space: Option<&SpaceCurve>,
) -> Result<(PlanarCurve, Option<InputReport>), JobError> {
    if let Some(curve) = in_space {
        let input = match spec {
            CurveSpec::Points { file } | CurveSpec::Model { file } => Some(InputReport::of(file)),
            _ => None,
        };
        return Ok((space::flat(curve)?, input));
    }
    Ok(match spec {
        CurveSpec::Line { length_mm } => (PlanarCurve::line(*length_mm)?, None),
        CurveSpec::Circle { diameter_mm } => (PlanarCurve::circle(*diameter_mm)?, None),
        CurveSpec::Path { file, id } => {
            let path = read_path(file, id.as_deref(), &Limits::default())?;
            let curve = match round_mm {
                Some(radius) => PlanarCurve::from_bez_path_rounded(&path, radius)?,
                None => PlanarCurve::from_bez_path(&path)?,
            };
            (curve, Some(InputReport::of(file)))
        }
        CurveSpec::Ring { .. }
        | CurveSpec::Helix { .. }
        | CurveSpec::Points { .. }
        | CurveSpec::Model { .. } => {
            unreachable!("a curve in space was read before")
        }
    })
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
        StitchMethod::Lri if !cut.sides.are_held() => &[StitchMethod::Lri, StitchMethod::Warp],
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
        match clock.time(Stage::Map, || Part::new(&outline, map, cut.sides, planned, chord_mm * MAP_SHARE)) {
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
