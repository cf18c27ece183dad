//! The inside of one path of an SVG file: a region that ornament is to fill.
//!
//! How the path is painted does not matter, nor what else is in the file, with one exception: a path that is filled encloses
//! what its fill covers. Without a fill it encloses what an odd number of its subpaths goes around, so that an outline inside of another
//! one is a hole, whichever way it was drawn.

use std::path::Path;

use kurbo::BezPath;

use super::curve::{Named, named};
use super::error::{ExemplarError, ExemplarFault};
use super::limits::Limits;
use super::outline::flat;
use super::parts::is_closed;
use crate::planar::{FillRule, Grid, GridError, Region};

/// The inside of the path with this `id` of the SVG file at `path`, or of its only path when no id is given: in millimetres, y
/// up, where the drawing has it on its page, within `chord_mm`. Polygons, rectangles, circles and ellipses are paths too.
///
/// # Errors
/// [`ExemplarError`] when the file cannot be read, holds no such path or no single one (the ids are listed),
/// or the path is broken, open, or encloses nothing.
pub fn read_area(
    path: &Path,
    id: Option<&str>,
    chord_mm: f64,
    limits: &Limits,
) -> Result<Region, ExemplarError> {
    let file = path.display().to_string();
    let bytes = super::read_bytes(path, limits).map_err(|fault| ExemplarError::new(&file, fault))?;
    parse(&bytes, id, chord_mm, limits).map_err(|fault| ExemplarError::new(file, fault))
}

/// [`read_area`] for a document in memory, which errors call `name`.
///
/// # Errors
/// As [`read_area`].
pub fn area_from_svg(
    name: &str,
    bytes: &[u8],
    id: Option<&str>,
    chord_mm: f64,
    limits: &Limits,
) -> Result<Region, ExemplarError> {
    parse(bytes, id, chord_mm, limits).map_err(|fault| ExemplarError::new(name, fault))
}

fn parse(bytes: &[u8], id: Option<&str>, chord_mm: f64, limits: &Limits) -> Result<Region, ExemplarFault> {
    let Named { place, path, rule } = named(bytes, id, limits)?;
    if !is_closed(&path) {
        return Err(ExemplarFault::OpenArea { place });
    }
    let bounds = path.control_box();
    let limit = Grid::MAX_EXTENT_MM;
    let far =
        [bounds.x0, bounds.y0, bounds.x1, bounds.y1].into_iter().find(|v| v.is_nan() || v.abs() > limit);
    if let Some(value) = far {
        return Err(ExemplarFault::Coordinate { place, value, limit, unit: "mm" });
    }
    let region = inside(&path, rule.unwrap_or(FillRule::EvenOdd), chord_mm)?;
    if region.is_empty() {
        return Err(ExemplarFault::NoArea { place });
    }
    Ok(region)
}

fn inside(path: &BezPath, rule: FillRule, chord_mm: f64) -> Result<Region, GridError> {
    let polygons = flat(path, chord_mm);
    let extent_mm = polygons.iter().flatten().fold(0.0, |far: f64, p| far.max(p.abs().max_element()));
    let grid = Grid::for_extent(extent_mm)?;
    let snapped = polygons
        .iter()
        .map(|polygon| polygon.iter().map(|&p| grid.snap(p)).collect())
        .collect::<Result<Vec<_>, GridError>>()?;
    Ok(Region::fill(grid, &snapped, rule))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(body: &str, id: Option<&str>) -> Result<Region, String> {
        let svg = format!("<svg width='100mm' height='100mm' viewBox='0 0 100 100'>\n{body}</svg>");
        area_from_svg("test", svg.as_bytes(), id, 0.01, &Limits::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn an_outline_inside_of_another_one_is_a_hole() {
        let frame = "M10 10H90V60H10Z M30 20H50V40H30Z";
        for paint in ["fill='none'", "fill='none' stroke='red'", "fill-rule='evenodd'"] {
            let region = area(&format!("<path d='{frame}' {paint}/>"), None).unwrap();
            assert_eq!((region.components(), region.holes()), (1, 1), "{paint}");
            assert!((region.area_mm2() - 3600.0).abs() < 1e-3);
            assert!(region.bounds_mm().unwrap().0.distance(glam::DVec2::new(10.0, 40.0)) < 1e-5);
        }
        assert_eq!(area(&format!("<path d='{frame}'/>"), None).unwrap().holes(), 0);
        let ring =
            area("<g transform='scale(2)'><circle id='c' cx='20' cy='20' r='10'/></g><path/>", Some("c"))
                .unwrap();
        assert!((ring.area_mm2() - std::f64::consts::PI * 400.0).abs() < 1.0);
    }

    #[test]
    fn what_encloses_nothing_is_named() {
        let says = |body: &str, id, wanted: &str| {
            let message = area(body, id).unwrap_err();
            assert!(message.contains(wanted), "{message}");
        };
        says("<path d='M0 0H9V9'/>", None, "<path> on line 2 is open");
        says("<path d='M0 0H9H0Z'/>", None, "encloses no area");
        says(
            "<path id='a' d='M0 0H9V9Z'/>",
            Some("b"),
            "has no element with the id \"b\"; its paths have the ids: a",
        );
        says(
            "<path id='a' d='M0 0H9V9Z'/><path d='M0 0H9V9Z'/>",
            None,
            "holds 2 paths, so one must be named",
        );
        says("<g id='a'/>", Some("a"), "is not a path");
    }
}
