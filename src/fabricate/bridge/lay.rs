//! Laying bridges of one kind: the shortest first, each where it is best.

use std::collections::BTreeSet;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use super::fence::Fence;
use super::ground::{Ground, nearest_step};
use super::links::{Link, links};
use super::place::{Place, Prober};
use super::trial::{Asked, Effort, Purpose, REQUIRED, Site, Verdict};
use super::{Bridge, BridgeError, BridgeKind, BridgeOptions, Bridged, Counts};
use crate::planar::{EdgeIndex, GridPoint, Region, Sets};

/// A machine's narrowest width is exceeded by this: what is just as wide is lost in rounding.
const SPARE: f64 = 1.05;
/// How hard a place is looked for. A link that finds none is tried again more generously after links a little
/// longer had their turn.
const TRIES: [Try; 6] = [
    Try { detour: [0.3, 1.0], wider: 1.0, is_alone: true, places: 10 },
    Try { detour: [2.0, 4.0], wider: 1.0, is_alone: false, places: 40 },
    // Where many parts nearly touch, a wide bridge covers the pockets that a narrow one would cut off.
    Try { detour: [0.3, 1.0], wider: 1.6, is_alone: false, places: 10 },
    Try { detour: [0.3, 1.0], wider: 2.5, is_alone: false, places: 10 },
    Try { detour: [2.0, 4.0], wider: 1.6, is_alone: false, places: 40 },
    Try { detour: [2.0, 4.0], wider: 2.5, is_alone: false, places: 40 },
];

struct Try {
    /// A place may be so much farther than the nearest, in parts of its distance and in widths, if it is better.
    detour: [f64; 2],
    /// The width of the bridge, in parts of what was asked for.
    wider: f64,
    /// Whether it may join two only.
    is_alone: bool,
    /// How many places are tried out, the best first.
    places: usize,
}
/// What each grade of hold is worth, in widths of length, and what it is worth to do what the machine requires.
const GRADE_WORTH: f64 = 0.5;
const REQUIRED_WORTH: f64 = 10.0;
/// Loops are looked for within so many widths first, and then within twice as many, and so on.
const FIRST_REACH: f64 = 4.0;
/// The grade that a loop must have while there may be a better place elsewhere.
const GOOD_GRADE: usize = 1;
/// After so many places in a row that would not do, there is none: more would only take longer to say so.
const MOST_FAILURES: usize = 400;
/// The most that one bridge changes the count by.
const LARGEST_CROWD: usize = 16;
/// How often all bridges of a kind are laid anew: what found no place is then joined first, while there is room.
const MOST_ROUNDS: usize = 8;
/// Middles of bridges closer than this, in widths, would overlap.
const BESIDE: f64 = 1.2;

/// `region` with `needed` bridges of one kind, if they are found with what is left of the `effort`.
pub(super) fn lay(
    region: &Region,
    kind: BridgeKind,
    needed: usize,
    options: &BridgeOptions<'_>,
    effort: &Effort,
) -> Result<Bridged, BridgeError> {
    let side = kind.side();
    let ground = Ground::new(region);
    let index = EdgeIndex::new(region);
    let machine_mm = if kind.is_strut() { options.min_feature_mm } else { options.min_gap_mm };
    let width_mm = options.width_mm.max(SPARE * machine_mm);
    let prober = Prober { ground: &ground, index: &index, side, width_mm };
    let (low, high) = region.bounds_mm().unwrap_or_default();
    let has = Counts::of(region);
    let mut hard = BTreeSet::new();
    let mut done = 0;
    // Windows have the counts of the whole but for the rounding of their borders. Should that ever make a
    // difference, the bridge that makes it is looked for and not laid again.
    let mut banned = Vec::new();
    let mut known = Known::default();
    let fence = options.within.filter(|_| kind.is_strut()).map(Fence::new);
    for _ in 0..MOST_ROUNDS {
        let site = Site::new(&ground, side, width_mm, options, fence.as_ref(), effort);
        let mut layer = Layer {
            prober,
            site,
            kind,
            needed,
            has,
            banned: &banned,
            known: &mut known,
            effort,
            extent_mm: low.distance(high),
            done: 0,
            bridges: Vec::new(),
            laid: Vec::new(),
        };
        let mut left = Vec::new();
        if kind == BridgeKind::Join || kind == BridgeKind::Open {
            let apart = options.closed_around.filter(|_| kind == BridgeKind::Open);
            let apart = apart.map(|p| [0, ground.face_of(region, nearest_step(region.grid(), p))]);
            left = layer.join(apart, &hard);
        } else {
            layer.close();
        }
        if !layer.is_done() {
            done = layer.done.max(done);
            if effort.is_spent() {
                return Err(BridgeError::TooMuch { kind, done, needed, width_mm });
            }
            let known = hard.len();
            hard.extend(left);
            if hard.len() == known {
                break;
            }
            continue;
        }
        let built = layer.site.built(usize::MAX);
        if Counts::of(&built) == kind.changed(has, needed) {
            return Ok(Bridged { region: built, bridges: layer.bridges });
        }
        banned.push(layer.bridges[layer.first_wrong()].corners_mm);
    }
    Err(BridgeError::NoPlace { kind, done, needed, width_mm })
}

/// What was found out in earlier rounds, which hardly differ from one to the next.
#[derive(Default)]
struct Known {
    /// Places between two contours, by the number of the try.
    places: FxHashMap<([usize; 2], usize), Rc<[Place]>>,
    verdicts: FxHashMap<Asked, Option<Verdict>>,
}

/// Bridges of one kind while they are laid.
struct Layer<'a> {
    prober: Prober<'a>,
    site: Site<'a>,
    kind: BridgeKind,
    needed: usize,
    has: Counts,
    /// The corners of bridges that must not be laid.
    banned: &'a [[[f64; 2]; 4]],
    known: &'a mut Known,
    effort: &'a Effort,
    extent_mm: f64,
    /// By how many the count has been changed.
    done: usize,
    bridges: Vec<Bridge>,
    /// After each bridge: how many outlines there are, and by how many the count has been changed.
    laid: Vec<(usize, usize)>,
}

impl Layer<'_> {
    fn is_done(&self) -> bool {
        self.done == self.needed
    }

    /// Whether there is nothing left to do, or nothing to do it with.
    fn is_over(&self) -> bool {
        self.is_done() || self.effort.is_spent()
    }

    /// Joins the nearest nodes first (Kruskal's minimum spanning forest), but never the two of `apart`, and before all
    /// others those that are `hard` to join. The nodes that could not be joined are returned.
    fn join(&mut self, apart: Option<[usize; 2]>, hard: &BTreeSet<usize>) -> Vec<usize> {
        let mut sets = Joined::new(self.prober.ground.nodes(self.prober.side), apart);
        if !hard.is_empty() {
            self.join_some(&mut sets, |a, b| hard.contains(&a) || hard.contains(&b));
        }
        self.join_some(&mut sets, |_, _| true);
        if self.is_done() { Vec::new() } else { sets.left_out(self.prober.ground.nodes(self.prober.side)) }
    }

    /// Joins the nearest nodes first, of the pairs that are `meant`.
    fn join_some(&mut self, sets: &mut Joined, meant: impl Fn(usize, usize) -> bool) {
        let (ground, side) = (self.prober.ground, self.prober.side);
        let (mut over, mut reach) = (-1.0, self.prober.width_mm);
        // Links without a place for a bridge: when longer ones are taken, they too may take a longer way.
        let mut again: Vec<(Link, usize)> = Vec::new();
        while !self.is_over() && (over <= self.extent_mm || !again.is_empty()) {
            let fresh = links(ground, side, over, reach, |a, b| meant(a, b) && sets.may_join(a, b));
            let fresh = fresh.into_iter().map(|link| (link, 0));
            for (link, number) in std::mem::take(&mut again).into_iter().chain(fresh) {
                let [a, b] = link.rims.map(|rim| ground.node(rim, side));
                // What lies between two contours is nearer to both: it has been tried already, and had no place.
                if self.is_over() || !sets.may_join(a, b) || !self.prober.is_clear(link.ends) {
                    continue;
                }
                let Try { detour: [part, widths], wider, is_alone, places } = TRIES[number];
                let limit = (1.0 + part) * link.distance_mm + widths * self.prober.width_mm;
                // Where more than two come close, a bridge may have no room to join two only.
                let purpose = if is_alone {
                    Purpose::Join
                } else {
                    Purpose::JoinCrowd(LARGEST_CROWD.min(self.needed - self.done))
                };
                let prober = Prober { width_mm: wider * self.prober.width_mm, ..self.prober };
                let found = self.known.places.entry((link.rims, number));
                let places = Rc::clone(found.or_insert_with(|| prober.between(&link, limit, places).into()));
                let is_laid = self.lay_best(&places, link.distance_mm, purpose, sets);
                if !is_laid && number + 1 < TRIES.len() {
                    again.push((link, number + 1));
                }
            }
            (over, reach) = (reach, 2.0 * reach);
        }
    }

    /// Closes loops where they are shortest.
    fn close(&mut self) {
        let mut reach = FIRST_REACH * self.prober.width_mm;
        let mut failures = 0;
        while !self.is_over() {
            let is_last = reach > self.extent_mm;
            let places = self.prober.loops(reach);
            for worst in [GOOD_GRADE, REQUIRED].into_iter().take(if is_last { 2 } else { 1 }) {
                for place in &places {
                    if self.is_over() || failures > MOST_FAILURES {
                        return;
                    }
                    if self.is_beside(place) {
                        continue;
                    }
                    let verdict = self.verdict(place, Purpose::Loop).filter(|v| v.grade <= worst);
                    if verdict.is_some_and(|verdict| self.lay(place, &verdict, place.length_mm())) {
                        failures = 0;
                    } else {
                        failures += 1;
                    }
                }
            }
            if is_last {
                return;
            }
            reach *= 2.0;
        }
    }

    fn in_mm(&self, path: &[GridPoint]) -> Vec<[f64; 2]> {
        path.iter().map(|&p| self.prober.ground.grid.to_mm(p).to_array()).collect()
    }

    fn is_beside(&self, place: &Place) -> bool {
        let near = BESIDE * self.prober.width_mm;
        self.bridges.iter().any(|laid| {
            let [from, to] = [laid.from_mm, laid.to_mm].map(glam::DVec2::from);
            (0.5 * (from + to)).distance(place.middle()) < near
        })
    }

    /// Lays a bridge at the best of these places; `false` when none will do.
    fn lay_best(&mut self, places: &[Place], least_mm: f64, purpose: Purpose, sets: &mut Joined) -> bool {
        let mut passed: Vec<(f64, &Place, Verdict)> = Vec::new();
        let mut least = f64::INFINITY;
        for place in places {
            // The places come in the order of their scores.
            if place.score >= least {
                break;
            }
            // What it meets costs less to look up than the bridge to try out.
            let Some(changes) = sets.can_join_all(&self.touched(place), purpose.most()) else { continue };
            if let Some(verdict) = self.verdict(place, purpose).filter(|v| v.changes == changes) {
                let fails = if verdict.grade > REQUIRED { REQUIRED_WORTH } else { 0.0 };
                let worth = GRADE_WORTH * verdict.grade as f64 + fails;
                let cost = place.score + worth * self.prober.width_mm;
                least = least.min(cost);
                passed.push((cost, place, verdict));
            }
        }
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let laid = passed.into_iter().find(|(_, place, verdict)| self.lay(place, verdict, least_mm));
        if let Some((_, place, _)) = laid {
            let touched = self.touched(place);
            touched.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
        }
        laid.is_some()
    }

    /// What a bridge at this place meets, each once.
    fn touched(&self, place: &Place) -> Vec<usize> {
        let (ground, side) = (self.prober.ground, self.prober.side);
        let mut nodes: Vec<usize> =
            self.prober.met(&place.corners).into_iter().map(|rim| ground.node(rim, side)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    fn verdict(&mut self, place: &Place, purpose: Purpose) -> Option<Verdict> {
        let asked = self.site.asked(&place.corners, purpose)?;
        let site = &self.site;
        self.known.verdicts.entry(asked).or_insert_with(|| site.try_out(&place.corners, purpose)).clone()
    }

    /// The first bridge after which the whole has not the counts that its window had; that the last is one is known.
    fn first_wrong(&self) -> usize {
        let (mut right, mut wrong) = (0, self.laid.len());
        while wrong - right > 1 {
            let middle = right.midpoint(wrong);
            let (outlines, done) = self.laid[middle - 1];
            let built = self.site.built(outlines);
            let is_right = Counts::of(&built) == self.kind.changed(self.has, done);
            *if is_right { &mut right } else { &mut wrong } = middle;
        }
        right
    }

    /// Lays a bridge; `false` when it is banned.
    fn lay(&mut self, place: &Place, verdict: &Verdict, least_mm: f64) -> bool {
        let corners_mm = place.corners.map(|p| p.to_array());
        if self.banned.contains(&corners_mm) {
            return false;
        }
        let outlines = self.site.lay(&place.corners, &verdict.pockets);
        self.done += verdict.changes;
        self.laid.push((outlines, self.done));
        self.bridges.push(Bridge {
            kind: self.kind,
            changes: verdict.changes,
            from_mm: place.from.to_array(),
            to_mm: place.to.to_array(),
            width_mm: place.width_mm(),
            length_mm: place.length_mm(),
            least_mm,
            area_mm2: verdict.area_mm2,
            corners_mm,
            pockets_mm: verdict.pockets.iter().map(|path| self.in_mm(path)).collect(),
        });
        true
    }
}

/// What is joined already, and what must not be.
struct Joined {
    sets: Sets,
    apart: Option<[usize; 2]>,
}

impl Joined {
    fn new(count: usize, apart: Option<[usize; 2]>) -> Self {
        Self { sets: Sets::new(count), apart }
    }

    fn root(&mut self, node: usize) -> usize {
        self.sets.find(node)
    }

    fn may_join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        let kept = self.apart.map(|[x, y]| [self.root(x), self.root(y)]);
        a != b && kept != Some([a, b]) && kept != Some([b, a])
    }

    /// By how many the count changes when all these are joined: from one to `most`, if none are joined already and
    /// all may be.
    fn can_join_all(&mut self, nodes: &[usize], most: usize) -> Option<usize> {
        let mut roots: Vec<usize> = nodes.iter().map(|&node| self.root(node)).collect();
        roots.sort_unstable();
        roots.dedup();
        let kept = self.apart.map(|pair| pair.map(|node| self.root(node)));
        let may = !kept.is_some_and(|pair| pair.iter().all(|node| roots.contains(node)));
        roots.len().checked_sub(1).filter(|changes| may && (1..=most).contains(changes))
    }

    /// Those of so many nodes that are outside of the largest set.
    fn left_out(&mut self, nodes: usize) -> Vec<usize> {
        let roots: Vec<usize> = (0..nodes).map(|node| self.sets.find(node)).collect();
        let mut sizes = vec![0; roots.len()];
        roots.iter().for_each(|&root| sizes[root] += 1);
        let largest = (0..roots.len()).max_by_key(|&root| sizes[root]);
        (0..roots.len()).filter(|&node| Some(roots[node]) != largest).collect()
    }

    fn join(&mut self, a: usize, b: usize) {
        self.sets.join(a, b);
    }
}
