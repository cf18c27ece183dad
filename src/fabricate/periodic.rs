//! Minimum feature and gap of a tile, enforced so that its copies still match.
//!
//! What is thickened at one side of a tile must be thickened at the opposite side, too. So not the tile is enforced, but four
//! copies around one corner, as much of them as has a say in it, and the tile is put together again from the quarters
//! around that corner: each side of it is cut along the same line as the opposite one, and matches by construction. Where
//! quarters meet, in the middle of the tile, what was thickened twice may differ by less than anyone makes; a greater
//! difference would be a step, and is refused. Excluded: what is not a rectangle.

use glam::DVec2;
use thiserror::Error;

use super::Counts;
use super::enforce::{EnforceError, EnforceOptions, Enforced, changed, enforce};
use super::in_box::framed;
use super::kerf::difference;
use crate::planar::{FillRule, Grid, GridError, GridPoint, Region};

/// How far around the tile copies have a say in what becomes of it, in sums of both widths. Less, and what grows there is
/// another thing on either side; more only takes time.
const REACH: f64 = 8.0;
/// Where quarters meet they may differ by this part of the chord error: less, and rounding is refused; more, and a step
/// shows.
const STEP: f64 = 1.0;

/// Why a tile cannot be enforced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PeriodicError {
    /// There is no room, as for any region.
    #[error(transparent)]
    Enforce(#[from] EnforceError),
    /// What was enforced is not the same in all copies.
    #[error("near ({:.2}, {:.2}) mm copies of the tile would differ once widths are enforced", position_mm.x, position_mm.y)]
    Differs {
        /// Where, in millimetres.
        position_mm: DVec2,
    },
    /// The tile as it is cut would have other counts.
    #[error(
        "along its sides, widths of a tile cannot be enforced without changing its counts from {} component(s) and {} hole(s) to {} and {}",
        before.components, before.holes, after.components, after.holes
    )]
    Counts {
        /// As it was.
        before: Counts,
        /// With its widths enforced.
        after: Counts,
    },
    /// Four copies are too large to compute with.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// As [`enforce`] for a tile: copies of what comes out, set side by side and one above the other at the size of the box
/// around its ink, match where those of `tile` do.
///
/// # Errors
/// [`PeriodicError`]; places are on the tile.
pub fn enforce_tile(tile: &Region, options: &EnforceOptions) -> Result<Enforced, PeriodicError> {
    let Some((low, high)) = tile.bounds_mm() else { return Ok(enforce(tile, options)?) };
    let pitch_mm = high - low;
    let reach_mm = REACH * (options.min_feature_mm + options.min_gap_mm);
    let grid = Grid::for_extent(2.0 * (pitch_mm.max_element() + reach_mm))?;
    let pitch = GridPoint::new(grid.steps(pitch_mm.x), grid.steps(pitch_mm.y));
    let half = GridPoint::new(pitch.x / 2, pitch.y / 2);
    let reach = grid.steps(reach_mm);
    let corner = tile.placed(grid, |p| p - low)?;
    // Columns and rows on either side of the corner.
    let [columns, rows] =
        [(half.x, pitch.x), (half.y, pitch.y)].map(|(half, pitch)| 1 + (half + reach) / pitch);
    let places = (-rows..rows).flat_map(|j| (-columns..columns).map(move |i| (i, j)));
    let copies: Vec<Region> =
        places.map(|(i, j)| corner.shifted(GridPoint::new(i * pitch.x, j * pitch.y))).collect();
    // What is cut off has room to grow as in the middle.
    let out = GridPoint::new(half.x + reach, half.y + reach);
    let window = [GridPoint::new(-out.x, -out.y), out];
    let near = framed(&clipped(&Region::union(grid, &copies), window[0], window[1]), window, reach / 2);
    let on_tile = |p: DVec2| p.rem_euclid(pitch_mm) + low;
    let enforced = enforce(&near, options).map_err(|error| match error {
        EnforceError::Crowded { what, position_mm, width_mm, min_feature_mm, min_gap_mm } => {
            let position_mm = on_tile(position_mm);
            EnforceError::Crowded { what, position_mm, width_mm, min_feature_mm, min_gap_mm }
        }
        error => error,
    })?;
    if enforced.region == near {
        return Ok(changed(tile, tile.clone(), options));
    }
    let around_corner = crossed(&enforced.region);
    let quarters = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
        let from = GridPoint::new(-i * (pitch.x - half.x), -j * (pitch.y - half.y));
        let to = GridPoint::new((1 - i) * half.x, (1 - j) * half.y);
        clipped(&around_corner, from, to).shifted(GridPoint::new(i * pitch.x, j * pitch.y))
    });
    let whole = Region::union(grid, &quarters);
    if let Some(place) = step(&around_corner, pitch, half, options) {
        return Err(PeriodicError::Differs { position_mm: on_tile(place) });
    }
    let whole = whole.placed(tile.grid(), |p| p + low)?;
    let (before, after) = (Counts::of(tile), Counts::of(&whole));
    if before != after {
        return Err(PeriodicError::Counts { before, after });
    }
    Ok(changed(tile, whole, options))
}

/// A place where what lies on one side of a middle line is not the same in the two copies that meet there.
fn step(
    around_corner: &Region,
    pitch: GridPoint,
    half: GridPoint,
    options: &EnforceOptions,
) -> Option<DVec2> {
    let grid = around_corner.grid();
    let strip =
        grid.steps(0.5 * (options.min_feature_mm + options.min_gap_mm)).min(half.x / 2).min(half.y / 2);
    let least = GridPoint::new(half.x - pitch.x, half.y - pitch.y);
    let strips = [
        (GridPoint::new(half.x - strip, least.y), GridPoint::new(pitch.x, 0)),
        (GridPoint::new(least.x, half.y - strip), GridPoint::new(0, pitch.y)),
    ];
    let half_step_mm = 0.5 * STEP * options.chord_mm;
    strips.into_iter().find_map(|(low, by)| {
        let one = clipped(around_corner, low, half);
        let [low, high] = [low, half].map(|p| GridPoint::new(p.x - by.x, p.y - by.y));
        let other = clipped(around_corner, low, high).shifted(by);
        let both = [difference(&one, &other), difference(&other, &one)];
        both.iter().find_map(|differs| {
            let seen = differs.offset(-half_step_mm, half_step_mm);
            let place = seen.contours().next().map(|contour| contour.points()[0]);
            place.map(|p| grid.to_mm(p))
        })
    })
}

/// The region inside of a rectangle.
fn clipped(region: &Region, low: GridPoint, high: GridPoint) -> Region {
    let (least, most) = region.bounds_mm().unwrap_or_default();
    let grid = region.grid();
    let margin = grid.steps(1.0);
    let around = [
        GridPoint::new(grid.steps(least.x).min(low.x) - margin, grid.steps(least.y).min(low.y) - margin),
        GridPoint::new(grid.steps(most.x).max(high.x) + margin, grid.steps(most.y).max(high.y) + margin),
    ];
    let mut layers: Vec<Vec<GridPoint>> = region.contours().map(|c| c.points().to_vec()).collect();
    layers.push(rectangle(low, high));
    // Positive where the ink and the rectangle are.
    layers.push(rectangle(around[0], around[1]).into_iter().rev().collect());
    Region::fill(grid, &layers, FillRule::Positive)
}

fn rectangle(low: GridPoint, high: GridPoint) -> Vec<GridPoint> {
    vec![low, GridPoint::new(high.x, low.y), high, GridPoint::new(low.x, high.y)]
}

/// The contours with a vertex wherever they cross an axis, so that all that is clipped along it has the same.
fn crossed(region: &Region) -> Region {
    let mut paths: Vec<Vec<GridPoint>> = region.contours().map(|c| c.points().to_vec()).collect();
    // Once as it is and once with x and y exchanged.
    for _ in 0..2 {
        for path in &mut paths {
            let n = path.len();
            let crossed: Vec<GridPoint> = (0..n)
                .flat_map(|i| {
                    let (a, b) = (path[i], path[(i + 1) % n]);
                    let crosses = (a.x < 0 && b.x > 0) || (a.x > 0 && b.x < 0);
                    std::iter::once(a).chain(crosses.then(|| GridPoint::new(0, height_at_axis(a, b))))
                })
                .collect();
            *path = crossed.into_iter().map(|p| GridPoint::new(p.y, p.x)).collect();
        }
    }
    Region::fill(region.grid(), &paths, FillRule::Positive)
}

/// Where the edge from `a` to `b`, which are on either side, crosses the line x = 0.
fn height_at_axis(a: GridPoint, b: GridPoint) -> i64 {
    let (along, whole) = (i128::from(-a.x), i128::from(b.x) - i128::from(a.x));
    let rise = i128::from(b.y) - i128::from(a.y);
    // Rounded to the nearest, the same from either end.
    let twice = 2 * (i128::from(a.y) * whole + rise * along) + whole;
    twice.div_euclid(2 * whole) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::boxes;
    use crate::verify::{endures_erosion, tiling};

    /// Boxes of a corner and a size in tenths of a millimetre.
    fn tile(of: &[(i64, i64, i64, i64)]) -> Region {
        boxes(Grid::for_extent(100.0).unwrap().steps(0.1), FillRule::NonZero, of)
    }

    const OPTIONS: EnforceOptions = EnforceOptions { min_feature_mm: 0.5, min_gap_mm: 0.5, chord_mm: 0.01 };

    #[test]
    fn thin_strands_across_the_sides_are_thickened_and_copies_match() {
        // A lattice of threads of 0.2 mm; one lies so near to the upper side that it has to grow across it.
        let threads = tile(&[(0, 60, 200, 2), (0, 146, 200, 2), (40, 0, 2, 150), (130, 0, 2, 150)]);
        let before = tiling(&threads).unwrap();
        let made = enforce_tile(&threads, &OPTIONS).unwrap();
        let after = tiling(&made.region).unwrap();
        assert_eq!((after.components, after.holes), (before.components, before.holes));
        assert!((after.pitch_mm - before.pitch_mm).length() < 1e-6, "{} {}", after.pitch_mm, before.pitch_mm);
        assert!(!endures_erosion(&threads, 0.2, 0.001) && made.added_mm2 > 10.0);
        // As it is set side by side, it is as wide as it must be.
        let grid = Grid::for_extent(100.0).unwrap();
        let one = made.region.placed(grid, |p| p).unwrap();
        let step = GridPoint::new(grid.steps(before.pitch_mm.x), grid.steps(before.pitch_mm.y));
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
            .map(|(i, j)| one.shifted(GridPoint::new(i * step.x, j * step.y)));
        assert!(endures_erosion(&Region::union(grid, &four), 0.24, 0.001));
    }

    #[test]
    fn a_tile_that_is_wide_enough_stays_as_it_is() {
        let wide = tile(&[(0, 60, 200, 10), (40, 0, 10, 150)]);
        assert_eq!(enforce_tile(&wide, &OPTIONS).unwrap().region, wide);
    }

    #[test]
    fn what_would_grow_across_a_side_on_its_own_is_refused() {
        // A thread that ends freely, so near to the upper side that what it grows to lies in two tiles.
        let beside = tile(&[(0, 0, 40, 150), (0, 70, 200, 40), (120, 148, 50, 1), (100, 0, 5, 150)]);
        let error = enforce_tile(&beside, &OPTIONS).unwrap_err();
        assert!(matches!(error, PeriodicError::Counts { .. }), "{error}");
        assert!(error.to_string().contains("from 2 component(s) and 0 hole(s) to 3 and 0"), "{error}");
        // Farther from it there is room.
        let inside = tile(&[(0, 0, 40, 150), (0, 70, 200, 40), (120, 130, 50, 1), (100, 0, 5, 150)]);
        let made = enforce_tile(&inside, &OPTIONS).unwrap();
        assert_eq!(Counts::of(&made.region), Counts::of(&inside));
    }
}
