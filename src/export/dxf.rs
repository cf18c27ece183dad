//! The DXF writer: cut lines as closed polylines with bulges, or splines, in millimetres.
//!
//! Importers guess the unit of a DXF that does not say it, which is why parts come out 25.4 times too large. A file of
//! release 2000 (AC1015) says it twice, by `$INSUNITS` and `$MEASUREMENT`, and every contour is one closed entity, so
//! that nothing has to be joined. It has all tables and dictionaries that a strict reader asks for, and no date, so
//! that the same cuts give the same bytes. Release 12 (AC1009) is for old machines: it has neither units nor splines.
//! Excluded: text, dimensions, blocks and layouts.

use std::fmt::{Display, Write};

use glam::DVec2;

use super::ExportError;
use super::cutlines::{CutLines, CutPath};
use super::layer::{DxfColour, Layer};
use super::outline::{Outline, Segment};
use super::text::Number;

/// The release of DXF that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DxfVersion {
    /// AC1015: with units, read by all current programs.
    #[default]
    R2000,
    /// AC1009: without units, to be taken as millimetres, for old machines. It has no splines.
    R12,
}

/// Handles of what others refer to. The rest are given out from [`FIRST_FREE`] on.
mod handle {
    pub(super) const LTYPE: u32 = 2;
    pub(super) const LAYER: u32 = 3;
    pub(super) const STYLE: u32 = 4;
    pub(super) const APPID: u32 = 7;
    pub(super) const DIMSTYLE: u32 = 8;
    pub(super) const BLOCK_RECORD: u32 = 9;
    pub(super) const MODEL_SPACE: u32 = 0xA;
    pub(super) const PAPER_SPACE: u32 = 0xB;
    pub(super) const ROOT: u32 = 0xC;
    pub(super) const GROUPS: u32 = 0xD;
}
const FIRST_FREE: u32 = 0x20;

/// The cut lines as the bytes of a DXF, with coordinates of as few digits as the chord error allows. The same lines give the same
/// bytes.
///
/// # Errors
/// [`ExportError::Splines`] for curves that release 12 cannot hold.
pub fn dxf(lines: &CutLines, version: DxfVersion) -> Result<String, ExportError> {
    // Handles end in the header, which comes first: what follows is written before it.
    let mut body = Writer { text: String::new(), version, next: FIRST_FREE };
    if version == DxfVersion::R2000 {
        body.section("CLASSES", |_| {});
    }
    body.section("TABLES", |w| w.tables(lines));
    body.section("BLOCKS", Writer::blocks);
    let mut fits = true;
    body.section("ENTITIES", |w| lines.paths.iter().for_each(|path| fits &= w.path(path)));
    if !fits {
        return Err(ExportError::Splines);
    }
    if version == DxfVersion::R2000 {
        body.section("OBJECTS", Writer::objects);
    }
    body.pair(0, "EOF");
    let mut file = Writer { text: String::new(), version, next: body.next };
    file.section("HEADER", |w| w.header(lines));
    Ok(file.text + &body.text)
}

struct Writer {
    text: String,
    version: DxfVersion,
    /// The next free handle.
    next: u32,
}

impl Writer {
    fn pair(&mut self, code: u16, value: impl Display) {
        let _ = writeln!(self.text, "{code}\n{value}");
    }

    fn pairs<const N: usize>(&mut self, pairs: [(u16, &str); N]) {
        pairs.into_iter().for_each(|(code, value)| self.pair(code, value));
    }

    /// A point of which x has this code, with a z of zero.
    fn point(&mut self, code: u16, p: DVec2) {
        self.pair(code, Number(p.x));
        self.pair(code + 10, Number(p.y));
        self.pair(code + 20, 0);
    }

    fn section(&mut self, name: &str, content: impl FnOnce(&mut Self)) {
        self.pairs([(0, "SECTION"), (2, name)]);
        content(self);
        self.pair(0, "ENDSEC");
    }

    fn is_r12(&self) -> bool {
        self.version == DxfVersion::R12
    }

    fn header(&mut self, lines: &CutLines) {
        let version = if self.is_r12() { "AC1009" } else { "AC1015" };
        self.pairs([(9, "$ACADVER"), (1, version)]);
        if !self.is_r12() {
            let seed = format!("{:X}", self.next);
            // 4 are millimetres, 1 is metric.
            self.pairs([(9, "$HANDSEED"), (5, &seed), (9, "$INSUNITS"), (70, "4")]);
            self.pairs([(9, "$MEASUREMENT"), (70, "1")]);
        }
        let (low, high) = lines.bounds_mm;
        let scale = 10f64.powi(lines.decimals);
        self.pair(9, "$EXTMIN");
        self.point(10, (low * scale).floor() / scale);
        self.pair(9, "$EXTMAX");
        self.point(10, (high * scale).ceil() / scale);
    }

    /// The start of an entity, an object or an entry of a table, with the next handle unless one is given.
    fn begin(&mut self, kind: &str, own: Option<u32>, owner: u32, class: &str) {
        self.pair(0, kind);
        if self.is_r12() {
            return;
        }
        let own = own.unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        });
        // A DIMSTYLE has its handle elsewhere, for reasons lost to time.
        self.pair(if kind == "DIMSTYLE" { 105 } else { 5 }, format_args!("{own:X}"));
        self.pair(330, format_args!("{owner:X}"));
        self.pair(100, class);
    }

    fn table(&mut self, name: &str, own: u32, entries: usize, content: impl FnOnce(&mut Self)) {
        self.pairs([(0, "TABLE"), (2, name)]);
        if !self.is_r12() {
            self.pair(5, format_args!("{own:X}"));
            self.pairs([(330, "0"), (100, "AcDbSymbolTable")]);
        }
        self.pair(70, entries);
        content(self);
        self.pair(0, "ENDTAB");
    }

    /// An entry of a table.
    fn entry(&mut self, kind: &str, own: Option<u32>, table: u32, class: &str, name: &str) {
        self.begin(kind, own, table, "AcDbSymbolTableRecord");
        if !self.is_r12() {
            self.pair(100, class);
        }
        self.pair(2, name);
    }

    fn tables(&mut self, lines: &CutLines) {
        let layers: Vec<Layer> = Layer::ALL
            .into_iter()
            .filter(|layer| lines.paths.iter().any(|path| path.layer == *layer))
            .collect();
        if !self.is_r12() {
            self.table("VPORT", 1, 0, |_| {});
        }
        let types: &[&str] =
            if self.is_r12() { &["CONTINUOUS"] } else { &["ByBlock", "ByLayer", "Continuous"] };
        self.table("LTYPE", handle::LTYPE, types.len(), |w| {
            for name in types {
                w.entry("LTYPE", None, handle::LTYPE, "AcDbLinetypeTableRecord", name);
                let shown = if name.eq_ignore_ascii_case("continuous") { "Solid line" } else { "" };
                w.pairs([(70, "0"), (3, shown), (72, "65"), (73, "0"), (40, "0")]);
            }
        });
        self.table("LAYER", handle::LAYER, 1 + layers.len(), |w| {
            w.layer("0", DxfColour::new([0, 0, 0]), true);
            for layer in layers {
                w.layer(layer.name(), DxfColour::new(lines.colours.of(layer)), layer != Layer::Sheet);
            }
        });
        self.table("STYLE", handle::STYLE, 1, |w| {
            w.entry("STYLE", None, handle::STYLE, "AcDbTextStyleTableRecord", "Standard");
            w.pairs([(70, "0"), (40, "0"), (41, "1"), (50, "0"), (71, "0"), (42, "1"), (3, "txt"), (4, "")]);
        });
        if self.is_r12() {
            return;
        }
        self.table("VIEW", 5, 0, |_| {});
        self.table("UCS", 6, 0, |_| {});
        self.table("APPID", handle::APPID, 1, |w| {
            w.entry("APPID", None, handle::APPID, "AcDbRegAppTableRecord", "ACAD");
            w.pair(70, 0);
        });
        self.table("DIMSTYLE", handle::DIMSTYLE, 1, |w| {
            w.pair(100, "AcDbDimStyleTable");
            w.pair(71, 1);
            w.entry("DIMSTYLE", None, handle::DIMSTYLE, "AcDbDimStyleTableRecord", "Standard");
            w.pair(70, 0);
        });
        self.table("BLOCK_RECORD", handle::BLOCK_RECORD, 2, |w| {
            for (name, own) in SPACES {
                w.entry("BLOCK_RECORD", Some(own), handle::BLOCK_RECORD, "AcDbBlockTableRecord", name);
            }
        });
    }

    fn layer(&mut self, name: &str, colour: DxfColour, plots: bool) {
        self.entry("LAYER", None, handle::LAYER, "AcDbLayerTableRecord", name);
        self.pair(70, 0);
        self.pair(62, colour.index);
        if let Some(exact) = colour.exact.filter(|_| !self.is_r12()) {
            self.pair(420, exact);
        }
        self.pair(6, if self.is_r12() { "CONTINUOUS" } else { "Continuous" });
        if !self.is_r12() && !plots {
            self.pair(290, 0);
        }
    }

    fn blocks(&mut self) {
        if self.is_r12() {
            return;
        }
        for (name, owner) in SPACES {
            for (kind, class) in [("BLOCK", "AcDbBlockBegin"), ("ENDBLK", "AcDbBlockEnd")] {
                self.begin(kind, None, owner, "AcDbEntity");
                self.pairs([(8, "0"), (100, class)]);
                if kind == "BLOCK" {
                    self.pairs([(2, name), (70, "0")]);
                    self.point(10, DVec2::ZERO);
                    self.pairs([(3, name), (1, "")]);
                }
            }
        }
    }

    /// A closed path as one entity; whether the release can hold it.
    fn path(&mut self, path: &CutPath) -> bool {
        let is_spline = path.outline.segments.iter().any(|s| matches!(s, Segment::Cubic(..)));
        match (is_spline, self.version) {
            (true, DxfVersion::R12) => return false,
            (true, DxfVersion::R2000) => self.spline(path),
            (false, DxfVersion::R12) => self.heavy_polyline(path),
            (false, DxfVersion::R2000) => self.polyline(path),
        }
        true
    }

    fn entity(&mut self, kind: &str, layer: Layer, class: &str) {
        self.begin(kind, None, handle::MODEL_SPACE, "AcDbEntity");
        self.pair(8, layer.name());
        if !self.is_r12() {
            self.pair(100, class);
        }
    }

    fn polyline(&mut self, CutPath { layer, outline }: &CutPath) {
        self.entity("LWPOLYLINE", *layer, "AcDbPolyline");
        self.pair(90, outline.segments.len());
        // Closed, and without a width.
        self.pairs([(70, "1"), (43, "0")]);
        for (p, bulge) in vertices(outline) {
            self.pair(10, Number(p.x));
            self.pair(20, Number(p.y));
            if bulge != 0.0 {
                self.pair(42, Number(bulge));
            }
        }
    }

    fn heavy_polyline(&mut self, CutPath { layer, outline }: &CutPath) {
        self.entity("POLYLINE", *layer, "");
        self.pair(66, 1);
        self.point(10, DVec2::ZERO);
        self.pair(70, 1);
        for (p, bulge) in vertices(outline) {
            self.entity("VERTEX", *layer, "");
            self.point(10, p);
            if bulge != 0.0 {
                self.pair(42, Number(bulge));
            }
        }
        self.entity("SEQEND", *layer, "");
    }

    /// Lines and cubics as one B-spline whose inner knots are threefold, so that its control points are those of the
    /// cubics. It ends where it begins; the flag of closed splines is not set, as some readers then repeat control
    /// points.
    fn spline(&mut self, CutPath { layer, outline }: &CutPath) {
        let n = outline.segments.len();
        let mut control = vec![outline.start];
        for segment in &outline.segments {
            let from = control[control.len() - 1];
            match *segment {
                Segment::Cubic(a, b, end) => control.extend([a, b, end]),
                Segment::Line(end) => {
                    control.extend([from.lerp(end, 1.0 / 3.0), from.lerp(end, 2.0 / 3.0), end])
                }
                Segment::Arc(..) => unreachable!("outlines of cubics have no arcs"),
            }
        }
        self.entity("SPLINE", *layer, "AcDbSpline");
        self.pairs([(210, "0"), (220, "0"), (230, "1"), (70, "8"), (71, "3")]);
        self.pair(72, 3 * n + 5);
        self.pair(73, control.len());
        self.pair(74, 0);
        for knot in 0..=n {
            let times = if knot == 0 || knot == n { 4 } else { 3 };
            (0..times).for_each(|_| self.pair(40, knot));
        }
        control.into_iter().for_each(|p| self.point(10, p));
    }

    fn objects(&mut self) {
        self.begin("DICTIONARY", Some(handle::ROOT), 0, "AcDbDictionary");
        self.pairs([(281, "1"), (3, "ACAD_GROUP")]);
        self.pair(350, format_args!("{:X}", handle::GROUPS));
        self.begin("DICTIONARY", Some(handle::GROUPS), handle::ROOT, "AcDbDictionary");
        self.pair(281, 1);
    }
}

/// The blocks that hold the drawing and the sheets of paper, with the handles of their records.
const SPACES: [(&str, u32); 2] =
    [("*Model_Space", handle::MODEL_SPACE), ("*Paper_Space", handle::PAPER_SPACE)];

/// The vertices of an outline of lines and arcs, each with the bulge of what follows.
fn vertices(outline: &Outline) -> impl Iterator<Item = (DVec2, f64)> + '_ {
    let bulge = |segment: &Segment| if let Segment::Arc(_, bulge) = *segment { bulge } else { 0.0 };
    outline.joints().zip(outline.segments.iter().map(bulge))
}

#[cfg(test)]
mod tests;
