//! Any SVG, as it is or with bridges, to a verified solid, drawing or picture.

use std::path::Path;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::bridging::{self, BridgesReport};
use super::error::JobError;
use super::flat::{Flat, FlatMaking, READ_SHARE};
use super::laser::LaserReport;
use super::making::{EnforcedReport, Quantities};
use super::output::{Output, Pending, persist};
use super::report::{InputReport, StageTime};
use super::stage::{Clock, Stage};
use crate::exemplar::{Exemplar, Limits, ReadOptions};
use crate::fabricate::{Counts, Solid};
use crate::planar::{Region, Tolerances};
use crate::topology::{Goal, Wanted};
use crate::verify::{MeshReport, NarrowPlaces, SvgReport};

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

/// Extrudes the drawing in `file` to a solid as `making` says, with `bridges` laid before, and writes each output,
/// verified: the solid as STL, 3MF or OBJ, the outline that it has as SVG on the drawing's own page, cut lines as DXF or SVG,
/// and a picture.
///
/// # Errors
/// [`JobError`] for a drawing that cannot be represented, a thickness out of range, and a file that cannot be
/// written or does not pass; then none of them exists under its name.
pub fn extrude(
    file: &Path,
    making: &FlatMaking,
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
    making: &FlatMaking,
    bridges: Option<ExtrudeBridges>,
    outputs: &[Output],
    progress: &mut dyn FnMut(Stage),
) -> Result<(ExtrudeReport, Vec<Pending>, Option<Solid>), JobError> {
    making.check(outputs)?;
    let (tolerances, laser) = (&making.tolerances, &making.laser);
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
    if let Some(mended) = making.enforced(&region, &mut clock)? {
        notes.push(mended.report.note());
        (region, enforced) = (mended.region, Some(mended.report));
    }
    let flat = Flat {
        region: &region,
        page_mm: DVec2::from(drawing.page_mm()),
        source: file,
        seed: None,
        bridges: bridges.as_ref().map_or(&[][..], |report| &report.bridges),
        making,
        lain: None,
        larger: "a larger drawing",
    };
    let made = flat.made(file, outputs, &mut clock)?;
    notes.extend(made.notes);
    let report = ExtrudeReport {
        schema_version: 1,
        input: InputReport { file: file.display().to_string(), sha256: drawing.sha256().to_owned() },
        components: region.components(),
        holes: region.holes(),
        thickness_mm: making.thickness_mm,
        bridges,
        enforced,
        narrow_places: made.narrow_places,
        quantities: made.quantities,
        bytes: made.bytes,
        solid: made.solid,
        drawing: made.drawing,
        laser: made.laser,
        files: outputs.iter().map(|output| output.target().to_string()).collect(),
        notes,
        times: clock.times,
    };
    Ok((report, made.pending, made.raised))
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
