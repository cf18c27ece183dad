//! What does not change an ornament changes neither what can be made of it nor what that costs: moving the exemplar,
//! scaling it, adding a point on an edge, turning it upside down, and drawing it left for right.

use std::cell::Cell;

use openwork::pieces::{Catalogue, CostWeights, Endpoint, Join, Piece};
use openwork::planar::{FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};
use openwork::solver::{Problem, Step, solve};
use openwork::topology::{Descriptor, Goal, Shape, Topology, Wanted};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Overlapping boxes: left, bottom, width and height.
type Boxes = Vec<(i64, i64, i64, i64)>;

/// How the same drawing is given.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Change {
    None,
    Moved(i64, i64),
    /// By so many halves.
    Scaled(i64),
    /// With so many points more on each edge.
    Dense(i64),
    Flipped,
    Mirrored,
}

/// What is made of it.
#[derive(Debug, Clone, Copy)]
struct Request {
    lines: usize,
    shape: Shape,
    window: (u32, u32),
    /// In thousandths of a millimetre of the drawing as it is.
    drift_limit: i32,
}

const STEP: i64 = 10_000_000;
/// A drift that nothing reaches.
const FAR: i32 = 1_000_000_000;

impl Change {
    fn factor(self) -> f64 {
        if let Self::Scaled(halves) = self { halves as f64 / 2.0 } else { 1.0 }
    }
}

fn region(boxes: &Boxes, change: Change) -> Region {
    let place = |x: i64, y: i64| match change {
        Change::Moved(dx, dy) => GridPoint::new((x + dx) * STEP, (y + dy) * STEP),
        Change::Scaled(halves) => GridPoint::new(x * halves * (STEP / 2), y * halves * (STEP / 2)),
        Change::Mirrored => GridPoint::new((200 - x) * STEP, y * STEP),
        Change::Flipped => GridPoint::new(x * STEP, (100 - y) * STEP),
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

/// The pieces of a drawing; `None` when a cut has to be left out.
fn cut_up(boxes: &Boxes, change: Change, lines: usize) -> Option<Catalogue> {
    let region = region(boxes, change);
    let rule = SlicingRule::Uniform { lines };
    let slicing = Slicing::new(&region, &ReebGraph::new(&region), rule, &Tolerances::default()).ok()?;
    (slicing.cuts.len() == lines).then(|| Catalogue::new(&region, &slicing.cuts, &CostWeights::default()))
}

/// What the best run for a goal costs, in millionths, and what it makes.
fn answer(catalogue: &Catalogue, change: Change, request: &Request, goal: Goal) -> Option<(u64, Topology)> {
    let n = catalogue.pieces().len();
    let step = |j: &Join| Step {
        to: j.to,
        cost: (j.cost * 1e6).round() as u64,
        rise: (j.rise_mm / change.factor() * 1e3).round() as i32,
    };
    let ends = |side: fn(&Descriptor) -> &[u16]| {
        (0..n).map(|p| side(&catalogue.descriptors()[p]).is_empty().then_some(0)).collect::<Vec<_>>()
    };
    let problem = Problem {
        shape: request.shape,
        descriptors: catalogue.descriptors(),
        widths: vec![1; n],
        steps: catalogue.joins().iter().map(|joins| joins.iter().map(step).collect()).collect(),
        begin: ends(Descriptor::left),
        end: ends(Descriptor::right),
        window: request.window.0..=request.window.1,
        drift_limit: request.drift_limit,
        variety: None,
        memory_limit: 1 << 28,
        effort_limit: usize::MAX,
    };
    let solution = solve(&problem, goal).ok()?;
    let pieces = solution.sequence.iter().map(|&p| &catalogue.descriptors()[p]);
    let topology = request.shape.topology(pieces).expect("a solution adds up");
    assert!(goal.admits(topology));
    Some((solution.cost, topology))
}

/// Goals that the drawing can meet, from what its best run makes, and some that it can just not, or seldom.
fn goals(made: Topology) -> Vec<Goal> {
    let goal = |components: Option<u32>, holes: Option<u32>| Goal {
        components: components.map(Wanted::exactly),
        holes: holes.map(Wanted::exactly),
        closed_pattern: false,
    };
    vec![
        Goal::default(),
        goal(Some(1), None),
        goal(Some(made.components), None),
        goal(Some(made.components), Some(made.holes)),
        goal(Some(made.components), Some(made.holes + 1)),
        goal(None, Some(made.holes + 1)),
        Goal { components: Wanted::between(1, made.components.max(2)), ..goal(None, Some(made.holes)) },
        Goal { closed_pattern: made.closed_pattern, ..goal(Some(made.components + 1), None) },
    ]
}

/// The heights of the portal endpoints on the left and the right of a piece in micrometres, with what is closed in it
/// and χ.
type Sides = ([Vec<i64>; 2], u32, i64);

fn sides(p: &Piece) -> Sides {
    let heights = |ends: &[Endpoint]| ends.iter().map(|e| (e.y_mm * 1e3).round() as i64).collect::<Vec<_>>();
    ([heights(&p.left), heights(&p.right)], p.descriptor.closed(), p.descriptor.euler())
}

fn is_mirrored(plain: &Catalogue, changed: &Catalogue) -> bool {
    let turned = |p: &Piece| {
        let ([left, right], closed, euler) = sides(p);
        ([right, left], closed, euler)
    };
    plain.pieces().iter().rev().map(turned).eq(changed.pieces().iter().map(sides))
}

/// The same drawings each time, so that it can be told how much they say.
#[test]
fn the_same_drawing_has_the_same_answers() {
    let boxes = prop::collection::vec((0i64..60, 0i64..30, 4i64..40, 2i64..20), 2..9);
    // About as many pieces as the drawing has, which are a run by themselves.
    let request = (2usize..7, any::<bool>(), (0u32..2, 0u32..3), prop_oneof![1 => Just(FAR), 2 => 1i32..20])
        .prop_map(|(lines, is_ring, (less, more), limit)| Request {
            lines,
            shape: if is_ring { Shape::Ring } else { Shape::Open },
            window: ((lines as u32 + 1).saturating_sub(less), lines as u32 + 1 + more),
            // Beside what whole boxes rise by.
            drift_limit: if limit == FAR { FAR } else { 100 * limit + 37 },
        });
    // Comparisons of two answers, of those of rings, of those in a band, and of all.
    let [met, rings, banded, all] = [const { Cell::new(0) }; 4];
    let count = |cell: &Cell<u32>, is_one: bool| cell.set(cell.get() + u32::from(is_one));
    let config = Config { failure_persistence: None, ..Config::with_cases(256) };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let drawings = (boxes, request, (-40i64..40, -40i64..40));
    let outcome = runner.run(&drawings, |(boxes, request, shift)| {
        let Some(plain) = cut_up(&boxes, Change::None, request.lines) else {
            return Err(TestCaseError::reject("a cut is left out"));
        };
        let level = Request { drift_limit: FAR, ..request };
        let made = answer(&plain, Change::None, &level, Goal::default());
        let goals = made.map_or(vec![Goal::default()], |(_, made)| goals(made));
        let changes = [
            Change::Moved(shift.0, shift.1),
            Change::Scaled(1),
            Change::Scaled(4),
            Change::Scaled(6),
            Change::Dense(1),
            Change::Flipped,
            Change::Mirrored,
        ];
        for change in changes {
            let Some(changed) = cut_up(&boxes, change, request.lines) else {
                prop_assert!(change == Change::Mirrored, "{change:?} has other cuts");
                continue;
            };
            // A cut that would run along an edge gives way to one side, which a mirror does not know.
            if change == Change::Mirrored && !is_mirrored(&plain, &changed) {
                continue;
            }
            // Drift is measured from where a run begins, which the mirror moves to its end.
            let request = if change == Change::Mirrored { level } else { request };
            for &goal in &goals {
                let costs = [(&plain, Change::None), (&changed, change)].map(|(catalogue, change)| {
                    answer(catalogue, change, &request, goal).map(|(cost, _)| cost)
                });
                // Each join is rounded to a millionth by itself, and cuts to a grid that does not scale.
                let agree = match costs {
                    [Some(a), Some(b)] => a.abs_diff(b) <= 2 * u64::from(request.window.1) + 2 + a / 10_000,
                    [a, b] => a == b,
                };
                prop_assert!(agree, "{change:?} of {request:?}: {costs:?} for {goal:?}");
                count(&all, true);
                count(&met, costs[0].is_some());
                count(&rings, costs[0].is_some() && request.shape == Shape::Ring);
                count(&banded, costs[0].is_some() && request.drift_limit < FAR);
            }
        }
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
    let [met, rings, banded, all] = [met, rings, banded, all].map(|cell| cell.get());
    assert!(2 * met > all && 4 * rings > met && 4 * banded > met, "{met}, {rings}, {banded} of {all}");
}
