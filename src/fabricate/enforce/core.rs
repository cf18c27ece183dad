//! What ink, and each gap, can be shrunk to: lines in their middle.
//!
//! In a Delaunay triangulation of the contours every vertex lies on a contour, so walking from triangle to triangle
//! without crossing a contour is a graph that hangs together, and has loops, exactly as the ink (or the gap) does. No
//! tolerance is in that. Drawn through a point of each edge that is crossed, it runs along the middle of what is
//! narrow, where it is wanted (Prasad 1997 calls it the chordal axis); in the wide it is any line. Long edges of
//! contours are divided first, or narrow strips would be crossed at few places only.
//!
//! Excluded: what is too narrow ([`super::keep`]), and what becomes of it ([`super::grow`]).

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::planar::{EdgeIndex, IndexedEdge, Region, Sets, threads};

/// A middle of an edge is no better than half of its length, and good from this part on.
const CENTRED: f64 = 0.45;
/// A neck may be so much farther from one side than from the other, as a part of its radius: nodes are about that well in the
/// middle of what is narrow.
const BESIDE: f64 = 0.5;
/// Points of an edge that are looked at for the one farthest from all contours.
const SAMPLES: usize = 15;
/// Finer looks around the best of them, each at half the distance.
const LOOKS: usize = 6;
/// Fewer edges than that are not worth a thread.
const LEAST_SHARE: usize = 1000;
/// The most points that one edge of a contour is divided by.
const MOST_POINTS: f64 = 10_000.0;

/// A point of a core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub(super) at: DVec2,
    /// How far it is from the nearest contour, in millimetres: half of the width here, up to [`Fineness::hold`]. Zero at the
    /// end of a tip.
    pub(super) radius: f64,
    /// The least node that it hangs together with.
    pub(super) part: usize,
}

/// The core of the ink, or that of all gaps.
#[derive(Debug, Clone, Default)]
pub(super) struct Core {
    pub(super) nodes: Vec<Node>,
    /// Straight ways between nodes, each inside of the ink (or of the gap).
    pub(super) links: Vec<[usize; 2]>,
}

type Mesh = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// How finely cores are computed. Lengths are millimetres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fineness {
    /// Halves of the widths, of ink and of gaps, that are wide enough.
    pub(super) enough: [f64; 2],
    /// Halves of the widths from which on nothing need be measured.
    pub(super) hold: [f64; 2],
    /// The longest edge of a contour that is not divided.
    pub(super) spacing: f64,
}

/// The cores of the ink and of the gaps of a region that is not empty.
pub(super) fn cores(region: &Region, index: &EdgeIndex, fineness: &Fineness) -> [Core; 2] {
    let mesh = mesh(region, fineness);
    let ink = ink_faces(&mesh);
    let mut cores = [Core::default(), Core::default()];
    let side_of = |is_ink: bool| usize::from(!is_ink);
    let mut crossing = vec![usize::MAX; mesh.num_undirected_edges()];
    let crossed = mesh.undirected_edges().filter(|edge| !edge.is_constraint_edge()).filter_map(|edge| {
        let face = edge.as_directed().face().as_inner()?;
        let ends = edge.positions().map(|p| DVec2::new(p.x, p.y));
        Some((edge.index(), side_of(ink[face.index()]), ends))
    });
    let crossed: Vec<(usize, usize, [DVec2; 2])> = crossed.collect();
    let find = |&(_, side, ends): &_| widest(index, ends, [fineness.enough[side], fineness.hold[side]]);
    for (&(edge, side, _), found) in crossed.iter().zip(on_all_cores(&crossed, find)) {
        crossing[edge] = cores[side].add(found);
    }
    for face in mesh.inner_faces() {
        let side = side_of(ink[face.index()]);
        let core = &mut cores[side];
        let edges = face.adjacent_edges().map(|edge| edge.as_undirected());
        let open: Vec<usize> =
            edges.iter().filter(|e| !e.is_constraint_edge()).map(|e| crossing[e.index()]).collect();
        let corners = face.positions().map(|p| DVec2::new(p.x, p.y));
        match open[..] {
            [a, b] => core.links.push([a, b]),
            // A tip: its end is the corner that the one open edge does not have.
            [a] => {
                let open = edges.iter().find(|e| !e.is_constraint_edge()).expect("there is one");
                let ends = open.positions().map(|p| DVec2::new(p.x, p.y));
                let tip = corners.into_iter().find(|c| !ends.contains(c)).unwrap_or(corners[0]);
                let end = core.add(Found { at: tip, radius: 0.0 });
                core.links.push([a, end]);
            }
            // Ways meet in the middle, or where one of them crosses its edge if that is wider: a triangle with a corner
            // in a notch has its middle near the notch.
            _ => {
                let middle = Found::new(index, middle(corners), fineness.hold[side]);
                let wider = open.iter().copied().filter(|&a| core.nodes[a].radius > middle.radius);
                let widest =
                    wider.reduce(|a, b| if core.nodes[b].radius > core.nodes[a].radius { b } else { a });
                let meet = widest.unwrap_or_else(|| core.add(middle));
                core.links.extend(open.iter().filter(|&&a| a != meet).map(|&a| [a, meet]));
            }
        }
    }
    cores.iter_mut().for_each(Core::find_parts);
    cores
}

/// What `work` gives for each of `items`, in their order.
fn on_all_cores<T: Sync, U: Send>(items: &[T], work: impl Fn(&T) -> U + Sync) -> Vec<U> {
    let share = items.len().div_ceil(threads()).max(LEAST_SHARE);
    let work = |items: &[T]| items.iter().map(&work).collect::<Vec<U>>();
    std::thread::scope(|scope| {
        let work = &work;
        let mut shares = items.chunks(share);
        let own = shares.next().unwrap_or_default();
        let others: Vec<_> = shares.map(|items| scope.spawn(move || work(items))).collect();
        let mut done = work(own);
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        done
    })
}

impl Core {
    fn add(&mut self, Found { at, radius }: Found) -> usize {
        self.nodes.push(Node { at, radius, part: usize::MAX });
        self.nodes.len() - 1
    }

    fn find_parts(&mut self) {
        let mut parts = Sets::new(self.nodes.len());
        self.links.iter().for_each(|&[a, b]| parts.join(a, b));
        for (i, node) in self.nodes.iter_mut().enumerate() {
            node.part = parts.find(i);
        }
    }

    /// The widest point of each part: one that is surely inside of it.
    pub(super) fn widest_of_parts(&self) -> Vec<Node> {
        let mut widest: Vec<Option<Node>> = vec![None; self.nodes.len()];
        for node in &self.nodes {
            let best = &mut widest[node.part];
            if best.is_none_or(|best| node.radius > best.radius) {
                *best = Some(*node);
            }
        }
        widest.into_iter().flatten().collect()
    }
}

/// A point with its distance to the nearest contour, up to what need not be measured.
#[derive(Debug, Clone, Copy)]
struct Found {
    at: DVec2,
    radius: f64,
}

impl Found {
    fn new(index: &EdgeIndex, at: DVec2, hold: f64) -> Self {
        let radius = |edge: &IndexedEdge| edge.nearest(at).distance(at).min(hold);
        Self { at, radius: index.nearest_within(at, hold).map_or(hold, radius) }
    }
}

/// The distance to the nearest contour.
pub(super) fn radius(index: &EdgeIndex, at: DVec2) -> f64 {
    index.nearest(at).map_or(f64::INFINITY, |edge| edge.nearest(at).distance(at))
}

/// Half of the width across a node that may be a neck, in millimetres: as far as the nearest contour is on one side, there
/// is one on the other, or nearly. Infinite where there is none: the node is near the edge of something wide.
pub(super) fn across(index: &EdgeIndex, node: &Node) -> f64 {
    let Some(edge) = index.nearest(node.at) else { return f64::INFINITY };
    let opposite = 2.0 * node.at - edge.nearest(node.at);
    let beyond = radius(index, opposite);
    if beyond <= BESIDE * node.radius { node.radius + 0.5 * beyond } else { f64::INFINITY }
}

/// The point where an edge of the triangulation is crossed: its middle if that is as wide as matters or as can be, or
/// else the point farthest from all contours. An edge shorter than what is wide enough is narrow wherever it is crossed.
fn widest(index: &EdgeIndex, [a, b]: [DVec2; 2], [enough, hold]: [f64; 2]) -> Found {
    let (middle, length) = (Found::new(index, a.midpoint(b), hold), a.distance(b));
    if length < 2.0 * enough || middle.radius >= hold.min(CENTRED * length) {
        return middle;
    }
    let at = |t: f64| (Found::new(index, a.lerp(b, t), hold), t);
    let mut step = 1.0 / (SAMPLES + 1) as f64;
    let mut best = (middle, 0.5);
    // From an end, and from one point to the next, the distance to the contours rises by no more than the way.
    let mut last = (0.0, 0.0);
    for t in (1..=SAMPLES).map(|i| i as f64 * step) {
        let most = (last.0 + (t - last.1) * length).min((1.0 - t) * length);
        if most > best.0.radius {
            let found = at(t);
            last = (found.0.radius, t);
            if found.0.radius > best.0.radius {
                best = found;
            }
        }
    }
    for _ in 0..LOOKS {
        step *= 0.5;
        for t in [best.1 - step, best.1 + step] {
            // As wide as matters.
            if best.0.radius >= hold {
                return best.0;
            }
            let found = at(t);
            if found.0.radius > best.0.radius {
                best = found;
            }
        }
    }
    best.0
}

/// The circumcentre of a triangle if it is inside, or else the centroid.
fn middle([a, b, c]: [DVec2; 3]) -> DVec2 {
    let (u, v) = (b - a, c - a);
    let det = 2.0 * u.perp_dot(v);
    let (uu, vv) = (u.length_squared(), v.length_squared());
    let centre = a + DVec2::new(uu * v.y - vv * u.y, vv * u.x - uu * v.x) / det;
    let is_left = |p: DVec2, q: DVec2| (q - p).perp_dot(centre - p) > 0.0;
    let is_inside = is_left(a, b) && is_left(b, c) && is_left(c, a);
    if is_inside { centre } else { (a + b + c) / 3.0 }
}

/// The triangulation of the contours, their long edges divided, in a frame.
fn mesh(region: &Region, fineness: &Fineness) -> Mesh {
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let mut points = Vec::with_capacity(2 * region.vertices() + 4);
    let mut edges = Vec::with_capacity(points.capacity());
    let mut close = |points: &Vec<Point2<f64>>, first: usize| {
        let n = points.len();
        edges.extend((first..n).map(|i| [i, if i + 1 < n { i + 1 } else { first }]));
    };
    for contour in region.contours() {
        let first = points.len();
        for (a, b) in contour.edges() {
            let [a, b] = [a, b].map(|p| region.grid().to_mm(p));
            let parts = (a.distance(b) / fineness.spacing).ceil().clamp(1.0, MOST_POINTS);
            points.extend((0..parts as usize).map(|i| {
                let p = a.lerp(b, i as f64 / parts);
                Point2::new(p.x, p.y)
            }));
        }
        close(&points, first);
    }
    // So far away that what lies between is no narrow gap.
    let far = (high - low).length() + 8.0 * fineness.hold[0].max(fineness.hold[1]);
    let (low, high) = (low - far, high + far);
    let first = points.len();
    points.extend([
        Point2::new(low.x, low.y),
        Point2::new(high.x, low.y),
        Point2::new(high.x, high.y),
        Point2::new(low.x, high.y),
    ]);
    close(&points, first);
    Mesh::try_bulk_load_cdt(points, edges, |_| {}).expect("a grid's points are finite")
}

/// Whether each face, by its index, is ink; the outer face counts as ink, as the frame bounds a gap.
fn ink_faces(mesh: &Mesh) -> Vec<bool> {
    let mut ink = vec![true; mesh.num_all_faces()];
    let mut seen = vec![false; mesh.num_all_faces()];
    seen[mesh.outer_face().index()] = true;
    let mut stack: Vec<_> = mesh.convex_hull().map(|edge| edge.rev().fix()).collect();
    while let Some(entered) = stack.pop() {
        let entered = mesh.directed_edge(entered);
        let (face, behind) = (entered.face().index(), entered.rev().face().index());
        if std::mem::replace(&mut seen[face], true) {
            continue;
        }
        ink[face] = ink[behind] != entered.is_constraint_edge();
        stack.extend([entered.next(), entered.prev()].map(|edge| edge.rev().fix()));
    }
    ink
}
