//! Holes that are too small to be holes: where strokes cross at a small angle, or almost meet; and slits along the frame, where the border
//! cuts off a stroke that runs beside it.
//!
//! A dab of the pen follows the middle of its hole: half way between the hole's two sides, from the one end of it to the other.

use glam::DVec2;

use super::ChangeKind;
use super::scene::Scene;
use super::step::{Step, is_inside};
use super::work::Foot;
use crate::planar::Contour;
use crate::samples::cubic::Cubic;

/// A hole with less area than a square of this many chords is an accident of drawing.
const LEAST_CHORDS: f64 = 8.0;
/// A hole at the frame is a slit if it is narrower than this part of the pen: with less, hairs of light stay there; with more, corners fill.
const SLIT_PENS: f64 = 0.5;
/// Where there are too many holes, those may be filled that have less area than a square of this many pens: a dab hides them.
const HIDDEN_PENS: f64 = 1.0;
/// A dab bends at the most so often; more is a curve.
const MOST_BENDS: u32 = 32;

/// Dabs of the pen that fill holes with less area than the square of the least gap, and slits along the frame.
pub(super) fn filled(scene: &Scene) -> Vec<Step> {
    let work = &scene.work;
    let grid = scene.region.grid();
    let least_mm = work.completing.min_gap_mm.max(LEAST_CHORDS * work.completing.chord_mm);
    let holes = scene.region.parts().iter().flat_map(|part| part.holes());
    let small = holes.filter(|hole| hole.area_mm2(grid).abs() < least_mm * least_mm || is_slit(scene, hole));
    small.filter_map(|hole| dab(scene, hole)).collect()
}

/// Dabs that fill the smallest holes, up to `needed` of those that are hardly seen.
pub(super) fn closable(scene: &Scene, needed: usize, is_banned: &dyn Fn(&Step) -> bool) -> Vec<Step> {
    let area_mm2 = |hole: &Contour| hole.area_mm2(scene.region.grid()).abs();
    let most_mm2 = (HIDDEN_PENS * scene.work.pen_mm).powi(2);
    let holes = scene.region.parts().iter().flat_map(|part| part.holes());
    let mut small: Vec<&Contour> = holes.filter(|hole| area_mm2(hole) < most_mm2).collect();
    small.sort_by(|a, b| area_mm2(a).total_cmp(&area_mm2(b)));
    let dabs = small.into_iter().filter_map(|hole| dab(scene, hole));
    dabs.filter(|step| !is_banned(step)).take(needed).collect()
}

/// A stroke along the middle of a hole; none where that is not in the area.
fn dab(scene: &Scene, hole: &Contour) -> Option<Step> {
    let (work, grid) = (&scene.work, scene.region.grid());
    let back = |&p| work.plane.back(grid.to_mm(p));
    let first = back(hole.points().first()?);
    // In one piece, where the area is rolled.
    let points: Vec<DVec2> = hole.points().iter().map(|p| first + work.area.way(first, back(p))).collect();
    let far = |from: usize| {
        let ways = points.iter().map(|p| p.distance(points[from])).enumerate();
        ways.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    };
    let begin = far(0)?;
    let end = far(begin)?;
    let count = points.len();
    let side = |step: usize| -> Vec<DVec2> {
        let numbers = std::iter::successors(Some(begin), |&i| (i != end).then_some((i + step) % count));
        numbers.map(|i| points[i]).collect()
    };
    let sides = [side(1), side(count - 1)];
    let lengths = [lengths(&sides[0]), lengths(&sides[1])];
    let length_mm = lengths.iter().map(|along| along.last().copied().unwrap_or(0.0)).fold(0.0, f64::max);
    let bends = (length_mm / work.pen_mm).ceil().clamp(1.0, f64::from(MOST_BENDS)) as u32;
    let middle = |k: u32| {
        let [a, b] = [0, 1].map(|i| along(&sides[i], &lengths[i], f64::from(k) / f64::from(bends)));
        a.midpoint(b)
    };
    let cubics: Vec<Cubic> = (0..bends)
        .map(|k| [middle(k), middle(k + 1)])
        .map(|[a, b]| [a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b])
        .collect();
    let feet = [points[begin], points[end]].map(Foot::Ink);
    is_inside(&cubics, work.area).then(|| Step::along(ChangeKind::Fill, feet, &cubics))
}

/// How far each place of a line is along it.
fn lengths(line: &[DVec2]) -> Vec<f64> {
    let mut so_far = 0.0;
    let steps = line.windows(2).map(|w| {
        so_far += w[0].distance(w[1]);
        so_far
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The place at a part of the length of a line, whose places are so far along it.
fn along(line: &[DVec2], lengths: &[f64], part: f64) -> DVec2 {
    let wanted = part * lengths[lengths.len() - 1];
    let next = lengths.partition_point(|&length| length < wanted).clamp(1, line.len().max(2) - 1);
    let side = lengths[next] - lengths[next - 1];
    let part = if side > 0.0 { (wanted - lengths[next - 1]) / side } else { 0.0 };
    line[next - 1].lerp(line[next], part)
}

/// Whether a hole lies along the frame and is narrower, in the mean, than a part of the pen.
fn is_slit(scene: &Scene, hole: &Contour) -> bool {
    let work = &scene.work;
    let Some(frame_mm) = work.completing.frame_mm else { return false };
    let grid = scene.region.grid();
    let points: Vec<DVec2> = hole.points().iter().map(|&p| grid.to_mm(p)).collect();
    let around_mm: f64 = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| a.distance(*b)).sum();
    let mean_mm = 2.0 * hole.area_mm2(grid).abs() / around_mm;
    let at_frame_mm = 0.5 * frame_mm + 4.0 * work.completing.chord_mm;
    mean_mm < SLIT_PENS * work.pen_mm
        && points.iter().any(|&p| work.area.depth_mm(work.plane.back(p)) < at_frame_mm)
}
