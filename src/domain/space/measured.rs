//! Arc length along a spline.
//!
//! Lengths are integrated between close parameters once, and from the nearest of them on where they are asked for.

use super::error::SpaceError;
use super::spline::{Jet, Spline};

/// Steps of the table of lengths for each point that a curve passes. More, and it takes longer; fewer, and frames
/// that are carried from step to step are less exact (each step errs by its fourth power, Wang et al. 2008).
const STEPS: usize = 32;
/// A curve that slows down to this part of the speed of its chords turns on the spot: a cusp.
const CUSP: f64 = 0.02;

/// A spline with its lengths at many parameters.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    spline: Spline,
    parameters: Vec<f64>,
    lengths: Vec<f64>,
}

impl Measured {
    /// Measures a spline by the lengths of chords, so that its speed is about 1.
    ///
    /// # Errors
    /// [`SpaceError::Cusp`] where it turns on the spot.
    pub(super) fn new(spline: Spline) -> Result<Self, SpaceError> {
        let mut parameters = vec![0.0];
        for pair in spline.knots().windows(2) {
            let part = |i: usize| pair[0] + (pair[1] - pair[0]) * i as f64 / STEPS as f64;
            parameters.extend((1..=STEPS).map(part));
        }
        let mut lengths = vec![0.0];
        for pair in parameters.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + length(&spline, pair[0], pair[1]));
        }
        // A step in which it turns back goes through no speed at all.
        let velocity = |i: usize| spline.at(parameters[i]).velocity;
        let turns = |i: usize| i + 1 < parameters.len() && velocity(i).dot(velocity(i + 1)) < 0.0;
        if let Some(i) = (0..parameters.len()).find(|&i| velocity(i).length() < CUSP || turns(i)) {
            return Err(SpaceError::Cusp { position: spline.at(parameters[i]).point, at_mm: lengths[i] });
        }
        Ok(Self { spline, parameters, lengths })
    }

    /// The length of all of it.
    pub(super) fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// How many parameters the table has.
    pub(super) fn steps(&self) -> usize {
        self.parameters.len()
    }

    /// The curve at a parameter of the table.
    pub(super) fn jet(&self, step: usize) -> Jet {
        self.spline.at(self.parameters[step])
    }

    /// A parameter of the table.
    pub(super) fn parameter(&self, step: usize) -> f64 {
        self.parameters[step]
    }

    /// The length up to a parameter of the table.
    pub(super) fn length_to(&self, step: usize) -> f64 {
        self.lengths[step]
    }

    /// The curve at any parameter.
    pub(super) fn at(&self, t: f64) -> Jet {
        self.spline.at(t)
    }

    /// The parameter at arc length `u`, and the last of the table that is not after it.
    pub(super) fn locate(&self, u: f64) -> (usize, f64) {
        let i = self.lengths.partition_point(|&s| s <= u).clamp(1, self.lengths.len() - 1) - 1;
        let from = self.parameters[i];
        let left = u - self.lengths[i];
        let mut t = from + left / self.spline.at(from).velocity.length();
        for _ in 0..4 {
            t += (left - length(&self.spline, from, t)) / self.spline.at(t).velocity.length();
        }
        (i, t)
    }
}

/// The length between two parameters, by Gauss and Legendre.
fn length(spline: &Spline, from: f64, to: f64) -> f64 {
    const NODES: [(f64, f64); 3] =
        [(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0), (-0.774_596_669_241_483_4, 5.0 / 9.0)];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    NODES.iter().map(|(x, weight)| weight * spline.at(middle + half * x).velocity.length()).sum::<f64>()
        * half
}
