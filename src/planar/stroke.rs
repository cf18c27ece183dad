//! Strokes as areas: convex polygons whose union is what the pen covers.
//!
//! The line is flattened; each chord is swept by the pen as a strip, each turn is filled by a wedge from one
//! strip's end to the next one's, and joins and caps are wedges too. Neighbours share the edge from the line
//! to the pen's rim with bitwise the same points, and all polygons run the same way round. So they stay
//! attached when they are snapped to a grid, and their union by winding has neither gaps nor islands. An outline
//! in one piece, made of offset curves, has both: its curves cross again and again by less than the tolerance,
//! and each crossing leaves a speck beside the stroke.
//!
//! Excluded: dashes, which are cut before, and joins other than miter, round and bevel.

use glam::DVec2;
use kurbo::{BezPath, Cap, Join, ParamCurve, PathEl, PathSeg, Stroke};

/// Directions closer than this are one (in radians). Larger, and rims would have steps; smaller, and a wedge
/// could be so thin that snapping turns it over.
const SAME_DIRECTION: f64 = 1e-4;
/// A turn between segments below this is a smooth curve drawn with rounded numbers (in radians). Larger, and
/// blunt corners lose their join; smaller, and the two tangents, which lie beside the chords, make notches.
const SMOOTH_TURN: f64 = 0.02;
/// Two directions this close to opposite leave no corner to be bevelled.
const OPPOSITE: f64 = 1e-6;
/// Chords shorter than this part of the pen's radius are left out: they would be narrower than what
/// [`SAME_DIRECTION`] moves the ends of a strip by.
const SHORTEST_CHORD: f64 = 1e-3;

/// The polygons that the pen of `style` covers along `path`, all counter-clockwise and within `tolerance` of
/// the exact stroke when united; `None` if they have more than `limit` vertices.
pub fn stroked(path: &BezPath, style: &Stroke, tolerance: f64, limit: usize) -> Option<Vec<Vec<DVec2>>> {
    let radius = style.width / 2.0;
    let mut pen = Pen {
        style,
        radius,
        line_tolerance: tolerance / 2.0,
        arc_step: 2.0 * (1.0 - (tolerance / 2.0 / radius).min(1.0)).acos(),
        shortest: (SHORTEST_CHORD * radius).min(tolerance / 4.0),
        same: SAME_DIRECTION.min(tolerance / 40.0 / radius),
        direction: DVec2::X,
        polygons: Vec::new(),
        vertices: 0,
    };
    for subpath in path.subpaths() {
        pen.subpath(subpath);
        if pen.vertices > limit {
            return None;
        }
    }
    Some(pen.polygons)
}

/// One segment of the line.
struct Leg {
    /// Vertices of its chords.
    points: Vec<DVec2>,
    /// Unit tangents at its ends.
    leaving: DVec2,
    reaching: DVec2,
    /// Whether there is a corner or a flat cap at its ends, which needs the tangent and not the chord.
    is_sharp: [bool; 2],
}

impl Leg {
    fn end(&self) -> DVec2 {
        self.points[self.points.len() - 1]
    }

    /// The direction in which the pen has finished the leg.
    fn last_direction(&self) -> DVec2 {
        let chord = self.end() - self.points[self.points.len() - 2];
        if self.is_sharp[1] { self.reaching } else { chord.try_normalize().unwrap_or(self.reaching) }
    }
}

struct Pen<'a> {
    style: &'a Stroke,
    radius: f64,
    line_tolerance: f64,
    arc_step: f64,
    shortest: f64,
    same: f64,
    /// The direction across which the pen lies at present.
    direction: DVec2,
    polygons: Vec<Vec<DVec2>>,
    vertices: usize,
}

impl Pen<'_> {
    fn subpath(&mut self, elements: &[PathEl]) {
        let mut legs: Vec<Leg> = Vec::new();
        for segment in kurbo::segments(elements.iter().copied()) {
            let from = legs.last().map(Leg::end);
            legs.extend(self.leg(&segment, from));
        }
        let n = legs.len();
        if n == 0 {
            return self.dot(elements);
        }
        let closed = matches!(elements.last(), Some(PathEl::ClosePath));
        for i in 0..n {
            let next = (i + 1) % n;
            let sharp =
                if closed || next > 0 { self.is_corner(legs[i].reaching, legs[next].leaving) } else { true };
            (legs[i].is_sharp[1], legs[next].is_sharp[0]) = (sharp, sharp);
        }
        let (begin, leaving) = (legs[0].points[0], legs[0].leaving);
        if closed {
            // Where the last segments were too short, the line still closes where it began.
            let end = legs[n - 1].points.len() - 1;
            legs[n - 1].points[end] = begin;
            self.direction = legs[n - 1].last_direction();
        } else {
            self.direction = -leaving;
            self.cap(begin, self.style.start_cap);
            self.direction = leaving;
        }
        for leg in &legs {
            self.sweep(leg);
        }
        if !closed {
            self.cap(legs[n - 1].end(), self.style.end_cap);
        }
    }

    /// A segment as chords that begin at `from`, where the last one ended; `None` if it is too short to have a
    /// direction.
    fn leg(&self, segment: &PathSeg, from: Option<DVec2>) -> Option<Leg> {
        let control = control_points(segment);
        let mut points = vec![from.unwrap_or(control[0])];
        let line = [PathEl::MoveTo(segment.start()), segment.as_path_el()];
        kurbo::flatten(line, self.line_tolerance, |el| {
            if let PathEl::LineTo(p) = el {
                let p = DVec2::new(p.x, p.y);
                if points[points.len() - 1].distance(p) >= self.shortest {
                    points.push(p);
                }
            }
        });
        if points.len() < 2 {
            return None;
        }
        let leaving = control.iter().find_map(|&p| (p - control[0]).try_normalize())?;
        let reaching = control.iter().rev().find_map(|&p| (control[3] - p).try_normalize())?;
        Some(Leg { points, leaving, reaching, is_sharp: [true; 2] })
    }

    /// Strips along the chords of a leg and wedges between them, with the join before it.
    fn sweep(&mut self, leg: &Leg) {
        if leg.is_sharp[0] {
            self.turn(leg.points[0], leg.leaving, self.style.join);
        }
        let last = leg.last_direction();
        let chords = leg.points.len() - 1;
        for (i, chord) in leg.points.windows(2).enumerate() {
            let Some(along) = (chord[1] - chord[0]).try_normalize() else { continue };
            self.turn(chord[0], along, Join::Round);
            let begin = self.across();
            self.direction = if i + 1 == chords && self.is_same(along, last) { last } else { along };
            let end = self.across();
            let [from, to] = [chord[0], chord[1]];
            self.push(vec![from - begin, to - end, to, to + end, from + begin, from]);
        }
        self.turn(leg.end(), last, Join::Round);
        self.direction = last;
    }

    /// Whether a join is seen where the line turns from `reaching` to `leaving`.
    fn is_corner(&self, reaching: DVec2, leaving: DVec2) -> bool {
        self.style.join != Join::Round && reaching.angle_to(leaving).abs() > SMOOTH_TURN
    }

    /// Turns the pen at `at` and fills the outer side of the turn.
    fn turn(&mut self, at: DVec2, direction: DVec2, join: Join) {
        if self.is_same(self.direction, direction) {
            return;
        }
        let (before, turn) = (self.direction, self.direction.angle_to(direction));
        self.direction = direction;
        // The outer side is on the right of a turn to the left.
        let outer = |direction: DVec2| -direction.perp() * self.radius * turn.signum();
        let (from, to) = (outer(before), outer(direction));
        let mut wedge = vec![at, at + from];
        match join {
            Join::Round => {
                let steps = (turn.abs() / self.arc_step).ceil().clamp(1.0, 1e4);
                let rim = |i| DVec2::from_angle(turn * f64::from(i) / steps).rotate(from);
                wedge.extend((1..steps as u32).map(|i| at + rim(i)));
            }
            _ if turn.abs() > std::f64::consts::PI - OPPOSITE => return,
            Join::Miter if (turn / 2.0).cos() * self.style.miter_limit >= 1.0 => {
                wedge.push(at + (from + to) / (1.0 + before.dot(direction)));
            }
            Join::Miter | Join::Bevel => {}
        }
        wedge.push(at + to);
        if turn < 0.0 {
            wedge.reverse();
        }
        self.push(wedge);
    }

    /// What the pen covers beyond the end of a line that runs in its direction.
    fn cap(&mut self, at: DVec2, cap: Cap) {
        let (across, along) = (self.across(), self.direction * self.radius);
        let mut polygon = vec![at, at - across];
        match cap {
            Cap::Butt => return,
            Cap::Square => polygon.extend([at - across + along, at + across + along]),
            Cap::Round => {
                let half = std::f64::consts::PI;
                let steps = (half / self.arc_step).ceil().clamp(2.0, 1e4);
                let rim = |i| DVec2::from_angle(half * f64::from(i) / steps).rotate(-across);
                polygon.extend((1..steps as u32).map(|i| at + rim(i)));
            }
        }
        polygon.push(at + across);
        self.push(polygon);
    }

    /// A line of no length: round and square caps make a dot, butt caps nothing.
    fn dot(&mut self, elements: &[PathEl]) {
        if let [PathEl::MoveTo(p), _, ..] = *elements {
            let at = DVec2::new(p.x, p.y);
            for (direction, cap) in [(DVec2::X, self.style.end_cap), (-DVec2::X, self.style.start_cap)] {
                self.direction = direction;
                self.cap(at, cap);
            }
        }
    }

    /// From the line to the pen's left rim.
    fn across(&self) -> DVec2 {
        self.direction.perp() * self.radius
    }

    fn is_same(&self, a: DVec2, b: DVec2) -> bool {
        a.angle_to(b).abs() <= self.same
    }

    fn push(&mut self, polygon: Vec<DVec2>) {
        self.vertices += polygon.len();
        self.polygons.push(polygon);
    }
}

/// The control points of the segment as of a cubic with the same ends and end tangents.
fn control_points(segment: &PathSeg) -> [DVec2; 4] {
    let points = match *segment {
        PathSeg::Line(l) => [l.p0, l.p0, l.p1, l.p1],
        PathSeg::Quad(q) => [q.p0, q.p1, q.p1, q.p2],
        PathSeg::Cubic(c) => [c.p0, c.p1, c.p2, c.p3],
    };
    points.map(|p| DVec2::new(p.x, p.y))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::planar::{FillRule, Grid, Region};

    const TOLERANCE: f64 = 0.004;

    fn region(d: &str, style: &Stroke) -> Region {
        let path = BezPath::from_svg(d).unwrap();
        let polygons = stroked(&path, style, TOLERANCE, usize::MAX).unwrap();
        let grid = Grid::for_extent(200.0).unwrap();
        let paths: Vec<Vec<_>> =
            polygons.iter().map(|p| p.iter().map(|&q| grid.snap(q).unwrap()).collect()).collect();
        Region::fill(grid, &paths, FillRule::NonZero).without_cracks()
    }

    #[test]
    fn caps_and_joins_cover_what_they_should() {
        let pi = std::f64::consts::PI;
        let area = |d: &str, style: &Stroke| region(d, style).area_mm2();
        let pen = || Stroke::new(4.0).with_caps(Cap::Butt).with_join(Join::Miter);
        let corner = "M20 20H60V60";
        let close = |a: f64, b: f64| assert!((a - b).abs() < 0.02, "{a} is not {b}");
        close(area(corner, &pen()), 320.0);
        close(area(corner, &pen().with_miter_limit(1.4)), 318.0);
        close(area(corner, &pen().with_join(Join::Bevel)), 318.0);
        close(area(corner, &pen().with_join(Join::Round)), 316.0 + pi);
        close(area("M60 60V20H20", &pen().with_join(Join::Round)), 316.0 + pi);
        close(area("M20 20H60", &pen().with_caps(Cap::Square)), 176.0);
        close(area("M20 20H60", &pen().with_caps(Cap::Round)), 160.0 + 4.0 * pi);
        close(area("M20 20H60H20", &pen().with_join(Join::Round)), 160.0 + 2.0 * pi);
        close(area("M20 20h0", &pen().with_caps(Cap::Round)), 4.0 * pi);
        close(area("M20 20h0", &pen().with_caps(Cap::Square)), 16.0);
        assert!(region("M20 20h0", &pen()).is_empty());
        let frame = region("M20 20H60V60H20Z", &pen());
        assert_eq!((frame.components(), frame.holes()), (1, 1));
        close(frame.area_mm2(), 44.0 * 44.0 - 36.0 * 36.0);
    }

    #[test]
    fn a_stroke_of_many_smooth_curves_has_no_specks() {
        // Rounded coordinates: tangents of neighbours differ by a few milliradians, either way.
        let scroll = "M8.5 6.41C10.44 6.54 12.26 7.61 13.13 9.38C13.91 10.97 13.81 12.86 12.75 14.3C11.82 15.56 10.28 \
                      16.25 8.72 15.99C7.39 15.77 6.23 14.86 5.81 13.55C5.46 12.45 5.7 11.22 6.52 10.4C7.19 9.73 8.19 9.43 \
                      9.1 9.72C9.81 9.95 10.39 10.53 10.51 11.28C10.6 11.82 10.43 12.39 9.98 12.72";
        for width in [0.02, 0.3, 1.2] {
            for join in [Join::Round, Join::Miter, Join::Bevel] {
                let style = Stroke::new(width).with_caps(Cap::Round).with_join(join);
                let found = region(scroll, &style);
                assert_eq!((found.components(), found.holes()), (1, 0), "{width} {join:?}");
            }
        }
    }

    #[test]
    fn too_many_vertices_are_refused() {
        let path = BezPath::from_svg("M0 0H9V9H0Z").unwrap();
        assert!(stroked(&path, &Stroke::new(1.0), TOLERANCE, 20).is_none());
    }

    /// How far a point is off a line that is drawn in SVG, whose y points down.
    fn off_line(d: &str, p: glam::DVec2) -> f64 {
        use kurbo::ParamCurveNearest;
        let path = BezPath::from_svg(d).unwrap();
        let at = kurbo::Point::new(p.x, p.y);
        path.segments().map(|s| s.nearest(at, 1e-9).distance_sq.sqrt()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn small_holes_that_a_line_runs_around_stay() {
        // Found at random: its strands leave a hole of three tenths of a micrometre.
        let d = "M29 37C50 19 3 0 0 0C0 0 0 0 19 41C34 38 57 15 41 16C27 57 31 32 30 1C19 19 17 48 30 26";
        let style = Stroke::new(5.826595547990405).with_caps(Cap::Round).with_join(Join::Round);
        let found = region(d, &style);
        let grid = found.grid();
        let small = found.parts()[0].holes().iter().find(|hole| hole.area_mm2(grid).abs() < 1e-7).unwrap();
        let off = off_line(d, grid.to_mm(small.points()[0]));
        assert!((off - 0.5 * 5.826595547990405).abs() < 2.0 * TOLERANCE, "{off}");
    }

    proptest! {
        #[test]
        fn one_line_is_one_component_and_covers_itself(
            points in prop::collection::vec((0i32..60, 0i32..60), 4..19),
            width in 0.01f64..9.0,
            join in prop_oneof![Just(Join::Round), Just(Join::Miter), Just(Join::Bevel)],
            cap in prop_oneof![Just(Cap::Round), Just(Cap::Butt), Just(Cap::Square)],
        ) {
            let mut d = format!("M{} {}", points[0].0, points[0].1);
            for c in points[1..].chunks_exact(3) {
                d.push_str(&format!("C{} {} {} {} {} {}", c[0].0, c[0].1, c[1].0, c[1].1, c[2].0, c[2].1));
            }
            prop_assume!(points.iter().any(|p| *p != points[0]));
            let style = Stroke::new(width).with_caps(cap).with_join(join);
            let found = region(&d, &style);
            prop_assert_eq!(found.components(), 1);
            // Every hole of the union is one that the line runs around, never a crack between polygons: where all is round, half of the
            // width away from the line, however small it is.
            let grid = found.grid();
            let is_round = matches!((join, cap), (Join::Round, Cap::Round));
            for hole in found.parts()[0].holes() {
                let off = off_line(&d, grid.to_mm(hole.points()[0]));
                let is_crack = match is_round {
                    true => off < 0.5 * width - 2.0 * TOLERANCE,
                    false => hole.area_mm2(grid).abs() <= 1e-7,
                };
                prop_assert!(!is_crack, "{} mm2, {off} mm off a line of {width} mm", hole.area_mm2(grid));
            }
        }
    }
}
