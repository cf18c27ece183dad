//! Where results go and in which format.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::JobError;
use crate::export::{self, ExportError};

/// A file format that a job can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// An SVG drawing in millimetres.
    Svg,
    /// A binary STL solid in millimetres.
    Stl,
    /// A picture to look at.
    Png,
}

/// Where an output goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// A file.
    File(PathBuf),
    /// Standard output.
    Stdout,
}

/// One output of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    target: Target,
    format: Format,
}

impl Output {
    /// A file whose extension says the format: `.svg`, `.stl` or `.png`.
    ///
    /// # Errors
    /// [`JobError::Option`] for another extension.
    pub fn file(path: impl AsRef<Path>) -> Result<Self, JobError> {
        let path = path.as_ref();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        let format = match extension.as_str() {
            "svg" => Format::Svg,
            "stl" => Format::Stl,
            "png" => Format::Png,
            _ => {
                return Err(JobError::Option {
                    option: "--output",
                    found: format!("{} does not say a format", path.display()),
                    wanted: "end the name in .svg, .stl or .png (or use - for an SVG on standard output)"
                        .to_owned(),
                });
            }
        };
        Ok(Self { target: Target::File(path.to_owned()), format })
    }

    /// Standard output.
    pub fn stdout(format: Format) -> Self {
        Self { target: Target::Stdout, format }
    }

    /// The format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Where it goes.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Refuses outputs that would overwrite each other.
    ///
    /// # Errors
    /// [`JobError::Option`] names the file that stands there twice.
    pub fn check_distinct<'a>(targets: impl IntoIterator<Item = &'a Target>) -> Result<(), JobError> {
        let mut seen: Vec<PathBuf> = Vec::new();
        for target in targets {
            let name = match target {
                Target::Stdout => PathBuf::from("-"),
                // Two spellings of one name are one file.
                Target::File(path) => std::path::absolute(path).unwrap_or_else(|_| path.clone()),
            };
            let name = name.canonicalize().unwrap_or(name);
            if seen.contains(&name) {
                return Err(JobError::Option {
                    option: "--output",
                    found: format!("{} is given twice", name.display()),
                    wanted: "every output needs a name of its own".to_owned(),
                });
            }
            seen.push(name);
        }
        Ok(())
    }
}

/// Bytes on their way out: staged beside their destination, or held for standard output.
pub(super) enum Pending {
    File(export::Staged),
    Stdout(Vec<u8>),
}

impl Pending {
    pub(super) fn new(target: &Target, bytes: Vec<u8>) -> Result<Self, JobError> {
        Ok(match target {
            Target::File(path) => Self::File(export::stage(path, &bytes)?),
            Target::Stdout => Self::Stdout(bytes),
        })
    }

    /// The bytes as they are in the file, read again.
    pub(super) fn read_again(&self) -> Result<Vec<u8>, JobError> {
        match self {
            Self::Stdout(bytes) => Ok(bytes.clone()),
            Self::File(staged) => std::fs::read(staged.temporary()).map_err(|source| {
                JobError::Export(ExportError::Write { path: staged.destination().to_owned(), source })
            }),
        }
    }
}

/// Gives all files their names, then writes what goes to standard output.
pub(super) fn persist(pending: Vec<Pending>) -> Result<(), JobError> {
    let mut files = Vec::new();
    let mut streams = Vec::new();
    for item in pending {
        match item {
            Pending::File(staged) => files.push(staged),
            Pending::Stdout(bytes) => streams.push(bytes),
        }
    }
    for bytes in streams {
        let mut out = std::io::stdout().lock();
        out.write_all(&bytes)
            .and_then(|()| out.flush())
            .map_err(|source| JobError::Export(ExportError::Write { path: PathBuf::from("-"), source }))?;
    }
    Ok(export::persist_all(files)?)
}
