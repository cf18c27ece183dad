//! What was asked for, held against what a file has.

use std::fmt;

use thiserror::Error;

use super::cutlines::{CutFault, CutReport};
use super::endure::{endures_dilation, endures_erosion};
use super::likeness::Unlike;
use super::narrowest::Narrowest;
use super::shells::{MeshFault, MeshReport};
use super::svg::SvgReport;
use crate::planar::Region;

/// The numbers that are as expected: all from the least to the most, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Between {
    /// The least of them.
    pub least: usize,
    /// The greatest of them.
    pub most: usize,
}

impl From<usize> for Between {
    fn from(n: usize) -> Self {
        Self { least: n, most: n }
    }
}

impl fmt::Display for Between {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.least == self.most {
            true => write!(f, "{}", self.least),
            false => write!(f, "{}..{}", self.least, self.most),
        }
    }
}

/// What a file should have.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Expected {
    /// The number of components (shells of a solid); `None` is any.
    pub components: Option<Between>,
    /// The number of holes (total genus of a solid); `None` is any.
    pub holes: Option<Between>,
    /// The counts must stay the same after eroding by half of this; 0 asks for nothing.
    pub min_feature_mm: f64,
    /// The counts must stay the same after dilating by half of this; 0 asks for nothing.
    pub min_gap_mm: f64,
}

/// The first thing that is not as expected.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Mismatch {
    /// Another number of components.
    #[error("the file has {found} component(s); {wanted} were asked for")]
    Components {
        /// In the file.
        found: usize,
        /// Asked for.
        wanted: Between,
    },
    /// Another number of holes.
    #[error("the file has {found} hole(s); {wanted} were asked for")]
    Holes {
        /// In the file.
        found: usize,
        /// Asked for.
        wanted: Between,
    },
    /// Ink that the machine would lose.
    #[error("ink narrower than {wanted_mm} mm holds the pattern together{}", place(narrowest))]
    Feature {
        /// The width asked for.
        wanted_mm: f64,
        /// The narrowest place.
        narrowest: Option<Narrowest>,
    },
    /// A gap that the machine would close.
    #[error("a gap narrower than {wanted_mm} mm keeps the pattern apart{}", place(narrowest))]
    Gap {
        /// The width asked for.
        wanted_mm: f64,
        /// The narrowest place.
        narrowest: Option<Narrowest>,
    },
    /// Cut lines that are not sound, so that the part would be spoilt.
    #[error("the cut lines have {count} fault(s), first: {first}")]
    Cuts {
        /// How many.
        count: usize,
        /// The first.
        first: CutFault,
    },
    /// Another number of shells.
    #[error("the solid has {found} shell(s); {wanted} were asked for")]
    Shells {
        /// In the file.
        found: usize,
        /// Asked for.
        wanted: Between,
    },
    /// Another total genus.
    #[error("the solid has {found} tunnel(s) (total genus); {wanted} were asked for")]
    Genus {
        /// In the file.
        found: i64,
        /// Asked for.
        wanted: Between,
    },
    /// A solid that is not sound, so that its counts mean nothing.
    #[error("the solid has {count} fault(s), first: {first}")]
    Faults {
        /// How many.
        count: usize,
        /// The first.
        first: MeshFault,
    },
    /// Another shape than the one that was planned.
    #[error("the file does not have the shape that it was made from: {0}")]
    Unlike(Box<Unlike>),
    /// A model that leaves its unit to whoever reads it, or has another.
    #[error("the model is in {}; it must say that it is in {wanted}", found.unwrap_or("a unit that it does not say"))]
    Unit {
        /// In the file.
        found: Option<&'static str>,
        /// What our own are in.
        wanted: &'static str,
    },
}

impl From<Unlike> for Mismatch {
    fn from(unlike: Unlike) -> Self {
        Self::Unlike(Box::new(unlike))
    }
}

fn place(narrowest: &Option<Narrowest>) -> String {
    narrowest.map_or_else(String::new, |n| {
        format!(": {:.3} mm at ({:.3}, {:.3}) mm", n.width_mm, n.position_mm.x, n.position_mm.y)
    })
}

fn within<E>(found: usize, wanted: Option<Between>, mismatch: impl Fn(usize, Between) -> E) -> Result<(), E> {
    let missed = wanted.filter(|wanted| !(wanted.least..=wanted.most).contains(&found));
    missed.map_or(Ok(()), |wanted| Err(mismatch(found, wanted)))
}

impl SvgReport {
    /// Whether the file is as `expected`. Widths are tried out by eroding and dilating.
    ///
    /// # Errors
    /// The first [`Mismatch`]; for a width, with the narrowest place of the file.
    pub fn check(&self, expected: &Expected) -> Result<(), Mismatch> {
        planar(&self.region, expected, [self.min_feature, self.min_gap], self.chord_mm)
    }
}

impl CutReport {
    /// Whether the cut lines are sound and the material that they leave is as `expected`. Widths are tried out by
    /// eroding and dilating.
    ///
    /// # Errors
    /// The first [`Mismatch`]; for a width, with the narrowest place of the file.
    pub fn check(&self, expected: &Expected) -> Result<(), Mismatch> {
        if let Some(first) = self.faults.first() {
            return Err(Mismatch::Cuts { count: self.faults.len(), first: first.clone() });
        }
        planar(&self.region, expected, [self.min_feature, self.min_gap], self.chord_mm)
    }
}

/// Whether a region is as `expected`; `narrowest` are its narrowest ink and gap.
fn planar(
    region: &Region,
    expected: &Expected,
    narrowest: [Option<Narrowest>; 2],
    chord_mm: f64,
) -> Result<(), Mismatch> {
    let mismatch = |found, wanted| Mismatch::Components { found, wanted };
    within(region.components(), expected.components, mismatch)?;
    within(region.holes(), expected.holes, |found, wanted| Mismatch::Holes { found, wanted })?;
    let [ink, gap] = narrowest;
    let wanted_mm = expected.min_feature_mm;
    if wanted_mm > 0.0 && !endures_erosion(region, 0.5 * wanted_mm, chord_mm) {
        return Err(Mismatch::Feature { wanted_mm, narrowest: ink });
    }
    let wanted_mm = expected.min_gap_mm;
    if wanted_mm > 0.0 && !endures_dilation(region, 0.5 * wanted_mm, chord_mm) {
        return Err(Mismatch::Gap { wanted_mm, narrowest: gap });
    }
    Ok(())
}

impl MeshReport {
    /// Whether the solid is sound and as `expected`: as many shells as components, a total genus of as many
    /// as holes. Widths are not looked at; the SVG of the same outline tells them.
    ///
    /// # Errors
    /// The first [`Mismatch`].
    pub fn check(&self, expected: &Expected) -> Result<(), Mismatch> {
        if let Some(first) = self.faults.first() {
            return Err(Mismatch::Faults { count: self.faults.len(), first: first.clone() });
        }
        within(self.shells.len(), expected.components, |found, wanted| Mismatch::Shells { found, wanted })?;
        let mismatch = |_, wanted| Mismatch::Genus { found: self.genus, wanted };
        // Sound shells have no negative genus.
        within(usize::try_from(self.genus).unwrap_or(usize::MAX), expected.holes, mismatch)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{read_stl, read_svg};
    use super::*;

    /// Two squares joined by a bar 1 mm wide, and a third one 0.5 mm away.
    const JOINED: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="10mm" viewBox="0 0 40 10">
        <path d="M0 0L10 0L10 4L20 4L20 0L30 0L30 10L20 10L20 5L10 5L10 10L0 10Z"/>
        <path d="M30.5 0L40 0L40 10L30.5 10Z"/></svg>"#;

    #[test]
    fn an_svg_is_checked_by_its_counts_and_at_tolerance() {
        let report = read_svg(JOINED.as_bytes(), 0.01).unwrap();
        let fine = Expected {
            components: Some(2.into()),
            holes: Some(0.into()),
            min_feature_mm: 0.98,
            min_gap_mm: 0.48,
        };
        assert_eq!(report.check(&fine), Ok(()));
        assert_eq!(report.check(&Expected::default()), Ok(()));
        let wanted = Expected { components: Some(1.into()), ..fine };
        assert_eq!(report.check(&wanted), Err(Mismatch::Components { found: 2, wanted: 1.into() }));
        let wanted = Expected { holes: Some(3.into()), ..fine };
        assert_eq!(report.check(&wanted), Err(Mismatch::Holes { found: 0, wanted: 3.into() }));
        let two_or_more = Between { least: 2, most: 4 };
        assert_eq!(report.check(&Expected { components: Some(two_or_more), ..fine }), Ok(()));
        let missed = report.check(&Expected { holes: Some(two_or_more), ..fine }).unwrap_err();
        assert_eq!(missed.to_string(), "the file has 0 hole(s); 2..4 were asked for");
        let text = report.check(&Expected { min_feature_mm: 1.02, ..fine }).unwrap_err().to_string();
        assert!(
            text.starts_with("ink narrower than 1.02 mm holds the pattern together: 1.000 mm at ("),
            "{text}"
        );
        let text = report.check(&Expected { min_gap_mm: 0.52, ..fine }).unwrap_err().to_string();
        assert!(
            text.starts_with("a gap narrower than 0.52 mm keeps the pattern apart: 0.500 mm at (30.250"),
            "{text}"
        );
    }

    #[test]
    fn an_stl_is_checked_by_shells_and_genus() {
        let (o, x, y, z) = ("0 0 0", "1 0 0", "0 1 0", "0 0 1");
        let facets = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(|[a, b, c]| {
            format!("facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
        });
        let report =
            |n: usize| read_stl(format!("solid t\n{}endsolid t\n", facets[..n].concat()).as_bytes()).unwrap();
        let wanted = Expected { components: Some(1.into()), holes: Some(0.into()), ..Expected::default() };
        assert_eq!(report(4).check(&wanted), Ok(()));
        let holed = Expected { holes: Some(1.into()), ..wanted };
        assert_eq!(report(4).check(&holed), Err(Mismatch::Genus { found: 0, wanted: 1.into() }));
        let two = Expected { components: Some(2.into()), ..wanted };
        assert_eq!(report(4).check(&two), Err(Mismatch::Shells { found: 1, wanted: 2.into() }));
        assert!(matches!(report(3).check(&wanted), Err(Mismatch::Faults { count: 3, .. })));
    }
}
