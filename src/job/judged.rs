//! The drawing and the solid of a band, judged before they are files.
//!
//! The promise at the machine's tolerance is checked on the drawing, so one is always made. Excluded: cut lines, which are
//! judged as files ([`super::laser`]).

use std::path::PathBuf;

use super::band::Band;
use super::choice::Choice;
use super::error::JobError;
use super::flat::{file_name, name};
use super::laser::Cutting;
use super::making;
use super::output::{Format, Output};
use super::print;
use super::raised::{Raised, Wanted};
use super::space;
use super::stage::{Clock, Stage};
use super::surface::MergedCounts;
use crate::export::{self, MeshDocument, SvgDocument, SvgOptions};
use crate::fabricate::{Counts, Solid};
use crate::planar::{Region, Tolerances};
use crate::verify::{self, Expected, Mismatch, NarrowPlaces, Narrowest, SvgReport};

/// The part of the chord error that is for fitting curves to the drawing.
const SVG_SHARE: f64 = 0.5;

/// What a drawing without a file is called.
const DRAWING: &str = "the drawing";

/// A drawing that has passed, and what was found in it.
#[derive(Debug, Clone)]
pub(super) struct Drawn {
    pub(super) drawing: SvgDocument,
    pub(super) found: SvgReport,
}

impl Band {
    /// What every file has to have. The widths of a pattern that is carved out of a plate are those of the plate, which is
    /// judged by itself.
    pub(super) fn expected(&self) -> Expected {
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
    pub(super) fn kept_tolerances(&self) -> Tolerances {
        // Twice swapped is not swapped.
        self.job.options.laser.of_pattern(&self.job.tolerances)
    }

    /// The narrowest places of what is left of a plate, which keeps the widths.
    pub(super) fn judge(&self, kept: &Region, outputs: &[Output]) -> Result<NarrowPlaces, JobError> {
        let tolerances = self.kept_tolerances();
        let places = making::worst_places(kept, &tolerances);
        making::check_widths(kept, &tolerances)
            .map_err(|mismatch| self.mismatch(shown(outputs), mismatch, &places))?;
        Ok(places)
    }

    /// The drawing, which has passed: the promise at the machine's tolerance is checked on it, so it is always made.
    pub(super) fn drawn(&self, clock: &mut Clock<'_>) -> Result<Drawn, JobError> {
        let drawing = clock.time(Stage::Svg, || self.svg())?;
        let mut found = clock.time(Stage::Verify, || self.read_svg(drawing.text.as_bytes()))?;
        let mut expected = self.expected();
        if let Some(joined) = &self.part.joined {
            // The drawing is cut open; the part is not.
            let flat = Counts::of(&self.part.region);
            (expected.components, expected.holes) = (Some(flat.components.into()), Some(flat.holes.into()));
            (expected.min_feature_mm, expected.min_gap_mm) = (0.0, 0.0);
            let tolerances = &self.job.tolerances;
            // What was drawn is rounded, so that its sides would not meet; the part's do.
            let (places, widths) = clock.time(Stage::Verify, || {
                let places = joined.narrow_places(&found.narrow_places, &self.part.region, tolerances);
                (places, joined.check_widths(&self.part.region, tolerances))
            });
            (found.min_feature, found.min_gap) = (places.ink.first().copied(), places.gaps.first().copied());
            found.narrow_places = places;
            widths.map_err(|mismatch| self.mismatch(DRAWING.into(), mismatch, &found.narrow_places))?;
        }
        found
            .check(&expected)
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
    pub(super) fn cutting(&self) -> Result<Cutting, JobError> {
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
        self.solid_within(self.job.tolerances.chord_mm(), notes)
    }

    /// The same with facets within `chord_mm`, in space.
    fn solid_within(&self, chord_mm: f64, notes: &mut Vec<String>) -> Result<Solid, JobError> {
        let options = &self.job.options;
        if let Some(map) = &self.space {
            let solid = space::solid(&self.part, map, chord_mm)?;
            if !self.job.options.carves_model() {
                notes.extend(space::relief_notes(map, chord_mm));
            }
            return match &self.job.ground {
                Some(ground) => ground.merged(solid, self.counts, notes),
                None => Ok(solid),
            };
        }
        options.print.solid(&self.part.region, options.thickness_mm, chord_mm, notes)
    }

    /// What the model has on which it lies, if they are one part.
    pub(super) fn merged_counts(&self) -> Result<Option<MergedCounts>, JobError> {
        let ground = self.job.ground.as_ref();
        Ok(ground.map(|ground| ground.merged_counts(self.counts)).transpose()?.flatten())
    }

    /// The part as a solid, made now if it was not before.
    pub(super) fn into_solid(self) -> Result<Solid, JobError> {
        match self.raised.as_ref().and_then(Raised::solid) {
            Some(solid) => Ok(solid.clone()),
            None => self.solid(&mut Vec::new()),
        }
    }

    /// The solid and its files for those of `outputs` that hold it, and for its picture and its volume.
    pub(super) fn raised(&self, outputs: &[Output], clock: &mut Clock<'_>) -> Result<Raised, JobError> {
        let options = &self.job.options;
        let is_leaning = !options.print.profile(options.thickness_mm)?.is_upright();
        let merged = self.merged_counts()?;
        let wanted = Wanted {
            outputs,
            document: &self.document(),
            expected: &merged.map_or_else(|| self.expected(), MergedCounts::expected),
            // The volume of what is bent is not that of what is flat.
            is_shown: options.picture.view.is_some()
                || ((is_leaning || self.space.is_some()) && !options.laser.carve),
        };
        let asked_mm = self.job.tolerances.chord_mm();
        match self.space.is_some() {
            true => {
                Raised::bent(wanted, clock, asked_mm, |chord_mm, notes| self.solid_within(chord_mm, notes))
            }
            false => Raised::new(wanted, clock, |notes| self.solid_within(asked_mm, notes)),
        }
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

    /// Whether widths could be enforced and were not.
    pub(super) fn can_enforce(&self) -> bool {
        !self.job.options.enforce && self.part.joined.is_none()
    }

    fn mismatch(&self, file: PathBuf, mismatch: Mismatch, found: &NarrowPlaces) -> JobError {
        let scale = |narrowest: Option<&Narrowest>, wanted: f64, option: &str| {
            let factor = narrowest.map(|n| wanted / n.width_mm).filter(|f| f.is_finite() && *f < 100.0);
            // A curve in space has room for so much, and a wider band is longer inside.
            let factor = factor.filter(|_| self.space.is_none());
            let width = factor.map(|f| format!("--width {:.0}mm or more", (self.report.width_mm * f).ceil()));
            // A tile and what is closed in space cannot be mended, and what was mended has been.
            let mend = if self.can_enforce() { "--enforce would mend it, or " } else { "" };
            format!(
                "; {mend}{} would do, or a smaller {option}",
                width.unwrap_or_else(|| "a larger --width".to_owned())
            )
        };
        let tolerances = &self.kept_tolerances();
        // What is carved out of a model is its gap.
        let [feature, gap] = match self.job.options.carves_model() {
            true => ["--min-gap", "--min-feature"],
            false => ["--min-feature", "--min-gap"],
        };
        let remedy = match mismatch {
            Mismatch::Feature { .. } => scale(found.ink.first(), tolerances.min_feature_mm(), feature),
            Mismatch::Gap { .. } => scale(found.gaps.first(), tolerances.min_gap_mm(), gap),
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
pub(super) fn shown(outputs: &[Output]) -> PathBuf {
    let shown = outputs.iter().find(|o| o.format() == Format::Svg).or(outputs.first());
    shown.map_or_else(|| DRAWING.into(), |o| name(o.target()))
}
