//! What a drawing covers: its strokes with their pens, united with its elements.

use glam::DVec2;
use kurbo::{Cap, Join, Stroke};

use super::{Area, Drawing};
use crate::planar::{self, FillRule, Grid, GridError, GridPoint, Region};

/// The ink of a drawing on `grid`, where strokes have round ends and corners. They are nowhere narrower than their pens, and their outlines are
/// within twice `chord_mm` of the true ones.
///
/// # Errors
/// [`GridError`] for coordinates that are no numbers or too large.
pub fn inked(drawing: &Drawing, grid: Grid, chord_mm: f64) -> Result<Region, GridError> {
    united(&polygons(drawing, chord_mm), grid)
}

/// The plane in which the ink of an area is counted: the area's own, or for a rolled one a ring whose inside is below it. All of a
/// lap is on it once, so components and holes are those of the rolled ink as it stands; and as always the inside of a ring is a hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CountingPlane {
    /// Of a rolled area, the length of its lap, and what y has to be raised by to be a radius.
    ring: Option<(f64, f64)>,
}

impl CountingPlane {
    pub fn of(area: &Area) -> Self {
        let (low, _) = area.bounds_mm();
        Self { ring: area.lap_mm().map(|lap_mm| (lap_mm, lap_mm / std::f64::consts::TAU - low.y)) }
    }

    /// Where a place of the area is.
    pub fn place(self, p: DVec2) -> DVec2 {
        match self.ring {
            // Clockwise, which keeps ink on the left.
            Some((lap_mm, raise_mm)) => {
                DVec2::from_angle(-std::f64::consts::TAU * p.x / lap_mm) * (p.y + raise_mm)
            }
            None => p,
        }
    }

    /// The place of the area that is there.
    pub fn back(self, p: DVec2) -> DVec2 {
        match self.ring {
            Some((lap_mm, raise_mm)) => {
                let x = -p.to_angle() / std::f64::consts::TAU * lap_mm;
                DVec2::new(x.rem_euclid(lap_mm), p.length() - raise_mm)
            }
            None => p,
        }
    }

    /// The middle of the ring, if it is one.
    pub fn middle(self) -> Option<DVec2> {
        self.ring.map(|_| DVec2::ZERO)
    }

    /// The ink of a drawing of the area.
    pub fn inked(self, drawing: &Drawing, grid: Grid, chord_mm: f64) -> Result<Region, GridError> {
        let mut polygons = polygons(drawing, chord_mm);
        if self.ring.is_some() {
            polygons.iter_mut().for_each(|polygon| *polygon = self.bent(polygon, chord_mm));
        }
        united(&polygons, grid)
    }

    /// A polygon as it lies on the ring, with as many points as its sides need to be within `chord_mm` of what they become.
    fn bent(self, polygon: &[DVec2], chord_mm: f64) -> Vec<DVec2> {
        let mut points = Vec::with_capacity(polygon.len());
        for (&a, &b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            // Polygons that share a side have to share its points: it is parted the same way whichever way it runs.
            let is_forward = (a.x, a.y) <= (b.x, b.y);
            let (from, to) = if is_forward { (a, b) } else { (b, a) };
            let (lap_mm, raise_mm) = self.ring.unwrap_or((f64::INFINITY, 0.0));
            let radius_mm = (from.y.max(to.y) + raise_mm).max(chord_mm);
            let angle = std::f64::consts::TAU * (to.x - from.x) / lap_mm;
            let step = 2.0 * (1.0 - chord_mm / radius_mm).max(0.0).acos();
            let steps = (angle / step).ceil().clamp(1.0, 1e4) as u32;
            let part = |i: u32| from.lerp(to, f64::from(i) / f64::from(steps));
            let parts = (0..steps).map(|i| if is_forward { part(i) } else { part(steps - i) });
            points.extend(parts.map(|p| self.place(p)));
        }
        points
    }
}

/// Polygons that cover what is drawn, with the ink on their left.
fn polygons(drawing: &Drawing, chord_mm: f64) -> Vec<Vec<DVec2>> {
    let strokes = drawing.curves.iter().flat_map(|curve| {
        // Chords of a round outline lie inside of it, and a pen as wide as a machine's least width must not come out narrower.
        let pen = Stroke::new(curve.width_mm + 2.0 * chord_mm).with_caps(Cap::Round).with_join(Join::Round);
        planar::stroked(&curve.path, &pen, chord_mm, usize::MAX).unwrap_or_default()
    });
    let contours = drawing.elements.iter().flat_map(|element| &element.contours);
    strokes.chain(contours.cloned()).collect()
}

fn united(polygons: &[Vec<DVec2>], grid: Grid) -> Result<Region, GridError> {
    let snapped = |polygon: &Vec<DVec2>| polygon.iter().map(|&p| grid.snap(p)).collect();
    let paths: Vec<Vec<GridPoint>> = polygons.iter().map(snapped).collect::<Result<_, _>>()?;
    Ok(Region::fill(grid, &paths, FillRule::Positive).without_cracks())
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;
    use crate::samples::{Curve, Element};

    #[test]
    fn strokes_and_elements_are_one_ink() {
        let square = |side: f64| {
            [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        };
        let inner = square(6.0).into_iter().rev().map(|p| p + 2.0).collect();
        let curve = |d: &str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
        let mut drawing =
            Drawing { curves: Vec::new(), elements: vec![Element { contours: vec![square(10.0), inner] }] };
        let counts = |drawing: &Drawing| {
            let region = inked(drawing, Grid::for_extent(60.0).unwrap(), 0.01).unwrap();
            (region.components(), region.holes())
        };
        assert_eq!(counts(&drawing), (1, 1));
        drawing.curves.push(curve("M5 1V9"));
        assert_eq!(counts(&drawing), (1, 2));
        drawing.curves.push(curve("M20 5C25 0 25 10 30 5"));
        assert_eq!(counts(&drawing), (2, 2));
        drawing.curves.push(curve("M10 5H20"));
        assert_eq!(counts(&drawing), (1, 2));
    }

    #[test]
    fn strokes_are_as_wide_as_their_pen_everywhere() {
        let curve = Curve { path: BezPath::from_svg("M5 5C30 0 5 30 40 20L20 45").unwrap(), width_mm: 1.0 };
        let ink = |chord_mm: f64| {
            let drawing = Drawing { curves: vec![curve.clone()], elements: Vec::new() };
            inked(&drawing, Grid::for_extent(60.0).unwrap(), chord_mm).unwrap()
        };
        let middle: Vec<DVec2> =
            planar::chords(&curve.path, 1e-6).into_iter().flat_map(|line| line.points).collect();
        for chord_mm in [0.05, 0.0025] {
            let outline = planar::EdgeIndex::new(&ink(chord_mm));
            let half_mm = |p: &DVec2| outline.nearest(*p).unwrap().nearest(*p).distance(*p);
            let widths = middle.iter().map(half_mm);
            let (least, most) =
                widths.fold((f64::MAX, 0.0_f64), |(least, most), w| (least.min(w), most.max(w)));
            assert!(least >= 0.5 - 1e-5 && most <= 0.5 + 2.0 * chord_mm, "{chord_mm}: {least} {most}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let mut path = BezPath::new();
        path.move_to((0.0, 0.0));
        path.line_to((1e9, 0.0));
        let drawing = Drawing { curves: vec![Curve { path, width_mm: 1.0 }], elements: Vec::new() };
        assert!(matches!(
            inked(&drawing, Grid::for_extent(60.0).unwrap(), 0.01),
            Err(GridError::Extent { .. })
        ));
    }

    #[test]
    fn a_lap_is_counted_as_it_stands() {
        let grid = Grid::for_extent(200.0).unwrap();
        let path = [(-20.0, 0.0), (60.0, 0.0), (60.0, 20.0), (-20.0, 20.0)];
        let path = path.map(|(x, y)| grid.snap(DVec2::new(x, y)).unwrap()).to_vec();
        let area = Area::rolled(Region::fill(grid, &[path], FillRule::Positive), 40.0);
        let plane = CountingPlane::of(&area);
        for p in [DVec2::new(3.0, 5.0), DVec2::new(39.0, 20.0)] {
            assert!(plane.back(plane.place(p)).distance(p) < 1e-9);
        }
        let counts = |lines: &[&str]| {
            let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
            let drawing = Drawing { curves: lines.iter().map(curve).collect(), elements: Vec::new() };
            let region = plane.inked(&drawing, grid, 0.01).unwrap();
            (region.components(), region.holes())
        };
        assert_eq!(counts(&["M10 5H30"]), (1, 0));
        assert_eq!(counts(&["M10 5H50"]), (1, 1));
        assert_eq!(counts(&["M10 5H50", "M10 15H50"]), (2, 2));
        assert_eq!(counts(&["M10 5H50", "M10 15H50", "M0 5V15", "M40 8V20"]), (1, 2));
    }
}
