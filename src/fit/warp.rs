//! The strip warp: bends a piece without being able to change its topology.
//!
//! A piece lies in the strip 0 ≤ x ≤ w. On each side the endpoints have to move to targets in the same order,
//! so there is an increasing function of y through them: d_L on the left and d_R on the right. Blending the
//! two, φ(x, y) = (1 − s) d_L(y) + s d_R(y) with s = smoothstep(x / w), gives for every x an increasing
//! function of y, so (x, y) → (x, φ) is a homeomorphism of the strip whatever is drawn in it.
//!
//! To match tangents, a term a(x) c(y) is added at each side, where a(0) = 0, a'(0) = 1 and a vanishes
//! beyond a reach ρ, and c interpolates the change of slope that each endpoint needs. As |a| ≤ 4/27 ρ, choosing
//! ρ so that 4/27 ρ max|c'| is less than the least ∂φ/∂y keeps φ increasing: the proof still holds. Excluded:
//! slopes steeper than [`STEEPEST`], which no finite reach could turn.

use glam::DVec2;

use super::interpolant::Monotone;
use super::stitch::{Bent, SideTarget, Stitch, Targets};
use crate::pieces::{Endpoint, Piece};

/// Slopes are matched up to this steepness (76 degrees).
const STEEPEST: f64 = 4.0;
/// The part of the least ∂φ/∂y that the tangent terms may use up.
const SHARE: f64 = 0.7;
/// The greatest value of t(1 − t)² on 0..1.
const BUMP_MAX: f64 = 4.0 / 27.0;
/// The tangent term reaches at most this part of the piece, so that both sides' terms never meet.
const MAX_REACH: f64 = 0.5;
/// Beyond the outermost endpoints the change of slope fades out over this many times the greatest reach.
const FADE: f64 = 1.0;

/// The warp of one piece.
#[derive(Debug, Clone)]
pub struct StripWarp {
    width_mm: f64,
    /// Where the ink lies along x: in the blank beyond it, beside a side without endpoints, nothing bends, so that
    /// ink moves with that side from its very edge.
    ink_mm: (f64, f64),
    left: Side,
    right: Side,
}

#[derive(Debug, Clone)]
struct Side {
    heights: Monotone,
    slopes: Monotone,
    /// How far into the piece the slopes are changed, in millimetres; 0 for not at all.
    reach_mm: f64,
}

impl StripWarp {
    /// The warp of the strip of `piece` that takes its endpoints to `targets`.
    pub fn new(piece: &Piece, targets: &Targets<'_>) -> Self {
        let sides = ((&piece.left[..], targets.left), (&piece.right[..], targets.right));
        let blanks_mm = piece.blanks_mm();
        Self::of_strip(piece.width_mm, blanks_mm, sides.0, sides.1, targets.offset_mm, targets.held_mm)
    }

    /// The warp of a strip of `width_mm`, blank at both ends by so much, whose sides' endpoints go to the targets. A side without endpoints
    /// is moved by `offset_mm`, unless heights are held: then points at `held_mm` above and below the middle stay
    /// where they are, and targets must lie between.
    fn of_strip(
        width_mm: f64,
        (before_mm, after_mm): (f64, f64),
        (left, left_targets): (&[Endpoint], &[SideTarget]),
        (right, right_targets): (&[Endpoint], &[SideTarget]),
        offset_mm: f64,
        held_mm: Option<f64>,
    ) -> Self {
        let heights = |ends: &[Endpoint], targets: &[SideTarget]| {
            let mut points: Vec<(f64, f64)> =
                ends.iter().zip(targets).map(|(e, t)| (e.y_mm, t.y_mm)).collect();
            points.reverse();
            match points[..] {
                _ if held_mm.is_some() => {
                    let held = held_mm.unwrap_or_default();
                    points.insert(0, (-held, -held));
                    points.push((held, held));
                }
                [] => points.push((0.0, offset_mm)),
                [bottom, above, ..] => {
                    // Beyond the outermost portals the warp eases into a plain shift.
                    let (below, top) = (points[points.len() - 2], points[points.len() - 1]);
                    let ease = (above.0 - bottom.0, top.0 - below.0);
                    points.insert(0, (bottom.0 - ease.0, bottom.1 - ease.0));
                    points.push((top.0 + ease.1, top.1 + ease.1));
                }
                [_] => unreachable!("a portal has two endpoints"),
            }
            Monotone::new(&points, 1.0)
        };
        let (left_heights, right_heights) = (heights(left, left_targets), heights(right, right_targets));
        let least = left_heights.slope_range().0.min(right_heights.slope_range().0);
        let most_reach = MAX_REACH * (width_mm - before_mm - after_mm);
        Self {
            width_mm,
            ink_mm: (before_mm, width_mm - after_mm),
            left: Side::new(left_heights, left, left_targets, most_reach, least, held_mm),
            right: Side::new(right_heights, right, right_targets, most_reach, least, held_mm),
        }
    }
}

impl Side {
    fn new(
        heights: Monotone,
        ends: &[Endpoint],
        targets: &[SideTarget],
        most_reach: f64,
        least: f64,
        held_mm: Option<f64>,
    ) -> Self {
        let n = ends.len();
        let clamp = |slope: f64| slope.clamp(-STEEPEST, STEEPEST);
        let mut changes: Vec<(f64, f64)> = ends
            .iter()
            .zip(targets)
            .enumerate()
            .map(|(k, (end, target))| {
                let wanted = clamp(target.tangent.y / target.tangent.x);
                let given = clamp(end.slope() * heights.slope_at(n - k));
                (end.y_mm, wanted - given)
            })
            .collect();
        changes.reverse();
        if changes.iter().all(|c| c.1.abs() < 1e-9) {
            return Self { heights, slopes: Monotone::new(&[], 0.0), reach_mm: 0.0 };
        }
        let slopes = faded(&changes, FADE * most_reach, held_mm.unwrap_or(f64::INFINITY));
        let (low, high) = slopes.slope_range();
        let steepest = low.abs().max(high.abs());
        let reach_mm = most_reach.min(SHARE * least / (BUMP_MAX * steepest));
        Self { heights, slopes, reach_mm }
    }

    /// a(x)·c(y) at a distance from this side, for slopes that are measured away from it.
    fn bump(&self, distance: f64, y: f64) -> f64 {
        if distance >= self.reach_mm {
            return 0.0;
        }
        let t = distance / self.reach_mm;
        self.reach_mm * t * (1.0 - t) * (1.0 - t) * self.slopes.value(y)
    }
}

/// The changes of slope with points added beyond the ends, at most `most` from the middle, where they have faded to
/// nothing.
fn faded(changes: &[(f64, f64)], fade: f64, most: f64) -> Monotone {
    let (first, last) = (changes[0].0, changes[changes.len() - 1].0);
    let mut points = vec![((first - fade).max(-most), 0.0)];
    points.extend_from_slice(changes);
    points.push(((last + fade).min(most), 0.0));
    Monotone::new(&points, 0.0)
}

impl Stitch for StripWarp {
    fn bend(&self, piece: &Piece, chord_mm: f64) -> Bent {
        let chains = piece.chains.iter().map(|chain| self.polyline(&chain.points, chord_mm));
        let loops = piece.loops.iter().map(|points| {
            let closed: Vec<DVec2> = points.iter().chain(points.first()).copied().collect();
            let mut bent = self.polyline(&closed, chord_mm);
            bent.pop();
            bent
        });
        Bent { chains: chains.collect(), loops: loops.collect() }
    }
}

/// Halvings of an edge: a thousandth of an edge is as fine as any warp needs.
const MAX_DEPTH: u32 = 10;

impl StripWarp {
    /// The image of a point of the piece; x in 0..=width, and both in millimetres.
    pub fn map(&self, p: DVec2) -> DVec2 {
        let (from, to) = self.ink_mm;
        let t = ((p.x - from) / (to - from)).clamp(0.0, 1.0);
        let s = t * t * (3.0 - 2.0 * t);
        let blended = (1.0 - s) * self.left.heights.value(p.y) + s * self.right.heights.value(p.y);
        let tangents = self.left.bump(p.x, p.y) - self.right.bump(self.width_mm - p.x, p.y);
        DVec2::new(p.x, blended + tangents)
    }

    /// The image of a polyline, with points added where the image of an edge bends away from its chord.
    fn polyline(&self, points: &[DVec2], chord_mm: f64) -> Vec<DVec2> {
        let mut bent = vec![self.map(points[0])];
        for w in points.windows(2) {
            let from = bent[bent.len() - 1];
            self.edge((w[0], from), (w[1], self.map(w[1])), chord_mm, MAX_DEPTH, &mut bent);
        }
        bent
    }

    fn edge(
        &self,
        from: (DVec2, DVec2),
        to: (DVec2, DVec2),
        chord_mm: f64,
        depth: u32,
        bent: &mut Vec<DVec2>,
    ) {
        // A bend may hide from the middle, so the quarters are looked at too.
        let strays = |t: f64| self.map(from.0.lerp(to.0, t)).distance(from.1.lerp(to.1, t)) > chord_mm;
        if depth > 0 && (strays(0.5) || strays(0.25) || strays(0.75)) {
            let middle = from.0.midpoint(to.0);
            let middle = (middle, self.map(middle));
            self.edge(from, middle, chord_mm, depth - 1, bent);
            self.edge(middle, to, chord_mm, depth - 1, bent);
        } else {
            bent.push(to.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Ends = (Vec<Endpoint>, Vec<SideTarget>);

    fn ends() -> impl Strategy<Value = Ends> {
        let end = (0.05f64..2.0, 0.05f64..2.0, -1.3f64..1.3, -1.3f64..1.3);
        (0usize..5, -3.0f64..3.0).prop_flat_map(move |(portals, shift)| {
            prop::collection::vec(end.clone(), 2 * portals).prop_map(move |steps| {
                let (mut from, mut to) = (3.0, 3.0 + shift);
                let mut found = (Vec::new(), Vec::new());
                for (a, b, before, after) in steps {
                    from -= a;
                    to -= b;
                    found.0.push(Endpoint { y_mm: from, tangent: DVec2::from_angle(before) });
                    found.1.push(SideTarget { y_mm: to, tangent: DVec2::from_angle(after) });
                }
                found
            })
        })
    }

    proptest! {
        #[test]
        fn vertical_lines_stay_in_order(left in ends(), right in ends(), width in 0.2f64..20.0, x in 0.0f64..1.0) {
            let warp = StripWarp::of_strip(width, (0.0, 0.0), (&left.0, &left.1), (&right.0, &right.1), 0.5, None);
            let mut before = f64::NEG_INFINITY;
            for i in 0..=2000 {
                let y = -15.0 + 0.015 * f64::from(i);
                let image = warp.map(DVec2::new(x * width, y));
                prop_assert!(image.y > before, "at y = {y}");
                before = image.y;
            }
        }

        #[test]
        fn held_heights_stay(left in ends(), right in ends(), width in 0.2f64..20.0, x in 0.0f64..1.0) {
            let warp = StripWarp::of_strip(width, (0.0, 0.0), (&left.0, &left.1), (&right.0, &right.1), 0.0, Some(30.0));
            let mut before = f64::NEG_INFINITY;
            for i in 0..=2000 {
                let y = -30.0 + 0.03 * f64::from(i);
                let image = warp.map(DVec2::new(x * width, y));
                prop_assert!(image.y > before, "at y = {y}");
                before = image.y;
            }
            for y in [-30.0, 30.0] {
                prop_assert!((warp.map(DVec2::new(x * width, y)).y - y).abs() < 1e-12);
            }
        }

        #[test]
        fn endpoints_and_slopes_arrive(left in ends(), right in ends()) {
            let width = 10.0;
            let warp = StripWarp::of_strip(width, (0.0, 0.0), (&left.0, &left.1), (&right.0, &right.1), 0.0, None);
            for (x, inward, (ends, targets)) in [(0.0, 1.0, &left), (width, -1.0, &right)] {
                let side = if x == 0.0 { &warp.left } else { &warp.right };
                let reach = side.reach_mm;
                for (k, (end, target)) in ends.iter().zip(targets).enumerate() {
                    let at = DVec2::new(x, end.y_mm);
                    prop_assert!((warp.map(at).y - target.y_mm).abs() < 1e-9);
                    let given = end.slope() * side.heights.slope_at(ends.len() - k);
                    if given.abs() < STEEPEST && reach > 1e-3 {
                        // Heights may bend by 5000 per millimetre between near endpoints: the step is well below.
                        let step = DVec2::new(1.0, end.slope()) * inward * reach * 1e-7;
                        let moved = warp.map(at + step) - warp.map(at);
                        let wanted = (target.tangent.y / target.tangent.x).clamp(-STEEPEST, STEEPEST);
                        prop_assert!((moved.y / moved.x - wanted).abs() < 0.02 * (1.0 + wanted.abs()),
                            "{} {}", moved.y / moved.x, wanted);
                    }
                }
            }
        }
    }
}
