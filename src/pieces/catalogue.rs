//! The catalogue: pieces, and the table of what each join costs.

use std::cmp::Ordering;
use std::ops::Range;

use thiserror::Error;

use super::cut_up::{Rim, cut_up};
use super::mirror::mirrored;
use super::piece::{Endpoint, Piece};
use super::seam::{Side, misfit, weakness};
use crate::planar::Region;
use crate::reeb::Cut;
use crate::topology::Descriptor;

/// How a join is weighed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostWeights {
    /// The weight α of positions against tangents, 0 to 1 (Zhou 2014 §3.6.1 uses 0.8).
    pub alpha: f64,
    /// The cost λ of a jump, which is a successor that is not the exemplar's own next piece. 0 is the paper,
    /// which then favours short cycles repeated many times. Positions are weighed in units of 1/60 of the
    /// exemplar's longer side, so that a cost does not depend on the size of the drawing.
    pub jump: f64,
    /// The cost of a join that moves the run up or down by the exemplar's height; it grows with the square. The
    /// paper has no such term and leaves bands that climb to the fit; 0 is the paper.
    pub rise: f64,
    /// The cost of a jump whose worst strand has the misfit 1 (see [`Join::misfit`]); it grows with the square. The
    /// paper has no such term; 0 is the paper.
    pub misfit: f64,
    /// Jumps with a greater misfit are left out. The paper leaves none out: infinite.
    pub worst_misfit: f64,
    /// The cost of a jump where the seam hangs by a hair (see [`Join::weakness`]). The paper has no such term; 0 is the
    /// paper.
    pub weakness: f64,
    /// How many successors of each piece are kept: the cheapest, and always the exemplar's own next piece. With
    /// mirrored pieces, so many of its own orientation and so many of the other, so that none is lost to them.
    pub successors: usize,
}

/// A weight out of range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{name} is {value}; it must be {wanted}")]
pub struct CostWeightsError {
    /// The parameter.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What would be accepted.
    pub wanted: &'static str,
}

impl Default for CostWeights {
    fn default() -> Self {
        Self {
            alpha: 0.8,
            jump: 1.0,
            rise: 50.0,
            misfit: 0.0,
            worst_misfit: f64::INFINITY,
            weakness: 0.0,
            successors: 16,
        }
    }
}

impl CostWeights {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`CostWeightsError`] names the parameter that is not a number in range.
    pub fn validate(&self) -> Result<(), CostWeightsError> {
        if !(0.0..=1.0).contains(&self.alpha) {
            return Err(CostWeightsError { name: "alpha", value: self.alpha, wanted: "from 0 to 1" });
        }
        if !(0.0..=1000.0).contains(&self.jump) {
            return Err(CostWeightsError { name: "jump-cost", value: self.jump, wanted: "from 0 to 1000" });
        }
        Ok(())
    }
}

/// The join of a piece to a successor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// The successor.
    pub to: usize,
    /// D(i, j) of Zhou 2014 §3.6.1, what the rise costs, and λ and what misfit and weakness cost if this is a jump.
    pub cost: f64,
    /// The vertical offset τ that aligns the successor best, in millimetres: added to the offset of the piece
    /// it gives the successor's.
    pub rise_mm: f64,
    /// How badly the worst strand fits: 0 where all go straight on, and 1 where one lies beside the other by the width
    /// of the narrower, is twice as wide, or turns back. The reflection of a side has at most 1.
    pub misfit: f64,
    /// How weak the seam is: 0 where much ink holds it and nothing beside it is narrow, 1 where it hangs by a hair, 2
    /// where the cut also leaves a sliver of a strand over.
    pub weakness: f64,
    /// Whether the successor is the exemplar's own next piece.
    pub is_natural: bool,
}

/// Where a piece comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Its number in the exemplar, from 0 at the left.
    pub index: usize,
    /// Whether it is shown left for right.
    pub is_mirrored: bool,
}

/// The pieces of an exemplar and the joins between them.
///
/// Pieces 0 to n − 1 are the exemplar's, from left to right. With mirrored pieces, n + i is piece i left for
/// right; in the mirror, the exemplar begins with piece 2n − 1 and ends with piece n.
#[derive(Debug, Clone)]
pub struct Catalogue {
    pieces: Vec<Piece>,
    /// The number n of pieces of the exemplar.
    originals: usize,
    descriptors: Vec<Descriptor>,
    joins: Vec<Vec<Join>>,
    width_mm: f64,
    height_mm: f64,
    own_ends_only: bool,
}

/// How many jumps a join costs that sets the end of the exemplar beside its beginning with a gap between them.
const JUMPS_OF_A_BREAK: f64 = 5.0;
/// The side of the exemplar on which costs were tuned; positions are weighed as if the exemplar had it.
const REFERENCE_MM: f64 = 60.0;

impl Catalogue {
    /// Cuts `region` at `cuts` and weighs every join.
    pub fn new(region: &Region, cuts: &[Cut], weights: &CostWeights) -> Self {
        Self::of(cut_up(region, cuts, Rim::Apart), false, region, weights)
    }

    /// As [`Self::new`], with every piece a second time, mirrored left for right.
    pub fn with_mirrored(region: &Region, cuts: &[Cut], weights: &CostWeights) -> Self {
        Self::of(cut_up(region, cuts, Rim::Apart), true, region, weights)
    }

    /// As [`Self::with_mirrored`], of a sheet whose lower and upper side are one place.
    pub fn rolled(region: &Region, cuts: &[Cut], weights: &CostWeights) -> Self {
        Self::of(cut_up(region, cuts, Rim::Joined), true, region, weights)
    }

    fn of(mut pieces: Vec<Piece>, is_mirrored: bool, region: &Region, weights: &CostWeights) -> Self {
        let (low, high) = region.bounds_mm().unwrap_or_default();
        let size = high - low;
        let originals = pieces.len();
        if is_mirrored {
            let total_mm = pieces.last().map_or(0.0, |p| p.x_mm + p.width_mm);
            pieces.extend((0..originals).map(|i| mirrored(&pieces[i], total_mm)).collect::<Vec<_>>());
        }
        let descriptors = pieces.iter().map(|p| p.descriptor.clone()).collect();
        let mut catalogue = Self {
            pieces,
            originals,
            descriptors,
            joins: Vec::new(),
            width_mm: size.x,
            height_mm: size.y,
            own_ends_only: false,
        };
        let scale = Scale { longer_mm: size.max_element(), height_mm: size.y };
        let lefts: Vec<Side<'_>> = catalogue.pieces.iter().map(Side::left).collect();
        let joins = catalogue.pieces.iter().enumerate();
        let joins =
            joins.map(|(from, piece)| catalogue.joins_from(from, Side::right(piece), &lefts, scale, weights));
        catalogue.joins = joins.collect();
        catalogue
    }

    /// The number of pieces of the exemplar, without mirrored ones.
    pub fn originals(&self) -> usize {
        self.originals
    }

    /// Where a piece comes from.
    pub fn origin(&self, piece: usize) -> Origin {
        if piece < self.originals {
            Origin { index: piece, is_mirrored: false }
        } else {
            Origin { index: piece - self.originals, is_mirrored: true }
        }
    }

    /// The piece that follows in the exemplar or, after a mirrored piece, in its mirror image; `None` at the end.
    pub fn natural_next(&self, piece: usize) -> Option<usize> {
        match self.origin(piece) {
            Origin { index, is_mirrored: false } => (index + 1 < self.originals).then_some(piece + 1),
            Origin { index, is_mirrored: true } => (index > 0).then_some(piece - 1),
        }
    }

    /// Whether the exemplar, or its mirror image, begins with this piece.
    pub fn is_own_begin(&self, piece: usize) -> bool {
        match self.origin(piece) {
            Origin { index, is_mirrored: false } => index == 0,
            Origin { index, is_mirrored: true } => index + 1 == self.originals,
        }
    }

    /// Whether the exemplar, or its mirror image, ends with this piece.
    pub fn is_own_end(&self, piece: usize) -> bool {
        self.natural_next(piece).is_none()
    }

    /// The pieces: the exemplar's in its order, then the mirrored ones, if there are any, in the same order.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The descriptors of the pieces.
    pub fn descriptors(&self) -> &[Descriptor] {
        &self.descriptors
    }

    /// The joins that may follow each piece, cheapest first.
    pub fn joins(&self) -> &[Vec<Join>] {
        &self.joins
    }

    /// The join from one piece to another, if it was kept.
    pub fn join(&self, from: usize, to: usize) -> Option<&Join> {
        self.joins[from].iter().find(|j| j.to == to)
    }

    /// The joins of a sequence, in order, of those that were kept.
    pub fn joins_of(&self, sequence: &[usize]) -> impl Iterator<Item = &Join> {
        sequence.windows(2).filter_map(|pair| self.join(pair[0], pair[1]))
    }

    /// The number of joins of a sequence at which the exemplar does not go on as it is.
    pub fn jumps_of(&self, sequence: &[usize]) -> usize {
        self.joins_of(sequence).filter(|join| !join.is_natural).count()
    }

    /// The same catalogue for open runs that begin and end as the exemplar does.
    pub fn with_own_ends_only(mut self) -> Self {
        self.own_ends_only = true;
        self
    }

    /// Whether open runs may only begin and end as the exemplar does, or its mirror image.
    pub fn has_own_ends_only(&self) -> bool {
        self.own_ends_only
    }

    /// The width of the exemplar in millimetres.
    pub fn width_mm(&self) -> f64 {
        self.width_mm
    }

    /// The height of the exemplar in millimetres.
    pub fn height_mm(&self) -> f64 {
        self.height_mm
    }

    fn joins_from(
        &self,
        from: usize,
        side: Side<'_>,
        lefts: &[Side<'_>],
        scale: Scale,
        weights: &CostWeights,
    ) -> Vec<Join> {
        let right = side.endpoints();
        let natural = self.natural_next(from);
        // A piece after itself is the shortest of the degenerate cycles; slicing by events never allows it
        // (Zhou 2014 §5.2), uniform slicing would.
        let fits = |&to: &usize| to != from && lefts[to].portals() == side.portals();
        let join = |to: usize| {
            let is_natural = natural == Some(to);
            let left = lefts[to].endpoints();
            let (cost, rise_mm) = join_cost(right, left, scale.unit_mm(), weights.alpha);
            // An empty join inside the exemplar is one of its own gaps; at its ends it is a break that the
            // exemplar does not have.
            let is_break = right.is_empty() && (self.is_own_end(from) || self.is_own_begin(to));
            let jumps = if is_natural {
                0.0
            } else if is_break {
                JUMPS_OF_A_BREAK
            } else {
                1.0
            };
            let jump = weights.jump * jumps;
            let rise = weights.rise * (rise_mm / scale.height_mm).powi(2);
            let (misfit, weakness) = match is_natural {
                true => (0.0, 0.0),
                false => (misfit(right, left), weakness(side, lefts[to], scale.longer_mm, scale.height_mm)),
            };
            let seam = weights.misfit * misfit.powi(2) + weights.weakness * weakness;
            Join { to, cost: cost + jump + rise + seam, rise_mm, misfit, weakness, is_natural }
        };
        let is_allowed = |join: &Join| join.misfit <= weights.worst_misfit;
        let of_one_orientation = |range: Range<usize>| {
            let mut joins: Vec<Join> = range.filter(fits).map(join).filter(is_allowed).collect();
            joins.sort_by(Join::order);
            let natural = joins.iter().position(|j| j.is_natural);
            if let Some(late) = natural.filter(|&at| at >= weights.successors) {
                joins.swap(late, weights.successors.saturating_sub(1));
            }
            joins.truncate(weights.successors.max(1));
            joins
        };
        let mut joins = of_one_orientation(0..self.originals);
        joins.extend(of_one_orientation(self.originals..lefts.len()));
        joins.sort_by(Join::order);
        joins
    }
}

impl Join {
    /// Cheaper first, then by number.
    fn order(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(self.to.cmp(&other.to))
    }
}

/// What positions are measured in.
#[derive(Clone, Copy)]
struct Scale {
    /// The exemplar's longer side.
    longer_mm: f64,
    /// The exemplar's height.
    height_mm: f64,
}

impl Scale {
    fn unit_mm(self) -> f64 {
        self.longer_mm / REFERENCE_MM
    }
}

/// α d_match + (1 − α) d_tangent and the best offset τ (Zhou 2014 §3.6.1).
///
/// d_match is the mean squared distance of endpoints after the best vertical offset, in square units;
/// d_tangent sums 1 − cos of the angle between tangents over the endpoints. Without portals both are 0.
fn join_cost(right: &[Endpoint], left: &[Endpoint], unit_mm: f64, alpha: f64) -> (f64, f64) {
    if right.is_empty() {
        return (0.0, 0.0);
    }
    let n = right.len() as f64;
    let pairs = || right.iter().zip(left);
    let rise_mm = pairs().map(|(r, l)| r.y_mm - l.y_mm).sum::<f64>() / n;
    let squares: f64 = pairs().map(|(r, l)| (l.y_mm - r.y_mm + rise_mm).powi(2)).sum();
    let d_match = squares / n / (unit_mm * unit_mm);
    let d_tangent: f64 = pairs().map(|(r, l)| (1.0 - r.tangent.dot(l.tangent)).abs()).sum();
    (alpha * d_match + (1.0 - alpha) * d_tangent, rise_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn side(ys: &[f64], angle: f64) -> Vec<Endpoint> {
        ys.iter().map(|&y_mm| Endpoint { y_mm, tangent: DVec2::from_angle(angle) }).collect()
    }

    #[test]
    fn the_best_offset_is_free_and_the_rest_is_not() {
        let right = side(&[3.0, 1.0], 0.0);
        let (cost, rise) = join_cost(&right, &side(&[2.5, 0.5], 0.0), 1.0, 0.8);
        assert!(cost.abs() < 1e-12 && (rise - 0.5).abs() < 1e-12);
        // One portal 0.4 wider: each end is off by 0.2.
        let (cost, rise) = join_cost(&right, &side(&[3.2, 0.8], 0.0), 1.0, 0.8);
        assert!((cost - 0.8 * 0.04).abs() < 1e-12 && rise.abs() < 1e-12);
        // Tangents 60 degrees apart at two endpoints: 2 (1 - 1/2).
        let (cost, _) = join_cost(&right, &side(&[3.0, 1.0], 60f64.to_radians()), 1.0, 0.8);
        assert!((cost - 0.2).abs() < 1e-12);
        // Twice the size in twice the unit costs the same.
        let (large, _) = join_cost(&side(&[6.0, 2.0], 0.0), &side(&[6.4, 1.6], 0.0), 2.0, 0.8);
        assert!((large - 0.8 * 0.04).abs() < 1e-12);
    }
}
