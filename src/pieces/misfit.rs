//! How badly the worst strand of a join fits.
//!
//! The cost of Zhou 2014 §3.6.1 is a mean: of two dozen strands, one that is joined to another three widths away from
//! it hardly counts, and yet it is what everyone sees: the seam shears it into a sliver. The misfit is that of the
//! worst strand, in measures of the strand itself. Excluded: what it costs, and which misfits are accepted at all
//! ([`super::CostWeights`]).

use std::f64::consts::FRAC_PI_2;

use super::piece::Endpoint;

/// The misfit of the worst portal where `right` meets `left`, as they lie; both from the top. It is 0 where every
/// strand goes straight on, and 1 where one lies beside the other by the width of the narrower, is twice as wide, or
/// turns by 90 degrees.
pub(super) fn misfit(right: &[Endpoint], left: &[Endpoint]) -> f64 {
    let portals = right.chunks_exact(2).zip(left.chunks_exact(2));
    portals.map(|(r, l)| of_portal(r, l)).fold(0.0, f64::max)
}

fn of_portal(right: &[Endpoint], left: &[Endpoint]) -> f64 {
    let width_mm = |side: &[Endpoint]| side[0].y_mm - side[1].y_mm;
    let middle_mm = |side: &[Endpoint]| (side[0].y_mm + side[1].y_mm) / 2.0;
    let narrow_mm = width_mm(right).min(width_mm(left)).max(f64::MIN_POSITIVE);
    let beside = (middle_mm(right) - middle_mm(left)).abs() / narrow_mm;
    let wider = width_mm(right).max(width_mm(left)) / narrow_mm - 1.0;
    // A leaf that narrows to its tip goes on straight if its middle does.
    let along = |side: &[Endpoint]| (side[0].tangent.to_angle() + side[1].tangent.to_angle()) / 2.0;
    let turned = (along(right) - along(left)).abs() / FRAC_PI_2;
    beside.max(wider).max(turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn side(ys: &[f64], degrees: f64) -> Vec<Endpoint> {
        let tangent = DVec2::from_angle(degrees.to_radians());
        ys.iter().map(|&y_mm| Endpoint { y_mm, tangent }).collect()
    }

    #[test]
    fn the_worst_strand_counts_by_its_own_width() {
        let right = side(&[9.0, 7.0, 2.0, 1.0], 0.0);
        let close = |left: &[Endpoint], wanted: f64| (misfit(&right, left) - wanted).abs() < 1e-12;
        assert!(close(&right, 0.0));
        assert!(close(&side(&[9.5, 7.5, 2.0, 1.0], 0.0), 0.25));
        assert!(close(&side(&[9.5, 7.5, 3.5, 2.5], 0.0), 1.5), "beside it");
        assert!(close(&side(&[9.0, 7.0, 3.0, 0.0], 0.0), 2.0), "three times as wide");
        assert!(close(&side(&[9.0, 7.0, 2.0, 1.0], -45.0), 0.5), "turned");
        assert_eq!(misfit(&[], &[]), 0.0);
    }
}
