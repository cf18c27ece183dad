//! Circular arcs through a smooth run of vertices, within a tolerance that is proved and not sampled.
//!
//! From each vertex on, the farthest other is sought that one arc, or two with a common tangent (a biarc, Bolton
//! 1975), reach with the run's tangents at both ends. Acceptance is that of the cubics: over each edge, the part of
//! the arc that belongs to it lies in the edge's capsule, the points within the tolerance of it. The farthest point
//! of an arc from an edge is an end of the part, or where the arc runs along the edge, or where its radius points away from an
//! end of the edge; these few points prove it for all. The parts go on from vertex to vertex, so the arcs pass every point of the run
//! that closely too. What is checked is what stands in the file, rounded.

use glam::DVec2;

use super::curves::{FITTING, ROUNDING, Rounding, joint};
use super::outline::{Arc, Segment, distance_to_edge};
use super::runs::{Run, THINNING, tangent_between};

/// Arcs turn by less than 150 degrees: near half a turn, the radius no longer says well where an arc runs.
const MAX_BULGE: f64 = 0.767;
/// A single arc may leave the tangents of its ends by this (radians). More, and kinks show; less, and arcs of one
/// circle are cut in two.
const KINK: f64 = 0.01;

/// The segments of an outline that stand for its runs, joined where the runs meet.
pub(super) fn arcs(runs: &[Run], rounding: Rounding) -> (DVec2, Vec<Segment>) {
    let mut segments = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        let (from, to) = (joint(runs, i, rounding), joint(runs, i + 1, rounding));
        if run.straight {
            segments.push(Segment::Line(to));
        } else {
            Fit { run, rounding, from, to }.all(&mut segments);
        }
    }
    let start = joint(runs, 0, rounding);
    if !segments.iter().any(|segment| matches!(segment, Segment::Line(_))) {
        close_by_line(start, &mut segments, runs[runs.len() - 1].tolerances.last().copied(), rounding);
    }
    (start, segments)
}

/// Makes the end of the last arc a line that hardly differs from it. Readers compute where an arc ends and miss the start
/// of the contour by a rounding error; a line ends where it says.
fn close_by_line(start: DVec2, segments: &mut Vec<Segment>, tolerance: Option<f64>, rounding: Rounding) {
    let before = segments.len().checked_sub(2).map_or(start, |i| segments[i].end());
    let (Some(Segment::Arc(to, bulge)), Some(tolerance)) = (segments.last().copied(), tolerance) else {
        return;
    };
    let arc = Arc { from: before, to, bulge };
    let length = (8.0 * arc.radius() * THINNING * tolerance).sqrt();
    // Of an arc so flat that most of it would do for a line, half stays an arc.
    let t = (1.0 - length / (arc.radius() * arc.turn().abs())).max(0.5);
    let middle = rounding.round(arc.at(t), tolerance);
    if let Some(shorter) = rounded_arc(before, middle, (0.25 * t * arc.turn()).tan(), tolerance) {
        segments.pop();
        // What is left may be so flat that no digit of its bulge matters, and an arc without one has no radius.
        segments.push(match shorter.bulge {
            0.0 => Segment::Line(middle),
            bulge => Segment::Arc(middle, bulge),
        });
        segments.push(Segment::Line(to));
    }
}

/// The arc with as few digits of its bulge as matter; `None` when it turns too far.
fn rounded_arc(from: DVec2, to: DVec2, bulge: f64, tolerance: f64) -> Option<Arc> {
    let length = from.distance(to);
    if length == 0.0 || bulge.abs() > MAX_BULGE {
        return None;
    }
    // Half a unit of the last digit moves the top of the arc by a quarter of it for each unit of length.
    let decimals = (length / (4.0 * ROUNDING * tolerance)).log10().ceil().clamp(0.0, 12.0);
    let scale = 10f64.powi(decimals as i32);
    Some(Arc { from, to, bulge: (bulge * scale).round() / scale })
}

struct Fit<'a> {
    run: &'a Run,
    rounding: Rounding,
    from: DVec2,
    to: DVec2,
}

impl Fit<'_> {
    fn all(&self, segments: &mut Vec<Segment>) {
        let last = self.run.points.len() - 1;
        let mut low = 0;
        while low < last {
            // Doubling, then halving: nearly always the farthest that will do.
            let (mut reached, mut beyond) = (low + 1, last + 1);
            let mut best =
                self.attempt(low, reached).unwrap_or_else(|| vec![Segment::Line(self.joint(reached))]);
            let mut step = 1;
            while reached + 1 < beyond {
                let high = (reached + step).min(reached + (beyond - reached) / 2).max(reached + 1);
                match self.attempt(low, high) {
                    Some(found) => {
                        (best, reached) = (found, high);
                        step *= 2;
                    }
                    None => beyond = high,
                }
            }
            segments.append(&mut best);
            low = reached;
        }
    }

    /// The vertex as the file has it.
    fn joint(&self, i: usize) -> DVec2 {
        self.rounding.vertex(self.run, i, [self.from, self.to])
    }

    /// The unit tangent of the run at a vertex.
    fn tangent(&self, i: usize) -> DVec2 {
        let points = &self.run.points;
        if i == 0 {
            return self.run.tangents.0;
        } else if i + 1 == points.len() {
            return self.run.tangents.1;
        }
        let (a, b) = (points[i] - points[i - 1], points[i + 1] - points[i]);
        tangent_between(a.normalize(), a.length(), b.normalize(), b.length())
    }

    /// One or two segments from vertex `low` to `high`, if they stay within the tolerances.
    fn attempt(&self, low: usize, high: usize) -> Option<Vec<Segment>> {
        let tightest = self.run.tolerances[low..high].iter().copied().fold(f64::INFINITY, f64::min);
        if tightest <= 0.0 {
            return None;
        }
        let (from, to) = (self.joint(low), self.joint(high));
        let (leaving, reaching) = (self.tangent(low), self.tangent(high));
        let chord = to - from;
        let (first, last) = (leaving.angle_to(chord), chord.angle_to(reaching));
        let single = ((first - last).abs() <= KINK)
            .then(|| rounded_arc(from, to, (0.25 * (first + last)).tan(), tightest))
            .and_then(|arc| self.accepted(vec![arc?], low, high, tightest));
        single.or_else(|| {
            let middle = biarc_joint(from, leaving, to, reaching)?;
            let middle = self.rounding.round(middle, tightest);
            // Each arc keeps the tangent of its own end; in the middle they agree, but for rounding.
            let one = rounded_arc(from, middle, (0.5 * leaving.angle_to(middle - from)).tan(), tightest)?;
            let two = rounded_arc(middle, to, (0.5 * (to - middle).angle_to(reaching)).tan(), tightest)?;
            self.accepted(vec![one, two], low, high, tightest)
        })
    }

    /// The arcs as segments, if over the vertices from `low` to `high` they stay within the tolerances.
    fn accepted(&self, arcs: Vec<Arc>, low: usize, high: usize, tightest: f64) -> Option<Vec<Segment>> {
        let path = Path { arcs: &arcs };
        let vertices = &self.run.points[low..=high];
        let mut here = 0.0;
        for (i, edge) in vertices.windows(2).enumerate() {
            let next = if low + i + 1 == high { arcs.len() as f64 } else { path.nearest(edge[1]) };
            let radius = self.run.tolerances[low + i] * FITTING;
            let apart = path.at(next).distance(edge[1]).max(path.at(here).distance(edge[0]));
            if next < here || apart > radius || path.farthest(here, next, edge) > radius {
                return None;
            }
            here = next;
        }
        let segment = |arc: &Arc| match arc.rise() <= tightest * THINNING {
            true => Segment::Line(arc.to),
            false => Segment::Arc(arc.to, arc.bulge),
        };
        Some(arcs.iter().map(segment).collect())
    }
}

/// Where the two arcs of a biarc with handles of equal length meet.
fn biarc_joint(from: DVec2, leaving: DVec2, to: DVec2, reaching: DVec2) -> Option<DVec2> {
    let across = to - from;
    let along = across.dot(leaving + reaching);
    let squared = across.length_squared();
    let root = (along * along + 2.0 * (1.0 - leaving.dot(reaching)) * squared).max(0.0).sqrt();
    let handle = squared / (along + root);
    let joint = 0.5 * (from + leaving * handle + to - reaching * handle);
    (handle > 0.0 && joint.is_finite()).then_some(joint)
}

/// Arcs one after another; the parameter i + t is at t on arc i. Bulges may be zero: then an arc is a line.
struct Path<'a> {
    arcs: &'a [Arc],
}

impl Path<'_> {
    fn split(&self, s: f64) -> (usize, f64) {
        let i = (s as usize).min(self.arcs.len() - 1);
        (i, s - i as f64)
    }

    fn at(&self, s: f64) -> DVec2 {
        let (i, t) = self.split(s);
        point(&self.arcs[i], t)
    }

    /// The parameter of the point nearest to `p`, which is not far off.
    fn nearest(&self, p: DVec2) -> f64 {
        let along = |arc: &Arc| {
            if arc.bulge == 0.0 {
                let chord = arc.to - arc.from;
                return ((p - arc.from).dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
            }
            let centre = arc.centre();
            ((arc.from - centre).angle_to(p - centre) / arc.turn()).clamp(0.0, 1.0)
        };
        let distance = |(i, arc): (usize, &Arc)| {
            let t = along(arc);
            (point(arc, t).distance_squared(p), i as f64 + t)
        };
        let candidates = self.arcs.iter().enumerate().map(distance);
        candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, s)| s)
    }

    /// The greatest distance of the part between two parameters from an edge.
    fn farthest(&self, from: f64, to: f64, edge: &[DVec2]) -> f64 {
        let off = |p: DVec2| distance_to_edge(p, edge[0], edge[1]);
        let normal = (edge[1] - edge[0]).perp();
        let ((first, t), (last, u)) = (self.split(from), self.split(to));
        let mut farthest = off(self.at(from)).max(off(self.at(to)));
        for i in first..=last {
            let arc = &self.arcs[i];
            let (t, u) = (if i == first { t } else { 0.0 }, if i == last { u } else { 1.0 });
            farthest = farthest.max(off(point(arc, t))).max(off(point(arc, u)));
            if arc.bulge != 0.0 {
                let centre = arc.centre();
                let radius = arc.from - centre;
                for side in [normal, -normal, centre - edge[0], centre - edge[1]] {
                    let s = radius.angle_to(side) / arc.turn();
                    if (t..=u).contains(&s) {
                        farthest = farthest.max(off(point(arc, s)));
                    }
                }
            }
        }
        farthest
    }
}

fn point(arc: &Arc, t: f64) -> DVec2 {
    match t {
        0.0 => arc.from,
        1.0 => arc.to,
        _ if arc.bulge == 0.0 => arc.from.lerp(arc.to, t),
        _ => arc.at(t),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::outline::Outline;
    use super::super::runs::Polygon;
    use super::*;

    const CHORD: f64 = 0.01;

    fn fit(points: Vec<DVec2>, chord: f64) -> Outline {
        let tolerances = vec![chord; points.len()];
        let (start, segments) = arcs(&Polygon { points, tolerances }.runs(), Rounding { exact: 9 });
        Outline { start, segments }
    }

    fn circle(radius: f64, n: u32) -> Vec<DVec2> {
        (0..n)
            .map(|i| radius * DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(n)))
            .collect()
    }

    /// Points of the outline, close together.
    fn samples(outline: &Outline) -> Vec<DVec2> {
        let each = outline.joints().zip(&outline.segments).flat_map(|(from, segment)| {
            (0..200).map(move |k| {
                let t = f64::from(k) / 200.0;
                match *segment {
                    Segment::Line(to) => from.lerp(to, t),
                    Segment::Arc(to, bulge) => Arc { from, to, bulge }.at(t),
                    Segment::Cubic(..) => panic!("there are no cubics among arcs"),
                }
            })
        });
        each.collect()
    }

    fn off(p: DVec2, polygon: &[DVec2]) -> f64 {
        let n = polygon.len();
        (0..n).map(|i| distance_to_edge(p, polygon[i], polygon[(i + 1) % n])).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_circle_is_a_few_arcs_of_its_radius() {
        let outline = fit(circle(30.0, 400), CHORD);
        assert!((4..=7).contains(&outline.segments.len()), "{:?}", outline.segments);
        let n = outline.segments.len();
        assert!(matches!(outline.segments[n - 1], Segment::Line(_)), "the start is met exactly");
        for (from, segment) in outline.joints().zip(&outline.segments[..n - 1]) {
            let Segment::Arc(to, bulge) = *segment else { panic!("{segment:?}") };
            assert!((Arc { from, to, bulge }.radius() - 30.0).abs() < 0.05);
        }
    }

    #[test]
    fn contours_of_flat_arcs_end_in_a_line_too() {
        // A cushion of 1.3 mm: each side rises by so much less than the chord error that half of it could be a line.
        let (side, bulge) = (1.3, 0.03);
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(DVec2::from);
        let arcs = (0..4).map(|i| Arc { from: corners[i], to: corners[(i + 1) % 4], bulge });
        let outline =
            fit(arcs.flat_map(|arc| (0..8).map(move |k| arc.at(f64::from(k) / 8.0))).collect(), 0.05);
        let is_arc = |segment: &Segment| matches!(segment, Segment::Arc(..));
        assert_eq!(outline.segments.iter().filter(|s| is_arc(s)).count(), 4, "{:?}", outline.segments);
        let last = outline.segments[outline.segments.len() - 1];
        assert_eq!(last, Segment::Line(outline.start), "readers miss the end of an arc by a rounding error");
    }

    #[test]
    fn arcs_of_a_smooth_run_meet_without_kinks() {
        let ellipse: Vec<DVec2> =
            circle(1.0, 600).iter().map(|p| DVec2::new(p.x * 20.0, p.y * 7.0)).collect();
        let outline = fit(ellipse, CHORD);
        assert!(outline.segments.len() < 40, "{} segments", outline.segments.len());
        let ends: Vec<[DVec2; 2]> = (outline.joints().zip(&outline.segments))
            .map(|(from, segment)| match *segment {
                Segment::Arc(to, bulge) => {
                    let arc = Arc { from, to, bulge };
                    [arc.velocity(0.0), arc.velocity(1.0)]
                }
                Segment::Line(to) if to == outline.start => [to - from; 2],
                _ => panic!("an ellipse has no lines but the one that closes it"),
            })
            .collect();
        for i in 0..ends.len() {
            let kink = ends[i][1].angle_to(ends[(i + 1) % ends.len()][0]).abs();
            assert!(kink < 3.0 * KINK, "{kink}");
        }
    }

    #[test]
    fn an_arc_that_bulges_past_the_end_of_an_edge_is_measured_there() {
        // Its ends are level with the end of the edge, one radius below the centre, and within the tolerance; its top is not.
        let (tolerance, turn) = (1.0f64, 149.8f64.to_radians());
        let radius = 0.62 * tolerance;
        let at = |angle: f64| radius * DVec2::from_angle(angle);
        let arc = Arc { from: at(-0.5 * turn), to: at(0.5 * turn), bulge: (0.25 * turn).tan() };
        assert!(arc.centre().length() < 1e-9);
        let edge = [DVec2::new(-5.0, 0.2), DVec2::new(-radius, 0.0)];
        let path = Path { arcs: &[arc] };
        let sampled = (0..=1000).map(|k| arc.at(f64::from(k) / 1000.0));
        let sampled = sampled.map(|p| distance_to_edge(p, edge[0], edge[1])).fold(0.0, f64::max);
        let found = path.farthest(0.0, 1.0, &edge);
        assert!(sampled > 1.2 * tolerance && distance_to_edge(arc.from, edge[0], edge[1]) < tolerance);
        assert!(found > sampled - 1e-9 && found < sampled + 1e-3, "{found} is not {sampled}");
    }

    #[test]
    fn no_tolerance_gives_the_polygon_back() {
        let outline = fit(circle(5.0, 40), 0.0);
        assert_eq!(outline.segments.len(), 40);
        assert!(outline.segments.iter().all(|s| matches!(s, Segment::Line(_))));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn arcs_stay_within_the_chord_both_ways(
            waves in proptest::collection::vec((2u32..9, -0.2..0.2f64, 0.0..6.3f64), 0..4),
            radius in 0.5..40.0f64,
            chord in 0.002..0.05f64,
            n in 20u32..600,
        ) {
            let at = |i: u32| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                let rise: f64 = waves.iter().map(|&(k, a, phase)| a * (f64::from(k) * angle + phase).cos()).sum();
                DVec2::from_angle(angle) * radius * (1.0 + rise)
            };
            let polygon: Vec<DVec2> = (0..n).map(at).collect();
            let found = samples(&fit(polygon.clone(), chord));
            let worst = found.iter().map(|&p| off(p, &polygon)).fold(0.0, f64::max);
            prop_assert!(worst <= chord, "the arcs leave the polygon by {worst}");
            let points = polygon.iter().enumerate()
                .flat_map(|(i, p)| [*p, p.lerp(polygon[(i + 1) % polygon.len()], 0.5)]);
            let worst = points.map(|p| off(p, &found)).fold(0.0, f64::max);
            prop_assert!(worst <= chord, "the polygon leaves the arcs by {worst}");
        }
    }
}
