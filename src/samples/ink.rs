//! What a drawing covers: its strokes with their pens, united with its elements.

use kurbo::{Cap, Join, Stroke};

use super::Drawing;
use crate::planar::{self, FillRule, Grid, GridError, GridPoint, Region};

/// The ink of a drawing on `grid`, where strokes have round ends and corners and stay within `chord_mm` of their true outlines.
///
/// # Errors
/// [`GridError`] for coordinates that are no numbers or too large.
pub fn inked(drawing: &Drawing, grid: Grid, chord_mm: f64) -> Result<Region, GridError> {
    let mut paths: Vec<Vec<GridPoint>> = Vec::new();
    for curve in &drawing.curves {
        let pen = Stroke::new(curve.width_mm).with_caps(Cap::Round).with_join(Join::Round);
        let polygons = planar::stroked(&curve.path, &pen, chord_mm, usize::MAX).unwrap_or_default();
        for polygon in polygons {
            paths.push(polygon.into_iter().map(|p| grid.snap(p)).collect::<Result<_, _>>()?);
        }
    }
    for contour in drawing.elements.iter().flat_map(|element| &element.contours) {
        paths.push(contour.iter().map(|&p| grid.snap(p)).collect::<Result<_, _>>()?);
    }
    Ok(Region::fill(grid, &paths, FillRule::Positive).without_cracks())
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
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
}
