//! The narrowest ink and the narrowest gap of a region: the first that erosion or dilation would lose.
//!
//! Peaks and passes of the distance to the boundary ([`Clearance`]) are paired by the elder rule of
//! persistent homology: going down from the highest value, a pass that joins two peaks ends the lower one,
//! and a pass that closes a loop belongs to a hole. A pass whose lower peak is hardly higher is the tip of a
//! discretised cusp or the ripple of a flattened curve: what it would cut off vanishes with a little more
//! erosion, and it does not count. All other passes, and the highest peak of each component, are places
//! where the counts change.

use glam::DVec2;
use serde::Serialize;

use super::clearance::{Clearance, Spot, Way};
use crate::planar::Region;

/// A narrowest place: its width, and the middle of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Narrowest {
    /// The width in millimetres: eroding (or dilating) by half of it changes the counts.
    pub width_mm: f64,
    /// The middle of the place in millimetres, y up.
    #[serde(serialize_with = "super::json::point")]
    pub position_mm: DVec2,
}

/// The narrowest ink and the narrowest gap of a region.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Widths {
    /// The ink that erosion loses first: a neck that breaks, a wall that opens a hole, a part that vanishes.
    pub feature: Option<Narrowest>,
    /// The gap that dilation loses first: parts that meet, a hole or the mouth of a bay that closes.
    pub gap: Option<Narrowest>,
}

/// The narrowest ink of `region` up to `limit_mm` wide; `None` when there is none so narrow.
///
/// What would be cut off, but with `chord_mm` more erosion vanishes, does not count: sharp tips.
pub fn min_feature(region: &Region, limit_mm: f64, chord_mm: f64) -> Option<Narrowest> {
    widths(region, chord_mm).feature.filter(|n| n.width_mm <= limit_mm)
}

/// The narrowest gap of `region` up to `limit_mm` wide; `None` when there is none so narrow.
///
/// What would be closed off, but with `chord_mm` more dilation fills, does not count: the ends of notches.
pub fn min_gap(region: &Region, limit_mm: f64, chord_mm: f64) -> Option<Narrowest> {
    widths(region, chord_mm).gap.filter(|n| n.width_mm <= limit_mm)
}

/// Both at once, for little more than the price of one. A single convex part has no gap.
pub fn widths(region: &Region, chord_mm: f64) -> Widths {
    let (Some(mut clearance), Some((low, high))) = (Clearance::new(region), region.bounds_mm()) else {
        return Widths::default();
    };
    clearance.ways.sort_by(|a, b| b.narrowest.radius.total_cmp(&a.narrowest.radius).then(a.ends.cmp(&b.ends)));
    // The way around everything runs between the ink and the frame, and is wider than any gap of the ink.
    let outside = (high - low).length();
    let gap = first_change(&clearance, false, chord_mm).filter(|n| n.width_mm < outside);
    Widths { feature: first_change(&clearance, true, chord_mm), gap }
}

fn first_change(clearance: &Clearance, ink: bool, persistence_mm: f64) -> Option<Narrowest> {
    let changes = changes(clearance, ink, persistence_mm);
    let first = changes.into_iter().min_by(|a, b| a.radius.total_cmp(&b.radius))?;
    Some(Narrowest { width_mm: 2.0 * first.radius, position_mm: first.at })
}

/// The places where the counts of one side change, from the widest down.
fn changes(clearance: &Clearance, ink: bool, persistence_mm: f64) -> Vec<Spot> {
    let mut peaks = Peaks::new(clearance);
    let mut changes = Vec::new();
    let on_side = |way: &&Way| clearance.places[way.ends[0]].1 == ink;
    for way in clearance.ways.iter().filter(on_side) {
        let [a, b] = way.ends.map(|end| peaks.find(end));
        let lower = if a == b { None } else { Some(peaks.join(a, b)) };
        if lower.is_none_or(|peak| peak.radius - way.narrowest.radius > persistence_mm) {
            changes.push(way.narrowest);
        }
    }
    for place in 0..clearance.places.len() {
        if clearance.places[place].1 == ink && peaks.find(place) == place {
            changes.push(peaks.highest[place]);
        }
    }
    changes
}

/// Sets of places, each with its highest peak.
struct Peaks {
    parent: Vec<usize>,
    highest: Vec<Spot>,
}

impl Peaks {
    fn new(clearance: &Clearance) -> Self {
        Self {
            parent: (0..clearance.places.len()).collect(),
            highest: clearance.places.iter().map(|(spot, _)| *spot).collect(),
        }
    }

    fn find(&mut self, mut place: usize) -> usize {
        while self.parent[place] != place {
            self.parent[place] = self.parent[self.parent[place]];
            place = self.parent[place];
        }
        place
    }

    /// Joins two roots under the one with the higher peak; the lower peak.
    fn join(&mut self, a: usize, b: usize) -> Spot {
        let (over, under) = if self.highest[a].radius >= self.highest[b].radius { (a, b) } else { (b, a) };
        self.parent[under] = over;
        self.highest[under]
    }
}

#[cfg(test)]
mod tests {
    use super::super::endure::{endures_dilation, endures_erosion};
    use super::*;
    use crate::planar::{FillRule, Grid, GridPoint};

    fn region(paths: &[Vec<DVec2>]) -> Region {
        let grid = Grid::for_extent(128.0).unwrap();
        let paths: Vec<Vec<GridPoint>> =
            paths.iter().map(|path| path.iter().map(|&p| grid.snap(p).unwrap()).collect()).collect();
        Region::fill(grid, &paths, FillRule::EvenOdd)
    }

    fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<DVec2> {
        [(x, y), (x + width, y), (x + width, y + height), (x, y + height)].map(DVec2::from).to_vec()
    }

    fn circle(x: f64, y: f64, radius: f64, n: usize) -> Vec<DVec2> {
        let turn = std::f64::consts::TAU / n as f64;
        (0..n).map(|i| DVec2::new(x, y) + radius * DVec2::from_angle(i as f64 * turn)).collect()
    }

    /// The first change by bisection over whole offsets: slow, and sharing nothing with the triangulation.
    fn bisected(endures: impl Fn(f64) -> bool, limit_mm: f64) -> Option<f64> {
        let mut step = 1e-3;
        let mut low = 0.0;
        while endures(low + step) {
            low += step;
            step = (low * 0.05).max(1e-3);
            if 2.0 * low > limit_mm {
                return None;
            }
        }
        let mut high = low + step;
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if endures(middle) { low = middle } else { high = middle }
        }
        Some(low + high)
    }

    fn assert_near(found: Option<Narrowest>, width_mm: f64, at: (f64, f64), within: f64) {
        let found = found.unwrap();
        assert!((found.width_mm - width_mm).abs() < 0.01, "{found:?} {width_mm}");
        assert!(found.position_mm.distance(at.into()) < within, "{found:?} {at:?}");
    }

    #[test]
    fn dumbbell() {
        let bar = [(10.0, 4.0), (20.0, 4.5), (20.0, 5.5), (10.0, 6.0)].map(DVec2::from).to_vec();
        let dumbbell = region(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(20.0, 0.0, 10.0, 10.0), bar]);
        assert_eq!(dumbbell.components(), 1);
        assert_near(min_feature(&dumbbell, 10.0, 0.01), 1.0, (20.0, 5.0), 0.1);
        assert_eq!(min_feature(&dumbbell, 0.9, 0.01), None);
        // A bay of constant width has no mouth, and closes evenly.
        assert_eq!(min_gap(&dumbbell, 100.0, 0.01), None);
    }

    #[test]
    fn thin_wall_and_hole() {
        let ring = region(&[circle(0.0, 0.0, 10.0, 90), circle(1.0, 0.0, 8.5, 90)]);
        assert_near(min_feature(&ring, 10.0, 0.01), 0.5, (9.75, 0.0), 1.0);
        assert_near(min_gap(&ring, 20.0, 0.01), 17.0 * (2f64.to_radians()).cos(), (1.0, 0.0), 0.3);
    }

    #[test]
    fn neighbours() {
        let two = region(&[rectangle(0.0, 0.0, 5.0, 5.0), rectangle(5.25, 1.0, 7.0, 2.0)]);
        assert_near(min_feature(&two, 10.0, 0.01), 2.0, (8.75, 2.0), 2.6);
        assert_near(min_gap(&two, 10.0, 0.01), 0.25, (5.125, 2.0), 1.5);
    }

}
