//! The distance to the boundary as a graph: where it peaks, and how far it falls between peaks.
//!
//! Let d be the distance of a point to the boundary of a region. Eroding the ink by r leaves the set d > r,
//! so its topology changes at the critical points of d only: a *peak* (three contacts around a point, where
//! a piece of ink vanishes) or a *pass* (two opposite contacts, where a neck breaks). The same holds for the
//! gaps and dilation. A Delaunay triangulation of the vertices, with edges split until none has a vertex in
//! its diametral circle, carries all of them: a triangle stands for a place between stretches of the
//! boundary, an inner edge for the way from one such place to the next. Distances are those to the edges in
//! sight ([`Walls`]), not to the vertices, so a coarse triangulation gives the distances of the polygons.
//!
//! The gaps are bounded by a frame, far enough away to be no narrow place itself.

use glam::DVec2;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use super::ascent::{Edge, Spot, spot};
use super::walls::Walls;
use crate::planar::Region;

/// Centres nearer to the boundary than this part of the circumradius are not told from points beyond it.
const ON_BORDER: f64 = 1e-6;
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
    /// If that is a pass, and not just the lower end, the unit vector that leads from it towards the first end.
    pub(super) ahead: Option<DVec2>,
}

/// The distance to the boundary on both of its sides.
pub(super) struct Clearance {
    /// One place for each triangle, and whether it is ink. A peak is at least as high as its place.
    pub(super) places: Vec<(Spot, bool)>,
    /// The ways between them; none leads from ink to gap.
    pub(super) ways: Vec<Way>,
}

pub(super) type Mesh = ConstrainedDelaunayTriangulation<Point2<f64>>;

impl Clearance {
    /// Of a region; `None` when it is empty.
    pub(super) fn new(region: &Region) -> Option<Self> {
        let (low, high) = region.bounds_mm()?;
        let mesh = mesh(region, low, high);
        let ink = ink_faces(&mesh);
        let faces = mesh.num_inner_faces();
        let mut survey =
            Survey { walls: Walls::new(&mesh), seats: Vec::with_capacity(faces), in_sight: Vec::new() };
        let mut places: Vec<(Spot, bool)> =
            (0..faces).map(|face| (survey.place(face), ink[face + 1])).collect();
        let mut ways = Vec::with_capacity(mesh.num_undirected_edges());
        for edge in mesh.undirected_edges().filter(|e| !e.is_constraint_edge()) {
            let (a, b) = (edge.as_directed(), edge.as_directed().rev());
            let (Some(left), Some(right)) = (a.face().as_inner(), b.face().as_inner()) else { continue };
            let ends = [left.index() - 1, right.index() - 1];
            let vertices = [a.from().index(), a.to().index()];
            let pass = survey.pass(vertices, ends);
            // Where the way crosses the edge there is at least so much room, whatever the triangles say.
            let narrowest = pass.map_or_else(|| survey.crossing(vertices, ends), |(spot, _)| spot);
            for end in ends {
                if narrowest.radius > places[end].0.radius {
                    places[end].0 = narrowest;
                }
            }
            ways.push(Way { ends, narrowest, ahead: pass.map(|(_, ahead)| ahead) });
        }
        for way in ways.iter_mut().filter(|way| way.ahead.is_none()) {
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
    // An angle limit of zero asks for nothing but the splitting of encroached edges.
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
    let outer = mesh.outer_face();
    (ink[outer.index()], seen[outer.index()]) = (true, true);
    let mut stack: Vec<_> = mesh.convex_hull().map(|e| e.rev().fix()).collect();
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

/// The measuring of places and ways.
struct Survey {
    walls: Walls,
    /// Where each triangle sits on the ridges: its circumcentre, if that is on its side of the boundary.
    seats: Vec<DVec2>,
    /// The edges in sight, kept to spare allocations.
    in_sight: Vec<Edge>,
}

impl Survey {
    /// The place that a triangle stands for: its circumcentre, which is near a peak if there is one.
    fn place(&mut self, face: usize) -> Spot {
        let [a, b, c] = self.walls.corners(face).map(|v| self.walls.at(v));
        let middle = (a + b + c) / 3.0;
        let centre = circumcentre(a, b, c).unwrap_or(middle);
        let radius = centre.distance(a);
        self.look(&[face], centre, radius);
        let found = spot(centre, &self.in_sight);
        // The centre of a right-angled triangle is on the boundary, and at a sharp tip it may be beyond.
        let hidden =
            found.radius < ON_BORDER * radius || self.in_sight.iter().any(|&e| crosses(e, (middle, centre)));
        let found = if hidden { spot(middle, &self.in_sight) } else { found };
        self.seats.push(found.at);
        found
    }

    /// The pass between the boundary around two vertices: a segment that is the shortest between the two,
    /// locally, and whose diametral circle is clear of the boundary. It is on the way between the two
    /// triangles when they sit on different sides of it; other ways nearby lead past it. With it comes the
    /// unit vector from it towards the first triangle.
    fn pass(&mut self, [p, q]: [usize; 2], faces: [usize; 2]) -> Option<(Spot, DVec2)> {
        let (a, b) = (self.walls.at(p), self.walls.at(q));
        let mut best: Option<(Spot, DVec2)> = None;
        let mut offer = |survey: &mut Self, x: DVec2, y: DVec2| {
            let found = Spot { radius: x.distance(y) * 0.5, at: (x + y) * 0.5 };
            let side = |face: usize| (y - x).perp_dot(survey.seats[face] - x) >= 0.0;
            let first = side(faces[0]);
            if best.is_some_and(|(b, _)| b.radius <= found.radius) || first == side(faces[1]) {
                return;
            }
            survey.look(&faces, found.at, found.radius);
            if spot(found.at, &survey.in_sight).radius >= found.radius * (1.0 - ROUNDING) {
                let across = (y - x).normalize_or_zero().perp();
                best = Some((found, if first { across } else { -across }));
            }
        };
        if self.faces_away(p, b) && self.faces_away(q, a) {
            offer(self, a, b);
        }
        for (v, from, w) in [(p, a, q), (q, b, p)] {
            for edge in self.walls.around(w) {
                if let Some(foot) = foot(from, edge)
                    && self.faces_away(v, foot)
                {
                    offer(self, from, foot);
                }
            }
        }
        best
    }

    /// The point between two vertices that is as far from the boundary around the one as around the other.
    fn crossing(&mut self, [p, q]: [usize; 2], faces: [usize; 2]) -> Spot {
        let (mut a, mut b) = (self.walls.at(p), self.walls.at(q));
        let (around_p, around_q) = (self.walls.around(p), self.walls.around(q));
        for _ in 0..CROSSING_ROUNDS {
            let x = (a + b) * 0.5;
            if spot(x, &around_p).radius < spot(x, &around_q).radius { a = x } else { b = x }
        }
        let x = (a + b) * 0.5;
        let limit = spot(x, &around_p).radius;
        self.look(&faces, x, limit);
        let found = spot(x, &self.in_sight);
        Spot { radius: found.radius.min(limit), at: x }
    }

    fn look(&mut self, from: &[usize], centre: DVec2, radius: f64) {
        self.walls.in_sight(from, centre, radius, &mut self.in_sight);
    }

    /// Whether both edges at `v` lead away from `target`, or at most run across.
    fn faces_away(&self, v: usize, target: DVec2) -> bool {
        self.walls.around(v).iter().all(|&(from, to)| {
            let (d, u) = (to - from, target - from);
            d.dot(u) <= ROUNDING * d.length() * u.length()
        })
    }
}

/// The foot of the perpendicular from `p` on an edge, if it falls between its ends.
fn foot(p: DVec2, (a, b): Edge) -> Option<DVec2> {
    let d = b - a;
    let t = (p - a).dot(d) / d.length_squared();
    (t > 0.0 && t < 1.0).then(|| a + d * t)
}

/// Whether two segments meet.
fn crosses((a, b): Edge, (p, q): Edge) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    side(a, b, p) * side(a, b, q) <= 0.0 && side(p, q, a) * side(p, q, b) <= 0.0
}

fn circumcentre(a: DVec2, b: DVec2, c: DVec2) -> Option<DVec2> {
    let (u, v) = (b - a, c - a);
    let det = 2.0 * u.perp_dot(v);
    let (uu, vv) = (u.length_squared(), v.length_squared());
    let x = DVec2::new(uu * v.y - vv * u.y, vv * u.x - uu * v.x) / det;
    x.is_finite().then(|| a + x)
}
