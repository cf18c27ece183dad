//! Kerf compensation: contours moved so that the part has the drawn size after the beam has burnt its width away.
//!
//! The beam runs along a contour and takes half of the kerf on either side, so outer contours go out by that and
//! holes go in: the ink is dilated. That is done as an erosion of the gaps inside a frame, by exact offsets, and
//! what is left of the gaps is counted piece by piece: every gap must remain in one piece, as the beam has to pass
//! through it. Ink narrower than the kerf is refused too, as heat from both sides would take it. The first place
//! that fails is found by halving the radius until the change of the counts is caught in a thin residue. Excluded:
//! lead-ins, and what the beam leaves in sharp inner corners, which it rounds by half of the kerf.

use glam::DVec2;
use thiserror::Error;

use super::limbs::refused_limb;
use crate::planar::{Contour, FillRule, Grid, GridError, GridPoint, Part, Region, RegionError};

/// Room between the ink and the frame that bounds the gaps, in kerfs: less, and the frame would be in the way.
const FRAME_KERFS: f64 = 4.0;
/// Rounds of halving in the search for the place that fails first: the width is known to 1/256 of the kerf.
const ROUNDS: u32 = 8;
/// Residues that are tried out, the largest first. The place is nearly always the first; the rest are sharp tips.
const TRIED: usize = 40;
/// Edges shorter than this part of the chord error are left out. Less, and fitted curves meet bends that are none; more,
/// and the kerf is off by it.
const SHORTEST_PART: f64 = 0.01;
/// Chords of round joins are at most this part of the radius, as they make an offset too small.
const ARC_PART: f64 = 0.002;

/// Why a region cannot be compensated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KerfError {
    /// The kerf is no usable length.
    #[error("the kerf is {found_mm} mm; it must be from 0.001 to 10 mm (a laser's is about 0.1 to 0.3 mm)")]
    Range {
        /// What was given.
        found_mm: f64,
    },
    /// There is nothing to cut.
    #[error("there is nothing to cut: the region is empty")]
    Empty,
    /// A gap that the beam does not fit into.
    #[error(
        "at ({:.2}, {:.2}) mm a gap of {width_mm:.3} mm is narrower than the kerf of {kerf_mm} mm and cannot be \
         cut; widen it, scale the part up, or use a finer kerf", position_mm.x, position_mm.y
    )]
    Gap {
        /// The middle of the place, in millimetres.
        position_mm: DVec2,
        /// Its width.
        width_mm: f64,
        /// The kerf.
        kerf_mm: f64,
    },
    /// Ink that would burn away.
    #[error(
        "at ({:.2}, {:.2}) mm a feature of {width_mm:.3} mm is narrower than the kerf of {kerf_mm} mm and would \
         burn away; thicken it, scale the part up, or use a finer kerf", position_mm.x, position_mm.y
    )]
    Feature {
        /// The middle of the place, in millimetres.
        position_mm: DVec2,
        /// Its width.
        width_mm: f64,
        /// The kerf.
        kerf_mm: f64,
    },
    /// The compensated part is too large to compute with.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// Refuses a kerf that no beam has.
///
/// # Errors
/// [`KerfError::Range`].
pub fn check_kerf(kerf_mm: f64) -> Result<(), KerfError> {
    match (1e-3..=10.0).contains(&kerf_mm) {
        true => Ok(()),
        false => Err(KerfError::Range { found_mm: kerf_mm }),
    }
}

/// The region whose contours a beam of width `kerf_mm` has to follow so that `region` is left: the ink grown by
/// half of the kerf, with the same components and holes. Round corners are kept within `chord_mm`.
///
/// # Errors
/// [`KerfError::Gap`] and [`KerfError::Feature`] name the first place that is narrower than the kerf: where the counts
/// would change if gaps, or ink, lost half of it on either side, or where ink much longer than the kerf is wide would burn
/// away. Sharp tips and the ends of notches are none.
pub fn compensated(region: &Region, kerf_mm: f64, chord_mm: f64) -> Result<Region, KerfError> {
    check_kerf(kerf_mm)?;
    let (low, high) = region.bounds_mm().ok_or(KerfError::Empty)?;
    let radius_mm = 0.5 * kerf_mm;
    let margin = DVec2::splat(FRAME_KERFS * kerf_mm + chord_mm);
    let (low, high) = (low - margin, high + margin);
    // A part may come on the coarse grid of a mesh, on which an offset would be no smooth line.
    let grid = Grid::for_extent(low.abs().max(high.abs()).max_element())?;
    let ink = match grid == region.grid() {
        true => region.clone(),
        false => region.placed(grid, |p| p)?,
    };
    if eroded(&ink, radius_mm, chord_mm).is_none() {
        let (position_mm, width_mm) = first_loss(&ink, radius_mm, chord_mm);
        return Err(KerfError::Feature { position_mm, width_mm, kerf_mm });
    }
    if let Some(limb) = refused_limb(&ink, kerf_mm, chord_mm) {
        let (position_mm, width_mm) = (DVec2::from_array(limb.position_mm), limb.width_mm);
        return Err(KerfError::Feature { position_mm, width_mm, kerf_mm });
    }
    let frame = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let frame: Result<Vec<GridPoint>, GridError> = frame.into_iter().map(|p| grid.snap(p)).collect();
    let gaps = Region::fill(grid, &[frame?], FillRule::NonZero).without(&ink);
    let Some(pieces) = eroded(&gaps, radius_mm, chord_mm) else {
        let (position_mm, width_mm) = first_loss(&gaps, radius_mm, chord_mm);
        return Err(KerfError::Gap { position_mm, width_mm, kerf_mm });
    };
    match without_frame(grid, &pieces) {
        Ok(grown) => Ok(without_short_edges(grown, grid.steps(SHORTEST_PART * chord_mm))),
        Err(RegionError::Grid(error)) => Err(error.into()),
        Err(RegionError::Invalid { faults }) => unreachable!("pieces of a region are disjoint: {faults:?}"),
    }
}

/// What lies around disjoint gaps of which the one that holds the frame bounds all others.
fn without_frame(grid: Grid, gaps: &[Part]) -> Result<Region, RegionError> {
    let frame = gaps.iter().map(|part| part.exterior().doubled_area()).max();
    let contours = gaps.iter().flat_map(|part| {
        let is_frame = Some(part.exterior().doubled_area()) == frame;
        part.contours().skip(usize::from(is_frame))
    });
    Region::from_contours(grid, contours.map(reversed).collect())
}

/// The region without edges of so few steps, which offsets leave where arcs meet, if it is none the worse for it.
fn without_short_edges(region: Region, shortest: i64) -> Region {
    let cleaned = region.contours().map(|contour| {
        let mut path: Vec<GridPoint> = Vec::with_capacity(contour.points().len());
        for &p in contour.points() {
            let near = |q: &GridPoint| (p.x - q.x).abs().max((p.y - q.y).abs()) < shortest;
            if !path.last().is_some_and(near) && !path.first().is_some_and(near) {
                path.push(p);
            }
        }
        Contour::new(path)
    });
    let cleaned: Option<Vec<Contour>> = cleaned.collect();
    let counts = |region: &Region| (region.components(), region.holes());
    let cleaned = cleaned.and_then(|contours| Region::from_contours(region.grid(), contours).ok());
    cleaned.filter(|cleaned| counts(cleaned) == counts(&region)).unwrap_or(region)
}

/// The contour the other way round.
fn reversed(contour: &Contour) -> Contour {
    let points = contour.points().iter().rev().copied().collect();
    Contour::new(points).expect("a contour stays one, the other way round")
}

/// What erosion by `radius_mm` leaves of `ink`, if that is one piece of each component with as many holes.
/// Crumbs that vanish with `chord_mm` more are dropped, as the tip of a polygon that stands for a cusp does not
/// narrow evenly.
fn eroded(ink: &Region, radius_mm: f64, chord_mm: f64) -> Option<Vec<Part>> {
    let arc_mm = (0.25 * chord_mm).min(ARC_PART * radius_mm);
    let left = ink.offset(-radius_mm, arc_mm);
    let mut of_each: Vec<Vec<&Part>> = vec![Vec::new(); ink.components()];
    for piece in left.parts() {
        of_each[home(ink.parts(), piece)?].push(piece);
    }
    if of_each.iter().any(|of| of.len() > 1) {
        let core = ink.offset(-radius_mm - chord_mm, arc_mm);
        let lasting: Vec<usize> = core.parts().iter().filter_map(|part| home(left.parts(), part)).collect();
        let lasts = |piece: &Part| lasting.iter().any(|&i| left.parts()[i] == *piece);
        of_each.iter_mut().filter(|of| of.len() > 1).for_each(|of| of.retain(|piece| lasts(piece)));
    }
    let kept = of_each.iter().zip(ink.parts()).map(|(of, whole)| match of[..] {
        [piece] if piece.holes().len() == whole.holes().len() => Some(piece.clone()),
        _ => None,
    });
    kept.collect()
}

/// Which of the parts holds `piece`, which lies inside of one of them.
fn home(parts: &[Part], piece: &Part) -> Option<usize> {
    let p = piece.exterior().points()[0];
    parts.iter().position(|part| part.covers(p))
}

/// Where erosion changes the counts of `ink` first, and how wide the ink is there. It must do so at `radius_mm`.
fn first_loss(ink: &Region, radius_mm: f64, chord_mm: f64) -> (DVec2, f64) {
    // A chord larger than the radius would hide everything that is narrower.
    let chord_mm = chord_mm.min(0.1 * radius_mm);
    let (mut kept_mm, mut lost_mm) = (0.0, radius_mm);
    for _ in 0..ROUNDS {
        let middle_mm = 0.5 * (kept_mm + lost_mm);
        match eroded(ink, middle_mm, chord_mm) {
            Some(_) => kept_mm = middle_mm,
            None => lost_mm = middle_mm,
        }
    }
    // Between the two radii the ink loses a skin, and what is no wider than that skin: necks, walls and tips.
    let arc_mm = ARC_PART * radius_mm;
    let before = if kept_mm > 0.0 { ink.offset(-kept_mm, arc_mm) } else { ink.clone() };
    let after = ink.offset(-lost_mm, arc_mm);
    let residue = before.without(&after.offset(1.01 * (lost_mm - kept_mm), arc_mm));
    let extent = |part: &Part| {
        let (low, high) = part.exterior().bounds();
        (high.x - low.x).max(high.y - low.y)
    };
    let mut places: Vec<&Part> = residue.parts().iter().collect();
    places.sort_by_key(|part| std::cmp::Reverse(extent(part)));
    let counts = |region: &Region| (region.components(), region.holes());
    let changes = |place: &&&Part| {
        let alone = Region::from_contours(ink.grid(), place.contours().cloned().collect());
        alone.is_ok_and(|alone| counts(&before.without(&alone)) != counts(&before))
    };
    let found = places.iter().take(TRIED).find(changes).or(places.first()).copied();
    let place = found.or(before.parts().first()).or(ink.parts().first()).expect("there is ink to lose");
    let (low, high) = place.exterior().bounds();
    (0.5 * (ink.grid().to_mm(low) + ink.grid().to_mm(high)), 2.0 * lost_mm)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::planar::{EdgeIndex, boxes};

    const CHORD: f64 = 0.01;

    /// Boxes of a corner, a width and a height in millimetres.
    fn region(of: &[(i64, i64, i64, i64)]) -> Region {
        // The grid for 100 mm has 2^26 steps to the millimetre.
        boxes(1 << 26, FillRule::EvenOdd, of)
    }

    /// The same with units of 0.01 mm.
    fn fine(of: &[(i64, i64, i64, i64)]) -> Region {
        boxes(671_089, FillRule::EvenOdd, of)
    }

    fn counts(region: &Region) -> (usize, usize) {
        (region.components(), region.holes())
    }

    #[test]
    fn outer_contours_go_out_and_holes_in_by_half() {
        let frame = region(&[(10, 10, 30, 20), (15, 15, 10, 10)]);
        let cut = compensated(&frame, 0.2, CHORD).unwrap();
        assert_eq!(counts(&cut), (1, 1));
        let (low, high) = cut.bounds_mm().unwrap();
        assert!(low.distance(DVec2::splat(9.9)) < 1e-6 && high.distance(DVec2::new(40.1, 30.1)) < 1e-6);
        let hole = cut.parts()[0].holes()[0].area_mm2(cut.grid());
        assert!((hole + 9.8 * 9.8).abs() < 1e-4, "{hole}");
    }

    #[test]
    fn a_gap_narrower_than_the_kerf_is_named_with_its_place() {
        // Two plates with 0.12 mm between them, from (20, 10) to (20.12, 12), and wider gaps elsewhere.
        let near = fine(&[(1000, 1000, 1000, 200), (2012, 1000, 1000, 200), (1000, 1300, 500, 100)]);
        let KerfError::Gap { position_mm, width_mm, .. } = compensated(&near, 0.15, CHORD).unwrap_err()
        else {
            panic!("the gap is the fault")
        };
        assert!((width_mm - 0.12).abs() < 0.002, "{width_mm}");
        assert!(
            (position_mm.x - 20.06).abs() < 0.02 && (10.0..=12.0).contains(&position_mm.y),
            "{position_mm}"
        );
        assert_eq!(counts(&compensated(&near, 0.11, CHORD).unwrap()), (3, 0));
    }

    #[test]
    fn a_feature_narrower_than_the_kerf_is_named_with_its_place() {
        // A bar 0.1 mm high between two plates.
        let bar = fine(&[(0, 0, 500, 500), (500, 200, 500, 10), (1000, 0, 500, 500)]);
        let error = compensated(&bar, 0.15, CHORD).unwrap_err();
        let KerfError::Feature { position_mm, width_mm, .. } = error else { panic!("{error}") };
        assert!((width_mm - 0.1).abs() < 0.002 && (5.0..=10.0).contains(&position_mm.x), "{error}");
        assert!((position_mm.y - 2.05).abs() < 0.02, "{position_mm}");
        assert!(error.to_string().contains("mm a feature of 0.100 mm is narrower than the kerf of 0.15 mm"));
    }

    #[test]
    fn a_kerf_wider_than_the_part_or_no_length_is_refused() {
        let square = region(&[(10, 10, 2, 2)]);
        let error = compensated(&square, 3.0, CHORD).unwrap_err();
        assert!(
            matches!(error, KerfError::Feature { width_mm, .. } if (width_mm - 2.0).abs() < 0.02),
            "{error}"
        );
        for kerf_mm in [0.0, -0.1, f64::NAN, 11.0] {
            assert!(matches!(compensated(&square, kerf_mm, CHORD), Err(KerfError::Range { .. })));
        }
        let nothing = Region::empty(Grid::for_extent(10.0).unwrap());
        assert_eq!(compensated(&nothing, 0.1, CHORD), Err(KerfError::Empty));
    }

    #[test]
    fn the_mouth_of_a_bay_must_let_the_beam_through() {
        // A flask: a chamber of 3 by 3 mm that is open through a neck 0.1 mm wide.
        let flask = fine(&[(0, 0, 500, 500), (100, 100, 300, 300), (245, 400, 10, 100)]);
        assert_eq!(counts(&flask), (1, 0));
        let error = compensated(&flask, 0.15, CHORD).unwrap_err();
        assert!(
            matches!(error, KerfError::Gap { position_mm, .. } if position_mm.distance(DVec2::new(2.5, 4.5)) < 0.6),
            "{error}"
        );
    }

    #[test]
    fn the_end_of_a_notch_is_no_gap() {
        let notch =
            [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (10.2, 10.0), (10.0, 2.0), (9.8, 10.0), (0.0, 10.0)];
        let grid = Grid::for_extent(100.0).unwrap();
        let path = notch.map(|p| grid.snap(DVec2::from(p)).unwrap()).to_vec();
        let notched = Region::fill(grid, &[path], FillRule::NonZero);
        assert_eq!(counts(&compensated(&notched, 0.15, CHORD).unwrap()), (1, 0));
    }

    /// The greatest distance of a vertex of `a` from the boundary of `b`.
    fn distance(a: &Region, b: &Region) -> f64 {
        let index = EdgeIndex::new(b);
        let points = a.contours().flat_map(Contour::points).map(|&p| a.grid().to_mm(p));
        points.map(|p| index.nearest(p).unwrap().nearest(p).distance(p)).fold(0.0, f64::max)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        /// Out by half of the kerf and in again rounds inner corners with the beam's radius r and leaves the rest.
        /// At a right angle an arc of radius r stays within (√2 − 1) r of the corner, and a chord within its error.
        #[test]
        fn kerf_out_and_in_gives_the_shape(
            boxes in prop::collection::vec((0i64..60, 0i64..60, 1i64..20, 1i64..20), 1..9),
            kerf_mm in 0.02..1.2f64,
        ) {
            let shape = region(&boxes);
            prop_assume!(!shape.is_empty());
            // Contours that meet in a corner were pulled apart by less than any kerf.
            match compensated(&shape, kerf_mm, CHORD) {
                Ok(cut) => {
                    prop_assert_eq!(counts(&cut), counts(&shape));
                    let back = cut.offset(-0.5 * kerf_mm, 0.25 * CHORD);
                    prop_assert_eq!(counts(&back), counts(&shape));
                    let allowed = (2f64.sqrt() - 1.0) * 0.5 * kerf_mm + CHORD;
                    prop_assert!(distance(&back, &shape) <= allowed);
                    prop_assert!(distance(&shape, &back) <= allowed);
                    // The beam leaves at least the shape: the symmetric difference is what it cannot reach.
                    let lost = shape.without(&back.placed(shape.grid(), |p| p).unwrap());
                    prop_assert!(lost.area_mm2() <= 0.1 * CHORD * shape.vertices() as f64, "{}", lost.area_mm2());
                    let corner = (1.0 - std::f64::consts::FRAC_PI_4) * 0.25 * kerf_mm * kerf_mm;
                    let grown = back.area_mm2() - shape.area_mm2();
                    prop_assert!(grown <= shape.vertices() as f64 * (corner + CHORD * kerf_mm));
                }
                Err(KerfError::Gap { width_mm, .. } | KerfError::Feature { width_mm, .. }) => {
                    prop_assert!(width_mm <= kerf_mm * 1.0001);
                }
                Err(error) => prop_assert!(false, "{}", error),
            }
        }
    }
}
