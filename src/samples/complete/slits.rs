//! Holes that are too small to be holes: where strokes cross at a small angle, or almost meet; and slits along the frame, where the border
//! cuts off a stroke that runs beside it.

use glam::DVec2;

use super::ChangeKind;
use super::scene::Scene;
use super::step::{Link, Port, Step};
use super::work::Foot;
use crate::planar::Contour;

/// A hole with less area than a square of this many chords is an accident of drawing.
const LEAST_CHORDS: f64 = 8.0;

/// A hole at the frame is a slit if it is narrower than this part of the pen: with less, hairs of light stay there; with more, corners fill.
const SLIT_PENS: f64 = 0.5;

/// Dabs of the pen that fill holes with less area than the square of the least gap, and slits along the frame.
pub(super) fn filled(scene: &Scene) -> Vec<Step> {
    let work = &scene.work;
    let grid = scene.region.grid();
    let least_mm = work.completing.min_gap_mm.max(LEAST_CHORDS * work.completing.chord_mm);
    let holes = scene.region.parts().iter().flat_map(|part| part.holes());
    let small = holes.filter(|hole| hole.area_mm2(grid).abs() < least_mm * least_mm || is_slit(scene, hole));
    let dab = |hole: &Contour| {
        let points: Vec<DVec2> = hole.points().iter().map(|&p| grid.to_mm(p)).collect();
        let far =
            |from: DVec2| points.iter().copied().max_by(|a, b| a.distance(from).total_cmp(&b.distance(from)));
        let a = far(points[0])?;
        let ends = [a, far(a)?].map(|at| work.plane.back(at)).map(|at| Port {
            foot: Foot::Ink(at),
            at,
            owner: None,
            onward: None,
        });
        let [from, to] = ends;
        Some(Step::add(ChangeKind::Fill, &Link::smooth(scene, &from, &to), None))
    };
    small.filter_map(dab).collect()
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
