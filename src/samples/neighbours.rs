//! Which samples are near which: a grid of buckets as wide as the radius.

use glam::DVec2;

use super::area::Area;

/// The neighbourhoods n(s) of all samples: those within a radius, each with itself first (Tu 2020 §4.2.2).
#[derive(Debug, Clone, Default)]
pub struct Neighbourhoods {
    starts: Vec<usize>,
    near: Vec<Near>,
}

/// A sample in the neighbourhood of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Its number.
    pub sample: usize,
    /// Where it lies, seen from the middle, in millimetres.
    pub offset: DVec2,
}

impl Neighbourhoods {
    /// The samples within `radius_mm` of each, in an area that may be rolled.
    pub fn new(points: &[DVec2], radius_mm: f64, area: Option<&Area>) -> Self {
        let buckets = Buckets::new(points, radius_mm, area);
        let (mut starts, mut near) = (vec![0], Vec::new());
        for (i, &p) in points.iter().enumerate() {
            near.push(Near { sample: i, offset: DVec2::ZERO });
            let first = near.len();
            buckets.within(p, radius_mm, |sample, offset| {
                if sample != i {
                    near.push(Near { sample, offset });
                }
            });
            near[first..].sort_unstable_by_key(|near| near.sample);
            starts.push(near.len());
        }
        Self { starts, near }
    }

    /// The neighbourhood of a sample; it comes first itself.
    pub fn of(&self, sample: usize) -> &[Near] {
        &self.near[self.starts[sample]..self.starts[sample + 1]]
    }

    /// The number of samples in the largest.
    pub fn largest(&self) -> usize {
        self.starts.windows(2).map(|ends| ends[1] - ends[0]).max().unwrap_or(0)
    }

    /// The mean number of samples.
    pub fn mean(&self) -> f64 {
        self.near.len() as f64 / (self.starts.len() - 1).max(1) as f64
    }
}

/// Points by the square that they lie in.
pub struct Buckets<'a> {
    points: &'a [DVec2],
    area: Option<&'a Area>,
    low: DVec2,
    side_mm: f64,
    columns: usize,
    rows: usize,
    starts: Vec<usize>,
    order: Vec<usize>,
}

impl<'a> Buckets<'a> {
    /// Buckets of squares of at least `side_mm`; as many as there are points, about, at the most.
    pub fn new(points: &'a [DVec2], side_mm: f64, area: Option<&'a Area>) -> Self {
        let home = |p: DVec2| area.map_or(p, |area| area.home(p));
        let mut low = points.iter().map(|&p| home(p)).reduce(DVec2::min).unwrap_or_default();
        let mut high = points.iter().map(|&p| home(p)).reduce(DVec2::max).unwrap_or_default();
        let lap_mm = area.and_then(Area::lap_mm);
        if let Some(lap_mm) = lap_mm {
            (low.x, high.x) = (0.0, lap_mm);
        }
        let size = (high - low).max(DVec2::splat(1e-9));
        let most = (points.len() as f64).sqrt().ceil() * 2.0 + 1.0;
        let side_mm = side_mm.max(size.max_element() / most);
        // Rolled, whole squares go round, and none of them is narrower than the radius.
        let columns = match lap_mm {
            Some(lap_mm) => ((lap_mm / side_mm).floor() as usize).max(1),
            None => (size.x / side_mm).floor() as usize + 1,
        };
        let rows = (size.y / side_mm).floor() as usize + 1;
        let mut buckets = Self {
            points,
            area,
            low,
            side_mm,
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            order: Vec::new(),
        };
        let at: Vec<usize> = points.iter().map(|&p| buckets.bucket(home(p))).collect();
        at.iter().for_each(|&b| buckets.starts[b + 1] += 1);
        for b in 0..columns * rows {
            buckets.starts[b + 1] += buckets.starts[b];
        }
        let mut next = buckets.starts.clone();
        buckets.order = vec![0; points.len()];
        for (i, &b) in at.iter().enumerate() {
            buckets.order[next[b]] = i;
            next[b] += 1;
        }
        buckets
    }

    fn lap_mm(&self) -> Option<f64> {
        self.area.and_then(Area::lap_mm)
    }

    fn column(&self, x: f64) -> usize {
        let width = self.lap_mm().map_or(self.side_mm, |lap_mm| lap_mm / self.columns as f64);
        (((x - self.low.x) / width).max(0.0) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) / self.side_mm).max(0.0) as usize).min(self.rows - 1)
    }

    fn bucket(&self, p: DVec2) -> usize {
        self.row(p.y) * self.columns + self.column(p.x)
    }

    /// Tells every point within `radius_mm` of `p`, with the way to it.
    pub fn within(&self, p: DVec2, radius_mm: f64, mut tell: impl FnMut(usize, DVec2)) {
        let home = self.area.map_or(p, |area| area.home(p));
        let way = |q: DVec2| self.area.map_or(q - p, |area| area.way(p, q));
        let (first_row, last_row) = (self.row(home.y - radius_mm), self.row(home.y + radius_mm));
        let is_whole =
            self.lap_mm().is_some_and(|lap_mm| 2.0 * radius_mm >= lap_mm * (1.0 - 2.0 / self.columns as f64));
        let columns: Vec<usize> = match self.lap_mm() {
            Some(_) if is_whole => (0..self.columns).collect(),
            Some(lap_mm) => {
                let width = lap_mm / self.columns as f64;
                let first = ((home.x - radius_mm) / width).floor() as i64;
                let last = ((home.x + radius_mm) / width).floor() as i64;
                (first..=last).map(|c| c.rem_euclid(self.columns as i64) as usize).collect()
            }
            None => (self.column(home.x - radius_mm)..=self.column(home.x + radius_mm)).collect(),
        };
        for row in first_row..=last_row {
            for &column in &columns {
                let bucket = row * self.columns + column;
                for &i in &self.order[self.starts[bucket]..self.starts[bucket + 1]] {
                    let offset = way(self.points[i]);
                    if offset.length_squared() <= radius_mm * radius_mm {
                        tell(i, offset);
                    }
                }
            }
        }
    }

    /// The point nearest to `p` of those that are `good`, and how far it is; the first one if several are as near.
    pub fn nearest(&self, p: DVec2, good: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let mut radius_mm = self.side_mm;
        let widest = self.side_mm * (self.columns + self.rows + 2) as f64 + self.outside(p);
        loop {
            let mut best: Option<(usize, f64)> = None;
            self.within(p, radius_mm, |i, offset| {
                let d = offset.length();
                let is_better = best.is_none_or(|(j, b)| d < b || (d == b && i < j));
                if is_better && good(i) {
                    best = Some((i, d));
                }
            });
            if best.is_some() || radius_mm > widest {
                return best;
            }
            radius_mm *= 2.0;
        }
    }

    /// How far `p` is outside of the squares, at the most.
    fn outside(&self, p: DVec2) -> f64 {
        let home = self.area.map_or(p, |area| area.home(p));
        let high = self.low + self.side_mm * DVec2::new(self.columns as f64, self.rows as f64);
        (self.low - home).max(home - high).max(DVec2::ZERO).length()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::samples::area::tests::{rolled, square};

    fn points() -> impl Strategy<Value = Vec<DVec2>> {
        prop::collection::vec((0.0f64..40.0, 0.0f64..40.0).prop_map(|(x, y)| DVec2::new(x, y)), 1..60)
    }

    proptest! {
        #[test]
        fn all_within_the_radius_are_found(points in points(), radius in 0.5f64..30.0, is_rolled: bool) {
            let area = if is_rolled { rolled(40.0, 40.0) } else { square(40.0) };
            let near = Neighbourhoods::new(&points, radius, Some(&area));
            for (i, &p) in points.iter().enumerate() {
                let mut found: Vec<usize> = near.of(i).iter().map(|near| near.sample).collect();
                prop_assert_eq!(found[0], i);
                found.sort_unstable();
                let all: Vec<usize> =
                    (0..points.len()).filter(|&j| area.way(p, points[j]).length() <= radius).collect();
                prop_assert_eq!(found, all);
            }
        }

        #[test]
        fn the_nearest_is_found(points in points(), x in -20.0f64..60.0, y in -20.0f64..60.0) {
            let p = DVec2::new(x, y);
            let buckets = Buckets::new(&points, 3.0, None);
            let (_, distance) = buckets.nearest(p, |_| true).unwrap();
            let least = points.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            prop_assert!((distance - least).abs() < 1e-12);
        }
    }
}
