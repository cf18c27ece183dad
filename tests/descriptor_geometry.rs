//! The algebra of descriptors against geometry: what joining predicts is counted on contours.
//!
//! Exemplars are polygons with holes, and wavy strands that split and merge. The counts are taken by the
//! plane's own validated regions, which know nothing of descriptors.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use glam::DVec2;
use openwork::fit::{FitOptions, Outline, OutlineContour, Sides, StitchMethod};
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::{Contour, FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{Cut, ReebGraph, Slicing, SlicingRule};
use openwork::topology::{Descriptor, Topology};
use proptest::prelude::*;

const GRID_EXTENT_MM: f64 = 100.0;

fn snapped(points: impl IntoIterator<Item = DVec2>) -> Vec<GridPoint> {
    let grid = Grid::for_extent(GRID_EXTENT_MM).unwrap();
    points.into_iter().map(|p| grid.snap(p).unwrap()).collect()
}

fn filled(paths: &[Vec<GridPoint>], rule: FillRule) -> Region {
    Region::fill(Grid::for_extent(GRID_EXTENT_MM).unwrap(), paths, rule)
}

/// An exemplar by a few numbers, so that a failing one can be read.
#[derive(Debug, Clone)]
enum Sketch {
    /// Stars of three to nine corners; where an even number overlap there is no ink.
    Stars(Vec<Star>),
    /// Wavy strands of uneven thickness; they split and merge where they cross.
    Strands(Vec<Strand>),
}

#[derive(Debug, Clone)]
struct Star {
    at: (f64, f64),
    radii: Vec<f64>,
    turn: f64,
}

#[derive(Debug, Clone)]
struct Strand {
    from: f64,
    length: f64,
    base: f64,
    amplitude: f64,
    period: f64,
    phase: f64,
    half_width: f64,
    unevenness: f64,
}

impl Sketch {
    fn region(&self) -> Region {
        match self {
            Self::Stars(stars) => {
                filled(&stars.iter().map(Star::path).collect::<Vec<_>>(), FillRule::EvenOdd)
            }
            Self::Strands(strands) => {
                filled(&strands.iter().map(Strand::path).collect::<Vec<_>>(), FillRule::NonZero)
            }
        }
    }
}

impl Star {
    fn path(&self) -> Vec<GridPoint> {
        let sector = TAU / self.radii.len() as f64;
        let corners = self.radii.iter().enumerate();
        snapped(
            corners
                .map(|(k, &r)| DVec2::from(self.at) + r * DVec2::from_angle(self.turn + sector * k as f64)),
        )
    }
}

impl Strand {
    fn path(&self) -> Vec<GridPoint> {
        let n = (self.length * 2.0) as usize;
        let side = |k: usize, sign: f64| {
            let x = self.from + self.length * k as f64 / n as f64;
            let angle = TAU * x / self.period + self.phase;
            let half = self.half_width * (1.0 + self.unevenness * (2.3 * angle).cos());
            DVec2::new(x, self.base + self.amplitude * angle.sin() + sign * half)
        };
        snapped((0..=n).map(|k| side(k, -1.0)).chain((0..=n).rev().map(|k| side(k, 1.0))))
    }
}

fn exemplars() -> impl Strategy<Value = Sketch> {
    let star = ((2.0f64..58.0, -8.0f64..8.0), prop::collection::vec(1.5f64..12.0, 3..10), 0.0f64..TAU)
        .prop_map(|(at, radii, turn)| Star { at, radii, turn });
    let place = (0.0f64..40.0, 10.0f64..60.0, -6.0f64..6.0);
    let wave = (0.5f64..5.0, 8.0f64..40.0, 0.0f64..TAU, 0.3f64..1.2, 0.0f64..0.6);
    let strand = (place, wave).prop_map(|((from, length, base), wave)| {
        let (amplitude, period, phase, half_width, unevenness) = wave;
        Strand { from, length, base, amplitude, period, phase, half_width, unevenness }
    });
    prop_oneof![
        prop::collection::vec(star, 1..8).prop_map(Sketch::Stars),
        prop::collection::vec(strand, 1..6).prop_map(Sketch::Strands),
    ]
    .prop_filter("no ink", |sketch| !sketch.region().is_empty())
}

fn rules() -> impl Strategy<Value = SlicingRule> {
    prop_oneof![
        (1usize..14).prop_map(|lines| SlicingRule::Uniform { lines }),
        Just(SlicingRule::Reeb { persistence_mm: 0.1 }),
    ]
}

fn cuts(region: &Region, rule: SlicingRule) -> Option<Vec<Cut>> {
    Slicing::new(region, &ReebGraph::new(region), rule, &Tolerances::default()).ok().map(|s| s.cuts)
}

fn catalogue(region: &Region, cuts: &[Cut]) -> Catalogue {
    Catalogue::new(region, cuts, &CostWeights::default())
}

/// The topology of a run by the algebra alone.
fn predicted(catalogue: &Catalogue, sequence: &[usize], is_ring: bool) -> Topology {
    let descriptors = catalogue.descriptors();
    let mut run = descriptors[sequence[0]].clone();
    for &piece in &sequence[1..] {
        run = run.join(&descriptors[piece]).unwrap();
    }
    if is_ring { run.close().unwrap() } else { run.finished().unwrap() }
}

/// A run of random joins: from a piece without portals on the left to one without on the right, or closed by a
/// last join. After the random part the way to the end is the shortest.
fn walk(catalogue: &Catalogue, choices: &[u16], is_ring: bool) -> Option<Vec<usize>> {
    let pieces = catalogue.pieces();
    let mut choices = choices.iter().map(|&c| usize::from(c));
    let firsts: Vec<usize> =
        (0..pieces.len()).filter(|&p| is_ring || pieces[p].left_portals() == 0).collect();
    let first = *firsts.get(choices.next()? % firsts.len().max(1))?;
    let mut sequence = vec![first];
    let mut last = first;
    for choice in choices {
        let joins = &catalogue.joins()[last];
        let Some(join) = joins.get(choice % joins.len().max(1)) else { break };
        last = join.to;
        sequence.push(last);
    }
    let is_end = |p: usize| {
        if is_ring { catalogue.join(p, first).is_some() } else { pieces[p].right_portals() == 0 }
    };
    let mut before = vec![None; pieces.len()];
    let mut queue = VecDeque::from([last]);
    let mut end = is_end(last).then_some(last);
    while let Some(p) = queue.pop_front().filter(|_| end.is_none()) {
        for join in &catalogue.joins()[p] {
            if before[join.to].is_none() && join.to != last {
                before[join.to] = Some(p);
                queue.push_back(join.to);
                end = end.or(is_end(join.to).then_some(join.to));
            }
        }
    }
    let mut way = Vec::new();
    let mut at = end?;
    while at != last {
        way.push(at);
        at = before[at]?;
    }
    sequence.extend(way.into_iter().rev());
    Some(sequence)
}

/// The contour on a circle of circumference `length_mm`, v towards the centre, with edges split so finely that
/// their chords are true to the curve.
fn around_circle(contour: &OutlineContour, length_mm: f64) -> Vec<DVec2> {
    let radius = length_mm / TAU;
    let place = |p: DVec2| (radius - p.y) * DVec2::from_angle(p.x / radius);
    let next = contour.points[0] + DVec2::new(length_mm * f64::from(contour.winding), 0.0);
    let ends = contour.points.iter().skip(1).copied().chain([next]);
    let edges = contour.points.iter().copied().zip(ends);
    edges
        .flat_map(|(a, b)| {
            let parts = ((b.x - a.x).abs() / (1e-3 * radius)).ceil().max(1.0);
            (0..parts as usize).map(move |k| place(a.lerp(b, k as f64 / parts)))
        })
        .collect()
}

proptest! {
    // Leaving out one cut leaves one piece where there were two, and its descriptor is that of their join.
    #[test]
    fn a_join_is_the_piece_without_the_cut(sketch in exemplars(), rule in rules()) {
        let region = sketch.region();
        let Some(cuts) = cuts(&region, rule) else { return Ok(()) };
        let cut_up = catalogue(&region, &cuts);
        let parts = cut_up.descriptors();
        for left_out in 0..cuts.len() {
            let mut fewer = cuts.clone();
            fewer.remove(left_out);
            let united = catalogue(&region, &fewer);
            prop_assert_eq!(&parts[left_out].join(&parts[left_out + 1]).unwrap(), &united.descriptors()[left_out]);
        }
    }

    #[test]
    fn the_join_of_all_pieces_is_the_exemplar(sketch in exemplars(), rule in rules()) {
        let region = sketch.region();
        let Some(cuts) = cuts(&region, rule) else { return Ok(()) };
        let catalogue = catalogue(&region, &cuts);
        let all: Vec<usize> = (0..catalogue.pieces().len()).collect();
        let topology = predicted(&catalogue, &all, false);
        let counted = (region.components() as u32, region.holes() as u32);
        prop_assert_eq!((topology.components, topology.holes), counted);
    }

    // Whatever way round the pieces are joined, the plane cannot tell the order.
    #[test]
    fn joining_is_associative(sketch in exemplars(), rule in rules(), split in 0usize..14) {
        let region = sketch.region();
        let Some(cuts) = cuts(&region, rule) else { return Ok(()) };
        let catalogue = catalogue(&region, &cuts);
        let parts = catalogue.descriptors();
        let join = |parts: &[Descriptor]| {
            parts[1..].iter().fold(parts[0].clone(), |run, p| run.join(p).unwrap())
        };
        let split = 1 + split % parts.len();
        let whole = join(parts);
        if split < parts.len() {
            prop_assert_eq!(join(&parts[..split]).join(&join(&parts[split..])).unwrap(), whole);
        }
    }

    // Bending and linking keeps every count of a line, and of a ring on a circle.
    #[test]
    fn stitching_never_changes_the_counts(
        sketch in exemplars(),
        rule in rules(),
        choices in prop::collection::vec(any::<u16>(), 1..14),
        is_ring in any::<bool>(),
        stretch in 0.7f64..1.3,
        stitch in prop::sample::select(vec![StitchMethod::Warp, StitchMethod::Lri]),
    ) {
        let region = sketch.region();
        let Some(cuts) = cuts(&region, rule) else { return Ok(()) };
        let catalogue = catalogue(&region, &cuts);
        let Some(sequence) = walk(&catalogue, &choices, is_ring) else { return Ok(()) };
        let natural_mm: f64 = sequence.iter().map(|&p| catalogue.pieces()[p].width_mm).sum();
        let length_mm = natural_mm * stretch;
        // On a circle the height has to be small against the radius.
        let height_mm = if is_ring { 0.2 * length_mm / TAU } else { catalogue.height_mm() };
        let options = FitOptions { length_mm, height_mm, is_ring, chord_mm: 1e-3, stitch, sides: Sides::Free };
        let outline = Outline::new(&catalogue, &sequence, &options).unwrap();
        let topology = predicted(&catalogue, &sequence, is_ring);
        let winds = outline.contours.iter().any(|c| c.winding != 0);
        prop_assert_eq!(winds, topology.closed_pattern);
        let place = |c: &OutlineContour| if is_ring { around_circle(c, length_mm) } else { c.points.clone() };
        let placed: Vec<Vec<DVec2>> = outline.contours.iter().map(place).collect();
        let extent_mm = placed.iter().flatten().map(|p| p.abs().max_element()).fold(1.0, f64::max);
        let grid = Grid::for_extent(extent_mm).unwrap();
        let contours: Vec<Contour> = placed
            .iter()
            .filter_map(|c| Contour::new(c.iter().map(|&p| grid.snap(p).unwrap()).collect()))
            .collect();
        prop_assert_eq!(contours.len(), outline.contours.len(), "a contour collapsed");
        let fitted = Region::from_contours(grid, contours);
        prop_assert!(fitted.is_ok(), "{:?}\nof {:?}", fitted.err(), sequence);
        let counted = fitted.map(|r| (r.components() as u32, r.holes() as u32));
        prop_assert_eq!(counted, Ok((topology.components, topology.holes)));
    }
}
