//! The constants of sample-graph synthesis; the defaults are those of Tu 2020 unless an item says otherwise.

/// One level of the hierarchy, lengths in millimetres (Tu 2020 §4.1.1, §4.3.5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The radius r of a neighbourhood.
    pub radius_mm: f64,
    /// The spacing δ of samples along a curve.
    pub spacing_mm: f64,
}

/// How the first samples are laid (Tu 2020 §4.3.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// Patches of the exemplar, each one that suits those around it.
    #[default]
    Patches,
    /// Single samples at random places.
    Noise,
}

/// What becomes of the pattern at the border of the area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Border {
    /// It is synthesized beyond the border and cut there, as cloth is; elements are whole or are not there.
    #[default]
    Cut,
    /// It is kept inside by the domain term alone, as in the paper, and strands end where they end.
    Within,
}

/// Parts of the method that can be left out, to see what they are for (Tu 2020 §5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Without {
    /// The difference of edges, Eq. 5.
    pub edges: bool,
    /// Samples that may stay unmatched, §4.2.3.
    pub robust: bool,
    /// Adding and removing samples, §4.3.4.
    pub existence: bool,
    /// Directions of paths in the reconstruction, §4.4.2.
    pub orientation: bool,
}

/// Everything that can be chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The levels from coarse to fine, one to three.
    pub levels: Vec<Level>,
    /// Searches and assignments at each level: 7.
    pub iterations: usize,
    /// What random choices come from.
    pub seed: u64,
    /// How it begins.
    pub start: Start,
    /// How it ends.
    pub border: Border,
    /// γ of Eq. 8, the weight of attributes beside positions: 0.5.
    pub attribute_weight: f64,
    /// β of Eq. 5, the price of an edge too many or too few, in parts of δ: 1.
    pub edge_count_price: f64,
    /// The price c of an unmatched sample of a curve (§4.2.3), in parts of δ: `least + per_edge` · |E(s)|, `most` at the most.
    pub unmatched: UnmatchedPrice,
    /// The price of a sample that the output lacks beside the exemplar, in parts of δ; the paper has none (§4.2.3).
    pub missing_price: f64,
    /// Neighbours of a sample in the graph that the search follows (§4.3.3): 8.
    pub search_neighbours: usize,
    /// Passes of the search in the first iteration of a level, and in those after: 5 and 2.
    pub passes: [usize; 2],
    /// The largest and the smallest window of the random search, in parts of the longer side of the exemplar. The paper has 150 and 25
    /// units for exemplars of 250 to 500: 0.4 and 0.067.
    pub windows: [f64; 2],
    /// Votes of a neighbourhood count with the cost for each of its samples to minus this power; the paper's count alike, 0.
    pub vote_power: f64,
    /// Samples that are believed in less than this are removed, and those more are added (§4.3.4): 0.5.
    pub least_existence: f64,
    /// Edges that are believed in less than this are not made, however many a sample lacks; the paper has no such limit (Eq. 21).
    pub least_edge: f64,
    /// Candidates nearer than this to a cluster are of it, in parts of δ (Algorithm 1): 0.5.
    pub cluster: f64,
    /// Two directions are opposite if they differ from half a turn by less than this, in radians (§4.4.2): π/9.
    pub opposite: f64,
    /// What is left out.
    pub without: Without,
}

/// c of §4.2.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnmatchedPrice {
    /// Of a sample without edges, in parts of δ: 1.2.
    pub least: f64,
    /// More for each edge: 0.4.
    pub per_edge: f64,
    /// At the most: 2.
    pub most: f64,
    /// Of a sample of an element, in parts of the mean distance to the nearest neighbour: 1.5.
    pub element: f64,
}

impl Default for UnmatchedPrice {
    fn default() -> Self {
        Self { least: 1.2, per_edge: 0.4, most: 2.0, element: 1.5 }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            levels: Vec::new(),
            iterations: 7,
            seed: 0,
            start: Start::default(),
            border: Border::default(),
            attribute_weight: 0.5,
            edge_count_price: 1.0,
            unmatched: UnmatchedPrice::default(),
            missing_price: 0.5,
            search_neighbours: 8,
            passes: [5, 2],
            windows: [0.4, 0.067],
            vote_power: 2.0,
            least_existence: 0.5,
            least_edge: 0.25,
            cluster: 0.5,
            opposite: std::f64::consts::PI / 9.0,
            without: Without::default(),
        }
    }
}
