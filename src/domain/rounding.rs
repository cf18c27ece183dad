//! Corners rounded, and what only looks like a corner eased.
//!
//! Every joint is mended in one way: a stretch around it is replaced by the biarc between the tangents at its
//! ends, so the result is smooth. Between two straight lines that is the arc of a circle.

use super::arc::Arc;
use super::chain::{Chain, Cut, Joint};
use super::error::DomainError;

/// A joint that turns by more than this is a corner of the drawing: 1 degree. Larger, and drawn corners are
/// lost; smaller, and the rounding of coordinates in a file makes corners.
const CORNER_RAD: f64 = std::f64::consts::PI / 180.0;
/// A joint that turns by less than this needs no mending: 1 nm at 10 mm from the curve.
const SMOOTH_RAD: f64 = 1e-7;
/// How far easing reaches from a joint. Larger, and it moves the curve visibly (by 0.003 mm for one degree);
/// smaller, and the bend that it makes is too tight for a wide band.
const EASE_MM: f64 = 0.25;
/// Where the curve bends tighter than this radius but hardly turns, it is eased: a control point that sits on
/// its end point makes such a spike of curvature.
const SPIKE_RADIUS_MM: f64 = 2.0;
/// What "hardly turns" is, over the eased stretch.
const SPIKE_TURN_RAD: f64 = 0.1;
/// A corner of at most this turn is eased where that is gentler than its rounding: 10 degrees. Short lines that
/// stand for a curve meet in such corners, and the small radius would bend the band there.
const GENTLE_RAD: f64 = std::f64::consts::PI / 18.0;
/// How much closer a rounding comes to the corner's neighbours at each try.
const GROWTH: f64 = 1.05;

/// The chain without jumps of direction, when it has no corner.
///
/// # Errors
/// [`DomainError::Corner`] names the first corner.
pub(super) fn eased(chain: &Chain) -> Result<Chain, DomainError> {
    let corners = chain.joints(CORNER_RAD);
    if let Some(corner) = corners.first() {
        return Err(DomainError::Corner {
            position: chain.point(corner.at),
            at_mm: corner.at,
            turn_deg: corner.turn.to_degrees(),
            more: corners.len() - 1,
        });
    }
    let joints = chain.joints(SMOOTH_RAD);
    let rooms = rooms(chain, &joints);
    let cuts: Vec<Cut> = joints
        .iter()
        .zip(rooms)
        .map(|(j, room)| {
            let reach = ease_reach(room);
            Cut { from: j.at - reach, to: j.at + reach }
        })
        .collect();
    let smooth = chain.bridged(&within(chain, cuts));
    Ok(smooth.bridged(&spikes(&smooth)))
}

/// The chain with each corner replaced by arcs of at least `radius_mm`; between straight lines that turn by
/// more than [`GENTLE_RAD`], of exactly that radius.
///
/// # Errors
/// [`DomainError::RoundRadius`] and [`DomainError::Rounding`].
pub(super) fn rounded(chain: &Chain, radius_mm: f64) -> Result<Chain, DomainError> {
    if !(radius_mm > 0.0 && radius_mm.is_finite()) {
        return Err(DomainError::RoundRadius { radius_mm });
    }
    let corners = chain.joints(CORNER_RAD);
    let rooms = rooms(chain, &corners);
    let refuse = |corner: &Joint, room_mm| DomainError::Rounding {
        position: chain.point(corner.at),
        turn_deg: corner.turn.to_degrees(),
        radius_mm,
        room_mm,
    };
    let mut cuts: Vec<Cut> = Vec::with_capacity(corners.len());
    for (corner, &room) in corners.iter().zip(&rooms) {
        // A sharp corner between curves opens on the way out: begin lower than the tangent says.
        let mut reach = radius_mm * (0.5 * corner.turn.abs()).tan().min(4.0);
        if corner.turn.abs() <= GENTLE_RAD {
            reach = reach.max(ease_reach(room));
        }
        let cut = loop {
            if reach > room {
                return Err(refuse(corner, room));
            }
            let cut = Cut { from: corner.at - reach, to: corner.at + reach };
            if chain.bridge(cut).iter().all(|arc| arc.curvature.abs() * radius_mm <= 1.0 + 1e-6) {
                break cut;
            }
            reach *= GROWTH;
        };
        if let Some(previous) = cuts.last().filter(|c| c.to > cut.from) {
            return Err(refuse(corner, room - (previous.to - cut.from)));
        }
        cuts.push(cut);
    }
    // At the seam of a closed chain the last rounding meets the first one.
    if let (true, Some(first), Some(last)) = (chain.is_closed(), cuts.first(), cuts.last()) {
        let overlap = last.to - (first.from + chain.length());
        if overlap > 0.0 {
            return Err(refuse(&corners[0], rooms[0] - overlap));
        }
    }
    Ok(chain.bridged(&within(chain, cuts)))
}

/// How far easing reaches from a joint with this much room: less than half of it, so that something of the
/// drawing is left between two joints.
fn ease_reach(room: f64) -> f64 {
    EASE_MM.min(0.45 * room)
}

/// For each joint the distance to its nearest neighbour or to the end of an open chain, whichever is less.
fn rooms(chain: &Chain, joints: &[Joint]) -> Vec<f64> {
    let n = joints.len();
    let gap_after = |i: usize| match joints.get(i + 1) {
        Some(next) => next.at - joints[i].at,
        None if chain.is_closed() => joints[0].at + chain.length() - joints[i].at,
        None => chain.length() - joints[i].at,
    };
    let gap_before = |i: usize| match i.checked_sub(1) {
        Some(before) => gap_after(before),
        None if chain.is_closed() => gap_after(n - 1),
        None => joints[0].at,
    };
    (0..n).map(|i| gap_before(i).min(gap_after(i))).collect()
}

/// Stretches of the chain where it bends tightly and hardly turns.
fn spikes(chain: &Chain) -> Vec<Cut> {
    let tight = |arc: &Arc| arc.curvature.abs() * SPIKE_RADIUS_MM > 1.0;
    let mut cuts: Vec<Cut> = Vec::new();
    for (start, arc) in chain.located_arcs().filter(|(_, arc)| tight(arc)) {
        let cut = Cut { from: start - EASE_MM, to: start + arc.length + EASE_MM };
        match cuts.last_mut() {
            Some(last) if last.to >= cut.from => last.to = cut.to,
            _ => cuts.push(cut),
        }
    }
    cuts.retain(|cut| cut.to - cut.from < 0.5 * chain.length());
    let mut cuts = within(chain, cuts);
    cuts.retain(|&cut| chain.turn_within(cut) <= SPIKE_TURN_RAD);
    cuts
}

/// Cuts in order with those that reach past an end clipped (open) or moved to the start (closed), where they
/// are merged with what they meet.
fn within(chain: &Chain, mut cuts: Vec<Cut>) -> Vec<Cut> {
    let length = chain.length();
    if !chain.is_closed() {
        for cut in &mut cuts {
            *cut = Cut { from: cut.from.max(0.0), to: cut.to.min(length) };
        }
        return cuts;
    }
    while let Some(&last) = cuts.last() {
        let around = Cut { from: last.from - length, to: last.to - length };
        let first = cuts[0];
        if cuts.len() > 1 && first.from < 0.0 && around.to > first.from {
            cuts.pop();
            cuts[0] = Cut { from: around.from.min(first.from), to: first.to.max(around.to) };
        } else if around.to > 0.0 {
            cuts.pop();
            cuts.insert(0, around);
        } else {
            break;
        }
    }
    // What was moved may now meet the next one.
    while cuts.len() > 1 && cuts[0].to > cuts[1].from {
        let second = cuts.remove(1);
        cuts[0].to = cuts[0].to.max(second.to);
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::path::chain_of;
    use kurbo::BezPath;

    fn chain(svg: &str) -> Chain {
        chain_of(&BezPath::from_svg(svg).unwrap()).unwrap()
    }

    fn tightest_radius(chain: &Chain) -> f64 {
        chain.located_arcs().map(|(_, arc)| arc.curvature.abs().recip()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_rounded_square_has_the_radius_and_length() {
        let square = chain("M0 0 H20 V20 H0 Z");
        let round = rounded(&square, 3.0).unwrap();
        assert_eq!(round.joints(1e-9), []);
        assert!((tightest_radius(&round) - 3.0).abs() < 1e-9);
        let expected = 4.0 * 14.0 + std::f64::consts::TAU * 3.0;
        assert!((round.length() - expected).abs() < 1e-9, "{}", round.length());
    }

    #[test]
    fn roundings_may_use_the_whole_side_and_no_more() {
        let square = chain("M0 0 H20 V20 H0 Z");
        let circle = rounded(&square, 10.0 - 1e-9).unwrap();
        assert!((circle.length() - std::f64::consts::TAU * 10.0).abs() < 1e-6);
        let message = rounded(&square, 10.5).unwrap_err().to_string();
        assert!(message.contains("corner of -90.0 degrees at (0.000, 20.000) mm"), "{message}");
        assert!(message.contains("radius of 10.5 mm"), "{message}");
        for radius_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(rounded(&square, radius_mm), Err(DomainError::RoundRadius { .. })));
        }
    }

    #[test]
    fn corners_between_curves_get_at_least_the_radius() {
        let heart = chain(
            "M100 50 C80 0 10 5 10 65 C10 115 65 140 100 185 C135 140 190 115 190 65 C190 5 120 0 100 50 Z",
        );
        assert_eq!(heart.joints(0.1).len(), 2);
        let round = rounded(&heart, 6.0).unwrap();
        assert_eq!(round.joints(1e-6), []);
        assert!(tightest_radius(&round) >= 6.0 - 1e-4, "{}", tightest_radius(&round));
    }

    #[test]
    fn the_first_corner_is_named() {
        let DomainError::Corner { position, at_mm, turn_deg, more } =
            eased(&chain("M0 0 H20 V20 H40")).unwrap_err()
        else {
            panic!("a corner is refused as one")
        };
        assert!((position - glam::DVec2::new(20.0, 0.0)).length() < 1e-9);
        assert!((at_mm - 20.0).abs() < 1e-9 && (turn_deg - 90.0).abs() < 1e-9);
        assert_eq!(more, 1);
    }

    #[test]
    fn small_bends_are_eased_within_the_promise() {
        let bent = chain("M0 0 L10 0 L20 0.15");
        let smooth = eased(&bent).unwrap();
        assert_eq!(smooth.joints(1e-12), []);
        assert!(tightest_radius(&smooth) > 10.0);
        let middle = smooth.point(10.0);
        assert!(middle.y.abs() < 0.003 && (middle.x - 10.0).abs() < 0.003, "{middle}");
    }

    #[test]
    fn many_short_lines_bend_as_the_circle_they_stand_for() {
        let points: Vec<String> = (0..720)
            .map(|i| (f64::from(i) * 0.5).to_radians())
            .map(|a| format!("{:.5} {:.5}", 10.0 * a.cos(), 10.0 * a.sin()))
            .collect();
        let smooth = eased(&chain(&format!("M{} Z", points.join("L")))).unwrap();
        assert_eq!(smooth.joints(1e-9), []);
        assert!((smooth.length() - std::f64::consts::TAU * 10.0).abs() < 0.01);
        assert!(tightest_radius(&smooth) > 8.0, "{}", tightest_radius(&smooth));
    }

    #[test]
    fn short_lines_that_stand_for_a_circle_can_be_rounded() {
        let points: Vec<String> = (0..72)
            .map(|i| (f64::from(i) * 5.0).to_radians())
            .map(|a| format!("{:.4} {:.4}", 5.0 * a.cos(), 5.0 * a.sin()))
            .collect();
        let polygon = chain(&format!("M{} Z", points.join("L")));
        assert!(matches!(eased(&polygon), Err(DomainError::Corner { more: 71, .. })));
        let smooth = eased(&rounded(&polygon, 1.0).unwrap()).unwrap();
        assert!(tightest_radius(&smooth) > 4.0, "{}", tightest_radius(&smooth));
    }

    #[test]
    fn a_control_point_on_its_end_point_makes_no_spike() {
        for svg in ["M0 0 C0 0 30 25 60 0", "M-40 -16 C-20 -16 -8 -8 0 0 C0 0 20 20 60 30"] {
            let sharp = chain(svg);
            assert!(tightest_radius(&sharp) < 2.0, "{}", tightest_radius(&sharp));
            let smooth = eased(&sharp).unwrap();
            assert!(tightest_radius(&smooth) > 2.0, "{}", tightest_radius(&smooth));
            assert_eq!(smooth.joints(1e-6), []);
            assert!((smooth.length() - sharp.length()).abs() < 0.01);
        }
    }
}
