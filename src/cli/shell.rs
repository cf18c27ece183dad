//! What shells and readers of manuals want to know of the program, made from the one definition of its arguments.

use std::io::Write;
use std::path::Path;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::args::Arguments;
use super::run::CliError;
use crate::export::{ExportError, persist_all, stage};
use crate::job::JobError;

#[derive(Debug, Args)]
pub(super) struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManArguments {
    /// Write a page for every command into this folder, which is made if there is none [default: the page of the program, on standard output]
    #[arg(long, value_name = "FOLDER")]
    folder: Option<std::path::PathBuf>,
}

/// Prints what completes the program's arguments in a shell.
pub(super) fn completions(arguments: &CompletionsArguments) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "openwork", &mut script);
    print(&script)
}

/// Prints the manual page of the program, or writes those of all commands into a folder, which is made if there is none.
pub(super) fn man(arguments: &ManArguments) -> Result<(), CliError> {
    // Commands know their whole names and the options of all only when it is built.
    let mut program = Arguments::command();
    program.build();
    match &arguments.folder {
        None => print(&page(&program)?),
        Some(folder) => write_pages(&program, folder),
    }
}

fn write_pages(program: &clap::Command, folder: &Path) -> Result<(), CliError> {
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    std::fs::create_dir_all(folder)
        .map_err(|source| JobError::from(ExportError::Write { path: folder.to_owned(), source }))?;
    let mut staged = Vec::new();
    for command in std::iter::once(program).chain(commands) {
        let name = command.get_display_name().unwrap_or(command.get_name());
        staged.push(stage(&folder.join(format!("{name}.1")), &page(command)?).map_err(JobError::from)?);
    }
    Ok(persist_all(staged).map_err(JobError::from)?)
}

fn page(command: &clap::Command) -> Result<Vec<u8>, CliError> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page).map_err(CliError::Stdout)?;
    Ok(page)
}

/// Prints to standard output; a reader who has had enough is no failure.
pub(super) fn print(bytes: &[u8]) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}
