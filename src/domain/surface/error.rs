//! Why a model cannot be used, or no curve lies on it.

use glam::DVec3;
use thiserror::Error;

/// Why a model cannot be used, or no curve lies on it. Positions are in millimetres, in the coordinates of the model.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SurfaceError {
    /// There is no facet, or none with an area.
    #[error("the model has no facet with an area; export it again as triangles")]
    Empty,
    /// There are more facets than can be numbered.
    #[error("the model has more than {most} facets; simplify it")]
    TooMany {
        /// The most facets.
        most: usize,
    },
    /// The model ends under a band, or turns away from it.
    #[error(
        "the model ends or turns away under the band, {off_mm:.2} mm beside its curve at ({:.2}, {:.2}, {:.2}) mm, {at_mm:.2} mm along it; use a narrower --width, or lead the curve elsewhere",
        position.x, position.y, position.z
    )]
    Beyond {
        /// A place of the flat band without the model under it.
        position: DVec3,
        /// Where along the curve.
        at_mm: f64,
        /// How far beside it.
        off_mm: f64,
    },
    /// A corner is not a place.
    #[error(
        "facet {facet} has a corner that is not a place within 2 m of the origin, which is as far as the numbers of mesh files are fine enough; move or scale the model, whose unit is the millimetre"
    )]
    Coordinates {
        /// Which, from 1.
        facet: usize,
    },
    /// An edge has three facets or more.
    #[error(
        "{facets} facets share the edge from ({:.3}, {:.3}, {:.3}) to ({:.3}, {:.3}, {:.3}) mm{}, so the model has no inside there; unite its parts (a boolean union) or take the inner walls out",
        ends[0].x, ends[0].y, ends[0].z, ends[1].x, ends[1].y, ends[1].z, others(*more)
    )]
    Crowded {
        /// The ends of the edge.
        ends: [DVec3; 2],
        /// How many facets it has.
        facets: usize,
        /// How many further edges are like it.
        more: usize,
    },
    /// A facet without area cannot be taken out.
    #[error(
        "the facet at ({:.3}, {:.3}, {:.3}) mm has no area and cannot be mended by turning its longest edge, as there is such an edge already; mend the model in a mesh editor",
        position.x, position.y, position.z
    )]
    Flat {
        /// Where.
        position: DVec3,
    },
    /// The model has one side only.
    #[error(
        "the model has one side only, as a Möbius band has: facets cannot be turned the same way around ({:.3}, {:.3}, {:.3}) mm; give it a thickness, or cut it open",
        position.x, position.y, position.z
    )]
    OneSided {
        /// Where.
        position: DVec3,
    },
    /// The model has a border and must not.
    #[error(
        "the model is open at ({:.3}, {:.3}, {:.3}) mm ({loops} border(s)) and has no inside; close it, or give it a wall with --shell MM",
        position.x, position.y, position.z
    )]
    Open {
        /// A corner of the longest border.
        position: DVec3,
        /// How many borders there are.
        loops: usize,
    },
    /// A plane misses the model.
    #[error(
        "there is nothing to go around at a height of {height_mm} mm: the model reaches from {low_mm:.3} to {high_mm:.3} mm; use a height between"
    )]
    Height {
        /// The height asked for.
        height_mm: f64,
        /// The lowest place of the model.
        low_mm: f64,
        /// The highest.
        high_mm: f64,
    },
    /// Too few control points.
    #[error("{found} point(s) make no curve; at least {wanted} that lie apart are needed")]
    Points {
        /// How many there are.
        found: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// A control point is not a place.
    #[error("point {number} has a coordinate that is not a number; write x, y and z in millimetres")]
    Control {
        /// Which, from 1.
        number: usize,
    },
    /// A control point is not on the surface.
    #[error(
        "point {number} is {distance_mm:.3} mm off the surface, and at most {tolerance_mm} mm are allowed; the nearest place of the model is ({:.3}, {:.3}, {:.3}) mm",
        nearest.x, nearest.y, nearest.z
    )]
    Off {
        /// Which, from 1.
        number: usize,
        /// How far it is away.
        distance_mm: f64,
        /// How far it may be.
        tolerance_mm: f64,
        /// The nearest place of the model.
        nearest: DVec3,
    },
    /// Two control points in a row are one place of the model.
    #[error("point {number} and the next one are both at ({:.3}, {:.3}, {:.3}) mm of the model; leave one of them out", position.x, position.y, position.z)]
    Twice {
        /// The first of them, from 1.
        number: usize,
        /// Where.
        position: DVec3,
    },
    /// Two control points in a row are on different parts.
    #[error(
        "point {number} at ({:.3}, {:.3}, {:.3}) mm and the next one are on parts of the model that do not hang together; a curve stays on one part",
        position.x, position.y, position.z
    )]
    Parts {
        /// The first of them, from 1.
        number: usize,
        /// Where.
        position: DVec3,
    },
    /// The curve goes round a handle in two ways.
    #[error(
        "the curve goes round a handle of the model lengthwise and across, and meets itself near ({:.3}, {:.3}, {:.3}) mm, so that it cannot be laid flat; go round it in one way only",
        position.x, position.y, position.z
    )]
    Handle {
        /// Where.
        position: DVec3,
    },
    /// The curve is all over the model.
    #[error(
        "the facets around the curve near ({:.3}, {:.3}, {:.3}) mm are all of the model, so that it cannot be cut open beside it; divide its facets into smaller ones (remesh)",
        position.x, position.y, position.z
    )]
    Coarse {
        /// Where it begins.
        position: DVec3,
    },
    /// The curve leaves the model.
    #[error(
        "the curve leaves the surface between points {number} and {} near ({:.3}, {:.3}, {:.3}) mm, at a border or where the surface around the points ends; add points between them, or move them away from the border",
        number + 1, position.x, position.y, position.z
    )]
    Leaves {
        /// The point before it leaves, from 1.
        number: usize,
        /// The last place on the model.
        position: DVec3,
    },
    /// A facet turned over where the surface was laid flat.
    #[error(
        "the surface around ({:.3}, {:.3}, {:.3}) mm cannot be laid flat: its facets are too thin for the numbers; make them more even (remesh)",
        position.x, position.y, position.z
    )]
    Flipped {
        /// Where.
        position: DVec3,
    },
    /// A wall is no thickness, or makes no mesh.
    #[error(
        "a wall of {wall_mm} mm cannot be made at ({:.3}, {:.3}, {:.3}) mm, where its inner side would turn over or meet itself; use more than 0.01 mm, and less than the model is curved or thick there",
        position.x, position.y, position.z
    )]
    Wall {
        /// The thickness asked for.
        wall_mm: f64,
        /// Where its two sides become one.
        position: DVec3,
    },
}

fn others(more: usize) -> String {
    match more {
        0 => String::new(),
        1 => " (and there is 1 more such edge)".to_owned(),
        n => format!(" (and there are {n} more such edges)"),
    }
}
