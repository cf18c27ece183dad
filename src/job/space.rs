//! Bands along curves in space: what they are in the plane, and the solid that becomes of them.
//!
//! The pattern is made on a flat strip, as long as the curve. The drawing is that strip, at its true size in the middle of the thickness, and
//! the solid is the strip laid along the curve. A closed curve gives a strip whose ends have the same ink ([`super::unrolled`]).

use glam::DVec2;

use super::builder::BandJob;
use super::error::JobError;
use super::part::Part;
use super::points::{Points, read_points};
use super::print::PrintOptions;
use crate::domain::{CurveSpec, PlanarCurve, Relief, SpaceCurve, SpaceMap, Twist};
use crate::fabricate::{self, Solid};
use crate::planar::Tolerances;

/// The part of the chord error that facets along the curve may spend; flattening, bending and the drawing have the rest.
const FACET_SHARE: f64 = 0.5;

/// Where less than this part of a thickness is left, it is told.
const THINNER: f64 = 0.95;

/// Widths of the flat pattern are whole parts of a millimetre, so many.
const WIDTHS_PER_MM: f64 = 1e4;

/// What is asked of a band along a curve in space, beyond the curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpaceOptions {
    /// The opening of a ring, which makes it a cuff: straight across, inside, in millimetres.
    pub gap_mm: Option<f64>,
    /// How the band is turned about its curve.
    pub twist: Option<Twist>,
    /// The points of a curve that is named by a file, where they stand in the job that names it and not in a table of their own.
    pub points: Option<Points>,
}

/// The curve in space that a specification names, if it names one.
///
/// # Errors
/// [`JobError`] for a curve that cannot be read or used, and for a gap where there is no ring.
pub(super) fn read_space_curve(job: &BandJob) -> Result<Option<SpaceCurve>, JobError> {
    let options = &job.options;
    let middle = |inner_mm: f64| 0.5 * (inner_mm + options.thickness_mm);
    let SpaceOptions { gap_mm, twist, points } = &options.space;
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
            Some(gap_mm) if gap_mm > 0.0 && gap_mm < options.min_gap_mm => {
                let found = format!("{gap_mm} mm is less than the minimum gap of {} mm", options.min_gap_mm);
                return refuse("--gap", &found, "use a wider one, or leave it out for a closed ring");
            }
            Some(gap_mm) => SpaceCurve::cuff(middle(*inner_mm), gap_mm, 0.5 * inner_mm)?,
            None => SpaceCurve::ring(middle(*inner_mm))?,
        },
        CurveSpec::Helix { inner_mm, pitch_mm, turns } => {
            SpaceCurve::helix(middle(*inner_mm), *pitch_mm, *turns)?
        }
        CurveSpec::Points { file } => {
            let read = points.clone().map_or_else(|| read_points(file), Ok)?;
            SpaceCurve::through(&read.points, read.is_closed)?
        }
        CurveSpec::Model { .. } => {
            let ground = job.ground.as_ref().expect("a band on a model has one");
            if twist.is_some() {
                return refuse("--twist", "a band on a model lies as the model does", "leave it out");
            }
            ground.curve().clone()
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
    refuse_flat_only(&options.print)?;
    if options.round_mm.is_some() {
        return refuse("--round", "a curve in space has no corners to round", "leave it out");
    }
    if curve.is_closed() && (options.enforce || options.bridge_mm.is_some()) {
        let option = if options.enforce { "--enforce" } else { "--bridge" };
        let wanted = match options.along {
            CurveSpec::Ring { .. } => "give a ring a --gap, or ask for what the ornament gives by itself",
            _ => "leave the curve open, or ask for what the ornament gives by itself",
        };
        return refuse(option, "the ends of a closed band in space would not meet after it", wanted);
    }
    Ok(Some(curve))
}

/// Refuses what is made for parts that lie flat only.
pub(super) fn refuse_flat_only(print: &PrintOptions) -> Result<(), JobError> {
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
            found: "it is for parts that lie flat, and this one does not".to_owned(),
            wanted: "leave it out".to_owned(),
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

/// The map of a band of `height_mm` along the curve. A ring or a helix is lifted so that its lowest corner is at z = 0.
pub(super) fn space_map(job: &BandJob, curve: SpaceCurve, height_mm: f64) -> Result<SpaceMap, JobError> {
    let thickness_mm = job.options.thickness_mm;
    if let Some(ground) = &job.ground {
        return ground.map(job, height_mm);
    }
    match job.options.along {
        CurveSpec::Ring { .. } | CurveSpec::Helix { .. } => {
            standing(curve, height_mm, thickness_mm, None, &job.tolerances)
        }
        _ => laid(curve, height_mm, thickness_mm, None, &job.tolerances),
    }
}

/// The map of a sheet about the middle of its height and thickness.
fn laid(
    curve: SpaceCurve,
    height_mm: f64,
    thickness_mm: f64,
    relief: Option<Relief>,
    tolerances: &Tolerances,
) -> Result<SpaceMap, JobError> {
    let [v, w] = [height_mm, thickness_mm].map(|mm| [-0.5 * mm, 0.5 * mm]);
    Ok(SpaceMap::draped(curve, v, w, relief, tolerances.min_gap_mm())?)
}

/// The same, lifted so that its lowest corner is at z = 0.
pub(super) fn standing(
    curve: SpaceCurve,
    height_mm: f64,
    thickness_mm: f64,
    relief: Option<Relief>,
    tolerances: &Tolerances,
) -> Result<SpaceMap, JobError> {
    let map = laid(curve, height_mm, thickness_mm, relief, tolerances)?;
    let low_mm = map.low_mm();
    Ok(map.lifted(-low_mm))
}

/// The tolerances of the flat pattern, so that those that were asked for hold in space, where lengths are longer on the outer side of a
/// bend and shorter on the inner one.
pub(super) fn flat_tolerances(asked: &Tolerances, map: &SpaceMap) -> Result<Tolerances, JobError> {
    let [least, most] = map.scales();
    // Rounded up, so that messages can be read.
    let wider = |mm: f64| (mm / least * WIDTHS_PER_MM).ceil() / WIDTHS_PER_MM;
    let [feature, gap] = [asked.min_feature_mm(), asked.min_gap_mm()].map(wider);
    Ok(Tolerances::new(asked.chord_mm() / most, feature, gap)?)
}

/// What to say where the flat pattern has to be wider than what was asked for.
pub(super) fn note(asked: &Tolerances, flat: &Tolerances) -> Option<String> {
    let widths = [
        ("--min-feature", asked.min_feature_mm(), flat.min_feature_mm()),
        ("--min-gap", asked.min_gap_mm(), flat.min_gap_mm()),
    ];
    let told = |(option, asked, flat): (&str, f64, f64)| format!("{option} {asked} mm is {flat:.3} mm there");
    let told: Vec<String> = widths.into_iter().filter(|(_, asked, flat)| flat > asked).map(told).collect();
    (!told.is_empty()).then(|| {
        format!(
            "lengths are shorter in bends and twists than in the flat pattern, which has more: {}",
            told.join(", ")
        )
    })
}

/// What to say of a sheet on a relief: how thin it is on slopes, and where facets do not keep the chord error.
pub(super) fn relief_notes(map: &SpaceMap, chord_mm: f64) -> Vec<String> {
    let [back, front] = map.w_range_mm();
    let (thickness_mm, part) = (front - back, map.least_thickness());
    let mut notes = Vec::new();
    if part < THINNER {
        notes.push(format!(
            "slopes take from the thickness, which is measured without them: {:.2} mm are left of {thickness_mm:.2} mm on the steepest",
            part * thickness_mm
        ));
    }
    if !map.keeps(FACET_SHARE * chord_mm) {
        notes.push(format!(
            "the sheet is bent too finely for its size: facets are not everywhere within {chord_mm:.4} mm of it; a larger --chord, or a smoother sheet"
        ));
    }
    notes
}

/// The solid of a flat part along the curve.
pub(super) fn solid(part: &Part, map: &SpaceMap, chord_mm: f64) -> Result<Solid, JobError> {
    let cut_mm = part.joined.as_ref().map_or(0.0, |joined| joined.cut_mm);
    let lines = map.lines(cut_mm, FACET_SHARE * chord_mm);
    let shift = part.shift_mm;
    let mut lines_mm: Vec<f64> = lines.iter().map(|u| u - cut_mm + shift.x).collect();
    if let Some(joined) = &part.joined {
        let last = lines_mm.len() - 1;
        [lines_mm[0], lines_mm[last]] = joined.sides_mm;
    }
    let levels_mm: Vec<f64> = map.levels(FACET_SHARE * chord_mm).iter().map(|v| v + shift.y).collect();
    let w_range = map.w_range_mm();
    let place = |p: DVec2, side: usize| map.place(p - shift + DVec2::new(cut_mm, 0.0), w_range[side]);
    let sheet = fabricate::Sheet {
        place: &place,
        lines_mm: &lines_mm,
        levels_mm: &levels_mm,
        is_joined: part.joined.is_some(),
        chord_mm,
    };
    Ok(fabricate::wrap(&part.region, &sheet)?)
}
