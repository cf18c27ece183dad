//! The analysis as a table for a terminal.

use std::fmt;

use super::{Analysis, PieceFound, SlicingUsed};

impl fmt::Display for Analysis {
    /// The counts, one line for each piece, then the notes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size_mm;
        writeln!(
            f,
            "{}: {width:.2} x {height:.2} mm, {:.1} mm2 of ink, {}, {}",
            self.name,
            self.area_mm2,
            count(self.components, "component"),
            count(self.holes, "hole")
        )?;
        let of = |event| self.critical_points.iter().filter(|p| p.event == event).count();
        write!(
            f,
            "{}: {} begin, {} end, {} split, {} merge",
            count(self.critical_points.len(), "critical point"),
            of("begin"),
            of("end"),
            of("split"),
            of("merge")
        )?;
        let cuts = count(self.cuts.len(), "cut");
        match self.slicing {
            SlicingUsed::Reeb { persistence_mm } => {
                let small = self.critical_points.iter().filter(|p| !p.makes_cuts).count();
                writeln!(f, "; {small} below the threshold of {persistence_mm:.3} mm")?;
                writeln!(f, "{cuts} between events")?;
            }
            SlicingUsed::Uniform { .. } => writeln!(f, "\n{cuts}, equally spaced")?,
        }
        for [from, to] in &self.kept_mm {
            writeln!(f, "kept whole from {from:.2} to {to:.2} mm")?;
        }
        for cut in &self.dropped_cuts {
            writeln!(
                f,
                "no cut at x = {:.3} mm: its narrowest portal is {:.3} mm",
                cut.x_mm, cut.narrowest_portal_mm
            )?;
        }
        if let Some(thin) = self.cuts.iter().filter_map(|c| c.narrowest_portal_mm).reduce(f64::min) {
            writeln!(f, "narrowest portal {thin:.3} mm")?;
        }
        writeln!(f, "\npiece     x mm  width mm  portals  closed  holes  successors  left | right")?;
        for piece in &self.pieces {
            row(f, piece)?;
        }
        if !self.notes.is_empty() {
            writeln!(f)?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        Ok(())
    }
}

fn row(f: &mut fmt::Formatter<'_>, piece: &PieceFound) -> fmt::Result {
    let d = &piece.descriptor;
    let portals = format!("{} > {}", d.left.len(), d.right.len());
    writeln!(
        f,
        "{:>5} {:>8.3}  {:>8.3}  {portals:>7}  {:>6}  {:>5}  {:>10}  {} | {}",
        piece.index,
        piece.x_mm,
        piece.width_mm,
        d.closed,
        d.holes,
        piece.successors,
        labels(&d.left),
        labels(&d.right)
    )
}

/// Component labels, or a dash without portals.
fn labels(labels: &[u16]) -> String {
    if labels.is_empty() {
        return "-".to_owned();
    }
    labels.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::super::tests::analysis;
    use crate::reeb::SlicingRule;

    #[test]
    fn a_row_for_each_piece() {
        let text = analysis(None).to_string();
        assert!(
            text.starts_with("eye: 56.00 x 12.00 mm, 460.0 mm2 of ink, 2 components, 1 hole\n"),
            "{text}"
        );
        assert!(text.contains("6 critical points: 2 begin, 2 end, 1 split, 1 merge; 0 below"), "{text}");
        assert!(text.contains("1 > 2"), "{text}");
        assert!(text.contains("  0 | 0 0\n"), "{text}");
        assert_eq!(text.lines().filter(|l| l.contains(" | ")).count(), 1 + 8);
        let uniform = analysis(Some(SlicingRule::Uniform { lines: 3 })).to_string();
        assert!(uniform.contains("3 cuts, equally spaced"), "{uniform}");
    }
}
