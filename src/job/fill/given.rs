//! What is read: the exemplar as a drawing, and strokes that are there already.

use std::path::Path;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::builder::refused;
use super::ground::moved;
use super::{CloneSpec, Density};
use crate::exemplar::{Limits, Linework, ReadOptions};
use crate::job::error::JobError;
use crate::job::flat::READ_SHARE;
use crate::job::notes::WARNING;
use crate::planar::{Chords, chords};
use crate::samples::{Area, CloneBox, Curve, Drawing, Element, Level};

/// Strokes that run beside each other nearer than this part of the narrower pen lie upon each other.
const UPON: f64 = 0.25;
/// They do so if it is for more than so many pens.
const UPON_PENS: f64 = 3.0;

/// The curves and elements of an SVG file, with the pen that was asked for.
///
/// # Errors
/// As [`Linework::read`].
pub(super) fn read(
    file: &Path,
    chord_mm: f64,
    stroke_mm: Option<f64>,
) -> Result<(Drawing, Linework), JobError> {
    let options =
        ReadOptions { chord_mm: chord_mm * READ_SHARE, target_height_mm: None, limits: Limits::default() };
    let linework = Linework::read(file, &options)?;
    let strokes = linework.strokes().iter();
    let curves =
        strokes.map(|line| Curve { path: line.path.clone(), width_mm: stroke_mm.unwrap_or(line.width_mm) });
    let elements = linework.elements().iter().map(|contours| Element { contours: contours.clone() });
    let drawing = Drawing { curves: curves.collect(), elements: elements.collect() };
    Ok((drawing, linework))
}

/// What is there already, in the coordinates of its page.
pub(super) struct Kept {
    /// Its strokes, from which the pattern goes on, and its shapes.
    pub(super) drawing: Drawing,
    /// All that it covers, as it is drawn: strokes with their own ends and corners.
    pub(super) ink: Drawing,
    /// The file.
    pub(super) linework: Linework,
}

impl Kept {
    /// Strokes and shapes where their file has them.
    ///
    /// # Errors
    /// As [`Linework::read`]; and [`JobError::Option`] for strokes that lie upon each other.
    pub(super) fn read(file: &Path, chord_mm: f64) -> Result<Self, JobError> {
        let (drawing, linework) = read(file, chord_mm, None)?;
        if let Some((first, second, at)) = upon_each_other(&drawing.curves) {
            let found = format!(
                "{}: strokes {} and {} lie upon each other at ({:.2}, {:.2}) mm, so that it is unclear how paths go on there",
                file.display(),
                first + 1,
                second + 1,
                at.x,
                at.y
            );
            return Err(refused(
                "--keep",
                found,
                "delete one of them, or move them apart; strokes may cross and end on each other",
            ));
        }
        let strokes = Element { contours: linework.stroke_ink().to_vec() };
        let strokes = Some(strokes).filter(|strokes| !strokes.contours.is_empty());
        let elements = strokes.into_iter().chain(drawing.elements.iter().cloned()).collect();
        Ok(Self { drawing, ink: Drawing { curves: Vec::new(), elements }, linework })
    }

    /// It elsewhere.
    pub(super) fn moved(self, by: DVec2) -> Self {
        Self { drawing: moved(&self.drawing, by), ink: moved(&self.ink, by), ..self }
    }

    /// Lower left and upper right corner of its ink, in millimetres.
    pub(super) fn bounds_mm(&self) -> Option<(DVec2, DVec2)> {
        self.ink.bounds_mm()
    }
}

/// Refuses a copy of what is not on the exemplar's page, which is as large as `page_mm`, nor near its lines, and one to a place whose middle is not
/// in the area, in the coordinates of the maker, which lie by `shift_mm` before those of the area.
pub(super) fn check_clones(
    clones: &[CloneSpec],
    (exemplar, page_mm): (&Drawing, DVec2),
    (area, shift_mm): (&Area, DVec2),
) -> Result<(), JobError> {
    if let Some(clone) = clones.iter().find(|clone| !area.contains(clone.placed(shift_mm).to_mm)) {
        let middle = clone.to_mm + 0.5 * clone.size_mm;
        let (low, high) = area.bounds_mm();
        let (low, high) = (low - shift_mm, high - shift_mm);
        let found = format!(
            "the middle of the copy would be at ({:.2}, {:.2}) mm, outside of the domain, which lies from ({:.2}, {:.2}) to ({:.2}, {:.2}) mm inside of its pen",
            middle.x, middle.y, low.x, low.y, high.x, high.y
        );
        return Err(refused("--clone", found, "copy to a place in the domain"));
    }

    let (low, high) = exemplar.bounds_mm().unwrap_or_default();
    // The SVG library's sizes are `f32`, and a box may end where the page does.
    let page_mm = page_mm * (1.0 + f64::from(f32::EPSILON));
    let (low, high) = (low.min(DVec2::ZERO), high.max(page_mm));
    let is_on_page = |clone: &&CloneSpec| {
        clone.from_mm.cmpge(low).all() && (clone.from_mm + clone.size_mm).cmple(high).all()
    };
    match clones.iter().find(|clone| !is_on_page(clone)) {
        None => Ok(()),
        Some(clone) => {
            let (from, to) = (clone.from_mm, clone.from_mm + clone.size_mm);
            let found = format!(
                "the box from ({:.2}, {:.2}) to ({:.2}, {:.2}) mm reaches beyond the exemplar, which lies from ({:.2}, {:.2}) to ({:.2}, {:.2}) mm",
                from.x, from.y, to.x, to.y, low.x, low.y, high.x, high.y
            );
            Err(refused("--clone", found, "copy from a box of the exemplar"))
        }
    }
}

/// A note on copies that are not wholly in the area, half a pen beside which they are cut.
pub(super) fn cut_clones(clones: &[CloneBox], area: &Area, pen_mm: f64) -> Option<String> {
    let is_cut = |clone: &&CloneBox| {
        let half_mm = (clone.half_mm - pen_mm).max(DVec2::ZERO);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        !area.covers_all(&[corners.map(|(x, y)| clone.to_mm + half_mm * DVec2::new(x, y)).to_vec()])
    };
    let cut = clones.iter().filter(is_cut).count();
    (cut > 0).then(|| {
        format!(
            "{cut} of {} copies reach beyond the domain, and their strokes are cut off there",
            clones.len()
        )
    })
}

/// The first two strokes that run upon each other, by their numbers from 0, and where.
fn upon_each_other(curves: &[Curve]) -> Option<(usize, usize, DVec2)> {
    let narrowest_mm = curves.iter().map(|curve| curve.width_mm).fold(f64::INFINITY, f64::min);
    let near_mm = UPON * narrowest_mm;
    let points: Vec<Vec<DVec2>> = curves.iter().map(|curve| dotted(curve, near_mm)).collect();
    let cell = |p: DVec2| ((p.x / near_mm).floor() as i64, (p.y / near_mm).floor() as i64);
    let mut cells: FxHashMap<(i64, i64), Vec<(usize, DVec2)>> = FxHashMap::default();
    let long = (UPON_PENS / UPON).ceil() as usize;
    for (number, dots) in points.iter().enumerate() {
        // How many dots in a row are near each stroke that came before.
        let mut runs: FxHashMap<usize, usize> = FxHashMap::default();
        for &p in dots {
            let (x, y) = cell(p);
            let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
            let near = around.filter_map(|at| cells.get(&at)).flatten();
            let mut others: Vec<usize> =
                near.filter(|(_, q)| p.distance(*q) < near_mm).map(|&(other, _)| other).collect();
            others.sort_unstable();
            others.dedup();
            runs =
                others.into_iter().map(|other| (other, runs.get(&other).map_or(1, |run| run + 1))).collect();
            let first = runs.iter().filter(|(_, run)| **run >= long).map(|(&other, _)| other).min();
            if let Some(other) = first {
                return Some((other, number, p));
            }
        }
        for &p in dots {
            cells.entry(cell(p)).or_default().push((number, p));
        }
    }
    None
}

/// Points along a curve, so far apart.
fn dotted(curve: &Curve, step_mm: f64) -> Vec<DVec2> {
    let line = chords(&curve.path, 0.1 * step_mm).into_iter().next().map_or_else(Vec::new, Chords::way);
    let mut dots: Vec<DVec2> = line.first().copied().into_iter().collect();
    for &to in line.iter().skip(1) {
        let from = dots[dots.len() - 1];
        let steps = (from.distance(to) / step_mm).floor() as usize;
        dots.extend((1..=steps).map(|i| from + (to - from).normalize_or_zero() * step_mm * i as f64));
        if steps == 0 && from.distance(to) > 0.5 * step_mm {
            dots.push(to);
        }
    }
    dots
}

/// The ink of a pattern that has less than this part of the exemplar's is told to be little.
const LITTLE: f64 = 0.35;

/// A warning of a pattern that has hardly any ink beside the exemplar.
pub(super) fn sparse(learnt: &Density, made: &Density) -> Option<String> {
    (made.ink < LITTLE * learnt.ink).then(|| {
        format!(
            "{WARNING}only {:.1} % of the domain is ink, and {:.1} % of the exemplar: the pattern found little that suits there; try another --seed, larger or smaller --radii, or a larger domain",
            100.0 * made.ink,
            100.0 * learnt.ink
        )
    })
}

/// Pens that differ by more than this part are told to be mixed.
const MIXED: f64 = 1.2;

/// A note on pens that differ, as a path of the pattern has one.
pub(super) fn mixed_pens(exemplar: &Drawing) -> Option<String> {
    let widths = exemplar.curves.iter().map(|curve| curve.width_mm);
    let (least, most) =
        widths.fold((f64::INFINITY, 0.0_f64), |(least, most), mm| (least.min(mm), most.max(mm)));
    (most > MIXED * least).then(|| {
        format!(
            "the exemplar has pens from {least:.2} to {most:.2} mm; samples do not tell them apart, and each path of the pattern has the mean of its samples'; --stroke gives all of them one"
        )
    })
}

/// A warning of an exemplar that is a single stroke or shape: nothing beside it says how far apart things are.
pub(super) fn meagre(exemplar: &Drawing) -> Option<String> {
    (exemplar.curves.len() + exemplar.elements.len() == 1).then(|| {
        let what = if exemplar.curves.is_empty() { "shape" } else { "stroke" };
        format!(
            "{WARNING}the exemplar is one {what}, and nothing beside it says how far apart things are: draw several, as they are to lie"
        )
    })
}

/// A neighbourhood is so many radii across.
const NEIGHBOURHOOD_RADII: f64 = 2.0;

/// A note on shapes that no neighbourhood holds: their samples see little of what is around them.
pub(super) fn oversize(exemplar: &Drawing, levels: &[Level]) -> Option<String> {
    let radius_mm = levels.iter().map(|level| level.radius_mm).fold(0.0, f64::max);
    let size = |element: &Element| {
        let points = || element.contours.iter().flatten().copied();
        points().reduce(DVec2::max).unwrap_or_default() - points().reduce(DVec2::min).unwrap_or_default()
    };
    let sizes = exemplar.elements.iter().map(size);
    let large: Vec<DVec2> =
        sizes.filter(|size| size.max_element() > NEIGHBOURHOOD_RADII * radius_mm).collect();
    let largest = large.iter().copied().max_by(|a, b| a.max_element().total_cmp(&b.max_element()))?;
    Some(format!(
        "{WARNING}{} of {} shape(s) of the exemplar do not fit into a neighbourhood of {:.1} mm across, the largest is {:.1} mm by {:.1} mm: little of their surroundings is seen, and they may come to lie over one another; draw such ornament as strokes, or give larger --radii",
        large.len(),
        exemplar.elements.len(),
        NEIGHBOURHOOD_RADII * radius_mm,
        largest.x,
        largest.y
    ))
}

#[cfg(test)]
mod tests {
    use kurbo::BezPath;

    use super::*;

    #[test]
    fn an_empty_pattern_and_mixed_pens_are_told() {
        let of = |ink: f64| Density { area_mm2: 1.0, components: 1.0, holes: 1.0, dangling_ends: 1.0, ink };
        assert!(sparse(&of(0.2), &of(0.04)).unwrap().contains("only 4.0 % of the domain"));
        assert_eq!(sparse(&of(0.2), &of(0.1)), None);
        let curve = |width_mm: f64| Curve { path: BezPath::from_svg("M0 0H50").unwrap(), width_mm };
        let drawing = |pens: &[f64]| Drawing {
            curves: pens.iter().map(|&mm| curve(mm)).collect(),
            elements: Vec::new(),
        };
        assert!(mixed_pens(&drawing(&[3.0, 0.5])).unwrap().contains("from 0.50 to 3.00 mm"));
        assert_eq!((mixed_pens(&drawing(&[1.0, 1.1])), mixed_pens(&drawing(&[]))), (None, None));
    }

    #[test]
    fn one_stroke_is_told_to_be_too_little() {
        let curve = || Curve { path: BezPath::from_svg("M0 0H50").unwrap(), width_mm: 1.0 };
        let mut drawing = Drawing { curves: vec![curve()], elements: Vec::new() };
        assert!(meagre(&drawing).unwrap().contains("is one stroke"));
        drawing.curves.push(curve());
        assert_eq!(meagre(&drawing), None);
    }

    #[test]
    fn strokes_upon_each_other_are_found_and_those_that_cross_are_not() {
        let found = |paths: &[&str]| {
            let curve = |d: &&str| Curve { path: BezPath::from_svg(d).unwrap(), width_mm: 1.0 };
            upon_each_other(&paths.iter().map(curve).collect::<Vec<_>>())
        };
        assert_eq!(found(&["M0 0H50", "M20 -9V30", "M0 0L50 20", "M0 3H50"]), None);
        let (first, second, at) = found(&["M0 0H50", "M0 9H9", "M60 0.1H20"]).unwrap();
        assert!((first, second) == (0, 2) && at.y == 0.1 && at.x < 48.0, "{at}");
        assert!(found(&["M0 0C9 9 20 9 30 0", "M0 0C9 9 20 9 30 0"]).is_some());
    }
}
