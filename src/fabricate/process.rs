//! Processes: what machines can make, in numbers.
//!
//! A process says how thin ink and how narrow a gap may be, how much a cut takes away, how finely curves are followed and
//! how thick the sheet is. Those that are built in are rules of thumb, each number with its source, for a machine that
//! nobody has measured. A file in TOML adds processes and materials, or gives those that are built in other numbers;
//! options on the command line come last. `docs/processes.md` shows [`table`].
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
//! Excluded: what is done with the numbers.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::material::{self, Material};

/// What a machine can make. Lengths are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Process {
    /// Its name on the command line.
    pub name: String,
    /// The narrowest ink that it makes.
    pub min_feature_mm: f64,
    /// The narrowest gap that it keeps open.
    pub min_gap_mm: f64,
    /// The width that a cut takes away; 0 for a process that adds material.
    pub kerf_mm: f64,
    /// The greatest distance between a curve and what stands for it that the machine does not show.
    pub chord_mm: f64,
    /// The thickness of the sheet, or a usual one of a print.
    pub thickness_mm: f64,
    /// The colour of lines that are cut, as `#rrggbb`.
    pub cut_colour: String,
    /// The colour of what is engraved, as `#rrggbb`.
    pub engrave_colour: String,
}

/// A number of a built-in process with its source.
type Sourced = (f64, &'static str);

/// A process that is built in.
struct BuiltIn {
    name: &'static str,
    min_feature: Sourced,
    min_gap: Sourced,
    kerf: Sourced,
    chord: Sourced,
    thickness: Sourced,
}

const OURS: &str = "our choice";
const ADDS: &str = "material is added, not cut";
const NOZZLE: &str = "nothing in the plane below the nozzle's diameter is printed \
     (3dflyingbear.com, best practices for FDM); two such lines are better (0.8 mm, blog.my3dpm.com, FDM design table)";
const FINE_NOZZLE: &str = "the nozzle's diameter, as for the nozzle of 0.4 mm";
const PRINT_GAP: &str = "loose fits leave 0.3 to 0.5 mm (colorpop.company, FDM design guidelines)";
const PRINT_CHORD: &str = "our choice: an eighth of the nozzle would not show, files need not be so coarse";
const LASER_LINES: &str = "cut lines closer than 0.5 mm may burn away together \
     (cutlasercut.com, what is laser kerf; laserengravingservice.co.uk, artwork preparation)";
const LASER_INK: &str = "details below 1 mm warp or break (cutlasercut.com, what is laser kerf; \
     laserengravingservice.co.uk, artwork preparation)";

const BUILT_IN: [BuiltIn; 6] = [
    BuiltIn {
        name: "fdm-0.4",
        min_feature: (0.4, NOZZLE),
        min_gap: (0.4, PRINT_GAP),
        kerf: (0.0, ADDS),
        chord: (0.01, PRINT_CHORD),
        thickness: (2.0, "our choice: ten layers of 0.2 mm"),
    },
    BuiltIn {
        name: "fdm-0.2",
        min_feature: (0.2, FINE_NOZZLE),
        min_gap: (0.2, "our choice: half of that of twice the nozzle"),
        kerf: (0.0, ADDS),
        chord: (0.005, PRINT_CHORD),
        thickness: (1.2, "our choice: twelve layers of 0.1 mm"),
    },
    BuiltIn {
        name: "resin",
        min_feature: (
            0.4,
            "supported walls from 0.4 mm (addema.se, guide for SLA; layerx3d.in, SLA design rules)",
        ),
        min_gap: (0.5, "holes below 0.5 mm close, parts need 0.5 mm between them (addema.se, guide for SLA)"),
        kerf: (0.0, ADDS),
        chord: (0.005, "our choice: a tenth of a pixel of usual screens"),
        thickness: (2.0, OURS),
    },
    BuiltIn {
        name: "laser-ply-3mm",
        min_feature: (1.0, LASER_INK),
        min_gap: (0.5, LASER_LINES),
        kerf: (
            0.2,
            "plywood of 3 mm (laserengravingservice.co.uk, table of kerfs; 0.008 in at laser504.com, kerfs)",
        ),
        chord: (0.02, "our choice: a tenth of the kerf"),
        thickness: (3.0, "the sheet"),
    },
    BuiltIn {
        name: "laser-acrylic-3mm",
        min_feature: (1.0, LASER_INK),
        min_gap: (0.5, LASER_LINES),
        kerf: (
            0.15,
            "acrylic of 3 mm (laserengravingservice.co.uk, table of kerfs; 0.2 mm at help.ponoko.com, kerf)",
        ),
        chord: (0.015, "our choice: a tenth of the kerf"),
        thickness: (3.0, "the sheet"),
    },
    BuiltIn {
        name: "waterjet",
        min_feature: (1.5, "our choice: about two kerfs, so that a web is not undercut from both sides"),
        min_gap: (0.8, "our choice: the kerf and a little, as nothing narrower than the jet can be cut"),
        kerf: (0.76, "0.03 in (metalcreature.com, design for waterjet)"),
        chord: (
            0.025,
            "our choice: a fifth of the usual tolerance of 0.005 in (metalcreature.com, design for waterjet)",
        ),
        thickness: (3.0, OURS),
    },
];

/// Lines to cut are red and what is engraved is black at many services (laserengravingservice.co.uk, artwork
/// preparation).
const CUT_COLOUR: &str = "#ff0000";
const ENGRAVE_COLOUR: &str = "#000000";

impl BuiltIn {
    fn process(&self) -> Process {
        Process {
            name: self.name.to_owned(),
            min_feature_mm: self.min_feature.0,
            min_gap_mm: self.min_gap.0,
            kerf_mm: self.kerf.0,
            chord_mm: self.chord.0,
            thickness_mm: self.thickness.0,
            cut_colour: CUT_COLOUR.to_owned(),
            engrave_colour: ENGRAVE_COLOUR.to_owned(),
        }
    }

    /// What is measured, its number and its source.
    fn rows(&self) -> [(&'static str, Sourced); 5] {
        [
            ("minimum feature", self.min_feature),
            ("minimum gap", self.min_gap),
            ("kerf", self.kerf),
            ("chord", self.chord),
            ("thickness", self.thickness),
        ]
    }
}

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
            processes: BUILT_IN.iter().map(|p| (p.name.to_owned(), p.process())).collect(),
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
        let colour = |key: &str, given: Option<String>, of: fn(&Process) -> String, usual: &str| {
            let colour = given.or(base.as_ref().map(of)).unwrap_or_else(|| usual.to_owned());
            let digits = colour.strip_prefix('#').unwrap_or("");
            if digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit()) {
                Ok(colour)
            } else {
                Err(format!("{key} is '{colour}'; write it as #ff0000"))
            }
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
            cut_colour: colour("cut_colour", entry.cut_colour, |p| p.cut_colour.clone(), CUT_COLOUR)?,
            engrave_colour: colour(
                "engrave_colour",
                entry.engrave_colour,
                |p| p.engrave_colour.clone(),
                ENGRAVE_COLOUR,
            )?,
        })
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

/// The built-in processes and materials with their sources, as tables in Markdown.
pub fn table() -> String {
    let mut text = String::from("| process | what | mm | source |\n|---|---|---|---|\n");
    for process in &BUILT_IN {
        for (what, (mm, source)) in process.rows() {
            let _ = writeln!(text, "| `{}` | {what} | {mm} | {source} |", process.name);
        }
    }
    text.push_str("\n| material | g/cm³ | source |\n|---|---|---|\n");
    text.push_str(&material::rows());
    text
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
        assert_eq!((mine.kerf_mm, mine.thickness_mm, mine.cut_colour.as_str()), (0.18, 3.0, "#0000FF"));
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

    #[test]
    fn the_page_shows_the_table() {
        let page = include_str!("../../docs/processes.md");
        assert!(page.contains(&table()), "docs/processes.md must hold this:\n{}", table());
    }
}
