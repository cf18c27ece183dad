//! The analysis for a terminal: its counts, and a table of its pieces.

use std::fmt;

use super::{Analysis, PieceFound, SlicingUsed};

/// What the columns of the table are.
const LEGEND: &str = "x: left edge from the left of the ink; portals: strands cut on the left > on the right; closed: parts \
    that reach neither side; holes: inside it; successors: pieces that may follow; left | right: the part that each strand \
    belongs to, top to bottom";

impl fmt::Display for Analysis {
    /// The counts, one line for each piece, then the notes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.counts(f)?;
        writeln!(f, "\npiece     x mm  width mm  portals  closed  holes  successors  left | right")?;
        for piece in &self.pieces {
            row(f, piece)?;
        }
        writeln!(f, "{LEGEND}")?;
        if !self.notes.is_empty() {
            writeln!(f)?;
        }
        self.told(f)
    }
}

/// An analysis without its table.
struct Summary<'a>(&'a Analysis);

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(analysis) = self;
        analysis.counts(f)?;
        let most = analysis.cuts.iter().map(|cut| cut.portals).max().unwrap_or(0);
        writeln!(f, "{}; at most {} on a cut", count(analysis.pieces.len(), "piece"), count(most, "portal"))?;
        analysis.told(f)
    }
}

impl Analysis {
    /// The counts and the notes, without a line for each piece.
    pub fn summary(&self) -> impl fmt::Display + '_ {
        Summary(self)
    }

    fn counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        Ok(())
    }

    fn told(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        assert_eq!(text.lines().filter(|l| l.contains(" | ")).count(), 1 + 8 + 1, "head, rows and legend");
        assert!(text.contains("portals: strands cut"), "{text}");
        let summary = analysis(None).summary().to_string();
        assert!(summary.starts_with("eye: 56.00 x 12.00 mm") && !summary.contains(" | "), "{summary}");
        assert!(summary.ends_with("8 pieces; at most 2 portals on a cut\n"), "{summary}");
        let uniform = analysis(Some(SlicingRule::Uniform { lines: 3 })).to_string();
        assert!(uniform.contains("3 cuts, equally spaced"), "{uniform}");
    }
}
