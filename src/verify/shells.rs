//! Shells, genus and volume of a triangle soup, and whether it is the boundary of a solid.
//!
//! Corners with the same `f32` coordinates are one vertex; nothing else is welded. Facets that share an edge
//! are one shell. A shell is closed when each of its edges is used exactly twice, in opposite directions;
//! then its genus is 1 − χ/2 with χ = V − E + F. Vertices are counted as fans of facets, so that a point at
//! which two fans meet (a fault) does not upset the genus. Facets that cross each other are looked for by
//! [`super::crossings`].

use std::fmt;

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use schemars::JsonSchema;
use serde::Serialize;

use super::crossings::crossings;
use super::likeness::Facets;
use crate::planar::Sets;

/// Faults that a report prints for people; the list itself is complete.
pub(super) const FAULTS_SHOWN: usize = 10;

/// One facet as the file has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub(super) normal: [f32; 3],
    pub(super) corners: [[f32; 3]; 3],
}

/// What a mesh file (STL, 3MF or OBJ) holds, in millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeshReport {
    /// The number of facets.
    pub triangles: usize,
    /// The number of different corners.
    pub vertices: usize,
    /// The connected surfaces, in the order of their first facets.
    pub shells: Vec<Shell>,
    /// The sum of the genus of all closed shells: the number of tunnels.
    pub genus: i64,
    /// The volume enclosed.
    pub volume_mm3: f64,
    /// The smallest and largest coordinates; `None` without facets.
    pub bounds_mm: Option<([f64; 3], [f64; 3])>,
    /// The unit that the file says it is in; `None` when it says none, or its format has none.
    pub unit: Option<&'static str>,
    /// Why this is not the boundary of a solid; empty when it is.
    pub faults: Vec<MeshFault>,
    /// What facets there are.
    #[serde(skip)]
    pub(super) facets: Facets,
}

/// One connected surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Shell {
    /// The number of facets.
    pub triangles: usize,
    /// The genus; `None` when the shell is not closed.
    pub genus: Option<i64>,
    /// The volume enclosed: positive when the facets face outwards, negative around a cavity.
    pub volume_mm3: f64,
}

/// A place where facets are not the boundary of a solid. Facets count from 0, in the order of the file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeshFault {
    /// What is wrong.
    pub kind: MeshFaultKind,
    /// The facet, or the first one of several.
    pub facet: usize,
    /// Where, in millimetres.
    pub position_mm: [f64; 3],
}

/// The ways in which facets can fail to bound a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshFaultKind {
    /// The facet has no area.
    Degenerate,
    /// The facet has the corners of an earlier one.
    Duplicate,
    /// The facet's normal points against its winding.
    Normal,
    /// Only one facet has this edge.
    OpenEdge,
    /// Two facets run along this edge in the same direction.
    FlippedEdge,
    /// More than two facets share this edge.
    CrowdedEdge,
    /// Surfaces meet in this point only.
    PinchedVertex,
    /// The shell of this facet faces inwards and is no cavity of another.
    InsideOut,
    /// Another facet crosses this one, or touches it elsewhere than in corners that both have.
    Crossing,
}

impl fmt::Display for MeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.kind {
            MeshFaultKind::Degenerate => "has no area",
            MeshFaultKind::Duplicate => "has the corners of an earlier facet",
            MeshFaultKind::Normal => "has a normal against its winding",
            MeshFaultKind::OpenEdge => "has an edge without a second facet",
            MeshFaultKind::FlippedEdge => "runs along an edge in the same direction as another facet",
            MeshFaultKind::CrowdedEdge => "has an edge with more than two facets",
            MeshFaultKind::PinchedVertex => "has a corner in which surfaces meet in one point only",
            MeshFaultKind::InsideOut => "is on a shell that faces inwards",
            MeshFaultKind::Crossing => "crosses or touches another facet",
        };
        let [x, y, z] = self.position_mm;
        write!(f, "facet {} {what} at ({x:.4}, {y:.4}, {z:.4}) mm", self.facet)
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "triangles    {}", self.triangles)?;
        writeln!(f, "shells       {}", self.shells.len())?;
        writeln!(f, "genus        {}", self.genus)?;
        writeln!(f, "volume       {:.3} mm3", self.volume_mm3)?;
        write!(f, "faults       {}", self.faults.len())?;
        self.faults.iter().take(FAULTS_SHOWN).try_for_each(|fault| write!(f, "\n  {fault}"))
    }
}

/// Counts shells and genus, and looks for faults.
pub(super) fn survey(facets: &[Facet]) -> MeshReport {
    let soup = Soup::weld(facets);
    let mut faults = soup.facet_faults(facets);
    let mut shells = Sets::new(facets.len());
    let mut fans = Sets::new(3 * facets.len());
    let sides = sides(&soup.facets);
    // The facet that stands for each edge, with whether the edge is sound.
    let mut edges: Vec<(usize, bool)> = Vec::with_capacity(sides.len() / 2);
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        let fault = match edge {
            [a, b] if a.forward != b.forward => None,
            [_] => Some(MeshFaultKind::OpenEdge),
            [_, _] => Some(MeshFaultKind::FlippedEdge),
            _ => Some(MeshFaultKind::CrowdedEdge),
        };
        for pair in edge.windows(2) {
            shells.join(pair[0].facet, pair[1].facet);
            for end in edge[0].ends {
                fans.join(soup.corner(pair[0].facet, end), soup.corner(pair[1].facet, end));
            }
        }
        edges.push((edge[0].facet, fault.is_none()));
        faults.extend(fault.map(|kind| {
            let [p, q] = edge[0].ends.map(|v| soup.at[v]);
            MeshFault { kind, facet: edge[0].facet, position_mm: ((p + q) * 0.5).to_array() }
        }));
    }
    faults.extend(soup.pinched(&mut fans));
    let (shells, inside_out) = soup.shells(&mut shells, &mut fans, &edges);
    faults.extend(inside_out);
    faults.extend(crossings(&soup.at, &soup.facets, &sides).into_iter().map(|(facet, position)| MeshFault {
        kind: MeshFaultKind::Crossing,
        facet,
        position_mm: position.to_array(),
    }));
    let corner = |pick: fn(DVec3, DVec3) -> DVec3| soup.at.iter().copied().reduce(pick);
    MeshReport {
        triangles: facets.len(),
        vertices: soup.at.len(),
        genus: shells.iter().filter_map(|s| s.genus).sum(),
        volume_mm3: shells.iter().map(|s| s.volume_mm3).sum(),
        bounds_mm: corner(DVec3::min).zip(corner(DVec3::max)).map(|(a, b)| (a.to_array(), b.to_array())),
        unit: None,
        shells,
        faults,
        facets: Facets::of(facets.iter().map(|facet| facet.corners)),
    }
}

/// Facets with their corners welded.
struct Soup {
    at: Vec<DVec3>,
    facets: Vec<[usize; 3]>,
}

/// One use of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The lower vertex, then the higher.
    pub(super) ends: [usize; 2],
    pub(super) facet: usize,
    /// Whether the facet runs from the lower vertex to the higher.
    pub(super) forward: bool,
}

/// Every side of every facet that does not begin where it ends, by edge.
pub(super) fn sides(facets: &[[usize; 3]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * facets.len());
    for (facet, &[a, b, c]) in facets.iter().enumerate() {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if p != q {
                sides.push(Side { ends: [p.min(q), p.max(q)], facet, forward: p < q });
            }
        }
    }
    sides.sort_unstable();
    sides
}

impl Soup {
    fn weld(facets: &[Facet]) -> Self {
        let mut known: FxHashMap<[u32; 3], usize> = FxHashMap::default();
        let mut at = Vec::new();
        let welded = facets.iter().map(|facet| {
            facet.corners.map(|p| {
                // Adding zero makes one number of both zeros.
                *known.entry(p.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                    at.push(DVec3::from_array(p.map(f64::from)));
                    at.len() - 1
                })
            })
        });
        let facets = welded.collect();
        Self { at, facets }
    }

    fn corner(&self, facet: usize, vertex: usize) -> usize {
        3 * facet + self.facets[facet].iter().position(|&v| v == vertex).expect("an edge ends in corners")
    }

    fn points(&self, facet: usize) -> [DVec3; 3] {
        self.facets[facet].map(|v| self.at[v])
    }

    fn facet_faults(&self, given: &[Facet]) -> Vec<MeshFault> {
        let mut faults = Vec::new();
        let mut seen: FxHashSet<[usize; 3]> = FxHashSet::default();
        for (facet, &corners) in self.facets.iter().enumerate() {
            let [a, b, c] = self.points(facet);
            let position_mm = ((a + b + c) / 3.0).to_array();
            let mut add = |kind| faults.push(MeshFault { kind, facet, position_mm });
            let normal = (b - a).cross(c - a);
            if normal == DVec3::ZERO {
                add(MeshFaultKind::Degenerate);
            } else if normal.dot(DVec3::from_array(given[facet].normal.map(f64::from))) < 0.0 {
                add(MeshFaultKind::Normal);
            }
            let mut sorted = corners;
            sorted.sort_unstable();
            if !seen.insert(sorted) {
                add(MeshFaultKind::Duplicate);
            }
        }
        faults
    }

    /// The vertices with more than one fan of facets.
    fn pinched(&self, fans: &mut Sets) -> Vec<MeshFault> {
        let mut fan_of = vec![usize::MAX; self.at.len()];
        let mut reported = vec![false; self.at.len()];
        let mut faults = Vec::new();
        for (facet, corners) in self.facets.iter().enumerate() {
            for (i, &v) in corners.iter().enumerate() {
                let fan = fans.find(3 * facet + i);
                if fan_of[v] == usize::MAX {
                    fan_of[v] = fan;
                } else if fan_of[v] != fan && !std::mem::replace(&mut reported[v], true) {
                    let position_mm = self.at[v].to_array();
                    faults.push(MeshFault { kind: MeshFaultKind::PinchedVertex, facet, position_mm });
                }
            }
        }
        faults
    }

    /// The shells, and those that face inwards without being cavities.
    fn shells(
        &self,
        sets: &mut Sets,
        fans: &mut Sets,
        edges: &[(usize, bool)],
    ) -> (Vec<Shell>, Vec<MeshFault>) {
        let mut number = vec![usize::MAX; self.facets.len()];
        let mut tallies: Vec<Tally> = Vec::new();
        // Volumes are taken from a point of the solid, as far-off coordinates would cancel badly.
        let origin = self.at.first().copied().unwrap_or_default();
        for facet in 0..self.facets.len() {
            let root = sets.find(facet);
            if number[root] == usize::MAX {
                number[root] = tallies.len();
                tallies.push(Tally::new(facet));
            }
            let tally = &mut tallies[number[root]];
            let [a, b, c] = self.points(facet).map(|p| p - origin);
            tally.facets += 1;
            tally.volume += a.dot(b.cross(c)) / 6.0;
            for p in [a, b, c] {
                (tally.low, tally.high) = (tally.low.min(p), tally.high.max(p));
            }
            tally.vertices += (0..3).filter(|i| fans.find(3 * facet + i) == 3 * facet + i).count() as i64;
        }
        for &(facet, sound) in edges {
            let tally = &mut tallies[number[sets.find(facet)]];
            tally.edges += 1;
            tally.closed &= sound;
        }
        let mut faults = Vec::new();
        for tally in tallies.iter().filter(|t| t.volume < 0.0) {
            let around =
                |t: &&Tally| t.volume > 0.0 && t.low.cmplt(tally.low).all() && t.high.cmpgt(tally.high).all();
            if tallies.iter().find(around).is_none() {
                let position_mm = self.points(tally.first)[0].to_array();
                faults.push(MeshFault { kind: MeshFaultKind::InsideOut, facet: tally.first, position_mm });
            }
        }
        (tallies.iter().map(Tally::shell).collect(), faults)
    }
}

/// What is counted of one shell.
struct Tally {
    first: usize,
    facets: usize,
    vertices: i64,
    edges: i64,
    closed: bool,
    volume: f64,
    low: DVec3,
    high: DVec3,
}

impl Tally {
    fn new(first: usize) -> Self {
        let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        Self { first, facets: 0, vertices: 0, edges: 0, closed: true, volume: 0.0, low, high }
    }

    fn shell(&self) -> Shell {
        let euler = self.vertices - self.edges + self.facets as i64;
        let genus = self.closed.then_some(1 - euler / 2);
        Shell { triangles: self.facets, genus, volume_mm3: self.volume }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Quad = [[i32; 3]; 4];

    /// The boundary of unit cubes at `cells`, two facets to a square.
    fn cubes(cells: &[[i32; 3]]) -> Vec<Facet> {
        let mut facets = Vec::new();
        for &cell in cells {
            for axis in 0..3 {
                for up in [false, true] {
                    let mut beyond = cell;
                    beyond[axis] += if up { 1 } else { -1 };
                    if !cells.contains(&beyond) {
                        facets.extend(square(cell, axis, up));
                    }
                }
            }
        }
        facets
    }

    fn square(cell: [i32; 3], axis: usize, up: bool) -> [Facet; 2] {
        let corner = |a: i32, b: i32| {
            let mut p = cell;
            p[axis] += i32::from(up);
            p[(axis + 1) % 3] += a;
            p[(axis + 2) % 3] += b;
            p
        };
        let mut quad: Quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        if !up {
            quad.reverse();
        }
        let facet = |i: usize, j: usize, k: usize| {
            let corners = [i, j, k].map(|n| quad[n].map(|x| x as f32));
            Facet { normal: [0.0; 3], corners }
        };
        [facet(0, 1, 2), facet(0, 2, 3)]
    }

    fn kinds(report: &MeshReport) -> Vec<MeshFaultKind> {
        let mut kinds: Vec<_> = report.faults.iter().map(|f| f.kind).collect();
        kinds.dedup();
        kinds
    }

    fn ring() -> Vec<[i32; 3]> {
        let all = (0..3).flat_map(|x| (0..3).map(move |y| [x, y, 0]));
        all.filter(|&cell| cell != [1, 1, 0]).collect()
    }

    #[test]
    fn a_ring_has_a_tunnel() {
        let report = survey(&cubes(&ring()));
        assert_eq!((report.shells.len(), report.genus, report.volume_mm3), (1, 1, 8.0));
        assert_eq!(report.faults, []);
        assert_eq!(report.bounds_mm, Some(([0.0; 3], [3.0, 3.0, 1.0])));
    }

    #[test]
    fn shells_are_counted_one_by_one() {
        let mut cells = ring();
        cells.extend([[5, 0, 0], [9, 0, 0], [9, 1, 0]]);
        let report = survey(&cubes(&cells));
        let shells: Vec<_> = report.shells.iter().map(|s| (s.genus, s.volume_mm3.round())).collect();
        assert_eq!(shells, [(Some(1), 8.0), (Some(0), 1.0), (Some(0), 2.0)]);
        assert_eq!(report.faults, []);
    }

    #[test]
    fn a_cavity_is_no_fault_but_an_inverted_solid_is() {
        let all = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
        let hollow: Vec<_> = all.filter(|&cell| cell != [1, 1, 1]).collect();
        let report = survey(&cubes(&hollow));
        let mut volumes: Vec<_> = report.shells.iter().map(|s| s.volume_mm3.round()).collect();
        volumes.sort_by(f64::total_cmp);
        assert_eq!((volumes, kinds(&report)), (vec![-1.0, 27.0], vec![]));
        let mut inverted = cubes(&ring());
        inverted.iter_mut().for_each(|f| f.corners.swap(0, 1));
        assert_eq!(kinds(&survey(&inverted)), [MeshFaultKind::InsideOut]);
    }

    #[test]
    fn an_edge_of_four_facets_is_a_fault() {
        let report = survey(&cubes(&[[0, 0, 0], [1, 1, 0]]));
        assert_eq!(kinds(&report), [MeshFaultKind::CrowdedEdge]);
        assert_eq!(report.faults[0].position_mm, [1.0, 1.0, 0.5]);
        assert!(report.shells.iter().all(|s| s.genus.is_none()));
    }

    #[test]
    fn a_pinched_vertex_is_a_fault_and_leaves_the_counts() {
        let report = survey(&cubes(&[[0, 0, 0], [1, 1, 1]]));
        assert_eq!(kinds(&report), [MeshFaultKind::PinchedVertex]);
        assert_eq!(report.faults[0].position_mm, [1.0; 3]);
        assert_eq!((report.shells.len(), report.genus, report.vertices), (2, 0, 15));
    }

    #[test]
    fn facet_faults_name_the_facet() {
        let mut facets = cubes(&[[0, 0, 0]]);
        let last = facets.pop().unwrap();
        let open = survey(&facets);
        assert_eq!((kinds(&open), open.shells[0].genus), (vec![MeshFaultKind::OpenEdge], None));
        facets.push(Facet { corners: [last.corners[1], last.corners[0], last.corners[2]], ..last });
        assert_eq!(kinds(&survey(&facets)), [MeshFaultKind::FlippedEdge]);
        facets[11] = last;
        facets[3].normal = {
            let [a, b, c] = facets[3].corners.map(|p| DVec3::from_array(p.map(f64::from)));
            let n = (b - a).cross(c - a);
            [-n.x as f32, -n.y as f32, -n.z as f32]
        };
        let turned = survey(&facets);
        assert_eq!((kinds(&turned), turned.faults[0].facet), (vec![MeshFaultKind::Normal], 3));
        facets.push(last);
        assert!(kinds(&survey(&facets)).contains(&MeshFaultKind::Duplicate));
        facets.push(Facet { corners: [[0.0; 3], [0.5; 3], [1.0; 3]], ..last });
        assert!(survey(&facets).faults.iter().any(|f| f.kind == MeshFaultKind::Degenerate && f.facet == 13));
    }
}
