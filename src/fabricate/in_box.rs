//! Minimum feature and gap enforced in a box that is kept, without flat sides where ink would leave it.
//!
//! [`enforce`] never leaves the box around the ink, and what would is cut off straight: tips of leaves come out as if they had
//! been filed down. So the ink is first left to grow as it likes; by as much as it leaves the box, the drawing is
//! pressed together on that side, and grows again, into the box and not over it. Drawings become smaller so by half of what ink
//! is thickened, which nobody sees. Excluded: rectangles, whose sides are straight as they are.

use glam::DVec2;

use super::Counts;
use super::enforce::{EnforceError, EnforceOptions, Enforced, enforce};
use crate::planar::{FillRule, Grid, GridPoint, Region};

/// So often the drawing is pressed anew. It nearly always fits the second time; more only take time.
const TRIES: usize = 3;
/// How far from the ink the frame is, and how wide, in sums of both widths: farther than ink grows.
const FRAME: f64 = 4.0;

/// How a drawing was pressed together, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    /// The lower left and the upper right corner of the box around it before.
    pub from: [DVec2; 2],
    /// The same after.
    pub to: [DVec2; 2],
}

impl Pressed {
    /// Where a point of the drawing has gone.
    pub fn moved(&self, p: DVec2) -> DVec2 {
        self.to[0] + (p - self.from[0]) * ((self.to[1] - self.to[0]) / (self.from[1] - self.from[0]))
    }

    /// By how much the drawing has become narrower and lower.
    pub fn by_mm(&self) -> DVec2 {
        (self.from[1] - self.from[0]) - (self.to[1] - self.to[0])
    }
}

/// As [`enforce`], within the same box, with round tips round; the region may be on a finer grid. Where there is no way to,
/// tips are cut off straight. Areas are those of the region as it was given, and changes those after it was pressed.
///
/// # Errors
/// As [`enforce`].
pub fn enforce_in_box(region: &Region, options: &EnforceOptions) -> Result<Enforced, EnforceError> {
    let Some((low, high)) = region.bounds_mm() else { return enforce(region, options) };
    let counts = Counts::of(region);
    let mut pressed = region.clone();
    let mut press = None;
    let [mut left_below, mut right_above] = [DVec2::ZERO; 2];
    for _ in 0..TRIES {
        // Where there is no room without a box, there is none in it.
        let free = enforced_freely(&pressed, options)?;
        let Some((least, most)) = free.region.bounds_mm() else { break };
        let over = [(low - least).max(DVec2::ZERO), (most - high).max(DVec2::ZERO)];
        if over[0].max(over[1]).max_element() <= options.chord_mm {
            // The rest is less than anything that matters.
            let fits = between(&free.region, [least, most], [low.max(least), high.min(most)]);
            match fits.filter(|fits| Counts::of(fits) == counts) {
                Some(made) => return Ok(Enforced { pressed: press, ..measured(region, made, free) }),
                None => break,
            }
        }
        left_below += over[0];
        right_above += over[1];
        let to = [low + left_below, high - right_above];
        match between(region, [low, high], to) {
            Some(narrower) if Counts::of(&narrower) == counts => {
                (pressed, press) = (narrower, Some(Pressed { from: [low, high], to }));
            }
            _ => break,
        }
    }
    enforce(region, options)
}

/// What was `enforced`, with `made` of it and the areas by which that differs from the region `before` it was pressed.
fn measured(before: &Region, made: Region, enforced: Enforced) -> Enforced {
    let Ok(before) = before.placed(made.grid(), |p| p) else { return Enforced { region: made, ..enforced } };
    let both_mm2 = Region::union(made.grid(), [&before, &made]).area_mm2();
    let [added_mm2, removed_mm2] = [&before, &made].map(|region| (both_mm2 - region.area_mm2()).max(0.0));
    Enforced { region: made, added_mm2, removed_mm2, ..enforced }
}

/// The region with the box of one pair of corners moved to another; as it is where they are the same.
fn between(region: &Region, from: [DVec2; 2], to: [DVec2; 2]) -> Option<Region> {
    if from == to {
        return Some(region.clone());
    }
    let size = from[1] - from[0];
    let scale = (to[1] - to[0]) / size;
    let is_sound = size.min_element() > 0.0 && scale.min_element() > 0.5;
    let pressed = Pressed { from, to };
    is_sound.then(|| region.placed(region.grid(), |p| pressed.moved(p)).ok()).flatten()
}

/// What is enforced when no box is in the way.
fn enforced_freely(region: &Region, options: &EnforceOptions) -> Result<Enforced, EnforceError> {
    let Some((low, high)) = region.bounds_mm() else { return enforce(region, options) };
    let away_mm = FRAME * (options.min_feature_mm + options.min_gap_mm);
    let reach = low.abs().max(high.abs()).max_element() + 3.0 * away_mm;
    let Some(grid) = Grid::for_extent(reach).ok() else { return enforce(region, options) };
    let Ok(ink) = region.placed(grid, |p| p) else { return enforce(region, options) };
    let corners = [low, high].map(|p| GridPoint::new(grid.steps(p.x), grid.steps(p.y)));
    let free = enforce(&framed(&ink, corners, grid.steps(away_mm)), options)?;
    let is_changed = free.added_mm2 > 0.0 || free.removed_mm2 > 0.0;
    let region = if is_changed { without_frame(&free.region) } else { region.clone() };
    Ok(Enforced { region, ..free })
}

/// The region with a frame of ink around the box, `away` steps from it and as many wide: a region never leaves the box around
/// all of it.
fn framed(region: &Region, [low, high]: [GridPoint; 2], away: i64) -> Region {
    let grid = region.grid();
    let around = |by: i64| {
        let (low, high) = (GridPoint::new(low.x - by, low.y - by), GridPoint::new(high.x + by, high.y + by));
        vec![low, GridPoint::new(high.x, low.y), high, GridPoint::new(low.x, high.y)]
    };
    let inner = around(away).into_iter().rev().collect();
    let frame = Region::fill(grid, &[around(2 * away), inner], FillRule::Positive);
    Region::union(grid, [region, &frame])
}

/// The region without the part around everything.
fn without_frame(region: &Region) -> Region {
    let least = region.parts().iter().map(|part| part.exterior().bounds().0.x).min();
    let inside = region.parts().iter().filter(|part| Some(part.exterior().bounds().0.x) != least);
    let paths: Vec<Vec<GridPoint>> =
        inside.flat_map(|part| part.contours()).map(|contour| contour.points().to_vec()).collect();
    Region::fill(region.grid(), &paths, FillRule::Positive)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: EnforceOptions = EnforceOptions { min_feature_mm: 0.6, min_gap_mm: 0.3, chord_mm: 0.01 };

    /// A ring of a diameter of 10 mm whose ink is 0.3 mm wide.
    fn ring() -> Region {
        let grid = Grid::for_extent(100.0).unwrap();
        let circle = |radius: f64| -> Vec<GridPoint> {
            let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / 200.0;
            let point = |i| DVec2::splat(20.0) + radius * DVec2::from_angle(angle(i));
            (0..200).map(|i| grid.snap(point(i)).unwrap()).collect()
        };
        let inner = circle(4.7).into_iter().rev().collect();
        Region::fill(grid, &[circle(5.0), inner], FillRule::Positive)
    }

    #[test]
    fn a_thin_ring_stays_round_and_as_large_as_it_was() {
        let before = ring();
        let made = enforce_in_box(&before, &OPTIONS).unwrap();
        let (low, high) = made.region.bounds_mm().unwrap();
        assert!((high - low - 10.0).abs().max_element() < 0.011, "{low} {high}");
        assert_eq!(Counts::of(&made.region), Counts::of(&before));
        let eroded = made.region.offset(-0.295, 0.001);
        assert!(Counts::of(&eroded) == Counts::of(&before) && made.added_mm2 > 5.0);
        let after_mm2 = before.area_mm2() + made.added_mm2 - made.removed_mm2;
        assert!((made.region.area_mm2() - after_mm2).abs() < 1e-6, "{after_mm2}");
        let pressed = made.pressed.unwrap();
        assert!((pressed.by_mm() - 0.3).abs().max_element() < 0.05, "{pressed:?}");
        assert_eq!(pressed.moved(pressed.from[1]), pressed.to[1]);
        // No flat sides: the outer contour is round everywhere.
        let outer = made.region.parts()[0].exterior();
        let grid = made.region.grid();
        let middles = outer.edges().map(|(a, b)| grid.to_mm(a).midpoint(grid.to_mm(b)));
        let least = middles.map(|p| p.distance(DVec2::splat(20.0))).fold(f64::INFINITY, f64::min);
        assert!(least > 4.98, "{least}");
    }

    #[test]
    fn what_is_wide_stays_as_it_is() {
        let wide = EnforceOptions { min_feature_mm: 0.2, ..OPTIONS };
        assert_eq!(enforce_in_box(&ring(), &wide).unwrap().region, ring());
    }
}
