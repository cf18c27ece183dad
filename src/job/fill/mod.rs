//! An area filled with a pattern of curves and elements, by the second engine (Tu 2020).
//!
//! The pattern is synthesized as a graph of samples, completed until its ink has what was asked for, clipped to the domain and counted
//! there. What the pattern's own edges could not give, bridges do. From there on it is a flat part like any other ([`super::flat`]).

mod builder;
mod census;
mod clone;
mod engine;
mod given;
mod ground;
mod report;
mod sheet;

pub use builder::{FillBuilder, FillJob};
pub use census::Density;
pub use clone::CloneSpec;
pub use engine::ChangeReport;
pub use report::FillReport;

use glam::DVec2;

use self::builder::refused;
use self::census::{density_inside, density_of};
use self::engine::Pattern;
use self::given::Kept;
use self::ground::{Ground, ROUNDING_MM2, grid_error};
use self::sheet::Sheet;
use super::bridging::{self, BridgesReport};
use super::error::JobError;
use super::flat::{Flat, Lain, generator, name};
use super::making::EnforcedReport;
use super::output::{Output, Pending, Target, persist};
use super::part::Part;
use super::report::{FlatPattern, InputReport};
use super::stage::{Clock, Stage};
use super::surface::SurfaceOptions;
use crate::fabricate::{BridgeOptions, Counts};
use crate::planar::Region;
use crate::samples::{self, Area, Drawing, Given};
use crate::topology::Wanted;

pub use crate::samples::{
    Border as SampleBorder, LevelReport, Options as SampleOptions, Start as SampleStart, UnmatchedPrice,
    Without as SampleWithout,
};

/// The part of the chord error that strokes may spend where they are drawn.
const INK_SHARE: f64 = 0.25;

/// An area that is filled, ready to be written.
#[derive(Debug, Clone)]
pub struct Fill {
    job: FillJob,
    region: Region,
    /// Of a strip in space: where it lies, and the strip.
    sheet: Option<(Sheet, Part)>,
    drawing: Drawing,
    page_mm: DVec2,
    exemplar: InputReport,
    domain_file: Option<InputReport>,
    kept: Option<InputReport>,
    domain_mm2: f64,
    pen_mm: f64,
    densities: [Density; 2],
    levels: Vec<LevelReport>,
    own: Counts,
    changes: Vec<ChangeReport>,
    bridges: Option<BridgesReport>,
    enforced: Option<EnforcedReport>,
    notes: Vec<String>,
    times: Vec<super::report::StageTime>,
}

impl FillJob {
    /// The constants of the method for an exemplar, with its levels, in an area.
    fn constants(&self, exemplar: &Drawing, area: &Area) -> SampleOptions {
        let options = &self.options;
        let (low, high) = area.bounds_mm();
        let mut levels =
            samples::default_levels(exemplar, options.number_of_levels(), (high - low).min_element());
        for (i, level) in levels.iter_mut().enumerate() {
            level.radius_mm = options.radii_mm.get(i).copied().unwrap_or(level.radius_mm);
            level.spacing_mm = options.spacing_mm.get(i).copied().unwrap_or(level.spacing_mm);
        }
        SampleOptions { levels, ..options.constants.clone() }
    }
}

impl Fill {
    pub(super) fn new(job: &FillJob, progress: &mut dyn FnMut(Stage)) -> Result<Self, JobError> {
        let mut clock = Clock::new(progress);
        let sheet = clock.time(Stage::Read, || Sheet::new(job))?;
        let mut job = job.clone();
        if let Some(sheet) = &sheet {
            job.options.making.tolerances = sheet.tolerances;
        }
        let (job, options) = (&job, &job.options);
        let chord_mm = options.making.tolerances.chord_mm();
        let read = clock.time(Stage::Read, || given::read(&options.exemplar, chord_mm, options.stroke_mm));
        let (exemplar, linework) = read?;
        let mut notes = linework.notes().to_vec();
        notes.extend(linework.lost().map(str::to_owned));
        notes.extend(sheet.iter().flat_map(|sheet| &sheet.notes).cloned());
        let pens_mm = exemplar.curves.iter().map(|curve| curve.width_mm);
        let pen_mm = pens_mm.fold(options.frame_mm.unwrap_or(0.0), f64::max);
        let mut ground = clock.time(Stage::Read, || Ground::new(job, sheet.as_ref(), pen_mm))?;
        let mut kept = None;
        if let Some(file) = &options.keep {
            let read = clock.time(Stage::Read, || Kept::read(file, chord_mm))?.moved(ground.shift_mm);
            let bounds_mm = read.bounds_mm().unwrap_or_default();
            let (with_room, by) = ground.with_room_for(bounds_mm, pen_mm, chord_mm)?;
            (ground, kept) = (with_room, Some(read.moved(by)));
        }
        let learnt_from = (&exemplar, DVec2::from(linework.page_mm()));
        given::check_clones(&options.clones, learnt_from, (&ground.area, ground.shift_mm))?;
        let nothing = Drawing::default();
        let [kept_lines, kept_drawn] = kept.as_ref().map_or([&nothing; 2], |kept| [&kept.drawing, &kept.ink]);
        let given = Given {
            drawing: kept_lines.clone(),
            clones: options.clones.iter().map(|clone| clone.placed(ground.shift_mm)).collect(),
        };
        notes.extend(given::cut_clones(&given.clones, &ground.area, pen_mm));
        let (learnt, side_mm) = density_of(&options.exemplar, &exemplar, &linework, chord_mm)?;
        let constants = job.constants(&exemplar, &ground.area);
        notes.extend(ground.notes());
        notes.extend(given::meagre(&exemplar));
        notes.extend(given::mixed_pens(&exemplar).filter(|_| options.stroke_mm.is_none()));
        notes.extend(given::oversize(&exemplar, &constants.levels));
        let domain_mm2 = ground.domain.area_mm2();
        let ends_wanted = (learnt.dangling_ends * domain_mm2 / census::AREA_MM2).round() as usize;
        let pattern = engine::pattern(
            (job, &constants),
            &exemplar,
            &ground,
            (&given, kept_drawn),
            ends_wanted,
            &mut clock,
        )?;
        let Pattern { drawing, region, own, changes, notes: of_pattern, levels, lacking } = pattern;
        notes.extend(of_pattern);
        let (drawing, region, cut_mm) =
            clock.time(Stage::Map, || laid(&ground, &drawing, [kept_lines, kept_drawn], region, chord_mm))?;
        let kept_ink = ground.kept(kept_drawn, INK_SHARE * chord_mm)?;
        if let Some(kept) = &kept {
            let reach_mm = constants.levels.iter().map(|level| level.radius_mm).fold(0.0, f64::max);
            notes.extend_from_slice(kept.linework.notes());
            notes.extend(ground.far_away(&kept_ink, reach_mm));
        }
        let region = match kept_ink.is_empty() {
            true => region,
            false => Region::union(region.grid(), [&region, &kept_ink]),
        };
        let begin_mm = ground.begin_mm();
        let density = density_inside(&drawing, &region, &ground.domain, side_mm);
        notes.extend(given::sparse(&learnt, &density));
        let mut fill = Self {
            page_mm: ground.page_mm,
            exemplar: InputReport {
                file: options.exemplar.display().to_string(),
                sha256: linework.sha256().to_owned(),
            },
            domain_file: ground.input.clone(),
            kept: kept.as_ref().zip(options.keep.as_ref()).map(|(kept, file)| InputReport {
                file: file.display().to_string(),
                sha256: kept.linework.sha256().to_owned(),
            }),
            domain_mm2,
            pen_mm,
            densities: [learnt, density],
            levels,
            own,
            changes,
            bridges: None,
            enforced: None,
            notes,
            times: Vec::new(),
            job: job.clone(),
            sheet: None,
            region,
            drawing,
        };
        // Of a closed strip the sides are one place, of which its drawing knows nothing.
        let is_closed = sheet.as_ref().is_some_and(Sheet::is_closed);
        let within = (!is_closed).then(|| ground.for_bridges(&kept_ink, pen_mm));
        if let Some(within) = &within {
            fill.bridge(within, lacking.clone(), &mut clock)?;
            fill.keep(&kept_ink)?;
        }
        if let Some(mended) = options.making.enforced(&fill.region, &mut clock)? {
            fill.notes.push(mended.report.note());
            (fill.region, fill.enforced) = (mended.region, Some(mended.report));
            within.iter().try_for_each(|within| fill.keep_in(within))?;
            let lost_mm2 = kept_ink.without(&fill.region).area_mm2();
            if lost_mm2 > ROUNDING_MM2 {
                return Err(refused(
                    "--enforce",
                    format!(
                        "gaps between the strokes of --keep are too narrow, and widening them would take {lost_mm2:.3} mm2 of these"
                    ),
                    "draw them farther apart, give a smaller --min-gap, or leave out --enforce",
                ));
            }
        }
        if let Some(sheet) = sheet {
            let part = sheet.part(fill.region.clone(), fill.page_mm, begin_mm, cut_mm)?;
            if bridging::wanted(options.goal, part.counts) != part.counts {
                return Err(JobError::Refused(lacking.unwrap_or_else(|| {
                    format!(
                        "{} came out on the closed strip; try another --seed, or a ring with a --gap",
                        part.counts
                    )
                })));
            }
            fill.sheet = Some((sheet, part));
        }
        fill.times = clock.times;
        Ok(fill)
    }

    /// Lays bridges where the goal is not met, by the pattern's own edges or since it was clipped.
    fn bridge(
        &mut self,
        within: &Region,
        lacking: Option<String>,
        clock: &mut Clock<'_>,
    ) -> Result<(), JobError> {
        let options = &self.job.options;
        if self.region.is_empty() {
            return Err(refused(
                "--domain",
                "no ink of the pattern is inside of it".to_owned(),
                "use a larger domain, or a smaller exemplar",
            ));
        }
        let without = Counts::of(&self.region);
        if bridging::wanted(options.goal, without) == without {
            return Ok(());
        }
        let tolerances = options.making.laser.of_pattern(&options.making.tolerances);
        let width_mm = options.bridge_mm.unwrap_or(self.pen_mm.max(tolerances.min_feature_mm()));
        if width_mm == 0.0 {
            return Err(refused(
                "--bridge",
                format!(
                    "{without} came out, and an exemplar without strokes has no pen that could join them"
                ),
                "give --bridge with a width, as --bridge 1mm",
            ));
        }
        let laid = clock.time(Stage::Bridge, || {
            let bridges = bridging::options(width_mm, &tolerances, None);
            let bridges = BridgeOptions { within: Some(within), ..bridges };
            bridging::bridged(&self.region, options.goal, &bridges)
        });
        let laid = laid.map_err(|error| match lacking {
            Some(lacking) => JobError::Refused(format!("{lacking}; bridges do not help: {error}")),
            None => error.into(),
        })?;
        self.region = laid.region;
        let report = BridgesReport::new(without, laid.bridges);
        self.notes.push(report.note(Counts::of(&self.region)));
        self.bridges = Some(report);
        Ok(())
    }

    /// Takes away what was thickened beyond where ink may be, and refuses where that changes the counts. Whether all is as wide as asked for is
    /// measured on the files.
    fn keep_in(&mut self, within: &Region) -> Result<(), JobError> {
        let beyond_mm2 = self.region.without(within).area_mm2();
        if beyond_mm2 < ROUNDING_MM2 {
            return Ok(());
        }
        let before = Counts::of(&self.region);
        self.region = self.region.within(within);
        let after = Counts::of(&self.region);
        if after == before {
            return Ok(());
        }
        Err(refused(
            "--enforce",
            format!(
                "{beyond_mm2:.3} mm2 of what was thickened lies outside of the domain, and without it {after} are left of {before}"
            ),
            "give a --frame, which keeps ink away from the border, a smaller --min-feature, or a domain with more room",
        ))
    }

    /// Draws what is kept again where a bridge or a slit changed it.
    fn keep(&mut self, kept: &Region) -> Result<(), JobError> {
        if kept.without(&self.region).area_mm2() < ROUNDING_MM2 {
            return Ok(());
        }
        self.region = Region::union(self.region.grid(), [&self.region, kept]);
        let counts = Counts::of(&self.region);
        if bridging::wanted(self.job.options.goal, counts) == counts {
            return Ok(());
        }
        Err(JobError::Refused(format!(
            "{counts} came out, as what --keep names must not be cut; draw it otherwise, or ask for counts nearer to these"
        )))
    }

    /// The part in millimetres, y up from the lower left corner of its page.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// Its curves and elements there, without bridges and before anything was thickened.
    pub fn drawing(&self) -> &Drawing {
        &self.drawing
    }

    /// Encodes every output, reads each again, counts, and gives them their names only if all pass. The report goes to `report_file` as
    /// JSON, if one is named.
    ///
    /// # Errors
    /// [`JobError`] when a file cannot be written or does not pass; then none of them exists under its name.
    pub fn write(
        &self,
        outputs: &[Output],
        report_file: Option<&Target>,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<FillReport, JobError> {
        self.job.check_outputs(outputs, report_file)?;
        let (report, pending) = self.deliver(outputs, progress)?;
        persist(pending, report_file.map(|target| (target, report.to_json())))?;
        Ok(report)
    }

    /// What its drawing is, of a strip in space.
    fn flat_pattern(&self) -> Option<FlatPattern> {
        let (sheet, part) = self.sheet.as_ref()?;
        let Counts { components, holes } = Counts::of(&self.region);
        let cut_mm = part.joined.as_ref().map(|joined| joined.cut_mm);
        Some(FlatPattern {
            components,
            holes,
            is_joined: cut_mm.is_some(),
            cut_mm,
            scales: sheet.map.scales(),
        })
    }

    fn deliver(
        &self,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(FillReport, Vec<Pending>), JobError> {
        let mut clock = Clock::new(progress);
        clock.times.clone_from(&self.times);
        let options = &self.job.options;
        let flat = Flat {
            region: &self.region,
            page_mm: self.page_mm,
            source: &options.exemplar,
            seed: Some(options.constants.seed),
            bridges: self.bridges.as_ref().map_or(&[][..], |report| &report.bridges),
            making: &options.making,
            lain: self.sheet.as_ref().map(|(sheet, part)| Lain {
                part,
                map: &sheet.map,
                ground: sheet.model.as_ref(),
            }),
            larger: "an exemplar drawn larger",
        };
        let blamed = outputs.first().map_or_else(|| "the pattern".into(), |output| name(output.target()));
        let made = flat.made(&blamed, outputs, &mut clock)?;
        let [exemplar_density, density] = self.densities;
        let counts = self.sheet.as_ref().map_or_else(|| Counts::of(&self.region), |(_, part)| part.counts);
        let report = FillReport {
            schema_version: 1,
            generator: generator(),
            exemplar: self.exemplar.clone(),
            domain: options.domain.to_string(),
            along: options.along.as_ref().map(ToString::to_string),
            width_mm: options.width_mm,
            surface: options.surface.as_ref().map(SurfaceOptions::report),
            domain_file: self.domain_file.clone(),
            kept: self.kept.clone(),
            domain_mm2: self.domain_mm2,
            page_mm: self.page_mm.to_array(),
            seed: options.constants.seed,
            pen_mm: self.pen_mm,
            wanted_components: options.goal.components.map(Wanted::ends),
            wanted_holes: options.goal.holes.map(Wanted::ends),
            components: counts.components,
            holes: counts.holes,
            own: self.own,
            flat: self.flat_pattern(),
            exemplar_density,
            density,
            levels: self.levels.clone(),
            changes: self.changes.clone(),
            bridges: self.bridges.clone(),
            thickness_mm: options.making.thickness_mm,
            chord_mm: options.making.tolerances.chord_mm(),
            enforced: self.enforced.clone(),
            narrow_places: made.narrow_places,
            quantities: made.quantities,
            bytes: made.bytes,
            solid: made.solid,
            drawing: made.drawing,
            laser: made.laser,
            files: outputs.iter().map(|output| output.target().to_string()).collect(),
            notes: self.notes.iter().cloned().chain(made.notes).collect(),
            times: clock.times,
        };
        Ok((report, made.pending))
    }
}

/// A pattern with what is kept, as lines and as drawn, on its page, and its ink inside of the domain; and where along its curve a closed strip was
/// cut open.
fn laid(
    ground: &Ground,
    pattern: &Drawing,
    [kept_lines, kept_drawn]: [&Drawing; 2],
    region: Region,
    chord_mm: f64,
) -> Result<(Drawing, Region, f64), JobError> {
    let grid = ground.grid();
    let drawing = ground.laid(&pattern.with(kept_lines), chord_mm);
    if !ground.is_strip() {
        // On one grid with the domain; the ink that was counted, not drawn again.
        let ink =
            if region.grid() == grid { region } else { region.placed(grid, |p| p).map_err(grid_error)? };
        return Ok((drawing, ground.clipped(&ink), 0.0));
    }
    let drawn = ground.laid(&pattern.with(kept_drawn), chord_mm);
    let ink = samples::inked(&drawn, grid, INK_SHARE * chord_mm).map_err(grid_error)?;
    let (ink, cut_mm) = ground.opened(&ink)?;
    Ok((drawing, ink, cut_mm))
}
