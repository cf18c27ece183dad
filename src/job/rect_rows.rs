//! The second pass of a rectangle: rows of a strip, one below the other.
//!
//! The strip, turned by 90 degrees, is cut into rows, and each row may also be used upside down: a run that is cut
//! anywhere can then go on as its own reflection, where every strand meets itself. Beside these joins only those are
//! considered whose strands all fit, by a bar that the caller sets: with two dozen strands on a cut there is always
//! one that is sheared into a sliver when means are compared. Few joins are left that way, which also keeps the
//! search short. Excluded: the order in which strips and bars are tried ([`super::rect_search`]).

use glam::DVec2;

use super::band::Band;
use super::builder::BandJob;
use super::cut::{Cut, slice_region};
use super::error::JobError;
use super::making::Border;
use super::part::Part;
use super::plan::Plan;
use super::planning::{plan_run, plan_way};
use super::rect_builder::RectJob;
use super::rect_strip::Strip;
use super::rect_tile::{clear_sides, join_own_copies, join_sides, opened};
use super::stage::{Clock, Stage};
use crate::domain::{BandMap, CurveSpec};
use crate::exemplar::Exemplar;
use crate::fit::Sides;
use crate::planar::GridPoint;
use crate::topology::{Goal, Topology};
use crate::verify::{self, Tiling};

/// A jump in the second pass costs so many λ. The strip is only as long as the exemplar is high, so a run of it
/// ends every few millimetres anyway; at the price of the first pass, short cycles of equal rows are the optimum.
const JUMP_FACTOR: f64 = 10.0;
/// What moving a row sideways costs in the second pass, as a multiple of the first pass's. A band may climb; a
/// rectangle whose rows wander has ragged sides.
const RISE_FACTOR: f64 = 200.0;
/// What a jump of the misfit 1 costs in the second pass, in λ. Less, and slivers are worth a row more; more, and rows
/// are cut to pieces at the few places where all fits.
const MISFIT_COST: f64 = 10.0;
/// What a jump costs in the second pass that hangs by a hair, in λ. Less, and rows hang by the tips of leaves; more, and
/// they are cut through the middle, where all is ink.
const WEAKNESS_COST: f64 = 10.0;
/// Successors that are weighed of each row, of each orientation. A row's own reflection is among the cheapest; more
/// make the search longer and the pattern no better.
const SUCCESSORS: usize = 4;
/// The most memory that the search for rows may take, in bytes: a way that has no sequence soon is given up for the next.
const ROWS_MEMORY_LIMIT: usize = 8 << 20;
/// Rows may be pressed or stretched sideways by this much to fill the width: as a band along its length.
const STRETCH: std::ops::RangeInclusive<f64> = 0.7..=1.3;
/// So many joins for each row that fits the height look like rows. More, and it is scraps that are repeated.
const JOINS_PER_ROW: f64 = 3.0;

/// A second pass that has a plan.
pub(super) struct Way {
    job: BandJob,
    pub(super) cut: Cut,
    pub(super) plan: Plan,
    planned: Topology,
    /// The misfit of its worst join.
    pub(super) misfit: f64,
}

/// A rectangle that has passed.
pub(super) struct Made {
    pub(super) band: Band,
    /// What its copies make, if it is a tile.
    pub(super) tiling: Option<Tiling>,
}

/// What is wanted of the rows of a strip.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowsWish {
    /// The topology of the rectangle.
    pub(super) goal: Goal,
    /// The greatest misfit of a join.
    pub(super) worst_misfit: f64,
    /// How many times more joins than rows usually have are accepted.
    pub(super) scraps: f64,
    /// Whether a refusal is worth the time to find its reason.
    pub(super) explained: bool,
    /// Which of its cuts a tile's strip is split at: 0 is the best.
    pub(super) split: usize,
}

impl Way {
    /// The best rows of `strip` down the length of `map`.
    ///
    /// # Errors
    /// [`JobError`] when there are none.
    pub(super) fn new(
        job: &RectJob,
        strip: &Strip,
        wish: RowsWish,
        exemplar: &Exemplar,
        map: &BandMap,
        clock: &mut Clock<'_>,
    ) -> Result<Self, JobError> {
        let (tile, rolled) = (job.tile, job.is_rolled());
        let mut options = job.band.options.clone();
        options.along = CurveSpec::Line { length_mm: job.size.height_mm() };
        options.goal = wish.goal;
        options.mirror = true;
        // What is kept whole are places of the exemplar, and these the strip has kept already.
        options.kept.clear();
        options.weights.jump *= JUMP_FACTOR;
        options.weights.rise *= RISE_FACTOR;
        options.weights.misfit = MISFIT_COST;
        options.weights.weakness = WEAKNESS_COST;
        options.weights.worst_misfit = wish.worst_misfit;
        options.weights.successors = SUCCESSORS;
        let memory_limit = job.band.memory_limit.min(ROWS_MEMORY_LIMIT);
        let job = BandJob { options, memory_limit, ..job.band.clone() };
        let mut slice =
            |region: &_| clock.time(Stage::Slice, || slice_region(&job, exemplar.clone(), region));
        // The lower side to the right, so that rows come in reading order.
        let standing = strip.band.part.region.turned_left();
        let mut cut = slice(&standing)?;
        if tile {
            clear_sides(&mut cut);
            let (region, _) = opened(&standing, &cut.slicing.cuts, wish.split, true, &[])?;
            cut = slice(&region)?;
            join_own_copies(&mut cut, true);
        } else if rolled {
            join_sides(&mut cut);
        } else {
            cut.sides = Sides::Filled;
        }
        let (plan, planned) = match wish.explained {
            true => plan_run(&job, &mut cut, map, clock)?,
            false => plan_way(&job, &cut, map, clock).ok_or_else(|| {
                JobError::Refused("no sequence of these rows has what is wanted".to_owned())
            })?,
        };
        let jumps = cut.catalogue.jumps_of(&plan.sequence);
        let rows = map.curve().length_mm() / strip.height_mm();
        if jumps as f64 > wish.scraps * JOINS_PER_ROW * rows.max(1.0) {
            return Err(JobError::Refused(format!(
                "rows would be joined {jumps} times where {rows:.1} rows fit the height, from scraps of the pattern"
            )));
        }
        let misfit = cut.catalogue.joins_of(&plan.sequence).map(|join| join.misfit).fold(0.0, f64::max);
        Ok(Self { job, cut, plan, planned, misfit })
    }

    /// The rectangle, upright. `bridges` are their width, and what is wanted with them.
    ///
    /// # Errors
    /// [`JobError`] when it does not come out right.
    pub(super) fn made(
        &self,
        strip: &Strip,
        bridges: Option<(f64, Goal)>,
        rect: &RectJob,
        map: &BandMap,
        clock: &mut Clock<'_>,
    ) -> Result<Made, JobError> {
        let mut job = self.job.clone();
        if let Some((_, goal)) = bridges {
            job.options.goal = goal;
        }
        let mut band = Band::made(&job, &self.cut, self.plan.clone(), self.planned, map, None, clock)?;
        if !STRETCH.contains(&band.report.squash) {
            return Err(JobError::Refused(format!(
                "the rows would have to be pressed or stretched sideways by {:.0} % to fill the width",
                (band.report.squash - 1.0).abs() * 100.0
            )));
        }
        band.part = turned_back(&band.part);
        if rect.tile {
            // Copies are set page by page.
            let [low, high] = map.v_range_mm();
            band.part = band.part.without_margin(DVec2::new(high - low, map.curve().length_mm()))?;
        }
        band.report.made.page_mm = band.part.page_mm.to_array();
        if let Some(space) = &rect.space {
            band.lay(space, rect.is_rolled());
        }
        if let Some((width_mm, _)) = bridges {
            clock.time(Stage::Bridge, || band.lay_bridges(width_mm, None))?;
        }
        band.enforce(Border::Straight, clock)?;
        // What messages call the width of a band is the height of a row here.
        band.report.width_mm = strip.band.report.width_mm;
        // Ink that the machine cannot make may be thicker another way.
        let found = band.pass(clock)?;
        let tiling = match rect.tile {
            // One that does not join is one way less, and no fault of a file.
            true => {
                let tiling = clock.time(Stage::Verify, || verify::tiling(&found.region));
                Some(tiling.map_err(|fault| JobError::Refused(fault.to_string()))?)
            }
            false => None,
        };
        Ok(Made { band, tiling })
    }
}

/// A part that lies on its left side, set upright on its page.
fn turned_back(part: &Part) -> Part {
    let (low, high) = part.region.bounds_mm().unwrap_or_default();
    let grid = part.region.grid();
    // The turn takes x to −y; the margin below is that which was on the right.
    let up = grid.steps(low.x) + grid.steps(high.x);
    let region = part.region.turned_right().shifted(GridPoint::new(0, up));
    let turned = |p: &DVec2| DVec2::new(p.y, grid.mm(up) - p.x);
    let seams_mm = part.seams_mm.iter().map(|seam| seam.iter().map(turned).collect()).collect();
    Part { region, page_mm: DVec2::new(part.page_mm.y, part.page_mm.x), seams_mm, ..part.clone() }
}
