//! Pieces of the exemplar between neighbouring cuts, and how well each can follow each.
//!
//! A [`Piece`] is the ink between two cuts: chains of the contours that cross it, contours wholly inside it,
//! the endpoints of its portals and its descriptor, all from its own geometry. The [`Catalogue`] holds the
//! pieces and, for each, its best successors with their cost (Zhou 2014 §3.6.1). Where it is wanted, every piece is
//! there a second time, mirrored left for right; which piece follows naturally is [`Catalogue::natural_next`].
//!
//! What this room promises to the next: endpoints on a side descend strictly, every chain runs with the ink
//! on its left from one endpoint to another, and the descriptor is that of the piece's geometry.

mod catalogue;
mod cut_up;
mod mirror;
mod piece;
mod seam;

pub use catalogue::{Catalogue, CostWeights, CostWeightsError, Join, Origin};
pub use piece::{Chain, End, Endpoint, Piece};
