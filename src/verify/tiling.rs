//! Whether copies of a drawing join, and what the tiling that they make has.
//!
//! A tile is ink whose bounding box is the pitch: copies are set side by side and one above the other. They join
//! when the ink on the left side of the box is that on the right, and the same below and above. Glued along n
//! intervals a tile's Euler characteristic χ falls by n, which gives the holes of the tiling; the components are
//! united where they meet. That much is known without a copy; then four copies *are* set together, united and
//! counted, and must have the χ that follows.

use std::fmt;

use glam::DVec2;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

use crate::planar::{GridPoint, Region};

/// What the tiling has that copies of a tile make.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Tiling {
    /// The distance from one copy to the next, to the right and up, in millimetres.
    #[serde(serialize_with = "super::json::point")]
    #[schemars(with = "[f64; 2]")]
    pub pitch_mm: DVec2,
    /// The intervals in which a copy joins the next to the right.
    pub joins_across: usize,
    /// The intervals in which a copy joins the next above.
    pub joins_up: usize,
    /// Components for each tile: those of the torus that the tile is when its sides are glued.
    pub components: usize,
    /// Holes of that torus: those inside for each tile, and one for each way round that the ink closes.
    pub holes: i64,
    /// Components of two by two copies, united and counted.
    pub four_components: usize,
    /// Holes of two by two copies.
    pub four_holes: usize,
}

impl fmt::Display for Tiling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pitch_mm: pitch, joins_across, joins_up, components, holes, four_components, four_holes } =
            self;
        writeln!(
            f,
            "tile         {:.3} x {:.3} mm, joins {joins_across} across, {joins_up} up",
            pitch.x, pitch.y
        )?;
        writeln!(f, "tiling       {components} component(s) and {holes} hole(s) for each tile")?;
        write!(f, "2 x 2 tiles  {four_components} component(s), {four_holes} hole(s)")
    }
}

/// Why copies do not join.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TilingFault {
    /// There is no ink.
    #[error("there is no ink to join")]
    Empty,
    /// No ink lies along any side.
    #[error("copies do not join: no ink lies along a side of the tile")]
    Apart,
    /// Two opposite sides differ.
    #[error("copies do not join: ink at ({:.3}, {:.3}) mm has none to meet on the {opposite} side", position_mm.x, position_mm.y)]
    Side {
        /// An end of an interval that the other side does not have.
        position_mm: DVec2,
        /// The side without it.
        opposite: &'static str,
    },
    /// Copies set together do not have what the sides promise.
    #[error(
        "copies do not join: four have components less holes {found}, and {expected} follow from their sides"
    )]
    Count {
        /// χ of four copies.
        found: i64,
        /// χ by the sides.
        expected: i64,
    },
}

/// The tiling that copies of `tile` make.
///
/// # Errors
/// [`TilingFault`] when copies do not join.
pub fn tiling(tile: &Region) -> Result<Tiling, TilingFault> {
    let (low, high) = tile.bounds_mm().ok_or(TilingFault::Empty)?;
    let grid = tile.grid();
    let corner = |p: DVec2| GridPoint::new(grid.steps(p.x), grid.steps(p.y));
    let (low, high) = (corner(low), corner(high));
    let across = |p: GridPoint| (p.x, p.y);
    let up = |p: GridPoint| (p.y, p.x);
    let sides = [
        (intervals(tile, low.x, across), intervals(tile, high.x, across), ["left", "right"]),
        (intervals(tile, low.y, up), intervals(tile, high.y, up), ["lower", "upper"]),
    ];
    let mut owner: Vec<usize> = (0..tile.components()).collect();
    for (axis, (near, far, names)) in sides.iter().enumerate() {
        glue(near, far, &mut owner).map_err(|(along, is_far)| {
            let corner = if is_far { high } else { low };
            let at = match axis {
                0 => GridPoint::new(corner.x, along),
                _ => GridPoint::new(along, corner.y),
            };
            TilingFault::Side { position_mm: grid.to_mm(at), opposite: names[usize::from(!is_far)] }
        })?;
    }
    let (joins_across, joins_up) = (sides[0].0.len(), sides[1].0.len());
    if joins_across + joins_up == 0 {
        return Err(TilingFault::Apart);
    }
    let components = (0..owner.len()).filter(|&part| owner[part] == part).count();
    let euler = euler(tile);
    let pitch = GridPoint::new(high.x - low.x, high.y - low.y);
    let four = copies(tile, pitch, 2, 2);
    let joins = (joins_across + joins_up) as i64;
    let (found, expected) = (self::euler(&four), 4 * euler - 2 * joins);
    if found != expected {
        return Err(TilingFault::Count { found, expected });
    }
    Ok(Tiling {
        pitch_mm: grid.to_mm(pitch),
        joins_across,
        joins_up,
        components,
        holes: components as i64 - (euler - joins),
        four_components: four.components(),
        four_holes: four.holes(),
    })
}

/// What a strip has whose left and right sides are joined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Rolled {
    /// The intervals in which the sides meet.
    pub joins: usize,
    /// Components when they are joined.
    pub components: usize,
    /// Holes then, one of them for each way round that the ink closes.
    pub holes: usize,
}

/// What `strip` has when its left and right sides, at these x in millimetres, are joined. Ink that ends short of a side has nothing to
/// do with it.
///
/// # Errors
/// [`TilingFault`] when the ink along the two sides differs.
pub fn rolled(strip: &Region, sides_mm: [f64; 2]) -> Result<Rolled, TilingFault> {
    if strip.is_empty() {
        return Err(TilingFault::Empty);
    }
    let grid = strip.grid();
    let across = |p: GridPoint| (p.x, p.y);
    let [left, right] = sides_mm.map(|x| grid.steps(x));
    let [near, far] = [left, right].map(|x| intervals(strip, x, across));
    let mut owner: Vec<usize> = (0..strip.components()).collect();
    glue(&near, &far, &mut owner).map_err(|(along, is_far)| {
        let (x, opposite) = if is_far { (right, "left") } else { (left, "right") };
        TilingFault::Side { position_mm: grid.to_mm(GridPoint::new(x, along)), opposite }
    })?;
    let components = (0..owner.len()).filter(|&part| owner[part] == part).count();
    let holes = components as i64 - (euler(strip) - near.len() as i64);
    Ok(Rolled { joins: near.len(), components, holes: holes.try_into().expect("a Betti number") })
}

/// Unites the owners of ink that meets where one side is glued to another. Or where an interval begins that the other side does not
/// have, and whether it is on the far side.
fn glue(near: &[Interval], far: &[Interval], owner: &mut [usize]) -> Result<(), (i64, bool)> {
    let odd = |one: &[Interval], other: &[Interval]| {
        one.iter().find(|i| !other.iter().any(|j| (i.from, i.to) == (j.from, j.to))).map(|i| i.from)
    };
    if let Some(along) = odd(near, far) {
        return Err((along, false));
    }
    if let Some(along) = odd(far, near) {
        return Err((along, true));
    }
    for (a, b) in near.iter().zip(far) {
        let (a, b) = (root(owner, a.part), root(owner, b.part));
        owner[a.max(b)] = a.min(b);
    }
    Ok(())
}

/// So many copies of `tile` to the right and up, `pitch` apart, united.
fn copies(tile: &Region, pitch: GridPoint, columns: i64, rows: i64) -> Region {
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let copies: Vec<Region> =
        places.map(|(i, j)| tile.shifted(GridPoint::new(i * pitch.x, j * pitch.y))).collect();
    Region::union(tile.grid(), &copies)
}

fn euler(region: &Region) -> i64 {
    region.components() as i64 - region.holes() as i64
}

fn root(owner: &[usize], mut part: usize) -> usize {
    while owner[part] != part {
        part = owner[part];
    }
    part
}

/// Ink along a side.
struct Interval {
    from: i64,
    to: i64,
    part: usize,
}

/// The intervals of ink along the line on which the first coordinate is `at`, ascending.
fn intervals(tile: &Region, at: i64, coordinates: impl Fn(GridPoint) -> (i64, i64)) -> Vec<Interval> {
    let mut found: Vec<Interval> = Vec::new();
    for (part, ink) in tile.parts().iter().enumerate() {
        for (a, b) in ink.contours().flat_map(|c| c.edges()) {
            let ((a0, a1), (b0, b1)) = (coordinates(a), coordinates(b));
            if a0 == at && b0 == at {
                found.push(Interval { from: a1.min(b1), to: a1.max(b1), part });
            }
        }
    }
    found.sort_unstable_by_key(|i| (i.from, i.to));
    // A vertex inside of an interval splits its edge.
    let mut merged: Vec<Interval> = Vec::new();
    for next in found {
        match merged.last_mut() {
            Some(last) if last.to == next.from => last.to = next.to,
            _ => merged.push(next),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{self, FillRule, Grid};

    fn tile(boxes: &[(i64, i64, i64, i64)]) -> Region {
        planar::boxes(10_000_000, FillRule::NonZero, boxes)
    }

    #[test]
    fn a_strip_is_rolled() {
        // A bar all round, a bead over the sides, and an island inside.
        let strip = tile(&[(0, 0, 40, 2), (0, 4, 3, 3), (37, 4, 3, 3), (20, 5, 4, 4)]);
        let sides = strip.bounds_mm().map(|(low, high)| [low.x, high.x]).unwrap();
        let found = rolled(&strip, sides).unwrap();
        assert_eq!((found.joins, found.components, found.holes), (2, 3, 1));
        let odd = tile(&[(0, 0, 40, 2), (0, 4, 3, 3)]);
        assert!(matches!(rolled(&odd, sides), Err(TilingFault::Side { opposite: "right", .. })));
        let open = rolled(&tile(&[(5, 0, 30, 2)]), sides).unwrap();
        assert_eq!((open.joins, open.components, open.holes), (0, 1, 0));
    }

    #[test]
    fn a_cross_tiles_to_a_lattice() {
        let found = tiling(&tile(&[(0, 40, 100, 20), (30, 0, 30, 80)])).unwrap();
        assert_eq!((found.joins_across, found.joins_up), (1, 1));
        assert_eq!((found.components, found.holes), (1, 2), "round one way and round the other");
        assert_eq!((found.four_components, found.four_holes), (1, 1));
    }

    #[test]
    fn bars_tile_to_stripes() {
        // A bar from side to side, and an island on the corner of its own: two components for each tile.
        let found = tiling(&tile(&[(0, 0, 100, 20), (10, 40, 10, 10)]));
        assert!(matches!(found, Err(TilingFault::Side { opposite: "upper", .. })), "{found:?}");
        let found = tiling(&tile(&[(0, 40, 100, 20), (10, 0, 10, 10), (10, 90, 10, 10)])).unwrap();
        assert_eq!((found.components, found.holes), (2, 1));
        assert_eq!(found.four_components, 2 + 2 + 4);
    }

    #[test]
    fn sides_that_differ_are_named() {
        let found = tiling(&tile(&[(0, 40, 100, 20), (90, 50, 10, 30), (30, 0, 30, 80)]));
        assert!(matches!(found, Err(TilingFault::Side { opposite: "right", .. })), "{found:?}");
        // Round: it touches its sides in points only.
        let step = 10_000_000;
        let diamond =
            [(50, 0), (100, 50), (50, 100), (0, 50)].map(|(x, y)| GridPoint::new(x * step, y * step));
        let diamond = Region::fill(Grid::for_extent(100.0).unwrap(), &[diamond.to_vec()], FillRule::NonZero);
        assert_eq!(tiling(&diamond), Err(TilingFault::Apart));
        assert_eq!(tiling(&Region::empty(Grid::for_extent(1.0).unwrap())), Err(TilingFault::Empty));
    }
}
