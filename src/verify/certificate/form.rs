//! How a certificate is written, as far as it is read here.
//!
//! Apart from the code that writes it, so that a change there that is not told is found. Numbers may be any: what
//! cannot be is found by replaying.

use serde::Deserialize;

/// The version of certificates that are understood.
pub(super) const VERSION: i64 = 1;

#[derive(Deserialize)]
pub(super) struct Certificate {
    pub(super) version: i64,
    pub(super) shape: Shape,
    pub(super) wanted: Wanted,
    pub(super) pieces: Vec<Piece>,
    pub(super) sequence: Vec<i64>,
    pub(super) states: Vec<State>,
    pub(super) steps: Steps,
    pub(super) closing: Option<Closing>,
    pub(super) bridges: Vec<Bridge>,
    pub(super) result: Counts,
    pub(super) recount: Option<[i64; 2]>,
    pub(super) files: Vec<File>,
    pub(super) sha256: String,
}

#[derive(Deserialize, PartialEq, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub(super) enum Shape {
    Open,
    Ring,
}

#[derive(Deserialize)]
pub(super) struct Wanted {
    pub(super) components: Option<[i64; 2]>,
    pub(super) holes: Option<[i64; 2]>,
    pub(super) closed_pattern: bool,
}

#[derive(Deserialize)]
pub(super) struct Piece {
    pub(super) piece: i64,
    pub(super) left: Vec<i64>,
    pub(super) right: Vec<i64>,
    pub(super) closed: i64,
    pub(super) euler: i64,
}

#[derive(Deserialize)]
pub(super) struct State {
    pub(super) left: Vec<i64>,
    pub(super) right: Vec<i64>,
}

#[derive(Deserialize)]
pub(super) struct Steps {
    pub(super) state: Vec<i64>,
    pub(super) closed: Vec<i64>,
    pub(super) euler: Vec<i64>,
}

#[derive(Deserialize)]
pub(super) struct Closing {
    pub(super) portals: i64,
    pub(super) components: i64,
    pub(super) euler: i64,
    pub(super) closed_pattern: bool,
}

#[derive(Deserialize)]
pub(super) struct Bridge {
    pub(super) kind: String,
    pub(super) components: i64,
    pub(super) holes: i64,
}

#[derive(Deserialize)]
pub(super) struct Counts {
    pub(super) components: i64,
    pub(super) holes: i64,
    pub(super) euler: i64,
    pub(super) closed_pattern: bool,
}

#[derive(Deserialize)]
pub(super) struct File {
    pub(super) format: String,
    pub(super) sha256: String,
}
