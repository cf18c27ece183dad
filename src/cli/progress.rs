//! Progress on a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::job::Stage;

/// A spinner that names the stage; nothing at all when standard error is no terminal.
pub(super) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub(super) fn new(quiet: bool) -> Self {
        let shows = !quiet && std::io::stderr().is_terminal();
        let target = if shows { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        bar.set_style(ProgressStyle::default_spinner());
        if shows {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar }
    }

    /// Shows that a stage has begun.
    pub(super) fn show(&self, stage: Stage) {
        self.bar.set_message(match stage {
            Stage::Read => "reading the exemplar",
            Stage::Slice => "cutting it into pieces",
            Stage::Solve => "searching for a sequence",
            Stage::Fit => "fitting the pieces",
            Stage::Map => "mapping along the curve",
            Stage::Bridge => "laying bridges",
            Stage::Svg => "drawing",
            Stage::Stl => "building the solid",
            Stage::Png => "painting the picture",
            Stage::Verify => "reading the files again and counting",
        });
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
