//! Where struts may be: what would stick out of a region is cut off them before they are tried out.

use glam::DVec2;

use crate::planar::{EdgeIndex, FillRule, GridPoint, Region};

/// A region that struts stay in.
pub(super) struct Fence<'a> {
    region: &'a Region,
    index: EdgeIndex,
}

impl<'a> Fence<'a> {
    pub(super) fn new(region: &'a Region) -> Self {
        Self { region, index: EdgeIndex::new(region) }
    }

    /// What of a counter-clockwise outline is inside; `None` if that is not one piece without holes, which then joins something else
    /// than the outline would.
    pub(super) fn inside(&self, path: &[GridPoint]) -> Option<Vec<GridPoint>> {
        let inside = self.filled(path).within(self.region);
        let [part] = inside.parts() else { return None };
        part.holes().is_empty().then(|| part.exterior().points().to_vec())
    }

    /// Whether all of an outline is inside.
    pub(super) fn covers(&self, path: &[GridPoint]) -> bool {
        let grid = self.region.grid();
        let points = || path.iter().map(|&p| grid.to_mm(p));
        let (Some(low), Some(high)) = (points().reduce(DVec2::min), points().reduce(DVec2::max)) else {
            return true;
        };
        if self.index.in_box(low, high).next().is_none() {
            return self.region.parts().iter().any(|part| part.covers(path[0]));
        }
        self.filled(path).without(self.region).is_empty()
    }

    fn filled(&self, path: &[GridPoint]) -> Region {
        Region::fill(self.region.grid(), &[path.to_vec()], FillRule::Positive)
    }
}
