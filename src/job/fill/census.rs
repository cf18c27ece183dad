//! How much of everything there is on an area: components, holes and ends that hang free, beside the exemplar's.

use glam::DVec2;
use kurbo::PathEl;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use schemars::JsonSchema;
use serde::Serialize;

use crate::planar::{FillRule, Region};
use crate::samples::{Curve, Drawing};

/// A hundred square centimetres.
pub(super) const AREA_MM2: f64 = 10_000.0;
/// Chords of curves for this are within so much of a pen.
const CHORD_PENS: f64 = 0.05;
/// An end lies on its own curve again if that is so many pens further along.
const AWAY_PENS: f64 = 2.0;
/// Windows along each direction.
const WINDOWS: usize = 3;
/// A window is in the domain if all but this part of it is.
const OUTSIDE: f64 = 1e-6;
/// Ends nearer than this to the border of a window are cut there, and do not dangle.
const BORDER_PENS: f64 = 1.0;

/// Counts for each 100 square centimetres.
///
/// What hangs together over a border is cut by it, the more the smaller the area is. So the exemplar and the pattern are counted in windows of the
/// same size, that of the box around the exemplar's lines, and the pattern's figures are means.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Density {
    /// Width and height of a window in millimetres.
    pub window_mm: [f64; 2],
    /// How many windows were counted; none where the domain has no room for one, and all of it was counted.
    pub windows: usize,
    /// Connected components for each 100 square centimetres.
    pub components: f64,
    /// Holes for each 100 square centimetres.
    pub holes: f64,
    /// Ends of curves that lie on no other ink, for each 100 square centimetres.
    pub dangling_ends: f64,
}

impl Density {
    /// That of a drawing and its ink in the windows of `size` that fit into `domain`, which is on the ink's grid.
    pub(super) fn new(drawing: &Drawing, ink: &Region, domain: &Region, size: DVec2) -> Self {
        let ends = dangling_ends(drawing);
        let pens = drawing.curves.iter().map(|curve| curve.width_mm);
        let margin = DVec2::splat(BORDER_PENS * pens.fold(0.0, f64::max));
        let windows: Vec<(DVec2, Region)> = corners(domain, size)
            .into_iter()
            .map(|low| (low, rectangle(ink, low, low + size)))
            .filter(|(_, window)| window.without(domain).area_mm2() <= OUTSIDE * window.area_mm2())
            .collect();
        if windows.is_empty() {
            return Self::of([ink.components(), ink.holes(), ends.len()], domain.area_mm2(), 0, size);
        }
        let counts = windows.iter().fold([0; 3], |[components, holes, dangling], (low, window)| {
            let seen = ink.within(window);
            let inside = |p: &&DVec2| p.cmpgt(low + margin).all() && p.cmplt(low + size - margin).all();
            let free = ends.iter().filter(inside).count();
            [components + seen.components(), holes + seen.holes(), dangling + free]
        });
        Self::of(counts, windows.len() as f64 * size.x * size.y, windows.len(), size)
    }

    fn of(counts: [usize; 3], area_mm2: f64, windows: usize, size: DVec2) -> Self {
        let [components, holes, dangling_ends] = counts.map(|count| count as f64 * AREA_MM2 / area_mm2);
        Self { window_mm: size.to_array(), windows, components, holes, dangling_ends }
    }
}

/// Lower left corners of windows all over the box of `domain`: one where there is room for no more.
fn corners(domain: &Region, size: DVec2) -> Vec<DVec2> {
    let (low, high) = domain.bounds_mm().unwrap_or_default();
    let room = (high - low - size).max(DVec2::ZERO);
    let count = |room: f64, size: f64| if room > 0.05 * size { WINDOWS } else { 1 };
    let places = |low: f64, room: f64, n: usize| {
        (0..n).map(move |i| low + room * if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 })
    };
    let columns = count(room.x, size.x);
    places(low.y, room.y, count(room.y, size.y))
        .flat_map(|y| places(low.x, room.x, columns).map(move |x| DVec2::new(x, y)))
        .collect()
}

/// A rectangle on the ink's grid; none if it does not fit there.
fn rectangle(ink: &Region, low: DVec2, high: DVec2) -> Region {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let path: Result<Vec<_>, _> = corners.iter().map(|&p| ink.grid().snap(p)).collect();
    path.map_or_else(
        |_| Region::empty(ink.grid()),
        |path| Region::fill(ink.grid(), &[path], FillRule::NonZero),
    )
}

/// A straight piece of ink.
struct Stretch {
    ends: [DVec2; 2],
    /// How far its ink reaches from it.
    reach_mm: f64,
    /// The curve that it is of, and how far along it begins and ends; `None` for the border of an element.
    of: Option<(usize, [f64; 2])>,
}

impl RTreeObject for Stretch {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.ends[0].to_array(), self.ends[1].to_array())
    }
}

impl PointDistance for Stretch {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        let [a, b] = self.ends;
        let (along, p) = (b - a, DVec2::from(*point));
        let part = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (a + part * along).distance_squared(p)
    }
}

/// The ends of open curves that lie on no other ink.
fn dangling_ends(drawing: &Drawing) -> Vec<DVec2> {
    let mut stretches = Vec::new();
    for (number, curve) in drawing.curves.iter().enumerate() {
        let mut along_mm = 0.0;
        for ends in chords(curve).windows(2).map(|pair| [pair[0], pair[1]]) {
            let to_mm = along_mm + ends[0].distance(ends[1]);
            let of = Some((number, [along_mm, to_mm]));
            stretches.push(Stretch { ends, reach_mm: 0.5 * curve.width_mm, of });
            along_mm = to_mm;
        }
    }
    for contour in drawing.elements.iter().flat_map(|element| &element.contours) {
        let ends = |i: usize| [contour[i], contour[(i + 1) % contour.len()]];
        stretches.extend((0..contour.len()).map(|i| Stretch { ends: ends(i), reach_mm: 0.0, of: None }));
    }
    let widest_mm = drawing.curves.iter().map(|curve| curve.width_mm).fold(0.0, f64::max);
    let tree = RTree::bulk_load(stretches);
    let is_held = |number: usize, curve: &Curve, at: DVec2, along_mm: f64| {
        let mut near = tree.locate_within_distance(at.to_array(), widest_mm * widest_mm);
        near.any(|stretch| {
            let away_mm = AWAY_PENS * curve.width_mm;
            let is_own = stretch.of.is_some_and(|(of, [from, to])| {
                of == number && (from - away_mm..=to + away_mm).contains(&along_mm)
            });
            // The cap of an end touches an element beside it.
            let reach_mm = if stretch.of.is_some() { stretch.reach_mm } else { 0.5 * curve.width_mm };
            !is_own && stretch.distance_2(&at.to_array()) <= reach_mm * reach_mm
        }) || drawing.elements.iter().any(|element| winding(&element.contours, at) != 0)
    };
    let mut dangling = Vec::new();
    for (number, curve) in drawing.curves.iter().enumerate() {
        if matches!(curve.path.elements().last(), None | Some(PathEl::ClosePath)) {
            continue;
        }
        let points = chords(curve);
        let length_mm: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let ends = [(points[0], 0.0), (points[points.len() - 1], length_mm)];
        let free = ends.into_iter().filter(|&(at, along_mm)| !is_held(number, curve, at, along_mm));
        dangling.extend(free.map(|(at, _)| at));
    }
    dangling
}

fn chords(curve: &Curve) -> Vec<DVec2> {
    let mut points = Vec::new();
    let mut put = |p: kurbo::Point| points.push(DVec2::new(p.x, p.y));
    let mut start = kurbo::Point::ZERO;
    let tolerance = (CHORD_PENS * curve.width_mm).max(1e-3);
    kurbo::flatten(&curve.path, tolerance, |el| match el {
        PathEl::MoveTo(p) => {
            start = p;
            put(p);
        }
        PathEl::ClosePath => put(start),
        el => el.end_point().into_iter().for_each(&mut put),
    });
    points
}

/// How often closed polygons go round a point.
fn winding(contours: &[Vec<DVec2>], p: DVec2) -> i32 {
    let crosses = |a: DVec2, b: DVec2| match (a.y <= p.y, b.y <= p.y) {
        (true, false) if (b - a).perp_dot(p - a) > 0.0 => 1,
        (false, true) if (b - a).perp_dot(p - a) < 0.0 => -1,
        _ => 0,
    };
    let of = |contour: &Vec<DVec2>| -> i32 {
        let n = contour.len();
        (0..n).map(|i| crosses(contour[i], contour[(i + 1) % n])).sum()
    };
    contours.iter().map(of).sum()
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::samples::Element;

    fn ends(paths: &[&str], elements: Vec<Element>) -> usize {
        let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        dangling_ends(&Drawing { curves: paths.iter().map(curve).collect(), elements }).len()
    }

    #[test]
    fn ends_on_other_ink_do_not_dangle() {
        assert_eq!(ends(&["M0 0H50"], vec![]), 2);
        assert_eq!(ends(&["M0 0H50", "M20 0V30"], vec![]), 3);
        assert_eq!(ends(&["M0 0H50", "M20 0.6V30", "M0 0V9"], vec![]), 4);
        assert_eq!(ends(&["M0 0H50V50H0Z"], vec![]), 0);
        // A loop that comes back to itself.
        assert_eq!(ends(&["M0 0H50V50H20V0"], vec![]), 1);
        let leaf = [(40.0, -2.0), (60.0, -2.0), (60.0, 2.0), (40.0, 2.0)].map(|(x, y)| DVec2::new(x, y));
        let leaf = Element { contours: vec![leaf.to_vec()] };
        assert_eq!(ends(&["M0 0H50", "M61 0H70", "M60.4 0V9"], vec![leaf]), 4);
    }
}
