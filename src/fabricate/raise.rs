//! A solid with bevelled or sloped walls, stacked from horizontal sections.
//!
//! The sections are the region and what is left of it when it goes in from its edges ([`super::inset`]). What
//! lies between two of them in plan is triangulated, each vertex at the height of its section: a slope that is
//! a function of the plan, so that its facets cannot cross, and that shares its vertices with the sections, so
//! that the solid is closed by construction.
//!
//! Where ink is narrower than what goes in from both sides, as at a tip, the smaller section does not reach, and
//! the slope becomes a roof. Edges that run from outline to outline across the ink would leave it flat, at the
//! bottom even without any thickness; they get a vertex in the middle, as high as the slope is there. Half
//! steps of the grid are needed for that, so sections lie on a grid a step coarser than that of 32-bit floats.

use rustc_hash::{FxHashMap, FxHashSet};

use super::FabricateError;
use super::caps;
use super::inset::{self, NotInset};
use super::profile::{Level, Profile};
use super::snap::{YIELD_ROOM, snapped_to};
use super::solid::{self, Solid};
use crate::planar::{EdgeIndex, Grid, GridPoint, Part, Region};

/// The solid over `region` with the walls of `profile`: one shell for each component, with one tunnel for each hole.
/// Corners that become round as walls go in are kept within `chord_mm`.
///
/// Facets come component by component: bottom, top, then walls from the bottom up. With upright walls this is
/// [`super::extrude`].
///
/// # Errors
/// [`FabricateError::Inset`] where ink is too narrow, with what would do; otherwise as for [`super::extrude`].
pub fn raise(region: &Region, profile: &Profile, chord_mm: f64) -> Result<Solid, FabricateError> {
    if profile.is_upright() {
        return solid::extrude(region, profile.thickness_mm());
    }
    let (low, high) = region.bounds_mm().ok_or(FabricateError::Empty)?;
    let extent = low.abs().max(high.abs()).max_element();
    let grid = Grid::exact_in_f32(2.0 * extent * (1.0 + YIELD_ROOM))?;
    let region = snapped_to(region, grid)?;
    let parts: Vec<Region> = region.parts().iter().map(|part| alone(grid, part)).collect();
    let levels = profile.levels();
    let mut solid =
        Solid::with_capacity(levels.len() * region.vertices(), 2 * levels.len() * region.vertices());
    for part in &parts {
        let stacked = Stack::new(part, &levels, chord_mm).map_err(Fault::from);
        let stacked = stacked.and_then(|stack| stack.build(&mut solid));
        stacked.map_err(|fault| match fault {
            Fault::Inset(NotInset { position_mm }) => {
                let inset_mm = levels.iter().map(|level| level.inset_mm).fold(0.0, f64::max);
                let largest_mm = inset::largest(&parts, inset_mm, chord_mm);
                FabricateError::Inset { position_mm, inset_mm, remedy: profile.remedy(largest_mm) }
            }
            Fault::Engine(found) => {
                let position_mm = grid.to_mm(part.parts()[0].exterior().points()[0]);
                FabricateError::Triangulation { position_mm, found }
            }
        })?;
    }
    Ok(solid)
}

/// One component as a region of its own.
fn alone(grid: Grid, part: &Part) -> Region {
    Region::from_contours(grid, part.contours().cloned().collect()).expect("a part of a region is one")
}

/// Why a component has no solid.
enum Fault {
    Inset(NotInset),
    Engine(&'static str),
}

impl From<NotInset> for Fault {
    fn from(fault: NotInset) -> Self {
        Self::Inset(fault)
    }
}

impl From<&'static str> for Fault {
    fn from(found: &'static str) -> Self {
        Self::Engine(found)
    }
}

/// The sections of one component, from the bottom up.
struct Stack<'a> {
    levels: &'a [Level],
    sections: Vec<Region>,
}

/// A section in the solid.
struct Placed<'a> {
    level: Level,
    section: &'a Region,
    /// The number of its first vertex.
    first: u32,
}

impl<'a> Stack<'a> {
    fn new(part: &Region, levels: &'a [Level], chord_mm: f64) -> Result<Self, NotInset> {
        let sections = levels.iter().map(|level| inset::inset(part, level.inset_mm, chord_mm));
        Ok(Self { levels, sections: sections.collect::<Result<_, _>>()? })
    }

    /// Adds the component's shell to `solid`.
    fn build(&self, solid: &mut Solid) -> Result<(), Fault> {
        let placed: Vec<Placed<'_>> = self
            .levels
            .iter()
            .zip(&self.sections)
            .map(|(&level, section)| {
                let points = section.contours().flat_map(|c| c.points()).map(|&p| section.grid().to_mm(p));
                let lifted = points.map(|p| [p.x as f32, p.y as f32, level.z_mm as f32]);
                Placed { level, section, first: solid.add_vertices(lifted) }
            })
            .collect();
        let (bottom, top) = (&placed[0], &placed[placed.len() - 1]);
        let cap = |placed: &Placed<'_>| caps::triangulate(&placed.section.parts()[0]);
        solid.add_triangles(cap(bottom)?.iter().map(|&[a, b, c]| [a, c, b].map(|v| bottom.first + v)));
        solid.add_triangles(cap(top)?.iter().map(|t| t.map(|v| top.first + v)));
        for pair in placed.windows(2) {
            let (below, above) = (&pair[0], &pair[1]);
            if below.section == above.section {
                solid.add_wall(&below.section.parts()[0], below.first, above.first);
            } else if below.level.inset_mm < above.level.inset_mm {
                let facets = slope(below, above, solid)?;
                solid.add_triangles(facets);
            } else {
                let facets = slope(above, below, solid)?;
                solid.add_triangles(facets.into_iter().map(|[a, b, c]| [a, c, b]));
            }
        }
        solid.end_shell();
        Ok(())
    }
}

/// The facets between a section and a smaller one, counter-clockwise in plan, with the vertices that roofs need added to
/// `solid`.
fn slope(outer: &Placed<'_>, inner: &Placed<'_>, solid: &mut Solid) -> Result<Vec<[u32; 3]>, Fault> {
    let grid = outer.section.grid();
    let rings = inset::rings(outer.section, inner.section)?;
    let mut numbers: FxHashMap<GridPoint, u32> = FxHashMap::default();
    for placed in [outer, inner] {
        let points = placed.section.contours().flat_map(|c| c.points()).copied();
        numbers.extend(points.zip(placed.first..));
    }
    let mut outline = FxHashSet::default();
    outline.extend(outer.section.contours().flat_map(|c| c.edges()).map(|(a, b)| (numbers[&a], numbers[&b])));
    let outer_end = outer.first + outer.section.vertices() as u32;
    let crosses_ink = |a: u32, b: u32| {
        let is_outer = |v: u32| (outer.first..outer_end).contains(&v);
        is_outer(a) && is_outer(b) && !outline.contains(&(a, b)) && !outline.contains(&(b, a))
    };
    let edges = EdgeIndex::new(outer.section);
    let mut ridge: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let mut facets = Vec::new();
    for part in rings.parts() {
        let vertices: Vec<GridPoint> = part.contours().flat_map(|c| c.points()).copied().collect();
        for triangle in caps::triangulate(part)? {
            let corners = triangle.map(|v| vertices[v as usize]);
            let mut polygon = Vec::with_capacity(6);
            let mut middles = Vec::new();
            for i in 0..3 {
                let (p, q) = (corners[i], corners[(i + 1) % 3]);
                let (a, b) = (numbers[&p], numbers[&q]);
                polygon.push(a);
                if crosses_ink(a, b) {
                    let middle = *ridge.entry((a.min(b), a.max(b))).or_insert_with(|| {
                        let at = (grid.to_mm(p) + grid.to_mm(q)) * 0.5;
                        let height = edges.nearest(at).map_or(0.0, |edge| edge.nearest(at).distance(at));
                        let z = roof(outer.level, inner.level, height);
                        solid.add_vertices([[at.x as f32, at.y as f32, z]])
                    });
                    middles.push(polygon.len());
                    polygon.push(middle);
                }
            }
            cut_up(&polygon, &middles, &mut facets);
        }
    }
    Ok(facets)
}

/// How high the slope is `inside_mm` from the outline of the larger section: never as low as there.
fn roof(outer: Level, inner: Level, inside_mm: f64) -> f32 {
    let share = (inside_mm / (inner.inset_mm - outer.inset_mm)).min(1.0);
    let z = (outer.z_mm + (inner.z_mm - outer.z_mm) * share) as f32;
    let eaves = outer.z_mm as f32;
    match z == eaves {
        true if inner.z_mm > outer.z_mm => eaves.next_up(),
        true => eaves.next_down(),
        false => z,
    }
}

/// The triangles of a triangle of which `middles` (places in `polygon`) halve some edges. Each has a middle as a corner,
/// and none lies in one edge.
fn cut_up(polygon: &[u32], middles: &[usize], facets: &mut Vec<[u32; 3]>) {
    let n = polygon.len();
    let at = |i: usize| polygon[i % n];
    match *middles {
        [] => facets.push([at(0), at(1), at(2)]),
        [m] => facets.extend([[at(m), at(m + 1), at(m + 2)], [at(m), at(m + 2), at(m + 3)]]),
        [l, m] => {
            // The middles with a corner between them: the second is two places after the first.
            let first = if m == l + 2 { l } else { m };
            facets.push([at(first), at(first + 1), at(first + 2)]);
            facets.push([at(first), at(first + 2), at(first + 3)]);
            facets.push([at(first), at(first + 3), at(first + 4)]);
        }
        _ => {
            facets.extend([1, 3, 5].map(|m| [at(m), at(m + 1), at(m + 2)]));
            facets.push([at(1), at(3), at(5)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::solid::tests::{rectangles, region, shells_and_genus};
    use super::*;

    const CHORD_MM: f64 = 0.01;

    fn plate(thickness_mm: f64) -> Profile {
        Profile::upright(thickness_mm).unwrap()
    }

    fn frustum(low: f64, high: f64, height: f64) -> f64 {
        height / 3.0 * (low + high + (low * high).sqrt())
    }

    #[test]
    fn a_chamfered_square_has_the_volume_of_its_frusta() {
        let square = rectangles(&[(1.0, 1.0, 8.0, 8.0)]);
        let solid = raise(&square, &plate(3.0).chamfered(0.5).unwrap(), CHORD_MM).unwrap();
        assert_eq!(shells_and_genus(&solid), (1, 0));
        let expected = 64.0 * 2.0 + 2.0 * frustum(64.0, 49.0, 0.5);
        assert!((solid.volume_mm3() - expected).abs() < 1e-6, "{}", solid.volume_mm3());
        // Two caps, two slopes and a wall of four sides each.
        assert_eq!((solid.vertices().len(), solid.triangles().len()), (16, 28));
    }

    #[test]
    fn a_tapered_square_is_a_frustum() {
        let square = rectangles(&[(1.0, 1.0, 8.0, 8.0)]);
        let solid = raise(&square, &plate(2.0).tapered(45f64.next_down()).unwrap(), CHORD_MM).unwrap();
        assert_eq!(shells_and_genus(&solid), (1, 0));
        assert!((solid.volume_mm3() - frustum(64.0, 16.0, 2.0)).abs() < 1e-5, "{}", solid.volume_mm3());
    }

    #[test]
    fn upright_walls_are_an_extrusion() {
        let frame = rectangles(&[(0.0, 0.0, 10.0, 10.0), (2.0, 2.0, 4.0, 4.0)]);
        assert_eq!(raise(&frame, &plate(2.0), CHORD_MM), solid::extrude(&frame, 2.0));
    }

    #[test]
    fn a_thin_limb_gets_a_ridge() {
        // A bar 1 mm wide at a block: 1.5 mm from both sides leave nothing of it.
        let limb = rectangles(&[(0.0, 0.0, 10.0, 10.0), (10.0, 4.0, 6.0, 1.0)]);
        let profile = plate(4.0).tapered(20.0).unwrap();
        let solid = raise(&limb, &profile, CHORD_MM).unwrap();
        assert_eq!(shells_and_genus(&solid), (1, 0));
        let ridge = 0.5 / 20f64.to_radians().tan();
        let on_limb = solid.vertices().iter().filter(|p| p[0] > 11.0 && p[0] < 15.9 && p[2] > 0.0);
        let highest = on_limb.map(|p| f64::from(p[2])).fold(0.0, f64::max);
        assert!((highest - ridge).abs() < 1e-3, "{highest} is not {ridge}");
    }

    #[test]
    fn what_is_too_narrow_is_refused_with_what_would_do() {
        let bone = rectangles(&[(0.0, 0.0, 9.0, 9.0), (20.0, 0.0, 9.0, 9.0), (9.0, 4.0, 11.0, 1.0)]);
        let error = raise(&bone, &plate(4.0).chamfered(1.5).unwrap(), CHORD_MM).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("a chamfer of 0.499 mm does"), "{text}");
        assert!(raise(&bone, &plate(4.0).chamfered(0.499).unwrap(), CHORD_MM).is_ok());
        let text = raise(&bone, &plate(4.0).tapered(20.0).unwrap(), CHORD_MM).unwrap_err().to_string();
        assert!(text.contains("a taper of 7.1"), "{text}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn walls_that_go_in_keep_shells_and_genus(
            region in region(), thickness in 0.5..9.0f64, chamfer in 0.02..2.0f64, taper in 0.1..40.0f64,
            which in 0..3,
        ) {
            prop_assume!(!region.is_empty());
            let mut profile = plate(thickness);
            if which != 1 {
                profile = profile.chamfered(chamfer.min(0.4 * thickness)).unwrap();
            }
            if which != 0 {
                profile = profile.tapered(taper).unwrap();
            }
            let solid = match raise(&region, &profile, 0.05) {
                Ok(solid) => solid,
                Err(FabricateError::TooFine { .. } | FabricateError::Inset { .. }) => return Ok(()),
                Err(error) => panic!("{error}"),
            };
            prop_assert_eq!(shells_and_genus(&solid), (region.components(), region.holes()));
            let most = region.area_mm2() * thickness;
            let levels = profile.levels();
            let least = levels.windows(2).map(|pair| {
                let area = |level: &Level| region.offset(-level.inset_mm, 0.05).area_mm2();
                area(&pair[0]).min(area(&pair[1])) * (pair[1].z_mm - pair[0].z_mm)
            });
            let least: f64 = least.sum();
            let slack = 1e-3 * most + 0.5;
            prop_assert!(solid.volume_mm3() < most + slack && solid.volume_mm3() > least - slack);
            prop_assert_eq!(Ok(solid), raise(&region, &profile, 0.05));
        }
    }
}
