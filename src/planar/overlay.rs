//! The one adapter to i_overlay: every call of that library is in this file.
//!
//! Its API changes between major versions and it trusts its caller with coordinate ranges; a [`Grid`] keeps
//! coordinates far inside them. Collinear points are preserved on the way in and out, because dropping one
//! where two contours touch would hide the touch.

use i_overlay::core::fill_rule::FillRule as EngineRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::angle::Angle;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::IntShapes;
use i_overlay::mesh::int::arc::ArcOptions;
use i_overlay::mesh::int::outline::offset::IntOutlineOffset;
use i_overlay::mesh::int::style::{IntLineJoin, IntOutlineStyle};

use super::contour::Contour;
use super::grid::GridPoint;

/// Which points a set of closed paths fills, by their winding number w.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FillRule {
    /// w is odd.
    EvenOdd,
    /// w is not zero.
    NonZero,
    /// w is positive: counter-clockwise ink less clockwise holes.
    Positive,
}

impl FillRule {
    fn engine(self) -> EngineRule {
        match self {
            Self::EvenOdd => EngineRule::EvenOdd,
            Self::NonZero => EngineRule::NonZero,
            Self::Positive => EngineRule::Positive,
        }
    }
}

/// An exterior and its holes as the engine returns them; contours may still touch in points.
pub(super) type RawPart = Vec<Contour>;

fn to_engine(path: &[GridPoint]) -> Vec<IntPoint<i64>> {
    path.iter().map(|p| IntPoint { x: p.x, y: p.y }).collect()
}

fn from_engine(shapes: IntShapes<i64>) -> Vec<RawPart> {
    shapes
        .into_iter()
        .filter_map(|shape| {
            let mut contours =
                shape.into_iter().map(|c| Contour::new(c.iter().map(|p| GridPoint::new(p.x, p.y)).collect()));
            let exterior = contours.next()??;
            Some(std::iter::once(exterior).chain(contours.flatten()).collect())
        })
        .collect()
}

/// The set that `paths` fill under `rule`.
pub(super) fn fill<'a>(paths: impl Iterator<Item = &'a [GridPoint]>, rule: FillRule) -> Vec<RawPart> {
    let mut overlay =
        Overlay::<i64>::new_custom(64, IntOverlayOptions::keep_all_points(), Default::default());
    for path in paths {
        overlay.add_contour(&to_engine(path), ShapeType::Subject);
    }
    from_engine(overlay.overlay(OverlayRule::Subject, rule.engine()))
}

/// The boundary of the set that `paths` fill under `rule`, with the ink on the left of every edge. Unlike the
/// contours of a [`super::Region`] these may still touch in points: they are for building further sets, where
/// more ink may yet cover the touch.
pub fn boundaries(paths: &[Vec<GridPoint>], rule: FillRule) -> Vec<Contour> {
    fill(paths.iter().map(Vec::as_slice), rule).into_iter().flatten().collect()
}

/// The points within `radius` steps of the ink (negative: the points of the ink farther than that from its
/// boundary), with round joins approximated to within about `chord` steps.
pub(super) fn offset<'a>(
    contours: impl Iterator<Item = &'a [GridPoint]>,
    radius: i64,
    chord: i64,
) -> Vec<RawPart> {
    let paths: Vec<Vec<IntPoint<i64>>> = contours.map(to_engine).collect();
    let style = IntOutlineStyle::new(radius).line_join(round_join(radius, chord));
    match paths.outline_custom(&style, IntOverlayOptions::keep_output_points()) {
        Ok(shapes) => from_engine(shapes),
        Err(never) => unreachable!("only the bounds check reports errors: {never}"),
    }
}

/// The largest angular step whose chords stay within `chord` of a circle of `radius`, in the range that the
/// engine takes (0.35 to 45 degrees).
fn round_join(radius: i64, chord: i64) -> IntLineJoin {
    let sagitta = (chord.max(1) as f64 / radius.unsigned_abs().max(1) as f64).min(1.0);
    let turns = 2.0 * (1.0 - sagitta).acos() / std::f64::consts::TAU;
    let bits = (turns * 2f64.powi(32)).min(f64::from(u32::MAX)) as u32;
    IntLineJoin::Round(ArcOptions { max_step: Angle::from_bits(bits), ..ArcOptions::default() })
}
