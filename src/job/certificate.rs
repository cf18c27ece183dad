//! The certificate of a band: the sequence with all that is needed to add it up again.
//!
//! The search is not trusted: the certificate names the descriptor of every piece that occurs, the sequence, and
//! after each piece how the open portals of the run are connected, what is closed and χ. Each join can then be
//! checked by itself from the lines before and after it; the closing join of a ring, what bridges change, the
//! wanted counts, the recount on the files and their SHA-256 follow. `openwork verify --certificate` does so with
//! code of its own. Runs are connected in few different ways, which are listed once, so that a certificate has a
//! few small numbers for each piece of the band.
//!
//! Where the exemplar was cut is in it too, so that its pieces can be made again ([`super::recut`]): a replay by itself
//! does not tell whether the descriptors are those of the exemplar's geometry. What the files hold is counted on them.

use rustc_hash::FxHashMap;
use schemars::JsonSchema;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::builder::BandJob;
use super::cut::Cut;
use crate::fabricate::{Bridge, BridgeKind, Counts};
use crate::pieces::Catalogue;
use crate::topology::{Descriptor, Goal, Shape, Topology, Wanted};

/// The version of [`Certificate`]; it changes when a field changes its meaning or goes.
const VERSION: u32 = 1;

/// What proves the counts of a band. Whole numbers and text only, so that it reads back as it was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Certificate {
    /// The version of this structure.
    pub version: u32,
    /// `open` for a run with two ends, `ring` for one that is closed.
    pub shape: &'static str,
    /// What was asked for.
    pub wanted: WantedCounts,
    /// How the exemplar was cut; null when the pieces are not cut from a file, as the rows of a rectangle.
    pub source: Option<Source>,
    /// The pieces that occur, by number.
    pub pieces: Vec<PieceDescriptor>,
    /// The pieces of the band in order, by number.
    pub sequence: Vec<usize>,
    /// The different ways in which runs are connected, in the order in which they come first.
    pub states: Vec<Connections>,
    /// The run after each piece.
    pub steps: Steps,
    /// What the last join of a ring makes; null for an open run.
    pub closing: Option<Closing>,
    /// What was added or cut away afterwards, in order.
    pub bridges: Vec<BridgeStep>,
    /// Components, holes and χ in the end.
    pub result: ResultCounts,
    /// Components and holes that were counted on the files.
    pub recount: Option<[usize; 2]>,
    /// The files.
    pub files: Vec<FileDigest>,
    /// SHA-256 of all of the above as JSON without white space, keys in order.
    pub sha256: String,
}

/// What makes the pieces again. Numbers that are not whole are text, as their shortest decimal form.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Source {
    /// SHA-256 of the exemplar's file, in hexadecimal.
    pub sha256: String,
    /// The height in millimetres that it was scaled to; null for its own.
    pub height_mm: Option<String>,
    /// The greatest distance in millimetres between a curve of the job and what stands for it.
    pub chord_mm: String,
    /// Pieces of the exemplar; n + i is piece i of n, mirrored.
    pub pieces: usize,
    /// Where it was cut, in steps of the grid that it is read on.
    pub cuts: Vec<i64>,
}

/// Counts that were asked for: from the first to the second; null when free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct WantedCounts {
    /// Components.
    pub components: Option<[u32; 2]>,
    /// Holes.
    pub holes: Option<[u32; 2]>,
    /// Whether some component must go all the way round.
    pub closed_pattern: bool,
}

/// The descriptor of a piece (Zhou 2014 §3.4).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct PieceDescriptor {
    /// Its number.
    pub piece: usize,
    /// The component of each portal on the left, top to bottom, numbered by first occurrence.
    pub left: Vec<u16>,
    /// The component of each portal on the right, by the same numbers.
    pub right: Vec<u16>,
    /// Components that reach no portal.
    pub closed: u32,
    /// The Euler characteristic of all.
    pub euler: i64,
}

/// How the open portals of a run are connected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Connections {
    /// On its left end, as in [`PieceDescriptor`].
    pub left: Vec<u16>,
    /// On its right end.
    pub right: Vec<u16>,
}

/// The run after each piece, as columns of the same length.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Steps {
    /// How it is connected: which of [`Certificate::states`].
    pub state: Vec<usize>,
    /// Components that are closed.
    pub closed: Vec<u32>,
    /// The Euler characteristic.
    pub euler: Vec<i64>,
}

/// What gluing the ends of a ring makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Closing {
    /// Portals that are glued.
    pub portals: usize,
    /// Components of the ring.
    pub components: u32,
    /// Its Euler characteristic.
    pub euler: i64,
    /// Whether some component goes all the way round.
    pub closed_pattern: bool,
}

/// A bridge and what it changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct BridgeStep {
    /// `strut` for ink that was added, `slit` for ink that was taken away.
    pub kind: &'static str,
    /// What it adds to the number of components.
    pub components: i32,
    /// What it adds to the number of holes.
    pub holes: i32,
    /// Its middle on the page, in micrometres.
    pub position_um: [i64; 2],
}

/// The counts in the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ResultCounts {
    /// Components.
    pub components: u32,
    /// Holes.
    pub holes: u32,
    /// The Euler characteristic: components less holes.
    pub euler: i64,
    /// Whether some component goes all the way round.
    pub closed_pattern: bool,
}

/// A file that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FileDigest {
    /// The name as it was given.
    pub file: String,
    /// `svg`, `stl`, `3mf`, `obj` or `png`.
    pub format: &'static str,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl Certificate {
    /// Adds how the exemplar of `job` was cut.
    pub(super) fn tell_source(&mut self, job: &BandJob, cut: &Cut) {
        self.source = Some(Source {
            sha256: cut.exemplar.sha256().to_owned(),
            height_mm: job.options.width_mm.map(|mm| mm.to_string()),
            chord_mm: job.tolerances.chord_mm().to_string(),
            pieces: cut.catalogue.originals(),
            cuts: cut.slicing.cuts.iter().map(|c| c.x).collect(),
        });
    }

    /// Adds what bridges change, and the counts with them.
    pub(super) fn add_bridges(&mut self, bridges: &[Bridge], counts: Counts, closed_pattern: bool) {
        for bridge in bridges {
            let (kind, components, holes) = match bridge.kind {
                BridgeKind::Join => ("strut", -1, 0),
                BridgeKind::Enclose => ("strut", 0, 1),
                BridgeKind::Open => ("slit", 0, -1),
                BridgeKind::Split => ("slit", 1, 0),
            };
            let step = BridgeStep { kind, components, holes, position_um: middle_um(bridge) };
            self.bridges.extend(std::iter::repeat_n(step, bridge.changes));
        }
        self.result = ResultCounts {
            components: counts.components as u32,
            holes: counts.holes as u32,
            euler: counts.components as i64 - counts.holes as i64,
            closed_pattern,
        };
    }

    /// Moves bridges to where these are now: the same ones, in the same order.
    pub(super) fn move_bridges(&mut self, bridges: &[Bridge]) {
        let places = bridges.iter().flat_map(|bridge| std::iter::repeat_n(middle_um(bridge), bridge.changes));
        for (step, position_um) in self.bridges.iter_mut().zip(places) {
            step.position_um = position_um;
        }
    }

    /// The certificate of a sequence whose pieces add up to `planned`, before its files exist.
    pub(super) fn new(
        catalogue: &Catalogue,
        sequence: &[usize],
        shape: Shape,
        goal: Goal,
        planned: Topology,
    ) -> Self {
        let mut used = sequence.to_vec();
        used.sort_unstable();
        used.dedup();
        let descriptors = catalogue.descriptors();
        let (states, steps, last) = replayed(descriptors, sequence);
        let closing = (shape == Shape::Ring).then(|| {
            let portals = last.right().len();
            Closing {
                portals,
                components: planned.components,
                euler: last.euler() - portals as i64,
                closed_pattern: planned.closed_pattern,
            }
        });
        Self {
            version: VERSION,
            shape: match shape {
                Shape::Open => "open",
                Shape::Ring => "ring",
            },
            wanted: WantedCounts {
                components: goal.components.map(Wanted::ends),
                holes: goal.holes.map(Wanted::ends),
                closed_pattern: goal.closed_pattern,
            },
            source: None,
            pieces: used.iter().map(|&piece| PieceDescriptor::new(piece, &descriptors[piece])).collect(),
            sequence: sequence.to_vec(),
            states,
            steps,
            closing,
            bridges: Vec::new(),
            result: ResultCounts {
                components: planned.components,
                holes: planned.holes,
                euler: i64::from(planned.components) - i64::from(planned.holes),
                closed_pattern: planned.closed_pattern,
            },
            recount: None,
            files: Vec::new(),
            sha256: String::new(),
        }
    }

    /// Adds what was counted and written, and the digest of the whole.
    pub(super) fn seal(&mut self, recount: [usize; 2], files: Vec<FileDigest>) {
        self.recount = Some(recount);
        self.files = files;
        let mut value = serde_json::to_value(&*self).expect("a certificate has no keys that are not text");
        if let Some(fields) = value.as_object_mut() {
            fields.remove("sha256");
        }
        self.sha256 = sha256(value.to_string().as_bytes());
    }
}

/// The middle of a bridge on the page, in micrometres.
fn middle_um(bridge: &Bridge) -> [i64; 2] {
    [0, 1].map(|axis| ((bridge.from_mm[axis] + bridge.to_mm[axis]) / 2.0 * 1e3).round() as i64)
}

impl PieceDescriptor {
    fn new(piece: usize, descriptor: &Descriptor) -> Self {
        Self {
            piece,
            left: descriptor.left().to_vec(),
            right: descriptor.right().to_vec(),
            closed: descriptor.closed(),
            euler: descriptor.euler(),
        }
    }
}

/// The states and steps of a sequence, and the whole run.
fn replayed(descriptors: &[Descriptor], sequence: &[usize]) -> (Vec<Connections>, Steps, Descriptor) {
    let mut states = Vec::new();
    let mut known: FxHashMap<Descriptor, usize> = FxHashMap::default();
    let mut steps = Steps { state: Vec::new(), closed: Vec::new(), euler: Vec::new() };
    let mut run: Option<Descriptor> = None;
    for &piece in sequence {
        let next = match &run {
            None => descriptors[piece].clone(),
            Some(run) => run.join(&descriptors[piece]).expect("a plan joins pieces with equal portals"),
        };
        let state = *known.entry(next.connections()).or_insert_with(|| {
            states.push(Connections { left: next.left().to_vec(), right: next.right().to_vec() });
            states.len() - 1
        });
        steps.state.push(state);
        steps.closed.push(next.closed());
        steps.euler.push(next.euler());
        run = Some(next);
    }
    (states, steps, run.expect("a plan has pieces"))
}

/// SHA-256 in hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
