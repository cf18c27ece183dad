//! Counts what cut lines leave: material is what an odd number of contours is around.
//!
//! A cutter follows lines and knows no areas, so a file of lines has to be right in more than its counts: every path
//! closed, or closed by those that go on where it ends; nothing cut twice, as that burns; no crossings; and inner
//! contours before outer ones, as a part that is loose moves. [`super::read_dxf`] and [`super::read_cut_svg`] hand
//! their paths over to be judged here. Layers named `ENGRAVE` and `SHEET` are measured but cut nothing; what is engraved has
//! to be engraved once, too, and beside the cuts, and what of it is open is told, as lines of letters may be. Excluded: power, speed and kerf.

use std::collections::BTreeMap;
use std::fmt;

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use schemars::JsonSchema;
use serde::Serialize;

use super::error::VerifyError;
use super::narrowest::{Narrowest, widths};
use super::stretches::{Stretch, doubled};
use super::svg::contour_faults;
use crate::planar::{self, Contour, FillRule, Grid, GridPoint, Region};

/// Ends of open paths that are no farther apart meet: files keep four decimals or more.
const JOIN_MM: f64 = 1e-4;
/// Layers that are not cut, in capitals.
const UNCUT: [&str; 2] = [ENGRAVED, "SHEET"];
const ENGRAVED: &str = "ENGRAVE";

/// What a file of cut lines holds. Lengths are millimetres, y up; an SVG's from the page's lower left corner.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CutReport {
    /// The number of connected components of the material.
    pub components: usize,
    /// The number of holes in them.
    pub holes: usize,
    /// The area of the material.
    pub area_mm2: f64,
    /// The lower left and upper right corner of the material; `None` when there is none.
    #[serde(serialize_with = "super::json::corners")]
    #[schemars(with = "Option<[[f64; 2]; 2]>")]
    pub bounds_mm: Option<(DVec2, DVec2)>,
    /// The unit of the file.
    pub unit: &'static str,
    /// The length of all cuts.
    pub cut_length_mm: f64,
    /// Closed contours: the beam pierces once for each.
    pub pierces: usize,
    /// The layers, by name.
    pub layers: Vec<CutLayer>,
    /// The narrowest material; `None` when there is none.
    pub min_feature: Option<Narrowest>,
    /// The narrowest gap; `None` when no gap would ever close.
    pub min_gap: Option<Narrowest>,
    /// What is not in order.
    pub faults: Vec<CutFault>,
    /// Engraved paths that do not close: lines of letters need not, outlines of areas have to.
    pub open_engraved: Vec<CutFault>,
    /// What could be read, but not with certainty.
    pub warnings: Vec<String>,
    /// The greatest distance between the file's curves and the polygons that were counted.
    pub chord_mm: f64,
    /// The material.
    #[serde(skip)]
    pub region: Region,
}

/// A layer of a file of cut lines.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CutLayer {
    /// Its name.
    pub name: String,
    /// Whether what is on it is cut through, and counts.
    pub is_cut: bool,
    /// Entities on it.
    pub paths: usize,
    /// The length of all of them.
    pub length_mm: f64,
}

/// Something in a file of cut lines that would spoil the part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CutFault {
    /// A path that does not come back, nor do those that go on from its ends.
    Open {
        /// The element, with its line in the file.
        element: String,
        /// One of its loose ends.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// A closed path around no area.
    Degenerate {
        /// The element, with its line in the file.
        element: String,
        /// Where it begins.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// Two lines run along each other, so that the same cut is made twice.
    Doubled {
        /// Whether the lines are engraved, and not cut.
        is_engraved: bool,
        /// The middle of the stretch.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
        /// How long it is.
        length_mm: f64,
    },
    /// A line is engraved along a cut, so that the edge burns.
    EngravedCut {
        /// The middle of the stretch.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
        /// How long it is.
        length_mm: f64,
    },
    /// Contours cross or touch.
    Crossing {
        /// Where.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
    /// A contour is cut before one that lies inside of it.
    Order {
        /// Where the outer one begins.
        #[serde(serialize_with = "super::json::point")]
        #[schemars(with = "[f64; 2]")]
        position_mm: DVec2,
    },
}

impl fmt::Display for CutFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, p) = match self {
            Self::Open { element, position_mm } => {
                write!(f, "{element}: ")?;
                ("a path is not closed", position_mm)
            }
            Self::Degenerate { element, position_mm } => {
                write!(f, "{element}: ")?;
                ("a path has no area", position_mm)
            }
            Self::Doubled { is_engraved, position_mm, length_mm } => {
                let done = if *is_engraved { "engraved" } else { "cut" };
                write!(f, "{length_mm:.3} mm are {done} twice: ")?;
                ("lines run along each other", position_mm)
            }
            Self::EngravedCut { position_mm, length_mm } => {
                write!(f, "{length_mm:.3} mm are engraved and cut: ")?;
                ("lines run along each other", position_mm)
            }
            Self::Crossing { position_mm } => ("contours cross or touch", position_mm),
            Self::Order { position_mm } => ("a contour is cut before one inside of it", position_mm),
        };
        write!(f, "{what} at ({:.4}, {:.4}) mm", p.x, p.y)
    }
}

/// One path of a file, as a reader hands it over.
pub(super) struct CutPath {
    /// The element, with its line in the file.
    pub(super) element: String,
    pub(super) layer: String,
    /// One after the other, in millimetres, y up; at least one.
    pub(super) stretches: Vec<Stretch>,
    /// Whether the file says so, or it ends exactly where it begins.
    pub(super) is_closed: bool,
}

/// A closed contour, in the order of the file.
struct Ring {
    element: String,
    points: Vec<DVec2>,
}

/// Judges paths, with curves as polygons within `chord_mm`.
pub(super) fn judge(
    paths: Vec<CutPath>,
    unit: &'static str,
    warnings: Vec<String>,
    chord_mm: f64,
) -> Result<CutReport, VerifyError> {
    let layers = layers(&paths);
    let (paths, uncut): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_cut(&path.layer));
    let grid = grid(&paths)?;
    let cut_length_mm = paths.iter().flat_map(|path| &path.stretches).map(Stretch::length_mm).sum();
    let engraved = uncut.into_iter().filter(|path| path.layer.eq_ignore_ascii_case(ENGRAVED));
    let engraved: Vec<CutPath> = engraved.collect();
    let mut faults = twice(&paths, &engraved);
    let mut open_engraved = Vec::new();
    rings(engraved, chord_mm, &mut open_engraved);
    let rings = rings(paths, chord_mm, &mut faults);
    let mut contours = Vec::with_capacity(rings.len());
    for Ring { element, points } in &rings {
        let snapped: Result<Vec<GridPoint>, _> = points.iter().map(|&p| grid.snap(p)).collect();
        let snapped = snapped.map_err(|source| misplaced(element, source))?;
        match Contour::new(snapped) {
            Some(contour) => contours.push(contour),
            None => faults.push(CutFault::Degenerate { element: element.clone(), position_mm: points[0] }),
        }
    }
    let outlines: Vec<Vec<GridPoint>> = contours.iter().map(|c| c.points().to_vec()).collect();
    let region = Region::fill(grid, &outlines, FillRule::EvenOdd);
    faults.extend(out_of_order(grid, &contours));
    let crossings = contour_faults(&region, contours);
    faults.extend(crossings.iter().map(|fault| CutFault::Crossing { position_mm: fault.position_mm() }));
    let widths = widths(&region, chord_mm);
    Ok(CutReport {
        components: region.components(),
        holes: region.holes(),
        area_mm2: region.area_mm2(),
        bounds_mm: region.bounds_mm(),
        unit,
        cut_length_mm,
        pierces: rings.len(),
        layers,
        min_feature: widths.feature,
        min_gap: widths.gap,
        faults,
        open_engraved,
        warnings,
        chord_mm,
        region,
    })
}

/// The lines that run along each other: first those that are cut twice, then what is engraved twice or along a cut.
fn twice(cut: &[CutPath], engraved: &[CutPath]) -> Vec<CutFault> {
    let paths = cut.iter().chain(engraved);
    let stretches: Vec<&[Stretch]> = paths.map(|path| path.stretches.as_slice()).collect();
    let fault = |(pair, position_mm, length_mm): ([usize; 2], _, _)| {
        let [is_engraved, and_other] = pair.map(|path| path >= cut.len());
        match is_engraved == and_other {
            true => CutFault::Doubled { is_engraved, position_mm, length_mm },
            false => CutFault::EngravedCut { position_mm, length_mm },
        }
    };
    let mut faults: Vec<CutFault> = doubled(&stretches).into_iter().map(fault).collect();
    faults.sort_by_key(|fault| !matches!(fault, CutFault::Doubled { is_engraved: false, .. }));
    faults
}

fn is_cut(layer: &str) -> bool {
    !UNCUT.iter().any(|name| name.eq_ignore_ascii_case(layer))
}

fn layers(paths: &[CutPath]) -> Vec<CutLayer> {
    let mut layers: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
    for path in paths {
        let layer = layers.entry(&path.layer).or_default();
        layer.0 += 1;
        layer.1 += path.stretches.iter().map(Stretch::length_mm).sum::<f64>();
    }
    let layer = |(name, (paths, length_mm)): (&str, (usize, f64))| CutLayer {
        name: name.to_owned(),
        is_cut: is_cut(name),
        paths,
        length_mm,
    };
    layers.into_iter().map(layer).collect()
}

fn misplaced(element: &str, source: planar::GridError) -> VerifyError {
    VerifyError::CutCoordinate { element: element.to_owned(), source }
}

/// The grid for all that is cut.
fn grid(paths: &[CutPath]) -> Result<Grid, VerifyError> {
    let mut extent_mm = 1.0f64;
    for path in paths {
        for stretch in &path.stretches {
            let (low, high) = stretch.bounds();
            let probe = Grid::for_extent(1.0).expect("a millimetre has a grid");
            for corner in [low, high] {
                probe.snap(corner).map_err(|source| misplaced(&path.element, source))?;
                extent_mm = extent_mm.max(corner.abs().max_element());
            }
        }
    }
    Ok(Grid::for_extent(extent_mm).expect("every coordinate was in range"))
}

/// The closed contours: paths that are closed, and open ones that go on in each other.
fn rings(paths: Vec<CutPath>, chord_mm: f64, faults: &mut Vec<CutFault>) -> Vec<Ring> {
    let partners = partners(&paths);
    let mut done = vec![false; paths.len()];
    let mut rings = Vec::new();
    for first in 0..paths.len() {
        if done[first] {
            continue;
        }
        let element = paths[first].element.clone();
        if paths[first].is_closed {
            done[first] = true;
            let mut points = Vec::new();
            paths[first].stretches.iter().for_each(|s| s.flatten(chord_mm, &mut points));
            rings.push(Ring { element, points });
            continue;
        }
        // An end is a path and a side: 2 i is where path i begins, 2 i + 1 where it ends. Back to a loose end, if
        // there is one, and then along the chain.
        let mut entry = 2 * first;
        let mut is_loose = false;
        loop {
            match partners[entry] {
                None => {
                    is_loose = true;
                    break;
                }
                Some(before) if before ^ 1 == 2 * first => break,
                Some(before) => entry = before ^ 1,
            }
        }
        let mut points = Vec::new();
        let start = if is_loose { entry } else { 2 * first };
        let mut at = Some(start);
        while let Some(entry) = at.filter(|entry| !done[entry / 2]) {
            done[entry / 2] = true;
            let stretches = &paths[entry / 2].stretches;
            match entry % 2 {
                0 => stretches.iter().for_each(|s| s.flatten(chord_mm, &mut points)),
                _ => stretches.iter().rev().for_each(|s| s.reversed().flatten(chord_mm, &mut points)),
            }
            at = partners[entry ^ 1];
        }
        if is_loose {
            faults.push(CutFault::Open { element, position_mm: points[0] });
        } else {
            rings.push(Ring { element, points });
        }
    }
    rings
}

/// For each end of an open path the one that it meets, if that is exactly one.
fn partners(paths: &[CutPath]) -> Vec<Option<usize>> {
    let end = |i: usize| {
        let stretches = &paths[i / 2].stretches;
        if i.is_multiple_of(2) { stretches[0].from() } else { stretches[stretches.len() - 1].to() }
    };
    let ends = (0..2 * paths.len()).filter(|i| !paths[i / 2].is_closed);
    let tree = RTree::bulk_load(ends.clone().map(|i| GeomWithData::new(end(i).to_array(), i)).collect());
    let mut partners = vec![None; 2 * paths.len()];
    for i in ends {
        let near = tree.locate_within_distance(end(i).to_array(), JOIN_MM * JOIN_MM);
        let mut others = near.map(|entry| entry.data).filter(|&j| j != i);
        partners[i] = others.next().filter(|_| others.next().is_none());
    }
    (0..partners.len()).map(|i| partners[i].filter(|&j: &usize| partners[j] == Some(i))).collect()
}

/// Contours that come before one inside of them.
fn out_of_order(grid: Grid, contours: &[Contour]) -> Vec<CutFault> {
    let boxes: Vec<_> = contours.iter().map(Contour::bounds).collect();
    let is_around = |outer: usize, inner: usize| {
        let ((low, high), p) = (boxes[outer], contours[inner].points()[0]);
        (low.x..=high.x).contains(&p.x) && (low.y..=high.y).contains(&p.y) && contours[outer].contains(p)
    };
    let early = |&outer: &usize| (outer + 1..contours.len()).any(|inner| is_around(outer, inner));
    let early = (0..contours.len()).filter(early);
    early.map(|i| CutFault::Order { position_mm: grid.to_mm(contours[i].points()[0]) }).collect()
}

impl fmt::Display for CutReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "components   {}", self.components)?;
        writeln!(f, "holes        {}", self.holes)?;
        writeln!(f, "area         {:.3} mm2", self.area_mm2)?;
        if let Some((low, high)) = self.bounds_mm {
            let size = high - low;
            writeln!(f, "size         {:.3} x {:.3} mm (file in {})", size.x, size.y, self.unit)?;
        }
        writeln!(f, "cuts         {:.1} mm, {} pierces", self.cut_length_mm, self.pierces)?;
        for layer in &self.layers {
            let kind = if layer.is_cut { "" } else { ", not cut" };
            writeln!(
                f,
                "layer        {}: {} path(s), {:.1} mm{kind}",
                layer.name, layer.paths, layer.length_mm
            )?;
        }
        for (name, narrowest) in [("min feature", &self.min_feature), ("min gap", &self.min_gap)] {
            match narrowest {
                Some(n) => {
                    let (w, p) = (n.width_mm, n.position_mm);
                    writeln!(f, "{name:<12} {w:.3} mm at ({:.3}, {:.3}) mm", p.x, p.y)?;
                }
                None => writeln!(f, "{name:<12} none")?,
            }
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning      {warning}"))?;
        if let Some(first) = self.open_engraved.first() {
            writeln!(
                f,
                "engraved     {} path(s) that do not close, first: {first}",
                self.open_engraved.len()
            )?;
        }
        write!(f, "faults       {}", self.faults.len())?;
        self.faults.iter().take(super::shells::FAULTS_SHOWN).try_for_each(|fault| write!(f, "\n  {fault}"))
    }
}
