//! From a flat region to a solid: snapping to what a file can hold, triangulation, extrusion along z.
//!
//! A mesh file holds 32-bit floats. Rounding to them at the very end would move vertices after the last
//! check, so the region is first brought onto a grid whose points are exact in `f32` and checked *there*;
//! the caps are triangulated in integers with every boundary vertex kept, and the walls stand on the same
//! vertices. The solid is therefore closed by construction and writing it changes nothing: a region of b0
//! components and b1 holes becomes b0 shells of total genus b1.
//!
//! Before that, bridges may give the region other counts ([`bridge()`]), and what is too thin or too narrow for a machine
//! ([`Process`]) may be mended ([`enforce()`], [`enforce_in_box`]). For a beam instead of a printer, contours make room for the kerf
//! ([`compensated`]), and the part lies on a plate or is carved out of it ([`on_sheet`], [`carved`]). What a machine will make nothing of is found
//! before it does ([`filled_bays`], [`burnt_limbs`], [`thin_everywhere`], [`smaller_than`]).
//!
//! Walls may be bevelled or sloped ([`raise()`]), the number of triangles limited ([`raise_within`]), and the part turned
//! to fit a printer ([`Bed`]).
//!
//! On a curved sheet, as a ring or a helix, back and front are one triangulation that no line of the sheet crosses ([`wrap()`]).
//!
//! Solids may be moved, united and taken from each other ([`union`], [`difference`], [`intersection`], [`Solid::moved`]), and facets from
//! elsewhere become a solid where they bound one ([`Solid::from_facets`]).
//!
//! Excluded: files. Nothing here knows how the region came to be.

mod bays;
mod bed;
mod boolean;
mod bridge;
mod caps;
mod enforce;
mod facets;
mod gap;
mod in_box;
mod inset;
mod kerf;
mod limbs;
mod limit;
mod lines;
mod material;
mod process;
mod profile;
mod raise;
mod sheet;
mod simplify;
mod slivers;
mod small;
mod snap;
mod solid;
mod workshop;
mod wrap;

pub use bays::{FilledBay, filled_bays};
pub use bed::Bed;
pub use boolean::{Body, Overlap, difference, intersection, union};
pub use bridge::{Bridge, BridgeError, BridgeKind, BridgeOptions, Bridged, Counts, bridge};
pub use enforce::{Change, EnforceError, EnforceOptions, Enforced, TIP, enforce};
pub use gap::{Gap, gap};
pub use in_box::{Pressed, enforce_in_box};
pub use kerf::{KerfError, check_kerf, compensated};
pub use limbs::{BurntLimb, burnt_limbs};
pub use limit::{Limited, raise_within};
pub use material::{Material, MaterialReport};
pub use process::{CUT_COLOUR, ENGRAVE_COLOUR, Process, table as process_table};
pub use profile::Profile;
pub use raise::raise;
pub use sheet::{Carved, FallenPiece, SheetError, SheetSize, carved, on_sheet, plate, shift_onto};
pub use small::{smaller_than, thin_everywhere};
pub use snap::snapped_to_f32;
pub use solid::{Shell, Solid, extrude};
pub use workshop::{Workshop, WorkshopError};
pub use wrap::{Sheet, wrap};

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::planar::GridError;

/// Why a region cannot become a solid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FabricateError {
    /// The region has no ink.
    #[error("there is nothing to extrude: the region is empty")]
    Empty,
    /// The thickness is not a usable length.
    #[error("the thickness is {found_mm} mm; it must be from 0.001 to 100000 mm")]
    Thickness {
        /// What was given.
        found_mm: f64,
    },
    /// The chamfer is not a usable length.
    #[error(
        "the chamfer is {found_mm} mm; it must be at least 0.01 mm and less than half of the thickness of \
         {thickness_mm} mm"
    )]
    Chamfer {
        /// What was given.
        found_mm: f64,
        /// The thickness of the solid.
        thickness_mm: f64,
    },
    /// The taper is not a usable angle.
    #[error("the taper is {found_deg} degrees; it must be more than 0 and less than 45")]
    Taper {
        /// What was given.
        found_deg: f64,
    },
    /// Walls cannot go in as far as they are to without changing components or holes.
    #[error(
        "near ({:.3}, {:.3}) mm the ink is too narrow for walls that go in by {inset_mm:.3} mm: components or \
         holes would change; {remedy}", position_mm.x, position_mm.y
    )]
    Inset {
        /// Where, in millimetres.
        position_mm: DVec2,
        /// How far the walls are to go in.
        inset_mm: f64,
        /// What would do.
        remedy: String,
    },
    /// A solid cannot keep the chord error with so few triangles.
    #[error(
        "the solid has {found} triangles at least within a chord error of {chord_mm} mm; at most {most} are \
         allowed; {remedy}"
    )]
    TooManyTriangles {
        /// The fewest that were found.
        found: usize,
        /// How many are allowed.
        most: usize,
        /// The chord error that was asked for.
        chord_mm: f64,
        /// What would do.
        remedy: String,
    },
    /// The part is higher than the printer's room.
    #[error(
        "the part is {height_mm:.2} mm high, and the bed of {} has room for {} mm; make it thinner, with a smaller \
         --thickness, or give a higher bed", room(bed), bed.height_mm.unwrap_or(f64::INFINITY)
    )]
    TooHigh {
        /// The height of the part.
        height_mm: f64,
        /// The bed.
        bed: Bed,
    },
    /// The part does not fit the printer.
    #[error(
        "the part is {:.2} x {:.2} x {:.2} mm and does not fit a bed of {}, not even turned by {turn_deg:.1} \
         degrees to {:.2} x {:.2} mm; make it smaller, or give a larger bed",
        part_mm[0], part_mm[1], part_mm[2], room(bed), turned_mm[0], turned_mm[1]
    )]
    Bed {
        /// Width, depth and height as it is.
        part_mm: [f64; 3],
        /// The turn that comes nearest to fitting.
        turn_deg: f64,
        /// Width and depth when it is turned.
        turned_mm: [f64; 2],
        /// The bed.
        bed: Bed,
    },
    /// The region's extent does not fit the grid of 32-bit floats.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Features are finer than the 32-bit floats of a mesh file can tell apart.
    #[error(
        "at ({:.4}, {:.4}) mm contours are closer than the {step_mm:.1e} mm that a mesh file resolves at this \
         size; in 32-bit floats {found_components} component(s) and {found_holes} hole(s) would remain of \
         {components} and {holes}; move the drawing nearer to the origin, scale it up, or set a minimum \
         feature and gap", position_mm.x, position_mm.y
    )]
    TooFine {
        /// Where, in millimetres.
        position_mm: DVec2,
        /// The distance of neighbouring 32-bit floats at the region's extent.
        step_mm: f64,
        /// Components of the region.
        components: usize,
        /// Holes of the region.
        holes: usize,
        /// Components after snapping.
        found_components: usize,
        /// Holes after snapping.
        found_holes: usize,
    },
    /// The ends of a sheet that are joined do not have the same ink.
    #[error(
        "the ends of the strip do not meet: ink at ({:.3}, {:.3}) mm has none on the other end", position_mm.x, position_mm.y
    )]
    Ends {
        /// A place on one end, in millimetres.
        position_mm: DVec2,
    },
    /// The triangulation of a cap is not the cap: a fault of the engine, caught before it reaches a file.
    #[error(
        "the cap of the component at ({:.4}, {:.4}) mm was not triangulated exactly ({found}); please report \
         this drawing; moving or scaling it slightly is likely to help", position_mm.x, position_mm.y
    )]
    Triangulation {
        /// The least point of the component.
        position_mm: DVec2,
        /// What is wrong with the triangles.
        found: &'static str,
    },
    /// Facets do not bound a solid.
    #[error(
        "the facets do not bound a solid: at ({:.4}, {:.4}, {:.4}) mm {found}", position_mm.x, position_mm.y, position_mm.z
    )]
    Facets {
        /// Where, in millimetres.
        position_mm: DVec3,
        /// What is wrong there.
        found: &'static str,
    },
    /// Facets cross or touch in the 32-bit floats of a mesh file.
    #[error(
        "in the 32-bit floats of a mesh file facets of the result cross or touch each other, also without those that are \
         thinner than {thin_mm:.1e} mm; solids touch along an edge only, or faces nearly coincide: move one of the solids a \
         little"
    )]
    Rounding {
        /// The last thickness that was tried.
        thin_mm: f64,
    },
    /// A motion that leaves no solid.
    #[error("the motion flattens the solid, or is not finite; every factor must be other than 0")]
    Motion,
    /// The engine of unions and differences failed.
    #[error("the engine for unions and differences failed ({found}); please report these solids")]
    Engine {
        /// What it says.
        found: String,
    },
}

fn room(bed: &Bed) -> String {
    let height = bed.height_mm.map_or_else(String::new, |height| format!(" x {height}"));
    format!("{} x {}{height} mm", bed.width_mm, bed.depth_mm)
}
