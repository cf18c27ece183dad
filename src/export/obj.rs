//! The Wavefront OBJ writer.
//!
//! Text: one line for each vertex and each facet, a group for each shell. The format knows no unit, so the
//! comments at the top say millimetres; readers that ask are to be told so.

use std::fmt::Write;

use super::mesh::{MeshDocument, decimals};
use crate::fabricate::Solid;

/// `solid` as an OBJ in millimetres, its shells as named groups, facets in the solid's order. Coordinates are
/// the shortest decimals that are read as the same `f32` again.
pub fn obj(solid: &Solid, document: &MeshDocument) -> Vec<u8> {
    // Some thirty bytes a line.
    let mut text = String::with_capacity(32 * (solid.vertices().len() + solid.triangles().len()));
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        text.write_fmt(arguments).and_then(|()| text.write_char('\n')).expect("a string takes any text");
    };
    line(format_args!("# {}", one_line(&document.application)));
    line(format_args!("# Units: millimetres"));
    for (name, note) in &document.notes {
        line(format_args!("# {}: {}", one_line(name), one_line(note)));
    }
    line(format_args!("o {}", word(&document.title)));
    for (name, shell) in document.parts(solid) {
        line(format_args!("g {}", word(&name)));
        for [x, y, z] in shell.vertices.iter().map(|p| p.map(decimals)) {
            line(format_args!("v {x} {y} {z}"));
        }
        for [a, b, c] in shell.triangles.iter().map(|t| t.map(|v| v + 1)) {
            line(format_args!("f {a} {b} {c}"));
        }
    }
    text.into_bytes()
}

/// A comment may not run into the next line.
fn one_line(text: &str) -> String {
    text.replace(|c: char| c.is_control(), " ")
}

/// Spaces would make several groups of one.
fn word(text: &str) -> String {
    let word: Vec<&str> = text.split(|c: char| c.is_whitespace() || c.is_control()).collect();
    word.join("_")
}
