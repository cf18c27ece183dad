//! The command line: raw arguments, checked configuration, run, messages.
//!
//! Standard output carries only what was asked for; messages and the progress bar, which shows on a terminal
//! only, go to standard error. Exit codes: 0 done, 2 wrong input or arguments, 3 constraints that cannot be
//! met, 4 failed verification, 1 a bug of ours; what an interruption ends counts as ended by its signal, which shells
//! show as 130 (Ctrl-C), 143 (`kill`) or 129 (the terminal closed).

/// Prints a line to standard error; with nobody there to read it, nothing is lost.
macro_rules! say {
    ($($message:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($message)*);
    }};
}

mod args;
mod build;
mod extrude;
mod fill;
mod interrupt;
mod laser;
mod make;
mod picture;
mod preset;
mod print;
mod progress;
mod rect;
mod run;
mod scene;
mod schema;
mod shell;
mod surface;
mod values;
mod verify;

use std::process::ExitCode;

use clap::Parser;

pub use args::Arguments;

/// The exit code of a program whose input or arguments are wrong.
const WRONG_INPUT: u8 = 2;

/// Runs the program with the process's arguments.
pub fn main() -> ExitCode {
    let arguments = match preset::expanded(std::env::args_os().collect()) {
        Ok(arguments) => Arguments::parse_from(arguments),
        Err(error) => {
            say!("error: {error}");
            return ExitCode::from(WRONG_INPUT);
        }
    };
    interrupt::leave_nothing_behind();
    // A panic has said where it happened; the exit code says that it is ours.
    match std::panic::catch_unwind(|| run::run(arguments)) {
        Err(_) => {
            eprintln!("error: this is a bug in Openwork; please report it with the command and the files");
            ExitCode::FAILURE
        }
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            say!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
