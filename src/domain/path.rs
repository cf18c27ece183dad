//! Bézier paths to chains of arcs.
//!
//! A cubic is halved until the biarc with its end points and end tangents stays within [`TOLERANCE_MM`] of it.
//! The result interpolates points and tangents, so it is smooth where the path is, and arc length, frames
//! and curvature need no tables. A cusp inside a segment shows as pieces too short to draw that still turn:
//! they are dropped, which leaves an ordinary corner.
//!
//! Rejected: inverting the arc length of the Béziers themselves by a table and Newton steps. It fails where
//! a control point sits on its end point, as the speed is zero there, and drawings are full of that.

use glam::DVec2;
use kurbo::{BezPath, CubicBez, ParamCurve, ParamCurveArea, PathEl, PathSeg, Point};

use super::arc::{Arc, biarc, turn_between};
use super::chain::Chain;
use super::error::DomainError;
use crate::planar::{Grid, GridError};

/// How far the arcs may lie from the path. Larger, and headings between nodes are off enough to show at the
/// rim of a wide band; smaller, and the number of arcs grows with the inverse cube root.
const TOLERANCE_MM: f64 = 1e-6;
/// Ends closer than this meet, and segments shorter than this are dropped: files round their coordinates to
/// a few decimals, and the short pieces that this leaves point anywhere.
const WELD_MM: f64 = 2e-3;
/// Lines that follow a line and are shorter than this are dropped likewise: where so short lines stand for a
/// curve, the rounding of their ends decides where they point. Larger, and a curve of 3 mm radius gets corners.
const LINE_WELD_MM: f64 = 0.05;
/// Pieces shorter than this are not halved again. A bend that still turns at this size is a corner.
const SHORTEST_MM: f64 = 1e-4;
/// The greatest angle between a piece's chord and its end tangents, so that halving sees every wiggle.
const MAX_HALF_TURN: f64 = 0.3;
/// The shortest curve that makes sense.
pub(super) const MIN_LENGTH_MM: f64 = 0.1;

/// The chain of arcs along `path`, corners and all; closed curves run clockwise.
pub(super) fn chain_of(path: &BezPath) -> Result<Chain, DomainError> {
    check_coordinates(path)?;
    match path.subpaths().filter(|s| s.len() > 1).count() {
        0 => return Err(DomainError::Empty),
        1 => {}
        count => return Err(DomainError::Subpaths { count }),
    }
    let mut segments = welded(path);
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
        return Err(DomainError::TooShort { length_mm: 0.0, minimum_mm: MIN_LENGTH_MM });
    };
    let start = first.p0;
    let closed = last.p3.distance(start) <= WELD_MM;
    if closed {
        let last = segments.last_mut().expect("checked above");
        *last = ending_at(last, start);
        let area: f64 = segments.iter().map(ParamCurveArea::signed_area).sum();
        if area > 0.0 {
            segments.reverse();
            for s in &mut segments {
                *s = CubicBez::new(s.p3, s.p2, s.p1, s.p0);
            }
        }
    }
    let mut nodes = Vec::new();
    for segment in &segments {
        push_nodes(segment, &mut nodes);
    }
    let chain = Chain::new(nodes.windows(2).flat_map(|w| w[0].arcs_to(&w[1])), closed);
    if chain.length() < MIN_LENGTH_MM {
        return Err(DomainError::TooShort { length_mm: chain.length(), minimum_mm: MIN_LENGTH_MM });
    }
    Ok(chain)
}

fn check_coordinates(path: &BezPath) -> Result<(), GridError> {
    let check = |p: Point| {
        let extent_mm = p.x.abs().max(p.y.abs());
        if !p.is_finite() {
            Err(GridError::NotFinite { x: p.x, y: p.y })
        } else if extent_mm > Grid::MAX_EXTENT_MM {
            Err(GridError::Extent { extent_mm })
        } else {
            Ok(())
        }
    };
    path.elements().iter().try_for_each(|element| match *element {
        PathEl::MoveTo(p) | PathEl::LineTo(p) => check(p),
        PathEl::QuadTo(p, q) => check(p).and_then(|()| check(q)),
        PathEl::CurveTo(p, q, r) => check(p).and_then(|()| check(q)).and_then(|()| check(r)),
        PathEl::ClosePath => Ok(()),
    })
}

/// The segments as cubics, without those that are too short to have a direction; what follows a dropped one
/// starts where it started. A last one that is dropped takes the end of the one before with it.
fn welded(path: &BezPath) -> Vec<CubicBez> {
    let mut segments: Vec<CubicBez> = Vec::new();
    let mut end = None;
    let mut dropped_to = None;
    let mut after_line = false;
    for segment in path.segments() {
        let drawn = segment.to_cubic();
        let start = *end.get_or_insert(drawn.p0);
        let is_line = matches!(segment, PathSeg::Line(_));
        let cubic = if is_line {
            line(start, drawn.p3)
        } else {
            CubicBez::new(start, drawn.p1 + (start - drawn.p0), drawn.p2, drawn.p3)
        };
        let shortest = if is_line && after_line { LINE_WELD_MM } else { WELD_MM };
        after_line = is_line;
        if polygon_length(&cubic) < shortest {
            dropped_to = Some(cubic.p3);
        } else {
            end = Some(cubic.p3);
            segments.push(cubic);
            dropped_to = None;
        }
    }
    if let (Some(end), Some(last)) = (dropped_to, segments.last_mut()) {
        *last = ending_at(last, end);
    }
    segments
}

/// `c` sheared so that it ends at `end`; a line stays straight.
fn ending_at(c: &CubicBez, end: Point) -> CubicBez {
    let shift = end - c.p3;
    CubicBez::new(c.p0, c.p1 + shift / 3.0, c.p2 + shift * (2.0 / 3.0), end)
}

fn line(from: Point, to: Point) -> CubicBez {
    CubicBez::new(from, from.lerp(to, 1.0 / 3.0), from.lerp(to, 2.0 / 3.0), to)
}

fn polygon_length(c: &CubicBez) -> f64 {
    c.p0.distance(c.p1) + c.p1.distance(c.p2) + c.p2.distance(c.p3)
}

/// A point of the path with the directions in which it is reached and left.
struct Node {
    point: DVec2,
    arriving: DVec2,
    leaving: DVec2,
}

impl Node {
    fn arcs_to(&self, next: &Self) -> [Arc; 2] {
        biarc(self.point, self.leaving, next.point, next.arriving)
    }
}

/// Appends the nodes along `segment`, the first one only when there is none yet.
fn push_nodes(segment: &CubicBez, nodes: &mut Vec<Node>) {
    let Some((leaving, _)) = end_directions(segment) else { return };
    match nodes.last_mut() {
        Some(last) => last.leaving = leaving,
        None => nodes.push(Node { point: vector(segment.p0), arriving: leaving, leaving }),
    }
    let mut stack = vec![*segment];
    while let Some(piece) = stack.pop() {
        let Some((leaving, arriving)) = end_directions(&piece) else { continue };
        if polygon_length(&piece) < SHORTEST_MM {
            // Where it is smooth the direction has hardly changed; where not, this leaves a corner.
            skip_to(vector(piece.p3), arriving, nodes);
        } else if is_a_biarc(&piece, leaving, arriving) {
            // Halving may fall on a cusp exactly, and then the direction changes between two pieces.
            nodes.last_mut().expect("the first node is there").leaving = leaving;
            nodes.push(Node { point: vector(piece.p3), arriving, leaving: arriving });
        } else {
            let (near, far) = piece.subdivide();
            stack.extend([far, near]);
        }
    }
}

/// Moves the end of the chain to `point` without an arc; the first node stays where the path begins.
fn skip_to(point: DVec2, leaving: DVec2, nodes: &mut [Node]) {
    let is_first = nodes.len() == 1;
    if let Some(last) = nodes.last_mut() {
        last.leaving = leaving;
        if is_first {
            last.arriving = leaving;
        } else {
            last.point = point;
        }
    }
}

fn is_a_biarc(piece: &CubicBez, leaving: DVec2, arriving: DVec2) -> bool {
    let (p0, p1) = (vector(piece.p0), vector(piece.p3));
    let chord = p1 - p0;
    // A piece that goes back and forth on its chord would pass for a line.
    let forth = |from: Point, to: Point| (vector(to) - vector(from)).dot(chord) >= 0.0;
    let monotone = forth(piece.p0, piece.p1) && forth(piece.p1, piece.p2) && forth(piece.p2, piece.p3);
    if chord == DVec2::ZERO || !monotone {
        return false;
    }
    let off = |direction| turn_between(direction, chord).abs() > MAX_HALF_TURN;
    if off(leaving) || off(arriving) {
        return false;
    }
    let [first, second] = biarc(p0, leaving, p1, arriving);
    (1..8).map(|i| vector(piece.eval(f64::from(i) / 8.0))).all(|p| {
        let arc = if (p - second.start).dot(second.direction) < 0.0 { &first } else { &second };
        arc.distance(p).abs() <= TOLERANCE_MM
    })
}

/// The unit directions at both ends; where a control point sits on the end, that towards the next one.
/// `None` when all points are one.
fn end_directions(c: &CubicBez) -> Option<(DVec2, DVec2)> {
    let [p0, p1, p2, p3] = [c.p0, c.p1, c.p2, c.p3].map(vector);
    // A control point nearer than rounding of the coordinates points anywhere.
    let noise = 1e-12 * p0.abs().max_element().max(1.0);
    let towards = |steps: [DVec2; 3]| steps.into_iter().find(|d| d.length() > noise).map(DVec2::normalize);
    Some((towards([p1 - p0, p2 - p0, p3 - p0])?, towards([p3 - p2, p3 - p1, p3 - p0])?))
}

fn vector(p: Point) -> DVec2 {
    DVec2::new(p.x, p.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::sample_curves;
    use kurbo::{ParamCurveArclen, Shape};
    use proptest::prelude::*;

    fn chain(svg: &str) -> Result<Chain, DomainError> {
        chain_of(&BezPath::from_svg(svg).unwrap())
    }

    #[test]
    fn lengths_of_known_curves() {
        let circle = chain("M10 0 A10 10 0 0 1 -10 0 A10 10 0 0 1 10 0 Z").unwrap();
        assert!(circle.is_closed());
        // The error is that of the cubics for which kurbo takes the arcs.
        assert!((circle.length() - std::f64::consts::TAU * 10.0).abs() < 0.01);
        let parabola = kurbo::QuadBez::new((0.0, 0.0), (10.0, 20.0), (20.0, 0.0));
        let found = chain("M0 0 Q10 20 20 0").unwrap();
        assert!(!found.is_closed());
        assert!((found.length() - parabola.arclen(1e-9)).abs() < 1e-6);
        assert_eq!(chain("M0 0 L3 4").unwrap().located_arcs().count(), 2);
    }

    #[test]
    fn closed_curves_run_clockwise() {
        for svg in ["M0 0 H20 V20 H0 Z", "M0 0 V20 H20 V0 Z", "M0 0 H20 V20 H0 V0.001"] {
            let square = chain(svg).unwrap();
            assert!(square.is_closed());
            assert!((square.point(0.0) - DVec2::ZERO).length() < 0.002, "{svg}");
            assert!((square.point(20.0) - DVec2::new(0.0, 20.0)).length() < 0.002, "{svg}");
        }
    }

    #[test]
    fn short_segments_leave_no_corner() {
        // Zero-length segments, rounding dust that points backwards, and a closing line of 0.001 mm.
        let svg = "M0 0 L0 0 L0 10 L0 9.999 L0 20 C0 20 0 20 0 20 L20 20 L20 0 L0.001 0 Z";
        assert_eq!(chain(svg).unwrap().joints(0.01).len(), 4);
    }

    #[test]
    fn a_cusp_inside_a_segment_is_a_corner() {
        let cusp = CubicBez::new((0.0, 0.0), (10.0, 10.0), (0.0, 10.0), (10.0, 0.0));
        let there_and_back = CubicBez::new((0.0, 0.0), (30.0, 0.0), (-20.0, 0.0), (10.0, 0.0));
        // Halving falls on the cusp of the first one and beside those of the others.
        for (cubic, cusps) in [(cusp, 1), (cusp.subsegment(0.0..0.7), 1), (there_and_back, 2)] {
            let chain = chain_of(&BezPath::from_path_segments([PathSeg::Cubic(cubic)].into_iter())).unwrap();
            let joints = chain.joints(0.1);
            assert_eq!(joints.len(), cusps, "{joints:?}");
            assert!(joints.iter().all(|j| j.turn.abs() > 3.0), "{joints:?}");
            assert!((chain.length() - cubic.arclen(1e-9)).abs() < 1e-3);
        }
    }

    #[test]
    fn lines_too_short_to_point_anywhere_still_make_a_curve() {
        let n = 200_000;
        let points = (0..n).map(|i| f64::from(i) / f64::from(n) * std::f64::consts::TAU);
        let mut path = BezPath::new();
        for (i, a) in points.enumerate() {
            // Five decimals, as in a file.
            let p = ((30e5 * a.cos()).round() / 1e5, (30e5 * a.sin()).round() / 1e5);
            if i == 0 { path.move_to(p) } else { path.line_to(p) }
        }
        path.close_path();
        let chain = chain_of(&path).unwrap();
        assert!(chain.is_closed());
        assert!((chain.length() - 60.0 * std::f64::consts::PI).abs() < 1e-3);
        assert_eq!(chain.joints(0.01), []);
    }

    #[test]
    fn refusals() {
        let message = |svg| chain(svg).unwrap_err().to_string();
        assert!(message("M0 0").contains("draws nothing"));
        assert!(message("M0 0 H9 M0 5 H9").contains("2 subpaths"));
        assert!(message("M0 0 L0 0").contains("0 mm long; a band needs at least 0.1 mm"));
        assert!(message("M0 0 L1e30 0").contains("check the units"));
        let mut path = BezPath::new();
        path.move_to((0.0, 0.0));
        path.line_to((f64::NAN, 0.0));
        assert!(chain_of(&path).unwrap_err().to_string().contains("not a finite number"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_chain_follows_the_path(path in sample_curves::open_path()) {
            let chain = chain_of(&path).unwrap();
            prop_assert_eq!(chain.joints(1e-6), vec![]);
            prop_assert!((chain.length() - path.perimeter(1e-9)).abs() < 1e-5);
            let mut along = 0.0;
            for segment in path.segments() {
                for i in 0..=9 {
                    let t = f64::from(i) / 9.0;
                    let part = segment.subsegment(0.0..t).arclen(1e-9);
                    let p = chain.point((along + part).min(chain.length() - 1e-12));
                    prop_assert!(p.distance(vector(segment.eval(t))) < 1e-5);
                }
                along += segment.arclen(1e-9);
            }
        }
    }
}
