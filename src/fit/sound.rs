//! Whether a bent piece is still the piece that was planned, decided exactly.
//!
//! The chains of a piece and the portals between their ends close to contours. Bent, snapped to the integer grid and
//! closed again, they must be simple and pairwise disjoint, lie inside each other as before, and keep within the
//! strip, which they touch at the endpoints only. Then the bent piece has the same descriptor, and pieces can be
//! glued as the plan says, whatever bent them.

use glam::DVec2;
use rustc_hash::FxHashMap;
use thiserror::Error;

use super::stitch::Bent;
use crate::pieces::{End, Piece};
use crate::planar::{Contour, Fault, Grid, GridPoint, Region, RegionError};

/// What is wrong with a bent piece. Positions are millimetres from its left cut and above the middle of the band.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Unsound {
    /// Two contours cross or touch, or one does itself.
    #[error("contours meet at ({:.3}, {:.3}) mm of the piece", .position_mm.x, .position_mm.y)]
    Meets {
        /// A place where they do.
        position_mm: DVec2,
    },
    /// A contour leaves the strip between the cuts.
    #[error("a contour leaves the piece at ({:.3}, {:.3}) mm", .position_mm.x, .position_mm.y)]
    Leaves {
        /// A vertex outside.
        position_mm: DVec2,
    },
    /// A contour has turned over, or lies inside of another one than before.
    #[error("a contour at ({:.3}, {:.3}) mm of the piece has turned over or changed sides", .position_mm.x, .position_mm.y)]
    Turned {
        /// A vertex of it.
        position_mm: DVec2,
    },
    /// There is no such deformation: the system of equations cannot be solved in floats.
    #[error("the deformation cannot be computed")]
    Unsolvable,
}

/// Which contours of a piece lie directly inside which: an exterior with its holes, by number.
type Nesting = Vec<(usize, Vec<usize>)>;

/// A piece as it should stay.
#[derive(Debug, Clone)]
pub(super) struct Soundness {
    nesting: Result<Nesting, Unsound>,
}

impl Soundness {
    /// What has to stay true of `piece`.
    pub(super) fn of(piece: &Piece) -> Self {
        let drawn = Bent {
            chains: piece.chains.iter().map(|c| c.points.clone()).collect(),
            loops: piece.loops.clone(),
        };
        Self { nesting: nesting(piece, &drawn) }
    }

    /// Compares `bent` with the piece as drawn.
    pub(super) fn check(&self, piece: &Piece, bent: &Bent) -> Result<(), Unsound> {
        let (found, wanted) = (nesting(piece, bent)?, self.nesting.as_ref().map_err(|&fault| fault)?);
        match found.iter().zip(wanted).find(|(found, wanted)| found != wanted) {
            None if found.len() == wanted.len() => Ok(()),
            _ => {
                let points = bent.loops.iter().chain(&bent.chains).flatten();
                Err(Unsound::Turned { position_mm: points.copied().next().unwrap_or_default() })
            }
        }
    }
}

fn nesting(piece: &Piece, bent: &Bent) -> Result<Nesting, Unsound> {
    let all = || bent.chains.iter().chain(&bent.loops).flatten();
    let extent_mm = all().map(|p| p.abs().max_element()).fold(piece.width_mm, f64::max);
    let grid = Grid::for_extent(extent_mm).map_err(|_| Unsound::Unsolvable)?;
    let snap = |p: DVec2| grid.snap(p).map_err(|_| Unsound::Unsolvable);
    let right = grid.steps(piece.width_mm);
    let within = |points: &[DVec2]| -> Result<Vec<GridPoint>, Unsound> {
        let place = |&p: &DVec2| match snap(p)? {
            q if 0 < q.x && q.x < right => Ok(q),
            _ => Err(Unsound::Leaves { position_mm: p }),
        };
        points.iter().map(place).collect()
    };
    let mut paths = Vec::new();
    let mut used = vec![false; piece.chains.len()];
    for first in 0..piece.chains.len() {
        let (mut path, mut at) = (Vec::new(), first);
        while !used[at] {
            used[at] = true;
            let points = &bent.chains[at];
            path.push(snap(points[0])?);
            path.extend(within(&points[1..points.len() - 1])?);
            path.push(snap(points[points.len() - 1])?);
            // Across the portal to its other end, where the next chain begins.
            let next = match piece.chains[at].end {
                End::Left(k) => End::Left(k ^ 1),
                End::Right(k) => End::Right(k ^ 1),
            };
            at = piece
                .chains
                .iter()
                .position(|c| c.start == next)
                .expect("a chain begins at every other endpoint");
        }
        if !path.is_empty() {
            paths.push(path);
        }
    }
    for points in &bent.loops {
        paths.push(within(points)?);
    }
    let mut owners = FxHashMap::default();
    let mut contours = Vec::with_capacity(paths.len());
    for (number, path) in paths.into_iter().enumerate() {
        let turned = Unsound::Turned { position_mm: grid.to_mm(path[0]) };
        let contour = Contour::new(path).ok_or(turned)?;
        owners.insert(contour.points()[0], number);
        contours.push(contour);
    }
    let region = Region::from_contours(grid, contours).map_err(|error| match error {
        RegionError::Invalid { faults } => match faults[0] {
            Fault::Crossing(position_mm) => Unsound::Meets { position_mm },
            Fault::Nesting(position_mm) => Unsound::Turned { position_mm },
        },
        RegionError::Grid(_) => Unsound::Unsolvable,
    })?;
    let mut nesting: Nesting = region
        .parts()
        .iter()
        .map(|part| {
            let mut holes: Vec<usize> = part.holes().iter().map(|hole| owners[&hole.points()[0]]).collect();
            holes.sort_unstable();
            (owners[&part.exterior().points()[0]], holes)
        })
        .collect();
    nesting.sort_unstable();
    Ok(nesting)
}

#[cfg(test)]
mod tests {
    use super::super::sample_pieces::crossing_strand;
    use super::*;

    /// What is found when the strand with a hole and an island is bent by `bend`, which gets its chains (below and
    /// above) and its loops (hole and island).
    fn verdict(bend: impl Fn(&mut Bent)) -> Result<(), Unsound> {
        let piece = crossing_strand();
        let chains = piece.chains.iter().map(|c| c.points.clone()).collect();
        let mut bent = Bent { chains, loops: piece.loops.clone() };
        bend(&mut bent);
        Soundness::of(&piece).check(&piece, &bent)
    }

    #[test]
    fn what_is_only_bent_is_sound() {
        assert_eq!(verdict(|_| {}), Ok(()));
        assert_eq!(
            verdict(|bent| bent.chains.iter_mut().chain(&mut bent.loops).flatten().for_each(|p| p.y += p.x)),
            Ok(())
        );
    }

    #[test]
    fn contours_that_cross_or_touch_are_found() {
        let crossed = verdict(|bent| bent.chains[0][2].y = 1.0);
        assert!(matches!(crossed, Err(Unsound::Meets { .. })), "{crossed:?}");
        // The island's lowest vertex on the strand's upper contour.
        let touched = verdict(|bent| bent.loops[1][1] = bent.chains[1][2]);
        assert!(matches!(touched, Err(Unsound::Meets { .. })), "{touched:?}");
    }

    #[test]
    fn the_strip_ends_at_its_cuts() {
        let left = verdict(|bent| bent.chains[0][1].x = -1e-6);
        assert!(matches!(left, Err(Unsound::Leaves { .. })), "{left:?}");
        let on_cut = verdict(|bent| bent.chains[1][1].x = 4.0);
        assert!(matches!(on_cut, Err(Unsound::Leaves { .. })), "{on_cut:?}");
    }

    #[test]
    fn loops_that_turn_over_or_move_out_are_found() {
        let turned = verdict(|bent| bent.loops[1].reverse());
        assert!(matches!(turned, Err(Unsound::Turned { .. })), "{turned:?}");
        let swapped = verdict(|bent| {
            bent.loops[0].iter_mut().for_each(|p| p.y += 1.5);
            bent.loops[1]
                .iter_mut()
                .for_each(|p| *p = (*p - DVec2::new(2.0, 1.5)) * 3.0 + DVec2::new(2.0, 1.5));
        });
        assert!(matches!(swapped, Err(Unsound::Turned { .. })), "a hole in the island: {swapped:?}");
    }
}
