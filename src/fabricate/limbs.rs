//! Limbs of ink that burn away: they change no count, and the part lacks them in the end.
//!
//! Where ink that matters is narrower than the kerf, the counts tell ([`super::kerf`]). A spike or a tendril that ends
//! blind matters to no count, and between two cuts it chars all the same. Such ink is what an opening by half of the kerf
//! takes away. An opening takes a little of every sharp tip too, which is as it should be: a tip is what ends within a few
//! kerfs. What is longer than a tip of any angle that ornaments have is refused; what is between the two burns away without
//! much harm, and is told.

use schemars::JsonSchema;
use serde::Serialize;

use crate::planar::{Grid, GridError, GridPoint, Part, Region};

/// What an opening takes in so many kerfs may be a tip: 20 is that of an angle of 3 degrees. Less, and ornaments with fine tips are
/// refused; more, and spikes pass.
const TIP_KERFS: f64 = 20.0;
/// What it takes in so many is not worth a word: 5 is the tip of an angle of 11 degrees.
const TOLD_KERFS: f64 = 5.0;
/// Chords of round joins are at most this part of the radius.
const ARC_PART: f64 = 0.002;

/// A limb narrower than the kerf. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct BurntLimb {
    /// On its outline, near its middle.
    pub position_mm: [f64; 2],
    /// Its area by its length.
    pub width_mm: f64,
    /// Half of the way around it.
    pub length_mm: f64,
}

/// The limbs of `ink` that a beam of width `kerf_mm` takes and that are longer than blunt tips, the longest first. They are
/// looked for on `grid`.
///
/// # Errors
/// [`GridError`] when the ink does not fit the grid.
pub fn burnt_limbs(
    ink: &Region,
    grid: Grid,
    kerf_mm: f64,
    chord_mm: f64,
) -> Result<Vec<BurntLimb>, GridError> {
    let mut limbs = thin_limbs(&ink.placed(grid, |p| p)?, kerf_mm, chord_mm);
    limbs.retain(|limb| limb.length_mm > TOLD_KERFS * kerf_mm);
    limbs.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm));
    Ok(limbs)
}

/// The longest limb of `ink` that a beam of width `kerf_mm` would take, if it is too long for a tip.
pub(super) fn refused_limb(ink: &Region, kerf_mm: f64, chord_mm: f64) -> Option<BurntLimb> {
    let limbs = thin_limbs(ink, kerf_mm, chord_mm).into_iter();
    let longest = limbs.max_by(|a, b| a.length_mm.total_cmp(&b.length_mm));
    longest.filter(|limb| limb.length_mm > TIP_KERFS * kerf_mm)
}

/// Tips and limbs of `ink` that a beam of width `kerf_mm` would take.
fn thin_limbs(ink: &Region, kerf_mm: f64, chord_mm: f64) -> Vec<BurntLimb> {
    let radius_mm = 0.5 * kerf_mm;
    let arc_mm = (0.25 * chord_mm).min(ARC_PART * radius_mm);
    // A chord more, or slivers of rounding would hang together all along the outline.
    let opened = ink.offset(-radius_mm, arc_mm).offset(radius_mm + chord_mm.min(0.1 * kerf_mm), arc_mm);
    let lost = ink.without(&opened);
    lost.parts().iter().map(|part| limb(&lost, part)).collect()
}

fn limb(lost: &Region, part: &Part) -> BurntLimb {
    let grid = lost.grid();
    let length = |(a, b): (GridPoint, GridPoint)| grid.to_mm(a).distance(grid.to_mm(b));
    let length_mm = 0.5 * part.contours().flat_map(|contour| contour.edges()).map(length).sum::<f64>();
    let area_mm2: f64 = part.contours().map(|contour| contour.area_mm2(grid)).sum();
    let (low, high) = part.exterior().bounds();
    let middle = grid.to_mm(low).midpoint(grid.to_mm(high));
    // Of a long straight edge no end is near the middle.
    let edges = part.exterior().edges().map(|(a, b)| [grid.to_mm(a), grid.to_mm(b)]);
    let nearest = edges.map(|[a, b]| {
        let t = (middle - a).dot(b - a) / (b - a).length_squared();
        a.lerp(b, t.clamp(0.0, 1.0))
    });
    let nearest = nearest.min_by(|a, b| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)));
    let position_mm = nearest.unwrap_or(middle).to_array();
    BurntLimb { position_mm, width_mm: area_mm2 / length_mm, length_mm }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::planar::FillRule;

    /// A plate of 30 by 10 mm with a spike of 20 mm upwards that is so wide at its foot and at its tip.
    fn spiked(foot: f64, tip: f64) -> Region {
        let grid = Grid::for_extent(100.0).unwrap();
        let spike = [(15.0 + 0.5 * foot, 10.0), (15.0 + 0.5 * tip, 30.0), (15.0 - 0.5 * tip, 30.0)];
        let mut path = vec![(0.0, 0.0), (30.0, 0.0), (30.0, 10.0)];
        path.extend(spike);
        path.extend([(15.0 - 0.5 * foot, 10.0), (0.0, 10.0)]);
        let path = path.into_iter().map(|p| grid.snap(DVec2::from(p)).unwrap()).collect();
        Region::fill(grid, &[path], FillRule::NonZero)
    }

    #[test]
    fn a_spike_narrower_than_the_kerf_is_a_limb() {
        let limb = refused_limb(&spiked(0.1, 0.1), 0.15, 0.01).unwrap();
        assert!((limb.width_mm - 0.1).abs() < 0.002 && (limb.length_mm - 20.0).abs() < 0.2, "{limb:?}");
        assert!(DVec2::from(limb.position_mm).distance(DVec2::new(15.0, 20.0)) < 0.1, "{limb:?}");
        assert_eq!(refused_limb(&spiked(0.1, 0.1), 0.09, 0.01), None);
    }

    #[test]
    fn a_tip_is_none() {
        // Of 4 mm at its foot it is narrower than the kerf in its last 0.75 mm.
        assert_eq!(refused_limb(&spiked(4.0, 0.001), 0.15, 0.01), None);
        // Of 0.3 mm at its foot, in its last 10 mm.
        let fine = refused_limb(&spiked(0.3, 0.001), 0.15, 0.01).unwrap();
        assert!((fine.length_mm - 10.0).abs() < 1.5, "{fine:?}");
    }

    #[test]
    fn short_limbs_are_told_and_tips_are_not() {
        let told = |region: &Region, kerf_mm| burnt_limbs(region, region.grid(), kerf_mm, 0.01).unwrap();
        // 20 mm are not 20 kerfs of 1.2 mm.
        let spike = spiked(1.0, 1.0);
        assert_eq!(refused_limb(&spike, 1.2, 0.01), None);
        let [limb] = told(&spike, 1.2)[..] else { panic!("there is one spike") };
        assert!((limb.length_mm - 20.0).abs() < 1.5 && (limb.width_mm - 1.0).abs() < 0.1, "{limb:?}");
        assert_eq!(told(&spike, 0.9), []);
        // Of 17 degrees.
        assert_eq!(told(&spiked(6.0, 0.001), 0.15), []);
    }
}
