//! Whether outlines keep clear of each other as curves, and not only as the chords of one flattening.
//!
//! Chords hide what the curves do between them: two outlines that cross may have chords that do not, and the
//! other way round. So every piece of a flattened cubic stands for all that lies within the flattening's
//! tolerance of its chord, which holds the curve and the chords of any reader that flattens as finely. Where
//! such a piece meets another that does not continue it, the outlines are not clear. Straight lines stand for
//! themselves, so an outline of lines only is always clear; whether lines cross is for the region to say.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::outline::{Arc, Cubic, Outline, Segment, distance_to_edge};

/// A straight line of an outline, or the chord of a part of an arc or cubic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    from: DVec2,
    to: DVec2,
    /// How far from the chord the outline, or a reader's chords, may run; zero for a line.
    radius: f64,
    /// The inner control points of the cubic between `from` and `to`; of an arc, points on its end tangents; of a line,
    /// its ends.
    handles: [DVec2; 2],
}

impl Piece {
    /// Where the piece begins.
    pub(super) fn from(&self) -> DVec2 {
        self.from
    }

    fn is_curved(&self) -> bool {
        self.radius > 0.0
    }

    fn envelope(&self, margin: f64) -> AABB<[f64; 2]> {
        let margin = DVec2::splat(margin);
        let (low, high) = (self.from.min(self.to) - margin, self.from.max(self.to) + margin);
        AABB::from_corners(low.to_array(), high.to_array())
    }

    fn distance(&self, other: &Self) -> f64 {
        let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a) > 0.0;
        let parts = |a: &Self, b: &Self| side(a.from, a.to, b.from) != side(a.from, a.to, b.to);
        if parts(self, other) && parts(other, self) {
            return 0.0;
        }
        let to_other = [self.from, self.to].map(|p| distance_to_edge(p, other.from, other.to));
        let to_self = [other.from, other.to].map(|p| distance_to_edge(p, self.from, self.to));
        to_other.into_iter().chain(to_self).fold(f64::INFINITY, f64::min)
    }
}

/// The pieces of an outline in order, with chords at most `tolerance` from it.
pub(super) fn pieces(outline: &Outline, tolerance: f64) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(4 * outline.segments.len());
    let mut from = outline.start;
    for segment in &outline.segments {
        let end = segment.end();
        match *segment {
            Segment::Line(_) => pieces.push(Piece { from, to: end, radius: 0.0, handles: [from, end] }),
            Segment::Arc(to, bulge) => {
                let arc = Arc { from, to, bulge };
                let radius = tolerance.min(arc.rise()).max(f64::MIN_POSITIVE);
                let curve = |t: f64| (arc.at(t), arc.velocity(t));
                add(&mut pieces, curve, arc.pieces_within(tolerance), radius, [from, end]);
            }
            Segment::Cubic(a, b, _) => {
                let cubic = Cubic([from, a, b, end]);
                // No chord of a cubic leaves its control polygon, however coarse.
                let flatness = distance_to_edge(a, from, end).max(distance_to_edge(b, from, end));
                let radius = tolerance.min(flatness).max(f64::MIN_POSITIVE);
                let curve = |t: f64| (cubic.at(t), cubic.velocity(t));
                add(&mut pieces, curve, cubic.pieces_within(tolerance), radius, [from, end]);
            }
        }
        from = end;
    }
    pieces
}

/// Adds the pieces between `n` equal steps of a curve, which gives its point and derivative at a parameter.
fn add(
    pieces: &mut Vec<Piece>,
    curve: impl Fn(f64) -> (DVec2, DVec2),
    n: usize,
    radius: f64,
    [from, end]: [DVec2; 2],
) {
    let third = 1.0 / (3.0 * n as f64);
    let at = |i: usize| {
        let (p, velocity) = curve(i as f64 / n as f64);
        let p = if i == 0 {
            from
        } else if i == n {
            end
        } else {
            p
        };
        (p, velocity * third)
    };
    let mut here = at(0);
    for i in 1..=n {
        let next = at(i);
        let handles = [here.0 + here.1, next.0 - next.1];
        pieces.push(Piece { from: here.0, to: next.0, radius, handles });
        here = next;
    }
}

/// Points along the stretches where the pieces of closed outlines are not clear of each other, at most
/// `spacing` apart. None means that the outlines, as curves, meet no more than their pieces do as lines.
pub(super) fn unclear(outlines: &[Vec<Piece>], spacing: f64) -> Vec<DVec2> {
    let widest = outlines.iter().flatten().map(|p| p.radius).fold(0.0, f64::max);
    if widest == 0.0 {
        return Vec::new();
    }
    let mut entries = Vec::with_capacity(outlines.iter().map(Vec::len).sum());
    for (o, pieces) in outlines.iter().enumerate() {
        entries.extend(pieces.iter().enumerate().map(|(i, p)| {
            let (low, high) = (p.from.min(p.to).to_array(), p.from.max(p.to).to_array());
            GeomWithData::new(Rectangle::from_corners(low, high), (o, i))
        }));
    }
    let tree = RTree::bulk_load(entries);
    let mut found = Vec::new();
    for (o, pieces) in outlines.iter().enumerate() {
        for (i, piece) in pieces.iter().enumerate() {
            let next = (i + 1) % pieces.len();
            if !opens(piece, &pieces[next]) {
                found.push(piece.to);
            }
            if !piece.is_curved() {
                continue;
            }
            for entry in tree.locate_in_envelope_intersecting(piece.envelope(piece.radius + widest)) {
                let (other_o, other_i) = entry.data;
                let other = &outlines[other_o][other_i];
                let continues =
                    o == other_o && (i == other_i || next == other_i || (other_i + 1) % pieces.len() == i);
                let reach = piece.radius + other.radius;
                if !continues && piece.distance(other) <= reach {
                    let n = (piece.from.distance(piece.to) / spacing).ceil().max(1.0) as u32;
                    let along = (0..=n).map(|k| piece.from.lerp(piece.to, f64::from(k) / f64::from(n)));
                    found.extend(
                        along.filter(|&p| distance_to_edge(p, other.from, other.to) <= reach + spacing),
                    );
                }
            }
        }
    }
    found
}

/// Whether two consecutive pieces meet in their joint only: seen from there, their control points lie in
/// separate cones.
fn opens(piece: &Piece, next: &Piece) -> bool {
    let joint = piece.to;
    let (back, ahead) = (piece.from - joint, next.to - joint);
    if back.dot(ahead) < 0.0 || !(piece.is_curved() || next.is_curved()) {
        return true;
    }
    let spread = |axis: DVec2, handles: [DVec2; 2]| {
        let off = handles.map(|h| if h == joint { 0.0 } else { axis.angle_to(h - joint).abs() });
        off[0].max(off[1])
    };
    back.angle_to(ahead).abs() > spread(back, piece.handles) + spread(ahead, next.handles)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(start: (f64, f64), segments: &[[(f64, f64); 3]]) -> Vec<Piece> {
        let segment = |&[a, b, end]: &[(f64, f64); 3]| Segment::Cubic(a.into(), b.into(), end.into());
        let outline = Outline { start: start.into(), segments: segments.iter().map(segment).collect() };
        pieces(&outline, 0.01)
    }

    /// A dome from (0, 0) to (4, 0) that rises to 3, and back along the ground.
    fn dome() -> Vec<Piece> {
        let mut dome = outline((0.0, 0.0), &[[(0.0, 4.0), (4.0, 4.0), (4.0, 0.0)]]);
        dome.push(line((4.0, 0.0), (0.0, 0.0)));
        dome
    }

    fn line(from: (f64, f64), to: (f64, f64)) -> Piece {
        let (from, to) = (from.into(), to.into());
        Piece { from, to, radius: 0.0, handles: [from, to] }
    }

    fn bar(y: f64) -> Vec<Piece> {
        let corners = [(0.0, y), (4.0, y), (4.0, y + 1.0), (0.0, y + 1.0)];
        (0..4).map(|i| line(corners[i], corners[(i + 1) % 4])).collect()
    }

    #[test]
    fn a_curve_is_clear_beyond_its_radius_only() {
        assert_eq!(unclear(&[dome(), bar(3.02)], 0.1), []);
        // The chords reach at least 2.99.
        let near = unclear(&[dome(), bar(3.0)], 0.1);
        assert!(!near.is_empty());
        assert!(near.iter().all(|p| p.distance(DVec2::new(2.0, 3.0)) < 1.0), "{near:?}");
    }

    #[test]
    fn lines_are_always_clear() {
        assert_eq!(unclear(&[bar(0.0), bar(1.0), bar(1.5)], 0.1), []);
    }

    #[test]
    fn sides_that_swap_at_a_tip_are_found() {
        // Two curves from (0, 0) to (4, 0) and back; at the second tip the lower leaves above the upper.
        let lens = outline(
            (0.0, 0.0),
            &[[(1.0, -1.0), (3.0, -1.0), (4.0, 0.0)], [(3.0, 1.0), (1.0, 1.0), (0.0, 0.0)]],
        );
        assert_eq!(unclear(&[lens], 0.1), []);
        let swapped = outline(
            (0.0, 0.0),
            &[[(1.0, -1.0), (3.9999, 0.0002), (4.0, 0.0)], [(3.9999, 0.0001), (1.0, 1.0), (0.0, 0.0)]],
        );
        assert!(unclear(&[swapped], 0.1).iter().any(|p| p.distance(DVec2::new(4.0, 0.0)) < 0.1));
    }
}
