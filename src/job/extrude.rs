//! Any SVG, as it is or with bridges, to a verified solid, drawing or picture.

use std::path::Path;

use glam::DVec2;
use serde::Serialize;

use super::bridging::{self, BridgesReport};
use super::error::JobError;
use super::laser::{Cutting, LaserOptions, LaserReport};
use super::output::{Format, Output, Pending, Target, persist};
use super::print::{self, PrintOptions, check_mesh};
use super::report::{InputReport, StageTime};
use super::stage::{Clock, Stage};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::export::{self, SvgOptions};
use crate::fabricate::{Bridge, Counts};
use crate::planar::{GridPoint, Region, Tolerances};
use crate::topology::{Goal, Wanted};
use crate::verify::{self, Expected, MeshReport, Mismatch, SvgReport};

/// The part of the chord error that is for flattening the drawing; the rest is for fitting curves to it again.
const READ_SHARE: f64 = 0.5;

/// What was extruded, and what was found in the files.
#[derive(Debug, Clone, PartialEq, Serialize)]
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

/// Extrudes the drawing in `file` to a solid `thickness_mm` high, with `bridges` laid before, and writes each output,
/// verified: the solid as STL, 3MF or OBJ with the walls of `print`, the outline that it has as SVG on the drawing's own
/// page, cut lines as `laser` says, and a picture of it with its bridges.
///
/// # Errors
/// [`JobError`] for a drawing that cannot be represented, a thickness out of range, and a file that cannot be
/// written or does not pass; then none of them exists under its name.
pub fn extrude(
    file: &Path,
    thickness_mm: f64,
    print: &PrintOptions,
    tolerances: &Tolerances,
    bridges: Option<ExtrudeBridges>,
    laser: &LaserOptions,
    outputs: &[Output],
    progress: &mut dyn FnMut(Stage),
) -> Result<ExtrudeReport, JobError> {
    Output::check(outputs.iter().map(Output::target), &[file])?;
    laser.check(outputs)?;
    print.profile(thickness_mm)?;
    let mut clock = Clock::new(progress);
    let options = ReadOptions {
        chord_mm: tolerances.chord_mm() * READ_SHARE,
        target_height_mm: None,
        limits: Limits::default(),
    };
    let drawing = clock.time(Stage::Read, || Exemplar::read(file, &options))?;
    let mut region = drawing.region().clone();
    let mut notes = drawing.notes().to_vec();
    let bridges = match bridges {
        Some(wanted) => Some(clock.time(Stage::Bridge, || lay(&mut region, wanted, tolerances))?),
        None => None,
    };
    notes.extend(bridges.as_ref().map(|report| report.note(Counts::of(&region))));
    let expected = Expected {
        components: Some(region.components().into()),
        holes: Some(region.holes().into()),
        ..Expected::default()
    };
    let mut cutting = match laser.is_needed(outputs) {
        true => {
            let page_mm = DVec2::from(drawing.page_mm());
            let chord_mm = tolerances.chord_mm();
            let chords_mm = [chord_mm, chord_mm * (1.0 - READ_SHARE)];
            let of = format!("{} of {}", generator(), file_name(file));
            Some(clock.time(Stage::CutLines, || Cutting::new(laser, &region, page_mm, chords_mm, of))?)
        }
        false => None,
    };
    let (mut raised, mut solid, mut drawn) = (None, None, None);
    let mut pending = Vec::with_capacity(outputs.len());
    for output in outputs {
        let target = output.target();
        if let Some(cutting) = cutting.as_mut().filter(|_| laser.makes(output.format())) {
            pending.push(cutting.write(output, &mut clock)?.0);
            continue;
        }
        let item = match output.format() {
            Format::Dxf => unreachable!("a DXF has cut lines"),
            format @ (Format::Stl | Format::Threemf | Format::Obj) => {
                let bytes = clock.time(Stage::Stl, || {
                    let make = || print.solid(&region, thickness_mm, tolerances.chord_mm(), &mut notes);
                    let solid = print::raised(&mut raised, make)?;
                    print::mesh(format, solid, &print.document(file, None, Counts::of(&region)))
                })?;
                let item = Pending::new(target, bytes)?;
                solid = Some(clock.time(Stage::Verify, || check_mesh(output, &item, &expected))?);
                item
            }
            Format::Svg => {
                let chord_mm = tolerances.chord_mm();
                let bytes = clock.time(Stage::Svg, || svg(&region, &drawing, file, chord_mm))?;
                let item = Pending::new(target, bytes)?;
                drawn = Some(clock.time(Stage::Verify, || check_svg(target, &item, &expected, chord_mm))?);
                item
            }
            Format::Png => {
                let laid: &[Bridge] = bridges.as_ref().map_or(&[], |report| &report.bridges);
                let marks = Marks { bridges: laid, ..Marks::default() };
                let picture =
                    clock.time(Stage::Png, || export::png(&region, &marks, export::DEFAULT_PIXELS))?;
                Pending::new(target, picture)?
            }
        };
        pending.push(item);
    }
    persist(pending, None)?;
    Ok(ExtrudeReport {
        schema_version: 1,
        input: InputReport { file: file.display().to_string(), sha256: drawing.sha256().to_owned() },
        components: region.components(),
        holes: region.holes(),
        thickness_mm,
        bridges,
        solid,
        drawing: drawn,
        laser: cutting.map(|cutting| cutting.report),
        files: outputs.iter().map(|output| output.target().to_string()).collect(),
        notes,
        times: clock.times,
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
    chord_mm: f64,
) -> Result<SvgReport, JobError> {
    let bytes = pending.read_again()?;
    let report = verify::read_svg(&bytes, chord_mm / 4.0)
        .map_err(|error| JobError::Unjudged { file: name(target), error })?;
    report.check(expected).map_err(|mismatch| mismatched(target, mismatch))?;
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
