//! Holes that are too small to be holes: where strokes cross at a small angle, or almost meet.

use glam::DVec2;

use super::ChangeKind;
use super::scene::Scene;
use super::step::{Link, Port, Step};
use super::work::Foot;
use crate::planar::Contour;

/// A hole with less area than a square of this many chords is an accident of drawing.
const LEAST_CHORDS: f64 = 8.0;

/// Dabs of the pen that fill holes with less area than the square of the least gap.
pub(super) fn filled(scene: &Scene) -> Vec<Step> {
    let work = &scene.work;
    let grid = scene.region.grid();
    let least_mm = work.completing.min_gap_mm.max(LEAST_CHORDS * work.completing.chord_mm);
    let holes = scene.region.parts().iter().flat_map(|part| part.holes());
    let small = holes.filter(|hole| hole.area_mm2(grid).abs() < least_mm * least_mm);
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
