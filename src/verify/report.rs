use glam::DVec2;
use serde::{Serialize, Serializer};
pub(super) fn point<S: Serializer>(p: &DVec2, serializer: S) -> Result<S::Ok, S::Error> {
    [p.x, p.y].serialize(serializer)
}
