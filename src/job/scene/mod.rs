//! Scenes: several parts in their places, joined into one solid.
//!
//! Parts are made side by side, each judged as a command of its own would judge it, placed, repeated and united. Joints are looked at
//! before that: copies that must fuse have to share volume. The union is one solid, whose shells and genus are held against what
//! was declared, and against every file that is written, read again. What did not change is taken from a cache: the solids of parts, and
//! the files of the whole.
//!
//! Excluded: scene files ([`crate::cli`]); how solids are united ([`crate::fabricate::Body`]).

mod cache;
mod joint;
mod kept;
mod making;
mod place;
mod report;
mod strip;
mod whole;
mod workers;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;

use cache::{Cache, Key};
pub use joint::{Joint, JointReport};
use kept::{facet_bytes, part_of, unpacked};
use making::Made;
pub use making::Making;
pub use place::{Axis, Placement, Repeat};
pub use report::{CopyReport, PartReport, SceneReport};
pub use strip::Strip;
use workers::each;

use super::certificate::sha256;
use super::error::JobError;
use super::output::{Format, Output, Pending, Target, persist};
use super::raised::{Raised, Wanted};
use super::stage::{Clock, Stage};
use crate::export::{self, DEFAULT_COLOUR, MeshDocument, Painted, View};
use crate::fabricate::{Body, Solid};
use crate::verify::{Between, Expected};

/// A part of a scene.
#[derive(Debug, Clone)]
pub struct ScenePart {
    /// Its name, which no other part has.
    pub name: String,
    /// What it is made from.
    pub making: Making,
    /// Every file that making it reads.
    pub files: Vec<PathBuf>,
    /// How it is placed.
    pub placement: Placement,
    /// How it is repeated after that.
    pub repeat: Repeat,
}

/// Parts, and what the whole has to be.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The name that files give to the solid.
    pub title: String,
    /// The parts; no two have the same name.
    pub parts: Vec<ScenePart>,
    /// What must fuse.
    pub joints: Vec<Joint>,
    /// The shells that the whole must have; `None` is any number.
    pub shells: Option<Between>,
    /// The total genus that the whole must have; `None` is any.
    pub genus: Option<Between>,
    /// Where pictures are taken from.
    pub view: View,
    /// The longer side of pictures in pixels.
    pub pixels: u32,
    /// Where results are kept; `None` keeps none.
    pub cache: Option<PathBuf>,
}

/// What a scene is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step<'s> {
    /// A part is being made.
    Part(&'s str, Stage),
    /// Copies are put in their places.
    Place,
    /// Joints are looked at.
    Join,
    /// Copies are united.
    Unite,
    /// The files are made and judged.
    Files(Stage),
}

/// A copy of a part in its place.
struct Placed {
    /// Its name.
    name: String,
    /// The name of its part.
    part: String,
    body: Body,
    bounds: Bounds,
    /// The number of the copy of the same part that follows it, if any does.
    next: Option<usize>,
}

/// A box in space.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    fn of([low, high]: [DVec3; 2]) -> Self {
        Self { low, high }
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    fn to_arrays(self) -> [[f64; 3]; 2] {
        [self.low.to_array(), self.high.to_array()]
    }
}

impl Scene {
    /// Builds the scene and writes each output and the report, verified, or none of them.
    ///
    /// # Errors
    /// [`JobError::Part`] for a part that cannot be made, [`JobError::Joint`] for copies that do not fuse, [`JobError::Mismatch`] for a
    /// whole that is not as declared, and what else ends a job.
    pub fn build(
        &self,
        outputs: &[Output],
        report_file: Option<&Target>,
        progress: &mut dyn FnMut(Step<'_>),
    ) -> Result<SceneReport, JobError> {
        let start = Instant::now();
        let inputs: Vec<&std::path::Path> =
            self.parts.iter().flat_map(|p| &p.files).map(PathBuf::as_path).collect();
        Output::check(outputs.iter().map(Output::target).chain(report_file), &inputs)?;
        if let Some(flat) = outputs.iter().find(|o| !o.format().is_solid() && o.format() != Format::Png) {
            return Err(JobError::Option {
                option: "--output",
                found: format!("{} is a flat drawing", flat.target()),
                wanted: "a scene is a solid: end the name in .stl, .3mf, .obj or .png".to_owned(),
            });
        }
        let cache = self.cache.as_deref().map(Cache::new);
        let keys: Vec<Key> = self.parts.iter().map(|part| part.making.key(&part.files)).collect();
        let whole = self.key(&keys, outputs);
        let kept = cache.as_ref().and_then(|cache| cache.get(&whole)).and_then(unpacked);
        let (mut report, files) = match kept {
            Some((report, files)) if files.len() == outputs.len() => {
                (SceneReport { from_cache: true, ..report }, files)
            }
            _ => {
                let (mut report, files) = self.made(&keys, cache.as_ref(), outputs, progress)?;
                let json = report.to_json();
                let blocks: Vec<&[u8]> =
                    std::iter::once(json.as_bytes()).chain(files.iter().map(Vec::as_slice)).collect();
                report.notes.extend(cache.and_then(|cache| cache.put(&whole, &blocks).err()));
                (report, files)
            }
        };
        report.files = outputs.iter().map(|output| output.target().to_string()).collect();
        progress(Step::Files(Stage::Verify));
        let staged =
            outputs.iter().zip(&files).map(|(output, bytes)| Pending::unchanged(output.target(), bytes));
        let pending = staged.collect::<Result<Vec<_>, _>>()?;
        report.milliseconds = start.elapsed().as_secs_f64() * 1e3;
        persist(pending, report_file.map(|target| (target, report.to_json())))?;
        Ok(report)
    }

    /// What the files of the whole follow from.
    fn key(&self, keys: &[Key], outputs: &[Output]) -> Key {
        let formats: Vec<&str> = outputs.iter().map(|output| output.format().name()).collect();
        let places: Vec<_> = self.parts.iter().map(|p| (&p.name, &p.placement, &p.repeat)).collect();
        let Self { title, joints, shells, genus, view, pixels, .. } = self;
        let own = format!("{:?}", (title, joints, shells, genus, view, pixels, places, formats));
        Key::of(std::iter::once(own.as_bytes()).chain(keys.iter().map(Key::as_bytes)))
    }

    /// Everything made: the report, and the content of each output.
    fn made(
        &self,
        keys: &[Key],
        cache: Option<&Cache>,
        outputs: &[Output],
        progress: &mut dyn FnMut(Step<'_>),
    ) -> Result<(SceneReport, Vec<Vec<u8>>), JobError> {
        let mut notes = Vec::new();
        let made = self.parts(keys, cache, &mut notes, progress)?;
        progress(Step::Place);
        let copies = self.copies(&made)?;
        progress(Step::Join);
        let joints = joint::check(&self.joints, &copies)?;
        progress(Step::Unite);
        let whole = Body::union(&copies.iter().map(|copy| copy.body.clone()).collect::<Vec<_>>())?;
        whole::check([self.shells, self.genus], &whole, &copies, outputs)?;
        let (shells, genus) = (whole.shells().len(), whole.genus());
        let files = self.files(&whole, outputs, &mut |stage| progress(Step::Files(stage)))?;
        let parts = self.parts.iter().zip(&made).map(|(part, made)| PartReport {
            name: part.name.clone(),
            kind: part.making.kind().to_owned(),
            shells: made.solid.shells().len(),
            genus: made.solid.genus(),
            volume_mm3: made.solid.volume_mm3(),
            copies: copies.iter().filter(|copy| copy.part == part.name).map(copy_report).collect(),
            from_cache: made.is_kept,
            report: made.report.clone(),
        });
        for (part, made) in self.parts.iter().zip(&made) {
            notes.extend(made.notes.iter().map(|note| match note.strip_prefix("warning: ") {
                Some(warning) => format!("warning: {}: {warning}", part.name),
                None => format!("{}: {note}", part.name),
            }));
        }
        let report = SceneReport {
            schema_version: 1,
            generator: generator(),
            parts: parts.collect(),
            joints,
            shells,
            genus,
            triangles: whole.triangles().len(),
            volume_mm3: whole.volume_mm3(),
            bounds_mm: bounds(&whole).to_arrays(),
            files: Vec::new(),
            bytes: files.iter().map(Vec::len).collect(),
            sha256: files.iter().map(|bytes| sha256(bytes)).collect(),
            from_cache: false,
            notes,
            milliseconds: 0.0,
        };
        Ok((report, files))
    }

    /// The parts, made or from the cache; equal ones are made once.
    fn parts(
        &self,
        keys: &[Key],
        cache: Option<&Cache>,
        notes: &mut Vec<String>,
        progress: &mut dyn FnMut(Step<'_>),
    ) -> Result<Vec<Made>, JobError> {
        let mut first_of: BTreeMap<&[u8], usize> = BTreeMap::new();
        let mut different: Vec<(&ScenePart, &Key)> = Vec::new();
        for (part, key) in self.parts.iter().zip(keys) {
            first_of.entry(key.as_bytes()).or_insert_with(|| {
                different.push((part, key));
                different.len() - 1
            });
        }
        let work = |&(part, key): &(&ScenePart, &Key), say: &dyn Fn((String, Stage))| {
            if let Some(kept) = cache.and_then(|cache| cache.get(key)).and_then(|blocks| part_of(&blocks)) {
                return Ok((kept, None));
            }
            let made = part.making.make(&mut |stage| say((part.name.clone(), stage)));
            let made = made.map_err(|error| of_part(&part.name, error))?;
            let fault = cache.and_then(|cache| {
                let [report, notes] = [made.report.to_string(), serde_json::json!(made.notes).to_string()];
                cache.put(key, &[&facet_bytes(&made.solid), report.as_bytes(), notes.as_bytes()]).err()
            });
            Ok((made, fault))
        };
        let mut told = |(name, stage): (String, Stage)| progress(Step::Part(&name, stage));
        let results: Vec<Result<(Made, Option<String>), JobError>> = each(&different, work, &mut told);
        let results = results.into_iter().collect::<Result<Vec<_>, _>>()?;
        // One note for all, as the reason is the same.
        notes.extend(results.iter().find_map(|(_, fault)| fault.clone()));
        Ok(keys.iter().map(|key| results[first_of[key.as_bytes()]].0.clone()).collect())
    }

    /// All copies of all parts in their places.
    fn copies(&self, made: &[Made]) -> Result<Vec<Placed>, JobError> {
        let mut wanted = Vec::new();
        for (part, made) in self.parts.iter().zip(made) {
            let first = wanted.len();
            let (count, times) = (part.repeat.copies(), part.repeat.times);
            for (i, motion) in part.placement.motions(&part.repeat, &made.solid).into_iter().enumerate() {
                let name = if count > 1 { format!("{} {}", part.name, i + 1) } else { part.name.clone() };
                // Mirrored copies follow each other as those that they mirror.
                let (lap, place) = (i / times, i % times);
                let is_last = place + 1 == times;
                let next =
                    (!is_last || part.repeat.is_closed()).then(|| first + lap * times + (place + 1) % times);
                wanted.push((part, &made.solid, name, motion, next));
            }
        }
        let copy = |(part, solid, name, motion, next): &(
            &ScenePart,
            &Solid,
            String,
            glam::DAffine3,
            Option<usize>,
        ),
                    _: &dyn Fn(())| {
            let body = Body::new(solid, motion).map_err(|error| of_part(name, error.into()))?;
            let bounds = Bounds::of(body.bounds_mm());
            Ok(Placed { name: name.clone(), part: part.name.clone(), body, bounds, next: *next })
        };
        each(&wanted, copy, &mut |()| ()).into_iter().collect()
    }

    /// The content of each output, judged.
    fn files(
        &self,
        whole: &Solid,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<Vec<Vec<u8>>, JobError> {
        let (shells, genus) = (whole.shells().len(), whole.genus());
        let expected =
            Expected { components: Some(shells.into()), holes: Some(genus.into()), ..Expected::default() };
        let document = MeshDocument {
            title: self.title.clone(),
            application: generator(),
            notes: vec![("Shells".to_owned(), shells.to_string()), ("Genus".to_owned(), genus.to_string())],
            colours: vec![MeshDocument::GREY],
        };
        let is_png = |output: &Output| output.format() == Format::Png;
        let wanted = Wanted { outputs, document: &document, expected: &expected, is_shown: true };
        // A picture takes as long as reading a file again.
        let (raised, picture) = Clock::new(progress).both(
            |clock| Raised::new(wanted, clock, |_| Ok(whole.clone())),
            |_| {
                let painted = [Painted { solid: whole, colour: DEFAULT_COLOUR }];
                outputs
                    .iter()
                    .any(is_png)
                    .then(|| export::view_png(&painted, self.view, self.pixels))
                    .transpose()
            },
        );
        let (raised, picture) = (raised?, picture?);
        let bytes = |output: &Output| match raised.file(output.format()) {
            Some(file) => file.bytes.clone(),
            None => picture.clone().expect("what holds no solid is a picture"),
        };
        Ok(outputs.iter().map(bytes).collect())
    }
}

fn generator() -> String {
    format!("Openwork {}", env!("CARGO_PKG_VERSION"))
}

fn copy_report(copy: &Placed) -> CopyReport {
    CopyReport { name: copy.name.clone(), bounds_mm: copy.bounds.to_arrays() }
}

/// What is wrong, told of a part. A part has no file, so that it stands for one in what is said of files.
fn of_part(name: &str, error: JobError) -> JobError {
    let file = PathBuf::from(format!("part {name}"));
    match error {
        JobError::Mismatch { mismatch, remedy, .. } => JobError::Mismatch { file, mismatch, remedy },
        JobError::Unjudged { error, .. } => JobError::Unjudged { file, error },
        error => JobError::Part { part: name.to_owned(), error: Box::new(error) },
    }
}

/// The box around a solid.
fn bounds(solid: &Solid) -> Bounds {
    let points = || solid.vertices().iter().map(|p| DVec3::from_array(p.map(f64::from)));
    Bounds::of([points().reduce(DVec3::min), points().reduce(DVec3::max)].map(Option::unwrap_or_default))
}
