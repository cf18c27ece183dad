//! What mesh files say beside their triangles.

use crate::fabricate::{Shell, Solid};

/// The name of a solid, who made it, and in which colours its parts are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshDocument {
    /// The name of the solid. Of several parts each has its number behind it.
    pub title: String,
    /// The program and its version.
    pub application: String,
    /// What else is to be known, as pairs of a name (letters only) and a text: the command, the seed, counts.
    pub notes: Vec<(String, String)>,
    /// Red, green and blue of the parts, one after the other and then from the first again; at least one.
    pub colours: Vec<[u8; 3]>,
}

impl MeshDocument {
    /// A grey that shades well, for parts without a colour of their own.
    pub const GREY: [u8; 3] = [0xb8, 0xbc, 0xc2];

    /// Names and shells of the parts, in the solid's order.
    pub(super) fn parts<'a>(&'a self, solid: &'a Solid) -> impl Iterator<Item = (String, Shell<'a>)> {
        let is_one = solid.shells().len() == 1;
        solid.shells().enumerate().map(move |(i, shell)| {
            let name = if is_one { self.title.clone() } else { format!("{} {}", self.title, i + 1) };
            (name, shell)
        })
    }
}

/// The shortest decimals that are read as `x` again.
pub(super) fn decimals(x: f32) -> impl std::fmt::Display {
    // Adding zero turns a negative zero into a plain one.
    x + 0.0
}
