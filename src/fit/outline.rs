//! The outline of a run of pieces: closed contours in band coordinates.

use glam::DVec2;

use super::placed::{FitError, FitOptions, Placed, Prepared, Sides};
use super::sound::Unsound;
use super::stitch::{Bent, StitchMethod};
use crate::pieces::{Catalogue, End};

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
    /// Whether a piece on either side was warped because rotation-invariant deformation did not hold.
    pub fell_back: bool,
}

/// A piece that rotation-invariant deformation would have broken, and that was warped instead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    /// The place of the piece in the run, from 0.
    pub place: usize,
    /// Its number in the catalogue.
    pub piece: usize,
    /// What would have been wrong.
    pub fault: Unsound,
}

/// The contours of a run of pieces.
#[derive(Debug, Clone)]
pub struct Outline {
    /// All contours.
    pub contours: Vec<OutlineContour>,
    /// The seams in order; the closing one of a ring last.
    pub seams: Vec<Seam>,
    /// The pieces that were warped in place of what was wanted.
    pub fallbacks: Vec<Fallback>,
    /// How the other pieces were bent.
    pub method: StitchMethod,
    /// What the lengths of the pieces were multiplied by.
    pub stretch: f64,
    /// How far up the run was moved before that, so that it lies in the middle of the band, in millimetres.
    pub lift_mm: f64,
    /// What heights were multiplied by, so that the run fits the band; at most 1 unless it is to fill the band.
    pub squash: f64,
}

impl Outline {
    /// The outline of `sequence`.
    ///
    /// # Errors
    /// [`FitError`] when the sequence is no run of the catalogue.
    pub fn new(catalogue: &Catalogue, sequence: &[usize], options: &FitOptions) -> Result<Self, FitError> {
        Self::prepared(catalogue, sequence, options, &mut Prepared::new())
    }

    /// The same outline, with what is `prepared` for this catalogue used, and added to.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn prepared(
        catalogue: &Catalogue,
        sequence: &[usize],
        options: &FitOptions,
        prepared: &mut Prepared,
    ) -> Result<Self, FitError> {
        let placed = Placed::new(catalogue, sequence, options)?;
        let chord_mm = options.chord_mm / placed.stretch.max(1.0);
        let mut fallbacks = Vec::new();
        let bent: Vec<Bent> = (0..sequence.len())
            .map(|place| {
                let (bent, fault) = placed.bend(place, options.stitch, prepared, chord_mm);
                fallbacks.extend(fault.map(|fault| Fallback { place, piece: sequence[place], fault }));
                placed.stretched(bent)
            })
            .collect();
        let contours = placed.link(&bent, options);
        let seams = placed.seams(&bent, &fallbacks);
        let mut outline = Self {
            contours,
            seams,
            fallbacks,
            method: placed.method(options.stitch),
            stretch: placed.stretch,
            squash: 1.0,
            lift_mm: 0.0,
        };
        outline.fit_height(options.height_mm, options.sides);
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
            Sides::Held | Sides::Joined => return,
            Sides::Free if low >= -half && high <= half => return,
            Sides::Free => fits.min(1.0),
            Sides::Filled => fits,
        };
        self.lift_mm = -(low + high) / 2.0;
        for point in self.contours.iter_mut().flat_map(|c| &mut c.points) {
            point.y = (point.y + self.lift_mm) * self.squash;
        }
    }
}

impl Placed<'_> {
    fn stretched(&self, mut bent: Bent) -> Bent {
        bent.chains.iter_mut().chain(&mut bent.loops).flatten().for_each(|p| p.x *= self.stretch);
        bent
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
                    let (end, run) = (self.pieces[at].chains[chain].end, &bent[at].chains[chain]);
                    let shift = DVec2::new(self.starts_mm[at] + f64::from(laps) * options.length_mm, 0.0);
                    points.extend(run[..run.len() - 1].iter().map(|p| *p + shift));
                    let (next, entry) = match end {
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

    fn seams(&self, bent: &[Bent], fallbacks: &[Fallback]) -> Vec<Seam> {
        let n = bent.len();
        let last_edge = |i: usize, end: End| -> DVec2 {
            // The edge that arrives at or leaves an endpoint, turned to point right.
            let chains = self.pieces[i].chains.iter().zip(&bent[i].chains);
            let direction = chains.into_iter().find_map(|(chain, run)| {
                if chain.start == end {
                    Some(run[1] - run[0])
                } else if chain.end == end {
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
                    fell_back: fallbacks.iter().any(|f| f.place == i || f.place == j),
                }
            })
            .collect()
    }
}
