//! SVG in, one clean [`Region`] out; or, for the second engine, curves and elements ([`Linework`]).
//!
//! An exemplar is what a maker would cut: every visible fill and stroke of the drawing, united. Whatever the
//! drawing holds that ink cannot represent is an error that names the element and says what would work;
//! nothing is left out silently.
//!
//! The idea: the SVG library (usvg) resolves styles, units, transforms, `use` and markers, but it passes over
//! what it cannot read. So a scan of the XML goes first; it checks every value with the library's own
//! parsers, knows the line of every element, and counts what must come out.
//!
//! What is ink: every opaque fill and stroke, also gradients, whatever the colour. White among other colours is
//! an error, as it may be a background or a knock-out; a drawing all in white is ink. Opacity strictly between
//! 0 and 1 is an error; at 0 there is no ink. Clip paths are applied exactly. What `display`, `visibility`,
//! `none` paints or definitions keep from view is not ink. The page does not clip.
//!
//! Excluded: text (convert it to paths), images, masks, filters, patterns, compressed files, entities.
//! Arcs and circles reach us as cubic Béziers of a quarter turn, true to 0.03 % of the radius: at the default
//! chord that is more than flattening may add from a radius of 18 mm on (0.005 mm). It moves an outline by less
//! than a machine can, and no count.

mod area;
mod artwork;
mod check;
mod curve;
mod error;
mod heights;
mod limits;
mod linework;
mod outline;
mod parts;
mod scan;
mod source;
mod style;

use std::fmt;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use self::artwork::Artwork;
use self::scan::Strictness;
use self::source::Source;
use crate::planar::{Region, Tolerances};

pub use self::area::{area_from_svg, read_area};
pub use self::curve::{path_from_svg, read_path};
pub use self::error::{ExemplarError, ExemplarFault, Place};
pub use self::heights::{Heights, HeightsError, read_heights};
pub use self::limits::Limits;
pub use self::linework::Linework;
pub use self::parts::Line;

/// How to read an exemplar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadOptions {
    /// The greatest distance between a curve and its chords in millimetres, at the final size.
    pub chord_mm: f64,
    /// The height of the ink's bounding box after scaling; `None` keeps the drawing's own size. Curves are
    /// flattened at the final size, and the height is met within `chord_mm`.
    pub target_height_mm: Option<f64>,
    /// What a file may cost.
    pub limits: Limits,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { chord_mm: Tolerances::DEFAULT_CHORD_MM, target_height_mm: None, limits: Limits::default() }
    }
}

/// An ornament to learn from: a region in millimetres, y up, where the drawing had it on its page.
#[derive(Clone)]
pub struct Exemplar {
    name: String,
    sha256: String,
    notes: Vec<String>,
    artwork: Arc<Artwork>,
    options: ReadOptions,
    scale: f64,
    region: Region,
}

impl Exemplar {
    /// The exemplar in the SVG file at `path`, named by the file's stem.
    ///
    /// # Errors
    /// [`ExemplarError`] names the file and what is wrong with it.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, ExemplarError> {
        read_named(path, &options.limits, |name, bytes| Self::parse(name, bytes, options))
    }

    /// The exemplar in the SVG document `bytes`, which errors call `name`.
    ///
    /// # Errors
    /// [`ExemplarError`] says what is wrong with it.
    pub fn from_svg(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ExemplarError> {
        Self::parse(name, bytes, options).map_err(|fault| ExemplarError::new(name, fault))
    }

    fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ExemplarFault> {
        check_options(options)?;
        let source = Source::parse(bytes, &options.limits)?;
        let scan = scan::scan(&source, &options.limits, Strictness::Ink)?;
        let mut artwork = Artwork::new(&source, scan, &options.limits)?;
        let notes = std::mem::take(&mut artwork.notes);
        let region = outline::region(&artwork, 1.0, options.chord_mm, &options.limits)?;
        let natural = Self {
            name: name.to_owned(),
            sha256: sha256(bytes),
            notes,
            artwork: Arc::new(artwork),
            options: *options,
            scale: 1.0,
            region,
        };
        let mut exemplar = match options.target_height_mm {
            Some(height) => natural.with_height(height)?,
            None => natural,
        };
        exemplar.note_overhang();
        exemplar.note_specks();
        Ok(exemplar)
    }

    /// Scaled until the ink is `height` high. Chords change the height a little, and less the finer they are
    /// for the size of the ink, so a second step mends what the first one leaves.
    fn with_height(&self, height: f64) -> Result<Self, ExemplarFault> {
        let mut scaled = self.clone();
        for _ in 0..2 {
            scaled = self.at_scale(scaled.scale * height / scaled.height_mm())?;
        }
        Ok(scaled)
    }

    fn height_mm(&self) -> f64 {
        self.region.bounds_mm().map_or(0.0, |(low, high)| high.y - low.y)
    }

    fn at_scale(&self, scale: f64) -> Result<Self, ExemplarFault> {
        let region = outline::region(&self.artwork, scale, self.options.chord_mm, &self.options.limits)?;
        Ok(Self { scale, region, ..self.clone() })
    }

    fn note_overhang(&mut self) {
        let (width, height) = (self.artwork.page_mm.0 * self.scale, self.artwork.page_mm.1 * self.scale);
        let slack = self.options.chord_mm;
        let outside = self.region.bounds_mm().is_some_and(|(low, high)| {
            low.min_element() < -slack || high.x > width + slack || high.y > height + slack
        });
        if outside {
            self.notes.push("some ink lies outside of the page; it is read all the same".to_owned());
        }
    }

    /// Parts and holes too small for anyone to see count all the same, so they are told.
    fn note_specks(&mut self) {
        let grid = self.region.grid();
        let speck_mm2 = self.options.chord_mm * self.options.chord_mm;
        for (what, counted, is_part) in [("part", "component", true), ("hole", "hole", false)] {
            let mut specks = self
                .region
                .contours()
                .filter(|c| c.is_counter_clockwise() == is_part && c.area_mm2(grid).abs() < speck_mm2);
            let Some(first) = specks.next() else { continue };
            let (at, area) = (grid.to_mm(first.points()[0]), first.area_mm2(grid).abs());
            let down = self.artwork.page_mm.1 * self.scale - at.y;
            let (number, are, it_counts, it) = match specks.count() {
                0 => (format!("1 {what}"), "is", "it counts", "it"),
                more => (format!("{} {what}s", more + 1), "are", "they count", "them"),
            };
            let first = if it == "it" { "it lies" } else { "the first lies" };
            let remedy = if is_part { "delete {it}, or join {it} to its neighbour," } else { "fill {it}" };
            self.notes.push(format!(
                "{number} {are} too small to see (under {speck_mm2:.1e} mm2): {first} {:.4} mm from the left and {down:.4} \
                 mm from the top of the page and has {area:.1e} mm2; {it_counts} as a {counted} like any other, so {} in \
                 the drawing if that is not meant",
                at.x,
                remedy.replace("{it}", it),
            ));
        }
    }

    /// A copy scaled by `factor` about the origin of the page. Its curves are flattened anew, so that the
    /// chord error is the same at the new size.
    ///
    /// # Errors
    /// When `factor` is not a positive number, or the result leaves the range that can be computed with.
    pub fn scaled(&self, factor: f64) -> Result<Self, ExemplarError> {
        let scaled = if factor.is_finite() && factor > 0.0 {
            self.at_scale(self.scale * factor)
        } else {
            Err(ExemplarFault::Option { name: "the scale factor", value: factor, wanted: "a number above 0" })
        };
        scaled.map_err(|fault| ExemplarError::new(&self.name, fault))
    }

    /// Width and height of its page in millimetres. Ink may lie outside of it.
    pub fn page_mm(&self) -> [f64; 2] {
        let (width, height) = self.artwork.page_mm;
        [width * self.scale, height * self.scale]
    }

    /// The ink.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// The file's stem, or the name given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The SHA-256 of the file's bytes, in lower-case hexadecimal.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// What is worth telling the user though it is no error, one sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

impl fmt::Debug for Exemplar {
    /// A summary: an ornament has thousands of vertices.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Exemplar")
            .field("name", &self.name)
            .field("sha256", &self.sha256)
            .field("scale", &self.scale)
            .field("components", &self.region.components())
            .field("holes", &self.region.holes())
            .finish_non_exhaustive()
    }
}

fn check_options(options: &ReadOptions) -> Result<(), ExemplarFault> {
    if !(options.chord_mm.is_finite() && options.chord_mm >= 1e-5) {
        let (value, wanted) = (options.chord_mm, "a length of 0.00001 mm or more");
        return Err(ExemplarFault::Option { name: "the chord", value, wanted });
    }
    match options.target_height_mm {
        Some(value) if !(value.is_finite() && value > 0.0) => {
            Err(ExemplarFault::Option { name: "the height", value, wanted: "a length above 0 mm" })
        }
        _ => Ok(()),
    }
}

/// What `parse` makes of a file and of its name, which is its stem; errors name the file.
fn read_named<T>(
    path: &Path,
    limits: &Limits,
    parse: impl FnOnce(&str, &[u8]) -> Result<T, ExemplarFault>,
) -> Result<T, ExemplarError> {
    let file = path.display().to_string();
    let bytes = read_bytes(path, limits).map_err(|fault| ExemplarError::new(&file, fault))?;
    let name = path.file_stem().map_or_else(|| file.clone(), |stem| stem.to_string_lossy().into_owned());
    parse(&name, &bytes).map_err(|fault| ExemplarError::new(file, fault))
}

/// The SHA-256 of bytes in lower-case hexadecimal.
fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The bytes of a file, never more than one beyond the limit.
fn read_bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>, ExemplarFault> {
    let fault = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => ExemplarFault::Missing,
        _ => ExemplarFault::Unreadable(e),
    };
    let mut bytes = Vec::new();
    let one_more = (limits.bytes as u64).saturating_add(1);
    File::open(path).map_err(fault)?.take(one_more).read_to_end(&mut bytes).map_err(fault)?;
    Ok(bytes)
}
