//! The distance to the boundary as a graph: where it peaks, and how far it falls between peaks.
//!
//! Let d be the distance of a point to the boundary of a region. Eroding the ink by r leaves the set d > r,
//! so its topology changes at the critical points of d only: a *peak* (three contacts around a point, where
//! a piece of ink vanishes) or a *pass* (two opposite contacts, where a neck breaks). The same holds for the
//! gaps and dilation. A Delaunay triangulation of the vertices, with edges split until none has a vertex in
//! its diametral circle, carries all of them: a triangle stands for a place between three stretches of the
//! boundary, an inner edge for the way from one such place to the next. Values are not those of the
//! vertices but of the edges next to them, so a coarse triangulation gives the distances of the polygons.
//!
//! The gaps are bounded by a frame, far enough away to be no narrow place itself.

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use super::ascent::{self, Edge, Spot, ascend};
use crate::planar::Region;

/// How far a peak is looked for from a triangle's circumcentre, as part of its radius. No edge is nearer than
/// 0.7 of it where edges are not encroached; farther off, edges that were not looked at could be in the way.
const PEAK_REACH: f64 = 0.5;
/// Halvings in the search for the middle between two stretches of the boundary.
const CROSSING_ROUNDS: usize = 12;
/// Relative slack in tests of angles and distances, against rounding only.
const ROUNDING: f64 = 1e-9;

/// A way between two places of the same side of the boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// The places, as indices into [`Clearance::places`].
    pub(super) ends: [usize; 2],
    /// The narrowest spot along the way.
    pub(super) narrowest: Spot,
    /// Whether that is a pass, and not just the lower end.
    pub(super) is_pass: bool,
}

/// The distance to the boundary on both of its sides.
pub(super) struct Clearance {
    /// One place for each triangle, and whether it is ink.
    pub(super) places: Vec<(Spot, bool)>,
    /// The ways between them; none leads from ink to gap.
    pub(super) ways: Vec<Way>,
}

type Mesh = ConstrainedDelaunayTriangulation<Point2<f64>>;

impl Clearance {
    /// Of a region that is not empty.
    pub(super) fn new(region: &Region) -> Option<Self> {
        let (low, high) = region.bounds_mm()?;
        let mesh = mesh(region, low, high);
        let border = Border::new(&mesh);
        let ink = ink_faces(&mesh);
        let mut places: Vec<(Spot, bool)> = Vec::with_capacity(ink.len());
        for face in mesh.inner_faces() {
            debug_assert_eq!(face.index(), places.len() + 1);
            let corners = face.vertices().map(|v| v.index());
            let across = face.adjacent_edges().map(|e| {
                let apex = if e.is_constraint_edge() { None } else { e.rev().opposite_vertex() };
                apex.unwrap_or(e.from()).index()
            });
            places.push((border.peak(corners, across), ink[face.index()]));
        }
        let mut ways = Vec::with_capacity(mesh.num_undirected_edges());
        for edge in mesh.undirected_edges().filter(|e| !e.is_constraint_edge()) {
            let (a, b) = (edge.as_directed(), edge.as_directed().rev());
            let (Some(left), Some(right)) = (a.face().as_inner(), b.face().as_inner()) else { continue };
            let ends = [left.index() - 1, right.index() - 1];
            let (p, q) = (a.from().index(), a.to().index());
            let apexes = [a, b].map(|e| e.opposite_vertex().map_or(p, |v| v.index()));
            let around = [p, q, apexes[0], apexes[1]];
            let pass = border.pass(around);
            // Where the way crosses the edge there is at least so much room, whatever the triangles say.
            let crossing = pass.unwrap_or_else(|| border.crossing(around));
            for end in ends {
                if crossing.radius > places[end].0.radius {
                    places[end].0 = crossing;
                }
            }
            ways.push(Way { ends, narrowest: crossing, is_pass: pass.is_some() });
        }
        for way in ways.iter_mut().filter(|way| !way.is_pass) {
            // Without a pass in between, the distance falls evenly to the lower end.
            let [a, b] = way.ends.map(|end| places[end].0);
            way.narrowest = if a.radius < b.radius { a } else { b };
        }
        Some(Self { places, ways })
    }
}

/// The triangulation of the region's contours and a frame, without encroached edges.
fn mesh(region: &Region, low: DVec2, high: DVec2) -> Mesh {
    let mut points = Vec::with_capacity(region.vertices() + 4);
    let mut edges = Vec::with_capacity(region.vertices() + 4);
    let mut add = |ring: &mut dyn Iterator<Item = DVec2>| {
        let first = points.len();
        points.extend(ring.map(|p| Point2::new(p.x, p.y)));
        edges.extend((first..points.len()).map(|i| [i, if i + 1 < points.len() { i + 1 } else { first }]));
    };
    for contour in region.contours() {
        add(&mut contour.points().iter().map(|&p| region.grid().to_mm(p)));
    }
    let far = (high - low).length() * 2.0;
    let (low, high) = (low - far, high + far);
    let frame = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    add(&mut frame.into_iter());
    let limit = points.len() * 20;
    let mut mesh = Mesh::try_bulk_load_cdt(points, edges, |_| {}).expect("a grid's points are finite");
    let parameters = RefinementParameters::<f64>::new()
        .with_angle_limit(AngleLimit::from_deg(0.0))
        .with_max_additional_vertices(limit);
    mesh.refine(parameters);
    mesh
}

/// Whether each face, by index, is ink: crossing a constraint changes sides. The face outside of the frame
/// counts as ink.
fn ink_faces(mesh: &Mesh) -> Vec<bool> {
    let mut ink = vec![false; mesh.num_all_faces()];
    let mut seen = vec![false; mesh.num_all_faces()];
    let mut stack = Vec::new();
    let outer = mesh.outer_face();
    (ink[outer.index()], seen[outer.index()]) = (true, true);
    stack.extend(mesh.convex_hull().map(|e| e.rev().fix()));
    while let Some(entered) = stack.pop() {
        let entered = mesh.directed_edge(entered);
        let (face, behind) = (entered.face().index(), entered.rev().face().index());
        if std::mem::replace(&mut seen[face], true) {
            continue;
        }
        ink[face] = ink[behind] ^ entered.is_constraint_edge();
        stack.extend([entered.next(), entered.prev()].map(|e| e.rev().fix()));
    }
    ink
}

/// The boundary around each vertex of the triangulation.
struct Border {
    at: Vec<DVec2>,
    /// The neighbours of each vertex along its contour.
    next: Vec<[usize; 2]>,
}

impl Border {
    fn new(mesh: &Mesh) -> Self {
        let at: Vec<DVec2> = mesh.vertices().map(|v| v.position()).map(|p| DVec2::new(p.x, p.y)).collect();
        let mut next: Vec<[usize; 2]> = (0..at.len()).map(|v| [v, v]).collect();
        for edge in mesh.undirected_edges().filter(|e| e.is_constraint_edge()) {
            let [p, q]: [FixedVertexHandle; 2] = edge.vertices().map(|v| v.fix());
            for (v, w) in [(p.index(), q.index()), (q.index(), p.index())] {
                let slot = usize::from(next[v][0] != v);
                next[v][slot] = w;
            }
        }
        Self { at, next }
    }

    /// The two edges that meet in `v`.
    fn edges(&self, v: usize) -> [Edge; 2] {
        self.next[v].map(|w| (self.at[v], self.at[w]))
    }

    /// The distance of `x` to the boundary around `v`, squared.
    fn distance_squared(&self, v: usize, x: DVec2) -> f64 {
        let [a, b] = self.edges(v).map(|edge| ascent::nearest(edge, x).distance_squared(x));
        a.min(b)
    }

    /// `x` with its distance to the boundary around `vertices`.
    fn spot(&self, x: DVec2, vertices: &[usize]) -> Spot {
        let squares = vertices.iter().map(|&v| self.distance_squared(v, x));
        Spot { radius: squares.fold(f64::INFINITY, f64::min).sqrt(), at: x }
    }

    /// The peak of the distance to the boundary around a triangle's `corners` and the corners `across` its
    /// sides.
    fn peak(&self, corners: [usize; 3], across: [usize; 3]) -> Spot {
        let [a, b, c] = corners.map(|v| self.at[v]);
        let mut edges = [[(DVec2::ZERO, DVec2::ZERO); 2]; 6];
        for (slot, &v) in edges.iter_mut().zip(corners.iter().chain(&across)) {
            *slot = self.edges(v);
        }
        let edges = edges.as_flattened();
        let middle = ascent::spot((a + b + c) / 3.0, edges);
        let Some(centre) = circumcentre(a, b, c) else { return middle };
        let peak = ascend(centre, edges, PEAK_REACH * centre.distance(a));
        if peak.radius > middle.radius { peak } else { middle }
    }

    /// The pass between the boundary around the first two vertices of `around`: a segment that is the
    /// shortest between the two, locally, and whose diametral circle is clear of the boundary `around`.
    fn pass(&self, around: [usize; 4]) -> Option<Spot> {
        let [p, q, ..] = around;
        let (a, b) = (self.at[p], self.at[q]);
        let mut best: Option<Spot> = None;
        let mut offer = |x: DVec2, y: DVec2| {
            let spot = Spot { radius: x.distance(y) * 0.5, at: (x + y) * 0.5 };
            let clear = spot.radius * (1.0 - ROUNDING);
            if best.is_none_or(|b| spot.radius < b.radius) && self.spot(spot.at, &around).radius >= clear {
                best = Some(spot);
            }
        };
        let (p_faces, q_faces) = (self.faces_away(p, b), self.faces_away(q, a));
        if p_faces && q_faces {
            offer(a, b);
        }
        for (v, from, w) in [(p, a, q), (q, b, p)] {
            for end in self.next[w] {
                if let Some(foot) = foot(from, self.at[w], self.at[end])
                    && self.faces_away(v, foot)
                {
                    offer(from, foot);
                }
            }
        }
        best
    }

    /// The point between the first two vertices of `around` that is as far from the boundary around the one
    /// as around the other.
    fn crossing(&self, around: [usize; 4]) -> Spot {
        let [p, q, ..] = around;
        let (mut a, mut b) = (self.at[p], self.at[q]);
        for _ in 0..CROSSING_ROUNDS {
            let x = (a + b) * 0.5;
            if self.distance_squared(p, x) < self.distance_squared(q, x) {
                a = x;
            } else {
                b = x;
            }
        }
        self.spot((a + b) * 0.5, &around)
    }

    /// Whether both edges at `v` lead away from `target`, or at most run across.
    fn faces_away(&self, v: usize, target: DVec2) -> bool {
        let u = target - self.at[v];
        self.next[v].iter().all(|&w| {
            let d = self.at[w] - self.at[v];
            d.dot(u) <= ROUNDING * d.length() * u.length()
        })
    }
}

/// The foot of the perpendicular from `p`, if it falls between `a` and `b`.
fn foot(p: DVec2, a: DVec2, b: DVec2) -> Option<DVec2> {
    let d = b - a;
    let t = (p - a).dot(d) / d.length_squared();
    (t > 0.0 && t < 1.0).then(|| a + d * t)
}

fn circumcentre(a: DVec2, b: DVec2, c: DVec2) -> Option<DVec2> {
    let (u, v) = (b - a, c - a);
    let det = 2.0 * u.perp_dot(v);
    let (uu, vv) = (u.length_squared(), v.length_squared());
    let x = DVec2::new(uu * v.y - vv * u.y, vv * u.x - uu * v.x) / det;
    x.is_finite().then(|| a + x)
}
