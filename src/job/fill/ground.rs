//! The area that is filled: where its pattern is made, and where that comes to lie on the page.
//!
//! An area in the plane is filled where it lies on its page. A band is filled flat, as a strip of (u, v), whose curves are then
//! laid along the curve; the strip of a closed curve has no ends. Either way the pattern is made half a pen away from the
//! border, so that its ink ends there. A strip for a curve in space stays flat on its page ([`super::sheet`]).

use glam::DVec2;
use kurbo::{Affine, BezPath, Point};

use super::FillJob;
use super::builder::refused;
use super::sheet::{Sheet, unrolled};
use crate::domain::{BandMap, CurveSpec, FillDomain};
use crate::exemplar::{Limits, read_area};
use crate::job::band::read_curve;
use crate::job::error::JobError;
use crate::job::notes::{WARNING, squeezed};
use crate::job::part::MARGIN_MM;
use crate::job::report::InputReport;
use crate::planar::{Chords, EdgeIndex, FillRule, Grid, GridError, GridPoint, Region, chords};
use crate::samples::{self, Area, Curve, Drawing, Element};

/// The part of the chord error for each: flattening curves before they are mapped, and mapping them.
const MAP_SHARE: f64 = 0.25;

/// An area and its page. Lengths are millimetres.
pub(super) struct Ground {
    /// Where the pattern is made.
    pub(super) area: Area,
    /// What is filled, on its page; no ink is outside of it.
    pub(super) domain: Region,
    /// Width and height of the page.
    pub(super) page_mm: DVec2,
    /// From the coordinates that the maker knows to those in which the pattern is made.
    pub(super) shift_mm: DVec2,
    /// The file that it comes from, if it does.
    pub(super) input: Option<InputReport>,
    /// Whether it is a strip that is laid along a curve, by this program or by who bends it.
    is_laid: bool,
    strip: Option<Strip>,
}

/// How a strip becomes what is on the page.
enum Strip {
    /// Laid along a curve in the plane.
    Along { map: BandMap, shift_mm: DVec2 },
    /// Cut open: a strip without ends, so long, that is laid along a closed curve in space.
    Open { length_mm: f64, shift_mm: DVec2 },
}

impl Ground {
    /// The area of a job whose widest pen is so wide.
    ///
    /// # Errors
    /// [`JobError`] when the area cannot be read or mapped, and when it is narrower than the pen.
    pub(super) fn new(job: &FillJob, sheet: Option<&Sheet>, pen_mm: f64) -> Result<Self, JobError> {
        let options = &job.options;
        let chord_mm = options.making.tolerances.chord_mm();
        let ground = match &options.domain {
            FillDomain::Rect(size) => {
                let corner = DVec2::splat(MARGIN_MM);
                let size = DVec2::new(size.width_mm(), size.height_mm());
                let page_mm = size + 2.0 * MARGIN_MM;
                let grid = grid(page_mm)?;
                Self::plane(
                    filled(grid, &[rectangle(corner, corner + size)])?,
                    page_mm,
                    corner,
                    pen_mm,
                    chord_mm,
                )
            }
            FillDomain::Path { file, id } => {
                let region = read_area(file, id.as_deref(), 0.5 * chord_mm, &Limits::default())?;
                let (low, high) = region.bounds_mm().unwrap_or_default();
                let page_mm = high - low + 2.0 * MARGIN_MM;
                let shift_mm = DVec2::splat(MARGIN_MM) - low;
                let region = region.placed(grid(page_mm)?, |p| p + shift_mm).map_err(grid_error)?;
                let input = Some(InputReport::of(file));
                Self { input, ..Self::plane(region, page_mm, shift_mm, pen_mm, chord_mm) }
            }
            FillDomain::Band => match sheet {
                Some(sheet) => Self::flat(sheet, pen_mm, chord_mm)?,
                None => Self::band(job, pen_mm, chord_mm)?,
            },
        };
        let points = match &options.along {
            Some(CurveSpec::Points { file } | CurveSpec::Model { file }) => Some(InputReport::of(file)),
            _ => None,
        };
        if let Some(frame_mm) = options.frame_mm.filter(|&mm| ground.domain.offset(-mm, chord_mm).is_empty())
        {
            let found = format!("{frame_mm} mm is so wide that it covers all of the domain");
            return Err(refused("--frame", found, "use a narrower one, or a larger domain"));
        }
        match ground.area.region().is_empty() {
            false => Ok(Self { input: points.or(ground.input), ..ground }),
            true => Err(refused(
                "--domain",
                format!("it is nowhere wider than the pen of {pen_mm:.2} mm"),
                "use a larger domain, or a narrower --stroke",
            )),
        }
    }

    fn plane(domain: Region, page_mm: DVec2, shift_mm: DVec2, pen_mm: f64, chord_mm: f64) -> Self {
        let area = Area::new(inset(&domain, pen_mm, chord_mm));
        Self { area, domain, page_mm, shift_mm, input: None, is_laid: false, strip: None }
    }

    fn band(job: &FillJob, pen_mm: f64, chord_mm: f64) -> Result<Self, JobError> {
        let options = &job.options;
        let (along, width_mm) =
            options.along.as_ref().zip(options.width_mm).expect("a band was checked to have both");
        let (curve, input) = read_curve(along, options.round_mm, None)?;
        let half = 0.5 * width_mm;
        let map = BandMap::new(curve, -half, half)?;
        let length_mm = map.curve().length_mm();
        let is_closed = map.curve().is_closed();
        let borders: Vec<Vec<DVec2>> = match is_closed {
            true => [-half, half]
                .map(|v| map.map_contour(&[DVec2::new(0.0, v)], 1, MAP_SHARE * chord_mm))
                .to_vec(),
            false => {
                let corners = rectangle(DVec2::new(0.0, -half), DVec2::new(length_mm, half));
                vec![map.map_contour(&corners, 0, MAP_SHARE * chord_mm)]
            }
        };
        let points = || borders.iter().flatten().copied();
        let low = points().reduce(DVec2::min).unwrap_or_default();
        let high = points().reduce(DVec2::max).unwrap_or_default();
        let page_mm = high - low + 2.0 * MARGIN_MM;
        let on_page = DVec2::splat(MARGIN_MM) - low;
        let borders: Vec<Vec<DVec2>> =
            borders.iter().map(|border| border.iter().map(|&p| p + on_page).collect()).collect();
        let domain = filled(grid(page_mm)?, &borders)?;
        // Half a lap more on both sides, so that nothing is near the ends of what has none.
        let beyond = if is_closed { 0.5 * length_mm } else { 0.0 };
        let ends = [DVec2::new(-beyond, -half), DVec2::new(length_mm + beyond, half)];
        let strip = filled(grid(DVec2::new(length_mm + beyond, half))?, &[rectangle(ends[0], ends[1])])?;
        let inside = inset(&strip, pen_mm, chord_mm);
        let area = if is_closed { Area::rolled(inside, length_mm) } else { Area::new(inside) };
        let shift_mm = DVec2::new(0.0, -half);
        Ok(Self {
            area,
            domain,
            page_mm,
            shift_mm,
            input,
            is_laid: true,
            strip: Some(Strip::Along { map, shift_mm: on_page }),
        })
    }

    /// A strip that is laid along a curve in space: on the page it is flat.
    fn flat(sheet: &Sheet, pen_mm: f64, chord_mm: f64) -> Result<Self, JobError> {
        let [low, high] = sheet.map.v_range_mm();
        let length_mm = sheet.map.curve().length_mm();
        let size = DVec2::new(length_mm, high - low);
        let corner = DVec2::splat(MARGIN_MM);
        let page_mm = size + 2.0 * MARGIN_MM;
        let domain = filled(grid(page_mm)?, &[rectangle(corner, corner + size)])?;
        if !sheet.is_closed() {
            return Ok(Self { is_laid: true, ..Self::plane(domain, page_mm, corner, pen_mm, chord_mm) });
        }
        let beyond = 0.5 * length_mm;
        let ends = [DVec2::new(-beyond, low), DVec2::new(length_mm + beyond, high)];
        let strip = filled(grid(DVec2::new(length_mm + beyond, high))?, &[rectangle(ends[0], ends[1])])?;
        let area = Area::rolled(inset(&strip, pen_mm, chord_mm), length_mm);
        let on_page = corner - DVec2::new(0.0, low);
        let strip = Some(Strip::Open { length_mm, shift_mm: on_page });
        Ok(Self { area, domain, page_mm, shift_mm: DVec2::new(0.0, low), input: None, is_laid: true, strip })
    }

    /// The same with room on its page for ink between two corners, and by how much everything is moved for that.
    ///
    /// # Errors
    /// [`JobError::Option`] where the area is a strip, beside which there is nothing.
    pub(super) fn with_room_for(
        self,
        (low, high): (DVec2, DVec2),
        pen_mm: f64,
        chord_mm: f64,
    ) -> Result<(Self, DVec2), JobError> {
        if self.is_laid {
            let (from, to) = self.area.region().bounds_mm().unwrap_or_default();
            let beyond = DVec2::splat(0.5 * pen_mm + chord_mm);
            let is_within = low.cmpge(from - beyond).all() && high.cmple(to + beyond).all();
            let [low, high] = [low, high].map(|p| p - self.shift_mm);
            return is_within.then_some((self, DVec2::ZERO)).ok_or_else(|| {
                let found = format!(
                    "there is ink from ({:.2}, {:.2}) to ({:.2}, {:.2}) mm, some of it beside the strip of the band",
                    low.x, low.y, high.x, high.y
                );
                refused("--keep", found, "draw it within the strip, whose lower left corner is (0, 0)")
            });
        }
        let margin = DVec2::splat(MARGIN_MM);
        let by = (margin - low).max(DVec2::ZERO);
        let page_mm = self.page_mm.max(high + margin) + by;
        if page_mm == self.page_mm {
            return Ok((self, by));
        }
        let domain = self.domain.placed(grid(page_mm)?, |p| p + by).map_err(grid_error)?;
        let plane = Self::plane(domain, page_mm, self.shift_mm + by, pen_mm, chord_mm);
        Ok((Self { input: self.input, ..plane }, by))
    }

    /// What is kept, as it lies on the page. Of a closed strip in space, which is cut open somewhere, there is none.
    ///
    /// # Errors
    /// [`JobError`] for coordinates that are too large.
    pub(super) fn kept(&self, drawing: &Drawing, chord_mm: f64) -> Result<Region, JobError> {
        let inked = |drawing: &Drawing| samples::inked(drawing, self.grid(), chord_mm).map_err(grid_error);
        match &self.strip {
            None => inked(drawing),
            Some(Strip::Open { .. }) => Ok(Region::empty(self.grid())),
            Some(Strip::Along { .. }) => Ok(self.clipped(&inked(&self.laid(drawing, chord_mm))?)),
        }
    }

    /// Notes on what becomes of the pattern where the strip bends.
    pub(super) fn notes(&self) -> Vec<String> {
        match &self.strip {
            Some(Strip::Along { map, shift_mm }) => squeezed(map, *shift_mm).collect(),
            _ => Vec::new(),
        }
    }

    /// Whether the pattern is made on a strip, and laid along a curve.
    pub(super) fn is_strip(&self) -> bool {
        self.strip.is_some()
    }

    /// That of the page.
    pub(super) fn grid(&self) -> Grid {
        self.domain.grid()
    }

    /// A pattern that was made in the area, on the page.
    pub(super) fn laid(&self, drawing: &Drawing, chord_mm: f64) -> Drawing {
        let (map, shift_mm) = match &self.strip {
            None => return drawing.clone(),
            Some(Strip::Open { shift_mm, .. }) => return moved(drawing, *shift_mm),
            Some(Strip::Along { map, shift_mm }) => (map, shift_mm),
        };
        let chord_mm = MAP_SHARE * chord_mm;
        let curve = |curve: &Curve| {
            let Chords { points, is_closed } =
                chords(&curve.path, chord_mm).into_iter().next().unwrap_or_default();
            let points = map.map_line(&points, chord_mm);
            let mut path = BezPath::new();
            for (i, p) in points.iter().map(|&p| p + *shift_mm).enumerate() {
                let p = Point::new(p.x, p.y);
                if i == 0 { path.move_to(p) } else { path.line_to(p) }
            }
            if is_closed {
                path.close_path();
            }
            Curve { path, width_mm: curve.width_mm }
        };
        let element = |element: &Element| {
            let mapped = |contour: &Vec<DVec2>| {
                map.map_contour(contour, 0, chord_mm).into_iter().map(|p| p + *shift_mm).collect()
            };
            Element { contours: element.contours.iter().map(mapped).collect() }
        };
        Drawing {
            curves: drawing.curves.iter().map(curve).collect(),
            elements: drawing.elements.iter().map(element).collect(),
        }
    }

    /// Where on the page the curve of a strip begins, at its middle line.
    pub(super) fn begin_mm(&self) -> DVec2 {
        let (low, high) = self.domain.bounds_mm().unwrap_or_default();
        DVec2::new(low.x, 0.5 * (low.y + high.y))
    }

    /// The ink that is inside of the domain; of a strip that was cut open, with how far along its curve that was.
    pub(super) fn opened(&self, ink: &Region) -> Result<(Region, f64), JobError> {
        let Some(Strip::Open { length_mm, .. }) = self.strip else { return Ok((self.clipped(ink), 0.0)) };
        let grid = self.grid();
        let begin = grid.steps(self.begin_mm().x);
        let lap = grid.steps(self.begin_mm().x + length_mm) - begin;
        let (one, at) = unrolled(ink, begin, lap)?;
        Ok((one, grid.mm(at)))
    }

    /// Where bridges may be: in the domain, and between it and what is kept beside it; never in the domain's holes.
    pub(super) fn for_bridges(&self, kept: &Region, pen_mm: f64) -> Region {
        let (domain, grid) = (&self.domain, self.grid());
        let beside = kept.without(domain);
        if beside.area_mm2() < ROUNDING_MM2 {
            return domain.clone();
        }
        let ways_mm = beside.parts().iter().map(|part| self.way_mm(&part.alone(grid)));
        let reach_mm = ways_mm.fold(0.0, f64::max) + ROOM_PENS * pen_mm;
        let around = beside.offset(reach_mm, 0.1 * reach_mm);
        let outlines: Vec<Vec<GridPoint>> =
            domain.parts().iter().map(|part| part.exterior().points().to_vec()).collect();
        let holes = Region::fill(grid, &outlines, FillRule::Positive).without(domain);
        Region::union(grid, [&Region::union(grid, [domain, &around]).without(&holes), kept])
    }

    /// A warning of what is kept so far from the domain that the pattern, whose neighbourhoods reach so far, knows nothing of it.
    pub(super) fn far_away(&self, kept: &Region, reach_mm: f64) -> Option<String> {
        let seen = self.domain.offset(reach_mm, 0.1 * reach_mm);
        let parts = kept.parts().iter().map(|part| part.alone(self.grid()));
        let ways: Vec<f64> =
            parts.filter(|part| part.within(&seen).is_empty()).map(|part| self.way_mm(&part)).collect();
        let farthest_mm = ways.iter().copied().reduce(f64::max)?;
        Some(format!(
            "{WARNING}{} component(s) of --keep lie beside the domain, up to {farthest_mm:.1} mm away, where no neighbourhood of {reach_mm:.1} mm sees them: the pattern does not go on from them, and only bridges reach them; draw them nearer",
            ways.len()
        ))
    }

    /// How far ink beside the domain is from it: from a corner of the one to a side of the other, as they do not cross.
    fn way_mm(&self, ink: &Region) -> f64 {
        let least = |of: &Region, to: &Region| {
            let index = EdgeIndex::new(to);
            let points = of.contours().flat_map(|contour| contour.points()).map(|&p| of.grid().to_mm(p));
            let ways = points.filter_map(|p| index.nearest(p).map(|edge| edge.nearest(p).distance(p)));
            ways.fold(f64::INFINITY, f64::min)
        };
        least(ink, &self.domain).min(least(&self.domain, ink))
    }

    /// The ink that is inside of the domain.
    pub(super) fn clipped(&self, ink: &Region) -> Region {
        ink.within(&self.domain)
    }
}

/// What outlines that cross lose by rounding, at the most.
pub(super) const ROUNDING_MM2: f64 = 1e-4;
/// Bridges to what is kept beside the domain may be so many pens wide around it.
const ROOM_PENS: f64 = 3.0;

/// A drawing elsewhere.
pub(super) fn moved(drawing: &Drawing, by: DVec2) -> Drawing {
    let curve = |curve: &Curve| Curve {
        path: Affine::translate((by.x, by.y)) * &curve.path,
        width_mm: curve.width_mm,
    };
    let contour = |contour: &Vec<DVec2>| contour.iter().map(|&p| p + by).collect();
    let element = |element: &Element| Element { contours: element.contours.iter().map(contour).collect() };
    Drawing {
        curves: drawing.curves.iter().map(curve).collect(),
        elements: drawing.elements.iter().map(element).collect(),
    }
}

/// Where the middle of the pen may be.
fn inset(domain: &Region, pen_mm: f64, chord_mm: f64) -> Region {
    match pen_mm > 0.0 {
        true => domain.offset(-0.5 * pen_mm, chord_mm),
        false => domain.clone(),
    }
}

fn rectangle(low: DVec2, high: DVec2) -> Vec<DVec2> {
    vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
}

fn filled(grid: Grid, paths: &[Vec<DVec2>]) -> Result<Region, JobError> {
    let snapped: Result<Vec<Vec<GridPoint>>, GridError> =
        paths.iter().map(|path| path.iter().map(|&p| grid.snap(p)).collect()).collect();
    Ok(Region::fill(grid, &snapped.map_err(grid_error)?, FillRule::EvenOdd))
}

fn grid(reach_mm: DVec2) -> Result<Grid, JobError> {
    Grid::for_extent(reach_mm.max_element()).map_err(grid_error)
}

pub(super) fn grid_error(error: GridError) -> JobError {
    JobError::Fabricate(error.into())
}
