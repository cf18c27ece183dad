//! The middle lines of all ink in a tree, to find what is near and whether a new stroke would run clear of it.

use std::cmp::Ordering;

use std::collections::BTreeMap;

use glam::DVec2;
use kurbo::PathEl;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

use super::work::Work;
use crate::samples::Element;
use crate::samples::cubic::{Cubic, point_at};

/// Chords of an edge.
pub(super) const CHORDS: u32 = 8;

/// A stroke that is within reach of the ink it comes from for more than so many pens runs alongside of it, with a slit between.
const MOST_ALONGSIDE: f64 = 2.5;

/// Whose line it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owner {
    /// An edge of the graph.
    Edge(usize),
    /// A contour of an element, the contours numbered through all elements.
    Contour(usize),
    /// A stroke of the frame.
    Frame(usize),
}

/// A straight piece of ink.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub from: DVec2,
    pub to: DVec2,
    /// Half of its width; 0 for an outline.
    pub half_mm: f64,
    pub owner: Owner,
    /// Where it begins and ends in its edge, by the parameter of the curve.
    span: [f64; 2],
}

impl Line {
    /// An order that does not depend on how the lines were found.
    fn order(&self, other: &Self) -> Ordering {
        let places = |line: &Self| [line.span[0], line.from.x, line.from.y];
        let by_place =
            || places(self).iter().zip(places(other)).map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne());
        self.owner.cmp(&other.owner).then_with(|| by_place().unwrap_or(Ordering::Equal))
    }

    /// The part of the way along the line at which it is nearest to `p`.
    fn nearest_part(&self, p: DVec2) -> f64 {
        let d = self.to - self.from;
        let square = d.length_squared();
        if square > 0.0 { ((p - self.from).dot(d) / square).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The point of the line nearest to `p`, and its parameter in its edge.
    pub fn nearest(&self, p: DVec2) -> (DVec2, f64) {
        let part = self.nearest_part(p);
        (self.from.lerp(self.to, part), self.span[0] + part * (self.span[1] - self.span[0]))
    }
}

impl RTreeObject for Line {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.from.to_array(), self.to.to_array())
    }
}

impl PointDistance for Line {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        let p = DVec2::from_array(*point);
        self.nearest(p).0.distance_squared(p)
    }
}

/// How a new stroke lies between its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Run {
    /// It leaves the ink at its one end and meets ink again at the other, and none between.
    Clear,
    /// The ink of its ends is so near that the pen always touches it.
    Short,
    /// It touches other ink.
    Blocked,
}

/// The middle lines of edges and frame, and the outlines of elements.
pub(super) struct Lines {
    tree: RTree<Line>,
    by_owner: BTreeMap<Owner, Vec<Line>>,
    /// Half of the widest pen.
    most_half_mm: f64,
    lap_mm: Option<f64>,
}

impl Lines {
    pub fn new(work: &Work) -> Self {
        let mut lines = Vec::new();
        for edge in work.present() {
            lines.extend(of_cubic(&work.cubic(edge), work.width_mm(edge) / 2.0, edge));
        }
        let contours = work.elements.iter().flat_map(|element: &Element| &element.contours).enumerate();
        for (number, contour) in contours {
            for (&from, &to) in contour.iter().zip(contour.iter().cycle().skip(1)) {
                lines.push(Line { from, to, half_mm: 0.0, owner: Owner::Contour(number), span: [0.0; 2] });
            }
        }
        for (number, curve) in work.frame.iter().enumerate() {
            let mut begin = DVec2::ZERO;
            let mut from = DVec2::ZERO;
            for element in curve.path.elements() {
                let to = match *element {
                    PathEl::MoveTo(p) => {
                        begin = DVec2::new(p.x, p.y);
                        from = begin;
                        continue;
                    }
                    PathEl::LineTo(p) => DVec2::new(p.x, p.y),
                    _ => begin,
                };
                lines.push(Line {
                    from,
                    to,
                    half_mm: curve.width_mm / 2.0,
                    owner: Owner::Frame(number),
                    span: [0.0; 2],
                });
                from = to;
            }
        }
        let lap_mm = work.area.lap_mm();
        let most_half_mm = lines.iter().map(|line| line.half_mm).fold(0.0, f64::max);
        let empty = Self { tree: RTree::new(), by_owner: BTreeMap::new(), most_half_mm, lap_mm };
        empty.with(lines.into_iter().flat_map(|line| empty.copies(line)).collect())
    }

    /// Lines like these in the same plane.
    fn with(&self, lines: Vec<Line>) -> Self {
        let mut by_owner: BTreeMap<Owner, Vec<Line>> = BTreeMap::new();
        lines.iter().for_each(|line| by_owner.entry(line.owner).or_default().push(*line));
        Self { tree: RTree::bulk_load(lines), by_owner, ..*self }
    }

    /// The line where it is, and once round to both sides.
    fn copies(&self, line: Line) -> Vec<Line> {
        let shifts = match self.lap_mm {
            Some(lap_mm) => vec![-lap_mm, 0.0, lap_mm],
            None => vec![0.0],
        };
        let moved =
            |x: f64| Line { from: line.from + DVec2::new(x, 0.0), to: line.to + DVec2::new(x, 0.0), ..line };
        shifts.into_iter().map(moved).collect()
    }

    /// Adds the curve of an edge.
    pub fn add(&mut self, cubic: &Cubic, half_mm: f64, edge: usize) {
        self.most_half_mm = self.most_half_mm.max(half_mm);
        for line in of_cubic(cubic, half_mm, edge) {
            for copy in self.copies(line) {
                self.tree.insert(copy);
                self.by_owner.entry(copy.owner).or_default().push(copy);
            }
        }
    }

    /// The lines whose ink is within `reach_mm` of `p`, by how far their ink is, nearest first.
    pub fn near(&self, p: DVec2, reach_mm: f64) -> Vec<(f64, &Line)> {
        let reach = reach_mm + self.most_half_mm;
        let mut found: Vec<(f64, &Line)> = self
            .tree
            .locate_within_distance(p.to_array(), reach * reach)
            .map(|line| (line.nearest(p).0.distance(p) - line.half_mm, line))
            .filter(|&(gap, _)| gap <= reach_mm)
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.order(b.1)));
        found
    }

    /// All lines, by how far their middles are from `p`, nearest first, and of those that are as far in the order of their owners.
    pub fn nearest_first(&self, p: DVec2) -> impl Iterator<Item = (f64, &Line)> {
        let lines = self.tree.nearest_neighbor_iter(p.to_array());
        let mut lines = lines.map(move |line| (line.nearest(p).0.distance(p), line)).peekable();
        // Those that are as far as one another, the last first: the tree has them as it was built.
        let mut tied: Vec<(f64, &Line)> = Vec::new();
        std::iter::from_fn(move || {
            if tied.is_empty() {
                let first = lines.next()?;
                tied.push(first);
                while let Some(next) = lines.next_if(|next| next.0 == first.0) {
                    tied.push(next);
                }
                tied.sort_by(|a, b| b.1.order(a.1));
            }
            tied.pop()
        })
    }

    /// The first of [`Self::nearest_first`] that is of one of some owners. What lies between is not gone through.
    pub fn nearest_of(&self, owners: &[Owner], p: DVec2) -> Option<&Line> {
        let lines = owners.iter().filter_map(|owner| self.by_owner.get(owner)).flatten();
        let ways = lines.map(|line| (line.nearest(p).0.distance(p), line));
        ways.min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.order(b.1))).map(|(_, line)| line)
    }

    /// Only the lines of some owners.
    pub fn only(&self, is_wanted: impl Fn(Owner) -> bool) -> Self {
        self.with(self.tree.iter().filter(|line| is_wanted(line.owner)).copied().collect())
    }

    /// How a stroke along `cubic` would lie that may touch only what `is_own`, and keeps `margin_mm` from what it does not touch.
    pub fn run(&self, cubic: &Cubic, half_mm: f64, margin_mm: f64, is_own: impl Fn(Owner) -> bool) -> Run {
        let length = cubic.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let steps = (length / half_mm.max(1e-9)).ceil().clamp(6.0, 200.0) as u32;
        let (mut runs, mut was) = (0, false);
        // By end, how many of the steps touch the ink there.
        let mut touching = [0, 0];
        for i in 0..=steps {
            let near = self.near(point_at(cubic, f64::from(i) / f64::from(steps)), half_mm + margin_mm);
            if near.iter().any(|(_, line)| !is_own(line.owner)) {
                return Run::Blocked;
            }
            let touches = !near.is_empty();
            runs += usize::from(touches && !was);
            touching[usize::from(runs > 1)] += u32::from(touches);
            was = touches;
        }
        let most_mm = MOST_ALONGSIDE * (2.0 * half_mm + margin_mm);
        let is_alongside =
            touching.iter().any(|&count| f64::from(count) * length > most_mm * f64::from(steps));
        match runs {
            _ if is_alongside => Run::Blocked,
            1 => Run::Short,
            2 => Run::Clear,
            _ => Run::Blocked,
        }
    }
}

fn of_cubic(cubic: &Cubic, half_mm: f64, edge: usize) -> impl Iterator<Item = Line> {
    let at = |i: u32| f64::from(i) / f64::from(CHORDS);
    let cubic = *cubic;
    (0..CHORDS).map(move |i| {
        let span = [at(i), at(i + 1)];
        let [from, to] = span.map(|t| point_at(&cubic, t));
        Line { from, to, half_mm, owner: Owner::Edge(edge), span }
    })
}
