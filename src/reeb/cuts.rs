//! Where the exemplar is cut.
//!
//! Between each two neighbouring events that matter, one cut: where the narrowest portal and gap are widest
//! and the contours cross the line most squarely (a slanted crossing makes a kink when pieces of other
//! slants follow). Zhou 2014 §5.2 takes the middle instead. A cut whose narrowest portal is under the
//! minimum feature is dropped (§5.2.1); uniform slicing (§5.1) takes equally spaced lines.

use thiserror::Error;

use super::graph::ReebGraph;
use super::persistence::persistence;
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
    /// Where the cut would have been best, in millimetres.
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
        /// The cut with the widest narrowest portal.
        x_mm: f64,
        /// The height of that portal.
        portal_mm: f64,
    },
}

/// Places tried between two events. More find a slightly better cut; fewer miss the straight part of a curl.
const CANDIDATES: i64 = 24;
/// No cut where a contour runs along it more steeply than this (cosine of 78 degrees): a strand that is cut
/// along its length cannot be joined to another without a kink.
const LEAST_SQUARENESS: f64 = 0.2;
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
        let Some((low, high)) = region.bounds_mm() else {
            return Ok(Self { cuts: Vec::new(), dropped: Vec::new() });
        };
        let grid = region.grid();
        let sections = CrossSections::new(region);
        let (left, right) = (grid.steps(low.x), grid.steps(high.x));
        let intervals = match rule {
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
                event_intervals(reeb, grid.steps(persistence_mm).max(1))
            }
        };
        let mut chosen = Self { cuts: Vec::new(), dropped: Vec::new() };
        let separation = SEPARATION * (high.y - low.y);
        for best in best_cuts(&sections, &intervals, separation) {
            let portal_mm = best.narrowest_portal_mm();
            if portal_mm < tolerances.min_feature_mm() {
                chosen.dropped.push(CutDropped { x_mm: grid.mm(best.x), portal_mm });
            } else {
                chosen.cuts.push(best);
            }
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
}

/// An open interval of x in which one cut is placed, with the places to try.
struct Interval {
    low: i64,
    high: i64,
    tries: Vec<i64>,
}

fn uniform_intervals(lines: usize, left: i64, right: i64) -> Result<Vec<Interval>, SlicingError> {
    let n = i64::try_from(lines).unwrap_or(i64::MAX);
    if !(1..=10_000).contains(&n) {
        return Err(SlicingError::Parameter {
            name: "slicing uniform",
            value: n as f64,
            wanted: "from 1 to 10000 lines",
        });
    }
    let at = |k: i64| left + ((right - left) as f64 * k as f64 / (n + 1) as f64) as i64;
    let spacing = ((right - left) / (n + 1)).max(2);
    Ok((1..=n)
        .map(|k| Interval { low: at(k) - spacing / 2, high: at(k) + spacing / 2, tries: vec![at(k)] })
        .collect())
}

fn event_intervals(reeb: &ReebGraph, threshold: i64) -> Vec<Interval> {
    let spans = persistence(reeb);
    let mut xs: Vec<i64> = reeb
        .points()
        .zip(&spans)
        .filter(|(_, span)| span.is_none_or(|s| s >= threshold))
        .map(|((_, p), _)| p.at.x)
        .collect();
    xs.sort_unstable();
    xs.windows(2)
        .filter(|pair| pair[1] - pair[0] >= threshold.max(8))
        .map(|pair| {
            let (low, high) = (pair[0], pair[1]);
            let tries = (1..CANDIDATES).map(|k| low + (high - low) * k / CANDIDATES).collect();
            Interval { low, high, tries }
        })
        .collect()
}

fn best_cuts(sections: &CrossSections<'_>, intervals: &[Interval], separation: f64) -> Vec<Cut> {
    let mut xs = Vec::new();
    for interval in intervals {
        let free =
            interval.tries.iter().filter_map(|&x| sections.clear_of_vertices(x, interval.low, interval.high));
        xs.extend(free);
    }
    xs.sort_unstable();
    xs.dedup();
    let mut cuts: Vec<Option<Cut>> =
        sections.at(&xs).into_iter().zip(&xs).map(|(crossings, &x)| Some(Cut { x, crossings })).collect();
    let mut chosen = Vec::with_capacity(intervals.len());
    for interval in intervals {
        let range = xs.partition_point(|&x| x <= interval.low)..xs.partition_point(|&x| x < interval.high);
        let middle = (interval.low + interval.high) / 2;
        let best = range
            .filter_map(|i| cuts[i].as_ref().map(|cut| (i, score(&cut.crossings), (cut.x - middle).abs())))
            .filter(|&(_, score, _)| score > separation)
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.2.cmp(&a.2)));
        if let Some((i, ..)) = best {
            chosen.extend(cuts[i].take());
        }
    }
    chosen
}

/// How good a cut is, in millimetres: the narrowest portal or gap, less where contours cross at a slant.
fn score(crossings: &[Crossing]) -> f64 {
    if crossings.is_empty() {
        return f64::MAX;
    }
    if crossings.iter().any(|c| c.tangent.x < LEAST_SQUARENESS) {
        return 0.0;
    }
    let narrowest = crossings.windows(2).map(|w| w[0].y_mm - w[1].y_mm).fold(f64::INFINITY, f64::min);
    let squareness = crossings.iter().map(|c| c.tangent.x).sum::<f64>() / crossings.len() as f64;
    let worst = crossings.iter().map(|c| c.tangent.x).fold(1.0, f64::min);
    narrowest * squareness * (0.2 + 0.8 * worst)
}
