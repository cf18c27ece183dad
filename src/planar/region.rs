//! A validated region: polygons with holes whose contours touch nowhere.

use glam::DVec2;
use rustc_hash::FxHashMap;
use thiserror::Error;

use super::contour::Contour;
use super::grid::{Grid, GridError, GridPoint};
use super::overlay::{self, FillRule, RawPart};
use super::touch;

/// A hole narrower than this, in steps of the grid, is a crack: corners are rounded by half a step each, crossings of edges once
/// more, and again where further edges cross there. It is half a nanometre for a drawing of 100 mm.
const CRACK_STEPS: f64 = 16.0;

/// One connected component of a region.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    exterior: Contour,
    holes: Vec<Contour>,
}

impl Part {
    /// The outer boundary, counter-clockwise.
    pub fn exterior(&self) -> &Contour {
        &self.exterior
    }

    /// The boundaries of the holes, clockwise.
    pub fn holes(&self) -> &[Contour] {
        &self.holes
    }

    /// The exterior, then the holes.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        std::iter::once(&self.exterior).chain(&self.holes)
    }

    /// The part as a region by itself, on the grid that it is on.
    pub fn alone(&self, grid: Grid) -> Region {
        let outlines: Vec<Vec<GridPoint>> = self.contours().map(|c| c.points().to_vec()).collect();
        Region::fill(grid, &outlines, FillRule::Positive)
    }

    /// Whether `p` lies strictly inside of the outer boundary and of no hole, exactly.
    pub fn covers(&self, p: GridPoint) -> bool {
        self.exterior.contains(p) && !self.holes.iter().any(|hole| hole.contains(p))
    }
}

/// A set of the plane bounded by simple, pairwise disjoint polygons on a [`Grid`]: polygons with holes,
/// exteriors counter-clockwise, in an order that depends on the set only.
///
/// Validity is established by the constructors, so that no user of a region needs a second check.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    grid: Grid,
    parts: Vec<Part>,
}

/// A place where contours break the rules of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Two edges cross here, or a contour passes twice through this point.
    Crossing(DVec2),
    /// A contour near this point covers ink twice, or is a hole outside of any ink.
    Nesting(DVec2),
}

impl Fault {
    /// Where, in millimetres.
    pub fn position_mm(&self) -> DVec2 {
        match *self {
            Self::Crossing(p) | Self::Nesting(p) => p,
        }
    }
}

/// Why contours do not make a region.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RegionError {
    /// A point does not fit the grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The contours cross, touch or nest wrongly; at least one place is given.
    #[error("contours cross or touch at {} place(s), first at ({:.4}, {:.4}) mm", faults.len(), faults[0].position_mm().x, faults[0].position_mm().y)]
    Invalid {
        /// The places found.
        faults: Vec<Fault>,
    },
}

impl Region {
    /// The empty region.
    pub fn empty(grid: Grid) -> Self {
        Self { grid, parts: Vec::new() }
    }

    /// The region that closed `paths` fill under `rule`: crossings, overlaps, duplicates and either winding
    /// are all allowed. Where the filled set touches itself in a point, the ink retreats from the point, as
    /// such a point holds nothing together.
    pub fn fill(grid: Grid, paths: &[Vec<GridPoint>], rule: FillRule) -> Self {
        let parts = overlay::fill(paths.iter().map(Vec::as_slice), rule);
        Self { grid, parts: touch::pull_apart(parts) }.sorted()
    }

    /// The union of regions on one grid.
    ///
    /// # Panics
    /// When the grids differ.
    pub fn union<'a>(grid: Grid, regions: impl IntoIterator<Item = &'a Region>) -> Self {
        let mut paths = Vec::new();
        for region in regions {
            assert_eq!(region.grid, grid, "a union needs one grid");
            paths.extend(region.contours().map(|c| c.points().to_vec()));
        }
        Self::fill(grid, &paths, FillRule::Positive)
    }

    /// A region of which the contours are given, already oriented with the ink on the left; nothing about
    /// them is changed.
    ///
    /// # Errors
    /// [`RegionError::Invalid`] names the places where they cross, touch, or nest wrongly.
    pub fn from_contours(grid: Grid, contours: Vec<Contour>) -> Result<Self, RegionError> {
        let mut seen: FxHashMap<GridPoint, usize> = FxHashMap::default();
        let mut faults = Vec::new();
        for (i, contour) in contours.iter().enumerate() {
            for &p in contour.points() {
                if seen.insert(p, i).is_some() {
                    faults.push(Fault::Crossing(grid.to_mm(p)));
                }
            }
        }
        let parts = overlay::fill(contours.iter().map(Contour::points), FillRule::Positive);
        // A point of the result that was not given is a crossing of two edges or a vertex on an edge.
        let (mut given_area, mut found_area) = (0, 0);
        let mut kept: Vec<&Contour> = Vec::new();
        for contour in parts.iter().flatten() {
            let foreign = contour.points().iter().find(|p| !seen.contains_key(p));
            faults.extend(foreign.map(|&p| Fault::Crossing(grid.to_mm(p))));
            found_area += contour.doubled_area();
            kept.push(contour);
        }
        given_area += contours.iter().map(Contour::doubled_area).sum::<i128>();
        // A vertex of one contour on an edge of another splits that edge.
        let (given, found) = (seen.len(), kept.iter().map(|c| c.points().len()).sum::<usize>());
        if faults.is_empty() && found > given {
            let mut met = rustc_hash::FxHashSet::default();
            let twice = kept.iter().flat_map(|c| c.points()).find(|&&p| !met.insert(p));
            faults.extend(twice.map(|&p| Fault::Crossing(grid.to_mm(p))));
        }
        if faults.is_empty() && (kept.len() != contours.len() || given_area != found_area) {
            kept.sort_unstable();
            let odd = contours.iter().find(|c| kept.binary_search(c).is_err()).unwrap_or(&contours[0]);
            faults.push(Fault::Nesting(grid.to_mm(odd.points()[0])));
        }
        // A spike of no width bounds nothing and is not in the result.
        if faults.is_empty() && found < given {
            let found: rustc_hash::FxHashSet<GridPoint> =
                kept.iter().flat_map(|c| c.points()).copied().collect();
            let lost = contours.iter().flat_map(|c| c.points()).find(|p| !found.contains(p));
            faults.extend(lost.map(|&p| Fault::Crossing(grid.to_mm(p))));
        }
        if faults.is_empty() {
            Ok(Self { grid, parts: parts.into_iter().map(Part::from_raw).collect() }.sorted())
        } else {
            Err(RegionError::Invalid { faults })
        }
    }

    /// The region with `place` applied to every point. `place` must be a motion that takes the grid to itself, and
    /// `flips` says whether it turns left to right.
    pub(super) fn rigidly_moved(&self, place: impl Fn(GridPoint) -> GridPoint, flips: bool) -> Self {
        let moved = |contour: &Contour| {
            let mut points: Vec<GridPoint> = contour.points().iter().map(|&p| place(p)).collect();
            if flips {
                points.reverse();
            }
            Contour::new(points).expect("a motion keeps a contour a contour")
        };
        let part = |part: &Part| Part {
            exterior: moved(&part.exterior),
            holes: part.holes.iter().map(moved).collect(),
        };
        Self { grid: self.grid, parts: self.parts.iter().map(part).collect() }.sorted()
    }

    fn sorted(mut self) -> Self {
        for part in &mut self.parts {
            part.holes.sort_unstable();
        }
        self.parts.sort_unstable();
        self
    }

    /// The points that are not in `other`, which is on the same grid.
    pub fn without(&self, other: &Self) -> Self {
        let taken = other.contours().map(|c| c.points().iter().rev().copied().collect());
        let paths: Vec<Vec<GridPoint>> = self.contours().map(|c| c.points().to_vec()).chain(taken).collect();
        Self::fill(self.grid, &paths, FillRule::Positive)
    }

    /// The points of this region that are in another one too, which is on the same grid.
    pub fn within(&self, other: &Self) -> Self {
        let contours = || self.contours().chain(other.contours()).map(|c| c.points().to_vec());
        let all = || contours().flatten();
        let Some(low) = all().reduce(|a, b| GridPoint::new(a.x.min(b.x), a.y.min(b.y))) else {
            return Self::empty(self.grid);
        };
        let high = all().fold(low, |a, b| GridPoint::new(a.x.max(b.x), a.y.max(b.y)));
        // One winding less everywhere, by a clockwise frame, leaves what is inside of both. In two steps, what is outside and then the
        // rest, edges would be rounded twice, and hairs left between them.
        let [left, below, right, above] = [low.x - 1, low.y - 1, high.x + 1, high.y + 1];
        let frame = [(left, below), (left, above), (right, above), (right, below)];
        let frame = frame.map(|(x, y)| GridPoint::new(x, y)).to_vec();
        Self::fill(self.grid, &contours().chain([frame]).collect::<Vec<_>>(), FillRule::Positive)
    }

    /// The points within `radius_mm` of the region, or with a negative radius those deeper inside than that.
    /// Round corners are kept within `chord_mm`.
    pub fn offset(&self, radius_mm: f64, chord_mm: f64) -> Self {
        let contours = self.contours().map(Contour::points);
        let parts = overlay::offset(contours, self.grid.steps(radius_mm), self.grid.steps(chord_mm));
        Self { grid: self.grid, parts: touch::pull_apart(parts) }.sorted()
    }

    /// The region with `place` applied to every vertex, snapped to `grid`, and united again.
    ///
    /// `place` must be a similarity or another map under which straight edges stay good enough, and keep the
    /// orientation.
    ///
    /// # Errors
    /// [`GridError`] when a point does not fit `grid`.
    pub fn placed(&self, grid: Grid, place: impl Fn(DVec2) -> DVec2) -> Result<Self, GridError> {
        let mut paths = Vec::new();
        for contour in self.contours() {
            let path: Result<Vec<_>, _> =
                contour.points().iter().map(|&p| grid.snap(place(self.grid.to_mm(p)))).collect();
            paths.push(path?);
        }
        Ok(Self::fill(grid, &paths, FillRule::Positive))
    }

    /// The region without parts and holes of less than `area_mm2`, and a point of each that was left out, in
    /// millimetres.
    pub fn without_specks(&self, area_mm2: f64) -> (Self, Vec<DVec2>) {
        let mut specks = Vec::new();
        let mut keep = |contour: &Contour| {
            let large = contour.area_mm2(self.grid).abs() >= area_mm2;
            if !large {
                specks.push(self.grid.to_mm(contour.points()[0]));
            }
            large
        };
        let mut parts = self.parts.clone();
        parts.retain(|part| keep(&part.exterior));
        for part in &mut parts {
            part.holes.retain(&mut keep);
        }
        (Self { grid: self.grid, parts }, specks)
    }

    /// The region without holes that are narrower than a few steps of its grid: where ink is united that was rounded to the
    /// grid, they are cracks between its parts.
    pub fn without_cracks(mut self) -> Self {
        let is_crack = |hole: &Contour| {
            let length = |(a, b): (GridPoint, GridPoint)| ((b.x - a.x) as f64).hypot((b.y - a.y) as f64);
            let area = 0.5 * hole.doubled_area().unsigned_abs() as f64;
            // Of what is long and narrow the outline is twice as long as itself.
            area < CRACK_STEPS * 0.5 * hole.edges().map(length).sum::<f64>()
        };
        for part in &mut self.parts {
            part.holes.retain(|hole| !is_crack(hole));
        }
        self
    }

    /// The grid of the coordinates.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The connected components, in the order of their least points.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// All contours, part by part.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.parts.iter().flat_map(Part::contours)
    }

    /// The number of connected components (b0).
    pub fn components(&self) -> usize {
        self.parts.len()
    }

    /// The number of holes (b1).
    pub fn holes(&self) -> usize {
        self.parts.iter().map(|p| p.holes.len()).sum()
    }

    /// Whether there is no ink.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// The number of vertices.
    pub fn vertices(&self) -> usize {
        self.contours().map(|c| c.points().len()).sum()
    }

    /// The area in square millimetres.
    pub fn area_mm2(&self) -> f64 {
        self.contours().map(|c| c.area_mm2(self.grid)).sum()
    }

    /// The lower left and upper right corner of the bounding box in millimetres; `None` when empty.
    pub fn bounds_mm(&self) -> Option<(DVec2, DVec2)> {
        self.parts
            .iter()
            .map(|part| {
                let (low, high) = part.exterior.bounds();
                (self.grid.to_mm(low), self.grid.to_mm(high))
            })
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

impl Part {
    pub(super) fn from_raw(mut raw: RawPart) -> Self {
        let holes = raw.split_off(1);
        let exterior = raw.pop().expect("the engine's shapes have an exterior");
        Self { exterior, holes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::for_extent(100.0).unwrap()
    }

    fn path(points: &[(f64, f64)]) -> Vec<GridPoint> {
        points.iter().map(|&(x, y)| grid().snap(DVec2::new(x, y)).unwrap()).collect()
    }

    fn square(x: f64, y: f64, side: f64) -> Vec<GridPoint> {
        path(&[(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
    }

    fn hole(x: f64, y: f64, side: f64) -> Vec<GridPoint> {
        square(x, y, side).into_iter().rev().collect()
    }

    fn counts(paths: &[Vec<GridPoint>], rule: FillRule) -> (usize, usize) {
        let region = Region::fill(grid(), paths, rule);
        let again = Region::from_contours(grid(), region.contours().cloned().collect());
        assert_eq!(again.as_ref(), Ok(&region), "a filled region is valid");
        (region.components(), region.holes())
    }

    #[test]
    fn cracks_are_closed_and_holes_are_not() {
        let at =
            |points: &[(i64, i64)]| points.iter().map(|&(x, y)| GridPoint::new(x, y)).collect::<Vec<_>>();
        let around = at(&[(0, 0), (100_000, 0), (100_000, 100_000), (0, 100_000)]);
        let crack = at(&[(100, 100), (100, 103), (90_000, 105), (90_000, 102)]);
        let slot = at(&[(100, 200), (100, 220), (90_000, 220), (90_000, 200)]);
        let dot = at(&[(500, 500), (500, 540), (540, 540), (540, 500)]);
        let region = Region::fill(grid(), &[around, crack, slot, dot], FillRule::Positive);
        assert_eq!((region.holes(), region.without_cracks().holes()), (3, 2));
    }

    #[test]
    fn a_spike_of_no_width_is_a_fault() {
        let spike = path(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (20.0, 10.0), (5.0, 10.0), (0.0, 10.0)]);
        let Err(RegionError::Invalid { faults }) =
            Region::from_contours(grid(), vec![Contour::new(spike).unwrap()])
        else {
            panic!("the spike would be lost");
        };
        assert!(matches!(faults[..], [Fault::Crossing(p)] if p == DVec2::new(20.0, 10.0)), "{faults:?}");
    }

    #[test]
    fn fill_rules_and_windings() {
        let nested = [square(0.0, 0.0, 10.0), square(2.0, 2.0, 4.0)];
        assert_eq!(counts(&nested, FillRule::EvenOdd), (1, 1));
        assert_eq!(counts(&nested, FillRule::NonZero), (1, 0));
        let ring = [hole(0.0, 0.0, 10.0), square(2.0, 2.0, 4.0)];
        assert_eq!(counts(&ring, FillRule::NonZero), (1, 1));
        let twice = [square(0.0, 0.0, 10.0), square(0.0, 0.0, 10.0)];
        assert_eq!(counts(&twice, FillRule::NonZero), (1, 0));
    }

    #[test]
    fn a_point_holds_nothing_together() {
        // Two squares that share a corner are two components.
        assert_eq!(counts(&[square(0.0, 0.0, 5.0), square(5.0, 5.0, 5.0)], FillRule::NonZero), (2, 0));
        // A hole that touches the outside in one point opens there.
        let diamond = path(&[(0.0, 5.0), (3.0, 7.0), (6.0, 5.0), (3.0, 3.0)]);
        assert_eq!(counts(&[square(0.0, 0.0, 10.0), diamond], FillRule::EvenOdd), (1, 0));
        // Four squares around a gap, joined by corners only.
        let four =
            [square(0.0, 5.0, 5.0), square(5.0, 0.0, 5.0), square(10.0, 5.0, 5.0), square(5.0, 10.0, 5.0)];
        assert_eq!(counts(&four, FillRule::NonZero), (4, 0));
        // Two holes that meet in a corner are two holes: the gap does not retreat, the ink does.
        let holes = [square(0.0, 0.0, 10.0), hole(2.0, 2.0, 3.0), hole(5.0, 5.0, 3.0)];
        assert_eq!(counts(&holes, FillRule::NonZero), (1, 1));
    }

    #[test]
    fn a_bow_tie_is_two_triangles() {
        let bow = path(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)]);
        assert_eq!(counts(&[bow], FillRule::NonZero), (2, 0));
    }

    #[test]
    fn a_vertex_on_an_edge_is_a_touch() {
        let triangle = path(&[(10.0, 5.0), (14.0, 3.0), (14.0, 7.0)]);
        assert_eq!(counts(&[square(0.0, 0.0, 10.0), triangle], FillRule::NonZero), (2, 0));
    }

    #[test]
    fn from_contours_names_the_crossing() {
        let contours = [square(0.0, 0.0, 4.0), square(2.0, 3.0, 4.0)].map(|p| Contour::new(p).unwrap());
        let Err(RegionError::Invalid { faults }) = Region::from_contours(grid(), contours.to_vec()) else {
            panic!("crossing squares are no region")
        };
        assert!(faults.contains(&Fault::Crossing(DVec2::new(4.0, 3.0))), "{faults:?}");
        let triangle = path(&[(4.0, 2.0), (6.0, 1.0), (6.0, 3.0)]);
        let touching = [square(0.0, 0.0, 4.0), triangle].map(|p| Contour::new(p).unwrap());
        let Err(RegionError::Invalid { faults }) = Region::from_contours(grid(), touching.to_vec()) else {
            panic!("a vertex on an edge is no region")
        };
        assert_eq!(faults, [Fault::Crossing(DVec2::new(4.0, 2.0))]);
        let stray = [square(0.0, 0.0, 4.0), hole(6.0, 0.0, 2.0)].map(|p| Contour::new(p).unwrap());
        let Err(RegionError::Invalid { faults }) = Region::from_contours(grid(), stray.to_vec()) else {
            panic!("a hole outside of ink is no region")
        };
        assert_eq!(faults, [Fault::Nesting(DVec2::new(6.0, 0.0))]);
    }

    #[test]
    fn specks_are_left_out_and_named() {
        let paths =
            [square(0.0, 0.0, 10.0), hole(4.0, 4.0, 0.01), square(20.0, 0.0, 0.01), hole(6.0, 6.0, 2.0)];
        let region = Region::fill(grid(), &paths, FillRule::Positive);
        let (clean, specks) = region.without_specks(0.001);
        assert_eq!((clean.components(), clean.holes(), specks.len()), (1, 1, 2));
        assert!(specks.iter().any(|p| p.distance(DVec2::new(20.0, 0.0)) < 0.01));
        assert_eq!(region.without_specks(0.0).0, region);
    }

    #[test]
    fn what_is_in_both_is_exact() {
        let frame = [square(0.0, 0.0, 10.0), square(2.0, 2.0, 6.0)];
        let frame = Region::fill(grid(), &frame, FillRule::EvenOdd);
        let half = Region::fill(
            grid(),
            &[path(&[(5.0, -1.0), (20.0, -1.0), (20.0, 20.0), (5.0, 20.0)])],
            FillRule::NonZero,
        );
        let both = frame.within(&half);
        assert_eq!((both.components(), both.holes(), both.area_mm2()), (1, 0, 32.0));
        assert_eq!(half.within(&frame), both);
        assert!(both.without(&half).is_empty());
        assert!(frame.within(&Region::empty(grid())).is_empty());
    }

    #[test]
    fn offsets_change_the_counts_where_they_should() {
        // Two squares joined by a neck 1 mm wide.
        let dumbbell = [
            square(0.0, 0.0, 10.0),
            square(20.0, 0.0, 10.0),
            path(&[(9.0, 4.0), (21.0, 4.0), (21.0, 5.0), (9.0, 5.0)]),
        ];
        let region = Region::fill(grid(), &dumbbell, FillRule::NonZero);
        assert_eq!(region.components(), 1);
        assert_eq!(region.offset(-0.49, 0.01).components(), 1);
        assert_eq!(region.offset(-0.51, 0.01).components(), 2);
        assert_eq!(region.offset(4.9, 0.01).holes(), 0);
        let grown = region.offset(1.0, 0.001).area_mm2();
        let expected = 210.0 + 98.0 + std::f64::consts::TAU - 4.0;
        assert!((grown - expected).abs() < 0.02, "{grown} {expected}");
    }
}
