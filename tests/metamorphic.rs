//! What does not change an ornament changes neither what can be made of it nor what that costs: moving the exemplar,
//! scaling it, adding a point on an edge, and drawing it left for right.

use openwork::pieces::{Catalogue, CostWeights, Endpoint, Piece};
use openwork::planar::{FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};
use openwork::solver::{Problem, Step, solve};
use openwork::topology::{Descriptor, Goal, Shape, Topology, Wanted};
use proptest::prelude::*;

/// Overlapping boxes: left, bottom, width and height.
type Boxes = Vec<(i64, i64, i64, i64)>;

/// How the same drawing is given.
#[derive(Debug, Clone, Copy)]
enum Change {
    None,
    Moved(i64, i64),
    Scaled(i64),
    /// With so many points more on each edge.
    Dense(i64),
    Mirrored,
}

const STEP: i64 = 10_000_000;
/// The greatest number of holes that is looked at.
const MOST_HOLES: u32 = 3;

fn region(boxes: &Boxes, change: Change) -> Region {
    let place = |x: i64, y: i64| match change {
        Change::Moved(dx, dy) => GridPoint::new((x + dx) * STEP, (y + dy) * STEP),
        Change::Scaled(factor) => GridPoint::new(x * factor * STEP, y * factor * STEP),
        Change::Mirrored => GridPoint::new((200 - x) * STEP, y * STEP),
        Change::None | Change::Dense(_) => GridPoint::new(x * STEP, y * STEP),
    };
    let more = if let Change::Dense(n) = change { n } else { 0 };
    let paths: Vec<Vec<GridPoint>> = boxes
        .iter()
        .map(|&(x, y, w, h)| {
            let corners = [place(x, y), place(x + w, y), place(x + w, y + h), place(x, y + h)];
            let edge = |i: usize| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                let at = move |k: i64, a: i64, b: i64| a + (b - a) / (more + 1) * k;
                (0..=more).map(move |k| GridPoint::new(at(k, a.x, b.x), at(k, a.y, b.y)))
            };
            (0..4).flat_map(edge).collect()
        })
        .collect();
    Region::fill(Grid::for_extent(100.0).unwrap(), &paths, FillRule::EvenOdd)
}

/// The heights of the portal endpoints on the left and the right of each piece in micrometres, with what is closed in it
/// and χ; and the cost of the best run for each goal, in millionths.
type Answers = (Vec<Sides>, Vec<Option<u64>>);
type Sides = ([Vec<i64>; 2], u32, i64);

fn answers(boxes: &Boxes, change: Change, lines: usize, window: (u32, u32)) -> Option<Answers> {
    let region = region(boxes, change);
    let rule = SlicingRule::Uniform { lines };
    let slicing = Slicing::new(&region, &ReebGraph::new(&region), rule, &Tolerances::default()).ok()?;
    if slicing.cuts.len() != lines {
        return None;
    }
    let catalogue = Catalogue::new(&region, &slicing.cuts, &CostWeights::default());
    let n = catalogue.pieces().len();
    let step = |j: &openwork::pieces::Join| Step { to: j.to, cost: (j.cost * 1e6).round() as u64, rise: 0 };
    let ends = |side: fn(&Descriptor) -> &[u16]| {
        (0..n).map(|p| side(&catalogue.descriptors()[p]).is_empty().then_some(0)).collect::<Vec<_>>()
    };
    let problem = Problem {
        shape: Shape::Open,
        descriptors: catalogue.descriptors(),
        widths: vec![1; n],
        steps: catalogue.joins().iter().map(|joins| joins.iter().map(step).collect()).collect(),
        begin: ends(Descriptor::left),
        end: ends(Descriptor::right),
        window: window.0..=window.1,
        drift_limit: 1,
        variety: None,
        memory_limit: 1 << 28,
    };
    let goals = std::iter::once(Goal::default()).chain((0..=MOST_HOLES).map(|holes| Goal {
        components: Some(Wanted::exactly(1)),
        holes: Some(Wanted::exactly(holes)),
        closed_pattern: false,
    }));
    let cost = |goal: Goal| {
        let solution = solve(&problem, goal).ok()?;
        let mut pieces = solution.sequence.iter().map(|&p| catalogue.descriptors()[p].clone());
        let first = pieces.next()?;
        let run = pieces.try_fold(first, |run, piece| run.join(&piece)).ok()?;
        assert!(run.finished().is_some_and(|topology: Topology| goal.admits(topology)));
        Some(solution.cost)
    };
    let heights = |ends: &[Endpoint]| ends.iter().map(|e| (e.y_mm * 1e3).round() as i64).collect::<Vec<_>>();
    let sides =
        |p: &Piece| ([heights(&p.left), heights(&p.right)], p.descriptor.closed(), p.descriptor.euler());
    let pieces = catalogue.pieces().iter().map(sides).collect();
    Some((pieces, goals.map(cost).collect()))
}

proptest! {
    #[test]
    fn the_same_drawing_has_the_same_answers(
        boxes in prop::collection::vec((0i64..60, 0i64..30, 4i64..40, 2i64..20), 2..9),
        lines in 2usize..7,
        window in (3u32..9, 0u32..3).prop_map(|(low, more)| (low, low + more)),
        shift in (-40i64..40, -40i64..40),
    ) {
        let plain = answers(&boxes, Change::None, lines, window);
        prop_assume!(plain.is_some());
        let (pieces, plain) = plain.unwrap();
        let changes =
            [Change::Moved(shift.0, shift.1), Change::Scaled(2), Change::Dense(1), Change::Mirrored];
        for change in changes {
            let is_mirror = matches!(change, Change::Mirrored);
            let Some((changed_pieces, changed)) = answers(&boxes, change, lines, window) else {
                prop_assert!(is_mirror, "{change:?} has other cuts");
                continue;
            };
            // A cut that would run along an edge gives way to one side, which a mirror does not know.
            let turned = |([left, right], closed, euler): &Sides| {
                ([right.clone(), left.clone()], *closed, *euler)
            };
            let is_mirrored = pieces.iter().rev().map(turned).eq(changed_pieces);
            if is_mirror && !is_mirrored {
                continue;
            }
            for (a, b) in plain.iter().zip(&changed) {
                // Each join is rounded to a millionth by itself, and cuts to a grid that does not scale.
                let agree = match (a, b) {
                    (Some(a), Some(b)) => a.abs_diff(*b) <= 2 * u64::from(window.1) + 2 + a / 10_000,
                    (a, b) => a == b,
                };
                prop_assert!(agree, "{:?}: {:?} instead of {:?}", change, changed, plain);
            }
        }
    }
}
