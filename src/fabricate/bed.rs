//! Whether a part fits the bed of a printer, and how it must be turned.
//!
//! Only the convex hull counts. While it turns, its width is the distance of two of its corners along x, and
//! these change only at angles at which an edge stands upright; the same holds for the depth. Between two such
//! angles both are cosines, so the angles at which they just fit are known in closed form (rotating calipers):
//! what fits at all is found, not sampled.

use std::f64::consts::PI;

use glam::DVec2;

use super::FabricateError;
use crate::planar::{Grid, GridError, GridPoint, Region, orient};

/// What is taken as fitting, as a part of the bed: the size of rounding errors, so that what fits exactly does.
const ROUNDING: f64 = 1e-9;

/// The room of a printer, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bed {
    /// Along x.
    pub width_mm: f64,
    /// Along y.
    pub depth_mm: f64,
    /// Along z; `None` is as high as need be.
    pub height_mm: Option<f64>,
}

impl Bed {
    /// The angle in degrees, counter-clockwise and from −90 to 90, by which `region` must be turned to fit: 0 when it
    /// fits as it is, otherwise where the most room is left.
    ///
    /// # Errors
    /// [`FabricateError::TooHigh`], and [`FabricateError::Bed`] with the sizes when it fits at no angle.
    pub fn turn_for(&self, region: &Region, thickness_mm: f64) -> Result<f64, FabricateError> {
        let hull = hull(region);
        let as_it_is = size(&hull, 0.0);
        if self.height_mm.is_some_and(|height| thickness_mm > height) {
            return Err(FabricateError::TooHigh { height_mm: thickness_mm, bed: *self });
        }
        if self.room(as_it_is) >= 0.0 {
            return Ok(0.0);
        }
        let best = self.roomiest(&hull);
        if self.room(size(&hull, best)) < 0.0 {
            return Err(FabricateError::Bed {
                part_mm: [as_it_is.x, as_it_is.y, thickness_mm],
                turn_deg: best.to_degrees(),
                turned_mm: size(&hull, best).to_array(),
                bed: *self,
            });
        }
        // A round number if that fits as well.
        let rounded = (best.to_degrees() * 10.0).round() / 10.0;
        let fits = self.room(size(&hull, rounded.to_radians())) >= 0.0;
        Ok(if fits { rounded } else { best.to_degrees() })
    }

    /// `region` turned by `turn_deg` and moved to the middle of the bed.
    ///
    /// # Errors
    /// [`GridError`] when the bed is out of range.
    pub fn place(&self, region: &Region, turn_deg: f64) -> Result<Region, GridError> {
        let turn = DVec2::from_angle(turn_deg.to_radians());
        let hull: Vec<DVec2> = hull(region).into_iter().map(|p| turn.rotate(p)).collect();
        let low = hull.iter().copied().reduce(DVec2::min).unwrap_or_default();
        let high = hull.iter().copied().reduce(DVec2::max).unwrap_or_default();
        let by = (DVec2::new(self.width_mm, self.depth_mm) - low - high) * 0.5;
        let grid = Grid::for_extent(self.width_mm.max(self.depth_mm))?;
        region.placed(grid, |p| turn.rotate(p) + by)
    }

    /// The least distance to the sides that a part of `size` leaves; negative when it does not fit.
    fn room(&self, size: DVec2) -> f64 {
        let bed = DVec2::new(self.width_mm, self.depth_mm);
        let room = (bed - size).min_element();
        if room >= -ROUNDING * bed.max_element() { room.max(0.0) } else { room }
    }

    /// The angle in radians, from −π/2 to π/2, that leaves the most room among all where something changes.
    fn roomiest(&self, hull: &[DVec2]) -> f64 {
        // A part turned by half a turn is as wide and as deep.
        let half = |angle: f64| angle - PI * (angle / PI).round();
        let edges = hull.iter().zip(hull.iter().cycle().skip(1));
        // An edge stands upright, or lies level.
        let changes = edges.map(|(a, b)| -(b - a).to_angle()).flat_map(|angle| [angle, angle + 0.5 * PI]);
        let mut changes: Vec<f64> = changes.map(half).chain([-0.5 * PI, 0.5 * PI]).collect();
        changes.sort_by(f64::total_cmp);
        changes.dedup();
        let mut candidates = vec![0.0];
        for pair in changes.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let [wide, deep] = calipers(hull, 0.5 * (from + to));
            let mut within = vec![from, to];
            for (across, side) in [(wide, self.width_mm), (deep, self.depth_mm)] {
                // across.length() * cos(angle + direction) is the size.
                let reach = (side / across.length()).min(1.0).acos();
                let roots = [reach, -reach].map(|r| half(r - across.to_angle()));
                within.extend(roots.into_iter().filter(|root| (from..to).contains(root)));
            }
            within.sort_by(f64::total_cmp);
            let middles: Vec<f64> = within.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
            candidates.extend(within.into_iter().chain(middles));
        }
        let room = |angle: &f64| self.room(size(hull, *angle));
        let better = |a: &f64, b: &f64| room(a).total_cmp(&room(b)).then(b.abs().total_cmp(&a.abs()));
        candidates.into_iter().max_by(better).expect("there is one angle at least")
    }
}

/// The corners of the convex hull, counter-clockwise, in millimetres.
fn hull(region: &Region) -> Vec<DVec2> {
    let mut points: Vec<GridPoint> =
        region.parts().iter().flat_map(|part| part.exterior().points()).copied().collect();
    points.sort_unstable();
    let mut chain: Vec<GridPoint> = Vec::new();
    for backwards in [false, true] {
        let start = chain.len();
        let mut add = |p: GridPoint| {
            while chain.len() >= start + 2
                && orient(chain[chain.len() - 2], chain[chain.len() - 1], p).is_le()
            {
                chain.pop();
            }
            chain.push(p);
        };
        match backwards {
            false => points.iter().for_each(|&p| add(p)),
            true => points.iter().rev().for_each(|&p| add(p)),
        }
        // The next chain begins with it.
        chain.pop();
    }
    chain.into_iter().map(|p| region.grid().to_mm(p)).collect()
}

/// Width and depth of the hull turned by `angle`.
fn size(hull: &[DVec2], angle: f64) -> DVec2 {
    let turn = DVec2::from_angle(angle);
    let turned = || hull.iter().map(|&p| turn.rotate(p));
    let extreme = |pick: fn(DVec2, DVec2) -> DVec2| turned().reduce(pick).unwrap_or_default();
    extreme(DVec2::max) - extreme(DVec2::min)
}

/// The lines between the corners that are outermost when the hull is turned by `angle`: across its width, as a vector
/// of which x is the width after turning, and across its depth, a quarter turn back so that x is the depth.
fn calipers(hull: &[DVec2], angle: f64) -> [DVec2; 2] {
    [0.0, -0.5 * PI].map(|back| {
        let turn = DVec2::from_angle(angle + back);
        let x = |p: &&DVec2| turn.rotate(**p).x;
        let by_x = |a: &&DVec2, b: &&DVec2| x(a).total_cmp(&x(b));
        let ends = hull.iter().max_by(by_x).zip(hull.iter().min_by(by_x));
        let across = ends.map(|(right, left)| *right - *left).unwrap_or_default();
        DVec2::from_angle(back).rotate(across)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::solid::tests::{rectangles, region};
    use super::*;

    fn bed(width_mm: f64, depth_mm: f64) -> Bed {
        Bed { width_mm, depth_mm, height_mm: None }
    }

    #[test]
    fn what_fits_is_not_turned() {
        let plate = rectangles(&[(10.0, 10.0, 60.0, 20.0)]);
        assert_eq!(bed(60.0, 20.0).turn_for(&plate, 2.0), Ok(0.0));
        assert_eq!(bed(20.0, 60.0).turn_for(&plate, 2.0).map(f64::abs), Ok(90.0));
    }

    #[test]
    fn a_long_strip_goes_along_the_diagonal() {
        let strip = rectangles(&[(0.0, 0.0, 120.0, 4.0)]);
        let turn = bed(100.0, 100.0).turn_for(&strip, 2.0).unwrap();
        assert_eq!(turn.abs(), 45.0);
        let placed = bed(100.0, 100.0).place(&strip, turn).unwrap();
        let (low, high) = placed.bounds_mm().unwrap();
        assert!(low.cmpge(DVec2::ZERO).all() && high.cmple(DVec2::splat(100.0)).all(), "{low} {high}");
        assert!((low + high - 100.0).length() < 1e-6);
        assert!((placed.area_mm2() - 480.0).abs() < 1e-3);
    }

    #[test]
    fn what_just_fits_at_one_angle_is_found() {
        // (120 + 4) / √2 on both sides, and not a hair less.
        let strip = rectangles(&[(0.0, 0.0, 120.0, 4.0)]);
        let side = 124.0 / 2f64.sqrt();
        assert!((bed(side + 1e-6, side + 1e-6).turn_for(&strip, 2.0).unwrap().abs() - 45.0).abs() < 0.01);
        assert!(bed(side - 1e-3, side - 1e-3).turn_for(&strip, 2.0).is_err());
    }

    #[test]
    fn a_bed_too_small_names_the_sizes() {
        let strip = rectangles(&[(0.0, 0.0, 150.0, 4.0)]);
        let text = bed(100.0, 100.0).turn_for(&strip, 2.0).unwrap_err().to_string();
        assert!(text.contains("150.00 x 4.00 x 2.00 mm") && text.contains("100 x 100 mm"), "{text}");
        let low = Bed { height_mm: Some(1.5), ..bed(300.0, 300.0) };
        let text = low.turn_for(&strip, 2.0).unwrap_err().to_string();
        assert!(text.contains("is 2.00 mm high") && text.contains("300 x 300 x 1.5 mm"), "{text}");
        assert!(text.contains("room for 1.5 mm") && !text.contains("turned"), "{text}");
    }

    proptest! {
        #[test]
        fn an_angle_is_found_wherever_sampling_finds_one(
            region in region(), width in 20.0..120.0f64, depth in 20.0..120.0f64,
        ) {
            prop_assume!(!region.is_empty());
            let hull = hull(&region);
            let bed = bed(width, depth);
            let sampled = (-900..=900).map(|i| f64::from(i) / 10.0).any(|turn| {
                bed.room(size(&hull, turn.to_radians())) > 0.0
            });
            match bed.turn_for(&region, 2.0) {
                Ok(turn) => prop_assert!(bed.room(size(&hull, turn.to_radians())) >= 0.0, "{}", turn),
                Err(error) => prop_assert!(!sampled, "{}", error),
            }
        }
    }
}
