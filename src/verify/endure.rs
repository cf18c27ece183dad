//! The promise itself, tried out: are the counts the same after eroding, and after dilating?
//!
//! Eroding a sharp tip leaves crumbs: the tip of a polygon that stands for a cusp does not narrow evenly.
//! A piece counts when some of it withstands a little more erosion; if nothing of a component does, the
//! component itself is about to vanish and its largest piece counts. Dilation is erosion of the gaps, which
//! are made into a region of their own inside a frame.

use crate::planar::{Contour, FillRule, GridPoint, Part, Region};

/// Whether every component of `region` withstands erosion by `radius_mm` in one piece with all its holes;
/// pieces that vanish with `chord_mm` more are none.
pub fn endures_erosion(region: &Region, radius_mm: f64, chord_mm: f64) -> bool {
    let eroded = region.offset(-radius_mm, arc_chord(radius_mm, chord_mm));
    let homes = Homes::new(region);
    let mut pieces: Vec<Vec<usize>> = vec![Vec::new(); region.components()];
    for (i, piece) in eroded.parts().iter().enumerate() {
        if let Some(home) = homes.of(piece) {
            pieces[home].push(i);
        }
    }
    if pieces.iter().any(|of| of.len() > 1) {
        keep_lasting(&mut pieces, region, &eroded, radius_mm + chord_mm, chord_mm);
    }
    pieces.iter().zip(region.parts()).all(|(of, part)| match of[..] {
        [piece] => eroded.parts()[piece].holes().len() == part.holes().len(),
        _ => false,
    })
}

/// Drops the pieces that vanish by `radius_mm`, but never all of a component.
fn keep_lasting(pieces: &mut [Vec<usize>], region: &Region, eroded: &Region, radius_mm: f64, chord_mm: f64) {
    let core = region.offset(-radius_mm, arc_chord(radius_mm, chord_mm));
    let homes = Homes::new(eroded);
    let mut lasts = vec![false; eroded.components()];
    for part in core.parts() {
        if let Some(piece) = homes.of(part) {
            lasts[piece] = true;
        }
    }
    for of in pieces.iter_mut().filter(|of| of.len() > 1) {
        let largest = of.iter().copied().max_by_key(|&i| eroded.parts()[i].exterior().doubled_area());
        of.retain(|&i| lasts[i]);
        if of.is_empty() {
            of.extend(largest);
        }
    }
}

/// Whether no components meet and no gap closes, opens or splits when the ink grows by `radius_mm`; gaps
/// that fill with `chord_mm` more are none.
pub fn endures_dilation(region: &Region, radius_mm: f64, chord_mm: f64) -> bool {
    endures_erosion(&gaps(region, radius_mm + chord_mm), radius_mm, chord_mm)
}

/// Arcs finer than the crumbs, or they would make crumbs of their own, and close to the radius: chords run
/// inside of their circles, which makes an offset too small.
fn arc_chord(radius_mm: f64, chord_mm: f64) -> f64 {
    (chord_mm * 0.25).min(radius_mm * 0.002)
}

/// What is not ink, inside a frame that erosion by `radius_mm` does not bring near the ink.
fn gaps(region: &Region, radius_mm: f64) -> Region {
    let grid = region.grid();
    let bounds = region.contours().map(Contour::bounds);
    let Some((low, high)) = bounds.reduce(|a, b| (min(a.0, b.0), max(a.1, b.1))) else {
        return Region::empty(grid);
    };
    let far = grid.steps(radius_mm) * 4 + ((high.x - low.x) + (high.y - low.y));
    let (low, high) = (GridPoint::new(low.x - far, low.y - far), GridPoint::new(high.x + far, high.y + far));
    let frame = vec![low, GridPoint::new(high.x, low.y), high, GridPoint::new(low.x, high.y)];
    let reversed = |c: &Contour| c.points().iter().rev().copied().collect();
    let paths: Vec<Vec<GridPoint>> = std::iter::once(frame).chain(region.contours().map(reversed)).collect();
    Region::fill(grid, &paths, FillRule::Positive)
}

fn min(a: GridPoint, b: GridPoint) -> GridPoint {
    GridPoint::new(a.x.min(b.x), a.y.min(b.y))
}

fn max(a: GridPoint, b: GridPoint) -> GridPoint {
    GridPoint::new(a.x.max(b.x), a.y.max(b.y))
}

/// Finds the part of a region that another part lies in.
struct Homes<'a> {
    parts: Vec<(&'a Part, (GridPoint, GridPoint))>,
}

impl<'a> Homes<'a> {
    fn new(region: &'a Region) -> Self {
        Self { parts: region.parts().iter().map(|p| (p, p.exterior().bounds())).collect() }
    }

    fn of(&self, inner: &Part) -> Option<usize> {
        let p = inner.exterior().points()[0];
        self.parts.iter().position(|(part, (low, high))| {
            (low.x..=high.x).contains(&p.x) && (low.y..=high.y).contains(&p.y) && part.covers(p)
        })
    }
}
