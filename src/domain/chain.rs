//! A chain of arcs end to end, measured from its start.

use glam::DVec2;

use super::arc::{Arc, biarc, turn_between};

/// Where two neighbouring arcs do not share their tangent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    /// Where along the chain, in mm; 0 for the joint of a closed chain's end with its start.
    pub at: f64,
    /// By how much the direction turns there, in radians, positive to the left.
    pub turn: f64,
}

/// A stretch of a chain that is to be replaced. In a closed chain it may begin before 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// Where it begins, in mm.
    pub from: f64,
    /// Where it ends, in mm, after `from`.
    pub to: f64,
}

/// Arcs end to end. Each arc ends where the next one starts, within rounding; directions may differ there
/// ([`Chain::joints`]).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    arcs: Vec<Arc>,
    /// Where each arc starts along the chain.
    starts: Vec<f64>,
    length: f64,
    closed: bool,
}

impl Chain {
    /// The chain of all `arcs` that have a length. A closed chain's last arc ends where the first one starts.
    pub fn new(arcs: impl IntoIterator<Item = Arc>, closed: bool) -> Self {
        let mut chain = Self { arcs: Vec::new(), starts: Vec::new(), length: 0.0, closed };
        for arc in arcs {
            if arc.length > 0.0 {
                chain.starts.push(chain.length);
                chain.length += arc.length;
                chain.arcs.push(arc);
            }
        }
        chain
    }

    /// The arcs with where each one starts along the chain.
    pub fn located_arcs(&self) -> impl Iterator<Item = (f64, &Arc)> {
        self.starts.iter().copied().zip(&self.arcs)
    }

    /// The length of all arcs in mm.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether the end is the start.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The arc at `u` and the distance of `u` from that arc's start. A joint belongs to the arc that follows.
    ///
    /// `u` wraps in a closed chain; in an open one the distance lies outside of the arc when `u` lies
    /// outside of the chain.
    pub fn locate(&self, u: f64) -> (&Arc, f64) {
        let u = self.wrap(u);
        let next = self.starts.partition_point(|&s| s <= u);
        let i = next.saturating_sub(1);
        (&self.arcs[i], u - self.starts[i])
    }

    /// `u` from 0 up to the length in a closed chain; `u` itself in an open one.
    pub fn wrap(&self, u: f64) -> f64 {
        if self.closed && !(0.0..self.length).contains(&u) {
            let wrapped = u.rem_euclid(self.length);
            // A tiny negative u rounds up to the length itself.
            if wrapped < self.length { wrapped } else { 0.0 }
        } else {
            u
        }
    }

    /// The joints where the direction turns by more than `least` radians, in order.
    pub fn joints(&self, least: f64) -> Vec<Joint> {
        let before_first = if self.closed { self.arcs.last() } else { None };
        let before = std::iter::once(before_first).chain(self.arcs.iter().map(Some));
        let joints = before.zip(self.located_arcs()).filter_map(|(before, (at, arc))| {
            before.map(|b| Joint { at, turn: turn_between(b.end_direction(), arc.direction) })
        });
        joints.filter(|j| j.turn.abs() > least).collect()
    }

    /// The arcs from `from` to `to` mm, both within the chain.
    fn slice(&self, from: f64, to: f64) -> impl Iterator<Item = Arc> + '_ {
        let first = self.starts.partition_point(|&s| s <= from).saturating_sub(1);
        let reached = self.located_arcs().skip(first).take_while(move |(s, _)| *s < to);
        reached.map(move |(s, arc)| arc.part((from - s).max(0.0), (to - s).min(arc.length)))
    }

    /// By how much the direction turns within the arcs of `cut`, either way, in radians.
    pub fn turn_within(&self, cut: Cut) -> f64 {
        let turn = |from, to| self.slice(from, to).map(|arc| arc.turn().abs()).sum::<f64>();
        let before_start = if cut.from < 0.0 { turn(self.length + cut.from, self.length) } else { 0.0 };
        before_start + turn(cut.from.max(0.0), cut.to)
    }

    /// The two arcs that would replace `cut`.
    pub fn bridge(&self, cut: Cut) -> [Arc; 2] {
        let (before, s) = self.locate_before(cut.from);
        let (after, t) = self.locate(cut.to);
        biarc(before.point(s), before.direction_at(s), after.point(t), after.direction_at(t))
    }

    /// As [`Chain::locate`], but a joint belongs to the arc before it.
    fn locate_before(&self, u: f64) -> (&Arc, f64) {
        let u = if self.closed && u <= 0.0 { u + self.length } else { u };
        let i = self.starts.partition_point(|&s| s < u).saturating_sub(1);
        (&self.arcs[i], u - self.starts[i])
    }

    /// The chain with each cut replaced by its bridge, so that the direction does not jump there.
    ///
    /// The cuts are in order and do not overlap; only the first one may begin before 0. The start of a chain
    /// whose first cut begins before 0 becomes the middle of that bridge.
    pub fn bridged(&self, cuts: &[Cut]) -> Self {
        let (seam, inner) = match cuts.split_first() {
            Some((first, rest)) if first.from < 0.0 => (Some(*first), rest),
            _ => (None, cuts),
        };
        let seam_arcs = seam.map(|cut| self.bridge(cut));
        let mut arcs: Vec<Arc> = seam_arcs.iter().map(|[_, second]| *second).collect();
        let mut done = seam.map_or(0.0, |cut| cut.to);
        for &cut in inner {
            arcs.extend(self.slice(done, cut.from));
            arcs.extend(self.bridge(cut));
            done = cut.to;
        }
        arcs.extend(self.slice(done, seam.map_or(self.length, |cut| self.length + cut.from)));
        arcs.extend(seam_arcs.iter().map(|[first, _]| *first));
        Self::new(arcs, self.closed)
    }

    /// Where `u` lies, for messages.
    pub fn point(&self, u: f64) -> DVec2 {
        let (arc, s) = self.locate(u);
        arc.point(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[(f64, f64)], closed: bool) -> Chain {
        let corners: Vec<DVec2> = corners.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        let n = if closed { corners.len() } else { corners.len() - 1 };
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            Arc::through(a, (b - a).normalize(), b)
        };
        Chain::new((0..n).map(edge), closed)
    }

    #[test]
    fn joints_of_a_square() {
        let square = polygon(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)], true);
        let at: Vec<f64> = square.joints(0.1).iter().map(|j| j.at).collect();
        assert_eq!(at, [0.0, 2.0, 4.0, 6.0]);
        let open = polygon(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)], false);
        assert_eq!(open.joints(0.1).len(), 1);
        assert_eq!(open.joints(1.6), []);
    }

    #[test]
    fn bridges_leave_no_joint_even_at_the_seam() {
        let square = polygon(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)], true);
        let cuts = [0.0, 2.0, 4.0, 6.0].map(|at| Cut { from: at - 0.5, to: at + 0.5 });
        let smooth = square.bridged(&cuts);
        assert_eq!(smooth.joints(1e-12), []);
        assert!((smooth.length() - (4.0 + std::f64::consts::PI)).abs() < 1e-12);
        let end = smooth.located_arcs().last().unwrap().1;
        assert!((end.point(end.length) - smooth.point(0.0)).length() < 1e-12);
    }

    #[test]
    fn wrapping_never_reaches_the_length() {
        let square = polygon(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)], true);
        for u in [-1e-20, 8.0, -8.0, 1e9] {
            assert!((0.0..8.0).contains(&square.wrap(u)), "{u}");
        }
        assert_eq!(square.point(9.0), DVec2::new(1.0, 0.0));
        assert!((square.point(-0.5) - DVec2::new(0.0, 0.5)).length() < 1e-12);
    }
}
