//! Whether the attributes and properties of one element mean what they say.
//!
//! The SVG library falls back to a default, truncates, or leaves an element out when a value cannot be read.
//! For a maker that is scrap. So every value that shapes the ink is parsed here first, by the same parsers,
//! and one that would be passed over is an error with its line.

use std::str::FromStr;

use roxmltree::Node;
use svgtypes::{
    AspectRatio, Length, LengthListParser, LengthUnit, NumberListParser, Paint, PathParser, PathSegment,
    PointsParser, Transform, ViewBox,
};

use super::error::{ExemplarFault, shortened};
use super::limits::Limits;
use super::source::Source;
use super::style::Declared;

/// The attributes of each shape that are lengths, and whether a shape exists only when it is positive.
const LENGTHS: [(&str, &[&str], &[&str]); 5] = [
    ("rect", &["x", "y", "rx", "ry"], &["width", "height"]),
    ("circle", &["cx", "cy"], &["r"]),
    ("ellipse", &["cx", "cy"], &["rx", "ry"]),
    ("line", &["x1", "y1", "x2", "y2"], &[]),
    ("use", &["x", "y", "width", "height"], &[]),
];

/// The checks of one document.
pub(super) struct Checker<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) limits: &'a Limits,
}

impl Checker<'_> {
    fn invalid(&self, node: Node, name: &str, value: &str, wanted: impl Into<String>) -> ExemplarFault {
        ExemplarFault::Attribute {
            place: self.source.place(node),
            name: name.to_owned(),
            value: shortened(value),
            wanted: wanted.into(),
        }
    }

    fn in_range(&self, node: Node, value: f64) -> Result<(), ExemplarFault> {
        let limit = self.limits.coordinate;
        if value.is_finite() && value.abs() <= limit {
            return Ok(());
        }
        Err(ExemplarFault::Coordinate { place: self.source.place(node), value, limit, unit: "user units" })
    }

    fn length(&self, node: Node, name: &str, value: &str) -> Result<Length, ExemplarFault> {
        let length = Length::from_str(value).map_err(|_| {
            self.invalid(node, name, value, "a number with a unit such as px or mm is wanted")
        })?;
        self.in_range(node, length.number)?;
        Ok(length)
    }

    /// The number of path segments of a shape that is read completely; 0 for a path without data.
    pub(super) fn shape(&self, node: Node, tag: &str) -> Result<usize, ExemplarFault> {
        match tag {
            "path" => node.attribute("d").map_or(Ok(0), |d| self.path_data(node, d)),
            "polyline" | "polygon" => self.points(node, tag),
            _ => self.lengths(node, tag).map(|()| 8),
        }
    }

    /// The lengths that place and size an element.
    pub(super) fn lengths(&self, node: Node, tag: &str) -> Result<(), ExemplarFault> {
        let Some((_, any, positive)) = LENGTHS.iter().find(|(t, ..)| *t == tag) else { return Ok(()) };
        for name in *any {
            if let Some(value) = node.attribute(*name) {
                self.length(node, name, value)?;
            }
        }
        for name in *positive {
            let value = node.attribute(*name).unwrap_or_default();
            let one_radius = tag == "ellipse" && value.is_empty();
            if one_radius && ["rx", "ry"].iter().any(|n| node.has_attribute(*n)) {
                continue;
            }
            let wanted = "it must be greater than 0 for the shape to exist";
            if value.is_empty() || self.length(node, name, value)?.number <= 0.0 {
                return Err(self.invalid(node, name, value, wanted));
            }
        }
        Ok(())
    }

    fn path_data(&self, node: Node, d: &str) -> Result<usize, ExemplarFault> {
        let mut count = 0;
        for segment in PathParser::from(d) {
            let segment = segment.map_err(|e| self.bad_path_data(node, d, count, &e))?;
            for number in numbers(&segment) {
                self.in_range(node, number)?;
            }
            count += 1;
        }
        if count == 0 && !d.trim().is_empty() && d.trim() != "none" {
            return Err(self.bad_path_data(node, d, 0, &svgtypes::Error::InvalidValue));
        }
        Ok(count)
    }

    fn bad_path_data(&self, node: Node, d: &str, segment: usize, error: &svgtypes::Error) -> ExemplarFault {
        use svgtypes::Error;
        // The library counts characters from 1.
        let at = match *error {
            Error::UnexpectedEndOfStream => d.chars().count(),
            Error::UnexpectedData(at) | Error::InvalidChar(_, at) | Error::InvalidString(_, at) => at,
            Error::InvalidNumber(at) => at,
            _ => 1,
        };
        let near: String = d.chars().skip(at.saturating_sub(10)).take(20).collect();
        ExemplarFault::PathData { place: self.source.place(node), segment, at, near }
    }

    fn points(&self, node: Node, tag: &str) -> Result<usize, ExemplarFault> {
        let value = node.attribute("points").unwrap_or_default();
        let wrong = |wanted: &str| self.invalid(node, "points", value, wanted);
        let mut numbers = 0;
        for number in NumberListParser::from(value) {
            self.in_range(node, number.map_err(|_| wrong("a list of numbers is wanted"))?)?;
            numbers += 1;
        }
        let points = PointsParser::from(value).count();
        let least = if tag == "polygon" { 3 } else { 2 };
        if numbers % 2 == 1 || points * 2 != numbers {
            return Err(wrong("an even number of coordinates is wanted"));
        }
        if points < least {
            return Err(wrong(&format!("at least {least} points are wanted, {points} found")));
        }
        Ok(points)
    }

    /// The size and view box of an element that has its own coordinates.
    pub(super) fn viewport(&self, node: Node) -> Result<(), ExemplarFault> {
        for name in ["width", "height"] {
            let Some(value) = node.attribute(name).filter(|v| *v != "auto") else { continue };
            if self.length(node, name, value)?.number <= 0.0 {
                return Err(ExemplarFault::PageSize { place: self.source.place(node) });
            }
        }
        self.view_box(node)
    }

    /// The view box of an element that has its own coordinates.
    pub(super) fn view_box(&self, node: Node) -> Result<(), ExemplarFault> {
        if let Some(value) = node.attribute("viewBox") {
            let wanted = "four numbers are wanted: x, y, width and height, the last two positive";
            let view_box =
                ViewBox::from_str(value).map_err(|_| self.invalid(node, "viewBox", value, wanted))?;
            for number in [view_box.x, view_box.y, view_box.w, view_box.h] {
                self.in_range(node, number)?;
            }
        }
        if let Some(value) = node.attribute("preserveAspectRatio") {
            AspectRatio::from_str(value).map_err(|_| {
                self.invalid(node, "preserveAspectRatio", value, "a value such as xMidYMid is wanted")
            })?;
        }
        Ok(())
    }

    /// Whether the value of a property means something, and something that ink can represent.
    pub(super) fn property(&self, node: Node, declared: &Declared) -> Result<(), ExemplarFault> {
        let Declared { name, value, styled, .. } = *declared;
        let invalid = |wanted: &str| Err(self.invalid(node, name, value, wanted));
        let unsupported = |what: &str, remedy| {
            Err(ExemplarFault::Unsupported { place: self.source.place(node), what: what.to_owned(), remedy })
        };
        if value == "inherit" {
            return Ok(());
        }
        match name {
            "fill" | "stroke" if Paint::from_str(value).is_err() => {
                return invalid("a colour is wanted, such as #000, black or none");
            }
            "opacity" | "fill-opacity" | "stroke-opacity" if opacity(value).is_none() => {
                return invalid("a number from 0 to 1 or a percentage is wanted");
            }
            "stroke-width" if self.length(node, name, value)?.number < 0.0 => {
                return invalid("a stroke width is 0 or more");
            }
            "stroke-dashoffset" => {
                self.length(node, name, value)?;
            }
            "stroke-miterlimit" if finite_number(value).is_none_or(|n| n < 1.0) => {
                return invalid("a number of 1 or more is wanted");
            }
            "stroke-dasharray" if value != "none" => {
                for dash in LengthListParser::from(value) {
                    if !dash.is_ok_and(|d| d.number >= 0.0 && d.number.is_finite()) {
                        return invalid("lengths of 0 or more are wanted");
                    }
                }
            }
            "fill-rule" | "clip-rule" if !["nonzero", "evenodd"].contains(&value) => {
                return invalid("nonzero or evenodd is wanted");
            }
            "stroke-linecap" if !["butt", "round", "square"].contains(&value) => {
                return invalid("butt, round or square is wanted");
            }
            "stroke-linejoin" if ["miter-clip", "arcs"].contains(&value) => {
                return unsupported(
                    &format!("has the line join {value}, which is not drawn here"),
                    "use miter, round or bevel, or convert the stroke to a path",
                );
            }
            "stroke-linejoin" if !["miter", "round", "bevel"].contains(&value) => {
                return invalid("miter, round or bevel is wanted");
            }
            "transform" => return self.transform(node, value),
            "mask" | "filter" if value != "none" => {
                return unsupported(
                    &format!("has a {name}, which acts on pixels"),
                    "remove it, or draw its effect as paths",
                );
            }
            "mix-blend-mode" if styled && value != "normal" => {
                return unsupported(
                    &format!("is blended ({value}) with what lies below"),
                    "set mix-blend-mode to normal",
                );
            }
            "vector-effect" if value != "none" => {
                return unsupported(
                    &format!("has the vector effect {value}, which depends on the viewer's scale"),
                    "remove it, or convert the stroke to a path",
                );
            }
            "paint-order" if value.contains("markers") => {
                return unsupported("paints its markers in an unusual order", "remove paint-order");
            }
            "d" | "x" | "y" | "cx" | "cy" | "r" | "rx" | "ry" | "translate" | "rotate" | "scale"
            | "offset-path"
                if styled =>
            {
                return unsupported(
                    &format!("has its {name} in a style, which is not read there"),
                    "write it as an attribute (save as plain SVG)",
                );
            }
            _ => {}
        }
        Ok(())
    }

    /// The transform attribute of an element, if it has one.
    pub(super) fn transforms(&self, node: Node) -> Result<(), ExemplarFault> {
        node.attribute("transform").map_or(Ok(()), |value| self.transform(node, value.trim()))
    }

    fn transform(&self, node: Node, value: &str) -> Result<(), ExemplarFault> {
        if value == "none" {
            return Ok(());
        }
        let wanted = "a list such as translate(1 2) rotate(30) in user units and degrees is wanted";
        let t = Transform::from_str(value).map_err(|_| self.invalid(node, "transform", value, wanted))?;
        for number in [t.a, t.b, t.c, t.d, t.e, t.f] {
            self.in_range(node, number)?;
        }
        // The library leaves out what is scaled to nothing; this is its bound.
        let (sx, sy) = (t.a.hypot(t.c), t.b.hypot(t.d));
        if sx.min(sy) < f64::from(f32::EPSILON) || (t.a * t.d - t.b * t.c) == 0.0 {
            return Err(self.invalid(
                node,
                "transform",
                value,
                "it flattens the element to nothing; remove the element",
            ));
        }
        Ok(())
    }
}

fn finite_number(value: &str) -> Option<f64> {
    svgtypes::Number::from_str(value).ok().map(|n| n.0).filter(|n| n.is_finite())
}

fn opacity(value: &str) -> Option<f64> {
    let length = Length::from_str(value).ok()?;
    let number = match length.unit {
        LengthUnit::None => length.number,
        LengthUnit::Percent => length.number / 100.0,
        _ => return None,
    };
    (0.0..=1.0).contains(&number).then_some(number)
}

/// The numbers of a segment.
fn numbers(segment: &PathSegment) -> impl Iterator<Item = f64> {
    let all = match *segment {
        PathSegment::MoveTo { x, y, .. }
        | PathSegment::LineTo { x, y, .. }
        | PathSegment::SmoothQuadratic { x, y, .. } => [x, y, 0.0, 0.0, 0.0, 0.0],
        PathSegment::HorizontalLineTo { x, .. } => [x, 0.0, 0.0, 0.0, 0.0, 0.0],
        PathSegment::VerticalLineTo { y, .. } => [y, 0.0, 0.0, 0.0, 0.0, 0.0],
        PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => [x1, y1, x2, y2, x, y],
        PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => [x2, y2, x, y, 0.0, 0.0],
        PathSegment::Quadratic { x1, y1, x, y, .. } => [x1, y1, x, y, 0.0, 0.0],
        PathSegment::EllipticalArc { rx, ry, x_axis_rotation, x, y, .. } => {
            [rx, ry, x_axis_rotation, x, y, 0.0]
        }
        PathSegment::ClosePath { .. } => [0.0; 6],
    };
    all.into_iter()
}
