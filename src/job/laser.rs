//! Files for a laser or a waterjet: the part as cut lines, with kerf, on a plate, and what cutting takes.
//!
//! The contours are moved by half of the kerf and fitted with lines and arcs. Each file is read again: its lines must
//! be sound and those that were planned, leave as many components and holes as are wanted, and do so too when the kerf is
//! taken off again; and what is left keeps the widths that were asked for.

use std::path::PathBuf;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::engrave::Engraving;
use super::error::{JobError, OURS};
use super::flat::name;
use super::making;
use super::output::{Format, Output, Pending};
use super::picture::PictureOptions;
use super::report::InputReport;
use super::stage::{Clock, Stage};
use crate::export::{self, Curves, CutLines, CutNumbers, DxfVersion, Layer, LayerColours, Marks, SvgOptions};
use crate::fabricate::{self, BurntLimb, Counts, FabricateError, FallenPiece, FilledBay, SheetSize};
use crate::planar::{GridPoint, Region, Tolerances};
use crate::verify::{self, CutReport, Expected, Mismatch, NarrowPlaces};

/// A plate needs so much material around the part, in millimetres, or three kerfs if that is more. Less, and what is
/// left of its edge breaks or burns away.
const EDGE_MM: f64 = 1.0;
const EDGE_KERFS: f64 = 3.0;
/// How finely files are read again, as a part of the chord error: as finely as contours were held apart. Coarser, and the
/// chords of two that pass each other closely may cross.
const READ_PART: f64 = 0.03;

/// What files of cut lines are to be like. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LaserOptions {
    /// Whether an SVG has cut lines instead of ink. A DXF always has.
    pub cut: bool,
    /// The width that the beam burns away; without one, cuts run along the contours themselves.
    pub kerf_mm: Option<f64>,
    /// What the lines are made of.
    pub curves: Curves,
    /// The release of a DXF.
    pub dxf_version: DxfVersion,
    /// The plate in whose middle the part is laid.
    pub sheet: Option<SheetSize>,
    /// Whether the part is cut out of the plate as a sign: what is left of the plate is kept, not the part.
    pub carve: bool,
    /// A drawing whose outlines are engraved: on the part's page, or on the plate's if there is one.
    pub engrave: Option<PathBuf>,
    /// The colours of the layers.
    pub colours: LayerColours,
}

impl LaserOptions {
    /// The tolerances of the pattern, when what is kept has those of `kept`: the ink of what is carved out of a plate is its gaps.
    pub(super) fn of_pattern(&self, kept: &Tolerances) -> Tolerances {
        if self.carve { kept.swapped() } else { *kept }
    }

    /// The plate out of which the part is carved, if it is.
    pub(super) fn plate(&self) -> Option<SheetSize> {
        self.sheet.filter(|_| self.carve)
    }

    /// Whether a file of this format has cut lines.
    pub(super) fn cuts(&self, format: Format) -> bool {
        format == Format::Dxf || (format == Format::Svg && self.cut)
    }

    /// Whether a file of this format is made from the cut lines, or shows what they are about.
    pub(super) fn makes(&self, format: Format) -> bool {
        self.cuts(format) || (format == Format::Png && self.carve)
    }

    /// Whether one of the files is, or shows what is engraved.
    pub(super) fn is_needed(&self, outputs: &[Output]) -> bool {
        let shows = |format| format == Format::Png && self.engrave.is_some();
        outputs.iter().any(|output| self.makes(output.format()) || shows(output.format()))
    }

    /// Refuses options that contradict each other or the outputs.
    ///
    /// # Errors
    /// [`JobError::Option`] names the option; [`JobError::Kerf`] and [`JobError::Sheet`] for one out of range.
    pub fn check(&self, outputs: &[Output]) -> Result<(), JobError> {
        self.kerf_mm.map_or(Ok(()), fabricate::check_kerf)?;
        self.sheet.map_or(Ok(()), SheetSize::check)?;
        let refuse = |option, found: &str, wanted: &str| {
            Err(JobError::Option { option, found: found.to_owned(), wanted: wanted.to_owned() })
        };
        if self.carve && self.sheet.is_none() {
            return refuse("--carve", "there is no plate to carve", "give its size, as --sheet 300x200mm");
        }
        let other = outputs.iter().find(|output| !self.makes(output.format()));
        if let Some(other) = other.filter(|_| self.carve) {
            let found = format!("{} would have the pattern, and not the sign", other.target());
            return refuse("--carve", &found, "write a .dxf, a .png, or an .svg with --cut");
        }
        let given = [
            ("--cut", self.cut),
            ("--kerf", self.kerf_mm.is_some()),
            ("--sheet", self.sheet.is_some()),
            ("--engrave", self.engrave.is_some()),
            ("--curves", self.curves != Curves::default()),
            ("--dxf-version", self.dxf_version != DxfVersion::default()),
        ];
        let none_cut = !outputs.iter().any(|output| self.cuts(output.format()));
        // A picture of a sign shows its plate, and the kerf is tried on it; any picture shows what is engraved.
        let has_picture = outputs.iter().any(|output| output.format() == Format::Png);
        let shows = |option| if option == "--engrave" { has_picture } else { self.carve };
        if let Some((option, _)) =
            given.into_iter().find(|&(option, is_given)| is_given && none_cut && !shows(option))
        {
            let wanted = "write a .dxf, or an .svg with --cut, or leave it out";
            return refuse(option, "no output has cut lines", wanted);
        }
        if self.dxf_version == DxfVersion::R12 && self.curves == Curves::Spline {
            return refuse(
                "--dxf-version",
                "DXF of release 12 has no splines",
                "use --curves arcs or polyline",
            );
        }
        Ok(())
    }
}

/// What was cut, in numbers. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LaserReport {
    /// The width that the beam burns away, if one was given.
    pub kerf_mm: Option<f64>,
    /// Width and height of the plate, if there is one.
    pub sheet_mm: Option<[f64; 2]>,
    /// Components of what is kept: the part, or the plate that it was carved out of.
    pub components: usize,
    /// Holes of what is kept.
    pub holes: usize,
    /// When the part was carved out of a plate: the pieces of the plate that fall out.
    pub falls_out: Option<Vec<FallenPiece>>,
    /// Limbs of what is kept that are narrower than the kerf, so that they burn away, the longest first. Longer ones than
    /// these are refused.
    pub burnt_limbs: Vec<BurntLimb>,
    /// Bays of what is kept that the beam does not get into, so that they stay filled, the largest first.
    pub filled_bays: Vec<FilledBay>,
    /// The drawing that is engraved, if there is one.
    pub engraved: Option<InputReport>,
    /// What cutting takes.
    #[serde(flatten)]
    pub numbers: CutNumbers,
    /// The files of cut lines.
    pub files: Vec<LaserFile>,
}

/// A file of cut lines.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LaserFile {
    /// Its name.
    pub file: String,
    /// Its size.
    pub bytes: usize,
}

/// A part as cut lines, on its way to files.
pub(super) struct Cutting {
    options: LaserOptions,
    lines: CutLines,
    page_mm: DVec2,
    tolerances: Tolerances,
    description: String,
    /// What the cuts bound, on the page of the files.
    cut: Region,
    /// What is kept, and what of it falls out.
    kept: Region,
    fallen: Option<Region>,
    /// The plate without what falls out, when the part was carved out of it.
    sign: Option<Region>,
    engraved: Option<Region>,
    /// How far the part was moved on its plate.
    shift: DVec2,
    pub(super) report: LaserReport,
}

impl Cutting {
    /// The cut lines of a part on its page, or of the plate that it is carved out of. `tolerances` are those of
    /// what is kept, and `curve_chord_mm` is what of the chord error is left for curves.
    pub(super) fn new(
        options: &LaserOptions,
        part: &Region,
        page_mm: DVec2,
        tolerances: &Tolerances,
        curve_chord_mm: f64,
        description: String,
    ) -> Result<Self, JobError> {
        let chord_mm = tolerances.chord_mm();
        let edge_mm = EDGE_MM.max(EDGE_KERFS * options.kerf_mm.unwrap_or(0.0));
        // What is left of a plate around a sign is ink, and has to be as wide.
        let carved_edge_mm = edge_mm.max(tolerances.min_feature_mm());
        let (kept, fallen, sign, falls_out) = match options.sheet {
            Some(sheet) if options.carve => {
                let carved = fabricate::carved(part, sheet, carved_edge_mm)?;
                (carved.plate, Some(carved.fallen), Some(carved.sign), Some(carved.falls_out))
            }
            Some(sheet) => (fabricate::on_sheet(part, sheet, edge_mm)?, None, None, None),
            None => (part.clone(), None, None, None),
        };
        let cut = match options.kerf_mm {
            Some(kerf_mm) => fabricate::compensated(&kept, kerf_mm, curve_chord_mm)?,
            None => kept.clone(),
        };
        let filled_bays = match options.kerf_mm {
            Some(kerf_mm) => fabricate::filled_bays(&kept, &cut, kerf_mm, curve_chord_mm),
            None => Ok(Vec::new()),
        };
        let filled_bays = filled_bays.map_err(FabricateError::from)?;
        let burnt_limbs = match options.kerf_mm {
            Some(kerf_mm) => fabricate::burnt_limbs(&kept, cut.grid(), kerf_mm, curve_chord_mm),
            None => Ok(Vec::new()),
        };
        let burnt_limbs = burnt_limbs.map_err(FabricateError::from)?;
        let shift = options.sheet.map_or(DVec2::ZERO, |sheet| fabricate::shift_onto(part, sheet));
        let read = |file: &PathBuf| Engraving::read(file, chord_mm - curve_chord_mm);
        let engraving = options.engrave.as_ref().map(read).transpose()?;
        let laid = |of: &Engraving| of.on(&kept, fallen.as_ref(), cut.grid(), chord_mm);
        let engraved = engraving.as_ref().map(laid).transpose()?;
        let page_mm = options.sheet.map_or(page_mm, |sheet| DVec2::new(sheet.width_mm, sheet.height_mm));
        let plate = match options.sheet.filter(|_| !options.carve) {
            Some(sheet) => Some(fabricate::plate(cut.grid(), sheet).map_err(JobError::Sheet)?),
            None => None,
        };
        // The page grows where cuts pass its border, by whole steps, so that the lines stay what they are.
        let (low, high) = cut.bounds_mm().unwrap_or_default();
        let margin = |mm: f64| if mm < 0.0 { cut.grid().steps(curve_chord_mm - mm) } else { 0 };
        let by = GridPoint::new(margin(low.x), margin(low.y));
        let corner = cut.grid().to_mm(by);
        let page_mm = page_mm.max(high + curve_chord_mm) + corner;
        let cut = cut.shifted(by);
        let on_page = |region: Option<&Region>| region.map(|region| region.shifted(by));
        let layers = [
            (Layer::Engrave, on_page(engraved.as_ref())),
            (Layer::Cut, Some(cut.clone())),
            (Layer::Sheet, on_page(plate.as_ref())),
        ];
        let layers: Vec<_> =
            layers.iter().filter_map(|(layer, region)| Some((*layer, region.as_ref()?))).collect();
        let lines = CutLines::new(&layers, options.curves, curve_chord_mm)?.with_colours(options.colours);
        let Counts { components, holes } = Counts::of(&kept);
        let report = LaserReport {
            kerf_mm: options.kerf_mm,
            sheet_mm: options.sheet.map(|sheet| [sheet.width_mm, sheet.height_mm]),
            components,
            holes,
            falls_out,
            burnt_limbs,
            filled_bays,
            engraved: engraving.map(|engraving| engraving.input),
            numbers: lines.numbers(),
            files: Vec::new(),
        };
        let (options, tolerances) = (options.clone(), *tolerances);
        Ok(Self {
            options,
            lines,
            page_mm,
            tolerances,
            description,
            cut,
            kept,
            fallen,
            sign,
            engraved,
            shift,
            report,
        })
    }

    /// The sign that is left of the plate without what falls out; `None` when the part itself is kept.
    pub(super) fn sign(&self) -> Option<&Region> {
        self.sign.as_ref()
    }

    /// What is left of the plate, with the pieces that fall out of it: files hold both, and both are judged.
    pub(super) fn kept(&self) -> &Region {
        &self.kept
    }

    /// What is engraved, on the part's own page.
    pub(super) fn engraved_on_part(&self) -> Result<Option<Region>, JobError> {
        let moved = |region: &Region| region.placed(region.grid(), |p| p - self.shift);
        let moved = self.engraved.as_ref().map(moved).transpose();
        Ok(moved.map_err(FabricateError::from)?)
    }

    /// One output, which has passed, and its bytes. A picture is as `picture` says, with what is narrow in the plate.
    pub(super) fn write(
        &mut self,
        output: &Output,
        picture: &PictureOptions,
        narrow: &NarrowPlaces,
        clock: &mut Clock<'_>,
    ) -> Result<(Pending, Vec<u8>), JobError> {
        let bytes = match output.format() {
            Format::Png => clock.time(Stage::Png, || {
                let (fallen, engraved) = (self.fallen.as_ref(), self.engraved.as_ref());
                let marks = Marks { fallen, engraved, ..Marks::default() };
                picture.sign_png(&self.kept, marks, narrow)
            })?,
            Format::Svg => clock
                .time(Stage::CutLines, || {
                    let options = SvgOptions {
                        width_mm: self.page_mm.x,
                        height_mm: self.page_mm.y,
                        chord_mm: self.tolerances.chord_mm(),
                        title: None,
                        description: Some(self.description.clone()),
                    };
                    export::cut_svg(&self.lines, &options)
                })?
                .into_bytes(),
            _ => clock
                .time(Stage::CutLines, || export::dxf(&self.lines, self.options.dxf_version))?
                .into_bytes(),
        };
        let item = Pending::new(output.target(), bytes)?;
        let bytes = item.read_again()?;
        if self.options.cuts(output.format()) {
            clock.time(Stage::Verify, || self.check(output, &bytes))?;
            let file = name(output.target()).display().to_string();
            self.report.files.push(LaserFile { file, bytes: bytes.len() });
        }
        Ok((item, bytes))
    }

    /// Holds the bytes of a file against what is kept.
    fn check(&self, output: &Output, bytes: &[u8]) -> Result<CutReport, JobError> {
        let file = || name(output.target());
        let read = if output.format() == Format::Dxf { verify::read_dxf } else { verify::read_cut_svg };
        let chord_mm = self.tolerances.chord_mm();
        let found =
            read(bytes, chord_mm * READ_PART).map_err(|error| JobError::Unjudged { file: file(), error })?;
        let expected = Expected {
            components: Some(self.report.components.into()),
            holes: Some(self.report.holes.into()),
            ..Expected::default()
        };
        let mismatch = |mismatch| {
            let remedy = match mismatch {
                Mismatch::Feature { .. } | Mismatch::Gap { .. } => "; try a smaller --chord, or --enforce",
                _ => "; try a smaller --chord",
            };
            JobError::Mismatch { file: file(), mismatch, remedy: remedy.to_owned() }
        };
        found.check(&expected).map_err(mismatch)?;
        if let Some(first) = found.open_engraved.first() {
            let count = found.open_engraved.len();
            return Err(mismatch(Mismatch::Cuts { count, first: first.clone() }));
        }
        // A bug of ours, if not: the lines are the plan's within the chord error.
        let within_mm = chord_mm * (1.0 + READ_PART);
        found.is_like(&self.cut, within_mm).map_err(|unlike| JobError::Mismatch {
            file: file(),
            mismatch: unlike.into(),
            remedy: OURS.to_owned(),
        })?;
        let left = match self.options.kerf_mm {
            Some(kerf_mm) => {
                // What the beam leaves of the file.
                let region = found.region.offset(-0.5 * kerf_mm, chord_mm * READ_PART);
                let left = CutReport { region, ..found.clone() };
                left.check(&expected).map_err(mismatch)?;
                left.region
            }
            None => found.region.clone(),
        };
        // What is kept has the whole widths; curves that stand for it take off their part on either side.
        making::check_widths_less(&left, &self.tolerances, chord_mm).map_err(mismatch)?;
        Ok(found)
    }
}
