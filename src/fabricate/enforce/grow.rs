//! One step: ink, or a gap, grows by strokes, and no count changes.
//!
//! What grows never takes from the guards of the other side, which are the kept core of that side made wide; so nothing
//! that was apart meets, and nothing is closed off that held together. Two things may still go wrong in the small, and
//! are put right: a stroke may be cut in pieces by the guards, of which some hang on nothing, and it may cut off the
//! end of a notch. Pieces without a core of their own side are dropped, cut-off ends without a core of the other side
//! are filled.

use glam::DVec2;

use super::stroke::Stroke;
use crate::planar::{Contour, FillRule, Grid, GridPoint, Region, boundaries};

/// Strokes that are united at a time. More, and what they cover twice is cut up again and again; fewer, and each outline
/// goes through more rounds.
const FEW: usize = 16;

/// What bounds the growth.
pub(super) struct Bounds<'a> {
    /// Strokes that are not grown into.
    pub(super) guards: &'a [Stroke],
    /// A box that is not left, as its lower left and upper right corner in millimetres.
    pub(super) within: (DVec2, DVec2),
    /// How far polygons may be from the discs that they stand for.
    pub(super) chord_mm: f64,
}

/// `set` with `strokes`, but without what of them lies in a guard. `own` has a point of each part of the set, and
/// `other` one of each part of what is not in it.
pub(super) fn grown(
    set: &Region,
    strokes: &[Stroke],
    bounds: &Bounds<'_>,
    own: &[DVec2],
    other: &[DVec2],
) -> Region {
    let grid = set.grid();
    let covered = |strokes: &[Stroke]| covered(strokes, grid, bounds.chord_mm);
    let (grown, guarded) = std::thread::scope(|scope| {
        let guarded = scope.spawn(|| covered(bounds.guards));
        let grown = covered(strokes);
        (grown, guarded.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    // Positive where a stroke is (1), in the box (1 less 1), and no guard (−1); or where the set is (3).
    let mut layers = grown;
    layers.extend(guarded.into_iter().map(reversed));
    layers.push(rectangle(grid, bounds.within));
    let around = around(set, bounds.within);
    layers.push(reversed(around));
    for _ in 0..3 {
        layers.extend(set.contours().map(|contour| contour.points().to_vec()));
    }
    tidied(Region::fill(grid, &layers, FillRule::Positive), own, other)
}

/// The boundary of all that strokes cover. Those that follow each other overlap many times over, so they are united a few
/// at a time: of each few hardly more than the outline is left for the next round.
fn covered(strokes: &[Stroke], grid: Grid, chord_mm: f64) -> Vec<Vec<GridPoint>> {
    let united = |polygons: &[Vec<GridPoint>]| paths(&boundaries(polygons, FillRule::NonZero));
    let polygons: Vec<Vec<GridPoint>> = strokes.iter().map(|stroke| stroke.polygon(grid, chord_mm)).collect();
    let mut few: Vec<Vec<Vec<GridPoint>>> = polygons.chunks(FEW).map(united).collect();
    while few.len() > FEW {
        few = few.chunks(FEW).map(|few| united(&few.concat())).collect();
    }
    united(&few.concat())
}

/// What is not in `set`, inside of `frame`.
pub(super) fn complement(set: &Region, frame: (DVec2, DVec2)) -> Region {
    let contours = set.contours().map(|contour| reversed(contour.points().to_vec()));
    let paths: Vec<Vec<GridPoint>> = contours.chain([rectangle(set.grid(), frame)]).collect();
    Region::fill(set.grid(), &paths, FillRule::Positive)
}

/// Without parts that have no point of `own`, and holes that have none of `other`.
fn tidied(region: Region, own: &[DVec2], other: &[DVec2]) -> Region {
    let grid = region.grid();
    let points = |of: &[DVec2]| -> Vec<GridPoint> {
        of.iter().map(|p| GridPoint::new(grid.steps(p.x), grid.steps(p.y))).collect()
    };
    let (own, other) = (points(own), points(other));
    let has = |contour: &Contour, of: &[GridPoint]| {
        let (low, high) = contour.bounds();
        let is_near = |p: &GridPoint| (low.x..=high.x).contains(&p.x) && (low.y..=high.y).contains(&p.y);
        of.iter().filter(|p| is_near(p)).any(|&p| contour.contains(p))
    };
    let mut kept = Vec::new();
    for part in region.parts().iter().filter(|part| has(part.exterior(), &own)) {
        kept.push(part.exterior().clone());
        kept.extend(part.holes().iter().filter(|hole| has(hole, &other)).cloned());
    }
    if kept.len() == region.contours().count() {
        return region;
    }
    Region::fill(grid, &paths(&kept), FillRule::Positive)
}

fn paths(contours: &[Contour]) -> Vec<Vec<GridPoint>> {
    contours.iter().map(|contour| contour.points().to_vec()).collect()
}

fn reversed(mut path: Vec<GridPoint>) -> Vec<GridPoint> {
    path.reverse();
    path
}

fn rectangle(grid: Grid, (low, high): (DVec2, DVec2)) -> Vec<GridPoint> {
    let at = |x: f64, y: f64| GridPoint::new(grid.steps(x), grid.steps(y));
    vec![at(low.x, low.y), at(high.x, low.y), at(high.x, high.y), at(low.x, high.y)]
}

/// A rectangle around everything that is laid on top of each other.
fn around(set: &Region, (low, high): (DVec2, DVec2)) -> Vec<GridPoint> {
    let bounds = set.bounds_mm().unwrap_or((low, high));
    let (low, high) = (low.min(bounds.0), high.max(bounds.1));
    let margin = high - low + 1.0;
    rectangle(set.grid(), (low - margin, high + margin))
}
