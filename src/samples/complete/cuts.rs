//! Edges that are taken away: between two faces, to open a hole, and where they alone hold a component together, to part it.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::ChangeKind;
use super::lines::Owner;
use super::links::Planner;
use super::scene::Scene;
use super::step::Step;
use crate::planar::Sets;
use crate::samples::cubic::point_at;

/// A strand of at most so many spacings is taken away as a whole; a longer one is cut.
const WHOLE_SPACINGS: f64 = 2.5;
/// The gap of a cut is at least this many pens, to be seen as one.
const GAP_PENS: f64 = 0.75;
/// What a cut leaves has to be as long as this many pens, or it would be a crumb.
const CRUMB_PENS: f64 = 3.0;

/// Edges one after the other, between samples where there is a choice or an end.
struct Strand {
    edges: Vec<usize>,
    /// The samples in the order of the edges, one more than there are edges.
    samples: Vec<usize>,
}

/// Edges of a strand that may be taken away, and the faces to either side.
struct Cut {
    /// The number of the strand.
    strand: usize,
    edges: Vec<usize>,
    confidence: f64,
    faces: [usize; 2],
}

impl Planner<'_, '_> {
    /// Up to `needed` steps of which each opens a hole, to the outside or to another, and parts nothing.
    pub fn openings(&self, needed: usize) -> Vec<Step> {
        let mut sets = Sets::new(self.scene.region.holes() + 1);
        let mut steps = Vec::new();
        // Each cut was judged by what the others leave of its strand, so there is one of each at a time.
        let mut is_cut = BTreeSet::new();
        for cut in self.cuts() {
            let [a, b] = cut.faces.map(|face| sets.find(face));
            if a == b || steps.len() == needed || is_cut.contains(&cut.strand) {
                continue;
            }
            if self.would_open_ring(&mut sets, [a, b]) {
                continue;
            }
            let step = Step::remove(ChangeKind::Open, cut.edges, &self.scene.work);
            if !(self.is_banned)(&step) {
                sets.join(a, b);
                is_cut.insert(cut.strand);
                steps.push(step);
            }
        }
        steps
    }

    /// Whether uniting two sets of faces would leave no ink that winds round, where that is wanted.
    fn would_open_ring(&self, sets: &mut Sets, [a, b]: [usize; 2]) -> bool {
        self.inside.is_some_and(|inside| {
            let (outside, inside) = (sets.find(0), sets.find(inside));
            outside != inside && [a.min(b), a.max(b)] == [outside.min(inside), outside.max(inside)]
        })
    }

    /// Up to `needed` steps of which each makes two components of one.
    pub fn partings(&self, needed: usize) -> Vec<Step> {
        let cuts = self.cuts().into_iter().filter(|cut| cut.faces[0] == cut.faces[1]);
        let step = |cut: Cut| (cut.strand, Step::remove(ChangeKind::Part, cut.edges, &self.scene.work));
        let steps = cuts.map(step).filter(|(_, step)| !(self.is_banned)(step));
        let mut is_cut = BTreeSet::new();
        steps.filter(|&(strand, _)| is_cut.insert(strand)).map(|(_, step)| step).take(needed).collect()
    }

    /// A step that opens a hole where after it the fewest more would have to be opened to part the component: what two faces share
    /// in two places parts when both are cut, and of three faces that meet in pairs all.
    pub fn opening_to_part(&self) -> Option<Step> {
        let cuts: Vec<Cut> = self
            .cuts()
            .into_iter()
            .filter(|cut| cut.faces[0] != cut.faces[1])
            .filter(|cut| {
                self.inside.is_none_or(|inside| !cut.faces.contains(&0) || !cut.faces.contains(&inside))
            })
            .collect();
        let mut shared: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut around: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for &Cut { faces: [a, b], .. } in &cuts {
            *shared.entry([a.min(b), a.max(b)]).or_default() += 1;
            around.entry(a).or_default().insert(b);
            around.entry(b).or_default().insert(a);
        }
        let worth = |cut: &Cut| {
            let [a, b] = cut.faces;
            (shared[&[a.min(b), a.max(b)]] > 1, around[&a].intersection(&around[&b]).count())
        };
        let steps = cuts
            .iter()
            .map(|cut| (worth(cut), Step::remove(ChangeKind::Open, cut.edges.clone(), &self.scene.work)));
        let mut best: Option<((bool, usize), Step)> = None;
        for (worth, step) in steps.filter(|(_, step)| !(self.is_banned)(step)) {
            if best.as_ref().is_none_or(|(known, _)| worth > *known) {
                best = Some((worth, step));
            }
        }
        best.map(|(_, step)| step)
    }

    /// One cut for each strand and each two faces that it has on its sides, those of least confidence first.
    fn cuts(&self) -> Vec<Cut> {
        let strands = strands(self.scene);
        let mut cuts: Vec<Cut> =
            strands.iter().enumerate().flat_map(|(i, strand)| self.cuts_of(i, strand)).collect();
        // Where nothing is known of them, in an order that does not begin in one corner.
        let scattered = |cut: &Cut| (cut.edges[0] as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        cuts.sort_by(|a, b| a.confidence.total_cmp(&b.confidence).then(scattered(a).cmp(&scattered(b))));
        cuts
    }

    fn cuts_of(&self, number: usize, strand: &Strand) -> Vec<Cut> {
        let (scene, work) = (self.scene, &self.scene.work);
        if strand.edges.iter().any(|&edge| work.is_given(edge)) {
            return Vec::new();
        }
        let length =
            |range: Range<usize>| strand.edges[range].iter().map(|&edge| work.length_mm(edge)).sum::<f64>();
        let count = strand.edges.len();
        let ends = [strand.samples[0], strand.samples[count]];
        // Other ink holds an end as well as another edge does: the frame, an element, a stroke that passes there.
        let holding = ends.map(|end| scene.ink_at(end));
        let is_held: Vec<bool> = (0..2)
            .map(|side| {
                let end = ends[side];
                scene.by_sample[end].len() > 1 || work.samples[end].is_given || !holding[side].is_empty()
            })
            .collect();
        let is_loop = ends[0] == ends[1];
        // What is left at an end in the open is a component by itself, and may not be a crumb.
        let leaves_no_crumb = |range: &Range<usize>| {
            let remains = [length(0..range.start), length(range.end..count)];
            is_loop || (0..2).all(|side| is_held[side] || remains[side] >= CRUMB_PENS * work.pen_mm)
        };
        let is_whole =
            is_held == [true; 2] && !is_loop && length(0..count) < WHOLE_SPACINGS * scene.spacing_mm;
        let ranges: Vec<Range<usize>> = match is_whole {
            true => std::iter::once(0..count).collect(),
            false => self.gaps(strand).filter(leaves_no_crumb).collect(),
        };
        let mut cuts: Vec<Cut> = Vec::new();
        for range in ranges {
            let edges = strand.edges[range].to_vec();
            let Some(faces) = edges.iter().find_map(|&edge| faces(scene, edge)) else { continue };
            let is_known = |cut: &Cut| cut.faces == faces || cut.faces == [faces[1], faces[0]];
            if cuts.iter().any(is_known)
                || !self.is_bold && edges.iter().any(|&edge| self.is_touched(edge, strand, &holding))
            {
                continue;
            }
            let confidence =
                edges.iter().map(|&edge| work.edges[edge].confidence).fold(f64::INFINITY, f64::min);
            cuts.push(Cut { strand: number, edges, confidence, faces });
        }
        cuts
    }

    /// Around each edge, the least confident first, as many as leave a gap that is seen as one; all if there are no more.
    fn gaps<'t>(&self, strand: &'t Strand) -> impl Iterator<Item = Range<usize>> + use<'t, '_> {
        let work = &self.scene.work;
        let gap_mm = (GAP_PENS * work.pen_mm).max(self.scene.margin_mm()) + work.pen_mm;
        let confidence = |i: usize| work.edges[strand.edges[i]].confidence;
        let off_middle = |i: usize| (2 * i + 1).abs_diff(strand.edges.len());
        let mut order: Vec<usize> = (0..strand.edges.len()).collect();
        order.sort_by(|&a, &b| {
            confidence(a).total_cmp(&confidence(b)).then(off_middle(a).cmp(&off_middle(b))).then(a.cmp(&b))
        });
        let at = |i: usize| work.samples[strand.samples[i]].at;
        order.into_iter().map(move |least| {
            let mut range = least..least + 1;
            while work.area.way(at(range.start), at(range.end)).length() < gap_mm {
                match (range.start > 0, range.end < strand.edges.len()) {
                    (true, true) if range.len() % 2 == 0 => range.start -= 1,
                    (_, true) => range.end += 1,
                    (true, false) => range.start -= 1,
                    (false, false) => break,
                }
            }
            range
        })
    }

    /// Whether ink lies at an edge that is not of its own path, nor what holds the ends of that: it would be left in the gap, or hangs on to it.
    fn is_touched(&self, edge: usize, strand: &Strand, holding: &[Vec<Owner>; 2]) -> bool {
        let (scene, work) = (self.scene, &self.scene.work);
        let own =
            strand.samples.iter().flat_map(|&sample| scene.own(super::work::Foot::Sample(sample), None));
        let mut own: Vec<Owner> = own.collect();
        own.extend(strand.edges.iter().map(|&edge| Owner::Edge(edge)));
        own.extend(holding.iter().flatten());
        let cubic = work.cubic(edge);
        [0.2, 0.4, 0.6, 0.8].into_iter().any(|t| {
            let near = scene.lines.near(point_at(&cubic, t), work.width_mm(edge) / 2.0);
            near.iter().any(|(_, line)| !own.contains(&line.owner))
        })
    }
}

/// The faces to the left and to the right of an edge, where both sides of it lie open at one place.
fn faces(scene: &Scene, edge: usize) -> Option<[usize; 2]> {
    let work = &scene.work;
    let cubic = work.cubic(edge);
    let off_mm = work.width_mm(edge) / 2.0 + 2.0 * work.completing.chord_mm;
    [0.5, 0.3, 0.7].into_iter().find_map(|t| {
        let along = point_at(&cubic, t + 0.05) - point_at(&cubic, t - 0.05);
        let across = along.perp().normalize_or_zero() * off_mm;
        let face = |p| scene.places.face(work.plane.place(p));
        Some([face(point_at(&cubic, t) + across)?, face(point_at(&cubic, t) - across)?])
    })
}

/// All edges as strands.
fn strands(scene: &Scene) -> Vec<Strand> {
    let work = &scene.work;
    let is_inner = |sample: usize| scene.by_sample[sample].len() == 2;
    let mut is_used = vec![false; work.edges.len()];
    let mut strands = Vec::new();
    let outer = |edge: usize| work.edges[edge].ends.into_iter().find(|&end| !is_inner(end));
    let begins = work.present().filter_map(|edge| Some((edge, outer(edge)?)));
    let loops = work.present().map(|edge| (edge, work.edges[edge].ends[0]));
    for (edge, begin) in begins.chain(loops) {
        if is_used[edge] {
            continue;
        }
        let mut strand = Strand { edges: Vec::new(), samples: vec![begin] };
        let (mut at, mut edge) = (begin, edge);
        loop {
            is_used[edge] = true;
            strand.edges.push(edge);
            let [a, b] = work.edges[edge].ends;
            at = if at == a { b } else { a };
            strand.samples.push(at);
            match scene.by_sample[at].iter().find(|&&next| is_inner(at) && !is_used[next]) {
                Some(&next) => edge = next,
                None => break,
            }
        }
        strands.push(strand);
    }
    strands
}
