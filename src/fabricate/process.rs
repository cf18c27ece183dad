//! Processes: what machines can make, in numbers.
//!
//! A process says how thin ink and how narrow a gap may be, how much a cut takes away, how finely curves are followed, how
//! thick the sheet is and which colours tell a cutter what to do. Those that are built in are rules of thumb, each number
//! with its source, for a machine that nobody has measured. `docs/processes.md` shows [`table`]. Excluded: processes of
//! others ([`super::workshop`]), and what is done with the numbers.

use std::fmt::Write as _;

use serde::Serialize;

use super::material;

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
    /// The colour of lines that are cut: red, green and blue.
    pub cut_colour: [u8; 3],
    /// The colour of lines that are engraved: red, green and blue.
    pub engrave_colour: [u8; 3],
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

/// The colour of lines that are cut, when a process does not say another. Lines to cut are red and what is engraved is
/// black at many services (laserengravingservice.co.uk, artwork preparation).
pub const CUT_COLOUR: [u8; 3] = [0xff, 0, 0];
/// The colour of lines that are engraved, when a process does not say another.
pub const ENGRAVE_COLOUR: [u8; 3] = [0, 0, 0];

impl BuiltIn {
    fn process(&self) -> Process {
        Process {
            name: self.name.to_owned(),
            min_feature_mm: self.min_feature.0,
            min_gap_mm: self.min_gap.0,
            kerf_mm: self.kerf.0,
            chord_mm: self.chord.0,
            thickness_mm: self.thickness.0,
            cut_colour: CUT_COLOUR,
            engrave_colour: ENGRAVE_COLOUR,
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

/// The processes that are built in.
pub(super) fn built_in() -> impl Iterator<Item = Process> {
    BUILT_IN.iter().map(BuiltIn::process)
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
    fn the_page_shows_the_table() {
        let page = include_str!("../../docs/processes.md");
        assert!(page.contains(&table()), "docs/processes.md must hold this:\n{}", table());
    }
}
