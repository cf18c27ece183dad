//! What of a drawing is a curve, and what an element.
//!
//! Each fill and each stroke is a piece. A piece belongs to the outermost group around it that is an element, or to the path that is
//! filled; a stroke that belongs to neither is a curve.

use std::collections::BTreeMap;

use kurbo::{Affine, BezPath, Cap, PathEl, Shape as _, Stroke};

use super::ReadOptions;
use super::artwork::{Artwork, Brush, Holder, Item, Shape};
use super::error::{ExemplarFault, Place};
use super::limits::Limits;
use super::outline::{largest_scale, regions};
use crate::planar::Grid;

/// A transform is a similarity if it lengthens all ways alike up to this part; the SVG library's coefficients are `f32`. Smaller, and
/// plain rotations are refused; larger, and a pen is wrong by what can be seen.
const STRETCH: f64 = 1e-4;
/// A line whose ends are closer than this is closed, and one that is no larger is a dot, in millimetres.
const CLOSED_MM: f64 = 0.002;

/// A curve: what a round pen draws along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The middle of the pen: one subpath in millimetres, y up; it ends with a closing element if it is closed.
    pub path: BezPath,
    /// The width of the pen in millimetres.
    pub width_mm: f64,
}

/// What a drawing consists of.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) strokes: Vec<Line>,
    /// These as they are drawn.
    pub(super) drawn_strokes: Vec<Item<Shape>>,
    /// Each one as the fills and strokes that it has.
    pub(super) elements: Vec<Vec<Item<Shape>>>,
    pub(super) notes: Vec<String>,
    /// What is lost where the curves are drawn again by a round pen.
    pub(super) lost: Option<String>,
    /// How many open curves have flat ends, and the first of them.
    flat: Option<(Place, usize)>,
}

/// One fill or stroke, alone.
struct Piece {
    shape: Shape,
    /// It with the clips that act on it.
    item: Item<Shape>,
    is_clipped: bool,
}

/// What makes some pieces one element.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Bond {
    /// The group with this number.
    Group(usize),
    /// The path whose fill is the piece with this number.
    Path(usize),
}

impl Parts {
    /// The pieces of a drawing, sorted out.
    ///
    /// # Errors
    /// [`ExemplarFault`] for a curve that no round pen draws.
    pub(super) fn new(artwork: &Artwork, options: &ReadOptions) -> Result<Self, ExemplarFault> {
        let mut parts = Self { notes: artwork.notes.clone(), ..Self::default() };
        parts.sort_out(artwork, options)?;
        Ok(parts)
    }

    fn sort_out(&mut self, artwork: &Artwork, options: &ReadOptions) -> Result<(), ExemplarFault> {
        let mut inked = Vec::new();
        for piece in pieces(&artwork.items) {
            // A fill that nobody wrote covers nothing under a straight line.
            let is_bare = matches!(piece.shape.brush, Brush::FillUnderStroke(_))
                && regions(&[&[Item::Shape(piece.shape.clone())]], 1.0, options.chord_mm, &options.limits)?
                    [0]
                .is_empty();
            if !is_bare {
                inked.push(piece);
            }
        }
        let groups = Groups::new(&artwork.holders, &inked);
        let mut elements: BTreeMap<Bond, usize> = BTreeMap::new();
        for (i, piece) in inked.iter().enumerate() {
            let is_stroke = is_stroke(piece);
            // A fill is followed by the stroke of the same path.
            let has_fill =
                is_stroke && i > 0 && matches!(inked[i - 1].shape.brush, Brush::FillUnderStroke(_));
            let bond = match groups.element(piece.shape.holder) {
                Some(group) => Bond::Group(group),
                None if has_fill => Bond::Path(i - 1),
                None if is_stroke => {
                    self.curves(piece, &options.limits)?;
                    continue;
                }
                None => Bond::Path(i),
            };
            if matches!(bond, Bond::Path(_)) && has_fill && !is_closed(&piece.shape.path) {
                self.notes.push(format!(
                    "{} is open and has a fill, so it is read as an element with its stroke; write fill=\"none\" if a \
                     curve is meant",
                    piece.shape.place
                ));
            }
            let element = *elements.entry(bond).or_insert(self.elements.len());
            if element == self.elements.len() {
                self.elements.push(Vec::new());
            }
            self.elements[element].push(piece.item.clone());
        }
        self.lost = self.flat.take().map(|(place, count)| {
            let (curves, first) =
                if count == 1 { ("curve has", "it is") } else { ("curves have", "the first is") };
            format!("{count} {curves} flat ends ({first} {place}); curves are synthesized with round ones")
        });
        Ok(())
    }

    /// The curves that a stroke draws.
    fn curves(&mut self, piece: &Piece, limits: &Limits) -> Result<(), ExemplarFault> {
        let shape = &piece.shape;
        let Brush::Stroke(style) = &shape.brush else { unreachable!("only a stroke has a pen") };
        let refused = |what: &str, remedy| {
            Err(ExemplarFault::Unsupported { place: shape.place.clone(), what: what.to_owned(), remedy })
        };
        if piece.is_clipped {
            return refused(
                "is a curve that a clip cuts, and a pen does not end along a line",
                "release the clip and shorten the curve, or make it a filled shape (in Inkscape: Path, Stroke to Path)",
            );
        }
        if !style.dash_pattern.is_empty() {
            return refused(
                "is a dashed curve, and a curve is drawn in one go",
                "make each dash a curve (in Inkscape: Extensions, Modify Path, Convert to Dashes), or remove the dashes",
            );
        }
        let Some(scale) = similarity(shape.to_mm) else {
            return refused(
                "is a curve that its transform stretches, so that the pen is wider one way than another",
                "apply the transform to the path, or make it a filled shape (in Inkscape: Path, Stroke to Path)",
            );
        };
        let path = shape.to_mm * &shape.path;
        let bounds = path.control_box();
        let limit = Grid::MAX_EXTENT_MM;
        if let Some(value) = [bounds.x0, bounds.y0, bounds.x1, bounds.y1]
            .into_iter()
            .find(|v| !v.is_finite() || v.abs() > limit)
        {
            return Err(ExemplarFault::Coordinate { place: shape.place.clone(), value, limit, unit: "mm" });
        }
        self.drawn_strokes.push(piece.item.clone());
        for subpath in path.subpaths() {
            let mut path: BezPath = subpath.iter().copied().collect();
            let bounds = path.bounding_box();
            if bounds.width().max(bounds.height()) < CLOSED_MM {
                if style.start_cap == Cap::Butt {
                    // By the rules of SVG it draws nothing.
                    continue;
                }
                return refused(
                    "has a dot, a line of no length",
                    "draw it as a filled circle, which is an element",
                );
            }
            if !is_closed(&path) {
                self.note_flat(&shape.place, style);
            } else if !matches!(path.elements().last(), Some(PathEl::ClosePath)) {
                path.close_path();
            }
            self.strokes.push(Line { path, width_mm: style.width * scale });
        }
        if self.strokes.len() > limits.segments {
            return Err(ExemplarFault::TooManySegments {
                place: shape.place.clone(),
                limit: limits.segments,
            });
        }
        Ok(())
    }

    fn note_flat(&mut self, place: &Place, style: &Stroke) {
        if style.start_cap != Cap::Round {
            self.flat.get_or_insert_with(|| (place.clone(), 0)).1 += 1;
        }
    }
}

/// Which groups are elements.
struct Groups<'a> {
    holders: &'a [Holder],
    is_element: Vec<bool>,
}

impl<'a> Groups<'a> {
    fn new(holders: &'a [Holder], pieces: &[Piece]) -> Self {
        let mut held = vec![0; holders.len()];
        let mut has_fill = vec![false; holders.len()];
        for piece in pieces {
            if let Some(holder) = piece.shape.holder {
                has_fill[holder] |= !is_stroke(piece);
            }
            around(holders, piece.shape.holder).for_each(|holder| held[holder] += 1);
        }
        let is_element = (0..holders.len())
            .map(|i| has_fill[i] && held[i] < pieces.len() && !holders[i].is_layer)
            .collect();
        Self { holders, is_element }
    }

    /// The outermost group around `holder` that is an element.
    fn element(&self, holder: Option<usize>) -> Option<usize> {
        around(self.holders, holder).filter(|&holder| self.is_element[holder]).last()
    }
}

/// A holder and those around it, outwards.
fn around(holders: &[Holder], holder: Option<usize>) -> impl Iterator<Item = usize> {
    std::iter::successors(holder, |&holder| holders[holder].around)
}

fn pieces(items: &[Item<Shape>]) -> Vec<Piece> {
    let piece = |item: &Item<Shape>| match item {
        Item::Shape(shape) => vec![Piece { shape: shape.clone(), item: item.clone(), is_clipped: false }],
        Item::Clipped(inner, clip) => {
            let clipped = |piece: Piece| {
                let item = Item::Clipped(vec![piece.item], clip.clone());
                Piece { item, is_clipped: true, ..piece }
            };
            pieces(inner).into_iter().map(clipped).collect()
        }
    };
    items.iter().flat_map(piece).collect()
}

fn is_stroke(piece: &Piece) -> bool {
    matches!(piece.shape.brush, Brush::Stroke(_))
}

/// Whether a subpath ends where it began.
pub(super) fn is_closed(path: &BezPath) -> bool {
    let ends = |subpath: &[PathEl]| {
        let start = subpath.first()?.end_point()?;
        let end = subpath.last()?.end_point().unwrap_or(start);
        Some(start.distance(end) < CLOSED_MM)
    };
    path.subpaths().all(|subpath| ends(subpath).unwrap_or(true))
}

/// By how much a map lengthens, if that is the same all ways.
fn similarity(affine: Affine) -> Option<f64> {
    let largest = largest_scale(affine);
    let smallest = affine.determinant().abs() / largest;
    (largest - smallest <= STRETCH * largest).then(|| (largest * smallest).sqrt())
}
