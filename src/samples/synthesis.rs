//! The whole method: search and assignment in turn, from the coarsest level to the finest (Tu 2020 §4.3).

use std::time::Instant;

use glam::DVec2;

use super::area::Area;
use super::border;
use super::copies::{CloneBox, Copies};
use super::drawing::{Curve, Drawing};
use super::edges;
use super::elements::{Elements, Placed, Similarity};
use super::existence;
use super::given::Given;
use super::graph::{Graph, Kind, Sample};
use super::level::{LevelReport, SampleError};
use super::neighbours::Neighbourhoods;
use super::options::{Border, Level, Options, Start, Without};
use super::orientations;
use super::positions;
use super::resample::resampled;
use super::sampling::{Resolution, sampled};
use super::search::{Found, Route, matchings, search};
use super::similarity::{Likeness, Matching};
use super::source::Source;
use super::start;

/// A narrow exemplar has patches and margins as if its shorter side were this part of the longer one.
const NARROWEST: f64 = 0.2;

/// What the border cuts off in less line than this part of the finest spacing is a scrap.
const SCRAP: f64 = 0.8;

/// What was synthesized.
#[derive(Debug, Clone)]
pub struct Synthesis {
    /// Samples and edges at the finest level.
    pub graph: Graph,
    /// The classes of the exemplar's elements, and the output's elements, which samples name by number.
    pub elements: Elements,
    /// What was given, as it was drawn.
    pub given: Drawing,
    /// Curves that were copied from the exemplar, as they lie; copied elements are among the others.
    pub copied: Vec<Curve>,
    /// How many elements were not copied, as they would reach beyond the area.
    pub lost_copies: usize,
    /// What happened at each level.
    pub levels: Vec<LevelReport>,
}

/// A pattern like `exemplar` all over `area`. `progress` is told the level and the iteration that begins.
///
/// # Errors
/// [`SampleError`] for an exemplar with too little in it, levels that cannot be, an area with no room, and neighbourhoods that are too large.
pub fn synthesize(
    exemplar: &Drawing,
    area: &Area,
    options: &Options,
    given: &Given,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Synthesis, SampleError> {
    super::level::check(options, area)?;
    let wanted = area;
    let area = &match options.border {
        Border::Cut => area.grown(options.levels.iter().map(|level| level.radius_mm).fold(0.0, f64::max)),
        Border::Within => area.clone(),
    };
    let elements = Elements::of(&exemplar.elements);
    let bounds_mm = roomy(exemplar.bounds_mm().ok_or(SampleError::Empty)?);
    let clones = super::given::checked(&given.clones, wanted)?;
    let copies = Copies::new(&clones, exemplar, &elements, wanted)?;
    let is_curved = !exemplar.curves.is_empty();
    let levels = options.levels.len();
    let mut output = Output { graph: Graph::default(), placed: copies.placed.clone(), found: Vec::new() };
    let mut reports = Vec::new();
    for (number, &level) in options.levels.iter().enumerate() {
        let began = Instant::now();
        let resolution = Resolution { level: number, levels, spacing_mm: level.spacing_mm };
        let learnt = sampled(exemplar, &elements, resolution);
        let points: Vec<DVec2> = learnt.samples.iter().map(|s| s.at).collect();
        super::level::check_crowd(&points, level, None)?;
        let source = Source::new(learnt, bounds_mm, level.radius_mm);
        super::level::check_source(&source, level, area)?;
        // Elements of a level come from the one before.
        let placed = if number == 0 { copies.placed.clone() } else { Vec::new() };
        let fixed = Elements { classes: elements.classes.clone(), placed };
        let fixed = given.sampled(&copies, fixed, area, resolution, is_curved);
        let run = Run { source: &source, elements: &elements, area, options, number, level };
        match number {
            0 => run.begin(&mut output, fixed, &clones),
            _ => run.refine(&mut output, fixed),
        }
        if output.graph.samples.is_empty() {
            return Err(SampleError::NoRoom);
        }
        let mut report = run.iterate(&mut output, progress)?;
        report.seconds = began.elapsed().as_secs_f64();
        reports.push(report);
    }
    let mut elements = Elements { classes: elements.classes, placed: output.placed };
    let least_mm = SCRAP * options.levels.last().map_or(0.0, |level| level.spacing_mm);
    border::cut(&mut output.graph, &mut elements, wanted, least_mm);
    if output.graph.samples.is_empty() {
        return Err(SampleError::NoRoom);
    }
    Ok(Synthesis {
        graph: output.graph,
        elements,
        given: given.drawing.clone(),
        copied: copies.curves,
        lost_copies: copies.lost,
        levels: reports,
    })
}

/// A box that is not narrower than a part of its length, around the same middle: a single straight line has no box to speak of.
fn roomy((low, high): (DVec2, DVec2)) -> (DVec2, DVec2) {
    let size = high - low;
    let least = DVec2::splat(NARROWEST * size.max_element());
    let more = (least - size).max(DVec2::ZERO) / 2.0;
    (low - more, high + more)
}

/// The output between iterations.
#[derive(Clone)]
struct Output {
    graph: Graph,
    /// Its elements.
    placed: Vec<Placed>,
    /// For each sample the exemplar's that its neighbourhood is like, as far as it is known.
    found: Vec<Option<usize>>,
}

/// One level.
struct Run<'a> {
    source: &'a Source,
    elements: &'a Elements,
    area: &'a Area,
    options: &'a Options,
    number: usize,
    level: Level,
}

impl Run<'_> {
    /// The first samples of the coarsest level.
    fn begin(&self, output: &mut Output, given: Graph, clones: &[CloneBox]) {
        let started = match self.options.start {
            Start::Patches => {
                start::patches(self.source, given, clones, self.area, self.options, self.level.spacing_mm)
            }
            Start::Noise => start::noise(self.source, given, clones, self.area, self.options),
        };
        output.graph = started.graph;
        output.found = self.middles_near(&output.graph, &started.origins);
        for (s, origin) in started.origins.iter().enumerate() {
            let sample = &mut output.graph.samples[s];
            if let (Kind::Element { class, .. }, false) = (sample.kind, sample.is_given) {
                let like = origin.map(|i| self.source.graph.samples[i].element);
                place(
                    &mut output.placed,
                    sample,
                    class,
                    like.map(|e| self.elements.placed[e as usize].similarity),
                );
            }
        }
    }

    /// The same samples of the exemplar, or the nearest that may be the middle of a neighbourhood.
    fn middles_near(&self, graph: &Graph, origins: &[Option<usize>]) -> Vec<Option<usize>> {
        let finders = self.source.finders();
        let near = |s: &Sample, origin: &Option<usize>| {
            let at = self.source.graph.samples[(*origin)?].at;
            finders.get(&s.kind)?.nearest(at)
        };
        graph.samples.iter().zip(origins).map(|(s, origin)| near(s, origin)).collect()
    }

    /// The samples of the level before, at this one's spacing.
    fn refine(&self, output: &mut Output, given: Graph) {
        let coarse = &output.graph;
        let (mut fine, parents) = resampled(coarse, self.area, self.level.spacing_mm);
        let finders = self.source.finders();
        let mut found: Vec<Option<usize>> = fine
            .samples
            .iter()
            .zip(&parents)
            .map(|(s, &parent)| {
                let by = self.area.way(coarse.samples[parent].at, s.at);
                finders.get(&Kind::Curve)?.nearest(self.source.beside(output.found[parent]?, by))
            })
            .collect();
        for (number, placed) in output.placed.iter().enumerate() {
            let points = self.points(placed.class);
            for (point, p) in (0..).zip(points) {
                fine.samples.push(Sample {
                    at: self.area.home(placed.similarity.apply(p)),
                    kind: Kind::Element { class: placed.class, point },
                    orientations: Vec::new(),
                    width_mm: 0.0,
                    existence: 1.0,
                    is_given: placed.is_given,
                    element: number as u32,
                });
                found.push(None);
            }
        }
        super::given::exchange(&mut fine, &mut found, given, self.area);
        (output.graph, output.found) = (fine, found);
    }

    fn points(&self, class: u32) -> Vec<DVec2> {
        let class = &self.elements.classes[class as usize];
        class.points(self.number, self.options.levels.len(), self.level.spacing_mm)
    }

    fn iterate(
        &self,
        output: &mut Output,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<LevelReport, SampleError> {
        let mut report = LevelReport::new(self.level, self.source);
        // Assignments may make it worse in the end; what was best stays.
        let mut best: Option<(f64, Output)> = None;
        for iteration in 0..=self.options.iterations {
            progress(self.number, iteration);
            let is_last = iteration == self.options.iterations;
            let passes = if is_last { 1 } else { self.options.passes[usize::from(iteration > 0)] };
            let began = Instant::now();
            let near = self.neighbourhoods(&output.graph)?;
            let likeness = self.likeness(&output.graph, &near);
            let found = self.found(output, &likeness, passes, iteration);
            report.search_seconds += began.elapsed().as_secs_f64();
            let energy = report.tell(&output.graph, &found, self.area);
            // Samples of noise have no edges, which cost nothing, and draw nothing.
            let is_drawn = iteration > 0 || self.number > 0 || self.options.start == Start::Patches;
            if (is_drawn || is_last) && best.as_ref().is_none_or(|(least, _)| energy < *least) {
                let found = found.iter().map(|&(input, _)| Some(input)).collect();
                best = Some((energy, Output { found, ..output.clone() }));
            }
            if is_last {
                break;
            }
            let matchings = matchings(&likeness, &found);
            self.assign(output, &matchings, &found, iteration);
            if output.graph.samples.is_empty() {
                return Err(SampleError::NoRoom);
            }
        }
        if let Some((_, kept)) = best {
            *output = kept;
        }
        let near = self.neighbourhoods(&output.graph)?;
        report.full_energy_per_sample = self.full_energy(output, &near) / output.graph.samples.len() as f64;
        report.finish(&output.graph, near.mean());
        Ok(report)
    }

    /// The energy by the whole measure of what was perhaps made without a part of it.
    fn full_energy(&self, output: &Output, near: &Neighbourhoods) -> f64 {
        let options = &Options { without: Without::default(), ..self.options.clone() };
        // What the search measures by did not change, so a pass is enough.
        let passes = if self.options.without == Without::default() { 1 } else { options.passes[0] };
        let run = Run { options, ..*self };
        let likeness = run.likeness(&output.graph, near);
        let found = run.found(output, &likeness, passes, options.iterations + 1);
        super::level::energy(&output.graph, &found, self.area)
    }

    fn neighbourhoods(&self, graph: &Graph) -> Result<Neighbourhoods, SampleError> {
        let points: Vec<DVec2> = graph.samples.iter().map(|s| s.at).collect();
        super::level::check_crowd(&points, self.level, Some(self.area))?;
        Ok(Neighbourhoods::new(&points, self.level.radius_mm, Some(self.area)))
    }

    fn likeness<'b>(&'b self, graph: &'b Graph, near: &'b Neighbourhoods) -> Likeness<'b> {
        Likeness::new(self.source, (graph, near), self.area, self.options, self.level.spacing_mm)
    }

    fn found(&self, output: &Output, likeness: &Likeness<'_>, passes: usize, iteration: usize) -> Vec<Found> {
        let route = Route::new(&output.graph, self.area, self.options.search_neighbours);
        let purpose = [3, self.number as u64, iteration as u64];
        search(likeness, &route, &output.found, passes, self.options, &purpose)
    }

    /// The assignment step: positions, edges, directions, and which samples there are.
    fn assign(&self, output: &mut Output, matchings: &[Matching], found: &[Found], iteration: usize) {
        let graph = &mut output.graph;
        let moves = positions::moves(graph, self.source, matchings, self.area);
        let keeps_existence = self.options.without.existence;
        existence::believe(graph, matchings);
        // None for the last search, which would find them without edges.
        let is_last = iteration + 1 == self.options.iterations;
        let fresh = match keeps_existence || is_last {
            true => Vec::new(),
            false => existence::missing(
                graph,
                self.source,
                matchings,
                self.area,
                self.options,
                (self.level.radius_mm, self.level.spacing_mm),
                |kind| kind == Kind::Curve || self.number == 0,
            ),
        };
        let purpose = [4, self.number as u64, iteration as u64];
        orientations::turn_all(graph, self.source, matchings, self.options.seed, &purpose);
        for (sample, by) in graph.samples.iter_mut().zip(moves) {
            if !sample.is_given {
                sample.at = self.area.home(sample.at + by);
            }
        }
        edges::join(graph, self.source, matchings, self.area, self.options);
        output.found = found.iter().map(|&(input, _)| Some(input)).collect();
        if !keeps_existence {
            self.remove(output);
        }
        let origins: Vec<Option<usize>> = fresh.iter().map(|(_, input)| Some(*input)).collect();
        let added =
            Graph { samples: fresh.into_iter().map(|(sample, _)| sample).collect(), ..Graph::default() };
        output.found.extend(self.middles_near(&added, &origins));
        for (mut sample, origin) in added.samples.into_iter().zip(origins) {
            if let Kind::Element { class, .. } = sample.kind {
                let like = origin.map(|i| self.source.graph.samples[i].element);
                place(
                    &mut output.placed,
                    &mut sample,
                    class,
                    like.map(|e| self.elements.placed[e as usize].similarity),
                );
            }
            output.graph.samples.push(sample);
        }
        self.put_elements(output);
    }

    /// Takes out samples that are not believed in, elements as wholes.
    fn remove(&self, output: &mut Output) {
        let graph = &mut output.graph;
        let mut belief = vec![[0.0; 2]; output.placed.len()];
        for sample in graph.samples.iter().filter(|s| s.kind != Kind::Curve) {
            let [sum, count] = &mut belief[sample.element as usize];
            (*sum, *count) = (*sum + sample.existence, *count + 1.0);
        }
        let stays: Vec<bool> = graph
            .samples
            .iter()
            .map(|sample| {
                let existence = match sample.kind {
                    Kind::Curve => sample.existence,
                    Kind::Element { .. } => {
                        belief[sample.element as usize][0] / belief[sample.element as usize][1]
                    }
                };
                sample.is_given || existence >= self.options.least_existence
            })
            .collect();
        let mut kept = stays.iter();
        output.found.retain(|_| *kept.next().expect("one for each sample"));
        graph.keep(&stays);
    }

    /// No smaller and no larger than the exemplar's elements of the class are.
    fn in_size(&self, class: u32, fitted: Similarity) -> Similarity {
        let sizes = self
            .elements
            .placed
            .iter()
            .filter(|placed| placed.class == class)
            .map(|p| p.similarity.turn.length());
        let (least, most) =
            sizes.fold((f64::INFINITY, 0.0_f64), |(least, most), size| (least.min(size), most.max(size)));
        let size = fitted.turn.length();
        let turn = if size > 0.0 { fitted.turn / size } else { DVec2::X };
        Similarity { turn: turn * size.clamp(least, most), ..fitted }
    }

    /// Where elements are, by their samples. Elements without samples are gone.
    fn put_elements(&self, output: &mut Output) {
        let samples = &mut output.graph.samples;
        let mut targets: Vec<Vec<(u32, DVec2)>> = vec![Vec::new(); output.placed.len()];
        for sample in samples.iter() {
            if let Kind::Element { point, .. } = sample.kind {
                targets[sample.element as usize].push((point, sample.at));
            }
        }
        let mut number_of = vec![u32::MAX; output.placed.len()];
        let mut placed: Vec<Placed> = Vec::new();
        for (number, targets) in targets.iter().enumerate() {
            if targets.is_empty() {
                continue;
            }
            number_of[number] = placed.len() as u32;
            let old = output.placed[number];
            if old.is_given {
                placed.push(old);
                continue;
            }
            let points = self.points(old.class);
            let similarity = match points.len() {
                1 => Similarity { shift: targets[0].1, ..old.similarity },
                _ => {
                    // Samples of one element lie within it, on one side of a seam.
                    let middle = old.similarity.shift;
                    let from: Vec<DVec2> = targets.iter().map(|t| points[t.0 as usize]).collect();
                    let to: Vec<DVec2> =
                        targets.iter().map(|t| middle + self.area.way(middle, t.1)).collect();
                    self.in_size(old.class, Similarity::fitted(&from, &to))
                }
            };
            placed.push(Placed { similarity, ..old });
        }
        for sample in samples.iter_mut().filter(|s| s.kind != Kind::Curve) {
            sample.element = number_of[sample.element as usize];
        }
        output.placed = placed;
    }
}

/// Gives a new sample in the middle of an element its element, turned and scaled as `like`.
fn place(placed: &mut Vec<Placed>, sample: &mut Sample, class: u32, like: Option<Similarity>) {
    let similarity = like.unwrap_or(Similarity::shifted(DVec2::ZERO));
    sample.element = placed.len() as u32;
    let similarity = Similarity { shift: sample.at, ..similarity };
    placed.push(Placed { class, similarity, is_given: false });
}
