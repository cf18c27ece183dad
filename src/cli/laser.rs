//! Options for files that a laser or a waterjet cuts, and what is said of them.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::make::Made;
use super::values;
use crate::job::{Curves, DxfVersion, LaserOptions, LaserReport, SheetSize};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Cutting (.dxf, and .svg with --cut)")]
pub(super) struct LaserArgs {
    /// Write an .svg as cut lines: red hairlines without fill, inner contours first, instead of black ink
    #[arg(long)]
    pub(super) cut: bool,
    /// Width that the beam burns away: outer contours go out and holes go in by half of it, so that the part has the drawn
    /// size. A gap or feature narrower than it is an error, a bay that stays filled a warning [default: cuts run along the contours]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(super) kerf: Option<f64>,
    /// What cut lines are made of, within --chord: arcs (and lines), polyline (lines only) or spline (cubic curves)
    #[arg(long, value_name = "KIND", value_enum, default_value_t = CurveKind::Arcs)]
    pub(super) curves: CurveKind,
    /// Release of a .dxf: r2000, which says that its unit is the millimetre, or r12 for old machines, which cannot
    #[arg(long, value_name = "RELEASE", value_enum, default_value_t = Release::R2000)]
    pub(super) dxf_version: Release,
    /// Lay the part in the middle of a plate of this size, as 300x200mm, whose outline is drawn on a layer of its own
    #[arg(long, value_name = "WxH", value_parser = values::sheet, allow_hyphen_values = true)]
    pub(super) sheet: Option<SheetSize>,
    /// Cut the pattern out of the plate as a sign: what is left of the plate is kept. Every hole of the pattern is a piece
    /// that falls out of it; with --holes 0 none does
    #[arg(long)]
    pub(super) carve: bool,
    /// Engrave the outlines of this drawing on the part (SVG), on a layer of its own and before anything is cut. Its page is
    /// the part's, or the plate's with --sheet: what is drawn over the part's .svg, or over the cut lines on their plate, is in its place. Refused where there is no material; a .png shows it in yellow
    #[arg(long, value_name = "FILE.svg")]
    pub(super) engrave: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum CurveKind {
    Arcs,
    Polyline,
    Spline,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Release {
    R2000,
    R12,
}

impl LaserArgs {
    /// The options; the kerf is that of the process where none was typed and something is cut.
    pub(super) fn options(&self, made: &Made, outputs: &[PathBuf]) -> LaserOptions {
        let is_dxf = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("dxf"));
        let cuts = self.cut || outputs.iter().any(is_dxf);
        LaserOptions {
            cut: self.cut,
            kerf_mm: self.kerf.or(made.kerf_mm.filter(|_| cuts)),
            curves: match self.curves {
                CurveKind::Arcs => Curves::Arcs,
                CurveKind::Polyline => Curves::Polyline,
                CurveKind::Spline => Curves::Spline,
            },
            dxf_version: match self.dxf_version {
                Release::R2000 => DxfVersion::R2000,
                Release::R12 => DxfVersion::R12,
            },
            sheet: self.sheet,
            carve: self.carve,
            engrave: self.engrave.clone(),
            colours: made.colours,
        }
    }
}

/// What cutting takes, and what falls out of a sign.
pub(super) fn say_cuts(laser: Option<&LaserReport>) {
    let Some(laser) = laser else { return };
    if let Some(pieces) = &laser.falls_out {
        match pieces.iter().max_by(|a, b| a.area_mm2.total_cmp(&b.area_mm2)) {
            None => say!("nothing falls out of the plate"),
            Some(largest) => {
                let p = largest.position_mm;
                say!(
                    "warning: {} piece(s) fall out of the plate, the largest of {:.1} mm2 at ({:.1}, {:.1}) mm; a pattern with --holes 0 keeps all, and --bridge 1mm opens holes",
                    pieces.len(),
                    largest.area_mm2,
                    p.x,
                    p.y
                );
            }
        }
    }
    if let Some(longest) = laser.burnt_limbs.first() {
        let [x, y] = longest.position_mm;
        say!(
            "note: {} limb(s) are narrower than the kerf and burn away, the longest {:.2} mm long and {:.3} mm wide, at ({x:.1}, {y:.1}) mm; they hold nothing; scale the part up, or use a finer kerf, to keep them",
            laser.burnt_limbs.len(),
            longest.length_mm,
            longest.width_mm
        );
    }
    if let Some(largest) = laser.filled_bays.first() {
        let [x, y] = largest.position_mm;
        say!(
            "warning: the beam does not get into {} bay(s), which stay filled, the largest of {:.2} mm2 at ({x:.1}, {y:.1}) mm; scale the part up, or use a finer kerf",
            laser.filled_bays.len(),
            largest.area_mm2
        );
    }
    if laser.files.is_empty() {
        return;
    }
    let numbers = &laser.numbers;
    if laser.engraved.is_some() {
        say!("engraves {:.1} mm", numbers.engrave_length_mm);
    }
    say!("cuts {:.1} mm, {} pierces, {} nodes", numbers.cut_length_mm, numbers.pierces, numbers.nodes);
}
