//! Curves as chains of chords, and where they meet: at crossings, ends that lie on another line, and corners.

use std::f64::consts::FRAC_PI_6;

use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

use super::drawing::Curve;
use crate::planar::chords;

/// A curve as a chain of chords; the last point of a closed one is its first again.
#[derive(Debug, Clone)]
pub struct Line {
    /// Vertices in millimetres.
    pub points: Vec<DVec2>,
    /// The length from the beginning to each vertex.
    pub along_mm: Vec<f64>,
    /// Lengths along it where it turns sharply.
    pub corners_mm: Vec<f64>,
    /// Whether it closes on itself.
    pub is_closed: bool,
    /// The width of the pen.
    pub width_mm: f64,
}

/// A turn between chords of different segments from here on is a corner.
const CORNER: f64 = FRAC_PI_6;

impl Line {
    /// The chords of a curve, within `chord_mm`; `None` if it has no length.
    pub fn new(curve: &Curve, chord_mm: f64) -> Option<Self> {
        let subpath = chords(&curve.path, chord_mm).into_iter().next()?;
        let is_closed = subpath.is_closed;
        let mut points = subpath.way();
        points.dedup();
        if points.len() < 2 {
            return None;
        }
        let mut along_mm = vec![0.0];
        for ends in points.windows(2) {
            along_mm.push(along_mm[along_mm.len() - 1] + ends[0].distance(ends[1]));
        }
        let mut line = Self { points, along_mm, corners_mm: Vec::new(), is_closed, width_mm: curve.width_mm };
        line.corners_mm = line.corners();
        Some(line)
    }

    fn corners(&self) -> Vec<f64> {
        let last = self.points.len() - 1;
        let chord = |i: usize| self.points[i + 1] - self.points[i];
        let turns = |a: DVec2, b: DVec2| a.angle_to(b).abs() > CORNER;
        let inner = (1..last).filter(|&i| turns(chord(i - 1), chord(i))).map(|i| self.along_mm[i]);
        let seam = (self.is_closed && turns(chord(last - 1), chord(0))).then_some(0.0);
        seam.into_iter().chain(inner).collect()
    }

    /// The whole length.
    pub fn length_mm(&self) -> f64 {
        self.along_mm[self.along_mm.len() - 1]
    }

    /// The place at a length along it.
    pub fn at(&self, along_mm: f64) -> DVec2 {
        let (i, t) = self.chord_at(along_mm);
        self.points[i].lerp(self.points[i + 1], t)
    }

    /// The chord at a length along it, and how far on it.
    fn chord_at(&self, along_mm: f64) -> (usize, f64) {
        let length_mm = self.length_mm();
        let along_mm = match self.is_closed {
            true => along_mm.rem_euclid(length_mm),
            false => along_mm.clamp(0.0, length_mm),
        };
        let i = self.along_mm.partition_point(|&a| a <= along_mm).clamp(1, self.points.len() - 1) - 1;
        (i, ((along_mm - self.along_mm[i]) / (self.along_mm[i + 1] - self.along_mm[i])).clamp(0.0, 1.0))
    }

    /// Points between two lengths along it, `count` chords; on a closed line beyond its end too.
    pub fn between(&self, from_mm: f64, to_mm: f64, count: usize) -> Vec<DVec2> {
        (0..=count).map(|i| self.at(from_mm + (to_mm - from_mm) * i as f64 / count as f64)).collect()
    }
}

/// Two places that are one: line and length along it.
pub type Meeting = [(usize, f64); 2];

struct Chord {
    line: usize,
    chord: usize,
    low: DVec2,
    high: DVec2,
}

impl RTreeObject for Chord {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

/// Where lines cross one another or themselves, and where their ends lie within `reach` of another line, which a function of both
/// gives: half of a pen, as ink meets there. In an order that depends on the lines only.
pub fn meetings(lines: &[Line], reach: impl Fn(&Line, &Line) -> f64) -> Vec<Meeting> {
    let chords = lines.iter().enumerate().flat_map(|(line, l)| {
        l.points.windows(2).enumerate().map(move |(chord, ends)| Chord {
            line,
            chord,
            low: ends[0].min(ends[1]),
            high: ends[0].max(ends[1]),
        })
    });
    let tree = RTree::bulk_load(chords.collect());
    let mut meetings: Vec<Meeting> = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let last = line.points.len() - 2;
        for i in 0..=last {
            let (a, b) = (line.points[i], line.points[i + 1]);
            let around = AABB::from_corners(a.min(b).to_array(), a.max(b).to_array());
            for other in tree.locate_in_envelope_intersecting(around) {
                // Each pair once; chords that follow one another share a vertex.
                let is_next = other.line == number
                    && (other.chord <= i + 1 || (line.is_closed && i == 0 && other.chord == last));
                if other.line < number || is_next {
                    continue;
                }
                let (c, d) =
                    (lines[other.line].points[other.chord], lines[other.line].points[other.chord + 1]);
                if let Some([t, s]) = crossing(a, b, c, d) {
                    let along =
                        |l: &Line, i: usize, t: f64| l.along_mm[i] + t * (l.along_mm[i + 1] - l.along_mm[i]);
                    meetings.push([
                        (number, along(line, i, t)),
                        (other.line, along(&lines[other.line], other.chord, s)),
                    ]);
                }
            }
        }
        if line.is_closed {
            continue;
        }
        let widest = lines.iter().map(|other| reach(line, other)).fold(0.0, f64::max);
        for (end_mm, p) in [(0.0, line.points[0]), (line.length_mm(), line.points[line.points.len() - 1])] {
            let around = AABB::from_corners((p - widest).to_array(), (p + widest).to_array());
            let mut near: Vec<(usize, f64, f64)> = Vec::new();
            for other in tree.locate_in_envelope_intersecting(around) {
                let on = &lines[other.line];
                let (c, d) = (on.points[other.chord], on.points[other.chord + 1]);
                let t = ((p - c).dot(d - c) / (d - c).length_squared()).clamp(0.0, 1.0);
                let away = c.lerp(d, t).distance(p);
                let along = on.along_mm[other.chord] + t * c.distance(d);
                // Its own end is no meeting; what is far along it is.
                let is_own = other.line == number && (along - end_mm).abs() < 4.0 * reach(line, line);
                if away <= reach(line, on) && !is_own {
                    near.push((other.line, away, along));
                }
            }
            near.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)));
            near.dedup_by_key(|near| near.0);
            meetings.extend(near.into_iter().map(|(other, _, along)| [(number, end_mm), (other, along)]));
        }
    }
    meetings.sort_by(|a, b| {
        let key = |m: &Meeting| (m[0].0, m[1].0);
        key(a).cmp(&key(b)).then(a[0].1.total_cmp(&b[0].1)).then(a[1].1.total_cmp(&b[1].1))
    });
    meetings
}

/// How far on ab and on cd they cross; `None` if they do not, or run side by side.
pub fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<[f64; 2]> {
    let (r, s) = (b - a, d - c);
    let turn = r.perp_dot(s);
    if turn == 0.0 {
        return None;
    }
    let (t, u) = ((c - a).perp_dot(s) / turn, (c - a).perp_dot(r) / turn);
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some([t, u])
}
