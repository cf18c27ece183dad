//! From painted curves to one region: strokes become outlines, curves become chords, all becomes one union.
//!
//! Curves are flattened and strokes expanded within half of the chord error. Every shape is filled by its own
//! rule; the boundaries are then united under one rule that counts windings, and only the final union is made a
//! [`Region`], so that ink which merely touches in one path can still be joined by another. A clip is an exact
//! intersection: inside of both is where the windings of both, less one, are positive.

use glam::DVec2;
use kurbo::{Affine, BezPath, ParamCurveArclen};

use super::artwork::{Artwork, Brush, Clip, Item, Shape};
use super::error::{ExemplarFault, Place};
use super::limits::Limits;
use crate::planar::{Contour, FillRule, Grid, GridError, GridPoint, Region, boundaries, chords, stroked};

/// A dash of no length becomes one of this part of the stroke's width, so that its caps have a direction.
const DOT: f64 = 1e-4;
/// Rounding of coordinates to `f32` may move a point by this part of the drawing's size, no more.
const MAX_ROUNDING: f64 = 1e-4;

/// A shape as closed polygons in millimetres.
struct Flat {
    place: Place,
    polygons: Vec<Vec<DVec2>>,
    rule: FillRule,
    /// Whether it is a mistake when the shape covers nothing.
    needs_area: bool,
}

/// The region of `artwork` scaled by `scale` about the origin, with curves flattened within `chord_mm`.
pub(super) fn region(
    artwork: &Artwork,
    scale: f64,
    chord_mm: f64,
    limits: &Limits,
) -> Result<Region, ExemplarFault> {
    if artwork.items.is_empty() {
        return Err(ExemplarFault::NoInk);
    }
    let region = regions(&[&artwork.items], scale, chord_mm, limits)?.swap_remove(0);
    let Some((low, high)) = region.bounds_mm() else { return Err(ExemplarFault::NoInk) };
    check_precision(&artwork.items, scale, (high - low).max_element())?;
    Ok(region)
}

/// The region of each of the `drawings`, on one grid.
pub(super) fn regions(
    drawings: &[&[Item<Shape>]],
    scale: f64,
    chord_mm: f64,
    limits: &Limits,
) -> Result<Vec<Region>, ExemplarFault> {
    let mut flattener = Flattener { scale, chord_mm, limits, vertices: 0, dashes: 0.0, extent_mm: 0.0 };
    let drawings: Vec<Vec<Item<Flat>>> = drawings
        .iter()
        .map(|items| items.iter().map(|item| item.try_map(&mut |shape| flattener.flatten(shape))).collect())
        .collect::<Result<_, _>>()?;
    let grid = Grid::for_extent(flattener.extent_mm)?;
    let filler = Filler { grid };
    drawings
        .iter()
        .map(|items| Ok(Region::fill(grid, &filler.union(items)?, FillRule::Positive).without_cracks()))
        .collect()
}

/// The SVG library's coordinates are `f32`: a small drawing far from its origin has lost its shape.
pub(super) fn check_precision(items: &[Item<Shape>], scale: f64, size_mm: f64) -> Result<(), ExemplarFault> {
    for item in items {
        match item {
            Item::Shape(shape) => {
                let bounds = shape.path.control_box();
                let far = [bounds.x0, bounds.y0, bounds.x1, bounds.y1]
                    .into_iter()
                    .fold(0.0, |m: f64, v: f64| m.max(v.abs()));
                let far_mm = far * largest_scale(shape.to_mm) * scale;
                if far_mm * f64::from(f32::EPSILON) > MAX_ROUNDING * size_mm {
                    return Err(ExemplarFault::Imprecise {
                        place: shape.place.clone(),
                        ratio: far_mm / size_mm,
                    });
                }
            }
            Item::Clipped(items, _) => check_precision(items, scale, size_mm)?,
        }
    }
    Ok(())
}

/// The most by which an affine map lengthens.
pub(super) fn largest_scale(affine: Affine) -> f64 {
    let [a, b, c, d, _, _] = affine.as_coeffs();
    let (x2, y2) = (a * a + b * b, c * c + d * d);
    ((x2 + y2 + (x2 - y2).hypot(2.0 * (a * c + b * d))) / 2.0).sqrt()
}

struct Flattener<'a> {
    scale: f64,
    chord_mm: f64,
    limits: &'a Limits,
    vertices: usize,
    dashes: f64,
    extent_mm: f64,
}

impl Flattener<'_> {
    fn flatten(&mut self, shape: &Shape) -> Result<Flat, ExemplarFault> {
        let to_mm = Affine::scale(self.scale) * shape.to_mm;
        let bounds = to_mm.transform_rect_bbox(shape.path.control_box());
        self.check_range(&shape.place, [bounds.x0, bounds.y0, bounds.x1, bounds.y1])?;
        let (polygons, rule) = match &shape.brush {
            Brush::Fill(rule) | Brush::FillUnderStroke(rule) => {
                (flat(&(to_mm * &shape.path), self.chord_mm / 2.0), *rule)
            }
            Brush::Stroke(style) => (self.stroked(shape, style, to_mm)?, FillRule::NonZero),
        };
        self.vertices += polygons.iter().map(Vec::len).sum::<usize>();
        if self.vertices > self.limits.vertices {
            return Err(ExemplarFault::TooManyVertices {
                place: shape.place.clone(),
                limit: self.limits.vertices,
            });
        }
        for p in polygons.iter().flatten() {
            self.extent_mm = self.extent_mm.max(p.abs().max_element());
        }
        self.check_range(&shape.place, [self.extent_mm; 4])?;
        Ok(Flat {
            place: shape.place.clone(),
            polygons,
            rule,
            needs_area: matches!(shape.brush, Brush::Fill(_)),
        })
    }

    fn check_range(&self, place: &Place, values: [f64; 4]) -> Result<(), ExemplarFault> {
        let limit = Grid::MAX_EXTENT_MM;
        match values.into_iter().find(|v| v.is_nan() || v.abs() > limit) {
            Some(value) => Err(ExemplarFault::Coordinate { place: place.clone(), value, limit, unit: "mm" }),
            None => Ok(()),
        }
    }

    /// What a stroke covers. It is made in the shape's own units: what a transform does to a shape, it does to
    /// its stroke.
    fn stroked(
        &mut self,
        shape: &Shape,
        style: &kurbo::Stroke,
        to_mm: Affine,
    ) -> Result<Vec<Vec<DVec2>>, ExemplarFault> {
        let tolerance = self.chord_mm / 2.0 / largest_scale(to_mm);
        let dashed;
        let path = if style.dash_pattern.is_empty() {
            &shape.path
        } else {
            dashed = self.dashed(shape, style, tolerance)?;
            &dashed
        };
        let limit = self.limits.vertices;
        let mut polygons = stroked(path, style, tolerance, limit)
            .ok_or_else(|| ExemplarFault::TooManyVertices { place: shape.place.clone(), limit })?;
        for p in polygons.iter_mut().flatten() {
            let q = to_mm * kurbo::Point::new(p.x, p.y);
            *p = DVec2::new(q.x, q.y);
        }
        Ok(polygons)
    }

    fn dashed(
        &mut self,
        shape: &Shape,
        style: &kurbo::Stroke,
        tolerance: f64,
    ) -> Result<BezPath, ExemplarFault> {
        let dot = DOT * style.width;
        let mut pattern = style.dash_pattern.clone();
        for dash in pattern.chunks_exact_mut(2).filter(|dash| dash[0] == 0.0) {
            // The gap gives what the dash takes, or the dots would drift.
            (dash[0], dash[1]) = (dot, (dash[1] - dot).max(0.0));
        }
        let period = pattern.iter().sum::<f64>();
        let length: f64 = shape.path.segments().map(|s| s.arclen(period.max(tolerance))).sum();
        self.dashes += length / period * pattern.len() as f64;
        if self.dashes > self.limits.segments as f64 {
            return Err(ExemplarFault::TooManySegments {
                place: shape.place.clone(),
                limit: self.limits.segments,
            });
        }
        Ok(kurbo::dash(shape.path.iter(), style.dash_offset, &pattern).collect())
    }
}

/// The vertices of each subpath, within `tolerance_mm`.
pub(super) fn flat(path: &BezPath, tolerance_mm: f64) -> Vec<Vec<DVec2>> {
    chords(path, tolerance_mm).into_iter().map(|subpath| subpath.points).collect()
}

struct Filler {
    grid: Grid,
}

type Paths = Vec<Vec<GridPoint>>;

impl Filler {
    /// Boundaries whose windings add up to more than zero where there is ink.
    fn union(&self, items: &[Item<Flat>]) -> Result<Paths, ExemplarFault> {
        let mut paths = Vec::new();
        for item in items {
            match item {
                Item::Shape(flat) => paths.extend(self.fill(flat)?),
                Item::Clipped(items, clip) => {
                    let clip = self.clip(clip)?;
                    paths.extend(intersection(self.union(items)?, clip));
                }
            }
        }
        Ok(paths)
    }

    fn clip(&self, clip: &Clip<Flat>) -> Result<Paths, ExemplarFault> {
        let paths = self.union(&clip.items)?;
        match &clip.within {
            Some(within) => Ok(intersection(paths, self.clip(within)?)),
            None => Ok(paths),
        }
    }

    fn fill(&self, flat: &Flat) -> Result<Paths, ExemplarFault> {
        let snap = |polygon: &Vec<DVec2>| {
            polygon.iter().map(|&p| self.grid.snap(p)).collect::<Result<Vec<_>, GridError>>()
        };
        let polygons: Vec<_> = flat.polygons.iter().map(snap).collect::<Result<_, _>>()?;
        let paths = simple(&polygons, flat.rule);
        if paths.is_empty() && flat.needs_area {
            return Err(ExemplarFault::NoArea { place: flat.place.clone() });
        }
        Ok(paths)
    }
}

fn simple(paths: &[Vec<GridPoint>], rule: FillRule) -> Paths {
    boundaries(paths, rule).iter().map(|c: &Contour| c.points().to_vec()).collect()
}

/// Where both sets of boundaries have ink.
fn intersection(a: Paths, b: Paths) -> Paths {
    let a = simple(&a, FillRule::Positive);
    let b = simple(&b, FillRule::Positive);
    let all = || a.iter().chain(&b).flatten();
    let (Some(x0), Some(x1)) = (all().map(|p| p.x).min(), all().map(|p| p.x).max()) else {
        return Vec::new();
    };
    let (Some(y0), Some(y1)) = (all().map(|p| p.y).min(), all().map(|p| p.y).max()) else {
        return Vec::new();
    };
    // One winding less everywhere: a clockwise frame around all of it.
    let frame = [(x0 - 1, y0 - 1), (x0 - 1, y1 + 1), (x1 + 1, y1 + 1), (x1 + 1, y0 - 1)];
    let frame = frame.map(|(x, y)| GridPoint::new(x, y)).to_vec();
    let paths: Paths = a.into_iter().chain(b).chain([frame]).collect();
    simple(&paths, FillRule::Positive)
}
