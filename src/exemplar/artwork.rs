//! The painted shapes of a drawing as curves in millimetres, with the clips that act on them.
//!
//! The SVG library has resolved styles, `use`, markers and units; here its tree is walked once, paint is judged
//! (what is opaque is ink, what is half there is refused), and transforms are gathered. Coordinates come out
//! as `f64`, y up, in a page that keeps the drawing's place: y = page height - y in the file.

use std::collections::{BTreeMap, HashMap};

use kurbo::{Affine, BezPath, Cap, Join, Stroke};
use usvg::tiny_skia_path::PathSegment;
use usvg::{Group, Node, Paint};

use super::error::{ExemplarFault, Place};
use super::limits::Limits;
use super::scan::Scan;
use super::source::{Labels, Source};
use crate::planar::FillRule;

/// Millimetres to a CSS pixel.
pub(super) const MM_PER_PX: f64 = 25.4 / 96.0;
/// Opacities this close to 0 or 1 are 0 or 1: the library keeps them as `f32`.
const OPACITY_EPSILON: f32 = 1e-4;

/// How a shape is painted.
#[derive(Debug, Clone)]
pub(super) enum Brush {
    Fill(FillRule),
    /// The fill of a shape that has a stroke too: it may enclose nothing, as SVG fills even a line by default.
    FillUnderStroke(FillRule),
    Stroke(Stroke),
}

/// One fill or one stroke.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) place: Place,
    /// The path in its own user units.
    pub(super) path: BezPath,
    /// From user units to millimetres with y up.
    pub(super) to_mm: Affine,
    pub(super) brush: Brush,
    /// The number of the innermost `g` or `use` around it.
    pub(super) holder: Option<usize>,
}

/// A `g` or a `use` as it is drawn: one for each time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Holder {
    /// The number of the next one around, which is smaller than its own.
    pub(super) around: Option<usize>,
    /// Whether it is a layer of Inkscape.
    pub(super) is_layer: bool,
}

/// A shape, or items of which only the part inside a clip is ink.
#[derive(Debug, Clone)]
pub(super) enum Item<S> {
    Shape(S),
    Clipped(Vec<Self>, Clip<S>),
}

/// The union of some items, cut down to `within` when there is one.
#[derive(Debug, Clone)]
pub(super) struct Clip<S> {
    pub(super) items: Vec<Item<S>>,
    pub(super) within: Option<Box<Clip<S>>>,
}

impl<S> Item<S> {
    /// The item with `f` applied to every shape.
    pub(super) fn try_map<T, E>(&self, f: &mut impl FnMut(&S) -> Result<T, E>) -> Result<Item<T>, E> {
        Ok(match self {
            Self::Shape(shape) => Item::Shape(f(shape)?),
            Self::Clipped(items, clip) => {
                Item::Clipped(items.iter().map(|i| i.try_map(f)).collect::<Result<_, _>>()?, clip.try_map(f)?)
            }
        })
    }
}

impl<S> Clip<S> {
    fn try_map<T, E>(&self, f: &mut impl FnMut(&S) -> Result<T, E>) -> Result<Clip<T>, E> {
        let within = self.within.as_ref().map(|w| w.try_map(f)).transpose()?;
        Ok(Clip {
            items: self.items.iter().map(|i| i.try_map(f)).collect::<Result<_, _>>()?,
            within: within.map(Box::new),
        })
    }
}

/// A drawing.
#[derive(Debug, Clone)]
pub(super) struct Artwork {
    pub(super) items: Vec<Item<Shape>>,
    pub(super) holders: Vec<Holder>,
    pub(super) page_mm: (f64, f64),
    pub(super) notes: Vec<String>,
}

/// The SVG library's tree of a labelled document.
pub(super) fn library_tree(source: &Source, limits: &Limits) -> Result<(usvg::Tree, Labels), ExemplarFault> {
    let (text, labels) = source.labelled();
    let options = usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(&text, &options).map_err(|e| match e {
        usvg::Error::InvalidSize => ExemplarFault::PageSize { place: source.place(source.root()) },
        usvg::Error::ElementsLimitReached
        | usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => {
            ExemplarFault::TooManyElements { limit: limits.elements }
        }
        e => ExemplarFault::NotXml { detail: e.to_string() },
    })?;
    Ok((tree, labels))
}

/// From CSS pixels with y down to millimetres with y up, on a page of this height in pixels.
pub(super) fn page_to_mm(height_px: f64) -> Affine {
    Affine::new([MM_PER_PX, 0.0, 0.0, -MM_PER_PX, 0.0, height_px * MM_PER_PX])
}

impl Artwork {
    /// The painted shapes of `source`; everything that `scan` expects must be there.
    pub(super) fn new(source: &Source, scan: Scan, limits: &Limits) -> Result<Self, ExemplarFault> {
        let (tree, labels) = library_tree(source, limits)?;
        let size = tree.size();
        let mut collector = Collector {
            labels: &labels,
            fallback: source.place(source.root()),
            kept: HashMap::new(),
            holders: Vec::new(),
            paints: Paints::default(),
        };
        let at = Position {
            transform: page_to_mm(f64::from(size.height())),
            place: None,
            anchor: None,
            holder: None,
            counted: true,
        };
        let items = collector.group(tree.root(), &at)?;
        let Collector { kept, paints, holders, .. } = collector;
        compare(&scan.expected, &kept)?;
        if scan.expected.is_empty() {
            return Err(ExemplarFault::NothingDrawn);
        }
        let mut notes = scan.notes;
        if let Some(place) = paints.first_white {
            if paints.coloured > 0 {
                return Err(ExemplarFault::White { place, count: paints.white });
            }
            notes.push("everything is painted white, so white is read as ink".to_owned());
        } else if paints.coloured == 0 {
            return Err(ExemplarFault::NoInk);
        }
        let page_mm = (f64::from(size.width()) * MM_PER_PX, f64::from(size.height()) * MM_PER_PX);
        Ok(Self { items, holders, page_mm, notes })
    }
}

/// Nothing that the scan saw may be missing.
fn compare(
    expected: &BTreeMap<String, (usize, Place)>,
    kept: &HashMap<String, usize>,
) -> Result<(), ExemplarFault> {
    let missing =
        expected.iter().filter(|(label, (count, _))| kept.get(*label).copied().unwrap_or(0) < *count);
    match missing.map(|(_, (_, place))| place).min_by_key(|place| place.line) {
        Some(place) => Err(ExemplarFault::Dropped { place: place.clone() }),
        None => Ok(()),
    }
}

#[derive(Default)]
struct Paints {
    white: usize,
    coloured: usize,
    first_white: Option<Place>,
}

/// Where the walk is in the tree.
#[derive(Clone)]
struct Position<'t> {
    transform: Affine,
    /// The nearest named element around.
    place: Option<&'t Place>,
    /// The label of the outermost `use` around.
    anchor: Option<&'t str>,
    /// The number of the innermost `g` or `use` around.
    holder: Option<usize>,
    /// False inside clip paths, whose shapes are no ink.
    counted: bool,
}

struct Collector<'t> {
    labels: &'t Labels,
    fallback: Place,
    kept: HashMap<String, usize>,
    holders: Vec<Holder>,
    paints: Paints,
}

impl<'t> Collector<'t> {
    fn group(&mut self, group: &'t Group, outer: &Position<'t>) -> Result<Vec<Item<Shape>>, ExemplarFault> {
        let id = group.id();
        let mut at = outer.clone();
        at.transform = outer.transform * affine(group.transform());
        at.place = self.labels.place(id).or(outer.place);
        if at.anchor.is_none() && self.labels.is_use(id) {
            at.anchor = Some(id);
        }
        if self.labels.place(id).is_some() {
            at.holder = Some(self.holders.len());
            self.holders.push(Holder { around: outer.holder, is_layer: self.labels.is_layer(id) });
        }
        let mut items = Vec::new();
        for node in group.children() {
            match node {
                Node::Group(inner) => items.extend(self.group(inner, &at)?),
                Node::Path(path) => self.path(path, &at, &mut items)?,
                Node::Image(_) | Node::Text(_) => {
                    return Err(ExemplarFault::Dropped { place: self.place(node.id(), &at) });
                }
            }
        }
        self.judge(group, &at)?;
        if group.opacity().get() <= OPACITY_EPSILON {
            return Ok(Vec::new());
        }
        match group.clip_path() {
            Some(clip) if !items.is_empty() => Ok(vec![Item::Clipped(items, self.clip(clip, &at)?)]),
            _ => Ok(items),
        }
    }

    /// The name of the element with this id, or of the nearest one around it.
    fn place(&self, id: &str, at: &Position) -> Place {
        self.labels.place(id).or(at.place).unwrap_or(&self.fallback).clone()
    }

    /// Refuses a group that acts on pixels.
    fn judge(&self, group: &Group, at: &Position) -> Result<(), ExemplarFault> {
        // The library wraps a lone shape with an opacity in a group without an id.
        let named = || match group.children() {
            [only] if group.id().is_empty() => self.place(only.id(), at),
            _ => self.place(group.id(), at),
        };
        let opacity = group.opacity().get();
        if partial(opacity) {
            return Err(ExemplarFault::PartialOpacity { place: named(), what: "an opacity of", opacity });
        }
        if group.mask().is_some() || !group.filters().is_empty() {
            let what = "has a mask or filter, which acts on pixels".to_owned();
            return Err(ExemplarFault::Unsupported {
                place: named(),
                what,
                remedy: "remove it, or draw its effect as paths",
            });
        }
        Ok(())
    }

    fn clip(&mut self, clip: &'t usvg::ClipPath, at: &Position<'t>) -> Result<Clip<Shape>, ExemplarFault> {
        let within = clip.clip_path().map(|outer| self.clip(outer, at)).transpose()?.map(Box::new);
        let inside =
            Position { transform: at.transform * affine(clip.transform()), counted: false, ..at.clone() };
        Ok(Clip { items: self.group(clip.root(), &inside)?, within })
    }

    fn path(
        &mut self,
        path: &'t usvg::Path,
        at: &Position<'t>,
        items: &mut Vec<Item<Shape>>,
    ) -> Result<(), ExemplarFault> {
        if at.counted {
            let label = at.anchor.unwrap_or(path.id());
            *self.kept.entry(label.to_owned()).or_default() += 1;
        }
        if !path.is_visible() {
            return Ok(());
        }
        let place = self.place(path.id(), at);
        let shape = |brush| {
            let path = bez_path(path.data());
            Item::Shape(Shape { place: place.clone(), path, to_mm: at.transform, brush, holder: at.holder })
        };
        let mut inked =
            |paint, opacity: usvg::Opacity, what| self.is_ink(paint, opacity.get(), what, &place, at);
        let fill = match path.fill() {
            Some(fill) if inked(fill.paint(), fill.opacity(), "a fill opacity of")? => Some(fill),
            _ => None,
        };
        let stroke = match path.stroke() {
            Some(stroke) if inked(stroke.paint(), stroke.opacity(), "a stroke opacity of")? => Some(stroke),
            _ => None,
        };
        if let Some(fill) = fill {
            let rule = fill_rule(fill.rule());
            let alone = stroke.is_none();
            items.push(shape(if alone { Brush::Fill(rule) } else { Brush::FillUnderStroke(rule) }));
        }
        items.extend(stroke.map(|stroke| shape(Brush::Stroke(stroke_style(stroke)))));
        Ok(())
    }

    fn is_ink(
        &mut self,
        paint: &Paint,
        opacity: f32,
        what: &'static str,
        place: &Place,
        at: &Position,
    ) -> Result<bool, ExemplarFault> {
        if opacity <= OPACITY_EPSILON {
            return Ok(false);
        }
        if partial(opacity) {
            return Err(ExemplarFault::PartialOpacity { place: place.clone(), what, opacity });
        }
        let stops = match paint {
            Paint::Color(color) => {
                if at.counted {
                    self.paints.note(*color, place);
                }
                return Ok(true);
            }
            Paint::LinearGradient(gradient) => gradient.stops(),
            Paint::RadialGradient(gradient) => gradient.stops(),
            Paint::Pattern(_) => {
                return Err(ExemplarFault::Unsupported {
                    place: place.clone(),
                    what: "is painted with a pattern".to_owned(),
                    remedy: "convert the pattern to objects (in Inkscape: Object, Pattern, Pattern to Objects), or use a \
                             plain colour",
                });
            }
        };
        if let Some(stop) = stops.iter().find(|stop| stop.opacity().get() < 1.0 - OPACITY_EPSILON) {
            let (what, opacity) =
                ("a gradient that is not opaque, with a stop of opacity", stop.opacity().get());
            return Err(ExemplarFault::PartialOpacity { place: place.clone(), what, opacity });
        }
        self.paints.coloured += 1;
        Ok(true)
    }
}

impl Paints {
    fn note(&mut self, color: usvg::Color, place: &Place) {
        if color == usvg::Color::white() {
            self.white += 1;
            self.first_white.get_or_insert_with(|| place.clone());
        } else {
            self.coloured += 1;
        }
    }
}

fn partial(opacity: f32) -> bool {
    opacity > OPACITY_EPSILON && opacity < 1.0 - OPACITY_EPSILON
}

pub(super) fn fill_rule(rule: usvg::FillRule) -> FillRule {
    match rule {
        usvg::FillRule::NonZero => FillRule::NonZero,
        usvg::FillRule::EvenOdd => FillRule::EvenOdd,
    }
}

pub(super) fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

pub(super) fn bez_path(data: &usvg::tiny_skia_path::Path) -> BezPath {
    let point = |p: usvg::tiny_skia_path::Point| kurbo::Point::new(f64::from(p.x), f64::from(p.y));
    let mut path = BezPath::with_capacity(data.len());
    for segment in data.segments() {
        match segment {
            PathSegment::MoveTo(p) => path.move_to(point(p)),
            PathSegment::LineTo(p) => path.line_to(point(p)),
            PathSegment::QuadTo(a, p) => path.quad_to(point(a), point(p)),
            PathSegment::CubicTo(a, b, p) => path.curve_to(point(a), point(b), point(p)),
            PathSegment::Close => path.close_path(),
        }
    }
    path
}

fn stroke_style(stroke: &usvg::Stroke) -> Stroke {
    let width = f64::from(stroke.width().get());
    let cap = match stroke.linecap() {
        usvg::LineCap::Butt => Cap::Butt,
        usvg::LineCap::Round => Cap::Round,
        usvg::LineCap::Square => Cap::Square,
    };
    let join = match stroke.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => Join::Miter,
        usvg::LineJoin::Round => Join::Round,
        usvg::LineJoin::Bevel => Join::Bevel,
    };
    let style = Stroke::new(width)
        .with_caps(cap)
        .with_join(join)
        .with_miter_limit(f64::from(stroke.miterlimit().get()));
    match stroke.dasharray() {
        Some(dashes) => style.with_dashes(
            f64::from(stroke.dashoffset()),
            dashes.iter().map(|&d| f64::from(d)).collect::<Vec<_>>(),
        ),
        None => style,
    }
}
