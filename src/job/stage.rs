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
    /// Samples of the output, searched and assigned in turn.
    Synthesize,
    /// An iteration of that begins, counted from 1 at each level; levels are counted from 1, the coarsest.
    Iterate {
        /// The level.
        level: usize,
        /// The iteration.
        iteration: usize,
    },
    /// Curves through samples, joined and opened.
    Complete,
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
    /// All stages, without the iterations of one.
    pub const ALL: [Self; 14] = [
        Self::Read,
        Self::Slice,
        Self::Solve,
        Self::Synthesize,
        Self::Complete,
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
            Self::Synthesize | Self::Iterate { .. } => "synthesize",
            Self::Complete => "complete",
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
        self.time_telling(stage, |_| work())
    }

    /// The same for work that tells of what it is at.
    pub(super) fn time_telling<T>(
        &mut self,
        stage: Stage,
        work: impl FnOnce(&mut dyn FnMut(Stage)) -> T,
    ) -> T {
        (self.listener)(stage);
        let start = Instant::now();
        let result = work(self.listener);
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        self.add(StageTime { stage: stage.name(), milliseconds });
        result
    }

    /// Runs `work`, and on another thread `beside`, which tells nobody of its stages. Both times count, so that stages may
    /// add up to more than the whole took.
    pub(super) fn both<T, U: Send>(
        &mut self,
        work: impl FnOnce(&mut Self) -> T,
        beside: impl FnOnce(&mut Clock<'_>) -> U + Send,
    ) -> (T, U) {
        std::thread::scope(|scope| {
            let other = scope.spawn(|| {
                let mut nobody = |_| {};
                let mut clock = Clock::new(&mut nobody);
                let result = beside(&mut clock);
                (result, clock.times)
            });
            let own = work(self);
            let (theirs, times) = other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            times.into_iter().for_each(|time| self.add(time));
            (own, theirs)
        })
    }

    fn add(&mut self, time: StageTime) {
        match self.times.iter_mut().find(|known| known.stage == time.stage) {
            Some(known) => known.milliseconds += time.milliseconds,
            None => self.times.push(time),
        }
    }
}
