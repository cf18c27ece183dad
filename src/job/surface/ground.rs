//! The model that a band lies on, and the band's place on it.

use std::sync::{Arc, OnceLock};

use super::super::builder::BandJob;
use super::super::error::JobError;
use super::super::points::read_points;
use super::under::Under;
use super::{Height, Route, SurfaceMode, SurfaceOptions};
use crate::domain::{Mesh, MeshCurve, MeshHeights, Relief, SpaceCurve, SpaceError, SpaceMap};
use crate::verify;

/// The largest model that is read, in bytes: twenty million facets.
const MAX_BYTES: u64 = 1 << 30;
/// The curve is smoothed over so many edges of the model, as its corners are none of the band's.
const SMOOTHED_EDGES: f64 = 1.5;
/// A model that is smaller, in millimetres, is one in another unit.
const LEAST_MM: f64 = 1.0;
/// Facets so near to the curve are beside it, in millimetres.
const BESIDE_MM: f64 = 0.1;
/// The least and the greatest distance between the points that carry the smooth curve, in millimetres.
const SPACING_MM: [f64; 2] = [0.75, 6.0];
/// How far from the flat band the model is looked for, as a part of half of the width, and beyond.
const REACH_PART: f64 = 1.75;
const REACH_MM: f64 = 2.0;
/// How far a band reaches beyond what the relief misses, in millimetres, so that band and model are one or apart all over.
const BEYOND_MM: f64 = 0.15;

/// A model with a curve on it, read once for all that is made on it.
#[derive(Debug, Clone)]
pub struct Ground(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    options: SurfaceOptions,
    mesh: Mesh,
    on_mesh: MeshCurve,
    curve: SpaceCurve,
    notes: Vec<String>,
    /// Whether a pattern goes through the wall, once that is known.
    is_through: OnceLock<bool>,
}

impl Ground {
    /// Reads the model and draws the curve on it.
    ///
    /// # Errors
    /// [`JobError`] for what is no model, and where no curve can be.
    pub(in super::super) fn new(options: &SurfaceOptions) -> Result<Self, JobError> {
        let refuse = |option: &'static str, found: String, wanted: &str| JobError::Option {
            option,
            found,
            wanted: wanted.to_owned(),
        };
        check(options)?;
        let file = || options.model.display();
        let unreadable = |error: std::io::Error| {
            refuse("--mesh", format!("{}: {error}", file()), "name an STL, a 3MF or an OBJ of triangles")
        };
        if std::fs::metadata(&options.model).map_err(unreadable)?.len() > MAX_BYTES {
            let found = format!("{} has more than 1 GiB", file());
            return Err(refuse("--mesh", found, "simplify the model"));
        }
        let bytes = std::fs::read(&options.model).map_err(unreadable)?;
        let facets = verify::read_facets(&bytes).map_err(|error| {
            refuse("--mesh", format!("{}: {error}", file()), "name an STL, a 3MF or an OBJ of triangles")
        })?;
        let (mesh, repairs) = Mesh::new(facets)?;
        let [low, high] = mesh.bounds_mm();
        let size_mm = (high - low).max_element();
        if size_mm < LEAST_MM {
            let found = format!("{} is only {size_mm:.3} mm large", file());
            return Err(refuse(
                "--mesh",
                found,
                "models are in millimetres: scale it, by 1000 if it is in metres",
            ));
        }
        if options.mode != SurfaceMode::Band && options.shell_mm.is_none() {
            mesh.ensure_closed()?;
        }
        let mut notes: Vec<String> = repairs.iter().map(|repair| format!("the model: {repair}")).collect();
        let on_mesh = match &options.route {
            Route::Around(height) => around(&mesh, *height, &mut notes)?,
            Route::Through { points, is_closed } => {
                mesh.through(&points.0, *is_closed, options.tolerance_mm)?
            }
            Route::Curve(file) => {
                let read = read_points(file)?;
                mesh.along(&read.points, read.is_closed, options.tolerance_mm)?
            }
        };
        let length_mm = on_mesh.length_mm();
        let beside = MeshHeights::new(&mesh, on_mesh.points_mm.iter().copied(), BESIDE_MM);
        let spacing_mm = (SMOOTHED_EDGES * beside.edge_mm()).clamp(SPACING_MM[0], SPACING_MM[1]);
        let curve = SpaceCurve::on_surface(&on_mesh, spacing_mm.min(length_mm / 12.0))?;
        let options = options.clone();
        let is_through = OnceLock::new();
        Ok(Self(Arc::new(Inner { options, mesh, on_mesh, curve, notes, is_through })))
    }

    /// The curve that carries the band: smooth, and on the model but for what it is smoother.
    pub(in super::super) fn curve(&self) -> &SpaceCurve {
        &self.0.curve
    }

    pub(in super::super) fn options(&self) -> &SurfaceOptions {
        &self.0.options
    }

    /// Whether a pattern that is carved goes through the wall of the model.
    pub(in super::super) fn is_through(&self) -> bool {
        self.options().mode == SurfaceMode::Carve && self.0.is_through.get().copied().unwrap_or_default()
    }

    pub(super) fn on_mesh(&self) -> &MeshCurve {
        &self.0.on_mesh
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.0.mesh
    }

    /// What was mended of the model, and chosen.
    pub(in super::super) fn notes(&self) -> &[String] {
        &self.0.notes
    }

    /// Where a band of `height_mm` lies on the model.
    ///
    /// # Errors
    /// [`SurfaceError::Beyond`] where the model ends or turns away under the band, and what [`SpaceMap::draped`] refuses.
    pub(in super::super) fn map(&self, job: &BandJob, height_mm: f64) -> Result<SpaceMap, JobError> {
        let half = 0.5 * height_mm;
        let reach_mm = REACH_PART * half + REACH_MM;
        let under = Under::new(self, half, reach_mm);
        let (relief, missed_mm) = under.relief()?;
        let Inner { options, curve, .. } = &*self.0;
        let is_through = match (options.depth_mm, options.shell_mm) {
            (Some(depth_mm), None) => under.is_through(depth_mm)?,
            (depth_mm, _) => depth_mm.is_none(),
        };
        self.0.is_through.get_or_init(|| is_through);
        let beyond = missed_mm + BEYOND_MM;
        let thickness_mm = job.options.thickness_mm;
        let steepest = |relief: &Relief| -> Result<f64, SpaceError> {
            let flat =
                SpaceMap::draped(curve.clone(), [-half, half], [0.0, beyond], Some(relief.clone()), 0.0)?;
            Ok(flat.scales()[1])
        };
        let w_range = match (options.mode, options.depth_mm, options.shell_mm) {
            (SurfaceMode::Band, ..) => [0.0, thickness_mm],
            (SurfaceMode::Emboss, ..) => [-beyond, thickness_mm],
            (SurfaceMode::Carve, Some(depth_mm), _) => [-depth_mm, beyond],
            // Where the model slopes under the band, its wall is thicker along the band's own direction.
            (SurfaceMode::Carve, None, wall_mm) => {
                [-(wall_mm.unwrap_or(thickness_mm) * steepest(&relief)? + beyond), beyond]
            }
        };
        let gap_mm = job.tolerances.min_gap_mm();
        let map = SpaceMap::draped(curve.clone(), [-half, half], w_range, Some(relief), gap_mm);
        map.map_err(|error| match (&error, options.mode) {
            (SpaceError::Fold { .. }, SurfaceMode::Carve) => JobError::Option {
                option: if options.depth_mm.is_some() { "--depth" } else { "--shell" },
                found: format!("what is carved reaches {:.2} mm into the model, and {error}", -w_range[0]),
                wanted: "carve less deep, or lead the curve elsewhere".to_owned(),
            },
            _ => error.into(),
        })
    }
}

/// The way round the model at a height; of several the longest.
fn around(mesh: &Mesh, height: Height, notes: &mut Vec<String>) -> Result<MeshCurve, JobError> {
    let [low, high] = mesh.bounds_mm();
    let height_mm = match height {
        Height::Mm(mm) => mm,
        Height::Part(part) => low.z + part * (high.z - low.z),
    };
    let mut loops = mesh.around(height_mm)?;
    loops.sort_by(|a, b| b.length_mm().total_cmp(&a.length_mm()));
    if loops.len() > 1 {
        let lengths: Vec<String> = loops.iter().map(|l| format!("{:.1} mm", l.length_mm())).collect();
        notes.push(format!(
            "there are {} ways round the model at a height of {height_mm:.3} mm ({}); the longest is taken",
            loops.len(),
            lengths.join(", ")
        ));
    }
    Ok(loops.swap_remove(0))
}

/// Refuses options that have nothing to do with each other.
fn check(options: &SurfaceOptions) -> Result<(), JobError> {
    let refuse = |option: &'static str, found: &str, wanted: &str| {
        Err(JobError::Option { option, found: found.to_owned(), wanted: wanted.to_owned() })
    };
    if options.tolerance_mm.is_nan() || options.tolerance_mm < 0.0 {
        return refuse("--tolerance", &format!("it is {} mm", options.tolerance_mm), "use 0 mm or more");
    }
    let lengths = [("--shell", options.shell_mm), ("--depth", options.depth_mm)];
    if let Some((option, _)) = lengths.into_iter().find(|(_, mm)| mm.is_some_and(|mm| mm <= 0.0)) {
        return refuse(option, "it is no thickness", "use a length of more than 0, as 2mm");
    }
    match (options.mode, options.shell_mm, options.depth_mm) {
        (SurfaceMode::Band, Some(_), _) => refuse(
            "--shell",
            "a band is a part of its own, without the model",
            "use it with --mode emboss or carve",
        ),
        (SurfaceMode::Band | SurfaceMode::Emboss, _, Some(_)) => {
            refuse("--depth", "only what is carved has a depth", "use --thickness, or --mode carve")
        }
        (SurfaceMode::Carve, None, None) => refuse(
            "--mode carve",
            "nothing says how deep",
            "give the model a wall to cut through with --shell 2mm, or carve into it with --depth 2mm (deeper than its wall goes through)",
        ),
        (SurfaceMode::Carve, Some(wall_mm), Some(depth_mm)) if depth_mm >= wall_mm => refuse(
            "--depth",
            &format!("{depth_mm} mm is through the wall of {wall_mm} mm"),
            "leave it out to cut through, or use less",
        ),
        _ => Ok(()),
    }
}
