//! Where the pattern is to lie: a region, or a strip whose two ends are one place.

use glam::DVec2;

use crate::planar::{EdgeIndex, FillRule, GridPoint, Region};

/// Corners of an area that is grown are round within this part of what it grows by.
const GROWN_CHORD: f64 = 0.05;

/// The output domain D (Tu 2020 §4.3.1).
#[derive(Clone)]
pub struct Area {
    region: Region,
    index: EdgeIndex,
    squares: Squares,
    lap_mm: Option<f64>,
}

impl Area {
    /// The inside of a region in millimetres, y up; it may have holes.
    pub fn new(region: Region) -> Self {
        let index = EdgeIndex::new(&region);
        Self { squares: Squares::new(&region, &index), index, region, lap_mm: None }
    }

    /// The same, where x and x + `lap_mm` are one place. The region has to reach over one lap, from x = 0, and one half more on both sides.
    pub fn rolled(region: Region, lap_mm: f64) -> Self {
        Self { lap_mm: Some(lap_mm), ..Self::new(region) }
    }

    /// The same with so much more all around.
    pub fn grown(&self, by_mm: f64) -> Self {
        let region = self.region.offset(by_mm, GROWN_CHORD * by_mm);
        Self { lap_mm: self.lap_mm, ..Self::new(region) }
    }

    /// The region.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// By how much x grows once round, if the ends are one place.
    pub fn lap_mm(&self) -> Option<f64> {
        self.lap_mm
    }

    /// Lower left and upper right corner of where samples are: of one lap, if the ends are one place.
    pub fn bounds_mm(&self) -> (DVec2, DVec2) {
        let (low, high) = self.region.bounds_mm().unwrap_or_default();
        match self.lap_mm {
            Some(lap_mm) => (DVec2::new(0.0, low.y), DVec2::new(lap_mm, high.y)),
            None => (low, high),
        }
    }

    /// Whether a position lies inside, decided exactly on the region's grid. On the outer border it does not, on that of a hole it does.
    pub fn contains(&self, p: DVec2) -> bool {
        let Ok(p) = self.region.grid().snap(self.home(p)) else { return false };
        let square = self.squares.of(self.region.grid().to_mm(p));
        square.unwrap_or_else(|| covers(&self.region, p))
    }

    /// Whether all that contours enclose lies inside, decided exactly on the region's grid.
    pub fn covers_all(&self, contours: &[Vec<DVec2>]) -> bool {
        let grid = self.region.grid();
        let points: Vec<DVec2> = contours.iter().flatten().copied().collect();
        if !self.is_crossed_near(&points) {
            return points.first().is_none_or(|&p| self.contains(p));
        }
        let snapped = |contour: &Vec<DVec2>| contour.iter().map(|&p| grid.snap(p)).collect();
        let paths: Result<Vec<Vec<GridPoint>>, _> = contours.iter().map(snapped).collect();
        paths.is_ok_and(|paths| {
            Region::fill(grid, &paths, FillRule::Positive).without(&self.region).is_empty()
        })
    }

    /// Whether any of the border is in the box of points.
    pub fn is_crossed_near(&self, points: &[DVec2]) -> bool {
        let Some(&first) = points.first() else { return false };
        let (low, high) = points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
        self.index.in_box(low, high).next().is_some()
    }

    /// Where a straight line crosses the border, as parts of its length, in no particular order. Rounding may miss one through a corner.
    pub fn crossings(&self, from: DVec2, to: DVec2) -> impl Iterator<Item = f64> + '_ {
        let way = to - from;
        self.index.in_box(from.min(to), from.max(to)).filter_map(move |edge| {
            let side = edge.to - edge.from;
            let turn = way.perp_dot(side);
            let [part, place] = [side, way].map(|line| (edge.from - from).perp_dot(line) / turn);
            ((0.0..=1.0).contains(&part) && (0.0..=1.0).contains(&place)).then_some(part)
        })
    }

    /// The point of the border that is nearest, in the lap of `p`.
    pub fn nearest(&self, p: DVec2) -> DVec2 {
        let home = self.home(p);
        self.index.nearest(home).map_or(p, |edge| p + edge.nearest(home) - home)
    }

    /// How far the border is, in millimetres.
    pub fn depth_mm(&self, p: DVec2) -> f64 {
        self.nearest(p).distance(p)
    }

    /// The shortest way from `a` to `b`.
    pub fn way(&self, a: DVec2, b: DVec2) -> DVec2 {
        let way = b - a;
        match self.lap_mm {
            Some(lap_mm) => DVec2::new(way.x - (way.x / lap_mm).round() * lap_mm, way.y),
            None => way,
        }
    }

    /// The same place in the first lap.
    pub fn home(&self, p: DVec2) -> DVec2 {
        match self.lap_mm {
            Some(lap_mm) => DVec2::new(p.x.rem_euclid(lap_mm), p.y),
            None => p,
        }
    }
}

fn covers(region: &Region, p: GridPoint) -> bool {
    region.parts().iter().any(|part| part.covers(p))
}

/// Squares over the box of a region: those that no edge passes are inside or outside as a whole, which saves going round an outline of hundreds of vertices.
#[derive(Clone)]
struct Squares {
    low: DVec2,
    side: DVec2,
    /// Row by row; `None` where edges pass.
    inside: Vec<Option<bool>>,
}

/// Squares along each side.
const SQUARES: usize = 64;
/// Edges are looked for in squares that are larger by this part, so that rounding never hides one.
const AROUND: f64 = 1e-3;

impl Squares {
    fn new(region: &Region, index: &EdgeIndex) -> Self {
        let (low, high) = region.bounds_mm().unwrap_or_default();
        let side = (high - low).max(DVec2::splat(f64::MIN_POSITIVE)) / SQUARES as f64;
        let inside = (0..SQUARES * SQUARES).map(|i| {
            let corner = low + side * DVec2::new((i % SQUARES) as f64, (i / SQUARES) as f64);
            let around = side * AROUND;
            match index.in_box(corner - around, corner + side + around).next() {
                Some(_) => None,
                None => region.grid().snap(corner + side / 2.0).ok().map(|middle| covers(region, middle)),
            }
        });
        Self { low, side, inside: inside.collect() }
    }

    /// Whether the square of a place is inside; `None` where edges pass it.
    fn of(&self, p: DVec2) -> Option<bool> {
        let place = (p - self.low) / self.side;
        if place.cmplt(DVec2::ZERO).any() || place.cmpge(DVec2::splat(SQUARES as f64)).any() {
            return None;
        }
        self.inside[place.y as usize * SQUARES + place.x as usize]
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::planar::Grid;

    fn rectangle(low: DVec2, high: DVec2) -> Region {
        let grid = Grid::for_extent(1000.0).unwrap();
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let path = corners.iter().map(|&p| grid.snap(p).unwrap()).collect();
        Region::fill(grid, &[path], FillRule::NonZero)
    }

    pub(in crate::samples) fn square(side_mm: f64) -> Area {
        Area::new(rectangle(DVec2::ZERO, DVec2::splat(side_mm)))
    }

    pub(in crate::samples) fn rolled(lap_mm: f64, height_mm: f64) -> Area {
        let low = DVec2::new(-0.5 * lap_mm, 0.0);
        Area::rolled(rectangle(low, DVec2::new(1.5 * lap_mm, height_mm)), lap_mm)
    }

    #[test]
    fn the_short_way_leads_over_the_seam() {
        let area = rolled(100.0, 20.0);
        let way = area.way(DVec2::new(95.0, 3.0), DVec2::new(5.0, 4.0));
        assert_eq!(way, DVec2::new(10.0, 1.0));
        assert_eq!(area.home(DVec2::new(-5.0, 3.0)), DVec2::new(95.0, 3.0));
        assert!(area.contains(DVec2::new(205.0, 3.0)) && !area.contains(DVec2::new(205.0, 30.0)));
        assert_eq!(square(10.0).way(DVec2::ZERO, DVec2::new(9.0, 0.0)), DVec2::new(9.0, 0.0));
    }

    #[test]
    fn squares_say_what_the_outline_says() {
        let grid = Grid::for_extent(100.0).unwrap();
        let star: Vec<_> = (0..14)
            .map(|i| DVec2::from_angle(f64::from(i) * 0.4488) * if i % 2 == 0 { 40.0 } else { 9.0 } + 45.0)
            .map(|p| grid.snap(p).unwrap())
            .collect();
        let region = Region::fill(grid, &[star], FillRule::NonZero);
        let area = Area::new(region.clone());
        for i in 0..10_000 {
            let p = DVec2::new(f64::from(i % 100), f64::from(i / 100)) * 0.9 + 0.123;
            assert_eq!(area.contains(p), covers(&region, grid.snap(p).unwrap()), "{p}");
        }
    }

    #[test]
    fn what_is_outside_is_drawn_to_the_border() {
        let area = square(10.0);
        assert_eq!(area.nearest(DVec2::new(12.0, 4.0)), DVec2::new(10.0, 4.0));
        assert_eq!(area.depth_mm(DVec2::new(4.0, 3.0)), 3.0);
        assert!(area.grown(5.0).contains(DVec2::new(-4.0, 5.0)));
    }
}
