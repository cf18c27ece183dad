//! Bands along curves in space: what they are in the plane, and the solid that becomes of them.
//!
//! The pattern is made on a flat strip, as long as the curve. The drawing is that strip, at its true size in the middle of the thickness, and
//! the solid is the strip laid along the curve. A closed curve gives a strip whose ends have the same ink ([`super::unrolled`]).

use glam::DVec2;

use super::builder::{BandBuilder, BandJob};
use super::error::JobError;
use super::part::Part;
use super::points::read_points;
use super::print::PrintOptions;
use crate::domain::{CurveSpec, PlanarCurve, SpaceCurve, SpaceMap, Twist};
use crate::fabricate::{self, Solid};
use crate::planar::Tolerances;

/// The part of the chord error that facets along the curve may spend; flattening, bending and the drawing have the rest.
const FACET_SHARE: f64 = 0.5;

/// What is asked of a band along a curve in space, beyond the curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpaceOptions {
    /// The opening of a ring, which makes it a cuff: straight across, inside, in millimetres.
    pub gap_mm: Option<f64>,
    /// How the band is turned about its curve.
    pub twist: Option<Twist>,
}

/// The curve in space that a specification names, if it names one.
///
/// # Errors
/// [`JobError`] for a curve that cannot be read or used, and for a gap where there is no ring.
pub(super) fn read_space_curve(options: &BandBuilder) -> Result<Option<SpaceCurve>, JobError> {
    let middle = |inner_mm: f64| 0.5 * (inner_mm + options.thickness_mm);
    let SpaceOptions { gap_mm, twist } = &options.space;
    let refuse = |option: &'static str, found: &str, wanted: &str| {
        Err(JobError::Option { option, found: found.to_owned(), wanted: wanted.to_owned() })
    };
    if gap_mm.is_some() && !matches!(options.along, CurveSpec::Ring { .. }) {
        return refuse(
            "--gap",
            "only a ring has a gap",
            "use it with --along ring:DIAMETER, or leave it out",
        );
    }
    let curve = match &options.along {
        CurveSpec::Ring { inner_mm } => match *gap_mm {
            Some(gap_mm) => SpaceCurve::cuff(middle(*inner_mm), gap_mm, 0.5 * inner_mm)?,
            None => SpaceCurve::ring(middle(*inner_mm))?,
        },
        CurveSpec::Helix { inner_mm, pitch_mm, turns } => {
            SpaceCurve::helix(middle(*inner_mm), *pitch_mm, *turns)?
        }
        CurveSpec::Points { file } => {
            let read = read_points(file)?;
            SpaceCurve::through(&read.points, read.is_closed)?
        }
        _ if twist.is_some() => {
            let wanted = "use it with --along ring, helix or points, or leave it out";
            return refuse("--twist", "a band in the plane has no twist", wanted);
        }
        _ => return Ok(None),
    };
    let curve = match twist {
        Some(twist) => curve.twisted(twist)?,
        None => curve,
    };
    refuse_flat_edges(&options.print)?;
    if curve.is_closed() && (options.enforce || options.bridge_mm.is_some()) {
        let option = if options.enforce { "--enforce" } else { "--bridge" };
        let wanted = "give a ring a --gap, or ask for what the ornament gives by itself";
        return refuse(option, "the ends of a closed band in space would not meet after it", wanted);
    }
    Ok(Some(curve))
}

/// Edges that follow the surface are not made.
fn refuse_flat_edges(print: &PrintOptions) -> Result<(), JobError> {
    let given = [
        ("--chamfer", print.chamfer_mm.is_some()),
        ("--taper", print.taper_deg.is_some()),
        ("--bed", print.bed.is_some()),
        ("--max-triangles", print.max_triangles.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((option, _)) => Err(JobError::Option {
            option,
            found: "it is for flat parts, and a band along a curve in space has plain edges".to_owned(),
            wanted: "leave it out, or lay the band along a line, circle or path".to_owned(),
        }),
    }
}

/// The curve in the plane that stands for it: a line as long.
pub(super) fn flat(curve: &SpaceCurve) -> Result<PlanarCurve, JobError> {
    Ok(match curve.is_closed() {
        true => PlanarCurve::rolled(curve.length_mm())?,
        false => PlanarCurve::line(curve.length_mm())?,
    })
}

/// The map of a band of `height_mm` along the curve. A ring or a helix is lifted so that it stands at z = 0.
pub(super) fn space_map(job: &BandJob, curve: SpaceCurve, height_mm: f64) -> Result<SpaceMap, JobError> {
    let (half, half_thickness) = (0.5 * height_mm, 0.5 * job.options.thickness_mm);
    let stands = matches!(job.options.along, CurveSpec::Ring { .. } | CurveSpec::Helix { .. });
    let curve = if stands { curve.lifted(half) } else { curve };
    Ok(SpaceMap::new(curve, [-half, half], [-half_thickness, half_thickness])?)
}

/// The tolerances of the flat pattern, so that those that were asked for hold in space, where lengths along the band are longer on the
/// outer side of a bend and shorter on the inner one; and a note where that is much.
pub(super) fn flat_tolerances(asked: &Tolerances, map: &SpaceMap) -> Result<Tolerances, JobError> {
    let [least, most] = map.scales();
    let feature = asked.min_feature_mm() / least.min(1.0);
    let gap = asked.min_gap_mm() / least.min(1.0);
    Ok(Tolerances::new(asked.chord_mm() / most.max(1.0), feature, gap)?)
}

/// The solid of a flat part along the curve.
pub(super) fn solid(part: &Part, map: &SpaceMap, chord_mm: f64) -> Result<Solid, JobError> {
    let lines = map.lines(FACET_SHARE * chord_mm);
    let shift = part.shift_mm;
    let lines_mm: Vec<f64> = lines.iter().map(|u| u + shift.x).collect();
    let w_range = map.w_range_mm();
    let cut_mm = part.joined.as_ref().map_or(0.0, |joined| joined.cut_mm);
    let place = |p: DVec2, side: usize| map.place(p - shift + DVec2::new(cut_mm, 0.0), w_range[side]);
    let sheet =
        fabricate::Sheet { place: &place, lines_mm: &lines_mm, is_joined: part.joined.is_some(), chord_mm };
    Ok(fabricate::wrap(&part.region, &sheet)?)
}
