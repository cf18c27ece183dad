//! A region whose coordinates are exact in 32-bit floats.

use super::FabricateError;
use crate::planar::{Contour, FillRule, Grid, GridPoint, Region, RegionError};

/// How far ink (or gap) may yield where the 32-bit grid cannot keep two contours apart, in its steps. Fewer, and
/// rounding could bring them together again; more, and what can be written would be refused.
const YIELD_STEPS: f64 = 4.0;

/// Edges shorter than this many steps of the 32-bit grid are merged with their neighbours if the counts allow.
/// Fewer, and a cap gets facets of so little area that programs take them for none; more, and it would show
/// (this is 0.06 micrometres at 64 mm).
const SHORTEST_EDGE_STEPS: i64 = 16;

/// A vertex that makes with its neighbours a triangle of less area than this, in square millimetres, is left out if the
/// counts allow, as a cap, or a quarter of it a roof, may have a facet there. Programs take facets of less than a fifth of it for none.
/// More, and it would show first in parts of a few hundredths of a millimetre.
const FLAT_MM2: f64 = 5e-10;

/// Room for the yield, which may pass the power of two that the extent just fits: a part of the extent.
pub(super) const YIELD_ROOM: f64 = 1e-6;

/// `region` with every coordinate exact in `f32` and the same components and holes.
///
/// A region that is exact already is returned as it is. Otherwise every vertex goes to the nearest point of
/// [`Grid::exact_in_f32`] for the region's extent (3.8e-6 mm at 64 mm), and edges of a few steps
/// and bends that are nearly none go. Where that makes contours cross or
/// touch, the region is filled anew; where that joins or severs ink, all ink yields by a few steps, or all
/// gaps do. Each is accepted only if no component and no hole came or went.
///
/// # Errors
/// [`FabricateError::TooFine`] names a place that the grid cannot resolve; [`FabricateError::Grid`] when the
/// extent is out of range; [`FabricateError::Empty`].
pub fn snapped_to_f32(region: &Region) -> Result<Region, FabricateError> {
    let (low, high) = region.bounds_mm().ok_or(FabricateError::Empty)?;
    if is_exact(region) {
        return Ok(region.clone());
    }
    let extent = low.abs().max(high.abs()).max_element();
    snapped_to(region, Grid::exact_in_f32(extent * (1.0 + YIELD_ROOM))?)
}

/// `region` on a coarser grid, with the same components and holes, as [`snapped_to_f32`] does it. The grid is for an
/// extent that is larger by [`YIELD_ROOM`].
///
/// # Errors
/// [`FabricateError::TooFine`], [`FabricateError::Grid`].
pub(super) fn snapped_to(region: &Region, grid: Grid) -> Result<Region, FabricateError> {
    let failed = match snap(region, grid)? {
        Attempt::Kept(snapped) => return Ok(snapped),
        Attempt::Changed(failed) => failed,
    };
    for steps in [-YIELD_STEPS, YIELD_STEPS] {
        let yielded = region.offset(steps * grid.step_mm(), grid.step_mm());
        if same_counts(&yielded, region)
            && let Attempt::Kept(snapped) = snap(&yielded, grid)?
        {
            return Ok(snapped);
        }
    }
    Err(failed)
}

enum Attempt {
    /// The same components and holes, on the grid.
    Kept(Region),
    /// The error that tells what became of them.
    Changed(FabricateError),
}

/// What a path is rid of, in steps of its grid.
#[derive(Debug, Clone, Copy)]
struct Trifles {
    /// Edges shorter than this.
    edge: i64,
    /// Bends of less than this, as twice the area of the triangle with both neighbours.
    doubled_area: i128,
}

impl Trifles {
    const NONE: Self = Self { edge: 0, doubled_area: 0 };

    fn on(grid: Grid) -> Self {
        let step_mm2 = grid.step_mm() * grid.step_mm();
        Self { edge: SHORTEST_EDGE_STEPS, doubled_area: (2.0 * FLAT_MM2 / step_mm2).ceil() as i128 }
    }
}

/// Snapped without very short edges and very flat bends, or with them where they are needed.
fn snap(region: &Region, grid: Grid) -> Result<Attempt, FabricateError> {
    match snap_without(region, grid, Trifles::on(grid))? {
        Attempt::Changed(_) => snap_without(region, grid, Trifles::NONE),
        kept => Ok(kept),
    }
}

fn snap_without(region: &Region, grid: Grid, trifles: Trifles) -> Result<Attempt, FabricateError> {
    let mut paths = Vec::new();
    let mut contours = Vec::new();
    let mut fault = None;
    for contour in region.contours() {
        let path = snapped(contour, region.grid(), grid, trifles)?;
        match Contour::new(path.clone()) {
            Some(contour) => contours.push(contour),
            None => fault = fault.or(Some(grid.to_mm(path[0]))),
        }
        paths.push(path);
    }
    if fault.is_none() {
        match Region::from_contours(grid, contours) {
            // Valid contours may still nest otherwise, when one was turned inside out.
            Ok(snapped) if same_counts(&snapped, region) => return Ok(Attempt::Kept(snapped)),
            Ok(_) => {}
            Err(RegionError::Invalid { faults }) => fault = Some(faults[0].position_mm()),
            Err(RegionError::Grid(error)) => return Err(error.into()),
        }
    }
    let filled = Region::fill(grid, &paths, FillRule::Positive);
    if same_counts(&filled, region) {
        return Ok(Attempt::Kept(filled));
    }
    Ok(Attempt::Changed(FabricateError::TooFine {
        position_mm: fault.unwrap_or_else(|| grid.to_mm(paths[0][0])),
        step_mm: grid.step_mm(),
        components: region.components(),
        holes: region.holes(),
        found_components: filled.components(),
        found_holes: filled.holes(),
    }))
}

/// The contour's points on the other grid, without trifles.
fn snapped(
    contour: &Contour,
    from: Grid,
    to: Grid,
    trifles: Trifles,
) -> Result<Vec<GridPoint>, FabricateError> {
    let mut path: Vec<GridPoint> = Vec::with_capacity(contour.points().len());
    for &p in contour.points() {
        let p = to.snap(from.to_mm(p))?;
        let near = |q: &GridPoint| (p.x - q.x).abs().max((p.y - q.y).abs()) < trifles.edge;
        if !path.last().is_some_and(near) {
            path.push(p);
        }
    }
    Ok(without_flat_bends(path, trifles.doubled_area))
}

/// The closed path without vertices that are nearly between their neighbours. Those that are quite between them stay: no
/// facet has them for three corners.
fn without_flat_bends(path: Vec<GridPoint>, doubled_area: i128) -> Vec<GridPoint> {
    let n = path.len();
    let mut kept: Vec<GridPoint> = Vec::with_capacity(n);
    for (i, &p) in path.iter().enumerate() {
        let before = *kept.last().unwrap_or(&path[n - 1]);
        // The last vertex is followed by the first one that is left.
        let after = path.get(i + 1).or(kept.first()).copied().unwrap_or(p);
        let from_before = |q: GridPoint| (i128::from(q.x - before.x), i128::from(q.y - before.y));
        let (u, v) = (from_before(p), from_before(after));
        let doubled = (u.0 * v.1 - u.1 * v.0).abs();
        if doubled == 0 || doubled >= doubled_area {
            kept.push(p);
        }
    }
    kept
}

pub(super) fn same_counts(a: &Region, b: &Region) -> bool {
    (a.components(), a.holes()) == (b.components(), b.holes())
}

fn is_exact(region: &Region) -> bool {
    let grid = region.grid();
    let exact = |mm: f64| f64::from(mm as f32) == mm;
    region.contours().flat_map(|c| c.points()).map(|&p| grid.to_mm(p)).all(|p| exact(p.x) && exact(p.y))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn region(grid: Grid, paths: &[&[(f64, f64)]]) -> Region {
        let snap = |&(x, y): &(f64, f64)| grid.snap(DVec2::new(x, y)).unwrap();
        let paths: Vec<Vec<GridPoint>> = paths.iter().map(|p| p.iter().map(snap).collect()).collect();
        Region::fill(grid, &paths, FillRule::EvenOdd)
    }

    #[test]
    fn a_bend_of_nearly_nothing_is_left_out() {
        let at = |points: &[(i64, i64)]| -> Vec<GridPoint> {
            points.iter().map(|&(x, y)| GridPoint::new(x, y)).collect()
        };
        // The second point is less than a step off the line between its neighbours, the fifth on it; the last is nearly
        // between its neighbour and the first.
        let path = at(&[(0, 0), (20, 6), (41, 12), (50, 400), (25, 400), (0, 400), (-90, 100), (-45, 51)]);
        let kept = at(&[(0, 0), (41, 12), (50, 400), (25, 400), (0, 400), (-90, 100)]);
        assert_eq!(without_flat_bends(path.clone(), 100), kept);
        assert_eq!(without_flat_bends(path.clone(), 0), path);
    }

    #[test]
    fn an_exact_region_is_left_alone() {
        let grid = Grid::for_extent(100.0).unwrap();
        let square = region(grid, &[&[(0.0, 0.0), (10.5, 0.0), (10.5, 10.25), (0.0, 10.25)]]);
        assert_eq!(snapped_to_f32(&square).unwrap(), square);
    }

    #[test]
    fn vertices_move_by_half_a_step_at_most() {
        let grid = Grid::for_extent(100.0).unwrap();
        let triangle = region(grid, &[&[(0.1, 0.2), (70.3, 10.7), (33.3, 60.9)]]);
        let snapped = snapped_to_f32(&triangle).unwrap();
        assert!(is_exact(&snapped));
        let half = snapped.grid().step_mm() / 2.0;
        let pairs = triangle.contours().next().unwrap().points().iter();
        for (p, q) in pairs.zip(snapped.contours().next().unwrap().points()) {
            let moved = (grid.to_mm(*p) - snapped.grid().to_mm(*q)).abs();
            assert!(moved.max_element() <= half, "{moved}");
        }
    }

    #[test]
    fn a_touch_is_mended_where_the_counts_allow() {
        // The spike of the lower square ends a hundredth of a float step below the upper one.
        let grid = Grid::for_extent(1000.0).unwrap();
        let spike: &[(f64, f64)] =
            &[(900.0, 0.0), (910.0, 0.0), (910.0, 5.0), (905.1, 10.0 - 1e-6), (900.0, 5.0)];
        let near = region(grid, &[spike, &[(900.0, 10.0), (910.0, 10.0), (910.0, 15.0), (900.0, 15.0)]]);
        assert_eq!(near.components(), 2);
        let mended = snapped_to_f32(&near).unwrap();
        assert_eq!((mended.components(), mended.holes()), (2, 0));
        assert!((mended.area_mm2() - near.area_mm2()).abs() < 1.0);
    }

    #[test]
    fn what_floats_cannot_resolve_is_refused_with_its_place() {
        // Two wires of 0.1 micrometres as far apart, at the far end of 90 m: neither ink nor gap can yield.
        let grid = Grid::for_extent(90_000.0).unwrap();
        let wire = |x: f64| [(x, 0.0), (x + 1e-4, 0.0), (x + 1e-4, 5.0), (x, 5.0)];
        let wires = region(grid, &[&wire(89_980.0), &wire(89_980.0 + 2e-4)]);
        let Err(FabricateError::TooFine { position_mm, components, .. }) = snapped_to_f32(&wires) else {
            panic!("the gap is below the resolution of floats")
        };
        assert_eq!(components, 2);
        assert!((position_mm.x - 89_980.0).abs() < 0.01, "{position_mm}");
    }

    #[test]
    fn a_gap_that_floats_cannot_resolve_opens() {
        let grid = Grid::for_extent(90_000.0).unwrap();
        let bar = |x: f64| [(x, 0.0), (x + 5.0, 0.0), (x + 5.0, 5.0), (x, 5.0)];
        let bars = region(grid, &[&bar(89_980.0), &bar(89_985.0 + 1e-4)]);
        assert_eq!(snapped_to_f32(&bars).unwrap().components(), 2);
    }

    #[test]
    fn nothing_is_an_error() {
        let empty = Region::empty(Grid::for_extent(1.0).unwrap());
        assert_eq!(snapped_to_f32(&empty), Err(FabricateError::Empty));
    }
}
