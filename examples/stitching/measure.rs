//! What can be measured on a bent run: how it turns at its seams, and how its pieces differ from the drawn ones.

use glam::DVec2;
use openwork::fit::{Bent, Placed, Seam};
use openwork::pieces::{End, Piece};
use openwork::planar::Region;

/// What one method did to one run, or to all.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Seams between pieces that are not neighbours in the exemplar.
    pub jumps: usize,
    /// The turn at each end of each portal of these seams, in radians.
    pub angles: Vec<f64>,
    /// How many of them exceed what the exemplar has itself.
    pub over: usize,
    /// The integral of squared curvature along the pieces beside these seams, as drawn.
    pub drawn_energy: f64,
    /// The same after bending.
    pub bent_energy: f64,
    /// w' / w of the thickness w of strands, in samples along the contours of these pieces.
    pub widths: Vec<f64>,
    /// The angle between the last edges on the two sides of these seams, greatest of each seam, in radians.
    pub kinks: Vec<f64>,
    /// Pieces that were warped instead.
    pub fallbacks: usize,
    /// Time for all pieces of the run, with nothing prepared.
    pub first_ms: f64,
    /// Time with everything prepared.
    pub again_ms: f64,
}

/// How many samples of thickness are taken along each contour of a piece.
const SAMPLES: usize = 24;

impl Measured {
    /// Compares `bent` with the pieces of `placed`; angles and curvature at a scale of `scale_mm`.
    pub fn new(placed: &Placed<'_>, bent: &[Bent], seams: &[Seam], scale_mm: f64) -> Self {
        let mut measured = Self::default();
        let pieces = placed.pieces();
        let n = pieces.len();
        let mut beside_jump = vec![false; n];
        for (i, seam) in seams.iter().enumerate().filter(|(_, seam)| !seam.is_natural) {
            let j = (i + 1) % n;
            measured.jumps += 1;
            measured.kinks.push(seam.after_deg.to_radians());
            (beside_jump[i], beside_jump[j]) = (true, true);
            for k in 0..pieces[i].right.len() {
                let before = inward(pieces[i], &bent[i], End::Right(k), scale_mm, placed.stretch());
                let after = inward(pieces[j], &bent[j], End::Left(k), scale_mm, placed.stretch());
                measured.angles.push((-before).angle_to(after).abs());
            }
        }
        for i in (0..n).filter(|&i| beside_jump[i]) {
            let drawn = contours(&drawn(pieces[i]));
            let bent = contours(&bent[i]);
            for ((before, closed), (after, _)) in drawn.iter().zip(&bent) {
                measured.drawn_energy += energy(before, *closed, scale_mm);
                measured.bent_energy += energy(after, *closed, scale_mm);
            }
            let (was, is) = (thicknesses(&drawn), thicknesses(&bent));
            measured.widths.extend(was.iter().zip(&is).filter_map(|(was, is)| Some((*is)? / (*was)?)));
        }
        measured
    }

    /// Adds what was measured on another run.
    pub fn add(&mut self, other: &Self) {
        self.jumps += other.jumps;
        self.angles.extend(&other.angles);
        self.over += other.over;
        self.drawn_energy += other.drawn_energy;
        self.bent_energy += other.bent_energy;
        self.widths.extend(&other.widths);
        self.kinks.extend(&other.kinks);
        self.fallbacks += other.fallbacks;
        self.first_ms += other.first_ms;
        self.again_ms += other.again_ms;
    }
}

/// The value below which a part of `values` lies; 0 without any.
pub fn percentile(values: &[f64], part: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((last as f64 * part).round() as usize).copied().unwrap_or_default()
}

/// How much the contours of `region` turn from one step to the next, in radians, in steps of `scale_mm`.
pub fn turnings(region: &Region, scale_mm: f64) -> Vec<f64> {
    let contours = region
        .contours()
        .map(|c| -> Vec<DVec2> { c.points().iter().map(|&p| region.grid().to_mm(p)).collect() });
    contours.flat_map(|points| turns(&points, true, scale_mm)).collect()
}

/// A piece as it was cut.
pub fn drawn(piece: &Piece) -> Bent {
    Bent { chains: piece.chains.iter().map(|c| c.points.clone()).collect(), loops: piece.loops.clone() }
}

/// From an endpoint to where its chain is after `scale_mm`.
fn inward(piece: &Piece, bent: &Bent, end: End, scale_mm: f64, stretch: f64) -> DVec2 {
    let place = |p: &DVec2| DVec2::new(p.x * stretch, p.y);
    let chains = piece.chains.iter().zip(&bent.chains);
    let points: Vec<DVec2> = chains
        .into_iter()
        .find_map(|(chain, points)| {
            if chain.start == end {
                Some(points.iter().map(place).collect())
            } else if chain.end == end {
                Some(points.iter().rev().map(place).collect())
            } else {
                None
            }
        })
        .expect("every endpoint has a chain");
    let mut left = scale_mm;
    for w in points.windows(2) {
        let step = w[0].distance(w[1]);
        if step >= left {
            return w[0].lerp(w[1], left / step) - points[0];
        }
        left -= step;
    }
    points[points.len() - 1] - points[0]
}

/// All contours of a piece, and whether each closes.
fn contours(bent: &Bent) -> Vec<(Vec<DVec2>, bool)> {
    let chains = bent.chains.iter().map(|points| (points.clone(), false));
    chains.chain(bent.loops.iter().map(|points| (points.clone(), true))).collect()
}

/// Points along a polyline at equal steps of about `step_mm`.
fn resampled(points: &[DVec2], closed: bool, step_mm: f64) -> Vec<DVec2> {
    let path: Vec<DVec2> = points.iter().chain(points.first().filter(|_| closed)).copied().collect();
    let length: f64 = path.windows(2).map(|w| w[0].distance(w[1])).sum();
    let steps = (length / step_mm).round().max(1.0);
    let (mut found, mut at, mut next) = (vec![path[0]], 0.0, 1.0);
    for w in path.windows(2) {
        let edge = w[0].distance(w[1]);
        while next < steps && at + edge >= next * length / steps {
            found.push(w[0].lerp(w[1], (next * length / steps - at) / edge));
            next += 1.0;
        }
        at += edge;
    }
    if !closed {
        found.push(path[path.len() - 1]);
    }
    found
}

fn turns(points: &[DVec2], closed: bool, step_mm: f64) -> Vec<f64> {
    let even = resampled(points, closed, step_mm);
    let n = even.len();
    let range = if closed { 0..n } else { 1..n.max(1) - 1 };
    range.map(|i| (even[i] - even[(i + n - 1) % n]).angle_to(even[(i + 1) % n] - even[i]).abs()).collect()
}

/// The integral of squared curvature.
fn energy(points: &[DVec2], closed: bool, step_mm: f64) -> f64 {
    turns(points, closed, step_mm).into_iter().map(|turn| turn * turn / step_mm).sum()
}

/// How far it is across the ink from samples of each contour; `None` where a cut is in the way.
fn thicknesses(contours: &[(Vec<DVec2>, bool)]) -> Vec<Option<f64>> {
    let edges: Vec<(DVec2, DVec2)> = contours
        .iter()
        .flat_map(|(points, closed)| {
            let path: Vec<DVec2> = points.iter().chain(points.first().filter(|_| *closed)).copied().collect();
            path.windows(2).map(|w| (w[0], w[1])).collect::<Vec<_>>()
        })
        .collect();
    let mut found = Vec::new();
    for (points, closed) in contours {
        let path: Vec<DVec2> = points.iter().chain(points.first().filter(|_| *closed)).copied().collect();
        let length: f64 = path.windows(2).map(|w| w[0].distance(w[1])).sum();
        let (mut at, mut k) = (0.0, 0);
        for w in path.windows(2) {
            let edge = w[0].distance(w[1]);
            while k < SAMPLES && at + edge >= (k as f64 + 0.5) / SAMPLES as f64 * length {
                let from = w[0].lerp(w[1], ((k as f64 + 0.5) / SAMPLES as f64 * length - at) / edge);
                // The ink is on the left.
                found.push(first_hit(from, (w[1] - w[0]).perp().normalize(), &edges));
                k += 1;
            }
            at += edge;
        }
        found.extend(std::iter::repeat_n(None, SAMPLES - k));
    }
    found
}

fn first_hit(from: DVec2, way: DVec2, edges: &[(DVec2, DVec2)]) -> Option<f64> {
    let hit = |&(a, b): &(DVec2, DVec2)| {
        let along = b - a;
        let across = way.perp_dot(along);
        let t = (a - from).perp_dot(along) / across;
        let s = (a - from).perp_dot(way) / across;
        (across != 0.0 && t > 1e-6 && (0.0..=1.0).contains(&s)).then_some(t)
    };
    edges.iter().filter_map(hit).reduce(f64::min)
}
