//! What runs along the frame: strokes that the border cuts off at a small angle, or that pass beside it, leave hairs of light and swellings.
//!
//! Such stretches are taken away, as the frame is there in their place; what is left of the stroke ends in the open then, and goes on to the
//! frame at a fair angle like other ends near it ([`super::tidy`]). Excluded: what holds an element, which would come loose.

use std::collections::BTreeMap;

use super::ChangeKind;
use super::lines::Owner;
use super::scene::Scene;
use super::step::Step;
use super::work::Work;
use crate::planar::Sets;
use crate::samples::cubic::{Cubic, point_at};

/// Chords by which an edge is looked at.
const LOOKS: usize = 16;
/// A stroke is beside the frame where the gap between them is less than this many pens: with less, hairs of light stay.
const GAP_PENS: f64 = 0.6;
/// It runs along it where it comes nearer by less than this part of its length: at less than 30 degrees. With more, strokes that meet the frame
/// fairly are cut back.
const GRAZING: f64 = 0.5;
/// It is taken away where it does so for more than this many pens: a ring that touches the frame goes on as one.
const LONG_PENS: f64 = 8.0;
/// A stroke that reaches no farther than this many pens beyond that is a swelling of the frame.
const SWELLING_PENS: f64 = 0.5;
/// Where more than this part of all would go, nothing goes.
const MOST_GONE: f64 = 0.5;
/// What is left and is shorter than this many pens is a crumb.
const CRUMB_PENS: f64 = 3.0;

/// The pattern with its edges parted where they begin and cease to run along the frame, and the steps that take these stretches away.
pub(super) fn parted<'a>(scene: &Scene<'a>) -> (Work<'a>, Vec<Step>) {
    let mut work = scene.work.clone();
    let Some(frame_mm) = work.completing.frame_mm else { return (work, Vec::new()) };
    let beside_mm = beside_mm(&work, frame_mm);
    let edges: Vec<usize> = work.present().filter(|&edge| may_go(scene, edge)).collect();
    let stretches =
        edges.iter().filter_map(|&edge| Some((edge, grazing(&work, &work.cubic(edge), beside_mm)?)));
    let mut gone: Vec<usize> = Vec::new();
    for (edge, stretch) in long(&work, stretches.collect()) {
        gone.push(work.part_of(edge, stretch));
    }
    gone.extend(scraps(scene, &work, &gone, beside_mm + SWELLING_PENS * work.pen_mm));
    // In a strip that is hardly wider than its frame everything is beside it, and is the pattern.
    let length_mm =
        |edges: &mut dyn Iterator<Item = usize>| edges.map(|edge| work.length_mm(edge)).sum::<f64>();
    if length_mm(&mut gone.iter().copied()) > MOST_GONE * length_mm(&mut work.present()) {
        return (scene.work.clone(), Vec::new());
    }
    let steps = pieces(&work, &gone)
        .into_values()
        .map(|edges| Step::remove(ChangeKind::Trim, edges, &work))
        .collect();
    (work, steps)
}

/// Those stretches that are long, together with what they go on to in other edges: a ring or a scale that touches the frame stays as it is.
fn long(work: &Work, stretches: Vec<(usize, [f64; 2])>) -> Vec<(usize, [f64; 2])> {
    let count = stretches.len();
    let mut sets = Sets::new(count + work.samples.len());
    for (i, &(edge, [from, until])) in stretches.iter().enumerate() {
        let [a, b] = work.edges[edge].ends;
        [(from == 0.0, a), (until == 1.0, b)]
            .iter()
            .filter(|(reaches, _)| *reaches)
            .for_each(|(_, end)| sets.join(i, count + end));
    }
    let mut lengths_mm = vec![0.0; count + work.samples.len()];
    for (i, &(edge, [from, until])) in stretches.iter().enumerate() {
        lengths_mm[sets.find(i)] += (until - from) * work.length_mm(edge);
    }
    let is_long = |i: usize| lengths_mm[sets.find(i)] > LONG_PENS * work.pen_mm;
    let is_long: Vec<bool> = (0..count).map(is_long).collect();
    stretches.into_iter().zip(is_long).filter(|(_, is_long)| *is_long).map(|(stretch, _)| stretch).collect()
}

/// Whether an edge is not the maker's, nor goes on from what is, and no element hangs on it.
fn may_go(scene: &Scene, edge: usize) -> bool {
    let work = &scene.work;
    let holds = |i: u32| {
        let p = point_at(&work.cubic(edge), f64::from(i) / 4.0);
        let near = scene.lines.near(p, 0.5 * work.width_mm(edge));
        near.iter().any(|(_, line)| matches!(line.owner, Owner::Contour(_)))
    };
    let is_held = work.edges[edge].ends.iter().any(|&end| work.samples[end].is_given);
    !work.is_given(edge) && !is_held && !(0..=4).any(holds)
}

/// The middles of strokes that are beside the frame are nearer to the border than this.
fn beside_mm(work: &Work, frame_mm: f64) -> f64 {
    0.5 * frame_mm + (0.5 + GAP_PENS) * work.pen_mm
}

/// Whether most of a new stroke would run along the frame, as what is taken away there does.
pub(super) fn is_grazing(work: &Work, cubic: &Cubic) -> bool {
    let stretch =
        work.completing.frame_mm.and_then(|frame_mm| grazing(work, cubic, beside_mm(work, frame_mm)));
    stretch.is_some_and(|[from, until]| until - from > 0.5)
}

/// The stretch of a curve that runs along the border within `beside_mm` of it, by its parameters.
fn grazing(work: &Work, cubic: &Cubic, beside_mm: f64) -> Option<[f64; 2]> {
    let at: Vec<_> = (0..=LOOKS).map(|i| point_at(cubic, i as f64 / LOOKS as f64)).collect();
    let length_mm: f64 = at.windows(2).map(|w| w[0].distance(w[1])).sum();
    if work.area.depth_mm(at[LOOKS / 2]) > beside_mm + length_mm {
        return None;
    }
    let depths: Vec<f64> = at.iter().map(|&p| work.area.depth_mm(p)).collect();
    let is_along = |&i: &usize| {
        let nearer_mm = (depths[i + 1] - depths[i]).abs();
        depths[i].min(depths[i + 1]) < beside_mm && nearer_mm < GRAZING * at[i].distance(at[i + 1])
    };
    let (first, last) = ((0..LOOKS).find(is_along)?, (0..LOOKS).rfind(is_along)?);
    Some([first, last + 1].map(|i| i as f64 / LOOKS as f64))
}

/// What is nowhere farther than `swelling_mm` from the border, or would be left beside the stretches that go and is too little to be a stroke.
fn scraps(scene: &Scene, work: &Work, gone: &[usize], swelling_mm: f64) -> Vec<usize> {
    let left: Vec<usize> = work.present().filter(|edge| !gone.contains(edge)).collect();
    let mut is_cut = vec![false; work.samples.len()];
    gone.iter().flat_map(|&edge| work.edges[edge].ends).for_each(|end| is_cut[end] = true);
    let is_scrap = |edges: &Vec<usize>| {
        let length_mm: f64 = edges.iter().map(|&edge| work.length_mm(edge)).sum();
        let is_low = |&edge: &usize| {
            let cubic = work.cubic(edge);
            [0.0, 0.25, 0.5, 0.75, 1.0].iter().all(|&t| work.area.depth_mm(point_at(&cubic, t)) < swelling_mm)
        };
        let is_beside = edges.iter().flat_map(|&edge| work.edges[edge].ends).any(|end| is_cut[end]);
        let is_crumb = is_beside && length_mm < CRUMB_PENS * work.pen_mm;
        // Edges that were parted just now are those of strokes that may go.
        let stays = |&edge: &usize| edge < scene.work.edges.len() && !may_go(scene, edge);
        (is_crumb || edges.iter().all(is_low)) && !edges.iter().any(stays)
    };
    pieces(work, &left).into_values().filter(is_scrap).flatten().collect()
}

/// Edges that hang together, by one of their samples.
fn pieces(work: &Work, edges: &[usize]) -> BTreeMap<usize, Vec<usize>> {
    let mut sets = Sets::new(work.samples.len());
    edges.iter().for_each(|&edge| sets.join(work.edges[edge].ends[0], work.edges[edge].ends[1]));
    let mut pieces: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &edge in edges {
        pieces.entry(sets.find(work.edges[edge].ends[0])).or_default().push(edge);
    }
    pieces
}
