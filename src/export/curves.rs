//! Cubic Béziers through a smooth run of vertices, within a tolerance that is proved and not sampled.
//!
//! Schneider's method (Graphics Gems I, 1990): least squares for the lengths of the two handles with the
//! directions given, better parameters by Newton steps, and where that fails a split with a common tangent.
//! The acceptance is stricter than his: over each edge the control points of that part of the cubic lie in
//! the edge's capsule (the points within the tolerance of it). The capsule is convex, so the curve stays
//! inside, and as it runs from one end to the other it also passes every point of the edge that closely:
//! both directions of the Hausdorff distance at once.

use glam::DVec2;

use super::outline::{Cubic, Segment, distance_to_edge};
use super::runs::{Run, THINNING, tangent_between};
use crate::planar::Grid;

/// The part of a tolerance that rounding to decimals may use.
pub(super) const ROUNDING: f64 = 0.02;
/// What thinning and rounding leave to the fit.
pub(super) const FITTING: f64 = 1.0 - THINNING - 2.0 * ROUNDING;
/// Newton rounds. Fewer, and more segments are needed; more, and nothing is gained.
const ROUNDS: usize = 6;
/// A start so many times off the tolerance is not worth Newton steps.
const HOPELESS: f64 = 30.0;
/// A split leaves this part of the turn on either side. Less, and slivers are split off; more, and splits
/// miss the spot where the curve changes.
const CENTRAL: f64 = 0.2;
/// The most that one cubic turns, in radians: beyond it fits are loops.
const MAX_TURN: f64 = 3.3;

/// Rounds coordinates to decimals that suit a tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounding {
    /// The decimals at which grid points stay apart.
    pub(super) exact: i32,
}

impl Rounding {
    /// Vertex `i` of a run as the file has it: one of its `ends`, which its neighbours share, or rounded.
    pub(super) fn vertex(self, run: &Run, i: usize, [from, to]: [DVec2; 2]) -> DVec2 {
        if i == 0 {
            from
        } else if i + 1 == run.points.len() {
            to
        } else {
            self.round(run.points[i], run.tolerances[i - 1].min(run.tolerances[i]))
        }
    }

    /// The rounding of points of a grid.
    pub(super) fn on(grid: Grid) -> Self {
        Self { exact: (-grid.step_mm().log10()).ceil() as i32 }
    }

    /// `p` with the fewest decimals that move it by [`ROUNDING`] of the tolerance at most.
    pub(super) fn round(self, p: DVec2, tolerance: f64) -> DVec2 {
        let decimals = self.decimals(tolerance);
        let scale = 10f64.powi(decimals);
        (p * scale).round() / scale
    }

    /// How many decimals those are.
    pub(super) fn decimals(self, tolerance: f64) -> i32 {
        let wanted = (std::f64::consts::FRAC_1_SQRT_2 / (ROUNDING * tolerance)).log10().ceil();
        if wanted < f64::from(self.exact) { (wanted as i32).max(0) } else { self.exact }
    }
}

/// The segments of an outline that stand for its runs, joined where the runs meet.
pub(super) fn fitted(runs: &[Run], rounding: Rounding) -> (DVec2, Vec<Segment>) {
    let mut segments = Vec::new();
    let joint = |i: usize| joint(runs, i, rounding);
    let start = joint(0);
    for (i, run) in runs.iter().enumerate() {
        if run.straight {
            segments.push(Segment::Line(joint(i + 1)));
        } else {
            let mut fit = Fit {
                run,
                turned: turned(&run.points),
                rounding,
                from: joint(i),
                to: joint(i + 1),
                segments: &mut segments,
            };
            fit.range(0, run.points.len() - 1, run.tangents.0, run.tangents.1);
        }
    }
    (start, segments)
}

/// Where run `i` begins, as the file has it; the one after the last is the first.
pub(super) fn joint(runs: &[Run], i: usize, rounding: Rounding) -> DVec2 {
    let (run, before) = (&runs[i % runs.len()], &runs[(i + runs.len() - 1) % runs.len()]);
    let tolerance = run.tolerances[0].min(before.tolerances[before.tolerances.len() - 1]);
    rounding.round(run.points[0], tolerance)
}

/// The absolute turn over all inner vertices up to each vertex, in radians.
fn turned(points: &[DVec2]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut turned = vec![0.0];
    turned.extend(points.windows(3).map(|w| {
        sum += (w[1] - w[0]).angle_to(w[2] - w[1]).abs();
        sum
    }));
    turned
}

struct Fit<'a> {
    run: &'a Run,
    turned: Vec<f64>,
    rounding: Rounding,
    from: DVec2,
    to: DVec2,
    segments: &'a mut Vec<Segment>,
}

impl Fit<'_> {
    /// Fits vertices `low` to `high` with unit tangents `leaving` and `reaching`.
    fn range(&mut self, low: usize, high: usize, leaving: DVec2, reaching: DVec2) {
        let split = if self.turn(low, high) > MAX_TURN {
            self.turned_by(low, high, 0.5)
        } else {
            match self.cubic(low, high, leaving, reaching) {
                Ok(segment) => return self.segments.push(segment),
                Err(_) if high == low + 1 => return self.segments.push(Segment::Line(self.joint(high))),
                Err(worst) => {
                    worst.clamp(self.turned_by(low, high, CENTRAL), self.turned_by(low, high, 1.0 - CENTRAL))
                }
            }
        };
        let edge = |i: usize| self.run.points[i + 1] - self.run.points[i];
        let (a, b) = (edge(split - 1), edge(split));
        let tangent = tangent_between(a.normalize(), a.length(), b.normalize(), b.length());
        self.range(low, split, leaving, tangent);
        self.range(split, high, tangent, reaching);
    }

    /// The absolute turn over the vertices between `low` and `high`.
    fn turn(&self, low: usize, high: usize) -> f64 {
        self.turned[high - 1] - self.turned[low]
    }

    /// The inner vertex at which `part` of the turn is done.
    fn turned_by(&self, low: usize, high: usize, part: f64) -> usize {
        let wanted = self.turned[low] + part * self.turn(low, high);
        let after = self.turned[low..high].partition_point(|&t| t < wanted);
        (low + after).clamp(low + 1, (high - 1).max(low + 1))
    }

    /// The vertex as the file has it.
    fn joint(&self, i: usize) -> DVec2 {
        self.rounding.vertex(self.run, i, [self.from, self.to])
    }

    /// One cubic, or the inner vertex at which to split.
    fn cubic(&self, low: usize, high: usize, leaving: DVec2, reaching: DVec2) -> Result<Segment, usize> {
        let points = &self.run.points[low..=high];
        let tolerances = &self.run.tolerances[low..high];
        let tightest = tolerances.iter().copied().fold(f64::INFINITY, f64::min);
        if tightest <= 0.0 {
            return Err(self.turned_by(low, high, 0.5));
        }
        let mut parameters = by_length(points);
        let mut worst = 0;
        for round in 0..ROUNDS {
            let handles = handles(points, &parameters, leaving, reaching);
            let (first, last) = (points[0], points[points.len() - 1]);
            let cubic = Cubic([first, first + leaving * handles.0, last - reaching * handles.1, last]);
            let excess;
            (excess, worst) = excess_over(&cubic, points, &parameters, tolerances);
            if excess <= 1.0 {
                let end = self.joint(high);
                let [_, a, b, _] = cubic.0.map(|p| self.rounding.round(p, tightest));
                let straight = handles_lie_on_chord(&cubic, tightest * THINNING);
                return Ok(if straight { Segment::Line(end) } else { Segment::Cubic(a, b, end) });
            }
            if points.len() == 2 || excess > HOPELESS || (round + 3 >= ROUNDS && excess > 3.0) {
                break;
            }
            improve(&cubic, points, &mut parameters);
        }
        Err((low + worst).clamp(low + 1, (high - 1).max(low + 1)))
    }
}

/// The lengths of both handles by least squares; a third of the chord where that says nothing sensible.
fn handles(points: &[DVec2], parameters: &[f64], leaving: DVec2, reaching: DVec2) -> (f64, f64) {
    let (first, last) = (points[0], points[points.len() - 1]);
    let chord = first.distance(last);
    let (mut aa, mut ab, mut bb, mut ax, mut bx) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (&p, &t) in points.iter().zip(parameters) {
        let s = 1.0 - t;
        let (a, b) = (leaving * (3.0 * s * s * t), -reaching * (3.0 * s * t * t));
        let rest = p - first * (s * s * (s + 3.0 * t)) - last * (t * t * (t + 3.0 * s));
        aa += a.dot(a);
        ab += a.dot(b);
        bb += b.dot(b);
        ax += a.dot(rest);
        bx += b.dot(rest);
    }
    let determinant = aa * bb - ab * ab;
    let (x, y) = ((ax * bb - bx * ab) / determinant, (aa * bx - ab * ax) / determinant);
    let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let sensible = 1e-3 * chord..=length;
    if determinant > 1e-12 * aa * bb && sensible.contains(&x) && sensible.contains(&y) {
        (x, y)
    } else {
        (length / 3.0, length / 3.0)
    }
}

/// Parameters in proportion to the length along the polyline.
fn by_length(points: &[DVec2]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut parameters = vec![0.0];
    parameters.extend(points.windows(2).map(|w| {
        sum += w[0].distance(w[1]);
        sum
    }));
    parameters.iter_mut().for_each(|t| *t /= sum);
    parameters
}

/// One Newton step of each inner parameter towards the foot of its vertex on the curve.
fn improve(cubic: &Cubic, points: &[DVec2], parameters: &mut [f64]) {
    let inner = 1..points.len() - 1;
    for (&p, t) in points[inner.clone()].iter().zip(&mut parameters[inner]) {
        let (off, velocity) = (cubic.at(*t) - p, cubic.velocity(*t));
        let slope = velocity.length_squared() + off.dot(cubic.acceleration(*t));
        if slope > 0.0 {
            *t = (*t - off.dot(velocity) / slope).clamp(0.0, 1.0);
        }
    }
}

/// How many times the cubic leaves its tolerance at worst, and after which vertex.
fn excess_over(cubic: &Cubic, points: &[DVec2], parameters: &[f64], tolerances: &[f64]) -> (f64, usize) {
    let mut worst = (0.0, 0);
    let mut consider = |excess: f64, i: usize| {
        if excess > worst.0 {
            worst = (excess, i);
        }
    };
    let mut here = (points[0], cubic.velocity(0.0));
    for (i, &tolerance) in tolerances.iter().enumerate() {
        let radius = tolerance * FITTING;
        let step = parameters[i + 1] - parameters[i];
        if step <= 0.0 {
            return (f64::INFINITY, i);
        }
        let next = (cubic.at(parameters[i + 1]), cubic.velocity(parameters[i + 1]));
        consider(next.0.distance(points[i + 1]) / radius, i + 1);
        for control in [here.0 + here.1 * (step / 3.0), next.0 - next.1 * (step / 3.0)] {
            consider(distance_to_edge(control, points[i], points[i + 1]) / radius, i);
        }
        here = next;
    }
    worst
}

fn handles_lie_on_chord(cubic: &Cubic, slack: f64) -> bool {
    let [first, a, b, last] = cubic.0;
    [a, b].iter().all(|&p| distance_to_edge(p, first, last) <= slack)
}

#[cfg(test)]
mod tests {
    use super::super::runs::Polygon;
    use super::*;

    const ROUND: Rounding = Rounding { exact: 9 };

    fn fit(points: Vec<DVec2>, chord: f64) -> Vec<Segment> {
        let tolerances = vec![chord; points.len()];
        fitted(&Polygon { points, tolerances }.runs(), ROUND).1
    }

    fn circle(radius: f64, n: u32) -> Vec<DVec2> {
        (0..n)
            .map(|i| radius * DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(n)))
            .collect()
    }

    #[test]
    fn a_circle_takes_few_cubics() {
        let segments = fit(circle(30.0, 400), 0.01);
        assert!((4..=8).contains(&segments.len()), "{}", segments.len());
        assert!(segments.iter().all(|s| matches!(s, Segment::Cubic(..))));
    }

    #[test]
    fn joints_of_a_smooth_run_share_a_tangent() {
        let ellipse: Vec<DVec2> =
            circle(1.0, 300).iter().map(|p| DVec2::new(p.x * 20.0, p.y * 7.0)).collect();
        let segments = fit(ellipse, 0.002);
        for (i, segment) in segments.iter().enumerate() {
            let (Segment::Cubic(_, b, end), Segment::Cubic(a, ..)) =
                (*segment, segments[(i + 1) % segments.len()])
            else {
                panic!("an ellipse has no lines")
            };
            assert!((end - b).angle_to(a - end).abs() < 0.01);
        }
    }

    #[test]
    fn no_tolerance_gives_the_polygon_back() {
        let points = circle(5.0, 40);
        let segments = fit(points.clone(), 0.0);
        assert_eq!(segments.len(), 40);
        for segment in segments {
            let Segment::Line(end) = segment else { panic!("exact outlines are polygons") };
            assert!(points.iter().any(|p| p.distance(end) < 1e-9));
        }
    }

    #[test]
    fn decimals_follow_the_tolerance() {
        assert_eq!(ROUND.decimals(0.01), 4);
        assert_eq!(ROUND.decimals(1.0), 2);
        assert_eq!(ROUND.decimals(0.0), 9);
        let p = DVec2::new(1.234_567_89, -0.000_012_3);
        assert!(ROUND.round(p, 0.01).distance(p) <= 0.01 * ROUNDING);
    }
}
