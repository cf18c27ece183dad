//! The `openwork` program: a thin shell around the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    openwork::cli::main()
}
