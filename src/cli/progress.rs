//! Progress on a terminal.

use std::borrow::Cow;
use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::job::{Stage, Step, Target};

/// The line that is shown, for whatever ends the program beside its ordinary way.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes the line from the terminal, if there is one.
pub(super) fn clear() {
    if let Some(line) = shown().take() {
        line.finish_and_clear();
    }
}

/// A line that names the stage and the seconds since the beginning, and goes before anything else is said. There is none
/// when standard error is no terminal, when the terminal cannot take a line back, or when a file is printed on the
/// same terminal. It has no colours, whatever `NO_COLOR` says.
pub(super) struct Progress {
    line: ProgressBar,
}

impl Progress {
    /// A line for a job whose files go to `targets`.
    pub(super) fn new<'t>(quiet: bool, targets: impl IntoIterator<Item = &'t Target>) -> Self {
        let prints = targets.into_iter().any(|target| *target == Target::Stdout);
        let mixes = prints && std::io::stdout().is_terminal();
        let shows = !quiet && !mixes && std::io::stderr().is_terminal();
        let target = if shows { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let line = ProgressBar::with_draw_target(None, target);
        let style =
            ProgressStyle::with_template("{spinner} {msg}{seconds}").expect("the template is well formed");
        line.set_style(style.with_key("seconds", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // Short jobs have no need of a clock; nobody is left to hear of a failure to show one.
            if let seconds @ 1.. = state.elapsed().as_secs() {
                let _ = write!(text, " ... {seconds} s");
            }
        }));
        if shows {
            line.enable_steady_tick(Duration::from_millis(100));
            *shown() = Some(line.clone());
        }
        Self { line }
    }

    /// Shows that a stage has begun.
    pub(super) fn show(&self, stage: Stage) {
        self.line.set_message(words(stage));
    }

    /// Shows what a scene is at.
    pub(super) fn show_step(&self, step: Step<'_>) {
        match step {
            Step::Part(name, stage) => self.line.set_message(format!("{name}: {}", words(stage))),
            Step::Place => self.line.set_message("placing"),
            Step::Join => self.line.set_message("looking at the joints"),
            Step::Unite => self.line.set_message("uniting"),
            Step::Files(stage) => self.show(stage),
        }
    }
}

/// What is done in a stage.
fn words(stage: Stage) -> Cow<'static, str> {
    if let Stage::Iterate { level, iteration } = stage {
        return format!("synthesizing: level {level}, iteration {iteration}").into();
    }
    Cow::Borrowed(match stage {
        Stage::Read => "reading the exemplar",
        Stage::Slice => "cutting it into pieces",
        Stage::Solve => "searching for a sequence",
        Stage::Synthesize | Stage::Iterate { .. } => "synthesizing",
        Stage::Complete => "joining and opening",
        Stage::Fit => "fitting the pieces",
        Stage::Map => "mapping along the curve",
        Stage::Bridge => "laying bridges",
        Stage::Enforce => "thickening and widening",
        Stage::Svg => "drawing",
        Stage::CutLines => "laying out the cuts",
        Stage::Stl => "building the solid",
        Stage::Png => "painting the picture",
        Stage::Verify => "reading the files again and counting",
    })
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.line.finish_and_clear();
        clear();
    }
}
