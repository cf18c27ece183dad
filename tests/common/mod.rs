//! The program in a folder of its own, for tests of the command line.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::TempDir;

/// A folder in which the program runs; it goes when the test ends.
pub struct Room(TempDir);

/// What a run left on its two streams, and how it ended.
pub struct Finished {
    pub code: i32,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Room {
    /// A folder with copies of these exemplars of `fixtures/exemplars`.
    pub fn with(fixtures: &[&str]) -> Self {
        let room = Self(tempfile::tempdir().unwrap());
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/exemplars");
        for name in fixtures {
            std::fs::copy(source.join(name), room.path(name)).unwrap();
        }
        room
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// A file of the room as JSON.
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// Writes a drawing of 120 mm by 60 mm in which one user unit is one millimetre.
    pub fn draw(&self, name: &str, body: &str) {
        let head =
            "<svg xmlns='http://www.w3.org/2000/svg' width='120mm' height='60mm' viewBox='0 0 120 60'>";
        self.write(name, &format!("{head}\n{body}\n</svg>\n"));
    }

    /// Every file of the room and what is in it; hidden ones too.
    pub fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        let files = std::fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap());
        let named = files.map(|file| {
            let bytes = std::fs::read(file.path()).unwrap_or_default();
            (file.file_name().into_string().unwrap(), bytes)
        });
        named.collect()
    }

    /// The program with these arguments, which spaces part, ready to run in the room.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::cargo_bin("openwork").unwrap();
        command.current_dir(self.0.path()).args(arguments.split_whitespace());
        command
    }

    /// Runs the program.
    pub fn run(&self, arguments: &str) -> Finished {
        Finished::of(&mut self.command(arguments))
    }

    /// Runs the program, which must succeed.
    #[track_caller]
    pub fn succeeds(&self, arguments: &str) -> Finished {
        let finished = self.run(arguments);
        assert_eq!(finished.code, 0, "{arguments}: {}", finished.stderr);
        finished
    }

    /// Runs the program, which must end with this code and say all of `words`, print nothing, and leave the room
    /// exactly as it was.
    #[track_caller]
    pub fn refuses(&self, arguments: &str, code: i32, words: &[&str]) {
        let before = self.contents();
        let Finished { code: found, stdout, stderr } = self.run(arguments);
        assert_eq!(found, code, "{arguments}: {stderr}");
        assert!(stderr.starts_with("error: "), "{arguments}: {stderr}");
        for word in words {
            assert!(stderr.contains(word), "{arguments}: \"{word}\" is not in: {stderr}");
        }
        assert!(stdout.is_empty(), "{arguments}: {}", String::from_utf8_lossy(&stdout));
        let after = self.contents();
        assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>(), "{arguments}");
        assert!(before == after, "{arguments} changed a file");
    }
}

impl Finished {
    pub fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        Self {
            code: output.status.code().expect("the program was not killed"),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}
