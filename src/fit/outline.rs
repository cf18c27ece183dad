//! The outline of a run of pieces: closed contours in band coordinates.

use glam::DVec2;
use rustc_hash::FxHashMap;
use thiserror::Error;

use super::offsets::offsets;
use super::warp::{SideTarget, Stitch, StripWarp};
use crate::pieces::{Catalogue, Chain, End, Piece};

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
}

/// What becomes of the two sides of the band, v = −H/2 and v = H/2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// Ink stays within them: a run that offsets carry out of the band is pressed flat.
    #[default]
    Free,
    /// Ink fills the band from side to side: the run is pressed or stretched.
    Filled,
    /// What lies on them stays there: pieces keep their heights, and only what is between the sides bends.
    Held,
}

/// A closed contour in band coordinates, with the ink on its left.
#[derive(Debug, Clone, PartialEq)]
pub struct OutlineContour {
    /// Vertices: u along the band, unwrapped on a ring, and v across, in millimetres.
    pub points: Vec<DVec2>,
    /// How often it goes round a ring: the last vertex is followed by the first, moved by so many lengths.
    pub winding: i32,
}

/// Where two pieces meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The position along the band, in millimetres.
    pub u_mm: f64,
    /// The greatest angle between contours on the two sides, in degrees, as cut.
    pub before_deg: f64,
    /// The greatest turn of a contour at the seam after fitting, in degrees.
    pub after_deg: f64,
    /// Whether the pieces are neighbours in the exemplar.
    pub is_natural: bool,
}

/// The contours of a run of pieces.
#[derive(Debug, Clone)]
pub struct Outline {
    /// All contours.
    pub contours: Vec<OutlineContour>,
    /// The seams in order; the closing one of a ring last.
    pub seams: Vec<Seam>,
    /// What the lengths of the pieces were multiplied by.
    pub stretch: f64,
    /// What heights were multiplied by, so that the run fits the band; at most 1 unless it is to fill the band.
    pub squash: f64,
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

impl Outline {
    /// The outline of `sequence`.
    ///
    /// # Errors
    /// [`FitError`] when the sequence is no run of the catalogue.
    pub fn new(catalogue: &Catalogue, sequence: &[usize], options: &FitOptions) -> Result<Self, FitError> {
        Self::with_sides(catalogue, sequence, options, Sides::Free)
    }

    /// The outline of `sequence` with a say in what becomes of the sides of the band.
    ///
    /// # Errors
    /// As [`Outline::new`].
    pub fn with_sides(
        catalogue: &Catalogue,
        sequence: &[usize],
        options: &FitOptions,
        sides: Sides,
    ) -> Result<Self, FitError> {
        let placed = Placed::new(catalogue, sequence, options, sides)?;
        let bent: Vec<Bent> = (0..sequence.len()).map(|i| placed.bend(i, options.chord_mm)).collect();
        let contours = placed.link(&bent, options);
        let seams = placed.seams(&bent);
        let mut outline = Self { contours, seams, stretch: placed.stretch, squash: 1.0 };
        outline.fit_height(options.height_mm, sides);
        Ok(outline)
    }

    /// The lowest and highest v; (0, 0) without contours.
    pub fn height_range_mm(&self) -> (f64, f64) {
        let vs = self.contours.iter().flat_map(|c| &c.points).map(|p| p.y);
        vs.map(|v| (v, v)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
    }

    /// Offsets may carry ink out of the band: the whole is then moved back to the middle, and pressed flat as
    /// far as need be.
    fn fit_height(&mut self, height_mm: f64, sides: Sides) {
        let (low, high) = self.height_range_mm();
        let half = height_mm / 2.0;
        let fits = height_mm / (high - low);
        self.squash = match sides {
            Sides::Held => return,
            Sides::Free if low >= -half && high <= half => return,
            Sides::Free => fits.min(1.0),
            Sides::Filled => fits,
        };
        let middle = (low + high) / 2.0;
        for point in self.contours.iter_mut().flat_map(|c| &mut c.points) {
            point.y = (point.y - middle) * self.squash;
        }
    }
}

/// A run with every piece placed, before bending.
struct Placed<'a> {
    pieces: Vec<&'a Piece>,
    starts_mm: Vec<f64>,
    offsets: Vec<f64>,
    /// The targets at each join, from the first; none where there are no portals.
    joints: Vec<Joint>,
    stretch: f64,
    is_ring: bool,
    /// The height above and below the middle that stays where it is.
    held_mm: Option<f64>,
}

struct Joint {
    targets: Vec<SideTarget>,
    before_deg: f64,
    is_natural: bool,
}

/// A bent piece: its chains by where they start, in band coordinates relative to the piece's beginning.
struct Bent {
    chains: FxHashMap<End, (End, Vec<DVec2>)>,
    loops: Vec<Vec<DVec2>>,
}

impl<'a> Placed<'a> {
    fn new(
        catalogue: &'a Catalogue,
        sequence: &[usize],
        options: &FitOptions,
        sides: Sides,
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
        let held_mm = (sides == Sides::Held).then_some(options.height_mm / 2.0);
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
        Ok(Self { pieces, starts_mm, offsets, joints, stretch, is_ring: options.is_ring, held_mm })
    }

    fn joint_before(&self, i: usize) -> Option<&Joint> {
        let wrapped = if self.is_ring {
            Some((i + self.pieces.len() - 1) % self.pieces.len())
        } else {
            i.checked_sub(1)
        };
        wrapped.map(|j| &self.joints[j])
    }

    fn bend(&self, i: usize, chord_mm: f64) -> Bent {
        let piece = self.pieces[i];
        let (left, right) = (
            self.joint_before(i).map_or(&[][..], |j| &j.targets),
            self.joints.get(i).map_or(&[][..], |j| &j.targets),
        );
        let warp = StripWarp::held(
            piece.width_mm,
            (&piece.left, left),
            (&piece.right, right),
            self.offsets[i],
            self.held_mm,
        );
        let place = |p: DVec2| {
            let bent = warp.map(p);
            DVec2::new(bent.x * self.stretch, bent.y)
        };
        let end_point = |end: End| match end {
            End::Left(k) => DVec2::new(0.0, left[k].y_mm),
            End::Right(k) => DVec2::new(piece.width_mm * self.stretch, right[k].y_mm),
        };
        let chains = piece
            .chains
            .iter()
            .map(|Chain { start, end, points }| {
                let mut bent = bend_polyline(points, &place, chord_mm);
                // Neighbours meet in the very same numbers.
                let last = bent.len() - 1;
                bent[0] = end_point(*start);
                bent[last] = end_point(*end);
                (*start, (*end, bent))
            })
            .collect();
        let loops = piece
            .loops
            .iter()
            .map(|points| {
                let closed: Vec<DVec2> = points.iter().chain(points.first()).copied().collect();
                let mut bent = bend_polyline(&closed, &place, chord_mm);
                bent.pop();
                bent
            })
            .collect();
        Bent { chains, loops }
    }

    /// Follows chains across joins until each contour closes.
    fn link(&self, bent: &[Bent], options: &FitOptions) -> Vec<OutlineContour> {
        let n = bent.len();
        let mut contours = Vec::new();
        let mut used: Vec<Vec<bool>> = self.pieces.iter().map(|p| vec![false; p.chains.len()]).collect();
        let number = |i: usize, start: End| self.pieces[i].chains.iter().position(|c| c.start == start);
        for i in 0..n {
            for first in 0..self.pieces[i].chains.len() {
                if used[i][first] {
                    continue;
                }
                let (mut at, mut chain, mut laps) = (i, first, 0i32);
                let mut points = Vec::new();
                loop {
                    used[at][chain] = true;
                    let start = self.pieces[at].chains[chain].start;
                    let (end, run) = &bent[at].chains[&start];
                    let shift = DVec2::new(self.starts_mm[at] + f64::from(laps) * options.length_mm, 0.0);
                    points.extend(run[..run.len() - 1].iter().map(|p| *p + shift));
                    let (next, entry) = match *end {
                        End::Right(k) => (at + 1, End::Left(k)),
                        End::Left(k) => (at + n - 1, End::Right(k)),
                    };
                    laps += i32::from(matches!(end, End::Right(_)) && next == n)
                        - i32::from(matches!(end, End::Left(_)) && at == 0);
                    at = next % n;
                    chain = number(at, entry).expect("both sides of a join have the same endpoints");
                    if used[at][chain] {
                        break;
                    }
                }
                contours.push(OutlineContour { points, winding: laps });
            }
            let shift = DVec2::new(self.starts_mm[i], 0.0);
            contours.extend(bent[i].loops.iter().map(|points| OutlineContour {
                points: points.iter().map(|p| *p + shift).collect(),
                winding: 0,
            }));
        }
        contours
    }

    fn seams(&self, bent: &[Bent]) -> Vec<Seam> {
        let n = bent.len();
        let last_edge = |i: usize, end: End| -> DVec2 {
            // The edge that arrives at or leaves an endpoint, turned to point right.
            let direction = bent[i].chains.iter().find_map(|(start, (stop, run))| {
                if *start == end {
                    Some(run[1] - run[0])
                } else if *stop == end {
                    Some(run[run.len() - 1] - run[run.len() - 2])
                } else {
                    None
                }
            });
            let direction = direction.unwrap_or(DVec2::X);
            if direction.x < 0.0 { -direction } else { direction }
        };
        self.joints
            .iter()
            .enumerate()
            .map(|(i, joint)| {
                let j = (i + 1) % n;
                let turn = |k: usize| last_edge(i, End::Right(k)).angle_to(last_edge(j, End::Left(k))).abs();
                let after = (0..joint.targets.len()).map(turn).fold(0.0, f64::max);
                Seam {
                    u_mm: self.starts_mm[i] + self.pieces[i].width_mm * self.stretch,
                    before_deg: joint.before_deg,
                    after_deg: after.to_degrees(),
                    is_natural: joint.is_natural,
                }
            })
            .collect()
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

/// Halvings of an edge: a thousandth of an edge is as fine as any warp needs.
const MAX_DEPTH: u32 = 10;

/// The image of a polyline, with points added where the image of an edge bends away from its chord.
fn bend_polyline(points: &[DVec2], place: &impl Fn(DVec2) -> DVec2, chord_mm: f64) -> Vec<DVec2> {
    let mut bent = vec![place(points[0])];
    for w in points.windows(2) {
        let from = bent[bent.len() - 1];
        bend_edge((w[0], from), (w[1], place(w[1])), place, chord_mm, MAX_DEPTH, &mut bent);
    }
    bent
}

fn bend_edge(
    from: (DVec2, DVec2),
    to: (DVec2, DVec2),
    place: &impl Fn(DVec2) -> DVec2,
    chord_mm: f64,
    depth: u32,
    bent: &mut Vec<DVec2>,
) {
    // A bend may hide from the middle, so the quarters are looked at too.
    let strays = |t: f64| place(from.0.lerp(to.0, t)).distance(from.1.lerp(to.1, t)) > chord_mm;
    if depth > 0 && (strays(0.5) || strays(0.25) || strays(0.75)) {
        let middle = from.0.midpoint(to.0);
        let middle = (middle, place(middle));
        bend_edge(from, middle, place, chord_mm, depth - 1, bent);
        bend_edge(middle, to, place, chord_mm, depth - 1, bent);
    } else {
        bent.push(to.1);
    }
}
