//! Limbs of ink that burn away: they change no count, and the part lacks them in the end.
//!
//! Where ink that matters is narrower than the kerf, the counts tell ([`super::kerf`]). A spike or a tendril that ends
//! blind matters to no count, and between two cuts it chars all the same. Such ink is what an opening by half of the kerf
//! takes away. An opening takes a little of every sharp tip too, which is as it should be: a tip is what ends within a few
//! kerfs, and only what is longer is a limb.

use glam::DVec2;

use super::kerf::difference;
use crate::planar::{GridPoint, Part, Region};

/// What an opening takes in so many kerfs is a tip: 20 is that of an angle of 3 degrees. Less, and ornaments with fine tips are
/// refused; more, and spikes pass.
const TIP_KERFS: f64 = 20.0;
/// Chords of round joins are at most this part of the radius.
const ARC_PART: f64 = 0.002;

/// A limb narrower than the kerf. Lengths are millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limb {
    /// On its outline, near its middle.
    pub(super) position_mm: DVec2,
    /// Its area by its length.
    pub(super) width_mm: f64,
    /// Half of the way around it.
    pub(super) length_mm: f64,
}

/// The longest limb of `ink` that a beam of width `kerf_mm` would take, if there is one.
pub(super) fn thin_limb(ink: &Region, kerf_mm: f64, chord_mm: f64) -> Option<Limb> {
    let radius_mm = 0.5 * kerf_mm;
    let arc_mm = (0.25 * chord_mm).min(ARC_PART * radius_mm);
    // A chord more, or slivers of rounding would hang together all along the outline.
    let opened = ink.offset(-radius_mm, arc_mm).offset(radius_mm + chord_mm.min(0.1 * kerf_mm), arc_mm);
    let lost = difference(ink, &opened);
    let limbs = lost.parts().iter().map(|part| limb(&lost, part));
    let longest = limbs.max_by(|a, b| a.length_mm.total_cmp(&b.length_mm));
    longest.filter(|limb| limb.length_mm > TIP_KERFS * kerf_mm)
}

fn limb(lost: &Region, part: &Part) -> Limb {
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
    Limb { position_mm: nearest.unwrap_or(middle), width_mm: area_mm2 / length_mm, length_mm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planar::{FillRule, Grid};

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
        let limb = thin_limb(&spiked(0.1, 0.1), 0.15, 0.01).unwrap();
        assert!((limb.width_mm - 0.1).abs() < 0.002 && (limb.length_mm - 20.0).abs() < 0.2, "{limb:?}");
        assert!(limb.position_mm.distance(DVec2::new(15.0, 20.0)) < 0.1, "{limb:?}");
        assert_eq!(thin_limb(&spiked(0.1, 0.1), 0.09, 0.01), None);
    }

    #[test]
    fn a_tip_is_none() {
        // Of 4 mm at its foot it is narrower than the kerf in its last 0.75 mm.
        assert_eq!(thin_limb(&spiked(4.0, 0.001), 0.15, 0.01), None);
        // Of 0.3 mm at its foot, in its last 10 mm.
        let fine = thin_limb(&spiked(0.3, 0.001), 0.15, 0.01).unwrap();
        assert!((fine.length_mm - 10.0).abs() < 1.5, "{fine:?}");
    }
}
