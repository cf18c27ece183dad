//! How points are written in JSON: as arrays of millimetres.

use glam::DVec2;
use serde::{Serialize, Serializer};

/// `[x, y]`.
pub(super) fn point<S: Serializer>(p: &DVec2, serializer: S) -> Result<S::Ok, S::Error> {
    p.to_array().serialize(serializer)
}

/// `[[x, y], [x, y]]`, or null.
pub(super) fn corners<S: Serializer>(p: &Option<(DVec2, DVec2)>, serializer: S) -> Result<S::Ok, S::Error> {
    p.map(|(low, high)| [low.to_array(), high.to_array()]).serialize(serializer)
}
