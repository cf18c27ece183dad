//! Layers of what a cutter works, and the colours that tell them apart.
//!
//! Laser programs sort what to do by colour, so a process may say which ones a machine knows. A DXF has two ways to say one:
//! the numbers of the AutoCAD colour index, of which all programs know the first nine, and beside it an exact one.

use schemars::JsonSchema;
use serde::Serialize;

use crate::fabricate::{CUT_COLOUR, ENGRAVE_COLOUR};

/// What is to be done along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// Only the surface is marked.
    Engrave,
    /// The beam goes through.
    Cut,
    /// Nothing: the outline of the plate, to lay the part out by.
    Sheet,
}

impl Layer {
    /// All, in the order in which they are worked.
    pub const ALL: [Self; 3] = [Self::Engrave, Self::Cut, Self::Sheet];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Engrave => "ENGRAVE",
            Self::Cut => "CUT",
            Self::Sheet => "SHEET",
        }
    }
}

/// The colours of what is worked: red, green and blue of each. What is only shown is grey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LayerColours {
    /// Lines that are cut.
    pub cut: [u8; 3],
    /// Lines that are engraved.
    pub engrave: [u8; 3],
}

impl Default for LayerColours {
    /// Those of the processes that are built in.
    fn default() -> Self {
        Self { cut: CUT_COLOUR, engrave: ENGRAVE_COLOUR }
    }
}

impl LayerColours {
    /// The colour of a layer.
    pub fn of(&self, layer: Layer) -> [u8; 3] {
        match layer {
            Layer::Engrave => self.engrave,
            Layer::Cut => self.cut,
            Layer::Sheet => GREY,
        }
    }
}

const GREY: [u8; 3] = [128, 128, 128];

/// The numbers of the colour index that all programs show alike. The seventh is black on paper and white on black screens.
const INDEX: [(u8, [u8; 3]); 10] = [
    (1, [255, 0, 0]),
    (2, [255, 255, 0]),
    (3, [0, 255, 0]),
    (4, [0, 255, 255]),
    (5, [0, 0, 255]),
    (6, [255, 0, 255]),
    (7, [0, 0, 0]),
    (7, [255, 255, 255]),
    (8, GREY),
    (9, [192, 192, 192]),
];

/// A colour as a DXF has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct DxfColour {
    /// The nearest of the colour index.
    pub(super) index: u8,
    /// The exact colour as one number, where the index has only a nearest.
    pub(super) exact: Option<u32>,
}

impl DxfColour {
    pub(super) fn new([red, green, blue]: [u8; 3]) -> Self {
        let squared = |(_, of): &(u8, [u8; 3])| {
            let apart = [red, green, blue].into_iter().zip(*of).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2));
            apart.sum::<u32>()
        };
        let nearest = INDEX.iter().min_by_key(|entry| squared(entry)).expect("the index has colours");
        let exact = u32::from_be_bytes([0, red, green, blue]);
        Self { index: nearest.0, exact: (squared(nearest) > 0).then_some(exact) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_their_nearest_number() {
        for (index, colour) in INDEX {
            assert_eq!(DxfColour::new(colour), DxfColour { index, exact: None });
        }
        assert_eq!(DxfColour::new([250, 10, 0]), DxfColour { index: 1, exact: Some(0xfa_0a00) });
        assert_eq!(DxfColour::new([0, 60, 200]).index, 5);
        assert_eq!(DxfColour::new([20, 20, 20]).index, 7);
    }
}
