//! The 3MF writer.
//!
//! A zip archive of three parts: types, relationships, and the model in XML. Every shell of the solid is an
//! object with a name and a base material; where there are several, one more object holds them together, so
//! that no reader moves them apart. The archive has no dates of its own: the same solid gives the same bytes.
//! Source: 3D Manufacturing Format, core specification 1.3.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::mesh::{MeshDocument, decimals};
use crate::fabricate::{Shell, Solid};

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rel0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;
/// Names of metadata that the specification does not know need a namespace of their own.
const NOTES_NAMESPACE: &str = "urn:openwork:notes";
/// The number of the list of materials; objects count on from it.
const MATERIALS: usize = 1;

/// `solid` as a 3MF in millimetres: its shells as named objects with their colours, facets in the solid's
/// order, and the notes of `document` as metadata. Coordinates are the shortest decimals that are read as the
/// same `f32` again.
pub fn threemf(solid: &Solid, document: &MeshDocument) -> Vec<u8> {
    let parts = [
        ("[Content_Types].xml", TYPES.to_owned()),
        ("_rels/.rels", RELATIONSHIPS.to_owned()),
        ("3D/3dmodel.model", model(solid, document)),
    ];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // What depends on the day or the system is fixed.
    let options = SimpleFileOptions::DEFAULT
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644)
        .system(System::Unix);
    for (name, text) in parts {
        // Four gigabytes in one part take the longer form of the format.
        let options = options.large_file(u32::try_from(text.len()).is_err());
        archive.start_file(name, options).expect("the names differ and are short");
        archive.write_all(text.as_bytes()).expect("memory takes any bytes");
    }
    archive.finish().expect("memory takes any bytes").into_inner()
}

fn model(solid: &Solid, document: &MeshDocument) -> String {
    let mut xml = Xml(String::with_capacity(64 * (solid.vertices().len() + solid.triangles().len())));
    xml.line(format_args!(r#"<?xml version="1.0" encoding="UTF-8"?>"#));
    xml.line(format_args!(
        r#"<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:o="{NOTES_NAMESPACE}">"#
    ));
    xml.line(format_args!(r#"<metadata name="Title">{}</metadata>"#, escaped(&document.title)));
    xml.line(format_args!(r#"<metadata name="Application">{}</metadata>"#, escaped(&document.application)));
    for (name, note) in &document.notes {
        xml.line(format_args!(r#"<metadata name="o:{}">{}</metadata>"#, escaped(name), escaped(note)));
    }
    xml.line(format_args!("<resources>"));
    xml.line(format_args!(r#"<basematerials id="{MATERIALS}">"#));
    for [red, green, blue] in &document.colours {
        let colour = format!("{red:02X}{green:02X}{blue:02X}");
        xml.line(format_args!(r##"<base name="{colour}" displaycolor="#{colour}FF"/>"##));
    }
    xml.line(format_args!("</basematerials>"));
    let mut id = MATERIALS;
    for (i, (name, shell)) in document.parts(solid).enumerate() {
        id += 1;
        let colour = i % document.colours.len().max(1);
        xml.mesh(id, &escaped(&name), colour, &shell);
    }
    if id > MATERIALS + 1 {
        let parts = MATERIALS + 1..=id;
        id += 1;
        xml.line(format_args!(
            r#"<object id="{id}" type="model" name="{}"><components>"#,
            escaped(&document.title)
        ));
        for part in parts {
            xml.line(format_args!(r#"<component objectid="{part}"/>"#));
        }
        xml.line(format_args!("</components></object>"));
    }
    xml.line(format_args!("</resources>"));
    xml.line(format_args!(r#"<build><item objectid="{id}"/></build>"#));
    xml.line(format_args!("</model>"));
    xml.0
}

/// Text that grows line by line.
struct Xml(String);

impl Xml {
    fn line(&mut self, arguments: std::fmt::Arguments<'_>) {
        self.0.write_fmt(arguments).and_then(|()| self.0.write_char('\n')).expect("a string takes any text");
    }

    fn mesh(&mut self, id: usize, name: &str, colour: usize, shell: &Shell<'_>) {
        self.line(format_args!(
            r#"<object id="{id}" type="model" name="{name}" pid="{MATERIALS}" pindex="{colour}"><mesh><vertices>"#
        ));
        for [x, y, z] in shell.vertices.iter().map(|p| p.map(decimals)) {
            self.line(format_args!(r#"<vertex x="{x}" y="{y}" z="{z}"/>"#));
        }
        self.line(format_args!("</vertices><triangles>"));
        for [a, b, c] in shell.triangles.iter().map(|t| t.map(|v| v - shell.first_vertex)) {
            self.line(format_args!(r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#));
        }
        self.line(format_args!("</triangles></mesh></object>"));
    }
}

/// Text as it may stand in XML; characters that it cannot hold become spaces.
fn escaped(text: &str) -> Cow<'_, str> {
    let special = |c: char| {
        matches!(c, '&' | '<' | '>' | '"') || c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
    };
    if !text.contains(special) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if special(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out.into()
}
