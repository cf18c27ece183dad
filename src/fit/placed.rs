//! A run of pieces, each at its place and with its targets, ready to be bent.

use glam::DVec2;
use thiserror::Error;

use super::lri::Lri;
use super::offsets::offsets;
use super::sound::{Soundness, Unsound};
use super::stitch::{Bent, SideTarget, Stitch, StitchMethod, Targets};
use super::warp::StripWarp;
use crate::pieces::{Catalogue, End, Piece};

/// What the outline has to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// The arc length L of the band.
    pub length_mm: f64,
    /// The height H of the band.
    pub height_mm: f64,
    /// Whether the run closes on itself.
    pub is_ring: bool,
    /// How far a chord may lie from the bent edge that it stands for.
    pub chord_mm: f64,
    /// How pieces are bent to meet.
    pub stitch: StitchMethod,
    /// What becomes of the sides of the band.
    pub sides: Sides,
}

/// What becomes of the two sides of the band, v = −H/2 and v = H/2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// Ink stays within them: a run that offsets carry out of the band is pressed flat.
    #[default]
    Free,
    /// Ink fills the band from side to side: the run is pressed or stretched.
    Filled,
    /// What lies on them stays there: pieces keep their heights, and only what is between the sides bends. Pieces
    /// are always warped, as rotation-invariant deformation moves what lies on the sides.
    Held,
    /// The same, and the two sides are one place, as of a sheet that is rolled.
    Joined,
}

impl Sides {
    /// Whether what lies on the sides stays there.
    pub fn are_held(self) -> bool {
        matches!(self, Self::Held | Self::Joined)
    }
}

/// A run of pieces that cannot be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FitError {
    /// Two successive pieces have no join in the catalogue.
    #[error("piece {to} cannot follow piece {from}: the catalogue has no such join")]
    NoJoin {
        /// The first piece.
        from: usize,
        /// The second.
        to: usize,
    },
    /// There is no piece at all.
    #[error("a run of no pieces has no outline")]
    Empty,
}

/// The pieces of a catalogue made ready for rotation-invariant deformation, each when it is first needed and then
/// kept: a run has the same pieces again and again, and the system of a piece does not depend on its neighbours.
#[derive(Debug, Default)]
pub struct Prepared {
    pieces: Vec<Option<Ready>>,
}

#[derive(Debug)]
struct Ready {
    /// `None` where there is no system to solve.
    lri: Option<Lri>,
    soundness: Soundness,
}

impl Prepared {
    /// Nothing prepared yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// How many pieces have been prepared.
    pub fn len(&self) -> usize {
        self.pieces.iter().flatten().count()
    }

    /// Whether no piece has been prepared.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn ready(&mut self, number: usize, piece: &Piece) -> &Ready {
        if self.pieces.len() <= number {
            self.pieces.resize_with(number + 1, || None);
        }
        self.pieces[number]
            .get_or_insert_with(|| Ready { lri: Lri::new(piece), soundness: Soundness::of(piece) })
    }
}

/// A run with every piece placed, before bending.
#[derive(Debug, Clone)]
pub struct Placed<'a> {
    pub(super) sequence: &'a [usize],
    pub(super) pieces: Vec<&'a Piece>,
    pub(super) starts_mm: Vec<f64>,
    offsets: Vec<f64>,
    /// The targets at each join, from the first; none where there are no portals.
    pub(super) joints: Vec<Joint>,
    pub(super) stretch: f64,
    is_ring: bool,
    /// The height above and below the middle that stays where it is.
    held_mm: Option<f64>,
}

#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub(super) targets: Vec<SideTarget>,
    pub(super) before_deg: f64,
    pub(super) is_natural: bool,
}

impl<'a> Placed<'a> {
    /// Places the pieces of `sequence` along the band, and averages the endpoints and tangents of neighbours.
    ///
    /// # Errors
    /// [`FitError`] when the sequence is no run of the catalogue.
    pub fn new(
        catalogue: &'a Catalogue,
        sequence: &'a [usize],
        options: &FitOptions,
    ) -> Result<Self, FitError> {
        let pieces: Vec<&Piece> = sequence.iter().map(|&p| &catalogue.pieces()[p]).collect();
        let (Some(&first), Some(&last)) = (sequence.first(), sequence.last()) else {
            return Err(FitError::Empty);
        };
        let mut joins: Vec<(usize, usize)> = sequence.windows(2).map(|w| (w[0], w[1])).collect();
        if options.is_ring {
            joins.push((last, first));
        }
        let table = joins
            .iter()
            .map(|&(from, to)| catalogue.join(from, to).ok_or(FitError::NoJoin { from, to }))
            .collect::<Result<Vec<_>, _>>()?;
        let rises: Vec<f64> = table.iter().map(|j| j.rise_mm).collect();
        let portals: Vec<usize> =
            joins.iter().map(|&(from, _)| catalogue.pieces()[from].right_portals()).collect();
        let held_mm = options.sides.are_held().then_some(options.height_mm / 2.0);
        let offsets = match held_mm {
            Some(_) => vec![0.0; pieces.len()],
            None => offsets(&rises, &portals, options.is_ring),
        };
        // The ink of an open run fills the band from end to end.
        let blank = |p: Option<&&Piece>, of: fn((f64, f64)) -> f64| match p {
            Some(p) if !options.is_ring => of(p.blanks_mm()),
            _ => 0.0,
        };
        let (before, after) = (blank(pieces.first(), |b| b.0), blank(pieces.last(), |b| b.1));
        let natural: f64 = pieces.iter().map(|p| p.width_mm).sum::<f64>() - before - after;
        let stretch = options.length_mm / natural;
        let mut at = -before * stretch;
        let starts_mm = pieces
            .iter()
            .map(|p| {
                let start = at;
                at += p.width_mm * stretch;
                start
            })
            .collect();
        let n = pieces.len();
        let joints = (0..joins.len())
            .map(|i| {
                let j = (i + 1) % n;
                Joint::new(pieces[i], offsets[i], pieces[j], offsets[j], table[i].is_natural)
            })
            .collect();
        Ok(Self { sequence, pieces, starts_mm, offsets, joints, stretch, is_ring: options.is_ring, held_mm })
    }

    fn joint_before(&self, i: usize) -> Option<&Joint> {
        let wrapped = if self.is_ring {
            Some((i + self.pieces.len() - 1) % self.pieces.len())
        } else {
            i.checked_sub(1)
        };
        wrapped.map(|j| &self.joints[j])
    }

    /// The pieces in their order.
    pub fn pieces(&self) -> &[&'a Piece] {
        &self.pieces
    }

    /// What x in the i-th piece is multiplied by on the way into the band.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Where the i-th piece has to go.
    pub fn targets(&self, i: usize) -> Targets<'_> {
        Targets {
            left: self.joint_before(i).map_or(&[][..], |joint| &joint.targets),
            right: self.joints.get(i).map_or(&[][..], |joint| &joint.targets),
            offset_mm: self.offsets[i],
            held_mm: self.held_mm,
        }
    }

    /// How pieces are bent where `wanted` was asked for.
    pub(super) fn method(&self, wanted: StitchMethod) -> StitchMethod {
        if self.held_mm.is_some() { StitchMethod::Warp } else { wanted }
    }

    /// The i-th piece bent to its targets, before stretching, and if rotation-invariant deformation was wanted and
    /// did not hold, why it was warped instead.
    ///
    /// Pieces at the ends of an open run are always warped, as their ink has to end where the band ends, and so are
    /// pieces without portals, which are only shifted, and all where the sides of the band are held.
    pub fn bend(
        &self,
        i: usize,
        method: StitchMethod,
        prepared: &mut Prepared,
        chord_mm: f64,
    ) -> (Bent, Option<Unsound>) {
        let is_end = !self.is_ring && (i == 0 || i + 1 == self.pieces.len());
        let is_loose = self.pieces[i].left.is_empty() && self.pieces[i].right.is_empty();
        let fault = match self.method(method) {
            StitchMethod::Lri if !is_end && !is_loose => match self.deformed(i, prepared, chord_mm) {
                Ok(bent) => return (bent, None),
                Err(fault) => Some(fault),
            },
            _ => None,
        };
        let piece = self.pieces[i];
        let warp = StripWarp::new(piece, &self.targets(i));
        (self.pinned(i, warp.bend(piece, chord_mm)), fault)
    }

    fn deformed(&self, i: usize, prepared: &mut Prepared, chord_mm: f64) -> Result<Bent, Unsound> {
        let piece = self.pieces[i];
        let ready = prepared.ready(self.sequence[i], piece);
        let lri = ready.lri.as_ref().ok_or(Unsound::Unsolvable)?;
        let bent = self.pinned(i, lri.solved(&self.targets(i)).bend(piece, chord_mm));
        ready.soundness.check(piece, &bent).map(|()| bent)
    }

    /// Neighbours meet in the very same numbers.
    fn pinned(&self, i: usize, mut bent: Bent) -> Bent {
        let piece = self.pieces[i];
        let targets = self.targets(i);
        let end_point = |end: End| match end {
            End::Left(k) => DVec2::new(0.0, targets.left[k].y_mm),
            End::Right(k) => DVec2::new(piece.width_mm, targets.right[k].y_mm),
        };
        for (chain, points) in piece.chains.iter().zip(&mut bent.chains) {
            let last = points.len() - 1;
            points[0] = end_point(chain.start);
            points[last] = end_point(chain.end);
        }
        bent
    }
}

impl Joint {
    /// The endpoints and tangents of two neighbours are averaged (Zhou 2014 §4.2).
    fn new(a: &Piece, a_offset: f64, b: &Piece, b_offset: f64, is_natural: bool) -> Self {
        let pairs = || a.right.iter().zip(&b.left);
        let targets = pairs()
            .map(|(r, l)| SideTarget {
                y_mm: (r.y_mm + a_offset + l.y_mm + b_offset) / 2.0,
                tangent: (r.tangent + l.tangent).normalize(),
            })
            .collect();
        let before = pairs().map(|(r, l)| r.tangent.angle_to(l.tangent).abs()).fold(0.0, f64::max);
        Self { targets, before_deg: before.to_degrees(), is_natural }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_pieces::{targets_of, turned, two_strands};
    use super::*;

    /// Three times the same piece, the middle one with these targets.
    fn run<'a>(piece: &'a Piece, left: Vec<SideTarget>, right: Vec<SideTarget>) -> Placed<'a> {
        let joint = |targets| Joint { targets, before_deg: 0.0, is_natural: false };
        Placed {
            sequence: &[0, 0, 0],
            pieces: vec![piece; 3],
            starts_mm: vec![0.0, 4.0, 8.0],
            offsets: vec![0.0; 3],
            joints: vec![joint(left), joint(right)],
            stretch: 1.0,
            is_ring: false,
            held_mm: None,
        }
    }

    #[test]
    fn strands_that_would_cross_are_warped() {
        let piece = two_strands();
        let (left, right) = targets_of(&piece);
        // The upper strand sets out and arrives steeply below itself, the lower one above.
        let towards = |side: &[SideTarget], angle: f64| {
            [turned(&side[..2], -angle, 0.0), turned(&side[2..], angle, 0.0)].concat()
        };
        let placed = run(&piece, towards(&left, 1.2), towards(&right, -1.2));
        let mut prepared = Prepared::new();
        let (bent, fault) = placed.bend(1, StitchMethod::Lri, &mut prepared, 1e-3);
        assert!(matches!(fault, Some(Unsound::Meets { .. })), "{fault:?}");
        let (warped, none) = placed.bend(1, StitchMethod::Warp, &mut prepared, 1e-3);
        assert_eq!((bent, none), (warped.clone(), None));
        assert_eq!(Soundness::of(&piece).check(&piece, &warped), Ok(()));
    }

    #[test]
    fn gentle_targets_are_met_without_the_warp() {
        let piece = two_strands();
        let (left, right) = targets_of(&piece);
        let placed = run(&piece, turned(&left, 0.3, 0.2), right);
        let mut prepared = Prepared::new();
        assert!(prepared.is_empty());
        let (once, fault) = placed.bend(1, StitchMethod::Lri, &mut prepared, 1e-3);
        assert_eq!((fault, prepared.len()), (None, 1));
        // What is prepared is used again, and changes nothing.
        let (again, _) = placed.bend(1, StitchMethod::Lri, &mut prepared, 1e-3);
        assert_eq!((again, prepared.len()), (once, 1));
    }
}
