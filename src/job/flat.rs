//! What follows when the region of a part that lies flat is known: its solid, drawing, cut lines and picture, each verified.
//!
//! A drawing that is extruded and an area that was filled are made the same way. Excluded: where the region comes from, and the names of
//! files.

use std::path::Path;

use glam::DVec2;

use super::blind;
use super::error::JobError;
use super::laser::{Cutting, LaserOptions, LaserReport};
use super::making::{self, Border, Mended, Quantities};
use super::output::{Format, Output, Pending, Target};
use super::part::Part;
use super::picture::{PictureOptions, Pictured, Show};
use super::print::PrintOptions;
use super::raised::{self, Raised};
use super::small;
use super::space;
use super::stage::{Clock, Stage};
use super::surface::{Ground, MergedCounts, SurfaceMode};
use crate::domain::SpaceMap;
use crate::export::{self, SvgOptions};
use crate::fabricate::{Bridge, Counts, Material, Solid};
use crate::planar::{GridPoint, Region, Tolerances};
use crate::verify::{self, Expected, MeshReport, Mismatch, NarrowPlaces, SvgReport};

/// The part of the chord error that is for flattening the drawing; the rest is for fitting curves to it again.
pub(super) const READ_SHARE: f64 = 0.5;

/// How a region is to be made as a part that lies flat.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatMaking {
    /// The height of the solid in millimetres.
    pub thickness_mm: f64,
    /// The tolerances; the counts of the outline must survive their widths.
    pub tolerances: Tolerances,
    /// Whether what is too thin is thickened and what is too narrow widened before.
    pub enforce: bool,
    /// The material, for the mass in the report.
    pub material: Option<Material>,
    /// The walls of the solid, and the printer.
    pub print: PrintOptions,
    /// The files of cut lines.
    pub laser: LaserOptions,
    /// The pictures.
    pub picture: PictureOptions,
}

/// The thickness of a solid when none is asked for, in millimetres: five layers or more of most printers.
const DEFAULT_THICKNESS_MM: f64 = 2.0;

impl Default for FlatMaking {
    fn default() -> Self {
        Self {
            thickness_mm: DEFAULT_THICKNESS_MM,
            tolerances: Tolerances::default(),
            enforce: false,
            material: None,
            print: PrintOptions::default(),
            laser: LaserOptions::default(),
            picture: PictureOptions::default(),
        }
    }
}

impl FlatMaking {
    /// Refuses to enforce widths that are not given.
    pub(super) fn check_enforced(&self) -> Result<(), JobError> {
        if self.enforce && self.tolerances.min_feature_mm() == 0.0 && self.tolerances.min_gap_mm() == 0.0 {
            return Err(making::no_width());
        }
        Ok(())
    }

    pub(super) fn check(&self, outputs: &[Output]) -> Result<(), JobError> {
        self.check_enforced()?;
        self.laser.check(outputs)?;
        self.picture.check(outputs)?;
        if self.laser.carve {
            self.picture.check_sign()?;
        }
        if self.picture.show.contains(&Show::Seams) {
            return Err(JobError::Option {
                option: "--show",
                found: "seams are where pieces of a band meet, and there are no pieces here".to_owned(),
                wanted: "use --show thin or bridges".to_owned(),
            });
        }
        self.print.profile(self.thickness_mm)?;
        Ok(())
    }

    /// The region with its minimum feature and gap enforced, if that is asked for and something was lacking.
    pub(super) fn enforced(
        &self,
        region: &Region,
        clock: &mut Clock<'_>,
    ) -> Result<Option<Mended>, JobError> {
        if !self.enforce {
            return Ok(None);
        }
        clock.time(Stage::Enforce, || match self.laser.plate() {
            Some(sheet) => {
                let of_pattern = self.laser.of_pattern(&self.tolerances);
                making::enforced_in_plate(region, &of_pattern, Border::Straight, sheet)
            }
            None => making::enforced(region, &self.tolerances, Border::Straight),
        })
    }
}

/// A region that is to be made as it is.
pub(super) struct Flat<'f> {
    /// Where it lies on its page, y up.
    pub(super) region: &'f Region,
    /// Width and height of the page.
    pub(super) page_mm: DVec2,
    /// The drawing that it comes from, for what files say of it.
    pub(super) source: &'f Path,
    /// The seed that it comes from, if there is one.
    pub(super) seed: Option<u64>,
    /// The bridges in it, which pictures show.
    pub(super) bridges: &'f [Bridge],
    /// How it is made.
    pub(super) making: &'f FlatMaking,
    /// Where it lies, if that is not in the plane; then the drawing is the part laid flat.
    pub(super) lain: Option<Lain<'f>>,
    /// What would make all of it larger, for remedies.
    pub(super) larger: &'static str,
}

/// A part along a curve in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lain<'f> {
    /// It as it is laid flat, and what it has as it stands.
    pub(super) part: &'f Part,
    pub(super) map: &'f SpaceMap,
    /// The model that it is on, if there is one.
    pub(super) ground: Option<&'f Ground>,
}

impl Lain<'_> {
    /// What the model has with the part, if they are one.
    fn merged_counts(&self) -> Result<Option<MergedCounts>, JobError> {
        let counts = self.part.counts;
        Ok(self.ground.map(|ground| ground.merged_counts(counts)).transpose()?.flatten())
    }

    /// Whether it is cut out of a model, so that its ink is a gap of what is made.
    fn is_carved(&self) -> bool {
        self.ground.is_some_and(|ground| ground.options().mode == SurfaceMode::Carve)
    }

    /// It as a solid with facets within `chord_mm`, and the model if they are one. `asked_mm` is the chord error that was asked for.
    fn solid(&self, chord_mm: f64, asked_mm: f64, notes: &mut Vec<String>) -> Result<Solid, JobError> {
        let Self { part, map, ground } = *self;
        if !self.is_carved() {
            notes.extend(space::relief_notes(map, asked_mm));
        }
        let solid = space::solid(part, map, chord_mm)?;
        match ground {
            Some(ground) => ground.merged(solid, part.counts, notes),
            None => Ok(solid),
        }
    }
}

/// What was made of it, and what was found in the files.
pub(super) struct FlatMade {
    /// The outputs on their way to their names.
    pub(super) pending: Vec<Pending>,
    /// The solid, if something asked for it.
    pub(super) raised: Option<Solid>,
    pub(super) narrow_places: NarrowPlaces,
    pub(super) quantities: Quantities,
    /// Bytes of the files, in their order.
    pub(super) bytes: Vec<usize>,
    pub(super) solid: Option<MeshReport>,
    pub(super) drawing: Option<SvgReport>,
    pub(super) laser: Option<LaserReport>,
    pub(super) notes: Vec<String>,
}

impl Flat<'_> {
    /// Encodes every output, reads each again and counts. `blamed` is named where the region itself is at fault.
    ///
    /// # Errors
    /// [`JobError`] when a file cannot be made or does not pass.
    pub(super) fn made(
        &self,
        blamed: &Path,
        outputs: &[Output],
        clock: &mut Clock<'_>,
    ) -> Result<FlatMade, JobError> {
        let region = self.region;
        let FlatMaking { tolerances, material, print, laser, picture, .. } = self.making;
        let (thickness_mm, enforce) = (self.making.thickness_mm, self.making.enforce);
        let expected = Expected {
            components: Some(region.components().into()),
            holes: Some(region.holes().into()),
            ..Expected::default()
        };
        let counts = self.lain.map_or_else(|| Counts::of(region), |lain| lain.part.counts);
        let merged = self.lain.map(|lain| lain.merged_counts()).transpose()?.flatten();
        let standing = merged.map(MergedCounts::expected).unwrap_or_else(|| Expected {
            components: Some(counts.components.into()),
            holes: Some(counts.holes.into()),
            ..Expected::default()
        });
        let joined = self.lain.and_then(|lain| lain.part.joined.as_ref());
        let document = print.document(self.source, self.seed, counts);
        let mut cutting = match laser.is_needed(outputs) {
            true => {
                let curve_chord_mm = tolerances.chord_mm() * (1.0 - READ_SHARE);
                Some(clock.time(Stage::CutLines, || {
                    Cutting::new(laser, region, self.page_mm, tolerances, curve_chord_mm, self.description())
                })?)
            }
            false => None,
        };
        let kept = cutting.as_ref().filter(|_| laser.carve).map_or(region, Cutting::kept);
        let is_shown =
            picture.view.is_some() || self.lain.is_some() || !print.profile(thickness_mm)?.is_upright();
        let wanted = raised::Wanted { outputs, document: &document, expected: &standing, is_shown };
        // Neither needs the other.
        let (narrow_places, raised) = clock.both(
            |clock| {
                clock.time(Stage::Verify, || {
                    let narrow_places = making::worst_places(kept, tolerances);
                    // What was cut open is judged with what lies beyond the cut.
                    match joined {
                        Some(joined) => joined
                            .check_widths(kept, tolerances)
                            .map(|()| joined.narrow_places(&narrow_places, kept, tolerances)),
                        None => making::check_widths(kept, tolerances).map(|()| narrow_places),
                    }
                    .map_err(|mismatch| {
                        let is_carved = self.lain.is_some_and(|lain| lain.is_carved());
                        too_narrow(mismatch, blamed, enforce || joined.is_some(), is_carved)
                    })
                })
            },
            |clock| {
                let asked_mm = tolerances.chord_mm();
                match self.lain {
                    Some(lain) => Raised::bent(wanted, clock, asked_mm, |chord_mm, notes| {
                        lain.solid(chord_mm, asked_mm, notes)
                    }),
                    None => {
                        Raised::new(wanted, clock, |notes| print.solid(region, thickness_mm, asked_mm, notes))
                    }
                }
            },
        );
        let (narrow_places, raised) = (narrow_places?, raised?);
        let (mut solid, mut drawn) = (None, None);
        let mut pending = Vec::with_capacity(outputs.len());
        let mut sizes = Vec::with_capacity(outputs.len());
        for output in outputs {
            let target = output.target();
            if let Some(cutting) = cutting.as_mut().filter(|_| laser.makes(output.format())) {
                let (item, bytes) = cutting.write(output, picture, &narrow_places, clock)?;
                sizes.push(bytes.len());
                pending.push(item);
                continue;
            }
            let item = match output.format() {
                Format::Dxf => unreachable!("a DXF has cut lines"),
                Format::Stl | Format::Threemf | Format::Obj => {
                    let file = raised.file(output.format()).expect("its output asked for it");
                    sizes.push(file.bytes.len());
                    solid = Some(file.found.clone());
                    clock.time(Stage::Verify, || Pending::unchanged(target, &file.bytes))?
                }
                Format::Svg => {
                    let chord_mm = tolerances.chord_mm();
                    let bytes = clock.time(Stage::Svg, || self.svg(chord_mm))?;
                    sizes.push(bytes.len());
                    let item = Pending::new(target, bytes)?;
                    drawn = Some(clock.time(Stage::Verify, || {
                        check_svg(target, &item, &expected, tolerances, joined.is_some())
                    })?);
                    item
                }
                Format::Png => {
                    let narrow_mm = narrow_places.places_mm();
                    let engraved = cutting.as_ref().map(Cutting::engraved_on_part).transpose()?.flatten();
                    let part = Pictured {
                        region,
                        bridges: self.bridges,
                        seams_mm: &[],
                        narrow_mm: &narrow_mm,
                        engraved: engraved.as_ref(),
                    };
                    let picture = clock.time(Stage::Png, || picture.png(&part, raised.solid()))?;
                    sizes.push(picture.len());
                    Pending::new(target, picture)?
                }
            };
            pending.push(item);
        }
        let quantities = match cutting.as_ref().and_then(Cutting::sign) {
            Some(sign) => Quantities::new(sign, thickness_mm, None, material.as_ref()),
            None => Quantities::new(region, thickness_mm, raised.volume_mm3(), material.as_ref()),
        };
        let narrowest_mm = narrow_places.ink.first().map(|n| n.width_mm);
        let mut notes = raised.notes.clone();
        notes.extend(small::warnings(region, tolerances, outputs, narrowest_mm, self.larger));
        let (material, gap) = if laser.carve { ("material", "cut") } else { ("ink", "gap") };
        let [ink, gaps] = [&narrow_places.ink, &narrow_places.gaps].map(|places| places.first().copied());
        notes.extend(small::hairline(ink, material, "part", self.larger));
        notes.extend(small::hairline(gaps, gap, "part", self.larger));
        notes.extend(blind::notes(&narrow_places, tolerances, !enforce, self.larger));
        Ok(FlatMade {
            pending,
            raised: raised.solid().cloned(),
            narrow_places,
            quantities,
            bytes: sizes,
            solid,
            drawing: drawn,
            laser: cutting.map(|cutting| cutting.report),
            notes,
        })
    }

    fn description(&self) -> String {
        format!("{} of {}", generator(), file_name(self.source))
    }

    /// The outline on its page, which grows where ink lies outside of it.
    fn svg(&self, chord_mm: f64) -> Result<Vec<u8>, JobError> {
        let (low, high) = self.region.bounds_mm().unwrap_or_default();
        let grid = self.region.grid();
        // By whole steps, so that the outline stays what it is.
        let [left, below] = low.to_array().map(|mm| if mm < 0.0 { -grid.steps(mm) } else { 0 });
        let corner = DVec2::new(grid.mm(left), grid.mm(below));
        let page_mm = self.page_mm.max(high) + corner;
        let options = SvgOptions {
            width_mm: page_mm.x,
            height_mm: page_mm.y,
            chord_mm: chord_mm * (1.0 - READ_SHARE),
            title: None,
            description: Some(self.description()),
        };
        Ok(export::svg(&self.region.shifted(GridPoint::new(left, below)), &options)?.text.into_bytes())
    }
}

/// That what is kept lacks a width that was asked for, whatever files are made of it.
fn too_narrow(mismatch: Mismatch, file: &Path, is_mended: bool, is_carved: bool) -> JobError {
    let remedy = match mismatch {
        _ if !is_mended => "; --enforce would mend it",
        Mismatch::Feature { .. } if is_carved => "; it is cut out of the model: a smaller --min-gap would do",
        Mismatch::Gap { .. } if is_carved => "; it is left between cuts: a smaller --min-feature would do",
        _ => "",
    };
    JobError::Mismatch { file: file.to_owned(), mismatch, remedy: remedy.to_owned() }
}

pub(super) fn generator() -> String {
    format!("Openwork {}", env!("CARGO_PKG_VERSION"))
}

/// Reads a written SVG again and holds it against the plan.
fn check_svg(
    target: &Target,
    pending: &Pending,
    expected: &Expected,
    tolerances: &Tolerances,
    is_cut_open: bool,
) -> Result<SvgReport, JobError> {
    let bytes = pending.read_again()?;
    let report = verify::read_svg(&bytes, tolerances.chord_mm() / 4.0)
        .map_err(|error| JobError::Unjudged { file: name(target), error })?;
    report.check(expected).map_err(|mismatch| mismatched(target, mismatch))?;
    if is_cut_open {
        return Ok(report);
    }
    // The outline has the whole widths; curves that stand for it take off their part on either side.
    making::check_widths_less(&report.region, tolerances, tolerances.chord_mm())
        .map_err(|mismatch| mismatched(target, mismatch))?;
    Ok(report)
}

/// That a written file is not as planned.
fn mismatched(target: &Target, mismatch: Mismatch) -> JobError {
    JobError::Mismatch { file: name(target), mismatch, remedy: String::new() }
}

/// The last part of a path, which is the same in every folder.
pub(super) fn file_name(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy()
}

/// The name of a target in messages.
pub(super) fn name(target: &Target) -> std::path::PathBuf {
    match target {
        Target::File(path) => path.clone(),
        Target::Stdout => "standard output".into(),
    }
}
