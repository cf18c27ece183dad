//! What it means to stitch a piece to its neighbours, whatever the method.

use std::fmt;
use std::str::FromStr;

use glam::DVec2;

use crate::pieces::Piece;

/// Where the endpoints of one side have to go, top to bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideTarget {
    /// The height to reach, in millimetres above the middle of the band.
    pub y_mm: f64,
    /// The unit tangent to have there, pointing right.
    pub tangent: DVec2,
}

/// Where a piece has to go.
#[derive(Debug, Clone, Copy)]
pub struct Targets<'a> {
    /// The targets of the endpoints on its left side, top to bottom.
    pub left: &'a [SideTarget],
    /// Those on its right side.
    pub right: &'a [SideTarget],
    /// How far up a side without endpoints goes, in millimetres.
    pub offset_mm: f64,
    /// The height above and below the middle at which everything stays where it is; targets lie between.
    pub held_mm: Option<f64>,
}

/// A piece after stitching: x in millimetres from its left cut, y above the middle of the band.
#[derive(Debug, Clone, PartialEq)]
pub struct Bent {
    /// The images of the piece's chains, in their order, with the images of both endpoints.
    pub chains: Vec<Vec<DVec2>>,
    /// The images of its loops, in their order.
    pub loops: Vec<Vec<DVec2>>,
}

/// A deformation of one piece that takes its endpoints to their targets.
///
/// It is asked for the whole piece rather than point by point: a map of the plane, as the strip warp is, can place
/// one point without the others, but in a rotation-invariant deformation every vertex depends on all of them.
pub trait Stitch {
    /// The image of `piece`, which must be the piece that the deformation was made for. Polylines get points
    /// where an edge bends further than `chord_mm` away from its chord.
    fn bend(&self, piece: &Piece, chord_mm: f64) -> Bent;
}

/// How pieces are bent to meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StitchMethod {
    /// The strip warp: cannot break the topology, whatever it bends.
    Warp,
    /// Linear rotation-invariant deformation (Zhou 2014 §4.2), and the warp for pieces that do not survive it.
    #[default]
    Lri,
}

impl fmt::Display for StitchMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warp => "warp",
            Self::Lri => "lri",
        })
    }
}

impl FromStr for StitchMethod {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "warp" => Ok(Self::Warp),
            "lri" => Ok(Self::Lri),
            _ => Err(format!(
                "'{text}' is no way of stitching; use warp (never breaks the pattern) or lri (linear rotation-invariant deformation)"
            )),
        }
    }
}
