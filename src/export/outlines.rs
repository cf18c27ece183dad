//! Outlines of lines and curves for the contours of a region, with its components and holes.
//!
//! Every contour is fitted by itself and stays within the chord tolerance of its polygon, but two contours
//! that pass each other more closely than that may still cross. So the outlines are checked as they will
//! stand in the file, rounded: as curves they must keep clear of each other, and flattened they must be a
//! region. Where they fault, the tolerance of the polygon's edges nearby is divided, down to the exact edges.
//! A file therefore has the region's components and holes, for every reader that flattens as finely as the
//! check; specks stand in it point by point, for coarser readers too. Excluded: how a contour is fitted.

use glam::DVec2;

use super::arcs::arcs;
use super::clearance::{Piece, pieces, unclear};
use super::curves::{FITTING, Rounding, fitted};
use super::outline::{Outline, Segment};
use super::runs::Polygon;
use crate::planar::{Contour, EdgeIndex, Region, RegionError};

/// How finely outlines are flattened for the check, as a part of the tolerance. Larger, and curves that pass
/// each other closely, but well, become lines; smaller, and fewer readers flatten as finely.
const CHECK_FLATTENING: f64 = 0.03;
/// What a fault does to the tolerance of the edges nearby.
const TIGHTENING: f64 = 0.25;
/// A tolerance below this part of the chord becomes zero, which keeps the edges themselves.
const EXACT_BELOW: f64 = 1e-3;
/// Contours of less area than so many squares of the chord are specks, of which curves could leave nothing.
const SPECK: f64 = 4.0;
/// Rounds of tightening before all edges are kept: each round finds at least one fault in each contour.
const MAX_ROUNDS: usize = 60;

/// What outlines are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Curves {
    /// Straight lines and circular arcs.
    #[default]
    Arcs,
    /// Straight lines only.
    Polyline,
    /// Straight lines and cubic Béziers.
    Spline,
}

/// Fitted outlines of all contours, in their order, within `chord_mm` of them both ways. They make a region of the same
/// components and holes.
pub(super) fn outlines(region: &Region, curves: Curves, chord_mm: f64) -> Vec<Outline> {
    let grid = region.grid();
    let rounding = Rounding::on(grid);
    let mut polygons: Vec<Polygon> = region
        .contours()
        .map(|c| {
            let speck = c.area_mm2(grid).abs() < SPECK * chord_mm * chord_mm;
            Polygon {
                points: c.points().iter().map(|&p| grid.to_mm(p)).collect(),
                tolerances: vec![if speck { 0.0 } else { chord_mm }; c.points().len()],
            }
        })
        .collect();
    let fit = |polygon: &Polygon| {
        let (start, segments) = match curves {
            Curves::Arcs => arcs(&polygon.runs(), rounding),
            Curves::Polyline => lines(polygon, rounding),
            Curves::Spline => fitted(&polygon.runs(), rounding),
        };
        Outline { start, segments }
    };
    let mut outlines: Vec<Outline> = polygons.iter().map(fit).collect();
    let mut index = None;
    for round in 0.. {
        let faults = faults(region, &outlines, chord_mm);
        if faults.is_empty() || round > MAX_ROUNDS {
            break;
        }
        let mut concerned = vec![false; polygons.len()];
        let edges = index.get_or_insert_with(|| EdgeIndex::new(region));
        for &fault in &faults {
            // An outline at the fault has its polygon within the tolerance of it.
            for edge in edges.within(fault, 1.5 * chord_mm) {
                let tolerance = &mut polygons[edge.contour].tolerances[edge.edge];
                if *tolerance > 0.0 {
                    *tolerance *= TIGHTENING;
                    if *tolerance < EXACT_BELOW * chord_mm {
                        *tolerance = 0.0;
                    }
                    concerned[edge.contour] = true;
                }
            }
        }
        if round == MAX_ROUNDS || !concerned.contains(&true) {
            for polygon in &mut polygons {
                polygon.tolerances.fill(0.0);
            }
            concerned.fill(true);
        }
        for i in (0..polygons.len()).filter(|&i| concerned[i]) {
            outlines[i] = fit(&polygons[i]);
        }
    }
    outlines
}

/// The polygon with as few vertices as its tolerances allow.
fn lines(polygon: &Polygon, rounding: Rounding) -> (DVec2, Vec<Segment>) {
    let thinned = polygon.thinned(FITTING);
    let n = thinned.points.len();
    let rounded = |i: usize| {
        let tolerance = thinned.tolerances[i % n].min(thinned.tolerances[(i + n - 1) % n]);
        rounding.round(thinned.points[i % n], tolerance)
    };
    (rounded(0), (1..=n).map(|i| Segment::Line(rounded(i))).collect())
}

/// Where the outlines are not a region of the same components and holes.
fn faults(region: &Region, outlines: &[Outline], chord_mm: f64) -> Vec<DVec2> {
    let grid = region.grid();
    let flattened: Vec<_> = outlines.iter().map(|o| pieces(o, CHECK_FLATTENING * chord_mm)).collect();
    let mut faults = unclear(&flattened, chord_mm);
    let mut contours = Vec::with_capacity(outlines.len());
    for pieces in &flattened {
        // Points beyond the grid's extent, and contours that lost their area, are faults like a crossing.
        let snapped: Result<Vec<_>, _> = pieces.iter().map(|p| grid.snap(p.from())).collect();
        match snapped.ok().and_then(Contour::new) {
            Some(contour) => contours.push(contour),
            None => faults.extend(pieces.iter().map(Piece::from)),
        }
    }
    if !faults.is_empty() {
        return faults;
    }
    match Region::from_contours(grid, contours) {
        Ok(found) if (found.components(), found.holes()) == (region.components(), region.holes()) => {
            Vec::new()
        }
        Ok(_) => outlines.iter().map(|o| o.start).collect(),
        Err(RegionError::Invalid { faults }) => faults.iter().map(|f| f.position_mm()).collect(),
        Err(RegionError::Grid(_)) => outlines.iter().map(|o| o.start).collect(),
    }
}
