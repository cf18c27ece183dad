//! The stages of a job, for progress and timing.

use std::time::Instant;

use super::report::StageTime;

/// A stage of a job, in the order in which they come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Reading the exemplar and the curve.
    Read,
    /// Events, cuts and pieces.
    Slice,
    /// The search for a sequence.
    Solve,
    /// Offsets and warps.
    Fit,
    /// The map along the curve.
    Map,
    /// Struts and slits, when they are needed.
    Bridge,
    /// Thickening and widening, when they are asked for.
    Enforce,
    /// The SVG file.
    Svg,
    /// Kerf, plate and the files of cut lines.
    CutLines,
    /// The solid and its STL, 3MF and OBJ files.
    Stl,
    /// The picture.
    Png,
    /// Reading the files again and counting.
    Verify,
}

impl Stage {
    /// All stages.
    pub const ALL: [Self; 12] = [
        Self::Read,
        Self::Slice,
        Self::Solve,
        Self::Fit,
        Self::Map,
        Self::Bridge,
        Self::Enforce,
        Self::Svg,
        Self::CutLines,
        Self::Stl,
        Self::Png,
        Self::Verify,
    ];

    /// The stage's name in reports and on the progress bar.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Slice => "slice",
            Self::Solve => "solve",
            Self::Fit => "fit",
            Self::Map => "map",
            Self::Bridge => "bridge",
            Self::Enforce => "enforce",
            Self::Svg => "svg",
            Self::CutLines => "cut_lines",
            Self::Stl => "stl",
            Self::Png => "png",
            Self::Verify => "verify",
        }
    }
}

/// Tells a listener of each stage and times it.
pub(super) struct Clock<'a> {
    listener: &'a mut dyn FnMut(Stage),
    pub(super) times: Vec<StageTime>,
}

impl<'a> Clock<'a> {
    pub(super) fn new(listener: &'a mut dyn FnMut(Stage)) -> Self {
        Self { listener, times: Vec::new() }
    }

    /// Runs one stage; a stage that is run again adds to its time.
    pub(super) fn time<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        (self.listener)(stage);
        let start = Instant::now();
        let result = work();
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        match self.times.iter_mut().find(|t| t.stage == stage.name()) {
            Some(known) => known.milliseconds += milliseconds,
            None => self.times.push(StageTime { stage: stage.name(), milliseconds }),
        }
        result
    }
}
