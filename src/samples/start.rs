//! The first samples of the coarsest level (Tu 2020 §4.3.2).
//!
//! Patches of the exemplar are laid side by side, each chosen so that it suits those beside it where they overlap; there only samples are copied that
//! nothing stands for yet. The paper copies no edges; here they come along, since a strand that is whole in a patch had better stay so.

use glam::DVec2;
use rustc_hash::{FxHashMap, FxHashSet};

use super::area::Area;
use super::copies::CloneBox;
use super::draws::Draws;
use super::graph::{Edge, Graph, Kind};
use super::neighbours::Buckets;
use super::options::Options;
use super::parallel::in_parallel;
use super::sampling::curve_sample;
use super::source::Source;

/// The side of a patch as a part of the exemplar's shorter side.
const PATCH: f64 = 0.5;
/// How far patches overlap, as a part of their side.
const OVERLAP: f64 = 0.35;
/// Places of the exemplar that are tried for a patch.
const TRIES: usize = 160;
/// And places around the best of these.
const REFINED: u32 = 60;
/// All of it is laid so often, and what suits best in sum is taken.
const STARTS: usize = 8;
/// Samples nearer to each other than this part of δ are the same in an overlap.
const SAME: f64 = 0.6;

/// The output in the making: samples, edges, and the sample of the exemplar that each sample was copied from.
pub struct Started {
    /// Samples and edges.
    pub graph: Graph,
    /// For each sample the exemplar's; `None` for what was given.
    pub origins: Vec<Option<usize>>,
}

struct Patcher<'a> {
    source: &'a Source,
    points: Vec<DVec2>,
    area: &'a Area,
    spacing_mm: f64,
    unmatched_mm: f64,
    started: Started,
    pairs: FxHashSet<[usize; 2]>,
    /// What is covered: middles and half sizes.
    windows: Vec<(DVec2, DVec2)>,
}

/// Patches over all of the area but for the clones, around what is `given`.
pub fn patches(
    source: &Source,
    given: Graph,
    clones: &[CloneBox],
    area: &Area,
    options: &Options,
    spacing_mm: f64,
) -> Started {
    let all = in_parallel(STARTS, |number| {
        laid(source, given.clone(), clones, area, options, spacing_mm, number as u64)
    });
    let best = all.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    best.expect("there are several starts").0
}

/// One way to lay them, and how badly they suit one another in all.
fn laid(
    source: &Source,
    given: Graph,
    clones: &[CloneBox],
    area: &Area,
    options: &Options,
    spacing_mm: f64,
    number: u64,
) -> (Started, f64) {
    let origins = vec![None; given.samples.len()];
    let pairs = given.edges.iter().map(|edge| edge.ends).collect();
    let mut patcher = Patcher {
        source,
        points: source.graph.samples.iter().map(|s| s.at).collect(),
        area,
        spacing_mm,
        unmatched_mm: options.unmatched.most * spacing_mm,
        started: Started { graph: given, origins },
        pairs,
        windows: clones.iter().map(|clone| (clone.to_mm, clone.half_mm)).collect(),
    };
    let mut unsuited = 0.0;
    let (low, high) = source.bounds_mm;
    let (area_low, area_high) = area.bounds_mm();
    let half = DVec2::splat(0.5 * PATCH * (high - low).min_element());
    let step = 2.0 * half * (1.0 - OVERLAP);
    let size = area_high - area_low;
    let count = ((size - if area.lap_mm().is_some() { DVec2::new(0.0, 2.0 * half.y) } else { 2.0 * half })
        / step)
        .ceil()
        .max(DVec2::ZERO);
    let [columns, rows] = [count.x as usize + usize::from(area.lap_mm().is_none()), count.y as usize + 1];
    let columns = columns.max(1);
    for row in 0..rows {
        for column in 0..columns {
            // There and back, so that each patch lies beside the one before.
            let column = if row % 2 == 0 { column } else { columns - 1 - column };
            let share = |i: usize, n: usize| if n < 2 { 0.5 } else { i as f64 / (n - 1) as f64 };
            let x = match area.lap_mm() {
                Some(lap_mm) => lap_mm * (column as f64 + 0.5) / columns as f64,
                None => area_low.x + half.x + share(column, columns) * (size.x - 2.0 * half.x),
            };
            let middle = DVec2::new(x, area_low.y + half.y + share(row, rows) * (size.y - 2.0 * half.y));
            let mut draws = Draws::new(options.seed, &[1, number, row as u64, column as u64]);
            unsuited += patcher.lay_best(middle, half, &mut draws);
        }
    }
    (patcher.started, unsuited)
}

impl Patcher<'_> {
    /// Lays the place of the exemplar that suits best around `middle`, and says how badly it suits.
    fn lay_best(&mut self, middle: DVec2, half: DVec2, draws: &mut Draws) -> f64 {
        let (low, high) = self.source.bounds_mm;
        let room = (high - low - 2.0 * half).max(DVec2::ZERO);
        let existing = self.existing(middle, half);
        let mut best: Option<(f64, DVec2)> = None;
        let tries = if existing.is_empty() { 1 } else { TRIES };
        let points = &self.points;
        let buckets = Buckets::new(points, self.spacing_mm, None);
        let attempt = |from: DVec2, best: &mut Option<(f64, DVec2)>| {
            let score = self.score(&buckets, &existing, middle, from, half);
            if best.is_none_or(|(least, _)| score < least) {
                *best = Some((score, from));
            }
        };
        for _ in 0..tries {
            attempt(low + half + room * DVec2::new(draws.unit(), draws.unit()), &mut best);
        }
        // Nearer and nearer around the best.
        for round in 0..if tries > 1 { REFINED } else { 0 } {
            let (_, around) = best.expect("one was tried");
            let reach = room.max_element() * 0.25 * (1.0 - f64::from(round) / f64::from(REFINED));
            let by = DVec2::new(draws.unit() - 0.5, draws.unit() - 0.5) * 2.0 * reach;
            attempt((around + by).clamp(low + half, low + half + room), &mut best);
        }
        let (unsuited, from) = best.expect("one was tried");
        self.lay(middle, from, half);
        unsuited
    }

    /// What there is in a window: numbers and offsets from its middle.
    fn existing(&self, middle: DVec2, half: DVec2) -> Vec<(usize, DVec2)> {
        let samples = self.started.graph.samples.iter().enumerate();
        let inside = samples.map(|(i, s)| (i, self.area.way(middle, s.at)));
        inside.filter(|(_, offset)| offset.abs().cmple(half).all()).collect()
    }

    fn is_covered(&self, p: DVec2) -> bool {
        self.windows.iter().any(|&(middle, half)| self.area.way(middle, p).abs().cmplt(half).all())
    }

    /// How badly a place of the exemplar suits what there is: Eq. 7 with nearest samples for matches, both ways.
    fn score(
        &self,
        buckets: &Buckets<'_>,
        existing: &[(usize, DVec2)],
        middle: DVec2,
        from: DVec2,
        half: DVec2,
    ) -> f64 {
        let inputs = &self.source.graph.samples;
        let reach = self.unmatched_mm;
        let mut is_used: FxHashSet<usize> = FxHashSet::default();
        let mut score = 0.0;
        for &(s, offset) in existing {
            let kind = self.started.graph.samples[s].kind;
            let mut nearest: Option<(f64, usize)> = None;
            buckets.within(from + offset, reach, |i, way| {
                let d = way.length();
                if inputs[i].kind == kind
                    && nearest.is_none_or(|(least, j)| d < least || (d == least && i < j))
                {
                    nearest = Some((d, i));
                }
            });
            score += nearest.map_or(reach, |(d, _)| d.min(reach));
            is_used.extend(nearest.map(|(_, i)| i));
        }
        let mut extra = 0usize;
        buckets.within(from, half.length(), |i, way| {
            let is_in = way.abs().cmple(half).all();
            if is_in
                && !is_used.contains(&i)
                && self.is_covered(middle + way)
                && self.area.contains(middle + way)
            {
                extra += 1;
            }
        });
        score + reach * extra as f64
    }

    /// Copies the window of the exemplar around `from` to `middle`.
    fn lay(&mut self, middle: DVec2, from: DVec2, half: DVec2) {
        let existing = self.existing(middle, half * 1.2);
        let same_mm = SAME * self.spacing_mm;
        let inputs = &self.source.graph.samples;
        let mut copy_of: FxHashMap<usize, usize> = FxHashMap::default();
        let mut is_taken: FxHashSet<usize> = FxHashSet::default();
        let mut fresh: FxHashSet<usize> = FxHashSet::default();
        for (i, input) in inputs.iter().enumerate() {
            let offset = input.at - from;
            if !offset.abs().cmple(half).all() {
                continue;
            }
            let at = self.area.home(middle + offset);
            let near = existing.iter().filter(|&&(s, _)| {
                self.started.graph.samples[s].kind == input.kind && !is_taken.contains(&s)
            });
            let same = near
                .map(|&(s, there)| (there.distance(offset), s))
                .filter(|(d, _)| *d < same_mm)
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((_, s)) = same {
                is_taken.insert(s);
                copy_of.insert(i, s);
            } else if self.area.contains(at) && !self.is_covered(at) {
                let number = self.started.graph.samples.len();
                self.started.graph.samples.push(super::graph::Sample {
                    at,
                    is_given: false,
                    ..input.clone()
                });
                self.started.origins.push(Some(i));
                copy_of.insert(i, number);
                fresh.insert(number);
            }
        }
        for edge in &self.source.graph.edges {
            let [Some(&a), Some(&b)] = edge.ends.map(|end| copy_of.get(&end)) else { continue };
            let ends = [a.min(b), a.max(b)];
            if a != b && (fresh.contains(&a) || fresh.contains(&b)) && self.pairs.insert(ends) {
                let [h0, h1] = edge.handles;
                let handles = if a < b { [h0, h1] } else { [h1, h0] };
                self.started.graph.edges.push(Edge { ends, confidence: 1.0, handles });
            }
        }
        self.windows.push((middle, half));
    }
}

/// Single samples at random places, as many as the exemplar has for the size of the area, each like a random one of the exemplar and without
/// edges: white noise (Tu 2020 §5.2).
pub fn noise(source: &Source, given: Graph, clones: &[CloneBox], area: &Area, options: &Options) -> Started {
    let (low, high) = source.bounds_mm;
    let density = source.graph.samples.len() as f64 / (high - low).element_product();
    let (area_low, area_high) = area.bounds_mm();
    let size = area_high - area_low;
    let count = (density * size.element_product()).round() as usize;
    let mut started = Started { origins: vec![None; given.samples.len()], graph: given };
    let mut draws = Draws::new(options.seed, &[2]);
    for _ in 0..count {
        let at = area_low + size * DVec2::new(draws.unit(), draws.unit());
        let i = draws.below(source.graph.samples.len());
        let like = &source.graph.samples[i];
        if area.contains(at) && !clones.iter().any(|clone| clone.covers(at, area)) {
            let sample = match like.kind {
                Kind::Curve => super::graph::Sample {
                    orientations: like.orientations.clone(),
                    ..curve_sample(at, like.width_mm)
                },
                Kind::Element { .. } => super::graph::Sample { at, is_given: false, ..like.clone() },
            };
            started.graph.samples.push(sample);
            started.origins.push(None);
        }
    }
    started
}
