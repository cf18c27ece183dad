//! The processes and materials that there are: those that are built in, and those of a file.
//!
//! A file in TOML adds processes and materials, or gives those that are built in other numbers; options on the command
//! line come last. What the file has and there is not is an error with its line, and with the name that was probably meant.
//!
//! ```toml
//! [process.fdm-mine]
//! like = "fdm-0.4"          # what is left out is as there
//! min_feature_mm = 0.5
//!
//! [material.walnut]
//! density_g_cm3 = 0.64
//! ```
//!
//! Excluded: the numbers of what is built in ([`super::process`], [`super::material`]).

use std::collections::BTreeMap;

use serde::Deserialize;
use thiserror::Error;

use super::material::{self, Material};
use super::process::{self, CUT_COLOUR, ENGRAVE_COLOUR, Process};

/// Why there is no such process or material.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum WorkshopError {
    /// A name that nothing has.
    #[error("there is no {kind} '{name}'{}; there is {}", meant(nearest), known.join(", "))]
    Unknown {
        /// Process or material.
        kind: &'static str,
        /// As it was given.
        name: String,
        /// One that is spelt nearly so.
        nearest: Option<String>,
        /// All that there are.
        known: Vec<String>,
    },
    /// A file that is not as it should be.
    #[error("line {line}: {found}")]
    File {
        /// The line, from 1.
        line: usize,
        /// What is wrong, and what would work.
        found: String,
    },
}

fn meant(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean '{name}'?)"))
}

/// The processes and materials that there are, by their names.
#[derive(Debug, Clone, PartialEq)]
pub struct Workshop {
    processes: BTreeMap<String, Process>,
    materials: BTreeMap<String, Material>,
}

impl Default for Workshop {
    /// Those that are built in.
    fn default() -> Self {
        Self {
            processes: process::built_in().map(|p| (p.name.clone(), p)).collect(),
            materials: material::built_in().map(|m| (m.name.clone(), m)).collect(),
        }
    }
}

impl Workshop {
    /// Those that are built in, with those of a file in TOML, which win.
    ///
    /// # Errors
    /// [`WorkshopError::File`] with the line, for what is no TOML, unknown keys, and numbers out of range.
    pub fn with_file(text: &str) -> Result<Self, WorkshopError> {
        let line_of =
            |at: usize| 1 + text.as_bytes()[..at.min(text.len())].iter().filter(|&&b| b == b'\n').count();
        let file: File = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| line_of(span.start));
            WorkshopError::File { line, found: suggested(error.message()) }
        })?;
        let mut workshop = Self::default();
        for (name, entry) in file.process {
            let line = line_of(entry.span().start);
            let process = workshop.process_of(name.get_ref(), entry.into_inner());
            let process = process.map_err(|found| WorkshopError::File { line, found })?;
            workshop.processes.insert(process.name.clone(), process);
        }
        for (name, entry) in file.material {
            let line = line_of(entry.span().start);
            let name = name.into_inner();
            let material = Material { name: name.clone(), density_g_cm3: entry.into_inner().density_g_cm3 };
            if !material::DENSITIES.contains(&material.density_g_cm3) {
                let found =
                    format!("{} g/cm3 is no density; it must be from 0.01 to 25", material.density_g_cm3);
                return Err(WorkshopError::File { line, found });
            }
            workshop.materials.insert(name, material);
        }
        Ok(workshop)
    }

    fn process_of(&self, name: &str, entry: ProcessEntry) -> Result<Process, String> {
        let like = entry.like.as_deref().unwrap_or(name);
        let base = match self.processes.get(like) {
            Some(base) => Some(base.clone()),
            None if entry.like.is_some() => return Err(self.process(like).unwrap_err().to_string()),
            None => None,
        };
        let length = |key: &str, given: Option<f64>, of: fn(&Process) -> f64, [low, high]: [f64; 2]| {
            let value = given.or(base.as_ref().map(of)).ok_or_else(|| {
                format!("the process '{name}' has no {key}; give it one, or a process that it is like")
            })?;
            if (low..=high).contains(&value) {
                Ok(value)
            } else {
                Err(format!("{key} is {value}; it must be from {low} to {high} mm"))
            }
        };
        let colour =
            |key: &str, given: Option<String>, of: fn(&Process) -> [u8; 3], usual: [u8; 3]| match given {
                Some(text) => rgb(&text).ok_or_else(|| format!("{key} is '{text}'; write it as #ff0000")),
                None => Ok(base.as_ref().map_or(usual, of)),
            };
        Ok(Process {
            name: name.to_owned(),
            min_feature_mm: length(
                "min_feature_mm",
                entry.min_feature_mm,
                |p| p.min_feature_mm,
                [0.0, 100.0],
            )?,
            min_gap_mm: length("min_gap_mm", entry.min_gap_mm, |p| p.min_gap_mm, [0.0, 100.0])?,
            kerf_mm: length("kerf_mm", entry.kerf_mm, |p| p.kerf_mm, [0.0, 100.0])?,
            chord_mm: length("chord_mm", entry.chord_mm, |p| p.chord_mm, [1e-4, 1.0])?,
            thickness_mm: length("thickness_mm", entry.thickness_mm, |p| p.thickness_mm, [1e-3, 1e4])?,
            cut_colour: colour("cut_colour", entry.cut_colour, |p| p.cut_colour, CUT_COLOUR)?,
            engrave_colour: colour(
                "engrave_colour",
                entry.engrave_colour,
                |p| p.engrave_colour,
                ENGRAVE_COLOUR,
            )?,
        })
    }

    /// The names of all processes, in alphabetical order.
    pub fn process_names(&self) -> impl Iterator<Item = &str> {
        self.processes.keys().map(String::as_str)
    }

    /// The names of all materials, in alphabetical order.
    pub fn material_names(&self) -> impl Iterator<Item = &str> {
        self.materials.keys().map(String::as_str)
    }

    /// The process of this name.
    ///
    /// # Errors
    /// [`WorkshopError::Unknown`] with those that there are.
    pub fn process(&self, name: &str) -> Result<&Process, WorkshopError> {
        self.processes.get(name).ok_or_else(|| unknown("process", name, self.processes.keys()))
    }

    /// The material of this name.
    ///
    /// # Errors
    /// [`WorkshopError::Unknown`] with those that there are.
    pub fn material(&self, name: &str) -> Result<&Material, WorkshopError> {
        self.materials.get(name).ok_or_else(|| unknown("material", name, self.materials.keys()))
    }
}

/// The colour that is written as `#rrggbb`.
fn rgb(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    let is_hexadecimal = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let [_, red, green, blue] =
        u32::from_str_radix(digits, 16).ok().filter(|_| is_hexadecimal)?.to_be_bytes();
    Some([red, green, blue])
}

fn unknown<'a>(kind: &'static str, name: &str, known: impl Iterator<Item = &'a String>) -> WorkshopError {
    let known: Vec<String> = known.cloned().collect();
    WorkshopError::Unknown { kind, name: name.to_owned(), nearest: nearest(name, known.iter()), known }
}

/// What is spelt most like `name`, if it is at all.
fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a String>) -> Option<String> {
    let ranked = known.map(|k| (edits(name, k), k));
    ranked.min().filter(|&(edits, _)| edits <= 1 + name.chars().count() / 4).map(|(_, k)| k.clone())
}

/// The number of letters to put in, leave out or exchange to get from one word to the other (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, &y) in b.iter().enumerate() {
            let exchanged = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// The message of a wrong key with the one that was probably meant: serde names the wrong one and then the known ones.
fn suggested(message: &str) -> String {
    let message = message.trim_end();
    let words: Vec<String> = message.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    match words.split_first() {
        Some((wrong, known)) if message.starts_with("unknown field") => {
            let meant = meant(&nearest(wrong, known.iter()));
            format!("there is no key '{wrong}'{meant}; there is {}", known.join(", "))
        }
        _ => message.to_owned(),
    }
}

/// A file of processes and materials.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    process: BTreeMap<toml::Spanned<String>, toml::Spanned<ProcessEntry>>,
    #[serde(default)]
    material: BTreeMap<toml::Spanned<String>, toml::Spanned<MaterialEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProcessEntry {
    like: Option<String>,
    min_feature_mm: Option<f64>,
    min_gap_mm: Option<f64>,
    kerf_mm: Option<f64>,
    chord_mm: Option<f64>,
    thickness_mm: Option<f64>,
    cut_colour: Option<String>,
    engrave_colour: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialEntry {
    density_g_cm3: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_wins_over_what_is_built_in_and_may_be_like_it() {
        let text = "[process.\"fdm-0.4\"]\nmin_gap_mm = 0.3\n\n[process.mine]\nlike = \"laser-ply-3mm\"\n\
                    kerf_mm = 0.18\ncut_colour = \"#0000FF\"\n\n[material.walnut]\ndensity_g_cm3 = 0.64\n";
        let workshop = Workshop::with_file(text).unwrap();
        let fdm = workshop.process("fdm-0.4").unwrap();
        assert_eq!((fdm.min_feature_mm, fdm.min_gap_mm), (0.4, 0.3));
        let mine = workshop.process("mine").unwrap();
        assert_eq!((mine.kerf_mm, mine.thickness_mm, mine.cut_colour), (0.18, 3.0, [0, 0, 255]));
        assert_eq!(workshop.material("walnut").unwrap().density_g_cm3, 0.64);
    }

    #[test]
    fn wrong_files_are_refused_with_their_line() {
        let refused = |text: &str| Workshop::with_file(text).unwrap_err().to_string();
        let found = refused("[process.a]\nlike = \"resin\"\nmin_featur_mm = 1.0\n");
        assert!(found.starts_with("line 3:") && found.contains("did you mean 'min_feature_mm'"), "{found}");
        let found = refused("[proces.a]\nkerf_mm = 1.0\n");
        assert!(found.starts_with("line 1:") && found.contains("did you mean 'process'"), "{found}");
        let found = refused("\n[process.a]\nlike = \"risin\"\n");
        assert!(found.starts_with("line 2:") && found.contains("did you mean 'resin'"), "{found}");
        let found = refused("[process.a]\nkerf_mm = 1.0\n");
        assert!(found.contains("has no min_feature_mm"), "{found}");
        let found = refused("[process.a]\nlike = \"resin\"\nkerf_mm = -1.0\n");
        assert!(found.contains("kerf_mm is -1; it must be from 0 to 100 mm"), "{found}");
        let found = refused("[process.a]\nlike = \"resin\"\ncut_colour = \"red\"\n");
        assert!(found.contains("write it as #ff0000"), "{found}");
        let found = refused("[material.air]\ndensity_g_cm3 = 0.0012\n");
        assert!(found.contains("is no density"), "{found}");
        assert!(refused("[process.a\n").starts_with("line 1:"));
        assert!(refused("[process.a]\nkerf_mm = \"wide\"\n").starts_with("line 2:"));
    }

    #[test]
    fn unknown_names_are_told_what_there_is() {
        let error = Workshop::default().process("fdm-04").unwrap_err().to_string();
        assert!(error.contains("did you mean 'fdm-0.4'") && error.contains("waterjet"), "{error}");
        let error = Workshop::default().material("unobtainium").unwrap_err().to_string();
        assert!(!error.contains("did you mean") && error.contains("pla"), "{error}");
    }
}
