//! Why a curve in space makes no band.

use glam::DVec3;
use thiserror::Error;

/// Why there is no band along a curve in space. Positions are in millimetres.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SpaceError {
    /// The radius of a ring or helix is no length, or makes none.
    #[error(
        "a ring or helix with a radius of {radius_mm} mm cannot be made; use a diameter from 0.1 mm to 4 m"
    )]
    Radius {
        /// The radius of the middle of the thickness.
        radius_mm: f64,
    },
    /// The gap of a cuff.
    #[error(
        "a gap of {gap_mm} mm does not fit a ring of {most_mm} mm inside; it must be more than 0 and less than that"
    )]
    Gap {
        /// What was asked for.
        gap_mm: f64,
        /// The inner diameter.
        most_mm: f64,
    },
    /// The turns or the pitch of a helix.
    #[error("{turns} turns with a pitch of {pitch_mm} mm make no helix; use more than 0 turns, up to 10000")]
    Turns {
        /// How often it goes round.
        turns: f64,
        /// By how much it rises each time.
        pitch_mm: f64,
    },
    /// The curve is too long.
    #[error("the curve is {:.1} m long, and at most {:.0} m can be made; use fewer turns", length_mm / 1000.0, most_mm / 1000.0)]
    Length {
        /// Its length.
        length_mm: f64,
        /// The greatest.
        most_mm: f64,
    },
    /// A place of a twist is beyond the end of the curve.
    #[error(
        "the twist has a place at {place_mm} mm, but the curve is {length_mm:.2} mm long; use places up to that"
    )]
    TwistPlace {
        /// The place.
        place_mm: f64,
        /// The length of the curve.
        length_mm: f64,
    },
    /// Too few points.
    #[error("{found} point(s) make no curve; at least {wanted} that lie apart are needed")]
    Points {
        /// How many there are.
        found: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// A point is not a place.
    #[error(
        "point {number} is not a place within 2 m of the origin, which is as far as the numbers of mesh files are fine enough; move the curve nearer"
    )]
    Coordinates {
        /// Which, from 1.
        number: usize,
    },
    /// Two points in a row are the same.
    #[error("point {number} and the next one are both at ({:.3}, {:.3}, {:.3}) mm; leave one of them out", position.x, position.y, position.z)]
    Twice {
        /// The first of them, from 1.
        number: usize,
        /// Where.
        position: DVec3,
    },
    /// The curve turns on the spot.
    #[error(
        "the curve has a cusp at ({:.3}, {:.3}, {:.3}) mm, {at_mm:.2} mm along it, where it turns back on the spot; spread the points there, or add some so that it turns in an arc",
        position.x, position.y, position.z
    )]
    Cusp {
        /// Where.
        position: DVec3,
        /// Where along the curve.
        at_mm: f64,
    },
    /// A curve on a model cannot be sampled.
    #[error(
        "a curve of {length_mm:.3} mm on a model cannot be smoothed over {spacing_mm} mm; use more than 0 mm, and at most a twelfth of its length"
    )]
    Spacing {
        /// Over what length it was to be smoothed.
        spacing_mm: f64,
        /// Its length.
        length_mm: f64,
    },
    /// A model turns over under its curve.
    #[error(
        "the model turns over an edge at ({:.3}, {:.3}, {:.3}) mm, {at_mm:.2} mm along the curve, and a band cannot; move the curve away from it, or round the edge",
        position.x, position.y, position.z
    )]
    Edge {
        /// Where.
        position: DVec3,
        /// Where along the curve.
        at_mm: f64,
    },
    /// A closed curve that comes back turned.
    #[error("a twist of {by_deg} degrees does not close; along a closed curve it must be a multiple of 360")]
    Twist {
        /// By how much in all.
        by_deg: f64,
    },
    /// The band folds.
    #[error(
        "the band folds at ({:.2}, {:.2}, {:.2}) mm, {at_mm:.2} mm along the curve: it reaches {reach_mm:.2} mm towards the inside of a bend of {radius_mm:.2} mm radius, and at most {:.2} mm fit; use a narrower --width, a smaller --thickness, or a gentler curve",
        position.x, position.y, position.z, allowed_mm
    )]
    Fold {
        /// Where.
        position: DVec3,
        /// Where along the curve.
        at_mm: f64,
        /// How far the band reaches towards the centre of the bend.
        reach_mm: f64,
        /// The radius of the bend.
        radius_mm: f64,
        /// How far it may reach.
        allowed_mm: f64,
    },
    /// The relief is too steep.
    #[error(
        "the relief rises by {degrees:.0} degrees at ({:.2}, {:.2}, {:.2}) mm, where the sheet would be less than half as thick; 60 degrees are the most, so make it lower or smoother",
        position.x, position.y, position.z
    )]
    Steep {
        /// Where.
        position: DVec3,
        /// How steep.
        degrees: f64,
    },
    /// The band meets itself.
    #[error(
        "the band {} itself at ({:.2}, {:.2}, {:.2}) mm: {:.1} mm and {:.1} mm along the curve; use a narrower --width, a smaller --thickness, a greater pitch, or move the curve apart",
        met(*gap_mm), position.x, position.y, position.z, at_mm[0], at_mm[1]
    )]
    Contact {
        /// Where.
        position: DVec3,
        /// The two places along the curve.
        at_mm: [f64; 2],
        /// How far they have to be apart, if they may not only not meet.
        gap_mm: f64,
    },
}

fn met(gap_mm: f64) -> String {
    match gap_mm > 0.0 {
        true => format!("comes within {gap_mm} mm, the minimum gap, of"),
        false => "meets".to_owned(),
    }
}
