//! A strip that is laid along a curve in space, or on a model.
//!
//! The pattern is made flat, and the drawing is that. The solid is the strip bent along the curve, by the same map as a band's; of a
//! closed curve, the strip's two sides are one place and have the same ink.

use glam::DVec2;

use super::FillJob;
use super::builder::refused;
use crate::domain::SpaceMap;
use crate::fabricate::Counts;
use crate::job::builder::BandBuilder;
use crate::job::error::JobError;
use crate::job::joined::Joined;
use crate::job::part::Part;
use crate::job::space;
use crate::job::surface;
use crate::planar::{GridPoint, Region, Tolerances};
use crate::verify;

/// Places at which a closed strip may be cut open, of which one with the fewest strands is taken.
const PLACES: i64 = 256;

/// Where a strip lies in space.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub(super) map: SpaceMap,
    /// The model that it lies on.
    pub(super) model: Option<surface::Ground>,
    /// Those of the flat pattern, so that what was asked for holds where the strip is bent.
    pub(super) tolerances: Tolerances,
    /// What to say of them, and of the model.
    pub(super) notes: Vec<String>,
}

impl Sheet {
    /// That of a job whose curve is one in space.
    ///
    /// # Errors
    /// [`JobError`] when the curve or the model cannot be read or carry the strip.
    pub(super) fn new(job: &FillJob) -> Result<Option<Self>, JobError> {
        let options = &job.options;
        let Some((along, width_mm)) = options.along.as_ref().zip(options.width_mm) else { return Ok(None) };
        let making = &options.making;
        let asked = &making.tolerances;
        // A band of that curve knows how it lies.
        let band = match &options.surface {
            Some(surface) => BandBuilder::on_model(&options.exemplar, surface.clone()),
            None => BandBuilder::new(&options.exemplar, along.clone()),
        };
        let band = band
            .width_mm(width_mm)
            .thickness_mm(making.thickness_mm)
            .chord_mm(asked.chord_mm())
            .min_feature_mm(asked.min_feature_mm())
            .min_gap_mm(asked.min_gap_mm())
            .print(making.print.clone())
            .enforce(making.enforce)
            .space(options.space.clone());
        let band = options.round_mm.into_iter().fold(band, BandBuilder::round_mm);
        let band = options.bridge_mm.into_iter().fold(band, BandBuilder::bridge_mm);
        let mut band = band.build()?;
        band.ground = options.surface.as_ref().map(surface::Ground::new).transpose()?;
        // Of what is carved out of a model, ink is the gaps.
        let asked = &band.tolerances;
        let Some(curve) = space::read_space_curve(&band)? else { return Ok(None) };
        let map = space::space_map(&band, curve, width_mm)?;
        let tolerances = space::flat_tolerances(asked, &map)?;
        let read = band.ground.iter().flat_map(surface::Ground::notes).cloned();
        let notes = read.chain(space::note(asked, &tolerances)).collect();
        Ok(Some(Self { map, tolerances, notes, model: band.ground }))
    }

    /// Whether the strip's sides are one place.
    pub(super) fn is_closed(&self) -> bool {
        self.map.curve().is_closed()
    }

    /// The strip on its page, of which the place `shift_mm` is the beginning of the curve.
    pub(super) fn part(
        &self,
        region: Region,
        page_mm: DVec2,
        shift_mm: DVec2,
        cut_mm: f64,
    ) -> Result<Part, JobError> {
        let length_mm = self.map.curve().length_mm();
        let sides_mm = [shift_mm.x, shift_mm.x + length_mm];
        let joined = self.is_closed().then_some(Joined { cut_mm, sides_mm });
        let counts = match joined {
            None => Counts::of(&region),
            Some(_) => {
                let rolled = verify::rolled(&region, sides_mm)?;
                Counts { components: rolled.components, holes: rolled.holes }
            }
        };
        Ok(Part { region, page_mm, shift_mm, seams_mm: Vec::new(), counts, joined })
    }
}

/// The ink of a pattern that goes on after `lap` steps to the right, from where it is best cut open: one lap, that begins at the step
/// `begin`; and how many steps to the right of the pattern's own beginning it was cut.
///
/// # Errors
/// [`JobError::Option`] when there is no place for the cut.
pub(super) fn unrolled(ink: &Region, begin: i64, lap: i64) -> Result<(Region, i64), JobError> {
    let points = || ink.contours().flat_map(|contour| contour.points());
    let (low, high) = (points().map(|p| p.x).min().unwrap_or(0), points().map(|p| p.x).max().unwrap_or(0));
    // So many copies that each lap from the first to the second is whole.
    let [first, last] = [(begin - high).div_euclid(lap), (begin + 2 * lap - low).div_euclid(lap) + 1];
    let copies: Vec<Region> = (first..=last).map(|k| ink.shifted(GridPoint::new(k * lap, 0))).collect();
    let all = Region::union(ink.grid(), &copies);
    let strands = |x: i64| {
        all.contours().flat_map(|contour| contour.edges()).filter(|(a, b)| (a.x < x) != (b.x < x)).count()
    };
    let mut places: Vec<(usize, i64)> =
        (0..PLACES).map(|k| k * lap / PLACES).map(|at| (strands(begin + at), at)).collect();
    places.sort_unstable();
    let cut = |at: i64| {
        let [_, right] = all.split_at(begin + at)?;
        let [one, _] = right.split_at(begin + at + lap)?;
        Some((one.shifted(GridPoint::new(-at, 0)), at))
    };
    places.into_iter().find_map(|(_, at)| cut(at)).ok_or_else(|| {
        refused(
            "--along",
            "the pattern of the closed strip can be cut open nowhere".to_owned(),
            "use another --seed, or a --gap",
        )
    })
}
