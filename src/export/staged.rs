//! Files that appear whole or not at all.
//!
//! Bytes go to a temporary file beside their destination; when every output of a run is there (and was read
//! again and verified), all are renamed. A rename within a directory replaces the old file at once, so no
//! reader ever sees half of one; and as the bytes are on the disk before it, neither does one after a power cut.
//! Several files are renamed one after the other: where one fails, those before it get back what they had replaced.
//! A [`Staged`] that is dropped takes its temporary file with it; for a run that is interrupted, [`remove_staged`]
//! does.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, TempPath};

use super::ExportError;

/// The temporary files of this process that still exist.
static STAGED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn registry() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    // A set of paths is whole even if a thread panicked while holding it.
    STAGED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A complete file under a temporary name, beside its destination and with the same extension. Dropping it
/// removes it.
#[derive(Debug)]
pub struct Staged {
    destination: PathBuf,
    // `None` once it has its name.
    temporary: Option<TempPath>,
}

impl Staged {
    /// The name that the file is to have.
    pub fn destination(&self) -> &Path {
        &self.destination
    }

    /// The name that it has until then: read this to verify what was written.
    pub fn temporary(&self) -> &Path {
        self.temporary.as_deref().unwrap_or(&self.destination)
    }

    /// Renames it. The registry is that of the caller, who holds it.
    fn persist(mut self, registry: &mut BTreeSet<PathBuf>) -> Result<(), ExportError> {
        let Some(temporary) = self.temporary.take() else { return Ok(()) };
        registry.remove(&*temporary);
        // On failure the error gives the temporary file back, which removes it.
        temporary
            .persist(&self.destination)
            .map_err(|failed| ExportError::write(&self.destination, failed.error))
    }
}

impl Staged {
    /// Removes it, for one who holds the registry.
    fn discard(mut self, registry: &mut BTreeSet<PathBuf>) {
        if let Some(temporary) = self.temporary.take() {
            registry.remove(&*temporary);
        }
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some(temporary) = self.temporary.take() {
            registry().remove(&*temporary);
        }
    }
}

/// Writes `bytes` beside `path` under a temporary name.
///
/// The permissions are those of any new file (by the umask), and a symbolic link is followed, as if the file
/// had been written in place. The bytes are on the disk on return: otherwise a power cut soon after the rename could leave an
/// empty file in the place of an old one.
///
/// # Errors
/// [`ExportError::NotAFile`] when `path` names a directory or a device, [`ExportError::Write`] when the
/// directory is missing, cannot be written to, or is full. Nothing is left behind.
pub fn stage(path: &Path, bytes: &[u8]) -> Result<Staged, ExportError> {
    let destination = destination(path)?;
    let suffix = destination.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    let mut registry = registry();
    // The reason is kept as the system gave it: the temporary name would only confuse.
    let mut reason = None;
    // With the permissions that any new file gets.
    let create = |name: &Path| {
        File::options().write(true).create_new(true).open(name).inspect_err(|e| reason = e.raw_os_error())
    };
    let made =
        Builder::new().prefix(".openwork-").suffix(&suffix).make_in(directory_of(&destination), create);
    let mut file =
        made.map_err(|error| ExportError::write(path, reason.map_or(error, io::Error::from_raw_os_error)))?;
    registry.insert(file.path().to_owned());
    drop(registry);
    // Through the file itself, as errors of the wrapper tell of the temporary name.
    let written = file.as_file_mut().write_all(bytes).and_then(|()| file.as_file().sync_data());
    // From here on, every way out removes the file.
    let staged = Staged { destination, temporary: Some(file.into_temp_path()) };
    written.map_err(|error| ExportError::write(path, error))?;
    Ok(staged)
}

/// Whether a file could be written at `path`, as far as can be told without writing: it is no directory, and
/// its directory is there.
///
/// # Errors
/// As for [`stage`].
pub fn check_destination(path: &Path) -> Result<(), ExportError> {
    let destination = destination(path)?;
    match fs::metadata(directory_of(&destination)) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(ExportError::write(path, io::ErrorKind::NotADirectory.into())),
        Err(error) => Err(ExportError::write(path, error)),
    }
}

/// The file that `path` names, links followed.
fn destination(path: &Path) -> Result<PathBuf, ExportError> {
    let destination = match fs::metadata(path) {
        Ok(found) if found.is_file() => {
            fs::canonicalize(path).map_err(|error| ExportError::write(path, error))?
        }
        Ok(_) => return Err(ExportError::NotAFile { path: path.to_owned() }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(ExportError::write(path, error)),
    };
    if destination.file_name().is_none() || path.as_os_str().to_string_lossy().ends_with(['/', '\\']) {
        return Err(ExportError::NotAFile { path: path.to_owned() });
    }
    Ok(destination)
}

fn directory_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Gives all files their names, in order; or none of them.
///
/// An interruption comes before the first of them or after the last.
///
/// # Errors
/// [`ExportError::Write`] names the file that could not be renamed: then none has its name, and what had been there
/// before is there again. As everything else was checked before, this takes a change of the directory meanwhile.
/// [`ExportError::Partly`] when moreover some could not be put back, as on a file system without hard links, and says which.
pub fn persist_all(files: Vec<Staged>) -> Result<(), ExportError> {
    // Held until all is done or undone.
    let mut registry = registry();
    let mut done = Vec::new();
    let last = files.len().saturating_sub(1);
    let mut fault = None;
    for (i, file) in files.into_iter().enumerate() {
        if fault.is_some() {
            // Dropping it would wait for the registry.
            file.discard(&mut registry);
            continue;
        }
        // After the last one nothing can fail.
        let before = if i < last { Before::of(&file.destination) } else { Before::Nothing };
        let destination = file.destination.clone();
        match file.persist(&mut registry) {
            Ok(()) => done.push((destination, before)),
            Err(error) => fault = Some(error),
        }
    }
    let Some(error) = fault else { return Ok(()) };
    let stands = |(path, before): (PathBuf, Before)| (!before.restore(&path)).then_some(path);
    let standing: Vec<PathBuf> = done.into_iter().filter_map(stands).collect();
    match (standing.is_empty(), error) {
        (false, ExportError::Write { path, source }) => Err(ExportError::Partly { path, source, standing }),
        (_, error) => Err(error),
    }
}

/// What was under a name before a file took it.
enum Before {
    Nothing,
    /// The old file, under a second name that goes when this is dropped.
    Old(TempPath),
    /// A file that cannot have two names.
    Lost,
}

impl Before {
    fn of(destination: &Path) -> Self {
        if !destination.exists() {
            return Self::Nothing;
        }
        let link = |name: &Path| fs::hard_link(destination, name);
        match Builder::new().prefix(".openwork-").suffix(".old").make_in(directory_of(destination), link) {
            Ok(old) => Self::Old(old.into_temp_path()),
            Err(_) => Self::Lost,
        }
    }

    /// Whether it is there again.
    fn restore(self, destination: &Path) -> bool {
        match self {
            Self::Nothing => fs::remove_file(destination).is_ok(),
            Self::Old(old) => old.persist(destination).is_ok(),
            Self::Lost => false,
        }
    }
}

/// Removes every temporary file of this process, for a signal handler that is about to end it: from then on no file is
/// begun and none gets its name. Files that are being renamed are waited for.
pub fn remove_staged() {
    let mut registry = registry();
    for path in std::mem::take(&mut *registry) {
        // Nobody is left to hear of a failure.
        let _ = fs::remove_file(path);
    }
    // Never released: the rest of the program must not begin another file while it ends.
    std::mem::forget(registry);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_at_the_rename_and_not_before() {
        let room = tempfile::tempdir().unwrap();
        let (one, two) = (room.path().join("a.svg"), room.path().join("b.stl"));
        fs::write(&two, "old").unwrap();
        let staged = vec![stage(&one, b"one").unwrap(), stage(&two, b"two").unwrap()];
        assert!(!one.exists());
        assert_eq!(fs::read(&two).unwrap(), b"old");
        assert_eq!(fs::read(staged[1].temporary()).unwrap(), b"two");
        assert_eq!(staged[1].temporary().extension().unwrap(), "stl");
        persist_all(staged).unwrap();
        assert_eq!(names(room.path()), ["a.svg", "b.stl"]);
        assert_eq!(fs::read(&two).unwrap(), b"two");
    }

    #[test]
    fn what_is_not_persisted_leaves_nothing() {
        let room = tempfile::tempdir().unwrap();
        let staged = stage(&room.path().join("a.svg"), b"one").unwrap();
        assert!(registry().contains(staged.temporary()));
        let temporary = staged.temporary().to_owned();
        drop(staged);
        assert!(!registry().contains(&temporary));
        assert!(names(room.path()).is_empty());
    }

    #[test]
    fn a_failed_rename_leaves_nothing_of_its_own() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("a.svg");
        let staged = vec![stage(&path, b"one").unwrap(), stage(&room.path().join("b.svg"), b"two").unwrap()];
        // Meanwhile a directory takes the name.
        fs::create_dir(&path).unwrap();
        let error = persist_all(staged).unwrap_err();
        assert!(error.to_string().contains("a.svg"), "{error}");
        assert_eq!(names(room.path()), ["a.svg"]);
    }

    #[test]
    fn a_failed_rename_undoes_those_before_it() {
        let room = tempfile::tempdir().unwrap();
        let [old, new, taken, after] = ["a.svg", "b.svg", "c.svg", "d.svg"].map(|n| room.path().join(n));
        fs::write(&old, "old").unwrap();
        let staged = [&old, &new, &taken, &after].map(|path| stage(path, b"new").unwrap());
        fs::create_dir(&taken).unwrap();
        let error = persist_all(staged.into()).unwrap_err();
        assert!(matches!(&error, ExportError::Write { path, .. } if *path == taken), "{error}");
        assert_eq!(names(room.path()), ["a.svg", "c.svg"]);
        assert_eq!(fs::read(&old).unwrap(), b"old");
    }

    #[test]
    fn what_cannot_be_put_back_is_named() {
        let room = tempfile::tempdir().unwrap();
        let old = room.path().join("a.svg");
        fs::write(&old, "old").unwrap();
        assert!(!Before::Lost.restore(&old));
        let source = io::ErrorKind::PermissionDenied.into();
        let error = ExportError::Partly { path: "b.svg".into(), source, standing: vec![old] };
        let message = error.to_string();
        assert!(message.contains("cannot write b.svg") && message.contains("a.svg"), "{message}");
    }

    #[test]
    fn destinations_that_are_no_files_are_refused() {
        let room = tempfile::tempdir().unwrap();
        let message = |path: &Path| stage(path, b"one").unwrap_err().to_string();
        assert!(message(room.path()).contains("not a file"));
        assert!(message(&room.path().join("new/")).contains("not a file"));
        let missing = message(&room.path().join("no/a.svg"));
        assert!(missing.contains("no/a.svg: No such file") && !missing.contains(".openwork"), "{missing}");
        let file = room.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(message(&file.join("a.svg")).contains("a.svg"));
        for wrong in ["", "new/", "no/a.svg", "file/a.svg"].map(|name| room.path().join(name)) {
            assert_eq!(check_destination(&wrong).unwrap_err().to_string(), message(&wrong));
        }
        assert!(check_destination(&room.path().join("new.svg")).is_ok() && check_destination(&file).is_ok());
        assert_eq!(names(room.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_a_new_file_and_links_are_followed() {
        use std::os::unix::fs::PermissionsExt;
        let room = tempfile::tempdir().unwrap();
        let (ours, usual, link) = ["a.svg", "usual", "link.svg"].map(|n| room.path().join(n)).into();
        persist_all(vec![stage(&ours, b"one").unwrap()]).unwrap();
        fs::write(&usual, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&usual));
        std::os::unix::fs::symlink(&ours, &link).unwrap();
        persist_all(vec![stage(&link, b"two").unwrap()]).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&ours).unwrap(), b"two");
    }
}
