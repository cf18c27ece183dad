//! Parts and wholes as blocks of a cache, and back.

use super::making::Made;
use super::report::SceneReport;
use crate::fabricate::Solid;

/// The corners of all facets.
pub(super) fn facet_bytes(solid: &Solid) -> Vec<u8> {
    solid.facets().flat_map(|facet| facet.concat()).flat_map(f32::to_le_bytes).collect()
}

/// A part as it was kept.
pub(super) fn part_of(blocks: &[Vec<u8>]) -> Option<Made> {
    let [facets, report, notes] = blocks else { return None };
    let float = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
    let floats: Vec<f32> = facets.as_chunks::<4>().0.iter().map(float).collect();
    let facets = floats.as_chunks::<3>().0.as_chunks::<3>().0;
    Some(Made {
        solid: Solid::from_facets(facets.iter().copied()).ok()?,
        report: serde_json::from_slice(report).ok()?,
        notes: serde_json::from_slice(notes).ok()?,
        is_kept: true,
    })
}

/// A whole as it was kept: its report, and the content of its files.
pub(super) fn unpacked(blocks: Vec<Vec<u8>>) -> Option<(SceneReport, Vec<Vec<u8>>)> {
    let mut blocks = blocks.into_iter();
    let report = serde_json::from_slice(&blocks.next()?).ok()?;
    Some((report, blocks.collect()))
}
