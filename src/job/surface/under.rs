//! The model under a band: how far it is from the flat band, and how thick its wall is.

use glam::DVec2;

use super::super::error::JobError;
use super::Ground;
use crate::domain::{MeshHeights, Relief, SpaceCurve, SurfaceError};

/// A relief has a value for each of so many parts of the band's width, and at most so far apart, in millimetres.
const RELIEF_PARTS: f64 = 24.0;
const RELIEF_MM: f64 = 0.5;
/// The most values.
const MOST_VALUES: f64 = 500_000.0;
/// A wall is thinner or thicker than a depth if it is so by this part at least.
const CLEARLY: f64 = 0.05;

/// Places under a band, in rows along it.
pub(super) struct Under<'g> {
    curve: &'g SpaceCurve,
    heights: MeshHeights,
    half: f64,
    reach_mm: f64,
    columns: usize,
    rows: usize,
}

impl<'g> Under<'g> {
    /// Under a band of twice `half` mm on `ground`, which is looked for within `reach_mm` of where the band would be flat.
    pub(super) fn new(ground: &'g Ground, half: f64, reach_mm: f64) -> Self {
        let curve = ground.curve();
        let length_mm = curve.length_mm();
        // Of a large model so many values are enough, and more take minutes.
        let step =
            (2.0 * half / RELIEF_PARTS).min(RELIEF_MM).max((2.0 * half * length_mm / MOST_VALUES).sqrt());
        let rows = ((2.0 * half / step).ceil() as usize + 1).max(4);
        let columns = ((length_mm / step).ceil() as usize + 1).max(4);
        // Long facets have few points on the curve.
        let along = (0..columns).map(|i| curve.frame(length_mm * i as f64 / columns as f64).point);
        let near = ground.on_mesh().points_mm.iter().copied().chain(along);
        let heights = MeshHeights::new(ground.mesh(), near, half.hypot(reach_mm) + half);
        Self { curve, heights, half, reach_mm, columns, rows }
    }

    /// A place of the band, in columns and rows, and how far the model is there.
    fn at(&self, i: f64, j: f64) -> Result<(DVec2, f64), SurfaceError> {
        let last = if self.curve.is_closed() { self.columns } else { self.columns - 1 } as f64;
        let u = self.curve.length_mm() * i / last;
        let v = self.half * (2.0 * j / (self.rows - 1) as f64 - 1.0);
        let frame = self.curve.frame(u);
        let origin = frame.point + frame.across * v;
        match self.heights.height(origin, frame.out, self.reach_mm) {
            Some(height) => Ok((DVec2::new(u, v), height)),
            None => Err(SurfaceError::Beyond { position: origin, at_mm: u, off_mm: v.abs() }),
        }
    }

    /// The model's distance from the flat band, and by how much the smooth relief misses it at most.
    ///
    /// # Errors
    /// [`SurfaceError::Beyond`].
    pub(super) fn relief(&self) -> Result<(Relief, f64), SurfaceError> {
        let (rows, columns) = (self.rows, self.columns);
        let mut table = Vec::with_capacity(rows * columns);
        for j in 0..rows {
            for i in 0..columns {
                table.push(self.at(i as f64, j as f64)?.1);
            }
        }
        let (length_mm, v_range) = (self.curve.length_mm(), [-self.half, self.half]);
        let relief = Relief::new(table, columns, length_mm, v_range, self.curve.is_closed());
        let mut missed_mm: f64 = 0.0;
        for j in 0..rows - 1 {
            for i in 0..columns - 1 {
                for part in [0.0, 0.5] {
                    let (uv, height) = self.at(i as f64 + part, j as f64 + part)?;
                    missed_mm = missed_mm.max((relief.at(uv) - height).abs());
                }
            }
        }
        Ok((relief, missed_mm))
    }

    /// Whether what is carved so deep goes through the wall everywhere, or nowhere.
    ///
    /// # Errors
    /// [`JobError::Option`] where it would in some places only.
    pub(super) fn is_through(&self, depth_mm: f64) -> Result<bool, JobError> {
        let [mut thinnest, mut thickest] = [f64::INFINITY, 0.0f64];
        for j in 0..self.rows {
            for i in 0..self.columns {
                let (uv, height) = self.at(i as f64, j as f64)?;
                let frame = self.curve.frame(uv.x);
                let surface = frame.point + frame.across * uv.y + frame.out * height;
                let reach_mm = 2.0 * depth_mm + self.reach_mm;
                let wall = self.heights.height(surface, -frame.out, reach_mm).filter(|wall| *wall > 0.0);
                let wall = wall.unwrap_or(f64::INFINITY);
                (thinnest, thickest) = (thinnest.min(wall), thickest.max(wall));
            }
        }
        if thickest < (1.0 - CLEARLY) * depth_mm {
            return Ok(true);
        }
        if thinnest > (1.0 + CLEARLY) * depth_mm {
            return Ok(false);
        }
        let thickest = if thickest.is_finite() { format!("{thickest:.2} mm") } else { "a lot".to_owned() };
        Err(JobError::Option {
            option: "--depth",
            found: format!(
                "under the band the model is {thinnest:.2} mm to {thickest} thick, so that {depth_mm} mm would go through it in some places only"
            ),
            wanted: "use less to stay in it everywhere, or more to go through".to_owned(),
        })
    }
}
