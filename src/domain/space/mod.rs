//! Bands along curves in space: rings, helices, curves through points, and curves on models.
//!
//! A band has coordinates (u, v) as in the plane, and w through its thickness. A curve carries a right-handed frame along
//! ([`SpaceCurve`]): on a ring or a helix that of the cylinder, through points one that turns as little as it can, on a model that of the
//! model, and a twist ([`Twist`]) if that is wanted. [`SpaceMap`] lays the band along it and refuses what folds or meets itself, with the place. Zhou 2014 §3.5.
//!
//! Excluded: the pattern and its facets, which are made where solids are.

mod contact;
mod curve;
mod error;
mod facets;
mod map;
mod measured;
mod relief;
mod roll;
mod spline;
mod traced;
mod twist;

pub use curve::{SpaceCurve, SpaceFrame};
pub use error::SpaceError;
pub use map::SpaceMap;
pub use relief::Relief;
pub use roll::{Roll, RollError};
pub(super) use spline::Spline;
pub use twist::{Twist, TwistError};
