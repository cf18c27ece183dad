//! Why a curve or a width makes no band.

use glam::DVec2;
use thiserror::Error;

use super::squeeze::Side;
use crate::planar::GridError;

/// Why there is no band. Positions are in millimetres, y up, in the coordinates of the curve that was given.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DomainError {
    /// The path has no segment.
    #[error("the path draws nothing; a band needs a path with at least one segment")]
    Empty,
    /// The path has several subpaths.
    #[error("the path has {count} subpaths; a band follows one: split the path and name the part to follow")]
    Subpaths {
        /// How many subpaths have a segment.
        count: usize,
    },
    /// A coordinate is not a number, or further out than can be computed with.
    #[error("the curve cannot be used: {0}")]
    Coordinates(#[from] GridError),
    /// The curve has no length to speak of.
    #[error("the curve is {length_mm} mm long; a band needs at least {minimum_mm} mm")]
    TooShort {
        /// The length found, in millimetres.
        length_mm: f64,
        /// The least length that is accepted, in millimetres.
        minimum_mm: f64,
    },
    /// The tangent turns at one point.
    #[error(
        "the curve has a corner of {turn_deg:.1} degrees at ({:.3}, {:.3}) mm, {at_mm:.3} mm along it{}; a band cannot turn a corner: round it in the drawing or pass --round RADIUS",
        position.x, position.y, others(*more)
    )]
    Corner {
        /// Where.
        position: DVec2,
        /// Where along the curve, in millimetres.
        at_mm: f64,
        /// By how much the direction of travel turns, in degrees, positive to the left.
        turn_deg: f64,
        /// How many further corners there are.
        more: usize,
    },
    /// The radius for rounding corners is not a positive number.
    #[error("the radius for rounding corners is {radius_mm} mm; it must be more than 0 and finite")]
    RoundRadius {
        /// What was given, in millimetres.
        radius_mm: f64,
    },
    /// A corner has too little curve around it for the radius.
    #[error(
        "the corner of {turn_deg:.1} degrees at ({:.3}, {:.3}) mm cannot be rounded to a radius of {radius_mm} mm: there are only {room_mm:.3} mm of curve beside it; use a smaller radius or round it in the drawing",
        position.x, position.y
    )]
    Rounding {
        /// Where.
        position: DVec2,
        /// By how much the direction of travel turns, in degrees, positive to the left.
        turn_deg: f64,
        /// The radius that was asked for, in millimetres.
        radius_mm: f64,
        /// The length of curve that the rounding may use on its shorter side, in millimetres.
        room_mm: f64,
    },
    /// The sides of the band are not two increasing numbers.
    #[error(
        "the band reaches from {low_mm} to {high_mm} mm across the curve; its width must be more than 0 and finite"
    )]
    Width {
        /// The lower side.
        low_mm: f64,
        /// The upper side.
        high_mm: f64,
    },
    /// The curve bends too hard for the band, even when squeezed.
    #[error(
        "the band folds at ({:.3}, {:.3}) mm, {at_mm:.3} mm along the curve: it reaches {reach_mm:.3} mm to the {side}, where the curve bends with a radius of {radius_mm:.3} mm; at most {allowed_mm:.3} mm fit, so use a narrower --width or a gentler curve",
        position.x, position.y
    )]
    Fold {
        /// Where on the curve.
        position: DVec2,
        /// Where along the curve, in millimetres.
        at_mm: f64,
        /// The inner side of the bend.
        side: Side,
        /// The radius of the curve there, in millimetres.
        radius_mm: f64,
        /// How far the band reaches to that side, in millimetres.
        reach_mm: f64,
        /// How far it could reach, when squeezed as far as is allowed, in millimetres.
        allowed_mm: f64,
    },
    /// Two places of the band overlap.
    #[error(
        "the band meets itself at ({:.3}, {:.3}) mm, where {first_mm:.3} mm along the curve comes upon {second_mm:.3} mm; use a narrower --width or move the curve apart",
        position.x, position.y
    )]
    Crossing {
        /// Where.
        position: DVec2,
        /// The one place along the curve, in millimetres.
        first_mm: f64,
        /// The other place along the curve, in millimetres; not before the first.
        second_mm: f64,
    },
}

/// So many corners are hardly drawn as corners.
const MANY_CORNERS: usize = 50;

fn others(more: usize) -> String {
    match more {
        0 => String::new(),
        1 => " (and 1 more corner)".to_owned(),
        n if n >= MANY_CORNERS => format!(" (and {n} more, as if short lines stood for a curve)"),
        n => format!(" (and {n} more corners)"),
    }
}
