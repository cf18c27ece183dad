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
    /// A DXF of cut lines in millimetres.
    Dxf,
    /// A binary STL solid in millimetres.
    Stl,
    /// A 3MF package of the solid, with names, colours and notes.
    Threemf,
    /// An OBJ of the solid in millimetres.
    Obj,
    /// A picture to look at.
    Png,
}

impl Format {
    /// Its name, which is also the extension of such files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Dxf => "dxf",
            Self::Stl => "stl",
            Self::Threemf => "3mf",
            Self::Obj => "obj",
            Self::Png => "png",
        }
    }

    /// Whether such files hold a solid.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Stl | Self::Threemf | Self::Obj)
    }
}

/// Where an output goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// A file.
    File(PathBuf),
    /// Standard output.
    Stdout,
}

impl Target {
    /// The target with a number before the extension: `out-01.svg` for `out.svg`. Standard output has none.
    pub fn numbered(&self, number: usize) -> Self {
        match self {
            Self::Stdout => Self::Stdout,
            Self::File(path) => {
                let text = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_os_string();
                let mut name = text(path.file_stem());
                name.push(format!("-{number:02}"));
                if path.extension().is_some() {
                    name.push(".");
                    name.push(text(path.extension()));
                }
                Self::File(path.with_file_name(name))
            }
        }
    }
}

impl Target {
    /// The contact sheet beside numbered files: `out-sheet.png` for `out.svg`. Standard output has none.
    pub fn contact_sheet(&self) -> Option<Self> {
        match self {
            Self::Stdout => None,
            Self::File(path) => {
                let mut name = path.file_stem().unwrap_or_default().to_os_string();
                name.push("-sheet.png");
                Some(Self::File(path.with_file_name(name)))
            }
        }
    }
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Stdout => f.write_str("standard output"),
        }
    }
}

/// One output of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    target: Target,
    format: Format,
}

impl Output {
    /// A file whose extension says the format: `.svg`, `.dxf`, `.stl`, `.3mf`, `.obj` or `.png`.
    ///
    /// # Errors
    /// [`JobError::Option`] for another extension.
    pub fn file(path: impl AsRef<Path>) -> Result<Self, JobError> {
        let path = path.as_ref();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        let format = match extension.as_str() {
            "svg" => Format::Svg,
            "dxf" => Format::Dxf,
            "stl" => Format::Stl,
            "3mf" => Format::Threemf,
            "obj" => Format::Obj,
            "png" => Format::Png,
            _ => {
                return Err(JobError::Option {
                    option: "--output",
                    found: format!("{} does not say a format", path.display()),
                    wanted:
                        "end the name in .svg, .dxf, .stl, .3mf, .obj or .png (or use - for an SVG on standard output)"
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

    /// The same format with another target.
    pub fn with_target(&self, target: Target) -> Self {
        Self { target, format: self.format }
    }

    /// The same with a number in its name (see [`Target::numbered`]).
    pub fn numbered(&self, number: usize) -> Self {
        self.with_target(self.target.numbered(number))
    }

    /// The format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Where it goes.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Refuses, before anything is computed, outputs that would overwrite each other or one of `inputs`, and
    /// those that cannot be files.
    ///
    /// # Errors
    /// [`JobError::Option`] names the file that stands there twice; [`JobError::Export`] as
    /// [`export::check_destination`].
    pub fn check<'a>(
        targets: impl IntoIterator<Item = &'a Target>,
        inputs: &[&Path],
    ) -> Result<(), JobError> {
        let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
        let mut seen: Vec<PathBuf> = Vec::new();
        for target in targets {
            let (shown, name) = match target {
                Target::Stdout => ("standard output".into(), PathBuf::from("-")),
                Target::File(path) => (path.display().to_string(), identity(path)),
            };
            let refuse = |what| JobError::Option {
                option: "--output",
                found: format!("{shown} {what}"),
                wanted: "every output needs a name of its own".to_owned(),
            };
            if seen.contains(&name) {
                return Err(refuse("is given twice"));
            }
            if let Target::File(path) = target {
                if inputs.contains(&name) {
                    return Err(refuse("is an input, which would be overwritten"));
                }
                export::check_destination(path)?;
            }
            seen.push(name);
        }
        Ok(())
    }
}

/// One path for all spellings of a name, whether or not there is such a file.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        match (absolute.parent().map(Path::canonicalize), absolute.file_name()) {
            (Some(Ok(folder)), Some(name)) => folder.join(name),
            _ => absolute,
        }
    })
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

    /// The same for bytes that have passed: what is read again must be those.
    pub(super) fn unchanged(target: &Target, bytes: &[u8]) -> Result<Self, JobError> {
        let pending = Self::new(target, bytes.to_vec())?;
        if pending.read_again()? != bytes {
            let source = std::io::Error::other("the file differs from what was written to it");
            return Err(ExportError::Write { path: target.to_string().into(), source }.into());
        }
        Ok(pending)
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

/// Writes what goes to standard output, then gives all files their names. A reader of standard output that
/// has closed the pipe has had enough, which is no failure. Reports go with them to their targets.
pub(super) fn persist<'t>(
    mut pending: Vec<Pending>,
    reports: impl IntoIterator<Item = (&'t Target, String)>,
) -> Result<(), JobError> {
    for (target, json) in reports {
        pending.push(Pending::new(target, json.into_bytes())?);
    }
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
        match out.write_all(&bytes).and_then(|()| out.flush()) {
            Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => {
                return Err(ExportError::Write { path: "standard output".into(), source }.into());
            }
            _ => {}
        }
    }
    Ok(export::persist_all(files)?)
}
