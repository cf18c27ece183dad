//! What is told of a level, and what is refused.

use glam::DVec2;
use serde::Serialize;
use thiserror::Error;

use super::area::Area;
use super::graph::Graph;
use super::neighbours::Buckets;
use super::options::{Level, Options};
use super::search::Found;
use super::source::Source;

/// Neighbourhoods of more samples than this are refused: the search would take hours.
pub const MOST_NEIGHBOURS: usize = 400;
/// Neighbourhoods of fewer samples of the exemplar than this say nothing.
const LEAST_NEIGHBOURS: usize = 3;

/// More samples than this are refused: at 1.5 ms for each that is more than a minute for each level.
pub const MOST_SAMPLES: usize = 60_000;

/// Why there is no pattern.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SampleError {
    /// Nothing is drawn.
    #[error("the exemplar has neither curves nor elements; draw open or closed strokes, or filled shapes")]
    Empty,
    /// One sample, or a few that are alone.
    #[error(
        "the exemplar has {samples} sample(s), at most {largest} of them within {radius_mm:.2} mm of one another, and a pattern to learn needs at least {LEAST_NEIGHBOURS}: draw more strokes or shapes, or use a larger --radii; each filled shape is one sample, and an ornament that is one shape is for openwork band or rect"
    )]
    Sparse {
        /// Samples of the exemplar.
        samples: usize,
        /// Those of the largest neighbourhood.
        largest: usize,
        /// The radius of neighbourhoods.
        radius_mm: f64,
    },
    /// Too many samples in a neighbourhood.
    #[error(
        "a neighbourhood of radius {radius_mm:.2} mm has {largest} samples at a spacing of {spacing_mm:.2} mm, and more than {MOST_NEIGHBOURS} would take hours; 20 to 30 are usual: use a smaller --radii or a larger --spacing"
    )]
    Crowded {
        /// The samples in the largest neighbourhood.
        largest: usize,
        /// The radius.
        radius_mm: f64,
        /// The spacing.
        spacing_mm: f64,
    },
    /// More samples than anyone waits for.
    #[error(
        "the domain would have about {samples:.0} samples, and more than {MOST_SAMPLES} take too long: the exemplar is {width_mm:.2} x {height_mm:.2} mm; use a larger --spacing, a smaller domain, or a larger exemplar (is its unit right?)"
    )]
    Many {
        /// About as many samples as there would be.
        samples: f64,
        /// The width of the exemplar.
        width_mm: f64,
        /// Its height.
        height_mm: f64,
    },
    /// The area is smaller than a neighbourhood.
    #[error(
        "the domain is {width_mm:.2} x {height_mm:.2} mm inside of its pen, less than a neighbourhood of radius {radius_mm:.2} mm: use a larger domain, or a smaller --radii with a smaller --spacing"
    )]
    Small {
        /// The width of the area.
        width_mm: f64,
        /// Its height.
        height_mm: f64,
        /// The radius of neighbourhoods.
        radius_mm: f64,
    },
    /// A number that cannot be used.
    #[error("{name} is {found}; wanted {wanted}")]
    Option {
        /// What it is called.
        name: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        wanted: &'static str,
    },
    /// No sample is inside of the area.
    #[error(
        "nothing is left of the pattern: no part of it fits in the domain, or the exemplar has too little side by side for any of it to be believed in; use a larger domain, a smaller exemplar, or one with more strokes or shapes"
    )]
    NoRoom,
}

/// What happened at a level.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LevelReport {
    /// The radius of neighbourhoods in millimetres.
    pub radius_mm: f64,
    /// The spacing of samples in millimetres.
    pub spacing_mm: f64,
    /// Samples of the exemplar.
    pub exemplar_samples: usize,
    /// Samples of the output, at the end.
    pub samples: usize,
    /// The mean number of samples in a neighbourhood of the output.
    pub neighbours: f64,
    /// The energy of Tu 2020 Eq. 12 before each iteration and after the last, in millimetres.
    pub energies: Vec<f64>,
    /// The same for each sample.
    pub energies_per_sample: Vec<f64>,
    /// That of what was kept, the least of these, with nothing left out of the measure, so that results that were made without a part of the method
    /// can be compared.
    pub full_energy_per_sample: f64,
    /// Seconds in all.
    #[serde(skip)]
    pub seconds: f64,
    /// Seconds of searches.
    #[serde(skip)]
    pub search_seconds: f64,
}

impl LevelReport {
    pub(super) fn new(level: Level, source: &Source) -> Self {
        Self {
            radius_mm: level.radius_mm,
            spacing_mm: level.spacing_mm,
            exemplar_samples: source.graph.samples.len(),
            samples: 0,
            neighbours: 0.0,
            energies: Vec::new(),
            energies_per_sample: Vec::new(),
            full_energy_per_sample: 0.0,
            seconds: 0.0,
            search_seconds: 0.0,
        }
    }

    /// Adds the energy of what was found, and gives it for each sample.
    pub(super) fn tell(&mut self, graph: &Graph, found: &[Found], area: &Area) -> f64 {
        let energy = energy(graph, found, area);
        let each = energy / found.len().max(1) as f64;
        self.energies.push(energy);
        self.energies_per_sample.push(each);
        each
    }

    pub(super) fn finish(&mut self, graph: &Graph, neighbours: f64) {
        (self.samples, self.neighbours) = (graph.samples.len(), neighbours);
    }
}

/// The energy of Tu 2020 Eq. 12: costs, and how far samples are outside of the area.
pub(super) fn energy(graph: &Graph, found: &[Found], area: &Area) -> f64 {
    let costs: f64 = found.iter().map(|(_, cost)| cost).sum();
    let outside = graph.samples.iter().filter(|s| !s.is_given && !area.contains(s.at));
    costs + outside.map(|s| area.depth_mm(s.at)).sum::<f64>()
}

/// Refuses neighbourhoods of too many samples, before there is a list of them.
pub(super) fn check_crowd(points: &[DVec2], level: Level, area: Option<&Area>) -> Result<(), SampleError> {
    let buckets = Buckets::new(points, level.radius_mm, area);
    for &p in points {
        let mut largest = 0;
        buckets.within(p, level.radius_mm, |_, _| largest += 1);
        if largest > MOST_NEIGHBOURS {
            let Level { radius_mm, spacing_mm } = level;
            return Err(SampleError::Crowded { largest, radius_mm, spacing_mm });
        }
    }
    Ok(())
}

pub(super) fn check(options: &Options, area: &Area) -> Result<(), SampleError> {
    let refuse = |name, found: String, wanted| Err(SampleError::Option { name, found, wanted });
    if !(1..=3).contains(&options.levels.len()) {
        return refuse("the number of levels", options.levels.len().to_string(), "1, 2 or 3");
    }
    for level in &options.levels {
        for (name, mm) in [("a radius", level.radius_mm), ("a spacing", level.spacing_mm)] {
            if !(mm.is_finite() && mm > 0.0) {
                return refuse(name, format!("{mm} mm"), "a length above 0 mm");
            }
        }
        if level.radius_mm < level.spacing_mm {
            let found = format!("{} mm, less than the spacing of {} mm", level.radius_mm, level.spacing_mm);
            return refuse("a radius", found, "at least the spacing, or neighbourhoods hold nothing");
        }
    }
    if options.levels.windows(2).any(|pair| pair[1].spacing_mm > pair[0].spacing_mm) {
        let all: Vec<String> = options.levels.iter().map(|level| level.spacing_mm.to_string()).collect();
        return refuse("--spacing", all.join(", "), "lengths from coarse to fine");
    }
    let [widest, narrowest] = options.windows;
    if !(narrowest > 0.0 && narrowest <= widest && widest.is_finite()) {
        return refuse(
            "--windows",
            format!("{widest}, {narrowest}"),
            "two numbers above 0, the larger one first",
        );
    }
    let numbers = [
        ("--cluster", options.cluster, options.cluster > 0.0),
        ("--attribute-weight", options.attribute_weight, options.attribute_weight >= 0.0),
        ("--edge-count-price", options.edge_count_price, options.edge_count_price >= 0.0),
        ("--missing-price", options.missing_price, options.missing_price >= 0.0),
        ("--vote-power", options.vote_power, options.vote_power >= 0.0),
    ];
    if let Some((name, value, _)) =
        numbers.into_iter().find(|(_, value, is_good)| !(*is_good && value.is_finite()))
    {
        return refuse(name, value.to_string(), "a number that is not below 0; above it for --cluster");
    }
    if options.search_neighbours == 0 || options.passes.contains(&0) {
        return refuse("--search-neighbours or --passes", "0".to_owned(), "1 or more");
    }
    let (low, high) = area.bounds_mm();
    let size = high - low;
    let radius_mm = options.levels.iter().map(|level| level.radius_mm).fold(0.0, f64::max);
    if area.region().is_empty() || size.min_element() < radius_mm {
        return Err(SampleError::Small { width_mm: size.x, height_mm: size.y, radius_mm });
    }
    Ok(())
}

pub(super) fn check_source(source: &Source, level: Level, area: &Area) -> Result<(), SampleError> {
    let size = source.bounds_mm.1 - source.bounds_mm.0;
    let laps = area.lap_mm().map_or(1.0, |_| 0.5);
    let expected =
        source.graph.samples.len() as f64 * area.region().area_mm2() * laps / size.element_product();
    if expected > MOST_SAMPLES as f64 {
        return Err(SampleError::Many { samples: expected, width_mm: size.x, height_mm: size.y });
    }
    let (samples, largest) = (source.graph.samples.len(), source.near.largest());
    if samples == 0 {
        return Err(SampleError::Empty);
    }
    match largest < LEAST_NEIGHBOURS {
        true => Err(SampleError::Sparse { samples, largest, radius_mm: level.radius_mm }),
        false => Ok(()),
    }
}
