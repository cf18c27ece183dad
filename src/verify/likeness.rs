//! Whether a file has the very shape that it was made from.
//!
//! Counts know nothing of size and place: a file that is scaled, mirrored or moved has the counts of the plan, and cuts
//! scrap. So what was read is laid over the plan. Cut lines are curves that were fitted within a chord error. What lies
//! between a contour and its curve is then nowhere thicker than the chord error, and vanishes when half of that is taken
//! off all around: any point of it is on the way from a point of the contour to one of the curve. Meshes hold the numbers of
//! the plan, every bit of them, in whatever order facets are written. Excluded: what was asked for ([`super::Expected`]).

use std::fmt;
use std::hash::{Hash, Hasher};

use glam::{DVec2, DVec3};
use rustc_hash::FxHasher;
use thiserror::Error;

use super::cutlines::CutReport;
use super::shells::MeshReport;
use crate::planar::{FillRule, GridError, GridPoint, Region};

/// Chords of round joins, as a part of what is taken off.
const ARC_PART: f64 = 0.01;
/// Half a chord error is taken off, and this part of it more, for the round joins and for what files are rounded to.
const MORE: f64 = 0.05;

/// How a file differs from the plan that it was made from.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Unlike {
    /// It reaches elsewhere.
    #[error("it reaches from {found}, and {wanted} is planned")]
    Box {
        /// In the file.
        found: Extent,
        /// In the plan.
        wanted: Extent,
    },
    /// Another area.
    #[error("it has {found_mm2:.4} mm2, and {wanted_mm2:.4} mm2 are planned")]
    Area {
        /// In the file, in square millimetres.
        found_mm2: f64,
        /// In the plan.
        wanted_mm2: f64,
    },
    /// Another volume.
    #[error("it has {found_mm3:.4} mm3, and {wanted_mm3:.4} mm3 are planned")]
    Volume {
        /// In the file, in cubic millimetres.
        found_mm3: f64,
        /// In the plan.
        wanted_mm3: f64,
    },
    /// A contour runs elsewhere.
    #[error(
        "at ({:.3}, {:.3}) mm a contour is more than {allowed_mm} mm from where it is planned",
        position_mm.x, position_mm.y
    )]
    Contour {
        /// Where, in millimetres.
        position_mm: DVec2,
        /// How far it may be.
        allowed_mm: f64,
    },
    /// A solid of the same size with other facets, as a mirrored one has.
    #[error("it has other facets than are planned")]
    Facets,
    /// The plan does not fit the grid of the file.
    #[error("it cannot be laid over the plan: {0}")]
    Grid(#[from] GridError),
}

/// The box around a shape: its lower and its upper corner in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent([Vec<f64>; 2]);

impl Extent {
    fn flat((low, high): (DVec2, DVec2)) -> Self {
        Self([low.to_array().to_vec(), high.to_array().to_vec()])
    }

    fn solid((low, high): ([f64; 3], [f64; 3])) -> Self {
        Self([low.to_vec(), high.to_vec()])
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let corner = |of: &Vec<f64>| of.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(", ");
        write!(f, "({}) to ({}) mm", corner(&self.0[0]), corner(&self.0[1]))
    }
}

impl CutReport {
    /// Whether the material is that of `plan`, where lines may be `within_mm` off.
    ///
    /// # Errors
    /// [`Unlike`] says what is not.
    pub fn is_like(&self, plan: &Region, within_mm: f64) -> Result<(), Unlike> {
        let grid = self.region.grid();
        let plan = plan.placed(grid, |p| p)?;
        let [found, wanted] = [&self.region, &plan].map(|of| of.bounds_mm().unwrap_or_default());
        let apart = (found.0 - wanted.0).abs().max((found.1 - wanted.1).abs()).max_element();
        if apart > within_mm {
            return Err(Unlike::Box { found: Extent::flat(found), wanted: Extent::flat(wanted) });
        }
        let length = |(a, b): (GridPoint, GridPoint)| grid.to_mm(a).distance(grid.to_mm(b));
        let outline_mm: f64 = plan.contours().flat_map(|contour| contour.edges()).map(length).sum();
        let (found_mm2, wanted_mm2) = (self.region.area_mm2(), plan.area_mm2());
        if (found_mm2 - wanted_mm2).abs() > within_mm * outline_mm {
            return Err(Unlike::Area { found_mm2, wanted_mm2 });
        }
        let paths = [&self.region, &plan].into_iter().flat_map(Region::contours);
        let paths: Vec<Vec<GridPoint>> = paths.map(|contour| contour.points().to_vec()).collect();
        let between = Region::fill(grid, &paths, FillRule::EvenOdd);
        let radius_mm = 0.5 * within_mm * (1.0 + MORE);
        match between.offset(-radius_mm, ARC_PART * radius_mm).contours().next() {
            None => Ok(()),
            Some(off) => {
                let position_mm = grid.to_mm(off.points()[0]);
                Err(Unlike::Contour { position_mm, allowed_mm: within_mm })
            }
        }
    }
}

impl MeshReport {
    /// Whether the facets are those of `plan`, in any order.
    ///
    /// # Errors
    /// [`Unlike`] says what is not.
    pub fn is_like(&self, plan: impl Iterator<Item = [[f32; 3]; 3]> + Clone) -> Result<(), Unlike> {
        if self.facets == Facets::of(plan.clone()) {
            return Ok(());
        }
        let at = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
        let corners = || plan.clone().flatten().map(at);
        let bounds = corners().reduce(DVec3::min).zip(corners().reduce(DVec3::max));
        let wanted = bounds.map(|(low, high)| (low.to_array(), high.to_array()));
        if self.bounds_mm != wanted {
            let extent = |bounds: Option<_>| Extent::solid(bounds.unwrap_or_default());
            return Err(Unlike::Box { found: extent(self.bounds_mm), wanted: extent(wanted) });
        }
        // From a corner, as far-off coordinates would cancel badly.
        let origin = corners().next().unwrap_or_default();
        let six_volumes = |corners: [[f32; 3]; 3]| {
            let [a, b, c] = corners.map(|p| at(p) - origin);
            a.dot(b.cross(c))
        };
        let wanted_mm3 = plan.clone().map(six_volumes).sum::<f64>() / 6.0;
        match (self.volume_mm3 - wanted_mm3).abs() <= 1e-9 * wanted_mm3.abs() {
            true => Err(Unlike::Facets),
            false => Err(Unlike::Volume { found_mm3: self.volume_mm3, wanted_mm3 }),
        }
    }
}

/// What facets are there, whatever their order and whichever corner they begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Facets {
    count: usize,
    /// The sum of a hash of each.
    sum: u64,
}

impl Facets {
    pub(super) fn of(facets: impl Iterator<Item = [[f32; 3]; 3]>) -> Self {
        facets.fold(Self::default(), |all, corners| {
            // Adding zero makes one number of both zeros.
            let [a, b, c] = corners.map(|p| p.map(|x| (x + 0.0).to_bits()));
            let first = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
            let mut hasher = FxHasher::default();
            first.hash(&mut hasher);
            Self { count: all.count + 1, sum: all.sum.wrapping_add(hasher.finish()) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read_cut_svg, read_stl};
    use super::*;
    use crate::planar::{Grid, boxes};

    /// An L with long and short legs, as cut lines that went through `place`.
    fn cut(place: impl Fn(DVec2) -> DVec2) -> CutReport {
        let corners = [(10.0, 10.0), (40.0, 10.0), (40.0, 14.0), (14.0, 14.0), (14.0, 30.0), (10.0, 30.0)];
        let points = corners.map(|p| place(DVec2::from(p))).map(|p| format!("{},{}", p.x, 50.0 - p.y));
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="50mm" viewBox="0 0 60 50"><g id="CUT" fill="none" stroke="red"><path d="M{}Z"/></g></svg>"#,
            points.join("L")
        );
        read_cut_svg(svg.as_bytes(), 1e-3).unwrap()
    }

    fn plan() -> Region {
        let step = Grid::for_extent(100.0).unwrap().steps(1.0);
        boxes(step, FillRule::NonZero, &[(10, 10, 30, 4), (10, 10, 4, 20)])
    }

    #[test]
    fn cut_lines_within_the_chord_are_the_plan() {
        assert_eq!(cut(|p| p).is_like(&plan(), 0.01), Ok(()));
        assert_eq!(cut(|p| p + 0.005).is_like(&plan(), 0.01), Ok(()));
    }

    #[test]
    fn cut_lines_that_are_scaled_mirrored_or_moved_are_not() {
        let unlike = |place: fn(DVec2) -> DVec2| cut(place).is_like(&plan(), 0.01).unwrap_err();
        let scaled = unlike(|p| p * 1.001);
        assert!(matches!(scaled, Unlike::Box { .. }), "{scaled}");
        assert_eq!(
            scaled.to_string(),
            "it reaches from (10.0100, 10.0100) to (40.0400, 30.0300) mm, and (10.0000, 10.0000) to (40.0000, 30.0000) mm is planned"
        );
        assert!(matches!(unlike(|p| p + DVec2::new(0.0, 0.02)), Unlike::Box { .. }));
        // Within its own box, with the same area.
        let mirrored = unlike(|p| DVec2::new(50.0 - p.x, p.y));
        assert!(matches!(mirrored, Unlike::Contour { .. }), "{mirrored}");
        // A leg that is too wide, within the box.
        let wide = unlike(|p| if p == DVec2::splat(14.0) { DVec2::new(20.0, 20.0) } else { p });
        assert!(matches!(wide, Unlike::Area { .. }), "{wide}");
    }

    const TETRAHEDRON: [[[f32; 3]; 3]; 4] = {
        let (o, x, y, z) = ([0., 0., 0.], [3., 0., 0.], [0., 3., 0.], [0., 0., 2.]);
        [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
    };

    /// What is read of the tetrahedron after `place`, its facets turned inside out if that mirrors.
    fn solid(is_mirrored: bool, place: impl Fn([f32; 3]) -> [f32; 3]) -> MeshReport {
        let facet = |&[a, b, c]: &[[f32; 3]; 3]| {
            let corners = if is_mirrored { [a, c, b] } else { [b, c, a] };
            let corners = corners.map(&place).map(|[x, y, z]| format!("vertex {x} {y} {z}\n"));
            format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
        };
        let text: String = TETRAHEDRON.iter().rev().map(facet).collect();
        let report = read_stl(format!("solid t\n{text}endsolid t\n").as_bytes()).unwrap();
        assert_eq!(report.faults, []);
        report
    }

    #[test]
    fn solids_that_are_scaled_mirrored_or_moved_are_not_the_plan() {
        let like = |report: MeshReport| report.is_like(TETRAHEDRON.into_iter());
        assert_eq!(like(solid(false, |p| p)), Ok(()), "the order of facets and corners is free");
        let found = like(solid(false, |p| p.map(|x| 1.0001 * x)));
        assert!(matches!(found, Err(Unlike::Box { .. })), "{found:?}");
        assert!(matches!(like(solid(false, |[x, y, z]| [x + 0.01, y, z])), Err(Unlike::Box { .. })));
        // Within the same box, with the same volume.
        assert_eq!(like(solid(true, |[x, y, z]| [3.0 - x, y, z])), Err(Unlike::Facets));
        // The apex elsewhere over the same base keeps box and volume; lower is another box.
        assert!(matches!(like(solid(false, |[x, y, z]| [x, y, 0.5 * z])), Err(Unlike::Box { .. })));
    }
}
