//! The fabrication tolerances of a job, in one place.

use thiserror::Error;

/// What the maker's machine needs, in millimetres. Built once and handed down.
///
/// The numeric grid ([`super::Grid`]) is another thing: it follows from the extent and has no setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    chord_mm: f64,
    min_feature_mm: f64,
    min_gap_mm: f64,
}

/// A tolerance that cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{name} is {value_mm} mm; it must be {wanted}")]
pub struct TolerancesError {
    /// The parameter's name.
    pub name: &'static str,
    /// What was given.
    pub value_mm: f64,
    /// What would be accepted.
    pub wanted: &'static str,
}

impl Tolerances {
    /// The chord error that is used when none is asked for, in millimetres. Larger and facets show on a
    /// print; smaller and files grow without a machine being able to follow.
    pub const DEFAULT_CHORD_MM: f64 = 0.01;

    /// Checked tolerances. `chord_mm` is the greatest distance between a curve and the chords or fitted
    /// curves that stand for it; the counts of the result must survive eroding by half of `min_feature_mm`
    /// and dilating by half of `min_gap_mm` (0 asks for nothing).
    ///
    /// # Errors
    /// [`TolerancesError`] names the parameter that is not a number in range.
    pub fn new(chord_mm: f64, min_feature_mm: f64, min_gap_mm: f64) -> Result<Self, TolerancesError> {
        if !(1e-4..=1.0).contains(&chord_mm) {
            return Err(TolerancesError { name: "chord", value_mm: chord_mm, wanted: "from 0.0001 to 1" });
        }
        for (name, value_mm) in [("min-feature", min_feature_mm), ("min-gap", min_gap_mm)] {
            if !(0.0..=100.0).contains(&value_mm) {
                return Err(TolerancesError { name, value_mm, wanted: "from 0 (not checked) to 100" });
            }
        }
        Ok(Self { chord_mm, min_feature_mm, min_gap_mm })
    }

    /// The same with another chord error; `None` when that is out of range.
    pub fn with_chord_mm(&self, chord_mm: f64) -> Option<Self> {
        Self::new(chord_mm, self.min_feature_mm, self.min_gap_mm).ok()
    }

    /// The same for a pattern that is cut out of what is kept: its ink is a gap of that, and its gaps are the ink.
    pub fn swapped(&self) -> Self {
        Self { min_feature_mm: self.min_gap_mm, min_gap_mm: self.min_feature_mm, ..*self }
    }

    /// The greatest distance between a curve and what stands for it.
    pub fn chord_mm(&self) -> f64 {
        self.chord_mm
    }

    /// The width of the narrowest ink that the machine makes; 0 when it was not given.
    pub fn min_feature_mm(&self) -> f64 {
        self.min_feature_mm
    }

    /// The width of the narrowest gap that the machine keeps open; 0 when it was not given.
    pub fn min_gap_mm(&self) -> f64 {
        self.min_gap_mm
    }
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { chord_mm: Self::DEFAULT_CHORD_MM, min_feature_mm: 0.0, min_gap_mm: 0.0 }
    }
}
