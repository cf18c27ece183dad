//! A plain strip: a band along a curve that is full of ink, so that no exemplar is needed. Rims, feet, legs and rails.

use glam::DVec2;

use crate::domain::{BandMap, CurveSpec};
use crate::fabricate::Solid;
use crate::fit::{Outline, OutlineContour, Sides, StitchMethod};
use crate::job::band::read_curve;
use crate::job::builder::{BandBuilder, BandJob};
use crate::job::error::JobError;
use crate::job::part::{Part, PartError};
use crate::job::space::{self, read_space_curve};
use crate::topology::Topology;

/// The part of the chord error that is for the outline of a strip in the plane.
const MAP_SHARE: f64 = 0.5;

/// The width of a strip when none is asked for, in millimetres.
const DEFAULT_WIDTH_MM: f64 = 4.0;

/// A strip whose options are in order.
#[derive(Debug, Clone)]
pub struct Strip {
    job: BandJob,
}

impl Strip {
    /// A strip along the curve of `options`, of which the width, the thickness, the chord error and what is said of the curve
    /// are used.
    ///
    /// # Errors
    /// [`JobError`] names an option that is out of range.
    pub fn new(along: CurveSpec, options: impl FnOnce(BandBuilder) -> BandBuilder) -> Result<Self, JobError> {
        let builder = BandBuilder::new("", along).width_mm(DEFAULT_WIDTH_MM);
        Ok(Self { job: options(builder).build()? })
    }

    /// The solid.
    pub(super) fn solid(&self) -> Result<Solid, JobError> {
        let options = &self.job.options;
        let chord_mm = self.job.tolerances.chord_mm();
        let in_space = read_space_curve(&self.job)?;
        let (curve, _) = read_curve(&options.along, options.round_mm, in_space.as_ref())?;
        let height_mm = options.width_mm.unwrap_or(DEFAULT_WIDTH_MM);
        let half = 0.5 * height_mm;
        let (length_mm, is_closed) = (curve.length_mm(), curve.is_closed());
        let map = BandMap::new(curve, -half, half)?;
        let in_space = in_space.map(|curve| space::space_map(&self.job, curve, height_mm)).transpose()?;
        let planned = Topology { components: 1, holes: u32::from(is_closed), closed_pattern: is_closed };
        let outline = outline(length_mm, half, is_closed);
        let part = Part::new(&outline, &map, Sides::Free, planned, chord_mm * MAP_SHARE).map_err(
            |error| match error {
                PartError::Job(error) => error,
                PartError::Untrue(fault) => {
                    JobError::Outline { components: 1, holes: usize::from(is_closed), fault }
                }
            },
        )?;
        match &in_space {
            Some(map) => space::solid(&part, map, chord_mm),
            None => options.print.solid(&part.region, options.thickness_mm, chord_mm, &mut Vec::new()),
        }
    }
}

/// All of a band of twice `half` in height.
fn outline(length_mm: f64, half: f64, is_closed: bool) -> Outline {
    let line = |winding: i32, v: f64| OutlineContour {
        // Halves, so that no edge is as long as the whole.
        points: [0.0, 0.5].map(|part| DVec2::new(f64::from(winding) * part * length_mm, v)).to_vec(),
        winding,
    };
    let corners = [(0.0, -half), (length_mm, -half), (length_mm, half), (0.0, half)];
    let contours = match is_closed {
        true => vec![line(1, -half), line(-1, half)],
        false => vec![OutlineContour { points: corners.map(DVec2::from).to_vec(), winding: 0 }],
    };
    Outline {
        contours,
        seams: Vec::new(),
        fallbacks: Vec::new(),
        method: StitchMethod::Warp,
        stretch: 1.0,
        lift_mm: 0.0,
        squash: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn strip(along: &str) -> Solid {
        let along = along.parse().unwrap();
        Strip::new(along, |o| o.width_mm(6.0).thickness_mm(3.0).chord_mm(0.02)).unwrap().solid().unwrap()
    }

    #[test]
    fn strips_are_whole() {
        for (along, genus, volume) in [
            ("line:40mm", 0, 40.0 * 18.0),
            ("circle:30mm", 1, PI * 30.0 * 18.0),
            ("ring:30mm", 1, PI * 33.0 * 18.0),
            ("path:fixtures/curves/wave.svg", 0, 0.0),
            ("helix:30mm,pitch=12mm,turns=2", 0, 0.0),
        ] {
            let solid = strip(along);
            assert_eq!((solid.shells().len(), solid.genus()), (1, genus), "{along}");
            let found = solid.volume_mm3();
            assert!(volume == 0.0 || (found / volume - 1.0).abs() < 0.01, "{along}: {found} {volume}");
        }
    }
}
