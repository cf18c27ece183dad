//! Where the exemplar is cut.
//!
//! Between each two neighbouring events that matter, one cut: where the narrowest portal and gap are widest
//! and the contours cross the line most squarely (a slanted crossing makes a kink when pieces of other
//! slants follow). Zhou 2014 §5.2 takes the middle instead. Where no event is for long, there are several: three
//! strands without an event would else be one piece, which nothing can follow. Cuts too close for a piece
//! between them are thinned out, the best ones staying. A cut whose narrowest portal is under the minimum feature is
//! dropped (§5.2.1); uniform slicing (§5.1) takes equally spaced lines. Neither cuts inside a [`KeptRange`].

use std::cmp::Ordering;
use std::collections::BTreeMap;

use thiserror::Error;

use super::graph::ReebGraph;
use super::intervals::{Interval, event_intervals, uniform_intervals};
use super::kept::{Kept, KeptRange};
use super::section::{CrossSections, Crossing};
use crate::planar::{Region, Tolerances};

/// How the positions of cuts are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlicingRule {
    /// One cut between neighbouring events whose persistence and distance are at least this many millimetres.
    Reeb {
        /// The least persistence, and the least distance between events with a cut between them.
        persistence_mm: f64,
    },
    /// So many equally spaced cuts (Zhou 2014 §5.1).
    Uniform {
        /// The number of cuts.
        lines: usize,
    },
}

impl SlicingRule {
    /// The default threshold of persistence, as a part of the exemplar's width. Larger, and short motifs are
    /// never cut apart; smaller, and noise on the outline makes pieces.
    pub const DEFAULT_PERSISTENCE: f64 = 0.002;

    /// Slicing by events with the default threshold for an exemplar of this width.
    pub fn reeb_for_width(width_mm: f64) -> Self {
        Self::Reeb { persistence_mm: Self::DEFAULT_PERSISTENCE * width_mm }
    }
}

/// A vertical cutting line.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// The position in steps of the region's grid; no vertex has this x.
    pub x: i64,
    /// Where it crosses the contours, from top to bottom: portal j lies between crossings 2j and 2j + 1.
    pub crossings: Vec<Crossing>,
}

impl Cut {
    /// The number of portals.
    pub fn portals(&self) -> usize {
        self.crossings.len() / 2
    }

    /// The height of the narrowest portal in millimetres; infinite without portals.
    pub fn narrowest_portal_mm(&self) -> f64 {
        narrowest_portal_mm(&self.crossings)
    }
}

fn narrowest_portal_mm(crossings: &[Crossing]) -> f64 {
    crossings.chunks_exact(2).map(|p| p[0].y_mm - p[1].y_mm).fold(f64::INFINITY, f64::min)
}

/// Why there is no cut between two neighbouring events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutDropped {
    /// Where the cut would have been best, in millimetres from the left edge of the ink.
    pub x_mm: f64,
    /// The height of its narrowest portal.
    pub portal_mm: f64,
}

/// The cuts of an exemplar.
#[derive(Debug, Clone)]
pub struct Slicing {
    /// The cuts, ascending in x.
    pub cuts: Vec<Cut>,
    /// Cuts left out as their narrowest portal is thinner than the minimum feature.
    pub dropped: Vec<CutDropped>,
    /// Places where a cut was wanted and none could be: contours run along it, or nearly touch on it.
    pub missed: usize,
    /// Places where a cut was wanted and a kept range forbids it.
    pub kept_whole: usize,
}

/// Why an exemplar cannot be sliced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SlicingError {
    /// A parameter out of range.
    #[error("{name} is {value}; it must be {wanted}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would be accepted.
        wanted: &'static str,
    },
    /// Every possible cut has a portal thinner than the minimum feature.
    #[error(
        "every cut passes through ink thinner than --min-feature {min_feature_mm} mm: the best one, at x = {x_mm:.2} mm, through {portal_mm:.3} mm; scale the ornament up with --width, choose another exemplar, or lower --min-feature"
    )]
    TooThin {
        /// What was asked for.
        min_feature_mm: f64,
        /// The cut with the widest narrowest portal, from the left edge of the ink.
        x_mm: f64,
        /// The height of that portal.
        portal_mm: f64,
    },
    /// A range to keep that is none.
    #[error("--keep {from_mm:.2}mm..{to_mm:.2}mm {fault}; the exemplar is {width_mm:.2} mm wide")]
    Kept {
        /// Where the range begins.
        from_mm: f64,
        /// Where it ends.
        to_mm: f64,
        /// What is wrong with it, and what would work.
        fault: &'static str,
        /// The width of the exemplar's ink.
        width_mm: f64,
    },
    /// Every place for a cut is in a kept range.
    #[error(
        "--keep leaves no place for a cut in the exemplar, which is {width_mm:.2} mm wide; keep less of it"
    )]
    AllKept {
        /// The width of the exemplar's ink.
        width_mm: f64,
    },
}

/// No cut through more strands than this: their partitions could not be told apart in any time.
const MOST_PORTALS: usize = 4096;
/// No cut where a contour runs along it more steeply than this (cosine of 78 degrees): a strand that is cut
/// along its length cannot be joined to another without a kink.
const LEAST_SQUARENESS: f64 = 0.2;
/// The parts of an interval in which distances from its middle are told apart.
const ASIDE_PARTS: f64 = 96.0;
/// Portals closer than this part of the exemplar's height are not told apart, and no cut is placed there.
const SEPARATION: f64 = 1e-6;

impl Slicing {
    /// The cuts of `region` by `rule`.
    ///
    /// # Errors
    /// [`SlicingError`] for parameters out of range, and when the minimum feature leaves no cut.
    pub fn new(
        region: &Region,
        reeb: &ReebGraph,
        rule: SlicingRule,
        tolerances: &Tolerances,
    ) -> Result<Self, SlicingError> {
        Self::keeping(region, reeb, rule, &[], tolerances)
    }

    /// The cuts of `region` by `rule`, none of them inside a range of `kept`.
    ///
    /// # Errors
    /// [`SlicingError`] for parameters and ranges out of range, and when the minimum feature or the ranges leave
    /// no cut.
    pub fn keeping(
        region: &Region,
        reeb: &ReebGraph,
        rule: SlicingRule,
        kept: &[KeptRange],
        tolerances: &Tolerances,
    ) -> Result<Self, SlicingError> {
        let mut chosen = Self { cuts: Vec::new(), dropped: Vec::new(), missed: 0, kept_whole: 0 };
        let Some((low, high)) = region.bounds_mm() else {
            return Ok(chosen);
        };
        let grid = region.grid();
        let kept = Kept::new(kept, grid, (low.x, high.x))?;
        let sections = CrossSections::new(region);
        let (left, right) = (grid.steps(low.x), grid.steps(high.x));
        let mut shortest = 0;
        let wanted = match rule {
            SlicingRule::Uniform { lines } => uniform_intervals(lines, left, right)?,
            SlicingRule::Reeb { persistence_mm } => {
                if !(0.0..=high.x - low.x).contains(&persistence_mm) {
                    let wanted = "from 0 to the width of the exemplar";
                    return Err(SlicingError::Parameter {
                        name: "persistence",
                        value: persistence_mm,
                        wanted,
                    });
                }
                shortest = grid.steps(persistence_mm).max(1);
                event_intervals(reeb, shortest, high.y - low.y, grid)
            }
        };
        let intervals: Vec<Interval> = wanted.iter().filter_map(|interval| interval.outside(&kept)).collect();
        chosen.kept_whole = wanted.len() - intervals.len();
        let min_feature_mm = tolerances.min_feature_mm();
        let limits = Limits { height_mm: high.y - low.y, min_feature_mm, centre: (left + right) / 2 };
        let best = best_cuts(&sections, &intervals, &kept, limits);
        for cut in spread(best, (left, right), shortest) {
            let portal_mm = cut.narrowest_portal_mm();
            if portal_mm < tolerances.min_feature_mm() {
                chosen.dropped.push(CutDropped { x_mm: grid.mm(cut.x) - low.x, portal_mm });
            } else {
                chosen.cuts.push(cut);
            }
        }
        chosen.missed = intervals.len() - chosen.cuts.len() - chosen.dropped.len();
        chosen.leave_out_blank_pieces(&sections);
        if chosen.cuts.is_empty() && chosen.dropped.is_empty() && chosen.kept_whole > 0 {
            return Err(SlicingError::AllKept { width_mm: high.x - low.x });
        }
        match chosen.dropped.iter().max_by(|a, b| a.portal_mm.total_cmp(&b.portal_mm)) {
            Some(widest) if chosen.cuts.is_empty() => Err(SlicingError::TooThin {
                min_feature_mm: tolerances.min_feature_mm(),
                x_mm: widest.x_mm,
                portal_mm: widest.portal_mm,
            }),
            _ => Ok(chosen),
        }
    }

    /// Between two empty cuts with nothing between them there is no ink to make a piece of. Of the cuts of one
    /// gap the middle one stays, so that the mirrored exemplar keeps the same.
    fn leave_out_blank_pieces(&mut self, sections: &CrossSections<'_>) {
        let mut at = 0;
        while at < self.cuts.len() {
            let is_same_gap = |cut: &Cut, next: &Cut| {
                next.crossings.is_empty() && !sections.has_vertex_between(cut.x, next.x)
            };
            let mut end = at + 1;
            if self.cuts[at].crossings.is_empty() {
                while end < self.cuts.len() && is_same_gap(&self.cuts[end - 1], &self.cuts[end]) {
                    end += 1;
                }
            }
            let middle = (at + end - 1) / 2;
            self.cuts.drain(middle + 1..end);
            self.cuts.drain(at..middle);
            at += 1;
        }
    }
}

/// What a cut must keep to.
#[derive(Clone, Copy)]
struct Limits {
    /// The height of the exemplar.
    height_mm: f64,
    /// A cut through thinner ink will be dropped, so any other is better.
    min_feature_mm: f64,
    /// The middle of the exemplar.
    centre: i64,
}

/// The best cut of each interval that has one, ascending, with its merit.
fn best_cuts(
    sections: &CrossSections<'_>,
    intervals: &[Interval],
    kept: &Kept,
    limits: Limits,
) -> Vec<(Cut, Merit)> {
    let mut xs = Vec::new();
    for interval in intervals {
        let clear = |&x: &i64| sections.clear_of_vertices(x, interval.low, interval.high);
        xs.extend(interval.tries.iter().filter_map(clear).filter(|&x| !kept.forbids(x)));
    }
    xs.sort_unstable();
    xs.dedup();
    let mut cuts: Vec<Option<Cut>> =
        sections.at(&xs).into_iter().zip(&xs).map(|(crossings, &x)| Some(Cut { x, crossings })).collect();
    let mut chosen = Vec::with_capacity(intervals.len());
    for interval in intervals {
        let range = xs.partition_point(|&x| x <= interval.low)..xs.partition_point(|&x| x < interval.high);
        let best = range
            .filter_map(|i| Some((i, Merit::new(cuts[i].as_ref()?, interval, limits)?)))
            .max_by(|a, b| a.1.order(&b.1));
        if let Some((i, merit)) = best {
            chosen.extend(cuts[i].take().map(|cut| (cut, merit)));
        }
    }
    chosen
}

/// Leaves out the worse of two cuts closer than `shortest`, and cuts so close to an end of the exemplar: what
/// lies between is too narrow to be a piece. The best choose first, so that neither end of the exemplar does.
fn spread(mut cuts: Vec<(Cut, Merit)>, (left, right): (i64, i64), shortest: i64) -> Vec<Cut> {
    cuts.retain(|(cut, _)| (cut.x - left).min(right - cut.x) >= shortest);
    cuts.sort_by(|(a, better), (b, worse)| worse.order(better).then(a.x.cmp(&b.x)));
    let mut kept: BTreeMap<i64, Cut> = BTreeMap::new();
    for (cut, _) in cuts {
        let is_apart = shortest == 0 || kept.range(cut.x - shortest + 1..cut.x + shortest).next().is_none();
        if is_apart {
            kept.insert(cut.x, cut);
        }
    }
    kept.into_values().collect()
}

/// How good a cut is.
#[derive(Clone, Copy)]
struct Merit {
    is_thick_enough: bool,
    /// In parts of a thousand: of what is as good in a mirror neither may be better by the noise of a drawing.
    score: i64,
    /// How far it is from the middle of its interval, in parts of the interval.
    aside: i64,
    /// How far it is from the middle of the exemplar: of two equal places in a symmetric motif, a mirror must
    /// show the same one.
    outward: i64,
}

impl Merit {
    /// `None` where there can be no cut.
    fn new(cut: &Cut, interval: &Interval, limits: Limits) -> Option<Self> {
        let crossings = &cut.crossings;
        let apart = crossings.windows(2).all(|w| w[0].y_mm - w[1].y_mm > SEPARATION * limits.height_mm);
        let square = crossings.iter().all(|c| c.tangent.x >= LEAST_SQUARENESS);
        let is_thick_enough = cut.narrowest_portal_mm() >= limits.min_feature_mm;
        let aside = (cut.x - (interval.low + interval.high) / 2).abs() as f64;
        let parts = ASIDE_PARTS / (interval.high - interval.low) as f64;
        (apart && square && cut.portals() <= MOST_PORTALS).then(|| Self {
            is_thick_enough,
            score: (1000.0 * score(crossings, limits.height_mm).ln()).round() as i64,
            aside: (aside * parts).round() as i64,
            outward: (cut.x - limits.centre).abs(),
        })
    }

    fn order(&self, other: &Self) -> Ordering {
        self.is_thick_enough
            .cmp(&other.is_thick_enough)
            .then(self.score.cmp(&other.score))
            .then(other.aside.cmp(&self.aside))
            .then(other.outward.cmp(&self.outward))
    }
}

/// How good a cut is: the thickness of the thinnest portal or gap in parts of the exemplar, less where contours cross at a slant.
///
/// Thickness is measured across the strand. Along the cut, a strand that runs beside it would pass for a thick
/// one, and cuts would be drawn to the places that are worst for them. Its root counts, as a slant shows more
/// at a seam than a strand that is a little thinner.
fn score(crossings: &[Crossing], height_mm: f64) -> f64 {
    if crossings.is_empty() {
        return f64::INFINITY;
    }
    let thickness = |w: &[Crossing]| (w[0].y_mm - w[1].y_mm) / height_mm * w[0].tangent.x.min(w[1].tangent.x);
    let thinnest = crossings.windows(2).map(thickness).fold(f64::INFINITY, f64::min);
    let mean = crossings.iter().map(|c| c.tangent.x).sum::<f64>() / crossings.len() as f64;
    let worst = crossings.iter().map(|c| c.tangent.x).fold(1.0, f64::min);
    thinnest.sqrt() * mean * (0.2 + 0.8 * worst)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid, GridPoint};

    /// The unit of the drawings: a millimetre in steps of their grid.
    const MM: i64 = 1 << 26;

    fn region(paths: &[&[(i64, i64)]]) -> Region {
        let paths: Vec<Vec<GridPoint>> =
            paths.iter().map(|p| p.iter().map(|&(x, y)| GridPoint::new(x * MM, y * MM)).collect()).collect();
        Region::fill(Grid::for_extent(128.0).unwrap(), &paths, FillRule::EvenOdd)
    }

    fn cuts(region: &Region, persistence_mm: f64, min_feature_mm: f64) -> Vec<(f64, usize)> {
        let tolerances = Tolerances::new(0.01, min_feature_mm, 0.0).unwrap();
        let rule = SlicingRule::Reeb { persistence_mm };
        let found = Slicing::new(region, &ReebGraph::new(region), rule, &tolerances).unwrap();
        found.cuts.iter().map(|c| (region.grid().mm(c.x), c.portals())).collect()
    }

    #[test]
    fn a_strand_is_cut_where_it_is_level_and_not_where_it_is_steep() {
        // Level, then steep and three times as tall along the cut, but no thicker.
        let strand: &[(i64, i64)] = &[(0, 40), (0, 42), (10, 42), (20, 82), (20, 74), (11, 40)];
        let found = cuts(&region(&[strand]), 0.2, 0.0);
        assert!(found.iter().all(|&(x, _)| x < 10.0), "{found:?}");
    }

    #[test]
    fn long_strands_are_cut_again_and_again() {
        let bar = |y: i64| [(0, y), (90, y), (90, y + 2), (0, y + 2)];
        let found = cuts(&region(&[&bar(0), &bar(6), &bar(12)]), 0.2, 0.0);
        // 90 mm in parts of half of the height of 14 mm.
        assert_eq!(found.len(), 12);
        assert!(found.iter().all(|&(_, portals)| portals == 3));
        let gaps: Vec<f64> = found.windows(2).map(|w| w[1].0 - w[0].0).collect();
        assert!(gaps.iter().all(|&g| g > 14.0 / 6.0), "{gaps:?}");
    }

    #[test]
    fn no_piece_is_narrower_than_the_threshold() {
        // Steps in a bar's end and a hole close to them: events 1 mm apart.
        let bar: &[(i64, i64)] = &[(0, 0), (60, 0), (59, 4), (60, 8), (1, 8), (2, 5)];
        let hole: &[(i64, i64)] = &[(3, 6), (5, 7), (4, 5)];
        let region = region(&[bar, hole]);
        for persistence_mm in [0.5, 0.9, 1.9] {
            let found = cuts(&region, persistence_mm, 0.0);
            let edges: Vec<f64> = [0.0].into_iter().chain(found.iter().map(|c| c.0)).chain([60.0]).collect();
            assert!(edges.windows(2).all(|w| w[1] - w[0] >= persistence_mm), "{edges:?}");
        }
    }

    #[test]
    fn ink_that_is_thick_enough_is_cut_rather_than_ink_that_is_square() {
        // Level and 1 mm thick on the left, sloping and at least 2 mm thick on the right.
        let strand: &[(i64, i64)] = &[(0, 20), (0, 21), (9, 21), (19, 31), (19, 26), (10, 20)];
        let thin = cuts(&region(&[strand]), 0.2, 0.0);
        let thick = cuts(&region(&[strand]), 0.2, 1.5);
        assert!(thin.iter().any(|c| c.0 < 9.0) && thick.iter().all(|c| c.0 > 9.0), "{thin:?} {thick:?}");
        assert!(!thick.is_empty());
    }
}
