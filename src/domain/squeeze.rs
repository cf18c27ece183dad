//! How far a band is squeezed on the inner side of a bend.
//!
//! At depth v on the inner side of a bend of curvature κ the curve's length shrinks by 1 − vκ, and at
//! v = 1/κ the band folds. Where it would come nearer to that than [`COMPRESSION`], v is replaced by
//! f(v) = v / (1 + k v): f(0) = 0, f'(0) = 1, f' = 1 / (1 + k v)² > 0, so that the middle of the band
//! keeps its scale and nothing changes order. The band's outermost v = V comes to lie at V / (1 + k V), which
//! is at most `COMPRESSION`/κ when k ≥ κ/`COMPRESSION` − 1/V.
//!
//! k follows the curvature along u as a smooth upper bound: the needed values on cells of u, each replaced by
//! the greatest one nearby, then averaged three times (two boxes and a quadratic spline). The spline is
//! once continuously differentiable, so the image has no kink, and as no average reaches further than the
//! maximum was taken, k is nowhere below what is needed.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use super::curve::PlanarCurve;
use super::error::DomainError;

/// The greatest v κ that is allowed: beside a bend at least 15 % of the length remains. Larger, and the ink
/// there is crushed; smaller, and bands are squeezed that need not be.
pub(super) const COMPRESSION: f64 = 0.85;
/// The least share of its reach to which a side may be squeezed. Smaller, and the ornament cannot be
/// recognised.
pub(super) const LEAST_SHARE: f64 = 0.4;
/// Cells of u per reach of the band.
const CELLS_PER_REACH: f64 = 16.0;
/// Bounds the memory for a hair-thin band on a long curve.
const MAX_CELLS: f64 = 200_000.0;

/// A side of a curve, seen in the direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// v > 0.
    Left,
    /// v < 0.
    Right,
}

impl Side {
    /// 1 on the left, −1 on the right: the sign of v there, and of the curvature of a bend towards it.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// A stretch where the band is squeezed on the inner side of a bend.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Squeeze {
    /// The inner side.
    pub side: Side,
    /// Where the squeeze begins along the curve, in mm.
    pub from_mm: f64,
    /// Where it ends, in mm; more than the curve's length when it passes the start of a closed curve.
    pub to_mm: f64,
    /// Where the curve bends most within, in mm along the curve.
    pub at_mm: f64,
    /// That place in the plane, x and y in mm.
    pub position_mm: [f64; 2],
    /// The radius of the curve there, in mm.
    pub radius_mm: f64,
    /// How far the band reaches to this side where it is not squeezed, in mm.
    pub reach_mm: f64,
    /// How far it reaches at the tightest place, in mm: at least 0.4 of `reach_mm`.
    pub squeezed_to_mm: f64,
}

/// k(u) of one side of a band.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    cell_mm: f64,
    closed: bool,
    /// k averaged, by cell; cell i is centred on i·`cell_mm`. Empty where nothing is squeezed.
    k: Vec<f64>,
}

/// The curve's hardest bend towards a side.
#[derive(Debug, Clone, Copy)]
struct Bend {
    at_mm: f64,
    /// Positive.
    curvature: f64,
}

impl Profile {
    /// The profile of the side of `curve` on which a band reaches out to `reach_mm`, and what it squeezes.
    ///
    /// # Errors
    /// [`DomainError::Fold`] where the side would be squeezed to less than [`LEAST_SHARE`].
    pub fn new(curve: &PlanarCurve, side: Side, reach_mm: f64) -> Result<(Self, Vec<Squeeze>), DomainError> {
        let length = curve.length_mm();
        let smooth_over = if curve.is_closed() { reach_mm.min(0.25 * length) } else { reach_mm };
        let cells = (length / smooth_over * CELLS_PER_REACH).clamp(8.0, MAX_CELLS).ceil() as usize;
        let mut profile = Self { cell_mm: length / cells as f64, closed: curve.is_closed(), k: Vec::new() };

        let hardest = bends(curve, side).max_by(|a, b| a.curvature.total_cmp(&b.curvature));
        let Some(hardest) = hardest.filter(|b| b.curvature * reach_mm > COMPRESSION) else {
            return Ok((profile, Vec::new()));
        };
        let radius_mm = hardest.curvature.recip();
        let allowed_mm = COMPRESSION * radius_mm / LEAST_SHARE;
        if reach_mm > allowed_mm {
            return Err(DomainError::Fold {
                position: curve.frame(hardest.at_mm).point,
                at_mm: hardest.at_mm,
                side,
                radius_mm,
                reach_mm,
                allowed_mm,
            });
        }

        let needed = profile.needed(curve, side, reach_mm, cells);
        let half_box = ((0.5 * smooth_over / profile.cell_mm).round() as usize).max(1);
        // Two boxes reach 2 · half_box cells, the spline 1.5 more, and a cell half of itself.
        profile.k = profile.greatest_within(&needed, 2 * half_box + 2);
        for _ in 0..2 {
            profile.k = profile.averaged_within(&profile.k, half_box);
        }
        let squeezes = profile.squeezes(curve, side, reach_mm);
        Ok((profile, squeezes))
    }

    /// k at `u`, which lies in the curve's range on a closed curve.
    pub fn k(&self, u: f64) -> f64 {
        if self.k.is_empty() {
            return 0.0;
        }
        let position = u / self.cell_mm;
        let nearest = position.round();
        let x = position - nearest;
        let nearest = nearest as isize;
        // The quadratic B-spline: three weights that are positive and sum to one.
        0.5 * (0.5 - x) * (0.5 - x) * self.at(&self.k, nearest - 1)
            + (0.75 - x * x) * self.at(&self.k, nearest)
            + 0.5 * (0.5 + x) * (0.5 + x) * self.at(&self.k, nearest + 1)
    }

    /// What each cell needs, from the exact curvature of all arcs that touch it.
    fn needed(&self, curve: &PlanarCurve, side: Side, reach_mm: f64, cells: usize) -> Vec<f64> {
        let n = if self.closed { cells } else { cells + 1 };
        let mut needed = vec![0.0; n];
        for (start, length, curvature) in curve.curvatures() {
            let k = (side.sign() * curvature / COMPRESSION - reach_mm.recip()).max(0.0);
            let first = (start / self.cell_mm).round() as usize;
            let last = ((start + length) / self.cell_mm).round() as usize;
            for i in first..=last {
                let cell = &mut needed[if self.closed { i % n } else { i.min(n - 1) }];
                *cell = k.max(*cell);
            }
        }
        needed
    }

    fn at(&self, values: &[f64], i: isize) -> f64 {
        let n = values.len() as isize;
        values[if self.closed { i.rem_euclid(n) } else { i.clamp(0, n - 1) } as usize]
    }

    fn greatest_within(&self, values: &[f64], reach: usize) -> Vec<f64> {
        self.combined(values, reach, |window| window.fold(0.0, f64::max))
    }

    fn averaged_within(&self, values: &[f64], reach: usize) -> Vec<f64> {
        let count = (2 * reach + 1) as f64;
        self.combined(values, reach, |window| window.sum::<f64>() / count)
    }

    fn combined(
        &self,
        values: &[f64],
        reach: usize,
        combine: impl Fn(&mut dyn Iterator<Item = f64>) -> f64,
    ) -> Vec<f64> {
        let reach = reach as isize;
        let window = |i: isize| combine(&mut (i - reach..=i + reach).map(|j| self.at(values, j)));
        (0..values.len() as isize).map(window).collect()
    }

    /// The runs of cells that are squeezed, in the order of u.
    fn squeezes(&self, curve: &PlanarCurve, side: Side, reach_mm: f64) -> Vec<Squeeze> {
        let n = self.k.len();
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for i in (0..n).filter(|&i| self.k[i] > 0.0) {
            match runs.last_mut() {
                Some((_, end)) if *end == i => *end = i + 1,
                _ => runs.push((i, i + 1)),
            }
        }
        if self.closed && runs.len() > 1 && runs[0].0 == 0 && runs[runs.len() - 1].1 == n {
            let (_, end) = runs.remove(0);
            runs.last_mut().expect("one is left").1 = n + end;
        }
        let length = curve.length_mm();
        let squeeze = |(first, end): (usize, usize)| {
            let from_mm = ((first as f64 - 0.5) * self.cell_mm).max(0.0);
            let to_mm = (end as f64 - 0.5) * self.cell_mm;
            let to_mm = match end {
                _ if end - first == n => length,
                _ if end <= n => to_mm.min(length),
                _ => to_mm,
            };
            let inside =
                |b: &Bend| (from_mm..=to_mm).contains(&b.at_mm) || b.at_mm + length <= to_mm && self.closed;
            let bend = bends(curve, side)
                .filter(inside)
                .max_by(|a, b| a.curvature.total_cmp(&b.curvature).then(b.at_mm.total_cmp(&a.at_mm)))?;
            Some(Squeeze {
                side,
                from_mm,
                to_mm,
                at_mm: bend.at_mm,
                position_mm: curve.frame(bend.at_mm).point.to_array(),
                radius_mm: bend.curvature.recip(),
                reach_mm,
                squeezed_to_mm: reach_mm / (1.0 + self.k(bend.at_mm) * reach_mm),
            })
        };
        runs.into_iter().filter_map(squeeze).collect()
    }
}

/// The bends of `curve` towards `side`, each at the middle of its arc.
fn bends(curve: &PlanarCurve, side: Side) -> impl Iterator<Item = Bend> + '_ {
    curve.curvatures().filter_map(move |(start, length, curvature)| {
        let curvature = side.sign() * curvature;
        (curvature > 0.0).then_some(Bend { at_mm: start + 0.5 * length, curvature })
    })
}
