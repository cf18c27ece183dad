//! Any SVG, as it is or with bridges, to a verified solid, drawing or picture.

use std::path::Path;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::blind;
use super::bridging::{self, BridgesReport};
use super::error::JobError;
use super::laser::{Cutting, LaserOptions, LaserReport};
use super::making::{self, Border, EnforcedReport, Quantities};
use super::output::{Format, Output, Pending, Target, persist};
use super::picture::{PictureOptions, Pictured, Show};
use super::print::PrintOptions;
use super::raised::{self, Raised};
use super::report::{InputReport, StageTime};
use super::small;
use super::stage::{Clock, Stage};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::export::{self, SvgOptions};
use crate::fabricate::{Bridge, Counts, Material, Solid};
use crate::planar::{GridPoint, Region, Tolerances};
use crate::topology::{Goal, Wanted};
use crate::verify::{self, Expected, MeshReport, Mismatch, NarrowPlaces, SvgReport};

/// The part of the chord error that is for flattening the drawing; the rest is for fitting curves to it again.
const READ_SHARE: f64 = 0.5;

/// What was extruded, and what was found in the files.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExtrudeReport {
    /// The version of this structure.
    pub schema_version: u32,
    /// The drawing.
    pub input: InputReport,
    /// Components of the drawing: shells of the solid.
    pub components: usize,
    /// Holes of the drawing: total genus of the solid.
    pub holes: usize,
    /// The height of the solid in millimetres.
    pub thickness_mm: f64,
    /// The bridges, when some were asked for; the counts are with them.
    pub bridges: Option<BridgesReport>,
    /// What was thickened and widened; null when it was not asked for, or nothing was lacking.
    pub enforced: Option<EnforcedReport>,
    /// The ten narrowest places of ink and of gaps.
    pub narrow_places: NarrowPlaces,
    /// What costs money.
    pub quantities: Quantities,
    /// Bytes of the files, in their order.
    pub bytes: Vec<usize>,
    /// What was found in the solid, if one was written.
    pub solid: Option<MeshReport>,
    /// What was found in the SVG, if one was written.
    pub drawing: Option<SvgReport>,
    /// The files of cut lines, if some were written.
    pub laser: Option<LaserReport>,
    /// The files that were written.
    pub files: Vec<String>,
    /// What the user may want to know.
    pub notes: Vec<String>,
    /// Time per stage.
    pub times: Vec<StageTime>,
}

/// Bridges for a drawing that is extruded, and the counts that they are to make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtrudeBridges {
    /// The width of struts and slits in millimetres.
    pub width_mm: f64,
    /// The number of components, or a range of numbers; `None` leaves it as it is.
    pub components: Option<Wanted>,
    /// The number of holes, or a range of numbers; `None` leaves it as it is.
    pub holes: Option<Wanted>,
}

/// How a drawing that is extruded is to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtrudeMaking {
    /// The height of the solid in millimetres.
    pub thickness_mm: f64,
    /// The tolerances; the counts of the outline must survive its widths.
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

impl ExtrudeMaking {
    fn check(&self, outputs: &[Output]) -> Result<(), JobError> {
        if self.enforce && self.tolerances.min_feature_mm() == 0.0 && self.tolerances.min_gap_mm() == 0.0 {
            return Err(making::no_width());
        }
        self.laser.check(outputs)?;
        self.picture.check(outputs)?;
        if self.laser.carve {
            self.picture.check_sign()?;
        }
        if self.picture.show.contains(&Show::Seams) {
            return Err(JobError::Option {
                option: "--show",
                found: "seams are where pieces of a band meet, and a drawing that is extruded has none"
                    .to_owned(),
                wanted: "use --show thin or bridges".to_owned(),
            });
        }
        self.print.profile(self.thickness_mm)?;
        Ok(())
    }
}

/// Extrudes the drawing in `file` to a solid as `making` says, with `bridges` laid before, and writes each output,
/// verified: the solid as STL, 3MF or OBJ, the outline that it has as SVG on the drawing's own page, cut lines as DXF or SVG,
/// and a picture.
///
/// # Errors
/// [`JobError`] for a drawing that cannot be represented, a thickness out of range, and a file that cannot be
/// written or does not pass; then none of them exists under its name.
pub fn extrude(
    file: &Path,
    making: &ExtrudeMaking,
    bridges: Option<ExtrudeBridges>,
    outputs: &[Output],
    progress: &mut dyn FnMut(Stage),
) -> Result<ExtrudeReport, JobError> {
    let inputs: Vec<&Path> = std::iter::once(file).chain(making.laser.engrave.as_deref()).collect();
    Output::check(outputs.iter().map(Output::target), &inputs)?;
    let (report, pending, _) = extruded(file, making, bridges, outputs, progress)?;
    persist(pending, None)?;
    Ok(report)
}

/// The same with the outputs on their way to their names; and the solid, if some output asked for it.
pub(super) fn extruded(
    file: &Path,
    making: &ExtrudeMaking,
    bridges: Option<ExtrudeBridges>,
    outputs: &[Output],
    progress: &mut dyn FnMut(Stage),
) -> Result<(ExtrudeReport, Vec<Pending>, Option<Solid>), JobError> {
    making.check(outputs)?;
    let ExtrudeMaking { tolerances, material, print, laser, picture, .. } = making;
    let (thickness_mm, enforce) = (making.thickness_mm, making.enforce);
    let mut clock = Clock::new(progress);
    let options = ReadOptions {
        chord_mm: tolerances.chord_mm() * READ_SHARE,
        target_height_mm: None,
        limits: Limits::default(),
    };
    let drawing = clock.time(Stage::Read, || Exemplar::read(file, &options))?;
    let of_pattern = laser.of_pattern(tolerances);
    let mut region = drawing.region().clone();
    let mut notes = drawing.notes().to_vec();
    let bridges = match bridges {
        Some(wanted) => Some(clock.time(Stage::Bridge, || lay(&mut region, wanted, &of_pattern))?),
        None => None,
    };
    notes.extend(bridges.as_ref().map(|report| report.note(Counts::of(&region))));
    let mut enforced = None;
    if enforce
        && let Some(mended) = clock.time(Stage::Enforce, || match laser.plate() {
            Some(sheet) => making::enforced_in_plate(&region, &of_pattern, Border::Straight, sheet),
            None => making::enforced(&region, tolerances, Border::Straight),
        })?
    {
        notes.push(mended.report.note());
        (region, enforced) = (mended.region, Some(mended.report));
    }
    let expected = Expected {
        components: Some(region.components().into()),
        holes: Some(region.holes().into()),
        ..Expected::default()
    };
    let raise = |notes: &mut Vec<String>| print.solid(&region, thickness_mm, tolerances.chord_mm(), notes);
    let document = print.document(file, None, Counts::of(&region));
    let mut cutting = match laser.is_needed(outputs) {
        true => {
            let page_mm = DVec2::from(drawing.page_mm());
            let curve_chord_mm = tolerances.chord_mm() * (1.0 - READ_SHARE);
            let of = format!("{} of {}", generator(), file_name(file));
            Some(clock.time(Stage::CutLines, || {
                Cutting::new(laser, &region, page_mm, tolerances, curve_chord_mm, of)
            })?)
        }
        false => None,
    };
    let kept = cutting.as_ref().filter(|_| laser.carve).map_or(&region, Cutting::kept);
    let is_shown = picture.view.is_some() || !print.profile(thickness_mm)?.is_upright();
    let wanted = raised::Wanted { outputs, document: &document, expected: &expected, is_shown };
    // Neither needs the other.
    let (narrow_places, raised) = clock.both(
        |clock| {
            clock.time(Stage::Verify, || {
                let narrow_places = making::worst_places(kept, tolerances);
                check_widths(kept, tolerances, file, enforce).map(|()| narrow_places)
            })
        },
        |clock| Raised::new(wanted, clock, raise),
    );
    let (narrow_places, raised) = (narrow_places?, raised?);
    let (mut solid, mut drawn) = (None, None);
    let mut pending = Vec::with_capacity(outputs.len());
    let mut sizes = Vec::with_capacity(outputs.len());
    for output in outputs {
        let target = output.target();
        if let Some(cutting) = cutting.as_mut().filter(|_| laser.makes(output.format())) {
            let (item, bytes) = cutting.write(output, picture, &narrow_places, &mut clock)?;
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
                let bytes = clock.time(Stage::Svg, || svg(&region, &drawing, file, chord_mm))?;
                sizes.push(bytes.len());
                let item = Pending::new(target, bytes)?;
                drawn = Some(clock.time(Stage::Verify, || check_svg(target, &item, &expected, tolerances))?);
                item
            }
            Format::Png => {
                let laid: &[Bridge] = bridges.as_ref().map_or(&[], |report| &report.bridges);
                let narrow_mm = narrow_places.places_mm();
                let engraved = cutting.as_ref().map(Cutting::engraved_on_part).transpose()?.flatten();
                let part = Pictured {
                    region: &region,
                    bridges: laid,
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
        None => Quantities::new(&region, thickness_mm, raised.volume_mm3(), material.as_ref()),
    };
    let narrowest_mm = narrow_places.ink.first().map(|n| n.width_mm);
    notes.extend_from_slice(&raised.notes);
    notes.extend(small::warnings(&region, tolerances, outputs, narrowest_mm));
    notes.extend(blind::notes(&narrow_places, tolerances, !enforce));
    let report = ExtrudeReport {
        schema_version: 1,
        input: InputReport { file: file.display().to_string(), sha256: drawing.sha256().to_owned() },
        components: region.components(),
        holes: region.holes(),
        thickness_mm,
        bridges,
        enforced,
        narrow_places,
        quantities,
        bytes: sizes,
        solid,
        drawing: drawn,
        laser: cutting.map(|cutting| cutting.report),
        files: outputs.iter().map(|output| output.target().to_string()).collect(),
        notes,
        times: clock.times,
    };
    Ok((report, pending, raised.solid().cloned()))
}

/// The widths that were asked for are those of what is kept, whatever files are made of it.
fn check_widths(
    region: &Region,
    tolerances: &Tolerances,
    file: &Path,
    is_enforced: bool,
) -> Result<(), JobError> {
    making::check_widths(region, tolerances).map_err(|mismatch| {
        let remedy = if is_enforced { "" } else { "; --enforce would mend it" }.to_owned();
        JobError::Mismatch { file: file.to_owned(), mismatch, remedy }
    })
}

fn generator() -> String {
    format!("Openwork {}", env!("CARGO_PKG_VERSION"))
}

/// The outline on the page of `drawing`, which grows where ink lies outside of it.
fn svg(region: &Region, drawing: &Exemplar, file: &Path, chord_mm: f64) -> Result<Vec<u8>, JobError> {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let grid = region.grid();
    // By whole steps, so that the outline stays what it is.
    let [left, below] = low.to_array().map(|mm| if mm < 0.0 { -grid.steps(mm) } else { 0 });
    let corner = DVec2::new(grid.mm(left), grid.mm(below));
    let page_mm = DVec2::from(drawing.page_mm()).max(high) + corner;
    let options = SvgOptions {
        width_mm: page_mm.x,
        height_mm: page_mm.y,
        chord_mm: chord_mm * (1.0 - READ_SHARE),
        title: None,
        description: Some(format!("{} of {}", generator(), file_name(file))),
    };
    Ok(export::svg(&region.shifted(GridPoint::new(left, below)), &options)?.text.into_bytes())
}

/// Gives a drawing bridges.
fn lay(
    region: &mut Region,
    wanted: ExtrudeBridges,
    tolerances: &Tolerances,
) -> Result<BridgesReport, JobError> {
    let without = Counts::of(region);
    let goal = Goal { components: wanted.components, holes: wanted.holes, closed_pattern: false };
    let bridged = bridging::bridged(region, goal, &bridging::options(wanted.width_mm, tolerances, None))?;
    *region = bridged.region;
    Ok(BridgesReport::new(without, bridged.bridges))
}

/// Reads a written SVG again and holds it against the plan.
fn check_svg(
    target: &Target,
    pending: &Pending,
    expected: &Expected,
    tolerances: &Tolerances,
) -> Result<SvgReport, JobError> {
    let bytes = pending.read_again()?;
    let report = verify::read_svg(&bytes, tolerances.chord_mm() / 4.0)
        .map_err(|error| JobError::Unjudged { file: name(target), error })?;
    report.check(expected).map_err(|mismatch| mismatched(target, mismatch))?;
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
