//! Lines and arcs of cut paths, and whether two of them make the same cut.

use std::f64::consts::TAU;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Lines no farther apart make one cut. Less, and the rounding of a file hides a double; more, and the sides of a sharp
/// tip are taken for one.
const SAME_MM: f64 = 2e-5;
/// They have to run along each other for so long. Less, and sharp tips are doubles; more, and a short double is
/// overlooked.
const ALONG_MM: f64 = 0.02;

/// A straight line or a circular arc, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stretch {
    /// From a point to a point.
    Line(DVec2, DVec2),
    /// About a centre, from a point, turning by an angle (radians, positive to the left, one turn at most), to a point.
    Arc { centre: DVec2, from: DVec2, turn: f64, to: DVec2 },
}

impl Stretch {
    pub(super) fn from(&self) -> DVec2 {
        match *self {
            Self::Line(from, _) | Self::Arc { from, .. } => from,
        }
    }

    pub(super) fn to(&self) -> DVec2 {
        match *self {
            Self::Line(_, to) | Self::Arc { to, .. } => to,
        }
    }

    pub(super) fn reversed(&self) -> Self {
        match *self {
            Self::Line(from, to) => Self::Line(to, from),
            Self::Arc { centre, from, turn, to } => Self::Arc { centre, from: to, turn: -turn, to: from },
        }
    }

    pub(super) fn length_mm(&self) -> f64 {
        match *self {
            Self::Line(from, to) => from.distance(to),
            Self::Arc { centre, from, turn, .. } => from.distance(centre) * turn.abs(),
        }
    }

    fn at(&self, t: f64) -> DVec2 {
        match *self {
            Self::Line(from, to) => from.lerp(to, t),
            Self::Arc { centre, from, turn, .. } => {
                centre + DVec2::from_angle(t * turn).rotate(from - centre)
            }
        }
    }

    /// A box around it; for an arc that of its circle or, when it is short, that of its ends and what rises between.
    pub(super) fn bounds(&self) -> (DVec2, DVec2) {
        let (low, high) = (self.from().min(self.to()), self.from().max(self.to()));
        match *self {
            Self::Line(..) => (low, high),
            Self::Arc { centre, from, turn, .. } => {
                let radius = from.distance(centre);
                let rise = DVec2::splat(radius * (1.0 - (turn.abs() / 2.0).min(TAU / 2.0).cos()));
                ((low - rise).max(centre - radius), (high + rise).min(centre + radius))
            }
        }
    }

    /// Adds its points but the last, with chords within `chord_mm`.
    pub(super) fn flatten(&self, chord_mm: f64, points: &mut Vec<DVec2>) {
        let n = match *self {
            Self::Line(..) => 1,
            Self::Arc { centre, from, turn, .. } => {
                let radius = from.distance(centre).max(f64::MIN_POSITIVE);
                let step = 2.0 * (1.0 - chord_mm / radius).clamp(0.0, 1.0).acos();
                (turn.abs() / step.max(1e-5)).ceil().max(1.0) as u32
            }
        };
        points.push(self.from());
        points.extend((1..n).map(|i| self.at(f64::from(i) / f64::from(n))));
    }

    /// The parameter of the point nearest to `p`, beyond 0 and 1 too.
    fn along(&self, p: DVec2) -> f64 {
        match *self {
            Self::Line(from, to) => (p - from).dot(to - from) / (to - from).length_squared(),
            Self::Arc { centre, from, turn, .. } => {
                // The angle nearest to the arc's middle, so that both ends are within half a turn of it.
                let middle = turn / 2.0;
                let off = (from - centre).angle_to(p - centre) - middle;
                (middle + off - TAU * (off / TAU).round()) / turn
            }
        }
    }

    /// Where, and for how long, the other makes the same cut.
    fn shared_with(&self, other: &Self) -> Option<(DVec2, f64)> {
        if matches!(self, Self::Line(..)) != matches!(other, Self::Line(..)) {
            return None;
        }
        let (a, b) = (self.along(other.from()), self.along(other.to()));
        let (mut low, mut high) = (a.min(b).max(0.0), a.max(b).min(1.0));
        if let Self::Arc { turn, .. } = other
            && turn.abs() > TAU * 0.75
        {
            // Of a circle, ends say nothing.
            (low, high) = (0.0, 1.0);
        }
        let length_mm = (high - low) * self.length_mm();
        let near = |t: f64| {
            let p = self.at(t);
            let s = other.along(p).clamp(0.0, 1.0);
            other.at(s).distance(p) <= SAME_MM
        };
        let middle = 0.5 * (low + high);
        (length_mm > ALONG_MM && [low, middle, high].into_iter().all(near))
            .then(|| (self.at(middle), length_mm))
    }
}

/// The stretches of two paths that make the same cut: the numbers of the paths, the lower first, the middle of each, and its length. Neighbours within a path are not compared:
/// where a path turns back on itself it has no area there.
pub(super) fn doubled(paths: &[&[Stretch]]) -> Vec<([usize; 2], DVec2, f64)> {
    let margin = DVec2::splat(SAME_MM);
    let envelope = |stretch: &Stretch| {
        let (low, high) = stretch.bounds();
        ((low - margin).to_array(), (high + margin).to_array())
    };
    let mut entries = Vec::new();
    for (i, path) in paths.iter().enumerate() {
        entries.extend(path.iter().enumerate().map(|(k, stretch)| {
            let (low, high) = envelope(stretch);
            GeomWithData::new(Rectangle::from_corners(low, high), (i, k))
        }));
    }
    let tree = RTree::bulk_load(entries);
    let mut found = Vec::new();
    for (i, path) in paths.iter().enumerate() {
        for (k, stretch) in path.iter().enumerate() {
            let (low, high) = envelope(stretch);
            let near = tree.locate_in_envelope_intersecting(AABB::from_corners(low, high));
            let follows = |m: usize| k.abs_diff(m) == 1 || k.abs_diff(m) + 1 == path.len();
            let mut later: Vec<(usize, usize)> =
                near.map(|entry| entry.data).filter(|&j| j > (i, k)).collect();
            later.sort_unstable();
            for (j, m) in later {
                // A path of two stretches may be there and back.
                if i == j && follows(m) && path.len() > 2 {
                    continue;
                }
                let shared = stretch.shared_with(&paths[j][m]);
                found.extend(shared.map(|(middle, length_mm)| ([i, j], middle, length_mm)));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(a: (f64, f64), b: (f64, f64)) -> Stretch {
        Stretch::Line(a.into(), b.into())
    }

    fn arc(radius: f64, from: f64, turn: f64) -> Stretch {
        let at = |angle: f64| radius * DVec2::from_angle(angle);
        Stretch::Arc { centre: DVec2::ZERO, from: at(from), turn, to: at(from + turn) }
    }

    #[test]
    fn lines_that_overlap_in_part_are_found_and_neighbours_are_not() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let square: Vec<Stretch> = (0..4).map(|i| line(square[i], square[(i + 1) % 4])).collect();
        assert_eq!(doubled(&[&square]), []);
        let beside = [line((12.0, 0.0), (4.0, 0.0)), line((4.0, 1e-3), (12.0, 1e-3))];
        let found = doubled(&[&square, &beside]);
        assert_eq!(found, [([0, 1], DVec2::new(7.0, 0.0), 6.0)]);
        assert_eq!(doubled(&[&square, &square]).len(), 4);
        assert_eq!(doubled(&[&[line((0.0, 0.0), (5.0, 5.0))], &[line((0.0, 5.0), (5.0, 0.0))]]), []);
    }

    #[test]
    fn arcs_of_one_circle_are_found_where_they_overlap() {
        let found = doubled(&[&[arc(10.0, 0.0, 2.0)], &[arc(10.0, 3.0, -2.0)]]);
        let [(_, at, length_mm)] = found[..] else { panic!("{found:?}") };
        assert!((length_mm - 10.0).abs() < 1e-6 && at.distance(10.0 * DVec2::from_angle(1.5)) < 1e-6);
        assert_eq!(doubled(&[&[arc(10.0, 0.0, 2.0)], &[arc(10.0, 2.0, 2.0)]]), [], "they only meet");
        assert_eq!(doubled(&[&[arc(10.0, 0.0, 2.0)], &[arc(10.001, 0.0, 2.0)]]), []);
    }

    #[test]
    fn arcs_are_flattened_within_the_chord() {
        let mut points = Vec::new();
        arc(10.0, 0.0, -3.0).flatten(0.01, &mut points);
        assert!((20..60).contains(&points.len()));
        let lows = points.windows(2).map(|w| w[0].midpoint(w[1]).length());
        assert!(lows.fold(f64::INFINITY, f64::min) > 9.99);
        let (low, high) = arc(10.0, 0.0, 1.0).bounds();
        assert!(low.x <= 10.0 * 1f64.cos() && high.x <= 10.0 && high.y >= 10.0 * 1f64.sin() && low.y <= 0.0);
    }
}
