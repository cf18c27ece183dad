//! How much of everything there is on an area: components, holes and ends that hang free, beside the exemplar's.

use std::path::Path;

use glam::DVec2;
use kurbo::PathEl;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use schemars::JsonSchema;
use serde::Serialize;

use super::engine::unlearnt;
use super::ground::grid_error;
use crate::exemplar::Linework;
use crate::job::error::JobError;
use crate::planar::{Chords, EdgeIndex, FillRule, Grid, GridPoint, Part, Region, chords};
use crate::samples::{Curve, Drawing, SampleError, inked};

/// A hundred square centimetres.
pub(super) const AREA_MM2: f64 = 10_000.0;
/// Chords of curves for this are within so much of a pen.
const CHORD_PENS: f64 = 0.05;
/// An end lies on its own curve again if that is so many pens further along.
const AWAY_PENS: f64 = 2.0;
/// Ends nearer than so many pens to the border are cut there, and do not dangle.
const BORDER_PENS: f64 = 1.0;
/// Ink within this part of the pen of the border is cut by it.
const CUT_PENS: f64 = 0.1;

/// Counts for each 100 square centimetres.
///
/// A border cuts what hangs together, the more the smaller the area is, so plain counts of a small exemplar and of a large pattern cannot be compared.
/// Every cut therefore takes half from the component that it cuts: halves on both sides make one. Holes follow from the Euler
/// characteristic, of which the border has half as well (the usual estimate from a window, Stoyan, Kendall and Mecke 1995, §6).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Density {
    /// The mean area of the windows that were counted, in square millimetres.
    pub area_mm2: f64,
    /// Connected components for each 100 square centimetres.
    pub components: f64,
    /// Holes for each 100 square centimetres.
    pub holes: f64,
    /// Ends of curves that lie on no other ink, for each 100 square centimetres.
    pub dangling_ends: f64,
    /// The part of the area that is ink, from 0 to 1.
    pub ink: f64,
}

impl Density {
    /// The mean of several, at least one.
    pub(super) fn mean(all: Vec<Self>) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Self {
            area_mm2: mean(|d| d.area_mm2),
            components: mean(|d| d.components),
            holes: mean(|d| d.holes),
            dangling_ends: mean(|d| d.dangling_ends),
            ink: mean(|d| d.ink),
        }
    }

    /// That of a drawing and its ink, which does not leave `window` and is on its grid.
    pub(super) fn new(drawing: &Drawing, ink: &Region, window: &Region) -> Self {
        let pen_mm = drawing.curves.iter().map(|curve| curve.width_mm).fold(0.0, f64::max);
        let cut_mm = CUT_PENS * if pen_mm > 0.0 { pen_mm } else { window.area_mm2().sqrt() / 100.0 };
        let inner = window.offset(-cut_mm, cut_mm / 4.0);
        let cuts = ink.within(&window.without(&inner));
        let mut of_part = vec![0usize; ink.components()];
        for cut in cuts.parts() {
            let owner = ink.parts().iter().position(|part| inside(cut).is_some_and(|p| part.covers(p)));
            owner.into_iter().for_each(|owner| of_part[owner] += 1);
        }
        let components: f64 = of_part
            .iter()
            .zip(ink.parts())
            .map(|(&cuts, part)| match 1.0 - 0.5 * cuts as f64 {
                // What hangs together in rings does so outside too, and is one with what is cut off.
                share if !part.holes().is_empty() => share.max(0.0),
                share => share,
            })
            .sum();
        let euler = |region: &Region| region.components() as f64 - region.holes() as f64;
        let holes = components - (euler(ink) - 0.5 * euler(&cuts));
        let border = EdgeIndex::new(window);
        let is_free = |p: &&DVec2| {
            let border_mm = border.nearest(**p).map_or(f64::INFINITY, |edge| edge.nearest(**p).distance(**p));
            border_mm > BORDER_PENS * pen_mm
                && window.grid().snap(**p).is_ok_and(|p| window.parts().iter().any(|part| part.covers(p)))
        };
        let ends = dangling_ends(drawing);
        let area_mm2 = window.area_mm2();
        let density = |count: f64| count.max(0.0) * AREA_MM2 / area_mm2;
        Self {
            area_mm2,
            components: density(components),
            holes: density(holes),
            dangling_ends: density(ends.iter().filter(is_free).count() as f64),
            ink: ink.area_mm2() / area_mm2,
        }
    }
}

/// A point inside of a part: half-way between the neighbours of a vertex where that is inside.
fn inside(part: &Part) -> Option<GridPoint> {
    let points = part.exterior().points();
    let n = points.len();
    let between = |a: GridPoint, b: GridPoint| GridPoint::new(a.x.midpoint(b.x), a.y.midpoint(b.y));
    (0..n).map(|i| between(points[i], points[(i + 2) % n])).find(|&p| part.covers(p))
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
        for ends in line(curve).windows(2).map(|pair| [pair[0], pair[1]]) {
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
        let points = line(curve);
        let length_mm: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let ends = [(points[0], 0.0), (points[points.len() - 1], length_mm)];
        let free = ends.into_iter().filter(|&(at, along_mm)| !is_held(number, curve, at, along_mm));
        dangling.extend(free.map(|(at, _)| at));
    }
    dangling
}

/// The line of a curve; none if it has no subpath.
fn line(curve: &Curve) -> Vec<DVec2> {
    let tolerance = (CHORD_PENS * curve.width_mm).max(1e-3);
    chords(&curve.path, tolerance).into_iter().next().map_or_else(Vec::new, Chords::way)
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

/// Parts of an exemplar's shorter side that are left out all around when it and what was made of it are counted, one after the other, as how a
/// drawing ends is not what it is like inside. Of several windows the mean is steadier.
const BORDERS: [f64; 4] = [0.05, 0.1, 0.15, 0.2];
/// What is left of a narrow area has to be this part of it, or it is nearly all border.
const LEAST_WINDOW: f64 = 0.25;

/// How much of everything an exemplar has, away from the border of its page, or of the box around its lines where these are not on the page; and
/// how long its shorter side is.
pub(super) fn density_of(
    file: &Path,
    exemplar: &Drawing,
    linework: &Linework,
    chord_mm: f64,
) -> Result<(Density, f64), JobError> {
    let Some((low, high)) = exemplar.bounds_mm() else {
        return Err(unlearnt(file, SampleError::Empty));
    };
    let page = DVec2::from(linework.page_mm());
    let grid = Grid::for_extent(low.abs().max(high.abs()).max(page).max_element()).map_err(grid_error)?;
    let ink = inked(exemplar, grid, chord_mm).map_err(grid_error)?;
    let pen = DVec2::splat(exemplar.curves.iter().map(|curve| curve.width_mm).fold(chord_mm, f64::max));
    let is_on_page = low.cmpge(-pen).all() && high.cmple(page + pen).all();
    // A single straight line has a box without area.
    let (low, high) = if is_on_page { (DVec2::ZERO, page) } else { (low, high.max(low + pen)) };
    let side_mm = (high - low).min_element();
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let path = corners.iter().map(|&p| grid.snap(p)).collect::<Result<Vec<_>, _>>().map_err(grid_error)?;
    let window = Region::fill(grid, &[path], FillRule::NonZero);
    Ok((density_inside(exemplar, &ink.within(&window), &window, side_mm), side_mm))
}

/// How much of everything there is inside of an area, for an exemplar whose shorter side is `side_mm`: the mean of windows, or on all of the area where none
/// has room.
pub(super) fn density_inside(drawing: &Drawing, ink: &Region, area: &Region, side_mm: f64) -> Density {
    let window = |part: &f64| area.offset(-part * side_mm, part * side_mm / 10.0);
    let least_mm2 = LEAST_WINDOW * area.area_mm2();
    let windows: Vec<Region> =
        BORDERS.iter().map(window).filter(|window| window.area_mm2() > least_mm2).collect();
    let windows = if windows.is_empty() { vec![area.clone()] } else { windows };
    Density::mean(windows.iter().map(|window| Density::new(drawing, &ink.within(window), window)).collect())
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::planar::{FillRule, Grid};
    use crate::samples::Element;

    fn ends(paths: &[&str], elements: Vec<Element>) -> usize {
        let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        dangling_ends(&Drawing { curves: paths.iter().map(curve).collect(), elements }).len()
    }

    /// Bars of a lattice that goes on beyond the window, and a dot in each mesh: none of the lattice's components, one hole and one dot a mesh.
    #[test]
    fn cuts_at_the_border_count_half() {
        let grid = Grid::for_extent(200.0).unwrap();
        let rectangle = |x: f64, y: f64, w: f64, h: f64| {
            let corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)];
            corners.map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).to_vec()
        };
        let bars = (0..10).flat_map(|i| {
            let at = 10.0 * f64::from(i) + 4.5;
            [rectangle(at, -50.0, 1.0, 200.0), rectangle(-50.0, at, 200.0, 1.0)]
        });
        let dots = (0..11)
            .flat_map(|i| (0..11).map(move |j| (10.0 * f64::from(i) - 1.0, 10.0 * f64::from(j) - 1.0)));
        let paths: Vec<_> = bars.chain(dots.map(|(x, y)| rectangle(x, y, 2.0, 2.0))).collect();
        let ink = Region::fill(grid, &paths, FillRule::NonZero);
        for [x, y, w, h] in [[0.0, 0.0, 100.0, 100.0], [3.0, 1.7, 60.0, 80.0], [10.0, 20.0, 50.0, 50.0]] {
            let window = Region::fill(grid, &[rectangle(x, y, w, h)], FillRule::NonZero);
            let found = Density::new(&Drawing::default(), &ink.within(&window), &window);
            // 100 meshes to the 100 cm2; corners are neglected.
            assert!((found.components - 100.0).abs() < 8.0, "{found:?}");
            assert!((found.holes - 100.0).abs() < 8.0, "{found:?}");
            // A fifth of each mesh is bar, less where they cross, and a twenty-fifth dot.
            assert!((found.ink - 0.23).abs() < 0.03, "{found:?}");
        }
    }

    #[test]
    fn a_strip_that_is_all_border_is_counted_whole() {
        let grid = Grid::for_extent(200.0).unwrap();
        let rectangle = |w: f64, h: f64| {
            let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
            let path = corners.map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).to_vec();
            Region::fill(grid, &[path], FillRule::NonZero)
        };
        // Windows that are narrower by 2, 4, 6 and 8 mm, as far as they have room.
        for (height, area_mm2) in [(20.0, 1430.0), (12.0, 670.0), (5.0, 294.0), (1.0, 100.0)] {
            let area = rectangle(100.0, height);
            let found = density_inside(&Drawing::default(), &Region::empty(grid), &area, 20.0);
            assert!((found.area_mm2 - area_mm2).abs() < 1.0, "{height}: {found:?}");
        }
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
